//! The text formats of GEMPA (Benitez and Mugarte; Figure 14 of "Key elements for motion planning
//! algorithms", 2010): environments, configuration files and `.txt` meshes. See `docs/formats/`.

pub(crate) mod environment;
pub(crate) mod mesh;

pub use environment::{Environment, Obstacle};
pub use mesh::{gempa_mesh_text, write_gempa_mesh};
