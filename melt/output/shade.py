"""Light, ground and translucency: from depth buffers to a picture.

Geometry is drawn at twice the size of the picture and averaged (antialiasing). Solids are opaque
with a bright highlight and dark outlines; liquid lets what is behind it shine through by the law of
Beer and Lambert over the length of the ray inside it.
"""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter

from melt.output import splat
from melt.output.camera import Camera, look

OVERSAMPLE = 2
LIGHT = np.array([-0.50, -0.62, 1.15]) / np.linalg.norm([-0.50, -0.62, 1.15])  # towards the light
SKY, HORIZON, FLOOR = (
    np.array(c, np.float32) for c in ((0.82, 0.88, 0.94), (0.97, 0.975, 0.98), (0.885, 0.89, 0.90))
)
#: Sky, horizon and floor where white vapour is to be seen before them.
DUSK = tuple(np.array(c, np.float32) for c in ((0.58, 0.66, 0.75), (0.76, 0.81, 0.86), (0.79, 0.81, 0.83)))
#: What a liquid's surface lets through: at least, and more of thin liquid, over how many spacings.
CLEAR, CLEARER = (0.18, 0.55, 10), (0.30, 0.55, 20)
_MAP = 1024  # pixels of the shadow map


class Spheres(NamedTuple):
    """Particles to draw: centre (n, 3) and radius (n,) [m], colour (n, 3)."""

    centre: np.ndarray
    radius: np.ndarray
    rgb: np.ndarray


class Layer(NamedTuple):
    """What is in front at each pixel: depth [m] (inf for nothing), normal in the camera frame, colour,
    length of the ray inside [m]."""

    depth: np.ndarray
    normal: np.ndarray
    rgb: np.ndarray
    inside: np.ndarray


def numbers(camera):
    """Return focal length and centre of a camera as the drawing functions take them."""
    return np.float32(camera.focal), np.float32(camera.centre[0]), np.float32(camera.centre[1])


def sphere_layer(shapes, camera, behind=None):
    """Return the `Layer` of spheres; ``behind`` limits the length of rays in them."""
    size = (camera.height, camera.width)
    depth, index = np.full(size, np.inf, np.float32), np.full(size, -1, np.int32)
    centre = camera.view(shapes.centre).astype(np.float32)
    radius = shapes.radius.astype(np.float32)
    splat.spheres(centre, radius, *numbers(camera), depth, index)
    inside = np.zeros(size, np.float32)
    if behind is not None:
        splat.thickness(centre, radius, *numbers(camera), behind, inside)
    hit = index >= 0
    normal, rgb = np.zeros((*size, 3), np.float32), np.zeros((*size, 3), np.float32)
    i = index[hit]
    rows, columns = np.nonzero(hit)
    z = centre[i, 2]
    scale = np.maximum(radius[i] / z * np.float32(camera.focal), 0.75)
    u = (columns + 0.5 - (centre[i, 0] / z * camera.focal + camera.centre[0])) / scale
    v = (rows + 0.5 - (centre[i, 1] / z * camera.focal + camera.centre[1])) / scale
    normal[hit] = np.stack([u, v, -np.sqrt(np.maximum(1 - u * u - v * v, 0))], axis=-1)
    rgb[hit] = shapes.rgb[i]
    return Layer(depth, normal, rgb, inside)


def mesh_layer(mesh, rgb, camera, behind=None):
    """Return the `Layer` of a closed mesh with vertex colours (v, 3)."""
    size = (camera.height, camera.width)
    depth = np.full(size, np.inf, np.float32)
    inside, out = np.zeros(size, np.float32), np.zeros((*size, 6), np.float32)
    v = camera.view(mesh.vertices)
    corner = np.concatenate([camera.pixels(mesh.vertices), 1 / v[:, 2:]], axis=1)[mesh.faces]
    value = np.concatenate([mesh.normals @ camera.axes.T, rgb], axis=1).astype(np.float32)[mesh.faces]
    behind = np.full(size, np.inf, np.float32) if behind is None else behind
    splat.triangles(corner, value, np.minimum(behind, 1e9), depth, inside, out)
    normal = out[..., :3]
    normal = normal / np.maximum(np.linalg.norm(normal, axis=2, keepdims=True), 1e-6)
    return Layer(depth, normal, out[..., 3:], np.maximum(inside, 0))


def _moved(d, rows, columns):
    """Return d moved by whole pixels, its borders repeated."""
    h, w = d.shape
    r, c = np.clip(np.arange(h) + rows, 0, h - 1), np.clip(np.arange(w) + columns, 0, w - 1)
    return d[r][:, c]


