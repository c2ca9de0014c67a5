//! Variants made from outside the crate, one per slot: what the engine must leave room for.

use crate::common::*;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::Vector2;

type Point = Vector2<f64>;
type Local<'c> = Straight<'c, Rn<2>, mp_cspace::erased::AnyCheck<'c, Vector2<f64>>>;

fn problem<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
    start: Point,
    goal: Point,
) -> Problem<'c, Rn<2>, Local<'c>> {
    let local = certified(space, boxes.clone(), 1e-3);
    Problem::new(space, local, Exact(boxes.clone()), start, goal).unwrap()
}

fn trap() -> (Boxes<2>, Point, Point) {
    (hollow([0.4, 0.5], 0.2, 0.05, 0.03), Point::new(0.4, 0.5), Point::new(0.05, 0.5))
}

fn short() -> Tuning {
    Tuning { step: Length::Absolute(0.1), ..Tuning::default() }
}

fn solves<P: Planner<Point>>(mut planner: P, boxes: &Boxes<2>) -> Progress {
    let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(50_000), &mut ());
    let Outcome::Solved(path) = outcome else { panic!("{:?}", planner.progress()) };
    assert!(!path.states.windows(2).any(|pair| boxes.hit(&pair[0], &pair[1])));
    planner.progress()
}

/// Select: dynamic-domain RRT (Yershova et al. 2005). A node that failed refuses far samples.
#[derive(Clone)]
struct DynamicDomain {
    nearest: NearestSelector<Linear>,
    radius: f64,
    radii: Vec<f64>,
}

impl<C: Space> Selector<C> for DynamicDomain {
    fn select(
        &mut self,
        space: &C,
        points: &[C::State],
        target: &C::State,
        why: Purpose,
        rng: &mut Rng,
        out: &mut Vec<Hit>,
    ) {
        self.nearest.select(space, points, target, why, rng, out);
        out.retain(|hit| why == Purpose::Join || hit.distance <= self.radii[hit.id as usize]);
    }
    fn near(&self, space: &C, points: &[C::State], q: &C::State, radius: f64, out: &mut Vec<Hit>) {
        self.nearest.near(space, points, q, radius, out);
    }
    fn inserted(&mut self, space: &C, points: &[C::State], id: NodeId, parent: Option<NodeId>) {
        self.radii.push(f64::INFINITY);
        self.nearest.inserted(space, points, id, parent);
    }
    fn feedback(&mut self, id: NodeId, why: Purpose, grew: bool) {
        if why == Purpose::Explore && !grew {
            self.radii[id as usize] = self.radius;
        }
    }
    fn pruned(&mut self, space: &C, points: &[C::State], survivors: &[NodeId]) {
        self.radii = survivors.iter().map(|&id| self.radii[id as usize]).collect();
        self.nearest.pruned(space, points, survivors);
    }
}

#[test]
fn a_selector_that_learns() {
    let (space, (boxes, start, goal)) = (square(), trap());
    let plain = RrtConnect::with_index(problem(&space, &boxes, start, goal), Linear::new(), short()).unwrap();
    let parts = TreePlannerParts {
        target_sampler: Samples(Uniform(&space)),
        selector: DynamicDomain { nearest: NearestSelector::default(), radius: 0.1, radii: Vec::new() },
        extender: (Extend, Connect::default()),
        inserter: Append,
        tuning: short(),
    };
    let learning = TwoTrees::assemble("dd-rrt", problem(&space, &boxes, start, goal), parts).unwrap();
    let (plain, learning) = (solves(plain, &boxes), solves(learning, &boxes));
    assert!(learning.motions < plain.motions, "{learning:?} against {plain:?}");
}

/// Propose: of several samples the one farthest from the tree, as reduced-dispersion RRT looks
/// at several (Lindemann and LaValle 2004).
struct Farthest(usize);

