//! Small scenes of robots that cannot make any motion: among obstacles that move, on wheels, and by limited velocities and
//! accelerations; and of goals that leave something free.

use super::scene::Files;

/// Two lorries drive along a road that a disc crosses, and a gate beyond it is open for some seconds only.
const CROSSING: &str = "\
# A disc crosses a road with two lorries, then passes a gate that is open from 14 s to 22 s.

[world]
walls = [[0, 0], [12, 10]]

[robot]
disc = 0.3

[motion]
start = [6, 0.8]
goal = { x = [2, 10], y = 9.2 }   # anywhere beyond the gate
speed = 1.0                       # metres per second, at most
horizon = 40                      # seconds

[[obstacle]]
name = \"left wall\"
rectangle = [[0, 7.2], [5.4, 7.5]]

[[obstacle]]
name = \"right wall\"
rectangle = [[6.6, 7.2], [12, 7.5]]

[[moving]]
name = \"eastbound\"
rectangle = [[-2, -0.6], [2, 0.6]]
path = [[0, 1, 3], [12, 25, 3]]    # time, x, y

[[moving]]
name = \"westbound\"
rectangle = [[-2, -0.6], [2, 0.6]]
path = [[0, 14, 5], [6, 6, 5], [9, 6, 5], [16, -8, 5]]

[[moving]]
name = \"gate\"
rectangle = [[-0.65, -0.1], [0.65, 0.1]]
path = [[0, 6, 7.35, 0], [13, 6, 7.35, 0], [14, 7.6, 7.35, 0], [22, 7.6, 7.35, 0], [23, 6, 7.35, 0]]
";

/// A car turns around in a lane and parks between two others.
const PARKING: &str = "\
# A car parks backward between two others.

[world]
walls = [[0, 0], [20, 8]]

[robot]
kind = \"car\"
polygon = [[-1, -0.9], [3.4, -0.9], [3.4, 0.9], [-1, 0.9]]   # the origin is the middle of the rear axle
wheelbase = 2.5
turning_radius = 5
speed = 2
duration = 0.5                                                # seconds that an input is held

[motion]
start = [3, 5.5, 0]
goal = [9.3, 1.3, 0]
tolerance = 0.2

[[obstacle]]
name = \"car behind\"
rectangle = [[2, 0.3], [7, 2.2]]

[[obstacle]]
name = \"car in front\"
rectangle = [[14.5, 0.3], [19, 2.2]]
";

/// A unicycle in a room with three tables.
const UNICYCLE: &str = "\
# A robot with two driven wheels goes around tables.

[world]
walls = [[0, 0], [5, 4]]

[robot]
kind = \"unicycle\"
disc = 0.18
speed = 0.5
turning = 1.5
reverse = false
duration = 0.6

[motion]
start = [0.5, 0.5, 0]
goal = { x = [4.4, 4.7], y = [3.3, 3.6] }   # any direction

[[obstacle]]
name = \"long table\"
rectangle = [[1.2, 0], [1.7, 2.8]]

[[obstacle]]
name = \"round table\"
circle = [3, 3, 0.5]

[[obstacle]]
name = \"desk\"
rectangle = [[3.2, 0.8], [5, 1.4]]
";

/// A long body moves sideways and turns, with a limited velocity each.
const VELOCITIES: &str = "\
# A body moved by velocities: it goes sideways slowly.

[world]
walls = [[0, 0], [5, 4]]

[robot]
kind = \"velocities\"
polygon = [[-0.6, -0.12], [0.6, -0.12], [0.6, 0.12], [-0.6, 0.12]]
speeds = [0.8, 0.3, 1.0]   # x, y (m/s) and turning (rad/s)
duration = 0.5

[motion]
start = [0.8, 0.5, 0]
goal = [4.2, 3.5, 0]
tolerance = 0.15

[[obstacle]]
name = \"lower wall\"
rectangle = [[2.4, 0], [2.6, 1.6]]

[[obstacle]]
name = \"upper wall\"
rectangle = [[2.4, 2.3], [2.6, 4]]
";

/// A puck that accelerates.
const ACCELERATIONS: &str = "\
# A puck moved by accelerations goes around a corner, and is slow at the goal.

[world]
walls = [[0, 0], [4, 3]]

[robot]
kind = \"accelerations\"
disc = 0.1
speeds = [1, 1]              # m/s
accelerations = [0.8, 0.8]   # m/s²
duration = 0.4

[motion]
start = [0.4, 0.4]           # at rest: its velocities could follow
goal = { x = [3.3, 3.7], y = [0.3, 0.7], v_x = [-0.3, 0.3], v_y = [-0.3, 0.3] }

[[obstacle]]
name = \"wall\"
rectangle = [[1.9, 0], [2.1, 2]]
";

/// A table with three sides at which a robot may stand.
const DOCKS: &str = "\
# A set of goals: a cart stops at any of three docks, or anywhere along a shelf.

[world]
walls = [[0, 0], [6, 4]]

[robot]
polygon = [[-0.35, -0.2], [0.35, -0.2], [0.35, 0.2], [-0.35, 0.2]]

[motion]
start = [0.6, 0.5, 0]
goals = [
    [5.4, 0.5, 0],                                # dock 1
    [5.4, 1.2, 0],                                # dock 2
    { x = 5.4, y = 3.5 },                         # dock 3, any direction
    { x = [2.5, 4], y = 3.6, yaw = [-0.1, 0.1] }, # along the shelf
]

