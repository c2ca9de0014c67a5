//! Roadmaps by regions: what they answer beside plain ones of as many nodes, and how evenly their work is
//! spread over ranks.

use crate::error::Result;
use crate::experiment::{Lab, Table};
use crate::options::Common;
use crate::scenes::{Rigid, either, free};
use mp_cspace::Rng;
use mp_plan::{Description, Finish, Interrupt, RegionalWork, Request, Scene, SceneRoadmap};
use mp_ranks::{Policy, simulate};
use serde::{Deserialize, Serialize};

/// Scenes, regions and attempts in each.
const ROADMAPS: [(&str, usize, usize); 6] = [
    ("cubicles", 64, 100),
    ("cubicles", 1_024, 100),
    ("cubicles", 1_024, 1_000),
    ("apartment", 64, 100),
    ("apartment", 1_024, 100),
    ("maze", 64, 50),
];
/// The numbers of ranks that are simulated.
const RANKS: [usize; 3] = [16, 64, 256];
/// What the simulation takes as the seconds of a collision query, of a message on its way, and of the
/// master's work for a message.
const QUERY_S: f64 = 20e-6;
const LATENCY_S: f64 = 20e-6;
const MESSAGE_S: f64 = 10e-6;
/// Paths that each roadmap is asked for.
const ASKED: usize = 100;

/// A case: a roadmap.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
struct Case {
    scene: String,
    regions: usize,
    samples: usize,
    seed: u64,
}

/// A roadmap of a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Built {
    nodes: usize,
    edges: usize,
    components: usize,
    /// How many of the paths it had.
    answered: usize,
}

/// The result of a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Run {
    /// Regions among the items.
    regions: usize,
    /// Collision queries of each item, and what was estimated.
    queries: Vec<u64>,
    estimates: Vec<f64>,
    by_regions: Built,
    /// The planner `prm` without expansion, with as many nodes.
    plain: Built,
}

/// In which order items are handed out.
#[derive(Clone, Copy)]
enum Order {
    AsNumbered,
    ByEstimate,
    ByCost,
}

impl Run {
    fn costs(&self, items: std::ops::Range<usize>) -> Vec<f64> {
        self.queries[items].iter().map(|queries| QUERY_S * *queries as f64).collect()
    }

    /// The largest cost of a region by their mean.
    fn imbalance(&self) -> f64 {
        let costs = self.costs(0..self.regions);
        let mean = costs.iter().sum::<f64>() / costs.len() as f64;
        costs.into_iter().fold(0.0, f64::max) / mean
    }

    /// The part of the time of all ranks in which they work.
    fn efficiency(&self, ranks: usize, order: Order) -> f64 {
        let phases = [0..self.regions, self.regions..self.queries.len()];
        let (mut work, mut makespan) = (0.0, 0.0);
        for items in phases {
            let mut costs = self.costs(items.clone());
            work += costs.iter().sum::<f64>();
            let policy = match order {
                Order::AsNumbered => Policy::InOrder,
                Order::ByCost => Policy::DearestFirst,
                Order::ByEstimate => {
                    let mut order: Vec<(f64, f64)> =
                        self.estimates[items].iter().copied().zip(costs.iter().copied()).collect();
                    order.sort_by(|a, b| b.0.total_cmp(&a.0));
                    costs = order.into_iter().map(|(_, cost)| cost).collect();
                    Policy::InOrder
                }
            };
            makespan += simulate(&costs, policy, ranks, LATENCY_S, MESSAGE_S).makespan_s;
        }
        work / (ranks as f64 * makespan)
    }
}

