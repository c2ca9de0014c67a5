//! Arms and bodies with joints that fly, written as URDF.

use super::bodies::{Form, form, loose, mesh_file, pose};
use super::{World, by_rates, end, goals, line, list, lists, wide_goal};
use crate::draw::Draw;
use crate::oracle::{Body, Case, Joint, Moves, Piece, Shape, Tree};
use nalgebra::{Isometry3, Point3, Vector3};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

/// The half of each side of the room (m), before it is scaled.
pub(super) const HALF: f64 = 3.0;

/// How many configurations say whether two links touch in most of them.
pub(super) const SAMPLES: usize = 12;

/// The numbers of a pose as URDF writes them: the same six, with the angles from the last to the first.
fn origin(six: &[f64; 6]) -> String {
    let [x, y, z, a, b, c] = six;
    format!("<origin xyz=\"{x} {y} {z}\" rpy=\"{c} {b} {a}\"/>")
}

/// A random unit vector, mostly along an axis.
fn axis(draw: &mut Draw) -> Vector3<f64> {
    let along = *draw.one(&[Vector3::x(), Vector3::y(), Vector3::z(), -Vector3::z()]);
    let any = Vector3::new(draw.within(-1.0, 1.0), draw.within(-1.0, 1.0), draw.within(-1.0, 1.0));
    if draw.chance(0.8) || any.norm() < 0.1 { along } else { any.normalize() }
}

/// A collision shape of a link: its element in URDF, and its pieces.
fn collision(
    draw: &mut Draw,
    length: f64,
    name: &str,
    files: &mut BTreeMap<String, Vec<u8>>,
) -> (String, Vec<Piece>) {
    let thick = length * draw.within(0.06, 0.25);
    // Along Z, beginning somewhat behind the joint.
    let mut six = [0.0, 0.0, 0.5 * length, 0.0, 0.0, 0.0];
    if draw.chance(0.3) {
        six[0] = draw.within(-0.3, 0.3) * length;
        (six[3], six[4], six[5]) = (draw.within(-PI, PI), draw.within(-1.0, 1.0), draw.within(-PI, PI));
    }
    let at = pose(six);
    let tall = 0.8 * length;
    let (element, pieces) = match draw.below(6) {
        0 => {
            let radius = thick + 0.1 * length;
            (format!("<sphere radius=\"{radius}\"/>"), Form::Ball(radius).pieces(&at))
        }
        1 => {
            let element = format!("<cylinder radius=\"{thick}\" length=\"{tall}\"/>");
            (element, Form::Cylinder([thick, tall]).pieces(&at))
        }
        2 => {
            let end = |z: f64| at * Point3::new(0.0, 0.0, z);
            let capsule = Piece::Capsule { a: end(-0.4 * length), b: end(0.4 * length), radius: thick };
            (format!("<capsule radius=\"{thick}\" length=\"{tall}\"/>"), vec![capsule])
        }
        3 => {
            let file = mesh_file(draw, name);
            let file = file.replace(".txt", ".off");
            let count = draw.count(2, 8);
            let triangles = loose(draw, count, 0.4 * length);
            Form::Mesh(triangles.clone(), file.clone()).write(files);
            let scale = draw.within(0.2, 1.0);
            let scaled = triangles.iter().map(|t| t.map(|p| p.map(|x| scale * x))).collect();
            let element = format!("<mesh filename=\"{file}\" scale=\"{scale} {scale} {scale}\"/>");
            (element, Form::Mesh(scaled, file).pieces(&at))
        }
        _ => {
            let sides = [2.0 * thick, 2.0 * thick * draw.within(0.3, 1.0), tall];
            let element = format!("<box size=\"{} {} {}\"/>", sides[0], sides[1], sides[2]);
            (element, Form::Box(sides).pieces(&at))
        }
    };
    (format!("<collision>{}<geometry>{element}</geometry></collision>", origin(&six)), pieces)
}

/// A robot as text and as the oracle has it.
pub(super) struct Made {
    pub(super) urdf: String,
    pub(super) srdf: Option<String>,
    pub(super) tree: Tree,
    pub(super) bodies: Vec<Body>,
    /// The frame of the link of each body.
    pub(super) of_link: Vec<usize>,
    /// The frame of the first link.
    pub(super) first: usize,
    pub(super) pairs: Vec<[usize; 2]>,
    /// Limits and name of each number of the joints.
    pub(super) limits: Vec<Option<[f64; 2]>>,
    pub(super) names: Vec<String>,
    pub(super) files: BTreeMap<String, Vec<u8>>,
    pub(super) reach: f64,
}

