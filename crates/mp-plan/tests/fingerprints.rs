//! Every planner by name on every shipped scene comes to the same, bit for bit, as when `fingerprints.txt` was made, on
//! every machine. `cargo xtask golden` runs this program on other processors.
//!
//! A line is a case and what came of it: scene, planner, seed, iterations, options of the command line; then how it
//! ended, its counters, the bits of lengths and clearance, and hashes: of the numbers of the path, and where the options ask
//! for them, of the roadmap and of the bytes of pictures. A deliberate change of behaviour is a change of the table, with
//! its reason in the commit:
//!
//! ```text
//! cargo test --release -p mp-plan --test fingerprints
//! MP_WRITE_FINGERPRINTS=1 cargo test --release -p mp-plan --test fingerprints   # writes it anew
//! MP_FINGERPRINTS=short cargo test -p mp-plan --test fingerprints               # each planner once in a scene for each kind of robot
//! MP_FINGERPRINTS=shortest cargo test -p mp-plan --test fingerprints            # each planner, scene and option once
//! ```

use mp_plan::{Cancel, Control, Finish, GrownRoadmap, Report, Request, Scene, Watch, in_parallel};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const TABLE: &str = include_str!("fingerprints.txt");

/// A line of the table.
#[derive(Clone, Copy)]
struct Case {
    line: &'static str,
    /// Scene, planner, seed, iterations, options.
    words: &'static str,
    scene: &'static str,
    planner: &'static str,
}

impl Case {
    fn all() -> Vec<Self> {
        let case = |line: &'static str| {
            let words = line.split_once(" = ").unwrap().0;
            let mut parts = words.split(' ');
            Self { line, words, scene: parts.next().unwrap(), planner: parts.next().unwrap() }
        };
        TABLE.lines().map(case).collect()
    }

    fn has(&self, option: &str) -> bool {
        self.words.split(' ').any(|word| word == option)
    }

    /// Without a path first, then by the work that it takes.
    fn cost(&self) -> (bool, u64) {
        let mut words = self.line.split(' ');
        let mut number = |name: &str| -> u64 {
            words.by_ref().find(|word| *word == name).and_then(|_| words.next()?.parse().ok()).unwrap_or(0)
        };
        let work = number("iterations") + number("motions") + number("queries");
        (self.line.ends_with("path -") || self.line.ends_with("= error"), work)
    }
}

/// The scenes of the short lists: one for each kind of robot, soon loaded.
const SMALL: [&str; 8] =
    ["arm", "crossing", "easy", "planar-bugtrap", "rrs-low", "unicycle", "warehouse", "wrench"];

/// The least costly case of each group.
fn cheapest<K: Ord>(cases: &[Case], group: impl Fn(&Case) -> K) -> BTreeSet<&'static str> {
    let mut best: BTreeMap<K, Case> = BTreeMap::new();
    for case in cases {
        let found = best.entry(group(case)).or_insert(*case);
        if case.cost() < found.cost() {
            *found = *case;
        }
    }
    best.into_values().map(|case| case.words).collect()
}

/// The cases to run: all of them, or a short list where `MP_FINGERPRINTS` says so.
fn chosen() -> Vec<Case> {
    let mut cases = Case::all();
    cases.retain(|case| cfg!(feature = "pictures") || !case.has("--picture"));
    let list = std::env::var("MP_FINGERPRINTS").ok();
    let Some(list) = list.as_deref() else { return cases };
    cases.retain(|case| SMALL.contains(&case.scene));
    let extras = |case: &Case| [case.has("--roadmap"), case.has("--picture")];
    let short = match list {
        "short" => cheapest(&cases, |case| (case.scene, case.planner, extras(case))),
        "shortest" => {
            let mut short = cheapest(&cases, |case| case.planner);
            short.extend(cheapest(&cases, |case| case.scene));
            short.extend(cheapest(&cases, extras));
            short
        }
        other => panic!("MP_FINGERPRINTS is short or shortest, not {other}"),
    };
    cases.retain(|case| short.contains(case.words));
    cases
}

/// The request of a case: planner, seed, iterations, options.
fn request(words: &[&str]) -> Request {
    let mut request =
        Request::new(words[0]).seed(words[1].parse().unwrap()).iterations(words[2].parse().unwrap());
    (request.budget.time_s, request.sharp_clearance) = (None, true);
    let mut options = words[3..].iter();
    while let Some(option) = options.next() {
        let mut value = || *options.next().unwrap();
        match *option {
            "--metric" => request.metric = value().parse().unwrap(),
            "--motion" => request.motion = value().parse().unwrap(),
            "--step" => request = request.set("step", value()),
            "--relax" => request.finish = Finish::Relax,
            "--no-shorten" => request.finish = Finish::AsFound,
            "--roadmap" | "--picture" => {}
            other => panic!("{other}"),
        }
    }
    request
}

/// What came of a case.
fn line(case: &str, report: &Report) -> String {
    let bits = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{:016x}", v.to_bits()));
    let ended = report.stopped_by.map_or("solved", |by| by.word());
    format!(
        "{case} = {ended} iterations {} nodes {} edges {} motions {} queries {} rejected {} found {} length {} clearance {} path {}",
        report.iterations,
        report.nodes,
        report.edges.map_or_else(|| "-".to_owned(), |n| n.to_string()),
        report.motion_checks,
        report.collision_checks,
        report.rejected,
        bits(report.path_length_found),
        bits(report.path_length),
        bits(report.clearance),
        report.fingerprint.as_deref().unwrap_or("-"),
    )
}

