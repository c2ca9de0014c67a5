//! What a session has open, and the requests about it.

use super::files::{Named, endings, format_of, plain_name};
use super::mesh::{is_mesh, scene_of_mesh};
use super::times::trajectory_of;
use super::{number_of, text_of};
use crate::bytes::{path_head, rgb};
use crate::message::{Message, json};
use crate::{PathTrack, Role, SceneFile, Shape};
use mp_geom::TriMesh;
use mp_io::{Content, Disk, DocumentShape, FORMATS, Files, ProblemDocument, SceneDocument};
use mp_plan::{
    EditedScene, Error, Interrupt, MetricName, PathFileKind, PathRows, Request, Scene, SceneProblem,
    TrajectoryKind, brief,
};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a session begins with.
#[derive(Clone, Debug, Default)]
pub struct Opening {
    /// The scene that is open at the beginning.
    pub scene: Option<Scene>,
    /// A path through it.
    pub path: Option<PathRows>,
    /// A scene file that is shown at the beginning when no scene is open. The session cannot plan in it.
    pub shown: Option<SceneFile>,
    /// The folder in which files are saved; without one, the page gets their content.
    pub folder: Option<PathBuf>,
    /// What draws a scene as a small PNG, for the gallery; without it, the gallery has words only.
    pub thumbnail: Option<Thumbnail>,
}

/// How long a path takes in a file of meshes that move, seconds: as in a film of `mp render`.
const GLB_SECONDS: f64 = 8.0;

/// A scene as a small picture: the bytes of a PNG.
pub type Thumbnail = fn(&Scene) -> Result<Vec<u8>, Error>;

/// The scene that is open.
#[derive(Clone, Debug)]
pub(crate) struct Open {
    pub(crate) scene: Scene,
    /// What can be edited. Its meshes are in `meshes`.
    document: Option<Document>,
    /// The problem that a [`Document::Problem`] changes.
    problem: Option<Arc<SceneProblem>>,
    /// What of it is not edited, and what can be done instead.
    unedited: Option<String>,
    path: Option<PathRows>,
}

/// What can be edited of a scene.
#[derive(Clone, Debug, serde::Serialize)]
#[serde(untagged)]
enum Document {
    /// All of a rigid body among meshes.
    Scene(Box<SceneDocument>),
    /// Obstacles and ends of a problem in TOML.
    Problem(ProblemDocument),
}

/// What a session has open.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    pub(crate) open: Option<Open>,
    /// Meshes by the names that documents call them.
    meshes: BTreeMap<String, TriMesh>,
    folder: Option<PathBuf>,
    /// What is shown when nothing is open.
    shown: Option<SceneFile>,
    thumbnail: Option<Thumbnail>,
}

type Answer = Result<Message, Error>;

impl Workspace {
    pub(crate) fn new(opening: Opening) -> Self {
        let Opening { scene, path, shown, folder, thumbnail } = opening;
        let mut workspace = Self { folder, shown, thumbnail, ..Self::default() };
        if let Some(scene) = scene {
            let (files, on_disk): (Arc<dyn Files>, _) = match scene.files().shipped {
                true => (Arc::new(mp_plan::shipped_files()), false),
                false => (Arc::new(Disk), true),
            };
            workspace.adopt(scene, files, on_disk, path);
        }
        workspace
    }

    /// The reply to a request.
    pub(crate) fn answer(&mut self, request: &Message) -> Answer {
        match text_of(&request.head, "do")? {
            "hello" => self.hello(),
            "open" => self.open(request),
            "edit" => self.edit(request),
            "mesh" => self.mesh(request),
            "thumbnail" => self.thumbnail(request),
            "path" => self.path(request),
            "check" => self.check(request),
            "reach" => self.reach(request),
            "next" => self.next(request),
            "field" => self.field(request),
            "save" => self.save(request),
            "save_path" => self.save_path(request),
            "save_trajectory" => self.save_trajectory(request),
            "export" => self.export(request),
            other => Err(Error::new(format!("there is no request `{other}`"))
                .help("docs/formats/session.md lists them: is the page of another version?")),
        }
    }

