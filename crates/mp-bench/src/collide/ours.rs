//! The queries with `mp-collide`.

use super::pairs::Pair;
use super::poses::{EDGE, Meshes, QueryPoses};
use super::record::{QueryId, TimedAnswers, timed};
use crate::clock::nanoseconds;
use mp_collide::{Isa, Query};
use nalgebra::Isometry3;

/// The name of `mp-collide` in tables.
pub(crate) const OURS: &str = "mp";
/// The tolerance of tolerance queries, in radii of the robot.
pub(crate) const TOLERANCE: f64 = 0.02;

/// The cost of building the trees of a pair.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TreeBuild {
    pub(crate) lib: String,
    /// The time for both meshes, milliseconds.
    pub(crate) ms: f64,
    /// The memory of both trees, bytes; 0 when it is not known.
    pub(crate) bytes: usize,
}

pub(crate) fn build(pair: &Pair) -> (Meshes, TreeBuild) {
    let begin = nanoseconds();
    let meshes = Meshes::new(pair);
    let ms = (nanoseconds() - begin) * 1e-6;
    let bytes = meshes.a.memory() + meshes.b.memory();
    (meshes, TreeBuild { lib: OURS.to_owned(), ms, bytes })
}

/// The name of `mp-collide` on an instruction set.
pub(crate) fn name(isa: Isa) -> String {
    if isa == Isa::detect() {
        OURS.to_owned()
    } else {
        format!("{OURS}_{}", format!("{isa:?}").to_lowercase())
    }
}

/// Runs all queries `passes` times; distances only for the first `distances` poses of each set.
pub(crate) fn ask(
    pair: &Pair,
    meshes: &Meshes,
    poses: &QueryPoses,
    distances: usize,
    passes: usize,
) -> Vec<TimedAnswers> {
    let here = Isometry3::identity();
    let (a, b) = (&meshes.a, &meshes.b);
    let tolerance = TOLERANCE * pair.radius();
    let mut all = Vec::new();
    for (set, poses) in [("uniform", &poses.uniform), ("near", &poses.near)] {
        for isa in Isa::available() {
            let mut query = Query::with_isa(isa);
            let what = QueryId::new(&name(isa), set, "collide");
            all.push(timed(what, poses, passes, |pose| f64::from(query.intersects(a, &here, b, pose))));
        }
        let mut query = Query::default();
        let what = QueryId::new(OURS, set, "tolerance");
        all.push(timed(what, poses, passes, |pose| f64::from(query.within(a, &here, b, pose, tolerance))));
        let what = QueryId::new(OURS, set, "distance");
        let some = &poses[..distances.min(poses.len())];
        all.push(timed(what, some, passes, |pose| query.distance(a, &here, b, pose).distance));
    }
    let edges: Vec<&[Isometry3<f64>]> = poses.edges.chunks(EDGE).collect();
    let mut query = Query::default();
    let mut motion = timed(QueryId::new(OURS, "edges", "motion"), &edges, passes, |edge| {
        query.first_collision(b, edge, a, &here).unwrap_or(EDGE) as f64
    });
    // Per pose that is checked: those up to and including the first collision.
    let looked_at: f64 = motion.answers.iter().map(|first| (first + 1.0).min(EDGE as f64)).sum();
    let per_pose = edges.len() as f64 / looked_at;
    motion.least *= per_pose;
    motion.medians.iter_mut().for_each(|ns| *ns *= per_pose);
    all.push(motion);
    all
}

#[cfg(test)]
mod tests {
    use super::super::pairs::tori;
    use super::super::poses::Counts;
    use super::*;

    #[test]
    fn all_is_asked_and_all_agree() {
        let pair = tori("tori", 12).unwrap();
        let (meshes, build) = build(&pair);
        assert!(build.bytes > 0 && build.ms > 0.0);
        let counts = Counts { uniform: 50, near: 40, edges: 5 };
        let poses = QueryPoses::new(&pair, &meshes, counts, 2).unwrap();
        let all = ask(&pair, &meshes, &poses, 30, 2);
        assert_eq!(all.len(), 2 * (Isa::available().len() + 2) + 1);
        let of = |set: &str, query: &str| {
            all.iter().filter(|r| r.what.set == set && r.what.query == query).collect::<Vec<_>>()
        };
        for set in ["uniform", "near"] {
            let collide = of(set, "collide");
            assert!(collide.iter().all(|r| r.answers == collide[0].answers && r.medians.len() == 1));
            let (distance, within) = (of(set, "distance")[0], of(set, "tolerance")[0]);
            for (i, d) in distance.answers.iter().enumerate() {
                assert_eq!(*d == 0.0, collide[0].answers[i] == 1.0);
                assert_eq!(*d <= TOLERANCE * pair.radius(), within.answers[i] == 1.0);
            }
        }
        assert!(of("edges", "motion")[0].answers.iter().all(|&k| (1.0..=EDGE as f64).contains(&k)));
    }
}
