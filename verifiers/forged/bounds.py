"""Bounds of forged motions and measures: how much of an event a plain one is."""

HALF = 0.1
"""[m] Half-size of the actors. Own choice; bounds are brought to it."""
WAY = 0.3
"""[m] Own choice: three times the way that makes an event of a motion."""
SOFT = 0.1
"""[m/s] Own choice: at which things touch that nobody would say hit each other."""
LEANS = 0.8
"""[rad] Own choice: just over half a right angle, where what is as high as wide has passed its balance."""
PLAIN = 3.0
"""[1] Own choice: a plain event of matter is three times its threshold, as `WAY` is of that of bodies."""
PLAIN_CYCLES = 6.0
"""[1] Own choice: three times the two cycles that `flutters` asks for by itself."""
PLAIN_WAVE = 0.1
"""[1] Own choice: of the side of a square as large as a sheet, how far to either side it plainly flutters; a flag's fly end goes twice as far."""
PLAIN_OPENING = 0.3
"""[1] Own choice: of a wall's lesser side, how wide and high a hole in it plainly is."""
