//! Lessons: read from a file and checked against their scene; and the built-in ones.

use super::quantity::{self, LessonQuantity, Template};
use super::runs::Runs;
use super::spec::{AnswerSpec, LessonSpec, SceneSpec, StepSpec, When};
use super::task::{Goal, LessonTask};
use crate::Command;
use crate::action::{self, Action, Context};
use crate::recorded::exchange;
use crate::refusal::{Refusal, refusal};
use std::borrow::Cow;
use std::sync::Arc;
use stickslip_core::{JudgedLaw, Mode, Model};
use stickslip_platform::disk;
use stickslip_scene::embedded_all;
use stickslip_scene::format::error::{AtPath, Path, at, bail, did_you_mean, fault};
use stickslip_scene::format::{Fault, read};
use stickslip_scene::readers::or_mistaken;
use stickslip_scene::scene::placed;
use stickslip_scene::{EmbeddedFile, FileKind, Scene, SceneError};
use stickslip_scene::{embedded, joined};
use stickslip_study::Vary;

/// A lesson that matches its scene.
#[derive(Debug, Clone)]
pub struct Lesson {
    /// Path of the file, or name of the built-in lesson.
    pub name: String,
    /// Title, one line.
    pub title: String,
    /// Subject, one line.
    pub about: String,
    /// The scene.
    pub scene: Scene,
    /// The scene's model.
    pub model: Arc<Model>,
    /// The steps in order.
    pub steps: Vec<LessonStep>,
    /// The recorded exchange that it walks through, if it has no solver: name and text.
    pub(super) recorded: Option<Arc<(String, String)>>,
    /// The runs of its chart, if it has one.
    pub runs: Option<Arc<Runs>>,
    /// The text of its file, for line numbers in errors.
    text: String,
}

/// A step of a lesson.
#[derive(Debug, Clone)]
pub enum LessonStep {
    /// Something to read.
    Text(Template),
    /// An action to perform.
    Press {
        /// Text before the action.
        text: Template,
        /// The action.
        action: Action,
        /// How to perform it, in words.
        how: String,
    },
    /// A question.
    Ask(Ask),
    /// A state to reach.
    Reach(LessonTask),
    /// Decisions to predict.
    Predict {
        /// Text before the predictions.
        text: Template,
        /// Number of consecutive right predictions required.
        right: u32,
    },
}

/// A question.
#[derive(Debug, Clone)]
pub struct Ask {
    /// The question.
    pub text: Template,
    /// The right answer.
    pub answer: Answer,
    /// Whether every action is allowed, to find the answer.
    pub explores: bool,
    /// Number of minor iterations that it looks ahead.
    pub ahead: u32,
    /// Reply to a wrong answer.
    pub hint: Template,
    /// Reply to the right answer.
    pub then: Template,
}

/// The answer of a question; nodes by slave number.
#[derive(Debug, Clone)]
pub enum Answer {
    /// The next mode of this slave node.
    Mode(usize),
    /// The cell of Table 2 that applies at this slave node.
    Rule(usize),
    /// A number and its relative tolerance.
    Number(LessonQuantity, f64),
    /// One of several sentences, each with its condition.
    Choice(Vec<(Template, Truth)>),
}

/// The condition that makes a choice right.
#[derive(Debug, Clone, PartialEq)]
pub enum Truth {
    /// The increment ends in a cycle.
    Cycles,
    /// The increment is accepted.
    Accepted,
    /// The number of consistent states.
    Answers(usize),
    /// The next mode of this slave node.
    Becomes(usize, Mode),
    /// Convergence of the residuals: quadratic, or linear if false.
    Quadratic(bool),
    /// The shown equilibrium is stable under a constant load; unstable if false.
    Stable(bool),
    /// All laws are satisfied.
    Obeys,
    /// This law is violated.
    Breaks(JudgedLaw),
    /// The first number is clearly less than the second.
    Less(LessonQuantity, LessonQuantity),
    /// The numbers are about the same.
    Close(LessonQuantity, LessonQuantity),
    /// The run with these settings is the cheapest of those with an error of at most this.
    Cheapest(Vec<(String, String)>, f64),
    /// Whether the author marked it as right.
    Known(bool),
}

/// Maximum length of texts in characters: what an 80x24 screen can show.
const LONGEST_TEXT: usize = 480;
const LONGEST_REMARK: usize = 320;
/// Maximum number of choices, one digit each.
const MOST_CHOICES: usize = 9;
/// Maximum number of minor iterations that a question looks ahead.
const FARTHEST: u32 = 100;

