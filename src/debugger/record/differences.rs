//! Compares two snapshots, node by node.
//!
//! Compared exactly: position, number of minor iterations, status, modes, rules, forced modes, interventions,
//! and the scalars of the scenes. Numbers may differ by 1e-9 of their scale, because another processor may sum
//! in another order. The scale is the force scale of the residual norms for forces, the diagonal of the scene's
//! bodies for lengths, and 1 for rotations and for residuals, which are relative already; or the number itself,
//! if that is larger. NaN equals NaN. Names of scenes are not compared.

use super::snapshot::{Displacement, Recorded, SlaveRecord, Snapshot};
use crate::explain::names;
use std::collections::BTreeMap;
use std::fmt::{self, Debug};
use stickslip_core::linear::singular::LooseMotion;
use stickslip_core::{Failure, Norms, Rule, Singular, Status};
use stickslip_scene::format::paths;
use stickslip_scene::{Scene, joined, shown, sig2, sig4};

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
}

/// What is compared: a field of the whole state, or of a node.
#[derive(Clone, Copy)]
struct Item<'a> {
    node: Option<&'a str>,
    field: &'a str,
}

impl<'a> From<&'a str> for Item<'a> {
    fn from(field: &'a str) -> Item<'a> {
        Item { node: None, field }
    }
}

impl<'a> From<(&'a str, &'a str)> for Item<'a> {
    fn from((node, field): (&'a str, &'a str)) -> Item<'a> {
        let node = Some(node);
        Item { node, field }
    }
}

/// Scales of forces and lengths.
struct Scales {
    force: f64,
    length: f64,
}

/// Compares two snapshots, node by node.
pub fn compare(a: &Snapshot, b: &Snapshot) -> Differences {
    compare_within(a, b, TOLERANCE)
}

/// The same with another tolerance of numbers.
pub fn compare_within(a: &Snapshot, b: &Snapshot, tolerance: f64) -> Differences {
    Differences::between(a, b, tolerance)
}

