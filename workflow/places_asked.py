"""Where place_object is asked to put an entity, checked before anything is built."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..worlds.errors import InputError
from .arrangements import Array, AssetAsk, Beside, Station

if TYPE_CHECKING:
    from ..worlds.spec import WorldSpec

__all__ = ["Asked", "check_asked", "number_of"]

FARTHEST = 1e6
"""[m] Own choice: no world is larger, and squares of distances stay far from overflow."""


@dataclass(frozen=True)
class Asked:
    """Where an entity shall be put, see the arguments of place_object."""

    entity: str
    asset: AssetAsk | None = None
    on: str | None = None
    surface: str | None = None
    at: tuple[float, float] | None = None
    height: float | None = None
    yaw_deg: float | None = None
    tilt: bool = False
    lay: bool = False
    beside: Beside | None = None
    river: Station | None = None
    afloat: str | None = None
    group: tuple[str, ...] | None = None
    copy: str | None = None
    array: Array | None = None
    cameras: bool = False
    strict: bool = True

    @property
    def names(self) -> list[str]:
        """The entity, then those that go along."""
        return list(dict.fromkeys((self.entity, *(self.group or ()))))


def check_asked(spec: WorldSpec, asked: Asked) -> None:
    """Refuse arguments that contradict each other or name nothing.

    Raises:
        InputError: with the argument and what it may be.
    """
    from ..worlds.hints import did_you_mean

    names = asked.names
    beside = None if asked.beside is None else asked.beside.entity
    for name in (*names, asked.on, beside):
        if name is not None and name not in spec.entities:
            hint = did_you_mean(name, spec.entities) or ";"
            raise InputError(f"unknown entity {name!r}{hint} the world has {sorted(spec.entities)[:30]}")
    for word, name in (("rest on", asked.on), ("stand beside", beside), ("float on", asked.afloat)):
        if name in names:
            raise InputError(f"{name!r} cannot {word} itself")
    if asked.at is not None and not all(abs(c) <= FARTHEST for c in asked.at):
        raise InputError(f"at {asked.at} is out of range; each coordinate is within {FARTHEST:g} m of the origin")
    given = [k for k in ("at", "beside", "river") if getattr(asked, k) is not None]
    if len(given) > 1:
        raise InputError(f"{' and '.join(given)} both say where; give one of them")
    lowered = [k for k in ("on", "river", "afloat") if getattr(asked, k) is not None]
    if asked.height is not None and lowered:
        raise InputError(f"height and {lowered[0]} both say how high; give one of them")
    if asked.surface is not None and (asked.on is None or asked.afloat is not None or asked.array is not None):
        raise InputError("surface names a place of the generated entity on: give on, and leave afloat and array out (things lie along its slope by themselves)")
    if asked.tilt and asked.on is None:
        raise InputError("tilt needs on: the surface whose slope it takes")
    if asked.afloat is not None and (asked.on is not None or asked.array is not None):
        raise InputError("afloat finds the height of one assembly by itself; leave on and array out, or place them one by one")
    if asked.copy is not None and asked.array is not None:
        raise InputError("copy makes one copy, array many; give one of them")
    if asked.copy == "":
        raise InputError("copy is the suffix of the new ids and not empty, e.g. '_b'")
    if asked.array is not None:
        _check_array(asked, asked.array)


def _check_array(asked: Asked, array: Array) -> None:
    if array.kind == "grid" and (min(array.counts) < 1 or not 2 <= array.counts[0] * array.counts[1] <= 500):
        raise InputError(
            f"counts {array.counts} give {array.counts[0] * array.counts[1]} places; a grid has 2 to 500, each count at least 1"
        )
    if array.kind == "circle" and (array.center is None or array.arc_deg == 0):
        raise InputError("a circle needs center, x, y [m], and an arc_deg other than 0")
    if array.kind == "scatter" and (
        array.polygon is None or asked.at is not None or asked.beside is not None or asked.river is not None
    ):
        raise InputError(
            "a scatter needs polygon, its corners x, y [m], and finds x and y by itself: leave at, beside and river out"
        )
    if array.yaw == "along" and array.kind != "circle":
        raise InputError("yaw 'along' is for a circle; give 'same' or 'random'")
    if array.size[0] > array.size[1]:
        raise InputError(f"size {array.size}: the least factor comes first")
    if asked.group and array.size != (1.0, 1.0):
        raise InputError("sizes vary of single entities; leave size or group out")


def number_of(index: int) -> str:
    """Suffix of a copy of an array, whose first is the entity itself."""
    return f"_{index + 1:03d}"
