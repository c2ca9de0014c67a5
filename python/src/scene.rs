//! Scenes: loading, planning, checking.

use crate::callback::Calls;
use crate::error::{ToPython, to_python};
use crate::interrupt::{Cancel, Reporter, work};
use crate::own::{self, Own};
use crate::render::Wanted;
use crate::report::{ReportParts, array, parts, rows};
use crate::roadmap::Roadmap;
use mp_geom::TriMesh;
use mp_io::{Content, Disk, Files, Until};
use mp_plan::{
    Control, Interpolation, Interrupt, Knots, Length, Pace, PathFileKind, Request, TimedPath, Trajectory,
    TrajectoryKind,
};
use mp_store::FileId;
use mp_view::Planner;
use nalgebra::Point3;
use numpy::{PyArray1, PyArray2, PyArray3, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Files in memory, and for names that are not there, on the disk if that is wanted.
#[derive(Clone, Debug, Default)]
struct Given {
    files: Arc<BTreeMap<PathBuf, Vec<u8>>>,
    disk: bool,
}

impl Files for Given {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, mp_io::Error> {
        match self.files.get(path) {
            Some(bytes) if bytes.len() as u64 <= limit => Ok(bytes.clone()),
            None if self.disk => Disk.read(path, limit),
            // What errors say of files in memory is in one place.
            found => mp_io::InMemory(|_: &str| found).read(path, limit),
        }
    }
    fn holds(&self, path: &Path) -> bool {
        self.files.contains_key(path) || (self.disk && Disk.holds(path))
    }
    fn absolute(&self, folder: &Path) -> std::io::Result<PathBuf> {
        if self.disk { Disk.absolute(folder) } else { Ok(folder.to_owned()) }
    }
}

/// A scene of `mp-plan`, and where its files are.
#[pyclass(frozen, module = "mp_motion._mp")]
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) scene: mp_plan::Scene,
    given: Given,
    /// The name of a shipped scene.
    shipped: Option<String>,
    /// Where the parts of its motion before it have ended.
    parts: Vec<Vec<f64>>,
    /// Start and goals in place of those of the files, as they were given.
    ends: Option<Ends>,
    /// Of an own robot, the exception that one of its functions raised.
    calls: Option<Calls>,
}

/// Start and goals.
type Ends = (Vec<f64>, Vec<Vec<f64>>);

/// A finished path: its rows, its length, its clearance, whether it was shortened.
type FinishedParts<'py> = (Bound<'py, PyArray2<f64>>, f64, Option<f64>, bool);

/// A request from its JSON form.
pub(crate) fn request(json: &str) -> PyResult<Request> {
    serde_json::from_str(json).map_err(|e| {
        to_python(
            &mp_plan::Error::new(format!("an option is not valid: {}", without_place(&e)))
                .help("see help(mp_motion.Scene.plan) for its options")
                .of_kind(mp_plan::ErrorKind::Request),
        )
    })
}

/// What is wrong with some JSON, without the place in it, as nobody has seen the text.
pub(crate) fn without_place(error: &serde_json::Error) -> String {
    let text = error.to_string();
    text.split_once(" at line ").map_or(text.clone(), |(what, _)| what.to_owned())
}

/// Loads by `job`, which gets what to ask whether to end.
fn loaded(
    py: Python<'_>,
    job: impl FnOnce(Interrupt) -> Result<mp_plan::Scene, mp_plan::Error> + Send,
) -> PyResult<mp_plan::Scene> {
    let cancel = mp_plan::Cancel::new();
    let interrupt = Interrupt::new(cancel.clone());
    let (scene, raised) = work(py, &cancel, None, None, move |_| job(interrupt))?;
    raised.map_or(Ok(()), Err)?;
    scene.to_python()
}

impl Scene {
    /// Does `job`, as [`work`] says.
    pub(crate) fn work<T: Send>(
        &self,
        py: Python<'_>,
        cancel: &mp_plan::Cancel,
        progress: Option<&Py<PyAny>>,
        job: impl FnOnce(Reporter) -> T + Send,
    ) -> PyResult<(T, Option<PyErr>)> {
        work(py, cancel, progress, self.calls.as_ref(), job)
    }

    pub(crate) fn calls(&self) -> Option<&Calls> {
        self.calls.as_ref()
    }
}

