//! Robots among obstacles that move: time is a dimension of planning.

use super::model::{ModelBody, MotionModel};
use super::{
    Appearance, Body, BodyShape, Checker, Column, Contact, Description, Deviation, DrivenScene, End,
    Measured, Motion, SpeedBound, no_metric,
};
use crate::goals::{GoalPart, examples};
use crate::numbers::told_apart;
use crate::robot::motion::TypedMotion;
use crate::{Error, MetricName, brief, plain};
use mp_cspace::space_time::SpaceTime;
use mp_cspace::{
    AsVectors, Clearance, Configuration, Demand, Embed, Factored, Interrupt, Interrupted, MotionCheck,
    MotionValidity, OnVectors, Space, StateVector,
};
use mp_geom::Aabb;
use mp_io::{Driven, Timing};
use mp_robot::Trajectory;
use nalgebra::{Isometry3, Point3};
use std::fmt::Debug;

/// The ends of a path match start and goal if their times differ by no more, seconds.
const TIME_TOLERANCE: f64 = 1e-3;

/// A kind of robot that can be among obstacles that move.
pub trait WithMoving:
    Motion + Description + Appearance + TypedMotion + Clone + Debug + Send + Sync + 'static
{
    /// Where it is: what the numbers of a configuration say.
    type Place: StateVector + Clone + Debug + PartialEq + Send + Sync;
    /// The space of its places, without time.
    type Places: Factored + Space<State = Self::Place> + Embed + Clone + Send + Debug + 'static;
    /// The robot among all of them: what planners check places at times with.
    type Among: Checker<(Self::Place, f64)> + Debug + 'static;
    /// The independent check of finished paths.
    type AmongVerifier<'c>: MotionValidity<(Self::Place, f64)> + Clone + Send + Sync
    where
        Self: 'c;

    /// The space of its places.
    fn places(&self) -> &Self::Places;
    /// A verifier in a space of positions and times.
    ///
    /// # Errors
    /// When the robot cannot be verified.
    fn among_verifier<'c>(
        &'c self,
        space: &'c SpaceTime<Self::Places>,
        among: &Self::Among,
    ) -> Result<Self::AmongVerifier<'c>, Error>;
    /// What the verifier says of a single moment, as [`SpeedBound::check_state`].
    fn check_moment<'c>(
        verifier: &mut Self::AmongVerifier<'c>,
        q: &(Self::Place, f64),
        _enough: f64,
    ) -> MotionCheck
    where
        Self: 'c,
    {
        verifier.check_motion(q, q)
    }
    /// The same among all of them, keeping the clearance `kept` (m).
    fn among_keeping(among: &Self::Among, kept: f64) -> Self::Among;
    /// The speed (m/s) that no point of a moving obstacle ever exceeds.
    fn obstacle_speed(among: &Self::Among) -> f64;
    /// The trajectories of the moving obstacles.
    fn trajectories(among: &Self::Among) -> Vec<&Trajectory>;
    /// The poses of the moving obstacles in the world at `time` (s).
    fn obstacle_poses(among: &Self::Among, time: f64) -> Vec<Isometry3<f64>>;
    /// The indices of the moving obstacles that the robot touches.
    fn touched(among: &mut Self::Among, q: &(Self::Place, f64)) -> Vec<usize>;
}

/// A robot among obstacles of which some move on known trajectories. A configuration is that of the robot, and a time.
#[derive(Clone, Debug)]
pub struct MovingScene<K: WithMoving> {
    still: K,
    among: OnVectors<K::Among, (K::Place, f64)>,
    obstacles: Vec<Body>,
    space: AsVectors<SpaceTime<K::Places>>,
    start: Configuration,
    goals: Vec<Configuration>,
    /// What the goals ask of each number, the time last.
    goal_parts: Vec<Vec<GoalPart>>,
}

/// The state of a robot at a time.
type Moment<K> = (<K as WithMoving>::Place, f64);

