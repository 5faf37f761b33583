"""Threads that share calls: each call is made once, errors arrive at the caller, several callers do not hinder each other."""

from concurrent.futures import ThreadPoolExecutor
from functools import partial

import pytest
from worldagent.simulation.team import Team, team


@pytest.mark.parametrize("helpers", [0, 1, 3])
@pytest.mark.parametrize("count", [0, 1, 2, 50])
def test_every_call_is_made_once(helpers: int, count: int) -> None:
    made: list[int] = []
    Team(helpers)([partial(made.append, k) for k in range(count)])
    assert sorted(made) == list(range(count))


def test_an_error_of_any_call_arrives_and_the_team_goes_on() -> None:
    made: list[int] = []
    here = Team(2)
    for broken in range(8):
        calls = [partial(made.append, k) for k in range(8)]
        calls[broken] = partial(int, "seven")  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="seven"):
            here(calls)
    made.clear()
    here([partial(made.append, k) for k in range(8)])
    assert sorted(made) == list(range(8))


def test_callers_in_several_threads_share_one_team() -> None:
    here = team(1)
    made: list[list[int]] = [[], [], []]

    def work(mine: list[int]) -> None:
        for k in range(200):
            here([partial(mine.append, 2 * k), partial(mine.append, 2 * k + 1)])
            assert len(mine) == 2 * k + 2, "all calls have ended when the caller goes on"

    with ThreadPoolExecutor(3) as threads:
        list(threads.map(work, made))
    assert all(sorted(mine) == list(range(400)) for mine in made)
    assert team(1) is here
