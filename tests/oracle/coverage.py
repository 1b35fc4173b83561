"""How often the 95 % intervals of /v1/fits hold the true value, for rigs that are simulated from the equations of motion alone (rigs.py).

    python3 -B tests/oracle/coverage.py

Prints tables in Markdown, for docs/fitting.md. With --impacts instead: the widths of the intervals after so many impacts. Fails if the intervals
hold too seldom or too often, if estimates are biased, or if a wrong one is called good. The fits are those of the package equipoise.
"""

import argparse
import random
import statistics
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from math import pi, sqrt

import equipoise
from measured import FIRST
from rigs import SD, Rig, filmed

MISSED, OUTLIER = 7, 11


@dataclass(frozen=True)
class Case:
    name: str
    rig: Rig
    # The scene with given values of the unknown fields.
    scene: Callable
    # Paths of the unknown fields with their true values.
    unknown: dict
    columns: tuple = ("t", "theta")
    impacts: tuple = (20, 40, 60)


def rod(table, height=0.2, theta=0.2, contact=None, radius=Rig.radius_of_gyration, **more):
    body = {"contact_distance": Rig.contact_distance, "radius_of_gyration": radius}
    return {"body": body, "contact": contact or {}, "table": table, "release": {"height": height, "theta": theta}, **more}


def rig_of_the_page(gain_error, bias, restitution):
    table = {"tilt_gain": FIRST.tilt_gain, "energy_gain": FIRST.energy_gain, "target_height": FIRST.target_height, "assumed_restitution": 0.75}
    body = {"contact_distance": FIRST.contact_distance, "radius_of_gyration": FIRST.radius_of_gyration}
    table["errors"] = {"tilt_gain": gain_error, "angle_bias": bias}
    return {
        "body": body, "incline": pi / 6, "contact": {"restitution": restitution}, "table": table,
        "release": {"height": FIRST.height, "theta": FIRST.theta},
    }


# A fit finds the bias of the sensor and the lean of the axis as one.
ERRORS = {
    "table.errors.tilt_gain": FIRST.gain_error, "table.errors.angle_bias": FIRST.angle_bias + FIRST.offset / FIRST.contact_distance,
    "contact.restitution": FIRST.restitution,
}
GAINS = {"x": 0.018, "theta": -1.17, "x_dot": 0.023, "theta_dot": -0.03}
CASES = [
    Case(
        "the paper's rod", Rig(theta=0.2, assumed_restitution=1.0, tilt_gain=1.1), lambda gain, gravity: rod({"tilt_gain": gain}, gravity=gravity),
        {"table.tilt_gain": 1.1, "gravity": 9.81},
    ),
    Case("the rig of this page", FIRST, rig_of_the_page, ERRORS, impacts=(20, 30, 40)),
    Case(
        "feedback of the place, and a bias",
        Rig(theta=0.2, assumed_restitution=1.0, feedback=tuple(GAINS.values()), angle_bias=0.003, gain_error=0.05),
        lambda gain_error, bias: rod({"feedback": GAINS, "errors": {"tilt_gain": gain_error, "angle_bias": bias}}),
        {"table.errors.tilt_gain": 0.05, "table.errors.angle_bias": 0.003}, ("t", "theta", "x"),
    ),
    Case(
        "friction, matched table", Rig(theta=0.1, restitution=0.8, friction=0.5, matched=True, assumed_restitution=0.8, tilt_gain=1.3),
        lambda gain, radius: rod({"tilt_gain": gain, "slide": "matched"}, 0.2, 0.1, {"restitution": 0.8, "friction": 0.5}, radius),
        {"table.tilt_gain": 1.3, "body.radius_of_gyration": Rig.radius_of_gyration}, ("t", "theta", "x"),
    ),
    Case(
        "wrong belief", Rig(theta=0.1, height=0.3, restitution=0.795, assumed_restitution=0.8, tilt_gain=1.1),
        lambda restitution, gain: rod({"tilt_gain": gain, "assumed_restitution": 0.8}, 0.3, 0.1, {"restitution": restitution}),
        {"contact.restitution": 0.795, "table.tilt_gain": 1.1},
    ),
    Case(
        "table that stands still", Rig(theta=0.01, height=0.5, restitution=0.985, tilt_gain=1.05),
        lambda restitution, gain: rod({"tilt_gain": gain, "strike": "still"}, 0.5, 0.01, {"restitution": restitution}),
        {"contact.restitution": 0.985, "table.tilt_gain": 1.05},
    ),
]
# Strikes that scatter, of which a fit does not know.
SCATTERED = [
    Case(name, replace(FIRST, **scatter), rig_of_the_page, ERRORS, impacts=(40,))
    for name, scatter in (
        ("restitution by 0.0002", {"restitution_sd": 2e-4}), ("restitution by 0.001", {"restitution_sd": 1e-3}),
        ("restitution by 0.01", {"restitution_sd": 1e-2}), ("tilt by 0.1 mrad", {"tilt_sd": 1e-4}), ("tilt by 0.5 mrad", {"tilt_sd": 5e-4}),
        ("tilt by 2 mrad", {"tilt_sd": 2e-3}),
    )
]