/// Runs the suite. True when everything was measured.
pub(crate) fn run(common: &Common) -> Result<bool> {
    let lab = Lab::new(common)?;
    let mut log = lab.log("regions", common.time)?;
    let roadmaps = ROADMAPS.into_iter().filter(|(scene, regions, _)| {
        let wanted = common.scenes.is_empty() || common.scenes.iter().any(|name| name == scene);
        wanted && (*regions < 100 || !common.quick)
    });
    let seeds = 1..=u64::from(common.runs_or(1, 2));
    let cases: Vec<Case> = roadmaps
        .flat_map(|(scene, regions, samples)| {
            seeds.clone().map(move |seed| Case { scene: scene.to_owned(), regions, samples, seed })
        })
        .collect();
    if !lab.measure(&mut log, "regions", &cases, measure)? {
        return Ok(false);
    }
    let built = |b: &Built| format!("{} / {} / {}", b.nodes, b.edges, b.components);
    let answers = Table::of(
        log.each(&cases),
        &[
            ("scene", &|(case, _)| case.scene.clone()),
            ("regions", &|(case, _)| case.regions.to_string()),
            ("attempts in each", &|(case, _)| case.samples.to_string()),
            ("seed", &|(case, _)| case.seed.to_string()),
            ("nodes / edges / components", &|(_, run)| built(&run.by_regions)),
            ("of `prm`", &|(_, run)| built(&run.plain)),
            ("answered of 100", &|(_, run)| run.by_regions.answered.to_string()),
            ("by `prm`", &|(_, run)| run.plain.answered.to_string()),
        ],
    );
    let mut balance = Table::of(
        log.each(&cases),
        &[
            ("scene", &|(case, _)| case.scene.clone()),
            ("regions", &|(case, _)| case.regions.to_string()),
            ("attempts in each", &|(case, _)| case.samples.to_string()),
            ("seed", &|(case, _)| case.seed.to_string()),
            ("queries of a region", &|(_, run)| {
                let costs = run.costs(0..run.regions);
                format!("{:.0}", costs.iter().sum::<f64>() / QUERY_S / costs.len() as f64)
            }),
            ("largest : mean", &|(_, run)| format!("{:.2}", run.imbalance())),
            ("queries of pairs", &|(_, run)| {
                let [regions, pairs] = [0..run.regions, run.regions..run.queries.len()]
                    .map(|items| run.queries[items].iter().sum::<u64>() as f64);
                format!("{:.0}%", 100.0 * pairs / (regions + pairs))
            }),
        ],
    );
    for ranks in RANKS {
        balance.head.push(format!("{ranks} ranks"));
        for (row, (_, run)) in balance.rows.iter_mut().zip(log.each(&cases)) {
            let of = |order| format!("{:.2}", run.efficiency(ranks, order));
            row.push([Order::AsNumbered, Order::ByEstimate, Order::ByCost].map(of).join(" / "));
        }
    }
    let text = format!("{}\n\n{}\n", answers.markdown(), balance.markdown());
    lab.report("regions", &text, &answers.made_at(log.commits(&cases)))?;
    Ok(log.each(&cases).count() == cases.len())
}

fn measure(case: &Case) -> Result<Option<Run>> {
    let (scene, rigid) = (Scene::find(&case.scene)?, Rigid::load(&case.scene)?);
    let row = |q| either!(&rigid, scene => scene.row(&q));
    let ends: Vec<_> =
        either!(&rigid, scene => free(scene, Rng::stream(1, 99)).take(ASKED + 1).map(row).collect());
    let request = Request::new("regional-prm").seed(case.seed).finish(Finish::AsFound);
    let request = request.set("regions", case.regions).set("samples", case.samples);
    let (work, never) = (scene.regions(&request)?, Interrupt::never());
    let regions = work.regions() as usize;
    let built = (0..work.regions())
        .map(|region| work.build(region, &never))
        .collect::<std::result::Result<Vec<_>, _>>()?;
    let connect = |item: u64| {
        let [one, other] =
            work.pair(item).unwrap_or_default().map(|region| built[region as usize].as_slice());
        work.connect(item, [one, other], &never)
    };
    let connected =
        (work.regions()..work.items()).map(connect).collect::<std::result::Result<Vec<_>, _>>()?;
    let queries = built.iter().chain(&connected).map(|result| RegionalWork::tally(result).queries).collect();
    let estimates = (0..work.items()).map(|item| match work.pair(item) {
        None => work.estimate(item, &never),
        Some(pair) => Ok(RegionalWork::estimate_pair(pair.map(|region| built[region as usize].as_slice()))),
    });
    let estimates = estimates.collect::<std::result::Result<_, _>>()?;
    let by_regions = asked(work.finish(&built, &connected)?, &ends)?;
    let mut plain =
        Request::new("prm").seed(case.seed).set("expand", 0).nodes(by_regions.nodes).finish(Finish::AsFound);
    plain.budget.time_s = None;
    let plain = asked(scene.roadmap(&plain)?, &ends)?;
    Ok(Some(Run { regions, queries, estimates, by_regions, plain }))
}

/// The roadmap, asked for the path from each configuration to the next.
fn asked(mut roadmap: SceneRoadmap, ends: &[Vec<f64>]) -> Result<Built> {
    let mut answered = 0;
    for pair in ends.windows(2) {
        answered += usize::from(roadmap.query(&pair[0], &pair[1])?.solved);
    }
    Ok(Built { nodes: roadmap.nodes(), edges: roadmap.edges(), components: roadmap.components(), answered })
}