class Stage:
    """The ground and the light of one camera: everything that does not change from frame to frame."""

    def __init__(self, camera, low, high, spacing, colours=(SKY, HORIZON, FLOOR)):
        s = OVERSAMPLE
        self.camera = camera._replace(
            focal=camera.focal * s, width=camera.width * s, height=camera.height * s, shift=camera.shift * s
        )
        self.spacing, self.size = spacing, float(np.linalg.norm(high - low))
        self.far = float(np.linalg.norm(camera.eye - (low + high) / 2)) + 1.5 * self.size
        rays = self.camera.rays()
        self.coarse_rays = np.ascontiguousarray(rays[::s, ::s])
        down = rays[..., 2]
        with np.errstate(divide="ignore"):
            depth = np.where(down < -1e-6, (low[2] - self.camera.eye[2]) / down, np.inf)
        self.floor_depth = np.where(depth > 0, depth, np.inf).astype(np.float32)
        point = self.camera.eye + rays * np.minimum(self.floor_depth, 1e6)[..., None]
        middle = (low + high) / 2
        away = np.hypot(point[..., 0] - middle[0], point[..., 1] - middle[1]) / self.size
        fade = np.clip(1.15 - away / 2.2, 0, 1)[..., None] ** 1.5 * np.isfinite(self.floor_depth)[..., None]
        up = np.clip(rays[..., 2:] / np.linalg.norm(rays, axis=2, keepdims=True) * 2.5, 0, 1)
        sky, horizon, floor = colours
        self.backdrop = (fade * floor + (1 - fade) * ((1 - up) * horizon + up * sky)).astype(np.float32)
        self.fade = fade[..., 0].astype(np.float32)
        axes = look(LIGHT)
        far = 40 * self.size
        self.lamp = Camera(middle + LIGHT * far, axes, _MAP / (1.15 * self.size) * far, _MAP, _MAP)
        self.light = (self.camera.axes @ LIGHT).astype(np.float32)  # in the camera frame
        half = self.light + np.array([0, 0, -1], np.float32)
        self.half = half / np.linalg.norm(half)

    def shadow_map(self, shapes):
        """Return the depth map of spheres seen from the light."""
        depth, index = np.full((_MAP, _MAP), np.inf, np.float32), np.zeros((_MAP, _MAP), np.int32)
        if len(shapes.centre):
            centre = self.lamp.view(shapes.centre).astype(np.float32)
            splat.spheres(centre, shapes.radius.astype(np.float32), *numbers(self.lamp), depth, index)
        return depth

    def lit(self, depth, maps):
        """Return the share of light (h, w) that reaches the points at ``depth``; maps: [(map, strength)]."""
        s = OVERSAMPLE  # soft shadows need no finer pixels than the picture's
        d = depth[::s, ::s]
        seen = np.isfinite(d)
        point = self.camera.eye + self.coarse_rays[seen] * d[seen][:, None]
        v = self.lamp.view(point)
        pixel = v[:, :2] / v[:, 2:] * self.lamp.focal + self.lamp.centre
        bias = 1.2 * self.spacing
        light = np.ones(len(v), np.float32)
        for shadow, strength in maps:
            hidden = np.zeros(len(v), np.float32)
            taps = [(a, b) for a in (-2.2, 0, 2.2) for b in (-2.2, 0, 2.2)]
            for a, b in taps:
                x = np.clip(pixel[:, 0] + a, 0, _MAP - 1).astype(np.int32)
                y = np.clip(pixel[:, 1] + b, 0, _MAP - 1).astype(np.int32)
                hidden += v[:, 2] > shadow[y, x] + bias
            light *= 1 - strength * hidden / len(taps)
        full = np.ones(d.shape, np.float32)
        full[seen] = light
        full = uniform_filter(full, 3)
        return np.repeat(np.repeat(full, s, 0), s, 1)[: depth.shape[0], : depth.shape[1]]

    def hollows(self, depth):
        """Return the darkening (h, w) of points that lie in a hollow (ambient occlusion).

        Opposite neighbours are taken together, so that slopes are no hollows; neighbours more than
        a few spacings away in depth belong to something else, and would draw halos.
        """
        s = OVERSAMPLE
        reach = 10 * self.spacing
        d = depth[::s, ::s]
        d = np.where(np.isfinite(d), d, np.float32(1e9))
        near = max(2.0, min(3 * self.spacing * self.camera.focal / s / (2.5 * self.size), 12.0))
        shade = np.zeros_like(d)
        taps = [
            (r * np.cos(a), r * np.sin(a)) for r in (near, 2.5 * near) for a in np.arange(4) * np.pi / 4 + r
        ]
        for x, y in taps:
            one, other = (d - _moved(d, round(k * y), round(k * x)) for k in (1, -1))
            close = (np.abs(one) < reach) & (np.abs(other) < reach)
            shade += np.where(close, np.clip((one + other) / (0.5 * reach), 0, 1), 0)
        shade = uniform_filter(1 - np.minimum(1.5 * shade / len(taps), 0.45) * (d < self.far), 3)
        return np.repeat(np.repeat(shade, s, 0), s, 1)[: depth.shape[0], : depth.shape[1]]

    def draw(self, solid, liquid, maps, liquid_style="spheres"):
        """Return the picture (h, w, 3) in 0 .. 1, at oversampled size."""
        picture, depth, light = self.ground(solid, maps)
        return self.add_liquid(picture, depth, liquid, light, liquid_style)

    def ground(self, solid, maps):
        """Return the picture of ground and solids, their depth, and the share of light there."""
        depth = np.minimum(self.floor_depth, solid.depth)
        hit = solid.depth < self.floor_depth
        light = self.lit(depth, maps)
        picture = self.backdrop * (1 - self.fade * (1 - (0.45 + 0.55 * light)))[..., None]
        if hit.any():
            n = solid.normal[hit]
            diffuse = np.clip(n @ self.light, 0, 1) * (0.25 + 0.75 * light[hit])
            sky = 0.5 - 0.5 * (n @ self.camera.axes[:, 2].astype(np.float32) * -1)
            shine = np.clip(n @ self.half, 0, 1) ** 40 * light[hit]
            edge = 0.55 + 0.45 * np.clip(-n[:, 2] * 2.2, 0, 1)
            picture[hit] = solid.rgb[hit] * (0.34 + 0.26 * sky + 0.62 * diffuse)[:, None] * edge[:, None]
            picture[hit] += 0.35 * shine[:, None]
        picture *= self.hollows(depth)[..., None]
        return picture, depth, light

    def add_liquid(self, picture, behind, layer, light, style, length=None, bubbly=None):
        """Return the picture with liquid in front of it.

        With gas in the run: ``length`` (h, w) is that of the ray before the first bubble [m], which ``bubbly``
        (h, w) says is there; the liquid is clearer then.
        """
        hit = layer.depth < behind
        if not hit.any():
            return picture
        n, rgb = layer.normal[hit], layer.rgb[hit]
        rows, columns = np.nonzero(hit)
        inside = layer.inside[hit]
        row, column, gassy = rows, columns, length is not None
        if style == "mesh":  # refraction: what is behind appears shifted along the normal
            shift = np.clip(inside / self.size, 0, 0.15)[:, None] * n[:, :2] * 0.35 * self.camera.focal / 3
            row = np.clip(rows - shift[:, 1], 0, picture.shape[0] - 1).astype(int)
            column = np.clip(columns - shift[:, 0], 0, picture.shape[1] - 1).astype(int)
        back = picture[row, column]
        inside = length[row, column] if gassy else inside
        facing = np.clip(-n[:, 2], 0, 1)
        diffuse = np.clip(n @ self.light, 0, 1)
        high = np.clip(n @ self.half, 0, 1)[:, None]
        if style == "mesh":
            least, most, reach = CLEARER if gassy else CLEAR
            clear = least + most * np.exp(-inside / (reach * self.spacing))[:, None]
            body = rgb * (0.66 + 0.40 * diffuse)[:, None]
            fresnel = (0.03 + 0.55 * (1 - facing) ** 4)[:, None]
            shine = 0.55 * high**120
        else:
            clear = 0.06 + 0.55 * np.exp(-inside / (6 * self.spacing))[:, None]
            if gassy:
                clear = np.where(bubbly[hit][:, None], 0.30 + 0.50 * np.exp(-inside / (6 * self.spacing))[:, None], clear)
            body = rgb * (0.72 + 0.36 * diffuse)[:, None] * (0.84 + 0.16 * facing)[:, None]
            fresnel = (0.10 * (1 - facing) ** 3)[:, None]
            shine = 0.18 * high**14
        body = body * (0.70 + 0.30 * light[hit])[:, None]
        through = back * (clear + (1 - clear) * rgb)  # coloured by what it passed
        colour = through * clear + body * (1 - clear)
        colour = colour * (1 - fresnel) + SKY * fresnel + shine
        front = np.where(hit, layer.depth, behind)
        out = picture.copy()
        out[hit] = colour
        return out * (0.3 + 0.7 * self.hollows(front))[..., None]


def reduce(picture):
    """Return the picture (h, w, 3) uint8 at final size."""
    s = OVERSAMPLE
    h, w = picture.shape[0] // s, picture.shape[1] // s
    mean = np.clip(picture[: h * s, : w * s], 0, 1).reshape(h, s, w, s, 3).mean(axis=(1, 3))
    return (mean * 255 + 0.5).astype(np.uint8)
