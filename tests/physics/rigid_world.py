"""Short specifications for tests of the rigid solver: an entity is one line, a world a dict of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from worldagent.construction import build_entity
from worldagent.simulation.rigid import SolverRigid
from worldagent.worlds.spec import WorldSpec

NO_ASSETS = Path("/nonexistent")
G = 9.81


def entity(
    shape: Mapping[str, Any] | None = None,
    *,
    at: Sequence[float] = (0, 0, 0),
    euler: Sequence[float] | None = None,
    motion: str = "dynamic",
    mass: float | None = None,
    v: Sequence[float] = (0, 0, 0),
    w: Sequence[float] = (0, 0, 0),
    material: str = "m",
    drag: float = 0.0,
    **more: Any,
) -> dict[str, Any]:
    """An entity of one part; declared dimensions are not judged here."""
    physics = {
        "category": "rigid",
        "mass": mass,
        "linear_velocity": tuple(v),
        "angular_velocity": tuple(w),
        "linear_damping": drag,
    }
    parts = {} if shape is None else {"p": {"shape": dict(shape)}}
    return {
        "role": "test object",
        "motion": motion,
        "physics": physics,
        "dimensions": {"size": (1, 1, 1)},
        "pose": {"position": tuple(at), "euler": None if euler is None else tuple(euler)},
        "material": material,
        "parts": parts,
        **more,
    }


def box(*size: float, **more: Any) -> dict[str, Any]:
    return entity({"kind": "box", "size": size}, **more)


def ball(radius: float, **more: Any) -> dict[str, Any]:
    return entity({"kind": "sphere", "radius": radius}, **more)


def floor(size: float = 20.0, *, top: float = 0.0, **more: Any) -> dict[str, Any]:
    """A static slab whose top is at z = `top`."""
    return box(size, size, 1.0, at=(0, 0, top - 0.5), motion="static", **more)


def world(
    entities: Mapping[str, Any],
    *,
    seconds: float = 1.0,
    fps: int = 24,
    materials: Mapping[str, Any] | None = None,
    settings: Mapping[str, Any] | None = None,
    friction: float = 0.5,
    restitution: float = 0.0,
    **plan: Any,
) -> WorldSpec:
    """A world of one rigid instance `main` that has all entities as members; material `m` is the default one."""
    return WorldSpec.model_validate(
        {
            "title": "test",
            "prompt": "test",
            "materials": {
                "m": {"density": 1000.0, "friction": friction, "restitution": restitution},
                **(materials or {}),
            },
            "entities": dict(entities),
            "simulation": {
                "fps": fps,
                "frames": max(2, round(seconds * fps) + 1),
                "solvers": {"main": {"engine": "mujoco", "members": list(entities), "settings": dict(settings or {})}},
                **plan,
            },
        }
    )


def solver(spec: WorldSpec, *, prepare: bool = True) -> SolverRigid:
    """The world's solver at frame 0."""
    made = SolverRigid(spec, {n: build_entity(spec, n, NO_ASSETS) for n in spec.entities}, "main")
    if prepare:
        made.prepare()
    return made


class Run:
    """All frames of a world: channels stacked where they have one shape, listed where they do not."""

    def __init__(self, spec: WorldSpec) -> None:
        self.solver = solver(spec)
        self.frames = [dict(self.solver.frame_data())]
        for k in range(1, spec.simulation.frames):
            self.solver.advance(k)
            self.frames.append(dict(self.solver.frame_data()))
        self.index = self.solver.index()
        self.time = np.arange(len(self.frames)) / spec.simulation.fps

    def of(self, name: str, channel: str = "position", body: str = "body") -> np.ndarray:
        """One body's channel over the frames."""
        row = self.index.bodies.index(f"{name}/{body}")
        return np.array([f[channel][row] for f in self.frames])

    def series(self, channel: str) -> np.ndarray:
        return np.array([f[channel] for f in self.frames])

    def record(self, name: str) -> np.ndarray:
        return self.series(f"record/{name}")

    def events(self, a: str | None = None, b: str | None = None) -> list[dict[str, Any]]:
        """Events between two entities (any when None), in order of time."""
        found = []
        for k, frame in enumerate(self.frames):
            for i, pair in enumerate(frame["event/pair"]):
                names = {self.index.colliders[p] for p in pair}
                if {n for n in (a, b) if n is not None} <= names:
                    found.append(
                        {"frame": k, "names": names, **{c: frame[f"event/{c}"][i] for c in ("time", "point", "speed", "impulse")}}
                    )
        return found

    def joint(self, name: str) -> np.ndarray:
        return self.series("joint")[:, self.index.joints.index(name)]


def worst_clearance(run: Run, *, ignore: Sequence[frozenset[str]] = (), skip_above: float = 0.002) -> tuple[float, str, str, int]:
    """Smallest signed clearance of visible surfaces of different entities over all frames: value [m], names, frame."""
    from worldagent.geometry import Solid, clearance_series
    from worldagent.worlds.arrays import pose_of

    pieces = []
    for name, built in run.solver.built.items():
        fixed = pose_of(run.solver.spec.entities[name].pose)
        for part in built.parts:
            if f"{name}/{part.body}" in run.index.bodies:
                track = run.of(name, "position", part.body), run.of(name, "quaternion", part.body)
            else:
                track = np.tile(fixed.position, (len(run.frames), 1)), np.tile(fixed.quaternion, (len(run.frames), 1))
            moves = run.solver.spec.entities[name].motion != "static"
            pieces.append((name, moves, Solid.from_mesh(part.render, closed=True), track))
    worst = (np.inf, "", "", -1)
    for i, (a, moves_a, solid_a, track_a) in enumerate(pieces):
        for b, moves_b, solid_b, track_b in pieces[i + 1 :]:
            if a == b or not (moves_a or moves_b) or frozenset((a, b)) in ignore:
                continue
            series = clearance_series(solid_a, track_a, solid_b, track_b, skip_above=skip_above)
            k = int(series.argmin())
            if series[k] < worst[0]:
                worst = (float(series[k]), a, b, k)
    return worst
