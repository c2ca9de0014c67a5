//! Shapes of parry from and to ours, and parry as a third opinion on what they are.

use mp_collide::parry::{
    self, ParryError, Part, Shape, from_parry, mesh_from_parry, mesh_to_parry, point_from_parry,
    point_to_parry, pose_from_parry, pose_to_parry, solid_to_parry,
};
use mp_collide::{CollisionMesh, Query, Scene, Solid};
use mp_geom::{MeshError, TriMesh, primitives};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::query;
use parry3d_f64::shape::{self, SharedShape, TypedShape};
use proptest::prelude::*;
use rand::RngExt;

use crate::common::{Pcg64, bumpy, point, pose, rng, rotation};

/// How far parry's iterations may end from a distance, for sizes about 1.
const BAND: f64 = 1e-4;

fn only(shape: &dyn shape::Shape) -> Part {
    let parts = from_parry(shape).unwrap();
    assert_eq!(parts.len(), 1);
    parts.into_iter().next().unwrap()
}

fn solid(part: &Part) -> &Solid {
    let Shape::Solid(solid) = &part.shape else { panic!("{part:?} is no solid") };
    solid
}

fn mesh(part: &Part) -> &TriMesh {
    let Shape::Mesh { mesh, .. } = &part.shape else { panic!("{part:?} is no mesh") };
    mesh
}

fn turned(turn: UnitQuaternion<f64>, v: Vector) -> Vector3<f64> {
    turn * point_from_parry(v).coords
}

#[test]
fn solids_go_round() {
    let solids = [
        Solid::ball(0.3),
        Solid::capsule(0.2, 1.7),
        Solid::cuboid(0.1, 2.0, 3.3),
        Solid::cylinder(0.7, 0.1),
        Solid::cone(0.4, 5.3),
        Ok(Solid::half_space()),
    ];
    for given in solids.map(Result::unwrap) {
        let (there, pose_sp) = solid_to_parry(&given);
        let back = only(&*there);
        // The same sizes, to the bit: what they were made of is in the debug output.
        assert_eq!(format!("{given:?}"), format!("{:?}", solid(&back)));
        let pose = pose_from_parry(&pose_sp).unwrap() * back.pose;
        assert!((pose.to_homogeneous() - Isometry3::identity().to_homogeneous()).amax() < 1e-15, "{pose}");
    }
}

#[test]
fn poses_and_points_go_round_to_the_bit() {
    let mut rng = rng(71);
    for _ in 0..100 {
        let (given, p) = (pose(&mut rng, 3.0), point(&mut rng, 2.0));
        assert_eq!(pose_from_parry(&pose_to_parry(&given)).unwrap(), given);
        assert_eq!(point_from_parry(point_to_parry(&p)), p);
        let (ours, theirs) = (given * p, point_from_parry(pose_to_parry(&given) * point_to_parry(&p)));
        assert!((ours - theirs).norm() < 1e-14);
    }
}

#[test]
fn what_parry_gives_is_where_it_was() {
    let ways = [Vector::X, -Vector::X, Vector::Y, -Vector::Y, Vector::Z, -Vector::Z];
    let mut rng = rng(72);
    let random = (0..40).map(|_| point_to_parry(&Point3::from(rotation(&mut rng) * Vector3::z())));
    for way in ways.into_iter().chain(random).chain([Vector::new(1e-9, 0.0, -1.0)]) {
        // The half-space is below its plane, the capsule from one end to the other.
        for size in [1.0, 1e-200, 1e200] {
            let half_space = only(&shape::HalfSpace::new(way * size));
            let up = half_space.pose.rotation * Vector3::z();
            assert!((up - point_from_parry(way).coords).norm() < 1e-15, "{way} {up}");
        }
        let (a, b) = (Vector::new(1.0, 2.0, 3.0), Vector::new(1.0, 2.0, 3.0) + way * 0.6);
        let capsule = only(&shape::Capsule::new(a, b, 0.25));
        let expected = Solid::capsule(0.25, (point_from_parry(b) - point_from_parry(a)).norm()).unwrap();
        let (found, _) = solid_to_parry(solid(&capsule));
        let (TypedShape::Capsule(found), (expected, _)) = (found.as_typed_shape(), solid_to_parry(&expected))
        else {
            panic!("no capsule")
        };
        let expected = expected.as_capsule().unwrap();
        assert!((found.half_height() - expected.half_height()).abs() < 1e-15);
        let end = capsule.pose * point_from_parry(found.segment.b);
        assert!((end - point_from_parry(b)).norm() < 2e-15, "{end} {b}");
    }
    // Tip of the cone up along Y.
    let cone = only(&shape::Cone::new(1.0, 0.5));
    assert!((turned(cone.pose.rotation, Vector::Z) - Vector3::y()).norm() < 1e-15);
    // No length: a ball, where it is.
    let ball = only(&shape::Capsule::new(Vector::ONE, Vector::ONE, 0.25));
    assert_eq!(format!("{:?}", solid(&ball)), format!("{:?}", Solid::ball(0.25).unwrap()));
    assert_eq!(ball.pose, Isometry3::translation(1.0, 1.0, 1.0));
}

