"""A map or an ensemble too large for one request, in tiles on any number of servers: `pip install dask distributed`.

The result has the bytes that one request to one server would have. After an interruption the same command requests only the missing
tiles.
Example: in_tiles.py regions map.json --into map --server http://a:8080 http://b:8080, where map.json is the body of POST /v1/regions.
"""

import argparse
import errno
import hashlib
import http.client
import json
import math
import os
import random
import shutil
import socket
import sys
import threading
import time
import urllib.request
from array import array
from contextlib import nullcontext
from pathlib import Path
from urllib.parse import urlsplit

import dask
from distributed import Client, LocalCluster, as_completed, get_worker

# Pauses before a server that cannot be reached is tried again, s; they double each time.
FIRST_PAUSE, LONGEST_PAUSE = 0.5, 30.0
# Time limits of a connection attempt and of silence, s.
CONNECT_TIME, SILENT_TIME = 10, 300
# Errors of this machine's disk, not of a server.
OF_THE_DISK = {errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EACCES, errno.ENOENT, errno.EIO}
# Most angles of an ensemble in memory, eight bytes each.
NUMBERS_AT_ONCE = 1 << 23
# The standard normal deviate of a 95 % interval, and the shares of runs below the quantiles.
DEVIATE, SHARES = 1.959963984540054, (0.05, 0.25, 0.5, 0.75, 0.95)


def post(server, resource, request, form, token):
    """POST to /v1/<resource>: the open connection and its answer."""
    url = urlsplit(server)
    kind = http.client.HTTPSConnection if url.scheme == "https" else http.client.HTTPConnection
    connection = kind(url.hostname, url.port, timeout=CONNECT_TIME)
    try:
        connection.connect()
        connection.sock.settimeout(SILENT_TIME)
        headers = {"Content-Type": "application/json", "User-Agent": "equipoise-docs"}
        if token:
            headers["Authorization"] = f"Bearer {token}"
        connection.request("POST", f"{url.path}/v1/{resource}?format={form}", json.dumps(request), headers)
        return connection, connection.getresponse()
    except BaseException:
        connection.close()
        raise


def refusal(answer):
    """The errors of a request, field by field."""
    text = answer.read()
    try:
        problem = json.loads(text)
        errors = [f"  {each['pointer'].strip('/').replace('/', '.')}: {each['detail']}" for each in problem.get("errors", [])]
        return "\n".join([f"{problem['title']} ({answer.status}): {problem['detail']}", *errors])
    except (ValueError, KeyError, TypeError):
        return f"status {answer.status}: {text[:200].decode(errors='replace')}"


def asked(job, request, form, first, take, pauses):
    """Returns what `take` makes of the first server's answer to this request, or {"stop": reason} if no server will answer.

    An overloaded server names a time to wait. Meanwhile, and while a server cannot be reached, others are tried.
    `pauses` holds for each server the time of the next try and the number of failures in a row.
    """
    servers = job["servers"][first % len(job["servers"]) :] + job["servers"][: first % len(job["servers"])]
    begin, last = time.monotonic(), "nobody was asked"
    while True:
        now = time.monotonic()
        server = min(servers, key=lambda each: max(now, pauses.get(each, (now, 0))[0]))
        until, failures = pauses.get(server, (now, 0))
        if max(until, now) - begin > job["patience"]:
            return {"stop": f"no server answers within {job['patience']:g} s; at last, {last}"}
        time.sleep(max(0.0, until - now))
        try:
            connection, answer = post(server, job["resource"], request, form, job["token"])
            try:
                if answer.status in (429, 503) and answer.headers.get("Retry-After", "").isdigit():
                    last = f"{server} had too much to do"
                    pauses[server] = (time.monotonic() + int(answer.headers["Retry-After"]), 0)
                    continue
                if answer.status in (400, 401, 403, 404, 405, 406, 413, 415, 422):
                    return {"stop": f"{server}: {refusal(answer)}"}
                if answer.status != 200:
                    raise OSError(f"status {answer.status}")
                build = answer.headers.get("equipoise-build")
                if build != job["build"]:
                    return {"stop": f"{server} is build {build}, but the tiles are of {job['build']}, whose bytes may differ"}
                done = take(answer)
                pauses[server] = (time.monotonic(), 0)
                return done
            finally:
                connection.close()
        except (OSError, http.client.HTTPException) as error:
            if isinstance(error, OSError) and error.errno in OF_THE_DISK:
                return {"stop": f"{job['folder']}: {error}"}
            last = f"{server}: {error!r}"
            pause = min(LONGEST_PAUSE, FIRST_PAUSE * 2**failures) * random.uniform(0.5, 1)
            pauses[server] = (time.monotonic() + pause, failures + 1)


