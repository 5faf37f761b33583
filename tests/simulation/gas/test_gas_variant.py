"""A gas world that goes on without its emission: what counterfactuals of gas read."""

from __future__ import annotations

import numpy as np
from worldagent.simulation.protocol import Intervention
from worldagent.simulation.variants import run_variant
from worldagent.testing.defects._gas_scenes import SOLVER, scene

FROM, TO = 0, 4


def test_without_its_emission_a_room_stays_clear_and_with_all_its_drivers_it_goes_on_as_recorded() -> None:
    base = scene("room")
    for without in (frozenset({"fire"}), frozenset[str]()):
        variant = run_variant(base, Intervention(without=without, held=frozenset({"plate"})), start=FROM, end=TO)
        soot = [variant.caches[SOLVER].read(k, ("gas_soot",))["gas_soot"] for k in range(FROM, TO + 1)]
        recorded = base.caches[SOLVER].read(TO, ("gas_soot",))["gas_soot"]
        assert recorded.max() > 0.0
        if without:
            assert soot[-1].max() == 0.0
        else:
            assert np.array_equal(soot[-1], recorded)