/// The built-in lessons in teaching order.
static LESSONS: &[EmbeddedFile] = embedded_all![
    "../../problems/lessons/",
    ".ron",
    "modes",
    "table-2",
    "majors",
    "by-hand",
    "condensed",
    "t-max",
    "increment",
    "oscillation",
    "two-nodes",
    "several-answers",
    "no-answer",
    "remedies",
    "slip",
    "judge",
    "two-sides",
    "edge",
    "laws",
    "bodies",
    "limit-point",
    "stability",
    "chart",
    "point-force",
    "attached",
    "cure",
];

/// The built-in exercise sheets, one for each session of the course.
static SHEETS: &[EmbeddedFile] = embedded_all![
    "../../problems/exercises/",
    ".ron",
    "sheet-1",
    "sheet-2",
    "sheet-3",
    "sheet-4",
    "sheet-5",
    "sheet-6",
];

/// The built-in recorded exchanges.
static EXCHANGES: &[EmbeddedFile] =
    embedded_all!["../../problems/lessons/", ".exchange", "kratos-walk"];

/// All built-in lessons, in teaching order.
pub fn list() -> &'static [EmbeddedFile] {
    LESSONS
}

/// The built-in exercise sheets, in the order of the course. They are lessons to be printed.
pub fn sheets() -> &'static [EmbeddedFile] {
    SHEETS
}

/// The title of a built-in lesson; empty if it cannot be read (checked by a test).
pub fn title(lesson: &EmbeddedFile) -> String {
    let spec = read::value::<LessonSpec>(lesson.name, lesson.text, "lesson");
    spec.map(|spec| spec.title).unwrap_or_default()
}

/// Finds a built-in lesson or exercise sheet by its name, with or without `.ron`, or a lesson by its number in teaching order.
pub fn find(name: &str) -> Option<&'static EmbeddedFile> {
    let name = name.strip_suffix(".ron").unwrap_or(name);
    match name.parse::<usize>() {
        Ok(number) => LESSONS.get(number.checked_sub(1)?),
        Err(_) => {
            let name = current_name(name);
            embedded::find(LESSONS, name).or_else(|| embedded::find(SHEETS, name))
        }
    }
}

/// Splits `NAME@STEP`, with steps from 1, into the name and the step from 0.
pub fn split_step(name: &str) -> (&str, Option<usize>) {
    match name.rsplit_once('@') {
        Some((own, step)) => match step.parse::<usize>().ok().and_then(|n| n.checked_sub(1)) {
            Some(step) => (own, Some(step)),
            None => (name, None),
        },
        None => (name, None),
    }
}

/// The current name of a built-in lesson. Names of earlier versions began with a number (`2-modes`).
pub fn current_name(name: &str) -> &str {
    match name.split_once('-') {
        Some((number, word))
            if number.parse::<u32>().is_ok() && LESSONS.iter().any(|own| own.name == word) =>
        {
            word
        }
        _ => name,
    }
}

impl Lesson {
    /// Opens a lesson file, or a built-in lesson by name; a file takes precedence.
    ///
    /// # Errors
    /// If there is no such lesson, or it does not match its scene: one message, with line and column.
    pub fn open(name: &str) -> Result<Lesson, SceneError> {
        let (name, text) = text_of(name)?;
        Lesson::from_text(&name, &text)
    }

    /// Opens a lesson on another scene than its own.
    ///
    /// # Errors
    /// As [`Lesson::open`]; also if the scene cannot be opened, or the lesson does not fit it.
    pub fn open_on(name: &str, scene: &str) -> Result<Lesson, SceneError> {
        let (name, text) = text_of(name)?;
        let scene = Scene::open(scene, &[])?;
        Lesson::read(&name, &text, Some(scene))
    }

    /// Reads a lesson from text; `name` is its name for messages.
    ///
    /// # Errors
    /// As [`Lesson::open`].
    pub fn from_text(name: &str, text: &str) -> Result<Lesson, SceneError> {
        Lesson::read(name, text, None)
    }

