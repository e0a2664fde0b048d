//! Looking for a text in a page of lines: `/`, what is typed, and on to the next place.

/// What is looked for.
#[derive(Debug, Clone, Default)]
pub struct Search {
    /// What is being typed.
    typed: Option<String>,
    /// What was looked for last, in small letters.
    sought: String,
    /// Whether it was not found.
    missed: bool,
}

/// What a key of the search leads to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Go {
    /// Nowhere: the text is still being typed, or was left.
    Nowhere,
    /// To the first place from here on.
    Here,
    /// To the next place.
    Next,
    /// To the place before.
    Back,
}

impl Search {
    /// What is being typed.
    pub fn typed(&self) -> Option<&str> {
        self.typed.as_deref()
    }

    /// What was looked for last, in small letters; empty if nothing was.
    pub fn sought(&self) -> &str {
        &self.sought
    }

    /// What the title of the page says of it.
    pub fn title(&self) -> Option<String> {
        match &self.typed {
            Some(typed) => Some(format!("/{typed}_")),
            None => self
                .missed
                .then(|| format!("nothing holds '{}'", self.sought)),
        }
    }

    /// What a key does to it; `None` if the key is none of its own.
    pub fn key(&mut self, name: &str) -> Option<Go> {
        self.missed = false;
        let Some(typed) = &mut self.typed else {
            return match name {
                "/" => {
                    self.typed = Some(String::new());
                    Some(Go::Nowhere)
                }
                "n" if !self.sought.is_empty() => Some(Go::Next),
                "N" if !self.sought.is_empty() => Some(Go::Back),
                _ => None,
            };
        };
        match name {
            "Esc" => self.typed = None,
            // Enter alone goes on with what was looked for before.
            "Enter" if typed.is_empty() => {
                self.typed = None;
                return Some(Go::Next);
            }
            "Enter" => {
                self.sought = typed.to_lowercase();
                self.typed = None;
                return Some(Go::Here);
            }
            "Backspace" if typed.is_empty() => self.typed = None,
            "Backspace" => {
                typed.pop();
            }
            "Space" => typed.push(' '),
            _ if name.chars().count() == 1 => typed.push_str(name),
            _ => {}
        }
        Some(Go::Nowhere)
    }

    /// Whether a line holds what is looked for.
    pub fn holds(&self, line: &str) -> bool {
        !self.sought.is_empty() && line.to_lowercase().contains(&self.sought)
    }

    /// The line to go to from line `from`, round from the page's end.
    pub fn find(&mut self, go: Go, from: usize, lines: &[String]) -> Option<usize> {
        let count = lines.len();
        if count == 0 || go == Go::Nowhere || self.sought.is_empty() {
            return None;
        }
        let at = |k: usize| match go {
            Go::Back => (from + 2 * count - 1 - k) % count,
            Go::Next => (from + 1 + k) % count,
            _ => (from + k) % count,
        };
        let found = (0..count).map(at).find(|&line| self.holds(&lines[line]));
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
        assert_eq!((at, told.as_deref()), (1, Some("nothing holds 'z'")));
        // It is not said any longer than until the next key.
        assert_eq!(press("j", &mut at), None);
        assert_eq!(search.title(), None);
    }
}
