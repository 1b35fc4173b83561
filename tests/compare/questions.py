"""The requests that both programs are asked: every preset and example of the contract, and random mixes of features."""

import json
import random
from typing import NamedTuple, Optional
from urllib.parse import quote

from mixes import QUIET, mix


class Question(NamedTuple):
    """A request. One with a body is a POST."""

    resource: str
    form: str
    path: str
    body: Optional[str] = None
    kind: str = "application/json"

    def told(self):
        return f"GET {self.path}" if self.body is None else f"POST {self.path} {self.body}"


# Parameters that keep the answer of a preset cheap.
CHEAP = {
    "ladder": "bounces=10",
    "trajectories": "bounces=40&samples_per_flight=2",
    "jacobians": "at.impact=3&period=2",
    "periodic-orbits": "period=1",
    "precision": "bounces=3&methods.0=map&methods.1=adaptive&axis=evaluations",
    "previews": "bounces=100",
    "stability": "bounces=200",
    "probe": "",
    "controllers": "",
    "catches": "hold=1&hold_samples=20",
    "throws": "apex.height=0.3&apex.theta=0.1",
    "regions": "x.field=release.theta&x.from=-0.2&x.to=0.2&x.count=5"
    "&y.field=release.height&y.from=0.15&y.to=0.4&y.count=4&bounces=50",
    "ensembles": "runs=20&bounces=40",
}

# Formats of a random request: JSON tells most.
FORMS = ["json"] * 4 + ["csv", "ndjson", "arrow", "svg", "png"]

MEASURED = ["theta", "x_dot", "y_dot", "theta_dot", "x"]

STRATEGIES = [{}, {"strategy": "bounce_down"}, {"strategy": "bounce_down", "ratio": 0.6}, {"strategy": "plan", "strikes": 6},
              {"strategy": "brake", "brake": 9.81}]  # fmt: skip

# Times that a refused request is drawn again, and the share that is kept.
REDRAWS = 20
KEPT_REFUSALS = 0.02

QUANTITIES = ["survival", "max_theta", "residue", "spectral_radius", "caught", "rest_time"]

SIDES = [("release.theta", -0.3, 0.3), ("release.height", 0.15, 0.5), ("table.tilt_gain", 0.9, 1.7), ("release.theta_dot", -2, 2),
         ("contact.restitution", 0.4, 1), ("contact.friction", 0, 0.5), ("release.x_dot", -0.3, 0.3)]  # fmt: skip


def of_contract(contract):
    """The queries and bodies that the contract prints."""
    for path, item in contract["paths"].items():
        resource = path.removeprefix("/v1/").split("/")[0]
        if not path.startswith("/v1/") or resource == "live" or "{" in path and resource != "batches":
            continue
        for query in item.get("get", {}).get("x-queries", []):
            form = query.partition("format=")[2].partition("&")[0] or "json"
            yield Question(resource, form, f"{path}?{query}")
        for kind, content in item.get("post", {}).get("requestBody", {}).get("content", {}).items():
            for example in content.get("examples", {}).values():
                body = example["value"]
                if resource == "batches":
                    yield Question("batches", "ndjson", path.replace("{resource}", "stability"), body, kind)
                else:
                    yield Question(resource, "json", path, json.dumps(body))


def formats(contract, resource):
    """Formats of a resource, by the contract."""
    for parameter in contract["paths"][f"/v1/{resource}"]["get"]["parameters"]:
        if "$ref" in parameter:
            parameter = contract["components"]["parameters"][parameter["$ref"].rpartition("/")[2]]
        if parameter["name"] == "format":
            return parameter["schema"]["enum"]
    return ["json"]


def of_presets(contract, presets, failures):
    """Every preset through every resource in every format, and what needs no scene."""
    for name in presets:
        yield Question("scenes", "json", f"/v1/scenes/{name}")
        for resource, query in CHEAP.items():
            if resource == "probe":
                target = quote(f"preset={name}&bounces=200", safe="")
                yield Question("probe", "openmetrics", f"/v1/probe?target={target}")
                continue
            for form in formats(contract, resource):
                # Columns of a clock cannot be left out of Arrow's bytes.
                if (resource, form) != ("precision", "arrow"):
                    yield Question(resource, form, f"/v1/{resource}?preset={name}&{query}&format={form}")
        yield Question("jacobians", "json", f"/v1/jacobians?preset={name}&at=fixed_point")
    for name in failures:
        for form in ("json", "svg", "png"):
            yield Question("failures", form, f"/v1/failures/{name}?format={form}")


def of_mixes(seed, count, ask, only):
    """Random scenes of two to four features. `ask` answers a request: one that is refused is mostly drawn again, and a fit gets its data from a run."""
    for number in range(count):
        make = RANDOM[only if only in RANDOM else KINDS[number % len(KINDS)]]
        # Each request has its own dice, so that it stays what it is when another one draws more.
        dice = random.Random(f"{seed} {number}")
        question = make(dice, ask)
        for _ in range(REDRAWS):
            if dice.random() < KEPT_REFUSALS or ask(question).status == 200:
                break
            question = make(dice, ask)
        yield question


