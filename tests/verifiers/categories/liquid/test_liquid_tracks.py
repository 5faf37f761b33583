"""Tracks of a wet foot are founded; thicker ones, and those where no foot was, are not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from worldagent.geometry.solids import Solid
from worldagent.tests.simulation.liquid.test_tracks import STEPS, box, foot, walk
from worldagent.verifiers.categories.liquid.solids import Piece
from worldagent.verifiers.categories.liquid.tracks import Carried
from worldagent.worlds.categories.liquid.wet import Texels


def judged(found: list[dict[str, Any]], texels: dict[str, Any]) -> list[float]:
    place = np.array([foot(k).position for k in range(len(STEPS))])
    none, turn = np.zeros((len(STEPS), 3)), np.tile(np.eye(3), (len(STEPS), 1, 1))
    floor, sole = box((-0.2, -0.2, -0.1), (0.8, 0.2, 0.0)), box((-0.05, -0.05, 0.0), (0.05, 0.05, 0.1))
    pieces = [
        Piece("floor", "body", "body", Solid.from_mesh(floor, closed=True), none, turn, True, True),
        Piece("foot", "body", "body", Solid.from_mesh(sole, closed=True), place, turn, False, True),
    ]
    position, normal, area = (texels[f"texel/{n}"].astype(float) for n in ("position", "normal", "area"))
    held = Texels(position, normal, area, texels["texel/part"], (), 0.02)
    carried = Carried(held, pieces, [np.flatnonzero(texels["texel/part"] == k) for k in range(2)], 0.003)
    return [carried.see(k, frame).film for k, frame in enumerate(found)]


def test_a_walk_is_founded() -> None:
    _, texels, found = walk()
    assert sum(len(f["track/texel"]) for f in found) > 100
    assert judged(found, texels) == [0.0] * len(STEPS)


@pytest.mark.parametrize("what", ["thicker", "elsewhere", "too early", "above one"])
def test_films_that_nobody_left_are_noticed(what: str) -> None:
    _, texels, found = walk()
    frame = found[6]
    rows, film = frame["track/texel"].copy(), frame["track/film"].copy()
    floor = np.flatnonzero((texels["texel/part"] == 0) & (texels["texel/normal"][:, 2] > 0.5))
    x = texels["texel/position"][floor, 0]
    on_floor = np.isin(rows, floor)
    at = 6
    if what == "thicker":
        film[on_floor] *= 3.0
    elif what == "above one":
        film[on_floor] = 1.2
    else:
        spot = 0.7 if what == "elsewhere" else 0.6
        rows = np.append(rows, floor[np.argmin(np.abs(x - spot))]).astype(np.int32)
        film = np.append(film, np.float32(0.2))
    fluid = np.zeros(len(rows), dtype=np.int32)
    broken = [*found[:at], frame | {"track/texel": rows, "track/film": film, "track/fluid": fluid}, *found[at + 1 :]]
    values = judged(broken, texels)
    assert values[at] > 0.1
    assert values[:at] == [0.0] * at
