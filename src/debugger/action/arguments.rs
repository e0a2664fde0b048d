//! Parses the arguments of actions.

use super::context::{Context, any_or_exact, chosen, exact, find, model, several};
use super::meaning::{
    Action, ChartOf, Colours, CopyTarget, Filter, HiddenDecisions, Question, Sort, Ui,
};
use super::parameters::{parameter, set_paths};
use super::table::{ActionEntry, Verb};
use crate::history::breakpoints::Condition;
use crate::refusal::{Refusal, refusal};
use crate::{BranchTarget, Command, ExportScope, Watch, WatchQuantity};
use std::fmt::Display;
use std::ops::RangeBounds;
use std::path::PathBuf;
use std::str::FromStr;
use stickslip_core::Mode;
use stickslip_manual as manual;
use stickslip_scene::joined;
use stickslip_study::Vary;

/// Maximum number of characters after an action's name.
const LONGEST_REST: usize = 1000;

/// Parses a line: the name of an action and its arguments.
pub fn parse(line: &str, context: &Context) -> Result<Action, Refusal> {
    let line = line.trim();
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    if word.is_empty() {
        return Err(refusal!("type the name of an action; ? lists all actions"));
    }
    context.entry(word)?.act(rest.trim(), context)
}

impl ActionEntry {
    /// The action of this entry with these arguments.
    pub fn act(&self, rest: &str, context: &Context) -> Result<Action, Refusal> {
        if rest.chars().count() > LONGEST_REST {
            return Err(refusal!(
                "the arguments of {name} are longer than {LONGEST_REST} characters",
                name = self.name
            ));
        }
        let words: Vec<&str> = rest.split_whitespace().collect();
        if words.len() > self.most_words() {
            return Err(self.misused());
        }
        let ui = |ui| Ok(Action::Ui(ui));
        let ask = |question| ui(Ui::Ask(question));
        let command = match &self.verb {
            Verb::Forward(unit) => Command::Forward {
                unit: *unit,
                count: self.count(&words)?,
            },
            Verb::Back(unit) => Command::Back {
                unit: *unit,
                count: self.count(&words)?,
            },
            Verb::Force { hold } => return self.force(&words, *hold, context),
            Verb::Release => Command::Release {
                slave: chosen(words.first().copied(), context)?,
            },
            Verb::Increment if words.is_empty() => {
                return ask(Question::Increment);
            }
            Verb::Increment => Command::Increment(increment(rest)?),
            Verb::Set => self.set(rest, &words, context)?,
            Verb::SetPath(path) => Command::Set {
                path: path.to_string(),
                value: self.only(&words)?.into(),
            },
            Verb::Goto => Command::Goto {
                step: number(self.only(&words)?, "step number", 0.., self.usage())?,
            },
            Verb::Branch(Some(to)) => Command::Branch(to.clone()),
            Verb::Branch(None) | Verb::Rename | Verb::Unwatch if rest.is_empty() => {
                return Err(self.misused());
            }
            Verb::Branch(None) => Command::Branch(BranchTarget::Named(rest.into())),
            Verb::Rename => Command::Rename(rest.into()),
            Verb::Unwatch => Command::Unwatch(rest.into()),
            Verb::Compare => Command::Compare((!rest.is_empty()).then(|| rest.into())),
            Verb::Break if words.is_empty() => return ask(Question::Break),
            Verb::Break => Command::Break(condition(&words, context)?),
            Verb::Delete => Command::Delete(self.number_or_all(&words)?),
            Verb::Enable { on } => Command::Enable {
                id: self.number_or_all(&words)?,
                on: *on,
            },
            Verb::Watch => Command::Watch(self.watch(&words, context)?),
            Verb::Plain(command) => command.clone(),
            Verb::Census => Command::Census(several(&words, context)?),
            Verb::Export { what, overwrite } => {
                let frozen = match what {
                    ExportScope::Shown => rest.strip_prefix("--frozen"),
                    _ => None,
                };
                let frozen = frozen.filter(|file| file.is_empty() || file.starts_with(' '));
                let file = frozen.map_or(rest, str::trim_start);
                if file.is_empty() {
                    return Err(self.misused());
                }
                Command::Export {
                    what: frozen.map_or(*what, |_| ExportScope::Whole),
                    file: PathBuf::from(file),
                    overwrite: *overwrite,
                }
            }
            Verb::Snapshot { overwrite: true } if rest.is_empty() => return Err(self.misused()),
            Verb::Snapshot { overwrite } => {
                let file = (!rest.is_empty()).then(|| PathBuf::from(rest));
                Command::Snapshot {
                    file,
                    overwrite: *overwrite,
                }
            }
            Verb::Journal => Command::Journal((!rest.is_empty()).then(|| PathBuf::from(rest))),
            Verb::Node if rest.is_empty() => return ask(Question::Node),
            Verb::Node => return ui(Ui::Select(find(rest, context)?)),
            Verb::Open if rest.is_empty() => return ask(Question::Scene),
            Verb::Open => return ui(Ui::Open(rest.into())),
            Verb::Sort => return ui(Ui::Sort(one_of(&words, Sort::ALL, Sort::word)?)),
            Verb::Filter => return ui(Ui::Filter(one_of(&words, Filter::ALL, Filter::word)?)),
            Verb::Copy => {
                return ui(Ui::Copy(one_of(
                    &words,
                    CopyTarget::all(),
                    CopyTarget::word,
                )?));
            }
            Verb::Colours => {
                let rest = words.join(" ");
                let rest = (!rest.is_empty()).then_some(rest.as_str());
                let colours = one_of(rest.as_slice(), Colours::ALL, Colours::word)?;
                return ui(Ui::Colours(colours));
            }
            Verb::Mouse => {
                let word = |on: bool| if on { "on" } else { "off" };
                let on = one_of(&words, [true, false], word)?;
                return ui(Ui::Mouse(on));
            }
            Verb::Magnify => {
                let expected = "expected a number from 1 to 1e9";
                let factor = |word: &&str| number(word, "factor", 1.0..=1e9, expected);
                return ui(Ui::Magnify(words.first().map(factor).transpose()?));
            }
            Verb::Chart => return ui(Ui::Chart(chart_of(rest, &words)?)),
            Verb::Lesson if rest.is_empty() => return ask(Question::Lesson),
            Verb::Lesson => return ui(Ui::Lesson(rest.into())),
            Verb::Answer if rest.is_empty() => return ask(Question::Answer),
            Verb::Answer => return ui(Ui::Answer(rest.into())),
            Verb::Predict => {
                let whose = one_of(&words, HiddenDecisions::ALL, HiddenDecisions::word)?;
                return ui(Ui::Predict(whose));
            }
            Verb::Monitor if rest.is_empty() => return ui(Ui::Monitor(None)),
            Verb::Monitor => return ui(Ui::Monitor(Some(monitor(rest, context)?))),
            Verb::Help if rest.is_empty() => return ui(Ui::Help),
            Verb::Help => return ui(Ui::Manual(manual::page(rest)?)),
            Verb::StartFrom => return ui(Ui::StartFrom(self.entry(&words)?)),
            Verb::Apply => return ui(Ui::Apply(self.entry(&words)?)),
            Verb::Do(own) => return ui(own.clone()),
        };
        Ok(Action::Session(command))
    }

