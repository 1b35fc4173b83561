"""Runs the shipped scripts of docs/clients against a server, and checks their output by another way to the same numbers."""

import contextlib
import json
import math
import re
import socket
import socketserver
import subprocess
import sys
import tempfile
import threading
import urllib.parse
import urllib.request
import xml.etree.ElementTree as ElementTree
from pathlib import Path

SERVER, SCRIPTS = sys.argv[1], Path(sys.argv[2]).resolve()
sys.path.insert(0, str(SCRIPTS))
sys.dont_write_bytecode = True
import ask as client  # noqa: E402

client.SERVER = SERVER


def printed(script, *arguments, status=0, given=None):
    command = [sys.executable, "-B", SCRIPTS / script, "--server", SERVER, *arguments]
    done = subprocess.run(command, input=given, capture_output=True, text=True)
    assert done.returncode == status, f"{script} {arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def numbers(pattern, text):
    found = re.search(pattern, text)
    assert found, f"no {pattern} in:\n{text}"
    return [float(each) for each in found.groups()]


def outcome(scene, impacts):
    return client.ask("trajectories", {"preset": "case-1", "scene": scene, "bounces": impacts})["outcome"]["kind"]


def quickstart():
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "run.svg"
        text = printed("quickstart.py", "--picture", str(picture))
        assert ElementTree.parse(picture).getroot().tag.endswith("svg")
    # Equation 18, with the paper's lengths: l = 0.4/3 and ρ² = 2/225.
    assert numbers(r"tilt_gain 1\.1: [\d.]+ to the limit above, ([\d.]+)", text) == [1 + 2 / 225 / (2 * (0.2 - 0.4 / 3) * 0.4 / 3)], text
    assert len(re.findall(r"^ +\d+ +\d+\.\d{5}", text, re.MULTILINE)) == 10, text


def margins():
    text = printed("margins_of_my_rig.py", "--lengths", "0.133", "0.094", "--tilt-gain", "1.1", "--off-distance", "0.002", "--off-gyration", "0.001")
    corners = [1 + rho**2 / (2 * l * (0.2 - l)) for l in (0.131, 0.133, 0.135) for rho in (0.093, 0.095)]
    least, most = numbers(r"upper end is from ([\d.]+) to ([\d.]+)", text)
    assert math.isclose(least, min(corners), abs_tol=1e-5) and math.isclose(most, max(corners), abs_tol=1e-5), (least, most, corners)
    [aside] = numbers(r"up to ([\d.]+) rad aside", text)
    scene = {"body": {"contact_distance": 0.133, "radius_of_gyration": 0.094}, "release": {"height": 0.2}}
    assert outcome({**scene, "release": {"theta": aside - 0.01}}, 1000) == "completed", aside
    polygon = printed("margins_of_my_rig.py", "--polygon", "0,0 0.05,0.2 -0.05,0.2", "--tilt-gain", "1.1")
    # A uniform triangle with base 0.1 and height 0.2: l = 0.4/3, ρ² = 0.2²/18 + 0.1²/24.
    assert math.isclose(numbers(r"from 1 to ([\d.]+)", polygon)[0], 1 + (0.04 / 18 + 0.01 / 24) / (2 * (0.2 - 0.4 / 3) * 0.4 / 3), abs_tol=1e-5), polygon
    wrong = printed("margins_of_my_rig.py", "--lengths", "0.133", "0.094", "--tilt-gain", "1000", status=1)
    assert "scene.table.tilt_gain: tilt_gain is 1000; it must be from -100 to 100" in wrong, wrong


def tilt_gain():
    text = printed("which_tilt_gain.py", "--runs", "40", "--bounces", "100", "--gains", "7")
    gain, share = numbers(r"recommended: ([\d.]+)\. ([\d.]+)% survive", text)
    [aside] = numbers(r"furthest aside: ([\d.]+) rad", text)
    table = {"tilt_gain": gain}
    assert outcome({"table": table, "release": {"theta": aside}}, 100) == "completed"
    assert outcome({"table": table, "release": {"theta": aside + 0.01}}, 100) != "completed"
    assert "no tilt gain to choose: the table stands still" in printed("which_tilt_gain.py", "--preset", "still-lossy", status=1)
    # Every run of the ensemble, one by one.
    noise = {"timing_sd": 0.01, "model": "plan", "seed": 1}
    alone = [outcome({"table": table, "noise": {**noise, "run": run}}, 100) for run in range(40)]
    assert math.isclose(100 * alone.count("completed") / 40, share, abs_tol=0.06), (alone, text)