/// Writes links about as long as `lengths`. Returns the bodies of the robot and the link of each; link i is
/// behind joint i - 1.
fn links(
    draw: &mut Draw,
    floats: bool,
    lengths: &[f64],
    (name, urdf): (&str, &mut String),
    files: &mut BTreeMap<String, Vec<u8>>,
) -> (Vec<Body>, Vec<usize>) {
    let (mut bodies, mut of_link) = (Vec::new(), Vec::new());
    for (link, length) in lengths.iter().enumerate() {
        let mut elements = String::new();
        let shapes = match link {
            0 if !floats => draw.below(2),
            0 => 1,
            // The last link has a shape: something has to move.
            _ if link + 1 == lengths.len() => draw.count(1, 2),
            _ => *draw.one(&[0, 1, 1, 1, 2]),
        };
        for shape in 0..shapes {
            let (element, pieces) = collision(draw, *length, &format!("part{name}-{link}-{shape}"), files);
            elements += &element;
            bodies.push(Body::new(format!("link{link}"), Shape::Pieces(pieces), link));
            of_link.push(link);
        }
        line(urdf, format!("<link name=\"link{link}\">{elements}</link>"));
    }
    (bodies, of_link)
}

/// A random robot.
fn made(draw: &mut Draw, floats: bool, scale: f64) -> Made {
    let mut made = without_pairs(draw, floats, scale, "");
    made.pair_links(draw);
    made
}

/// A random robot, of whose links it is not yet known which are compared. Names of its files have `name` in
/// them.
pub(super) fn without_pairs(draw: &mut Draw, floats: bool, scale: f64, name: &str) -> Made {
    let count = if floats { draw.count(1, 3) } else { draw.count(1, 7) };
    let mut files = BTreeMap::new();
    let mut urdf = String::from("<?xml version=\"1.0\"?>\n<robot name=\"arm\">\n");
    let mut joints: Vec<Joint> = Vec::new();
    let mut limits: Vec<Option<[f64; 2]>> = Vec::new();
    let mut names = Vec::new();
    let mut reach = 0.0;
    let lengths: Vec<f64> = (0..=count).map(|_| scale * draw.within(0.25, 0.9)).collect();
    let (bodies, of_link) = links(draw, floats, &lengths, (name, &mut urdf), &mut files);
    for j in 0..count {
        // Mostly a chain; rarely a branch.
        let above = if draw.chance(0.85) { j } else { draw.below(j + 1) };
        let mut six = [0.0, 0.0, lengths[above] * draw.within(0.8, 1.1), 0.0, 0.0, 0.0];
        if draw.chance(0.4) {
            (six[3], six[4], six[5]) = (draw.within(-PI, PI), draw.within(-1.2, 1.2), draw.within(-PI, PI));
        }
        let axis = axis(draw);
        // Something has to move: the first joint does.
        let kind = if j == 0 { draw.below(4) } else { draw.below(8) };
        let followed = limits.iter().rposition(Option::is_some);
        let mut text =
            format!("<parent link=\"link{above}\"/><child link=\"link{}\"/>{}", j + 1, origin(&six));
        text += &format!("<axis xyz=\"{} {} {}\"/>", axis.x, axis.y, axis.z);
        let limit = |low: f64, high: f64| {
            format!("<limit lower=\"{low}\" upper=\"{high}\" effort=\"1\" velocity=\"1\"/>")
        };
        let (word, slides, number, farthest) = match kind {
            3 => {
                limits.push(None);
                ("continuous", false, Some((limits.len() - 1, 1.0, 0.0)), 0.0)
            }
            2 => {
                let ends = [-scale * draw.within(0.0, 0.4), scale * draw.within(0.1, 0.6)];
                text += &limit(ends[0], ends[1]);
                limits.push(Some(ends));
                ("prismatic", true, Some((limits.len() - 1, 1.0, 0.0)), ends[1].max(-ends[0]))
            }
            6 => ("fixed", false, None, 0.0),
            7 if followed.is_some() => {
                let i = followed.unwrap_or(0);
                let (factor, shift) = (draw.within(-1.5, 1.5), draw.within(-0.3, 0.3));
                text += &limit(-1e9, 1e9);
                let name: &String = &names[i];
                text += &format!("<mimic joint=\"{name}\" multiplier=\"{factor}\" offset=\"{shift}\"/>");
                ("revolute", false, Some((i, factor, shift)), 0.0)
            }
            _ => {
                let ends = [-draw.within(0.2, 3.0), draw.within(0.2, 3.0)];
                text += &limit(ends[0], ends[1]);
                limits.push(Some(ends));
                ("revolute", false, Some((limits.len() - 1, 1.0, 0.0)), 0.0)
            }
        };
        if names.len() < limits.len() {
            names.push(format!("joint{j}"));
        }
        line(&mut urdf, format!("<joint name=\"joint{j}\" type=\"{word}\">{text}</joint>"));
        reach += pose(six).translation.vector.norm() + farthest;
        joints.push(Joint { above, origin: pose(six), axis, slides, number, farthest, is_held: false });
    }
    urdf += "</robot>\n";
    reach += lengths.iter().fold(0.0, |most: f64, x| most.max(*x));
    let circles = limits.iter().map(Option::is_none).collect();
    let base = Isometry3::identity();
    let tree = Tree { floats, base, joints, numbers: limits.len(), circles };
    Made { urdf, srdf: None, tree, bodies, of_link, first: 0, pairs: Vec::new(), limits, names, files, reach }
}

