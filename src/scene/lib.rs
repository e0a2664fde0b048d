//! Reads scene files (through [`format`](mod@format)), checks them, and compiles them to the model that the solver uses.
//!
//! - `compile`, with [`nodes`], `curves`, `blocks`, `geometry` and [`limits`]: converts a [`Spec`] to a [`Model`], or reports
//!   errors.
//! - [`cost`]: estimated time and memory of a scene, and unused features; [`memory`]: available memory.
//! - [`base`]: a scene read once for many settings; [`solver`]: creates the solver of a scene, with all threads.
//! - `deck`: CalculiX and Abaqus decks; [`import`]: meshes of other programs.
//! - [`attached`]: scenes sent by attached solvers.
//! - `pressed`: detects prescribed displacements that compress a solid beyond the range of its law.
//! - [`problems`]: interface problems of other programs.
//! - [`builtin`]: the built-in scenes; [`embedded`](mod@embedded): other embedded files.
//! - [`shown`]: makes external text safe for a terminal, table or picture; [`number`]: formats numbers for people.
//! - [`calculix`]: the files of a finished CalculiX run.

#![forbid(unsafe_code)]

pub mod attached;
pub mod base;
pub mod bonds;
pub mod builtin;
pub mod calculix;
pub mod cost;
pub mod embedded;
pub mod format;
pub mod gaps;
pub mod import;
pub mod limits;
pub mod memory;
pub mod nodes;
pub mod number;
pub mod precision;
pub mod problems;
pub mod shown;
pub mod solver;

mod areas;
mod blocks;
mod compile;
mod corners;
mod curves;
mod deck;
mod geometry;
mod pressed;

use crate::format::condensed::Problem;
use crate::format::kind;
use crate::format::paths::Override;
use crate::format::{Fault, SceneError, Spec, condensed, error, locate, paths, read, stored};
pub use problems::siconos;
use stickslip_core::model::Model;
use stickslip_exchange::attach::message;
use stickslip_exchange::matrix_market;
use stickslip_platform::{disk, input};

pub use compile::increments;
use nodes::Names;

/// Where an interface problem in space cannot be used.
pub const IN_SPACE: &str = "the interface problem is one in space, which `stickslip FILE`, `run`, `record` and `remedies` solve";

/// A scene that has been read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Path of the file, or name of the built-in scene.
    pub name: String,
    /// The file's text; empty for a scene created from a [`Spec`].
    pub text: String,
    /// The author's input, including values set from outside.
    pub spec: Spec,
    /// The model that the solver uses.
    pub model: Model,
    /// Warnings about parts of the file that were ignored or reinterpreted: location and text.
    pub remarks: Vec<String>,
    names: Names,
    overrides: Vec<Override>,
    imports: bool,
}

impl Scene {
    /// Opens a scene file, or a built-in scene by name; a file with that name takes precedence. `overrides` are pairs of path and
    /// value, as in `--set`.
    ///
    /// # Errors
    /// If the scene does not exist, is invalid, or is an interface problem in space.
    pub fn open(name: &str, overrides: &[(String, String)]) -> Result<Scene, SceneError> {
        let scene = Scene::open_any(name, overrides)?;
        match scene.spec.in_space {
            None => Ok(scene),
            Some(_) => Err(SceneError::whole(name, IN_SPACE)),
        }
    }

    /// As [`Scene::open`], also for an interface problem in space, which has its own solver ([`solver::any_solver`]).
    ///
    /// # Errors
    /// If the scene does not exist or is invalid.
    pub fn open_any(name: &str, overrides: &[(String, String)]) -> Result<Scene, SceneError> {
        if !disk::is_file(name)
            && let Some(builtin) = builtin::find(name)
        {
            return Scene::from_text(builtin.name, builtin.text, overrides);
        }
        if import::is_mesh(name) {
            return Err(SceneError::whole(name, import::no_scene(name)));
        }
        if let Some(problem) = problems::opened::from_file(name, overrides) {
            return Scene::assemble(name, "", problem?.spec(), overrides, Vec::new());
        }
        let text = match deck::is_called_so(name) {
            true => {
                deck::text(std::path::Path::new(name)).map_err(|error| read::unread(name, error))
            }
            false => read::text(name),
        };
        let text = text.map_err(|mut error| {
            if !disk::exists(name) {
                error.message = no_such_scene(name);
            }
            error
        })?;
        Scene::from_text(name, &text, overrides)
    }

