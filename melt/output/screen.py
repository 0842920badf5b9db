"""Liquid by the screen-space renderer: frames from particles, without a mesh. Flood spec 5.

`ScreenRenderer` draws a frame with the stages of `melt.stages_screen` on any backend; `melt.output.screen_run` uses it
for 3-D runs (``melt render --renderer screen``).
"""

from typing import NamedTuple

import numpy as np

from melt import backend as backends
from melt import params as P
from melt.check.compare import stage_function
from melt.errors import MeltError
from melt.fields import FIELDS
from melt.output import relief, splat
from melt.output.shade import HORIZON, LIGHT, SKY, Layer
from melt.state import REAL, dtype_of, shape_of

SMOOTH = ("narrow", "separable", "bilateral")
#: Rounds of the two passes: one leaves the pattern of the particles, of the narrow-range filter too.
ROUNDS = {"separable": 2, "narrow": 2}


class Look(NamedTuple):
    """What liquid looks like: colours of its body and of what it absorbs, over which length [m]; strength of highlights."""

    body: tuple = (0.03, 0.20, 0.30)
    absorb: tuple = (1.0, 0.42, 0.30)
    clarity: float = 1.0
    shine: float = 0.55
    ambient: float = 0.45


class ScreenRenderer:
    """Draws frames with one camera; all buffers of pixels are made once, those of particles when their number changes.

    Args:
        camera: `melt.output.camera.Camera`.
        backend: name of a backend, ``cpu`` unless given.
        smooth: narrow (narrow-range filter), separable (two bilateral passes) or bilateral (the whole window).
        below: positions are on the surface, spheres hang below them (shallow water); thickness reaches down to the
            terrain. Radii of three particle distances give a closed sheet of thin water, which the terrain cuts off.
        look: `Look`. stops: colours of the map of values, (k, 3), or None: the liquid has one colour.
        precision: single or double.

    Attributes: ``skipped``, particles of the last frame that were left out because a number of theirs is not finite;
    ``seconds``, a dict that collects the time of each stage if it is not None.
    """

    def __init__(self, camera, backend="cpu", smooth="narrow", below=False, look=None, stops=None, precision="single"):
        if smooth not in SMOOTH:
            raise MeltError(f"unknown smoothing {smooth!r}: use {', '.join(SMOOTH)}")
        self.camera, self.smooth, self.below = camera, smooth, below
        self.look, self.stops = look or Look(), stops
        self.backend = backend if isinstance(backend, backends.Backend) else backends.load(backend)
        self.precision, self.real = precision, REAL[precision]
        self.skipped, self.seconds = 0, None
        height, width = camera.height, camera.width
        self.sizes = dict(
            pixel_row=height, pixel_column=width, half_row=-(-height // 2), half_column=-(-width // 2), reduction=64,
            stop=2 if stops is None else len(stops), particle=-1,
        )
        self.arrays, self.terrain = {}, None
        for name in (
            "screen_depth screen_depth_next screen_normal screen_length screen_length_next screen_length_sum screen_value"
            " screen_value_sum screen_map picture screen_skipped"
        ).split():
            self._allocate(name)
        if stops is not None:
            self._put("screen_map", np.asarray(stops, float).T)
        self._light()
        self.set_behind(*sky(camera))

    def _allocate(self, name):
        field = FIELDS[name]
        self.arrays[name] = self.backend.upload(np.zeros(shape_of(field, self.sizes), dtype_of(field, self.precision)))

    def _put(self, name, values):
        self.arrays[name] = self.backend.upload(np.ascontiguousarray(values, dtype_of(FIELDS[name], self.precision)))

    def _light(self):
        sun, up = self.camera.axes @ LIGHT, self.camera.axes[:, 2]
        look = self.look
        named = dict(sun=(sun, "xyz"), up=(up, "xyz"))
        absorb, zenith = np.array(look.absorb) / look.clarity, SKY * np.array([0.62, 0.78, 0.97])
        colours = dict(body=look.body, absorb=absorb, zenith=zenith, horizon=HORIZON, nadir=(0.45, 0.47, 0.47))
        named |= {name: (colour, ("red", "green", "blue")) for name, colour in colours.items()}
        self.optics = P.make(
            P.Optics, self.real, fresnel=0.0201, refraction=0.25, mapped=int(self.stops is not None), ambient=look.ambient,
            shine=look.shine, doublings=6, **{f"{name}_{k}": v for name, (values, parts) in named.items() for k, v in zip(parts, values)},
        )

    def _view(self, far):
        c = self.camera
        axes = {f"{name}_{k}": v for name, axis in zip(("right", "down", "forward"), c.axes) for k, v in zip("xyz", axis)}
        eye = dict(zip(("eye_x", "eye_y", "eye_z"), c.eye))
        return P.make(
            P.View, self.real, focal=c.focal, centre_x=c.centre[0], centre_y=c.centre[1], far=far, smallest=0.75, below=int(self.below),
            **eye, **axes,
        )

    def set_behind(self, colour, depth):
        """Take what stands behind the liquid: colour (h, w, 3) 0 to 1, depth (h, w) [m], inf for the sky."""
        self._put("behind_colour", np.moveaxis(np.asarray(colour), 2, 0))
        self._put("behind_depth", depth)

    def set_terrain(self, terrain):
        """Draw a height field as what stands behind the liquid; done once for a terrain.

        terrain: ``elevation`` (ny, nx) [m], NaN for holes; ``lower`` (x, y) of node [0, 0] and ``cell`` (dx, dy) [m], in
        the coordinates of the particles.
        """
        if terrain is self.terrain:
            return
        height = np.asarray(terrain.elevation, float)
        self.sizes.update(relief_row=height.shape[0], relief_column=height.shape[1])
        self._put("relief_height", height)
        (x, y), (dx, dy) = terrain.lower, terrain.cell
        grid = P.make(P.Relief, self.real, lower_x=x, lower_y=y, cell_x=dx, cell_y=dy, base=relief.base(terrain))
        self._allocate("behind_depth")
        self._run("relief_depth", self.arrays["relief_height"], grid, self._view(1.0), self.arrays["behind_depth"])
        depth = self.backend.download(self.arrays["behind_depth"])
        self.set_behind(relief.colours(terrain, self.camera, depth, sky(self.camera)[0]), depth)
        self.terrain = terrain

    def _run(self, name, *arguments):
        function = stage_function(name, self.backend.folder)
        if self.seconds is None:
            function(*arguments)
            return
        import time

        began = time.perf_counter()
        function(*arguments)
        self.backend.synchronize()
        self.seconds.setdefault(name, []).append(time.perf_counter() - began)

    def draw(self, position, radius, value=None, terrain=None):
        """Return the picture (height, width, 3) uint8 of particles at ``position`` (3, n) with ``radius`` (n,) [m].

        value: (n,) places on the map of colours, 0 to 1 (with ``stops``). terrain: see `set_terrain`.
        """
        planes = self.planes(position, radius, value, terrain)
        out = np.empty((self.camera.height, self.camera.width, 3), np.uint8)
        splat.to_bytes(planes, out)
        return out

    def planes(self, position, radius, value=None, terrain=None):
        """Return the picture as planes (3, height, width); they are overwritten by the next frame."""
        if terrain is not None:
            self.set_terrain(terrain)
        view = self.surface(position, radius, value)
        a = self.arrays
        self._run(
            "screen_shade", a["screen_depth"], a["screen_normal"], a["screen_length"], a["screen_value"], a["screen_map"],
            a["behind_depth"], a["behind_colour"], view, self.optics, a["picture"],
        )
        return a["picture"].copy_to_host() if self.backend.on_device else a["picture"]

    def surface(self, position, radius, value=None):
        """Find depth, normals, thickness and values of the liquid's surface; return the `View` used."""
        self._take(position, radius, value)
        a, n = self.arrays, self.sizes["particle"]
        good = radius[np.isfinite(radius) & (radius > 0)] if n else radius
        most, mean = (float(good.max()), float(good.mean())) if len(good) else (1.0, 1.0)
        middle, far = _depths(self.camera, position, most)
        most = max(most, 0.75 * far / self.camera.focal)  # spheres are drawn three quarters of a pixel wide at least
        view = self._view(far)
        filter = P.make(P.Filter, self.real, size=0.85 * mean, smallest=1.0, largest=16.0, range=2 * mean, narrow=3 * mean, clamp=mean)
        # int32 cannot overflow, whatever the particles: every one adds a chord of at most 2 r, or a weight of at most 1
        steps = 2.0**30 / max(n, 4096)
        sums = P.make(P.Splat, self.real, length_steps=steps / (2 * most), value_steps=steps, reach=3 * mean)
        self._run("screen_project", a["position"], a["screen_radius"], view, a["screen_sphere"], a["screen_box"], a["screen_skipped"])
        self.skipped = int(self.backend.download(a["screen_skipped"]).sum())
        drawn = a["screen_sphere"], a["screen_box"]
        self._run("screen_depth", *drawn, a["behind_depth"], view, a["screen_depth"])
        if not self.below:
            self._run("screen_length", *drawn, a["behind_depth"], view, sums, a["screen_length"], a["screen_length_sum"])
            # as wide as the spheres, whose pattern would show through clear liquid
            blur = self.real(np.clip(0.5 * self.camera.focal * mean / middle, 0.7, 12.0))
            self._run("screen_blur", a["screen_length"], blur, np.int32(0), a["screen_length_next"])
            self._run("screen_blur", a["screen_length_next"], blur, np.int32(1), a["screen_length"])
        if self.stops is not None:
            self._run("screen_value", *drawn, a["particle_value"], a["screen_depth"], view, sums, a["screen_value"], a["screen_value_sum"])
        self._smooth(filter, view)
        if self.below:
            longest = self.real(4 * self.look.clarity)
            self._run("screen_column", a["screen_depth"], a["behind_depth"], view, longest, a["screen_length"])
        self._run("screen_normal", a["screen_depth"], view, a["screen_normal"])
        return view

    def _take(self, position, radius, value):
        n = position.shape[1]
        if n != self.sizes["particle"]:
            self.sizes["particle"] = n
            self._allocate("screen_sphere")
            self._allocate("screen_box")
        self._put("position", position)
        self._put("screen_radius", radius)
        self._put("particle_value", np.zeros(n) if value is None else value)

    def _smooth(self, filter, view):
        a = self.arrays
        if self.smooth == "bilateral":
            self._run("bilateral", a["screen_depth"], filter, view, a["screen_depth_next"])
            a["screen_depth"], a["screen_depth_next"] = a["screen_depth_next"], a["screen_depth"]
            return
        name = {"separable": "bilateral_pass", "narrow": "narrow_pass"}[self.smooth]
        for _ in range(ROUNDS[self.smooth]):
            self._run(name, a["screen_depth"], filter, view, np.int32(0), a["screen_depth_next"])
            self._run(name, a["screen_depth_next"], filter, view, np.int32(1), a["screen_depth"])

    def layer(self, position, radius, value=None):
        """Return the liquid's surface as a `melt.output.shade.Layer`, for pictures that put gas into it."""
        self.surface(position, radius, value)
        wanted = ("screen_depth", "screen_normal", "screen_length", "screen_value")
        get = {name: self.backend.download(self.arrays[name]) for name in wanted}
        depth, inside = get["screen_depth"], _doubled(get["screen_length"])[: self.camera.height, : self.camera.width]
        some, weight = (_doubled(v)[: self.camera.height, : self.camera.width] for v in get["screen_value"])
        rgb = np.broadcast_to(np.array(self.look.body, np.float32), (*depth.shape, 3))
        if self.stops is not None:
            at, stops = some / np.maximum(weight, 1e-4), np.asarray(self.stops)
            places = np.linspace(0, 1, len(stops))
            rgb = np.stack([np.interp(at, places, channel) for channel in stops.T], axis=-1).astype(np.float32)
        inside = np.where(np.isfinite(depth), inside, 0).astype(np.float32)
        return Layer(depth, np.ascontiguousarray(np.moveaxis(get["screen_normal"], 0, 2)), rgb, inside)


def _doubled(image):
    return np.repeat(np.repeat(image, 2, 0), 2, 1)


def _depths(camera, position, most):
    """Return the mean depth [m] of particles in front, and the power of two [m] that no sphere reaches, at most 2^20."""
    depth = camera.axes[2] @ (np.asarray(position, np.float32) - camera.eye.astype(np.float32)[:, None])
    depth = depth[np.isfinite(depth) & (depth > 0)]
    if not len(depth):
        return 1.0, 1.0
    return float(depth.mean()), 2.0 ** min(np.ceil(np.log2((float(depth.max()) + 2 * most) * 1.001)), 20)


def sky(camera):
    """Return colour (h, w, 3) and depth (h, w) of an empty picture: sky, and haze below the horizon."""
    rays = camera.rays()
    up = np.clip(rays[..., 2:] / np.linalg.norm(rays, axis=2, keepdims=True) * 2.5, 0, 1)
    return ((1 - up) * HORIZON + up * SKY).astype(np.float32), np.full(rays.shape[:2], np.inf, np.float32)
