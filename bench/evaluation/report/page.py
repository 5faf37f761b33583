"""The report about a run: one HTML page with its pictures inside; no script, no network.

Names, reasons and worlds come from agents and strangers: all text is escaped, and the page's own policy forbids scripts and foreign content.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from ....rendering.report.markup import cell, escaped, figure, tag
from ....rendering.report.style import STYLE
from ..figures import FIGURES, METRIC_FIGURES, SERVER_FIGURES, Figure
from .films import FilmSheet

__all__ = ["report_page"]

POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"
OWN_STYLE = (
    "caption{text-align:start;color:var(--dim);padding-bottom:.3rem}th[scope=row]{color:inherit;font-size:1em;white-space:normal;font-weight:400;min-width:9rem}"
    ".scroll:focus-visible{outline:2px solid var(--ink)}.best{font-weight:700}.side{display:grid;grid-template-columns:repeat(auto-fit,minmax(20rem,1fr));gap:1rem}"
    ".limit{color:var(--open)}.error{color:var(--none)}tfoot td,tfoot th{border-top:2px solid var(--line);font-weight:600}"
)
ARROWS = {"higher": "↑", "lower": "↓", "": ""}
NONE = "–"


def report_page(document: Mapping[str, Any], sheets: Mapping[str, Sequence[FilmSheet]]) -> str:
    """The page.

    Args:
        document: of `report_document`.
        sheets: contact sheets by prompt.
    """
    run, runs = document["run"], [document, *document["beside"]]
    title = f"{run['task']}: {run['agent']}" + ("" if run["model"] in ("", "none", "none/none") else f" on {run['model']}")
    counts = ", ".join(f"{count} {word}" for word, count in document["outcomes"].items())
    ablation = document["made_with"]["ablation"]
    head = tag("h1", escaped(title)) + tag(
        "p", escaped(f"{counts}. Run {run['name']}, began {run['began']}, log {run['status']}.")
    )
    if ablation:
        head += tag("p", escaped(f"Checks left out: {ablation}. Nothing of this run is an acceptance."), class_="fail")
    sections = (
        ("Averages", _averages(runs)),
        (
            "The metrics by prompt",
            _by_prompt(document, METRIC_FIGURES, "Metrics of each prompt; with repeats, the mean and its 95 % interval"),
        ),
        ("The server's figures by prompt", _by_prompt(document, SERVER_FIGURES, "The server's own figures of each prompt")),
        ("Outcomes", _outcomes(document)),
        ("Not scored", _unscored(document)),
        ("Beats: server and judge", _beats(document)),
        ("Films", _films(sheets)),
        ("Made with", _made_with(document)),
    )
    body = tag("header", head) + tag(
        "main", "".join(tag("section", tag("h2", escaped(t)) + inner) for t, inner in sections if inner)
    )
    meta = f'<meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="{POLICY}"><meta name="viewport" content="width=device-width,initial-scale=1"><meta name="color-scheme" content="light dark">'
    return f'<!DOCTYPE html>\n<html lang="en"><head>{meta}{tag("title", escaped(title))}<style>{STYLE}{OWN_STYLE}</style></head>{tag("body", body)}</html>\n'


def _grid(caption: str, head: Sequence[str], rows: Sequence[Sequence[str]], foot: Sequence[str] = ()) -> str:
    """A table of escaped cells whose first cell of a row names it; it scrolls by keyboard too."""

    def line(cells: Sequence[str]) -> str:
        return tag("tr", tag("th", cells[0], scope="row") + "".join(cells[1:]))

    inner = tag("caption", escaped(caption)) + tag("thead", tag("tr", "".join(tag("th", escaped(h), scope="col") for h in head)))
    inner += tag("tbody", "".join(line(r) for r in rows)) + (tag("tfoot", line(foot)) if foot else "")
    return tag("div", tag("table", inner), class_="scroll", tabindex="0", role="region", aria_label=caption)


def _titles(figures: Sequence[Figure]) -> list[str]:
    return [f"{f.title} {ARROWS[f.better]}".strip() for f in figures]


def _told(value: float | None, interval: Sequence[float] | None, digits: int) -> str:
    if value is None:
        return NONE
    spread = "" if interval is None else f" [{interval[0]:.{digits}f}, {interval[1]:.{digits}f}]"
    return f"{value:.{digits}f}{spread}"


def _averages(runs: Sequence[Mapping[str, Any]]) -> str:
    """The paper's table: a row per run, the best of each column in bold where there are several."""

    def cells(run: Mapping[str, Any], figures: Sequence[Figure], best: Mapping[str, float]) -> list[str]:
        made = [escaped(_method(run))]
        for f in figures:
            known = run["figures"].get(f.name) or {}
            value = known.get("average")
            few = "" if not known or value is not None else f" ({known['prompts_scored']} of {known['prompts']} prompts)"
            top = value is not None and best.get(f.name) == value
            words = escaped(_told(value, known.get("interval"), f.digits) + few)
            made.append(cell(tag("strong", words) if top else words, "n"))
        return made

    found = ""
    for figures, caption in (
        (METRIC_FIGURES, "Macro averages of the metrics over all prompts, by what they measure: Pen and Caus physical plausibility, Qual shot planning, "
         "Comp and Align content alignment, Imag and Prod aesthetics"),
        (SERVER_FIGURES, "Macro averages of the server's own figures"),
    ):  # fmt: skip
        shown = [f for f in figures if figures is METRIC_FIGURES or any(f.name in r["figures"] for r in runs)]
        best = {f.name: top for f in shown if len(runs) > 1 and (top := _best(runs, f)) is not None}
        found += _grid(caption, ("run", *_titles(shown)), [cells(r, shown, best) for r in runs])
    note = "In brackets 95 % intervals over the repeats, where every prompt has at least two. A prompt without a value leaves the average without one (R140)."
    return found + tag("p", escaped(note), class_="dim")


