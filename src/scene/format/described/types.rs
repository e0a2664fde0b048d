//! What the scene reference says of a type: its forms, their fields, what may be written and what is the default.

use crate::format::notation::options;
use serde::de::DeserializeOwned;
use stickslip_core::model::documented::{Docs, Lines, text};

/// A type of the scene file, as the reference shows it.
#[derive(Debug, Clone)]
pub struct Type {
    /// Its name, as the file has it.
    pub name: &'static str,
    /// Its doc comment.
    pub docs: String,
    /// One without a name for a struct; for an enum one for each variant.
    pub forms: Vec<Form>,
}

/// A struct, a variant with its fields, or a word.
#[derive(Debug, Clone)]
pub struct Form {
    /// The variant's or the word's name, as the file has it.
    pub name: Option<&'static str>,
    /// Its doc comment; empty for a struct.
    pub docs: String,
    /// Its fields, in the order of the file; empty for a word.
    pub fields: Vec<Field>,
}

/// A field of a form.
#[derive(Debug, Clone)]
pub struct Field {
    /// Its name, as the file has it.
    pub name: &'static str,
    /// Its doc comment.
    pub docs: String,
    /// What may be written.
    pub kind: String,
    /// What it is where it is left out, as serde reads it; `None` for a field that must be there.
    pub default: Option<String>,
}

/// Whether the reference has the type already.
pub(crate) fn known(types: &[Type], name: &str) -> bool {
    types.iter().any(|known| known.name == name)
}

/// `head(field: …, …)` of the fields that must be there.
pub(crate) fn blank_form(head: &str, fields: &[(&str, bool, String)]) -> String {
    let required = fields.iter().filter(|(_, optional, _)| !optional);
    let written: Vec<String> = required
        .map(|(name, _, blank)| format!("{name}: {blank}"))
        .collect();
    format!("{head}({})", written.join(", "))
}

/// The value of the shortest text: what serde makes of the fields that are left out.
pub(crate) fn read_blank<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    options()
        .from_str(text)
        .map_err(|error| format!("{text}: {error}"))
}

/// How the reference shows a default that is made of the defaults of its fields.
pub(crate) const OWN_DEFAULTS: &str = "all its defaults";

/// A type's name, leading to where the reference describes it.
pub(crate) fn link(name: &str) -> String {
    format!("[{name}](#{})", name.to_lowercase())
}

/// The doc comment of a part.
pub(super) fn lines_of(docs: &Docs, part: &str) -> Lines {
    let found = docs.parts.iter().find(|(name, _)| *name == part);
    found.map_or(&[], |(_, lines)| lines)
}

/// An enum of plain words: serde lists them in the order of the variants.
pub(super) fn of_words(docs: &Docs, words: &[&'static str]) -> Type {
    let forms = words.iter().zip(docs.parts).map(|(word, (_, lines))| Form {
        name: Some(word),
        docs: text(lines),
        fields: Vec::new(),
    });
    Type {
        name: docs.name,
        docs: text(docs.lines),
        forms: forms.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_core::model::{Friction, InitialState, Settings};

    #[test]
    fn what_may_be_left_out_of_a_settings_table_is_its_default() {
        assert_eq!(read_blank::<Settings>("()").unwrap(), Settings::default());
        assert_eq!(read_blank::<Friction>("()").unwrap(), Friction::default());
        assert_eq!(
            read_blank::<InitialState>("()").unwrap(),
            InitialState::default()
        );
    }
}