    pub(crate) fn opened(&self) -> Result<&Open, Error> {
        self.open.as_ref().ok_or_else(|| Error::new("no scene is open").help("open one, or begin a new one"))
    }

    fn hello(&self) -> Answer {
        let parameters = |parameters: &[mp_plan::Parameter]| {
            let one = |p: &mp_plan::Parameter| json!({"name": p.name, "default": p.default, "range": p.range, "summary": p.doc});
            parameters.iter().map(one).collect::<Vec<_>>()
        };
        let roadmaps = mp_plan::roadmap_planners();
        let planner = |info: &mp_plan::PlannerInfo| {
            let family = if roadmaps.iter().any(|r| r.name == info.name) { "roadmap" } else { "tree" };
            json!({
                "name": info.name, "aliases": info.aliases, "summary": info.summary, "family": family,
                "citation": info.citation, "parameters": parameters(info.parameters),
            })
        };
        let meta = mp_plan::meta_planners().iter().map(|meta| {
            json!({
                "prefix": meta.prefix, "summary": meta.summary, "around": meta.around,
                "parameters": parameters(meta.parameters),
            })
        });
        let gallery: Vec<Value> = Scene::gallery()
            .into_iter()
            .map(|(title, scenes)| json!({"title": title, "scenes": scenes}))
            .collect();
        let metrics =
            MetricName::ALL.iter().map(|(_, name, formula)| json!({"name": name, "formula": formula}));
        let mut reply = Message::default()
            .with("planners", mp_plan::planners().map(planner).collect::<Vec<_>>())
            .with("meta_planners", meta.collect::<Vec<_>>())
            .with("metrics", metrics.collect::<Vec<_>>())
            .with("request", json(&Request::default()))
            .with("scenes", Scene::shipped())
            .with("gallery", json(&gallery))
            .with("thumbnails", self.thumbnail.is_some())
            .with("endings", json(&endings()))
            .with("folder", self.folder.as_ref().map(|folder| folder.display().to_string()));
        let opened = match (&self.open, &self.shown) {
            (Some(open), _) => Value::Object(self.described(open, &mut reply)?),
            (None, Some(file)) => {
                let note = "this file only shows: to plan, open the scene that it was made from";
                json!({"scene": reply.array(&file.to_bytes()), "document": null, "warnings": [note]})
            }
            (None, None) => Value::Null,
        };
        reply.set("opened", opened);
        Ok(reply)
    }

    /// Opens the scene with a shipped name, or that of the files of the request.
    fn open(&mut self, request: &Message) -> Answer {
        let (scene, files): (_, Arc<dyn Files>) = match request.head.get("scene").and_then(Value::as_str) {
            Some(name) => (shipped(name)?, Arc::new(mp_plan::shipped_files())),
            None => {
                let files = Named::of(request)?;
                let main = match request.head.get("main").and_then(Value::as_str) {
                    Some(name) => name,
                    None => files.scene()?,
                };
                let main = Path::new(main);
                let scene = match is_mesh(main, files.content(&main.to_string_lossy())) {
                    true => scene_of_mesh(&files, main)?,
                    false => Scene::load_from(&files, main)?,
                };
                (scene, Arc::new(files))
            }
        };
        self.adopt(scene, files, false, None);
        self.reply()
    }

    /// A small picture of a shipped scene.
    fn thumbnail(&self, request: &Message) -> Answer {
        let draw = self.thumbnail.ok_or_else(|| Error::new("nothing here draws pictures"))?;
        let png = draw(&shipped(text_of(&request.head, "scene")?)?)?;
        let mut reply = Message::default();
        let png = reply.array(&png);
        Ok(reply.with("png", png))
    }

