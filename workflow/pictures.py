"""Pictures of a candidate for tools and jobs: single views, contact sheets, plots of its account."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from ..worlds.errors import EvidenceError, InputError
from ..worlds.folder import WorldFolder, write_atomically
from .context import Picture

if TYPE_CHECKING:
    from ..geometry import Camera
    from ..worlds.arrays import U8
    from ..worlds.candidate import Candidate

__all__ = ["Kind", "View", "draw", "film_sheet", "misplaced", "motion_sheet"]

Kind = Literal["preview", "still", "contact_sheet", "ids", "ledger", "plan", "section", "field", "final"]

SHEET_FRAMES = 9
SHEET_WIDTH = 1920
"""Pixels of a contact sheet at most."""


MOST_HOLDERS = 3
"""Bodies that a warning about a camera names."""


@dataclass(frozen=True)
class View:
    """A picture that is asked for."""

    kind: Kind
    frame: int
    """Frame whose state is drawn."""
    seen_from: int
    """Frame at which the shot's camera stands."""
    shot: str | None
    camera: Camera | None
    """A camera of its own in place of a shot's."""
    size: tuple[int, int]
    """Width and height [pixels]."""
    frames: Sequence[int] | None = None
    """Frames of a contact sheet; None spreads them over the motion."""
    samples: int | None = None
    """Paths per pixel of a still."""


def spread(last: int) -> list[int]:
    """At most nine frames from 0 to `last`, evenly."""
    import numpy as np

    return sorted(set(np.linspace(0, last, SHEET_FRAMES).round().astype(int).tolist()))


def draw(candidate: Candidate, view: View) -> Picture:
    """The encoded picture.

    Raises:
        InputError: a frame of a contact sheet is out of range.
        LimitError: a still of so many samples is too dear.
    """
    from .. import rendering
    from ..worlds.limits import check_cap

    width, height = view.size
    camera = view.camera
    if camera is None and view.seen_from != view.frame:
        camera = rendering.camera_for(candidate, view.seen_from, shot=view.shot, width=width, height=height)
    if view.kind == "contact_sheet":
        return _sheet(candidate, view, camera)
    seen: dict[str, Any] = {"shot": view.shot, "camera": camera, "width": width, "height": height}
    if view.kind == "ledger":
        image = _ledger(candidate, width, height)
    elif view.kind == "plan":
        image = rendering.plan_view(candidate, view.frame)
    elif view.kind == "section":
        image = rendering.section_view(candidate, view.frame)
    elif view.kind == "ids":
        image = rendering.id_view(candidate, view.frame, **seen)
    elif view.kind == "still":
        check_cap("still_samples", width * height * (view.samples or candidate.spec.look.samples), what="this picture")
        image = rendering.render_frame(candidate, view.frame, samples=view.samples, **seen)
    else:
        image = rendering.preview(candidate, view.frame, **seen)
    encoded = rendering.encode(image)
    return Picture(encoded.data, encoded.format)


def misplaced(candidate: Candidate, view: View) -> list[str]:
    """A warning where a camera stands in a body, which hides the world or is cut open, as rows `shots:inside` judge it; of a sheet for the first such frame."""
    from .. import rendering
    from ..verifiers.shots.camera_path import stands_in

    if view.kind not in ("preview", "still", "ids", "contact_sheet"):
        return []
    sheet = view.kind == "contact_sheet"
    frames = view.frames or spread(candidate.last_frame) if sheet else [view.frame]
    for frame in frames:
        at, (width, height) = frame if sheet else view.seen_from, view.size
        camera = view.camera or rendering.camera_for(candidate, at, shot=view.shot, width=width, height=height)
        if told := stands_in(candidate, camera, frame):
            return [f"{text} at frame {at}: move it out" for text in told[:MOST_HOLDERS]]
    return []


def _sheet(candidate: Candidate, view: View, camera: Camera | None) -> Picture:
    chosen = view.frames or spread(candidate.last_frame)
    bad = [k for k in chosen if not 0 <= k <= candidate.last_frame]
    if bad:
        raise InputError(f"frames {bad} are out of range; allowed 0..{candidate.last_frame}")
    # Tiles are shrunk to fit the sheet: no use in drawing them larger.
    across = max(1, math.ceil(math.sqrt(len(chosen))))
    width, height = view.size
    tile = min(width, SHEET_WIDTH // across)
    size = tile, max(64, round(height * tile / width))
    return Picture(_tiles(candidate, chosen, size, shot=view.shot, camera=camera), "jpeg")


def _tiles(
    candidate: Candidate,
    frames: Sequence[int],
    size: tuple[int, int],
    *,
    shot: str | None = None,
    camera: Camera | None = None,
    columns: int | None = None,
) -> bytes:
    """A JPEG of previews of these frames, each with its time."""
    from ..rendering import PreviewRenderer, contact_sheet, preview

    renderer, fps = PreviewRenderer(candidate), candidate.spec.simulation.fps
    images = [preview(candidate, k, shot=shot, camera=camera, width=size[0], height=size[1], renderer=renderer) for k in frames]
    return contact_sheet(images, [f"frame {k}  {k / fps:.2f} s" for k in frames], columns=columns)


def _ledger(candidate: Candidate, width: int, height: int) -> U8:
    """The account of the verifiers; the solver's bare records where a channel for it is missing."""
    from .. import rendering
    from ..verifiers.ledgers.accounts import account_of

    try:
        account = account_of(candidate)
    except EvidenceError:
        return rendering.plot_ledger(candidate, width=max(width, 640), height=max(height, 480))
    return rendering.plot_account(candidate, account, width=width, height=height)


def motion_sheet(candidate: Candidate, folder: WorldFolder, name: str) -> str:
    """Contact sheet over the candidate's frames, kept in `pictures/`; returns its file name."""
    write_atomically(folder.pictures / name, _tiles(candidate, spread(candidate.last_frame), (480, 270), columns=3))
    return name


def film_sheet(folder: WorldFolder, frames: list[Path], name: str, fps: int) -> str:
    """Contact sheet of a rendered film, kept in `pictures/`; returns its file name."""
    import cv2
    import numpy as np

    from ..rendering import contact_sheet

    chosen = spread(len(frames) - 1)
    images = [np.asarray(cv2.imread(str(frames[k])))[..., ::-1].astype(np.uint8) for k in chosen]
    sheet = contact_sheet(images, [f"frame {k}  {k / fps:.2f} s" for k in chosen], columns=3)
    write_atomically(folder.pictures / name, sheet)
    return name
