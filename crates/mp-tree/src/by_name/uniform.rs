//! Problems whose local planner moves by a uniform set of inputs, for planners made by name.

use super::{BuildArgs, BuildResult, Types};
use crate::{BuildError, Parameter, Problem, RrtInputs, Rsrt, Settings, Tuning};
use mp_control::{Accept, Flow, InputPlanner, InputSet, Kinematic, LocalFlowCheck, Order};
use mp_cspace::{AnyFlow, LocalPlanner, Space};

/// The number of directions of a set of inputs.
pub const INPUTS: Parameter = Parameter {
    name: "inputs",
    range: "a whole number",
    default: "0",
    doc: "directions of motion, both ways along each axis first, the rest spread evenly; 0: the axes alone",
};

/// The number of lengths of motion per direction of a set of inputs.
pub const LEVELS: Parameter = Parameter {
    name: "levels",
    range: "a whole number, 1 to 20",
    default: "3",
    doc: "lengths of motion: the step, a quarter of it, a quarter of that, and so on",
};

/// The order in which successors are tested for collision; the default is the planner's.
pub const ORDER: Parameter = Parameter {
    name: "order",
    range: "test-all or sort-first",
    default: "test-all",
    doc: "test all successors for collision and take the nearest free one, or sort them and take the first",
};

/// Which successors may be taken; the default is the planner's.
pub const ACCEPT: Parameter = Parameter {
    name: "accept",
    range: "nearer or any",
    default: "nearer",
    doc: "take only successors nearer to the sample than the node that is extended, or any",
};

/// The order and the condition on successors that are set, if any.
pub(crate) fn order_and_accept(settings: &Settings) -> Result<(Option<Order>, Option<Accept>), BuildError> {
    let order = settings.choice(ORDER.name, ORDER.range, |name| match name {
        "test-all" => Some(Order::TestAll),
        "sort-first" => Some(Order::SortFirst),
        _ => None,
    })?;
    let accept = settings.choice(ACCEPT.name, ACCEPT.range, |name| match name {
        "nearer" => Some(Accept::Nearer),
        "any" => Some(Accept::Any),
        _ => None,
    })?;
    Ok((order, accept))
}

/// Makes RRT by inputs or RSRT, with the order and the condition that are set, or these. The condition
/// decides which of the two types it is: where any successor may be taken, those that a node of the tree
/// resembles must be refused.
pub(crate) fn make_by_inputs<'c, T: Types<'c>>(
    args: BuildArgs<'c, '_, T>,
    (order, accept): (Order, Accept),
) -> BuildResult<'c, T> {
    let set = order_and_accept(args.settings)?;
    let (order, accept) = (set.0.unwrap_or(order), set.1.unwrap_or(accept));
    let problem = moved_by_inputs(args.problem, &args.tuning, args.settings)?;
    let problem =
        problem.try_map_local(|local| Ok::<_, BuildError>(local.ordered(order).accepting(accept)))?;
    Ok(match accept {
        Accept::Nearer => Box::new(RrtInputs::with_index(problem, args.index, args.tuning)?),
        Accept::Any => Box::new(Rsrt::with_index(problem, args.index, args.tuning)?),
    })
}

/// How planners made by name move by inputs.
pub(crate) enum NamedFlow<'c, C: Space> {
    Velocities(Kinematic<'c, C>),
    /// As the robot does.
    Own(AnyFlow<'c, C::State>),
}

impl<C: Space> Flow<C::State, Vec<f64>> for NamedFlow<'_, C> {
    fn integrate(&self, from: &C::State, input: &Vec<f64>, time: f64) -> C::State {
        match self {
            Self::Velocities(flow) => flow.integrate(from, input, time),
            Self::Own(flow) => flow(from, input, time),
        }
    }
    fn reversed(&self, to: &C::State, input: &Vec<f64>, time: f64) -> Option<C::State> {
        match self {
            Self::Velocities(flow) => flow.reversed(to, input, time),
            Self::Own(_) => None,
        }
    }
}

/// A local planner that moves by inputs; its motions and edges are those of `L`.
pub(crate) type ByInputs<'c, C, L> = InputPlanner<'c, C, NamedFlow<'c, C>, Vec<f64>, LocalFlowCheck<L>>;

/// The problem with a local planner that moves by the inputs of the robot, or, for a robot that can make any
/// motion, by velocities for one second each: [`InputSet::uniform`], one step long. Then, from within a step,
/// listed goals are connected to exactly; where goals are sampled, and so not known beforehand, every target
/// is.
pub(crate) fn moved_by_inputs<'c, C: Space, L: LocalPlanner<C::State>>(
    problem: Problem<'c, C, L>,
    tuning: &Tuning,
    settings: &Settings,
) -> Result<Problem<'c, C, ByInputs<'c, C, L>>, BuildError> {
    let space = problem.space();
    let reach = tuning.step.step_in(space)?;
    let directions = settings.count(INPUTS.name)?.unwrap_or(0);
    let directions = in_range(INPUTS.name, directions, 0, 1 << 20)?;
    let levels = in_range(LEVELS.name, settings.count(LEVELS.name)?.unwrap_or(3), 1, 20)?;
    in_range("inputs times levels", u64::from(directions) * u64::from(levels), 0, 1 << 20)?;
    let interrupt = problem.interrupt().clone();
    if let Some(system) = problem.inputs().cloned() {
        let inputs = InputSet::new((system.inputs)(directions as usize, levels))?;
        let flow = NamedFlow::Own(system.flow);
        return problem.try_map_local(|local| {
            let planner = InputPlanner::new(space, flow, inputs, system.duration, LocalFlowCheck(local))?;
            Ok(planner.with_interrupt(interrupt))
        });
    }
    let inputs = InputSet::uniform(space, reach, directions as usize, levels)?;
    let flow = NamedFlow::Velocities(Kinematic::new(space)?);
    let (goals, sampled) = (problem.goals().listed().to_vec(), problem.goals().has_sampler());
    problem.try_map_local(|local| {
        let planner = InputPlanner::new(space, flow, inputs, 1.0, LocalFlowCheck(local))?;
        let planner = planner.with_interrupt(interrupt);
        Ok(if sampled { planner.reaching_all() } else { planner.reaching(goals) })
    })
}

fn in_range(name: &'static str, value: u64, least: u32, most: u32) -> Result<u32, BuildError> {
    match u32::try_from(value) {
        Ok(count) if (least..=most).contains(&count) => Ok(count),
        _ => {
            let range = format!("a whole number from {least} to {most}");
            Err(BuildError::OutOfRange { name, value: value as f64, range })
        }
    }
}
