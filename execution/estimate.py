"""How long a job will still take, from the rate of progress measured so far."""

from __future__ import annotations

from bisect import bisect_right

__all__ = ["Estimate"]


class Estimate:
    """Time left [s]. Steady: it counts down, and rises only when the work has clearly become slower.

    The rate is that of the later half of the run, at least WINDOW_S: phases differ in pace. The time before the first
    report, when engines load, does not count.
    """

    WINDOW_S = 5.0
    EARLIEST_S = 2.0
    """No estimate before so long after the first report [s]."""
    SLOWER = 1.2
    """By what factor, or by how many seconds (SLACK_S), the time left must grow until it is told."""
    SLACK_S = 3.0
    SAMPLES_MAX = 128

    def __init__(self) -> None:
        self._times: list[float] = []
        self._done: list[float] = []
        self._total: float | None = None
        self._end: float | None = None

    def add(self, now: float, done: float, total: float | None) -> None:
        """Take a report; `now` [s] on any clock that does not fall."""
        self._total = total
        if self._done and done <= self._done[-1]:
            return
        self._times.append(now)
        self._done.append(done)
        if len(self._times) > self.SAMPLES_MAX:
            del self._times[1:-1:2], self._done[1:-1:2]

    def left(self, now: float) -> float | None:
        """Time left at `now` [s]; None where it cannot be told."""
        if self._total is None or not self._times or now - self._times[0] < self.EARLIEST_S:
            return None
        done = self._done[-1]
        since = max(self._times[0], min(now - self.WINDOW_S, (self._times[0] + now) / 2))
        first = max(0, bisect_right(self._times, since) - 1)
        if done <= self._done[first]:  # nothing moved in the window: the pace of the whole run
            first = 0
        gained = done - self._done[first]
        if gained <= 0 or done > self._total:
            return None
        end = now + (self._total - done) * (now - self._times[first]) / gained
        if (
            self._end is None
            or end < self._end
            or end - now > max(self.SLOWER * (self._end - now), self._end - now + self.SLACK_S)
        ):
            self._end = end
        return max(0.0, self._end - now)
