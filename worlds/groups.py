"""Registry of causal parameter groups: JSON pointer -> group and class of edit (R111-R113)."""

from __future__ import annotations

import re

from .categories.registry import CATEGORIES, parameter_of
from .parameters import GroupInfo

__all__ = ["GROUPS", "group_of"]

GROUPS: dict[str, GroupInfo] = {
    g.name: g
    for g in (
        GroupInfo("placement", "scene", "where entities stand and how they are turned, what floats in the air"),
        GroupInfo("dimensions", "scene", "declared sizes"),
        GroupInfo("shape", "scene", "parts, collision shapes, generators, entities added or removed"),
        GroupInfo("terrain", "scene", "height, erosion and water of landscapes"),
        GroupInfo("cover", "shot", "ground materials and plants of landscapes: nothing simulated depends on them"),
        GroupInfo("joints", "scene", "hinges, slides, balls, welds, springs, pins of deforming bodies"),
        GroupInfo("relations", "scene", "scene graph: regions and relations"),
        GroupInfo("material", "solver", "friction, restitution, density"),
        GroupInfo("mass", "solver", "declared masses and damping"),
        GroupInfo("initial_state", "solver", "velocities and temperatures at frame 0"),
        GroupInfo("resolution", "solver", "particle spacing or cell size of liquids, cells of elastic bodies, radius of grains"),
        GroupInfo("domain", "solver", "box in which a liquid or particles are simulated, and its sides"),
        GroupInfo("contact", "solver", "collision skins, special contact pairs, contact stiffness"),
        GroupInfo("step", "solver", "time step, iterations and other solver settings"),
        GroupInfo("drivers", "solver", "authored drivers, gravity, couplings"),
        GroupInfo("interval", "solver", "frames, frame rate, preroll, seed"),
        GroupInfo("story", "story", "beats and requirements"),
        GroupInfo("limits", "story", "bounds of checks"),
        GroupInfo("shots", "shot", "shot plan"),
        GroupInfo("look", "shot", "light, picture format, appearance"),
        GroupInfo("text", "text", "titles, roles, clauses and claims: no influence on anything simulated"),
        *(group for category in CATEGORIES.values() for group in category.groups),
    )
}

_RULES: tuple[tuple[str, str], ...] = (
    (r"/entities/[^/]+/(afloat|pose(/.*)?)", "placement"),
    (r"/entities/[^/]+/(dimensions|nominal_diagonal)(/.*)?", "dimensions"),
    (r"/entities/[^/]+/physics(/.*)?", "mass"),
    (r"/entities/[^/]+/material", "material"),
    (r"/entities/[^/]+/(role|inputs|outputs)(/.*)?", "text"),
    (r"/entities/[^/]+/parts/[^/]+/material", "material"),
    (r"/entities(/.*)?", "shape"),
    (r"/materials/[^/]+/appearance(/.*)?", "look"),
    (r"/materials(/.*)?", "material"),
    (r"/terrains/[^/]+/(ground|vegetation)(/.*)?", "cover"),
    (r"/terrains(/.*)?", "terrain"),
    (r"/graph(/.*)?", "relations"),
    (r"/story/semantics", "text"),
    (r"/story(/.*)?", "story"),
    (r"/shots(/.*)?", "shots"),
    (r"/look(/.*)?", "look"),
    (r"/(title|clauses|claims)(/.*)?", "text"),
    (r"/simulation/limits(/.*)?", "limits"),
    (r"/simulation/joints(/.*)?", "joints"),
    (r"/simulation/(drivers|gravity|couplings|order)(/.*)?", "drivers"),
    (r"/simulation/contacts(/.*)?", "contact"),
    (r"/simulation/solvers/[^/]+/members(/.*)?", "shape"),
    (r"/simulation/solvers(/.*)?", "step"),
    (r"/simulation/(fps|frames|preroll|seed)", "interval"),
    (r"/simulation", "interval"),
)
_COMPILED = tuple((re.compile(pattern + "$"), group) for pattern, group in _RULES)


def group_of(pointer: str) -> GroupInfo:
    """Group of a JSON pointer into `world.json`; `text` for what nothing depends on."""
    parameter = parameter_of(pointer)
    if parameter is not None:
        return GROUPS[parameter.group]
    return GROUPS[next((group for pattern, group in _COMPILED if pattern.match(pointer)), "text")]
