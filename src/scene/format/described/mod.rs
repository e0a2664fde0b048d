//! The types of the scene file, described once: a field that is written in [`spec`](super::spec) can be listed, set by
//! its path, and stands in the manual's scene reference.
//!
//! - `described!` defines a struct, or an enum whose variants have fields. After a field's type may stand
//!   `=> name` (lists call their entries by it; no value to set), `=> skip` (no value to set), `=> given` (an optional
//!   value that can be set where there is one).
//! - `fields!` describes a struct that is defined elsewhere with [`documented!`](stickslip_core::model::documented), all of whose
//!   fields may be left out. It names them all: one that is forgotten does not compile.
//! - `words!` describes enums of plain words that are defined elsewhere. The words are those that serde reads, so
//!   that none can be forgotten.

pub(crate) mod macros;
mod model;
mod types;
mod words;

use super::error::{NotSet, Path, quoted};
use stickslip_core::model::documented::{Lines, text};
pub use types::{Field, Form, Type};
pub(crate) use types::{OWN_DEFAULTS, blank_form, known, link, read_blank};

/// A place that a walk has come to: the way there, which is made a name or a path of only where somebody asks.
#[derive(Clone, Copy)]
pub(crate) struct ScalarPlace<'a> {
    /// Where the last step was taken from; nothing at the scene itself.
    last: Option<(&'a ScalarPlace<'a>, PlaceStep<'a>)>,
}

/// A step from one place to the next.
#[derive(Clone, Copy)]
enum PlaceStep<'a> {
    Field(&'a str),
    /// An entry of a list by its name, which not all have, and by its position from 0.
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

    /// An entry of a list: by its name if it has one, else by its position from 0.
    fn entry(&'a self, called: Option<&'a str>, index: usize) -> ScalarPlace<'a> {
        self.then(PlaceStep::Entry(called, index))
    }

    /// A part of a tuple, which has a name only here.
    fn part(&'a self, name: &'a str, index: usize) -> ScalarPlace<'a> {
        self.entry(Some(name), index)
    }

    fn then(&'a self, step: PlaceStep<'a>) -> ScalarPlace<'a> {
        ScalarPlace {
            last: Some((self, step)),
        }
    }

    /// As a person types it.
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

    /// Whether a person who types this means it.
    pub(crate) fn is(&self, name: &str) -> bool {
        self.rest(name).is_some_and(str::is_empty)
    }

    /// What follows in a text after the name of this place; `None` where it does not begin with that.
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

    /// As the file has it.
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

    /// The words that it can be; none where it is no word.
    pub(crate) fn words(&self) -> &'static [&'static str] {
        match self {
            Scalar::Choice(choice) => choice.names(),
            Scalar::Flag(_) => &["true", "false"],
            _ => &[],
        }
    }

    pub(crate) fn set(self, text: &str) -> Result<(), NotSet> {
        let mut own = self;
        own.take(text).ok_or_else(|| NotSet::NoValue {
            value: quoted(text),
            kind: own.kind(),
        })
    }

    /// Takes what a text says, if it says anything of the kind.
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

/// One of a few words.
pub(crate) trait Choice {
    fn names(&self) -> &'static [&'static str];
    fn name(&self) -> &'static str;
    /// Takes the choice of that name, if there is one.
    fn choose(&mut self, name: &str) -> bool;
}

/// What a walk does at every scalar.
pub(crate) type Visit<'v> = dyn FnMut(&ScalarPlace<'_>, Scalar<'_>) + 'v;

/// What can stand in a scene file.
pub(crate) trait Described: Sized {
    /// Visits every scalar in it, in the order of the file.
    fn walk(&mut self, place: &ScalarPlace<'_>, visit: &mut Visit<'_>);
    /// Visits an optional one where there is one.
    fn walk_optional(this: &mut Option<Self>, place: &ScalarPlace<'_>, visit: &mut Visit<'_>) {
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
    /// An optional number can be set where there is none.
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

/// A node of a given mesh: its label, x and y, none of which is set by a path.
impl Described for (usize, f64, f64) {
    fn walk(&mut self, _place: &ScalarPlace<'_>, _visit: &mut Visit<'_>) {}
    fn kind() -> String {
        "a whole number and two numbers (label, x, y)".to_owned()
    }
    fn blank() -> String {
        "(0, 0.0, 0.0)".to_owned()
    }
    fn shown(&self) -> String {
        format!("{self:?}")
    }
}
