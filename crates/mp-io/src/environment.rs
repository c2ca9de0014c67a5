//! GEMPA environment files: the robot, its initial and goal configuration, and the obstacles.

use crate::problem::SpaceKind;
use mp_formats::error::Error;
use mp_formats::files::{MAX_TEXT_BYTES, read_file};
use mp_formats::number::Row;
use mp_formats::path::six;
use mp_formats::text::{Text, Token, clipped};
use std::fmt::Write as _;
use std::path::Path;

/// An obstacle of an [`Environment`].
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Its number, as in `Obstacle #1`.
    pub number: u64,
    /// Its mesh file as the environment names it, relative to the folder of the environment.
    pub mesh: String,
    /// Its pose: x, y, z in metres, α, β, γ in radians.
    pub pose: [f64; 6],
}

/// The content of a GEMPA environment file. Six-tuples are x, y, z (metres), α yaw about Z, β pitch about Y and
/// γ roll about X (radians).
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// The mesh file of the robot as the environment names it, relative to the folder of the environment.
    pub robot: String,
    /// The initial configuration.
    pub start: [f64; 6],
    /// The goal configuration.
    pub goal: [f64; 6],
    /// The obstacles, which stand still, in the order of the file.
    pub obstacles: Vec<Obstacle>,
    /// `Space` after `End` (an extension; other readers stop at `End`).
    pub space: Option<SpaceKind>,
    /// `Bounds` after `End` (an extension): lowest x, y, z, highest x, y, z of the robot's position.
    pub bounds: Option<[f64; 6]>,
}

/// Where the parts of an environment are in its text.
#[derive(Debug)]
pub(crate) struct Places<'a> {
    pub(crate) robot: Token<'a>,
    pub(crate) start: Token<'a>,
    pub(crate) goal: Token<'a>,
    pub(crate) meshes: Vec<Token<'a>>,
    pub(crate) poses: Vec<Token<'a>>,
    pub(crate) bounds: Option<Token<'a>>,
}

/// The page that describes the format.
pub(crate) const GUIDE: &str = "gempa-environment.md";
const SIX: &str = "six numbers: x y z α β γ";

impl Environment {
    /// Reads the file `path`; the meshes it names are not opened.
    ///
    /// # Errors
    /// [`Error`] when it cannot be read or is not an environment file.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        Self::parse(&path.display().to_string(), &read_file(path, MAX_TEXT_BYTES)?)
    }

    /// Reads `bytes`, the content of a file that errors call `file`.
    ///
    /// # Errors
    /// [`Error`] when it is not an environment file, with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        Ok(parse(&Text::new(file, bytes, GUIDE)?)?.0)
    }

    /// The text of the file. Numbers have the fewest digits that read back to the same bits.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        let _ = writeln!(out, "Robot\n{}\n{}\n{}", self.robot, Row(&self.start), Row(&self.goal));
        for o in &self.obstacles {
            let _ = writeln!(out, "\nObstacle #{}\n{}\n{}", o.number, o.mesh, Row(&o.pose));
        }
        out.push_str("\nEnd\n");
        if let Some(space) = self.space {
            let _ = writeln!(out, "Space {space}");
        }
        if let Some(bounds) = &self.bounds {
            let _ = writeln!(out, "Bounds {}", Row(bounds));
        }
        out
    }

    /// Writes the file `path` in one step; the meshes it names are not written.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be written; then nothing is left of it.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        Ok(mp_store::write(path.as_ref(), self.to_text().as_bytes())?)
    }
}

/// What to do where a file asks for more than one goal, or for a part of one.
const ONE_GOAL: &str = "this format has one goal, of six numbers; a rigid problem (.toml) may have several goals, and leave \
                        numbers free: docs/formats/rigid-problem.md";

