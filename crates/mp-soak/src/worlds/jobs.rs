//! What people ask of arms: held joints, bases that move in the plane, things that links carry, and two
//! robots at once.

use super::arms::{HALF, Made, SAMPLES, obstacles, placed, without_pairs};
use super::bodies::{Form, form, pose};
use super::{World, end, goals, line, list, lists};
use crate::draw::Draw;
use crate::oracle::{Body, Case, Joint, Shape};
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// A robot, and what its table says.
struct Robot {
    made: Made,
    base: Isometry3<f64>,
    lines: Vec<String>,
}

/// Arms among figures.
pub(super) fn jobs(draw: &mut Draw) -> World {
    let scale = if draw.chance(0.8) { 1.0 } else { draw.logarithmic(1e-2, 1e2) };
    let two = draw.chance(0.4);
    let (mut text, mut files) = (String::new(), BTreeMap::new());
    let mut made = named(draw, scale, if two { "a/" } else { "" }, &mut text, &mut files);
    if two {
        made = together(made, named(draw, scale, "b/", &mut text, &mut files));
    }
    files.append(&mut made.files);
    let carried = if draw.chance(0.6) { attached(draw, scale, &mut made, &mut files) } else { String::new() };
    let mut case = made.case();
    case.extent = 2.0 * (scale * HALF).max(made.reach);
    case.far = case.extent + 2.0 * scale;
    let (obstacles, round) = obstacles(draw, scale, &mut case, &mut files);
    let cloud = if draw.chance(0.4) { cloud(draw, scale, &mut case) } else { String::new() };
    let margin = 0.05 * round.max(0.3 * scale) + 1e-3 * made.reach;
    let configuration = |draw: &mut Draw| made.joint_values(draw);
    case.start = end(draw, &case, margin, configuration);
    let widths: Vec<f64> =
        made.limits.iter().map(|limits| limits.map_or(0.3, |[low, high]| 0.1 * (high - low))).collect();
    let quoted: Vec<String> = made.names.iter().map(|name| format!("\"{name}\"")).collect();
    let (asked, goal) = goals(draw, &quoted, &widths, |draw| end(draw, &case, margin, configuration));
    case.goals = asked;
    line(&mut text, format!("\n[motion]\nstart = {}\n{goal}", list(&case.start)));
    text += &carried;
    text += &obstacles;
    text += &cloud;
    World::of_toml(text, files, case, margin)
}

/// A random robot as it is in a scene in which its names begin with `prefix`. Writes its table and its files.
fn named(
    draw: &mut Draw,
    scale: f64,
    prefix: &str,
    text: &mut String,
    files: &mut BTreeMap<String, Vec<u8>>,
) -> Made {
    let name = prefix.trim_end_matches('/');
    let robot = robot(draw, scale, name);
    line(text, if name.is_empty() { "[robot]".to_owned() } else { format!("[[robot]]\nname = \"{name}\"") });
    line(text, format!("urdf = \"arm{name}.urdf\""));
    files.insert(format!("arm{name}.urdf"), robot.made.urdf.clone().into_bytes());
    if let Some(srdf) = &robot.made.srdf {
        line(text, format!("srdf = \"arm{name}.srdf\""));
        files.insert(format!("arm{name}.srdf"), srdf.clone().into_bytes());
    }
    robot.lines.iter().for_each(|extra| line(text, extra));
    alone(robot, prefix)
}

/// A random robot, some of whose joints may be held, on a base that stands or moves in the plane.
fn robot(draw: &mut Draw, scale: f64, name: &str) -> Robot {
    let mut made = without_pairs(draw, false, scale, name);
    made.pair_links(draw);
    let mut lines = Vec::new();
    if made.limits.len() > 1 && draw.chance(0.5) {
        let number = draw.below(made.limits.len());
        let [low, high] = made.limits[number].unwrap_or([-PI, PI]);
        let value = draw.within(low, high);
        lines.push(format!("hold = {{ {} = {value:?} }}", made.names[number]));
        hold(&mut made, number, value);
    }
    let base = if draw.chance(0.4) {
        let half = scale * draw.within(0.5, 2.0);
        lines.push(format!("base = \"planar\"\nbounds = {}", lists([&[-half; 2][..], &[half; 2][..]])));
        drive(&mut made, half);
        Isometry3::identity()
    } else {
        let six = placed(draw, scale);
        lines.push(format!("base = {}", list(&six)));
        pose(six)
    };
    Robot { made, base, lines }
}

