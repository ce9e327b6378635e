//! `cargo sitl`: see `tautline_sitl::command`.

use std::process::ExitCode;

fn main() -> ExitCode {
    tautline_sitl::command::run()
}
