//! Scenes as an editor keeps them, `.mp.json`: figures stay figures, with names, colours and scales.

use crate::environment::{Environment, Obstacle};
use crate::problem::{Body, PlacedBody, RigidProblem, SpaceKind};
use mp_formats::error::{Error, ErrorKind};
use mp_formats::files::{Files, MAX_TEXT_BYTES, decode};
use mp_formats::formats::gempa::gempa_mesh_text;
use mp_formats::formats::off::{OffDocument, off_text};
use mp_formats::mesh::{MAX_COORDINATE, mesh_error, read_mesh_of, solid_mesh, vertex_beyond};
use mp_geom::{Aabb, PrimitiveError, Shape, TriMesh, pose_from_six, short_six_from_pose};
use nalgebra::{Isometry3, Point3};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The version written and read.
const VERSION: u32 = 1;
/// The page that describes the format.
const GUIDE: &str = "the format is described in docs/formats/session.md, “Documents”";
/// A scene of a rigid body, to be edited: our own scene file, `.mp.json`. docs/formats/session.md describes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneDocument {
    /// The version of the format.
    pub version: u32,
    /// What messages and pictures call the scene.
    pub name: String,
    /// The space in which the robot moves.
    pub space: SpaceKind,
    /// The lowest and the highest corner (m) of the box in which the origin of the robot may be; without, around everything.
    #[serde(default)]
    pub bounds: Option<[[f64; 3]; 2]>,
    /// The body that moves.
    pub robot: DocumentBody,
    /// The start: x, y, z (m), α, β, γ (rad), as in GEMPA environments.
    pub start: [f64; 6],
    /// The goal, as the start.
    pub goal: [f64; 6],
    /// The bodies that stand still, each with a pose.
    pub obstacles: Vec<DocumentBody>,
}

/// A body of a [`SceneDocument`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DocumentBody {
    /// What messages and the list of bodies call it.
    pub name: String,
    /// Its colour, `#rrggbb`; without, as viewers like.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub color: Option<String>,
    /// Its geometry before it is scaled.
    pub shape: DocumentShape,
    /// The scale along its own axes, each above zero; without, 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f64; 3]>,
    /// The pose of an obstacle: x, y, z (m), α, β, γ (rad); none for the robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pose: Option<[f64; 6]>,
}

/// A shape of a [`SceneDocument`], about the origin of its body. Lengths are metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum DocumentShape {
    /// A ball with an inside.
    Sphere {
        /// From the middle or the axis to the surface.
        radius: f64,
    },
    /// A box.
    Cube {
        /// The lengths of its sides.
        size: [f64; 3],
    },
    /// A cone about z, apex up.
    Cone {
        /// The radius of its base.
        radius: f64,
        /// From base to apex or from base to base.
        height: f64,
    },
    /// A cylinder about z.
    Cylinder {
        /// From the middle or the axis to the surface.
        radius: f64,
        /// From base to apex or from base to base.
        height: f64,
    },
    /// A torus about z.
    Torus {
        /// The radius of the ring.
        ring: f64,
        /// The radius of the tube, less than that of the ring.
        tube: f64,
    },
    /// A regular tetrahedron.
    Tetrahedron {
        /// The length of its edges.
        edge: f64,
    },
    /// Triangles of a file.
    Mesh {
        /// The name of the mesh file; it must be beside the document only where `off` is missing.
        file: String,
        /// Its triangles as text of an OFF file; without, they are in the file, beside the document.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        off: Option<String>,
        /// Whether it has an inside, as figures have; it must be closed then.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        solid: bool,
    },
}

