//! Which links may touch, which joints follow others, and the keyframes.

use super::document::{Classes, Element, Model, Said};
use super::tree::{Numbers, Reader};
use mp_formats::error::Error;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// The most pairs of links that may touch.
const MAX_PAIRS: usize = 200_000;

/// What a geom, or a link, touches: two do if a bit of `kind` of one is in `with` of the other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bits {
    kind: u32,
    with: u32,
}

impl Bits {
    pub(super) fn of(said: &Said<'_, '_>) -> Result<Self, Error> {
        let bits = |key| {
            let number = said.number(key, 1.0)?;
            match number.fract() == 0.0 && (-2_147_483_648.0..=4_294_967_295.0).contains(&number) {
                true => Ok(number as i64 as u32),
                false => Err(said.wrong(key, "a whole number of 32 bits")),
            }
        };
        Ok(Self { kind: bits("contype")?, with: bits("conaffinity")? })
    }

    /// What touches all that any of both touches.
    pub(super) fn and(self, other: Self) -> Self {
        Self { kind: self.kind | other.kind, with: self.with | other.with }
    }

    /// Whether it touches nothing whatever.
    pub(super) fn never(self) -> bool {
        (self.kind, self.with) == (0, 0)
    }

    fn touch(self, other: Self) -> bool {
        self.kind & other.with != 0 || other.kind & self.with != 0
    }
}

/// The geoms that pairs name, which touch whatever their bits say.
pub(super) struct PairedGeoms<'m> {
    names: HashSet<&'m str>,
    pairs: Vec<[&'m str; 2]>,
    links: HashMap<&'m str, usize>,
}

impl<'m> PairedGeoms<'m> {
    pub(super) fn of(model: &Model<'m>) -> Result<Self, Error> {
        let pairs = model.inside("contact").into_iter().filter(|node| node.has_tag_name("pair"));
        let pairs: Vec<[&'m str; 2]> =
            pairs.filter_map(|node| Some([node.attribute("geom1")?, node.attribute("geom2")?])).collect();
        Ok(Self { names: pairs.iter().flatten().copied().collect(), pairs, links: HashMap::new() })
    }

    /// Whether a pair names the geom `node`, which is of this link.
    pub(super) fn found(&mut self, node: Element<'m>, link: usize) -> bool {
        let name = node.attribute("name").filter(|name| self.names.contains(name));
        name.is_some_and(|name| {
            self.links.insert(name, link);
            true
        })
    }

    fn links(&self) -> BTreeSet<(usize, usize)> {
        let link = |name: &str| self.links.get(name).copied();
        self.pairs.iter().filter_map(|[a, b]| Some(ordered(link(a)?, link(b)?))).collect()
    }
}

fn ordered(a: usize, b: usize) -> (usize, usize) {
    (a.min(b), a.max(b))
}

/// The joints that follow others in proportion.
pub(super) struct Couplings<'m> {
    /// The joint that is followed, and the constant and the factor.
    pub(super) of: BTreeMap<&'m str, (&'m str, [f64; 2])>,
    /// The names of other equalities, which are not read.
    pub(super) unread: Vec<&'m str>,
}

impl<'m> Couplings<'m> {
    pub(super) fn of(model: &Model<'m>, classes: &Classes<'m>) -> Result<Self, Error> {
        let mut read = Self { of: BTreeMap::new(), unread: Vec::new() };
        for node in model.inside("equality") {
            let said = Said::of(model, classes, node, 0)?;
            if said.text("active") == Some("false") {
                continue;
            }
            let kind = node.tag_name().name();
            let mut row =
                if kind == "joint" { said.row("polycoef")?.unwrap_or_default() } else { Vec::new() };
            // What is not said is as in y = x.
            row.extend([0.0, 1.0].iter().skip(row.len()));
            match (node.attribute("joint1"), node.attribute("joint2"), row.as_slice()) {
                (Some(one), Some(two), [constant, factor, rest @ ..])
                    if one != two && rest.iter().all(|x| *x == 0.0) =>
                {
                    read.of.insert(one, (two, [*constant, *factor]));
                }
                _ => read.unread.push(node.attribute("name").unwrap_or(kind)),
            }
        }
        // Those that follow a follower would need what that follows.
        let leads: Vec<&str> =
            read.of.values().map(|(two, _)| *two).filter(|two| read.of.contains_key(two)).collect();
        leads.into_iter().for_each(|two| {
            if read.of.remove(two).is_some() {
                read.unread.push(two);
            }
        });
        Ok(read)
    }
}

