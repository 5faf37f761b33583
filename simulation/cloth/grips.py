"""Implicit steps of sheets that touch and move slowly: contacts are part of the system, and the cut lets nothing cross after it.

Backward Euler for the sheets, an augmented Lagrangian for contacts: each pair that could meet wants a relative velocity u_n >= a along
its normal at the start of the step, and gives the impulse p with

    p_n = max(p_n + k (a - u_n), 0),    p_t = p_t - k u_t, cut to friction p_n,

k being a few times the mass that the pair would move alone. A round solves the sheets' system with the stiffness k of the pairs that
press (without what slides along its way) and takes the impulses that come out. Pairs start with what they gave each other in the step before.
Impulses are cut to Coulomb's law at last; what that leaves over moves a free sheet as a whole, or is borne by what holds it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import warp
from ...worlds.arrays import F64, I32
from . import step_kernels as steps
from . import stride_kernels as strides
from . import tangent_kernels as tangents
from .grip_kernels import agree, answer, clamp, ease, fails, grip, near_ones, offer, press, pressing, weigh
from .implicit import THETA, TURN

if TYPE_CHECKING:
    from .engine import Cloth
    from .strides import Strides

__all__ = ["DEAR", "Grips"]

DEAR = 6
"""Explicit steps that one of these costs, measured on 40 x 40 and 100 x 100 vertices that lie in folds."""
HARD = 5.0
"""Own choice: stiffness of contacts over the mass that a pair would move alone."""
ROUNDS = 6
"""Rounds at most; what then is missed the cut holds back."""
CLOSE = 0.05
"""Share of what is unbalanced without contacts at which conjugate gradients end; with 0.15 a heap gained energy."""
MOST = 200
"""Their steps at most."""
FINE = 0.1
"""Turn [rad] of an edge in a round after which forces are not looked at again: backward Euler bears more than a rule that keeps energy."""
LEAP = 0.5
"""Turn up to which a round goes."""
MISSED = 0.2
"""Share of the distance of contact that a pair may come closer than it wants in a step."""
OVER = 0.02
"""Share of all that presses by which impulses may break Coulomb's law before they are cut to it."""
FARTHEST = 0.3
"""Edges that the fastest vertex may go in a step."""
SLIDE = 0.5
"""Share of the distance of contact that vertices go in a step, as a mean square. Normals stay as they were: with twice as much, what
slides over the edge between two triangles of a floor felt a tenth more friction."""
DEEPEST = 5
"""Most times that a call is halved."""
AGAIN = 3
"""Solves of a step at most, where lists must be made anew for what a solve found."""


def _names(pairs: I32) -> NDArray[np.uint64]:
    """A number for each pair, (p, 4)."""
    found = np.zeros(len(pairs), dtype=np.uint64)
    for k in range(4):
        found = found * np.uint64(0x9E3779B97F4A7C15) + pairs[:, k].astype(np.uint64) + np.uint64(1)
    return found


