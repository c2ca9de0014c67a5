//! Maps of ROS's map_server: a YAML file and an image.

use super::{GUIDE, GridMap};
use crate::error::{Error, ErrorKind};
use crate::files::decode;
use crate::problem::MAX_COORDINATE;
use mp_geom::planar::Polygon;
use nalgebra::Isometry2;

/// The content of the YAML file of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct RosMap {
    /// The name of the image.
    pub image: String,
    /// Metres per pixel.
    pub resolution: f64,
    /// x, y (m) and yaw (rad) of the lower left corner.
    pub origin: [f64; 3],
    /// Whether white pixels are occupied, instead of black ones.
    pub negate: bool,
    /// A pixel is occupied when it is more likely occupied than this.
    pub occupied_thresh: f64,
    /// A pixel is free when it is less likely occupied than this.
    pub free_thresh: f64,
}

impl RosMap {
    /// Reads `bytes`, the content of a YAML file of map_server that errors call `file`: `image`, `resolution` and
    /// `origin`, and, with defaults, `negate` (0), `occupied_thresh` (0.65), `free_thresh`
    /// (0.196) and `mode` (`trinary`, the only one read). Other keys are skipped.
    ///
    /// # Errors
    /// [`Error`] with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        let text = decode(file, bytes)?;
        let at = |start: usize, length: usize, message: String| {
            Error::at(ErrorKind::Format, file, text, start, length.max(1), message).help(GUIDE)
        };
        let (mut image, mut resolution, mut origin) = (None, None, None);
        let mut map = Self {
            image: String::new(),
            resolution: 0.0,
            origin: [0.0; 3],
            negate: false,
            occupied_thresh: 0.65,
            free_thresh: 0.196,
        };
        let mut lines = Lines { text, at: 0 }.peekable();
        while let Some((start, line)) = lines.next() {
            let line = line.trim_end();
            if line.is_empty() || line == "---" || line == "..." {
                continue;
            }
            let Some((key, value)) = line.split_once(':') else {
                let message = format!("`{}` has no key", crate::text::clipped(line));
                return Err(at(start, line.len(), message).expected("lines of the form `key: value`"));
            };
            let place = start + key.len() + 1;
            let (key, value) = (key.trim(), unquoted(value));
            let number = |word: &str, what: &str| match word.trim().parse::<f64>() {
                Ok(v) if v.is_finite() && v.abs() <= MAX_COORDINATE => Ok(v),
                _ => {
                    let message = format!("`{}` is not {what}", crate::text::clipped(word));
                    Err(at(place, line.len() - key.len() - 1, message).expected("a finite number"))
                }
            };
            let share = |word: &str| match number(word, "a probability")? {
                v if (0.0..=1.0).contains(&v) => Ok(v),
                v => Err(at(place, 1, format!("{v} is not a probability")).expected("a number from 0 to 1")),
            };
            match key {
                "image" => image = Some(value.to_owned()),
                "resolution" => {
                    let v = number(value, "metres per pixel")?;
                    if v <= 0.0 {
                        return Err(
                            at(place, 1, format!("the resolution is {v}")).expected("metres above zero")
                        );
                    }
                    resolution = Some(v);
                }
                "origin" => {
                    let mut words: Vec<String> = Vec::new();
                    if value.is_empty() {
                        while let Some((_, item)) = lines.next_if(|(_, l)| l.trim_start().starts_with('-')) {
                            // The hyphen of the list, not that of a number.
                            words.push(item.trim_start()[1..].trim().to_owned());
                        }
                    } else {
                        let inner =
                            value.strip_prefix('[').and_then(|v| v.strip_suffix(']')).unwrap_or(value);
                        words.extend(inner.split(',').map(str::to_owned));
                    }
                    let [x, y, yaw] = words.as_slice() else {
                        let message = format!("the origin has {} numbers", words.len());
                        return Err(at(place, line.len() - key.len(), message).expected("`[x, y, yaw]`"));
                    };
                    let what = "a number of the origin";
                    origin = Some([number(x, what)?, number(y, what)?, number(yaw, what)?]);
                }
                "negate" => {
                    map.negate = match value {
                        "0" | "false" => false,
                        "1" | "true" => true,
                        _ => return Err(at(place, 1, "negate is neither 0 nor 1".into()).expected("0 or 1")),
                    }
                }
                "occupied_thresh" => map.occupied_thresh = share(value)?,
                "free_thresh" => map.free_thresh = share(value)?,
                "mode" if value != "trinary" => {
                    let message = format!("maps of mode `{}` are not read", crate::text::clipped(value));
                    return Err(at(place, 1, message)
                        .expected("`trinary`")
                        .with_kind(ErrorKind::Unsupported));
                }
                _ => {}
            }
        }
        let missing = |what: &str| {
            at(text.len(), 0, format!("the map has no `{what}`")).expected(format!("`{what}: …`"))
        };
        map.image = image.filter(|name| !name.is_empty()).ok_or_else(|| missing("image"))?;
        map.resolution = resolution.ok_or_else(|| missing("resolution"))?;
        map.origin = origin.ok_or_else(|| missing("origin"))?;
        if map.free_thresh > map.occupied_thresh {
            let message = "free_thresh is above occupied_thresh".to_owned();
            return Err(
                at(0, 1, message).expected("the threshold of what is free below that of what is occupied")
            );
        }
        Ok(map)
    }

    /// The obstacles of the map whose image is `grid`, unknown pixels included unless they are free; `None` when there are none.
    ///
    /// # Errors
    /// When coordinates are not finite or beyond 10⁶⁰, or `interrupt` says to end.
    pub fn outline(
        &self,
        grid: &GridMap,
        unknown_is_free: bool,
        interrupt: &mp_stop::Interrupt,
    ) -> Result<Option<Polygon>, mp_geom::planar::PolygonError> {
        let occupied = |brightness: f32| {
            let v = f64::from(brightness) / 255.0;
            let probability = if self.negate { v } else { 1.0 - v };
            if unknown_is_free {
                probability > self.occupied_thresh
            } else {
                // All that is not free is an obstacle, unknown pixels included.
                probability >= self.free_thresh
            }
        };
        let [x, y, yaw] = self.origin;
        let polygon = grid.outline(self.resolution, [0.0; 2], occupied, interrupt)?;
        Ok(polygon.map(|p| p.transformed(&Isometry2::new([x, y].into(), yaw))))
    }
}

/// A value without its comment and quotes.
fn unquoted(value: &str) -> &str {
    let value = value.trim();
    for quote in ['"', '\''] {
        if let Some(inner) = value.strip_prefix(quote).and_then(|v| v.split_once(quote)) {
            return inner.0;
        }
    }
    value.split(" #").next().unwrap_or(value).trim()
}

/// Lines and where they begin; a line that is a comment is empty.
struct Lines<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a str);
    fn next(&mut self) -> Option<Self::Item> {
        if self.at >= self.text.len() {
            return None;
        }
        let start = self.at;
        let rest = &self.text[start..];
        let length = rest.find('\n').map_or(rest.len(), |i| i + 1);
        self.at += length;
        let line = &rest[..length];
        Some((start, if line.trim_start().starts_with('#') { "" } else { line.trim_end() }))
    }
}
