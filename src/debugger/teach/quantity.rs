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
use super::refusal::LessonError;
use crate::RoundOff;
use crate::action::{self, Context};
use crate::explain::judged;
use crate::explain::names;
use crate::explain::report;
use stickslip_core::Mode;
use stickslip_scene::number::sig4;

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

/// Quantities of a slave node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NodeQuantity {
    /// Gap (length), negative for penetration.
    Gap,
    /// Normal force; compression is positive.
    Fn,
    /// Tangential force.
    Ft,
    /// The friction bound T_max, force.
    TMax,
    /// Slip, length.
    Slip,
    /// Factor by which the error of a lagged T_max changes in the next solve.
    Lag,
    /// Motion of S* relative to the node along n if all nodes were free, length.
    FreeN,
    /// The same along t.
    FreeT,
    /// Compliance: motion along n per F_n on the node, length per force.
    Wnn,
    /// Motion along n per F_t, and along t per F_n.
    Wnt,
    /// Motion along t per F_t.
    Wtt,
    /// ρ, the ratio of tangential to normal travel of a node that touches.
    Ratio,
    /// Load factor at which the node leaves its mode.
    Leaves,
    /// Mode of the shown iteration.
    Mode,
    /// Mode of the next iteration.
    Next,
    /// The cell of Table 2 that applied, in words.
    Reason,
}

/// Quantities of the solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolveQuantity {
    /// The load factor λ.
    Load,
    /// Size of the increment, as a load factor.
    Increment,
    /// Angle of friction, degrees.
    Angle,
    /// Coefficient of friction.
    Tan,
    /// Cohesion, force.
    Cohesion,
    /// Number of consistent states.
    Answers,
    /// Minor iterations until the increment ends.
    Minors,
    /// Period of the cycle.
    Period,
    /// Major iterations of this increment.
    Majors,
    /// The latest relative residual.
    Residual,
    /// Number of sliding slave nodes.
    Sliding,
    /// The judge's finding, in a sentence.
    Verdict,
}

/// Quantities of a run in a chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunQuantity {
    /// Relative error.
    Error,
    /// Number of factorizations.
    Factorizations,
}

stickslip_core::words! {
    NodeQuantity, ALL, word:
    Gap "gap",
    Fn "F_n",
    Ft "F_t",
    TMax "T_max",
    Slip "slip",
    Lag "lag",
    FreeN "v_n",
    FreeT "v_t",
    Wnn "W_nn",
    Wnt "W_nt",
    Wtt "W_tt",
    Ratio "rho",
    Leaves "leaves",
    Mode "mode",
    Next "next",
    Reason "reason",
}

stickslip_core::words! {
    RunQuantity, ALL, word:
    Error "error",
    Factorizations "factorizations",
}

stickslip_core::words! {
    SolveQuantity, ALL, word:
    Load "load",
    Increment "increment",
    Angle "angle",
    Tan "tan",
    Cohesion "cohesion",
    Answers "answers",
    Minors "minors",
    Period "period",
    Majors "majors",
    Residual "residual",
    Sliding "sliding",
    Verdict "verdict",
}

impl NodeQuantity {
    /// Whether it belongs to the frozen interface problem.
    fn is_frozen(self) -> bool {
        matches!(
            self,
            NodeQuantity::FreeN
                | NodeQuantity::FreeT
                | NodeQuantity::Wnn
                | NodeQuantity::Wnt
                | NodeQuantity::Wtt
        )
    }
}

impl LessonQuantity {
    /// Parses a quantity: `F_n beam.end`, `load`.
    ///
    /// # Errors If the quantity or its node is unknown.
    pub fn read(text: &str, context: &Context) -> Result<LessonQuantity, LessonError> {
        let (word, rest) = text.split_once(' ').unwrap_or((text, ""));
        let rest = rest.trim();
        if let Some(nodal) = NodeQuantity::from_word(word) {
            return match rest {
                "" => Err(LessonError::WhichNode(word.into())),
                node => Ok(Of(nodal, action::exact(node, context)?)),
            };
        }
        if let Some(of) = RunQuantity::from_word(word) {
            return Ok(Run(of, settings(rest)?));
        }
        let whole = SolveQuantity::from_word(word);
        match (word, whole, rest) {
            ("key", _, action) => {
                let entry = action::ACTIONS.iter().find(|entry| entry.name == action);
                let key = entry.and_then(|entry| entry.keys.first());
                key.map(|key| Key(key))
                    .ok_or_else(|| LessonError::NoKey(action.into()))
            }
            ("right", _, "") => Ok(Right),
            (_, Some(whole), "") => Ok(Solve(whole)),
            (_, Some(_), _) => Err(LessonError::NotNodal(word.into())),
            _ => Err(unknown(word)),
        }
    }

