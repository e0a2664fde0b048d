//! The types of the scene file, described once: a field that is written in [`spec`](super::spec) can be listed, set by
//! its path, and stands in the manual's scene reference.
//!
//! - `described!` defines a struct, or an enum whose variants have fields. After a field's type may stand
//!   `=> name` (lists call their entries by it; no value to set), `=> skip` (no value to set), `=> given` (an optional
//!   value that can be set where there is one).
//! - `fields!` describes a struct that is defined elsewhere with [`documented!`](crate::model::documented), all of whose
//!   fields may be left out. It names them all: one that is forgotten does not compile.
//! - `words!` describes enums of plain words that are defined elsewhere. The words are those that serde reads, so
//!   that none can be forgotten.

pub(crate) mod macros;
mod model;
mod types;
mod words;

use super::error::{NotSet, Path, quoted};
use crate::model::documented::{Lines, text};
pub use types::{Field, Form, Type};
pub(crate) use types::{OWN_DEFAULTS, blank_form, known, link, read_blank};

/// A place that a walk has come to, by both its names.
#[derive(Clone)]
pub(crate) struct ScalarPlace {
    /// As a person types it.
    pub(crate) name: String,
    /// As the file has it.
    pub(crate) at: Path,
}

impl ScalarPlace {
    /// The scene itself.
    pub(crate) fn root() -> ScalarPlace {
        ScalarPlace {
            name: String::new(),
            at: Path::default(),
        }
    }

    pub(crate) fn field(&self, key: &str) -> ScalarPlace {
        let name = match self.name.as_str() {
            "" => key.to_owned(),
            name => format!("{name}.{key}"),
        };
        let at = self.at.then(key);
        ScalarPlace { name, at }
    }

    /// An entry of a list: by its name if it has one, else by its position from 0.
    fn entry(&self, called: Option<&str>, index: usize) -> ScalarPlace {
        let name = match called {
            Some(id) => format!("{}.{id}", self.name),
            None => format!("{}[{index}]", self.name),
        };
        let at = self.at.then(index);
        ScalarPlace { name, at }
    }

    /// A part of a tuple, which has a name only here.
    fn part(&self, name: &str, index: usize) -> ScalarPlace {
        self.entry(Some(name), index)
    }
}

