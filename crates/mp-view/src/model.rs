//! The model of a scene file.

use mp_plan::Column;
use serde::{Deserialize, Serialize};

/// A scene with what is to be shown of it.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFile {
    /// What the page calls the scene.
    pub name: String,
    /// The configuration space: `SE3`, `SE2`, `R2`, `6 joints`.
    pub space: String,
    /// Whether the scene is best seen from above.
    pub planar: bool,
    /// The meaning of each number of a configuration.
    pub columns: Vec<Column>,
    /// The least and the largest value of each number; `None` for an angle without limits.
    pub limits: Vec<Option<[f64; 2]>>,
    /// The least and the largest coordinates (m) of what is drawn without a path: obstacles, start and goals.
    pub bounds: [[f64; 3]; 2],
    /// What is to be added to all places (m): zero, unless [it is far away](SceneFile::for_file).
    pub origin: [f64; 3],
    /// Surfaces, each in the frame of its bodies.
    pub meshes: Vec<Mesh>,
    /// Areas of the plane.
    pub areas: Vec<Area>,
    /// Polylines, such as walls of the plane.
    pub lines: Vec<Polyline>,
    /// The bodies of the robot first, then the obstacles.
    pub bodies: Vec<Body>,
    /// Where paths begin, drawn green.
    pub start: Configuration,
    /// Where paths may end, drawn red; one configuration for each goal that leaves numbers free.
    pub goals: Vec<Configuration>,
    /// Paths, to be drawn and animated.
    pub paths: Vec<PathTrack>,
    /// Search trees.
    pub trees: Vec<Tree>,
    /// The roadmap of a run, if its planner builds one.
    pub roadmap: Option<Roadmap>,
    /// The report of a run, as `mp plan --json` prints it.
    pub report: Option<serde_json::Value>,
}

/// A triangle mesh in the frame of its bodies, metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// x y z of each vertex.
    pub positions: Vec<f32>,
    /// The three vertices of each triangle.
    pub triangles: Vec<u32>,
}

/// An area of the plane z = 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Area {
    /// x y (m) of each corner: the outer ring, then the holes. The last corner is joined to the first.
    pub rings: Vec<Vec<f32>>,
}

/// Points joined in order by straight lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyline {
    /// x y z (m) of each point.
    pub points: Vec<f32>,
}

/// Whether a body moves with the configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// It is a part of the robot.
    Robot,
    /// It is an obstacle that moves by itself. Its poses come with each configuration, as those of the robot, after them.
    Moving,
    /// It stands still.
    Obstacle,
}

/// What a body looks like.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Shape {
    /// An index of [`SceneFile::meshes`].
    Mesh(usize),
    /// An index of [`SceneFile::areas`].
    Area(usize),
    /// Some of the polylines.
    Lines(Vec<usize>),
}

/// What is drawn at a pose: a part of the robot, or an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its name in messages.
    pub name: String,
    /// Whether it is a part of the robot.
    pub role: Role,
    /// What it looks like, in its own frame.
    pub shape: Shape,
    /// Where an obstacle is: x y z (m), and the unit quaternion x y z w. `None` for the bodies of the robot and obstacles that move,
    /// whose poses come with each configuration.
    pub pose: Option<[f64; 7]>,
    /// Its own colour: red, green and blue. `None` for the colour of its role. Start and goals keep theirs.
    pub color: Option<[u8; 3]>,
}

/// A configuration, with the poses of the robot's bodies.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Configuration {
    /// Its numbers, as the columns say.
    pub row: Vec<f64>,
    /// A pose for each body of the robot: x y z (m), and the unit quaternion x y z w.
    pub poses: Vec<f64>,
}

/// A path, sampled finely enough that poses between neighbours may be interpolated linearly.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathTrack {
    /// What lists and the legend call it.
    pub name: String,
    /// Whether the path passed the verifier.
    pub verified: bool,
    /// Its length in the metric of the space, where it is known.
    pub length: Option<f64>,
    /// The numbers of each configuration, one after the other.
    pub rows: Vec<f64>,
    /// A pose for each body of the robot at each configuration, seven numbers each.
    pub poses: Vec<f32>,
    /// x y z (m) of the point whose curve is drawn, at each configuration.
    pub trace: Vec<f32>,
    /// A lower bound on the clearance (m) at each configuration, where it is known.
    pub clearance: Option<Vec<f32>>,
    /// How far (m) the robot has moved from the start to each configuration, an upper bound for its points, where it is known.
    pub travel: Option<Vec<f32>>,
    /// Which configurations are the path's own, where it is known; the others are between them.
    pub corners: Option<Vec<u32>>,
}

/// A search tree, drawn by one point of the robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tree {
    /// What lists and the legend call it.
    pub name: String,
    /// x y z (m) of each node.
    pub nodes: Vec<f32>,
    /// The parent of each node; −1 for a root.
    pub parents: Vec<i32>,
    /// The edges that are not straight.
    pub bends: Bends,
}

/// Edges of a tree that are not straight where they are drawn, such as those that snakes bend around obstacles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bends {
    /// For each edge that bends: the node at its end, and how many points lie between the parent and that node.
    pub nodes: Vec<u32>,
    /// x y z (m) of these points from the parent to the node, edge by edge.
    pub through: Vec<f32>,
}

/// A roadmap, drawn by one point of the robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Roadmap {
    /// x y z (m) of each milestone.
    pub nodes: Vec<f32>,
    /// The two milestones of each edge.
    pub edges: Vec<u32>,
    /// The connected component of each milestone.
    pub component: Vec<u32>,
    /// What each milestone is: 0 sampled, 1 guard, 2 connection, 3 other.
    pub kind: Vec<u8>,
}
