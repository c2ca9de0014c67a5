//! Palettes of at most 256 colours for many pictures, by splitting boxes of colours where they vary most
//! (after P. Heckbert, "Color image quantization for frame buffer display", 1982).

use crate::picture::Picture;
use std::collections::BTreeMap;

/// Bits of each channel by which colours are told apart.
const BITS: u32 = 6;

/// A cell of colours that are taken for one.
fn cell(p: [u8; 3]) -> usize {
    p.iter().fold(0, |cell, c| (cell << BITS) | usize::from(c >> (8 - BITS)))
}

/// Colours, and the one to take for each pixel.
#[derive(Debug)]
pub(crate) struct Palette {
    pub(crate) colours: Vec<[u8; 3]>,
    /// For each cell the index of its colour; `u16::MAX` where it has not been looked for.
    index: Vec<u16>,
}

/// Colours in a part of the space of colours: mean and weight of each cell.
struct Colours(Vec<([f64; 3], f64)>);

impl Colours {
    /// The weighted mean, and for each channel the weighted sum of squared differences from it.
    fn spread(&self) -> ([f64; 3], [f64; 3]) {
        let weight: f64 = self.0.iter().map(|(_, w)| w).sum();
        let of = |k: usize| {
            let mean = self.0.iter().map(|(c, w)| w * c[k]).sum::<f64>() / weight;
            (mean, self.0.iter().map(|(c, w)| w * mp_math::powi(c[k] - mean, 2)).sum::<f64>())
        };
        let [r, g, b] = [of(0), of(1), of(2)];
        ([r.0, g.0, b.0], [r.1, g.1, b.1])
    }
}

impl Palette {
    /// A palette of at most `most` colours for pictures like `samples`.
    pub(crate) fn new(samples: &[Picture], most: usize) -> Self {
        let mut cells: BTreeMap<usize, ([f64; 3], f64)> = BTreeMap::new();
        for p in samples.iter().flat_map(|picture| picture.rgb().as_chunks::<3>().0) {
            let (sum, count) = cells.entry(cell(*p)).or_default();
            (0..3).for_each(|k| sum[k] += f64::from(p[k]));
            *count += 1.0;
        }
        // By less than their count: small things in colours of their own keep them.
        let mean = |(sum, count): ([f64; 3], f64)| (sum.map(|s| s / count), mp_math::powf(count, 0.75));
        let all = Colours(cells.into_values().map(mean).collect());
        let spread = all.spread();
        let mut boxes = vec![(all, spread)];
        while boxes.len() < most {
            let total = |b: &(Colours, ([f64; 3], [f64; 3]))| b.1.1.iter().sum::<f64>();
            let widest = (0..boxes.len()).max_by(|&a, &b| total(&boxes[a]).total_cmp(&total(&boxes[b])));
            let Some(widest) = widest.filter(|&i| boxes[i].0.0.len() > 1 && total(&boxes[i]) > 0.0) else {
                break;
            };
            let (colours, (middle, variance)) = boxes.swap_remove(widest);
            let axis = (0..3).max_by(|&a, &b| variance[a].total_cmp(&variance[b])).unwrap_or(0);
            let (low, high): (Vec<_>, Vec<_>) =
                colours.0.into_iter().partition(|(c, _)| c[axis] <= middle[axis]);
            for part in [low, high].into_iter().filter(|part| !part.is_empty()).map(Colours) {
                let spread = part.spread();
                boxes.push((part, spread));
            }
        }
        let mut colours: Vec<[u8; 3]> =
            boxes.iter().map(|(_, (mean, _))| mean.map(|c| c.round().clamp(0.0, 255.0) as u8)).collect();
        colours.sort_unstable();
        colours.dedup();
        Self { colours, index: vec![u16::MAX; 1 << (3 * BITS)] }
    }

    /// The index of the nearest colour.
    pub(crate) fn nearest(&mut self, p: [u8; 3]) -> u8 {
        let known = &mut self.index[cell(p)];
        if *known == u16::MAX {
            // The first pixel of a cell must not decide: its middle does.
            let middle = p.map(|c| i32::from((c >> (8 - BITS)) << (8 - BITS)) + (1 << (7 - BITS)));
            let away = |c: &[u8; 3]| -> i32 { (0..3).map(|k| (i32::from(c[k]) - middle[k]).pow(2)).sum() };
            let nearest = (0..self.colours.len()).min_by_key(|&i| away(&self.colours[i]));
            *known = nearest.unwrap_or(0) as u16;
        }
        *known as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colours_are_kept_and_many_are_near() {
        let few = [[255, 255, 255], [46, 158, 91], [207, 58, 58], [0, 0, 0]];
        let picture = Picture::from_fn((100, 100), |x, y| few[if y == 0 { x % 4 } else { 0 }]);
        let mut palette = Palette::new(&[picture], 255);
        assert_eq!(palette.colours.len(), 4);
        for colour in few {
            let found = palette.nearest(colour);
            assert_eq!(palette.colours[usize::from(found)], colour);
        }
        let many = Picture::from_fn((256, 256), |x, y| [x as u8, y as u8, (x ^ y) as u8]);
        let mut palette = Palette::new(std::slice::from_ref(&many), 255);
        assert_eq!(palette.colours.len(), 255);
        let away = |p: [u8; 3], q: [u8; 3]| p.iter().zip(q).map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0);
        let pixels = many.rgb().as_chunks::<3>().0;
        let worst = pixels.iter().map(|&p| {
            let i = palette.nearest(p);
            away(p, palette.colours[usize::from(i)])
        });
        assert!(worst.max() < Some(60));
    }
}