def posted(dice, resource, request, forms=FORMS):
    form = dice.choice(forms)
    return Question(resource, form, f"/v1/{resource}?format={form}", json.dumps(request))


def trajectory(dice, _ask):
    _, scene = mix(dice)
    request = {"scene": scene, "bounces": dice.choice([5, 20, 60]), "method": dice.choice(["auto", "map", "map", "extended", "linear"])}
    if dice.random() < 0.3:
        request["samples_per_flight"] = dice.choice([1, 4])
    if dice.random() < 0.1:
        request["tolerance"] = dice.choice([1e-6, 1e-12, 1e-20])
    if dice.random() < 0.1:
        request["hold"] = 0.2
    if dice.random() < 0.5:
        request["interventions"] = interventions(dice)
        request["method"] = dice.choice(["auto", "map"])
    return posted(dice, "trajectories", request)


def interventions(dice):
    first = dice.randint(1, 6)
    changes = [
        {"kick": {"theta_dot": round(dice.uniform(-0.3, 0.3), 4)}},
        {"set": {"table": {"tilt_gain": round(dice.uniform(0.95, 1.4), 4)}}},
        {"catch": dice.choice(STRATEGIES)},
        {"catch": dice.choice(STRATEGIES)},
        {"throw": {"apex": {"height": round(dice.uniform(0.2, 0.6), 4), "theta": round(dice.uniform(-0.2, 0.2), 4)}}},
    ]
    made = [{"impact": first} | dice.choice(changes)]
    if dice.random() < 0.3:
        made.append({"impact": first + dice.randint(1, 8)} | dice.choice(changes))
    return made


def jacobian(dice, _ask):
    _, scene = mix(dice, QUIET)
    state = {"theta": 0.05, "x_dot": 0.02, "y_dot": -1.3, "theta_dot": 0.1}
    request = {"scene": scene, "at": dice.choice(["fixed_point", {"impact": dice.randint(1, 8)}, {"state": state}])}
    if dice.random() < 0.4:
        request["period"] = dice.randint(2, 4)
    return posted(dice, "jacobians", request, FORMS[:7])


def stability(dice, _ask):
    _, scene = mix(dice)
    request = {"scene": scene, "bounces": dice.choice([50, 200])}
    if dice.random() < 0.25:
        request["budget"] = True
        request["bounces"] = 20
    if dice.random() < 0.25:
        request["tolerances"] = [
            {"field": "body.contact_distance", "tolerance": 0.002},
            {"field": "body.radius_of_gyration", "tolerance": 0.001},
            {"field": "contact.restitution", "tolerance": 0.01},
        ]
    if dice.random() < 0.1:
        request["tolerances"] = [{"field": "table.tilt_gain", "tolerance": 0.02}]
    if dice.random() < 0.1:
        request["basin"] = True
    return posted(dice, "stability", request, FORMS + ["openmetrics"])


def region(dice, _ask):
    quantity = dice.choice(QUANTITIES)
    _, scene = mix(dice, QUIET) if quantity in QUANTITIES[2:] else mix(dice)
    across, up = dice.sample(SIDES, 2)
    count = 3 if quantity in ("caught", "rest_time") else dice.choice([4, 9, 17])
    request = {"scene": scene, "quantity": quantity, "bounces": dice.choice([20, 60])}
    for name, (field, low, high), cells in (("x", across, count), ("y", up, 3)):
        request[name] = {"field": field, "from": low, "to": high, "count": cells}
    if quantity in ("caught", "rest_time"):
        request["catch"] = dice.choice(STRATEGIES) | {"hold": 0.5}
        del request["bounces"]
    return posted(dice, "regions", request)


def ensemble(dice, _ask):
    _, scene = mix(dice)
    if "noise" not in scene:
        scene["noise"] = {"timing_sd": 0.002, "angle_sd": 0.002, "model": dice.choice(["strike", "plan"])}
    if dice.random() < 0.3:
        scene["noise"] |= {"x_dot_sd": 0.005, "theta_dot_sd": 0.01}
    if dice.random() < 0.2:
        scene["noise"]["restitution_sd"] = 0.01
    request = {"scene": scene, "runs": dice.choice([10, 40]), "bounces": dice.choice([10, 40]), "seed": dice.randint(0, 9)}
    return posted(dice, "ensembles", request, FORMS + ["progress"])


def periodic_orbit(dice, _ask):
    _, scene = mix(dice, QUIET)
    request = {"scene": scene}
    kind = dice.random()
    if kind < 0.4:
        request["period"] = 1
    elif kind < 0.7:
        request |= {"family": "symmetric", "theta": round(dice.uniform(0.02, 0.3), 4)}
    else:
        guess = {"theta": 0.05, "x_dot": 0.02, "y_dot": -1.3, "theta_dot": 0.1}
        request |= {"period": dice.randint(1, 3), "guess": guess}
    if dice.random() < 0.3:
        request["sweep"] = {"field": dice.choice(["table.tilt_gain", "release.height"]), "from": 1.1, "to": 1.3, "points": 8}
    return posted(dice, "periodic-orbits", request)


