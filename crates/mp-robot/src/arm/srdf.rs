//! Pairs of links that may touch, from SRDF text.

use super::xml::Text;
use super::{ArmModel, UrdfError};

impl ArmModel {
    /// Takes the pairs of links that may touch from the `disable_collisions` of an SRDF. The rest of the SRDF is ignored; that
    /// the base moves by a virtual joint is said in a note, unless it [floats](Self::floating).
    ///
    /// # Errors
    /// [`UrdfError::Syntax`] when the text is not an SRDF. Missing links are reported by [`Arm::new`](crate::Arm::new).
    pub fn with_srdf(mut self, text: &str) -> Result<Self, UrdfError> {
        let text = Text::new("an SRDF", text)?;
        let document = text.parse()?;
        let mut pairs = Vec::new();
        for node in document.root_element().children().filter(|n| n.has_tag_name("disable_collisions")) {
            let link = |name: &str| {
                node.attribute(name)
                    .map(str::to_owned)
                    .ok_or_else(|| text.error(&node, format!("<disable_collisions> has no attribute {name}")))
            };
            pairs.push((link("link1")?, link("link2")?));
        }
        self.may_touch = Some(pairs);
        let free = |n: &roxmltree::Node<'_, '_>| matches!(n.attribute("type"), Some("floating" | "planar"));
        let mut virtuals = document.root_element().children().filter(|n| n.has_tag_name("virtual_joint"));
        if self.floating.is_none() && virtuals.any(|n| free(&n)) {
            self.notes.push(
                "the SRDF has a virtual joint by which the base moves, but the base stands still: write `base = \"floating\"` \
                 and `bounds` in the robot problem if it shall move freely"
                    .to_owned(),
            );
        }
        Ok(self)
    }
}
