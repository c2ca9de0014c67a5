//! Files that hold only a robot or only a map, opened as scenes: the rest of the problem is chosen here.
//!
//! A problem that names the file is made as text and read by the ordinary reader, so that a robot or a map means the same
//! with and without a problem around it. Then its ends are chosen, and what was chosen is said in the notes of the scene.

use crate::files::load::Texts;
use crate::{Error, Scene};
use mp_io::{Content, Files, ProblemChanges};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene, and the problem that was made around its file: where that would be, and its text.
type Around = (Scene, Option<(PathBuf, String)>);

/// The scene of a file that is no scene but can be made one; `None` for all other files. `named` is what its name says that it holds.
///
/// # Errors
/// When the file is such a file and cannot be read, or there is no free configuration.
pub(crate) fn scene(files: &dyn Files, file: &Path, named: Option<Content>) -> Result<Option<Around>, Error> {
    match named {
        Some(Content::Robot) => robot(files, file).map(Some),
        Some(Content::Map) => map(files, file).map(Some),
        Some(Content::MapImage) => map(files, &beside(files, file)?).map(Some),
        Some(Content::RobotMacros) => Ok(Some((with_macros(files, file, &ProblemChanges::default())?, None))),
        Some(Content::RobotSemantics) => {
            Err(Error::new(format!("{} is an SRDF, not a scene", file.display()))
                .help("name it in a robot problem: docs/formats/robot-problem.md"))
        }
        _ => Ok(None),
    }
}

/// The map file of ROS that gives the image `file` its scale.
fn beside(files: &dyn Files, file: &Path) -> Result<PathBuf, Error> {
    let mut places = Content::Map.format().endings.iter().map(|ending| file.with_extension(ending));
    places.find(|place| files.holds(place)).ok_or_else(|| {
        let name = name_of(file).unwrap_or_default();
        let stem = file.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        Error::new(format!("{} is an image: nothing says how large its pixels are", file.display())).help(format!(
            "write `{stem}.yaml` beside it:\n    image: {name}\n    resolution: 0.05   # metres per pixel\n    \
             origin: [0, 0, 0]\n  or name it in a world: docs/formats/planar-world.md"
        ))
    })
}

/// The name of a file without folders, quoted as TOML quotes it. JSON quotes such names in the same way.
fn quoted(file: &Path) -> Result<String, Error> {
    Ok(serde_json::Value::from(name_of(file)?).to_string())
}

fn name_of(file: &Path) -> Result<String, Error> {
    let name = file.file_name().and_then(|name| name.to_str());
    name.map(str::to_owned).ok_or_else(|| {
        Error::new(format!("{} has a name that is not Unicode", file.display())).help("rename the file")
    })
}

/// The name that the problem around `file` has in errors, in the same folder.
fn around(file: &Path) -> PathBuf {
    file.with_extension("toml")
}

fn robot(files: &dyn Files, file: &Path) -> Result<Around, Error> {
    let scene = with_chosen_ends(files, robot_alone(files, file)?)?;
    Ok((scene, Some(problem_around(files, file)?)))
}

/// The scene of a robot with macros. It cannot be read again elsewhere: what the macros include is not known.
pub(crate) fn with_macros(files: &dyn Files, file: &Path, changes: &ProblemChanges) -> Result<Scene, Error> {
    let text = mp_io::expand_xacro(file, &changes.arguments)?;
    // `robot.urdf.xacro`, or `robot.xacro`.
    let place = file.with_extension("").with_extension(Content::Robot.ending());
    let files = Texts::one(&place, &text, files);
    let changes = ProblemChanges { arguments: Vec::new(), ..changes.clone() };
    let mut scene = Scene::load_changed(&files, &place, &changes)?.with_file(file);
    let of = Arc::make_mut(&mut scene.files);
    of.changed = true;
    of.inputs.push(file.to_owned());
    Ok(scene)
}

/// The scene of a problem of an arm that leaves its start, its goals or both open.
pub(crate) fn with_chosen_ends(files: &dyn Files, problem: mp_io::RobotProblem) -> Result<Scene, Error> {
    Ok(Scene::built(mp_kinds::build::arm_with_chosen_ends(files, problem)?))
}

/// The problem of a URDF alone, without start and goal.
///
/// # Errors
/// When the file cannot be read.
pub(crate) fn robot_alone(files: &dyn Files, file: &Path) -> Result<mp_io::RobotProblem, Error> {
    let (place, text) = problem_around(files, file)?;
    Ok(mp_io::RobotProblem::load_from(&Texts::one(&place, &text, files), &place)?)
}

/// The text of the problem of a URDF alone, and the name that it has.
pub(crate) fn problem_around(files: &dyn Files, file: &Path) -> Result<(PathBuf, String), Error> {
    // Read first, so that an error about it names the file itself.
    mp_io::read_robot_text(files, file)?;
    let text = format!("[robot]\nurdf = {}\n[motion]\nstart = []\ngoal = []\n", quoted(file)?);
    Ok((around(file), text))
}

/// The radius (m) of the disc that moves on a map alone: that of common mobile robots.
const RADIUS: f64 = 0.2;

