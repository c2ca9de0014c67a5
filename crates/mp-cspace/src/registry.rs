//! Planners by name: their descriptions for people, and their settings as text.

use crate::{BuildError, Length, Space};

/// A parameter of a planner, described for people.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Its name in settings.
    pub name: &'static str,
    /// The values allowed.
    pub range: &'static str,
    /// Its default, as text of a setting.
    pub default: &'static str,
    /// What it does.
    pub doc: &'static str,
}

/// A planner, described for people.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlannerInfo {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is and when to use it, in a line.
    pub summary: &'static str,
    /// Its paper.
    pub citation: &'static str,
    /// What can be set, in the order in which help lists it.
    pub parameters: &'static [Parameter],
    /// Its other names.
    pub aliases: &'static [&'static str],
    /// The demands it cannot meet by its nature, each with the reason.
    pub cannot: &'static [(Demand, &'static str)],
}

impl PlannerInfo {
    /// Whether the planner can meet the demand.
    #[must_use]
    pub fn can(&self, demand: Demand) -> bool {
        self.reason_against(demand).is_none()
    }

    /// Why the planner cannot meet the demand; `None` if it can. Planners that move by inputs are those with
    /// the parameter `inputs`.
    #[must_use]
    pub fn reason_against(&self, demand: Demand) -> Option<&'static str> {
        let by_inputs = || self.parameters.iter().any(|parameter| parameter.name == "inputs");
        match demand {
            Demand::Inputs if !by_inputs() => {
                Some("the robot moves by inputs, and the planner on straight motions")
            }
            _ => self.cannot.iter().find(|(kind, _)| *kind == demand).map(|(_, reason)| *reason),
        }
    }

    /// Whether `name` is its name or one of its other names.
    #[must_use]
    pub fn is_called(&self, name: &str) -> bool {
        self.name == name || self.aliases.contains(&name)
    }
}

impl BuildError {
    /// There is no planner called `name` among `planners`; suggests the most similar name.
    #[must_use]
    pub fn unknown_planner(name: &str, planners: &[PlannerInfo]) -> Self {
        let known: Vec<_> = planners.iter().map(|info| info.name).collect();
        let aliases = planners.iter().flat_map(|info| info.aliases).copied();
        let suggestion = closest(name, known.iter().copied().chain(aliases));
        Self::UnknownPlanner { name: name.to_owned(), known, suggestion }
    }
}

/// A demand of a problem that some planners cannot meet by their nature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Demand {
    /// To reach a goal that is only a test: no state to aim at.
    Region,
    /// To plan with motions that cannot run backward.
    OneWay,
    /// To move by the inputs of a system only.
    Inputs,
    /// To plan without [hints](crate::ObstacleKnowledge::hints) of obstacles.
    NoHints,
    /// To plan without a [clearance gradient](crate::ObstacleKnowledge::gradient).
    NoGradient,
    /// To plan with neither a clearance gradient nor an [`Objective`](crate::Objective).
    NoCost,
    /// To plan without the [geometry](crate::ObstacleKnowledge::geometry) of obstacles.
    NoGeometry,
}

/// Values of parameters by name.
///
/// ```
/// use mp_cspace::registry::Settings;
/// let settings = Settings::parse(["step=15%", "goal-bias=0.1"])?;
/// assert_eq!(settings.number("goal-bias")?, Some(0.1));
/// assert!(Settings::parse(["step"]).is_err());
/// # Ok::<(), mp_cspace::BuildError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Settings(Vec<(String, String)>);

impl Settings {
    /// Settings from texts of the form `key=value`.
    ///
    /// # Errors
    /// When a text has no `=`, or nothing before it.
    pub fn parse<T: AsRef<str>>(texts: impl IntoIterator<Item = T>) -> Result<Self, BuildError> {
        let mut settings = Self::default();
        for text in texts {
            let text = text.as_ref();
            match text.split_once('=') {
                Some((key, value)) if !key.trim().is_empty() => settings.set(key.trim(), value.trim()),
                _ => return Err(malformed(text.to_owned(), "KEY=VALUE")),
            }
        }
        Ok(settings)
    }

    /// Sets a parameter; the last value counts.
    pub fn set(&mut self, key: &str, value: &str) {
        self.0.retain(|(known, _)| known != key);
        self.0.push((key.to_owned(), value.to_owned()));
    }

    /// The value of a parameter that is set.
    #[must_use]
    pub fn text(&self, key: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    /// Refuses names that are not parameters of `planner`.
    ///
    /// # Errors
    /// When there is such a name; lists the names allowed.
    pub fn check(&self, planner: &PlannerInfo) -> Result<(), BuildError> {
        self.check_among(planner.name, planner.parameters)
    }

    /// Refuses names other than those of `parameters`.
    ///
    /// # Errors
    /// When there is such a name; lists the names allowed.
    pub fn check_among<'p>(
        &self,
        planner: &'static str,
        parameters: impl IntoIterator<Item = &'p Parameter>,
    ) -> Result<(), BuildError> {
        let known: Vec<&'static str> = parameters.into_iter().map(|parameter| parameter.name).collect();
        match self.0.iter().find(|(key, _)| !known.iter().any(|name| name == key)) {
            None => Ok(()),
            Some((key, _)) => {
                let suggestion = closest(key, known.iter().copied());
                Err(BuildError::UnknownParameter { planner, name: key.clone(), known, suggestion })
            }
        }
    }

    /// The settings whose names are in `parameters`, in the same order.
    #[must_use]
    pub fn only(&self, parameters: &[Parameter]) -> Self {
        let known = |key: &str| parameters.iter().any(|parameter| parameter.name == key);
        Self(self.0.iter().filter(|(key, _)| known(key)).cloned().collect())
    }

