//! One problem: its world, its request, what the program answers, and what the oracle says of it.

use crate::draw::Draw;
use crate::oracle::{Fault, Judged, rows_of};
use crate::request::request;
use crate::worlds::{Kind, World};
use mp_io::InMemory;
use mp_plan::{
    Finish, Interrupt, MetricName, PathFileKind, PathRows, RelaxField, Report, Request, Scene, StoppedBy,
};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// The path of a problem is also damaged, and judged again, with this probability.
const DAMAGED: f64 = 0.15;

/// Which problems are wanted.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Wanted {
    /// Only worlds of this kind.
    pub kind: Option<String>,
    /// Only this planner.
    pub planner: Option<String>,
}

/// How a problem ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// A path was returned.
    Solved,
    /// No path within the budget.
    Unsolved,
    /// Start or goal is not free.
    EndRefused,
    /// Nothing was planned.
    Refused,
}

/// A finding: what is wrong with the program, or with the oracle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// What sort of finding it is: a word or two, for the tally.
    pub sort: &'static str,
    /// What is wrong.
    pub what: String,
}

/// What became of one problem.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The kind of its world.
    pub kind: &'static str,
    /// The name of its planner; empty if the scene could not be loaded.
    pub planner: String,
    /// How it ended.
    pub outcome: Outcome,
    /// What the oracle said of the path.
    pub judged: Option<Judged>,
    /// Damaged paths that the oracle refused, and that the verifier was asked to refuse too.
    pub damaged: u64,
    /// Whether a certificate of the path was made, and replayed by the program that shares no code with what made it.
    pub certified: bool,
    /// Requests that were refused before one suited the robot.
    pub refused_requests: u64,
    /// Whether the clock ended the run, which it should not.
    pub out_of_time: bool,
    /// The request that was answered; `None` if none was.
    pub request: Option<Request>,
    /// What is wrong, by the oracle or by a panic; empty after most trials.
    pub findings: Vec<Finding>,
    /// The message with which the program refused.
    pub refusal: Option<String>,
    /// The text of the path.
    pub path: Option<String>,
}

/// A problem as it is drawn.
#[derive(Debug)]
pub struct Problem {
    /// The kind of its world.
    pub kind: &'static Kind,
    /// The files of the scene, and what the oracle knows of it.
    pub world: World,
    /// What follows in its stream of random numbers.
    rest: Draw,
}

impl Problem {
    /// The problem that `seed` and `number` draw; of the kind that `wanted` names, if it names one.
    #[must_use]
    pub fn new(seed: u64, number: u64, wanted: &Wanted) -> Self {
        let mut draw = Draw::new(seed, number);
        let drawn = Kind::drawn(&mut draw);
        let kind = wanted.kind.as_deref().and_then(Kind::named).unwrap_or(drawn);
        let world = kind.make(&mut draw);
        Self { kind, world, rest: draw }
    }

