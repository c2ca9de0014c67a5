//! Scenes as binary glTF 2.0: meshes and their motion, for Blender and other programs.

use crate::{Area, PathTrack, Role, SceneFile, Shape};
use mp_geom::planar::Polygon;
use mp_render::palette::{GOAL, INK, MIDDLE, OBSTACLE, OBSTACLES, PATH, START};
use nalgebra::{Point2, Quaternion, UnitQuaternion, Vector3};
use serde_json::{Map, Value, json};

/// How opaque the copies at start and goal are.
const COPY: f64 = 0.35;

/// The numbers of glTF for types and purposes.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const LINES: u32 = 1;
const LINE_STRIP: u32 = 3;
const TRIANGLES: u32 = 4;

impl SceneFile {
    /// The scene as a binary glTF 2.0 file (`.glb`): its bodies as meshes with names and colours, the robot moving along each path
    /// (an animation of `seconds` seconds for each, at even speed), the curves of the paths as lines, and translucent copies of
    /// the robot at start and goals. Areas of the plane are thin plates. In the file y is up, as glTF wants; its one
    /// root node turns the scene, whose own z is up. Of a scene [far away](Self::for_file) a node below the root has the `origin`.
    #[must_use]
    pub fn to_glb(&self, seconds: f64) -> Vec<u8> {
        let mut file = Glb::new(self);
        let robot: Vec<&crate::Body> =
            self.bodies.iter().filter(|body| body.role != Role::Obstacle).collect();
        let seven = |poses: &[f64], i: usize| poses.get(7 * i..7 * i + 7).and_then(|p| p.try_into().ok());

        let mut nodes = Vec::new();
        for (n, body) in self.bodies.iter().filter(|body| body.role == Role::Obstacle).enumerate() {
            let colour = match body.shape {
                Shape::Mesh(_) => OBSTACLES[n % OBSTACLES.len()],
                Shape::Area(_) => OBSTACLE,
                Shape::Lines(_) => INK,
            };
            let mesh = file.mesh(&body.name, &body.shape, colour, 1.0);
            nodes.push(file.node(&body.name, mesh, body.pose));
        }
        let mut parts = file.group("obstacles", nodes);

        // Where the robot is at the beginning of its motion.
        let first = self.paths.first();
        let moving: Vec<usize> = robot
            .iter()
            .enumerate()
            .map(|(i, body)| {
                let on_path = first.and_then(|path| pose_of(path, robot.len(), 0, i));
                let mesh = file.mesh(&body.name, &body.shape, MIDDLE, 1.0);
                file.node(&body.name, mesh, on_path.or_else(|| seven(&self.start.poses, i)))
            })
            .collect();
        parts.extend(file.group("robot", moving.clone()));

        // Without a path the robot stands at the start itself.
        let start = first.map(|_| ("start".to_owned(), &self.start, START));
        let goals = self.goals.iter().enumerate().map(|(n, goal)| {
            let name = if self.goals.len() == 1 { "goal".to_owned() } else { format!("goal {}", n + 1) };
            (name, goal, GOAL)
        });
        for (name, configuration, colour) in start.into_iter().chain(goals) {
            let mut copies = Vec::new();
            for (i, body) in robot.iter().enumerate() {
                let mesh = file.mesh(&format!("{}, {name}", body.name), &body.shape, colour, COPY);
                copies.push(file.node(
                    &format!("{}, {name}", body.name),
                    mesh,
                    seven(&configuration.poses, i),
                ));
            }
            parts.extend(file.group(&name, copies));
        }
        for path in &self.paths {
            parts.extend(file.trace(path));
            file.animate(path, &moving, self.reach(&robot), seconds);
        }
        if self.origin != [0.0; 3] && !parts.is_empty() {
            file.nodes.push(json!({ "name": "origin", "translation": self.origin, "children": parts }));
            parts = vec![file.nodes.len() - 1];
        }
        file.finish(&self.name, parts)
    }

