//! The run of a plain rod as one of that body alone: its loop then has no other model in it, which would take a third of a bounce.

use crate::bounce::rod::Rod;
use crate::run::orbit::Orbit;
use crate::scene::model::Model;

impl Orbit<Model> {
    /// The same run of the plain rod, if that is its model.
    pub(crate) fn of_plain_rod(&self) -> Option<Orbit<Rod>> {
        match self.body {
            Model::Rod(rod) => Some(self.with_body(rod)),
            Model::Point(_) | Model::General(_) => None,
        }
    }
}
