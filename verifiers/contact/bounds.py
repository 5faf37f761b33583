"""Bounds of the check `contact`, of the contact log and of the travel per step."""

TUNNEL_SHARE = 0.25
"""[1] Own choice: deeper than this share of the thinner body, in two frames running or between two, is no contact any more. Depth
is that of the deepest surface point and cannot exceed half the thinner body, so this is half of what is possible."""
PRECISION = 0.5
"""[1] Own choice: the deepest place of a path that might be displaced is found within this share of the wanted depth."""
BENT = 0.1
"""[1] Own choice: a path counts as bent when it may leave the cubic by more than this share of the wanted depth."""
BEYOND = 1.1
"""[1] Own choice: a displacement goes this much farther than the depth it escapes."""
ROUNDING = 1e-9
"""[m] Own choice: two bodies whose places against each other differ by less are as they were. Pieces of one lump, written in double
precision, differ by 1e-15 (measured)."""
JOIN = 1e-3
"""[1] Own choice: share of an interval before and after logged contacts in which the path is drawn straight."""

THICKNESS_SHARE = 0.5
"""[1] A body that travels more than half of a collider's thickness in one step may be pushed out on the far side."""
EXPLAINED = 1.02
"""[1] Own choice: the recorded travel is that of a body whose own, by the frames' ends and gravity, is within two per cent of it."""

LOG = 1e-6
"""[1] Relative: sums over the same steps in another order; measured 1e-15."""
CONE = 1e-3
"""[1] Relative: to this the engine meets the cone of friction while a body slides."""
PAUSE = 0.005
"""[s] A pair that has not touched for longer than this begins a new contact, as the solvers log it."""

SKIN_FACTOR = 1.5
"""[1] Own choice: the suggested skin covers the measured depth this many times, since finer steps shift the deepest frame."""
SKIN_SHARE = 0.9
"""[1] Share of the contact tolerance that two skins may take (`worlds/audits/audit.py`)."""
SKIN_MAX = 0.02
"""[m] Largest skin that the specification takes."""
CRUMBLE_FACTOR = 1.2
"""[1] Own choice: faces crumble by so many times the overlap that was measured: more yield lets the next blow go deeper."""
