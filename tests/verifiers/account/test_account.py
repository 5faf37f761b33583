"""The account of small worlds: what is in it, what is never in it, and that a broken world is told otherwise than a sound one."""

from __future__ import annotations

import random
import string
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import Event, Touch, ball, box, ground, make_candidate, world
from worldagent.verifiers.account.text import MOST_CHARACTERS, account_of
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.predicates.models import Displacement
from worldagent.worlds.spec import Appearance, Beat, ForceDriver, HingeJoint, Material, ReleaseDriver, Story, WorldSpec

FRAMES, FPS = 25, 24
NAMES = ("floor", "post", "sphere", "plank", "push", "hold", "pivot", "timber", "paint", "happens")
MATERIALS = {"red": (0.8, 0.02, 0.02), "brown": (0.2, 0.09, 0.03)}


def spec_of(names: Mapping[str, str], order: Sequence[str], text: str) -> WorldSpec:
    """A ball that is pushed over the floor against a post on a hinge, under given names and texts."""
    n = names
    materials = {
        n[own]: Material(density=600.0, substance="wood", appearance=Appearance(color=MATERIALS[look]))
        for own, look in (("timber", "brown"), ("paint", "red"))
    }
    entities = {
        n["floor"]: ground().model_copy(update={"material": n["timber"], "role": text}),
        n["post"]: box(0.1, 0.1, 0.6, motion="dynamic", at=(1.0, 0, 0.3), material=n["timber"]),
        n["sphere"]: ball(0.1, motion="dynamic", at=(0, 0, 0.1), material=n["paint"]),
        n["plank"]: box(0.5, 0.1, 0.05, motion="dynamic", at=(0, 2, 0.025), material=n["timber"]),
    }
    entities = {k: e.model_copy(update={"role": text}) for k, e in entities.items()}
    made = world(
        {n[k]: entities[n[k]] for k in order},
        materials=materials,
        drivers={
            n["push"]: ForceDriver(entity=n["sphere"], force=(3.0, 0, 0), start=0.1, end=0.4),
            n["hold"]: ReleaseDriver(entity=n["plank"], time=0.5),
        },
        joints={n["pivot"]: HingeJoint(child=n["post"], anchor=(1.0, 0, 0), axis=(0, 1, 0))},
        story=Story(beats={n["happens"]: _beat(n, text)}),
        frames=FRAMES,
    )
    return made.model_copy(update={"title": text, "prompt": text})


def _beat(n: Mapping[str, str], text: str) -> Beat:
    return Beat(
        text=text,
        owner=n["push"],
        subject=n["sphere"],
        frames=(1, 20),
        predicate=Displacement(entity=n["sphere"], min=0.5),
        causes=[],
    )


def candidate_of(
    folder: Path, names: Mapping[str, str], *, hit: bool = True, order: Sequence[str] = NAMES[:4], text: str = "A test."
) -> Candidate:
    """Hand-written motion: the ball rolls 0.85 m along x, or along y; where it meets the post, that tips by 90 degrees."""
    along = np.clip(np.linspace(-0.2, 1.2, FRAMES), 0.0, 0.85)
    way = np.zeros((FRAMES, 3))
    way[:, 0 if hit else 1], way[:, 2] = along, 0.1
    still = np.tile([1.0, 0, 0, 0], (FRAMES, 1))
    tip = np.clip(np.linspace(-2.0, 1.5, FRAMES), 0.0, 1.0) * np.pi / 2 if hit else np.zeros(FRAMES)
    turned = np.stack([np.cos(tip / 2), 0 * tip, np.sin(tip / 2), 0 * tip], axis=1)
    fallen = np.stack([1.0 + 0.3 * np.sin(tip), 0 * tip, 0.3 * np.cos(tip)], axis=1)
    n = names
    contacts = [Touch(k, n["floor"], n[thing], 0.1) for k in range(FRAMES) for thing in ("sphere", "post", "plank")]
    events = []
    if hit:
        contacts.append(Touch(19, n["post"], n["sphere"], 0.7))
        events.append(Event(18.5 / FPS, n["post"], n["sphere"], speed=1.4, impulse=0.7))
    spec = spec_of(names, order, text)
    tracks = {n["sphere"]: (way, still), n["post"]: (fallen, turned)}
    return make_candidate(folder, spec, tracks=tracks, touches=contacts, events=events)


