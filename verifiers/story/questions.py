"""Questions of the checks `beat`, `causal` and `robustness`."""

from __future__ import annotations

from ..rows.questions import Question

__all__ = [
    "BEAT",
    "BRANCHES",
    "CAUSAL",
    "CHOICES",
    "DRIVEN",
    "PHASES_SHOWN",
    "PROMISE",
    "QUESTIONS",
    "REQUIREMENT",
    "ROBUST",
    "UNTOLD",
    "VACUOUS",
    "WITHOUT",
]

BEAT = Question(
    "beat",
    "the declared predicate holds over the frames of {0}",
    "quantity of the predicate",
    "various",
    ">=",
    "field of the predicate",
    ("beat",),
)
VACUOUS = Question("beat:vacuous", "{0} is not true before its interval begins", subject=("beat",))
DRIVEN = Question("beat:driven", "a solver brings {0} about, and the story owns what starts it", subject=("beat",))
BRANCHES = Question(
    "beat:branches",
    "every branch of an `or` of {0} comes true in the recorded motion, or in a perturbed run of a sample of it",
    "branches that never do",
    "branch",
    "<=",
    "0",
    ("beat",),
)
REQUIREMENT = Question(
    "requirement",
    "the declared predicate of {0} holds over its frames",
    "quantity of the predicate",
    "various",
    ">=",
    "field of the predicate",
    ("requirement",),
    matrix_group="physical",
)
CHOICES = Question(
    "requirement:branches",
    "every branch of an `or` of {0} comes true in the recorded motion",
    "branches that never do",
    "branch",
    "<=",
    "0",
    ("requirement",),
    matrix_group="physical",
)
CAUSAL = Question(
    "causal",
    "{0} comes no later than {1}, and an impulse chain leads from its subject to that of {1}",
    "links of the chain; where one body does both, frames between them; where others push too, the impulse of the chain",
    "various",
    ">=",
    "1 link, 0 frames, or MOMENTUM_SHARE of the impulse of others",
    ("cause", "effect"),
)
WITHOUT = Question(
    "causal:without",
    "without {0}, {1} does not come",
    "quantity of the effect's predicate without the cause; where a margin is declared, the change",
    "various",
    "<=",
    "field of the predicate, which must be missed; the margin of {0}",
    ("cause", "effect"),
)
UNTOLD = Question(
    "causal:untold",
    "without the drivers of which no beat that leads to {0} tells, as far as they reach its bodies, {0} comes as well",
    "1 where it does not come without them",
    "1",
    "<=",
    "0",
    ("beat",),
)
ROBUST = Question(
    "robustness",
    "{1} comes true under {0} as well",
    "share of the perturbed runs in which it does; with a finer step, frames by which it shifts",
    "1",
    ">=",
    "min_fraction of the item; at most `frames` of it",
    ("item", "beat"),
)
PHASES_SHOWN = Question(
    "probe:phases",
    "the run covers preroll, activation, first contact, peak response and early settling",
    "phases shown",
    "phases",
    ">=",
    "5, or 4 where nothing should meet",
)
PROMISE = Question(
    "numerical:promise",
    "beats come true as the probe of these settings promised",
    "beats that come otherwise",
    "beat",
    "<=",
    "0; after a coarser probe LATE of the time and the order",
    matrix_group="temporal",
)

QUESTIONS = (BEAT, VACUOUS, DRIVEN, BRANCHES, REQUIREMENT, CHOICES, CAUSAL, WITHOUT, UNTOLD, ROBUST, PHASES_SHOWN, PROMISE)
