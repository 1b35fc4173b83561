"""A server of one's own, or one that runs already, and requests to it."""

import atexit
import http.client
import json
import os
import re
import shutil
import subprocess
import sysconfig
import time
import urllib.error
import urllib.request
from urllib.parse import urlencode, urlsplit

from ._answers import Answer, Problem, Record, record
from ._resources import RESOURCES, SCENE

PATIENCE = 60  # Seconds for which requests to an overloaded server, and a broken live run, are tried again.

# Starts the program, and ends it when standard input closes. The system closes it when this process ends, in whatever way.
KEEPER = '"$@" </dev/null & server=$!; exec 3<&0 >&-; { read -r line <&3; kill "$server"; } & wait "$server"; kill $! 2>&-'


def find_program():
    """The server's program: EQUIPOISE if it is a path, else the one installed with this package, else one on the PATH."""
    folders = [sysconfig.get_path("scripts"), sysconfig.get_path("scripts", f"{os.name}_user"), *os.get_exec_path()]
    named = os.environ.get("EQUIPOISE", "")
    program = named if named and "://" not in named else shutil.which("equipoise", path=os.pathsep.join(folders))
    if not program:
        raise FileNotFoundError("there is no program equipoise; install the package, or name the program in EQUIPOISE")
    return program


class Server:
    """`Server()` starts a server on a free port of localhost; it ends with `close()`, with the `with` block, and with this process.

    `Server(url, token)` is one that runs already. `arguments` are those of the program, as ["--permits", "4"]. All functions of the
    package are methods. The token is otherwise that of EQUIPOISE_TOKEN.
    """

    def __init__(self, url=None, token=None, *, program=None, arguments=()):
        self._process, self._own, self._owner, opener = None, url is None, os.getpid(), []
        self._token = token or os.environ.get("EQUIPOISE_TOKEN", "")
        if self._own:
            url = self._start(program or find_program(), arguments)
            opener = [urllib.request.ProxyHandler({})]
        self.url = url.rstrip("/")
        self._opener = urllib.request.build_opener(*opener)

    def _start(self, program, arguments):
        command = ["/bin/sh", "-c", KEEPER, "sh", program, "--listen", "127.0.0.1:0", "--log-format", "text", *arguments]
        # A session of its own, so that Ctrl-C stops a computation here and not the server.
        settings = {**os.environ, **({"EQUIPOISE_TOKEN": self._token} if self._token else {})}
        self._process = subprocess.Popen(command, env=settings, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True)
        atexit.register(self.close)
        with self._process.stdout as lines:
            said = lines.readline().decode()
        served = re.search(r" serves (http\S+)", said)
        if not served:
            self.close()
            raise RuntimeError(f"{program} did not start; its message is on standard error")
        return served[1]

    @property
    def ended(self):
        """True of a server of one's own that has ended. Processes forked from this one cannot tell."""
        return self._own and self._owner == os.getpid() and (self._process is None or self._process.poll() is not None)

    def close(self):
        """Ends a server of one's own."""
        process, self._process = self._process, None
        if process and self._owner == os.getpid():
            atexit.unregister(self.close)
            # Processes forked from this one may hold the pipe too, so a line is written.
            try:
                process.stdin.write(b"\n")
                process.stdin.close()
            except BrokenPipeError:
                pass
            process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def open(self, path, body=None, timeout=300, **headers):
        """The open answer to a GET of /v1/<path>, or with a body to a POST. A problem is raised."""
        headers = {"User-Agent": "equipoise-python", **headers}
        if self._token:
            headers["Authorization"] = f"Bearer {self._token}"
        if body is not None:
            headers["Content-Type"] = "application/json"
        call, until = urllib.request.Request(f"{self.url}/v1/{path}", body, headers), time.monotonic() + PATIENCE
        while True:
            try:
                return self._opener.open(call, timeout=timeout)
            except urllib.error.HTTPError as error:
                with error:
                    text, wait = error.read().decode(errors="replace"), float(error.headers.get("Retry-After", 1))
                if error.code != 503 or time.monotonic() + wait > until:
                    try:
                        problem = json.loads(text)
                    except ValueError:
                        problem = {"title": error.reason, "status": error.code, "detail": text}
                    raise Problem(problem) from None
                time.sleep(wait)
            except urllib.error.URLError as error:
                raise ConnectionError(f"no server at {self.url}: {error.reason}") from error

    def read(self, path, body=None):
        """The bytes of an answer."""
        with self.open(path, body) as answer:
            return answer.read()

    def get(self, path):
        """The JSON of GET /v1/<path>: `get("scenes")`, `get("scenes/case-1")`, `get("fields")`, `get("paper")`."""
        return json.loads(self.read(path), object_hook=record)

    def ask(self, resource, **request):
        """The answer of a resource by its name; `stability(…)` is `ask("stability", …)`."""
        body = json.dumps(with_scene(request), default=plain, allow_nan=False).encode()
        return Answer(self, resource, body)

    def live(self, **request):
        """Messages of a live run as they happen: `hello`, an `impact` each, and `end`; `message.type` tells them apart.

        After a broken connection the run goes on with the next impact. Fields are those of /v1/live: a scene, `speed`, `epoch_ms`, …
        """
        request = with_scene(request)
        if "epoch_ms" not in request:
            request.setdefault("from", 1)  # The first impact of a run that begins now, also after a reconnect.
        query = urlencode(list(flat(json.loads(json.dumps(request, default=plain)))))
        last, until = {}, 0.0
        while True:
            try:
                with self.open(f"live/events?{query}", timeout=60, Accept="text/event-stream", **last) as events:
                    # A line that was cut off comes again.
                    for line in (line for line in events if line.startswith(b"data: ") and line.endswith(b"\n")):
                        for message in singly(json.loads(line[6:], object_hook=Record)):
                            if message.type == "hello":
                                # It has the epoch of the run.
                                query = urlsplit(message.url).query + (f"&from={request['from']}" if "from" in request else "")
                            elif message.type == "impact":
                                last = {"Last-Event-ID": str(message.n)}
                            yield message
                            until = time.monotonic() + PATIENCE
                            if message.type == "end":
                                return
            except (OSError, http.client.HTTPException):
                if time.monotonic() > until:
                    raise
            time.sleep(1)


