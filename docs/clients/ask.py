"""Questions to an equipoise server, with Python's standard library alone.

`ask("trajectories", {"preset": "case-1", "impacts": 20})` is the answer as a dict; a format other than JSON comes as bytes.
A request that cannot be answered ends the program with what is wrong, field by field. `ask_many` asks the same of many at once.
"""

import argparse
import collections
import http.client
import itertools
import json
import sys
import time
import urllib.error
import urllib.request

SERVER = "http://127.0.0.1:8080"
BODY_BYTES = 256 * 1024  # What a server takes at a time, unless it was started with another --body-bytes.
TRIES = 5


def arguments(about):
    """A parser that begins with `--server`; read it with `parse`."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    parser.add_argument("--server", default=SERVER, help="address of the server")
    return parser


def parse(parser):
    global SERVER
    options = parser.parse_args()
    SERVER = options.server.rstrip("/")
    return options


def ask(resource, request, form="json"):
    """POST to /v1/<resource>. While the server has too much to do, it says how long to wait, and that is waited."""
    try:
        with post(f"{resource}?format={form}", json.dumps(request).encode(), "application/json") as answer:
            return json.load(answer) if form == "json" else answer.read()
    except urllib.error.URLError as error:
        sys.exit(f"no server at {SERVER}: {error.reason}; start one, or say --server where it is")


def ask_many(resource, requests):
    """Many requests to /v1/<resource>: for each in its order (answer, None), or (None, problem), as soon as it is there.

    They go to /v1/batches/<resource>, as many at a time as a body may hold. What an answer that was cut off, or a server that was
    being started anew, has left out is asked for again.
    """
    waiting = collections.deque(json.dumps(request).encode() + b"\n" for request in requests)
    fruitless = 0
    while waiting:
        sizes = itertools.accumulate(map(len, waiting))
        body = b"".join(itertools.islice(waiting, max(1, sum(1 for _ in itertools.takewhile(BODY_BYTES.__ge__, sizes)))))
        fruitless, why = fruitless + 1, "they break off"
        try:
            with post(f"batches/{resource}", body, "application/x-ndjson") as answer:
                for line in map(json.loads, answer):
                    if "end" in line or line.get("problem", {}).get("status") == 503:
                        break
                    waiting.popleft()
                    fruitless = 0
                    yield line.get("answer"), line.get("problem")
        except (ValueError, OSError, http.client.HTTPException) as error:
            why = error
        if fruitless == TRIES:
            sys.exit(f"no answer from {SERVER} to {TRIES} batches one after the other: {why}")
        time.sleep(fruitless)


def post(path, body, media_type):
    call = urllib.request.Request(f"{SERVER}/v1/{path}", body, {"Content-Type": media_type, "User-Agent": "equipoise-docs"})
    while True:
        try:
            return urllib.request.urlopen(call, timeout=300)
        except urllib.error.HTTPError as error:
            problem = json.load(error)
            if error.code == 503:
                time.sleep(float(error.headers["Retry-After"]))
                continue
            sys.exit(said(problem))


def said(problem):
    """A problem as text, field by field."""
    lines = [f"  {each['pointer'].strip('/').replace('/', '.')}: {each['detail']}" for each in problem.get("errors", [])]
    return "\n".join([f"{problem['title']} ({problem['status']}): {problem['detail']}", *lines])
