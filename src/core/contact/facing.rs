//! Selects the pieces of a master that a slave node may touch, where the master is cut at its convex corners.
//!
//! A node that passes a corner at a small depth is briefly closer to the side that it does not face. On an uncut chain S* would
//! jump to that side and push the node out in the wrong direction. Let n_S be the outward normal of the slave's body at the
//! node, and n the normal of a piece at its point closest to the node. The node faces the piece, and may touch it, if
//!
//! ```text
//! n_S · n < −1/2          (within 60 degrees of opposite)
//! ```
//!
//! A node that faces no piece may touch all of them. At a right-angled corner, every direction towards the corner faces one of
//! the two sides. The condition depends on positions only, so the judge uses it as well.

use crate::contact::projection::{closest_point, normal, right_of};
use crate::model::{Contact, Surface};
use crate::plane::{dot, minus};

/// Maximum number of surfaces of a slave node for which the facing condition is tested; a node with more may touch all of them.
pub const MOST: usize = 16;
/// n_S · n below which a node faces a piece.
const FACES: f64 = -0.5;

/// Numbers of the surfaces that a slave node may touch, for the given `positions` of all nodes. The result is stored in `room`
/// unless the node may touch all its surfaces.
pub fn faced<'a>(
    slave: &'a Contact,
    surfaces: &[Surface],
    positions: &[[f64; 2]],
    room: &'a mut [usize; MOST],
) -> &'a [usize] {
    let all = slave.surfaces.as_slice();
    let Some(facing) = slave.facing.as_ref().filter(|_| all.len() <= MOST) else {
        return all;
    };
    let [from, to] = facing.outline.map(|node| positions[node]);
    let own = right_of(minus(to, from));
    let at = positions[slave.node];
    let faces = |surface: usize| {
        let spot = closest_point(at, surfaces, &[surface], positions, None);
        spot.is_some_and(|spot| {
            let n = normal(&surfaces[surface], spot, positions);
            dot(own, n) < FACES
        })
    };
    let (mut count, mut found) = (0, false);
    for &surface in all {
        let is_piece = facing.pieces.contains(&surface);
        let is_faced = is_piece && faces(surface);
        found |= is_faced;
        if is_faced || !is_piece {
            room[count] = surface;
            count += 1;
        }
    }
    if found { &room[..count] } else { all }
}

/// Whether a surface is a piece of a cut master of this slave node.
pub fn is_piece(slave: &Contact, surface: usize) -> bool {
    let facing = slave.facing.as_ref();
    facing.is_some_and(|facing| facing.pieces.contains(&surface))
}
