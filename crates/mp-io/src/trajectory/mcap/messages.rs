//! The messages of ROS 2 that are written and read, and their definitions.

use super::cdr::{Reader, Writer};
use super::{RecordedBody, RecordedShape, Recording};
use crate::TrajectoryFile;
use crate::trajectory::ros::{Message, Point, Time};
use nalgebra::Isometry3;

/// Between the definitions of a message and of those that it has.
const LINE: &str = "================================================================================";

const TIME: (&str, &str) = ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec");
const DURATION: (&str, &str) = ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec");
const HEADER: (&str, &str) = ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id");
const VECTOR: (&str, &str) = ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z");
const POINT: (&str, &str) = ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z");
const QUATERNION: (&str, &str) =
    ("geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1");

/// The type of a message and its definition, with those of its parts.
pub(super) struct Type {
    pub(super) name: &'static str,
    own: &'static str,
    parts: &'static [(&'static str, &'static str)],
}

impl Type {
    pub(super) fn definition(&self) -> String {
        let parts = self.parts.iter().map(|(name, own)| format!("\n{LINE}\nMSG: {name}\n{own}\n"));
        format!("{}\n{}", self.own, parts.collect::<String>())
    }
}

pub(super) const JOINT_TRAJECTORY: Type = Type {
    name: "trajectory_msgs/msg/JointTrajectory",
    own: "std_msgs/Header header\nstring[] joint_names\ntrajectory_msgs/JointTrajectoryPoint[] points",
    parts: &[
        HEADER,
        TIME,
        (
            "trajectory_msgs/JointTrajectoryPoint",
            "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] effort\n\
             builtin_interfaces/Duration time_from_start",
        ),
        DURATION,
    ],
};

pub(super) const JOINT_STATE: Type = Type {
    name: "sensor_msgs/msg/JointState",
    own: "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort",
    parts: &[HEADER, TIME],
};

pub(super) const TRANSFORMS: Type = Type {
    name: "tf2_msgs/msg/TFMessage",
    own: "geometry_msgs/TransformStamped[] transforms",
    parts: &[
        (
            "geometry_msgs/TransformStamped",
            "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform",
        ),
        HEADER,
        TIME,
        ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation"),
        VECTOR,
        QUATERNION,
    ],
};

pub(super) const MARKERS: Type = Type {
    name: "visualization_msgs/msg/MarkerArray",
    own: "visualization_msgs/Marker[] markers",
    parts: &[
        (
            "visualization_msgs/Marker",
            "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\ngeometry_msgs/Pose pose\n\
             geometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\nbuiltin_interfaces/Duration lifetime\nbool frame_locked\n\
             geometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\nstring texture_resource\n\
             sensor_msgs/CompressedImage texture\nvisualization_msgs/UVCoordinate[] uv_coordinates\nstring text\n\
             string mesh_resource\nvisualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials",
        ),
        HEADER,
        TIME,
        DURATION,
        ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation"),
        POINT,
        QUATERNION,
        VECTOR,
        ("std_msgs/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a"),
        ("sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data"),
        ("visualization_msgs/UVCoordinate", "float32 u\nfloat32 v"),
        ("visualization_msgs/MeshFile", "string filename\nuint8[] data"),
    ],
};

/// The trajectory as it is sent to a controller.
pub(super) fn joint_trajectory(trajectory: &TrajectoryFile) -> Vec<u8> {
    let mut out = Writer::new();
    out.header(0, "");
    names(&mut out, trajectory);
    out.u32(trajectory.times.len() as u32);
    for (i, time) in trajectory.times.iter().enumerate() {
        for rows in [&trajectory.positions, &trajectory.velocities, &trajectory.accelerations] {
            out.numbers(rows.get(i).map_or(&[], Vec::as_slice));
        }
        out.numbers(&[]);
        out.time(super::nanoseconds(*time));
    }
    out.done()
}

