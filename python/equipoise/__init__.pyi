"""Types, written from openapi.yaml by tests/clients/python_types.py."""

from collections.abc import Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, NamedTuple, TypedDict

class FieldError(NamedTuple):
    field: str
    detail: str

class Problem(Exception):
    status: int
    title: str
    detail: str
    errors: list[FieldError]

class Record(dict[str, Any]):
    def __getattr__(self, name: str) -> Any: ...
    @property
    def json(self) -> dict[str, Any]: ...

class Columns(Record):
    def to_arrow(self) -> Any: ...
    def to_pandas(self) -> Any: ...
    def to_polars(self) -> Any: ...

class Answer(Columns):
    def read(self, form: str) -> bytes: ...
    def save(self, path: str | PathLike[str]) -> None: ...

Preset = Literal["case-1", "case-2", "case-2-figure", "case-3", "case-4", "case-5", "critical-soft", "critical-hard", "true-triangle", "triangle-polygon", "point-mass", "still-lossy", "case-1-noise", "case-4-noise", "case-4-total", "air-table", "juggling", "rough-matched", "rough-feedback", "rough-noise", "rough-catch", "rough-juggling"]

class Body(TypedDict, total=False):
    contact_distance: float | None
    radius_of_gyration: float | None
    point: bool | None
    offset: float | None
    vertices: Sequence[Any] | None
    contact_vertex: int | None

class Air(TypedDict, total=False):
    drag: float | None
    rotation_drag: float | None
    wind: float | None

class Contact(TypedDict, total=False):
    restitution: float | None
    friction: float | None
    law: Literal["poisson", "newton", "stronge"] | None

class Table(TypedDict, total=False):
    tilt_gain: float | None
    energy_gain: float | None
    target_height: float | None
    energy_measure: Literal["vertical", "total"] | None
    energy_law: Literal["proportional", "one_strike"] | None
    program: Sequence[Any] | None
    strike: Literal["compensated", "still"] | None
    slide: Literal["none", "matched"] | None
    feedback: Mapping[str, Any] | None
    assumed_restitution: float | None
    errors: Mapping[str, Any] | None
    tilt_rate: Literal["none", "follows", "corrected"] | None
    pivot: Mapping[str, Any] | None
    delay: float | None
    prediction: Literal["none", "flight"] | None
    length: float | None
    limits: Mapping[str, Any] | None

class Release(TypedDict, total=False):
    height: float | None
    theta: float | None
    theta_dot: float | None
    x: float | None
    x_dot: float | None
    y_dot: float | None

class Noise(TypedDict, total=False):
    timing_sd: float | None
    angle_sd: float | None
    x_sd: float | None
    x_dot_sd: float | None
    y_dot_sd: float | None
    theta_dot_sd: float | None
    restitution_sd: float | None
    model: Literal["strike", "plan"] | None
    seed: int | None
    run: int | None

class Scene(TypedDict, total=False):
    body: Body | None
    gravity: float | None
    incline: float | None
    air: Air | None
    contact: Contact | None
    table: Table | None
    release: Release | None
    topple_angle: float | None
    noise: Noise | None

