//! A scene made ready to plan on.

use super::mover::Mover;
use crate::info::brief;
use crate::output::note;
use miette::{IntoDiagnostic, Result, WrapErr, miette};
use mp::collide::Query;
use mp::cspace::{Clearance, Space};
use mp::geom::{TriMesh, six_from_pose};
use mp::io::{Problem, SpaceKind};
use mp::robot::{Planar, RigidBody, Spatial, Verifier};
use nalgebra::Isometry3;
use std::path::Path;

/// A problem and everything made of it once, for all runs.
#[derive(Clone, Debug)]
pub(crate) struct Setting<M: Mover> {
    pub(crate) problem: Problem,
    pub(crate) space: M::Space,
    pub(crate) robot: RigidBody<M>,
    pub(crate) start: M::State,
    pub(crate) goal: M::State,
    /// Distance of the robot's farthest point from its origin, metres.
    pub(crate) radius: f64,
    /// Clearance that the certified check resolves, metres.
    pub(crate) tolerance: f64,
}

/// A setting of either kind.
#[derive(Clone, Debug)]
pub(crate) enum Ready {
    Space(Box<Setting<Spatial>>),
    Plane(Box<Setting<Planar>>),
}

impl Ready {
    /// Reads the scene `file` and makes it ready.
    pub(crate) fn load(file: &Path) -> Result<Self> {
        Self::of(Problem::load(file)?).wrap_err_with(|| format!("cannot plan in {}", file.display()))
    }

    /// Makes `problem` ready.
    pub(crate) fn of(problem: Problem) -> Result<Self> {
        Ok(match problem.space {
            SpaceKind::Se3 => Self::Space(Box::new(Setting::new(problem)?)),
            SpaceKind::Se2 => Self::Plane(Box::new(Setting::new(problem)?)),
        })
    }

    /// What overlaps what: the robot at start and goal with obstacles, and obstacles with each other.
    pub(crate) fn overlaps(&self) -> Vec<String> {
        match self {
            Self::Space(setting) => setting.overlaps(),
            Self::Plane(setting) => setting.overlaps(),
        }
    }

    /// An error when start or goal is not free: names the bodies in the way and the nearest free configuration.
    pub(crate) fn check_ends(&self) -> Result<()> {
        match self {
            Self::Space(setting) => setting.check_ends(),
            Self::Plane(setting) => setting.check_ends(),
        }
        .wrap_err_with(|| format!("cannot plan in {}", self.name()))
    }

    pub(crate) fn problem(&self) -> &Problem {
        match self {
            Self::Space(setting) => &setting.problem,
            Self::Plane(setting) => &setting.problem,
        }
    }

    /// The largest distance in the space, in the default metric.
    pub(crate) fn extent(&self) -> f64 {
        match self {
            Self::Space(setting) => setting.space.extent(),
            Self::Plane(setting) => setting.space.extent(),
        }
    }

    /// Writes the problem to `folder` as one JSON and two OFF files for other planners; returns the former.
    pub(crate) fn export(&self, folder: &Path) -> Result<std::path::PathBuf> {
        Ok(mp::io::export_ompl(self.problem(), folder, self.name(), &mp::io::OmplExport::default())?)
    }

    pub(crate) fn name(&self) -> &str {
        &self.problem().name
    }
}

