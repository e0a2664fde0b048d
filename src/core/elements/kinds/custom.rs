//! Kinds of elements from other packages.

use super::continuum_kind::Outline;
use crate::elements::lagrange::MAX_NODES;
use std::any::Any;
use std::collections::BTreeMap;
use std::hash::{Hash, Hasher};
use std::sync::{PoisonError, RwLock};

/// A kind from another package, identified by its name.
#[derive(Debug)]
pub struct CustomKind {
    pub(super) name: &'static str,
    pub(super) outline: Outline,
    /// What [`crate::fem`] computes of it.
    pub(crate) formulation: Box<dyn Any + Send + Sync>,
}

/// Why a kind cannot be registered.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum KindError {
    /// Another kind has this name.
    #[error("there is already a kind of element called {0:?}")]
    Taken(&'static str),
    /// Faces that are not those of a triangle or a quadrilateral.
    #[error(
        "{name:?}: an element of {nodes} nodes cannot have the faces {faces:?}; it needs 3 or 4 of 2 to {MAX_NODES} nodes, from \
         corner k to the next one, with the nodes between corners in order after all corners"
    )]
    Faces {
        /// Name of the kind.
        name: &'static str,
        /// Number of nodes of an element.
        nodes: usize,
        /// Local node indices of the faces.
        faces: &'static [&'static [usize]],
    },
}

static REGISTERED: RwLock<BTreeMap<&str, &CustomKind>> = RwLock::new(BTreeMap::new());

impl CustomKind {
    /// Adds a kind whose name is none of `taken`.
    pub(super) fn register(self, taken: &[&str]) -> Result<&'static CustomKind, KindError> {
        let (name, Outline { nodes, faces, .. }) = (self.name, self.outline);
        if !are_around(faces, nodes) {
            return Err(KindError::Faces { name, nodes, faces });
        }
        let mut registered = REGISTERED.write().unwrap_or_else(PoisonError::into_inner);
        if taken.contains(&name) || registered.contains_key(name) {
            return Err(KindError::Taken(name));
        }
        let kind: &'static CustomKind = Box::leak(Box::new(self));
        registered.insert(name, kind);
        Ok(kind)
    }

    /// The kind with this name.
    pub(super) fn named(name: &str) -> Option<&'static CustomKind> {
        let registered = REGISTERED.read().unwrap_or_else(PoisonError::into_inner);
        registered.get(name).copied()
    }
}

/// Whether faces are those of an element with this many nodes: of a triangle or a quadrilateral, with the same number of nodes
/// each, from corner to corner; the nodes between the corners are numbered after the corners, face by face.
fn are_around(faces: &[&[usize]], nodes: usize) -> bool {
    let (corners, per_face) = (faces.len(), faces.first().map_or(0, |face| face.len()));
    (3..=4).contains(&corners)
        && (2..=MAX_NODES).contains(&per_face)
        && nodes >= corners * (per_face - 1)
        && faces.iter().enumerate().all(|(k, face)| {
            let inner = corners + k * (per_face - 2)..corners + (k + 1) * (per_face - 2);
            [k].into_iter()
                .chain(inner)
                .chain([(k + 1) % corners])
                .eq(face.iter().copied())
        })
}

impl PartialEq for CustomKind {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for CustomKind {}

impl Hash for CustomKind {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name.hash(state);
    }
}
