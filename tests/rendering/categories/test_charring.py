"""Char in pictures: solids and cloth that burn are black as far as their gas has left them, gone where cloth is consumed, and whole at frame 0."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.geometry.camera import Camera
from worldagent.rendering.categories.charring import CHAR, Charring
from worldagent.rendering.preview import PreviewRenderer
from worldagent.testing.defects._gas_scenes import FRAMES, SOLVER, scene

LAST = FRAMES - 1


def view() -> Camera:
    return Camera(np.array([-1.1, -1.0, 0.6]), np.array([0.0, 0.0, 0.3]), 40.0, 240, 180)


@pytest.mark.parametrize("kind", ["hung", "kindled", "torch"])
def test_triangles_have_the_share_that_their_pieces_lost(kind: str) -> None:
    base = scene(kind)
    charred = Charring(base).of("sheet", "sheet")
    assert charred is not None
    cache, count = base.caches[SOLVER], len(base.entity("sheet").parts[0].render.faces)
    assert charred.by_face(0) == pytest.approx(np.zeros(count))
    first, last = cache.read(0), cache.read(LAST)
    corner = base.surface("sheet", "sheet", 0)[charred.faces]
    area = 0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    lost = float(((first["burning_left"] - last["burning_left"]) * first["burning_area"]).sum())
    assert float(charred.by_face(LAST) @ area) * first["burning_left"][0] == pytest.approx(lost, rel=1e-6)


def test_cloth_is_gone_where_all_pieces_of_a_triangle_are_consumed_and_a_solid_never() -> None:
    hung, stiff = (Charring(scene(k)).of("sheet", "sheet") for k in ("hung", "torch"))
    assert hung is not None
    assert stiff is not None
    gone = hung.gone(LAST)
    assert 0 < gone.sum() < len(gone)
    assert hung.by_face(LAST)[gone] == pytest.approx(1.0)
    assert not hung.gone(0).any()
    assert not stiff.gone(LAST).any()


def test_a_preview_shows_the_hole_and_the_char() -> None:
    """Fewer pixels show the cloth than would if it were whole, and those at its edge are darker."""
    base, camera = scene("hung"), view()
    renderer = PreviewRenderer(base)
    there = renderer.mask(LAST, camera, "sheet")
    charred = renderer._burning[next(iter(renderer._burning))]
    middle = base.surface("sheet", "sheet", LAST)[charred.faces[charred.gone(LAST)]].mean(axis=1)
    pixels, _ = camera.project(middle)
    column, row = (pixels[:, k].astype(int) for k in (0, 1))
    assert not there[row, column].all()
    place = base.surface("sheet", "sheet", LAST)
    black = charred.at(place, LAST)
    assert black.max() == pytest.approx(1.0)
    assert black.min() == 0.0
    colors = np.full((len(place), 3), 0.5)
    number = next(iter(renderer._burning))
    shown = renderer._burnt(LAST, np.full(len(place), number), place, colors)
    assert shown[black == 1.0] == pytest.approx(np.tile(CHAR, (int((black == 1.0).sum()), 1)))
    assert shown[black == 0.0] == pytest.approx(0.5)


def test_a_world_without_fire_has_no_char() -> None:
    assert Charring(scene("room")).parts == {}
