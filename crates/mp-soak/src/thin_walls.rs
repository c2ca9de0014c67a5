//! Tests of the oracle. For every kind of robot it must find walls as thin as a hair, wrong ends and leaps.

#![cfg(test)]

use crate::oracle::{
    Ask, Body, Case, Drive, DriveKind, Fault, Joint, Mover, Moves, Piece, Shape, Timing, Tree, box_pieces,
};
use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use std::f64::consts::PI;

/// The thickness of walls, metres.
const THIN: f64 = 1e-6;

/// A robot without obstacles, in a room of ten metres.
fn case(moves: Moves, robot: Vec<Body>, start: &[f64], goal: &[f64]) -> Case {
    let limits = match &moves {
        Moves::Point => vec![Some([-5.0, 5.0]); 2],
        Moves::Plane => vec![Some([-5.0, 5.0]), Some([-5.0, 5.0]), None],
        Moves::Space => [[Some([-5.0, 5.0]); 3], [None; 3]].concat(),
        Moves::Tree(tree) => {
            let root = if tree.floats { [[Some([-5.0, 5.0]); 3], [None; 3]].concat() } else { Vec::new() };
            let joints = tree.circles.iter().map(|circle| (!circle).then_some([-3.0, 3.0]));
            root.into_iter().chain(joints).collect()
        }
    };
    Case {
        moves,
        robot,
        pairs: Vec::new(),
        still: Vec::new(),
        moving: Vec::new(),
        timing: None,
        drive: None,
        limits,
        start: start.to_vec(),
        goals: vec![goal.iter().map(|x| Ask::Exactly(*x)).collect()],
        extent: 10.0,
        far: 10.0,
    }
}

/// A wall across the x axis in the plane, from y = -1 to y = 1.
fn line_wall(x: f64) -> Body {
    let ring = vec![[x, -1.0], [x + THIN, -1.0], [x + THIN, 1.0], [x, 1.0]];
    Body::new("wall", Shape::Rings { rings: vec![ring], filled: true }, 0)
}

/// A wall across the x axis in space.
fn plate(x: f64) -> Body {
    Body::new("wall", Shape::Pieces(box_pieces([THIN, 2.0, 2.0], &Isometry3::translation(x, 0.0, 0.0))), 0)
}

fn disc() -> Body {
    Body::new("robot", Shape::Disc { middle: [0.0; 2], radius: 0.01 }, 0)
}

fn polygon() -> Body {
    let ring = vec![[-0.01, -0.01], [0.01, -0.01], [0.0, 0.02]];
    Body::new("robot", Shape::Rings { rings: vec![ring], filled: true }, 0)
}

fn small_box(frame: usize) -> Body {
    Body::new("robot", Shape::Pieces(box_pieces([0.02; 3], &Isometry3::identity())), frame)
}

/// The path must be free without the wall, and collide with it near its middle.
fn hits_wall(mut case: Case, rows: &[Vec<f64>], wall: Body) {
    let free = case.judge(rows);
    assert_eq!(free.fault, None, "without the wall");
    assert!(free.finished && free.edges + 1 == rows.len() as u64);
    case.still.push(wall);
    let hit = case.judge(rows);
    assert!(
        matches!(&hit.fault, Some(Fault::Contact { edge: 0, between, .. }) if between == "robot and wall"),
        "{hit:?}"
    );
}

#[test]
fn discs_and_polygons() {
    let (a, b) = (vec![-1.3, 0.1], vec![2.0, 0.0]);
    hits_wall(case(Moves::Point, vec![disc()], &a, &b), &[a.clone(), b.clone()], line_wall(0.377));
    let (a, b) = (vec![-1.3, 0.1, 2.0], vec![2.0, 0.0, -2.0]);
    hits_wall(case(Moves::Plane, vec![polygon()], &a, &b), &[a.clone(), b.clone()], line_wall(0.377));
}

#[test]
fn rigid_bodies_in_space() {
    let (a, b) = (vec![-1.3, 0.1, 0.0, 1.0, 0.5, 0.0], vec![2.0, 0.0, 0.1, -1.0, 0.0, 2.0]);
    for wall in [
        plate(0.377),
        Body::new(
            "wall",
            Shape::Pieces(vec![Piece::Triangle([
                Point3::new(0.2, -1.0, -1.0),
                Point3::new(0.3, 1.0, -1.0),
                Point3::new(0.4, 0.0, 2.0),
            ])]),
            0,
        ),
        Body::new(
            "wall",
            Shape::Pieces(vec![Piece::Cylinder {
                pose: Isometry3::translation(0.2, 0.0, 0.0) * Isometry3::rotation(Vector3::y() * 0.5 * PI),
                radius: 1.0,
                half: 0.5 * THIN,
            }]),
            0,
        ),
    ] {
        hits_wall(case(Moves::Space, vec![small_box(0)], &a, &b), &[a.clone(), b.clone()], wall);
    }
}