#[pymethods]
impl Scene {
    /// The scene that `given` names: a file or a shipped scene.
    #[staticmethod]
    fn find(py: Python<'_>, given: PathBuf) -> PyResult<Self> {
        let scene = loaded(py, |interrupt| mp_plan::Scene::find_until(&given, &interrupt))?;
        let on_disk = !scene.inputs_on_disk().is_empty();
        let shipped = (!on_disk).then(|| given.to_string_lossy().into_owned());
        Ok(Self {
            scene,
            given: Given { disk: on_disk, ..Given::default() },
            shipped,
            parts: Vec::new(),
            ends: None,
            calls: None,
        })
    }

    /// The scene in the file `main` of `files`. Files that are not among them are read from the disk, if `disk` says so.
    #[staticmethod]
    fn from_files(
        py: Python<'_>,
        main: PathBuf,
        files: BTreeMap<PathBuf, Vec<u8>>,
        disk: bool,
    ) -> PyResult<Self> {
        let given = Given { files: Arc::new(files), disk };
        let scene = loaded(py, |interrupt| {
            let scene = mp_plan::Scene::load_from(&Until { files: &given, interrupt }, &main)?;
            Ok(scene)
        })?;
        Ok(Self { scene, given, shipped: None, parts: Vec::new(), ends: None, calls: None })
    }

    /// The scene of an own robot.
    #[staticmethod]
    fn own(robot: own::Given, start: Vec<f64>, goals: Vec<Vec<f64>>) -> PyResult<Self> {
        let (robot, calls) = Own::new(robot, &start, &goals).to_python()?;
        let scene = mp_plan::Scene::new(robot);
        Ok(Self {
            scene,
            given: Given::default(),
            shipped: None,
            parts: Vec::new(),
            ends: None,
            calls: Some(calls),
        })
    }

    /// With another start and other goals.
    fn with_ends(&self, start: Vec<f64>, goals: Vec<Vec<f64>>) -> PyResult<Self> {
        let scene = self.scene.with_ends(&start, &goals).to_python()?;
        Ok(Self { scene, ends: Some((start, goals)), ..self.clone() })
    }

    /// Keeping a clearance (m) from obstacles.
    fn keeping(&self, clearance: f64) -> PyResult<Self> {
        Ok(Self { scene: self.scene.keeping(clearance).to_python()?, ..self.clone() })
    }

    /// How many parts of its motion come after this one.
    #[getter]
    fn parts_left(&self) -> usize {
        self.scene.parts_left()
    }

    /// The next part of its motion, when this one has ended at the row `end`.
    fn next_part(&self, py: Python<'_>, end: Vec<f64>) -> PyResult<Option<Self>> {
        let cancel = mp_plan::Cancel::new();
        let interrupt = Interrupt::new(cancel.clone());
        let next = || self.scene.next_part(&end, &interrupt);
        let (next, raised) = self.work(py, &cancel, None, |_| next())?;
        raised.map_or(Ok(()), Err)?;
        let parts = [&self.parts[..], &[end]].concat();
        Ok(next.to_python()?.map(|scene| Self { scene, parts, ends: None, ..self.clone() }))
    }

    /// The clearance (m) that it keeps.
    #[getter]
    fn clearance_kept(&self) -> f64 {
        self.scene.clearance_kept()
    }

    /// What makes the scene again: the name of a shipped scene or of the main file, the contents of all files, where the parts before it
    /// have ended, other start and goals, and the clearance kept.
    #[expect(clippy::type_complexity, reason = "the state of a pickle, which only `mp_motion` reads")]
    fn state<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Option<String>, Option<PathBuf>, Bound<'py, PyDict>, Vec<Vec<f64>>, Option<Ends>, f64)>
    {
        let files = PyDict::new(py);
        if self.shipped.is_none() {
            for path in self.scene.inputs() {
                let bytes = self.given.read(path, mp_io::MAX_MESH_BYTES).to_python()?;
                files.set_item(path, PyBytes::new(py, &bytes))?;
            }
        }
        let main = self.scene.file().map(Path::to_owned);
        Ok((
            self.shipped.clone(),
            main,
            files,
            self.parts.clone(),
            self.ends.clone(),
            self.scene.clearance_kept(),
        ))
    }

