//! Groups of joints, and states with names, from SRDF text.

use super::xml::{Text, some};
use super::{ArmModel, Joint, JointKind, UrdfError};
use roxmltree::Node;
use std::collections::BTreeSet;

/// A named state of an SRDF: values for the joints of a group.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedState {
    /// The name of the state.
    pub name: String,
    /// The name of the group that it sets.
    pub group: String,
    /// Joints and their values (rad or m).
    pub values: Vec<(String, f64)>,
}

/// A member of a group.
#[derive(Clone, Debug, PartialEq)]
enum Member {
    Joint(String),
    /// The joint above this link.
    Link(String),
    /// The joints between two links.
    Chain {
        base: String,
        tip: String,
    },
    Group(String),
}

/// The groups and named states of an SRDF.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SrdfGroups {
    groups: Vec<(String, Vec<Member>)>,
    states: Vec<NamedState>,
}

impl SrdfGroups {
    /// Those of an SRDF.
    ///
    /// # Errors
    /// [`UrdfError::Syntax`] when the text is not an SRDF, or a value is no number.
    pub fn from_srdf(text: &str) -> Result<Self, UrdfError> {
        let text = Text::new("an SRDF", text)?;
        let document = text.parse()?;
        let named = |node: &Node<'_, '_>, name: &str| text.named(node, name);
        let mut found = Self::default();
        for node in document.root_element().children().filter(Node::is_element) {
            match node.tag_name().name() {
                "group" => {
                    let mut members = Vec::new();
                    for member in node.children().filter(Node::is_element) {
                        members.push(match member.tag_name().name() {
                            "joint" => Member::Joint(named(&member, "name")?),
                            "link" => Member::Link(named(&member, "name")?),
                            "group" => Member::Group(named(&member, "name")?),
                            "chain" => Member::Chain {
                                base: named(&member, "base_link")?,
                                tip: named(&member, "tip_link")?,
                            },
                            _ => continue,
                        });
                    }
                    found.groups.push((named(&node, "name")?, members));
                }
                "group_state" => {
                    let mut values = Vec::new();
                    for joint in node.children().filter(|child| child.has_tag_name("joint")) {
                        let (name, value) = (named(&joint, "name")?, named(&joint, "value")?);
                        let numbers = value.split_ascii_whitespace().map(str::parse::<f64>);
                        match numbers
                            .collect::<Result<Vec<_>, _>>()
                            .ok()
                            .filter(|all| all.iter().all(|x| x.is_finite()))
                            .as_deref()
                        {
                            Some(&[number]) => values.push((name, number)),
                            // A joint that is planar.
                            Some(&[x, y, theta]) => {
                                values.extend(planar_parts(&name).into_iter().zip([x, y, theta]));
                            }
                            // Joints that float move the whole robot.
                            Some([_, _, ..]) => {}
                            _ => return Err(text.error(&joint, format!("\"{value}\" is no finite number"))),
                        }
                    }
                    found.states.push(NamedState {
                        name: named(&node, "name")?,
                        group: named(&node, "group")?,
                        values,
                    });
                }
                _ => {}
            }
        }
        Ok(found)
    }

    /// The names of the groups.
    pub fn groups(&self) -> impl Iterator<Item = &str> {
        self.groups.iter().map(|(name, _)| name.as_str())
    }

    /// The named states, of all groups.
    #[must_use]
    pub fn states(&self) -> &[NamedState] {
        &self.states
    }

    /// The joints of a group that can move by themselves, in the order of the model, with those of the groups in it.
    ///
    /// # Errors
    /// What is wrong, in a sentence: there is no such group, it names what the robot does not have, or nothing of it moves.
    pub fn joints(&self, model: &ArmModel, group: &str) -> Result<Vec<String>, String> {
        let mut joints = BTreeSet::new();
        let (mut left, mut seen) = (vec![group], BTreeSet::new());
        while let Some(name) = left.pop() {
            if !seen.insert(name) {
                continue;
            }
            let Some((_, members)) = self.groups.iter().find(|(known, _)| known == name) else {
                let known: Vec<_> = self.groups().map(str::to_owned).collect();
                return Err(match known.is_empty() {
                    true => format!("there is no group \"{name}\", as there are no groups"),
                    false => format!("there is no group \"{name}\"; the groups are {}", some(&known)),
                });
            };
            for member in members {
                match member {
                    Member::Group(inner) => left.push(inner),
                    // The joint between the robot and the world is not in a URDF.
                    Member::Joint(joint) => {
                        let parts = planar_parts(joint);
                        let own = |(_, j): &(usize, &Joint)| j.name == *joint || parts.contains(&j.name);
                        joints.extend(model.joints.iter().enumerate().filter(own).map(|(i, _)| i));
                    }
                    Member::Link(link) => joints.extend(above(model, link, name)?),
                    Member::Chain { base, tip } => joints.extend(chain(model, base, tip, name)?),
                }
            }
        }
        let moves = |i: &usize| {
            let joint = &model.joints[*i];
            joint.mimic.is_none() && joint.kind != JointKind::Fixed && joint.kind.held().is_none()
        };
        let found: Vec<_> = joints.into_iter().filter(moves).map(|i| model.joints[i].name.clone()).collect();
        match found.is_empty() {
            true => Err(format!("no joint of the group \"{group}\" moves by itself")),
            false => Ok(found),
        }
    }
}

