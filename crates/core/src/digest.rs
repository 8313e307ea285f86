//! Checksums: 128 bits that follow from bytes, the same on any machine.

use std::fmt;
use std::str::FromStr;
use xxhash_rust::xxh3::Xxh3;

/// 128 bits that follow from a sequence of bytes: XXH3 (Collet, "xxHash", 2012–2020).
///
/// Equal contents have equal digests in any process on any machine. Different contents have the same
/// one by chance in one pair of 2¹²⁸; it is no protection against somebody who wants a collision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Digest(u128);

impl Digest {
    /// The digest of some bytes.
    pub fn of(bytes: &[u8]) -> Self {
        let mut hash = Digester::new();
        hash.bytes(bytes);
        hash.finish()
    }

    /// Its 16 bytes in the order of the digits that it is displayed as.
    pub fn to_bytes(self) -> [u8; 16] {
        self.0.to_be_bytes()
    }
}

impl fmt::Display for Digest {
    /// 32 hexadecimal digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

impl FromStr for Digest {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let is_digit = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
        match u128::from_str_radix(text, 16) {
            Ok(digest) if text.len() == 32 && text.bytes().all(is_digit) => Ok(Self(digest)),
            _ => Err(format!(
                "expected a checksum of 32 hexadecimal digits, found {text:?}"
            )),
        }
    }
}

/// A digest being computed: numbers count by their little-endian bytes.
pub(crate) struct Digester(Box<Xxh3>);

impl Digester {
    /// A digest of no bytes so far.
    pub(crate) fn new() -> Self {
        Self(Box::new(Xxh3::new()))
    }

    /// Adds bytes as they are.
    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// Adds a number. A list's length is added before its items, so that two lists in a row differ from one list of
    /// both.
    pub(crate) fn number(&mut self, number: u64) {
        self.bytes(&number.to_le_bytes());
    }

    /// Adds 64-bit floating-point numbers.
    pub(crate) fn doubles(&mut self, numbers: impl IntoIterator<Item = f64>) {
        for number in numbers {
            self.number(number.to_bits());
        }
    }

    /// Adds 32-bit integers, a few thousand at a time.
    pub(crate) fn words(&mut self, words: impl IntoIterator<Item = u32>) {
        const AT_ONCE: usize = 4096;
        let mut buffer = Vec::with_capacity(4 * AT_ONCE);
        for word in words {
            buffer.extend(word.to_le_bytes());
            if buffer.len() == 4 * AT_ONCE {
                self.bytes(&buffer);
                buffer.clear();
            }
        }
        self.bytes(&buffer);
    }

    /// Adds a list whose items consist of 32-bit words.
    pub(crate) fn list<T: bytemuck::Pod>(&mut self, list: &[T]) {
        if cfg!(target_endian = "little") {
            self.bytes(bytemuck::cast_slice(list));
        } else {
            self.words(bytemuck::cast_slice::<T, u32>(list).iter().copied());
        }
    }

    /// The digest of everything added so far.
    pub(crate) fn finish(&self) -> Digest {
        Digest(self.0.digest128())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The truth is the reference implementation's published answer for no bytes, and that of its
    /// command line (`xxh128sum`) for three.
    #[test]
    fn digests_are_those_of_xxh3() {
        assert_eq!(
            Digest::of(b"").to_string(),
            "99aa06d3014798d86001c324468d497f"
        );
        assert_eq!(
            Digest::of(b"abc").to_string(),
            "06b05ab6733a618578af5f94892f3950"
        );
    }

    #[test]
    fn words_are_their_bytes() {
        let words: Vec<u32> = (0..10_000u32)
            .map(|i| i.wrapping_mul(0x9e37_79b9))
            .collect();
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        let mut hash = Digester::new();
        hash.words(words.iter().copied());
        assert_eq!(hash.finish(), Digest::of(&bytes));
        let mut hash = Digester::new();
        hash.list(&words);
        assert_eq!(hash.finish(), Digest::of(&bytes));
    }

    #[test]
    fn text_comes_back() {
        let digest = Digest::of(b"RayCast");
        assert_eq!(digest.to_string().parse(), Ok(digest));
        for bad in [
            "",
            "0",
            "+9aa06d3014798d86001c324468d497f",
            "99AA06D3014798D86001C324468D497F",
        ] {
            assert!(bad.parse::<Digest>().is_err(), "{bad}");
        }
    }
}
