"""Questions about elastic bodies: shape, holds and flight of each, and the ledgers of the instance that moves them."""

from __future__ import annotations

from ...rows.questions import Question

__all__ = ["ENTITY", "INSTANCE", "QUESTIONS"]

ENTITY = (
    Question(
        "category:elastic:shape",
        "every vertex is finite and no tetrahedron is inverted",
        "least volume of a tetrahedron over that at rest",
        "1",
        ">=",
        "0",
        ("entity",),
    ),
    Question(
        "category:elastic:strain",
        "largest principal strain <= max_strain of the contract",
        "largest principal strain",
        "1",
        "<=",
        "max_strain of the body",
        ("entity",),
    ),
    Question(
        "category:elastic:self",
        "the visible surface passes nowhere through itself",
        "largest number of crossing pairs of triangles at a frame",
        "1",
        "<=",
        "0",
        ("entity",),
    ),
    Question(
        "category:elastic:volume",
        "the volume changes by no more than max_strain allows at the Poisson's ratio",
        "largest relative change of volume",
        "1",
        "<=",
        "3 (1 - 2 poisson_ratio) max_strain, at least VOLUME_NOISE",
        ("entity",),
    ),
    Question(
        "category:elastic:step",
        "no node travels farther in a step than half an edge of the surface that collides",
        "largest travel of a node in a step",
        "m",
        "<=",
        "TRAVEL_SHARE of the edge",
        ("entity",),
    ),
    Question(
        "category:elastic:recovery",
        "at rest, the body is back in its shape: within `recovery` of its size, and what its load explains",
        "farthest vertex from the best fit of the rest shape, at the last frame",
        "m",
        "<=",
        "recovery of its size, plus LOAD_SHARE of what beam and column formulas give",
        ("entity",),
    ),
    Question(
        "category:elastic:pins",
        "what pins hold stays where they hold it",
        "largest slip of the middle of what a pin holds, of the pin that is nearest to its bound",
        "m",
        "<=",
        "SLIP_SHARE of the spread of what it holds",
        ("entity",),
    ),
    Question(
        "category:elastic:flight",
        "where nothing touches or pins the body, its centre of mass falls freely",
        "largest change of velocity per frame beyond a free fall",
        "m/s",
        "<=",
        "FLIGHT of what gravity gives, plus FLIGHT_SPEED",
        ("entity",),
    ),
)
"""Questions about each elastic body."""

INSTANCE = (
    Question(
        "category:elastic:energy",
        "energy of the instance less the work of drivers, coupled solvers and fields never grows by more than limits.energy_growth "
        "of the energy in play",
        "largest growth over any interval, as share of the energy in play",
        "1",
        "<=",
        "limits.energy_growth",
        ("solver",),
    ),
    Question(
        "category:elastic:solve",
        "the elastic solve of every step converges, or ends within a relative residual of 1e-3",
        "largest relative residual of a solve that ended before it converged",
        "1",
        "<=",
        "RESIDUAL",
        ("solver",),
    ),
    Question(
        "category:elastic:records",
        "recorded energies and momentum of elastic members are those of their vertices",
        "largest deviation, as share of what is in play",
        "1",
        "<=",
        "RECORDS",
        ("solver",),
    ),
    Question(
        "category:elastic:mass",
        "simulation meshes hold the volume that was built",
        "largest share of the built volume that a simulation mesh misses",
        "1",
        "<=",
        "MASS",
        ("solver",),
    ),
    Question(
        "category:elastic:exchange",
        "what elastic members received is what cloth, grains and liquids gave them",
        "largest difference over the largest impulse",
        "1",
        "<=",
        "BOOKS",
        ("solver",),
    ),
    Question(
        "category:elastic:fields",
        "impulses of force fields are those of the declared fields within a tenth of the largest",
        "largest difference over the largest impulse",
        "1",
        "<=",
        "FIELD",
        ("solver",),
    ),
    Question(
        "category:elastic:together",
        "energy of elastic bodies and the cloth coupled with them, less work from outside, never grows by more than "
        "limits.energy_growth of the energy in play",
        "largest growth over any interval, as share of the energy in play",
        "1",
        "<=",
        "limits.energy_growth",
        ("solver",),
    ),
)
"""Questions about each instance with elastic members."""

QUESTIONS = (*ENTITY, *INSTANCE)
