"""Bounds of the check `navigability`."""

RASTER_NOISE = 0.002
"""[m] How much narrower than real the search may measure a way: points move within cells to a 250th of 5 cm, and corners
of obstacles are sampled."""
OPENING_NOISE = 0.02
"""[1] Share of the width by which an opening may be measured too narrow: points search the middle of their cube in steps of a 64th,
and surfaces are sampled at half a cube."""
CELLS_ACROSS = 3.0
"""[1] Own choice: cells of the fluid's solver across an opening; with fewer the flow through it is not computed but guessed."""
PITCH = 1.2
"""[1] Own choice: steepest mean rise / run over a stretch (50 degrees); building codes end stairs at 42 degrees."""
STRETCH = 0.6
"""[m] Own choice: the stretch, one and a half paces; three quarters of the width for narrower carriers."""
REST = 0.5
"""[1] Own choice: a piece of a region's floor below this share of the largest is a rest behind a wall, and no place to start."""
THRESHOLD = 2.5
"""[1] Own choice: a step up to this many times the allowed one is an oversized step; a higher one is an obstacle."""
GAP = 0.05
"""[m] Own choice: cracks up to this are stepped or rolled over, or an eighth of narrower carriers. Wider than the 13 mm of
ADA 302.3 for floor openings, narrower than the 75 mm between platform and train of 49 CFR 38.53."""
GAPS_PER_WIDTH = 8.0
"""[1] Own choice: a narrower carrier gets over cracks of its width by this."""
SAME_HEIGHT = 1e-4
"""[m] Surfaces closer than this in height are one: a hundredth of a step that anybody feels."""
WADING = {"walker": 0.5, "object": 0.3}
"""[m] Depth of still water that stops a carrier. Source: Cox, Shand & Blacka 2010 (Australian Rainfall and Runoff, project 10):
0.5 m is the limit for the smaller half of people, 0.3 m floats small cars."""
CELL = 0.05
"""[m] Own choice: largest cell of the search; an eighth of the width where that is finer."""
NEAR = 60.0
"""[m] Own choice: the first search over open land looks this far, or half the distance, around the regions; then over all of it."""
STILL = 1e-4
"""[m] Own choice: a part whose corners moved less than this has not moved; a twentieth of the noise of measured widths."""
FITS = 1.01
"""[1] Own choice: tolerance of sizes when asking whether an entity is the carrier that travels."""
SEAM = 1e-9
"""[1] Relative slack of the sides of cells and of the point-in-triangle test, so that a centre on a shared edge is hit."""
VERTICAL = 1e-9
"""[1] A triangle whose normal has a smaller z share is a wall and has no height at a point."""
