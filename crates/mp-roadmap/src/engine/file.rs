//! Roadmaps in files. `docs/formats/roadmap.md` describes them.

use super::{Link, LinkState, MilestoneKind, Roadmap, Tag};
use mp_cspace::{NodeId, StateVector};
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

const MAGIC: [u8; 8] = *b"\x89MPR\r\n\x1a\n";
const VERSION: u32 = 1;
/// Stands for no obstacle or no motion.
const NONE: u32 = u32::MAX;
const CHECKSUM: usize = 8;
/// How many bytes of a file are read at a time while its checksum is computed.
const PIECE: u64 = 1 << 20;

/// The largest number of a state or motion, in magnitude. Collision queries accept no larger coordinates.
const MAX_NUMBER: f64 = 1e75;

/// The largest file of a roadmap that is read, bytes (16 GiB).
pub const MAX_ROADMAP_BYTES: u64 = 16 << 30;

/// A hash of all numbers of a scene and a robot, the same on any machine: XXH3-64 of them as little-endian
/// doubles. It detects changes, but does not resist forgery.
pub fn fingerprint(numbers: impl IntoIterator<Item = f64>) -> u64 {
    let mut hash = Xxh3::new();
    numbers.into_iter().for_each(|x| hash.update(&x.to_le_bytes()));
    hash.digest()
}

/// Why bytes are not a roadmap, or not the one for this scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RoadmapError {
    /// The file could not be read or written.
    #[error("{}", .0.message())]
    File(#[from] mp_store::Error),
    /// The first eight bytes are not those of the format.
    #[error("not a roadmap: it does not begin with the bytes 89 4d 50 52 0d 0a 1a 0a")]
    NotARoadmap,
    /// A version of the format that this version of the library cannot read.
    #[error("expected version {VERSION} of the format, found {found}; build the roadmap anew")]
    Version {
        /// The version in the file.
        found: u32,
    },
    /// The roadmap of another scene or robot, or of another metric or clearance.
    #[error(
        "made for another scene or robot, metric or clearance: expected the fingerprint {expected:016x}, found {found:016x}; \
        build the roadmap anew"
    )]
    OtherScene {
        /// The fingerprint of scene and robot.
        expected: u64,
        /// The one in the file.
        found: u64,
    },
    /// The bytes are cut off or damaged.
    #[error("cut off or damaged: expected the checksum {expected:016x}, found {found:016x}")]
    Damaged {
        /// The checksum of the bytes.
        expected: u64,
        /// The checksum in the file.
        found: u64,
    },
    /// The checksum is right, but the bytes are not a roadmap of such states.
    #[error("byte {at}: expected {expected}")]
    Invalid {
        /// The place in the file, bytes.
        at: usize,
        /// What was expected there.
        expected: &'static str,
    },
}

/// Why a file could not be saved or loaded.
#[derive(Debug, thiserror::Error)]
#[error("{}: {error}", path.display())]
pub struct RoadmapFileError {
    /// The path of the file.
    pub path: PathBuf,
    /// What went wrong.
    pub error: RoadmapError,
}

/// Roadmaps in files.
impl<S: StateVector, E: StateVector> Roadmap<S, E> {
    /// The roadmap as bytes, with the fingerprint of its scene and robot. The same roadmap gives the same
    /// bytes.
    #[must_use]
    pub fn to_bytes(&self, fingerprint: u64) -> Vec<u8> {
        let mut numbers = Vec::new();
        if let Some(state) = self.states().first() {
            state.write(&mut numbers);
        }
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(fingerprint.to_le_bytes());
        for count in [self.len(), self.all_edges().len(), numbers.len()] {
            bytes.extend((count as u32).to_le_bytes());
        }
        for (state, tag) in self.states().iter().zip(self.tags()) {
            put_node(&mut bytes, state, tag);
        }
        for (_, ends, link) in self.all_edges() {
            put_link(&mut bytes, ends, link);
        }
        bytes.extend(xxh3_64(&bytes).to_le_bytes());
        bytes
    }