def request(case, number, sd_is_known, has_faults):
    """A data set with noise of its own, and first values of the unknown fields up to 5 % off; errors of the table begin at 0."""
    chance = random.Random(f"{case.name} {number}")
    seen = filmed(case.rig.impacts(case.impacts[number % len(case.impacts)], chance), case.columns, chance, 5.0)
    if has_faults:
        seen["theta"][OUTLIER] += chance.choice((-0.06, 0.06))
        seen = {name: column[:MISSED] + column[MISSED + 1 :] for name, column in seen.items()}
    first = [0 if "errors" in path else value * chance.uniform(0.95, 1.05) for path, value in case.unknown.items()]
    first = [min(value, 1.0) if path == "contact.restitution" else value for path, value in zip(case.unknown, first)]
    rounded = {name: [round(value, 5) for value in column] for name, column in seen.items()}
    sd = {name: SD[name] for name in case.columns} if sd_is_known else {}
    return {"scene": case.scene(*first), "measured": rounded, "unknown": list(case.unknown), "sd": sd}


def good_fits(requests):
    """The fits that are called good. No fit is no wrong one, and counts as not good."""
    def fit(request):
        try:
            return equipoise.fits(**request)
        except equipoise.Problem:
            return None

    with ThreadPoolExecutor(4) as pool:
        return [fit for fit in pool.map(fit, requests) if fit and fit["quality"]["kind"] == "good"]


def errors(case, fits):
    """Of each field that is told: its path, its error over its standard deviation, and True if the interval holds the true value."""
    for fit in fits:
        for estimate in fit["estimates"]:
            if estimate["identifiable"]:
                truth, (low, high) = case.unknown[estimate["field"]], estimate["interval"]
                yield estimate["field"], (estimate["value"] - truth) / estimate["sd"], low <= truth <= high


def share(part, whole):
    return f"{part} of {whole}, {100 * part / whole:.1f} %" if whole else "–"


def coverage(sets):
    """Of every other data set the standard deviations are known, and every third has a missed impact and an outlier."""
    print("| rig | unknown | called good | intervals that hold the true value | mean error over sd |\n|---|---|---|---|---|")
    all_held = all_told = 0
    for case in CASES:
        fits = good_fits([request(case, number, number % 2 == 0, number % 3 == 2) for number in range(sets)])
        found = list(errors(case, fits))
        means = {path: statistics.fmean(off for other, off, _ in found if other == path) for path in case.unknown}
        assert len(found) >= 0.8 * sets * len(case.unknown), f"{case.name}: {len(found)} estimates of {sets} data sets"
        assert all(abs(off) < 8 for _, off, _ in found), f"{case.name}: a wrong estimate is called good"
        # A fifth of a standard deviation, and three times the chance of a mean of so many.
        assert all(abs(mean) < 0.2 + 3 / sqrt(sets) for mean in means.values()), f"{case.name}: {means}"
        held = sum(holds for *_, holds in found)
        all_held, all_told = all_held + held, all_told + len(found)
        names, offs = (", ".join(each) for each in ([f"`{path}`" for path in means], [f"{mean:+.2f}" for mean in means.values()]))
        print(f"| {case.name} | {names} | {len(fits)} of {sets} | {share(held, len(found))} | {offs} |")
    print(f"| all | | | {share(all_held, all_told)} | |")
    assert 0.92 <= all_held / all_told <= 0.98, f"{all_held} of {all_told}"


def scatter(sets):
    print("| scatter of each strike | sd known: called good | their intervals that hold | sd estimated: called good | their intervals that hold |")
    print("|---|---|---|---|---|")
    for case in SCATTERED:
        cells = []
        for is_known in (True, False):
            fits = good_fits([request(case, number, is_known, False) for number in range(sets)])
            found = [holds for *_, holds in errors(case, fits)]
            cells += [f"{len(fits)} of {sets}", share(sum(found), len(found))]
        print(f"| {case.name} | {' | '.join(cells)} |")


def widths(sets):
    """Half of the 95 % interval, median of the data sets that tell the field."""
    case = CASES[1]
    print(f"| impacts | {' | '.join(f'`{path}`' for path in case.unknown)} | called good |\n|---|{'---|' * (len(case.unknown) + 1)}")
    for impacts in (6, 8, 10, 15, 20, 30, 40):
        shorter = replace(case, impacts=(impacts,))
        fits = good_fits([request(shorter, number, True, False) for number in range(sets)])
        cells = []
        for place in range(len(case.unknown)):
            intervals = [fit["estimates"][place]["interval"] for fit in fits]
            told = [(high - low) / 2 for low, high in filter(None, intervals)]
            cells.append(f"{statistics.median(told):.2g}" if 2 * len(told) > sets else "not told")
        print(f"| {impacts} | {' | '.join(cells)} | {len(fits)} of {sets} |")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scatter", action="store_true", help="rigs whose strikes scatter, instead")
    parser.add_argument("--impacts", action="store_true", help="widths of the intervals by the number of impacts, instead")
    parser.add_argument("--sets", type=int, help="data sets of each rig; 100, 20 or 11 by default")
    options = parser.parse_args()
    if options.scatter:
        scatter(options.sets or 20)
    elif options.impacts:
        widths(options.sets or 11)
    else:
        coverage(options.sets or 100)
