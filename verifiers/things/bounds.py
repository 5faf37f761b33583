"""Bounds of the rows about things: how far what opens must open, how far shapes of one part may differ."""

OPEN_ANGLE = 1.0472
"""[rad] 60 degrees: there the edge of a door is as far from the jamb as the door is wide (chord 2 w sin 30 = w), so that the way through
is no narrower than the opening; the same of a lid and its box."""
OPEN_SHARE = 0.6
"""[1] Own choice: what turns over less than 100 degrees turns over so much of its range: a sash that tilts, a flap."""
DRAWN_SHARE = 0.7
"""[1] Own choice: a drawer comes out by so much of its travel; slides that come out by three quarters are the plain kind
of hardware."""
GRAZE = 1e-3
"""[m] Own choice: an overlap of two default skins is no stop: what rubs still opens. Frames of the motion have bounds of their own."""
COARSE = 0.1
"""[m] Own choice: travel between two poses that are looked at first; between two that are farther from a surface nothing can be hit."""
FINE = 0.01
"""[m] Own choice: travel between two poses near a surface: what is thinner together with what moves is not found; plates of doors
and drawers are 12 mm or more."""
EXACT = 1e-3
"""[m] Own choice: travel to which the place of the first hit is found."""
PUSHED_MASS = 4.5
"""[kg] Free things that weigh less are pushed away: 22.2 N, with which a door must open (ADA 2010 404.2.9), over friction 0.5 and 9.81 m/s^2."""
CARRIED_MASS = 15.0
"""[kg] What weighs less and is small is taken up and opened elsewhere, as a lantern: most people lift it (ISO 11228-1, annex C)."""
CARRIED_SIZE = 0.501
"""[m] Own choice: and whose longest edge is no longer than half a metre, between two hands."""
LEVEL = 0.05
"""[1] Own choice: of a full turn, how far the axis of a hinge may lean, that what stands on the turning body stays on it (18 degrees)."""
MOVES = 3.0
"""[m] Own choice: a suggested move is no longer."""
SEARCHED = 8
"""[1] Own choice: failing joints of a scene whose suggested move is searched; the others name what is in the way."""

SHAPES_SHARE = 0.02
"""[1] Own choice: collision and visible shape of a part may differ by this share of the part's size: rounded shapes of 16 facets are
1.9 % of the radius off (FACETS of the scale check)."""
SHAPES_LEAST = 0.002
"""[m] Own choice: of small parts by this: twice the gap at which two default skins touch."""

MIDDLE = 0.4
"""[1] Own choice: middle share of the footprint, per axis, over which the height of a seat, a top or a mattress is measured."""
CELLS = 24
"""[1] Own choice: cells per axis over that middle."""
LEVEL_QUANTILE = 0.3
"""[1] Own choice: of the heights of cells in the middle, from below: leaning backs and cushions may be over up to two thirds of them."""
LEVEL_SHARE = 0.999
"""[1] Own choice: cosine to the vertical of the normal of what counts as level, 2.6 degrees; treads are laid to fall by 1 or 2 degrees."""
SAME_TREAD = 0.005
"""[m] Own choice: heights that differ by less are one tread; IBC 1011.5.4 lets risers differ by 9.5 mm."""
TREAD_DEPTH = 0.07
"""[m] Own choice: triangles that are lower than this are rails, strings and nosings; half a foot does not stand on them."""
TREAD_AREA = 0.05
"""[m^2] Own choice: level pieces that are smaller are posts, caps and nosings; half a metre of the narrowest tread has 0.1."""
TREAD_SHARE = 0.4
"""[1] Own choice: of the median area of level pieces; smaller ones are rails and strings."""
LEAF_THIN = 0.25
"""[1] Own choice: a fixed body whose outline from above is no thicker on the mean, as share of its width and height, is a leaf."""
FOOTROOM = 0.3
"""[m] Own choice: where something is nearer above, nobody stands; a boot is lower, and steps over each other are farther apart."""
