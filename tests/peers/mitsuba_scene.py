"""A caustix scene file as a Mitsuba scene.

Units: one lumen here is one watt there, so that luminance [cd/m2] and radiance [W/(m2 sr)] are the same number. What has
no exact equivalent is refused, never approximated.

Two things differ in kind and are the scenes' business: a panel stops light there and lets it pass here; and light
that leaves a room is lost in both.
"""

import math
import tomllib

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
mi.set_log_level(mi.LogLevel.Warn)

EMITTER_KEYS = {
    "isotropic": {"position", "flux_lm"},
    "panel": {"position", "flux_lm", "aim", "up", "size"},
}
MATERIAL_KEYS = {
    "lambertian": {"reflectance"},
    "mirror": {"reflectance"},
    "dielectric": {"ior", "ior_outside"},
    "absorber": set(),
}
SURFACE_KEYS = {
    "rectangle": {"corner", "edge_u", "edge_v"},
    "box": {"min", "max"},
    "sphere": {"center", "radius"},
}


def read(path):
    """The scene file as a dictionary."""
    with open(path, "rb") as file:
        return tomllib.load(file)


def _check(table, what, known):
    kind = table.get("type")
    if kind not in known:
        raise SystemExit(f"{what} of type {kind!r} has no equivalent here; there are {sorted(known)}")
    surplus = set(table) - known[kind] - {"type", "name", "material"}
    if surplus:
        raise SystemExit(f"{what} of type {kind!r}: no equivalent for {sorted(surplus)}")


def _rgb(value):
    return {"type": "rgb", "value": list(value) if isinstance(value, list) else [value] * 3}


def _parallelogram(centre, edge_u, edge_v):
    """Mitsuba's rectangle, [-1, 1]^2 with the normal +z, between these edges."""
    normal = np.cross(edge_u, edge_v)
    matrix = np.eye(4)
    matrix[:3, 0] = np.asarray(edge_u) / 2
    matrix[:3, 1] = np.asarray(edge_v) / 2
    matrix[:3, 2] = normal / np.linalg.norm(normal)
    matrix[:3, 3] = centre
    return {"type": "rectangle", "to_world": mi.ScalarTransform4f(matrix)}


def _emitter(table):
    _check(table, "an emitter", EMITTER_KEYS)
    position, flux = table["position"], table["flux_lm"]
    if table["type"] == "isotropic":
        return {"type": "point", "position": position, "intensity": _rgb(flux / (4 * math.pi))}
    aim = np.array(table.get("aim", [0.0, 0.0, -1.0]), dtype=float)
    aim /= np.linalg.norm(aim)
    default_up = [1.0, 0.0, 0.0] if abs(aim[0]) + abs(aim[2]) == 0 else [0.0, 1.0, 0.0]
    up = np.array(table.get("up", default_up), dtype=float)
    up -= aim * (up @ aim)
    up /= np.linalg.norm(up)
    width, height = table["size"]
    return _parallelogram(position, width * np.cross(up, aim), height * up) | {
        "bsdf": {"type": "diffuse", "reflectance": _rgb(0.0)},
        "emitter": {"type": "area", "radiance": _rgb(flux / (math.pi * width * height))},
    }


def _material(table):
    _check(table, "a material", MATERIAL_KEYS)
    kind = table["type"]
    if kind == "dielectric":
        return {"type": "dielectric", "int_ior": float(table["ior"]), "ext_ior": float(table.get("ior_outside", 1.0))}
    if kind == "mirror":
        one_side = {"type": "conductor", "material": "none", "specular_reflectance": _rgb(table.get("reflectance", 1.0))}
    else:
        one_side = {"type": "diffuse", "reflectance": _rgb(table.get("reflectance", 0.0))}
    return {"type": "twosided", "bsdf": one_side}


def _surface(table, materials):
    _check(table, "a surface", SURFACE_KEYS)
    kind = table["type"]
    if kind == "rectangle":
        edge_u, edge_v = np.array(table["edge_u"]), np.array(table["edge_v"])
        shape = _parallelogram(np.array(table["corner"]) + (edge_u + edge_v) / 2, edge_u, edge_v)
    elif kind == "box":
        low, high = np.array(table["min"]), np.array(table["max"])
        transform = mi.ScalarTransform4f().translate((low + high) / 2).scale((high - low) / 2)
        shape = {"type": "cube", "to_world": transform}
    else:
        shape = {"type": "sphere", "center": table["center"], "radius": table["radius"]}
    return shape | {"bsdf": _material(materials[table["material"]])}


