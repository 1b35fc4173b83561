//! The queue of messages to one live client. It is bounded: for a slow client it skips the oldest impacts and says so with a `gap`.
//! No other message is skipped.

use std::collections::VecDeque;

use axum::extract::ws::{Message, close_code};
use futures_util::{Sink, SinkExt, Stream, StreamExt};
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use tokio::time::{Instant, timeout};

use crate::http::Problem;
use crate::limits;
use crate::live::server_message;
use crate::live::server_message::{ImpactMessage, OutgoingFrame, ServerMessage};

#[derive(Debug)]
enum QueuedItem {
    Impact(Box<ImpactMessage>),
    Frame(OutgoingFrame),
}

/// The queue of one client.
#[derive(Debug)]
pub struct Outbox {
    items: VecDeque<QueuedItem>,
    impacts: usize,
    most_impacts: usize,
    gap: Option<(u64, u64)>,
    since: Option<Instant>,
}

impl Outbox {
    /// An empty queue for so many impacts.
    pub fn new(most_impacts: usize) -> Self {
        Self { items: VecDeque::new(), impacts: 0, most_impacts: most_impacts.max(1), gap: None, since: None }
    }

    /// Tells whether nothing waits.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Time since which something has been waiting without a break.
    pub fn waiting_since(&self) -> Option<Instant> {
        self.since
    }

    /// Number of waiting messages other than impacts. Each answers a message of the client.
    pub fn answers(&self) -> usize {
        self.items.len() - self.impacts
    }

    /// Adds any message but an impact.
    pub fn push(&mut self, frame: OutgoingFrame) {
        self.add(QueuedItem::Frame(frame));
    }

    /// Adds an impact, and skips the oldest one if there are too many.
    pub fn push_impact(&mut self, impact: ImpactMessage) {
        self.add(QueuedItem::Impact(Box::new(impact)));
        self.impacts += 1;
        if self.impacts > self.most_impacts
            && let Some(oldest) = self.items.iter().position(|item| matches!(item, QueuedItem::Impact(_)))
            && let Some(QueuedItem::Impact(impact)) = self.items.remove(oldest)
        {
            self.impacts -= 1;
            self.gap = Some((self.gap.map_or(impact.n(), |(from, _)| from), impact.n()));
        }
    }

    /// Drops the waiting impacts, for a client that has left their run.
    pub fn drop_impacts(&mut self) {
        self.items.retain(|item| matches!(item, QueuedItem::Frame(_)));
        (self.impacts, self.gap) = (0, None);
        self.note_emptiness();
    }

    /// The next frame. Consecutive impacts are sent as one message.
    pub fn pop(&mut self) -> Option<OutgoingFrame> {
        let frame = match self.items.pop_front()? {
            QueuedItem::Frame(frame) => frame,
            QueuedItem::Impact(impact) => match self.gap.take() {
                Some((from, to)) => {
                    self.items.push_front(QueuedItem::Impact(impact));
                    ServerMessage::Gap { from, to }.to_frame()
                }
                None => self.impacts_from(*impact),
            },
        };
        self.note_emptiness();
        Some(frame)
    }

    fn impacts_from(&mut self, first: ImpactMessage) -> OutgoingFrame {
        let mut batch = vec![first];
        while batch.len() < limits::LIVE_BATCH
            && let Some(QueuedItem::Impact(_)) = self.items.front()
            && let Some(QueuedItem::Impact(impact)) = self.items.pop_front()
        {
            batch.push(*impact);
        }
        self.impacts -= batch.len();
        ServerMessage::impacts(&batch).to_frame()
    }

    fn add(&mut self, item: QueuedItem) {
        self.since.get_or_insert_with(Instant::now);
        self.items.push_back(item);
    }

    fn note_emptiness(&mut self) {
        if self.items.is_empty() {
            self.since = None;
        }
    }
}

// Ends of a live connection, with the codes of their reasons.

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

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::api::computed::trajectories::columns::ImpactRow;
    use crate::runs::playback::Playback;
    use crate::runs::run::tests::case;

    fn pop(outbox: &mut Outbox) -> Value {
        let Some(OutgoingFrame::Message { text, .. }) = outbox.pop() else { panic!("nothing waits") };
        serde_json::from_str(&text).unwrap()
    }

    /// The impacts of a run, one after another.
    fn impacts() -> impl FnMut() -> ImpactMessage {
        let run = case("case-1");
        let mut playback = Playback::new(&run, limits::LIVE_BOUNCES);
        move || {
            let (contact, _) = playback.next_impact(&run, &mut || true).unwrap().unwrap();
            ImpactMessage { row: ImpactRow::new(playback.body(), true, contact), next_strike: None }
        }
    }

    #[test]
    fn a_slow_client_is_told_what_it_misses() {
        let mut next = impacts();
        let mut outbox = Outbox::new(4);
        outbox.push_impact(next());
        assert_eq!(pop(&mut outbox)["n"], 1);
        assert!(outbox.waiting_since().is_none());
        outbox.push_impact(next());
        outbox.push(OutgoingFrame::Message { kind: "ack", id: None, text: "1".to_owned() });
        for _ in 3..=12 {
            outbox.push_impact(next());
        }
        assert_eq!(pop(&mut outbox), 1);
        assert_eq!(pop(&mut outbox), json!({"type": "gap", "from": 2, "to": 8}));
        assert_eq!(pop(&mut outbox)["columns"]["n"], json!([9, 10, 11, 12]));
        assert!(outbox.is_empty() && outbox.waiting_since().is_none());
    }
}
