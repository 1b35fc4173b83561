"""Computes a map and an ensemble in tiles with three servers and a Dask cluster of four workers, kills workers and servers on the
way, and compares the result with the bytes of one request to one server. Then it kills the script itself and counts the requests that
the next start repeats.

Arguments: the server's program and the folder of the scripts. Needs the Python that has Dask.
"""

import json
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import psutil

PROGRAM, SCRIPT = sys.argv[1], Path(sys.argv[2]).resolve() / "in_tiles.py"
MOST_S = 120
MAP = {
    "preset": "case-1",
    "x": {"field": "table.tilt_gain", "from": 0.95, "to": 1.6, "count": 317},
    "y": {"field": "release.theta", "from": 0, "to": 0.5, "count": 311},
    "bounces": 2000,
    "quantity": "max_theta",
}
RUNS = {"preset": "case-1-noise", "runs": 1500, "bounces": 450, "seed": 5}


class Server:
    """The server on a free port."""

    def __init__(self):
        self.process = subprocess.Popen([PROGRAM, "--listen", "127.0.0.1:0"], stdout=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().split(" serves ")[1].strip().rstrip("/")

    def kill(self):
        self.process.kill()
        self.process.wait()

    def ask(self, path, body=None):
        request = urllib.request.Request(self.address + path, body and json.dumps(body).encode(), {"Content-Type": "application/json"})
        with urllib.request.urlopen(request, timeout=MOST_S) as answer:
            return answer.read()

    def gauge(self, name):
        lines = self.ask("/metrics").decode().splitlines()
        return sum(float(line.rsplit(" ", 1)[1]) for line in lines if line.startswith(name))


class Stranger(BaseHTTPRequestHandler):
    """A server that is not of this build, or is busy: `health`, `build`, `status` and `retry_after_s` of its class."""

    health = build = status = retry_after_s = None
    asked = 0

    def do_GET(self):
        self.say(200, self.health)

    def do_POST(self):
        type(self).asked += 1
        self.rfile.read(int(self.headers["Content-Length"]))
        self.say(self.status, self.build)

    def say(self, status, build):
        self.send_response(status)
        self.send_header("equipoise-build", build)
        if status == 503:
            self.send_header("Retry-After", str(self.retry_after_s))
        self.send_header("Content-Length", "0")
        self.end_headers()

    def log_message(self, *_):
        pass


@contextmanager
def stranger(**said):
    kind = type("Stranger", (Stranger,), said)
    server = ThreadingHTTPServer(("127.0.0.1", 0), kind)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield kind, f"http://127.0.0.1:{server.server_port}"
    server.shutdown()


class Script:
    """The shipped script and its output folder."""

    def __init__(self, folder, resource, request, servers, *rest, workers=4):
        folder.mkdir(exist_ok=True)
        (folder / "request.json").write_text(json.dumps(request))
        command = [sys.executable, "-B", SCRIPT, resource, folder / "request.json", "--into", folder, "--workers", workers, *rest]
        self.folder, self.said = folder, folder / "said"
        with open(self.said, "w") as said:
            self.process = psutil.Popen([*map(str, command), "--server", *servers], stdout=said, stderr=said)

    def done(self):
        return [file for file in (self.folder / "tiles").glob("*.ndjson")]

    def workers(self):
        return [child for child in self.process.children(recursive=True) if any("spawn_main" in part for part in child.cmdline())]

    def ends(self, status=0):
        found = self.process.wait(MOST_S)
        said = self.said.read_text()
        assert found == status, f"{found}, not {status}:\n{said}"
        return said

    def until(self, what):
        """Polls `what` while the script runs; returns its first true value."""
        begin = time.monotonic()
        while time.monotonic() - begin < MOST_S:
            if found := what():
                return found
            assert self.process.poll() is None, f"the script has ended:\n{self.said.read_text()}"
            time.sleep(0.005)
        raise AssertionError(f"nothing in {MOST_S} s:\n{self.said.read_text()}")


def killed(script, servers, tiles):
    """After some tiles, kills a worker that holds half a tile and a server that computes one."""
    assert len(script.until(lambda: len(script.workers()) == 4 and script.workers())) == 4
    script.until(lambda: len(script.done()) >= 5)

    def in_mid_work():
        for part in (script.folder / "tiles").glob("*.part"):
            worker = psutil.Process(int(part.name.split(".")[-3]))
            worker.suspend()
            if part.exists():
                return worker, part
            worker.resume()
        return None

    worker, part = script.until(in_mid_work)
    worker.send_signal(signal.SIGKILL)
    script.until(lambda: servers[2].gauge("equipoise_jobs_running") > 0)
    servers[2].kill()
    assert part.exists() and len(script.done()) < tiles, "too late: nothing was left to do"


def kill_all(script):
    """Kills the script without warning, like a power failure; its workers end by themselves."""
    script.until(lambda: len(script.done()) >= 12)
    workers = script.workers()
    script.process.kill()
    script.process.wait()
    _, alive = psutil.wait_procs(workers, timeout=MOST_S)
    assert not alive, alive


def answers(servers, resource):
    """Number of answered requests, once none is under way."""
    begin = time.monotonic()
    while any(server.gauge("equipoise_jobs_running") for server in servers):
        assert time.monotonic() - begin < MOST_S
        time.sleep(0.01)
    return sum(server.gauge(f'equipoise_requests_total{{method="POST",route="/v1/{resource}",status="200"}}') for server in servers)



def main(folder):
    servers = [Server() for _ in range(3)]
    try:
        addresses = [server.address for server in servers]
        build = json.loads(servers[0].ask("/health/live"))["build"]
        small = ["--tile-size", "2000"]

        script = Script(folder / "map", "regions", MAP, addresses, *small, "--format", "ndjson", "csv")
        killed(script, servers, 52)
        said = script.ends()
        assert len(script.done()) == 52 and not list((folder / "map/tiles").glob("*.part")), said
        for form in ("ndjson", "csv"):
            whole = servers[0].ask(f"/v1/regions?format={form}", MAP)
            assert (folder / f"map/regions.{form}").read_bytes() == whole, form
        print("ok    a killed worker and a killed server", flush=True)
        servers.pop(), addresses.pop()

        script = Script(folder / "again", "regions", MAP, addresses, *small)
        kill_all(script)
        done = script.done()
        done[0].write_bytes(done[0].read_bytes()[:-100])
        missing = 52 - len(done) + 1
        assert 10 < missing <= 41, missing
        before = answers(servers, "regions")
        # From here on the size of tiles does not matter.
        said = Script(folder / "again", "regions", MAP, addresses, workers=2).ends()
        assert f"{52 - missing} of 52 tiles are there already" in said, said
        again = answers(servers, "regions") - before
        assert again == missing, f"{again} tiles asked for, {missing} missing"
        assert (folder / "again/regions.ndjson").read_bytes() == (folder / "map/regions.ndjson").read_bytes()
        print("ok    a killed script goes on", flush=True)

        other = {**MAP, "bounces": 30}
        assert "has tiles of another request" in Script(folder / "again", "regions", other, addresses).ends(1)
        wrong = Script(folder / "wrong", "regions", {**MAP, "quantity": "weight"}, addresses, workers=1).ends(1)
        assert "quantity: quantity is \"weight\"" in wrong, wrong
        with stranger(health="0.0.0+other") as (_, address):
            said = Script(folder / "mixed", "regions", other, [*addresses, address]).ends(1)
            assert "servers have to be of one build" in said and f"0.0.0+other: {address}" in said and build in said, said
            manifest = json.loads((folder / "again/manifest.json").read_text())
            (folder / "again/manifest.json").write_text(json.dumps({**manifest, "build": "0.0.0+older"}))
            said = Script(folder / "again", "regions", MAP, addresses).ends(1)
            assert f"has tiles of build 0.0.0+older, and the servers are {build}" in said, said
        with stranger(health=build, build="0.0.0+newer", status=200) as (_, address):
            said = Script(folder / "newer", "regions", other, [*addresses, address], *small, workers=1).ends(1)
            assert f"{address} is build 0.0.0+newer, but the tiles are of {build}" in said, said
        with stranger(health=build, build=build, status=503, retry_after_s=3600) as (busy, address):
            Script(folder / "busy", "regions", other, [address, addresses[0]], *small, workers=2).ends()
            assert 1 <= busy.asked <= 2, f"2 workers asked {busy.asked} times within the hour that they were to wait"
            assert (folder / "busy/regions.ndjson").read_bytes() == servers[0].ask("/v1/regions?format=ndjson", other)
        print("ok    other builds, other requests, and servers without time", flush=True)

        script = Script(folder / "runs", "ensembles", RUNS, addresses, "--tile-size", "70", workers=2)
        said = script.ends()
        whole = json.loads(servers[0].ask("/v1/ensembles", RUNS))
        assert len(script.done()) == 22
        assert (folder / "runs/ensembles.csv").read_bytes() == servers[0].ask("/v1/ensembles?format=csv", RUNS)
        survived = whole["survived"]
        assert f"1,500 runs: {survived['runs']:,} completed" in said, said
        assert f"{100 * survived['share']:.4g} % outlast all contacts" in said, said
        print("ok    an ensemble", flush=True)
    finally:
        for server in servers:
            server.kill()


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        main(Path(made))
