//! The question whether to go on with long work, asked now and then.

/// Contacts between two questions of whether to go on: far less than a millisecond for any body, its derivatives included.
pub const CHECK_INTERVAL: u64 = 128;

/// Asks whether to go on, every [`CHECK_INTERVAL`] contacts of many runs, each of which may be shorter, or steps of a motion in contact.
pub(crate) struct CancellationCheck<'a> {
    done: u64,
    go_on: &'a mut dyn FnMut() -> bool,
}

impl<'a> CancellationCheck<'a> {
    /// Nothing done yet.
    pub(crate) fn new(go_on: &'a mut dyn FnMut() -> bool) -> Self {
        Self { done: 0, go_on }
    }

    /// Tells whether to go on after so many more contacts or steps.
    pub(crate) fn pass(&mut self, done: u64) -> bool {
        let before = self.done / CHECK_INTERVAL;
        self.done += done;
        self.done / CHECK_INTERVAL == before || (self.go_on)()
    }
}
