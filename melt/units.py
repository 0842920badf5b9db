"""Quantities with units, read at the border: ``"-10 degC"``, ``"0.2 m"``, ``"5 W/(m K)"``.

Inside melt every number is SI (temperatures in degC), so nothing else knows about units.
"""

import difflib
import math
import re
from fractions import Fraction
from typing import NamedTuple

from melt.errors import UnitError


class Quantity(NamedTuple):
    """One kind of quantity: exponents of (kg, m, s, K), the unit of plain numbers, an example."""

    name: str
    dimension: tuple
    unit: str
    example: str


_LIST = [
    Quantity("number", (0, 0, 0, 0), "1", "0.5"),
    Quantity("mass", (1, 0, 0, 0), "kg", "2 kg"),
    Quantity("length", (0, 1, 0, 0), "m", "0.2 m"),
    Quantity("area", (0, 2, 0, 0), "m^2", "1 m^2"),
    Quantity("volume", (0, 3, 0, 0), "m^3", "1 m^3"),
    Quantity("discharge", (0, 3, -1, 0), "m^3/s", "19.7 m^3/s"),
    Quantity("time", (0, 0, 1, 0), "s", "5 ms"),
    Quantity("temperature", (0, 0, 0, 1), "degC", "20 degC"),
    Quantity("temperature difference", (0, 0, 0, 1), "K", "0.5 K"),
    Quantity("heating rate", (0, 0, -1, 1), "K/s", "5 K/s"),
    Quantity("density", (1, -3, 0, 0), "kg/m^3", "1000 kg/m^3"),
    Quantity("speed", (0, 1, -1, 0), "m/s", "8 m/s"),
    Quantity("acceleration", (0, 1, -2, 0), "m/s^2", "9.81 m/s^2"),
    Quantity("rate", (0, 0, -1, 0), "1/s", "0.1 1/s"),
    Quantity("force", (1, 1, -2, 0), "N", "1 N"),
    Quantity("pressure", (1, -1, -2, 0), "Pa", "1 atm"),
    Quantity("energy", (1, 2, -2, 0), "J", "1 kJ"),
    Quantity("power", (1, 2, -3, 0), "W", "1 kW"),
    Quantity("dynamic viscosity", (1, -1, -1, 0), "Pa s", "1 mPa s"),
    Quantity("diffusivity", (0, 2, -1, 0), "m^2/s", "0.3 m^2/s"),
    Quantity("conductivity", (1, 1, -3, -1), "W/(m K)", "2.22 W/(m K)"),
    Quantity("specific heat", (0, 2, -2, -1), "J/(kg K)", "4187 J/(kg K)"),
    Quantity("latent heat", (0, 2, -2, 0), "J/kg", "334 kJ/kg"),
    Quantity("power density", (1, -1, -3, 0), "W/m^3", "1 kW/m^3"),
    Quantity("heat transfer coefficient", (1, 0, -3, -1), "W/(m^2 K)", "10 W/(m^2 K)"),
    Quantity("thermal expansion", (0, 0, 0, -1), "1/K", "2.1e-4 1/K"),
    Quantity("angle", (0, 0, 0, 0), "deg", "90 deg"),
]
QUANTITIES = {quantity.name: quantity for quantity in _LIST}

_TABLE = {  # name: (factor to SI, exponents of kg, m, s, K)
    "1": (1.0, (0, 0, 0, 0)), "%": (0.01, (0, 0, 0, 0)), "deg": (1.0, (0, 0, 0, 0)),
    "rad": (180.0 / math.pi, (0, 0, 0, 0)),
    "kg": (1.0, (1, 0, 0, 0)), "g": (1e-3, (1, 0, 0, 0)), "t": (1e3, (1, 0, 0, 0)),
    "m": (1.0, (0, 1, 0, 0)), "km": (1e3, (0, 1, 0, 0)), "cm": (1e-2, (0, 1, 0, 0)),
    "mm": (1e-3, (0, 1, 0, 0)), "um": (1e-6, (0, 1, 0, 0)), "in": (0.0254, (0, 1, 0, 0)),
    "ft": (0.3048, (0, 1, 0, 0)), "l": (1e-3, (0, 3, 0, 0)),
    "s": (1.0, (0, 0, 1, 0)), "ms": (1e-3, (0, 0, 1, 0)), "us": (1e-6, (0, 0, 1, 0)),
    "min": (60.0, (0, 0, 1, 0)), "h": (3600.0, (0, 0, 1, 0)), "day": (86400.0, (0, 0, 1, 0)),
    "Hz": (1.0, (0, 0, -1, 0)), "K": (1.0, (0, 0, 0, 1)), "degC": (1.0, (0, 0, 0, 1)),
    "degF": (Fraction(5, 9), (0, 0, 0, 1)), "N": (1.0, (1, 1, -2, 0)), "kN": (1e3, (1, 1, -2, 0)),
    "Pa": (1.0, (1, -1, -2, 0)), "mPa": (1e-3, (1, -1, -2, 0)), "hPa": (1e2, (1, -1, -2, 0)),
    "kPa": (1e3, (1, -1, -2, 0)), "MPa": (1e6, (1, -1, -2, 0)), "bar": (1e5, (1, -1, -2, 0)),
    "atm": (101325.0, (1, -1, -2, 0)), "J": (1.0, (1, 2, -2, 0)), "kJ": (1e3, (1, 2, -2, 0)),
    "MJ": (1e6, (1, 2, -2, 0)), "cal": (4.184, (1, 2, -2, 0)), "W": (1.0, (1, 2, -3, 0)),
    "mW": (1e-3, (1, 2, -3, 0)), "kW": (1e3, (1, 2, -3, 0)), "MW": (1e6, (1, 2, -3, 0)),
}
# factors as they are written: a decimal number has no rounding before it is multiplied
_UNITS = {name: (Fraction(str(factor)), dimension) for name, (factor, dimension) in _TABLE.items()}
_ALIASES = {"°C": "degC", "C": "degC", "celsius": "degC", "°F": "degF", "F": "degF", "kelvin": "K",
            "sec": "s", "hour": "h", "°": "deg", "L": "l", "inch": "in", "meter": "m", "metre": "m"}
