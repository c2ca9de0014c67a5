//! Scenes as glTF, read back by another reader.

use gltf::animation::util::ReadOutputs;
use gltf::mesh::Mode;
use mp_plan::{Cancel, Control, Request, Scene};
use mp_view::{GrownTrees, Role, SceneFile};
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};

fn planned(name: &str) -> SceneFile {
    let scene = Scene::find(name).unwrap();
    let report = scene.plan(&Request::new("rrt-connect").seed(1)).unwrap();
    let mut file = SceneFile::of(&scene).unwrap();
    file.add_report(&scene, &report).unwrap();
    file
}

fn pose(t: [f32; 3], q: [f32; 4]) -> Isometry3<f32> {
    let q = UnitQuaternion::new_normalize(Quaternion::new(q[3], q[0], q[1], q[2]));
    Isometry3::from_parts(Translation3::from(t), q)
}

/// The pose of body `i` in a row of poses.
fn seven(poses: &[f64], i: usize) -> Isometry3<f32> {
    let p: Vec<f32> = poses[7 * i..7 * i + 7].iter().map(|v| *v as f32).collect();
    pose([p[0], p[1], p[2]], [p[3], p[4], p[5], p[6]])
}

fn near(a: &Isometry3<f32>, b: &Isometry3<f32>) -> bool {
    (a.translation.vector - b.translation.vector).norm() < 1e-3 && a.rotation.angle_to(&b.rotation) < 2e-3
}

/// Named nodes in order under one root that turns z upwards, the robot from start to goal in the time, translucent ends, the trace
/// as a line.
#[test]
fn scenes_read_back_with_their_motion() {
    for name in ["easy", "arm", "rrs-low"] {
        let file = planned(name);
        let bytes = file.to_glb(3.0);
        assert_eq!(bytes, file.to_glb(3.0));
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
        let blob = blob.unwrap();
        let data = |buffer: gltf::Buffer<'_>| (buffer.length() <= blob.len()).then_some(blob.as_slice());

        let roots: Vec<_> = document.default_scene().unwrap().nodes().collect();
        let [root] = roots.as_slice() else { panic!("{name}: one root") };
        let (t, q, _) = root.transform().decomposed();
        let up = pose(t, q) * Point3::new(0.0, 0.0, 1.0);
        assert!((up - Point3::new(0.0, 1.0, 0.0)).norm() < 1e-6, "{name}: {up}");

        let child = |parent: &gltf::Node<'_>, wanted: &str| {
            parent.children().find(|node| node.name() == Some(wanted)).map(|node| node.index())
        };
        let node = |index: usize| document.nodes().nth(index).unwrap();
        let group = |wanted: &str| node(child(root, wanted).unwrap_or_else(|| panic!("{name}: {wanted}")));
        let names = |role: Role| file.bodies.iter().filter(move |b| b.role == role).map(|b| b.name.clone());
        for (group, role) in [(group("obstacles"), Role::Obstacle), (group("robot"), Role::Robot)] {
            let found: Vec<_> = group.children().map(|node| node.name().unwrap().to_owned()).collect();
            assert_eq!(found, names(role).collect::<Vec<_>>(), "{name}");
        }
        let robot: Vec<usize> = group("robot").children().map(|node| node.index()).collect();

        // From the start to a goal, in three seconds.
        let animations: Vec<_> = document.animations().collect();
        assert_eq!(animations.len(), 1);
        let mut ends = vec![[([0.0; 3], [0.0; 4]); 2]; robot.len()];
        for channel in animations[0].channels() {
            let body = robot.iter().position(|node| *node == channel.target().node().index()).unwrap();
            let reader = channel.reader(data);
            let times: Vec<f32> = reader.read_inputs().unwrap().collect();
            assert!(times.len() > 10 && times[0] == 0.0 && (times[times.len() - 1] - 3.0).abs() < 1e-5);
            assert!(times.windows(2).all(|w| w[0] < w[1]), "{name}");
            match reader.read_outputs().unwrap() {
                ReadOutputs::Translations(all) => {
                    let all: Vec<_> = all.collect();
                    assert_eq!(all.len(), times.len());
                    (ends[body][0].0, ends[body][1].0) = (all[0], all[all.len() - 1]);
                }
                ReadOutputs::Rotations(all) => {
                    let all: Vec<_> = all.into_f32().collect();
                    assert_eq!(all.len(), times.len());
                    let dot = |w: &[[f32; 4]]| (0..4).map(|k| w[0][k] * w[1][k]).sum::<f32>();
                    assert!(all.windows(2).all(|w| dot(w) > 0.9), "{name}: the near way around");
                    (ends[body][0].1, ends[body][1].1) = (all[0], all[all.len() - 1]);
                }
                _ => panic!("{name}: another channel"),
            }
        }
        for (i, [first, last]) in ends.iter().enumerate() {
            assert!(near(&pose(first.0, first.1), &seven(&file.start.poses, i)), "{name} {i}");
            let last = pose(last.0, last.1);
            assert!(file.goals.iter().any(|goal| near(&last, &seven(&goal.poses, i))), "{name} {i}");
        }

        // Copies at the ends are seen through, and have the points of the robot.
        let goal = if file.goals.len() == 1 { "goal" } else { "goal 1" };
        for wanted in ["start", goal] {
            let copies: Vec<_> = group(wanted).children().collect();
            assert_eq!(copies.len(), robot.len());
            for mesh in copies.iter().filter_map(gltf::Node::mesh) {
                let material = mesh.primitives().next().unwrap().material();
                assert_eq!(material.alpha_mode(), gltf::material::AlphaMode::Blend);
            }
        }
        let trace = root.children().find(|node| node.name().is_some_and(|n| n.starts_with("path "))).unwrap();
        let line = trace.mesh().unwrap().primitives().next().unwrap();
        assert_eq!(line.mode(), Mode::LineStrip);
        let points = line.reader(data).read_positions().unwrap().count();
        assert_eq!(points, file.paths[0].trace.len() / 3);

        // Bodies that are meshes have the points and triangles of the scene.
        let meshes = file.bodies.iter().filter(|body| matches!(body.shape, mp_view::Shape::Mesh(_)));
        for body in meshes.filter(|body| body.role == Role::Obstacle) {
            let mp_view::Shape::Mesh(i) = body.shape else { continue };
            let found = node(child(&group("obstacles"), &body.name).unwrap());
            let primitive = found.mesh().unwrap().primitives().next().unwrap();
            let reader = primitive.reader(data);
            let positions: Vec<f32> = reader.read_positions().unwrap().flatten().collect();
            let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
            if file.bodies.iter().filter(|b| b.name == body.name).count() == 1 {
                assert_eq!(
                    (positions, indices),
                    (file.meshes[i].positions.clone(), file.meshes[i].triangles.clone())
                );
            }
        }
    }
}

