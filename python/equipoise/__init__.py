"""Can a bouncing object be balanced? The functions of this package ask an equipoise server, which is started at first use.

`equipoise.stability(preset="case-1", table={"tilt_gain": 1.2})` is the verdict with its margins. Keywords are the fields of the
request; `body`, `table`, `release` and the other parts of a scene may stand beside them. `help(equipoise.stability)` lists them.
The server ends with this process. If EQUIPOISE is an address, that server is asked instead. All needs are in the standard library;
pandas, polars and pyarrow are used by `to_pandas()`, `to_polars()` and `to_arrow()`.
"""

import os
import threading

from ._answers import Answer, Columns, FieldError, Problem, Record
from ._resources import RESOURCES
from ._server import Server

__all__ = ["Answer", "Columns", "FieldError", "Problem", "Record", "Server", "get", "live", "server", *RESOURCES]

_lock, _shared = threading.Lock(), None


def server():
    """The server that the functions of the package ask. One that has ended is replaced."""
    global _shared
    with _lock:
        if _shared is None or _shared.ended:
            address = os.environ.get("EQUIPOISE", "")
            _shared = Server(address if address.startswith(("http://", "https://")) else None)
        return _shared


def _function(name):
    def call(*arguments, **request):
        return getattr(server(), name)(*arguments, **request)

    call.__name__ = call.__qualname__ = name
    call.__doc__ = getattr(Server, name).__doc__
    return call


globals().update({name: _function(name) for name in ("get", "live", *RESOURCES)})
