"""Runs the commands of docs/fitting.md, and compares their output and pictures with those of the page, number by number.

    .venv/bin/python check_worked_example.py http://127.0.0.1:8080 ../../docs        UPDATE=1 writes the page and its pictures anew.

It needs pandas and the package equipoise. An output is the text or the table after a command. Numbers may differ by one in their last digit:
platforms round sines differently.
"""

import contextlib
import difflib
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SERVER, DOCS = sys.argv[1], Path(sys.argv[2]).resolve()
PAGE, IMAGE = DOCS / "fitting.md", "fitting-"
WRITTEN = "http://127.0.0.1:8080"
UPDATE = os.environ.get("UPDATE") == "1"
# A command, and its output if it has one.
BLOCK = re.compile(r"```(?P<kind>sh|python)\n(?P<command>.*?)```\n(?:\n(?P<open>```text\n)(?P<text>.*?)```\n|\n(?P<table>(?:\|[^\n]*\n)+))?", re.DOTALL)
NUMBER = re.compile(r"(?<![\w.#])-?\d+(?:\.\d+)?(?:e-?\d+)?")
# The commands in Python share their names.
SESSION = {}
os.environ["EQUIPOISE"] = SERVER
os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
os.environ["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"


def run(kind, command, folder):
    if kind == "python":
        os.chdir(folder)
        with contextlib.redirect_stdout(io.StringIO()) as said:
            exec(command, SESSION)
        return said.getvalue()
    command = command.replace(WRITTEN, SERVER)
    done = subprocess.run(["bash", "-ec", command], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0 and not done.stderr, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout.replace(SERVER, WRITTEN)


def close(one, other):
    """Equal, or apart by one in the last digit."""
    decimals = len(re.sub(r"e.*", "", one).partition(".")[2])
    exponent = int(one.partition("e")[2] or 0)
    return abs(float(one) - float(other)) <= 1.01 * 10.0 ** (exponent - decimals)


def holds(found, expected):
    """True if the expected numbers are among those found, in their order. An answer may say more than it did."""
    left = iter(NUMBER.findall(found))
    return all(any(close(each, number) for each in left) for number in NUMBER.findall(expected))


def compared(what, found, expected):
    if not holds(found, expected):
        difference = difflib.unified_diff(expected.splitlines(), found.splitlines(), "the page", "now", lineterm="", n=0)
        sys.exit("\n".join([f"{what}: other numbers than on the page; UPDATE=1 writes them anew", *list(difference)[:60]]))


if not shutil.which("curl"):
    print("skip  worked example: curl is not installed")
    sys.exit()
page = PAGE.read_text()
with tempfile.TemporaryDirectory() as root:
    folder = Path(root) / "docs" / "clients"
    shutil.copytree(DOCS / "clients", folder, ignore=shutil.ignore_patterns("__pycache__"))
    (Path(root) / "tests").symlink_to(DOCS.parent / "tests")

    def checked(block):
        output = run(block["kind"], block["command"], folder)
        begin = f"```{block['kind']}\n{block['command']}```\n"
        if block["table"]:
            expected, written = block["table"], f"{begin}\n{output}"
        elif block["open"]:
            expected, written = block["text"], f"{begin}\n```text\n{output}```\n"
        else:
            return block[0]
        if UPDATE:
            return written
        compared(block["command"], output, expected)
        return block[0]

    page = BLOCK.sub(checked, page)
    for picture in re.findall(rf"\({IMAGE}(\w+\.svg)\)", page):
        found, kept = folder / picture, DOCS / f"{IMAGE}{picture}"
        if UPDATE:
            shutil.copy(found, kept)
        compared(kept.name, found.read_text(), kept.read_text())
    for data in filter(Path.is_file, folder.iterdir()):
        kept = DOCS / "clients" / data.name
        if UPDATE and data.suffix == ".csv" and kept.exists():
            shutil.copy(data, kept)
        assert not kept.exists() or kept.read_bytes() == data.read_bytes(), f"{data.name} is not that of its command"
    os.chdir(DOCS)
if UPDATE:
    PAGE.write_text(page)
print("ok    worked example of docs/fitting.md")
