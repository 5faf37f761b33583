"""Bounds of events that liquids and grains have in common, and of the vessels that hold them."""

PACKING = 0.6
"""[1] Share of a heap that is grains: poured spheres have 0.58 to 0.62 (Scott, Nature 188 (1960) 908)."""
VESSEL_CELLS = 24
"""[cells] Own choice: along the longest side of a vessel's box; what is narrower than a cell is no opening of it."""
VESSEL_WAYS = 12
"""[ways] Own choice: level directions in which the walls about a place are looked for."""
ENCLOSED = 0.75
"""[1] Own choice: a place is in a vessel where its walls stand in this share of the level directions: a spout or a hole is open to fewer, and
beside a wall half are open."""
UPRIGHT = 0.26
"""[rad] Own choice: 15 degrees; a vessel that leans no more than this from how it was built stands upright."""
LIES = 1.3
"""[rad] Own choice: 75 degrees; the lip of a vessel that leans more lies about on what bears it, and what runs out has nowhere to fall."""
RIM_CELLS = 1.5
"""[cells] Own choice: what leaves so near to the rim leaves over it; two particles where that is more."""
POUR_SHARE = 0.05
"""[1] Own choice: of the most that was in the vessel; a few drops are spilled, not poured."""
POUR_FALL = 0.1
"""[1] Own choice: of the vessel's height, how far what left falls below where it left; two particles where that is more."""
FILL_SHARE = 0.5
"""[1] Own choice: of the vessel's volume. `min` asks for more."""
FILL_RISE = 0.25
"""[1] Own choice: by how much of the vessel's volume its content rises; sloshing does not change it."""
BRIMFUL = 0.85
"""[1] Own choice: height of the content over that of the vessel's inside from which on it is full: where it runs over a lip is lower than its middle."""
OVERFLOW_SHARE = 0.02
"""[1] Own choice: of the vessel's volume; less is a drip."""
LEAK_SHARE = 0.02
"""[1] Own choice: of the most that was in the vessel; less is a drip."""
FLOW_SECONDS = 0.5
"""[s] Own choice: what passes for less is a surge."""
FLOW_PARTICLES = 8
"""[particles] Own choice: as many as make a splash; fewer are drops that nothing resolves."""
FLOW_ONE_WAY = 0.75
"""[1] Own choice: of all that passes either way, what passes along the normal on balance: what sloshes to and fro has none."""
FLOW_CARRIED = 0.5
"""[1] Own choice: of what passes, what rides along with a body that moves about it."""
RIDES = 0.5
"""[1] Own choice: of its way in a frame, how far off a particle is from where the body about it would have taken it, and rides along."""
SPREAD = 1.5
"""[1] Own choice: area covered over that at the start; sloshing and settling change it by a tenth."""
SPREAD_BORNE = 0.5
"""[1] Own choice: share of its weight that is borne, by its mean acceleration: none in free fall, all at rest."""
SPREAD_CELL = 2.0
"""[particles] Own choice: side of the squares of which the covered ones are counted."""
