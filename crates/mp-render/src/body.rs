//! Bodies at poses in the world.

use crate::error::{RenderError, check_range};
use crate::model::Model;
use mp_geom::TriMesh;
use nalgebra::Isometry3;
use std::sync::Arc;

/// A mesh made ready to be drawn, and its pose. Copies share the mesh.
#[derive(Clone, Debug)]
pub struct Body {
    pub(crate) model: Arc<Model>,
    pub(crate) pose_wb: Isometry3<f64>,
}

impl Body {
    /// The body `mesh` at `pose_wb` in the world.
    #[must_use]
    pub fn new(mesh: &TriMesh, pose_wb: Isometry3<f64>) -> Self {
        Self { model: Arc::new(Model::new(mesh)), pose_wb }
    }

    /// An invisible body, a point at the origin of `pose_wb`, for a robot without a mesh.
    #[must_use]
    pub fn point(pose_wb: Isometry3<f64>) -> Self {
        Self { model: Arc::new(Model::point()), pose_wb }
    }

    /// The same body at another pose.
    #[must_use]
    pub fn at(&self, pose_wb: Isometry3<f64>) -> Self {
        Self { model: Arc::clone(&self.model), pose_wb }
    }

    /// Its pose in the world.
    #[must_use]
    pub fn pose(&self) -> &Isometry3<f64> {
        &self.pose_wb
    }

    /// The distance of its farthest point from its origin, metres.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.model.radius
    }

    /// Refuses a body whose pose or mesh is out of range; `what` names the body.
    pub(crate) fn check(&self, what: impl FnOnce() -> String) -> Result<(), RenderError> {
        let translation = self.pose_wb.translation.vector;
        let rotation = self.pose_wb.rotation.coords;
        check_range(translation.iter().chain(&rotation).copied().chain([self.model.radius]), what)
    }
}
