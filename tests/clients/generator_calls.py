"""Clients of openapi-generator: every operation is called with every example of the contract, and every answer is decoded.

    generator_calls.py python CONTRACT CLIENT ADDRESS ANSWERS    calls the Python client in the folder CLIENT; writes the answers to a file
    generator_calls.py documented PAGE CLIENT ADDRESS            runs the lines for the Python client in a page of docs
    generator_calls.py rust CONTRACT CLIENT                      prints the same calls for the Rust client in the folder CLIENT
    generator_calls.py compare ANSWERS DECODED                   compares the lines of openapi-generator/main.rs with the answers

A decoded request or answer is encoded again, and has to be the one that was decoded. In answers a null is as good as no member.
"""

import importlib
import inspect
import json
import re
import sys
import textwrap
from pathlib import Path
from urllib.parse import parse_qsl

import yaml

from calls import ENDING, media, resolved, value

PACKAGE = "equipoise_client"
# Calls that fail by a fault of a generator: the error (a pattern) and the reason. A call that does not fail so is an error of this table.
NO_UPGRADE = r"\b426\b", "the client cannot request the upgrade to a WebSocket"
NO_HTML = "Received `text/html", "of texts, the client decodes text/plain alone"
NO_EVENTS = "Received `text/event-stream", "of texts, the client decodes text/plain alone"
# The server refuses by the head of the request and closes, which the client may notice before the answer.
NO_TYPE = r"\b415\b|error sending request", "the client sends a body that is not JSON without its Content-Type; it is sent once more with it"
FAULTS = {
    "Python": {"live": NO_UPGRADE},
    "Rust": {"live": NO_UPGRADE, "page": NO_HTML, "docs": NO_HTML, "paperPage": NO_HTML, "rigPage": NO_HTML, "embed": NO_HTML, "liveEvents": NO_EVENTS, "postBatch": NO_TYPE},
}
# Members that a clock measures, and what follows from them: compared by their type between two requests.
MEASURED = {"cost_ns_per_bounce", "spread_ns_per_bounce", "repeats", "pareto"}
# Parts of texts that differ between two requests: counts of requests, and names of requests.
CHANGING = {"metrics": r"^[^#].*\n", "postBatch": r'"request_id":"[^"]*"'}


def snake(name):
    return re.sub(r"\W", "_", re.sub("([a-z])([A-Z])", r"\1_\2", name)).strip("_").lower()


def examples(contract):
    """Every call: operation, method, arguments by name, and the body with the name of its schema."""
    for item in contract["paths"].values():
        for method in ("get", "head", "post"):
            if method not in item:
                continue
            operation = item[method]
            listed = [resolved(contract, each) for each in item.get("parameters", []) + operation.get("parameters", [])]
            placed = {one["name"]: one["example"] for one in listed if one["in"] == "path"}
            if method == "post":
                content = next(iter(operation["requestBody"]["content"].values()))
                reference = content["schema"].get("$ref", "")
                for example in content["examples"].values():
                    yield operation, method, placed, (reference.split("/")[-1], example["value"])
                continue
            queries = {one["name"]: one for one in listed if one["in"] == "query"}
            given = [item["get"].get("x-base-query"), *item["get"].get("x-queries", [])]
            if operation["operationId"] in ENDING:
                given = [ENDING[operation["operationId"]]]
            asked, told = [], set()
            for query in filter(None, given):
                pairs = dict(parse_qsl(query))
                if "json" == pairs.pop("format", "json") and all(name in queries for name in pairs):
                    asked.append({name: value(contract, queries[name], text) for name, text in pairs.items()})
            asked = asked or [{"preset": "case-1"} if "preset" in queries else {}]
            for arguments in asked[:1] if method == "head" else asked:
                if (key := json.dumps(arguments)) not in told:
                    told.add(key)
                    yield operation, method, placed | arguments, None


def is_json(contract, operation, method):
    return method != "head" and "application/json" in media(contract, operation)


def differs(told, decoded, place=""):
    """The first difference, or None."""
    if isinstance(told, dict) and isinstance(decoded, dict):
        found = (differs(told.get(name), decoded.get(name), f"{place}/{name}") for name in sorted(told.keys() | decoded.keys()))
        return next(filter(None, found), None)
    if isinstance(told, list) and isinstance(decoded, list) and len(told) == len(decoded):
        found = (differs(*pair, f"{place}/{index}") for index, pair in enumerate(zip(told, decoded)))
        return next(filter(None, found), None)
    if isinstance(told, bool) is isinstance(decoded, bool) and told == decoded:
        return None
    return f"{place}: {json.dumps(decoded)[:200]} is not {json.dumps(told)[:200]}"


