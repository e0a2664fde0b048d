//! A frozen interface problem written out as a scene of its own: a condensed scene
//! ([`stickslip_scene::format::condensed`]) whose minor iterations are those of the problem.
//!
//! With springs of stiffness k the problem's relation is `ΔF = start + R (v − ΔF / k)` ([`InterfaceResponse`]); S* moves by
//! v + p relative to S, with what is prescribed, p. In the scene the slave node moves by u = −(v + p) over a floor at
//! rest, under F = F₀ + ΔF. Without the springs,
//!
//! ```text
//! K (u − free) = load + F      K = −(1 + R/k)⁻¹ R      load = −(1 + R/k)⁻¹ start − F₀      free = −p
//! u = free + W F               W = −(R⁻¹ + 1/k)        free = R⁻¹ start − W F₀ − p
//! ```
//!
//! The first exists unless something is rigid, the second unless something is loose; where both do, the first is
//! written. No file leaves here that has not been read back and stepped beside the problem ([`compared`]).

use crate::explain::core::Core;
use crate::explain::names;
use crate::explain::report;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip_core::contact::record::{ContactRecord, Forced};
use stickslip_core::interface::minor_history::Cycle;
use stickslip_core::interface::problem::{InterfaceProblem, ProblemNode};
use stickslip_core::interface::response::InterfaceResponse;
use stickslip_core::interface::trials::Trials;
use stickslip_core::model::InitialState;
use stickslip_core::model::{Bond, Mode, Model, Settings};
use stickslip_core::step::drive::{RunEnd, Until};
use stickslip_core::step::event::Outcome;
use stickslip_core::step::event::{Failure, Position};
use stickslip_core::step::stepper::Stepper;
use stickslip_core::strategy::method;
use stickslip_linalg::DenseFactors;
use stickslip_scene::format::condensed::{Contact, Matrix, Problem};
use stickslip_scene::format::{SceneError, read};
use stickslip_scene::siconos::Friction2d;
use stickslip_scene::{Scene, limits};

/// From this size on of the inverse (relative to the springs) that makes one of the two matrices, too many digits are
/// lost in taking the springs out.
const SINGULAR: f64 = 1e9;
/// Most minor iterations for which a file is stepped beside its problem.
const COMPARED: u32 = 200;
/// Forces and lengths of the two may differ by this, relatively: what taking the springs out may cost.
const CLOSE: f64 = 1e-6;
/// Width of a comment's lines.
const WIDTH: usize = 110;

/// Why a problem is not written as a scene.
#[derive(Debug, thiserror::Error)]
pub enum NoExport {
    /// The scene has no slave nodes.
    #[error("no slave node is over a surface, so there is no interface problem")]
    NoInterface,
    /// The equations of what is left out are singular.
    #[error("the problem of the nodes over a surface is singular")]
    Singular,
    /// The nodes whose forces a support carries.
    #[error(
        "no unknown moves {0} along the surface or across it: the support carries what acts there, and no matrix says so"
    )]
    EmbeddedFile(String),
    /// The matrix is larger than a scene file may be.
    #[error(
        "the matrix of {nodes} nodes takes {mebibytes} MiB, and a scene file can have {}; a core is smaller",
        read::FILE_BYTES >> 20
    )]
    Large {
        /// Nodes of the problem.
        nodes: usize,
        /// What its matrix would take, in units of 2^20 bytes.
        mebibytes: usize,
    },
    /// The form of Siconos has friction coefficients only.
    #[error("{0} has cohesion, and the form of Siconos knows none; a .ron file has it")]
    Cohesive(String),
    /// Why no matrix says what the scene says.
    #[error("the problem cannot be written as a matrix: {0}")]
    NoMatrix(String),
    /// The scene cycles, and otherwise than the problem.
    #[error("the core cycles with period {period}, and what would be written has {found}")]
    OtherCycle {
        /// Iterations of one period of the problem's cycle.
        period: u32,
        /// What the scene does.
        found: String,
    },
    /// The file does not do what the problem does.
    #[error(transparent)]
    Parted(#[from] Parted),
}

