"""Tool render_shot: pictures of a world."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from ..workflow.arguments import WorldId
from ..workflow.context import Link, Picture, ToolContext, ToolReply
from ..workflow.pictures import Kind, View, draw, misplaced
from ..worlds.errors import InputError
from ..worlds.folder import write_atomically

if TYPE_CHECKING:
    from ..execution import Job
    from ..workflow.session import Session
    from ..worlds.candidate import Candidate
    from ..worlds.folder import WorldFolder

__all__ = ["film_reply", "render_shot"]

LEDGER_SIZE = (1200, 1000)
"""Pixels of a ledger plot: six panels with legends."""
USUAL_SIZE = (640, 360)
"""Pixels of other pictures."""
LEAST_SIDE = 64
"""[pixels] As the fields of the tool say."""

_FILM_KINDS = {"webm": "video/webm", "mp4": "video/mp4"}


def render_shot(
    context: ToolContext,
    world: WorldId,
    kind: Annotated[
        Kind,
        Field(
            description="preview: quick shaded frame; still: path-traced frame; contact_sheet: frames over time; ids: frame coloured and "
            "labelled by entity; ledger: plots of energy, momentum, ...; plan / section: measured drawings; field: map of a landscape; final: path-traced video"
        ),
    ] = "preview",
    frame: Annotated[int, Field(ge=0, description="Frame index, for single pictures")] = 0,
    shot: Annotated[str | None, Field(description="Shot id whose camera to use; default the one that covers the frame")] = None,
    camera: Annotated[
        dict[str, Any] | list[float] | None,
        Field(
            description="Own camera instead: {'position': [x, y, z], 'look_at': 'entity id'} or 'target': [x, y, z] in place of look_at, "
            "and 'fov_deg' if not 40; or six numbers, position and target [m]"
        ),
    ] = None,
    frames: Annotated[list[int] | None, Field(description="For contact_sheet: which frames", max_length=25)] = None,
    field: Annotated[
        str | None,
        Field(
            description="For field: hillshade, height, slope, basin_depth, accumulation, moisture, cover, ...; unknown ones list all"
        ),
    ] = None,
    terrain: Annotated[str | None, Field(description="For field: id under /terrains; default the only one")] = None,
    stage: Annotated[
        Literal["best", "static", "sketch", "probe", "full"],
        Field(description="What to show: default the bake, else the probe, else the sketch, else frame 0"),
    ] = "best",
    width: Annotated[
        int | None,
        Field(ge=64, le=1920, description="Pixels (of a whole contact sheet's tile); default 640, for final the specification's"),
    ] = None,
    height: Annotated[int | None, Field(ge=64, le=1080, description="Pixels; by width; for final the specification's")] = None,
    samples: Annotated[int | None, Field(ge=1, le=1024, description="Paths per pixel for still and final")] = None,
    wait_s: Annotated[
        float,
        Field(ge=0, le=240, description="For final: seconds to wait (50 at most, unless the server allows more), then a job id"),
    ] = 30.0,
) -> ToolReply:
    """Look at the world: a picture comes back inline, beside a line of JSON; or make the final film.

    Takes seconds, except final. field works as soon as build_terrain(terrain=...) has built the landscape, final after acceptance,
    the others as soon as the audit passes. Frames are indices (frame k at k / fps s); own cameras in m. Use it for composition, light and understanding what happened.
    Not for judging geometry or motion: numbers do that better (run_checks, inspect_world). final renders every frame into a
    video, as a resumable job with an estimate; refused without acceptance of this very candidate.
    Returns: JSON text (summary, file, frame, camera), the picture (JPEG or PNG, at most 700 kB) and a link to it; for final
    also a link to the film with its size and length, or a job_id when it takes longer than wait_s. Next: inspect_world.
    """
    from ..workflow.session import Session

    session = Session.open(context.workspace, world)
    if kind == "final":
        return _final(context, session, width, height, samples, wait_s)
    if kind == "field":
        return _field(session, terrain, field or "hillshade", width, height)
    asked = _Asked(kind, frame, shot, camera, frames, stage, (width, height), samples)
    return _pictured(session, asked)


@dataclass(frozen=True)
class _Asked:
    """Arguments of the call for a picture of a candidate."""

    kind: Kind
    frame: int
    shot: str | None
    camera: dict[str, Any] | list[float] | None
    frames: list[int] | None
    stage: str
    size: tuple[int | None, int | None]
    samples: int | None


def _pictured(session: Session, asked: _Asked) -> ToolReply:
    """Draws a picture of the candidate, keeps it in the world folder and tells where."""
    from ..rendering import shot_of
    from ..workflow.answers import answer
    from ..workflow.estimates import still_took
    from ..workflow.measurements import run_of
    from ..workflow.own_camera import buried, own_camera
    from ..worlds.canonical import digest_of

    world, kind, frame, shot, camera = session.folder.id, asked.kind, asked.frame, asked.shot, asked.camera
    candidate, state = _candidate(session, asked)
    data: dict[str, Any] = {"world": world, "revision": session.revision, "kind": kind, "source": candidate.artifact}
    wide, tall = LEDGER_SIZE if kind == "ledger" else USUAL_SIZE
    size = _size(asked.size, (wide, tall))
    unjudged = session.shown(candidate, candidate.last_frame if kind == "contact_sheet" else state)
    own = None if camera is None else own_camera(candidate, camera, state, *size)
    view_of = View(kind, state, frame, shot, own, size, asked.frames, asked.samples)
    began = time.monotonic()
    image = draw(candidate, view_of)
    if kind == "still":
        still_took(session.folder, time.monotonic() - began, size[0] * size[1] * (asked.samples or session.spec.look.samples))
    warnings = [*([] if own is None else buried(candidate, own)), *misplaced(candidate, view_of)]
    warnings += [unjudged] if unjudged else []
    if state != frame:
        warnings.append("nothing is simulated yet: the state of frame 0, seen from this frame's camera")
    view = shot or ("camera" + digest_of(camera)[:6] if camera is not None else "auto")
    link = _kept(session, f"{kind}_{session.revision:04d}_{frame:05d}_{view}", image)
    at = ""
    if kind not in ("contact_sheet", "ledger"):
        moment = round(frame / session.spec.simulation.fps, 4)
        data |= {"frame": frame, "time": moment}
        at = f" of frame {frame} ({moment:g} s)"
    data["file"] = f"pictures/{link.name}"
    data["camera"] = "own" if camera is not None else shot or shot_of(session.spec, frame) or "automatic"
    text = f"{kind}{at}, from the {run_of(candidate)} candidate, camera {data['camera']}"
    then = "judge by numbers: inspect_world(part='state' or 'matrix')"
    return ToolReply(answer(data, text, then, warnings), pictures=(image,), links=(link,))


def _size(asked: tuple[int | None, int | None], usual: tuple[int, int]) -> tuple[int, int]:
    """Width and height in pixels; where one alone is asked for, the other keeps the usual picture's shape, within what may be asked for."""
    (width, height), (wide, tall) = asked, usual
    if width is not None and height is None:
        height = max(LEAST_SIDE, round(width * tall / wide))
    elif height is not None and width is None:
        width = max(LEAST_SIDE, round(height * wide / tall))
    return width or wide, height or tall