/// A joint behind the joint `above`, turning about Z.
fn turning(above: usize, along: f64, number: usize) -> Joint {
    Joint {
        above,
        origin: Isometry3::translation(along, 0.0, 0.0),
        axis: Vector3::z(),
        slides: false,
        number: Some((number, 1.0, 0.0)),
        farthest: 0.0,
        is_held: false,
    }
}

fn tree(floats: bool, joints: Vec<Joint>) -> Tree {
    let numbers = joints.iter().filter_map(|joint| joint.number).map(|(i, ..)| i + 1).max().unwrap_or(0);
    Tree { floats, base: Isometry3::identity(), joints, numbers, circles: vec![false; numbers] }
}

/// A small box one metre out along X in the frame behind joint `frame - 1`.
fn hand(frame: usize) -> Body {
    Body::new("robot", Shape::Pieces(box_pieces([0.02; 3], &Isometry3::translation(1.0, 0.0, 0.0))), frame)
}

/// Of two loose triangles, the second is wholly inside of a solid box.
#[test]
fn a_part_inside_of_a_solid_touches_it() {
    let triangle =
        |x: f64| Piece::Triangle([[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]].map(|[y, z]| Point3::new(x, y, z)));
    let there = vec![0.0; 6];
    let robot = vec![Body::new("robot", Shape::Pieces(vec![triangle(-3.0), triangle(0.0)]), 0)];
    let mut inside = case(Moves::Space, robot, &there, &there);
    assert_eq!(inside.clearance_at(&there), Ok(f64::INFINITY));
    inside.still = vec![Body::new("box", Shape::Pieces(box_pieces([2.0; 3], &Isometry3::identity())), 0)];
    assert_eq!(inside.clearance_at(&there), Ok(0.0));
    inside.still = vec![Body::new(
        "box",
        Shape::Pieces(box_pieces([2.0; 3], &Isometry3::translation(3.0, 0.0, 0.0))),
        0,
    )];
    assert!(inside.clearance_at(&there).unwrap() > 1.0);
}

#[test]
fn arms() {
    // The second joint turns back what the first turns: the hand goes around on a circle of radius one about
    // (cos, sin).
    let arm = tree(false, vec![turning(0, 0.0, 0), turning(1, 1.0, 1)]);
    let (a, b) = (vec![-1.0, 0.3], vec![1.0, 0.3]);
    let wall = Body::new(
        "wall",
        Shape::Pieces(box_pieces([4.0, THIN, 1.0], &Isometry3::translation(1.0, 0.6, 0.0))),
        0,
    );
    hits_wall(case(Moves::Tree(arm), vec![hand(2)], &a, &b), &[a.clone(), b.clone()], wall);
    // A joint that slides and one that mimics it.
    let slide = |above, axis, factor| Joint {
        above,
        origin: Isometry3::identity(),
        axis,
        slides: true,
        number: Some((0, factor, 0.0)),
        farthest: 3.0 * f64::abs(factor),
        is_held: false,
    };
    let arm = tree(false, vec![slide(0, Vector3::x(), 1.0), slide(1, Vector3::y(), 0.1)]);
    hits_wall(
        case(Moves::Tree(arm), vec![small_box(2)], &[-2.0], &[2.0]),
        &[vec![-2.0], vec![2.0]],
        plate(0.377),
    );
}

#[test]
fn continuous_joints_go_the_shorter_way() {
    let mut arm = tree(false, vec![turning(0, 0.0, 0)]);
    arm.circles[0] = true;
    // From 3 to -3 it passes π, not 0.
    let rows = [vec![3.0], vec![-3.0]];
    let wall = |x| {
        Body::new(
            "wall",
            Shape::Pieces(box_pieces([0.5, THIN, 0.5], &Isometry3::translation(x, 0.0, 0.0))),
            0,
        )
    };
    let mut there = case(Moves::Tree(arm), vec![hand(1)], &rows[0], &rows[1]);
    there.still = vec![wall(1.0)];
    assert_eq!(there.judge(&rows).fault, None);
    there.still = vec![wall(-1.0)];
    assert!(matches!(there.judge(&rows).fault, Some(Fault::Contact { .. })));
}

