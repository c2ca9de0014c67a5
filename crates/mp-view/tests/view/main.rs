//! Pages, their files and their server.

mod attacks;
mod files;
mod fuzz;
mod glb;
