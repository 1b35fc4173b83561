"""Runs the bridges of docs/clients to other tools, and reads back what the tools got: each impact bit for bit that of /v1/trajectories."""

import asyncio
import contextlib
import io
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.parse
import urllib.request
from pathlib import Path

import paho.mqtt.client as mqtt
import pyarrow
import websockets
from mcap.reader import make_reader
from rerun.chunk import RrdReader

SERVER, SCRIPTS, DEBIAN = sys.argv[1], Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve()
SPEED = 20
# It was released an hour ago, at 20 times the pace: all of it has happened, and comes at once.
EPOCH = round(time.time() * 1000) - 3_600_000
ENDED = f"preset=case-3&speed={SPEED}&epoch_ms={EPOCH}&from=1"
# It begins with the request and goes on.
UNDER_WAY = "preset=case-1&speed=20"
PATIENCE_S = 60


def get(address):
    with urllib.request.urlopen(address, timeout=PATIENCE_S) as answer:
        return json.load(answer)


def expected(preset):
    """The impacts of a preset, with the dates of `ENDED`."""
    columns = get(f"{SERVER}/v1/trajectories?preset={preset}&bounces=60")["impacts"]
    columns["time_ms"] = [round(EPOCH + 1e3 * t / SPEED) for t in columns["t"]]
    return columns


def started(script, *arguments, **options):
    command = [sys.executable, "-B", SCRIPTS / script, "--server", SERVER, *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)


def finished(process):
    out, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0, f"{process.args}: {process.returncode}\n{out}{err}"
    return out


