//! The elimination tree of [`super::fronts`], computed once per pattern.
//!
//! Unknowns are grouped. The graph of the groups is ordered by approximate minimum degree, or by nested dissection
//! ([`super::dissection`]) if that pays off. An eliminated group is then coupled to the later groups
//!
//! ```text
//! later(k) = (neighbours(k) ∪ ⋃ later(children of k)) \ {k and what came before},      parent(k) = min later(k).
//! ```
//!
//! A group is merged with a child whose coupled groups are the same or nearly so; one larger front then replaces two. The run
//! time is nearly linear in the number of entries of the pattern and of the groups' factors.

use super::check::SolveError;
use super::dissection;
use super::graph::{Graph, NONE};
use super::pattern::{Pattern, lists};

/// A child is merged if the two eliminate at most this many unknowns, and at most this fraction of their front is zero.
const JOINED: [(usize, f64); 4] = [(8, 0.8), (24, 0.4), (64, 0.15), (usize::MAX, 0.03)];
/// A child whose values stay while its parent's change is merged only if it eliminates at most this many unknowns.
const JOINED_STILL: usize = 4;

/// Minor iterations of a typical major iteration, and changed positions per minor iteration.
const MINORS: f64 = 3.0;
const CHANGES: f64 = 4.0;

/// The unknowns that a front eliminates, and those coupled to them.
pub(super) struct Node {
    /// The unknowns eliminated here, then the later ones.
    pub unknowns: Vec<usize>,
    /// Number of unknowns eliminated here.
    pub pivots: usize,
    /// The node that receives its remainder, and the indices of its later unknowns there.
    pub parent: Option<usize>,
    pub places: Vec<usize>,
    /// Whether it depends on rows that may change between factorizations.
    pub changing: bool,
}

/// The nodes in postorder: children directly before their parent (with all of their descendants).
pub(super) struct Tree {
    pub nodes: Vec<Node>,
}

impl Tree {
    /// Computes the tree of a pattern; `groups` is the group of each unknown, and rows from `first` on may change.
    pub fn new(pattern: &Pattern, groups: &[usize], first: usize) -> Result<Self, SolveError> {
        let graph = Graph::new(pattern, groups, first);
        let (mut order, mut joined) =
            tried(&graph, graph.part_in_order((0..graph.count()).collect())?);
        if graph.changing.contains(&true) {
            let other = tried(&graph, dissection::order(&graph, &[])?);
            if operations(&other.1) < operations(&joined) {
                (order, joined) = other;
            }
        }
        let mut tree = Tree { nodes: Vec::new() };
        for root in roots(&joined) {
            tree.lay_out(&graph, &order, &mut joined, root);
        }
        tree.find_places(pattern.size());
        Ok(tree)
    }

    /// Numbers a node and its descendants.
    fn lay_out(
        &mut self,
        graph: &Graph,
        order: &Order,
        joined: &mut [EliminationGroup],
        root: usize,
    ) {
        let mut path = vec![root];
        while let Some(&node) = path.last() {
            if let Some(child) = joined[node].children.pop() {
                path.push(child);
                continue;
            }
            path.pop();
            let own = &mut joined[node];
            for &child in &own.numbered {
                self.nodes[child].parent = Some(self.nodes.len());
            }
            let groups = own.pivots.iter().chain(&own.later);
            let members = groups.flat_map(|&k| graph.members(order.groups[k]));
            self.nodes.push(Node {
                unknowns: members.map(|&unknown| unknown as usize).collect(),
                pivots: own.weight,
                parent: None,
                places: Vec::new(),
                changing: own.changing,
            });
            (own.pivots, own.later) = (Vec::new(), Vec::new());
            if let Some(&parent) = path.last() {
                joined[parent].numbered.push(self.nodes.len() - 1);
            }
        }
    }

    fn find_places(&mut self, size: usize) {
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); self.nodes.len()];
        for (k, node) in self.nodes.iter().enumerate() {
            if let Some(parent) = node.parent {
                children[parent].push(k);
            }
        }
        let mut place = vec![0; size];
        for (k, children) in children.iter().enumerate() {
            for (at, &unknown) in self.nodes[k].unknowns.iter().enumerate() {
                place[unknown] = at;
            }
            for &child in children {
                let node = &mut self.nodes[child];
                let later = &node.unknowns[node.pivots..];
                node.places = later.iter().map(|&unknown| place[unknown]).collect();
            }
        }
    }
}

/// The fronts that an order leads to; the order is converted to postorder.
fn tried(graph: &Graph, groups: Vec<usize>) -> (Order, Vec<EliminationGroup>) {
    let order = Order::new(groups);
    let parents = parents(graph, &order);
    let order = order.in_postorder(&parents);
    let joined = join(graph, &order);
    (order, joined)
}

/// An equivalent order of the groups with all descendants directly before each group.
pub(super) fn in_postorder(graph: &Graph, groups: Vec<usize>) -> Vec<usize> {
    let order = Order::new(groups);
    let parents = parents(graph, &order);
    order.in_postorder(&parents).groups
}

/// The elimination tree: for each position in the order, the first later group coupled to it by fill.
fn parents(graph: &Graph, order: &Order) -> Vec<usize> {
    let mut parents = vec![NONE; graph.count()];
    // Highest known ancestor of each position: paths are compressed during the walk.
    let mut top = vec![NONE; graph.count()];
    for (k, &group) in order.groups.iter().enumerate() {
        for neighbour in graph.neighbours(group) {
            let mut at = order.place[neighbour];
            while at < k {
                let next = std::mem::replace(&mut top[at], k);
                if next == NONE {
                    parents[at] = k;
                }
                at = next.min(k);
            }
        }
    }
    parents
}

