//! Quantities by name, for a lesson's questions and, in braces, its texts.
//!
//! At a slave node, `NAME NODE`: `gap`, `F_n`, `F_t`, `T_max`, `slip` (of the minor iteration), `lag` (the
//! factor by which the error of a lagged T_max changes in the next one), `v_n`, `v_t`, `W_nn`, `W_nt`, `W_tt` and `rho` (of
//! the condensed problem, see [`super::frame_values::CondensedNode`]), `leaves` (load at which it leaves its mode), `mode` (of this iteration), `next` (of
//! the next one), `reason` (the decision in a sentence). Of the solve: `load`, `increment` (its size), `angle`,
//! `tan` and `cohesion` (of the first slave node), `answers` (number of consistent states in the census),
//! `minors` (minor iterations to the end of this increment), `majors` (all its major iterations), `residual`
//! (the latest, relative), `sliding` (number of nodes that slide next), `period` (of the cycle that ends the increment), `verdict` (the judge's finding in
//! the last accepted increment, in a sentence). Of a run in the lesson's chart, `NAME PATH=VALUE …`: `error`
//! (relative) and `factorizations`. In addition, `right` is the right answer of the previous question, and `key
//! ACTION` the key of an action.

use super::frame_values::FrameValues;
use crate::RoundOff;
use crate::action::{self, Context};
use crate::explain::judged;
use crate::explain::report;
use crate::refusal::{Refusal, refusal};
use stickslip_core::Mode;
use stickslip_scene::format::error::did_you_mean;
use stickslip_scene::sig4;

/// Why a quantity has no number.
const NO_NUMBER: &str = "this is not a number";

/// A quantity that the solver can provide.
#[derive(Debug, Clone, PartialEq)]
pub enum LessonQuantity {
    /// A quantity of a slave node (by slave number).
    Of(NodeQuantity, usize),
    /// A quantity of the solve.
    Solve(SolveQuantity),
    /// A quantity of the run of the lesson's chart with these settings.
    Run(RunQuantity, Vec<(String, String)>),
    /// A literal number.
    Written(f64),
    /// The right answer of the question.
    Right,
    /// The key of an action.
    Key(&'static str),
}

use LessonQuantity::*;

stickslip_core::words! {
    /// Quantities of a slave node.
    pub enum NodeQuantity, ALL, word {
        /// Gap (length), negative for penetration.
        Gap "gap",
        /// Normal force; compression is positive.
        Fn "F_n",
        /// Tangential force.
        Ft "F_t",
        /// The friction bound T_max, force.
        TMax "T_max",
        /// Slip, length.
        Slip "slip",
        /// Factor by which the error of a lagged T_max changes in the next solve.
        Lag "lag",
        /// Motion of S* relative to the node along n if all nodes were free, length.
        FreeN "v_n",
        /// The same along t.
        FreeT "v_t",
        /// Compliance: motion along n per F_n on the node, length per force.
        Wnn "W_nn",
        /// Motion along n per F_t, and along t per F_n.
        Wnt "W_nt",
        /// Motion along t per F_t.
        Wtt "W_tt",
        /// ρ, the ratio of tangential to normal travel of a node that touches.
        Ratio "rho",
        /// Load factor at which the node leaves its mode.
        Leaves "leaves",
        /// Mode of the shown iteration.
        Mode "mode",
        /// Mode of the next iteration.
        Next "next",
        /// The cell of Table 2 that applied, in words.
        Reason "reason",
    }
}

stickslip_core::words! {
    /// Quantities of the solve.
    pub enum SolveQuantity, ALL, word {
        /// The load factor λ.
        Load "load",
        /// Size of the increment, as a load factor.
        Increment "increment",
        /// Angle of friction, degrees.
        Angle "angle",
        /// Coefficient of friction.
        Tan "tan",
        /// Cohesion, force.
        Cohesion "cohesion",
        /// Number of consistent states.
        Answers "answers",
        /// Minor iterations until the increment ends.
        Minors "minors",
        /// Period of the cycle.
        Period "period",
        /// Major iterations of this increment.
        Majors "majors",
        /// The latest relative residual.
        Residual "residual",
        /// Number of sliding slave nodes.
        Sliding "sliding",
        /// The judge's finding, in a sentence.
        Verdict "verdict",
    }
}

stickslip_core::words! {
    /// Quantities of a run in a chart.
    pub enum RunQuantity, ALL, word {
        /// Relative error.
        Error "error",
        /// Number of factorizations.
        Factorizations "factorizations",
    }
}

impl LessonQuantity {
    /// Parses a quantity: `F_n beam.end`, `load`.
    ///
    /// # Errors
    /// If the quantity or its node is unknown.
    pub fn read(text: &str, context: &Context) -> Result<LessonQuantity, Refusal> {
        let (word, rest) = text.split_once(' ').unwrap_or((text, ""));
        let rest = rest.trim();
        if let Some(nodal) = NodeQuantity::from_word(word) {
            return match rest {
                "" => Err(refusal!("{word} needs a node: {{{word} NODE}}")),
                node => Ok(Of(nodal, action::exact(node, context)?)),
            };
        }
        if let Some(of) = RunQuantity::from_word(word) {
            return Ok(Run(of, settings(rest)?));
        }
        let whole = SolveQuantity::from_word(word);
        match (word, whole, rest) {
            ("key", _, action) => {
                let key = action::named(action).and_then(|entry| entry.keys.first());
                key.map(|key| Key(key))
                    .ok_or_else(|| refusal!("{action:?} is not an action with a key"))
            }
            ("right", _, "") => Ok(Right),
            (_, Some(whole), "") => Ok(Solve(whole)),
            (_, Some(_), _) => Err(refusal!("{word} does not take a node; write {word} alone")),
            _ => Err(unknown(word)),
        }
    }

