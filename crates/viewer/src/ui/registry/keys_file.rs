//! The key bindings file.

use super::action::Action;
use super::actions;
use super::chord::Chord;
use super::keymap::Keymap;
use std::fmt::Write;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

/// The version of the file's format.
const VERSION: &str = "1";
/// The most faults of a file that are shown.
const MOST_FAULTS: usize = 5;

/// The contents of a key bindings file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KeysFile {
    /// The key bindings that could be read.
    pub keymap: Keymap,
    /// Faults, each with its line.
    pub faults: Vec<String>,
    /// Messages about commands that lost a default key to another one.
    pub taken: Vec<String>,
}

/// A command's keys in a file.
struct Entry {
    line: usize,
    action: &'static Action,
    keys: Vec<Chord>,
}

impl KeysFile {
    /// Reads a file, which messages call `name`. A fault affects only its own line: commands that the file does not
    /// name, or whose line is faulty, keep their default keys. A key that the file gives to a command is taken from the
    /// one that has it by default; of two commands in the file the first keeps it.
    pub fn read(name: &str, text: &str) -> Self {
        let mut reading = Reading {
            name,
            text,
            entries: Vec::new(),
            faults: Vec::new(),
        };
        reading.file();
        let Reading {
            entries, faults, ..
        } = reading;
        let (keymap, taken) = keymap(entries);
        Self {
            keymap,
            faults: few(faults),
            taken,
        }
    }

    /// A template that changes nothing, with instructions and all commands.
    pub fn template() -> String {
        let mut text = format!(
            "# Keys of RayCast's window. Take the # off a line and give the command other keys:\n\
             # [] for none, or one or several such as \"F\", \"Ctrl+Shift+S\", \"Alt+Left\", \"PageUp\", \"F5\".\n\
             # A key that is given to a command here is taken from whichever has it usually.\n\
             # Help, Reload keys takes in what the file says.\n\
             version = {VERSION}\n\n[keys]\n"
        );
        let mut menu = None;
        for action in actions() {
            if menu.replace(action.menu) != Some(action.menu) {
                // Writing to a string cannot fail.
                let _ = writeln!(text, "\n# {}", action.menu.name());
            }
            let keys: Vec<_> = action
                .keys
                .iter()
                .map(|k| format!("{:?}", k.name()))
                .collect();
            let _ = writeln!(
                text,
                "# {} = [{}]  # {}: {}",
                action.id,
                keys.join(", "),
                action.name.trim_end_matches('…'),
                action.does
            );
        }
        text
    }
}

/// The first faults in the order of their lines, and the number of others.
fn few(mut faults: Vec<(usize, String)>) -> Vec<String> {
    faults.sort_by_key(|(line, _)| *line);
    let mut faults: Vec<_> = faults.into_iter().map(|(_, fault)| fault).collect();
    let more = faults.len().saturating_sub(MOST_FAULTS);
    faults.truncate(MOST_FAULTS);
    if more > 0 {
        faults.push(format!("… and {more} more faults"));
    }
    faults
}

/// The key bindings with the file's entries applied, and messages about commands that lost a default key.
fn keymap(entries: Vec<Entry>) -> (Keymap, Vec<String>) {
    let mut keymap = Keymap::default();
    let mut taken = Vec::new();
    for action in actions() {
        if entries.iter().any(|entry| entry.action.id == action.id) {
            continue;
        }
        let mut keys = action.keys.to_vec();
        keys.retain(|key| {
            let by = entries
                .iter()
                .find(|entry| entry.keys.iter().any(|other| other.clashes(key)));
            taken.extend(by.map(|by| {
                let (key, from, by) = (key.name(), action.name, by.action.name);
                format!("{key} is now {by}, no longer {from}")
            }));
            by.is_none()
        });
        keymap.set(action, keys);
    }
    for entry in entries {
        keymap.set(entry.action, entry.keys);
    }
    (keymap, taken)
}

struct Reading<'a> {
    name: &'a str,
    text: &'a str,
    entries: Vec<Entry>,
    /// Each with its line.
    faults: Vec<(usize, String)>,
}