    /// Takes a scene as the one that is open. It was read from `files`, on the disk or in memory.
    fn adopt(&mut self, scene: Scene, files: Arc<dyn Files>, on_disk: bool, path: Option<PathRows>) {
        if let Some(EditedScene { mut document, meshes }) = scene.document() {
            for (body, mesh) in document.bodies_mut().zip(meshes) {
                if let (DocumentShape::Mesh { file, .. }, Some(mesh)) = (&mut body.shape, mesh) {
                    *file = self.name_mesh(file, mesh);
                }
            }
            let document = Some(Document::Scene(Box::new(document)));
            self.open = Some(Open { scene, document, problem: None, unedited: None, path });
            return;
        }
        let (problem, unedited) = match scene.problem(files, on_disk) {
            Ok(problem) => {
                let pixels = "The pixels of the map are not edited here: add obstacles beside them, or change the image.";
                let has_map = problem.has_map().unwrap_or(false);
                (Some(Arc::new(problem)), has_map.then(|| pixels.to_owned()))
            }
            Err(e) => (None, Some(not_edited(&e))),
        };
        let document = problem.as_ref().map(|problem| Document::Problem(problem.document().clone()));
        self.open = Some(Open { scene, document, problem, unedited, path });
    }

    /// Keeps a mesh, and returns the name by which documents call it: that of its file, unless another mesh has it.
    fn name_mesh(&mut self, file: &str, mesh: TriMesh) -> String {
        let numbered = (2..).map(|number: u64| format!("{number}_{file}"));
        for name in std::iter::once(file.to_owned()).chain(numbered) {
            match self.meshes.get(&name) {
                Some(known) if *known != mesh => {}
                Some(_) => return name,
                None => {
                    self.meshes.insert(name.clone(), mesh);
                    return name;
                }
            }
        }
        file.to_owned()
    }

    /// Makes the scene of an edited document.
    fn edit(&mut self, request: &Message) -> Answer {
        let document = self.document(request)?;
        let meshes = &self.meshes;
        let mesh = |name: &str| known_mesh(meshes, name);
        let scene = match (&document, &self.open) {
            (Document::Scene(document), Some(open)) => {
                open.scene.edited(SceneDocument::clone(document), &mesh)?
            }
            (Document::Scene(document), None) => Scene::from_document(SceneDocument::clone(document), &mesh)?,
            (Document::Problem(document), _) => {
                self.problem()?.edited(document, &mesh, &self.opened()?.scene)?
            }
        };
        // A document of a rigid body says all of it.
        let of_problem = self.open.as_ref().filter(|_| matches!(document, Document::Problem(_)));
        let (problem, unedited) =
            of_problem.map_or((None, None), |open| (open.problem.clone(), open.unedited.clone()));
        self.open = Some(Open { scene, document: Some(document), problem, unedited, path: None });
        self.reply()
    }

    /// The problem that is edited.
    fn problem(&self) -> Result<&SceneProblem, Error> {
        self.opened()?.problem.as_deref().ok_or_else(|| {
            Error::new("this document is of a problem in a file, and none is open")
                .help("open the problem that it was made from")
        })
    }

    fn document(&self, request: &Message) -> Result<Document, Error> {
        let document = request.head.get("document").cloned().unwrap_or_default();
        let read = match document.get("plane") {
            Some(_) => serde_json::from_value(document).map(Document::Problem),
            None => serde_json::from_value(document).map(Document::Scene),
        };
        read.map_err(|e| {
            Error::new(format!("this is no document: {e}"))
                .help("docs/formats/session.md describes documents")
        })
    }

    /// The reply of `open` for what is open.
    fn reply(&self) -> Answer {
        let mut reply = Message::default();
        reply.head = self.described(self.opened()?, &mut reply)?;
        Ok(reply)
    }

