//! The scene reference: every type of the file, its fields, what may be written and what holds where nothing is.

use super::Described;
use crate::model::documented::{Docs, Lines, text};
use crate::scene::Spec;
use crate::scene::read::options;
use serde::de::DeserializeOwned;

/// A type of the scene file, as the reference shows it.
#[derive(Debug, Clone)]
pub struct Type {
    pub name: &'static str,
    pub docs: String,
    /// One without a name for a struct; for an enum one for each variant.
    pub forms: Vec<Form>,
}

/// A struct, a variant with its fields, or a word.
#[derive(Debug, Clone)]
pub struct Form {
    /// The variant's or the word's name, as the file has it.
    pub name: Option<&'static str>,
    pub docs: String,
    pub fields: Vec<Field>,
}

/// A field of a form.
#[derive(Debug, Clone)]
pub struct Field {
    pub name: &'static str,
    pub docs: String,
    /// What may be written.
    pub kind: String,
    /// What it is where it is left out, as serde reads it; `None` for a field that must be there.
    pub default: Option<String>,
}

impl Field {
    pub(crate) fn of<T: Described>(
        name: &'static str,
        docs: Lines,
        value: &T,
        optional: bool,
    ) -> Field {
        Field {
            name,
            docs: text(docs),
            kind: T::kind(),
            default: optional.then(|| value.shown()),
        }
    }
}

/// All types of the scene file, the scene itself first, each after one in which it stands.
///
/// # Errors
/// If the defaults of a type cannot be read, which would be a fault of this module; the tests call it.
pub fn reference() -> Result<Vec<Type>, String> {
    let mut all = Vec::new();
    Spec::types(&mut all)?;
    Ok(all)
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

pub(super) fn types_of<T: Described>(_: &T, into: &mut Vec<Type>) -> Result<(), String> {
    T::types(into)
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
    use super::super::words::{of_word, word, words};
    use super::*;
    use crate::model::{Friction, InitialState, Law, Settings, Strategy};

    fn all() -> Vec<Type> {
        reference().unwrap_or_else(|error| panic!("{error}"))
    }

    fn field(of: &str, form: Option<&str>, name: &str) -> Field {
        let all = all();
        let found = all.iter().find(|one| one.name == of).unwrap();
        let form = found.forms.iter().find(|one| one.name == form).unwrap();
        form.fields
            .iter()
            .find(|one| one.name == name)
            .unwrap()
            .clone()
    }

    #[test]
    fn defaults_of_the_reference_are_those_that_are_read() {
        assert_eq!(field("Spec", None, "title").default, None);
        assert_eq!(field("Spec", None, "refine").default.as_deref(), Some("1"));
        assert_eq!(field("Spec", None, "loads").default.as_deref(), Some("[]"));
        assert_eq!(
            field("Nodes", Some("Block"), "grading").default.as_deref(),
            Some("(1.0, 1.0)")
        );
        assert_eq!(
            field("Nodes", Some("Mesh"), "tolerance").default.as_deref(),
            Some("1e-6")
        );
        assert_eq!(
            field("Material", Some("Section"), "GA").default.as_deref(),
            Some("none")
        );
        assert_eq!(
            field("Material", Some("Elastic"), "law").default.as_deref(),
            Some("svk")
        );
        assert_eq!(
            field("Settings", None, "majors").default.as_deref(),
            Some("60")
        );
        assert_eq!(field("Sides", None, "top").default.as_deref(), Some("none"));
        assert_eq!(
            field("SlaveSpec", None, "start").kind,
            "one of free, sliding, fixed"
        );
    }

    /// What a comment says of a default, where that is a plain value, against the value itself.
    #[test]
    fn a_default_that_a_comment_names_is_the_one_that_is_read() {
        let mut compared = 0;
        for field in all()
            .iter()
            .flat_map(|one| &one.forms)
            .flat_map(|form| form.fields.clone())
        {
            let Some((_, said)) = field.docs.split_once("Default: ") else {
                continue;
            };
            let said = said
                .split([',', ';'])
                .next()
                .unwrap_or_default()
                .trim_end_matches('.');
            let default = field
                .default
                .unwrap_or_else(|| panic!("{} has no default", field.name));
            let plain = said
                .chars()
                .all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
            if plain && !["none", "empty", "zero", "nothing", "smooth"].contains(&said) {
                compared += 1;
                let number = |text: &str| text.parse::<f64>().ok();
                let same =
                    said == default || (number(said).is_some() && number(said) == number(&default));
                assert!(
                    same,
                    "{}: the comment says {said}, read is {default}",
                    field.name
                );
            }
        }
        assert!(compared > 20, "{compared}");
    }

    #[test]
    fn every_type_and_word_says_what_it_is() {
        for one in all() {
            assert!(!one.docs.is_empty(), "{} is not described", one.name);
            assert!(!one.forms.is_empty(), "{} has no form", one.name);
            for field in one.forms.iter().flat_map(|form| &form.fields) {
                assert!(
                    !field.docs.is_empty(),
                    "{}: {} is not described",
                    one.name,
                    field.name
                );
            }
        }
    }

    #[test]
    fn words_are_written_as_they_are_read() {
        for name in words::<Strategy>() {
            let value: Strategy = of_word(name).unwrap();
            assert_eq!(word(&value), *name);
        }
        assert_eq!(words::<Strategy>(), Strategy::NAMES);
        assert_eq!(words::<Law>(), ["svk", "neohookean"]);
        assert_eq!(of_word::<Law>("steel"), None);
        assert_eq!(Strategy::DOCS.parts.len(), Strategy::NAMES.len());
    }

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