    /// The error for too few or too many words.
    fn misused(&self) -> Refusal {
        Refusal::new(self.usage())
    }

    /// The argument of an action that has one.
    fn only<'a>(&self, words: &[&'a str]) -> Result<&'a str, Refusal> {
        words.first().copied().ok_or_else(|| self.misused())
    }

    fn count(&self, words: &[&str]) -> Result<u32, Refusal> {
        number(words.first().unwrap_or(&"1"), "count", 1.., self.usage())
    }

    /// An entry of a list, counted from 0.
    fn entry(&self, words: &[&str]) -> Result<usize, Refusal> {
        number(self.only(words)?, "list entry", 1.., self.usage()).map(|entry: usize| entry - 1)
    }

    /// The number of a breakpoint; `None` for all.
    fn number_or_all(&self, words: &[&str]) -> Result<Option<u32>, Refusal> {
        match self.only(words)? {
            "all" => Ok(None),
            word => number(word, "breakpoint number", 0.., self.usage()).map(Some),
        }
    }

    fn watch(&self, words: &[&str], context: &Context) -> Result<Watch, Refusal> {
        let (what, name) = match words.iter().position(|word| *word == "as") {
            Some(at) if at + 1 == words.len() => return Err(self.misused()),
            Some(at) => (&words[..at], Some(words[at + 1..].join(" "))),
            None => (words, None),
        };
        let Some((word, rest)) = what.split_first() else {
            return Err(self.misused());
        };
        let model = model(context)?;
        let quantity = WatchQuantity::from_word(word).ok_or_else(|| {
            let all = WatchQuantity::NAMES.join(", ");
            refusal!("cannot watch '{word}'; quantities: {all}")
        })?;
        let slave = match (quantity.is_nodal(), rest) {
            (true, []) => chosen(None, context)?,
            (true, [node]) => exact(node, context)?,
            (false, []) => 0,
            _ => return Err(self.misused()),
        };
        let watch = Watch::new(model, quantity, slave);
        Ok(match name {
            Some(name) => Watch { name, ..watch },
            None => watch,
        })
    }

    fn force(&self, words: &[&str], hold: bool, context: &Context) -> Result<Action, Refusal> {
        let (node, word) = match words[..] {
            [] if !hold => return Ok(Action::Ui(Ui::Ask(Question::Mode))),
            [word] => (None, word),
            [node, word] => (Some(node), word),
            _ => return Err(self.misused()),
        };
        let mode = mode(word).ok_or_else(|| Refusal::no_mode(word))?;
        Ok(Action::Session(Command::Force {
            slave: chosen(node, context)?,
            mode,
            hold,
        }))
    }

    fn set(&self, rest: &str, words: &[&str], context: &Context) -> Result<Command, Refusal> {
        // Names and texts of attached solvers may contain spaces.
        if let Some((known, value)) = parameter(rest, context)
            && !value.is_empty()
        {
            return Ok(Command::Set {
                path: known.name.clone(),
                value: value.into(),
            });
        }
        let [path, value] = words[..] else {
            let paths = set_paths(context).join(", ");
            return Err(refusal!("{}; paths: {paths}", self.usage()));
        };
        Ok(Command::Set {
            path: path.into(),
            value: value.into(),
        })
    }
}