    /// What is open, with arrays in `message`.
    fn described(&self, open: &Open, message: &mut Message) -> Result<serde_json::Map<String, Value>, Error> {
        let mut file = self.scene_file(open)?;
        if let Some(path) = &open.path {
            file.add_path(&open.scene, "path", path)?;
        }
        let mut members = serde_json::Map::new();
        members.insert("written".to_owned(), json(&open.path.as_ref().map(|path| &path.rows)));
        members.insert("scene".to_owned(), message.array(&file.to_bytes()));
        members.insert("document".to_owned(), json(&open.document));
        members.insert("unedited".to_owned(), json(&open.unedited));
        let wrong = open.scene.wrong_ends();
        let odd = open.scene.lint().into_iter().filter(|found| !wrong.contains(found));
        let far = file.far().map(|middle| {
            let away = middle.amax();
            format!(
                "the scene is {} m away from the origin, and the page draws with numbers of 32 bits: bodies are shown up to {} m \
                 off. Plans, files and pictures of `mp` are exact",
                brief(away),
                brief(away * f64::from(f32::EPSILON))
            )
        });
        let notes: Vec<String> = open.scene.notes().iter().cloned().chain(odd).chain(far).collect();
        members.insert("warnings".to_owned(), wrong.into());
        members.insert("notes".to_owned(), notes.into());
        members.insert("planner".to_owned(), open.scene.default_planner().into());
        members.insert("cannot".to_owned(), json(&open.scene.planners_that_cannot()));
        members.insert("links".to_owned(), open.scene.has_links().into());
        members.insert("trajectories".to_owned(), open.scene.has_trajectories().into());
        members.insert("parts_left".to_owned(), open.scene.parts_left().into());
        Ok(members)
    }

    /// The scene file of what is open, with the colours of its document, and with obstacles of the plane where it puts them.
    fn scene_file(&self, open: &Open) -> Result<SceneFile, Error> {
        Ok(Self::dressed(open, SceneFile::of(&open.scene)?))
    }

    fn dressed(open: &Open, mut file: SceneFile) -> SceneFile {
        match &open.document {
            Some(Document::Scene(document)) => {
                for (body, drawn) in document.bodies().zip(&mut file.bodies) {
                    drawn.color = body.color.as_deref().and_then(rgb);
                }
            }
            Some(Document::Problem(document)) => {
                let still = file.bodies.iter_mut().filter(|body| body.role == Role::Obstacle);
                for (obstacle, drawn) in document.obstacles.iter().zip(still) {
                    if let (Some(rings), Shape::Area(area)) = (obstacle.rings(), &drawn.shape) {
                        let ring =
                            |ring: Vec<[f64; 2]>| ring.as_flattened().iter().map(|x| *x as f32).collect();
                        file.areas[*area].rings = rings.into_iter().map(ring).collect();
                        let ([x, y, _, angle, ..], [a, b, _]) = (obstacle.pose, file.origin);
                        let pose = mp_geom::pose_from_six([x - a, y - b, 0.0, angle, 0.0, 0.0]);
                        drawn.pose = Some(crate::of_scene::seven(&pose));
                    }
                }
            }
            None => {}
        }
        file
    }

    /// Keeps the meshes of files, for documents.
    fn mesh(&mut self, request: &Message) -> Answer {
        let files = Named::of(request)?;
        let name = files.only("mesh")?.to_owned();
        let mesh = mp_io::read_mesh_of(&files, Path::new(&name))?;
        let (vertices, triangles, bounds) = (mesh.vertices().len(), mesh.triangles().len(), mesh.aabb());
        let file = self.name_mesh(&name, mesh);
        Ok(Message::default()
            .with("file", file)
            .with("vertices", vertices)
            .with("triangles", triangles)
            .with("bounds", json(&[<[f64; 3]>::from(bounds.min.coords), bounds.max.coords.into()])))
    }