impl<K: WithMoving> MovingScene<K> {
    /// The robot of `still` among its obstacles, and also among `obstacles`, each with the name and shape of a body, which move
    /// as `among` knows, the last of them until the time `last` (s). Its goals are those of `still`, at a time as `timing` says.
    ///
    /// # Errors
    /// When the times or the speed are not valid, or there is no speed.
    pub fn new(
        still: K,
        among: K::Among,
        obstacles: Vec<Body>,
        timing: &Timing,
        last: f64,
    ) -> Result<Self, Error> {
        let Some(speed) = timing.speed else {
            return Err(Error::new("obstacles move, and the robot has no speed").help("say how fast it is"));
        };
        // Time to wait until nothing moves, and then to go around everything; or until the goal, if that is later.
        let around = 2.0 * still.places().extent() / speed;
        let usual = last.max(timing.start) + around;
        let horizon = timing.horizon.unwrap_or(match timing.goal {
            Some([from, to]) if from > usual => to.min(from + around),
            _ => usual,
        });
        let space = AsVectors(SpaceTime::new(still.places().clone(), horizon, speed)?);
        let start = timed(still.start(), timing.start);
        let exactly = |q: &Configuration| still.row(q).into_iter().map(GoalPart::Exactly).collect();
        let parts =
            still.goal_parts().map_or_else(|| still.goals().iter().map(exactly).collect(), <[_]>::to_vec);
        let arrival =
            GoalPart::Between(timing.goal.unwrap_or([timing.start, horizon]).map(|t| t.min(horizon)));
        let goal_parts = with_time(parts, arrival);
        let among = OnVectors::new(among);
        let goals = vec![start.clone()];
        let mut scene = Self { still, among, obstacles, space, start, goals, goal_parts };
        scene.goals = examples(&scene, &scene.goal_parts);
        Ok(scene)
    }

    /// The robot among the obstacles that stand still.
    #[must_use]
    pub fn still(&self) -> &K {
        &self.still
    }

    /// The configuration of the robot alone.
    fn alone(&self, q: &Configuration) -> Configuration {
        match q.split_last() {
            Some((_, numbers)) => numbers.into(),
            None => self.still.start().clone(),
        }
    }
}

fn time(q: &Configuration) -> f64 {
    q.last().copied().unwrap_or(0.0)
}

fn timed(q: &Configuration, time: f64) -> Configuration {
    q.iter().copied().chain([time]).collect()
}

fn with_time(mut goals: Vec<Vec<GoalPart>>, time: GoalPart) -> Vec<Vec<GoalPart>> {
    goals.iter_mut().for_each(|goal| goal.push(time));
    goals
}

impl<K: WithMoving<Checker: Debug> + SpeedBound> MovingScene<K> {
    /// The same robot among the same obstacles, moved by inputs. It starts with `velocity`, or at rest when that is empty. `goals`
    /// say what is asked of each number of the configuration without the time, then of the velocities.
    ///
    /// # Errors
    /// When the robot cannot move so.
    pub fn driven(
        self,
        driven: &Driven,
        velocity: &[f64],
        mut goals: Vec<Vec<GoalPart>>,
    ) -> Result<DrivenScene, Error> {
        let own = self.still.columns().len();
        for (goal, timed) in goals.iter_mut().zip(&self.goal_parts) {
            goal.insert(own.min(goal.len()), timed.last().copied().unwrap_or(GoalPart::Free));
        }
        DrivenScene::new(self, driven, velocity, goals)
    }
}

impl<K: WithMoving<Checker: Debug> + SpeedBound> SpeedBound for MovingScene<K> {
    const TIMED: bool = true;

    fn speed_bound(&self, rates: &[f64]) -> f64 {
        self.still.speed_bound(rates) + K::obstacle_speed(self.among.inner())
    }
    fn check_state<'c>(verifier: &mut Self::Verifier<'c>, q: &Configuration, enough: f64) -> MotionCheck
    where
        Self: 'c,
    {
        match q.to() {
            Some(moment) => K::check_moment(verifier.inner_mut(), &moment, enough),
            None => MotionCheck::Unproven { at: 0.0 },
        }
    }
    fn degrees_of_freedom(&self) -> Vec<Column> {
        self.still.degrees_of_freedom()
    }
}

