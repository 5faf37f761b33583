"""Bounds of the questions about breakable bodies: their pieces, what holds them together, and what broke it."""

VOLUME = 1e-6
"""[1] Relative, own choice: planes cut exactly; `ROUND_VOLUME` for parts with round sides, whose pieces have flat ones."""
ROUND_VOLUME = 5e-3
"""[1] Relative, own choice: of cylinders and spheres, cut into chords."""
CAPPED_VOLUME = 7e-3
"""[1] The same for capsules: their caps are cut into chords along the meridian too; 5.9e-3 without a barrel."""
APART = 1e-6
"""[1] Own choice, of a piece's size: rounding of poses is 1e-12 of it."""
ENERGY = 1e-6
"""[1] Relative to the record of energy, or to 1 J where it is less: sums of the same numbers in another order."""
RATIO = 0.02
"""[1] Own choice: loads are solved for once more after they changed by this much, and stored in double precision."""
ROUNDING = 1e-6
"""[1] Of stresses in single precision."""
OVERLOAD = 1.25
"""[1] Own choice: mean forces over frames are not the forces of steps."""
STEADY = 0.5
"""[s] Own choice: five times what the engine counts as lasting at the default contact time."""
CASES = 24
"""[load cases] Own choice: so many are solved anew at least."""
WORK = 12000
"""[bonds] In all load cases that are solved anew: about a second."""

WITH_FRICTION = 2.0
"""[1] Force of a contact over its normal force: sqrt(1 + mu^2) at friction 1.7."""
BOUNCE = 2.0
"""[1] Momentum that turns round, over what came."""
FAINT = 1e-2
"""[1] Of a piece's weight; the engine calls loads below a tenth of that none."""
TUMBLE = 1.2
"""[1] Own choice: how much faster a tumbling body may turn between two frames than at them."""
NEARLY = 0.9
"""[1] Own choice: the distance that is proposed, over what was reached."""

CRACK_SHARE = 0.01
"""[1] Own choice: share of its bonds from which on a body has a crack that one can see; one bond at least."""
BREAK_SHARE = 0.02
"""[1] Own choice: share of its mass in lumps that came off from which on a body is broken: a chip off an edge is less."""
BREAK_APART = 0.02
"""[1] Own choice: of the body's diagonal, how far off a lump is that has come off: as far as a displacement that is seen (`worlds/noise.py`)."""
