//! Opens files: recognises the kind of a file from its text, names the command that reads it, and reads those that contain a
//! scene.
//!
//! Readers ask for the kind before reporting a syntax error: for a snapshot the message is not "unknown field in a scene".

use crate::format::condensed::Problem;
use crate::format::error::{self, Path, Step, at};
use crate::format::locate::{head, locate, too_deep};
use crate::format::paths::Override;
use crate::format::{Fault, condensed, read, stored};
use crate::scene::{changed, placed};
use crate::{Scene, SceneError};
use crate::{builtin, calculix, deck, import, problems, shown};
use problems::siconos;
use stickslip_exchange::attach::conversation;
use stickslip_exchange::matrix_market;
use stickslip_platform::{disk, input};

/// Where an interface problem in space cannot be used.
pub const IN_SPACE: &str = "this is an interface problem in space; only `stickslip FILE`, `run`, `record` and `remedies` take it";

/// The kinds of files that the program reads or writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A scene or an interface problem, in RON or in another program's format.
    Scene,
    /// A Gmsh mesh.
    Mesh,
    /// A recorded state.
    Snapshot,
    /// The commands of a session.
    Journal,
    /// A guided lesson.
    Lesson,
    /// A parameter study of a scene.
    Study,
    /// Definition of a work-precision chart.
    Chart,
    /// Result table of a work-precision chart.
    ChartTable,
    /// Any other table written by a run or a sweep.
    Table,
    /// Stored results of a map.
    Results,
    /// A terminal recording of a session.
    Cast,
    /// Contact elements of a CalculiX run.
    Contacts,
    /// The stored exchange with an attached solver.
    Exchange,
    /// Convergence of a CalculiX run: its increments or its residuals.
    Progress,
}

/// A reader: how a kind of file is recognised, named, and read.
struct Reader {
    kind: FileKind,
    /// Name, as in "this is NAME".
    name: &'static str,
    /// The command that reads it, with `{}` for the file; empty if there is none.
    command: &'static str,
    recognise: fn(&Start) -> bool,
    /// Reads it as a scene. `None` if it is none, or is read as RON.
    read: Option<ReadScene>,
    /// Extensions of such files that no other kind has.
    extensions: &'static [&'static str],
    /// What a message calls the format of files with these extensions.
    format: &'static str,
    /// How files with these extensions begin, for kinds that are not read as a scene.
    beginning: &'static str,
}

type ReadScene = fn(&Source) -> Result<Scene, SceneError>;

const fn file(
    kind: FileKind,
    name: &'static str,
    command: &'static str,
    recognise: fn(&Start) -> bool,
) -> Reader {
    Reader {
        kind,
        name,
        command,
        recognise,
        read: None,
        extensions: &[],
        format: "",
        beginning: "",
    }
}

/// A form of scene.
const fn scene(recognise: fn(&Start) -> bool, read: Option<ReadScene>) -> Reader {
    Reader {
        read,
        ..file(FileKind::Scene, "a scene", "stickslip run {}", recognise)
    }
}

impl Reader {
    /// The reader of files with these extensions, whatever they begin with.
    const fn named(self, extensions: &'static [&'static str], format: &'static str) -> Reader {
        Reader {
            extensions,
            format,
            ..self
        }
    }

    /// With the beginning of its files, for the message if a file with its name begins otherwise.
    const fn beginning_with(self, beginning: &'static str) -> Reader {
        Reader { beginning, ..self }
    }

    /// The message for a file that has the name of its kind, but not its beginning.
    fn damage(&self) -> String {
        format!(
            "the name is that of {}, which begins with {}",
            self.format, self.beginning
        )
    }

    /// The reader of files with the extension of this one, if there is only one.
    fn from_name(name: &str) -> Option<&'static Reader> {
        let extension = std::path::Path::new(name).extension()?.to_str()?;
        let is_own = |own: &&str| own.eq_ignore_ascii_case(extension);
        let mut readers = READERS.iter();
        readers.find(|reader| reader.extensions.iter().any(is_own))
    }
}

