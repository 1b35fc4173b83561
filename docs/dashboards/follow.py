#!/usr/bin/env python3
"""Follows a live run and prints its impacts, each exactly once, over any number of broken connections.

    python3 follow.py 'http://127.0.0.1:8080/v1/live/events?preset=case-1'

Needs only Python. The token of a server is read from EQUIPOISE_TOKEN. It ends with the run or on Ctrl-C.
"""

import http.client
import json
import os
import sys
import time
import urllib.error
import urllib.request
from urllib.parse import parse_qs, urljoin, urlsplit

TOKEN = os.environ.get("EQUIPOISE_TOKEN")


def events(answer):
    """The events of an open answer: id (or None) and message. An incomplete event is skipped, because it comes again."""
    mark, text = None, ""
    for line in answer:
        name, _, value = line.decode().rstrip("\n").partition(": ")
        if name == "id":
            mark = value
        elif name == "data":
            text = value
        elif not name and text:
            yield mark, json.loads(text)
            mark, text = None, ""


def impacts(message):
    """The impacts in a message: one, many as columns, or none."""
    if message["type"] == "impact":
        yield {name: message[name] for name in ("n", "t", "theta", "energy")}
    elif message["type"] == "impacts":
        columns = message["columns"]
        for n, t, theta, energy in zip(columns["n"], columns["t"], columns["theta"], columns["energy"]):
            yield {"n": n, "t": t, "theta": theta, "energy": energy}


def follow(url):
    """The impacts of the run at an address as they happen, from the first on or from its `from`."""
    given = parse_qs(urlsplit(url).query).get("from")
    first = given[0] if given else "1"
    if not given:
        url += f"{'&' if urlsplit(url).query else '?'}from={first}"
    last = None
    while True:
        headers = {"Accept": "text/event-stream"}
        if TOKEN:
            headers["Authorization"] = f"Bearer {TOKEN}"
        if last:
            headers["Last-Event-ID"] = last
        try:
            with urllib.request.urlopen(urllib.request.Request(url, headers=headers), timeout=60) as answer:
                if answer.status == 204:
                    return
                for mark, message in events(answer):
                    if message["type"] == "hello":
                        # This address has the run's epoch, so the client can reconnect to it.
                        events_url = message["url"].replace("/v1/live?", "/v1/live/events?", 1)
                        url = urljoin(url, f"{events_url}&from={first}")
                    elif message["type"] == "gap":
                        print(f"too slow: impacts {message['from']} to {message['to']} were skipped", file=sys.stderr)
                    elif message["type"] == "problem":
                        raise SystemExit(json.dumps(message))
                    yield from impacts(message)
                    last = mark or last
                    if message["type"] == "end":
                        return
        except urllib.error.HTTPError as error:
            if error.code != 503:
                raise SystemExit(error.read().decode()) from None
        except (OSError, http.client.HTTPException):
            pass
        print("the connection broke; trying again", file=sys.stderr)
        time.sleep(1)


if __name__ == "__main__":
    try:
        for impact in follow(sys.argv[1]):
            print("{n}\t{t:.6f} s\tθ {theta:+.6f} rad\tenergy {energy:.6f} m²/s²".format(**impact), flush=True)
    except KeyboardInterrupt:
        pass
