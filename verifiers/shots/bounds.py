"""Bounds of the check `shots`."""

SCREEN_STEP = 0.2
"""[1] Own choice: a picture that moves by more than a fifth of its width per frame cannot be followed by eye."""
MOMENT = 0.25
"""[s] Own choice: the frame at which a beat comes true is shown when its subject is seen within this time of it."""
NEAR_PLANE = 1e-3
"""[m] What is nearer than this plane the renderer cuts off (`near_clip` in `rendering/tracer/scene.py`)."""
FILL = 0.15
"""[1] Own choice: share of the picture's height that a subject fills in a suggested view."""

SEEN_NOISE = 3.0
"""[1] Own choice: a pixel shows a subject where it differs by more than so many times the noise of the difference; of
normal noise in one channel 0.3 % of the pixels do by chance."""
JUST_NOTICEABLE = 2.3
"""[1] Least difference of CIELAB colours that counts, however little noise there is. Mahy, Van Eycken and Oosterlinck (1994), Evaluation
of uniform color spaces developed after the adoption of CIELAB and CIELUV, Color Research and Application 19(2): a just noticeable one."""
SEEN_SHARE = 0.25
"""[1] Own choice: share of a subject's pixels that must differ. A box shows three faces at most, of which one must stand out, less what
its edges lose; noise alone gives under 0.01."""
SEEN_PIXELS = 9
"""[pixels] Own choice: a subject that fills fewer of a plate, three by three, is a dot."""
DARK = 8.0
"""[1] Own choice: lightness (CIELAB L*) below which a screen in a lit room shows black: 0.9 % of white is what its glass reflects."""
BRIGHT = 98.0
"""[1] Own choice: lightness (CIELAB L*) from which on an eye can tell nothing from white, less than `JUST_NOTICEABLE` away."""
MIDDLE_GREY = 0.18
"""[1] Own choice: luminance of white to which a suggested exposure brings a subject, that of a photographer's grey card."""
