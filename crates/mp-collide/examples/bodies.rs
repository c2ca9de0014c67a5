//! Two meshes, and a scene of many.
//!
//! `cargo run --release -p mp-collide --example bodies`

use std::error::Error;
use std::io::Write;

use mp_collide::{CollisionMesh, Query, Scene};
use mp_geom::primitives;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = std::io::stdout().lock();

    // Build a tree for each mesh, once. They are immutable, and cheap to clone.
    let ring = CollisionMesh::new(&primitives::torus(1.0, 0.3, 64, 32)?);
    let ball = CollisionMesh::new(&primitives::sphere(0.5, 3)?);

    // Scratch: one for each thread.
    let mut query = Query::default();

    // Two meshes, each at a pose in the world.
    let pose_wr = Isometry3::translation(0.0, 0.0, 0.0);
    for x in [0.0, 0.1, 0.2, 0.3] {
        let pose_wb = Isometry3::translation(x, 0.0, 0.0);
        let hit = query.intersects(&ring, &pose_wr, &ball, &pose_wb);
        let apart = query.distance(&ring, &pose_wr, &ball, &pose_wb);
        let near = query.within(&ring, &pose_wr, &ball, &pose_wb, 0.05);
        writeln!(out, "ball at x = {x} m: hit {hit}, distance {:.4} m, within 5 cm {near}", apart.distance)?;
    }

    // A scene: static bodies, and bodies that move.
    let (mut scene, mut rings) = (Scene::new(), Vec::new());
    for i in 0..10 {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::x() * 0.3 * f64::from(i));
        let pose_wb = Isometry3::from_parts(Vector3::new(1.5 * f64::from(i), 0.0, 0.0).into(), turn);
        rings.push(scene.insert(format!("ring {i}"), ring.clone(), pose_wb)?);
    }
    let cart = scene.insert_movable("cart", ball.clone(), Isometry3::translation(0.0, 0.0, 5.0))?;
    // Neighbouring rings may touch.
    for pair in rings.windows(2) {
        scene.allow_pair(pair[0], pair[1], true);
    }
    scene.merge_static(); // One tree of all rings.

    // A body of the scene, moved about.
    for x in [0.0, 0.75, 1.5, 15.0] {
        scene.move_body(cart, Isometry3::translation(x, 0.0, 0.0))?;
        let hit = scene.body_collides(&mut query, cart).and_then(|id| scene.body(id));
        let pairs = scene.colliding_pairs(&mut query).len();
        writeln!(out, "cart at x = {x} m: hits {:?}, {pairs} pairs in all", hit.map(|body| body.name()))?;
    }

    // A mesh that is no body of the scene: how far from the bodies, and which is the nearest?
    let pose_wm = Isometry3::translation(4.0, 2.0, 0.5);
    let (clearance, nearest) = scene.clearance(&mut query, &ball, &pose_wm, f64::INFINITY);
    let nearest = nearest.and_then(|id| scene.body(id)).map(|body| body.name());
    writeln!(out, "ball beside the rings: {clearance:.4} m from {nearest:?}")?;

    // Why not? Names and depths, for messages.
    for contact in scene.contacts(&mut query, &ball, &Isometry3::translation(3.4, 0.6, 0.0)) {
        writeln!(out, "contact with {:?}, about {:.3} m deep", contact.name, contact.depth)?;
    }

    writeln!(out, "{} triangles, {} bytes in memory", ring.triangle_count(), ring.memory())?;
    Ok(())
}