pub(crate) fn parse<'a>(text: &Text<'a>) -> Result<(Environment, Places<'a>), Error> {
    let mut lines = text.lines();
    let mut next = |what: &str| lines.next().ok_or_else(|| text.error_at_end(what));

    let first = next("`Robot`")?;
    if !first.text.eq_ignore_ascii_case("Robot") {
        let message = format!("the file begins with `{}`", clipped(first.text));
        return Err(text.error(first, message).expected("`Robot`").help(
            "an environment file begins with the line `Robot`, then the mesh file, the initial and the goal six-tuple",
        ));
    }
    let robot = next("the mesh file of the robot")?;
    mesh_name(text, robot)?;
    let start = next("the initial configuration, six numbers: x y z α β γ")?;
    let goal = next("the goal configuration, six numbers: x y z α β γ")?;
    // What is wrong with a number says what to do; anything else may be a goal of another kind.
    let of_goal = |e: Error| match e.remedy().is_some_and(|help| help.ends_with(GUIDE)) {
        true => e.help(ONE_GOAL),
        false => e,
    };
    let mut places = Places { robot, start, goal, meshes: Vec::new(), poses: Vec::new(), bounds: None };
    let mut env = Environment {
        robot: robot.text.to_owned(),
        start: six(text, start, "the initial configuration", SIX)?,
        goal: six(text, goal, "the goal configuration", SIX).map_err(of_goal)?,
        obstacles: Vec::new(),
        space: None,
        bounds: None,
    };
    let mut numbers = std::collections::HashSet::new();
    loop {
        let line = next("`Obstacle #k` or `End`")?;
        if line.text.eq_ignore_ascii_case("End") {
            break;
        }
        let Some(number) = obstacle_number(line.text) else {
            let mut e = text.error(line, format!("`{}` is out of place", clipped(line.text)));
            if line.words().all(|w| w.text.parse::<f64>().is_ok()) {
                e = e
                    .help(format!("a robot has two six-tuples (initial, goal), an obstacle one; {ONE_GOAL}"));
            }
            return Err(e.expected("`Obstacle #k` or `End`"));
        };
        if !numbers.insert(number) {
            return Err(text
                .error(line, format!("there are two obstacles #{number}"))
                .expected("a number of its own for every obstacle")
                .help("messages name obstacles by their number: renumber one of them"));
        }
        let mesh = next(&format!("the mesh file of obstacle #{number}"))?;
        mesh_name(text, mesh)?;
        let pose = next(&format!("the pose of obstacle #{number}, six numbers: x y z α β γ"))?;
        env.obstacles.push(Obstacle {
            number,
            mesh: mesh.text.to_owned(),
            pose: six(text, pose, &format!("the pose of obstacle #{number}"), SIX)?,
        });
        places.meshes.push(mesh);
        places.poses.push(pose);
    }
    for line in lines {
        extension(text, line, &mut env, &mut places)?;
    }
    Ok((env, places))
}

/// A line after `End`.
fn extension<'a>(
    text: &Text<'a>,
    line: Token<'a>,
    env: &mut Environment,
    places: &mut Places<'a>,
) -> Result<(), Error> {
    if line.text.starts_with('#') {
        return Ok(());
    }
    let mut words = line.words();
    let key = words.next().unwrap_or(line);
    let twice = |seen: bool| match seen {
        true => {
            Err(text.error(line, format!("`{}` is given twice", key.text)).help("remove one of the lines"))
        }
        false => Ok(()),
    };
    if key.text.eq_ignore_ascii_case("Space") {
        twice(env.space.is_some())?;
        let kind = words.next().unwrap_or(line.end());
        env.space = Some(match (kind.text.to_ascii_uppercase().as_str(), words.next()) {
            ("SE2", None) => SpaceKind::Se2,
            ("SE3", None) => SpaceKind::Se3,
            (_, Some(extra)) => {
                return Err(text.error(extra, "one word too many").expected("`Space SE2` or `Space SE3`"));
            }
            _ => {
                let message = match kind.text {
                    "" => "`Space` names no space".to_owned(),
                    other => format!("`{}` is not a space", clipped(other)),
                };
                return Err(text.error(kind, message).expected("`Space SE2` or `Space SE3`"));
            }
        });
    } else if key.text.eq_ignore_ascii_case("Bounds") {
        twice(env.bounds.is_some())?;
        let at = key.end().at;
        let rest = Token { text: &line.text[at - line.at..], at }.trimmed();
        let what = "six numbers: xmin ymin zmin xmax ymax zmax";
        let b = six(text, rest, "bounds", what)?;
        if let Some(i) = (0..3).find(|&i| b[i] > b[i + 3]) {
            let axis = ["x", "y", "z"][i];
            return Err(text
                .error(rest, format!("the lowest {axis}, {}, is above the highest, {}", b[i], b[i + 3]))
                .expected(what)
                .help("the three lowest come first, then the three highest"));
        }
        env.bounds = Some(b);
        places.bounds = Some(rest);
    } else {
        let help = match obstacle_number(line.text) {
            Some(_) => "move `End` behind the last obstacle",
            None => "begin the line with # to make it a comment",
        };
        return Err(text
            .error(key, format!("`{}` after `End`", clipped(key.text)))
            .expected("`Space SE2`, `Space SE3` or `Bounds xmin ymin zmin xmax ymax zmax`")
            .help(help));
    }
    Ok(())
}

