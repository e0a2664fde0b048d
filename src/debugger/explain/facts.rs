//! Facts of the diagnosis page, by the part of the page that shows them.

/// A part of the page below What. Parts are shown in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The cause, with node, body, element and numbers.
    Why,
    /// What happened in a finished run.
    Report,
    /// Which node pushes which, one change of mode per line.
    Loop,
    /// The consistent states of the frozen problem.
    Census,
    /// How the residuals and T_max develop.
    Rates,
    /// Everything else.
    Details,
}

impl Part {
    /// The parts below Try.
    pub const BELOW: [Part; 5] = [
        Part::Report,
        Part::Loop,
        Part::Census,
        Part::Rates,
        Part::Details,
    ];

    /// Heading of the part.
    pub fn heading(self) -> &'static str {
        match self {
            Part::Why => "Why",
            Part::Report => "Report",
            Part::Loop => "Loop",
            Part::Census => "Census",
            Part::Rates => "Rates",
            Part::Details => "Details",
        }
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
