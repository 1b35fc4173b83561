"""Many scenes, one answer: reads requests as NDJSON, a JSON object on each line, and writes what the server says to each as NDJSON.

Lines come out in the order in which they went in, as soon as they are there. What is wrong with one stands in its line, and the exit
status says that there was one. Example: batch.py stability < rigs.ndjson > verdicts.ndjson
"""

import json
import sys

from ask import arguments, ask_many, parse

parser = arguments(__doc__)
parser.add_argument("resource", help="what is asked: stability, trajectories, controllers, ...")
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