SAME = dict(zip(NAMES, NAMES, strict=True))


def other_names(seed: int) -> tuple[dict[str, str], str]:
    """Names and a text of letters that no word of the account holds."""
    draw = random.Random(seed)
    word = ["".join(draw.choices(string.ascii_uppercase, k=3)) + "q" + str(draw.randrange(10**6)) for _ in range(len(NAMES) + 4)]
    return dict(zip(NAMES, word, strict=False)), " ".join(word[-4:])


def test_the_account_tells_things_causes_and_what_happens(tmp_path: Path) -> None:
    text = account_of(candidate_of(tmp_path, SAME)).text
    lines = text.splitlines()
    assert lines[0].startswith("4 things, 25 frames, 1 s; gravity 9.81 m/s^2 down")
    assert any(line.startswith("- ball B: 0.2 m, red, 0.2 m high, ") for line in lines)
    assert any(line.startswith("- box A: 0.6 x 0.1 x 0.1 m, brown, 0.6 m high, 3.6 kg, at (1, 0, 0.3)") for line in lines)
    assert "- box C: 0.5 x 0.1 x 0.05 m, brown, 0.05 m high, 1.5 kg, at (0, 2, 0.025)" in lines
    assert any(line.startswith("- box D: 10 x 10 x 0.2 m, brown, 0.2 m high, fixed") for line in lines)
    assert "- 0.10 to 0.40 s: a force pushes ball B: 3 N towards +x" in lines
    assert "- 0.50 s: box C, held until then, is let go" in lines
    assert "- box A turns on a hinge at a fixed point" in lines
    assert any("ball B goes 0.85 m towards +x" in line for line in lines)
    assert any("tips by 90 degrees" in line and "box A" in line for line in lines)
    assert "- 0.77 s: ball B hits box A at up to 1.4 m/s, 0.7 N s in all" in lines
    assert "- all the time: box C stays in place" in lines


def test_a_world_in_which_the_ball_misses_is_told_otherwise_in_the_lines_that_matter(tmp_path: Path) -> None:
    sound = account_of(candidate_of(tmp_path / "a", SAME)).text
    broken = account_of(candidate_of(tmp_path / "b", SAME, hit=False)).text
    assert "hits" in sound
    assert "tips by" in sound
    assert "towards +x" in sound
    assert "hits" not in broken
    assert "tips by" not in broken
    assert "goes 0.85 m towards +y" in broken
    assert "goes 0.85 m towards +x" not in broken


@pytest.mark.parametrize("seed", range(6))
def test_other_names_texts_and_order_give_the_same_bytes_and_none_of_them_is_told(seed: int, tmp_path: Path) -> None:
    names, text = other_names(seed)
    order = random.Random(seed).sample(NAMES[:4], 4)
    plain = account_of(candidate_of(tmp_path / "a", SAME)).text
    told = account_of(candidate_of(tmp_path / "b", names, order=order, text=text)).text
    assert told == plain
    words = [*names.values(), *text.split()]
    assert [word for word in words if word.lower() in told.lower()] == []


def test_the_same_candidate_gives_the_same_bytes_and_digest_every_time(tmp_path: Path) -> None:
    first = account_of(candidate_of(tmp_path, SAME))
    again = account_of(candidate_of(tmp_path / "again", SAME))
    assert (first.text, first.digest) == (again.text, again.digest)
    assert len(first.digest) == 64


