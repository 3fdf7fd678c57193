//! `abbe workbench`: the page in which a machine file is edited, served on 127.0.0.1.
//!
//! The page asks for everything by POST with a token. It stands in the address that the program prints, behind the `#`:
//! the page itself holds none, for every account of the computer may fetch it. The page may save one file, the one that
//! was named on the command line, and only over the text that it was given.

use crate::cli::Outcome;
use crate::cli::arguments::{JobArg, ReferenceArg, ToolPosesArg};
use crate::cli::output::session::Session;
use crate::cli::serve::{HTML, PageRequest, PageResponse, Site, serve};
use crate::cli::store::files::Recorded;
use crate::cli::store::write::{clear_left_over, replace_if};
use abbe::options::{BenchPage, Reference};
use abbe::text::shown;
use abbe::{Cancellation, Diagnostic, Files, Run, codes, workbench};
use hyper::{Method, StatusCode};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

#[derive(Debug, clap::Args)]
#[command(mut_arg("job", |option| option.conflicts_with("tool_poses")))]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    #[command(flatten)]
    tool_poses: ToolPosesArg,
    #[command(flatten)]
    job: JobArg,
    #[command(flatten)]
    reference: ReferenceArg,
    /// Port on 127.0.0.1 (0 to 65535) [default: any that is free].
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    port: u16,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let Args { tool_poses, job, reference, .. } = args;
    let part = PartAsked {
        work: job.job.clone().or_else(|| tool_poses.tool_poses.clone()),
        part: StatedPart { reference: reference.reference.clone(), path: job.path },
    };
    open(session, &args.machine, part, args.port)
}

/// The part with which the page begins.
#[derive(Debug, Default, Serialize)]
pub(super) struct PartAsked {
    /// Job file, or file of tool poses.
    #[serde(skip_serializing_if = "Option::is_none")]
    work: Option<PathBuf>,
    part: StatedPart,
}

/// The reference and the path that are stated of the part beside its file.
#[derive(Debug, Default, Serialize)]
struct StatedPart {
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Option<Reference>,
    #[serde(skip_serializing_if = "Option::is_none")]
    path: Option<bool>,
}

/// Serves the workbench of a machine until the program is ended.
pub(super) fn open(session: &mut Session, machine: &Path, part: PartAsked, port: u16) -> Outcome {
    if session.files.read(machine).is_err() {
        // The refusal names the reason.
        session.load(machine, None)?;
    }
    if let Some(work) = part.work.as_ref().filter(|work| session.files.read(work).is_err()) {
        let message = format!("`{}` cannot be read", shown(&work.display().to_string()));
        let help = "name a job file, or a file of tool poses, from the folder in which the program runs";
        return session.refuse(Diagnostic::new(codes::E0101, message).help(help));
    }
    let unserved = |message: String| Diagnostic::new(codes::E0631, message);
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).or_else(|failure| {
        let message = format!("127.0.0.1 port {port} cannot be opened: {failure}");
        session.refuse(unserved(message).help("leave `--port` out: any free port is taken then"))
    })?;
    let port = listener.local_addr().map_or(port, |address| address.port());
    // Of a save that was killed.
    clear_left_over(machine, &Recorded::default());
    let bench = random().and_then(|token| {
        let bench = Bench::new(machine, session.root(), token.clone(), &random()?).with_part(&part);
        serve(listener, port, Arc::new(bench)).map(|()| token)
    });
    let token = bench.or_else(|failure| session.refuse(unserved(format!("the page cannot be served: {failure}"))))?;
    session.print(&format!(
        "http://127.0.0.1:{port}/#token={token} is the workbench of {}; \
         the file changes when you save it there. Ctrl-C ends it.",
        machine.display()
    ));
    // Nobody knows the address of a server that cannot name it.
    while !session.has_lost_output() {
        std::thread::park();
    }
    Ok(())
}

/// Returns 128 random bits, hexadecimal.
fn random() -> std::io::Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|failure| std::io::Error::other(failure.to_string()))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// A machine file on the workbench.
struct Bench {
    machine: PathBuf,
    /// The part with which the page begins.
    part: Value,
    /// The folder of `--confined`.
    root: Option<PathBuf>,
    token: String,
    page: String,
    /// Held while the file is compared and replaced.
    saving: Mutex<()>,
    /// Sources of the answers.
    inputs: Mutex<InputFiles>,
}

/// The files that were read for answers since the last change of one of them.
#[derive(Default)]
struct InputFiles {
    read: Recorded,
    /// Number of changes so far.
    changes: u64,
}

