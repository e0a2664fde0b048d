//! A solver of one's own, in Rust, stepped as the debugger steps its own.
//!
//! Some nodes stand over a rough floor, tied to each other and to their places by springs; they are pressed down and pushed
//! along. The solver is a primal-dual active set iteration for Signorini's and Coulomb's conditions: solve with the modes as they
//! are, look which conditions are broken, change those modes, solve again. It implements [`Solver`], and a session does the rest:
//! stepping, going back, forcing a mode, branches.
//!
//! `cargo run --example attach`

use nalgebra::{DMatrix, DVector};
use std::error::Error;
use std::io::Write;
use std::sync::Arc;
use stickslip::contact::record::{ContactRecord, Forced};
use stickslip::history::branches;
use stickslip::linear::norms::Norms;
use stickslip::model::{Mode, Model};
use stickslip::record::command::{BranchTarget, Command, Unit};
use stickslip::recorded::log::Log;
use stickslip::session::Session;
use stickslip::step::event::{Event, Failure, Outcome};
use stickslip::step::solver::{Capabilities, Now, RewindSupport, SolverLost};
use stickslip::step::{Solver, State};
use stickslip_exchange::attach::message::{
    Components, Contact, Friction, Id, NodeMessage, Scene, SurfaceMessage,
};

/// Nodes, their distances from the floor, the stiffness of every spring, and the loads on a node at the load factor 1.
const GAPS: [f64; 4] = [0.0, 0.01, 0.03, 0.08];
const SPRING: f64 = 100.0;
const PRESS: f64 = 10.0;
const PUSH: f64 = 6.0;
const MU: f64 = 0.3;
/// Iterations after which modes that still change are given up.
const MOST: u32 = 20;

/// Springs, stepped by an active set iteration. All that it goes on from is in the state.
struct Springs {
    model: Arc<Model>,
    state: State,
    event: Event,
    /// Stiffness, the same along n and along t.
    k: DMatrix<f64>,
}

impl Springs {
    fn new(model: Arc<Model>) -> Self {
        let count = GAPS.len();
        let between = |i: usize, j: usize| match i.abs_diff(j) {
            0 => SPRING * (1 + usize::from(i > 0) + usize::from(i + 1 < count)) as f64,
            1 => -SPRING,
            _ => 0.0,
        };
        Springs {
            state: State::outside_start(&model),
            event: Event::nothing_yet(&model),
            k: DMatrix::from_fn(count, count, between),
            model,
        }
    }

    /// Motions, and the forces of the floor, under a load on each node; some are held where they are, others pulled.
    fn solve(
        &self,
        load: f64,
        held: &[Option<f64>],
        pull: &[f64],
    ) -> Result<[DVector<f64>; 2], SolverLost> {
        let loads = DVector::from_element(held.len(), load);
        let (mut matrix, mut right) = (self.k.clone(), &loads + DVector::from_row_slice(pull));
        for (i, held) in held.iter().enumerate() {
            if let Some(at) = held {
                matrix.row_mut(i).fill(0.0);
                (matrix[(i, i)], right[i]) = (1.0, *at);
            }
        }
        let moved = matrix
            .lu()
            .solve(&right)
            .ok_or_else(|| SolverLost::new("nothing holds the nodes"))?;
        let forces = &self.k * &moved - loads;
        Ok([moved, forces])
    }
}

impl Solver for Springs {
    fn now(&self) -> Now<'_> {
        Now::new(&self.model, &self.state, &self.event)
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }

    fn advance(&mut self) -> Result<(), SolverLost> {
        let (nodes, start) = (&self.state.nodes, &self.state.start);
        let load = (start.load_factor + self.state.controls.increment).min(1.0);
        // n is upward: a node that touches has come down by its distance.
        let touches = |k: usize| (nodes[k].mode != Mode::Free).then_some(-GAPS[k]);
        let held: Vec<_> = (0..GAPS.len()).map(touches).collect();
        let [up, f_n] = self.solve(-PRESS * load, &held, &[0.0; GAPS.len()])?;
        // t is to the left, and so are the pushes. A fixed node stays where it was when the increment began.
        let before = |k: usize| -start.u[2 * k];
        let sign = |k: usize| if nodes[k].sign > 0.0 { 1.0 } else { -1.0 };
        let sticks = |k: usize| (nodes[k].mode == Mode::Fixed).then(|| before(k));
        let held: Vec<_> = (0..GAPS.len()).map(sticks).collect();
        let slides = |k: usize| match nodes[k].mode {
            Mode::Sliding => sign(k) * MU * f_n[k],
            Mode::Free | Mode::Fixed => 0.0,
        };
        let pull: Vec<f64> = (0..GAPS.len()).map(slides).collect();
        let [along, f_t] = self.solve(PUSH * load, &held, &pull)?;
        let found = |k: usize| {
            let (node, gap, slip) = (&nodes[k], GAPS[k] + up[k], before(k) - along[k]);
            let next = match (node.forced, node.mode) {
                (Forced::Held(mode), _) => mode,
                (_, Mode::Free) if gap < 0.0 => Mode::Fixed,
                (_, Mode::Fixed | Mode::Sliding) if f_n[k] < 0.0 => Mode::Free,
                (_, Mode::Fixed) if f_t[k].abs() > MU * f_n[k] => Mode::Sliding,
                // The floor drags a node the way that it goes ahead of it.
                (_, Mode::Sliding) if slip * sign(k) < 0.0 => Mode::Fixed,
                (_, same) => same,
            };
            let t_max = (MU * f_n[k]).copysign(if node.mode == Mode::Sliding {
                sign(k)
            } else {
                f_t[k]
            });
            ContactRecord {
                gap,
                f_n: f_n[k],
                f_t: f_t[k],
                t_max,
                slip,
                ..ContactRecord::from_modes(node.mode, next, node)
            }
        };
        let records: Vec<ContactRecord> = (0..GAPS.len()).map(found).collect();
        let settled = records
            .iter()
            .all(|record| record.decision.before == record.decision.next);
        self.event = Event {
            position: self.state.next,
            load_factor: load,
            outcome: match settled {
                true => Outcome::accepted(Norms::default(), load == 1.0),
                false if self.state.next.minor >= MOST => Outcome::Failed(Failure::Reported {
                    reason: format!("modes still change after {MOST} iterations"),
                    relative: None,
                }),
                false => Outcome::Minor,
            },
            nodes: records,
            ..Event::nothing_yet(&self.model)
        };
        let mut u = vec![0.0; self.model.dofs.len()];
        for k in 0..GAPS.len() {
            (u[2 * k], u[2 * k + 1]) = (-along[k], up[k]);
        }
        self.state.u = Arc::new(u);
        self.state.follow(&self.event, 0);
        Ok(())
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities {
            name: "springs".into(),
            force: true,
            hold: true,
            increment: true,
            goes_back: RewindSupport::ToAny,
            ..Capabilities::default()
        }
    }
}

