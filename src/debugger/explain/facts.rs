//! Facts of the diagnosis page, by the part of the page that shows them.

stickslip_core::words! {
    /// A part of the page below What, with its heading. Parts are shown in this order; Try is between the first two.
    pub enum Part, ALL, heading {
        /// The cause, with node, body, element and numbers.
        Why "Why",
        /// What happened in a finished run.
        Report "Report",
        /// Which node pushes which, one change of mode per line.
        Loop "Loop",
        /// The consistent states of the frozen problem.
        Census "Census",
        /// How the residuals and T_max develop.
        Rates "Rates",
        /// Everything else.
        Details "Details",
    }
}

/// A line of the page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fact {
    /// The part that shows it.
    pub part: Part,
    /// The line.
    pub text: String,
}

impl Fact {
    /// A fact of a part.
    pub fn new(part: Part, text: impl Into<String>) -> Fact {
        let text = text.into();
        Fact { part, text }
    }

    /// A cause.
    pub fn why(text: impl Into<String>) -> Fact {
        Fact::new(Part::Why, text)
    }

    /// Facts of the same part.
    pub fn all(part: Part, lines: impl IntoIterator<Item = String>) -> Vec<Fact> {
        lines.into_iter().map(|text| Fact { part, text }).collect()
    }
}
