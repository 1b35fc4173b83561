"""Contact 100 of random runs near upright, with 50 digits, for server/physics/tests/accuracy.rs.

Needs mpmath. Prints JSON: python3 tests/oracle/runs.py > tests/oracle/runs.json
Written from the equations of the paper, (8) and (24) to (28), not from the server's code. `plain` is the largest error of
the same lines in doubles.
"""

import json
import math
import random

import mpmath as mp

mp.mp.dps = 60
CONTACTS = 100


def run(scene, module, number):
    length, rho = number(scene["body"]["contact_distance"]), number(scene["body"]["radius_of_gyration"])
    gravity, kappa = number("9.81"), number(scene["table"]["tilt_gain"])
    release = {name: number(value) for name, value in scene["release"].items()}
    theta, theta_dot, x_dot, y_dot = release["theta"], release["theta_dot"], release["x_dot"], number(0)
    height = release["height"] - length * module.cos(theta)
    contacts = 0
    while True:
        # Near upright the gap is concave: Newton from beyond its last zero falls onto the next contact.
        t = (y_dot + module.sqrt(y_dot**2 + 2 * gravity * (height + 2 * length))) / gravity
        for _ in range(60):
            gap = height + y_dot * t - gravity * t * t / 2 + length * module.cos(theta) - length * module.cos(theta + theta_dot * t)
            step = gap / (y_dot - gravity * t + length * theta_dot * module.sin(theta + theta_dot * t))
            t -= step
            if abs(step) < 1e-40:
                break
        contacts, height = contacts + 1, number(0)
        theta, y_dot = theta + theta_dot * t, y_dot - gravity * t
        if contacts == CONTACTS:
            return [theta, x_dot, y_dot, theta_dot]
        alpha = kappa * theta
        beta = theta - alpha
        normal = -module.sin(alpha) * x_dot + module.cos(alpha) * y_dot + length * theta_dot * module.sin(beta)
        impulse = -2 * normal / (1 + length**2 * module.sin(beta) ** 2 / rho**2)
        x_dot, y_dot = x_dot - impulse * module.sin(alpha), y_dot + impulse * module.cos(alpha)
        theta_dot += impulse * length * module.sin(beta) / rho**2
        if length * theta_dot**2 > gravity or y_dot + length * theta_dot * module.sin(theta) <= 0:
            return None


def main():
    random.seed(7)
    samples = []
    while len(samples) < 60:
        length = 10 ** random.uniform(-1.3, 0)
        height = length * random.uniform(1.2, 3)
        rho = length * random.uniform(0.3, 1.2)
        critical = 1 + rho**2 / (2 * (height - length) * length)
        scene = {
            "body": {"contact_distance": length, "radius_of_gyration": rho},
            "table": {"tilt_gain": 1 + (critical - 1) * random.uniform(0.05, 0.6)},
            "release": {
                "height": height,
                "theta": random.uniform(-0.1, 0.1),
                "theta_dot": random.uniform(-0.3, 0.3),
                "x_dot": random.uniform(-0.3, 0.3),
            },
        }
        exact, plain = run(scene, mp, mp.mpf), run(scene, math, float)
        if exact is None or plain is None:
            continue
        error = max(abs(float(a - mp.mpf(b))) for a, b in zip(exact, plain))
        if error > 1e-9:
            continue
        names = ("theta", "x_dot", "y_dot", "theta_dot")
        scene["state"] = {name: float(value) for name, value in zip(names, exact)}
        scene["plain"] = error
        samples.append(scene)
    print("[" + ",\n".join(json.dumps(sample) for sample in samples) + "]")


main()
