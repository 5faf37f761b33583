"""Causal parameter groups, their classes of edit, and the group of a JSON pointer (R111-R113)."""

from __future__ import annotations

from .categories.registry import CATEGORIES
from .directions import nearest_field
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
        GroupInfo("resolution", "solver", "particle spacing or cell size of fluids, cells of elastic bodies, radius of grains"),
        GroupInfo("domain", "solver", "box in which loose matter is simulated, and its sides"),
        GroupInfo("contact", "solver", "collision skins, special contact pairs, contact stiffness"),
        GroupInfo("step", "solver", "time step, iterations and other solver settings"),
        GroupInfo("drivers", "solver", "authored drivers, gravity, couplings"),
        GroupInfo("interval", "solver", "frames, frame rate, preroll, settle, seed"),
        GroupInfo("story", "story", "beats and requirements"),
        GroupInfo("limits", "story", "bounds of checks"),
        GroupInfo("shots", "shot", "shot plan"),
        GroupInfo("look", "shot", "light, picture format, appearance"),
        GroupInfo("text", "text", "titles, roles, clause mapping: no influence on anything simulated"),
        *(group for category in CATEGORIES.values() for group in category.groups),
    )
}


def group_of(pointer: str) -> GroupInfo:
    """Group of a JSON pointer into `world.json`; `text` for what nothing depends on."""
    field = nearest_field(pointer)
    return GROUPS["text" if field is None else field.group]