def singly(message):
    """The message; of many impacts in columns, a message for each."""
    if message.type != "impacts":
        return [message]
    return [Record(type="impact", **dict(zip(message.columns, row))) for row in zip(*message.columns.values())]


def with_scene(request):
    """A request in which keywords such as `table` are in `scene`. A text stays outside: `contact` of controllers is one."""
    scene = {name: request.pop(name) for name in SCENE if name in request and not isinstance(request[name], str)}
    return {**request, "scene": merged(request.get("scene") or {}, scene)} if scene else request


def merged(one, other):
    """Merges objects by RFC 7396, as the server merges a scene onto a preset."""
    return {**one, **{name: merged(one.get(name) or {}, value) if isinstance(value, dict) else value for name, value in other.items()}}


def plain(value):
    """Arrays, series and data frames as lists, for JSON. NaN is a missing value, as in pandas."""
    for name in ("to_pydict", "tolist", "to_list", "to_pylist"):
        if hasattr(value, name):
            values = getattr(value, name)()
            return [None if each != each else each for each in values] if isinstance(values, list) else values
    if hasattr(value, "columns"):
        return {str(name): value[name] for name in value.columns}
    raise TypeError(f"{type(value).__name__} is not for a request")


def flat(value, path=""):
    """Parameters of a query for the fields of an object: `scene.table.tilt_gain`."""
    if isinstance(value, (dict, list)):
        for name, each in value.items() if isinstance(value, dict) else enumerate(value):
            yield from flat(each, f"{path}.{name}" if path else str(name))
    elif value is not None:
        yield path, value if isinstance(value, str) else json.dumps(value)


def method(name):
    def call(self, **request):
        return self.ask(name, **request)

    call.__name__, call.__qualname__, call.__doc__ = name, f"Server.{name}", RESOURCES[name].doc
    return call


for name in RESOURCES:
    setattr(Server, name, method(name))
