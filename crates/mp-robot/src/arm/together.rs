//! Several robots as one.

use super::robot::SharedArm;
use super::{ArmError, ArmModel, Joint, JointKind, Link};
use mp_cspace::Interrupt;
use std::collections::BTreeSet;

impl ArmModel {
    /// Several robots as one, whose root carries them all: the names of the links and joints of each begin with its text. Links of
    /// different robots must not touch; of each robot the same pairs are compared as when it is alone.
    ///
    /// # Errors
    /// When one of the models is not valid, or its base floats; and when `interrupt` says to end.
    pub fn together(robots: Vec<(String, Self)>, interrupt: &Interrupt) -> Result<Self, ArmError> {
        let mut all =
            Self { links: vec![Link::new("world")], may_touch: Some(Vec::new()), ..Self::default() };
        for (prefix, model) in robots {
            if model.floating.is_some() {
                return Err(ArmError::Floats);
            }
            let alone = SharedArm::new(&model, interrupt)?;
            let compared: BTreeSet<[&str; 2]> = alone.checked_pairs().collect();
            let solid =
                || model.links.iter().filter(|link| !link.shapes.is_empty()).map(|link| link.name.as_str());
            let pairs = solid().enumerate().flat_map(|(i, a)| solid().skip(i + 1).map(move |b| [a, b]));
            let named = |name: &str| format!("{prefix}{name}");
            let both = |[a, b]: [&str; 2]| (named(a), named(b));
            let (kept, free): (Vec<_>, Vec<_>) =
                pairs.partition(|[a, b]| compared.contains(&[*a, *b]) || compared.contains(&[*b, *a]));
            all.may_touch.get_or_insert_default().extend(free.into_iter().map(both));
            all.kept_apart.extend(kept.into_iter().map(both));
            let child = |link: &Link| model.joints.iter().any(|joint| joint.child == link.name);
            let root = model.links.iter().find(|link| !child(link)).map_or("", |link| link.name.as_str());
            all.joints.push(Joint::new(named("base"), "world", named(root), JointKind::Fixed).at(model.base));
            let name = prefix.trim_end_matches('/');
            all.notes.extend(alone.notes().map(|note| format!("{name}: {note}")));
            all.links.extend(model.links.iter().map(|link| Link { name: named(&link.name), ..link.clone() }));
            all.joints.extend(model.joints.iter().map(|joint| Joint {
                name: named(&joint.name),
                parent: named(&joint.parent),
                child: named(&joint.child),
                mimic: joint.mimic.clone().map(|mimic| super::Mimic { joint: named(&mimic.joint), ..mimic }),
                ..joint.clone()
            }));
        }
        Ok(all)
    }
}
