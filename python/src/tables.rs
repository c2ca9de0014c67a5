//! The tables of planners, metrics and shipped scenes, as `mp-plan` has them.

use crate::scene::json;
use mp_plan::Parameter;
use pyo3::prelude::*;

/// A parameter: name, values allowed, default, what it does.
type ParameterRow = (&'static str, &'static str, &'static str, &'static str);

fn parameters(of: &'static [Parameter]) -> Vec<ParameterRow> {
    of.iter().map(|p| (p.name, p.range, p.default, p.doc)).collect()
}

/// A planner: name, summary, citation, parameters, other names, whether it builds a roadmap.
type PlannerRow = (&'static str, &'static str, &'static str, Vec<ParameterRow>, Vec<&'static str>, bool);

/// All planners by name.
#[pyfunction]
pub(crate) fn planners() -> Vec<PlannerRow> {
    let roadmaps = mp_plan::roadmap_planners();
    let builds_roadmap = |name: &str| roadmaps.iter().any(|info| info.name == name);
    mp_plan::planners()
        .map(|p| {
            let (parameters, aliases) = (parameters(p.parameters), p.aliases.to_vec());
            (p.name, p.summary, p.citation, parameters, aliases, builds_roadmap(p.name))
        })
        .collect()
}

/// The meta-planners: prefix, summary, citation, parameters.
#[pyfunction]
pub(crate) fn meta_planners() -> Vec<(&'static str, &'static str, &'static str, Vec<ParameterRow>)> {
    mp_plan::meta_planners()
        .iter()
        .map(|p| (p.prefix, p.summary, p.citation, parameters(p.parameters)))
        .collect()
}

/// The metrics: name and formula.
#[pyfunction]
pub(crate) fn metrics() -> Vec<(&'static str, &'static str)> {
    mp_plan::MetricName::ALL.iter().map(|(_, name, formula)| (*name, *formula)).collect()
}

/// The names of the shipped scenes.
#[pyfunction]
pub(crate) fn shipped() -> Vec<&'static str> {
    mp_plan::Scene::shipped()
}

/// The request without any option, as JSON.
#[pyfunction]
pub(crate) fn default_request() -> PyResult<String> {
    json(&mp_plan::Request::default())
}
