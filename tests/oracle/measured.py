"""Measured impacts of a rig, simulated from the equations of motion alone: docs/clients/measured.csv, which docs/clients/fit_my_rig.py fits.

    python3 -B tests/oracle/measured.py > docs/clients/measured.csv

The rig is the paper's rod with a tilt gain of 1.12 and a radius of gyration of 0.097 m. Noise is 1 ms and 2 mrad. The clock does not start at the
release, the camera missed impact 24, and one angle is off by 0.1 rad.
"""

import random

from simulation import Body, State, fall, strike

GAIN, RHO, DISTANCE, HEIGHT, THETA = 1.12, 0.097, 0.4 / 3, 0.2, 0.15
IMPACTS, CLOCK = 60, 4.2
TIME_SD, ANGLE_SD = 1e-3, 2e-3
MISSED, OUTLIER = 24, 41


def impacts(count):
    """Times and angles just before each impact; each strikes a table that stands still at its tilt."""
    body = Body(DISTANCE, RHO, 9.81, 1.0)
    # Heights count from that of an upright body at contact with a level table.
    state = State(0.0, 0.0, HEIGHT, THETA, 0.0, 0.0, 0.0)
    for _ in range(count):
        state = fall(body, state)
        yield state.t, state.theta
        state, _, _ = strike(body, state, GAIN * state.theta, 0.0)


def main():
    noise = random.Random(18)
    print("t [s],theta [rad]")
    for n, (t, theta) in enumerate(impacts(IMPACTS), 1):
        t, theta = t + CLOCK + noise.gauss(0, TIME_SD), theta + noise.gauss(0, ANGLE_SD)
        if n == OUTLIER:
            theta += 0.1
        if n != MISSED:
            print(f"{t:.5f},{theta:.5f}")


if __name__ == "__main__":
    main()
