//! Trees saved and loaded.

use mp_collide::{CollisionMesh, Query, TreeError};
use mp_geom::{TriMesh, primitives};
use nalgebra::{Isometry3, Point3, Vector3};
use proptest::prelude::*;
use rand::RngExt;
use xxhash_rust::xxh3::xxh3_64;

use crate::common::{Pcg64, bumpy, cuboid, pose, rng, soup};

/// The header: magic, version, counts. Then the box around everything.
const VERTICES: usize = 28 + 120;

fn meshes(rng: &mut Pcg64) -> Vec<TriMesh> {
    let one = TriMesh::new(
        [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]].map(Point3::from).to_vec(),
        vec![[0, 1, 2]],
    );
    let far = bumpy(6, 1.0, 0.1).transformed(&Isometry3::translation(1e6, -1e6, 3e5));
    let zeros = vec![Point3::new(0.0, -0.0, 1.0), Point3::new(-0.0, 0.0, 1.0), Point3::new(1.0, 0.0, -0.0)];
    vec![
        one.unwrap(),
        cuboid(Vector3::new(1.0, 2.0, 0.5)),
        bumpy(30, 1.0, 0.2),
        soup(rng, 500, 1.0, 0.2),
        primitives::torus(1.0, 0.4, 24, 12).unwrap(),
        far,
        TriMesh::new(zeros, vec![[0, 1, 2], [2, 1, 0], [1, 1, 1]]).unwrap(),
    ]
}

/// Answers of `a` and `b` with `other`, bit for bit.
fn assert_same(a: &CollisionMesh, b: &CollisionMesh, other: &CollisionMesh, rng: &mut Pcg64) {
    assert_eq!(a.triangle_count(), b.triangle_count());
    assert_eq!(a.triangles(), b.triangles());
    assert_eq!(a.radius(), b.radius());
    assert_eq!(a.memory(), b.memory());
    assert_eq!(a.fingerprint(), b.fingerprint());
    let (mut query_a, mut query_b) = (Query::default(), Query::default());
    for _ in 0..60 {
        let (here, there) = (pose(rng, 0.5), pose(rng, 0.5 + 1.5 * a.radius()));
        let (x, y) = (&mut query_a, &mut query_b);
        assert_eq!(
            x.intersecting_triangles(a, &here, other, &there),
            y.intersecting_triangles(b, &here, other, &there)
        );
        assert_eq!(x.distance(a, &here, other, &there), y.distance(b, &here, other, &there));
        assert_eq!(x.distance(other, &here, a, &there), y.distance(other, &here, b, &there));
        assert_eq!(x.escape(a, &here, other, &there), y.escape(b, &here, other, &there));
        for enough in [0.0, 0.1, 1.0] {
            let clearance = x.clearance(a, &here, other, &there, enough);
            assert_eq!(clearance, y.clearance(b, &here, other, &there, enough));
        }
    }
    // Not only the answers: the way there too.
    assert_eq!(query_a.counters, query_b.counters);
}

#[test]
fn loaded_trees_are_the_built_ones() {
    let mut rng = rng(51);
    let other = CollisionMesh::new(&bumpy(9, 0.7, 0.2));
    for mesh in meshes(&mut rng) {
        let built = CollisionMesh::new(&mesh);
        let bytes = built.to_bytes();
        let loaded = CollisionMesh::from_bytes(&bytes).unwrap();
        assert_eq!(loaded.to_bytes(), bytes);
        assert_eq!(CollisionMesh::fingerprint_of(&mesh), loaded.fingerprint());
        assert_same(&built, &loaded, &other, &mut rng);
        assert!(mp_collide::fuzz::tree(&bytes));
    }
}

