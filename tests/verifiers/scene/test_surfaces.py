"""Clearances that the spatial checks share: what is known already saves queries and changes no answer."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.geometry import batch
from worldagent.geometry.clearance import signed_clearance
from worldagent.testing.worlds.small_worlds import entity, ground, make_candidate, pose, world
from worldagent.verifiers.scene import surfaces as surfaces_module
from worldagent.verifiers.scene.surfaces import Surfaces
from worldagent.verifiers.support.touching import contacts_of
from worldagent.worlds.spec import Box, Part


def cluttered(tmp_path, seed: int):
    """Boards that lie on each other, some apart by less than the contact tolerance, and rails across them."""
    rng = np.random.default_rng(seed)
    things, height = {"ground": ground()}, 0.0
    for k in range(5):
        boards = [
            Part(shape=Box(size=(0.3, 0.2, 0.1)), pose=pose((0.31 * n, float(rng.uniform(-0.1, 0.1)), 0.05))) for n in range(4)
        ]
        height += float(rng.choice([0.0, 5e-4, 0.02]))
        made = entity(*boards, motion="static" if k == 0 else "dynamic")
        things[f"layer{k}"] = made.model_copy(update={"pose": pose((0.0, 0.0, height))})
        height += 0.1
    return make_candidate(tmp_path, world(things))


@pytest.mark.parametrize("seed", range(4))
def test_what_is_known_at_the_start_changes_no_gap_and_no_contact(tmp_path, seed):
    """Law: the nearest parts and the contact points of two entities are those of all their parts."""
    candidate = cluttered(tmp_path, seed)
    knowing, fresh = Surfaces(candidate), Surfaces(candidate)
    assert len(knowing.first) >= 2
    assert not fresh.at_start
    for a, b in knowing.first:
        one, two = knowing.gap(a, b, 0), fresh.gap(a, b, 0)
        assert (one.distance, one.part_a, one.part_b) == (two.distance, two.part_a, two.part_b)
        assert np.array_equal(one.point_a, two.point_a)
        found, expected = contacts_of(knowing, a, b, 0), contacts_of(fresh, a, b, 0)
        assert np.array_equal(found.points, expected.points)
        assert np.array_equal(found.normals, expected.normals)


def test_two_entities_are_measured_once_at_the_start_for_all_checks(tmp_path, monkeypatch):
    """Choice: overlap and support both ask where things touch, and in a room they touch by the thousand."""
    asked = []
    measure = signed_clearance
    monkeypatch.setattr(surfaces_module, "signed_clearance", lambda *given: asked.append(1) or measure(*given))
    surfaces = Surfaces(cluttered(tmp_path, 0))
    a, b = next(iter(surfaces.first))
    first = surfaces.gap(a, b, 0)
    count = len(asked)
    assert count > 0
    assert surfaces.gap(a, b, 0) == first
    assert len(asked) == count
    assert surfaces.gap(a, b, 0, offset=np.array([0.0, 0.0, 1.0])).distance > first.distance
    assert len(asked) > count


@pytest.mark.parametrize("seed", range(4))
def test_carrying_asked_of_all_at_once_is_carrying_asked_one_by_one(tmp_path, seed):
    """Own choice: all pairs that touch are measured together, and none of the answers depends on the others."""
    surfaces = Surfaces(cluttered(tmp_path, seed))
    answers = set()
    for a, b in surfaces.first:
        for below, above in ((a, b), (b, a)):
            alone = Surfaces(surfaces.candidate)
            assert alone.first.keys() == surfaces.first.keys()
            gap = alone.contact_gap(below, above)
            expected = bool(alone._carried([(below, above)], 1, gap)[below, above][0])
            assert bool(surfaces.carries(below, above, until=1)[0]) is expected
            answers.add(expected)
    assert answers == {True, False}


@pytest.mark.parametrize("seed", range(4))
def test_gaps_asked_for_all_at_once_are_those_asked_one_by_one(tmp_path, monkeypatch, seed):
    """Law: in a large world compiled loops answer for all pairs that are near, and for parts of one entity; the distances are the same."""
    candidate = cluttered(tmp_path, seed)
    fresh, together = Surfaces(candidate), Surfaces(candidate)
    expected = {pair: fresh.gap(*pair, 0) for pair in fresh.first}
    monkeypatch.setattr(batch, "MANY", 1)
    assert together.first.keys() == expected.keys()
    monkeypatch.setattr(surfaces_module, "signed_clearance", None)  # nobody asks for a single pair
    for (a, b), wanted in expected.items():
        found, back = together.gap(a, b, 0), together.gap(b, a, 0)
        assert found.distance == back.distance == pytest.approx(wanted.distance, abs=1e-14)
        assert np.array_equal(found.point_a, back.point_b)
        assert (found.part_a, found.part_b) == (back.part_b, back.part_a)
    for name in ("layer1", "layer4"):
        rows = together.parts_of[name]
        assert not {parts for parts in together.own if parts[0] in rows}  # boards of one layer lie 10 mm apart, beyond reach


def test_parts_of_one_entity_have_their_distances_at_once(tmp_path, monkeypatch):
    """Limit case: two boards that touch, and a third that is 1 mm away."""
    monkeypatch.setattr(batch, "MANY", 1)
    boards = [Part(shape=Box(size=(0.3, 0.2, 0.1)), pose=pose((x, 0.0, 0.05))) for x in (0.0, 0.3, 0.601)]
    surfaces = Surfaces(make_candidate(tmp_path, world({"ground": ground(), "row": entity(*boards)})))
    first = surfaces.parts_of["row"][0]
    assert surfaces.own == {
        (first, first + 1): pytest.approx(0.0, abs=1e-15),
        (first + 1, first + 2): pytest.approx(1e-3, abs=1e-12),
    }
