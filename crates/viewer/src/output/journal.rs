//! Journals of part files, from which a later command resumes.

use super::part_file::open_resumable;
use raycast_core::digest::Digest;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;

/// The pieces of a file: the length of each, its checksum, and what its writer needs to know of it. A piece is in the
/// journal only after it is synced to the disk, and counts only if the part file has its bytes.
///
/// The first line identifies the program and the file; then there is a line a piece: `BYTES DIGEST WORDS…`, and a checksum of these.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    pieces: Vec<String>,
    /// Lines that are not written yet.
    waiting: String,
}

impl Journal {
    /// The journal of the file with this `key`. The part file is truncated to the journal's pieces, after a `head` that is
    /// written again. A journal with another key, or without a valid piece, is restarted.
    ///
    /// # Errors
    /// Files that cannot be read or written; files of these names that [`Journal`] did not write, which stay.
    pub(super) fn open(
        path: PathBuf,
        key: Digest,
        head: &[u8],
        part: &mut File,
    ) -> io::Result<Self> {
        let mut file = open_resumable(&path, false)?;
        let mut text = Vec::new();
        file.read_to_end(&mut text)?;
        let text = String::from_utf8_lossy(&text);
        // A journal is on the disk before its part file has a byte.
        let is_own = if text.is_empty() {
            part.metadata()?.len() == 0
        } else {
            text.lines().next().is_some_and(is_first_line)
        };
        if !is_own {
            let reason = format!(
                "{} was not written by this program: move it, and the part file beside it, away",
                path.display()
            );
            return Err(io::Error::other(reason));
        }
        let first = first_line(key);
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
        let kept = lines.split_inclusive('\n').take(pieces.len());
        let known: String = std::iter::once(first.as_str()).chain(kept).collect();
        // Never empty from here on: an empty journal belongs to no part file.
        file.seek(SeekFrom::Start(0))?;
        file.write_all(known.as_bytes())?;
        file.set_len(known.len() as u64)?;
        file.sync_all()?;
        part.set_len(end)?;
        part.seek(SeekFrom::Start(0))?;
        part.write_all(head)?;
        part.seek(SeekFrom::Start(end))?;
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

    /// Records a piece that was written, to be stored at the next [`super::Unfinished::store_journal`]; `words` are its
    /// writer's, without a line end.
    pub fn record(&mut self, bytes: &[u8], words: &str) {
        let body = format!("{} {} {words}", bytes.len(), Digest::of(bytes));
        let check = Digest::of(body.as_bytes());
        self.waiting.push_str(&format!("{body} {check}\n"));
    }

    /// Syncs the part file to the disk, and then stores what is recorded of it.
    pub(super) fn store(&mut self, part: &File) -> io::Result<()> {
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

/// The first line of a file's journal. It names the version, since another one may compress differently.
fn first_line(key: Digest) -> String {
    let version = env!("CARGO_PKG_VERSION");
    format!("raycast {version} journal 1 of {key}\n")
}

/// Whether any version of this program wrote this line as a journal's first.
fn is_first_line(line: &str) -> bool {
    let words: Vec<_> = line.split(' ').collect();
    matches!(words[..], ["raycast", _, "journal", _, "of", key] if key.parse::<Digest>().is_ok())
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
        let (key, first_key) = (Digest::of(key.as_bytes()), Digest::of(b"key"));
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let output = Output::at(&at("out"), &[]).expect("a place");
        let (mut file, mut journal) = output.resume(first_key, b"HEAD").expect("begins");
        for (piece, words) in [("first", "a 1"), ("second", "b"), ("third", "")] {
            file.append(piece.as_bytes()).expect("written");
            journal.record(piece.as_bytes(), words);
            file.store_journal(&mut journal).expect("noted");
        }
        file.append(b"half of the four").expect("written");
        assert!(
            output.resume(first_key, b"HEAD").is_err(),
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
    }

    /// What this program did not write stays, and is named.
    #[test]
    fn files_of_somebody_else_under_these_names_are_left_alone() {
        let key = Digest::of(b"key");
        for (part, journal) in [
            (Some("a thesis"), None),
            (Some("a thesis"), Some("")),
            (None, Some("a diary\n")),
            (Some("a thesis"), Some("a diary\n")),
            (Some("a thesis"), Some("raycast of today: journal 1\n")),
        ] {
            let folder = tempfile::tempdir().expect("a folder");
            let at = |name: &str| folder.path().join(name);
            let files = [
                (".out.raycast-part", part),
                (".out.raycast-journal", journal),
            ];
            for (name, text) in files {
                if let Some(text) = text {
                    fs::write(at(name), text).expect("written");
                }
            }
            let output = Output::at(&at("out"), &[]).expect("a place");
            let error = output
                .resume(key, b"head")
                .expect_err("refused")
                .to_string();
            assert!(
                error.contains(".out.raycast-journal was not written"),
                "{error}"
            );
            for (name, text) in files {
                let left = fs::read_to_string(at(name)).unwrap_or_default();
                assert_eq!(left, text.unwrap_or_default(), "{name}");
            }
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_under_these_names_are_not_followed() {
        for name in [".out.raycast-part", ".out.raycast-journal"] {
            let folder = tempfile::tempdir().expect("a folder");
            let own = folder.path().join("own");
            fs::write(&own, "a thesis").expect("written");
            std::os::unix::fs::symlink(&own, folder.path().join(name)).expect("a link");
            let output = Output::at(&folder.path().join("out"), &[]).expect("a place");
            let error = output
                .resume(Digest::of(b""), b"head")
                .expect_err("refused");
            assert!(error.to_string().contains("is no file"), "{error}");
            assert_eq!(fs::read(&own).expect("it is there"), b"a thesis");
        }
    }
}
