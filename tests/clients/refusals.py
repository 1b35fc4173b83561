"""A check for schemathesis: what keeps to the schema is not refused for its form, else the contract is wider than the server."""

import re

import schemathesis

FORM = re.compile(r"^unknown field|; it must be |must be a JSON")
# Values of a field that another field names, and the band of a tile: no schema knows their limits.
NAMED = re.compile(r"/(x|y|sweep)/(parameter|from|to)$|^/tile/index$")


@schemathesis.check
def refused_for_its_form(ctx, response, case):
    if response.status_code != 422 or case.method == "HEAD" or not case.meta.generation.mode.is_positive:
        return
    for error in response.json()["errors"]:
        assert not FORM.search(error["detail"]) or NAMED.search(error["pointer"]), error
