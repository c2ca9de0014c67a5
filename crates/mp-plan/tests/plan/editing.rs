//! Obstacles, starts and goals of problems in TOML are edited, and what is saved reads back as the scene that was edited.

use mp_io::{
    Disk, DocumentShape, Files, InMemory, OtherShape, ProblemDocument, ProblemObstacle, ProblemShape,
};
use mp_plan::{PathRows, Request, Scene, SceneProblem, shipped_files};
use std::path::Path;
use std::sync::Arc;

fn no_mesh(name: &str) -> Result<mp_geom::TriMesh, mp_io::Error> {
    panic!("{name} is asked for")
}

fn obstacle(name: &str, shape: ProblemShape, pose: [f64; 6]) -> ProblemObstacle {
    ProblemObstacle { name: name.into(), of: None, shape, scale: None, pose }
}

fn ball(name: &str, radius: f64, [x, y, z]: [f64; 3]) -> ProblemObstacle {
    obstacle(name, ProblemShape::Solid(DocumentShape::Sphere { radius }), [x, y, z, 0.0, 0.0, 0.0])
}

fn disc(name: &str, radius: f64, [x, y]: [f64; 2]) -> ProblemObstacle {
    obstacle(name, ProblemShape::Other(OtherShape::Circle { radius }), [x, y, 0.0, 0.0, 0.0, 0.0])
}

/// What a person sees of a scene.
fn seen(scene: &Scene) -> (Vec<f64>, Vec<Vec<f64>>, String) {
    (scene.start(), scene.goals(), format!("{:?}", scene.bodies()))
}

/// Writes the files of an edited problem into a folder, and loads the scene from there.
fn saved(problem: &SceneProblem, document: &ProblemDocument, into: &Path) -> Scene {
    let (files, left) = problem.saved("saved", document, &no_mesh, Some(into)).unwrap();
    assert!(left.is_empty(), "{left:?}");
    for (name, bytes) in &files {
        std::fs::write(into.join(name), bytes).unwrap();
    }
    assert_eq!(files[0].0, "saved.toml");
    Scene::load(into.join("saved.toml")).unwrap()
}

/// Every shipped problem in TOML: an obstacle is moved, one deleted, one added. The saved problem is the edited scene, and the lines that were
/// not changed are as they were.
#[test]
fn edited_problems_read_back_from_their_files() {
    let mut edited_kinds = std::collections::BTreeSet::new();
    for name in Scene::shipped() {
        let scene = Scene::find(name).unwrap();
        let problem = scene.problem(Arc::new(shipped_files()), false);
        if scene.files().file.extension().is_none_or(|ending| ending != "toml") {
            assert!(problem.is_err(), "{name} is no problem in TOML");
            continue;
        }
        let problem = problem.unwrap();
        let document = problem.document();
        // As it was opened, it is the same text.
        let own = problem.saved("same", document, &no_mesh, None).unwrap().0;
        let text = String::from_utf8(shipped_files().read(&scene.files().file, 1 << 20).unwrap()).unwrap();
        let without = |text: &str| -> Vec<String> {
            text.lines().filter(|line| !line.contains('"')).map(str::to_owned).collect()
        };
        assert_eq!(without(&text), without(std::str::from_utf8(&own[0].1).unwrap()), "{name}");
        let mut changed = document.clone();
        // What is carried later on is named by the motion, and stays.
        if changed.obstacles.len() > 3 && !text.contains("attach") {
            changed.obstacles.remove(1);
        }
        if let Some(first) = changed.obstacles.first_mut() {
            first.pose = [first.pose[0] + 0.01, first.pose[1], first.pose[2], 0.25, 0.0, 0.0];
        }
        changed.obstacles.push(match changed.plane {
            true => disc("new \"one\"", 0.001, [-0.5, -0.5]),
            false => ball("new \"one\"", 0.01, [0.0, 0.0, 9.0]),
        });
        let edited = problem.edited(&changed, &no_mesh, &scene).unwrap();
        let last = changed.obstacles.len() - 1;
        let still: Vec<_> = edited.bodies().into_iter().filter(|body| body.pose.is_some()).collect();
        let names =
            |count: usize| still.iter().take(count).map(|body| body.name.as_str()).collect::<Vec<_>>();
        let wanted: Vec<_> = changed.obstacles.iter().map(|o| o.name.as_str()).collect();
        assert_eq!(names(last + 1), wanted, "{name}");
        let dir = tempfile::tempdir().unwrap();
        assert_eq!(seen(&saved(&problem, &changed, dir.path())), seen(&edited), "{name}");
        // Once more: the same document gives the same scene, and undoing all gives the first one.
        let back = problem.edited(document, &no_mesh, &edited).unwrap();
        assert_eq!(seen(&back), seen(&scene), "{name}");
        // Ends that were moved are written too, as many numbers as the file has.
        let ends = (scene.start(), scene.goals());
        changed.start = Some(ends.0.clone());
        changed.goals = Some(ends.1.clone());
        let moved = problem.edited(&changed, &no_mesh, &scene).map(|scene| (scene.start(), scene.goals()));
        let exact = |e: &mp_plan::Error| e.to_string().contains("cannot reach these numbers exactly");
        assert!(moved.as_ref().map_or_else(exact, |moved| moved.0 == ends.0), "{name}: {moved:?}");
        edited_kinds.insert(scene.kind());
    }
    assert!(edited_kinds.len() >= 4, "{edited_kinds:?}");
}

