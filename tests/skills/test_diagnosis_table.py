"""The diagnosis tables: their form, the tools they name, and that every number they look at really is in such rows."""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, get_args

import numpy as np
import pytest
from worldagent.construction import build_entity
from worldagent.server.skill_files import SKILLS
from worldagent.testing.defects import _liquid_resolution as liquid_resolution
from worldagent.testing.defects import _liquid_scenes as liquid_scenes
from worldagent.testing.defects._films import film_of
from worldagent.testing.defects._gas_scenes import scene as gas_scene
from worldagent.testing.defects.suites import CHECKS, suite_of
from worldagent.testing.worlds.event_worlds import event_world
from worldagent.testing.worlds.small_worlds import IDENTITY, Event, Touch, ball, box, ground, make_candidate, world
from worldagent.tools import TOOLS
from worldagent.verifiers.categories import check as category
from worldagent.verifiers.checks import run_checks
from worldagent.verifiers.contact import check as contact
from worldagent.verifiers.diagnosis.table import Condition, Entry, entries, table_schema
from worldagent.verifiers.story import beats, causal, counterfactual, phases
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.groups import GROUPS
from worldagent.worlds.predicates import Contact, Displacement, Reaches, Tilts, Topples, TouchEvent
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, Bond, BoxRegion, Breakable, BrickPattern, CameraKey, Shot, Story

TABLE: list[Entry] = [entry for _, _, entry in entries()]
EASIER = {"story", "limits"}
PLACEHOLDERS = {
    "row", "entity", "other", "frame", "first", "last", "solver", "beat", "shot", "material", "striker", "driver", "tip", "support", "part",
    "relation", "rubs", "wind", "steady", "becalmed", "held", "free", "emitter", "grains", "flying", "emission",
    "follows", "jammed", "ends", "stands", "lies", "waves", "collides", "alone", "rests", "rolls",
}  # fmt: skip
"""Those that are filled from a row, and those that stay for the reader to fill."""


def test_ids_are_unique() -> None:
    assert len({e.id for e in TABLE}) == len(TABLE)


def test_the_schema_in_the_skill_is_that_of_the_model() -> None:
    assert json.loads((SKILLS / "repair" / "diagnosis.schema.json").read_text()) == table_schema()


@pytest.mark.parametrize("entry", TABLE, ids=lambda e: str(e.id))
def test_an_entry_has_evidence_a_probe_and_causes_of_existing_groups(entry: Entry) -> None:
    assert entry.evidence
    assert entry.cheapest_probe
    assert entry.causes or entry.id in ("summary", "follows-beat")
    for cause in entry.causes:
        assert cause.edit_class == GROUPS[cause.group].edit_class
        assert all(p.startswith("/") for p in cause.pointers)
        assert set(cause.needs) <= PLACEHOLDERS
        assert cause.weakens or cause.group not in {"limits"}
        for rule in cause.patch:
            given = [rule.value, rule.scale, rule.ratio, rule.plus, rule.toward]
            assert sum(g is not None for g in given) == 1, rule
            assert GROUPS[cause.group].edit_class != "story", "a table never suggests an easier story by itself"
    text = entry.model_dump_json()
    assert set(re.findall(r"<(\w+)>", text)) <= PLACEHOLDERS


@pytest.mark.parametrize("entry", TABLE, ids=lambda e: str(e.id))
def test_the_cheapest_probe_calls_a_tool_as_it_is(entry: Entry) -> None:
    known = {t.name: inspect.signature(t.function).parameters for t in TOOLS}
    assert entry.cheapest_probe
    for probe in entry.cheapest_probe:
        assert probe.tool in known
        assert probe.look_at
        for name, value in probe.arguments.items():
            assert name in known[probe.tool], (entry.id, probe)
            words = re.findall(r"'(\w+)'", str(known[probe.tool][name].annotation))
            if isinstance(value, str) and words and name in ("scope", "part", "kind", "stage"):
                assert value in words, (entry.id, probe)


def test_causes_that_ease_the_specification_say_so() -> None:
    easing = [(e, c) for e in TABLE if "audit" not in e.checks for c in e.causes if c.group in EASIER]
    assert easing, "no cause eases a specification: is the list of groups that do still right?"
    assert [f"{e.id}: {c.cause}" for e, c in easing if c.patch] == []


# ---------------------------------------------------------------- keys that really occur


def _beat(predicate: Any, subject: str, frames: tuple[int, int], causes: tuple[str, ...] = ()) -> Beat:
    return Beat(text="it happens", owner="rigid", subject=subject, frames=frames, predicate=predicate, causes=causes)


