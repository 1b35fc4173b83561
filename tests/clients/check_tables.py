"""Reads live URLs of a server as tables with pyarrow, pandas, polars and DuckDB, in every format, and compares each number with JSON.

Argument: the address of the server. Needs the Python that has these packages.
"""

import io
import json
import math
import re
import sys
import tempfile
import urllib.request
from pathlib import Path

import duckdb
import fsspec
import pandas
import polars
import pyarrow
import pyarrow.csv
import pyarrow.ipc

SERVER = sys.argv[1]
FILES = tempfile.TemporaryDirectory()
RUN = "/v1/trajectories?preset=case-1&bounces=700"
MAP = (
    "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=0.95&x.to=1.6&x.count=81"
    "&y.field=release.height&y.from=0&y.to=0.5&y.count=61&quantity=max_theta&bounces=60"
)
ENSEMBLE = "/v1/ensembles?preset=case-1-noise&runs=60&bounces=80&angles=true"


def url(path, **parameters):
    return SERVER + path + "".join(f"&{name}={value}" for name, value in parameters.items())


def got(path, **parameters):
    with urllib.request.urlopen(url(path, **parameters)) as answer:
        return answer.read()


def saved(address):
    """A file of an answer, for DuckDB, which needs an extension to read URLs."""
    with urllib.request.urlopen(address) as answer:
        return kept(answer.read(), re.search("format=([a-z]+)", address)[1])


def kept(body, ending="ndjson"):
    name = Path(FILES.name) / f"{len(list(Path(FILES.name).iterdir()))}.{ending}"
    name.write_bytes(body)
    return name


def arrow(path, **parameters):
    return pyarrow.ipc.open_stream(got(path, format="arrow", **parameters)).read_all()


def plain(values):
    """Values as Python has them, without the missing numbers of pandas."""
    return [None if value is None or value is pandas.NA or value != value else value for value in values]


def same(values, expected, name):
    values, expected = plain(values), list(expected)
    assert len(values) == len(expected), f"{name}: {len(values)} of {len(expected)} rows"
    for row, (value, other) in enumerate(zip(values, expected)):
        # Not ==, for which 0.0 is -0.0.
        equal = repr(float(value)) == repr(float(other)) if isinstance(other, (int, float)) and value is not None else value == other
        assert equal, f"{name}, row {row}: {value!r}, in JSON {other!r}"


def with_units(names, table):
    """Names of CSV for those of JSON."""
    units = {name: (table.schema.field(name).metadata or {}).get(b"unit", b"").decode() for name in names}
    written = {name: unit.replace("/", "_per_").replace("²", "2") for name, unit in units.items()}
    return {name: f"{name}_{written[name]}" if written[name] else name for name in names}


def runs():
    impacts = json.loads(got(RUN))["impacts"]
    assert len(impacts["n"]) > 100 and impacts["flight_time"][-1] is None, "a run with a null"
    table = arrow(RUN)
    assert table.schema.field("theta").metadata[b"unit"] == b"rad"
    rest = json.loads(table.schema.metadata[b"equipoise"])
    assert rest["outcome"] == json.loads(got(RUN))["outcome"] and "impacts" not in rest
    header = with_units(impacts, table)
    csv, rows = url(RUN, format="csv"), got(RUN, format="ndjson").rsplit(b"\n", 2)[0]
    at_contacts = table
    assert duckdb.sql("select count(*) from at_contacts").fetchall()[0][0] == len(impacts["n"])
    frames = {
        "pyarrow, Arrow": table,
        "pandas, Arrow": table.to_pandas(),
        "polars, Arrow": polars.read_ipc_stream(got(RUN, format="arrow")),
        "DuckDB, Arrow": duckdb.arrow(table).arrow().read_all(),
        "pandas, CSV": pandas.read_csv(csv),
        "polars, CSV": polars.read_csv(csv),
        "pyarrow, CSV": pyarrow.csv.read_csv(io.BytesIO(got(RUN, format="csv"))),
        "DuckDB, CSV": duckdb.sql(f"select * from read_csv('{saved(csv)}')").arrow().read_all(),
        "pandas, NDJSON": pandas.read_json(io.BytesIO(rows), lines=True, precise_float=True),
        "polars, NDJSON": polars.read_ndjson(io.BytesIO(rows)),
        "DuckDB, NDJSON": duckdb.sql(f"select * from read_json('{kept(rows)}')").arrow().read_all(),
    }
    for program, frame in frames.items():
        for name, expected in impacts.items():
            column = frame[header[name] if program.endswith("CSV") else name]
            values = column.to_pylist() if hasattr(column, "to_pylist") else column.to_list()
            same([None if value == "" else value for value in values], expected, f"{program}: {name}")
    print(f"{len(frames)} ways to read {len(impacts['n'])} impacts of {len(impacts)} columns")


def parts():
    """polars asks for the length, then for ranges; a map is streamed for others."""
    for path in (RUN, MAP):
        whole = got(path, format="csv")
        request = urllib.request.Request(url(path, format="csv"), method="HEAD")
        with urllib.request.urlopen(request) as head:
            assert int(head.headers["Content-Length"]) == len(whole) and head.headers["Accept-Ranges"] == "bytes"
        with fsspec.open(url(path, format="csv"), block_size=4096) as file:
            file.seek(len(whole) - 300)
            assert file.read() == whole[-300:], "a part by fsspec"
    assert polars.scan_csv(url(MAP, format="csv")).select(polars.len()).collect().item() == 81 * 61


def maps():
    whole = json.loads(got(MAP))
    values = [value for row in whole["values"] for value in row]
    assert None in values, "a cell that cannot be"
    names = [name for row in whole["outcomes"] for name in (whole["outcome_names"][code] for code in row)]
    table = arrow(MAP)
    for program, frame in {"pyarrow": table, "polars": polars.read_ipc_stream(got(MAP, format="arrow"))}.items():
        same(frame["max_theta"].to_pylist() if program == "pyarrow" else frame["max_theta"].to_list(), values, program)
        same(frame["outcome"].to_pylist() if program == "pyarrow" else frame["outcome"].to_list(), names, program)
        same(frame["release.height"].to_pylist() if program == "pyarrow" else frame["release.height"].to_list(),
             [y for y in whole["y"] for _ in whole["x"]], program)
    cells = table
    counted = duckdb.sql("select outcome, count(*) from cells group by outcome").fetchall()
    assert dict(counted) == {name: count for name, count in whole["counts"].items() if count}, counted
    print(f"{len(values)} cells of a map")


def ensembles():
    whole, table = json.loads(got(ENSEMBLE)), arrow(ENSEMBLE)
    at = {n: angles for n, angles in zip(whole["quantiles"]["n"], whole["angles"])}
    for n, angles in enumerate(table["abs_theta"].to_pylist(), 1):
        assert angles == at.get(n), n
    frame = polars.read_ipc_stream(got(ENSEMBLE, format="arrow"))
    medians = {n: median for n, median in zip(whole["quantiles"]["n"], whole["quantiles"]["q50"])}
    same(frame["abs_theta_q50"].to_list(), [medians.get(n) for n in range(1, frame.height + 1)], "medians of |θ|")
    print(f"{len(at)} contacts with the angles of an ensemble")


runs()
parts()
maps()
ensembles()
