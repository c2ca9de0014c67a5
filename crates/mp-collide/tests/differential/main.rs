//! The engine against brute force, exact arithmetic, the reference implementation and parry.

mod bad_input;
mod common;
mod filled;
mod lanes;
mod meshes;
mod motions;
mod parry;
mod properties;
mod referee;
mod saved;
mod scene_model;
mod scenes;
mod solids;
mod triangles;
