//! Scene files of every kind of scene: written, read, animated, and broken on purpose.

use mp_plan::{Request, Scene};
use mp_view::{Bends, PathTrack, Roadmap, Role, SceneFile, Tree, ViewError};
use proptest::prelude::*;
use std::sync::OnceLock;

fn planned(name: &str) -> (Scene, SceneFile) {
    let scene = Scene::find(name).unwrap();
    let report = scene.plan(&Request::new("rrt-connect").seed(1)).unwrap();
    assert!(report.solved, "{name}: {:?}", report.why);
    let mut file = SceneFile::of(&scene).unwrap();
    file.add_report(&scene, &report).unwrap();
    (scene, file)
}

/// A file with everything in it.
fn full() -> &'static SceneFile {
    static FILE: OnceLock<SceneFile> = OnceLock::new();
    FILE.get_or_init(|| {
        let (_, mut file) = planned("easy");
        file.trees.push(Tree {
            name: "start".into(),
            nodes: vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
            parents: vec![-1, 0],
            bends: Bends { nodes: vec![1, 2], through: vec![0.0, 1.5, 2.0, 1.0, 4.0, 5.0] },
        });
        file.bodies[1].color = Some([0, 127, 255]);
        file.roadmap = Some(Roadmap {
            nodes: vec![0.0; 9],
            edges: vec![0, 2],
            component: vec![0, 1, 0],
            kind: vec![0, 1, 2],
        });
        file
    })
}

/// Bodies, ends and paths of a rigid body, an arm, and robots of the plane: read back the same, and as the scene has them.
#[test]
fn every_kind_of_scene_is_read_back() {
    for name in ["easy", "arm", "rrs-low"] {
        let (scene, file) = planned(name);
        let bytes = file.to_bytes();
        assert_eq!(bytes, file.to_bytes());
        assert_eq!(SceneFile::parse(&bytes).unwrap(), file, "{name}");
        assert_eq!(file.bodies.len(), scene.bodies().len());
        assert_eq!(file.start.row, scene.start());
        let robots = file.bodies.iter().filter(|body| body.role != Role::Obstacle).count();
        let path = &file.paths[0];
        let count = path.trace.len() / 3;
        assert!(path.verified && count > 10 && path.poses.len() == 7 * robots * count, "{name}");
        // From start to goal, clear all along.
        let columns = file.columns.len();
        let near = |row: &[f64], end: &[f64]| row.iter().zip(end).all(|(a, b)| (a - b).abs() < 1e-3);
        let (first, last) = (&path.rows[..columns], &path.rows[columns * (count - 1)..]);
        assert!(near(first, &file.start.row), "{name}: {first:?}");
        assert!(file.goals.iter().any(|goal| near(last, &goal.row)), "{name}: {last:?}");
        assert!(path.clearance.as_ref().unwrap().iter().all(|c| *c > 0.0), "{name}");
    }
}

/// Poses between neighbours may be interpolated linearly: the robot moves little from one to the next.
#[test]
fn tracks_are_fine_enough_for_a_film() {
    let (_, file) = planned("easy");
    let path = &file.paths[0];
    let size = (0..3).map(|i| file.bounds[1][i] - file.bounds[0][i]).fold(0.0, f64::max) as f32;
    for pair in path.poses.chunks_exact(7).collect::<Vec<_>>().windows(2) {
        let step =
            (0..3).map(|i| mp_math::powi(f64::from(pair[1][i] - pair[0][i]), 2)).sum::<f64>().sqrt() as f32;
        let dot = (3..7).map(|i| pair[1][i] * pair[0][i]).sum::<f32>().abs();
        assert!(step < 0.03 * size && dot > 0.99, "{step} of {size}, {dot}");
    }
}

