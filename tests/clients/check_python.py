"""Tests of the package equipoise: answers, errors, data frames, pictures, live runs, types, and that servers end with their processes.

The servers are those of the program in EQUIPOISE; files go to the folder in MADE. Without pyarrow it tests what needs no other package.
"""

import contextlib
import copy
import importlib.util
import io
import json
import os
import pickle
import signal
import subprocess
import sys
import time
import urllib.request
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import equipoise

ALONE = importlib.util.find_spec("pyarrow") is None
NO_PROXY = urllib.request.build_opener(urllib.request.ProxyHandler({}))
AXES = {"x": {"field": "table.tilt_gain", "from": 1, "to": 1.6, "count": 4}, "y": {"field": "release.theta", "from": 0, "to": 0.5, "count": 3}}


def refused(call, **request):
    try:
        call(**request)
    except equipoise.Problem as problem:
        return problem
    raise AssertionError(f"{request} is not refused")


def answers():
    """Every example of the contract, by the package and by a plain request."""
    server = equipoise.server()
    with NO_PROXY.open(f"{server.url}/openapi.json") as contract:
        operations = {path: item["post"] for path, item in json.load(contract)["paths"].items() if "post" in item and "{" not in path}
    assert [path.split("/")[-1].replace("-", "_") for path in operations] == list(equipoise._resources.RESOURCES)
    for path, operation in operations.items():
        name = path.split("/")[-1].replace("-", "_")
        request = next(iter(operation["requestBody"]["content"]["application/json"]["examples"].values()))["value"]
        call = urllib.request.Request(server.url + path, json.dumps(request).encode(), {"Content-Type": "application/json"})
        with NO_PROXY.open(call) as answer:
            body = answer.read()
        given = getattr(equipoise, name)(**request)
        # Times of methods differ from request to request.
        assert name == "precision" or given == json.loads(body) and given.read("json") == body, name
        assert given == given.json and type(given.json) is dict, name
        picture = given._repr_svg_()
        assert (picture is not None) == (equipoise._resources.RESOURCES[name].picture and name != "periodic_orbits"), name
        assert not picture or ElementTree.fromstring(picture).tag.endswith("svg"), name
        assert repr(given).startswith(f"<{name}: ") and len(getattr(equipoise, name).__doc__) > 100
        if not ALONE and "application/vnd.apache.arrow.stream" in str(operation) and name != "previews":
            assert given.to_arrow().num_rows == len(given.to_pandas()) == given.to_polars().height > 0, name


def requests():
    table, release = {"tilt_gain": 1.2}, {"theta": 0.1}
    whole = equipoise.stability(preset="case-1", scene={"table": table, "release": release})
    assert equipoise.stability(preset="case-1", table=table, release=release) == whole
    assert equipoise.stability(preset="case-1", scene={"table": table}, release=release) == whole
    # The scene of an answer, with a change.
    steeper = equipoise.stability(scene=whole.scene, table={"tilt_gain": 1.55})
    assert steeper.verdict.code == "unstable" and steeper.scene.release.theta == 0.1 and whole["scene"].table.tilt_gain == 1.2
    changed = copy.deepcopy(whole.scene)
    changed.table.tilt_gain = 1.55
    assert equipoise.stability(scene=changed) == steeper and "verdict" in dir(steeper)
    assert equipoise.controllers(preset="case-1", contact="stick").contact == "stick"
    assert pickle.loads(pickle.dumps(whole)) == whole
    assert equipoise.get("scenes/case-1").name == "case-1"
    try:
        print(whole.verdicts)
        raise SystemExit("an attribute that is not there")
    except AttributeError as error:
        assert "there is no verdicts; there are scene, " in str(error), error


