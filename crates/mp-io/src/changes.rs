//! Problems that options of a command line change: another start, other goals, more obstacles. They become text of the problem, so that
//! an option means what the same text means in a file.

use crate::problem::PlacedBody;
use crate::problem_document::{inline, is_header};
use crate::robot::{ObstacleTable, entry};
use crate::shape::{Meshes, Shaped};
use crate::toml_problem::TomlText;
use mp_formats::error::{Error, ErrorKind};
use mp_formats::files::Files;
use mp_geom::pose_from_six;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use toml::{Spanned, Value};

/// A start, goals and obstacles, as a person writes them: what each option was given.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ProblemChanges {
    /// The start: numbers, or the name of a state in the SRDF.
    pub from: Option<String>,
    /// The goals, in place of all others: each is numbers, a name, or what stands in the table of a goal.
    pub to: Vec<String>,
    /// Obstacles beside the others: each is what stands in the table of an obstacle.
    pub obstacles: Vec<String>,
    /// Arguments of a robot with macros, `NAME:=VALUE`.
    pub arguments: Vec<String>,
}

/// The page that describes obstacles.
const SHAPES: &str = "docs/formats/shapes.md describes shapes";

/// The options, as lines of text name them.
const FROM: &str = "--from";
const TO: &str = "--to";
const OBSTACLE: &str = "--obstacle";

/// What begins the comment that says from which option a line is.
const MARK: &str = " # by ";

/// The ends in the text of a problem.
#[derive(Deserialize)]
struct Ends {
    robot: Option<Value>,
    motion: Option<Motion>,
}

#[derive(Deserialize)]
struct Motion {
    start: Option<Spanned<Value>>,
    goal: Option<Spanned<Value>>,
    goals: Option<Spanned<Value>>,
}

impl ProblemChanges {
    /// Whether nothing changes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The text of a problem in TOML, which errors call `file`, with the changes. Errors about lines that are from options name these.
    ///
    /// # Errors
    /// [`Error`] when the text or that of an option is no TOML, or there is no start or goal to replace.
    pub fn applied(&self, file: &str, text: &str) -> Result<String, Error> {
        let from = self.from.as_ref().map(|from| value(FROM, from)).transpose()?;
        let given = self.to.iter().map(|to| value(TO, to)).collect::<Result<Vec<_>, _>>()?;
        let mut text = with_ends(file, text, from, &given, true)?;
        for obstacle in &self.obstacles {
            text += &obstacle_lines(obstacle)?;
        }
        Ok(text)
    }

    /// The obstacles, for problems in other formats. Names of files are relative to the problem at `path`.
    ///
    /// # Errors
    /// [`Error`] when the text of one makes no sense, or a file cannot be read.
    pub fn bodies(&self, files: &dyn Files, path: &Path) -> Result<Vec<PlacedBody>, Error> {
        let text: String =
            self.obstacles.iter().map(|text| obstacle_lines(text)).collect::<Result<_, _>>()?;
        let source = TomlText { file: OBSTACLE, text: &text, guide: SHAPES };
        let Obstacles { obstacle } = source.read()?;
        let mut meshes = Meshes::new(files, path);
        let body = |(i, table)| {
            let entry = entry(&source, i, table)?;
            let (file, mesh) = meshes.of(&source, &entry.name, &entry.shape)?;
            Ok(PlacedBody { name: entry.name, file, mesh, pose: pose_from_six(entry.pose) })
        };
        obstacle.iter().enumerate().map(body).collect()
    }

    /// The numbers of the start, for problems in other formats.
    ///
    /// # Errors
    /// [`Error`] when it is anything but numbers.
    pub fn start_row(&self) -> Result<Option<Vec<f64>>, Error> {
        self.from.as_ref().map(|from| row(FROM, from)).transpose()
    }

    /// The numbers of the goals, for problems in other formats.
    ///
    /// # Errors
    /// [`Error`] when they are anything but numbers.
    pub fn goal_rows(&self) -> Result<Vec<Vec<f64>>, Error> {
        self.to.iter().map(|to| row(TO, to)).collect()
    }
}

