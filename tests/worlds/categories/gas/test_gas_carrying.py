"""Couplings by which a gas carries others: what the audit says of them, what is baked first, and the medium that caches tell of."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.carried_worlds import JET_PROMPT, embers_spec, jet_spec, stream_spec
from worldagent.testing.worlds.small_gas import dust_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.bake_plan import groups_of
from worldagent.worlds.cache import Cache, CacheIndex, write_container
from worldagent.worlds.categories.gas.carrying import unmet
from worldagent.worlds.categories.gas.medium import FADES, GasMedium
from worldagent.worlds.errors import EvidenceError
from worldagent.worlds.fields import fields_of
from worldagent.worlds.instances import bake_order, felt_by, read_by, waits_for_itself
from worldagent.worlds.spec import WorldSpec
from worldagent.worlds.writers import writers_of

BACK = {"source": "bodies", "target": "air", "direction": "one_way", "variables": ["motion"]}
CARRIES = {"source": "air", "target": "bodies", "direction": "one_way", "variables": ["wrench"]}


def world(document: dict[str, Any], *edits: tuple[str, Any]) -> WorldSpec:
    for pointer, value in edits:
        *way, last = pointer.strip("/").split("/")
        node = document
        for step in way:
            node = node[step]
        node[last] = value
    return WorldSpec.model_validate({"prompt": JET_PROMPT, **document})


def problems(spec: WorldSpec) -> str:
    """Texts of the rows about couplings and gases."""
    rows = [r for r in audit(spec).rows if r.id in ("audit:couplings", "audit:gases")]
    return " ".join(p for r in rows if r.status != "pass" for p in (r.evidence or {})["problems"])


@pytest.mark.parametrize("document", [jet_spec(), embers_spec(), stream_spec(thing="sheet")], ids=["body", "embers", "sheet"])
def test_a_gas_that_carries_passes_and_is_baked_before_what_it_carries(document: dict[str, Any]) -> None:
    spec = world(document)
    assert problems(spec) == ""
    order, (coupling,) = bake_order(spec), spec.simulation.couplings.values()
    assert order.index("air") < order.index(coupling.target)
    assert "air" in read_by(spec, coupling.target)


def test_bodies_that_a_gas_carries_are_not_in_its_way_and_others_are() -> None:
    spec = world(jet_spec())
    assert unmet(spec, "air") == {"ball"}
    assert read_by(spec, "air") == ()
    alone = world(jet_spec(), ("/simulation/couplings", {}))
    assert unmet(alone, "air") == frozenset()
    assert read_by(alone, "air") == ("bodies",)
    assert bake_order(alone) == ("bodies", "air")


def test_matter_that_reads_carried_bodies_comes_after_them() -> None:
    """Cloth that meets the ball: gas, then bodies, then cloth."""
    document = stream_spec(thing="sheet")
    document["entities"]["ball"] = jet_spec()["entities"]["ball"]
    document["simulation"]["solvers"]["bodies"]["members"].append("ball")
    document["simulation"]["couplings"]["too"] = CARRIES
    assert bake_order(world(document)) == ("air", "bodies", "sheets")


def test_dust_of_bodies_that_the_gas_carries_is_refused() -> None:
    spec = world(dust_spec(), ("/simulation/couplings", {"c": CARRIES}))
    assert "driver 'kick' makes gas of 'air' by how 'ball' moves, and coupling 'c' lets that gas carry it" in problems(spec)


WRONG: list[tuple[tuple[str, Any], str]] = [
    (("/simulation/couplings/carries/variables", ["motion"]), "it exchanges wrench alone"),
    (("/simulation/couplings/back", BACK), "let 'bodies' move the gas of 'air' and be moved by it"),
    (("/entities/ball/motion", "static"), "no member of 'bodies' is dynamic"),
    (("/simulation/order", ["bodies", "air"]), "comes before 'air', whose motion it reads"),
    (
        ("/simulation/drivers/wind", {"kind": "field", "field": {"kind": "wind", "velocity": [1, 0, 0]}, "entities": ["ball"]}),
        "moves the air about 'ball' and not the gas",
    ),
]


@pytest.mark.parametrize(("edit", "said"), WRONG, ids=[said for _, said in WRONG])
def test_the_audit_refuses_what_contradicts(edit: tuple[str, Any], said: str) -> None:
    assert said in problems(world(jet_spec(), edit))


@pytest.mark.parametrize("document", [jet_spec(), embers_spec(), stream_spec(thing="sheet")], ids=["body", "embers", "sheet"])
def test_a_gas_that_feels_what_it_carries_moves_at_the_same_time(document: dict[str, Any]) -> None:
    spec = world(document, ("/simulation/couplings/carries/direction", "two_way"))
    assert problems(spec) == ""
    (coupling,) = spec.simulation.couplings.values()
    assert {"air", coupling.target} in [set(group) for group in groups_of(spec)]
    assert felt_by(spec, "air") == (coupling.target,)
    assert "air" not in read_by(spec, coupling.target)
    assert coupling.target not in read_by(spec, "air")
    assert ("bodies" in read_by(spec, "air")) == (coupling.target != "bodies")
    assert "gas feel" in writers_of(spec, "air")
    assert felt_by(world(jet_spec()), "air") == ()


def test_what_cannot_be_felt_is_refused() -> None:
    felt = ("/simulation/couplings/carries/direction", "two_way")
    follows = world(jet_spec(), felt, ("/simulation/solvers/air/settings/follows", True))
    assert "is solved in a part of its box that follows it, and feels nothing there" in problems(follows)
    document = stream_spec(thing="sheet")
    document["entities"]["ball"] = jet_spec()["entities"]["ball"]
    document["simulation"]["solvers"]["bodies"]["members"].append("ball")
    document["simulation"]["couplings"]["too"] = {**CARRIES, "direction": "two_way"}
    both = world(document, felt)
    assert "'sheets' and 'bodies' move at the same time as the gas of 'air', and do not push each other" in problems(both)
    joined = {"source": "sheets", "target": "bodies", "direction": "two_way", "variables": ["motion", "wrench"]}
    assert problems(world(document, felt, ("/simulation/couplings/joined", joined))) == ""
    soft = jet_spec()
    soft["entities"]["ball"]["physics"] = {"category": "elastic", "young_modulus": 1e5, "resolution": 0.01}
    assert "does not feel 'ball', which deforms" in problems(world(soft, felt))


def test_what_would_burn_in_the_gas_that_carries_it_is_refused() -> None:
    document = embers_spec()
    document["entities"]["ball"] = jet_spec()["entities"]["ball"]
    document["materials"]["shell"] = {"density": 500.0, "substance": "paper", "flammable": {}}
    document["simulation"]["solvers"]["bodies"]["members"].append("ball")
    document["simulation"]["couplings"]["too"] = CARRIES
    assert "'ball' may burn in the gas of 'air', which carries it" in problems(world(document))


def test_cloth_that_burns_in_the_gas_that_carries_it_is_a_circle() -> None:
    burns = {"source": "sheets", "target": "air", "direction": "one_way", "variables": ["motion"]}
    spec = world(stream_spec(thing="sheet"), ("/simulation/couplings/burns", burns))
    assert set(waits_for_itself(spec)) == {"air", "sheets"}
    assert "let 'sheets' move the gas of 'air' and be moved by it" in problems(spec)


def linear_cache(folder: Path) -> Cache:
    """Two frames of a gas whose values are linear in place and time."""
    cache = Cache(folder)
    folder.mkdir(parents=True, exist_ok=True)
    cache.write_index(CacheIndex("air", "gas", 10, 2, ("smoke",), (), (), (), "", {}))
    corner, cell, shape = np.array([-0.3, 0.1, 0.2]), 0.1, (6, 5, 4)
    middles = corner + cell * (np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1) + 0.5)
    digests = []
    for frame in range(2):
        data = {
            "gas_corner": corner,
            "gas_velocity": ((1.0 + frame) * middles).astype(np.float32),
            "gas_temperature": (300.0 + 100.0 * middles[..., 2]).astype(np.float32),
            "gas_soot": np.zeros(shape, np.float32),
        }
        digests.append(write_container(cache.path(frame), data))
    cache.begin_digests(digests)
    return Cache(folder)


def test_a_medium_is_linear_between_cells_and_frames_and_fades_beyond_its_box(tmp_path: Path) -> None:
    """Interpolation of a linear field is exact; one cell out of the box a share of 1 / `FADES` less is the gas."""
    medium = GasMedium(linear_cache(tmp_path / "air"), 0.1, 10.0, 0.47, 293.15)
    points = np.array([[0.0, 0.3, 0.4], [-0.2, 0.22, 0.33], [-0.4, 0.3, 0.4], [-0.3 - 0.1 * FADES, 0.3, 0.4]])
    for time, factor in ((0.0, 1.0), (0.025, 1.25), (0.1, 2.0), (-1.0, 1.0)):
        found, share = medium.at(points, time)
        assert found.velocity[:2] == pytest.approx(factor * points[:2], rel=1e-6)
        assert found.density[:2] == pytest.approx(352.98 / (300.0 + 100.0 * points[:2, 2]), rel=1e-4)
        assert share == pytest.approx([1.0, 1.0, 1.0 - 1.0 / FADES, 0.0])


def test_about_the_box_there_is_still_air_and_without_a_cache_nothing_is_told(tmp_path: Path) -> None:
    spec = world(jet_spec())
    with pytest.raises(EvidenceError, match="probe or bake first"):
        fields_of(spec, "ball").medium(np.zeros((1, 3)), 0.0)
    media = {"air": GasMedium(linear_cache(tmp_path / "air"), 0.1, 10.0, 0.47, 293.15)}
    far = fields_of(spec, "ball", media=media).medium(np.array([[9.0, 0.0, 0.0]]), 0.0)
    assert far.density[0] == pytest.approx(1.204, rel=1e-3)
    assert not far.velocity.any()
    assert fields_of(spec, "floor", media=media).names == ()
