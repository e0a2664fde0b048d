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

/// Appends the digest to a single-line text, without a line end.
pub fn sealed(text: &str) -> String {
    format!("{text}\t{}", Digest::from_text(text))
}

/// The text of a sealed line without its line end; `None` if its digest is missing or does not match.
pub fn opened(line: &str) -> Option<&str> {
    let (text, digest) = line.rsplit_once('\t')?;
    (Digest::from_text(text).to_string() == digest).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_changed_byte_of_a_sealed_line_is_detected() {
        let line = sealed("key\t(end: 1.25e-3, name: \"u_x\")");
        assert_eq!(opened(&line), Some("key\t(end: 1.25e-3, name: \"u_x\")"));
        for place in 0..line.len() {
            for by in [b'0', b'1', b'9', b'a', b' ', b'\t'] {
                let mut bytes = line.clone().into_bytes();
                if bytes[place] == by {
                    continue;
                }
                bytes[place] = by;
                let changed = String::from_utf8(bytes).unwrap();
                assert_eq!(opened(&changed), None, "{changed}");
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
    fn lines_with_a_missing_or_wrong_digest_are_not_opened() {
        assert_eq!(opened("key\tvalue"), None);
        assert_eq!(opened("key\tvalue\t0123456789abcdef"), None);
    }
}
