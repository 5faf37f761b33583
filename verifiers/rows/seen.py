"""Rows pass over no frames that are not there: they may still fail."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...worlds.probe_length import probe_frames

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row

__all__ = ["only_seen", "unmended_till_seen"]


def only_seen(candidate: Candidate, found: Row, needed: tuple[int, int] | None = None) -> Row:
    """The row, `unverified` where it passes over frames that are not there.

    A failure stays one. Rows about the shot plan alone (their artifact is `world.json`) have looked at all of it.

    Args:
        candidate: what was inspected.
        found: the verdict about it.
        needed: frames over which the requirement holds; default those of the row.
    """
    first, last = needed or found.frames or (0, -1)
    planned = found.check == "shots" and found.artifact == "world.json"
    if found.status != "pass" or last <= candidate.last_frame or planned:
        return found
    text = f"frames {first}..{candidate.last_frame} of {first}..{last} seen: {found.evidence.get('explanation', found.predicate)}"
    evidence = {**found.evidence, "explanation": text, "seen": [first, candidate.last_frame]}
    return found.model_copy(update={"status": "unverified", "frames": (first, last), "evidence": evidence})


def unmended_till_seen(candidate: Candidate, found: Row) -> Row:
    """The row without corrections where it only waits for frames that nobody simulated yet: nothing of it is to be mended.

    A whole probe leaves them to the bake; one that was stopped is to be probed to its end first.
    """
    if (
        candidate.stage != "probe"
        or found.status != "unverified"
        or found.frames is None
        or found.frames[1] <= candidate.last_frame
    ):
        return found
    needed = probe_frames(candidate.spec) - 1
    stopped = candidate.last_frame < needed
    told = {
        "symptom": f"the probe ended before frame {needed}"
        if stopped
        else "it waits for frames that the probe leaves to the bake",
        "cheapest_probe": [{"tool": "probe_sim" if stopped else "bake_sim", "look_at": found.id}],
    }
    return found.model_copy(update={"corrections": (), "evidence": {**found.evidence, "diagnosis": told}})
