//! Certificates: a path, the robot and its obstacles as numbers, and for each part of each edge a clearance that proves it free.
//!
//! docs/formats/certificate.md describes the file, and what a program must do to replay one. `mp-verify-certificate` is such a
//! program; it shares no code with this crate. The proof is that of Schwarzer, Saha and Latombe, *Adaptive dynamic collision
//! checking* (2005): what is farther apart than it can move stays apart.

mod compare;

use crate::path::states;
use crate::{Error, MotionModel, PathRows, Robot};
use mp_cspace::{Curve, Interrupt};
use mp_kinds::at_limits;
use mp_kinds::prove::{Prover, agrees};
use mp_time::Trajectory;
use serde::Serialize;
use xxhash_rust::xxh3::xxh3_128;

pub(crate) use compare::differences;

/// The version of the file; with curves it is the next one.
const VERSION: u32 = 2;

/// The member that ends a certificate: a hash of all bytes before it.
const CHECKSUM: &str = ",\n\"checksum\":";

/// A path with the proof that it is free: see docs/formats/certificate.md.
#[derive(Clone, Debug)]
pub struct Certificate {
    text: String,
    edges: usize,
    intervals: usize,
    clearance: Option<f64>,
}

#[derive(Serialize)]
struct File<'a> {
    certificate: u32,
    scene: &'a str,
    columns: Vec<String>,
    model: &'a MotionModel,
    path: &'a [Vec<f64>],
    #[serde(skip_serializing_if = "Option::is_none")]
    curves: Option<Vec<Vec<[f64; 6]>>>,
    clearance: Option<f64>,
    edges: &'a [Vec<Vec<[f64; 2]>>],
}

impl Certificate {
    /// The file: JSON.
    #[must_use]
    pub fn to_json(&self) -> &str {
        &self.text
    }

    /// How many edges the path has.
    #[must_use]
    pub fn edges(&self) -> usize {
        self.edges
    }

    /// Into how many parts its edges are divided, over all pairs of bodies.
    #[must_use]
    pub fn intervals(&self) -> usize {
        self.intervals
    }

    /// The clearance (m) that it proves all along the path; `None` where there is nothing to hit.
    #[must_use]
    pub fn clearance(&self) -> Option<f64> {
        self.clearance
    }
}

/// The certificate of a path, or of a trajectory through its configurations. `clearance` (m) is a lower bound on the clearance
/// along it, 0 if none is known: the certificate proves
/// half of it, and what the robot keeps at least, or a twentieth of its tolerance where that is more.
///
/// # Errors
/// When the path is of another robot, is not free, turns exactly half way round in one edge, or the kind of robot is your own and
/// has no model; and when `interrupt` says to end.
pub(crate) fn certificate(
    kind: &dyn Robot,
    path: &PathRows,
    trajectory: Option<&Trajectory>,
    clearance: f64,
    interrupt: &Interrupt,
) -> Result<Certificate, Error> {
    let _span = tracing::info_span!("certificate", scene = kind.name()).entered();
    let what = || format!("cannot certify this path in {}", kind.name());
    let states = states(kind, path)?;
    let model = kind.motion_model().map_err(|e| e.context(what()))?;
    let limits = kind.limits();
    for (row, q) in path.rows.iter().zip(&states) {
        // The proof is of where the path has the joint.
        agrees(&model, &at_limits(row, &limits), &kind.poses(q)).map_err(|e| e.context(what()))?;
    }
    let clearance = if clearance.is_finite() { clearance } else { 0.0 };
    // All of what is kept, and half of what is beyond.
    let kept = if clearance > kind.kept() { kind.kept() } else { 0.0 };
    let margin = (0.5 * (clearance + kept)).max(0.05 * kind.tolerance());
    let mut prover = Prover::new(&model, margin, interrupt).map_err(|e| Error::new(e).context(what()))?;
    let number = (path.rows.len() - 1).max(1);
    let curves: Option<Vec<Vec<_>>> = trajectory.map(|trajectory| {
        let piece = |i| (0..path.columns.len()).map(|column| trajectory.polynomial(i, column)).collect();
        (0..number).map(piece).collect()
    });
    // A path of one configuration is an edge from there to itself.
    let ends = path.rows.iter().zip(path.rows.iter().skip(1).chain(path.rows.last()));
    let edges = ends.take(number).enumerate();
    let edges = edges.map(|(i, (from, to))| {
        let fault = |why| Error::new(format!("between configurations {} and {}: {why}", i + 1, i + 2));
        let made = match &curves {
            Some(curves) => prover.curve(from, &curves[i]),
            None => prover.edge(from, to),
        };
        made.map_err(|why| fault(why).help("check the path with `mp check`"))
    });
    let edges: Vec<_> = edges.collect::<Result<_, _>>().map_err(|e| e.context(what()))?;
    let proved = (!model.pairs.is_empty()).then_some(margin);
    let file = File {
        certificate: VERSION + u32::from(curves.is_some()),
        scene: kind.name(),
        columns: columns(kind),
        model: &model,
        path: &path.rows,
        curves,
        clearance: proved,
        edges: &edges,
    };
    let text = serde_json::to_string(&file).map_err(|e| Error::new(e.to_string()).context(what()))?;
    let mut text = text.strip_suffix('}').map_or_else(String::new, str::to_owned);
    text += &format!("{CHECKSUM}\"{:032x}\"}}\n", xxh3_128(text.as_bytes()));
    let intervals = edges.iter().flatten().map(Vec::len).sum();
    tracing::info!(edges = edges.len(), intervals, "certified");
    Ok(Certificate { text, edges: edges.len(), intervals, clearance: proved })
}

/// Name and unit of each number of a row.
fn columns(kind: &dyn Robot) -> Vec<String> {
    kind.columns().iter().map(ToString::to_string).collect()
}
