//! Boundary of a mesh of continuum elements.

use crate::elements::kinds::ElementKind;
use std::collections::HashMap;

/// The faces that belong to exactly one of these elements, as node numbers: the boundary of the body. Connected faces are
/// consecutive.
pub fn boundary<'a>(
    elements: impl Iterator<Item = (ElementKind, &'a [usize])> + Clone,
) -> Vec<Vec<usize>> {
    let places =
        elements.flat_map(|(kind, nodes)| kind.faces().iter().map(move |face| (nodes, *face)));
    let ends = |nodes: &[usize], face: &[usize]| (nodes[face[0]], nodes[face[face.len() - 1]]);
    let mut walked: Vec<(usize, usize)> = places
        .clone()
        .map(|(nodes, face)| ends(nodes, face))
        .collect();
    walked.sort_unstable();
    let outer = places.filter(|(nodes, face)| {
        let (first, last) = ends(nodes, face);
        walked.binary_search(&(last, first)).is_err()
    });
    in_order(
        outer
            .map(|(nodes, face)| face.iter().map(|&place| nodes[place]).collect())
            .collect(),
    )
}

/// Sorts faces into walks; where a walk closes or ends, the first remaining face starts the next one.
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
            let outer = kind.nodes() - usize::from(kind == ElementKind::Quad9);
            assert_eq!(named, (0..outer).collect::<Vec<_>>(), "{kind:?}");
            assert!(faces.iter().all(|face| face.len() == kind.per_face()));
        }
    }

    #[test]
    fn the_boundary_of_two_elements_surrounds_both() {
        // 6-5-4-13-12
        // 7   3    11     two quadrilaterals that share the side 2-3-4
        // 0-1-2-9-10
        let elements = [
            vec![0, 2, 4, 6, 1, 3, 5, 7],
            vec![2, 10, 12, 4, 9, 11, 13, 3],
        ];
        let of_kind = elements
            .iter()
            .map(|nodes| (ElementKind::Quad8, nodes.as_slice()));
        let boundary = boundary(of_kind);
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

    #[test]
    fn the_boundary_of_mixed_elements_surrounds_all() {
        // 3---2       a quadrilateral, with a triangle on its right
        // |   | \
        // 0---1--4
        let elements: [(ElementKind, &[usize]); 2] = [
            (ElementKind::Quad4, &[0, 1, 2, 3]),
            (ElementKind::Triangle3, &[1, 4, 2]),
        ];
        let boundary = boundary(elements.into_iter());
        assert_eq!(boundary, [[0, 1], [1, 4], [4, 2], [2, 3], [3, 0]]);
    }
}
