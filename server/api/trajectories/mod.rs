//! `trajectories`: the contacts of a run.

pub mod answer;
pub mod columns;

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;
use equipoise_physics::run::orbit::Contact;

use crate::api::app::App;
use crate::api::shared::write;
use crate::api::trajectories::answer::{Request, Trajectory};
use crate::compute::{Cancelled, Price, Turn};
use crate::http::{Ask, Format, Problem, Resource};
use crate::runs::playback::Course;
use crate::runs::run_url;

const RESOURCE: Resource =
    Resource { name: "trajectories", formats: &[Format::Json, Format::Csv, Format::Ndjson, Format::Svg, Format::Png] };

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/trajectories", get(trajectories).post(trajectories))
}

pub(crate) async fn trajectories(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let (run, request) = ask.read(|reader| {
        let run = run_url::read_unclocked(reader);
        let request = Request::read(reader);
        Some((run?, request))
    })?;
    app.config.limits.of_answer().admit(request.numbers())?;
    let price = Price::bounces(request.price(run.scene())).within(&app.config.limits.of_work())?;
    let canonical = write::canonical(run.scene(), &(request, run_url::url(&run)));
    let metrics = app.metrics.clone();
    ask.respond(&app.pool, &RESOURCE, &canonical, price, move |format: Format, turn: &Turn| {
        let mut course = Course::up_to(&run, request.impacts);
        let mut contacts = std::iter::from_fn(|| course.next_n().map(|_| course.advance(&run).0));
        // What nobody changes, and what never meets the table, is the scene's own run.
        let changed = (!run.interventions().is_empty() && run.scene().orbit().is_ok())
            .then_some(&mut contacts as &mut dyn Iterator<Item = Contact>);
        let trajectory = match Trajectory::compute(run.scene(), &request, changed, || turn.go_on()) {
            Ok(trajectory) => trajectory,
            Err(Some((pointer, detail))) => return Err(Problem::invalid_at(pointer, detail)),
            Err(None) => return Err(Cancelled.into()),
        };
        metrics.bounces.inc_by(trajectory.outcome.impacts);
        match format {
            Format::Csv => write::csv(&trajectory.impacts, turn),
            Format::Ndjson => write::ndjson(&trajectory.impacts, &trajectory.end(), turn),
            Format::Svg | Format::Png => write::picture(trajectory.to_picture(), format, turn),
            _ => write::json(&trajectory, turn),
        }
    })
    .await
}
