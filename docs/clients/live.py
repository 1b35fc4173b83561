"""Messages of a live run for the bridges, each impact as one flat object, over any number of broken connections.

`for message in messages("http://127.0.0.1:8080", "preset=case-1&speed=2"): …` yields `hello`, then impacts as they happen, and `end`.
It needs the package equipoise: `pip install ../..` in this folder. The token of a server is read from EQUIPOISE_TOKEN.
"""

import argparse
from urllib.parse import parse_qsl

import equipoise


def arguments(about, **defaults):
    """A parser with the options of every bridge: the server, the query of the run, and the number of impacts."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    parser.add_argument("--server", default="http://127.0.0.1:8080", help="address of the equipoise server")
    parser.add_argument("--query", default="preset=case-1", help="the run: parameters of /v1/live")
    parser.add_argument("--bounces", type=int, default=10_000_000, help="impacts after which to stop")
    parser.set_defaults(**defaults)
    return parser


def messages(server, query, impacts=10_000_000):
    for message in equipoise.Server(server).live(**dict(parse_qsl(query))):
        # Of impacts the columns alone, without the strike that comes next.
        message.pop("next_strike", None)
        yield message
        impacts -= message.type == "impact"
        if impacts <= 0:
            return
