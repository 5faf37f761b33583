"""Bounds of the questions about rigid instances: laws of motion and contact, records, numbers."""

MASS_NOISE = 1e-9
"""[1] Relative: a sum of doubles in another order."""
JOINT_GAP = 1e-3
"""[m] Own choice: below what a picture of the scene resolves."""
JOINT_SHARE = 0.01
"""[1] Own choice: of the smallest jointed body's diagonal, for large bodies."""
LIMIT_STEPS = 4.0
"""[steps] That a critically damped limit of a joint takes: it is overrun by speed times this, over e."""
DETACHED = 1e-9
"""[s] Rounding of the time at which a driver opens a joint."""
ESCAPE = 10.0
"""[1] Own choice: ten scene sizes away nothing that belongs to the story happens."""

REST_HEIGHT = 1e-3
"""[m] Own choice: least energy that is in play, as the weight of all that takes part times this height: the noise of a scene at rest
is not magnified."""
LEDGER_NOISE = 1e-9
"""[1] Relative: the ledger's own energies speak where they show more growth than the records."""
AUTHORED_NOISE = 1e-6
"""[1] Least energy that counts as in play, in parts of that of the bodies on paths."""
RECORDS = 1e-3
"""[1] Relative to the energy or momentum in play; the same formula on the same state, measured 1e-9. Bending of ropes is summed by
the engine in its own coordinates."""
WORK = 0.01
"""[1] Own choice: of the energy in play, recorded work beyond what the drivers can have done in one frame."""

IMPULSE = 2e-3
"""[m/s] Change of velocity per frame without a source. Measured: 1e-14 for free bodies and contacts, 5e-4 for jointed ones and
2e-4 for springs, whose forces the frames resolve only so far."""
JOINTED = 2e-3
"""[1] Of the fastest surface of an assembly of jointed bodies: generalised coordinates keep momentum only to a step's turn."""
PLACE = 1e-4
"""[m] Displacement in one frame beyond what velocities, contacts and a step's delay explain; measured 1e-15."""
SPIN = 5e-3
"""[rad/s] Change of angular velocity per frame beyond Euler's equations and |omega|^2 dt; measured at most 0.15 of the latter."""
TURN = 2e-3
"""[rad] Turn in one frame beyond Euler's equations and |omega|^2 dt per frame; measured at most 0.2 of the latter."""
HELD = 1e-5
"""[m] Distance of a driven body's surface from where its driver puts it; measured 4e-11 m for held bodies."""
UNSTEADY = 0.1
"""[1] Own choice: share of a body's weight by which the force of a liquid may vary within a frame beside its mean and what the frames
beside show."""
FASTER = 1.01
"""[1] Allowance on recorded peak speeds: a path's cubic between two steps."""
BUDGET_NOISE = 1e-6
"""[1] Relative: rounding of a budget of impulses."""

REACH = 1e-3
"""[m] Rounding of boxes and a frame's fall beyond the contact tolerance."""
FRICTION = 0.05
"""[1] Own choice: relative; the engine's cone is met to 1e-3 while a body slides."""
SLIDING = 0.1
"""[m/s] Own choice: slower bodies may stick within the frame."""
STRAIGHT = 0.9995
"""[1] Own choice: cosine of the angle between the velocities at both frames from which on a body slides straight."""
ROLLS = 0.02
"""[1] Own choice: share of the speed that turning may give the surface of a sliding body."""

BOUNCE = 0.05
"""[1] Own choice: of restitution; measured 0.01 for single hits of balls at steps up to 2 ms."""
SLOW_BOUNCE = 0.25
"""[m/s] Slower hits are not judged: gravity in a step and the resting threshold are then a visible part of them."""
TURNED = 0.5 * BOUNCE
"""[1] Own choice: part of the closing speed that a turn of the ground under a rolling ball may add to what it keeps."""

ASKEW = 0.9
"""[1] Own choice: cosine of the angle between a normal and the line of two centres; a step's travel turns it by less."""
DECIDED = 0.5
"""[1] Own choice: part of the closing speed that may have come from something else, for the impact to be judged."""
UNTOLD = 1.0
"""[1] Deviation of what is not told, or along another normal: all of a restitution."""

GAIN = 0.01
"""[1] Of the energy that took part, given by contacts in one step, or in one frame. The solver leaves 1e-4 of what an impact exchanges, and
what is pushed out of a skin comes back as up to 2 per cent of the speed, 4e-4 of the energy, over the steps of a push; measured: 5e-3 in a
chain of five balls at restitution 0, below 1e-3 elsewhere. The fault that it is for gave half of the energy and more in a step."""
PUSHES = 4.0
"""[1] Own choice: what entered a skin is out of it after four of the solver's time constants for that."""
REST_SPEED = 0.05
"""[m/s] Own choice, for worlds without gravity: bodies whose speeds are below a tenth of this, half a centimetre per second, may be pushed
out of their skins. As SLOW."""

FIELD = 0.05
"""[1] Own choice: of the largest force of a field on the body in play, what recorded impulses may differ from the declared field's."""

QUATERNION_NOISE = 1e-6
"""[1] Deviation of a quaternion's norm from 1; engines normalise every step, so more means a damaged state."""
GROWTH = 20.0
"""[1] Own choice: no body gets this many times faster from one frame to the next while the scene's energy grows."""
SLOW = 0.05
"""[m/s] Speeds below this count as this in a growth ratio: anything is many times faster than rest."""
SPIKE = 20.0
"""[1] Own choice, as between frames: nothing is this many times faster within a frame than at its ends or than its way asks for."""
CAPPED = 0.05
"""[1] Own choice: share of steps that may end at the iteration cap before contact forces are not to be trusted."""
USUAL_TOLERANCE = 1e-8
"""[1] Default of MuJoCo: improvement of its cost by which the search for contact forces ends, scaled by mean inertia; rooms ask for less."""
SLACK = 1.0
"""[m/s] Added to the speed limit for travel per frame: rounding of positions and half a frame of gravity."""
STILL = 0.05
"""[m/s] A free body that is faster than this at two frames in a row is not at the same place to the last bit."""
ASLEEP_CREEP = 1e-6
"""[m] Way of a sleeping body per frame; the engine integrates it not at all."""
ASLEEP_SPEED = 1e-3
"""[m/s] Speed of a sleeping body; the engine puts it to zero."""
TIME = 1e-6
"""[s] Rounding of sums of steps."""
