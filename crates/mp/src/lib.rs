//! Motion planning in Rust: the facade over the layered `mp-*` crates.
pub use mp_collide as collide;
pub use mp_cspace as cspace;
pub use mp_geom as geom;
pub use mp_io as io;
pub use mp_robot as robot;
pub use mp_tree as tree;
