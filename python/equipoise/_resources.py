"""The resources that compute, written from openapi.yaml by tests/clients/python_types.py."""

from collections import namedtuple

# Path under /v1, member of the answer that is its Arrow table, whether it has a picture, documentation.
Resource = namedtuple("Resource", "path table picture doc")

SCENE = ('body', 'gravity', 'incline', 'air', 'contact', 'table', 'release', 'topple_angle', 'noise')

RESOURCES = {
    "ladder": Resource("ladder", None, False, """Find the simplest model that a scene needs.

Runs the scene on each rung of the ladder of models up to its own: linear, rod, rod with x, constant errors,
delay, friction, noise, polygon. For each rung the answer gives the field that requires it, its difference
from the rung below and its cost; it names the lowest rung that is sufficient.

Fields, besides those of a scene:
    preset
    bounces: Largest number of impacts to follow on each rung.
    tolerance: Largest difference of states for which a rung counts as not needed, m/s.
"""),
    "trajectories": Resource("trajectories", 'impacts', True, """Follow a body from impact to impact.

The states just before each impact, the outcome of the run and, on request, points along the flights.

Fields, besides those of a scene:
    preset
    interventions: Interventions during the run: fields set from the strike of an impact on, kicks just after
        it, and catches and throws. A run that is caught ends with the outcome of its catch. The run then uses
        the map without error estimates: other methods and a `tolerance` are a 422.
    hold: Time for which a run that ended as `settled` is followed in contact, under its own table, s.
    bounces: Largest number of impacts to follow.
    samples_per_flight: Points along each flight. 0 leaves `flights` out.
    method: Method of computation. `linear` is the solution about the fixed point in closed form, of a rod
        whose bounces repeat; its error estimate is the distance from the run of the map beside it, with the
        error estimate of that. `map` goes from impact to impact in doubles. `extended` does so with 31
        digits; its numbers are decimal strings, the errors of a table with noise and endings are those of
        doubles. `auto` is the map. With a `tolerance` it is `extended` if the error estimate of the map
        exceeds it at an impact; if that of `extended` does too, the answer is a 422 that says for how many
        impacts it would hold.
    tolerance: Largest error of a state to accept, m/s. It is compared with `error_estimate`;
        `predictable_bounces` takes 0.001 by default. With noise it is the error against the run with the same
        errors of the table.
    epoch_ms: Wall time of the release since 1970 (UTC), ms. With it `impacts` and `flights`, and the rows of
        CSV and NDJSON, have the column `time_ms`: `epoch_ms` + 1000 t, to the nearest millisecond, as a whole
        number in every format, which dashboards read directly. `t` has all the digits.
"""),
    "jacobians": Resource("jacobians", None, False, """Differentiate the map from one impact to the next.

The derivative of the state before an impact with respect to the state `period` impacts earlier. It
differentiates the map itself, including the contact time. By default it is taken at the fixed point: in
closed form, or else by Newton's iteration on the return map; if no bounce repeats, the answer is a 422 with
the pointer `/at`. With a delay that is longer than a flight, the motion that the table plans before the last
strike belongs to the state; at a given state it is the one that the table plans for that state.

Fields, besides those of a scene:
    preset
    at: State at which to differentiate.
    period: Number of bounces to differentiate over.
"""),
    "periodic_orbits": Resource("periodic-orbits", None, True, """Find periodic orbits, and follow them along a parameter.

Finds a state that recurs after `period` impacts without drift, by Newton's iteration with exact derivatives.
Its energy is the energy of the scene's fixed point: that of the release less the part that the drift keeps, E
− c²/2 with c the `drift_speed` of `stability`. With an `energy_gain` the energy is free, since the table sets
it; the orbit has all of it. With `sweep` the answer is the branch of such orbits along a field of the scene,
followed round its folds, with every change of stability located. The energy E − c²/2 changes along with the
field. The picture is of the branch. With `family` the iteration starts at the exact mirror-symmetric orbit of
period 2 through `theta`. Without a sweep, the orbit keeps its own energy. With a sweep, the start is where in
the range that energy equals E − c²/2 of the scene. With an `energy_gain` that orbit must have the target
height: without a sweep any other `theta` is a 422 that names the right angle. With friction the family is
that of contacts that stick to a `matched` table. Of a body beyond the rod (air, a turning table, a delay,
constant errors, state feedback) that orbit is the guess for the one through `theta`, at the energy that it
has. Such a body may keep neither the energy nor the drift along its orbits; then the orbit has those that its
equations give it. If the upright bounce of the scene does not repeat, `nothing_repeats` says why and what
each bounce changes, and the fields of the orbit are null. A `guess`, a `family` or a `sweep` without an orbit
is a 422. With friction each contact is in the mode that it takes (sticking, sliding, slip reversal), in which
the map is smooth. An orbit with a contact at the switch between two modes is a 422, and a branch ends there
with that reason.

Fields, besides those of a scene:
    preset
    period: Number of impacts after which the orbit recurs. By default 2; without any start, 1, the upright
        bounce.
    guess: A state just before an impact, near that of the orbit. All parts except `y_dot` are 0 by default.
    family: Start at the exact mirror-symmetric orbit of period 2. Needs `theta`.
    theta: Angle of that orbit; not 0. Needs `family`.
    sweep: The field along which to follow the orbit.
"""),
    "precision": Resource("precision", None, True, """Chart speed against accuracy.

Runs the scene by every method over its settings: the map, its variants, the linear solution, and general
simulation methods as they are commonly used. Each point has its clock time, its work counts and its error
against the run with 31 digits. Points that no other point beats in both cost and error form the Pareto front.
Times are measured for each request, so answers differ and are not cached; counts and errors are the same each
time.

Fields, besides those of a scene:
    preset
    bounces: Impacts of every run.
    axis: Measure of cost along the axis of the picture.
    methods: The methods to run; by default all. Answers keep their own order.
"""),
    "previews": Resource("previews", None, True, """Show a run in a headline and a picture.

The outcome of a run in plain words, with a picture of 1200 × 630 pixels: the body on its first flights, and
the state just before each impact. Programs show it beside a link to the page: the page's `og:image` is this
resource as PNG.

Fields, besides those of a scene:
    preset
    interventions: Interventions during the run: fields set from the strike of an impact on, kicks just after
        it, and catches and throws. A run that is caught ends with the outcome of its catch. The run then uses
        the map without error estimates: other methods and a `tolerance` are a 422.
    bounces: Largest number of impacts to follow.
"""),
    "stability": Resource("stability", None, True, """Tell whether the bounce is stable.

Gives the bounce that repeats, the eigenvalues about it, the boundary coefficient where they do not decide, a
nonlinear run, and whether the two agree. Where the angle circles, eigenvalues are not sufficient: the first
Lyapunov coefficient (`lyapunov`) tells whether a swing grows or decays in third order. Every scene gets a
verdict. The first 500 impacts of the run give its rotation number, an indicator of chaos, and the number of
predictable impacts.

Fields, besides those of a scene:
    preset
    bounces: Largest number of impacts of the nonlinear run.
    basin: Computes the basin of release angles too, by 448 more runs in parallel, each at a quarter of the
        price of a run. With a program of heights or `table.limits` each is a whole run, and for a polygon
        two.
    budget: Computes the budget of the errors of the rig too: for each the largest value that keeps the
        verdict, alone and together, by up to some 2,000 more runs of `bounces` contacts.
    release_margins: Adds margins of the gain `of` `release` to `margins`: the values of the tilt gain (with
        state feedback a factor on its gains) nearest to its own at which the run of this release ends
        otherwise, by up to some 120 more runs of `bounces` contacts.
    tolerances: Tolerances of fields, each field once: largest deviations from the scene, either way. At most
        3 besides those of the body and of the restitution.
"""),
    "controllers": Resource("controllers", None, True, """Design a table that balances in place.

Designs state feedback α = −K·(x, θ, ẋ, θ̇) in place of α = κθ. The gain K is optimal for given weights on the
linear model of one bounce (LQR: the discrete algebraic Riccati equation, solved by structured doubling). A
proportional tilt leaves the body circling and drifting; this law brings it to rest in place. It also does so
on a contact that sticks, where no proportional tilt of a table without `slide: matched` is stable. The model
is the derivative of the return map of the rig as it is: its errors, its delay, its pivot and the air are in
it. A constant tilt beside the law moves the place of rest, `fixed_point.x`. Where nothing holds the height
(air, a wrong belief in the restitution), the law is about the upright bounce of the release, and
`y_dot_change` says how fast its height goes. `given` judges the scene's own law.

Fields, besides those of a scene:
    preset
    contact: Behaviour of the contact for which the law is designed. By default that of the scene near its
        fixed point: with any friction it sticks.
    weights
"""),
    "catches": Resource("catches", None, True, """Catch a falling body and hold it.

Brings the body of a scene to rest on the table, from its release on, and holds it there. The table strikes at
each contact with a tilt and a speed of its own choice, in place of the scene's law, and then stays in contact
with the body. Plans go through the map, so they know the air. `table.errors` and `body.offset` are unknown to
the table: it senses, tilts and moves with them. It carries a state that it sensed `table.delay` before on to
the strike, and strikes at a tilt that does not turn. Section 15 of `docs/physics.md` has the strategies and
their formulas, `docs/catching.md` examples.

Fields, besides those of a scene:
    preset
    strategy: Strategy of the catch. `bounce_down`: each strike leaves the contact point `ratio` times as fast
        as it came, and tilts by state feedback that is scheduled on that speed. `plan`: `strikes` strikes of
        `ratio` and a stop, with the least tilts after which the body is at rest; planned again at each
        strike, with the restitution that the strikes so far have shown. `brake`: the table meets the contact
        point at its own speed, without a strike, and brakes. `auto` tries `bounce_down` quickly and slowly,
        plans quickly and slowly, and `brake`, and takes the first that catches the body within
        `table.limits`.
    ratio: Ratio of the vertical speeds of the contact point just after and just before a strike. Only for
        `bounce_down` (at most 0.98, by default 0.5) and `plan` (by default 0.8).
    strikes: Number of strikes of a plan before its stop. Only for `plan`. By default the fewest from 4 to 12
        with all tilts within 0.25 rad and `table.limits`, else those with the least tilt.
    brake: Acceleration of the braking table. Only for `brake`. By default the gravity in the plane.
    weights
    hold_speed: Vertical speed of the contact point after a strike below which the lasting contact begins.
    hold: Time in contact to compute.
    hold_samples: Largest number of rows of `hold`: every so many of 600 steps evenly in time, and the last
        moment.
"""),
    "throws": Resource("throws", None, True, """Throw a body to an apex of given height and angle.

The tilt and the speed of one strike after which the body rises to the height `apex.height` and has the angle
`apex.theta` there. Without friction the answer is in closed form; with friction it is solved for, and
`residual` is what is left. No throw tilts the table beyond 1.4 rad.

Fields, besides those of a scene:
    preset
    apex: The top of the flight after the throw.
    impact: Throws at this impact of the run of the scene, counted from 1. Not with `state`.
    state: State just before the throw, with the contact point on the table. What is left out is 0.
    catch
"""),
    "fits": Resource("fits", 'residuals', True, """Fit fields of a scene to measured impacts.

Estimates fields of a scene from impacts that were measured on a rig: `t` and any of `theta`, `x_dot`,
`y_dot`, `theta_dot` and `x`, just before each. Any field that is a number can be unknown, except those of
noise; errors of the rig that the scene leaves out begin at 0. The motion between impacts is taken as exact,
the measurements as noisy: noise of the scene is left out. The clock of the data need not start at the
release. An estimate has its standard deviation and its 95 % interval. If the data do not determine a field
(`identifiable` is false), it has neither; `detail` gives the reason, and the fitted scene keeps its first
value. Single outliers are left out, missed and doubled impacts are numbered anew, and `notes` names them.
Data that cannot be in the units of the contract are refused: angles beyond π, flights that would rise above
100 m, and velocities that are not the change of their place over the time of flight. `quality` says if the
model explains the data. If it is not `good`, do not trust the intervals. `stability` has the verdict on the
fitted scene and its margins over the confidence region. There is no GET: data are too long for an address. As
`text/csv` or `application/vnd.apache.arrow.stream` the body is `measured` alone, and all other fields stand
in the query, as in `preset=case-1&unknown.0=table.tilt_gain&sd.t=0.001`. Estimates of a curved model are
biased in second order of their standard deviations. From 20 impacts with `tilt_gain` and `radius_of_gyration`
unknown, noise of 1 ms and 2 mrad, and θ and t measured, the radius is on average 0.3 standard deviations too
large; from 60 impacts 0.2.

Fields, besides those of a scene:
    preset
    measured: Measured impacts in columns of one length, null where a value is missing. States are those just
        before an impact. `t` is needed, on any clock, and rises from row to row. Without `n` the rows are the
        impacts from 1 on; missed and doubled ones are found.
    unknown: Paths of the unknown fields, such as `table.tilt_gain`. `/v1/fields` lists all fields; those of
        kind `number` can be unknown.
    sd: Standard deviations of the measurements by column. Those that are missing are estimated from the
        residuals. Only if all are given can χ² say that the model is wrong.
"""),
    "regions": Resource("regions", None, True, """Map survival over two fields.

Runs a scene for every pair of values of two of its fields. Each cell shows how long the run survives, or a
result of the linear analysis. The ends of the linear verdict are lines over the cells. Tiles are bands of
whole rows; the values and rows of all tiles together are those of the whole map. Limits of work and of the
answer hold for each tile, so that a map of any size can be requested in tiles. The quantities `caught` and
`rest_time` catch the body of each cell, with the settings of `catch`; they need no law of the table and have
no `limit_curves`. Of a tile with more than 512 × 512 cells, each drawn cell is a mean; the caption says so,
and how many drawn cells hide different outcomes. NDJSON and CSV are streamed: each row is sent as soon as it
and all rows before it are complete. Reading slowly does not delay the work. Long maps take turns with other
requests. To be able to resume a map, request it in tiles.

Fields, besides those of a scene:
    preset
    x: The field that varies along a row, and its values.
    y: The field that varies from row to row, and its values.
    bounces: Largest number of contacts of each run.
    quantity: Quantity that a cell shows: contacts survived; the largest |θ| at a contact, rad; Greene's
        residue; the spectral radius; of catches, 1 if the body is caught and 0 if it is not; or the time from
        which it rests, s.
    catch
    tile
"""),
    "ensembles": Resource("ensembles", None, True, """Run a scene many times, each time with different noise.

Runs a scene with noise `runs` times. For each contact the answer gives the share of runs that continue, its
95 % interval (Wilson), the number of runs that reached the contact (`at_risk`), and quantiles of |θ|. It also
counts how the other runs ended. The noise of run k depends on the seed and k alone: a larger ensemble
contains the smaller one, and the scene in the answer, sent to `/v1/trajectories` or `/v1/live`, is run 0.
Every run is followed for the same number of contacts, so the Kaplan-Meier curve is the share of runs that
continue. Without noise all runs are alike; `notes` says so. The counts of all tiles add up to those of the
whole ensemble. Quantiles do not; `angles` has the values from which to compute them. The runs of a tile may
cost 400 million bounces of the plain rod; a bounce with noise counts as three, one with friction or of a
polygon as two.

Fields, besides those of a scene:
    preset
    runs: Number of runs, those of other tiles included. More than 20 000 have to be requested in tiles.
    bounces: Largest number of contacts of each run.
    seed: Seed of the noise, in place of the scene's own `noise.seed`.
    angles: Adds the angles themselves to JSON and Arrow.
    tile
"""),
}
