"""A picture that a call asks for: taken, kept in the world folder, and told of; at once, or as a job where it takes long."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ..worlds.errors import InputError
from ..worlds.folder import WorldFolder, write_atomically
from .context import Link, Picture
from .pictures import Kind, View, draw, misplaced
from .session import Session

if TYPE_CHECKING:
    from ..execution import JobContext
    from ..worlds.candidate import Candidate

__all__ = ["USUAL_SIZE", "PictureAsk", "Seen", "kept_picture", "look", "picture", "size_of", "takes_long"]

LEDGER_SIZE = (1200, 1000)
"""Pixels of a ledger plot: six panels with legends."""
USUAL_SIZE = (640, 360)
"""Pixels of other pictures."""
LEAST_SIDE = 64
"""[pixels] As the fields of the tool say."""
PATHS_AT_ONCE = 1_000_000
"""Own choice: stills of more paths are jobs. A furnished room took 17 s per million on two busy cores."""
THINGS_AT_ONCE = 24
"""Own choice: contact sheets of worlds with more entities are jobs. One of a furnished room with 82 took 26 to 283 s on busy cores."""


@dataclass(frozen=True)
class PictureAsk:
    """Arguments of the call for a picture of a candidate."""

    kind: Kind
    frame: int
    shot: str | None
    camera: dict[str, Any] | list[float] | None
    frames: list[int] | None
    stage: str
    size: tuple[int | None, int | None]
    samples: int | None

    def plain(self) -> dict[str, Any]:
        """As JSON-able data."""
        return asdict(self)

    @staticmethod
    def of(data: dict[str, Any]) -> PictureAsk:
        """Arguments from their data as `plain` gives it."""
        return PictureAsk(**{**data, "size": tuple(data["size"])})


class Seen(NamedTuple):
    """Candidate and view of a picture, before it is drawn."""

    candidate: Candidate
    view: View
    warnings: tuple[str, ...]


def look(session: Session, asked: PictureAsk) -> Seen:
    """The candidate and the view that are asked for; frames of a motion count as seen from now on.

    Raises:
        InputError: the frame, the shot or the camera is wrong.
        RefusedError: the audit does not pass, or the asked stage is not there.
    """
    from .own_camera import buried, own_camera

    candidate, state = _candidate(session, asked)
    size = size_of(asked.size, LEDGER_SIZE if asked.kind == "ledger" else USUAL_SIZE)
    unjudged = session.shown(candidate, candidate.last_frame if asked.kind == "contact_sheet" else state)
    own = None if asked.camera is None else own_camera(candidate, asked.camera, state, *size)
    view = View(asked.kind, state, asked.frame, asked.shot, own, size, asked.frames, asked.samples)
    warnings = [] if own is None else buried(candidate, own)
    warnings += [unjudged] if unjudged else []
    if state != asked.frame:
        warnings.append("nothing is simulated yet: the state of frame 0, seen from this frame's camera")
    return Seen(candidate, view, tuple(warnings))


def takes_long(session: Session, seen: Seen) -> bool:
    """True for a picture that a job takes."""
    view = seen.view
    if view.kind == "still":
        return _paths(session, view) > PATHS_AT_ONCE
    return view.kind == "contact_sheet" and len(session.spec.entities) > THINGS_AT_ONCE


def _paths(session: Session, view: View) -> int:
    return view.size[0] * view.size[1] * (view.samples or session.spec.look.samples)


def take(session: Session, asked: PictureAsk, seen: Seen) -> dict[str, Any]:
    """Draws a picture, keeps it in the world folder, and tells of it as data for the reply."""
    from ..rendering import shot_of
    from ..worlds.canonical import digest_of
    from .estimates import still_took
    from .measurements import run_of

    candidate, view = seen.candidate, seen.view
    began = time.monotonic()
    image = draw(candidate, view)
    if view.kind == "still":
        still_took(session.folder, time.monotonic() - began, _paths(session, view))
    warnings = [*seen.warnings, *misplaced(candidate, view)]
    named = asked.shot or ("camera" + digest_of(asked.camera)[:6] if asked.camera is not None else "auto")
    link = kept_picture(session.folder, f"{view.kind}_{session.revision:04d}_{asked.frame:05d}_{named}", image)
    data: dict[str, Any] = {
        "world": session.folder.id,
        "revision": session.revision,
        "kind": view.kind,
        "source": candidate.artifact,
    }
    at = ""
    if view.kind not in ("contact_sheet", "ledger"):
        moment = round(asked.frame / session.spec.simulation.fps, 4)
        data |= {"frame": asked.frame, "time": moment}
        at = f" of frame {asked.frame} ({moment:g} s)"
    data["file"] = f"pictures/{link.name}"
    data["camera"] = "own" if asked.camera is not None else asked.shot or shot_of(session.spec, asked.frame) or "automatic"
    data["warnings"] = warnings
    data["says"] = f"{view.kind}{at}, from the {run_of(candidate)} candidate, camera {data['camera']}"
    return data


def picture(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Take a picture that takes long, as a job."""
    session = Session.at(WorldFolder.at(Path(payload["folder"]))).as_asked(payload.get("revision"), payload.get("stamp"))
    asked = PictureAsk.of(payload["asked"])
    context.progress(0.0, 1.0, "reading the frame")
    seen = look(session, asked)
    width, height = seen.view.size
    what = (
        "frames side by side" if asked.kind == "contact_sheet" else f"{seen.view.samples or session.spec.look.samples} paths each"
    )
    # Nothing is done yet that tells a pace: shaders and geometry are loaded first, and a time left would be made up.
    context.progress(0.0, 1.0, f"drawing {width} x {height} pixels, {what}")
    return take(session, asked, seen)


