"""A cannonball breaches a wall under a flag: accepted, broken by the ball and by nothing before, and without the gust nothing whips."""

from __future__ import annotations

import argparse
import sqlite3
from pathlib import Path

import pytest
from worldagent.examples.siege import PROMPT, SECONDS, WHIP, run, siege_spec
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.verifiers.story import beats, counterfactual
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import parse_spec

HUNG, SHOWN = 2.0, 2.5
"""Times of the flag alone, coarse: in still air before frame 0, and over the frames [s]."""


def test_the_specification_passes_the_audit() -> None:
    report = audit(parse_spec({"prompt": PROMPT, **siege_spec()}))
    assert report.passed, [r for r in report.rows if r.status == "fail"]


def _flag_alone(folder: Path, drivers: tuple[str, ...]) -> Candidate:
    """The siege's flag at its pole without the wall, in triangles of 12 cm, with some of what acts on it."""
    spec = siege_spec(0.12, SHOWN)
    spec["entities"] = {n: spec["entities"][n] for n in ("ground", "pole", "flag")}
    spec["story"] = {"beats": {n: spec["story"]["beats"][n] for n in ("blows", "whips")}}
    spec["shots"], spec["claims"] = {}, {}
    plan = spec["simulation"]
    plan["solvers"]["stones"]["members"] = ["ground", "pole"]
    plan["drivers"] = {n: plan["drivers"][n] for n in drivers}
    plan["preroll"], plan["drivers"]["air"]["start"] = HUNG, -HUNG
    return simulate(folder, parse_spec({"prompt": "The flag whips in the gust.", **spec}))


def test_the_flag_whips_in_the_gust_and_not_in_still_air(tmp_path: Path) -> None:
    """Both beats hold with the gust and fail in a world of their own without it; the run that takes the gust away says the same."""
    with_gust = _flag_alone(tmp_path / "gust", ("air", "gust"))
    rows = {r.id: r for r in (*beats.check(with_gust), *counterfactual.check(with_gust))}
    for row in ("beat:blows", "beat:whips", "beat:vacuous:blows", "beat:vacuous:whips", "causal:without:blows:whips"):
        assert rows[row].status == "pass", (row, rows[row].evidence)
    assert rows["causal:without:blows:whips"].evidence["intervention"] == "driver gust is taken away"
    still = {r.id: r for r in beats.check(_flag_alone(tmp_path / "still", ("air",)))}
    assert still["beat:blows"].status == still["beat:whips"].status == "fail"
    assert still["beat:whips"].measured < WHIP["min_amplitude"]


@pytest.mark.slow
def test_the_wall_is_breached_and_accepted(tmp_path: Path) -> None:
    found = run(argparse.Namespace(out=str(tmp_path), edge=0.05, seconds=SECONDS, no_render=True))
    assert found["accepted"], found
    with sqlite3.connect(tmp_path / "siege" / "ledger.sqlite") as ledger:
        rows = dict(ledger.execute("select id, status from matrix").fetchall())
    for row in (
        "requirement:whole",
        "beat:breaches",
        "beat:collapses",
        "beat:blows",
        "beat:whips",
        "causal:without:blows:whips",
        "causal:without:strikes:breaches",
        "causal:without:breaches:collapses",
        "contact:wall:wall",
        "category:cloth:energy:silk",
    ):
        assert rows[row] == "pass", row