def soon(what, attempt):
    """Waits until an attempt gives something."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        with contextlib.suppress(OSError, urllib.error.URLError):
            if done := attempt():
                return done
        time.sleep(0.1)
    raise AssertionError(f"not within {PATIENCE_S} s: {what}")


def same(rows, columns, names, count):
    """Compares rows, or objects, with columns by number of the impact."""
    assert [row["n"] for row in rows] == columns["n"][:count], [row["n"] for row in rows]
    for name in names:
        assert [row.get(name) for row in rows] == columns[name][:count], name


def broken_connections(_folder):
    sys.path.insert(0, str(SCRIPTS))
    import live

    cut = Path(__file__).resolve().parent / "cut.py"
    with subprocess.Popen([sys.executable, cut, str(urllib.parse.urlsplit(SERVER).port), "15000"], stdout=subprocess.PIPE, text=True) as proxy:
        try:
            with contextlib.redirect_stderr(io.StringIO()):
                heard = list(live.messages(f"http://127.0.0.1:{proxy.stdout.readline().strip()}", ENDED))
        finally:
            proxy.terminate()
    assert sum(message["type"] == "hello" for message in heard) > 2, "no connection was cut"
    columns = expected("case-3")
    impacts = [message for message in heard if message["type"] == "impact"]
    same(impacts, columns, set(columns) - {"error_estimate"}, len(columns["n"]))
    assert heard[-1]["outcome"]["kind"] == "sinking"


def rerun(folder):
    file = folder / "run.rrd"
    finished(started("rerun_live.py", "--query", ENDED, "--save", str(file)))
    columns, seen, texts = expected("case-3"), {}, []
    for chunk in RrdReader(str(file)).stream():
        batch, name = chunk.to_record_batch(), chunk.entity_path.removeprefix("/")
        if name.startswith("impact/"):
            times = batch.column("time").cast(pyarrow.int64()).to_pylist()
            runs = batch.column("run").cast(pyarrow.int64()).to_pylist()
            values = [value for [value] in batch.column("Scalars:scalars").to_pylist()]
            seen.setdefault(name.removeprefix("impact/"), []).extend(
                zip(batch.column("impact").cast(pyarrow.int64()).to_pylist(), times, runs, values)
            )
        elif name == "end":
            texts += [text for cell in batch.column("TextLog:text").to_pylist() for text in cell]
    for name in ("t", "x", "theta", "x_dot", "y_dot", "theta_dot", "alpha", "energy", "contact_velocity"):
        n, times, runs, values = zip(*sorted(seen[name]))
        assert list(n) == columns["n"] and list(values) == columns[name], name
        assert [round(date / 1e6) for date in times] == columns["time_ms"], name
        assert all(abs(run / 1e9 - t) < 1e-9 for run, t in zip(runs, columns["t"])), name
    assert len(texts) == 1 and "does not rise again" in texts[0], texts


async def foxglove_live(port):
    """Twenty messages of the channel /impact, as Foxglove gets them."""
    async with websockets.connect(f"ws://127.0.0.1:{port}", subprotocols=["foxglove.sdk.v1"]) as client:
        impacts, channel = [], None
        while len(impacts) < 20:
            frame = await asyncio.wait_for(client.recv(), PATIENCE_S)
            if isinstance(frame, bytes):
                # Opcode 1, subscription, time in ns, then the message (ws-protocol of Foxglove).
                assert frame[0] == 1 and int.from_bytes(frame[1:5], "little") == 7
                impacts.append((int.from_bytes(frame[5:13], "little"), json.loads(frame[13:])))
            elif channel is None and (message := json.loads(frame))["op"] == "advertise":
                [channel] = [one["id"] for one in message["channels"] if one["topic"] == "/impact"] or [None]
                if channel is not None:
                    await client.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": 7, "channelId": channel}]}))
        return impacts


def foxglove(folder):
    file = folder / "run.mcap"
    # The app shows a run while it happens.
    process = started("foxglove_mcap.py", "--query", UNDER_WAY, "--bounces", "400", "--file", str(file), "--port", "0")
    port = process.stdout.readline().strip().rsplit(":", 1)[1]
    live = asyncio.run(foxglove_live(port))
    finished(process)
    with file.open("rb") as source:
        read = [(message.log_time, json.loads(message.data)) for _, _, message in make_reader(source).iter_messages("/impact")]
    assert len(read) == 400 and all(date == impact["time_ms"] * 1_000_000 for date, impact in read)
    first = live[0][1]["n"] - 1
    assert live == read[first : first + 20], "the WebSocket and the file differ"
    # A run that has ended, with its outcome.
    finished(started("foxglove_mcap.py", "--query", ENDED, "--file", str(file), "--port", "0"))
    with file.open("rb") as source:
        reader = make_reader(source)
        schemas = {schema.name: json.loads(schema.data) for schema in reader.get_summary().schemas.values()}
        impacts = [json.loads(message.data) for _, _, message in reader.iter_messages("/impact")]
        [end] = [json.loads(message.data) for _, _, message in reader.iter_messages("/end")]
    columns = expected("case-3")
    names = set(columns) - {"n", "error_estimate"}
    assert names <= set(schemas["impact"]["properties"]), names
    same(impacts, columns, names, len(columns["n"]))
    assert (end["kind"], end["bounces"]) == ("sinking", len(columns["n"])), end


def free_port():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        return taken.getsockname()[1]


@contextlib.contextmanager
def daemon(program, folder, *arguments):
    libraries = ":".join(str(each) for each in [*DEBIAN.glob("usr/lib/*-linux-gnu*"), *DEBIAN.glob("lib/*-linux-gnu*")])
    with (folder / f"{Path(program).name}.log").open("w") as log:
        process = subprocess.Popen([program, *arguments], stdout=log, stderr=log, env={**os.environ, "LD_LIBRARY_PATH": libraries})
        try:
            yield
        finally:
            process.terminate()
            process.wait(PATIENCE_S)


def found(name):
    """A program that was unpacked here or is installed; None if there is none."""
    return next((str(file) for file in DEBIAN.glob(f"usr/*bin/{name}")), None) or shutil.which(name, path=f"{os.environ['PATH']}:/usr/sbin")


def mqtt_influx(folder):
    mosquitto, influxd = found("mosquitto"), found("influxd")
    if not (mosquitto and influxd):
        print("skip  MQTT and InfluxDB: Debian's mosquitto and influxdb cannot be had here")
        return
    broker, database, backup = free_port(), free_port(), free_port()
    (folder / "mosquitto.conf").write_text(f"listener {broker} 127.0.0.1\nallow_anonymous true\npersistence false\nuser root\n")
    (folder / "influxdb.conf").write_text(
        f'reporting-disabled = true\nbind-address = "127.0.0.1:{backup}"\n[meta]\ndir = "{folder}/meta"\n[data]\ndir = "{folder}/data"\n'
        f'wal-dir = "{folder}/wal"\n[monitor]\nstore-enabled = false\n[http]\nbind-address = "127.0.0.1:{database}"\n'
    )
    with daemon(mosquitto, folder, "-c", f"{folder}/mosquitto.conf"), daemon(influxd, folder, "-config", f"{folder}/influxdb.conf"):
        influx = f"http://127.0.0.1:{database}"
        soon("InfluxDB", lambda: urllib.request.urlopen(f"{influx}/ping").status == 204)
        got, subscribed = [], []
        listener = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2)
        listener.on_message = lambda _client, _data, message: got.append((message.topic, json.loads(message.payload)))
        listener.on_subscribe = lambda *_: subscribed.append(True)
        soon("mosquitto", lambda: listener.connect("127.0.0.1", broker) == mqtt.MQTT_ERR_SUCCESS)
        listener.loop_start()
        listener.subscribe("lab/#", qos=1)
        soon("the subscription", lambda: subscribed)
        places = ["--mqtt", f"127.0.0.1:{broker}", "--influx", influx, "--topic", "lab", "--database", "rig"]
        finished(started("mqtt_influx.py", "--query", ENDED, *places))
        soon("the end by MQTT", lambda: got[-1][0] == "lab/end" if got else None)
        listener.loop_stop()
        query = urllib.parse.urlencode({"db": "rig", "epoch": "ns", "q": "SELECT * FROM impact"})
        [series] = get(f"{influx}/query?{query}")["results"][0]["series"]
    columns = expected("case-3")
    count = len(columns["n"])
    impacts = [message for topic, message in got if topic == "lab/impact"]
    same(impacts, columns, set(columns) - {"error_estimate"}, count)
    assert [topic for topic, _ in got] == ["lab/hello", *["lab/impact"] * count, "lab/end"]
    assert got[-1][1]["outcome"]["kind"] == "sinking"
    points = [dict(zip(series["columns"], values)) for values in series["values"]]
    dates = [point.pop("time") for point in points]
    assert dates == [1_000_000 * date + n for date, n in zip(columns["time_ms"], columns["n"])]
    same(points, columns, set(columns) - {"error_estimate", "time_ms"}, count)


with tempfile.TemporaryDirectory() as place:
    for bridge in (broken_connections, rerun, foxglove, mqtt_influx):
        folder = Path(place) / bridge.__name__
        folder.mkdir()
        bridge(folder)
        print(f"ok    {bridge.__name__}")
