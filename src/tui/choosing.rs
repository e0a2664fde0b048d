//! What the chooser offers, in groups, and which of it a typed text leaves.

use crate::view::View;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use stickslip_core::model::Model;
use stickslip_core::step::stepper::Stepper;
use stickslip_debugger::history::frame::Frame;
use stickslip_debugger::teach::progress::{Progress, Reached};
use stickslip_debugger::teach::{self, Lesson};
use stickslip_scene::embedded::EmbeddedFile;
use stickslip_scene::format::SceneError;
use stickslip_scene::{Scene, builtin};

/// Most files of a folder that are offered, and most entries that are looked at.
const MOST: usize = 200;
const LOOKED_AT: usize = 5000;

/// The groups, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// The paper's problems, and closed forms that its theory is held against.
    Paper,
    /// Scenes whose iterations oscillate, jump, or have no answer.
    Oscillations,
    /// Guided lessons.
    Lessons,
    /// Scenes whose answers are known from elsewhere.
    Benchmarks,
    /// Scenes in the folder in which the program was started.
    Files,
}

stickslip_core::words! {
    Group, title:
    Paper "The paper",
    Oscillations "Oscillations",
    Lessons "Lessons",
    Benchmarks "Benchmarks",
    Files "Your files in this folder",
}

/// Something that the chooser offers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Offer {
    /// Where it stands.
    pub group: Group,
    /// The name by which it is opened.
    pub name: String,
    /// Its title; empty where it is not read yet.
    pub title: String,
    /// The user's progress, if it is a lesson.
    pub reached: Option<Reached>,
}

impl Offer {
    /// Whether it is a scene that the program carries.
    pub fn is_scene(&self) -> bool {
        matches!(
            self.group,
            Group::Paper | Group::Oscillations | Group::Benchmarks
        )
    }
}

/// The list of what can be opened, while it is shown.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Chooser {
    /// What is selected of what is left, from 0.
    pub at: usize,
    /// What was typed.
    pub typed: String,
}

impl Chooser {
    /// The offers that have every typed word in their name, title or group, whatever the case of its letters.
    pub fn left<'a>(&self, offers: &'a [Offer]) -> Vec<&'a Offer> {
        let typed = self.typed.to_lowercase();
        let has = |offer: &&Offer| {
            let all = format!("{} {} {}", offer.name, offer.title, offer.group.title());
            let all = all.to_lowercase();
            typed.split_whitespace().all(|word| all.contains(word))
        };
        offers.iter().filter(has).collect()
    }

    /// The selected one.
    pub fn selected<'a>(&self, offers: &'a [Offer]) -> Option<&'a Offer> {
        self.left(offers).get(self.at).copied()
    }

    /// Types a text behind what was typed, or with none takes the last letter away.
    pub fn type_text(&mut self, text: &str) {
        match text {
            "" => drop(self.typed.pop()),
            _ => self.typed.push_str(text),
        }
        self.at = 0;
    }
}

/// What is known of the selected offer, for its preview.
#[derive(Debug, Clone)]
pub struct Preview {
    /// Whose it is.
    pub name: String,
    /// What it is, or why it cannot be opened.
    pub what: Result<Glance, String>,
}

/// A first look at a scene, alone or of a lesson.
#[derive(Debug, Clone)]
pub struct Glance {
    /// Whether it is a lesson.
    pub is_lesson: bool,
    /// Its title.
    pub title: String,
    /// What it is about.
    pub about: String,
    /// The scene's model.
    pub model: Arc<Model>,
    /// Its start.
    pub frame: Frame,
}

impl Preview {
    /// Looks at an offer. A file can be a scene or a lesson.
    pub fn of(offer: &Offer) -> Preview {
        let name = offer.name.clone();
        let what = match offer.group {
            Group::Lessons => lesson(&name),
            Group::Files => scene(&name).or_else(|why| lesson(&name).map_err(|_| why)),
            Group::Paper | Group::Oscillations | Group::Benchmarks => scene(&name),
        };
        let what = what.map_err(|why| why.to_string());
        Preview { name, what }
    }
}

impl Preview {
    /// What the shape shows of it, where it can be opened.
    pub fn view(&self) -> Option<View<'_>> {
        let glance = self.what.as_ref().ok()?;
        Some(View {
            name: &self.name,
            scene: None,
            model: &glance.model,
            frames: std::slice::from_ref(&glance.frame),
            strips: &[],
            tree: None,
            background: None,
            aside: String::new(),
            start_gaps: "",
            guest: None,
            cursor: 0,
            running: false,
            residuals: Vec::new(),
        })
    }
}

/// An offer that is looked at, on a thread of its own.
#[derive(Debug, Default)]
pub struct Looking(Option<(String, Receiver<Preview>)>);

impl Looking {
    /// Whether something is looked at.
    pub fn is_busy(&self) -> bool {
        self.0.is_some()
    }

