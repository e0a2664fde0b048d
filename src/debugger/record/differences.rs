//! Compares two snapshots, node by node.
//!
//! Compared exactly: position, numbers of minor iterations and nodes, status, modes, rules, forced modes,
//! interventions, the limit of the residual, and the scalars of the scenes. Numbers may differ by 1e-9 of their
//! scale, because another processor may sum in another order. The scale is the force scale of the residual norms
//! for forces, the diagonal of the scene's bodies for lengths, and 1 for rotations and for residuals, which are
//! relative already; or the number itself, if that is larger. NaN equals NaN. Names of scenes are not compared.

use super::snapshot::{Displacement, Recorded, SlaveRecord, Snapshot};
use crate::explain::tested::Dimension::{self, Force, Length, Ratio};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt::{self, Debug};
use stickslip_core::linear::singular::LooseMotion;
use stickslip_core::{Failure, Norms, Rule, Singular, Status};
use stickslip_scene::format::paths;
use stickslip_scene::{Scene, joined, shortest, shown, sig2, sig4};

/// Largest relative difference of equal numbers.
pub const TOLERANCE: f64 = 1e-9;

/// One difference.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Name of the node. `None` if the difference concerns the whole state.
    pub node: Option<String>,
    /// What differs, such as `f_n`.
    pub field: String,
    /// Value on the left, as text.
    pub left: String,
    /// Value on the right, as text.
    pub right: String,
    /// For numbers: the difference and its limit.
    pub apart: Option<(f64, f64)>,
}

impl Difference {
    /// What differs, with the node: `beam.end f_n`.
    fn what(&self) -> String {
        match (&self.node, self.field.as_str()) {
            (None, field) => field.to_owned(),
            (Some(node), SLAVE | NODE) => format!("{} {node}", self.field),
            (Some(node), field) => format!("{node} {field}"),
        }
    }
}

/// Field of a slave node that only one side has.
const SLAVE: &str = "slave";
/// Field of a node that only one side has.
const NODE: &str = "node";

/// All differences; displayed as a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Differences {
    /// One row per difference.
    pub rows: Vec<Difference>,
    /// Largest relative difference of equal numbers.
    tolerance: f64,
    /// Scales of forces and lengths.
    scales: [f64; 2],
    /// Increments and load factors of both sides, if the increments differ.
    apart: Option<[(u32, f64); 2]>,
}

