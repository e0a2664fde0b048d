//! Addresses every scalar of a scene by a path that a user can type: `friction.angle`, `nodes.beam.elements`.
//!
//! Paths use ids where they exist, otherwise positions; the parts of a point are `x` and `y`. Listing and setting use the same
//! walk over the scene, so they always agree.

use super::described::{Described, ScalarPlace, Visit};
use super::error::{Path, SetError, nearest, quoted};
use super::spec::Spec;
use crate::few;

/// A value set from outside.
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    /// The path as typed.
    pub path: String,
    /// The value as typed.
    pub value: String,
    /// Path of the value in the scene.
    pub(crate) at: Path,
}

/// A scalar of a scene with its value and accepted values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListedScalar {
    /// Path as a user types it.
    pub path: String,
    /// Value as a user types it.
    pub value: String,
    /// Accepted values: "a number", "one of lagged, consistent".
    pub kind: String,
    /// The allowed words; empty for other kinds.
    pub words: &'static [&'static str],
}

/// All scalars of a scene, in file order.
pub fn list(spec: &Spec) -> Vec<ListedScalar> {
    let mut all = Vec::new();
    // The walk also serves setting, so it needs a mutable scene.
    walk(&mut spec.clone(), &mut |place, scalar| {
        all.push(ListedScalar {
            path: place.name(),
            value: scalar.value(),
            kind: scalar.kind(),
            words: scalar.words(),
        });
    });
    all
}

/// All settings, which every scene has.
pub fn of_settings() -> impl Iterator<Item = ListedScalar> {
    let all = list(&Spec::default()).into_iter();
    all.filter(|listed| listed.path.starts_with("settings."))
}

/// The path that replaces one of earlier revisions, which journals may contain; otherwise the path itself.
fn current(path: &str) -> &str {
    match path {
        "settings.search_limit" => "settings.search",
        _ => path,
    }
}

/// Sets one scalar. Compiling the scene shows whether it is still valid.
///
/// # Errors
/// If the path does not exist, or the value has the wrong kind.
pub fn set(spec: &mut Spec, path: &str, value: &str) -> Result<Override, SetError> {
    let path = current(path.trim());
    let mut done = None;
    walk(spec, &mut |place, scalar| {
        if done.is_none() && place.is(path) {
            done = Some(scalar.set(value.trim()).map(|()| place.at()));
        }
    });
    match done {
        Some(result) => Ok(Override {
            path: path.to_owned(),
            value: value.trim().to_owned(),
            at: result?,
        }),
        None => Err(SetError::NoScalar(unknown(spec, path))),
    }
}

/// Path in the scene of a scalar; `None` if it does not exist.
pub(crate) fn find(spec: &Spec, path: &str) -> Option<Path> {
    let path = current(path.trim());
    let mut found = None;
    // The walk also serves setting, so it needs a mutable scene.
    walk(&mut spec.clone(), &mut |place, _| {
        if found.is_none() && place.is(path) {
            found = Some(place.at());
        }
    });
    found
}

/// Completes a path without its first or last step if that can be omitted: `increment` for `history.increment`, `t_max` for
/// `settings.t_max`, `friction` for `friction.angle`. Other paths are returned unchanged.
pub fn whole(spec: &Spec, path: &str) -> String {
    let path = path.trim();
    let mut wholes = [
        path.to_owned(),
        format!("history.{path}"),
        format!("settings.{path}"),
        format!("{path}.angle"),
    ];
    // The walk also serves setting, so it needs a mutable scene.
    let mut spec = spec.clone();
    let mut first = None;
    walk(&mut spec, &mut |place, _| {
        let before = first.unwrap_or(wholes.len());
        first = (0..before).find(|&k| place.is(&wholes[k])).or(first);
    });
    std::mem::take(&mut wholes[first.unwrap_or(0)])
}

fn unknown(spec: &Spec, path: &str) -> String {
    let all = list(spec);
    let names = || all.iter().map(|listed| listed.path.as_str());
    let within = |head: &str| {
        let is_within = |rest: &str| rest.starts_with(['.', '[']);
        let within = names().filter(|name| name.strip_prefix(head).is_some_and(is_within));
        few(within, 8)
    };
    let inside = within(path);
    if !inside.is_empty() {
        return format!("{} is not a single value; it has {inside}", quoted(path));
    }
    if let Some(near) = nearest(path, names()) {
        return format!(
            "the scene has no value {}; did you mean {near}?",
            quoted(path)
        );
    }
    // Not close to any path: show how the longest existing prefix continues.
    let mut head = path;
    while let Some(cut) = head.rfind(['.', '[']) {
        head = &head[..cut];
        let siblings = within(head);
        if !siblings.is_empty() {
            return format!(
                "the scene has no value {}; {head} has {siblings}",
                quoted(path)
            );
        }
    }
    format!(
        "the scene has no value {}; `check --paths` lists them all",
        quoted(path)
    )
}

/// Visits every scalar in file order. Omitted fields of slave groups and of the history whose default depends on other values are
/// visited with that default, and stay omitted unless set to a different value. Setting `history.increment` scales the increments
/// of all legs.
fn walk(spec: &mut Spec, visit: &mut Visit<'_>) {
    let friction = spec.friction;
    let least = spec.history.least();
    let own: Vec<bool> = spec
        .slaves
        .iter()
        .map(|group| group.friction.is_some())
        .collect();
    let own_least = spec.history.least.is_some();
    for group in &mut spec.slaves {
        group.friction.get_or_insert(friction);
    }
    spec.history.least.get_or_insert(least);
    let increment = spec.history.increment;
    spec.walk(&ScalarPlace::root(), visit);
    for (group, own) in spec.slaves.iter_mut().zip(own) {
        if !own && group.friction == Some(friction) {
            group.friction = None;
        }
    }
    if spec.history.increment != increment {
        let part = spec.history.increment / increment;
        spec.history
            .increments
            .iter_mut()
            .for_each(|size| *size *= part);
    }
    if !own_least && spec.history.least == Some(least) {
        spec.history.least = None;
    }
}
