"""References for cases of the failure gallery, with 60 digits, for tests/server/failures.rs.

Needs mpmath. Prints JSON: python3 tests/oracle/failures.py > tests/oracle/failures.json
Written from the equations of the paper, not from the server's code.
"""

import json

import mpmath as mp

from jacobians import bounce

mp.mp.dps = 60

ROD = {
    "contact_distance": 0.13333333333333333,
    "radius_of_gyration": 0.09428090415820635,
    "gravity": 9.81,
    "restitution": 1.0,
    "tilt_gain": 1.1,
    "energy_gain": 0.0,
    "target_height": 0.2,
}
L, RHO, G = (mp.mpf(ROD[name]) for name in ("contact_distance", "radius_of_gyration", "gravity"))


def derivative(contacts):
    """Derivative over some contacts of the paper's first case, from its first contact, by central differences."""
    theta = mp.mpf(0.3)
    start = [RHO * theta, mp.mpf(0), -mp.sqrt(2 * G * (mp.mpf(0.2) - L * mp.cos(theta))), mp.mpf(0)]
    step = mp.mpf(10) ** -25
    columns = []
    for column in range(4):
        ends = []
        for sign in (1, -1):
            state = list(start)
            state[column] += sign * step
            for _ in range(contacts):
                state, _ = bounce(ROD, state)
            ends.append(state)
        columns.append([(a - b) / (2 * step) for a, b in zip(*ends)])
    return [[float(columns[column][row]) for column in range(4)] for row in range(4)]


def graze():
    """The height of release from which the second contact is a graze: the gap and its slope are zero together."""
    start, spin = mp.mpf(-1.8), mp.mpf(6)

    def gap_and_slope(height, t):
        fall = mp.findroot(lambda s: height - G * s * s / 2 - L * mp.cos(start + spin * s), mp.mpf("0.208"))
        theta, y_dot = start + spin * fall, -G * fall
        alpha = mp.mpf(ROD["tilt_gain"]) * theta
        arm = L * mp.sin(theta - alpha)
        impulse = -2 * (mp.cos(alpha) * y_dot + arm * spin) / (1 + (arm / RHO) ** 2)
        y_dot, turn = y_dot + impulse * mp.cos(alpha), spin + impulse * arm / RHO**2
        gap = y_dot * t - G * t * t / 2 + L * mp.cos(theta) - L * mp.cos(theta + turn * t)
        return gap, y_dot - G * t + L * turn * mp.sin(theta + turn * t)

    height, t = mp.findroot(lambda h, t: gap_and_slope(h, t), (mp.mpf("0.32574832"), mp.mpf("0.0645")))
    return {"height": mp.nstr(height, 30), "flight_time": mp.nstr(t, 30)}


def chatter(contacts):
    """Flights of a rod that topples over a table that stands still, with restitution 1/2, released at 0.05 rad."""
    theta, turn = mp.mpf(0.05), mp.mpf(0)
    y_dot = -mp.sqrt(2 * G * (mp.mpf(0.2) - L * mp.cos(theta)))
    flights = []
    for _ in range(contacts):
        arm = L * mp.sin(theta)
        impulse = -mp.mpf("1.5") * (y_dot + arm * turn) / (1 + (arm / RHO) ** 2)
        y_dot, turn = y_dot + impulse, turn + impulse * arm / RHO**2

        def deflated(t):
            return y_dot - G * t / 2 + (L * mp.cos(theta) - L * mp.cos(theta + turn * t)) / t

        # Newton from the right, at a negative gap, down to the first root.
        rise, pull = y_dot + L * turn * mp.sin(theta), G - L * turn**2 * mp.cos(theta)
        t = mp.findroot(deflated, 2 * rise / pull)
        flights.append(mp.nstr(t, 25))
        theta, y_dot = theta + turn * t, y_dot - G * t
    return flights


print(json.dumps({"derivative": derivative(100), "graze": graze(), "chatter": chatter(20)}, indent=1))