def kind(value):
    return "number" if type(value) in (int, float) else type(value).__name__


def without_times(answer):
    if isinstance(answer, dict):
        return {name: kind(of) if name in MEASURED else without_times(of) for name, of in answer.items()}
    return [without_times(each) for each in answer] if isinstance(answer, list) else answer


def leave_out(model):
    """A model made by `from_dict` names members that are not there as null, which would remove values of a preset."""
    if isinstance(model, list):
        for each in model:
            leave_out(each)
    for name in list(getattr(model, "model_fields_set", [])):
        if getattr(model, name) is None:
            model.model_fields_set.discard(name)
        else:
            leave_out(getattr(model, name))


def adds_null(text, sent):
    """True if a member is null that is not there in the text."""
    if isinstance(sent, list):
        return any(map(adds_null, text, sent))
    if not isinstance(sent, dict):
        return False
    return any(of is None if name not in text else adds_null(text[name], of) for name, of in sent.items())


def restricted(sent, text):
    """The members that are there in the text. `from_dict` adds the defaults that the contract names."""
    if isinstance(sent, list):
        return list(map(restricted, sent, text))
    return {name: restricted(of, text[name]) for name, of in sent.items() if name in text} if isinstance(sent, dict) else sent


def python(contract, client, address, answers):
    sys.path.insert(0, client)
    package = importlib.import_module(PACKAGE)
    connection = package.ApiClient(package.Configuration(host=address))
    lines, wrongs, filled = [], [], 0
    for operation, method, arguments, body in examples(contract):
        name = operation["operationId"]
        call = getattr(getattr(package, operation["tags"][0] + "Api")(connection), snake(name) + "_with_http_info")
        line = {"operation": name, "request": body[1] if body and body[0] else None, "answer": None}
        lines.append(line)
        error = None
        try:
            given = {snake(parameter): value for parameter, value in arguments.items()}
            if body is not None:
                schema, text = body
                [parameter] = [one for one in inspect.signature(call).parameters if one == "body" or one.endswith("_request")]
                made = getattr(package, schema).from_dict(text) if schema else text.encode()
                if schema:
                    filled += adds_null(text, made.to_dict())
                    leave_out(made)
                    if adds_null(text, made.to_dict()):
                        wrongs.append(f"{name}: the request has more nulls than {json.dumps(text)}: {made.to_json()}")
                    elif wrong := differs(text, restricted(made.to_dict(), text)):
                        wrongs.append(f"{name}, request: {wrong}")
                given[parameter] = made
            answer = call(**given)
            if is_json(contract, operation, method):
                line["answer"] = json.loads(answer.raw_data)
                decoded = json.loads(answer.data.to_json()) if hasattr(answer.data, "to_json") else answer.data
                if wrong := differs(line["answer"], decoded):
                    wrongs.append(f"{name}: {wrong}")
            elif method != "head":
                text = answer.data.encode() if isinstance(answer.data, str) else bytes(answer.data)
                line["answer"] = answer.raw_data.decode()
                if not text or text != answer.raw_data:
                    wrongs.append(f"{name}: {text[:200]!r} is not {answer.raw_data[:200]!r}")
        except Exception as failure:
            error = f"{type(failure).__name__}: {failure}"[:600]
        wrongs += judged("Python", name, error)
    if not filled:
        wrongs.append("from_dict adds no null: leave_out is not needed any more")
    Path(answers).write_text("".join(json.dumps(line) + "\n" for line in lines))
    report("Python", lines, wrongs)


def documented(page, client, address):
    sys.path.insert(0, client)
    [lines] = re.findall(r"^  ```python\n(  from openapi_client .*?)^  ```", Path(page).read_text(), re.DOTALL | re.MULTILINE)
    for text in ("openapi_client", "http://127.0.0.1:8080"):
        assert text in lines, text
    exec(textwrap.dedent(lines).replace("openapi_client", PACKAGE).replace("http://127.0.0.1:8080", address), {})


