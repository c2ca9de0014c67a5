//! Planning in space and time: a gate is passed only while it is open.

use mp::cspace::{
    Certified, Iterations, KdTree, Outcome, Path, Planner, Rng, Se2, Se2State, Straight, Uniform,
    space_time::{ForwardInTime, SpaceTime},
};
use mp::geom::primitives::cuboid;
use mp::robot::{AmongMoving, MovingVerifier, PlanarFlyer, Trajectory};
use mp::tree::{
    Append, Connect, Goals, Length, NearestSelector, Problem, Rrt, Samples, SingleTree, TreePlannerParts,
    Tuning,
};
use nalgebra::Isometry3;

type State = (Se2State, f64);

/// A box goes through the gate in a wall at x = 0, whose leaf is at these heights at these times: at 0 it
/// closes the gap, at 2 it does not. `connect` grows step after step.
fn through(gate: &[(f64, f64)], connect: bool, iterations: u64) -> Option<Path<State>> {
    let wall =
        |y: f64| ("wall".to_owned(), cuboid(0.2, 2.0, 1.0).unwrap(), Isometry3::translation(0.0, y, 0.0));
    let body = PlanarFlyer::new(&cuboid(0.3, 0.2, 0.2).unwrap(), [wall(-1.5), wall(1.5)]).unwrap();
    let heights = gate.iter().map(|&(time, y)| (time, Isometry3::translation(0.0, y, 0.0)));
    let leaf = ("leaf".to_owned(), cuboid(0.01, 1.2, 1.0).unwrap(), Trajectory::new(heights).unwrap());
    let robot = AmongMoving::new(body, [leaf]).unwrap();

    let positions = Se2::new([-2.0, -2.0], [2.0, 2.0]).unwrap().with_rotation_weight(0.2).unwrap();
    let space = SpaceTime::new(positions, 14.0, 1.0).unwrap();
    let verifier = MovingVerifier::new(&space, &robot).unwrap();
    let check = ForwardInTime { space: &space, check: Certified::new(&space, robot, 1e-3).unwrap() };
    let local = Straight::new(&space, check);
    let goal = Se2State::new(1.5, 0.0, 0.0);
    let arrival = space.at_any_time(goal);
    let goals = Goals::region(arrival.clone()).with_sampler(arrival);
    let start = (Se2State::new(-1.5, 0.0, 0.0), 0.0);
    let problem = Problem::new(&space, local, verifier, start, goals).unwrap();
    let tuning = Tuning { step: Length::Absolute(2.0), ..Tuning::default() };
    let (mut rng, mut stop) = (Rng::seed(1), Iterations(iterations));
    let outcome = if connect {
        let (target_sampler, selector) = (Samples(Uniform(&space)), NearestSelector::<KdTree>::default());
        let parts = TreePlannerParts {
            target_sampler,
            selector,
            extender: Connect::default(),
            inserter: Append,
            tuning,
        };
        SingleTree::assemble(problem, parts).unwrap().solve(&mut rng, &mut stop, &mut ())
    } else {
        Rrt::new(problem, tuning).unwrap().solve(&mut rng, &mut stop, &mut ())
    };
    let Outcome::Solved(path) = outcome else { return None };
    assert_eq!(path.states[path.states.len() - 1].0, goal);
    for pair in path.states.windows(2) {
        let way = (pair[1].0.translation - pair[0].0.translation).norm();
        let time = pair[1].1 - pair[0].1;
        assert!(time > 0.0, "back in time");
        assert!(way <= time * (1.0 + 1e-6), "too fast");
    }
    Some(path)
}

#[test]
fn a_gate_is_passed_only_while_it_is_open() {
    // Opens from 4 s to 5 s, closes from 8 s to 9 s.
    let gate = [(4.0, 0.0), (5.0, 2.0), (8.0, 2.0), (9.0, 0.0)];
    for connect in [false, true] {
        let path = through(&gate, connect, 200_000).expect("the gate is open for three seconds");
        let mut crossing = Vec::new();
        for pair in path.states.windows(2) {
            let [(a, begin), (b, end)] = pair else { continue };
            for i in 0..=1000 {
                let t = f64::from(i) / 1000.0;
                if a.translation.lerp(&b.translation, t).x.abs() < 0.1 {
                    crossing.push(begin + (end - begin) * t);
                }
            }
        }
        // The leaf is 1.2 m high, the gap 1 m, the box 0.2 m: before 4.15 s and after 8.85 s it does not fit.
        assert!(!crossing.is_empty() && crossing.iter().all(|t| (4.1..8.9).contains(t)), "{crossing:?}");
    }
}

#[test]
fn a_gate_that_does_not_open_in_time_is_not_passed() {
    assert!(through(&[(0.0, 0.0)], false, 3000).is_none(), "it never opens");
    assert!(through(&[(0.5, 2.0), (1.0, 0.0)], false, 3000).is_none(), "it closes before anyone is there");
    assert!(through(&[(13.0, 0.0), (13.9, 2.0)], true, 3000).is_none(), "it opens when time is up");
}
