//! Runs on several ranks, here threads: what they write is what one process writes, after any end.

use crate::{Dir, LIST, SCENE, STICK, WALL, whole};
use mp_batch::{ListedProblems, ManyOptions, ManyOutcome, ProblemList, RanksOutcome, Shard, scene_on_ranks};
use mp_plan::{Cancel, Error, Interrupt, Request, Scene};
use mp_ranks::{Link, threads};

/// A run on so many ranks. The one that is `told` ends when so many items are done.
struct Job<'d> {
    dir: &'d Dir,
    out: &'d str,
    options: ManyOptions,
    told: Option<(usize, u64)>,
}

impl<'d> Job<'d> {
    fn new(dir: &'d Dir, out: &'d str) -> Self {
        Self { dir, out, options: whole(), told: None }
    }

    fn told(self, rank: usize, after: u64) -> Self {
        Self { told: Some((rank, after)), ..self }
    }

    fn load(&self) -> Result<ListedProblems, Error> {
        ProblemList::load(self.dir.at("problems.jsonl"))?.with_scenes(&Interrupt::never())
    }

    fn on(&self, ranks: usize) -> Result<RanksOutcome, Error> {
        self.watched(ranks, |_| ())
    }

    fn watched(
        &self,
        ranks: usize,
        mut watch: impl FnMut(&ManyOutcome) + Send,
    ) -> Result<RanksOutcome, Error> {
        let cancels: Vec<Cancel> = (0..ranks).map(|_| Cancel::new()).collect();
        let progress = |now: &ManyOutcome| {
            watch(now);
            if let Some((rank, after)) = self.told
                && now.tally.items >= after
            {
                cancels[rank].cancel();
            }
        };
        let (out, options) = (self.dir.at(self.out), &self.options);
        let mut links = threads(ranks);
        let others = links.split_off(1);
        std::thread::scope(|scope| {
            let rank = |link: mp_ranks::ThreadLink| {
                let cancel = &cancels[link.rank()];
                let never = || -> Result<ListedProblems, Error> { panic!("only the master loads") };
                ListedProblems::run_on(&link, "nowhere/r".as_ref(), options, cancel, never, |_| ())
            };
            let others: Vec<_> =
                others.into_iter().map(|link| scope.spawn(move || rank(link).unwrap())).collect();
            let ran = ListedProblems::run_on(&links[0], &out, options, &cancels[0], || self.load(), progress);
            assert!(others.into_iter().all(|rank| rank.join().unwrap().is_none()));
            ran.map(|ran| ran.unwrap())
        })
    }
}

fn ahead_of(dir: &Dir, out: &str) -> Option<String> {
    std::fs::read_to_string(dir.at(&format!("{out}.ahead"))).ok()
}

#[test]
fn ranks_do_not_matter() {
    let dir = Dir::new();
    dir.run("all.jsonl", &whole()).unwrap();
    for ranks in [1, 3, 20] {
        let out = format!("{ranks}.jsonl");
        let mut steps = Vec::new();
        let ran = Job::new(&dir, &out).watched(ranks, |now| steps.push(now.tally.items)).unwrap();
        assert!(dir.read(&out) == dir.read("all.jsonl"), "{ranks} ranks");
        assert_eq!(steps, (0..=14).collect::<Vec<_>>());
        assert_eq!((ran.outcome.before, ran.outcome.is_complete(), ahead_of(&dir, &out)), (0, true, None));
        assert_eq!((ran.shares.items().len(), ran.shares.items().iter().sum::<u64>()), (ranks, 14));
        assert!(ran.shares.work().iter().sum::<f64>() > 100.0, "{}", ran.shares);
    }
    let shard: Shard = "2/3".parse().unwrap();
    dir.shard("shard.jsonl", "2/3");
    Job { options: ManyOptions { shard, threads: 2, ..whole() }, ..Job::new(&dir, "s.jsonl") }.on(3).unwrap();
    assert!(dir.read("s.jsonl") == dir.read("shard.jsonl"));
}

