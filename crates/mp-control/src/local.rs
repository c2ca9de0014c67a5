//! The local planner that chooses among inputs.

use crate::{Flow, FlowCheck, Input, InputError, InputSet, SuccessorMotion};
use mp_cspace::{Direction, Extension, Interrupt, LocalPlanner, Motion, ParameterError, Reach, Rng, Space};

/// In which order successors are tested for collision.
///
/// The order decides how many tests are made, and nothing else: under the same [condition](Accept) both
/// orders take the same successor, bit for bit, since the first free one in the order of distance is the
/// nearest free one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Order {
    /// Every successor is tested, and of the free ones the nearest to the target is taken: ALG. 4 of
    /// N. Jouandeau, Y. Touati and A. Ali Cherif, *Incremental motion planning with Las Vegas
    /// algorithms*, 2008. (The printed listing never lowers `dmin`, and would take the last one nearer
    /// than the node; the text of the paper means the closest.)
    TestAll,
    /// Successors are sorted by their distance to the target and tested in that order; the first that
    /// is free is taken: RSRT, §3.2 of the same paper.
    SortFirst,
}

/// Which successors may be taken. This decides the shape of the tree: a node at an obstacle, from which no
/// free successor comes nearer to the sample, does not grow under [`Nearer`](Self::Nearer), and slides along
/// the obstacle or backs away from it under [`Any`](Self::Any).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Accept {
    /// Only those nearer to the target than the node itself: `dmin` of ALG. 4.
    Nearer,
    /// Any: RSRT has no such condition.
    Any,
}

/// What an [`InputPlanner`] has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputCounters {
    /// Calls of [`extend`](LocalPlanner::extend).
    pub expansions: u64,
    /// Successors produced: inputs integrated.
    pub successors: u64,
    /// Motions tested for collision.
    pub tested: u64,
    /// Successors dropped because they are not finite.
    pub not_finite: u64,
    /// Successors dropped because they are not in the space.
    pub outside: u64,
    /// Successors of backward trees dropped because the flow cannot run backward, or running it forward
    /// from them does not lead to the same state again, bit for bit.
    pub irreversible: u64,
}

/// A local planner whose choice among inputs its caller controls: an [`InputPlanner`], or a reference to one.
pub trait InputChoice {
    /// The order in which successors are tested, and which may be taken, where its maker has not
    /// [chosen](InputPlanner::ordered) these: how a planner says its defaults.
    fn set_defaults(&mut self, order: Order, accept: Accept);

    /// How many inputs there are.
    fn count(&self) -> usize;

    /// Tries each input at most once per node from now on: extends only by inputs not marked in `tried`, one
    /// entry per input (all unmarked when it has another length), and marks those it tries. Each extension
    /// tests at most `most` for collision. Any successor is accepted, in the order of
    /// [`SortFirst`](Order::SortFirst).
    fn lend_tried(&mut self, tried: Vec<bool>, most: usize);

    /// Ends [`lend_tried`](Self::lend_tried) and returns the marks.
    fn take_tried(&mut self) -> Vec<bool>;
}

impl<L: InputChoice + ?Sized> InputChoice for &mut L {
    fn set_defaults(&mut self, order: Order, accept: Accept) {
        (**self).set_defaults(order, accept);
    }
    fn count(&self) -> usize {
        (**self).count()
    }
    fn lend_tried(&mut self, tried: Vec<bool>, most: usize) {
        (**self).lend_tried(tried, most);
    }
    fn take_tried(&mut self) -> Vec<bool> {
        (**self).take_tried()
    }
}

