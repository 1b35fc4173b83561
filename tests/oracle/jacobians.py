"""Derivatives of the map at random states by central differences with 50 digits, for server/physics/tests/identities.rs.

Needs mpmath. Prints JSON: python3 tests/oracle/jacobians.py > tests/oracle/jacobians.json
Written from the equations of the paper, (8) and (24) to (28), not from the server's code.
"""

import json
import random

import mpmath as mp

mp.mp.dps = 60


def bounce(body, state):
    length, rho, gravity, e, kappa, energy_gain, target = (mp.mpf(body[name]) for name in
        ("contact_distance", "radius_of_gyration", "gravity", "restitution", "tilt_gain", "energy_gain", "target_height"))
    theta, x_dot, y_dot, theta_dot = state[0] / rho, state[1], state[2], state[3] / rho
    alpha = kappa * theta
    beta = theta - alpha
    normal = -mp.sin(alpha) * x_dot + mp.cos(alpha) * y_dot + length * theta_dot * mp.sin(beta)
    eta = gravity * length * mp.cos(theta) + y_dot**2 / 2
    table = -((1 - e) / (1 + e) + energy_gain * (gravity * target - eta)) * normal
    if normal - table >= 0:
        return None
    impulse = -(1 + e) * (normal - table) / (1 + length**2 * mp.sin(beta) ** 2 / rho**2)
    x_dot = x_dot - impulse * mp.sin(alpha)
    y_dot = y_dot + impulse * mp.cos(alpha)
    theta_dot = theta_dot + impulse * length * mp.sin(beta) / rho**2
    if y_dot + length * theta_dot * mp.sin(theta) <= 0:
        return None

    def gap(t):
        return y_dot * t - gravity * t * t / 2 + length * mp.cos(theta) - length * mp.cos(theta + theta_dot * t)

    def slope(t):
        return y_dot - gravity * t + length * theta_dot * mp.sin(theta + theta_dot * t)

    # March with a bound on the curvature, so that no root is missed, then polish.
    curvature = gravity + length * theta_dot**2
    t = mp.mpf(0)
    while True:
        value, speed = (mp.mpf(0) if t == 0 else gap(t)), slope(t)
        step = (speed + mp.sqrt(speed**2 + 2 * curvature * value)) / curvature
        t += step * mp.mpf("0.999")
        if gap(t) < mp.mpf("1e-9") * length:
            break
    for _ in range(8):
        t -= gap(t) / slope(t)
    arrival = slope(t)
    return [rho * (theta + theta_dot * t), x_dot, y_dot - gravity * t, rho * theta_dot], arrival


def main():
    random.seed(20)
    samples = []
    while len(samples) < 80:
        length = 10 ** random.uniform(-1.3, 0.3)
        body = {
            "contact_distance": length,
            "radius_of_gyration": length * random.uniform(0.3, 1.2),
            "gravity": random.uniform(2, 12),
            "restitution": random.uniform(0.2, 1),
            "tilt_gain": random.uniform(-0.5, 2),
            "energy_gain": random.choice([0.0, random.uniform(0, 0.1)]),
            "target_height": length * random.uniform(1.2, 3),
        }
        theta_dot = random.uniform(-30, 30) if random.random() < 0.3 else random.uniform(-4, 4)
        state = {
            "theta": random.uniform(-1, 1),
            "x_dot": random.uniform(-1, 1),
            "y_dot": random.uniform(-4, -0.3),
            "theta_dot": theta_dot,
        }
        rho = mp.mpf(body["radius_of_gyration"])
        centre = [rho * mp.mpf(state["theta"]), mp.mpf(state["x_dot"]), mp.mpf(state["y_dot"]), rho * mp.mpf(state["theta_dot"])]
        result = bounce(body, centre)
        if result is None or abs(result[1]) < 0.05:
            continue
        step = mp.mpf("1e-20")
        columns = []
        for index in range(4):
            ends = []
            for sign in (1, -1):
                aside = list(centre)
                aside[index] += sign * step
                ends.append(bounce(body, aside)[0])
            columns.append([(high - low) / (2 * step) for high, low in zip(*ends)])
        matrix = [[float(columns[column][row]) for column in range(4)] for row in range(4)]
        samples.append({"body": body, "state": state, "matrix": matrix, "contact_speed": float(result[1])})
    print("[" + ",\n".join(json.dumps(sample) for sample in samples) + "]")


if __name__ == "__main__":
    main()
