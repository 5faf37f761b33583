"""Questions of the check `claim`."""

from __future__ import annotations

from ..rows.questions import Question

__all__ = ["COUNT", "EVENT", "NEGATION", "ORDER", "QUANTITY", "QUESTIONS", "THING", "UNSEEN"]

THING = Question(
    "claim:thing",
    "each thing that the claim {0} names is in a picture",
    "largest share of a picture that the least shown of them fills",
    "1",
    ">=",
    "limits.visible_pixels",
    ("claim",),
    matrix_group="observational",
)
COUNT = Question(
    "claim:count",
    "exactly as many separate bodies as the claim {0} counts are there and do what is told of them, neither one less nor one more",
    "how many there are, or do it",
    "1",
    "==",
    "the number of its words",
    ("claim",),
    matrix_group="temporal",
)
EVENT = Question(
    "claim:event",
    "the beats of the claim {0} come true, and none of the rival readings of its words does",
    "beats that do not come true, and rivals that do",
    "1",
    "<=",
    "0",
    ("claim",),
    matrix_group="temporal",
)
ORDER = Question(
    "claim:order",
    "what the claim {0} tells comes true in its order, and no other order of it is true",
    "least time from one event to the next, 0 where another order is true as well; of events at the same time the time between them",
    "s",
    ">=",
    "the longer of one frame and ORDER_SEEN; of events at the same time at most AT_ONCE and a frame",
    ("claim",),
    matrix_group="temporal",
)
NEGATION = Question(
    "claim:negation",
    "what the claim {0} denies never comes true, and does where it plainly happens",
    "requirements that are not met, or that deny what is more than the words",
    "1",
    "<=",
    "0",
    ("claim",),
    matrix_group="temporal",
)
QUANTITY = Question(
    "claim:quantity",
    "what the claim {0} names measures what its words say, and neither half nor twice of it",
    "measured value of what it names, the farthest from the words",
    "various",
    "in",
    "the number of its words, up to a factor of NEARER where they give no least or most",
    ("claim",),
    matrix_group="physical",
)

UNSEEN = Question(
    "claim:unseen",
    "nothing that can hardly be seen and that no claim names pushes, holds or pulls a body that the prompt names",
    "clear bodies and parts, and springs with nothing drawn, that do",
    "1",
    "<=",
    "0",
    matrix_group="temporal",
)
QUESTIONS = (THING, COUNT, QUANTITY, EVENT, ORDER, NEGATION, UNSEEN)
