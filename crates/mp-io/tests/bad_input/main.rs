//! A table of bad files: what each error says, and where.

mod collada;
mod meshes;
mod ompl_app;
mod paths;
mod scenes;

use mp_io::{Error, PathFile, RigidProblem, read_mesh};
use std::path::Path;

/// Which reader gets the first file of a case.
#[derive(Clone, Copy, PartialEq)]
enum Reader {
    RigidProblem,
    Mesh,
    Path,
}
use Reader::{Mesh, Path as Route, RigidProblem as Scene};

struct Case {
    reader: Reader,
    /// Name and content; the first one is read.
    files: Vec<(&'static str, Vec<u8>)>,
    /// `file:line:column: message; expected …`.
    error: &'static str,
    /// The remedy, or "".
    help: &'static str,
}

fn case(
    reader: Reader,
    name: &'static str,
    content: impl AsRef<[u8]>,
    error: &'static str,
    help: &'static str,
) -> Case {
    Case { reader, files: vec![(name, content.as_ref().to_vec())], error, help }
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
const DAE: &str = "<COLLADA>\n<library_geometries><geometry id=\"g\"><mesh>\n<source id=\"p\"><float_array count=\"9\">0 0 0 1 0 0 0 1 0</float_array></source>\n\
<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\n<triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>\n<p>0 1 2</p></triangles>\n\
</mesh></geometry></library_geometries>\n<library_visual_scenes><visual_scene id=\"s\">\n<node><instance_geometry url=\"#g\"/></node>\n</visual_scene></library_visual_scenes>\n<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n";

fn env(from: &str, to: &str, error: &'static str, help: &'static str) -> Case {
    assert!(ENV.contains(from), "{from}");
    case(Scene, "s.env", ENV.replacen(from, to, 1), error, help)
        .with("r.off", TRIANGLE)
        .with("w.off", TRIANGLE)
}

fn cfg(from: &str, to: &str, error: &'static str, help: &'static str) -> Case {
    assert!(CFG.contains(from), "{from}");
    case(Scene, "s.cfg", CFG.replacen(from, to, 1), error, help)
        .with("r.off", TRIANGLE)
        .with("w.off", TRIANGLE)
}

fn dae(from: &str, to: &str, error: &'static str, help: &'static str) -> Case {
    assert!(DAE.contains(from), "{from}");
    case(Mesh, "m.dae", DAE.replacen(from, to, 1), error, help)
}

fn off(content: &str, error: &'static str, help: &'static str) -> Case {
    case(Mesh, "m.off", content, error, help)
}

fn run(folder: &Path, case: &Case) -> Error {
    for (name, content) in &case.files {
        std::fs::write(folder.join(name), content).unwrap();
    }
    let path = folder.join(case.files[0].0);
    match case.reader {
        Scene => RigidProblem::load(&path).map(drop),
        Mesh => read_mesh(&path).map(drop),
        Route => PathFile::read(&path).map(drop),
    }
    .expect_err("bad input must be refused")
}

fn check(cases: &[Case]) {
    let mut wrong = Vec::new();
    for case in cases {
        let dir = tempfile::tempdir().unwrap();
        let e = run(dir.path(), case);
        let prefix = format!("{}/", dir.path().display());
        let folder = dir.path().display().to_string();
        let clean = |s: &str| s.replace(&prefix, "").replace(&folder, "DIR");
        let (error, help) = (clean(&e.to_string()), clean(e.remedy().unwrap_or_default()));
        if error != case.error || help != case.help {
            wrong.push(format!(
                "{:?}\n    {error:?},\n    {help:?}",
                String::from_utf8_lossy(&case.files[0].1)
            ));
        }
        // Whatever is wrong, showing it must work.

        let picture = e.report();
        assert!(picture.len() < 4000, "{picture}");
    }
    assert!(
        wrong.is_empty(),
        "{} of {} cases differ; they gave\n{}",
        wrong.len(),
        cases.len(),
        wrong.join("\n")
    );
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
    assert_eq!(
        shown(read_mesh(file("gone/none.off")).unwrap_err()),
        "DIR/gone/none.off: cannot read the file: no such file"
    );
    assert_eq!(shown(PathFile::read(dir.path()).unwrap_err()), "DIR: this is a folder, not a file");
    std::fs::create_dir(file("r.off")).unwrap();
    std::fs::write(file("s.env"), ENV).unwrap();
    assert_eq!(
        shown(RigidProblem::load(file("s.env")).unwrap_err()),
        "DIR/s.env:2:1: the mesh of the robot is not readable: DIR/r.off: this is a folder, not a file"
    );
    // As large as no mesh may be; nothing of it is on the disk, and nothing of it is read.
    std::fs::File::create(file("huge.off")).unwrap().set_len(1 << 40).unwrap();
    assert_eq!(
        shown(read_mesh(file("huge.off")).unwrap_err()),
        "DIR/huge.off: the file has 1099511627776 bytes, more than the 536870912 this reader accepts"
    );
    std::fs::File::create(file("huge.env")).unwrap().set_len(1 << 30).unwrap();
    assert!(shown(RigidProblem::load(file("huge.env")).unwrap_err()).contains("more than the 67108864"));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(file("loop.off"), file("loop.off")).unwrap();
        assert!(
            shown(read_mesh(file("loop.off")).unwrap_err())
                .starts_with("DIR/loop.off: cannot read the file: ")
        );
        let e = read_mesh("/dev/zero").unwrap_err();
        assert_eq!(e.message(), "this is not a regular file");
    }
}
