//! The engine against brute force, exact arithmetic, the reference implementation and parry.

mod common;
mod meshes;
mod referee;
mod triangles;
