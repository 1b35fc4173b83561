"""Runs docs/clients/jupyter/rig.ipynb headless, and compares its outputs with answers of the server.

    .venv/bin/python -B check_notebook.py http://127.0.0.1:8080 ../../docs/clients
"""

import json
import os
import re
import sys
import urllib.request
from importlib.metadata import version
from pathlib import Path

import nbformat
from nbclient import NotebookClient

SERVER, FILE = sys.argv[1], Path(sys.argv[2]).resolve() / "jupyter" / "rig.ipynb"
os.environ.update({"EQUIPOISE": SERVER, "MPLBACKEND": "module://matplotlib_inline.backend_inline"})


def got(path):
    with urllib.request.urlopen(f"{SERVER}/v1/{path}") as answer:
        return json.load(answer)


notebook = nbformat.read(FILE, as_version=4)
nbformat.validate(notebook)
assert not any(cell.get("outputs") or cell.get("execution_count") for cell in notebook.cells), "the notebook is kept without outputs"
NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(FILE.parent)}}).execute()

outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
# A warning goes to stderr.
assert all(output.output_type in ("execute_result", "display_data") for output in outputs), [output.get("text") for output in outputs]
texts = ["".join(output.data["text/plain"]) for output in outputs]
html = "".join(output.data.get("text/html", "") for output in outputs)

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
assert sum("image/png" in output.data for output in outputs) == 3, "three pictures"
print(f"ok    notebook: nbclient {version('nbclient')}, ipykernel {version('ipykernel')}, pandas {version('pandas')}, {len(outputs)} outputs")
