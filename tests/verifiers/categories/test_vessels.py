"""Pours, fills, overflows and leaks: how water leaves a tank decides, on ways in closed form."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from worldagent.testing.worlds import small_worlds as sw
from worldagent.testing.worlds.liquid_worlds import Flow, G, pool_in_tank
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.categories.vessel import Vessel, vessel_of
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.arrays import F64, rotation_matrix
from worldagent.worlds.categories.event import VesselEvent
from worldagent.worlds.errors import EvidenceError

Flags = NDArray[np.bool_]
S = 0.02
SIZE = (0.24, 0.2, 0.12)
"""Size of the water [m]; the tank is twice as deep."""
FRAMES = 12
KINDS = ("pours", "fills", "overflows", "leaks")
UP = np.array([0.0, 0.0, 1.0])


def pool(*, full: bool = False, gap: float = 0.0) -> Flow:
    """Still water in a tank that a path may move; with `full` it stands to the rim, with `gap` over a slit in the floor."""
    flow = pool_in_tank(size=SIZE, spacing=S, frames=FRAMES, gap=gap, below=0.5)
    tank = flow.spec.entities["tank"].model_copy(update={"motion": "kinematic"})
    spec = flow.spec.model_copy(update={"entities": {**flow.spec.entities, "tank": tank}})
    points = flow.position[0]
    if full:
        points = np.concatenate([points, points + np.array([0.0, 0.0, SIZE[2]])])
    ids = np.arange(len(points))
    still = [points.copy() for _ in range(FRAMES)]
    return flow.edited(spec=spec, position=still, velocity=[0 * p for p in still], identity=[ids] * FRAMES)


def fallen(start: F64, frames: int) -> F64:
    """A place after so many frames of free fall."""
    return start - UP * 0.5 * G * (frames / 24) ** 2


def leaves(flow: Flow, which: Flags, lip: F64, at: int = 3, each: int = 40) -> Flow:
    """Some particles go to a lip, over or through it, and fall; so many in every frame from `at` on."""
    out = flow.edited()
    for k in range(FRAMES):
        for n, i in enumerate(np.flatnonzero(which).tolist()):
            since = k - at - n // each
            if since >= 0:
                out.position[k][i] = fallen(lip + np.array([0.0, 1e-3 * (n % each), 0.0]), since)
    return out


def tilted(flow: Flow, angle: float = 1.0) -> Flow:
    """The tank and all in it lean over by an angle [rad] from frame 2 on, about an edge of its foot."""
    turns = np.array([angle if k >= 2 else 0.0 for k in range(FRAMES)])
    quaternion = np.stack([np.cos(turns / 2), 0 * turns, np.sin(turns / 2), 0 * turns], axis=1)
    turn, foot = rotation_matrix(quaternion), np.array([SIZE[0] / 2, 0.0, 0.0])
    place = foot - turn @ foot
    moved = [p @ turn[k].T + place[k] for k, p in enumerate(flow.position)]
    return flow.edited(position=moved, tracks={"tank": (place, quaternion)})


def judged(flow: Flow, folder: Path, kind: str, **more: float) -> Outcome:
    event = VesselEvent.model_validate({"kind": kind, "entity": "pool", "other": "tank", **more})
    return evaluate(flow.candidate(folder), event, (0, FRAMES - 1))


def told(flow: Flow, folder: Path) -> set[str]:
    """Kinds that are true of it."""
    candidate = flow.candidate(folder)
    asked = {kind: VesselEvent.model_validate({"kind": kind, "entity": "pool", "other": "tank"}) for kind in KINDS}
    return {kind for kind, event in asked.items() if evaluate(candidate, event, (0, FRAMES - 1)).status == "pass"}


def upper(flow: Flow) -> Flags:
    """Which particles stand in the upper half of the water."""
    z = flow.position[0][:, 2]
    return np.asarray(z > np.median(z))


def poured() -> Flow:
    """The tank leans, and its upper half runs over the lip."""
    flow = tilted(pool(full=True))
    candidates = upper(pool(full=True))
    angle = 1.0
    rim = np.array([SIZE[0] / 2 + 0.03, -0.02, 2 * SIZE[2] - 0.005])
    turn = rotation_matrix(np.array([np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0]))
    foot = np.array([SIZE[0] / 2, 0.0, 0.0])
    return leaves(flow, candidates, turn @ (rim - foot) + foot)


def overflowed(*, full: bool = True) -> Flow:
    """Flow in which the uppermost liquid runs over the rim of an upright tank."""
    flow = pool(full=full)
    return leaves(flow, upper(flow), np.array([SIZE[0] / 2 + 0.035, -0.02, 2 * SIZE[2] - 0.004]))


def leaked() -> Flow:
    """Water over a slit in the tank's floor falls through it."""
    flow = pool(gap=3.2 * S)
    middle = np.abs(flow.position[0][:, 0] - 0.5 * S) < S
    out = flow.edited()
    for k in range(FRAMES):
        out.position[k][middle] = fallen(flow.position[0][middle], max(0, k - 2))
    return out


