"""A live run in the Rerun viewer: every number of an impact over its time, and the body as it strikes.

    pip install ../.. rerun-sdk && python3 rerun_live.py --query 'preset=case-1&speed=2'   # opens the viewer
    python3 rerun_live.py --query 'preset=case-1' --bounces 100 --save run.rrd             # writes a file for `rerun run.rrd`
"""

import math

import rerun as rr
from live import arguments, messages

parser = arguments(__doc__.splitlines()[0])
parser.add_argument("--save", help="write a recording to this file; otherwise open a viewer")
options = parser.parse_args()

rr.init("equipoise")
if options.save:
    rr.save(options.save)
else:
    rr.spawn()
length = None
for message in messages(options.server, options.query, options.bounces):
    if message["type"] == "hello":
        length = message["derived"]["contact_distance"]
        rr.log("scene", rr.AnyValues(url=message["url"], build=message["build"]), static=True)
    elif message["type"] == "impact":
        rr.set_time("time", timestamp=message["time_ms"] / 1e3)
        rr.set_time("run", duration=message["t"])
        rr.set_time("impact", sequence=message["n"])
        for name, value in message.items():
            if isinstance(value, float):
                rr.log(f"impact/{name}", rr.Scalars(value))
        rr.log("contact_mode", rr.TextLog(message["contact_mode"] or "no strike"))
        # The line from the contact point to the centre of gravity. In Rerun y points down.
        x, theta, foot = message["x"], message["theta"], -message["clearance"]
        body = [(x + length * math.sin(theta), foot), (x, foot - length * math.cos(theta))]
        rr.log("body", rr.LineStrips2D([body], radii=0.002))
    elif message["type"] == "end":
        rr.log("end", rr.TextLog(message["outcome"]["detail"]))
rr.disconnect()
