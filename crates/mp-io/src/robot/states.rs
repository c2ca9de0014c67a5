//! Named states of a robot: the `group_state` of an SRDF.

use super::{RobotPart, RobotProblem};
use crate::error::Error;
use crate::toml_problem::{GoalEntry, GoalPart};
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// A state that an SRDF names.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedState {
    /// Its name.
    pub name: String,
    /// The group of joints that it is of.
    pub group: String,
    /// The values (rad or m) of joints, by their names.
    pub joints: BTreeMap<String, f64>,
}

/// The states that the text of an SRDF names, in its order. Joints with several values are left out; a text that is no SRDF has no states.
#[must_use]
pub fn named_states(srdf: &str) -> Vec<NamedState> {
    let Ok(document) = Document::parse(srdf) else { return Vec::new() };
    let states = document.root_element().children().filter(|node| node.has_tag_name("group_state"));
    let joint = |node: Node<'_, '_>| {
        let value = node.attribute("value")?.trim().parse().ok().filter(|x: &f64| x.is_finite())?;
        Some((node.attribute("name")?.to_owned(), value))
    };
    let state = |node: Node<'_, '_>| {
        let joints = node.children().filter(|child| child.has_tag_name("joint")).filter_map(joint).collect();
        let text = |name| node.attribute(name).unwrap_or_default().to_owned();
        NamedState { name: text("name"), group: text("group"), joints }
    };
    states.map(state).collect()
}

impl RobotProblem {
    /// The problem with numbers in place of the names of states; `names` are the numbers of a configuration. Joints of which the state of
    /// the start says nothing are as in `neutral`, those of a goal as at the start.
    ///
    /// # Errors
    /// When no SRDF has a state of that name: at its place in the file.
    pub fn with_states(mut self, names: &[String], neutral: &[f64]) -> Result<Self, Error> {
        let values = |joints: &BTreeMap<String, f64>, others: &[f64]| -> Vec<f64> {
            let value = |(i, name): (usize, &String)| {
                joints.get(name).copied().unwrap_or_else(|| others.get(i).copied().unwrap_or(0.0))
            };
            names.iter().enumerate().map(value).collect()
        };
        if let Some(name) = self.file.start_state.take() {
            self.file.start = values(&self.state(&name, RobotPart::Start)?, neutral);
        }
        for i in 0..self.file.goals.len() {
            let GoalEntry::State(name) = &self.file.goals[i] else { continue };
            let joints = self.state(name, RobotPart::Goal(i))?;
            self.file.goals[i] = match self.file.tolerance > 0.0 {
                true => GoalEntry::Named(
                    joints
                        .into_iter()
                        .filter(|(name, _)| names.contains(name))
                        .map(|(name, x)| (name, GoalPart::Exactly(x)))
                        .collect(),
                ),
                false => GoalEntry::All(values(&joints, &self.file.start)),
            };
        }
        Ok(self)
    }

    /// Refuses names of states that there are not.
    pub(super) fn check_states(&self) -> Result<(), Error> {
        let goals = self.file.goals.iter().enumerate().filter_map(|(i, goal)| match goal {
            GoalEntry::State(name) => Some((RobotPart::Goal(i), name)),
            _ => None,
        });
        let mut all = self.file.start_state.iter().map(|name| (RobotPart::Start, name)).chain(goals);
        all.try_for_each(|(part, name)| self.state(name, part).map(|_| ()))
    }

    /// The joints of the states of this name: of several groups, all of them.
    fn state(&self, name: &str, part: RobotPart) -> Result<BTreeMap<String, f64>, Error> {
        let states = self.srdf.as_deref().map(named_states).unwrap_or_default();
        let found: Vec<_> = states.iter().filter(|state| state.name == name).collect();
        if found.is_empty() {
            let message = format!("there is no state \"{}\"", crate::text::clipped(name));
            let mut known: Vec<_> = states.iter().map(|state| state.name.as_str()).collect();
            known.dedup();
            let help = match (&self.srdf, known.is_empty()) {
                (None, _) => {
                    "states are in an SRDF, and none was found: give the values of the joints".to_owned()
                }
                (_, true) => "the SRDF has no states: give the values of the joints".to_owned(),
                (_, false) => format!("the states of the SRDF are {}", known.join(", ")),
            };
            return Err(self.file.fault(part, &message, &help));
        }
        Ok(found.into_iter().flat_map(|state| state.joints.clone()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_are_read() {
        let srdf = "<robot name='r'><group_state name='home' group='arm'><joint name='a' value='0.5'/><joint name='b' value='x'/>\
                    </group_state><group_state name='open' group='hand'/></robot>";
        let states = named_states(srdf);
        assert_eq!((states[0].name.as_str(), states[0].group.as_str()), ("home", "arm"));
        assert_eq!(states[0].joints, BTreeMap::from([("a".to_owned(), 0.5)]));
        assert_eq!((states[1].name.as_str(), states.len()), ("open", 2));
        assert!(named_states("<robot").is_empty());
    }
}
