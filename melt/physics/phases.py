"""Numbers of the field ``phase``."""

LIQUID, SOLID, WALL, BUBBLE, VAPOUR, INACTIVE = range(6)
PHASE_NAMES = ("liquid", "solid", "wall", "bubble", "vapour", "inactive")
