"""Pictures and videos of runs: shaded particles or surfaces, coloured by a field."""

import pathlib
import shutil
import tomllib

import numpy as np
from PIL import Image, ImageDraw

from melt.output import camera as cameras
from melt.output import colours, mesh_files, shade, surface_mesh
from melt.output import gas as gases
from melt.output.annotate import annotate, edges
from melt.output.errors import OutputError
from melt.output.flood_picture import FloodPainter
from melt.output.run_reader import Run, open_run
from melt.output.screen_run import ScreenLiquid
from melt.output.shade import Spheres, Stage
from melt.output.whole import whole
from melt.physics.phases import BUBBLE, LIQUID, PHASE_NAMES, SOLID, VAPOUR, WALL


class Painter:
    """Draws frames of one run with one camera and one colour scale.

    Args:
        run: `Run`.
        field: field that colours particles; `colours.choose` says what stands in for a missing one.
        surface: draw the liquid's surface and the solids' instead of particles.
        view: iso, side, front or top. size: pixels (width, height).
        walls: draw wall particles too.
        screen: draw the liquid in screen space with this smoothing (`melt.output.screen.SMOOTH`).
    """

    def __init__(self, run, field="temperature", surface=False, view="iso", size=(1280, 720), walls=False, screen=None):
        if view not in cameras.VIEWS:
            raise OutputError(f"unknown view '{view}': use {', '.join(cameras.VIEWS)}.")
        if len(run) == 0:
            raise OutputError(f"{run.path} has no frame yet: nothing to draw.")
        self.run, self.surface, self.walls = run, surface, walls
        self.colouring = colours.choose(run, field)
        self.spacing, self.box = _scene_facts(run)
        if self.spacing is None:
            self.spacing = surface_mesh.spacing_of(self._first())
        low, high = self.bounds = self._bounds()
        # a box not much larger than what moves in it is drawn, and whole
        self.boxed = self.box is not None and bool(
            np.all(self.box[1] - self.box[0] <= 1.6 * (high - low) + 4 * self.spacing)
        )
        seen = (np.minimum(low, self.box[0]), np.maximum(high, self.box[1])) if self.boxed else (low, high)
        self.camera = cameras.fit(
            *seen, view, *size, right=0.12 if self.colouring.field != "phase" else 0.0
        )
        self._stage = None
        self.screen = ScreenLiquid(screen, self.colouring, self.spacing) if screen else None

    def values(self, frame):
        """Return the numbers (n,) that colour a frame."""
        return colours.values_of(frame, self.colouring.field)

    @property
    def stage(self):
        """The ground and the light, made when the first picture is drawn."""
        if self._stage is None:
            self._stage = self._build_stage()
        return self._stage

    def _build_stage(self):
        low, high = self.bounds
        gassy = "bubble_radius" in self.run.fields
        stage = Stage(self.camera, low, high, self.spacing, *([shade.DUSK] if gassy else []))
        ink = [(128, 140, 154)] if gassy else []
        if self.boxed:
            canvas = Image.fromarray((stage.backdrop * 255).astype(np.uint8))
            edges(ImageDraw.Draw(canvas), stage.camera, *self.box, *ink)
            stage.backdrop = np.asarray(canvas).astype(np.float32) / 255
        return stage

    def draw(self, k):
        """Return the picture of frame ``k``, (height, width, 3) uint8."""
        names = {"position", "phase", "material", "velocity", "bubble_radius", self.colouring.field}
        names &= set(self.run.fields)
        frame = self.run.frame(k, names)
        phase = self._phase(frame)
        rgb = self.colouring.rgb(self.values(frame))
        seen = np.isfinite(frame["position"]).all(axis=1)
        opaque = seen & ((phase == SOLID) | (self.walls & (phase == WALL)))
        liquid, gas = seen & (phase == LIQUID), seen & ((phase == BUBBLE) | (phase == VAPOUR))
        x, dx = frame["position"], self.spacing
        solid_shapes = Spheres(x[opaque], np.full(opaque.sum(), 0.56 * dx), rgb[opaque])
        bubbles = gases.of(frame, phase, seen, dx) if "bubble_radius" in names else None
        drops = liquid if bubbles else liquid | gas
        radius = np.where(gas[drops], 0.5, 0.42) * dx
        liquid_shapes = Spheres(x[drops], radius, np.where(gas[drops][:, None], np.float32(0.96), rgb[drops]))
        camera = self.stage.camera
        maps = [(self.stage.shadow_map(solid_shapes), 0.75), (self.stage.shadow_map(liquid_shapes), 0.35)]
        if self.surface:
            values = self.values(frame).astype(np.float64)
            whole = gases.filled(frame, phase, values, bubbles.bubbles, dx) if bubbles else (frame, values)
            meshes = mesh_files.surfaces(*whole, dx)
            colour = {
                kind: self.colouring.rgb(mesh.temperature).reshape(-1, 3) for kind, mesh in meshes.items()
            }
            solid_layer = shade.mesh_layer(meshes["solid"], colour["solid"], camera)
            behind = np.minimum(self.stage.floor_depth, solid_layer.depth)
            liquid_layer = shade.mesh_layer(meshes["liquid"], colour["liquid"], camera, behind)
        else:
            solid_layer = shade.sphere_layer(solid_shapes, camera)
            behind = np.minimum(self.stage.floor_depth, solid_layer.depth)
            if self.screen:
                picture = self.screen.draw(self.stage, solid_layer, maps, x[drops], self.values(frame)[drops], bubbles)
                return self._finished(picture, k, phase[seen])
            liquid_layer = shade.sphere_layer(liquid_shapes, camera, behind)
        drawn = (solid_layer, liquid_layer, maps, "mesh" if self.surface else "spheres")
        picture = gases.draw(self.stage, *drawn, bubbles) if bubbles else self.stage.draw(*drawn)
        return self._finished(picture, k, phase[seen])

    def _finished(self, picture, k, phase):
        number = np.bincount(phase, minlength=6)
        counts = ", ".join(f"{number[p]:,} {PHASE_NAMES[p]}" for p in (0, 1, 3, 4) if number[p])
        return annotate(shade.reduce(picture), self.run.times[k], self.colouring, counts)

    def _phase(self, frame):
        return frame["phase"] if "phase" in frame else np.zeros(len(frame["position"]), np.int32)

    def _first(self):
        k = int(np.argmax(self.run.counts > 1))
        return self.run.frame(k, ["position"])["position"]

    def _bounds(self, sample=8):
        """Return the box around the moving particles of the run, far splashes and rising vapour left out."""
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        names = [n for n in ("position", "phase") if n in self.run.fields]
        for k in np.unique(np.linspace(0, len(self.run) - 1, min(sample, len(self.run))).astype(int)):
            frame = self.run.frame(k, names)
            phase = self._phase(frame)
            keep = np.isfinite(frame["position"]).all(axis=1) & ((phase != WALL) | self.walls) & (phase != VAPOUR)
            x = frame["position"][keep]
            if len(x):
                most = np.quantile(x, (0.002, 0.998), axis=0)
                more = 0.25 * (most[1] - most[0]).max()
                low = np.minimum(low, np.maximum(x.min(axis=0), most[0] - more))
                high = np.maximum(high, np.minimum(x.max(axis=0), most[1] + more))
        if not np.all(low <= high):
            return np.zeros(3), np.ones(3)
        pad = 0.02 * np.linalg.norm(high - low) + 0.5 * self.spacing
        floor = (
            self.box[0][2] if self.box is not None and self.box[0][2] <= low[2] + 2 * pad else low[2] - pad
        )
        return np.array([low[0] - pad, low[1] - pad, min(floor, low[2])]), high + pad


