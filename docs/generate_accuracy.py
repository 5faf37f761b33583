"""Write `docs/accuracy.md` and its data, `docs/accuracy.json`, from figures of `worldagent bench defects` (the last line it prints).

python docs/generate_accuracy.py FIGURES.json [LATER.json ...]   # these runs alone
python docs/generate_accuracy.py --add LATER.json [...]          # later runs of some checks replace what there is of them
python docs/generate_accuracy.py --corrections NOW.json [BEFORE.json]   # runs of `worldagent bench corrections`: keep BEFORE beside NOW
python docs/generate_accuracy.py --refresh                       # only tell anew which tables are stale
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from worldagent.testing.defects.suites import suite_digest, verifiers_digest
from worldagent.verifiers.story.robustness import clopper_pearson

HEAD = """# Accuracy of the checks

What each check finds of worlds that were broken on purpose, and what it refuses of sound worlds that look suspicious. Written by
`docs/generate_accuracy.py` from runs of `worldagent bench defects`.

A world counts as found when a mandatory row of that check fails and names the culprit; a sound one as refused when any mandatory row
of the check does not pass. Truth comes from how a world was made, never from the verifier. Magnitudes, sizes, places, directions and
frames are drawn at run time. The suites were made together with the checks, and misses were mended in both, so these figures say how
well the checks keep what they promise about the kinds of defects listed in `testing/defects/`, not about kinds that nobody thought of.
Intervals: 95 %, Clopper and Pearson (1934).
"""


DATA = Path(__file__).with_name("accuracy.json")
PAGE = Path(__file__).with_name("accuracy.md")
KEPT = ("broken", "detected", "clean", "false_alarms", "median_ms", "mechanisms", "missed", "smallest_detected", "suite")
"""Figures of each check that the data keep."""
CORRECTIONS = """## Corrections that help

Each correction of a failing row is applied to the world it is made for (`worldagent bench corrections`): it helps where the audit takes the
edit, the row then passes or comes a tenth nearer to its bound, and nothing else fails newly; motion is simulated again. An edit that asks
for less is counted apart (eased), and so is what is said in words alone. Rows whose recording was wrong, and not the specification,
are counted apart as well: there only another run helps.
"""


def joined(runs: list[dict[str, Any]], earlier: dict[str, Any] | None = None) -> dict[str, Any]:
    """Data of several runs after earlier ones, of each check the latest."""
    found: dict[str, Any] = {"runs": [], "accepted": None, "checks": {}} if earlier is None else dict(earlier)
    for run in runs:
        fresh = {n: {**{k: f[k] for k in KEPT}, "verifiers": run["verifiers"]} for n, f in run["checks"].items()}
        only = None if len(runs) == 1 and earlier is None else run["checks"]
        found = {
            **found,
            "runs": [*found["runs"], _run(run, only)],
            "accepted": run.get("accepted") or found["accepted"],
            "checks": {**found["checks"], **fresh},
        }
    return found


def stale(data: dict[str, Any]) -> dict[str, str]:
    """Checks whose figures are not of today's code, with what has changed since."""
    judges, found = verifiers_digest(), {}
    for name, figures in data["checks"].items():
        changed = ["its worlds"] if figures["suite"] != suite_digest(name) else []
        changed += ["the verifiers"] if figures["verifiers"] != judges else []
        if changed:
            found[name] = " and ".join(changed)
    return found


def _run(figures: dict[str, Any], checks: Iterable[str] | None) -> str:
    machine = figures["machine"]
    of = "" if checks is None else f" of {', '.join(checks) or 'the accepted worlds'}"
    return (
        f"Run{of} of {figures['date'][:10]}, commit `{figures['commit']}`, seed {figures['seed']}, {machine['processor']} "
        f"({machine['cores']} cores, shared), {figures['wall_s']:.0f} s."
    )


def _stale_lines(data: dict[str, Any]) -> list[str]:
    by_change: dict[str, list[str]] = {}
    for name, changed in stale(data).items():
        by_change.setdefault(changed, []).append(name)
    return [f"Stale: since the run of {', '.join(names)}, {changed} changed." for changed, names in by_change.items()]


