//! Lines with a digest, so that changed characters are detected.
//!
//! A sealed line is its text, a tab, and 16 hexadecimal digits: the 64-bit FNV-1a hash of the text's bytes. The digest detects
//! accidental changes; it is not a signature.

use std::fmt;

/// FNV-1a with 64 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Digest(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// The digest of a text.
    pub fn from_text(text: &str) -> Digest {
        let mut digest = Digest::default();
        digest.add(text);
        digest
    }

    /// Appends text.
    pub fn add(&mut self, text: &str) {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

impl fmt::Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.add(text);
        Ok(())
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

/// Result of checking a line's digest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seal<'a> {
    /// The text, with a matching digest.
    Whole(&'a str),
    /// The digest does not match the text.
    Broken,
    /// The line has no digest.
    Missing,
}

/// Appends the digest to a single-line text, without a line end.
pub fn sealed(text: &str) -> String {
    format!("{text}\t{}", Digest::from_text(text))
}

/// Checks the digest of a line without its line end.
pub fn opened(line: &str) -> Seal<'_> {
    let is_digest = |word: &str| {
        word.len() == 16
            && word
                .bytes()
                .all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b))
    };
    match line.rsplit_once('\t') {
        Some((text, word)) if is_digest(word) => {
            if Digest::from_text(text).to_string() == word {
                Seal::Whole(text)
            } else {
                Seal::Broken
            }
        }
        _ => Seal::Missing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_changed_byte_of_a_sealed_line_is_detected() {
        let line = sealed("key\t(end: 1.25e-3, name: \"u_x\")");
        assert_eq!(
            opened(&line),
            Seal::Whole("key\t(end: 1.25e-3, name: \"u_x\")")
        );
        for place in 0..line.len() {
            for by in [b'0', b'1', b'9', b'a', b' ', b'\t'] {
                let mut bytes = line.clone().into_bytes();
                if bytes[place] == by {
                    continue;
                }
                bytes[place] = by;
                let changed = String::from_utf8(bytes).unwrap();
                assert!(!matches!(opened(&changed), Seal::Whole(_)), "{changed}");
            }
        }
    }

    #[test]
    fn the_digest_is_that_of_fnv_1a() {
        assert_eq!(Digest::from_text("").to_string(), "cbf29ce484222325");
        assert_eq!(Digest::from_text("a").to_string(), "af63dc4c8601ec8c");
        assert_eq!(Digest::from_text("foobar").to_string(), "85944171f73967e8");
    }

    #[test]
    fn missing_and_wrong_digests_are_distinguished() {
        assert_eq!(opened("key\tvalue"), Seal::Missing);
        assert_eq!(opened("key\tvalue\t0123456789abcdef"), Seal::Broken);
    }
}