/// The k of `Obstacle #k`.
fn obstacle_number(line: &str) -> Option<u64> {
    let (word, rest) = (line.get(..8)?, line.get(8..)?);
    word.eq_ignore_ascii_case("Obstacle").then_some(())?;
    let digits = rest.trim_start().strip_prefix('#')?.trim_start();
    digits.bytes().all(|b| b.is_ascii_digit()).then(|| digits.parse().ok())?
}

/// Refuses a mesh name that is a keyword or numbers: the line of the name was left out.
fn mesh_name(text: &Text<'_>, line: Token<'_>) -> Result<(), Error> {
    let keyword = line.text.eq_ignore_ascii_case("End")
        || line.text.eq_ignore_ascii_case("Robot")
        || obstacle_number(line.text).is_some();
    if keyword || line.words().all(|w| w.text.parse::<f64>().is_ok()) {
        return Err(text
            .error(line, format!("`{}` is not the name of a file", clipped(line.text)))
            .expected("the name of a mesh file"));
    }
    if line.text.chars().any(char::is_control) {
        return Err(text.error(line, "the name of the mesh file has control characters"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Figure 14 of the key-elements paper, left side.
    const FIGURE_14: &str = "Robot
robot_angular.txt
0.0 0.0 0.0 0.0 0.0 0.0
1.0 20.0 0.0 0.7 1.2 0.8



Obstacle #1
bench_lamina_angosta_grande.txt
3.0 10 8.0 0.0 0.0 0.0


Obstacle #2
bench_lamina_angosta_grande.txt
3.0 10 -8.0 0.0 0.0 0.0
End
";

    #[test]
    fn figure_14() {
        let env = Environment::parse("f14.env", FIGURE_14.as_bytes()).unwrap();
        assert_eq!(env.robot, "robot_angular.txt");
        assert_eq!(env.goal, [1.0, 20.0, 0.0, 0.7, 1.2, 0.8]);
        assert_eq!(env.obstacles.len(), 2);
        assert_eq!(env.obstacles[1].pose, [3.0, 10.0, -8.0, 0.0, 0.0, 0.0]);
        assert_eq!(env.space, None);
        insta::assert_snapshot!(env.to_text(), @r"
        Robot
        robot_angular.txt
        0 0 0 0 0 0
        1 20 0 0.7 1.2 0.8

        Obstacle #1
        bench_lamina_angosta_grande.txt
        3 10 8 0 0 0

        Obstacle #2
        bench_lamina_angosta_grande.txt
        3 10 -8 0 0 0

        End
        ");
    }

    #[test]
    fn extension_after_end() {
        let text = FIGURE_14.to_owned() + "\n# planar\nspace se2\nBounds  -1 -2 0 3 30 0\r\n";
        let env = Environment::parse("f14.env", text.as_bytes()).unwrap();
        assert_eq!((env.space, env.bounds), (Some(SpaceKind::Se2), Some([-1.0, -2.0, 0.0, 3.0, 30.0, 0.0])));
        assert_eq!(Environment::parse("again", env.to_text().as_bytes()).unwrap(), env);
    }
}
