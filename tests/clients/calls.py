"""Writes a program for each generated client that calls every operation of the contract once: calls.py and calls.ts.

The calls are written out, so that type checkers hold every argument to the generated types. The arguments come from the contract too:
queries, examples of parameters and bodies. A new route is called without a change here.
"""

import json
import sys
from pathlib import Path
from urllib.parse import parse_qsl

import yaml
from openapi_python_client.strings import ClassName, PythonIdentifier

# A run that falls at its second contact, so that its events end.
ENDING = {"liveEvents": "preset=case-1&scene.contact.friction=0.1"}


def resolved(contract, node):
    while "$ref" in node:
        target = contract
        for key in node["$ref"][2:].split("/"):
            target = target[key]
        node = target
    return node


def value(contract, parameter, text):
    kind = resolved(contract, parameter["schema"]).get("type")
    return {"number": float, "integer": int, "boolean": "true".__eq__}.get(kind, str)(text)


def calls(contract):
    """Every operation as (operation, path, method, arguments of the path, of the query, body)."""
    for path, item in contract["paths"].items():
        for method in ("get", "head", "post"):
            if method not in item:
                continue
            operation = item[method]
            listed = item.get("parameters", []) + operation.get("parameters", [])
            parameters = {(one["in"], one["name"]): one for one in (resolved(contract, each) for each in listed)}
            placed = {name: one["example"] for (where, name), one in parameters.items() if where == "path"}
            queries = [ENDING.get(operation["operationId"]), operation.get("x-base-query"), *item.get("get", {}).get("x-queries", []), "preset=case-1"]
            names = {name for where, name in parameters if where == "query"}
            asked = {}
            for query in queries if method != "post" else []:
                pairs = [(name, text) for name, text in parse_qsl(query or "") if name != "format"]
                if pairs and all(name in names for name, _ in pairs):
                    asked = {name: value(contract, parameters["query", name], text) for name, text in pairs}
                    break
            body = None
            if "requestBody" in operation:
                # A JSON object, or the text of NDJSON.
                [content] = operation["requestBody"]["content"].values()
                body = next(iter(content["examples"].values()))["value"]
            yield operation, path, method, placed, asked, body


def media(contract, operation):
    success = next(response for status, response in operation["responses"].items() if status < "300")
    return list(resolved(contract, success).get("content", {}))


def python(contract):
    head, body = ["import io", "import json", "import sys", "from typing import Any, Callable", "", "import httpx", "from generated import Client, models", "from generated.types import File, Response"], []
    for operation, _, _, placed, asked, given in calls(contract):
        module = PythonIdentifier(operation["operationId"], "field_")
        head.append(f"from generated.api.{PythonIdentifier(operation['tags'][0], 'tag')} import {module} as {module}_")
        arguments = [f"{PythonIdentifier(name, 'field_')}={value!r}" for name, value in (placed | asked).items()]
        if isinstance(given, str):
            arguments.append(f"body=File(io.BytesIO({given.encode()!r}))")
        elif given is not None:
            schema = operation["requestBody"]["content"]["application/json"]["schema"]["$ref"].split("/")[-1]
            arguments.append(f"body=models.{ClassName(schema, 'field_')}.from_dict({given!r})")
        client = "upgrading" if "101" in operation["responses"] else "client"
        is_json = "application/json" in media(contract, operation)
        call = f"lambda: {module}_.sync_detailed({', '.join([f'client={client}', *arguments])})"
        body.append(f"calls.append(({operation['operationId']!r}, {is_json}, {call}))")
    return "\n".join(head + [PYTHON_START] + body + [PYTHON_END])


PYTHON_START = """
client = Client(base_url=sys.argv[1], timeout=httpx.Timeout(120), raise_on_unexpected_status=True)
handshake = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA=="}
upgrading = Client(base_url=sys.argv[1], timeout=httpx.Timeout(120), headers=handshake)
calls: list[tuple[str, bool, Callable[[], Response[Any]]]] = []
"""
PYTHON_END = """
wrongs = []
for name, is_json, call in calls:
    try:
        answer = call()
        assert 200 <= answer.status_code < 300 or answer.status_code == 101 and "live" == name, answer.status_code
        if is_json:
            # The model keeps the whole answer.
            assert answer.parsed is not None and answer.parsed.to_dict() == json.loads(answer.content), "the model is not the answer"
    except Exception as wrong:
        wrongs.append(f"{name}: {type(wrong).__name__}: {wrong}"[:600])
print(f"Python: {len(calls)} operations called, {len(wrongs)} wrong", *wrongs, sep="\\n  ")
sys.exit(len(wrongs) > 0)
"""


def typescript(contract):
    lines = [TYPESCRIPT_START]
    for operation, path, method, placed, asked, given in calls(contract):
        parameters = {where: given for where, given in (("path", placed), ("query", asked)) if given}
        options = ({"params": parameters} if parameters else {}) | ({} if given is None else {"body": given})
        if "application/json" not in media(contract, operation):
            options["parseAs"] = "text"
        options = json.dumps(options)
        if isinstance(given, str):
            options = options[:-1] + ", \"bodySerializer\": String, \"headers\": { \"Content-Type\": \"application/x-ndjson\" }}"
        # fetch cannot request an upgrade, so here the other answer of the contract is right.
        expected = 426 if "101" in operation["responses"] else 200
        lines.append(f"calls.push([{json.dumps(operation['operationId'])}, {expected}, () => client.{method.upper()}({json.dumps(path)}, {options})]);")
    return "\n".join([*lines, TYPESCRIPT_END])


TYPESCRIPT_START = """import createClient from 'openapi-fetch';
import type { paths } from './contract.js';
declare const process: { argv: string[]; exitCode: number };

type Result = { data?: unknown; error?: unknown; response: Response };
const client = createClient<paths>({ baseUrl: process.argv[2] });
const calls: [string, number, () => Promise<Result>][] = [];
"""
TYPESCRIPT_END = """
const wrongs: string[] = [];
for (const [name, expected, call] of calls) {
  try {
    const { data, error, response } = await call();
    if (response.status !== expected) wrongs.push(`${name}: ${response.status}: ${JSON.stringify(error)}`);
    else if (response.ok && data === undefined && response.headers.has('content-type') && !name.startsWith('head')) wrongs.push(`${name}: nothing was read`);
  } catch (wrong) {
    wrongs.push(`${name}: ${wrong}`);
  }
}
console.log([`TypeScript: ${calls.length} operations called, ${wrongs.length} wrong`, ...wrongs].join('\\n  '));
process.exitCode = wrongs.length > 0 ? 1 : 0;
"""

if __name__ == "__main__":
    contract, folder = yaml.safe_load(Path(sys.argv[1]).read_text()), Path(sys.argv[2])
    (folder / "calls.py").write_text(python(contract))
    (folder / "calls.ts").write_text(typescript(contract))
