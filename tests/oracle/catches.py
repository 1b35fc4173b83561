"""Asks a server for random catches and throws, and simulates each of them from the equations of motion (simulation.py).

python3 tests/oracle/catches.py http://127.0.0.1:8080 [number of catches]

A catch that the server calls held must be held by the simulation: from the release on, with the tilts and table speeds of the strikes
of the answer, its own search for contacts, and its own law of the hold. Needs only the standard library.
"""

import json
import random
import sys
import urllib.error
import urllib.request
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from math import cos, isclose, pi

from simulation import Body, State, contact_law, contact_velocity, fall, fly, hold, strike

PAPER = {"contact_distance": 0.4 / 3, "radius_of_gyration": 2**0.5 / 15}
# Contact speed, m/s, below which a table that stays with the body need not move with it.
TOUCH_SPEED = 5e-3
# A strike and its flight from the server's state end within this of the server's next state (s, m, m/s).
STRIKE_ERROR = 1e-9
# Difference of two runs at which the simulation goes on from the server's state, m and m/s.
APART = 1e-7
# A hold of the simulation is this near to that of the server (m, m/s).
HOLD_ERROR = 1e-5
# The tilt of a hold is this near to that of the server (rad).
TILT_ERROR = 1e-4
# Largest |θ| (rad) of a body that is held.
UPRIGHT = 0.01
# Least share of the random catches that are held.
SHARE = 0.5
# Error of a throw's apex (m): in closed form, and by a search.
EXACT, SEARCHED = 1e-12, 1e-9


def ask(address, resource, body):
    """An answer, or the problem document of a refusal."""
    data = json.dumps(body).encode()
    request = urllib.request.Request(f"{address}/v1/{resource}", data, {"Content-Type": "application/json"})
    try:
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.load(answer)
    except urllib.error.HTTPError as error:
        return json.load(error)


def random_scene(draw):
    """A release of up to 0.3 rad and 2 rad/s, e from 0.3 to 1, a belief that is off by up to 0.2, and matched friction in a third."""
    e = draw.uniform(0.3, 1.0)
    contact, table = {"restitution": e}, {"tilt_gain": 1.1}
    if draw.random() < 0.5:
        table["assumed_restitution"] = min(1.0, e + draw.uniform(-0.2, 0.2))
    if draw.random() < 0.33:
        contact["friction"] = draw.uniform(0.3, 1.0)
        table["slide"] = "matched"
    release = {
        "height": draw.uniform(0.2, 0.4),
        "theta": draw.uniform(-0.3, 0.3),
        "theta_dot": draw.uniform(-2.0, 2.0),
        "x_dot": draw.uniform(-0.2, 0.2),
    }
    return {"body": PAPER, "contact": contact, "table": table, "release": release}


def random_catch(draw):
    body = {"scene": random_scene(draw), "strategy": draw.choice(["auto", "bounce_down", "bounce_down", "plan", "brake"])}
    if body["strategy"] == "bounce_down":
        body["ratio"] = draw.uniform(0.3, 0.8)
    if body["strategy"] == "brake":
        body["brake"] = draw.uniform(4.0, 20.0)
    return body


def random_throw(draw):
    """A throw from a run's contact or from rest, up to one turn, frictionless in half of the cases."""
    scene = random_scene(draw)
    if draw.random() < 0.5:
        scene["contact"].pop("friction", None)
        scene["table"].pop("slide", None)
    # A wrong belief misses the apex, which is no error of the throw.
    scene["table"].pop("assumed_restitution", None)
    body = {"scene": scene, "apex": {"height": draw.uniform(0.3, 0.8), "theta": draw.choice([0.0, pi, -pi, 2 * pi, draw.uniform(-3, 3)])}}
    if draw.random() < 0.5:
        body["impact"] = 1
    return body


def body_of(scene):
    shape, contact = scene["body"], scene["contact"]
    return Body(
        shape["contact_distance"],
        shape["radius_of_gyration"],
        scene["gravity"],
        contact["restitution"],
        contact.get("friction") or 0.0,
    )


