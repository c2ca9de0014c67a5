//! Messages of several pieces: between ranks with the same version of the program.

use mp_plan::Error;
use std::path::{Path, PathBuf};

/// What such bytes begin with.
const FORMAT: &str = "mp pieces 1";

/// Pieces of bytes, each after its length.
pub(crate) struct Writer(pub(crate) Vec<u8>);

impl Writer {
    pub(crate) fn new() -> Self {
        let mut parcel = Self(Vec::new());
        parcel.text(FORMAT);
        parcel.text(env!("CARGO_PKG_VERSION"));
        parcel
    }
    pub(crate) fn number(&mut self, number: usize) {
        self.0.extend((number as u64).to_le_bytes());
    }
    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len());
        self.0.extend(bytes);
    }
    pub(crate) fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }
    /// A name that is not UTF-8 fails where it is read.
    pub(crate) fn path(&mut self, path: &Path) {
        self.bytes(path.as_os_str().as_encoded_bytes());
    }
}

/// Reads what a [`Writer`] wrote.
pub(crate) struct Reader<'b>(&'b [u8]);

impl<'b> Reader<'b> {
    /// What a [`Writer`] of the same version wrote.
    pub(crate) fn new(bytes: &'b [u8]) -> Result<Self, Error> {
        let mut parcel = Self(bytes);
        if parcel.text()? != FORMAT {
            return Err(torn());
        }
        let version = parcel.text()?;
        if version != env!("CARGO_PKG_VERSION") {
            let own = env!("CARGO_PKG_VERSION");
            let message = format!("this rank has version {own} of the program, and the master {version}");
            return Err(Error::new(message).help("start the same program on all nodes"));
        }
        Ok(parcel)
    }
    pub(crate) fn number(&mut self) -> Result<usize, Error> {
        let (number, rest) = self.0.split_first_chunk::<8>().ok_or_else(torn)?;
        self.0 = rest;
        usize::try_from(u64::from_le_bytes(*number)).map_err(|_| torn())
    }
    pub(crate) fn bytes(&mut self) -> Result<&'b [u8], Error> {
        let length = self.number()?;
        let (bytes, rest) = self.0.split_at_checked(length).ok_or_else(torn)?;
        self.0 = rest;
        Ok(bytes)
    }
    pub(crate) fn text(&mut self) -> Result<&'b str, Error> {
        std::str::from_utf8(self.bytes()?).map_err(|_| torn())
    }
    pub(crate) fn path(&mut self) -> Result<PathBuf, Error> {
        Ok(self.text()?.into())
    }
}

/// The error about a message that ends too early or is none.
pub(crate) fn torn() -> Error {
    Error::new("what the master sent did not arrive whole").help("start the same program on all nodes")
}
