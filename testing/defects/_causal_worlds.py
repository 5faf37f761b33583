"""Scenes of the causal suite: dominoes, sliders and contacts written by hand, turned and moved as `rng` says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64, quaternion_product
from ...worlds.candidate import Candidate
from ...worlds.predicates import Topples
from ...worlds.spec import Beat, Entity
from ...worlds.vocabulary import SpecModel
from ..worlds.simulated_worlds import beat
from ..worlds.small_worlds import Event, Touch, ball, box, ground, make_candidate, world

__all__ = ["FPS", "LAST", "MASS", "TIME", "Scene", "falls"]

FPS, FRAMES = 24, 49
LAST = FRAMES - 1
TIME: F64 = np.arange(FRAMES) / FPS
MASS = 600.0 * 0.02 * 0.1 * 0.2
"""Mass of a domino of `Scene` [kg]."""
PUSH = 0.05
"""[N s] Impulse of a contact where nothing else is said."""
RATE = 3.0
"""[rad/s] at which dominoes turn; they count as toppled 0.2 s after they start."""


def falls(name: str, *, causes: Sequence[str] = ()) -> Beat:
    """The beat that a domino topples."""
    return beat(name, Topples(entity=name), frames=(0, LAST), causes=causes)


class Scene:
    """Bodies on a floor, in a frame of its own that lies anywhere and is turned by any angle."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.heading = float(rng.uniform(-np.pi, np.pi))
        self.offset = np.array([*rng.uniform(-3, 3, 2), 0.0])
        self.entities: dict[str, Entity] = {"floor": ground(20.0)}
        self.tracks: dict[str, Any] = {}
        self.events: list[Event] = []
        self.touches: list[Touch] = []

    def at(self, points: Any) -> F64:
        """Points of the scene's own frame in the world."""
        c, s = np.cos(self.heading), np.sin(self.heading)
        turned: F64 = np.asarray(points, dtype=np.float64) @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + self.offset
        return turned

    def domino(self, name: str, x: float, start: float = np.inf, *, lies: float = 1.4) -> None:
        """A domino that starts to turn at `start` [s]."""
        angle = np.clip(RATE * (TIME - start), 0.0, lies)
        own = np.stack([np.cos(angle / 2), 0 * angle, np.sin(angle / 2), 0 * angle], axis=1)
        turn = np.array([np.cos(self.heading / 2), 0.0, 0.0, np.sin(self.heading / 2)])
        places = np.stack([x + 0.05 * np.sin(angle), 0 * angle, 0.1 * np.cos(angle)], axis=1)
        self.entities[name] = box(0.02, 0.1, 0.2, motion="dynamic", at=self.at([x, 0, 0.1]), euler=(0, 0, self.heading))
        self.tracks[name] = self.at(places), quaternion_product(turn, own)

    def slider(self, name: str, x: Any, *, y: float = 0.0, radius: float = 0.05, motion: str = "dynamic") -> None:
        """A ball whose centre is at `x` [m], a number or shape (frames,)."""
        along = np.broadcast_to(np.asarray(x, dtype=np.float64), (FRAMES,))
        places = self.at(np.stack([along, np.full(FRAMES, y), np.full(FRAMES, radius)], axis=1))
        self.entities[name] = ball(radius, motion=motion, at=places[0])
        self.tracks[name] = places, (1.0, 0.0, 0.0, 0.0)

    def hit(self, time: float, a: str, b: str, impulse: float = PUSH) -> None:
        """A contact that is over by the next frame."""
        self.events.append(Event(time, a, b, impulse=impulse))
        self.touches.append(Touch(int(np.ceil(time * FPS - 1e-9)), a, b, impulse))

    def leans(self, time: float, a: str, b: str, impulse: float = PUSH, *, until: float = TIME[-1]) -> None:
        """A contact that lasts."""
        first = int(np.ceil(time * FPS - 1e-9))
        self.events.append(Event(time, a, b, impulse=impulse))
        self.touches += [Touch(k, a, b, impulse) for k in range(first, int(until * FPS) + 1)]

    def rests(self, a: str, b: str, impulse: Any = 0.1) -> None:
        """A contact from the start on; `impulse` per frame [N s], a number or shape (frames,)."""
        own = np.broadcast_to(np.asarray(impulse, dtype=np.float64), (FRAMES,))
        self.touches += [Touch(k, a, b, float(own[k])) for k in range(1, FRAMES)]

    def momentum(self, name: str, frame: int, mass: float = MASS) -> float:
        """Size of the momentum [kg m/s] as it is in the cache."""
        places = self.tracks[name][0]
        return mass * float(np.linalg.norm(np.gradient(places, 1.0 / FPS, axis=0)[frame]))

    def candidate(
        self,
        folder: Path,
        beats: Mapping[str, Beat],
        *,
        drivers: Mapping[str, SpecModel] | None = None,
        joints: Mapping[str, SpecModel] | None = None,
    ) -> Candidate:
        """The scene's candidate; every moving body rests on the floor."""
        for name, entity in self.entities.items():
            if entity.motion == "dynamic":
                self.rests("floor", name)
        spec = world(self.entities, beats=beats, frames=FRAMES, drivers=drivers, joints=joints)
        return make_candidate(folder, spec, tracks=self.tracks, touches=self.touches, events=self.events)
