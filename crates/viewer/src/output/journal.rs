//! Journals of part files, from which a later command resumes.

use raycast_core::digest::Digest;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;

/// The pieces of a file: the length of each, its checksum, and what its writer needs to know of it. A piece is in the
/// journal only after it is synced to the disk, and counts only if the part file has its bytes.
///
/// The first line identifies the file; then there is a line a piece: `BYTES DIGEST WORDS…`, and a checksum of these.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    pieces: Vec<String>,
    /// Lines that are not written yet.
    waiting: String,
}

impl Journal {
    /// The journal of the file with this `key` (a line). The part file is truncated to the journal's pieces, after a
    /// `head` that is written again. A journal with another key, or without a valid piece, is restarted.
    ///
    /// # Errors
    /// Files that cannot be read or written.
    pub(super) fn open(path: PathBuf, key: &str, head: &[u8], part: &mut File) -> io::Result<Self> {
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path)?;
        let mut text = Vec::new();
        file.read_to_end(&mut text)?;
        let text = String::from_utf8_lossy(&text);
        let first = format!("{key}\n");
        let lines = text.strip_prefix(&first).unwrap_or_default();
        let mut pieces = Vec::new();
        let mut end = head.len() as u64;
        part.seek(SeekFrom::Start(end))?;
        // A truncated line does not count.
        let whole = |line: &'_ str| line.strip_suffix('\n').map(str::to_owned);
        for line in lines.split_inclusive('\n').map_while(whole) {
            let Some((bytes, words)) = read_piece(&line, part)? else {
                break;
            };
            end += bytes;
            pieces.push(words);
        }
        part.set_len(end)?;
        part.seek(SeekFrom::Start(0))?;
        part.write_all(head)?;
        part.seek(SeekFrom::Start(end))?;
        let kept = lines.split_inclusive('\n').take(pieces.len());
        let known: String = std::iter::once(first.as_str()).chain(kept).collect();
        file.set_len(0)?;
        file.seek(SeekFrom::Start(0))?;
        file.write_all(known.as_bytes())?;
        file.sync_all()?;
        Ok(Self {
            path,
            file,
            pieces,
            waiting: String::new(),
        })
    }

    /// The words of each piece that the part file has.
    pub fn pieces(&self) -> &[String] {
        &self.pieces
    }

    /// Records a piece that was written, to be stored at the next [`super::Unfinished::note`]; `words` are its
    /// writer's, without a line end.
    pub fn remember(&mut self, bytes: &[u8], words: &str) {
        let body = format!("{} {} {words}", bytes.len(), Digest::of(bytes));
        let check = Digest::of(body.as_bytes());
        self.waiting.push_str(&format!("{body} {check}\n"));
    }

    /// Syncs the part file to the disk, and then stores what is recorded of it.
    pub(super) fn note(&mut self, part: &File) -> io::Result<()> {
        if !self.waiting.is_empty() {
            part.sync_data()?;
            self.file.write_all(self.waiting.as_bytes())?;
            self.file.sync_data()?;
            self.waiting.clear();
        }
        Ok(())
    }

    /// Removes the journal of a complete file.
    ///
    /// Call it after the file was renamed: a journal that is left over restarts.
    pub fn remove(self) {
        // A journal without a part file does not count.
        let _ = fs::remove_file(self.path);
    }
}

/// The length and the words of a piece, if the part file has its bytes next.
fn read_piece(line: &str, part: &mut File) -> io::Result<Option<(u64, String)>> {
    let Some((body, check)) = line.rsplit_once(' ') else {
        return Ok(None);
    };
    if Digest::of(body.as_bytes()).to_string() != check {
        return Ok(None);
    }
    let mut words = body.splitn(3, ' ');
    let mut next = || words.next().unwrap_or_default();
    let (Ok(length), Ok(digest)) = (next().parse::<u64>(), next().parse::<Digest>()) else {
        return Ok(None);
    };
    let words = next().to_owned();
    let mut bytes = Vec::new();
    Read::by_ref(part).take(length).read_to_end(&mut bytes)?;
    let is_there = bytes.len() as u64 == length && Digest::of(&bytes) == digest;
    Ok(is_there.then_some((length, words)))
}

#[cfg(test)]
mod tests {
    use super::super::Output;
    use super::*;

    /// The pieces that are found again after `damage`, and the file's bytes.
    fn after(damage: impl Fn(&mut Vec<u8>, &mut Vec<u8>), key: &str) -> (Vec<String>, Vec<u8>) {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let output = Output::at(&at("out"), &[]).expect("a place");
        let (mut file, mut journal) = output.resume("key", b"HEAD").expect("begins");
        for (piece, words) in [("first", "a 1"), ("second", "b"), ("third", "")] {
            file.append(piece.as_bytes()).expect("written");
            journal.remember(piece.as_bytes(), words);
            file.note(&mut journal).expect("noted");
        }
        file.append(b"half of the four").expect("written");
        assert!(
            output.resume("key", b"HEAD").is_err(),
            "one command at a time"
        );
        drop((file, journal));
        let [mut part, mut notes] = [".out.raycast-part", ".out.raycast-journal"]
            .map(|name| fs::read(at(name)).expect("it is kept"));
        damage(&mut part, &mut notes);
        fs::write(at(".out.raycast-part"), &part).expect("written");
        fs::write(at(".out.raycast-journal"), &notes).expect("written");
        let (mut file, journal) = output.resume(key, b"head").expect("goes on");
        let pieces = journal.pieces().to_vec();
        file.append(b"!").expect("written");
        file.finish().expect("finished");
        journal.remove();
        assert_eq!(
            fs::read_dir(folder.path()).map(Iterator::count).ok(),
            Some(1)
        );
        (pieces, fs::read(at("out")).expect("it is there"))
    }

    #[test]
    fn what_was_noted_is_gone_on_with_and_the_rest_is_cut_off() {
        let words = |count: usize| {
            ["a 1", "b", ""][..count]
                .iter()
                .map(|w| (*w).to_owned())
                .collect()
        };
        let all: (Vec<String>, Vec<u8>) = (words(3), b"headfirstsecondthird!".to_vec());
        assert_eq!(after(|_, _| {}, "key"), all);
        let two = (words(2), b"headfirstsecond!".to_vec());
        assert_eq!(after(|part, _| part.truncate(18), "key"), two);
        assert_eq!(after(|part, _| part[16] ^= 1, "key"), two);
        assert_eq!(
            after(|_, notes| notes.truncate(notes.len() - 1), "key"),
            two
        );
        let last_word = |notes: &[u8]| notes.len() - 36;
        assert_eq!(
            after(
                |_, notes| {
                    let at = last_word(notes);
                    notes[at] ^= 1;
                },
                "key"
            ),
            two
        );
        let none = (words(0), b"head!".to_vec());
        assert_eq!(after(|part, _| part[4] ^= 1, "key"), none);
        assert_eq!(after(|_, _| {}, "another key"), none);
        assert_eq!(after(|part, _| part.clear(), "key"), none);
        assert_eq!(after(|_, notes| notes.clear(), "key"), none);
    }
}
