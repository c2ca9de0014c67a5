//! Fields that push snakes, by name.

use crate::{Error, positive_number};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// The field that pushes snakes: a path that is relaxed, and with the setting `field` the edges of the planners `rrs` and
/// `rrs-connect`. As text, `clearance`, `paper`, `risk`, `risk:FACTOR` or `image:FILE`.
///
/// All but [`Clearance`](Self::Clearance) are images of the plane, for robots in worlds of the plane: 7.5 cells are as long as the
/// range, and no side has more than 2048. The image of a world is dark where the robot touches something; where that is a
/// polygon, at each of 16 rotations.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum RelaxField {
    /// Obstacles repel: `½·(1 − c/range)²` for a clearance of `c` below the range, which is 3% of the extent of the space.
    #[default]
    Clearance,
    /// Eq. 3 of Baizid et al.: the outlines of obstacles repel, in a blurred image.
    Paper,
    /// The repulsion of obstacles, and a greyscale image (PNG or PGM) over the bounds of the robot: from 0 where it is white to 1
    /// where it is black, blurred by a third of the range.
    Image(PathBuf),
    /// The repulsion of obstacles, and the landscape of risk of the path: where a robot that moves inexactly may hit an obstacle
    /// that was measured inexactly, from 0 to 1 where the risk is greatest. Edges of trees have no path yet: there it is the risk of
    /// [passing everywhere](mp_snake::risk::everywhere). All deviations are those of a small robot on wheels
    /// with a laser, [`MotionNoise`](mp_snake::risk::MotionNoise) and [`RangeNoise`](mp_snake::risk::RangeNoise), times this
    /// factor.
    Risk(f64),
}

impl RelaxField {
    /// How each is written, and what it is.
    pub const ALL: [(&'static str, &'static str); 4] = [
        ("clearance", "obstacles repel (the default)"),
        ("paper", "eq. 3 of Baizid et al.: outlines of obstacles in a blurred image repel (the plane)"),
        (
            "risk",
            "the landscape of risk of inexact motion and sensing; `risk:2` for twice the noise (the plane)",
        ),
        (
            "image:FILE",
            "the dark pixels of a PNG or PGM image over the bounds of the robot repel (the plane)",
        ),
    ];
}

impl fmt::Display for RelaxField {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Clearance => f.write_str("clearance"),
            Self::Paper => f.write_str("paper"),
            Self::Image(file) => write!(f, "image:{}", file.display()),
            Self::Risk(1.0) => f.write_str("risk"),
            Self::Risk(factor) => write!(f, "risk:{factor}"),
        }
    }
}

impl FromStr for RelaxField {
    type Err = Error;
    fn from_str(s: &str) -> Result<Self, Error> {
        match s.split_once(':') {
            None if s == "clearance" => Ok(Self::Clearance),
            None if s == "paper" => Ok(Self::Paper),
            None if s == "risk" => Ok(Self::Risk(1.0)),
            Some(("risk", factor)) => match positive_number(factor) {
                Ok(factor) => Ok(Self::Risk(factor)),
                Err(e) => Err(Error::new(format!("the factor of the noise is `{factor}`: {e}"))
                    .help("give a number, such as risk:2")),
            },
            Some(("image", file)) if !file.is_empty() => Ok(Self::Image(file.into())),
            _ => {
                let names: Vec<_> = Self::ALL.iter().map(|(name, _)| *name).collect();
                Err(Error::new(format!("there is no field `{s}`"))
                    .help(format!("there are: {}", names.join(", "))))
            }
        }
    }
}

crate::as_text!(RelaxField);
