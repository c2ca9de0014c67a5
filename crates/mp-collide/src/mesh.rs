//! The mesh with its tree, which queries compare.

use mp_stop::{Interrupt, Interrupted};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3};

use crate::around::Outline;
use crate::bvh::{Tree, build::SMALL};
use crate::cloud::Cloud;
use crate::filled::Parts;
use crate::triangle::Triangle;

/// A mesh and its pose in the world.
pub(crate) type PosedMesh<'m> = (&'m CollisionMesh, &'m Isometry3<f64>);

/// A mesh with its tree of oriented boxes: built once, immutable, cheap to clone, shared between threads.
#[derive(Clone, Debug)]
pub struct CollisionMesh {
    /// Of a cloud: that of the box around the centres.
    pub(crate) tree: Arc<Tree>,
    /// If the mesh is balls.
    pub(crate) cloud: Option<Arc<Cloud>>,
    /// The triangles that bound solids: see [`TriMesh::solids`].
    pub(crate) solids: Arc<[Range<u32>]>,
    /// The connected components, made at the first use.
    pub(crate) parts: Arc<OnceLock<Parts>>,
    /// What is around it, found where it is first put into a scene.
    pub(crate) outline: Arc<OnceLock<Outline>>,
}

impl CollisionMesh {
    /// Builds the tree of `mesh`: O(n log² n) for n triangles. Its [solids](TriMesh::solids) are [filled](Self::is_filled).
    /// [Balls](TriMesh::balls) get a tree of their centres. Where there are triangles too, they are
    /// [faceted](TriMesh::faceted).
    #[must_use]
    pub fn new(mesh: &TriMesh) -> Self {
        match Self::of(mesh, &mut || Ok(())) {
            Ok(made) => made,
            Err(Interrupted) => unreachable!("nothing interrupts it"),
        }
    }

    /// As [`new`](Self::new); `None` when `interrupt` says to end.
    #[must_use]
    pub fn new_until(mesh: &TriMesh, interrupt: &Interrupt) -> Option<Self> {
        let mut interrupt = interrupt.clone();
        Self::of(mesh, &mut || interrupt.go_on()).ok()
    }

    fn of(mesh: &TriMesh, go_on: &mut dyn FnMut() -> Result<(), Interrupted>) -> Result<Self, Interrupted> {
        let count = mesh.triangles().len();
        if !mesh.balls().is_empty() {
            return match mesh.is_balls() {
                true => Self::of_cloud(mesh, go_on),
                false => Self::of(&mesh.faceted(), go_on),
            };
        }
        let made = if count > SMALL {
            Self::with_tree(count, &|i| mesh.triangle(i), go_on)?
        } else {
            // A copy in one piece is a little faster.
            let copied: Vec<Triangle> = (0..count).map(|i| mesh.triangle(i)).collect();
            Self::with_tree(count, &|i| copied[i], go_on)?
        };
        if let Some(corners) = mesh.vertices_of_few_parts() {
            made.parts.get_or_init(|| Parts::new(corners));
        }
        Ok(Self { solids: mesh.solids().into(), ..made })
    }

    fn of_cloud(
        mesh: &TriMesh,
        go_on: &mut dyn FnMut() -> Result<(), Interrupted>,
    ) -> Result<Self, Interrupted> {
        let _span = tracing::debug_span!("build", points = mesh.triangles().len()).entered();
        let balls: Vec<_> = mesh.each_ball().collect();
        let cloud = Cloud::build(&balls, go_on)?;
        let corners = cloud.corners();
        let around = Self::with_tree(8, &|i| [corners[i]; 3], go_on)?;
        Ok(Self { cloud: Some(Arc::new(cloud)), ..around })
    }

    /// Of `count` triangles, at least one and at most `u32::MAX`.
    ///
    /// # Errors
    /// That of `go_on`, which is called often.
    pub(crate) fn built<E>(
        count: usize,
        triangle: impl Fn(usize) -> Triangle,
        mut go_on: impl FnMut() -> Result<(), E>,
    ) -> Result<Self, E> {
        let mut error = None;
        let mut ask = || go_on().map_err(|e| error = Some(e)).map_err(|()| Interrupted);
        let made = Self::with_tree(count, &triangle, &mut ask);
        match (made, error) {
            (Ok(made), _) => Ok(made),
            (Err(_), Some(error)) => Err(error),
            (Err(Interrupted), None) => unreachable!("it ends by an error alone"),
        }
    }

    /// As [`built`](Self::built): compiled once for all closures.
    fn with_tree(
        count: usize,
        triangle: &dyn Fn(usize) -> Triangle,
        go_on: &mut dyn FnMut() -> Result<(), Interrupted>,
    ) -> Result<Self, Interrupted> {
        let _span = tracing::debug_span!("build", triangles = count).entered();
        let tree = Arc::new(Tree::build(count, triangle, go_on)?);
        let (solids, parts, outline) = Default::default();
        Ok(Self { tree, cloud: None, solids, parts, outline })
    }

    /// Whether both share one tree, and either both are solids or none: not whether they are equal.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.tree, &other.tree) && self.solids == other.solids
    }

    /// How many triangles there are, or balls.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.cloud.as_ref().map_or(self.tree.triangles.len(), |cloud| cloud.len())
    }

    /// The radius of its balls (m); 0 for triangles.
    #[must_use]
    pub fn rounding(&self) -> f64 {
        self.cloud.as_ref().map_or(0.0, |cloud| cloud.radius)
    }

    /// The triangles in the order of the mesh this was built from; balls by their centres.
    #[must_use]
    pub fn triangles(&self) -> Vec<Triangle> {
        if let Some(cloud) = &self.cloud {
            return cloud.centers().into_iter().map(|p| [p; 3]).collect();
        }
        let mut triangles = vec![[Point3::origin(); 3]; self.triangle_count()];
        for (triangle, &id) in self.tree.triangles.iter().zip(&self.tree.ids) {
            triangles[id as usize] = *triangle;
        }
        triangles
    }

    /// The largest distance of a point of the mesh from the origin of its frame (metres), rounded up.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.tree.radius + self.rounding()
    }

    /// Memory of tree and triangles (bytes).
    #[must_use]
    pub fn memory(&self) -> usize {
        self.tree.memory() + self.cloud.as_ref().map_or(0, |cloud| cloud.memory())
    }

    pub(crate) fn tree(&self) -> &Tree {
        &self.tree
    }
}
