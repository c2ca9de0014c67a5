//! Layers of samples in linear light, and their conversion to pixels.

use crate::picture::Picture;
use std::sync::LazyLock;

/// Linear red, green and blue, 0 to 1.
pub(crate) type Colour = [f32; 3];

/// The linear colour of an sRGB one.
pub(crate) fn srgb(hex: u32) -> Colour {
    [16, 8, 0].map(|shift| {
        let v = f64::from((hex >> shift) & 255) / 255.0;
        (if v <= 0.04045 { v / 12.92 } else { mp_math::powf((v + 0.055) / 1.055, 2.4) }) as f32
    })
}

/// `a` for `t` = 0, `b` for `t` = 1.
pub(crate) fn mix(a: Colour, b: Colour, t: f32) -> Colour {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t)
}

/// `c` times `f`.
pub(crate) fn scaled(c: Colour, f: f32) -> Colour {
    c.map(|v| v * f)
}

/// The visible colour at each sample, and its depth key.
#[derive(Clone, Debug)]
pub(crate) struct Layer {
    pub(crate) colour: Vec<Colour>,
    pub(crate) key: Vec<f32>,
}

impl Layer {
    pub(crate) fn new(samples: usize) -> Self {
        Self { colour: vec![[0.0; 3]; samples], key: vec![f32::INFINITY; samples] }
    }

    /// Puts `colour` at sample `i` when it is nearer than the present one.
    #[inline]
    pub(crate) fn put(&mut self, i: usize, key: f32, colour: Colour) {
        if key < self.key[i] {
            self.key[i] = key;
            self.colour[i] = colour;
        }
    }
}

/// Translucent surfaces in front of a [`Layer`], in any order: their colours are averaged by weight, and each
/// absorbs its share of the light from behind (weighted blended transparency, McGuire and Bavoil 2013).
#[derive(Clone, Debug)]
pub(crate) struct Veil {
    sum: Vec<Colour>,
    weight: Vec<f32>,
    /// The share of the light from behind that comes through, where there is a surface.
    through: Vec<f32>,
    /// The largest opacity of a surface.
    most: Vec<f32>,
    /// Whether there is no surface at all.
    empty: bool,
}

impl Veil {
    pub(crate) fn new(samples: usize) -> Self {
        // Zeros only: memory that no surface touches is not even there.
        let [weight, through, most] = [(); 3].map(|()| vec![0.0; samples]);
        Self { sum: vec![[0.0; 3]; samples], weight, through, most, empty: true }
    }

    /// Adds a surface of opacity `alpha` whose colour counts `weight` times.
    #[inline]
    pub(crate) fn add(&mut self, i: usize, colour: Colour, alpha: f32, weight: f32) {
        let w = alpha * weight;
        self.empty = false;
        if self.weight[i] == 0.0 {
            self.through[i] = 1.0;
        }
        for (sum, c) in self.sum[i].iter_mut().zip(colour) {
            *sum += w * c;
        }
        self.weight[i] += w;
        self.through[i] *= 1.0 - alpha;
        self.most[i] = self.most[i].max(alpha);
    }

    /// Blends the veil over `behind`, of which at most the fraction `most` is hidden, unless one surface alone
    /// hides more.
    pub(crate) fn over(&self, behind: &mut [Colour], most: f32) {
        if self.empty {
            return;
        }
        for (i, b) in behind.iter_mut().enumerate() {
            if self.weight[i] > 0.0 {
                let hidden = (1.0 - self.through[i]).min(most.max(self.most[i]));
                *b = mix(*b, scaled(self.sum[i], 1.0 / self.weight[i]), hidden);
            }
        }
    }
}

/// Averages `factor` × `factor` samples per pixel, in linear light, into 8-bit sRGB.
pub(crate) fn resolve(samples: &[Colour], (width, height): (usize, usize), factor: usize) -> Picture {
    let (w, h) = (width / factor, height / factor);
    let (share, curve) = (1.0 / (factor * factor) as f32, &*CURVE);
    Picture::from_fn((w, h), |x, y| {
        let mut sum = [0.0; 3];
        for dy in 0..factor {
            let row = (y * factor + dy) * width + x * factor;
            for c in &samples[row..row + factor] {
                for (s, c) in sum.iter_mut().zip(c) {
                    *s += c.clamp(0.0, 1.0);
                }
            }
        }
        sum.map(|s| curve[(s * share * GRID as f32 + 0.5) as usize])
    })
}

/// Steps of [`CURVE`].
const GRID: usize = 4096;

/// The inverse of the sRGB curve on a grid: exact to well under one step of 8 bits.
static CURVE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let of = |i: usize| {
        let v = i as f64 / GRID as f64;
        let s = if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * mp_math::powf(v, 1.0 / 2.4) - 0.055 };
        (s * 255.0 + 0.5) as u8
    };
    (0..=GRID).map(of).collect()
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_round_trips() {
        for hex in [0x00_00_00, 0xff_ff_ff, 0x12_34_56, 0xc0_ff_ee] {
            let pixel = resolve(&[srgb(hex); 4], (2, 2), 2);
            let [r, g, b] = pixel.pixel(0, 0).unwrap().map(u32::from);
            let wanted = [(hex >> 16) & 255, (hex >> 8) & 255, hex & 255];
            for (got, want) in [r, g, b].into_iter().zip(wanted) {
                assert!(got.abs_diff(want) <= 1, "{hex:06x}: {got} {want}");
            }
        }
    }

    #[test]
    fn the_order_of_a_veil_does_not_matter() {
        let (red, blue) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        let (mut a, mut b) = (Veil::new(1), Veil::new(1));
        for c in [red, blue] {
            a.add(0, c, 0.5, 1.0);
        }
        for c in [blue, red] {
            b.add(0, c, 0.5, 1.0);
        }
        let (mut over_a, mut over_b) = ([[1.0; 3]], [[1.0; 3]]);
        a.over(&mut over_a, 1.0);
        b.over(&mut over_b, 1.0);
        assert_eq!(over_a, over_b);
        assert!((over_a[0][1] - 0.25).abs() < 1e-6);
    }

    /// What many faint surfaces hide is limited; what one of them hides is not.
    #[test]
    fn a_surface_hides_as_much_as_it_is_opaque() {
        for (alpha, count, left) in [(0.1, 40, 0.5), (0.9, 1, 0.1), (0.9, 3, 0.1)] {
            let mut veil = Veil::new(1);
            (0..count).for_each(|_| veil.add(0, [0.0; 3], alpha, 1.0));
            let mut behind = [[1.0; 3]];
            veil.over(&mut behind, 0.5);
            assert!((behind[0][0] - left).abs() < 1e-6, "{alpha} {count}: {behind:?}");
        }
    }
}