_NUMBER = re.compile(r"\s*([+-]?(?:inf|nan|(?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?))(.*)", re.S)
_TOKEN = re.compile(r"\s*(\^-?\d+|[()/]|[^\s()/^]+)")
_OFFSET = {"K": Fraction("-273.15"), "degC": Fraction(0), "degF": Fraction(-160, 9)}
_LARGEST_POWER = 9  # of a unit; more is a slip of the pen
_LONGEST = 1000  # bits of a factor: powers of powers of powers have more than there is memory


def read(value, quantity):
    """Return ``value`` (a number, or text with a unit) as a float in the unit of ``quantity``.

    ``quantity`` names an entry of `QUANTITIES`; temperatures come back in degC.

    Raises:
        UnitError: not a quantity, an unknown unit, or a unit of another kind.
    """
    kind = QUANTITIES[quantity]
    advice = f"give a number in {kind.unit} or text such as '{kind.example}'"
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise UnitError(f"{value!r} is not {_article(kind.name)}: {advice}")
    if not isinstance(value, str):
        return _double(value)
    match = _NUMBER.fullmatch(value)
    if match is None:
        raise UnitError(f"{value!r} is not {_article(kind.name)}: {advice}")
    digits, unit = match[1].replace("_", ""), match[2].strip()
    if not unit:
        return float(digits)
    if quantity == "temperature" and (name := _ALIASES.get(unit, unit)) in _OFFSET:
        return _converted(digits, _UNITS[name][0], _OFFSET[name])
    factor, dimension = unit_of(unit, value)
    if dimension != kind.dimension:
        expected = f"expected {_article(kind.name)} such as '{kind.example}'"
        raise UnitError(f"{value!r} is {_article(_name(dimension))}, {expected}")
    return _converted(digits, factor)


def duration(text, option, zero=False):
    """Return a time [s] given for ``option`` of a command: above 0, or of 0 too.

    Raises:
        UnitError: it is no time, or not one that is allowed.
    """
    seconds = read(text, "time")
    if not (0 <= seconds if zero else 0 < seconds) or seconds == math.inf:
        raise UnitError(f"{option} {text}: it must be a time {'of 0 s or more' if zero else 'above 0 s'}, such as '{2 if zero else 60} s'")
    return seconds


def _converted(digits, factor, offset=0):
    """Return digits * factor + offset, rounded once: 70 cm and 0.7 m are the same number."""
    number = float(digits)
    if number == 0 or not math.isfinite(number) or len(digits) > 400:  # their exact values may have more digits than there is memory
        return number * float(factor) + float(offset)
    return _double(Fraction(digits) * factor + offset)


def _double(value):
    """Return a number as a float; whole numbers may be too large for one, and are then infinite."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def unit_of(text, context=None):
    """Return (factor to SI as a fraction, exponents of kg, m, s, K) of a unit such as ``W/(m^2 K)``."""
    plain = text.replace("²", "^2").replace("³", "^3").replace("**", "^").replace("*", " ").replace("·", " ")
    plain = re.sub(r"(?<=[A-Za-z])([23])(?![\d^])", r"^\1", plain)  # m3 as m^3
    tokens = _TOKEN.findall(plain)
    try:
        factor, dimension, rest = _product(tokens, context or text)
    except (IndexError, RecursionError):
        rest = ["end"]
    if rest:
        raise UnitError(f"{context or text!r}: cannot read the unit {text!r}; write for instance 'W/(m^2 K)'")
    return factor, dimension


def _product(tokens, context):
    """Read factors up to the end or a closing bracket."""
    factor, dimension, sign = Fraction(1), (0, 0, 0, 0), 1
    while tokens and tokens[0] != ")":
        token, *tokens = tokens
        if token == "/":
            sign = -1
            continue
        if token == "(":
            f, d, tokens = _product(tokens, context)
            tokens = tokens[1:] if tokens else [][0]
        else:
            f, d = _unit(token, context)
        power = sign
        if tokens and tokens[0].startswith("^"):
            if len(tokens[0]) > 3 or abs(int(tokens[0][1:])) > _LARGEST_POWER:
                raise UnitError(f"{context!r}: the power {tokens[0]} of a unit is too large, at most {_LARGEST_POWER}")
            power, tokens = sign * int(tokens[0][1:]), tokens[1:]
        factor *= f**power
        if max(factor.numerator.bit_length(), factor.denominator.bit_length()) > _LONGEST:
            raise UnitError(f"{context!r}: the powers of its units are too large")
        dimension = tuple(a + power * b for a, b in zip(dimension, d))
        sign = 1
    return factor, dimension, tokens


def _unit(token, context):
    name = _ALIASES.get(token, token)
    if name not in _UNITS:
        close = difflib.get_close_matches(token, [*_UNITS, *_ALIASES], 1)
        hint = f"did you mean {close[0]!r}?" if close else f"known units: {', '.join(sorted(_UNITS))}"
        raise UnitError(f"{context!r}: unknown unit {token!r}; {hint}")
    return _UNITS[name]


def _name(dimension):
    for quantity in _LIST:
        if quantity.dimension == dimension:
            return quantity.name
    parts = [f"{u}^{e}" for u, e in zip(("kg", "m", "s", "K"), dimension) if e]
    return "quantity in " + " ".join(parts)


def _article(name):
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"