    /// The roadmap from the bytes of [`Roadmap::to_bytes`], for the same scene and robot. Which edges were
    /// verified is not stored: they are verified again when a path leads along them.
    ///
    /// # Errors
    /// When it was made for another fingerprint, or the bytes are cut off, damaged or not a roadmap of such
    /// states.
    pub fn from_bytes(bytes: &[u8], fingerprint: u64) -> Result<Self, RoadmapError> {
        check_beginning(bytes)?;
        let mut reader = Reader { bytes, at: MAGIC.len() + size_of::<u32>() };
        let body = bytes.len().saturating_sub(CHECKSUM).max(reader.at);
        let found = Reader { bytes, at: body }.u64()?;
        let expected = xxh3_64(&bytes[..body]);
        if expected != found {
            return Err(RoadmapError::Damaged { expected, found });
        }
        reader.bytes = &bytes[..body];
        let found = reader.u64()?;
        if found != fingerprint {
            return Err(RoadmapError::OtherScene { expected: fingerprint, found });
        }
        let [nodes, edges, width] = [reader.u32()?, reader.u32()?, reader.u32()?];
        let mut map = Self::new();
        for _ in 0..nodes {
            let (state, tag) = reader.node(width)?;
            map.add(state, tag);
        }
        for _ in 0..edges {
            let (ends, link) = reader.link(nodes)?;
            map.insert(ends[0], ends[1], link);
        }
        match reader.at == body {
            true => Ok(map),
            false => Err(RoadmapError::Invalid { at: reader.at, expected: "the checksum" }),
        }
    }

    /// Writes [`Roadmap::to_bytes`] to a file, whole or not at all.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>, fingerprint: u64) -> Result<(), RoadmapFileError> {
        let path = path.as_ref();
        let written = mp_store::write(path, &self.to_bytes(fingerprint));
        written.map_err(|error| RoadmapFileError { path: path.to_owned(), error: error.into() })
    }

    /// Reads a file that [`Roadmap::save`] wrote for the same fingerprint. Memory is taken only for a file
    /// with the right beginning and checksum.
    ///
    /// # Errors
    /// As [`Roadmap::from_bytes`]; [`RoadmapError::File`] when it is not a regular file of at most
    /// [`MAX_ROADMAP_BYTES`], or cannot be read.
    pub fn load(path: impl AsRef<Path>, fingerprint: u64) -> Result<Self, RoadmapFileError> {
        let path = path.as_ref();
        let loaded = checked_bytes(path).and_then(|bytes| Self::from_bytes(&bytes, fingerprint));
        loaded.map_err(|error| RoadmapFileError { path: path.to_owned(), error })
    }
}

fn put_numbers(bytes: &mut Vec<u8>, value: &impl StateVector) -> u32 {
    let mut numbers = Vec::new();
    value.write(&mut numbers);
    bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
    numbers.len() as u32
}

/// Appends a node; its state has as many numbers as those of all others.
pub(super) fn put_node(bytes: &mut Vec<u8>, state: &impl StateVector, tag: &Tag) {
    put_numbers(bytes, state);
    let kind = MilestoneKind::ALL.iter().position(|kind| *kind == tag.kind).unwrap_or(0);
    bytes.push(kind as u8);
    for number in [tag.obstacle.unwrap_or(NONE), tag.tried, tag.failed] {
        bytes.extend(number.to_le_bytes());
    }
}

/// Appends an edge.
pub(super) fn put_link(bytes: &mut Vec<u8>, ends: [NodeId; 2], link: &Link<impl StateVector>) {
    ends.iter().for_each(|end| bytes.extend(end.to_le_bytes()));
    bytes.extend(link.length.to_le_bytes());
    bytes.push(match link.state {
        LinkState::Unchecked => 0,
        LinkState::Free => 1,
        LinkState::Blocked => 2,
    });
    let at = bytes.len();
    bytes.extend(NONE.to_le_bytes());
    if let Some(motion) = &link.edge {
        let count = put_numbers(bytes, motion);
        bytes[at..at + size_of::<u32>()].copy_from_slice(&count.to_le_bytes());
    }
}

/// Refuses bytes that do not begin as a roadmap of this version does.
fn check_beginning(bytes: &[u8]) -> Result<(), RoadmapError> {
    if !bytes.starts_with(&MAGIC) {
        return Err(RoadmapError::NotARoadmap);
    }
    match (Reader { bytes, at: MAGIC.len() }).u32()? {
        VERSION => Ok(()),
        found => Err(RoadmapError::Version { found }),
    }
}

