"""Runs the lines for R and DuckDB of docs/clients/tools.md, and compares what they print with JSON answers of the server. Compares the
versions in its table of tools with those that are pinned here.

    python3 -B check_lines.py http://127.0.0.1:8080 ../../docs/clients        `duckdb` is on the path; R is optional.
"""

import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.request
from collections import Counter
from pathlib import Path

SERVER, PAGE = sys.argv[1], Path(sys.argv[2]) / "tools.md"
WRITTEN = "http://127.0.0.1:8080"
[SECTION] = re.findall(r"^## Lines for R and DuckDB\n(.*?)^## ", PAGE.read_text(), re.DOTALL | re.MULTILINE)
BLOCKS = {kind: text.replace(WRITTEN, SERVER) for kind, text in re.findall(r"^```(\w+)\n(.*?)^```$", SECTION, re.DOTALL | re.MULTILINE)}
assert set(BLOCKS) == {"r", "sh"}, BLOCKS.keys()


def got(path):
    with urllib.request.urlopen(f"{SERVER}/v1/{path}") as answer:
        return json.load(answer)


def printed(command, folder="."):
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0 and not done.stderr, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def is_near(text, number, digits):
    return math.isclose(float(text), number, rel_tol=10.0**-digits)


RUN = got("trajectories?preset=case-1&bounces=1000")["impacts"]


def r():
    with tempfile.TemporaryDirectory() as folder:
        # The last line looks at the table, with all digits.
        code = BLOCKS["r"] + 'cat(nrow(run), names(run)[1], format(max(abs(run$theta_rad)), digits = 17), is.character(run$contact_mode))\n'
        (Path(folder) / "lines.R").write_text(code)
        lines = printed(["Rscript", "lines.R"], folder).splitlines()
        assert (Path(folder) / "Rplots.pdf").read_bytes().startswith(b"%PDF"), "a plot"
    critical = got("stability?preset=case-1")["margins"][0]["above"]["limit"]
    assert is_near(lines[0].split()[1], critical, 6), lines
    rows, first, largest, is_text = lines[1].split()
    assert (rows, first, is_text) == ("1000", "n", "TRUE"), lines
    assert float(largest) == max(map(abs, RUN["theta"])), lines
    version = re.search(r"[\d.]+\d", printed(["R", "--version"]))[0]
    print(f"ok    lines: R {version}")


def duckdb():
    # `-csv` prints numbers with all digits and no frame.
    commands = [line.replace("duckdb -c", "duckdb -csv -noheader -c") for line in BLOCKS["sh"].splitlines()]
    assert len(commands) == 3, commands
    run, modes, region = ([row.split(",") for row in printed(["bash", "-o", "pipefail", "-c", command]).split()] for command in commands)
    assert int(run[0][0]) == 1000 and float(run[0][1]) == max(map(abs, RUN["theta"])), run
    juggled = Counter(got("trajectories?preset=rough-juggling&bounces=1000")["impacts"]["contact_mode"])
    assert {mode: int(count) for mode, count in modes} == juggled, (modes, juggled)
    [address] = re.findall(rf"'{re.escape(SERVER)}/v1/([^']*)&format=csv'", commands[2])
    answer = got(address)
    widest = {}
    for angle, row in zip(answer["y"], answer["values"]):
        for gain, survival in zip(answer["x"], row):
            if survival == 500:
                widest[gain] = max(angle, widest.get(gain, 0.0))
    assert {float(gain): float(angle) for gain, angle in region} == widest, (region, widest)
    assert len(widest) > 10 and len(set(widest.values())) > 3, widest
    version = re.search(r"[\d.]+\d", printed(["duckdb", "-version"]))[0]
    print(f"ok    lines: DuckDB {version}")


def versions():
    here = Path(__file__).parent
    pinned = dict(line.split("==") for line in (here / "requirements.in").read_text().split())
    for package in (here / "package.json", here / "node-red/package.json"):
        found = json.loads(package.read_text())
        pinned |= found.get("dependencies", {}) | found.get("devDependencies", {})
    [table] = re.findall(r"^\| tool \| version .*\n\|---.*\n((?:\|.*\n)+)", PAGE.read_text(), re.MULTILINE)
    # Versions of Debian are those of the machine.
    cells = [re.sub(r"[^;]* of Debian \d+", "", row.split("|")[2]) for row in table.splitlines()]
    named = [pair for cell in cells for pair in re.findall(r"([@\w/-]+) (\d[.\d]*\d)", cell)]
    assert len(named) > 20 and not (wrong := [pair for pair in named if pinned.get(pair[0]) != pair[1]]), wrong
    print(f"ok    lines: {len(named)} versions in the table of tools")


versions()
duckdb()
if shutil.which("Rscript"):
    r()
else:
    print("skip  lines: R is not installed (apt-get install r-base-core r-cran-jsonlite)")