    /// Opens a scene named in the file `own`: a file in the same folder or below, as for the files named in scenes and decks, or
    /// a built-in scene.
    ///
    /// # Errors
    /// A message with the reason.
    pub fn named_in(own: &str, named: &str) -> Result<String, String> {
        let own = std::path::Path::new(own);
        let found = match input::path_in_folder(own, named.trim_start_matches("./")) {
            Ok(path) if disk::is_file(&path) => return Ok(path.to_string_lossy().into_owned()),
            Ok(_) => "not a file".to_owned(),
            Err(why) => why,
        };
        if builtin::find(named).is_some() {
            return Ok(named.to_owned());
        }
        let names = builtin::list().iter().map(|scene| scene.name);
        let (quoted, similar) = (error::quoted(named), error::did_you_mean(named, names));
        Err(format!(
            "no scene {quoted} in the folder of this file or below, and no built-in scene of that name{similar}: {found}"
        ))
    }

    /// Reads a scene from a text, or converts the text to one ([`condensed`], [`problems`]). `name` identifies it in messages,
    /// and files that it names are relative to a file of that name.
    ///
    /// # Errors
    /// If the scene is invalid.
    pub fn from_text(
        name: &str,
        text: &str,
        overrides: &[(String, String)],
    ) -> Result<Scene, SceneError> {
        let source = Source {
            name,
            text,
            overrides,
        };
        match FORMS.iter().find(|(recognise, _)| recognise(text)) {
            Some((_, read)) => read(&source),
            None => source.ron(),
        }
    }

    /// Checks a scene without a text, such as one from a snapshot.
    ///
    /// # Errors
    /// If the scene is invalid; the error has no line then.
    pub fn from_spec(name: &str, spec: Spec) -> Result<Scene, SceneError> {
        Scene::assemble(name, "", spec, &[], Vec::new())
    }

    /// The scene sent by an attached solver, under a name; `increment` is its first increment, if it sends one.
    ///
    /// # Errors
    /// If the scene is invalid.
    pub fn from_message(
        name: &str,
        message: &message::Scene,
        increment: Option<f64>,
    ) -> Result<Scene, SceneError> {
        Scene::from_spec(name, attached::spec(message, increment))
    }

    /// Checks a scene that is embedded in another file, at a path of its text; `name` identifies the file in messages.
    ///
    /// # Errors
    /// If the scene is invalid, with the location in that file.
    pub fn within(
        name: &str,
        text: &str,
        path: &error::Path,
        mut spec: Spec,
    ) -> Result<Scene, SceneError> {
        let at = |fault: Fault| {
            let whole = error::Path(path.0.iter().chain(&fault.path.0).cloned().collect());
            placed(name, text, &[], Fault::new(whole, fault.message))
        };
        imported(&mut spec, name, at)?;
        Scene::compiled(name, "", spec, Vec::new(), |_, fault| at(fault))
    }

    /// This scene with one scalar changed, as by `--set` or by the debugger's `:set`.
    ///
    /// # Errors
    /// If the path does not exist, or the scene is invalid with the value.
    pub fn with(&self, path: &str, value: &str) -> Result<Scene, SceneError> {
        self.with_all(&[(path.to_owned(), value.to_owned())])
    }