def page(figures: dict[str, Any]) -> str:
    """The page that tells the data."""
    lines = [
        HEAD,
        *figures["runs"],
        "",
        *[line for text in _stale_lines(figures) for line in (text, "")],
        "| check | mechanisms broken / sound | found | 95 % | refused | 95 % | median ms per world |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, f in figures["checks"].items():
        found, alarm = _intervals(f)
        lines.append(
            f"| {name} | {f['mechanisms']['broken']} / {f['mechanisms']['clean']} | {f['detected']} of {f['broken']} | {found} "
            f"| {f['false_alarms']} of {f['clean']} | {alarm} | {f['median_ms']:.0f} |"
        )
    total = {k: sum(f[k] for f in figures["checks"].values()) for k in ("broken", "detected", "clean", "false_alarms")}
    found, alarm = _intervals(total)
    lines.append(
        f"| all | | {total['detected']} of {total['broken']} | {found} "
        f"| {total['false_alarms']} of {total['clean']} | {alarm} | |"
    )
    kept = figures.get("accepted")
    if kept:
        lines += [
            "",
            f"Accepted worlds (`testing/defects/accepted.py`), built, baked and judged anew: {kept['worlds']} worlds, {kept['checks']} checks of "
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
    return "\n".join([*lines, *_correction_lines(figures.get("corrections"))]) + "\n"


def _correction_lines(kept: dict[str, Any] | None) -> list[str]:
    """The section about corrections; nothing where none were measured."""
    if not kept:
        return []
    now, before = kept["now"], kept.get("before") or {"checks": {}}
    lines = [
        "",
        CORRECTIONS,
        _run(now, None),
        *([now["note"]] if "note" in now else []),
        "",
        "| check | failing rows | share that helps | before | eased | in words alone | edits tried | that help | recordings | told so |",
    ]
    lines.append("|---|---|---|---|---|---|---|---|---|---|")
    for name, f in [*now["checks"].items(), ("all", now)]:
        was = before if name == "all" else before["checks"].get(name, {})
        lines.append(
            f"| {name} | {f['rows']} | {_percent(f)} | {_percent(was)} | {f['eased']} | {f['words']} | {f['patches']} | {f['helping']} "
            f"| {f['recordings']} | {f['recordings_helped']} |"
        )
    return lines


def _percent(figures: dict[str, Any]) -> str:
    rows = figures.get("rows", 0)
    return f"{figures['helped']} of {rows}, {100 * figures['helped'] / rows:.0f} %" if rows else "-"


def _intervals(figures: dict[str, Any]) -> tuple[str, str]:
    """95 % intervals of the share found and of the share refused, as text."""
    of = (("detected", "broken"), ("false_alarms", "clean"))
    found, alarm = (clopper_pearson(figures[hits], figures[count]) for hits, count in of)
    return f"{100 * found[0]:.2f} to {100 * found[1]:.2f} %", f"{100 * alarm[0]:.2f} to {100 * alarm[1]:.2f} %"


def with_corrections(data: dict[str, Any], now: dict[str, Any], before: dict[str, Any] | None) -> dict[str, Any]:
    """The data with a run of `worldagent bench corrections`, without its list of useless ones, and an earlier one beside it."""
    kept = {"now": now, "before": before or data.get("corrections", {}).get("before")}
    return {**data, "corrections": {k: v and {n: f for n, f in v.items() if n != "useless"} for k, v in kept.items()}}


if __name__ == "__main__":
    option = sys.argv[1] if sys.argv[1:2] in (["--add"], ["--refresh"], ["--corrections"]) else None
    runs = [json.loads(Path(name).read_text().strip().splitlines()[-1]) for name in sys.argv[1 + (option is not None) :]]
    if option == "--corrections":
        data = with_corrections(json.loads(DATA.read_text()), runs[0], runs[1] if runs[1:] else None)
    else:
        data = joined(runs, json.loads(DATA.read_text()) if option else None)
    DATA.write_text(json.dumps(data, indent=1) + "\n")
    PAGE.write_text(page(data))
