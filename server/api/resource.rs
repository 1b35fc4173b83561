//! One route for all resources that compute an answer: read the request, price it, compute the answer and write it.

use std::sync::Arc;

use axum::Router;
use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::Response;
use axum::routing::{get, post};
use futures_util::FutureExt;
use futures_util::future::BoxFuture;
use prometheus_client::metrics::counter::Counter;

use crate::api::app::App;
use crate::api::contract::{Contract, Description, Identity};
use crate::api::formats::FormatSet;
use crate::compute::{OverBudget, Price, TimeSlice, TimeSlices};
use crate::http::request::fields::Fields;
use crate::http::request::tree::TableBody;
use crate::http::{ApiRequest, BodyWriter, Format, Problem, Reader, Resource};
use crate::limits::{Limit, Limits};

/// A valid request, with all defaults filled in.
pub trait ResourceRequest: Fields + Clone + Send + Sync + 'static {
    /// Reads a request. On `None`, the reader has the errors.
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        Self::read_fields(reader)
    }

    /// Highest price of the work, in bounces of the plain rod.
    fn work(&self) -> u64;

    /// Most numbers in the answer, if they may be many.
    fn answer_numbers(&self) -> u64 {
        0
    }

    /// Most memory besides that of any work, bytes.
    fn bytes(&self) -> u64 {
        0
    }

    /// Limit of the work.
    fn limit(limits: &Limits) -> Limit {
        limits.of_work()
    }

    /// Prices the work.
    ///
    /// # Errors
    /// The limit that the work or its answer exceeds.
    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        limits.of_answer().admit(self.answer_numbers())?;
        Price::bounces(self.work()).taking(self.bytes()).within(&Self::limit(limits))
    }
}

/// A resource that computes an answer to a request of this type.
pub trait ComputedResource: ResourceRequest {
    /// Name in the paths `/v1/<name>` and `/v1/batches/<name>`.
    const NAME: &'static str;

    /// Name of one answer, in names of operations and schemas of the contract.
    const SINGULAR: &'static str = "";

    /// True if a request is too large for a query, so that there is no GET.
    const POST_ONLY: bool = false;

    /// The table that a body may be in place of JSON.
    const TABLE: Option<&'static TableBody> = None;

    /// Formats of the answer.
    type Format: FormatSet;

    /// The work, from a request to the bytes of its answer.
    const WORK: Work<Self, Self::Format>;

    /// Describes answer and tables in the contract.
    fn describe(_: &mut Description<'_>) {}
}

/// Canonical form of a request: together with build, format and encoding it determines every byte of the answer.
type Canonical<R> = fn(&R) -> Vec<u8>;

/// Computes an answer, counts the bounces that it took, and returns it in a format.
type ComputeWhole<R, F> = fn(&R, F, &TimeSlice, &Counter) -> Result<Vec<u8>, Problem>;

/// Computes an answer, counts the bounces that it took, and sends it in a format piece by piece.
type ComputeStreaming<R, F, Slices> = fn(&R, F, &Slices, &mut BodyWriter, &Counter) -> Result<(), Problem>;

/// The work of a resource, from a request to the bytes of its answer. Formats in `streamed` are sent while they are computed.
#[derive(Debug)]
pub enum Work<R, F> {
    /// A pure function of the request, short enough for one time slice.
    Pure {
        /// See [`Canonical`].
        canonical: Canonical<R>,
        /// See [`ComputeWhole`].
        compute: ComputeWhole<R, F>,
    },
    /// A pure function of the request, done in many time slices.
    InSlices {
        /// See [`Canonical`].
        canonical: Canonical<R>,
        /// See [`Work`].
        streamed: &'static [Format],
        /// See [`ComputeStreaming`].
        compute: ComputeStreaming<R, F, TimeSlices>,
    },
    /// A measurement, which differs each time and so is never cached.
    Measured {
        /// See [`Work`].
        streamed: &'static [Format],
        /// See [`ComputeStreaming`].
        compute: ComputeStreaming<R, F, TimeSlice>,
    },
}

/// A resource in the list of routes.
#[derive(Debug, Clone, Copy)]
pub struct Endpoint {
    /// See [`ComputedResource::NAME`].
    pub name: &'static str,
    /// See [`ComputedResource::POST_ONLY`].
    pub post_only: bool,
    /// Answers one request.
    pub answer: Answer,
    identity: Identity,
    table: Option<&'static TableBody>,
    describe: fn(&mut Description<'_>),
}

/// Answers one request.
pub type Answer = fn(App, ApiRequest) -> BoxFuture<'static, Result<Response<Body>, Problem>>;

impl Endpoint {
    /// The endpoint of a resource.
    pub const fn of<R: ComputedResource>() -> Self {
        Self {
            name: R::NAME,
            post_only: R::POST_ONLY,
            answer: |app, api_request| answer::<R>(app, api_request).boxed(),
            identity: Identity {
                name: R::NAME,
                singular: R::SINGULAR,
                post_only: R::POST_ONLY,
                is_measured: matches!(R::WORK, Work::Measured { .. }),
                formats: R::Format::FORMATS,
            },
            table: R::TABLE,
            describe: |description| {
                description.request::<R>();
                R::describe(description);
            },
        }
    }