const ARM: &str = "<robot name='r'><link name='a'/><link name='b'><collision><origin xyz='0.5 0 0'/><geometry>\
                   <box size='1 0.1 0.1'/></geometry></collision></link><joint name='j' type='revolute'><parent link='a'/><child link='b'/>\
                   <axis xyz='0 0 1'/><limit lower='-3' upper='3' velocity='1' effort='1'/></joint></robot>";

const PROBLEM: &str = "# mine\n[robot]\nurdf = \"r.urdf\"\n\n[[obstacle]] # the first\nbox = [0.1, 0.1, 0.1]\nat = [5, 0, 0]\n\n\
                       # of points\n[[obstacle]]\nat = [\n  0,\n  3, 0 ]\n[obstacle.points]\nradius = 0.1\nat = [\n  [0, 0, 0],\n  [1, 0, 0],\n]\n\n\
                       [[obstacle]]\nsphere = 0.2\nscale = [1, 2, 1]\npose = [0, 0, 4, 0, 0, 0.5]\n\n# ends\n[motion]\nstart = [-1] # here\ngoal = { j = 1 }\n";

fn in_memory(text: &'static str) -> Arc<dyn Files> {
    Arc::new(InMemory(move |name: &str| match name {
        "p.toml" => Some(text.as_bytes()),
        "r.urdf" => Some(ARM.as_bytes()),
        _ => None,
    }))
}

/// Lines that were not changed stay, with their comments; shapes that an editor does not know are kept, and copied.
#[test]
fn what_was_not_changed_keeps_its_lines() {
    let files = in_memory(PROBLEM);
    let scene = Scene::load_from(&*files, Path::new("p.toml")).unwrap();
    let problem = scene.problem(files, false).unwrap();
    let mut document = problem.document().clone();
    let kinds: Vec<_> = document.obstacles.iter().map(|o| (o.name.as_str(), o.scale)).collect();
    assert_eq!(kinds, [("obstacle 1", None), ("obstacle 2", None), ("obstacle 3", Some([1.0, 2.0, 1.0]))]);
    let cloud = ProblemShape::Other(OtherShape::Given { of: 1, kind: "points".into() });
    assert_eq!((&document.obstacles[1].shape, document.obstacles[1].pose[1]), (&cloud, 3.0));
    document.obstacles.remove(0);
    document.obstacles.push(obstacle("copy", cloud, [0.0, -3.0, 0.0, 0.0, 0.0, 0.5]));
    (document.start, document.goals) = (Some(vec![-0.5]), Some(vec![vec![0.5], vec![1.5]]));
    let (files, _) = problem.saved("q", &document, &no_mesh, None).unwrap();
    let text = String::from_utf8(files[0].1.clone()).unwrap();
    assert_eq!(
        text,
        "# mine\n[robot]\nurdf = \"q_r.urdf\"\n\n\n# of points\n[[obstacle]]\nname = \"obstacle 2\"\n\
         points = { at = [[0, 0, 0], [1, 0, 0]], radius = 0.1 }\nat = [0, 3, 0]\n\n\
         [[obstacle]]\nname = \"obstacle 3\"\nsphere = 0.2\npose = [0, 0, 4, 0, 0, 0.5]\nscale = [1, 2, 1]\n\n\
         # ends\n[motion]\nstart = [-0.5] # here\ngoals = [[0.5], [1.5]]\n\n\
         [[obstacle]]\nname = \"copy\"\npoints = { at = [[0, 0, 0], [1, 0, 0]], radius = 0.1 }\npose = [0, -3, 0, 0, 0, 0.5]\n"
    );
    assert_eq!(files[1], ("q_r.urdf".to_owned(), ARM.as_bytes().to_vec()));
    let edited = problem.edited(&document, &no_mesh, &scene).unwrap();
    assert_eq!((edited.start(), edited.goals()), (vec![-0.5], vec![vec![0.5], vec![1.5]]));
    assert_eq!(edited.bodies().len(), 4);
}

