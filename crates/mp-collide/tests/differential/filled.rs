//! Filled meshes in scenes: what is wholly inside collides.

use mp_collide::{CollisionMesh, FillError, Query, RigidMotion, Scene};
use mp_geom::TriMesh;
use mp_geom::primitives::{cuboid, sphere, torus};
use nalgebra::{Isometry3, Point3, Vector3};

use crate::common::{bumpy, pose, rng};

fn at(x: f64) -> Isometry3<f64> {
    Isometry3::translation(x, 0.0, 0.0)
}

fn cube(size: f64) -> TriMesh {
    cuboid(size, size, size).unwrap().into_surface()
}

#[test]
fn every_query_of_a_scene_knows_the_inside() {
    let (solid, shell) = (CollisionMesh::new(&cube(2.0)).filled().unwrap(), CollisionMesh::new(&cube(2.0)));
    let ball = sphere(0.3, 1).unwrap().into_surface();
    let full = CollisionMesh::new(&ball).filled().unwrap();
    let ball = CollisionMesh::new(&ball);
    let mut query = Query::default();
    assert!(solid.is_filled() && !shell.is_filled());
    // The obstacle filled and the robot not, the other way round where the ball is the obstacle, and neither.
    for (obstacle, robot, solid) in
        [(&solid, &ball, true), (&shell, &ball, false), (&ball, &solid, true), (&full, &shell, false)]
    {
        for movable in [false, true] {
            let mut scene = Scene::new();
            let id = match movable {
                true => scene.insert_movable("it", obstacle.clone(), at(5.0)),
                false => scene.insert("it", obstacle.clone(), at(5.0)),
            };
            let id = id.unwrap();
            for merged in [false, true] {
                if merged {
                    scene.merge_static();
                }
                let (inside, outside) = (at(5.1), at(8.0));
                let hit = solid.then_some(id);
                assert_eq!(scene.collide_body(&mut query, robot, &inside), hit);
                assert_eq!(scene.collides(&mut query, robot, &inside), solid);
                assert!(!scene.collides(&mut query, robot, &outside));
                let (clearance, nearest) = scene.clearance(&mut query, robot, &inside, 10.0);
                assert_eq!((clearance == 0.0, nearest), (solid, Some(id)));
                assert!(scene.clearance(&mut query, robot, &outside, 10.0).0 > 1.0);
                let poses = [outside, outside, inside, at(5.0 + 1.15)];
                let first = scene.first_collision(&mut query, robot, &poses);
                assert_eq!(first, Some((if solid { 2 } else { 3 }, id)));
                assert_eq!(scene.first_collision(&mut query, robot, &poses[..3]).is_some(), solid);
                let motion = RigidMotion::new(Vector3::new(0.0, 0.1, 0.0), Vector3::zeros(), robot.radius());
                assert_eq!(scene.check_interval(&mut query, robot, &inside, &motion, 0.0).is_free(), !solid);
                assert!(scene.check_interval(&mut query, robot, &outside, &motion, 0.0).is_free());
                let contacts = scene.contacts(&mut query, robot, &inside);
                assert_eq!(contacts.len(), usize::from(solid));
                // Out of a cube that reaches to 1 from a place at 0.1: 0.9 and the radius.
                assert!(contacts.iter().all(|c| (1.0..1.6).contains(&c.depth)), "{contacts:?}");
            }
            let other = scene.insert("robot", robot.clone(), at(5.1)).unwrap();
            assert_eq!(scene.body_collides(&mut query, other), solid.then_some(id));
            assert_eq!(scene.colliding_pairs(&mut query).len(), usize::from(solid));
            scene.remove(id).unwrap();
            assert!(!scene.collides(&mut query, &CollisionMesh::new(&cube(9.0)), &at(5.1)));
        }
    }
}

#[test]
fn parts_are_looked_at_one_by_one() {
    let solid = CollisionMesh::new(&cube(2.0)).filled().unwrap();
    let hollow = TriMesh::merged([&cube(2.0), &cube(1.0).reversed()]).unwrap();
    let hollow = CollisionMesh::new(&hollow).filled().unwrap();
    // One part far away, one in the middle; a point among them.
    let small = cube(0.2);
    let far = small.transformed(&at(7.0));
    let two = CollisionMesh::new(&TriMesh::merged([&far, &small]).unwrap());
    let point = TriMesh::from_soup(&[[Point3::origin(); 3]]).unwrap();
    let dust = CollisionMesh::new(&TriMesh::merged([&far, &point]).unwrap());
    let mut query = Query::default();
    for (mesh, inside) in [(&solid, true), (&hollow, false)] {
        let mut scene = Scene::new();
        scene.insert("it", mesh.clone(), Isometry3::identity()).unwrap();
        for robot in [&two, &dust] {
            assert_eq!(scene.collides(&mut query, robot, &at(0.1)), inside);
            assert!(!scene.collides(&mut query, robot, &at(3.0)));
            // In the wall of the hollow one.
            assert!(scene.collides(&mut query, robot, &at(0.75)));
        }
    }
}

/// Against the equation of a torus.
#[test]
fn random_poses_agree_with_an_equation() {
    let (outer, inner) = (torus(1.0, 0.45, 24, 12).unwrap(), bumpy(5, 0.2, 0.3));
    let around = CollisionMesh::new(&outer).filled().unwrap();
    let robot = CollisionMesh::new(&inner);
    let mut scene = Scene::new();
    let (mut rng, mut query) = (rng(11), Query::default());
    let id = scene.insert("it", around, Isometry3::identity()).unwrap();
    let mut seen = [0; 2];
    for _ in 0..2_000 {
        let pose = pose(&mut rng, 1.5);
        if query.intersects(scene.body(id).unwrap().mesh(), &Isometry3::identity(), &robot, &pose) {
            continue;
        }
        // Where the middle of the robot is, which is farther from the mesh than that is from the true torus.
        let p = pose.translation.vector;
        let inside = mp_math::hypot(mp_math::hypot(p.x, p.y) - 1.0, p.z) < 0.45;
        let hit = scene.collides(&mut query, &robot, &pose);
        assert_eq!(hit, inside, "{pose}");
        seen[usize::from(hit)] += 1;
    }
    assert!(seen.iter().all(|n| *n > 50), "{seen:?}");
}

#[test]
fn meshes_without_an_inside_are_refused() {
    let fill = |mesh: &TriMesh| CollisionMesh::new(mesh).filled().map(|_| ());
    let whole = cube(1.0);
    let part =
        |from: usize| TriMesh::new(whole.vertices().to_vec(), whole.triangles()[from..].to_vec()).unwrap();
    assert_eq!(fill(&part(1)), Err(FillError::Open { edges: 3 }));
    assert_eq!(fill(&whole.reversed()), Err(FillError::InsideOut));
    let touching =
        TriMesh::merged([&whole, &whole.transformed(&Isometry3::translation(1.0, 1.0, 1.0))]).unwrap();
    assert_eq!(fill(&touching), Err(FillError::NotManifold { edges: 0, vertices: 1 }));
    let mut turned = whole.triangles().to_vec();
    turned[0].swap(0, 1);
    let turned = TriMesh::new(whole.vertices().to_vec(), turned).unwrap();
    assert_eq!(fill(&turned), Err(FillError::NotOriented { edges: 3 }));
    let lost = whole.transformed(&Isometry3::translation(f64::NAN, 0.0, 0.0));
    assert!(fill(&lost).is_err());
}
