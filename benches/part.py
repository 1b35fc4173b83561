"""Writes a part of docs/measurements.md: `COMMAND | python3 benches/part.py NAME` puts the output between its marks."""

import sys
from pathlib import Path

PAGE = Path(__file__).parent.parent / "docs/measurements.md"
NAME, TEXT = sys.argv[1], sys.stdin.read().strip()
begin, end = f"<!-- benches/run {NAME} -->\n", "<!-- end -->\n"
before, rest = PAGE.read_text(encoding="utf-8").split(begin)
PAGE.write_text(f"{before}{begin}\n{TEXT}\n\n{end}{rest.split(end, 1)[1]}", encoding="utf-8")
