//! Ends of a live connection, with the codes of their reasons.

use axum::extract::ws::close_code;

/// Code and reason of a close; None if the client has ended the session.
pub(crate) type Close = Option<(u16, &'static str)>;

/// Reasons why no more messages can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unreadable {
    /// A message or a frame is larger than the limit.
    TooLarge,
    /// Text, or the reason of a close, is not UTF-8.
    NotUtf8,
    /// A frame breaks the protocol (RFC 6455).
    Broken,
    /// The connection is gone, so nothing can be sent.
    Gone,
}

impl Unreadable {
    /// The close with this reason (RFC 6455, section 7.4.1).
    pub(crate) fn close(self) -> Close {
        match self {
            Unreadable::TooLarge => Some((close_code::SIZE, "a message too large")),
            Unreadable::NotUtf8 => Some((close_code::INVALID, "text that is not UTF-8")),
            Unreadable::Broken => Some((close_code::PROTOCOL, "a frame that breaks the protocol")),
            Unreadable::Gone => None,
        }
    }
}
