//! A builder of scenes, which turns them into files.

use super::shape::{mapped, on_fine_grid, on_grid};
use mp_geom::TriMesh;
use mp_io::{Environment, Obstacle, PathFile, SpaceKind, gempa_mesh_text, off_text};
use std::collections::BTreeMap;

/// Files to write, by path relative to the assets folder.
pub type Files = BTreeMap<String, Vec<u8>>;

/// Position and angles as in GEMPA files: x, y, z, then yaw α, pitch β, roll γ in radians.
pub(super) type Six = [f64; 6];

/// A right angle.
pub(super) const QUARTER: f64 = std::f64::consts::FRAC_PI_2;

/// The pose at the origin.
pub(super) const HOME: Six = [0.0; 6];

/// A pose in the plane.
pub(super) fn planar(x: f64, y: f64, yaw: f64) -> Six {
    [x, y, 0.0, yaw, 0.0, 0.0]
}

/// One planning problem: a robot, obstacles with poses, start, goal and bounds.
pub(super) struct Scene {
    name: &'static str,
    space: SpaceKind,
    bounds: [[f64; 3]; 2],
    robot: String,
    start: Six,
    goal: Six,
    obstacles: Vec<(String, Six)>,
    files: Files,
}

impl Scene {
    /// A scene in SE(3) for a robot whose mesh is written to `file`; the origin of the robot stays in `bounds`.
    pub(super) fn new(name: &'static str, bounds: [[f64; 3]; 2], file: &str, robot: &TriMesh) -> Self {
        let mut scene = Self {
            name,
            space: SpaceKind::Se3,
            bounds,
            robot: String::new(),
            start: HOME,
            goal: HOME,
            obstacles: Vec::new(),
            files: Files::new(),
        };
        scene.robot = scene.mesh(file, robot);
        scene
    }

    /// Makes the robot move in the plane z = 0.
    pub(super) fn in_plane(mut self) -> Self {
        self.space = SpaceKind::Se2;
        self
    }

    pub(super) fn query(mut self, start: Six, goal: Six) -> Self {
        (self.start, self.goal) = (start, goal);
        self
    }

    /// Sets start and goal to the ends of a known solution, which becomes `paths/NAME.txt`.
    pub(super) fn solved_by(mut self, path: &[Six]) -> Self {
        let path: Vec<Six> = path.iter().map(|six| six.map(on_fine_grid)).collect();
        self.files.insert(format!("paths/{}.txt", self.name), configurations(&path));
        self.query(path[0], path[path.len() - 1])
    }

    /// Adds an obstacle at every one of `poses`.
    pub(super) fn obstacle(mut self, file: &str, mesh: &TriMesh, poses: &[Six]) -> Self {
        let path = self.mesh(file, mesh);
        self.obstacles.extend(poses.iter().map(|&p| (path.clone(), p)));
        self
    }

    /// Adds a mesh as `meshes/FILE`; returns its path relative to a scene file. The extension of `file` chooses
    /// the format.
    fn mesh(&mut self, file: &str, mesh: &TriMesh) -> String {
        let mesh = mapped(mesh, |p| [on_grid(p.x), on_grid(p.y), on_grid(p.z)]);
        let text = if file.ends_with(".off") { off_text(&mesh) } else { gempa_mesh_text(&mesh) };
        let path = format!("meshes/{file}");
        self.files.insert(path.clone(), text.into_bytes());
        format!("../{path}")
    }

    /// Adds the scene and its meshes to `files`.
    pub(super) fn finish(mut self, files: &mut Files) {
        let [low, high] = self.bounds;
        let obstacles = self.obstacles.into_iter().zip(1..);
        let environment = Environment {
            robot: self.robot,
            start: self.start,
            goal: self.goal,
            obstacles: obstacles.map(|((mesh, pose), number)| Obstacle { number, mesh, pose }).collect(),
            space: Some(self.space),
            bounds: Some([low[0], low[1], low[2], high[0], high[1], high[2]]),
        };
        files.insert(format!("scenes/{}.env", self.name), environment.to_text().into_bytes());
        for (path, bytes) in std::mem::take(&mut self.files) {
            if let Some(other) = files.insert(path.clone(), bytes.clone()) {
                assert!(other == bytes, "two different meshes are called {path}");
            }
        }
    }
}

/// The content of a configuration file.
pub(super) fn configurations(path: &[Six]) -> Vec<u8> {
    PathFile { configurations: path.to_vec() }.to_text().into_bytes()
}
