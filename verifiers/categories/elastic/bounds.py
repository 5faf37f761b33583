"""Bounds of the questions about elastic bodies: shape, holds, flight, ledgers."""

TRAVEL_SHARE = 0.5
"""[1] Own choice: a surface that moves farther per step than this share of its shortest edge may jump over another."""
CROSSING = 1e-6
"""[1] Relative to the size: surfaces that touch themselves may cross by rounding."""
VOLUME_NOISE = 0.01
"""[1] Own choice: relative change of volume that no material is asked to avoid."""

REST_SPEED = 0.01
"""[m/s] Own choice: slower than one can see on a body of centimetres."""
REST_FRAMES = 3
"""[frames] Own choice: at the end, over which a body must be that slow to count as at rest."""
LOAD_SHARE = 3.0
"""[1] Own choice: a static estimate from beam and column formulas stays within this factor of the truth for a compact body."""
SLIP_SHARE = 0.1
"""[1] Own choice: of the spread of what a pin holds; cells beside a pinned node deform, and their vertices with them."""
FLIGHT = 0.02
"""[1] Of what gravity gives in a frame; centres of vertices and of nodes differ by the second order of the strain."""
FLIGHT_SPEED = 2e-4
"""[m/s] Single precision of cached velocities, with room."""

RECORDS = 0.1
"""[1] Of what is in play: masses at vertices and at nodes sum a field of velocities differently, by the second order of a cell."""
MASS = 0.1
"""[1] Own choice: share of the built volume that a cut lattice may miss; the mass itself is kept."""
RESIDUAL = 1e-3
"""[1] Measured: sags of beams are right within a per cent up to residuals of 5e-2, and off by 10 % at 1."""
REST_HEIGHT = 1e-3
"""[m] Energy scale of a scene where nothing moves: all its weight times this height."""
BOOKS = 1e-9
"""[1] Relative to the largest impulse: sums of the same numbers in another order."""
LEAST = 1e-12
"""[N s] Below it nothing was exchanged."""
FIELD = 0.1
"""[1] Own choice: of the largest impulse in a frame that a field should give, what recorded ones may differ by: masses
at nodes and at vertices part what is pinned differently."""

LINE_PARTS = 8
"""[slices] Own choice: across the longest extent, whose centres are the middle line."""
BEND_SHARE = 0.02
"""[1] Own choice: of its length, how far its middle line bends: a beam at a fiftieth of its length is seen to."""
STRETCH_SHARE = 0.05
"""[1] Own choice: growth of the middle line; stiff bodies that break at a thousandth never stretch so that one sees it."""
WOBBLE_SHARE = 0.01
"""[1] Own choice: of its length, between two turning points."""
TURNS = 2.0
"""[1] Turning points of one period."""

SHIVER_SPEED = 0.02
"""[m/s] Own choice: faster at a frame, it is not at rest, however short its way; faster than frames, it goes no farther to and fro than 0.13 mm."""
SHIVER_SPIN = 0.1
"""[rad/s] The same of its turning: no more than 0.7 mrad."""
