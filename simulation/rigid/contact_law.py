"""Contact law: Newton's impact law for closing contacts, Coulomb friction without lift, a soft recovery of depth.

MuJoCo solves a contact for an acceleration a = -b v - k r (direct `solref`), r < 0 being the depth inside the summed
skins. k = 1 / (N dt)^2 pushes what entered a skin back out, softly, because depth that is pushed out fast comes back as
speed; b = 1 / (4 dt) damps that more than critically and lets friction stick within a few steps. b = 1 / dt would do that
in one step, but its accelerations alternate from step to step and double the iterations of piles.

Three things are added between the velocity stage of a step and its solution, in the reference accelerations:

- **Impacts.** Contacts that close faster than `rest_speed` are struck one after another at the beginning of the step (`impact_sequence.py`); what
  lasts is solved for afterwards, with the speeds that they leave.
- **Impacts of debris.** Such a contact is solved for -(1 + e) v / dt instead: within one step, so that a body enters a skin by
  v dt at most, whatever the phase of the impact. This is Newton's law v' = -e v (J. J. Moreau, *Unilateral contact and dry friction in finite freedom dynamics*, 1988, for several contacts
  at once). What else a step with impacts asks for is in `impacts.py`. A calibrated spring-damper gave e +-0.02 depending on the phase of the impact and dipped N times deeper.
- **Pieces of one breakable body** meet as `crumbling` says.
- **Beside elastic bodies** the same is asked of rigid ones by another way (`beside_flexes.py`).
- **No lift.** The convex friction cone of MuJoCo makes a contact that slides at speed s separate at mu s: a sliding box
  hops, and a ball that hits obliquely bounces too high. Taking mu s / dt out of the normal reference makes the cone
  Coulomb's (G. De Saxce and Z.-Q. Feng, Mathematical and Computer Modelling 28 (1998) 225; F. Cadoux, 2009, for the
  fixed-point iteration). In lasting contacts s is
  that which the accelerations of the step before leave; in steps with impacts of debris it is iterated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from .beside_flexes import ask_beside_flexes
from .contact_points import ContactPoints
from .crumbling import scale_rows
from .impact_friction import stop_slides
from .impact_sequence import Blow, ImpactSequence
from .impacts import Impact
from .pair_values import PairValues
from .sides import sides_of
from .stiction import Stiction

if TYPE_CHECKING:
    from .crumbling import Crumbling, Weak
    from .model import RigidModel

__all__ = ["IMPEDANCE", "ContactLaw", "contact_reference", "rest_speed", "set_contact_law"]

IMPEDANCE = 0.97
"""Constant impedance d of contacts: a share 1 - d of the unconstrained acceleration passes. Below 1 the
solver converges in 2-4 iterations instead of 10 or more; what is left, (1 - d) of gravity, sinks a resting body by
(1 - d) / d g (N dt)^2, a few micrometres."""
JOINT_SOLIMP = (0.999, 0.999, 0.001, 0.5, 2.0)
"""The same for welds, connections, limits and dry friction of joints; stiffer, for they carry loads without skins."""
JOINT_STEPS = 4.0
"""Natural period / 2 pi of welds, connections and limits, in steps; they are critically damped."""
DAMPING_STEPS = 4.0
"""Time constant of contact damping and of sticking friction, in steps."""
PUSHED_OUT = 60.0
"""[m/s^2] What opens already is pushed out of a skin until it has this times the step as speed, 3 cm/s at half a millisecond: depth of a fast
impact would come back as twice that. It is what bears a body 200 times heavier (`SOFTEST` of `model.py`), so that nothing sinks for it."""
HARDER = 0.01
"""Softness of closing contacts, in parts of that of others. How softly MuJoCo meets a reference depends on the estimated,
not the true inertia that a contact sees; that would add up to (1 - d) (1 + e) to the restitution. Not in tight faces of a broken body."""
SLOWEST_BOUNCE = 0.01
"""[m/s] Contacts that close slower do not bounce: a hop from there is 5 micrometres high."""
GRAVITY_STEPS = 4.0
"""Contacts that close slower than gravity makes them in this many steps do not bounce either, or nothing would rest."""
SLIP_PASSES = 3
"""Most solutions per step to find the slip after impacts; the error falls by mu^2 in each."""
MORE_PASSES = 8
"""The same where few contacts feel the impacts: for a ball the error falls by 3.5 mu^2 / (1 + 3.5 mu^2) only, 0.56 at friction 0.6."""
FEW_CONTACTS = 40
CROWD = 200
FEW_PASSES = 2
"""The same where more than `CROWD` contacts of debris do: a solution takes milliseconds then."""
SLIP_SPEED = 0.05
"""[m/s] Slower impacts are solved once, with the slip that is there before them: a ball that slides fast and settles on its skin
would hop from nothing otherwise. What they set sliding hops by mu^2 / 2 g of this squared at most, 30 micrometres."""
SLIP_TOLERANCE = 0.01
"""Change of the lift in parts of the fastest impact that ends the iteration."""
ATTEMPTS = 4
"""Most times that a solution of debris whose forces do not fit its accelerations is taken up where it ended."""
UNBALANCED = 0.05
"""Share of the largest force by which forces and accelerations may disagree."""
_CONE = 4  # mjCNSTRSTATE_CONE: the contact slides


def contact_reference(steps: float, dt: float) -> tuple[float, float]:
    """Stiffness k [1/s^2] and damping b [1/s] of a contact; MuJoCo takes them negated."""
    return 1.0 / (steps * dt) ** 2, 1.0 / (DAMPING_STEPS * dt)


def rest_speed(gravity: float, dt: float) -> float:
    """Closing speed below which a contact does not bounce [m/s]."""
    return max(SLOWEST_BOUNCE, GRAVITY_STEPS * gravity * dt)


class ContactLaw:
    """Restitution and friction without lift; see the module.

    Args:
        model: the compiled model.
        restitution: restitution per side of a contact (geoms, then elastic bodies), shape (sides,).
        colliders: collider per side, shape (sides,).
        pairs: restitution of pairs of colliders that have their own.
        kin: contacts among pieces of breakable bodies, where there are any.
        stiction: coefficients of contacts that slip, where rest has others.
    """

    def __init__(
        self,
        model: Any,
        restitution: F64,
        colliders: Any,
        pairs: dict[tuple[int, int], float],
        kin: Crumbling | None,
        stiction: Stiction | None = None,
    ) -> None:
        import mujoco

        self.mj, self.model = mujoco, model
        self.restitution, self.colliders = restitution, colliders
        self.kin, self._stiction = kin, stiction
        self._weak: Weak | None = None
        self._found = False
        self._needed = np.zeros(model.nv)
        self._sequence = None if kin is not None else ImpactSequence(model)
        self.blow: Blow | None = None
        self._points = ContactPoints(model)
        self._pairs = PairValues(colliders, pairs)

    def restitution_of(self, geoms: Any) -> F64:
        """Restitution of contacts between geoms, shape (n, 2) -> (n,): the smaller one, or the pair's own."""
        return self._pairs.over(self.restitution[geoms].min(axis=1), geoms)

    def apply(self, data: Any, dt: float, slowest: float) -> None:
        """Write the reference accelerations of this step's contacts.

        Args:
            data: state after `mj_step1`.
            dt: time step [s].
            slowest: closing speed from which on a contact bounces [m/s].
        """
        self._weak, self._found, self.blow = None, False, None
        self._points.apply(data)
        if self._stiction is not None and data.ncon and data.nefc:
            self._stiction.apply(data, sides_of(self.model, data.contact))
        if self.kin is not None:
            stop_slides(self, data, dt, slowest)
        if not data.ncon or not data.nefc:
            return
        contact = data.contact
        if self._sequence is not None and self.model.nflex:
            solid = (contact.flex < 0).all(axis=1) & (contact.efc_address >= 0)
            if (data.efc_vel[contact.efc_address[solid]] < -slowest).any():
                self.blow = self._sequence.resolve(data, slowest, self.restitution_of(sides_of(self.model, contact)))
            ask_beside_flexes(self, data, np.flatnonzero(solid), dt)
            if self.blow is not None:
                self._sequence.begin(self.blow, data, dt)
            return
        rows = contact.efc_address
        live = rows >= 0
        if not live.all():
            rows = rows[live]
            if not len(rows):
                return
        speed = data.efc_vel[rows]
        hit = speed < -slowest
        if self._sequence is not None:
            if hit.any():
                self.blow = self._sequence.resolve(data, slowest, self.restitution_of(sides_of(self.model, contact)))
            self._last(data, rows, contact.friction[live], contact.dim[live], dt)
            return
        kin = self.kin
        weak = None if kin is None else kin.crumbling(data, contact.geom[live], contact.pos[live], rows, dt)
        self._weak = weak
        friction, sizes = contact.friction[live], contact.dim[live]
        if hit.any():
            self._found = self._meet(data, sides_of(self.model, contact)[live], rows, hit, friction, sizes, dt, weak)
            return
        data.efc_aref[rows] -= self._lift(rows, friction, sizes, data.efc_aref)
        if weak is not None and kin is not None:
            if kin.fresh:
                self._try(data)
                self._found = not kin.crumble(data, weak, np.ones(len(weak.rows), dtype=bool))
            else:
                kin.recall(data, weak)

    def _last(self, data: Any, rows: NDArray[np.int32], friction: F64, sizes: NDArray[np.int32], dt: float) -> None:
        """Write what contacts are solved for that last, or that the impacts of the step leave."""
        blow, damping, speed = self.blow, data.efc_KBIP[rows, 1], data.efc_vel[rows]
        asked = data.efc_aref if blow is None else data.efc_aref - data.efc_KBIP[:, 1] * blow.change
        lift = self.lasting_lift(data, rows, friction, sizes, asked)
        speed = speed if blow is None else speed + blow.change[rows]
        wanted = self.wanted(rows, asked[rows], speed, damping, dt)
        if blow is not None and self._sequence is not None:
            self._sequence.begin(blow, data, dt)
        data.efc_aref[rows] = wanted - lift

    def wanted(self, rows: NDArray[np.int32], asked: F64, speed: F64, damping: F64, dt: float) -> F64:
        """Accelerations that contacts are solved for along their normals, after the impacts of the step [m/s^2], shape (n,).

        What opens is not pushed out of the skins faster than `PUSHED_OUT`; what the impacts moved stops closing within the step, and opens as
        they left it.

        Args:
            rows: normal rows of the contacts.
            asked: by their springs and dampers at `speed` [m/s^2].
            speed: that the impacts leave [m/s].
            damping: of each [1/s].
            dt: time step [s].
        """
        opens = speed > 0.0
        wanted = np.where(opens, np.minimum(asked, PUSHED_OUT - speed / dt), asked)
        if self.blow is None:
            return wanted
        change = self.blow.change[rows]
        stopped = np.where(opens, np.minimum(wanted, -speed / dt), wanted - speed * (1.0 / dt - damping))
        return np.asarray(np.where(change != 0.0, stopped, wanted) + change / dt)

    def end(self, data: Any, dt: float) -> None:
        """Forget the impacts of the step after its integration: what follows goes on from the forces that last."""
        if self.blow is not None:
            data.qacc_warmstart[:] -= self.blow.gained / dt
            self.blow = None

    def solve(self, data: Any) -> None:
        """Find the forces of this step, unless they are found already, and note from what the next one goes on."""
        if not self._found:
            self._forward(data)
            self.settle(data)
        if self.kin is not None and self._weak is not None:
            self.kin.remember(data, self._weak)

    def settle(self, data: Any) -> None:
        """Count the impacts among the forces of contacts, once those of the step are found."""
        if self.blow is not None and self._sequence is not None:
            self._sequence.settle(self.blow, data, self.model.opt.timestep)

    def _forward(self, data: Any) -> None:
        for _ in range(1 if self.kin is None else ATTEMPTS):
            self.mj.mj_fwdActuation(self.model, data)
            self.mj.mj_fwdAcceleration(self.model, data)
            self.mj.mj_fwdConstraint(self.model, data)
            if self.kin is None or self._balanced(data):
                return
            data.qacc_warmstart[:] = data.qacc

    def _balanced(self, data: Any) -> bool:
        """True if the forces found are those of the accelerations found."""
        if not data.nefc:
            return True
        self.mj.mj_mulM(self.model, data, self._needed, data.qacc)
        given = data.qfrc_constraint
        amiss = np.abs(self._needed - data.qfrc_smooth - given).max(initial=0.0)
        return bool(amiss <= UNBALANCED * np.abs(given).max(initial=0.0))

    def _try(self, data: Any) -> None:
        """Find the forces of this step; the next solution starts from them."""
        self._forward(data)
        data.qacc_warmstart[:] = data.qacc

    def _meet(
        self,
        data: Any,
        sides: Any,
        rows: NDArray[np.int32],
        hit: NDArray[np.bool_],
        friction: F64,
        sizes: NDArray[np.int32],
        dt: float,
        weak: Weak | None,
    ) -> bool:
        """Write what contacts are solved for in a step with impacts, those of which are `hit`; whether the forces are found."""
        speed = data.efc_vel[rows]
        own = data.efc_aref[rows]
        closing = speed[hit] if weak is None else np.minimum(speed[hit] + weak.slack[hit], 0.0)
        impact = Impact.of(data, rows, hit, speed, self.restitution_of(sides), None if weak is None else weak.tight)
        own[hit] = -(1.0 + impact.bounce[hit]) * closing / dt
        own[impact.parting] = impact.wanted(dt)[impact.parting]
        # Faces in a tight fit ask for what cannot all be had, and the harder they are the larger is what they answer with.
        hard = hit if weak is None else hit & ~weak.tight
        self._harden(data, rows[hard], sizes[hard])
        fastest = float(-speed.min())
        lift = self._lift(rows, friction, sizes, data.efc_aref)
        if fastest > SLIP_SPEED:
            lift[hit] = 0.0
        acceleration = np.zeros(data.nefc)
        swung = np.zeros(len(rows), dtype=bool)
        passes, kin = SLIP_PASSES, self.kin
        if kin is not None and weak is not None:
            kin.recall(data, weak)
        near = self._near(data, rows, rows[hit])
        if kin is not None:
            felt = int(near.sum())
            passes = MORE_PASSES if felt <= FEW_CONTACTS else FEW_PASSES if felt > CROWD else SLIP_PASSES
        for _ in range(passes if fastest > SLIP_SPEED else 0):
            data.efc_aref[rows] = own - lift
            self._try(data)
            crumbled = weak is not None and kin is not None and kin.crumble(data, weak, self._near(data, weak.rows, rows[hit]))
            self.mj.mj_mulJacVec(self.model, data, acceleration, data.qacc)
            found = self._lift(rows, friction, sizes, acceleration - data.efc_aref)
            loose = data.efc_state[rows] != _CONE
            found[loose] = 0.0
            found = np.where(near, found, lift)
            # A lift that took a closing contact all its force is too large: without the halving the passes would swing
            # between that and none, and the last one lets a grazing corner through.
            swung |= loose & hit & (lift > 0.0)
            found = np.where(swung, 0.5 * (found + lift), found)
            change = float(np.abs(found - lift).max())
            lift = found
            if change * dt < SLIP_TOLERANCE * fastest and not crumbled:
                if kin is not None:
                    return True
                break
        data.efc_aref[rows] = own - lift
        return False

    def _near(self, data: Any, rows: NDArray[np.int32], hit: NDArray[np.int32]) -> NDArray[np.bool_]:
        """Which contacts, at `rows`, feel those at `hit` within the step; the others go on as in steps without impacts."""
        if self.kin is None or data.nisland < 2:
            return np.ones(len(rows), dtype=bool)
        struck = np.zeros(data.nisland, dtype=bool)
        struck[data.efc_island[hit]] = True
        return np.asarray(struck[data.efc_island[rows]])

    def lasting_lift(self, data: Any, rows: NDArray[np.int32], friction: F64, sizes: NDArray[np.int32], asked: F64) -> F64:
        """The lift of what lasts [m/s^2], by the accelerations of the step before.

        The error falls as in the passes of a step. Without the accelerations what slides would sink by mu^2 g (N dt)^2, up to 0.2 mm, and be
        pushed up again when it stops.
        """
        before = np.zeros(data.nefc)
        self.mj.mj_mulJacVec(self.model, data, before, data.qacc_warmstart)
        return self._lift(rows, friction, sizes, asked - before)

    def _lift(self, rows: NDArray[np.int32], friction: F64, sizes: NDArray[np.int32], tangential: F64) -> F64:
        """Friction coefficient times slip / dt [m/s^2] of contacts at `rows`, from accelerations per constraint row."""
        square = (friction[:, 0] * tangential[rows + 1]) ** 2 + (friction[:, 1] * tangential[rows + 2]) ** 2
        rolling = sizes > 3
        if rolling.any():
            at = rows[rolling]
            for k in (3, 4, 5):
                square[rolling] += (friction[rolling, k - 1] * tangential[at + k]) ** 2
        return np.asarray(np.sqrt(square))

    def _harden(self, data: Any, rows: NDArray[np.int32], sizes: NDArray[np.int32]) -> None:
        for k in range(int(sizes.max(initial=0))):
            scale_rows(data, rows[sizes > k] + k, HARDER)


def set_contact_law(rigid: RigidModel, steps: float, dt: float) -> None:
    """Write step and contact, limit and equality stiffness for a time step `dt` [s]."""
    model = rigid.model
    model.opt.timestep = dt
    k, b = contact_reference(steps, dt)
    for target in (model.geom_solref, model.pair_solref, model.flex_solref):
        target[:] = (-k, -b)
    omega = 1.0 / (JOINT_STEPS * dt)
    for target in (model.eq_solref, model.jnt_solref):
        target[:] = (-(omega**2), -2.0 * omega)
    model.dof_solref[:] = (-((1.0 / dt) ** 2), -1.0 / dt)
    for target in (model.eq_solimp, model.jnt_solimp, model.dof_solimp):
        target[:] = JOINT_SOLIMP