/// A plan in the edited scene goes around the new obstacle, which the old path meets; a robot and a map alone become problems when they are
/// saved, wherever that is.
#[test]
fn plans_avoid_new_obstacles() {
    let dir = tempfile::tempdir().unwrap();
    let into = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &[u8]| std::fs::write(dir.path().join(name), text).unwrap();
    write("r.urdf", ARM.as_bytes());
    write("room.yaml", b"image: room.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n");
    write("room.pgm", &[b"P5 60 40 255\n".as_slice(), &[255; 2400]].concat());
    for (file, new) in [("r.urdf", None), ("room.yaml", Some(disc("pillar", 0.6, [3.0, 2.0])))] {
        let scene = Scene::load(dir.path().join(file)).unwrap();
        let problem = scene.problem(Arc::new(Disk), true).unwrap();
        let mut document = problem.document().clone();
        assert!(document.obstacles.is_empty() && problem.has_map().unwrap() == new.is_some());
        if new.is_none() {
            // Between start and goal, the other way round is free.
            (document.start, document.goals) = (Some(vec![-1.0]), Some(vec![vec![1.0]]));
        } else {
            (document.start, document.goals) = (Some(vec![0.5, 2.0]), Some(vec![vec![5.5, 2.0]]));
        }
        let before = problem.edited(&document, &no_mesh, &scene).unwrap();
        let path = |scene: &Scene| {
            let report = scene.plan(&Request::new("rrt-connect").seed(1)).unwrap();
            PathRows { format: scene.path_format(), columns: scene.columns(), rows: report.path.unwrap() }
        };
        let old = path(&before);
        document.obstacles.push(new.unwrap_or_else(|| ball("pillar", 0.2, [0.9, 0.5, 0.0])));
        if document.plane {
            let edited = problem.edited(&document, &no_mesh, &before).unwrap();
            let faults = edited.check(&old).unwrap().faults;
            assert!(faults.iter().any(|fault| fault.contains("pillar")), "{faults:?}");
            let new = path(&edited);
            assert!(edited.check(&new).unwrap().free);
            assert_eq!(seen(&saved(&problem, &document, into.path())), seen(&edited));
            assert!(saved(&problem, &document, into.path()).check(&new).unwrap().free);
        } else {
            // One joint cannot go around it, so that the start moves to its other side.
            let edited = problem.edited(&document, &no_mesh, &before).unwrap();
            assert!(!edited.check(&old).unwrap().free);
            document.start = Some(vec![0.9]);
            let edited = problem.edited(&document, &no_mesh, &before).unwrap();
            assert!(edited.check(&path(&edited)).unwrap().free);
            assert_eq!(seen(&saved(&problem, &document, into.path())), seen(&edited));
        }
        // Beside its own files the names stay.
        let (files, _) =
            problem.saved("here", &document, &no_mesh, Some(&dir.path().canonicalize().unwrap())).unwrap();
        let text = String::from_utf8(files[0].1.clone()).unwrap();
        assert!(files.len() == 1 && text.contains(&format!("\"{file}\"")), "{text}");
        // For a folder that is not known the files are named where they are.
        let (files, _) = problem.saved("away", &document, &no_mesh, None).unwrap();
        let text = String::from_utf8(files[0].1.clone()).unwrap();
        let place = dir.path().canonicalize().unwrap().join(file);
        assert!(files.len() == 1 && text.contains(&*place.to_string_lossy()), "{text}");
    }
}