def controller(dice, _ask):
    _, scene = mix(dice)
    request = {"scene": scene}
    if dice.random() < 0.3:
        request["contact"] = dice.choice(["frictionless", "stick"])
    if dice.random() < 0.3:
        request["weights"] = {"state": {"x": 0}, "input": 5}
    return posted(dice, "controllers", request)


def catch(dice, _ask):
    _, scene = mix(dice)
    return posted(dice, "catches", {"scene": scene, "hold": 0.5, "hold_samples": 10} | dice.choice(STRATEGIES))


def throw(dice, _ask):
    _, scene = mix(dice)
    request = {"scene": scene, "apex": {"height": round(dice.uniform(0.2, 0.6), 4), "theta": dice.choice([0, 0.1, -0.2, 3.141592653589793])}}
    kind = dice.random()
    if kind < 0.4:
        request["impact"] = dice.randint(1, 6)
    elif kind < 0.6:
        request["state"] = {"theta": 0.05, "y_dot": -1.2, "x_dot": 0.05}
    if dice.random() < 0.4:
        request["catch"] = dice.choice(STRATEGIES) | {"hold": 0.5, "hold_samples": 10}
    return posted(dice, "throws", request)


def fit(dice, ask):
    _, scene = mix(dice, QUIET)
    answer = ask(Question("trajectories", "json", "/v1/trajectories", json.dumps({"scene": scene, "bounces": 25, "method": "map"})))
    rows = json.loads(answer.body).get("impacts", {}) if answer.status == 200 else {}
    measured = {"t": [round(t + dice.gauss(0, 1e-4), 6) for t in rows.get("t", [0.1, 0.2])]}
    for name in dice.sample(MEASURED, 2):
        if rows.get(name):
            measured[name] = [None if value is None else round(value + dice.gauss(0, 1e-3), 5) for value in rows[name]]
    unknown = dice.sample(["table.tilt_gain", "body.radius_of_gyration", "body.contact_distance", "contact.restitution", "release.theta"], 2)
    for path in unknown:
        part, field = path.split(".")
        if field in scene.get(part, {}):
            scene[part] = scene[part] | {field: round(scene[part][field] * 1.03, 6)}
    request = {"scene": scene, "measured": measured, "unknown": unknown[: dice.randint(1, 2)]}
    if dice.random() < 0.5:
        request["sd"] = {"t": 1e-4} | {name: 1e-3 for name in measured if name != "t"}
    return posted(dice, "fits", request, FORMS + ["progress"])


def batch(dice, _ask):
    resource, made = dice.choice([("stability", stability), ("trajectories", trajectory), ("jacobians", jacobian), ("catches", catch)])
    lines = "".join(made(dice, _ask).body + "\n" for _ in range(4))
    return Question("batches", "ndjson", f"/v1/batches/{resource}", lines, "application/x-ndjson")


def preview(dice, _ask):
    _, scene = mix(dice)
    request = {"scene": scene, "bounces": 60}
    if dice.random() < 0.3:
        request["interventions"] = interventions(dice)
    return posted(dice, "previews", request, ["json", "svg", "png"])


def ladder(dice, _ask):
    _, scene = mix(dice)
    return posted(dice, "ladder", {"scene": scene, "bounces": 10}, FORMS[:7])


def precision(dice, _ask):
    _, scene = mix(dice, QUIET)
    return posted(dice, "precision", {"scene": scene, "bounces": 3, "methods": ["map", "runge_kutta_bisection"]}, ["json"])


def probe(dice, _ask):
    """Presets with a changed field, since a target is a query."""
    preset, gain = dice.choice(["case-1", "case-4", "rough-matched", "juggling", "air-table"]), round(dice.uniform(0.9, 1.7), 4)
    target = f"preset={preset}&scene.table.tilt_gain={gain}&bounces=100"
    return Question("probe", "openmetrics", "/v1/probe?target=" + quote(target, safe=""))


RANDOM = {
    "trajectories": trajectory,
    "jacobians": jacobian,
    "stability": stability,
    "regions": region,
    "ensembles": ensemble,
    "periodic-orbits": periodic_orbit,
    "controllers": controller,
    "catches": catch,
    "throws": throw,
    "fits": fit,
    "batches": batch,
    "previews": preview,
    "ladder": ladder,
    "precision": precision,
    "probe": probe,
}

# Resources by turns, those with most physics most often.
KINDS = [*RANDOM, "trajectories", "stability", "regions", "catches", "jacobians", "trajectories", "trajectories"]
KINDS = [name for name in KINDS if name not in ("precision", "probe")] * 4 + ["precision", "probe"]
