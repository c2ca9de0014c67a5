//! Comparison of all boolean answers with exact arithmetic.
//!
//! The contract of [`mp_collide`] is taken literally: the corners of the robot are moved by the rotation
//! matrix and the translation, with the rounding it specifies, and touching is collision. Triangles whose
//! bounding balls meet are compared one by one, in integers wherever `f64` is not certain. No code is shared
//! with the engine.

mod hard_poses;
mod predicate;

use super::Options;
use super::pairs::Pair;
use super::poses::Meshes;
use crate::clock::{nanoseconds, seconds_since};
use crate::error::Result;
use crate::experiment::{Lab, Table};
use crate::options::Common;
use crate::output::note;
use mp_collide::reference::RefMesh;
use mp_collide::{Isa, Query};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use predicate::{Sides, Triangle, apart, meet_exactly};

/// The default number of poses of all pairs together.
const POSES: usize = 1_000_000;
/// The most wrong answers of each kind that are printed.
const TOLD: usize = 5;

/// Compares all answers. True when none differs.
pub(super) fn run(lab: &Lab, common: &Common, options: &Options, pairs: &[&str]) -> Result<bool> {
    let each = options.poses.unwrap_or(if common.quick { POSES / 100 } else { POSES / pairs.len() });
    let mut table = Table::new(["pair", "poses", "count", "colliding", "decided in integers", "wrong"]);
    let mut all_right = true;
    for name in pairs {
        let pair = Pair::load(name)?;
        let meshes = Meshes::new(&pair);
        let mut referee = Referee::new(&pair);
        let mut queries: Vec<Query> = Isa::available().into_iter().map(Query::with_isa).collect();
        let begin = nanoseconds();
        for (kind, poses) in hard_poses::pose_groups(&pair, &meshes, each, options.seed)? {
            let (mut hits, mut close, mut wrong) = (0, 0, 0);
            for pose in &poses {
                let exact = referee.judge(pose);
                hits += usize::from(exact.meet);
                close += usize::from(exact.close);
                // The query runs on every instruction set.
                if queries.iter_mut().any(|query| meshes.collide(query, pose) != exact.meet) {
                    wrong += 1;
                    if wrong <= TOLD {
                        note(&format!(
                            "{name} ({kind}): {} is the exact answer at {}",
                            exact.meet,
                            bits(pose)
                        ));
                    }
                }
            }
            all_right &= wrong == 0;
            let counts = [poses.len(), hits, close, wrong].map(|n| n.to_string());
            table.rows.push([(*name).to_owned(), kind].into_iter().chain(counts).collect());
        }
        note(&format!("{name}: compared in {:.0} s", seconds_since(begin)));
    }
    lab.report("referee", &table.markdown(), &table)?;
    Ok(all_right)
}

/// The exact text of a pose, with which it can be made again.
fn bits(pose: &Isometry3<f64>) -> String {
    let (q, t) = (pose.rotation.quaternion(), pose.translation.vector);
    format!("w i j k {:?} {:?} {:?} {:?}, x y z {:?} {:?} {:?}", q.w, q.i, q.j, q.k, t.x, t.y, t.z)
}

/// The answer of the referee.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ExactAnswer {
    meet: bool,
    /// Whether `f64` was not certain.
    close: bool,
}

/// Decides exactly whether poses of a pair collide.
#[derive(Debug)]
struct Referee<'p> {
    pair: &'p Pair,
    a: RefMesh,
    b: RefMesh,
    close: Vec<(Triangle, Triangle, Sides)>,
}

impl<'p> Referee<'p> {
    fn new(pair: &'p Pair) -> Self {
        Self { pair, a: RefMesh::new(&pair.a), b: RefMesh::new(&pair.b), close: Vec::new() }
    }

    /// Whether the robot at `pose` collides.
    fn judge(&mut self, pose: &Isometry3<f64>) -> ExactAnswer {
        let Self { pair, a, b, close } = self;
        let moved = Placed::new(pose);
        close.clear();
        let clear_hit = a.any_near_pair(&Isometry3::identity(), b, pose, |i, j| {
            let (s, t) = (pair.a.triangle(i), pair.b.triangle(j).map(|p| moved.point(&p)));
            if apart(&s, &t) {
                return false;
            }
            let sides = Sides::of(&s, &t);
            let meet = sides.meet();
            if !meet {
                close.push((s, t, sides));
            }
            meet
        });
        let meet = clear_hit || close.iter().any(|(s, t, sides)| meet_exactly(s, t, sides));
        ExactAnswer { meet, close: !clear_hit && !close.is_empty() }
    }
}

/// The transform of the robot's points, with the rounding of the contract.
#[derive(Clone, Copy, Debug)]
struct Placed {
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
}

impl Placed {
    fn new(pose: &Isometry3<f64>) -> Self {
        let q = pose.rotation.quaternion();
        let (w, x, y, z, s) = (q.w, q.i, q.j, q.k, 2.0 / q.norm_squared());
        let rotation = Matrix3::new(
            1.0 - s * (y * y + z * z),
            s * (x * y - w * z),
            s * (x * z + w * y),
            s * (x * y + w * z),
            1.0 - s * (x * x + z * z),
            s * (y * z - w * x),
            s * (x * z - w * y),
            s * (y * z + w * x),
            1.0 - s * (x * x + y * y),
        );
        Self { rotation, translation: pose.translation.vector }
    }

    fn point(&self, p: &Point3<f64>) -> Point3<f64> {
        let row = |i: usize| {
            let r = self.rotation.row(i);
            r[0] * p.x + r[1] * p.y + r[2] * p.z + self.translation[i]
        };
        Point3::new(row(0), row(1), row(2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collide::pairs::tori;
    use mp_geom::primitives;

    #[test]
    fn boxes_that_touch_are_judged_right() {
        let mesh = primitives::cuboid(1.0, 0.5, 2.0).unwrap();
        let bounds = mesh.aabb();
        let pair = Pair { name: "boxes".into(), a: mesh.clone(), b: mesh, bounds };
        let mut referee = Referee::new(&pair);
        let mut at = |x: f64, y: f64, z: f64| referee.judge(&Isometry3::translation(x, y, z));
        for (x, y, z) in [(1.0, 0.0, 0.0), (1.0, 0.5, 0.0), (-1.0, 0.5, 2.0), (0.0, 0.125, 2.0)] {
            assert!(at(x, y, z).meet, "{x} {y} {z}");
            let off = 1.0 + f64::EPSILON;
            assert!(!at(x * off, y * off, z * off).meet, "{x} {y} {z}");
        }
        assert_eq!(at(3.0, 0.0, 0.0), ExactAnswer { meet: false, close: false });
    }

    #[test]
    fn the_engine_is_right() {
        let pair = tori("tori", 16).unwrap();
        let (meshes, mut referee) = (Meshes::new(&pair), Referee::new(&pair));
        let mut query = Query::default();
        for (kind, poses) in hard_poses::pose_groups(&pair, &meshes, 2_000, 1).unwrap() {
            for pose in &poses {
                let right = referee.judge(pose).meet;
                assert_eq!(meshes.collide(&mut query, pose), right, "{kind} {}", bits(pose));
            }
        }
    }
}
