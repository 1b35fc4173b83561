"""One question to an equipoise server, with Python's standard library alone.

`ask("trajectories", {"preset": "case-1", "impacts": 20})` is the answer as a dict; a format other than JSON comes as bytes.
A request that cannot be answered ends the program with what is wrong, field by field.
"""

import argparse
import json
import sys
import time
import urllib.error
import urllib.request

SERVER = "http://127.0.0.1:8080"


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
    headers = {"Content-Type": "application/json", "User-Agent": "equipoise-docs"}
    call = urllib.request.Request(f"{SERVER}/v1/{resource}?format={form}", json.dumps(request).encode(), headers)
    while True:
        try:
            with urllib.request.urlopen(call, timeout=300) as answer:
                return json.load(answer) if form == "json" else answer.read()
        except urllib.error.HTTPError as error:
            problem = json.load(error)
            if error.code == 503:
                time.sleep(float(error.headers["Retry-After"]))
                continue
            lines = [f"  {each['pointer'].strip('/').replace('/', '.')}: {each['detail']}" for each in problem.get("errors", [])]
            sys.exit("\n".join([f"{problem['title']} ({error.code}): {problem['detail']}", *lines]))
        except urllib.error.URLError as error:
            sys.exit(f"no server at {SERVER}: {error.reason}; start one, or say --server where it is")
