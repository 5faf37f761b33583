"""Bounds of the checks of claims."""

LOOKS = 5
"""[1] Own choice: frames of each shot at which a thing is looked for; its ends, its middle and between."""
STILL_BODIES = 3
"""[1] Own choice: bodies at rest that an event is asked of."""
ORDER_SEEN = 0.02
"""[s] Least time apart at which people tell which of two things came first (Hirsh and Sherrick 1961, doi:10.1037/h0045283)."""
AT_ONCE = 0.1
"""[s] Own choice: greatest time between the beginnings of two events that come at the same time. What follows a blow by up to about a tenth of a
second still seems to come with it (Michotte 1963, The Perception of Causality); who waits for a second one sees it later than that."""
ALIKE = 0.1
"""[1] Own choice: bodies whose extents and volume differ by no more than this share, and their colour by no more than that in each of
red, green and blue, look the same at a glance."""
NEARER = 1.414
"""[1] Ratio at which a value lies as near to a number as to twice it. Own choice: nearness is measured in ratios, as half and twice are."""
AS_BUILT = 1.05
"""[1] Own choice: ratio to a plain number within which a thing is built, starts or is dense as the words say; rounding of what people write."""
AS_SAID = 1.25
"""[1] Own choice: the same of what motion gives, where the number is said plainly; who reads 1.2 m/s may be shown 0.96 to 1.5."""
CROSS_ENDS = 0.1
"""[1] Own choice: share of the extent of what is crossed, within which what comes from one of its ends, or to the other, may begin and end."""
CROSS_BODY = 0.25
"""[1] Own choice: the same at most by half of the size of who crosses: a cart's centre stands that far upon a bridge with its wheels at the end."""