/// The text of a problem, which errors call `file`, with another start and other goals, each a value of TOML. If they are from options,
/// comments say so.
///
/// # Errors
/// [`Error`] when the text is no TOML, there is no start or goal to replace, or it is under a header of its own.
pub(crate) fn with_ends(
    file: &str,
    text: &str,
    from: Option<String>,
    given: &[String],
    from_options: bool,
) -> Result<String, Error> {
    let guide = "docs/formats describes problems";
    let Ends { robot, motion } = TomlText { file, text, guide }.read()?;
    let (start, goal, goals) = motion.map_or((None, None, None), |m| (m.start, m.goal, m.goals));
    let mut replaced: Vec<(Range<usize>, String, &'static str)> = Vec::new();
    let none = |option: &'static str, what: &str| {
        Error::new(ErrorKind::Content, option, format!("{file} has no {what} to replace"))
            .help("add `[motion]` with `start` and `goal` to the problem")
    };
    for (end, asked, option) in
        [(&start, from.is_some(), FROM), (&goal, !given.is_empty(), TO), (&goals, !given.is_empty(), TO)]
    {
        if let Some(end) = end.as_ref().filter(|_| asked)
            && (end.get_ref().is_table() || end.get_ref().get(0).is_some_and(Value::is_table))
            && is_header(&text[end.span().start..])
        {
            let message = format!("the ends of {file} stand under headers of their own");
            return Err(Error::new(ErrorKind::Content, option, message)
                .help("write them in [motion], such as `start = { joint1 = 0.5 }`"));
        }
    }
    if let Some(from) = from {
        let start = start.ok_or_else(|| none(FROM, "start"))?;
        let from = beside(robot.as_ref(), start.get_ref(), from);
        replaced.push((start.span(), from, FROM));
    }
    match (given, goal, goals) {
        ([], ..) => {}
        (_, _, Some(goals)) => replaced.push((goals.span(), format!("[{}]", given.join(", ")), TO)),
        ([one], Some(goal), None) => replaced.push((goal.span(), one.clone(), TO)),
        (several, Some(goal), None) => {
            let key = text[..goal.span().start].rfind("goal").unwrap_or(goal.span().start);
            replaced.push((key..goal.span().end, format!("goals = [{}]", several.join(", ")), TO));
        }
        (_, None, None) => return Err(none(TO, "goal")),
    }
    replaced.sort_by_key(|(span, ..)| std::cmp::Reverse(span.start));
    let mut text = text.to_owned();
    for (span, value, option) in replaced {
        let rest = text[span.end..].lines().next().unwrap_or_default().trim();
        let ends_line = rest.is_empty() || rest.starts_with('#');
        let mark = if ends_line && from_options { format!("{MARK}{option}") } else { String::new() };
        text.replace_range(span, &(value + &mark));
    }
    Ok(text)
}

/// The value of another start in place of `old`. Joints that the problem does not let move stay where the old one has them by name.
fn beside(robot: Option<&Value>, old: &Value, from: String) -> String {
    let chooses = |robot: &Value| robot.get("group").is_some() || robot.get("joints").is_some();
    let chosen = robot.is_some_and(|r| chooses(r) || r.as_array().is_some_and(|all| all.iter().any(chooses)));
    let names = old.get("numbers").and(old.get("held")).unwrap_or(old);
    match chosen && from.starts_with('[') && !names.is_array() {
        true => format!("{{ numbers = {from}, held = {} }}", inline(names)),
        false => from,
    }
}

/// The numbers that an option gives.
fn row(option: &'static str, text: &str) -> Result<Vec<f64>, Error> {
    let read = members(option, "list of numbers", &value(option, text)?)?;
    read.try_into::<Vec<f64>>().map_err(|_| {
        let message = format!("`{}` is no list of numbers", mp_formats::text::clipped(text));
        Error::new(ErrorKind::Content, option, message)
            .help("write the numbers of a configuration; only problems in TOML have goals of other kinds")
    })
}

