//! Scenes against a loop over all bodies.

use mp_collide::{BodyId, CollisionMesh, Query, Scene, SceneError};
use nalgebra::{Isometry3, Vector3};
use rand::RngExt;

use crate::common::{Pcg64, bumpy, cuboid, pose, rng, soup};

fn random_scene(rng: &mut Pcg64, bodies: usize) -> Scene {
    let meshes = [
        CollisionMesh::new(&cuboid(Vector3::new(0.5, 0.2, 0.1))),
        CollisionMesh::new(&bumpy(6, 0.3, 0.2)),
        CollisionMesh::new(&soup(rng, 10, 0.4, 0.4)),
    ];
    let mut scene = Scene::new();
    for i in 0..bodies {
        let (name, mesh, at) = (format!("body {i}"), meshes[i % 3].clone(), pose(rng, 3.0));
        let id = if i % 4 == 0 { scene.insert_movable(name, mesh, at) } else { scene.insert(name, mesh, at) };
        assert_eq!(id.unwrap().index(), i);
    }
    scene
}

/// Compares every answer of the scene with a loop over its bodies; returns whether it was a hit.
fn check(scene: &Scene, mesh: &CollisionMesh, at: &Isometry3<f64>) -> bool {
    let mut query = Query::default();
    // Merging rounds the vertices to the world: near contact answers may differ by that.
    let rounding = 1e-13;
    let mut hits = Vec::new();
    let mut distances = Vec::new();
    for (id, body) in scene.bodies() {
        let distance = query.distance(mesh, at, body.mesh(), body.pose()).distance;
        distances.push((id, distance));
        if distance == 0.0 {
            hits.push(id);
        }
    }
    let least = distances.iter().map(|(_, d)| *d).fold(f64::INFINITY, f64::min);
    let near =
        |id: BodyId, d: f64| distances.iter().any(|(other, e)| *other == id && (e - d).abs() <= rounding);
    let hit = scene.collide_body(&mut query, mesh, at);
    assert!(hit.is_none_or(|id| hits.contains(&id)));
    assert_eq!(hit.is_some(), !hits.is_empty());
    assert_eq!(scene.collides(&mut query, mesh, at), hit.is_some());
    let contacts: Vec<BodyId> = scene.contacts(&mut query, mesh, at).iter().map(|c| c.body).collect();
    assert_eq!(contacts, hits);
    for enough in [0.0, 0.5 * least, 1.001 * least, 1.0, f64::INFINITY] {
        let (clearance, body) = scene.clearance(&mut query, mesh, at, enough);
        assert!(clearance <= least + rounding && clearance >= enough.min(least) - rounding);
        match body {
            Some(body) => assert!(near(body, clearance), "{body:?} {clearance} {distances:?}"),
            None => assert!(clearance >= enough && hits.is_empty(), "{clearance} {enough}"),
        }
    }
    hit.is_some()
}

#[test]
fn scenes_answer_as_a_loop_over_their_bodies_does() {
    let mut rng = rng(31);
    let mesh = CollisionMesh::new(&bumpy(7, 0.9, 0.1));
    let (mut hit, mut total) = (0, 0);
    for bodies in [1, 2, 7, 40] {
        let mut scene = random_scene(&mut rng, bodies);
        for step in 0..60 {
            match step {
                15 | 45 => {
                    scene.merge_static();
                    assert_eq!(scene.is_merged(), bodies > 1);
                }
                30 => {
                    // Movable bodies move under a merged tree; a static one undoes it.
                    scene.move_body(scene.find("body 0").unwrap(), pose(&mut rng, 1.0)).unwrap();
                    assert_eq!(scene.is_merged(), bodies > 1);
                    if let Some(id) = scene.find("body 1") {
                        scene.move_body(id, pose(&mut rng, 1.0)).unwrap();
                        assert!(!scene.is_merged());
                    }
                }
                50 => {
                    if let Some(id) = scene.find("body 5") {
                        assert_eq!(scene.remove(id).unwrap().name(), "body 5");
                        assert!(!scene.is_merged() && scene.body(id).is_none());
                    }
                }
                _ => {}
            }
            hit += usize::from(check(&scene, &mesh, &pose(&mut rng, 3.5)));
            total += 1;
        }
    }
    assert!(hit > total / 10 && hit < total * 9 / 10, "{hit} of {total} in collision");
}

#[test]
fn empty_scenes_are_free() {
    let scene = Scene::new();
    let mut query = Query::default();
    let mesh = CollisionMesh::new(&cuboid(Vector3::new(1.0, 1.0, 1.0)));
    let here = Isometry3::identity();
    assert!(scene.is_empty());
    assert_eq!(scene.collide_body(&mut query, &mesh, &here), None);
    assert_eq!(scene.clearance(&mut query, &mesh, &here, 1.0), (f64::INFINITY, None));
    assert!(scene.contacts(&mut query, &mesh, &here).is_empty());
    assert!(scene.colliding_pairs(&mut query).is_empty());
}

