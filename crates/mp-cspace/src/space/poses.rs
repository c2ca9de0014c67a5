//! What the spaces of poses in the plane and in space have in common.

/// Constructors and accessors of a space of poses, with `translations: Rn<$n>` and a `rotation_weight`.
macro_rules! pose_space {
    ($space:ident, $n:literal) => {
        impl $space {
            /// Poses whose translation is in the box from `low` to `high`.
            ///
            /// # Errors
            /// When a bound is not finite or a `low` is not below its `high`.
            pub fn new(
                low: impl Into<nalgebra::SVector<f64, $n>>,
                high: impl Into<nalgebra::SVector<f64, $n>>,
            ) -> Result<Self, $crate::SpaceError> {
                Ok(Self { translations: Rn::new(low, high)?, rotation_weight: 0.5 })
            }

            /// The same poses with another weight of rotation (m/rad).
            ///
            /// # Errors
            /// When the weight is not positive and finite.
            pub fn with_rotation_weight(self, rotation_weight: f64) -> Result<Self, $crate::SpaceError> {
                let rotation_weight = $crate::error::weight("the rotation weight", rotation_weight)?;
                Ok(Self { rotation_weight, ..self })
            }

            /// The box of translations.
            #[must_use]
            pub fn translations(&self) -> &Rn<$n> {
                &self.translations
            }

            /// The weight of rotation, metres per radian.
            #[must_use]
            pub fn rotation_weight(&self) -> f64 {
                self.rotation_weight
            }
        }
    };
}
pub(super) use pose_space;