#[test]
fn trees_of_any_size_and_shape_come_back() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
    let triangles = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 4], [2, 3, 4], [1, 1, 1], [0, 0, 4]];
    let shape =
        |s: f64| TriMesh::new(corners.map(|p| Point3::from(p) * s).to_vec(), triangles.repeat(2)).unwrap();
    let sizes = [
        5e-324, 1e-310, 1e-300, 1e-160, 1e-75, 1e-46, 1e-20, 1e-9, 1e9, 1e20, 1e38, 1e39, 1e74, 1e76, 1e200,
        1e308,
    ];
    let slivers = (0..200_u32).map(|i| {
        let (t, thin) = (f64::from(i), 10.0_f64.powi(-(i as i32 % 18)));
        [[t.sin(), t.cos(), 0.3 * t], [t.sin() + thin, t.cos(), 0.3 * t], [2.0 * t.cos(), t, t.sin() + thin]]
    });
    let halves = (0..1000).map(|i| {
        let s = 0.5_f64.powi(i);
        [[s, 0.0, 0.0], [s, s, 0.0], [s, 0.0, s]]
    });
    let points = (0..500).map(|i| [[f64::from(i), 0.0, 0.0]; 3]);
    let same = (0..300).map(|_| [[3.0, 1.0, 2.0]; 3]);
    let soups = [slivers.collect::<Vec<_>>(), halves.collect(), points.collect(), same.collect()];
    let soups =
        soups.iter().map(|s| TriMesh::from_soup(&s.iter().map(|t| t.map(Point3::from)).collect::<Vec<_>>()));
    for mesh in sizes.map(shape).into_iter().chain(soups.map(Result::unwrap)) {
        let built = CollisionMesh::new(&mesh);
        let bytes = built.to_bytes();
        let loaded =
            CollisionMesh::from_bytes(&bytes).unwrap_or_else(|e| panic!("radius {}: {e}", built.radius()));
        assert_eq!(loaded.to_bytes(), bytes);
        assert!(mesh.triangles().len() > 20 || mp_collide::fuzz::tree(&bytes));
    }
}

#[test]
fn files_are_written_whole_and_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tree");
    let (mesh, other) = (bumpy(8, 1.0, 0.2), bumpy(9, 1.0, 0.2));
    let built = CollisionMesh::new(&mesh);
    built.save(&path).unwrap();
    CollisionMesh::new(&other).save(&path).unwrap();
    built.save(&path).unwrap();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(CollisionMesh::load(&path).unwrap().to_bytes(), built.to_bytes());
    assert!(CollisionMesh::load_for(&path, &mesh).is_ok());
    let error = CollisionMesh::load_for(&path, &other).unwrap_err();
    assert!(matches!(error.problem, TreeError::OtherMesh { found, .. } if found == built.fingerprint()));
    assert!(error.to_string().starts_with(&format!("{}: ", path.display())), "{error}");

    let problem = |path: &std::path::Path| CollisionMesh::load(path).unwrap_err().problem;
    assert!(matches!(problem(&folder.path().join("none")), TreeError::Io(_)));
    assert!(matches!(problem(folder.path()), TreeError::Io(_)));
    assert!(matches!(built.save(folder.path()).unwrap_err().problem, TreeError::Io(_)));
    assert!(matches!(built.save(folder.path().join("no/a")).unwrap_err().problem, TreeError::Io(_)));
    for cut in [0, 7, 8, 27, 28, 500, built.to_bytes().len() - 1] {
        std::fs::write(&path, &built.to_bytes()[..cut]).unwrap();
        assert!(matches!(problem(&path), TreeError::NotATree | TreeError::Length { .. }), "{cut}");
    }
    std::fs::write(&path, [built.to_bytes(), vec![0]].concat()).unwrap();
    assert!(matches!(problem(&path), TreeError::Length { .. }));
}

/// The bytes of the tree of a box with one word replaced, and the checksum set right.
fn with_word(at: usize, word: u32) -> Vec<u8> {
    let mut bytes = CollisionMesh::new(&cuboid(Vector3::new(1.0, 2.0, 3.0))).to_bytes();
    bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
    signed(bytes)
}

