//! Types whose doc comments are shown by the program: rustdoc and the manual use the same text.

/// Doc comments of a type and its parts (fields or variants, in source order).
#[derive(Debug, Clone, Copy)]
pub struct Docs {
    /// Name of the type.
    pub name: &'static str,
    /// Its doc comment.
    pub lines: DocAttributes,
    /// Name and doc comment of each part.
    pub parts: &'static [(&'static str, DocAttributes)],
}

/// The attributes of an item: each line of the doc comment, `None` for any other attribute.
pub type DocAttributes = &'static [Option<&'static str>];

/// A doc comment as one text: lines are joined, and empty lines separate paragraphs.
pub fn text(lines: DocAttributes) -> String {
    let mut text = String::new();
    for line in lines.iter().flatten().map(|line| line.trim()) {
        let gap = match (text.is_empty() || text.ends_with('\n'), line.is_empty()) {
            (_, true) => "\n\n",
            (true, false) => "",
            (false, false) => " ",
        };
        text += gap;
        text += line;
    }
    text.trim().to_owned()
}

/// The text of a doc attribute.
#[macro_export]
#[doc(hidden)]
macro_rules! doc_line {
    (doc = $text:expr) => {
        Some($text)
    };
    ($($other:tt)*) => {
        None
    };
}

pub(crate) use doc_line;

/// Defines a struct of plain fields or an enum of unit variants, and adds `DOCS`. A `choice` is an enum whose variants are words of
/// the scene file, one of them the default.
macro_rules! documented {
    ($(#[$($meta:tt)*])* $vis:vis choice $name:ident { $($parts:tt)* }) => {
        $crate::documented::documented! {
            #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
            #[serde(rename_all = "lowercase")]
            $(#[$($meta)*])*
            $vis enum $name { $($parts)* }
        }
    };
    ($(#[$($meta:tt)*])* $vis:vis struct $name:ident {
        $($(#[$($part_meta:tt)*])* $part_vis:vis $part:ident : $type:ty),* $(,)?
    }) => {
        $(#[$($meta)*])*
        $vis struct $name {
            $($(#[$($part_meta)*])* $part_vis $part: $type),*
        }
        $crate::documented::documented!(@docs $name [$([$($meta)*])*] $($part [$([$($part_meta)*])*])*);
    };
    ($(#[$($meta:tt)*])* $vis:vis enum $name:ident {
        $($(#[$($part_meta:tt)*])* $part:ident),* $(,)?
    }) => {
        $(#[$($meta)*])*
        $vis enum $name {
            $($(#[$($part_meta)*])* $part),*
        }
        $crate::documented::documented!(@docs $name [$([$($meta)*])*] $($part [$([$($part_meta)*])*])*);
    };
    (@docs $name:ident [$([$($meta:tt)*])*] $($part:ident [$([$($part_meta:tt)*])*])*) => {
        impl $name {
            /// Doc comments of the type and its parts.
            pub const DOCS: $crate::documented::Docs = $crate::documented::Docs {
                name: stringify!($name),
                lines: &[$($crate::documented::doc_line!($($meta)*)),*],
                parts: &[$((stringify!($part), &[$($crate::documented::doc_line!($($part_meta)*)),*])),*],
            };
        }
    };
}
pub(crate) use documented;
