//! Which actions are possible while the session is busy.

use super::meaning::{Action, Page, Question, Ui};
use crate::Command;

impl Action {
    /// Whether an action queries or changes the session.
    pub fn asks(&self) -> bool {
        match self {
            Action::Session(_) => true,
            Action::Ui(ui) => matches!(
                ui,
                Ui::Repeat
                    | Ui::Page(Page::Diagnosis | Page::Remedies)
                    | Ui::StartFrom(_)
                    | Ui::Apply(_)
                    | Ui::Chart(_)
                    | Ui::Open(_)
                    | Ui::Lesson(_)
                    | Ui::On
                    | Ui::Hint
                    | Ui::Answer(_)
                    | Ui::Predict(_)
                    | Ui::Ask(Question::Mode | Question::Increment | Question::Answer)
            ),
        }
    }

    /// Whether an action means the same after another scene has been opened.
    pub fn outlives_the_scene(&self) -> bool {
        match self {
            Action::Session(command) => matches!(command, Command::Journal(None)),
            Action::Ui(ui) => matches!(
                ui,
                Ui::NextPane
                    | Ui::PreviousPane
                    | Ui::Zoom
                    | Ui::Explain
                    | Ui::Page(Page::Timeline | Page::Contact)
                    | Ui::Sort(_)
                    | Ui::SortBackward
                    | Ui::View
                    | Ui::Magnify(_)
                    | Ui::Filter(_)
                    | Ui::Ask(Question::Node | Question::Break | Question::Lesson)
                    | Ui::CommandLine
                    | Ui::Help
                    | Ui::Keys
                    | Ui::Colours(_)
                    | Ui::Mouse(_)
                    | Ui::Manual(_)
                    | Ui::Cancel
                    | Ui::Interrupt
                    | Ui::Redraw
                    | Ui::Suspend
                    | Ui::Quit
            ),
        }
    }
}
