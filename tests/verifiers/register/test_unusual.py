"""Unusual things stand beside the verdict: nothing is said of an ordinary world, and each of them of one that has it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import MATERIALS, Touch, ball, box, ground, make_candidate, world
from worldagent.verifiers.categories.rigid.register import _meeting
from worldagent.verifiers.register.frictions import friction_lines
from worldagent.verifiers.register.unusual import unusual
from worldagent.worlds.materials import material_table
from worldagent.worlds.predicates import Contact
from worldagent.worlds.spec import Beat, ContactPair, Interacts, Material, Requirement, Story, WorldSpec
from worldagent.worlds.verdicts import unusual_told

CRATE = {"crate": box(0.1, 0.1, 0.1, at=(0, 0, 0.05), motion="dynamic"), "floor": ground()}


def lines(
    folder: Path, entities: dict[str, Any] | None = None, *, moved: Any = None, touches: Any = (), **more: Any
) -> list[str]:
    contacts = more.pop("contacts", {})
    spec = world(entities or CRATE, **more)
    spec = spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"contacts": contacts})})
    return unusual(make_candidate(folder, spec, tracks=moved, touches=touches, records={"driver_work": 0.0}))


def beat(impulse: float) -> Beat:
    touch = Contact(kind="contact", a="crate", b="floor", min_impulse=impulse)
    return Beat(text="it touches", owner="rigid", subject="crate", frames=(0, 3), predicate=touch)


def test_an_ordinary_world_has_nothing_unusual(tmp_path: Path) -> None:
    assert lines(tmp_path, beats={"hit": beat(0.1)}) == []
    assert unusual_told({"unusual": []}) == unusual_told({}) == {}


@pytest.mark.parametrize(
    ("gravity", "said"),
    [
        ((0.0, 0.0, -1.62), "gravity of 1.62 m/s^2"),
        ((1.0, 0.0, -9.76), "degrees off straight down"),
        ((0.0, 0.0, 0.0), "gravity of 0 m/s^2"),
    ],
)
def test_gravity_that_is_not_the_earth_s_is_unusual(gravity: tuple[float, float, float], said: str, tmp_path: Path) -> None:
    (line,) = lines(tmp_path, gravity=gravity)
    assert said in line


def test_what_hardly_loses_energy_in_a_bounce_is_unusual(tmp_path: Path) -> None:
    lively = ContactPair(a="crate", b="floor", restitution=0.96, reason="a magnet under the floor")
    (line,) = lines(tmp_path / "lively", contacts={"pair": lively})
    assert "with a restitution of 0.96" in line
    assert lines(tmp_path / "dull", contacts={"pair": lively.model_copy(update={"restitution": 0.9})}) == []


def of(material: str, **more: Any) -> Any:
    """A marble that another can meet."""
    return ball(0.02, material=material, at=(0, 0, 0.02), **{"motion": "dynamic", **more})


def glass(restitution: float = 0.97, row: str | None = None) -> Material:
    return Material(density=2500, restitution=restitution, of=row)


DULL = Material(density=700, restitution=0.4)


def said(folder: Path, materials: dict[str, Material], *bodies: Any, **more: Any) -> list[str]:
    entities = {f"body-{k}": body for k, body in enumerate(bodies)}
    return lines(folder, entities, materials={**MATERIALS, **materials}, **more)


def test_a_lively_material_is_unusual_only_beside_another_that_it_can_meet(tmp_path: Path) -> None:
    """Two materials in touch have the smaller restitution of the two."""
    known = {"clear": glass(), "superball": glass(0.98), "board": DULL}
    assert said(tmp_path / "alone", known, of("clear"), of("board", motion="static")) == []
    (line,) = said(tmp_path / "like", known, of("clear"), of("clear"), of("board", motion="static"))
    assert line.startswith("material 'clear' has a restitution of 0.97")
    (line,) = said(tmp_path / "two", known, of("clear"), of("superball", motion="static"))
    assert line.startswith("materials 'clear' and 'superball' have together a restitution of 0.97")
    still = of("clear", motion="static")
    assert said(tmp_path / "still", known, still, still) == []


def test_a_restitution_of_the_table_is_not_unusual(tmp_path: Path) -> None:
    row = next(
        n for n, r in material_table().materials.items() if r.figures.get("restitution") and r.figures["restitution"].holds(0.97)
    )
    table, above = glass(row=row), glass(1.0, row=row)
    assert said(tmp_path / "table", {"clear": table}, of("clear"), of("clear")) == []
    (line,) = said(tmp_path / "above", {"clear": above}, of("clear"), of("clear"))
    assert "restitution of 1:" in line
    (line,) = said(tmp_path / "one", {"clear": table, "own": glass()}, of("clear"), of("own"))
    assert "'clear' and 'own'" in line


def test_a_pair_of_its_own_stands_for_its_materials(tmp_path: Path) -> None:
    damped = ContactPair(a="body-0", b="body-1", restitution=0.5, reason="felt between the two")
    assert said(tmp_path, {"clear": glass()}, of("clear"), of("clear"), contacts={"pair": damped}) == []


def test_a_touch_of_any_strength_is_unusual_unless_it_is_denied(tmp_path: Path) -> None:
    (line,) = lines(tmp_path / "beat", beats={"hit": beat(0.0)})
    assert line == "beat 'hit' is met by any touch of 'crate' and 'floor', however faint: its min_impulse is 0"
    apart = Requirement(text="they touch", predicate=beat(0.0).predicate, never=True)
    assert lines(tmp_path / "never", story=Story(requirements={"apart": apart})) == []


def test_a_body_on_a_path_that_pushes_another_is_unusual(tmp_path: Path) -> None:
    bodies = {**CRATE, "hand": box(0.1, 0.1, 0.1, at=(-0.3, 0, 0.05), motion="kinematic")}
    way = np.linspace((-0.3, 0, 0.05), (0.0, 0, 0.05), 10)
    found = lines(
        tmp_path,
        bodies,
        frames=10,
        moved={"hand": (way, np.tile((1.0, 0, 0, 0), (10, 1)))},
        touches=[Touch(4, "hand", "crate", 0.2)],
    )
    assert any("'hand' on its authored path pushes 'crate'" in line for line in found)


def surface(spec: WorldSpec, **materials: Any) -> list[str]:
    return list(friction_lines(spec.model_copy(update={"materials": {**spec.materials, **materials}})))


@pytest.mark.parametrize(
    ("substance", "density", "field", "usual", "odd"),
    [
        ("steel", 7850, "friction", 0.3, 0.0),
        ("wood", 600, "friction", 0.4, 4.0),
        ("stone", 2600, "friction", 0.6, 0.0),
        ("wood", 600, "restitution", 0.4, 1.0),
    ],
)
def test_a_surface_unlike_its_substance_is_unusual(substance: str, density: float, field: str, usual: float, odd: float) -> None:
    spec = world(CRATE)
    used = spec.entities["crate"].material
    asked = {"substance": substance, "density": density, "friction": 0.5}
    assert surface(spec, **{used: Material.model_validate({**asked, field: usual})}) == []
    (line,) = surface(spec, **{used: Material.model_validate({**asked, field: odd, "departs": "waxed and polished"})})
    assert f"a {field} of {odd:g}" in line
    assert "waxed and polished" in line


def test_a_ball_that_stays_on_a_steep_slope_is_unusual() -> None:
    spec = world({"marble": ball(0.06, at=(0, 0, 0.06), motion="dynamic"), "floor": ground()})
    used = spec.entities["marble"].material
    one = spec.materials[used]
    assert surface(spec, **{used: one.model_copy(update={"rolling_friction": 0.003})}) == []
    (line,) = surface(spec, **{used: one.model_copy(update={"rolling_friction": 0.1})})
    assert "slopes of up to 59 degrees" in line


def test_the_register_names_the_pair_of_materials_that_meets() -> None:
    spec = world(
        {
            "brick": box(0.1, 0.1, 0.1, at=(0, 0, 0.05), motion="dynamic"),
            "other": box(0.1, 0.1, 0.1, at=(1, 0, 0.05), motion="dynamic"),
            "floor": ground(),
        }
    )
    rough, smooth, base = (next(iter(spec.materials.values())).model_copy(update={"friction": f}) for f in (4.0, 0.1, 0.3))
    used = {"rough": rough, "smooth": smooth, "base": base}
    made = {"brick": "rough", "other": "smooth", "floor": "base"}
    entities = {
        n: e.model_copy(
            update={"material": made[n], "parts": {k: p.model_copy(update={"material": None}) for k, p in e.parts.items()}}
        )
        for n, e in spec.entities.items()
    }
    stands = {"a": Interacts(kind="interacts", a="brick", b="floor"), "b": Interacts(kind="interacts", a="other", b="floor")}
    spec = spec.model_copy(
        update={"entities": entities, "materials": used, "graph": spec.graph.model_copy(update={"relations": stands})}
    )
    instance = next(iter(spec.simulation.rigid.values()))
    assert _meeting(spec, instance, used) == [("base", "rough"), ("base", "smooth")]
    apart = spec.model_copy(update={"graph": spec.graph.model_copy(update={"relations": {}})})
    assert ("rough", "smooth") in _meeting(apart, instance, used)