/// The kinds of breakpoint conditions.
pub(super) const CONDITIONS: [&str; 8] = [
    "mode", "leaves", "margin", "element", "cycle", "residual", "failure", "at",
];

/// Parses a breakpoint condition. A missing node, or `any`, means any node.
fn condition(words: &[&str], context: &Context) -> Result<Condition, Refusal> {
    let (word, rest) = words
        .split_first()
        .map_or(("", words), |(w, rest)| (*w, rest));
    let usage = |how: &str| refusal!("usage: break {word} {how}");
    match (word, rest) {
        ("mode" | "leaves", _) if rest.len() <= 2 => {
            let (node, mode) = node_and_mode(rest, context)?;
            let (from, to) = match word {
                "mode" => (None, mode),
                _ if mode.is_none() => return Err(usage("[NODE] MODE")),
                _ => (mode, None),
            };
            Ok(Condition::Mode { node, from, to })
        }
        ("mode" | "leaves", _) => Err(usage("[NODE] [MODE]")),
        ("margin", [.., value]) if rest.len() <= 2 => {
            let below = number(value, "margin", f64::MIN..=f64::MAX, "expected a number")?;
            let node = any_or_exact(rest.get(rest.len().wrapping_sub(2)), context)?;
            Ok(Condition::Margin { node, below })
        }
        ("margin", _) => Err(usage("[NODE] VALUE")),
        ("element", [] | [_]) => Ok(Condition::Element {
            node: any_or_exact(rest.first(), context)?,
        }),
        ("element", _) => Err(usage("[NODE]")),
        ("cycle", []) => Ok(Condition::Cycle),
        ("residual", []) => Ok(Condition::Residual),
        ("failure", []) => Ok(Condition::Failure),
        ("cycle" | "residual" | "failure", _) => Err(usage("")),
        ("at", [place]) => Ok(Condition::At(place.parse()?)),
        ("at", _) => Err(usage("INC[.MAJOR[.MINOR]]")),
        _ => Err(refusal!(
            "unknown condition '{word}'; conditions: {}",
            CONDITIONS.join(", ")
        )),
    }
}