const FOUR: &str = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

/// A mesh that was added is written beside the problem. Where the robot names further files in memory, all names stay, and the files are
/// listed.
#[test]
fn meshes_are_written_beside_the_problem() {
    let robot: &'static str =
        Box::leak(ARM.replace("<box size='1 0.1 0.1'/>", "<mesh filename='bar.off'/>").into_boxed_str());
    for (urdf, left) in [(ARM, vec![]), (robot, vec!["r.urdf".to_owned(), "bar.off".to_owned()])] {
        let files: Arc<dyn Files> = Arc::new(InMemory(move |name: &str| match name {
            "p.toml" => Some(PROBLEM.as_bytes()),
            "r.urdf" => Some(urdf.as_bytes()),
            "bar.off" => Some(FOUR.as_bytes()),
            _ => None,
        }));
        let scene = Scene::load_from(&*files, Path::new("p.toml")).unwrap();
        let problem = scene.problem(files, false).unwrap();
        let mut document = problem.document().clone();
        let file = "four.stl".to_owned();
        let mesh = ProblemShape::Solid(DocumentShape::Mesh { file, off: None, solid: true });
        document.obstacles.push(obstacle("four", mesh, [0.0, 0.0, 5.0, 0.1, 0.0, 0.0]));
        document.obstacles[3].scale = Some([1.0, 1.0, 2.0]);
        let four = |name: &str| {
            assert_eq!(name, "four.stl");
            mp_io::parse_mesh("four.off", FOUR.as_bytes())
        };
        let edited = problem.edited(&document, &four, &scene).unwrap();
        let (saved, named) = problem.saved("q", &document, &four, None).unwrap();
        assert_eq!(named, left);
        let text = String::from_utf8(saved[0].1.clone()).unwrap();
        assert!(text.contains("mesh = \"q_four_stl.off\"\nsolid = true\n"), "{text}");
        assert_eq!((saved[1].0.as_str(), text.contains("\"q_r.urdf\"")), ("q_four_stl.off", left.is_empty()));
        let kept: &'static [(String, Vec<u8>)] = Box::leak(saved.into_boxed_slice());
        let again = InMemory(move |name: &str| match name {
            "r.urdf" => Some(urdf.as_bytes()),
            "bar.off" => Some(FOUR.as_bytes()),
            _ => kept.iter().find(|file| file.0 == name).map(|file| file.1.as_slice()),
        });
        assert_eq!(seen(&Scene::load_from(&again, Path::new("q.toml")).unwrap()), seen(&edited));
    }
}

/// A start of a robot with accelerations has velocities, after the time if there is one; an edited goal leaves them free.
#[test]
fn velocities_of_a_start_are_kept() {
    let moving = "[[moving]]\ncircle = [0, 0, 0.1]\npath = [[0, 1, 1], [1, 1, 2]]\n";
    for (given, more, moved, expected) in [
        ("[2, 2]", "", [0.0, 0.0], "[3, 4]"),
        ("[2, 2]", "", [0.5, 0.0], "[3, 4, 0.5, 0]"),
        ("[2, 2, 0, 0.25]", "", [0.0, 0.0], "[3, 4, 0, 0]"),
        ("[2, 2]", moving, [0.0, 0.0], "[3, 4]"),
        ("[2, 2, 0, 0.25]", moving, [0.5, 0.0], "[3, 4, 0.5, 0]"),
    ] {
        let text = format!(
            "[world]\nwalls = [[0, 0], [9, 9]]\n[robot]\ndisc = 0.1\nkind = \"accelerations\"\nspeeds = [1, 1]\n\
             accelerations = [1, 1]\nduration = 0.5\n[motion]\nstart = {given}\ngoal = [6, 6]\ntolerance = 0.4\n{more}"
        );
        let files = in_memory(Box::leak(text.into_boxed_str()));
        let scene = Scene::load_from(&*files, Path::new("p.toml")).unwrap();
        let problem = scene.problem(files, false).unwrap();
        let mut document = problem.document().clone();
        let time = if more.is_empty() { vec![] } else { vec![0.0] };
        let row = |numbers: &[f64], velocity: &[f64]| [numbers, &time, velocity, &[0.0; 3]].concat();
        document.start = Some(row(&[3.0, 4.0], &moved));
        document.goals = Some(vec![row(&[5.0, 5.0], &[0.0; 2])]);
        let edited = problem.edited(&document, &no_mesh, &scene).unwrap();
        assert_eq!(edited.start(), row(&[3.0, 4.0], &moved), "{given} {more}");
        let (saved, _) = problem.saved("q", &document, &no_mesh, None).unwrap();
        let saved = String::from_utf8(saved[0].1.clone()).unwrap();
        assert!(saved.contains(&format!("start = {expected}\ngoal = [5, 5]\n")), "{saved}");
    }
}

