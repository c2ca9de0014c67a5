//! Geometric features of robot and obstacles, and how to place the robot relative to an obstacle.

use crate::rigid::Shared;
use crate::{Placement, RigidBody};
use mp_cspace::{
    Interrupt, Rng,
    obstacles::{BodyFeatures, BodySphere, ObstacleGeometry, PointOf},
};
use mp_geom::{NO_COMPONENT, TriMesh};
use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use rand::RngExt;
use std::convert::Infallible;
use std::sync::OnceLock;

/// The features and surfaces of a robot and of the connected parts of its obstacles.
#[derive(Debug)]
pub(crate) struct SceneFeatures {
    robot: Surface,
    /// Each part, in the world.
    parts: Vec<Surface>,
    spheres: Vec<BodySphere>,
    /// For each obstacle: the index of its first part, and the part of each of its triangles, counted from that index.
    of_triangle: Vec<(usize, Vec<u32>)>,
}

/// A mesh with the running sums of its triangle areas, to draw points from.
#[derive(Debug)]
struct Surface {
    mesh: TriMesh,
    areas: Vec<f64>,
    sphere: BodySphere,
    /// Found when they are asked for: the tight box takes a thousand times as long as the sphere.
    features: OnceLock<BodyFeatures>,
}

/// Balls up to this many have surfaces; of more the centres stand for them.
const ROUND: usize = 1000;

/// The surface of a mesh, and how many of its triangles stand for each triangle of the mesh.
fn surface(mesh: &TriMesh) -> (TriMesh, usize) {
    let count = mesh.triangles().len();
    if !mesh.is_balls() || count > ROUND {
        return (mesh.clone(), 1);
    }
    let faceted = mesh.faceted();
    let each = faceted.triangles().len() / count;
    (faceted, each)
}

impl Surface {
    fn new(mesh: TriMesh) -> Self {
        let areas = (0..mesh.triangles().len()).scan(0.0, |sum, i| {
            *sum += mesh.triangle_area(i);
            Some(*sum)
        });
        let sphere = mesh.surrounding_sphere();
        let sphere = BodySphere { center: sphere.center.coords, radius: sphere.radius };
        Self { areas: areas.collect(), sphere, features: OnceLock::new(), mesh }
    }

    fn features(&self) -> BodyFeatures {
        *self.features.get_or_init(|| {
            let features = self.mesh.features();
            BodyFeatures { axis: features.axis.into_inner(), volume_ratio: features.volume_ratio() }
        })
    }

    fn point(&self, of: PointOf, rng: &mut Rng) -> Vector3<f64> {
        match of {
            PointOf::Center => self.sphere.center,
            PointOf::Vertex => {
                let t = self.mesh.triangles()[rng.random_range(0..self.areas.len())];
                self.mesh.vertices()[t[rng.random_range(0..3_usize)] as usize].coords
            }
            PointOf::Surface => {
                if !self.mesh.balls().is_empty() {
                    return self.mesh.triangle(rng.random_range(0..self.areas.len()))[0].coords;
                }
                let whole = self.areas.last().copied().unwrap_or(0.0);
                let at = rng.random::<f64>() * whole;
                let i = self.areas.partition_point(|&sum| sum <= at).min(self.areas.len() - 1);
                let [a, b, c] = self.mesh.triangle(i);
                let (mut u, mut v) = (rng.random::<f64>(), rng.random::<f64>());
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                (a + (b - a) * u + (c - a) * v).coords
            }
        }
    }
}

impl SceneFeatures {
    /// # Errors
    /// That of `go_on`, which is called for each part.
    fn new<E>(shared: &Shared, mut go_on: impl FnMut() -> Result<(), E>) -> Result<Self, E> {
        let (robot, _) = surface(&shared.robot_mesh);
        let mut features = Self {
            robot: Surface::new(robot),
            parts: Vec::new(),
            spheres: Vec::new(),
            of_triangle: Vec::new(),
        };
        for (_, mesh) in &shared.obstacles.placed {
            go_on()?;
            let (mesh, each) = surface(mesh);
            let component = mesh.topology().component.into_iter().step_by(each).collect();
            let first = features.parts.len();
            features.of_triangle.push((first, component));
            for part in mesh.parts() {
                go_on()?;
                let part = Surface::new(part);
                features.spheres.push(part.sphere);
                features.parts.push(part);
            }
        }
        Ok(features)
    }
}

impl<P: Placement> RigidBody<P> {
    fn features(&self) -> &SceneFeatures {
        self.shared.features.get_or_init(|| {
            let Ok(features) = SceneFeatures::new(&self.shared, || Ok::<(), Infallible>(()));
            features
        })
    }
}

/// The rotation that takes the unit vector `from` to the unit vector `to`, by the shorter way.
fn turn_to(from: &Vector3<f64>, to: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(from, to).unwrap_or_else(|| {
        // Opposite vectors: any axis perpendicular to them.
        let across = from.cross(&Vector3::ith(from.iamin(), 1.0));
        UnitQuaternion::from_axis_angle(&Unit::new_normalize(across), std::f64::consts::PI)
    })
}

