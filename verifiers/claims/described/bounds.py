"""Bounds of the check `claim`, of words that describe; sources stand in the modules that use them."""

COLOURED = 0.5
"""[1] Own choice: share of a body's pixels that must have the colour that a word names."""
AMONG = 0.1
"""[1] Own choice: of two colours of one claim, as black and white, each has a tenth of the pixels at least."""
ZINGG = 2.0 / 3.0
"""[1] Ratio of extents below which a stone is flat or long, after Zingg."""
CIRCLE = 0.93
"""[1] Own choice: circularity of what is called round, between a hexagon's 0.907 and a circle's 1; a cylinder of 16 faces has 0.987."""
SQUARE = 0.9
"""[1] Own choice: ratio of sides, and share of its rectangle, of what is called square; a circle fills 0.785."""
DOWN = 30.0
"""[deg] Own choice: least angle below the level at which a view is called one from above."""
NEARER = 0.9
"""[1] Own choice: ratio of the distances, or fields of view, at the end and the start of a push in."""
NEAR = 1.0
"""[1] Own choice: what is beside something is no farther from it than the geometric mean of their lengths: a chair a metre from a table, a person
four metres from a house, a marble two hand's breadths from a bookcase."""
BENEATH = 0.5
"""[1] Own choice: share of the smaller outline, as seen along gravity, that lies within the other's where one is under the other: the larger part of it."""
PLATE = 0.25
"""[1] Own choice: thickness over the lesser of width and height up to which what stands upright is a plate, as a window, with nothing within its outline."""
REVEAL = 0.2
"""[m] Own choice: half of a thick wall. What stands under a window is no farther from its plane than this and half of its own depth."""
TOUCHING = 2.0
"""[1] Own choice: gaps that count as touching, in `limits.contact_gap`: rests are checked by rows of their own."""
WALLS = 3
"""[1] Own choice: level rays of four that meet walls; the fourth wall may be left out for the camera."""
LYING = 0.1
"""[1] Own choice: cover of snow of a snowy land, mean over its cells."""
SWELLS = 0.1
"""[1] Own choice: share of its speed by which a gusty wind swells and ebbs at least, where it does not come and go."""
ALONG = 0.1
"""[1] Own choice: cosine of the azimuth up to which the sun counts as north or south of a place, and as no side of the sky."""
NOTICED = 0.029
"""[1] Just noticeable difference of a length: Teghtsoonian (1971), Psychological Review 78(1)."""
FELT = 0.02
"""[1] Just noticeable difference of a weight, from the same."""
STEEP = 0.20
"""[1] Slope from which on land is steep, tangent of the inclination: Soil Survey Manual (2017), table 3-1."""
LEVEL = 0.03
"""[1] Slope up to which it is nearly level, from the same."""
CLOSE = 0.5
"""[1] Own choice after Salt (1983): share of the picture's height or width that a subject fills in a close shot at least."""
WIDE = 0.75
"""[1] Own choice after Salt (1983): the same in a wide shot at most."""
RISES = 0.1
"""[1] Own choice: part of a body's size by which it goes down or up; less is a wobble."""
MOVES = 0.5
"""[1] Own choice: part of a body's size by which it goes along a way at all."""
TILT = 0.6
"""[rad] Greatest tilt of what still stands: that from which on `topples` speaks of a fall, and `worlds/postures.py` of upright."""
PACE = 0.1
"""[1/s] Own choice: of its own diagonal, how fast what stands, sits, leans or lies may creep or sway; a vase of 30 cm by 3 cm in a second. A fall is
faster within a frame of 24 up to 2 m of diagonal, and bears nothing besides."""
BORNE = 0.5
"""[1] Share of its weight that others bear where it does not fall: the threshold of the event `falls`."""
OPENING = 0.25
"""[s] From frame 0 on, within which what the prompt begins with stands, lies or hangs: as long as `stops` asks for rest; bodies settle into their contacts by then."""
SCENERY = 5.0
"""[m] Own choice: what never moves and is taller is scenery, which lies in its valley however tall."""
