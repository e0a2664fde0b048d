//! Describes each type of the scene file once: a field declared in [`spec`](super::spec) can be listed, set by its path, and
//! appears in the manual's scene reference.
//!
//! - `described!` defines a struct, or an enum whose variants have fields. A field's type may be followed by `=> name`
//!   (identifies the entry in lists; cannot be set), `=> skip` (cannot be set), or `=> given` (an optional value that can be set
//!   only where the scene gives it).
//! - `fields!` describes a struct that is defined elsewhere with [`documented!`](stickslip_core::model::documented) and whose
//!   fields are all optional. It lists every field; omitting one is a compile error.
//! - `words!` describes enums of unit variants that are defined elsewhere. The words are those that serde reads, so none can be
//!   missing.

pub(crate) mod macros;
mod model;
mod types;
mod words;

use super::error::{Path, SetError, quoted};
use crate::joined;
use stickslip_core::model::documented::{DocAttributes, text};
pub use types::{Field, Form, Type};
pub(crate) use types::{OWN_DEFAULTS, blank_form, contains, link, read_blank};

/// The current location of a walk, as a linked list of steps. It is converted to a name or a path only on demand.
#[derive(Clone, Copy)]
pub(crate) struct ScalarPlace<'a> {
    /// Parent and last step; `None` for the scene itself.
    last: Option<(&'a ScalarPlace<'a>, PlaceStep<'a>)>,
}

/// A step from one location to the next.
#[derive(Clone, Copy)]
enum PlaceStep<'a> {
    Field(&'a str),
    /// A list entry: its name, if it has one, and its index from 0.
    Entry(Option<&'a str>, usize),
}

impl<'a> ScalarPlace<'a> {
    /// The scene itself.
    pub(crate) fn root() -> ScalarPlace<'static> {
        ScalarPlace { last: None }
    }

    pub(crate) fn field(&'a self, key: &'a str) -> ScalarPlace<'a> {
        self.then(PlaceStep::Field(key))
    }

    /// A list entry, addressed by its name if it has one, else by its index from 0.
    fn entry(&'a self, called: Option<&'a str>, index: usize) -> ScalarPlace<'a> {
        self.then(PlaceStep::Entry(called, index))
    }

    /// A part of a tuple, which is named only here.
    fn part(&'a self, name: &'a str, index: usize) -> ScalarPlace<'a> {
        self.entry(Some(name), index)
    }

    fn then(&'a self, step: PlaceStep<'a>) -> ScalarPlace<'a> {
        ScalarPlace {
            last: Some((self, step)),
        }
    }

    /// The path as typed by a user.
    pub(crate) fn name(&self) -> String {
        let mut name = String::new();
        self.write(&mut name);
        name
    }

    fn write(&self, name: &mut String) {
        let Some((above, step)) = self.last else {
            return;
        };
        above.write(name);
        match step {
            PlaceStep::Field(word) | PlaceStep::Entry(Some(word), _) => {
                if above.last.is_some() {
                    name.push('.');
                }
                name.push_str(word);
            }
            PlaceStep::Entry(None, index) => *name += &format!("[{index}]"),
        }
    }

    /// Whether `name` as typed by a user addresses this location.
    pub(crate) fn is(&self, name: &str) -> bool {
        self.rest(name).is_some_and(str::is_empty)
    }

    /// The rest of a text after the name of this location; `None` if it does not start with that name.
    fn rest<'n>(&self, name: &'n str) -> Option<&'n str> {
        let Some((above, step)) = self.last else {
            return Some(name);
        };
        let name = above.rest(name)?;
        match step {
            PlaceStep::Field(word) | PlaceStep::Entry(Some(word), _) => {
                let name = match above.last {
                    Some(_) => name.strip_prefix('.')?,
                    None => name,
                };
                name.strip_prefix(word)
            }
            PlaceStep::Entry(None, index) => {
                let (digits, rest) = name.strip_prefix('[')?.split_once(']')?;
                (digits == index.to_string()).then_some(rest)
            }
        }
    }

    /// The path in the file.
    pub(crate) fn at(&self) -> Path {
        let Some((above, step)) = self.last else {
            return Path::default();
        };
        let mut path = above.at();
        path.0.push(match step {
            PlaceStep::Field(key) => key.into(),
            PlaceStep::Entry(_, index) => index.into(),
        });
        path
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
            Scalar::Choice(choice) => choice.name(),
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
            Scalar::Choice(choice) => choice.accepts(),
        }
    }

    /// The allowed words; empty for other kinds.
    pub(crate) fn words(&self) -> &'static [&'static str] {
        match self {
            Scalar::Choice(choice) => choice.names(),
            Scalar::Flag(_) => &["true", "false"],
            _ => &[],
        }
    }

    pub(crate) fn set(self, text: &str) -> Result<(), SetError> {
        let mut own = self;
        own.take(text).ok_or_else(|| {
            let is_whole = !text.is_empty()
                && text
                    .trim_start_matches('-')
                    .bytes()
                    .all(|b| b.is_ascii_digit());
            let kind = match own {
                Scalar::Count(_) | Scalar::Limit(_) if is_whole => {
                    "a whole number that is neither negative nor huge".to_owned()
                }
                _ => own.kind(),
            };
            SetError::NoValue {
                value: quoted(text),
                kind,
            }
        })
    }

    /// Sets the value from a text, if the text is valid for it.
    fn take(&mut self, text: &str) -> Option<()> {
        let number = || text.parse::<f64>().ok().filter(|x| x.is_finite());
        match self {
            Scalar::Number(x) => **x = number()?,
            Scalar::Optional(x) if text == "none" => **x = None,
            Scalar::Optional(x) => **x = Some(number()?),
            Scalar::Count(n) => **n = text.parse().ok()?,
            Scalar::Limit(n) => **n = text.parse().ok()?,
            Scalar::Flag(flag) => **flag = text.parse().ok()?,
            Scalar::Text(old) => text.clone_into(old),
            Scalar::Choice(choice) => return choice.choose(text).then_some(()),
        }
        Some(())
    }
}

