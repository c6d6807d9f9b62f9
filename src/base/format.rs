//! Numbers as people read them: units, thousands separators, three digits that count.

/// A count with thousands separators: 1,234,567.
pub fn count(number: impl TryInto<u64>) -> String {
    let Ok(number) = number.try_into() else { return "–".into() };
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A number to one decimal with thousands separators, for what a person sets: 0.5, 100, 11,174.3.
pub fn grouped(value: f64) -> String {
    let tenths = (value.abs() * 10.0).round() as u64;
    let sign = if value < 0.0 && tenths > 0 { "-" } else { "" };
    match tenths % 10 {
        0 => format!("{sign}{}", count(tenths / 10)),
        tenth => format!("{sign}{}.{tenth}", count(tenths / 10)),
    }
}

/// A count of things: 1 polygon, 2,008 polygons.
pub fn things(number: usize, one: &str, many: &str) -> String {
    format!("{} {}", count(number), if number == 1 { one } else { many })
}

/// Three digits that count, with a power of ten where that is shorter to read: 0.0123, 12.3,
/// 1.23e-5.
pub fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !value.is_finite() {
        return "–".into();
    }
    match value.abs() {
        size if !(1e-3..1e6).contains(&size) => format!("{value:.2e}"),
        size if size >= 999.5 => {
            let sign = if value < 0.0 { "-" } else { "" };
            format!("{sign}{}", count(size.round() as u64))
        }
        size => {
            let decimals = (2 - size.log10().floor() as i32).clamp(0, 6) as usize;
            format!("{value:.decimals$}")
        }
    }
}

/// A number above 0, rounded to one digit.
pub fn to_one_digit(value: f32) -> f32 {
    let power = 10_f32.powi(value.log10().floor() as i32);
    (value / power).round().max(1.0) * power
}

/// Three digits that count, without zeros at the end, for round numbers: 0.5, 20, 1,500.
pub fn short(value: f64) -> String {
    let text = number(value);
    match text.split_once('.') {
        Some((_, decimals)) if decimals.chars().all(|digit| digit.is_ascii_digit()) => {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        _ => text,
    }
}

/// A measured value with its standard error, which says how many digits count: 12.4 ± 0.8, 40 ± 19,
/// 8.23 ± 0.04.
pub fn plus_minus(value: f64, standard_error: f64) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let decimals = match standard_error {
        error if error < 0.01 => 3,
        error if error < 0.1 => 2,
        error if error < 10.0 || !error.is_finite() => 1,
        _ => 0,
    };
    let text = |value: f64| if value.abs() < 1e3 { format!("{value:.decimals$}") } else { grouped(value.round()) };
    match standard_error {
        // No error at all says nothing of digits.
        0.0 => format!("{} ± 0", number(value)),
        error if error.is_finite() => format!("{} ± {}", text(value), text(error)),
        _ => format!("{} ± ∞", text(value)),
    }
}

/// A number with its unit.
pub fn quantity(value: f64, unit: &str) -> String {
    format!("{} {unit}", number(value))
}

/// A time: 12.3 ms, 4.56 s, 2 min 05 s.
pub fn seconds(seconds: f64) -> String {
    if seconds >= 60.0 {
        let whole = seconds.round() as u64;
        format!("{} min {:02} s", whole / 60, whole % 60)
    } else if seconds >= 1.0 || seconds <= 0.0 {
        format!("{seconds:.1} s")
    } else {
        format!("{:.0} ms", 1e3 * seconds)
    }
}

/// A memory size: 512 B, 12.3 KiB, 4.5 MiB.
pub fn bytes(bytes: usize) -> String {
    const UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
    if bytes < 1024 {
        return format!("{bytes} B");
    }
    let mut size = bytes as f64 / 1024.0;
    let mut unit = 0;
    while size >= 1024.0 && unit + 1 < UNITS.len() {
        size /= 1024.0;
        unit += 1;
    }
    format!("{size:.1} {}", UNITS[unit])
}

/// The system's text of an error without its number: `(os error 2)` tells a person nothing.
pub fn without_os_codes(text: &str) -> String {
    const MARK: &str = " (os error ";
    let mut kept = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(MARK) {
        let behind = &rest[start + MARK.len()..];
        let digits = behind.len() - behind.trim_start_matches(|c: char| c.is_ascii_digit() || c == '-').len();
        let is_code = digits > 0 && behind[digits..].starts_with(')');
        kept.push_str(&rest[..if is_code { start } else { start + MARK.len() }]);
        rest = if is_code { &behind[digits + 1..] } else { behind };
    }
    kept + rest
}

/// A share in per cent: 12.4 %.
pub fn percent(share: f64) -> String {
    if share.is_finite() { format!("{} %", number(100.0 * share)) } else { "–".into() }
}

/// A share and its standard error in per cent.
pub fn percent_with(share: f64, standard_error: f64) -> String {
    format!("{} %", plus_minus(100.0 * share, 100.0 * standard_error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_the_system_are_left_out() {
        let said = "a.csv: cannot be read (No such file (os error 2)); try (os error x) again (os error 13)";
        assert_eq!(without_os_codes(said), "a.csv: cannot be read (No such file); try (os error x) again");
    }

    /// Written out by hand.
    #[test]
    fn numbers_read_well() {
        assert_eq!(count(0_u32), "0");
        assert_eq!(count(999_u32), "999");
        assert_eq!(count(1_000_u32), "1,000");
        assert_eq!(count(1_234_567_usize), "1,234,567");
        assert_eq!(things(1, "polygon", "polygons"), "1 polygon");
        assert_eq!(things(2_008, "polygon", "polygons"), "2,008 polygons");
        assert_eq!([0.0, 0.04, -2.5, 100.0, 11_174.34].map(grouped), ["0", "0", "-2.5", "100", "11,174.3"]);
        assert_eq!(number(0.0), "0");
        assert_eq!([0.5, 20.0, 1500.0, 0.01, 1e-5, 0.0].map(short), ["0.5", "20", "1,500", "0.01", "1.00e-5", "0"]);
        assert_eq!([999.4, 999.6].map(number), ["999", "1,000"]);
        assert_eq!(number(12.345), "12.3");
        assert_eq!(number(0.012345), "0.0123");
        assert_eq!(number(-12_345.0), "-12,345");
        assert_eq!(number(0.000_012_3), "1.23e-5");
        assert_eq!(number(f64::NAN), "–");
        assert_eq!(quantity(2.5, "W"), "2.50 W");
        let measured =
            [(12.44, 0.81), (41.2, 19.0), (8.2345, 0.041), (0.0, 0.3), (1234.0, 56.0), (5.0, 0.0), (0.5, 0.0012)];
        let read = measured.map(|(value, error)| plus_minus(value, error));
        assert_eq!(
            read,
            ["12.4 ± 0.8", "41 ± 19", "8.23 ± 0.04", "0.0 ± 0.3", "1,234 ± 56", "5.00 ± 0", "0.500 ± 0.001"]
        );
        assert_eq!(plus_minus(-1234.0, 56.0), "-1,234 ± 56");
        assert_eq!((plus_minus(12.44, f64::INFINITY), plus_minus(f64::NAN, 1.0)), ("12.4 ± ∞".into(), "–".into()));
        assert_eq!(seconds(0.0123), "12 ms");
        assert_eq!(seconds(125.0), "2 min 05 s");
        assert_eq!(bytes(512), "512 B");
        assert_eq!(bytes(5 << 20), "5.0 MiB");
    }
}
