//! A smooth curve through all nodes of a master chain, so that its normal does not jump between elements.
//!
//! Between the nodes b and c the curve is the cubic with given positions and slopes at its ends (Hermite). The slope at a node is
//! that of the parabola through it and its two neighbours (Catmull & Rom 1974 for equal distances; Overhauser 1968). With knots
//! s, the distance along the undeformed straight chords between nodes, and h = s_c − s_b,
//!
//! ```text
//! x(t) = h00(t) x_b + h10(t) h x'_b + h01(t) x_c + h11(t) h x'_c            t = (s − s_b)/h = (1 + ξ)/2
//! x'_b = h/(k+h) (x_b − x_a)/k + k/(k+h) (x_c − x_b)/h                       k = s_b − s_a
//! h00 = 2t³ − 3t² + 1    h10 = t³ − 2t² + t    h01 = 3t² − 2t³    h11 = t³ − t²
//! ```
//!
//! On a closed chain this holds everywhere. At an end of an open chain the slope is that of the parabola through the last three
//! nodes, so the last piece is this parabola; a chain of two nodes is straight.
//!
//! The knots are constant, so a point of the curve is a fixed weighted mean of up to four node positions: Σ N_i x_i, where the
//! N_i sum to one. Hence the curve rotates and moves with its nodes, a piece behaves like an element with shape functions, and a
//! force on it is distributed over the four nodes such that force and moment are preserved. x' is continuous, and x'' jumps at
//! the nodes. The distance from a smooth curve through the nodes is O(h³), and from a circle with evenly spaced nodes 3h⁴/128
//! radii, where h is the angle between two nodes.
//!
//! The curve has no corners: sharp turns of the chain are rounded. A real corner requires two surfaces.

use crate::fem::lagrange::{MAX_NODES, Shape};
use crate::model::{Node, Piece, STENCIL, Surface};

/// Makes the chain of a surface smooth: its elements are then the pieces between nodes. The chain's elements must be connected,
/// with distinct nodes, at least three of them if it is closed.
pub fn smooth(surface: &mut Surface, nodes: &[Node]) {
    let chain = walk(&surface.elements);
    let closed = chain.len() > 2 && chain.first() == chain.last();
    let count = chain.len().saturating_sub(1);
    let (elements, pieces) = (0..count).map(|k| piece(&chain, closed, k, nodes)).unzip();
    (surface.elements, surface.smooth) = (elements, pieces);
}

/// The nodes of a chain in walking order; a closed chain repeats its first node at the end.
fn walk(elements: &[Vec<usize>]) -> Vec<usize> {
    let mut chain: Vec<usize> = elements.iter().flatten().copied().collect();
    chain.dedup();
    chain
}

/// Piece k of a chain, with the nodes that it depends on.
fn piece(chain: &[usize], closed: bool, k: usize, nodes: &[Node]) -> (Vec<usize>, Piece) {
    let count = chain.len() - 1;
    let before = match k {
        0 if closed => Some(chain[count - 1]),
        0 => None,
        _ => Some(chain[k - 1]),
    };
    let behind = match chain.get(k + 2) {
        None if closed => Some(chain[1]),
        behind => behind.copied(),
    };
    let (b, c) = (chain[k], chain[k + 1]);
    let chord = |one: usize, other: usize| {
        let ([x, y], [u, v]) = (nodes[one].at, nodes[other].at);
        (u - x).hypot(v - y)
    };
    let h = chord(b, c);
    let first = usize::from(before.is_some());
    // Slopes times h, as weights of (the node before, b, c) and of (b, c, the node after).
    let early = before.map(|a| {
        let k = chord(a, b);
        let (share, own) = (h / (k + h) * (h / k), k / (k + h));
        [-share, share - own, own]
    });
    let late = behind.map(|d| {
        let l = chord(c, d);
        let (own, share) = (l / (l + h), h / (l + h) * (h / l));
        [-own, own - share, share]
    });
    let mut slopes = [[0.0; STENCIL]; 2];
    let mut add = |end: usize, from: usize, shares: [f64; 3]| {
        for (slope, share) in slopes[end][from..].iter_mut().zip(shares) {
            *slope += share;
        }
    };
    // If a parabola is missing, its slope follows from the other parabola: twice the chord minus the slope at the other end.
    let other = |[x, y, z]: [f64; 3], chord: [f64; 3]| {
        [2.0 * chord[0] - x, 2.0 * chord[1] - y, 2.0 * chord[2] - z]
    };
    match (early, late) {
        (Some(early), Some(late)) => {
            add(0, 0, early);
            add(1, 1, late);
        }
        (Some(early), None) => {
            add(0, 0, early);
            add(1, 0, other(early, [0.0, -1.0, 1.0]));
        }
        (None, Some(late)) => {
            add(0, 0, other(late, [-1.0, 1.0, 0.0]));
            add(1, 0, late);
        }
        (None, None) => (0..2).for_each(|end| add(end, 0, [-1.0, 1.0, 0.0])),
    }
    let mut stencil: Vec<usize> = [before, Some(b), Some(c), behind]
        .into_iter()
        .flatten()
        .collect();
    // On a triangle, the node before equals the node after.
    if before.is_some() && before == behind {
        stencil.pop();
        for slope in &mut slopes {
            slope[0] += std::mem::take(&mut slope[STENCIL - 1]);
        }
    }
    (stencil, Piece { first, slopes })
}

/// The functions N_i of a piece at ξ, with two derivatives with respect to ξ.
pub fn shape(piece: &Piece, xi: f64) -> Shape {
    let t = 0.5 * (1.0 + xi);
    let (n, d, dd) = (
        hermite(
            [
                t * t * (2.0 * t - 3.0) + 1.0,
                t * ((t - 2.0) * t + 1.0),
                t * t * (3.0 - 2.0 * t),
                t * t * (t - 1.0),
            ],
            piece,
        ),
        hermite(
            [
                6.0 * t * (t - 1.0),
                (3.0 * t - 4.0) * t + 1.0,
                6.0 * t * (1.0 - t),
                t * (3.0 * t - 2.0),
            ],
            piece,
        ),
        hermite(
            [12.0 * t - 6.0, 6.0 * t - 4.0, 6.0 - 12.0 * t, 6.0 * t - 2.0],
            piece,
        ),
    );
    // dt/dξ = 1/2.
    Shape {
        n,
        d: d.map(|d| 0.5 * d),
        dd: dd.map(|dd| 0.25 * dd),
    }
}

/// The weight of each node in a combination of position and slope at the start and at the end.
fn hermite([b, slope_b, c, slope_c]: [f64; 4], piece: &Piece) -> [f64; MAX_NODES] {
    let mut shares = [0.0; MAX_NODES];
    for (k, share) in shares.iter_mut().enumerate().take(STENCIL) {
        *share = slope_b * piece.slopes[0][k] + slope_c * piece.slopes[1][k];
    }
    shares[piece.first] += b;
    shares[piece.first + 1] += c;
    shares
}