/// From the meshes: each connected part of an obstacle's mesh is an obstacle here, and points are drawn from these parts.
/// Spheres are computed at the first call, in O(n log n) of the triangles, features for each part when they are asked for. Clones
/// share both.
impl<P: Placement> ObstacleGeometry<P::State> for RigidBody<P> {
    fn prepare(&self, interrupt: &Interrupt) -> bool {
        let known = &self.shared.features;
        let mut interrupt = interrupt.clone();
        let go_on = || if interrupt.ask() { Err(()) } else { Ok(()) };
        if known.get().is_none()
            && let Ok(features) = SceneFeatures::new(&self.shared, go_on)
        {
            // Another thread may have been first, with the same features.
            let _ = known.set(features);
        }
        known.get().is_some()
    }
    fn obstacles(&self) -> &[BodySphere] {
        &self.features().spheres
    }

    fn robot(&self) -> BodySphere {
        self.features().robot.sphere
    }

    fn obstacle_features(&self, obstacle: usize) -> Option<BodyFeatures> {
        self.features().parts.get(obstacle).map(Surface::features)
    }

    fn robot_features(&self) -> BodyFeatures {
        self.features().robot.features()
    }

    fn touched_obstacle(&mut self, q: &P::State) -> Option<usize> {
        if let Some((obstacle, triangle)) = self.hit(q) {
            let (first, parts) = &self.features().of_triangle[obstacle];
            let part = parts.get(triangle).filter(|part| **part != NO_COMPONENT).copied().unwrap_or(0);
            return Some(first + part as usize);
        }
        let around = self.solid_around(&P::pose(q))?;
        let obstacle = self.shared.obstacles.placed.iter().position(|(id, _)| *id == around)?;
        Some(self.features().of_triangle[obstacle].0)
    }

    fn obstacle_point(&self, obstacle: usize, of: PointOf, rng: &mut Rng) -> Option<Vector3<f64>> {
        Some(self.features().parts.get(obstacle)?.point(of, rng))
    }

    fn robot_point(&self, of: PointOf, rng: &mut Rng) -> Vector3<f64> {
        self.features().robot.point(of, rng)
    }

    fn world_point(&self, q: &P::State, point: &Vector3<f64>) -> Vector3<f64> {
        (P::pose(q) * Point3::from(*point)).coords
    }

    fn moved_to(&self, q: &P::State, point: &Vector3<f64>, place: &Vector3<f64>) -> P::State {
        let pose = P::pose(q);
        let translation = Translation3::from(place - pose.rotation * point);
        P::configuration(&Isometry3::from_parts(translation, pose.rotation))
    }

    fn aligned(&self, place: &Vector3<f64>, direction: &Vector3<f64>, angle: f64) -> P::State {
        let robot = &self.features().robot;
        let axis = robot.features().axis;
        let unit = |v: Vector3<f64>| Unit::try_new(v, 1e-12);
        let rotation = match P::TURNS {
            [_, _, _] => match unit(*direction) {
                Some(along) => UnitQuaternion::from_axis_angle(&along, angle) * turn_to(&axis, &along),
                None => UnitQuaternion::identity(),
            },
            [2] => {
                let yaw =
                    |v: &Vector3<f64>| if v.xy().norm() > 1e-12 { mp_math::atan2(v.y, v.x) } else { 0.0 };
                let turn = yaw(direction) - yaw(&axis) + angle;
                UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn)
            }
            _ => UnitQuaternion::identity(),
        };
        let translation = Translation3::from(place - rotation * robot.sphere.center);
        P::configuration(&Isometry3::from_parts(translation, rotation))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives::{cuboid, cylinder};

    #[test]
    fn tight_boxes_are_found_when_they_are_asked_for() {
        let obstacle =
            |x: f64, mesh: TriMesh| ("obstacle".to_owned(), mesh, Isometry3::translation(x, 0.0, 0.0));
        let parts = vec![
            obstacle(0.0, cylinder(0.1, 2.0, 12).unwrap()),
            obstacle(3.0, cuboid(1.0, 3.0, 1.0).unwrap()),
        ];
        let body = crate::FreeFlyer::new(&cuboid(0.1, 0.1, 0.4).unwrap(), parts).unwrap();
        assert!(body.prepare(&Interrupt::never()) && body.obstacles().len() == 2);
        let found =
            || body.features().parts.iter().map(|part| part.features.get().is_some()).collect::<Vec<_>>();
        assert!(found() == [false, false] && body.features().robot.features.get().is_none());
        let features = body.obstacle_features(1).unwrap();
        assert!((features.axis - Vector3::y()).norm() < 1e-9);
        assert_eq!(found(), [false, true]);
    }
}
