//! Meshes that stand still, as checkers and verifiers need them.

use crate::solid_obstacle::{SolidObstacle, is_solid};
use mp_collide::reference::RefMesh;
use mp_collide::{Body, BodyId, CollisionMesh, Query, Scene, SceneError};
use mp_cspace::{Interrupt, Interrupted};
use mp_geom::{Aabb, TriMesh};
use nalgebra::{Isometry3, Point3};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::{Arc, OnceLock};

/// The most triangles of robot and obstacles together: what a reference mesh can hold.
pub(crate) const MAX_TRIANGLES: usize = 1 << 30;

/// Obstacles with more triangles keep a tree of their own: one tree of all obstacles is faster only where they are many, and
/// would have to be built again when one of them is edited.
const MAX_MERGED: usize = 50_000;

/// Where all others have more triangles than this together, as a thousand spheres have, so do obstacles with more than [`FEW`] of them:
/// one tree of all takes more time and memory than they take themselves.
const MAX_TOGETHER: usize = 500_000;
const FEW: usize = 200;

/// More obstacles than this are one mesh for arms and their verifiers, whose tree says soon which of them are near. The trees of fewer ones
/// answer as fast, and making one of all may take longer than planning.
pub(crate) const MANY: usize = 64;

/// A mesh as verifiers see it, and its pose in the world.
pub(crate) type PlacedReference = (Arc<RefMesh>, Isometry3<f64>);

/// What is known of a mesh in its own frame, found at the first use.
#[derive(Debug, Default)]
struct Known {
    is_solid: OnceLock<bool>,
    /// The mesh for verifiers.
    reference: OnceLock<Arc<RefMesh>>,
}

/// Named obstacles that stand still. Clones of a robot share them.
#[derive(Debug)]
pub(crate) struct Obstacles {
    pub(crate) scene: Scene,
    /// Each obstacle, in the world frame.
    pub(crate) placed: Vec<(BodyId, Arc<TriMesh>)>,
    /// Each obstacle in its own frame. Equal ones share what is known of them.
    own: Vec<(TriMesh, Arc<Known>)>,
    /// The box around all of them; empty when there are none.
    pub(crate) bounds: Aabb,
    /// The obstacles that are solids, made at the first use.
    solids: OnceLock<Vec<(BodyId, SolidObstacle)>>,
    /// Made for the first verifier; `None` inside when there are no obstacles.
    reference: OnceLock<Option<Arc<RefMesh>>>,
    /// Each obstacle for verifiers, made for the first one that asks.
    references: OnceLock<Arc<[PlacedReference]>>,
}

