//! The file format of studies.
//!
//! ```ron
//! (
//!     title: "Effect of the increment",
//!     scene: "02-two-cantilevers-rough",             // or scenes: ["…", "…"]
//!     vary: [("history.increment", [0.05, 0.1]), ("settings.residual", ["stress", "accumulate"])],
//!     set: [("settings.majors", 100)],               // for all runs
//!     x: "u_x", y: "load",                           // the axes of the figure
//!     about: "What to look for.",
//! )
//! ```
//!
//! Paths are those of `check --paths`; a `*` matches any single step (`materials.*.update`), and sets all
//! matching paths to the same value.

use super::builtin;
use serde::{Deserialize, Deserializer};
use stickslip_scene::format::error::{Fault, Path, at, did_you_mean};
use stickslip_scene::format::locate::{locate, too_deep};
use stickslip_scene::format::read::{text, value};
use stickslip_scene::readers::or_mistaken;
use stickslip_scene::scene::placed;
use stickslip_scene::{FileKind, Scene, SceneError};

/// A study, before its scenes are checked.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Study {
    /// Path of the file, or name of the built-in study or scene.
    pub name: String,
    /// Title; empty for the scene's.
    pub title: String,
    /// What the study shows, for the reader.
    pub about: String,
    /// Scenes, as for `Scene::open`; at least one.
    pub scenes: Vec<String>,
    /// Varied settings; the last one changes fastest.
    pub vary: Vec<Vary>,
    /// Settings of all runs: path and value.
    pub set: Vec<(String, String)>,
    /// Horizontal axis; `None` for the first monitor.
    pub x: Option<AxisQuantity>,
    /// Vertical axis; `None` for the load factor.
    pub y: Option<AxisQuantity>,
    /// The text of its file, where errors have a line; empty if there is none, or a value of the file was replaced.
    pub text: String,
}

/// One setting and the values that it takes.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(from = "(String, Vec<Word>)")]
pub struct Vary {
    /// Path of the setting.
    pub path: String,
    /// Its values, as typed.
    pub values: Vec<String>,
}

impl Vary {
    /// Parses a varied setting: `PATH=A,B,C`. A value may be a range: `0.01..0.1/4` means four evenly
    /// spaced values, including the ends, `0.01..0.1/4log` for four in constant ratio. `2x` is twice the
    /// scene's value (computed by the plan).
    ///
    /// # Errors
    /// If the text does not have this form.
    pub fn parse(text: &str) -> Result<Vary, String> {
        let Some((path, values)) = text.split_once('=') else {
            return Err("expected PATH=A,B,C, such as history.increment=0.01,0.02".to_owned());
        };
        let values: Result<Vec<Vec<String>>, String> = values
            .split(',')
            .map(|value| spread(value.trim()))
            .collect();
        Ok(Vary {
            path: path.trim().to_owned(),
            values: values?.concat(),
        })
    }
}

/// Largest number of values of a range.
const MOST_OF_RANGE: u32 = 1000;

/// A value, or the values of a range.
fn spread(value: &str) -> Result<Vec<String>, String> {
    let Some((low, rest)) = value.split_once("..") else {
        return Ok(vec![value.to_owned()]);
    };
    let wrong = || {
        format!(
            "{value}: expected a range LOW..HIGH/COUNT or LOW..HIGH/COUNTlog, such as 0.01..0.1/4"
        )
    };
    let (high, count) = rest.split_once('/').ok_or_else(wrong)?;
    let (count, even_ratios) = match count.strip_suffix("log") {
        Some(count) => (count, true),
        None => (count, false),
    };
    let number = |text: &str| text.parse::<f64>().ok().filter(|x| x.is_finite());
    let (low, high) = number(low).zip(number(high)).ok_or_else(wrong)?;
    let count: u32 = count.parse().map_err(|_| wrong())?;
    if !(2..=MOST_OF_RANGE).contains(&count) {
        return Err(format!(
            "{value}: the range has {count} values; it must have 2 to {MOST_OF_RANGE}"
        ));
    }
    if even_ratios && !(low > 0.0 && high > 0.0) {
        return Err(format!(
            "{value}: the ends of a logarithmic range must be above 0"
        ));
    }
    let at = |k: u32| {
        let part = f64::from(k) / f64::from(count - 1);
        let value = if even_ratios {
            low * (high / low).powf(part)
        } else {
            low + (high - low) * part
        };
        // Formatted as typed, without the round-off of the division.
        format!("{value:.9e}")
            .parse::<f64>()
            .map_or(value, |short| short)
    };
    Ok((0..count).map(|k| at(k).to_string()).collect())
}