/// The bytes of a file whose beginning and checksum are those of a roadmap.
fn checked_bytes(path: &Path) -> Result<Vec<u8>, RoadmapError> {
    let failed = |e| RoadmapError::from(mp_store::Error::reading(path, &e));
    let mut file = mp_store::open(path, MAX_ROADMAP_BYTES)?;
    let (mut hash, mut unhashed) = (Xxh3::new(), Vec::new());
    // The last bytes of a piece may be the checksum: they are hashed with the next piece.
    let mut first = true;
    while (&file).take(PIECE).read_to_end(&mut unhashed).map_err(failed)? > 0 || first {
        if std::mem::take(&mut first) {
            check_beginning(&unhashed)?;
        }
        let count = unhashed.len().saturating_sub(CHECKSUM);
        hash.update(&unhashed[..count]);
        unhashed.drain(..count);
    }
    let (expected, found) = (hash.digest(), Reader { bytes: &unhashed, at: 0 }.u64()?);
    if expected != found {
        return Err(RoadmapError::Damaged { expected, found });
    }
    file.rewind().map_err(failed)?;
    Ok(mp_store::read_stream(path, file, MAX_ROADMAP_BYTES)?)
}

/// Reads little-endian numbers one after another.
pub(super) struct Reader<'b> {
    pub(super) bytes: &'b [u8],
    pub(super) at: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], RoadmapError> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let Some(head) = rest.first_chunk::<N>() else {
            return Err(RoadmapError::Invalid { at: self.at, expected: "more: the file is cut off" });
        };
        self.at += N;
        Ok(*head)
    }

    fn u8(&mut self) -> Result<u8, RoadmapError> {
        Ok(self.take::<1>()?[0])
    }

    pub(super) fn u32(&mut self) -> Result<u32, RoadmapError> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    pub(super) fn u64(&mut self) -> Result<u64, RoadmapError> {
        Ok(u64::from_le_bytes(self.take()?))
    }

    fn f64s(&mut self, count: u32) -> Result<Vec<f64>, RoadmapError> {
        // A damaged count reserves no more memory than the remaining bytes can fill.
        let left = (self.bytes.len() - self.at) / 8;
        let mut numbers = Vec::with_capacity((count as usize).min(left));
        for _ in 0..count {
            let (at, number) = (self.at, f64::from_le_bytes(self.take()?));
            if number.is_nan() || number.abs() > MAX_NUMBER {
                return Err(RoadmapError::Invalid { at, expected: "a finite number of at most 1e75" });
            }
            numbers.push(number);
        }
        Ok(numbers)
    }

    /// A node whose state has `width` numbers.
    pub(super) fn node<S: StateVector>(&mut self, width: u32) -> Result<(S, Tag), RoadmapError> {
        let at = self.at;
        let state = S::read(&self.f64s(width)?);
        let state = state.ok_or(RoadmapError::Invalid { at, expected: "a state of this space" })?;
        let kind = MilestoneKind::ALL.get(usize::from(self.u8()?)).copied();
        let kind = kind.ok_or(RoadmapError::Invalid { at: self.at - 1, expected: "a kind of node" })?;
        let obstacle = Some(self.u32()?).filter(|obstacle| *obstacle != NONE);
        Ok((state, Tag { kind, obstacle, tried: self.u32()?, failed: self.u32()? }))
    }

    /// An edge between two of `nodes` nodes.
    pub(super) fn link<E: StateVector>(
        &mut self,
        nodes: u32,
    ) -> Result<([NodeId; 2], Link<E>), RoadmapError> {
        let at = self.at;
        let wrong = |expected| RoadmapError::Invalid { at, expected };
        let ends = [self.u32()?, self.u32()?];
        if ends[0] == ends[1] || ends.iter().any(|end| *end >= nodes) {
            return Err(wrong("two nodes of the roadmap"));
        }
        let length = f64::from_le_bytes(self.take()?);
        if !(length >= 0.0 && length.is_finite()) {
            return Err(wrong("an edge of finite length, not negative"));
        }
        let state = match self.u8()? {
            0 => LinkState::Unchecked,
            1 => LinkState::Free,
            2 => LinkState::Blocked,
            _ => return Err(wrong("an edge that is unchecked, free or blocked")),
        };
        let edge = match self.u32()? {
            NONE => None,
            count => Some(E::read(&self.f64s(count)?).ok_or(wrong("a motion of this local planner"))?),
        };
        if edge.is_none() && state == LinkState::Free {
            return Err(wrong("a free edge with its motion"));
        }
        Ok((ends, Link { edge, length, state, verified: [false; 2] }))
    }
}