def friction():
    text = printed("which_friction.py", "--scene", json.dumps({"release": {"theta": 0.05}, "table": {"tilt_gain": 2}}))
    # Near upright a tilt gain of 2 is beyond 1.5 without friction, and within 2.5 on a contact that sticks.
    [least] = numbers(r"moving along[^\n]*\n  poisson  friction 0: does not hold\n +from ([\d.]+) on: holds", text)
    for factor, wanted in ((0.97, False), (1.0001, True)):
        scene = {"release": {"theta": 0.05}, "table": {"tilt_gain": 2, "slide": "matched"}, "contact": {"friction": least * factor}}
        assert (outcome(scene, 300) == "completed") == wanted, (least, factor)
    # With noise a bounce repeats no more, and the share of runs that survive is told.
    text_noise = printed("which_friction.py", "--preset", "case-1-noise")
    assert re.search(r"tilt alone\n  poisson  friction 0: holds\n +from [\d.]+ on: does not hold; with noise \d+ of 200 runs", text_noise), text_noise
    slips = re.search(r"contact that slips\n  poisson  friction 0: holds\n +from 0\.0000\d on: does not hold", text)
    assert slips, text


def fit():
    data, scene, sd = str(SCRIPTS / "my_rig.csv"), str(SCRIPTS / "my_rig.json"), ("--sd", "t=0.001", "theta=0.002")
    # Of the simulation in tests/oracle/measured.py; the bias is that of the sensor with the lean of the axis.
    truths = {"table.errors.tilt_gain": 0.04, "table.errors.angle_bias": 0.001 + math.atan(0.0003 / 0.12), "contact.restitution": 0.72}
    with tempfile.TemporaryDirectory() as folder:
        picture, fitted, wrong = (Path(folder) / name for name in ("residuals.svg", "fitted.json", "wrong.csv"))
        text = printed("fit_my_rig.py", data, "--scene", scene, *sd, "--unknown", *truths, "--picture", str(picture), "--fitted", str(fitted), "--page")
        assert ElementTree.parse(picture).getroot().tag.endswith("svg")
        fitted = json.loads(fitted.read_text())
        page = urllib.parse.urlsplit(re.search(r"^page +(.*)", text, re.MULTILINE)[1])
        assert f"{page.scheme}://{page.netloc}" == SERVER, text
        query = dict(urllib.parse.parse_qsl(page.query))
        assert query["scene.contact.restitution"] == json.dumps(fitted["contact"]["restitution"]), text
        # The page reads its address as the server reads a query.
        with urllib.request.urlopen(f"{SERVER}/v1/stability?{page.query}") as answer:
            assert json.load(answer)["scene"] == fitted, text
        for content, said in (
            ("t [s],theta [rad]\n0.1,0.1\n0.3,high\n", "line 3: theta is 'high', not a number"),
            ("t,theta\n0.1,nan\n", "line 2: theta is 'nan', not a number"),
            ("time,theta\n0.1,0.1\n", "it needs t"),
            ("t;theta\n0.1;0.1\n", "with commas between them"),
            ("t,t\n0.1,0.1\n", "each name once"),
            ("", "of an empty file"),
            ("t [s],theta [turns]\n0.1,0.1\n", "theta is in turns; convert it to rad"),
            ("t [h],theta\n0.1,0.1\n", "t is in h; convert it to s"),
            ("t,theta\n0.1,2.5\n0.3,-2.5\n0.5,2.5\n", "is the column in degrees?"),
            ("t,theta\n0.1,0.1\n", "measured: there is 1 impact"),
        ):
            wrong.write_text(content)
            told = printed("fit_my_rig.py", str(wrong), "--scene", scene, status=1)
            assert said in told, f"{content!r}: {told}"
        # The same impacts in other units, by their header.
        rows = [line.split(",") for line in Path(data).read_text().splitlines()[1:]]
        other = (f"{float(t) * 1000!r},{math.degrees(float(theta))!r}\n" for t, theta in rows)
        wrong.write_text("".join(("t [ms],theta_deg\n", *other)))
        asked = Path(folder) / "request.json"
        printed("fit_my_rig.py", str(wrong), "--scene", scene, "--request", str(asked))
        measured = json.loads(asked.read_text())["measured"]
        for row, (t, theta) in enumerate(rows):
            assert math.isclose(measured["t"][row], float(t)) and math.isclose(measured["theta"][row], float(theta)), row
    assert "cannot read" in printed("fit_my_rig.py", "missing.csv", "--scene", scene, status=1)
    assert "--scene is not JSON" in printed("fit_my_rig.py", data, "--scene", "{", status=1)
    assert "such as t=0.001" in printed("fit_my_rig.py", data, "--scene", scene, "--sd", "t", status=1)
    assert "unknown" in printed("fit_my_rig.py", data, "--scene", scene, "--unknown", "table.gain", status=1)
    # Estimates are within four standard deviations.
    for path, truth in truths.items():
        value, sd = numbers(rf"{re.escape(path)} = ([\d.]+) \+- ([\d.e-]+)", text)
        assert abs(value - truth) < 4 * sd and sd < 0.05 * truth, text
    assert "missed" in text and "doubled" in text and "theta of row 12" in text, text
    assert re.search(r"^mended +table.errors.angle_bias = 0: weakly", text, re.MULTILINE), text