/// Extends states by the inputs of a set: each input, applied for the duration, gives a successor. One that
/// is free of collision is taken, in the [`Order`] set.
///
/// The inputs and the duration decide the length of a step: [`Reach::Step`] limits exact connections only.
/// A target is reached when a successor equals it to the bit. Where the check can
/// [connect](FlowCheck::connect) states exactly, [`Reach::Full`] does that, and so do steps toward the
/// states given to [`reaching`](Self::reaching) from within a step of them.
///
/// In backward trees successors are states that lead to the node: the flow is [reversed](Flow::reversed).
/// Where edges are replayed, only successors from which the flow runs forward to the same node, bit for
/// bit, are used. Rounding makes these rare, so backward trees are useful with
/// [`LocalFlowCheck`](crate::LocalFlowCheck) only.
///
/// Time per extension: one integration and distance per input, a sort in
/// [`SortFirst`](Order::SortFirst), and the tests.
#[derive(Clone, Debug)]
pub struct InputPlanner<'c, C: Space, F, U, K> {
    space: &'c C,
    flow: F,
    inputs: InputSet<U>,
    duration: f64,
    check: K,
    order: Option<Order>,
    accept: Option<Accept>,
    /// The order and the condition where none is chosen.
    defaults: (Order, Accept),
    exact: Exact<C::State>,
    counters: InputCounters,
    /// The inputs tried before, and how many an extension may test.
    tried: Option<(Vec<bool>, usize)>,
    interrupt: Interrupt,
    /// The distance to the target and the input of each successor that may be taken.
    ranked: Vec<(f64, usize)>,
    successors: Vec<C::State>,
}

/// The states to which steps connect exactly.
#[derive(Clone, Debug)]
enum Exact<S> {
    Listed(Vec<S>),
    All,
}

impl<S: PartialEq> Exact<S> {
    fn has(&self, q: &S) -> bool {
        match self {
            Self::Listed(states) => states.contains(q),
            Self::All => true,
        }
    }
}

/// Number of states from which the flow is tried at construction.
const PROBES: usize = 32;

/// The most states tried while every input leads out of the space: with many joints near their limits most
/// states are such.
const MOST_PROBES: usize = 1024;

/// The most inputs tried from each of these states.
const PROBED_INPUTS: usize = 256;

