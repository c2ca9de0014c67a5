//! Problems in TOML files, recognised by their tables.

use crate::planar::PlanarProblem;
use crate::rigid_toml::RigidTask;
use crate::robot::RobotProblem;
use crate::shape;
use crate::toml_problem::TomlText;
use mp_formats::error::Error;
use mp_formats::files::{Files, MAX_TEXT_BYTES, decode};
use std::f64::consts::TAU;
use std::path::Path;

/// The pages that describe the formats.
const GUIDE: &str =
    "the formats are described in docs/formats: planar-world.md, rigid-problem.md and robot-problem.md";

/// A problem in a TOML file; all files that it names are read, but for the meshes of a robot of links.
#[derive(Clone, Debug)]
pub enum ProblemFile {
    /// A world in the plane: the file has a table `world`.
    World(Box<PlanarProblem>),
    /// A rigid body: the table `robot` has a shape.
    Body(Box<RigidTask>),
    /// A robot of links and joints: everything else.
    Links(Box<RobotProblem>),
}

impl ProblemFile {
    /// Reads the problem at `path`. File names in it are relative to it.
    ///
    /// # Errors
    /// [`Error`] when a file cannot be read or makes no sense, with file, line and column.
    pub fn load_from(files: &dyn Files, path: &Path) -> Result<Self, Error> {
        let (file, bytes) = (path.display().to_string(), files.read(path, MAX_TEXT_BYTES)?);
        let text = TomlText { file: &file, text: decode(&file, &bytes)?, guide: GUIDE };
        let tables: toml::Table = text.read()?;
        let world = tables.contains_key("world");
        let is_body = |robot: &toml::Table| shape::names().any(|shape| robot.contains_key(shape));
        let several = tables.get("robot").and_then(toml::Value::as_array);
        let bodies = |robots: &Vec<toml::Value>| robots.iter().filter_map(toml::Value::as_table).any(is_body);
        if several.is_some_and(|robots| world || bodies(robots)) {
            let at = text.text.find("[[robot]]").unwrap_or(0);
            return Err(text
                .error(&(at..at + "[[robot]]".len()), "this problem has one robot, in `[robot]`")
                .help("write `[robot]`; only robots made of links and joints plan together"));
        }
        let robot = tables.get("robot").and_then(toml::Value::as_table);
        Ok(if world {
            Self::World(Box::new(PlanarProblem::of_bytes(files, path, &bytes)?))
        } else if robot.is_some_and(is_body) {
            Self::Body(Box::new(RigidTask::of_bytes(files, path, &bytes)?))
        } else {
            Self::Links(Box::new(RobotProblem::of_bytes(files, path, &bytes)?))
        })
    }
}