def errors():
    problem = refused(equipoise.stability, preset="case-1", table={"tilt_gain": 1000}, bounces=0)
    assert problem.status == 422 and [error.field for error in problem.errors] == ["scene.table.tilt_gain", "bounces"]
    assert problem.errors[0].detail == "tilt_gain is 1000; it must be from -100 to 100 (no unit)" and problem.errors[0].detail in str(problem)
    assert pickle.loads(pickle.dumps(problem)).errors == problem.errors
    assert refused(equipoise.trajectories, preset="case-1", bounce=3).errors[0].field == "bounce"
    assert "json, csv, ndjson, arrow" in refused(equipoise.ladder(preset="case-1").read, form="svg").detail
    assert refused(lambda **request: next(equipoise.live(**request)), preset="case-1", speed=0).errors[0].field == "speed"
    for program, wanted in (("/missing", RuntimeError), (sys.executable, RuntimeError)):
        with contextlib.suppress(wanted):
            equipoise.Server(program=program, arguments=["--wrong"])
            raise SystemExit(f"{program} is no server")
    with contextlib.suppress(ConnectionError):
        equipoise.Server("http://127.0.0.1:1").stability(preset="case-1")
        raise SystemExit("a server where there is none")


def tables():
    run = equipoise.trajectories(preset="case-1", bounces=50, samples_per_flight=3)
    assert len(run.impacts.theta) == 50 and isinstance(run.impacts.theta, list)
    if ALONE:
        with contextlib.suppress(ImportError):
            run.impacts.to_pandas()
            raise SystemExit("a data frame without pandas")
        return
    import pandas
    from IPython.core.formatters import DisplayFormatter

    shown = DisplayFormatter().format(run)[0]
    assert sorted(shown) == ["image/svg+xml", "text/plain"] and shown["text/plain"] == repr(run), shown
    for columns in (run.impacts, run.flights):
        frames = columns.to_pandas().to_dict("list"), columns.to_polars().to_dict(as_series=False), columns.to_arrow().to_pydict()
        assert all(repr(frame["t"]) == repr(columns.t) and list(frame) == list(columns) for frame in frames)
    assert run.impacts.to_arrow().schema.field("theta").metadata[b"unit"] == b"rad"
    cells = equipoise.regions(preset="case-1", bounces=50, **AXES).to_pandas()
    assert list(cells) == ["table.tilt_gain", "release.theta", "survival", "outcome"] and len(cells) == 12
    # Columns of every kind are measured impacts.
    sent = {"preset": "case-1", "unknown": ["table.tilt_gain"], "sd": {"t": 1e-3, "theta": 1e-3}}
    fits = [equipoise.fits(measured=each, **sent) for each in (
        {"t": run.impacts.t, "theta": run.impacts.theta},
        run.impacts.to_pandas()[["t", "theta"]],
        run.impacts.to_polars()[["t", "theta"]],
        run.impacts.to_arrow().select(["t", "theta"]),
        {name: pandas.Series(run.impacts[name]).to_numpy() for name in ("t", "theta")},
    )]
    assert all(fit == fits[0] for fit in fits) and abs(fits[0].estimates[0].value - 1.1) < 1e-3


def files():
    run, folder = equipoise.trajectories(preset="case-1", bounces=20), Path(os.environ["MADE"])
    for name, begin in (("run.svg", b"<svg"), ("run.png", b"\x89PNG"), ("run.csv", b"n,t_s,")):
        run.save(folder / name)
        assert (folder / name).read_bytes().startswith(begin), name


def live():
    run = equipoise.trajectories(preset="case-1", bounces=12)
    messages = equipoise.live(preset="case-1", speed=20)
    assert next(messages).type == "hello"
    seen = [next(messages) for _ in range(12)]
    assert [message.theta for message in seen] == run.impacts.theta and [message.n for message in seen] == run.impacts.n
    messages.close()
    # Connections that break are a test of the bridges.
    end = equipoise.trajectories(preset="still-lossy", bounces=100_000)
    told = list(equipoise.live(preset="still-lossy", speed=20))
    assert told[0].type == "hello" and [message.n for message in told[1:-1]] == end.impacts.n
    assert told[-1].type == "end" and told[-1].outcome.kind == end.outcome.kind, told[-1]


