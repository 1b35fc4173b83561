"""Requests to an equipoise server, using only Python's standard library.

`ask("trajectories", {"preset": "case-1", "bounces": 20})` returns the answer as a dict; other formats than JSON come as bytes.
An invalid request ends the program with the errors of its fields. `ask_many` sends many requests at once.
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
BODY_BYTES = 256 * 1024  # Default of a server's --body-bytes.
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
    """POST to /v1/<resource>. If the server is overloaded, waits for the time that it names and repeats the request."""
    try:
        with post(f"{resource}?format={form}", json.dumps(request).encode(), "application/json") as answer:
            return json.load(answer) if form == "json" else answer.read()
    except urllib.error.URLError as error:
        sys.exit(f"no server at {SERVER}: {error.reason}; start one, or say --server where it is")


def ask_many(resource, requests):
    """Many requests to /v1/<resource>. Yields (answer, None) or (None, problem) for each, in order, as soon as it is ready.

    They go to /v1/batches/<resource>, as many at a time as fit into a body. Requests that a broken answer or a restart of the server
    left out are sent again.
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