fn signed(mut bytes: Vec<u8>) -> Vec<u8> {
    let content = bytes.len() - 8;
    let checksum = xxh3_64(&bytes[..content]);
    bytes[content..].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

#[test]
fn the_header_is_as_documented() {
    let bytes = CollisionMesh::new(&cuboid(Vector3::new(1.0, 2.0, 3.0))).to_bytes();
    let header: Vec<String> = bytes[..28].iter().map(|b| format!("{b:02x}")).collect();
    insta::assert_snapshot!(format!("{} of {}", header.join(" "), bytes.len()), @"89 4d 50 54 0d 0a 1a 0a 01 00 00 00 08 00 00 00 0c 00 00 00 03 00 00 00 01 00 00 00 of 824");
}

#[test]
fn errors_say_what_was_expected_where() {
    let error = |at, word| CollisionMesh::from_bytes(&with_word(at, word)).unwrap_err().to_string();
    let triangles = VERTICES + 8 * 24;
    let order = triangles + 12 * 12;
    let leaves = order + 12 * 4;
    let nodes = leaves + 3 * 64;
    let errors = [
        error(0, 0),
        error(8, 2),
        error(12, 0),
        error(12, 9),
        error(16, 0),
        error(20, 13),
        error(24, 3),
        error(32, 0x7ff8_0000),
        error(VERTICES + 4, 0x7ff0_0000),
        error(VERTICES + 4, 0x40f0_0000),
        error(triangles, 8),
        error(order, 99),
        error(order, 11),
        error(leaves, 0),
        error(leaves, 9),
        error(leaves + 4, 0x7fc0_0000),
        error(leaves + 4 + 48, 0),
        error(nodes, 0x4100_0000),
        error(nodes + 60, 0),
        error(nodes + 60, 0x8000_0001),
        error(nodes + 60, 0xffff_ffff),
        error(nodes + 68, 0x8000_0000),
    ];
    insta::assert_snapshot!(errors.join("\n"), @r#"
    not a file of a collision tree: it does not begin with the bytes 89 4d 50 54 0d 0a 1a 0a
    byte 8: expected version 1 of the format, found 2; build the tree anew
    byte 12: expected at least one vertex, found 0
    expected 848 bytes from the counts in the header, found 824: cut off, or damaged
    byte 16: expected at least one triangle, found 0
    byte 20: expected at least one leaf, no more than triangles and 2³¹ − 1, found 13
    byte 24: expected fewer nodes than leaves, found 3
    byte 28: expected a box with orthonormal axes that is no larger than the mesh, found MeshObb { center: [NaN, 0.0, 0.0], axes: [[[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]], [[0.0, 0.0, 1.0]]], half: [[1.0, 2.0, 3.0]] }
    byte 148: expected finite coordinates, found [inf, -2.0, -3.0]
    byte 28: expected a box around all triangles below it, found corner {65536, -2, -3} outside
    byte 340: expected three numbers of vertices, found [8, 1, 2]
    byte 484: expected the number of a triangle, found 99
    byte 528: expected each triangle once, found 11 a second time
    byte 532: expected leaves of 1 to 8 triangles, all of them together, found 0
    byte 532: expected leaves of 1 to 8 triangles, all of them together, found 9
    byte 536: expected a box with orthonormal axes that is no larger than the mesh, found [[NaN, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [-3.0, 0.0, 0.0, 1.0]] [1.0000012, 2.0000014, 9.473946e-7]
    byte 536: expected a box around all triangles below it, found corner [-1.0, -2.0, -3.0] outside
    byte 724: expected a box with orthonormal axes that is no larger than the mesh, found [[8.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]] [1.0000012, 2.0000014, 3.000002]
    byte 784: expected children that are later nodes or leaves, and in no other node, found [0, 80000001, 80000002, ffffffff, ffffffff, ffffffff, ffffffff, ffffffff]
    byte 784: expected children that are later nodes or leaves, and in no other node, found [80000001, 80000001, 80000002, ffffffff, ffffffff, ffffffff, ffffffff, ffffffff]
    byte 784: expected two to eight children, then ffffffff, found [ffffffff, 80000001, 80000002, ffffffff, ffffffff, ffffffff, ffffffff, ffffffff]
    byte 784: expected children that are later nodes or leaves, and in no other node, found [80000000, 80000001, 80000000, ffffffff, ffffffff, ffffffff, ffffffff, ffffffff]
    "#);
    let mut damaged = CollisionMesh::new(&cuboid(Vector3::new(1.0, 2.0, 3.0))).to_bytes();
    damaged[VERTICES] ^= 1;
    assert!(
        matches!(CollisionMesh::from_bytes(&damaged), Err(TreeError::Checksum { at, .. }) if at as usize == damaged.len() - 8)
    );
}

/// How often each good file is spoilt.
fn iterations() -> usize {
    std::env::var("MP_FUZZ_ITERATIONS").ok().and_then(|n| n.parse().ok()).unwrap_or(3000)
}

#[test]
fn fuzz_no_bytes_give_a_panic_or_a_wrong_answer() {
    let mut rng = rng(52);
    let files: Vec<Vec<u8>> =
        [cuboid(Vector3::new(1.0, 2.0, 0.5)), bumpy(4, 1.0, 0.2), soup(&mut rng, 70, 1.0, 0.3)]
            .iter()
            .map(|mesh| CollisionMesh::new(mesh).to_bytes())
            .collect();
    let mut good = 0;
    for i in 0..iterations() {
        let mut bytes = files[i % files.len()].clone();
        for _ in 0..rng.random_range(1..4) {
            let at = rng.random_range(0..bytes.len() - 4);
            match rng.random_range(0..6) {
                0 => bytes[at] ^= 1 << rng.random_range(0..8),
                1 => bytes[at] = rng.random(),
                // Numbers that are close to what they were, or special.
                2 => {
                    let word = at & !3;
                    let old =
                        u32::from_le_bytes([bytes[word], bytes[word + 1], bytes[word + 2], bytes[word + 3]]);
                    let new = old.wrapping_add_signed(rng.random_range(-3..4));
                    bytes[word..word + 4].copy_from_slice(&new.to_le_bytes());
                }
                3 => {
                    let special =
                        [0, 1, 2, 8, !0, 1 << 31, (1 << 31) - 1, 0x7f80_0000, 0x7ff0_0000, 0x3f80_0000];
                    let word: u32 = special[rng.random_range(0..special.len())];
                    bytes[at & !3..(at & !3) + 4].copy_from_slice(&word.to_le_bytes());
                }
                4 => {
                    let from = rng.random_range(0..bytes.len() - 4) & !3;
                    bytes.copy_within(from..from + 4, at & !3);
                }
                _ => {
                    let length = if rng.random_bool(0.1) { at } else { bytes.len() };
                    bytes.truncate(length.max(8));
                }
            }
        }
        good += usize::from(mp_collide::fuzz::tree(&bytes));
        assert!(bytes.len() < 8 || CollisionMesh::from_bytes(&bytes).is_err() || files.contains(&bytes));
    }
    assert!(good > iterations() / 100, "only {good} were good");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn any_mesh_comes_back_the_same(
        corners in proptest::collection::vec([-1e3..1e3, -1.0..1.0, -1e-3..1e-3_f64], 3..40),
        triangles in proptest::collection::vec([0..1000_u32, 0..1000, 0..1000], 1..150),
        seed in any::<u64>(),
    ) {
        let n = corners.len() as u32;
        let triangles = triangles.iter().map(|t| t.map(|i| i % n)).collect();
        let mesh = TriMesh::new(corners.into_iter().map(Point3::from).collect(), triangles).unwrap();
        let built = CollisionMesh::new(&mesh);
        let loaded = CollisionMesh::from_bytes(&built.to_bytes()).unwrap();
        let other = CollisionMesh::new(&cuboid(Vector3::new(100.0, 0.1, 0.1)));
        assert_same(&built, &loaded, &other, &mut rng(seed));
    }
}
