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


TWO_PHASES = [(10.0, 8), (0.4, 50)]
"""Eighty frames in 8 s, then checks for 50 s."""


def pace_of(rates):
    estimate, now, done = Estimate(), 0.0, 0.0
    for rate, seconds in rates:
        for _ in range(round(seconds / 0.5)):
            estimate.add(now, done, 100.0)
            now, done = now + 0.5, min(100.0, done + rate * 0.5)
    return estimate.pace(now)


def told_by(pace, rates, *, step=0.5):
    estimate, now, done, seen = Estimate(pace), 0.0, 0.0, []
    for rate, seconds in rates:
        for _ in range(round(seconds / step)):
            estimate.add(now, done, 100.0)
            seen.append((now, estimate.left(now)))
            now, done = now + step, min(100.0, done + rate * step)
    return seen


def test_a_pace_says_when_which_part_was_done():
    pace = pace_of(TWO_PHASES)
    assert pace[0] == 0
    assert pace[8] == pytest.approx(4.0, abs=0.5)
    assert pace[16] == pytest.approx(8.0, abs=0.6)
    assert pace[-1] == pytest.approx(58.0, abs=0.6)
    assert pace == sorted(pace)


def test_the_pace_of_an_earlier_run_tells_of_phases_to_come():
    """By the rate alone the frames promise an end after ten seconds."""
    by_rate = dict(told_by(None, TWO_PHASES))
    assert by_rate[6.0] == pytest.approx(4.0, abs=0.5)
    by_pace = dict(told_by(pace_of(TWO_PHASES), TWO_PHASES))
    for now, left in by_pace.items():
        assert left == pytest.approx(58.0 - now, abs=1.5)


def test_a_run_that_is_slower_than_the_earlier_one_is_told_so():
    slow = [(rate / 2, 2 * seconds) for rate, seconds in TWO_PHASES]
    seen = dict(told_by(pace_of(TWO_PHASES), slow))
    assert seen[0.0] == pytest.approx(58.0, abs=1)
    assert seen[60.0] == pytest.approx(56.0, rel=0.2)
    assert seen[100.0] == pytest.approx(16.0, rel=0.2)


def test_silence_within_the_step_of_an_earlier_run_counts_down_and_beyond_it_grows():
    pace = [0.0, *(10.0 + k for k in range(20))]  # the first step took ten seconds
    estimate = Estimate(pace)
    estimate.add(0.0, 0.0, 20.0)
    told = [estimate.left(float(now)) for now in range(0, 100, 5)]
    assert told[0] == pytest.approx(29.0)
    assert told[1] == pytest.approx(24.0)
    known = [t for t in told if t is not None]
    assert max(known) > 45
    assert told[-1] is None  # so slow that the earlier run is no measure any more


def test_a_run_that_goes_on_midway_uses_the_rest_of_the_pace_and_leaves_none():
    pace = pace_of(TWO_PHASES)
    estimate = Estimate(pace)
    for k in range(21):
        estimate.add(k * 0.5, 80.0 + 0.2 * k, 100.0)
    assert estimate.left(10.0) == pytest.approx(40.0, rel=0.1)
    assert estimate.pace(10.0) is None


def test_a_pace_of_another_form_is_not_used():
    for pace in ([], [1.0], [0.0] * 21):
        estimate = Estimate(pace)
        estimate.add(0.0, 0.0, 10.0)
        estimate.add(5.0, 5.0, 10.0)
        assert estimate.left(5.0) == pytest.approx(5.0)


def stretched(parts, *, compile_s=0.0, last=1.0):
    """A run of stretches (steps, seconds a step), the first step of each longer: (time, Estimate) after every report."""
    estimate, now = Estimate(), 0.0
    for rank, (steps, seconds) in enumerate(parts):
        first, ends = rank * last / len(parts), (rank + 1) * last / len(parts)
        for step in range(steps + 1):
            estimate.add(now, first + (ends - first) * step / steps, 1.0, ends)
            yield now, rank, step, estimate
            now += seconds + (compile_s if step == 0 else 0.0) if step < steps else 0.0


def test_a_stretch_tells_only_of_itself_and_the_last_one_of_the_whole():
    """The pace of what goes on now tells nothing of what comes at another pace."""
    judged = 0
    for now, rank, step, estimate in stretched([(20, 0.5), (20, 3.0)]):
        judged += 1
        if rank == 0:
            assert estimate.left(now) is None
            if step >= 5:
                assert estimate.left_of_stretch(now) == pytest.approx(0.5 * (20 - step), abs=1e-6)
        elif step >= 2:
            assert estimate.left(now) == pytest.approx(3.0 * (20 - step), abs=1e-6)
    assert judged == 2 * 21


def test_the_first_step_of_a_stretch_is_no_measure():
    judged = 0
    for now, _, step, estimate in stretched([(30, 1.0)], compile_s=60.0):
        judged += 1
        if step < 2:
            assert estimate.left(now) is None
        else:
            assert estimate.left(now) == pytest.approx(30.0 - step, abs=1e-6)
    assert judged == 31
