"""Installs the peers, runs each in a process of its own, prints the table and writes the JSON. Nothing but the standard library."""

import json
import math
import os
import pathlib
import platform
import subprocess
import sys
import venv

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "peers"

# The script of a peer, and what it needs from the Python package index.
PYTHON = {
    "numba_map": "numba",
    "heyoka_events": "heyoka",
    "diffrax_events": "diffrax",
    "cvode_events": "scikit-sundae",
    "scipy_events": "scipy",
    "drake_witness": "drake",
    "mujoco_contact": "mujoco",
    "chipmunk_contact": "pymunk",
    "box2d_contact": "Box2D",
}
INSTALL_S, RUN_S = 900, 600
SHORT = ["--short"] if "--short" in sys.argv else []


def call(command, seconds):
    """Output of a command, or why there is none."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return None, f"took longer than {seconds} s"
    except OSError as reason:
        return None, str(reason)
    if done.returncode:
        lines = (done.stderr.strip() or done.stdout.strip() or f"exit status {done.returncode}").splitlines()
        return None, lines[-1][:300]
    return done.stdout, None


def lines(name, output, reason):
    """The lines of JSON that a peer printed."""
    found = [json.loads(line) for line in (output or "").splitlines() if line.startswith("{")]
    return found or [{"name": name, "skipped": reason or "printed nothing"}]


def native():
    manifest, target = HERE / "native/Cargo.toml", TARGET / "native"
    build = ["cargo", "build", "--release", "--quiet", "--manifest-path", manifest, "--target-dir", target]
    _, reason = call(build, INSTALL_S)
    if reason:
        return lines("equipoise and rapier2d", None, reason)
    return lines("equipoise and rapier2d", *call([target / "release/peers", *SHORT], RUN_S))


def python():
    folder = TARGET / "venv"
    if not (folder / "bin/python").exists():
        venv.create(folder, with_pip=True)
    for script, package in PYTHON.items():
        print(f"installing and running {package} …", file=sys.stderr)
        pip = [folder / "bin/pip", "install", "--quiet", "--disable-pip-version-check", package]
        _, reason = call(pip, INSTALL_S)
        if reason:
            yield {"name": package, "skipped": f"not installed: {reason}"}
        else:
            yield from lines(package, *call([folder / "bin/python", HERE / f"{script}.py", *SHORT], RUN_S))


def processor():
    try:
        text = pathlib.Path("/proc/cpuinfo").read_text()
    except OSError:
        return platform.processor()
    return next((line.split(":")[1].strip() for line in text.splitlines() if line.startswith("model name")), "unknown")


def table(peers):
    def number(value, form):
        return "–" if value is None else format(value, form)

    rows = [("", "version", "setting", "ns a bounce", "impacts", "error at 1", "at 10", "at 100")]
    for peer in peers:
        if "skipped" in peer:
            rows.append((peer["name"], "skipped", peer["skipped"], "", "", "", "", ""))
            continue
        errors = [number(peer[f"error_at_{n}"], ".1e") for n in (1, 10, 100)]
        speed = number(peer["ns_per_bounce"], ",.0f")
        rows.append((peer["name"], peer["version"], peer["setting"], speed, str(peer["impacts"]), *errors))
    widths = [max(map(len, column)) for column in zip(*(row for row in rows if row[3]))]
    for row in rows:
        cells = [cell.ljust(width) if column < 3 else cell.rjust(width)
                 for column, (cell, width) in enumerate(zip(row, widths))]
        print("  ".join(cells).rstrip())


def main():
    load = os.getloadavg()[0]
    named = [argument for argument in sys.argv[1:] if argument != "--short"]
    out = pathlib.Path(named[0]) if named else TARGET / "peers.json"
    TARGET.mkdir(parents=True, exist_ok=True)
    print("building equipoise and rapier2d …", file=sys.stderr)
    peers = native() + list(python())
    fastest = {}
    for peer in peers:
        fastest[peer["name"]] = min(fastest.get(peer["name"], math.inf), peer.get("ns_per_bounce", math.inf))
    # The settings of a peer keep their order.
    peers.sort(key=lambda peer: (fastest[peer["name"]], peer["name"]))
    machine = {
        "processor": processor(),
        "cores": os.cpu_count(),
        "system": platform.platform(),
        "python": platform.python_version(),
        # Above the number of cores, the times are too long.
        "load_average": load,
    }
    scene = "the paper's case 1: 100 impacts from the release; errors in m or m/s against 60 digits, as /v1/precision defines them"
    out.write_text(json.dumps({"scene": scene, "machine": machine, "peers": peers}, indent=1, ensure_ascii=False) + "\n")
    table(peers)
    print(f"\n{machine['processor']}, {machine['cores']} cores, load {machine['load_average']:.1f}; written to {out}")


if __name__ == "__main__":
    main()