/// Groups by position, and positions by group.
struct Order {
    groups: Vec<usize>,
    place: Vec<usize>,
}

impl Order {
    fn new(groups: Vec<usize>) -> Order {
        let mut place = vec![0; groups.len()];
        for (k, &group) in groups.iter().enumerate() {
            place[group] = k;
        }
        Order { groups, place }
    }

    /// An equivalent order with all descendants directly before their group.
    fn in_postorder(self, parents: &[usize]) -> Order {
        let count = parents.len();
        let below = || {
            let all = parents.iter().enumerate();
            all.map(|(k, &parent)| (if parent == NONE { count } else { parent }, k))
        };
        let (starts, mut children) = lists(count + 1, below);
        // In reverse, so that the first comes first.
        for k in 0..=count {
            children[starts[k]..starts[k + 1]].reverse();
        }
        let mut left: Vec<usize> = starts[1..].to_vec();
        let mut path = vec![count];
        let mut groups = Vec::with_capacity(count);
        while let Some(&k) = path.last() {
            if left[k] > starts[k] {
                left[k] -= 1;
                path.push(children[left[k]]);
            } else {
                path.pop();
                groups.extend(self.groups.get(k));
            }
        }
        Order::new(groups)
    }
}

/// Groups eliminated in one front, by position in the order.
#[derive(Default)]
struct EliminationGroup {
    pivots: Vec<usize>,
    /// Coupled later groups, ascending.
    later: Vec<usize>,
    /// Number of unknowns of both.
    weight: usize,
    seen: usize,
    /// Entries of its factors that are zero and exist only because groups were merged.
    zeros: usize,
    children: Vec<usize>,
    /// The children that are numbered in the tree.
    numbered: Vec<usize>,
    changing: bool,
    /// Whether it has been merged into another.
    gone: bool,
}

/// Merges each group with its children where that pays off, in order.
fn join(graph: &Graph, order: &Order) -> Vec<EliminationGroup> {
    let count = graph.count();
    let weight = |k: usize| graph.members(order.groups[k]).len();
    let mut all: Vec<EliminationGroup> = Vec::with_capacity(count);
    // The children of each position, and a mark for those already listed.
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); count];
    let mut mark = vec![NONE; count];
    for k in 0..count {
        let group = order.groups[k];
        let mut own = EliminationGroup {
            changing: graph.changing[group],
            weight: weight(k),
            children: std::mem::take(&mut children[k]),
            ..EliminationGroup::default()
        };
        let mut take = |later: &mut Vec<usize>, places: &mut dyn Iterator<Item = usize>| {
            for place in places.filter(|&place| place > k) {
                if std::mem::replace(&mut mark[place], k) != k {
                    later.push(place);
                }
            }
        };
        let seen = graph.neighbours(group);
        take(&mut own.later, &mut seen.map(|other| order.place[other]));
        for &child in &own.children {
            take(&mut own.later, &mut all[child].later.iter().copied());
            own.changing |= all[child].changing;
        }
        own.later.sort_unstable();
        own.seen = own.later.iter().map(|&place| weight(place)).sum();
        absorb(&mut own, &mut all);
        own.pivots.push(k);
        if let Some(&parent) = own.later.first() {
            children[parent].push(k);
        }
        all.push(own);
    }
    all
}

/// Merges a group with its children where that pays off; those that eliminate most come first.
fn absorb(own: &mut EliminationGroup, all: &mut [EliminationGroup]) {
    let mut children = std::mem::take(&mut own.children);
    children.sort_by_key(|&child| std::cmp::Reverse(all[child].seen));
    let mut kept = Vec::new();
    for child in children {
        let child_is = &mut all[child];
        let more = (own.weight + own.seen).saturating_sub(child_is.seen);
        let zeros = own.zeros + child_is.zeros + 2 * child_is.weight * more;
        let weight = own.weight + child_is.weight;
        let entries = weight * (weight + 2 * own.seen);
        let still = own.changing && !child_is.changing && child_is.weight > JOINED_STILL;
        let few =
            |&(most, part): &(usize, f64)| weight <= most && zeros as f64 <= part * entries as f64;
        if still || !(more == 0 || JOINED.iter().any(few)) {
            kept.push(child);
            continue;
        }
        (own.weight, own.zeros) = (weight, zeros);
        own.pivots.append(&mut child_is.pivots);
        own.children.append(&mut child_is.children);
        child_is.later = Vec::new();
        child_is.gone = true;
    }
    own.children.append(&mut kept);
    own.children.sort_unstable();
    own.pivots.sort_unstable();
}

/// Operations of a major iteration: all fronts once, and in each further minor iteration those affected by the changes.
fn operations(all: &[EliminationGroup]) -> f64 {
    let cube = |size: usize| (size as f64).powi(3);
    // A front with all its ancestors.
    let mut path = vec![0.0; all.len()];
    let (mut whole, mut reached, mut count) = (0.0, 0.0, 0.0);
    for (k, own) in all.iter().enumerate().rev().filter(|(_, own)| !own.gone) {
        let operations = cube(own.weight + own.seen) - cube(own.seen);
        path[k] += operations;
        own.children.iter().for_each(|&child| path[child] = path[k]);
        whole += operations;
        if own.changing {
            (reached, count) = (reached + path[k], count + 1.0);
        }
    }
    whole + MINORS * f64::min(whole, CHANGES * reached / f64::max(count, 1.0))
}

fn roots(all: &[EliminationGroup]) -> Vec<usize> {
    let roots = all.iter().enumerate();
    let roots = roots.filter(|(_, joined)| !joined.gone && joined.later.is_empty());
    roots.map(|(k, _)| k).collect()
}
