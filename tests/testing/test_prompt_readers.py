"""Forms of forged and honest worlds for readers: how they are dealt, and what counts as caught."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from worldagent.bench.prompt_readers import Form, caught, figures, packs
from worldagent.worlds.errors import InputError


def form(name: str, world: str, *, forged: bool = True) -> Form:
    return Form(name, world, forged, right=2, prompts=6, spans=2)


def test_no_pack_holds_a_world_twice() -> None:
    dealt = packs([form("a", "x", forged=False), form("b", "y"), form("c", "x"), form("d", "x"), form("e", "y")])
    assert dealt == [["a", "b"], ["c", "e"], ["d"]]


@pytest.mark.parametrize(
    ("choice", "second", "expected"),
    [
        (2, "shown", (False, False)),
        (0, "shown", (True, False)),
        (3, "not shown", (True, False)),
        (2, "contradicted", (False, True)),
    ],
)
def test_another_prompt_and_a_contradicted_part_catch_a_world(choice: int, second: str, expected: tuple[bool, bool]) -> None:
    answers = json.dumps({"answers": {"1": "shown", "2": second}})
    assert caught(form("a", "x"), json.dumps({"prompt": choice}), answers) == expected


def test_an_answer_that_leaves_out_a_part_is_refused() -> None:
    with pytest.raises(InputError, match="2"):
        caught(form("a", "x"), '{"prompt": 2}', '{"answers": {"1": "shown"}}')


def test_figures_count_only_forms_that_were_read(tmp_path: Path) -> None:
    forms = [form("a", "x"), form("b", "x"), form("c", "x", forged=False)]
    (tmp_path / "key.json").write_text(json.dumps({"forms": [f._asdict() for f in forms]}))
    for name, choice in (("a", 0), ("c", 2)):
        place = tmp_path / "forms" / name
        place.mkdir(parents=True)
        (place / "choice.json").write_text(json.dumps({"prompt": choice}))
        (place / "spans.json").write_text(json.dumps({"answers": {"1": "shown", "2": "not shown"}}))
    found = figures(tmp_path)
    assert found["forged caught"]["read"] == 1
    assert found["forged caught"]["count"] == found["forged caught"]["by_choice"] == 1
    assert found["honest refused"]["read"] == 1
    assert found["honest refused"]["count"] == 0
    assert found["honest refused"]["interval_95"][1] == pytest.approx(0.975)
