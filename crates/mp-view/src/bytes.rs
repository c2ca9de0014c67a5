//! Scene files as bytes: docs/formats/viewer.md.

use crate::arrays::{ArrayRef, Entry, append, extract};
use crate::{
    Area, Bends, Body, Configuration, Mesh, PathTrack, Polyline, Roadmap, Role, SceneFile, Shape, Tree,
    ViewError,
};
use mp_plan::Column;
use serde::{Deserialize, Serialize};
use std::cell::Cell;

/// The version written and read.
const VERSION: u32 = 1;

/// The first four bytes.
const MAGIC: &[u8; 4] = b"MPV1";

#[derive(Serialize, Deserialize)]
struct Head {
    version: u32,
    name: String,
    space: String,
    planar: bool,
    columns: Vec<Column>,
    limits: Vec<Option<[f64; 2]>>,
    bounds: [[f64; 3]; 2],
    #[serde(default, skip_serializing_if = "is_zero")]
    origin: [f64; 3],
    meshes: Vec<MeshHead>,
    areas: Vec<AreaHead>,
    lines: Vec<LineHead>,
    bodies: Vec<BodyHead>,
    start: Configuration,
    goals: Vec<Configuration>,
    paths: Vec<PathHead>,
    trees: Vec<TreeHead>,
    roadmap: Option<RoadmapHead>,
    report: Option<serde_json::Value>,
}

#[derive(Serialize, Deserialize)]
struct MeshHead {
    positions: ArrayRef,
    triangles: ArrayRef,
}

#[derive(Serialize, Deserialize)]
struct AreaHead {
    rings: Vec<ArrayRef>,
}

#[derive(Serialize, Deserialize)]
struct LineHead {
    points: ArrayRef,
}

#[derive(Serialize, Deserialize)]
struct BodyHead {
    name: String,
    role: Role,
    #[serde(flatten)]
    shape: Shape,
    #[serde(skip_serializing_if = "Option::is_none")]
    pose: Option<[f64; 7]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    color: Option<String>,
}

#[derive(Serialize, Deserialize)]
pub(crate) struct PathHead {
    name: String,
    verified: bool,
    length: Option<f64>,
    rows: ArrayRef,
    poses: ArrayRef,
    trace: ArrayRef,
    clearance: Option<ArrayRef>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    travel: Option<ArrayRef>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    corners: Option<ArrayRef>,
}

#[derive(Serialize, Deserialize)]
struct TreeHead {
    name: String,
    nodes: ArrayRef,
    parents: ArrayRef,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    bent: Option<ArrayRef>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    through: Option<ArrayRef>,
}

#[derive(Serialize, Deserialize)]
struct RoadmapHead {
    nodes: ArrayRef,
    edges: ArrayRef,
    component: ArrayRef,
    kind: ArrayRef,
}

fn is_zero(origin: &[f64; 3]) -> bool {
    *origin == [0.0; 3]
}

/// A head, padded, and the arrays behind it.
pub(crate) fn frame(mut head: Vec<u8>, data: &[u8]) -> Vec<u8> {
    head.resize(head.len().next_multiple_of(8), b' ');
    let mut bytes = Vec::with_capacity(8 + head.len() + data.len());
    bytes.extend(MAGIC);
    bytes.extend((head.len() as u32).to_le_bytes());
    bytes.extend(head);
    bytes.extend(data);
    bytes
}

/// The head and the arrays in `bytes`.
pub(crate) fn unframe(bytes: &[u8]) -> Result<(&[u8], &[u8]), ViewError> {
    let rest = bytes.strip_prefix(MAGIC).ok_or(ViewError::NotAScene)?;
    let cut_off = |expected| ViewError::CutOff { expected, found: bytes.len() };
    let (length, rest) = rest.split_first_chunk::<4>().ok_or_else(|| cut_off(8))?;
    let length = u32::from_le_bytes(*length) as usize;
    rest.split_at_checked(length).ok_or_else(|| cut_off(length.saturating_add(8)))
}