def _best(runs: Sequence[Mapping[str, Any]], figure: Figure) -> float | None:
    values: list[float] = [v for r in runs if (v := (r["figures"].get(figure.name) or {}).get("average")) is not None]
    if len(set(values)) < 2 or not figure.better:
        return None
    return max(values) if figure.better == "higher" else min(values)


def _method(run: Mapping[str, Any]) -> str:
    told = run["run"]
    model = "" if told["model"] in ("", "none", "none/none") else f" ({told['model']})"
    ablation = run["made_with"]["ablation"]
    return f"{told['agent']}{model}{f', without {ablation}' if ablation else ''}, {told['name']}"


def _by_prompt(document: Mapping[str, Any], figures: Sequence[Figure], caption: str) -> str:
    known = document["figures"]
    shown = [f for f in figures if f.name in known]
    if not shown:
        return tag("p", "None was asked for: worldagent eval score RUN --metrics ...") if figures is METRIC_FIGURES else ""
    prompts = list(known[shown[0].name]["by_prompt"])

    def line(prompt: str) -> list[str]:
        told = [(known[f.name]["by_prompt"][prompt], f.digits) for f in shown]
        return [escaped(prompt), *(cell(escaped(_told(t["mean"], t["interval"], digits)), "n") for t, digits in told)]

    foot = [
        "macro average",
        *(cell(escaped(_told(known[f.name]["average"], known[f.name]["interval"], f.digits)), "n") for f in shown),
    ]
    return _grid(caption, ("prompt", *_titles(shown)), [line(p) for p in prompts], foot)


def _outcomes(document: Mapping[str, Any]) -> str:
    rows = []
    for s in document["samples"]:
        name = f"{s['id']}, repeat {s['epoch']}" if document["run"]["repeats"] > 1 else s["id"]
        beside = [
            s["limit"] and f"limit: {s['limit']}",
            *(f"isolation: {m}" for m in s["isolation"]),
            *(f"waived: {w}" for w in s["unmet"]),
        ]
        words = escaped(s["reason"]) + "".join(tag("div", escaped(w), class_="dim") for w in beside if w)
        rows.append(
            [
                escaped(name),
                cell(tag("strong", escaped(s["outcome"]), class_=s["outcome"])),
                cell(words),
                cell(escaped(", ".join(s["open_rows"][:6]) or NONE)),
            ]
        )
    caption = "Each sample: accepted, refused (its agent ended without an acceptance), limit (a budget ended it), error (the server or the harness failed; it counts in no figure)"
    return _grid(caption, ("sample", "outcome", "reason", "open rows"), rows)