/// Joints that are held where the start says by names stay there when the start is moved, again and again, and when an option gives another.
#[test]
fn what_is_held_stays_when_the_start_moves() {
    let two = ARM.replace(
        "</robot>",
        "<link name='c'/><joint name='k' type='revolute'><parent link='b'/><child link='c'/><axis xyz='0 0 1'/>\
         <limit lower='-3' upper='3' velocity='1' effort='1'/></joint></robot>",
    );
    let two: &'static str = Box::leak(two.into_boxed_str());
    let srdf = "<robot name='r'><group name='end'><joint name='k'/></group>\
                <group_state name='up' group='end'><joint name='j' value='1.25'/><joint name='k' value='0.5'/></group_state></robot>";
    for start in ["{ j = 1.25, k = 0.5 }", "\"up\""] {
        let text = format!(
            "[robot]\nurdf = \"r.urdf\"\nsrdf = \"r.srdf\"\ngroup = \"end\"\n[motion]\nstart = {start}\ngoal = [1]\n"
        );
        let text: &'static str = Box::leak(text.into_boxed_str());
        let files: Arc<dyn Files> = Arc::new(InMemory(move |name: &str| match name {
            "p.toml" => Some(text.as_bytes()),
            "r.urdf" => Some(two.as_bytes()),
            "r.srdf" => Some(srdf.as_bytes()),
            _ => None,
        }));
        let scene = Scene::load_from(&*files, Path::new("p.toml")).unwrap();
        let problem = scene.problem(files, false).unwrap();
        let mut document = problem.document().clone();
        let poses = |scene: &Scene| format!("{:?}", scene.poses(&[0.75]).unwrap());
        for moved in [-0.5, 2.0] {
            document.start = Some(vec![moved]);
            let edited = problem.edited(&document, &no_mesh, &scene).unwrap();
            assert_eq!((edited.start(), poses(&edited)), (vec![moved], poses(&scene)));
        }
        let (saved, _) = problem.saved("q", &document, &no_mesh, None).unwrap();
        let saved: &'static [(String, Vec<u8>)] = Box::leak(saved.into_boxed_slice());
        let again: Arc<dyn Files> = Arc::new(InMemory(move |name: &str| {
            saved.iter().find(|file| file.0 == name).map(|file| file.1.as_slice())
        }));
        let read = Scene::load_from(&*again, Path::new("q.toml")).unwrap();
        assert_eq!((read.start(), poses(&read)), (vec![2.0], poses(&scene)));
        let problem = read.problem(again, false).unwrap();
        document.start = Some(vec![-1.0]);
        let edited = problem.edited(&document, &no_mesh, &read).unwrap();
        assert_eq!((edited.start(), poses(&edited)), (vec![-1.0], poses(&scene)));
    }
}