fn map(files: &dyn Files, file: &Path) -> Result<Around, Error> {
    use mp_io::{GoalPart, PlanarProblem, PlanarShape};
    let place = around(file);
    let map = quoted(file)?;
    let text = |radius: f64| {
        format!("[world]\nmap = {map}\n[robot]\ndisc = {radius:?}\n[motion]\nstart = [0, 0]\ngoal = [0, 0]\n")
    };
    // Read first, so that errors about them name the files themselves.
    let ros = mp_io::RosMap::parse(&file.display().to_string(), &files.read(file, mp_io::MAX_TEXT_BYTES)?)?;
    let image = file.parent().unwrap_or(Path::new("")).join(&ros.image);
    mp_io::GridMap::parse(&image.display().to_string(), &files.read(&image, mp_io::MAX_MESH_BYTES)?)?;
    let mut problem = PlanarProblem::load_from(&Texts::one(&place, &text(RADIUS), files), &place)?;
    let polygons = problem.obstacles.iter().map(|o| o.polygon.clone()).collect();
    let world = mp_geom::planar::PlanarWorld::new_until(polygons, problem.walls, &files.interrupt())
        .map_err(|e| Error::new(e.to_string()))?;
    let grid = Grid::new(&world, problem.bounds);
    let widest = grid.clearances.iter().copied().fold(0.0, f64::max);
    let radius = RADIUS.min(0.5 * widest);
    // What checks resolve far from the origin may be millimetres, which the disc keeps free too.
    let disc = mp_robot::DiscRobot::new(world, radius);
    let free = radius + disc.map_or(0.0, |disc| 2.0 * disc.tolerance());
    let (start, goal) = grid.far_apart(free).ok_or_else(|| {
        Error::new(format!("{} has no free region to plan in", file.display()))
            .help("free pixels are light, unless the map says `negate: 1`; unknown pixels count as obstacles")
    })?;
    problem.file.robot = PlanarShape::Disc(radius);
    let goal = goal.iter().map(|&number| GoalPart::Exactly(number)).collect();
    (problem.file.start, problem.file.goals) = (start.to_vec(), vec![goal]);
    let size = match radius < RADIUS {
        true => format!("{} m, half of the widest clearance of the map", crate::brief(radius)),
        false => format!("{} m, as common mobile robots have", crate::brief(radius)),
    };
    let notes = vec![
        format!("{} is a map alone. The robot is a disc with the radius {size}", name_of(file)?),
        "start and goal are far apart in the largest free region. A world file sets all of these: \
         docs/formats/planar-world.md"
            .to_owned(),
    ];
    let scene = Scene::from_world_until(problem, &files.interrupt())?.with_notes(notes);
    Ok((scene, Some((place, text(radius)))))
}

/// How many points the longer side of a grid over a map has.
const POINTS: usize = 240;

/// Points of a map at equal distances, with their clearances.
struct Grid {
    low: [f64; 2],
    spacing: f64,
    counts: [usize; 2],
    /// Row by row. Negative inside obstacles.
    clearances: Vec<f64>,
}

impl Grid {
    fn new(world: &mp_geom::planar::PlanarWorld, [low, high]: [[f64; 2]; 2]) -> Self {
        let size = [high[0] - low[0], high[1] - low[1]];
        let spacing = size[0].max(size[1]) / POINTS as f64;
        let counts = size.map(|side| ((side / spacing) as usize).max(1));
        // In the middle of its cell, so that no point is on the border of the map.
        let mut grid = Self { low, spacing, counts, clearances: Vec::new() };
        grid.clearances =
            (0..counts[0] * counts[1]).map(|i| world.signed_distance(&grid.point(i).into())).collect();
        grid
    }

    fn point(&self, i: usize) -> [f64; 2] {
        let at = |k: usize, n: usize| self.low[k] + (n as f64 + 0.5) * self.spacing;
        [at(0, i % self.counts[0]), at(1, i / self.counts[0])]
    }

    /// The neighbours of a point that a disc can reach from it on a straight line. The clearance changes by at most the
    /// distance, so along the line it is at least half of (the sum of both clearances minus the spacing).
    fn reachable(&self, i: usize, radius: f64) -> impl Iterator<Item = usize> + '_ {
        let [columns, rows] = self.counts;
        let (x, y) = (i % columns, i / columns);
        let neighbours = [
            (x > 0).then(|| i - 1),
            (x + 1 < columns).then(|| i + 1),
            (y > 0).then(|| i - columns),
            (y + 1 < rows).then(|| i + columns),
        ];
        let clearance = move |i: usize| self.clearances[i] - radius;
        let free = move |j: &usize| {
            clearance(i).min(clearance(*j)) > 0.0 && clearance(i) + clearance(*j) > self.spacing
        };
        neighbours.into_iter().flatten().filter(free)
    }

    /// The points that a disc can reach from `first`, in the order of their distance on the grid.
    fn region(&self, first: usize, radius: f64, seen: &mut [bool]) -> Vec<usize> {
        let mut found = vec![first];
        seen[first] = true;
        let mut at = 0;
        while at < found.len() {
            for next in self.reachable(found[at], radius) {
                if !std::mem::replace(&mut seen[next], true) {
                    found.push(next);
                }
            }
            at += 1;
        }
        found
    }

    /// Two points of the largest region in which a disc can move, far apart on the grid.
    fn far_apart(&self, radius: f64) -> Option<([f64; 2], [f64; 2])> {
        let mut seen = vec![false; self.clearances.len()];
        let mut largest = Vec::new();
        for first in 0..self.clearances.len() {
            if !seen[first] && self.clearances[first] > radius {
                let region = self.region(first, radius, &mut seen);
                if region.len() > largest.len() {
                    largest = region;
                }
            }
        }
        // The point farthest from any point is at one end of the region, the one farthest from that at the other.
        let farthest = |from: usize| {
            let mut seen = vec![false; self.clearances.len()];
            self.region(from, radius, &mut seen).last().copied()
        };
        let start = farthest(*largest.first()?)?;
        let goal = farthest(start).filter(|goal| *goal != start)?;
        Some((self.point(start), self.point(goal)))
    }
}
