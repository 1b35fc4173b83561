"""From which friction on does my controller hold, or fail? For every law of impact.

Judges four tables, each by its verdict near upright and a run from the release: tilt alone, tilt with a table that moves along
with the contact, and state feedback designed for a contact that slips and for one that sticks.
Example: which_friction.py --preset case-1 --scene '{"release": {"theta": 0.05}}'
"""

import json

from ask import arguments, ask, parse

parser = arguments(__doc__)
parser.add_argument("--preset", default="case-1")
parser.add_argument("--scene", type=json.loads, default={"release": {"theta": 0.05}}, help="changes to the preset, as JSON")
parser.add_argument("--most", type=float, default=1.0, help="largest friction coefficient")
parser.add_argument("--points", type=int, default=13, help="coefficients tried from 0.0001 on, before each change is located")
parser.add_argument("--bounces", type=int, default=300, help="bounces to survive")
options = parse(parser)


def merged(one, other):
    """Merges a patch by RFC 7396, as the server merges a scene onto a preset."""
    return {**one, **{key: merged(one.get(key) or {}, value) if isinstance(value, dict) else value for key, value in other.items()}}


def designed(contact):
    law = ask("controllers", {"preset": options.preset, "scene": options.scene, "contact": contact})
    return {"table": {"tilt_gain": None, "feedback": law["scene"]["table"]["feedback"]}}


def judged(table, law, friction):
    """True if the controller holds the body and small deviations do not grow, and the reason."""
    scene = merged(merged(options.scene, table), {"contact": {"friction": friction, "law": law}})
    answer = ask("stability", {"preset": options.preset, "scene": scene, "bounces": options.bounces})
    verdict = answer["verdict"]
    return verdict["code"] not in ("unstable", "bounded_beyond_boundary"), verdict["reason"]


tables = {
    "tilt alone": {},
    "tilt, moving along with the contact": {"table": {"slide": "matched"}},
    "feedback designed for a contact that slips": designed("frictionless"),
    "feedback designed for a contact that sticks": designed("stick"),
}
for name, table in tables.items():
    print(f"\n{name}")
    for law in ("poisson", "newton", "stronge"):
        grid = [0.0, *(1e-4 * (options.most / 1e-4) ** (index / (options.points - 1)) for index in range(options.points))]
        holds, reason = judged(table, law, grid[0])
        print(f"  {law:8} friction 0: {'holds' if holds else 'does not hold'}")
        for low, high in zip(grid, grid[1:]):
            if judged(table, law, high)[0] == holds:
                continue
            while high - low > max(1e-5, 0.01 * high):
                middle = (low + high) / 2
                low, high = (middle, high) if judged(table, law, middle)[0] == holds else (low, middle)
            holds, reason = judged(table, law, high)
            print(f"           from {high:.5f} on: {'holds' if holds else 'does not hold'}; {reason}")
