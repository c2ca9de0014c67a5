//! Robots among obstacles that move: time is a dimension of planning.

use super::model::{ModelBody, MotionModel};
use super::vectors::OnVectors;
use super::{
    Body, BodyShape, Checker, Column, DrivenScene, End, Measured, Mismatch, RobotKind, SpeedBound, Touch,
    no_metric,
};
use crate::goals::{GoalPart, examples};
use crate::motion::{Configured, TypedMotion};
use crate::numbers::told_apart;
use crate::{Error, MetricName, brief, plain};
use mp_cspace::space_time::SpaceTime;
use mp_cspace::{
    AsVectors, Clearance, Demand, Embed, Interrupt, Interrupted, MotionCheck, MotionValidity, Space,
    StateVector,
};
use mp_geom::Aabb;
use mp_io::{Driven, Timing};
use mp_robot::Trajectory;
use nalgebra::{DVector, Isometry3, Point3};
use std::fmt::Debug;

/// The ends of a path match start and goal if their times differ by no more, seconds.
const TIME_TOLERANCE: f64 = 1e-3;

/// A kind of robot that can be among obstacles that move.
pub trait WithMoving: RobotKind + TypedMotion<Space: Embed + 'static, State: StateVector> + Clone {
    /// The robot among all of them: what planners check positions at times with.
    type Among: Checker<(Self::State, f64)> + Debug + 'static;
    /// The independent check of finished paths.
    type AmongVerifier<'c>: MotionValidity<(Self::State, f64)> + Clone + Send + Sync
    where
        Self: 'c;

    /// A verifier in a space of positions and times.
    ///
    /// # Errors
    /// When the robot cannot be verified.
    fn among_verifier<'c>(
        &'c self,
        space: &'c SpaceTime<Self::Space>,
        among: &Self::Among,
    ) -> Result<Self::AmongVerifier<'c>, Error>;
    /// What the verifier says of a single moment, as [`SpeedBound::check_state`].
    fn check_moment<'c>(
        verifier: &mut Self::AmongVerifier<'c>,
        q: &(Self::State, f64),
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
    /// The poses of the moving obstacles at a time.
    fn obstacle_poses(among: &Self::Among, time: f64) -> Vec<Isometry3<f64>>;
    /// The indices of the moving obstacles that the robot touches.
    fn touched(among: &mut Self::Among, q: &(Self::State, f64)) -> Vec<usize>;
}

/// A robot among obstacles of which some move on known trajectories. A configuration is that of the robot, and a time.
#[derive(Clone, Debug)]
pub struct MovingScene<K: WithMoving> {
    still: K,
    among: OnVectors<K::Among, (K::State, f64)>,
    obstacles: Vec<Body>,
    space: AsVectors<SpaceTime<K::Space>>,
    start: DVector<f64>,
    goals: Vec<DVector<f64>>,
    /// What the goals ask of each number, the time last.
    goal_parts: Vec<Vec<GoalPart>>,
}

/// The state of a robot at a time.
type Moment<K> = (<K as Configured>::State, f64);

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
        // Time to wait until nothing moves, and then to go around everything.
        let horizon = timing.horizon.unwrap_or(last.max(timing.start) + 2.0 * still.space().extent() / speed);
        let space = AsVectors(SpaceTime::new(still.space().clone(), horizon, speed)?);
        let start = vector::<K>((still.start().clone(), timing.start));
        let exactly = |q: &K::State| still.row(q).into_iter().map(GoalPart::Exactly).collect();
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

    /// The configuration and the time of a vector; the start for one that is none.
    fn moment(&self, q: &DVector<f64>) -> Moment<K> {
        StateVector::read(q.as_slice()).unwrap_or_else(|| (self.still.start().clone(), 0.0))
    }
}

/// The numbers of a configuration and a time.
fn vector<K: WithMoving>(moment: Moment<K>) -> DVector<f64> {
    AsVectors::<SpaceTime<K::Space>>::vector(&moment)
}

/// Goals at a time.
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
    ) -> Result<DrivenScene<Self>, Error> {
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
    fn check_state<'c>(verifier: &mut Self::Verifier<'c>, q: &DVector<f64>, enough: f64) -> MotionCheck
    where
        Self: 'c,
    {
        match StateVector::read(q.as_slice()) {
            Some(moment) => K::check_moment(verifier.inner_mut(), &moment, enough),
            None => MotionCheck::Unproven { at: 0.0 },
        }
    }
    fn degrees_of_freedom(&self) -> Vec<Column> {
        self.still.degrees_of_freedom()
    }
}

impl<K: WithMoving> Configured for MovingScene<K> {
    type State = DVector<f64>;
}

