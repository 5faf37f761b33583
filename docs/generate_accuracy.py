"""Write `docs/accuracy.md` from the figures of `worldagent bench defects` (the last line of its standard output, as a file).

python docs/generate_accuracy.py FIGURES.json [LATER.json ...]
python docs/generate_accuracy.py --add LATER.json [...]

Later runs of some checks (`--only`) replace what earlier files say of them; the page names every run. With `--add` the page as it
stands is the earliest of them.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from worldagent.verifiers.robustness import clopper_pearson

HEAD = """# Accuracy of the checks

What each check finds of worlds that were broken on purpose, and what it refuses of sound worlds that look suspicious. Written by
`docs/generate_accuracy.py` from runs of `worldagent bench defects`.

A world counts as found when a mandatory row of that check fails and names the culprit; a sound one as refused when any mandatory row
of the check does not pass. Truth comes from how a world was made, never from the verifier. Magnitudes, sizes, places, directions and
frames are drawn at run time. The suites were made together with the checks, and misses were mended in both, so these figures say how
well the checks keep what they promise about the kinds of defects listed in `bench/defects/`, not about kinds that nobody thought of.
Intervals: 95 %, Clopper and Pearson (1934).
"""


def joined(runs: list[dict[str, Any]], page: str = "") -> dict[str, Any]:
    """Figures of several runs, of each check the latest, with the totals over them; `page` is what an earlier page says."""
    checks: dict[str, Any] = _told(page)
    for run in runs:
        checks = {**checks, **run["checks"]}
    total = {k: sum(f[k] for f in checks.values()) for k in ("broken", "detected", "clean", "false_alarms")}
    return {
        "checks": checks,
        "accepted": next((r["accepted"] for r in reversed(runs) if r.get("accepted")), _accepted(page)),
        "detection_95": clopper_pearson(total["detected"], total["broken"]),
        "false_alarm_95": clopper_pearson(total["false_alarms"], total["clean"]),
        "runs": [
            *re.findall(r"^Run.*$", page, re.MULTILINE),
            *(_run(r, None if len(runs) == 1 and not page else r["checks"]) for r in runs),
        ],
    }


def _told(page: str) -> dict[str, Any]:
    """Figures of every check that a page holds."""
    checks: dict[str, Any] = {}
    tables = page.partition("## Smallest defect found")
    for cells in _cells(tables[0], 7):
        ours, sound = map(int, cells[1].split(" / "))
        (detected, broken), (alarms, clean) = ([int(n) for n in cells[k].split(" of ")] for k in (2, 4))
        checks[cells[0]] = {
            "mechanisms": {"broken": ours, "clean": sound}, "broken": broken, "detected": detected, "clean": clean,
            "false_alarms": alarms, "detection_95": clopper_pearson(detected, broken), "false_alarm_95": clopper_pearson(alarms, clean),
            "median_ms": float(cells[6]), "missed": [], "smallest_detected": {},
        }  # fmt: skip
    for check, mechanism, magnitude, seed in re.findall(r"^- (\w+): (.+) at (\S+), seed (\d+)$", tables[0], re.MULTILINE):
        checks[check]["missed"].append({"mechanism": mechanism, "magnitude": float(magnitude), "seed": int(seed)})
    for check, mechanism, found, bound, unit in _cells(tables[2], 5):
        least = None if found == "not found" else float(found)
        checks[check]["smallest_detected"][mechanism] = {"magnitude": least, "bound": float(bound), "unit": unit}
    return checks


def _cells(text: str, count: int) -> list[list[str]]:
    """Rows of the tables of a page without their heads, and without totals."""
    rows = [[c.strip() for c in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]
    return [r for r in rows if len(r) == count and r[0] not in ("check", "all") and not r[0].startswith("---")]


def _accepted(page: str) -> dict[str, int] | None:
    found = re.search(r"judged anew: (\d+) worlds, (\d+) checks of\s+them, (\d+) refused", page)
    return dict(zip(("worlds", "checks", "false_alarms"), map(int, found.groups()), strict=True)) if found else None


def _run(figures: dict[str, Any], checks: Iterable[str] | None) -> str:
    machine = figures["machine"]
    of = "" if checks is None else f" of {', '.join(checks)}"
    return (
        f"Run{of} of {figures['date'][:10]}, commit `{figures['commit']}`, seed {figures['seed']}, {machine['processor']} "
        f"({machine['cores']} cores, shared), {figures['wall_s']:.0f} s."
    )


def page(figures: dict[str, Any]) -> str:
    """The page of joined runs."""
    lines = [
        HEAD,
        *figures["runs"],
        "",
        "| check | mechanisms broken / sound | found | 95 % | refused | 95 % | median ms per world |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, f in figures["checks"].items():
        found, alarm = (f"{100 * low:.2f} to {100 * high:.2f} %" for low, high in (f["detection_95"], f["false_alarm_95"]))
        lines.append(
            f"| {name} | {f['mechanisms']['broken']} / {f['mechanisms']['clean']} | {f['detected']} of {f['broken']} | {found} "
            f"| {f['false_alarms']} of {f['clean']} | {alarm} | {f['median_ms']:.0f} |"
        )
    total = {k: sum(f[k] for f in figures["checks"].values()) for k in ("broken", "detected", "clean", "false_alarms")}
    low, high = figures["detection_95"]
    lower, upper = figures["false_alarm_95"]
    lines.append(
        f"| all | | {total['detected']} of {total['broken']} | {100 * low:.2f} to {100 * high:.2f} % "
        f"| {total['false_alarms']} of {total['clean']} | {100 * lower:.2f} to {100 * upper:.2f} % | |"
    )
    kept = figures.get("accepted")
    if kept:
        lines += [
            "",
            f"Accepted worlds (`bench/defects/accepted/`), built, baked and judged anew: {kept['worlds']} worlds, {kept['checks']} checks of "
            f"them, {kept['false_alarms']} refused.",
        ]
    missed = [(name, m) for name, f in figures["checks"].items() for m in f["missed"]]
    if missed:
        lines += ["", "Wrong in this run:", ""]
        lines += [f"- {name}: {m['mechanism']} at {m['magnitude']:.6g}, seed {m['seed']}" for name, m in missed]
    lines += [
        "",
        "## Smallest defect found",
        "",
        "| check | mechanism | smallest found | documented bound | unit |",
        "|---|---|---|---|---|",
    ]
    for name, f in figures["checks"].items():
        for mechanism, least in f["smallest_detected"].items():
            value = "not found" if least["magnitude"] is None else f"{least['magnitude']:.4g}"
            lines.append(f"| {name} | {mechanism} | {value} | {least['bound']:.4g} | {least['unit']} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    target = Path(__file__).parent / "accuracy.md"
    add = sys.argv[1:2] == ["--add"]
    found = [json.loads(Path(name).read_text().strip().splitlines()[-1]) for name in sys.argv[1 + add :]]
    target.write_text(page(joined(found, target.read_text() if add else "")))