    /// What was found of the selected offer, once it is there; begins to look at it where it is not known yet. Nobody looks
    /// for a closed chooser.
    pub fn follow(
        &mut self,
        chooser: Option<&Chooser>,
        offers: &[Offer],
        known: Option<&Preview>,
    ) -> Option<Preview> {
        let Some(offer) = chooser.and_then(|chooser| chooser.selected(offers)) else {
            self.0 = None;
            return None;
        };
        if let Some(Ok(preview)) = self.0.as_ref().map(|(_, seen)| seen.try_recv()) {
            self.0 = None;
            return Some(preview);
        }
        let asked = self.0.as_ref().map(|(name, _)| name);
        if known.map(|seen| &seen.name) != Some(&offer.name) && asked != Some(&offer.name) {
            let (told, seen) = channel();
            self.0 = Some((offer.name.clone(), seen));
            let offer = offer.clone();
            thread::spawn(move || {
                // Nobody may want it any more.
                let _ = told.send(Preview::of(&offer));
            });
        }
        None
    }
}

fn scene(name: &str) -> Result<Glance, SceneError> {
    let scene = Scene::open(name, &[])?;
    let (title, about) = (scene.model.title.clone(), scene.spec.about.clone());
    Ok(glance(scene.model, title, about, false))
}

fn lesson(name: &str) -> Result<Glance, SceneError> {
    let lesson = Lesson::open(name)?;
    let model = (*lesson.model).clone();
    Ok(glance(model, lesson.title, lesson.about, true))
}

fn glance(model: Model, title: String, about: String, is_lesson: bool) -> Glance {
    let model = Arc::new(model);
    let state = Stepper::new(model.clone()).state().clone();
    let frame = Frame {
        state,
        event: None,
        intervention: None,
        monitors: None,
    };
    Glance {
        is_lesson,
        title,
        about,
        model,
        frame,
    }
}

/// What the program itself has, and the files of the folder in which it runs.
pub fn offers(progress: &Progress) -> Vec<Offer> {
    let scene = |scene: &EmbeddedFile| Offer {
        group: match scene.name.split('-').next() {
            Some("osc") => Group::Oscillations,
            Some("bench") => Group::Benchmarks,
            _ => Group::Paper,
        },
        name: scene.name.into(),
        title: builtin::title(scene),
        reached: None,
    };
    let lesson = |lesson: &EmbeddedFile| Offer {
        group: Group::Lessons,
        name: lesson.name.into(),
        title: teach::lesson::title(lesson),
        reached: progress.of(lesson.name),
    };
    let scenes = builtin::list().iter().map(scene);
    let lessons = teach::list().iter().map(lesson);
    let mut all: Vec<Offer> = scenes.chain(lessons).collect();
    // Groups stand together, each in its own order.
    all.sort_by_key(|offer| offer.group as usize);
    all.extend(files(Path::new(".")));
    all
}

/// Scene files of a folder, by name.
pub fn files(folder: &Path) -> Vec<Offer> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let name = |entry: std::fs::DirEntry| {
        let path = entry.path();
        let ending = path.extension().and_then(|ending| ending.to_str())?;
        let wanted = ["ron", "dat"].contains(&ending) && path.is_file();
        let name = entry.file_name().into_string().ok()?;
        (wanted && !name.starts_with('.')).then_some(name)
    };
    let entries = entries.take(LOOKED_AT).filter_map(Result::ok);
    let mut names: Vec<String> = entries.filter_map(name).collect();
    names.sort();
    names.truncate(MOST);
    let offer = |name| Offer {
        group: Group::Files,
        name,
        title: String::new(),
        reached: None,
    };
    names.into_iter().map(offer).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typed_words_leave_what_has_them_all() {
        let offers = offers(&Progress::default());
        let left = |typed: &str| -> Vec<String> {
            let chooser = Chooser {
                typed: typed.into(),
                at: 0,
            };
            let left = chooser.left(&offers);
            left.iter().map(|offer| offer.name.clone()).collect()
        };
        assert_eq!(left("").len(), offers.len());
        assert!(left("TABLE 2").contains(&"2-table-2".to_owned()));
        let lessons = teach::list().iter().map(|lesson| lesson.name);
        assert_eq!(left("lessons"), lessons.collect::<Vec<_>>());
        assert_eq!(left("hertz block"), ["hertz-cylinder-on-block"]);
        assert!(left("no such scene").is_empty());
    }

    #[test]
    fn every_offer_of_the_program_has_a_picture() {
        let offers = offers(&Progress::default());
        for offer in offers.iter().filter(|offer| offer.group != Group::Files) {
            let preview = Preview::of(offer);
            let glance = preview.what.unwrap_or_else(|why| panic!("{why}"));
            assert_eq!(glance.title, offer.title);
            assert!(!glance.about.is_empty(), "{}", offer.name);
        }
    }
}