    /// Reads a path through the scene from a file, or takes its configurations from the request, and checks it.
    fn path(&mut self, request: &Message) -> Answer {
        let scene = &self.scene_to_plan(request)?;
        let files;
        let (name, rows) = if request.head.contains_key("rows") {
            let rows = rows_of(&request.head, "rows")?;
            rows.iter().try_for_each(|row| scene.traced(row).map(drop))?;
            let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
            // As it will be written: only that is checked.
            (text_of(&request.head, "name")?, path.read_back()?)
        } else {
            files = Named::of(request)?;
            let name = files.only("path")?;
            let kind = PathFileKind::of(Path::new(name)).unwrap_or(PathFileKind::Text);
            (name, scene.parse_path(name, files.content(name), kind)?)
        };
        let verdict = scene.check(&rows)?;
        let track = PathTrack::of(name, verdict.free, Some(verdict.path_length), scene.track(&rows)?);
        let mut reply = Message::default();
        let path = json(&path_head(&track, &mut reply.data));
        let written = json(&rows.rows);
        Ok(reply.with("path", path).with("faults", verdict.faults).with("written", written))
    }

    /// A field that pushes snakes.
    fn field(&self, request: &Message) -> Answer {
        let scene = &self.opened()?.scene;
        let row = match request.head.get("row") {
            None | Some(Value::Null) => scene.start(),
            Some(_) => row_of(&request.head, "row")?,
        };
        let range = request.head.get("range").and_then(Value::as_str);
        let name = request.head.get("field").and_then(Value::as_str).unwrap_or("clearance");
        let path = request.head.contains_key("path").then(|| rows_of(&request.head, "path")).transpose()?;
        let path = path.map(|rows| PathRows { format: scene.path_format(), columns: scene.columns(), rows });
        let cells = number_of(&request.head, "cells")? as usize;
        let image = scene.field(&name.parse()?, &row, path.as_ref(), range, cells)?;
        let energy: Vec<f32> = image.energy.iter().map(|energy| *energy as f32).collect();
        let mut reply = Message::default();
        let energy = reply.array(&energy);
        Ok(reply
            .with("origin", json(&image.origin))
            .with("cell", image.cell)
            .with("width", image.width)
            .with("energy", energy)
            .with("range", image.range))
    }

    fn check(&self, request: &Message) -> Answer {
        let scene = &self.opened()?.scene;
        let row = row_of(&request.head, "row")?;
        let found = scene.explain(&row)?;
        let poses: Vec<f64> = scene.poses(&row)?.iter().flat_map(crate::of_scene::seven).collect();
        let touching: Vec<String> = found.touching.iter().map(ToString::to_string).collect();
        Ok(Message::default()
            .with("free", found.free)
            .with("in_bounds", found.in_bounds)
            .with("clearance", found.clearance)
            .with("touching", touching)
            .with("fault", found.fault)
            .with("nearest_free", found.nearest_free)
            .with("poses", poses))
    }

    /// The configuration that puts a body of an arm to a place.
    fn reach(&self, request: &Message) -> Answer {
        let scene = &self.opened()?.scene;
        let (row, pose) = (row_of(&request.head, "row")?, row_of(&request.head, "pose")?);
        let pose = of_seven(&pose).ok_or_else(|| {
            Error::new("`pose` of the request is no pose: x y z and the quaternion x y z w, not zero")
        })?;
        let reached = scene.reaching_from(number_of(&request.head, "body")? as usize, &pose, &row)?;
        let poses = reached.as_ref().map(|row| scene.poses(row)).transpose()?.unwrap_or_default();
        let poses: Vec<f64> = poses.iter().flat_map(crate::of_scene::seven).collect();
        Ok(Message::default().with("row", reached).with("poses", poses))
    }

    /// Opens the next part of the motion, which begins where the last one ended.
    fn next(&mut self, request: &Message) -> Answer {
        let end = row_of(&request.head, "row")?;
        let next = self.opened()?.scene.next_part(&end, &Interrupt::never())?;
        let next = next.ok_or_else(|| Error::new("this was the last part of the motion"))?;
        let unedited =
            "Obstacles are edited in the first part of the motion: open the scene again.".to_owned();
        let unedited = Some(unedited);
        self.open = Some(Open { scene: next, document: None, problem: None, unedited, path: None });
        self.reply()
    }

