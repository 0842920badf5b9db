"""Numbers of the field ``phase``."""

LIQUID, SOLID, WALL, BUBBLE, VAPOUR, INACTIVE, AIRBORNE, DRIVEN = range(8)
PHASE_NAMES = ("liquid", "solid", "wall", "bubble", "vapour", "inactive", "airborne", "driven")