#[test]
fn links_hit_each_other() {
    let mut arm = case(
        Moves::Tree(tree(false, vec![turning(0, 0.0, 0), turning(0, 0.0, 1)])),
        vec![hand(1), hand(2)],
        &[-1.0, 1.0],
        &[1.0, -1.0],
    );
    let rows = [vec![-1.0, 1.0], vec![1.0, -1.0]];
    assert_eq!(arm.judge(&rows).fault, None);
    arm.pairs = vec![[0, 1]];
    assert!(matches!(arm.judge(&rows).fault, Some(Fault::Contact { .. })));
}

#[test]
fn bodies_that_fly() {
    let flying = tree(true, vec![turning(0, 0.0, 0)]);
    let (a, b) = (vec![-3.3, 0.1, 0.0, 1.0, 0.5, 0.0, 1.0], vec![2.0, 0.0, 0.1, -1.0, 0.0, 2.0, -1.0]);
    hits_wall(case(Moves::Tree(flying), vec![hand(1)], &a, &b), &[a.clone(), b.clone()], plate(-0.777));
}

#[test]
fn obstacles_that_move() {
    // The robot goes to the right, a wall to the left, and they meet.
    let meets = |moves: Moves, robot: Body, wall: Body, rows: [Vec<f64>; 2]| {
        let goal = &rows[1][..rows[1].len() - 1];
        let mut there = case(moves, vec![robot], &rows[0], goal);
        there.timing = Some(Timing { speed: Some(1.0), start: 0.0, goal: [0.0, 10.0] });
        let at = |x: f64| Isometry3::from(Translation3::new(x, 0.0, 0.0));
        there.moving = vec![Mover { body: wall.clone(), rows: vec![(1.0, at(3.0)), (4.0, at(-3.0))] }];
        assert!(matches!(there.judge(&rows).fault, Some(Fault::Contact { .. })));
        // Two seconds later the wall has gone by before the robot is there.
        there.moving[0].rows = vec![(0.0, at(3.0)), (0.1, at(-3.0))];
        assert_eq!(there.judge(&rows).fault, None);
        // Twice as fast is too fast.
        let last = rows[1].len() - 1;
        let mut fast = rows.clone();
        fast[1][last] = 0.5;
        assert!(matches!(there.judge(&fast).fault, Some(Fault::Invalid(_))));
    };
    meets(Moves::Point, disc(), line_wall(0.0), [vec![-1.0, 0.0, 0.0], vec![1.0, 0.0, 5.0]]);
    meets(Moves::Plane, polygon(), line_wall(0.0), [vec![-1.0, 0.0, 1.0, 0.0], vec![1.0, 0.0, 0.0, 5.0]]);
    let still = [0.0; 3];
    let row = |x: f64, time: f64| [&[x, 0.0, 0.0], &still[..], &[time]].concat();
    meets(Moves::Space, small_box(0), plate(0.0), [row(-1.0, 0.0), row(1.0, 5.0)]);
}

