//! The manual: one Markdown page per topic, shown by `stickslip help TOPIC` and `:help TOPIC`, and included in rustdoc here.
//!
//! Screens, tables and numbers of the program on a page are generated (`tests/files/manual.rs`; `README=write` updates them); for
//! others the page names the command or test that they come from.

#![forbid(unsafe_code)]

pub mod render;
pub mod search;

use stickslip_scene::EmbeddedFile;
use stickslip_scene::embedded;
use stickslip_scene::format::error::did_you_mean;

/// A page of the manual.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Page {
    /// Its name in `help`.
    pub topic: &'static str,
    /// One line on its subject.
    pub about: &'static str,
    file: EmbeddedFile,
}

impl Page {
    /// The Markdown text.
    pub fn text(&self) -> &'static str {
        self.file.text
    }
}

macro_rules! pages {
    ($($module:ident $topic:literal $file:literal $about:literal;)*) => {
        $(
            // Brackets on a page mark optional arguments, not links.
            #[allow(rustdoc::broken_intra_doc_links)]
            #[doc = include_str!($file)]
            pub mod $module {}
        )*

        /// All pages, in reading order.
        pub static PAGES: &[Page] = &[
            $(Page { topic: $topic, about: $about, file: embedded!($topic, $file) }),*
        ];
    };
}

pages! {
    tour "tour" "pages/tour.md" "The first ten minutes: a lesson, problem 01, and a case that cycles";
    diagnosing "diagnosing" "pages/diagnosing.md" "From \"it does not converge\" to the cause and a remedy";
    lessons "lessons" "pages/lessons.md" "Guided lessons, and how to write one";
    teaching "teaching" "pages/teaching.md" "A course of six sessions, for lecturers";
    scenes "scenes" "pages/scenes.md" "The scene file: every type and field with its default";
    settings "settings" "pages/settings.md" "Options and limits of the method";
    strategies "strategies" "pages/strategies.md" "Strategies for the next modes; the ladder; jumps";
    decks "decks" "pages/decks.md" "CalculiX and Abaqus decks: what is read, and how it is interpreted";
    past_runs "past-runs" "pages/past-runs.md" "A finished CalculiX run: why it failed, and the cure";
    attaching "attaching" "pages/attaching.md" "Stepping another program's solver in this debugger";
    protocol "protocol" "pages/protocol.md" "The messages between an attached solver and the debugger";
    adapters "adapters" "pages/adapters.md" "Attaching a solver with Python: an example and three adapters";
    corners "corners" "pages/corners.md" "Corners, where two sides of a surface meet";
    limit_points "limit-points" "pages/limit-points.md" "Limit loads, and the states past them";
    jumps "jumps" "pages/jumps.md" "Stability, and jumps past a limit point";
    interfaces "interfaces" "pages/interfaces.md" "Interface problems from other programs and for other solvers";
    paraview "paraview" "pages/paraview.md" "Results in ParaView, of each increment, major or minor iteration";
    command_line "command-line" "pages/command-line.md" "Subcommands, files, exit codes";
    json "json" "pages/json.md" "Results as JSON and JUnit, for scripts and CI: all fields";
    keys "keys" "pages/keys.md" "Keys and actions of the debugger; branches, breakpoints, journals";
    glossary "glossary" "pages/glossary.md" "Terms of this program and the paper, and what other codes call them";
    studies "studies" "pages/studies.md" "Many runs of a scene; the paper's figures";
    maps_and_charts "maps-and-charts" "pages/maps-and-charts.md" "Maps of convergence; random problems; error over cost";
    cluster "cluster" "pages/cluster.md" "Several machines: shards, logs, merging; HyperQueue, Slurm, parallel";
    theory "theory" "pages/theory.md" "The method, its symbols, and differences from the paper";
    verification "verification" "pages/verification.md" "Acceptance criteria, accuracy, and how they are tested";
    benchmarks "benchmarks" "pages/benchmarks.md" "Scenes with published reference values, and the deviations from them";
    speed "speed" "pages/speed.md" "Cost of runs, and how it scales";
    install "install" "pages/install.md" "Installing, features, completions, pages for man, older clusters";
    architecture "architecture" "pages/architecture.md" "Structure of the source code";
    contributing "contributing" "pages/contributing.md" "Contributing: tests, fuzzing, rules";
    changes "changes" "pages/changes.md" "Changes between versions";
}

/// An unknown topic.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the manual has no page '{topic}'{near}; `help` lists all")]
pub struct NoPage {
    topic: String,
    /// A similar topic, as part of the message.
    near: String,
}

/// The page of a topic.
///
/// # Errors
/// If there is none; the message suggests a similar one.
pub fn page(topic: &str) -> Result<&'static Page, NoPage> {
    let found = PAGES.iter().find(|page| page.topic == topic);
    found.ok_or_else(|| NoPage {
        topic: stickslip_scene::shown::cut(topic, 40),
        near: did_you_mean(topic, PAGES.iter().map(|page| page.topic)),
    })
}

/// The topics with their subjects, one per line.
pub fn contents() -> String {
    let width = PAGES.iter().map(|page| page.topic.len()).max().unwrap_or(0);
    PAGES
        .iter()
        .map(|page| format!("  {:<width$}  {}\n", page.topic, page.about))
        .collect()
}

/// A line that matches a search.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hit {
    /// The page.
    pub topic: &'static str,
    /// The heading above it; at the top of a page, the page's title.
    pub heading: String,
    /// The line without styles.
    pub line: String,
}

/// All lines that contain a text, ignoring case, as shown in 80 columns.
pub fn search(text: &str) -> Vec<Hit> {
    let text = text.to_lowercase();
    let mut hits = Vec::new();
    if text.trim().is_empty() {
        return hits;
    }
    for page in PAGES {
        let mut heading = String::new();
        for line in render::render(page.text(), render::WIDTH) {
            let shown = line.text();
            if line.is_heading() {
                heading = shown.trim().to_owned();
            }
            if shown.to_lowercase().contains(&text) {
                let line = shown.trim().to_owned();
                let (topic, heading) = (page.topic, heading.clone());
                hits.push(Hit {
                    topic,
                    heading,
                    line,
                });
            }
        }
    }
    hits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_topic_suggests_a_similar_one() {
        assert!(
            page("strategis")
                .is_err_and(|e| e.to_string().contains("did you mean \"strategies\"?"))
        );
        assert!(page("\u{1b}]0;x").is_err_and(|e| !e.to_string().contains('\u{1b}')));
        assert_eq!(page("keys").map(|page| page.topic), Ok("keys"));
    }

    #[test]
    fn hits_name_their_heading() {
        let hits = search("T_MAX USED");
        assert!(
            hits.iter()
                .any(|hit| hit.topic == "diagnosing" && !hit.heading.is_empty()),
            "{hits:?}"
        );
        assert_eq!(search("no page has this in it"), []);
        assert_eq!(search(" "), []);
    }
}
