//! `/v1/previews`: a run in a headline and a picture, as programs show them beside a link to the page.

use equipoise_physics::map::strike::State;
use equipoise_physics::numbers::trig::sin_cos;
use equipoise_physics::run::cancellation::CHECK_INTERVAL;
use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::scene::{Name, Scene};

use crate::api::prelude::*;
use crate::api::shared::outcome::{Outcome, RunEnding};
use crate::charts::{Card, CardPlane, FirstContact, PlacedBody, card};
use crate::runs::interventions::RunSpec;
use crate::runs::playback::Playback;
use crate::runs::run::Run;

impl ComputedResource for PreviewRequest {
    const NAME: &'static str = "previews";
    const SINGULAR: &'static str = "Preview";
    type Format = FigureFormat;
    const WORK: Work<Self, FigureFormat> = Work::Pure {
        canonical: canonical_of,
        compute: |request, format, slice, bounces| {
            let answer = PreviewAnswer::compute(request, &mut || slice.should_continue())?;
            bounces.inc_by(answer.outcome.bounces);
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract.answer::<PreviewAnswer>();
    }
}

/// Price of an impact besides its bounce, in bounces: its dot.
const DOT_PRICE: u64 = 4;

request_fields! {
    /// A request for a preview.
    #[derive(Debug, Clone, Serialize)]
    pub struct PreviewRequest {
        /// The run.
        pub run: Run = RunSpec,
        /// Largest number of impacts to follow.
        pub bounces: u64 = whole(1..=limits::PREVIEW_BOUNCES).or(1000),
    }
}

impl ResourceRequest for PreviewRequest {
    fn work(&self) -> u64 {
        self.bounces().saturating_add(limits::PREVIEW_ANSWER_PRICE + DOT_PRICE * self.bounces)
    }
}

impl PreviewRequest {
    /// Price of the run alone, with its catches and throws, in bounces.
    pub fn bounces(&self) -> u64 {
        (self.bounces * bounce_price(self.run.scene())).saturating_add(self.run.guidance_price())
    }
}

/// Number of flights in the picture.
const FLIGHTS: usize = 5;

/// Points on the path of each flight.
const POINTS: usize = 16;

/// Answer of `/v1/previews`.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Preview")]
pub struct PreviewAnswer {
    scene: Resolved,
    /// The outcome in plain words.
    pub title: String,
    /// Body, table and release in a sentence.
    pub text: String,
    outcome: Outcome,
    #[serde(skip)]
    drawing: Drawing,
}

/// The parts of a run that its picture shows.
#[derive(Debug, Default)]
struct Drawing {
    /// The centre of gravity on the first flights, m.
    path: Vec<(f64, f64)>,
    /// The body at the release.
    release: PlacedBody,
    /// The first contact, if there is one.
    contact: Option<FirstContact>,
    /// The states just before the contacts: (θ, θ̇), or (ẋ, ẏ) of a point mass.
    states: Vec<(f64, f64)>,
}

impl PreviewAnswer {
    /// Computes the run.
    ///
    /// # Errors
    /// `go_on` said `false`.
    pub fn compute(request: &PreviewRequest, go_on: &mut dyn FnMut() -> bool) -> Result<Self, Cancelled> {
        let PreviewRequest { run, bounces } = request;
        let scene = run.scene();
        let mut playback = Playback::new(run, *bounces);
        let mut drawing = Drawing::new(scene);
        while let Some((contact, _)) = playback.next_impact(run, go_on)? {
            if contact.n.is_multiple_of(CHECK_INTERVAL) && !go_on() {
                return Err(Cancelled);
            }
            drawing.add(&contact, playback.body().contact_height(&contact.state), scene);
        }
        let outcome = playback.outcome().cloned().ok_or(Cancelled)?;
        let title = outcome.headline();
        Ok(Self { scene: Resolved(**scene), title, text: text(run), outcome, drawing })
    }
}

impl Drawing {
    fn new(scene: &Scene) -> Self {
        let release = scene.release();
        let release = place(scene, (release.x, release.height), sin_cos(release.state.theta));
        Self { release, ..Self::default() }
    }

