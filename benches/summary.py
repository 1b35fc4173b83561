"""Writes the table "Before and after" of docs/speed.md from what the benchmarks printed. Called by benches/run.

A row whose benchmark was not run keeps its value.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
BEGIN, END = "<!-- begin: before and after -->", "<!-- end: before and after -->"

# Name, command, value before, target.
ROWS = [
    ("requests per second over those of a bare handler: `trajectories`, 100 impacts, asked for again", "http", "0.12", "≥ 0.6"),
    ("the same, `stability`", "http", "0.02", "≥ 0.6"),
    ("the same, `scenes`", "http", "0.10", "≥ 0.6"),
    ("the same, `controllers`", "http", "0.10", "≥ 0.6"),
    ("the same, `/health/live`", "http", "0.48", "≥ 0.8"),
    ("the same, `/`", "http", "0.54", "≥ 0.8"),
    ("the same, `trajectories`, 100 impacts, computed each time", "http", "0.12", "≥ 0.25"),
    ("an impact with its error estimate, over its bounce", "bounce", "8.5", "≤ 2.5"),
    ("stability, 2000 impacts, µs of a core", "bounce", "400", "≤ 200"),
    ("cost of a cell over the rod's, all runs survive: point mass", "cost", "18", "≤ 0.8"),
    ("the same, state feedback", "cost", "15", "≤ 1.5"),
    ("the same, triangle", "cost", "14", "≤ 2.5"),
    ("the same, noise", "cost", "23", "≤ 4"),
    ("a bounce in lanes over the bare loop, AVX-512", "lanes", "1.6", "≤ 1.2"),
    ("the same, AVX2", "lanes", "1.3", "≤ 1.2"),
    ("a survival map of 256 × 256 × 1000 as PNG, over bare loops on all cores", "lanes", "1.77", "≤ 1.4"),
]


def http(text):
    ratio = lambda name: re.search(rf"^{re.escape(name)}: .*ratio (\S+)", text, re.M)
    paths = ["/v1/trajectories?preset=case-1&impacts=100", "/v1/stability?preset=case-1", "/v1/scenes",
             "/v1/controllers?preset=case-1", "/health/live", "/", "computed each time, beside the bytes from memory"]
    return [found and found[1] for found in map(ratio, paths)]


def bounce(text):
    estimate = re.search(r"over the bounce: (\S+)", text)
    verdict = re.search(r"verdict over .*, (\S+) µs", text)
    return [found and found[1] for found in (estimate, verdict)]


def lanes(text):
    sweep = lambda path: re.search(rf"^{path}, \|θ\| ≤ 0.03: sweep .*ratio (\S+)", text, re.M)
    whole = re.search(r"^256 × 256 × 1000 survival as PNG: .*ratio (\S+)", text, re.M)
    return [found and found[1] for found in (sweep("Avx512"), sweep("Avx2"), whole)]


def cost(text):
    def rate(name):
        found = re.search(rf"^\| {name} \| \d+ \| survival \| ([\d,]+) \|", text, re.M)
        return found and float(found[1].replace(",", ""))

    rod = rate("rod, all of whose runs survive")
    names = ["point mass", "state feedback, all of whose runs survive", "polygon, a triangle, all of whose runs survive",
             "small noise, all of whose runs survive"]
    return [rod and rate(name) and f"{rod / rate(name):.2f}" for name in names]


def main():
    page, results = ROOT / "docs/speed.md", pathlib.Path(sys.argv[1])
    text = page.read_text()
    begin, end = text.index(BEGIN), text.index(END)
    known = dict(re.findall(r"^\| (.*?) \| .* \| (\S+) \| `cargo", text[begin:end], re.M))
    found = {}
    for part, read in {"http": http, "bounce": bounce, "lanes": lanes, "cost": cost}.items():
        file = results / f"{part}.txt"
        values = read(file.read_text()) if file.exists() else []
        names = [name for name, command, *_ in ROWS if command == part]
        found |= {name: value for name, value in zip(names, values) if value}
    lines = [BEGIN, "", "| | before | target | now | |", "|---|---|---|---|---|"]
    for name, command, before, target in ROWS:
        now = found.get(name, known.get(name, "–"))
        lines.append(f"| {name} | {before} | {target} | {now} | `cargo bench --bench {command}` |")
    page.write_text(text[:begin] + "\n".join(lines) + "\n\n" + text[end:])


main()