    /// This scene with several scalars changed, one after the other.
    ///
    /// # Errors
    /// As [`Scene::with`].
    pub fn with_all(&self, changes: &[(String, String)]) -> Result<Scene, SceneError> {
        let scene = Scene::assemble(
            &self.name,
            &self.text,
            self.spec.clone(),
            changes,
            self.overrides.clone(),
        )?;
        Ok(Scene {
            remarks: self.remarks.clone(),
            imports: self.imports,
            ..scene
        })
    }

    /// Number of a node by any of its names: `ID.3`, `ID.end`, `ID@0.5`, or the id of a single node.
    ///
    /// # Errors
    /// A message that lists the existing names.
    pub fn node(&self, name: &str) -> Result<usize, String> {
        self.names.node(name)
    }

    /// Whether its text refers to mesh files, whose content the spec already includes.
    pub fn imports(&self) -> bool {
        self.imports
    }

    /// All node names and what they refer to.
    pub fn names(&self) -> &Names {
        &self.names
    }

    /// The values set from outside, in order: path and value.
    pub fn overrides(&self) -> impl Iterator<Item = (&str, &str)> {
        self.overrides
            .iter()
            .map(|o| (o.path.as_str(), o.value.as_str()))
    }

    fn assemble(
        name: &str,
        text: &str,
        spec: Spec,
        changes: &[(String, String)],
        overrides: Vec<Override>,
    ) -> Result<Scene, SceneError> {
        let (spec, overrides) = changed(name, spec, changes, overrides)?;
        let place = |overrides: &[Override], fault| placed(name, text, overrides, fault);
        Scene::compiled(name, text, spec, overrides, place)
    }

    fn compiled(
        name: &str,
        text: &str,
        spec: Spec,
        overrides: Vec<Override>,
        place: impl Fn(&[Override], Fault) -> SceneError,
    ) -> Result<Scene, SceneError> {
        let (model, names) = compile::compile(&spec).map_err(|fault| place(&overrides, fault))?;
        Ok(Scene {
            name: name.to_owned(),
            text: text.to_owned(),
            spec,
            model,
            remarks: Vec::new(),
            names,
            overrides,
            imports: false,
        })
    }
}

/// An input format: how to recognise and how to read it.
type Form = (fn(&str) -> bool, fn(&Source) -> Result<Scene, SceneError>);

/// The formats, in the order in which they are tried; all other text is read as RON.
const FORMS: [Form; 5] = [
    // The contact elements of a run begin like a deck.
    (
        |text| deck::is_one(text) && !kind::is_contacts(text),
        |source| source.deck(),
    ),
    (
        |text| text.starts_with(matrix_market::MARK),
        |source| source.problem(problems::market::read),
    ),
    (
        |text| locate::head(text) == Some(stored::HEAD),
        |source| source.problem(problems::stored::read),
    ),
    (siconos::is_one, |source| {
        source.problem(problems::opened::siconos)
    }),
    (
        |text| locate::head(text) == Some(condensed::HEAD),
        |source| source.condensed(),
    ),
];

/// The text of a scene and the values set from outside.
struct Source<'a> {
    name: &'a str,
    text: &'a str,
    overrides: &'a [(String, String)],
}

