"""Settling before frame 0 (`simulation.settle`): what settles, the world in which it does, and the frames that show how it came to rest."""

from __future__ import annotations

import hashlib
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .cache import Cache
from .categories.registry import CATEGORIES
from .derived import Derived
from .errors import EvidenceError
from .instances import coupled_groups
from .spec import FieldDriver, PathDriver, ReleaseDriver

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = [
    "HOLD_SECONDS",
    "SettledFrames",
    "hold_frames",
    "rest_way",
    "settling",
    "settling_terms",
    "settling_world",
    "unsettled",
]

HOLD_SECONDS = 0.5
"""[s] Own choice: what has kept its place for so long is at rest; nothing that swings about is slow for all of it."""


def unsettled(spec: WorldSpec, name: str) -> str:
    """Reason why an entity cannot settle; empty where it can."""
    entity, plan = spec.entities[name], spec.simulation
    if entity.motion != "dynamic":
        return f"it is {entity.motion}: nothing but its driver, if any, moves it"
    if not rest_way(spec, name) > 0.0:
        return f"{entity.physics.category} of its kind does not come to rest by itself"
    if any((*getattr(entity.physics, "linear_velocity", ()), *getattr(entity.physics, "angular_velocity", ()))):
        return "it starts with a velocity"
    if getattr(entity.physics, "currents", None):
        return "it starts with currents"
    held = next((n for n, d in plan.drivers.items() if isinstance(d, ReleaseDriver) and d.entity == name), None)
    return "" if held is None else f"release {held!r} holds it where it is declared"


def settling(spec: WorldSpec) -> tuple[str, ...]:
    """Entities that come to rest before frame 0."""
    settle = spec.simulation.settle
    if settle is None:
        return ()
    return tuple(n for n in (settle.entities or spec.entities) if n in spec.entities and not unsettled(spec, n))


def settling_world(spec: WorldSpec) -> WorldSpec:
    """The world of the settle run: without drivers, media at rest apart, and with what follows a path where the path begins.

    An edit of drivers, beats, shots or frames leaves it as it is.
    """
    plan, settle = spec.simulation, spec.simulation.settle
    assert settle is not None
    media = {
        n: d.model_copy(update={"start": 0.0, "rise": 0.0, "end": None})
        for n, d in plan.drivers.items()
        if isinstance(d, FieldDriver) and d.field.kind == "drag"
    }
    first = {
        d.entity: min(d.keys.values(), key=lambda k: k.time).pose for d in plan.drivers.values() if isinstance(d, PathDriver)
    }
    entities = {n: e.model_copy(update={"pose": first[n]}) if n in first else e for n, e in spec.entities.items()}
    frames = math.ceil(settle.max_time * plan.fps - 1e-9) + 1
    still = plan.model_copy(update={"drivers": media, "frames": max(frames, hold_frames(spec)), "preroll": 0.0})
    return spec.model_copy(update={"entities": entities, "simulation": still})


def settling_terms(spec: WorldSpec) -> dict[str, Any] | None:
    """Everything of the drivers that a settle run depends on; None where nothing settles."""
    if spec.simulation.settle is None:
        return None
    still = settling_world(spec)
    media = {n: d.model_dump(mode="json") for n, d in still.simulation.drivers.items()}
    driven = {d.entity for d in spec.simulation.drivers.values() if isinstance(d, PathDriver)}
    places = {n: still.entities[n].pose.model_dump(mode="json") for n in sorted(driven & still.entities.keys())}
    return {"settles": list(settling(spec)), "media": media, "places": places}


def hold_frames(spec: WorldSpec) -> int:
    """Frames over which what is at rest keeps its place, first and last included."""
    return max(1, round(HOLD_SECONDS * spec.simulation.fps)) + 1


def rest_way(spec: WorldSpec, name: str) -> float:
    """Farthest that an entity at rest may move in `HOLD_SECONDS` [m]; 0 where it does not come to rest by itself.

    Its category says how far, by what its engine resolves; a body that others push goes with them as far as they go.
    """
    plan = spec.simulation
    own = _own_way(spec, name)
    pushing = {n for g in coupled_groups(spec) if any(name in plan.rigid[r].members for r in g & plan.rigid.keys()) for n in g}
    return max([own, *(_own_way(spec, m) for n in pushing - plan.rigid.keys() for m in plan.solvers[n].members)]) if own else own


def _own_way(spec: WorldSpec, name: str) -> float:
    return CATEGORIES[spec.entities[name].physics.category].rest_way(spec, name) if name in spec.entities else 0.0


class SettledFrames(Derived):
    """The last frames of the settle run of an instance, in `settled/` beside its own; the last of them is the state at frame 0."""

    one = "settled state"
    many = "settled frames"
    note = "settled.json"

    def __init__(self, cache: Cache) -> None:
        super().__init__(cache, cache.folder / "settled")
        self.files = Cache(cache.folder / "settled")

    @property
    def state_path(self) -> Path:
        """File of the engine's state at the end; whoever trusts nothing settles again instead of reading it."""
        return self.files.folder / "state.bin"

    def there(self) -> bool:
        """Whether the instance has settled, and all of its last frames are there."""
        try:
            return len(self.files.digests()) >= self.files.index.frames > 0
        except EvidenceError:
            return False

    def count(self) -> int:
        """All frames of the cache where it has settled, since that stands behind each of them; else 0."""
        return self.cache.index.frames if self.there() else 0

    def digest(self, frames: int | None = None) -> str:
        """SHA-256 over the recorded digests of its frames and its note, hex; `frames` does not matter."""
        note = (self.files.folder / self.note).read_bytes()
        return hashlib.sha256("".join([*self.files.digests(), hashlib.sha256(note).hexdigest()]).encode()).hexdigest()

    def _understand(self, data: dict[str, Any]) -> None:
        data["recipe"], float(data["seconds"]), dict(data["moving"])
