"""A program under test that serves on a free port of localhost."""

import http.client
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

from questions import Question


class Answer(NamedTuple):
    status: int
    kind: str
    body: bytes


class Server:
    """A program that serves on a free port."""

    def __init__(self, program):
        environment = {name: value for name, value in os.environ.items() if not name.startswith("EQUIPOISE")}
        self.log = tempfile.TemporaryFile()
        self.process = subprocess.Popen([program, "--listen", "127.0.0.1:0"], stderr=self.log, stdout=self.log, env=environment | {"RUST_LOG": "info"})
        self.port = self.wait()
        self.build = json.loads(self.ask(Question("health", "json", "/health/ready")).body)["build"]

    def said(self):
        self.log.seek(0)
        return self.log.read().decode()

    def wait(self):
        for _ in range(300):
            if serves := re.search(r"serves http://[^/]*:(\d+)/", self.said()):
                return int(serves[1])
            if self.process.poll() is not None:
                break
            time.sleep(0.1)
        sys.exit(f"{self.process.args[0]} does not serve: {self.said()}")

    def ask(self, question):
        """Sends a request; a busy server is asked again."""
        headers = {"accept": "*/*", "x-request-id": "compare", "content-type": question.kind}
        for _ in range(30):
            connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=600)
            try:
                body = None if question.body is None else question.body.encode()
                connection.request("GET" if body is None else "POST", question.path, body, headers)
                answer = connection.getresponse()
                if answer.status not in (429, 503):
                    # A build id may be part of a body.
                    text = answer.read()
                    if build := getattr(self, "build", None):
                        text = text.replace(build.encode(), b"(build)")
                    return Answer(answer.status, answer.headers.get("content-type", ""), text)
            except (http.client.HTTPException, OSError) as error:
                return Answer(0, "text/plain", f"{type(error).__name__}: {error}".encode())
            finally:
                connection.close()
            time.sleep(1)
        return Answer(answer.status, "text/plain", b"busy")

    def stop(self):
        self.process.terminate()
        self.process.wait()
