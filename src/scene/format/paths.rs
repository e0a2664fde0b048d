//! Every scalar of a scene by a path that a person can type: `friction.angle`, `nodes.beam.elements`.
//!
//! Paths name things by their ids where they have any, and by their position where not; a point's parts are `x` and
//! `y`. One walk over the scene serves listing and setting, so that neither can know more than the other.

use super::described::{Described, ScalarPlace, Visit};
use super::error::{NotSet, Path, nearest, quoted};
use super::spec::Spec;
use stickslip_core::model::Settings;

/// A value set from outside.
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    /// The path as it was typed.
    pub path: String,
    /// The value as it was typed.
    pub value: String,
    /// Where the value stands in the scene.
    pub(crate) at: Path,
}

/// A scalar of a scene, its value, and what it may be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// Its path, as a person types it.
    pub path: String,
    /// Its value, as a person types it.
    pub value: String,
    /// What can be set: "a number", "one of lagged, consistent".
    pub kind: String,
    /// The words that it can be; none where it is no word.
    pub words: &'static [&'static str],
}

/// All scalars of a scene, in the order of the file.
pub fn list(spec: &Spec) -> Vec<Listed> {
    let mut all = Vec::new();
    // The walk is for setting too and needs a scene that it may change.
    walk(&mut spec.clone(), &mut |place, scalar| {
        all.push(Listed {
            path: place.name(),
            value: scalar.value(),
            kind: scalar.kind(),
            words: scalar.words(),
        });
    });
    all
}

/// The settings by their paths, and the words that each can be; no words for a number.
pub fn of_settings() -> Vec<(String, &'static [&'static str])> {
    let mut all = Vec::new();
    let root = ScalarPlace::root();
    let place = root.field("settings");
    Settings::default().walk(&place, &mut |place, scalar| {
        all.push((place.name(), scalar.words()));
    });
    all
}

/// Sets one scalar. Whether the scene is sound with it shows when it is compiled.
///
/// # Errors
/// If there is no such path, or the value is not of its kind.
pub fn set(spec: &mut Spec, path: &str, value: &str) -> Result<Override, NotSet> {
    let path = path.trim();
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
        None => Err(NotSet::NoScalar(unknown(spec, path))),
    }
}

/// Where a scalar of a scene stands, found once for many settings of it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Found {
    /// Its number in the walk, which no setting changes: what is listed hangs on nothing that can be set.
    number: usize,
    /// Where it stands in the scene.
    pub(crate) at: Path,
}

/// Finds a scalar; `None` if there is none of that path.
pub(crate) fn find(spec: &Spec, path: &str) -> Option<Found> {
    let path = path.trim();
    let (mut number, mut found) = (0, None);
    // The walk is for setting too and needs a scene that it may change.
    walk(&mut spec.clone(), &mut |place, _| {
        if found.is_none() && place.is(path) {
            let at = place.at();
            found = Some(Found { number, at });
        }
        number += 1;
    });
    found
}

impl Found {
    /// Sets the scalar, in the scene where it was found or one that differs from that in scalars only; `None` if the
    /// value is not of its kind.
    pub(crate) fn set(&self, spec: &mut Spec, value: &str) -> Option<()> {
        let (mut number, mut done) = (0, None);
        walk(spec, &mut |_, scalar| {
            if number == self.number {
                done = scalar.set(value.trim()).ok();
            }
            number += 1;
        });
        done
    }
}

/// The whole path for one without its first or last step, where a person may leave it out: `increment` for
/// `history.increment`, `t_max` for `settings.t_max`, `friction` for `friction.angle`. What is none of these stays.
pub fn whole(spec: &Spec, path: &str) -> String {
    let path = path.trim();
    let mut wholes = [
        path.to_owned(),
        format!("history.{path}"),
        format!("settings.{path}"),
        format!("{path}.angle"),
    ];
    // The walk is for setting too and needs a scene that it may change.
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
    let inside: Vec<&str> = names()
        .filter(|name| {
            !path.is_empty()
                && name
                    .strip_prefix(path)
                    .is_some_and(|r| r.starts_with(['.', '[']))
        })
        .collect();
    if !inside.is_empty() {
        return format!(
            "{} is no single value; it has {}",
            quoted(path),
            first_of(&inside)
        );
    }
    if let Some(near) = nearest(path, names()) {
        return format!(
            "the scene has no value {}; did you mean {near}?",
            quoted(path)
        );
    }
    // Not near to any: what the longest beginning that does exist goes on with.
    let mut head = path;
    while let Some(cut) = head.rfind(['.', '[']) {
        head = &head[..cut];
        let siblings: Vec<&str> = names()
            .filter(|n| {
                n.strip_prefix(head)
                    .is_some_and(|r| r.starts_with(['.', '[']))
            })
            .collect();
        if !siblings.is_empty() {
            return format!(
                "the scene has no value {}; {head} has {}",
                quoted(path),
                first_of(&siblings)
            );
        }
    }
    format!(
        "the scene has no value {}; `check --paths` lists them all",
        quoted(path)
    )
}

fn first_of(names: &[&str]) -> String {
    const MOST: usize = 8;
    let more = if names.len() > MOST { ", …" } else { "" };
    names
        .iter()
        .take(MOST)
        .copied()
        .collect::<Vec<_>>()
        .join(", ")
        + more
}

/// Visits every scalar, in the order of the file. What a group of slaves or the history leaves to a default that hangs on
/// other values is shown as that default, and stays left out unless it is set to something else. Where `history.increment` is set,
/// the increments of each leg change in proportion.
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
        let sizes = spec.history.increments.iter_mut();
        sizes.for_each(|size| *size *= part);
    }
    if !own_least && spec.history.least == Some(least) {
        spec.history.least = None;
    }
}
