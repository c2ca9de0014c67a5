//! File formats of motion planning: meshes, scenes, problems, paths.
