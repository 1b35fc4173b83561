//! `regions`: maps of stability over two fields of a scene.

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use super::App;
use crate::compute::{Cancel, Cancelled, Price, fan_out};
use crate::http::{Ask, Format, Problem, Resource};
use crate::limits;
use crate::wire::region::{Answer, Request};
use crate::wire::scene::Resolved;

const RESOURCE: Resource =
    Resource { name: "regions", formats: &[Format::Json, Format::Csv, Format::Ndjson, Format::Svg, Format::Png] };

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/regions", get(regions).post(regions))
}

async fn regions(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let request = ask.read(Request::read)?;
    limits::ANSWER.admit(request.cells().saturating_mul(2))?;
    limits::REGION_WORK.admit(request.bounces())?;
    // A bounce in lanes takes a sixth of a plain one.
    let price = Price::bounces(request.bounces() / 6 + request.cells());
    let region = request.region;
    let sides = [region.x, region.y].map(|axis| (axis.name.row().path, axis.from, axis.to, axis.count));
    let rest = (sides, region.impacts, region.quantity as u8, request.tile);
    let canonical = super::canonical_of(&(Resolved(&request.scene), rest));
    let (metrics, threads) = (app.metrics.clone(), app.pool.permits());
    ask.respond(&app.pool, &RESOURCE, &canonical, price, move |format: Format, cancel: &Cancel| {
        let rows = request.rows();
        let block = (limits::REGION_BLOCK_CELLS / region.x.count).max(1);
        let cells = fan_out(threads, rows.len().div_ceil(block), |number| {
            let first = rows.start + number * block;
            region.cells(first..(first + block).min(rows.end), &mut || !cancel.is_set())
        });
        let answer = Answer::new(request, cells.ok_or(Cancelled)?.concat());
        metrics.bounces.inc_by(answer.bounces());
        match format {
            Format::Csv => Ok(answer.to_csv()),
            Format::Ndjson => Ok(answer.to_ndjson()),
            Format::Svg | Format::Png => super::picture(answer.to_picture(), format, cancel),
            _ => super::json(&answer),
        }
    })
    .await
}