/// What to write for an option.
pub(crate) fn help_of(option: &str) -> &'static str {
    match option {
        OBSTACLE => {
            "write a shape and its place, such as \"box = [0.4, 0.4, 0.02], at = [0.5, 0, 0.3]\": docs/formats/shapes.md"
        }
        _ => {
            "write numbers, or of a goal what stands in its table, such as \"x = 1.5, y = [-1, 1]\"; for robots made of links also the \
             name of a state, or \"link = 'hand', position = [0.4, 0, 0.3]\""
        }
    }
}

/// What an option gives for an end, as a value of TOML: a list of numbers, a table, or the name of a state.
fn value(option: &'static str, given: &str) -> Result<String, Error> {
    let text = given.replace(char::is_control, " ");
    let text = text.trim();
    let words: Vec<&str> = text.split([' ', ',']).filter(|word| !word.is_empty()).collect();
    let is_number = |word: &&str| word.parse::<f64>().is_ok_and(f64::is_finite);
    let value = if text.starts_with(['[', '{']) {
        text.to_owned()
    } else if text.contains('=') {
        format!("{{ {text} }}")
    } else if words.iter().any(is_number) {
        if let Some(wrong) = words.iter().find(|word| !is_number(word)) {
            let message = format!("`{wrong}` is not a number");
            return Err(Error::new(ErrorKind::Format, option, message)
                .help("separate the numbers of a configuration by commas or blanks"));
        }
        let numbers = words.iter().map(|word| word.parse::<f64>().map(|x| format!("{x:?}")));
        format!("[{}]", numbers.filter_map(Result::ok).collect::<Vec<_>>().join(", "))
    } else {
        quoted(text)
    };
    members(option, "end of a motion", &value)?;
    Ok(value)
}

/// A value of TOML that an option gives.
fn members(option: &'static str, what: &str, value: &str) -> Result<Value, Error> {
    let read = toml::from_str::<toml::Table>(&format!("it = {value}")).ok().and_then(|mut t| t.remove("it"));
    read.ok_or_else(|| {
        let message = format!("`{}` is no {what}", mp_formats::text::clipped(value));
        Error::new(ErrorKind::Format, option, message).help(help_of(option))
    })
}

/// A text as TOML quotes it. JSON quotes all but one character in the same way.
pub(crate) fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string().replace('\u{7f}', "\\u007f")
}

/// The lines of an obstacle that an option gives.
fn obstacle_lines(given: &str) -> Result<String, Error> {
    let text = given.replace(char::is_control, " ");
    let table = if text.trim_start().starts_with('{') { text } else { format!("{{ {text} }}") };
    members(OBSTACLE, "obstacle", &table)?;
    let text = format!("it = {table}");
    let source = TomlText { file: OBSTACLE, text: &text, guide: SHAPES };
    let Obstacle { it } = source.read()?;
    let line = |(key, value): (String, Spanned<Value>)| {
        format!("{} = {}{MARK}{OBSTACLE}\n", quoted(&key), &text[value.span()])
    };
    Ok(format!("\n[[obstacle]]{MARK}{OBSTACLE}\n{}", it.into_iter().map(line).collect::<String>()))
}

/// Obstacles alone.
#[derive(Deserialize)]
struct Obstacles {
    #[serde(default)]
    obstacle: Vec<Spanned<Shaped<ObstacleTable>>>,
}

/// The members of an obstacle.
#[derive(Deserialize)]
struct Obstacle {
    it: BTreeMap<String, Spanned<Value>>,
}

