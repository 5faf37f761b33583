"""A contact log in which one impulse, force or event was edited contradicts itself; logs of real motions do not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects import _scenes
from worldagent.verifiers.contact.log import Fault, log_fault

DURATION, STEP = 1.0 / 24.0, 0.002
Log = list[dict[str, Any]]
SCENES = ("thrown_pair", "bounce", "stack", "pushed", "pile", "slide", "roped")


def _asleep(film: Any) -> list[frozenset[int]]:
    colliders = film.index.colliders
    owners = [colliders.index(b.split("/", 1)[0]) for b in film.index.bodies]
    return [frozenset(o for o, s in zip(owners, f["asleep"], strict=True) if s) for f in film.frames]


def _rough(film: Any) -> Any:
    """All materials of these scenes rub alike."""
    count = len(film.index.colliders)
    return np.full((count, count), max(m.friction for m in film.spec.materials.values()))


def _judged(film: Any) -> Fault | None:
    return log_fault(film.frames, DURATION, _asleep(film), STEP, _rough(film))


def _blow(film: Any) -> tuple[int, int]:
    """The first frame after the start in which a contact begins, and its row in the log."""
    for k, frame in enumerate(film.frames):
        before = [] if k == 0 else film.frames[k - 1]["contact/pair"].tolist()
        for row, pair in enumerate(frame["contact/pair"].tolist()):
            if k > 1 and pair in frame["event/pair"].tolist() and pair not in before:
                return k, row
    raise AssertionError("nothing begins to touch")


@pytest.mark.parametrize("variant", [0, 1])
@pytest.mark.parametrize("scene", SCENES)
def test_a_real_log_agrees_with_itself(scene: str, variant: int) -> None:
    assert _judged(getattr(_scenes, scene)(variant)) is None


@pytest.mark.parametrize("times", [50.0, 1.2, 1.001])
@pytest.mark.parametrize("scene", ["thrown_pair", "bounce"])
def test_an_impulse_of_a_blow_that_was_made_larger_is_found(scene: str, times: float) -> None:
    film = getattr(_scenes, scene)(0)
    k, row = _blow(film)
    film.frames[k]["contact/impulse"][row] *= times
    found = _judged(film)
    assert found is not None
    assert (found.frame, list(found.pair)) == (k, film.frames[k]["contact/pair"][row].tolist())
    assert found.measured == pytest.approx(film.frames[k]["contact/impulse"][row])


def test_an_impulse_at_rest_that_was_made_larger_is_found() -> None:
    """Nothing begins there: what a force may give in a frame bounds it, to the body that rests on something static too."""
    film = _scenes.slide(0)
    k = next(k for k in range(2, len(film.frames)) if len(film.frames[k]["contact/impulse"]))
    film.frames[k]["contact/impulse"] *= 50.0
    found = _judged(film)
    assert found is not None
    assert (found.frame, found.text) == (k, "its impulse is more than its largest force gives in a whole frame")


def _less(frame: dict[str, Any], row: int) -> None:
    frame["contact/impulse"][row] *= 0.5


def _no_event(frame: dict[str, Any], row: int) -> None:
    keep = (frame["event/pair"] != frame["contact/pair"][row]).any(axis=1)
    for name in [n for n in frame if n.startswith("event/")]:
        frame[name] = frame[name][keep]


def _another_event(frame: dict[str, Any], row: int) -> None:
    for name in [n for n in frame if n.startswith("event/")]:
        frame[name] = np.concatenate([frame[name], frame[name][-1:]])
    frame["event/pair"][-1] = (0, 0)


def _no_contact(frame: dict[str, Any], row: int) -> None:
    for name in [n for n in frame if n.startswith("contact/")]:
        frame[name] = np.delete(frame[name], row, axis=0)


@pytest.mark.parametrize(
    ("edit", "text"),
    [
        (_less, "more impulse than its contact"),
        (_no_event, "no event tells"),
        (_another_event, "not in the log"),
        (_no_contact, "not in the log"),
    ],
)
def test_a_log_with_something_taken_out_or_put_in_is_found(edit: Callable[[dict[str, Any], int], None], text: str) -> None:
    film = _scenes.bounce(0)
    k, row = _blow(film)
    edit(film.frames[k], row)
    found = _judged(film)
    assert found is not None
    assert found.frame == k
    assert text in found.text


def test_what_a_contact_gives_lies_within_its_cone_of_friction() -> None:
    film = _scenes.slide(0)
    k = next(k for k in range(2, film.count) if len(film.frames[k]["contact/vector"]))
    log = film.frames[k]
    sideways = np.array(log["contact/vector"])
    sideways[0, :2] *= 1.1  # it slides: the friction is on the cone
    log["contact/vector"] = sideways
    found = _judged(film)
    assert found is not None
    assert (found.frame, found.text) == (k, "it gives more than its normal impulse and friction allow")