def _candidate(session: Session, asked: _Asked) -> tuple[Candidate, int]:
    """The candidate to draw, and the frame whose state is drawn.

    Raises:
        InputError: the frame or the shot is not there.
    """
    from ..workflow.measurements import run_of, seen_candidate
    from ..worlds.hints import did_you_mean

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


def _kept(session: Session, name: str, image: Picture) -> Link:
    """Writes a picture to the world folder; a link to it."""
    file = f"{name}.{'png' if image.format == 'png' else 'jpg'}"
    write_atomically(session.folder.pictures / file, image.data)
    return Link(file, f"worldagent://worlds/{session.folder.id}/pictures/{file}", f"image/{image.format}", len(image.data))


def _field(session: Session, terrain: str | None, field: str, width: int | None, height: int | None) -> ToolReply:
    from ..rendering import encode, field_map
    from ..workflow.answers import answer
    from ..worlds.landscape import open_landscape

    known = sorted(session.spec.terrains)
    name = terrain or (known[0] if len(known) == 1 else None)
    if name not in session.spec.terrains:
        raise InputError(
            f"terrain {name!r}: the world has {known}; kind='field' needs one that build_terrain(terrain=...) has built"
        )
    land = open_landscape(session.folder.root, session.spec, name)
    drawn = encode(field_map(land, field, width=width or 900, height=height or 700))
    image = Picture(drawn.data, drawn.format)
    link = _kept(session, f"field_{name}_{field}", image)
    data = {"world": session.folder.id, "kind": "field", "field": field, "terrain": name, "file": f"pictures/{link.name}"}
    told = answer(
        data, f"{field} of the landscape {name!r}, north up", "numbers: build_terrain's reply, inspect_world(part='matrix')"
    )
    return ToolReply(told, pictures=(image,), links=(link,))