impl Reading<'_> {
    fn line(&self, at: usize) -> usize {
        let before = self.text.get(..at).unwrap_or(self.text);
        1 + before.bytes().filter(|byte| *byte == b'\n').count()
    }

    fn fault(&mut self, at: usize, what: impl std::fmt::Display) {
        let line = self.line(at);
        let fault = format!("{}:{line}: {what}", self.name);
        self.faults.push((line, fault));
    }

    fn file(&mut self) {
        let (table, errors) = DeTable::parse_recoverable(self.text);
        for error in errors {
            let at = error.span().map_or(0, |span| span.start);
            self.fault(at, error.message().lines().next().unwrap_or("no TOML"));
        }
        let table = table.into_inner();
        let mut commands = Vec::new();
        for (key, value) in in_order(&table) {
            let at = key.span().start;
            match (key.get_ref().as_ref(), value.get_ref()) {
                ("version", DeValue::Integer(version)) if version.as_str() == VERSION => {}
                ("version", _) => self.fault(
                    at,
                    format_args!(
                        "expected version = {VERSION}: this file may be for a newer RayCast"
                    ),
                ),
                ("keys", DeValue::Table(table)) => flatten("", table, &mut commands),
                (other, _) => self.fault(
                    at,
                    format_args!("expected version and [keys], found {}", quoted(other)),
                ),
            }
        }
        for (id, value, at) in commands {
            self.command(&id, value, at);
        }
    }

    fn command(&mut self, id: &str, value: &DeValue<'_>, at: usize) {
        let Some(action) = actions().find(|action| action.id == id) else {
            let near = nearest(id);
            let what = format!("there is no command {}: is it {near}?", quoted(id));
            return self.fault(at, what);
        };
        if let Some(first) = self.entries.iter().find(|other| other.action.id == id) {
            let what = format!("{id} stands in line {} already", first.line);
            return self.fault(at, what);
        }
        if let Some(keys) = self.chords(value, at) {
            let line = self.line(at);
            let is_taken_away = keys.is_empty();
            let keys = self.free(keys, at, action);
            // A command all of whose keys belong to others keeps its default ones.
            if is_taken_away || !keys.is_empty() {
                self.entries.push(Entry { line, action, keys });
            }
        }
    }

    /// The keys of an entry; `None` if one of them is invalid.
    fn chords(&mut self, value: &DeValue<'_>, at: usize) -> Option<Vec<Chord>> {
        let texts = match value {
            DeValue::String(text) => vec![(text.as_ref(), at)],
            DeValue::Array(several) => {
                let texts = several.iter().map(|one| match one.get_ref() {
                    DeValue::String(text) => Some((text.as_ref(), one.span().start)),
                    _ => None,
                });
                match texts.collect() {
                    Some(texts) => texts,
                    None => {
                        self.fault(at, "expected keys in quotes, such as [\"F\", \"Ctrl+S\"]");
                        return None;
                    }
                }
            }
            _ => {
                self.fault(at, "expected a key in quotes, or several in [ ]");
                return None;
            }
        };
        let mut chords = Vec::new();
        for (text, at) in texts {
            match Chord::read(text) {
                Ok(chord) => chords.push(chord),
                Err(expected) => {
                    self.fault(at, format_args!("{}: {expected}", quoted(text)));
                    return None;
                }
            }
        }
        Some(chords)
    }

    /// The keys that no earlier command in the file has.
    fn free(&mut self, keys: Vec<Chord>, at: usize, action: &Action) -> Vec<Chord> {
        let mut free = Vec::new();
        for key in keys {
            let before = self
                .entries
                .iter()
                .find(|entry| entry.keys.iter().any(|other| other.clashes(&key)));
            match before {
                Some(before) => {
                    let (key, first, line) = (key.name(), before.action.id, before.line);
                    let what = format!(
                        "{key} of {} is that of {first} in line {line} already",
                        action.id
                    );
                    self.fault(at, what);
                }
                None => free.push(key),
            }
        }
        free
    }
}

/// A table's entries in the order of the file.
fn in_order<'a, 't>(
    table: &'a DeTable<'t>,
) -> Vec<(&'a Spanned<DeString<'t>>, &'a Spanned<DeValue<'t>>)> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    entries
}

/// The commands of a table, with values and positions; an unquoted `view.fit` is a nested table.
fn flatten<'a>(
    path: &str,
    table: &'a DeTable<'_>,
    commands: &mut Vec<(String, &'a DeValue<'a>, usize)>,
) {
    for (key, value) in in_order(table) {
        let id = format!("{path}{}", key.get_ref());
        match value.get_ref() {
            DeValue::Table(inner) => flatten(&format!("{id}."), inner, commands),
            value => commands.push((id, value, key.span().start)),
        }
    }
    commands.sort_by_key(|(_, _, at)| *at);
}

/// A quoted word of a file, shortened if it is long.
fn quoted(text: &str) -> String {
    const MOST_CHARACTERS: usize = 40;
    let mut start: String = text.chars().take(MOST_CHARACTERS).collect();
    if start.len() < text.len() {
        start.push('…');
    }
    format!("{start:?}")
}

