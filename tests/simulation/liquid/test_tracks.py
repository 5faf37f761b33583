"""Tracks: a film splits where surfaces meet, each print has half of the one before, and no film is made up."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.simulation.liquid.tracks import Tracks, sweeps
from worldagent.simulation.liquid.wet import WetPart, _spread
from worldagent.worlds.arrays import RigidPose
from worldagent.worlds.built import TriangleMesh

SIZE = 0.02
FOOT = 0.1


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> TriangleMesh:
    corner = np.array([[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]  # fmt: skip
    return TriangleMesh(corner, np.array(faces, dtype=np.int32))


STEPS = [(0.0, 0.0), (0.0, 0.1), (0.2, 0.1), (0.2, 0.0), (0.2, 0.1), (0.4, 0.1), (0.4, 0.0), (0.4, 0.1), (0.6, 0.1), (0.6, 0.0)]
"""Place along x and height of the foot at every frame: it stands at frames 0, 3, 6 and 9."""


def foot(frame: int) -> RigidPose:
    x, z = STEPS[frame]
    return RigidPose(np.array([x, 0.0, z + 0.001]), np.array([1.0, 0.0, 0.0, 0.0]))


def here(_: int) -> RigidPose:
    return RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


def walk(drying: float = 1e6) -> tuple[Tracks, dict[str, np.ndarray], list[dict[str, np.ndarray]]]:
    """A foot that is wet at frame 0 walks over a dry floor."""
    parts = [
        WetPart(("floor", "body", "body"), box((-0.2, -0.2, -0.1), (0.8, 0.2, 0.0)), here, True),
        WetPart(("foot", "body", "body"), box((-FOOT / 2, -FOOT / 2, 0.0), (FOOT / 2, FOOT / 2, 0.1)), foot, False),
    ]
    reach = (np.full(3, -0.1), np.full(3, 0.1))
    texels, size = _spread(parts, [reach, *sweeps(parts, reach, len(STEPS), SIZE)], SIZE)
    groups = [np.flatnonzero(texels["texel/part"] == k) for k in range(2)]
    tracks = Tracks(texels, groups, parts, size=size, gap=0.003, drying=np.array([drying]), step=1 / 24)
    sole = groups[1][texels["texel/normal"][groups[1]][:, 2] < -0.5]
    found = []
    for frame in range(len(STEPS)):
        wet = sole if frame == 0 else sole[:0]
        held = {"wet/texel": wet, "wet/fluid": np.zeros(len(wet), dtype=np.int32)}
        found.append(held | tracks.follow(frame, held))
    return tracks, texels, found


def prints(texels: dict[str, np.ndarray], tracks: Tracks) -> list[float]:
    """Mean film on the floor under the foot's places."""
    at, up = texels["texel/position"], texels["texel/normal"][:, 2] > 0.5
    floor = (texels["texel/part"] == 0) & up
    inner = FOOT / 2 - SIZE
    return [
        float(tracks._film[floor & (np.abs(at[:, 0] - x) < inner) & (np.abs(at[:, 1]) < inner)].mean()) for x in (0.2, 0.4, 0.6)
    ]


def test_every_print_has_half_of_the_one_before() -> None:
    """Law: a film splits in halves. Between the prints the floor stays dry, also where the foot passes over it."""
    tracks, texels, _ = walk()
    assert prints(texels, tracks) == pytest.approx([0.5, 0.25, 0.125], rel=0.25)
    at = texels["texel/position"]
    between = (texels["texel/part"] == 0) & (np.abs(at[:, 0] - 0.3) < 0.04)
    assert between.any()
    assert tracks._film[between].max() == 0.0


def test_films_are_shared_and_not_made() -> None:
    """Law: their sum over places of one size does not grow after the foot was wetted."""
    _, texels, found = walk()
    amount = np.zeros(len(texels["texel/part"]))
    amount[found[0]["wet/texel"]] = 1.0
    sums = []
    for held in found:
        amount[held["track/texel"]] = held["track/film"]
        sums.append(float(amount.sum()))
    # Frame 0: the sole stays wet under liquid, and its print is new.
    assert (np.diff(sums[1:]) <= 1e-3 * sums[0]).all()
    assert sums[-1] > 0.8 * sums[0]


def test_films_dry_as_declared_while_they_are_carried() -> None:
    wet, dry = walk()[0], walk(drying=0.1)[0]
    texels = walk()[1]
    share = np.array(prints(texels, dry)) / np.array(prints(texels, wet))
    assert share[0] == pytest.approx(np.exp(-(9 / 24) / 0.1), rel=0.05)


def test_a_resumed_run_goes_on_alike() -> None:
    tracks, texels, found = walk()
    again = walk()[0]
    again._film[:], again._fluid[:] = 0.0, -1
    for held in found:
        again.take(held)
    assert again._film == pytest.approx(tracks._film, abs=1e-12)
    assert (again._fluid == tracks._fluid).all()
    assert len(texels["texel/part"]) == len(again._film)