impl SceneDocument {
    /// Reads `bytes`, the content of a file that errors call `file`.
    ///
    /// # Errors
    /// [`Error`] when it is not a document of this version, with line and column, or a number, colour or name is not valid.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        let text = decode(file, bytes)?;
        let document: Self = mp_formats::json::parse(file, text, "a scene of an editor (.mp.json)", GUIDE)
            .map_err(|e| match e.message().contains("`goals`") {
                true => e.help(
                    "an editor has one goal; rigid problems (.toml) have sets of goals: docs/formats/rigid-problem.md",
                ),
                false => e,
            })?;
        document.check(file)?;
        Ok(document)
    }

    /// Reads the file `path` through `files`. Meshes that it names are not opened.
    ///
    /// # Errors
    /// As [`parse`](Self::parse), or when the file cannot be read.
    pub fn load_from(files: &dyn Files, path: &Path) -> Result<Self, Error> {
        Self::parse(&path.display().to_string(), &files.read(path, MAX_TEXT_BYTES)?)
    }

    /// The text of the file. Numbers have the fewest digits that read back to the same bits.
    #[must_use]
    pub fn to_text(&self) -> String {
        // All members have JSON forms; numbers that are not finite become null, and `check` refuses those.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// The document of a problem. Its meshes are named, not written into it.
    #[must_use]
    pub fn of_problem(problem: &RigidProblem) -> Self {
        let body = |name: &str, file: &Path, mesh: &TriMesh, pose: Option<&Isometry3<f64>>| DocumentBody {
            name: name.to_owned(),
            color: None,
            shape: DocumentShape::Mesh {
                file: file.file_name().map_or_else(|| name.to_owned(), |f| f.to_string_lossy().into_owned()),
                off: None,
                solid: !mesh.solids().is_empty(),
            },
            scale: None,
            pose: pose.map(short_six_from_pose),
        };
        Self {
            version: VERSION,
            name: problem.name.clone(),
            space: problem.space,
            bounds: problem.bounds.map(|b| [b.min.coords.into(), b.max.coords.into()]),
            robot: body(&problem.robot.name, &problem.robot.file, &problem.robot.mesh, None),
            start: short_six_from_pose(&problem.start),
            goal: short_six_from_pose(&problem.goal),
            obstacles: problem
                .obstacles
                .iter()
                .map(|o| body(&o.name, &o.file, &o.mesh, Some(&o.pose)))
                .collect(),
        }
    }

    /// The problem of the document. `mesh` gives the meshes of files that are not written into it.
    ///
    /// # Errors
    /// [`Error`] when a number, colour or name is not valid, a shape is not possible, or a mesh is missing. It calls the
    /// document `file`.
    pub fn problem(
        &self,
        file: &str,
        mesh: &dyn Fn(&str) -> Result<TriMesh, Error>,
    ) -> Result<RigidProblem, Error> {
        self.check(file)?;
        self.problem_among(file, &self.meshes(mesh)?)
    }

    /// The mesh of each body, the robot's first, before it is scaled; `None` for figures. `mesh` gives the meshes of files that
    /// are not written into the document.
    ///
    /// # Errors
    /// [`Error`] when a mesh is missing or not valid, or is to be a solid and is not closed.
    pub fn meshes(
        &self,
        mesh: &dyn Fn(&str) -> Result<TriMesh, Error>,
    ) -> Result<Vec<Option<TriMesh>>, Error> {
        let of = |body: &DocumentBody| {
            let DocumentShape::Mesh { file, off, solid } = &body.shape else { return Ok(None) };
            let own = match off {
                Some(off) => OffDocument::parse(file, off.as_bytes())?.to_mesh(file)?,
                None => mesh(file)?,
            };
            match solid {
                true => solid_mesh(file, own).map(Some),
                false => Ok(Some(own.into_surface())),
            }
        };
        self.bodies().map(of).collect()
    }

    /// The problem of the document, as [`problem`](Self::problem), with `meshes` as [`meshes`](Self::meshes) returns them.
    ///
    /// # Errors
    /// As [`problem`](Self::problem).
    pub fn problem_among(&self, file: &str, meshes: &[Option<TriMesh>]) -> Result<RigidProblem, Error> {
        self.check(file)?;
        let mesh = |body: &DocumentBody, i: usize| body.mesh(file, meshes.get(i).and_then(Option::as_ref));
        let robot = mesh(&self.robot, 0)?;
        let (start, goal) = (pose_from_six(self.start), pose_from_six(self.goal));
        let bounds = self.bounds.map(|[low, high]| Aabb::new(Point3::from(low), Point3::from(high)));
        if let Some(b) = &bounds {
            for (which, six) in [("start", &self.start), ("goal", &self.goal)] {
                if (0..3).any(|i| six[i] < b.min[i] || six[i] > b.max[i]) {
                    return Err(Error::new(
                        ErrorKind::Content,
                        file,
                        format!("the {which} is out of bounds"),
                    )
                    .help("move it, or widen the bounds"));
                }
            }
        }
        let obstacle = |(i, o): (usize, &DocumentBody)| {
            Ok(PlacedBody {
                name: o.name.clone(),
                file: o.shape.file().into(),
                mesh: mesh(o, i + 1)?,
                pose: pose_from_six(o.pose.unwrap_or_default()),
            })
        };
        Ok(RigidProblem {
            name: self.name.clone(),
            space: self.space,
            robot: Body { name: self.robot.name.clone(), file: self.robot.shape.file().into(), mesh: robot },
            obstacles: self.obstacles.iter().enumerate().map(obstacle).collect::<Result<_, Error>>()?,
            start,
            goal,
            bounds,
        })
    }

    /// The document with every mesh written into it, so that its file needs no other.
    ///
    /// # Errors
    /// As [`problem`](Self::problem).
    pub fn with_meshes(mut self, mesh: &dyn Fn(&str) -> Result<TriMesh, Error>) -> Result<Self, Error> {
        for body in self.bodies_mut() {
            if let DocumentShape::Mesh { file, off: off @ None, .. } = &mut body.shape {
                *off = Some(off_text(&mesh(file)?));
            }
        }
        Ok(self)
    }

    /// The same scene as a GEMPA environment: the name and content of each file, the environment first. Figures become
    /// meshes, scales are applied to them, names and colours are lost, and that figures have an inside.
    ///
    /// # Errors
    /// As [`problem`](Self::problem).
    pub fn to_gempa(
        &self,
        name: &str,
        mesh: &dyn Fn(&str) -> Result<TriMesh, Error>,
    ) -> Result<Vec<(String, String)>, Error> {
        let mut meshes: Vec<(&DocumentBody, String)> = Vec::new();
        let mut files = Vec::new();
        self.check(name)?;
        for (body, own) in self.bodies().zip(self.meshes(mesh)?) {
            let same =
                |known: &&(&DocumentBody, String)| known.0.shape == body.shape && known.0.scale == body.scale;
            let file = match meshes.iter().find(same) {
                Some((_, file)) => file.clone(),
                None => {
                    let file = free_name(name, &plain_name(&body.name), &files);
                    files.push((file.clone(), gempa_mesh_text(&body.mesh(name, own.as_ref())?)));
                    file
                }
            };
            meshes.push((body, file));
        }
        let mut names = meshes.into_iter().map(|(_, file)| file);
        let robot = names.next().unwrap_or_default();
        let obstacles = (self.obstacles.iter().zip(names).zip(1..))
            .map(|((o, mesh), number)| Obstacle { number, mesh, pose: o.pose.unwrap_or_default() })
            .collect();
        let environment = Environment {
            robot,
            start: self.start,
            goal: self.goal,
            obstacles,
            space: (self.space != SpaceKind::Se3).then_some(self.space),
            bounds: self.bounds.map(|[[a, b, c], [d, e, f]]| [a, b, c, d, e, f]),
        };
        files.insert(0, (format!("{name}.env"), environment.to_text()));
        Ok(files)
    }

    /// The robot first, then the obstacles.
    pub fn bodies(&self) -> impl Iterator<Item = &DocumentBody> {
        std::iter::once(&self.robot).chain(&self.obstacles)
    }

    /// The robot first, then the obstacles, to be changed.
    pub fn bodies_mut(&mut self) -> impl Iterator<Item = &mut DocumentBody> {
        std::iter::once(&mut self.robot).chain(&mut self.obstacles)
    }

    /// Checks what the types do not say.
    fn check(&self, file: &str) -> Result<(), Error> {
        let wrong = |what: String, help: &str| Err(Error::new(ErrorKind::Content, file, what).help(help));
        if self.version != VERSION {
            let what = format!("the document has version {}; this program reads {VERSION}", self.version);
            return wrong(what, "write it again with this program, or take a newer one");
        }
        for body in self.bodies() {
            let name = &body.name;
            if body.color.as_ref().is_some_and(|color| !is_color(color)) {
                return wrong(format!("{name} has a colour that is not valid"), "write it as #rrggbb");
            }
            if body.scale.iter().flatten().any(|s| !(s.is_finite() && *s > 0.0)) {
                return wrong(
                    format!("{name} has a scale that is not above zero"),
                    "give three numbers above zero",
                );
            }
        }
        if self.robot.pose.is_some() {
            return wrong("the robot has a pose".to_owned(), "give it a start and a goal instead");
        }
        if let Some(body) = self.obstacles.iter().find(|o| o.pose.is_none()) {
            return wrong(format!("{} has no pose", body.name), "give x y z α β γ");
        }
        let mut numbers = self.bounds.iter().flatten().flatten().chain(&self.start).chain(&self.goal);
        let too_large = |v: &f64| v.is_nan() || v.abs() > MAX_COORDINATE;
        let placed = self.obstacles.iter().filter_map(|o| o.pose.as_ref()).flatten().any(too_large);
        if placed || numbers.any(too_large) {
            let what = format!("a pose, an end or the bounds have a number beyond {MAX_COORDINATE:e}");
            return wrong(what, "coordinates are metres, angles radians");
        }
        if let Some([low, high]) = &self.bounds
            && (0..3).any(|i| low[i] > high[i])
        {
            return wrong("the bounds are empty".to_owned(), "the first corner is the lowest");
        }
        let leaves = |six: &[f64; 6]| six[2] != 0.0 || six[4] != 0.0 || six[5] != 0.0;
        if self.space == SpaceKind::Se2 && (leaves(&self.start) || leaves(&self.goal)) {
            let what = "start or goal leaves the plane, but the space is SE2";
            return wrong(what.to_owned(), "write x y 0 α 0 0, or make the space SE3");
        }
        Ok(())
    }
}