impl<'c, C, F, U, K> InputPlanner<'c, C, F, U, K>
where
    C: Space,
    U: Input,
    F: Flow<C::State, U>,
    K: FlowCheck<C::State, U, F>,
{
    /// Extends states of `space` by `flow`: each of the `inputs` for `duration` seconds, tested by
    /// `check`. The order and the condition are those of RSRT, unless others are
    /// [chosen](Self::ordered) or the planner has [defaults](InputChoice::set_defaults) of its own.
    ///
    /// # Errors
    /// When the duration is not positive and finite; when the flow, tried from some states of the space,
    /// leads from one of them to a state that is not finite, or from none of them to another state in the
    /// space.
    pub fn new(
        space: &'c C,
        flow: F,
        inputs: InputSet<U>,
        duration: f64,
        check: K,
    ) -> Result<Self, InputError> {
        let duration = ParameterError::positive("the duration", duration)?;
        probe(space, &flow, inputs.inputs(), duration)?;
        Ok(Self {
            space,
            flow,
            ranked: Vec::with_capacity(inputs.len()),
            successors: Vec::with_capacity(inputs.len()),
            inputs,
            duration,
            check,
            order: None,
            accept: None,
            defaults: (Order::SortFirst, Accept::Any),
            exact: Exact::Listed(Vec::new()),
            counters: InputCounters::default(),
            tried: None,
            interrupt: Interrupt::never(),
        })
    }

    /// The same, which has no motions once `interrupt` says to end.
    #[must_use]
    pub fn with_interrupt(self, interrupt: Interrupt) -> Self {
        Self { interrupt, ..self }
    }

    /// The same in this order, whatever the planner's default is.
    #[must_use]
    pub fn ordered(self, order: Order) -> Self {
        Self { order: Some(order), ..self }
    }

    /// The same with this condition on successors, whatever the planner's default is.
    #[must_use]
    pub fn accepting(self, accept: Accept) -> Self {
        Self { accept: Some(accept), ..self }
    }

    /// The same, connecting exactly to these `states` from within a step of them, where the check can do
    /// that: for goals.
    #[must_use]
    pub fn reaching(self, states: impl IntoIterator<Item = C::State>) -> Self {
        Self { exact: Exact::Listed(states.into_iter().collect()), ..self }
    }

    /// The same, connecting exactly to any target within a step: for goals that are not known in advance.
    #[must_use]
    pub fn reaching_all(self) -> Self {
        Self { exact: Exact::All, ..self }
    }

    /// The counters so far.
    #[must_use]
    pub fn counters(&self) -> InputCounters {
        self.counters
    }

    /// The inputs among which the planner chooses.
    #[must_use]
    pub fn inputs(&self) -> &InputSet<U> {
        &self.inputs
    }

    /// The collision test.
    #[must_use]
    pub fn check(&self) -> &K {
        &self.check
    }

    /// Computes the successors, and ranks those that are in the space and differ from the node.
    fn produce(&mut self, node: &C::State, toward: &C::State, direction: Direction) {
        self.ranked.clear();
        self.successors.clear();
        let counters = &mut self.counters;
        for (index, input) in self.inputs.inputs().iter().enumerate() {
            if self.interrupt.ask() {
                self.ranked.clear();
                return;
            }
            if self.tried.as_ref().is_some_and(|(tried, _)| tried[index]) {
                self.successors.push(node.clone());
                continue;
            }
            let end = match direction {
                Direction::Forward => Some(self.flow.integrate(node, input, self.duration)),
                Direction::Backward => self.flow.reversed(node, input, self.duration),
            };
            counters.successors += 1;
            let Some(end) = end else {
                counters.irreversible += 1;
                self.successors.push(node.clone());
                continue;
            };
            let distance = self.space.distance(&end, toward);
            if !distance.is_finite() {
                counters.not_finite += 1;
            } else if !self.space.contains(&end) {
                counters.outside += 1;
            } else if K::REPLAYED
                && direction == Direction::Backward
                && self.flow.integrate(&end, input, self.duration) != *node
            {
                counters.irreversible += 1;
            } else if end != *node {
                self.ranked.push((distance, index));
            }
            self.successors.push(end);
        }
        if let Some((tried, _)) = &mut self.tried {
            // Whatever the target, the inputs that are not ranked give no successor of this node.
            tried.fill(true);
            self.ranked.iter().for_each(|&(_, index)| tried[index] = false);
        }
    }

    fn test(&mut self, node: &C::State, index: usize, direction: Direction) -> Option<(K::Edge, f64)> {
        self.counters.tested += 1;
        if let Some((tried, _)) = &mut self.tried {
            tried[index] = true;
        }
        let (successor, input) = (&self.successors[index], &self.inputs.inputs()[index]);
        let motion = SuccessorMotion { node, successor, input, duration: self.duration, direction };
        self.check.test(&self.flow, &motion)
    }

    /// The input of the successor taken, with its edge and cost.
    fn choose(
        &mut self,
        node: &C::State,
        direction: Direction,
        within: f64,
    ) -> Option<(usize, (K::Edge, f64))> {
        let most = self.tried.as_ref().map(|(_, most)| *most);
        match self.order.unwrap_or(self.defaults.0) {
            Order::TestAll if most.is_none() => {
                let (mut least, mut best) = (within, None);
                for i in 0..self.ranked.len() {
                    if self.interrupt.ask() {
                        return None;
                    }
                    let (distance, index) = self.ranked[i];
                    if let Some(edge) = self.test(node, index, direction)
                        && distance < least
                    {
                        (least, best) = (distance, Some((index, edge)));
                    }
                }
                best
            }
            Order::TestAll | Order::SortFirst => {
                self.ranked.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                for i in 0..self.ranked.len().min(most.unwrap_or(usize::MAX)) {
                    let (distance, index) = self.ranked[i];
                    if distance >= within || self.interrupt.ask() {
                        return None;
                    }
                    if let Some(edge) = self.test(node, index, direction) {
                        return Some((index, edge));
                    }
                }
                None
            }
        }
    }

    fn accept(&self) -> Accept {
        if self.tried.is_some() {
            return Accept::Any;
        }
        self.accept.unwrap_or(self.defaults.1)
    }

    /// An exact connection, where it is wanted and can be made. `None` to continue with the inputs.
    fn connect(
        &mut self,
        node: &C::State,
        toward: &C::State,
        direction: Direction,
        reach: Reach,
    ) -> Option<Extension<C::State, K::Edge>> {
        let wanted = match reach {
            Reach::Full => true,
            Reach::Step(step) => self.exact.has(toward) && self.space.distance(node, toward) <= step,
        };
        let connected = if wanted { self.check.connect(node, toward, direction) } else { None }?;
        self.counters.tested += 1;
        let decided = matches!((&connected, reach), (Extension::Reached(_), _) | (_, Reach::Full));
        decided.then_some(connected)
    }
}

