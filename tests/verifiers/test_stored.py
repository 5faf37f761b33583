"""Open and missing rows of a stored verdict, found again whenever a gate asks, whatever a record says of them."""

from __future__ import annotations

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.verifiers.stored import demanded, demanded_of_motion, open_in_matrix, open_in_probe, unmet
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import WorldSpec


@pytest.fixture(scope="module")
def spec() -> WorldSpec:
    return parse_spec({**small_spec(), "prompt": PROMPT})


def row(row_id: str, status: str = "pass", **more: object) -> Row:
    check = row_id.partition(":")[0]
    return Row(**{"id": row_id, "check": check, "group": "physical", "predicate": "p", "status": status, "artifact": "x"} | more)  # type: ignore[arg-type]


def complete(spec: WorldSpec) -> list[Row]:
    """One passing row per id that is demanded, and one per check that has none of them."""
    names = [
        *demanded(spec),
        "support:scene",
        "shots:tiling",
        "numerical:finite:rigid",
        "contact:scene",
        "category:rigid:mass:rigid",
    ]
    return [row(i) for i in (*names, "navigability:scene")]


def test_the_specification_demands_its_beats_causes_entities_and_instances(spec: WorldSpec) -> None:
    assert demanded_of_motion(spec) == {
        "beat:fall",
        "beat:roll",
        "beat:strike",
        "causal:without:roll:strike",
        "causal:without:strike:fall",
    }
    assert demanded(spec) >= {*demanded_of_motion(spec), "scale:ball", "delivery:digests:rigid", "delivery:replay", "audit:story"}
    assert unmet(spec, complete(spec)) == []


def test_open_and_missing_rows_are_named(spec: WorldSpec) -> None:
    rows = [r for r in complete(spec) if r.id not in ("beat:fall", "navigability:scene")]
    lines = unmet(spec, [*rows, row("support:b1", "fail", measured=0.5, unit="m"), row("support:b2", "fail", mandatory=False)])
    assert lines == [
        "support:b1: fail, measured 0.5 m",
        "beat:fall: missing, although the specification demands it",
        "navigability: no row of this check",
    ]


def test_of_the_matrix_count_rows_that_fail_and_rows_of_the_whole_that_are_unverified() -> None:
    rows = [row("beat:a", "fail"), row("beat:b", "unverified"), row("beat:c", "unverified"), row("beat:d", "unverified")]
    rows[3] = rows[3].model_copy(update={"evidence": {"stale": "world.json changed"}})
    stages = {"beat:a": "probe", "beat:b": "probe", "beat:c": "full", "beat:d": "full"}
    assert open_in_matrix(rows, stages) == ["beat:a: fail", "beat:c: unverified"]


def test_a_probe_leaves_open_what_its_frames_could_have_judged() -> None:
    rows = [
        row("beat:a", "unverified", frames=(0, 40)),
        row("beat:b", "unverified", frames=(0, 20)),
        row("beat:c", "fail", frames=(0, 40)),
    ]
    assert [r.id for r in open_in_probe(rows, 30)] == ["beat:b", "beat:c"]