/// Keeps the roadmap.
#[derive(Default)]
struct Kept(Option<GrownRoadmap>);

impl Watch for Kept {
    fn wants_roadmap(&self) -> bool {
        true
    }
    fn roadmap(&mut self, roadmap: GrownRoadmap) {
        self.0 = Some(roadmap);
    }
}

fn hash(bytes: &[u8]) -> String {
    format!("{:016x}", xxhash_rust::xxh3::xxh3_64(bytes))
}

/// A hash of all nodes and edges.
fn hash_of_roadmap(roadmap: &GrownRoadmap) -> String {
    let mut bytes = Vec::new();
    for ((row, kind), component) in roadmap.rows.iter().zip(&roadmap.kinds).zip(&roadmap.components) {
        row.iter().for_each(|v| bytes.extend(v.to_bits().to_le_bytes()));
        bytes.extend(kind.as_bytes());
        bytes.extend(component.to_le_bytes());
    }
    roadmap.edges.iter().flatten().for_each(|end| bytes.extend((*end as u64).to_le_bytes()));
    hash(&bytes)
}

/// Hashes of the pictures that the scene can be drawn as, with the path if there is one.
#[cfg(feature = "pictures")]
fn hashes_of_pictures(scene: &Scene, report: &Report) -> String {
    use mp_plan::{Look, PathRows, PictureKind};
    let rows = report.path.clone();
    let path = rows.map(|rows| PathRows { format: scene.path_format(), columns: scene.columns(), rows });
    let look = Look { size: (320, 240), ..Look::default() };
    let kinds =
        if scene.is_planar_world() { &[PictureKind::Svg, PictureKind::Png][..] } else { &[PictureKind::Png] };
    let of = |kind: &PictureKind| hash(&scene.picture(path.as_ref(), "caption", *kind, &look).unwrap());
    kinds.iter().map(of).collect::<Vec<_>>().join(" ")
}

fn run(case: &Case, scene: &Scene) -> String {
    let words: Vec<&str> = case.words.split(' ').skip(1).collect();
    let mut kept = Kept::default();
    let watch: &mut dyn Watch = if case.has("--roadmap") { &mut kept } else { &mut () };
    let Ok(report) = scene.plan_with(&request(&words), &mut Control::new(Cancel::new(), watch)) else {
        return format!("{} = error", case.words);
    };
    let mut line = line(case.words, &report);
    if case.has("--roadmap") {
        line += &format!(" roadmap {}", hash_of_roadmap(&kept.0.unwrap()));
    }
    #[cfg(feature = "pictures")]
    if case.has("--picture") {
        line += &format!(" picture {}", hashes_of_pictures(scene, &report));
    }
    line
}

#[test]
fn all_is_as_it_was_on_every_machine() {
    let cases = chosen();
    let names: BTreeSet<&str> = cases.iter().map(|case| case.scene).collect();
    let scenes: BTreeMap<&str, Scene> =
        names.into_iter().map(|name| (name, Scene::find(name).unwrap())).collect();
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let lines: Vec<String> =
        in_parallel(cases.len(), threads, &Cancel::new(), |i| run(&cases[i], &scenes[cases[i].scene]))
            .into_iter()
            .flatten()
            .collect();
    if std::env::var_os("MP_WRITE_FINGERPRINTS").is_some() {
        assert_eq!(cases.len(), TABLE.lines().count(), "the table is written as a whole only");
        let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fingerprints.txt");
        return std::fs::write(table, lines.join("\n") + "\n").unwrap();
    }
    let differ = cases.iter().zip(&lines).filter(|(case, found)| case.line != *found);
    let wrong: Vec<String> = differ.map(|(case, is)| format!("was {}\nis  {is}", case.line)).collect();
    assert!(wrong.is_empty(), "{} of {} differ:\n{}", wrong.len(), lines.len(), wrong.join("\n"));
    #[allow(clippy::print_stdout)] // How many, for `cargo xtask golden`.
    {
        println!("{} of {} cases are as they were", lines.len(), TABLE.lines().count());
    }
}

/// Of each kind of robot there are all planners, a roadmap and a picture.
#[test]
#[cfg(feature = "roadmaps")]
fn the_table_is_complete() {
    let cases = Case::all();
    for scene in mp_scenes::without_solution() {
        for planner in mp_plan::planners() {
            let case = format!("{scene} {} 1 ", planner.name);
            assert!(TABLE.lines().any(|line| line.starts_with(&case)), "{case}is not in the table");
        }
    }
    let kinds = SMALL.map(|name| Scene::find(name).unwrap().kind().unwrap());
    let all = ["arms", "discs", "driven", "driven-moving", "floating", "moving", "plane", "space"];
    assert_eq!(BTreeSet::from(kinds), BTreeSet::from(all));
    for (scene, kind) in SMALL.into_iter().zip(kinds) {
        let has = |option: &str| cases.iter().any(|case| case.scene == scene && case.has(option));
        // Motions that cannot be reversed have no roadmaps.
        let one_way = ["driven", "driven-moving", "moving"].contains(&kind);
        assert!(has("--picture") && (has("--roadmap") || one_way), "{scene}");
    }
}
