//! The question whether to go on with many runs, asked now and then.

/// Contacts between two questions of whether to go on: far less than a millisecond for any body, its derivatives included.
pub const CHECK_INTERVAL: u64 = 128;

/// Price of beginning a run, in contacts.
const BEGINNING: u64 = 8;

/// Asks whether to go on, every [`CHECK_INTERVAL`] contacts of many runs, each of which may be shorter.
pub(crate) struct CancellationCheck<'a> {
    contacts: u64,
    go_on: &'a mut dyn FnMut() -> bool,
}

impl<'a> CancellationCheck<'a> {
    /// Nothing done yet.
    pub(crate) fn new(go_on: &'a mut dyn FnMut() -> bool) -> Self {
        Self { contacts: 0, go_on }
    }

    /// Tells whether to begin a run.
    pub(crate) fn begin(&mut self) -> bool {
        self.pass(BEGINNING)
    }

    /// Tells whether to go on after a contact.
    pub(crate) fn contact(&mut self) -> bool {
        self.pass(1)
    }

    fn pass(&mut self, contacts: u64) -> bool {
        let before = self.contacts / CHECK_INTERVAL;
        self.contacts += contacts;
        self.contacts / CHECK_INTERVAL == before || (self.go_on)()
    }
}
