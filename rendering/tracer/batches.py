"""Bodies of a candidate as few meshes: all parts of one material layer that move, or that do not, are one batch."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ...worlds.arrays import F32, F64, rotation_matrix
from ...worlds.built import BuiltPart
from ...worlds.candidate import Candidate
from ..categories.charring import Charring
from ..categories.layer import PartsLayer
from ..categories.liquid.wet_look import Link, Wetness, film_at, finely
from ..categories.registry import Layers
from ..categories.soft_part import SoftPart
from ..land.scenery import cut_from, landscapes_of
from ..views import active, pattern_frame
from .burnt import BurntPart, burnt_part, burnt_surface
from .materials import PANE
from .surfaces import Surface, textured_surfaces
from .textures import Tile

__all__ = ["Batch", "Kind", "batches_of"]

FAR = 1e5
"""[m] Where lamps are that do not exist at a frame: their light is 1e-8 of that at 10 m."""


class Kind(NamedTuple):
    """Properties that all parts of a batch share."""

    material: str
    layer: str
    """Kind of texture: `side`, or `end` for the end grain of wood."""
    moving: bool
    wets: bool
    """A liquid ever wets them."""
    tone: float
    """Factor by which they are lighter than the material."""
    lamp: str = ""
    """Lamp of the look that they are; empty for all that does not shine."""
    burns: bool = False
    """They may burn beside a gas."""

    @property
    def name(self) -> str:
        """Name of the mesh in the scene."""
        tone = f"-{round(100 * self.tone)}" if self.tone != 1.0 else ""
        lamp = f"-lamp-{self.lamp}" if self.lamp else ""
        return f"{'moving' if self.moving else 'static'}-{self.material}-{self.layer}{'-wet' if self.wets else ''}{tone}{lamp}{'-burns' if self.burns else ''}"


@dataclass(frozen=True)
class Batch:
    """Parts of one kind as one mesh."""

    name: str
    bodies: tuple[tuple[str, str], ...]
    """(entity, body) that own vertices."""
    owner: Any
    """Index into `bodies` per vertex."""
    surface: Surface
    links: tuple[tuple[int, tuple[Link, ...]], ...] = ()
    """Number of vertices of each wetted part and where its film comes from, in the order of their vertices; empty where nothing gets wet."""
    soft: tuple[SoftPart, ...] = ()
    """Parts that deform."""
    shines: bool = False
    burnt: tuple[BurntPart, ...] = ()
    """Parts that burn."""

    def char(self, frame: int) -> F32:
        """Blackness of every vertex, shape (v,)."""
        return np.concatenate([part.char(frame) for part in self.burnt]).astype(np.float32)

    def film(self, wetness: Wetness, frame: int, known: dict[str, F64]) -> F32:
        """Share of the film of a liquid at every vertex, shape (v,)."""
        return np.concatenate([film_at(wetness, list(links), count, frame, known) for count, links in self.links])

    @property
    def entities(self) -> frozenset[str]:
        """Entities that own vertices."""
        return frozenset(entity for entity, _ in self.bodies)

    def place_digest(self, positions: F32, without: str | None) -> bytes:
        """SHA-256 of the positions that `placed` gave, but for those of the entity left out, which is a point somewhere."""
        there = np.array([entity != without for entity, _ in self.bodies])
        return hashlib.sha256(np.ascontiguousarray(positions[there[self.owner]]).tobytes()).digest()

    def placed(self, candidate: Candidate, frame: int, without: str | None = None) -> tuple[F32, F32]:
        """World positions and normals at a frame; entities that do not exist then, and one left out, shrink to a point.

        Lamps go far away instead: what shines must have an area.
        """
        poses = [candidate.pose(entity, frame, body) for entity, body in self.bodies]
        turns = rotation_matrix(np.stack([p.quaternion for p in poses]))
        there = {e: e != without and active(candidate, e, frame) for e in self.entities}
        shown = np.array([there[entity] or self.shines for entity, _ in self.bodies], dtype=np.float64)
        shifts = np.stack([p.position for p in poses])
        if self.shines:
            shifts -= np.array([[0.0, 0.0, 0.0 if there[entity] else FAR] for entity, _ in self.bodies])
        local = self.surface.positions * shown[self.owner, None]
        positions = np.einsum("nij,nj->ni", turns[self.owner], local) + shifts[self.owner]
        normals = np.einsum("nij,nj->ni", turns[self.owner], self.surface.normals)
        for part in self.soft:
            if there[part.entity]:
                positions[part.rows], normals[part.rows] = part.placed(candidate, frame)
        for burnt in self.burnt:
            burnt.hole(frame, positions)
        return positions.astype(np.float32), normals.astype(np.float32)


def _joined(surfaces: list[Surface]) -> Surface:
    starts = np.cumsum([0, *(len(s.positions) for s in surfaces)])
    return Surface(
        np.concatenate([s.positions for s in surfaces]),
        np.concatenate([s.normals for s in surfaces]),
        np.concatenate([s.uv for s in surfaces]),
        np.concatenate([s.faces + start for s, start in zip(surfaces, starts, strict=False)]),
    )


class _Shown(NamedTuple):
    """Changes of surfaces by other matter."""

    wetness: Wetness
    charring: Charring


class _Piece(NamedTuple):
    """Surface of one part that goes into a batch."""

    layer: PartsLayer
    entity: str
    part: BuiltPart
    surface: Surface


def _pieces(
    candidate: Candidate, layers: Layers, tiles: dict[str, dict[str, Tile]], shown: _Shown
) -> Iterator[tuple[Kind, _Piece]]:
    """Surfaces of all bodies but the grounds of landscapes, which are drawn with their land."""
    wetness = shown.wetness
    wet, scenery = wetness.entities(), landscapes_of(candidate)
    lamps = {(lamp.entity, lamp.part): name for name, lamp in sorted(candidate.spec.look.lamps.items())}
    for layer, entity, part in layers.parts:
        if cut_from(candidate, entity) in scenery:
            continue
        changing = candidate.moves(entity) or candidate.spec.entities[entity].active is not None
        look = candidate.spec.materials[part.material].appearance
        surfaces = textured_surfaces(
            part.render,
            smooth=part.smooth,
            tiles=tiles[part.material],
            pattern=look.pattern,
            scale=look.pattern_scale,
            frame=pattern_frame(candidate, entity, part),
            key=f"{entity}/{part.part}",
        )
        lamp = lamps.get((entity, part.part), "")
        charred = None if lamp else shown.charring.of(entity, part.part)
        wets = entity in wet and look.transmission < PANE and not layer.bends(entity) and not lamp and charred is None
        tone = layer.tone(entity, part.part)
        for side, surface in surfaces.items():
            fine = wetness.refined(entity, part.body, part.part, surface) if wets else surface
            if charred is not None:
                fine = burnt_surface(candidate, charred, surface, finely)
            yield Kind(part.material, side, changing, wets, tone, lamp, charred is not None), _Piece(layer, entity, part, fine)


def batches_of(
    candidate: Candidate, layers: Layers, tiles: dict[str, dict[str, Tile]], wetness: Wetness, charring: Charring
) -> dict[Kind, Batch]:
    """Batches of all bodies by what their parts have in common; tiles by material and texture layer."""
    found: dict[Kind, list[_Piece]] = {}
    shown = _Shown(wetness, charring)
    for kind, piece in _pieces(candidate, layers, tiles, shown):
        found.setdefault(kind, []).append(piece)
    return {kind: _batch(candidate, kind, pieces, shown) for kind, pieces in sorted(found.items())}


def _batch(candidate: Candidate, kind: Kind, pieces: list[_Piece], shown: _Shown) -> Batch:
    wetness = shown.wetness
    bodies = tuple(dict.fromkeys((p.entity, p.part.body) for p in pieces))
    index = {name: k for k, name in enumerate(bodies)}
    counts = [len(p.surface.positions) for p in pieces]
    owner = np.concatenate([np.full(n, index[p.entity, p.part.body]) for p, n in zip(pieces, counts, strict=True)])
    links = [tuple(wetness.links(p.entity, p.part.body, p.part.part, p.surface)) for p in pieces] if kind.wets else []
    starts = np.cumsum([0, *counts]).tolist()
    soft = [p.layer.soft(p.entity, p.part, p.surface, k) for p, k in zip(pieces, starts, strict=False)]
    return Batch(
        kind.name,
        bodies,
        owner,
        _joined([p.surface for p in pieces]),
        tuple(zip(counts, links, strict=False)),
        tuple(s for s in soft if s is not None),
        bool(kind.lamp),
        tuple(_burnt(candidate, p, shown, k) for p, k in zip(pieces, starts, strict=False)) if kind.burns else (),
    )


def _burnt(candidate: Candidate, piece: _Piece, shown: _Shown, start: int) -> BurntPart:
    charred = shown.charring.of(piece.entity, piece.part.part)
    assert charred is not None
    return burnt_part(candidate, charred, piece.part, piece.surface, start)
