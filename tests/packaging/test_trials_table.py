"""The table of trials says what their transcripts hold."""

from __future__ import annotations

import json
import re
from pathlib import Path
from statistics import median
from typing import Any

ROOT = Path(__file__).resolve().parents[2] / "docs" / "trials"
ROW = re.compile(r"^\| (\w*) ?\| \[\w+\]\((\S+\.jsonl)\) \| (\d) of (\d) \| (\d+) \| (\d+) \| ([\d,]+) \|$", re.MULTILINE)
ADVERSARIES = {"adversary/transcript.jsonl"}
"""Transcripts of those who wanted worlds accepted that do not show their prompt."""


def lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def test_every_honest_transcript_has_a_row_with_its_counts() -> None:
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    told = {path: (int(calls), int(requests), read) for _, path, _, _, calls, requests, read in ROW.findall(page)}
    there = {p.relative_to(ROOT).as_posix() for p in ROOT.glob("*/*.jsonl")} - ADVERSARIES
    assert set(told) == there
    for path, (calls, requests, read) in told.items():
        held = lines(ROOT / path)
        assert calls == sum(line.get("op", "call") == "call" for line in held), path
        assert requests == len(held), path
        assert read == f"{round(sum(line.get('chars') or 0 for line in held), -3):,}", path


def test_the_medians_per_prompt_are_those_of_the_rows() -> None:
    page, part = (ROOT / "README.md").read_text(encoding="utf-8"), ""
    found: dict[str, list[tuple[float, float]]] = {"before": [], "since": []}
    for name, _, _, prompts, calls, _, read in ROW.findall(page):
        part = name or part
        found[part] += [(int(calls) / int(prompts), int(read.replace(",", "")) / int(prompts))] * int(prompts)
    before, since = ((median(c for c, _ in v), median(r for _, r in v), len(v)) for v in found.values())
    assert (
        f"{before[0]:g} calls and {before[1]:,.0f} characters read before ({before[2]} prompts), {since[0]:g} and {since[1]:,.0f} since ({since[2]})"
        in page
    )
