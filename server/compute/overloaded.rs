//! Refusals of work because of overload, with their words.

use std::fmt;

use crate::compute::quota::QuotaExceeded;

/// Work was refused because of overload.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Overloaded {
    /// The queue is full.
    QueueFull(QuotaExceeded),
    /// The client has too many unread answers.
    UnreadAnswers(QuotaExceeded),
    /// The work would take more memory than is left for the client.
    Memory(QuotaExceeded),
    /// No permit became free in time.
    QueueTimeout {
        /// Time in the queue, s.
        waited_s: u64,
    },
}

impl fmt::Display for Overloaded {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Overloaded::QueueFull(QuotaExceeded { held, free }) => {
                write!(formatter, "{held} requests from this address are computed or waiting, and ")?;
                match free {
                    0 => formatter.write_str("no place is left"),
                    free => write!(formatter, "the last {free} places are for others"),
                }
            }
            Overloaded::UnreadAnswers(QuotaExceeded { held, free }) => {
                write!(formatter, "{held} bytes of answers are still to be read from this address, and ")?;
                write!(formatter, "the last {free} bytes of memory for answers are for others")
            }
            Overloaded::Memory(QuotaExceeded { held, free }) => {
                write!(
                    formatter,
                    "answers for this address are computed in {held} bytes of memory, and {free} bytes are free, "
                )?;
                formatter.write_str("too few for one more")
            }
            Overloaded::QueueTimeout { waited_s } => {
                write!(formatter, "the request waited {waited_s} s for its turn, the limit")
            }
        }
    }
}

impl std::error::Error for Overloaded {}
