//! Ends of a live connection, with the codes of their reasons.

use axum::extract::ws::{Message, close_code};
use futures_util::{Sink, SinkExt, Stream, StreamExt};
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use tokio::time::timeout;

use crate::http::Problem;
use crate::limits;
use crate::live::outbox::Outbox;
use crate::live::server_message;
use crate::live::server_message::OutgoingFrame;

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

/// Tells a client why it gets no run, and closes the connection.
pub async fn refuse(
    problem: &Problem,
    incoming: impl Stream<Item = Result<Message, Unreadable>> + Unpin + Send,
    outgoing: impl Sink<OutgoingFrame> + Unpin + Send + 'static,
) {
    let mut outbox = Outbox::new(0);
    outbox.push(server_message::problem(problem));
    let (code, reason) = match problem.status().is_server_error() {
        true => (close_code::AGAIN, "busy"),
        false => (close_code::POLICY, problem.title()),
    };
    outbox.push(OutgoingFrame::Close(code, reason));
    let (sender, writer) = writer(outgoing);
    say_goodbye(outbox, incoming, sender, writer).await;
}

/// Starts a task that sends frames one after another.
pub(crate) fn writer(
    mut outgoing: impl Sink<OutgoingFrame> + Unpin + Send + 'static,
) -> (mpsc::Sender<OutgoingFrame>, JoinHandle<()>) {
    let (sender, mut receiver) = mpsc::channel(1);
    let writer = tokio::spawn(async move {
        while let Some(frame) = receiver.recv().await {
            if outgoing.send(frame).await.is_err() {
                return;
            }
        }
        // The last message has been flushed. Dropping the other half ends the connection.
    });
    (sender, writer)
}

/// Sends the last messages and waits for the client's close, up to a limit.
pub(crate) async fn say_goodbye(
    mut outbox: Outbox,
    mut incoming: impl Stream<Item = Result<Message, Unreadable>> + Unpin + Send,
    sender: mpsc::Sender<OutgoingFrame>,
    mut writer: JoinHandle<()>,
) {
    let goodbye = async {
        while let Some(frame) = outbox.pop() {
            if sender.send(frame).await.is_err() {
                break;
            }
        }
        drop(sender);
        let _ = (&mut writer).await;
        // Waits for the client's close, so that the client gets all messages.
        while let Some(Ok(_)) = incoming.next().await {}
    };
    let _ = timeout(limits::GOODBYE_TIME, goodbye).await;
    writer.abort();
}
