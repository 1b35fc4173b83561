//! Writes large answers to memory, and stops when their client has gone.

use std::io::{self, Write};

use crate::compute::Cancelled;
use crate::http::problem::Problem;
use crate::limits;

/// Bytes in memory, with a cancellation check now and then.
pub struct OutputBuffer<'a> {
    bytes: Vec<u8>,
    should_continue: &'a dyn Fn() -> bool,
    /// Length at which to check for cancellation again.
    next_check: usize,
    is_cancelled: bool,
}

/// Returns the bytes that `write` writes, and asks `should_continue` now and then. About `room` bytes are expected.
///
/// # Errors
/// A cancellation once `should_continue` is false; an internal error if `write` fails for another reason.
pub fn write_to_memory(
    room: usize,
    should_continue: &dyn Fn() -> bool,
    write: impl FnOnce(&mut OutputBuffer<'_>) -> io::Result<()>,
) -> Result<Vec<u8>, Problem> {
    let (bytes, next_check) = (Vec::new(), limits::WRITE_STEP_BYTES);
    let mut output = OutputBuffer { bytes, should_continue, next_check, is_cancelled: false };
    match output.reserve(room).and_then(|()| write(&mut output)) {
        Ok(()) => Ok(output.bytes),
        Err(_) if output.is_cancelled => Err(Cancelled.into()),
        Err(error) if error.kind() == io::ErrorKind::OutOfMemory => {
            Err(Problem::overloaded("the server is short of memory"))
        }
        Err(_) => Err(Problem::internal()),
    }
}

impl OutputBuffer<'_> {
    /// Makes room. Memory that there is not is an error: these are the largest pieces that any answer takes.
    #[inline]
    fn reserve(&mut self, bytes: usize) -> io::Result<()> {
        self.bytes.try_reserve(bytes).map_err(|_| io::ErrorKind::OutOfMemory.into())
    }
}

impl Write for OutputBuffer<'_> {
    #[inline]
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.write_all(bytes).map(|()| bytes.len())
    }

    #[inline]
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.reserve(bytes.len())?;
        self.bytes.extend_from_slice(bytes);
        if self.bytes.len() >= self.next_check {
            self.next_check = self.bytes.len() + limits::WRITE_STEP_BYTES;
            if !(self.should_continue)() {
                self.is_cancelled = true;
                return Err(io::Error::other(Cancelled));
            }
        }
        Ok(())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn bytes_come_out_as_they_go_in() {
        let bytes = write_to_memory(0, &|| true, |out| {
            (0..100_000_u32).try_for_each(|number| out.write_all(number.to_string().as_bytes()))
        });
        let all: String = (0..100_000_u32).map(|number| number.to_string()).collect();
        assert_eq!(bytes.unwrap(), all.into_bytes());
    }

    #[test]
    fn writing_ends_soon_after_nobody_waits() {
        let has_left = Cell::new(false);
        let mut rows = 0;
        let endless = |out: &mut OutputBuffer<'_>| {
            loop {
                rows += 1;
                if rows == 100 {
                    has_left.set(true);
                }
                out.write_all(&[b'0'; 1000])?;
            }
        };
        assert_eq!(write_to_memory(0, &|| !has_left.get(), endless).unwrap_err().status(), 503);
        assert!(rows <= 100 + limits::WRITE_STEP_BYTES / 1000 + 1, "{rows}");
    }

    #[test]
    fn other_failures_are_the_servers_own() {
        let failed = write_to_memory(0, &|| true, |_| Err(io::Error::other("on purpose")));
        assert_eq!(failed.unwrap_err().status(), 500);
    }
}
