//! The scene reference as Markdown for the manual's pages.

use stickslip::format::described::{Field, Form, Type};
use stickslip::format::reference::reference;
use stickslip::scene::joined;

/// All types of the file except the settings, which have a separate page.
///
/// # Errors
/// If the reference cannot be generated.
pub fn types() -> Result<String, String> {
    let all = reference()?;
    let is_word = |one: &Type| one.forms.iter().all(|form| form.fields.is_empty());
    let mut text = String::new();
    for one in all
        .iter()
        .filter(|one| one.name != "Settings" && !is_word(one))
    {
        text += &format!("### {}\n\n{}\n\n", one.name, plain(&one.docs));
        for form in &one.forms {
            if let Some(name) = form.name {
                text += &format!("#### {name}\n\n");
            }
            if !form.docs.is_empty() {
                text += &format!("{}\n\n", plain(&form.docs));
            }
            text += &fields(form, &all);
        }
    }
    Ok(text.trim_end().replace("(#settings)", "(settings.md)") + "\n")
}

/// The settings with their choices.
///
/// # Errors
/// If the reference cannot be generated.
pub fn settings() -> Result<String, String> {
    let all = reference()?;
    let found = all.iter().find(|one| one.name == "Settings");
    let settings = found.ok_or("the reference has no Settings")?;
    Ok(settings
        .forms
        .iter()
        .map(|form| fields(form, &all))
        .collect())
}

fn fields(form: &Form, all: &[Type]) -> String {
    let mut text = String::new();
    for field in &form.fields {
        let default = field.default.as_ref();
        let default = default
            .map(|value| {
                if value.starts_with("all its") {
                    format!(", default {value}")
                } else {
                    format!(", default `{value}`")
                }
            })
            .unwrap_or_default();
        let words = words(field, all);
        let kind = match words {
            Some(_) => match field.kind.split_once(", or ") {
                Some((_, other)) => format!("one of these words, or {other}"),
                None => "one of these words".to_owned(),
            },
            None => field.kind.clone(),
        };
        text += format!(
            "- `{}`: {kind}{default}. {}",
            field.name,
            without_default(&field.docs)
        )
        .trim_end();
        text.push('\n');
        for word in words.into_iter().flatten() {
            text += format!(
                "    - `{}`: {}",
                word.name.unwrap_or_default(),
                plain(&word.docs)
            )
            .trim_end_matches([':', ' ']);
            text.push('\n');
        }
    }
    text.push('\n');
    text
}

/// The allowed words of a field.
fn words<'a>(field: &Field, all: &'a [Type]) -> Option<&'a [Form]> {
    let listed = field.kind.strip_prefix("one of ")?;
    let listed = listed.split_once(", or ").map_or(listed, |parts| parts.0);
    let names = |one: &Type| joined(one.forms.iter().filter_map(|form| form.name), ", ");
    all.iter()
        .find(|one| names(one) == listed)
        .map(|one| &one.forms[..])
}

/// A doc comment without a plain default at its end, because the default is shown separately.
fn without_default(docs: &str) -> String {
    let docs = plain(docs);
    match docs.split_once("Default: ") {
        Some((before, default))
            if !default.trim_end_matches('.').contains(' ') || default == "(1, 1)." =>
        {
            before.trim_end().to_owned()
        }
        _ => docs,
    }
}

/// A doc comment without rustdoc links, which do not work on a page.
fn plain(docs: &str) -> String {
    docs.replace("[`", "`").replace("`]", "`")
}