def batch():
    # More lines than one body may have, with a blank line and an invalid one among them.
    gains = [1 + 0.4 * number / 4000 for number in range(4000)]
    lines = [json.dumps({"preset": "case-1", "scene": {"table": {"tilt_gain": gain}}, "bounces": 1}) for gain in gains]
    lines[1] = ""
    lines[2] = '{"preset": "case-1", "bounces": 0}'
    assert sum(map(len, lines)) > client.BODY_BYTES
    told = [json.loads(line) for line in printed("batch.py", "trajectories", given="\n".join(lines), status=1).splitlines()]
    assert [line["line"] for line in told] == [1, *range(3, 4001)]
    assert [line["line"] for line in told if "problem" in line] == [3], told[1]
    assert told[1]["problem"]["errors"][0]["pointer"] == "/bounces", told[1]
    assert [line["answer"]["scene"]["table"]["tilt_gain"] for line in told[2:]] == gains[3:]
    assert "line 2 is not JSON" in printed("batch.py", "trajectories", given='{"preset": "case-1"}\n{', status=1)
    assert "there are no batches of this name; there are catches, controllers" in printed("batch.py", "scenes", given="{}", status=1)


def cut_off():
    # A proxy that breaks off the first answers.
    host, port = SERVER.split("//")[1].split(":")
    served = []

    class Way(socketserver.BaseRequestHandler):
        def handle(self):
            served.append(len(served))
            with socket.create_connection((host, int(port))) as server:
                threading.Thread(target=carry, args=(self.request, server, None), daemon=True).start()
                carry(server, self.request, 30_000 if served[-1:] < [2] else None)

    def carry(source, sink, most):
        with contextlib.suppress(OSError):
            while (most is None or most > 0) and (part := source.recv(4096)):
                sink.sendall(part)
                most = most and most - len(part)

    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), Way) as way:
        threading.Thread(target=way.serve_forever, daemon=True).start()
        client.SERVER = f"http://127.0.0.1:{way.server_address[1]}"
        requests = [{"preset": "case-1", "bounces": impacts} for impacts in range(1, 61)]
        answers = list(client.ask_many("trajectories", requests))
        assert [len(answer["impacts"]["n"]) for answer, _ in answers] == [*range(1, 61)]
        assert served == [0, 1, 2], served
        way.shutdown()
    client.SERVER = SERVER


for check in (quickstart, margins, fit, tilt_gain, friction, batch, cut_off):
    check()
    print(f"ok    {check.__name__}")