/// Areas become closed plates: their volume is the area times the thickness, holes left out.
#[test]
fn areas_are_plates() {
    let mut file = planned("rrs-low");
    file.areas[0].rings =
        vec![vec![0.0, 0.0, 4.0, 0.0, 4.0, 4.0, 0.0, 4.0], vec![1.0, 1.0, 2.0, 1.0, 2.0, 2.0, 1.0, 2.0]];
    let bytes = file.to_glb(1.0);
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
    let blob = blob.unwrap();
    let plate = document.meshes().find(|mesh| mesh.name() == Some(&file.bodies[0].name)).unwrap();
    let primitive = plate.primitives().next().unwrap();
    let reader = primitive.reader(|_| Some(&blob));
    let points: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    let top: f32 = points.iter().map(|p| p[2]).fold(0.0, f32::max);
    let covered: f32 = indices
        .chunks_exact(3)
        .map(|t| t.iter().map(|i| points[*i as usize]).collect::<Vec<_>>())
        .filter(|t| t.iter().all(|p| p[2] == top))
        .map(|t| {
            ((t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[2][0] - t[0][0]) * (t[1][1] - t[0][1])) / 2.0
        })
        .sum();
    assert!(top > 0.0 && (covered - 15.0).abs() < 1e-4, "{covered}");
}

/// Without a path nothing moves, and numbers that glTF does not allow are left out.
#[test]
fn little_or_broken_scenes_are_still_files() {
    let scene = Scene::find("easy").unwrap();
    let mut file = SceneFile::of(&scene).unwrap();
    file.meshes[0].positions[0] = f32::NAN;
    file.start.poses[4] = f64::INFINITY;
    file.meshes[1].triangles.clear();
    let document = gltf::Gltf::from_slice(&file.to_glb(8.0)).unwrap().document;
    assert_eq!(document.animations().count(), 0);
    assert!(document.nodes().all(|node| node.name() != Some("start")), "the robot itself is there");
    let empty = SceneFile {
        meshes: Vec::new(),
        bodies: Vec::new(),
        goals: Vec::new(),
        ..SceneFile::of(&scene).unwrap()
    };
    assert_eq!(gltf::Gltf::from_slice(&empty.to_glb(8.0)).unwrap().document.nodes().count(), 1);
}

