//! Robots of all kinds behind one pointer.

use crate::certificate::{Certificate, certificate};
use crate::check::check;
use crate::explain::{check_ends, explain, lint};
use crate::path::state;
use crate::plan::plan;
#[cfg(all(feature = "ranks", feature = "roadmaps"))]
use crate::regional::AnyRegional;
use crate::run::AnyPrepared;
#[cfg(feature = "ranks")]
use crate::run::FoundRun;
#[cfg(feature = "roadmaps")]
use crate::scene_roadmap::AnySceneRoadmap;
use crate::sweep::{sweep, track};
use crate::{
    AnyKind, Body, Column, Configuration, Control, Error, Explanation, Finished, Length, PathFormat,
    PathRows, Report, Request, Sweep, Track, Verdict,
};
use mp_cspace::{Demand, Interrupt, Interrupted, Rng, Space, Validity};
use mp_geom::Aabb;
use mp_io::RigidProblem;
use nalgebra::{Isometry3, Point3};
use std::any::Any;
use std::path::{Path, PathBuf};
use std::sync::Arc;
#[cfg(feature = "ranks")]
use std::time::Duration;

/// A [`RobotKind`] behind a pointer.
pub(crate) trait AnyRobot: Send + Sync {
    fn name(&self) -> &str;
    fn space_name(&self) -> String;
    fn columns(&self) -> Vec<Column>;
    fn limits(&self) -> Vec<Option<[f64; 2]>>;
    fn details(&self) -> Vec<(String, String)>;
    fn free_share(&self, samples: u32, interrupt: &Interrupt) -> f64;
    fn path_format(&self) -> PathFormat;
    fn default_planner(&self) -> &'static str;
    fn demands(&self) -> &'static [Demand];
    fn moving_obstacles(&self) -> usize;
    fn start(&self) -> Vec<f64>;
    fn goals(&self) -> Vec<Vec<f64>>;
    fn with_ends(&self, start: &[f64], goals: &[Vec<f64>]) -> Result<Arc<dyn AnyRobot>, Error>;
    fn traced(&self, row: &[f64]) -> Result<Point3<f64>, Error>;
    fn plan(&self, request: &Request, control: &mut Control<'_>) -> Result<Report, Error>;
    fn routes(
        &self,
        request: &Request,
        count: usize,
        apart: Length,
        control: &mut Control<'_>,
    ) -> Result<Vec<Report>, Error>;
    fn prepare<'s>(&'s self, request: &'s Request) -> Result<Box<dyn AnyPrepared + 's>, Error>;
    /// The report of a run elsewhere, which took the time `time`: its path is finished here.
    #[cfg(feature = "ranks")]
    fn found_report(
        &self,
        request: &Request,
        found: FoundRun,
        time: Duration,
        control: &mut Control<'_>,
    ) -> Result<Report, Error>;
    #[cfg(feature = "roadmaps")]
    fn roadmap(
        self: Arc<Self>,
        request: &Request,
        control: &mut Control<'_>,
    ) -> Result<Box<dyn AnySceneRoadmap>, Error>;
    #[cfg(all(feature = "ranks", feature = "roadmaps"))]
    fn regional<'s>(&'s self, request: &'s Request) -> Result<Box<dyn AnyRegional + 's>, Error>;
    #[cfg(all(feature = "ranks", feature = "roadmaps"))]
    fn roadmap_of(
        self: Arc<Self>,
        request: &Request,
        map: Box<dyn Any + Send>,
    ) -> Result<Box<dyn AnySceneRoadmap>, Error>;
    fn finish(
        &self,
        path: &PathRows,
        request: &Request,
        control: &mut Control<'_>,
    ) -> Result<Finished, Error>;
    fn check(&self, path: &PathRows, interrupt: &Interrupt) -> Result<Verdict, Error>;
    fn certificate(
        &self,
        path: &PathRows,
        clearance: f64,
        interrupt: &Interrupt,
    ) -> Result<Certificate, Error>;
    fn certificate_differences(&self, certificate: &str) -> Result<Vec<String>, Error>;
    fn explain(&self, row: &[f64]) -> Result<Explanation, Error>;
    fn check_ends(&self) -> Result<Vec<String>, Error>;
    fn keeping(&self, kept: f64) -> Result<Arc<dyn AnyRobot>, Error>;
    fn kept(&self) -> f64;
    fn make_ready(&self, interrupt: &Interrupt) -> Result<(), Interrupted>;
    fn lint(&self) -> Vec<String>;
    fn bodies(&self) -> Vec<Body>;
    fn poses(&self, row: &[f64]) -> Result<Vec<Isometry3<f64>>, Error>;
    fn sweep(&self, path: Option<&PathRows>) -> Result<Sweep, Error>;
    fn track(&self, path: &PathRows) -> Result<Track, Error>;
    #[cfg(feature = "planar")]
    fn field(
        &self,
        field: &crate::RelaxField,
        row: &[f64],
        path: Option<&PathRows>,
        range: Option<&str>,
        cells: usize,
    ) -> Result<crate::FieldImage, Error>;
    fn export(&self, folder: &Path) -> Result<PathBuf, Error>;
    fn rigid_problem(&self) -> Option<&RigidProblem>;
    fn is_planar(&self) -> bool;
    fn picture_bounds(&self) -> Option<Aabb>;
    /// For front ends that need the kind itself.
    fn as_any(&self) -> &dyn Any;
}

/// A robot of one type of configuration.
pub(crate) struct OfState<S>(pub(crate) Arc<AnyKind<S>>);

impl<S: Configuration> AnyRobot for OfState<S> {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn space_name(&self) -> String {
        self.0.space_name()
    }
    fn columns(&self) -> Vec<Column> {
        self.0.columns()
    }
    fn limits(&self) -> Vec<Option<[f64; 2]>> {
        self.0.limits()
    }
    fn details(&self) -> Vec<(String, String)> {
        self.0.details()
    }
    fn free_share(&self, samples: u32, interrupt: &Interrupt) -> f64 {
        let (mut rng, mut checker) = (Rng::seed(1), self.0.any_checker());
        let mut interrupt = interrupt.clone();
        let tried = (0..samples).take_while(|_| !interrupt.ask());
        let free = tried.filter(|_| checker.is_valid(&self.0.any_space().sample_uniform(&mut rng))).count();
        free as f64 / f64::from(samples.max(1))
    }
    fn path_format(&self) -> PathFormat {
        self.0.path_format()
    }
    fn default_planner(&self) -> &'static str {
        self.0.default_planner()
    }
    fn demands(&self) -> &'static [Demand] {
        self.0.demands()
    }
    fn moving_obstacles(&self) -> usize {
        self.0.moving_obstacles()
    }
    fn start(&self) -> Vec<f64> {
        self.0.given_start()
    }
    fn goals(&self) -> Vec<Vec<f64>> {
        self.0.goals().iter().map(|goal| self.0.row(goal)).collect()
    }
    fn with_ends(&self, start: &[f64], goals: &[Vec<f64>]) -> Result<Arc<dyn AnyRobot>, Error> {
        if goals.is_empty() {
            return Err(Error::new("there is no goal").help("give at least one configuration as a goal"));
        }
        let goals = goals.iter().map(|goal| state(&*self.0, goal)).collect::<Result<_, _>>()?;
        Ok(Arc::new(Self(self.0.any_with_ends(state(&*self.0, start)?, goals, start)?)))
    }
    fn traced(&self, row: &[f64]) -> Result<Point3<f64>, Error> {
        Ok(self.0.traced(&state(&*self.0, row)?))
    }
    fn plan(&self, request: &Request, control: &mut Control<'_>) -> Result<Report, Error> {
        plan(&*self.0, request, control)
    }
    fn routes(
        &self,
        request: &Request,
        count: usize,
        apart: Length,
        control: &mut Control<'_>,
    ) -> Result<Vec<Report>, Error> {
        crate::routes::routes(&*self.0, request, count, apart, control)
    }
    fn prepare<'s>(&'s self, request: &'s Request) -> Result<Box<dyn AnyPrepared + 's>, Error> {
        crate::run::prepare(&*self.0, request)
    }
    #[cfg(feature = "ranks")]
    fn found_report(
        &self,
        request: &Request,
        found: FoundRun,
        time: Duration,
        control: &mut Control<'_>,
    ) -> Result<Report, Error> {
        crate::plan::found_report(&*self.0, request, found, time, control)
    }
    #[cfg(feature = "roadmaps")]
    fn roadmap(
        self: Arc<Self>,
        request: &Request,
        control: &mut Control<'_>,
    ) -> Result<Box<dyn AnySceneRoadmap>, Error> {
        crate::scene_roadmap::build(Arc::clone(&self.0), request, control)
    }
    #[cfg(all(feature = "ranks", feature = "roadmaps"))]
    fn regional<'s>(&'s self, request: &'s Request) -> Result<Box<dyn AnyRegional + 's>, Error> {
        crate::regional::regional(&*self.0, request)
    }
    #[cfg(all(feature = "ranks", feature = "roadmaps"))]
    fn roadmap_of(
        self: Arc<Self>,
        request: &Request,
        map: Box<dyn Any + Send>,
    ) -> Result<Box<dyn AnySceneRoadmap>, Error> {
        crate::scene_roadmap::of_map(Arc::clone(&self.0), request, map)
    }
    fn finish(
        &self,
        path: &PathRows,
        request: &Request,
        control: &mut Control<'_>,
    ) -> Result<Finished, Error> {
        crate::finish::finish_given(&*self.0, path, request, control)
    }
    fn check(&self, path: &PathRows, interrupt: &Interrupt) -> Result<Verdict, Error> {
        check(&*self.0, path, interrupt)
    }
    fn certificate(
        &self,
        path: &PathRows,
        clearance: f64,
        interrupt: &Interrupt,
    ) -> Result<Certificate, Error> {
        certificate(&*self.0, path, clearance, interrupt)
    }
    fn certificate_differences(&self, text: &str) -> Result<Vec<String>, Error> {
        crate::certificate::differences(&*self.0, text)
    }
    fn explain(&self, row: &[f64]) -> Result<Explanation, Error> {
        Ok(explain(&*self.0, &state(&*self.0, row)?))
    }
    fn check_ends(&self) -> Result<Vec<String>, Error> {
        check_ends(&*self.0)
    }
    fn keeping(&self, kept: f64) -> Result<Arc<dyn AnyRobot>, Error> {
        Ok(Arc::new(Self(self.0.any_keeping(kept)?)))
    }
    fn kept(&self) -> f64 {
        self.0.kept()
    }
    fn make_ready(&self, interrupt: &Interrupt) -> Result<(), Interrupted> {
        self.0.make_ready(interrupt)
    }
    fn lint(&self) -> Vec<String> {
        lint(&*self.0)
    }
    fn bodies(&self) -> Vec<Body> {
        self.0.bodies()
    }
    fn poses(&self, row: &[f64]) -> Result<Vec<Isometry3<f64>>, Error> {
        Ok(self.0.poses(&state(&*self.0, row)?))
    }
    fn sweep(&self, path: Option<&PathRows>) -> Result<Sweep, Error> {
        sweep(&*self.0, path)
    }
    fn track(&self, path: &PathRows) -> Result<Track, Error> {
        track(&*self.0, path)
    }
    #[cfg(feature = "planar")]
    fn field(
        &self,
        field: &crate::RelaxField,
        row: &[f64],
        path: Option<&PathRows>,
        range: Option<&str>,
        cells: usize,
    ) -> Result<crate::FieldImage, Error> {
        crate::field::field(&*self.0, field, row, path, range, cells)
    }
    fn export(&self, folder: &Path) -> Result<PathBuf, Error> {
        self.0.export(folder)
    }
    fn rigid_problem(&self) -> Option<&RigidProblem> {
        self.0.rigid_problem()
    }
    fn is_planar(&self) -> bool {
        self.0.is_planar()
    }
    fn picture_bounds(&self) -> Option<Aabb> {
        self.0.picture_bounds()
    }
    fn as_any(&self) -> &dyn Any {
        &*self.0
    }
}