    /// Its value, if it is a number.
    ///
    /// # Errors
    /// If it is not a number or not known.
    pub fn number(&self, look: &FrameValues) -> Result<f64, Refusal> {
        match self {
            Of(nodal, slave) => nodal.number(*slave, look),
            Solve(whole) => whole_number(*whole, look),
            Run(of, settings) => {
                let run = look.runs()?.of(settings)?;
                match of {
                    RunQuantity::Error => {
                        run.error.ok_or_else(|| refusal!("this run has no error"))
                    }
                    RunQuantity::Factorizations => Ok(run.factorizations as f64),
                }
            }
            Written(number) => Ok(*number),
            Right | Key(_) => Err(Refusal::new(NO_NUMBER)),
        }
    }

    /// Whether the quantity is a number.
    pub fn is_number(&self) -> bool {
        match self {
            Of(nodal, _) => !matches!(
                nodal,
                NodeQuantity::Mode | NodeQuantity::Next | NodeQuantity::Reason
            ),
            Solve(whole) => *whole != SolveQuantity::Verdict,
            Run(..) | Written(_) => true,
            Right | Key(_) => false,
        }
    }

    /// Whether the quantity needs more than the shown state: the decision, the verdict, or later iterations.
    /// Hints cannot contain it.
    fn looks_ahead(&self) -> bool {
        match self {
            Right => true,
            Of(of, _) => matches!(
                of,
                NodeQuantity::Lag
                    | NodeQuantity::Leaves
                    | NodeQuantity::Next
                    | NodeQuantity::Reason
            ),
            Solve(whole) => matches!(
                whole,
                SolveQuantity::Answers
                    | SolveQuantity::Minors
                    | SolveQuantity::Period
                    | SolveQuantity::Majors
                    | SolveQuantity::Verdict
            ),
            Run(..) | Written(_) | Key(_) => false,
        }
    }