/// All readers, in the order in which they are tried.
#[rustfmt::skip]
const READERS: [Reader; 19] = [
    file(FileKind::Mesh, "a Gmsh mesh", "stickslip export {} -o SCENE.ron", |start| start.text.trim_start().starts_with("$MeshFormat")).named(&["msh"], "a Gmsh mesh").beginning_with("$MeshFormat"),
    file(FileKind::Results, "a file of stored results", "stickslip map SCENE --resume {}", |start| start.first.starts_with("stickslip ") && start.first.contains(" results, ")),
    file(FileKind::Exchange, "a stored exchange with an attached solver", "stickslip {}", |start| start.text.starts_with(conversation::HEAD)),
    file(FileKind::Contacts, "the .cel file of a finished CalculiX run", "stickslip {}", |start| calculix::is_contacts(start.first)).named(&["cel"], "a .cel file of CalculiX")
        .beginning_with("*ELEMENT,TYPE=…,ELSET=contactelements_…"),
    file(FileKind::Progress, "a table of a finished CalculiX run", "stickslip {}", |start| ["SUMMARY OF JOB INFORMATION", "SUMMARY OF C0NVERGENCE INFORMATION"].contains(&start.first))
        .named(&["sta", "cvg"], "a .sta or .cvg file of CalculiX").beginning_with("SUMMARY OF"),
    file(FileKind::Cast, "a terminal recording of a session", "asciinema play {}", |start| start.first.starts_with("{\"version\"")),
    file(FileKind::ChartTable, "the table of a work-precision chart", "stickslip chart --from {}", |start| start.first.starts_with("scene,series,run,")),
    file(FileKind::Table, "a table of results", "", |start| {
        let columns = ["increment,load,", "increment,attempt,", "scene,"];
        columns.iter().any(|columns| start.first.starts_with(columns)) || start.first.contains(",status,increment,load,majors")
    }),
    scene(|start| deck::is_one(start.text) && !calculix::is_contacts(start.text), Some(|source| source.deck())).named(&["inp"], "a deck"),
    scene(|start| start.text.starts_with(matrix_market::MARK), Some(|source| source.problem(problems::market::read))).named(&["mtx"], "a Matrix Market file"),
    scene(|start| start.begins_with(stored::HEAD), Some(|source| source.problem(problems::stored::read))),
    scene(|start| start.begins_with(condensed::HEAD), Some(|source| source.condensed())),
    scene(|start| siconos::is_one(start.text), Some(|source| source.problem(problems::opened::siconos))).named(&["dat"], "a Siconos file"),
    file(FileKind::Journal, "a journal", "stickslip resume {}", |start| start.has_format() && start.first.contains("began:")),
    file(FileKind::Snapshot, "a snapshot", "stickslip replay {}", |start| start.has_format()),
    file(FileKind::Lesson, "a lesson", "stickslip lesson {}", |start| start.has(&["scene", "steps"])),
    file(FileKind::Chart, "the definition of a work-precision chart", "", |start| start.has(&["scene", "series"])),
    scene(|start| start.has(&["nodes", "bodies"]), None),
    file(FileKind::Study, "a study", "stickslip study {}", |start| {
        ["vary", "benchmarks", "scenes", "scene"].iter().any(|field| start.has(&[field]))
    }),
];

/// The parts of a text used to recognise its kind.
struct Start<'a> {
    text: &'a str,
    /// The first line that is neither blank nor a table comment.
    first: &'a str,
}

impl<'a> Start<'a> {
    fn new(text: &'a str) -> Self {
        let text = text.trim_start_matches(input::MARK);
        let rows = text.lines().filter(|line| !line.starts_with('#'));
        Start {
            text,
            // A file of comments only has none, such as the head of an exchange.
            first: rows
                .map(str::trim)
                .find(|line| !line.is_empty())
                .unwrap_or_default(),
        }
    }