impl Differences {
    /// All differences.
    fn between(a: &Snapshot, b: &Snapshot, tolerance: f64) -> Differences {
        let mut found = Differences {
            rows: Vec::new(),
            tolerance,
        };
        found.scenes(a, b);
        found.exact("interventions", &interventions(a), &interventions(b));
        found.exact("minor iterations done", &a.steps, &b.steps);
        for (what, left, right) in [
            ("increment", a.position.increment, b.position.increment),
            ("attempt", a.position.attempt, b.position.attempt),
            ("major", a.position.major, b.position.major),
            ("minor", a.position.minor, b.position.minor),
        ] {
            found.exact(what, &left, &right);
        }
        let scales = Scales {
            force: force(&a.state).max(force(&b.state)),
            length: length(a).max(length(b)),
        };
        found.states(&a.state, &b.state, &scales);
        found
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
            let text = |value: Option<&String>| value.map_or(ABSENT.to_owned(), Clone::clone);
            self.exact_text(format!("scene {path}").as_str(), text(pair.0), text(pair.1));
        }
        if self.rows.len() == before {
            self.exact_text(
                "scene",
                "original".into(),
                "differs, but not in a scalar".into(),
            );
        }
    }

    fn states(&mut self, a: &Recorded, b: &Recorded, scales: &Scales) {
        self.number("load factor", a.load_factor, b.load_factor, 1.0);
        self.exact_text("status", status(&a.status), status(&b.status));
        self.norms("before", a.before.as_ref(), b.before.as_ref(), scales);
        self.norms("after", a.after.as_ref(), b.after.as_ref(), scales);
        self.named(
            SLAVE,
            &a.slaves,
            &b.slaves,
            |s| &s.node,
            |all, a, b| {
                all.slave(a, b, scales);
            },
        );
        self.named(
            NODE,
            &a.displacements,
            &b.displacements,
            |d| &d.node,
            |all, a, b| {
                all.displacement(a, b, scales);
            },
        );
        self.exact("number of shear forces", &a.shear.len(), &b.shear.len());
        for (k, (left, right)) in a.shear.iter().zip(&b.shear).enumerate() {
            self.number(
                format!("shear force {}", k + 1).as_str(),
                *left,
                *right,
                scales.force,
            );
        }
    }

    fn slave(&mut self, a: &SlaveRecord, b: &SlaveRecord, scales: &Scales) {
        let name = a.node.as_str();
        let rule = |s: &SlaveRecord| s.rule.map_or(ABSENT, Rule::name).to_owned();
        for (what, left, right) in [
            ("mode", names::mode(a.mode), names::mode(b.mode)),
            ("next", names::mode(a.next), names::mode(b.next)),
        ] {
            self.exact_text((name, what), left.into(), right.into());
        }
        self.exact_text((name, "rule"), rule(a), rule(b));
        self.exact((name, "forced"), &a.forced, &b.forced);
        match (a.gap, b.gap) {
            (Some(left), Some(right)) => {
                self.number((name, "gap"), left, right, scales.length);
            }
            (left, right) => self.exact((name, "gap"), &left, &right),
        }
        for (what, left, right, scale) in [
            ("f_n", a.f_n, b.f_n, scales.force),
            ("f_t", a.f_t, b.f_t, scales.force),
            ("t_max", a.t_max, b.t_max, scales.force),
            ("slip", a.slip, b.slip, scales.length),
        ] {
            self.number((name, what), left, right, scale);
        }
    }

    fn displacement(&mut self, a: &Displacement, b: &Displacement, scales: &Scales) {
        let name = a.node.as_str();
        self.number((name, "x"), a.x, b.x, scales.length);
        self.number((name, "y"), a.y, b.y, scales.length);
        match (a.rotation, b.rotation) {
            (Some(left), Some(right)) => {
                self.number((name, "rotation"), left, right, 1.0);
            }
            (left, right) => self.exact((name, "rotation"), &left, &right),
        }
    }

    fn norms(&mut self, when: &str, a: Option<&Norms>, b: Option<&Norms>, scales: &Scales) {
        let (Some(a), Some(b)) = (a, b) else {
            self.exact(
                format!("residual {when}").as_str(),
                &a.is_some(),
                &b.is_some(),
            );
            return;
        };
        for (what, left, right, scale) in [
            ("force", a.force, b.force, scales.force),
            ("relative", a.relative, b.relative, 1.0),
            ("interface", a.interface, b.interface, 1.0),
            ("correction", a.correction, b.correction, 1.0),
        ] {
            self.number(
                format!("residual {when}, {what}").as_str(),
                left,
                right,
                scale,
            );
        }
    }

    /// Compares the items that both sides have under a name; one that only one side has is a difference.
    fn named<'a, T>(
        &mut self,
        field: &str,
        a: &'a [T],
        b: &'a [T],
        name: fn(&T) -> &String,
        compare: impl Fn(&mut Self, &T, &T),
    ) {
        let by_name = |all: &'a [T]| -> BTreeMap<String, &'a T> {
            all.iter().map(|one| (name(one).clone(), one)).collect()
        };
        for (node, pair) in paired(&by_name(a), &by_name(b)) {
            match pair {
                (Some(left), Some(right)) => compare(self, left, right),
                (left, right) => {
                    let text = |there: bool| if there { "there" } else { ABSENT }.to_owned();
                    let (left, right) = (text(left.is_some()), text(right.is_some()));
                    self.exact_text((node.as_str(), field), left, right);
                }
            }
        }
    }

    fn exact<'a, T: PartialEq + Debug>(&mut self, item: impl Into<Item<'a>>, left: &T, right: &T) {
        if left != right {
            self.exact_text(item, word(left), word(right));
        }
    }

    fn exact_text<'a>(&mut self, item: impl Into<Item<'a>>, left: String, right: String) {
        if left != right {
            self.add(item.into(), left, right, None);
        }
    }

    fn add(&mut self, item: Item, left: String, right: String, apart: Option<(f64, f64)>) {
        self.rows.push(Difference {
            node: item.node.map(str::to_owned),
            field: item.field.to_owned(),
            left,
            right,
            apart,
        });
    }

    fn number<'a>(&mut self, item: impl Into<Item<'a>>, left: f64, right: f64, scale: f64) {
        // Equality covers the infinities, whose difference is NaN.
        if left == right || (left.is_nan() && right.is_nan()) {
            return;
        }
        let allowed = self.tolerance * scale.max(left.abs()).max(right.abs());
        let apart = (left - right).abs();
        if apart <= allowed && apart.is_finite() {
            return;
        }
        let (left, right) = (format!("{left:?}"), format!("{right:?}"));
        self.add(item.into(), left, right, Some((apart, allowed)));
    }
}

const ABSENT: &str = "-";

/// The name of a value: `Some(FixedSlides)` gives `FixedSlides`.
fn word<T: Debug>(value: &T) -> String {
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
        let apart = |row: &Difference| {
            row.apart
                .map(|(apart, allowed)| format!("{} > {}", sig4(apart), sig2(allowed)))
                .unwrap_or_default()
        };
        let mut lines = vec![["", "left", "right", "apart > allowed"].map(str::to_owned)];
        lines.extend(
            self.rows
                .iter()
                .map(|r| [r.what(), r.left.clone(), r.right.clone(), apart(r)]),
        );
        for line in shown::aligned(&lines, lines[0].len()) {
            writeln!(f, "{line}")?;
        }
        Ok(())
    }
}
