"""Surfaces as files for other programs: PLY, OBJ, VTP, and scenes for POV-Ray."""

import base64
import pathlib
import struct

import numpy as np

from melt.output import surface_mesh
from melt.output.errors import OutputError
from melt.output.surface_mesh import components, join, reconstruct
from melt.physics.phases import LIQUID, SOLID

IOR = {"liquid": 1.33, "solid": 1.31}  # water, ice
_PALETTE = 48  # POV-Ray textures along the colour scale


def write_ply(path, mesh, rgb):
    """Write binary PLY with normals, vertex colours (v, 3) in 0 .. 1 and the temperature, if any."""
    fields = [("x", "f4"), ("y", "f4"), ("z", "f4"), ("nx", "f4"), ("ny", "f4"), ("nz", "f4")]
    fields += [("red", "u1"), ("green", "u1"), ("blue", "u1")]
    warm = len(mesh.temperature) == len(mesh.vertices) and len(mesh.vertices) > 0
    fields += [("temperature", "f4")] if warm else []
    vertex = np.zeros(len(mesh.vertices), [(n, "<" + t if t != "u1" else t) for n, t in fields])
    for k in range(3):
        vertex["xyz"[k]] = mesh.vertices[:, k]
        vertex["n" + "xyz"[k]] = mesh.normals[:, k]
        vertex[("red", "green", "blue")[k]] = np.round(rgb[:, k] * 255)
    if warm:
        vertex["temperature"] = mesh.temperature
    face = np.zeros(len(mesh.faces), [("n", "u1"), ("v", "<i4", 3)])
    face["n"], face["v"] = 3, mesh.faces
    names = {"f4": "float", "u1": "uchar"}
    head = ["ply", "format binary_little_endian 1.0", "comment melt; lengths in m, temperature in degC"]
    head += [f"element vertex {len(vertex)}"] + [f"property {names[t]} {n}" for n, t in fields]
    head += [f"element face {len(face)}", "property list uchar int vertex_indices", "end_header", ""]
    path.write_bytes("\n".join(head).encode() + vertex.tobytes() + face.tobytes())


def write_obj(path, mesh, rgb):
    """Write Wavefront OBJ with normals and vertex colours behind the coordinates."""
    with open(path, "w") as file:
        file.write("# melt; lengths in m\n")
        np.savetxt(file, np.column_stack([mesh.vertices, rgb]), fmt="v %.8g %.8g %.8g %.4f %.4f %.4f")
        np.savetxt(file, mesh.normals, fmt="vn %.5f %.5f %.5f")
        np.savetxt(file, np.repeat(mesh.faces + 1, 2, axis=1), fmt="f %d//%d %d//%d %d//%d")


def write_vtp(path, mesh, rgb):
    """Write VTK XML PolyData."""
    count = len(mesh.faces)

    def array(name, values, kind, components=1):
        data = np.ascontiguousarray(values).tobytes()
        text = base64.b64encode(struct.pack("<Q", len(data)) + data).decode()
        head = f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="binary">'
        return f"{head}{text}</DataArray>"

    point = array("Normals", mesh.normals.astype("<f4"), "Float32", 3)
    if len(mesh.temperature) == len(mesh.vertices):
        point += array("temperature", mesh.temperature.astype("<f4"), "Float32")
    path.write_text(
        '<?xml version="1.0"?><VTKFile type="PolyData" version="1.0" '
        'byte_order="LittleEndian" header_type="UInt64">'
        f'<PolyData><Piece NumberOfPoints="{len(mesh.vertices)}" NumberOfPolys="{count}" NumberOfVerts="0" '
        f'NumberOfLines="0" NumberOfStrips="0"><PointData Normals="Normals">{point}</PointData>'
        f"<Points>{array('Points', mesh.vertices.astype('<f8'), 'Float64', 3)}</Points>"
        f"<Polys>{array('connectivity', mesh.faces.astype('<i8'), 'Int64')}"
        f"{array('offsets', 3 * np.arange(1, count + 1, dtype='<i8'), 'Int64')}"
        "</Polys></Piece></PolyData></VTKFile>"
    )


# --- POV-Ray ----------------------------------------------------------------------------------


def _left(points):
    """Turn right-handed z-up points (n, 3) into POV-Ray's left-handed y-up ones: y and z change places."""
    return np.asarray(points)[:, [0, 2, 1]]


def _vectors(name, rows, fmt):
    body = ",\n".join("<" + ",".join(fmt % v for v in row) + ">" for row in rows)
    return f"  {name} {{ {len(rows)},\n{body}\n  }}\n"


def mesh2(mesh, shade, kind, palette):
    """Return a POV-Ray ``mesh2`` of a mesh: ``kind`` liquid or solid, ``shade`` (v,) rows of the palette.

    The change of handedness turns faces round, so their winding is turned back.
    """
    faces = mesh.faces[:, ::-1]
    lines = ["mesh2 {\n", _vectors("vertex_vectors", _left(mesh.vertices), "%.7g")]
    lines.append(_vectors("normal_vectors", _left(mesh.normals), "%.5f"))
    clear = "rgbt <%.3f,%.3f,%.3f,0.72>" if kind == "liquid" else "rgbt <%.3f,%.3f,%.3f,0.25>"
    finish = (
        "finish { ambient 0.12 diffuse 0.65 specular 0.7 roughness 0.004 reflection { 0.02, 0.35 fresnel } "
    )
    finish += "conserve_energy }"
    textures = "\n".join(f"texture {{ pigment {{ {clear % tuple(c)} }} {finish} }}" for c in palette)
    lines.append(f"  texture_list {{ {len(palette)},\n{textures}\n  }}\n")
    # one texture per face: POV-Ray traces the rays of each of three corner textures, at every bounce
    face_shade = np.round(shade[faces].mean(axis=1)).astype(int)
    rows = ",\n".join("<{},{},{}>,{}".format(*f, s) for f, s in zip(faces.tolist(), face_shade.tolist()))
    lines.append(f"  face_indices {{ {len(faces)},\n{rows}\n  }}\n")
    lines.append(f"  interior {{ ior {IOR[kind]} }}\n}}\n")
    return "".join(lines)


