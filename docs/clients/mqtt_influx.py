"""A live run for a lab's data bus: every impact as JSON on an MQTT topic, and as a point in InfluxDB.

    apt install mosquitto influxdb && pip install ../.. paho-mqtt && python3 mqtt_influx.py --query 'preset=case-1&speed=2'
    Then: mosquitto_sub -t 'equipoise/impact', and: influx -database equipoise -execute 'SELECT theta FROM impact LIMIT 5'
"""

import json
import urllib.parse
import urllib.request

import paho.mqtt.client as mqtt
from live import arguments, messages

parser = arguments(__doc__.splitlines()[0])
parser.add_argument("--mqtt", default="127.0.0.1:1883", help="host and port of the broker")
parser.add_argument("--topic", default="equipoise", help="first part of the MQTT topics")
parser.add_argument("--influx", default="http://127.0.0.1:8086", help="address of InfluxDB 1.x")
parser.add_argument("--database", default="equipoise", help="database of InfluxDB; it is made if there is none")
options = parser.parse_args()


def influx(path, body, **parameters):
    address = f"{options.influx}/{path}?{urllib.parse.urlencode(parameters)}"
    urllib.request.urlopen(urllib.request.Request(address, data=body.encode(), method="POST"), timeout=10).close()


def point(impact):
    """A line of the line protocol. Points at one time replace each other, so n stands in the digits below a millisecond."""
    fields = [f"n={impact['n']}i"] + [f"{name}={value}" for name, value in impact.items() if isinstance(value, float)]
    if impact["contact_mode"]:
        fields.append('contact_mode="' + impact["contact_mode"] + '"')
    return f"impact {','.join(fields)} {impact['time_ms'] * 1_000_000 + impact['n'] % 1_000_000}"


host, port = options.mqtt.rsplit(":", 1)
broker = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2)
broker.connect(host, int(port))
broker.loop_start()
influx("query", "", q=f'CREATE DATABASE "{options.database}"')
sent = None
for message in messages(options.server, options.query, options.bounces):
    if message["type"] in ("hello", "impact", "end"):
        # `hello` and `end` are retained: who comes later learns which run it is.
        sent = broker.publish(f"{options.topic}/{message['type']}", json.dumps(message), qos=1, retain=message["type"] != "impact")
    if message["type"] == "impact":
        influx("write", point(message), db=options.database, precision="ns")
if sent:
    sent.wait_for_publish(10)
broker.disconnect()