    #[getter]
    fn name(&self) -> &str {
        self.scene.name()
    }

    #[getter]
    fn space(&self) -> String {
        self.scene.space()
    }

    #[getter]
    fn file(&self) -> Option<PathBuf> {
        self.scene.file().map(Path::to_owned)
    }

    #[getter]
    fn default_planner(&self) -> &'static str {
        self.scene.default_planner()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.scene.notes().to_vec()
    }

    /// Name and unit of each number of a configuration.
    fn columns(&self) -> Vec<(String, String)> {
        self.scene.columns().into_iter().map(|column| (column.name, column.unit)).collect()
    }

    /// The least and the largest value of each number; `None` for an angle without limits.
    fn limits(&self) -> Vec<Option<(f64, f64)>> {
        self.scene.limits().into_iter().map(|limits| limits.map(|[low, high]| (low, high))).collect()
    }

    fn details(&self) -> Vec<(String, String)> {
        self.scene.details()
    }

    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.scene.start())
    }

    fn goals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array(py, &self.scene.goals(), self.scene.columns().len())
    }

    fn planners_that_cannot(&self) -> Vec<(&'static str, &'static str)> {
        self.scene.planners_that_cannot()
    }

    fn lint(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let (lint, raised) = self.work(py, &mp_plan::Cancel::new(), None, |_| self.scene.lint())?;
        raised.map_or(Ok(lint), Err)
    }

    fn free_share(&self, py: Python<'_>, samples: u32) -> PyResult<f64> {
        let cancel = mp_plan::Cancel::new();
        let interrupt = Interrupt::new(cancel.clone());
        let (share, raised) =
            self.work(py, &cancel, None, |_| self.scene.free_share_until(samples, &interrupt))?;
        raised.map_or(Ok(share), Err)
    }

    /// The poses (4×4) of the bodies of the robot at a configuration, shape (bodies, 4, 4).
    fn poses<'py>(&self, py: Python<'py>, row: Vec<f64>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let poses = self.scene.poses(&row).to_python()?;
        let matrices: Vec<Vec<Vec<f64>>> = poses
            .iter()
            .map(|pose| pose.to_homogeneous().row_iter().map(|row| row.iter().copied().collect()).collect())
            .collect();
        if matrices.is_empty() {
            return Ok(PyArray3::zeros(py, [0, 4, 4], false));
        }
        PyArray3::from_vec3(py, &matrices).map_err(|e| PyValueError::new_err(e.to_string()))
    }

    /// How often the functions of an own robot were called; zero of other robots.
    fn function_calls(&self) -> u64 {
        self.calls.as_ref().map_or(0, Calls::count)
    }

    /// Plans: a report in parts, and the exception that ended it, if one did.
    #[pyo3(signature = (json, cancel=None, progress=None))]
    fn plan<'py>(
        &self,
        py: Python<'py>,
        json: &str,
        cancel: Option<&Cancel>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(ReportParts<'py>, Option<Py<PyAny>>)> {
        let request = request(json)?;
        let cancel = cancel.map(|c| c.0.clone()).unwrap_or_default();
        let raised = cancel.clone();
        let (report, error) = self.work(py, &cancel, progress.as_ref(), |mut reporter| {
            self.scene.plan_with(&request, &mut Control::new(raised, &mut reporter))
        })?;
        Ok((parts(py, report.to_python()?)?, error.map(|e| e.into_value(py).into_any())))
    }

    /// Plans several routes.
    #[pyo3(signature = (json, count, apart, cancel=None, progress=None))]
    fn routes<'py>(
        &self,
        py: Python<'py>,
        json: &str,
        count: usize,
        apart: &str,
        cancel: Option<&Cancel>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Vec<ReportParts<'py>>, Option<Py<PyAny>>)> {
        let request = request(json)?;
        let apart: Length = apart.parse().to_python()?;
        let cancel = cancel.map(|c| c.0.clone()).unwrap_or_default();
        let raised = cancel.clone();
        let (reports, error) = self.work(py, &cancel, progress.as_ref(), |mut reporter| {
            self.scene.routes(&request, count, apart, &mut Control::new(raised, &mut reporter))
        })?;
        let reports = reports.to_python()?.into_iter().map(|report| parts(py, report));
        Ok((reports.collect::<PyResult<_>>()?, error.map(|e| e.into_value(py).into_any())))
    }

    /// Builds a roadmap.
    #[pyo3(signature = (json, cancel=None, progress=None))]
    fn roadmap(
        &self,
        py: Python<'_>,
        json: &str,
        cancel: Option<&Cancel>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Roadmap> {
        let request = request(json)?;
        let cancel = cancel.map(|c| c.0.clone()).unwrap_or_default();
        let raised = cancel.clone();
        let (roadmap, error) = self.work(py, &cancel, progress.as_ref(), |mut reporter| {
            self.scene.roadmap_with(&request, &mut Control::new(raised, &mut reporter))
        })?;
        error.map_or(Ok(()), Err)?;
        roadmap.to_python().map(|roadmap| Roadmap::new(roadmap, self.calls.clone()))
    }

    /// Finishes a path from elsewhere: the path, its length, its clearance, whether it was shortened; and the exception that ended it.
    #[pyo3(signature = (json, path, cancel=None, progress=None))]
    fn finish<'py>(
        &self,
        py: Python<'py>,
        json: &str,
        path: PyReadonlyArray2<'_, f64>,
        cancel: Option<&Cancel>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<FinishedParts<'py>> {
        let (request, path) = (request(json)?, self.rows(rows(&path)));
        let cancel = cancel.map(|c| c.0.clone()).unwrap_or_default();
        let raised = cancel.clone();
        let (finished, error) = self.work(py, &cancel, progress.as_ref(), |mut reporter| {
            self.scene.finish(&path, &request, &mut Control::new(raised, &mut reporter))
        })?;
        error.map_or(Ok(()), Err)?;
        let finished = finished.to_python()?;
        let path = array(py, &finished.path.rows, self.scene.columns().len())?;
        Ok((path, finished.length, finished.clearance, finished.shortened))
    }

    /// Verifies a path: the JSON form of a verdict.
    fn check(&self, py: Python<'_>, path: PyReadonlyArray2<'_, f64>) -> PyResult<String> {
        let path = self.rows(rows(&path));
        let cancel = mp_plan::Cancel::new();
        let interrupt = Interrupt::new(cancel.clone());
        let (verdict, raised) =
            self.work(py, &cancel, None, |_| self.scene.check_until(&path, &interrupt))?;
        raised.map_or(Ok(()), Err)?;
        json(&verdict.to_python()?)
    }

    /// Times a path, and proves its curve: the trajectory as JSON.
    fn time(
        &self,
        py: Python<'_>,
        path: PyReadonlyArray2<'_, f64>,
        scales: [f64; 3],
        deviation: f64,
    ) -> PyResult<String> {
        let path = self.rows(rows(&path));
        let cancel = mp_plan::Cancel::new();
        let interrupt = Interrupt::new(cancel.clone());
        let [velocity, acceleration, jerk] = scales;
        let pace = Pace { velocity, acceleration, jerk, deviation };
        let (timed, raised) = self.work(py, &cancel, None, |_| self.scene.time(&path, &pace, &interrupt))?;
        raised.map_or(Ok(()), Err)?;
        let TimedPath { trajectory, tightened, clearance, notes, .. } = timed.to_python()?;
        let Knots { times, positions, velocities, accelerations } = trajectory.knots();
        // Infinity, where there is nothing to hit, is no number in JSON.
        let clearance = clearance.is_finite().then_some(clearance);
        json(&serde_json::json!({
            "times": times,
            "positions": positions,
            "velocities": velocities,
            "accelerations": accelerations,
            "curve": trajectory.interpolation().to_string(),
            "clearance": clearance,
            "tightened": tightened,
            "notes": notes,
        }))
    }

    /// A trajectory as the content of a file of this name.
    fn trajectory_bytes<'py>(
        &self,
        py: Python<'py>,
        file: PathBuf,
        times: Vec<f64>,
        positions: PyReadonlyArray2<'_, f64>,
        velocities: PyReadonlyArray2<'_, f64>,
        accelerations: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let Some(kind) = TrajectoryKind::of(&file) else {
            let message = format!("{}: name a file that ends in .csv, .json, .yaml or .mcap", file.display());
            return Err(PyValueError::new_err(message));
        };
        let columns = self.scene.columns();
        let joints = columns.iter().map(|column| (column.name.as_str(), column.unit.as_str()));
        let [positions, velocities, accelerations] = [&positions, &velocities, &accelerations].map(rows);
        let knots = Knots { times, positions, velocities, accelerations };
        let made = Trajectory::of_controller(joints, knots);
        let made = made.map_err(|e| PyValueError::new_err(e.to_string()))?;
        Ok(PyBytes::new(py, &self.scene.trajectory_bytes(&made, kind).to_python()?))
    }

    /// Checks the trajectory in a file, as JSON. `curve` is that between its points, or `controller`.
    fn check_trajectory(&self, py: Python<'_>, file: PathBuf, curve: &str) -> PyResult<String> {
        let curve = match curve {
            "controller" => None,
            "linear" => Some(Interpolation::Linear),
            "cubic" => Some(Interpolation::Cubic),
            "quintic" => Some(Interpolation::Quintic),
            other => {
                let message = format!("the curve is `{other}`, not controller, linear, cubic or quintic");
                return Err(PyValueError::new_err(message));
            }
        };
        let Some(read) = self.scene.read_trajectory(&file, curve).to_python()? else {
            return Err(PyValueError::new_err(format!("{} has no times", file.display())));
        };
        let cancel = mp_plan::Cancel::new();
        let interrupt = Interrupt::new(cancel.clone());
        let (verdict, raised) =
            self.work(py, &cancel, None, |_| self.scene.check_trajectory(&read, &interrupt))?;
        raised.map_or(Ok(()), Err)?;
        json(&verdict.to_python()?)
    }

    /// The certificate of a path as JSON.
    fn certificate(
        &self,
        py: Python<'_>,
        path: PyReadonlyArray2<'_, f64>,
        clearance: f64,
    ) -> PyResult<String> {
        let path = self.rows(rows(&path));
        let cancel = mp_plan::Cancel::new();
        let interrupt = Interrupt::new(cancel.clone());
        let (certificate, raised) =
            self.work(py, &cancel, None, |_| self.scene.certificate(&path, clearance, &interrupt))?;
        raised.map_or(Ok(()), Err)?;
        Ok(certificate.to_python()?.to_json().to_owned())
    }

    /// Explains a configuration, as JSON.
    fn explain(&self, py: Python<'_>, row: Vec<f64>) -> PyResult<String> {
        let (explanation, raised) =
            self.work(py, &mp_plan::Cancel::new(), None, |_| self.scene.explain(&row))?;
        raised.map_or(Ok(()), Err)?;
        json(&explanation.to_python()?)
    }

    /// What is odd about start and goals; an error when one is not free.
    fn check_ends(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let (odd, raised) = self.work(py, &mp_plan::Cancel::new(), None, |_| self.scene.check_ends())?;
        raised.map_or(Ok(()), Err)?;
        odd.to_python()
    }

    /// The text of a path as a file whose kind is that of the ending of `file`.
    fn path_text(&self, file: PathBuf, path: PyReadonlyArray2<'_, f64>) -> PyResult<String> {
        Ok(self.rows(rows(&path)).to_file(PathFileKind::of(&file).to_python()?))
    }

    /// The bytes of a picture or film.
    fn draw(
        &self,
        py: Python<'_>,
        file: PathBuf,
        path: Option<PyReadonlyArray2<'_, f64>>,
        caption: &str,
        wanted: Wanted,
    ) -> PyResult<Option<Vec<u8>>> {
        self.drawn(py, &file, path, caption, &wanted)
    }

    /// What goes into a file of this name: a `path`, what viewers `view`, or something `drawn`.
    #[staticmethod]
    fn kind_of_file(file: PathBuf) -> &'static str {
        match Content::of(&file).find(|content| content.is_path() || content.is_shown()) {
            Some(Content::Page | Content::ViewerScene | Content::Gltf) => "view",
            Some(path) if path.is_path() => "path",
            _ => "drawn",
        }
    }

    /// The scene for viewers.
    fn view(
        &self,
        py: Python<'_>,
        file: PathBuf,
        report: Option<&str>,
        path: Option<PyReadonlyArray2<'_, f64>>,
        seconds: f64,
    ) -> PyResult<Vec<u8>> {
        self.viewed(py, &file, report, path, seconds, Planner::None)
    }

    /// The page that shows what this program sends, with the scene inside.
    fn page(
        &self,
        py: Python<'_>,
        report: Option<&str>,
        path: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<Vec<u8>> {
        self.viewed(py, Path::new("x.html"), report, path, 0.0, Planner::Elsewhere)
    }

    /// A message to that page: a path to show under this name.
    fn path_for_page(
        &self,
        py: Python<'_>,
        name: &str,
        path: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Vec<u8>> {
        self.path_shown(py, name, &path)
    }

    /// Writes a file whole or not at all. It must be none of the files of the scene.
    fn write(&self, py: Python<'_>, file: PathBuf, content: &[u8]) -> PyResult<()> {
        let id = FileId::of(&file);
        if self.scene.inputs_on_disk().iter().any(|input| FileId::of(input) == id) {
            let what = format!("{} is a file of the scene", file.display());
            return Err(to_python(&mp_plan::Error::new(what).help("write to another file")));
        }
        py.detach(|| mp_store::write(&file, content)).to_python()
    }

    /// Configurations at equal distances along a path.
    fn resample<'py>(
        &self,
        py: Python<'py>,
        path: PyReadonlyArray2<'py, f64>,
        count: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let path = self.rows(rows(&path));
        let along = py.detach(|| self.scene.resample(&path, count)).to_python()?;
        array(py, &along, self.scene.columns().len())
    }

    /// Reads a path from a file.
    fn read_path<'py>(&self, py: Python<'py>, file: PathBuf) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let path = py.detach(|| self.scene.read_path(&file)).to_python()?;
        array(py, &path.rows, self.scene.columns().len())
    }

    /// The rows of a table with named columns as rows of numbers of the robot.
    fn named_rows<'py>(
        &self,
        py: Python<'py>,
        names: Vec<String>,
        table: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.scene.named_rows("the table", &names, &rows(&table)).to_python()?;
        array(py, &rows, self.scene.columns().len())
    }
}

