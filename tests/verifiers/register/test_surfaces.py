"""The register tells of drawn parts and proxy colliders: fine ones of all bodies in one line, coarse ones by body, the worst first."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from worldagent.testing.worlds.small_worlds import box, ground, make_candidate, world
from worldagent.verifiers.register.surfaces import surface_lines
from worldagent.worlds.candidate import Candidate


def _candidate(folder: Path, deviations: dict[str, tuple[float, float]]) -> Candidate:
    entities = {name: box(0.1, 0.1, 0.1, at=(k, 0, 1), motion="dynamic") for k, name in enumerate(deviations)}
    candidate = make_candidate(folder, world({"floor": ground(), **entities}), stage="full")
    for name, deviation in deviations.items():
        built = candidate.built[name]
        parts = tuple(replace(part, deviation=deviation) for part in built.parts)
        candidate.built[name] = replace(built, parts=parts)  # type: ignore[index]
    return candidate


def test_many_fine_colliders_are_one_line_with_the_largest_figures(tmp_path: Path) -> None:
    fine = {f"b{k}": (1e-5 * (k + 1), 2e-6) for k in range(5)}
    lines = list(surface_lines(_candidate(tmp_path, {**fine, "rough": (0.004, 0.002), "exact": (0.0, 0.0)})))
    assert [line["what"] for line in lines] == [
        "proxy collider of rough/p0",
        "proxy colliders of 5 parts (b4/p0, b3/p0, b2/p0 and 2 more)",
    ]
    assert lines[0]["effect"] == "collision surface up to 0.004 m outside and 0.002 m inside the visible one"
    assert lines[1]["effect"] == "collision surface up to 5e-05 m outside and 2e-06 m inside the visible one"


def test_drawn_parts_of_a_body_are_one_line(tmp_path: Path) -> None:
    spec = world({"floor": ground(), "a": box(0.1, 0.1, 0.1, at=(0, 0, 1), motion="dynamic")})
    part = spec.entities["a"].parts["p0"]
    drawn = part.model_copy(update={"collides": False})
    for count, said in ((1, "part a/q0 is drawn only"), (5, "5 parts of 'a' are drawn only (q0, q1, q2 and 2 more)")):
        parts = {"p0": part, **{f"q{k}": drawn for k in range(count)}}
        entity = spec.entities["a"].model_copy(update={"parts": parts})
        changed = spec.model_copy(update={"entities": {**spec.entities, "a": entity}})
        candidate = make_candidate(tmp_path / str(count), changed, stage="full")
        assert said in [line["what"] for line in surface_lines(candidate)]
