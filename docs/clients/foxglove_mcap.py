"""A live run in Foxglove: a WebSocket server for the app, and an MCAP file of the same messages.

    pip install ../.. foxglove-sdk && python3 foxglove_mcap.py --query 'preset=case-1&speed=2' --file run.mcap
    In Foxglove: Open connection, Foxglove WebSocket, ws://localhost:8765; a plot takes `/impact.theta`. Later open run.mcap.
"""

import foxglove
from live import arguments, messages

parser = arguments(__doc__.splitlines()[0])
parser.add_argument("--port", type=int, default=8765, help="port of the WebSocket server; 0 takes a free one")
parser.add_argument("--file", default="run.mcap", help="MCAP file to write")
options = parser.parse_args()

NUMBER, WORD = {"type": "number"}, {"type": "string"}
NAMES = ["t", "x", "theta", "x_dot", "y_dot", "theta_dot", "x_dot_after", "y_dot_after", "theta_dot_after", "alpha", "table_velocity_x",
         "table_velocity_y", "impulse_normal", "impulse_tangential", "energy", "flight_time", "contact_velocity", "clearance"]
IMPACT = {"n": {"type": "integer"}, "time_ms": {"type": "integer"}, **dict.fromkeys(NAMES, NUMBER), "contact_mode": WORD}
END = {"kind": WORD, "detail": WORD, "bounces": {"type": "integer"}, "t": NUMBER}


def channel(topic, properties):
    return foxglove.Channel(topic, schema={"type": "object", "title": topic[1:], "properties": properties})


impact, end = channel("/impact", IMPACT), channel("/end", END)
# The file has to exist before the first message, and is closed with its index after the last one.
with foxglove.open_mcap(options.file, allow_overwrite=True):
    server = foxglove.start_server(name="equipoise", port=options.port)
    print(f"ws://127.0.0.1:{server.port}", flush=True)
    time = 0
    for message in messages(options.server, options.query, options.bounces):
        if message["type"] == "impact":
            time = message["time_ms"] * 1_000_000
            impact.log({name: message[name] for name in IMPACT if message[name] is not None}, log_time=time)
        elif message["type"] == "end":
            end.log({name: message["outcome"][name] for name in END}, log_time=time)
    server.stop()
