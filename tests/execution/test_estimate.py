"""The time left, estimated from measured progress."""

import pytest
from worldagent.execution.estimate import Estimate


def run(rates, *, total=100.0, step=0.5):
    """Time left after every report of a run whose rate [1/s] changes: (time, done, left)."""
    estimate, now, done, seen = Estimate(), 0.0, 0.0, []
    for rate, seconds in rates:
        for _ in range(round(seconds / step)):
            estimate.add(now, done, total)
            seen.append((now, done, estimate.left(now)))
            now, done = now + step, done + rate * step
    return seen


def test_a_steady_pace_gives_the_true_time_and_counts_down():
    seen = run([(2.0, 50)])
    told = [(now, left) for now, _, left in seen if left is not None]
    assert told[0][0] == pytest.approx(Estimate.EARLIEST_S)
    for now, left in told:
        assert left == pytest.approx(50 - now, abs=1e-6)


def test_a_slower_phase_is_told_and_a_jitter_is_not():
    seen = run([(2.0, 25), (0.5, 100)])
    after = [left for now, _, left in seen if now >= 60]
    assert max(after) > 60  # 32 remain at 0.5 / s
    jittered = run([(2.0, 5), (1.9, 5), (2.1, 5), (1.9, 5), (2.0, 5)])
    told = [left for _, _, left in jittered if left is not None]
    assert told == sorted(told, reverse=True)


def test_a_stall_grows_the_time_left():
    estimate = Estimate()
    for k in range(11):
        estimate.add(k * 1.0, k * 1.0, 20)
    before = estimate.left(10.0)
    assert before == pytest.approx(10.0)
    assert estimate.left(60.0) > 40


def test_nothing_is_told_without_a_total_or_progress():
    estimate = Estimate()
    estimate.add(0.0, 0.0, None)
    estimate.add(9.0, 5.0, None)
    assert estimate.left(10.0) is None
    still = Estimate()
    still.add(0.0, 3.0, 10.0)
    assert still.left(20.0) is None


def test_the_work_before_a_resumption_does_not_count():
    estimate = Estimate()
    for k in range(11):
        estimate.add(k * 1.0, 500.0 + k, 520.0)
    assert estimate.left(10.0) == pytest.approx(10.0)


def test_a_long_run_keeps_few_samples():
    estimate = Estimate()
    for k in range(100_000):
        estimate.add(k * 0.25, float(k), 200_000.0)
    assert len(estimate._times) <= Estimate.SAMPLES_MAX + 1
    assert estimate.left(25_000.0) == pytest.approx(25_000.0, rel=0.01)
