"""Numbers of a condition in words."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.verifiers.predicates.conditions import Condition, in_digits


@pytest.mark.parametrize(
    ("value", "bound", "told"),
    [
        (0.5, 0.99, ("0.5", "0.99")),
        (0.98962, 0.99, ("0.9896", "0.99")),
        (0.98999999, 0.99, ("0.98999999", "0.99")),
        (0.99, 0.99, ("0.99", "0.99")),
        (1231.0, 1232.0, ("1231", "1232")),
        (float("nan"), 0.99, ("nan", "0.99")),
    ],
)
def test_numbers_that_differ_are_told_apart(value: float, bound: float, told: tuple[str, str]) -> None:
    assert in_digits(value, bound) == told


def test_what_misses_its_bound_by_little_does_not_seem_to_meet_it() -> None:
    condition = Condition("share of its power that is gone", np.array([0.98962]), 0.99)
    assert condition.text(0) == "share of its power that is gone is 0.9896, at least 0.99 is asked"