impl<K: WithMoving> TypedMotion for MovingScene<K> {
    type Space = AsVectors<SpaceTime<K::Places>>;
    type Checker = OnVectors<K::Among, Moment<K>>;
    type Verifier<'c>
        = OnVectors<K::AmongVerifier<'c>, Moment<K>>
    where
        Self: 'c;
    fn space(&self) -> &Self::Space {
        &self.space
    }
    /// The times of the goals are of no account: the robot may arrive whenever the scene says.
    fn with_ends(&self, start: Configuration, goals: Vec<Configuration>) -> Result<Self, Error> {
        let first = self.alone(&start);
        let positions: Vec<Configuration> = goals.iter().map(|q| self.alone(q)).collect();
        let exactly = |q: &Configuration| self.still.row(q).into_iter().map(GoalPart::Exactly).collect();
        let parts = positions.iter().map(exactly).collect();
        let time = self.goal_parts.first().and_then(|goal| goal.last()).copied().unwrap_or(GoalPart::Free);
        let still = self.still.with_ends(first, positions)?;
        let mut scene = Self { still, start, goal_parts: with_time(parts, time), ..self.clone() };
        scene.goals = examples(&scene, &scene.goal_parts);
        Ok(scene)
    }
    fn checker(&self) -> &Self::Checker {
        &self.among
    }
    fn verifier(&self) -> Result<Self::Verifier<'_>, Error> {
        Ok(OnVectors::new(self.still.among_verifier(&self.space.0, self.among.inner())?))
    }
    fn starting_as(mut self, row: &[f64]) -> Self {
        let own = self.still.given_start().len().min(row.len());
        self.still = self.still.starting_as(&row[..own]);
        self
    }
    fn keeping(&self, kept: f64) -> Result<Self, Error> {
        let among = OnVectors::new(K::among_keeping(self.among.inner(), kept));
        Ok(Self { still: self.still.keeping(kept)?, among, ..self.clone() })
    }
    fn checker_keeping(&self, kept: f64) -> Option<Self::Checker> {
        Some(OnVectors::new(K::among_keeping(self.among.inner(), kept)))
    }
}

impl<K: WithMoving> Motion for MovingScene<K> {
    fn start(&self) -> &Configuration {
        &self.start
    }
    fn goals(&self) -> &[Configuration] {
        &self.goals
    }
    fn goal_parts(&self) -> Option<&[Vec<GoalPart>]> {
        Some(&self.goal_parts)
    }
    fn can_move(&self, from: &Configuration, to: &Configuration) -> bool {
        match (from.to(), to.to()) {
            (Some(from), Some(to)) => self.space.0.can_move(&from, &to),
            _ => false,
        }
    }
    fn demands(&self) -> &'static [Demand] {
        &[Demand::OneWay]
    }
    fn default_planner(&self) -> &'static str {
        "rrt"
    }
    fn make_ready(&self, interrupt: &Interrupt) -> Result<(), Interrupted> {
        self.still.make_ready(interrupt)
    }
    fn tolerance(&self) -> f64 {
        self.still.tolerance()
    }
    fn kept(&self) -> f64 {
        self.still.kept()
    }
    fn accuracy(&self) -> f64 {
        self.still.accuracy()
    }
    fn shortcut_clearance(&self) -> f64 {
        self.still.shortcut_clearance()
    }
    fn measured(&self, metric: MetricName) -> Result<Measured<'_>, Error> {
        match metric {
            MetricName::Default => Ok(Measured::by_coordinates(&self.space)),
            _ => Err(no_metric(metric, "a robot among obstacles that move", &[MetricName::Default])),
        }
    }
    fn nearest_free(&self, q: &Configuration) -> Option<Configuration> {
        let free = timed(&self.still.nearest_free(&self.alone(q))?, time(q));
        let enough = 2.0 * self.tolerance();
        (self.among.clone().clearance(&free, enough) >= enough).then_some(free)
    }
}