impl DocumentBody {
    /// Its mesh, scaled, in its own frame. `own` is its mesh unless it is a figure.
    fn mesh(&self, file: &str, own: Option<&TriMesh>) -> Result<TriMesh, Error> {
        let impossible = |e: PrimitiveError| {
            Error::new(ErrorKind::Content, file, format!("{} cannot be made: {e}", self.name))
                .help("give lengths above zero, metres")
        };
        let made = match self.shape.figure() {
            Some(figure) => figure.mesh().map_err(impossible)?,
            None => own.cloned().ok_or_else(|| {
                let what = format!("the mesh {} is missing", self.shape.file());
                Error::new(ErrorKind::Content, file, what).help("open it first")
            })?,
        };
        let made = match self.scale {
            Some(scale) => made.scaled(scale).map_err(|e| mesh_error(file, &e))?,
            None => made,
        };
        match vertex_beyond(&made) {
            None => Ok(made),
            Some(v) => {
                let what = format!(
                    "{} has a vertex at ({:e}, {:e}, {:e}), beyond {MAX_COORDINATE:e} m",
                    self.name, v.x, v.y, v.z
                );
                Err(Error::new(ErrorKind::Content, file, what).help("coordinates are metres: scale it down"))
            }
        }
    }
}

impl DocumentShape {
    /// The figure that files call `name`, with these lengths (m); `None` when documents do not have it.
    pub(crate) fn of_primitive(name: &str, lengths: &[f64]) -> Option<Self> {
        Some(match (name, lengths) {
            ("sphere", &[radius]) => Self::Sphere { radius },
            ("box", &[x, y, z]) => Self::Cube { size: [x, y, z] },
            ("cone", &[radius, height]) => Self::Cone { radius, height },
            ("cylinder", &[radius, height]) => Self::Cylinder { radius, height },
            ("torus", &[ring, tube]) => Self::Torus { ring, tube },
            ("tetrahedron", &[edge]) => Self::Tetrahedron { edge },
            _ => return None,
        })
    }

