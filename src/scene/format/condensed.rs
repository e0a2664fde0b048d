//! Interface problems without bodies: contacts and the matrix that couples them.
//!
//! All values are in the frame of each contact: n is the outward normal of its master, t is n turned 90 degrees anticlockwise.
//! Displacements u and forces f are those of the slave node; f_n > 0 pushes it away. Components are ordered in pairs: (n, t) of
//! the first contact, of the second, and so on:
//!
//! ```text
//! K (u − free λ) = load λ + f        or        u = free λ + W (load λ + f),        gap = gap_0 + u_n
//! ```
//!
//! With `tangents: 2` the problem is one in space, given by W: three components (n, t, n × t) per contact, no loads, and gaps that
//! `free` includes.
//!
//! A RON file that begins with `Contacts(` is such a problem, with the fields of [`Problem`]; [`Problem::text`] writes it.
//! [`Problem::spec`] converts it to an ordinary scene: the contacts in a row above an endless floor y = 0, where u_n = u_y and
//! u_t = −u_x.

use super::error::{Fault, Path, Step, at, bail};
use super::in_space::SpaceSpec;
use super::notation;
use super::spec::{BodySpec, History, LoadSpec, Nodes, SlaveSpec, Spec, SurfaceSpec};
use ron::ser::PrettyConfig;
use ron::value::RawValue;
use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use stickslip_core::plane::max_abs;
use stickslip_core::words::is_default;
use stickslip_core::{Friction, InitialState, Mode, Settings, counted};
use stickslip_exchange::problem;

/// First word of an interface problem file.
pub const HEAD: &str = "Contacts";

/// Response of the body that carries the contacts: row by row, or by its entries.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Matrix {
    /// K, force per length.
    Stiffness(Vec<Vec<f64>>),
    /// W, length per force; may be singular.
    Compliance(Vec<Vec<f64>>),
    /// W by its nonzero entries: row, column (from 0) and value; repeated ones are added.
    Entries(Vec<(usize, usize, f64)>),
}

/// One contact.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Name of the node.
    pub id: String,
    /// Undeformed distance to the master; negative is penetration. Default: 0.
    #[serde(default, skip_serializing_if = "is_default")]
    pub gap: f64,
    /// Friction of the contact. Default: smooth.
    #[serde(
        default,
        skip_serializing_if = "is_default",
        serialize_with = "changes"
    )]
    pub friction: Friction,
    /// Load on the node along n and t at load factor 1. Default: none.
    #[serde(default, skip_serializing_if = "is_default")]
    pub load: [f64; 2],
    /// Mode of the first minor iteration. Default: free.
    #[serde(default, skip_serializing_if = "is_default")]
    pub start: Mode,
    /// Values from iterations before the first one. Default: nothing.
    #[serde(
        default,
        skip_serializing_if = "is_default",
        serialize_with = "changes"
    )]
    pub state: InitialState,
}

/// An interface problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Contacts", deny_unknown_fields)]
pub struct Problem {
    /// One-line title.
    pub title: String,
    /// Description. Default: empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub about: String,
    /// Tangential components of each contact: 1, or 2 in space. Default: 1.
    #[serde(
        default = "one",
        deserialize_with = "tangents",
        skip_serializing_if = "is_one"
    )]
    pub tangents: usize,
    /// The contacts, in the order of the rows and columns of `matrix`.
    pub contacts: Vec<Contact>,
    /// Response of the body that carries the contacts.
    pub matrix: Matrix,
    /// Displacement without contact forces at load factor 1: two components per contact, or an empty list. Default: none.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        serialize_with = "on_one_line"
    )]
    pub free: Vec<f64>,
    /// Spacing of neighbouring contacts: a typical length of gaps and motions, to which length tolerances are relative. Default:
    /// the largest gap or free motion.
    #[serde(
        default,
        deserialize_with = "positive",
        skip_serializing_if = "Option::is_none",
        serialize_with = "bare"
    )]
    pub spacing: Option<f64>,
    /// Path of the load factor. Default: one increment from 0 to 1.
    #[serde(
        default,
        skip_serializing_if = "is_default",
        serialize_with = "on_one_line"
    )]
    pub history: History,
    /// Options of the method. Default: as for a scene.
    #[serde(
        default,
        skip_serializing_if = "is_default",
        serialize_with = "changes"
    )]
    pub settings: Settings,
}

