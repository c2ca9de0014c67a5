//! Readers of large files of motion planning: meshes, points, images, paths.
//!
//! Everybody uses them through `mp-io`, which reads problems made of them. They are a crate of their own because it is compiled
//! optimised, while what reads small files once, in `mp-io`, is not. Loops over triangles, points, pixels and rows belong here, in
//! functions without type parameters: generic ones are compiled where they are used.
//!
//! - [`mesh`] reads a mesh, whatever the format; [`formats`] has the table of all formats, and what reads each mesh.
//! - [`points`] reads sets of points, [`grid`] images.
//! - [`path`] and [`csv`] read and write paths, and [`columns`] matches their columns by name.
//! - [`files`], [`text`], [`number`], [`json`], [`xml`], [`encoding`] and [`error`] are what all readers share.

pub mod columns;
pub mod csv;
pub mod encoding;
pub mod error;
pub mod files;
pub mod formats;
pub mod grid;
pub mod json;
pub mod mesh;
pub mod number;
pub mod path;
pub mod points;
pub mod text;
mod trace;
pub mod xml;