class Server:
    url: str
    @property
    def ended(self) -> bool: ...
    def __init__(self, url: str | None = None, token: str | None = None, *, program: str | None = None, arguments: Sequence[str] = ()) -> None: ...
    def __enter__(self) -> Server: ...
    def __exit__(self, *_: object) -> None: ...
    def close(self) -> None: ...
    def get(self, path: str) -> Record: ...
    def ask(self, resource: str, **request: Any) -> Answer: ...
    def read(self, path: str, body: bytes | None = None) -> bytes: ...
    def live(self, **request: Any) -> Iterator[Record]: ...
    def ladder(self, *, preset: Preset | None = ..., scene: Scene | None = ..., bounces: int | None = ..., tolerance: float | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Find the simplest model that a scene needs."""
    def trajectories(self, *, preset: Preset | None = ..., scene: Scene | None = ..., interventions: Sequence[Any] | None = ..., hold: float | None = ..., bounces: int | None = ..., samples_per_flight: int | None = ..., method: Literal["auto", "linear", "map", "extended"] | None = ..., tolerance: float | None = ..., epoch_ms: int | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Follow a body from impact to impact."""
    def jacobians(self, *, preset: Preset | None = ..., scene: Scene | None = ..., at: Literal["fixed_point"] | Mapping[str, Any] | None = ..., period: int | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Differentiate the map from one impact to the next."""
    def periodic_orbits(self, *, preset: Preset | None = ..., scene: Scene | None = ..., period: int | None = ..., guess: Mapping[str, Any] | None = ..., family: Literal["symmetric"] | None = ..., theta: float | None = ..., sweep: Mapping[str, Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Find periodic orbits, and follow them along a parameter."""
    def precision(self, *, preset: Preset | None = ..., scene: Scene | None = ..., bounces: int | None = ..., axis: Literal["time", "evaluations", "steps"] | None = ..., methods: Sequence[Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Chart speed against accuracy."""
    def previews(self, *, preset: Preset | None = ..., scene: Scene | None = ..., interventions: Sequence[Any] | None = ..., bounces: int | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Show a run in a headline and a picture."""
    def stability(self, *, preset: Preset | None = ..., scene: Scene | None = ..., bounces: int | None = ..., basin: bool | None = ..., budget: bool | None = ..., release_margins: bool | None = ..., tolerances: Sequence[Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Tell whether the bounce is stable."""
    def controllers(self, *, preset: Preset | None = ..., scene: Scene | None = ..., contact: Contact | None | Literal["frictionless", "stick"] | None = ..., weights: Mapping[str, Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Design a table that balances in place."""
    def catches(self, *, preset: Preset | None = ..., scene: Scene | None = ..., strategy: Literal["auto", "bounce_down", "plan", "brake"] | None = ..., ratio: float | None = ..., strikes: int | None = ..., brake: float | None = ..., weights: Mapping[str, Any] | None = ..., hold_speed: float | None = ..., hold: float | None = ..., hold_samples: int | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Catch a falling body and hold it."""
    def throws(self, *, preset: Preset | None = ..., scene: Scene | None = ..., apex: Mapping[str, Any], impact: int | None = ..., state: Mapping[str, Any] | None = ..., catch: Mapping[str, Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Throw a body to an apex of given height and angle."""
    def fits(self, *, preset: Preset | None = ..., scene: Scene | None = ..., measured: Mapping[str, Any], unknown: Sequence[Any], sd: Mapping[str, Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Fit fields of a scene to measured impacts."""
    def regions(self, *, preset: Preset | None = ..., scene: Scene | None = ..., x: Mapping[str, Any], y: Mapping[str, Any], bounces: int | None = ..., quantity: Literal["survival", "max_theta", "residue", "spectral_radius", "caught", "rest_time"] | None = ..., catch: Mapping[str, Any] | None = ..., tile: Mapping[str, Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Map survival over two fields."""
    def ensembles(self, *, preset: Preset | None = ..., scene: Scene | None = ..., runs: int | None = ..., bounces: int | None = ..., seed: int | None = ..., angles: bool | None = ..., tile: Mapping[str, Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
        """Run a scene many times, each time with different noise."""

def server() -> Server: ...
def get(path: str) -> Record: ...
def live(**request: Any) -> Iterator[Record]: ...
def ladder(*, preset: Preset | None = ..., scene: Scene | None = ..., bounces: int | None = ..., tolerance: float | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Find the simplest model that a scene needs."""
def trajectories(*, preset: Preset | None = ..., scene: Scene | None = ..., interventions: Sequence[Any] | None = ..., hold: float | None = ..., bounces: int | None = ..., samples_per_flight: int | None = ..., method: Literal["auto", "linear", "map", "extended"] | None = ..., tolerance: float | None = ..., epoch_ms: int | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Follow a body from impact to impact."""
def jacobians(*, preset: Preset | None = ..., scene: Scene | None = ..., at: Literal["fixed_point"] | Mapping[str, Any] | None = ..., period: int | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Differentiate the map from one impact to the next."""
def periodic_orbits(*, preset: Preset | None = ..., scene: Scene | None = ..., period: int | None = ..., guess: Mapping[str, Any] | None = ..., family: Literal["symmetric"] | None = ..., theta: float | None = ..., sweep: Mapping[str, Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Find periodic orbits, and follow them along a parameter."""
def precision(*, preset: Preset | None = ..., scene: Scene | None = ..., bounces: int | None = ..., axis: Literal["time", "evaluations", "steps"] | None = ..., methods: Sequence[Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Chart speed against accuracy."""
def previews(*, preset: Preset | None = ..., scene: Scene | None = ..., interventions: Sequence[Any] | None = ..., bounces: int | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Show a run in a headline and a picture."""
def stability(*, preset: Preset | None = ..., scene: Scene | None = ..., bounces: int | None = ..., basin: bool | None = ..., budget: bool | None = ..., release_margins: bool | None = ..., tolerances: Sequence[Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Tell whether the bounce is stable."""
def controllers(*, preset: Preset | None = ..., scene: Scene | None = ..., contact: Contact | None | Literal["frictionless", "stick"] | None = ..., weights: Mapping[str, Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Design a table that balances in place."""
def catches(*, preset: Preset | None = ..., scene: Scene | None = ..., strategy: Literal["auto", "bounce_down", "plan", "brake"] | None = ..., ratio: float | None = ..., strikes: int | None = ..., brake: float | None = ..., weights: Mapping[str, Any] | None = ..., hold_speed: float | None = ..., hold: float | None = ..., hold_samples: int | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Catch a falling body and hold it."""
def throws(*, preset: Preset | None = ..., scene: Scene | None = ..., apex: Mapping[str, Any], impact: int | None = ..., state: Mapping[str, Any] | None = ..., catch: Mapping[str, Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Throw a body to an apex of given height and angle."""
def fits(*, preset: Preset | None = ..., scene: Scene | None = ..., measured: Mapping[str, Any], unknown: Sequence[Any], sd: Mapping[str, Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Fit fields of a scene to measured impacts."""
def regions(*, preset: Preset | None = ..., scene: Scene | None = ..., x: Mapping[str, Any], y: Mapping[str, Any], bounces: int | None = ..., quantity: Literal["survival", "max_theta", "residue", "spectral_radius", "caught", "rest_time"] | None = ..., catch: Mapping[str, Any] | None = ..., tile: Mapping[str, Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Map survival over two fields."""
def ensembles(*, preset: Preset | None = ..., scene: Scene | None = ..., runs: int | None = ..., bounces: int | None = ..., seed: int | None = ..., angles: bool | None = ..., tile: Mapping[str, Any] | None = ..., body: Body | None = ..., gravity: float | None = ..., incline: float | None = ..., air: Air | None = ..., contact: Contact | None = ..., table: Table | None = ..., release: Release | None = ..., topple_angle: float | None = ..., noise: Noise | None = ...) -> Answer:
    """Run a scene many times, each time with different noise."""