/// Parses `[NODE] [MODE]`: a single word is a mode if it can be one, otherwise a node.
fn node_and_mode(
    words: &[&str],
    context: &Context,
) -> Result<(Option<usize>, Option<Mode>), Refusal> {
    match words {
        [] => Ok((None, None)),
        [word] => match mode(word) {
            Some(mode) => Ok((None, Some(mode))),
            None => Ok((any_or_exact(Some(word), context)?, None)),
        },
        [node, word, ..] => {
            let mode = mode(word).ok_or_else(|| Refusal::no_mode(word))?;
            Ok((any_or_exact(Some(node), context)?, Some(mode)))
        }
    }
}

/// A mode by its letter (f, s, x) or a prefix of its name.
pub fn mode(word: &str) -> Option<Mode> {
    let word = word.to_lowercase();
    Mode::ALL.into_iter().find(|mode| match word.len() {
        0 | 1 => letter(*mode) == word,
        _ => mode.word().starts_with(&word),
    })
}

/// A mode as a letter.
pub fn letter(mode: Mode) -> &'static str {
    match mode {
        Mode::Free => "f",
        Mode::Sliding => "s",
        Mode::Fixed => "x",
    }
}

/// Parses an increment size.
pub fn increment(word: &str) -> Result<f64, Refusal> {
    let expected = "expected a positive number such as 0.005";
    let positive = f64::MIN_POSITIVE..=f64::MAX;
    number(word.trim(), "increment", positive, expected)
}

/// Parses a number within limits.
fn number<T: FromStr + PartialOrd>(
    word: &str,
    kind: &str,
    limits: impl RangeBounds<T>,
    expected: impl Display,
) -> Result<T, Refusal> {
    let number = word.parse().ok().filter(|number| limits.contains(number));
    number.ok_or_else(|| Refusal::no_value(word, kind, expected))
}

/// Parses a file, or settings with their values; nothing means the scene's own chart.
fn chart_of(rest: &str, words: &[&str]) -> Result<ChartOf, Refusal> {
    if rest.is_empty() {
        return Ok(ChartOf::Scene);
    }
    if !words.iter().all(|word| word.contains('=')) {
        return Ok(ChartOf::File(rest.into()));
    }
    let over: Result<_, _> = words.iter().map(|word| Vary::parse(word)).collect();
    over.map(ChartOf::Settings).map_err(Refusal::new)
}

/// The choice that a word is a prefix of; `None` without a word.
fn one_of<T: Copy>(
    words: &[&str],
    all: impl IntoIterator<Item = T>,
    spell: fn(T) -> &'static str,
) -> Result<Option<T>, Refusal> {
    let Some(word) = words.first() else {
        return Ok(None);
    };
    let all: Vec<T> = all.into_iter().collect();
    let found = all.iter().find(|&&one| spell(one) == *word);
    found
        .or_else(|| all.iter().find(|&&one| spell(one).starts_with(word)))
        .copied()
        .map(Some)
        .ok_or_else(|| {
            let all = joined(all.iter().map(|&one| spell(one)), ", ");
            refusal!("unknown word '{word}'; expected one of: {all}")
        })
}

/// The number of the monitor with this name.
fn monitor(name: &str, context: &Context) -> Result<usize, Refusal> {
    let monitors = &model(context)?.monitors;
    let found = monitors.iter().position(|monitor| monitor.name == name);
    found.ok_or_else(|| {
        if monitors.is_empty() {
            refusal!("this scene has no monitors")
        } else {
            let names = joined(monitors.iter().map(|m| &m.name), ", ");
            refusal!("unknown monitor '{name}'; monitors: {names}")
        }
    })
}
