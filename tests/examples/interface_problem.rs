//! Poses an interface problem of its own, without bodies, and finds all of its consistent states.
//!
//! Two slave nodes on a rigid floor are held by springs and coupled by another one. With K the stiffness in the components
//! (n, t) of each node, P the loads and F the forces of the floor, K u = P + F. The floor does not move, so the motion of S*
//! relative to S is v = −u, and the forces answer it by F = −P − K v.
//!
//! `cargo run --example interface_problem`

use std::error::Error;
use std::io::Write;
use stickslip::contact::state::ContactState;
use stickslip::interface::census::census;
use stickslip::interface::kinematics::NodeKinematics;
use stickslip::interface::problem::{Assumed, InterfaceProblem, ProblemNode, Trials};
use stickslip::interface::response::InterfaceResponse;
use stickslip::model::{Friction, InitialState, Mode, Settings};

/// Stiffness by rows: n and t of node 0, n and t of node 1.
const K: [[f64; 4]; 4] = [
    [100.0, 0.0, 0.0, 0.0],
    [0.0, 120.0, 0.0, -20.0],
    [0.0, 0.0, 100.0, 0.0],
    [0.0, -20.0, 0.0, 120.0],
];
/// Loads in the same components: both nodes are pressed down, and node 0 is pushed against t.
const P: [f64; 4] = [-30.0, -30.0, -30.0, 0.0];

fn main() -> Result<(), Box<dyn Error>> {
    run(&mut std::io::stdout())
}

/// Writes how far one assumption is from obeying Coulomb's law, and all states that obey it.
pub fn run(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let problem = problem();
    let mut trials = Trials::new(&problem).ok_or("no memory")?;
    let stuck = trials.answer(&[Assumed::Fixed; 2]).ok_or("singular")?;
    let (node, margin) = stuck.worst().ok_or("no nodes")?;
    writeln!(
        out,
        "{}: node {node} breaks {:?} by {:.3}",
        stuck.letters(),
        margin.condition,
        -margin.value,
    )?;
    let all = census(&problem)?;
    writeln!(
        out,
        "{} assumptions tried, {} consistent",
        all.tried,
        all.answers.len()
    )?;
    for found in &all.answers {
        for (node, answer) in found.answer.nodes.iter().enumerate() {
            writeln!(
                out,
                "{}: node {node} has F_n = {:.4}, F_t = {:.4}, slip = {:.5}",
                found.answer.letters(),
                answer.f_n,
                answer.f_t,
                answer.slip,
            )?;
        }
    }
    Ok(())
}

fn problem() -> InterfaceProblem {
    InterfaceProblem {
        relation: InterfaceResponse {
            // No springs in between: z is the motion v itself.
            stiffness: f64::INFINITY,
            start: P.map(|p| -p).to_vec(),
            // Column by column.
            response: (0..4).flat_map(|j| K.map(|row| -row[j])).collect(),
        },
        nodes: (0..2).map(node).collect(),
        // What forces, lengths and stiffnesses are about as large as.
        force: 30.0,
        length: 0.3,
        spring: 100.0,
        settings: Settings::default(),
    }
}

/// A node that starts free, 0.1 above a floor whose outward normal is y.
fn node(slave: usize) -> ProblemNode {
    ProblemNode {
        slave,
        kinematics: Some(NodeKinematics {
            gap: 0.1,
            normal: [0.0, 1.0],
            foot: [slave as f64, 0.0],
            moves: [true; 2],
        }),
        prescribed: [0.0; 2],
        friction: Friction {
            angle: 20.0,
            cohesion: 0.0,
        },
        state: ContactState::new(Mode::Free, &InitialState::default()),
    }
}
