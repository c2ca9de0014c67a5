//! The geometry of obstacles behind a pointer.

use crate::{
    Interrupt, Rng,
    obstacles::{BodyFeatures, BodySphere, ObstacleGeometry, ObstacleHints, PointOf},
};
use nalgebra::Vector3;
use std::fmt;

/// Obstacle geometry as a trait object that can be cloned.
trait ErasedGeometry<'c, S>: ObstacleGeometry<S> + Send + Sync {
    fn boxed(&self) -> Box<dyn ErasedGeometry<'c, S> + 'c>;
}

impl<'c, S, G: ObstacleGeometry<S> + Clone + Send + Sync + 'c> ErasedGeometry<'c, S> for G {
    fn boxed(&self) -> Box<dyn ErasedGeometry<'c, S> + 'c> {
        Box::new(self.clone())
    }
}

/// Any [`ObstacleGeometry`] behind a pointer.
pub struct AnyGeometry<'c, S>(Box<dyn ErasedGeometry<'c, S> + 'c>);

impl<'c, S> AnyGeometry<'c, S> {
    /// `geometry`, erased.
    pub fn new(geometry: impl ObstacleGeometry<S> + Clone + Send + Sync + 'c) -> Self {
        Self(Box::new(geometry))
    }
}

impl<S> Clone for AnyGeometry<'_, S> {
    fn clone(&self) -> Self {
        Self((*self.0).boxed())
    }
}

impl<S> fmt::Debug for AnyGeometry<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AnyGeometry").field("obstacles", &self.0.obstacles().len()).finish_non_exhaustive()
    }
}

impl<S> ObstacleHints<S> for AnyGeometry<'_, S> {
    fn touches(&mut self, q: &S) -> bool {
        self.0.touches(q)
    }
    fn slide_along(&mut self, from: &S, toward: &S, hit: Option<&S>, rng: &mut Rng) -> Option<S> {
        self.0.slide_along(from, toward, hit, rng)
    }
    fn moved_by(&self, q: &S, from: &S, to: &S) -> S {
        self.0.moved_by(q, from, to)
    }
}

impl<S> ObstacleGeometry<S> for AnyGeometry<'_, S> {
    fn prepare(&self, interrupt: &Interrupt) -> bool {
        self.0.prepare(interrupt)
    }
    fn obstacles(&self) -> &[BodySphere] {
        self.0.obstacles()
    }
    fn robot(&self) -> BodySphere {
        self.0.robot()
    }
    fn obstacle_features(&self, obstacle: usize) -> Option<BodyFeatures> {
        self.0.obstacle_features(obstacle)
    }
    fn robot_features(&self) -> BodyFeatures {
        self.0.robot_features()
    }
    fn touched_obstacle(&mut self, q: &S) -> Option<usize> {
        self.0.touched_obstacle(q)
    }
    fn obstacle_point(&self, obstacle: usize, of: PointOf, rng: &mut Rng) -> Option<Vector3<f64>> {
        self.0.obstacle_point(obstacle, of, rng)
    }
    fn robot_point(&self, of: PointOf, rng: &mut Rng) -> Vector3<f64> {
        self.0.robot_point(of, rng)
    }
    fn world_point(&self, q: &S, point: &Vector3<f64>) -> Vector3<f64> {
        self.0.world_point(q, point)
    }
    fn moved_to(&self, q: &S, point: &Vector3<f64>, place: &Vector3<f64>) -> S {
        self.0.moved_to(q, point, place)
    }
    fn aligned(&self, place: &Vector3<f64>, direction: &Vector3<f64>, angle: f64) -> S {
        self.0.aligned(place, direction, angle)
    }
    fn is_far(&self, q: &S) -> bool {
        self.0.is_far(q)
    }
}