/// A quantity of an accepted increment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AxisQuantity {
    /// Number of the increment.
    Increment,
    /// The load factor λ.
    Load,
    /// Major iterations of the increment.
    Majors,
    /// Minor iterations of the increment.
    Minors,
    /// A monitor of the scene, by name.
    Monitor(String),
}

impl AxisQuantity {
    /// The quantity with this name; other words are names of monitors.
    pub fn named(name: &str) -> AxisQuantity {
        match name {
            "increment" => AxisQuantity::Increment,
            "load" => AxisQuantity::Load,
            "majors" => AxisQuantity::Majors,
            "minors" => AxisQuantity::Minors,
            monitor => AxisQuantity::Monitor(monitor.to_owned()),
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        match self {
            AxisQuantity::Increment => "increment",
            AxisQuantity::Load => "load",
            AxisQuantity::Majors => "majors",
            AxisQuantity::Minors => "minors",
            AxisQuantity::Monitor(name) => name,
        }
    }
}

impl Study {
    /// A study of one unchanged scene, with nothing varied yet.
    pub fn from_scene(name: &str) -> Study {
        Study {
            name: name.to_owned(),
            scenes: vec![name.to_owned()],
            ..Study::default()
        }
    }

    /// Opens a study file, a built-in study, or a scene to be varied; a file takes precedence.
    ///
    /// # Errors
    /// If nothing has this name, or the study cannot be read. Scenes are not read yet.
    pub fn open(name: &str) -> Result<Study, SceneError> {
        if std::path::Path::new(name).exists() {
            let text = text(name, "studies and scenes are written in RON")?;
            return if is_study(&text) {
                Study::from_text(name, &text)?.open_scenes(name)
            } else {
                Ok(Study::from_scene(name))
            };
        }
        if let Some(builtin) = builtin::find(name) {
            return Study::from_text(builtin.name, builtin.text);
        }
        if stickslip_scene::builtin::find(name).is_some() {
            return Ok(Study::from_scene(name));
        }
        Err(SceneError::whole(name, nothing_there(name)))
    }

    /// Parses a study; `name` is its name for messages.
    ///
    /// # Errors
    /// If it cannot be read, with line and column.
    pub fn from_text(name: &str, text: &str) -> Result<Study, SceneError> {
        let file: StudyFile = value(name, text, "study")
            .map_err(|error| or_mistaken(error, name, text, FileKind::Study))?;
        let mut study = Study {
            name: name.to_owned(),
            title: file.title,
            about: file.about,
            scenes: file.scenes,
            vary: file.vary,
            set: file.set,
            x: file.x.as_deref().map(AxisQuantity::named),
            y: file.y.as_deref().map(AxisQuantity::named),
            text: text.to_owned(),
        };
        if file.scene.is_some() && !study.scenes.is_empty() {
            let twice = "a study needs either scene or scenes, not both";
            return Err(study.fault(&at!["scenes"], twice));
        }
        study.scenes.extend(file.scene);
        if study.scenes.is_empty() {
            let message = "a study needs a scene: \"NAME\", or scenes: [\"NAME\", \"NAME\"]";
            return Err(study.fault(&at![], message));
        }
        Ok(study)
    }

    /// An error at a value of the file; without a line if the value is not from there.
    pub(super) fn fault(&self, at: &Path, message: impl Into<String>) -> SceneError {
        let place = locate(&self.text, at);
        let mut around = at.clone();
        // A value that the file does not contain has the place of the one around it.
        let is_there = around.0.pop().is_none() || locate(&self.text, &around) != place;
        let (text, at) = match is_there && !self.text.is_empty() {
            true => (self.text.as_str(), at.clone()),
            false => ("", Path::default()),
        };
        placed(&self.name, text, &[], Fault::new(at, message))
    }

    /// The error of a scene about the k-th setting, of `set` and then `vary`, at its place in the file.
    pub(super) fn setting_fault(&self, k: usize, error: SceneError) -> SceneError {
        let at = match k.checked_sub(self.set.len()) {
            None => at!["set", k],
            Some(k) => at!["vary", k],
        };
        let message = match self.scenes.len() {
            1 => error.message.clone(),
            _ => format!("in {}: {}", error.file, error.message),
        };
        let fault = self.fault(&at, message);
        if fault.at.is_some() { fault } else { error }
    }