/// Warns of the first pose with an angle that is meant in degrees, most likely: more than a whole turn, and a multiple of five. `poses` are what they are
/// called, and x y z α β γ.
pub(crate) fn warn_of_degrees<'p>(
    files: &dyn Files,
    path: &Path,
    mut poses: impl Iterator<Item = (&'p str, [f64; 6])>,
) {
    let is_odd = |angle: &f64| angle.abs() > TAU && angle % 5.0 == 0.0;
    if let Some((what, angle)) =
        poses.find_map(|(what, six)| Some((what, six[3..].iter().copied().find(is_odd)?)))
    {
        let what = mp_formats::text::clipped(what);
        files.warn(
            path,
            &format!(
                "{what} is turned by {angle} radians, as angles here are; {angle} degrees are {}",
                angle.to_radians()
            ),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::InMemory;
    use std::sync::Mutex;

    /// Remembers the notes.
    #[derive(Debug)]
    struct Noting<'t>(&'t str, Mutex<Vec<String>>);

    impl Files for Noting<'_> {
        fn read(&self, path: &Path, _: u64) -> Result<Vec<u8>, Error> {
            let urdf = "<robot name='r'><link name='a'/></robot>";
            let off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
            let text = match path.extension().and_then(|e| e.to_str()) {
                Some("urdf") => urdf,
                Some("off") => off,
                _ => self.0,
            };
            Ok(text.into())
        }
        fn note(&self, _: &Path, remark: &str) {
            self.1.lock().unwrap().push(remark.to_owned());
        }
    }

    /// Angles are radians; 45 and 90 are degrees, most likely.
    #[test]
    fn angles_that_are_degrees_most_likely_are_noted() {
        let notes = |name: &str, text: &str| {
            let files = Noting(text, Mutex::default());
            let read = match name.ends_with(".env") {
                true => crate::RigidProblem::load_from(&files, Path::new(name)).map(drop),
                false => ProblemFile::load_from(&files, Path::new(name)).map(drop),
            };
            read.unwrap();
            files.1.into_inner().unwrap()
        };
        let motion = "[motion]\nstart = [0, 0, 0, 0, 0, 0]\ngoal = [1, 0, 0, 0, 0, 0]\n";
        let body = |angle: &str| {
            let obstacle = format!(
                "[[obstacle]]\nname = \"wall\"\nbox = [1, 1, 1]\npose = [9, 90, 45, 0, {angle}, 0]\n"
            );
            notes("f.toml", &format!("[robot]\nbox = [1, 1, 1]\n{motion}{obstacle}"))
        };
        assert_eq!(
            body("90.0"),
            ["wall is turned by 90 radians, as angles here are; 90 degrees are 1.5707963267948966"]
        );
        assert_eq!((body("-45").len(), body("1.57").len(), body("7").len(), body("5").len()), (1, 0, 0, 0));
        let start = notes(
            "f.toml",
            &format!("[robot]\nbox = [1, 1, 1]\n{}", motion.replace("0, 0]\ng", "0, 30]\ng")),
        );
        assert!(start[0].starts_with("the start is turned by 30 radians"), "{start:?}");
        let links = |base: &str| {
            notes(
                "f.toml",
                &format!(
                    "[robot]\nurdf = \"r.urdf\"\nbase = [0, 0, 0, {base}, 0, 0]\n[motion]\nstart = []\ngoal = []\n"
                ),
            )
        };
        assert!(links("180")[0].starts_with("the base is turned by 180 radians") && links("3.14").is_empty());
        let env =
            |angle: &str| notes("f.env", &format!("Robot\nr.off\n0 0 0 0 0 0\n5 0 0 {angle} 0 0\nEnd\n"));
        assert!(env("45")[0].starts_with("the goal is turned by 45 radians") && env("0.7").is_empty());
    }

    fn load(text: &str) -> Result<ProblemFile, Error> {
        let urdf = "<robot name='r'><link name='a'/></robot>";
        let files = InMemory(|name: &str| match name {
            "f.toml" => Some(text.as_bytes()),
            "r.urdf" => Some(urdf.as_bytes()),
            _ => None,
        });
        ProblemFile::load_from(&files, Path::new("f.toml"))
    }

    #[test]
    fn problems_are_known_by_their_tables_however_they_are_written() {
        let ends = "[motion]\nstart = [0, 0, 0, 0, 0, 0]\ngoal = [1, 0, 0, 0, 0, 0]\n";
        for body in [
            "[robot]\nbox = [1, 1, 1]\n",
            "[ robot ] # a body\n\"box\" = [1, 1, 1]\n",
            "robot.box = [1, 1, 1]\n",
            "robot = { sphere = 1 }\n",
        ] {
            let read = load(&format!("{body}{ends}"));
            assert!(matches!(read, Ok(ProblemFile::Body(_))), "{body}: {read:?}");
        }
        let ends = "[motion]\nstart = [1, 1]\ngoal = [2, 2]\n";
        for world in ["[world]\nwalls = [[0, 0], [3, 3]]\n", "world = { walls = [[0, 0], [3, 3]] }\n"] {
            let read = load(&format!("{world}[robot]\ndisc = 0.1\n{ends}"));
            assert!(matches!(read, Ok(ProblemFile::World(_))), "{world}: {read:?}");
        }
        let links = "# box = 1\n[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = []\ngoal = []\n";
        assert!(matches!(load(links), Ok(ProblemFile::Links(_))));
        assert!(matches!(load(&links.replace("[robot]", "[[robot]]")), Ok(ProblemFile::Links(_))));
        let bodies = format!("# two\n[[robot]]\nbox = [1, 1, 1]\n[[robot]]\nbox = [1, 1, 1]\n{ends}");
        let several = load(&bodies).unwrap_err();
        assert!(
            several.line() == Some(2) && several.remedy().is_some_and(|r| r.contains("links and joints")),
            "{several}"
        );
        let error = load("[robot\nbox = 1").unwrap_err();
        assert!(
            error.line() == Some(1) && error.remedy().is_some_and(|r| r.contains("docs/formats")),
            "{error}"
        );
    }

    #[test]
    fn toml_in_the_documentation_is_toml() {
        let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs");
        let pages = ["formats", "guides"]
            .map(|folder| std::fs::read_dir(std::path::Path::new(docs).join(folder)).unwrap());
        let mut count = 0;
        for page in pages.into_iter().flatten() {
            let text = std::fs::read_to_string(page.unwrap().path()).unwrap();
            for block in text.split("\n```toml").skip(1) {
                let (_, block) = block.split("\n```").next().unwrap().split_once('\n').unwrap();
                toml::from_str::<toml::Table>(block).unwrap_or_else(|e| panic!("{e}\n{block}"));
                count += 1;
            }
        }
        assert!(count > 10, "{count} blocks");
    }
}