/// Request of the page to save the file.
#[derive(Deserialize)]
struct SaveRequest {
    /// The text to write.
    text: String,
    /// The text that the page was given.
    before: String,
}

impl Site for Bench {
    fn respond(&self, request: &PageRequest, cancellation: &Cancellation) -> PageResponse {
        match (&request.method, request.path.as_str()) {
            (&Method::GET, "/") => {
                PageResponse { status: StatusCode::OK, media: HTML, body: self.page.clone().into_bytes().into() }
            }
            (&Method::GET, _) => PageResponse::empty(StatusCode::NOT_FOUND),
            (&Method::POST, _) if request.token.as_deref() != Some(self.token.as_str()) => {
                PageResponse::empty(StatusCode::FORBIDDEN)
            }
            (&Method::POST, path) => self.post(path, &String::from_utf8_lossy(&request.body), cancellation),
            _ => PageResponse::empty(StatusCode::METHOD_NOT_ALLOWED),
        }
    }
}

impl Bench {
    /// `nonce` is that of the page's style, hexadecimal.
    fn new(machine: &Path, root: Option<&Path>, token: String, nonce: &str) -> Self {
        let start = json!({"evaluator": "program"}).to_string();
        let page = BenchPage { start: &start, nonce, is_served: true, ..BenchPage::default() }.html();
        let (machine, root) = (machine.to_owned(), root.map(Path::to_owned));
        Self { machine, part: json!({}), root, token, page, saving: Mutex::default(), inputs: Mutex::default() }
    }

    fn with_part(self, part: &PartAsked) -> Self {
        Self { part: json!(part), ..self }
    }

    fn post(&self, path: &str, body: &str, cancellation: &Cancellation) -> PageResponse {
        match path {
            "/open" => self.open(),
            "/ask" => self.ask(body, cancellation),
            "/follow" => self.follow(),
            "/save" => match serde_json::from_str(body) {
                Ok(request) => self.save(&request),
                Err(_) => PageResponse::empty(StatusCode::BAD_REQUEST),
            },
            _ => PageResponse::empty(StatusCode::NOT_FOUND),
        }
    }

    fn files(&self) -> Recorded {
        Recorded::within(self.root.as_deref())
    }

    /// Returns the text of the file as it is now.
    fn text(&self) -> Option<String> {
        String::from_utf8(self.files().read(&self.machine).ok()?).ok()
    }

    fn ask(&self, body: &str, cancellation: &Cancellation) -> PageResponse {
        let files = self.files();
        let run = Run { monitor: cancellation, ..Run::with(&files) };
        let found = answer(StatusCode::OK, &workbench(body, run));
        self.inputs.lock().unwrap_or_else(PoisonError::into_inner).read.absorb(files);
        found
    }

    /// Returns the text of the file as it is now, and how often a file that answers were computed from has changed.
    fn follow(&self) -> PageResponse {
        let mut inputs = self.inputs.lock().unwrap_or_else(PoisonError::into_inner);
        if inputs.read.has_changed() {
            *inputs = InputFiles { read: self.files(), changes: inputs.changes + 1 };
        }
        answer(StatusCode::OK, &json!({"text": self.text(), "changes": inputs.changes}))
    }

    fn open(&self) -> PageResponse {
        match self.text() {
            Some(text) => {
                let mut open = self.part.clone();
                (open["machine"], open["text"]) = (json!(self.machine), text.into());
                answer(StatusCode::OK, &open)
            }
            None => failure(StatusCode::NOT_FOUND, "the file cannot be read as text"),
        }
    }

    fn save(&self, request: &SaveRequest) -> PageResponse {
        let _saving = self.saving.lock().unwrap_or_else(PoisonError::into_inner);
        let still = || self.text().is_some_and(|text| text == request.before);
        clear_left_over(&self.machine, &Recorded::default());
        match still().then(|| replace_if(&self.machine, request.text.as_bytes(), still)) {
            Some(Ok(true)) => answer(StatusCode::OK, &json!({"saved": true})),
            Some(Err(diagnostic)) => failure(StatusCode::INTERNAL_SERVER_ERROR, &diagnostic.message),
            None | Some(Ok(false)) => self.conflict(),
        }
    }

    /// Others wrote the file: their text is for the page to show.
    fn conflict(&self) -> PageResponse {
        let theirs = self.text();
        let words = match theirs {
            Some(_) => "the file on the disk has changed since the page read it",
            None => "the file on the disk can no longer be read",
        };
        answer(StatusCode::CONFLICT, &json!({"failure": words, "theirs": theirs}))
    }
}

