"""Calls every operation of the contract once with each generated client.

    calls.py typescript CONTRACT FOLDER        writes a program for each client of the table TYPESCRIPT: calls.*.ts
    calls.py python CONTRACT FOLDER            writes one for openapi-python-client: calls.py
    calls.py models CONTRACT FOLDER ADDRESS    calls with the models of datamodel-code-generator

Calls are written out, so that type checkers hold every argument to the generated types. The arguments come from the contract too:
queries, examples of parameters and bodies. A new route is called without a change here.
"""

import importlib
import inspect
import json
import sys
from pathlib import Path
from typing import get_args
from urllib.error import HTTPError
from urllib.parse import parse_qsl, urlencode
from urllib.request import Request, urlopen

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
                content = next(iter(operation["requestBody"]["content"].values()))
                body = next(iter(content["examples"].values()))["value"]
            yield operation, path, method, placed, asked, body


def media(contract, operation):
    success = next(response for status, response in operation["responses"].items() if status < "300")
    return list(resolved(contract, success).get("content", {}))


def python(contract):
    """Calls by openapi-python-client, of which the contract has JSON alone."""
    head, body = ["import json", "import sys", "from typing import Any, Callable", "", "import httpx", "from equipoise_client import Client, models", "from equipoise_client.types import Response"], []
    for operation, _, _, placed, asked, given in calls(contract):
        module = PythonIdentifier(operation["operationId"], "field_")
        path = f"equipoise_client.api.{PythonIdentifier(operation['tags'][0], 'tag')}"
        head.append(f"from {path} import {module} as {module}_")
        kinds = inspect.signature(importlib.import_module(f"{path}.{module}").sync_detailed).parameters
        arguments = []
        for name, value in (placed | asked).items():
            identifier = PythonIdentifier(name, "field_")
            # A word is a member of an enum.
            kind = [*get_args(kinds[identifier].annotation), kinds[identifier].annotation][0].__name__
            arguments.append(f"{identifier}=models.{kind}({value!r})" if isinstance(value, str) and kind != "str" else f"{identifier}={value!r}")
        if given is not None:
            arguments.append(f"body=models.{ClassName(reference(operation['requestBody']), 'field_')}.from_dict({given!r})")
        is_json = "application/json" in media(contract, operation)
        call = f"lambda: {module}_.sync_detailed({', '.join(['client=client', *arguments])})"
        body.append(f"calls.append(({operation['operationId']!r}, {is_json}, {call}))")
    return "\n".join(head + [PYTHON_START] + body + [PYTHON_END])


def reference(content):
    """Name of the schema of JSON."""
    return content["content"]["application/json"]["schema"]["$ref"].split("/")[-1]


PYTHON_START = """
client = Client(base_url=sys.argv[1], timeout=httpx.Timeout(120), raise_on_unexpected_status=True)
calls: list[tuple[str, bool, Callable[[], Response[Any]]]] = []
"""
PYTHON_END = """
wrongs = []
for name, is_json, call in calls:
    try:
        answer = call()
        assert 200 <= answer.status_code < 300, answer.status_code
        if is_json:
            # The model keeps the whole answer.
            assert answer.parsed is not None and answer.parsed.to_dict() == json.loads(answer.content), "the model is not the answer"
    except Exception as wrong:
        wrongs.append(f"{name}: {type(wrong).__name__}: {wrong}"[:600])
print(f"openapi-python-client: {len(calls)} operations called, {len(wrongs)} wrong", *wrongs, sep="\\n  ")
sys.exit(len(wrongs) > 0)
"""


def modelled(contract, address):
    """Calls every operation with the models of datamodel-code-generator, which keep the whole requests and answers."""
    models, told, wrongs = importlib.import_module("models"), 0, []
    for operation, path, method, placed, asked, given in calls(contract):
        name, told = operation["operationId"], told + 1
        try:
            url = address + path.format_map(placed) + ("?" + urlencode({key: json.dumps(of) if isinstance(of, bool) else of for key, of in asked.items()}) if asked else "")
            content_type = next(iter(operation.get("requestBody", {}).get("content", {"": None})))
            if isinstance(given, dict):
                body = getattr(models, reference(operation["requestBody"])).model_validate(given)
                assert body.model_dump(mode="json", exclude_unset=True, by_alias=True) == given, "the model is not the request"
                given = body.model_dump_json(exclude_unset=True, by_alias=True)
            request = Request(url, given and given.encode(), {"Content-Type": content_type}, method=method.upper())
            with urlopen(request, timeout=120) as answer:
                text = answer.read()
            if "application/json" in media(contract, operation) and method != "head":
                success = resolved(contract, next(of for status, of in operation["responses"].items() if status < "300"))
                schema = success["content"]["application/json"]["schema"]
                if "$ref" in schema:
                    model = getattr(models, schema["$ref"].split("/")[-1]).model_validate_json(text)
                    assert model.model_dump(mode="json", exclude_unset=True, by_alias=True) == json.loads(text), "the model is not the answer"
        except HTTPError as wrong:
            # The upgrade to a WebSocket is not asked for.
            if not (wrong.code == 426 and "101" in operation["responses"]):
                wrongs.append(f"{name}: {wrong.code}: {wrong.read()[:300]!r}")
        except Exception as wrong:
            wrongs.append(f"{name}: {type(wrong).__name__}: {wrong}"[:600])
    print(f"datamodel-code-generator: {told} operations called, {len(wrongs)} wrong", *wrongs, sep="\n  ")
    sys.exit(len(wrongs) > 0)


