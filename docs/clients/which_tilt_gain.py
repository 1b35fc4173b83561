"""Which tilt gain should I set? Scans it over release angles without noise and over repeated runs with it, and recommends one.

Candidates are the gains close to the best survival under noise (their 95 % intervals overlap). Of these it recommends the one with the
widest release angle. Example: which_tilt_gain.py --preset case-1 --timing-sd 0.01

A lab has the model "plan": a table that is late carries out the plan made for the wrong time. The paper's noise is "strike": the table meets
the body wherever it then is. It survives far more often.
"""

import json

from ask import arguments, ask, ask_many, parse, said

parser = arguments(__doc__)
parser.add_argument("--preset", default="case-1")
parser.add_argument("--scene", type=json.loads, default={}, help='changes to the preset, as \'{"release": {"height": 0.3}}\'')
parser.add_argument("--timing-sd", type=float, default=0.01, help="standard deviation of the time of the strike, in s")
parser.add_argument("--model", choices=["strike", "plan"], default="plan", help="behaviour of a late table: carry out its plan, as a real one does, or strike the body where it then is, as in the paper")
parser.add_argument("--gains", type=int, default=16, help="number of tilt gains")
parser.add_argument("--bounces", type=int, default=400, help="bounces to survive")
parser.add_argument("--runs", type=int, default=200, help="runs with noise for each gain")
options = parse(parser)

verdict = ask("stability", {"preset": options.preset, "scene": options.scene, "bounces": 1})
[gain] = [margin for margin in verdict["margins"] if margin["field"] == "table.tilt_gain"] or [None]
if not gain or not gain["below"] or not gain["above"]:
    raise SystemExit(f"no tilt gain to choose: {verdict['verdict']['reason']}")
lower, upper = gain["below"]["limit"], gain["above"]["limit"]
step = (upper - lower) / (options.gains + 1)
x = {"field": "table.tilt_gain", "from": lower + step, "to": upper - step, "count": options.gains}
y = {"field": "release.theta", "from": 0.01, "to": 0.6, "count": 60}
region = ask("regions", {"preset": options.preset, "scene": options.scene, "x": x, "y": y, "bounces": options.bounces})
survives = region["outcome_names"].index("completed")

print(f"stable without noise, near upright: {lower:g} to {upper:.5f};",
      f"timing {options.timing_sd * 1000:g} ms ({options.model}), {options.runs} runs of {options.bounces} bounces")
print(f"{'gain':>8} {'widest release':>15} {'survive noise':>14} {'95 %':>15}")
rows, noisy = [], []
for value in region["x"]:
    noise = {"timing_sd": options.timing_sd, "model": options.model}
    scene = {**options.scene, "table": {**options.scene.get("table", {}), "tilt_gain": value}, "noise": noise}
    noisy.append({"preset": options.preset, "scene": scene, "runs": options.runs, "bounces": options.bounces, "seed": 1})
for column, (value, (ensemble, problem)) in enumerate(zip(region["x"], ask_many("ensembles", noisy))):
    if problem:
        raise SystemExit(said(problem))
    angle = 0.0
    for theta, outcomes in zip(region["y"], region["outcomes"]):
        if outcomes[column] != survives:
            break
        angle = theta
    rows.append((value, angle, ensemble["survived"]))
    print(f"{value:8.4f} {angle:11.2f} rad {rows[-1][2]['share']:13.1%} {rows[-1][2]['lower']:7.1%}-{rows[-1][2]['upper']:.1%}")

best = max(rows, key=lambda row: row[2]["share"])[2]
close = [row for row in rows if row[2]["upper"] >= best["lower"]]
value, angle, survived = max(close, key=lambda row: (row[1], row[2]["share"]))
print(f"\nrecommended: {value:.4f}. {survived['share']:.1%} survive the noise, as good as the best ({best['share']:.1%}) with {options.runs} runs;")
print(f"  of the {len(close)} gains of which that is so, it may be released the furthest aside: {angle:.2f} rad.")
print(f"  It is {value - lower:.4f} above the lower end and {upper - value:.4f} below the upper one.")
if best["share"] == 0:
    print("  But no gain survives this noise: the timing has to be better first.")