impl Obstacles {
    /// The obstacles of a robot that has `triangles` triangles itself. Each obstacle is a name, a mesh and its pose in the
    /// world. The trees of meshes that `known` has are taken from there, and all of `known` if nothing differs. More than `many` get one
    /// tree of all.
    ///
    /// # Errors
    /// `too_many`, of the number of triangles, when there are more than [`MAX_TRIANGLES`]; when an obstacle cannot be placed, or
    /// `interrupt` says to end.
    pub(crate) fn new<E: From<SceneError> + From<Interrupted>>(
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
        (triangles, many): (usize, usize),
        too_many: impl Fn(usize) -> E,
        known: Option<&Arc<Self>>,
        interrupt: &Interrupt,
    ) -> Result<Arc<Self>, E> {
        let (mut scene, mut placed, mut own, mut count) = (Scene::new(), Vec::new(), Vec::new(), triangles);
        let (mut unchanged, mut asked) = (true, interrupt.clone());
        // Meshes that share their memory have one tree.
        let mut trees: HashMap<[usize; 4], (CollisionMesh, Arc<Known>)> = HashMap::new();
        let alike = known.map(|known| known.alike()).unwrap_or_default();
        let obstacles: Vec<_> = obstacles.into_iter().collect();
        let sizes = obstacles.iter().map(|(_, mesh, _)| mesh.triangles().len());
        let together = sizes.filter(|size| *size <= MAX_MERGED).fold(0, usize::saturating_add);
        let most = if together > MAX_TOGETHER { FEW } else { MAX_MERGED };
        for (i, (name, mesh, pose)) in obstacles.into_iter().enumerate() {
            count = count.saturating_add(mesh.triangles().len());
            if count > MAX_TRIANGLES {
                return Err(too_many(count));
            }
            asked.go_on()?;
            let same = known.and_then(|known| known.find([Some(i), alike.get(&look(&mesh)).copied()], &mesh));
            let (tree, own_known) = match same {
                Some((body, _, own_known)) => (body.mesh().clone(), Arc::clone(own_known)),
                None => match trees.entry(memory(&mesh)) {
                    Entry::Occupied(known) => known.get().clone(),
                    Entry::Vacant(new) => {
                        let tree = CollisionMesh::new_until(&mesh, interrupt).ok_or(Interrupted)?;
                        new.insert((tree, Arc::default())).clone()
                    }
                },
            };
            let in_world = match same {
                Some((body, in_world, _)) if *body.pose() == pose => Arc::clone(in_world),
                _ => Arc::new(mesh.transformed(&pose)),
            };
            unchanged &= known.is_some_and(|known| {
                known.placed.get(i).is_some_and(|(id, before)| {
                    Arc::ptr_eq(before, &in_world) && known.scene.body(*id).is_some_and(|b| b.name() == name)
                })
            });
            let id = match mesh.triangles().len() > most {
                true => scene.insert_movable(name, tree, pose)?,
                false => scene.insert(name, tree, pose)?,
            };
            placed.push((id, in_world));
            own.push((mesh, own_known));
        }
        if let Some(known) = known.filter(|known| unchanged && known.placed.len() == placed.len()) {
            return Ok(Arc::clone(known));
        }
        if placed.len() > many {
            scene.merge_static_until(interrupt)?;
        }
        let bounds = placed.iter().map(|(_, mesh)| mesh.aabb()).fold(Aabb::empty(), |a, b| a.union(&b));
        let (solids, reference, references) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
        Ok(Arc::new(Self { scene, placed, own, bounds, solids, reference, references }))
    }

    /// The first obstacle of each [`look`].
    fn alike(&self) -> HashMap<[u64; 4], usize> {
        self.own.iter().enumerate().rev().map(|(i, (mesh, _))| (look(mesh), i)).collect()
    }

    /// The first of some obstacles that has this mesh, the mesh in the world, and what is known of it.
    fn find(&self, some: [Option<usize>; 2], mesh: &TriMesh) -> Option<(&Body, &Arc<TriMesh>, &Arc<Known>)> {
        let same = |j: &usize| self.own.get(*j).is_some_and(|(own, _)| own == mesh);
        let j = some.into_iter().flatten().find(same)?;
        let (id, in_world) = &self.placed[j];
        Some((self.scene.body(*id)?, in_world, &self.own[j].1))
    }