def write_pov(path, meshes, shades, palette, camera, low, high):
    """Write a POV-Ray scene of meshes (kind -> Mesh) seen by a `Camera`; the box low .. high is lit."""
    middle, size = (low + high) / 2, float(np.linalg.norm(high - low))
    eye, ahead = (_left(p[None])[0] for p in (camera.eye, camera.eye + camera.axes[2] * size))
    angle = 2 * np.degrees(np.arctan(camera.width / 2 / camera.focal))
    lamp = _left((middle + np.array([-1.2, -1.5, 2.8]) * size)[None])[0]

    def vector(v):
        return "<{:.7g},{:.7g},{:.7g}>".format(*v)

    text = (
        "// povray +W1280 +H720 +A FILE.pov   (melt: lengths in m, y up)\n#version 3.7;\n"
        "global_settings { assumed_gamma 1.0 max_trace_level 8 }\n"
        f"camera {{ location {vector(eye)} up y right x*image_width/image_height sky y angle {angle:.4f} "
        f"look_at {vector(ahead)} }}\n"
        f"light_source {{ {vector(lamp)} rgb 1.1 }}\n"
        "sky_sphere { pigment { gradient y "
        "color_map { [0 rgb <0.95,0.96,0.97>] [1 rgb <0.55,0.70,0.88>] } } }\n"
        f"plane {{ y, {low[2] - 0.002 * size:.7g} pigment {{ rgb 0.82 }} "
        f"finish {{ ambient 0.1 diffuse 0.8 }} }}\n"
    )
    parts = [mesh2(mesh, shades[kind], kind, palette) for kind, mesh in meshes.items() if len(mesh.faces)]
    path.write_text(text + "".join(parts))


# --- a frame of a run -------------------------------------------------------------------------

WRITERS = {".ply": write_ply, ".obj": write_obj, ".vtp": write_vtp, ".pov": write_pov}


def surfaces(frame, values, spacing, **options):
    """Return {"liquid": Mesh, "solid": Mesh} of a frame; ``values`` (n,) are carried to the vertices."""
    phase = frame.get("phase", np.zeros(len(frame["position"]), np.int32))
    material = frame.get("material", np.zeros(len(phase), np.int32))
    seen = np.isfinite(frame["position"]).all(axis=1)
    liquid = seen & (phase == LIQUID)
    found = {"liquid": reconstruct(frame["position"][liquid], values[liquid], spacing, **options)}
    pieces = []
    for m in np.unique(material[seen & (phase == SOLID)]):
        part = seen & (phase == SOLID) & (material == m)
        pieces += components(frame["position"][part], values[part], spacing, **{**options, "correct": False})
    return found | {"solid": join(pieces)}


def write_run_frame(run, k, out, field="temperature", phase="all", view="iso", size=(1280, 720), **options):
    """Write the surfaces of frame ``k``; liquid and solid in one mesh unless ``phase`` names one.

    Args:
        phase: all, liquid or solid. field: carried to the vertices. view, size: camera of a POV-Ray scene.
        options: of `surface_mesh.reconstruct`: reach, radius, node, correct, backend.
    """
    from melt.output.picture import Painter
    from melt.output.whole import whole

    if phase not in ("all", "liquid", "solid"):
        raise OutputError(f"unknown phase '{phase}': use all, liquid or solid.")
    painter = Painter(run, field, view=view, size=size)
    frame = run.frame(k)
    meshes = surfaces(frame, painter.values(frame).astype(np.float64), painter.spacing, **options)
    meshes = {kind: mesh for kind, mesh in meshes.items() if phase in ("all", kind)}
    out = pathlib.Path(out)
    with whole(out) as temporary:
        if out.suffix.lower() == ".pov":
            steps = np.linspace(painter.colouring.low, painter.colouring.high, _PALETTE)
            span = max(painter.colouring.high - painter.colouring.low, 1e-30)
            shades = {
                kind: np.clip((m.temperature - steps[0]) / span * (_PALETTE - 1), 0, _PALETTE - 1)
                .round()
                .astype(int)
                for kind, m in meshes.items()
            }
            palette = painter.colouring.rgb(steps if painter.colouring.stops else np.zeros(_PALETTE))
            write_pov(temporary, meshes, shades, palette, painter.camera, *painter.bounds)
        else:
            mesh = join(m for m in meshes.values() if len(m.faces))
            rgb = painter.colouring.rgb(mesh.temperature)
            if painter.colouring.field != "temperature":  # the vertex field would go by a wrong name
                mesh = mesh._replace(temperature=np.zeros(0))
            WRITERS[out.suffix.lower()](temporary, mesh, rgb.reshape(-1, 3))
    return surface_mesh.join(meshes.values())