fn one() -> usize {
    1
}

fn is_one(tangents: &usize) -> bool {
    *tangents == 1
}

fn tangents<'de, D: Deserializer<'de>>(reader: D) -> Result<usize, D::Error> {
    match usize::deserialize(reader)? {
        tangents @ 1..=2 => Ok(tangents),
        other => Err(D::Error::custom(format!(
            "tangents is {other}; it must be 1, or 2 in space"
        ))),
    }
}

fn positive<'de, D: Deserializer<'de>>(reader: D) -> Result<Option<f64>, D::Error> {
    let value = Option::<f64>::deserialize(reader)?;
    match value {
        Some(x) if !(x > 0.0 && x.is_finite()) => Err(D::Error::custom(format!(
            "spacing is {x:?}; it must be a positive length"
        ))),
        _ => Ok(value),
    }
}

impl Problem {
    /// A plane problem with the default history and settings.
    pub fn new(title: &str, contacts: Vec<Contact>, matrix: Matrix, mut free: Vec<f64>) -> Problem {
        // Zeros without a sign.
        free.iter_mut().for_each(|q| *q += 0.0);
        if free.iter().all(|q| *q == 0.0) {
            free.clear();
        }
        Problem {
            title: title.to_owned(),
            about: String::new(),
            tangents: one(),
            contacts,
            matrix,
            free,
            spacing: None,
            history: History::default(),
            settings: Settings::default(),
        }
    }

    /// The path in the problem's own file of a value of the converted scene.
    pub(crate) fn origin(&self, of_scene: &Path) -> Path {
        let Some((Step::Key(list), rest)) = of_scene.0.split_first() else {
            return Path::default();
        };
        let (number, rest) = match rest.split_first() {
            Some((Step::Index(number), rest)) => (*number, rest),
            _ => (0, rest),
        };
        let (key, rest) = match rest.split_first() {
            Some((Step::Key(key), rest)) => (key.as_str(), rest),
            _ => ("", rest),
        };
        let after = |path: Path, rest: &[Step]| Path([&path.0[..], rest].concat());
        let contact = |k: usize| at!["contacts", k];
        // Rows and components are (n, t) in the file and (x, y) = (-t, n) in the scene.
        let turned: Vec<Step> = rest.iter().map(other_of_pair).collect();
        match (list.as_str(), key) {
            ("nodes", _) if number >= self.contacts.len() => at!["spacing"],
            ("nodes", "id") => contact(number).then("id"),
            ("nodes", "at") => contact(number).then("gap"),
            ("nodes" | "slaves", "" | "on") => contact(number),
            ("slaves", "nodes") => contact(number).then("id"),
            ("slaves", field) => after(contact(number).then(field), rest),
            ("loads", _) => {
                let mut loaded =
                    (0..self.contacts.len()).filter(|&k| load(&self.contacts[k]).is_some());
                contact(loaded.nth(number).unwrap_or(0)).then("load")
            }
            ("bodies", "free") => after(at!["free"], &turned),
            ("bodies", "nodes") => match rest.first() {
                Some(Step::Index(k)) => contact(*k).then("id"),
                _ => at!["contacts"],
            },
            ("bodies", "") => at!["matrix"],
            ("bodies", "entries") => after(at!["matrix"], rest),
            ("bodies", _) => after(at!["matrix"], &turned),
            ("surfaces" | "friction" | "materials" | "supports" | "monitors", _) => Path::default(),
            _ => of_scene.clone(),
        }
    }