    /// The obstacles whose meshes are closed surfaces without an inside, and have the point `p` of the world inside.
    pub(crate) fn around<'a>(
        &'a self,
        query: &'a mut Query,
        p: Point3<f64>,
    ) -> impl Iterator<Item = &'a str> {
        self.placed.iter().zip(&self.own).filter_map(move |((id, mesh), (own, known))| {
            let body = self.scene.body(*id)?;
            let inside = own.solids().is_empty()
                && query
                    .winding(body.mesh(), &body.pose().inverse_transform_point(&p))
                    .is_some_and(|n| n > 0)
                && *known.is_solid.get_or_init(|| is_solid(mesh));
            inside.then(|| body.name())
        })
    }

    /// The obstacles that have their first vertex inside of `surface` at `pose`.
    pub(crate) fn inside<'a>(
        &'a self,
        query: &'a mut Query,
        surface: &'a CollisionMesh,
        pose: &'a Isometry3<f64>,
    ) -> impl Iterator<Item = &'a str> {
        self.placed.iter().filter_map(move |(id, mesh)| {
            let p = pose.inverse_transform_point(mesh.vertices().first()?);
            let inside = query.winding(surface, &p).is_some_and(|n| n > 0);
            inside.then(|| self.scene.body(*id).map_or("", |body| body.name()))
        })
    }

    pub(crate) fn solids(&self) -> &[(BodyId, SolidObstacle)] {
        self.solids.get_or_init(|| {
            let named = self.placed.iter().zip(&self.own).filter_map(|((id, mesh), (_, known))| {
                let name = self.scene.body(*id)?.name();
                // Whether it is a solid does not depend on its pose.
                let solid = *known.is_solid.get_or_init(|| is_solid(mesh));
                solid.then(|| (*id, SolidObstacle::new(name, mesh)))
            });
            named.collect()
        })
    }

    /// All obstacles as one mesh for verifiers; `None` when there are no obstacles.
    pub(crate) fn reference(&self) -> Option<Arc<RefMesh>> {
        self.reference.get_or_init(|| self.merged().map(|mesh| Arc::new(RefMesh::new(&mesh)))).clone()
    }

    /// All obstacles as one mesh; `None` when there are none.
    fn merged(&self) -> Option<TriMesh> {
        TriMesh::merged(self.placed.iter().map(|(_, mesh)| &**mesh))
    }

    /// Makes the [`reference`](Self::reference), unless `interrupt` says to end.
    ///
    /// # Errors
    /// When it was interrupted.
    pub(crate) fn make_reference(&self, interrupt: &Interrupt) -> Result<(), Interrupted> {
        make_once(&self.reference, interrupt, || {
            let reference = |mesh: TriMesh| RefMesh::new_until(&mesh, interrupt).map(Arc::new);
            self.merged().map(|mesh| reference(mesh).ok_or(Interrupted)).transpose()
        })
        .map(drop)
    }

    /// The obstacles for verifiers, each in its own frame with its pose; one mesh of all where they are many.
    pub(crate) fn references(&self) -> Arc<[PlacedReference]> {
        // Nothing ends it.
        let _: Result<(), Interrupted> = self.make_references(&Interrupt::never());
        self.references.get().map_or_else(|| Arc::from([]), Arc::clone)
    }

    /// Makes the [`references`](Self::references), unless `interrupt` says to end.
    ///
    /// # Errors
    /// When it was interrupted.
    pub(crate) fn make_references(&self, interrupt: &Interrupt) -> Result<(), Interrupted> {
        make_once(&self.references, interrupt, || {
            let of = |mesh: &TriMesh| RefMesh::new_until(mesh, interrupt).map(Arc::new).ok_or(Interrupted);
            if self.placed.len() > MANY {
                return self.merged().iter().map(|mesh| Ok((of(mesh)?, Isometry3::identity()))).collect();
            }
            let own = self.placed.iter().zip(&self.own);
            own.map(|((id, in_world), (mesh, known))| match self.scene.body(*id) {
                Some(body) => {
                    let tree = make_once(&known.reference, interrupt, || of(mesh))?;
                    Ok((Arc::clone(tree), *body.pose()))
                }
                None => Ok((of(in_world)?, Isometry3::identity())),
            })
            .collect()
        })
        .map(drop)
    }

    /// The largest coordinate of the obstacles by magnitude; zero when there are none.
    pub(crate) fn farthest(&self) -> f64 {
        let Aabb { min, max } = &self.bounds;
        if self.bounds.is_empty() { 0.0 } else { min.coords.amax().max(max.coords.amax()) }
    }
}

