"""Measured impacts of rigs, simulated from the equations of motion alone (rigs.py): the data in docs/clients.

    python3 -B tests/oracle/measured.py rod > docs/clients/measured.csv
    python3 -B tests/oracle/measured.py rig > docs/clients/my_rig.csv
    python3 -B tests/oracle/measured.py trimmed > docs/clients/my_rig_trimmed.csv

`rod`: the paper's rod with a tilt gain of 1.12 and a radius of gyration of 0.097 m. The camera missed impact 24 and read one angle 0.1 rad wrong.

`rig`, of docs/fitting.md: an air table of 30°. The table tilts by 4 % more than it should, senses 1 mrad too much, and believes in a restitution
of 0.75 where it is 0.72. The centre of gravity is 0.3 mm beside the axis, which adds 2.5 mrad to the bias. The camera missed impact 18, saw
impact 29 twice, and read one angle 60 mrad wrong. `trimmed`: the same rig after its tilt was set 5.09 mrad back.
"""

import random
import sys
from dataclasses import dataclass, replace
from math import pi, sin

from rigs import Rig, filmed

FIRST = Rig(
    contact_distance=0.12, radius_of_gyration=0.1, offset=0.0003, gravity=9.81 * sin(pi / 6), restitution=0.72, assumed_restitution=0.75,
    tilt_gain=1.4, energy_gain=0.2, target_height=0.18, angle_bias=0.001, gain_error=0.04, height=0.18, theta=0.1, x=0.5, x_dot=-0.3,
)


@dataclass(frozen=True)
class Measurement:
    rig: Rig
    seed: int
    impacts: int
    # Time of the camera at the release, s.
    clock: float
    # Numbers of the impacts with a fault, 0 for none.
    missed: int = 0
    doubled: int = 0
    outlier: int = 0
    wrong: float = 0.0


MEASUREMENTS = {
    "rod": Measurement(Rig(radius_of_gyration=0.097, tilt_gain=1.12, theta=0.15), 18, 60, 4.2, missed=24, outlier=41, wrong=0.1),
    "rig": Measurement(FIRST, 18, 40, 7.3, missed=18, doubled=29, outlier=12, wrong=0.06),
    "trimmed": Measurement(replace(FIRST, tilt_offset=-0.00509, x=0.0, x_dot=0.0), 19, 40, 7.3),
}
# Time from an impact to its double, s.
LATER = 0.03


def main():
    made = MEASUREMENTS[sys.argv[1]]
    seen = filmed(made.rig.impacts(made.impacts), ("t", "theta"), random.Random(made.seed), made.clock)
    print("t [s],theta [rad]")
    for n, (t, theta) in enumerate(zip(seen["t"], seen["theta"]), 1):
        if n != made.missed:
            print(f"{t:.5f},{theta + (made.wrong if n == made.outlier else 0.0):.5f}")
        if n == made.doubled:
            print(f"{t + LATER:.5f},{theta:.5f}")


if __name__ == "__main__":
    main()