    /// The distance of the farthest point of the robot's bodies from the origins of their frames, metres.
    fn reach(&self, robot: &[&crate::Body]) -> f64 {
        let norm = |p: &[f32]| p.iter().map(|c| mp_math::powi(f64::from(*c), 2)).sum::<f64>().sqrt();
        let of = |body: &&crate::Body| match &body.shape {
            Shape::Mesh(i) => self.meshes[*i].positions.chunks_exact(3).map(norm).fold(0.0, f64::max),
            Shape::Area(i) => {
                self.areas[*i].rings.iter().flat_map(|r| r.chunks_exact(2)).map(norm).fold(0.0, f64::max)
            }
            Shape::Lines(_) => 0.0,
        };
        robot.iter().map(of).fold(0.0, f64::max)
    }
}

/// The pose of body `i` of `bodies` at configuration `k` of a path.
fn pose_of(path: &PathTrack, bodies: usize, k: usize, i: usize) -> Option<[f64; 7]> {
    let from = 7 * (k * bodies + i);
    let pose: [f32; 7] = path.poses.get(from..from + 7)?.try_into().ok()?;
    Some(pose.map(f64::from))
}

/// The translation and the unit quaternion of a pose; none where a number is not finite.
fn parts(pose: [f64; 7]) -> ([f32; 3], [f32; 4]) {
    let finite = |v: f64| if v.is_finite() { v as f32 } else { 0.0 };
    let [x, y, z, qx, qy, qz, qw] = pose;
    let q = Quaternion::new(qw, qx, qy, qz);
    let unit = UnitQuaternion::try_new(q, 1e-9).unwrap_or_else(UnitQuaternion::identity);
    let c = unit.coords;
    ([finite(x), finite(y), finite(z)], [c.x, c.y, c.z, c.w].map(finite))
}

/// A file that is put together.
struct Glb<'s> {
    scene: &'s SceneFile,
    data: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
    /// The colour and opacity of each material.
    colours: Vec<(u32, f64)>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    animations: Vec<Value>,
    /// The accessors of the points and triangles of each mesh and area, once they are written.
    written: [Vec<Option<Option<[usize; 2]>>>; 2],
    /// The thickness of areas, metres.
    thickness: f64,
}

impl<'s> Glb<'s> {
    fn new(scene: &'s SceneFile) -> Self {
        let [low, high] = scene.bounds;
        let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        Self {
            scene,
            data: Vec::new(),
            views: Vec::new(),
            accessors: Vec::new(),
            materials: Vec::new(),
            colours: Vec::new(),
            meshes: Vec::new(),
            nodes: Vec::new(),
            animations: Vec::new(),
            written: [vec![None; scene.meshes.len()], vec![None; scene.areas.len()]],
            thickness: 0.01 * size,
        }
    }

    /// An accessor of new data: `kind` is that of glTF, such as `VEC3`. Bounds are written for points and times.
    fn accessor(&mut self, numbers: &[f32], kind: &str, width: usize, target: Option<u32>) -> usize {
        let offset = self.data.len();
        self.data.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
        let count = numbers.len() / width;
        let mut accessor = json!({ "componentType": FLOAT, "count": count, "type": kind });
        if target.is_some() || width == 1 {
            let of = |k: usize, best: fn(f32, f32) -> f32, from: f32| {
                numbers.iter().skip(k).step_by(width).copied().fold(from, best)
            };
            accessor["min"] = (0..width).map(|k| of(k, f32::min, f32::INFINITY)).collect();
            accessor["max"] = (0..width).map(|k| of(k, f32::max, f32::NEG_INFINITY)).collect();
        }
        self.push_view(accessor, offset, target)
    }

