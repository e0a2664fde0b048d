//! Searches a page of lines: `/`, the search text, and moving between matches.

/// A search.
#[derive(Debug, Clone, Default)]
pub struct Search {
    /// The text that is being typed.
    typed: Option<String>,
    /// The last search text, in lower case.
    sought: String,
    /// Whether there was no match.
    missed: bool,
}

/// Where to move after a key of the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchMove {
    /// Stays: the text is still being typed, or the search was cancelled.
    Nowhere,
    /// To the first match from the current line on.
    Here,
    /// To the next match.
    Next,
    /// To the previous match.
    Back,
}

impl Search {
    /// The text that is being typed.
    pub fn typed(&self) -> Option<&str> {
        self.typed.as_deref()
    }

    /// The last search text, in lower case; empty if there is none.
    pub fn sought(&self) -> &str {
        &self.sought
    }

    /// The prompt or the result for the page's title.
    pub fn title(&self) -> Option<String> {
        match &self.typed {
            Some(typed) => Some(format!("/{typed}_")),
            None => self
                .missed
                .then(|| format!("no match for '{}'", self.sought)),
        }
    }

    /// Handles a key; `None` if the search does not use it.
    pub fn key(&mut self, name: &str) -> Option<SearchMove> {
        self.missed = false;
        let Some(typed) = &mut self.typed else {
            return match name {
                "/" => {
                    self.typed = Some(String::new());
                    Some(SearchMove::Nowhere)
                }
                "n" if !self.sought.is_empty() => Some(SearchMove::Next),
                "N" if !self.sought.is_empty() => Some(SearchMove::Back),
                _ => None,
            };
        };
        match name {
            "Esc" => self.typed = None,
            // Enter alone repeats the last search.
            "Enter" if typed.is_empty() => {
                self.typed = None;
                return Some(SearchMove::Next);
            }
            "Enter" => {
                self.sought = typed.to_lowercase();
                self.typed = None;
                return Some(SearchMove::Here);
            }
            "Backspace" if typed.is_empty() => self.typed = None,
            "Backspace" => {
                typed.pop();
            }
            "Space" => typed.push(' '),
            _ if name.chars().count() == 1 => typed.push_str(name),
            _ => {}
        }
        Some(SearchMove::Nowhere)
    }

    /// Whether a line contains the search text.
    pub fn holds(&self, line: &str) -> bool {
        !self.sought.is_empty() && line.to_lowercase().contains(&self.sought)
    }

    /// The matching line to go to from line `from`, wrapping around at the end of the page.
    pub fn find(&mut self, go: SearchMove, from: usize, lines: &[String]) -> Option<usize> {
        let count = lines.len();
        if count == 0 || go == SearchMove::Nowhere || self.sought.is_empty() {
            return None;
        }
        let found = (0..count)
            .map(|k| match go {
                SearchMove::Back => (from + 2 * count - 1 - k) % count,
                SearchMove::Next => (from + 1 + k) % count,
                _ => (from + k) % count,
            })
            .find(|&line| self.holds(&lines[line]));
        self.missed = found.is_none();
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_typed_found_and_found_again_both_ways() {
        let lines = ["a", "Beam", "c", "a beam", "e"].map(String::from);
        let mut search = Search::default();
        let mut at = 0;
        let mut press = |name: &str, at: &mut usize| {
            let go = search.key(name)?;
            if let Some(line) = search.find(go, *at, &lines) {
                *at = line;
            }
            search.title()
        };
        for letter in ["/", "b", "e", "x", "Backspace"] {
            press(letter, &mut at);
        }
        assert_eq!(press("a", &mut at).as_deref(), Some("/bea_"));
        press("Enter", &mut at);
        assert_eq!(at, 1);
        press("n", &mut at);
        assert_eq!(at, 3);
        press("n", &mut at);
        assert_eq!(at, 1);
        press("N", &mut at);
        assert_eq!(at, 3);
        press("/", &mut at);
        press("Enter", &mut at);
        assert_eq!(at, 1);
        press("/", &mut at);
        press("z", &mut at);
        let told = press("Enter", &mut at);
        assert_eq!((at, told.as_deref()), (1, Some("no match for 'z'")));
        // The result is shown until the next key.
        assert_eq!(press("j", &mut at), None);
        assert_eq!(search.title(), None);
    }
}
