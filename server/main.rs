//! The `equipoise` program with its allocator. Everything else is in the library, which compiles beside the physics.

mod allocator;

use std::process::ExitCode;

fn main() -> ExitCode {
    allocator::give_back_at_once();
    equipoise::program::main()
}
