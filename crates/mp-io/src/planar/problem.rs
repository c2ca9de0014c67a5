//! Worlds in the plane and the files they name.

use super::{GridMap, PlanarFile, PlanarMap, PlanarObstacle, PlanarPart, RosMap};
use crate::error::Error;
use crate::files::{Disk, Files, MAX_MESH_BYTES, MAX_TEXT_BYTES, stem};
use crate::problem::MAX_COORDINATE;
use mp_geom::planar::{Polygon, PolygonError};
use nalgebra::Isometry2;
use std::path::Path;

/// A world in the plane, all files read.
#[derive(Clone, Debug)]
pub struct PlanarProblem {
    /// The name of the file, without extension.
    pub name: String,
    /// The content of the file.
    pub file: PlanarFile,
    /// The obstacles: those of the file, then that of the image or map.
    pub obstacles: Vec<PlanarObstacle>,
    /// Lower and upper corner of the region of the robot's origin: as the file says, else within the walls,
    /// else on the image.
    pub bounds: [[f64; 2]; 2],
}

impl PlanarProblem {
    /// Whether a file is a world in the plane: its name ends in `.toml`, and it has a table `world`.
    #[must_use]
    pub fn is_planar_world(path: &Path) -> bool {
        Self::is_planar_world_in(&Disk, path)
    }

    /// As [`is_planar_world`](Self::is_planar_world), with the file read through `files`.
    #[must_use]
    pub fn is_planar_world_in(files: &dyn Files, path: &Path) -> bool {
        let named = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        let begins = |line: &str| {
            let line = line.trim_start();
            line.starts_with("[world]")
                || line.strip_prefix("world").is_some_and(|l| l.trim_start().starts_with(['=', '.']))
        };
        named
            && files
                .read(path, MAX_TEXT_BYTES)
                .is_ok_and(|bytes| String::from_utf8_lossy(&bytes).lines().any(begins))
    }

    /// Reads a world in the plane, its image or map. File names are relative to the file that has them.
    ///
    /// # Errors
    /// [`Error`] when a file cannot be read or makes no sense, with file, line and column.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::load_from(&Disk, path.as_ref())
    }

    /// As [`load`](Self::load), with the files read through `files`.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_from(files: &dyn Files, path: &Path) -> Result<Self, Error> {
        let file = PlanarFile::parse(&path.display().to_string(), &files.read(path, MAX_TEXT_BYTES)?)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut obstacles = file.obstacles.clone();
        let mut extent = None;
        if let Some(map) = &file.map {
            let (polygon, corners) =
                read_map(files, map, file.unknown_is_free, folder).map_err(|e| match e {
                    Fault::File(e) => {
                        let message = format!("this file is not usable: {e}");
                        file.fault(PlanarPart::Map, &message, e.remedy_of_named_file()).with_kind(e.kind())
                    }
                    Fault::Size(message) => {
                        file.fault(PlanarPart::Map, &message, "coordinates are metres: check the scale")
                    }
                })?;
            extent = Some(corners);
            obstacles.extend(polygon.map(|polygon| PlanarObstacle { name: "the map".into(), polygon }));
        }
        let Some(bounds) = file.bounds.or(file.walls).or(extent) else {
            let message = "the world has no bounds";
            return Err(file.fault(
                PlanarPart::World,
                message,
                "say `walls = [[x, y], [x, y]]`, or `bounds`",
            ));
        };
        Ok(Self { name: stem(path), file, obstacles, bounds })
    }
}

/// The faults of a map.
enum Fault {
    File(Error),
    Size(String),
}

impl From<Error> for Fault {
    fn from(e: Error) -> Self {
        Self::File(e)
    }
}

/// The polygon of a map, and the box around it.
fn read_map(
    files: &dyn Files,
    map: &PlanarMap,
    unknown_is_free: bool,
    folder: &Path,
) -> Result<(Option<Polygon>, [[f64; 2]; 2]), Fault> {
    let grid =
        |place: &Path| GridMap::parse(&place.display().to_string(), &files.read(place, MAX_MESH_BYTES)?);
    let (grid, scale, origin, polygon) = match map {
        PlanarMap::Image { file, scale, origin: [x, y], threshold } => {
            let grid = grid(&folder.join(file))?;
            let dark = |brightness: f32| f64::from(brightness) < 255.0 * threshold;
            let polygon = grid.outline(*scale, [*x, *y], dark, &files.interrupt());
            (grid, *scale, [*x, *y, 0.0], polygon)
        }
        PlanarMap::Ros(name) => {
            let place = folder.join(name);
            let map = RosMap::parse(&place.display().to_string(), &files.read(&place, MAX_TEXT_BYTES)?)?;
            let image = place.parent().unwrap_or(Path::new("")).join(&map.image);
            let grid = grid(&image)?;
            let polygon = map.outline(&grid, unknown_is_free, &files.interrupt());
            (grid, map.resolution, map.origin, polygon)
        }
    };
    let [width, height] = grid.size.map(|n| n as f64 * scale);
    let frame = Polygon::rectangle([0.0, 0.0], [width, height]);
    let [x, y, yaw] = origin;
    let [low, high] = frame
        .map_err(|e| Fault::Size(e.to_string()))?
        .transformed(&Isometry2::new([x, y].into(), yaw))
        .bounds();
    if low.coords.amax().max(high.coords.amax()) > MAX_COORDINATE {
        return Err(Fault::Size(format!("the map reaches beyond {MAX_COORDINATE:e} m")));
    }
    let polygon = polygon.map_err(|e| match e {
        PolygonError::Interrupted => Fault::File(Error::interrupted(folder.display())),
        e => Fault::Size(e.to_string()),
    });
    Ok((polygon?, [low.into(), high.into()]))
}
