//! LinuxCNC's COMP_FILE of type 1, as measured on the controller: lines that its loader would accept in silence, and
//! its corrections.

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrectionTable {
    /// Rising positions.
    pub nominal: Vec<f64>,
    /// Trims forward and reverse.
    pub trims: [Vec<f64>; 2],
}

impl CorrectionTable {
    /// Reads a table whose every line the loader would take as it is; fails with the reason at any other line.
    pub fn read(text: &str) -> Result<Self, String> {
        if !text.is_ascii() || text.contains('\r') || !text.ends_with('\n') {
            return Err("not plain lines of ASCII, each with its end".into());
        }
        let mut table = Self { nominal: Vec::new(), trims: [Vec::new(), Vec::new()] };
        for (number, line) in text.lines().enumerate() {
            table.take(line).map_err(|what| format!("line {}: {what}: {line:?}", number + 1))?;
        }
        match table.nominal.len() {
            0 => Err("no line at all".into()),
            // The 257th is dropped.
            257.. => Err("more than 256 lines".into()),
            _ => Ok(table),
        }
    }

    fn take(&mut self, line: &str) -> Result<(), String> {
        // The loader's buffer has 255 bytes.
        if line.len() > 254 {
            return Err("longer than the buffer".into());
        }
        let words: Vec<&str> = line.split(' ').collect();
        let [nominal, forward, reverse] = words[..] else { return Err(format!("{} words", words.len())) };
        let values = [nominal, forward, reverse].map(plain);
        let [Some(nominal), Some(forward), Some(reverse)] = values else { return Err("not plain decimals".into()) };
        if self.nominal.last().is_some_and(|last| *last >= nominal) {
            return Err("does not rise".into());
        }
        self.nominal.push(nominal);
        self.trims[0].push(forward);
        self.trims[1].push(reverse);
        Ok(())
    }

    /// Returns the correction at a position: trim and slope are kept in single precision, the rest is double; the end
    /// values are held.
    pub fn added(&self, position: f64, reverse: bool) -> f64 {
        let trims = &self.trims[usize::from(reverse)];
        let at_or_below = self.nominal.iter().filter(|nominal| **nominal <= position).count();
        if at_or_below == 0 {
            return f64::from(trims[0] as f32);
        }
        let i = at_or_below - 1;
        let trim = trims[i] as f32;
        if i + 1 == trims.len() {
            return f64::from(trim);
        }
        let slope = (f64::from(trims[i + 1] as f32 - trim) / (self.nominal[i + 1] - self.nominal[i])) as f32;
        f64::from(trim) + f64::from(slope) * (position - self.nominal[i])
    }
}

/// A plain decimal number: digits, a point, digits, perhaps a minus, and no minus before nothing.
pub fn plain(word: &str) -> Option<f64> {
    let digits = word.strip_prefix('-').unwrap_or(word);
    let (whole, part) = digits.split_once('.')?;
    let plain = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
    let value: f64 = word.parse().ok().filter(|_| plain(whole) && plain(part))?;
    (value != 0.0 || !word.starts_with('-')).then_some(value)
}

#[test]
fn the_reader_takes_what_the_controller_takes_and_nothing_it_would_misread() {
    let good = "0.0 0.001 -0.001\n10.0 0.002 -0.003\n";
    let table = CorrectionTable::read(good).unwrap();
    assert_eq!(table.nominal, [0.0, 10.0]);
    let bad =
        ["", "# x\n0.0 0.0 0.0\n", "0.0 0.0 0.0\n\n", "0.0,0.0,0.0\n", "0.0 0.0\n", "0.0 nan 0.0\n", "0.0 1e-3 0.0\n"];
    for text in bad.into_iter().chain([
        "0.0 -0.000 0.0\n",
        "1.0 0.0 0.0\n1.0 0.0 0.0\n",
        "0.0 0.0 0.0",
        "\u{feff}0.0 0.0 0.0\n",
    ]) {
        assert!(CorrectionTable::read(text).is_err(), "{text:?}");
    }
    let rows = |n: usize| (0..n).map(|i| format!("{i}.0 0.0 0.0\n")).collect::<String>();
    assert!(CorrectionTable::read(&rows(256)).is_ok() && CorrectionTable::read(&rows(257)).is_err());
}

#[test]
fn the_replay_holds_its_ends_and_rounds_to_single_precision() {
    let table = CorrectionTable::read("0.0 0.1 0.5\n10.0 0.3 0.7\n").unwrap();
    let single = |x: f32| f64::from(x);
    assert_eq!(
        [table.added(-5.0, false), table.added(10.0, false), table.added(50.0, true)],
        [single(0.1), single(0.3), single(0.7)]
    );
    assert!((table.added(5.0, false) - 0.2).abs() < 1e-8);
    // Doubles would give another value: single precision shows in the ninth digit.
    assert!((table.added(5.0, false) - 0.2).abs() > 1e-10);
}
