//! Paired timing of contenders that compute the same.
//!
//! Benchmark libraries time one thing after the other; on a machine with other work its speed drifts between them, and
//! the drift goes into the ratio. Here the contenders take turns, sample by sample of some ten microseconds. The result
//! is the median of the ratios of neighbouring samples, beside medians and minima of the times.

use std::time::Instant;

/// One contender: a name, and a closure that repeats its operation.
pub struct Contender<'a> {
    /// Printed name.
    pub name: &'a str,
    /// Repeats the operation a number of times.
    pub run: Box<dyn FnMut(usize) + 'a>,
}

impl<'a> Contender<'a> {
    /// Returns a contender.
    pub fn new(name: &'a str, run: impl FnMut(usize) + 'a) -> Self {
        Self { name, run: Box::new(run) }
    }
}

/// Times of one contender, in ns per operation.
#[derive(Debug, Clone)]
pub struct Result {
    /// Printed name.
    pub name: String,
    /// Median over the samples.
    pub median: f64,
    /// The fastest sample.
    pub min: f64,
    /// Median of the ratio of the first contender's sample to this one's beside it.
    pub ratio: f64,
}

/// Length of a sample in ns: short beside the slices of a scheduler.
const SAMPLE: f64 = 30_000.0;

/// Times the contenders in turns; each call of `run(n)` counts as `n * operations`.
pub fn paired(contenders: &mut [Contender<'_>], operations: usize, samples: usize) -> Vec<Result> {
    let counts: Vec<usize> = contenders.iter_mut().map(calibrated).collect();
    let mut times: Vec<Vec<f64>> = vec![Vec::with_capacity(samples); contenders.len()];
    for sample in 0..samples {
        for turn in 0..contenders.len() {
            let k = (turn + sample) % contenders.len();
            times[k].push(timed(&mut contenders[k], counts[k]) / (counts[k] * operations) as f64);
        }
    }
    let result = |k: usize| Result {
        name: contenders[k].name.to_owned(),
        median: median(times[k].clone()),
        min: times[k].iter().copied().fold(f64::INFINITY, f64::min),
        ratio: median(times[0].iter().zip(&times[k]).map(|(a, b)| a / b).collect()),
    };
    (0..contenders.len()).map(result).collect()
}

/// Prints a line per contender; the ratio is the time of the first divided by its own.
pub fn print(title: &str, results: &[Result]) {
    for (k, r) in results.iter().enumerate() {
        let title = if k == 0 { title } else { "" };
        let ratio = if k == 0 { String::new() } else { format!("{:8.3}", r.ratio) };
        println!("{title:<24} {:<12} {:>10.2} {:>10.2} {ratio}", r.name, r.median, r.min);
    }
}

/// Prints the heading of the lines.
pub fn heading() {
    println!("{:<24} {:<12} {:>10} {:>10} {:>8}", "", "", "median ns", "min ns", "ratio");
}

fn timed(contender: &mut Contender<'_>, count: usize) -> f64 {
    let start = Instant::now();
    (contender.run)(count);
    start.elapsed().as_nanos() as f64
}

fn calibrated(contender: &mut Contender<'_>) -> usize {
    let mut count = 1;
    loop {
        let time = timed(contender, count).min(timed(contender, count));
        if time >= SAMPLE || count >= 1 << 24 {
            return count;
        }
        count = (count * 2).max((count as f64 * 0.8 * SAMPLE / time.max(1.0)) as usize);
    }
}

/// Returns the middle of a list.
fn median(mut list: Vec<f64>) -> f64 {
    list.sort_by(f64::total_cmp);
    list[list.len() / 2]
}
