//! The main screens at all sizes: one stored text per screen, the same in all colours.

use stickslip::action::Colours;
use stickslip::tui::main_screens::{MAIN_SCREENS, SIZES};
use stickslip::tui::theme::Theme;
use stickslip::tui::{after_keys, screenshot};

/// The colours that the screens are looked at in; high contrast has no dim text, so that names leave out more.
const LOOKED_AT: [Colours; 3] = [Colours::Dark, Colours::Light, Colours::None];

/// The text with the times of remedies (in the column `ms`) and branches (`0.1 ms`) replaced.
fn without_times(text: &str) -> String {
    let mut column = None;
    let mut all = String::new();
    for line in text.lines() {
        let mut letters: Vec<char> = line.chars().collect();
        let units = (0..letters.len()).filter(|k| letters[*k..].starts_with(&[' ', 'm', 's']));
        let units: Vec<usize> = units.collect();
        let ends = match (line.contains(" factors "), column) {
            (true, _) => {
                column = units.first().map(|k| k + 3);
                Vec::new()
            }
            (false, Some(end)) => vec![end],
            (false, None) => units,
        };
        for end in ends {
            for letter in letters.iter_mut().take(end).skip(end.saturating_sub(4)) {
                if letter.is_ascii_digit() || *letter == '.' {
                    *letter = '#';
                }
            }
        }
        all.extend(letters);
        all.push('\n');
    }
    all
}

#[test]
fn the_main_screens_at_all_sizes_in_all_colours() {
    for screen in &MAIN_SCREENS {
        let mut all = String::new();
        for size in SIZES {
            let mut debugger = after_keys(screen.scene, screen.keys, size, Theme::mono()).unwrap();
            let text = debugger.text(size.0, size.1);
            assert_eq!(text.lines().count(), usize::from(size.1), "{}", screen.name);
            for colours in LOOKED_AT {
                debugger.app.theme = Theme::new(colours);
                let coloured = debugger.text(size.0, size.1);
                assert_eq!(coloured, text, "{} in {}", screen.name, colours.word());
            }
            all += &format!("{}x{}\n{}", size.0, size.1, without_times(&text));
        }
        insta::assert_snapshot!(screen.name, all);
    }
}

#[test]
fn a_screen_is_a_picture_with_the_size_of_its_cells() {
    let debugger = after_keys(None, "", (80, 24), Theme::new(Colours::Light)).unwrap();
    let bytes = screenshot::png(&debugger, (80, 24), Colours::Light).unwrap();
    let side = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!((side(16), side(20)), (80 * 10 + 16, 24 * 19 + 16));
    assert!(after_keys(None, "Enetr", (80, 24), Theme::mono()).is_err());
}
