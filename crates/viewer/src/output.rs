//! What commands and the window write: files, a report's folder, standard output.
//!
//! What is promised of a file:
//!
//! - **Whole or not at all.** It is written beside its place, in a part file, and renamed into it:
//!   at any moment its name has all of the old file or all of the new one. Part file and folder are
//!   synced to the disk before this is called done, so a power cut leaves one or the other, too.
//! - **Nothing left behind.** A part file (`.raycast-PROCESS-NUMBER-CHECKSUM.part`) goes with its command:
//!   done, failed, or ended by SIGINT, SIGTERM or SIGHUP. What SIGKILL or a power cut leaves, the next
//!   command that writes into the folder removes: part files are locked while they are written, and
//!   only those that nobody holds are removed. Where a file system has no locks they are left alone.
//! - **Nothing of others is removed.** A part file is known by its name's checksum, which no other file has by chance; it
//!   must be a file or a folder with its lock, no link, and this user's own (the superuser's may belong to anybody).
//! - **Gone on with, if asked for.** [`Output::resume`] writes a part file that stays when its command is
//!   ended, with a journal of what of it is safe on the disk; the next command goes on after that. Files of these
//!   names that no command wrote are refused and stay.
//! - **No input is lost.** A place is compared with every file that was opened on the way, and those that meshes name, by
//!   device and inode where the system has them: links, hard links and roundabout paths are no way around.
//! - **What it replaces stays what it was**: mode, owner and group are kept; a link is followed, also
//!   one to a file that is not there yet. A file that may not be written, or whose owner or group a
//!   new file cannot be given, is refused before the work. Not kept: access lists, other attributes,
//!   and other names of the file (hard links), which keep the old contents.
//! - **Two writers of one file** do not mix: the one that ends last is seen.
//!
//! A device or a pipe has none of this: it is written as the bytes come. So is the window's frame
//! log, which is there to be read while it grows.

mod file_identity;
mod folder;
mod journal;
mod mesh_file;
mod part_file;
mod part_folder;
mod signals;
mod standard;
mod target;
mod unfinished;

pub use folder::Folder;
pub use journal::Journal;
pub use mesh_file::{MESH_ENDINGS, MeshFile};
pub use part_folder::PartFolder;
pub use signals::watch_signals;
pub use standard::{print, print_error, written};
pub use target::Output;
pub use unfinished::Unfinished;
