//! Random sequences of changes to a scene, against a plain list of its bodies.

use std::collections::BTreeSet;

use mp_collide::{BodyId, CollisionMesh, Query, Scene};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

use crate::common::{bumpy, cuboid, rng, soup};

/// Merging rounds the vertices to the world: distances may differ by that.
const ROUNDING: f64 = 1e-13;

#[derive(Clone, Debug)]
enum Change {
    Insert { mesh: usize, movable: bool, pose: Isometry3<f64> },
    Move { body: usize, pose: Isometry3<f64> },
    Remove { body: usize },
    Allow { pair: (usize, usize), allowed: bool },
    Merge,
    Clone,
}

fn pose() -> impl Strategy<Value = Isometry3<f64>> {
    ([-1.2..1.2, -1.2..1.2, -1.2..1.2_f64], [-3.0..3.0, -3.0..3.0, -3.0..3.0_f64]).prop_map(|(t, r)| {
        Isometry3::from_parts(Translation3::from(t), UnitQuaternion::from_scaled_axis(Vector3::from(r)))
    })
}

fn change() -> impl Strategy<Value = Change> {
    let body = 0..1000_usize;
    prop_oneof![
        5 => (0..3_usize, any::<bool>(), pose())
            .prop_map(|(mesh, movable, pose)| Change::Insert { mesh, movable, pose }),
        3 => (body.clone(), pose()).prop_map(|(body, pose)| Change::Move { body, pose }),
        1 => body.clone().prop_map(|body| Change::Remove { body }),
        2 => (body.clone(), body, any::<bool>())
            .prop_map(|(x, y, allowed)| Change::Allow { pair: (x, y), allowed }),
        3 => Just(Change::Merge),
        1 => Just(Change::Clone),
    ]
}

struct Model {
    meshes: [CollisionMesh; 3],
    scene: Scene,
    bodies: Vec<(BodyId, usize, Isometry3<f64>)>,
    allowed: BTreeSet<(BodyId, BodyId)>,
    query: Query,
}

impl Model {
    fn new() -> Self {
        Self {
            meshes: [
                CollisionMesh::new(&cuboid(Vector3::new(0.5, 0.2, 0.1))),
                CollisionMesh::new(&bumpy(5, 0.3, 0.2)),
                CollisionMesh::new(&soup(&mut rng(7), 12, 0.4, 0.3)),
            ],
            scene: Scene::new(),
            bodies: Vec::new(),
            allowed: BTreeSet::new(),
            query: Query::default(),
        }
    }

    fn apply(&mut self, change: &Change) {
        let n = self.bodies.len();
        match *change {
            Change::Insert { mesh, movable, pose } => {
                let shape = self.meshes[mesh].clone();
                let insert = if movable { Scene::insert_movable } else { Scene::insert };
                let id = insert(&mut self.scene, "body", shape, pose).unwrap();
                self.bodies.push((id, mesh, pose));
            }
            Change::Merge => self.scene.merge_static(),
            Change::Clone => self.scene = self.scene.clone(),
            _ if n == 0 => {}
            Change::Move { body, pose } => {
                let body = &mut self.bodies[body % n];
                self.scene.move_body(body.0, pose).unwrap();
                body.2 = pose;
            }
            Change::Remove { body } => {
                let (id, ..) = self.bodies.remove(body % n);
                assert!(self.scene.remove(id).is_some());
                assert!(
                    self.scene.remove(id).is_none()
                        && self.scene.move_body(id, Isometry3::identity()).is_err()
                );
                self.allowed.retain(|(x, y)| *x != id && *y != id);
            }
            Change::Allow { pair: (x, y), allowed } => {
                let (x, y) = (self.bodies[x % n].0, self.bodies[y % n].0);
                self.scene.allow_pair(x, y, allowed);
                let pair = (x.min(y), x.max(y));
                if allowed {
                    self.allowed.insert(pair)
                } else {
                    self.allowed.remove(&pair)
                };
            }
        }
    }

    /// A mesh that is not in the scene, against every body.
    fn check_probe(&mut self, mesh: usize, at: &Isometry3<f64>) {
        let (scene, query, mesh) = (&self.scene, &mut self.query, &self.meshes[mesh]);
        let mut distances = Vec::new();
        for (id, own, pose) in &self.bodies {
            distances.push((*id, query.distance(mesh, at, &self.meshes[*own], pose).distance));
        }
        assert!(scene.bodies().map(|(id, _)| id).eq(distances.iter().map(|(id, _)| *id)));
        let hits: Vec<BodyId> = distances.iter().filter(|(_, d)| *d == 0.0).map(|(id, _)| *id).collect();
        let least = distances.iter().map(|(_, d)| *d).fold(f64::INFINITY, f64::min);
        let hit = scene.collide_body(query, mesh, at);
        assert_eq!(hit.is_some(), !hits.is_empty());
        assert!(hit.is_none_or(|id| hits.contains(&id)));
        assert_eq!(scene.first_collision(query, mesh, &[*at]), hit.map(|id| (0, id)));
        for enough in [0.0, 0.5 * least, 0.3, f64::INFINITY] {
            let (clearance, body) = scene.clearance(query, mesh, at, enough);
            assert!(clearance <= least + ROUNDING && clearance >= enough.min(least) - ROUNDING);
            assert_eq!(clearance == 0.0, !hits.is_empty());
            match body {
                Some(body) => {
                    assert!(distances.iter().any(|(id, d)| *id == body && (d - clearance).abs() <= ROUNDING))
                }
                None => assert!(clearance >= enough && hits.is_empty()),
            }
        }
    }

    /// The bodies against each other.
    fn check_pairs(&mut self) {
        let mut expected = Vec::new();
        for (i, (x, mesh_x, pose_x)) in self.bodies.iter().enumerate() {
            for (y, mesh_y, pose_y) in &self.bodies[i + 1..] {
                let (mesh_x, mesh_y) = (&self.meshes[*mesh_x], &self.meshes[*mesh_y]);
                if !self.allowed.contains(&(*x, *y)) && self.query.intersects(mesh_x, pose_x, mesh_y, pose_y)
                {
                    expected.push((*x, *y));
                }
            }
        }
        assert_eq!(self.scene.colliding_pairs(&mut self.query), expected);
        for (id, ..) in &self.bodies {
            let partner = self.scene.body_collides(&mut self.query, *id);
            let is_pair = |other: BodyId| expected.contains(&(other.min(*id), other.max(*id)));
            assert_eq!(partner.is_some(), expected.iter().any(|(x, y)| x == id || y == id));
            assert!(partner.is_none_or(is_pair));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 120, ..ProptestConfig::default() })]

    #[test]
    fn any_sequence_of_changes_leaves_a_scene_as_a_list_of_its_bodies(
        changes in proptest::collection::vec(change(), 1..60),
        probes in proptest::collection::vec((0..3_usize, pose()), 8),
    ) {
        let mut model = Model::new();
        for (step, change) in changes.iter().enumerate() {
            model.apply(change);
            let (mesh, at) = &probes[step % probes.len()];
            model.check_probe(*mesh, at);
            if step % 7 == 0 {
                model.check_pairs();
            }
        }
        model.scene.merge_static();
        for (mesh, at) in &probes {
            model.check_probe(*mesh, at);
        }
        model.check_pairs();
    }
}
