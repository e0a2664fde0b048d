//! Formats numbers for people: narrow and aligned at the decimal point in tables, without hiding a near-tie by rounding.

/// Shown for a number that an attached solver does not report.
pub const UNREPORTED: &str = "-";

/// A number with at most this many significant digits and without trailing zeros. Numbers below 0.001, from 1e7 on, and those with
/// more than `digits` + 1 digits before the decimal point have an exponent.
pub fn significant(value: f64, digits: usize) -> String {
    // Rounded in decimal, then printed in the shortest form that reads back equal.
    let rounded = format!("{value:.*e}", digits - 1);
    let most = 10f64.powi(digits as i32 + 1).min(1e7);
    match rounded.parse().unwrap_or(value) {
        0.0 => "0".into(),
        x if x.is_finite() && !(1e-3..most).contains(&x.abs()) => format!("{x:e}"),
        x if x.is_finite() && x.abs() >= 10f64.powi(digits as i32) => format!("{value:.0}"),
        x => x.to_string(),
    }
}

/// For errors and residuals in sentences.
pub fn sig2(value: f64) -> String {
    significant(value, 2)
}

/// For captions and sentences.
pub fn sig4(value: f64) -> String {
    significant(value, 4)
}

/// For tables and curves.
pub fn sig6(value: f64) -> String {
    significant(value, 6)
}

/// A load factor, a size or a tested value: ten digits, more than anyone types.
pub fn shortest(value: f64) -> String {
    significant(value, 10)
}

/// A number in a table cell: sign slot first, then up to six significant digits such that the last column stays empty, padded to
/// the width. Only an exact zero is shown as `0`.
pub fn fixed_width(value: f64, width: usize) -> String {
    let sign = if value < 0.0 { "" } else { " " };
    let text = (1..=6)
        .rev()
        .map(|digits| format!("{sign}{}", significant(value, digits)))
        .find(|text| text.len() < width)
        .unwrap_or_else(|| format!("{sign}{value:.0e}"));
    format!("{text:<width$}")
}

/// |F_t| over |T_max|: the fraction of friction used, with more digits near 1, where a mode switches. A dash if there is neither
/// force nor friction.
pub fn ratio(f_t: f64, t_max: f64) -> String {
    let ratio = (f_t / t_max).abs();
    let off = (ratio - 1.0).abs();
    match () {
        _ if t_max == 0.0 && f_t == 0.0 => "–".into(),
        _ if t_max == 0.0 => "∞".into(),
        _ if off < 5e-7 => "1".into(),
        _ if off < 5e-3 => significant(ratio, 7),
        _ if ratio < 1e-3 => sig2(ratio),
        _ => sig4(ratio),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_align_and_leave_a_gap() {
        assert_eq!(fixed_width(-1.23456789e-4, 13), "-1.23457e-4  ");
        assert_eq!(fixed_width(1.23456789e-4, 11), " 1.2346e-4 ");
        assert_eq!(fixed_width(-1.23456789e-10, 11), "-1.235e-10 ");
        assert_eq!(fixed_width(-0.123456789, 11), "-0.123457  ");
        assert_eq!(fixed_width(12400.0, 11), " 12400     ");
        assert_eq!(fixed_width(0.0, 6), " 0    ");
        assert_eq!(fixed_width(-0.0, 6), " 0    ");
        assert_eq!(fixed_width(f64::NAN, 6).trim(), "NaN");
        assert_eq!(fixed_width(1e-300, 4), " 1e-300");
    }

    #[test]
    fn a_ratio_of_one_has_no_round_off_and_a_near_tie_is_visible() {
        assert_eq!(ratio(1.0, -1.0), "1");
        assert_eq!(ratio(1.0 - 2e-11, 1.0), "1");
        assert_eq!(ratio(1.0 + 6e-16, 1.0), "1");
        assert_eq!(ratio(1.0 - 3e-6, 1.0), "0.999997");
        assert_eq!(ratio(1.0 + 3e-6, 1.0), "1.000003");
        assert_eq!(ratio(1.00006, 1.0), "1.00006");
        assert_eq!(ratio(0.5, 1.0), "0.5");
        assert_eq!(ratio(10.0, 0.57735026919), "17.32");
        assert_eq!(ratio(0.0, 0.0), "–");
        assert_eq!(ratio(1.0, 0.0), "∞");
    }

    #[test]
    fn load_factors_read_as_written() {
        assert_eq!(shortest(0.1 + 0.2), "0.3");
        assert_eq!(shortest(1200.0), "1200");
        assert_eq!(shortest(-0.005), "-0.005");
        assert_eq!(shortest(0.0), "0");
        assert_eq!(shortest(1e-7), "1e-7");
        assert_eq!(shortest(1.5258789062499997e-6), "1.525878906e-6");
    }

    #[test]
    fn numbers_have_four_digits_and_no_useless_zeros() {
        for (value, text) in [
            (0.0, "0"),
            (-5.752212389e-4, "-5.752e-4"),
            (1e-11, "1e-11"),
            (0.05, "0.05"),
            (-0.113, "-0.113"),
            (-1.96, "-1.96"),
            (30.0, "30"),
            (0.57735026919, "0.5774"),
            (12345.6, "12346"),
            (452381.0, "4.524e5"),
        ] {
            assert_eq!(sig4(value), text);
        }
    }
}