    /// Formats of the answer.
    pub fn formats(self) -> &'static [Format] {
        self.identity.formats
    }

    /// Adds the resource to the contract.
    pub fn describe(self, contract: &mut Contract) {
        let mut description = contract.resource(self.identity);
        (self.describe)(&mut description);
        description.finish();
    }

    /// The route `/v1/<name>`.
    pub fn routes(self) -> Router<App> {
        let handler = async move |State(app): State<App>, request: Request| {
            let api_request = ApiRequest::of(request, &app.config.limits, self.table).await?;
            (self.answer)(app, api_request).await
        };
        let methods = if self.post_only { post(handler) } else { get(handler).post(handler) };
        Router::new().route(&format!("/v1/{}", self.name), methods)
    }
}

async fn answer<R: ComputedResource>(app: App, api_request: ApiRequest) -> Result<Response<Body>, Problem> {
    let request = api_request.read(R::read)?;
    respond(app, api_request, request, R::WORK).await
}

/// Answers a request that has been read, by this work.
///
/// # Errors
/// Work over the budget, a format that the client does not accept, and errors of the work.
pub async fn respond<R: ComputedResource, F: FormatSet>(
    app: App,
    api_request: ApiRequest,
    request: R,
    work: Work<R, F>,
) -> Result<Response<Body>, Problem> {
    // Shared, because a request with a scene is large, and futures are copied with all that they hold.
    let request = Arc::new(request);
    let limits = &app.config.limits;
    let price = request.price(limits)?;
    limits.of_compute_bytes().admit(price.as_bytes())?;
    let resource = Resource { name: R::NAME, formats: F::FORMATS };
    let bounces = app.metrics.bounces.clone();
    match work {
        Work::Pure { canonical, compute } => {
            let canonical = canonical(&request);
            let compute = move |format, slice: &TimeSlice| compute(&request, negotiated(format), slice, &bounces);
            api_request.respond(&app.answers, &resource, &canonical, price, compute).await
        }
        Work::InSlices { canonical, streamed, compute } => {
            let canonical = canonical(&request);
            let compute = move |format, slices: &TimeSlices, out: &mut BodyWriter| {
                compute(&request, negotiated(format), slices, out, &bounces)
            };
            api_request.respond_in_slices(&app.answers, &resource, &canonical, price, streamed, compute).await
        }
        Work::Measured { streamed, compute } => {
            let compute = move |format, slice: &TimeSlice, out: &mut BodyWriter| {
                compute(&request, negotiated(format), slice, out, &bounces)
            };
            api_request.respond_uncached(&app.pool, &resource, price, streamed, compute).await
        }
    }
}

/// The negotiated format as a member of its set.
pub(crate) fn negotiated<F: FormatSet>(format: Format) -> F {
    F::of(format).expect("negotiation chooses among the formats of the set")
}
