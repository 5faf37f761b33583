"""The server's verdict beside a judge's, and the server's own figures."""

from __future__ import annotations

import json

import pytest
from worldagent.bench.evaluation.metrics.agreement import compare_beats

BEATS = ["b1", "b2", "b3", "b4", "b5"]
PAIRS = {"b1": ["smoke"], "b2": ["fills", "spills"], "b3": ["runs"], "b4": ["pushed"]}
SERVER = {"smoke": "pass", "fills": "pass", "spills": "fail", "runs": "pass", "pushed": "pass"}


def test_beats_agree_are_disputed_or_undecided() -> None:
    found = compare_beats(BEATS, SERVER, {"b1": 1.0, "b2": 0.0, "b3": 0.0, "b4": 0.5, "b5": 1.0}, pairs=PAIRS)
    assert [(b.server, b.outcome) for b in found.beats] == [
        ("pass", "agree"), ("fail", "agree"), ("pass", "disputed"), ("pass", "undecided"), ("unmatched", "undecided"),
    ]  # fmt: skip
    assert found.share == pytest.approx(2 / 3)
    assert [b.beat for b in found.disputed] == ["b3"]
    assert found.as_json()["open"] == 1
    json.dumps(found.as_json())


@pytest.mark.parametrize(("truth", "right"), [("happened", "server"), ("did_not", "judge")])
def test_a_ruling_says_who_was_right(truth: str, right: str) -> None:
    found = compare_beats(BEATS, SERVER, {"b3": 0.0}, pairs=PAIRS, ruled={"b3": truth})  # type: ignore[dict-item]
    assert found.disputed[0].right == right
    assert found.as_json()[f"{right}_right"] == 1


def test_kappa_is_cohens() -> None:
    """Twenty of both, five and ten of the ones, fifteen of the others: the textbook's 0.4."""
    server, judge = {}, {}
    for k, (s, j) in enumerate([("pass", 1.0)] * 20 + [("pass", 0.0)] * 5 + [("fail", 1.0)] * 10 + [("fail", 0.0)] * 15):
        server[f"b{k}"], judge[f"b{k}"] = s, j
    found = compare_beats(list(server), server, judge, pairs={b: [b] for b in server})
    assert found.share == pytest.approx(0.7)
    assert found.kappa == pytest.approx(0.4)


def test_without_decided_beats_there_is_no_share_and_no_kappa() -> None:
    found = compare_beats(BEATS, {}, dict.fromkeys(BEATS), pairs=PAIRS)
    assert (found.share, found.kappa) == (None, None)
    alike = compare_beats(["b1"], {"smoke": "pass"}, {"b1": 1.0}, pairs=PAIRS)
    assert (alike.share, alike.kappa) == (1.0, None)
