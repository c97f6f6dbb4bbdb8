//! Numbers as people read them.

/// A whole number with commas: `16,777,216`.
pub fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut out = String::with_capacity(digits.len() * 4 / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// A duration: `53.40 ms`, `0.534 s`, `12.3 s`, `3 min 20 s`, `2 h 05 min`.
pub fn seconds(seconds: f64) -> String {
    let whole = seconds.round().min(1e12) as u64;
    match whole {
        0..1 if seconds < 0.1 => format!("{:.2} ms", seconds * 1e3),
        0..1 => format!("{seconds:.3} s"),
        1..10 => format!("{seconds:.2} s"),
        10..120 => format!("{seconds:.1} s"),
        120..7200 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole / 60 % 60),
    }
}

/// Time left, in whole units: `12 s`, `3 min 20 s`.
pub fn countdown(left: f64) -> String {
    if left < 119.0 { format!("{:.0} s", left.max(0.0).ceil()) } else { seconds(left) }
}

/// A size in memory: `3.2 MiB`.
pub fn bytes(bytes: u64) -> String {
    let units = ["KiB", "MiB", "GiB", "TiB"];
    if bytes < 1024 {
        return format!("{bytes} bytes");
    }
    let (mut value, mut unit) = (bytes as f64 / 1024.0, 0);
    while value >= 1024.0 && unit + 1 < units.len() {
        value /= 1024.0;
        unit += 1;
    }
    format!("{value:.1} {}", units[unit])
}

/// `1 shape`, `2 shapes`.
pub fn plural(number: u64, noun: &str) -> String {
    format!("{} {noun}{}", count(number), if number == 1 { "" } else { "s" })
}

/// Arguments as a shell takes them.
pub fn shell_command(arguments: impl IntoIterator<Item = String>) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./,:=+@%".contains(c);
    let quoted = arguments.into_iter().map(|argument| {
        if !argument.is_empty() && argument.chars().all(plain) {
            argument
        } else {
            format!("'{}'", argument.replace('\'', r"'\''"))
        }
    });
    quoted.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts() {
        assert_eq!([0, 999, 1000, 16_777_216].map(count), ["0", "999", "1,000", "16,777,216"]);
        assert_eq!(plural(1, "light"), "1 light");
        assert_eq!(plural(1500, "light"), "1,500 lights");
    }

    #[test]
    fn durations_and_sizes() {
        assert_eq!(seconds(0.0534), "53.40 ms");
        assert_eq!(seconds(0.2), "0.200 s");
        assert_eq!(seconds(12.34), "12.3 s");
        assert_eq!(seconds(200.0), "3 min 20 s");
        assert_eq!(seconds(7500.0), "2 h 05 min");
        assert_eq!([countdown(0.2), countdown(118.9), countdown(200.0)], ["1 s", "119 s", "3 min 20 s"]);
        assert_eq!(bytes(3_355_443), "3.2 MiB");
        assert_eq!(bytes(12), "12 bytes");
    }

    #[test]
    fn commands_survive_a_shell() {
        let command = ["lichtweg", "a b.xml", "it's", ""].map(String::from);
        assert_eq!(shell_command(command), r"lichtweg 'a b.xml' 'it'\''s' ''");
    }
}
