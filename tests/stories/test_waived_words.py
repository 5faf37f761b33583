"""A world of whose words too many are waived is told as `incomplete` by every tool that looks at it, and neither judged nor filmed."""

from __future__ import annotations

from typing import Any

from worldagent.tests.stories.small_run import MARKED

WAIVED = MARKED.replace("into a row of", '[into a row of](waived because="left to the film")').replace(
    "The last", '[The last](waived because="left to the film")'
)


def test_too_much_that_is_waived_is_incomplete_and_closes_acceptance_and_film(accepted: Any) -> None:
    before = accepted.call("inspect_world", world="w")["last_verdict"]["says"]
    assert before == "accepted, prompt read by nobody"
    told = accepted.call("edit_spec", world="w", claims=WAIVED)
    said = "27% of the prompt's letters are waived, at most 20% may be: the world is incomplete; claim more of them"
    (row,) = told["audit"]["open_rows"]
    assert (row["id"], row["why"]) == ("audit:claims", f"/claims: {said}")
    assert row["id"] in accepted.call("inspect_world", world="w")["open_rows"]
    assert said in accepted.refused("run_checks", world="w", scope="acceptance")
    assert "not accepted" in accepted.refused("render_shot", world="w", kind="final")
    less = MARKED.replace("The last", '[The last](waived because="left to the film")')
    assert accepted.call("edit_spec", world="w", claims=less)["audit"]["passed"]