/// Whichever rank is interrupted, and wherever the file is cut.
#[test]
fn what_ended_early_goes_on_on_other_ranks() {
    let dir = Dir::new();
    dir.run("all.jsonl", &whole()).unwrap();
    let all = dir.read("all.jsonl");
    let lines = |text: &str| text.matches('\n').count().saturating_sub(1) as u64;
    for (ranks, told) in [(1, 0), (2, 0), (3, 2)] {
        for after in [0, 4, 9, 13] {
            let out = format!("{ranks}-{after}.jsonl");
            let ran = Job::new(&dir, &out).told(told, after).on(ranks).unwrap().outcome;
            assert!(ran.tally.items >= after && ran.before == 0, "{ran:?}");
            let (written, ahead) = (dir.read(&out), ahead_of(&dir, &out).unwrap_or_default());
            assert!(all.starts_with(&written), "{written}");
            // All that was done is in one of the files.
            assert!(ran.is_complete() || lines(&written) + lines(&ahead) >= ran.tally.items, "{ran:?}");
            // A kill may have cut a line of each.
            if lines(&written) > 0 {
                dir.write(&out, &written[..written.len() - 1]);
            }
            if let Some(cut) = ahead.len().checked_sub(1) {
                dir.write(&format!("{out}.ahead"), &ahead[..cut]);
            }
            let again = Job::new(&dir, &out).on(4 - ranks).unwrap().outcome;
            assert!(again.is_complete() && again.before + 2 >= ran.tally.items, "{ran:?} {again:?}");
            assert!(dir.read(&out) == all && ahead_of(&dir, &out).is_none(), "{out}");
        }
    }
    // One process goes on with what ranks have left, and they find it done.
    Job::new(&dir, "r.jsonl").told(0, 7).on(1).unwrap();
    assert!(ahead_of(&dir, "r.jsonl").is_some());
    dir.run("r.jsonl", &whole()).unwrap();
    let ran = Job::new(&dir, "r.jsonl").on(2).unwrap();
    assert_eq!((ran.outcome.before, ran.shares.items()), (14, &[0, 0][..]));
    assert!(dir.read("r.jsonl") == all && ahead_of(&dir, "r.jsonl").is_none());
}

/// Items without a planner take no time at all, the others some.
#[test]
fn the_dearest_come_first() {
    let dir = Dir::new();
    let cheap =
        r#"{"scene": "easy", "request": {"planner": "no-such-planner"}, "seeds": {"from": 1, "count": 30}}"#;
    let dear = r#"{"scene": "easy", "seeds": {"from": 1, "count": 30}}"#;
    dir.write("problems.jsonl", format!("{cheap}\n{dear}\n"));
    Job::new(&dir, "r.jsonl").told(0, 20).on(1).unwrap();
    let done = |text: &str, from: usize| {
        let lines = text.lines().skip(from);
        lines
            .map(|line| line.split([' ', ':', ',']).find_map(|word| word.parse::<u64>().ok()).unwrap())
            .collect()
    };
    let written: Vec<u64> = done(&dir.read("r.jsonl"), 1);
    let mut ahead: Vec<u64> = done(&ahead_of(&dir, "r.jsonl").unwrap(), 1);
    ahead.sort_unstable();
    // One of each kind, to know what they take; at most one more of the cheap ones, which was handed out
    // before that was known. The one at work when the rank was told to end may be done.
    assert!((1..=2).contains(&written.len()), "{written:?}");
    assert!((20..=21).contains(&(ahead.len() + written.len())), "{ahead:?}");
    assert!(ahead.iter().all(|item| *item >= 30), "{ahead:?}");
    Job::new(&dir, "r.jsonl").on(3).unwrap();
    dir.run("all.jsonl", &whole()).unwrap();
    assert!(dir.read("r.jsonl") == dir.read("all.jsonl"));
}

