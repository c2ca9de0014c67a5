//! What is written reads back the same.

#[path = "../../mp-formats/tests/numbers/mod.rs"]
mod numbers;

use mp_io::{Environment, Obstacle, SpaceKind};
use numbers::six;
use proptest::collection::vec;
use proptest::prelude::*;

fn environment() -> impl Strategy<Value = Environment> {
    let name = "[a-z_]{1,8}( [a-z]{1,4})?\\.(off|txt|stl)";
    let bounds = (six(), any::<bool>()).prop_map(|(mut b, given)| {
        for i in 0..3 {
            (b[i], b[i + 3]) = (b[i].min(b[i + 3]), b[i].max(b[i + 3]));
        }
        given.then_some(b)
    });
    let space = prop_oneof![Just(None), Just(Some(SpaceKind::Se2)), Just(Some(SpaceKind::Se3))];
    (name, six(), six(), vec((name, six()), 0..5), space, bounds).prop_map(
        |(robot, start, goal, obstacles, space, bounds)| Environment {
            robot,
            start,
            goal,
            obstacles: (1..)
                .zip(obstacles)
                .map(|(number, (mesh, pose))| Obstacle { number, mesh, pose })
                .collect(),
            space,
            bounds,
        },
    )
}

proptest! {
    #[test]
    fn environments(environment in environment()) {
        let text = environment.to_text();
        prop_assert_eq!(Environment::parse("t.env", text.as_bytes()).unwrap(), environment);
    }
}
