//! How the connection of a live run ends, and the codes that say why.

use axum::extract::ws::close_code;

/// How a session ends; none if the client has ended it.
pub(crate) type Close = Option<(u16, &'static str)>;

/// Reasons for which no message can be read any more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unreadable {
    /// A message or a frame is larger than the limit.
    TooLarge,
    /// Text, or the reason of a close, is not UTF-8.
    NotUtf8,
    /// A frame breaks the protocol (RFC 6455).
    Broken,
    /// The connection is gone: there is nobody to tell.
    Gone,
}

impl Unreadable {
    /// The close that says so (RFC 6455, section 7.4.1).
    pub(crate) fn close(self) -> Close {
        match self {
            Unreadable::TooLarge => Some((close_code::SIZE, "a message too large")),
            Unreadable::NotUtf8 => Some((close_code::INVALID, "text that is not UTF-8")),
            Unreadable::Broken => Some((close_code::PROTOCOL, "a frame that breaks the protocol")),
            Unreadable::Gone => None,
        }
    }
}
