//! The request for `throws`: a scene, the state before the throw, the apex, and the catch after it.

use equipoise_physics::catching::throw::ThrowTarget;
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::capability::Analysis;
use serde::Serialize;

use crate::api::catches::request::{CatchOptions, read_guided_scene};
use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::bounce_price;
use crate::api::shared::state::read_any_state;
use crate::api::shared::write;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::limits;
use crate::limits::Limits;
use crate::runs::prices::THROW_PRICE;

/// Heights of the apex, m.
const HEIGHTS: std::ops::RangeInclusive<f64> = 0.0..=100.0;

/// Angles at the apex, rad: about sixteen turns either way.
const ANGLES: std::ops::RangeInclusive<f64> = -100.0..=100.0;

/// Places of the centre of gravity before the throw, m.
const PLACES: std::ops::RangeInclusive<f64> = -1000.0..=1000.0;

/// The state before the throw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// A place, m, and a state on the table.
    State(f64, State),
    /// A contact of the scene's run.
    Impact(u64),
}

/// A request for a throw.
#[derive(Debug, Clone, Copy)]
pub struct ThrowRequest {
    /// The scene.
    pub scene: Scene,
    /// The state before the throw.
    pub start: Start,
    /// Height of the centre of gravity at the apex, m.
    pub height: f64,
    /// Angle at the apex, rad.
    pub theta: f64,
    /// Settings of the catch after the throw, if there is one.
    pub catch: Option<CatchOptions>,
}

impl Start {
    fn read(reader: &mut Reader<'_, '_>) -> Self {
        let place =
            reader.within("state", |state| (state.number("x", PLACES, "m").unwrap_or(0.0), read_any_state(state)));
        let impact = reader.integer("impact", 1..=limits::IMPACTS);
        if place.is_some() && reader.has("impact") {
            reader.refuse("impact", "impact and state both say what is thrown; leave one of them out");
        }
        match (impact, place) {
            (Some(impact), _) => Self::Impact(impact),
            (None, Some((x, state))) => Self::State(x, state),
            (None, None) => Self::State(0.0, State { theta: 0.0, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 }),
        }
    }

    fn canonical(&self) -> impl Serialize {
        match self {
            Self::State(x, State { theta, x_dot, y_dot, theta_dot }) => {
                (Some((*x, *theta, *x_dot, *y_dot, *theta_dot)), None)
            }
            Self::Impact(impact) => (None, Some(*impact)),
        }
    }
}

/// Reads the apex of a throw.
pub fn read_apex(apex: &mut Reader<'_, '_>) -> Option<ThrowTarget> {
    apex.require(&["height"]);
    let theta = apex.number("theta", ANGLES, "rad").unwrap_or(0.0);
    Some(ThrowTarget { height: apex.number("height", HEIGHTS, "m")?, theta })
}

impl ResourceRequest for ThrowRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let scene = read_guided_scene(reader, Analysis::Throw);
        reader.require(&["apex"]);
        let apex = reader.within("apex", read_apex);
        let start = Start::read(reader);
        let catch = reader.within("catch", CatchOptions::read);
        let ThrowTarget { height, theta } = apex??;
        Some(Self { scene: scene?, start, height, theta, catch })
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        let before = match self.start {
            Start::State(..) => 0,
            Start::Impact(impact) => impact * bounce_price(&self.scene),
        };
        let catch = self.catch.map_or(0, |catch| catch.price(&self.scene));
        Price::bounces(limits::ANSWER_PRICE + THROW_PRICE + before + catch).within(&limits.of_work())
    }
}

impl CanonicalRequest for ThrowRequest {
    fn canonical(&self) -> Vec<u8> {
        let Self { scene, start, height, theta, catch } = self;
        let catch = catch.as_ref().map(CatchOptions::canonical);
        write::canonical(scene, &(start.canonical(), height, theta, catch))
    }
}
