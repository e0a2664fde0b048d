//! Writes a frozen interface problem as a condensed scene ([`stickslip_scene::format::condensed`]) that has the
//! same minor iterations.
//!
//! With springs of stiffness k the problem's relation is `ΔF = start + R (v − ΔF / k)` ([`stickslip_core::interface::response`]);
//! S* moves by v + p relative to S, where p is prescribed. In the scene the slave node moves by u = −(v + p)
//! over a floor at rest, under F = F₀ + ΔF. Without the springs,
//!
//! ```text
//! K (u − free) = load + F      K = −(1 + R/k)⁻¹ R      load = −(1 + R/k)⁻¹ start − F₀      free = −p
//! u = free + W F               W = −(R⁻¹ + 1/k)        free = R⁻¹ start − W F₀ − p
//! ```
//!
//! The first form exists unless something is rigid, the second unless something can move freely; if both exist,
//! the first is written. Each file is read back and compared step by step with the problem before it is
//! returned ([`compared`]).

use crate::explain::core::{Core, cycle as cycle_of};
use crate::explain::cycles;
use crate::explain::names;
use crate::refusal::{Refusal, refusal};
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip_core::plane::max_abs;
use stickslip_core::strategy::method;
use stickslip_core::{
    Bond, ContactRecord, Cycle, Failure, Forced, InitialState, InterfaceProblem, Mode, Model,
    Outcome, Position, ProblemNode, RunEnd, Settings, Stepper, Trials, Until,
};
use stickslip_exchange::problem::{self, Local};
use stickslip_linalg::DenseFactors;
use stickslip_scene::format::condensed::{Contact, Matrix, Problem};
use stickslip_scene::format::read;
use stickslip_scene::{Scene, joined, limits, shown};

/// Why there is nothing to write.
const NO_INTERFACE: &str = "no slave node faces a surface, so there is no interface problem";
/// Why the problem cannot be reduced.
const NOT_SOLVABLE: &str = "the problem of the nodes that face a surface is singular";

/// If the inverse (relative to the springs) that yields one of the two matrices is larger than this, removing
/// the springs loses too many digits.
const SINGULAR: f64 = 1e9;
/// Maximum number of minor iterations compared between a file and its problem.
const COMPARED: u32 = 200;
/// Largest relative difference of forces and lengths: the accuracy lost by removing the springs.
const CLOSE: f64 = 1e-6;
/// Line width of comments.
const WIDTH: usize = 110;

/// Where a frozen problem comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Origin {
    /// Name of the scene.
    pub scene: String,
    /// Changes before, as typed: `PATH=VALUE`, or an intervention in words.
    pub changes: Vec<String>,
    /// The minor iteration after which the problem was taken, or before the first one.
    pub at: Position,
    /// Target load factor.
    pub load: f64,
}

impl Origin {
    /// A scene with its overrides.
    pub fn new(scene: &Scene, at: Position, load: f64) -> Self {
        Origin {
            scene: scene.name.clone(),
            changes: scene.overrides().map(|(p, v)| format!("{p}={v}")).collect(),
            at,
            load,
        }
    }

    /// The origin in a sentence.
    pub fn words(&self) -> String {
        let with = match self.changes.as_slice() {
            [] => String::new(),
            changes => format!(" with {}", changes.join(", ")),
        };
        let (scene, at, load) = (&self.scene, names::position(self.at), self.load);
        format!("From: {scene}{with}; {at}, load {load}.")
    }
}

/// The file of a core; `cycle` is that of the whole scene.
///
/// # Errors
/// If it cannot be written.
pub fn core(model: &Model, origin: &Origin, cycle: &Cycle, core: &Core) -> Result<String, Refusal> {
    let problem = core.on_cycle();
    let mut of_core = cycle_of(&problem).unwrap_or_else(|| core.cycle.clone());
    for (place, _) in &mut of_core.members {
        *place = problem.nodes[*place].slave;
    }
    let named = |slave: usize| names::slave(model, slave);
    let names = joined(
        core.problem.nodes.iter().map(|node| named(node.slave)),
        ", ",
    );
    let head = [
        "The core of a cycle: the smallest set of nodes that still cycles with all other modes frozen.".to_owned(),
        origin.words(),
        format!("In the scene: {}.", cycles::cycle(model, cycle)),
        format!("In this file: {}.", cycles::cycle(model, &of_core)),
    ];
    let title = format!(
        "Core of {}: {}, period {}",
        origin.scene, names, core.cycle.period
    );
    text(model, &problem, title, head.into())
}