impl Made {
    /// The frame that moves with a link: a fixed joint has none of its own.
    pub(super) fn moving_frame(&self, mut link: usize) -> usize {
        while link > 0 && !self.tree.joints[link - 1].is_joint() {
            link = self.tree.joints[link - 1].above;
        }
        link
    }

    /// Finds out which links are compared, and writes down those that may touch.
    pub(super) fn pair_links(&mut self, draw: &mut Draw) {
        let mut file = draw.chance(0.5);
        let (mut all, mut may_touch, neutral_touches) = self.pairs_and_touching(draw, file);
        // Without this file, links that always touch are found by the program. That cannot be if none touch
        // at the neutral one.
        if !file && (neutral_touches || !may_touch.is_empty()) {
            file = true;
            (all, may_touch, _) = self.pairs_and_touching(draw, file);
        }
        if file {
            let lines = may_touch.iter().map(|pair| {
                let [a, b] = pair.map(|link| link - self.first);
                format!("<disable_collisions link1=\"link{a}\" link2=\"link{b}\" reason=\"Default\"/>\n")
            });
            self.srdf = Some(format!("<robot name=\"arm\">\n{}</robot>\n", lines.collect::<String>()));
        }
        self.pairs = all;
    }

    /// The pairs of bodies that a robot with or without an SRDF compares, those of links that may touch as they do in most configurations, and
    /// whether any touch at the neutral one.
    fn pairs_and_touching(
        &self,
        draw: &mut Draw,
        file: bool,
    ) -> (Vec<[usize; 2]>, BTreeSet<[usize; 2]>, bool) {
        let of_link = &self.of_link;
        // A joint connects the links that move with its child to those that move with its parent; with a file its own two
        // links alone, and of the base only its own. A link without bodies stands for those next to it.
        let above_of = |link: usize| self.tree.joints[link - 1].above;
        let is_near = |top: usize, link: usize| {
            if self.moving_frame(top) != self.moving_frame(link) {
                return false;
            }
            let between: Vec<usize> =
                std::iter::successors(Some(link), |at| (*at > top).then(|| above_of(*at))).collect();
            between.last() == Some(&top)
                && between[1..]
                    .split_last()
                    .is_none_or(|(_, inner)| inner.iter().all(|at| !of_link.contains(at)))
        };
        let joined = |a: usize, b: usize| {
            let child_of = |child: usize, parent: usize| {
                let moved = self.moving_frame(child);
                moved > 0 && {
                    let above = self.tree.joints[moved - 1].above;
                    let of_parent = above == parent || (!of_link.contains(&above) && is_near(parent, above));
                    let of_child = moved == child || (!of_link.contains(&moved) && is_near(moved, child));
                    match self.moving_frame(above) {
                        _ if file => of_parent && of_child,
                        0 => of_parent,
                        body => body == self.moving_frame(parent),
                    }
                }
            };
            child_of(a, b) || child_of(b, a)
        };
        let mut all = Vec::new();
        for (j, b) in of_link.iter().enumerate() {
            for (i, a) in of_link.iter().enumerate().take(j) {
                if self.moving_frame(*a) != self.moving_frame(*b) && !joined(*a, *b) {
                    all.push([i, j]);
                }
            }
        }
        let neutral =
            self.limits.iter().map(|limits| limits.map_or(0.0, |[low, high]| 0.0_f64.clamp(low, high)));
        let mut samples: Vec<Vec<f64>> = vec![neutral.collect()];
        for _ in 0..SAMPLES {
            samples.push(self.joint_values(draw));
        }
        let mut case = self.case();
        case.still.clear();
        let touches = |case: &Case, sample: &Vec<f64>| {
            let root = if self.tree.floats { vec![0.0; 6] } else { Vec::new() };
            let row: Vec<f64> = root.into_iter().chain(sample.iter().copied()).collect();
            case.clearance_at(&row).is_ok_and(|clearance| clearance <= 0.0)
        };
        let (mut may_touch, mut neutral_touches) = (BTreeSet::new(), false);
        for pair in &all {
            case.pairs = vec![*pair];
            let count = samples.iter().filter(|sample| touches(&case, sample)).count();
            neutral_touches |= touches(&case, &samples[0]);
            if 2 * count > samples.len() {
                may_touch.insert(pair.map(|i| of_link[i]));
            }
        }
        all.retain(|pair| !may_touch.contains(&pair.map(|i| of_link[i])));
        (all, may_touch, neutral_touches)
    }