[[obstacle]]
name = \"counter\"
rectangle = [[1.6, 0], [2, 2.6]]

[[obstacle]]
name = \"shelf\"
rectangle = [[2.4, 3.82], [4.2, 4]]

[[obstacle]]
name = \"pillar\"
circle = [3.6, 1.6, 0.5]
";

/// A box flies through a window in which a blade turns.
const BLADE: &str = "\
# A box flies through a window while a blade turns in it.

[robot]
box = [0.5, 0.16, 0.16]
bounds = [[-2, -1.6, -1.6], [2, 1.6, 1.6]]

[motion]
start = [-1.5, 0, 0, 0, 0, 0]     # x y z, then the angles about Z, Y and X
goal = [1.5, 0, 0, 0, 0, 0]
speed = 1.5
horizon = 12

[[obstacle]]
name = \"left\"
box = [0.1, 1.2, 3.2]
pose = [0, 1.1, 0, 0, 0, 0]

[[obstacle]]
name = \"right\"
box = [0.1, 1.2, 3.2]
pose = [0, -1.1, 0, 0, 0, 0]

[[obstacle]]
name = \"lintel\"
box = [0.1, 1, 1.1]
pose = [0, 0, 1.05, 0, 0, 0]

[[obstacle]]
name = \"sill\"
box = [0.1, 1, 1.1]
pose = [0, 0, -1.05, 0, 0, 0]

[[moving]]
name = \"blade\"
box = [0.04, 0.95, 0.12]
path = [[0, 0, 0, 0, 0, 0, 0], [4, 0, 0, 0, 0, 0, 2], [8, 0, 0, 0, 0, 0, 4], [12, 0, 0, 0, 0, 0, 6]]
";

/// A robot on wheels among carts: obstacles that move, and inputs.
const WAREHOUSE: &str = "\
# A robot with two driven wheels crosses an aisle in which two carts drive.

[world]
walls = [[0, 0], [8, 6]]

[robot]
kind = \"unicycle\"
disc = 0.25
speed = 0.8
turning = 1.5
reverse = false
duration = 0.6

[motion]
start = [0.8, 0.6, 1.57]
goal = { x = [6.8, 7.4], y = [5, 5.6] }   # any direction, at any time
horizon = 30                              # seconds

[[obstacle]]
name = \"lower shelf\"
rectangle = [[1.8, 1.2], [8, 1.8]]

[[obstacle]]
name = \"upper shelf\"
rectangle = [[0, 4], [5.8, 4.6]]

[[moving]]
name = \"cart\"
rectangle = [[-0.6, -0.8], [0.6, 0.8]]
path = [[0, 7.2, 2.9], [6, 0.8, 2.9], [9, 0.8, 2.9], [15, 7.2, 2.9], [30, 7.2, 2.9]]   # time, x, y

[[moving]]
name = \"sweeper\"
circle = [0, 0, 0.4]
path = [[0, 6.8, 2.2], [10, 6.8, 5.4], [20, 6.8, 2.2], [30, 6.8, 5.4]]
";

/// A box that accelerates in space.
const FLYER: &str = "\
# A box moved by accelerations flies through a window, turns, and is slow at the goal.

[robot]
kind = \"accelerations\"
box = [0.7, 0.3, 0.2]
bounds = [[-2, -1.5, -1.2], [2, 1.5, 1.2]]
speeds = [0.6, 0.6, 0.6, 0.8, 0.8, 0.8]          # along x, y, z (m/s), and turning about them (rad/s)
accelerations = [0.5, 0.5, 0.5, 1, 1, 1]         # m/s², rad/s²
duration = 0.5                                   # seconds that an input is held

[motion]
start = [-1.4, -0.6, 0.5, 1.57, 0, 0]            # x y z, then the angles about Z, Y and X
goal = { x = [1.1, 1.6], y = [0.2, 0.8], z = [-0.6, 0], v_x = [-0.3, 0.3], v_y = [-0.3, 0.3], v_z = [-0.3, 0.3] }

[[obstacle]]
name = \"left\"
box = [0.1, 1.1, 2.4]
pose = [0, 0.95, 0, 0, 0, 0]

[[obstacle]]
name = \"right\"
box = [0.1, 1.1, 2.4]
pose = [0, -0.95, 0, 0, 0, 0]

[[obstacle]]
name = \"lintel\"
box = [0.1, 0.8, 0.7]
pose = [0, 0, 0.85, 0, 0, 0]

[[obstacle]]
name = \"sill\"
box = [0.1, 0.8, 0.9]
pose = [0, 0, -0.75, 0, 0, 0]
";

/// Adds the scenes.
pub(super) fn add(files: &mut Files) {
    for (name, text) in [
        ("accelerations", ACCELERATIONS),
        ("blade", BLADE),
        ("crossing", CROSSING),
        ("docks", DOCKS),
        ("flyer", FLYER),
        ("parking", PARKING),
        ("unicycle", UNICYCLE),
        ("velocities", VELOCITIES),
        ("warehouse", WAREHOUSE),
    ] {
        files.insert(format!("scenes/{name}.toml"), text.as_bytes().to_vec());
    }
}