/// A value of one side.
enum FieldValue {
    /// Compared exactly.
    Text(Cow<'static, str>),
    /// Compared within the tolerance, if both sides have it.
    Number(Option<f64>, Dimension),
}

/// What is compared, and its value.
type Field = (Cow<'static, str>, FieldValue);

fn exact(field: &'static str, value: impl Debug) -> Field {
    text(field, word(value))
}

fn text(field: impl Into<Cow<'static, str>>, value: impl Into<Cow<'static, str>>) -> Field {
    (field.into(), FieldValue::Text(value.into()))
}

fn number(
    field: impl Into<Cow<'static, str>>,
    value: impl Into<Option<f64>>,
    of: Dimension,
) -> Field {
    (field.into(), FieldValue::Number(value.into(), of))
}

/// Compares two snapshots, node by node.
pub fn compare(a: &Snapshot, b: &Snapshot) -> Differences {
    compare_within(a, b, TOLERANCE)
}

/// The same with another tolerance of numbers.
pub fn compare_within(a: &Snapshot, b: &Snapshot, tolerance: f64) -> Differences {
    let mut found = Differences {
        rows: Vec::new(),
        tolerance,
        scales: [
            force(&a.state).max(force(&b.state)),
            length(a).max(length(b)),
        ],
        apart: (a.position.increment != b.position.increment)
            .then(|| [a, b].map(|one| (one.position.increment, one.state.load_factor))),
    };
    found.scenes(a, b);
    let (left, right) = (&a.state, &b.state);
    found.fields(None, run(a), run(b));
    found.fields(None, counts(left), counts(right));
    for (when, a, b) in [
        ("residual before", &left.before, &right.before),
        ("residual after", &left.after, &right.after),
    ] {
        found.fields(None, norms(when, a), norms(when, b));
    }
    found.named(SLAVE, &left.slaves, &right.slaves, |s| &s.node, slave);
    let [left, right] = [left, right].map(|state| &state.displacements);
    found.named(NODE, left, right, |d| &d.node, displacement);
    found.fields(None, shear(a), shear(b));
    found
}

fn run(snapshot: &Snapshot) -> Vec<Field> {
    let (at, state) = (snapshot.position, &snapshot.state);
    vec![
        exact("interventions", interventions(snapshot)),
        exact("minor iterations done", snapshot.steps),
        exact("increment", at.increment),
        exact("attempt", at.attempt),
        exact("major", at.major),
        exact("minor", at.minor),
        number("load factor", state.load_factor, Ratio),
        text("status", status(&state.status)),
    ]
}

/// Numbers of rows. Rows are compared by name, so that a repeated one would replace the one before.
fn counts(state: &Recorded) -> Vec<Field> {
    vec![
        exact("number of slave nodes", state.slaves.len()),
        exact("number of nodes", state.displacements.len()),
    ]
}

fn norms(when: &'static str, norms: &Option<Norms>) -> Vec<Field> {
    let numbers = norms.as_ref().map(|norms| {
        [
            ("force", norms.force, Force),
            ("relative", norms.relative, Ratio),
            ("interface", norms.interface, Ratio),
            ("correction", norms.correction, Ratio),
            ("force scale", norms.scale, Force),
        ]
    });
    let limit = norms
        .as_ref()
        .map(|norms| text(format!("{when}, limit"), sig2(norms.limit)));
    let numbers = numbers.into_iter().flatten();
    let numbers = numbers.map(|(what, value, of)| number(format!("{when}, {what}"), value, of));
    [text(when, norms.as_ref().map_or(ABSENT, |_| THERE))]
        .into_iter()
        .chain(numbers)
        .chain(limit)
        .collect()
}

fn slave(slave: &SlaveRecord) -> Vec<Field> {
    vec![
        text("mode", slave.mode.word()),
        text("next", slave.next.word()),
        text("rule", slave.rule.map_or(ABSENT, Rule::name)),
        exact("forced", slave.forced),
        number("gap", slave.gap, Length),
        number("f_n", slave.f_n, Force),
        number("f_t", slave.f_t, Force),
        number("t_max", slave.t_max, Force),
        number("slip", slave.slip, Length),
    ]
}

fn displacement(of: &Displacement) -> Vec<Field> {
    vec![
        number("x", of.x, Length),
        number("y", of.y, Length),
        number("rotation", of.rotation, Ratio),
    ]
}

fn shear(snapshot: &Snapshot) -> Vec<Field> {
    let forces = &snapshot.state.shear;
    let numbers = (1..).zip(forces);
    let numbers = numbers.map(|(k, value)| number(format!("shear force {k}"), *value, Force));
    [exact("number of shear forces", forces.len())]
        .into_iter()
        .chain(numbers)
        .collect()
}

impl Differences {
    /// A table of the rows that differ most, and the number of the others: first what is compared exactly, of the whole state and
    /// then of nodes, then numbers. A line before it says if the states are not of the same increment.
    pub fn largest(&self, most: usize) -> String {
        let mut rows: Vec<&Difference> = self.rows.iter().collect();
        rows.sort_by(|a, b| {
            let ratio = |row: &Difference| {
                row.apart
                    .map_or(f64::INFINITY, |(apart, most)| apart / most)
            };
            let order = ratio(b).total_cmp(&ratio(a));
            order.then(a.node.is_some().cmp(&b.node.is_some()))
        });
        let apart = self.apart.map(|[(left, at), (right, found)]| {
            format!(
                "the states are of increments {left} and {right} (load {} and {}): equal numbers of minor iterations end in \
                 different increments\n",
                shortest(at),
                shortest(found)
            )
        });
        let mut lines = table(rows);
        let more = self.rows.len().saturating_sub(most);
        lines.truncate(most + 1);
        lines.extend((more > 0).then(|| format!("and {more} more")));
        apart.unwrap_or_default() + &joined(lines, "\n") + "\n"
    }

    /// Whether there are no differences.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    fn scenes(&mut self, a: &Snapshot, b: &Snapshot) {
        if a.scene == b.scene {
            return;
        }
        let before = self.rows.len();
        let values = |s: &Snapshot| -> BTreeMap<String, String> {
            paths::list(&s.scene)
                .into_iter()
                .map(|l| (l.path, l.value))
                .collect()
        };
        let (left, right) = (values(a), values(b));
        for (path, pair) in paired(&left, &right) {
            let [left, right] = [pair.0, pair.1].map(|value| value.map_or(ABSENT, String::as_str));
            self.text(None, format!("scene {path}"), left, right);
        }
        if self.rows.len() == before {
            self.text(None, "scene", "original", "differs, but not in a scalar");
        }
    }

    /// Compares the items that both sides have under a name; one that only one side has is a difference.
    fn named<'a, T>(
        &mut self,
        kind: &str,
        a: &'a [T],
        b: &'a [T],
        name: fn(&T) -> &String,
        fields: fn(&T) -> Vec<Field>,
    ) {
        let by_name = |all: &'a [T]| -> BTreeMap<String, &'a T> {
            all.iter().map(|one| (name(one).clone(), one)).collect()
        };
        for (node, pair) in paired(&by_name(a), &by_name(b)) {
            match pair {
                (Some(left), Some(right)) => self.fields(Some(node), fields(left), fields(right)),
                (left, right) => {
                    let [left, right] = [left, right].map(|own| own.map_or(ABSENT, |_| THERE));
                    self.text(Some(node), kind, left, right);
                }
            }
        }
    }

