"""Intervals and the paired bootstrap against cases with a known answer."""

from __future__ import annotations

import pytest
from scipy.stats import binom, ttest_1samp
from worldagent.bench.evaluation.statistics import paired_bootstrap, repeat_interval, share_interval


def test_the_bootstrap_of_yes_and_no_is_the_binomial_distribution() -> None:
    """Half of ten prompts gain one: the mean difference of a resample is a binomial share, whose quantiles are known."""
    first = {f"p{k}": 3.0 for k in range(10)}
    second = {f"p{k}": 3.0 + k % 2 for k in range(10)}
    found = paired_bootstrap(first, second, seed=5)
    assert (found.first, found.second, found.difference, found.prompts) == (3.0, 3.5, 0.5, 10)
    assert (found.low, found.high) == pytest.approx(tuple(binom.ppf([0.025, 0.975], 10, 0.5) / 10))
    assert found.same_sign == pytest.approx(1.0 - 0.5**10, abs=1e-3)
    assert found.moved


def test_pairs_are_drawn_together_and_the_order_of_prompts_does_not_matter() -> None:
    """Prompts differ a hundredfold, their differences not at all: the interval is a point."""
    first = {f"p{k}": 100.0 * k for k in range(8)}
    found = paired_bootstrap(first, {p: v - 2.0 for p, v in reversed(first.items())}, seed=1)
    assert (found.difference, found.low, found.high, found.same_sign) == (-2.0, -2.0, -2.0, 1.0)
    assert found.moved
    few = dict(list(first.items())[:5])
    assert not paired_bootstrap(few, {p: v - 2.0 for p, v in few.items()}).moved, (
        "five that go one way do so by chance in one of sixteen"
    )


def test_equal_seeds_give_equal_draws_and_no_difference_has_no_sign() -> None:
    first, second = {"a": 1.0, "b": 2.0, "c": 5.0}, {"a": 2.0, "b": 1.0, "c": 5.0}
    assert paired_bootstrap(first, second, seed=3) == paired_bootstrap(first, second, seed=3)
    found = paired_bootstrap(first, second, seed=3)
    assert (found.difference, found.same_sign, found.moved) == (0.0, None, False)
    with pytest.raises(ValueError, match="the same prompts"):
        paired_bootstrap(first, {"a": 1.0})


def test_the_interval_of_one_groups_repeats_is_students() -> None:
    values = [0.2, 0.5, 0.4, 0.9]
    known = ttest_1samp(values, 0.0).confidence_interval(0.95)
    found = repeat_interval([values])
    assert found is not None
    assert (found.low, found.high) == pytest.approx((known.low, known.high))


def test_an_average_over_prompts_is_surer_than_each_of_them_and_needs_two_repeats_of_all() -> None:
    values = [0.2, 0.5, 0.4, 0.9]
    one, four = repeat_interval([values]), repeat_interval([[v + k for v in values] for k in range(4)])
    assert one is not None
    assert four is not None
    assert (four.high - four.low) < 0.5 * (one.high - one.low)
    assert repeat_interval([values, [1.0]]) is None
    assert repeat_interval([]) is None


def test_a_share_of_all_is_no_certainty() -> None:
    """Wilson's bounds of 10 in 10 are 1 / (1 + z^2 / 10) and 1; those of 5 in 10 lie evenly about a half."""
    found = share_interval(10, 10)
    assert (found.low, found.high) == pytest.approx((0.7225, 1.0), abs=1e-4)
    half = share_interval(5, 10)
    assert (half.low, half.high) == pytest.approx((0.2366, 0.7634), abs=1e-4)
