"""Next step in a world with landscapes: they are built first, then what stands on them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..worlds.errors import EvidenceError
from ..worlds.landscape import open_landscape
from ..worlds.spec import HeightField, StemField, WorldSpec
from .answers import call

if TYPE_CHECKING:
    from .session import Session

__all__ = ["after_building", "grounds_of", "to_build", "to_place"]

ON_GROUND = "support:ground:"
"""Rows that tell whether a thing stands on the land."""


def grounds_of(spec: WorldSpec, terrain: str) -> list[str]:
    """Entities whose ground is cut from a landscape."""
    return [
        name
        for name, entity in spec.entities.items()
        for part in entity.parts.values()
        if isinstance(part.shape, HeightField) and part.shape.file is not None and part.shape.file.startswith(f"{terrain}-")
    ]


def to_build(session: Session) -> str | None:
    """The call that builds the first landscape which is not built from its present specification, or has no ground yet."""
    world = session.folder.id
    for name in session.spec.terrains:
        grounds = grounds_of(session.spec, name)
        try:
            open_landscape(session.folder.root, session.spec, name)
        except EvidenceError:
            grounds = grounds[:1]
        else:
            if grounds:
                continue
        if not grounds:
            return call("build_terrain", world=world, terrain=name)
        return call("build_terrain", world=world, terrain=name, entity=grounds[0], **_cut(session, grounds[0]))
    return None


def _cut(session: Session, ground: str) -> dict[str, Any]:
    """Arguments that cut a ground anew where and as it is."""
    import numpy as np

    entity = session.spec.entities[ground]
    found: dict[str, Any] = {"center": list(entity.pose.position[:2])}
    for part in entity.parts.values():
        if isinstance(part.shape, HeightField) and part.shape.file is not None:
            path = session.folder.assets / part.shape.file
            found["size"] = list(part.shape.size)
            if path.is_file():
                found["cells"] = max(np.load(path, mmap_mode="r", allow_pickle=False).shape) - 1
        if isinstance(part.shape, StemField):
            found["stems"] = True
    return found


def after_building(session: Session, ground: str, audit_open: list[str], static_open: list[str]) -> str:
    """The call after a landscape was built: a look and a place for things, or what stands in the way."""
    world = session.folder.id
    look = call("render_shot", world=world, kind="field", field="hillshade")
    if len(session.spec.entities) <= sum(len(grounds_of(session.spec, n)) for n in session.spec.terrains):
        find = call("inspect_world", world=world, part="terrain", find="flat", size=10)
        return f"{find} tells where things can stand ({look} shows the land); then edit_spec: add the entities, beats and shots"
    if audit_open:
        return f"edit_spec: mend {', '.join(audit_open[:3])}; {look} shows the land"
    lying = [row.removeprefix(ON_GROUND) for row in static_open if row.startswith(ON_GROUND)]
    if lying:
        call_them = call("place_object", world=world, entity=lying[0], on=ground)
        return f"{call_them} lowers it onto the ground" + (f", then {', '.join(lying[1:5])} likewise" if lying[1:] else "")
    if static_open:
        return f"edit_spec or place_object: mend {static_open[0]}; {look} shows the land"
    return f"{call('place_object', world=world)} for what is not in place, else {call('probe_sim', world=world)}; {look} shows the land"


def to_place(spec: WorldSpec, world: str, terrain: str, at: Any) -> str:
    """The call that uses a place on the land: where a ground covers it an entity, else a ground."""
    for name in grounds_of(spec, terrain):
        ground = spec.entities[name]
        size = ground.dimensions.size
        if all(abs(at[k] - ground.pose.position[k]) <= 0.5 * size[k] for k in (0, 1)):
            return (
                f"edit_spec: add an entity there, then {call('place_object', world=world, entity='its id', on=name, at=list(at))}"
            )
    return call("build_terrain", world=world, terrain=terrain, center=list(at), size=[120, 120])
