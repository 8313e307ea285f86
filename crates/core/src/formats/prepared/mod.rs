//! Prepared meshes (`.raycast`): what was read from mesh files, checked and stored, with the trees over it, so that a job
//! casts rays at once. The program's own: one of another version says so, and reads none of it.
//!
//! Little-endian, without padding. A text is its length in bytes (u32) and UTF-8; a list is its length (u32) and its
//! elements; an option is 0, or 1 and the value.
//!
//! | part | bytes |
//! |---|---|
//! | header | magic, 12 bytes; version u32; the program that wrote it, 20 bytes of ASCII, zeros behind; the file's length u64 |
//! | about | unit u32; warnings and notes, lists of texts |
//! | textures | list: columns, rows u32; wrap along u and v; RGBA texels |
//! | meshes | list: see `mesh` |
//! | objects | whether they are mesh nodes u32; list: see `object` |
//! | checksum | 16 bytes: see `checksum` |
//!
//! Trees are stored without boxes, as counts that a node takes out of its parent's: references cannot go round in a
//! circle, and boxes cannot be wrong, since they are made from the corners.

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
pub(super) use source::ReadAt;
pub use write::{PrepareError, write_prepared};

#[cfg(test)]
mod tests;
