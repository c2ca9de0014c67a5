//! Pairs of links that may touch, from SRDF text.

use super::groups::planar_parts;
use super::xml::{Text, some};
use super::{ArmModel, UrdfError};
use roxmltree::Node;
use std::collections::BTreeSet;

/// Elements that change nothing here: they name parts of the robot, or say how to plan for them.
const SKIPPED: [&str; 6] =
    ["group", "group_state", "end_effector", "virtual_joint", "joint_property", "link_sphere_approximation"];

impl ArmModel {
    /// Takes the pairs of links that may touch from an SRDF: those of `disable_collisions`, and all pairs of the links of
    /// `disable_default_collisions` but those of `enable_collisions`. The latter must not touch even if a joint connects them,
    /// unless `disable_collisions` names them too.
    ///
    /// Notes say which links are not of this robot, whose entries are skipped, which joints of groups and states are not, how many `disable_collisions` name one link only, and which other elements are not read although
    /// they have a meaning: that the base moves by a virtual joint, unless it [floats](Self::floating), that joints are passive,
    /// and elements that are unknown.
    ///
    /// # Errors
    /// [`UrdfError::Syntax`] when the text is not an SRDF.
    pub fn with_srdf(mut self, text: &str) -> Result<Self, UrdfError> {
        let text = Text::new("an SRDF", text)?;
        let document = text.parse()?;
        let elements = |name: &'static str| {
            document.root_element().children().filter(move |node| node.has_tag_name(name))
        };
        let named = |node: &Node<'_, '_>, name: &str| text.named(node, name);
        let mut absent = BTreeSet::new();
        let mut known = |model: &Self, name: &String| {
            model.links.iter().any(|link| link.name == *name) || {
                absent.insert(name.clone());
                false
            }
        };
        let half =
            |node: &Node<'_, '_>| node.attribute("link1").is_none() || node.attribute("link2").is_none();
        let mut pairs = |model: &Self, name: &'static str| {
            let mut pairs = Vec::new();
            // That is less than it could say: more is compared.
            let skipped = |node: &Node<'_, '_>| name == "disable_collisions" && half(node);
            for node in elements(name).filter(|node| !skipped(node)) {
                let pair = (named(&node, "link1")?, named(&node, "link2")?);
                // Both are looked for, so that both are named if they are absent.
                if known(model, &pair.0) & known(model, &pair.1) {
                    pairs.push(pair);
                }
            }
            Ok::<_, UrdfError>(pairs)
        };
        let halves = elements("disable_collisions").filter(half).count();
        let mut may_touch = pairs(&self, "disable_collisions")?;
        let mut kept_apart = pairs(&self, "enable_collisions")?;
        let same =
            |(a, b): &(String, String), (c, d): &(String, String)| (a, b) == (c, d) || (a, b) == (d, c);
        kept_apart.retain(|pair| !may_touch.iter().any(|other| same(pair, other)));
        for node in elements("disable_default_collisions") {
            let link = named(&node, "link")?;
            if known(&self, &link) {
                let others = self.links.iter().filter(|other| other.name != link);
                may_touch.extend(others.map(|other| (link.clone(), other.name.clone())));
            }
        }
        (self.may_touch, self.kept_apart) = (Some(may_touch), kept_apart);

        if halves > 0 {
            self.notes.push(format!(
                "<disable_collisions> without link1 or link2 is not read: {halves} in the SRDF"
            ));
        }
        if !absent.is_empty() {
            let absent: Vec<_> = absent.into_iter().collect();
            self.notes.push(format!("the SRDF names links that this robot does not have: {}", some(&absent)));
        }
        let of_world: BTreeSet<_> = elements("virtual_joint").filter_map(|n| n.attribute("name")).collect();
        let has = |name: &str| {
            let parts = planar_parts(name);
            of_world.contains(name) || self.joints.iter().any(|j| j.name == name || parts.contains(&j.name))
        };
        let members = elements("group").chain(elements("group_state")).flat_map(|node| node.children());
        let members = members.filter(|node| node.has_tag_name("joint")).filter_map(|n| n.attribute("name"));
        let absent: BTreeSet<_> = members.map(str::trim).filter(|name| !has(name)).collect();
        if !absent.is_empty() {
            let absent: Vec<_> = absent.into_iter().map(str::to_owned).collect();
            self.notes.push(format!(
                "groups or states of the SRDF name joints that this robot does not have: {}",
                some(&absent)
            ));
        }
        let passive =
            elements("passive_joint").map(|node| named(&node, "name")).collect::<Result<Vec<_>, _>>()?;
        if !passive.is_empty() {
            let note = "joints that are passive by the SRDF move like all others";
            self.notes.push(format!("{note}: {}", some(&passive)));
        }
        let read = ["disable_collisions", "enable_collisions", "disable_default_collisions", "passive_joint"];
        let names = document.root_element().children().filter(Node::is_element).map(|n| n.tag_name().name());
        let unknown: BTreeSet<_> = names.filter(|n| !SKIPPED.contains(n) && !read.contains(n)).collect();
        if !unknown.is_empty() {
            let unknown: Vec<_> = unknown.into_iter().map(str::to_owned).collect();
            self.notes.push(format!("elements of the SRDF that are not read: {}", some(&unknown)));
        }
        let free = |n: &Node<'_, '_>| matches!(n.attribute("type"), Some("floating" | "planar"));
        let stands = self.floating.is_none() && !self.has_planar_base();
        if stands && elements("virtual_joint").any(|n| free(&n)) {
            self.notes.push(
                "the SRDF has a virtual joint by which the base moves, but the base stands still: write `base = \"floating\"` \
                 and `bounds` in the robot problem if it shall move freely"
                    .to_owned(),
            );
        }
        Ok(self)
    }
}
