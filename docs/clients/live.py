"""Messages of a live run, each impact as one flat object, over any number of broken connections. Needs only Python's standard library.

`for message in messages("http://127.0.0.1:8080", "preset=case-1&speed=2"): …` yields `hello`, then impacts as they happen, and `end`.
The token of a server is read from EQUIPOISE_TOKEN.
"""

import argparse
import http.client
import json
import os
import sys
import time
import urllib.error
import urllib.request
from urllib.parse import parse_qs, urlsplit


def arguments(about, **defaults):
    """A parser with the options of every bridge: the server, the query of the run, and the number of impacts."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    parser.add_argument("--server", default="http://127.0.0.1:8080", help="address of the equipoise server")
    parser.add_argument("--query", default="preset=case-1", help="the run: parameters of /v1/live")
    parser.add_argument("--bounces", type=int, default=10_000_000, help="impacts after which to stop")
    parser.set_defaults(**defaults)
    return parser


def singly(message):
    """The message; of many impacts in columns, a message for each. Of impacts the columns alone, without the strike that comes next."""
    if message["type"] == "impact":
        del message["next_strike"]
    if message["type"] != "impacts":
        return [message]
    columns = message["columns"]
    return [{"type": "impact", **dict(zip(columns, row))} for row in zip(*columns.values())]


def messages(server, query, impacts=10_000_000):
    given, last = parse_qs(query), None
    # A run that begins with this request is sent from its first impact on, also after a reconnect.
    first = "" if "epoch_ms" in given or "from" in given else "&from=1"
    while True:
        headers = {"Accept": "text/event-stream"}
        if "EQUIPOISE_TOKEN" in os.environ:
            headers["Authorization"] = f"Bearer {os.environ['EQUIPOISE_TOKEN']}"
        if last:
            headers["Last-Event-ID"] = last
        request = urllib.request.Request(f"{server}/v1/live/events?{query}{first}", headers=headers)
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                # A line that was cut off comes again.
                whole = (line for line in answer if line.startswith(b"data: ") and line.endswith(b"\n"))
                for message in (one for line in whole for one in singly(json.loads(line[6:]))):
                    if message["type"] == "hello":
                        query = urlsplit(message["url"]).query  # It has the run's epoch, so the client can come back.
                        first = first or "".join(f"&from={n}" for n in given.get("from", []))
                    yield message
                    last = str(message["n"]) if message["type"] == "impact" else last
                    impacts -= message["type"] == "impact"
                    if message["type"] == "end" or impacts <= 0:
                        return
        except urllib.error.HTTPError as error:
            if error.code != 503:
                sys.exit(error.read().decode())
        except (OSError, http.client.HTTPException) as error:
            print(f"the connection broke ({error}); trying again", file=sys.stderr)
        time.sleep(1)
