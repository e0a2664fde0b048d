//! A question of a lesson: its right answer from the solver, and the replies.

use super::frame_values::FrameValues;
use super::lesson::{Answer, Ask, Truth};
use super::quantity::Template;
use crate::action;
use crate::explain::names::{MODES, TABLE_2};
use crate::explain::report;
use crate::explain::tested;
use crate::refusal::{Refusal, refusal};
use stickslip_core::{Decision, Mode, Rule, Stability, Test};
use stickslip_scene::{joined, sig4};

/// Relative difference below which numbers count as about the same.
const CLOSE: f64 = 0.05;

/// An open question, with its answer.
#[derive(Debug, Clone)]
pub struct TutorQuestion {
    /// The choices, if there are any.
    pub options: Vec<String>,
    right: RightAnswer,
    /// The decision at the node in question, if any, and whether there is friction.
    node: Option<(usize, Decision, bool)>,
    /// Whether the decision is in a later iteration.
    is_ahead: bool,
    hint: String,
    then: String,
    /// Number of wrong answers and hints so far.
    pub(super) tries: u32,
}

/// How a question is answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnswerKind {
    /// By a mode.
    Mode,
    /// By the number of an option.
    Choice,
    /// By a number.
    Number,
}

#[derive(Debug, Clone, PartialEq)]
enum RightAnswer {
    Mode(Mode),
    Choice(usize),
    Number { value: f64, tolerance: f64 },
}

impl TutorQuestion {
    /// Gets the right answer from the solver. Texts shown before the answer are filled from the current state
    /// `now`.
    pub(super) fn new(ask: &Ask, now: &FrameValues) -> Result<TutorQuestion, Refusal> {
        let look = now.ahead(ask.ahead)?;
        let found = |slave: usize| -> Result<_, Refusal> {
            let record = look.record(slave)?;
            Ok((slave, record.decision, record.t_max != 0.0))
        };
        let (mut options, mut node) = (Vec::new(), None);
        let right = match &ask.answer {
            Answer::Mode(slave) => {
                let found = found(*slave)?;
                node = Some(found);
                RightAnswer::Mode(found.1.next)
            }
            Answer::Rule(slave) => {
                let found = found(*slave)?;
                node = Some(found);
                let right;
                (options, right) = cells(&found.1)?;
                RightAnswer::Choice(right)
            }
            Answer::Number(quantity, tolerance) => {
                let (value, tolerance) = (quantity.number(&look)?, *tolerance);
                if !value.is_finite() {
                    return Err(refusal!("the quantity is not a finite number"));
                }
                RightAnswer::Number { value, tolerance }
            }
            Answer::Choice(choices) => {
                let texts = choices.iter().map(|(text, _)| text.fill(now, "…"));
                options = texts.collect::<Result<_, _>>()?;
                RightAnswer::Choice(chosen(choices, &look)?)
            }
        };
        let mut question = TutorQuestion {
            options,
            right,
            node,
            is_ahead: ask.ahead > 0,
            hint: ask.hint.fill(now, "…")?,
            then: String::new(),
            tries: 0,
        };
        let words = question.words();
        question.then = ask.then.fill(&look, &words)?;
        Ok(question)
    }

    pub(super) fn is_right(&self, word: &str) -> Result<bool, Refusal> {
        let word = word.trim();
        match &self.right {
            RightAnswer::Mode(right) => match action::mode(word) {
                Some(mode) => Ok(mode == *right),
                None => Err(Refusal::no_mode(word)),
            },
            RightAnswer::Choice(right) => match word.parse::<usize>() {
                Ok(number) if (1..=self.options.len()).contains(&number) => {
                    Ok(number - 1 == *right)
                }
                _ => Err(refusal!(
                    "invalid choice '{word}'; expected 1 to {}",
                    self.options.len()
                )),
            },
            RightAnswer::Number { value, tolerance } => {
                Ok(is_close(number(word)?, *value, *tolerance))
            }
        }
    }

    /// How it is answered.
    pub fn kind(&self) -> AnswerKind {
        match self.right {
            RightAnswer::Mode(_) => AnswerKind::Mode,
            RightAnswer::Choice(_) => AnswerKind::Choice,
            RightAnswer::Number { .. } => AnswerKind::Number,
        }
    }

    /// The right answer in words.
    fn words(&self) -> String {
        match self.right {
            RightAnswer::Number { value, .. } => sig4(value),
            _ => self.solution(),
        }
    }

    /// The reply to the right answer.
    pub(super) fn reply_to_right(&self) -> String {
        format!("Right: {}", self.explained())
    }

    /// The reply to a wrong answer that allows another attempt.
    pub(super) fn reply_to_wrong(&self, word: &str) -> String {
        if self.has_wrong_sign(word) {
            format!(
                "No: the amount is right, but the sign is wrong. {}",
                self.help()
            )
        } else {
            format!("No. {}", self.help())
        }
    }