/// Holds the joint of a number at a value: it and those that follow it are fixed then.
fn hold(made: &mut Made, number: usize, value: f64) {
    for joint in &mut made.tree.joints {
        match joint.number {
            Some((i, factor, shift)) if i == number => {
                let at = factor * value + shift;
                joint.origin *= match joint.slides {
                    true => Isometry3::from(Translation3::from(joint.axis * at)),
                    false => Isometry3::from_parts(
                        Translation3::identity(),
                        UnitQuaternion::from_axis_angle(&Unit::new_normalize(joint.axis), at),
                    ),
                };
                (joint.number, joint.is_held) = (None, true);
            }
            Some((i, factor, shift)) if i > number => joint.number = Some((i - 1, factor, shift)),
            _ => {}
        }
    }
    made.limits.remove(number);
    made.names.remove(number);
    made.tree.circles.remove(number);
    made.tree.numbers -= 1;
}

/// Puts a robot on a base that moves in the plane: three joints before all others.
fn drive(made: &mut Made, half: f64) {
    const JOINTS: usize = 3;
    for joint in &mut made.tree.joints {
        joint.above += JOINTS;
        joint.number = joint.number.map(|(i, factor, shift)| (i + JOINTS, factor, shift));
    }
    let joint = |above: usize, axis: Vector3<f64>, slides: bool| Joint {
        above,
        origin: Isometry3::identity(),
        axis,
        slides,
        number: Some((above, 1.0, 0.0)),
        farthest: if slides { half } else { 0.0 },
        is_held: false,
    };
    let base = [joint(0, Vector3::x(), true), joint(1, Vector3::y(), true), joint(2, Vector3::z(), false)];
    made.tree.joints.splice(0..0, base);
    made.bodies.iter_mut().for_each(|body| body.frame += JOINTS);
    made.of_link.iter_mut().for_each(|link| *link += JOINTS);
    made.first = JOINTS;
    let room = Some([-half, half]);
    made.limits.splice(0..0, [room, room, None]);
    made.names.splice(0..0, ["x", "y", "theta"].map(str::to_owned));
    made.tree.circles.splice(0..0, [false, false, true]);
    made.tree.numbers += JOINTS;
    made.reach += 2.0 * half;
}

/// A robot by the names that it has in a scene, on a root that stands in the world.
fn alone(robot: Robot, prefix: &str) -> Made {
    let Robot { mut made, base, .. } = robot;
    for joint in &mut made.tree.joints {
        joint.above += 1;
    }
    let (origin, farthest) = (base, 0.0);
    let root =
        Joint { above: 0, origin, axis: Vector3::x(), slides: false, number: None, farthest, is_held: false };
    made.tree.joints.insert(0, root);
    made.bodies.iter_mut().for_each(|body| {
        body.frame += 1;
        body.name.insert_str(0, prefix);
    });
    made.of_link.iter_mut().for_each(|link| *link += 1);
    made.names.iter_mut().for_each(|name| name.insert_str(0, prefix));
    made.reach += base.translation.vector.norm();
    made
}

