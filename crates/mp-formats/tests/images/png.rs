//! PNG files of every kind, written here, so that what they must read as is known.

use super::{read, refused};
use mp_formats::error::ErrorKind;
use mp_formats::grid::GridMap;
use proptest::prelude::*;

const GREY: u8 = 0;
const RGB: u8 = 2;
const PALETTE: u8 = 3;
const GREY_ALPHA: u8 = 4;
const RGBA: u8 = 6;

/// Each colour type with the depths it may have.
const KINDS: [(u8, &[u8]); 5] = [
    (GREY, &[1, 2, 4, 8, 16]),
    (RGB, &[8, 16]),
    (PALETTE, &[1, 2, 4, 8]),
    (GREY_ALPHA, &[8, 16]),
    (RGBA, &[8, 16]),
];

/// First column and row, and steps, of the seven passes of an interlaced image.
const PASSES: [[usize; 4]; 7] =
    [[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]];

/// A PNG file in the making.
#[derive(Clone, Debug)]
struct Image {
    kind: u8,
    depth: u8,
    interlaced: bool,
    size: [usize; 2],
    /// Channels of all pixels.
    samples: Vec<u16>,
    palette: Vec<[u8; 3]>,
    /// The content of the chunk tRNS, if there is one.
    transparency: Option<Vec<u8>>,
}

fn channels(kind: u8) -> usize {
    match kind {
        GREY | PALETTE => 1,
        GREY_ALPHA => 2,
        RGB => 3,
        _ => 4,
    }
}

impl Image {
    fn bytes(&self) -> Vec<u8> {
        let mut out = b"\x89PNG\r\n\x1a\n".to_vec();
        let [width, height] = self.size.map(|n| (n as u32).to_be_bytes());
        let rest = [self.depth, self.kind, 0, 0, u8::from(self.interlaced)];
        chunk(&mut out, b"IHDR", &[&width[..], &height, &rest].concat());
        if self.kind == PALETTE {
            chunk(&mut out, b"PLTE", self.palette.as_flattened());
        }
        if let Some(transparency) = &self.transparency {
            chunk(&mut out, b"tRNS", transparency);
        }
        chunk(&mut out, b"IDAT", &stored(&self.rows()));
        chunk(&mut out, b"IEND", &[]);
        out
    }

    /// The rows, none of them filtered.
    fn rows(&self) -> Vec<u8> {
        let passes = if self.interlaced { &PASSES[..] } else { &[[0, 0, 1, 1]] };
        let mut out = Vec::new();
        for &[x0, y0, dx, dy] in passes {
            if x0 >= self.size[0] {
                continue;
            }
            for y in (y0..self.size[1]).step_by(dy) {
                out.push(0);
                let (mut byte, mut used) = (0_u16, 0);
                let n = channels(self.kind);
                for x in (x0..self.size[0]).step_by(dx) {
                    for &sample in &self.samples[(y * self.size[0] + x) * n..][..n] {
                        if self.depth == 16 {
                            out.extend(sample.to_be_bytes());
                            continue;
                        }
                        byte = byte << self.depth | sample;
                        used += self.depth;
                        if used == 8 {
                            out.push(byte as u8);
                            (byte, used) = (0, 0);
                        }
                    }
                }
                if used > 0 {
                    out.push((byte << (8 - used)) as u8);
                }
            }
        }
        out
    }

    /// What the brightness must be.
    fn brightness(&self) -> Vec<f32> {
        let eight = |v: u16| eight(v, self.depth);
        let pixel = |p: &[u16]| match self.kind {
            PALETTE => self.palette[usize::from(p[0])].map(f32::from).iter().sum::<f32>() / 3.0,
            GREY | GREY_ALPHA => eight(p[0]),
            _ => p[..3].iter().map(|v| eight(*v)).sum::<f32>() / 3.0,
        };
        self.samples.chunks(channels(self.kind)).map(pixel).collect()
    }

    /// What it must be with opacity, if there is any transparency.
    fn with_alpha(&self) -> Option<Vec<f32>> {
        let chunk = self.transparency.as_deref();
        let own = matches!(self.kind, GREY_ALPHA | RGBA);
        let alpha = |p: &[u16]| match (self.kind, chunk) {
            (GREY_ALPHA | RGBA, _) => eight(p[p.len() - 1], self.depth),
            (PALETTE, Some(all)) => all.get(usize::from(p[0])).map_or(255.0, |a| f32::from(*a)),
            // One colour is transparent.
            (_, Some(one)) => {
                let clear =
                    one.chunks(2).map(|two| u16::from_be_bytes([two[0], two[1]])).eq(p.iter().copied());
                if clear { 0.0 } else { 255.0 }
            }
            _ => 255.0,
        };
        let pixels = self.samples.chunks(channels(self.kind)).zip(self.brightness());
        let mean = |(p, brightness): (&[u16], f32)| ((3.0 * brightness).round() + alpha(p)) / 4.0;
        (own || chunk.is_some()).then(|| pixels.map(mean).collect())
    }
}

fn eight(v: u16, depth: u8) -> f32 {
    (f64::from(v) * 255.0 / f64::from((1_u32 << depth) - 1)).round() as f32
}

fn chunk(out: &mut Vec<u8>, name: &[u8; 4], content: &[u8]) {
    out.extend((content.len() as u32).to_be_bytes());
    let begin = out.len();
    out.extend(name);
    out.extend(content);
    let sum = crc(&out[begin..]);
    out.extend(sum.to_be_bytes());
}

