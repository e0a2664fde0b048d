//! Compares two snapshots, node by node.
//!
//! Compared exactly: position, numbers of minor iterations and nodes, status, modes, rules, forced modes,
//! interventions in words, the limit of the residual, and the scalars of the scenes. Numbers may differ by 1e-9 of their
//! scale, because another processor may sum in another order. The scale is the force scale of the residual norms
//! for forces, the diagonal of the scene's bodies for lengths, and 1 for rotations and for residuals, which are
//! relative already; or the number itself, if that is larger. NaN equals NaN. Not compared: names of scenes, the
//! numbers in a status, and the noise of residuals.

use super::snapshot::{Recorded, Snapshot};
use crate::explain::report;
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
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
    if a.scene != b.scene {
        let [left, right] = [a, b].map(scalars);
        found.objects(None, "", &left, &right);
        if found.is_empty() {
            let other = "differs, but not in a scalar".into();
            found.exact(None, "scene", &"original".into(), &other);
        }
    }
    let [left, right] = [a, b].map(tree);
    found.values(None, "", "", &left, &right);
    found.rows.sort_by_key(|row| row.node.is_some());
    found
}

/// What is compared of a snapshot, except its scene.
fn tree(snapshot: &Snapshot) -> Value {
    let state = &snapshot.state;
    let scene = compiled(snapshot);
    let interventions = snapshot.interventions.iter().map(|applied| {
        let words = scene.as_ref().map_or_else(
            || format!("{:?}", applied.intervention),
            |scene| report::intervention(&scene.model, &applied.intervention),
        );
        format!("after minor iteration {}: {words}", applied.step)
    });
    // JSON makes them null.
    let text = format!("{state:?}");
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '-');
    let not_finite = words.filter(|word| ["NaN", "inf", "-inf"].contains(word));
    json!({
        "interventions": interventions.collect::<Vec<_>>(),
        "steps": snapshot.steps,
        "position": snapshot.position,
        "state": state,
        "numbers that are not finite": joined(not_finite, " "),
    })
}

/// The scalars of a scene.
fn scalars(snapshot: &Snapshot) -> Map<String, Value> {
    let all = paths::list(&snapshot.scene).into_iter();
    all.map(|l| (format!("scene {}", l.path), l.value.into()))
        .collect()
}

/// The name of a field; of a list, that of an entry.
fn name(key: &str) -> &str {
    match key {
        "steps" => "minor iterations done",
        "load_factor" => "load factor",
        "before" => "residual before",
        "after" => "residual after",
        "scale" => "force scale",
        "interventions" => "intervention",
        "slaves" => "slave node",
        "displacements" => "node",
        "shear" => "shear force",
        _ => key,
    }
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

    fn objects(
        &mut self,
        node: Option<&str>,
        within: &str,
        a: &Map<String, Value>,
        b: &Map<String, Value>,
    ) {
        for key in a.keys().chain(b.keys()).collect::<BTreeSet<_>>() {
            let [left, right] = [a, b].map(|all| all.get(key).unwrap_or(&Value::Null));
            self.values(node, key, &format!("{within}{}", name(key)), left, right);
        }
    }

    /// Compares entries of nodes by name, others by index.
    fn lists(&mut self, key: &str, field: &str, a: &[Value], b: &[Value]) {
        // Of entries with the same name, only the last is compared.
        let count = format!("number of {field}s");
        self.exact(None, &count, &a.len().into(), &b.len().into());
        let [a, b] = [a, b].map(|list| -> BTreeMap<_, _> {
            let entries = (1..).zip(list).map(|(k, entry)| {
                let node = entry["node"].as_str();
                ((node, node.map_or(k, |_| 0)), entry)
            });
            entries.collect()
        });
        for at in a.keys().chain(b.keys()).collect::<BTreeSet<_>>() {
            match (*at, [&a, &b].map(|all| all.get(at).copied())) {
                ((node, _), [Some(Value::Object(a)), Some(Value::Object(b))]) => {
                    self.objects(node, "", a, b);
                }
                ((None, k), [Some(a), Some(b)]) => {
                    self.values(None, key, &format!("{field} {k}"), a, b);
                }
                ((node, _), both) => {
                    let [a, b] = both.map(|one| one.unwrap_or(&Value::Null));
                    self.exact(node, field, a, b);
                }
            }
        }
    }

    fn values(&mut self, node: Option<&str>, key: &str, field: &str, a: &Value, b: &Value) {
        let numbers = [a, b].map(|value| value.as_f64().filter(|_| value.is_f64()));
        match (key, numbers, a, b) {
            ("noise", ..) => {}
            ("status", ..) => self.exact(node, field, &without_numbers(a), &without_numbers(b)),
            ("limit", [Some(a), Some(b)], ..) => {
                self.exact(node, field, &sig2(a).into(), &sig2(b).into());
            }
            (_, [Some(a), Some(b)], ..) => {
                let [force, length] = self.scales;
                let scale = match key {
                    "force" | "scale" | "f_n" | "f_t" | "t_max" | "shear" => force,
                    "gap" | "slip" | "x" | "y" => length,
                    _ => 1.0,
                };
                let allowed = self.tolerance * scale.max(a.abs()).max(b.abs());
                let apart = (a - b).abs();
                if apart > allowed {
                    let both = [a, b].map(|number| format!("{number:?}"));
                    self.row(node, field, both, Some((apart, allowed)));
                }
            }
            ("" | "position" | "state", _, Value::Object(a), Value::Object(b)) => {
                self.objects(node, "", a, b);
            }
            (_, _, Value::Object(a), Value::Object(b)) => {
                self.objects(node, &format!("{field}, "), a, b);
            }
            (_, _, Value::Array(a), Value::Array(b)) => self.lists(key, field, a, b),
            _ => self.exact(node, field, a, b),
        }
    }

    fn exact(&mut self, node: Option<&str>, field: &str, left: &Value, right: &Value) {
        if left != right {
            let both = [left, right].map(|value| match value {
                Value::Null => "-".to_owned(),
                Value::Object(_) if left.is_null() || right.is_null() => "there".to_owned(),
                Value::String(text) => text.clone(),
                other => other.to_string(),
            });
            self.row(node, field, both, None);
        }
    }

    fn row(
        &mut self,
        node: Option<&str>,
        field: &str,
        [left, right]: [String; 2],
        apart: Option<(f64, f64)>,
    ) {
        self.rows.push(Difference {
            node: node.map(str::to_owned),
            field: field.to_owned(),
            left,
            right,
            apart,
        });
    }
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
    compiled(snapshot).map_or(0.0, |scene| scene.model.length)
}

fn compiled(snapshot: &Snapshot) -> Option<Scene> {
    Scene::from_spec(&snapshot.name, snapshot.scene.clone()).ok()
}

/// A status without its numbers, which may differ by round-off.
fn without_numbers(status: &Value) -> Value {
    match status {
        Value::Array(all) => all.iter().map(without_numbers).collect(),
        Value::Object(all) => {
            let all = all.iter();
            all.map(|(key, value)| (key.clone(), without_numbers(value)))
                .collect()
        }
        Value::Number(number) if number.is_f64() => Value::Null,
        other => other.clone(),
    }
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
    let what = |row: &Difference| joined(row.node.iter().chain([&row.field]), " ");
    let mut lines = vec![["", "left", "right", "apart > allowed"].map(str::to_owned)];
    lines.extend(
        rows.into_iter()
            .map(|r| [what(r), r.left.clone(), r.right.clone(), apart(r)]),
    );
    shown::aligned(&lines, lines[0].len())
}
