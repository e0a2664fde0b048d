//! The context in which arguments of actions are read, and the lookup of slave nodes by name.

use super::keymap::Keymap;
use super::table::{ActionEntry, begun, by_name};
use crate::refusal::{Refusal, refusal};
use crate::{Frame, Tree};
use stickslip_core::interface::census::MOST;
use stickslip_core::{Capabilities, Model, State};
use stickslip_scene::{EmbeddedFile, Scene, few};

/// What the arguments of actions can refer to.
#[derive(Debug, Clone, Copy, Default)]
pub struct Context<'a> {
    /// The model of the open scene.
    pub model: Option<&'a Model>,
    /// The scene, which has more names for nodes than the model (`beam.end` for `beam.5`).
    pub scene: Option<&'a Scene>,
    /// The history, for names of branches.
    pub tree: Option<&'a Tree>,
    /// The selected slave node, by slave number.
    pub selected: usize,
    /// Names of the built-in scenes.
    pub scenes: &'a [String],
    /// The built-in lessons.
    pub lessons: &'a [EmbeddedFile],
    /// Capabilities of an attached solver; `None` for our own.
    pub offers: Option<&'a Capabilities>,
    /// The shown state.
    pub state: Option<&'a State>,
    /// The point after the shown one on its line.
    pub next: Option<&'a Frame>,
    /// The current keys; `None` for the defaults.
    pub keymap: Option<&'a Keymap>,
}

impl Context<'_> {
    /// Finds an entry by name, one-letter key, or unique prefix.
    pub fn entry(&self, word: &str) -> Result<&'static ActionEntry, Refusal> {
        let key = (word.chars().count() == 1).then_some(word);
        match (self.keymap, key) {
            (Some(keymap), Some(key)) => match keymap.by_key(key) {
                Some(entry) => Ok(entry),
                None => begun(word),
            },
            _ => by_name(word),
        }
    }
}

/// The named slave node, or the selected one without a name.
pub(super) fn chosen(word: Option<&str>, context: &Context) -> Result<usize, Refusal> {
    match word {
        Some(word) => exact(word, context),
        None if context.selected < model(context)?.contacts.len() => Ok(context.selected),
        None => Err(refusal!("this scene has no slave nodes")),
    }
}

/// The model of the open scene.
pub(super) fn model<'a>(context: &Context<'a>) -> Result<&'a Model, Refusal> {
    context.model.ok_or_else(|| refusal!("open a scene first"))
}

/// The slave node with exactly this name. No guessing, because the action changes the solve.
pub fn exact(word: &str, context: &Context) -> Result<usize, Refusal> {
    let model = model(context)?;
    let alias = context.scene.and_then(|scene| scene.node(word).ok());
    let node = model
        .nodes
        .iter()
        .position(|node| node.name == word)
        .or(alias)
        .or_else(|| respelled(word, model));
    if let Some(slave) = model
        .contacts
        .iter()
        .position(|slave| Some(slave.node) == node)
    {
        return Ok(slave);
    }
    let slaves = some_names(model);
    Err(if node.is_some() {
        refusal!("{word} is not a slave node; slave nodes: {slaves}")
    } else {
        refusal!("unknown node '{word}'; slave nodes: {slaves}")
    })
}

/// The only node whose name equals a word except for dots and dashes: earlier versions wrote node.1 as node-1
/// in places.
fn respelled(word: &str, model: &Model) -> Option<usize> {
    let plain = |name: &str| name.replace('-', ".");
    let mut called = model
        .nodes
        .iter()
        .enumerate()
        .filter(|(_, node)| plain(&node.name) == plain(word));
    called
        .next()
        .filter(|_| called.next().is_none())
        .map(|(node, _)| node)
}

/// Slave nodes separated by spaces or commas, in ascending order without duplicates: by name or, if no node has
/// that name, by index in the scene's list, from 1.
pub(super) fn several(words: &[&str], context: &Context) -> Result<Vec<usize>, Refusal> {
    let words = words.iter().flat_map(|word| word.split(','));
    let mut nodes = Vec::new();
    for word in words.filter(|word| !word.is_empty()) {
        let counted = word.parse::<usize>().ok().and_then(|n| n.checked_sub(1));
        let count = model(context)?.contacts.len();
        let slave = match (exact(word, context), counted) {
            (Ok(slave), _) => slave,
            (Err(_), Some(place)) if place < count => place,
            (Err(why), _) => return Err(why),
        };
        if !nodes.contains(&slave) {
            nodes.push(slave);
        }
    }
    nodes.sort_unstable();
    match nodes.len() {
        0..=MOST => Ok(nodes),
        n => Err(refusal!(
            "too many nodes for a census: {n}; the limit is {MOST}"
        )),
    }
}

/// The next slave node after the selected one whose name equals or else contains the word.
pub(super) fn find(word: &str, context: &Context) -> Result<usize, Refusal> {
    if let Ok(slave) = exact(word, context) {
        return Ok(slave);
    }
    let model = model(context)?;
    let count = model.contacts.len();
    (1..=count)
        .map(|step| (context.selected + step) % count)
        .find(|slave| model.nodes[model.contacts[*slave].node].name.contains(word))
        .ok_or_else(|| {
            refusal!(
                "no slave node name contains '{word}'; slave nodes: {}",
                some_names(model)
            )
        })
}

/// Names of the slave nodes, by slave number.
pub(super) fn names(model: &Model) -> impl Iterator<Item = &str> {
    model
        .contacts
        .iter()
        .map(|slave| model.nodes[slave.node].name.as_str())
}

/// The first few names of slave nodes, for messages.
fn some_names(model: &Model) -> String {
    few(names(model), 4)
}

pub(super) fn any_or_exact(
    word: Option<&&str>,
    context: &Context,
) -> Result<Option<usize>, Refusal> {
    match word {
        None | Some(&"any") => Ok(None),
        Some(word) => exact(word, context).map(Some),
    }
}
