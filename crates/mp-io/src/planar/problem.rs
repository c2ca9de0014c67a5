//! Worlds in the plane and the files they name.

use super::{PlanarFile, PlanarMap, PlanarObstacle, PlanarPart, RosMap};
use mp_formats::error::Error;
use mp_formats::files::{Disk, Files, MAX_MESH_BYTES, MAX_TEXT_BYTES, stem};
use mp_formats::grid::GridMap;
use mp_formats::mesh::MAX_COORDINATE;
use mp_geom::planar::{Polygon, PolygonError};
use nalgebra::{Isometry2, Point2};
use std::path::Path;

/// A world in the plane, all files read.
#[derive(Clone, Debug)]
pub struct PlanarProblem {
    /// The name of the file, without extension.
    pub name: String,
    /// The content of the file.
    pub file: PlanarFile,
    /// The obstacles: those of the file, then that of the image or map, then what is around a map that is turned.
    pub obstacles: Vec<PlanarObstacle>,
    /// Lower and upper corner of walls around everything: those of the file, and the edges of the image or map where nothing is known
    /// outside of it.
    pub walls: Option<[[f64; 2]; 2]>,
    /// Lower and upper corner of the region of the robot's origin: as the file says, else within the walls,
    /// else on the image.
    pub bounds: [[f64; 2]; 2],
}

impl PlanarProblem {
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
        Self::of_bytes(files, path, &files.read(path, MAX_TEXT_BYTES)?)
    }

    /// As [`load_from`](Self::load_from), from the content of the file.
    pub(crate) fn of_bytes(files: &dyn Files, path: &Path, bytes: &[u8]) -> Result<Self, Error> {
        let file = PlanarFile::parse(&path.display().to_string(), bytes)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut obstacles = file.obstacles.clone();
        let (mut walls, mut extent) = (file.walls, None);
        if let Some(map) = &file.map {
            let (polygon, frame) =
                read_map(files, map, file.unknown_is_free, folder).map_err(|e| match e {
                    Fault::File(e) => {
                        let message = format!("this file is not usable: {e}");
                        file.fault(PlanarPart::Map, &message, e.remedy_of_named_file()).with_kind(e.kind())
                    }
                    Fault::Size(message) => {
                        file.fault(PlanarPart::Map, &message, "coordinates are metres: check the scale")
                    }
                })?;
            obstacles.extend(polygon.map(|polygon| PlanarObstacle { name: "the map".into(), polygon }));
            let [low, high] = frame.bounds();
            extent = Some([low.into(), high.into()]);
            // The walls around a picture may be elsewhere than its edges. A map is all that is known.
            let is_all = matches!(map, PlanarMap::Ros(_)) || walls.is_none();
            if is_all && !file.unknown_is_free {
                let [l, h] = walls.map_or([low, high], |walls| walls.map(Point2::from));
                let [l, h] = [l.sup(&low), h.inf(&high)];
                if l.x >= h.x || l.y >= h.y {
                    return Err(file.fault(
                        PlanarPart::World,
                        "the walls and the map have nothing in common",
                        "both are in metres, in the same frame: the map has its own `origin` and `resolution`",
                    ));
                }
                walls = Some([l.into(), h.into()]);
                let around = beside_turned(&frame);
                obstacles.extend(
                    around.map(|polygon| PlanarObstacle { name: "the outside of the map".into(), polygon }),
                );
            }
        }
        let Some(bounds) = file.bounds.or(walls).or(extent) else {
            let message = "the world has no bounds";
            return Err(file.fault(
                PlanarPart::World,
                message,
                "say `walls = [[x, y], [x, y]]`, or `bounds`",
            ));
        };
        crate::trace::problem(&stem(path), obstacles.len());
        Ok(Self { name: stem(path), file, obstacles, walls, bounds })
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

/// What is between a rectangle that is turned and the box around it; `None` if it is not turned.
fn beside_turned(frame: &Polygon) -> Option<Polygon> {
    let corner = |[a, b]: [Point2<f64>; 2]| {
        let side = |c: &Point2<f64>| (b - a).perp(&(c - a));
        let corner = [Point2::new(a.x, b.y), Point2::new(b.x, a.y)].into_iter().find(|c| side(c) < 0.0);
        corner.map(|corner| vec![a, corner, b])
    };
    Polygon::new(frame.edges().filter_map(corner).collect()).ok()
}

/// The polygon of a map, and its edges.
fn read_map(
    files: &dyn Files,
    map: &PlanarMap,
    unknown_is_free: bool,
    folder: &Path,
) -> Result<(Option<Polygon>, Polygon), Fault> {
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
            if grid.with_alpha.is_some() {
                files.note(&image, "transparency counts as for map_server: brightness is the mean of red, green, blue and opacity");
            }
            let polygon = map.outline(&grid, unknown_is_free, &files.interrupt());
            (grid, map.resolution, map.origin, polygon)
        }
    };
    let [width, height] = grid.size.map(|n| n as f64 * scale);
    let frame = Polygon::rectangle([0.0, 0.0], [width, height]);
    let [x, y, yaw] = origin;
    let frame =
        frame.map_err(|e| Fault::Size(e.to_string()))?.transformed(&Isometry2::new([x, y].into(), yaw));
    let [low, high] = frame.bounds();
    if low.coords.amax().max(high.coords.amax()) > MAX_COORDINATE {
        return Err(Fault::Size(format!("the map reaches beyond {MAX_COORDINATE:e} m")));
    }
    let polygon = polygon.map_err(|e| match e {
        PolygonError::Interrupted => Fault::File(Error::interrupted(folder.display())),
        e => Fault::Size(e.to_string()),
    });
    Ok((polygon?, frame))
}