def _motion(folder: Path) -> Any:
    """A cube slides, a block stands, a ball comes late: beats of every kind that fail."""
    n = 25
    time = np.arange(n) / 24
    slide = np.stack([time, 0 * time, 0 * time + 0.1], axis=1)
    entities = {
        "floor": ground(),
        "cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1), velocity=(1, 0, 0)),
        "block": box(0.1, 0.1, 0.3, motion="dynamic", at=(3, 0, 0.15)),
        "ball": ball(0.1, motion="dynamic", at=(-3, 0, 0.1)),
    }
    aside = BoxRegion(min=(0.9, 0.3, 0), max=(1.5, 0.5, 0.5))
    story = {
        "aside": _beat(Reaches(entity="cube", region="aside"), "cube", (5, 24)),
        "late": _beat(Displacement(entity="cube", axis=(1, 0, 0), min=0.6), "cube", (2, 8)),
        "early": _beat(Displacement(entity="cube", axis=(1, 0, 0), min=0.2), "cube", (10, 10)),
        "short": _beat(Displacement(entity="cube", axis=(1, 0, 0), min=5.0), "cube", (2, 24)),
        "falls": _beat(Topples(entity="block", min_angle=1.0), "block", (2, 24), ("aside",)),
        "leans": _beat(Tilts(entity="block", min=0.5), "block", (2, 24)),
        "touch": _beat(Contact(a="cube", b="ball", min_impulse=1.0), "ball", (2, 20), ("slides",)),
        "bump": _beat(Contact(a="cube", b="floor", min_impulse=99.0), "cube", (2, 20)),
        "slides": _beat(Displacement(entity="cube", axis=(1, 0, 0), min=0.3), "cube", (2, 24)),
        "before": _beat(Displacement(entity="cube", axis=(1, 0, 0), min=0.1), "cube", (2, 24), ("slides",)),
        "apart": _beat(Displacement(entity="block", axis=(1, 0, 0), min=0.01), "block", (1, 24), ("slides",)),
    }
    moved = np.stack([3 + 0.02 * (time > 0.6), 0 * time, 0 * time + 0.15], axis=1)
    spec = world(entities, regions={"aside": aside}, frames=n, story=Story(beats=story))
    touches = [Touch(k, "cube", "floor", impulse=0.01) for k in range(3, 9)]
    return make_candidate(
        folder,
        spec,
        tracks={"cube": (slide, IDENTITY), "block": (moved, IDENTITY)},
        events=[Event(0.1, "cube", "floor")],
        touches=touches,
    )


def _pauses(folder: Path) -> Any:
    """A cube slides, rests and slides on; nothing else moves, so phases are missing."""
    n = 25
    x = np.concatenate([np.linspace(0, 0.3, 6), np.full(12, 0.3), np.linspace(0.3, 0.8, 7)])
    entities = {"floor": ground(), "cube": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1))}
    story = {
        "starts": _beat(Displacement(entity="cube", axis=(1, 0, 0), min=0.2), "cube", (1, 24)),
        "goes_on": _beat(Displacement(entity="cube", axis=(1, 0, 0), min=0.6), "cube", (1, 24), ("starts",)),
    }
    spec = world(entities, frames=n, story=Story(beats=story))
    return make_candidate(folder, spec, tracks={"cube": (np.stack([x, 0 * x, 0 * x + 0.1], axis=1), IDENTITY)})


