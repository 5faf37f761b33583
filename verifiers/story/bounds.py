"""Bounds of the checks `beat`, `causal` and `robustness`."""

STARTED = 0.05
"""[1] Own choice: share of the asked angle below which a fall has not begun, so that waiting for it is no help."""
SETTLING_FRAMES = 2
"""[frame] Own choice: a closest approach this near to the end of the run counts as still under way."""
BEHIND = 0.5
"""[1] Own choice: grains stay behind when at least this share of what is lacking lies higher than what came."""
MORE = 1.2
"""[1] Own choice: a suggestion gives so many times the frames or the room that it takes."""
FLICKER = 1
"""[frame] Own choice: two touches with at most so many frames between them are one; a resting body's log has such gaps."""

OUTRUNS = 0.05
"""[1] Own choice: what goes faster by so much of the speed of what pushed it leaps ahead of it."""
FREE_BOUNCE = 0.2
"""[1] A pair may have so much less restitution than its materials without a reason (`worlds/audits/pairs.py`)."""
HEAVY = 3.0
"""[1] Own choice: what is so many times as heavy as what it meets keeps three quarters of its speed, and more mass gives it little."""
DROPPED = 0.1
"""[1] of the half-size. Own choice: what sinks so far while it is pushed goes over an edge."""
AFTER_FRAMES = 2
"""[frame] Own choice: what has parted from its pusher shows within so many frames that it falls."""
SPARE = 1.2
"""[1] Own choice: factor on a computed speed or way, for what the estimate leaves out."""
MOST_FASTER = 3.0
"""[1] Own choice: no patch raises a speed by more; where so much lacks, something else is wrong."""

MOVED = 4.0
"""[1] Own choice: what has come so many times as far as a resting body may creep has left its place."""
LEAST_CHANGE = 0.05
"""[1] Own choice: a value that changes by less than this share of what it was with the cause has not changed, whatever margin was
declared: chaos alone moves numbers by a little."""

HELPED = 0.05
"""[1] Own choice: work of a helper on a body counts from this share of the greatest kinetic energy on that the body has had by then; what is
pushed slowly against friction soon exceeds it."""

OWNED = 0.05
"""[1] Own choice: a force brings about the motion of what starts with a velocity from this share of its momentum on, as `HELPED`."""

LEAST_WORK = 1e-6
"""[J] Own choice: work below this moves nothing that is seen; it lifts 1 g by 0.1 mm."""

CONFIDENCE = 0.95
"""[1] Own choice: confidence of the interval told beside the share of samples in which a beat comes true."""
TURNED = 0.02
"""[rad] Own choice: what turns by less has not been moved by anything; as `support_drift` for positions."""
MOST_WITHOUT = 4
"""[run] Own choice: most sets of drivers that no beat tells of and that are taken away in runs of their own, and as many again of single
drivers, to name the one that a beat needs; each costs at most one simulation, and one run mostly serves all beats."""
