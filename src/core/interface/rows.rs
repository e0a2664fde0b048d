//! Table 1's equations of a node, modified where supports carry a force.

use crate::contact::table1::{FrictionBound, SlipDirection, braked, equations, gone};
use crate::{BoundUpdate, ContactState, Equation, Friction, Mode, NodeKinematics, Settings};

/// Table 1's equations of a node, normal and tangential. An equation without an unknown is replaced by zero force, and the
/// supports carry that component ([`carried`]). `brake` resists sliding ([`crate::contact::table1::braked`]; 0 for Table 1
/// itself).
pub fn rows(
    node: &ContactState,
    kinematics: Option<&NodeKinematics>,
    friction: &Friction,
    settings: &Settings,
    brake: f64,
) -> [Equation; 2] {
    let limit = match settings.t_max {
        BoundUpdate::Lagged => FrictionBound::Lagged(node.t_max),
        BoundUpdate::Consistent => FrictionBound::Consistent {
            sign: node.sign,
            coefficient: friction.coefficient(),
            cohesion: friction.cohesion,
        },
    };
    let known = SlipDirection {
        gap: kinematics.map_or(0.0, |k| k.gap),
        ratio: node.ratio,
        slip: match kinematics {
            Some(over) if over.bond.is_tied() => node.drift,
            _ => node.slipped(settings),
        },
        f_n: node.f_n,
        f_t: node.f_t,
        limit,
    };
    let moves = moves(kinematics);
    let [normal, tangential] = supported(node.mode, &known, moves);
    match node.mode {
        Mode::Sliding if brake > 0.0 && moves[1] => [normal, braked(tangential, brake)],
        _ => [normal, tangential],
    }
}

/// Table 1's equations, with zero force for components carried by supports.
pub fn supported(mode: Mode, known: &SlipDirection, moves: [bool; 2]) -> [Equation; 2] {
    let [mut normal, mut tangential] = equations(mode, known);
    let carried = carried(mode, moves);
    if carried[0] {
        normal = gone(1.0, 0.0, known.f_n);
    }
    if carried[1] {
        tangential = gone(0.0, 1.0, known.f_t);
    }
    [normal, tangential]
}

/// Whether the normal and the tangential motion contain an unknown; both false without a surface.
pub fn moves(kinematics: Option<&NodeKinematics>) -> [bool; 2] {
    kinematics.map_or([false; 2], |k| k.moves)
}

/// Force components (normal, tangential) carried by the supports: those that would constrain a motion without an unknown.
pub fn carried(mode: Mode, moves: [bool; 2]) -> [bool; 2] {
    [
        mode != Mode::Free && !moves[0],
        mode == Mode::Fixed && !moves[1],
    ]
}