def released(scene):
    release = scene["release"]
    return State(0.0, *(release.get(name) or 0.0 for name in ("x", "height", "theta", "x_dot", "y_dot", "theta_dot")))


def at_contact(body, columns, index):
    """The answer's state just before a strike."""
    t, x, theta, x_dot, y_dot, theta_dot = (columns[name][index] for name in ("t", "x", "theta", "x_dot", "y_dot", "theta_dot"))
    return State(t, x, body.l * cos(theta), theta, x_dot, y_dot, theta_dot)


def distance(body, one, other):
    """Largest difference of two states in time, place and velocity, angles as lengths at the radius of gyration."""
    turn, spin = body.rho * (one.theta - other.theta), body.rho * (one.theta_dot - other.theta_dot)
    return max(map(abs, (one.t - other.t, one.x - other.x, turn, one.x_dot - other.x_dot, one.y_dot - other.y_dot, spin)))


def replayed(body, start, columns):
    """The simulated state at the touchdown, and the largest error of a strike with its flight.

    The motion is unstable without feedback, so rounding grows up to twentyfold per bounce. Where the simulation has parted from the
    answer by `APART`, it goes on from the answer's state; every single strike and flight is compared all the same.
    """
    own = fall(body, start)
    if not columns["n"]:
        return own, 0.0
    worst = distance(body, own, at_contact(body, columns, 0))
    last = len(columns["n"]) - 1
    for index in range(last + 1):
        theirs = at_contact(body, columns, index)
        own = theirs if distance(body, own, theirs) > APART else own
        table = columns["alpha"][index], columns["table_velocity"][index]
        struck = strike(body, theirs, *table)
        assert struck, f"strike {index + 1} pulls"
        after, *impulses = struck
        for name, impulse in zip(("impulse_normal", "impulse_tangential"), impulses):
            worst = max(worst, abs(impulse - columns[name][index]))
        # A flight that the answer does not end has no next contact: the table stays with the body.
        flies = columns["flight_time"][index] is not None
        if flies and index < last:
            worst = max(worst, distance(body, fall(body, after), at_contact(body, columns, index + 1)))
        own = strike(body, own, *table)[0]
        own = fall(body, own) if flies else own
    return own, worst


def check_catch(job):
    """Simulates a catch. Returns its outcome and its largest errors."""
    address, request = job
    answer = ask(address, "catches", request)
    assert "outcome" in answer, f"{answer} of {json.dumps(request)}"
    kind, told = answer["outcome"]["kind"], json.dumps(request)
    body, settings = body_of(answer["scene"]), answer["settings"]
    own, strike_error = replayed(body, released(answer["scene"]), answer["strikes"])
    assert strike_error < STRIKE_ERROR, f"a strike is off by {strike_error} of {told}"
    if kind != "held":
        return kind, answer["strategy"]["name"], strike_error, 0.0
    columns = answer["hold"]
    assert abs(own.t - answer["contact_from"]) < APART, f"the contact begins at {own.t} of {told}"
    speed = contact_velocity(body, own)[1]
    brake = settings.get("brake") or body.gravity
    brake = min(brake, body.gravity / 2) if speed > 0 else brake
    state, cost = [settings["weights"]["state"][name] for name in ("x", "theta", "x_dot", "theta_dot")], settings["weights"]["input"]
    rest = contact_law(body, body.gravity, state, cost)
    moves = abs(speed) >= TOUCH_SPEED
    braking = contact_law(body, body.gravity + (-brake if speed > 0 else brake), state, cost) if moves else rest
    times = columns["t"] or [answer["contact_from"] + settings["hold"]]
    strikes = answer["strikes"]
    struck = bool(strikes["n"]) and strikes["flight_time"][-1] is None
    held = hold(body, own, (braking, rest), times, speed, brake, tilt=strikes["alpha"][-1] if struck else None)
    assert held.reason == "completed", f"{held.reason} at {held.s.t} s, not held: {told}"
    if body.friction:
        assert held.least_friction < body.friction * (1 + 1e-6), f"slips, needs {held.least_friction}: {told}"
    hold_error = 0.0
    for index, s in enumerate(held.states if columns["t"] else []):
        theirs = [columns[name][index] for name in ("x", "theta", "x_dot", "theta_dot")]
        mine = (s.x, s.theta, s.x_dot, s.theta_dot)
        hold_error = max([hold_error] + [abs(a - b) for a, b in zip(mine, theirs)])
        if held.tilts[index] is not None:
            tilt_error = abs(held.tilts[index] - columns["alpha"][index])
            assert tilt_error < TILT_ERROR, f"the tilt of the hold is off by {tilt_error} rad at {s.t} s: {told}"
    rate = max([abs(b - a) / (u - t) for a, b, t, u in zip(columns["alpha"], columns["alpha"][1:], columns["t"], columns["t"][1:])] + [0.0])
    assert rate <= answer["demand"]["tilt_rate"] * (1 + 1e-9), f"the table tilts at {rate} rad/s, beyond the demand: {told}"
    if struck:
        assert abs(columns["alpha"][0] - strikes["alpha"][-1]) <= 1e-9, f"the tilt jumps as the contact begins: {told}"
    assert hold_error < HOLD_ERROR, f"the hold is off by {hold_error}: {told}"
    assert abs(held.s.theta) < UPRIGHT and abs(held.s.theta_dot) < 10 * UPRIGHT, f"{held.s} is not upright: {told}"
    return kind, answer["strategy"]["name"], strike_error, hold_error