def size_of(asked: tuple[int | None, int | None], usual: tuple[int, int]) -> tuple[int, int]:
    """Width and height in pixels; where one alone is asked for, the other keeps the usual picture's shape, within what may be asked for."""
    (width, height), (wide, tall) = asked, usual
    if width is not None and height is None:
        height = max(LEAST_SIDE, round(width * tall / wide))
    elif height is not None and width is None:
        width = max(LEAST_SIDE, round(height * wide / tall))
    return width or wide, height or tall


def _candidate(session: Session, asked: PictureAsk) -> tuple[Candidate, int]:
    """The candidate to draw, and the frame whose state is drawn.

    Raises:
        InputError: the frame or the shot is not there.
    """
    from ..worlds.hints import did_you_mean
    from .measurements import run_of, seen_candidate

    session.require_audit("rendering", still=True)
    candidate, frame, shots = seen_candidate(session, asked.stage), asked.frame, session.spec.shots
    # Before any motion is known, the camera's way can be seen all the same: frame 0 from where the camera will be.
    still = candidate.stage == "static" and asked.camera is None and frame < session.spec.simulation.frames
    state = 0 if still else frame
    if state > candidate.last_frame:
        raise InputError(f"frame {frame} is out of range; the {run_of(candidate)} candidate has frames 0..{candidate.last_frame}")
    if asked.shot is not None and asked.shot not in shots:
        raise InputError(f"unknown shot {asked.shot!r}{did_you_mean(asked.shot, shots) or ';'} the world has {sorted(shots)}")
    return candidate, state


def kept_picture(folder: WorldFolder, name: str, image: Picture) -> Link:
    """Writes a picture to the world folder; a link to it."""
    file = f"{name}.{'png' if image.format == 'png' else 'jpg'}"
    write_atomically(folder.pictures / file, image.data)
    return picture_link(folder, file, len(image.data))


def picture_link(folder: WorldFolder, file: str, size: int) -> Link:
    """Link to a picture that is kept in a world folder."""
    kind = "png" if file.endswith(".png") else "jpeg"
    return Link(file, f"worldagent://worlds/{folder.id}/pictures/{file}", f"image/{kind}", size)
