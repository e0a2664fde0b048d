//! Assigns the cells of a sweep to shards K of N, by a hash that never changes.
//!
//! A cell's [`Key`] is a hash of everything that its result depends on. Its shard depends on the key of its
//! problem, which leaves out how the problem is computed: cells that are compared with each other belong to one
//! shard.
//!
//! ```text
//! h = high half of the problem's key ⊕ low half of it         64 bits
//! h ← mix(h):  h ⊕ h≫33, · ff51afd7ed558ccd, h ⊕ h≫33, · c4ceb9fe1a85ec53, h ⊕ h≫33       (MurmurHash3's fmix64)
//! K = 1 + h mod N
//! ```
//!
//! so that it depends only on the problem: not on the machine, the other cells, or their order.

use std::fmt;
use std::num::NonZeroU64;
use std::str::FromStr;
use stickslip_core::counted;
use stickslip_scene::joined;

/// Identifies a cell: a hash (FNV-1a, 128 bits) of everything that its result depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key(u128);

impl Key {
    /// The key of an empty list.
    pub const EMPTY: Key = Key(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d);

    /// The key of some texts, the same on every machine.
    pub fn from_parts<'a>(parts: impl IntoIterator<Item = &'a str>) -> Key {
        parts.into_iter().fold(Key::EMPTY, Key::and)
    }

    /// The key of the same texts and one more.
    pub fn and(self, part: &str) -> Key {
        // Separates parts: this byte does not occur in UTF-8.
        let bytes = part.bytes().chain([0xff]);
        Key(bytes.fold(self.0, |hash, byte| {
            (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b)
        }))
    }

    /// Parses a key of 32 hexadecimal digits.
    pub fn read(text: &str) -> Option<Key> {
        let digits = text.len() == 32 && text.bytes().all(|b| b.is_ascii_hexdigit());
        let value = digits.then(|| u128::from_str_radix(text, 16).ok());
        value.flatten().map(Key)
    }

    /// The number h that determines the shard.
    pub fn mixed(self) -> u64 {
        let mut h = (self.0 >> 64) as u64 ^ self.0 as u64;
        h = (h ^ (h >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
        h = (h ^ (h >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
        h ^ (h >> 33)
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

/// A part of all cells: number K of N.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: u64,
    of: NonZeroU64,
}

impl Shard {
    /// All cells.
    pub const WHOLE: Shard = Shard {
        number: 1,
        of: NonZeroU64::MIN,
    };

    /// Shard K of N; `None` unless 1 <= K <= N.
    pub fn new(number: u64, of: u64) -> Option<Shard> {
        let of = NonZeroU64::new(of)?;
        (1..=of.get())
            .contains(&number)
            .then_some(Shard { number, of })
    }

    /// K, from 1.
    pub fn number(self) -> u64 {
        self.number
    }

    /// N.
    pub fn of(self) -> NonZeroU64 {
        self.of
    }

    /// Whether the cell with this number h belongs to the shard.
    pub fn has(self, h: u64) -> bool {
        1 + h % self.of == self.number
    }
}

/// The error for text that is no shard.
const NO_SHARD: &str = "expected K/N, such as 3/40 for shard 3 of 40 (K from 1 to N)";

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Shard, Self::Err> {
        let (number, of) = text.split_once('/').ok_or(NO_SHARD)?;
        let whole = |text: &str| text.parse::<u64>().map_err(|_| NO_SHARD);
        Shard::new(whole(number)?, whole(of)?).ok_or(NO_SHARD)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// Formats numbers as ranges: `3, 17 to 20 and 8 more ranges`; shows at most `most` ranges.
pub fn ranges(numbers: &[usize], most: usize) -> String {
    let mut ranges: Vec<(usize, usize)> = Vec::new();
    for &number in numbers {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => ranges.push((number, number)),
        }
    }
    let words = joined(
        ranges.iter().take(most).map(|&(first, last)| {
            if first == last {
                first.to_string()
            } else {
                format!("{first} to {last}")
            }
        }),
        ", ",
    );
    let more = match ranges.len().saturating_sub(most) {
        0 => String::new(),
        n => format!(" and {}", counted(n, "more range")),
    };
    words + &more
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fixed values: a change of these numbers makes all logs of shards invalid.
    #[test]
    fn the_hash_never_changes() {
        let keys: Vec<Key> = (0..6)
            .map(|k| Key::from_parts(["cell", &k.to_string()]))
            .collect();
        assert_eq!(keys[0].to_string(), PLANTED_KEY);
        let of = |n: u64| keys.iter().map(move |k| 1 + k.mixed() % n);
        assert_eq!(of(40).collect::<Vec<_>>(), PLANTED_40);
        assert_eq!(of(1_000_000).collect::<Vec<_>>(), PLANTED_1000000);
    }
    const PLANTED_KEY: &str = "716bbfe2f04ff78db14f12203e4942a7";
    const PLANTED_40: [u64; 6] = [13, 23, 33, 4, 40, 34];
    const PLANTED_1000000: [u64; 6] = [542213, 190023, 691433, 727364, 373400, 178834];

    #[test]
    fn every_cell_belongs_to_one_shard_and_shards_are_of_similar_size() {
        let mut counts = [0; 40];
        for k in 0..40_000 {
            let key = Key::from_parts(["seed 1", &k.to_string()]);
            let shards: Vec<u64> = (1..=40)
                .filter(|&n| Shard::new(n, 40).unwrap().has(key.mixed()))
                .collect();
            assert_eq!(shards.len(), 1);
            counts[shards[0] as usize - 1] += 1;
        }
        // A fair draw of 1,000 each has a standard deviation of 31.
        assert!(counts.iter().all(|n| (850..1150).contains(n)), "{counts:?}");
    }

    #[test]
    fn a_key_separates_parts_and_reads_back() {
        assert_ne!(Key::from_parts(["ab", "c"]), Key::from_parts(["a", "bc"]));
        let key = Key::from_parts(["ab", "c"]);
        assert_eq!(Key::read(&key.to_string()), Some(key));
        assert_eq!(Key::read("12"), None);
    }

    #[test]
    fn a_shard_is_k_of_n() {
        assert_eq!("3/40".parse(), Ok(Shard::new(3, 40).unwrap()));
        for wrong in ["", "3", "0/4", "5/4", "1/0", "a/4", "1/2/3", "-1/4"] {
            assert_eq!(wrong.parse::<Shard>(), Err(NO_SHARD), "{wrong}");
        }
        assert!(Shard::WHOLE.has(Key::from_parts(["a"]).mixed()));
    }

    #[test]
    fn numbers_are_formatted_as_ranges() {
        assert_eq!(ranges(&[], 3), "");
        assert_eq!(ranges(&[3, 5, 6, 7, 9], 3), "3, 5 to 7, 9");
        assert_eq!(ranges(&[1, 3, 5, 7], 2), "1, 3 and 2 more ranges");
    }
}
