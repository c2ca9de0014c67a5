//! Things that a link carries.

use super::{ArmError, ArmModel, Joint, JointKind, Link};
use mp_geom::TriMesh;
use nalgebra::Isometry3;

impl ArmModel {
    /// The same robot with a thing fixed to the link `to`, at `pose` in the frame of that link: a link of its own that must not
    /// touch any other, but those of `may_touch`, what is fixed to `to`, and other things attached there.
    ///
    /// # Errors
    /// [`ArmError::Attached`] when there is no link `to`, no link of `may_touch`, or a link called `name` already.
    pub fn attached(
        mut self,
        name: &str,
        shape: &TriMesh,
        to: &str,
        pose: &Isometry3<f64>,
        may_touch: &[String],
    ) -> Result<Self, ArmError> {
        let wrong = |why| Err(ArmError::Attached { name: name.to_owned(), link: to.to_owned(), why });
        let has = |link: &str| self.links.iter().any(|known| known.name == link);
        let names = || self.links.iter().map(|l| format!("\"{}\"", l.name)).collect::<Vec<_>>().join(", ");
        if has(name) {
            return wrong("there is a link of that name; give it another".to_owned());
        }
        if let Some(missing) = [to].into_iter().chain(may_touch.iter().map(String::as_str)).find(|l| !has(l))
        {
            return wrong(format!("there is no link \"{missing}\"; the links are {}", names()));
        }
        for link in self.links.iter().filter(|link| link.name != to) {
            let pair = (name.to_owned(), link.name.clone());
            match may_touch.contains(&link.name) {
                true => self.may_also_touch.push(pair),
                false => self.kept_apart.push(pair),
            }
        }
        self.links.push(Link::new(name).with(shape, &Isometry3::identity()));
        self.joints.push(Joint::new(name, to, name, JointKind::Fixed).at(*pose));
        Ok(self)
    }

    /// The same robot without what is [attached](Self::attached) under this name.
    #[must_use]
    pub fn detached(mut self, name: &str) -> Self {
        let is_other = |(a, b): &(String, String)| a != name && b != name;
        self.may_also_touch.retain(is_other);
        self.kept_apart.retain(is_other);
        self.links.retain(|link| link.name != name);
        self.joints.retain(|joint| joint.child != name);
        self
    }
}