impl<K: WithMoving> TypedMotion for MovingScene<K> {
    type Space = AsVectors<SpaceTime<K::Space>>;
    type Checker = OnVectors<K::Among, Moment<K>>;
    type Verifier<'c>
        = OnVectors<K::AmongVerifier<'c>, Moment<K>>
    where
        Self: 'c;
    fn space(&self) -> &Self::Space {
        &self.space
    }
    /// The times of the goals are of no account: the robot may arrive whenever the scene says.
    fn with_ends(&self, start: DVector<f64>, goals: Vec<DVector<f64>>) -> Result<Self, Error> {
        let (first, _) = self.moment(&start);
        let positions: Vec<K::State> = goals.iter().map(|q| self.moment(q).0).collect();
        let exactly = |q: &K::State| self.still.row(q).into_iter().map(GoalPart::Exactly).collect();
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

impl<K: WithMoving> RobotKind for MovingScene<K> {
    fn name(&self) -> &str {
        self.still.name()
    }
    fn space_name(&self) -> String {
        format!("{} and time", self.still.space_name())
    }
    fn start(&self) -> &DVector<f64> {
        &self.start
    }
    fn goals(&self) -> &[DVector<f64>] {
        &self.goals
    }
    fn goal_parts(&self) -> Option<&[Vec<GoalPart>]> {
        Some(&self.goal_parts)
    }

    fn can_move(&self, from: &DVector<f64>, to: &DVector<f64>) -> bool {
        self.space.0.can_move(&self.moment(from), &self.moment(to))
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
    fn measured(&self, metric: MetricName) -> Result<Measured<'_, DVector<f64>>, Error> {
        match metric {
            MetricName::Default => Ok(Measured::by_coordinates(&self.space)),
            _ => Err(no_metric(metric, "a robot among obstacles that move", &[MetricName::Default])),
        }
    }

    fn touching(&self, q: &DVector<f64>) -> Vec<Touch> {
        let moment = self.moment(q);
        let mut touches = self.still.touching(&moment.0);
        let name = |i: usize| self.obstacles.get(i).map_or("?", |body| body.name.as_str()).to_owned();
        let touched = K::touched(&mut self.among.inner().clone(), &moment).into_iter();
        touches.extend(touched.map(|i| Touch {
            part: None,
            other: name(i),
            with_itself: false,
            depth: None,
        }));
        touches
    }
    fn enclosures(&self, q: &DVector<f64>) -> Vec<[String; 2]> {
        self.still.enclosures(&self.moment(q).0)
    }
    fn nearest_free(&self, q: &DVector<f64>) -> Option<DVector<f64>> {
        let (position, time) = self.moment(q);
        let free = vector::<K>((self.still.nearest_free(&position)?, time));
        let enough = 2.0 * self.tolerance();
        (self.among.clone().clearance(&free, enough) >= enough).then_some(free)
    }
    fn lint(&self) -> Vec<String> {
        self.still.lint()
    }
    fn fault(&self, end: End, message: String, help: String) -> Error {
        self.still.fault(end, message, help)
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
    fn row(&self, q: &DVector<f64>) -> Vec<f64> {
        let (position, time) = self.moment(q);
        let mut row = self.still.row(&position);
        row.push(time);
        row
    }
    fn state(&self, row: &[f64]) -> DVector<f64> {
        let (time, position) = row.split_last().unwrap_or((&0.0, &[]));
        vector::<K>((self.still.state(position), *time))
    }
    fn given_start(&self) -> Vec<f64> {
        let mut row = self.row(self.start());
        row.iter_mut().zip(self.still.given_start()).for_each(|(x, given)| *x = given);
        row
    }
    fn odd_rows(&self, rows: &[Vec<f64>]) -> Option<String> {
        let positions: Vec<_> = rows.iter().map(|row| row[..row.len().saturating_sub(1)].to_vec()).collect();
        if let Some(odd) = self.still.odd_rows(&positions) {
            return Some(odd);
        }
        let moments: Vec<_> = rows.iter().map(|row| self.moment(&self.state(row))).collect();
        let space = &self.space.0;
        let i = moments.windows(2).position(|pair| !space.can_move(&pair[0], &pair[1]))?;
        let [(a, begin), (b, end)] = [&moments[i], &moments[i + 1]];
        let way = self.still.space().distance(a, b);
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
    fn mismatch(&self, q: &DVector<f64>, wanted: &DVector<f64>) -> Mismatch {
        let [(q, time), (wanted, when)] = [q, wanted].map(|q| self.moment(q));
        let late = (time - when).abs();
        if late > TIME_TOLERANCE {
            return Mismatch { off: late, allowed: TIME_TOLERANCE, unit: " s" };
        }
        self.still.mismatch(&q, &wanted)
    }

    fn bodies(&self) -> Vec<Body> {
        let (robot, still): (Vec<_>, Vec<_>) =
            self.still.bodies().into_iter().partition(|b| b.pose.is_none());
        robot.into_iter().chain(self.obstacles.iter().cloned()).chain(still).collect()
    }
    fn moving_obstacles(&self) -> usize {
        self.obstacles.len()
    }
    fn poses(&self, q: &DVector<f64>) -> Vec<Isometry3<f64>> {
        let (position, time) = self.moment(q);
        let mut poses = self.still.poses(&position);
        poses.extend(K::obstacle_poses(self.among.inner(), time));
        poses
    }
    fn traced(&self, q: &DVector<f64>) -> Point3<f64> {
        self.still.traced(&self.moment(q).0)
    }
    fn seconds(&self, from: &DVector<f64>, to: &DVector<f64>) -> Option<f64> {
        Some((self.moment(to).1 - self.moment(from).1).max(0.0))
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
