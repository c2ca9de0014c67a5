//! The engine against brute force, exact arithmetic, the reference implementation and parry.

mod bad_input;
mod clouds;
mod common;
mod filled;
mod lanes;
mod meshes;
mod motions;
mod nested;
mod parry;
mod properties;
mod referee;
mod scene_model;
mod scenes;
mod triangles;