    /// Adds a contact, at which the centre of gravity is at this height above the contact point, m.
    fn add(&mut self, contact: &Contact, height: f64, scene: &Scene) {
        let state = &contact.state;
        self.states.push(if has_angle(scene) { (state.theta, state.theta_dot) } else { (state.x_dot, state.y_dot) });
        let y = height + contact.clearance;
        if self.contact.is_none() {
            let turn = sin_cos(if has_angle(scene) { state.theta } else { 0.0 });
            let length = if has_angle(scene) { scene.model().rod.contact_distance } else { 0.0 };
            let (sin_alpha, cos_alpha) = sin_cos(contact.alpha);
            self.contact = Some(FirstContact {
                body: place(scene, (contact.x, y), turn),
                foot: (contact.x + length * turn.0, contact.clearance),
                table: (cos_alpha, sin_alpha),
            });
            let start = scene.release();
            self.fly((start.x, start.height), start.state, contact.t, scene);
        }
        if let (Some(strike), Some(time)) = (contact.strike, contact.flight_time)
            && self.path.len() < (FLIGHTS + 1) * POINTS
        {
            self.fly((contact.x, y), strike.after, time, scene);
        }
    }

    fn fly(&mut self, (x, y): (f64, f64), start: State, time: f64, scene: &Scene) {
        let flight = scene.running_model().flight(start, 0.0);
        self.path.extend((0..POINTS).map(|n| {
            let (way, rise) = flight.travel(time * n as f64 / (POINTS - 1) as f64);
            (x + way, y + rise)
        }));
    }
}

/// The body with its centre of gravity at a place, turned by an angle of this sine and cosine.
fn place(scene: &Scene, centre: (f64, f64), (sin, cos): (f64, f64)) -> PlacedBody {
    let turned = |x: f64, y: f64| (centre.0 + x * cos - y * sin, centre.1 + x * sin + y * cos);
    let rod = scene.number(Name::ContactDistance).zip(scene.number(Name::RadiusOfGyration));
    let outline = match (scene.outline(), rod) {
        (Some(outline), _) => outline.vertices().iter().map(|[x, y]| turned(*x, *y)).collect(),
        (None, Some((length, rho))) => vec![turned(0.0, -length), turned(0.0, length.max(rho))],
        (None, None) => vec![centre],
    };
    PlacedBody { centre, outline }
}

/// Describes body, table and release.
fn text(run: &Run) -> String {
    let scene = run.scene();
    let three = |value: f64| significant(value, 3);
    let body = match (has_angle(scene), scene.outline()) {
        (false, _) => "A point mass",
        (true, None) => "A rod",
        (true, Some(_)) => "A polygon",
    };
    let table = match scene.number(Name::TiltGain) {
        Some(gain) => format!("κ = {}", significant(gain, 4)),
        None => "state feedback".to_owned(),
    };
    let release = scene.release();
    let mut text = format!("{body} on a table with {table}, released from {} m", three(release.height));
    if has_angle(scene) && release.state.theta != 0.0 {
        text.push_str(&format!(" at {}°", three(release.state.theta.to_degrees())));
    }
    match run.interventions().len() {
        0 => {}
        1 => text.push_str(", with one change or kick on the way"),
        count => text.push_str(&format!(", with {count} changes and kicks on the way")),
    }
    text.push('.');
    text
}

impl Pictured for PreviewAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let drawing = &self.drawing;
        Ok(card(&Card {
            title: &self.title,
            text: &self.text,
            goes_on: self.outcome.ending == RunEnding::Bouncing(EndingKind::Completed),
            path: &drawing.path,
            release: &drawing.release,
            contact: drawing.contact.as_ref(),
            plane: CardPlane {
                symbols: if has_angle(&self.scene.0) { ("θ", "θ̇") } else { ("ẋ", "ẏ") },
                states: &drawing.states,
            },
        }))
    }
}
