//! The entries of the chooser, in groups, and the filter that a typed text applies.

use crate::view::View;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use stickslip_core::{Model, Stepper};
use stickslip_debugger::teach;
use stickslip_debugger::teach::progress::{LessonProgress, Progress};
use stickslip_debugger::{Frame, Lesson};
use stickslip_platform::{disk, task};
use stickslip_scene::builtin;
use stickslip_scene::{EmbeddedFile, Scene, SceneError};

/// Maximum number of files listed from a folder, and of folder entries examined.
const MOST: usize = 200;
const LOOKED_AT: usize = 5000;

stickslip_core::words! {
    /// Groups in display order.
    pub enum Group, title {
        /// Guided lessons.
        Lessons "Lessons",
        /// The paper's problems and closed-form solutions that verify its theory.
        Paper "The paper",
        /// Scenes whose iterations cycle, jump, or have no solution.
        Oscillations "Oscillations",
        /// Scenes with published reference solutions.
        Benchmarks "Benchmarks",
        /// Scenes in the working directory.
        Files "Your files in this folder",
    }
}

/// An entry of the chooser.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Offer {
    /// Its group.
    pub group: Group,
    /// The name that opens it.
    pub name: String,
    /// Its title; empty if it has not been read yet.
    pub title: String,
    /// The user's progress, for a lesson.
    pub reached: Option<LessonProgress>,
}

impl Offer {
    /// Whether it is a built-in scene.
    pub fn is_scene(&self) -> bool {
        matches!(
            self.group,
            Group::Paper | Group::Oscillations | Group::Benchmarks
        )
    }
}

/// The open chooser.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Chooser {
    /// Index of the selection among the filtered entries.
    pub at: usize,
    /// The filter text.
    pub typed: String,
}

impl Chooser {
    /// The entries whose name, title or group contains every typed word, ignoring case.
    pub fn left<'a>(&self, offers: &'a [Offer]) -> Vec<&'a Offer> {
        let typed = self.typed.to_lowercase();
        offers
            .iter()
            .filter(|offer| {
                let all = format!("{} {} {}", offer.name, offer.title, offer.group.title())
                    .to_lowercase();
                typed.split_whitespace().all(|word| all.contains(word))
            })
            .collect()
    }

    /// The selected entry.
    pub fn selected<'a>(&self, offers: &'a [Offer]) -> Option<&'a Offer> {
        self.left(offers).get(self.at).copied()
    }

    /// Appends to the filter text; an empty text deletes the last letter.
    pub fn type_text(&mut self, text: &str) {
        match text {
            "" => drop(self.typed.pop()),
            _ => self.typed.push_str(text),
        }
        self.at = 0;
    }
}

/// The preview of the selected entry.
#[derive(Debug, Clone)]
pub struct Preview {
    /// Name of the entry.
    pub name: String,
    /// The preview, or why the entry cannot be opened.
    pub what: Result<PreviewContent, String>,
}

/// Content of a preview: a scene, or a lesson with its scene.
#[derive(Debug, Clone)]
pub struct PreviewContent {
    /// Whether it is a lesson.
    pub is_lesson: bool,
    /// The scene's title.
    pub title: String,
    /// Its description.
    pub about: String,
    /// The scene's model.
    pub model: Arc<Model>,
    /// Its initial frame.
    pub frame: Frame,
}

impl Preview {
    /// Loads the preview of an entry. A file can be a scene or a lesson.
    pub fn new(offer: &Offer) -> Preview {
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
    /// The view that draws the preview's shape; `None` if the entry cannot be opened.
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
            attached: None,
            cursor: 0,
            running: false,
            residuals: Vec::new(),
        })
    }
}

/// Loads previews on a background thread.
#[derive(Debug, Default)]
pub struct PreviewLoader(Option<(String, Receiver<Preview>)>);

impl PreviewLoader {
    /// Whether a preview is loading.
    pub fn is_busy(&self) -> bool {
        self.0.is_some()
    }

    /// Returns the preview of the selected entry once it is loaded, and starts loading it if necessary. A closed chooser needs
    /// none.
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
            let (sender, seen) = channel();
            self.0 = Some((offer.name.clone(), seen));
            let offer = offer.clone();
            task::spawn(move || {
                // The receiver may be gone.
                let _ = sender.send(Preview::new(&offer));
            });
        }
        None
    }
}

fn scene(name: &str) -> Result<PreviewContent, SceneError> {
    let scene = Scene::open(name, &[])?;
    let (title, about) = (scene.model.title.clone(), scene.spec.about.clone());
    Ok(glance(scene.model, title, about, false))
}

fn lesson(name: &str) -> Result<PreviewContent, SceneError> {
    let lesson = Lesson::open(name)?;
    let model = (*lesson.model).clone();
    Ok(glance(model, lesson.title, lesson.about, true))
}

fn glance(model: Model, title: String, about: String, is_lesson: bool) -> PreviewContent {
    let model = Arc::new(model);
    let state = Stepper::new(model.clone()).state().clone();
    let frame = Frame {
        state,
        event: None,
        intervention: None,
        monitors: None,
    };
    PreviewContent {
        is_lesson,
        title,
        about,
        model,
        frame,
    }
}

/// The built-in entries, and the files of the working directory.
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
    let scenes = builtin::list().iter().map(scene);
    let lessons = teach::list().iter().map(|lesson| Offer {
        group: Group::Lessons,
        name: lesson.name.into(),
        title: teach::lesson::title(lesson),
        reached: progress.of(lesson.name),
    });
    let mut all: Vec<Offer> = scenes.chain(lessons).collect();
    // The sort is stable: entries keep their order within each group.
    all.sort_by_key(|offer| offer.group as usize);
    all.extend(files(Path::new(".")));
    all
}

/// Scene files of a folder, sorted by name.
pub fn files(folder: &Path) -> Vec<Offer> {
    let Ok(entries) = disk::read_dir(folder) else {
        return Vec::new();
    };
    let name = |entry: disk::DirEntry| {
        let path = entry.path();
        let ending = path.extension().and_then(|ending| ending.to_str())?;
        let wanted = ["ron", "dat"].contains(&ending) && disk::is_file(&path);
        let name = entry.file_name().into_string().ok()?;
        (wanted && !name.starts_with('.')).then_some(name)
    };
    let mut names: Vec<String> = entries
        .take(LOOKED_AT)
        .filter_map(Result::ok)
        .filter_map(name)
        .collect();
    names.sort();
    names.truncate(MOST);
    names
        .into_iter()
        .map(|name| Offer {
            group: Group::Files,
            name,
            title: String::new(),
            reached: None,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filter_keeps_entries_with_all_typed_words() {
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
        assert!(left("TABLE 2").contains(&"table-2".to_owned()));
        let lessons = teach::list().iter().map(|lesson| lesson.name);
        assert_eq!(left("lessons"), lessons.collect::<Vec<_>>());
        assert_eq!(left("hertz block"), ["hertz-cylinder-on-block"]);
        assert!(left("no such scene").is_empty());
    }

    #[test]
    fn every_built_in_entry_has_a_picture() {
        let offers = offers(&Progress::default());
        for offer in offers.iter().filter(|offer| offer.group != Group::Files) {
            let preview = Preview::new(offer);
            let glance = preview.what.unwrap_or_else(|why| panic!("{why}"));
            assert_eq!(glance.title, offer.title);
            assert!(!glance.about.is_empty(), "{}", offer.name);
        }
    }
}