    /// The problem as a scene; compiling the scene checks it.
    pub fn spec(&self) -> Spec {
        if self.tangents == 2 {
            return Spec {
                title: self.title.clone(),
                about: self.about.clone(),
                settings: self.settings,
                in_space: Some(self.space()),
                ..Spec::default()
            };
        }
        let spacing = self.length();
        let ids = || self.contacts.iter().map(|contact| contact.id.clone());
        let mut nodes: Vec<Nodes> = self
            .contacts
            .iter()
            .enumerate()
            .map(|(k, contact)| Nodes::Node {
                id: contact.id.clone(),
                at: (k as f64 * spacing, contact.gap),
            })
            .collect();
        // Walked towards -x, so that the outward side is up.
        nodes.push(Nodes::Line {
            id: FLOOR.to_owned(),
            from: (self.contacts.len() as f64 * spacing, 0.0),
            to: (-spacing, 0.0),
            elements: 1,
            per_element: 2,
        });
        let (mut stiffness, mut compliance, mut entries) = Default::default();
        match &self.matrix {
            Matrix::Stiffness(rows) => stiffness = turned(rows),
            Matrix::Compliance(rows) => compliance = turned(rows),
            Matrix::Entries(given) => entries = turned_entries(given),
        }
        Spec {
            title: self.title.clone(),
            about: self.about.clone(),
            nodes,
            bodies: vec![BodySpec::Matrix {
                id: "matrix".to_owned(),
                nodes: ids().collect(),
                stiffness,
                compliance,
                entries,
                free: turned_row(&self.free, 1.0),
            }],
            surfaces: vec![SurfaceSpec {
                id: FLOOR.to_owned(),
                along: FLOOR.to_owned(),
                endless: true,
                ..SurfaceSpec::default()
            }],
            slaves: self.contacts.iter().map(slave).collect(),
            loads: self.contacts.iter().filter_map(load).collect(),
            history: self.history.clone(),
            settings: self.settings,
            ..Spec::default()
        }
    }

    /// Rejects what a problem in space cannot have.
    pub(crate) fn check_in_space(&self) -> Result<(), Fault> {
        if self.tangents == 1 {
            return Ok(());
        }
        let count = 3 * self.contacts.len();
        match &self.matrix {
            Matrix::Stiffness(_) => {
                bail!(at!["matrix"], "a problem in space needs a compliance")
            }
            Matrix::Compliance(rows) => {
                if rows.len() != count {
                    let have = counted(rows.len(), "row");
                    bail!(
                        at!["matrix"],
                        "it has {have}; {count} are needed, three per contact"
                    );
                }
                if let Some(k) = rows.iter().position(|row| row.len() != count) {
                    let have = counted(rows[k].len(), "number");
                    bail!(
                        at!["matrix", k],
                        "row {} has {have}; {count} are needed",
                        k + 1
                    );
                }
            }
            Matrix::Entries(_) => {}
        }
        for (k, contact) in self.contacts.iter().enumerate() {
            let here = at!["contacts", k];
            if contact.load != [0.0; 2] {
                bail!(
                    here.then("load"),
                    "a problem in space has no loads; add W load to free"
                );
            }
            if (contact.start, &contact.state) != (Mode::Free, &InitialState::default()) {
                bail!(here, "in space a contact starts free and without a state");
            }
        }
        if self.history != History::default() || self.spacing.is_some() {
            bail!(
                Path::default(),
                "a problem in space has neither history nor spacing: it is solved in one increment"
            );
        }
        Ok(())
    }

    /// The problem in space.
    fn space(&self) -> SpaceSpec {
        let contact = |contact: &Contact| (contact.id.clone(), contact.friction);
        let mut free = self.free.clone();
        free.resize(free.len().max(3 * self.contacts.len()), 0.0);
        for (free, contact) in free.iter_mut().step_by(3).zip(&self.contacts) {
            *free += contact.gap;
        }
        SpaceSpec {
            contacts: self.contacts.iter().map(contact).collect(),
            compliance: match &self.matrix {
                Matrix::Entries(entries) => entries.clone(),
                Matrix::Compliance(rows) | Matrix::Stiffness(rows) => {
                    problem::Matrix::from_rows(rows).entries
                }
            },
            free,
        }
    }

    /// Length scale of the gaps and motions.
    fn length(&self) -> f64 {
        if let Some(spacing) = self.spacing {
            return spacing;
        }
        let gaps = self.contacts.iter().map(|contact| contact.gap);
        let most = max_abs(gaps.chain(self.free.iter().copied()));
        if most > 0.0 { most } else { 1.0 }
    }

