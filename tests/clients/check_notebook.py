"""Runs docs/clients/examples.ipynb headless, and compares its outputs with answers of the server.

    .venv/bin/python -B check_notebook.py http://127.0.0.1:8080 ../../docs/clients
"""

import json
import os
import re
import sys
import urllib.request
from collections import Counter
from importlib.metadata import version
from pathlib import Path

import nbformat
from nbclient import NotebookClient

SERVER, FILE = sys.argv[1], Path(sys.argv[2]).resolve() / "examples.ipynb"
os.environ.update({"EQUIPOISE": SERVER, "MPLBACKEND": "module://matplotlib_inline.backend_inline"})


def got(path):
    with urllib.request.urlopen(f"{SERVER}/v1/{path}") as answer:
        return json.load(answer)


def ending(bounces, **scene):
    """The ending of a run of case 1."""
    fields = "".join(f"&scene.{name.replace('__', '.')}={value}" for name, value in scene.items())
    return got(f"trajectories?preset=case-1&bounces={bounces}{fields}")["outcome"]["kind"]


def shown(sign):
    """The lines of the only text output with a sign, each as its words."""
    [table] = [text for text in texts if sign in text]
    return [line.split() for line in table.splitlines()]


notebook = nbformat.read(FILE, as_version=4)
nbformat.validate(notebook)
assert not any(cell.get("outputs") or cell.get("execution_count") for cell in notebook.cells), "the notebook is kept without outputs"
NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(FILE.parent)}}).execute()

outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
# A warning goes to stderr.
assert all(output.output_type in ("execute_result", "display_data") or output.name == "stdout" for output in outputs), [output.get("text") for output in outputs]
texts = ["".join(output.data["text/plain"]) if "data" in output else output.text for output in outputs]
html = "".join(output.data.get("text/html", "") for output in outputs if "data" in output)

# Equation 18, over the corners of the tolerances.
corners = [1 + rho**2 / (2 * l * (0.2 - l)) for l in (0.131, 0.133, 0.135) for rho in (0.093, 0.095)]
margins = {row[0]: row[2] for row in shown("least ")[1:]}
assert abs(float(margins["least"]) - (min(corners) - 1.1)) < 1e-5 and abs(float(margins["most"]) - (max(corners) - 1.1)) < 1e-5, (margins, corners)
[aside] = re.findall(r"released at rest up to ([\d.]+) rad", "".join(texts))
lengths = {"body__contact_distance": 0.133, "body__radius_of_gyration": 0.094, "release__height": 0.2}
assert ending(1000, release__theta=float(aside) - 0.01, **lengths) == "completed", aside

# A table that only tilts holds without friction alone, a matched one with any; runs agree.
verdicts = [row for row in shown("tilt alone") if row[0][0].isdigit()]
assert len(verdicts) == 7
for friction, alone, matched, _, stick in verdicts:
    scene = {"contact__friction": friction, "release__theta": 0.05}
    assert (alone != "unstable") == (float(friction) == 0) == (ending(300, **scene) == "completed"), friction
    assert matched != "unstable" and ending(300, table__slide="matched", **scene) == "completed", friction
    assert (stick == "stable_in_place") == (float(friction) >= 0.1), (friction, stick)

# Every run of an ensemble, one by one.
[row] = [row for row in shown("lower") if row[0] == "1.20"]
noise = {"noise__timing_sd": 0.01, "noise__model": "plan", "noise__seed": 0, "table__tilt_gain": 1.2}
assert Counter(ending(400, noise__run=run, **noise) for run in range(200))["completed"] == int(row[1]), row

frame = re.search(r'src="([^"]+)"', html)[1]
asked = urllib.request.Request(frame, headers={"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Dest": "iframe", "Sec-Fetch-Mode": "navigate"})
with urllib.request.urlopen(asked) as page:
    assert page.status == 200 and page.headers.get_content_type() == "text/html", frame

run = got("trajectories?preset=rough-noise&bounces=1000")["impacts"]
[table] = [text for text in texts if "std" in text]
counts, largest = (next(line.split() for line in table.splitlines() if line.startswith(name)) for name in ("count", "max"))
assert [float(each) for each in counts[1:]] == [1000] * 4, table
for shown, name in zip(largest[1:], ("t", "x", "theta", "energy")):
    assert abs(float(shown) - max(run[name])) <= 5e-6 * max(1, abs(max(run[name]))), (name, shown, max(run[name]))

[table] = [text for text in texts if text.lstrip().startswith("0.9")]
rows = [line.split() for line in table.splitlines()[1:]]
assert len(rows) == 5 and all(len(row) == 6 for row in rows), table
gains = [0.9 + index * 0.8 / 4 for index in range(5)]
for row in rows:
    for gain, cell in zip(gains, row[1:]):
        outcome = got(f"trajectories?preset=case-1&bounces=500&scene.table.tilt_gain={gain:.17g}&scene.release.theta={float(row[0]):.17g}")["outcome"]
        # A cell on a boundary may hang on the last bit of the printed angle.
        assert int(cell) == outcome["bounces"], (gain, row[0], cell, outcome)

# The rig as it was simulated: docs/fitting.md.
[table] = [text for text in texts if "table.errors.tilt_gain" in text]
for path, truth in (("table.errors.tilt_gain", 0.04), ("table.errors.angle_bias", 0.0035), ("contact.restitution", 0.72)):
    [value, sd] = re.search(rf"^{re.escape(path)} +([\d.e+-]+) +([\d.e+-]+) ", table, re.MULTILINE).groups()
    assert abs(float(value) - truth) <= 4 * float(sd) + 1e-6, table
assert any("missed" in text and "doubled" in text for text in texts), texts
assert sum("image/png" in output.get("data", {}) for output in outputs) == 3, "three pictures"
print(f"ok    notebook: nbclient {version('nbclient')}, ipykernel {version('ipykernel')}, pandas {version('pandas')}, {len(outputs)} outputs")