    /// The reader that the name of a file says, if the file begins neither like one of its kind nor like another kind.
    fn damaged(&self, name: &str) -> Option<&'static Reader> {
        let named = Reader::from_name(name)?;
        // A number or a keyword at the start says little.
        let doubtful = siconos::is_one(self.text)
            || (named.kind == FileKind::Contacts && deck::is_one(self.text));
        let is_other = FileKind::from_text(self.text).is_some() && !doubtful
            || self.text.trim_start().starts_with(['(', '/']);
        (!is_other && !(named.recognise)(self)).then_some(named)
    }

    /// Whether this is the first word of the RON value.
    fn begins_with(&self, word: &str) -> bool {
        head(self.text) == Some(word) && too_deep(self.text).is_none()
    }

    /// Whether the RON value has all these fields; the text need not be valid.
    fn has(&self, fields: &[&str]) -> bool {
        fields.iter().all(|field| has_field(self.text, field))
    }

    /// Whether the RON value begins with a format field, which scenes do not have.
    fn has_format(&self) -> bool {
        let value = self.text.trim_start_matches(['(', ' ', '\t', '\r', '\n']);
        value.starts_with("format")
    }
}

impl FileKind {
    /// Kind of a file, from its first part.
    pub fn from_file(path: &std::path::Path) -> Option<FileKind> {
        const READ: u64 = 4096;
        let start = input::start(path, READ).ok()?;
        FileKind::from_text(&String::from_utf8_lossy(&start))
    }

    /// Kind of a text, from its beginning and its outermost fields; `None` if unknown.
    pub fn from_text(text: &str) -> Option<FileKind> {
        let start = Start::new(text);
        let reader = READERS.iter().find(|reader| (reader.recognise)(&start));
        reader.map(|reader| reader.kind)
    }

    fn own(self) -> Option<&'static Reader> {
        READERS.iter().find(|reader| reader.kind == self)
    }

    /// Name, as in "this is NAME".
    pub fn name(self) -> &'static str {
        self.own().map_or("", |reader| reader.name)
    }

    /// The command that reads a file of this kind; `None` if there is none.
    pub fn reader(self, file: &str) -> Option<String> {
        // The tables of a run are read together with its contact elements.
        let cel = calculix::cel_of(file).filter(|_| self == FileKind::Progress);
        let cel = cel.map(|cel| cel.display().to_string());
        let file = shown::cut(cel.as_deref().unwrap_or(file), 120);
        let file = if file.contains(char::is_whitespace) {
            format!("'{file}'")
        } else {
            file
        };
        let command = self.own()?.command;
        (!command.is_empty()).then(|| command.replace("{}", &file))
    }
}

/// Whether the RON value in a text has a field; the text need not be valid.
pub fn has_field(text: &str, field: &str) -> bool {
    too_deep(text).is_none()
        && locate(text, &Path(vec![Step::from(field)])) != locate(text, &Path::default())
}

/// The message if a text is not of the kind `wanted`: ``this is a snapshot; `stickslip replay FILE` reads it``.
pub fn mistaken(file: &str, text: &str, wanted: FileKind) -> Option<String> {
    let kind = FileKind::from_text(text).filter(|kind| *kind != wanted)?;
    let name = kind.name();
    Some(match kind.reader(file) {
        Some(reader) => format!("this is {name}; `{reader}` reads it"),
        None => format!("this is {name}, not {}", wanted.name()),
    })
}