fn one_of(words: &[&str]) -> String {
    format!("one of {}", words.join(", "))
}

/// A fixed set of words.
pub(crate) trait Choice {
    fn names(&self) -> &'static [&'static str];
    fn name(&self) -> String;
    /// What may be written.
    fn accepts(&self) -> String {
        one_of(self.names())
    }
    /// Sets the choice with that name, if there is one.
    fn choose(&mut self, name: &str) -> bool;
}

/// Callback for every scalar of a walk.
pub(crate) type Visit<'v> = dyn FnMut(&ScalarPlace<'_>, Scalar<'_>) + 'v;

/// A type that can occur in a scene file.
pub(crate) trait Described: Sized {
    /// Visits every scalar, in file order.
    fn walk(&mut self, place: &ScalarPlace<'_>, visit: &mut Visit<'_>);
    /// Visits an optional value if it is present.
    fn walk_optional(this: &mut Option<Self>, place: &ScalarPlace<'_>, visit: &mut Visit<'_>) {
        if let Some(given) = this {
            given.walk(place, visit);
        }
    }
    /// Name that identifies it in lists.
    fn called(&self) -> Option<&str> {
        None
    }
    /// Description of the accepted values.
    fn kind() -> String;
    /// The shortest text that can be read as a value.
    fn blank() -> String;
    /// The value, formatted as a default in the reference.
    fn shown(&self) -> String;
    /// Adds the types it uses to the reference, each once.
    fn types(_into: &mut Vec<Type>) -> Result<(), String> {
        Ok(())
    }
}

/// A field as the reference shows it; `value` is its default if it is `optional`.
pub(crate) fn field_of<T: Described>(
    name: &'static str,
    docs: DocAttributes,
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

/// Adds the types used by a field.
pub(crate) fn types_of<T: Described>(_: &T, into: &mut Vec<Type>) -> Result<(), String> {
    T::types(into)
}

/// Scalars: type, variant, accepted values, shortest text, and format.
macro_rules! scalars {
    ($($type:ty, $scalar:ident, $kind:literal, $blank:literal, $shown:literal;)*) => {
        $(impl Described for $type {
            fn walk(&mut self, place: &ScalarPlace<'_>, visit: &mut Visit<'_>) {
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
    fn walk(&mut self, place: &ScalarPlace<'_>, visit: &mut Visit<'_>) {
        visit(place, Scalar::Number(self));
    }
    /// An optional number can be set even if it is absent.
    fn walk_optional(this: &mut Option<Self>, place: &ScalarPlace<'_>, visit: &mut Visit<'_>) {
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
    fn walk(&mut self, place: &ScalarPlace<'_>, visit: &mut Visit<'_>) {
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
    fn walk(&mut self, place: &ScalarPlace<'_>, visit: &mut Visit<'_>) {
        for (k, entry) in self.iter_mut().enumerate() {
            let called = entry.called().map(str::to_owned);
            entry.walk(&place.entry(called.as_deref(), k), visit);
        }
    }
    fn kind() -> String {
        format!("a list, each {}", T::kind())
    }
    fn blank() -> String {
        "[]".to_owned()
    }
    fn shown(&self) -> String {
        let all = joined(self.iter().map(T::shown), ", ");
        format!("[{all}]")
    }
    fn types(into: &mut Vec<Type>) -> Result<(), String> {
        T::types(into)
    }
}

/// Pairs: tuple elements in the file that have names on the command line.
macro_rules! pairs {
    ($($part:ty, $first:literal, $second:literal, $kind:literal;)*) => {
        $(impl Described for ($part, $part) {
            fn walk(&mut self, place: &ScalarPlace<'_>, visit: &mut Visit<'_>) {
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

/// Types whose parts cannot be set by a path: type, accepted values, and shortest text.
macro_rules! fixed {
    ($($type:ty, $kind:literal, $blank:literal;)*) => {
        $(impl $crate::format::described::Described for $type {
            fn walk(
                &mut self,
                _: &$crate::format::described::ScalarPlace<'_>,
                _: &mut $crate::format::described::Visit<'_>,
            ) {
            }
            fn kind() -> String {
                $kind.to_owned()
            }
            fn blank() -> String {
                $blank.to_owned()
            }
            fn shown(&self) -> String {
                format!("{self:?}")
            }
        })*
    };
}
pub(crate) use fixed;

fixed! {
    (usize, usize, f64), "two whole numbers and a number (row, column, value)", "(0, 0, 0.0)";
    (usize, f64, f64), "a whole number and two numbers (label, x, y)", "(0, 0.0, 0.0)";
}
