"""Values that are kept of those used lately."""

from collections.abc import Callable
from functools import partial

from worldagent.geometry.recent import Recent


def _made(value: str, made: list[str]) -> Callable[[], str]:
    def make() -> str:
        made.append(value)
        return value

    return make


def test_each_value_is_weighed_once_however_many_are_kept_and_asked_for() -> None:
    """Choice: counting all that is kept anew for every value took longer than to build a flat."""
    weighed: list[str] = []

    def weigh(value: str) -> float:
        weighed.append(value)
        return 1.0

    recent: Recent[str] = Recent(1e6)
    names = [str(k) for k in range(300)]
    for name in [*names, *names]:
        assert recent.of(name, partial(str, name), weigh) == name
    assert sorted(weighed) == sorted(names)
    assert len(recent) == 300
    assert recent.weight == 300.0


def test_the_ones_used_longest_ago_give_way_to_others() -> None:
    """Choice: of what is too much the one asked for last stays."""
    made: list[str] = []
    recent: Recent[str] = Recent(3.0)
    for name in ("a", "b", "c", "a", "d"):
        recent.of(name, _made(name, made), lambda value: 1.0)
    assert made == ["a", "b", "c", "d"]
    assert len(recent) == 3
    for name in ("a", "c", "d", "b"):  # b was used longest ago as d came
        recent.of(name, _made(name, made), lambda value: 1.0)
    assert made == ["a", "b", "c", "d", "b"]


def test_one_heavier_than_all_that_is_kept_is_given_and_not_kept() -> None:
    """Choice: it would drive out everything else and be dropped itself."""
    made: list[str] = []
    recent: Recent[str] = Recent(3.0)
    weights = {"a": 1.0, "heavy": 4.0}
    for name in ("a", "heavy", "a", "heavy"):
        assert recent.of(name, _made(name, made), weights.__getitem__) == name
    assert made == ["a", "heavy", "heavy"]
    assert recent.weight == 1.0
