//! The rapidly-exploring random tree family.
