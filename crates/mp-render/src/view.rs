//! From where a scene is seen, and how its bodies are drawn.

use crate::error::RenderError;
use nalgebra::Point3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6, PI};
use std::str::FromStr;

/// The field of view of the height of the picture, when none is given: 40°, in radians.
const FIELD_OF_VIEW: f64 = 0.698_131_700_797_731_8;

/// How bodies in space are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Opaque; obstacles in front of the path fade out.
    #[default]
    Solid,
    /// Edges only; faint where something hides them.
    Wire,
    /// Obstacles are seen through.
    Transparent,
}

impl Mode {
    /// All modes, with their names.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Solid, "solid"), (Self::Wire, "wire"), (Self::Transparent, "transparent")];
}

impl FromStr for Mode {
    type Err = RenderError;

    /// `solid`, `wire` or `transparent`.
    fn from_str(text: &str) -> Result<Self, RenderError> {
        let named = Self::ALL.into_iter().find(|(_, name)| *name == text);
        named.map(|(mode, _)| mode).ok_or_else(|| RenderError::Text {
            text: text.to_owned(),
            expected: "a mode: solid, wire or transparent",
        })
    }
}

/// From where a scene in space is seen. z is up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum View {
    /// From where most of the path is visible, with everything on the picture; planar scenes are seen from
    /// above.
    #[default]
    Best,
    /// From a direction, with everything on the picture.
    From {
        /// The angle (radians) from x, counter-clockwise seen from above, to the direction of the eye.
        azimuth: f64,
        /// The angle (radians) of the eye above the horizon.
        elevation: f64,
        /// Whether the projection is parallel; otherwise it is perspective.
        parallel: bool,
    },
    /// From a place.
    At {
        /// The place of the eye, metres.
        eye: Point3<f64>,
        /// The point in the middle of the picture, metres.
        target: Point3<f64>,
        /// The field of view (radians) of the height of the picture, at the target.
        field_of_view: f64,
        /// Whether the projection is parallel; otherwise it is perspective.
        parallel: bool,
    },
}

/// The azimuth and elevation of the standard views.
const STANDARD: [(&str, [f64; 2]); 7] = [
    ("front", [-FRAC_PI_2, 0.0]),
    ("back", [FRAC_PI_2, 0.0]),
    ("left", [PI, 0.0]),
    ("right", [0.0, 0.0]),
    ("top", [-FRAC_PI_2, FRAC_PI_2]),
    ("bottom", [-FRAC_PI_2, -FRAC_PI_2]),
    ("iso", [-FRAC_PI_3, FRAC_PI_6]),
];

impl View {
    /// The names of the standard views.
    pub fn names() -> impl Iterator<Item = &'static str> {
        STANDARD.iter().map(|(name, _)| *name)
    }

    /// Refuses places that make no picture.
    pub(crate) fn check(&self) -> Result<(), RenderError> {
        let wrong = |text: String, expected| Err(RenderError::Text { text, expected });
        match self {
            Self::Best => Ok(()),
            Self::From { azimuth, elevation, .. } if azimuth.is_finite() && elevation.is_finite() => Ok(()),
            Self::From { azimuth, elevation, .. } => {
                wrong(format!("{azimuth}, {elevation}"), "a finite azimuth and elevation")
            }
            Self::At { eye, target, field_of_view, .. } => {
                let distance = (eye - target).norm();
                if !(1e-6..=1e12).contains(&distance) || eye.coords.amax() > 1e12 {
                    return wrong(
                        format!("eye {:?}, target {:?}", eye.coords.as_slice(), target.coords.as_slice()),
                        "an eye and a target that differ, both within 1e12 m",
                    );
                }
                if !(0.1f64..=170.0).contains(&field_of_view.to_degrees()) {
                    return wrong(
                        format!("fov={}", field_of_view.to_degrees()),
                        "a field of view from 0.1 to 170 degrees",
                    );
                }
                Ok(())
            }
        }
    }
}

impl FromStr for View {
    type Err = RenderError;