fn crc(bytes: &[u8]) -> u32 {
    let bit = |c: u32| if c & 1 == 1 { c >> 1 ^ 0xedb8_8320 } else { c >> 1 };
    !bytes.iter().fold(u32::MAX, |c, b| (0..8).fold(c ^ u32::from(*b), |c, _| bit(c)))
}

/// A stream of zlib that is not compressed.
fn stored(bytes: &[u8]) -> Vec<u8> {
    let mut out = vec![0x78, 0x01];
    let blocks = bytes.chunks(u16::MAX.into()).collect::<Vec<_>>();
    for (i, block) in blocks.iter().enumerate() {
        out.push(u8::from(i + 1 == blocks.len()));
        let length = block.len() as u16;
        out.extend(length.to_le_bytes());
        out.extend((!length).to_le_bytes());
        out.extend(*block);
    }
    let add = |(a, b): (u32, u32), v: &u8| ((a + u32::from(*v)) % 65521, (a + u32::from(*v) + b) % 65521);
    let (a, b) = bytes.iter().fold((1, 0), add);
    out.extend((b << 16 | a).to_be_bytes());
    out
}

/// An image of any kind.
fn image() -> impl Strategy<Value = Image> {
    let kinds: Vec<(u8, u8)> = KINDS.iter().flat_map(|(k, ds)| ds.iter().map(|d| (*k, *d))).collect();
    let what = (prop::sample::select(kinds), any::<bool>(), any::<bool>(), [1..20_usize, 1..20_usize]);
    what.prop_flat_map(|((kind, depth), interlaced, transparent, size)| {
        let most = ((1_u32 << depth) - 1) as u16;
        let count = size[0] * size[1] * channels(kind);
        let samples = prop::collection::vec(0..=most, count);
        let palette =
            prop::collection::vec(any::<[u8; 3]>(), if kind == PALETTE { most as usize + 1 } else { 0 });
        (samples, palette).prop_map(move |(samples, palette)| {
            let first = |n: usize| samples[..n].iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>();
            let transparency = match kind {
                GREY | RGB => Some(first(channels(kind))),
                PALETTE => Some((0..palette.len() as u32).map(|i| (i * 37) as u8).collect()),
                _ => None,
            };
            let transparency = transparency.filter(|_| transparent);
            Image { kind, depth, interlaced, size, samples, palette, transparency }
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn every_kind_is_read(image in image()) {
        let grid = GridMap::parse("map.png", &image.bytes()).unwrap();
        prop_assert_eq!(grid.size, image.size);
        prop_assert_eq!(grid.brightness, image.brightness());
        prop_assert_eq!(grid.with_alpha, image.with_alpha());
    }

    #[test]
    fn spoilt_chunks_are_read_or_refused(image in image(), at in 0.0..1.0_f64, bit in 0..8_u32, cut: bool) {
        let mut bytes = image.bytes();
        let at = (at * bytes.len() as f64) as usize;
        if cut { bytes.truncate(at) } else { bytes[at] ^= 1 << bit }
        // Checksums are made right again, or nothing would come of it.
        let mut begin = 8;
        while let Some(length) = bytes.get(begin..begin + 4) {
            let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
            let Some(covered) = bytes.get(begin + 4..begin.saturating_add(length).saturating_add(8)) else { break };
            let sum = crc(covered).to_be_bytes();
            begin += length + 8;
            bytes.iter_mut().skip(begin).zip(sum).for_each(|(byte, sum)| *byte = sum);
            begin += 4;
        }
        if let Err(error) = read(&bytes) {
            prop_assert!(!error.to_string().contains('\n') && error.remedy().is_some());
        }
    }
}

/// A grey image of nothing but black, `size` pixels as its header says.
fn black(size: [usize; 2], rows: usize) -> Vec<u8> {
    let samples = vec![0; size[0] * rows];
    let image = Image {
        kind: GREY,
        depth: 8,
        interlaced: false,
        size: [size[0], rows],
        samples,
        palette: Vec::new(),
        transparency: None,
    };
    let mut bytes = image.bytes();
    bytes[20..24].copy_from_slice(&(size[1] as u32).to_be_bytes());
    let sum = crc(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&sum.to_be_bytes());
    bytes
}

#[test]
fn what_is_wrong_is_said() {
    refused(&black([8193, 1], 1), ErrorKind::TooLarge, "8193 × 1 pixels; expected 1 to 8192");
    refused(&black([1, 4_000_000_000], 1), ErrorKind::TooLarge, "expected 1 to 8192");
    refused(&black([4, 8192], 3), ErrorKind::Format, "cannot be read");
    assert_eq!(read(&black([8192, 1], 1)).unwrap(), [0.0; 8192]);
    let good = black([4, 3], 3);
    for end in [4, 12, 30, 40, 50] {
        refused(&good[..end], ErrorKind::Format, "cannot be read");
    }
    for length in [4, 5, 767_u32] {
        let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
        chunk(&mut bytes, b"IHDR", &[0, 0, 0, 1, 0, 0, 0, 1, 8, PALETTE, 0, 0, 0]);
        chunk(&mut bytes, b"PLTE", &vec![0; length as usize]);
        chunk(&mut bytes, b"IDAT", &stored(&[0, 0]));
        chunk(&mut bytes, b"IEND", &[]);
        let words = format!("the palette of the image has {length} bytes; expected three for each colour");
        refused(&bytes, ErrorKind::Format, &words);
    }
    let mut bad = good.clone();
    bad[45] ^= 1;
    refused(&bad, ErrorKind::Format, "cannot be read");
}