def _pressed(folder: Path) -> Any:
    """A ball presses into the floor that it touches."""
    z = np.concatenate([np.linspace(0.3, 0.098, 5), np.full(4, 0.098)])
    entities = {"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.3))}
    spec = world(entities, frames=len(z))
    touches = [Touch(k, "ball", "floor", min_gap=-0.002) for k in range(4, 9)]
    return make_candidate(folder, spec, tracks={"ball": (np.stack([0 * z, 0 * z, z], axis=1), IDENTITY)}, touches=touches)


def _squeezed(folder: Path) -> Any:
    """A brick of a wall that lies in the next one."""
    broken = Breakable(pattern=BrickPattern(size=(0.2, 0.1, 0.1)), bond=Bond(tension=1e5, shear=1e5))
    wall = box(0.6, 0.1, 0.3, motion="dynamic", at=(0, 0, 0.151)).model_copy(update={"breakable": broken})
    spec = world({"floor": ground(), "wall": wall}, frames=3)
    built = build_entity(spec, "wall", folder)
    moved = np.add(built.bodies[0].pose.position, (0, 0, 0.151)) + np.outer([0, 1, 1], (0.02, 0, 0))
    tracks = {f"wall/{built.bodies[0].name}": (moved, IDENTITY)}
    return make_candidate(folder, spec, tracks=tracks, built={"wall": built})


def _capped(folder: Path) -> Candidate:
    """A liquid whose pressure solves all end at their cap."""
    flow = liquid_scenes.pool(np.random.default_rng(3))
    return flow.edited(change={(4, "record/iterations_capped"): np.array(200.0)}).candidate(folder)


def _clings(folder: Path) -> Candidate:
    """Water that stays on a wall."""
    return liquid_resolution.clinging(folder, 9.0, np.random.default_rng(100)).candidate


def _dribbles(folder: Path) -> Candidate:
    """An inflow narrower than is resolved."""
    return liquid_resolution.tight_tap(folder, 2.0, np.random.default_rng(3)).candidate


def _seeps(folder: Path) -> Candidate:
    """A tank with a slot narrower than a spacing."""
    return liquid_resolution.slot(folder, 0.004, np.random.default_rng(3)).candidate


def _fades(folder: Path) -> Candidate:
    """Smoke that the picture does not hold."""
    base = gas_scene("hot")
    spec = base.spec.model_copy(deep=True)
    key = CameraKey(frame=0, position=(0, -2, 0.3), target=(0, 0, 9.0), fov_deg=40)
    spec.shots["side"] = Shot(frames=(0, base.last_frame), covers=[], intent="smoke", keys={"a": key})
    return Candidate(base.folder, spec, base.built, base.stage, base.caches)


def _rocks(folder: Path) -> Candidate:
    """A slab that rocks on its edge and does not tip."""
    spec = event_world("rock")
    frames = (0, spec.simulation.frames - 1)
    beat = Beat(text="it tips", owner="rigid", subject="slab", frames=frames, predicate=TouchEvent(kind="tips", entity="slab"))
    return film_of(spec.model_copy(update={"story": Story(beats={"tip": beat})})).candidate(folder)


OWN: dict[str, list[tuple[Callable[[Path], Candidate], Callable[[Candidate], list[Row]]]]] = {
    "category": [(_fades, category.check), (_clings, category.check), (_dribbles, category.check), (_seeps, category.check)],
    "beat": [(_motion, beats.check), (_motion, phases.check), (_pauses, phases.check), (_rocks, beats.check)],
    "causal": [(_motion, causal.check), (_pauses, causal.check), (_motion, counterfactual.check)],
    "contact": [(_pressed, contact.check), (_squeezed, contact.check)],
    "numerical": [(_capped, category.check_numerical)],
}
"""Worlds of this file, before those of the check's suite of defects."""


class _Rows:
    """Open rows of a check, from worlds that are broken on purpose; worlds are made as they are asked for."""

    def __init__(self, check: str) -> None:
        self.seen: list[Row] = []
        self.more = self._make(check)

    def __iter__(self) -> Iterator[Row]:
        yield from list(self.seen)
        for row in self.more:
            self.seen.append(row)
            yield row

    @staticmethod
    def _make(check: str) -> Iterator[Row]:
        for build, judge in OWN.get(check, ()):
            with TemporaryDirectory() as folder:
                yield from [r for r in judge(build(Path(folder))) if r.status in ("fail", "unverified")]
        if check not in CHECKS:
            return
        for mechanism in suite_of(check).of(broken=True):
            with TemporaryDirectory() as folder:
                built = mechanism.build(Path(folder), mechanism.high, np.random.default_rng(1))
                yield from [r for r in run_checks(built.candidate, only=[check]) if r.status in ("fail", "unverified")]


_rows = cache(_Rows)


def _keys(entry: Entry) -> set[str]:
    conditions: list[Condition] = [*entry.when, *(c for cause in entry.causes for c in (*cause.when, *cause.unless))]
    rules = [r for cause in entry.causes for r in cause.patch]
    named = (
        [c.key for c in conditions]
        + [c.than for c in conditions]
        + [k for r in rules for k in (r.ratio or ())]
        + [r.plus for r in rules]
    )
    return {k for k in named if k is not None}


LOOKED_AT = [(check, entry.id, key) for entry in TABLE for check in entry.checks for key in sorted(_keys(entry))]
SIMULATED = {"robustness"}
"""Its rows come from further simulations: tests/verifiers/story/test_robustness.py looks at them."""


@pytest.mark.parametrize(
    ("check", "entry", "key"), [i for i in LOOKED_AT if i[2].startswith("evidence.") and i[0] not in SIMULATED]
)
def test_evidence_that_ranks_causes_occurs_in_rows_of_that_check(check: str, entry: str, key: str) -> None:
    pattern, statuses = next((re.compile(e.row_pattern), e.statuses) for e in TABLE if e.id == entry)
    first, *rest = key.removeprefix("evidence.").split(".")
    values = (r.evidence.get(first) for r in _rows(check) if r.status in statuses and pattern.match(r.id))
    found = next((v for v in values if v is not None), None)
    assert found is not None, f"no open row of {check} that {entry} speaks of has {key}"
    assert isinstance(found, list) or not rest


@pytest.mark.parametrize(("entry", "key"), sorted({(e, k) for _, e, k in LOOKED_AT if not k.startswith("evidence.")}))
def test_other_keys_are_fields_of_a_row(entry: str, key: str) -> None:
    first, *rest = key.split(".")
    assert first in Row.model_fields
    assert not rest or (first == "frames" and rest[0] in "01")


def test_comparisons_fit_their_values() -> None:
    conditions = [(e.id, c) for e in TABLE for c in (*e.when, *(c for cause in e.causes for c in (*cause.when, *cause.unless)))]
    assert conditions
    for where, condition in conditions:
        if condition.compare in ("present", "absent"):
            assert condition.value is None, where
            assert condition.than is None, where
        else:
            assert (condition.value is None) != (condition.than is None), where
            if condition.compare in get_args(Condition.model_fields["compare"].annotation)[2:6]:
                assert not isinstance(condition.value, str), where