impl Source<'_> {
    fn problem(
        &self,
        read: fn(&str, &str, Option<f64>) -> Result<Problem, SceneError>,
    ) -> Result<Scene, SceneError> {
        let problem = read(
            self.name,
            self.text,
            problems::opened::memory(self.overrides),
        )?;
        Scene::assemble(self.name, "", problem.spec(), self.overrides, Vec::new())
    }

    fn condensed(&self) -> Result<Scene, SceneError> {
        let (name, text) = (self.name, self.text);
        let problem = read::problem(name, text)?;
        if let Some(what) = problem.unfit_in_space() {
            return Err(SceneError::whole(name, what));
        }
        let place = |overrides: &[Override], fault: Fault| {
            let own = Fault::new(problem.origin(&fault.path), fault.message.clone());
            match placed(name, "", overrides, fault) {
                set if set.set.is_some() => set,
                _ => placed(name, text, &[], own),
            }
        };
        // The text is not a scene's, so values set later cannot be located in it.
        let (spec, overrides) = changed(name, problem.spec(), self.overrides, Vec::new())?;
        Scene::compiled(name, "", spec, overrides, place)
    }

    fn ron(&self) -> Result<Scene, SceneError> {
        let (name, text) = (self.name, self.text);
        let spec = read::spec(name, text)?;
        let place = |overrides: &[Override], fault| placed(name, text, overrides, fault);
        if spec.attached.is_some() {
            let why = "this is the scene of an attached solver, and only that solver can solve it: stickslip attach -- COMMAND";
            return Err(place(&[], Fault::new(error::at!["attached"], why)));
        }
        let (mut spec, overrides) = changed(name, spec, self.overrides, Vec::new())?;
        let imports = imported(&mut spec, name, |fault| place(&overrides, fault))?;
        let scene = Scene::compiled(name, text, spec, overrides, place)?;
        Ok(Scene { imports, ..scene })
    }

    fn deck(&self) -> Result<Scene, SceneError> {
        let name = self.name;
        let read = deck::read(name, self.text)?;
        let place = |overrides: &[Override], fault: Fault| {
            let own = read.origin.of(&fault.path);
            let own = own.map(|(file, at)| (file.to_owned(), at));
            match (placed(name, "", overrides, fault), own) {
                (fault, Some((file, at))) if fault.set.is_none() => SceneError {
                    file,
                    at: Some(at),
                    ..fault
                },
                (fault, _) => fault,
            }
        };
        let (spec, overrides) = changed(name, read.spec.clone(), self.overrides, Vec::new())?;
        let mut scene = Scene::compiled(name, "", spec, overrides, place)?;
        scene.remarks = read.remarks;
        Ok(scene)
    }
}

/// Reads the meshes that a scene imports, and returns whether there are any; `name` is the scene's file, and `place` locates
/// errors in it.
fn imported(
    spec: &mut Spec,
    name: &str,
    place: impl Fn(Fault) -> SceneError,
) -> Result<bool, SceneError> {
    import::resolve(spec, name).map_err(|refused| match refused {
        import::ImportError::Here(fault) => place(fault),
        import::ImportError::There(error) => error,
    })
}

/// The scene of a file with additional values set from outside.
fn changed(
    name: &str,
    mut spec: Spec,
    changes: &[(String, String)],
    mut overrides: Vec<Override>,
) -> Result<(Spec, Vec<Override>), SceneError> {
    for (path, value) in changes {
        let change = paths::set(&mut spec, path, value).map_err(|why| SceneError {
            set: Some(error::shortened(&format!("{path}={value}"))),
            ..SceneError::whole(name, why.to_string())
        })?;
        overrides.retain(|earlier| earlier.at != change.at);
        overrides.push(change);
    }
    Ok((spec, overrides))
}

/// Determines the origin of a fault: a value set from outside, or a line of the file.
pub fn placed(file: &str, text: &str, overrides: &[Override], fault: Fault) -> SceneError {
    let Fault { path, message } = fault;
    // The last setting is the most likely cause; a fault of a compound value is attributed to a part of it that was set.
    let blamed = |o: &&Override| path == o.at || (!path.0.is_empty() && path.contains(&o.at));
    let set = overrides
        .iter()
        .rev()
        .find(blamed)
        .map(|o| error::shortened(&format!("{}={}", o.path, o.value)));
    let at = (set.is_none() && !text.is_empty())
        .then(|| locate::line_and_column(text, locate::locate(text, &path).start));
    SceneError {
        file: file.to_owned(),
        at,
        set,
        path: path.to_string(),
        message,
    }
}

fn no_such_scene(name: &str) -> String {
    let names = || builtin::list().iter().map(|scene| scene.name);
    let near = match error::did_you_mean_file(name) {
        none if none.is_empty() => error::did_you_mean(name, names()),
        near => near,
    };
    format!("no such file or built-in scene{near} (`stickslip list` shows the built-in ones)")
}