def check_throw(job):
    """Simulates a throw. Returns the error of its apex, or None if the server refuses it with a reason."""
    address, request = job
    answer = ask(address, "throws", request)
    told = json.dumps(request)
    if "apex" not in answer:
        assert answer["status"] == 422 and answer["errors"][0]["detail"], f"{answer} of {told}"
        return None
    body = body_of(answer["scene"])
    before = answer["before"]
    s = State(answer["t"], before["x"], body.l * cos(before["theta"]), *(before[n] for n in ("theta", "x_dot", "y_dot", "theta_dot")))
    after, *impulses = strike(body, s, answer["alpha"], answer["table_velocity"], answer["table_velocity_tangential"] if body.friction else None)
    for name, impulse in zip(("impulse_normal", "impulse_tangential"), impulses):
        assert isclose(impulse, answer[name], rel_tol=1e-9, abs_tol=1e-9), f"{name}: {impulse}, not {answer[name]} of {told}"
    top = fly(body, after, after.y_dot / body.gravity)
    error = max(abs(top.y - request["apex"]["height"]), body.rho * abs(top.theta - request["apex"]["theta"]))
    assert error < (SEARCHED if body.friction else EXACT), f"the apex is off by {error} of {told}"
    return error


def main():
    address, number = sys.argv[1].rstrip("/"), int(sys.argv[2]) if len(sys.argv) > 2 else 200
    draw = random.Random(16)
    catches = [(address, random_catch(draw)) for _ in range(number)]
    throws = [(address, random_throw(draw)) for _ in range(number)]
    with ProcessPoolExecutor() as pool:
        caught = list(pool.map(check_catch, catches, chunksize=4))
        thrown = list(pool.map(check_throw, throws, chunksize=16))
    kinds = Counter(kind for kind, *_ in caught)
    for name in sorted({name for _, name, *_ in caught}):
        share = Counter(kind for kind, strategy, *_ in caught if strategy == name)
        print(f"{name}: {dict(share)}")
    share = kinds["held"] / number
    print(
        f"{number} catches, {share:.0%} held; strikes within {max(error for _, _, error, _ in caught):.1e}, "
        f"holds within {max(error for *_, error in caught):.1e}"
    )
    errors = [error for error in thrown if error is not None]
    print(f"{len(errors)} of {number} throws, apex within {max(errors):.1e}")
    assert share >= SHARE, f"only {share:.0%} are caught"
    assert len(errors) >= number / 2, "most throws are refused"


if __name__ == "__main__":
    main()