/// The memory that a mesh shares with its clones.
fn memory(mesh: &TriMesh) -> [usize; 4] {
    let [vertices, triangles] = [mesh.vertices().as_ptr().addr(), mesh.triangles().as_ptr().addr()];
    [vertices, triangles, mesh.solids().as_ptr().addr(), mesh.balls().as_ptr().addr()]
}

/// Equal for equal meshes, and in constant time: the numbers of vertices and triangles, and the bits of the first vertex and of the last.
fn look(mesh: &TriMesh) -> [u64; 4] {
    let vertices = mesh.vertices();
    let bits = |p: Option<&Point3<f64>>| {
        p.map_or(0, |p| p.iter().fold(0, |all: u64, x| all.rotate_left(21) ^ x.to_bits()))
    };
    [vertices.len() as u64, mesh.triangles().len() as u64, bits(vertices.first()), bits(vertices.last())]
}

/// What `cell` holds. It is made if there is nothing yet, unless `interrupt` says to end.
///
/// # Errors
/// When it was interrupted.
pub(crate) fn make_once<'c, T>(
    cell: &'c OnceLock<T>,
    interrupt: &Interrupt,
    make: impl FnOnce() -> Result<T, Interrupted>,
) -> Result<&'c T, Interrupted> {
    if let Some(made) = cell.get() {
        return Ok(made);
    }
    interrupt.clone().go_on()?;
    let made = make()?;
    // Another thread may have been first, with the same.
    Ok(cell.get_or_init(|| made))
}

