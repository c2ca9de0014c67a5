//! `auto`, the planner that is taken when none is named: a portfolio of searches that take turns.
//!
//! No planner is best everywhere, and none of them says beforehand how long it will take. So several work by turns, each on a share of the
//! work, until one has a path: C. Gomes and B. Selman, *Algorithm portfolios*, Artificial Intelligence 126, 2001. The first is
//! RRT-Connect as the request says, with balanced trees: the larger one waits, so that work goes to the end that is boxed in. It has a turn
//! that is long enough for what is easy, so that such problems cost nothing more. The others are for what is hard: shorter steps for
//! narrow places, a metric in which turning counts as much as the robot's size says, trees that grow along surfaces, and also on as they
//! came, roadmaps with samples between obstacles.
//!
//! Robots with joints have a portfolio of their own: what is hard for them is mostly an end that is boxed in, not a long passage. Its searches
//! measure by how far joints move the robot, so that the shoulder counts for more than the wrist.
//!
//! A turn is measured in queries and iterations, never in time: the same request gives the same path on every machine. Each search
//! draws from a stream of its own. What a robot cannot do (a metric, hints of obstacles) is left out.
//!
//! ```
//! use mp_plan::{Request, Scene};
//! let (scene, request) = (Scene::find("easy")?, Request::new("auto").seed(2));
//! let report = scene.plan(&request)?;
//! assert_eq!(report.won.as_deref(), Some("rrt-connect balance=1"));
//! let first = Request::new("rrt-connect").seed(2).set("balance", "1");
//! assert_eq!(report.fingerprint, scene.plan(&first)?.fingerprint);
//! # Ok::<(), mp_plan::Error>(())
//! ```

use crate::run::NamedPlanner;
use crate::run::planners::PlannerKind;
use crate::run::prepared::Prepared;
use crate::{Error, MetricName, Request, Robot};
use mp_cspace::registry::{Parameter, PlannerInfo, Settings};
use mp_cspace::{BuildError, Configuration, Event, Observer, Path, Planner, Progress, Rng, Workers};
use mp_tree::Tuning;
use rand::RngExt;
use std::sync::atomic::Ordering;

/// The work of the first turn of the first search.
const TURN: Parameter = Parameter {
    name: "turn",
    range: "a whole number",
    default: "500000",
    doc: "queries and iterations after which the other searches have turns too; of robots with joints by default 50000",
};

/// The balance of the trees of the first search.
const BALANCE: Parameter = Parameter { default: "1", ..mp_tree::BALANCE };

/// The entry of [`planners`](crate::planners).
pub(crate) const INFO: PlannerInfo = PlannerInfo {
    name: "auto",
    summary: "takes turns: RRT-Connect, then also short steps, other metrics, surfaces and roadmaps; the default",
    citation: "Gomes and Selman 2001",
    parameters: &[TURN, mp_tree::STEP, mp_tree::GOAL_BIAS, mp_tree::PATIENCE, BALANCE],
    aliases: &[],
    cannot: mp_tree::NEEDS_BOTH_ENDS,
};

/// A search of the portfolio.
struct MemberInfo {
    planner: &'static str,
    settings: &'static [(&'static str, &'static str)],
    /// `None` for that of the request.
    metric: Option<MetricName>,
    /// The part of the work of a turn that it gets: less where its queries take longer.
    share: f64,
}

/// The first, with the settings of the request.
const FIRST: &str = "rrt-connect";

/// The searches for a kind of robot.
struct Portfolio {
    /// The metric of the first, where the request leaves it open.
    metric: MetricName,
    /// The work of its first turn, where the request leaves it open.
    turn: Option<u64>,
    /// Its share of the turns after that.
    first_share: f64,
    /// The part of the first turn that the others begin with.
    beginners: f64,
    /// The others, in the order of their turns.
    others: &'static [MemberInfo],
}

/// For robots without joints. What the first search has not solved in its first turn is better left to the others, so it gets half a share.
const BODIES: Portfolio = Portfolio {
    metric: MetricName::Default,
    turn: None,
    first_share: 0.5,
    beginners: 0.2,
    others: OTHERS_OF_BODIES,
};

/// For robots with joints. The second search has as much work as the first, from its first turn on: either may be the one that solves it.
const JOINTS: Portfolio = Portfolio {
    metric: MetricName::Scaled,
    turn: Some(50_000),
    first_share: 1.0,
    beginners: 1.0,
    others: OTHERS_OF_JOINTS,
};

/// The searches for this robot.
fn portfolio(kind: &dyn Robot) -> &'static Portfolio {
    if kind.has_joints() { &JOINTS } else { &BODIES }
}

