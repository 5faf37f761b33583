"""Words of material in a property claim against the substance of what it names (R131, R154).

A body is of the substance of which most of its volume is, and what a word of material stands beside is of that too: a badge of steel makes no
steel plate of a wooden one. A word that is in no list of the prompt's language is printed as the agent's reading. The density of a material is compared with the range of
its substance by an audit of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..claim_targets import targets_of
from ..claims import Reading
from ..made_of import made_of, noun_beside
from ..problems import Problem
from ..prompts.descriptions import meanings
from ..prompts.languages import REVIEWED, language_of
from ..spec import WorldSpec

__all__ = ["allowed_substances", "described_problems", "substance_problems"]


def allowed_substances(quote: str, language: str | None) -> list[tuple[str, tuple[str, ...]]]:
    """Words of materials in a quote, each with the substances that it allows; of any language with lists where the prompt's is not known."""
    found: dict[str, dict[str, None]] = {}
    for one in (language,) if language in REVIEWED else REVIEWED:
        for term, word in meanings(quote, one, "material"):
            found.setdefault(word, {}).update(dict.fromkeys(s for s in term.split("|") if s != "-"))
    return [(word, tuple(substances)) for word, substances in found.items() if substances]


def substance_problems(spec: WorldSpec, name: str) -> Iterator[Problem]:
    """A property claim that names a material which nothing in its `by` is made of."""
    claim = spec.claims[name]
    made = {n: substance for p in claim.by for n, substance in made_of(spec, p).items()}
    for word, allowed in allowed_substances(claim.quote, language_of(spec.prompt)):
        if made and not set(made.values()) & set(allowed):
            have = ", ".join(f"{n!r} is {s}" for n, s in list(made.items())[:3])
            text = f"{word!r} asks for {' or '.join(allowed)}; what the claim names is not: {have}"
            yield Problem(f"/claims/{name}/by", text)


def described_problems(spec: WorldSpec, reading: Reading) -> Iterator[Problem]:
    """Property claims of a material beside a noun whose things are not made of it, whatever the claims name."""
    for index, span in enumerate(reading.spans):
        if span.claim is None or span.type != "property" or spec.claims[span.claim].waived is not None:
            continue
        noun = noun_beside(reading.spans, index)
        if noun is None or spec.claims[noun].waived is not None or any(substance_problems(spec, span.claim)):
            continue
        for word, allowed in allowed_substances(span.text, reading.language):
            other = next((p for p in targets_of(spec.claims, noun) if not _is_of(spec, p, allowed)), None)
            if other is not None:
                have = " and ".join(dict.fromkeys(made_of(spec, other).values()))
                text = f"{word!r} asks for {' or '.join(allowed)}, and {other} of {spec.claims[noun].quote!r} beside it is of {have}: "
                yield Problem(f"/claims/{span.claim}/by", text + "make it of that, or claim the part of it as a thing")


def _is_of(spec: WorldSpec, pointer: str, allowed: Sequence[str]) -> bool:
    made = made_of(spec, pointer)
    return not made or bool(set(made.values()) & set(allowed))