impl<C: Space> TargetSampler<C> for Farthest {
    fn next_target<Se: Selector<C>>(
        &mut self,
        rng: &mut Rng,
        space: &C,
        points: &[C::State],
        selector: &mut Se,
    ) -> C::State {
        let mut hits = Vec::new();
        let mut best = (f64::NEG_INFINITY, space.sample_uniform(rng));
        for _ in 0..self.0 {
            let q = space.sample_uniform(rng);
            selector.select(space, points, &q, Purpose::Explore, rng, &mut hits);
            let distance = hits.first().map_or(0.0, |hit| hit.distance);
            if distance > best.0 {
                best = (distance, q);
            }
        }
        best.1
    }
}

/// Grow: one step, and on failure one toward a random state, as obstacle-based RRT changes its
/// mind (Rodriguez et al. 2006).
#[derive(Default)]
struct Sidestep {
    taken: usize,
    prunings: usize,
}

impl<L: LocalPlanner<Point>> Extender<Rn<2>, L> for Sidestep {
    fn extend<Se: Selector<Rn<2>>, A: Inserter<Rn<2>, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, Rn<2>, L, Se, A>,
    ) -> Grown {
        let grown = growing.step(from);
        if grown != Grown::Trapped {
            return grown;
        }
        self.taken += 1;
        let space = growing.checker().space();
        let aside = space.sample_uniform(growing.rng());
        growing.step_toward(from, &aside)
    }
    fn pruned(&mut self, _: Direction, _: &[NodeId]) {
        self.prunings += 1;
    }
}

#[test]
fn proposals_and_growths_of_ones_own() {
    let (space, (boxes, start, goal)) = (square(), trap());
    let parts = TreePlannerParts {
        target_sampler: Farthest(4),
        selector: NearestSelector(Linear::new()),
        extender: Sidestep::default(),
        inserter: Append,
        tuning: short(),
    };
    solves(SingleTree::assemble(problem(&space, &boxes, start, goal), parts).unwrap(), &boxes);
    let both = TreePlannerParts {
        target_sampler: Samples(Uniform(&space)),
        selector: NearestSelector(Linear::new()),
        extender: (Connect::default(), Connect::default()),
        inserter: Append,
        tuning: short(),
    };
    solves(TwoTrees::assemble("con-con", problem(&space, &boxes, start, goal), both).unwrap(), &boxes);
}

/// A car's pose moved by a finite set of inputs: forward only, turning left, right or not.
#[derive(Clone, Debug)]
struct Car<'c> {
    space: &'c Se2,
    boxes: Boxes<2>,
}

const DRIVE: f64 = 0.04;
const TURNS: [f64; 3] = [-0.4, 0.0, 0.4];

fn drive(from: &Se2State, turn: f64, part: f64) -> Se2State {
    let half = from.angle + 0.5 * turn * part;
    let t = from.translation + Vector2::new(mp_math::cos(half), mp_math::sin(half)) * (DRIVE * part);
    Se2State::new(t.x, t.y, from.angle + turn * part)
}

impl Car<'_> {
    fn free(&self, from: &Se2State, turn: f64) -> bool {
        (0..=20).all(|i| {
            let q = drive(from, turn, f64::from(i) / 20.0);
            self.space.contains(&q) && self.boxes.distance(&q.translation) > 0.01
        })
    }
}

/// ALG. 4: test every input, keep the free successor nearest to the target.
impl LocalPlanner<Se2State> for Car<'_> {
    type Edge = f64;
    fn extend(
        &mut self,
        from: &Se2State,
        toward: &Se2State,
        direction: Direction,
        reach: Reach,
    ) -> Extension<Se2State, f64> {
        if direction == Direction::Backward || reach == Reach::Full {
            return Extension::Trapped;
        }
        let before = self.space.distance(from, toward);
        let free = TURNS.into_iter().filter(|&turn| self.free(from, turn));
        let ends = free.map(|turn| (drive(from, turn, 1.0), turn));
        let away = |q: &Se2State| self.space.distance(q, toward);
        match ends.min_by(|a, b| away(&a.0).total_cmp(&away(&b.0))) {
            Some((end, edge)) if away(&end) < before => {
                Extension::Advanced(Motion { end, edge, cost: DRIVE })
            }
            _ => Extension::Trapped,
        }
    }
}

