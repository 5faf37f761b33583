"""Making plates: what is rendered, kept, stopped and told; the renderer is a painter, so that nothing is traced."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from worldagent.execution import Cancelled
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, ground, make_candidate, world
from worldagent.verifiers.shots.seen import check
from worldagent.workflow import jobs, plates
from worldagent.workflow.plates import LEAST_S, allowed_seconds, depart, make_plates
from worldagent.workflow.review.pictures import MOST_PICTURES, frames_to_show, pictures_of
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import EngineError, InputError
from worldagent.worlds.plates import SEEDS, Plate, Plates, View, plate_pictures, plate_size, plates_folder
from worldagent.worlds.predicates import Displacement
from worldagent.worlds.spec import Beat, CameraKey, Shot

N = 25
BALLS = ("a", "b", "c")


@pytest.fixture
def candidate(tmp_path: Path) -> Candidate:
    """Three balls roll side by side, each with a beat."""
    time = np.arange(N) / 24
    entities = {"floor": ground(), **{n: ball(0.1, motion="dynamic", at=(0, k, 0.1)) for k, n in enumerate(BALLS)}}
    tracks = {n: (np.stack([time, 0 * time + k, 0 * time + 0.1], axis=1), IDENTITY) for k, n in enumerate(BALLS)}
    moves = {n: Displacement(entity=n, min=0.3) for n in BALLS}
    beats = {f"{n}-rolls": Beat(text="", owner="rigid", subject=n, frames=(4, 20), predicate=moves[n]) for n in BALLS}
    camera = CameraKey(frame=0, position=(0.5, -4, 3), target=(0.5, 1, 0.1), fov_deg=40)
    spec = world(entities, frames=N, beats=beats, shots={"only": Shot(frames=(0, N - 1), keys={"k": camera})})
    return make_candidate(tmp_path, spec, tracks=tracks)


class Painter:
    """Stands for the renderer: white with its subject, black without it."""

    seen: list[View] = []
    level: Any = 255
    fails: Callable[[View], Exception | None] = staticmethod(lambda view: None)

    def __init__(self, candidate: Candidate) -> None:
        self.candidate = candidate

    def plate(self, view: View, *, size: tuple[int, int], samples: int) -> Plate:
        if (error := Painter.fails(view)) is not None:
            raise error
        Painter.seen.append(view)
        shape = (SEEDS, size[1], size[0], 3)
        return Plate(np.full(shape, Painter.level, np.uint8), np.zeros(shape, np.uint8))


@pytest.fixture(autouse=True)
def painter(monkeypatch: pytest.MonkeyPatch) -> type[Painter]:
    monkeypatch.setattr("worldagent.rendering.FrameRenderer", Painter)
    monkeypatch.setattr("worldagent.rendering.renderer_versions", lambda: {"source": "painter"})
    Painter.seen, Painter.level, Painter.fails = [], 255, staticmethod(lambda view: None)
    return Painter


def statuses(candidate: Candidate) -> dict[str, str]:
    return {r.subject[0]: r.status for r in check(candidate)}


def test_every_subject_is_looked_at_once_and_kept(candidate: Candidate) -> None:
    made = make_plates(candidate, seconds=60)
    assert [v.subject for v in made.views] == list(BALLS)
    assert statuses(candidate) == dict.fromkeys((f"{n}-rolls" for n in BALLS), "pass")
    assert make_plates(candidate, seconds=60) == made
    assert len(Painter.seen) == 3


def test_when_the_time_is_over_the_others_are_told_and_the_next_call_goes_on(candidate: Candidate) -> None:
    made = make_plates(candidate, seconds=-1.0)
    assert len(made.views) == 1
    assert made.left == dict.fromkeys(BALLS[1:], "the time for plates was over")
    assert statuses(candidate) == {"a-rolls": "pass", "b-rolls": "unverified", "c-rolls": "unverified"}
    assert make_plates(candidate, seconds=60).left == {}
    assert [v.subject for v in Painter.seen] == list(BALLS)
    assert set(statuses(candidate).values()) == {"pass"}


def test_a_cancelled_call_keeps_what_it_has_rendered(candidate: Candidate) -> None:
    def cancel() -> None:
        if Painter.seen:
            raise Cancelled("asked")

    with pytest.raises(Cancelled):
        make_plates(candidate, seconds=60, check=cancel)
    assert len(Painter.seen) == 1
    make_plates(candidate, seconds=60)
    assert len(Painter.seen) == 3


def test_progress_is_told_before_every_plate(candidate: Candidate) -> None:
    told: list[tuple[float, float, str]] = []
    make_plates(candidate, seconds=60, progress=lambda done, total, text, ends=None: told.append((done, total, text)))
    assert [(d, t) for d, t, _ in told] == [(0, 3), (1, 3), (2, 3)]
    assert "loading" in told[0][2]
    assert "looking at c" in told[2][2]


@pytest.mark.parametrize("what", ["look", "cache", "program", "damage"])
def test_what_is_stale_or_damaged_is_rendered_anew(candidate: Candidate, what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    make_plates(candidate, seconds=60)
    after = candidate
    if what == "look":
        look = candidate.spec.look.model_copy(update={"exposure": 1.0})
        after = dataclasses.replace(candidate, spec=candidate.spec.model_copy(update={"look": look}))
    elif what == "cache":
        after = dataclasses.replace(candidate, digest="another")
    elif what == "program":
        monkeypatch.setattr("worldagent.rendering.renderer_versions", lambda: {"source": "better painter"})
    else:
        (plates_folder(candidate) / "frame_000001.npz").write_bytes(b"no")
    make_plates(after, seconds=60)
    assert len(Painter.seen) == 6
    assert set(statuses(after).values()) == {"pass"}


def test_a_kept_plate_that_comes_out_otherwise_is_no_evidence(candidate: Candidate) -> None:
    """A forged plate agrees with its forged digest: only rendering it again tells."""
    Painter.level = 200
    make_plates(candidate, seconds=60)
    Painter.seen, Painter.level = [], 255
    make_plates(candidate, seconds=60)
    assert Painter.seen == [], "nothing distrusts them"
    made = make_plates(candidate, seconds=60, distrust=True)
    assert len(Painter.seen) == 1 + 3
    assert int(made.read(plates_folder(candidate), made.views[0]).shown.max()) == 255
    make_plates(candidate, seconds=60, distrust=True)
    assert len(Painter.seen) == 1 + 3 + 1


def speckled(candidate: Candidate, share: float) -> Any:
    """White in a share of the pixels, black elsewhere; shape (height, width, 1)."""
    width, height = plate_size(candidate.spec.look)
    return np.where(np.random.default_rng(0).random((height, width, 1)) < share, 255, 0)


@pytest.mark.parametrize(
    ("program", "there", "here", "departs"),
    [
        ("painter", 1.0, 1.0, False),
        ("painter", 1.0, 0.88, True),
        ("other", 1.0, 0.88, False),
        ("other", 1.0, 0.4, True),
        ("other", 0.35, 0.35, False),
        ("other", 0.35, 0.15, True),  # a fifth differs, but the subject is seen there and not here
    ],
)
def test_a_plate_of_another_program_may_depart_by_more_and_must_show_its_subject(
    candidate: Candidate,
    painter: type[Painter],
    program: str,
    there: float,
    here: float,
    departs: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    painter.level = speckled(candidate, there)
    made = make_plates(candidate, seconds=60)
    monkeypatch.setattr("worldagent.rendering.renderer_versions", lambda: {"source": program})
    painter.level = speckled(candidate, here)
    assert [depart(candidate, made, v) for v in made.views] == [departs] * 3


def test_without_a_renderer_every_subject_is_left_with_the_reason(candidate: Candidate, painter: type[Painter]) -> None:
    painter.fails = staticmethod(lambda view: EngineError("no LLVM"))
    made = make_plates(candidate, seconds=60)
    assert made.views == ()
    assert set(made.left) == set(BALLS)
    rows = check(candidate)
    assert {r.status for r in rows} == {"unverified"}
    assert {"no LLVM" in r.evidence["explanation"] for r in rows} == {True}


def test_a_subject_that_cannot_be_left_out_is_told(candidate: Candidate, painter: type[Painter]) -> None:
    def fails(view: View) -> Exception | None:
        return InputError("it is drawn with its landscape") if view.subject == "b" else None

    painter.fails = staticmethod(fails)
    made = make_plates(candidate, seconds=60)
    assert [v.subject for v in made.views] == ["a", "c"]
    assert statuses(candidate) == {"a-rolls": "pass", "b-rolls": "unverified", "c-rolls": "pass"}


def test_a_world_without_beats_to_be_seen_has_an_index_and_no_plates(candidate: Candidate) -> None:
    story = candidate.spec.story.model_copy(update={"beats": {}})
    bare = dataclasses.replace(candidate, spec=candidate.spec.model_copy(update={"story": story}))
    assert make_plates(bare, seconds=60).views == ()
    assert isinstance(Plates.open(plates_folder(bare)), Plates)
    assert check(bare) == []


def test_an_acceptance_looks_longer_than_a_check(candidate: Candidate, monkeypatch: pytest.MonkeyPatch) -> None:
    """It renders plates that a check had no time for: judged without, its verdict is worth nothing."""
    given: list[tuple[float, bool]] = []
    monkeypatch.setattr(plates, "make_plates", lambda _, *, seconds, distrust, **__: given.append((seconds, distrust)))
    session = SimpleNamespace(ledger=SimpleNamespace(bake=lambda freeze: {"detail": {"seconds": 4000.0}}))
    work: Any = SimpleNamespace(session=session, freeze="f", candidate=lambda stage: candidate)
    quiet: Any = SimpleNamespace(progress=lambda *_: None, check=lambda: None)
    jobs.plates_of(work, quiet)
    jobs.plates_of(work, quiet, distrust=True)
    assert given == [(400.0, False), (800.0, True)]


@pytest.mark.parametrize(
    ("bake", "seconds"), [(None, LEAST_S), ({"detail": {}}, LEAST_S), ({"detail": {"seconds": 4000.0}}, 400.0)]
)
def test_looking_may_take_a_tenth_of_the_bake_and_never_less_than_a_minute(bake: Any, seconds: float) -> None:
    assert allowed_seconds(bake) == seconds
    assert LEAST_S == 60
    assert pytest.approx(0.1) == plates.SHARE_OF_BAKE


# ---------------------------------------------------------------- pictures of a review


def test_pictures_of_a_review_are_plates_where_there_are_any(candidate: Candidate, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[int] = []

    def preview(candidate: Candidate, frame: int, *, width: int, height: int, **_: Any) -> Any:
        drawn.append(frame)
        return np.zeros((height, width, 3), np.uint8)

    monkeypatch.setattr("worldagent.rendering.preview", preview)
    monkeypatch.setattr("worldagent.rendering.PreviewRenderer", lambda candidate: None)
    assert plate_pictures(candidate) == {}
    bare = pictures_of(candidate)
    assert [p.frame for p in bare] == drawn
    made, drawn[:] = make_plates(candidate, seconds=60), []
    assert list(plate_pictures(candidate)) == list(made.views)
    pictures = {view.frame: picture for view, picture in plate_pictures(candidate).items()}
    assert all(p.shape == (*plate_size(candidate.spec.look)[::-1], 3) and (p == 255).all() for p in pictures.values())
    told = pictures_of(candidate)
    shown = {p.frame for p in told}
    assert shown & set(pictures)
    assert drawn == [p.frame for p in told if p.frame not in pictures]
    assert {0, candidate.last_frame} <= shown
    assert len(frames_to_show(candidate, list(range(1, 24)))) == MOST_PICTURES


@pytest.mark.parametrize("what", ["stale", "damaged"])
def test_plates_of_another_bake_or_damaged_ones_are_no_pictures(candidate: Candidate, what: str) -> None:
    made, folder = make_plates(candidate, seconds=60), plates_folder(candidate)
    if what == "stale":
        dataclasses.replace(made, cache="another").write(folder)
    else:
        (folder / "frame_000000.npz").write_bytes(b"none")
    assert plate_pictures(candidate) == {}


@pytest.mark.parametrize(("wall", "worked", "over"), [(1000.0, 10.0, False), (10.0, 1000.0, False), (1000.0, 1000.0, True)])
def test_time_for_plates_is_that_of_the_processors_where_the_machine_has_other_work(
    wall: float, worked: float, over: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = plates._Clock(60.0, None, lambda: None)
    now, used = time.monotonic(), time.process_time()
    monkeypatch.setattr(time, "monotonic", lambda: now + wall)
    monkeypatch.setattr(time, "process_time", lambda: used + worked)
    assert clock.over() is over