/// Two robots as one. Links of different robots must not touch, unless neither moves.
fn together(mut a: Made, b: Made) -> Made {
    let (frames, numbers, bodies) = (a.tree.joints.len(), a.tree.numbers, a.bodies.len());
    let moved = |frame: usize| if frame == 0 { 0 } else { frame + frames };
    a.tree.joints.extend(b.tree.joints.into_iter().map(|joint| Joint {
        above: moved(joint.above),
        number: joint.number.map(|(i, factor, shift)| (i + numbers, factor, shift)),
        ..joint
    }));
    a.tree.numbers += b.tree.numbers;
    a.tree.circles.extend(b.tree.circles);
    a.bodies.extend(b.bodies.into_iter().map(|mut body| {
        body.frame = moved(body.frame);
        body
    }));
    a.of_link.extend(b.of_link.into_iter().map(moved));
    a.pairs.extend(b.pairs.into_iter().map(|pair| pair.map(|i| i + bodies)));
    let stands: Vec<bool> = a.of_link.iter().map(|link| a.moving_frame(*link) == 0).collect();
    for i in 0..bodies {
        let others = (bodies..a.bodies.len()).filter(|j| !(stands[i] && stands[*j]));
        a.pairs.extend(others.map(|j| [i, j]));
    }
    a.limits.extend(b.limits);
    a.names.extend(b.names);
    a.files.extend(b.files);
    a.reach += b.reach;
    a
}

/// Adds a cloud of points, each a ball. Returns its table. No two points share a cell, so that none is left
/// out.
fn cloud(draw: &mut Draw, scale: f64, case: &mut Case) -> String {
    let (count, radius) = (draw.count(1, 60), scale * draw.within(0.005, 0.1));
    let (middle, half) = ([0; 3].map(|_| draw.within(-HALF, HALF)), draw.within(0.1, 2.0));
    let points: Vec<[f64; 3]> =
        (0..count).map(|_| middle.map(|x| scale * (x + draw.within(-half, half)))).collect();
    let six = placed(draw, 0.3 * scale);
    let at = pose(six);
    let balls = points
        .iter()
        .flat_map(|p| Form::Ball(radius).pieces(&(at * Isometry3::translation(p[0], p[1], p[2]))));
    case.still.push(Body::new("cloud".to_owned(), Shape::Pieces(balls.collect()), 0));
    format!(
        "\n[[obstacle]]\nname = \"cloud\"\npoints = {{ radius = {radius:?}, cell = {:?}, at = {} }}\npose = {}\n",
        1e-9 * scale,
        lists(points.iter().map(|p| &p[..])),
        list(&six)
    )
}

/// Attaches a figure to a link that has a shape. Links that it touches in most configurations may touch it.
/// Returns its table.
fn attached(draw: &mut Draw, scale: f64, made: &mut Made, files: &mut BTreeMap<String, Vec<u8>>) -> String {
    let on = draw.below(made.bodies.len());
    let (link, frame) = (made.bodies[on].name.clone(), made.of_link[on]);
    let size = scale * draw.within(0.1, 0.5);
    let figure = form(draw, size, "thing");
    let six = placed(draw, 0.4 * scale);
    let thing = made.bodies.len();
    made.bodies.push(figure.body("thing", &pose(six), frame));
    made.reach += scale;
    figure.write(files);
    let own = made.moving_frame(frame);
    let others: Vec<usize> = (0..thing).filter(|i| made.moving_frame(made.of_link[*i]) != own).collect();
    let mut case = made.case();
    let samples: Vec<Vec<f64>> = (0..SAMPLES).map(|_| made.joint_values(draw)).collect();
    let mut may_touch = std::collections::BTreeSet::new();
    for i in &others {
        case.pairs = vec![[*i, thing]];
        let touches = |row: &&Vec<f64>| case.clearance_at(row).is_ok_and(|clearance| clearance <= 0.0);
        if 2 * samples.iter().filter(touches).count() > SAMPLES {
            may_touch.insert(made.bodies[*i].name.clone());
        }
    }
    let kept = others.into_iter().filter(|i| !may_touch.contains(&made.bodies[*i].name));
    made.pairs.extend(kept.map(|i| [i, thing]).collect::<Vec<_>>());
    made.of_link.push(frame);
    let may: Vec<String> = may_touch.iter().map(|name| format!("\"{name}\"")).collect();
    format!(
        "\n[[attached]]\nname = \"thing\"\nlink = \"{link}\"\n{}\npose = {}\nmay_touch = [{}]\n",
        figure.toml(),
        list(&six),
        may.join(", ")
    )
}