    pub(super) fn joint_values(&self, draw: &mut Draw) -> Vec<f64> {
        let value = |limits: &Option<[f64; 2]>| match limits {
            Some([low, high]) => draw.within(*low, *high),
            None => draw.within(-PI, PI),
        };
        self.limits.iter().map(value).collect()
    }

    /// The names of the numbers that goals may leave open, and the widths of intervals of them.
    fn names_and_widths(&self, scale: f64) -> (Vec<String>, Vec<f64>) {
        let (mut names, mut widths) = (Vec::new(), Vec::new());
        if self.tree.floats {
            names.extend(["x", "y", "z", "alpha", "beta", "gamma"].map(str::to_owned));
            widths.extend([0.4 * scale, 0.4 * scale, 0.4 * scale, 0.5, 0.05, 0.5]);
        }
        names.extend(self.names.iter().cloned());
        widths.extend(self.tree.joints.iter().filter_map(|joint| {
            let first = joint.number.is_some_and(|(_, factor, shift)| factor == 1.0 && shift == 0.0);
            first.then_some(if joint.slides { 0.1 * scale } else { 0.3 })
        }));
        (names, widths)
    }

    pub(super) fn case(&self) -> Case {
        let root: &[Option<[f64; 2]>] = if self.tree.floats { &[None; 6] } else { &[] };
        let limits = [root, &self.limits].concat();
        let case = Case::new(Moves::Tree(self.tree.clone()), self.bodies.clone(), limits, 2.0 * self.reach);
        Case { pairs: self.pairs.clone(), ..case }
    }
}

/// An arm among figures; some move by inputs.
pub(super) fn arm(draw: &mut Draw) -> World {
    jointed(draw, false)
}

/// A body with joints that flies among figures.
pub(super) fn floating(draw: &mut Draw) -> World {
    jointed(draw, true)
}

/// A random pose at most `half` from the middle in each direction.
pub(super) fn placed(draw: &mut Draw, half: f64) -> [f64; 6] {
    let [x, y, z] = [0; 3].map(|_| draw.within(-half, half));
    [x, y, z, draw.within(-PI, PI), draw.within(-1.5, 1.5), draw.within(-PI, PI)]
}