#[test]
fn allowed_pairs_may_overlap() {
    let mesh = CollisionMesh::new(&cuboid(Vector3::new(0.6, 0.1, 0.1)));
    let mut scene = Scene::new();
    let mut query = Query::default();
    // A chain: each box overlaps the next.
    let ids: Vec<BodyId> = (0..5)
        .map(|i| {
            scene.insert(format!("link {i}"), mesh.clone(), Isometry3::translation(f64::from(i), 0.0, 0.0))
        })
        .collect::<Result<_, _>>()
        .unwrap();
    let all: Vec<_> = ids.windows(2).map(|w| (w[0], w[1])).collect();
    assert_eq!(scene.colliding_pairs(&mut query), all);
    scene.allow_pair(ids[2], ids[1], true);
    assert!(scene.is_allowed(ids[1], ids[2]));
    assert_eq!(scene.colliding_pairs(&mut query), [all[0], all[2], all[3]]);
    assert_eq!(scene.body_collides(&mut query, ids[2]), Some(ids[3]));
    scene.allow_pair(ids[2], ids[3], true);
    assert_eq!(scene.body_collides(&mut query, ids[2]), None);
    scene.allow_pair(ids[2], ids[3], false);
    assert_eq!(scene.body_collides(&mut query, ids[2]), Some(ids[3]));
    scene.remove(ids[3]);
    assert_eq!(scene.body_collides(&mut query, ids[2]), None);
    assert_eq!(scene.move_body(ids[3], Isometry3::identity()), Err(SceneError::NoSuchBody { index: 3 }));
    assert_eq!(scene.colliding_pairs(&mut query), [all[0]]);
    scene.move_body(ids[0], Isometry3::translation(4.0, 0.0, 0.0)).unwrap();
    assert_eq!(scene.colliding_pairs(&mut query), [(ids[0], ids[4])]);
}

#[test]
fn random_scenes_find_all_colliding_pairs() {
    let mut rng = rng(33);
    let mut query = Query::default();
    for _ in 0..10 {
        let mut scene = random_scene(&mut rng, 60);
        let ids: Vec<BodyId> = scene.bodies().map(|(id, _)| id).collect();
        for _ in 0..200 {
            scene.allow_pair(ids[rng.random_range(0..60)], ids[rng.random_range(0..60)], true);
        }
        let mut expected = Vec::new();
        for (i, x) in scene.bodies() {
            for (j, y) in scene.bodies().filter(|(j, _)| i < *j) {
                if !scene.is_allowed(i, j) && query.intersects(x.mesh(), x.pose(), y.mesh(), y.pose()) {
                    expected.push((i, j));
                }
            }
            let partner = scene.body_collides(&mut query, i);
            let mut touches = |j: BodyId, y: &mp_collide::Body| {
                i != j && !scene.is_allowed(i, j) && query.intersects(x.mesh(), x.pose(), y.mesh(), y.pose())
            };
            let partners: Vec<BodyId> =
                scene.bodies().filter(|(j, y)| touches(*j, y)).map(|(j, _)| j).collect();
            assert_eq!(partner.is_some(), !partners.is_empty());
            assert!(partner.is_none_or(|p| partners.contains(&p)));
        }
        assert!(!expected.is_empty());
        assert_eq!(scene.colliding_pairs(&mut query), expected);
    }
}

#[test]
fn contacts_name_body_and_depth() {
    let mut scene = Scene::new();
    let slab = CollisionMesh::new(&cuboid(Vector3::new(5.0, 5.0, 0.5)));
    scene.insert("floor", slab.clone(), Isometry3::translation(0.0, 0.0, -0.5)).unwrap();
    scene.insert("ceiling", slab, Isometry3::translation(0.0, 0.0, 3.5)).unwrap();
    let ball = CollisionMesh::new(&bumpy(20, 0.5, 0.0));
    let mut query = Query::default();
    let contacts = scene.contacts(&mut query, &ball, &Isometry3::translation(1.0, 2.0, 0.4));
    assert_eq!(contacts.len(), 1);
    assert_eq!(contacts[0].name, "floor");
    assert!((contacts[0].depth - 0.1).abs() < 0.01, "{}", contacts[0].depth);
}

#[test]
fn what_has_no_place_collides_with_every_body() {
    let mesh = CollisionMesh::new(&cuboid(Vector3::new(0.5, 0.5, 0.5)));
    let nowhere = Isometry3::translation(f64::NAN, 0.0, 0.0);
    let mut scene = Scene::new();
    let mut query = Query::default();
    let wall = scene.insert("wall", mesh.clone(), Isometry3::identity()).unwrap();
    for _ in 0..2 {
        assert_eq!(scene.collide_body(&mut query, &mesh, &nowhere), Some(wall));
        assert_eq!(scene.clearance(&mut query, &mesh, &nowhere, 1.0), (0.0, Some(wall)));
        assert_eq!(scene.contacts(&mut query, &mesh, &nowhere).len(), 1);
        scene.merge_static();
    }
}

#[test]
fn threads_share_a_scene_and_get_the_same_answers() {
    let mut rng = rng(37);
    let mut scene = random_scene(&mut rng, 40);
    scene.merge_static();
    let mesh = CollisionMesh::new(&bumpy(7, 0.9, 0.1));
    let poses: Vec<Isometry3<f64>> = (0..100).map(|_| pose(&mut rng, 3.5)).collect();
    let answers = |scene: &Scene| -> Vec<_> {
        let mut query = Query::default();
        let answer =
            |p| (scene.collide_body(&mut query, &mesh, p), scene.clearance(&mut query, &mesh, p, 1.0));
        poses.iter().map(answer).collect()
    };
    let expected = answers(&scene);
    std::thread::scope(|threads| {
        let others: Vec<_> = (0..4).map(|_| threads.spawn(|| answers(&scene))).collect();
        // A clone may be changed meanwhile.
        let mut clone = scene.clone();
        let first = clone.bodies().next().map(|(id, _)| id).unwrap();
        clone.remove(first);
        for other in others {
            assert_eq!(other.join().unwrap(), expected);
        }
    });
    assert_eq!(answers(&scene), expected);
}