def servers():
    with equipoise.Server(token=16 * "s", arguments=["--permits", "1"]) as own:
        assert own.url != equipoise.server().url and own.stability(preset="case-1").verdict.code == "elliptic"
        assert refused(equipoise.Server(own.url, token="wrong").stability, preset="case-1").status == 401
        assert equipoise.Server(own.url, token=16 * "s").get("scenes")["items"]
    with contextlib.suppress(ConnectionError):
        own.stability(preset="case-1")
        raise SystemExit("a server after its end")
    before = equipoise.server()
    before.close()
    assert before.ended and equipoise.get("scenes")["items"] and equipoise.server() is not before
    # Each way to end a process, several at a time; a fork shares the server of its parent and leaves it alone.
    ends = {
        "return": 0, "raise ValueError": 1, "os._exit(3)": 3, "time.sleep(100)": -signal.SIGKILL, "time.sleep(99)": -signal.SIGTERM,
        "if os.fork(): os.wait(); assert equipoise.get('scenes')\n    else: equipoise.get('scenes'); sys.exit()": 0,
    }
    run = "import equipoise, os, sys, time\ndef run():\n    print(equipoise.server().url, flush=True)\n    equipoise.get('scenes')\n    {}\nrun()"
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    started = [subprocess.Popen([sys.executable, "-c", run.format(each)], **options) for each in ends]
    urls = [process.stdout.readline().strip() for process in started]
    assert len(set(urls)) == len(ends) and all(urls), urls
    for process, status in zip(started, ends.values()):
        if status < 0:
            process.send_signal(-status)
        said = process.communicate(timeout=60)[1]
        assert process.returncode == status and (status == 1 or not said), (status, process.returncode, said)
    until = time.monotonic() + 20
    for url, end in zip(urls, ends):
        with contextlib.suppress(OSError):
            while NO_PROXY.open(url, timeout=5).close() is None:
                assert time.monotonic() < until, f"a server after {end}"
                time.sleep(0.05)
    # An address in EQUIPOISE is a server that runs already.
    other = {**os.environ, "EQUIPOISE": equipoise.server().url}
    told = subprocess.run([sys.executable, "-c", "import equipoise; print(equipoise.server().url)"], env=other, **options)
    assert told.stdout.strip() == equipoise.server().url, told


def documented():
    """The lines of docs/clients/README.md."""
    text = (Path(__file__).parents[2] / "docs/clients/README.md").read_text(encoding="utf-8")
    lines, folder = text.split("```python\n")[1].split("```")[0], os.getcwd()
    if ALONE:
        lines = lines.replace("run.impacts.to_pandas()", "None")
    said = io.StringIO()
    os.chdir(os.environ["MADE"])
    with contextlib.redirect_stdout(said):
        exec(lines, {})
    os.chdir(folder)
    said = said.getvalue().splitlines()
    assert said[0] == "elliptic, 2000 bounces survived" and said[3] == "scene.table.tilt_gain" and said[-1].startswith("10 "), said


def types():
    code = """
import equipoise
answer = equipoise.stability(preset="case-1", table={"tilt_gain": 1.2}, contact={"law": "newton"})
answer.impacts.to_pandas()
equipoise.controllers(contact="stick")
equipoise.regions(preset="case-1")  # type: ignore[call-arg]
equipoise.stability(presets="case-1")  # type: ignore[call-arg]
equipoise.Server().stability(preset="case-9")  # type: ignore[arg-type]
equipoise.stability(table={"gain": 1})  # type: ignore[arg-type]
"""
    package = Path(equipoise.__file__).parents[1]
    checked = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", os.environ["MADE"] + "/mypy", "-c", code]
    subprocess.run(checked, env={**os.environ, "MYPYPATH": str(package)}, check=True)


assert not {"pandas", "polars", "pyarrow", "numpy"} & set(sys.modules), "the import is light"
for check in (answers, requests, errors, tables, files, live, servers, documented, *([] if ALONE else [types])):
    check()
    print(f"ok    {check.__name__}{', with the standard library alone' if ALONE else ''}")
