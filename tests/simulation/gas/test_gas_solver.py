"""Gas as instances bake it: what is made is in the box or has left it, wind comes in at open sides, a plate is in the way."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.gas.solver import SolverGas
from worldagent.simulation.protocol import Intervention
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.by_category import spec_of
from worldagent.testing.worlds.small_gas import SMOKE_PROMPT, smoke_spec, stirred_spec
from worldagent.worlds.errors import InputError

LAST = 6
WIND = {"kind": "field", "field": {"kind": "wind", "velocity": [1.5, 0, 0]}}


def frame_of(changes: Mapping[str, Any], *, last: int = LAST, intervention: Intervention | None = None) -> dict[str, Any]:
    """A frame of the small world with other values at some pointers."""
    document = smoke_spec(frames=LAST + 1)
    for pointer, value in changes.items():
        *way, key = pointer.strip("/").split("/")
        node = document
        for step in way:
            node = node[step]
        node[key] = value
    spec = spec_of(document, SMOKE_PROMPT)
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    solver = SolverGas(spec, built, "air", intervention=intervention)
    solver.prepare()
    for frame in range(1, last + 1):
        solver.advance(frame)
    return dict(solver.frame_data())


def balance(frame: Mapping[str, Any], what: str, held: str) -> float:
    """Share of what was emitted that is neither in the box nor has left it."""
    made = float(frame[f"record/emitted_{what}"])
    return abs(float(frame[f"record/{held}"]) + float(frame[f"record/escaped_{what}"]) - made) / made


def test_what_is_made_is_in_the_box_or_has_left_it() -> None:
    """A quarter of a second at 0.08 m^3/s, in wind that takes it out at a side."""
    frame = frame_of({"/simulation/drivers/fire/rate": 0.08, "/simulation/drivers/wind": WIND})
    assert float(frame["record/volume_emitted"]) == pytest.approx(0.08 * 6 / 24)
    assert float(frame["record/escaped_soot"]) > 0.1 * float(frame["record/emitted_soot"])
    assert balance(frame, "soot", "soot_mass") < 1e-6
    assert balance(frame, "heat", "heat") < 1e-6
    assert float(frame["record/volume_escaped"]) == pytest.approx(0.02, rel=1e-3)
    assert float(frame["record/divergence"]) < 1e-5


def test_an_emission_makes_gas_from_its_start_to_its_end_alone() -> None:
    """From 0.05 to 0.1 s, which no step meets."""
    times = {"/simulation/drivers/fire/start": 0.05, "/simulation/drivers/fire/end": 0.1}
    assert float(frame_of(times)["record/volume_emitted"]) == pytest.approx(0.004 * 0.05)
    alone = frame_of({}, intervention=Intervention(without=frozenset({"fire"})))
    assert float(alone["record/soot_mass"]) == 0.0
    assert float(alone["record/max_speed"]) < 1e-6


def test_gas_is_no_hotter_than_its_source_and_no_colder_than_the_air() -> None:
    frame = frame_of({"/simulation/drivers/fire/rate": 0.02})
    assert 293.0 < frame["gas_temperature"].min() <= frame["gas_temperature"].max() < 400.5
    assert frame["gas_soot"].max() <= 1.001e-3


def test_wind_blows_around_the_plate_from_frame_0_on() -> None:
    start, later = (frame_of({"/simulation/drivers/wind": WIND}, last=n) for n in (0, LAST))
    for frame in (start, later):
        speed = frame["gas_velocity"][..., 0]
        assert speed[0].mean() == pytest.approx(1.5, rel=0.05)
        assert speed.max() > 1.6, "past the plate"
        assert np.abs(frame["gas_velocity"][..., 2]).max() > 0.1, "up and down at its edge"


def test_wind_that_begins_later_comes_in_at_the_side_that_it_blows_at() -> None:
    frame = frame_of({"/simulation/drivers/wind": {**WIND, "start": 0.05}})
    speed = frame["gas_velocity"][..., 0].mean(axis=(1, 2))
    assert speed[0] > 1.0 > 0.3 > speed[-1]
    assert (np.diff(speed) < 0.05).all()


def test_a_source_in_a_solid_is_refused() -> None:
    with pytest.raises(InputError, match=r"lies in solids.*/entities/smoke/pose"):
        frame_of(
            {
                "/entities/plate/dimensions/size": [0.3, 0.3, 0.3],
                "/entities/plate/parts/plate/shape/size": [0.3, 0.3, 0.3],
                "/entities/plate/pose/position": [0, 0, 0.1],
            },
            last=0,
        )


def test_smoke_that_a_plate_stirs_in_gusts_is_kept(tmp_path: Path) -> None:
    """Seven frames of a plate that comes down at half a metre per second: soot is kept to rounding, and gas moves down before it."""
    spec = spec_of(stirred_spec(frames=LAST + 1), SMOKE_PROMPT)
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    cache = run_frames(spec, built, tmp_path, frames=LAST + 1)["air"]
    start, end = cache.read(0), cache.read(LAST)
    assert balance(end, "soot", "soot_mass") < 1e-6
    assert (1.0 - start["gas_room"])[:, :, 12:].sum() > 10.0 > (1.0 - end["gas_room"])[:, :, 12:].sum()
    assert end["gas_velocity"][9, 8, 8, 2] < -0.1
    assert float(end["record/divergence"]) < 1e-5