def world(scene):
    """Emitters and surfaces, without sensor and integrator."""
    result = {"type": "scene"}
    for index, table in enumerate(scene["emitter"]):
        result[f"emitter_{index}"] = _emitter(table)
    for index, table in enumerate(scene["surface"]):
        result[f"surface_{index}"] = _surface(table, scene["material"])
    return result


def _film(width, height):
    """A pixel is the mean over its own square."""
    return {
        "type": "hdrfilm",
        "width": width,
        "height": height,
        "pixel_format": "rgb",
        "component_format": "float32",
        "rfilter": {"type": "box"},
    }


def camera_sensor(scene):
    """The scene's [camera] as a sensor."""
    camera = scene["camera"]
    if camera.get("filter") != "box" or "lens_radius" in camera:
        raise SystemExit('the camera must have filter = "box" and no lens for pixels to mean the same in both')
    up = camera.get("up", [0.0, 0.0, 1.0])
    return {
        "type": "perspective",
        "fov": float(camera["fov_deg"]),
        "fov_axis": "x",
        "near_clip": 1e-3,
        "to_world": mi.ScalarTransform4f().look_at(camera["position"], camera["look_at"], up),
        "film": _film(*camera["pixels"]),
    }


def _rectangle_of(scene, name):
    """The receiver's table and the rectangle it lies on."""
    receiver = next(r for r in scene["receiver"] if r.get("name", r["surface"]) == name)
    surface = next(s for s in scene["surface"] if s["name"] == receiver["surface"])
    if surface["type"] != "rectangle" or receiver.get("side", "front") != "front":
        raise SystemExit("only the front of a rectangle can be looked at cell by cell")
    return receiver, surface


def receiver_sensor(scene, name, eye):
    """A pinhole at `eye`, its film parallel to the receiver, so that each pixel is one cell of it.

    Returns the sensor and the part of its picture, rows and columns, that is the receiver. Row 0 is the row of largest v, as
    in caustix' maps. The film is centred on the foot of the eye and as large as it takes to hold the receiver: Mitsuba's
    particle tracer takes no notice of a shifted principal point.
    """
    receiver, surface = _rectangle_of(scene, name)
    edges = np.array([surface["edge_u"], surface["edge_v"]])
    lengths = np.linalg.norm(edges, axis=1)
    units = edges / lengths[:, None]
    cells = np.array(receiver.get("cells", [256, 256]))
    sizes = lengths / cells
    if abs(sizes[0] / sizes[1] - 1) > 1e-9:
        raise SystemExit("the receiver's cells must be squares: the film there has no others")
    normal = np.cross(*units)
    offset = np.array(eye) - np.array(surface["corner"])
    distance = offset @ normal
    if distance <= 0:
        raise SystemExit("the eye must stand before the front of the receiver")
    # In cells from the corner (u, v) = (0, 0); twice that, to hit the middle of a cell too.
    foot_twice = np.rint(2 * (units @ offset) / sizes).astype(int)
    if np.abs(foot_twice * sizes / 2 - units @ offset).max() > 1e-6 * sizes[0]:
        raise SystemExit("the foot of the eye must be a corner or the middle of a cell")
    pixels = np.maximum(np.abs(foot_twice), np.abs(2 * cells - foot_twice))
    start = (pixels - foot_twice) // 2  # the receiver's corner, in pixels from the film's lower left
    matrix = np.eye(4)
    matrix[:3, 0] = -units[0]  # the camera's own x points to the left of its picture
    matrix[:3, 1] = units[1]
    matrix[:3, 2] = -normal
    matrix[:3, 3] = eye
    sensor = {
        "type": "perspective",
        "fov": math.degrees(2 * math.atan(pixels[0] * sizes[0] / 2 / distance)),
        "fov_axis": "x",
        "near_clip": 1e-3 * distance,
        "to_world": mi.ScalarTransform4f(matrix),
        "film": _film(int(pixels[0]), int(pixels[1])),
    }
    top = int(pixels[1] - start[1] - cells[1])
    return sensor, (slice(top, top + int(cells[1])), slice(int(start[0]), int(start[0] + cells[0])))


def receiver_reflectance(scene, name):
    """Reflectance of the receiver's surface, by channel."""
    _, surface = _rectangle_of(scene, name)
    value = scene["material"][surface["material"]]["reflectance"]
    return np.array(value if isinstance(value, list) else [value] * 3)


def receiver_events(scene, name):
    """Which arrivals the receiver counts."""
    return _rectangle_of(scene, name)[0].get("events", "all")
