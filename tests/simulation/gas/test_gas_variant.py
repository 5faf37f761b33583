"""A gas world that goes on under an intervention: what counterfactuals of gas read."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.simulation.protocol import Intervention
from worldagent.simulation.variants import run_variant
from worldagent.testing.defects._gas_scenes import SOLVER, scene

LAST = 4


@pytest.mark.parametrize("without", [frozenset({"fire"}), frozenset[str]()])
def test_a_room_goes_on_as_recorded_or_clear_without_its_emission(without: frozenset[str]) -> None:
    base = scene("room")
    recorded = base.caches[SOLVER].read(LAST, ("gas_soot",))["gas_soot"]
    assert recorded.max() > 0.0
    variant = run_variant(base, Intervention(without=without, held=frozenset({"plate"})), start=0, end=LAST)
    soot = variant.caches[SOLVER].read(LAST, ("gas_soot",))["gas_soot"]
    assert np.array_equal(soot, np.zeros_like(recorded) if without else recorded)
