"""Field types of the scene model: a number in SI, or text with a unit (`melt.units`)."""

import math
from typing import Annotated

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema

from melt import units


class Section(BaseModel):
    """A table of a scene: unknown keys are refused, docstrings describe the keys."""

    model_config = ConfigDict(extra="forbid", validate_default=False, use_attribute_docstrings=True)


def quantity(name, *, above=None, at_least=None, at_most=None, infinite=False, paper=None):
    """Return the type of a scalar of kind ``name`` (`melt.units.QUANTITIES`) within bounds.

    ``paper`` names another kind that holds when ``heat.law`` is "paper" (conductivity is then the plain
    number of the figures, which ``heat.conductivity_scale`` turns into m^2/s).
    """

    def read(value, info):
        if paper and (info.context or {}).get("law") == "paper":
            return units.read(value, paper)
        return units.read(value, name)

    def check(value):
        if math.isnan(value) or (math.isinf(value) and not (infinite and value > 0)):
            raise ValueError(f"{value} is not {'a number or +inf' if infinite else 'finite'}")
        return value

    unit = units.QUANTITIES[name].unit
    if paper:
        unit += f" ({units.QUANTITIES[paper].unit} with heat.law = paper)"
    limits = {"exclusiveMinimum": above, "minimum": at_least, "maximum": at_most}
    schema = {
        "anyOf": [
            {"type": "number", **{k: v for k, v in limits.items() if v is not None}},
            {"type": "string", "examples": [units.QUANTITIES[name].example]},
        ],
        "unit": unit,
    }
    return Annotated[
        float,
        Field(gt=above, ge=at_least, le=at_most),
        AfterValidator(check),
        BeforeValidator(read),
        WithJsonSchema(schema),
    ]


def _never(value):
    return math.inf if value == "never" else value


MOST = 2**31 - 1  # of whole numbers, which the stages take as int32
Count = Annotated[int, Field(ge=0, le=MOST)]
PositiveCount = Annotated[int, Field(gt=0, le=MOST)]
Seed = Annotated[int, Field(ge=0, lt=2**64)]
Number = quantity("number")
NonNegative = quantity("number", at_least=0)
Positive = quantity("number", above=0)
Share = quantity("number", at_least=0, at_most=1)
Length = quantity("length")
PositiveLength = quantity("length", above=0)
Spacing = quantity("length", above=0, at_most=1e12)  # its cube is a number in any precision
Time = quantity("time")
PositiveTime = quantity("time", above=0)
Density = quantity("density", above=0)
Speed = quantity("speed")
PositiveSpeed = quantity("speed", above=0)
Rate = quantity("rate", at_least=0)
ABSOLUTE_ZERO = -273.15
Temperature = quantity("temperature", at_least=ABSOLUTE_ZERO)
MeltingPoint = Annotated[quantity("temperature", at_least=ABSOLUTE_ZERO, infinite=True), BeforeValidator(_never)]
TemperatureDifference = quantity("temperature difference", at_least=0)
Conductivity = quantity("conductivity", at_least=0, paper="number")
SpecificHeat = quantity("specific heat", above=0)
LatentHeat = quantity("latent heat", at_least=0)
HeatRate = quantity("power density", paper="heating rate")
HeatTransfer = quantity("heat transfer coefficient", at_least=0, paper="speed")
DynamicViscosity = quantity("dynamic viscosity", at_least=0)
Expansion = quantity("thermal expansion")
Angle = quantity("angle")
Vector = Annotated[list[Length], Field(min_length=3, max_length=3)]
PositiveVector = Annotated[list[PositiveLength], Field(min_length=3, max_length=3)]
Vector2 = Annotated[list[Length], Field(min_length=2, max_length=2)]
PositiveVector2 = Annotated[list[PositiveLength], Field(min_length=2, max_length=2)]
Velocity2 = Annotated[list[Speed], Field(min_length=2, max_length=2)]
Polygon = Annotated[list[Vector2], Field(min_length=3)]
Velocity = Annotated[list[Speed], Field(min_length=3, max_length=3)]
Acceleration = Annotated[list[quantity("acceleration")], Field(min_length=3, max_length=3)]
Direction = Annotated[list[Number], Field(min_length=3, max_length=3)]
Angles = Annotated[list[Angle], Field(min_length=3, max_length=3)]
