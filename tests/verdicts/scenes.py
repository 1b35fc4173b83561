"""Random scenes: the verdict on each beside a run of its release over 20,000 bounces."""

import json
import random as numbers
from collections import Counter

from mixes import QUIET, mix
from questions import Question

BOUNCES = 20_000

# Verdicts by which a run goes on and its swing does not grow, and by which it may.
STAYS = {"stable_in_place", "stable_drifting", "elliptic", "weakly_attracting"}
BOUNDED = STAYS | {"bounded_beyond_boundary"}

# Growth of a swing from the first tenth of a run to the last that is none, and the least swing that is no rounding, rad.
SAME, LEAST = 2, 1e-9


def scene_of(random):
    """A mix of features, released from a small swing; errors and drags from the range of the mix down to a thousandth of it."""
    names, scene = mix(random, QUIET)
    if "theta" in scene["release"]:
        scene["release"] = {"height": scene["release"]["height"], "theta": random.choice([-1, 1]) * 10 ** random.uniform(-5, -1)}
    for part in (scene["table"].get("errors", {}), scene.get("air", {})):
        for name in part:
            part[name] *= 10 ** random.uniform(-3, 0)
    return names, scene


def asked(server, path, request):
    answer = server.ask(Question("scenes", "json", path, json.dumps(request)))
    return answer.status, json.loads(answer.body)


def doubt(code, decided_by, run):
    """Says how a run contradicts a verdict; None if it does not."""
    swing = [abs(theta) for theta in run["impacts"]["theta"]]
    tenth = max(5, len(swing) // 10)
    early, late = max(swing[:tenth], default=0), max(swing[-tenth:], default=0)
    ended = run["outcome"]["kind"] != "completed"
    if ended:
        return f"ended as {run['outcome']['kind']} at bounce {len(swing)}" if code in BOUNDED else None
    if code in STAYS and late > SAME * max(early, LEAST):
        return f"grew from {early:.1e} to {late:.1e} rad"
    # Where no bounce repeats, or a drift leaves the table later, the run says nothing.
    if code == "unstable" and decided_by != "fixed_point" and late < SAME * max(early, LEAST):
        return f"stayed, from {early:.1e} to {late:.1e} rad"
    return None


def check(server, count, seed):
    """Prints the counts and every doubtful verdict; returns the number of these and of null verdicts."""
    random, codes, doubts = numbers.Random(seed), Counter(), 0
    while sum(codes.values()) < count:
        names, scene = scene_of(random)
        status, answer = asked(server, "/v1/stability", {"scene": scene})
        if status != 200:
            # Features of which one scene has one only.
            continue
        verdict = answer["verdict"]
        codes[verdict["code"]] += 1
        _, run = asked(server, "/v1/trajectories", {"scene": scene, "bounces": BOUNCES})
        if why := doubt(verdict["code"], verdict["decided_by"], run):
            doubts += 1
            print(f"{verdict['code']}, but a run {why}: {' × '.join(names)}: {verdict['reason']}: {json.dumps(scene)}")
    print(f"{count} scenes: {', '.join(f'{code} {number}' for code, number in codes.most_common())}; {codes[None]} null, {doubts} doubtful")
    return doubts + codes[None]