/// The tolerance `wanted`, or the least that coordinates as large as `farthest` can resolve, if that is more.
pub(crate) fn resolved_tolerance(wanted: f64, farthest: f64) -> f64 {
    let tolerance = wanted.max(1e-9 * farthest);
    if tolerance > 0.0 { tolerance } else { 1e-6 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives::cuboid;

    type Named = (String, TriMesh, Isometry3<f64>);

    fn made(obstacles: &[Named], known: Option<&Arc<Obstacles>>) -> Arc<Obstacles> {
        let too_many = |_| crate::RobotError::from(SceneError::Full);
        Obstacles::new(obstacles.iter().cloned(), (0, 0), too_many, known, &Interrupt::never()).unwrap()
    }

    /// Clones of a mesh have one tree, whatever their poses; equal meshes in other memory have their own.
    #[test]
    fn clones_of_a_mesh_share_a_tree() {
        let ball = |radius| mp_geom::primitives::sphere(radius, 2).unwrap();
        let (one, other, row) = (ball(0.1), ball(0.1), |i: usize| Isometry3::translation(i as f64, 0.0, 0.0));
        let named = |meshes: &[&TriMesh]| -> Vec<Named> {
            meshes.iter().enumerate().map(|(i, mesh)| (i.to_string(), (*mesh).clone(), row(i))).collect()
        };
        // What its tree is made of is all in one place.
        let trees = |meshes: &[&TriMesh]| -> Vec<usize> {
            let obstacles = made(&named(meshes), None);
            let alone: Vec<_> = obstacles.scene.bodies().map(|(_, body)| body.mesh().clone()).collect();
            let number = |mesh: &CollisionMesh| alone.iter().position(|known| known.is_same(mesh)).unwrap();
            alone.iter().map(number).collect()
        };
        let some = [&one, &other, &one, &one.clone(), &ball(0.2)];
        assert_eq!(trees(&some), [0, 1, 0, 0, 4]);
        let of_verifiers = made(&named(&some), None).references();
        let same = |(mesh, _): &PlacedReference| {
            of_verifiers.iter().position(|(known, _)| Arc::ptr_eq(known, mesh)).unwrap()
        };
        assert_eq!(of_verifiers.iter().map(same).collect::<Vec<_>>(), [0, 1, 0, 0, 4]);
        // Answers do not depend on it.
        let (shared, own) = (made(&named(&[&one, &one, &one]), None), {
            let copies = [ball(0.1), ball(0.1), ball(0.1)];
            made(&named(&[&copies[0], &copies[1], &copies[2]]), None)
        });
        let (mut query, probe) = (mp_collide::Query::default(), CollisionMesh::new(&ball(0.05)));
        for i in 0..60 {
            let at = Isometry3::translation(0.05 * f64::from(i), 0.12, 0.0);
            let clearance = |o: &Obstacles, query: &mut _| o.scene.clearance(query, &probe, &at, 1.0);
            assert_eq!(clearance(&shared, &mut query), clearance(&own, &mut query));
        }
    }

    /// A crowd of obstacles is as near as it is when it is one tree, and boxes among it still are one.
    #[test]
    fn a_crowd_is_not_one_tree() {
        let (ball, cube) = (mp_geom::primitives::sphere(0.1, 3).unwrap(), cuboid(0.1, 0.2, 0.1).unwrap());
        let crowd = |count: usize| -> Vec<Named> {
            let place =
                |i: usize| Isometry3::translation((i % 20) as f64, (i / 20) as f64, 0.5 * (i % 3) as f64);
            let mesh = |i: usize| if i.is_multiple_of(7) { cube.clone() } else { ball.clone() };
            (0..count).map(|i| (i.to_string(), mesh(i), place(i))).collect()
        };
        let (few, many) = (made(&crowd(300), None), made(&crowd(600), None));
        let movable = |o: &Obstacles| o.scene.bodies().filter(|(_, body)| body.is_movable()).count();
        assert_eq!((movable(&few), movable(&many)), (0, 600 - 600_usize.div_ceil(7)));
        let (mut query, probe) =
            (mp_collide::Query::default(), CollisionMesh::new(&cuboid(0.5, 0.1, 0.1).unwrap()));
        for i in 0..200 {
            // Among those that both have.
            let at = Isometry3::translation(0.1 * f64::from(i % 60), 0.05 * f64::from(i), 0.3);
            let [a, b] = [&few, &many].map(|o| o.scene.clearance(&mut query, &probe, &at, 0.4).0);
            assert!((a.min(0.4) - b.min(0.4)).abs() < 1e-9, "{i}: {a} {b}");
        }
    }

    /// What did not change is taken from the obstacles before; what changed is as if made anew.
    #[test]
    fn unchanged_obstacles_are_shared() {
        let cube = cuboid(1.0, 1.0, 1.0).unwrap();
        let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
        let before = ["a", "b", "c"].map(|name| (name.to_owned(), cube.clone(), at(name.len() as f64)));
        let known = made(&before, None);
        assert!(Arc::ptr_eq(&known, &made(&before, Some(&known))));

        let changes: [fn(&mut Vec<Named>); 5] = [
            |o| o[1].0 = "other".into(),
            |o| o[1].2 = Isometry3::translation(0.0, 5.0, 0.0),
            |o| o[1].1 = cuboid(1.0, 2.0, 1.0).unwrap(),
            |o| drop(o.remove(1)),
            |o| o.push(o[0].clone()),
        ];
        for change in changes {
            let mut after = before.to_vec();
            change(&mut after);
            let (shared, alone) = (made(&after, Some(&known)), made(&after, None));
            let [before, now] = [&known, &shared].map(|o| Arc::clone(&o.references()[0].0));
            assert!(Arc::ptr_eq(&before, &now), "as verifiers see it");
            assert!(!Arc::ptr_eq(&known, &shared));
            assert!(Arc::ptr_eq(&known.placed[0].1, &shared.placed[0].1));
            assert_eq!(shared.placed, alone.placed);
            assert_eq!(shared.bounds, alone.bounds);
            for (ours, theirs) in shared.scene.bodies().zip(alone.scene.bodies()) {
                assert_eq!((ours.1.name(), ours.1.pose()), (theirs.1.name(), theirs.1.pose()));
                assert_eq!(ours.1.mesh().triangles(), theirs.1.mesh().triangles());
            }
        }
    }
}
