"""Bytes of a run of 100,000 impacts in every format, and the times that clients take to parse them, as ratios to JSON.

`tests/clients/run formats` prints the part of docs/measurements.md that `benches/run formats` writes.

Argument: the address of a server. Needs the Python of tests/clients.
"""

import gzip
import io
import json
import os
import statistics
import sys
import time
import urllib.request
from pathlib import Path

import pandas
import polars
import pyarrow
import pyarrow.csv
import pyarrow.ipc

SERVER = sys.argv[1]
IMPACTS, REPEATS = 100_000, 5
RUN = f"/v1/trajectories?preset=case-1&bounces={IMPACTS}"


def got(form, encoding):
    """The body, and the time until its last byte, s. Asked for anew each time: so long an answer is not kept."""
    request = urllib.request.Request(f"{SERVER}{RUN}&{form}", headers={"Accept-Encoding": encoding})
    begun = time.perf_counter()
    with urllib.request.urlopen(request) as answer:
        body = answer.read()
        assert (answer.headers.get("Content-Encoding") or "identity") == encoding
    return body, time.perf_counter() - begun


def rows(body):
    """NDJSON without its last line, which is no row."""
    return body.rsplit(b"\n", 2)[0]


def median(work):
    """Median time of some repeats, s."""
    times = []
    for _ in range(REPEATS):
        begun = time.perf_counter()
        found = work()
        times.append(time.perf_counter() - begun)
        del found
    return statistics.median(times)


FORMS = {
    "JSON": ("format=json", {
        "Python": json.loads,
        "pandas": lambda body: pandas.DataFrame(json.loads(body)["impacts"]),
        "polars": lambda body: polars.DataFrame(json.loads(body)["impacts"]),
    }),
    "CSV": ("format=csv", {
        "pandas": lambda body: pandas.read_csv(io.BytesIO(body)),
        "polars": lambda body: polars.read_csv(io.BytesIO(body)),
        "pyarrow": lambda body: pyarrow.csv.read_csv(io.BytesIO(body)),
    }),
    "NDJSON": ("format=ndjson", {
        "Python": lambda body: [json.loads(line) for line in rows(body).splitlines()],
        "pandas": lambda body: pandas.read_json(io.BytesIO(rows(body)), lines=True, precise_float=True),
        "polars": lambda body: polars.read_ndjson(io.BytesIO(rows(body))),
    }),
    "Arrow": ("format=arrow", {
        "pandas": lambda body: pyarrow.ipc.open_stream(body).read_all().to_pandas(),
        "polars": polars.read_ipc_stream,
        "pyarrow": lambda body: pyarrow.ipc.open_stream(body).read_all(),
    }),
}


def ratio(value):
    return f"{value:.2g}" if value >= 1e-4 else f"{value:.6f}"


def cpu():
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    names = [line.split(": ", 1)[1] for line in lines if line.startswith("model name")]
    return f"{len(names)} cores of an {names[0]}" if names else "a machine that does not tell its CPU"


def main():
    rows, unit, whole = [], None, None
    for name, (form, readers) in FORMS.items():
        answers = [got(form, "identity") for _ in range(REPEATS)]
        body = answers[0][0]
        assert all(other == body for other, _ in answers), f"{name}: the bytes differ"
        sent = statistics.median(time for _, time in answers)
        packed = got(form, "gzip")[0]
        assert gzip.decompress(packed) == body
        times = {program: median(lambda: read(body)) for program, read in readers.items()}
        if unit is None:
            unit, whole = times["Python"], sent
            seconds = f"{unit * 1e3:.0f} ms"
        parsed = {program: ratio(time / unit) for program, time in times.items()}
        cells = [f"{len(body) / 1e6:.1f}", f"{len(packed) / 1e6:.1f}", f"{sent / whole:.2g}"]
        cells += [parsed.get(program, "") for program in ("Python", "pandas", "polars", "pyarrow")]
        rows.append(f"| {name} | " + " | ".join(cells) + " |")
    build = os.path.basename(os.path.dirname(os.environ.get("EQUIPOISE", "")))
    print(f"""Written by `benches/run formats` on a virtual machine with {cpu()}, with pandas {pandas.__version__},
polars {polars.__version__} and pyarrow {pyarrow.__version__}{", and a debug build of the server" if build == "debug" else ""}. {IMPACTS:,} impacts; times are medians of {REPEATS}, over that of
Python's `json.loads` ({seconds} here), or of JSON from request to last byte.

| format | MB | MB, gzip | request to last byte | Python | pandas | polars | pyarrow |
|---|---|---|---|---|---|---|---|
""" + "\n".join(rows))


main()