/// The nodes that can be written: those that face a surface and can move.
pub fn writable(problem: &InterfaceProblem) -> Vec<usize> {
    (0..problem.nodes.len())
        .filter(|place| problem.nodes[*place].moves() != [false; 2])
        .collect()
}

/// The nodes that can be written, and the problem without the others.
fn writable_part(problem: &InterfaceProblem) -> Result<(Vec<usize>, InterfaceProblem), Refusal> {
    let here = writable(problem);
    if here.is_empty() {
        return Err(Refusal::new(NO_INTERFACE));
    }
    let reduced = problem.reduced(&here);
    let reduced = reduced.ok_or_else(|| Refusal::new(NOT_SOLVABLE))?;
    Ok((here, reduced))
}

/// The file of a whole frozen problem in its current state, without the nodes that cannot be written
/// ([`writable`]): these do not interact with the others.
///
/// # Errors
/// If it cannot be written.
pub fn whole(
    model: &Model,
    origin: &Origin,
    problem: &InterfaceProblem,
) -> Result<String, Refusal> {
    let (here, reduced) = writable_part(problem)?;
    let mut head = vec![
        "The frozen interface problem of a major iteration: the bodies reduced to their contact nodes.".to_owned(),
        origin.words(),
    ];
    let gone = (0..problem.nodes.len()).filter(|place| !here.contains(place));
    let gone = joined(
        gone.map(|place| names::slave(model, problem.nodes[place].slave)),
        ", ",
    );
    if !gone.is_empty() {
        head.push(format!(
            "Left out (past the ends of all surfaces, or fixed together with the surface): {gone}."
        ));
    }
    let title = format!(
        "Interface of {}: {}",
        origin.scene,
        names::position(origin.at)
    );
    text(model, &reduced, title, head)
}

/// The file: with the stiffness, if that exists and its steps match the problem, otherwise with the compliance.
fn text(
    model: &Model,
    problem: &InterfaceProblem,
    title: String,
    mut head: Vec<String>,
) -> Result<String, Refusal> {
    unsupported(model, problem)?;
    let count = problem.nodes.len();
    let mut problem = problem.clone();
    for node in &mut problem.nodes {
        node.state.forced = Forced::No;
    }
    let problem = &problem;
    let ids = ids(model, problem);
    let renamed: Vec<String> = ids
        .iter()
        .zip(&problem.nodes)
        .filter_map(|(id, node)| {
            let name = names::slave(model, node.slave);
            (id != name).then(|| format!("{id} is {name}"))
        })
        .collect();
    if !renamed.is_empty() {
        head.push(format!("Nodes: {}.", renamed.join(", ")));
    }
    let comments: Vec<String> = head.iter().flat_map(|line| wrapped(line)).collect();
    let mut refused = Vec::new();
    for (form, made) in [
        ("stiffness", stiffness(problem)),
        (
            "compliance",
            compliance(problem)
                .map(|(w, free)| (Matrix::Compliance(w), free, vec![[0.0; 2]; count])),
        ),
    ] {
        let Some((matrix, free, loads)) = made else {
            let why = if form == "stiffness" {
                "some motion is rigidly fixed"
            } else {
                "some motion is unrestrained"
            };
            refused.push(format!("no {form}: {why}"));
            continue;
        };
        let contact = |place: usize| contact(problem, place, &ids[place], loads[place]);
        let contacts = (0..count).map(contact).collect();
        let written = Problem {
            spacing: Some(spacing(problem)),
            settings: settings(&problem.settings),
            ..Problem::new(&shortened(&title), contacts, matrix, free)
        };
        let text = written.text(&comments);
        if text.len() > read::FILE_BYTES {
            return Err(refusal!(
                "the matrix of {count} nodes takes {mebibytes} MiB, but scene files are limited to {} MiB; export the core instead",
                read::FILE_BYTES >> 20,
                mebibytes = text.len() >> 20
            ));
        }
        match compared(problem, &text) {
            Ok(_) => return Ok(text),
            Err(why) => refused.push(format!("with the {form}, the steps differ: {why}")),
        }
    }
    Err(refusal!(
        "the problem cannot be written as a matrix: {}",
        refused.join("; ")
    ))
}