#[test]
fn meshes_go_round() {
    let given = bumpy(6, 1.0, 0.2);
    assert_eq!(mesh_from_parry(&mesh_to_parry(&given).unwrap()).unwrap(), given);
    assert_eq!(*mesh(&only(&mesh_to_parry(&given).unwrap())), given);
    // Flat and needle triangles are welcome on both sides.
    let corners = vec![Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(2.0, 0.0, 0.0)];
    let awkward = TriMesh::new(corners, vec![[0, 1, 2], [0, 0, 1], [2, 2, 2]]).unwrap();
    assert_eq!(mesh_from_parry(&mesh_to_parry(&awkward).unwrap()).unwrap(), awkward);
}

#[test]
fn lists_of_points_are_meshes() {
    let [a, b, c] = [Vector::ZERO, Vector::X, Vector::new(0.0, 2.0, 1.0)];
    let triangle = only(&shape::Triangle::new(a, b, c));
    assert_eq!(mesh(&triangle).triangle(0), [a, b, c].map(point_from_parry));
    let segment = only(&shape::Segment::new(a, c));
    assert_eq!(mesh(&segment).triangle(0), [a, c, c].map(point_from_parry));
    let line = only(&shape::Polyline::new(vec![a, b, c], None));
    assert_eq!((mesh(&line).vertices().len(), mesh(&line).triangles().len()), (3, 2));

    let heights = parry3d_f64::utils::Array2::new(2, 3, vec![0.0, 0.1, 0.2, 0.3, 0.4, 0.5]);
    let field = shape::HeightField::new(heights, Vector::new(4.0, 10.0, 2.0));
    let ground = only(&field);
    assert_eq!((mesh(&ground).vertices().len(), mesh(&ground).triangles().len()), (6, 4));
    assert!(mesh(&ground).vertices().contains(&Point3::new(2.0, 5.0, 1.0)));

    let voxels = only(&shape::Voxels::new(Vector::ONE, &[[0, 0, 0].into(), [1, 0, 0].into()]));
    assert!((mesh(&voxels).signed_volume() - 2.0).abs() < 1e-12);

    let cube = shape::ConvexPolyhedron::from_convex_hull(
        &primitives::cuboid(1.0, 2.0, 3.0).unwrap().vertices().iter().map(point_to_parry).collect::<Vec<_>>(),
    );
    let cube = only(&cube.unwrap());
    assert!(matches!(cube.shape, Shape::Mesh { filled: true, .. }));
    assert!((mesh(&cube).signed_volume() - 6.0).abs() < 1e-12);
    assert!(cube.shape.to_collision_mesh(0.1).unwrap().is_filled());
    assert!(!ground.shape.to_collision_mesh(0.1).unwrap().is_filled());
}

