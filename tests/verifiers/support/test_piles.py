"""Groups that weight alone holds, told without a linear program: never one that the program finds wanting."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from worldagent.verifiers.support import equilibrium
from worldagent.verifiers.support.equilibrium import ENOUGH, Group, solve
from worldagent.verifiers.support.piles import rests_by_weight
from worldagent.verifiers.support.touching import Contacts

DOWN = np.array([0.0, 0.0, -1.0])


def patch(x: float, y: float, z: float, half: float, *, friction: float = 0.5, tilt: float = 0.0) -> Contacts:
    """Four corners of a level patch, pushed up from below."""
    points = np.array([(x + i * half, y + j * half, z) for i in (-1, 1) for j in (-1, 1)])
    normal = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    return Contacts(points, np.repeat(normal[None], 4, axis=0), np.full(4, friction))


def group(contacts: list[tuple[str, str, Contacts]], centers: dict[str, Any], weights: dict[str, float] | None = None) -> Group:
    names = tuple(centers)
    weight = np.array([(weights or {}).get(n, 1.0) for n in names])
    return Group(names, tuple(contacts), np.array(list(centers.values()), dtype=float), weight, np.full(len(names), 0.2), DOWN)


def by_program(some: Group, monkeypatch: pytest.MonkeyPatch) -> bool:
    """True if the linear program says that all of them rest."""
    with monkeypatch.context() as patched:
        patched.setattr(equilibrium, "rests_by_weight", lambda _: False)
        return all(b.missing <= ENOUGH and b.shift == 0.0 for b in solve(some).values())


def test_a_tower_rests_while_the_common_centre_is_over_its_foot() -> None:
    """Law: what stands on top moves the centre of all with it."""
    answers = []
    for x, weight in ((0.08, 1.0), (0.08, 50.0)):
        contacts = [("a", "floor", patch(0, 0, 0, 0.05)), ("b", "a", patch(0.05, 0, 0.1, 0.05))]
        answers.append(rests_by_weight(group(contacts, {"a": (0, 0, 0.05), "b": (x, 0, 0.15)}, {"b": weight})))
    assert answers == [True, False]


def test_a_block_across_two_others_shares_its_weight() -> None:
    """Choice: neither carrier alone has its centre over itself."""
    contacts = [("a", "floor", patch(-0.1, 0, 0, 0.04)), ("b", "floor", patch(0.1, 0, 0, 0.04))]
    contacts += [("c", "a", patch(-0.08, 0, 0.1, 0.02)), ("c", "b", patch(0.08, 0, 0.1, 0.02))]
    assert rests_by_weight(group(contacts, {"a": (-0.1, 0, 0.05), "b": (0.1, 0, 0.05), "c": (0.01, 0, 0.15)}))
    assert not rests_by_weight(group(contacts, {"a": (-0.1, 0, 0.05), "b": (0.1, 0, 0.05), "c": (0.12, 0, 0.15)}))


@pytest.mark.parametrize("change", [{"friction": 0.0}, {"tilt": 1e-3}])
def test_contacts_that_cannot_push_straight_up_prove_nothing(change: dict[str, float]) -> None:
    """Choice: the program decides about slopes and about what is smooth."""
    assert not rests_by_weight(group([("a", "floor", patch(0, 0, 0, 0.05, **change))], {"a": (0, 0, 0.05)}))
    assert rests_by_weight(group([("a", "floor", patch(0, 0, 0, 0.05))], {"a": (0, 0, 0.05)}))


def test_bodies_that_stand_on_each_other_in_a_ring_prove_nothing() -> None:
    """Law: a force that goes round is borne by nothing."""
    ring = [("a", "b", patch(0, 0, 0, 0.05)), ("b", "a", patch(0, 0, 0, 0.05))]
    assert not rests_by_weight(group(ring, {"a": (0, 0, 0.1), "b": (0, 0, 0.1)}))


def _drawn(rng: np.random.Generator) -> tuple[float, float]:
    x, y = rng.uniform(-0.06, 0.06, 2)
    return float(x), float(y)


def test_what_is_proven_the_program_finds_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Law: forces that are written down are a solution, so that none is ever told to rest that the program finds wanting."""
    rng = np.random.default_rng(7)
    found = {True: 0, False: 0}
    for _ in range(120):
        centers, contacts = {}, []
        for k in range(int(rng.integers(1, 5))):
            x, y = rng.uniform(-0.08, 0.08, 2)
            centers[f"b{k}"] = (x, y, 0.1 * k + 0.05)
            for on in ["floor"] if k == 0 else rng.choice([f"b{n}" for n in range(k)], size=min(k, 2), replace=False):
                contacts.append((f"b{k}", str(on), patch(*_drawn(rng), 0.1 * k, float(rng.uniform(0.02, 0.08)))))
        some = group(contacts, centers, {n: float(rng.uniform(0.2, 5.0)) for n in centers})
        proven = rests_by_weight(some)
        found[proven] += 1
        assert not proven or by_program(some, monkeypatch)
    assert min(found.values()) >= 20, found
