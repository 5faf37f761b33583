"""When and where the flames of a gas burnt, and what they ended with: told where a beat asks for flames that are not there (R100)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...predicates.outcome import vector
from .bounds import FIRE_OUT, FIRE_POWER
from .fire_of import Fire, SolidFire

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ...predicates.outcome import Outcome

__all__ = ["with_life"]

FADING = 0.3
"""[s] Own choice: flames that end so soon after a spark did are told to have ended with it: what it lit burns on for about that long."""


class Life(NamedTuple):
    """Flames of a gas over a run."""

    first: int
    """First frame of more than `FIRE_OUT` of their greatest power."""
    last: int
    """Last such frame."""
    most: float
    """Greatest power [W]."""
    brightest: int
    """Its frame."""
    at: tuple[float, float, float]
    """Their middle there [m]."""
    left: float
    """Power at the last frame of the run [W]."""
    spark: str | None
    """Ignition with which they ended; None where they did not end, or not with one."""

    def told(self, frames: int) -> str:
        """One sentence about them, in a run of so many frames."""
        until = "on" if self.last == frames - 1 else f"to {self.last}"
        text = f"its flames burn from frame {self.first} {until}, {self.most:.3g} W at most, about {vector(np.array(self.at))} m then"
        if self.left > 0.0:
            text += f"; {self.left:.3g} W at frame {frames - 1}"
        return text + (f"; they ended with ignition {self.spark}" if self.spark else "")


def with_life(outcome: Outcome, candidate: Candidate, entity: str, fire: Fire) -> Outcome:
    """An outcome that is missed, with when and where the flames of a gas burnt, in words and as `details["flames"]`."""
    if outcome.status != "fail" or isinstance(fire, SolidFire):
        return outcome
    found = _life(candidate, entity, fire)
    if found is None:
        text, known = f"{entity} has no flames in the whole run", {"burnt": False}
    else:
        text, known = found.told(fire.box.frames), {"burnt": True, **found._asdict()}
    return replace(outcome, explanation=f"{outcome.explanation}; {text}", details={**outcome.details, "flames": known})


def _life(candidate: Candidate, entity: str, fire: Fire) -> Life | None:
    """When and where flames burnt; None where they never did."""
    box = fire.box
    power = fire.power(0, box.frames - 1)
    most = float(power.max(initial=0.0))
    if most <= FIRE_OUT * FIRE_POWER:
        return None
    lit = np.flatnonzero(power > FIRE_OUT * most)
    first, last, brightest = int(lit[0]), int(lit[-1]), int(np.argmax(power))
    frame = box.read(brightest)
    assert frame.fire is not None
    weight = (frame.fire.released * frame.room).astype(np.float64)
    middle = (frame.centers.reshape(-1, 3) * weight.reshape(-1, 1)).sum(axis=0) / weight.sum()
    ended = last * box.duration if last < box.frames - 1 else None
    sparks = [
        name
        for name, driver in candidate.spec.simulation.drivers.items()
        if driver.kind == "ignition" and driver.entity == entity and driver.end is not None
        and ended is not None and -box.duration <= ended - driver.end <= FADING
    ]  # fmt: skip
    x, y, z = (round(float(c), 4) for c in middle)
    return Life(first, last, most, brightest, (x, y, z), float(power[-1]), sparks[0] if sparks else None)
