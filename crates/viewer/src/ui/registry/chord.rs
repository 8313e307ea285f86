//! Keys with modifiers.

use egui::Key;

/// A key with modifiers. For symbols Shift is ignored: whether it is needed to type them differs between keyboards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chord {
    /// Ctrl, or ⌘ on a Mac.
    pub ctrl: bool,
    /// Shift.
    pub shift: bool,
    /// Alt.
    pub alt: bool,
    /// The key.
    pub key: Key,
}

pub(super) const fn plain(key: Key) -> Chord {
    Chord {
        ctrl: false,
        shift: false,
        alt: false,
        key,
    }
}

pub(super) const fn ctrl(key: Key) -> Chord {
    Chord {
        ctrl: true,
        ..plain(key)
    }
}

pub(super) const fn ctrl_shift(key: Key) -> Chord {
    Chord {
        shift: true,
        ..ctrl(key)
    }
}

pub(super) const fn shift(key: Key) -> Chord {
    Chord {
        shift: true,
        ..plain(key)
    }
}

pub(super) const fn alt(key: Key) -> Chord {
    Chord {
        alt: true,
        ..plain(key)
    }
}

impl Chord {
    /// Whether a pressed key is this one.
    pub fn is(&self, key: Key, modifiers: egui::Modifiers) -> bool {
        self.key == key
            && self.ctrl == modifiers.command
            && self.alt == modifiers.alt
            && (self.shift == modifiers.shift || is_symbol(key))
    }

    /// Its name in menus: `Ctrl+Shift+S`.
    pub fn name(&self) -> String {
        let mut name = String::new();
        for (held, modifier) in [
            (
                self.ctrl,
                if cfg!(target_os = "macos") {
                    "⌘"
                } else {
                    "Ctrl+"
                },
            ),
            (self.alt, "Alt+"),
            (self.shift, "Shift+"),
        ] {
            if held {
                name.push_str(modifier);
            }
        }
        name.push_str(match self.key {
            Key::ArrowLeft => "Left",
            Key::ArrowRight => "Right",
            Key::ArrowUp => "Up",
            Key::ArrowDown => "Down",
            Key::PageUp => "Page Up",
            Key::PageDown => "Page Down",
            Key::Questionmark => "?",
            Key::Plus => "+",
            Key::Equals => "=",
            Key::Minus => "−",
            Key::Comma => ",",
            Key::Period => ".",
            key => key.name(),
        });
        name
    }

    /// Reads a name as [`Chord::name`] writes it, or as people do: `ctrl+shift+s`, `Alt+Left`, `PageUp`.
    ///
    /// # Errors
    /// What was expected.
    pub fn read(text: &str) -> Result<Self, String> {
        // The key follows the last plus, unless the key is plus itself.
        let (held, name) = match text.strip_suffix('+') {
            Some(held) if held.is_empty() || held.ends_with(['+', '⌘']) => (held, "+"),
            Some(_) => return Err("expected a key behind the last plus".to_owned()),
            None => text.rsplit_once('+').unwrap_or(("", text)),
        };
        let mut chord = plain(Key::Escape);
        let mac = held.contains('⌘') || name.starts_with('⌘');
        chord.ctrl = mac;
        let (held, name) = (held.replace('⌘', ""), name.trim_start_matches('⌘'));
        for word in held
            .split('+')
            .map(str::trim)
            .filter(|word| !word.is_empty())
        {
            match word.to_ascii_lowercase().as_str() {
                "ctrl" | "control" | "cmd" | "command" => chord.ctrl = true,
                "shift" => chord.shift = true,
                "alt" | "option" => chord.alt = true,
                _ => {
                    return Err(format!(
                        "expected Ctrl, Shift or Alt before the key, found {word:?}"
                    ));
                }
            }
        }
        let name: String = name.split_whitespace().collect();
        let known = Key::ALL
            .iter()
            .find(|key| key.name().eq_ignore_ascii_case(&name))
            .copied();
        let key = Key::from_name(&name).or(known).ok_or("expected a key")?;
        chord.key = key;
        let is_clipboard = chord.ctrl && matches!(key, Key::C | Key::V | Key::X);
        if is_clipboard
            || matches!(
                key,
                Key::Escape | Key::Tab | Key::Copy | Key::Cut | Key::Paste
            )
        {
            return Err("this key has a use that cannot be changed".to_owned());
        }
        // Shift is ignored for symbols.
        chord.shift &= !is_symbol(key);
        Ok(chord)
    }

    /// Whether one press can be both.
    pub fn clashes(&self, other: &Self) -> bool {
        (self.ctrl, self.alt, self.key) == (other.ctrl, other.alt, other.key)
            && (self.shift == other.shift || is_symbol(self.key))
    }

    /// Whether it can be used while text is being typed: it types nothing, and text fields do not use it themselves.
    pub(super) fn works_while_typing(&self) -> bool {
        let number = self.key.name().strip_prefix('F');
        let is_function = number.is_some_and(|number| number.parse::<u8>().is_ok());
        let is_of_text = matches!(
            self.key,
            Key::A
                | Key::C
                | Key::V
                | Key::X
                | Key::Y
                | Key::Z
                | Key::H
                | Key::K
                | Key::U
                | Key::W
                | Key::ArrowLeft
                | Key::ArrowRight
                | Key::ArrowUp
                | Key::ArrowDown
                | Key::Home
                | Key::End
                | Key::Backspace
                | Key::Delete
                | Key::Enter
        );
        // Ctrl with Alt types symbols on many keyboards.
        is_function || (self.ctrl && !self.alt && !is_of_text)
    }
}

fn is_symbol(key: Key) -> bool {
    matches!(
        key,
        Key::Plus
            | Key::Equals
            | Key::Minus
            | Key::Questionmark
            | Key::Exclamationmark
            | Key::Comma
            | Key::Period
            | Key::Colon
            | Key::Semicolon
            | Key::Slash
            | Key::Backslash
            | Key::Pipe
            | Key::OpenBracket
            | Key::CloseBracket
            | Key::OpenCurlyBracket
            | Key::CloseCurlyBracket
            | Key::Backtick
            | Key::Quote
    )
}