/// Meshes whose files would have the same name are files of their own: those that are added, those that the problem names, and those in folders.
#[test]
fn meshes_with_names_that_are_alike_stay_apart() {
    let cube = |side: f64| mp_geom::primitives::cuboid(side, side, side).unwrap();
    const GIVEN: [&str; 3] = ["a/b.off", "a_b.off", "q_four_stl.off"];
    let mut text = "[robot]\nbox = [0.1, 0.1, 0.1]\n[motion]\nstart = [9, 0, 0, 0, 0, 0]\n\
                    goals = [[9, 1, 0, 0, 0, 0], [9, 2, 0, 0, 0, 0]]\n"
        .to_owned();
    text.extend(GIVEN.map(|file| format!("[[obstacle]]\nmesh = \"{file}\"\n")));
    let mut all = vec![("p.toml".to_owned(), text.into_bytes())];
    for (i, file) in GIVEN.into_iter().enumerate() {
        all.push((file.to_owned(), mp_io::off_text(&cube(1.0 + i as f64)).into_bytes()));
    }
    let in_memory = |all: Vec<(String, Vec<u8>)>| -> Arc<dyn Files> {
        let kept: &'static [(String, Vec<u8>)] = Box::leak(all.into_boxed_slice());
        Arc::new(InMemory(move |name: &str| {
            kept.iter().find(|file| file.0 == name).map(|file| file.1.as_slice())
        }))
    };
    let files = in_memory(all);
    let scene = Scene::load_from(&*files, Path::new("p.toml")).unwrap();
    let problem = scene.problem(files, false).unwrap();
    let mut document = problem.document().clone();
    let added = [("four.stl", 4.0), ("four_stl", 5.0), ("FOUR.stl", 6.0)];
    for (file, _) in added {
        let mesh = DocumentShape::Mesh { file: file.to_owned(), off: None, solid: false };
        document.obstacles.push(obstacle(file, ProblemShape::Solid(mesh), [0.0; 6]));
    }
    let mesh = |name: &str| Ok(cube(added.iter().find(|(file, _)| *file == name).unwrap().1));
    let sides = |scene: &Scene| -> Vec<f64> {
        let problem = scene.bodies();
        let side = |body: &mp_plan::Body| match &body.shape {
            mp_plan::BodyShape::Mesh(mesh) => mesh.aabb().max.x - mesh.aabb().min.x,
            _ => panic!("{}", body.name),
        };
        problem.iter().filter(|body| body.pose.is_some()).map(side).collect()
    };
    let expected = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    assert_eq!(sides(&problem.edited(&document, &mesh, &scene).unwrap()), expected);
    let (saved, _) = problem.saved("q", &document, &mesh, None).unwrap();
    assert_eq!(sides(&Scene::load_from(&*in_memory(saved), Path::new("q.toml")).unwrap()), expected);
}

#[test]
fn what_is_wrong_is_said() {
    let files = in_memory(PROBLEM);
    let scene = Scene::load_from(&*files, Path::new("p.toml")).unwrap();
    let problem = scene.problem(files, false).unwrap();
    let refused = |change: &dyn Fn(&mut ProblemDocument)| {
        let mut document = problem.document().clone();
        change(&mut document);
        problem.edited(&document, &no_mesh, &scene).unwrap_err().to_string()
    };
    assert!(refused(&|d| d.version = 7).contains("version 7"));
    assert!(refused(&|d| d.obstacles.swap(0, 1)).contains("another problem"));
    assert!(refused(&|d| d.obstacles[2].of = Some(9)).contains("another problem"));
    assert!(refused(&|d| d.obstacles.push(ball("b", -1.0, [0.0; 3]))).contains("is -1"));
    assert!(
        refused(&|d| d.obstacles[2].scale = Some([0.0, 1.0, 1.0])).contains("the scale of obstacle 3 is 0")
    );
    assert!(refused(&|d| d.obstacles[1].scale = Some([2.0; 3])).contains("set of points"));
    assert!(refused(&|d| d.obstacles.push(disc("c", 1.0, [0.0; 2]))).contains("shape of the plane"));
    assert!(refused(&|d| d.start = Some(vec![f64::NAN])).contains("p.toml"));
    let inline = "obstacle = [{ sphere = 1, at = [9, 0, 0] }]\n[robot]\nurdf = \"r.urdf\"\n[motion]\nstart = [0]\ngoal = [1]\n";
    let files = in_memory(inline);
    let scene = Scene::load_from(&*files, Path::new("p.toml")).unwrap();
    let error = scene.problem(files, false).unwrap_err();
    assert!(
        error.to_string().contains("one list") && error.remedy().is_some_and(|r| r.contains("[[obstacle]]"))
    );
}
