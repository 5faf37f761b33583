"""Two static faults in a row: the second edit tests the first one by itself, and needs no call in between."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from worldagent.tests.stories.small_run import PROMPT, small_spec

Patch = Callable[..., list[dict[str, Any]]]
SIZE = "/entities/b1/dimensions/size"
TOO_SMALL = "the declared size is a slip of the pen"


def test_an_edit_after_a_static_fault_is_not_refused_for_a_test_that_takes_a_second(agent: Any, patch: Patch) -> None:
    spec = small_spec()
    right = spec["entities"]["b1"]["dimensions"]["size"]
    spec["entities"]["b1"]["dimensions"]["size"] = [2 * s for s in right]
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec)
    assert "scale:b1" in {row["id"] for row in agent.call("place_object", world="w")["open_rows"]}
    agent.call("edit_spec", world="w", patch=patch((SIZE, [1.5 * s for s in right])), hypothesis=TOO_SMALL)
    agent.call("edit_spec", world="w", patch=patch((SIZE, right)), hypothesis=TOO_SMALL)
    tested = agent.call("inspect_world", world="w", part="iterations")["iterations"]
    assert [(i["revision"], i.get("probe")) for i in tested] == [(3, None), (2, "static")]
    assert agent.call("place_object", world="w")["static_passed"]
    agent.call("edit_spec", world="w", patch=patch(("/entities/b2/physics/linear_velocity", [0.1, 0, 0])))
