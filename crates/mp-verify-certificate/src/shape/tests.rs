use super::*;
use parry3d_f64::query::distance;
use parry3d_f64::shape::Triangle;

/// A number that looks random, from -1 to 1.
fn drawn(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn body(vertices: Vec<[f64; 3]>, pieces: Vec<Vec<usize>>) -> Body {
    Body {
        name: "it".to_owned(),
        frame: 0,
        of_robot: true,
        radius: 0.0,
        radii: vec![],
        vertices,
        pieces,
        parts: vec![],
    }
}

/// As far apart as parry says, and no farther.
#[test]
fn triangles_are_apart_by_their_distance() {
    let mut state = 7;
    let mut shown = 0;
    for flat in [1.0, 1e-3, 1e-9, 0.0] {
        for _ in 0..500 {
            let mut corners = || -> Vec<[f64; 3]> {
                (0..3).map(|_| [drawn(&mut state), drawn(&mut state), flat * drawn(&mut state)]).collect()
            };
            let (a, b) = (corners(), corners());
            let shift =
                Pose::translation(1.5 * drawn(&mut state), 1.5 * drawn(&mut state), drawn(&mut state));
            let triangle = |c: &[[f64; 3]]| {
                let [p, q, r] = [c[0], c[1], c[2]].map(Vec3::from_array);
                Triangle::new(p, q, r)
            };
            let exact = distance(&Pose::IDENTITY, &triangle(&a), &shift, &triangle(&b)).unwrap().distance;
            let [a, b] = [a, b].map(|c| Shape::new(&body(c, vec![vec![0, 1, 2]])));
            let apart = |enough| a.apart(&Pose::IDENTITY, &b, &shift, enough);
            assert!(!apart(exact * (1.0 + 1e-6) + 1e-9), "{exact}");
            if exact > 1e-6 {
                assert!(apart(exact * (1.0 - 1e-6)), "{exact}");
                shown += 1;
            }
        }
    }
    assert!(shown > 1000, "{shown}");
}

/// The tree leaves out nothing: the answer is that of all pairs of pieces.
#[test]
fn a_tree_answers_as_all_its_pieces() {
    let mut state = 3;
    for _ in 0..200 {
        let mut soup = |n: usize| {
            let vertices = (0..3 * n).map(|i| {
                let place = [i / 3 % 4, i / 12, 0].map(|x| x as f64);
                place.map(|x| x + 0.4 * drawn(&mut state))
            });
            body(vertices.collect(), (0..n).map(|i| vec![3 * i, 3 * i + 1, 3 * i + 2]).collect())
        };
        let (a, b) = (soup(20), soup(13));
        let turn = Vec3::new(drawn(&mut state), drawn(&mut state), drawn(&mut state));
        let pose = Pose::new(Vec3::new(drawn(&mut state), drawn(&mut state), 2.0 * drawn(&mut state)), turn);
        let single = |body: &Body, piece: &[usize]| {
            Shape::new(&self::body(body.vertices.clone(), vec![piece.to_vec()]))
        };
        for enough in [1e-3, 0.1, 0.5] {
            let all = a.pieces.iter().all(|p| {
                b.pieces.iter().all(|q| single(&a, p).apart(&Pose::IDENTITY, &single(&b, q), &pose, enough))
            });
            assert_eq!(Shape::new(&a).apart(&Pose::IDENTITY, &Shape::new(&b), &pose, enough), all);
        }
    }
}