    /// Reads a lesson, on another scene than its own if one is given.
    fn read(name: &str, text: &str, other: Option<Scene>) -> Result<Lesson, SceneError> {
        let spec: LessonSpec = read::value(name, text, "lesson")
            .map_err(|error| or_mistaken(error, name, text, FileKind::Lesson))?;
        let recorded = match other {
            Some(_) => None,
            None => recorded(name, text, &spec)?,
        };
        // Progress on another scene is counted apart.
        let own_name = match &other {
            Some(scene) => format!("{name} on {}", scene.name),
            None => name.to_owned(),
        };
        let scene = match (other, &recorded) {
            (Some(scene), _) => scene,
            (None, Some(exchange)) => exchange::open(&exchange.0, &exchange.1)?.scene,
            (None, None) => scene(name, text, &spec)?,
        };
        let reader = LessonReader(Context {
            model: Some(&scene.model),
            scene: Some(&scene),
            ..Context::default()
        });
        let steps = reader
            .steps(&spec)
            .map_err(|fault| placed(name, text, &[], fault))?;
        let runs = runs(&spec, &scene).map_err(|fault| placed(name, text, &[], fault))?;
        Ok(Lesson {
            name: own_name,
            title: spec.title,
            about: spec.about,
            model: Arc::new(scene.model.clone()),
            recorded,
            runs,
            scene,
            steps,
            text: text.to_owned(),
        })
    }

    /// An error about a step, with its location in the file.
    pub(super) fn fault(&self, step: usize, message: String) -> SceneError {
        let fault = Fault::new(at!["steps", step], message);
        placed(&self.name, &self.text, &[], fault)
    }
}

/// Name and text of a lesson file, or of a built-in lesson; a file takes precedence.
fn text_of(name: &str) -> Result<(Cow<'_, str>, Cow<'static, str>), SceneError> {
    if !disk::is_file(name)
        && let Some(builtin) = find(name)
    {
        return Ok((builtin.name.into(), builtin.text.into()));
    }
    let text = read::text(name, "a lesson is written in RON").map_err(|mut error| {
        if !disk::exists(name) {
            let names = || LESSONS.iter().map(|lesson| lesson.name);
            error.message = format!(
                "no such file or built-in lesson{} (built-in: {})",
                did_you_mean(name, names()),
                joined(names(), ", ")
            );
        }
        error
    })?;
    Ok((name.into(), text.into()))
}

/// The recorded exchange of a lesson, by name and text.
fn recorded(
    name: &str,
    text: &str,
    spec: &LessonSpec,
) -> Result<Option<Arc<(String, String)>>, SceneError> {
    let SceneSpec::Recorded(named) = &spec.scene else {
        return Ok(None);
    };
    if let Some(own) = EXCHANGES.iter().find(|own| own.name == named) {
        return Ok(Some(Arc::new((own.name.into(), own.text.into()))));
    }
    let file = Scene::named_in(name, named)
        .map_err(|why| placed(name, text, &[], Fault::new(at!["scene"], why)))?;
    let read = read::text(&file, "an exchange is plain text")?;
    Ok(Some(Arc::new((file, read))))
}

/// The scene of a lesson.
fn scene(name: &str, text: &str, spec: &LessonSpec) -> Result<Scene, SceneError> {
    let at = |path: Path, message: String| placed(name, text, &[], Fault::new(path, message));
    let mut scene = match &spec.scene {
        SceneSpec::Scene(spec) => Scene::within(name, text, &at!["scene"], (**spec).clone())?,
        SceneSpec::Name(scene) | SceneSpec::Recorded(scene) => {
            let scene = Scene::named_in(name, scene).map_err(|why| at(at!["scene"], why))?;
            Scene::open(&scene, &[]).map_err(|error| at(at!["scene"], error.to_string()))?
        }
    };
    for (index, (path, value)) in spec.set.iter().enumerate() {
        scene = scene
            .with(path, value)
            .map_err(|error| at(at!["set", index], error.message))?;
    }
    Ok(scene)
}

/// The runs of a lesson's chart.
fn runs(spec: &LessonSpec, scene: &Scene) -> Result<Option<Arc<Runs>>, Fault> {
    if spec.chart.is_empty() {
        return Ok(None);
    }
    if matches!(spec.scene, SceneSpec::Scene(_)) {
        bail!(
            at!["chart"],
            "a chart requires a named scene: scene: Name(…)"
        );
    }
    let over = spec
        .chart
        .iter()
        .enumerate()
        .map(|(index, text)| Vary::parse(text).at(at!["chart", index]))
        .collect::<Result<Vec<_>, Fault>>()?;
    let runs = Runs::new(scene.name.clone(), over, spec.set.clone());
    Ok(Some(Arc::new(runs)))
}

/// Checks steps against the scene of a context.
struct LessonReader<'a>(Context<'a>);

