//! Finds the name that a mistyped one probably stands for.

use crate::disk;
use std::path::Path;
use strsim::osa_distance;

/// `; did you mean "beam.end"?` if a candidate is close enough to be a typo, else an empty string.
pub fn did_you_mean<'a>(wrong: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    match nearest(wrong, candidates) {
        Some(right) => format!("; did you mean {right:?}?"),
        None => String::new(),
    }
}

/// As [`did_you_mean`], for the path of a missing file and the files in its folder.
pub fn did_you_mean_file(missing: &str) -> String {
    let path = Path::new(missing);
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let entries = disk::read_dir(folder.unwrap_or(Path::new(".")));
    let names = entries.into_iter().flatten().flatten();
    let in_folder = |name| folder.map_or(Path::new("").join(&name), |folder| folder.join(&name));
    let mut paths: Vec<String> = names
        .map(|entry| in_folder(entry.file_name()))
        .map(|path| path.to_string_lossy().into_owned())
        .collect();
    // The order of a folder differs between machines.
    paths.sort_unstable();
    did_you_mean(missing, paths.iter().map(String::as_str))
}

/// The candidate with the smallest edit distance, if that is at most a third of the differing part; otherwise the only candidate
/// that begins with the word.
///
/// The common start and end are ignored, so `settings.foo` is not close to `settings.slip`, and `wall.ron` not to `beam.ron`.
pub fn nearest<'a>(wrong: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let candidates: Vec<&str> = candidates.into_iter().collect();
    // Longer words are not typos, and the distance costs quadratic time.
    const LONGEST: usize = 64;
    let letters = wrong.chars().count();
    let far = |right: &str| {
        let (a, b) = (wrong.chars(), right.chars());
        let start = a.clone().zip(b.clone()).take_while(|(a, b)| a == b);
        let end = a.rev().zip(b.rev()).take_while(|(a, b)| a == b);
        let differing = letters.saturating_sub(start.count() + end.count());
        let most = differing.div_ceil(3).max(1).min(letters.saturating_sub(1));
        let possible = wrong.len().max(right.len()) <= LONGEST;
        // Swapping two adjacent characters counts as one change.
        let far = possible.then(|| osa_distance(wrong, right));
        far.filter(|far| *far <= most)
    };
    let mut begun = candidates
        .iter()
        .filter(|right| !wrong.is_empty() && right.starts_with(wrong));
    let only = begun.next().filter(|_| begun.next().is_none());
    candidates
        .iter()
        .filter_map(|right| far(right).map(|far| (far, right)))
        .min_by_key(|(far, _)| *far)
        .map(|(_, right)| right)
        .or(only)
        .copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typos_are_recognised_and_unrelated_words_are_not() {
        assert_eq!(
            nearest("beam.edn", ["floor.end", "beam.end", "beam.start"]),
            Some("beam.end")
        );
        assert_eq!(nearest("refin", ["refine"]), Some("refine"));
        assert_eq!(nearest("wall", ["beam.end", "floor"]), None);
        assert_eq!(nearest("settings.foo", ["settings.slip"]), None);
        assert_eq!(nearest("wall.ron", ["beam.ron"]), None);
        assert_eq!(nearest("z", ["x"]), None);
        assert_eq!(nearest("", ["x"]), None);
        assert_eq!(
            nearest("osc-inc", ["osc-inclined", "osc-two6"]),
            Some("osc-inclined")
        );
        assert_eq!(nearest("osc-", ["osc-inclined", "osc-two6"]), None);
        assert_eq!(nearest("abdc", ["abcd"]), Some("abcd"));
    }
}