/// The others have all from the master: its files may be gone by then. A robot's mesh is sought in folders by
/// their absolute names.
#[test]
fn scenes_are_sent() {
    let dir = Dir::new();
    for folder in ["arms", "arms/parts", "arms/parts/meshes"] {
        std::fs::create_dir(dir.at(folder)).unwrap();
    }
    let mesh = "<geometry><mesh filename=\"package://parts/meshes/link.off\"/></geometry>";
    let joint = "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 0 1\"/>\
                 <limit lower=\"-3\" upper=\"3\" effort=\"1\" velocity=\"1\"/></joint>";
    let urdf = format!(
        "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"><collision>{mesh}</collision></link>{joint}</robot>"
    );
    let files = [
        ("arms/r.urdf", urdf.as_str()),
        ("arms/parts/meshes/link.off", STICK),
        ("arms/swing.toml", "[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [0.0]\ngoal = [1.0]\n"),
        ("wall.env", SCENE),
        ("stick.off", STICK),
        ("wall.off", WALL),
    ];
    files.iter().for_each(|(name, text)| dir.write(name, text));
    dir.write("problems.jsonl", format!("{{\"scene\": \"arms/swing\", \"seeds\": [1, 2, 3, 4]}}\n{LIST}"));
    let tally = dir.run("all.jsonl", &whole()).unwrap().tally;
    assert_eq!((tally.solved, tally.failed), (14, 3));
    let ran = Job::new(&dir, "r.jsonl").watched(3, |now| {
        if now.tally.items == 0 {
            files.iter().for_each(|(name, _)| std::fs::remove_file(dir.at(name)).unwrap());
        }
    });
    assert!(ran.unwrap().outcome.is_complete());
    assert!(dir.read("r.jsonl") == dir.read("all.jsonl"));
}

#[test]
fn what_cannot_begin_ends_on_all_ranks() {
    let dir = Dir::new();
    dir.run("r.jsonl", &whole()).unwrap();
    let refused = |out: &str, words: &str| {
        let e = Job::new(&dir, out).on(3).unwrap_err();
        assert!(e.report().contains(words), "{e}");
    };
    refused("wall.off", "would overwrite the input");
    refused("problems.jsonl", "would overwrite the input");
    dir.write("problems.jsonl", LIST.replace("20000", "20001"));
    refused("r.jsonl", "the list has changed");
    Job::new(&dir, "cut.jsonl").told(0, 7).on(2).unwrap();
    std::fs::remove_file(dir.at("cut.jsonl")).unwrap();
    dir.write("problems.jsonl", LIST);
    refused("cut.jsonl", "cut.jsonl.ahead: it belongs to another job");
    std::fs::remove_file(dir.at("problems.jsonl")).unwrap();
    refused("new.jsonl", "problems.jsonl");
    assert!(!dir.at("new.jsonl").exists());
}

/// What each of three ranks has of a scene and a request that the first one loads.
fn shared(
    load: impl FnOnce() -> Result<(Scene, Request), Error> + Send,
) -> Vec<Result<Option<(Scene, Request)>, Error>> {
    let mut links = threads(3);
    let others = links.split_off(1);
    std::thread::scope(|scope| {
        let never = || -> Result<(Scene, Request), Error> { panic!("only the master loads") };
        let others: Vec<_> =
            others.into_iter().map(|link| scope.spawn(move || scene_on_ranks(&link, never))).collect();
        let first = scene_on_ranks(&links[0], load);
        let others = others.into_iter().map(|rank| rank.join().unwrap());
        std::iter::once(first).chain(others).collect()
    })
}

#[test]
fn a_scene_and_a_request_are_sent() {
    let dir = Dir::new();
    let request = Request::new("rrt-connect").seed(7).set("step", "10%");
    for file in [dir.at("wall.env"), "arm".into(), "rrs-high".into()] {
        let all = shared(|| Ok((Scene::find(&file)?, request.clone())));
        let plans: Vec<_> = all
            .into_iter()
            .map(|one| {
                let (scene, sent) = one.unwrap().unwrap();
                assert_eq!(sent, request);
                (scene.name().to_owned(), scene.plan(&sent).unwrap().without_times().path)
            })
            .collect();
        assert!(plans[0].1.is_some() && plans.iter().all(|plan| *plan == plans[0]), "{file:?}");
    }
    let mut refused = shared(|| Err(Error::new("no such scene"))).into_iter();
    assert!(refused.next().unwrap().unwrap_err().message().contains("no such scene"));
    assert!(refused.all(|one| one.unwrap().is_none()));
}
