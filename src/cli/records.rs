//! The records that `--json` writes. The page `json` lists their fields from the same text.
//!
//! The first field of each subcommand's record is its schema, such as `stickslip-run-1`. The number rises when a field is renamed,
//! removed or changes its meaning; new fields do not change it.

use serde::Serialize;
use stickslip_core::{Failure, Model, Position};
use stickslip_debugger::explain::failures;

/// The type of a field, as the page names it.
trait JsonType {
    fn name() -> String;
}

/// The types with a fixed name.
macro_rules! named {
    ($($type:ty: $name:literal),* $(,)?) => {
        $(impl JsonType for $type {
            fn name() -> String {
                $name.into()
            }
        })*
    };
}

named! {
    bool: "boolean", u8: "integer", u32: "integer", u64: "integer", usize: "integer", f64: "number",
    String: "string", &'static str: "string",
}

impl<T: JsonType> JsonType for Option<T> {
    fn name() -> String {
        format!("{} or null", T::name())
    }
}

impl<T: JsonType> JsonType for Vec<T> {
    fn name() -> String {
        format!("list of {}", T::name())
    }
}

/// The fields of a record: name, type, meaning.
struct Table {
    title: &'static str,
    fields: Vec<(&'static str, String, String)>,
}

/// Declares records, their JSON type, and the tables of their fields.
macro_rules! records {
    ($(
        $(#[doc = $about:literal])*
        $record:ident $title:literal {
            $($(#[doc = $meaning:literal])+ $field:ident: $type:ty,)+
        }
    )+) => {
        $(
            $(#[doc = $about])*
            #[derive(Debug, Clone, Default, Serialize)]
            pub struct $record {
                $($(#[doc = $meaning])+ pub $field: $type,)+
            }

            impl JsonType for $record {
                fn name() -> String {
                    format!("`{}`", $title)
                }
            }
        )+

        /// All records, in the order of the page.
        fn all() -> Vec<Table> {
            vec![$(Table {
                title: $title,
                fields: vec![$((
                    stringify!($field),
                    <$type as JsonType>::name(),
                    [$($meaning),+].concat().trim().to_owned(),
                )),+],
            }),+]
        }
    };
}

records! {
    /// Result of `stickslip run`.
    RunRecord "run" {
        /// `stickslip-run-1`
        schema: &'static str,
        /// Name of the scene
        scene: String,
        /// `finished`, `failed`, `interrupted`, or `incomplete`: an equilibrium path reached its maximum length before its last load
        outcome: &'static str,
        /// Exit code of the program
        exit_code: u8,
        /// How the run ended, as the text output has it; null if the load was reached
        message: Option<String>,
        /// Accepted increments
        increments: u64,
        /// Major iterations of the accepted increments
        majors: u64,
        /// All minor iterations
        minors: u64,
        /// Load factor of the last accepted state
        load: f64,
        /// Why and where the run failed
        failure: Option<FailureRecord>,
        /// Causes of the failure, as lines of text
        why: Vec<String>,
        /// The first remedy that a trial showed to work; null if none did
        works: Option<String>,
        /// Increments that were accepted with a fallback
        fallbacks: Vec<FallbackRecord>,
        /// Loads of increments that jumped to another branch of equilibrium
        jumps: Vec<f64>,
        /// Increments that end a damped motion; the friction law holds for each step of the motion, not from its start to its end
        motions: Vec<MotionRecord>,
        /// Loads at which equilibrium became unstable
        unstable: Vec<f64>,
        /// Stability of the accepted states; empty without `--stability`
        stability: Vec<StabilityRecord>,
        /// Warnings
        warnings: Vec<String>,
        /// Numbers of all increments that were accepted with a warning; `warnings` describes the first ten
        doubtful: Vec<u32>,
        /// Notes, also those that `--quiet` does not print
        notes: Vec<String>,
        /// Monitors of the last accepted increment
        monitors: Vec<MonitorRecord>,
        /// Slave nodes in the last accepted increment
        slaves: Vec<SlaveRecord>,
    }

    /// Why and where an increment failed.
    FailureRecord "failure" {
        /// One of the kinds below
        kind: &'static str,
        /// Description
        words: String,
        /// Increment, from 1
        increment: u32,
        /// Attempt at this increment, from 1
        attempt: u32,
        /// Major iteration, from 1
        major: u32,
        /// Minor iteration, from 1
        minor: u32,
        /// Load factor at the end of the failed increment
        load: f64,
    }

    /// An increment that was accepted with a fallback.
    FallbackRecord "fallback" {
        /// The fallback (page `strategies`)
        fallback: &'static str,
        /// Load factor
        load: f64,
    }

    /// An increment that ends a damped motion (page `jumps`).
    MotionRecord "motion" {
        /// Increment, from 1
        increment: u32,
        /// Load factor
        load: f64,
        /// Load factor of the equilibrium from which the motion started
        from: f64,
        /// Number of steps
        steps: u32,
        /// Work of the viscosity
        dissipated: f64,
    }

    /// The start of a range of loads with the same stability.
    StabilityRecord "stability" {
        /// First load factor of the range
        load: f64,
        /// `stable`, `unstable(N)`, `divergence` or `not known` (page `jumps`)
        stability: String,
    }

    /// A monitor.
    MonitorRecord "monitor" {
        /// Name
        name: String,
        /// Value
        value: f64,
    }

    /// A slave node.
    SlaveRecord "slave" {
        /// Name of the node
        node: String,
        /// `free`, `sliding` or `fixed`
        mode: &'static str,
        /// Gap; negative is penetration
        gap: f64,
        /// Normal force; compression positive
        f_n: f64,
        /// Tangential force
        f_t: f64,
    }

    /// Result of `stickslip remedies`.
    RemediesRecord "remedies" {
        /// `stickslip-remedies-1`
        schema: &'static str,
        /// Name of the scene
        scene: String,
        /// Exit code of the program
        exit_code: u8,
        /// The first failure; null if the scene converges
        failure: Option<FailureRecord>,
        /// Causes of the failure, as lines of text
        why: Vec<String>,
        /// Remedies, best first; those that were not tried come last
        remedies: Vec<RemedyRecord>,
    }

    /// A remedy.
    RemedyRecord "remedy" {
        /// Name
        remedy: String,
        /// What to type in the debugger, or the option of `run`
        command: String,
        /// Whether it was tried; if not, all that follows is null
        tried: bool,
        /// `converged`, `law-violated`, `failed`, or `limit`: the limit of minor iterations was reached
        outcome: Option<&'static str>,
        /// Kind of the failure, if it failed
        failure: Option<&'static str>,
        /// Law that the accepted state violates, if it does
        law: Option<&'static str>,
        /// Minor iterations
        minors: Option<u32>,
        /// Major iterations
        majors: Option<u32>,
        /// Factorizations of the bodies
        factorizations: Option<u32>,
        /// Time of the solves
        seconds: Option<f64>,
        /// Largest penetration, or gap with a force across it, in the accepted state
        penetration: Option<f64>,
        /// Largest tension in the accepted state
        tension: Option<f64>,
        /// Largest tangential force beyond the friction limit in the accepted state
        shear: Option<f64>,
        /// Relative residual in the accepted state
        residual: Option<f64>,
        /// Held nodes whose mode Table 2 would change in the accepted state
        held: Option<usize>,
    }

    /// Result of `stickslip check` on a three-dimensional deck.
    DeckRecord "check of a deck in space" {
        /// `stickslip-check-deck-1`
        schema: &'static str,
        /// Name of the deck
        deck: String,
        /// Exit code of the program
        exit_code: u8,
        /// Nodes
        nodes: usize,
        /// Elements
        elements: usize,
        /// Contact pairs
        pairs: usize,
        /// Ties
        ties: usize,
        /// Steps
        steps: usize,
        /// Notes
        notes: Vec<String>,
        /// Warnings: causes and cures that the rules find
        warnings: Vec<String>,
    }

    /// Result of `stickslip check`.
    CheckRecord "check" {
        /// `stickslip-check-1`
        schema: &'static str,
        /// Name of the scene
        scene: String,
        /// Exit code of the program
        exit_code: u8,
        /// Nodes
        nodes: usize,
        /// Nodes on bodies
        nodes_on_bodies: usize,
        /// Unknowns of a minor iteration
        unknowns: usize,
        /// Unknown displacements in x and y
        translations: usize,
        /// Unknown rotations
        rotations: usize,
        /// Unknown shear forces
        shear_forces: usize,
        /// Unknown forces on bodies given by a compliance
        body_forces: usize,
        /// Unknown interface forces
        interface_forces: usize,
        /// Restrained degrees of freedom
        restrained: usize,
        /// Bodies, one line each
        bodies: Vec<String>,
        /// Surfaces, one line each
        surfaces: Vec<String>,
        /// Slave nodes and their initial modes
        slaves: String,
        /// Contact laws other than hard contact
        laws: Vec<String>,
        /// Nodes on the axis of revolution that may leave it
        axis: Vec<String>,
        /// Initial gaps, one line per surface
        gaps: Vec<String>,
        /// Increments and their path
        history: String,
        /// Estimated cost of each solver, the selected one first
        solvers: Vec<String>,
        /// Features that the scene does not use
        without: Vec<String>,
        /// Notes
        notes: Vec<String>,
        /// Warnings
        warnings: Vec<String>,
    }

    /// Result of `stickslip audit`.
    AuditRecord "audit" {
        /// `stickslip-audit-1`
        schema: &'static str,
        /// Exit code of the program
        exit_code: u8,
        /// One entry per scene or snapshot
        histories: Vec<HistoryRecord>,
    }

    /// The audit of a scene or a snapshot.
    HistoryRecord "history" {
        /// Name of the scene or snapshot
        name: String,
        /// `finished`, `failed` or `interrupted`
        outcome: &'static str,
        /// Whether a law is violated in an increment that is not marked
        violated: bool,
        /// Accepted increments
        increments: u32,
        /// Increments that were accepted with a mark
        marked: u32,
        /// The worst finding for each law that applied, in increments that are not marked
        findings: Vec<FindingRecord>,
        /// The same in marked increments; does not count as a violation
        marked_findings: Vec<FindingRecord>,
        /// Where friction produced the most work; does not count as a violation
        work: Option<FindingRecord>,
        /// The smallest principal stretch of the solids
        stretch: Option<StretchRecord>,
        /// The first point outside the range of its material law
        outside_range: Option<StretchRecord>,
        /// The master node deepest inside a body
        master_inside: Option<InsideRecord>,
        /// Why the history ended early
        failure: Option<FailureRecord>,
    }

    /// A finding of the judge.
    FindingRecord "finding" {
        /// The law (page `verification`)
        law: &'static str,
        /// Whether the amount exceeds its tolerance
        violated: bool,
        /// Increment, from 1
        increment: u32,
        /// Load factor
        load: f64,
        /// Name of the slave node; null if the finding concerns the whole scene
        node: Option<String>,
        /// Amount of the violation, relative to the scene's length or force
        amount: f64,
        /// Tolerance of the amount
        allowed: f64,
    }

    /// A point of a solid.
    StretchRecord "stretch" {
        /// Increment, from 1
        increment: u32,
        /// Load factor
        load: f64,
        /// Name of the body
        body: String,
        /// Number of the element, from 1
        element: usize,
        /// Smallest principal stretch
        stretch: f64,
        /// det F
        determinant: f64,
    }

    /// A master node inside a body.
    InsideRecord "inside" {
        /// Increment, from 1
        increment: u32,
        /// Load factor
        load: f64,
        /// Name of the master node
        node: String,
        /// Name of the body
        body: String,
        /// Distance from the body's outline
        depth: f64,
    }

    /// Result of `stickslip replay`.
    ReplayRecord "replay" {
        /// `stickslip-replay-1`
        schema: &'static str,
        /// Exit code of the program
        exit_code: u8,
        /// One entry per snapshot
        snapshots: Vec<ReplayedRecord>,
    }

    /// A snapshot that was recomputed.
    ReplayedRecord "snapshot" {
        /// The file
        file: String,
        /// `equal`, `differs`, `not-repeatable`: its steps cannot be repeated, or `unreadable`
        outcome: &'static str,
        /// What went wrong, if the snapshot could not be compared
        message: Option<String>,
        /// Name of the scene; null for unreadable files
        scene: Option<String>,
        /// Position of the recorded state: increment, from 1
        increment: Option<u32>,
        /// Attempt, from 1
        attempt: Option<u32>,
        /// Major iteration, from 1
        major: Option<u32>,
        /// Minor iteration, from 1
        minor: Option<u32>,
        /// Minor iterations that were recomputed; null if the snapshot could not be compared
        minors: Option<u64>,
        /// Number of differences
        differences: usize,
        /// The first 100 differences
        first: Vec<DifferenceRecord>,
        /// Time of the recomputation and the comparison
        seconds: f64,
    }

    /// A difference between the recorded and the recomputed state.
    DifferenceRecord "difference" {
        /// Name of the node; null if the difference concerns the whole state
        node: Option<String>,
        /// What differs
        field: String,
        /// Recorded value, as text
        expected: String,
        /// Recomputed value, as text
        found: String,
        /// Size of the difference; null for values that are not numbers
        apart: Option<f64>,
        /// Tolerance of the difference
        allowed: Option<f64>,
    }
}

impl FailureRecord {
    /// A failure at a position; `load` is the target of its increment.
    pub fn new(model: &Model, at: Position, load: f64, failure: &Failure) -> FailureRecord {
        let words = failures::describe(model, failure);
        FailureRecord::reported(FailureKind::from_failure(failure), words, at, load)
    }

    /// A failure that only its words describe.
    pub fn reported(kind: FailureKind, words: String, at: Position, load: f64) -> FailureRecord {
        FailureRecord {
            kind: kind.word(),
            words,
            increment: at.increment,
            attempt: at.attempt,
            major: at.major,
            minor: at.minor,
            load,
        }
    }
}

/// Defines the kinds of failure, each with its word and what it means.
macro_rules! failure_kinds {
    ($($kind:ident $word:literal $meaning:literal $($failure:pat)?,)*) => {
        stickslip_core::words! {
            /// Kinds of failure.
            pub enum FailureKind, ALL, word {
                $($kind $word,)*
            }
        }

        impl FailureKind {
            /// The kind of a failure.
            pub fn from_failure(failure: &Failure) -> FailureKind {
                match failure {
                    $($($failure => FailureKind::$kind,)?)*
                }
            }

            fn meaning(self) -> &'static str {
                match self {
                    $(FailureKind::$kind => $meaning),*
                }
            }
        }
    };
}

failure_kinds! {
    Cycle "cycle" "the minor iterations cycle" Failure::Cycle(_),
    MinorLimit "minor-limit" "the minor iterations reached their limit" Failure::MinorLimit { .. },
    MajorLimit "major-limit" "the major iterations reached their limit" Failure::MajorLimit { .. },
    MajorCycle "major-cycle" "the major iterations cycle" Failure::MajorCycle(_),
    Singular "singular" "the equations have no unique solution" Failure::Singular(_),
    RoundOff "round-off" "round-off exceeds the loads" Failure::RoundOff { .. },
    PathReversal "path-reversal" "the path would return to where it came from" Failure::PathReversal,
    ZeroMeasure "zero-measure" "the measure of the path does not change" Failure::ZeroMeasure,
    BranchJump "branch-jump" "the increment may have jumped to another branch" Failure::BranchJump { .. },
    NoRest "no-rest" "a damped motion does not settle" Failure::NoRest { .. },
    Diverged "diverged" "residual or displacements grew without bound" Failure::Diverged { .. },
    NoConsistentState "no-consistent-state" "no combination of modes is consistent" Failure::NoAnswer { .. },
    LadderEnded "ladder-ended" "no strategy of the ladder succeeded" Failure::LadderEnded { .. },
    NotFound "not-found" "a search found no consistent state" Failure::NotFound(_),
    LawViolated "law-violated" "the converged state violates a law" Failure::Refused(_),
    InvertedElement "inverted-element" "an element is inverted" Failure::Inverted(_),
    CutTooOften "cut-too-often" "the increment was cut too often at one node" Failure::CutTooOften { .. },
    OverConstrained "over-constrained" "node and surface cannot move apart" Failure::OverConstrained { .. },
    Reported "reported" "an attached solver reported the failure" Failure::Reported { .. },
    IterationLimit "iteration-limit" "an attached solver reached `--max-iterations` in an increment",
    SolverLost "solver-lost" "an attached solver cannot continue",
}

/// All records with their fields, and the kinds of failure, as Markdown.
pub fn markdown() -> String {
    let mut text = String::new();
    for Table { title, fields } in all() {
        text += &format!("## {title}\n\n| field | type | meaning |\n|---|---|---|\n");
        for (field, kind, meaning) in fields {
            text += &format!("| `{field}` | {kind} | {meaning} |\n");
        }
        text.push('\n');
    }
    text += "## Kinds of failure\n\n| kind | meaning |\n|---|---|\n";
    for kind in FailureKind::ALL {
        text += &format!("| `{}` | {} |\n", kind.word(), kind.meaning());
    }
    text
}