    /// The right answer, as typed.
    pub(super) fn solution(&self) -> String {
        match self.right {
            RightAnswer::Mode(mode) => mode.word().into(),
            RightAnswer::Choice(index) => (index + 1).to_string(),
            RightAnswer::Number { value, .. } => value.to_string(),
        }
    }

    /// Whether the negative of a number would be right.
    fn has_wrong_sign(&self, word: &str) -> bool {
        match &self.right {
            RightAnswer::Number { value, tolerance } => {
                number(word).is_ok_and(|given| is_close(-given, *value, *tolerance))
            }
            _ => false,
        }
    }

    /// The right answer with the reason.
    pub(super) fn explained(&self) -> String {
        let mut text = self.words() + ".";
        if let Some((_, decision, friction)) = &self.node {
            text += &format!(
                " {}. {}",
                compared(decision),
                report::reason(decision, *friction)
            );
        }
        if !self.then.is_empty() {
            text += &format!(" {}", self.then);
        }
        text
    }

    /// A hint without the answer: the row of Table 2, and the numbers of the decision.
    pub(super) fn help(&self) -> String {
        let mut text = match &self.node {
            Some((_, decision, _)) if !self.is_ahead => format!(
                "Look at row {} of Table 2: {}.",
                decision.before.word(),
                compared(decision)
            ),
            _ => String::new(),
        };
        text += if text.is_empty() || self.hint.is_empty() {
            ""
        } else {
            " "
        };
        text += &self.hint;
        if text.is_empty() {
            "Try again.".into()
        } else {
            text
        }
    }
}

/// Reads a number; accepts typographic minus signs and decimal commas.
fn number(word: &str) -> Result<f64, Refusal> {
    let plain = word.trim().replace('−', "-").replace(',', ".");
    plain
        .parse()
        .map_err(|_| refusal!("invalid number '{word}'; expected a number such as -0.05 or 2e-3"))
}

fn is_close(given: f64, value: f64, tolerance: f64) -> bool {
    (given - value).abs() <= tolerance * value.abs()
}

/// Cells of Table 2 in the row of the node's mode, and the index of the one that applied.
fn cells(decision: &Decision) -> Result<(Vec<String>, usize), Refusal> {
    if matches!(decision.rule, Rule::Held | Rule::OffSurface) {
        return Err(refusal!("no cell of Table 2 applies here"));
    }
    let place = |mode: Mode| MODES.iter().position(|m| *m == mode).unwrap_or(0);
    let options = MODES
        .iter()
        .enumerate()
        .map(|(column, mode)| {
            let [first, second] = TABLE_2[place(decision.before)][column];
            let and = if second.is_empty() { "" } else { " and " };
            format!("{first}{and}{second}: {}", mode.word())
        })
        .collect();
    Ok((options, place(decision.next)))
}

/// The only right choice.
fn chosen(choices: &[(Template, Truth)], look: &FrameValues) -> Result<usize, Refusal> {
    let mut right = Vec::new();
    for (index, (_, truth)) in choices.iter().enumerate() {
        let holds = match truth {
            Truth::Known(known) => *known,
            Truth::Cycles => look.end()?.cycle.is_some(),
            Truth::Accepted => look.end()?.accepted,
            Truth::Answers(count) => look.answers()? == *count,
            Truth::Becomes(slave, mode) => look.record(*slave)?.decision.next == *mode,
            Truth::Quadratic(wanted) => look.end()?.is_quadratic()? == *wanted,
            Truth::Obeys => look.verdict()?.broken().next().is_none(),
            Truth::Breaks(law) => look.verdict()?.broken().any(|found| found.law == *law),
            Truth::Stable(wanted) => match look.stability() {
                Stability::NotKnown => {
                    return Err(refusal!("the stability of this state is not known"));
                }
                found => found.is_unstable() != *wanted,
            },
            Truth::Less(a, b) => {
                let (a, b) = (a.number(look)?, b.number(look)?);
                a < b - CLOSE * b.abs()
            }
            Truth::Close(a, b) => {
                let (a, b) = (a.number(look)?, b.number(look)?);
                (a - b).abs() <= CLOSE * a.abs().max(b.abs())
            }
            Truth::Cheapest(settings, error) => look.runs()?.is_cheapest(settings, *error)?,
        };
        right.extend(holds.then_some(index));
    }
    match right[..] {
        [index] => Ok(index),
        [] => Err(refusal!("none of the choices is right")),
        _ => Err(refusal!("more than one choice is right")),
    }
}

/// The inequalities tested, with their numbers.
fn compared(decision: &Decision) -> String {
    let side = |test: &Test| {
        let sign = match test.value.partial_cmp(&test.bound) {
            _ if test.tie => "ties with",
            Some(std::cmp::Ordering::Less) => "<",
            Some(std::cmp::Ordering::Greater) => ">",
            _ => "=",
        };
        let (name, bound) = tested::sides(test.tested);
        let bound = bound.map_or("0".into(), |bound| {
            format!("{bound} = {}", sig4(test.bound))
        });
        format!("{name} = {} {sign} {bound}", sig4(test.value))
    };

    joined(decision.tests.iter().flatten().map(side), ", and ")
}