/// A joint and its value (rad or m).
pub(super) type JointValue = (usize, f64);

impl<'m> Reader<'_, 'm> {
    /// Pairs of links that may touch, and pairs that must not although a joint connects them: those of the world, and those that `pair` names.
    pub(super) fn link_pairs(&self) -> Result<[Vec<(usize, usize)>; 2], Error> {
        let names: HashMap<&str, usize> =
            self.links.iter().enumerate().map(|(i, link)| (link.name.as_str(), i)).collect();
        let mut excluded = BTreeSet::new();
        for node in self.model.inside("contact").into_iter().filter(|node| node.has_tag_name("exclude")) {
            let link = |key| {
                let name = self.model.own(node, key)?;
                names.get(name).copied().ok_or_else(|| {
                    let message = format!("there is no body \"{}\"", mp_formats::text::clipped(name));
                    self.model.error(node, message).help(format!("name a body in {key}"))
                })
            };
            excluded.insert(ordered(link("body1")?, link("body2")?));
        }
        let paired = self.paired.links();
        // The last one counts, as for all that is said twice.
        let flags = self.model.inside("option").into_iter().filter(|node| node.has_tag_name("flag"));
        let filter = flags.filter_map(|flag| flag.attribute("filterparent")).next_back();
        let joined_touch = filter == Some("disable");
        let solid: Vec<usize> = (0..self.links.len()).filter(|i| !self.links[*i].shapes.is_empty()).collect();
        let (mut may_touch, mut kept_apart) = (Vec::new(), Vec::new());
        let stands = |weld: usize| weld == 0 || self.links[weld].free;
        for (k, &j) in solid.iter().enumerate() {
            for &i in &solid[..k] {
                let (a, b) = (&self.links[i], &self.links[j]);
                if a.weld == b.weld || (stands(a.weld) && stands(b.weld)) {
                    continue;
                }
                let touch = a.bits.touch(b.bits);
                // MuJoCo compares what stands still with all that moves.
                let linked = (a.weld != 0 && b.above == a.weld) || (b.weld != 0 && a.above == b.weld);
                let joined = linked && !joined_touch;
                let must_not = paired.contains(&(i, j));
                if !must_not && (!touch || joined || excluded.contains(&(i, j))) {
                    may_touch.push((i, j));
                } else if must_not || linked || (i == 0 && stands(b.above)) {
                    kept_apart.push((i, j));
                }
            }
        }
        if may_touch.len() > MAX_PAIRS {
            let root = self.model.documents[0].root_element();
            let message = format!("more than {MAX_PAIRS} pairs of bodies touch by contype and conaffinity");
            return Err(self.model.too_large(root, message));
        }
        Ok([may_touch, kept_apart])
    }

    /// The keyframes: names, and the values of joints.
    pub(super) fn keyframes(&mut self) -> Result<Vec<(String, Vec<JointValue>)>, Error> {
        let mut found = Vec::new();
        let wanted: usize = self.numbers.iter().map(Numbers::count).sum();
        for (i, node) in self.model.inside("keyframe").into_iter().enumerate() {
            let said = Said::of(self.model, self.classes, node, 0)?;
            let name = node.attribute("name").map_or_else(|| format!("key {i}"), str::to_owned);
            let Some(row) = said.row("qpos")? else { continue };
            if row.len() != wanted {
                self.left_out("keyframes with another number of values than the model are not read", &name);
                continue;
            }
            let (mut values, mut rest) = (Vec::new(), row.as_slice());
            for numbers in &self.numbers {
                let (own, others) = rest.split_at(numbers.count());
                match (numbers, own) {
                    (Numbers::One(joint), [value]) => values.push((*joint, *value)),
                    (Numbers::Ball(joint), [w, x, y, z]) => {
                        let turns = about_axes([*w, *x, *y, *z]);
                        values.extend(turns.into_iter().enumerate().map(|(k, turn)| (joint + k, turn)));
                    }
                    _ => {}
                }
                rest = others;
            }
            found.push((name, values));
        }
        Ok(found)
    }
}

/// The angles about x, then y, then z of the turned frame that make up a quaternion.
fn about_axes([w, x, y, z]: [f64; 4]) -> [f64; 3] {
    let Ok(pose) = mp_geom::pose_from_quaternion([0.0; 3], w, x, y, z) else { return [0.0; 3] };
    // The inverse turns about z, y and x in this order, by the opposite angles.
    let [.., yaw, pitch, roll] = mp_geom::six_from_pose(&pose.inverse());
    [-roll, -pitch, -yaw]
}