/// The given error, or a better one if the text is a file of another kind.
pub fn or_mistaken(error: SceneError, file: &str, text: &str, wanted: FileKind) -> SceneError {
    match mistaken(file, text, wanted) {
        Some(message) => SceneError::whole(file, message),
        None => error,
    }
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

    /// As [`Scene::open`], also for an interface problem in space, which has its own solver ([`any_solver`](crate::solver::any_solver)).
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
        let wanted = match Reader::from_name(name) {
            Some(named) => &format!("{} is plain text", named.format),
            None => read::SCENE,
        };
        let text = if deck::is_called_so(name) {
            let text = deck::text(std::path::Path::new(name));
            text.map_err(|error| read::unread(name, error, wanted))
        } else {
            read::text(name, wanted)
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
        let start = Start::new(text);
        if let Some(named) = start.damaged(name) {
            return match named.read {
                Some(read) => read(&source),
                None => Err(SceneError {
                    at: Some((1, 1)),
                    ..SceneError::whole(name, named.damage())
                }),
            };
        }
        let read = READERS
            .iter()
            .find_map(|reader| reader.read.filter(|_| (reader.recognise)(&start)));
        match read {
            Some(read) => read(&source),
            None => source
                .ron()
                .map_err(|error| or_mistaken(error, name, text, FileKind::Scene)),
        }
    }
}

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
        let in_space = problem.check_in_space();
        in_space.map_err(|fault| placed(name, text, &[], fault))?;
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
            return Err(place(&[], Fault::new(at!["attached"], why)));
        }
        let (mut spec, overrides) = changed(name, spec, self.overrides, Vec::new())?;
        let imports = import::resolve(&mut spec, name, |fault| place(&overrides, fault))?;
        let mut scene = Scene::compiled(name, text, spec, overrides, place)?;
        scene.imports = imports;
        Ok(scene)
    }

    fn deck(&self) -> Result<Scene, SceneError> {
        let name = self.name;
        let read = deck::read(name, self.text)?;
        let place = |overrides: &[Override], fault: Fault| {
            let own = read
                .origin
                .of(&fault.path)
                .map(|(file, at)| (file.to_owned(), at));
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

fn no_such_scene(name: &str) -> String {
    let names = || builtin::list().iter().map(|scene| scene.name);
    let near = match error::did_you_mean_file(name) {
        none if none.is_empty() => error::did_you_mean(name, names()),
        near => near,
    };
    format!("no such file or built-in scene{near} (`stickslip list` shows the built-in ones)")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_recognised_by_its_text() {
        for (text, kind) in [
            (
                "(format:1,version:\"0.1.0\",began:1,name:\"a\",scene:(title:\"a\"))\nDone()\n",
                FileKind::Journal,
            ),
            (
                "(\n    format: 1,\n    name: \"a\",\n    scene: (title: \"a\"),\n    state: (),\n)",
                FileKind::Snapshot,
            ),
            (
                "// Words.\n(title: \"a\", scene: Scene((nodes: [], bodies: [])), steps: [])",
                FileKind::Lesson,
            ),
            ("(title: \"a\", scene: \"b\", vary: [])", FileKind::Study),
            ("(title: \"a\", scenes: [\"b\"])", FileKind::Study),
            ("(title: \"a\", benchmarks: [])", FileKind::Study),
            ("(scene: \"b\", series: [])", FileKind::Chart),
            ("(title: \"a\", nodes: [], bodies: [])", FileKind::Scene),
            ("Contacts(title: \"a\")", FileKind::Scene),
            ("Stored(title: \"a\")", FileKind::Scene),
            ("2\n1\n0\n", FileKind::Scene),
            (
                "%%MatrixMarket matrix array real general\n",
                FileKind::Scene,
            ),
            (
                "# words\nscene,series,run,settings,status,error\n",
                FileKind::ChartTable,
            ),
            ("increment,load,majors,minors,u_x\n", FileKind::Table),
            ("$MeshFormat\n4.1 0 8\n", FileKind::Mesh),
            ("stickslip 0.1.0 results, abc\n", FileKind::Results),
            ("{\"version\": 2}", FileKind::Cast),
            (
                "*ELEMENT,TYPE=C3D6,ELSET=contactelements_st1_in1_at1_it1\n1,2\n",
                FileKind::Contacts,
            ),
            ("# stickslip exchange 1\n", FileKind::Exchange),
            ("SUMMARY OF JOB INFORMATION\n STEP\n", FileKind::Progress),
            ("SUMMARY OF C0NVERGENCE INFORMATION\n", FileKind::Progress),
        ] {
            assert_eq!(FileKind::from_text(text), Some(kind), "{text}");
        }
        for text in ["", "((", "(title: \"a\")", "<svg>", "hello"] {
            assert_eq!(FileKind::from_text(text), None, "{text}");
        }
    }

    #[test]
    fn the_wanted_kind_is_not_reported() {
        let scene = "(title: \"a\", nodes: [], bodies: [])";
        assert_eq!(mistaken("a.ron", scene, FileKind::Scene), None);
        assert_eq!(
            mistaken("my scene.ron", scene, FileKind::Snapshot).unwrap(),
            "this is a scene; `stickslip run 'my scene.ron'` reads it"
        );
        let table = "SUMMARY OF JOB INFORMATION\n";
        assert_eq!(
            mistaken("job.sta", table, FileKind::Scene).unwrap(),
            "this is a table of a finished CalculiX run; `stickslip job.cel` reads it"
        );
    }
}
