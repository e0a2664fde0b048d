//! The manual: Markdown pages, one a topic. `stickslip help TOPIC` and `:help TOPIC` show them, and rustdoc does here.
//!
//! What a page says of the program is made by the program (`tests/files/manual.rs`; `README=write` renews it), or the page
//! names the command or the test that it comes from.

#![forbid(unsafe_code)]

pub mod render;
pub mod search;

use stickslip_scene::embedded;
use stickslip_scene::embedded::EmbeddedFile;
use stickslip_scene::format::error::did_you_mean;

/// A page of the manual.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Page {
    /// What `help` calls it.
    pub topic: &'static str,
    /// What it is about, in a line.
    pub about: &'static str,
    file: EmbeddedFile,
}

impl Page {
    /// Markdown.
    pub fn text(&self) -> &'static str {
        self.file.text
    }
}

macro_rules! pages {
    ($($module:ident $topic:literal $file:literal $about:literal;)*) => {
        $(
            // Brackets on a page are arguments that may be left out, and no links.
            #[allow(rustdoc::broken_intra_doc_links)]
            #[doc = include_str!($file)]
            pub mod $module {}
        )*

        /// All pages, in the order in which one may read them.
        pub const PAGES: &[Page] = &[
            $(Page { topic: $topic, about: $about, file: embedded!($topic, $file) }),*
        ];
    };
}

pages! {
    tour "tour" "pages/tour.md" "Five minutes with problem 01, and the case that cycles";
    diagnosing "diagnosing" "pages/diagnosing.md" "From \"it does not converge\" to why, and to what helps";
    lessons "lessons" "pages/lessons.md" "Guided lessons, and how to write one";
    teaching "teaching" "pages/teaching.md" "A course of six sessions, for lecturers";
    scenes "scenes" "pages/scenes.md" "The scene file: every type and field with its default";
    settings "settings" "pages/settings.md" "The choices of the method, and its limits";
    strategies "strategies" "pages/strategies.md" "How the next modes are chosen; the ladder; jumps";
    decks "decks" "pages/decks.md" "Decks of CalculiX and Abaqus: what is read, and as what";
    past_runs "past-runs" "pages/past-runs.md" "A finished CalculiX run: its cycles, and the contacts that chatter";
    attaching "attaching" "pages/attaching.md" "Another program's solver, stepped in this debugger";
    protocol "protocol" "pages/protocol.md" "What an attached solver and the debugger say to each other";
    adapters "adapters" "pages/adapters.md" "Attaching a solver with Python: an example, and three that are there";
    corners "corners" "pages/corners.md" "Where two sides of a surface meet";
    limit_points "limit-points" "pages/limit-points.md" "Where a load can go no further, and what comes after";
    jumps "jumps" "pages/jumps.md" "Stability; what comes past a limit point";
    interfaces "interfaces" "pages/interfaces.md" "Interface problems of other programs, and for other solvers";
    paraview "paraview" "pages/paraview.md" "Results in ParaView, of each increment, major or minor iteration";
    command_line "command-line" "pages/command-line.md" "Subcommands, files, exit codes";
    keys "keys" "pages/keys.md" "Keys and actions of the debugger; branches, breakpoints, journals";
    glossary "glossary" "pages/glossary.md" "Terms of this program and the paper, and what other codes call them";
    studies "studies" "pages/studies.md" "Many runs of a scene; the paper's figures";
    maps_and_charts "maps-and-charts" "pages/maps-and-charts.md" "Where it converges; random problems; error over cost";
    cluster "cluster" "pages/cluster.md" "Past one machine: shards, logs, merging; HyperQueue, Slurm, parallel";
    theory "theory" "pages/theory.md" "The method, its symbols, and where the program departs from the paper";
    verification "verification" "pages/verification.md" "What is accepted, how good it is, and how that is tested";
    benchmarks "benchmarks" "pages/benchmarks.md" "Scenes whose answers are known from elsewhere, and how near ours are";
    speed "speed" "pages/speed.md" "What runs cost, and how that grows";
    install "install" "pages/install.md" "Installing, features, completions, pages for man, older clusters";
    architecture "architecture" "pages/architecture.md" "How the source is built";
    contributing "contributing" "pages/contributing.md" "How to change it: tests, fuzzing, rules";
    changes "changes" "pages/changes.md" "What became different";
}

/// A topic that no page has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the manual has no page '{topic}'{near}; `help` lists them")]
pub struct NoPage {
    topic: String,
    /// What may have been meant.
    near: String,
}

/// The page of a topic.
///
/// # Errors
/// That there is none, with the nearest one.
pub fn page(topic: &str) -> Result<&'static Page, NoPage> {
    let found = PAGES.iter().find(|page| page.topic == topic);
    found.ok_or_else(|| NoPage {
        topic: stickslip_scene::shown::cut(topic, 40).to_string(),
        near: did_you_mean(topic, PAGES.iter().map(|page| page.topic)),
    })
}

/// The topics, one a line with what they are about.
pub fn contents() -> String {
    let width = PAGES.iter().map(|page| page.topic.len()).max().unwrap_or(0);
    let line = |page: &Page| format!("  {:<width$}  {}\n", page.topic, page.about);
    PAGES.iter().map(line).collect()
}

/// A line of a page that holds a word that was searched for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hit {
    /// The page.
    pub topic: &'static str,
    /// The heading under which it stands; that of the page at its top.
    pub heading: String,
    /// The line, without its styles.
    pub line: String,
}

/// All lines that hold a text, whatever the case of its letters, as they are shown 80 columns wide.
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
    fn a_wrong_topic_is_answered_with_the_nearest() {
        assert!(
            page("strategis")
                .is_err_and(|e| e.to_string().contains("did you mean \"strategies\"?"))
        );
        assert!(page("\u{1b}]0;x").is_err_and(|e| !e.to_string().contains('\u{1b}')));
        assert_eq!(page("keys").map(|page| page.topic), Ok("keys"));
    }

    #[test]
    fn what_is_found_stands_under_its_heading() {
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
