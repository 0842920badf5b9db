"""Time stamp, colour bar and domain edges on a picture."""

import functools
import pathlib

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont

INK = (40, 46, 54)


@functools.lru_cache
def font(size):
    """Return DejaVu Sans, which comes with matplotlib."""
    return ImageFont.truetype(
        str(pathlib.Path(matplotlib.get_data_path()) / "fonts/ttf/DejaVuSans.ttf"), size
    )


def pretty(unit):
    """Return a unit as printed: degC becomes the degree sign and C."""
    return unit.replace("degC", "°C").replace("^2", "²").replace("^3", "³")


def ticks(low, high, count=5):
    """Return round numbers within low .. high."""
    span = high - low
    if span <= 0:
        return [low]
    step = 10.0 ** np.floor(np.log10(span / count))
    step *= next(m for m in (1, 2, 5, 10) if span / (step * m) <= count)
    return [
        float(k * step) for k in range(int(np.ceil(low / step - 1e-9)), int(np.floor(high / step + 1e-9)) + 1)
    ]


def edges(draw, camera, low, high, ink=(176, 182, 190)):
    """Draw the far edges of the box low .. high, in the pixels of ``camera``."""
    corner = np.array([[(low, high)[b][k] for k, b in enumerate(bits)] for bits in np.ndindex(2, 2, 2)])
    view = camera.view(corner)
    if (view[:, 2] <= 0).any():
        return
    pixel = camera.pixels(corner)
    nearest = int(view[:, 2].argmin())
    for a in range(8):
        for k in range(3):
            b = a ^ (4 >> k)
            if a < b and nearest not in (a, b):
                draw.line(
                    [tuple(pixel[a]), tuple(pixel[b])], fill=ink, width=camera.height // 700 + 1
                )


def annotate(picture, time, colouring, counts=""):
    """Return the picture (h, w, 3) uint8 with the time at the lower left and the colour bar at the right."""
    image = Image.fromarray(picture)
    draw = ImageDraw.Draw(image)
    width, height = image.size
    big, small = font(max(11, height // 32)), font(max(9, height // 45))
    margin = height // 28
    draw.text((margin, height - margin), f"t = {time:.3f} s", INK, big, anchor="ls")
    if counts:
        draw.text((width - margin, height - margin), counts, (110, 116, 124), small, anchor="rs")
    if colouring.field != "phase":
        _bar(image, draw, colouring, small, margin)
    return np.asarray(image)


def _bar(image, draw, colouring, face, margin):
    width, height = image.size
    bar, tall = max(8, height // 48), int(height * 0.46)
    x, y = width - margin - bar - int(face.size * 3.4), int(height * 0.27)
    ramp = colouring.rgb(np.linspace(colouring.high, colouring.low, tall))
    pixels = np.repeat((ramp * 255 + 0.5).astype(np.uint8)[:, None], bar, axis=1)
    image.paste(Image.fromarray(pixels), (x, y))
    draw.rectangle([x - 1, y - 1, x + bar, y + tall], outline=(120, 126, 134))
    span = colouring.high - colouring.low
    for value in ticks(colouring.low, colouring.high):
        at = y + tall - 1 - (tall - 1) * ((value - colouring.low) / span if span > 0 else 0.5)
        draw.line([x + bar, at, x + bar + 4, at], fill=INK)
        draw.text((x + bar + 8, at), f"{value:g}", INK, face, anchor="lm")
    unit = f"[{pretty(colouring.unit)}]" if colouring.unit not in ("", "1") else ""
    draw.text((x + bar, y - face.size * 2.5), colouring.field.replace("_", " "), INK, face, anchor="mm")
    draw.text((x + bar, y - face.size * 1.3), unit, INK, face, anchor="mm")