/// Adds figures to a world. Returns their tables, and the radius of the largest round one.
pub(super) fn obstacles(
    draw: &mut Draw,
    scale: f64,
    case: &mut Case,
    files: &mut BTreeMap<String, Vec<u8>>,
) -> (String, f64) {
    let (mut text, mut round) = (String::new(), 0.0_f64);
    for i in 0..draw.count(0, 7) {
        let name = format!("obstacle-{}", i + 1);
        let size = draw.within(0.2, 1.6);
        let form = form(draw, size * scale, &name);
        let six = placed(draw, scale * HALF);
        let table = format!("\n[[obstacle]]\nname = \"{name}\"\n{}\npose = {}", form.toml(), list(&six));
        line(&mut text, table);
        form.write(files);
        case.still.push(form.body(&name, &pose(six), 0));
        round = round.max(form.round());
    }
    (text, round)
}

fn jointed(draw: &mut Draw, floats: bool) -> World {
    let scale = if draw.chance(0.8) { 1.0 } else { draw.logarithmic(1e-3, 1e3) };
    let mut made = made(draw, floats, if floats { 0.5 * scale } else { scale });
    let half = scale * HALF;
    let mut files = std::mem::take(&mut made.files);
    let (low, high) = ([-half; 3], [half; 3]);
    let base = if floats || draw.chance(0.5) {
        [0.0; 6]
    } else {
        let at = |draw: &mut Draw| scale * draw.within(-1.0, 1.0);
        [at(draw), at(draw), at(draw), draw.within(-PI, PI), draw.within(-1.0, 1.0), draw.within(-PI, PI)]
    };
    made.tree.base = pose(base);
    let mut case = made.case();
    case.extent = 2.0 * half.max(made.reach);
    case.far = case.extent + 2.0 * scale;
    let mut text = String::from("[robot]\nurdf = \"arm.urdf\"\n");
    files.insert("arm.urdf".to_owned(), made.urdf.clone().into_bytes());
    if let Some(srdf) = &made.srdf {
        line(&mut text, "srdf = \"arm.srdf\"");
        files.insert("arm.srdf".to_owned(), srdf.clone().into_bytes());
    }
    if floats {
        line(&mut text, format!("base = \"floating\"\nbounds = {}", lists([&low[..], &high[..]])));
        (0..3).for_each(|i| case.limits[i] = Some([low[i], high[i]]));
    } else {
        line(&mut text, format!("base = {}", list(&base)));
    }
    let (obstacles, round) = obstacles(draw, scale, &mut case, &mut files);
    let margin = 0.05 * round.max(0.3 * scale) + 1e-3 * made.reach;
    let configuration = |draw: &mut Draw| {
        let mut row = if floats { placed(draw, half).to_vec() } else { Vec::new() };
        row.extend(made.joint_values(draw));
        row
    };
    let (names, widths) = made.names_and_widths(scale);
    let inputs = !floats && draw.chance(0.25);
    if !inputs {
        case.start = end(draw, &case, margin, configuration);
        let free = |draw: &mut Draw| end(draw, &case, margin, configuration);
        let (asked, goal) = goals(draw, &names, &widths, free);
        case.goals = asked;
        line(&mut text, format!("\n[motion]\nstart = {}\n{goal}", list(&case.start)));
    } else {
        let time = draw.logarithmic(0.05, 1.5);
        let by_velocities = draw.chance(0.5);
        let drawn =
            |draw: &mut Draw| widths.iter().map(|width| width * draw.within(2.0, 8.0)).collect::<Vec<f64>>();
        let (speeds, accelerations) = (drawn(draw), drawn(draw));
        let (drive, lines) = by_rates(time, speeds, (!by_velocities).then_some(accelerations));
        lines.iter().for_each(|extra| line(&mut text, extra));
        let resting = drive.velocities.len();
        case.drive = Some(drive);
        let whole = |draw: &mut Draw| {
            let mut row = configuration(draw);
            row.extend(std::iter::repeat_n(0.0, resting));
            row
        };
        case.start = end(draw, &case, margin, whole);
        let row = end(draw, &case, margin, whole);
        let own = names.len();
        let wide: Vec<f64> = widths.iter().map(|width| width * 1.5).collect();
        let (goal, goal_text) = wide_goal(draw, &names, &row[..own], &wide);
        case.goals = vec![goal];
        line(&mut text, format!("\n[motion]\nstart = {}\n{goal_text}", list(&case.start[..own])));
    }
    text += &obstacles;
    World::of_toml(text, files, case, margin)
}