/// In coordinates of surveys numbers of 32 bits are half a metre apart: places are relative to the middle of the scene.
#[test]
fn scenes_far_from_the_origin_keep_their_places() {
    let rigid = "[robot]\nbox = [0.5, 0.5, 0.5]\nbounds = [[499990, 4499990, 90], [500030, 4500030, 110]]\n\
         [motion]\nstart = [500002, 4500012.345, 100, 0, 0, 0]\ngoal = [500010.7, 4500012.345, 100, 0, 0, 0]\n\
         [[obstacle]]\nname = \"pillar\"\nbox = [1, 1, 1]\npose = [500003.4, 4500010.3, 100, 0, 0, 0]\n";
    let plane = "[world]\nbounds = [[500000, 4500000], [500010, 4500010]]\n[robot]\ndisc = 0.1\n\
         [motion]\nstart = [500002, 4500005.345]\ngoal = [500008.7, 4500005.345]\n\
         [[obstacle]]\nname = \"pillar\"\nrectangle = [[500003.1, 4500002.2], [500005.3, 4500003.1]]\n";
    for (text, pillar, start) in [
        (rigid, [500_003.4, 4_500_010.3], [500_002.0, 4_500_012.345]),
        (plane, [500_004.2, 4_500_002.65], [500_002.0, 4_500_005.345]),
    ] {
        let scene = Scene::parse("far", text, std::path::Path::new("")).unwrap();
        let request = Request::new("rrt-connect").seed(1);
        let mut grown = GrownTrees::new(&scene, &request);
        let report = scene.plan_with(&request, &mut Control::new(Cancel::default(), &mut grown)).unwrap();
        let mut file = SceneFile::for_file(&scene).unwrap();
        file.add_run(&scene, &report).unwrap();
        grown.add_to(&mut file);
        // What the page reads has the same places, and says what they are relative to.
        assert_eq!(SceneFile::parse(&file.to_bytes()).unwrap(), file);
        assert!(file.origin[0] > 1e5 && file.start.poses[0].abs() < 20.0, "{:?}", file.start);
        let nodes: Vec<_> = file.trees.iter().flat_map(|tree| &tree.nodes).collect();
        assert!(nodes.len() > 3 && nodes.iter().all(|x| x.abs() < 50.0), "{nodes:?}");
        let bytes = file.to_glb(1.0);
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        // The reader of the other tests has numbers of 32 bits.
        let head: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
        let data = &bytes[28 + length..];
        let nodes = head["nodes"].as_array().unwrap();
        let named = |name: &str| nodes.iter().rfind(|n| n["name"] == name && n["translation"].is_array());
        let at = |node: &serde_json::Value, k: usize| node["translation"][k].as_f64().unwrap();
        let origin = named("origin").unwrap();
        let accessor = |i: &serde_json::Value| {
            let accessor = &head["accessors"][i.as_u64().unwrap() as usize];
            let view = &head["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
            let from = view["byteOffset"].as_u64().unwrap() as usize;
            let number = move |k: usize| f32::from_le_bytes(data[from + 4 * k..][..4].try_into().unwrap());
            (accessor["count"].as_u64().unwrap() as usize, number)
        };
        let node = named("pillar").unwrap();
        let primitive = &head["meshes"][node["mesh"].as_u64().unwrap() as usize]["primitives"][0];
        let (count, number) = accessor(&primitive["attributes"]["POSITION"]);
        let (_, moved) = accessor(&head["animations"][0]["samplers"][0]["output"]);
        for k in 0..2 {
            let all = (0..count).map(|i| f64::from(number(3 * i + k)));
            let (low, high) = all.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
            let middle = at(origin, k) + at(node, k) + (low + high) / 2.0;
            assert!((middle - pillar[k]).abs() < 1e-4, "{middle}");
            let begin = at(origin, k) + f64::from(moved(k));
            assert!((begin - start[k]).abs() < 1e-4, "{begin}");
        }
    }
    // All others are as they were.
    let easy = Scene::find("easy").unwrap();
    assert_eq!(SceneFile::for_file(&easy).unwrap(), SceneFile::of(&easy).unwrap());
}
