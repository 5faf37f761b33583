"""Still water: pressure, rest, density, level; and the volume of what has settled."""

from __future__ import annotations

import numpy as np
from worldagent.simulation.liquid.engine import Engine, Particles
from worldagent.simulation.liquid.surface import SurfaceSettings, surface_frame
from worldagent.simulation.step_reports import StepReport

from .world import CLOSED, OPEN, WALL, EngineName, Figure, G, advance, below, lattice, level, liquid, make, near, tank_walls

__all__ = ["hydrostatics", "settling", "still_water", "surface_volume"]


def surface_volume(engine: Engine, upper: tuple[float, float, float], name: EngineName, *, boxes: bool = False) -> float:
    """Volume inside the surface as the product meshes it, laid onto the walls of a tank [0, upper] [m^3]."""
    p = engine.particles()
    n = len(p.position)
    spacing = float(np.cbrt(np.median(p.volume)))
    wide = {"support": 3.0, "threshold": 0.64} if name == "flip" else {}
    sides = {} if boxes else {"lower": (0.0, 0.0, 0.0), "upper": upper, "closed": (True,) * 5 + (False,)}
    data = {
        "origin": np.zeros(3),
        "particle/position": p.position.astype(np.float32),
        "particle/velocity": p.velocity.astype(np.float32),
        "particle/id": p.identity,
        "particle/fluid": np.zeros(n, dtype=np.int32),
        "particle/volume": p.volume.astype(np.float32),
    }
    settings = SurfaceSettings(spacing, **wide, **sides)  # type: ignore[arg-type]
    found, _ = surface_frame(data, settings, dt=1 / 24, walls=[w.mesh for w in tank_walls(upper)] if boxes else ())
    return float(found["record/surface_volume"])


def _tank(engine: EngineName, cells: int, depth: float, walls: str) -> tuple[Engine, tuple[float, float, float], tuple]:
    spacing, side = depth / cells, depth
    water = lattice((0, 0, 0), (side, side, depth), spacing)
    room = (side, side, 1.5 * depth)
    if walls == "sides":
        return make(engine, liquid(spacing, water, room)), room, ()
    boundaries = tank_walls(room)
    low, high = (-2 * WALL,) * 3, (side + 2 * WALL, side + 2 * WALL, 2.0 * depth)
    return make(engine, liquid(spacing, water, high, lower=low, sides=OPEN, boundaries=boundaries)), room, boundaries


def _energy(p: Particles) -> float:
    """Kinetic over potential energy above the floor."""
    return float((0.5 * p.volume * (p.velocity**2).sum(axis=1)).sum() / (G * (p.volume * p.position[:, 2]).sum()))


def _rest(engine: EngineName, cells: int, walls: str, seconds: float) -> list[Figure]:
    depth = 0.4
    running, room, boundaries = _tank(engine, cells, depth, walls)
    spacing, start = depth / cells, surface_volume_of(running, room, engine, walls)
    pressure: list[tuple[float, float]] = []
    energy: list[tuple[float, float]] = []
    heights: list[float] = []

    def look(time: float, _: StepReport) -> None:
        p = running.particles()
        energy.append((time, _energy(p)))
        if time > 0.5 * seconds:
            low = p.position[:, 2] < 2 * spacing
            column = 1000.0 * G * (depth - p.position[low, 2])
            pressure.append((float((p.pressure[low] - column).mean()), float(len(p.position))))
            heights.append(level(running))

    reports = advance(running, seconds, boundaries, look, longest=0.02)
    late = [r for r, (t, _) in zip(reports, energy, strict=True) if t > 0.5 * seconds]
    course = np.array(energy)
    last, first = course[:, 0] > 0.9 * seconds, (course[:, 0] > 0.1) & (course[:, 0] < 0.1 + 0.1 * seconds)
    found = [
        below(
            "pressure near the floor, error / (rho g depth)", abs(np.mean([e for e, _ in pressure])) / (1000 * G * depth), 0.01
        ),
        below("kinetic / potential energy at the end", course[last, 1].mean(), 1e-4),
        below("kinetic energy, end / start", course[last, 1].mean() / max(course[first, 1].max(), 1e-12), 1.0),
        below("mean density error", abs(np.mean([r.density_error[0] for r in late])), 1e-3),
        below("level, error / depth", abs(np.mean(heights) / depth - 1), 0.01),
        below("surface volume, drift", abs(surface_volume_of(running, room, engine, walls) / start - 1), 0.01),
        below("particles lost", abs(running.particles().volume.sum() / (depth**3) - 1), 1e-6),
    ]
    if boundaries:
        push = -sum(r.impulse[:, 2].sum() for r in late) / sum(r.dt for r in late)
        found.append(near("force on the tank / weight", push / (1000 * G * depth**3), 1.0, 0.01))
    return found


def surface_volume_of(engine: Engine, room: tuple[float, float, float], name: EngineName, walls: str) -> float:
    """`surface_volume` by the kind of walls."""
    return surface_volume(engine, room, name, boxes=walls == "boxes")


def hydrostatics(engine: EngineName, cells: int, walls: str = "sides") -> list[Figure]:
    """A cube of 0.4 m, 2 s; `cells` over the depth."""
    return _rest(engine, cells, walls, 2.0)


def still_water(engine: EngineName, cells: int, walls: str = "sides") -> list[Figure]:
    """The same for 5 s."""
    return _rest(engine, cells, walls, 5.0)


def settling(engine: EngineName, cells: int) -> list[Figure]:
    """A column of 0.375 x 0.25 x 0.625 m falls apart in a tank 1 m long and comes to rest, 5 s; `cells` per metre."""
    spacing, size, room = 1.0 / cells, (0.375, 0.25, 0.625), (1.0, 0.25, 1.0)
    running = make(engine, liquid(spacing, lattice((0, 0, 0), size, spacing), room, sides=CLOSED))
    volume, start = float(np.prod(size)), surface_volume(running, room, engine)
    advance(running, 4.0)
    surfaces, density = [], []
    for _ in range(20):
        density += [r.density_error[0] for r in advance(running, 0.05)]
        surfaces.append(surface_volume(running, room, engine))
    p = running.particles()
    return [
        below("surface volume, drift", abs(np.mean(surfaces) / start - 1), 0.01),
        below("surface volume, error", abs(np.mean(surfaces) / volume - 1), 0.02),
        below("mean density error", abs(np.mean(density)), 1e-3),
        below("volume of particles, drift", abs(p.volume.sum() / volume - 1), 1e-6),
    ]