/// The larger tree waits for the smaller one.
const BALANCED: (&str, &str) = (BALANCE.name, BALANCE.default);

/// Half the steps go on as the tree came.
const WALKING: (&str, &str) = ("walks", "0.5");

/// For long and narrow passages.
const OTHERS_OF_BODIES: &[MemberInfo] = &[
    MemberInfo {
        planner: "obrrt-connect",
        settings: &[("step", "1%"), WALKING, BALANCED],
        metric: None,
        share: 1.25,
    },
    MemberInfo {
        planner: "obrrt-connect",
        settings: &[("step", "0.3%"), BALANCED],
        metric: None,
        share: 1.0,
    },
    MemberInfo {
        planner: "obrrt-connect",
        settings: &[("step", "1%"), WALKING, BALANCED],
        metric: Some(MetricName::Scaled),
        share: 1.0,
    },
    MemberInfo { planner: "retraction-rrt", settings: &[], metric: None, share: 0.25 },
    MemberInfo { planner: "bridge-prm", settings: &[], metric: Some(MetricName::Scaled), share: 0.25 },
];

/// For ends that are boxed in; the last one for what is long and narrow.
const OTHERS_OF_JOINTS: &[MemberInfo] = &[
    MemberInfo {
        planner: "obrrt-connect",
        settings: &[BALANCED],
        metric: Some(MetricName::Scaled),
        share: 1.0,
    },
    MemberInfo {
        planner: "obrrt-connect",
        settings: &[("step", "1%"), WALKING, BALANCED],
        metric: None,
        share: 0.2,
    },
];

/// After their first turns the searches are brought to this times the work of the round before, all by turns.
const ROUND: f64 = 1.5;

/// The requests of all searches with their shares of a turn, the first one first.
pub(crate) fn requests(kind: &dyn Robot, request: &Request) -> Vec<(Request, f64)> {
    let Portfolio { metric, first_share, others, .. } = portfolio(kind);
    let mut first = Request { planner: FIRST.to_owned(), ..request.clone() };
    if first.metric == MetricName::Default {
        first.metric = *metric;
    }
    first.settings.remove(TURN.name);
    first.settings.entry(BALANCE.name.to_owned()).or_insert_with(|| BALANCE.default.to_owned());
    let first = (first, *first_share);
    let of = |info: &MemberInfo| Request {
        planner: info.planner.to_owned(),
        settings: info
            .settings
            .iter()
            .map(|(name, value)| ((*name).to_owned(), (*value).to_owned()))
            .collect(),
        metric: info.metric.unwrap_or(request.metric),
        ..request.clone()
    };
    std::iter::once(first).chain(others.iter().map(|info| (of(info), info.share))).collect()
}

/// Refuses settings that the portfolio does not have, and values that cannot be read.
pub(crate) fn check(settings: &Settings) -> Result<(), BuildError> {
    settings.check(&INFO)?;
    settings.count_of(&TURN)?;
    Tuning::read(settings, &INFO).map(drop)
}

/// How a search is called in reports: its planner, with what differs from the request.
fn label(member: &Request, whole: &Request) -> String {
    let mut label = member.planner.clone();
    let own = member.settings.iter().filter(|(name, value)| whole.settings.get(*name) != Some(value));
    for (name, value) in own {
        label += &format!(" {name}={value}");
    }
    if member.metric != whole.metric {
        label += &format!(" metric={}", member.metric);
    }
    label
}

/// The searches of a portfolio, of which one has the turn.
pub(crate) struct Auto<'p> {
    prepared: &'p Prepared<'p>,
    members: Vec<Member<'p>>,
    turn: usize,
    /// Up to which work the present turn goes.
    reach: u64,
    /// The work up to which each search is brought in this round.
    round: f64,
    /// The work of the first turn, and the part of it that the others begin with.
    first_turn: u64,
    beginners: f64,
    won: Option<usize>,
}

/// A search: its planner is made when it has its first turn.
struct Member<'p> {
    prepared: &'p Prepared<'p>,
    share: f64,
    planner: Option<NamedPlanner<'p>>,
    rng: Option<Rng>,
    work: u64,
    progress: Progress,
    /// Whether it cannot go on, or cannot begin.
    ended: bool,
}