/// The head of a path, whose arrays are appended to `data`.
pub(crate) fn path_head(path: &PathTrack, data: &mut Vec<u8>) -> PathHead {
    PathHead {
        name: path.name.clone(),
        verified: path.verified,
        length: path.length,
        rows: append(data, &path.rows),
        poses: append(data, &path.poses),
        trace: append(data, &path.trace),
        clearance: path.clearance.as_ref().map(|clearance| append(data, clearance)),
        travel: path.travel.as_ref().map(|travel| append(data, travel)),
        corners: path.corners.as_ref().map(|corners| append(data, corners)),
    }
}

impl PathTrack {
    /// The path as a message to a page [that shows what a program sends](crate::Planner::Elsewhere).
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut data = Vec::new();
        let head = serde_json::json!({"path": path_head(self, &mut data)});
        frame(serde_json::to_vec(&head).unwrap_or_default(), &data)
    }
}

impl SceneFile {
    /// The bytes of the file. The same scene gives the same bytes.
    ///
    /// # Panics
    /// Never: numbers that JSON cannot hold are written as null.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut data = Vec::new();
        let head = self.head(&mut data);
        frame(serde_json::to_vec(&head).unwrap_or_default(), &data)
    }

    fn head(&self, data: &mut Vec<u8>) -> Head {
        let body = |body: &Body| BodyHead {
            name: body.name.clone(),
            role: body.role,
            shape: body.shape.clone(),
            pose: body.pose,
            color: body.color.map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}")),
        };
        let bent = |tree: &Tree| !tree.bends.nodes.is_empty();
        Head {
            version: VERSION,
            name: self.name.clone(),
            space: self.space.clone(),
            planar: self.planar,
            columns: self.columns.clone(),
            limits: self.limits.clone(),
            bounds: self.bounds,
            origin: self.origin,
            meshes: (self.meshes.iter())
                .map(|mesh| MeshHead {
                    positions: append(data, &mesh.positions),
                    triangles: append(data, &mesh.triangles),
                })
                .collect(),
            areas: (self.areas.iter())
                .map(|area| AreaHead { rings: area.rings.iter().map(|ring| append(data, ring)).collect() })
                .collect(),
            lines: self.lines.iter().map(|line| LineHead { points: append(data, &line.points) }).collect(),
            bodies: self.bodies.iter().map(body).collect(),
            start: self.start.clone(),
            goals: self.goals.clone(),
            paths: self.paths.iter().map(|path| path_head(path, data)).collect(),
            trees: (self.trees.iter())
                .map(|tree| TreeHead {
                    name: tree.name.clone(),
                    nodes: append(data, &tree.nodes),
                    parents: append(data, &tree.parents),
                    bent: bent(tree).then(|| append(data, &tree.bends.nodes)),
                    through: bent(tree).then(|| append(data, &tree.bends.through)),
                })
                .collect(),
            roadmap: self.roadmap.as_ref().map(|map| RoadmapHead {
                nodes: append(data, &map.nodes),
                edges: append(data, &map.edges),
                component: append(data, &map.component),
                kind: append(data, &map.kind),
            }),
            report: self.report.clone(),
        }
    }

    /// Reads a scene file.
    ///
    /// # Errors
    /// When the bytes are no scene file of this version, are cut off, or an array or index does not fit.
    pub fn parse(bytes: &[u8]) -> Result<Self, ViewError> {
        let (json, data) = unframe(bytes)?;
        let bad_head = |e: serde_json::Error| ViewError::Head { reason: e.to_string() };
        #[derive(Deserialize)]
        struct Versioned {
            version: u32,
        }
        let Versioned { version } = serde_json::from_slice(json).map_err(bad_head)?;
        if version != VERSION {
            return Err(ViewError::Version { found: version, expected: VERSION });
        }
        let scene = read(serde_json::from_slice(json).map_err(bad_head)?, data)?;
        scene.check()?;
        Ok(scene)
    }

    /// Checks what the types do not say: numbers of entries, and indices.
    fn check(&self) -> Result<(), ViewError> {
        let fits = |holds: bool, what: &str, problem| match holds {
            true => Ok(()),
            false => Err(ViewError::Array { what: what.to_owned(), problem }),
        };
        const LENGTH: &str = "does not have the number of entries expected";
        const INDEX: &str = "has an index out of range";
        let robots = self.bodies.iter().filter(|body| body.role != Role::Obstacle).count();
        for mesh in &self.meshes {
            fits(mesh.positions.len().is_multiple_of(3), "positions", LENGTH)?;
            fits(mesh.triangles.len().is_multiple_of(3), "triangles", LENGTH)?;
            let vertices = mesh.positions.len() / 3;
            fits(mesh.triangles.iter().all(|&v| (v as usize) < vertices), "triangles", INDEX)?;
        }
        fits(
            self.areas.iter().flat_map(|area| &area.rings).all(|ring| ring.len().is_multiple_of(2)),
            "rings",
            LENGTH,
        )?;
        fits(self.lines.iter().all(|line| line.points.len().is_multiple_of(3)), "points", LENGTH)?;
        fits(self.limits.len() == self.columns.len(), "limits", LENGTH)?;
        for body in &self.bodies {
            let known = match &body.shape {
                Shape::Mesh(i) => *i < self.meshes.len(),
                Shape::Area(i) => *i < self.areas.len(),
                Shape::Lines(lines) => lines.iter().all(|&i| i < self.lines.len()),
            };
            fits(known, "bodies", INDEX)?;
            fits(
                body.pose.is_some() == (body.role == Role::Obstacle),
                "bodies",
                "has obstacles without a pose, or poses of the robot",
            )?;
        }
        for q in self.goals.iter().chain([&self.start]) {
            fits(q.row.len() == self.columns.len() && q.poses.len() == 7 * robots, "configurations", LENGTH)?;
        }
        for path in &self.paths {
            let count = path.trace.len() / 3;
            let fitting = |known: &Option<Vec<f32>>| known.as_ref().is_none_or(|known| known.len() == count);
            let clearance = fitting(&path.clearance) && fitting(&path.travel);
            let all = path.trace.len() == 3 * count && path.rows.len() == count * self.columns.len();
            fits(all && path.poses.len() == 7 * robots * count && clearance, "paths", LENGTH)?;
            fits(path.corners.iter().flatten().all(|&i| (i as usize) < count), "corners", INDEX)?;
        }
        for tree in &self.trees {
            let count = tree.parents.len();
            fits(tree.nodes.len() == 3 * count, "trees", LENGTH)?;
            fits(tree.parents.iter().all(|&p| (-1..count as i64).contains(&i64::from(p))), "trees", INDEX)?;
            let (pairs, rest) = tree.bends.nodes.as_chunks::<2>();
            let points: u64 = pairs.iter().map(|[_, points]| u64::from(*points)).sum();
            let all = rest.is_empty() && tree.bends.through.len() as u64 == 3 * points;
            fits(all && pairs.iter().all(|[_, points]| *points > 0), "bent edges", LENGTH)?;
            fits(pairs.iter().all(|[node, _]| (*node as usize) < count), "bent edges", INDEX)?;
        }
        if let Some(map) = &self.roadmap {
            let count = map.nodes.len() / 3;
            let all = map.nodes.len() == 3 * count && map.component.len() == count && map.kind.len() == count;
            fits(all && map.edges.len().is_multiple_of(2), "roadmap", LENGTH)?;
            fits(map.edges.iter().all(|&node| (node as usize) < count), "roadmap", INDEX)?;
        }
        Ok(())
    }
}

