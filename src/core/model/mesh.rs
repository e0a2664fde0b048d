//! Kinds of continuum elements, as far as a model must know them: their nodes and their faces.

use std::collections::HashMap;

/// A kind of element of the plane continuum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ElementKind {
    /// The 8-node quadrilateral of the serendipity family: the corners anticlockwise, then the middles of the sides that
    /// start at them.
    Quad8,
}

impl ElementKind {
    /// All of them.
    pub const ALL: [ElementKind; 1] = [ElementKind::Quad8];

    /// Number of nodes of an element.
    pub fn nodes(self) -> usize {
        match self {
            ElementKind::Quad8 => 8,
        }
    }

    /// The faces: for each the places of its nodes in the element, anticlockwise around it, so that outside lies on the
    /// right of the walk. A face with m nodes is an m-node interface element.
    pub fn faces(self) -> &'static [&'static [usize]] {
        match self {
            ElementKind::Quad8 => &[&[0, 4, 1], &[1, 5, 2], &[2, 6, 3], &[3, 7, 0]],
        }
    }

    /// The corners, where its faces begin: places in the element, anticlockwise.
    pub fn corners(self) -> impl Iterator<Item = usize> {
        self.faces().iter().filter_map(|face| face.first()).copied()
    }

    /// The faces of an element with these nodes, by node number.
    pub fn faces_of(self, nodes: &[usize]) -> impl Iterator<Item = Vec<usize>> {
        let faces = self.faces().iter();
        faces.map(|face| face.iter().map(|&place| nodes[place]).collect())
    }

    /// The faces that belong to one of these elements only, by node number: the boundary of the body that they make, as
    /// surface elements. Faces that follow each other stand one after the other.
    pub fn boundary(self, elements: &[Vec<usize>]) -> Vec<Vec<usize>> {
        let faces = elements.iter().flat_map(|nodes| self.faces_of(nodes));
        let all: Vec<Vec<usize>> = faces.collect();
        let ends = |face: &[usize]| Some((*face.first()?, *face.last()?));
        let walked: HashMap<(usize, usize), usize> = all
            .iter()
            .enumerate()
            .filter_map(|(k, face)| Some((ends(face)?, k)))
            .collect();
        let inside = |face: &[usize]| {
            ends(face).is_some_and(|(first, last)| walked.contains_key(&(last, first)))
        };
        let outer: Vec<Vec<usize>> = all.into_iter().filter(|face| !inside(face)).collect();
        in_order(outer)
    }
}

/// Faces walked from one to the next; where a walk closes or ends, the first face that is left begins another.
fn in_order(faces: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    let starts: HashMap<usize, usize> = faces
        .iter()
        .enumerate()
        .filter_map(|(k, face)| Some((*face.first()?, k)))
        .collect();
    let mut taken = vec![false; faces.len()];
    let mut order = Vec::with_capacity(faces.len());
    for begin in 0..faces.len() {
        let mut next = Some(begin);
        while let Some(k) = next.filter(|&k| !taken[k]) {
            taken[k] = true;
            order.push(k);
            next = faces[k].last().and_then(|last| starts.get(last)).copied();
        }
    }
    order.into_iter().map(|k| faces[k].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_faces_of_every_kind_close_around_it_and_name_each_of_its_outer_nodes() {
        for kind in ElementKind::ALL {
            let faces = kind.faces();
            for (face, next) in faces.iter().zip(faces.iter().cycle().skip(1)) {
                assert_eq!(face.last(), next.first(), "{kind:?}");
            }
            let mut named: Vec<usize> = faces.concat();
            named.sort_unstable();
            named.dedup();
            assert_eq!(named, (0..kind.nodes()).collect::<Vec<_>>(), "{kind:?}");
        }
    }

    #[test]
    fn the_boundary_of_two_elements_is_walked_around_both_and_not_between_them() {
        // 6-5-4-13-12
        // 7   3    11     two quadrilaterals that share the side 2-3-4
        // 0-1-2-9-10
        let elements = vec![
            vec![0, 2, 4, 6, 1, 3, 5, 7],
            vec![2, 10, 12, 4, 9, 11, 13, 3],
        ];
        let boundary = ElementKind::Quad8.boundary(&elements);
        let expected = [
            [0, 1, 2],
            [2, 9, 10],
            [10, 11, 12],
            [12, 13, 4],
            [4, 5, 6],
            [6, 7, 0],
        ];
        assert_eq!(boundary, expected);
    }
}