    /// The quantity as text; `right` is the text of the right answer.
    fn text(&self, look: &FrameValues, right: &str) -> Result<String, Refusal> {
        match self {
            Right => Ok(right.into()),
            Key(key) => Ok((*key).into()),
            Of(NodeQuantity::Mode, slave) => Ok(look.before(*slave).word().into()),
            Of(NodeQuantity::Next, slave) => Ok(look.next(*slave).word().into()),
            Of(NodeQuantity::Reason, slave) => {
                let record = look.record(*slave)?;
                Ok(report::reason(&record.decision, record.t_max != 0.0))
            }
            Solve(SolveQuantity::Verdict) => {
                let worst = look
                    .verdict()?
                    .broken()
                    .max_by(|a, b| a.amount.total_cmp(&b.amount));
                Ok(match worst {
                    Some(finding) => judged::finding(&look.model, finding),
                    None => "all laws are satisfied".into(),
                })
            }
            Of(..) | Solve(_) | Run(..) | Written(_) => self.number(look).map(sig4),
        }
    }
}

impl NodeQuantity {
    fn number(self, slave: usize, look: &FrameValues) -> Result<f64, Refusal> {
        let frozen = || look.interface(slave);
        let record = look.record(slave);
        let round_off =
            || -> Result<_, Refusal> { Ok(RoundOff::new(&look.model, &look.event()?.before)) };
        let force = |force: f64| Ok(round_off()?.force(force));
        let length = |length: f64| Ok(round_off()?.length(length));
        match self {
            NodeQuantity::FreeN => Ok(frozen()?.free[0]),
            NodeQuantity::FreeT => Ok(frozen()?.free[1]),
            NodeQuantity::Wnn => Ok(frozen()?.compliance[0][0]),
            NodeQuantity::Wnt => Ok(frozen()?.compliance[0][1]),
            NodeQuantity::Wtt => Ok(frozen()?.compliance[1][1]),
            NodeQuantity::Ratio => Ok(look.frame.state.nodes[slave].ratio),
            NodeQuantity::Leaves => look.leaves(slave),
            NodeQuantity::Gap => length(record?.gap),
            NodeQuantity::Fn => force(record?.f_n),
            NodeQuantity::Ft => force(record?.f_t),
            NodeQuantity::TMax => force(record?.t_max),
            NodeQuantity::Slip => length(record?.slip),
            NodeQuantity::Lag => look.lag(slave),
            NodeQuantity::Mode | NodeQuantity::Next | NodeQuantity::Reason => {
                Err(Refusal::new(NO_NUMBER))
            }
        }
    }
}

fn whole_number(whole: SolveQuantity, look: &FrameValues) -> Result<f64, Refusal> {
    let controls = &look.frame.state.controls;
    let friction = || {
        controls
            .friction
            .first()
            .ok_or_else(|| refusal!("this scene has no slave nodes"))
    };
    Ok(match whole {
        SolveQuantity::Load => match &look.frame.event {
            Some(event) => event.load_factor,
            None => look.frame.state.load_factor,
        },
        SolveQuantity::Increment => controls.increment,
        SolveQuantity::Angle => friction()?.angle,
        SolveQuantity::Tan => friction()?.coefficient(),
        SolveQuantity::Cohesion => friction()?.cohesion,
        SolveQuantity::Answers => look.answers()? as f64,
        SolveQuantity::Minors => f64::from(look.end()?.minors),
        SolveQuantity::Period => match look.end()?.cycle {
            Some(cycle) => f64::from(cycle.period),
            None => return Err(refusal!("the increment does not end in a cycle")),
        },
        SolveQuantity::Majors => f64::from(look.end()?.majors),
        SolveQuantity::Residual => look.residual()?,
        SolveQuantity::Sliding => look
            .frame
            .state
            .nodes
            .iter()
            .filter(|node| node.mode == Mode::Sliding)
            .count() as f64,
        SolveQuantity::Verdict => return Err(Refusal::new(NO_NUMBER)),
    })
}

/// Parses a quantity or a literal number.
///
/// # Errors
/// As [`LessonQuantity::read`], and if the quantity is not a number.
pub fn number(text: &str, context: &Context) -> Result<LessonQuantity, Refusal> {
    match text.trim().parse() {
        Ok(number) => Ok(Written(number)),
        Err(_) => match LessonQuantity::read(text.trim(), context)? {
            quantity if quantity.is_number() => Ok(quantity),
            _ => Err(Refusal::new(NO_NUMBER)),
        },
    }
}

/// Parses the settings of a run: `PATH=VALUE PATH=VALUE`.
///
/// # Errors
/// If they cannot be parsed.
pub fn settings(text: &str) -> Result<Vec<(String, String)>, Refusal> {
    let settings: Option<Vec<_>> = text
        .split_whitespace()
        .map(|word| {
            let (path, value) = word.split_once('=')?;
            Some((path.to_owned(), value.to_owned()))
        })
        .collect();
    settings
        .filter(|settings| !settings.is_empty())
        .ok_or_else(|| refusal!("{text} does not select exactly one run of the lesson's chart"))
}

fn unknown(word: &str) -> Refusal {
    let all = NodeQuantity::NAMES.into_iter().chain(SolveQuantity::NAMES);
    let known: Vec<&str> = all
        .chain(RunQuantity::NAMES)
        .chain(["right", "key"])
        .collect();
    refusal!(
        "unknown quantity {word:?}{} (known: {})",
        did_you_mean(word, known.iter().copied()),
        known.join(", ")
    )
}

/// A text that contains quantities.
#[derive(Debug, Clone, PartialEq)]
pub struct Template(Vec<Piece>);

#[derive(Debug, Clone, PartialEq)]
enum Piece {
    Words(String),
    Value(LessonQuantity),
}

impl Template {
    /// Parses a text with quantities in braces. Line breaks become spaces, since the screen wraps.
    ///
    /// # Errors
    /// For the first unknown quantity.
    pub fn read(text: &str, context: &Context) -> Result<Template, Refusal> {
        let mut pieces = Vec::new();
        let words: Vec<&str> = text.split_whitespace().collect();
        let text = words.join(" ");
        let mut rest = text.as_str();
        while let Some((words, after)) = rest.split_once('{') {
            let (name, after) = after
                .split_once('}')
                .ok_or_else(|| refusal!("a brace {{ is not closed by }}"))?;
            pieces.push(Piece::Words(words.into()));
            pieces.push(Piece::Value(LessonQuantity::read(name.trim(), context)?));
            rest = after;
        }
        pieces.push(Piece::Words(rest.into()));
        Ok(Template(pieces))
    }

    /// Checks that the text may be a hint: it must neither look ahead nor contain `asked`, the answer.
    ///
    /// # Errors
    /// If it is not allowed.
    pub fn check_hint(&self, asked: Option<&LessonQuantity>) -> Result<(), Refusal> {
        if self.0.iter().any(|piece| match piece {
            Piece::Value(quantity) => quantity.looks_ahead() || Some(quantity) == asked,
            Piece::Words(_) => false,
        }) {
            Err(refusal!(
                "the hint contains the answer or looks ahead; use numbers of the shown iteration only"
            ))
        } else {
            Ok(())
        }
    }

    /// The text with the current values.
    ///
    /// # Errors
    /// If a value is not known.
    pub fn fill(&self, look: &FrameValues, right: &str) -> Result<String, Refusal> {
        self.0
            .iter()
            .map(|piece| match piece {
                Piece::Words(words) => Ok(words.clone()),
                Piece::Value(quantity) => quantity.text(look, right),
            })
            .collect()
    }
}