/// The joints that are read in place of a planar one.
pub(super) fn planar_parts(joint: &str) -> [String; 3] {
    ["x", "y", "theta"].map(|part| format!("{joint}/{part}"))
}

/// The joint above a link, if it has one.
fn above(model: &ArmModel, link: &str, group: &str) -> Result<Option<usize>, String> {
    match model.links.iter().any(|known| known.name == *link) {
        true => Ok(model.joints.iter().position(|joint| joint.child == *link)),
        false => {
            Err(format!("the group \"{group}\" names the link \"{link}\", which the robot does not have"))
        }
    }
}

/// The joints between two links: those from each of them up to the first link that is above both, or is one of them.
fn chain(model: &ArmModel, base: &str, tip: &str, group: &str) -> Result<Vec<usize>, String> {
    let [mut from, mut to] = [all_above(model, base, group)?, all_above(model, tip, group)?];
    // What is above both is not between them.
    while from.last().is_some_and(|joint| to.last() == Some(joint)) {
        from.pop();
        to.pop();
    }
    let top = |joints: &[usize], link: &str| {
        joints.last().map_or(link.to_owned(), |&joint| model.joints[joint].parent.clone())
    };
    if top(&from, base) != top(&to, tip) {
        return Err(format!(
            "the group \"{group}\" has a chain from \"{base}\" to \"{tip}\", which are in no such chain"
        ));
    }
    from.extend(to);
    Ok(from)
}

/// The joints above a link, from the nearest to the first of the robot.
fn all_above(model: &ArmModel, link: &str, group: &str) -> Result<Vec<usize>, String> {
    let (mut joints, mut link) = (Vec::new(), link);
    // Of a loop, which is no robot, each joint once.
    while let Some(joint) = above(model, link, group)?.filter(|_| joints.len() < model.joints.len()) {
        joints.push(joint);
        link = &model.joints[joint].parent;
    }
    Ok(joints)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Link;

    /// base -lift- torso, on which hang -left- l and -elbow- inner -right- r.
    #[test]
    fn chains_go_over_the_link_that_is_above_both_ends() {
        let turn = JointKind::Continuous;
        let joints = [
            ("lift", "base", "torso"),
            ("left", "torso", "l"),
            ("elbow", "torso", "inner"),
            ("right", "inner", "r"),
        ];
        let links = ["base", "torso", "l", "inner", "r", "apart"].map(Link::new);
        let joints = joints.map(|(name, parent, child)| Joint::new(name, parent, child, turn));
        let model = ArmModel { links: links.into(), joints: joints.into(), ..ArmModel::default() };
        let between = |base: &str, tip: &str| {
            let text = format!(
                "<robot name='r'><group name='g'><chain base_link='{base}' tip_link='{tip}'/></group></robot>"
            );
            SrdfGroups::from_srdf(&text).unwrap().joints(&model, "g")
        };
        assert_eq!(between("l", "r").unwrap(), ["left", "elbow", "right"]);
        assert_eq!(between("r", "l").unwrap(), ["left", "elbow", "right"]);
        assert_eq!(between("base", "l").unwrap(), ["lift", "left"]);
        assert_eq!(between("r", "torso").unwrap(), ["elbow", "right"]);
        assert!(between("apart", "r").unwrap_err().contains("in no such chain"));
        assert!(between("gone", "r").unwrap_err().contains("\"gone\""));
        assert!(between("l", "l").unwrap_err().contains("no joint of the group"));
    }
}
