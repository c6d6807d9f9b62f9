//! Faces turned towards the space that sees them.