/// Tries the flow from some states of the space.
fn probe<C: Space, U: Input, F: Flow<C::State, U>>(
    space: &C,
    flow: &F,
    inputs: &[U],
    duration: f64,
) -> Result<(), InputError> {
    let mut rng = Rng::seed(0);
    let mut moves = false;
    // Inputs in counting order: the first ones have much in common.
    let spread = inputs.len().div_ceil(PROBED_INPUTS).max(1);
    for tried in 0..MOST_PROBES {
        if moves && tried >= PROBES {
            break;
        }
        let from = space.sample_uniform(&mut rng);
        for (index, input) in inputs.iter().enumerate().step_by(spread) {
            let to = flow.integrate(&from, input, duration);
            if !space.distance(&from, &to).is_finite() {
                return Err(InputError::FlowNotFinite { index, from: format!("{from:?}") });
            }
            moves |= to != from && space.contains(&to);
        }
    }
    if moves { Ok(()) } else { Err(InputError::LeavesSpace { states: MOST_PROBES }) }
}

impl<C: Space, F, U: Input, K> InputChoice for InputPlanner<'_, C, F, U, K> {
    fn set_defaults(&mut self, order: Order, accept: Accept) {
        self.defaults = (order, accept);
    }
    fn count(&self) -> usize {
        self.inputs.len()
    }
    fn lend_tried(&mut self, mut tried: Vec<bool>, most: usize) {
        if tried.len() != self.inputs.len() {
            tried = vec![false; self.inputs.len()];
        }
        self.tried = Some((tried, most));
    }
    fn take_tried(&mut self) -> Vec<bool> {
        self.tried.take().map_or_else(Vec::new, |(tried, _)| tried)
    }
}

impl<C, F, U, K> LocalPlanner<C::State> for InputPlanner<'_, C, F, U, K>
where
    C: Space,
    U: Input,
    F: Flow<C::State, U>,
    K: FlowCheck<C::State, U, F>,
{
    type Edge = K::Edge;

    fn extend(
        &mut self,
        from: &C::State,
        toward: &C::State,
        direction: Direction,
        reach: Reach,
    ) -> Extension<C::State, K::Edge> {
        self.counters.expansions += 1;
        if let Some(connected) = self.connect(from, toward, direction, reach) {
            return connected;
        }
        self.produce(from, toward, direction);
        if reach == Reach::Full {
            let successors = &self.successors;
            self.ranked.retain(|&(_, index)| successors[index] == *toward);
        }
        let within = match self.accept() {
            Accept::Nearer => self.space.distance(from, toward),
            Accept::Any => f64::INFINITY,
        };
        let Some((index, (edge, cost))) = self.choose(from, direction, within) else {
            return Extension::Trapped;
        };
        let motion = Motion { end: self.successors.swap_remove(index), edge, cost };
        if motion.end == *toward { Extension::Reached(motion) } else { Extension::Advanced(motion) }
    }

    fn admits(&mut self, q: &C::State) -> bool {
        self.check.admits(q)
    }
}
