//! Poses as elements of MJCF have them.

use super::document::{Element, Model, Said};
use mp_formats::error::Error;
use nalgebra::{Isometry3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};

/// Shorter vectors (m) have no direction.
const NO_LENGTH: f64 = 1e-10;

/// What `compiler` says.
pub(super) struct Compiler<'m> {
    /// Radians of a unit of angles.
    pub(super) angle: f64,
    /// The axes of three Euler angles; those in small letters turn with the frame.
    sequence: [char; 3],
    /// The folder of meshes.
    pub(super) meshes: &'m str,
    /// Whether names of files lose their folders.
    pub(super) strips: bool,
    /// Whether a range means that a joint has limits.
    pub(super) auto_limits: bool,
}

impl<'m> Compiler<'m> {
    pub(super) fn of(model: &Model<'m>) -> Result<Self, Error> {
        let mut read = Self {
            angle: 1f64.to_radians(),
            sequence: ['x', 'y', 'z'],
            meshes: "",
            strips: false,
            auto_limits: true,
        };
        for node in model.sections("compiler") {
            let wrong = |key: &str, expected: &str| {
                let message = format!("{key} of <compiler> is not known");
                Err(model.error(node, message).expected(expected).help(format!("correct {key}=\"…\"")))
            };
            // Of one element the folder of meshes counts, of several what was said last.
            read.meshes = node.attribute("assetdir").unwrap_or(read.meshes);
            for attribute in node.attributes() {
                match (attribute.name(), attribute.value()) {
                    ("angle", "degree") => read.angle = 1f64.to_radians(),
                    ("angle", "radian") => read.angle = 1.0,
                    ("angle", _) => return wrong("angle", "degree or radian"),
                    ("coordinate", "local") => {}
                    ("coordinate", _) => {
                        return wrong(
                            "coordinate",
                            "local; save the model by MuJoCo 2.3 or older, which makes it so",
                        );
                    }
                    ("eulerseq", letters) => match letters.chars().collect::<Vec<_>>().try_into() {
                        Ok(sequence) if letters.chars().all(|c| "xyzXYZ".contains(c)) => {
                            read.sequence = sequence
                        }
                        _ => return wrong("eulerseq", "three letters of xyzXYZ"),
                    },
                    ("meshdir", folder) => read.meshes = folder,
                    ("strippath", value) => read.strips = value == "true",
                    ("autolimits", value) => read.auto_limits = value == "true",
                    _ => {}
                }
            }
        }
        Ok(read)
    }

    /// The pose of an element in the one around it.
    pub(super) fn pose(&self, said: &Said<'_, 'm>) -> Result<Isometry3<f64>, Error> {
        let at = said.numbers::<3>("pos")?.unwrap_or_default();
        Ok(Isometry3::from_parts(Translation3::from(Vector3::from(at)), self.turn(said)?))
    }

    /// How an element is turned in the one around it.
    pub(super) fn turn(&self, said: &Said<'_, 'm>) -> Result<UnitQuaternion<f64>, Error> {
        let direction = |key: &'m str, v: Vector3<f64>| {
            Unit::try_new(v, NO_LENGTH).ok_or_else(|| said.wrong(key, "a vector that has a direction"))
        };
        if let Some([w, x, y, z]) = said.numbers::<4>("quat")?.filter(|_| !turned_otherwise(said.node)) {
            let turn = mp_geom::pose_from_quaternion([0.0; 3], w, x, y, z);
            return turn
                .map(|pose| pose.rotation)
                .map_err(|_| said.wrong("quat", "w x y z, not all of them 0"));
        }
        if let Some([x, y, z, angle]) = said.numbers::<4>("axisangle")? {
            return Ok(turned(direction("axisangle", Vector3::new(x, y, z))?, angle * self.angle));
        }
        if let Some([a, b, c, d, e, f]) = said.numbers::<6>("xyaxes")? {
            let x = direction("xyaxes", Vector3::new(a, b, c))?;
            let y = Vector3::new(d, e, f);
            let y = direction("xyaxes", y - x.dot(&y) * x.into_inner())?;
            let axes = nalgebra::Matrix3::from_columns(&[x.into_inner(), y.into_inner(), x.cross(&y)]);
            return Ok(UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(
                axes,
            )));
        }
        if let Some(z) = said.numbers::<3>("zaxis")? {
            return Ok(onto(direction("zaxis", Vector3::from(z))?));
        }
        let Some(angles) = said.numbers::<3>("euler")? else { return Ok(UnitQuaternion::identity()) };
        let step = |all: UnitQuaternion<f64>, (axis, angle): (&char, f64)| {
            let own = match axis.to_ascii_lowercase() {
                'x' => Vector3::x_axis(),
                'y' => Vector3::y_axis(),
                _ => Vector3::z_axis(),
            };
            let next = turned(own, angle * self.angle);
            if axis.is_ascii_lowercase() { all * next } else { next * all }
        };
        Ok(self.sequence.iter().zip(angles).fold(UnitQuaternion::identity(), step))
    }
}

/// Whether an element has another turn than that of its class, which may be a quaternion.
fn turned_otherwise(node: Element<'_>) -> bool {
    ["axisangle", "xyaxes", "zaxis", "euler"].iter().any(|key| node.has_attribute(*key))
}

/// The turn about an axis, with the same bits everywhere.
pub(super) fn turned(axis: Unit<Vector3<f64>>, angle: f64) -> UnitQuaternion<f64> {
    let (sin, cos) = mp_math::sin_cos(0.5 * angle);
    UnitQuaternion::new_normalize(Quaternion::from_parts(cos, sin * axis.into_inner()))
}

/// The shortest turn of the z axis onto a direction.
pub(super) fn onto(z: Unit<Vector3<f64>>) -> UnitQuaternion<f64> {
    let across = Vector3::z().cross(&z);
    let axis = Unit::try_new(across, NO_LENGTH).unwrap_or_else(Vector3::x_axis);
    turned(axis, mp_math::atan2(across.norm(), z.z))
}
