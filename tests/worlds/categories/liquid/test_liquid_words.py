"""What a clause says of liquids asks for a liquid that an engine moves; painted water is no evidence (R66, R155)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.tests.stories.version_1 import old_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.categories.liquid.words import missing_liquid
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import WorldSpec

DRY = parse_spec({**old_spec(), "prompt": "A steel ball rolls into a row of three blocks."})
WET = parse_spec({**tank_spec(), "prompt": PROMPT})
MET = ["/entities/floor", "/story/beats/roll"]

TELLS = {
    "Water pours from a jug": "pours",
    "A log floats down the stream": "floats",
    "The street is flooded": "flooded",
    "A glass of milk stands on the table": "milk",
    "Waves break on the beach": "Waves",
    "Lava covers the road": "Lava",
    "A stream carries leaves and a log": "stream carries",
    "The river slowly carried a raft off": "river slowly carried",
    "Leaves drift down the brook": "drift down the brook",
    "A raft is swept along by a swollen river": "swept along by a swollen river",
    "A stream runs past a mill": "",
    "A woman carries a basket to the river": "",
    "A porter carries a trunk": "",
    "Sand pours onto a plate": "",
    "A balloon floats in the air": "",
    "A man waves at the camera": "",
    "A boy waves to his friends": "",
    "An oil lamp stands on the shelf": "",
    "A water tower overlooks the town": "",
    "A steel ball rolls into a row of three blocks": "",
}


@pytest.mark.parametrize("text", TELLS)
def test_words_that_tell_of_a_liquid_are_found(text: str) -> None:
    """Known gap: words with several meanings (a cup of tea colours, a float of a parade) ask, too; `static_because` answers."""
    assert [w for w, _ in missing_liquid(DRY, text, MET)] == ([TELLS[text]] if TELLS[text] else [])


def test_a_simulated_liquid_or_a_body_that_it_carries_is_evidence() -> None:
    assert not list(missing_liquid(WET, "Water splashes in a tank", ["/entities/water"]))
    assert not list(missing_liquid(WET, "A crate floats", ["/story/beats/drop"]))
    assert not list(missing_liquid(WET, "A tank of water", ["/entities/tank"]))
    assert list(missing_liquid(WET, "Water splashes in a tank", ["/entities/tank"]))
    one_way = WET.model_copy(update={"simulation": WET.simulation.model_copy(update={"couplings": {}})})
    assert list(missing_liquid(one_way, "A crate floats", ["/story/beats/drop"])), "what is not coupled carries nothing"


def test_water_of_a_landscape_is_water_that_nothing_moves_in() -> None:
    land = {"extent": [100, 100], "cell": 1, "hydrology": {"required": ["river"]}}
    spec = parse_spec({"title": "t", "prompt": "p", "terrains": {"land": land}, "simulation": {"frames": 2}})
    assert not list(missing_liquid(spec, "A river flows through the valley", ["/terrains/land"]))
    assert not list(missing_liquid(spec, "Still water lies below", ["/terrains/land"]))
    assert list(missing_liquid(spec, "A log floats down the river", ["/terrains/land"]))
    assert list(missing_liquid(spec, "The river floods the village", ["/terrains/land"]))
    assert list(missing_liquid(spec, "A stream carries leaves and a log", ["/terrains/land"]))


def _painted() -> dict[str, Any]:
    spec = old_spec()
    spec["entities"]["pool"] = {**spec["entities"]["floor"], "role": "blue water of the pool", "pose": {"position": [2, 2, 0]}}
    spec["simulation"]["solvers"]["rigid"]["members"].append("pool")
    spec["clauses"]["c3"] = {"met_by": ["/entities/pool", "/story/beats/roll"]}
    return spec


def test_painted_water_is_refused_as_evidence() -> None:
    prompt = (
        "A steel ball rolls into a row of three blocks. The last block falls off the shelf. The ball splashes into the water."
    )
    row = next(r for r in audit(parse_spec({**_painted(), "prompt": prompt})).rows if r.id == "audit:clauses")
    assert row.status == "fail"
    said = " ".join(row.evidence["problems"])
    assert "tells of a liquid (splashes) that nothing simulates" in said
    assert "pool is geometry, which shows no liquid" in said


def test_the_tank_meets_its_clauses() -> None:
    assert all(r.status == "pass" for r in audit(WET).rows)
    assert isinstance(WET, WorldSpec)
