"""Teeth of a pair of gears run clear of each other while both turn, and meet where only one of them does."""

from __future__ import annotations

import math

import numpy as np
import pytest
from worldagent.construction.assets.made import Made
from worldagent.construction.assets.registry import make
from worldagent.testing.assets import _at, _shared, _solids


def _met(made: Made, driver: float, driven: float) -> float:
    """Volume that both gears have in common when they are turned by two angles [rad], in m^3."""
    turned = [
        [_at(s, made.joints[name], q) for s in _solids(made.bodies[name])] for name, q in (("driver", driver), ("driven", driven))
    ]
    return _shared(*turned)


@pytest.mark.parametrize(("driver", "driven", "module"), [(2, 3, 0.016), (4, 2, 0.012), (2, 2, 0.03)])
def test_gears_turn_together_and_not_alone(driver: int, driven: int, module: float) -> None:
    made = make("gear_pair", {"eighths": driver, "eighths_driven": driven, "module": module}, 1)
    pitch = 2 * math.pi / (8 * driver)
    for turn in np.linspace(0, pitch, 7):
        assert _met(made, turn, -turn * driver / driven) == 0
    assert _met(made, pitch / 2, 0.0) > 0
