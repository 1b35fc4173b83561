//! Messages of a live client, which may come while work for it is under way: work ends with the client.

use std::collections::VecDeque;
use std::pin::{Pin, pin};
use std::task::{Context, Poll};

use axum::extract::ws::Message;
use futures_util::future::{Either, select};
use futures_util::{Stream, StreamExt};

use crate::limits;
use crate::live::close::Unreadable;

type Incoming = Result<Message, Unreadable>;

/// Messages of a client. Those that came during work wait for their turn.
#[derive(Debug)]
pub struct Inbox<S> {
    stream: S,
    waiting: VecDeque<Incoming>,
}

impl<S: Stream<Item = Incoming> + Unpin> Inbox<S> {
    /// The messages of this stream.
    pub fn new(stream: S) -> Self {
        Self { stream, waiting: VecDeque::new() }
    }

    /// Waits for work that the client waits for. `None` if the client leaves before, which drops the work.
    pub async fn attend<T>(&mut self, work: impl Future<Output = T>) -> Option<T> {
        let mut work = pin!(work);
        // A client that sends more than this is not read until the work is done.
        while self.waiting.len() < limits::LIVE_QUEUE {
            match select(work.as_mut(), self.stream.next()).await {
                Either::Left((done, _)) => return Some(done),
                Either::Right((None | Some(Ok(Message::Close(_))), _)) => return None,
                Either::Right((Some(Err(unreadable)), _)) => {
                    self.waiting = VecDeque::from([Err(unreadable)]);
                    return None;
                }
                Either::Right((Some(message), _)) => self.waiting.push_back(message),
            }
        }
        Some(work.await)
    }

    /// The close for a client that has left during work.
    pub(super) fn close(&self) -> crate::live::close::Close {
        self.waiting.front().and_then(|last| last.as_ref().err()).and_then(|unreadable| unreadable.close())
    }
}

impl<S: Stream<Item = Incoming> + Unpin> Stream for Inbox<S> {
    type Item = Incoming;

    fn poll_next(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Incoming>> {
        match self.waiting.pop_front() {
            Some(message) => Poll::Ready(Some(message)),
            None => self.stream.poll_next_unpin(context),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures_util::{FutureExt, stream};
    use std::future::{pending, ready};
    use std::sync::Arc;

    #[tokio::test]
    async fn work_ends_with_its_client_and_messages_wait_for_it() {
        let [one, two] = ["1", "2"].map(|text| Ok(Message::text(text)));
        let messages = stream::iter([one.clone(), two.clone()]).chain(stream::once(ready(Ok(Message::Close(None)))));
        let mut inbox = Inbox::new(messages);
        let held = Arc::new(());
        let work = {
            let held = held.clone();
            async move {
                pending::<()>().await;
                drop(held);
            }
        };
        assert_eq!(inbox.attend(work).await, None);
        assert_eq!(Arc::strong_count(&held), 1, "the work goes on");
        let mut inbox = Inbox::new(stream::iter([one.clone(), two.clone()]).chain(stream::pending()));
        let mut polls = 0;
        let work = std::future::poll_fn(|context| {
            polls += 1;
            context.waker().wake_by_ref();
            if polls > 4 { Poll::Ready(5) } else { Poll::Pending }
        });
        assert_eq!(inbox.attend(work).await, Some(5));
        assert_eq!((inbox.next().await, inbox.next().await), (Some(one), Some(two)));
        assert!(inbox.next().now_or_never().is_none());
    }
}
