//! Paths relaxed in fields of choice, and the fields as images.

use mp_cspace::{Path, Rn};
use mp_plan::{Control, Finish, PathRows, RelaxField, Request, Scene};
use nalgebra::Vector2;

/// Fields by name, with a picture of a world in `folder`, whose left half is dark.
fn fields(folder: &tempfile::TempDir) -> Vec<RelaxField> {
    let file = folder.path().join("left.pgm");
    let row = [vec!["0"; 50], vec!["255"; 50]].concat().join(" ");
    std::fs::write(&file, format!("P2 100 40 255\n{}\n", vec![row; 40].join("\n"))).unwrap();
    vec![RelaxField::Clearance, RelaxField::Paper, RelaxField::Risk(1.0), RelaxField::Image(file)]
}

fn relaxed(scene: &Scene, finish: Finish, field: &RelaxField) -> PathRows {
    let request = Request { field: field.clone(), finish, ..Request::new("rrt-connect").seed(2) };
    let report = scene.plan_with(&request, &mut Control::default()).unwrap();
    assert!(report.solved && report.verified, "{field}");
    PathRows { format: scene.path_format(), columns: scene.columns(), rows: report.path.unwrap() }
}

/// The mean energy along a path.
fn energy(scene: &Scene, field: &RelaxField, of: &PathRows, path: &PathRows) -> f64 {
    let image = scene.field(field, &scene.start(), Some(of), None, 500).unwrap();
    let states = path.rows.iter().map(|row| Vector2::new(row[0], row[1])).collect();
    let space = Rn::<2>::new([0.0; 2], [5.0, 2.0]).unwrap();
    let points = Path::straight(states).resampled(&space, 0.01).unwrap().states;
    let at = |p: &Vector2<f64>| {
        let [i, j] = [0, 1].map(|k| ((p[k] - image.origin[k]) / image.cell) as usize);
        let rows = image.energy.len() / image.width;
        image.energy[j.min(rows - 1) * image.width + i.min(image.width - 1)]
    };
    points.iter().map(at).sum::<f64>() / points.len() as f64
}

/// In each field the relaxed path has less of its energy than the path without its detours, and the paths differ from field to
/// field.
#[test]
fn each_field_pushes() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::find("rrs-follow").unwrap();
    let plain = relaxed(&scene, Finish::Shorten, &RelaxField::Clearance);
    let mut paths = Vec::new();
    for field in fields(&folder) {
        let path = relaxed(&scene, Finish::Relax, &field);
        // The risk of both is that of the same path.
        let [before, after] = [&plain, &path].map(|path| energy(&scene, &field, &plain, path));
        assert!(after < 0.9 * before, "{field}: {before} to {after}");
        assert!(!paths.contains(&path.rows), "{field}");
        paths.push(path.rows);
    }
}

/// The image is dark on the left, and the risk is where the path passes an obstacle.
#[test]
fn images_are_where_they_should_be() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::find("rrs-follow").unwrap();
    let path = relaxed(&scene, Finish::Shorten, &RelaxField::Clearance);
    let all = fields(&folder);
    let energy = |field: &RelaxField| scene.field(field, &scene.start(), Some(&path), None, 100).unwrap();
    let [clearance, image] = [energy(&all[0]), energy(&all[3])];
    for (i, (near, both)) in clearance.energy.iter().zip(&image.energy).enumerate() {
        let expected = match i % image.width {
            0..=43 => 1.0,
            44..=55 => continue,
            _ => 0.0,
        };
        assert!((both - near - expected).abs() < 1e-9, "{i}: {both} {near}");
    }
    let risk = energy(&all[2]);
    let more: Vec<f64> = risk.energy.iter().zip(&clearance.energy).map(|(a, b)| a - b).collect();
    let most = more.iter().copied().fold(0.0, f64::max);
    assert!((0.5..=1.0 + 1e-9).contains(&most) && more.iter().all(|r| *r > -1e-9), "{most}");
    // Nothing is at risk far from the path.
    let far = more.iter().enumerate().filter(|(i, _)| {
        let at = [0, 1].map(|k| {
            let cell = if k == 0 { i % risk.width } else { i / risk.width };
            risk.origin[k] + (cell as f64 + 0.5) * risk.cell
        });
        path.rows.iter().all(|row| mp_math::hypot(row[0] - at[0], row[1] - at[1]) > 1.5)
    });
    assert!(far.map(|(_, r)| *r).fold(0.0, f64::max) < 0.05);
}

#[test]
fn what_does_not_suit_is_refused_before_planning() {
    let folder = tempfile::tempdir().unwrap();
    let all = fields(&folder);
    let refused = |scene: &str, field: &RelaxField| {
        let scene = Scene::find(scene).unwrap();
        let request = Request::new(scene.default_planner()).relax(field.clone()).iterations(1);
        let error = scene.plan(&request).unwrap_err();
        assert!(error.remedy().is_some(), "{error}");
        error.to_string()
    };
    for scene in ["cubicles", "arm"] {
        assert!(refused(scene, &all[2]).contains("is for discs and polygons in worlds"), "{scene}");
    }
    assert!(refused("cubicles", &all[3]).contains("is for discs and polygons in worlds"));
    assert!(refused("docks", &all[3]).contains("100 × 40 pixels"));
    assert!(refused("unicycle", &all[0]).contains("moves by inputs"));
    assert!(refused("crossing", &all[0]).contains("no clearance gradient"));
    let missing = RelaxField::Image("nowhere.png".into());
    assert!(refused("rrs-follow", &missing).contains("nowhere.png"));
    let scene = Scene::find("rrs-follow").unwrap();
    let error = scene.field(&all[2], &scene.start(), None, None, 50).unwrap_err();
    assert_eq!(error.remedy(), Some("name a path"));
}
