"""First steps: the verdict on the paper's first case with its margins, a run as columns, and a picture of it.

Start a server, then `python3 quickstart.py`. It needs only Python 3.9 or newer.
"""

from pathlib import Path

from ask import arguments, ask, parse

parser = arguments(__doc__.splitlines()[0])
parser.add_argument("--preset", default="case-1", help="a case of the paper; /v1/scenes lists them")
parser.add_argument("--picture", type=Path, default=Path("run.svg"), help="file for the picture, .svg or .png")
options = parse(parser)

# The verdict: is it balanced, for which reason, and by which margins?
stability = ask("stability", {"preset": options.preset})
print(f"{options.preset}: {stability['verdict']['text']}\n  {stability['verdict']['reason']}")
for margin in stability["margins"]:
    for side in ("below", "above"):
        if end := margin[side]:
            print(f"  {margin['field']} {margin['value']}: {end['margin']:.4f} to the limit {side}, {end['limit']:.4f}")

# A preset with one change, and its run as columns: pandas.DataFrame(run["impacts"]) is a data frame.
run = ask("trajectories", {"preset": options.preset, "scene": {"release": {"height": 0.25}}, "bounces": 10})
columns = run["impacts"]
print(f"\nReleased at 0.25 m instead: {run['outcome']['detail']}\n{'n':>3} {'t [s]':>9} {'θ [rad]':>9} {'ẏ [m/s]':>9} {'error':>8}")
for n, t, theta, y_dot, error in zip(columns["n"], columns["t"], columns["theta"], columns["y_dot"], columns["error_estimate"]):
    print(f"{n:3} {t:9.5f} {theta:9.5f} {y_dot:9.5f} {'' if error is None else format(error, '.0e'):>8}")

# The server draws the picture.
options.picture.write_bytes(ask("trajectories", {"preset": options.preset, "bounces": 300}, options.picture.suffix[1:]))
print(f"\nThe phase planes of 300 impacts: {options.picture}")
