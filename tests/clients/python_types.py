"""Writes what the Python package has from openapi.yaml: the list of its functions with their texts, and their types.

`python_types.py` fails if a file is not up to date; with UPDATE=1 it writes them. It needs PyYAML.
"""

import keyword
import os
import re
import sys
import textwrap
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python/equipoise"
CONTRACT = yaml.load((ROOT / "openapi.yaml").read_text(), getattr(yaml, "CSafeLoader", yaml.SafeLoader))
SCHEMAS = CONTRACT["components"]["schemas"]
# Members of answers that are their Arrow table.
TABLES = {"trajectories": "impacts", "fits": "residuals"}
# Types of schemas that have a name in Python.
NAMED = {"ScenePatch": "Scene", "PresetName": "Preset"}


def followed(schema, section="schemas"):
    return CONTRACT["components"][section][schema["$ref"].split("/")[-1]] if "$ref" in schema else schema


def type_of(schema):
    """The Python type of a schema. Objects other than the parts of a scene are dicts."""
    name = schema.get("$ref", "").split("/")[-1]
    if name in NAMED:
        return NAMED[name]
    schema = followed(schema)
    kinds = schema.get("type", [])
    kinds = [kinds] if isinstance(kinds, str) else kinds
    if "enum" in schema:
        return "Literal[" + ", ".join(f'"{each}"' for each in schema["enum"] if each is not None) + "]" + (" | None" if None in schema["enum"] else "")
    if "anyOf" in schema or "oneOf" in schema:
        return " | ".join(dict.fromkeys(type_of(each) for each in schema.get("anyOf") or schema["oneOf"]))
    names = {"number": "float", "integer": "int", "boolean": "bool", "string": "str", "null": "None", "array": "Sequence[Any]", "object": "Mapping[str, Any]"}
    return " | ".join(names[kind] for kind in kinds) or "Any"


def described(properties):
    for name, schema in properties.items():
        text = schema.get("description") or followed(schema).get("description") or ""
        yield name, re.sub(r"\s+", " ", text).strip()


def documentation(item, fields):
    description = re.sub(r"\s+", " ", item.get("get", item["post"])["description"])
    lines = [item["post"]["summary"] + ".", "", *textwrap.wrap(description, 110), "", "Fields, besides those of a scene:"]
    for name, text in fields:
        lines += textwrap.wrap(f"{name}: {text}".rstrip(": "), 110, initial_indent="    ", subsequent_indent="        ")
    return "\n".join(lines)


def written():
    scene = SCHEMAS["ScenePatch"]["properties"]
    parts = {name: name.capitalize() for name, schema in scene.items() if "properties" in schema}
    types = {name: f"{parts[name]} | None" if name in parts else type_of(schema) for name, schema in scene.items()}
    resources, calls = [], []
    for path, item in CONTRACT["paths"].items():
        if "post" not in item or "{" in path:
            continue
        operation = item["post"]
        formats = followed(operation["responses"]["200"], "responses")["content"]
        request = followed(operation["requestBody"]["content"]["application/json"]["schema"])
        fields, name = request["properties"], path.split("/")[-1].replace("-", "_")
        assert not any(map(keyword.iskeyword, fields)), path
        own = {field: type_of(schema) for field, schema in fields.items()}
        every = own | {field: f"{kind} | {own[field]}" if field in own else kind for field, kind in types.items()}
        must = request.get("required", [])
        arguments = ", ".join(f"{field}: {kind}" + ("" if field in must else " = ...") for field, kind in every.items())
        calls.append((name, operation["summary"], arguments))
        doc = documentation(item, described({field: schema for field, schema in fields.items() if field != "scene"}))
        resources.append(f'    "{name}": Resource("{path[4:]}", {TABLES.get(name)!r}, {"image/svg+xml" in formats}, """{doc}\n"""),')
    head = "written from openapi.yaml by tests/clients/python_types.py"
    listed = f'''"""The resources that compute, {head}."""

from collections import namedtuple

# Path under /v1, member of the answer that is its Arrow table, whether it has a picture, documentation.
Resource = namedtuple("Resource", "path table picture doc")

SCENE = {tuple(scene)!r}

RESOURCES = {{
{chr(10).join(resources)}
}}
'''
    presets = type_of({"enum": SCHEMAS["PresetName"]["enum"]})
    classes = []
    for name, title in parts.items():
        members = scene[name]["properties"].items()
        classes.append(f"class {title}(TypedDict, total=False):\n" + "".join(f"    {member}: {type_of(schema)}\n" for member, schema in members))
    classes.append("class Scene(TypedDict, total=False):\n" + "".join(f"    {name}: {kind}\n" for name, kind in types.items()))
    indented = "".join(f'    def {name}(self, *, {arguments}) -> Answer:\n        """{summary}."""\n' for name, summary, arguments in calls)
    free = "".join(f'def {name}(*, {arguments}) -> Answer:\n    """{summary}."""\n' for name, summary, arguments in calls)
    stub = f'''"""Types, {head}."""

from collections.abc import Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, NamedTuple, TypedDict

class FieldError(NamedTuple):
    field: str
    detail: str

class Problem(Exception):
    status: int
    title: str
    detail: str
    errors: list[FieldError]

class Record(dict[str, Any]):
    def __getattr__(self, name: str) -> Any: ...
    @property
    def json(self) -> dict[str, Any]: ...

class Columns(Record):
    def to_arrow(self) -> Any: ...
    def to_pandas(self) -> Any: ...
    def to_polars(self) -> Any: ...

class Answer(Columns):
    def read(self, form: str) -> bytes: ...
    def save(self, path: str | PathLike[str]) -> None: ...

Preset = {presets}

{chr(10).join(classes)}
class Server:
    url: str
    @property
    def ended(self) -> bool: ...
    def __init__(self, url: str | None = None, token: str | None = None, *, program: str | None = None, arguments: Sequence[str] = ()) -> None: ...
    def __enter__(self) -> Server: ...
    def __exit__(self, *_: object) -> None: ...
    def close(self) -> None: ...
    def get(self, path: str) -> Record: ...
    def ask(self, resource: str, **request: Any) -> Answer: ...
    def read(self, path: str, body: bytes | None = None) -> bytes: ...
    def live(self, **request: Any) -> Iterator[Record]: ...
{indented}
def server() -> Server: ...
def get(path: str) -> Record: ...
def live(**request: Any) -> Iterator[Record]: ...
{free}'''
    return {PACKAGE / "_resources.py": listed, PACKAGE / "__init__.pyi": stub}


old = [path for path, text in written().items() if not path.exists() or path.read_text() != text]
for path in old:
    if os.environ.get("UPDATE"):
        path.write_text(written()[path])
    else:
        sys.exit(f"{path.relative_to(ROOT)} is not up to date; UPDATE=1 tests/clients/run python writes it")