    fn indices(&mut self, indices: &[u32]) -> usize {
        let offset = self.data.len();
        self.data.extend(indices.iter().flat_map(|v| v.to_le_bytes()));
        let accessor = json!({ "componentType": UNSIGNED_INT, "count": indices.len(), "type": "SCALAR" });
        self.push_view(accessor, offset, Some(ELEMENT_ARRAY_BUFFER))
    }

    /// Adds the view of the data from `offset` on and its accessor.
    fn push_view(&mut self, mut accessor: Value, offset: usize, target: Option<u32>) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": self.data.len() - offset });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        accessor["bufferView"] = self.views.len().into();
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// The material of a colour (`0xRRGGBB`) and opacity.
    fn material(&mut self, colour: u32, opacity: f64) -> usize {
        if let Some(known) = self.colours.iter().position(|c| *c == (colour, opacity)) {
            return known;
        }
        let linear = |shift: u32| {
            let v = f64::from((colour >> shift) & 255) / 255.0;
            if v <= 0.04045 { v / 12.92 } else { mp_math::powf((v + 0.055) / 1.055, 2.4) }
        };
        let mut material = json!({
            "pbrMetallicRoughness": {
                "baseColorFactor": [linear(16), linear(8), linear(0), opacity],
                "metallicFactor": 0.0,
                "roughnessFactor": 0.8,
            },
            // Triangles may have any orientation.
            "doubleSided": true,
        });
        if opacity < 1.0 {
            material["alphaMode"] = "BLEND".into();
        }
        self.colours.push((colour, opacity));
        self.materials.push(material);
        self.materials.len() - 1
    }

    /// The mesh of a shape; `None` when it is empty.
    fn mesh(&mut self, name: &str, shape: &Shape, colour: u32, opacity: f64) -> Option<usize> {
        let mut primitives = Vec::new();
        match shape {
            Shape::Mesh(i) => primitives.push(self.surface(0, *i, |scene, _| {
                let mesh = &scene.meshes[*i];
                (mesh.positions.clone(), mesh.triangles.clone())
            })?),
            Shape::Area(i) => {
                primitives.push(self.surface(1, *i, |scene, thickness| plate(&scene.areas[*i], thickness))?)
            }
            Shape::Lines(lines) => {
                for line in lines.iter().map(|i| &self.scene.lines[*i].points).collect::<Vec<_>>() {
                    if line.len() >= 6 {
                        primitives.push(self.line(line));
                    }
                }
            }
        }
        if primitives.is_empty() {
            return None;
        }
        let material = self.material(colour, opacity);
        primitives.iter_mut().for_each(|p| p["material"] = material.into());
        self.meshes.push(json!({ "name": name, "primitives": primitives }));
        Some(self.meshes.len() - 1)
    }

    /// A polyline as a primitive without a material.
    fn line(&mut self, points: &[f32]) -> Value {
        let points: Vec<f32> = points.iter().copied().map(finite).collect();
        let mode = if points.len() == 6 { LINES } else { LINE_STRIP };
        let points = self.accessor(&points, "VEC3", 3, Some(ARRAY_BUFFER));
        json!({ "attributes": { "POSITION": points }, "mode": mode })
    }

    /// A surface as a primitive without a material; its points and triangles are written when they are first used.
    fn surface(
        &mut self,
        kind: usize,
        i: usize,
        make: impl FnOnce(&SceneFile, f64) -> (Vec<f32>, Vec<u32>),
    ) -> Option<Value> {
        let written = self.written[kind][i].unwrap_or_else(|| {
            let (points, triangles) = make(self.scene, self.thickness);
            (!triangles.is_empty()).then(|| {
                let points: Vec<f32> = points.into_iter().map(finite).collect();
                [self.accessor(&points, "VEC3", 3, Some(ARRAY_BUFFER)), self.indices(&triangles)]
            })
        });
        self.written[kind][i] = Some(written);
        let [points, triangles] = written?;
        Some(json!({ "attributes": { "POSITION": points }, "indices": triangles, "mode": TRIANGLES }))
    }

