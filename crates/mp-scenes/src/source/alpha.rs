//! `alpha-1.0` … `alpha-1.5`: two tubes bent like the letter α, interlocked.
//!
//! The two arms of an α pass each other at a distance; the tubes come apart when one slips through the
//! crossing of the other. At scale s the crossing of the obstacle is 1.05 s times as wide as a tube is thick;
//! that of the robot is always as narrow as at scale 1.
//!
//! `tubes-1.0` … `tubes-1.5`: the same, as tight as the puzzles of these names that are known from the literature. The crossing leaves
//! a given room, and that only to a tube which is rolled so that its flats face the ridges of the other.

use super::scene::{Files, HOME, Scene, Six, configurations};
use super::shape::{on_grid, shifted, tube, tube_facing};
use mp_geom::{TriMesh, pose_from_six, six_from_pose};
use nalgebra::{Point3, Translation3, Unit, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, PI, SQRT_2};

/// Radius of the tubes.
const THICK: f64 = 0.5;
/// Radius of the loop.
const LOOP: f64 = 1.8;
/// Length of an arm from the crossing to its end.
const ARM: f64 = 5.0;
/// The x of the middle of an α, seen from the crossing: the origin of the robot.
const MIDDLE: f64 = -0.4;
/// Segments of the loop, and corners of the tube.
const STEPS: u32 = 36;
const SIDES: u32 = 12;

/// The bounds of all scenes.
const BOUNDS: [[f64; 3]; 2] = [[-10.0, -8.0, -8.0], [10.0, 8.0, 8.0]];
/// The free distance on either side of a strand in the crossing of `tubes`, metres. The first is that of the robot's own crossing.
const TIGHT: [(&str, f64); 4] =
    [("tubes-1.0", 0.0006), ("tubes-1.1", 0.002), ("tubes-1.2", 0.008), ("tubes-1.5", 0.06)];

/// Adds all scenes and their paths.
pub(super) fn add(files: &mut Files) {
    let robot = shifted(&alpha(level(1.0)), [-MIDDLE, 0.0, 0.0]);
    let path = separation(level(1.0), 0.0, [0.0; 2]);
    let (start, goal) = (path[0], path[path.len() - 1]);
    for (name, scale) in [
        ("alpha-1.0", 1.0),
        ("alpha-1.1", 1.1),
        ("alpha-1.2", 1.2),
        ("alpha-1.3", 1.3),
        ("alpha-1.4", 1.4),
        ("alpha-1.5", 1.5),
    ] {
        Scene::new(name, BOUNDS, "alpha/robot.off", &robot)
            .query(start.map(on_grid), goal.map(on_grid))
            .obstacle(&format!("alpha/obstacle-{scale:.1}.off"), &alpha(level(scale)), &[HOME])
            .finish(files);
    }
    let path: Vec<Six> = path.into_iter().map(|six| six.map(on_grid)).collect();
    files.insert("paths/alpha.txt".to_owned(), configurations(&path));
    let robot = shifted(&tight(tight_level(TIGHT[0].1)), [-MIDDLE, 0.0, 0.0]);
    for (name, room) in TIGHT {
        let level = tight_level(room);
        Scene::new(name, BOUNDS, "tubes/robot.off", &robot)
            .solved_by(&separation(level, FLAT, [0.2, BEND]))
            .obstacle(&format!("tubes/{name}.off"), &tight(level), &[HOME])
            .finish(files);
    }
}

/// Half the angle between two corners of a tube: how far it is rolled to be thinnest between two ridges.
const FLAT: f64 = PI / SIDES as f64;

/// As [`level`], where a strand that is rolled by [`FLAT`] has `room` on either side.
fn tight_level(room: f64) -> f64 {
    THICK * (1.0 + mp_math::cos(FLAT)) + room + BEND
}

/// Half of what a bent strand needs more than a straight one, on the inner side of its bend.
const BEND: f64 = 0.0007;

/// How far the centre line of either arm is from the plane z = 0 at the crossing.
fn level(scale: f64) -> f64 {
    THICK * (2.05 + 0.7 * (scale - 1.0))
}

/// An α along the plane z = 0 with its crossing at the origin and its loop towards -x: along the lower
/// arm, around the loop, along the upper arm.
fn alpha(level: f64) -> TriMesh {
    tube(&line(level), |_| THICK, SIDES, Vector3::z())
}

