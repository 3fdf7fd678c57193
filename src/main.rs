//! The program: a face over the library, which computes everything.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run(std::env::args_os())
}
