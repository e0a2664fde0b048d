//! Formats numbers for people: narrow and aligned at the decimal point in tables, without hiding a near-tie by rounding.

/// Shown for a number that an attached solver does not report.
pub const UNREPORTED: &str = "-";

/// A number in a table cell: sign slot first, then up to six significant digits such that the last column stays empty, padded to
/// the width. Decimal points are aligned. Only an exact zero is shown as `0`.
pub fn fixed_width(value: f64, width: usize) -> String {
    let sign = if value.is_sign_negative() && value != 0.0 {
        ""
    } else {
        " "
    };
    let text = match value {
        0.0 => " 0".into(),
        _ if !value.is_finite() => format!("{sign}{value}"),
        _ => (0..=5)
            .rev()
            .map(|digits| format!("{sign}{value:.digits$e}"))
            .find(|text| text.len() < width)
            .unwrap_or_else(|| format!("{sign}{value:.0e}")),
    };
    format!("{text:<width$}")
}

/// A number with ten significant digits, for the decision card.
pub fn long(value: f64) -> String {
    match value {
        0.0 => "0".into(),
        _ if value.is_finite() => format!("{value:.9e}"),
        _ => value.to_string(),
    }
}

/// A number with four significant digits, for captions.
pub fn short(value: f64) -> String {
    match value {
        0.0 => "0".into(),
        _ if value.is_finite() => format!("{value:.3e}"),
        _ => value.to_string(),
    }
}

/// A load factor or size as people write it: up to ten significant digits, without trailing zeros.
pub fn shortest(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !value.is_finite() || !(1e-4..1e7).contains(&value.abs()) {
        let rounded: f64 = format!("{value:.9e}").parse().unwrap_or(value);
        return format!("{rounded:e}");
    }
    let before = value.abs().log10().floor() as i32 + 1;
    let digits = (10 - before.max(0)).max(0) as usize;
    let text = format!("{value:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').into(),
        false => text,
    }
}

/// |F_t| over |T_max|: the fraction of friction used, with more decimals near 1, where a mode switches. A dash if there is neither
/// force nor friction.
pub fn ratio(f_t: f64, t_max: f64) -> String {
    if t_max == 0.0 {
        return if f_t == 0.0 {
            "–".into()
        } else {
            "∞".into()
        };
    }
    let ratio = (f_t / t_max).abs();
    let off = ratio - 1.0;
    match () {
        _ if f_t == 0.0 => "0".into(),
        _ if off.abs() < 5e-7 => "1".into(),
        _ if off.abs() < 5e-5 => format!("{ratio:.6}"),
        _ if !(1e-3..1e3).contains(&ratio) => format!("{ratio:.1e}"),
        _ => format!("{ratio:.4}"),
    }
}

/// A number with four significant digits, for people.
pub fn sig4(value: f64) -> String {
    let size = value.abs();
    let text = match () {
        _ if value == 0.0 => return "0".into(),
        _ if !(1e-3..1e5).contains(&size) => return format!("{value:.3e}").replace('-', "−"),
        _ if value == value.round() => format!("{value:.0}"),
        _ => {
            let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
            let text = format!("{value:.decimals$}");
            match decimals {
                0 => text,
                _ => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            }
        }
    };
    text.replace('-', "−")
}

/// A number with at most six significant digits, for people.
pub fn sig6(value: f64) -> String {
    // Rounded in decimal, then printed in the shortest form that reads back equal.
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    match rounded {
        0.0 => "0".to_owned(),
        x if (1e-4..1e7).contains(&x.abs()) => x.to_string(),
        x => format!("{x:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_align_and_leave_a_gap() {
        assert_eq!(fixed_width(-1.23456789e-3, 13), "-1.23457e-3  ");
        assert_eq!(fixed_width(1.23456789e-3, 11), " 1.2346e-3 ");
        assert_eq!(fixed_width(-1.23456789e-10, 11), "-1.235e-10 ");
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
        assert_eq!(ratio(0.5, 1.0), "0.5000");
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
            (-5.752212389e-4, "−5.752e−4"),
            (0.05, "0.05"),
            (-0.113, "−0.113"),
            (30.0, "30"),
            (0.57735026919, "0.5774"),
            (12345.6, "12346"),
        ] {
            assert_eq!(sig4(value), text);
        }
    }
}