    fn node(&mut self, name: &str, mesh: Option<usize>, pose: Option<[f64; 7]>) -> usize {
        let mut node = json!({ "name": name });
        if let Some(pose) = pose {
            let (translation, rotation) = parts(pose);
            node["translation"] = json!(translation);
            node["rotation"] = json!(rotation);
        }
        if let Some(mesh) = mesh {
            node["mesh"] = mesh.into();
        }
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// A node with children; none without them.
    fn group(&mut self, name: &str, children: Vec<usize>) -> Vec<usize> {
        if children.is_empty() {
            return children;
        }
        self.nodes.push(json!({ "name": name, "children": children }));
        vec![self.nodes.len() - 1]
    }

    /// The node of the curve of a path.
    fn trace(&mut self, path: &PathTrack) -> Option<usize> {
        if path.trace.len() < 6 {
            return None;
        }
        let mut line = self.line(&path.trace);
        line["material"] = self.material(PATH, 1.0).into();
        self.meshes.push(json!({ "name": format!("path {}", path.name), "primitives": [line] }));
        let mesh = self.meshes.len() - 1;
        // Above the areas, which would hide it.
        let areas = self.scene.areas.is_empty();
        let lift = if areas { 0.0 } else { 1.5 * self.thickness };
        let pose = [0.0, 0.0, lift, 0.0, 0.0, 0.0, 1.0];
        Some(self.node(&format!("path {}", path.name), Some(mesh), Some(pose)))
    }

    /// The motion of the robot's nodes along a path.
    fn animate(&mut self, path: &PathTrack, nodes: &[usize], reach: f64, seconds: f64) {
        let bodies = nodes.len();
        if bodies == 0 {
            return;
        }
        let count = path.poses.len() / (7 * bodies);
        let at = |k: usize, i: usize| parts(pose_of(path, bodies, k, i).unwrap_or([0.0; 7]));
        // Even speed: the time between two configurations is as long as the way of the body that moves most.
        let moved = |a: ([f32; 3], [f32; 4]), b: ([f32; 3], [f32; 4])| {
            let [a, b] = [a, b].map(|(t, q)| {
                let q = Quaternion::new(q[3], q[0], q[1], q[2]).cast::<f64>();
                (Vector3::from(t).cast::<f64>(), UnitQuaternion::new_normalize(q))
            });
            (a.0 - b.0).norm() + reach * a.1.angle_to(&b.1)
        };
        let mut ways = vec![0.0];
        for k in 1..count {
            let most = (0..bodies).map(|i| moved(at(k - 1, i), at(k, i))).fold(0.0, f64::max);
            ways.push(ways[k - 1] + most);
        }
        let total = ways[ways.len() - 1];
        if total <= 0.0 || !total.is_finite() {
            return;
        }
        // Times must grow.
        let mut keys: Vec<(usize, f32)> = Vec::new();
        for (k, way) in ways.iter().enumerate() {
            let time = (seconds * way / total) as f32;
            if keys.last().is_none_or(|(_, last)| time > *last) {
                keys.push((k, time));
            }
        }
        let times: Vec<f32> = keys.iter().map(|(_, time)| *time).collect();
        let input = self.accessor(&times, "SCALAR", 1, None);
        let (mut channels, mut samplers) = (Vec::new(), Vec::new());
        for (i, node) in nodes.iter().enumerate() {
            let (mut translations, mut rotations): (Vec<f32>, Vec<f32>) = (Vec::new(), Vec::new());
            for (k, _) in &keys {
                let (translation, mut rotation) = at(*k, i);
                // The nearer of the two quaternions of a rotation.
                let before = rotations.len().checked_sub(4).map(|from| &rotations[from..]);
                if before.is_some_and(|b| b.iter().zip(rotation).map(|(x, y)| x * y).sum::<f32>() < 0.0) {
                    rotation = rotation.map(|c| -c);
                }
                translations.extend(translation);
                rotations.extend(rotation);
            }
            for (numbers, kind, width, what) in
                [(translations, "VEC3", 3, "translation"), (rotations, "VEC4", 4, "rotation")]
            {
                let output = self.accessor(&numbers, kind, width, None);
                channels.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": what } }));
                samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
            }
        }
        self.animations.push(json!({ "name": path.name, "channels": channels, "samplers": samplers }));
    }

    /// The bytes of the file.
    fn finish(mut self, name: &str, parts: Vec<usize>) -> Vec<u8> {
        // A quarter turn around x: z of the scene becomes y.
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let mut root = json!({ "name": name, "rotation": [-half, 0.0, 0.0, half] });
        if !parts.is_empty() {
            root["children"] = parts.into();
        }
        self.nodes.push(root);
        let mut head = json!({
            "asset": { "version": "2.0", "generator": concat!("mp ", env!("CARGO_PKG_VERSION")) },
            "scene": 0,
            "scenes": [{ "name": name, "nodes": [self.nodes.len() - 1] }],
        });
        let buffers = match self.data.len() {
            0 => Vec::new(),
            length => vec![json!({ "byteLength": length })],
        };
        let lists = [
            ("nodes", self.nodes),
            ("meshes", self.meshes),
            ("materials", self.materials),
            ("animations", self.animations),
            ("accessors", self.accessors),
            ("bufferViews", self.views),
            ("buffers", buffers),
        ];
        let lists: Map<String, Value> = lists
            .into_iter()
            .filter(|(_, list)| !list.is_empty())
            .map(|(name, list)| (name.to_owned(), list.into()))
            .collect();
        if let Value::Object(head) = &mut head {
            head.extend(lists);
        }
        let mut json = head.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut chunks: Vec<(&[u8; 4], Vec<u8>)> = vec![(b"JSON", json)];
        if !self.data.is_empty() {
            chunks.push((b"BIN\0", self.data));
        }
        let length = 12 + chunks.iter().map(|(_, data)| 8 + data.len()).sum::<usize>();
        let mut bytes = b"glTF".to_vec();
        bytes.extend(2u32.to_le_bytes());
        bytes.extend((length as u32).to_le_bytes());
        for (kind, data) in chunks {
            bytes.extend((data.len() as u32).to_le_bytes());
            bytes.extend(kind);
            bytes.extend(data);
        }
        bytes
    }
}

fn finite(v: f32) -> f32 {
    if v.is_finite() { v } else { 0.0 }
}

/// An area of the plane as a plate from z = 0 upwards.
fn plate(area: &Area, thickness: f64) -> (Vec<f32>, Vec<u32>) {
    let ring = |ring: &Vec<f32>| {
        ring.chunks_exact(2).map(|p| Point2::new(f64::from(p[0]), f64::from(p[1]))).collect::<Vec<_>>()
    };
    let rings = area.rings.iter().map(ring).filter(|ring| ring.len() > 2).collect();
    let Ok(polygon) = Polygon::new(rings) else { return (Vec::new(), Vec::new()) };
    let (mut points, mut triangles): (Vec<f32>, Vec<u32>) = (Vec::new(), Vec::new());
    let mut add = |corners: [(Point2<f64>, f64); 3]| {
        for (p, z) in corners {
            triangles.push((points.len() / 3) as u32);
            points.extend([p.x as f32, p.y as f32, z as f32]);
        }
    };
    for [a, b, c] in polygon.triangles() {
        add([(a, thickness), (b, thickness), (c, thickness)]);
        add([(a, 0.0), (c, 0.0), (b, 0.0)]);
    }
    for [a, b] in polygon.edges() {
        add([(a, 0.0), (b, 0.0), (b, thickness)]);
        add([(a, 0.0), (b, thickness), (a, thickness)]);
    }
    (points, triangles)
}
