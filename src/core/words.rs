//! Words for the variants of an enum, each written once.

/// Gives an enum without fields a word for each variant, and a list of all variants where one is asked for. The enum may be defined
/// here, with each word after its variant.
#[macro_export]
macro_rules! words {
    ($(#[$meta:meta])* $vis:vis enum $type:ident, $($name:ident),+ {
        $($(#[$part:meta])* $variant:ident $text:literal),* $(,)?
    }) => {
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        $(#[$meta])*
        $vis enum $type {
            $($(#[$part])* $variant),*
        }

        $crate::words!($type, $($name),+: $($variant $text),*);
    };
    ($type:ident, $all:ident, $word:ident: $($variant:ident $text:literal),* $(,)?) => {
        $crate::words!($type, $word: $($variant $text),*);
        impl $type {
            /// The words of all, in order.
            pub const NAMES: [&'static str; [$($text),*].len()] = [$($text),*];
            /// All, in order.
            pub const $all: [$type; $type::NAMES.len()] = [$($type::$variant),*];

            /// The one with this word.
            pub fn from_word(word: &str) -> Option<$type> {
                let place = $type::NAMES.iter().position(|name| *name == word)?;
                Some($type::$all[place])
            }
        }
    };
    ($type:ident, $word:ident: $($variant:ident $(($($field:tt)*))? $text:literal),* $(,)?) => {
        impl $type {
            /// Its word in files and messages.
            pub const fn $word(self) -> &'static str {
                match self {
                    $($type::$variant $(($($field)*))? => $text),*
                }
            }
        }
    };
}

/// Whether a value is the default, which files may omit.
pub fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// A count with its noun, which is given in the singular: "1 entry", "2 entries".
pub fn counted<N: std::fmt::Display + PartialEq + From<u8>>(count: N, noun: &str) -> String {
    format!("{count} {}", noun_for(&count, noun))
}

/// The noun in the form that the count needs, for lines in which the count is written elsewhere.
pub fn noun_for<N: PartialEq + From<u8>>(count: &N, noun: &str) -> String {
    if *count == N::from(1) {
        return noun.to_owned();
    }
    let vowel_before_y = ["ay", "ey", "oy"].iter().any(|end| noun.ends_with(end));
    match noun.strip_suffix('y') {
        Some(stem) if !vowel_before_y => format!("{stem}ies"),
        _ if ["ch", "sh", "s", "x"].iter().any(|end| noun.ends_with(end)) => format!("{noun}es"),
        _ => format!("{noun}s"),
    }
}

/// How often: "once", "2 times".
pub fn times<N: std::fmt::Display + PartialEq + From<u8>>(count: N) -> String {
    if count == N::from(1) {
        "once".to_owned()
    } else {
        format!("{count} times")
    }
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn nouns_agree_with_their_counts() {
        for (count, noun, text) in [
            (0, "node", "0 nodes"),
            (1, "minor iteration", "1 minor iteration"),
            (1, "entry", "1 entry"),
            (2, "entry", "2 entries"),
            (3, "key", "3 keys"),
            (2, "branch", "2 branches"),
        ] {
            assert_eq!(counted(count, noun), text);
        }
    }
}