class Grips:
    """Steps with contacts of one run.

    Args:
        engine: whose arrays they move.
        lists: whose lists of pairs and whose system they share.
    """

    def __init__(self, engine: Cloth, lists: Strides) -> None:
        self._of, self._lists, self._system = engine, lists, lists.implicit
        self._met = warp().zeros(1, dtype=warp().int32, device=engine.device)
        self._weight = np.ones((engine.n - len(engine.held), 3))
        self._room, self._change = np.empty((engine.n, 3)), np.zeros((engine.n, 3))
        self.begin()

    def begin(self) -> None:
        """Forget what went before."""
        self._last, self._before = -1, 0.0
        self._kept: tuple[NDArray[np.uint64], F64] | None = None
        self._of.contacts.impulse.zero_()

    def run(self, span: float, time: float, solid_speed: float, air: F64) -> tuple[F64, int, float]:
        """Go on for at most `span` seconds, while steps are worth it and can be trusted.

        Args:
            span: of the call [s].
            time: at its start [s].
            solid_speed: of the fastest point of any solid [m/s].
            air: momentum [N s] and energy [J] that air and fields gave, (4,): theirs come on top.

        Returns:
            Impulses given to the bodies by contact, (b, 6); how many steps they were; the time that is done [s].
        """
        e = self._of
        of, whole = e.contacts, 1 << DEEPEST
        self._total = np.zeros((len(e.setup.boundaries), 6))
        count, done, least, tried = 0, 0, 0, False
        while done < whole:
            depth = max(self._halved(span, solid_speed), least)
            while depth < DEEPEST and done % (whole >> depth):
                depth += 1
            if depth > DEEPEST or span < DEAR * e.longest * (1 << depth):
                break
            if not tried and e.steps_done != self._last:
                of.fresh = False
                self.begin()
            tried = True
            self._system.theta = 1.0
            if self._step(span / (1 << depth), time + span * done / whole, solid_speed, air):
                count, done, least = count + 1, done + (whole >> depth), 0
            else:
                of.fresh, least = False, depth + 1
        if not tried:
            return self._total, 0, 0.0
        self._system.theta = THETA
        self._last = e.steps_done + count if done == whole else -1
        if done < whole:
            of.fresh = False
        return self._total + of.collect(), count, span * done / whole

    def _halved(self, span: float, solid_speed: float) -> int:
        """Number of halvings of a call for steps in which nothing goes too far."""
        e = self._of
        v, of = e.v.numpy(), e.contacts
        if of.solid is None:
            v = v - e.mass @ v / e.mass.sum()
        square = (v**2).sum(1)
        fastest, mean = math.sqrt(square.max()) + solid_speed, math.sqrt(e.mass @ square / e.mass.sum()) + solid_speed
        share = span * max(fastest / (FARTHEST * of.shortest), mean / (SLIDE * min(of.touch)))
        return max(0, math.ceil(math.log2(max(share, 1e-9)) - 1e-9))

    # ------------------------------------------------------------------ lists

    def _listed(self, h: float, solid_speed: float) -> bool:
        """Have lists that hold for the step; whether they do."""
        e, lists = self._of, self._lists
        of, now = e.contacts, float(e.clock.numpy()[2])
        outrun = now + h > lists.until or (now + h) * solid_speed > of.solid_margin
        if of.fresh and not outrun and not lists.strays():
            return True
        self._search(h, solid_speed)
        return not lists.strays()

    def _search(self, h: float, solid_speed: float) -> None:
        """Make lists anew; what pairs gave each other goes with them."""
        of = self._of.contacts
        self._total += of.collect()
        self.remember()
        self._lists.search(h, solid_speed)
        assert self._kept is not None
        given, (names, own) = of.impulse.numpy(), self._kept
        given[: of.count] = 0.0
        self._kept = None
        if len(names):
            wanted = _names(of.pairs.numpy()[: of.count])
            place = np.minimum(np.searchsorted(names, wanted), len(names) - 1)
            known = np.flatnonzero(names[place] == wanted)
            given[known] = own[place[known]]

    def remember(self) -> None:
        """Keep what pairs gave each other while others make lists."""
        if self._kept is not None:
            return
        of = self._of.contacts
        own = of.impulse.numpy()[: of.count]
        pressed = np.flatnonzero((own != 0).any(axis=1))
        names = _names(of.pairs.numpy()[pressed])
        order = np.argsort(names, kind="stable")
        self._kept = names[order], own[pressed][order]

    # ------------------------------------------------------------------ a step

    def _step(self, h: float, time: float, solid_speed: float, air: F64) -> bool:
        """Take a step; whether it was taken."""
        e, s = self._of, self._system
        of, p = e.contacts, e.passes
        push = e.blow(time, e.x.numpy()[: e.n])
        if e.blown:
            s.feel(e.x, e.v, e.face_array, e.air, e.drag, e.corners)
        self._lists.tell(0, h)
        if e.led_count:
            e.lead()()
        warp().copy(s.before, e.v)
        p("guess", tangents.guess, e.n, [e.v, e.x, e.target, e.inverse, e.clock, e.u])()
        if not self._listed(h, solid_speed):
            return False
        s.prepare(h)
        if self._before and self._before != h:
            of.impulse.numpy()[: of.count] *= h / self._before
        self._before = h
        for _ in range(AGAIN):
            if of.count:
                p("reckon", strides.reckon, of.count, [e.x, e.u, of.state["radius"], of.pairs, of.kinds, e.clock, of.share, of.normal, of.wanted, of.impulse, of.slack])()  # fmt: skip
            if not self._solve(h):
                return False
            felt = s.settle(h)
            if not self._lists.strays():
                break
            self._search(h, solid_speed)
        else:
            return False
        if of.count:
            p("overlooked", strides.overlooked, of.count, [e.u, of.pairs, of.kinds, e.clock, of.slack, of.wanted, self._met])()
        for one in of.ends():
            one()
        if e.total > e.n:
            p("carry", steps.carry, e.total - e.n, [e.n, e.clock, e.u, e.x])()
        p("tick", steps.tick, 1, [e.clock])()
        mean = s.mean.numpy()
        given = e.mass[:, None] * push * h
        if e.blown:
            given -= h * np.einsum("nij,nj->ni", s.drag.numpy(), mean - s.before.numpy())
        air += [*given.sum(0), float((given * mean).sum())]
        if len(e.held):
            e.reaction.numpy()[e.held] += felt
        return True

    def _solve(self, h: float) -> bool:
        """Velocities and impulses of a step; whether they can be trusted."""
        e, s, change = self._of, self._system, self._change
        of, u = e.contacts, e.u.numpy()
        pairs, kinds, share, normal = of.pairs.numpy(), of.kinds.numpy(), of.share.numpy(), of.normal.numpy()
        wanted, given, friction = of.wanted.numpy(), of.impulse.numpy(), of.friction.numpy()
        which = near_ones(wanted, of.count)
        stiff, part, slide = np.empty(len(which)), np.empty(len(which)), np.zeros((len(which), 3))
        ease(which, pairs, share, e.inverse.numpy(), HARD, stiff)
        look, aim, turn = True, 0.0, 0.0
        for round_ in range(ROUNDS):
            if look:
                s.look()
                left, frames, matrix, factor = s.left.numpy(), s.frames.numpy(), s.matrix(), s.factor()
                if round_ == 0:
                    aim = CLOSE**2 * weigh(factor, left)
                press(which, pairs, share, given, left)
            offer(which, pairs, kinds, share, normal, wanted, friction, stiff, u, given, part, slide, left)
            agree(which, pairs, share, normal, stiff, part, factor[0], frames, s.rest, self._room, self._weight)
            contacts = pressing(which, pairs, share, normal, stiff, part, slide, e.n)
            if grip(matrix, factor, contacts, self._weight, left, change, aim, MOST) >= MOST:
                return False
            turn = s.turned(h, change)
            if turn > LEAP:
                change *= LEAP / turn
            answer(which, *contacts, change, part, given)
            u[: e.n] += change
            look = turn >= FINE
            missed, over = fails(which, pairs, kinds, share, normal, wanted, friction, slide, u, given)
            if not look and missed * h < MISSED * of.touch[0] and over < OVER:
                break
        clamp(which, pairs, kinds, share, normal, friction, slide, given, left)
        return turn <= max(LEAP, TURN)
