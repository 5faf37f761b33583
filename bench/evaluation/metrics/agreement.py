"""The server's verdict beside a judge's, beat by beat: functions over plain data.

The server measures beats of the specification on the recorded motion; a judge sees beats of the prompt in pictures. Which beats of the
specification stand for which of the prompt is told by whoever knows (`pairs`): nothing here guesses by words.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

__all__ = ["Agreement", "BeatVerdicts", "compare_beats"]

Truth = Literal["happened", "did_not"]


@dataclass(frozen=True)
class BeatVerdicts:
    """Both verdicts on one beat of the prompt."""

    beat: str
    server: str
    """`pass`, `fail`, `unverified`, or `unmatched` where no beat of the specification stands for it."""
    judge: float | None
    """Completion 0, 0.5 or 1; None where the judge gave no score."""
    outcome: Literal["agree", "disputed", "undecided"]
    right: Literal["server", "judge", "unknown"] | None
    """The side that was right on a disputed one, as far as anyone ruled."""


@dataclass(frozen=True)
class Agreement:
    """Both verdicts over all beats."""

    beats: tuple[BeatVerdicts, ...]

    @property
    def disputed(self) -> tuple[BeatVerdicts, ...]:
        """Beats of which one says that they happened and the other that they did not."""
        return tuple(b for b in self.beats if b.outcome == "disputed")

    @property
    def share(self) -> float | None:
        """Share of agreement among the beats that both decide; None where there are none."""
        decided = [b for b in self.beats if b.outcome != "undecided"]
        return sum(b.outcome == "agree" for b in decided) / len(decided) if decided else None

    @property
    def kappa(self) -> float | None:
        """Cohen's kappa over the same beats (Educ. Psychol. Meas. 20 (1960) 37); None where one side says the same of all of them."""
        decided = [(b.server == "pass", b.judge == 1.0) for b in self.beats if b.outcome != "undecided"]
        if not decided:
            return None
        yes, no = (sum(s for s, _ in decided) / len(decided), sum(j for _, j in decided) / len(decided))
        chance = yes * no + (1.0 - yes) * (1.0 - no)
        return None if yes in (0.0, 1.0) or no in (0.0, 1.0) else ((self.share or 0.0) - chance) / (1.0 - chance)

    def as_json(self) -> dict[str, Any]:
        """Plain data for logs and reports."""
        right = Counter(b.right for b in self.disputed)
        return {
            "beats": [asdict(b) for b in self.beats],
            "agreement": self.share,
            "kappa": self.kappa,
            "disputed": [b.beat for b in self.disputed],
            "server_right": right["server"],
            "judge_right": right["judge"],
            "open": right["unknown"],
        }


def compare_beats(
    beats: Sequence[str],
    server: Mapping[str, str],
    judge: Mapping[str, float | None],
    *,
    pairs: Mapping[str, Sequence[str]],
    ruled: Mapping[str, Truth] | None = None,
) -> Agreement:
    """Compare verdicts on the beats of one prompt.

    Args:
        beats: ids of the prompt's beats, in order.
        server: status of the row of each beat of the specification.
        judge: completion of each beat of the prompt.
        pairs: beats of the specification that stand for each beat of the prompt; it happened where all of them pass.
        ruled: of disputed beats what a person, or a measurement of its own, found.
    """
    return Agreement(tuple(_compared(b, _status(server, pairs.get(b, ())), judge.get(b), (ruled or {}).get(b)) for b in beats))


def _status(server: Mapping[str, str], names: Sequence[str]) -> str:
    found = [server.get(name, "unverified") for name in names]
    if not found:
        return "unmatched"
    return "fail" if "fail" in found else "pass" if set(found) == {"pass"} else "unverified"


def _compared(beat: str, server: str, judge: float | None, truth: Truth | None) -> BeatVerdicts:
    if server not in ("pass", "fail") or judge not in (0.0, 1.0):
        return BeatVerdicts(beat, server, judge, "undecided", None)
    if (server == "pass") == (judge == 1.0):
        return BeatVerdicts(beat, server, judge, "agree", None)
    if truth is None:
        return BeatVerdicts(beat, server, judge, "disputed", "unknown")
    return BeatVerdicts(beat, server, judge, "disputed", "server" if (server == "pass") == (truth == "happened") else "judge")
