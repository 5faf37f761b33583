"""Small liquids for tests: lattices of particles in boxes, and bodies moved by hand."""

import numpy as np
from worldagent.simulation.boundaries import BodyState
from worldagent.simulation.liquid.dfsph import Dfsph, DfsphSettings
from worldagent.simulation.liquid.engine import Fluid, LiquidSetup

G = 9.81
WATER = Fluid("water", 1000.0, 1e-3)


def lattice(low, high, spacing):
    """Cell centres of a box (n, 3)."""
    axes = [np.arange(round((b - a) / spacing)) * spacing + a + spacing / 2 for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def liquid(spacing, size, domain, *, keep=None, fluid=WATER, gravity=-G, sides=("closed",) * 6, velocity=None, **more):
    """A box of liquid from the origin, in a domain from the origin."""
    x = lattice((0, 0, 0), size, spacing)
    x = x if keep is None else x[keep(x)]
    n = len(x)
    return LiquidSetup(
        spacing=spacing,
        lower=np.zeros(3),
        upper=np.array(domain, dtype=float),
        sides=sides,
        fluids=(fluid,),
        gravity=np.array([0.0, 0.0, gravity]),
        position=x,
        velocity=np.zeros((n, 3)) if velocity is None else velocity(x),
        fluid=np.zeros(n, dtype=np.int32),
        volume=np.full(n, spacing**3),
        **more,
    )


def bodies(*states):
    """Bodies (centre, velocity, inverse mass, inverse inertia, acceleration), not turned."""
    b = len(states)
    pick = [
        np.array([s[k] for s in states], dtype=float).reshape((b, *shape))
        for k, shape in enumerate([(3,), (3,), (), (3, 3), (3,)])
    ]
    turns = np.tile(np.eye(3), (b, 1, 1))
    return BodyState(pick[0], turns, pick[0], pick[1], np.zeros((b, 3)), pick[2], pick[3], pick[4])


def run(setup, seconds, *, state=None, **settings):
    """The engine after a time, and its reports."""
    engine = Dfsph(setup, DfsphSettings(**{"density_error": 1e-4, **settings}))
    state = state or bodies()
    reports = []
    while engine.time < seconds:
        reports.append(engine.step(seconds - engine.time + 1e-9, state))
    return engine, reports


def momentum(engine):
    """Linear and angular, about the origin, of all particles."""
    p = engine.particles()
    mass = p.volume * np.array([f.density for f in engine.setup.fluids])[p.fluid]
    return (mass[:, None] * p.velocity).sum(axis=0), np.cross(p.position, mass[:, None] * p.velocity).sum(axis=0)
