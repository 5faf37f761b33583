"""Bounds of the check `shots`."""

SCREEN_STEP = 0.2
"""[1] Own choice: a picture that moves by more than a fifth of its width per frame cannot be followed by eye."""
MOMENT = 0.25
"""[s] Own choice: the frame at which a beat comes true is shown when its subject is seen within this time of it."""
NEAR_PLANE = 1e-3
"""[m] What is nearer than this plane the renderer cuts off (`near_clip` in `rendering/tracer/scene.py`)."""
FILL = 0.15
"""[1] Own choice: share of the picture's height that a subject fills in a suggested view."""
