//! What is wrong with a configuration, or with the ends of a scene.

use crate::{Contact, End, Error, ErrorKind, Robot};
use mp_cspace::{Clearance, Configuration, Space, Validity};
use mp_kinds::numbers::{rounded, told_apart};
use serde::{Deserialize, Serialize};

/// Why a configuration is free or not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    /// Whether the configuration is in bounds and at least the tolerance away from contact.
    pub free: bool,
    /// Whether it is within the bounds of the space.
    pub in_bounds: bool,
    /// A lower bound (m) on the distance to contact; zero in collision, and where none is known.
    pub clearance: f64,
    /// The pairs of bodies in contact; empty when the configuration is free.
    pub touching: Vec<Contact>,
    /// Warnings of bodies inside closed surfaces: a surface has an inside only if it is made solid.
    pub warnings: Vec<String>,
    /// What is wrong, as the end of a sentence that begins "the configuration is"; `None` when it is free.
    pub fault: Option<String>,
    /// A free configuration nearby, for one that is not free.
    pub nearest_free: Option<Vec<f64>>,
}

pub(crate) fn explain(kind: &dyn Robot, q: &Configuration) -> Explanation {
    let (in_bounds, fault) = (kind.any_space().contains(q), fault(kind, q));
    let clearance = match in_bounds {
        true => kind.any_measure().clearance(q, f64::INFINITY).max(0.0),
        false => 0.0,
    };
    let nearest = fault.is_some().then(|| nearest_free(kind, q)).flatten();
    Explanation {
        free: fault.is_none(),
        in_bounds,
        clearance,
        touching: if in_bounds { kind.touching(q) } else { Vec::new() },
        warnings: if in_bounds { enclosures(kind, q).into_iter().collect() } else { Vec::new() },
        fault,
        nearest_free: nearest.map(|q| kind.row(&q)),
    }
}

/// A free configuration near `q`; of one out of bounds, near the nearest one within.
fn nearest_free(kind: &dyn Robot, q: &Configuration) -> Option<Configuration> {
    if kind.any_space().contains(q) {
        return free_near(kind, q);
    }
    let mut row = kind.row(q);
    for (number, limits) in row.iter_mut().zip(kind.limits()) {
        *number = limits.map_or(*number, |[low, high]| number.max(low).min(high));
    }
    let inside = kind.state(&row);
    if fault(kind, &inside).is_none() { Some(inside) } else { free_near(kind, &inside) }
}

/// A free configuration near `q`, with as few decimals as leave it free: people paste it back.
fn free_near(kind: &dyn Robot, q: &Configuration) -> Option<Configuration> {
    let found = kind.nearest_free(q)?;
    let short = [9, 12, 15].into_iter().map(|decimals| {
        let row: Vec<_> = kind.row(&found).into_iter().map(|v| rounded(v, decimals)).collect();
        kind.state(&row)
    });
    Some(short.into_iter().find(|q| fault(kind, q).is_none()).unwrap_or(found))
}

/// What is wrong with a configuration, to follow the words "the start is".
pub(crate) fn fault(kind: &dyn Robot, q: &Configuration) -> Option<String> {
    if !kind.any_space().contains(q) {
        return Some(kind.out_of_bounds(q));
    }
    if let Some(constraint) = kind.broken(q) {
        return Some(format!("against the constraint `{constraint}`"));
    }
    if kind.sampled().is_some() {
        return (!kind.any_checker().is_valid(q)).then(|| "in collision".to_owned());
    }
    let tolerance = kind.tolerance();
    if kind.any_checker().clearance(q, tolerance) >= tolerance {
        return None;
    }
    let touching = kind.touching(q);
    Some(match touching.is_empty() {
        true => {
            let (between, distance) = match kind.closest(q) {
                Some((names, distance)) => (format!(" between {names}"), distance),
                None => (String::new(), kind.any_measure().clearance(q, f64::INFINITY)),
            };
            // Links may be nearer to each other than what is kept from obstacles.
            let kept = if distance < tolerance { 0.0 } else { kind.kept() };
            let [distance, needed] = told_apart(distance, kept + tolerance);
            let needs = if kept > 0.0 { "must be kept" } else { "is needed" };
            format!("{distance} m from contact{between}: at least {needed} m {needs}")
        }
        false if touching.iter().any(|touch| touch.part.is_some()) => {
            format!("in collision: {}", list(&touching))
        }
        false => format!("in collision with {}", list(&touching)),
    })
}

