"""Which errors and parameters has my rig, as measured, which margins follow, and what is to be mended first?

FILE is a CSV of impacts with a header: t in s, and any of theta (rad), x_dot, y_dot, theta_dot and x, just before each impact. A header may name another
unit: `t [ms]`, `theta_deg`. Other columns are left out. --scene has the known fields and first values of the unknown ones; unknown errors begin at 0. ../fitting.md is a worked example:
    fit_my_rig.py my_rig.csv --scene my_rig.json --sd t=0.001 theta=0.002 \\
        --unknown table.errors.tilt_gain table.errors.angle_bias contact.restitution
"""

import csv
import json
import math
import re
import sys
import textwrap
import urllib.parse
import webbrowser
from pathlib import Path

from ask import arguments, ask, parse

# Correlation of two estimates that is worth a note.
CORRELATED = 0.95
UNITS = {"n": "", "t": "s", "theta": "rad", "x_dot": "m/s", "y_dot": "m/s", "theta_dot": "rad/s", "x": "m"}
# Other units that a header may name, with the factor to that of the server.
TURN = math.pi / 180
FACTORS = {
    "s": {"ms": 1e-3},
    "rad": {"mrad": 1e-3, "deg": TURN, "°": TURN},
    "rad/s": {"mrad/s": 1e-3, "deg/s": TURN, "°/s": TURN},
    "m": {"mm": 1e-3, "cm": 1e-2},
    "m/s": {"mm/s": 1e-3, "cm/s": 1e-2},
}


def opened(path):
    try:
        return path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        sys.exit(f"cannot read {path}: {getattr(error, 'strerror', None) or 'it is not text in UTF-8'}")


def heading(cell):
    """Name and unit of a column: `t [s]`, `theta (rad)`, `theta_deg`, `x_dot_mm_per_s`; the unit is empty without one."""
    found = re.fullmatch(r"\s*([^\[(]*?)\s*(?:[\[(](.*)[\])])?\s*", cell)
    name, unit = (found[1], (found[2] or "").strip()) if found else ("", "")
    for known, own in () if name in UNITS or unit else UNITS.items():
        for other in {own, *FACTORS.get(own, {})} - {""}:
            if name == f"{known}_{other.replace('/', '_per_')}":
                return known, other
    return name, unit


def columns(path):
    """The known columns of a CSV with their numbers in the units of the server; empty cells are null."""
    rows = list(csv.reader(opened(path).splitlines()))
    header = [heading(cell) for cell in rows[0]] if rows else []
    names = [name for name, _ in header]
    known = {name: [] for name in names if name in UNITS}
    if "t" not in known or len(known) < sum(name in UNITS for name in names):
        sys.exit(f"{path} has the columns {', '.join(names) or 'of an empty file'}; it needs t, the times of the impacts in s, and each name once, "
                 f"with commas between them. Known are {', '.join(UNITS)}")
    factors = {}
    for name, unit in header:
        if name in UNITS:
            factors[name] = 1 if unit in ("", UNITS[name]) else FACTORS.get(UNITS[name], {}).get(unit)
            if factors[name] is None:
                sys.exit(f"{path}: {name} is in {unit}; convert it to {UNITS[name] or 'a number without unit'}")
    for line, row in enumerate(rows[1:], 2):
        # An empty line is no impact.
        for name, cell in zip(names, row and row + [""] * (len(names) - len(row))):
            if name in known:
                try:
                    number = (int if name == "n" else float)(cell) if cell.strip() else None
                except ValueError:
                    number = math.nan
                if number is not None and not math.isfinite(number):
                    sys.exit(f"{path}, line {line}: {name} is {cell!r}, not a number")
                known[name].append(number if number is None or factors[name] == 1 else number * factors[name])
    return known


def changed(scene, path, value):
    """A scene with another value of a field, such as `table.tilt_gain`."""
    first, _, rest = path.partition(".")
    return {**scene, first: changed(scene.get(first) or {}, rest, value) if rest else value}


def held(scene, path):
    """The value of a field, None if the scene does not have it."""
    for part in path.split("."):
        scene = (scene or {}).get(part)
    return scene


def said(heading, text):
    """Prints a heading and wrapped text, its long numbers rounded."""
    short = re.sub(r"\d+\.\d{6,}(?:e-?\d+)?", lambda number: f"{float(number[0]):.5g}", text)
    print(textwrap.fill(short, 120, initial_indent=f"{heading:<14}", subsequent_indent=" " * 14))


def digits(value, sd):
    """A value with as many digits as its standard deviation lets it have."""
    return f"{value:.{max(0, 1 - math.floor(math.log10(sd)))}f}" if sd else f"{value:g}"


def judged(scene):
    """The verdict on a scene in a few words: linear margins of the tilt gain as it is set, or the reason."""
    answer = ask("stability", {"scene": scene})
    for gain in answer["margins"]:
        if gain["field"] == "table.tilt_gain" and gain["below"] and gain["above"]:
            return f"{answer['verdict']['text']}; tilt gain {gain['value']:.4g} of {gain['below']['limit']:.4f} to {gain['above']['limit']:.4f}"
    drift = answer.get("steady_drift") or {}
    if drift.get("acceleration"):
        seconds = drift["time_on_table"]
        return f"{answer['verdict']['text']}: driven aside at {drift['acceleration']:.3g} m/s²" + (f", {seconds:.1f} s on the table" if seconds else "")
    return f"{answer['verdict']['text']}: {answer['verdict']['reason']}"