/// A frozen problem in Siconos format in its current state, without the nodes that cannot be written
/// ([`writable`]). `q` includes the gaps and the previous slip, so that `u` are the gaps and slips of the whole
/// increment.
///
/// # Errors
/// If it cannot be written: the format supports only a compliance, and no cohesion.
pub fn siconos(model: &Model, problem: &InterfaceProblem) -> Result<Local, Refusal> {
    let TotalForceProblem { slaves, w, q } = total(model, problem)?;
    let nodes = || {
        slaves
            .iter()
            .filter_map(|slave| problem.nodes.iter().find(|node| node.slave == *slave))
    };
    if let Some(node) = nodes().find(|node| node.friction.cohesion != 0.0) {
        let name = names::slave(model, node.slave).to_owned();
        return Err(refusal!(
            "{name} has cohesion, which only .ron files support; export one instead"
        ));
    }
    let mu = nodes().map(|node| node.friction.coefficient()).collect();
    let w = problem::Matrix::from_rows(&w);
    Ok(Local { w, q, mu })
}

/// A problem in the total forces of its nodes: (gap, u) = W f + q, with n and t of each node in turn. u is the
/// slave's motion along t relative to its master since the start of the increment.
pub struct TotalForceProblem {
    /// Slave numbers of the nodes.
    pub slaves: Vec<usize>,
    /// W, row by row (length by force).
    pub w: Vec<Vec<f64>>,
    /// Gaps and motions at zero force (length).
    pub q: Vec<f64>,
}

/// A problem in total forces.
///
/// # Errors
/// If some motion is unrestrained, or a support carries the contact force of a node.
pub fn total(model: &Model, problem: &InterfaceProblem) -> Result<TotalForceProblem, Refusal> {
    let (_, problem) = writable_part(problem)?;
    unsupported(model, &problem)?;
    let (w, mut q) = compliance(&problem).ok_or_else(|| {
        refusal!("the problem cannot be written as a matrix: some motion is unrestrained")
    })?;
    for (pair, node) in q.chunks_exact_mut(2).zip(&problem.nodes) {
        pair[0] += node.kinematics.map_or(0.0, |k| k.gap);
        // Slip is the motion of the master relative to the slave; u is that of the slave.
        pair[1] -= node.state.slipped(&problem.settings);
    }
    let slaves = problem.nodes.iter().map(|node| node.slave).collect();
    Ok(TotalForceProblem { slaves, w, q })
}

/// Rejects nodes whose forces are carried by a support.
fn unsupported(model: &Model, problem: &InterfaceProblem) -> Result<(), Refusal> {
    let carried: Vec<&str> = problem
        .nodes
        .iter()
        .filter(|node| node.moves() != [true; 2])
        .map(|node| names::slave(model, node.slave))
        .collect();
    if carried.is_empty() {
        Ok(())
    } else {
        Err(refusal!(
            "{} cannot move along or across the surface: its support carries the contact force, which no matrix can represent",
            carried.join(", ")
        ))
    }
}

/// A contact in its current state.
fn contact(problem: &InterfaceProblem, place: usize, id: &str, load: [f64; 2]) -> Contact {
    let ProblemNode {
        kinematics,
        friction,
        state,
        ..
    } = problem.nodes[place];
    let touches = state.mode != Mode::Free;
    let limit = match state.mode {
        // If the solve updates T_max with F_n, only the sign of T_max matters.
        Mode::Sliding if state.t_max == 0.0 => state.sign * f64::EPSILON * problem.force,
        Mode::Sliding => state.t_max,
        _ => 0.0,
    };
    Contact {
        id: id.to_owned(),
        gap: kinematics.map_or(f64::INFINITY, |k| k.gap),
        friction,
        load,
        start: state.mode,
        state: InitialState {
            f_n: if touches { state.f_n } else { 0.0 },
            f_t: if touches { state.f_t } else { 0.0 },
            t_max: limit,
            slip: state.slipped(&problem.settings),
            ratio: if touches { state.ratio } else { 0.0 },
        },
    }
}