#[test]
fn bad_input_is_an_error() {
    let size = |shape: &dyn shape::Shape| assert!(matches!(from_parry(shape), Err(ParryError::Size(_))));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        size(&shape::Ball::new(bad));
        size(&shape::Cuboid::new(Vector::new(1.0, bad, 1.0)));
        size(&shape::Capsule::new_x(1.0, bad));
        size(&shape::Cone::new(1.0, bad));
        size(&shape::Cylinder { half_height: bad, radius: 1.0 });
    }
    for normal in [Vector::ZERO, Vector::NAN, Vector::new(f64::INFINITY, 0.0, 0.0)] {
        let error = from_parry(&shape::HalfSpace::new(normal)).unwrap_err();
        assert!(matches!(error, ParryError::BadNormal { .. }), "{error}");
    }
    for end in [Vector::NAN, Vector::INFINITY] {
        let error = from_parry(&shape::Capsule::new(Vector::ZERO, end, 1.0)).unwrap_err();
        assert_eq!(error, ParryError::BadPose);
    }
    for (at, turn) in [
        (Vector::NAN, Rotation::IDENTITY),
        (Vector::ZERO, Rotation::from_xyzw(0.0, 0.0, 0.0, 1.1)),
        (Vector::ZERO, Rotation::from_xyzw(0.0, f64::NAN, 0.0, 1.0)),
    ] {
        assert_eq!(pose_from_parry(&Pose::from_parts(at, turn)), Err(ParryError::BadPose));
    }
    let corners = vec![Vector::ZERO, Vector::X, Vector::Y];
    let endless = shape::TriMesh::new(vec![Vector::ZERO, Vector::X, Vector::NAN], vec![[0, 1, 2]]).unwrap();
    assert!(matches!(
        mesh_from_parry(&endless),
        Err(ParryError::Mesh(MeshError::NotFinite { vertex: 2, .. }))
    ));
    let round = shape::RoundCuboid { inner_shape: shape::Cuboid::new(Vector::ONE), border_radius: 0.1 };
    let line = "a cuboid with a round border of 0.1 m cannot be converted; convert its inner shape and ask \
                whether anything is within 0.1 m of that, or put a larger cuboid without border in its place";
    assert_eq!(from_parry(&round).unwrap_err().to_string(), line);

    let parts = vec![
        (Pose::IDENTITY, SharedShape::ball(1.0)),
        (Pose::IDENTITY, SharedShape::round_cylinder(1.0, 1.0, 0.1)),
    ];
    let error = from_parry(&shape::Compound::new(parts)).unwrap_err();
    assert!(matches!(error, ParryError::Part { part: 1, .. }), "{error}");
    assert!(error.to_string().starts_with("part 1 of a compound: a cylinder with a round border"), "{error}");
    let none = shape::Polyline::new(corners, Some(vec![]));
    assert_eq!(from_parry(&none).unwrap_err(), ParryError::Mesh(MeshError::Empty));

    let floor = Shape::Solid(Solid::half_space());
    assert_eq!(floor.to_mesh(0.1), Err(ParryError::Unbounded));
    for excess in [0.0, -1.0, f64::NAN, 1e-9] {
        for round in
            [Solid::ball(1.0), Solid::cylinder(1.0, 1.0), Solid::cone(1.0, 1.0), Solid::capsule(1.0, 1.0)]
        {
            let made = Shape::Solid(round.unwrap()).to_mesh(excess);
            assert!(matches!(made, Err(ParryError::Parameter { .. })), "{excess}");
        }
    }
}

#[test]
fn meshes_around_solids_hold_them_and_no_more() {
    let mut rng = rng(73);
    for excess in [1.0, 0.1, 0.01, 1e-4] {
        let solids = [
            Solid::ball(0.5),
            Solid::capsule(0.3, 1.0),
            Solid::cuboid(1.0, 0.2, 0.7),
            Solid::cylinder(0.6, 0.3),
            Solid::cone(0.4, 0.8),
        ];
        for solid in solids.map(Result::unwrap) {
            let shape = Shape::Solid(solid.clone());
            let around = shape.to_mesh(excess).unwrap();
            assert!(shape.to_collision_mesh(excess).unwrap().is_filled());
            let (there, pose_sp) = solid_to_parry(&solid);
            // Vertices are the farthest of the mesh; its faces are outside when the solid's points are inside of all.
            for v in around.vertices() {
                let apart = there.distance_to_point(&pose_sp, point_to_parry(v), true);
                assert!(apart <= excess + 1e-12, "{apart} {excess} {solid:?}");
            }
            for _ in 0..100 {
                let way = rotation(&mut rng) * Vector3::z();
                let map = there.as_support_map().unwrap();
                let support = map.support_point(&pose_sp, point_to_parry(&way.into()));
                let far = around.vertices().iter().map(|v| v.coords.dot(&way)).fold(f64::MIN, f64::max);
                assert!(far >= point_from_parry(support).coords.dot(&way) - 1e-12, "{solid:?}");
            }
            let faces = (0..around.triangles().len().min(2000)).map(|i| around.triangle(i));
            for [a, b, c] in faces {
                let Some(out) = (b - a).cross(&(c - a)).try_normalize(1e-20) else { continue };
                let map = there.as_support_map().unwrap();
                let support = point_from_parry(map.support_point(&pose_sp, point_to_parry(&out.into())));
                assert!((support - a).dot(&out) <= 1e-9, "{solid:?} {}", (support - a).dot(&out));
            }
        }
    }
}