/// Where a file and the problem that it was made of part.
#[derive(Debug, thiserror::Error)]
pub enum Parted {
    /// The file that would be written is no sound scene.
    #[error(transparent)]
    Unsound(#[from] Box<SceneError>),
    /// There is no memory to compare.
    #[error("no memory")]
    Memory,
    /// The file's history ends in this minor iteration.
    #[error("it is done before minor iteration {0}")]
    Done(u32),
    /// Only the problem is singular in this minor iteration.
    #[error("minor iteration {0} is singular, and there it is not")]
    Singular(u32),
    /// Only the file is not solved in this minor iteration.
    #[error("minor iteration {0} cannot be solved")]
    Unsolved(u32),
    /// The scene's iteration is not the problem's.
    #[error("they part in minor iteration {minor}, by {by:.1e}")]
    Apart {
        /// Number of the minor iteration, from 1.
        minor: u32,
        /// How far they are apart, relatively.
        by: f64,
    },
}

/// Where a problem was frozen.
#[derive(Debug, Clone, PartialEq)]
pub struct Origin {
    /// Name of the scene, and what was changed in it: `PATH=VALUE`, or an intervention in words.
    pub scene: String,
    /// What was done before, as one would type it.
    pub changes: Vec<String>,
    /// The minor iteration after which it was, or before the first.
    pub at: Position,
    /// Load factor that it aims at.
    pub load: f64,
}

impl Origin {
    /// A scene as it stands, with what was set from outside.
    pub fn of(scene: &Scene, at: Position, load: f64) -> Self {
        Origin {
            scene: scene.name.clone(),
            changes: scene.overrides().map(|(p, v)| format!("{p}={v}")).collect(),
            at,
            load,
        }
    }

