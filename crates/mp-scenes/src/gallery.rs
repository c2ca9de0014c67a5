//! The shipped scenes in groups, with a sentence about each.

use crate::PUZZLES;

/// Scenes that belong together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// What they have in common.
    pub title: &'static str,
    /// The name of each, and a sentence about it.
    pub scenes: Vec<(&'static str, &'static str)>,
}

/// The scenes that are not graded.
const GROUPS: &[(&str, &[(&str, &str)])] = &[
    (
        "Bodies among meshes",
        &[
            ("cubicles", "a wall without a door: down one stair well, through the basement, up the other"),
            ("apartment", "a piano is moved through two doors and a hall, past the furniture"),
            ("easy", "a body of three arms goes through a wide window"),
            ("twisty", "the same body through a narrow window, one arm after the other"),
            ("bugtrap", "a rod leaves a hollow whose neck reaches inwards"),
            ("gempa-1", "a tetrahedron in a garden of columns, cones and spheres"),
            ("gempa-2", "a cube through three walls, each with an opening little larger than the cube"),
            ("gempa-3", "an angular body in a narrow corridor with a bend"),
            ("gempa-4", "a slab winds through corridors between long, thin laminas"),
            ("maze", "a long way in the plane for a body that cannot turn everywhere"),
            ("planar-bugtrap", "a bar leaves a ring whose lips bend inwards"),
            (
                "alpha-1.0",
                "two bent tubes come apart through a crossing 1.05 times as wide as they are thick",
            ),
            ("alpha-1.1", "two bent tubes, a wider crossing"),
            ("alpha-1.2", "two bent tubes, a wider crossing"),
            ("alpha-1.3", "two bent tubes, a wider crossing"),
            ("alpha-1.4", "two bent tubes, a wider crossing"),
            ("alpha-1.5", "two bent tubes, a crossing 1.4 times as wide as they are thick"),
        ],
    ),
    (
        "Arms",
        &[
            ("arm", "six joints: from one compartment of a shelf into the next"),
            ("arm-6", "as long as a UR5e: out of one bin, over a wall, into another"),
            ("arm-7", "as long as a Panda: into the compartment above, beside a bottle"),
            ("shelf", "from one board to another of a shelf that is a scan of 100,000 points"),
            ("tool-pose", "the goal is a place for the hand, which points down and may turn"),
            ("carry", "three parts: to a box, over a wall with it, back without it"),
            ("two-arms", "two arms over one table, which must not touch each other either"),
            ("humanoid", "the waist and one arm of a humanoid move, a group of its SRDF"),
            ("mobile-arm", "an arm on a base that drives, through a door, from one table to another"),
            ("wrench", "a flying spanner shuts its jaw to pass a slot, and opens it to take a nut"),
        ],
    ),
    (
        "Vehicles, and obstacles that move",
        &[
            ("parking", "a car parks backward between two others"),
            ("unicycle", "forward only, around tables, and the end in any direction"),
            ("velocities", "a polygon moves by velocities, slow sideways, through a gap"),
            ("accelerations", "a disc moves by accelerations around a corner, and is slow at the goal"),
            ("docks", "a cart may end at any of several docks"),
            ("crossing", "a disc crosses a road with lorries, and a gate that is open for some seconds"),
            ("warehouse", "a unicycle crosses an aisle among carts that drive"),
            ("blade", "a box flies through a window in which a blade turns"),
            ("flyer", "a box flies by accelerations through a window, and is slow at the goal"),
        ],
    ),
    (
        "Worlds of two papers",
        &[
            ("rrs-maze", "a disc in a maze (Baizid et al., Figure 4)"),
            ("rrs-low", "a disc among few obstacles (Baizid et al., Figure 4)"),
            ("rrs-high", "a disc among many obstacles (Baizid et al., Figure 4)"),
            ("rrs-random", "a disc among random obstacles (Baizid et al., Figure 4)"),
            ("rrs-corridor", "a corridor in which a robot follows paths (Baizid et al., Figure 10)"),
            ("rrs-follow", "a roomier corridor, to look at paths that are followed"),
            ("rsrt-flyer-64", "a bar flies among 64 boxes (Jouandeau et al. 2008, Figure 6)"),
            ("rsrt-arm-64", "an arm of boxes among 64 boxes (Jouandeau et al. 2008, Figure 7)"),
        ],
    ),
];

/// All shipped scenes in groups, the graded ones last.
#[must_use]
pub fn groups() -> Vec<Group> {
    let plain = GROUPS.iter().map(|(title, scenes)| Group { title, scenes: scenes.to_vec() });
    let graded = |(title, grade): (&'static str, u8)| Group {
        title,
        scenes: PUZZLES.iter().filter(|p| p.grade == grade).map(|p| (p.scene, p.about)).collect(),
    };
    let grades = [("Puzzles that take seconds", 1), ("Puzzles that take a minute", 2), ("Hard puzzles", 3)];
    plain.chain(grades.map(graded)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_in_one_group() {
        let mut grouped: Vec<_> = groups().iter().flat_map(|group| group.scenes.clone()).collect();
        grouped.sort_unstable();
        assert!(grouped.iter().map(|(name, _)| *name).eq(crate::names()), "{grouped:?}");
        assert!(
            grouped.iter().all(|(_, about)| about.len() > 20 && about.len() < 100 && !about.ends_with('.'))
        );
    }
}