    /// Varies another setting, or replaces its values.
    pub fn vary(&mut self, vary: Vary) {
        match self.vary.iter_mut().find(|old| old.path == vary.path) {
            Some(old) => {
                *old = vary;
                self.text.clear();
            }
            None => self.vary.push(vary),
        }
    }

    /// The study of a file; [`Scene::named_in`] opens its scenes.
    fn open_scenes(mut self, file: &str) -> Result<Study, SceneError> {
        for k in 0..self.scenes.len() {
            self.scenes[k] = Scene::named_in(file, &self.scenes[k])
                .map_err(|why| self.fault(&self.scene_at(k), why))?;
        }
        Ok(self)
    }

    /// Where the file names its k-th scene.
    fn scene_at(&self, k: usize) -> Path {
        let whole = locate(&self.text, &at![]);
        match locate(&self.text, &at!["scene"]) == whole {
            true => at!["scenes", k],
            false => at!["scene"],
        }
    }
}

/// The fields of the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StudyFile {
    title: String,
    #[serde(default)]
    about: String,
    scene: Option<String>,
    #[serde(default)]
    scenes: Vec<String>,
    #[serde(default)]
    vary: Vec<Vary>,
    #[serde(default, deserialize_with = "pairs")]
    set: Vec<(String, String)>,
    x: Option<String>,
    y: Option<String>,
}

/// A value of a setting.
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "a value must be a number, true, false, or a text in quotes"
)]
enum Word {
    Flag(bool),
    Natural(u64),
    Integer(i64),
    Number(f64),
    Text(String),
}

impl From<Word> for String {
    /// As typed.
    fn from(word: Word) -> String {
        match word {
            Word::Flag(flag) => flag.to_string(),
            Word::Natural(number) => number.to_string(),
            Word::Integer(number) => number.to_string(),
            Word::Number(number) => format!("{number:?}"),
            Word::Text(text) => text,
        }
    }
}

impl From<(String, Vec<Word>)> for Vary {
    fn from((path, words): (String, Vec<Word>)) -> Vary {
        let values = words.into_iter().map(String::from).collect();
        Vary { path, values }
    }
}

/// Settings in a file: path and value of each.
pub(super) fn pairs<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<(String, String)>, D::Error> {
    Ok(Vec::<(String, Word)>::deserialize(from)?
        .into_iter()
        .map(|(path, word)| (path, word.into()))
        .collect())
}

/// Whether a text is a study, valid or not: it names scenes or varies something, which no scene does.
fn is_study(text: &str) -> bool {
    if too_deep(text).is_some() {
        // It is neither; the parser reports that.
        return true;
    }
    let whole = locate(text, &Path::default());
    ["scene", "scenes", "vary"]
        .iter()
        .any(|field| locate(text, &at![*field]) != whole)
}

fn nothing_there(name: &str) -> String {
    let studies: Vec<&str> = builtin::list().iter().map(|s| s.name).collect();
    let scenes: Vec<&str> = stickslip_scene::builtin::list()
        .iter()
        .map(|s| s.name)
        .collect();
    format!(
        "no such file, built-in study or scene{} (studies: {}; scenes: {})",
        did_you_mean(name, studies.iter().chain(&scenes).copied()),
        studies.join(", "),
        scenes.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<String> {
        Vary::parse(text).unwrap().values
    }

    #[test]
    fn ranges_include_their_ends() {
        assert_eq!(values("a=1,2, 3x"), ["1", "2", "3x"]);
        assert_eq!(values("a=0.1..0.4/4"), ["0.1", "0.2", "0.3", "0.4"]);
        assert_eq!(values("a=0.01..1/3log,5"), ["0.01", "0.1", "1", "5"]);
        assert_eq!(values("a=-1..1/3"), ["-1", "0", "1"]);
        for wrong in [
            "a",
            "a=1..2",
            "a=1..2/1",
            "a=x..2/3",
            "a=0..1/3log",
            "a=1..2/2.5",
        ] {
            assert!(Vary::parse(wrong).is_err(), "{wrong}");
        }
        let many = Vary::parse("a=0..1/100000").unwrap_err();
        assert!(
            many.ends_with("the range has 100000 values; it must have 2 to 1000"),
            "{many}"
        );
    }
}
