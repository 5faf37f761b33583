"""Every generator over random parameters: closed, apart, in one piece, of the right mass, and standing."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.construction.assets.registry import GENERATORS
from worldagent.testing.assets import faults, sampled
from worldagent.worlds.errors import InputError

REFUSED = 0.1
"""Share of random parameters that a generator may refuse, since they leave no room for a part."""


def _trials(name: str, count: int, start: int = 0) -> None:
    generator, refused = GENERATORS[name], 0
    for seed in range(start, start + count):
        parameters = sampled(generator, np.random.default_rng(seed))
        try:
            made = generator.make(parameters, seed)
        except InputError:
            refused += 1
            continue
        stands = generator.stands and bool(parameters.get("posts", True))  # without its posts the floor above carries a flight
        assert faults(made, stands=stands) == [], (parameters, seed)
    assert refused <= REFUSED * count, f"{refused} of {count} refused"


@pytest.mark.parametrize("name", GENERATORS)
def test_a_generator_makes_sound_things(name: str) -> None:
    assert faults(GENERATORS[name].make({}, 0), stands=GENERATORS[name].stands) == []
    _trials(name, 3)


@pytest.mark.slow
@pytest.mark.parametrize("name", GENERATORS)
def test_two_hundred_random_parameter_sets_of_a_generator_are_sound(name: str) -> None:
    _trials(name, 200)
