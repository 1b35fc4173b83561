"""Differences between two answers, by the path of each value."""

import csv
import io
import json
import re
from typing import Any, NamedTuple, Optional


class Difference(NamedTuple):
    """A value that differs. `group` is its path without positions; `relative` is null unless both are numbers."""

    path: str
    group: str
    old: Any
    new: Any
    relative: Optional[float]


# Members of `precision` that come from a clock.
CLOCK = {"cost_ns_per_bounce", "spread_ns_per_bounce", "cost", "cost_lower", "cost_upper", "repeats", "pareto"}

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")

MISSING = "(missing)"


def tree(body, kind, resource):
    """An answer as a tree of values."""
    text = None if kind.startswith(("image/png", "application/vnd.apache.arrow")) else body.decode()
    if text is None:
        return {"(bytes)": body}
    if kind.startswith(("application/json", "application/problem+json")):
        read = json.loads(text)
    elif kind.startswith("application/x-ndjson"):
        read = [json.loads(line) for line in text.splitlines()]
    elif kind.startswith("text/csv"):
        rows = list(csv.reader(io.StringIO(text)))
        names = rows[0] if rows else []
        read = {"(columns)": names}
        for index, name in enumerate(names):
            read[name] = [number(row[index]) if index < len(row) else MISSING for row in rows[1:]]
    elif kind.startswith("application/openmetrics-text"):
        read = {line.rpartition(" ")[0]: number(line.rpartition(" ")[2]) for line in text.splitlines() if not line.startswith("#")}
    else:
        # Of a picture: its numbers, and the text between them.
        read = {"(picture, numbers)": [float(it) for it in NUMBER.findall(text)], "(picture, text)": NUMBER.split(text)}
    return without_clock(read) if resource == "precision" else read


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def without_clock(read):
    if isinstance(read, list):
        return [without_clock(value) for value in read]
    if not isinstance(read, dict):
        return read
    # The speed of a column is told in its header: `cost_ns_per_bounce`.
    kept = {name: value for name, value in read.items() if not (name in CLOCK or name.startswith("cost_") or name == "time")}
    return {name: without_clock(value) for name, value in kept.items()}


def differences(old, new, path="", group=""):
    """All values that differ."""
    if isinstance(old, dict) and isinstance(new, dict):
        for name in [*old, *(name for name in new if name not in old)]:
            deeper = (f"{path}.{name}".lstrip("."), f"{group}.{name}".lstrip("."))
            yield from differences(old.get(name, MISSING), new.get(name, MISSING), *deeper)
    elif isinstance(old, list) and isinstance(new, list):
        for index, (left, right) in enumerate(zip(old, new)):
            yield from differences(left, right, f"{path}[{index}]", f"{group}[]")
        if len(old) != len(new):
            yield Difference(f"{path}.length", f"{group}.length", len(old), len(new), None)
    elif isinstance(old, bytes) and isinstance(new, bytes):
        if old != new:
            at = next((at for at, (left, right) in enumerate(zip(old, new)) if left != right), min(len(old), len(new)))
            yield Difference(f"{path} from byte {at}", group, f"{len(old)} bytes", f"{len(new)} bytes", None)
    elif type(old) is not type(new) and not (numeric(old) and numeric(new)):
        yield Difference(path or "(whole)", group or "(whole)", old, new, None)
    elif old != new:
        relative = abs(old - new) / max(abs(old), abs(new)) if numeric(old) and numeric(new) else None
        yield Difference(path or "(whole)", group or "(whole)", old, new, relative)


def numeric(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def compared(old, new, resource):
    """Differences of two answers: status, kind and body. A build id in a body is none."""
    if old.status != new.status:
        return [Difference("(status)", "(status)", told(old), told(new), None)]
    if old.kind != new.kind:
        return [Difference("(content-type)", "(content-type)", old.kind, new.kind, None)]
    if old.body == new.body:
        return []
    found = list(differences(tree(old.body, old.kind, resource), tree(new.body, new.kind, resource)))
    if not found and resource != "precision":
        found = [Difference("(bytes)", "(bytes)", f"{len(old.body)} bytes", f"{len(new.body)} bytes of the same values", None)]
    return found


def told(answer):
    """The status of an answer, and the reasons of a refusal."""
    if answer.status == 200:
        return "200"
    try:
        problem = json.loads(answer.body)
        reasons = [f"{error.get('pointer')}: {error.get('detail')}" for error in problem.get("errors", [])]
        return f"{answer.status} {'; '.join(reasons) or problem.get('detail')}"
    except ValueError:
        return str(answer.status)