    fn save(&self, request: &Message) -> Answer {
        let name = plain_name(request)?;
        let document = match request.head.get("document") {
            Some(Value::Object(_)) => self.document(request)?,
            _ => self.opened()?.document.clone().ok_or_else(|| {
                Error::new("this kind of scene is not saved").help("problems that are edited here are")
            })?,
        };
        let mesh = |name: &str| known_mesh(&self.meshes, name);
        let texts =
            |files: Vec<(String, String)>| files.into_iter().map(|(name, text)| (name, text.into_bytes()));
        let format = format_of(request, &["own", "gempa"], "scenes")?;
        let files = match document {
            Document::Problem(_) if format == "gempa" => {
                return Err(
                    Error::new("GEMPA has rigid bodies only").help("save it as the problem that it is")
                );
            }
            Document::Problem(document) => {
                let folder = self.folder_of(request);
                let (files, left) = self.problem()?.saved(&name, &document, &mesh, folder)?;
                let left = (!left.is_empty()).then(|| {
                    format!("It needs the files that the scene was opened with: {}.", left.join(", "))
                });
                return Ok(self.written(request, files)?.with("note", left));
            }
            Document::Scene(document) if format == "own" => {
                let document = SceneDocument { name: name.clone(), ..*document };
                document.problem(&name, &mesh)?;
                vec![(format!("{name}.mp.json"), document.with_meshes(&mesh)?.to_text())]
            }
            Document::Scene(document) => document.to_gempa(&name, &mesh)?,
        };
        self.written(request, texts(files).collect())
    }

    fn save_path(&self, request: &Message) -> Answer {
        let scene = &self.opened()?.scene;
        let name = plain_name(request)?;
        let paths = FORMATS.iter().filter(|format| format.content.is_path());
        let usual: Vec<&str> = paths.map(|format| format.endings[0]).collect();
        let file = format!("{name}.{}", format_of(request, &usual, "paths")?);
        let kind = PathFileKind::of(Path::new(&file))?;
        let rows = rows_of(&request.head, "rows")?;
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        // The same checks as for a path from a file: of this robot, and finite.
        scene.track(&path)?;
        self.written(request, vec![(file, path.to_file(kind).into_bytes())])
    }

    fn save_trajectory(&self, request: &Message) -> Answer {
        let format = format_of(request, &["csv", "json", "yaml", "mcap"], "trajectories")?;
        let file = format!("{}.{format}", plain_name(request)?);
        let kind = TrajectoryKind::of(Path::new(&file)).unwrap_or(TrajectoryKind::Csv);
        let scene = &self.opened()?.scene;
        let bytes = scene.trajectory_bytes(&trajectory_of(scene, request)?, kind)?;
        self.written(request, vec![(file, bytes)])
    }

    fn export(&self, request: &Message) -> Answer {
        let open = &Open { scene: self.scene_to_plan(request)?, ..self.opened()?.clone() };
        let name = plain_name(request)?;
        let formats = [Content::ViewerScene, Content::Gltf, Content::Page].map(Content::ending);
        // A page with the planner inside puts the scene into its own text.
        let formats = if cfg!(target_family = "wasm") { &formats[..2] } else { &formats[..] };
        let ending = format_of(request, formats, "exports")?;
        let mut file = Self::dressed(open, SceneFile::for_file(&open.scene)?);
        for path in request.head.get("paths").and_then(Value::as_array).into_iter().flatten() {
            let members = path.as_object().cloned().unwrap_or_default();
            let rows = rows_of(&members, "rows")?;
            let format = open.scene.path_format();
            let path = PathRows { format, columns: open.scene.columns(), rows };
            file.add_path(&open.scene, text_of(&members, "name")?, &path)?;
        }
        let bytes = match ending {
            #[cfg(not(target_family = "wasm"))]
            ending if ending == Content::Page.ending() => file.to_html().into_bytes(),
            ending if ending == Content::Gltf.ending() => file.to_glb(GLB_SECONDS),
            _ => file.to_bytes(),
        };
        self.written(request, vec![(format!("{name}.{ending}"), bytes)])
    }