fn answer(status: StatusCode, value: &Value) -> PageResponse {
    PageResponse { status, media: "application/json", body: value.to_string().into_bytes().into() }
}

fn failure(status: StatusCode, message: &str) -> PageResponse {
    answer(status, &json!({"failure": message}))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(bench: &Bench, method: Method, path: &str, token: Option<&str>, body: &Value) -> (u16, Value) {
        let body = body.to_string().into_bytes().into();
        let (path, token) = (path.to_owned(), token.map(str::to_owned));
        let response = bench.respond(&PageRequest { method, path, token, body }, &Cancellation::default());
        (response.status.as_u16(), serde_json::from_slice(&response.body).unwrap_or(Value::Null))
    }

    #[test]
    fn only_the_page_reads_and_saves_and_only_over_what_it_read() {
        let folder = std::env::temp_dir().join(format!("abbe-bench-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("m.yaml");
        std::fs::write(&file, "abbe: 1\n").unwrap();
        let bench = Bench::new(&file, None, "secret".to_owned(), "n");
        assert!(bench.page.contains("'nonce-n'") && !bench.page.contains("secret"), "the page tells its token");
        let save = |before: &str, text: &str| json!({"before": before, "text": text});
        for path in ["/open", "/ask", "/follow", "/save"] {
            for token in [None, Some(""), Some("guess")] {
                assert_eq!(ask(&bench, Method::POST, path, token, &save("abbe: 1\n", "x")).0, 403, "{path}");
            }
            assert_eq!(ask(&bench, Method::GET, path, Some("secret"), &Value::Null).0, 404, "{path}");
        }
        let post = |path: &str, body: &Value| ask(&bench, Method::POST, path, Some("secret"), body);
        assert_eq!(post("/open", &Value::Null).1, json!({"machine": &file, "text": "abbe: 1\n"}));
        let part = PartAsked { work: Some("job.yaml".into()), part: StatedPart { reference: None, path: Some(true) } };
        let open = Bench::new(&file, None, "secret".to_owned(), "n").with_part(&part).open();
        let open: Value = serde_json::from_slice(&open.body).unwrap();
        assert_eq!((&open["work"], &open["part"]), (&"job.yaml".into(), &json!({"path": true})));
        let (status, told) = post("/save", &save("other", "x"));
        assert_eq!((status, &told["theirs"]), (409, &"abbe: 1\n".into()), "{told}");
        assert_eq!(post("/save", &json!({"text": "x"})).0, 400);
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "abbe: 1\n");
        assert_eq!(post("/save", &save("abbe: 1\n", "abbe: 1\n# new\n")).0, 200);
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "abbe: 1\n# new\n");
        // What a killed save left.
        std::fs::write(folder.join(".m.yaml.999999999.tmp"), "half").unwrap();
        assert_eq!(post("/save", &save("abbe: 1\n# new\n", "abbe: 1\n")).0, 200);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        std::fs::remove_file(&file).unwrap();
        assert_eq!(post("/save", &save("abbe: 1\n", "x")).1["theirs"], Value::Null);
        assert_eq!(post("/../m.yaml", &Value::Null).0, 404);
        assert_eq!(ask(&bench, Method::PUT, "/", Some("secret"), &Value::Null).0, 405);
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_change_of_a_file_that_was_read_is_counted_once() {
        let folder = std::env::temp_dir().join(format!("abbe-follow-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (file, base) = (folder.join("m.yaml"), folder.join("base.yaml"));
        let text = "abbe: 1\nextends: base.yaml\n";
        std::fs::write(&file, text).unwrap();
        std::fs::write(&base, "machine: One\n").unwrap();
        let bench = Bench::new(&file, None, "secret".to_owned(), "n");
        let post = |path: &str, body: &Value| ask(&bench, Method::POST, path, Some("secret"), body).1;
        let request = json!({"machine": &file, "texts": {file.to_str().unwrap(): text}, "questions": ["check"]});
        let _ = post("/ask", &request);
        let state = |text: &str, changes: u64| json!({"text": text, "changes": changes});
        assert_eq!(post("/follow", &Value::Null), state(text, 0));
        std::fs::write(&base, "machine: Two\n").unwrap();
        for _ in 0..2 {
            assert_eq!(post("/follow", &Value::Null), state(text, 1));
        }
        let _ = post("/ask", &request);
        std::fs::write(&base, "machine: Three\n").unwrap();
        std::fs::write(&file, "abbe: 1\n").unwrap();
        assert_eq!(post("/follow", &Value::Null), state("abbe: 1\n", 2));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