#[test]
fn files_that_do_not_fit_are_refused_with_a_reason() {
    let refused = |bytes: &[u8]| SceneFile::parse(bytes).unwrap_err();
    let bytes = full().to_bytes();
    assert_eq!(refused(b""), ViewError::NotAScene);
    assert_eq!(refused(b"OFF\n8 12 0"), ViewError::NotAScene);
    assert!(matches!(refused(&bytes[..6]), ViewError::CutOff { .. }));
    assert!(matches!(refused(&bytes[..100]), ViewError::CutOff { .. }));
    assert!(matches!(refused(&bytes[..bytes.len() - 8]), ViewError::Array { .. }));
    let head = u32::from_le_bytes(bytes[4..8].try_into().unwrap()) as usize;
    let json = std::str::from_utf8(&bytes[8..8 + head]).unwrap();
    let text = |from: &str, to: &str| {
        assert!(json.contains(from), "{from}");
        let json = json.replacen(from, to, 1);
        let mut other = b"MPV1".to_vec();
        other.extend((json.len() as u32).to_le_bytes());
        other.extend(json.as_bytes());
        other.extend(&bytes[8 + head..]);
        other
    };
    assert_eq!(
        refused(&text("\"version\":1", "\"version\":9")),
        ViewError::Version { found: 9, expected: 1 }
    );
    assert!(matches!(refused(&text("\"name\"", "\"nome\"")), ViewError::Head { .. }));
    assert!(matches!(refused(&text("\"mesh\":0", "\"mesh\":999")), ViewError::Array { .. }));
    for color in ["", "#007ff", "007fff", "#007fff0", "#+07fff", "#00é7f"] {
        assert!(matches!(refused(&text("#007fff", color)), ViewError::Array { .. }), "{color}");
    }
    assert!(matches!(refused(&text("\"type\":\"f32\"", "\"type\":\"u8\"")), ViewError::Array { .. }));
    // The same array many times would take memory out of proportion.
    let mesh = json.split_once("\"meshes\":[").unwrap().1.split_once("}}").unwrap().0;
    let again = format!("{mesh}}}}},").repeat(1000) + mesh;
    let many = refused(&text(mesh, &again)).to_string();
    assert!(many.contains("in the place of another array"), "{many}");
    // Members of later versions are ignored.
    assert_eq!(&SceneFile::parse(&text("{\"version\":1,", "{\"version\":1,\"later\":[1],")).unwrap(), full());
}

#[test]
fn indices_and_counts_are_checked() {
    type Break = fn(&mut SceneFile);
    let breaks: [Break; 14] = [
        |file| file.meshes[0].triangles[0] = u32::MAX,
        |file| file.meshes[0].positions.truncate(4),
        |file| file.trees[0].parents[1] = 2,
        |file| file.trees[0].parents[1] = -2,
        |file| file.trees[0].bends.nodes[0] = 2,
        |file| file.trees[0].bends.nodes[1] = u32::MAX,
        |file| file.trees[0].bends.nodes.truncate(1),
        |file| file.trees[0].bends.nodes.extend([0, 0]),
        |file| file.paths[0].travel = Some(vec![0.0; 3]),
        |file| file.paths[0].corners = Some(vec![u32::MAX]),
        |file| file.roadmap.as_mut().unwrap().edges[0] = 3,
        |file| file.start.row.clear(),
        |file| file.paths[0] = PathTrack { trace: vec![0.0; 3], ..PathTrack::default() },
        |file| file.bodies[0].pose = Some([0.0; 7]),
    ];
    for (i, change) in breaks.into_iter().enumerate() {
        let mut file = full().clone();
        change(&mut file);
        assert!(matches!(SceneFile::parse(&file.to_bytes()), Err(ViewError::Array { .. })), "{i}");
    }
}

proptest! {
    /// Whatever happens to the bytes, reading gives a scene or an error.
    #[test]
    fn broken_bytes_never_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8), keep in any::<prop::sample::Index>(), cut in any::<bool>()) {
        let mut bytes = full().to_bytes();
        for (index, byte) in changes {
            // Most of them in the head, where they matter.
            let end = if byte % 4 == 0 { bytes.len() } else { bytes.len().min(4_000) };
            bytes[index.index(end)] = byte;
        }
        if cut {
            bytes.truncate(keep.index(bytes.len()));
        }
        if let Ok(file) = SceneFile::parse(&bytes) {
            prop_assert_eq!(SceneFile::parse(&file.to_bytes()).unwrap().meshes.len(), file.meshes.len());
        }
    }
}