/// Where the joints are at a moment of a recording.
pub(super) fn joint_state(recording: &Recording, moment: usize) -> Vec<u8> {
    let sampled = &recording.sampled;
    let mut out = Writer::new();
    out.header(super::nanoseconds(sampled.times[moment]), "");
    names(&mut out, sampled);
    for rows in [&sampled.positions, &sampled.velocities] {
        out.numbers(rows.get(moment).map_or(&[], Vec::as_slice));
    }
    out.numbers(&[]);
    out.done()
}

fn names(out: &mut Writer, trajectory: &TrajectoryFile) {
    out.u32(trajectory.joints.len() as u32);
    trajectory.joints.iter().for_each(|joint| out.text(&joint.name));
}

/// Where bodies are in the world.
pub(super) fn transforms(frames: &[String], poses: &[Isometry3<f64>], time: u64) -> Vec<u8> {
    let mut out = Writer::new();
    out.u32(frames.len() as u32);
    for (frame, pose) in frames.iter().zip(poses) {
        out.header(time, super::WORLD);
        out.text(frame);
        place(&mut out, pose);
    }
    out.done()
}

/// Position or translation, then the quaternion x y z w.
fn place(out: &mut Writer, pose: &Isometry3<f64>) {
    out.f64s(pose.translation.vector.iter().copied());
    out.f64s(pose.rotation.coords.iter().copied());
}

/// All bodies as markers, each in the frame of the same index.
pub(super) fn markers(bodies: &[RecordedBody], frames: &[String]) -> Vec<u8> {
    const LINES: u32 = 5;
    const TRIANGLES: u32 = 11;
    /// How wide lines are (m).
    const WIDTH: f64 = 0.005;
    let mut out = Writer::new();
    out.u32(bodies.len() as u32);
    for (i, (body, frame)) in bodies.iter().zip(frames).enumerate() {
        let (kind, points, scale) = match &body.shape {
            RecordedShape::Triangles(points) => (TRIANGLES, points, 1.0),
            RecordedShape::Lines(points) => (LINES, points, WIDTH),
        };
        out.header(0, frame);
        out.text(&body.name);
        out.u32(i as u32);
        out.u32(kind);
        out.u32(0);
        place(&mut out, &body.pose);
        out.f64s([scale; 3]);
        out.f32s(body.color);
        // It is shown for ever, and goes with its frame.
        out.time(0);
        out.u8(1);
        out.u32(points.len() as u32);
        points.iter().for_each(|point| out.f64s(point.iter().copied()));
        // Neither colours of points, nor a texture with its image and coordinates, nor text, nor a mesh by name or inside.
        out.u32(0);
        out.text("");
        out.header(0, "");
        out.text("");
        out.u32(0);
        out.u32(0);
        out.text("");
        out.text("");
        out.text("");
        out.u32(0);
        out.u8(0);
    }
    out.done()
}

/// A `JointTrajectory`; with `several`, the `RobotTrajectory` of MoveIt, which begins with one.
pub(super) fn read_joint_trajectory(bytes: &[u8], several: bool) -> Option<Message> {
    let mut bytes = Reader::new(bytes)?;
    let read = |bytes: &mut Reader<'_>| -> Option<Message> {
        bytes.time()?;
        bytes.text()?;
        let names = bytes.list(Reader::text)?;
        let points = bytes.list(|bytes| {
            let [positions, velocities, accelerations] =
                [bytes.numbers()?, bytes.numbers()?, bytes.numbers()?];
            bytes.numbers()?;
            let [sec, nanosec] = bytes.time()?;
            Some(Point {
                positions,
                velocities,
                accelerations,
                time_from_start: Time::Duration { sec, nanosec },
            })
        })?;
        Some(Message::of_joints(names, points))
    };
    let message = read(&mut bytes)?;
    if !several {
        return Some(message);
    }
    bytes.time()?;
    bytes.text()?;
    Some(message.beside(bytes.list(Reader::text)?))
}

/// The stamp, the names and the positions of a `JointState`.
pub(super) fn read_joint_state(bytes: &[u8]) -> Option<([i64; 2], Vec<String>, Vec<f64>)> {
    let mut bytes = Reader::new(bytes)?;
    let stamp = bytes.time()?;
    bytes.text()?;
    Some((stamp, bytes.list(Reader::text)?, bytes.numbers()?))
}
