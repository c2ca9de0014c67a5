//! A table of bad files: what each error says, and where.

#[path = "../../../mp-formats/tests/bad_input/case.rs"]
mod case;
mod ompl_app;
mod scenes;

use case::{Case, case, check};
use mp_io::{Error, RigidProblem};
use std::path::Path;

fn scene(file: &Path) -> Result<(), Error> {
    RigidProblem::load(file).map(drop)
}

impl Case {
    fn with(mut self, name: &'static str, content: impl AsRef<[u8]>) -> Self {
        self.files.push((name, content.as_ref().to_vec()));
        self
    }
}

const TRIANGLE: &str = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const ENV: &str = "Robot\nr.off\n0 0 0 0 0 0\n5 0 0 0 0 0\n\nObstacle #1\nw.off\n2 0 0 0 0 0\nEnd\n";
const CFG: &str = "[problem]\nrobot=r.off\nworld=w.off\nstart.x=0\nstart.y=0\nstart.theta=0\ngoal.x=1\ngoal.y=1\ngoal.theta=0\n";

fn env(from: &str, to: &str, error: &'static str, help: &'static str) -> Case {
    assert!(ENV.contains(from), "{from}");
    case(scene, "s.env", ENV.replacen(from, to, 1), error, help)
        .with("r.off", TRIANGLE)
        .with("w.off", TRIANGLE)
}

fn cfg(from: &str, to: &str, error: &'static str, help: &'static str) -> Case {
    assert!(CFG.contains(from), "{from}");
    case(scene, "s.cfg", CFG.replacen(from, to, 1), error, help)
        .with("r.off", TRIANGLE)
        .with("w.off", TRIANGLE)
}

#[test]
fn files_that_cannot_be_read() {
    let dir = tempfile::tempdir().unwrap();
    let shown = |e: Error| e.to_string().replace(&dir.path().display().to_string(), "DIR");
    let file = |name: &str| dir.path().join(name);
    assert_eq!(
        shown(RigidProblem::load(file("none.env")).unwrap_err()),
        "DIR/none.env: cannot read the file: no such file"
    );
    std::fs::create_dir(file("r.off")).unwrap();
    std::fs::write(file("s.env"), ENV).unwrap();
    assert_eq!(
        shown(RigidProblem::load(file("s.env")).unwrap_err()),
        "DIR/s.env:2:1: the mesh of the robot is not readable: DIR/r.off: this is a folder, not a file"
    );
    std::fs::File::create(file("huge.env")).unwrap().set_len(1 << 30).unwrap();
    assert!(shown(RigidProblem::load(file("huge.env")).unwrap_err()).contains("more than the 67108864"));
}
