//! Queries allocate nothing once their scratch has grown; clones share trees.

use allocation_counter::measure;
use mp_collide::{CollisionMesh, Query, Scene};
use mp_geom::primitives;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn poses(count: usize, reach: f64) -> Vec<Isometry3<f64>> {
    let mut rng = Pcg64::seed_from_u64(61);
    let mut vector = |size: f64| Vector3::from([0; 3].map(|_| rng.random_range(-size..size)));
    (0..count)
        .map(|_| {
            let turn = UnitQuaternion::from_scaled_axis(vector(3.0));
            Isometry3::from_parts(Translation3::from(vector(reach)), turn)
        })
        .collect()
}

/// `work` with a new query, then again with the same one: how many hits, and what the second time allocated.
fn second_time(mut work: impl FnMut(&mut Query) -> usize) -> usize {
    let mut query = Query::default();
    let first = work(&mut query);
    let mut again = 0;
    let info = measure(|| again = work(&mut query));
    assert_eq!(first, again);
    assert_eq!(info.count_total, 0, "{info:?}");
    first
}

#[test]
fn queries_of_two_meshes_allocate_nothing_after_warm_up() {
    let a = CollisionMesh::new(&primitives::torus(1.0, 0.4, 60, 30).unwrap());
    let b = CollisionMesh::new(&primitives::sphere(0.5, 3).unwrap());
    let here = Isometry3::identity();
    let (poses, bad) = (poses(60, 1.6), Isometry3::translation(f64::NAN, 0.0, 0.0));
    let count = |test: &mut dyn FnMut(&Isometry3<f64>) -> bool| poses.iter().filter(|p| test(p)).count();
    let hits = second_time(|query| count(&mut |p| query.intersects(&a, &here, &b, p)));
    assert!(hits > 5 && hits < 55);
    second_time(|query| count(&mut |p| query.intersecting_triangles(&a, &here, &b, p).is_some()));
    second_time(|query| count(&mut |p| query.distance(&a, &here, &b, p).distance == 0.0));
    for enough in [0.0, 0.1, f64::INFINITY] {
        second_time(|query| count(&mut |p| query.clearance(&a, &here, &b, p, enough) < 0.1));
        second_time(|query| count(&mut |p| query.within(&a, &here, &b, p, enough)));
    }
    second_time(|query| query.first_collision(&b, &poses, &a, &here).unwrap_or(poses.len()));
    second_time(|query| usize::from(query.intersects(&a, &here, &b, &bad)));
    second_time(|query| usize::from(query.distance(&a, &bad, &b, &here).distance == 0.0));
}

#[test]
fn depths_allocate_nothing_after_warm_up() {
    let mesh = CollisionMesh::new(&primitives::torus(1.0, 0.4, 60, 30).unwrap());
    let (here, poses) = (Isometry3::identity(), poses(60, 1.6));
    second_time(|query| poses.iter().filter(|p| query.depth(&mesh, &here, &mesh, p) > 0.0).count());
}

#[test]
fn queries_of_sizes_that_do_not_fit_the_lanes_allocate_nothing() {
    let small = CollisionMesh::new(&primitives::sphere(1e-12, 1).unwrap());
    let here = Isometry3::identity();
    let poses = poses(20, 2e-12);
    let all = |query: &mut Query| {
        let hits = |p: &&Isometry3<f64>| query.intersects(&small, &here, &small, p);
        let hits = poses.iter().filter(hits).count();
        let far = |p: &&Isometry3<f64>| query.distance(&small, &here, &small, p).distance > 0.0;
        hits + 100 * poses.iter().filter(far).count()
    };
    assert!(second_time(all) > 100);
}

fn scene() -> Scene {
    let shapes = [
        CollisionMesh::new(&primitives::torus(0.6, 0.2, 24, 12).unwrap()),
        CollisionMesh::new(&primitives::sphere(0.4, 2).unwrap()),
    ];
    let mut scene = Scene::new();
    for (i, pose) in poses(40, 4.0).into_iter().enumerate() {
        let shape = shapes[i % 2].clone();
        let insert = if i % 3 == 0 { Scene::insert_movable } else { Scene::insert };
        insert(&mut scene, format!("body {i}"), shape, pose).unwrap();
    }
    scene
}

#[test]
fn queries_of_scenes_allocate_nothing_after_warm_up() {
    let mesh = CollisionMesh::new(&primitives::sphere(0.7, 3).unwrap());
    let mut scene = scene();
    let poses = poses(60, 4.0);
    for _ in 0..2 {
        let hits = second_time(|q| poses.iter().filter(|p| scene.collides(q, &mesh, p)).count());
        assert!(hits > 2 && hits < 58, "{hits}");
        second_time(|q| scene.first_collision(q, &mesh, &poses).map_or(0, |(i, _)| i));
        for enough in [0.0, 0.2, f64::INFINITY] {
            second_time(|q| poses.iter().filter(|p| scene.clearance(q, &mesh, p, enough).0 < 0.2).count());
        }
        second_time(|q| scene.bodies().filter(|(id, _)| scene.body_collides(q, *id).is_some()).count());
        scene.merge_static();
    }
}

#[test]
fn moving_bodies_allocates_nothing_after_the_first_move() {
    let mut scene = scene();
    scene.merge_static();
    let ids: Vec<_> = scene.bodies().filter(|(_, body)| body.is_movable()).map(|(id, _)| id).collect();
    let poses = poses(500, 4.0);
    scene.move_body(ids[0], poses[0]).unwrap();
    let info = measure(|| {
        for (i, pose) in poses.iter().enumerate() {
            scene.move_body(ids[i % ids.len()], *pose).unwrap();
        }
    });
    assert_eq!(info.count_total, 0, "{info:?}");
    assert!(scene.is_merged());
}

#[test]
fn clones_share_their_trees() {
    let mesh = CollisionMesh::new(&primitives::torus(1.0, 0.4, 100, 50).unwrap());
    assert_eq!(measure(|| drop(mesh.clone())).count_total, 0);
    let mut scene = Scene::new();
    for i in 0..10 {
        scene.insert("a", mesh.clone(), Isometry3::translation(f64::from(i), 0.0, 0.0)).unwrap();
    }
    scene.merge_static();
    let bytes = measure(|| drop(scene.clone())).bytes_total as usize;
    assert!(bytes < 10 * 1000 && bytes < mesh.memory() / 10, "{bytes}");
}
