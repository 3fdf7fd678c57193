//! `abbe report --watch`: builds the page again whenever a file it was built from changes.
//!
//! A file that is refused leaves the last good page in place, with the diagnostics above it.

use super::output::session::Session;
use super::serve::{ServedPage, serve};
use super::store::files::Recorded;
use super::verbs::report::{Args, compute, write};
use super::{Exit, Outcome};
use abbe::options::Delivery;
use abbe::results::{RenderedPage, Report};
use abbe::{Diagnostic, codes};
use std::net::{Ipv4Addr, TcpListener};
use std::rc::Rc;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Interval between two looks at the files.
const PACE: Duration = Duration::from_millis(150);

pub(super) fn run(session: &mut Session, args: &Args) -> Outcome {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, args.port)).or_else(|failure| {
        let message = format!("127.0.0.1 port {} cannot be opened: {failure}", args.port);
        session.refuse(Diagnostic::new(codes::E0631, message).help("leave `--port` out: any free port is taken then"))
    })?;
    let port = listener.local_addr().map_or(args.port, |address| address.port());
    let mut turn = Turn { args, good: None };
    let (files, first) = turn.take(session)?;
    let answer = Arc::new(Mutex::new(Arc::new(first)));
    serve(listener, port, Arc::new(Arc::clone(&answer))).or_else(|failure| {
        let message = format!("the page cannot be served: {failure}");
        session.refuse(Diagnostic::new(codes::E0631, message).help("write the page to a file: --out FILE.html"))
    })?;
    session.print(&format!(
        "http://127.0.0.1:{port}/ shows the page; it follows the files until this program is ended (Ctrl-C)."
    ));
    follow(session, &mut turn, files, &answer)
}

/// Looks at the files for ever.
fn follow(
    session: &mut Session,
    turn: &mut Turn<'_>,
    mut files: Rc<Recorded>,
    answer: &Mutex<Arc<ServedPage>>,
) -> Outcome {
    loop {
        std::thread::sleep(PACE);
        if files.changed() {
            let (read, next) = turn.take(session)?;
            files = read;
            if let Ok(mut answer) = answer.lock() {
                *answer = Arc::new(next);
            }
        }
    }
}

/// The last page that was fine.
struct Turn<'a> {
    args: &'a Args,
    good: Option<Report>,
}

impl Turn<'_> {
    /// Builds the page from the files as they are now.
    fn take(&mut self, session: &mut Session) -> Result<(Rc<Recorded>, ServedPage), Exit> {
        let mut now = session.fresh();
        let problem = match compute(&mut now, self.args) {
            Ok(report) => {
                self.good = Some(report);
                None
            }
            // The command line itself: no file will mend it.
            Err(Exit::Usage) => return session.unfit_as(&now),
            Err(Exit::Refused) => Some(now.diagnostics.to_string()),
        };
        let good = self.good.get_or_insert_default();
        let page = good.page(Delivery::Watched, problem.as_deref()).or_else(|d| session.refuse(d))?;
        let written = if problem.is_none() { write_alone(&mut now, self.args, good) } else { Ok(()) };
        if let Err(exit) = written {
            session.diagnostics.absorb(now.diagnostics);
            return Err(exit);
        }
        session.say(if problem.is_some() { "refused: the page gives the reason" } else { "the page is up to date" });
        Ok((now.files, answer(page)))
    }
}

fn write_alone(session: &mut Session, args: &Args, good: &Report) -> Outcome {
    if args.out.is_none() {
        return Ok(());
    }
    let page = good.page(Delivery::Alone, None).or_else(|d| session.refuse(d))?;
    write(session, args, &page)
}

fn answer(page: RenderedPage) -> ServedPage {
    ServedPage { tag: format!("\"{}\"", page.mark), body: page.text.into_bytes().into() }
}
