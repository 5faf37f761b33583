"""Pages of a study: consent, films to rate, pairs to compare, the end. Plain HTML without scripts; they name no method."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ....rendering.report.markup import escaped, tag
from .answers import CRITERIA

__all__ = ["POLICY", "consent_page", "end_page", "pair_page", "rate_page", "words_page"]

POLICY = "default-src 'none'; media-src 'self'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'"
STYLE = """
:root{--ink:#1b1d21;--dim:#555b65;--line:#767d88;--back:#fff;--soft:#f2f4f6;--act:#0b57d0;--on:#fff;--bad:#b3261e}
@media (prefers-color-scheme:dark){:root{--ink:#e6e8eb;--dim:#a7b0bb;--line:#848d99;--back:#15171a;--soft:#1e2125;--act:#a8c7fa;--on:#062e6f;--bad:#ff8a80}}
*{box-sizing:border-box}body{margin:0 auto;max-width:80rem;padding:1.5rem;color:var(--ink);background:var(--back);font:16px/1.5 system-ui,sans-serif;overflow-wrap:anywhere}
h1{font-size:1.5rem;margin:.2rem 0}h2{font-size:1.15rem;margin:0 0 .4rem}.dim{color:var(--dim)}
blockquote{margin:.8rem 0;padding:.7rem 1rem;border-left:4px solid var(--line);background:var(--soft);white-space:pre-wrap}
.films{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(24rem,100%),1fr));gap:1.2rem;margin:1rem 0}
.film{border:1px solid var(--line);border-radius:.4rem;padding:.8rem}video{display:block;width:100%;aspect-ratio:16/9;background:#000}
fieldset{border:0;margin:.6rem 0 0;padding:0}legend{padding:0;font-weight:600}.scale{display:flex;flex-wrap:wrap;gap:.4rem;align-items:center}
.scale label{display:inline-flex;gap:.35rem;align-items:center;min-height:2rem;padding:.1rem .6rem;border:1px solid var(--line);border-radius:.3rem;cursor:pointer}
.scale label:has(:checked){background:var(--act);color:var(--on);border-color:var(--act)}input{accent-color:var(--act);width:1.1rem;height:1.1rem}
button{font:inherit;font-weight:600;padding:.6rem 1.4rem;border:0;border-radius:.4rem;background:var(--act);color:var(--on);cursor:pointer}
:focus-visible{outline:3px solid var(--act);outline-offset:2px}.scale label:has(:focus-visible){outline:3px solid var(--act);outline-offset:2px}
.bad{color:var(--bad);font-weight:600}
"""
LABELS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
"""Films of a page by their place on it."""


def _page(title: str, body: str) -> str:
    meta = '<meta charset="utf-8"><meta name="viewport" content="width=device-width,initial-scale=1"><meta name="color-scheme" content="light dark"><link rel="icon" href="data:,">'
    return f'<!DOCTYPE html>\n<html lang="en"><head>{meta}{tag("title", escaped(title))}<style>{STYLE}</style></head><body>{tag("main", body)}</body></html>\n'


def words_page(title: str, *paragraphs: str) -> str:
    """A page with words alone."""
    return _page(title, tag("h1", escaped(title)) + "".join(tag("p", escaped(p)) for p in paragraphs))


def consent_page(tasks: int, films: int, pairs: int, *, problem: str = "") -> str:
    """The first page."""
    told = f"{pairs} pairs of films, of each of which" if pairs != 1 else "a pair of films, of which"
    listed = "".join(tag("li", tag("strong", escaped(name)) + escaped(f": {covers}")) for name, covers in CRITERIA.values())
    body = (
        tag("h1", "Films of simulated worlds")
        + tag(
            "p",
            escaped(
                f"You will see {tasks} {'prompts' if tasks != 1 else 'prompt'}, and for each {films} films that were made from it. Rate every film from 1 (poor) to 5 (excellent) on four criteria:"
            ),
        )
        + tag("ul", listed)
        + (tag("p", escaped(f"After that come {told} you choose the better one.")) if pairs else "")
        + tag(
            "p",
            "No name, address or other personal information is kept: your answers stand under a random word. You may stop at any time; what you have sent by then is kept. To go on later, keep the address of the page.",
        )
        + (tag("p", escaped(problem), class_="bad", role="alert") if problem else "")
        + '<form method="post" action="/"><p><label><input type="checkbox" name="consent" value="yes" required> I take part of my own will, and agree that my answers are used.</label></p>'
        + "<button>Begin</button></form>"
    )
    return _page("Films of simulated worlds", body)


def end_page() -> str:
    """The last page."""
    return words_page("Thank you", "All your answers are kept. You may close this page.")


def _film(token: str, place: int, ratings: str = "") -> str:
    label = f"Film {LABELS[place]}"
    video = f'<video controls loop muted playsinline preload="metadata" src="/film/{token}" aria-label="{label}"></video>'
    return tag("section", tag("h2", label) + video + ratings, class_="film", aria_label=label)


def _scale(name: str, legend: str, choices: Sequence[tuple[str, str]], kept: str | None) -> str:
    made = "".join(
        f'<label><input type="radio" name="{name}" value="{value}" required{" checked" if kept == value else ""}> {escaped(words)}</label>'
        for value, words in choices
    )
    return tag("fieldset", tag("legend", escaped(legend)) + tag("div", made, class_="scale"))


def _form(progress: str, title: str, asked: str, prompt: str, inner: str, *, number: int, problem: str) -> str:
    hidden = f'<input type="hidden" name="step" value="{number}">'
    body = (
        tag("p", escaped(progress), class_="dim")
        + tag("h1", escaped(title))
        + (tag("p", escaped(problem), class_="bad", role="alert") if problem else "")
        + tag("p", "All films here were made from this prompt:")
        + tag("blockquote", escaped(prompt))
        + tag("p", escaped(asked))
        + f'<form method="post">{hidden}{inner}<p><button>Send and go on</button></p></form>'
    )
    return _page(f"{progress}: {title}", body)


def rate_page(
    prompt: str, tokens: Sequence[str], *, number: int, of: int, kept: Mapping[str, str] | None = None, problem: str = ""
) -> str:
    """Films of a task, each with its scales.

    Args:
        prompt: from which they were made.
        tokens: names of the films in their order.
        number: of the page, from 0.
        of: pages in all.
        kept: what was chosen already, where something is missing.
        problem: what is missing.
    """
    scale = [(str(k), str(k)) for k in range(1, 6)]
    films = "".join(
        _film(
            token,
            place,
            "".join(
                _scale(f"{key}-{place}", name, scale, (kept or {}).get(f"{key}-{place}")) for key, (name, _) in CRITERIA.items()
            ),
        )
        for place, token in enumerate(tokens)
    )
    covers = "; ".join(f"{name}: {words}" for name, words in CRITERIA.values())
    asked = f"Watch every film, then rate each from 1 (poor) to 5 (excellent). {covers}."
    return _form(
        f"Page {number + 1} of {of}",
        "Rate the films",
        asked,
        prompt,
        tag("div", films, class_="films"),
        number=number,
        problem=problem,
    )


def pair_page(prompt: str, tokens: Sequence[str], *, number: int, of: int, problem: str = "") -> str:
    """Two films of a task, of which the better one is chosen. Arguments as of `rate_page`."""
    films = tag("div", "".join(_film(token, place) for place, token in enumerate(tokens)), class_="films")
    choice = _scale(
        "choice", "Which film is better as a whole?", (("first", "Film A"), ("equal", "equally good"), ("second", "Film B")), None
    )
    asked = "Watch both films, then choose: which shows the prompt's world more plausibly, completely and beautifully?"
    return _form(f"Page {number + 1} of {of}", "Compare two films", asked, prompt, films + choice, number=number, problem=problem)
