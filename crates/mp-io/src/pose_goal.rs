//! Goals that are places of a link: a tool at a pose.

use crate::toml_problem::{PartText, TomlText};
use mp_formats::error::Error;
use mp_formats::text::clipped;
use std::collections::BTreeMap;
use std::ops::Range;

/// What may turn freely where a link is to be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FreeTurns {
    /// Nothing.
    #[default]
    None,
    /// The link about its own x, y or z axis: 0, 1 or 2.
    About(usize),
    /// The link about all axes: its rotation is free.
    All,
}

impl std::str::FromStr for FreeTurns {
    type Err = String;

    /// `none`, `x`, `y`, `z` or `all`.
    fn from_str(word: &str) -> Result<Self, String> {
        match word {
            "none" => Ok(Self::None),
            "x" => Ok(Self::About(0)),
            "y" => Ok(Self::About(1)),
            "z" => Ok(Self::About(2)),
            "all" => Ok(Self::All),
            other => Err(format!("`free` is `{}`", clipped(other))),
        }
    }
}

/// A place that a link is to have.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseEntry {
    /// The link that is to be there.
    pub link: String,
    /// x, y, z, α, β, γ of the link in the world.
    pub pose: [f64; 6],
    /// How far (m) its origin may be from there, to both sides along the axes of the pose.
    pub within: [f64; 3],
    /// What may turn freely.
    pub free: FreeTurns,
}

const EXPECTED: &str = "{ link = \"tool\", pose = [x, y, z, α, β, γ] }, or `position = [x, y, z]`; also `free = \"z\"` and `position_tolerance = 0.01`";

impl PoseEntry {
    /// Reads the table at `span`, which names a link.
    pub(crate) fn read(
        text: &TomlText<'_>,
        mut table: BTreeMap<String, PartText>,
        span: &Range<usize>,
    ) -> Result<Self, Error> {
        let fault = |message: String| Err(text.error(span, message).expected(EXPECTED));
        let Some(PartText::Text(link)) = table.remove("link") else {
            return fault("the goal names no link".to_owned());
        };
        let numbers = |part: Option<PartText>| match part {
            Some(PartText::Exactly(v)) => vec![v],
            Some(PartText::Between(two)) => two.to_vec(),
            Some(PartText::Numbers(all)) => all,
            Some(PartText::Text(_)) | None => Vec::new(),
        };
        let places = ["pose", "position"].map(|name| table.remove(name));
        let (pose, whole) = match places {
            [Some(pose), None] => (numbers(Some(pose)), true),
            [None, Some(position)] => (numbers(Some(position)), false),
            [Some(_), Some(_)] => return fault("the goal has a pose and a position".to_owned()),
            [None, None] => return fault(format!("the goal does not say where {} is to be", clipped(&link))),
        };
        if pose.len() != if whole { 6 } else { 3 } {
            let what = if whole { "pose" } else { "position" };
            return fault(format!("the {what} of the goal has {} numbers", pose.len()));
        }
        text.check("the goal", &pose, span)?;
        let within = table.remove("position_tolerance").map(|part| numbers(Some(part)));
        let within = match within.as_deref() {
            None => [0.0; 3],
            Some(&[v]) => [v; 3],
            Some(&[x, y, z]) => [x, y, z],
            Some(_) => {
                return fault(
                    "the tolerance of the goal is one number, or three along the axes of the pose".to_owned(),
                );
            }
        };
        text.check("the tolerance of the goal", &within, span)?;
        if within.iter().any(|v| *v < 0.0) {
            return fault("the tolerance of the goal is below zero".to_owned());
        }
        let free = match table.remove("free") {
            None if whole => FreeTurns::None,
            None => FreeTurns::All,
            Some(PartText::Text(word)) if whole => match word.parse() {
                Ok(free) => free,
                Err(message) => return fault(message),
            },
            Some(PartText::Text(_)) => return fault("a position leaves all turns free already".to_owned()),
            Some(_) => return fault("`free` is a number".to_owned()),
        };
        if let Some(name) = table.keys().next() {
            return fault(format!("the goal has `{}`, which means nothing for a link", clipped(name)));
        }
        let pose = std::array::from_fn(|i| pose.get(i).copied().unwrap_or(0.0));
        Ok(Self { link, pose, within, free })
    }
}
