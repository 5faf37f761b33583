"""Repairs of the scripted agent: from the rows that the server returns, and from nothing else.

The policy is generic. It goes through the open rows in the order of the loop (what is wrong upstream first), takes
the server's own suggested edit where there is one, and otherwise a rule for the kind of row, with the row's numbers.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import Any

__all__ = ["Edit", "missed_carrier", "propose"]

ORDER = (
    "audit",
    "scale",
    "interpenetration",
    "support",
    "navigability",
    "numerical",
    "contact",
    "category",
    "beat",
    "causal",
    "claim",
    "shots",
    "delivery",
)
"""Upstream first: a wrong size explains an overlap, an overlap explains a missing support, and so on."""

UNCLAIMED = re.compile(r"is told of '([^']+)', which no claim of a thing names")


@dataclass(frozen=True)
class Edit:
    """One proposed edit."""

    row: str
    hypothesis: str
    patch: list[dict[str, Any]]
    group: str


def _evidence(row: dict[str, Any]) -> dict[str, Any]:
    evidence = row.get("evidence", {})
    return evidence if isinstance(evidence, dict) else {}


def _claim(spec: dict[str, Any], row: dict[str, Any]) -> Edit | None:
    """Claim the words of things that events are told of: the last word of their role that stands in the prompt."""
    names = dict.fromkeys(n for p in _evidence(row).get("problems", ()) for n in UNCLAIMED.findall(p))
    patch = []
    for name in names:
        role = spec["entities"][name]["role"].split()
        word = next((w for w in reversed(role) if re.search(rf"\b{re.escape(w)}\b", spec["prompt"])), None)
        if word is not None:
            claim = {"quote": word, "type": "thing", "by": [f"/entities/{name}"]}
            patch.append({"op": "add", "path": f"/claims/{name}", "value": claim})
    return Edit(row["id"], f"the words of {', '.join(names)} were not claimed", patch, "text") if patch else None


def missed_carrier(spec: dict[str, Any], row: dict[str, Any]) -> tuple[str, str] | None:
    """(body, what the entity that should have caught it stands on) of a beat that missed a region carried by an entity."""
    beat = spec["story"]["beats"].get(row["id"].removeprefix("beat:"))
    if beat is None or beat["predicate"].get("kind") != "reaches":
        return None
    carrier = spec["graph"]["regions"][beat["predicate"]["region"]].get("relative_to")
    under = [r["a"] for r in spec["graph"]["relations"].values() if r["kind"] == "supports" and r["b"] == carrier]
    return (beat["predicate"]["entity"], under[0]) if under else None


def _missed_region(spec: dict[str, Any], row: dict[str, Any], landing: list[float] | None) -> Edit | None:
    """A body ended outside a region that moves with another entity: move that entity to where the body came down."""
    offset = _evidence(row).get("offset")
    beat = spec["story"]["beats"].get(row["id"].split(":", 1)[1])
    if offset is None or beat is None or beat["predicate"].get("kind") != "reaches":
        return None
    region = spec["graph"]["regions"][beat["predicate"]["region"]]
    carrier = region.get("relative_to")
    if carrier is None:
        return None
    position = list(spec["entities"][carrier]["pose"]["position"])
    if landing is not None:
        patch = [
            {
                "op": "replace",
                "path": f"/entities/{carrier}/pose/position",
                "value": [*(round(v, 4) for v in landing[:2]), position[2]],
            }
        ]
        text = f"{row['entities'][0]} came down at x, y = {landing[0]:.3f}, {landing[1]:.3f} m, where {carrier} does not stand, so it goes there"
        return Edit(row["id"], text, patch, "placement")
    # The offset leads from the region's surface to the body; going on by a part of its size brings the body well inside.
    reach = float(region.get("radius", 0.1))
    length = max((offset[0] ** 2 + offset[1] ** 2) ** 0.5, 1e-9)
    moved = [round(position[i] + offset[i] * (1 + 0.6 * reach / length), 4) for i in range(2)]
    patch = [{"op": "replace", "path": f"/entities/{carrier}/pose/position", "value": [*moved, position[2]]}]
    text = f"{row['entities'][0]} came to rest {length:.3f} m outside; {carrier} stands too far off, so it goes there"
    return Edit(row["id"], text, patch, "placement")


def _too_late(spec: dict[str, Any], rows: list[dict[str, Any]]) -> Edit | None:
    """The first beats come after their intervals: let the driver that starts them act earlier by as much."""
    late = {}
    for row in rows:
        beat = spec["story"]["beats"].get(row["id"].removeprefix("beat:"))
        for correction in row.get("corrections", []):
            for operation in correction.get("patch", []):
                if beat is not None and operation["path"].endswith("/frames") and operation["value"][1] > beat["frames"][1]:
                    late[row["id"].removeprefix("beat:")] = operation["value"][1] - beat["frames"][0]
    for name, frames in late.items():
        owner = spec["story"]["beats"][name]["owner"]
        driver = spec["simulation"].get("drivers", {}).get(owner)
        if driver is not None and driver.get("time"):
            time = round(max(0.0, driver["time"] - (frames - 2) / spec["simulation"]["fps"]), 4)
            patch = [{"op": "replace", "path": f"/simulation/drivers/{owner}/time", "value": time}]
            return Edit(f"beat:{name}", f"{owner} acts too late: {name} needs about {frames} frames less", patch, "drivers")
    return None


def _rescale(spec: dict[str, Any], row: dict[str, Any]) -> Edit | None:
    """A body is modelled too large or small: scale its shapes to the declared size."""
    name = row["entities"][0]
    for correction in row.get("corrections", []):
        if correction["group"] == "shape" and correction["action"].startswith("Scale the parts"):
            factor = float(correction["action"].split(" by ")[1].split(" x ")[0])
            patch = []
            for key, part in spec["entities"][name]["parts"].items():
                for field in ("radius", "height", "length", "size"):
                    if field in part["shape"]:
                        value = part["shape"][field]
                        scaled = [v * factor for v in value] if isinstance(value, list) else value * factor
                        patch.append({"op": "replace", "path": f"/entities/{name}/parts/{key}/shape/{field}", "value": scaled})
            return (
                Edit(row["id"], f"{name} is modelled at the wrong scale; its contract is right", patch, "shape")
                if patch
                else None
            )
    return None


def _suggested(row: dict[str, Any]) -> Edit | None:
    """The server's best suggestion that comes with a patch."""
    for correction in row.get("corrections", []):
        if correction.get("patch"):
            return Edit(row["id"], f"{correction['cause']}: {correction['action']}", correction["patch"], correction["group"])
    return None


def _edit_of(
    spec: dict[str, Any],
    row: dict[str, Any],
    rows: list[dict[str, Any]],
    landings: dict[str, list[float]],
) -> Edit | None:
    if row["id"] == "audit:claims":
        return _claim(spec, row)
    if row["check"] == "scale":
        return _rescale(spec, row) or _suggested(row)
    if row["check"] == "beat":
        return _too_late(spec, rows) or _missed_region(spec, row, landings.get(row["id"])) or _suggested(row)
    return _suggested(row)


def propose(
    spec: dict[str, Any],
    rows: list[dict[str, Any]],
    tried: set[str],
    landings: dict[str, list[float]],
) -> Edit | None:
    """The next edit for these open rows, or None when no rule applies.

    Args:
        spec: the present specification.
        rows: open rows as the server returned them.
        tried: edits made before, as JSON of their patches; none is repeated.
        landings: per failing row, where its body first touched what the entity that should have caught it stands on.
    """
    ranked = sorted(rows, key=lambda r: (ORDER.index(r["check"]), r["status"] != "fail", not r.get("mandatory", True)))
    for row in ranked:
        edit = _edit_of(spec, row, rows, landings)
        if edit is not None and json.dumps(edit.patch) not in tried:
            return edit
    return None