    /// The whole number set for `parameter`, or its default.
    ///
    /// # Errors
    /// When it is not a whole number, or negative.
    pub fn count_of(&self, parameter: &Parameter) -> Result<u64, BuildError> {
        let default = || parameter.default.parse().unwrap_or_default();
        Ok(self.count(parameter.name)?.unwrap_or_else(default))
    }

    /// The number set for `parameter`, or its default, which is in \[0, 1\].
    ///
    /// # Errors
    /// When it is not a number, or not in \[0, 1\].
    pub fn part_of(&self, parameter: &Parameter) -> Result<f64, BuildError> {
        let default = || parameter.default.parse().unwrap_or_default();
        let value = self.number(parameter.name)?.unwrap_or_else(default);
        if (0.0..=1.0).contains(&value) {
            return Ok(value);
        }
        Err(BuildError::OutOfRange { name: parameter.name, value, range: parameter.range.to_owned() })
    }

    /// The value set for `key`, if any, as `parse` reads it.
    ///
    /// # Errors
    /// When `parse` does not accept it; `expected` says what it accepts.
    pub fn choice<T>(
        &self,
        key: &str,
        expected: &'static str,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Result<Option<T>, BuildError> {
        let Some(value) = self.text(key) else { return Ok(None) };
        match parse(value) {
            Some(parsed) => Ok(Some(parsed)),
            None => Err(malformed(format!("{key}={value}"), expected)),
        }
    }

    /// The number set for `key`, if any.
    ///
    /// # Errors
    /// When it is not a number.
    pub fn number(&self, key: &str) -> Result<Option<f64>, BuildError> {
        self.choice(key, "a number", |value| value.parse().ok())
    }

    /// The whole number set for `key`, if any.
    ///
    /// # Errors
    /// When it is not a whole number, or negative.
    pub fn count(&self, key: &str) -> Result<Option<u64>, BuildError> {
        self.choice(key, "a whole number, not negative", |value| value.parse().ok())
    }

    /// The length set for `key`, if any.
    ///
    /// # Errors
    /// When it is none.
    pub fn length(&self, key: &str) -> Result<Option<Length>, BuildError> {
        self.choice(key, "a length above zero, or a percentage of the extent like 20%", |value| {
            value.parse().ok()
        })
    }

    /// The length set for `parameter`, or its default: a length, or with `%` a part of the extent of `space`.
    ///
    /// # Errors
    /// When it is neither, not positive, or longer than the extent.
    pub fn length_of<C: Space>(&self, parameter: &Parameter, space: &C) -> Result<f64, BuildError> {
        let default =
            || Self(vec![(parameter.name.to_owned(), parameter.default.to_owned())]).length(parameter.name);
        let step = match self.length(parameter.name)? {
            Some(step) => Some(step),
            None => default()?,
        };
        let malformed = || malformed(format!("{}={}", parameter.name, parameter.default), "a length");
        step.ok_or_else(malformed)?.step_in(space).map_err(|error| match error {
            BuildError::OutOfRange { value, range, .. } => {
                BuildError::OutOfRange { name: parameter.name, value, range }
            }
            other => other,
        })
    }
}

fn malformed(setting: String, expected: &'static str) -> BuildError {
    BuildError::Malformed { setting, expected }
}

/// The known name that `name` was probably meant to be: the one fewest edits away, at most a third of its
/// length.
///
/// ```
/// assert_eq!(mp_cspace::registry::closest("rrt-conect", ["rrt", "rrt-connect"]), Some("rrt-connect"));
/// assert_eq!(mp_cspace::registry::closest("dijkstra", ["rrt", "rrt-connect"]), None);
/// ```
pub fn closest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let fold = |text: &str| -> Vec<char> { text.to_lowercase().replace('_', "-").chars().take(64).collect() };
    let name = fold(name);
    let most = name.len().div_ceil(3);
    let near = known.into_iter().map(|other| (edits(&name, &fold(other)), other));
    near.filter(|&(edits, _)| edits <= most).min_by_key(|&(edits, _)| edits).map(|(_, other)| other)
}

/// The Levenshtein distance: insertions, deletions and substitutions from `a` to `b`.
fn edits(a: &[char], b: &[char]) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_what_it_cannot_read() {
        assert!(matches!(Settings::parse(["=3"]), Err(BuildError::Malformed { .. })));
        let settings = Settings::parse(["near=far", "count = -1", "count=1.5"]).unwrap();
        assert!(matches!(settings.length("near"), Err(BuildError::Malformed { .. })));
        assert!(matches!(settings.count("count"), Err(BuildError::Malformed { .. })));
        assert_eq!(settings.number("count"), Ok(Some(1.5)));
        assert_eq!(settings.number("none"), Ok(None));
    }

    #[test]
    fn counts_edits() {
        let count = |a: &str, b: &str| edits(&a.chars().collect::<Vec<_>>(), &b.chars().collect::<Vec<_>>());
        assert_eq!(count("kitten", "sitting"), 3);
        assert_eq!(count("", "abc"), 3);
        assert_eq!(count("same", "same"), 0);
    }

    #[test]
    fn suggests_only_what_is_near() {
        assert_eq!(closest("RRT_Connect", ["rrt", "rrt-connect"]), Some("rrt-connect"));
        assert_eq!(closest("rtt", ["rrt", "rrt-connect"]), Some("rrt"));
        assert_eq!(closest("", ["rrt"]), None);
    }
}
