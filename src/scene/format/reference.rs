//! The scene reference: every type of the file with its fields, accepted values and defaults.

use super::described::{Described, Type};
use super::spec::Spec;

/// All types of the scene file: the scene first, each other type after the first one that uses it.
///
/// # Errors
/// If the defaults of a type cannot be read. That would be a bug in this module; the tests check it.
pub fn reference() -> Result<Vec<Type>, String> {
    let mut all = Vec::new();
    Spec::types(&mut all)?;
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::super::described::Field;
    use super::*;

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
    fn reference_defaults_are_those_that_serde_reads() {
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

    /// A plain default named in a comment, compared with the actual default.
    #[test]
    fn defaults_named_in_comments_are_correct() {
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
    fn every_type_and_word_is_documented() {
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
}