#[test]
fn robots_moved_by_inputs() {
    let drive = |kind, count: usize, velocities: usize| Drive {
        kind,
        limits: vec![[-2.0, 2.0]; count],
        velocities: vec![3.0; velocities],
        longest: 3.0,
    };
    let driven = |moves: Moves, robot: Body, drive: Drive, rows: [Vec<f64>; 2], wall: Body| {
        let own = moves.numbers() + drive.velocities.len();
        let goal = rows[1][..own].to_vec();
        let mut there = case(moves, vec![robot], &rows[0][..own], &goal);
        there.drive = Some(drive);
        hits_wall(there.clone(), &rows, wall);
        // Another state than the one that the input leads to.
        let mut leap = rows.clone();
        leap[1][0] += 1e-3;
        there.goals = vec![vec![Ask::Free; own]];
        assert!(matches!(there.judge(&leap).fault, Some(Fault::Invalid(_))));
        // An input beyond its limits.
        let mut strong = rows;
        strong[1][own] = 2.5;
        assert!(matches!(there.judge(&strong).fault, Some(Fault::Invalid(_))));
    };
    // A quarter of a circle of radius one, from (0, 0) to (1, 1).
    let quarter = [vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0], vec![1.0, 1.0, 0.5 * PI, 1.0, 1.0, 0.5 * PI]];
    driven(Moves::Plane, polygon(), drive(DriveKind::Unicycle, 2, 0), quarter.clone(), line_wall(0.377));
    let mut car = quarter;
    car[1][4] = mp_math::atan(0.5);
    driven(Moves::Plane, polygon(), drive(DriveKind::Car(0.5), 2, 0), car, line_wall(0.377));
    let straight = [vec![-1.0, 0.0, 0.0, 0.0, 0.0], vec![1.0, 0.5, 1.0, 0.25, 2.0]];
    driven(Moves::Point, disc(), drive(DriveKind::Velocities, 2, 0), straight, line_wall(0.377));
    // x = t - t²/2 goes to 1/2 and back: between equal ends only a look in between finds the wall.
    let back = [vec![0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0], vec![0.0, 0.0, -1.0, 0.0, -1.0, 0.0, 2.0]];
    driven(Moves::Point, disc(), drive(DriveKind::Accelerations, 2, 2), back, line_wall(0.48));
    let arm = || Moves::Tree(tree(false, vec![turning(0, 0.0, 0)]));
    let wall = || {
        Body::new(
            "wall",
            Shape::Pieces(box_pieces([0.5, THIN, 0.5], &Isometry3::translation(1.0, 0.0, 0.0))),
            0,
        )
    };
    let turn = [vec![-1.0, 0.0, 0.0], vec![1.0, 1.0, 2.0]];
    driven(arm(), hand(1), drive(DriveKind::Velocities, 1, 0), turn, wall());
    let six = |x: f64| vec![x, 0.0, 0.0, 0.0, 0.0, 0.0];
    let none = vec![0.0; 7];
    let fly = [[six(-1.0), none].concat(), [six(1.0), six(1.0), vec![2.0]].concat()];
    driven(Moves::Space, small_box(0), drive(DriveKind::Velocities, 6, 0), fly, plate(0.377));
}

#[test]
fn ends_and_limits() {
    let (a, b) = (vec![-1.0, 0.1], vec![1.0, 0.0]);
    let there = case(Moves::Point, vec![disc()], &a, &b);
    let rows =
        |rows: &[[f64; 2]]| there.judge(&rows.iter().map(|row| row.to_vec()).collect::<Vec<_>>()).fault;
    assert_eq!(rows(&[[-1.0, 0.1], [4.0, 4.0], [1.0, 0.0]]), None);
    assert!(matches!(rows(&[[-1.0, 0.2], [1.0, 0.0]]), Some(Fault::Ends(_))));
    assert!(matches!(rows(&[[-1.0, 0.1], [1.0, 0.1]]), Some(Fault::Ends(_))));
    assert!(matches!(rows(&[[-1.0, 0.1], [4.0, 5.1], [1.0, 0.0]]), Some(Fault::Invalid(_))));
    assert!(matches!(rows(&[]), Some(Fault::Invalid(_))));
    assert!(matches!(there.judge(&[vec![0.0]]).fault, Some(Fault::Invalid(_))));
    assert!(matches!(there.judge(&[vec![f64::NAN, 0.0]]).fault, Some(Fault::Invalid(_))));
}

#[test]
fn half_turns_have_two_ways() {
    let six = |yaw: f64| vec![0.0, 0.0, 0.0, yaw, 0.0, 0.0];
    let rows = [six(0.0), six(PI)];
    let stick =
        Body::new("robot", Shape::Pieces(box_pieces([0.02; 3], &Isometry3::translation(1.0, 0.0, 0.0))), 0);
    let post = |y: f64| {
        Body::new("wall", Shape::Pieces(box_pieces([0.1; 3], &Isometry3::translation(0.0, y, 0.0))), 0)
    };
    let mut there = case(Moves::Space, vec![stick], &rows[0], &rows[1]);
    for (posts, free) in [(vec![1.0], true), (vec![-1.0], true), (vec![1.0, -1.0], false)] {
        there.still = posts.into_iter().map(post).collect();
        assert_eq!(there.judge(&rows).fault.is_none(), free);
    }
    // A little less than half a turn has one way.
    let rows = [six(0.0), six(3.1)];
    there.goals = vec![rows[1].iter().map(|x| Ask::Exactly(*x)).collect()];
    there.still = vec![post(1.0)];
    assert!(there.judge(&rows).fault.is_some());
    there.still = vec![post(-1.0)];
    assert!(there.judge(&rows).fault.is_none());
}