    /// The shape of a figure; `None` for a mesh.
    pub(crate) fn figure(&self) -> Option<Shape> {
        match self {
            Self::Sphere { radius } => Shape::primitive("sphere", &[*radius]),
            Self::Cube { size } => Shape::primitive("box", size),
            Self::Cone { radius, height } => Shape::primitive("cone", &[*radius, *height]),
            Self::Cylinder { radius, height } => Shape::primitive("cylinder", &[*radius, *height]),
            Self::Torus { ring, tube } => Shape::primitive("torus", &[*ring, *tube]),
            Self::Tetrahedron { edge } => Shape::primitive("tetrahedron", &[*edge]),
            Self::Mesh { .. } => None,
        }
    }

    /// The file of its mesh; empty for a figure.
    fn file(&self) -> &str {
        match self {
            Self::Mesh { file, .. } => file,
            _ => "",
        }
    }
}

/// Reads the document at `path` and makes its problem; meshes are looked for in its folder.
pub(crate) fn load(files: &dyn Files, path: &Path) -> Result<RigidProblem, Error> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let document = SceneDocument::load_from(files, path)?;
    document.problem(&path.display().to_string(), &|name| read_mesh_of(files, &folder.join(name)))
}

/// Whether a text is a colour, `#rrggbb`.
fn is_color(text: &str) -> bool {
    text.len() == 7 && text.starts_with('#') && text[1..].bytes().all(|b| b.is_ascii_hexdigit())
}