/// Replays the inputs.
impl Verify<Se2State, f64> for Car<'_> {
    fn verify_state(&mut self, q: &Se2State) -> MotionCheck {
        match self.boxes.distance(&q.translation) > 0.01 {
            true => MotionCheck::Free { clearance: 0.0 },
            false => MotionCheck::Collision { at: 0.0 },
        }
    }
    fn verify_edge(&mut self, from: &Se2State, turn: &f64, to: &Se2State) -> MotionCheck {
        match drive(from, *turn, 1.0) == *to && self.free(from, *turn) {
            true => MotionCheck::Free { clearance: 0.0 },
            false => MotionCheck::Collision { at: 1.0 },
        }
    }
}

#[test]
fn inputs_instead_of_straight_lines() {
    let space = Se2::new([0.0; 2], [1.0; 2]).unwrap();
    let car = Car { space: &space, boxes: slit(0.1, 0.8, 0.2) };
    let start = Se2State::new(0.1, 0.2, 0.0);
    let beyond = Goals::region(|q: &Se2State| q.translation.x > 0.8);
    let problem = Problem::new(&space, car.clone(), car.clone(), start, beyond).unwrap();
    let parts = TreePlannerParts {
        target_sampler: Samples(Uniform(&space)),
        selector: NearestSelector(Linear::new()),
        extender: Extend,
        inserter: AppendDistinct::default(),
        tuning: Tuning::default(),
    };
    let mut planner = SingleTree::assemble(problem, parts).unwrap();
    let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(50_000), &mut ());
    let Outcome::Solved(path) = outcome else { panic!("{:?}", planner.progress()) };
    let replayed = path.edges.iter().fold(start, |q, turn| drive(&q, *turn, 1.0));
    assert_eq!(Some(&replayed), path.states.last());
}

/// Asks for no motion longer than a step, and would rather the planner asked for none.
#[derive(Clone, Copy)]
struct OneStep;

impl<C: Space, L: LocalPlanner<C::State>> Extender<C, L> for OneStep {
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown {
        growing.step(from)
    }
    fn allows_direct(&self) -> bool {
        false
    }
}

/// Refuses motions of any length.
struct NeverFar<'c>(Local<'c>);

impl LocalPlanner<Point> for NeverFar<'_> {
    type Edge = ();
    fn extend(
        &mut self,
        from: &Point,
        toward: &Point,
        direction: Direction,
        reach: Reach,
    ) -> Extension<Point, ()> {
        assert_ne!(reach, Reach::Full, "asked to leap");
        self.0.extend(from, toward, direction, reach)
    }
}

/// Where a growth declines, the straight way to the goal is not tried, by any of the loops.
#[test]
fn leaps_can_be_declined() {
    let (space, boxes) = (square(), Boxes::default());
    let (start, goal) = (Point::new(0.1, 0.5), Point::new(0.9, 0.5));
    let problem = || {
        let local = NeverFar(certified(&space, boxes.clone(), 1e-3));
        Problem::new(&space, local, Exact(boxes.clone()), start, goal).unwrap()
    };
    fn parts<G>(
        space: &Rn<2>,
        extender: G,
    ) -> TreePlannerParts<Samples<Uniform<'_, Rn<2>>>, NearestSelector<Linear>, G, Append> {
        let (target_sampler, selector) = (Samples(Uniform(space)), NearestSelector(Linear::new()));
        TreePlannerParts { target_sampler, selector, extender, inserter: Append, tuning: short() }
    }
    solves(SingleTree::assemble(problem(), parts(&space, OneStep)).unwrap(), &boxes);
    solves(Improving::assemble(problem(), parts(&space, OneStep)).unwrap(), &boxes);
    // It is enough that one of the two declines.
    solves(
        TwoTrees::assemble("two", problem(), parts(&space, (OneStep, Connect::default()))).unwrap(),
        &boxes,
    );
    solves(TwoTrees::assemble("two", problem(), parts(&space, (Extend, OneStep))).unwrap(), &boxes);
}
