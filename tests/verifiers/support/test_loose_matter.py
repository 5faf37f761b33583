"""Water and grains that hang in the air at frame 0 are refused where no beat tells of their fall."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects import particles
from worldagent.testing.defects._loose_worlds import LOOSE_MECHANISMS
from worldagent.testing.defects.cases import Mechanism
from worldagent.verifiers.support.loose_matter import loose_rows
from worldagent.worlds.requirements import Row


def row_of(mechanism: Mechanism, magnitude: float, folder: Path, seed: int) -> Row:
    world = mechanism.build(folder, magnitude, np.random.default_rng(seed))
    (row,) = loose_rows(world.candidate)
    assert row.id == "support:matter:pool"
    return row


@pytest.mark.parametrize("mechanism", LOOSE_MECHANISMS, ids=lambda m: m.name)
@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_what_hangs_in_the_air_fails_and_what_is_held_or_told_of_passes(
    mechanism: Mechanism, share: float, tmp_path: Path
) -> None:
    magnitude = float(np.exp((1 - share) * np.log(mechanism.low) + share * np.log(mechanism.high)))
    row = row_of(mechanism, magnitude, tmp_path, seed=round(7 * share))
    assert row.status == ("fail" if mechanism.broken else "pass"), row.evidence["explanation"]
    if mechanism.broken:
        assert row.first_failing_entity == "pool"
        assert row.measured is not None
        assert row.measured > 0.01
        assert row.corrections


def test_height_and_share_are_told(tmp_path: Path) -> None:
    """Water 0.5 m above the ground: its lowest particles are half a distance higher."""
    hanging = next(m for m in LOOSE_MECHANISMS if m.name == "hanging-water")
    row = row_of(hanging, 0.5, tmp_path, seed=3)
    assert row.measured == 1.0
    assert "0.51 m from the nearest solid" in row.evidence["explanation"]


def raised(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    data["particle/position"][:, 2] += np.float32(magnitude)


def dropped(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    for name in [k for k in data if k.startswith("particle/")]:
        data[name] = data[name][:0]


@pytest.mark.parametrize(("height", "status"), [(0.0, "pass"), (0.01, "pass"), (0.6, "fail")])
def test_a_bed_of_grains_lies_in_its_tray(height: float, status: str, tmp_path: Path) -> None:
    candidate = particles._edited(tmp_path, raised, height, np.random.default_rng(1))
    (row,) = loose_rows(candidate)
    assert (row.id, row.status) == ("support:matter:sand", status), row.evidence["explanation"]


def test_what_is_not_there_at_frame_0_is_not_asked(tmp_path: Path) -> None:
    (row,) = loose_rows(particles._edited(tmp_path, dropped, 0.0, np.random.default_rng(1)))
    assert row.status == "not_applicable"