/// What is drawn, and which nodes may touch what.
fn told() -> Scene {
    let node = |name: String, at: [f64; 2]| NodeMessage {
        name,
        at: Some(Components::Two(at)),
    };
    let mut nodes: Vec<NodeMessage> = GAPS
        .iter()
        .zip(1..)
        .map(|(gap, k)| node(format!("node.{k}"), [f64::from(k), *gap]))
        .collect();
    nodes.push(node("floor.1".into(), [6.0, 0.0]));
    nodes.push(node("floor.2".into(), [-1.0, 0.0]));
    let contact = |k: usize| Contact {
        id: Id::Number(k as i64),
        node: k,
        surface: Some("floor".into()),
        friction: Friction {
            mu: Some(MU),
            ..Friction::default()
        },
        ..Contact::default()
    };
    Scene {
        title: "Nodes on springs over a rough floor".into(),
        about: String::new(),
        dimension: 2,
        mesh: None,
        nodes,
        lines: vec![(0..GAPS.len()).collect()],
        faces: Vec::new(),
        surfaces: vec![SurfaceMessage {
            name: "floor".into(),
            nodes: vec![GAPS.len(), GAPS.len() + 1],
            faces: Vec::new(),
            rigid: true,
        }],
        contacts: (0..GAPS.len()).map(contact).collect(),
        load: Some([0.0, 1.0]),
        monitors: Vec::new(),
        arc: false,
        drag: false,
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    run(&mut std::io::stdout())
}

/// Writes what happens: the way to the first accepted state, and another way to it by a mode that is forced.
pub fn run(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let scene = stickslip::scene::Scene::from_message("springs", &told(), Some(0.5))?;
    let solver = Springs::new(Arc::new(scene.model.clone()));
    let mut session = Session::attached(scene, Box::new(solver), Log::default());
    let mut goes = |command: Command| -> Result<Vec<String>, Box<dyn Error>> {
        let from = session.cursor();
        session.submit(command)?;
        session.wait();
        let frames = &session.frames()[(from + 1).min(session.frames().len())..];
        let mut lines: Vec<String> = frames
            .iter()
            .filter_map(|frame| {
                frame
                    .event
                    .as_ref()
                    .filter(|_| frame.intervention.is_none())
            })
            .map(|event| line(event))
            .collect();
        lines.push(format!(
            "in {}, step {}",
            branches::name(
                session.timeline().tree(),
                session.timeline().tree().current()
            ),
            session.cursor()
        ));
        Ok(lines)
    };
    let increment = || Command::Forward {
        unit: Unit::Increment,
        count: 1,
    };
    let back = Command::Back {
        unit: Unit::Minor,
        count: 2,
    };
    let force = Command::Force {
        slave: 2,
        mode: Mode::Free,
        hold: true,
    };
    for command in [
        increment(),
        back,
        force,
        increment(),
        Command::Branch(BranchTarget::Next),
        increment(),
    ] {
        for line in goes(command)? {
            writeln!(out, "{line}")?;
        }
    }
    Ok(())
}

/// An iteration in a line: the modes that were solved, and the normal forces.
fn line(event: &Event) -> String {
    let modes = event.nodes.iter().map(|node| match node.decision.before {
        Mode::Free => 'O',
        Mode::Sliding => 'S',
        Mode::Fixed => 'F',
    });
    let forces: Vec<String> = event
        .nodes
        .iter()
        .map(|node| format!("{:.3}", node.f_n))
        .collect();
    let ends = if matches!(event.outcome, Outcome::Increment { .. }) {
        ", accepted"
    } else {
        ""
    };
    let place = (event.position.increment, event.position.minor);
    format!(
        "{}.{} {} F_n = {}{ends}",
        place.0,
        place.1,
        modes.collect::<String>(),
        forces.join(" ")
    )
}