def last_line(file):
    """Start and text of the last line of an open file."""
    size = file.seek(0, os.SEEK_END)
    place = max(0, size - 4096)
    file.seek(place)
    tail = file.read()
    begin = tail.rfind(b"\n", 0, -1) + 1
    return place + begin, tail[begin:]


def counts(line):
    """Counts of endings from the last line of a tile; nothing if it is another line."""
    try:
        return json.loads(line)["end"]["counts"]
    except (ValueError, KeyError, TypeError):
        return None


def is_whole(file, size):
    """True if an open file has a whole tile."""
    found = counts(last_line(file)[1])
    return found is not None and sum(found.values()) == size


class Regions:
    """Maps: a tile is a band of rows, stored as the NDJSON of its answer."""

    unit, form, formats, asks = "cells", "ndjson", ["ndjson", "csv"], {}
    # Cells of a tile: some seconds of a core, and 1 MB to compute again if a worker is killed.
    most = 250_000

    @staticmethod
    def shares(request):
        """Number of rows, and of cells in each."""
        return request["y"]["count"], request["x"]["count"]

    @staticmethod
    def price(request):
        """Approximate bounces of a cell."""
        is_linear = request.get("quantity") in ("residue", "spectral_radius")
        return 10 if is_linear else request.get("bounces") or 1000

    @staticmethod
    def keep(answer, file):
        shutil.copyfileobj(answer, file, 1 << 20)

    @staticmethod
    def write_ndjson(job, out):
        """All rows, and a last line with the sums."""
        for place in job["places"]:
            with open(place, "rb") as file:
                end = last_line(file)[0]
                file.seek(0)
                while end > 0:
                    part = file.read(min(end, 1 << 20))
                    out.write(part)
                    end -= len(part)
        out.write(json.dumps({"end": {"counts": total(job)}}, separators=(",", ":")).encode() + b"\n")

    @staticmethod
    def write_csv(job, out):
        """The same rows cell by cell, with numbers as in the answers."""
        first = {**job["request"], "bounces": 1, "tile": {"index": 0, "of": job["request"]["y"]["count"]}}
        frame = asked(job, first, "json", 0, lambda answer: json.load(answer, parse_float=str, parse_int=str), {})
        if "stop" in frame:
            sys.exit(frame["stop"])
        out.write(header_of(job, first))
        outcomes = {str(code): f",{name}\r\n" for code, name in enumerate(frame["outcome_names"])}
        for place in job["places"]:
            with open(place, "rb") as file:
                for line in file:
                    row = json.loads(line, parse_float=str, parse_int=str)
                    if "end" not in row:
                        y = row["y"]
                        cells = zip(frame["x"], row["values"], row["outcomes"])
                        out.write("".join([f"{x},{y},{value or ''}{outcomes[code]}" for x, value, code in cells]).encode())

    @staticmethod
    def summarize(job):
        pass