/// A name as a part of a file's name: letters, digits and `_`.
fn plain_name(name: &str) -> String {
    let word: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect();
    let word = word.trim_matches('_');
    if word.is_empty() { "body".to_owned() } else { word.chars().take(40).collect() }
}

/// A name of a mesh file that is not yet among `files`.
fn free_name(scene: &str, word: &str, files: &[(String, String)]) -> String {
    let numbered = (2..).map(|number: u64| format!("{scene}_{word}_{number}.txt"));
    let mut names = std::iter::once(format!("{scene}_{word}.txt")).chain(numbered);
    names.find(|name| files.iter().all(|(file, _)| file != name)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_formats::files::InMemory;

    fn document() -> SceneDocument {
        let body = |name: &str, shape| DocumentBody {
            name: name.into(),
            color: None,
            shape,
            scale: None,
            pose: None,
        };
        let obstacle = |name: &str, shape, pose| DocumentBody { pose: Some(pose), ..body(name, shape) };
        let mut document = SceneDocument {
            version: 1,
            name: "figures".into(),
            space: SpaceKind::Se3,
            bounds: Some([[-5.0; 3], [5.0; 3]]),
            robot: body("robot", DocumentShape::Cube { size: [0.2, 0.1, 0.1] }),
            start: [-2.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            goal: [2.0, 0.0, 0.0, 0.5, 0.1, -0.3],
            obstacles: vec![
                obstacle("a ball", DocumentShape::Sphere { radius: 0.5 }, [0.0; 6]),
                obstacle(
                    "A ball",
                    DocumentShape::Cone { radius: 0.5, height: 1.0 },
                    [0.0, 2.0, 0.0, 0.1, 0.2, 0.3],
                ),
                obstacle(
                    "Röhre",
                    DocumentShape::Cylinder { radius: 0.5, height: 1.0 },
                    [0.0, -2.0, 0.0, 0.0, 0.0, 0.0],
                ),
                obstacle(
                    "ring",
                    DocumentShape::Torus { ring: 0.5, tube: 0.1 },
                    [0.0, 0.0, 2.0, 0.0, 0.0, 0.0],
                ),
                obstacle("four", DocumentShape::Tetrahedron { edge: 0.5 }, [0.0, 0.0, -2.0, 0.0, 0.0, 0.0]),
                obstacle(
                    "bench",
                    DocumentShape::Mesh { file: "bench.off".into(), off: None, solid: false },
                    [0.0, 4.0, 0.0, 0.0, 0.0, 0.0],
                ),
            ],
        };
        document.obstacles[0].color = Some("#12aB34".into());
        document.obstacles[1].scale = Some([1.0, 2.0, 0.5]);
        document
    }

    fn mesh(_: &str) -> Result<TriMesh, Error> {
        Ok(mp_geom::primitives::cuboid(1.0, 0.1, 0.1).unwrap())
    }

    #[test]
    fn a_list_that_is_too_long_is_named() {
        let text = document().to_text().replace("\"goal\": [", "\"goal\": [\n0.5,");
        let error = SceneDocument::parse("d", text.as_bytes()).unwrap_err();
        assert!(
            error.to_string().contains("longer than it should be") && error.remedy().is_some(),
            "{error}"
        );
        let torn = SceneDocument::parse("d", format!("{text} x").as_bytes()).unwrap_err();
        assert!(torn.to_string().contains("this is not JSON"), "{torn}");
    }

    #[test]
    fn reads_back_the_same() {
        let document = document();
        assert_eq!(SceneDocument::parse("d", document.to_text().as_bytes()).unwrap(), document);
        let whole = document.clone().with_meshes(&mesh).unwrap();
        let read = SceneDocument::parse("d", whole.to_text().as_bytes()).unwrap();
        let missing = |name: &str| -> Result<TriMesh, Error> { panic!("{name} is in the document") };
        assert_eq!(read.problem("d", &missing).unwrap(), document.problem("d", &mesh).unwrap());
    }

    /// The GEMPA environment has the same meshes at the same poses.
    #[test]
    fn gempa_environments_read_back_the_same() {
        let document = document();
        let files = document.to_gempa("figures", &mesh).unwrap();
        assert_eq!(files.len(), 8, "{:?}", files.iter().map(|f| &f.0).collect::<Vec<_>>());
        let kept: Vec<(String, &'static [u8])> =
            files.into_iter().map(|(name, text)| (name, &*text.into_bytes().leak())).collect();
        let memory = InMemory(move |name: &str| kept.iter().find(|f| f.0 == name).map(|f| f.1));
        let read = RigidProblem::load_from(&memory, Path::new("figures.env")).unwrap();
        let made = document.problem("d", &mesh).unwrap();
        assert_eq!(
            (read.start, read.goal, read.bounds, read.space),
            (made.start, made.goal, made.bounds, made.space)
        );
        assert_eq!(read.obstacles.len(), made.obstacles.len());
        let corners =
            |mesh: &TriMesh| -> Vec<_> { (0..mesh.triangles().len()).map(|i| mesh.triangle(i)).collect() };
        for (a, b) in read.obstacles.iter().zip(&made.obstacles) {
            assert_eq!(a.pose, b.pose);
            // There are no balls in these files.
            assert_eq!(corners(&a.mesh), corners(&b.mesh.faceted()));
        }
    }

    #[test]
    fn what_is_wrong_is_said() {
        let text = document().to_text();
        let refused = |from: &str, to: &str| {
            assert!(text.contains(from), "{from}");
            let read = SceneDocument::parse("d.mp.json", text.replacen(from, to, 1).as_bytes());
            read.and_then(|d| d.problem("d.mp.json", &mesh)).unwrap_err().to_string()
        };
        assert!(refused("\"version\": 1", "\"version\": 7").contains("version 7"));
        assert!(refused("#12aB34", "url(x)").contains("colour"));
        assert!(refused("\"radius\": 0.5", "\"radius\": -1").contains("a ball cannot be made"));
        assert!(refused("-2.0,", "-2e12,").contains("beyond"));
        assert!(refused("\"scale\"", "\"scal\"").contains("scal"));
        assert!(refused("\"SE3\"", "\"SE9\"").contains("SE9"));
        assert!(refused("\"SE3\"", "\"SE2\"").contains("plane"));
        assert!(refused("\"name\": \"figures\"", "\"nam\": \"figures\"").contains("nam"));
        assert!(SceneDocument::parse("d", b"{").unwrap_err().line().is_some());
        assert!(SceneDocument::parse("d", b"").is_err());
    }
}
