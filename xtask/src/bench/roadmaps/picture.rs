//! Roadmaps over their scenes, seen from above, as SVG: guards black, connections white.

use super::queries::{Local, steer};
use crate::output::{note, write};
use crate::plan::Ready;
use crate::plan::mover::Mover;
use crate::plan::setting::Setting;
use crate::scenes;
use miette::{IntoDiagnostic, Result};
use mp::cspace::{DefaultNn, Iterations, Nodes, Rng, Stop};
use mp::roadmap::algo::{prm, visibility_prm};
use mp::roadmap::{Builder, Connector, Kind, Learning, LinkState, NodeGenerator, Reachable, Roadmap};
use nalgebra::Point3;
use petgraph::visit::EdgeRef;
use std::fmt::Write;
use std::path::Path;

const SCENES: [&str; 3] = ["maze", "planar-bugtrap", "gempa-3"];
/// Nodes of PRM's.
const NODES: usize = 400;
/// The longer side, pixels.
const SIDE: f64 = 900.0;

/// Draws PRM's and Visib-PRM's roadmaps into `folder`.
pub(super) fn draw(folder: &Path) -> Result<()> {
    for name in SCENES {
        match Ready::load(&scenes::find(Path::new(name))?)? {
            Ready::Space(setting) => both(&setting, folder)?,
            Ready::Plane(setting) => both(&setting, folder)?,
        }
    }
    Ok(())
}

fn both<M: Mover>(setting: &Setting<M>, folder: &Path) -> Result<()> {
    let (space, name) = (&setting.space, &setting.problem.name);
    let reach = Reachable { neighbours: 15, radius: f64::INFINITY, cycles: false };
    let learning = Learning { learn: NODES * 2 / 3, ..Learning::default() };
    let recipe = prm::recipe(space, reach, learning).into_diagnostic()?;
    let map = built(setting, recipe.generate, recipe.connect, Nodes(NODES))?;
    one(setting, &map, &folder.join(format!("roadmap-{name}-prm.svg")))?;
    let recipe = visibility_prm::recipe(space, 1_000).into_diagnostic()?;
    let map = built(setting, recipe.generate, recipe.connect, Iterations(1_000_000))?;
    one(setting, &map, &folder.join(format!("roadmap-{name}-visibility-prm.svg")))
}

fn built<'c, M: Mover, G, K>(
    setting: &'c Setting<M>,
    generate: G,
    connect: K,
    mut stop: impl Stop,
) -> Result<Roadmap<M::State>>
where
    G: NodeGenerator<M::Space, Local<'c, M>>,
    K: Connector<M::Space, Local<'c, M>>,
{
    let index = <M::Space as DefaultNn>::Nn::default();
    let mut builder = Builder::new(steer(setting, setting.verifier()?)?, generate, connect, index);
    builder.build(&mut Rng::seed(1), &mut stop, &mut ());
    Ok(builder.into_map())
}

fn one<M: Mover>(setting: &Setting<M>, map: &Roadmap<M::State>, file: &Path) -> Result<()> {
    let bounds = setting.problem.position_bounds();
    let size = bounds.max - bounds.min;
    let scale = SIDE / size.x.max(size.y);
    let at = |p: &Point3<f64>| [(p.x - bounds.min.x) * scale, (bounds.max.y - p.y) * scale];
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {:.0}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n<path fill=\"#b4bdc9\" fill-opacity=\"0.6\" d=\"",
        size.x * scale,
        size.y * scale
    );
    for obstacle in &setting.problem.obstacles {
        for i in 0..obstacle.mesh.triangles().len() {
            let corners = obstacle.mesh.triangle(i).map(|p| at(&(obstacle.pose * p)));
            let [a, b, c] = corners;
            // All one way round, so that triangles above each other do not cancel.
            let turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            let [b, c] = if turn > 0.0 { [b, c] } else { [c, b] };
            let _ = write!(text, "M{:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}Z", a[0], a[1], b[0], b[1], c[0], c[1]);
        }
    }
    text.push_str("\"/>\n<g stroke=\"#5b7fa8\" stroke-width=\"0.8\">\n");
    let place = |q: &M::State| at(&Point3::from(M::pose(q).translation.vector));
    for edge in map.graph().edge_references().filter(|edge| edge.weight().state != LinkState::Blocked) {
        let [a, b] = [edge.source(), edge.target()].map(|end| place(&map.states()[end.index()]));
        let _ = writeln!(
            text,
            "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\"/>",
            a[0], a[1], b[0], b[1]
        );
    }
    text.push_str("</g>\n<g stroke=\"#000\" stroke-width=\"1\">\n");
    for (q, tag) in map.states().iter().zip(map.graph().node_weights()) {
        let (radius, fill) = match tag.kind {
            Kind::Guard => (6.0, "#000"),
            Kind::Connection => (5.0, "#fff"),
            Kind::Expanded => (3.0, "#e6892d"),
            _ => (3.0, "#2c6fb0"),
        };
        let [x, y] = place(q);
        let _ = writeln!(text, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{fill}\"/>");
    }
    text.push_str("</g>\n</svg>\n");
    write(file, text.as_bytes())?;
    note(&format!("drawn: {}", file.display()));
    Ok(())
}
