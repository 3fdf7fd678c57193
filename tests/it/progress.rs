//! Long work reports how far it is, and ends when its caller wants it to.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use abbe::{
    BudgetOptions, Cancelled, Diagnostics, IdentifyOptions, LoadOptions, MachineFile, MapOptions, Monitor, Run,
};

use crate::support::config;

/// Counts, and ends the job after a number of steps.
#[derive(Default)]
struct Counter {
    /// Steps that are announced, 0 if the job does not know.
    total: AtomicUsize,
    done: AtomicUsize,
    ended: AtomicUsize,
    limit: usize,
}

impl Monitor for Counter {
    fn begin(&self, phase: &str, total: usize) {
        assert!(!phase.is_empty());
        self.total.fetch_add(total, Ordering::Relaxed);
    }

    fn advance(&self, steps: usize) -> Result<(), Cancelled> {
        let done = self.done.fetch_add(steps, Ordering::Relaxed) + steps;
        if done > self.limit { Err(Cancelled) } else { Ok(()) }
    }

    fn end(&self) {
        self.ended.fetch_add(1, Ordering::Relaxed);
    }
}

type Job<'j> = &'j dyn Fn(&MachineFile, Run<'_>) -> Result<(), Diagnostics>;

/// The counts of a whole job; the same job is ended in its middle.
fn counted(path: &Path, job: Job) -> Counter {
    let file = abbe::load(path, &LoadOptions::default(), Run::on_disk()).unwrap().value;
    let whole = Counter { limit: usize::MAX, ..Counter::default() };
    job(&file, Run { monitor: &whole, ..Run::on_disk() }).unwrap();
    let half = Counter { limit: whole.done.load(Ordering::Relaxed) / 2, ..Counter::default() };
    let stopped = job(&file, Run { monitor: &half, ..Run::on_disk() });
    assert!(stopped.is_err_and(|diagnostics| diagnostics.is_cancelled() && diagnostics.is_empty()));
    assert!(half.done.load(Ordering::Relaxed) < whole.done.load(Ordering::Relaxed), "it ends early");
    whole
}

#[test]
fn maps_and_budgets_report_all_of_their_steps() {
    let map = counted(&config("trunnion.yaml"), &|file, run| abbe::map(file, &MapOptions::default(), run).map(|_| ()));
    assert_eq!(map.total.load(Ordering::Relaxed), map.done.load(Ordering::Relaxed));
    assert!(map.done.load(Ordering::Relaxed) > 10_000 && map.ended.load(Ordering::Relaxed) > 0);
    let options = BudgetOptions { samples: 200, ..BudgetOptions::default() };
    let study = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/examples/study.yaml");
    let budget = counted(&study, &|file, run| abbe::budget(file, &options, run).map(|_| ()));
    assert_eq!(budget.total.load(Ordering::Relaxed), budget.done.load(Ordering::Relaxed));
}

/// A fit does not know how often it will look at the readings; what comes after it has a total.
#[test]
fn a_fit_reports_the_readings_that_it_has_looked_at() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/examples/shop-floor");
    let fit = ["location", "EXX:poly3"].map(str::to_owned).to_vec();
    let data = vec![folder.join("volume.csv")];
    let options = IdentifyOptions { data, fit, folds: Some(3), ..IdentifyOptions::default() };
    let fit = counted(&folder.join("machine.yaml"), &|file, run| abbe::identify(file, &options, run).map(|_| ()));
    let (total, done) = (fit.total.load(Ordering::Relaxed), fit.done.load(Ordering::Relaxed));
    let rows = std::fs::read_to_string(folder.join("volume.csv")).unwrap().lines().count() - 2;
    // The uncertainty is one step, and each part left out another.
    assert!(total == 4 && done >= 2 * rows && done % rows == 4, "{done} of {rows} rows");
    assert_eq!(fit.ended.load(Ordering::Relaxed), 3);
}
