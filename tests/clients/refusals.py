"""Hooks for schemathesis. A request that is valid by its schema must not be refused for its form; otherwise the contract is wider than
the server. They also make NDJSON bodies, which no schema describes, and read YAML as text.
"""

import json
import re

import schemathesis
from hypothesis import strategies
from schemathesis.core.media_types import YAML_MEDIA_TYPES

FORM = re.compile(r"^unknown field|; it must be |must be a JSON")
# No schema can express these limits: values of a field that another field names, the band of a tile, and names with an index in them,
# for which the contract has an object (`scene.table.program[…]` is never sent), and a query within a query.
NAMED = re.compile(
    r"/(x|y|sweep|tolerances/[0-9]+)/(field|from|to|tolerance)$|^/tile/index$"
    r"|^/(scene/table/program|scene/body/vertices|interventions|clock)\[|^/target/"
)


@schemathesis.check
def refused_for_its_form(ctx, response, case):
    if response.status_code != 422 or case.method == "HEAD" or not case.meta.generation.mode.is_positive:
        return
    for error in response.json()["errors"]:
        assert not FORM.search(error["detail"]) or NAMED.search(error["pointer"]), error


VALUES = strategies.none() | strategies.booleans() | strategies.floats(allow_nan=False, allow_infinity=False) | strategies.text()
REQUESTS = strategies.dictionaries(strategies.sampled_from(["preset", "scene", "bounces", "x"]) | strategies.text(), VALUES).map(json.dumps)
LINES = strategies.lists(strategies.just('{"preset": "case-1"}') | REQUESTS | strategies.text(), max_size=5)
# The only binary body of the contract. A strategy for its media type would refuse the contract's own example, which is text.
schemathesis.openapi.format("binary", LINES.map(lambda lines: "\n".join(["{}", *lines])))


@schemathesis.serializer("application/x-ndjson")
def lines(ctx, value):
    return {"data": value.encode() if isinstance(value, str) else value}


@schemathesis.deserializer(*YAML_MEDIA_TYPES)
def text(ctx, response):
    # The schema is that of the text. By itself, schemathesis would parse it. The first of these types stands for all.
    return response.text