impl<M: Mover> Setting<M> {
    pub(crate) fn new(problem: Problem) -> Result<Self> {
        let space = M::space(&problem.position_bounds())?;
        let obstacles = problem.obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose));
        let robot = RigidBody::<M>::among(&problem.robot.mesh, obstacles).into_diagnostic()?;
        let (start, goal) = (M::configuration(&problem.start), M::configuration(&problem.goal));
        let radius = if robot.radius() > 0.0 { robot.radius() } else { 1e-3 * space.extent() };
        let tolerance = robot.tolerance();
        Ok(Self { problem, space, robot, start, goal, radius, tolerance })
    }

    /// The independent checker.
    pub(crate) fn verifier(&self) -> Result<Verifier<'_, M::Space, M>> {
        Verifier::new(&self.space, &self.robot).into_diagnostic()
    }

    /// A hash of the scene, the robot and the name of the metric.
    pub(crate) fn fingerprint(&self, metric: &str) -> u64 {
        let problem = &self.problem;
        let bounds = problem.position_bounds();
        let mut numbers: Vec<f64> = [bounds.min, bounds.max].iter().flat_map(|p| [p.x, p.y, p.z]).collect();
        numbers.push(f64::from(u8::from(problem.space == SpaceKind::Se2)));
        numbers.extend(metric.bytes().map(f64::from));
        let mut mesh = |mesh: &TriMesh, pose: &Isometry3<f64>| {
            numbers.push(mesh.vertices().len() as f64);
            numbers.extend(mesh.vertices().iter().flat_map(|p| [p.x, p.y, p.z]));
            numbers.extend(mesh.triangles().iter().flatten().map(|&i| f64::from(i)));
            numbers.extend(pose.to_homogeneous().iter());
        };
        mesh(&problem.robot.mesh, &Isometry3::identity());
        problem.obstacles.iter().for_each(|o| mesh(&o.mesh, &o.pose));
        mp::roadmap::fingerprint(numbers)
    }

    fn overlaps(&self) -> Vec<String> {
        let mut found = Vec::new();
        for (end, q) in [("start", &self.start), ("goal", &self.goal)] {
            let touching = self.touching(q);
            if !touching.is_empty() {
                found.push(format!("the {end} is in collision with {}", touching.join(", ")));
            }
            let around = self.robot.enclosing(q);
            if touching.is_empty() && !around.is_empty() {
                found.push(format!("the {end} is inside of {}", around.join(", ")));
            }
        }
        let scene = self.robot.scene();
        let name = |id| scene.body(id).map_or("?", |body| body.name());
        let pairs = scene.colliding_pairs(&mut Query::default());
        let named: Vec<String> =
            pairs.iter().take(5).map(|(a, b)| format!("{} and {}", name(*a), name(*b))).collect();
        let more =
            if pairs.len() > 5 { format!(" and {} more pairs", pairs.len() - 5) } else { String::new() };
        if !named.is_empty() {
            found.push(format!("obstacles touch each other: {}{more}", named.join(", ")));
        }
        found
    }

    /// The obstacles that the robot touches at `q`, and how deep.
    pub(crate) fn touching(&self, q: &M::State) -> Vec<String> {
        let contacts = self.robot.clone().explain(q);
        contacts.iter().map(|c| format!("{} ({} m deep)", c.name, brief(c.depth))).collect()
    }

    fn check_ends(&self) -> Result<()> {
        self.check_end("start", &self.start)?;
        self.check_end("goal", &self.goal)?;
        let inside = [&self.start, &self.goal].map(|q| self.robot.enclosing(q));
        if inside[0] != inside[1] {
            let [start, goal] = inside.map(|names| match names.is_empty() {
                true => "outside of all solids".to_owned(),
                false => format!("inside of {}", names.join(", ")),
            });
            let name = &self.problem.name;
            note(&format!("warning: {name}: the start is {start}, the goal {goal}: there may be no way"));
        }
        Ok(())
    }

    fn check_end(&self, end: &str, q: &M::State) -> Result<()> {
        if !self.space.contains(q) {
            return Err(miette!(
                help = "move it, or widen the bounds",
                "the {end} is out of bounds: {}",
                self.written(q)
            ));
        }
        let mut robot = self.robot.clone();
        let clearance = robot.clearance(q, self.tolerance);
        if clearance >= self.tolerance {
            return Ok(());
        }
        let touching = self.touching(q);
        let what = match touching.is_empty() {
            true => format!(
                "the {end} is {} m from contact: at least {} m is needed",
                brief(clearance),
                brief(self.tolerance)
            ),
            false => format!("the {end} is in collision with {}", touching.join(", ")),
        };
        let help = match robot.nearest_free(q, &self.space, 2.0 * self.tolerance) {
            Some(free) => format!("the nearest free configuration found is {}", self.written(&free)),
            None => "no free configuration was found nearby: is the scene in metres, the robot in its frame?"
                .into(),
        };
        Err(miette!(help = help, "{what}"))
    }

    /// `q` as a scene file has it.
    fn written(&self, q: &M::State) -> String {
        six_from_pose(&M::pose(q)).map(|v| ((v * 1e9).round() / 1e9 + 0.0).to_string()).join(" ")
    }
}
