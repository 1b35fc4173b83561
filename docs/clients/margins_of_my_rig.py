"""Is my rig stable, by which margins over the tolerances of its parts, and what does the table have to do?

Lengths in metres, angles in radians. Example: 0.133 +- 0.002 m from the centre of gravity to the contact, radius of gyration 0.094 +- 0.001 m:
    margins_of_my_rig.py --lengths 0.133 0.094 --tilt-gain 1.1 --off-distance 0.002 --off-gyration 0.001
For a polygon of uniform density instead:  --polygon "0,0 0.05,0.2 -0.05,0.2"
"""

import math

from ask import arguments, ask, parse

parser = arguments(__doc__)
body = parser.add_mutually_exclusive_group(required=True)
body.add_argument("--lengths", nargs=2, type=float, metavar=("L", "RHO"), help="centre of gravity to contact point; radius of gyration")
body.add_argument("--polygon", metavar="'X,Y X,Y …'", help="corners, counter-clockwise; the lowest one bounces")
parser.add_argument("--tilt-gain", type=float, required=True, help="the table tilts by this times the body's angle")
parser.add_argument("--height", type=float, default=0.2, help="release, of the centre of gravity above its height at contact with a flat table")
parser.add_argument("--theta", type=float, default=0.1, help="angle of release")
parser.add_argument("--restitution", type=float, default=1.0)
parser.add_argument("--incline", type=float, default=math.pi / 2, help="of the plane of motion; upright is pi/2")
parser.add_argument("--energy-gain", type=float, default=0.0, help="in s2/m2; steers the bounce to --height")
parser.add_argument("--off-distance", type=float, default=0.0, help="tolerance of the first length")
parser.add_argument("--off-gyration", type=float, default=0.0, help="tolerance of the second")
parser.add_argument("--off-restitution", type=float, default=0.0, help="tolerance of the restitution; needs an energy gain")
options = parse(parser)

if options.lengths:
    shape = dict(zip(("contact_distance", "radius_of_gyration"), options.lengths))
else:
    shape = {"vertices": [[float(number) for number in corner.split(",")] for corner in options.polygon.split()]}
table = {"tilt_gain": options.tilt_gain, "energy_gain": options.energy_gain}
scene = {
    "body": shape, "incline": options.incline, "contact": {"restitution": options.restitution},
    "table": table | ({"target_height": options.height} if options.energy_gain else {}),
    "release": {"height": options.height, "theta": options.theta},
}
off = {"body.contact_distance": options.off_distance, "body.radius_of_gyration": options.off_gyration, "contact.restitution": options.off_restitution}
tolerances = [{"field": field, "tolerance": tolerance} for field, tolerance in off.items()]
answer = ask("stability", {"scene": scene, "tolerances": tolerances, "basin": True, "bounces": 1000})

print(f"verdict      {answer['verdict']['text']}: {answer['verdict']['reason']}")
basin, run, over = answer["basin"], answer["nonlinear"], answer["over_tolerances"]
[gain] = [margin for margin in answer["margins"] if margin["field"] == "table.tilt_gain"] or [None]
if gain and gain["below"] and gain["above"]:
    value, below, above = gain["value"], gain["below"], gain["above"]
    print(f"tilt gain    {value:g}, stable from {below['limit']:g} to {above['limit']:.5f}:",
          f"{below['margin']:+.5f} and {above['margin']:+.5f} to spare")
    if above["least"] is not None:
        print(f"tolerances   {'every' if over['holds'] else 'NOT EVERY'} body within them is stable: the upper end is from",
              f"{value + above['least']:.5f} to {value + above['most']:.5f}, {above['least']:+.5f} to spare at worst")
if not gain or not gain["above"] or gain["above"]["least"] is None:
    print(f"tolerances   no margin: {over['reason']}")
if basin:
    print(f"release      at rest up to {basin['unbroken']:.3f} rad aside survives {basin['bounces']} bounces, in steps of {basin['spacing']:.4f} rad")
if run:
    demand = run["demand"]
    print(f"this run     {run['outcome']['detail']}")
    print(f"the table    tilts to {demand['tilt']:.3f} rad at {demand['tilt_rate']:.2f} rad/s,",
          f"moves at {demand['speed']:.3f} m/s over {demand['stroke']:.4f} m")