/// As [`alpha`], with ridges above and below all along.
fn tight(level: f64) -> TriMesh {
    let up = |t: Vector3<f64>| (Vector3::z() - t * t.z).normalize();
    tube_facing(&line(level), |_| THICK, SIDES, up)
}

/// The line along the middle of the tube.
fn line(level: f64) -> Vec<Point3<f64>> {
    let end = ARM * FRAC_1_SQRT_2;
    let mut line = vec![Point3::new(end, -end, -level)];
    line.extend((0..=STEPS).map(|i| on_loop(FRAC_PI_4 + 1.5 * PI * f64::from(i) / f64::from(STEPS), level)));
    line.push(Point3::new(end, end, level));
    line
}

/// The point of the loop at an angle about its centre, from π/4 to 7π/4. The loop rises from the level of
/// the lower arm to that of the upper, slowly at both ends.
fn on_loop(angle: f64, level: f64) -> Point3<f64> {
    let t = (angle - PI) / (0.75 * PI);
    let (s, c) = mp_math::sin_cos(angle);
    Point3::new(LOOP * (c - SQRT_2), LOOP * s, 0.5 * level * t * (3.0 - t * t))
}

/// A path that separates the two: like a ring along a wire, the loop of the robot follows the loop of the obstacle, then the
/// upper arm to its end and beyond. In the crossing the robot's strand is half-way between the two arms, rolled by `roll`, but for
/// the last of the distances `apart`; before, it is further from the wire by the first.
fn separation(level: f64, roll: f64, apart: [f64; 2]) -> Vec<Six> {
    let mut path = Vec::new();
    let [apart, lower] = apart;
    let turn = 24;
    for i in 0..=turn {
        let u = f64::from(i) / f64::from(turn);
        let angle = PI + 0.75 * PI * u;
        let ease = u * u * (3.0 - 2.0 * u);
        let at = ring(on_loop(angle, level), LOOP + (level + apart - LOOP) * ease, angle, 0.5 * PI * ease);
        path.push(rolled(at, roll * ease));
    }
    // Along the arm, the strand half-way between the two arms: from where the arm is straight, if it came nearer there.
    for i in i32::from(apart == 0.0)..=8 {
        let from = if apart > 0.0 { -0.5 * LOOP } else { -LOOP };
        let along = (from + (ARM + 4.0 - from) * f64::from(i) / 8.0) * FRAC_1_SQRT_2;
        path.push(rolled(ring(Point3::new(along, along, level), level + lower, 1.75 * PI, 0.5 * PI), roll));
    }
    path.push([7.0, 1.5, 3.5, -0.8, -0.9, -1.2]);
    path
}

/// The robot around the wire of the obstacle at `wire`, where the wire runs in the direction
/// `angle` + π/2. The far end of the robot's loop is at `distance` from there, on the side of the loop's
/// centre for `tilt` 0 and below for π/2; the robot's crossing is on the other side.
fn ring(wire: Point3<f64>, distance: f64, angle: f64, tilt: f64) -> Six {
    let ((s, c), (up, horizontal)) = (mp_math::sin_cos(angle), mp_math::sin_cos(tilt));
    let out = Vector3::new(c * horizontal, s * horizontal, up);
    let origin = wire + out * (LOOP * (SQRT_2 + 1.0) + MIDDLE - distance);
    [origin.x, origin.y, origin.z, angle - 2.0 * PI, -tilt, -0.5 * PI]
}

/// The robot turned about the strand at the far end of its loop.
fn rolled(at: Six, angle: f64) -> Six {
    if angle == 0.0 {
        return at;
    }
    let level = tight_level(TIGHT[0].1);
    let [before, after] = [-1.0, 1.0].map(|i| on_loop(PI + i * 1.5 * PI / f64::from(STEPS), level));
    let strand = Translation3::new(-LOOP * (SQRT_2 + 1.0) - MIDDLE, 0.0, 0.0);
    let turn = UnitQuaternion::from_axis_angle(&Unit::new_normalize(before - after), angle);
    six_from_pose(&(pose_from_six(at) * strand * turn * strand.inverse()))
}
