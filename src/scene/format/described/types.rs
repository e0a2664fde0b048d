//! Entries of the scene reference: the forms of a type, their fields, accepted values and defaults.

use crate::format::notation::options;
use crate::joined;
use serde::de::DeserializeOwned;
use stickslip_core::model::documented::{DocAttributes, Docs, text};

/// A type of the scene file, as the reference shows it.
#[derive(Debug, Clone)]
pub struct Type {
    /// Name in the file.
    pub name: &'static str,
    /// Its doc comment.
    pub docs: String,
    /// A single form without a name for a struct; one per variant for an enum.
    pub forms: Vec<Form>,
}

/// A struct, a variant with its fields, or a word.
#[derive(Debug, Clone)]
pub struct Form {
    /// Name of the variant or word in the file.
    pub name: Option<&'static str>,
    /// Doc comment; empty for a struct.
    pub docs: String,
    /// Fields in file order; empty for a word.
    pub fields: Vec<Field>,
}

/// A field of a form.
#[derive(Debug, Clone)]
pub struct Field {
    /// Name in the file.
    pub name: &'static str,
    /// Doc comment.
    pub docs: String,
    /// Accepted values.
    pub kind: String,
    /// Default as serde reads it; `None` for a required field.
    pub default: Option<String>,
}

/// Whether the reference already contains the type.
pub(crate) fn contains(types: &[Type], name: &str) -> bool {
    types.iter().any(|known| known.name == name)
}

/// `form(field: …, …)` with the required fields; only the name of a form without fields.
pub(crate) fn blank_form(form: Option<&str>, fields: &[(&str, bool, String)]) -> String {
    let form = form.unwrap_or_default();
    if fields.is_empty() {
        return form.to_owned();
    }
    let written = joined(
        fields
            .iter()
            .filter(|(_, optional, _)| !optional)
            .map(|(name, _, blank)| format!("{name}: {blank}")),
        ", ",
    );
    format!("{form}({written})")
}

/// The value of the shortest text, with all optional fields at their defaults.
pub(crate) fn read_blank<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    options()
        .from_str(text)
        .map_err(|error| format!("{text}: {error}"))
}

/// Shown for a default that consists of the defaults of its fields.
pub(crate) const OWN_DEFAULTS: &str = "that of each field";

/// A type name, linked to its section of the reference.
pub(crate) fn link(name: &str) -> String {
    format!("[{name}](#{})", name.to_lowercase())
}

/// The doc comment of a part.
pub(super) fn lines_of(docs: &Docs, part: &str) -> DocAttributes {
    let found = docs.parts.iter().find(|(name, _)| *name == part);
    found.map_or(&[], |(_, lines)| lines)
}

/// An enum of unit variants; serde lists them in declaration order.
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
    use stickslip_core::model::{Friction, InitialState, SearchBudget, SearchMode, Settings};

    #[test]
    fn a_budget_of_the_search_is_a_word_or_a_number_also_under_its_former_name() {
        let of = |text: &str| read_blank::<Settings>(text).map(|settings| settings.search);
        assert_eq!(of("(search: 3)").unwrap(), SearchBudget::Limit(3));
        assert_eq!(of("(search_limit: 3)").unwrap(), SearchBudget::Limit(3));
        assert_eq!(
            of("(search: off)").unwrap(),
            SearchBudget::Mode(SearchMode::Off)
        );
        let refused = of("(search: -3)").unwrap_err().to_string();
        assert!(refused.contains("auto, off, or a number"), "{refused}");
    }

    #[test]
    fn omitted_fields_have_their_defaults() {
        assert_eq!(read_blank::<Settings>("()").unwrap(), Settings::default());
        assert_eq!(read_blank::<Friction>("()").unwrap(), Friction::default());
        assert_eq!(
            read_blank::<InitialState>("()").unwrap(),
            InitialState::default()
        );
    }
}