    /// In a sentence.
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
/// Why there is none.
pub fn core(
    model: &Model,
    origin: &Origin,
    cycle: &Cycle,
    core: &Core,
) -> Result<String, NoExport> {
    let of_core = Cycle {
        members: core
            .cycle
            .members
            .iter()
            .map(|(place, modes)| (core.problem.nodes[*place].slave, modes.clone()))
            .collect(),
        ..core.cycle.clone()
    };
    let named = |slave: usize| names::slave(model, slave);
    let names: Vec<&str> = core
        .problem
        .nodes
        .iter()
        .map(|node| named(node.slave))
        .collect();
    let head = [
        "The core of a cycle: the fewest nodes that still cycle when all others go on for ever with what they do.".to_owned(),
        origin.words(),
        format!("There {}.", report::cycle(model, cycle)),
        format!("Here {}.", report::cycle(model, &of_core)),
    ];
    let title = format!(
        "Core of {}: {}, period {}",
        origin.scene,
        names.join(", "),
        core.cycle.period
    );
    let text = text(model, &core.on_cycle(), title, head.into())?;
    match cycle_of(&text)? {
        Some(found) if same_cycle(&found, &core.cycle) => Ok(text),
        other => {
            let found = other.map_or("none".to_owned(), |c| format!("one of period {}", c.period));
            Err(NoExport::OtherCycle {
                period: core.cycle.period,
                found,
            })
        }
    }
}

/// The nodes of a problem that a file can have: those over a surface, and with something that moves.
pub fn writable(problem: &InterfaceProblem) -> Vec<usize> {
    let can = |place: &usize| problem.nodes[*place].moves() != [false; 2];
    (0..problem.nodes.len()).filter(can).collect()
}

/// The file of a whole frozen problem, its nodes as they stand, less those that no file can have ([`writable`]): these
/// neither push nor are pushed.
///
/// # Errors
/// Why there is none.
pub fn whole(
    model: &Model,
    origin: &Origin,
    problem: &InterfaceProblem,
) -> Result<String, NoExport> {
    let here = writable(problem);
    if here.is_empty() {
        return Err(NoExport::NoInterface);
    }
    let mut head = vec![
        "The frozen interface problem of a major iteration: what its minor iterations know of the bodies.".to_owned(),
        origin.words(),
    ];
    let gone = (0..problem.nodes.len()).filter(|place| !here.contains(place));
    let gone: Vec<&str> = gone
        .map(|place| names::slave(model, problem.nodes[place].slave))
        .collect();
    if !gone.is_empty() {
        head.push(format!(
            "Left out, since past the ends of all surfaces, or held like what they lie on: {}.",
            gone.join(", ")
        ));
    }
    let problem = problem.reduced(&here).ok_or(NoExport::Singular)?;
    let title = format!(
        "Interface of {}: {}",
        origin.scene,
        names::position(origin.at)
    );
    text(model, &problem, title, head)
}

/// The file: stiffness where that exists and steps as the problem does, else compliance.
fn text(
    model: &Model,
    problem: &InterfaceProblem,
    title: String,
    mut head: Vec<String>,
) -> Result<String, NoExport> {
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
        ("compliance", compliance(problem)),
    ] {
        let Some((matrix, free, loads)) = made else {
            let why = if form == "stiffness" {
                "some motion is held rigidly"
            } else {
                "some motion is resisted by nothing"
            };
            refused.push(format!("no {form}: {why}"));
            continue;
        };
        let written = Problem {
            title: shortened(&title),
            about: String::new(),
            contacts: (0..count)
                .map(|place| contact(problem, place, &ids[place], loads[place]))
                .collect(),
            matrix,
            free,
            spacing: Some(spacing(problem)),
            history: Default::default(),
            settings: settings(&problem.settings),
        };
        let text = written.text(&comments);
        if text.len() > read::FILE_BYTES {
            return Err(NoExport::Large {
                nodes: count,
                mebibytes: text.len() >> 20,
            });
        }
        match compared(problem, &text) {
            Ok(_) => return Ok(text),
            Err(why) => refused.push(format!("its {form} does not step as it does: {why}")),
        }
    }
    Err(NoExport::NoMatrix(refused.join("; ")))
}

/// A frozen problem in the form of Siconos, its nodes as they stand, less those that no file can have ([`writable`]):
/// `q` has the gaps, and what was slipped before, so that `u` are the gaps and the slips of the whole increment.
///
/// # Errors
/// Why there is none: that form knows a compliance only, and no cohesion.
pub fn siconos(model: &Model, problem: &InterfaceProblem) -> Result<Friction2d, NoExport> {
    let Total { slaves, w, q } = total(model, problem)?;
    let of = |slave: &usize| problem.nodes.iter().find(|node| node.slave == *slave);
    let nodes = || slaves.iter().filter_map(of);
    if let Some(node) = nodes().find(|node| node.friction.cohesion != 0.0) {
        let name = names::slave(model, node.slave).to_owned();
        return Err(NoExport::Cohesive(name));
    }
    let mu = nodes().map(|node| node.friction.coefficient()).collect();
    Ok(Friction2d { w, q, mu })
}

/// A problem in the total forces of its nodes: (gap, u) = W f + q, n and t of each after the other, with the slave's motion u
/// along t against its master since the increment began.
pub struct Total {
    /// Slave numbers of the nodes.
    pub slaves: Vec<usize>,
    /// W, row by row (length by force).
    pub w: Vec<Vec<f64>>,
    /// Gaps and motions without any force (length).
    pub q: Vec<f64>,
}

/// A problem in total forces.
///
/// # Errors
/// Why there is none: some motion is resisted by nothing, or a support carries what acts on a node.
pub fn total(model: &Model, problem: &InterfaceProblem) -> Result<Total, NoExport> {
    let here = writable(problem);
    if here.is_empty() {
        return Err(NoExport::NoInterface);
    }
    let problem = problem.reduced(&here).ok_or(NoExport::Singular)?;
    unsupported(model, &problem)?;
    let none = || NoExport::NoMatrix("some motion is resisted by nothing".to_owned());
    let (matrix, mut q, _) = compliance(&problem).ok_or_else(none)?;
    let Matrix::Compliance(w) = matrix else {
        return Err(none());
    };
    for (pair, node) in q.chunks_exact_mut(2).zip(&problem.nodes) {
        pair[0] += node.kinematics.map_or(0.0, |k| k.gap);
        // Slip is that of the master against the slave; u is the slave's.
        pair[1] -= node.state.slipped(&problem.settings);
    }
    let slaves = problem.nodes.iter().map(|node| node.slave).collect();
    Ok(Total { slaves, w, q })
}

/// Refuses nodes whose forces a support carries.
fn unsupported(model: &Model, problem: &InterfaceProblem) -> Result<(), NoExport> {
    let carried: Vec<&str> = problem
        .nodes
        .iter()
        .filter(|node| node.moves() != [true; 2])
        .map(|node| names::slave(model, node.slave))
        .collect();
    match carried.is_empty() {
        true => Ok(()),
        false => Err(NoExport::EmbeddedFile(carried.join(", "))),
    }
}

/// A contact as it stands.
fn contact(problem: &InterfaceProblem, place: usize, id: &str, load: [f64; 2]) -> Contact {
    let ProblemNode {
        kinematics,
        friction,
        state,
        ..
    } = problem.nodes[place];
    let touches = state.mode != Mode::Free;
    let limit = match state.mode {
        // Where T_max follows F_n in the solve, only its sign is looked at.
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

/// What the minor iterations look at of the settings; a cycle stops, and what concerns the bodies is left out.
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

/// The scene's diagonal is the length that tolerances are parts of, in the file too.
fn spacing(problem: &InterfaceProblem) -> f64 {
    match problem.nodes.len() {
        1 => problem.length / 2.0,
        count => problem.length / (count - 1) as f64,
    }
}

type Parts = (Matrix, Vec<f64>, Vec<[f64; 2]>);

/// K, free and loads; `None` if something is rigid.
fn stiffness(problem: &InterfaceProblem) -> Option<Parts> {
    let InterfaceResponse {
        stiffness: k,
        start,
        response,
    } = &problem.relation;
    let n = start.len();
    let mut matrix: Vec<f64> = response.iter().map(|r| r / k).collect();
    (0..n).for_each(|i| matrix[i * n + i] += 1.0);
    let solved = solved(&matrix, start.iter().chain(response).copied().collect())?;
    let (c, k_columns) = solved.split_at(n);
    // (1 + R/k)⁻¹ = 1 + K/k; without springs nothing is taken out.
    let largest = k_columns.iter().fold(0.0_f64, |m, x| m.max(x.abs())) / k;
    if largest > SINGULAR {
        return None;
    }
    let free = problem
        .nodes
        .iter()
        .flat_map(|node| node.prescribed)
        .map(|p| -p);
    let load = |(place, node): (usize, &ProblemNode)| {
        [
            -c[2 * place] - node.state.f_n,
            -c[2 * place + 1] - node.state.f_t,
        ]
    };
    let loads = problem.nodes.iter().enumerate().map(load).collect();
    Some((
        Matrix::Stiffness(rows(n, |i, j| -k_columns[j * n + i])),
        free.collect(),
        loads,
    ))
}

/// W, free and no loads; `None` if something is loose.
fn compliance(problem: &InterfaceProblem) -> Option<Parts> {
    let InterfaceResponse {
        stiffness: k,
        start,
        response,
    } = &problem.relation;
    let n = start.len();
    let mut right = start.clone();
    right.extend((0..n * n).map(|at| if at / n == at % n { 1.0 } else { 0.0 }));
    let solved = solved(response, right)?;
    let (still, inverse) = solved.split_at(n);
    let largest = inverse.iter().fold(0.0_f64, |m, x| m.max(x.abs())) * problem.spring;
    if largest > SINGULAR {
        return None;
    }
    let w = rows(n, |i, j| {
        -inverse[j * n + i] - if i == j { 1.0 / k } else { 0.0 }
    });
    let acting: Vec<f64> = problem
        .nodes
        .iter()
        .flat_map(|node| [node.state.f_n, node.state.f_t])
        .collect();
    let prescribed = problem.nodes.iter().flat_map(|node| node.prescribed);
    let free = w
        .iter()
        .zip(still)
        .zip(prescribed)
        .map(|((row, still), p)| {
            let answer: f64 = row.iter().zip(&acting).map(|(w, f)| w * f).sum();
            still - answer - p
        });
    let free = free.collect();
    Some((
        Matrix::Compliance(w),
        free,
        vec![[0.0; 2]; problem.nodes.len()],
    ))
}

/// X of A X = B, all column by column.
fn solved(a: &[f64], mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = a.len().isqrt();
    let mut dense = DenseFactors::new(n, b.len() / n).ok()?;
    dense.factor(a);
    dense.solve(&mut b).ok()?;
    Some(b)
}

fn rows(n: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
    (0..n)
        .map(|i| (0..n).map(|j| entry(i, j)).collect())
        .collect()
}

/// Ids for the nodes: their names, with - for what no id may have in it, each once.
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

/// A comment in lines of [`WIDTH`], broken at blanks.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        let line = &mut lines[last];
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > WIDTH {
            lines.push(format!("  {word}"));
        } else {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines
}

/// Steps a file beside the problem that it was made of, minor iteration by minor iteration, until the minors settle,
/// cycle or fail. Returns the largest difference of a force or a length, relative to the problem's sizes of either.
///
/// # Errors
/// Where the two part.
pub fn compared(problem: &InterfaceProblem, text: &str) -> Result<f64, Parted> {
    let scene = Scene::from_text("what would be written", text, &[]).map_err(Box::new)?;
    let mut stepper = Stepper::new(Arc::new(scene.model));
    // What is written knows the touching points of bonds only, not the nodes behind them.
    let mut touching = problem.clone();
    let kinematics = touching
        .nodes
        .iter_mut()
        .filter_map(|node| node.kinematics.as_mut());
    kinematics.for_each(|over| over.bond = Bond::Hard);
    let mut trials = Trials::new(&touching).ok_or(Parted::Memory)?;
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
                Err(Parted::Singular(minor))
            });
        };
        if event.nodes.len() != records.len() {
            return ControlFlow::Break(Err(Parted::Unsolved(minor)));
        }
        for (found, wanted) in event.nodes.iter().zip(&records) {
            let modes = |r: &ContactRecord| (r.decision.before, r.decision.next);
            worst = worst.max(difference(problem, found, wanted));
            if modes(found) != modes(wanted) || worst > CLOSE {
                return ControlFlow::Break(Err(Parted::Apart { minor, by: worst }));
            }
        }
        match settled || failed {
            true => ControlFlow::Break(Ok(())),
            false => ControlFlow::Continue(()),
        }
    });
    match end {
        RunEnd::Stopped(parted) => parted?,
        RunEnd::Finished => return Err(Parted::Done(minor + 1)),
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

/// The cycle that a scene's first minor iterations close; `None` if they end otherwise.
fn cycle_of(text: &str) -> Result<Option<Cycle>, Parted> {
    let scene = Scene::from_text("what would be written", text, &[]).map_err(Box::new)?;
    let mut stepper = Stepper::new(Arc::new(scene.model));
    while let Some(event) = stepper.step() {
        match &event.outcome {
            Outcome::Minor => {}
            Outcome::Failed(Failure::Cycle(cycle)) => return Ok(Some(cycle.clone())),
            _ => return Ok(None),
        }
    }
    Ok(None)
}

/// Same period, members and patterns, wherever in the round each begins.
fn same_cycle(a: &Cycle, b: &Cycle) -> bool {
    let period = a.period as usize;
    let turned = |by: usize| {
        a.members
            .iter()
            .zip(&b.members)
            .all(|((i, ours), (j, theirs))| {
                i == j && (0..period).all(|k| ours[(k + by) % period] == theirs[k])
            })
    };
    a.period == b.period && a.members.len() == b.members.len() && (0..period).any(turned)
}
