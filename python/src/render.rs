//! Scenes as pictures, films and pages.

use crate::error::ToPython;
use crate::report::rows;
use crate::scene::Scene;
use mp_io::Content;
use mp_plan::{Film, FilmKind, Look, PICTURE_SIZE, PathRows};
use mp_view::{PathTrack, Planner, SceneFile};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use std::path::Path;
use std::str::FromStr;

/// How a picture is drawn: size, mode, camera, moment, seconds of a film.
pub(crate) type Wanted = (Option<(usize, usize)>, Option<String>, Option<String>, Option<f64>, Option<f64>);

fn look(size: (usize, usize), (wanted, mode, camera, at, _): &Wanted) -> PyResult<Look> {
    let mode = mode
        .as_deref()
        .map(|mode| {
            mode.parse().map_err(|e: <mp_plan::Mode as FromStr>::Err| mp_plan::Error::new(format!("{e}")))
        })
        .transpose();
    let view = camera
        .as_deref()
        .map(|view| {
            view.parse().map_err(|e: <mp_plan::View as FromStr>::Err| mp_plan::Error::new(format!("{e}")))
        })
        .transpose();
    Ok(Look {
        size: wanted.unwrap_or(size),
        mode: mode.to_python()?.unwrap_or_default(),
        view: view.to_python()?.unwrap_or_default(),
        at: *at,
        ..Look::default()
    })
}

impl Scene {
    /// The bytes of a picture or film, whose kind is that of the ending of `file`.
    pub(crate) fn drawn(
        &self,
        py: Python<'_>,
        file: &Path,
        path: Option<PyReadonlyArray2<'_, f64>>,
        caption: &str,
        wanted: &Wanted,
    ) -> PyResult<Option<Vec<u8>>> {
        let path = path.map(|path| self.rows(rows(&path)));
        let cancel = mp_plan::Cancel::new();
        let scene = &self.scene;
        let (bytes, raised) = if let Some(kind) = FilmKind::of(file) {
            let mut film = Film::new(kind);
            film.look = Look { at: None, ..look(film.look.size, wanted)? };
            film.seconds = wanted.4.unwrap_or(film.seconds);
            film.threads = std::thread::available_parallelism().map_or(1, usize::from);
            self.work(py, &cancel, None, |_| scene.film(path.as_ref(), caption, &film, &cancel, &mut |_| ()))?
        } else {
            let kind = scene.picture_kind(file).to_python()?;
            let look = look(PICTURE_SIZE, wanted)?;
            self.work(py, &cancel, None, |_| scene.picture(path.as_ref(), caption, kind, &look).map(Some))?
        };
        raised.map_or(Ok(()), Err)?;
        bytes.to_python()
    }

    /// The scene for viewers, in the format of the ending of `file`; with a report (its JSON form and its path) or a path alone.
    /// A page has this planner.
    pub(crate) fn viewed(
        &self,
        py: Python<'_>,
        file: &Path,
        report: Option<&str>,
        path: Option<PyReadonlyArray2<'_, f64>>,
        seconds: f64,
        planner: Planner<'_>,
    ) -> PyResult<Vec<u8>> {
        let path = path.map(|path| rows(&path));
        let content = Content::of(file).next();
        let report = report.map(mp_plan::Report::from_json).transpose().to_python()?;
        let scene = &self.scene;
        let cancel = mp_plan::Cancel::new();
        let (bytes, raised) = self.work(py, &cancel, None, |_| {
            // A planner of the page says where things are.
            let alone = matches!(planner, Planner::None);
            let mut file = if alone { SceneFile::for_file(scene) } else { SceneFile::of(scene) }?;
            match (report, path) {
                (Some(report), path) => {
                    file.add_report(scene, &mp_plan::Report { path, ..report })?;
                }
                (None, Some(path)) => file.add_path(scene, "path", &self.rows(path))?,
                (None, None) => {}
            }
            Ok::<_, mp_plan::Error>(match content {
                Some(Content::ViewerScene) => file.to_bytes(),
                Some(Content::Gltf) => file.to_glb(seconds),
                _ => mp_view::page(Some(&file), planner).into_bytes(),
            })
        })?;
        raised.map_or(Ok(()), Err)?;
        bytes.to_python()
    }
}

impl Scene {
    /// A path as a message to a page that shows what this program sends.
    pub(crate) fn path_shown(
        &self,
        py: Python<'_>,
        name: &str,
        path: &PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Vec<u8>> {
        let path = self.rows(rows(path));
        let scene = &self.scene;
        let (bytes, raised) = self.work(py, &mp_plan::Cancel::new(), None, |_| {
            let track = scene.track(&path)?;
            // One configuration leads nowhere: what matters is whether it is free.
            let (free, length) = match path.rows.len() {
                1 => (track.clearance.iter().all(|clearance| *clearance > 0.0), 0.0),
                _ => scene.check(&path).map(|verdict| (verdict.free, verdict.path_length))?,
            };
            Ok::<_, mp_plan::Error>(PathTrack::of(name, free, Some(length), track).to_bytes())
        })?;
        raised.map_or(Ok(()), Err)?;
        bytes.to_python()
    }

    pub(crate) fn rows(&self, rows: Vec<Vec<f64>>) -> PathRows {
        PathRows { format: self.scene.path_format(), columns: self.scene.columns(), rows }
    }
}
