//! A request's body that says when it waits for its client.

use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};

use axum::body::{Bytes, HttpBody};
use http_body::{Frame, SizeHint};
use hyper::body::Incoming;

use crate::transport::connection_slots::Place;

/// A body that arrives over a connection with this place.
pub(crate) struct Awaited {
    body: Incoming,
    place: Arc<Place>,
}

impl Awaited {
    pub(crate) fn new(body: Incoming, place: Arc<Place>) -> Self {
        Self { body, place }
    }
}

impl HttpBody for Awaited {
    type Data = Bytes;
    type Error = hyper::Error;

    fn poll_frame(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<hyper::Result<Frame<Bytes>>>> {
        let polled = Pin::new(&mut self.body).poll_frame(context);
        self.place.answers(polled.is_ready());
        polled
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
