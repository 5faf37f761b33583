"""Bounds of the questions about grains and flying particles."""

MASS = 1e-6
"""[1] Relative to the largest mass: masses are summed in double precision from radii in single precision."""
RECORDS = 1e-4
"""[1] Relative: records are summed before positions and velocities are rounded to single precision."""
HELD = 0.05
"""[1] Of what contacts among grains hold (and of 0.01 of the most): their depths follow from places rounded to single precision."""
MOMENTUM = 1e-4
"""[1] Of the momentum that came and went until then, or of what is there: single precision of the velocities in the cache."""
STRAY = 4.0
"""[radii] Beyond the domain: particles go when lists are made anew, which is before they get farther."""

OVERLAP = 0.1
"""[1] Of the smaller radius. Hertz's law holds while the contact is small against the grain: at a tenth of the radius it is a third of it."""
SCATTER = 0.04
"""[1] Beyond random close packing: radii spread by half of the mean pack up to 0.66, and parts of a bed scatter by 0.01 (measured)."""

FLIGHT = 0.02
"""[1] Own choice: of the way in the frame, beyond a radius: first order of the engine's steps."""
MOST = 400
"""[particles] Own choice: so many are judged per frame."""

REACTION = 1e-6
"""[1] Relative to the largest impulse of the wall in any frame: sums of the same numbers in another order, in double precision."""
FELT = 0.01
"""[1] Own choice: a body feels grains that push it with this share of its weight over a frame."""
SUNK = 0.1
"""[radii] A flying particle is a point at a surface: its middle may be so deep by the rounding of the cache and of facets."""

BURY_SHARE = 0.9
"""[1] Own choice: of what is seen of a body from above; of what is buried a tenth may look out."""
BURY_RISE = 0.5
"""[1] Own choice: by how much that share rises; what lay under grains from the start is not buried anew."""
BURY_GRAINS = 2.0
"""[grains] Own choice: within so many over the body the lowest grain lies on it or on its neighbours."""