    /// The text of the file: comment lines, then every field that differs from its default. Numbers are written with enough
    /// digits to be read back exactly.
    pub fn text(&self, comments: &[String]) -> String {
        let mut text = String::new();
        for line in comments {
            let line: String = line.chars().filter(|c| !c.is_control()).collect();
            text += format!("// {line}").trim_end();
            text.push('\n');
        }
        let layout = PrettyConfig::new().new_line("\n").depth_limit(2);
        text + HEAD + &notation::strict_lines(self, layout).unwrap_or_default() + "\n"
    }
}

/// Writes a number without `Some`.
fn bare<S: Serializer>(value: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
    value.unwrap_or_default().serialize(to)
}

/// Writes a value on one line.
fn on_one_line<T: Serialize, S: Serializer>(value: &T, to: S) -> Result<S::Ok, S::Error> {
    let layout = PrettyConfig::new().depth_limit(0);
    raw(
        notation::strict_lines(value, layout).unwrap_or_default(),
        to,
    )
}

/// Writes the fields of a flat struct that differ from their defaults, on one line.
fn changes<T: Serialize + Default, S: Serializer>(value: &T, to: S) -> Result<S::Ok, S::Error> {
    raw(
        format!("({})", differences(value, &T::default()).join(", ")),
        to,
    )
}

fn raw<S: Serializer>(text: String, to: S) -> Result<S::Ok, S::Error> {
    let text = RawValue::from_boxed_ron(text.into());
    text.map_err(S::Error::custom)?.serialize(to)
}

/// The fields of a flat struct that differ from those of another, as `name: value`.
fn differences<T: Serialize>(value: &T, other: &T) -> Vec<String> {
    // Pretty-printing puts each field on its own line.
    let pretty = || PrettyConfig::new().indentor("").new_line("\n");
    let lines = |value: &T| notation::strict_lines(value, pretty()).unwrap_or_default();
    let (ours, theirs) = (lines(value), lines(other));
    ours.lines()
        .zip(theirs.lines())
        .filter(|(ours, theirs)| ours != theirs)
        .map(|(ours, _)| ours.trim_end_matches(',').to_owned())
        .collect()
}

const FLOOR: &str = "floor";

fn slave(contact: &Contact) -> SlaveSpec {
    SlaveSpec {
        nodes: vec![contact.id.clone()],
        on: vec![FLOOR.to_owned()],
        start: contact.start,
        friction: Some(contact.friction.into()),
        state: contact.state,
        ..SlaveSpec::default()
    }
}

fn load(contact: &Contact) -> Option<LoadSpec> {
    let [n, t] = contact.load;
    (n != 0.0 || t != 0.0).then(|| LoadSpec::Force {
        node: contact.id.clone(),
        x: negative(t),
        y: n,
        scale: Vec::new(),
    })
}

/// Converts a matrix over (n, t) to one over (x, y) = (−t, n).
fn turned(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    rows.chunks(2)
        .flat_map(|pair| {
            let x = pair.get(1).map(|row| turned_row(row, -1.0));
            let y = pair.first().map(|row| turned_row(row, 1.0));
            x.into_iter().chain(y)
        })
        .collect()
}

/// The same for the entries of a matrix.
fn turned_entries(entries: &[(usize, usize, f64)]) -> Vec<(usize, usize, f64)> {
    let turn = |&(i, j, value): &(usize, usize, f64)| {
        // The normal component keeps its sign, the tangential one changes it.
        let value = if i % 2 == j % 2 {
            value
        } else {
            negative(value)
        };
        (i ^ 1, j ^ 1, value)
    };
    entries.iter().map(turn).collect()
}

/// A row over (n, t), times a sign, as a row over (x, y).
fn turned_row(row: &[f64], sign: f64) -> Vec<f64> {
    let times = |value: f64| if sign < 0.0 { negative(value) } else { value };
    row.chunks(2)
        .flat_map(|pair| {
            let x = pair.get(1).map(|&t| negative(times(t)));
            let y = pair.first().map(|&n| times(n));
            x.into_iter().chain(y)
        })
        .collect()
}

/// The other index of a pair, if the step is an index.
fn other_of_pair(step: &Step) -> Step {
    match step {
        Step::Index(k) => Step::Index(k ^ 1),
        key => key.clone(),
    }
}

/// −x, but 0 for 0.
fn negative(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { -x }
}
