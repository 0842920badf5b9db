"""What a run is watched for, and what it does on an alarm ([watch])."""

from typing import Annotated, Literal

from pydantic import Field

from melt.scene.quantities import Count, Positive, PositiveSpeed, Section


class FloodWatch(Section):
    """Watchdog of a flood: values that are not finite, columns beyond solver.top_speed, steps beyond their bounds."""

    on_unstable: Literal["stop", "halve"] = "stop"
    """On an alarm: stop, or roll back to the last good state and go on with half the step."""
    halvings: Annotated[int, Field(ge=1, le=10)] = 4
    """Halvings of the step at one place after which the run stops all the same: 4 is down to a sixteenth."""
    quiet: Count = 50
    """Outer steps behind the last alarm after which a halved step is doubled again; 0: it stays halved.

    Each doubling makes the next wait twice as long: one splash costs little, and a run that needs short steps for long is
    not tried at long ones again and again.
    """
    capsule: bool = True
    """On an alarm repeat the failing step stage by stage, and write the inputs of the culprit beside the run file."""


class Watch(FloodWatch):
    """Watchdog: values that are not finite, speeds and density errors beyond reason, solves that do not converge."""

    speed: PositiveSpeed | Literal["auto", "off"] = "auto"
    """A faster particle is an alarm; "auto": far above what falls, flows in or is driven in the scene; none with pressure = pbf."""
    density_error: Positive | Literal["off"] = 0.5
    """A larger mean compression of the liquid, rho/rho_0 - 1 with 0 for what is less dense, is an alarm."""
