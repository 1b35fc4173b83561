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
off = {"contact_distance": options.off_distance, "radius_of_gyration": options.off_gyration, "restitution": options.off_restitution}
answer = ask("stability", {"scene": scene, "tolerances": off, "basin": True, "impacts": 1000})

print(f"verdict      {answer['verdict']}: {answer['reason']}")
linear, margins, basin, run = answer["linear"], answer["margins"], answer["basin"], answer["nonlinear"]
if linear and linear["tilt_gain"]:
    gain = linear["tilt_gain"]
    print(f"tilt gain    {gain['value']:g}, stable from {gain['lower']:g} to {gain['critical']:.5f}:",
          f"{gain['margin_below']:+.5f} and {gain['margin_above']:+.5f} to spare")
if margins["tilt_gain"]:
    span = margins["tilt_gain"]["critical"]
    print(f"tolerances   {'every' if margins['holds'] else 'NOT EVERY'} body within them is stable: the upper end is from",
          f"{span['least']:.5f} to {span['most']:.5f}, {margins['tilt_gain']['margin_above']:+.5f} to spare at worst")
else:
    print(f"tolerances   no margin: {margins['reason']}")
if basin:
    print(f"release      at rest up to {basin['unbroken']:.3f} rad aside survives {basin['impacts']} bounces, in steps of {basin['spacing']:.4f} rad")
if run:
    demand = run["demand"]
    print(f"this run     {run['detail']}")
    print(f"the table    tilts to {demand['tilt']:.3f} rad at {demand['tilt_rate']:.2f} rad/s,",
          f"moves at {demand['speed']:.3f} m/s over {demand['stroke']:.4f} m")
