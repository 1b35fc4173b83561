"""Answers of the server: JSON objects with attributes, columns as data frames, pictures, and problems as exceptions."""

import json
from collections import namedtuple
from pathlib import Path

from ._resources import RESOURCES

FieldError = namedtuple("FieldError", "field detail")


class Problem(Exception):
    """A request that the server refuses. `errors` has the dotted name of each field and what is wrong with it."""

    def __init__(self, problem):
        super().__init__(problem)
        self.status, self.title, self.detail = (problem.get(name) for name in ("status", "title", "detail"))
        self.errors = [FieldError(each["pointer"].strip("/").replace("/", "."), each["detail"]) for each in problem.get("errors", [])]

    def __str__(self):
        fields = "".join(f"\n  {error.field}: {error.detail}" for error in self.errors)
        return f"{self.title} ({self.status}): {self.detail}{fields}"


class Record(dict):
    """A JSON object; `record.name` is `record["name"]`, except for the methods of a dict, such as `values`."""

    def __getattr__(self, name):
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"there is no {name}; there are {', '.join(self)}") from None

    def __setattr__(self, name, value):
        if name.startswith("_"):
            super().__setattr__(name, value)
        else:
            self[name] = value

    def __dir__(self):
        return [*super().__dir__(), *self]

    @property
    def json(self):
        """The same as plain dicts and lists."""
        return json.loads(json.dumps(self))


class Columns(Record):
    """Columns of one length by name, as lists. Data frames are made when they are asked for, by pandas, polars or pyarrow."""

    _source = None  # The answer whose Arrow stream has these columns, with units.

    def _arrow(self):
        return self._source.read("arrow") if self._source is not None else None

    def to_arrow(self):
        """A pyarrow.Table."""
        import pyarrow.ipc

        stream = self._arrow()
        return pyarrow.ipc.open_stream(stream).read_all() if stream else pyarrow.table(dict(self))

    def to_pandas(self):
        """A pandas.DataFrame: by Arrow if pyarrow is installed, else from the lists."""
        try:
            return self.to_arrow().to_pandas()
        except ImportError:
            import pandas

            return pandas.DataFrame(dict(self))

    def to_polars(self):
        """A polars.DataFrame, by Arrow."""
        import polars

        stream = self._arrow()
        return polars.read_ipc_stream(stream) if stream else polars.DataFrame(dict(self))

    def __reduce__(self):
        # Other processes get the values, without the connection.
        return Columns, (dict(self),)


class Answer(Columns):
    """The answer to a request. Its table is that of `format=arrow`; Jupyter shows its picture."""

    def __init__(self, server, resource, body):
        self._server, self._resource, self._body, self._source = server, resource, body, self
        super().__init__(json.loads(self.read("json"), object_hook=record))
        table = self.get(RESOURCES[resource].table)
        if isinstance(table, Columns):
            table._source = self

    def read(self, form):
        """The bytes of the answer in a format of the resource: json, csv, ndjson, arrow, svg, png."""
        return self._server.read(f"{RESOURCES[self._resource].path}?format={form}", self._body)

    def save(self, path):
        """Writes the answer to a file, in the format that its ending names: run.svg, run.csv, …"""
        Path(path).write_bytes(self.read(Path(path).suffix[1:]))

    def to_pandas(self):
        """A pandas.DataFrame. It needs pyarrow."""
        return self.to_arrow().to_pandas()

    def _repr_svg_(self):
        if RESOURCES[self._resource].picture:
            try:
                return self.read("svg").decode()
            except (Problem, ConnectionError):
                pass  # Such as periodic orbits without a sweep. The text is shown.
        return None

    def __repr__(self):
        said = self.get("verdict", {}).get("text") or self.get("outcome", {}).get("detail") or f"an answer with {', '.join(self)}"
        return f"<{self._resource}: {said}>"


def record(value):
    """A parsed object as Columns if it has columns, else as Record."""
    columns = [each for each in value.values() if isinstance(each, list)]
    flat = len(columns) == len(value) > 0 and len({len(each) for each in columns}) == 1
    return (Columns if flat and not any(isinstance(each, (list, dict)) for column in columns for each in column[:1]) else Record)(value)