fn read(head: Head, data: &[u8]) -> Result<SceneFile, ViewError> {
    /// Arrays, and how many bytes of them may still be read: many arrays in one place would take memory out of proportion.
    struct Data<'d>(&'d [u8], Cell<usize>);
    fn get<T: Entry>(data: &Data<'_>, array: &ArrayRef, what: &str) -> Result<Vec<T>, ViewError> {
        let entries = extract(data.0, array, what)?;
        let left = data.1.get().checked_sub(entries.len() * T::SIZE);
        let problem = "is in the place of another array";
        data.1.set(left.ok_or_else(|| ViewError::Array { what: what.to_owned(), problem })?);
        Ok(entries)
    }
    let data = &Data(data, Cell::new(data.len()));
    let no_color =
        || ViewError::Array { what: "bodies".to_owned(), problem: "has a colour that is not #rrggbb" };
    let body = |body: BodyHead| {
        Ok(Body {
            name: body.name,
            role: body.role,
            shape: body.shape,
            pose: body.pose,
            color: body.color.map(|text| rgb(&text).ok_or_else(no_color)).transpose()?,
        })
    };
    let mesh = |mesh: &MeshHead| {
        Ok(Mesh {
            positions: get(data, &mesh.positions, "positions")?,
            triangles: get(data, &mesh.triangles, "triangles")?,
        })
    };
    let area = |area: &AreaHead| {
        Ok(Area { rings: area.rings.iter().map(|ring| get(data, ring, "rings")).collect::<Result<_, _>>()? })
    };
    let path = |path: PathHead| {
        Ok(PathTrack {
            name: path.name,
            verified: path.verified,
            length: path.length,
            rows: get(data, &path.rows, "rows")?,
            poses: get(data, &path.poses, "poses")?,
            trace: get(data, &path.trace, "trace")?,
            clearance: path.clearance.map(|clearance| get(data, &clearance, "clearance")).transpose()?,
            travel: path.travel.map(|travel| get(data, &travel, "travel")).transpose()?,
            corners: path.corners.map(|corners| get(data, &corners, "corners")).transpose()?,
        })
    };
    let tree = |tree: TreeHead| {
        Ok(Tree {
            name: tree.name,
            nodes: get(data, &tree.nodes, "nodes")?,
            parents: get(data, &tree.parents, "parents")?,
            bends: Bends {
                nodes: tree.bent.map(|bent| get(data, &bent, "bent")).transpose()?.unwrap_or_default(),
                through: tree.through.map(|t| get(data, &t, "through")).transpose()?.unwrap_or_default(),
            },
        })
    };
    let roadmap = |map: RoadmapHead| {
        Ok(Roadmap {
            nodes: get(data, &map.nodes, "nodes")?,
            edges: get(data, &map.edges, "edges")?,
            component: get(data, &map.component, "component")?,
            kind: get(data, &map.kind, "kind")?,
        })
    };
    let line = |line: &LineHead| Ok(Polyline { points: get(data, &line.points, "points")? });
    Ok(SceneFile {
        name: head.name,
        space: head.space,
        planar: head.planar,
        columns: head.columns,
        limits: head.limits,
        bounds: head.bounds,
        origin: head.origin,
        meshes: head.meshes.iter().map(mesh).collect::<Result<_, ViewError>>()?,
        areas: head.areas.iter().map(area).collect::<Result<_, ViewError>>()?,
        lines: head.lines.iter().map(line).collect::<Result<_, ViewError>>()?,
        bodies: head.bodies.into_iter().map(body).collect::<Result<_, ViewError>>()?,
        start: head.start,
        goals: head.goals,
        paths: head.paths.into_iter().map(path).collect::<Result<_, ViewError>>()?,
        trees: head.trees.into_iter().map(tree).collect::<Result<_, ViewError>>()?,
        roadmap: head.roadmap.map(roadmap).transpose()?,
        report: head.report,
    })
}

/// Red, green and blue of `#rrggbb`.
pub(crate) fn rgb(text: &str) -> Option<[u8; 3]> {
    let digits =
        text.strip_prefix('#').filter(|d| d.len() == 6 && d.bytes().all(|b| b.is_ascii_hexdigit()))?;
    let [_, r, g, b] = u32::from_str_radix(digits, 16).ok()?.to_be_bytes();
    Some([r, g, b])
}
