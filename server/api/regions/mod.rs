//! `regions`: maps of stability over two fields of a scene.

pub mod answer;
pub mod rows;

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use crate::api::app::App;
use crate::api::regions::answer::{Answer, Request};
use crate::api::regions::rows::Rows;
use crate::api::scene::Resolved;
use crate::api::shared::write;
use crate::compute::{Cancelled, Turn, Turns};
use crate::http::{Ask, Format, Outlet, Problem, Resource};

const RESOURCE: Resource =
    Resource { name: "regions", formats: &[Format::Json, Format::Csv, Format::Ndjson, Format::Svg, Format::Png] };

/// Those that are sent row by row as they are computed.
const STREAMED: [Format; 2] = [Format::Csv, Format::Ndjson];

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/regions", get(regions).post(regions))
}

pub(crate) async fn regions(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let request = ask.read(Request::read)?;
    app.config.limits.of_answer().admit(request.cells().saturating_mul(2))?;
    app.config.limits.of_region_work().admit(request.price())?;
    let region = request.region;
    let sides = [region.x, region.y].map(|axis| (axis.name.row().path, axis.from, axis.to, axis.count));
    let rest = (sides, region.impacts, region.quantity as u8, request.tile);
    let canonical = write::canonical_of(&(Resolved(&request.scene), rest));
    let metrics = app.metrics.clone();
    ask.respond_in_turns(&app.pool, &RESOURCE, &canonical, &STREAMED, move |format, turns: &Turns, out: &mut Outlet| {
        let (cells, block) = (request.numbers(), request.block_cells());
        let blocks = cells.len().div_ceil(block);
        let compute = |number: usize, turn: &Turn| {
            let first = cells.start + number * block;
            let computed = region.cells(first..(first + block).min(cells.end), &mut || turn.go_on())?;
            metrics.bounces.inc_by(request.bounces_of(&computed));
            Some(computed)
        };
        if STREAMED.contains(&format) {
            let mut rows = Rows::new(request, format);
            out.send(rows.begin());
            turns.spread(blocks, compute, |cells| out.send(rows.add(&cells)))?;
            out.send(rows.end());
            return Ok(());
        }
        let mut all = Vec::with_capacity(cells.len());
        turns.spread(blocks, compute, |cells| all.extend(cells))?;
        turns.take(|turn| {
            let answer = Answer::new(request, all, || turn.go_on()).ok_or(Cancelled)?;
            let bytes = match format {
                Format::Svg | Format::Png => write::picture(answer.to_picture(), format, turn)?,
                _ => write::json(&answer, turn)?,
            };
            Ok(out.send_whole(bytes, turn)?)
        })?
    })
    .await
}
