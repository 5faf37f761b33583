"""Smoke that was seen and is seen no more: lost by the solver, thinned out, gone from the box, or out of the picture (R71).

Whether smoke is seen follows from its optical depth. What was let out and is neither in the box nor told to have left it, the solver lost. What
is in the box and too thin to be seen has faded. What is in the box and outside every picture that is taken at the frame, the camera cropped.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ....geometry.camera import camera_at
from ....worlds.errors import InputError
from ...rows.corrections import correction
from ...rows.findings import Finding
from .bounds import BOOKS, CROPPED, CUT
from .questions import FATE

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.spec import Shot
    from ...rows.questions import Question
    from .cells import GasFrame, Mask
    from .frames import GasBox

__all__ = ["Fate"]

TINY = 1e-30


class Fate:
    """Optical depth of every frame, and what its pictures show of it."""

    questions: ClassVar[Mapping[str, Question]] = FATE

    def __init__(self, box: GasBox) -> None:
        self.box = box
        self.depth: list[float] = []
        self.outside: list[dict[str, float]] = []
        self._shown: tuple[tuple[Any, ...], Mask] | None = None
        """Where the last camera stood, and the cells in its picture."""

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Look at one frame."""
        soot = now.held.astype(np.float64)
        self.depth.append(self.box.extinction * self.box.cell * max(float(soot.sum(axis=a).max()) for a in range(3)))
        shots = self.box.candidate.spec.shots
        taken = {n: s for n, s in shots.items() if s.frames[0] <= now.index <= s.frames[1]}
        self.outside.append({n: self._outside(s, now, soot) for n, s in taken.items()} if self.depth[-1] >= CUT else {})

    def _outside(self, shot: Shot, now: GasFrame, soot: np.ndarray[Any, np.dtype[np.float64]]) -> float:
        """Share of the soot that lies outside the picture of a shot; none where the camera cannot be placed or follows something."""
        look, candidate = self.box.candidate.spec.look, self.box.candidate
        if shot.follow is not None:
            return 0.0
        try:
            camera = camera_at(candidate.aimed(shot), now.index, look.width, look.height, None)
        except InputError:
            return 0.0
        seen_from = (camera.position.tobytes(), camera.axes.tobytes(), float(camera.fov_deg), now.corner.tobytes())
        if self._shown is None or self._shown[0] != seen_from:  # a camera that stands still sees the same cells at every frame
            at = (now.centers.reshape(-1, 3) - camera.position) @ camera.axes.T
            tall = np.tan(np.radians(camera.fov_deg) / 2.0)
            wide = tall * look.width / look.height
            shown = (at[:, 2] < 0.0) & (np.abs(at[:, 0]) <= -wide * at[:, 2]) & (np.abs(at[:, 1]) <= -tall * at[:, 2])
            self._shown = (seen_from, shown)
        return 1.0 - float(soot.reshape(-1)[self._shown[1]].sum()) / max(float(soot.sum()), TINY)

    def findings(self) -> dict[str, Finding]:
        """Finding on whether it stays in sight."""
        depth = np.array(self.depth)
        if depth.max(initial=0.0) < CUT:
            text = f"no smoke is ever seen: the optical depth is {depth.max(initial=0.0):.2g} at most"
            return {"fate": Finding("not_applicable", text, evidence=self._evidence(len(depth) - 1, ""))}
        since = int(np.argmax(depth >= CUT))
        faded = np.flatnonzero(depth[since:] < CUT)
        if len(faded):
            frame = since + int(faded[0])
            shares = self._shares(frame)
            cause = max(("lost", "escaped", "thinned"), key=lambda n: shares[n] if n != "lost" or shares[n] > BOOKS else 0.0)
            return {"fate": self._gone(frame, cause, shares)}
        cropped = [min(s.values(), default=0.0) for s in self.outside]
        if max(cropped) > CROPPED:
            frame = int(np.argmax(np.array(cropped) > CROPPED))
            return {"fate": self._gone(frame, "cropped", {**self._shares(frame), "cropped": cropped[frame]})}
        least = float(depth[since:].min())
        text = f"smoke is seen from frame {since} on, through an optical depth of {least:.2g} at least; pictures crop {max(cropped):.0%} of it at most"
        return {"fate": Finding("pass", text, max(cropped), CROPPED, "1", evidence=self._evidence(len(depth) - 1, ""))}

    def _shares(self, frame: int) -> dict[str, float]:
        """Shares of what was let out by a frame that were lost, that left the box, and that are in it and not seen."""
        box = self.box
        came = max(float(box.record("emitted_soot")[frame]), TINY)
        escaped = float(box.record("escaped_soot")[frame]) / came
        there = box.soot_mass(box.read(frame)) / came
        return {"lost": max(0.0, 1.0 - escaped - there), "escaped": escaped, "thinned": there}

    def _gone(self, frame: int, cause: str, shares: dict[str, float]) -> Finding:
        words = {
            "lost": "the solver lost {:.0%} of it",
            "escaped": "{:.0%} of it left the box",
            "thinned": "{:.0%} of it is there, too thin to be seen",
            "cropped": "{:.0%} of what is there lies outside every picture",
        }[cause].format(shares[cause])
        text = f"smoke is seen no more at frame {frame}: {words}; the optical depth is {self.depth[frame]:.2g} of {max(self.depth):.2g} at most"
        place = f"/entities/{self.box.members[0]}/physics/soot_density"
        hint = {
            "thinned": correction("it thins out", "initial_state", "raise soot_density of the source", pointers=(place,)),
            "cropped": correction(
                "the camera does not follow it", "shots", "aim the shots at where it goes", pointers=("/shots",)
            ),
        }.get(cause)
        return Finding(
            "fail", text, shares.get("cropped", 1.0), CROPPED, "1", frame=frame, hints=() if hint is None else (hint,),
            evidence=self._evidence(frame, cause),
        )  # fmt: skip

    def _evidence(self, frame: int, cause: str) -> dict[str, Any]:
        found: dict[str, Any] = {
            **self._shares(frame),
            "optical_depth": self.depth[frame],
            "cropped_by_shot": self.outside[frame],
        }
        return {**found, "cause": cause} if cause else found
