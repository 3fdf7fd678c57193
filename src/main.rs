//! The program: everything is in the library, this only hands the process over to it.

fn main() -> std::process::ExitCode {
    abbe::cli::run(std::env::args_os())
}
