"""Which tilt gain does my rig have, as measured, and which margins follow?

The file is a CSV of measured impacts with a header: t in s, and any of theta (rad), x_dot, y_dot, theta_dot and x, just before each impact; other columns
are left out. Known fields and first values of the unknown ones come with --scene. Example, with the data beside this script:
    fit_my_rig.py measured.csv --unknown table.tilt_gain body.radius_of_gyration --sd t=0.001 theta=0.002
"""

import csv
import json
import re
import sys
from pathlib import Path

from ask import arguments, ask, parse

COLUMNS = ("n", "t", "theta", "x_dot", "y_dot", "theta_dot", "x")


def columns(path):
    """The known columns of a CSV; empty cells are null. A unit after the name is cut off: `t [s]`, `theta (rad)`."""
    with path.open(newline="", encoding="utf-8-sig") as file:
        rows = list(csv.reader(file))
    if not rows:
        sys.exit(f"{path} is empty")
    names = [re.sub(r"\s*[\[(].*", "", name).strip() for name in rows[0]]
    found = {name: [] for name in names if name in COLUMNS}
    if "t" not in found:
        sys.exit(f"{path} has the columns {', '.join(names)}; it needs t, the times of the impacts in s")
    for line, row in enumerate(rows[1:], 2):
        for name, cell in zip(names, row + [""] * (len(names) - len(row))):
            if name in found:
                try:
                    number = int if name == "n" else float
                    found[name].append(number(cell) if cell.strip() else None)
                except ValueError:
                    sys.exit(f"{path}, line {line}: {name} is {cell!r}, not a number")
    return found


parser = arguments(__doc__)
parser.add_argument("file", type=Path, help="CSV of measured impacts")
parser.add_argument("--unknown", nargs="+", default=["table.tilt_gain"], metavar="PATH", help="fields of the scene to fit")
parser.add_argument("--preset", default="case-1", help="the scene to begin with")
parser.add_argument("--scene", type=json.loads, default={}, help="changes of it, as JSON")
parser.add_argument("--sd", nargs="*", default=[], metavar="COLUMN=SD", help="known standard deviations; others are estimated")
parser.add_argument("--picture", type=Path, help="file for the picture of the residuals, .svg or .png")
options = parse(parser)

deviations = {}
for each in options.sd:
    name, _, value = each.partition("=")
    try:
        deviations[name] = float(value)
    except ValueError:
        sys.exit(f"--sd {each}: it must be a column and a number, such as t=0.001")
request = {
    "preset": options.preset, "scene": options.scene, "measured": columns(options.file),
    "unknown": options.unknown, "sd": deviations,
}
fit = ask("fits", request)

print(f"quality      {fit['quality']['kind']}: {fit['quality']['detail']}")
for estimate in fit["estimates"]:
    unit = "" if estimate["unit"] == "1" else f" {estimate['unit']}"
    if estimate["identifiable"]:
        low, high = estimate["interval"]
        print(f"{estimate['path']} = {estimate['value']:.6g} +- {estimate['sd']:.2g}{unit}, 95 % from {low:.6g} to {high:.6g}")
    if estimate["detail"]:
        print(f"{estimate['path']}: {estimate['detail']}")
for note in fit["notes"]:
    print(f"note         {note}")
stability = fit["stability"]
print(f"verdict      {stability['verdict']}: {stability['reason']}")
for margin in stability["margins"]:
    print(f"margin       {margin['name']} {margin['value']:+.5f} +- {margin['sd']:.2g}, in the 95 % region from {margin['least']:+.5f} to {margin['most']:+.5f}")
holds = {True: "every scene at its ends is stable", False: "NOT every scene at its ends is stable", None: "no statement; see quality and estimates"}
print(f"region       {holds[stability['holds']]}")
print(f"scene        {json.dumps(fit['scene'])}")

if options.picture:
    options.picture.write_bytes(ask("fits", request, options.picture.suffix[1:]))
    print(f"residuals    {options.picture}")