def _scene_facts(run):
    """Return (spacing [m] or None, (low, high) of the domain or None) from the scene text."""
    try:
        domain = tomllib.loads(run.scene_text)["domain"]
        low, high = (np.array([float(v) for v in domain[k]]) for k in ("lower", "upper"))
        spacing = float(domain["spacing"]) if "spacing" in domain else None
        return spacing, (low, high) if low.shape == (3,) and high.shape == (3,) else None
    except (tomllib.TOMLDecodeError, KeyError, TypeError, ValueError):
        return None, None


def painter_of(run, field="temperature", surface=False, view="iso", size=(1280, 720), walls=False, screen=None):
    """Return the painter of a run: of a flood one that knows its terrain, and draws in screen space always."""
    if "bed" in run.maps:
        return FloodPainter(run, field, view, size, screen)
    return Painter(run, field, surface, view, size, walls, screen)


def render_frame(
    run, frame, out_png, field="temperature", surface=False, view="iso", size=(1280, 720), walls=False, screen=None
):
    """Write one frame as PNG."""
    with whole(out_png) as temporary:
        picture = painter_of(run, field, surface, view, size, walls, screen).draw(frame)
        Image.fromarray(picture).save(temporary, format="PNG")


def render_video(
    run,
    out_mp4,
    fps=25,
    field="temperature",
    surface=False,
    view="iso",
    size=(1280, 720),
    walls=False,
    frames=None,
    progress=None,
    screen=None,
):
    """Write frames (numbers or a slice; all unless given) as H.264; Ctrl-C or a failure leaves no file.

    ``progress(done, total)`` is called after each frame.
    """
    import imageio_ffmpeg

    size = tuple(v - v % 2 for v in size)  # yuv420p halves both
    painter = painter_of(run, field, surface, view, size, walls, screen)
    chosen = range(len(run))[frames] if isinstance(frames, slice) else range(len(run)) if frames is None else list(frames)
    if not len(chosen):
        raise OutputError(f"no frame to draw: {run.path} has frames 0 to {len(run) - 1}.")
    with whole(out_mp4) as temporary:
        writer = imageio_ffmpeg.write_frames(
            str(temporary),
            size,
            fps=fps,
            codec="libx264",
            quality=None,
            macro_block_size=2,
            output_params=["-crf", "18", "-preset", "medium", "-movflags", "+faststart", "-f", "mp4"],
        )
        writer.send(None)
        try:
            for done, k in enumerate(chosen):
                picture = np.ascontiguousarray(painter.draw(k))
                try:
                    writer.send(picture)
                except OSError as error:  # its pipe broke; the message is ffmpeg's whole command line
                    raise _cut_short(out_mp4, done) from error
                if progress:
                    progress(done + 1, len(chosen))
        finally:
            writer.close()
        if chosen and _frames_in(temporary) != len(chosen):
            raise _cut_short(out_mp4, _frames_in(temporary))