impl<K: WithMoving> Description for MovingScene<K> {
    fn name(&self) -> &str {
        self.still.name()
    }
    fn space_name(&self) -> String {
        format!("{} and time", self.still.space_name())
    }
    fn touching(&self, q: &Configuration) -> Vec<Contact> {
        let mut touches = self.still.touching(&self.alone(q));
        let name = |i: usize| self.obstacles.get(i).map_or("?", |body| body.name.as_str()).to_owned();
        let touched = |moment: Moment<K>| K::touched(&mut self.among.inner().clone(), &moment);
        let touched = q.to().map(touched).unwrap_or_default();
        touches.extend(touched.into_iter().map(|i| Contact {
            part: None,
            other: name(i),
            with_itself: false,
            depth: None,
        }));
        touches
    }
    fn enclosures(&self, q: &Configuration) -> Vec<[String; 2]> {
        self.still.enclosures(&self.alone(q))
    }
    fn lint(&self) -> Vec<String> {
        self.still.lint()
    }
    fn end_error(&self, end: End, message: String, help: String) -> Error {
        self.still.end_error(end, message, help)
    }
    fn motion_model(&self) -> Result<MotionModel, Error> {
        let mut model = self.still.motion_model()?;
        let (time, robot) = (self.still.columns().len(), model.of_robot());
        model.time = Some(time);
        for (body, trajectory) in self.obstacles.iter().zip(K::trajectories(self.among.inner())) {
            let frame = model.track_frame(time, trajectory);
            let body = match &body.shape {
                BodyShape::Mesh(mesh) => ModelBody::mesh(&body.name, frame, mesh),
                BodyShape::Area(rings) => ModelBody::rings(&body.name, frame, true, rings),
                BodyShape::Lines(lines) => ModelBody::rings(&body.name, frame, false, lines),
            };
            model.add_obstacles(vec![body], robot.clone());
        }
        Ok(model)
    }
    fn columns(&self) -> Vec<Column> {
        let mut columns = self.still.columns();
        columns.push(Column::new("time", "s"));
        columns
    }
    fn limits(&self) -> Vec<Option<[f64; 2]>> {
        let mut limits = self.still.limits();
        limits.push(Some([0.0, self.space.0.horizon()]));
        limits
    }
    fn details(&self) -> Vec<(String, String)> {
        let mut details = self.still.details();
        details.retain(|(name, _)| name != "goal is");
        let names: Vec<&str> = self.obstacles.iter().map(|body| body.name.as_str()).collect();
        details.push(("moving".to_owned(), names.join(", ")));
        details.push(("speed".to_owned(), format!("at most {} per second", brief(self.space.0.speed()))));
        let goals = self.goal_parts.iter().map(|goal| crate::goals::written(self, goal));
        details.extend(goals.map(|goal| ("goal is".to_owned(), goal)));
        details
    }
    fn row(&self, q: &Configuration) -> Vec<f64> {
        let mut row = self.still.row(&self.alone(q));
        row.push(time(q));
        row
    }
    fn state(&self, row: &[f64]) -> Configuration {
        let (time, position) = row.split_last().unwrap_or((&0.0, &[]));
        timed(&self.still.state(position), *time)
    }
    fn given_start(&self) -> Vec<f64> {
        let mut row = self.row(self.start());
        row.iter_mut().zip(self.still.given_start()).for_each(|(x, given)| *x = given);
        row
    }
    fn row_fault(&self, row: &[f64]) -> Option<&'static str> {
        self.still.row_fault(&row[..row.len() - 1])
    }
    fn row_error(&self, rows: &[Vec<f64>]) -> Option<String> {
        let positions: Vec<_> = rows.iter().map(|row| row[..row.len().saturating_sub(1)].to_vec()).collect();
        if let Some(odd) = self.still.row_error(&positions) {
            return Some(odd);
        }
        let moments: Option<Vec<Moment<K>>> = rows.iter().map(|row| self.state(row).to()).collect();
        let moments = moments?;
        let space = &self.space.0;
        let i = moments.windows(2).position(|pair| !space.can_move(&pair[0], &pair[1]))?;
        let [(a, begin), (b, end)] = [&moments[i], &moments[i + 1]];
        let way = self.still.places().distance(a, b);
        Some(match end > begin {
            true => {
                let [needed, speed] = told_apart(way / (end - begin), space.speed());
                let (way, time) = (brief(way), brief(end - begin));
                format!(
                    "configuration {} is {way} from the one before, too far for {time} s: {needed} per second, not {speed}",
                    i + 2
                )
            }
            false => {
                let [begin, end] = [begin, end].map(|time| plain(*time));
                format!(
                    "configuration {} is at {end} s, not after the one before, which is at {begin} s",
                    i + 2
                )
            }
        })
    }
    fn deviation(&self, q: &Configuration, wanted: &Configuration) -> Deviation {
        let late = (time(q) - time(wanted)).abs();
        if late > TIME_TOLERANCE {
            return Deviation { off: late, allowed: TIME_TOLERANCE, unit: " s" };
        }
        self.still.deviation(&self.alone(q), &self.alone(wanted))
    }
}

impl<K: WithMoving> Appearance for MovingScene<K> {
    fn bodies(&self) -> Vec<Body> {
        let (robot, still): (Vec<_>, Vec<_>) =
            self.still.bodies().into_iter().partition(|b| b.pose.is_none());
        robot.into_iter().chain(self.obstacles.iter().cloned()).chain(still).collect()
    }
    fn moving_obstacles(&self) -> usize {
        self.obstacles.len()
    }
    fn poses(&self, q: &Configuration) -> Vec<Isometry3<f64>> {
        let mut poses = self.still.poses(&self.alone(q));
        poses.extend(K::obstacle_poses(self.among.inner(), time(q)));
        poses
    }
    fn traced(&self, q: &Configuration) -> Point3<f64> {
        self.still.traced(&self.alone(q))
    }
    fn seconds(&self, from: &Configuration, to: &Configuration) -> Option<f64> {
        Some((time(to) - time(from)).max(0.0))
    }
    fn picture_spacing(&self) -> f64 {
        self.still.picture_spacing()
    }
    fn picture_bounds(&self) -> Option<Aabb> {
        self.still.picture_bounds()
    }
    fn is_planar(&self) -> bool {
        self.still.is_planar()
    }
}
