"""Bounds of forged motions: how much of an event a plain one is."""

HALF = 0.1
"""[m] Half-size of the actors. Own choice; bounds are brought to it."""
WAY = 0.3
"""[m] Own choice: three times the way that makes an event of a motion."""
SOFT = 0.1
"""[m/s] Own choice: at which things touch that nobody would say hit each other."""
LEANS = 0.8
"""[rad] Own choice: just over half a right angle, where what is as high as wide has passed its balance."""