    /// `best`, a standard view (`front`, `back`, `left`, `right`, `top`, `bottom`, `iso`), or
    /// `eye=x,y,z target=x,y,z fov=degrees`, where `fov` may be left out; then `ortho` for a parallel
    /// projection.
    fn from_str(text: &str) -> Result<Self, RenderError> {
        const FORMS: &str = "front, back, left, right, top, bottom or iso, or \"eye=x,y,z target=x,y,z fov=degrees\", \
                             each also with ortho";
        let wrong = |word: &str, expected| Err(RenderError::Text { text: word.to_owned(), expected });
        let (mut standard, mut eye, mut target, mut fov, mut parallel, mut best) =
            (None, None, None, None, false, false);
        for word in text.split_whitespace() {
            let again = match word.split_once('=') {
                Some((name @ ("eye" | "target"), numbers)) => {
                    let Some(point) = point(numbers) else {
                        return wrong(word, "three numbers in metres, as in eye=1,-2,0.5");
                    };
                    if name == "eye" { &mut eye } else { &mut target }.replace(point).is_some()
                }
                Some(("fov", degrees)) => match degrees.parse::<f64>() {
                    Ok(degrees) => fov.replace(degrees.to_radians()).is_some(),
                    Err(_) => return wrong(word, "a number of degrees, as in fov=40"),
                },
                None if word == "ortho" => std::mem::replace(&mut parallel, true),
                None if word == "best" => std::mem::replace(&mut best, true),
                _ => match STANDARD.iter().find(|(name, _)| *name == word) {
                    Some((_, angles)) => standard.replace(*angles).is_some(),
                    None => return wrong(word, FORMS),
                },
            };
            if again {
                return wrong(text, "each part once");
            }
        }
        let view = match (best, standard, eye, target, fov) {
            (true, None, None, None, None) if !parallel => Self::Best,
            (false, Some([azimuth, elevation]), None, None, None) => {
                Self::From { azimuth, elevation, parallel }
            }
            (false, None, Some(eye), Some(target), fov) => {
                Self::At { eye, target, field_of_view: fov.unwrap_or(FIELD_OF_VIEW), parallel }
            }
            (_, None, Some(_), None, _) => return wrong(text, "a target too, as in target=0,0,1"),
            (_, None, None, Some(_), _) => return wrong(text, "an eye too, as in eye=5,-5,3"),
            _ => return wrong(text, FORMS),
        };
        view.check()?;
        Ok(view)
    }
}

/// `x,y,z`
fn point(text: &str) -> Option<Point3<f64>> {
    let numbers: Vec<f64> = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
    let three = <[f64; 3]>::try_from(numbers).ok()?;
    three.iter().all(|c| c.is_finite()).then(|| three.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_are_read() {
        assert_eq!("best".parse(), Ok(View::Best));
        assert_eq!(" right ".parse(), Ok(View::From { azimuth: 0.0, elevation: 0.0, parallel: false }));
        for name in View::names() {
            assert!(matches!(name.parse(), Ok(View::From { parallel: false, .. })), "{name}");
            assert!(matches!(format!("{name} ortho").parse(), Ok(View::From { parallel: true, .. })));
        }
        let at = "eye=1,-2,3e1 target=0,0,0 fov=60 ortho".parse();
        let field_of_view = 60.0f64.to_radians();
        let (eye, target) = (Point3::new(1.0, -2.0, 30.0), Point3::origin());
        assert_eq!(at, Ok(View::At { eye, target, field_of_view, parallel: true }));
        let without: View = "target=0,0,0 eye=1,0,0".parse().unwrap();
        assert!(
            matches!(without, View::At { field_of_view, .. } if (field_of_view.to_degrees() - 40.0).abs() < 1e-9)
        );
    }

    #[test]
    fn other_texts_are_refused_with_what_is_expected() {
        for (text, words) in [
            ("", "front, back"),
            ("ortho", "front, back"),
            ("best ortho", "front, back"),
            ("fronte", "front, back"),
            ("front back", "once"),
            ("front eye=1,2,3", "front, back"),
            ("eye=1,2 target=0,0,0", "three numbers"),
            ("eye=1,2,nan target=0,0,0", "three numbers"),
            ("eye=1,2,3", "a target too"),
            ("target=1,2,3", "an eye too"),
            ("eye=1,2,3 target=1,2,3", "that differ"),
            ("eye=1,2,3 target=0,0,0 fov=180", "170"),
            ("eye=1,2,3 target=0,0,0 fov=wide", "degrees"),
            ("eye=1,2,3 eye=1,2,3 target=0,0,0", "once"),
        ] {
            let error = text.parse::<View>().unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
        assert!("solids".parse::<Mode>().unwrap_err().to_string().contains("wire"));
        assert_eq!("wire".parse(), Ok(Mode::Wire));
    }
}