impl<'p> Auto<'p> {
    /// The portfolio of a prepared request. The first search is made at once.
    ///
    /// # Errors
    /// When the first search cannot be made.
    pub(crate) fn new(prepared: &'p Prepared<'p>) -> Result<Self, Error> {
        let members = prepared.members.iter().map(|(prepared, share)| Member {
            prepared,
            share: *share,
            planner: None,
            rng: None,
            work: 0,
            progress: Progress::default(),
            ended: false,
        });
        let mut members: Vec<_> = members.collect();
        if let Some(first) = members.first_mut() {
            first.planner = Some(first.made()?);
        }
        let Portfolio { turn, beginners, .. } = *portfolio(prepared.kind);
        let first_turn = match turn {
            Some(turn) if !prepared.request.settings.contains_key(TURN.name) => turn,
            _ => prepared.request.settings().count_of(&TURN)?.max(1),
        };
        let (reach, round) = (first_turn, first_turn as f64);
        Ok(Self { prepared, members, turn: 0, reach, round, first_turn, beginners, won: None })
    }

    /// Which search has found the path.
    pub(crate) fn won(&self) -> Option<String> {
        let won = self.members.get(self.won?)?;
        Some(label(&won.prepared.request, &self.prepared.request))
    }

    /// Gives the turn to the next search that can go on.
    fn next_turn(&mut self) {
        for _ in 0..self.members.len() {
            self.turn += 1;
            if self.turn == self.members.len() {
                self.turn = 0;
                self.round *= ROUND;
            }
            let begins = self.turn > 0 && self.round <= self.first_turn as f64;
            let part = if begins { self.beginners } else { 1.0 };
            self.reach = (part * self.members[self.turn].share * self.round) as u64;
            if !self.members[self.turn].ended {
                return;
            }
        }
    }
}

impl<'p> Member<'p> {
    fn made(&self) -> Result<NamedPlanner<'p>, Error> {
        match PlannerKind::new(&self.prepared.request.planner)? {
            PlannerKind::Tree(spec) => {
                self.prepared.tree_planner(&spec.to_string(), &Workers::single()).map(NamedPlanner::Tree)
            }
            PlannerKind::Roadmap(info) => {
                self.prepared.roadmap_planner(info, Workers::single(), None).map(NamedPlanner::Roadmap)
            }
            PlannerKind::Auto => Err(Error::new("a portfolio has no portfolio inside")),
        }
    }
}

impl Planner<Configuration> for Auto<'_> {
    type Edge = ();

    fn step(
        &mut self,
        rng: &mut Rng,
        observer: &mut dyn Observer<Configuration>,
    ) -> Option<Path<Configuration>> {
        let turn = self.turn;
        let queries = self.prepared.queries();
        let member = &mut self.members[turn];
        if member.planner.is_none() {
            match member.made() {
                Ok(made) => {
                    member.planner = Some(made);
                    // Of the same numbers, which the first search does not miss.
                    member.rng = Some(Rng::stream(rng.clone().random(), turn as u64));
                }
                Err(_) => {
                    member.ended = true;
                    self.next_turn();
                    return None;
                }
            }
        }
        let Some(named) = &mut member.planner else { return None };
        let (before, planner) = (queries.load(Ordering::Relaxed), named.planner());
        // The first draws as it does alone.
        let path = planner.step(member.rng.as_mut().unwrap_or(rng), &mut Numbered { observer, member: turn });
        member.progress = planner.progress();
        member.ended = member.progress.exhausted;
        member.work += 1 + queries.load(Ordering::Relaxed).saturating_sub(before);
        if path.is_some() {
            self.won = Some(turn);
        } else if member.ended || member.work >= self.reach {
            self.next_turn();
        }
        path
    }

    fn progress(&self) -> Progress {
        let mut sum = Progress::default();
        for member in &self.members {
            sum.iterations += member.progress.iterations;
            sum.nodes += member.progress.nodes;
            sum.motions += member.progress.motions;
            sum.rejected += member.progress.rejected;
        }
        sum.exhausted = self.members.iter().all(|member| member.ended);
        sum
    }
}

/// Tells which trees are those of a search: two for each.
struct Numbered<'o> {
    observer: &'o mut dyn Observer<Configuration>,
    member: usize,
}

impl Observer<Configuration> for Numbered<'_> {
    fn on(&mut self, event: Event<'_, Configuration>) {
        let of = |tree: usize| tree + 2 * self.member;
        self.observer.on(match event {
            Event::Rooted { tree, id, state, kind } => Event::Rooted { tree: of(tree), id, state, kind },
            Event::Added { tree, id, parent, state, through } => {
                Event::Added { tree: of(tree), id, parent, state, through }
            }
            Event::Rewired { tree, id, parent, through } => {
                Event::Rewired { tree: of(tree), id, parent, through }
            }
            Event::Trapped { tree } => Event::Trapped { tree: of(tree) },
            Event::Pruned { tree, survivors } => Event::Pruned { tree: of(tree), survivors },
            // Edges of a roadmap name no tree.
            Event::Linked { .. } | Event::Unlinked { .. } => return,
            other => other,
        });
    }
}