def _unscored(document: Mapping[str, Any]) -> str:
    rows = [
        [escaped(f"{u['sample']}:{u['epoch']}"), cell(escaped(FIGURES[u["metric"]].title)), cell(escaped(u["reason"]))]
        for u in document["unscored"]
    ]
    return _grid("Metrics that could not be given, with their reasons", ("sample", "metric", "reason"), rows) if rows else ""


def _beats(document: Mapping[str, Any]) -> str:
    found = document["beats"]
    rows = []
    for name, told in found["samples"].items():
        for b in told["beats"]:
            judge = NONE if b["judge"] is None else {0.0: "absent", 0.5: "partly", 1.0: "completed"}[b["judge"]]
            right = {"server": "the server was right", "judge": "the judge was right", "unknown": "nobody ruled yet"}.get(
                b["right"] or "", ""
            )
            word = tag("strong", "disputed", class_="fail") if b["outcome"] == "disputed" else escaped(b["outcome"])
            rows.append(
                [
                    escaped(f"{name} {b['beat']}"),
                    cell(escaped(b["server"])),
                    cell(escaped(judge)),
                    cell(word),
                    cell(escaped(right)),
                ]
            )
    if not rows:
        return ""
    share, kappa = (NONE if found[k] is None else f"{found[k]:.3f}" for k in ("agreement", "kappa"))
    words = (
        f"Of the beats that both decide they agree on a share of {share} (Cohen's kappa {kappa}). Of the disputed ones the server was right on "
        f"{found['server_right']}, the judge on {found['judge_right']}; {found['open']} are open. Unmatched: no note says which beat of the world stands for it (--beats)."
    )
    return tag("p", escaped(words)) + _grid(
        "Beats of the prompts as the server measured them and as the judge saw them",
        ("beat", "server", "judge", "together", "who was right"),
        rows,
    )


def _films(sheets: Mapping[str, Sequence[FilmSheet]]) -> str:
    found = ""
    for prompt, films in sheets.items():
        shown = "".join(
            figure(f.picture, f"{f.run}, repeat {f.repeat}", f"frames of the film of {prompt}, run {f.run}, repeat {f.repeat}")
            for f in films
        )
        found += tag("h3", escaped(prompt)) + tag("div", shown, class_="side")
    return found


def _made_with(document: Mapping[str, Any]) -> str:
    made, run = document["made_with"], document["run"]
    facts: dict[str, Any] = {
        "report by worldagent": document["made_by"],
        "log": run["log"],
        "folder of the run": run["folder"],
        "arguments of the agent": run["agent_arguments"],
        **{f"prompts: {k}": v for k, v in made["prompts"].items()},
        **{f"template: {k}": v for k, v in made["template"].items()},
        **{f"budget: {k}": v for k, v in made["budget"].items()},
        "server": made["server"],
        "tools (SHA-256)": made["tools_sha256"],
        "revision": made["revision"],
        **{f"package {k}": v for k, v in made["packages"].items()},
        **{f"{FIGURES[k].title} by": v for k, v in made["metrics"].items()},
        **{f"film of {s['id']}:{s['epoch']} (SHA-256)": s["film"]["sha256"] for s in document["samples"] if s["film"]},
    }
    told = {
        k: v if isinstance(v, str) else json.dumps(v, sort_keys=True, ensure_ascii=False, default=str)
        for k, v in facts.items()
        if v not in (None, "", {}, [])
    }
    rows = [[escaped(k), cell(tag("code", escaped(v)))] for k, v in told.items()]
    return _grid("Versions, hashes and settings", ("what", "value"), rows)