/// The command with the most similar id.
fn nearest(id: &str) -> &'static str {
    let like = |action: &&Action| (strsim::jaro_winkler(action.id, id) * 1e6) as u64;
    actions()
        .max_by_key(like)
        .map_or("view.fit", |action| action.id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::registry::action;
    use egui::{Key, Modifiers};

    fn read(text: &str) -> KeysFile {
        KeysFile::read("keys.toml", text)
    }

    fn has(keymap: &Keymap, id: &str, key: Key, modifiers: Modifiers) -> bool {
        keymap.has(action(id), false, key, modifiers)
    }

    #[test]
    fn commands_have_the_keys_that_the_file_gives_them() {
        let file = read(
            "version = 1\n[keys]\nview.fit = \"Shift+F\"\n\"look.wireframe\" = [\"K\", \"Ctrl++\"]\n\
             view.reset = []\n",
        );
        assert_eq!(file.faults, [""; 0]);
        let keymap = &file.keymap;
        assert!(has(keymap, "view.fit", Key::F, Modifiers::SHIFT));
        assert!(!has(keymap, "view.fit", Key::F, Modifiers::NONE));
        assert!(has(keymap, "look.wireframe", Key::K, Modifiers::NONE));
        assert!(has(keymap, "look.wireframe", Key::Plus, Modifiers::COMMAND));
        assert!(!has(keymap, "view.reset", Key::R, Modifiers::NONE));
        assert_eq!(keymap.key(action("view.reset")), "");
        assert!(
            keymap
                .hint(action("view.fit"))
                .starts_with("Fit (Shift+F)\nBring")
        );
        assert!(
            has(keymap, "object.duplicate", Key::D, Modifiers::COMMAND),
            "as it was"
        );
    }

    #[test]
    fn a_command_is_given_keys_once_and_keeps_its_own_where_all_are_others() {
        let file = read(
            "version = 1\n[keys]\nview.fit = \"K\"\n\"view.fit\" = \"J\"\nlook.wireframe = \"K\"\n",
        );
        assert_eq!(
            file.faults,
            [
                "keys.toml:4: view.fit stands in line 3 already",
                "keys.toml:5: K of look.wireframe is that of view.fit in line 3 already",
            ]
        );
        let keymap = &file.keymap;
        assert!(has(keymap, "view.fit", Key::K, Modifiers::NONE));
        assert!(has(keymap, "look.wireframe", Key::W, Modifiers::NONE));
        assert!(Chord::read("Ctrl+").is_err());
        assert!(Chord::read("F7").is_ok_and(|chord| chord.works_while_typing()));
    }

    #[test]
    fn a_key_is_taken_from_the_command_that_has_it_usually() {
        let file = read("version = 1\n[keys]\nview.fit = \"W\"\n");
        assert_eq!(file.taken, ["W is now Fit, no longer Wireframe"]);
        assert!(!has(
            &file.keymap,
            "look.wireframe",
            Key::W,
            Modifiers::NONE
        ));
        assert_eq!(file.keymap.changed(), 2);
    }

    #[test]
    fn each_fault_names_its_line_and_costs_no_other() {
        let file = read(
            "version = 1\n[keys]\nview.fti = \"K\"\nview.fit = \"Hyper+K\"\nview.reset = 3\n\
             view.back = \"K\"\nview.forward = [\"K\", \"J\"]\nlook.borders = \"Escape\"\n",
        );
        assert_eq!(
            file.faults,
            [
                "keys.toml:3: there is no command \"view.fti\": is it view.fit?",
                "keys.toml:4: \"Hyper+K\": expected Ctrl, Shift or Alt before the key, found \"Hyper\"",
                "keys.toml:5: expected a key in quotes, or several in [ ]",
                "keys.toml:7: K of view.forward is that of view.back in line 6 already",
                "keys.toml:8: \"Escape\": this key has a use that cannot be changed",
            ]
        );
        assert!(has(&file.keymap, "view.back", Key::K, Modifiers::NONE));
        assert!(has(&file.keymap, "view.forward", Key::J, Modifiers::NONE));
        assert!(
            has(&file.keymap, "view.fit", Key::F, Modifiers::NONE),
            "as it was"
        );
    }

    #[test]
    fn a_damaged_file_is_read_as_far_as_it_goes() {
        let file = read("version = 1\n[keys]\nview.fit = \"K\"\nview.reset = [\"J\n");
        assert!(
            file.faults[0].starts_with("keys.toml:4: "),
            "{:?}",
            file.faults
        );
        assert!(has(&file.keymap, "view.fit", Key::K, Modifiers::NONE));
        let newer = read("version = 2\n[keys]\n");
        assert_eq!(
            newer.faults,
            ["keys.toml:1: expected version = 1: this file may be for a newer RayCast"]
        );
        let noise: String = ('\u{0}'..'\u{ff}').cycle().take(10_000).collect();
        assert_eq!(read(&noise).faults.len(), MOST_FAULTS + 1);
        assert_eq!(read("").keymap, Keymap::default());
    }

    #[test]
    fn the_template_changes_nothing_and_names_every_command_with_its_keys() {
        let template = KeysFile::template();
        assert_eq!(read(&template), KeysFile::default());
        let all: String = template
            .lines()
            .map(|line| match line.strip_prefix("# ") {
                Some(rest) if rest.contains(" = [") => format!("{rest}\n"),
                _ => format!("{line}\n"),
            })
            .collect();
        let file = read(&all);
        assert_eq!(file, KeysFile::default());
        assert!(actions().all(|action| all.contains(&format!("\n{} = [", action.id))));
    }
}
