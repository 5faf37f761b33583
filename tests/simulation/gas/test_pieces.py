"""Pieces of surface: they cover what they are cut from, and go where it goes."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.simulation.boundaries import BodyState
from worldagent.simulation.gas.pieces import STANDS, Pieces, cut_into_pieces, cut_sheet
from worldagent.simulation.gas.places import Places
from worldagent.simulation.gas.stock import Stock
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.categories.gas.models import Flammable

CORNERS = np.array([[0.0, 0.0, 0.0], [0.4, 0.0, 0.0], [0.0, 0.3, 0.1], [0.4, 0.3, 0.1]])
FACES = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)


def pieces(carrier: int, *, thin: bool) -> Pieces:
    cut = cut_sheet(CORNERS, FACES, 0.1)
    n = len(cut.area)
    return Pieces(
        part=np.zeros(n, dtype=np.int32), point=cut.point, normal=cut.normal, area=cut.area, depth=np.full(n, 1e-3),
        density=np.full(n, 500.0), kind=(Flammable(),), carrier=np.full(n, carrier), corner=FACES[cut.face].astype(np.int64),
        weight=cut.weight, thin=np.full(n, thin),
    )  # fmt: skip


def state(velocity: tuple[float, float, float], spin: tuple[float, float, float]) -> BodyState:
    zero = np.zeros((1, 3))
    return BodyState(
        zero, np.eye(3)[None], zero, np.array([velocity]), np.array([spin]), np.zeros(1), np.zeros((1, 3, 3)), zero.copy()
    )


def test_pieces_of_a_sheet_cover_its_triangles_and_lie_where_their_shares_say() -> None:
    cut = cut_sheet(CORNERS, FACES, 0.1)
    corner = CORNERS[FACES]
    whole = 0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    assert np.bincount(cut.face, cut.area) == pytest.approx(whole, rel=1e-12)
    assert cut.weight.sum(axis=1) == pytest.approx(1.0)
    assert np.einsum("nk,nkx->nx", cut.weight, corner[cut.face]) == pytest.approx(cut.point, abs=1e-15)
    point, normal, area = cut_into_pieces(TriangleMesh(CORNERS, FACES), 0.1)
    for one, two in ((point, cut.point), (normal, cut.normal), (area, cut.area)):
        assert np.array_equal(one, two)


def test_pieces_of_a_body_turn_with_it() -> None:
    places = Places(pieces(0, thin=False))
    places.take(state((0.0, 0.0, 2.0), (0.0, 0.0, np.pi)), 0.5)
    held = places.pieces
    assert places.point == pytest.approx(np.stack([-held.point[:, 1], held.point[:, 0], held.point[:, 2] + 1.0], axis=1))
    assert places.normal == pytest.approx(np.stack([-held.normal[:, 1], held.normal[:, 0], held.normal[:, 2]], axis=1))


def test_pieces_of_cloth_lie_on_its_triangles() -> None:
    places, bodies = Places(pieces(0, thin=True)), state((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    stretched = CORNERS * np.array([1.1, 1.0, 3.0])
    bodies.vertices[0] = (stretched, np.full((4, 3), 2.0))
    places.take(bodies, 0.25)
    assert places.point == pytest.approx(places.pieces.point * np.array([1.1, 1.0, 3.0]) + 0.5)
    across = np.cross(stretched[1] - stretched[0], stretched[2] - stretched[0])
    assert places.normal == pytest.approx(np.tile(across / np.linalg.norm(across), (len(places.point), 1)))


def test_what_stands_stays() -> None:
    places = Places(pieces(STANDS, thin=False))
    assert not places.move
    places.take(state((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)), 1.0)
    assert np.array_equal(places.point, places.pieces.point)


def test_material_of_sheets_and_solids_is_packed_and_restored() -> None:
    """A stock that goes on from what was packed is the same to the byte."""
    one, two = (Stock(pieces(0, thin=True), 293.15) for _ in range(2))
    flux = np.full(len(one.thin), 2.5e5)
    for _ in range(60):
        one.step(0.02, flux)
    assert (one.left < two.left).all()
    two.unpack({k: v.copy() for k, v in one.pack().items()})
    assert np.array_equal(one.step(0.02, flux), two.step(0.02, flux))
    assert np.array_equal(one.heat, two.heat)