# How the calls of each TypeScript client are written: its lines at the head, and a call with its arguments of path and query, and its body.
# A result has `data`, `error` and `response`, as that of openapi-fetch and of @hey-api/openapi-ts.
TYPESCRIPT = {
    "openapi-fetch": (
        """import createClient from 'openapi-fetch';
import type { paths } from './contract.js';
const client = createClient<paths>({ baseUrl: address });""",
        lambda operation, path, method, placed, asked, body: f"client.{method.upper()}({json.dumps(path)}, {fetched(operation, placed, asked, body)})",
    ),
    "hey-api": (
        """import * as sdk from './hey-api/index.js';
import { client } from './hey-api/client.gen.js';
client.setConfig({ baseUrl: address });
/** All events until the end of the run. */
async function listened(events: ReturnType<typeof sdk.liveEvents>) {
  const data: unknown[] = [];
  for await (const message of (await events).stream) if (data.push(message) && JSON.stringify(message).includes('"end"')) break;
  return { data, response: { status: 200, ok: true, headers: new Headers() } };
}""",
        lambda operation, path, method, placed, asked, body: ("listened(sdk.{}({}))" if operation["operationId"] == "liveEvents" else "sdk.{}({})").format(
            operation["operationId"], options({"path": placed, "query": asked}, body)
        ),
    ),
    "orval": (
        """import axios, { type AxiosResponse } from 'axios';
import * as api from './orval.js';
axios.defaults.baseURL = address;
axios.defaults.validateStatus = () => true;
async function answered(call: Promise<AxiosResponse<unknown>>) {
  const { data, status, headers } = await call;
  const ok = status < 300;
  return { data, error: ok ? undefined : data, response: { status, ok, headers: new Headers({ 'content-type': String(headers['content-type'] ?? '') }) } };
}""",
        lambda operation, path, method, placed, asked, body: "answered(api.{}({}))".format(
            operation["operationId"], ", ".join([*map(json.dumps, placed.values()), *written(body), *([json.dumps(asked)] if asked else [])])
        ),
    ),
}


def written(body):
    """A body as arguments: a JSON object, or NDJSON as a blob."""
    return [] if body is None else [f"new Blob([{json.dumps(body)}], {{ type: 'application/x-ndjson' }})" if isinstance(body, str) else json.dumps(body)]


def options(arguments, body):
    parts = [f"{name}: {json.dumps(given)}" for name, given in arguments.items() if given] + [f"body: {text}" for text in written(body)]
    return f"{{ {', '.join(parts)} }}" if parts else ""


def fetched(operation, placed, asked, body):
    parameters = {where: given for where, given in (("path", placed), ("query", asked)) if given}
    given = ({"params": parameters} if parameters else {}) | ({} if body is None else {"body": body})
    if "application/json" not in operation["media"]:
        given["parseAs"] = "text"
    text = json.dumps(given)
    ndjson = ', "bodySerializer": String, "headers": { "Content-Type": "application/x-ndjson" }}'
    return text[:-1] + ndjson if isinstance(body, str) else text


def typescript(contract, client):
    head, call = TYPESCRIPT[client]
    lines = [TYPESCRIPT_START, head]
    for operation, *arguments in calls(contract):
        # Neither fetch nor axios can request an upgrade, so here the other answer of the contract is right.
        expected = 426 if "101" in operation["responses"] else 200
        told = operation | {"media": media(contract, operation)}
        lines.append(f"calls.push([{json.dumps(operation['operationId'])}, {expected}, () => {call(told, *arguments)}]);")
    return "\n".join([*lines, TYPESCRIPT_END.replace("CLIENT", client)])


TYPESCRIPT_START = """declare const process: { argv: string[]; exitCode: number };
const address = process.argv[2];
type Result = { data?: unknown; error?: unknown; response?: { status: number; ok: boolean; headers: Headers } };
const calls: [string, number, () => Promise<Result>][] = [];
"""
TYPESCRIPT_END = """
const wrongs: string[] = [];
for (const [name, expected, call] of calls) {
  try {
    const { data, error, response } = await call();
    if (response?.status !== expected) wrongs.push(`${name}: ${response?.status}: ${JSON.stringify(error)}`);
    else if (response.ok && data === undefined && response.headers.has('content-type') && !name.startsWith('head')) wrongs.push(`${name}: nothing was read`);
  } catch (wrong) {
    wrongs.push(`${name}: ${wrong}`);
  }
}
console.log([`CLIENT: ${calls.length} operations called, ${wrongs.length} wrong`, ...wrongs].join('\\n  '));
process.exitCode = wrongs.length > 0 ? 1 : 0;
export {};
"""

if __name__ == "__main__":
    task, contract, folder, *rest = sys.argv[1:]
    contract = yaml.safe_load(Path(contract).read_text())
    sys.path.insert(0, folder)
    if task == "models":
        modelled(contract, *rest)
    elif task == "python":
        Path(folder, "calls.py").write_text(python(contract))
    else:
        for client in TYPESCRIPT:
            Path(folder, f"calls.{client}.ts").write_text(typescript(contract, client))
