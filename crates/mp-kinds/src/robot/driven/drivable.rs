//! A robot that can be moved by inputs, behind a pointer: what drives it is compiled once for all kinds of robots.

use super::SpeedBound;
use crate::robot::motion::AnyChecker;
use crate::{Column, Error, Robot, TypedMotion};
use mp_cspace::{Configuration, Embed, Interrupt, MotionCheck, MotionValidity, nn::Layout};
use std::sync::Arc;

/// A [`SpeedBound`] behind a pointer.
pub trait Drivable: Robot {
    /// Whether the last number of a configuration is the time (s).
    fn is_timed(&self) -> bool;
    /// [`SpeedBound::speed_bound`].
    fn speed(&self, rates: &[f64]) -> f64;
    /// [`SpeedBound::degrees_of_freedom`].
    fn degrees(&self) -> Vec<Column>;
    /// The coordinates of its space, for nearest neighbours.
    fn layout(&self) -> Layout;
    /// Writes the coordinates of a configuration, and returns how many.
    fn embed(&self, q: &Configuration, out: &mut [f64]) -> usize;
    /// A verifier of single configurations.
    ///
    /// # Errors
    /// When the robot cannot be verified.
    fn state_verifier(&self) -> Result<AnyStateVerifier<'_>, Error>;
    /// The same robot with other ends.
    ///
    /// # Errors
    /// When it cannot have others.
    fn with_other_ends(
        &self,
        start: Configuration,
        goals: Vec<Configuration>,
    ) -> Result<Arc<dyn Drivable>, Error>;
    /// The same robot, whose start was given by this row.
    fn started_as(&self, row: &[f64]) -> Arc<dyn Drivable>;
    /// The same robot, which keeps a clearance (m).
    ///
    /// # Errors
    /// When it cannot keep one.
    fn that_keeps(&self, kept: f64) -> Result<Arc<dyn Drivable>, Error>;
    /// The checker of the same robot, which keeps a clearance (m).
    fn checker_that_keeps(&self, kept: f64) -> Option<AnyChecker>;
}

impl<K: SpeedBound> Drivable for K {
    fn is_timed(&self) -> bool {
        K::TIMED
    }
    fn speed(&self, rates: &[f64]) -> f64 {
        self.speed_bound(rates)
    }
    fn degrees(&self) -> Vec<Column> {
        self.degrees_of_freedom()
    }
    fn layout(&self) -> Layout {
        TypedMotion::space(self).layout()
    }
    fn embed(&self, q: &Configuration, out: &mut [f64]) -> usize {
        TypedMotion::space(self).embed(q, out)
    }
    fn state_verifier(&self) -> Result<AnyStateVerifier<'_>, Error> {
        Ok(AnyStateVerifier(Box::new(Of::<K>(self.verifier()?))))
    }
    fn with_other_ends(
        &self,
        start: Configuration,
        goals: Vec<Configuration>,
    ) -> Result<Arc<dyn Drivable>, Error> {
        Ok(Arc::new(self.with_ends(start, goals)?))
    }
    fn started_as(&self, row: &[f64]) -> Arc<dyn Drivable> {
        Arc::new(self.clone().starting_as(row))
    }
    fn that_keeps(&self, kept: f64) -> Result<Arc<dyn Drivable>, Error> {
        Ok(Arc::new(self.keeping(kept)?))
    }
    fn checker_that_keeps(&self, kept: f64) -> Option<AnyChecker> {
        self.checker_keeping(kept).map(AnyChecker::new)
    }
}

/// The methods of a verifier of configurations as a trait object.
trait StateVerifier: Send + Sync {
    fn boxed<'c>(&self) -> Box<dyn StateVerifier + 'c>
    where
        Self: 'c;
    fn check_state(&mut self, q: &Configuration, enough: f64) -> MotionCheck;
    fn interrupt_by(&mut self, interrupt: &Interrupt);
    fn is_interrupted(&mut self) -> bool;
}

/// The verifier of a kind of robot.
struct Of<'c, K: SpeedBound + 'c>(K::Verifier<'c>);

impl<K: SpeedBound> StateVerifier for Of<'_, K> {
    fn boxed<'c>(&self) -> Box<dyn StateVerifier + 'c>
    where
        Self: 'c,
    {
        Box::new(Self(self.0.clone()))
    }
    fn check_state(&mut self, q: &Configuration, enough: f64) -> MotionCheck {
        K::check_state(&mut self.0, q, enough)
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.0.interrupt_by(interrupt);
    }
    fn is_interrupted(&mut self) -> bool {
        self.0.is_interrupted()
    }
}

/// What the verifier of a robot says of single configurations.
#[allow(missing_debug_implementations, reason = "a pointer has nothing to print")]
pub struct AnyStateVerifier<'c>(Box<dyn StateVerifier + 'c>);

impl Clone for AnyStateVerifier<'_> {
    fn clone(&self) -> Self {
        Self((*self.0).boxed())
    }
}

impl AnyStateVerifier<'_> {
    /// [`SpeedBound::check_state`].
    pub(super) fn check_state(&mut self, q: &Configuration, enough: f64) -> MotionCheck {
        self.0.check_state(q, enough)
    }
    pub(super) fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.0.interrupt_by(interrupt);
    }
    pub(super) fn is_interrupted(&mut self) -> bool {
        self.0.is_interrupted()
    }
}
