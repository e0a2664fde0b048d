//! `job.frd`: the contact pressure of the last result, written by `*CONTACT FILE` with CDIS or CSTR.
//!
//! A data set begins with ` -4`, its name and its number of components, has a line ` -5` with the name of each component, a line
//! ` -1` per node (number in columns 4 to 13, then values of 12 columns), and ends with ` -3`.

use super::lines::{Lines, ResultLine};
use crate::FormatError;
use std::io::BufRead;

/// The nodes of the last contact data set with their pressures; empty if there is none.
///
/// # Errors
/// If the file cannot be read, or a pressure is not a number.
pub fn pressures(from: impl BufRead) -> Result<Vec<(u32, f64)>, FormatError> {
    let mut lines = Lines::new(from);
    let (mut found, mut components) = (Vec::new(), Vec::new());
    let mut is_contact = false;
    while let Some(line) = lines.next()? {
        match line.bytes.get(..3) {
            Some(b" -4") => {
                is_contact = word(line) == Some(&b"CONTACT"[..]);
                if is_contact {
                    (found, components) = (Vec::new(), Vec::new());
                }
            }
            Some(b" -5") if is_contact => components.push(word(line) == Some(&b"CPRESS"[..])),
            Some(b" -1") if is_contact && line.whole => {
                let place = components.iter().position(|is_pressure| *is_pressure);
                let row = place.map(|place| row(line, place)).transpose()?;
                found.extend(row);
            }
            Some(b" -3") => is_contact = false,
            _ => {}
        }
    }
    Ok(found)
}

/// The second word of a line.
fn word(line: ResultLine<'_>) -> Option<&[u8]> {
    line.fields().nth(1).map(|field| field.bytes)
}

/// Node and pressure of a line, with the pressure at this place.
fn row(line: ResultLine, place: usize) -> Result<(u32, f64), FormatError> {
    let number = |from: usize, length: usize| {
        let bytes = line.bytes.get(from..from + length)?;
        std::str::from_utf8(bytes).ok().map(str::trim)
    };
    let node = number(3, 10).and_then(|text| text.parse().ok());
    let pressure = number(13 + 12 * place, 12).and_then(|text| text.parse().ok());
    match (node, pressure) {
        (Some(node), Some(pressure)) => Ok((node, pressure)),
        _ => Err(line.wrong(0, "a node with six numbers of 12 columns was expected")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRD: &str = " -4  CONTACT     6    1
 -5  COPEN       1    4    1    1
 -5  CPRESS      1    4    1    2
 -1        57-1.13492E-08 1.13192E+03
 -3
 -4  DISP        4    1
 -5  D1          1    2    1    0
 -1        57-1.00000E+00
 -3
";

    #[test]
    fn the_last_contact_data_set_counts() {
        assert_eq!(pressures(FRD.as_bytes()).unwrap(), [(57, 1131.92)]);
        let twice = FRD
            .replace(" 57", "  8")
            .replace("1.13192E+03", "2.00000E+00");
        assert_eq!(
            pressures(format!("{FRD}{twice}").as_bytes()).unwrap(),
            [(8, 2.0)]
        );
        assert!(pressures(&b"anything\n"[..]).unwrap().is_empty());
        let wrong = FRD.replace("1.13192E+03", "1.13x");
        assert_eq!(pressures(wrong.as_bytes()).unwrap_err().at, Some((4, 1)));
    }
}