    /// Its scene, read from its files in memory.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn scene(&self) -> Result<Scene, mp_plan::Error> {
        let files = &self.world.files;
        let found = |name: &str| files.get(&plain(name)).cloned();
        Scene::load_from(&InMemory(found), Path::new(&self.world.main))
    }

    /// A planner, settings and budgets for this scene, drawn after the world.
    #[must_use]
    pub fn request(&self, scene: &Scene, wanted: &Wanted) -> Request {
        request(&mut self.rest.clone(), scene, wanted.planner.as_deref())
    }

    /// Plans, and judges the answer. A panic is a finding.
    #[must_use]
    pub fn run(&self, wanted: &Wanted) -> Trial {
        catch_unwind(AssertUnwindSafe(|| self.try_run(wanted))).unwrap_or_else(|panic| {
            let text = panic.downcast_ref::<String>().cloned();
            let text = text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
            let mut trial = self.unfinished();
            trial.find("panic", text.unwrap_or_default());
            trial
        })
    }

    fn unfinished(&self) -> Trial {
        Trial {
            kind: self.kind.name,
            planner: String::new(),
            outcome: Outcome::Refused,
            judged: None,
            damaged: 0,
            certified: false,
            refused_requests: 0,
            out_of_time: false,
            request: None,
            findings: Vec::new(),
            refusal: None,
            path: None,
        }
    }

    fn try_run(&self, wanted: &Wanted) -> Trial {
        let mut trial = self.unfinished();
        let scene = match self.scene() {
            Ok(scene) => scene,
            Err(error) => {
                trial.find("scene refused", error.report());
                return trial;
            }
        };
        let mut request = self.request(&scene, wanted);
        trial.planner.clone_from(&request.planner);
        if let Err(error) = scene.check_ends() {
            trial.outcome = Outcome::EndRefused;
            self.judge_refusal(&error, &mut trial);
            return trial;
        }
        request.clearance = self.clearance();
        let mut answer = scene.plan(&request);
        for simpler in [Simpler::Plain, Simpler::Unset, Simpler::Default] {
            let Err(error) = &answer else { break };
            if wanted.planner.is_some() && matches!(simpler, Simpler::Default) {
                break;
            }
            trial.refusal = Some(error.report());
            trial.refused_requests += 1;
            request = simpler.of(request, &scene);
            trial.planner.clone_from(&request.planner);
            answer = scene.plan(&request);
        }
        let report = match answer {
            Ok(report) => report,
            // The planner that was asked for does not suit the robot.
            Err(_) if wanted.planner.is_some() => return trial,
            Err(error) => {
                trial.find("request refused", error.report());
                return trial;
            }
        };
        trial.request = Some(request.clone());
        let mut rest = self.rest.clone();
        (0..1000).for_each(|_| {
            rest.bits();
        });
        let threads = if request.threads == 1 { rest.count(2, 4) } else { 1 };
        self.plan_again(&scene, &request, threads, &report, &mut trial);
        trial.out_of_time = report.stages.iter().any(|stage| stage.ended_by == Some(StoppedBy::Time));
        trial.outcome = Outcome::Unsolved;
        if let Some(rows) = &report.path {
            trial.outcome = Outcome::Solved;
            let path =
                PathRows { format: scene.path_format(), columns: report.columns.clone(), rows: rows.clone() };
            let scene = scene.keeping(request.clearance).unwrap_or(scene);
            self.judge_path(&scene, &path, &mut rest, &mut trial);
            Self::certify(&scene, &path, report.clearance.unwrap_or(0.0), &mut trial);
        }
        trial
    }

    /// The certificate of a path can be made and replayed, and is about this path in this scene.
    fn certify(scene: &Scene, path: &PathRows, clearance: f64, trial: &mut Trial) {
        let certificate = match scene.certificate(path, clearance, &Interrupt::never()) {
            Ok(certificate) => certificate,
            Err(error) => {
                trial.find("no certificate", error.report());
                return;
            }
        };
        let text = certificate.to_json();
        let replayed = mp_verify_certificate::verify(text)
            .and_then(|_| mp_verify_certificate::is_of_path(text, &path.to_text()));
        if let Err(why) = replayed {
            trial.find("certificate refused", why);
            return;
        }
        match scene.certificate_differences(text) {
            Ok(differences) if differences.is_empty() => trial.certified = true,
            Ok(differences) => trial.find("certificate of another scene", differences.join("; ")),
            Err(error) => trial.find("certificate of another scene", error.report()),
        }
    }

    /// A clearance (m) to keep, in one problem of five: less than start and goals have.
    fn clearance(&self) -> f64 {
        let (mut draw, case) = (self.rest.clone(), &self.world.case);
        (0..2000).for_each(|_| {
            draw.bits();
        });
        let examples = case.goals.iter().map(|goal| case.example(goal));
        let ends = std::iter::once(Some(case.start.clone())).chain(examples);
        let clearance =
            |row: Option<Vec<f64>>| row.and_then(|row| case.clearance_at(&row).ok()).unwrap_or(0.0);
        let least = ends.map(clearance).fold(f64::INFINITY, f64::min);
        if draw.chance(0.2) && least.is_finite() { draw.within(0.1, 0.9) * least } else { 0.0 }
    }

    /// An end was refused: the oracle must agree that one is not free.
    fn judge_refusal(&self, error: &mp_plan::Error, trial: &mut Trial) {
        let case = &self.world.case;
        let mut ends = vec![("the start", Some(case.start.clone()))];
        for goal in &case.goals {
            ends.push(("a goal", case.example(goal)));
        }
        let clear =
            |row: &Vec<f64>| case.clearance_at(row).is_ok_and(|clearance| clearance > self.world.margin);
        if ends.iter().all(|(_, row)| row.as_ref().is_some_and(clear)) {
            trial.find("free end refused", error.report());
        }
        trial.refusal = Some(error.report());
    }

    /// The same request on another number of `threads` must give the same report.
    fn plan_again(
        &self,
        scene: &Scene,
        request: &Request,
        threads: usize,
        first: &Report,
        trial: &mut Trial,
    ) {
        let again = scene.plan(&request.clone().threads(threads));
        // Where the clock has ended one of them, as it does on a busy machine, they need not be the same.
        let by_clock = |report: &Report| {
            matches!(report.stopped_by, Some(StoppedBy::Time | StoppedBy::Unverified))
                || report.stages.iter().any(|stage| stage.ended_by == Some(StoppedBy::Time))
        };
        if by_clock(first) || again.as_ref().is_ok_and(by_clock) {
            return;
        }
        let same = again.as_ref().is_ok_and(|again| {
            let told = |report: &Report| {
                (
                    report.fingerprint.clone(),
                    report.path.clone(),
                    (report.iterations, report.nodes, report.edges),
                    (report.motion_checks, report.collision_checks, report.stopped_by),
                )
            };
            told(again) == told(first)
        });
        if !same {
            trial.find("threads differ", format!("on {threads} threads the result is another one"));
        }
    }

    fn judge_path(&self, scene: &Scene, path: &PathRows, rest: &mut Draw, trial: &mut Trial) {
        let text = path.to_text();
        let case = &self.world.case;
        let rows = match rows_of(&text) {
            Ok(rows) => rows,
            Err(what) => {
                trial.find("path unreadable", what);
                return;
            }
        };
        let kept = scene.clearance_kept();
        let judged = case.judge_keeping(&rows, kept);
        if let Some(fault) = &judged.fault {
            let sort = match fault {
                Fault::Contact { .. } => "path collides",
                Fault::Ends(_) | Fault::Invalid(_) => "path invalid",
            };
            trial.find(sort, fault.to_string());
        }
        let sound = judged.fault.is_none();
        trial.judged = Some(judged);
        if rest.chance(DAMAGED) && sound {
            self.judge_damaged(scene, path, &rows, rest, trial);
        }
        trial.path = Some(text);
    }

    /// Moves a configuration of a good path. Where the oracle refuses that, the verifier must refuse it too;
    /// and the verifier must accept the path as it was.
    fn judge_damaged(
        &self,
        scene: &Scene,
        path: &PathRows,
        rows: &[Vec<f64>],
        rest: &mut Draw,
        trial: &mut Trial,
    ) {
        let case = &self.world.case;
        let verified = |rows: &[Vec<f64>]| {
            let text = PathRows { rows: rows.to_vec(), ..path.clone() }.to_text();
            let read = scene.parse_path("the path", text.as_bytes(), PathFileKind::Text);
            read.and_then(|read| scene.check(&read))
        };
        match verified(rows) {
            Ok(verdict) if verdict.free => {}
            Ok(verdict) => trial.find("own path refused", verdict.faults.join("; ")),
            Err(error) => trial.find("own path refused", error.report()),
        }
        for _ in 0..3 {
            let mut damaged = rows.to_vec();
            damage(&mut damaged, case.extent, rest);
            let read: Vec<Vec<f64>> = damaged.iter().map(|row| case.at_limits(row)).collect();
            let judged = case.judge_keeping(&read, scene.clearance_kept());
            // The verifier is asked about ends a little off too; it allows more.
            let Some(fault @ (Fault::Contact { .. } | Fault::Invalid(_))) = &judged.fault else { continue };
            trial.damaged += 1;
            if let Ok(verdict) = verified(&damaged)
                && verdict.free
            {
                trial.find("damage accepted", fault.to_string());
                trial.path = Some(PathRows { rows: damaged, ..path.clone() }.to_text());
            }
        }
    }
}

