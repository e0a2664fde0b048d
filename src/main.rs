//! The program: see [`stickslip::cli`].

fn main() -> std::process::ExitCode {
    stickslip::cli::main()
}