/// The settings that minor iterations depend on; a cycle stops the run, and settings for the bodies are left
/// out.
fn settings(of: &Settings) -> Settings {
    Settings {
        strategy: of.strategy,
        touch: of.touch,
        t_max: of.t_max,
        slip: of.slip,
        sticking: of.sticking,
        ties: of.ties,
        minors: of.minors,
        tolerance: of.tolerance,
        ..Settings::default()
    }
}

/// Node spacing that gives the file the scene's diagonal, the reference length of the tolerances.
fn spacing(problem: &InterfaceProblem) -> f64 {
    match problem.nodes.len() {
        1 => problem.length / 2.0,
        count => problem.length / (count - 1) as f64,
    }
}

type Parts = (Matrix, Vec<f64>, Vec<[f64; 2]>);

/// K, free displacements and loads; `None` if something is rigid.
fn stiffness(problem: &InterfaceProblem) -> Option<Parts> {
    let relation = &problem.relation;
    let (k, start, n) = (relation.stiffness, &relation.start, relation.start.len());
    let mut matrix: Vec<f64> = relation.response.iter().map(|r| r / k).collect();
    (0..n).for_each(|i| matrix[i * n + i] += 1.0);
    let mut dense = DenseFactors::new(n, n + 1).ok()?;
    dense.factor(&matrix);
    let mut solved = [start.as_slice(), &relation.response].concat();
    dense.solve(&mut solved).ok()?;
    let (c, k_columns) = solved.split_at(n);
    // (1 + R/k)⁻¹ = 1 + K/k; without springs nothing has to be removed.
    let largest = max_abs(k_columns) / k;
    if largest > SINGULAR {
        return None;
    }
    let free = problem
        .nodes
        .iter()
        .flat_map(|node| node.prescribed)
        .map(|p| -p);
    let loads = problem
        .nodes
        .iter()
        .enumerate()
        .map(|(place, node)| {
            [
                -c[2 * place] - node.state.f_n,
                -c[2 * place + 1] - node.state.f_t,
            ]
        })
        .collect();
    Some((
        Matrix::Stiffness(rows(n, |i, j| -k_columns[j * n + i])),
        free.collect(),
        loads,
    ))
}

/// W and free displacements, without loads; `None` if something can move freely.
fn compliance(problem: &InterfaceProblem) -> Option<(Vec<Vec<f64>>, Vec<f64>)> {
    let bodies = problem.relation.compliance()?;
    if max_abs(&bodies.w) * problem.spring > SINGULAR {
        return None;
    }
    let n = problem.relation.count();
    let w = rows(n, |i, j| bodies.w[j * n + i]);
    let acting: Vec<f64> = problem
        .nodes
        .iter()
        .flat_map(|node| [node.state.f_n, node.state.f_t])
        .collect();
    let prescribed = problem.nodes.iter().flat_map(|node| node.prescribed);
    let free = w
        .iter()
        .zip(bodies.still)
        .zip(prescribed)
        .map(|((row, still), p)| {
            let answer: f64 = row.iter().zip(&acting).map(|(w, f)| w * f).sum();
            still - answer - p
        });
    let free = free.collect();
    Some((w, free))
}

fn rows(n: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
    (0..n)
        .map(|i| (0..n).map(|j| entry(i, j)).collect())
        .collect()
}