impl LessonReader<'_> {
    fn steps(&self, spec: &LessonSpec) -> Result<Vec<LessonStep>, Fault> {
        if spec.steps.is_empty() {
            bail!(at!["steps"], "a lesson needs at least one step");
        }
        let is_task =
            |step: &StepSpec| matches!(step, StepSpec::Reach { .. } | StepSpec::Find { .. });
        let first = spec.steps.iter().position(is_task);
        let after = |k: usize| first.is_some_and(|first| k > first);
        let steps = spec.steps.iter().enumerate();
        steps
            .map(|(k, step)| match step {
                StepSpec::Text(_) | StepSpec::Reach { .. } | StepSpec::Find { .. } => {
                    self.step(at!["steps", k], step)
                }
                _ if after(k) => Err(fault!(
                    at!["steps", k],
                    "only texts and tasks can follow a task, because the state is then the user's"
                )),
                _ => self.step(at!["steps", k], step),
            })
            .collect()
    }

    fn step(&self, path: Path, step: &StepSpec) -> Result<LessonStep, Fault> {
        let text = |text: &str| self.template(path.then("text"), text, LONGEST_TEXT);
        let remark = |at: &str, text: &str| self.template(path.then(at), text, LONGEST_REMARK);
        match step {
            StepSpec::Text(text) => {
                Ok(LessonStep::Text(self.template(path, text, LONGEST_TEXT)?))
            }
            StepSpec::Press { text: words, press } => {
                let (action, how) = press_of(press, &self.0).at(path.then("press"))?;
                let text = text(words)?;
                Ok(LessonStep::Press { text, action, how })
            }
            StepSpec::Predict { right: 0, .. } => Err(fault!(
                path.then("right"),
                "at least one right prediction is required"
            )),
            StepSpec::Predict { text: words, right } => Ok(LessonStep::Predict {
                text: text(words)?,
                right: *right,
            }),
            StepSpec::Ask {
                text: words,
                answer,
                ahead,
                hint,
                then,
            } => {
                if *ahead > FARTHEST {
                    bail!(
                        path.then("ahead"),
                        "a question can look ahead by at most {FARTHEST}"
                    );
                }
                let answer = self.answer(path.then("answer"), answer)?;
                let hint = remark("hint", hint)?;
                let asked = match &answer {
                    Answer::Number(quantity, _) if *ahead == 0 => Some(quantity),
                    _ => None,
                };
                hint.check_hint(asked).at(path.then("hint"))?;
                Ok(LessonStep::Ask(Ask {
                    text: text(words)?,
                    answer,
                    explores: false,
                    ahead: *ahead,
                    hint,
                    then: remark("then", then)?,
                }))
            }
            StepSpec::Find {
                text: words,
                of,
                tolerance,
                hint,
                then,
            } => {
                let (of, tolerance) = (of.clone(), *tolerance);
                let answer = self.answer(path.clone(), &AnswerSpec::Number { of, tolerance })?;
                Ok(LessonStep::Ask(Ask {
                    text: text(words)?,
                    answer,
                    explores: true,
                    ahead: 0,
                    hint: remark("hint", hint)?,
                    then: remark("then", then)?,
                }))
            }
            StepSpec::Reach {
                text: words,
                load,
                failure,
                without,
                hint,
                then,
                solution,
            } => {
                let goal = match (load, failure) {
                    (Some(_), true) => {
                        bail!(
                            path.then("failure"),
                            "a task has either a load or a failure"
                        )
                    }
                    (Some(load), false) => Goal::Load(*load),
                    (None, true) => Goal::Failure,
                    (None, false) => Goal::End,
                };
                let solution = solution.iter().enumerate().map(|(k, line)| {
                    let path = path.then("solution").then(k);
                    Ok(press_of(line, &self.0).at(path)?.0)
                });
                Ok(LessonStep::Reach(LessonTask {
                    text: text(words)?,
                    goal,
                    without: without.clone(),
                    hint: remark("hint", hint)?,
                    then: remark("then", then)?,
                    solution: solution.collect::<Result<_, Fault>>()?,
                }))
            }
        }
    }

    fn template(&self, path: Path, text: &str, longest: usize) -> Result<Template, Fault> {
        let length = text
            .split_whitespace()
            .map(|word| word.chars().count() + 1)
            .sum::<usize>();
        let message = match Template::read(text, &self.0) {
            Ok(template) if length <= longest => return Ok(template),
            Ok(_) => format!(
                "the text has {length} characters, too many for a small screen; split it into steps of at most {longest}"
            ),
            Err(why) => why.to_string(),
        };
        Err(Fault::new(path, message))
    }

    fn node(&self, path: Path, name: &str) -> Result<usize, Fault> {
        action::exact(name, &self.0).at(path)
    }

    fn answer(&self, path: Path, answer: &AnswerSpec) -> Result<Answer, Fault> {
        Ok(match answer {
            AnswerSpec::Mode { node } => Answer::Mode(self.node(path.then("node"), node)?),
            AnswerSpec::Rule { node } => Answer::Rule(self.node(path.then("node"), node)?),
            AnswerSpec::Number { of, tolerance } => {
                let quantity = LessonQuantity::read(of, &self.0).at(path.then("of"))?;
                if !quantity.is_number() {
                    bail!(path.then("of"), "{of} is not a number");
                }
                if !(0.0..1.0).contains(tolerance) {
                    bail!(
                        path.then("tolerance"),
                        "the tolerance is relative: 0 for exact, 0.01 for one per cent"
                    );
                }
                Answer::Number(quantity, *tolerance)
            }
            AnswerSpec::Choice(choices) => {
                if !(2..=MOST_CHOICES).contains(&choices.len()) {
                    bail!(path, "a question needs 2 to {MOST_CHOICES} choices");
                }
                let read = choices.iter().enumerate().map(|(k, (text, when))| {
                    let path = path.then(k);
                    let text = self.template(path.then(0), text, LONGEST_REMARK)?;
                    Ok((text, self.truth(path.then(1), when)?))
                });
                Answer::Choice(read.collect::<Result<_, Fault>>()?)
            }
        })
    }

    fn number(&self, path: &Path, text: &str) -> Result<LessonQuantity, Fault> {
        quantity::number(text, &self.0).at(path)
    }

    fn truth(&self, path: Path, when: &When) -> Result<Truth, Fault> {
        Ok(match when {
            When::Cycles => Truth::Cycles,
            When::Accepted => Truth::Accepted,
            When::Answers(count) => Truth::Answers(*count),
            When::Becomes { node, mode } => {
                Truth::Becomes(self.node(path.then("node"), node)?, *mode)
            }
            When::Linear => Truth::Quadratic(false),
            When::Quadratic => Truth::Quadratic(true),
            When::Stable => Truth::Stable(true),
            When::Unstable => Truth::Stable(false),
            When::Obeys => Truth::Obeys,
            When::Breaks(name) => {
                let all = || JudgedLaw::ALL.into_iter().chain(JudgedLaw::OF_BONDS);
                let law = all().find(|law| law.name() == name);
                let names = || joined(all().map(JudgedLaw::name), ", ");
                Truth::Breaks(
                    law.ok_or_else(|| fault!(path, "unknown law {name:?}; laws: {}", names()))?,
                )
            }
            When::Less(a, b) => Truth::Less(self.number(&path, a)?, self.number(&path, b)?),
            When::Close(a, b) => Truth::Close(self.number(&path, a)?, self.number(&path, b)?),
            When::Cheapest { run, error } => {
                let settings = quantity::settings(run);
                Truth::Cheapest(settings.at(path)?, *error)
            }
            When::Right => Truth::Known(true),
            When::Wrong => Truth::Known(false),
        })
    }
}