/// A scalar that can be read and set.
pub(crate) enum Scalar<'a> {
    Number(&'a mut f64),
    Optional(&'a mut Option<f64>),
    Count(&'a mut usize),
    Limit(&'a mut u32),
    Flag(&'a mut bool),
    Text(&'a mut String),
    Choice(&'a mut dyn Choice),
}

impl Scalar<'_> {
    pub(crate) fn value(&self) -> String {
        match self {
            Scalar::Number(x) => x.shown(),
            Scalar::Optional(x) => x.shown(),
            Scalar::Count(n) => n.shown(),
            Scalar::Limit(n) => n.shown(),
            Scalar::Flag(flag) => flag.shown(),
            Scalar::Text(text) => (*text).clone(),
            Scalar::Choice(choice) => choice.name().to_owned(),
        }
    }

    pub(crate) fn kind(&self) -> String {
        match self {
            Scalar::Number(_) => f64::kind(),
            Scalar::Optional(_) => Option::<f64>::kind(),
            Scalar::Count(_) => usize::kind(),
            Scalar::Limit(_) => u32::kind(),
            Scalar::Flag(_) => bool::kind(),
            Scalar::Text(_) => String::kind(),
            Scalar::Choice(choice) => one_of(choice.names()),
        }
    }

    pub(crate) fn set(self, text: &str) -> Result<(), NotSet> {
        let kind = self.kind();
        let wrong = || NotSet::NoValue {
            value: quoted(text),
            kind: kind.clone(),
        };
        let number = || {
            let finite = text.parse::<f64>().ok().filter(|x| x.is_finite());
            finite.ok_or_else(wrong)
        };
        match self {
            Scalar::Number(x) => *x = number()?,
            Scalar::Optional(x) if text == "none" => *x = None,
            Scalar::Optional(x) => *x = Some(number()?),
            Scalar::Count(n) => *n = text.parse().map_err(|_| wrong())?,
            Scalar::Limit(n) => *n = text.parse().map_err(|_| wrong())?,
            Scalar::Flag(flag) => *flag = text.parse().map_err(|_| wrong())?,
            Scalar::Text(old) => text.clone_into(old),
            Scalar::Choice(choice) => {
                if !choice.choose(text) {
                    return Err(wrong());
                }
            }
        }
        Ok(())
    }
}

fn one_of(words: &[&str]) -> String {
    format!("one of {}", words.join(", "))
}

/// One of a few words.
pub(crate) trait Choice {
    fn names(&self) -> &'static [&'static str];
    fn name(&self) -> &'static str;
    /// Takes the choice of that name, if there is one.
    fn choose(&mut self, name: &str) -> bool;
}

/// What a walk does at every scalar.
pub(crate) type Visit<'v> = dyn FnMut(&ScalarPlace, Scalar<'_>) + 'v;

/// What can stand in a scene file.
pub(crate) trait Described: Sized {
    /// Visits every scalar in it, in the order of the file.
    fn walk(&mut self, place: &ScalarPlace, visit: &mut Visit<'_>);
    /// Visits an optional one where there is one.
    fn walk_optional(this: &mut Option<Self>, place: &ScalarPlace, visit: &mut Visit<'_>) {
        if let Some(given) = this {
            given.walk(place, visit);
        }
    }
    /// What lists call it by.
    fn called(&self) -> Option<&str> {
        None
    }
    /// What may be written, in words.
    fn kind() -> String;
    /// The shortest text that can be read as one.
    fn blank() -> String;
    /// The value, as the reference shows a default.
    fn shown(&self) -> String;
    /// Adds the types that stand in it to the reference, each once.
    fn types(_into: &mut Vec<Type>) -> Result<(), String> {
        Ok(())
    }
}

/// A field as the reference shows it; `value` is its default where it is `optional`.
pub(crate) fn field_of<T: Described>(
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

/// Adds the types that stand in a field.
fn types_of<T: Described>(_: &T, into: &mut Vec<Type>) -> Result<(), String> {
    T::types(into)
}

/// Scalars that are visited as they are: type, scalar, what may be written, the shortest text, how it is shown.
macro_rules! scalars {
    ($($type:ty, $scalar:ident, $kind:literal, $blank:literal, $shown:literal;)*) => {
        $(impl Described for $type {
            fn walk(&mut self, place: &ScalarPlace, visit: &mut Visit<'_>) {
                visit(place, Scalar::$scalar(self));
            }
            fn kind() -> String {
                $kind.to_owned()
            }
            fn blank() -> String {
                $blank.to_owned()
            }
            fn shown(&self) -> String {
                format!($shown, self)
            }
        })*
    };
}

scalars! {
    usize, Count, "a whole number", "0", "{}";
    u32, Limit, "a whole number", "0", "{}";
    bool, Flag, "true or false", "false", "{}";
    String, Text, "a text", "\"\"", "{:?}";
}

impl Described for f64 {
    fn walk(&mut self, place: &ScalarPlace, visit: &mut Visit<'_>) {
        visit(place, Scalar::Number(self));
    }
    /// An optional number can be set where there is none.
    fn walk_optional(this: &mut Option<Self>, place: &ScalarPlace, visit: &mut Visit<'_>) {
        visit(place, Scalar::Optional(this));
    }
    fn kind() -> String {
        "a number".to_owned()
    }
    fn blank() -> String {
        "0.0".to_owned()
    }
    fn shown(&self) -> String {
        format!("{self:?}")
    }
}

impl<T: Described> Described for Option<T> {
    fn walk(&mut self, place: &ScalarPlace, visit: &mut Visit<'_>) {
        T::walk_optional(self, place, visit);
    }
    fn kind() -> String {
        format!("{}, or none", T::kind())
    }
    fn blank() -> String {
        "None".to_owned()
    }
    fn shown(&self) -> String {
        self.as_ref().map_or_else(|| "none".to_owned(), T::shown)
    }
    fn types(into: &mut Vec<Type>) -> Result<(), String> {
        T::types(into)
    }
}

impl<T: Described> Described for Vec<T> {
    fn walk(&mut self, place: &ScalarPlace, visit: &mut Visit<'_>) {
        for (k, entry) in self.iter_mut().enumerate() {
            let place = place.entry(entry.called(), k);
            entry.walk(&place, visit);
        }
    }
    fn kind() -> String {
        format!("a list, each {}", T::kind())
    }
    fn blank() -> String {
        "[]".to_owned()
    }
    fn shown(&self) -> String {
        let all: Vec<String> = self.iter().map(T::shown).collect();
        format!("[{}]", all.join(", "))
    }
    fn types(into: &mut Vec<Type>) -> Result<(), String> {
        T::types(into)
    }
}

/// Pairs: their parts are tuple elements in the file and have names on the command line.
macro_rules! pairs {
    ($($part:ty, $first:literal, $second:literal, $kind:literal;)*) => {
        $(impl Described for ($part, $part) {
            fn walk(&mut self, place: &ScalarPlace, visit: &mut Visit<'_>) {
                self.0.walk(&place.part($first, 0), visit);
                self.1.walk(&place.part($second, 1), visit);
            }
            fn kind() -> String {
                $kind.to_owned()
            }
            fn blank() -> String {
                format!("({0}, {0})", <$part>::blank())
            }
            fn shown(&self) -> String {
                format!("({}, {})", self.0.shown(), self.1.shown())
            }
        })*
    };
}

pairs! {
    f64, "x", "y", "two numbers (x, y)";
    usize, "x", "y", "two whole numbers (x, y)";
    String, "a", "b", "two texts (a, b)";
}
