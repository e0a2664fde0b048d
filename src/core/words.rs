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
