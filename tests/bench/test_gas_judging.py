"""Figures of the benchmark of judging gas worlds."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.bench import gas_judging
from worldagent.bench.gas_judging import SMALL, Judged, chosen_worlds, run
from worldagent.worlds.errors import InputError


def test_worlds_are_named_or_the_small_ones_and_an_unknown_one_is_refused_with_all_names() -> None:
    assert tuple(chosen_worlds(())) == SMALL
    assert tuple(chosen_worlds(("lava", "bowl"))) == ("lava", "bowl")
    assert set(SMALL) < set(chosen_worlds(("all",)))
    with pytest.raises(InputError, match=r"no recorded gas world 'volcano'; name some of .*kettle.*, or all"):
        chosen_worlds(("volcano",))


def test_the_ratio_is_that_of_judging_the_bake_and_the_worst_world_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    times = {"bowl": 10.0, "candle": 40.0, "kettle": 20.0}
    made = iter(times.values())

    def judged(spec: Any, root: Any) -> Judged:
        return Judged(next(made), {"support": 9.0}, {"opened": 0.5, "numerical": 3.5}, ("shots:seen",))

    monkeypatch.setattr(gas_judging, "judged_world", judged)
    found = run(checks=tuple(times))
    assert (found["median_ratio"], found["worst_ratio"], found["worst_world"]) == (0.2, 0.4, "bowl")
    assert found["worlds"]["candle"]["ratio"] == 0.1
    assert found["worlds"]["candle"]["full_checks_cpu_s"] == {"opened": 0.5, "numerical": 3.5}
    assert found["worlds"]["candle"]["open_rows"] == ["shots:seen"]
