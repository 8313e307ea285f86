//! Prepared meshes (`.raycast`): meshes as parsed and checked, stored with their BVHs, so that rendering starts
//! without parsing or building. The format is the program's own and not for exchange: a file of another format
//! version is rejected, not migrated.
//!
//! Little-endian, without padding. A text is its length in bytes (u32) and UTF-8; a list is its length (u32) and its
//! elements; an option is 0, or 1 and the value.
//!
//! | part | bytes |
//! |---|---|
//! | header | magic, 12 bytes; version u32; program version, 20 bytes of ASCII, zero-padded; file length u64 |
//! | about | unit u32; warnings and notes, lists of texts |
//! | textures | list: columns, rows u32; wrap along u and v; RGBA texels |
//! | meshes | list: see `mesh` |
//! | objects | whether they are mesh nodes u32; list: see `object` |
//! | checksum | 16 bytes: see `checksum` |
//!
//! Trees are stored without boxes: each inner node has only its first child's triangle and node counts, which must
//! fit into its own. So references cannot form a cycle. Boxes are recomputed from the vertices and cannot be wrong.

mod checksum;
mod decoder;
mod encoder;
mod header;
mod material;
mod mesh;
mod object;
mod read;
mod source;
mod texture;
mod write;

pub(super) use header::is_prepared;
pub(super) use read::{Prepared, read, read_from};
pub use write::{PrepareError, write_prepared};

#[cfg(test)]
mod refusal_tests;
#[cfg(test)]
mod tests;
