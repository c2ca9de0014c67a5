//! Pictures of scenes and paths, made with `mp-render`.

use crate::{BodyShape, Error, PathRows, Scene};
use mp_geom::TriMesh;
use mp_render::palette::{GOAL, INK, MIDDLE, OBSTACLE, PATH, START};
use mp_render::{Drawing, Item};
use nalgebra::{Isometry3, Point2, Point3};
use std::path::Path;

/// The default size of pictures, in pixels.
pub const PICTURE_SIZE: (usize, usize) = (1280, 960);

/// A kind of picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PictureKind {
    /// A PNG: pixels.
    Png,
    /// An SVG: lines and areas. Only for worlds in the plane.
    Svg,
}

impl Scene {
    /// Whether the scene is a world of areas in the plane, which can be drawn as SVG.
    #[must_use]
    pub fn is_planar_world(&self) -> bool {
        self.bodies().iter().any(|body| matches!(body.shape, BodyShape::Area(_)))
    }

    /// The kind of picture for a file, by the ending of its name.
    ///
    /// # Errors
    /// When this scene cannot be drawn as such a file.
    pub fn picture_kind(&self, file: &Path) -> Result<PictureKind, Error> {
        let ending = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        let wrong = |what: String| Err(Error::new(what).help("end its name in .png"));
        match ending.as_str() {
            "png" => Ok(PictureKind::Png),
            "svg" if self.is_planar_world() => Ok(PictureKind::Svg),
            "svg" => wrong(format!("only worlds in the plane are drawn as .svg, not for {}", file.display())),
            "" => wrong(format!("{} has no ending, which says what kind of picture it is", file.display())),
            _ => wrong(format!("cannot write a picture as .{ending}: {}", file.display())),
        }
    }

    /// The bytes of a picture of the scene, with the path if one is given, and `caption` below the name of the scene.
    ///
    /// # Errors
    /// When the path is of another robot, or the size is not possible.
    pub fn picture(
        &self,
        path: Option<&PathRows>,
        caption: &str,
        kind: PictureKind,
        size: (usize, usize),
    ) -> Result<Vec<u8>, Error> {
        let failed = |e: mp_render::RenderError| Error::new(e.to_string());
        Ok(match (self.is_planar_world(), kind) {
            (true, PictureKind::Svg) => self.drawing(path, caption)?.svg(size).map_err(failed)?.into_bytes(),
            (true, PictureKind::Png) => self.drawing(path, caption)?.pixels(size).map_err(failed)?.to_png(),
            (false, _) => self.solid(path, caption)?.draw(size).map_err(failed)?.to_png(),
        })
    }

    /// The picture of a scene in space.
    fn solid(&self, path: Option<&PathRows>, caption: &str) -> Result<mp_render::Scene, Error> {
        let bodies = self.bodies();
        let mesh = |body: &crate::Body| match &body.shape {
            BodyShape::Mesh(mesh) => Some(mesh.clone()),
            _ => None,
        };
        let robot: Vec<TriMesh> = bodies.iter().filter(|b| b.pose.is_none()).filter_map(mesh).collect();
        let still = bodies.iter().filter_map(|body| Some(mp_render::Body::new(&mesh(body)?, body.pose?)));
        // A robot of one body is one model at many poses. A robot of several bodies is merged anew for each configuration.
        let single = match robot.as_slice() {
            [only] => Some(mp_render::Body::new(only, Isometry3::identity())),
            _ => None,
        };
        let shown = |poses: &Vec<Isometry3<f64>>| match (&single, poses.as_slice()) {
            (Some(body), [pose]) => body.at(*pose),
            _ => {
                let placed: Vec<_> =
                    robot.iter().zip(poses).map(|(mesh, pose)| mesh.transformed(pose)).collect();
                TriMesh::merged(placed.iter()).map_or_else(
                    || mp_render::Body::point(poses.last().copied().unwrap_or_default()),
                    |mesh| mp_render::Body::new(&mesh, Isometry3::identity()),
                )
            }
        };
        let sweep = self.sweep(path)?;
        Ok(mp_render::Scene {
            title: self.name().to_owned(),
            subtitle: caption.to_owned(),
            planar: self.is_planar(),
            obstacles: still.collect(),
            start: Some(shown(&sweep.start)),
            goal: Some(shown(&sweep.goal)),
            copies: sweep.between.iter().map(shown).collect(),
            trace: sweep.trace,
            bounds: self.picture_bounds(),
        })
    }

    /// The picture of a world in the plane.
    fn drawing(&self, path: Option<&PathRows>, caption: &str) -> Result<Drawing, Error> {
        let sweep = self.sweep(path)?;
        let (mut low, mut high) = match self.picture_bounds() {
            Some(bounds) => (bounds.min.xy(), bounds.max.xy()),
            None => (Point2::origin(), Point2::new(1.0, 1.0)),
        };
        let (mut items, mut robot, mut walls) = (Vec::new(), Vec::new(), false);
        for body in self.bodies() {
            match (body.shape, body.pose) {
                (BodyShape::Area(rings), None) => robot.push(rings),
                (BodyShape::Area(rings), Some(pose)) => {
                    items.push(Item::area(placed(&rings, &pose), OBSTACLE))
                }
                (BodyShape::Lines(lines), Some(pose)) => {
                    walls = true;
                    let lines = placed(&lines, &pose);
                    for p in lines.iter().flatten() {
                        (low, high) = (low.inf(p), high.sup(p));
                    }
                    items.push(Item::lines(lines, INK, 4.0));
                }
                _ => {}
            }
        }
        if !walls {
            let frame = vec![low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y), low];
            items.push(Item::lines(vec![frame], OBSTACLE, 1.0));
        }
        let at = |poses: &Vec<Isometry3<f64>>, colour: u32| {
            let rings = robot.iter().zip(poses).flat_map(|(rings, pose)| placed(rings, pose)).collect();
            Item::area(rings, colour)
        };
        items.extend(sweep.between.iter().map(|poses| at(poses, MIDDLE).faint(0.3)));
        items.push(Item::lines(vec![sweep.trace.iter().map(Point3::xy).collect()], PATH, 2.5));
        items.extend([at(&sweep.start, START), at(&sweep.goal, GOAL)]);
        Ok(Drawing { title: self.name().to_owned(), subtitle: caption.to_owned(), low, high, items })
    }
}

/// Rings or lines of the plane at a pose.
fn placed(rings: &[Vec<Point2<f64>>], pose: &Isometry3<f64>) -> Vec<Vec<Point2<f64>>> {
    let place = |p: &Point2<f64>| (pose * Point3::new(p.x, p.y, 0.0)).xy();
    rings.iter().map(|ring| ring.iter().map(place).collect()).collect()
}