def filled() -> Flow:
    """Layer by layer water comes down into the empty tank."""
    flow = pool(full=True)
    out = flow.edited()
    z = flow.position[0][:, 2]
    for k in range(FRAMES):
        high = z > 2 * SIZE[2] * (k + 1) / FRAMES
        out.position[k][high] += np.array([0.0, 0.0, 0.3])
    return out


def lying(*, out: bool = True, gone: bool = False) -> Flow:
    """The tank lies on its side, and its upper half runs out onto what it lies on; with `gone`, what ran out first is taken away there."""
    flow = tilted(pool(full=True), angle=1.5)
    which = np.flatnonzero(upper(pool(full=True)))
    made = flow.edited()
    for k in range(3, FRAMES) if out else ():
        for n, i in enumerate(which.tolist()):
            if n < 80 * (k - 2):
                made.position[k][i] += np.array([0.08 * (k - 2 - n // 80), 0.0, 0.0])
    if gone:
        keep = [np.ones(len(p), dtype=bool) for p in made.position]
        for k in range(8, FRAMES):
            keep[k][which[:320]] = False  # out since frame 6
        parts = ("position", "velocity", "identity")
        return made.edited(**{name: [np.asarray(x)[m] for x, m in zip(getattr(made, name), keep, strict=True)] for name in parts})
    return made


WORLDS: dict[str, tuple[Callable[[], Flow], set[str]]] = {
    "poured over the lip of a leaning tank": (poured, {"pours"}),
    "over the rim of a full upright tank": (overflowed, {"overflows"}),
    "splashed out of a tank that is half full": (lambda: overflowed(full=False), set()),
    "through a slit in the floor": (leaked, {"leaks"}),
    "layer by layer into the tank": (filled, {"fills"}),
    "out of a tank that lies, onto what it lies on": (lying, {"pours"}),
    "carried along in a tank that lies": (lambda: lying(out=False), set()),
    "carried along in a leaning tank": (lambda: tilted(pool()), set()),
    "at rest in a full tank": (lambda: pool(full=True), set()),
}


@pytest.mark.parametrize("name", WORLDS)
def test_each_way_in_or_out_is_its_own_event(name: str, tmp_path: Path) -> None:
    make, wanted = WORLDS[name]
    assert told(make(), tmp_path) == wanted


def test_what_ran_out_counts_on_after_it_has_left_the_domain(tmp_path: Path) -> None:
    """Half of what was in the tank ran out of it; particles that open sides took away are no less poured."""
    stays, goes = (judged(lying(gone=gone), tmp_path / str(gone), "pours") for gone in (False, True))
    assert stays.value == pytest.approx(0.5, abs=0.1)
    assert goes.value == pytest.approx(stays.value, abs=0.02)


def test_what_goes_through_a_wall_is_no_leak(tmp_path: Path) -> None:
    """A defect of the liquid that its own rows find: there is no opening."""
    flow = pool()
    out = leaves(flow, flow.position[0][:, 2] < SIZE[2] / 2, np.array([SIZE[0] / 2 + 0.05, 0.0, 0.04]))
    found = judged(out, tmp_path, "leaks")
    assert (found.status, found.value) == ("fail", 0.0)


def test_shares_are_of_the_tank_and_of_what_was_in_it(tmp_path: Path) -> None:
    volume = float(np.prod(SIZE))
    found = judged(filled(), tmp_path / "fills", "fills")
    assert found.value == pytest.approx(1.0, abs=0.12)
    assert judged(filled(), tmp_path / "more", "fills", min=1.5).status == "fail"
    assert found.details["capacity_m3"] == pytest.approx(2 * volume, rel=0.12)
    through = judged(leaked(), tmp_path / "leaks", "leaks")
    assert through.value == pytest.approx(2 * S / SIZE[0], abs=0.02)
    over = judged(overflowed(), tmp_path / "over", "overflows")
    assert over.value == pytest.approx(9 * 40 / 1440, abs=0.03)


def vessel(folder: Path) -> Vessel:
    return vessel_of(pool().candidate(folder), "tank", UP)


def test_a_vessel_is_what_its_walls_stand_about(tmp_path: Path) -> None:
    made = vessel(tmp_path)
    half = SIZE[0] / 2
    places = np.array([[0, 0, 0.1], [0, 0, 0.235], [0, 0, 0.27], [0, 0, -0.1], [half + 0.04, 0, 0.1], [half - 0.01, 0, 0.1]])
    assert made.inside(made.local(places, 0)).tolist() == [True, True, False, False, False, True]
    assert made.below_rim(made.local(places[:1], 0))[0] == pytest.approx(0.14, abs=made.cell)
    assert made.tilt(0) == pytest.approx(0.0, abs=1e-9)


def test_a_slab_is_no_vessel(tmp_path: Path) -> None:
    flow = pool_in_tank(size=SIZE, spacing=S, frames=2, others={"slab": sw.box(0.1, 0.1, 0.02, at=(2, 0, 0))})
    with pytest.raises(EvidenceError, match="enclose nothing"):
        vessel_of(flow.candidate(tmp_path), "slab", UP)