/// Puts a row between two others, out of the way, or moves a row.
pub fn damage(rows: &mut Vec<Vec<f64>>, extent: f64, draw: &mut Draw) {
    let mut at = draw.below(rows.len());
    if rows.len() > 1 && draw.chance(0.7) {
        at = at.max(1);
        let middle = rows[at - 1].iter().zip(&rows[at]).map(|(a, b)| 0.5 * (a + b)).collect();
        rows.insert(at, middle);
    }
    let by = extent * draw.logarithmic(3e-3, 0.5);
    for (i, x) in rows[at].iter_mut().enumerate() {
        if i < 2 || draw.chance(0.3) {
            *x += by * draw.within(-1.0, 1.0);
        }
    }
}

/// What is left out of a request that does not suit the robot.
#[derive(Clone, Copy, Debug)]
enum Simpler {
    /// Metric and finish.
    Plain,
    /// The settings too.
    Unset,
    /// The planner too.
    Default,
}

impl Simpler {
    fn of(self, mut request: Request, scene: &Scene) -> Request {
        request.metric = MetricName::Default;
        request.field = RelaxField::Clearance;
        if request.finish == Finish::Relax {
            request.finish = Finish::Shorten;
        }
        if !matches!(self, Self::Plain) {
            request.settings.clear();
        }
        if matches!(self, Self::Default) {
            scene.default_planner().clone_into(&mut request.planner);
        }
        request
    }
}

impl Trial {
    fn find(&mut self, sort: &'static str, what: String) {
        self.findings.push(Finding { sort, what });
    }
}

/// A name without `.` and `..`.
fn plain(name: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in name.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}