    /// Compares the fields that both sides have.
    fn fields(&mut self, node: Option<&String>, left: Vec<Field>, right: Vec<Field>) {
        let [force, length] = self.scales;
        for ((field, left), (_, right)) in left.into_iter().zip(right) {
            match (left, right) {
                (FieldValue::Number(Some(left), of), FieldValue::Number(Some(right), _)) => {
                    self.number(node, field, (left, right), of.scale(force, length));
                }
                (left, right) => {
                    let [left, right] = [left, right].map(|value| match value {
                        FieldValue::Text(text) => text,
                        FieldValue::Number(value, _) => word(value).into(),
                    });
                    self.text(node, field, &left, &right);
                }
            }
        }
    }

    fn text<'a>(
        &mut self,
        node: Option<&String>,
        field: impl Into<Cow<'a, str>>,
        left: &str,
        right: &str,
    ) {
        if left != right {
            self.rows.push(Difference {
                node: node.cloned(),
                field: field.into().into_owned(),
                left: left.to_owned(),
                right: right.to_owned(),
                apart: None,
            });
        }
    }

    fn number(
        &mut self,
        node: Option<&String>,
        field: Cow<str>,
        (left, right): (f64, f64),
        scale: f64,
    ) {
        // Equality covers the infinities, whose difference is NaN.
        if left == right || (left.is_nan() && right.is_nan()) {
            return;
        }
        let allowed = self.tolerance * scale.max(left.abs()).max(right.abs());
        let apart = (left - right).abs();
        if apart <= allowed && apart.is_finite() {
            return;
        }
        self.rows.push(Difference {
            node: node.cloned(),
            field: field.into_owned(),
            left: format!("{left:?}"),
            right: format!("{right:?}"),
            apart: Some((apart, allowed)),
        });
    }
}

const ABSENT: &str = "-";
const THERE: &str = "there";

/// The name of a value: `Some(FixedSlides)` gives `FixedSlides`.
fn word(value: impl Debug) -> String {
    let text = format!("{value:?}");
    match text.strip_prefix("Some(").and_then(|t| t.strip_suffix(')')) {
        Some(inner) => inner.to_owned(),
        None if text == "None" => ABSENT.to_owned(),
        None => text,
    }
}

fn interventions(snapshot: &Snapshot) -> Vec<String> {
    snapshot
        .interventions
        .iter()
        .map(|a| format!("after {}: {:?}", a.step, a.intervention))
        .collect()
}

type Pairs<'a, T> = Vec<(&'a String, (Option<&'a T>, Option<&'a T>))>;

/// All items by name, from both sides.
fn paired<'a, T>(a: &'a BTreeMap<String, T>, b: &'a BTreeMap<String, T>) -> Pairs<'a, T> {
    let only_b = b.keys().filter(|key| !a.contains_key(*key));
    a.keys()
        .chain(only_b)
        .map(|key| (key, (a.get(key), b.get(key))))
        .collect()
}

fn force(state: &Recorded) -> f64 {
    state
        .before
        .iter()
        .chain(&state.after)
        .map(|n| n.scale)
        .fold(0.0, f64::max)
}

fn length(snapshot: &Snapshot) -> f64 {
    // An invalid scene has no size; its lengths are compared relative to themselves.
    Scene::from_spec(&snapshot.name, snapshot.scene.clone()).map_or(0.0, |s| s.model.length)
}

/// A status without its numbers, which may differ by round-off.
fn status(status: &Status) -> String {
    let Status::Failed(failure) = status else {
        return format!("{status:?}").to_lowercase();
    };
    let plain = match failure.clone() {
        Failure::MajorLimit { limit, .. } => Failure::MajorLimit {
            limit,
            relative: 0.0,
            interface: 0.0,
        },
        Failure::Diverged { .. } => return "diverged".into(),
        Failure::BranchJump { .. } => return "jumps".into(),
        Failure::RoundOff { .. } => return "round-off".into(),
        Failure::Inverted(point) => {
            return format!("element {} of body {} inverted", point.element, point.body);
        }
        Failure::OverConstrained { slave, .. } => Failure::OverConstrained { slave, gap: 0.0 },
        Failure::Singular(Singular::Rigid { motions }) => {
            let motion = |m: &LooseMotion| match m {
                LooseMotion::Translation(_) => "moves",
                LooseMotion::Rotation(_) => "turns",
            };
            let all = joined(
                motions
                    .iter()
                    .map(|m| format!("{} {}", m.body, motion(&m.motion))),
                ", ",
            );
            return format!("singular: {all}");
        }
        other => other,
    };
    format!("failed: {plain:?}")
}

impl fmt::Display for Differences {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for line in table(&self.rows) {
            writeln!(f, "{line}")?;
        }
        Ok(())
    }
}

/// Lines of a table of differences, with a head.
fn table<'a>(rows: impl IntoIterator<Item = &'a Difference>) -> Vec<String> {
    let apart = |row: &Difference| {
        row.apart
            .map(|(apart, allowed)| format!("{} > {}", sig4(apart), sig2(allowed)))
            .unwrap_or_default()
    };
    let mut lines = vec![["", "left", "right", "apart > allowed"].map(str::to_owned)];
    lines.extend(
        rows.into_iter()
            .map(|r| [r.what(), r.left.clone(), r.right.clone(), apart(r)]),
    );
    shown::aligned(&lines, lines[0].len())
}
