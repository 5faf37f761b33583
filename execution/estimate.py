"""Estimate of the time that a job will still take: from the progress measured so far, and from the pace of an earlier run like it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

__all__ = ["Estimate"]


class Estimate:
    """Time left [s]. Steady: it counts down, and rises only when the work has clearly become slower.

    Phases differ in pace: frames may be quick and checks slow. The pace of an earlier run says how; how much faster or
    slower this one is, is measured, and one that goes on quite otherwise tells nothing. Without one the rate is that of the later
    half of the run, at least WINDOW_S. Where reports say that the present pace ends before the work does, the rate tells of that
    stretch alone, and of the whole in the last one. The time before the first report, when engines load, does not count, nor the
    first step of a stretch, when its kernels are compiled.
    """

    WINDOW_S = 5.0
    EARLIEST_S = 2.0
    """No estimate before so long after the first report [s]."""
    SLOWER = 1.2
    """By what factor, or by how many seconds (SLACK_S), the time left must grow until it is told."""
    SLACK_S = 3.0
    SAMPLES_MAX = 128
    STEPS = 20
    """A pace holds the times at so many equal steps of the work."""
    MIDWAY = 0.1
    """A run whose first report lies beyond this part of the work began midway."""
    TRUST = 0.1
    """The part of an earlier run as which its total counts against what is measured now."""
    DOUBT = 3.0
    """A run that takes so many times longer or shorter than the earlier one is not like it."""

    def __init__(self, pace: Sequence[float] | None = None) -> None:
        self._times: list[float] = []
        self._done: list[float] = []
        self._stretch: list[tuple[float, float]] = []
        self._ends: float | None = None
        self._total: float | None = None
        self._end: float | None = None
        self._pace = list(pace) if pace is not None and len(pace) == self.STEPS + 1 and pace[-1] > 0 else None

    def add(self, now: float, done: float, total: float | None, ends: float | None = None) -> None:
        """Take a report; `now` [s] on any clock that does not fall, `ends`: where the stretch of one pace ends that it is of."""
        self._total = total
        if ends != self._ends:
            self._ends, self._stretch = ends, []
        if not self._stretch or done > self._stretch[-1][1]:
            self._stretch.append((now, done))
            if len(self._stretch) > self.SAMPLES_MAX:
                del self._stretch[2:-1:2]
        if self._done and done <= self._done[-1]:
            return
        self._times.append(now)
        self._done.append(done)
        if len(self._times) > self.SAMPLES_MAX:
            del self._times[1:-1:2], self._done[1:-1:2]

    def left(self, now: float) -> float | None:
        """Time left at `now` [s]; None where it cannot be told."""
        if not self._total or not self._times or self._done[-1] > self._total:
            return None
        left = None if self._pace is None else self._by_pace(now, self._total)
        if left is None and (self._ends is None or self._ends >= self._total * (1.0 - 1e-9)):
            left = self.left_of_stretch(now)
        if left is None:
            self._end = None
            return None
        told = None if self._end is None else self._end - now
        if told is None or left < told or left > max(self.SLOWER * told, told + self.SLACK_S):
            self._end = now + left
            told = left
        return max(0.0, told)

    def left_of_stretch(self, now: float) -> float | None:
        """Time until the end of what goes on at the present pace [s], by its own rate; None where it was not measured yet."""
        # The step that compiles kernels is no measure of those that follow.
        samples = self._stretch if self._ends is None else self._stretch[1:]
        if len(samples) < 2 or now - self._stretch[0][0] < self.EARLIEST_S:
            return None
        ends = self._total if self._ends is None else self._ends
        if ends is None:
            return None
        times, done = [t for t, _ in samples], samples[-1][1]
        since = max(times[0], min(now - self.WINDOW_S, (times[0] + now) / 2))
        first = max(0, bisect_right(times, since) - 1)
        if done <= samples[first][1]:  # nothing moved in the window: the pace of the whole stretch
            first = 0
        gained = done - samples[first][1]
        return max(0.0, (ends - done) * (now - times[first]) / gained) if gained > 0 else None

    def _by_pace(self, now: float, total: float) -> float | None:
        assert self._pace is not None
        whole, trust = self._pace[-1], self.TRUST * self._pace[-1]
        first, done, count = self._done[0], self._done[-1], len(self._done) - 1
        step = (done - first) / count if count else total / self.STEPS
        then_first, then, then_next = (_between(self._pace, d / total) for d in (first, done, done + step))
        start, last = self._times[0], self._times[-1]
        at_last_report = (last - start + trust) / (then - then_first + trust)
        in_silence = (now - start + trust) / (then_next - then_first + trust)
        if max(at_last_report, in_silence) > self.DOUBT or max(at_last_report, in_silence) < 1.0 / self.DOUBT:
            return None
        return max(at_last_report * (whole - then) - (now - last), in_silence * (whole - then_next))

    def pace(self, now: float) -> list[float] | None:
        """Times since the first report [s] at equal steps of work that is done `now`; None of a run that began midway."""
        if not self._total or len(self._times) < 3 or self._done[0] > self.MIDWAY * self._total:
            return None
        start, found = self._times[0], []
        points = [*zip(self._done, self._times, strict=True), (max(self._total, self._done[-1]), now)]
        for step in range(self.STEPS + 1):
            wanted = self._total * step / self.STEPS
            after = next(k for k, (done, _) in enumerate(points) if done >= wanted or k == len(points) - 1)
            done, time = points[after]
            before_done, before = points[max(0, after - 1)]
            part = (wanted - before_done) / (done - before_done) if done > before_done else 1.0
            found.append(round(before + max(0.0, part) * (time - before) - start, 3))
        return [*found[:-1], round(now - start, 3)]


def _between(pace: Sequence[float], part: float) -> float:
    """Time at a part of the work in [0, 1], interpolated."""
    place = min(max(part, 0.0), 1.0) * (len(pace) - 1)
    low = min(int(place), len(pace) - 2)
    return pace[low] + (place - low) * (pace[low + 1] - pace[low])