def row_of_blocks(folder: Path, count: int, *, tipping: int) -> Candidate:
    """Blocks in a row of which the first ones tip over, one after the other, each against the next."""
    frames = 60
    blocks = {f"d{k}": box(0.02, 0.1, 0.2, motion="dynamic", at=(0.1 * k, 0, 0.1)) for k in range(count)}
    spec = world({"floor": ground(), **blocks}, frames=frames)
    tracks, events, contacts = {}, [], []
    for k in range(tipping):
        angle = np.clip((np.arange(frames) - 2 * k - 2) / 5, 0.0, 1.0) * 1.2
        turn = np.stack([np.cos(angle / 2), 0 * angle, np.sin(angle / 2), 0 * angle], axis=1)
        place = np.stack([0.1 * k + 0.1 * np.sin(angle), 0 * angle, 0.1 * np.cos(angle)], axis=1)
        tracks[f"d{k}"] = (place, turn)
        if k + 1 < count:
            events.append(Event((2 * k + 4) / FPS, f"d{k}", f"d{k + 1}", speed=0.8, impulse=0.05))
            contacts.append(Touch(2 * k + 4, f"d{k}", f"d{k + 1}", 0.05))
    return make_candidate(folder, spec, tracks=tracks, events=events, touches=contacts)


def test_many_alike_things_are_told_together_with_how_many_tip(tmp_path: Path) -> None:
    whole = account_of(row_of_blocks(tmp_path / "a", 12, tipping=12)).text
    stopped = account_of(row_of_blocks(tmp_path / "b", 12, tipping=7)).text
    assert "- box A1 to A12: each 0.2 x 0.1 x 0.02 m" in whole
    assert "12 of 12 move" in whole
    assert "12 tip by more than 45 degrees" in whole
    assert "7 of 12 move" in stopped
    assert "7 tip by more than 45 degrees" in stopped
    assert "box A1 to A12 among themselves meet in 11 pairs at up to 0.8 m/s, first A1 and A2" not in whole
    assert "box A1 to A12 among themselves meet in 11 pairs at up to 0.8 m/s, first box A1 and box A2 at 0.17" in whole


def test_what_does_not_fit_is_counted_and_the_text_stays_short(tmp_path: Path) -> None:
    sizes = np.random.default_rng(1).uniform(0.05, 0.3, size=(60, 3)).round(3)
    blocks = {f"b{k}": box(*map(float, s), motion="dynamic", at=(float(k), 0, float(s[2]) / 2)) for k, s in enumerate(sizes)}
    spec = world({"floor": ground(200.0), **blocks}, frames=10)
    moved = {f"b{k}": (np.linspace((k, 0, 0.5), (k, 0.4 + 0.01 * k, 0.5), 10), (1.0, 0, 0, 0)) for k in range(60)}
    found = account_of(make_candidate(tmp_path, spec, tracks=moved))
    assert len(found.text) <= MOST_CHARACTERS
    lines = found.text.splitlines()
    told = sum(line.startswith("- ") for line in lines)
    assert sum(found.left_out.values()) > 0
    # 61 things and 60 motions, each from the first frame on; nothing meets.
    assert told + sum(found.left_out.values()) == 61 + 60 + 60
    assert lines[-1] == "Left out: " + ", ".join(f"{count} lines of {name!r}" for name, count in found.left_out.items())


def test_before_any_simulation_things_and_drivers_are_told_alone(tmp_path: Path) -> None:
    spec = spec_of(SAME, NAMES[:4], "A test.")
    static = make_candidate(tmp_path, spec)
    text = account_of(static).text
    assert "4 things, 1 frames" in text
    assert "Time line" not in text
    assert "What acts:" in text


def test_the_specification_of_this_test_is_one_that_the_server_reads() -> None:
    spec = spec_of(SAME, NAMES[:4], "A test.")
    assert parse_spec(spec.model_dump(mode="json", exclude_none=True)) == spec