    /// Its value, if it is a number.
    ///
    /// # Errors If it is not a number or not known.
    pub fn number(&self, look: &FrameValues) -> Result<f64, LessonError> {
        match self {
            Of(nodal, slave) if nodal.is_frozen() => {
                let of = look.interface(*slave)?;
                Ok(match nodal {
                    NodeQuantity::FreeN => of.free[0],
                    NodeQuantity::FreeT => of.free[1],
                    NodeQuantity::Wnn => of.compliance[0][0],
                    NodeQuantity::Wtt => of.compliance[1][1],
                    _ => of.compliance[0][1],
                })
            }
            Of(NodeQuantity::Ratio, slave) => Ok(look.frame.state.nodes[*slave].ratio),
            Of(NodeQuantity::Leaves, slave) => look.leaves(*slave),
            Of(nodal, slave) => {
                let record = look.record(*slave)?;
                let round_off = RoundOff::new(&look.model, &look.event()?.before);
                match nodal {
                    NodeQuantity::Gap => Ok(round_off.length(record.gap)),
                    NodeQuantity::Fn => Ok(round_off.force(record.f_n)),
                    NodeQuantity::Ft => Ok(round_off.force(record.f_t)),
                    NodeQuantity::TMax => Ok(round_off.force(record.t_max)),
                    NodeQuantity::Slip => Ok(round_off.length(record.slip)),
                    NodeQuantity::Lag => look.lag(*slave),
                    _ => Err(LessonError::NoNumber),
                }
            }
            Solve(whole) => whole_number(*whole, look),
            Run(of, settings) => {
                let run = look.runs()?.of(settings)?;
                match of {
                    RunQuantity::Error => run.error.ok_or(LessonError::NoError),
                    RunQuantity::Factorizations => Ok(run.factorizations as f64),
                }
            }
            Written(number) => Ok(*number),
            Right | Key(_) => Err(LessonError::NoNumber),
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
    fn text(&self, look: &FrameValues, right: &str) -> Result<String, LessonError> {
        match self {
            Right => Ok(right.into()),
            Key(key) => Ok((*key).into()),
            Of(NodeQuantity::Mode, slave) => Ok(names::mode(look.before(*slave)).into()),
            Of(NodeQuantity::Next, slave) => Ok(names::mode(look.next(*slave)).into()),
            Of(NodeQuantity::Reason, slave) => {
                let record = look.record(*slave)?;
                Ok(report::reason(&record.decision, record.t_max != 0.0))
            }
            Of(..) => self.number(look).map(sig4),
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
            Solve(_) | Run(..) | Written(_) => self.number(look).map(sig4),
        }
    }
}

fn whole_number(whole: SolveQuantity, look: &FrameValues) -> Result<f64, LessonError> {
    let controls = &look.frame.state.controls;
    let friction = || controls.friction.first().ok_or(LessonError::NoSlaves);
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
            None => return Err(LessonError::NoCycle),
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
        SolveQuantity::Verdict => return Err(LessonError::NoNumber),
    })
}

/// Parses a quantity or a literal number.
///
/// # Errors As [`LessonQuantity::read`], and if the quantity is not a number.
pub fn number(text: &str, context: &Context) -> Result<LessonQuantity, LessonError> {
    match text.trim().parse() {
        Ok(number) => Ok(Written(number)),
        Err(_) => match LessonQuantity::read(text.trim(), context)? {
            quantity if quantity.is_number() => Ok(quantity),
            _ => Err(LessonError::NoNumber),
        },
    }
}

/// Parses the settings of a run: `PATH=VALUE PATH=VALUE`.
///
/// # Errors If they cannot be parsed.
pub fn settings(text: &str) -> Result<Vec<(String, String)>, LessonError> {
    let settings: Option<Vec<_>> = text
        .split_whitespace()
        .map(|word| {
            let (path, value) = word.split_once('=')?;
            Some((path.to_owned(), value.to_owned()))
        })
        .collect();
    settings
        .filter(|settings| !settings.is_empty())
        .ok_or_else(|| LessonError::NoRun(text.to_owned()))
}

fn unknown(word: &str) -> LessonError {
    let all = NodeQuantity::NAMES.into_iter().chain(SolveQuantity::NAMES);
    LessonError::NoQuantity {
        word: word.into(),
        known: all
            .chain(RunQuantity::NAMES)
            .chain(["right", "key"])
            .collect(),
    }
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
    /// # Errors For the first unknown quantity.
    pub fn read(text: &str, context: &Context) -> Result<Template, LessonError> {
        let mut pieces = Vec::new();
        let words: Vec<&str> = text.split_whitespace().collect();
        let text = words.join(" ");
        let mut rest = text.as_str();
        while let Some((words, after)) = rest.split_once('{') {
            let (name, after) = after.split_once('}').ok_or(LessonError::Brace)?;
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
    /// [`LessonError::TellsAnswer`] if it is not allowed.
    pub fn check_hint(&self, asked: Option<&LessonQuantity>) -> Result<(), LessonError> {
        if self.0.iter().any(|piece| match piece {
            Piece::Value(quantity) => quantity.looks_ahead() || Some(quantity) == asked,
            Piece::Words(_) => false,
        }) {
            Err(LessonError::TellsAnswer)
        } else {
            Ok(())
        }
    }

    /// The text with the current values.
    ///
    /// # Errors If a value is not known.
    pub fn fill(&self, look: &FrameValues, right: &str) -> Result<String, LessonError> {
        self.0
            .iter()
            .map(|piece| match piece {
                Piece::Words(words) => Ok(words.clone()),
                Piece::Value(quantity) => quantity.text(look, right),
            })
            .collect()
    }
}
