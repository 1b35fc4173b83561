"""Rigs as a lab has them, simulated from the equations of motion (simulation.py): a table with errors of its own, a body whose centre of
gravity is beside its axis, and a camera with noise. For measured.py and coverage.py.

Written from mechanics, not from the server's code. Only the standard library. Units m, s, rad; unit mass.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, hypot

from simulation import Body, State, along, fall, strike

# Noise of a camera with 200 frames per second, which sees the contact between two frames.
SD = {"t": 1e-3, "theta": 2e-3, "x": 1e-3}


@dataclass(frozen=True)
class Rig:
    """A body, its table, and its release at rest or moving along the table."""

    contact_distance: float = 0.4 / 3
    radius_of_gyration: float = 2**0.5 / 15
    offset: float = 0.0
    # In the plane of motion: g times the sine of the incline.
    gravity: float = 9.81
    restitution: float = 1.0
    friction: float = 0.0
    # True if the table moves along itself with the contact point.
    matched: bool = False
    # None of a table that stands still.
    assumed_restitution: float | None = None
    tilt_gain: float = 0.0
    # K of the tilt −K·(x, θ, ẋ, θ̇), beside the tilt gain.
    feedback: tuple = (0.0, 0.0, 0.0, 0.0)
    energy_gain: float = 0.0
    target_height: float = 0.0
    angle_bias: float = 0.0
    tilt_offset: float = 0.0
    gain_error: float = 0.0
    height: float = 0.2
    theta: float = 0.0
    x: float = 0.0
    x_dot: float = 0.0
    # Scatter of restitution and tilt from strike to strike, which no fit knows of.
    restitution_sd: float = 0.0
    tilt_sd: float = 0.0

    def impacts(self, count, chance=None):
        """States just before the impacts, θ of the line from the contact point to the centre of gravity; fewer if the run ends."""
        # The axis leans by so much more than that line.
        lean = atan2(self.offset, self.contact_distance)
        length = hypot(self.contact_distance, self.offset)
        body = Body(length, self.radius_of_gyration, self.gravity, self.restitution, self.friction)
        state = State(0.0, self.x, self.height, self.theta, self.x_dot, 0.0, 0.0)
        found = []
        while len(found) < count:
            state = fall(body, state)
            if state is None or abs(state.theta) > 1.5:
                break
            found.append(state)
            sensed = (state.x, state.theta + lean + self.angle_bias, state.x_dot, state.theta_dot)
            wanted = self.tilt_gain * sensed[1] - sum(gain * value for gain, value in zip(self.feedback, sensed))
            alpha, met = (1 + self.gain_error) * wanted + self.tilt_offset, body
            if self.tilt_sd:
                alpha += chance.gauss(0, self.tilt_sd)
            if self.restitution_sd:
                met = replace(body, restitution=self.restitution + chance.gauss(0, self.restitution_sd))
            struck = strike(met, state, alpha, self.speed(body, state, alpha), None if self.matched else 0.0)
            if struck is None:
                break
            state = struck[0]
        return found

    def speed(self, body, state, alpha):
        """Velocity of the table along its normal. It makes up the loss that it believes in, and steers the energy of the vertical motion."""
        if self.assumed_restitution is None:
            return 0.0
        energy = self.gravity * state.y + state.y_dot**2 / 2
        short = self.energy_gain * (self.gravity * self.target_height - energy)
        lost = (1 - self.assumed_restitution) / (1 + self.assumed_restitution)
        return -(lost + short) * along(body, state, alpha)[0]


def filmed(states, columns, chance, clock=0.0):
    """The columns of states with the noise of the camera, whose clock shows `clock` at the release."""
    seen = {name: [] for name in columns}
    for state in states:
        for name in columns:
            seen[name].append(getattr(state, name) + (clock if name == "t" else 0.0) + chance.gauss(0, SD[name]))
    return seen
