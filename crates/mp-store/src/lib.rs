//! Files of a program: read within limits, written whole or not at all, locked while a run grows them.
//!
//! - [`read`] and [`open`] accept regular files up to a limit. A pipe, a device or a file that is too large
//!   is an error before anything is read.
//! - [`write`](fn@write) replaces a file in one step, [`write_parts`] one that is large, and [`writable`]
//!   says before a long run whether that will work.
//! - [`check_name`] decides what the name of a file inside a folder may be, and [`write_all`] writes several
//!   files into one, all or none.
//! - [`FileId`] tells whether two names lead to the same file.
//! - [`Lock`] keeps other processes from growing the same file or folder.
//! - [`Journal`] is a file that grows by whole lines.
//! - [`packed`] makes bytes small that travel.
//!
//! ```
//! let folder = std::env::temp_dir().join(format!("mp-store-{}", std::process::id()));
//! let file = folder.join("path.txt");
//! mp_store::make_folder(&folder)?;
//! mp_store::writable(&file)?;
//! mp_store::write(&file, b"0 0 0\n1 0 0\n")?;
//! assert_eq!(mp_store::read(&file, 1 << 20)?, b"0 0 0\n1 0 0\n");
//! # std::fs::remove_dir_all(folder).unwrap();
//! # Ok::<(), mp_store::Error>(())
//! ```
//!
//! Errors say the file, what is wrong and what to do. Where there is no file system, as in a browser, every
//! call is an error.

mod error;
mod id;
mod journal;
mod lock;
mod name;
#[cfg(not(target_family = "wasm"))]
mod packed;
mod read;
mod temporary;
mod write;

pub use error::{Error, ErrorKind};
pub use id::FileId;
pub use journal::Journal;
pub use lock::Lock;
pub use name::{check_name, in_folder, write_all};
#[cfg(not(target_family = "wasm"))]
pub use packed::packed;
pub use read::{open, read, read_stream};
pub use write::{folder_of, make_folder, writable, write, write_parts};
