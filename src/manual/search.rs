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

    /// Handles a key on a page that shows line `from` first, and returns the matching line to go to, if any; the outer `None` if the
    /// search does not use the key.
    pub fn key(&mut self, name: &str, from: usize, lines: &[String]) -> Option<Option<usize>> {
        self.missed = false;
        let Some(typed) = &mut self.typed else {
            match name {
                "/" => self.typed = Some(String::new()),
                "n" if !self.sought.is_empty() => return Some(self.find(from, 1, lines)),
                "N" if !self.sought.is_empty() => return Some(self.find(from, -1, lines)),
                _ => return None,
            }
            return Some(None);
        };
        match name {
            "Esc" => self.typed = None,
            // Enter alone repeats the last search.
            "Enter" if typed.is_empty() => {
                self.typed = None;
                return Some(self.find(from, 1, lines));
            }
            "Enter" => {
                self.sought = typed.to_lowercase();
                self.typed = None;
                return Some(self.find(from, 0, lines));
            }
            "Backspace" if typed.is_empty() => self.typed = None,
            "Backspace" => {
                typed.pop();
            }
            "Space" => typed.push(' '),
            _ if name.chars().count() == 1 => typed.push_str(name),
            _ => {}
        }
        Some(None)
    }

    /// Whether a line contains the search text.
    pub fn holds(&self, line: &str) -> bool {
        !self.sought.is_empty() && line.to_lowercase().contains(&self.sought)
    }

    /// The first matching line `by` lines after line `from` or further on, or back from there if `by` is negative; around the end of the
    /// page.
    fn find(&mut self, from: usize, by: isize, lines: &[String]) -> Option<usize> {
        let count = lines.len() as isize;
        if count == 0 || self.sought.is_empty() {
            return None;
        }
        let direction = if by < 0 { -1 } else { 1 };
        let found = (0..count)
            .map(|k| (from as isize + by + direction * k).rem_euclid(count) as usize)
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
            *at = search.key(name, *at, &lines)?.unwrap_or(*at);
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