def _frames_in(path):
    """Return the frames of a video, 0 if it cannot be read: ffmpeg tells nobody when the disk is full."""
    import imageio_ffmpeg

    try:
        return imageio_ffmpeg.count_frames_and_secs(str(path))[0]
    except (OSError, RuntimeError):
        return 0


def _cut_short(path, frames):
    free = shutil.disk_usage(pathlib.Path(path).resolve().parent).free
    return OutputError(
        f"cannot write {path}: ffmpeg stopped after {frames} frames, of which nothing is left; the disk "
        f"has {free / 1e6:.3g} MB free. Free some space, or name another place with --output."
    )


def render(run_path, out, frame=-1, **options):
    """Render a run to ``out``; its suffix chooses: png, mp4, or a mesh: ply, obj, vtp, pov.

    Args:
        run_path: run file, or an open `Run`.
        frame: frame of a picture or mesh (-1: the last).
        options: of `render_frame`, `render_video` or `mesh_files.write_run_frame`.

    Raises:
        OutputError, RunFileError.
    """
    out = pathlib.Path(out)
    suffix = out.suffix.lower()
    run = run_path if isinstance(run_path, Run) else open_run(run_path)
    try:
        if suffix == ".png":
            render_frame(run, _number(run, frame), out, **options)
        elif suffix == ".mp4":
            render_video(run, out, **options)
        elif suffix in mesh_files.WRITERS:
            mesh_files.write_run_frame(run, _number(run, frame), out, **options)
        else:
            kinds = ", ".join([".png", ".mp4", *mesh_files.WRITERS])
            raise OutputError(f"cannot render to '{out.name}': the suffix must be one of {kinds}.")
    finally:
        if run is not run_path:
            run.close()
    return out


def _number(run, frame):
    if len(run) == 0:
        raise OutputError(f"{run.path} has no frame yet: nothing to draw.")
    run.frame(frame, [])  # refuses a frame that is not there
    return frame % len(run)
