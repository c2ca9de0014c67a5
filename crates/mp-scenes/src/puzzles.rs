//! Scenes that planners are compared on, by how hard they are.

/// A scene with what is known of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Puzzle {
    /// The name of the scene, as `mp plan` takes it.
    pub scene: &'static str,
    /// How hard it is: 1 where RRT-Connect takes seconds at most, 2 where it does not always arrive within a minute, 3 where no
    /// planner did so reliably when the scene was made.
    pub grade: u8,
    /// The least clearance along the widest way that is known, as a share of the robot's radius about its origin.
    pub room: f64,
    /// What there is to do.
    pub about: &'static str,
}

const fn puzzle_of(scene: &'static str, grade: u8, room: f64, about: &'static str) -> Puzzle {
    Puzzle { scene, grade, room, about }
}

/// All graded scenes, the easy ones first.
pub const PUZZLES: &[Puzzle] = &[
    puzzle_of("flat-1.2", 1, 0.0961, "a piano goes through two doors on its side"),
    puzzle_of("twist-1.2", 1, 0.0847, "a plate goes through a slot that turns by a right angle"),
    puzzle_of("flat-1.05", 1, 0.024, "a piano through two doors, hardly larger than it is on its side"),
    puzzle_of(
        "tubes-1.5",
        1,
        0.0109,
        "two tubes like the letter α come apart through a crossing that they fit",
    ),
    puzzle_of("trap-1.5", 2, 0.1095, "a rod leaves a hollow by a neck 1.5 times as wide as it is thick"),
    puzzle_of("nut-3", 2, 0.0731, "a nut comes off a thread of three turns"),
    puzzle_of("key-1.5", 2, 0.0498, "a key goes through two wards, and is turned over between them"),
    puzzle_of("assembly-1.2", 2, 0.0265, "a hook is taken out of a block by 25 steps along three axes"),
    puzzle_of("twist-1.05", 2, 0.0172, "a plate through a slot that turns, fitted more closely"),
    puzzle_of(
        "tubes-1.2",
        2,
        0.00146,
        "two tubes, fitted more closely: the strand in the crossing must be rolled",
    ),
    puzzle_of("trap-1.2", 3, 0.0444, "a rod out of a neck 1.2 times as wide as it is thick"),
    puzzle_of("nut-6", 3, 0.0312, "a nut off a thread of six turns, fitted more closely"),
    puzzle_of("key-1.2", 3, 0.0199, "a key through two wards, fitted more closely"),
    puzzle_of("trap-1.05", 3, 0.0119, "a rod out of a neck 1.05 times as wide as it is thick"),
    puzzle_of("assembly-1.05", 3, 0.00735, "a hook out of a block, fitted more closely"),
    puzzle_of(
        "tubes-1.1",
        3,
        0.00037,
        "two tubes, with two millimetres on either side of a strand a metre thick",
    ),
    puzzle_of("tubes-1.0", 3, 0.00011, "two tubes, with six tenths of a millimetre on either side"),
];

/// What is known of the scene called `name`, if it is graded.
#[must_use]
pub fn puzzle(name: &str) -> Option<&'static Puzzle> {
    PUZZLES.iter().find(|puzzle| puzzle.scene == name)
}

/// The names of the scenes that come without a solution, in which planners find one soon. The others, with `paths/NAME.txt`, are for
/// comparisons.
pub fn without_solution() -> impl Iterator<Item = &'static str> {
    crate::names().filter(|name| crate::file(&format!("paths/{name}.txt")).is_none())
}
