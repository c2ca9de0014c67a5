//! Exact mesh collision detection with oriented bounding box trees.
