"""Bounds of the check `support`: what counts as held, at rest, landed or launched."""

OUTSIDE = 0.002
"""[m] Own choice: how far the centre of mass may seem to stand outside the contact polygon (facets, gap tolerance)."""
MISSING = 0.01
"""[1] Own choice: share of a body's weight that contact and friction may seem to lack (facets, rounded friction pyramids)."""
FLATS = 0.1
"""[1] Own choice: half width of a wheel's flats, of its radius, up to which it counts as round: 32 sides and more."""
LEVEL_CONTACT = 1e-3
"""[1] Own choice: contact normals this near to the vertical (sine) make a contact of which the polygon decides."""
SAME_PLACE = 1e-4
"""[m] and [1] of rotation matrices. Own choice: frames that differ less have one balance of forces."""
EDGE_SLACK = 5e-4
"""[m] Own choice: points this much farther than the nearest belong to one flat contact."""
BEND = 0.02
"""[1] Own choice: a surface may fall this steeply (sine, 1.1 degrees) behind a contact plane and still touch it flatly."""
SAME_NORMAL = 1e-3
"""[1] Own choice: normals that differ less than this are one."""

HELPS = 0.1
"""[1] Own choice: a liquid helps to carry a body when it pushes it up with this share of its weight over a frame."""
BEARS = 0.5
"""[1] Own choice: a liquid carries a body when it bears this share of its weight over the interval."""
CARRIES = 0.9
"""[1] Own choice: a force driver or a field holds a body when it carries this share of its weight at frame 0."""
LAUNCH_SPEED = 0.1
"""[m/s] Own choice: a slower initial velocity is no launch and does not explain a body in the air."""
GRIP_TIME = 0.1
"""[s] Own choice: a body that nothing presses has fallen 49 mm by then, ten times the default `support_drift`."""
LEFT = 1e-4
"""[m] Own choice: clearance that a suggested move leaves."""

TURNED = 0.02
"""[1] of quaternions, 0.04 rad. Own choice: a path that turns by less and goes no farther than a supported body may creep stays."""
STIRRED = 2e-4
"""[m] Own choice: a body that has not left its place by this much passes no motion on; bodies settle into their skins by less."""
FALLING = 0.5
"""[m/s] Own choice: slower bodies may still be held by something; a free fall is faster after 13 mm."""
RESOLVED = 1.0
"""[rad] Own choice: a spring that turns further in its phase within a frame is not resolved by the frames' states. A cubic
through them is then wrong by up to 1 / 384 of the amplitude (Hermite interpolation)."""

SEAM_SHARE = 0.01
"""[1] Own choice: of the smaller of two static things, the widest gap between them: a seam that nobody takes for air."""
SEAM_LEAST = 2e-4
"""[m] Own choice: seams of small things; suggested moves leave LEFT."""
SEAM_MOST = 2e-3
"""[m] Own choice: seams of large things: two skins of 1 mm, which people leave under everything that stands."""
FITTED = 5e-5
"""[m] Own choice: what is drawn as near to a wall as this fits it so closely that friction may hold it, as a book in a full shelf."""

HANGING = 0.05
"""[m] Own choice: gap that may stay open under a level base on natural ground; turf and gravel close it."""
SUNK = 0.5
"""[m] Own choice: depth of a foundation; a house that stands deeper has its ground floor in the ground, unless a `fastened`
relation says how deep it is meant to be."""
BASE = 0.05
"""[m] Own choice: level underside this near to an entity's lowest point is its base."""
LEVEL_BASE = 0.999
"""[1] Own choice: cosine up to which an underside is level (2.6 degrees)."""
BROAD = 0.02
"""[1] Own choice: a level base has at least this share of the footprint; round things have none and are not asked to lie flat."""
OVER_EDGE = 0.002
"""[m] Own choice, that of OUTSIDE: how far the centre may seem to lie outside the places that it stands on."""

SIDE_LEVEL = 1e-4
"""[1] Own choice: share of a body's size within which a drawn face lies on the side of its box; bonds to the world are as strict."""
SIDE_SAMPLES = 8
"""[1] Own choice: pieces into which each edge of a bonded side's triangles is cut, to look for what never moves at it."""
RIM = 1.5
"""[1] Own choice: in reaches, how far from the rim of a bonded side it has to meet what holds it; what only its rim touches does not."""

LUMPS_MOST = 200
"""[1] Own choice: meshes of more lumps are foliage, gravel or cloth in one surface, and are not asked to hang together."""

BOND = 1e6
"""[Pa] Own choice: what glue, plaster, nails or screws bear on the mean over the places at which static things touch from the side, plastic,
each place and direction by itself. Construction glues bear 3 to 10 MPa over their own area, which is a part of that; what is bolted or
welded bears more, and says `fastened`."""
BOND_MOST = 1e3
"""[1] Own choice: weights beyond which it is not told how many a joint bears."""

CLUMP = 2.0
"""[distances of particles] Own choice: edge of the cubes through which particles hang together; a gap of two parts them."""
LOOSE_REACH = 3.0
"""[distances of particles] Own choice: matter this near to a solid lies on it: grid liquids begin up to a cell, two distances, off walls."""
SIDEWAYS = 0.2
"""[1] Own choice: cosine to gravity from which a nearest surface is beneath, not beside: a slope of 78 degrees; steeper ones are asked straight down."""
HANGING_SHARE = 0.01
"""[1] Own choice: share of loose matter that may hang in the air at frame 0: drops at a rim that its volume cuts off."""
LOWEST_ASKED = 4000
"""[1] Own choice: most columns of loose matter whose lowest particle is asked."""