/// Start and goals, with the names that messages give them.
fn ends(kind: &dyn Robot) -> impl Iterator<Item = (End, String, &Configuration)> {
    let many = kind.goals().len() > 1;
    let goals = kind.goals().iter().enumerate().map(move |(i, q)| {
        let name = if many { format!("goal {}", i + 1) } else { "the goal".to_owned() };
        (End::Goal(i), name, q)
    });
    std::iter::once((End::Start, "the start".to_owned(), kind.start())).chain(goals)
}

/// An error message and a remedy for the configuration that messages call `name`; `None` when it is free.
pub(crate) fn refused(kind: &dyn Robot, name: &str, q: &Configuration) -> Option<(String, String)> {
    let fault = fault(kind, q)?;
    let mut help = match free_near(kind, q) {
        _ if !kind.any_space().contains(q) => kind.bounds_remedy(q),
        Some(free) => format!("the nearest free configuration found is {}", kind.in_words(&free)),
        None if kind.kept() > 0.0 => "nothing nearby keeps that clearance: ask for less".to_owned(),
        None => "no free configuration was found nearby: is the scene in metres, the robot in its frame?"
            .to_owned(),
    };
    if kind.any_space().contains(q)
        && let Some(remedy) = kind.remedy(&kind.touching(q))
    {
        help += &format!("; {remedy}");
    }
    Some((format!("{name} is {fault}"), help))
}

/// The most that are listed.
const LISTED: usize = 3;

/// A warning of what is inside of closed surfaces, if anything is.
pub(crate) fn enclosures(kind: &dyn Robot, q: &Configuration) -> Option<String> {
    let found = kind.enclosures(q);
    let named = found.iter().take(LISTED).map(|[inner, outer]| format!("{inner} is inside of {outer}"));
    let named = named.collect::<Vec<_>>().join(", ");
    let more = match found.len() {
        0 => return None,
        n if n > LISTED => format!(" and {} more", n - LISTED),
        _ => String::new(),
    };
    let what = "a closed mesh, but a surface, so that this counts as free: `solid = true` beside a mesh gives it an inside";
    Some(format!("{named}{more}: {what}"))
}

/// An error if the start or a goal is not free: it says what touches, how deep, and the nearest free configuration.
/// Otherwise returns what is odd about them.
pub(crate) fn check_ends(kind: &dyn Robot) -> Result<Vec<String>, Error> {
    for (end, name, q) in ends(kind) {
        if let Some((message, help)) = refused(kind, &name, q) {
            return Err(kind.end_error(end, message, help).of_kind(ErrorKind::NotFree(end)));
        }
    }
    let inside = ends(kind).filter_map(|(_, name, q)| Some(format!("at {name} {}", enclosures(kind, q)?)));
    Ok(inside.chain(kind.ends_error()).collect())
}

/// Which of start and goals are not free, and why.
pub(crate) fn wrong_ends(kind: &dyn Robot) -> Vec<String> {
    ends(kind).filter_map(|(_, name, q)| Some(format!("{name} is {}", fault(kind, q)?))).collect()
}

/// What is wrong or odd about a scene.
pub(crate) fn lint(kind: &dyn Robot) -> Vec<String> {
    let mut found = wrong_ends(kind);
    found.extend(ends(kind).filter_map(|(_, name, q)| Some(format!("at {name} {}", enclosures(kind, q)?))));
    found.extend(kind.lint());
    let bodies = kind.bodies();
    if !bodies.is_empty() && bodies.iter().all(|body| body.pose.is_none()) {
        found.push("there are no obstacles".to_owned());
    }
    if kind.goals().contains(kind.start()) {
        found.push("start and goal are the same".to_owned());
    }
    found
}

/// The names of what touches, as messages list them.
pub(crate) fn list(touching: &[Contact]) -> String {
    touching.iter().map(Contact::to_string).collect::<Vec<_>>().join(", ")
}