parser = arguments(__doc__)
parser.add_argument("file", type=Path, help="CSV of measured impacts")
parser.add_argument("--scene", required=True, help="scene as JSON, or a file of it")
parser.add_argument("--preset", help="preset onto which the scene is merged")
parser.add_argument("--unknown", nargs="+", default=["table.tilt_gain"], metavar="PATH", help="fields of the scene to fit")
parser.add_argument("--sd", nargs="*", default=[], metavar="COLUMN=SD", help="known standard deviations; others are estimated")
parser.add_argument("--fitted", type=Path, help="file for the fitted scene, as JSON")
parser.add_argument("--picture", type=Path, help="file for the picture of the residuals, .svg or .png")
parser.add_argument("--request", type=Path, help="file for the request, as JSON; nothing is sent then")
parser.add_argument("--page", action="store_true", help="print the address of the page with the fitted scene")
parser.add_argument("--open", action="store_true", help="open it")
options = parse(parser)

scene = options.scene if options.scene.lstrip().startswith("{") else opened(Path(options.scene))
try:
    scene = json.loads(scene)
    deviations = {name: float(value) for name, value in (each.split("=") for each in options.sd)}
except json.JSONDecodeError as error:
    sys.exit(f"--scene is not JSON: {error}")
except ValueError:
    sys.exit(f"--sd {' '.join(options.sd)}: each must be a column and a number, such as t=0.001")
for path in options.unknown:
    if (path.startswith("table.errors.") or path == "body.offset") and held(scene, path) is None:
        scene = changed(scene, path, 0)
request = {"scene": scene, "measured": columns(options.file), "unknown": options.unknown, "sd": deviations}
request |= {"preset": options.preset} if options.preset else {}
if options.request:
    options.request.write_text(json.dumps(request))
    sys.exit()
fit = ask("fits", request)

said(fit["quality"]["kind"], fit["quality"]["detail"])
for estimate in fit["estimates"]:
    path, unit = estimate["field"], "" if estimate["unit"] == "1" else f" {estimate['unit']}"
    if estimate["identifiable"]:
        value, low, high = (digits(number, estimate["sd"]) for number in (estimate["value"], *estimate["interval"]))
        print(f"{'estimate':<14}{path} = {value} +- {estimate['sd']:.2g}{unit}, 95 % from {low} to {high}")
    else:
        said("not told", f"{path}: {estimate['detail']}")
for one, row in enumerate(fit["correlation"]):
    for other, correlation in enumerate(row[:one]):
        if abs(correlation or 0) > CORRELATED:
            said("note", f"{options.unknown[other]} and {options.unknown[one]} have correlation {correlation:.4f}: a known one would sharpen the other")
for note in fit["notes"]:
    said("note", note)
stability, fitted = fit["stability"], fit["scene"]
said("verdict", f"{stability['verdict']['text']}: {stability['verdict']['reason']}")
margins = [(f"{margin['field']} {side}", end["margin"], end) for margin in stability["margins"] for side in ("below", "above") if (end := margin[side])]
if spectral := stability["spectral_margin"]:
    margins.append(("1 - spectral radius", spectral["value"], spectral))
for name, value, end in margins:
    said("margin", f"{name} {value:+.4f}, in the 95 % region from {end['least']:+.4f} to {end['most']:+.4f}")
if margins:
    words = {True: "all linear margins are above 0 at its ends", False: "NOT all linear margins are above 0 at its ends", None: "no statement, see above"}
    said("region", words[stability["holds"]])

# Each fitted error mended alone, then all of them.
mended, repairs = fitted, {}
for estimate in fit["estimates"]:
    path = estimate["field"]
    repair = (path, 0) if path.startswith("table.errors.") or path == "body.offset" else None
    if path == "contact.restitution" and held(fitted, "table.assumed_restitution") is not None:
        repair = ("table.assumed_restitution", estimate["value"])
    if repair and estimate["identifiable"]:
        repairs[repair[0]] = changed(fitted, *repair)
        mended = changed(mended, *repair)
if fit["quality"]["kind"] == "good" and repairs and all(estimate["identifiable"] for estimate in fit["estimates"]):
    said("as it is", judged(fitted))
    for path, repaired in repairs.items():
        said("mended", f"{path} = {held(repaired, path):.4g}: {judged(repaired)}")
    if len(repairs) > 1:
        said("all mended", judged(mended))

if options.fitted:
    options.fitted.write_text(json.dumps(fitted, indent=2) + "\n")
    said("scene", str(options.fitted))
if options.picture:
    options.picture.write_bytes(ask("fits", request, options.picture.suffix[1:]))
    said("residuals", str(options.picture))


def query(value, path):
    """A part of a scene as a query."""
    if isinstance(value, (dict, list)):
        parts = value.items() if isinstance(value, dict) else enumerate(value)
        return [pair for name, part in parts for pair in query(part, f"{path}.{name}")]
    return [] if value is None else [(path, json.dumps(value).strip('"'))]


page = f"{options.server.rstrip('/')}/?{urllib.parse.urlencode(query(fitted, 'scene'))}"
if options.page or options.open:
    print(f"{'page':<14}{page}")
if options.open:
    webbrowser.open(page)
