"""The demo's agent finds seeded flaws from the rows alone and gets its world accepted."""

from __future__ import annotations

import argparse
import datetime
import random
from pathlib import Path

import pytest
from worldagent.examples.domino_run import run
from worldagent.examples.domino_world import domino_spec
from worldagent.examples.flaws import FLAWS, plant

SEEDS = range(1, 21)
TODAY = SEEDS[datetime.datetime.now(tz=datetime.UTC).toordinal() % len(SEEDS)]
"""One seed a day in the fast suite, all of them in the slow one."""


def _run(seed: int, folder: Path) -> None:
    options = argparse.Namespace(seed=seed, flaws=3, out=str(folder), final=False, no_render=True)
    found = run(options)
    assert found["accepted"], found["repairs"]
    assert len(found["planted"]) == 3
    assert any(not repair["refused"] for repair in found["repairs"])


def test_todays_seed_is_repaired_and_accepted(tmp_path: Path) -> None:
    _run(TODAY, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_every_seed_is_repaired_and_accepted(seed: int, tmp_path: Path) -> None:
    _run(seed, tmp_path)


def test_there_are_at_least_twelve_kinds_of_flaws_and_each_changes_the_specification() -> None:
    assert len(FLAWS) >= 12
    for name, flaw in FLAWS.items():
        spec = domino_spec()
        flaw(spec, random.Random(name))
        assert spec != domino_spec(), name


def test_a_seed_always_plants_the_same_flaws() -> None:
    first, second = domino_spec(), domino_spec()
    assert plant(first, 5) == plant(second, 5)
    assert first == second
