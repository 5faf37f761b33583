"""Bounds of the questions about cloth: shape, tears, ledger of momentum, sides of sheets, fluttering."""

LEAST_AREA = 0.1
"""[1] Own choice: a triangle of less than this share of its area at rest has collapsed; folds bend edges, they do not shrink faces."""
SLIP = 1e-5
"""[m] Own choice: places are float64 and exact; bodies' poses between frames turn evenly, which leaves less than this."""

SAME = 1e-6
"""[1] Relative: tensions that two codes find from the same places."""
OVER = 0.05
"""[1] Own choice: share of the strength by which a tension may be over it at two frames in a row without a tear."""
ALIGNED = 0.8
"""[1] Own choice: cosine of an edge to the tension over which it need not open: then a vertex may stay whole."""
REACH = 1.001
"""[1] Allowance on recorded peak speeds for ways between frames."""
UPRIGHT = 0.3
"""[1] A warp that stands steeper across a triangle than this share of it in its plane is laid along the next axis."""

SINGLE = 4e-7
"""[1] Velocities are written in float32: relative error of their sums, several roundings."""
ROUNDING = 1e-9
"""[1] Relative error of sums in float64 that two codes make in another order."""
BOOKS = 1e-6
"""[1] Own choice: share of the momentum that passed through the cloth by which its ledger may be off."""
CUT = 0.02
"""[1] Own choice: share of the momentum exchanged that cut ways may take."""

NEAR = 1.0
"""[largest radii] Particles farther from a sheet than that and all that the two move in a frame are not followed."""
CROSSED = 0.2
"""[1] Own choice: of the radius; a middle nearer than that to a sheet is on neither side for certain."""
STRETCHES = 64
"""[1] Own choice: most stretches of a frame, for which particle and sheet move straight."""
RIM = 1e-9
"""[1] Weight of a corner below which a point lies on the edge opposite of it."""
NOISE = 1e-9
"""[m] Rounding of a distance to a plane."""

FLUTTER_SHARE = 0.1
"""[1] Own choice: share of a sheet's free area that has to flutter as asked. A loose corner is less; of a flag that waves at its fly
end alone a tenth does."""
FLUTTER_NOISE = 0.2
"""[1] Own choice, of the amplitude: a crossing of the mean counts once the point was this far on its other side."""
FLUTTER_ROUNDING = 1e-9
"""[1] Sums of areas are right to such a share."""
CELLS = 300
"""[1] Own choice: cells across the longer side of a shadow; its area is then right to about a thousandth."""

TEAR_SHARE = 0.05
"""[1] Own choice: length of what tore over the side of a square as large as the cloth: a snag is shorter."""
TEAR_PARTS = 0.005
"""[1] Own choice: how far the lips of a tear part, in the same measure: what is open and lies together looks whole."""