class Ensembles:
    """Runs with noise: a tile is a part of them, stored as their curve, then a line of angles for each contact that has some."""

    unit, form, formats, asks = "runs", "json", ["csv"], {"angles": True}
    # Runs of a tile, with 200 angles each: 8 MB.
    most = 2000

    @staticmethod
    def shares(request):
        return request["runs"], 1

    @staticmethod
    def price(request):
        """Approximate bounces of a run: with noise they take longer and are not in lanes."""
        return 10 * (request.get("bounces") or 400)

    @staticmethod
    def keep(answer, file):
        part = json.load(answer)
        curve = {"at_risk": part["survival"]["at_risk"], "ended": part["survival"]["ended"], "watched": part["quantiles"]["n"]}
        for line in [curve, *part["angles"], {"end": {"counts": part["counts"]}}]:
            file.write(json.dumps(line, separators=(",", ":")).encode() + b"\n")

    @staticmethod
    def write_csv(job, out):
        """The curve of all runs, contact by contact, from sums of counts and merged angles."""
        first = {**job["request"], "bounces": 1, "tile": {"index": 0, "of": job["request"]["runs"]}}
        out.write(header_of(job, first))
        at_risk, ended, places = [], [], []
        for place in job["places"]:
            with open(place, "rb") as file:
                curve = json.loads(file.readline())
                at_risk = [a + b for a, b in zip(at_risk or [0] * len(curve["at_risk"]), curve["at_risk"])]
                ended = [a + b for a, b in zip(ended or [0] * len(curve["ended"]), curve["ended"])]
                watched = curve["watched"]
                places.append(file.tell())
        runs = at_risk[0]
        some = max(1, NUMBERS_AT_ONCE // runs)
        quantiles = {}
        for begin in range(0, len(watched), some):
            angles = [array("d") for _ in watched[begin : begin + some]]
            for index, place in enumerate(job["places"]):
                with open(place, "rb") as file:
                    file.seek(places[index])
                    for found in angles:
                        found.extend(json.loads(file.readline()))
                    places[index] = file.tell()
            quantiles.update(zip(watched[begin:], map(quantiles_of, angles)))
        for n, (came, fell) in enumerate(zip(at_risk, ended), 1):
            left = came - fell
            numbers = [left / runs, *wilson_interval(left, runs), *quantiles.get(n, [None] * 5)]
            out.write(",".join([str(n), str(came), str(fell), *map(written, numbers)]).encode() + b"\r\n")

    @staticmethod
    def summarize(job):
        ends, runs = total(job), job["request"]["runs"]
        share, (lower, upper) = ends["completed"] / runs, wilson_interval(ends["completed"], runs)
        counted = ", ".join(f"{count:,} {name}" for name, count in ends.items() if count)
        print(f"{runs:,} runs: {counted}; {100 * share:.4g} % outlast all contacts (95 %: {100 * lower:.4g} to {100 * upper:.4g} %)")


def total(job):
    """Counts of endings over all tiles."""
    ends = {}
    for place in job["places"]:
        with open(place, "rb") as file:
            for name, count in counts(last_line(file)[1]).items():
                ends[name] = ends.get(name, 0) + count
    return ends


def wilson_interval(successes, trials):
    """Wilson interval (E. B. Wilson 1927), with the server's order of operations."""
    share, square = successes / trials, DEVIATE * DEVIATE
    middle = share + square / (2 * trials)
    half = DEVIATE * math.sqrt(share * (1 - share) / trials + square / (4.0 * trials * trials))
    whole = 1 + square / trials
    return (middle - half) / whole if successes else 0.0, (middle + half) / whole if successes < trials else 1.0


def quantiles_of(values):
    """Quantiles as in the server, on straight lines between the sorted values."""
    values, found = sorted(values), []
    for share in SHARES if values else []:
        place = share * (len(values) - 1)
        below = math.floor(place)
        low, high = values[below], values[min(below + 1, len(values) - 1)]
        found.append(low + (place - below) * (high - low))
    return found or [None] * len(SHARES)


def written(number):
    """A number in the server's notation: Python's digits, with a power of ten from 1e-6 down and 1e16 up."""
    text = "" if number is None else repr(number)
    digits, _, power = text.partition("e")
    if not power:
        return text
    return f"0.0000{digits.replace('.', '')}" if power == "-05" else f"{digits}e{int(power)}"


KINDS = {"regions": Regions, "ensembles": Ensembles}


def compute(job, index):
    """Gets a tile and stores it in one step, so that a file under its name is always whole.

    Runs in a worker. Two workers with the same tile, as after one seemed dead, write the same bytes.
    """
    kind, place = KINDS[job["resource"]], tile_place(job, index)
    begun = place.with_name(f"{index}.{socket.gethostname()}.{os.getpid()}.{threading.get_ident()}.part")

    def take(answer):
        with open(begun, "w+b") as file:
            kind.keep(answer, file)
            if not is_whole(file, size_of(job, index)):
                raise OSError("the answer has broken off")
            file.flush()
            os.fsync(file.fileno())
        os.replace(begun, place)
        return {"index": index}

    # An earlier worker may have stored it and been killed before it could report.
    if is_there(job, index):
        return {"index": index}
    worker = get_worker()
    if not hasattr(worker, "equipoise_pauses"):
        worker.equipoise_pauses = {}
    request = {**job["request"], **kind.asks, "tile": {"index": index, "of": job["of"]}}
    try:
        return asked(job, request, kind.form, index, take, worker.equipoise_pauses)
    finally:
        begun.unlink(missing_ok=True)


def tile_place(job, index):
    return Path(job["folder"]) / f"{index}.ndjson"


def is_there(job, index):
    try:
        with open(tile_place(job, index), "rb") as file:
            return is_whole(file, size_of(job, index))
    except FileNotFoundError:
        return False


def header_of(job, request):
    """The header line of the CSV of a request."""
    header = asked(job, request, "csv", 0, lambda answer: {"line": answer.readline()}, {})
    if "stop" in header:
        sys.exit(header["stop"])
    return header["line"]


def size_of(job, index):
    """Number of cells or runs of a tile, by the rule of the contract."""
    shares, each = KINDS[job["resource"]].shares(job["request"])
    return each * (shares * (index + 1) // job["of"] - shares * index // job["of"])


def tiles_of(kind, request, options):
    """Number of tiles."""
    if request.get("tile"):
        sys.exit("the request has a tile of its own; leave it out")
    try:
        shares, each = (int(count) for count in kind.shares(request))
    except (KeyError, TypeError, ValueError):
        sys.exit(f"the request does not say how many {kind.unit} it wants")
    most = min(options.tile_size or kind.most, options.tile_bounces // kind.price(request))
    return max(1, -(-shares // max(1, most // max(1, each))))


def build_of(servers):
    """The build of all servers that can be reached; it must be the same."""
    builds = {}
    for server in servers:
        try:
            with urllib.request.urlopen(f"{server}/health/live", timeout=CONNECT_TIME) as answer:
                builds.setdefault(answer.headers["equipoise-build"], []).append(server)
        except (OSError, http.client.HTTPException) as error:
            print(f"{server} cannot be reached now: {error}", file=sys.stderr)
    if not builds:
        sys.exit("no server can be reached")
    if len(builds) > 1 or None in builds:
        lines = [f"  {build or 'unknown'}: {', '.join(those)}" for build, those in builds.items()]
        sys.exit("\n".join(["servers have to be of one build, as the bytes of others may differ:", *lines]))
    return next(iter(builds))


def manifest_of(folder, resource, request, build, of):
    """Writes or checks the manifest of a folder, so that tiles of different requests are not mixed."""
    text = json.dumps([resource, request], sort_keys=True, separators=(",", ":"))
    digest = hashlib.sha256(text.encode()).hexdigest()
    wanted = {"sha256": digest, "build": build, "of": of, "resource": resource, "request": request}
    place = folder / "manifest.json"
    if place.exists():
        found = json.loads(place.read_text())
        if found["sha256"] != wanted["sha256"]:
            sys.exit(f"{folder} has tiles of another request; say --into another folder")
        if found["build"] != build:
            sys.exit(f"{folder} has tiles of build {found['build']}, and the servers are {build}; say --into another folder")
        return found
    begun = place.with_suffix(".part")
    begun.write_text(json.dumps(wanted, indent=1) + "\n")
    os.replace(begun, place)
    return wanted


class Progress:
    """Prints progress to standard error, once a second on a terminal and every ten seconds elsewhere."""

    def __init__(self, job, done):
        self.job, self.done, self.begun_with = job, len(done), sum(size_of(job, index) for index in done)
        self.size, self.begin, self.said = self.begun_with, time.monotonic(), time.monotonic()
        self.all = math.prod(KINDS[job["resource"]].shares(job["request"]))

    def add(self, index):
        self.done, self.size = self.done + 1, self.size + size_of(self.job, index)
        now, last = time.monotonic(), self.done == self.job["of"]
        if last or now - self.said >= (1 if sys.stderr.isatty() else 10):
            self.said = now
            rate = (self.size - self.begun_with) / (now - self.begin)
            left = (self.all - self.size) / rate
            end = "\r" if sys.stderr.isatty() and not last else "\n"
            unit = KINDS[self.job["resource"]].unit
            text = f"{self.done} of {self.job['of']} tiles, {100 * self.size / self.all:.1f} %, {rate:,.0f} {unit}/s, {left:.0f} s left"
            print(f"{text:<79}", end=end, file=sys.stderr, flush=True)


def fan_out(job, missing, client, progress):
    """Computes the missing tiles, a few more at a time than there are threads, so that no thread waits."""
    waiting = iter(missing)
    futures, under_way = as_completed(), 0

    def top_up():
        nonlocal under_way
        most = 2 * max(1, sum(client.nthreads().values()))
        while under_way < most and (index := next(waiting, None)) is not None:
            # Not pure: the result is the file, so Dask must not reuse an earlier result of the same name.
            futures.add(client.submit(compute, job, index, pure=False))
            under_way += 1

    top_up()
    for future in futures:
        under_way -= 1
        done = future.result()
        if "stop" in done:
            sys.exit(done["stop"])
        progress.add(done["index"])
        top_up()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("resource", choices=KINDS)
    parser.add_argument("request", type=Path, help="a file with the body of POST /v1/<resource>, without `tile`")
    parser.add_argument("--into", type=Path, required=True, help="folder of the tiles and the result, visible to all workers")
    parser.add_argument("--server", nargs="+", default=["http://127.0.0.1:8080"], help="addresses of servers (http://127.0.0.1:8080)")
    parser.add_argument("--scheduler", help="address of a Dask cluster; default: a cluster on this machine with --workers")
    parser.add_argument("--workers", type=int, default=4, help="worker processes, each with one tile at a time (4)")
    parser.add_argument("--format", nargs="+", choices=["ndjson", "csv"], help="of the result (ndjson for maps, csv for ensembles)")
    parser.add_argument("--tile-size", type=int, help="most cells or runs of a tile, but at least a row (250000 or 2000)")
    parser.add_argument("--tile-bounces", type=int, default=100_000_000, help="the same for its work, in bounces of lanes (100000000; a server counts 20 for one that is in none)")
    parser.add_argument("--patience", type=float, default=600, help="seconds without an answer before it gives up on a tile (600)")
    options = parser.parse_args()

    kind, request = KINDS[options.resource], json.loads(options.request.read_text())
    formats = options.format or kind.formats[:1]
    if not set(formats) <= set(kind.formats):
        sys.exit(f"{options.resource} are put together as {' or '.join(kind.formats)}")
    servers = [server.rstrip("/") for server in options.server]
    tiles = options.into / "tiles"
    of = tiles_of(kind, request, options)
    build = build_of(servers)
    tiles.mkdir(parents=True, exist_ok=True)
    manifest = manifest_of(options.into, options.resource, request, build, of)
    job = {"resource": options.resource, "request": request, "of": manifest["of"], "build": build, "servers": servers}
    job.update(folder=str(tiles.resolve()), token=os.environ.get("EQUIPOISE_TOKEN"), patience=options.patience)
    places = [tile_place(job, index) for index in range(job["of"])]

    done = {index for index in range(job["of"]) if is_there(job, index)}
    missing = [index for index in range(job["of"]) if index not in done]
    if done:
        print(f"{len(done)} of {job['of']} tiles are there already", file=sys.stderr)
    if missing:
        # Tiles of a killed worker go to another one; a tile that kills its worker ten times is at fault itself.
        dask.config.set({"distributed.scheduler.allowed-failures": 10})
        local = {"n_workers": options.workers, "threads_per_worker": 1, "memory_limit": 0, "dashboard_address": "127.0.0.1:0"}
        with nullcontext(options.scheduler) if options.scheduler else LocalCluster(host="127.0.0.1", **local) as cluster:
            with Client(cluster) as client:
                fan_out(job, missing, client, Progress(job, done))
    for left in tiles.glob("*.part"):
        left.unlink()
    for form in formats:
        place = options.into / f"{options.resource}.{form}"
        with open(place.with_suffix(".part"), "wb") as out:
            getattr(kind, f"write_{form}")({**job, "places": places}, out)
        os.replace(place.with_suffix(".part"), place)
        print(f"{place}: {place.stat().st_size:,} bytes")
    kind.summarize({**job, "places": places})


if __name__ == "__main__":
    main()
