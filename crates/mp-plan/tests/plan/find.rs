//! Scenes are found by name and by file; outputs are no inputs.

use mp_plan::{Claims, Scene};
use std::path::Path;

#[test]
fn shipped_scenes_are_found_by_name_and_are_sound() {
    for name in Scene::shipped() {
        let scene = Scene::find(name).unwrap_or_else(|e| panic!("{}", e.report()));
        assert_eq!(scene.name(), name);
        scene.check_ends().unwrap_or_else(|e| panic!("{}", e.report()));
    }
    let e = Scene::find("cubicels").unwrap_err();
    assert!(e.remedy().is_some_and(|help| help.contains("cubicles")), "{e:?}");
    assert!(Scene::find("no/such/thing/at/all").is_err());
}

#[test]
fn files_come_first_with_or_without_ending() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("easy.env"), "nonsense").unwrap();
    for name in ["easy", "easy.env"] {
        let e = Scene::find(dir.path().join(name)).unwrap_err();
        assert!(e.file().is_some_and(|file| file.file().ends_with("easy.env")), "{e:?}");
    }
    assert!(Scene::find(dir.path()).unwrap_err().message().contains("is a folder"));
}

#[test]
fn near_names_are_found_and_far_ones_are_not() {
    for (given, meant) in [
        ("cubicle", Some("cubicles")),
        ("esay", Some("easy")),
        ("qubikles", Some("cubicles")),
        ("zebra", None),
    ] {
        let e = Scene::find(given).unwrap_err();
        let help = e.remedy().unwrap_or_default();
        let similar =
            Scene::shipped().into_iter().find(|name| help.contains(&format!("did you mean `{name}`?")));
        assert_eq!(similar, meant, "{given}: {help}");
    }
}

/// A path in a file of the name of a scene does not hide the scene.
#[test]
fn paths_do_not_hide_scenes() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(dir.path().join(name), text).unwrap();
    let path = "\n 2 7\n-1 0.3 0.2 -0.4 0.3 0 0.35\n0.9 0.1 0 0.6 0 0 0.36\n";
    write("own.txt", path);
    let e = Scene::find(dir.path().join("own")).unwrap_err();
    assert!(e.remedy().is_some_and(|help| help.contains("own.txt is a path")), "{e:?}");
    write("own.toml", "[robot]\nbox = [1, 1, 1]\n");
    let e = Scene::find(dir.path().join("own")).unwrap_err();
    assert!(e.file().is_some_and(|file| file.file().ends_with("own.toml")), "{e:?}");
    // A scene that ends in .txt is found, and a faulty one too.
    write("wall.txt", "Rob\n");
    let e = Scene::find(dir.path().join("wall")).unwrap_err();
    assert!(e.file().is_some_and(|file| file.file().ends_with("wall.txt")), "{e:?}");
}

#[test]
fn outputs_are_no_inputs_and_no_other_outputs() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    std::fs::write(at("scene"), "").unwrap();
    let mut claims = Claims::default();
    claims.input(&at("scene"));
    claims.input(&at("scene"));
    let refused = claims.output("--out", &at("./scene")).unwrap_err();
    assert!(refused.message().contains("overwrite the input"), "{refused}");
    claims.output("--out", &at("new/path")).unwrap();
    let refused = claims.output("--roadmap", &at("new/./path")).unwrap_err();
    assert!(refused.message().contains("--out"), "{refused}");
    // Whoever lets one option have standard output does not add it.
    let refused = claims.output("--picture", Path::new("-")).unwrap_err();
    assert!(refused.message().contains("standard output has other content"), "{refused}");
    assert!(claims.output("--out", dir.path()).is_err());
}
