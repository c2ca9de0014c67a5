//! A folder of small scenes, and the program run in it.

use mp_geom::{TriMesh, primitives::cuboid};
use nalgebra::{Isometry3, Translation3};
use serde_json::Value;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

/// A temporary folder with `window.env` (a wall with a wide window), `closed.env` (the same, shut), `plane.env` (a
/// wall in the plane) and their meshes.
pub(crate) struct Dir(tempfile::TempDir);

/// What a finished program left behind.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Run {
    /// Standard output, which is one JSON value on one line.
    pub(crate) fn json(&self) -> Value {
        assert_eq!(self.stdout.lines().count(), 1, "{self:?}");
        serde_json::from_str(&self.stdout).unwrap_or_else(|e| panic!("{e}: {self:?}"))
    }
}

/// Runs the program in `dir`.
pub(crate) fn mp(dir: &Dir, args: &[&str]) -> Run {
    finish(start(dir, args))
}

/// Runs the program in `dir` with `input` on standard input.
pub(crate) fn fed(dir: &Dir, args: &[&str], input: &str) -> Run {
    let mut child = command(dir, args).stdin(Stdio::piped()).spawn().unwrap();
    // A program that does not read it is right to.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    finish(child)
}

pub(crate) fn start(dir: &Dir, args: &[&str]) -> Child {
    start_with(dir, args, &[])
}

/// The same with variables of the environment.
pub(crate) fn start_with(dir: &Dir, args: &[&str], variables: &[(&str, &str)]) -> Child {
    command(dir, args).envs(variables.iter().copied()).spawn().unwrap()
}

/// The same with a standard input that says nothing until it is dropped.
pub(crate) fn start_silent(dir: &Dir, args: &[&str]) -> (Child, std::io::PipeWriter) {
    let (reader, writer) = std::io::pipe().unwrap();
    (command(dir, args).stdin(reader).spawn().unwrap(), writer)
}

/// The same with a standard output that nobody reads.
pub(crate) fn start_unread(dir: &Dir, args: &[&str]) -> Child {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    command(dir, args).stdout(writer).spawn().unwrap()
}

fn command(dir: &Dir, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mp"));
    command.args(args).current_dir(dir.0.path()).env_remove("RUST_LOG");
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

pub(crate) fn finish(child: Child) -> Run {
    let output = child.wait_with_output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Run { code: output.status.code().unwrap_or(-1), stdout: text(output.stdout), stderr: text(output.stderr) }
}

fn block(x: f64, y: f64, z: f64, at: [f64; 3]) -> TriMesh {
    let pose = Isometry3::from_parts(Translation3::from(at), Default::default());
    cuboid(x, y, z).unwrap().transformed(&pose)
}

impl Dir {
    /// A folder with nothing in it.
    pub(crate) fn empty() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn new() -> Self {
        let dir = Self(tempfile::tempdir().unwrap());
        dir.mesh("robot.off", &cuboid(0.8, 0.2, 0.3).unwrap());
        dir.mesh("side.off", &block(0.2, 2.4, 4.0, [0.0, 0.0, 0.0]));
        dir.mesh("sill.off", &cuboid(0.2, 1.2, 1.2).unwrap());
        dir.mesh("lid.off", &cuboid(0.2, 1.2, 1.6).unwrap());
        dir.mesh("fence.off", &cuboid(0.2, 4.0, 1.0).unwrap());
        let ends = "Robot\nrobot.off\n-2 1.4 0.2 0 0 0\n2 1.3 1.8 0.7 0 0\n\n";
        let wall = "Obstacle #1\nside.off\n0 1.8 1 0 0 0\nObstacle #2\nside.off\n0 -1.8 1 0 0 0\n\
                    Obstacle #3\nsill.off\n0 0 -0.4 0 0 0\nObstacle #4\nsill.off\n0 0 2.4 0 0 0\n";
        let bounds = "End\nSpace SE3\nBounds -3 -2.5 -0.5 3 2.5 2.5\n";
        dir.write("window.env", format!("{ends}{wall}{bounds}"));
        let lid = "Obstacle #5\nlid.off\n0 0 1 0 0 0\n";
        dir.write("closed.env", format!("{ends}{wall}{lid}{bounds}"));
        let plane = "Robot\nrobot.off\n-2 0 0 0 0 0\n2 0 0 0.7 0 0\n\nObstacle #1\nfence.off\n0 0.7 0 0 0 0\n\
                     End\nSpace SE2\nBounds -3 -2.5 0 3 2.5 0\n";
        dir.write("plane.env", plane);
        dir
    }

    fn mesh(&self, name: &str, mesh: &TriMesh) {
        mp_io::write_off(self.path(name), mesh).unwrap();
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), text).unwrap();
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub(crate) fn read(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }

    pub(crate) fn exists(&self, name: &str) -> bool {
        self.path(name).exists()
    }

    /// The names in a folder, sorted.
    pub(crate) fn entries(&self, folder: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.path(folder)).unwrap();
        let mut names: Vec<_> =
            entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}
