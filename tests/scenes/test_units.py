"""Quantities with units: values, conversions, refusals."""

import math

import pytest

from melt import units
from melt.errors import UnitError


@pytest.mark.parametrize(
    ("text", "quantity", "value"),
    [
        ("-10 degC", "temperature", -10.0),
        ("263.15 K", "temperature", -10.0),
        ("14 degF", "temperature", -10.0),
        ("0.5 K", "temperature difference", 0.5),
        ("20 cm", "length", 0.2),
        ("0.2", "length", 0.2),
        (0.2, "length", 0.2),
        (3, "length", 3.0),
        ("1 atm", "pressure", 101325.0),
        ("1 g/cm^3", "density", 1000.0),
        ("1 g/cm3", "density", 1000.0),
        ("36 km/h", "speed", 10.0),
        ("2.22 W/(m K)", "conductivity", 2.22),
        ("2.22 W/m/K", "conductivity", 2.22),
        ("334 kJ/kg", "latent heat", 334e3),
        ("1 mPa s", "dynamic viscosity", 1e-3),
        ("9.81 m s^-2", "acceleration", 9.81),
        ("1e-2 m²/s", "diffusivity", 1e-2),
        ("inf", "temperature", math.inf),
        ("1 min", "time", 60.0),
    ],
)
def test_quantity_is_read_in_si(text, quantity, value):
    assert units.read(text, quantity) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "quantity", "words"),
    [
        ("5 kg", "temperature", "is a mass, expected a temperature"),
        ("5 K", "length", "is a temperature, expected a length"),
        ("5 mm kg", "length", "expected a length"),
        ("5 kgs", "mass", "did you mean 'kg'"),
        ("five", "mass", "is not a mass"),
        ("5 W/(m", "conductivity", "cannot read the unit"),
        ("5 kg)", "mass", "cannot read the unit"),
        ("5 " + "(" * 12 + "km" + "^9)" * 12, "length", "powers of its units are too large"),
        ("5 " + "(" * 5000 + "km" + ")" * 5000, "length", "cannot read the unit"),
        (True, "length", "is not a length"),
        ([1], "length", "is not a length"),
    ],
)
def test_wrong_quantity_is_refused_with_what_was_expected(text, quantity, words):
    with pytest.raises(UnitError, match=words.replace("(", r"\(").replace("'", "'")):
        units.read(text, quantity)


def test_every_example_reads_as_its_own_quantity():
    for name, quantity in units.QUANTITIES.items():
        assert math.isfinite(units.read(quantity.example, name))
