//! Numbers from bytes, with the place of each.

use super::TreeError;
use crate::bvh::NodeBox;

/// Reads little-endian numbers one after another.
pub(super) struct Reader<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Reader<'b> {
    pub(super) fn new(bytes: &'b [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// The place of the next number.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], TreeError> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let Some(head) = rest.first_chunk::<N>() else {
            let (expected, found) = ((self.at + N) as u64, self.bytes.len() as u64);
            return Err(TreeError::Length { expected, found });
        };
        self.at += N;
        Ok(*head)
    }

    pub(super) fn u32(&mut self) -> Result<u32, TreeError> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    pub(super) fn u64(&mut self) -> Result<u64, TreeError> {
        Ok(u64::from_le_bytes(self.take()?))
    }

    pub(super) fn f64s<const N: usize>(&mut self) -> Result<[f64; N], TreeError> {
        let mut all = [0.0; N];
        for x in &mut all {
            *x = f64::from_le_bytes(self.take()?);
        }
        Ok(all)
    }

    pub(super) fn u32s<const N: usize>(&mut self) -> Result<[u32; N], TreeError> {
        let mut all = [0; N];
        for x in &mut all {
            *x = self.u32()?;
        }
        Ok(all)
    }

    fn f32s<const N: usize>(&mut self) -> Result<[f32; N], TreeError> {
        Ok(self.u32s()?.map(f32::from_bits))
    }

    pub(super) fn obb(&mut self) -> Result<NodeBox, TreeError> {
        let frame = [self.f32s()?, self.f32s()?, self.f32s()?];
        Ok(NodeBox::new(frame, self.f32s()?))
    }
}

/// Something wrong at byte `at`.
pub(super) fn invalid(at: usize, expected: &'static str, found: impl std::fmt::Display) -> TreeError {
    TreeError::Invalid { at: at as u64, expected, found: found.to_string() }
}
