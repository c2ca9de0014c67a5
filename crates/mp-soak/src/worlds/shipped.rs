//! Shipped scenes with other starts and goals: environments, and the wrench.

use super::bodies::{Form, pose};
use super::{World, end, list};
use crate::draw::Draw;
use crate::oracle::{Ask, Body, Case, Joint, Moves, Piece, Shape, Tree, box_pieces};
use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// The environments, all of which have small meshes.
const ENVIRONMENTS: [&str; 9] =
    ["easy", "twisty", "maze", "planar-bugtrap", "cubicles", "gempa-1", "gempa-2", "gempa-3", "gempa-4"];

/// This many triangles of an obstacle are one body of the oracle, which compares bodies by balls around them
/// first.
const CHUNK: usize = 16;

/// The bytes of a shipped file.
fn bytes(path: &str) -> &'static [u8] {
    mp_scenes::file(path).map_or(&[], |file| file.bytes)
}

/// The numbers of a text, apart from comments and words.
fn numbers(text: &str) -> Vec<f64> {
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default());
    lines.flat_map(str::split_whitespace).filter_map(|word| word.parse().ok()).collect()
}

/// The triangles of a shipped mesh: OFF with convex faces, or loose triangles.
fn mesh(path: &str) -> Vec<[Point3<f64>; 3]> {
    let text = String::from_utf8_lossy(bytes(path));
    let all = numbers(&text);
    let point = |at: usize| Point3::new(all[at], all[at + 1], all[at + 2]);
    if !path.ends_with(".off") {
        return (0..all[0] as usize).map(|i| [0, 3, 6].map(|k| point(1 + 9 * i + k))).collect();
    }
    let (vertices, faces) = (all[0] as usize, all[1] as usize);
    let mut at = 3 + 3 * vertices;
    let mut triangles = Vec::new();
    for _ in 0..faces {
        let count = all[at] as usize;
        let corner = |k: usize| point(3 + 3 * all[at + 1 + k] as usize);
        triangles.extend((2..count).map(|k| [corner(0), corner(k - 1), corner(k)]));
        at += 1 + count;
    }
    triangles
}

/// The bodies of a mesh at a pose.
fn bodies(name: &str, triangles: &[[Point3<f64>; 3]], pose: &Isometry3<f64>) -> Vec<Body> {
    let moved = |t: &[Point3<f64>; 3]| Piece::Triangle(t.map(|p| pose * p));
    let chunks = triangles.chunks(CHUNK);
    chunks.map(|chunk| Body::new(name, Shape::Pieces(chunk.iter().map(moved).collect()), 0)).collect()
}

/// The shipped files whose names begin so.
fn files(beginnings: &[String]) -> BTreeMap<String, Vec<u8>> {
    let kept = |path: &str| beginnings.iter().any(|beginning| path.starts_with(beginning.as_str()));
    let all = mp_scenes::FILES.iter().filter(|file| kept(file.path));
    all.map(|file| (file.path.to_owned(), file.bytes.to_vec())).collect()
}

/// A shipped scene, with its own start and goal or random ones.
pub(super) fn shipped(draw: &mut Draw) -> World {
    if draw.chance(0.4) { wrench(draw) } else { environment(draw) }
}

fn environment(draw: &mut Draw) -> World {
    let name = *draw.one(&ENVIRONMENTS);
    let main = format!("scenes/{name}.env");
    let text = String::from_utf8_lossy(bytes(&main)).into_owned();
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let six = |line: &str| -> [f64; 6] {
        let all = numbers(line);
        std::array::from_fn(|i| all.get(i).copied().unwrap_or(0.0))
    };
    let file = |line: &str| format!("scenes/{line}");
    let robot = mesh(&file(lines[1]));
    let (own_start, own_goal) = (six(lines[2]), six(lines[3]));
    let mut still = Vec::new();
    let mut meshes = vec![lines[1]];
    let mut at = 4;
    while lines[at].starts_with("Obstacle") {
        still.extend(bodies(lines[at], &mesh(&file(lines[at + 1])), &pose(six(lines[at + 2]))));
        meshes.push(lines[at + 1]);
        at += 3;
    }
    let line = |word: &str| lines.iter().find(|line| line.starts_with(word)).copied().unwrap_or_default();
    let flat = line("Space").ends_with("SE2");
    let box_numbers = numbers(line("Bounds"));
    let limits: Vec<_> = match box_numbers.len() {
        6 => (0..3).map(|i| Some([box_numbers[i], box_numbers[i + 3]])).collect(),
        _ => vec![None; 3],
    };
    let (low, high): (Vec<f64>, Vec<f64>) =
        limits.iter().map(|limits| limits.map_or((-6.0, 6.0), |[low, high]| (low, high))).unzip();
    let (moves, limits) = match flat {
        true => (Moves::Plane, limits.into_iter().take(2).chain([None]).collect()),
        false => (Moves::Space, limits.into_iter().chain([None; 3]).collect()),
    };
    let extent = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
    let surface = robot.iter().map(|t| Piece::Triangle(*t)).collect();
    let body = Body::new("robot", Shape::Pieces(surface), 0);
    let mut case = Case { still, far: extent + 10.0, ..Case::new(moves, vec![body], limits, extent) };
    let margin = 1e-3 * case.robot[0].reach;
    let any = |draw: &mut Draw| {
        let mut six: [f64; 6] =
            std::array::from_fn(|i| if i < 3 { draw.within(low[i], high[i]) } else { 0.0 });
        six[3] = draw.within(-PI, PI);
        if flat {
            return vec![six[0], six[1], six[3]];
        }
        (six[4], six[5]) = (draw.within(-1.5, 1.5), draw.within(-PI, PI));
        six.to_vec()
    };
    let own = |six: [f64; 6]| if flat { vec![six[0], six[1], six[3]] } else { six.to_vec() };
    let kept = draw.chance(0.3);
    case.start = if kept { own(own_start) } else { end(draw, &case, margin, any) };
    let goal = if kept { own(own_goal) } else { end(draw, &case, margin, any) };
    let row = |q: &[f64]| {
        let six = if flat { vec![q[0], q[1], 0.0, q[2], 0.0, 0.0] } else { q.to_vec() };
        six.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ")
    };
    let changed = text.replacen(lines[2], &row(&case.start), 1).replacen(lines[3], &row(&goal), 1);
    case.goals = vec![goal.iter().map(|x| Ask::Exactly(*x)).collect()];
    let meshes: Vec<String> = meshes.iter().map(|mesh| mesh.trim_start_matches("../").to_owned()).collect();
    let mut files = files(&meshes);
    files.insert(main.clone(), changed.into_bytes());
    World { main, files, case, margin }
}

