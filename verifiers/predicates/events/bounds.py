"""Bounds of kinds of event that happen to bodies; `worlds/predicates/event_kinds.py` states them in the definitions."""

CARRIED = 0.5
"""[1] Own choice: carried by less than this share of its weight, a body is rather falling than lowered: at 0 it falls freely, at 1 it is held."""
BECOMES_MOTION = 0.5
"""[1] Own choice: share of the potential energy lost over an edge that becomes motion of the body or of what it pushes; a hand that
lowers it takes all but little, friction at the edge little."""
HALF_SIZE = 1.0
"""[1] of half the smallest extent. Own choice: a body that comes less far has stirred."""
TURN_TO_ROLL = 3.14
"""[rad] Own choice: half a turn, two faces of a die, so that what falls onto its side does not roll."""
ROLL_SLIP = 0.3
"""[1] Own choice: slip of the contact by way of the centre up to which turning is rolling; 0 is pure rolling, 1 is sliding."""
MOST_SLIP = 0.5
"""[1] The same between two frames: a lump slips where it lands. Own choice."""
ROLL_HOP = 0.1
"""[1] of its half-size. Own choice: what is lumpy leaves the ground between its lumps, no higher than this, and rolls on."""
ROLL_ROUND = 0.3
"""[1] Own choice: way of the contact around the body by what it turns through: 1 for a wheel, 0.45 for a die, 0 for what turns over one edge."""
LAST_TURN = 1.0
"""[rad] Own choice: turning over which the point of contact is followed; a wheel's comes round again after a whole turn."""
ON_FACE = 0.02
"""[rad] Own choice: 1 degree; what has turned less still stands on its face, in the middle of which a push finds it, on whose edge it turns."""
BEARS = 0.5
"""[1] of what contacts bear it with. Own choice: what bears the greater part is what it rolls, slides or tips on, where nobody says which."""
SLIDE_SLIP = 0.5
"""[1] Own choice: slip of the contact by way of the centre from which on motion is sliding."""
TIP_TURN = 0.2
"""[rad] A slab five times as high as thick stands in balance on its edge at atan(1/5) = 0.197; less is a wobble. Own choice."""
PAST_BALANCE = 0.01
"""[1] of the half-size. Own choice: so far the centre has come down from its highest place over the edge, above rounding."""
SPIN_TURN = 6.28
"""[rad] Own choice: one whole turn; less is turning."""
SPIN_OWN = 0.5
"""[1] of the radius of gyration per radian. Own choice: what turns about its own centre takes the centre no farther along; a wheel that
rolls takes it by its radius, more than its radius of gyration."""
LEVEL = 0.7
"""[1] Own choice: cosine of 45 degrees: an axis, a way or a push is rather along a direction than across it."""
STOP_TIME = 0.25
"""[s] Own choice: shorter stillness is a turning point."""
LAND_SPEED = 0.1
"""[1] of the half-size, as a height of free fall. Own choice: slower, it was set down."""
LAND_TIME = 0.2
"""[s] Own choice: it is carried for so long when it has landed; bounces of a hand's breadth last longer."""
BLOW_HEIGHT = 0.01
"""[1] of the smaller half-size, as a height of free fall. Own choice: slower contacts begin without a blow, as in a stack that settles."""
BLOW_LEAST = 0.02
"""[m/s] Own choice: the least closing speed of a blow where gravity gives none; as the floor of `speed` above noise."""
BLOW_OWN = 0.5
"""[1] Own choice: share of the closing speed that is the hitter's; both hit where they meet equally fast."""
BLOW_IMPULSE = 0.1
"""[1] of reduced mass times closing speed. A central blow without bounce gives 1, one at the end of a rod a quarter; own choice below that."""
PUSH_TIME = 0.1
"""[s] Own choice: longer than blows of rigid bodies last, as short as a shove."""
PUSH_WAY = 0.5
"""[1] of the other's half-size. Own choice: less is leaning against it."""
PUSH_ALONG = 0.5
"""[1] Own choice: cosine of 60 degrees between the impulse and the way: what lies on a moving cart is carried, not pushed."""
BOUNCE_BACK = 0.1
"""[1] of the closing speed. Own choice: a tenth of the speed is a hundredth of the energy; less is a rattle."""
BOUNCE_WAY = 0.2
"""[1] of the half-size. Own choice: so far it comes off what it bounced on."""
LIFT_WORK = 0.5
"""[1] of the other's weight times its way up or down. Own choice: the greater part of that energy goes through the lifter."""
WITH = 0.5
"""[1] of the other's way up or down. Own choice: what lifts or lowers by contact alone goes with it, and is not what it lands on."""
PULL_TOWARD = 0.5
"""[1] Own choice: cosine of 60 degrees between the impulse and the direction from the other's centre to the puller's."""
THROW_WORK = 0.5
"""[1] of the energy of motion with which the other leaves. Own choice: the greater part of it is the thrower's work."""
THROW_SPEED = 0.5
"""[1] of the half-size, as a height of free flight. Own choice: slower it was dropped."""
THROW_WAY = 2.0
"""[1] of the half-size. Own choice: it flies at least its own smallest extent."""
SLOW_SHARE = 0.5
"""[1] of the speed that is lost. Own choice: half is seen."""
SLOW_TIME = 0.2
"""[s] Own choice: shorter is a blow."""
SLOW_BLOW = 0.5
"""[1] of the lost speed within one interval. Own choice: more is a blow."""
DRIFT_SPEED = 4.0
"""[1] half-sizes per second. Own choice: what comes its own smallest extent in half a second is carried away, it does not drift."""
DRIFT_WORK = 0.5
"""[1] of all work that drives it. Own choice: the greater part is the medium's or the field's."""
SWING_TURN = 0.05
"""[rad] Own choice: 3 degrees; less is a tremble."""
SWING_BLOW = 0.2
"""[1] of the change of momentum at the turning point. Own choice: what others' contacts give there is no more, else it was struck back."""
SWING_SLOW = 0.5
"""[1] of the greatest rate of the half swing. Own choice: weight or a spring has slowed it so far by the frame before it turns; a stop has not."""
SWING_EVEN = 2.0
"""[1] Own choice: half periods one after the other differ by no more than this factor; a pendulum's period depends little on amplitude."""
JUMP_OUTSIDE = 0.2
"""[1] of the momentum with which it leaves. Own choice: others that move, drivers and fields give no more than that."""
JUMP_REST = 0.2
"""[1] of the speed with which it leaves. Own choice: faster on its way down before, it bounced."""
UPHILL_SLOPE = 0.5
"""[1] of the rise. Own choice: level way by rise of a slope of 63 degrees; steeper, it climbs a wall or is lifted."""
UPHILL_STILL = 0.5
"""[1] of the rise. Own choice: what carries it rises by less itself."""
REST_TIME = 0.25
"""[s] Own choice: as STOP_TIME."""
APPROACH = 0.02
"""[m/s] Own choice: slower, nothing comes towards what it rests against."""
TAKEN = 0.5
"""[1] of the momentum with which it came. Own choice: what ends a motion takes the greater part of it; friction on the way the rest."""
JAM_DRIVE = 0.1
"""[1] of the weight. Own choice: less than a tenth of its weight hardly drives it."""
JAM_HOLD = 0.5
"""[1] of the drive. Own choice: the greater part of the drive is held by the one that it jams against."""
LOOSE_WAY = 0.5
"""[1] of the half-size. Own choice: so far it moves past what held it, or away from it."""
OPEN_GAP = 0.25
"""[1] of the reach from the hinge. Own choice: about 15 degrees, through which one sees."""
SHUT_GAP = 0.05
"""[1] of the reach from the hinge. Own choice: 3 degrees; what is farther from its frame is ajar."""
MIDDLE = 0.35
"""[1] Own choice: from an end of a free edge towards the other; what is between is its middle, off what lies over and under it."""
