//! Compresses answers. Equal input gives equal bytes: one algorithm in plain Rust at one level.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::compute::{Cancelled, TimeSlice};
use crate::limits;

/// Fast rather than small: digits of doubles hardly get smaller at higher levels.
const FAST: Compression = Compression::new(1);

/// Compresses an answer to one request.
pub fn gzip(bytes: &[u8], slice: &TimeSlice) -> Result<Vec<u8>, Cancelled> {
    compress(bytes, FAST, slice)
}

/// Compresses bytes that are sent many times, as small as possible.
pub fn gzip_best(bytes: &[u8]) -> Vec<u8> {
    compress(bytes, Compression::best(), &TimeSlice::unbounded()).expect("nobody cancels it")
}

fn compress(bytes: &[u8], level: Compression, slice: &TimeSlice) -> Result<Vec<u8>, Cancelled> {
    // The header has no time, name or system, so that equal answers are equal bytes.
    let mut encoder = GzEncoder::new(Vec::with_capacity(bytes.len() / 2), level);
    feed(&mut encoder, bytes, slice)?;
    Ok(encoder.finish().expect("a vector takes all bytes"))
}

/// An encoder for pieces, at the level of `gzip`.
pub(crate) fn encoder() -> GzEncoder<Vec<u8>> {
    GzEncoder::new(Vec::new(), FAST)
}

/// Compresses a large piece, with checks for cancellation.
pub(crate) fn feed(encoder: &mut GzEncoder<Vec<u8>>, bytes: &[u8], slice: &TimeSlice) -> Result<(), Cancelled> {
    for step in bytes.chunks(limits::GZIP_STEP_BYTES) {
        slice.check()?;
        encoder.write_all(step).expect("a vector takes all bytes");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    #[test]
    fn what_goes_in_comes_out() {
        let bytes: Vec<u8> = (0..300_000_u32).flat_map(|n| n.to_string().into_bytes()).collect();
        for packed in [gzip(&bytes, &TimeSlice::unbounded()).unwrap(), gzip_best(&bytes)] {
            assert!(packed.len() < bytes.len() / 2);
            assert_eq!(packed[4..8], [0; 4], "a time in the header would make equal answers differ");
            let mut unpacked = Vec::new();
            flate2::read::GzDecoder::new(packed.as_slice()).read_to_end(&mut unpacked).unwrap();
            assert_eq!(unpacked, bytes);
        }
    }

    #[test]
    fn nobody_waiting_is_nothing_to_do() {
        let slice = TimeSlice::unbounded();
        slice.cancel().set();
        assert_eq!(gzip(b"text", &slice), Err(Cancelled));
    }
}