    /// The reply with these files: written into the folder, all or none, or their content.
    fn written(&self, request: &Message, files: Vec<(String, Vec<u8>)>) -> Answer {
        let mut reply = Message::default();
        files.iter().try_for_each(|(name, _)| mp_store::check_name(name))?;
        if let Some(folder) = self.folder_of(request) {
            let names: Vec<String> = files.iter().map(|file| file.0.clone()).collect();
            // The scene comes last: then all that it names is there.
            let files = files.into_iter().rev().map(|(name, bytes)| (name, [Ok::<_, Error>(bytes)]));
            mp_store::write_all(folder, files, flag(request, "overwrite"))?;
            return Ok(reply.with("written", names));
        }
        let files: Vec<Value> =
            files.iter().map(|(name, bytes)| json!({"name": name, "bytes": reply.array(bytes)})).collect();
        Ok(reply.with("files", files))
    }

    /// The folder into which a request writes; none when it asks for the content.
    fn folder_of(&self, request: &Message) -> Option<&Path> {
        self.folder.as_deref().filter(|_| !flag(request, "content"))
    }

    /// The scene of a request to plan: the one that is open, with the start and goals of the request.
    pub(crate) fn scene_to_plan(&self, request: &Message) -> Result<Scene, Error> {
        let scene = &self.opened()?.scene;
        let given = |name: &str| request.head.get(name).is_some_and(|value| !value.is_null());
        if !given("start") && !given("goals") {
            return Ok(scene.clone());
        }
        let start = if given("start") { row_of(&request.head, "start")? } else { scene.start() };
        let goals = if given("goals") { rows_of(&request.head, "goals")? } else { scene.goals() };
        scene.with_ends(&start, &goals)
    }
}

/// Why a scene cannot be edited, and what can be done instead, as sentences.
fn not_edited(e: &Error) -> String {
    let help = e.remedy().map(|help| format!(" Instead, {help}.")).unwrap_or_default();
    format!("Its obstacles are not edited here: {e}.{help}")
}

/// Whether a request says so.
fn flag(request: &Message, name: &str) -> bool {
    request.head.get(name).and_then(Value::as_bool).unwrap_or(false)
}

fn shipped(name: &str) -> Result<Scene, Error> {
    match Scene::shipped().contains(&name) {
        true => Scene::find(name),
        false => Err(Error::new(format!("no shipped scene is called {name}"))),
    }
}

/// The mesh that documents call `name`.
fn known_mesh(meshes: &BTreeMap<String, TriMesh>, name: &str) -> Result<TriMesh, mp_io::Error> {
    meshes.get(name).cloned().ok_or_else(|| {
        mp_io::Error::new(mp_io::ErrorKind::Io, name, "this mesh has not been opened")
            .help("open its file first")
    })
}

/// The pose of seven numbers, unless they are none.
fn of_seven(numbers: &[f64]) -> Option<Isometry3<f64>> {
    let [x, y, z, i, j, k, w] = *numbers else { return None };
    let turn = UnitQuaternion::try_new(Quaternion::new(w, i, j, k), 1e-9)?;
    let sound = numbers.iter().all(|number| number.is_finite());
    sound.then(|| Isometry3::from_parts(Translation3::new(x, y, z), turn))
}

/// A configuration in a request.
fn row_of(head: &serde_json::Map<String, Value>, name: &str) -> Result<Vec<f64>, Error> {
    serde_json::from_value(head.get(name).cloned().unwrap_or_default())
        .map_err(|_| Error::new(format!("the request has no configuration `{name}`: a list of numbers")))
}

/// Configurations in a request.
pub(crate) fn rows_of(head: &serde_json::Map<String, Value>, name: &str) -> Result<Vec<Vec<f64>>, Error> {
    serde_json::from_value(head.get(name).cloned().unwrap_or_default()).map_err(|_| {
        Error::new(format!("the request has no configurations `{name}`: a list of lists of numbers"))
    })
}