fn any_solid(rng: &mut Pcg64) -> SharedShape {
    let [a, b, c] = [0; 3].map(|_| rng.random_range(0.05..0.6));
    match rng.random_range(0..6) {
        0 => SharedShape::ball(a),
        1 => SharedShape::capsule(point_to_parry(&point(rng, 0.5)), point_to_parry(&point(rng, 0.5)), a),
        2 => SharedShape::cuboid(a, b, c),
        3 => SharedShape::cylinder(a, b),
        4 => SharedShape::cone(a, b),
        _ => SharedShape::halfspace(point_to_parry(&Point3::from(rotation(rng) * Vector3::z()))),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// Compounds of parry at random poses: our distances of their parts are parry's.
    #[test]
    fn a_third_opinion_on_distances(seed in any::<u64>()) {
        let mut rng = rng(seed);
        let count = rng.random_range(1..4);
        let parts = (0..count).map(|_| (pose_to_parry(&pose(&mut rng, 1.0)), any_solid(&mut rng)));
        let parts: Vec<(Pose, SharedShape)> = parts.collect();
        let (pose_wc, pose_wm) = (pose(&mut rng, 1.0), pose(&mut rng, 1.5));
        let ours = bumpy(4, 0.4, 0.2);
        let theirs = mesh_to_parry(&ours).unwrap();
        let (tree, mut query) = (CollisionMesh::new(&ours), Query::default());

        let brought = from_parry(&shape::Compound::new(parts.clone())).unwrap();
        prop_assert_eq!(brought.len(), parts.len());
        for (part, (pose_cp, shape)) in brought.iter().zip(&parts) {
            let apart = query.solid_distance(&tree, &pose_wm, solid(part), &(pose_wc * part.pose)).distance;
            let (at, mesh_at) = (pose_to_parry(&pose_wc) * *pose_cp, pose_to_parry(&pose_wm));
            let expected = query::distance(&at, &**shape, &mesh_at, &theirs).unwrap().distance;
            // Distances come from below contact too: parry's meshes are hollow, so are ours.
            prop_assert!((apart - expected).abs() < BAND, "{} {} {:?}", apart, expected, part);
            if expected > BAND {
                prop_assert!(!query.solid_intersects(&tree, &pose_wm, solid(part), &(pose_wc * part.pose)));
            }
            // And as meshes around them, in a scene.
            if shape.as_halfspace().is_none() {
                let mut scene = Scene::new();
                let around = part.shape.to_collision_mesh(0.02).unwrap();
                scene.insert("part", around, pose_wc * part.pose).unwrap();
                let (near, _) = scene.clearance(&mut query, &tree, &pose_wm, f64::INFINITY);
                prop_assert!(near <= expected + BAND && near >= expected - 0.02 - BAND, "{} {}", near, expected);
            }
        }
    }
}

#[test]
fn a_decomposed_mesh_of_parry_comes_in() {
    let ring = primitives::torus(1.0, 0.3, 16, 8).unwrap();
    let vertices: Vec<_> = ring.vertices().iter().map(point_to_parry).collect();
    let decomposed = SharedShape::convex_decomposition(&vertices, ring.triangles());
    let parts = from_parry(&*decomposed).unwrap();
    assert!(parts.len() > 2);
    let mut scene = Scene::new();
    for part in &parts {
        scene.insert("ring", part.shape.to_collision_mesh(0.01).unwrap(), part.pose).unwrap();
    }
    let ball = CollisionMesh::new(&primitives::sphere(0.05, 1).unwrap());
    let mut query = Query::default();
    // In the hole, and inside of the tube.
    assert!(!scene.collides(&mut query, &ball, &Isometry3::identity()));
    assert!(scene.collides(&mut query, &ball, &Isometry3::translation(0.0, 1.0, 0.0)));
    assert!(parry::convex_hull(&ring).is_ok());
}
