//! Recognises the kind of a file from its text, and names the command that reads it.
//!
//! Readers call this before reporting a syntax error: for a snapshot the message is not "unknown field in a scene".

use super::error::{Path, Step};
use super::locate::{head, locate, too_deep};
use crate::{calculix, shown};
use stickslip_exchange::attach::conversation;
use stickslip_platform::input;

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

/// How a kind of file is recognised, named and read.
struct Entry {
    kind: FileKind,
    /// Name, as in "this is NAME".
    name: &'static str,
    /// The command that reads it, with `{}` for the file; empty if there is none.
    command: &'static str,
    recognise: fn(&Start) -> bool,
}

const fn entry(
    kind: FileKind,
    name: &'static str,
    command: &'static str,
    recognise: fn(&Start) -> bool,
) -> Entry {
    Entry {
        kind,
        name,
        command,
        recognise,
    }
}

/// All kinds, in the order in which they are tried.
#[rustfmt::skip]
const KINDS: [Entry; 14] = [
    entry(FileKind::Mesh, "a Gmsh mesh", "stickslip export {} -o SCENE.ron", |start| start.text.trim_start().starts_with("$MeshFormat")),
    entry(FileKind::Results, "a file of stored results", "stickslip map SCENE --resume {}", |start| start.first.starts_with("stickslip ") && start.first.contains(" results, ")),
    entry(FileKind::Exchange, "a stored exchange with an attached solver", "stickslip {}", |start| start.text.starts_with(conversation::HEAD)),
    entry(FileKind::Contacts, "the .cel file of a finished CalculiX run", "stickslip {}", |start| is_contacts(start.first)),
    entry(FileKind::Progress, "a table of a finished CalculiX run", "stickslip {}", |start| ["SUMMARY OF JOB INFORMATION", "SUMMARY OF C0NVERGENCE INFORMATION"].contains(&start.first)),
    entry(FileKind::Cast, "a terminal recording of a session", "asciinema play {}", |start| start.first.starts_with("{\"version\"")),
    entry(FileKind::ChartTable, "the table of a work-precision chart", "stickslip chart --from {}", |start| start.first.starts_with("scene,series,run,")),
    entry(FileKind::Table, "a table of results", "", |start| {
        let columns = ["increment,load,", "increment,attempt,", "scene,"];
        columns.iter().any(|columns| start.first.starts_with(columns)) || start.first.contains(",status,increment,load,majors")
    }),
    entry(FileKind::Journal, "a journal", "stickslip resume {}", |start| start.has_format() && start.first.contains("began:")),
    entry(FileKind::Snapshot, "a snapshot", "stickslip replay {}", |start| start.has_format()),
    entry(FileKind::Lesson, "a lesson", "stickslip lesson {}", |start| start.has(&["scene", "steps"])),
    entry(FileKind::Chart, "the definition of a work-precision chart", "", |start| start.has(&["scene", "series"])),
    entry(FileKind::Scene, "a scene", "stickslip run {}", |start| {
        let heads = [super::condensed::HEAD, super::stored::HEAD];
        let number = start.first.split_whitespace().next().is_some_and(|word| word.parse::<u32>().is_ok());
        number
            || start.text.starts_with("%%MatrixMarket")
            || (start.is_shallow && head(start.text).is_some_and(|head| heads.contains(&head)))
            || start.has(&["nodes", "bodies"])
    }),
    entry(FileKind::Study, "a study", "stickslip study {}", |start| {
        ["vary", "benchmarks", "scenes", "scene"].iter().any(|field| start.has(&[field]))
    }),
];

/// The parts of a text used to recognise its kind.
struct Start<'a> {
    text: &'a str,
    /// The first line that is neither blank nor a table comment.
    first: &'a str,
    /// Whether brackets are nested shallowly enough to search for fields.
    is_shallow: bool,
}

impl Start<'_> {
    /// Whether the RON value has all these fields; the text need not be valid.
    fn has(&self, fields: &[&str]) -> bool {
        self.is_shallow && fields.iter().all(|field| is_field(self.text, field))
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
        let text = text.trim_start_matches(input::MARK);
        let rows = text.lines().filter(|line| !line.starts_with('#'));
        let start = Start {
            text,
            // A file of comments only has none, such as the head of an exchange.
            first: rows
                .map(str::trim)
                .find(|line| !line.is_empty())
                .unwrap_or_default(),
            is_shallow: too_deep(text).is_none(),
        };
        let found = KINDS.iter().find(|entry| (entry.recognise)(&start));
        found.map(|entry| entry.kind)
    }

    fn entry(self) -> Option<&'static Entry> {
        KINDS.iter().find(|entry| entry.kind == self)
    }

    /// Name, as in "this is NAME".
    pub fn name(self) -> &'static str {
        self.entry().map_or("", |entry| entry.name)
    }

    /// The command that reads a file of this kind; `None` if there is none.
    pub fn reader(self, file: &str) -> Option<String> {
        // The tables of a run are read together with its contact elements.
        let cel = calculix::cel_of(file).filter(|_| self == FileKind::Progress);
        let cel = cel.map(|cel| cel.display().to_string());
        let file = shown::cut(cel.as_deref().unwrap_or(file), 120);
        let file = match file.contains(char::is_whitespace) {
            true => format!("'{file}'"),
            false => file,
        };
        let command = self.entry()?.command;
        (!command.is_empty()).then(|| command.replace("{}", &file))
    }
}

/// Whether the RON value in a text has a field; the text need not be valid.
pub fn has_field(text: &str, field: &str) -> bool {
    too_deep(text).is_none() && is_field(text, field)
}

fn is_field(text: &str, field: &str) -> bool {
    locate(text, &Path(vec![Step::from(field)])) != locate(text, &Path::default())
}

/// Whether a text begins like the contact elements of a CalculiX run.
pub fn is_contacts(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default();
    first.starts_with("*ELEMENT") && first.contains("=contactelements_st")
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
