//! The binary arrays behind the head of a scene file.

use crate::ViewError;
use serde::{Deserialize, Serialize};

/// Where an array is in the file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ArrayRef {
    #[serde(rename = "type")]
    kind: Kind,
    /// Bytes from the first array on.
    offset: usize,
    /// Entries.
    count: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Kind {
    F32,
    F64,
    U32,
    I32,
    U8,
}

/// A type of number in the arrays of scene files.
pub(crate) trait Entry: Copy {
    const KIND: Kind;
    const SIZE: usize;
    fn write(self, out: &mut Vec<u8>);
    fn read(bytes: &[u8]) -> Self;
}

macro_rules! entries {
    ($($type:ty: $kind:ident),*) => {$(
        impl Entry for $type {
            const KIND: Kind = Kind::$kind;
            const SIZE: usize = size_of::<$type>();
            fn write(self, out: &mut Vec<u8>) {
                out.extend(self.to_le_bytes());
            }
            fn read(bytes: &[u8]) -> Self {
                let mut own = [0; size_of::<$type>()];
                own.copy_from_slice(bytes);
                Self::from_le_bytes(own)
            }
        }
    )*};
}
entries!(f32: F32, f64: F64, u32: U32, i32: I32, u8: U8);

/// Appends `entries` to `data`, from the next multiple of eight bytes on.
pub(crate) fn append<T: Entry>(data: &mut Vec<u8>, entries: &[T]) -> ArrayRef {
    data.resize(data.len().next_multiple_of(8), 0);
    let offset = data.len();
    entries.iter().for_each(|entry| entry.write(data));
    ArrayRef { kind: T::KIND, offset, count: entries.len() }
}

/// The entries of an array. `what` is its name in errors.
pub(crate) fn extract<T: Entry>(data: &[u8], array: &ArrayRef, what: &str) -> Result<Vec<T>, ViewError> {
    let wrong = |problem| ViewError::Array { what: what.to_owned(), problem };
    if array.kind != T::KIND {
        return Err(wrong("has numbers of another type than expected"));
    }
    let bytes = array.count.checked_mul(T::SIZE).and_then(|length| array.offset.checked_add(length));
    let bytes = bytes
        .and_then(|end| data.get(array.offset..end))
        .ok_or_else(|| wrong("reaches beyond the end of the file"))?;
    Ok(bytes.chunks_exact(T::SIZE).map(T::read).collect())
}