/// The option from which the line at byte `at` of a text is, if it is from one.
pub(crate) fn option_at(text: &str, at: usize) -> Option<&'static str> {
    let at = at.min(text.len());
    let line = text.get(text[..at].rfind('\n').map_or(0, |i| i + 1)..)?.lines().next()?;
    [FROM, TO, OBSTACLE].into_iter().find(|option| line.ends_with(&format!("{MARK}{option}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [0, 1] # here\ngoals = [[1, 2], [2, 3]]\n";

    fn changed(from: Option<&str>, to: &[&str], obstacles: &[&str]) -> ProblemChanges {
        let owned = |all: &[&str]| all.iter().map(|text| (*text).to_owned()).collect();
        ProblemChanges {
            from: from.map(str::to_owned),
            to: owned(to),
            obstacles: owned(obstacles),
            arguments: Vec::new(),
        }
    }

    #[test]
    fn quoted_texts_read_back() {
        for text in ["plain", "a \"b\" \\ c", "\u{7f}\n\t\u{1}ä"] {
            let table: toml::Table = toml::from_str(&format!("it = {}", super::quoted(text))).unwrap();
            assert_eq!(table["it"].as_str(), Some(text));
        }
    }

    #[test]
    fn ends_are_replaced_where_they_stand_and_obstacles_come_last() {
        let all = changed(Some("-1, 5e-1"), &["home", "j = 1"], &["box = [1, 2, 3], at = [0, 0, 1]"]);
        let text = all.applied("p.toml", TEXT).unwrap();
        assert_eq!(
            text,
            "[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [-1.0, 0.5] # by --from # here\ngoals = [\"home\", { j = 1 }] # by --to\n\n\
             [[obstacle]] # by --obstacle\n\"at\" = [0, 0, 1] # by --obstacle\n\"box\" = [1, 2, 3] # by --obstacle\n"
        );
        assert_eq!(option_at(&text, text.find("home").unwrap()), Some(TO));
        assert_eq!(option_at(&text, 3), None);
        let inline = "motion = { start = [0], goal = [1] }\nrobot.urdf = \"r.urdf\"\n";
        let text = changed(Some("2"), &["3", "4"], &[]).applied("p.toml", inline).unwrap();
        assert_eq!(text, "motion = { start = [2.0], goals = [[3.0], [4.0]] }\nrobot.urdf = \"r.urdf\"\n");
    }

    /// Where not all joints move, another start by numbers says where those are that it has; ends under headers are not replaced.
    #[test]
    fn held_joints_stay_where_a_start_by_names_has_them() {
        let from = |text: &str, from: &str| changed(Some(from), &[], &[]).applied("p.toml", text);
        let text =
            |robot: &str, start: &str| format!("robot = {robot}\n[motion]\nstart = {start}\ngoal = [1]\n");
        let all = "{ urdf = \"r\" }";
        let [group, joints] = ["{ group = \"g\" }", "[{ urdf = \"r\" }, { joints = [\"a\"] }]"];
        for (robot, start, expected) in [
            (group, "{ a = 1, \"x/b c\" = 2.5 }", "{ numbers = [0.5], held = { a = 1, \"x/b c\" = 2.5 } }"),
            (joints, "\"home\"", "{ numbers = [0.5], held = \"home\" }"),
            (group, "{ numbers = [1, 2], held = \"home\" }", "{ numbers = [0.5], held = \"home\" }"),
            (group, "[1, 2]", "[0.5]"),
            (all, "\"home\"", "[0.5]"),
        ] {
            let expected = text(robot, &format!("{expected} # by --from"));
            assert_eq!(from(&text(robot, start), "0.5").unwrap(), expected);
        }
        assert!(from(&text(group, "\"home\""), "up").unwrap().contains("start = \"up\" # by"));
        for (header, from, to) in
            [("start", Some("1"), vec![]), ("goal", None, vec!["1"]), ("goals", None, vec!["1"])]
        {
            let header =
                if header == "goals" { "[[motion.goals]]".to_owned() } else { format!("[motion.{header}]") };
            let error = changed(from, &to, &[]).applied("p.toml", &format!("{header}\na = 1\n")).unwrap_err();
            assert!(error.to_string().contains("headers of their own"), "{error}");
        }
    }

    #[test]
    fn what_is_no_value_is_an_error_that_names_the_option() {
        for (wrong, option) in [
            (changed(Some("1, x"), &[], &[]), FROM),
            (changed(None, &["{ j = "], &[]), TO),
            (changed(None, &["j = = 1"], &[]), TO),
            (changed(None, &[], &["box"]), OBSTACLE),
            (changed(None, &[], &["box = [1,"]), OBSTACLE),
        ] {
            let error = wrong.applied("p.toml", TEXT).unwrap_err();
            assert!(error.file() == option && error.remedy().is_some(), "{wrong:?}: {error}");
        }
        let error = changed(Some("1"), &[], &[]).applied("p.toml", "[robot]\n").unwrap_err();
        assert!(error.to_string().contains("no start to replace"), "{error}");
    }
}