/// The wrench: a handle that flies, and a jaw that slides on it. The numbers are those of its URDF.
fn wrench(draw: &mut Draw) -> World {
    let at = |x: f64, y: f64| Isometry3::translation(x, y, 0.0);
    let (low, high) = ([-1.6, -0.8, -0.6], [1.6, 0.8, 0.6]);
    let mut handle = box_pieces([0.45, 0.08, 0.05], &at(-0.315, 0.0));
    handle.push(Piece::Cylinder { pose: at(-0.55, 0.0), radius: 0.06, half: 0.025 });
    handle.extend(box_pieces([0.1, 0.3, 0.06], &at(-0.05, 0.03)));
    handle.extend(box_pieces([0.28, 0.08, 0.06], &at(0.14, 0.14)));
    let mut jaw = box_pieces([0.28, 0.05, 0.06], &at(0.14, 0.075));
    jaw.extend(box_pieces([0.08, 0.21, 0.04], &at(-0.04, 0.155)));
    let joint = Joint {
        above: 0,
        origin: Isometry3::identity(),
        axis: -Vector3::y(),
        slides: true,
        number: Some((0, 1.0, 0.0)),
        farthest: 0.38,
        is_held: false,
    };
    let tree = Tree {
        floats: true,
        base: Isometry3::identity(),
        joints: vec![joint],
        numbers: 1,
        circles: vec![false],
    };
    let mut still = bodies("wall", &mesh("meshes/wrench/wall.off"), &Isometry3::identity());
    still.extend(bodies("nut", &mesh("meshes/wrench/nut.off"), &pose([1.1, 0.2, 0.0, 0.6, 0.0, 0.0])));
    let bolt = Isometry3::from(Translation3::new(1.1, 0.2, -0.4));
    still.push(Form::Cylinder([0.07, 0.8]).body("bolt", &bolt, 0));
    let mut limits: Vec<_> = (0..3).map(|i| Some([low[i], high[i]])).collect();
    limits.extend([None, None, None, Some([0.04, 0.38])]);
    let robot = vec![Body::new("handle", Shape::Pieces(handle), 0), Body::new("jaw", Shape::Pieces(jaw), 1)];
    let mut case = Case { still, ..Case::new(Moves::Tree(tree), robot, limits, 3.2) };
    let margin = 0.01;
    let any = |draw: &mut Draw| {
        let mut row: Vec<f64> = (0..3).map(|i| draw.within(low[i], high[i])).collect();
        row.extend([
            draw.within(-PI, PI),
            draw.within(-1.5, 1.5),
            draw.within(-PI, PI),
            draw.within(0.04, 0.38),
        ]);
        row
    };
    let main = "scenes/wrench.toml".to_owned();
    let text = String::from_utf8_lossy(bytes(&main)).into_owned();
    let kept = draw.chance(0.3);
    let own = |word: &str| {
        let line = text.lines().find(|line| line.starts_with(word)).unwrap_or_default();
        (line.to_owned(), numbers(&line.replace(['[', ']', ',', '='], " ")))
    };
    let ((start_line, own_start), (goal_line, own_goal)) = (own("start"), own("goal"));
    case.start = if kept { own_start } else { end(draw, &case, margin, any) };
    let goal = if kept { own_goal } else { end(draw, &case, margin, any) };
    let changed = text.replacen(&start_line, &format!("start = {}", list(&case.start)), 1).replacen(
        &goal_line,
        &format!("goal = {}", list(&goal)),
        1,
    );
    case.goals = vec![goal.iter().map(|x| Ask::Exactly(*x)).collect()];
    let mut files = files(&["meshes/wrench/".to_owned(), "robots/wrench.urdf".to_owned()]);
    files.insert(main.clone(), changed.into_bytes());
    World { main, files, case, margin }
}
