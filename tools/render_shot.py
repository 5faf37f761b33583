"""Tool render_shot: pictures of a world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from ..workflow.arguments import WaitSeconds, WorldId
from ..workflow.context import Link, Picture, ToolContext, ToolReply
from ..workflow.pictures import Kind
from ..worlds.errors import InputError

if TYPE_CHECKING:
    from ..execution import Job
    from ..workflow.session import Session
    from ..workflow.taken_pictures import PictureAsk
    from ..worlds.folder import WorldFolder

__all__ = ["film_reply", "picture_reply", "render_shot"]

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
    wait_s: WaitSeconds = 30.0,
) -> ToolReply:
    """Look at the world: a picture comes back inline, beside a line of JSON; or make the final film.

    Takes seconds; a fine still or a contact sheet of many things is a job, which can be waited for and cancelled, like final. field works as soon as build_terrain(terrain=...) has built the landscape, final after acceptance,
    the others as soon as the audit passes. Frames are indices (frame k at k / fps s); own cameras in m. Use it for composition, light and understanding what happened.
    Not for judging geometry or motion: numbers do that better (run_checks, inspect_world). final renders every frame into a
    video, as a resumable job with an estimate; refused without acceptance of this very candidate.
    Returns: JSON text (summary, file, frame, camera), the picture (JPEG or PNG, at most 700 kB) and a link to it; for final
    also a link to the film with its size and length; or a job_id when it takes longer than wait_s. Next: inspect_world.
    """
    from ..workflow.session import Session
    from ..workflow.taken_pictures import PictureAsk

    session = Session.open(context.workspace, world)
    if kind == "final":
        return _final(context, session, width, height, samples, wait_s)
    if kind == "field":
        return _field(session, terrain, field or "hillshade", width, height)
    asked = PictureAsk(kind, frame, shot, camera, frames, stage, (width, height), samples)
    return _pictured(context, session, asked, wait_s)


def _pictured(context: ToolContext, session: Session, asked: PictureAsk, wait_s: float) -> ToolReply:
    """Draws a picture of the candidate at once, or as a job where that takes long; keeps it in the world folder and tells where."""
    from ..workflow.estimates import still_estimate
    from ..workflow.taken_pictures import look, take, takes_long
    from ..workflow.waiting import start_and_wait
    from ..worlds.canonical import digest_of

    seen = look(session, asked)
    if not takes_long(session, seen):
        context.progress(0.0, None, f"{asked.kind}: drawing")
        return _picture_told(session.folder, take(session, asked, seen))
    key = f"picture:{digest_of(asked.plain())}:{seen.candidate.digest}:{session.revision}"
    data = start_and_wait(context, session, "picture", {"asked": asked.plain()}, wait_s=wait_s, key=key)
    if "state" in data and asked.kind == "still":
        paths = seen.view.size[0] * seen.view.size[1] * (asked.samples or session.spec.look.samples)
        data["estimate_s"] = still_estimate(session.folder, paths)
    return _picture_told(session.folder, data)


def picture_reply(job: Job) -> ToolReply:
    """Reply for a picture whose job has ended."""
    from pathlib import Path

    from ..workflow.waiting import ended_data
    from ..worlds.folder import WorldFolder

    return _picture_told(WorldFolder(Path(job.payload["folder"])), ended_data(job))


def _picture_told(folder: WorldFolder, data: dict[str, Any]) -> ToolReply:
    from ..workflow.answers import answer, job_answer
    from ..workflow.taken_pictures import picture_link

    if "state" in data:
        told = job_answer(data)
        again = "the same call shows the picture once the job is done"
        return ToolReply(answer({**told, "world": folder.id}, told["summary"], told["next"], [*told["warnings"], again]))
    file = data["file"].rpartition("/")[2]
    image = (folder.pictures / file).read_bytes()
    link = picture_link(folder, file, len(image))
    then = "judge by numbers: inspect_world(part='state' or 'matrix')"
    kept = {k: v for k, v in data.items() if k not in ("says", "warnings")}
    shown = Picture(image, "png" if file.endswith(".png") else "jpeg")
    return ToolReply(answer(kept, data["says"], then, data["warnings"]), pictures=(shown,), links=(link,))


def _field(session: Session, terrain: str | None, field: str, width: int | None, height: int | None) -> ToolReply:
    from ..rendering import encode, field_map
    from ..workflow.answers import answer
    from ..workflow.taken_pictures import kept_picture
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
    link = kept_picture(session.folder, f"field_{name}_{field}", image)
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
