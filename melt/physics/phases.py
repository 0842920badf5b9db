"""Numbers of the field ``phase``."""

LIQUID, SOLID, WALL, BUBBLE, VAPOUR, INACTIVE, AIRBORNE = range(7)
PHASE_NAMES = ("liquid", "solid", "wall", "bubble", "vapour", "inactive", "airborne")