/// Unique ids for the nodes: their names, with - in place of characters that ids cannot have.
fn ids(model: &Model, problem: &InterfaceProblem) -> Vec<String> {
    let mut ids: Vec<String> = Vec::new();
    for node in &problem.nodes {
        let name = limits::node_id_of(names::slave(model, node.slave), limits::NAME - 6);
        let taken =
            |id: &str| id.split('.').next() == Some("floor") || ids.iter().any(|other| other == id);
        let again = (2..).map(|k| format!("{name}-{k}"));
        let free = std::iter::once(name.clone())
            .chain(again)
            .find(|id| !taken(id));
        ids.push(free.unwrap_or_default());
    }
    ids
}

fn shortened(title: &str) -> String {
    let plain = title.chars().filter(|c| !c.is_control());
    if title.chars().count() <= limits::TITLE {
        return plain.collect();
    }
    plain.take(limits::TITLE - 1).chain(['…']).collect()
}

/// A comment in lines of [`WIDTH`], indented after the first.
fn wrapped(text: &str) -> impl Iterator<Item = String> {
    let lines = shown::wrap(text, WIDTH - 2).into_iter().enumerate();
    lines.map(|(k, line)| if k == 0 { line } else { format!("  {line}") })
}

/// Steps a file and its problem together until the minor iterations settle, cycle or fail. Returns the largest
/// relative difference of a force or length.
///
/// # Errors
/// If the two differ.
pub fn compared(problem: &InterfaceProblem, text: &str) -> Result<f64, Refusal> {
    let scene = Scene::from_text("exported scene", text, &[])?;
    let mut stepper = Stepper::new(Arc::new(scene.model));
    // For bonds, the file contains only the contact points, not the nodes behind them.
    let mut touching = problem.clone();
    let kinematics = touching
        .nodes
        .iter_mut()
        .filter_map(|node| node.kinematics.as_mut());
    kinematics.for_each(|over| over.bond = Bond::Hard);
    let mut trials = Trials::new(&touching).ok_or_else(|| refusal!("not enough memory"))?;
    let mut nodes = problem.states();
    let (mut worst, mut minor) = (0.0_f64, 0);
    let until = Until::end().minors(COMPARED.into()).past_failures();
    let end = stepper.drive(until, |stepper| {
        minor += 1;
        let event = stepper.event();
        let failed = matches!(event.outcome, Outcome::Failed(_));
        let wanted = trials.minor(&mut nodes, method(problem.settings.strategy));
        let Some((records, settled)) = wanted else {
            let singular = matches!(event.outcome, Outcome::Failed(Failure::Singular(_)));
            return ControlFlow::Break(if singular {
                Ok(())
            } else {
                Err(refusal!(
                    "minor iteration {minor} is singular in the original only"
                ))
            });
        };
        if event.nodes.len() != records.len() {
            return ControlFlow::Break(Err(refusal!("minor iteration {minor} cannot be solved")));
        }
        for (found, wanted) in event.nodes.iter().zip(&records) {
            let modes = |r: &ContactRecord| (r.decision.before, r.decision.next);
            worst = worst.max(difference(problem, found, wanted));
            if modes(found) != modes(wanted) || worst > CLOSE {
                return ControlFlow::Break(Err(refusal!(
                    "they differ in minor iteration {minor}, by {worst:.1e}"
                )));
            }
        }
        if settled || failed {
            ControlFlow::Break(Ok(()))
        } else {
            ControlFlow::Continue(())
        }
    });
    match end {
        RunEnd::Stopped(parted) => parted?,
        RunEnd::Finished => {
            return Err(refusal!(
                "its history ends before minor iteration {}",
                minor + 1
            ));
        }
        RunEnd::Spent | RunEnd::Failed(_) | RunEnd::Interrupted => {}
    }
    Ok(worst)
}

fn difference(problem: &InterfaceProblem, a: &ContactRecord, b: &ContactRecord) -> f64 {
    let off = |a: f64, b: f64, size: f64| {
        if a == b {
            0.0
        } else {
            (a - b).abs() / size.max(a.abs()).max(b.abs())
        }
    };
    [
        off(a.f_n, b.f_n, problem.force),
        off(a.f_t, b.f_t, problem.force),
        off(a.gap, b.gap, problem.length),
        off(a.slip, b.slip, problem.length),
    ]
    .into_iter()
    .fold(0.0, f64::max)
}
