//! Every kind of query on every instruction set: the same answers to the last bit, and the same work wherever products
//! are fused alike.

use mp_collide::{CollisionMesh, Counters, IntervalCheck, Isa, Query, RigidMotion, Separation};
use mp_geom::{TriMesh, primitives};
use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use rand::RngExt;

use crate::common::{Pcg64, bumpy, cases_of, cuboid, point, pose, rng, soup};

/// What is asked: `a` at `poses` and along `motion` about the first of them, against `b` at `here`.
struct Case {
    a: CollisionMesh,
    b: CollisionMesh,
    here: Isometry3<f64>,
    poses: Vec<Isometry3<f64>>,
    motion: RigidMotion,
}

fn segment(p: Point3<f64>, q: Point3<f64>) -> TriMesh {
    TriMesh::new(vec![p, q], vec![[0, 1, 1]]).unwrap()
}

impl Case {
    fn new(rng: &mut Pcg64, kind: usize) -> Self {
        let (a, b) = match kind % 5 {
            0 => (bumpy(10, 0.5, 0.2), soup(rng, 60, 1.0, 0.3)),
            1 => (soup(rng, 40, 0.6, 0.3), bumpy(9, 0.7, 0.1)),
            // Many pairs of triangles are equally near.
            2 => (cuboid(Vector3::new(0.5, 0.4, 0.3)), cuboid(Vector3::new(0.6, 0.6, 0.6))),
            // One triangle whose corners are on a line.
            3 => (bumpy(10, 0.6, 0.2), segment(point(rng, 0.5), point(rng, 0.5))),
            _ => (primitives::cylinder(0.4, 1.0, 24).unwrap(), primitives::torus(1.0, 0.3, 24, 12).unwrap()),
        };
        let a = CollisionMesh::new(&a);
        let upright = Isometry3::from(Translation3::from(point(rng, 1.3)));
        let from = if rng.random_range(0..3) == 0 { upright } else { pose(rng, 1.3) };
        let along = point(rng, 0.05).coords;
        let at = |i: i32| Translation3::from(along * f64::from(i)) * from;
        Self {
            motion: RigidMotion::new(along, point(rng, 0.05).coords, a.radius()),
            poses: (0..20).map(at).collect(),
            here: if kind.is_multiple_of(2) { Isometry3::identity() } else { pose(rng, 0.5) },
            b: CollisionMesh::new(&b),
            a,
        }
    }

    fn answers(&self, query: &mut Query) -> Answers {
        let Self { a, b, here, poses, .. } = self;
        let at = &poses[0];
        let apart = query.distance(a, at, b, here);
        let d = apart.distance;
        let near = [1e-9, 0.5, 0.999, 1.0, 1.001, 2.0];
        Answers {
            triangles: query.intersecting_triangles(a, at, b, here),
            hit: query.intersects(a, at, b, here),
            within: near.map(|part| query.within(a, at, b, here, part * d)),
            clearance: near.map(|part| query.clearance(a, at, b, here, part * d)),
            escape: query.escape(a, at, b, here),
            first: query.first_collision(a, poses, b, here),
            check_interval: query.check_interval(a, at, &self.motion, b, here, 0.1),
            apart,
        }
    }
}

#[derive(Debug, PartialEq)]
struct Answers {
    apart: Separation,
    triangles: Option<(usize, usize)>,
    hit: bool,
    within: [bool; 6],
    clearance: [f64; 6],
    escape: Option<Vector3<f64>>,
    first: Option<usize>,
    check_interval: IntervalCheck,
}

#[test]
fn every_query_answers_alike_on_every_instruction_set() {
    let mut rng = rng(51);
    let mut hits = [0; 2];
    let cases = cases_of(120);
    for kind in 0..cases {
        let case = Case::new(&mut rng, kind);
        let expected = case.answers(&mut Query::with_isa(Isa::Scalar));
        hits[usize::from(expected.hit)] += 1;
        let mut fused: Option<(Isa, Counters)> = None;
        for isa in Isa::available() {
            let mut query = Query::with_isa(isa);
            let found = case.answers(&mut query);
            assert_eq!(found, expected, "{isa:?} {kind}");
            if let Isa::Avx2 | Isa::Avx512 = isa {
                let (first, counters) = *fused.get_or_insert((isa, query.counters));
                assert_eq!(query.counters, counters, "{isa:?} {first:?} {kind}");
            }
        }
    }
    assert!(hits[0] > cases / 4 && hits[1] > cases / 4, "{hits:?}");
}
