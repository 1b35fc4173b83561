"""Many scenes at once: reads requests as NDJSON, a JSON object on each line, and writes the answers as NDJSON.

Lines come out in the order of the input, each as soon as it is ready. Errors stand in the line of their request, and the exit status is
then 1. Example: batch.py stability < rigs.ndjson > verdicts.ndjson
"""

import json
import sys

from ask import arguments, ask_many, parse

parser = arguments(__doc__)
parser.add_argument("resource", help="resource: stability, trajectories, controllers, ...")
options = parse(parser)


numbers, requests = [], []
for number, line in enumerate(sys.stdin, 1):
    if line.strip():
        try:
            requests.append(json.loads(line))
        except ValueError as error:
            sys.exit(f"line {number} is not JSON: {error}")
        numbers.append(number)

wrong = 0
for number, (answer, problem) in zip(numbers, ask_many(options.resource, requests)):
    wrong += problem is not None
    print(json.dumps({"line": number, **({"problem": problem} if problem else {"answer": answer})}), flush=True)
sys.exit(wrong > 0)
