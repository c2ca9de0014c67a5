//! Random requests: every planner by name, with its settings at their ends too.

use crate::draw::Draw;
use mp_plan::{
    Budget, Finish, Length, MetricName, MotionValidator, ObjectiveName, Parameter, PlannerInfo, RelaxField,
    Request, Scene,
};
use std::collections::BTreeMap;

/// What is planned must not depend on the clock. This only ends what would take all night, and is counted.
const MOST_SECONDS: f64 = 30.0;

/// Parameters are set with this probability each.
const SET: f64 = 0.35;

/// A random request for a scene. `planner` is the only planner to take, with or without prefixes.
#[must_use]
pub fn request(draw: &mut Draw, scene: &Scene, planner: Option<&str>) -> Request {
    let (name, parameters) = match planner {
        Some(name) => (name.to_owned(), parameters_of(name)),
        None => planner_for(draw, scene),
    };
    let mut settings = BTreeMap::new();
    let plain = draw.chance(0.3);
    for parameter in parameters {
        if !plain
            && draw.chance(SET)
            && let Some(value) = value_for(draw, scene, &parameter)
        {
            settings.insert(parameter.name.to_owned(), value);
        }
    }
    let metric = if draw.chance(0.75) { MetricName::Default } else { draw.one(&MetricName::ALL).0 };
    let motion = match draw.below(10) {
        0 => MotionValidator::Discrete(Length::Fraction(draw.logarithmic(1e-4, 0.5))),
        1 => MotionValidator::Discrete(Length::Fraction(0.01)),
        _ => MotionValidator::Certified,
    };
    // Relaxing takes a hundred times as long as most problems here.
    let finish = match draw.below(25) {
        0..=7 => Finish::AsFound,
        8 => Finish::Relax,
        _ => Finish::Shorten,
    };
    let field = match draw.below(6) {
        0 => RelaxField::Paper,
        1 => RelaxField::Risk(draw.logarithmic(0.1, 10.0)),
        _ => RelaxField::Clearance,
    };
    // An iteration of these is many iterations of each of their runs.
    let most = 1500.0 / mp_math::powf(8.0, name.matches("or-").count() as f64);
    let nodes = draw.chance(0.1).then(|| draw.logarithmic(2.0, 2000.0) as usize);
    Request {
        planner: name,
        settings,
        metric,
        motion,
        clearance: 0.0,
        budget: Budget {
            time_s: Some(MOST_SECONDS),
            iterations: Some(draw.logarithmic(0.05 * most, most) as u64),
            queries: Some(draw.logarithmic(1_000.0, 15_000.0) as u64),
            nodes,
        },
        seed: draw.bits() >> 12,
        threads: if draw.chance(0.9) { 1 } else { draw.count(2, 4) },
        finish,
        hybridize: if finish == Finish::Shorten && draw.chance(0.03) { draw.count(2, 4) } else { 1 },
        field: if finish == Finish::Relax { field } else { RelaxField::Clearance },
        first_only: draw.chance(0.7),
        sharp_clearance: draw.chance(0.5),
        roadmap: None,
        objective: match draw.below(10) {
            0 => ObjectiveName::Clearance { weight: draw.logarithmic(0.1, 100.0), range: None },
            _ => ObjectiveName::Length,
        },
    }
}

/// A planner that can plan in the scene, perhaps run by meta-planners, and the parameters of all of them.
fn planner_for(draw: &mut Draw, scene: &Scene) -> (String, Vec<Parameter>) {
    let cannot: Vec<&str> = scene.planners_that_cannot().iter().map(|(name, _)| *name).collect();
    let all: Vec<&PlannerInfo> = mp_plan::planners().collect();
    // Rarely one that cannot, to see it refused.
    let refused = draw.chance(0.005);
    let by_inputs = |info: &PlannerInfo| info.parameters.iter().any(|parameter| parameter.name == "inputs");
    let needs_inputs = cannot.contains(&"rrt");
    let able: Vec<&&PlannerInfo> = all
        .iter()
        .filter(|info| refused || (!cannot.contains(&info.name) && by_inputs(info) == needs_inputs))
        .collect();
    let inner = **draw.one(&able);
    let mut name = inner.name.to_owned();
    let is_tree = name != "auto" && !mp_plan::roadmap_planners().iter().any(|info| info.name == name);
    if is_tree && draw.chance(0.25) {
        let fits = |prefix: &str, around: Option<&[&str]>| {
            prefix != "shared-" || around.is_none_or(|names| names.contains(&inner.name))
        };
        let metas: Vec<_> =
            mp_plan::meta_planners().iter().filter(|meta| fits(meta.prefix, meta.around)).collect();
        name = format!("{}{name}", draw.one(&metas).prefix);
        if draw.chance(0.2) {
            // Rounds within rounds would take the square of the time.
            let outer = if name.contains("or-") { "restart-" } else { *draw.one(&["or-", "restart-"]) };
            name = format!("{outer}{name}");
        }
    }
    let parameters = parameters_of(&name);
    (name, parameters)
}

/// The parameters of a planner and of the meta-planners in its name.
fn parameters_of(name: &str) -> Vec<Parameter> {
    let mut parameters = Vec::new();
    let mut rest = name;
    loop {
        if let Some(info) = mp_plan::planners().find(|info| info.is_called(rest)) {
            parameters.extend_from_slice(info.parameters);
            return parameters;
        }
        let outer =
            mp_plan::meta_planners().iter().find_map(|meta| Some((meta, rest.strip_prefix(meta.prefix)?)));
        let Some((meta, inner)) = outer else { return parameters };
        parameters.extend_from_slice(meta.parameters);
        rest = inner;
    }
}

