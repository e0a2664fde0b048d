//! What a file is that was given where another kind is read: told by its text, with the command that reads it.
//!
//! Whoever cannot read a text asks here before saying why: a snapshot is no scene with a field too many.

use super::error::{Path, Step};
use super::locate::{head, locate, too_deep};
use crate::outside::{calculix, input, shown};

/// The kinds of files that the program writes or reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A scene, or an interface problem: in RON, or in the form of another program.
    Scene,
    /// A mesh of Gmsh.
    Mesh,
    /// A recorded state.
    Snapshot,
    /// What was done in a session.
    Journal,
    /// A guided lesson.
    Lesson,
    /// A scene with many settings.
    Study,
    /// What a work-precision chart is to run.
    Chart,
    /// The table of a work-precision chart.
    ChartTable,
    /// Any other table that a run or a sweep writes.
    Table,
    /// Results that a map keeps.
    Results,
    /// A session to be played in a terminal.
    Cast,
    /// The contact elements of a CalculiX run.
    Contacts,
    /// How such a run went: its increments, or its residuals.
    Progress,
}

/// Columns with which the tables of runs, traces and sweeps begin.
const TABLES: [&str; 3] = ["increment,load,", "increment,attempt,", "scene,"];

/// What the tables of a CalculiX run begin with.
const PROGRESS: [&str; 2] = [
    "SUMMARY OF JOB INFORMATION",
    "SUMMARY OF C0NVERGENCE INFORMATION",
];

impl FileKind {
    /// What a text is, as far as its beginning and its outermost fields tell; `None` where they do not.
    pub fn of(text: &str) -> Option<FileKind> {
        let text = text.trim_start_matches(input::MARK);
        if text.starts_with("%%MatrixMarket") {
            return Some(FileKind::Scene);
        }
        if text.trim_start().starts_with("$MeshFormat") {
            return Some(FileKind::Mesh);
        }
        let rows = text.lines().filter(|line| !line.starts_with('#'));
        let first = rows.map(str::trim).find(|line| !line.is_empty())?;
        if first.starts_with("stickslip ") && first.contains(" results, ") {
            return Some(FileKind::Results);
        }
        if is_contacts(first) {
            return Some(FileKind::Contacts);
        }
        if PROGRESS.contains(&first) {
            return Some(FileKind::Progress);
        }
        if first.starts_with("{\"version\"") {
            return Some(FileKind::Cast);
        }
        if first.starts_with("scene,series,run,") {
            return Some(FileKind::ChartTable);
        }
        if TABLES.iter().any(|columns| first.starts_with(columns))
            || first.contains(",status,increment,load,majors")
        {
            return Some(FileKind::Table);
        }
        if first
            .split_whitespace()
            .next()
            .is_some_and(|word| word.parse::<u32>().is_ok())
        {
            return Some(FileKind::Scene);
        }
        FileKind::of_value(text)
    }

    /// The same of a value in RON, or of lines that each hold one.
    fn of_value(text: &str) -> Option<FileKind> {
        if too_deep(text).is_some() {
            return None;
        }
        if [super::condensed::HEAD, super::stored::HEAD]
            .map(Some)
            .contains(&head(text))
        {
            return Some(FileKind::Scene);
        }
        let whole = locate(text, &Path::default());
        let has = |field: &str| locate(text, &Path(vec![Step::from(field)])) != whole;
        let all = |fields: &[&str]| fields.iter().all(|field| has(field));
        let kinds: [(&[&str], FileKind); 7] = [
            (&["format", "began", "scene"], FileKind::Journal),
            (&["format", "state", "scene"], FileKind::Snapshot),
            (&["scene", "steps"], FileKind::Lesson),
            (&["scene", "series"], FileKind::Chart),
            (&["nodes", "bodies"], FileKind::Scene),
            (&["vary"], FileKind::Study),
            (&["benchmarks"], FileKind::Study),
        ];
        let found = kinds.into_iter().find(|(fields, _)| all(fields));
        let found = found.map(|(_, kind)| kind);
        found.or_else(|| (has("scenes") || has("scene")).then_some(FileKind::Study))
    }

    /// What it is called, after "this is".
    pub fn name(self) -> &'static str {
        match self {
            FileKind::Scene => "a scene",
            FileKind::Mesh => "a mesh of Gmsh",
            FileKind::Snapshot => "a snapshot",
            FileKind::Journal => "a journal",
            FileKind::Lesson => "a lesson",
            FileKind::Study => "a study",
            FileKind::Chart => "the file of a work-precision chart",
            FileKind::ChartTable => "the table of a work-precision chart",
            FileKind::Table => "a table of results",
            FileKind::Results => "a file of kept results",
            FileKind::Cast => "a session to be played in a terminal",
            FileKind::Contacts => "the .cel of a finished CalculiX run",
            FileKind::Progress => "a table of a finished CalculiX run",
        }
    }

    /// The command that reads a file of this kind; none where the program has none.
    pub fn reader(self, file: &str) -> Option<String> {
        // The tables of a run are read with its contact elements.
        let cel = calculix::cel_of(file).filter(|_| self == FileKind::Progress);
        let cel = cel.map(|cel| cel.display().to_string());
        let file = shown::cut(cel.as_deref().unwrap_or(file), 120);
        let file = match file.contains(char::is_whitespace) {
            true => format!("'{file}'"),
            false => file,
        };
        Some(match self {
            FileKind::Scene => format!("stickslip run {file}"),
            FileKind::Mesh => format!("stickslip export {file} -o SCENE.ron"),
            FileKind::Snapshot => format!("stickslip replay {file}"),
            FileKind::Journal => format!("stickslip resume {file}"),
            FileKind::Lesson => format!("stickslip lesson {file}"),
            FileKind::Study => format!("stickslip study {file}"),
            FileKind::ChartTable => format!("stickslip chart --from {file}"),
            FileKind::Results => format!("stickslip map SCENE --resume {file}"),
            FileKind::Cast => format!("asciinema play {file}"),
            FileKind::Contacts | FileKind::Progress => format!("stickslip {file}"),
            FileKind::Chart | FileKind::Table => return None,
        })
    }
}

/// Whether the value in RON that a text holds has a field; the text need not be sound.
pub(crate) fn has_field(text: &str, field: &str) -> bool {
    let whole = || locate(text, &Path::default());
    too_deep(text).is_none() && locate(text, &Path(vec![Step::from(field)])) != whole()
}

/// Whether a text begins as the contact elements of a CalculiX run do.
pub fn is_contacts(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default();
    first.starts_with("*ELEMENT") && first.contains("=contactelements_st")
}

/// The message where a text is of another kind than `wanted`: ``this is a snapshot; `stickslip replay FILE` reads it``.
pub fn mistaken(file: &str, text: &str, wanted: FileKind) -> Option<String> {
    let kind = FileKind::of(text).filter(|kind| *kind != wanted)?;
    let name = kind.name();
    Some(match kind.reader(file) {
        Some(reader) => format!("this is {name}; `{reader}` reads it"),
        None => format!("this is {name}, and not {}", wanted.name()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_told_by_its_text() {
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
            ("SUMMARY OF JOB INFORMATION\n STEP\n", FileKind::Progress),
            ("SUMMARY OF C0NVERGENCE INFORMATION\n", FileKind::Progress),
        ] {
            assert_eq!(FileKind::of(text), Some(kind), "{text}");
        }
        for text in ["", "((", "(title: \"a\")", "<svg>", "hello"] {
            assert_eq!(FileKind::of(text), None, "{text}");
        }
    }

    #[test]
    fn what_is_no_mistake_is_not_told() {
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
