"""Bounds of the checks of frame 0: sizes, places, overlaps and what counts as contact."""

LARGEST = 1e4
"""[m] Own choice: rigid worlds end below the size of a mountain; a larger entity is a unit error."""
SMALLEST = 1e-4
"""[m] Own choice: a diagonal below a tenth of a millimetre cannot be drawn or stepped; it is a unit error."""
NOMINAL_FACTOR = 3.0
"""[1] Own choice: real objects of one role differ by less than this; unit errors are factors of 10 to 1000."""
SCENERY = 2e4
"""[1] Own choice: static scenery (a 200 m terrain) may be this much larger than what touches it (a 1 cm pebble)."""
FACETS = 0.02
"""[1] Own choice: a part drawn by facets may fall this short of its shape, per axis: 16 segments miss 1.9 % of the radius."""
SPECK = 1e-6
"""[1] Own choice: a loose piece with less than this share of the surface (6 mm^2 on a cube of 1 m), or a triangle lower than this
share of the diagonal, is dust and gives nothing its size. Else a stray vertex could stand in for a missing length."""
HIDDEN_MASS = 0.1
"""[1] Own choice: parts that lie inside others may weigh this share of those that can be seen: nails, dowels, hinges."""
HIDDEN_SURFACE = 0.95
"""[1] Own choice: a part is hidden when so much of its surface lies inside others."""
HIDDEN_DEPTH = 0.01
"""[1] Own choice: share of its own diagonal by which a part must stand out to be seen; faces in one plane hide each other."""
HIDDEN_TRIANGLES = 500
"""[1] Own choice: largest triangles of a part that are looked at."""
FACES_TOLD = 200
"""[1] Own choice: faces of a mesh that a correction writes out at most; more are no message to an agent."""
DENSER = 2.0
"""[1] Own choice: what lies in a closed cavity is told of where it is so many times as dense as what can be seen: a shelf in a cupboard
makes nothing heavier than solid wood, a lump of iron does."""
SHEET = 0.01
"""[m] Own choice: what is no thicker on the mean, twice its volume by its surface, is sheet or bars and no lump: an oven in a stove."""
ESCAPES = 0.02
"""[1] Own choice: share of the sight lines from a part that may lead out of a cavity that counts as closed: joints between boards."""
SIGHT_PLACES = 64
"""[1] Own choice: triangles of a part from which sight lines go out, even over its area."""
SIGHT_LINES = 96
"""[1] Own choice: directions over the sphere, of which half leave a face."""

CROSSING_NOISE = 1e-6
"""[1] Of the size: files in single precision round vertices by 6e-8 of their coordinates, so that surfaces that touch may cross by a
few of these."""
BETWEEN = 0.5
"""[1] Half way between the winding numbers -1 and 0."""
MARGIN = 1e-4
"""[m] Own choice: a suggested move leaves this clearance, so that its rounding cannot touch again."""
WIDEST = 4.0
"""[1] Own choice: a suggested move longer than this many sizes of the moved body is not suggested."""
FARTHER = 8.0
"""[1] Own choice: a move so many times as long as the shortest one that clears the pair is not suggested."""
SAME_MOVE = 0.05
"""[1] Own choice: of two suggested moves that differ by less than this part of their length, one is enough."""

UNIT_QUATERNION = 1e-6
"""[1] Own choice: a quaternion whose length differs from 1 by more than this is not an orientation."""
GAP_CAP = 0.01
"""[m] The largest `limits.contact_gap` (S3): facet error cannot widen the contact tolerance beyond it."""
SUPPORT_SLOPE = 0.1
"""[1] Own choice: a contact carries when its normal rises at least this steeply (sine), about 6 degrees above level."""
MOVED_SHARE = 0.1
"""[1] Own choice: share of that rise by which a depth may be too small where a body is moved to see what carries it."""

ROUNDING = 1e-6
"""[m] Own choice: quaternions and transforms in double precision, places up to kilometres from the origin; nobody sees a micrometre."""
CORNERS = 2.0
"""[1] Opened along three faces at once a body moves by the root of three summed skins; the rest is for pushes that are not straight."""
SETTLED = 0.1
"""[1] Own choice: of its own diagonal, what a body may move in a preroll that is declared to rest on something."""
ASIDE = 2.0
"""[1] Own choice: of its own declared diagonal, how far aside an entity may come to rest: a stone may roll over, not down the hill."""
SPEED = 1e-4
"""[m/s] Own choice: velocities of bodies are set in double precision, half a step behind their places; those of vertices in single."""
SPEED_SHARE = 1e-4
"""[1] Of the declared speed: the same as SPEED, where that is large."""
LIQUID_MIDDLE = 0.5
"""[spacings] Own choice: of a liquid's middle from that of its declared volume; layers beside walls and slopes are cut unevenly."""
PARTICLE_SPEED = 1e-3
"""[m/s] Own choice: velocities of particles are single precision, those of a current lie between its points."""
FILLED = 0.05
"""[1] Own choice: of the grains that the declared share gives (0.003 off in a tray of 714 grains, 0.001 in one of 351)."""
FEW = 1.0
"""[1] Of the root of the number of grains, beside FILLED: some lie on one side or the other of the surface by chance."""