def judged(language, name, error):
    """The error of a call, unless it is the one that is expected."""
    expected, reason = FAULTS[language].get(name, (None, None))
    if expected is None:
        return [] if error is None else [f"{name}: {error}"]
    return [] if error and re.search(expected, error) else [f"{name}: {error or 'no error'}; expected is {expected!r}, since {reason}"]


def compare(answers, decoded):
    lines = [json.loads(line) for line in Path(answers).read_text().splitlines()]
    found = iter([json.loads(line) for line in Path(decoded).read_text().splitlines()])
    wrongs = []
    for line in lines:
        name = line["operation"]
        if line["request"] is not None:
            _, request = next(found)
            if wrong := differs(line["request"], request):
                wrongs.append(f"{name}, request: {wrong}")
        outcome, called, answer = next(found)
        assert called == name, f"{called} is called in place of {name}"
        wrongs += judged("Rust", name, answer if outcome == "error" else None)
        if FAULTS["Rust"].get(name) == NO_TYPE:
            outcome, _, answer = next(found)
            if outcome == "error":
                wrongs.append(f"{name}, with Content-Type: {answer}")
        if outcome == "error":
            continue
        if name in CHANGING:
            wrong = differs(*(re.sub(CHANGING[name], "", text, flags=re.M) for text in (line["answer"], answer)))
        elif "Precision" in name:
            wrong = differs(without_times(line["answer"]), without_times(answer))
        else:
            wrong = differs(line["answer"], answer)
        if wrong:
            wrongs.append(f"{name}: {wrong}")
    if left := list(found):
        wrongs.append(f"{len(left)} lines too many")
    report("Rust", lines, wrongs)


def report(language, lines, wrongs):
    operations = len({line["operation"] for line in lines})
    print(f"openapi-generator, {language}: {len(lines)} calls of {operations} operations, {len(wrongs)} wrong", *wrongs, sep="\n  ")
    sys.exit(len(wrongs) > 0)


def functions(client):
    """Functions of the Rust client by name: module, parameters as (name, type), without the configuration, and the type of the answer."""
    found = {}
    for file in sorted(Path(client, "src/apis").glob("*_api.rs")):
        signature = r"^pub (?:async )?fn (\w+)\(configuration: &configuration::Configuration(?:, )?(.*?)\) -> Result<(.*), Error<"
        for name, parameters, answer in re.findall(signature, file.read_text(), re.M):
            found[name] = file.stem, [tuple(one.split(": ", 1)) for one in parameters.split(", ") if one], answer
    return found


def rust(contract, client):
    known, lines = functions(client), []
    for operation, _, arguments, body in examples(contract):
        name = operation["operationId"]
        module, parameters, answer = known[snake(name)]
        given = {snake(parameter): value for parameter, value in arguments.items()}
        texts = []
        for parameter, kind in parameters:
            if kind == "std::path::PathBuf":
                file = Path(client, "body").resolve()
                file.write_text(body[1])
                texts.append(f"{quoted(str(file))}.into()")
            elif parameter.endswith("_request") and body:
                texts.append(f"body({quoted(json.dumps(body[1]))})")
            elif parameter not in given:
                texts.append("None")
            else:
                text = json.dumps(given[parameter])
                text = text if "&str" in kind else f"decoded({quoted(text)})"
                texts.append(f"Some({text})" if kind.startswith("Option<") else text)
        configurations = ["&plain", "&typed"] if FAULTS["Rust"].get(name) == NO_TYPE else ["&plain"]
        for configuration in configurations:
            call = f"{module}::{snake(name)}({', '.join([configuration, *texts])}).await"
            lines.append(f"    answered({json.dumps(name)}, {f'text({call}).await' if answer == 'reqwest::Response' else call});")
    modules = ", ".join(sorted({module for module, _, _ in known.values()}))
    return "\n".join(["{", f"    use equipoise_client::apis::{{{modules}}};", *lines, "}"])


def quoted(text):
    return f'r##"{text}"##'


if __name__ == "__main__":
    task, *arguments = sys.argv[1:]
    if task in ("compare", "documented"):
        sys.exit({"compare": compare, "documented": documented}[task](*arguments))
    contract = yaml.safe_load(Path(arguments[0]).read_text())
    if task == "python":
        python(contract, *arguments[1:])
    print(rust(contract, *arguments[1:]))
