//! Scenes are found by name and by file.

use mp_plan::Scene;

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