/// The JSON form of a result.
pub(crate) fn json(value: &impl serde::Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(|e| PyValueError::new_err(e.to_string()))
}

/// A mesh as the text of an OFF file, with numbers that read back to the same bits.
#[pyfunction]
pub(crate) fn mesh_off<'py>(
    py: Python<'py>,
    vertices: PyReadonlyArray2<'_, f64>,
    triangles: PyReadonlyArray2<'_, u32>,
) -> PyResult<Bound<'py, PyBytes>> {
    let points = |row: numpy::ndarray::ArrayView1<'_, f64>| Point3::new(row[0], row[1], row[2]);
    let vertices = vertices.as_array().rows().into_iter().map(points).collect();
    let triangles = triangles.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
    let text = py.detach(|| TriMesh::new(vertices, triangles).map(|mesh| mp_io::off_text(&mesh)));
    let text = text.map_err(|e| {
        to_python(&mp_plan::Error::new(format!("the mesh is not valid: {e}")).help("see mp_motion.Mesh"))
    })?;
    Ok(PyBytes::new(py, text.as_bytes()))
}

/// Vertices and triangles of a mesh.
type MeshArrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

/// Vertices and triangles of a mesh file.
#[pyfunction]
pub(crate) fn read_mesh<'py>(py: Python<'py>, file: PathBuf) -> PyResult<MeshArrays<'py>> {
    let mesh = py.detach(|| mp_io::read_mesh(&file)).to_python()?;
    let vertices = mesh.vertices().iter().flat_map(|v| [v.x, v.y, v.z]).collect();
    let triangles = mesh.triangles().iter().flatten().copied().collect();
    let shape = |e: numpy::ndarray::ShapeError| PyValueError::new_err(e.to_string());
    let vertices =
        numpy::ndarray::Array2::from_shape_vec((mesh.vertices().len(), 3), vertices).map_err(shape)?;
    let triangles =
        numpy::ndarray::Array2::from_shape_vec((mesh.triangles().len(), 3), triangles).map_err(shape)?;
    Ok((PyArray2::from_owned_array(py, vertices), PyArray2::from_owned_array(py, triangles)))
}