/// The action of a step, and how to perform it, in words.
fn press_of(press: &str, context: &Context) -> Result<(Action, String), Refusal> {
    let press = press.trim();
    let digits = press.len() - press.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let (count, key) = press.split_at(digits);
    if let Some(entry) = action::by_key(key) {
        if !count.is_empty() && !entry.takes_count() {
            return Err(refusal!("{key} takes no count"));
        }
        let action = entry.act(count, context)?;
        return Ok((action, format!("press {press} ({})", entry.name)));
    }
    let (word, rest) = press.split_once(' ').unwrap_or((press, ""));
    let found = action::by_name(word).map_err(|why| {
        // No suggestion for short words such as `up`: almost any name is similar.
        let names = action::ACTIONS
            .iter()
            .map(|entry| entry.name)
            .filter(|name| name.len() > 3);
        refusal!("not a key, and {why}{}", did_you_mean(word, names))
    })?;
    let action = action::parse(press, context)?;
    let how = match found.keys.first() {
        Some(key) if rest.is_empty() => format!("press {key} ({})", found.name),
        _ => format!("type :{press} and Enter{}", by_keys(&action)),
    };
    Ok((action, how))
}

/// The shorter way to perform some actions with an argument.
fn by_keys(action: &Action) -> String {
    match action {
        Action::Session(Command::Force { mode, hold, .. }) => {
            let letter = match hold {
                true => action::letter(*mode).to_uppercase(),
                false => action::letter(*mode).to_owned(),
            };
            format!(" (or press m, then {letter})")
        }
        Action::Session(Command::Increment(size)) => format!(" (or press i, then {size}, Enter)"),
        _ => String::new(),
    }
}