def _final(
    context: ToolContext, session: Session, width: int | None, height: int | None, samples: int | None, wait_s: float
) -> ToolReply:
    from ..workflow.estimates import film_estimate
    from ..workflow.gates import require_acceptance
    from ..workflow.waiting import start_and_wait
    from ..worlds.limits import check_film

    freeze = session.freeze()
    require_acceptance(session, freeze)
    size = {"width": width, "height": height, "samples": samples}
    check_film(session.spec, context.workspace, **size)
    key = f"final:{freeze}:{session.revision}:{width}:{height}:{samples}"
    look = session.spec.look
    estimate = film_estimate(
        context.jobs,
        frames=session.spec.simulation.frames,
        width=width or look.width,
        height=height or look.height,
        samples=samples or look.samples,
        folder=session.folder,
    )
    data = start_and_wait(context, session, "final", size, wait_s=wait_s, key=key)
    if "state" in data:
        data["estimate_s"] = estimate
    return _film_reply(session.folder, data)


def film_reply(job: Job) -> ToolReply:
    """Reply for a final sequence that has ended."""
    from pathlib import Path

    from ..workflow.waiting import ended_data
    from ..worlds.folder import WorldFolder

    return _film_reply(WorldFolder(Path(job.payload["folder"])), ended_data(job))


def _film_reply(folder: WorldFolder, data: dict[str, Any]) -> ToolReply:
    from ..workflow.answers import answer, job_answer
    from ..workflow.waiting import duration

    head = {"world": folder.id, "kind": "final"}
    if "state" in data:
        told = job_answer(data)
        warnings = [
            f"about {duration(data['estimate_s'])} as it is asked for; half the width and height take a quarter, as do a quarter of the samples"
            if data.get("estimate_s")
            else "how long it takes shows in the progress after the first frame"
        ]
        return ToolReply(answer({**told, **head}, told["summary"], told["next"], warnings))
    name = data["picture"]
    sheet = Picture((folder.pictures / name).read_bytes(), "jpeg")
    base = f"worldagent://worlds/{folder.id}"
    size, seconds = data["bytes"], data["duration_s"]
    film = Link("film", f"{base}/film", _FILM_KINDS[data["video"].rpartition(".")[2]], size, f"{seconds:g} s, {data['codec']}")
    text = f"film of {data['frames']} frames, {seconds:g} s, {data['width']} x {data['height']}, {size / 1e6:.1f} MB; {data.get('says', 'accepted')}"
    then = "the film is the delivery: read it by its link, or from the world folder"
    notes = [data["note"]] if data["note"] else []
    told = answer({**head, **{k: v for k, v in data.items() if k != "note"}}, text, then, notes)
    return ToolReply(told, pictures=(sheet,), links=(Link(name, f"{base}/pictures/{name}", "image/jpeg"), film))
