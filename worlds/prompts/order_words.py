"""Words of order by language and by what they do. Reviewed by hand; `while`, `one by one` and `last` say less and are not here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

__all__ = ["ALONE", "WORDS", "OrderKind"]

OrderKind = Literal["then", "before", "after", "together", "first", "last"]
"""`then`: what stands before it comes first; `before`, `after`: of two clauses, as conjunctions; `together`: both at once; `first`, `last`: the
event of its own clause begins or ends what is told."""
ALONE: frozenset[OrderKind] = frozenset(("first", "last"))
"""Kinds whose words mean it only where they are all that is claimed: `for the first surge` puts nothing in order."""


def _listed(words: str) -> tuple[str, ...]:
    return tuple(entry.strip() for entry in words.split(","))


WORDS: Mapping[str, Mapping[OrderKind, tuple[str, ...]]] = {
    "en": {
        "then": _listed(
            "then, afterwards, afterward, after that, after this, after which, thereafter, subsequently, whereupon, later, next, before long"
        ),
        "before": _listed("before, until, till"),
        "after": _listed("after, as soon as, only after"),
        "together": _listed("at the same time, at the same moment, at the same instant, simultaneously, at that very moment"),
        "first": _listed("first, firstly, at first, first of all"),
        "last": _listed("finally, lastly, at last, in the end, eventually"),
    },
    "de": {
        "then": _listed("dann, danach, daraufhin, anschließend, woraufhin, worauf, später"),
        "before": _listed("bevor, ehe, bis"),
        "after": _listed("nachdem, sobald, erst nachdem, nach"),
        "together": _listed(
            "gleichzeitig, zugleich, zur gleichen zeit, zur selben zeit, im selben moment, im selben augenblick, im gleichen moment"
        ),
        "first": _listed("zuerst, zunächst, als erstes"),
        "last": _listed("schließlich, zuletzt, zum schluss, am ende, am schluss"),
    },
    "fr": {
        "then": _listed("puis, ensuite, après quoi, plus tard"),
        "before": _listed("avant, avant de, avant que, avant qu', jusqu'à ce que"),
        "after": _listed("après, après que, après qu', dès que, une fois que, aussitôt que"),
        "together": _listed("en même temps, simultanément, au même moment, au même instant"),
        "first": _listed("d'abord, tout d'abord, en premier"),
        "last": _listed("enfin, finalement, à la fin"),
    },
    "es": {
        "then": _listed("luego, después, entonces, a continuación, tras lo cual, más tarde"),
        "before": _listed("antes de, antes de que, hasta que"),
        "after": _listed("después de, después de que, en cuanto, tan pronto como, tras"),
        "together": _listed("al mismo tiempo, a la vez, simultáneamente, en el mismo momento"),
        "first": _listed("primero, al principio"),
        "last": _listed("finalmente, por último, al final"),
    },
    "it": {
        "then": _listed("poi, in seguito, successivamente, dopodiché, più tardi"),
        "before": _listed("prima di, prima che, finché non, fino a quando"),
        "after": _listed("dopo, dopo che, non appena, appena"),
        "together": _listed("contemporaneamente, allo stesso tempo, nello stesso momento, simultaneamente"),
        "first": _listed("dapprima, per primo, per prima, all'inizio"),
        "last": _listed("infine, alla fine, per ultimo, per ultima"),
    },
    "pt": {
        "then": _listed("depois, então, em seguida, mais tarde"),
        "before": _listed("antes de, antes que, até que"),
        "after": _listed("depois de, depois que, assim que, logo que, após"),
        "together": _listed("ao mesmo tempo, simultaneamente, no mesmo momento"),
        "first": _listed("primeiro, no início"),
        "last": _listed("finalmente, por fim, por último, no final"),
    },
    "nl": {
        "then": _listed("dan, daarna, vervolgens, waarna, later"),
        "before": _listed("voordat, totdat, tot"),
        "after": _listed("nadat, zodra, na"),
        "together": _listed("tegelijk, tegelijkertijd, gelijktijdig, op hetzelfde moment"),
        "first": _listed("eerst, als eerste"),
        "last": _listed("tenslotte, ten slotte, uiteindelijk, tot slot, als laatste"),
    },
    "ru": {
        "then": _listed("потом, затем, после чего, после этого, позже"),
        "before": _listed("прежде чем, перед тем как, до того как, пока не"),
        "after": _listed("после того как, как только"),
        "together": _listed("одновременно, в то же время, в тот же момент"),
        "first": _listed("сначала, сперва, в начале"),
        "last": _listed("наконец, в конце концов, в конце"),
    },
    "zh": {
        "then": _listed("然后, 随后, 接着, 之后, 后来"),
        "before": (),
        "after": (),
        "together": _listed("与此同时, 同时"),
        "first": _listed("首先"),
        "last": _listed("最后, 最终, 终于"),
    },
    "ja": {"together": _listed("同時に")},
}
"""By language and kind."""