/// A value of a parameter that suits the scene; `None` where none is known.
fn value_for(draw: &mut Draw, scene: &Scene, parameter: &Parameter) -> Option<String> {
    let names: Vec<_> = scene.columns().into_iter().map(|column| column.name).collect();
    let plane = names == ["x", "y"] || names == ["x", "y", "yaw"];
    if parameter.name == "field" && plane {
        return Some((*draw.one(&["paper", "risk", "risk:3"])).to_owned());
    }
    value(draw, parameter)
}

/// A value that the range of a parameter allows, also at its ends; `None` for a range that is not understood.
fn value(draw: &mut Draw, parameter: &Parameter) -> Option<String> {
    let range = parameter.range;
    if range.contains("extent of the space") {
        let part = match draw.below(4) {
            0 => draw.logarithmic(1e-6, 1e-2),
            1 => *draw.one(&[1e-6, 100.0]),
            _ => draw.logarithmic(0.5, 100.0),
        };
        return Some(format!("{part}%"));
    }
    if range.starts_with("a whole number") {
        return Some(whole_number(draw, parameter).to_string());
    }
    if let Some(interval) = interval(range) {
        return Some(within(draw, interval).to_string());
    }
    match range {
        // Of what else it may be, the scene decides.
        _ if parameter.name == "field" => Some(parameter.default.to_owned()),
        "positive and finite" => Some(draw.logarithmic(1e-9, 1e9).to_string()),
        "positive and finite, in steps" => Some(draw.logarithmic(0.1, 100.0).to_string()),
        "in (0, radius], in steps" => Some(draw.logarithmic(1e-3, 2.0).to_string()),
        "0, or a length above" => {
            Some(if draw.chance(0.5) { 0.0 } else { draw.logarithmic(1e-3, 1e3) }.to_string())
        }
        _ => {
            let words: Vec<&str> =
                range.split([',', ' ']).filter(|word| !["", "or", "to"].contains(word)).collect();
            let plain = words.iter().all(|word| word.chars().all(|c| c.is_ascii_alphanumeric() || c == '-'));
            (plain && !words.is_empty()).then(|| (*draw.one(&words)).to_owned())
        }
    }
}

/// A whole number: small, near the default, or at an end of the range that still ends today.
fn whole_number(draw: &mut Draw, parameter: &Parameter) -> u64 {
    let least = if ["1 to", "from 1"].iter().any(|text| parameter.range.contains(text)) { 1 } else { 0 };
    let default: f64 = parameter.default.parse().unwrap_or(1.0);
    let most: u64 = match parameter.name {
        // Products of these are the work of an iteration.
        "runs" => 12,
        "slice" => 64,
        "levels" => 20,
        "inputs" => 40,
        "samples" | "candidates" => 300,
        "bounces" => 100,
        _ => 5000,
    };
    let drawn = match draw.below(4) {
        0 => least,
        1 => most,
        2 => draw.below(4) as u64,
        _ => (default.max(1.0) * draw.logarithmic(0.1, 10.0)) as u64,
    };
    drawn.clamp(least, most)
}

/// An interval: its ends, and whether each belongs to it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Interval {
    low: f64,
    high: f64,
    has_low: bool,
    has_high: bool,
}

/// The interval of a text such as `in [0, 1)`.
fn interval(range: &str) -> Option<Interval> {
    let rest = range.strip_prefix("in ")?;
    let (inside, end) = match rest.find([']', ')']) {
        Some(end) => (rest.get(1..end)?, rest.get(end..=end)?),
        None => return None,
    };
    let (low, high) = inside.split_once(',')?;
    let (low, high) = (low.trim().parse().ok()?, high.trim().parse().ok()?);
    Some(Interval { low, high, has_low: rest.starts_with('['), has_high: end == "]" })
}

/// A number of an interval, often at an end.
fn within(draw: &mut Draw, interval: Interval) -> f64 {
    let Interval { low, high, has_low, has_high } = interval;
    match draw.below(5) {
        0 if has_low => low,
        0 => low + (high - low) * 1e-9,
        1 if has_high => high,
        1 => high - (high - low) * 1e-9,
        2 => low + (high - low) * draw.logarithmic(1e-6, 1.0),
        _ => draw.within(low, high),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_range_of_every_parameter_is_understood() {
        let metas = mp_plan::meta_planners().iter().flat_map(|meta| meta.parameters);
        let mut draw = Draw::new(3, 3);
        for parameter in mp_plan::planners().flat_map(|info| info.parameters).chain(metas) {
            for _ in 0..20 {
                let text = value(&mut draw, parameter);
                assert!(text.is_some(), "{}: {}", parameter.name, parameter.range);
            }
        }
    }

    #[test]
    fn intervals_have_ends_or_not() {
        let found = interval("in [0, 1)").unwrap();
        assert_eq!(found, Interval { low: 0.0, high: 1.0, has_low: true, has_high: false });
        assert_eq!(interval("in (1, 1000]").unwrap().high, 1000.0);
        assert_eq!(interval("a whole number"), None);
    }
}
