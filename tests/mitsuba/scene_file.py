"""Raywood's scene files (docs/scene-file.md) as scenes of Mitsuba: as much of them as the scenes here say. What is not known is an error."""

import tomllib
from math import pi
from pathlib import Path

import mitsuba as mi
import numpy as np

# Below this alpha Raywood takes facets for a mirror.
SMOOTHEST = 1e-3


def load(path, size, depth, plain=False):
    """The scene of a file, for pictures of so many pixels along an edge and at most so many scatterings. `plain` takes Mitsuba's rough surfaces as they are."""
    file = Table(tomllib.loads(Path(path).read_text()), str(path))
    folder = Path(path).parent
    named = file.take("material", {})
    materials = {name: Material(Table(keys, name), plain) for name, keys in named.items()}

    def material(value):
        return materials[value] if isinstance(value, str) else Material(Table(value, "a material"), plain)

    scene = {"type": "scene"}

    def add(kind, value):
        scene[f"{kind}-{len(scene)}"] = value

    environment, background = file.take("environment", None), file.take("background", None)
    if environment:
        add("environment", panorama(folder / environment))
    elif np.any(color(background)):
        add("background", {"type": "constant", "radiance": rgb(background)})

    for keys in file.take("model", []):
        model = Table(keys, "[[model]]")
        shape = {"type": "obj", "filename": str(folder / model.take("file")), "face_normals": True}
        instances = model.take("instance", [{}])
        common = model.rest()
        for instance in instances:
            keys = Table(instance, "[[model.instance]]")
            place = placed(keys) @ placed(common)
            used = keys.take("material", common.values.get("material"))
            add("shape", {**shape, "to_world": mi.ScalarTransform4f(place), **material(used).shown()})
            keys.end()
        common.take("material", None)
        common.end()
    for keys in file.take("sphere", []):
        sphere = Table(keys, "[[sphere]]")
        shape = {"type": "sphere", "center": sphere.take("center"), "radius": sphere.take("radius")}
        add("shape", {**shape, **material(sphere.take("material")).shown()})
        sphere.end()
    for keys in file.take("light", []):
        light = light_of(Table(keys, "[[light]]"))
        if light:
            add("light", light)

    (keys,) = file.take("camera")
    camera = Table(keys, "[[camera]]")
    up = camera.take("up", [0, 1, 0])
    view = mi.ScalarTransform4f().look_at(camera.take("eye"), camera.take("target"), up)
    scene["sensor"] = {
        "type": "perspective",
        "to_world": view,
        "fov": camera.take("fov", 35),
        "fov_axis": "y",
        "film": {
            "type": "hdrfilm",
            "width": size,
            "height": size,
            "rfilter": {"type": "box"},
            "component_format": "float32",
            "pixel_format": "rgb",
        },
        "sampler": {"type": "independent"},
    }
    camera.end()
    file.end()
    absorbs = any(material.absorption is not None for material in materials.values())
    # Its depth counts the parts of a path, the first and the last included.
    scene["integrator"] = {"type": "volpath" if absorbs else "path", "max_depth": depth + 2}
    return mi.load_dict(scene)


class Table:
    """A table of a file, of which every key must be asked for."""

    def __init__(self, values, name):
        self.values, self.name = dict(values), name

    def take(self, key, *default):
        if key in self.values or not default:
            return self.values.pop(key)
        return default[0]

    def rest(self):
        rest, self.values = Table(self.values, self.name), {}
        return rest

    def end(self):
        if self.values:
            raise ValueError(f"{self.name}: {', '.join(self.values)} is not known here")


def color(value):
    return np.broadcast_to(np.array(value, dtype=float), 3)


def rgb(value):
    return {"type": "rgb", "value": color(value).tolist()}


def placed(keys):
    """The matrix of what is first scaled, then turned around x, y and z, then moved."""
    matrix = np.diag([*np.broadcast_to(keys.take("scale", 1), 3), 1.0])
    for axis, degrees in enumerate(keys.take("rotate", [0, 0, 0])):
        turn = np.eye(4)
        a, b = (axis + 1) % 3, (axis + 2) % 3
        sin, cos = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
        turn[a, a] = turn[b, b] = cos
        turn[a, b], turn[b, a] = -sin, sin
        matrix = turn @ matrix
    matrix[:3, 3] += keys.take("translate", [0, 0, 0])
    return matrix


class Material:
    """A material, read once."""

    def __init__(self, keys, plain):
        transmission = keys.take("transmission", 0)
        metallic = keys.take("metallic", None)
        roughness = keys.take("roughness", None)
        reflectance = keys.take("reflectance", 0.04)
        ior = keys.take("ior", 1.5)
        emission = keys.take("emission", 0)
        absorption = keys.take("absorption", None)
        self.emission = rgb(emission) if np.any(color(emission)) else None
        self.absorption = None if absorption is None else color(absorption)
        if transmission == 1:
            self.bsdf = glass(color(keys.take("color", 1)), ior, (roughness or 0) ** 2, plain)
        elif transmission != 0:
            raise ValueError(f"{keys.name}: glass in part")
        else:
            base = color(keys.take("color", 0.7))
            if metallic is None and roughness is None:
                bsdf = {"type": "diffuse", "reflectance": rgb(base)}
            else:
                alpha = (1 if roughness is None else roughness) ** 2
                bsdf = metallic_roughness(base, metallic or 0, alpha, color(reflectance), plain)
            # Raywood's surfaces have two sides.
            self.bsdf = {"type": "twosided", "bsdf": bsdf}
        keys.end()

    def shown(self):
        """What a shape of it has."""
        parts = {"bsdf": self.bsdf}
        if self.emission:
            parts["emitter"] = {"type": "area", "radiance": self.emission}
        if self.absorption is not None:
            # Mitsuba's colours are at most one, but for a scale.
            scale = float(self.absorption.max())
            absorbed = rgb(self.absorption / scale)
            medium = {"type": "homogeneous", "albedo": 0.0, "sigma_t": absorbed, "scale": scale}
            parts["interior"] = medium
        return parts


def metallic_roughness(base, metallic, alpha, reflectance, plain):
    if alpha < SMOOTHEST or plain:
        if metallic != 1 or np.any(base != 1):
            raise ValueError("a mirror that is not white")
        # Without a material it mirrors everything.
        kind = {"type": "conductor"} if alpha < SMOOTHEST else rough("roughconductor", alpha)
        return {**kind, "material": "none"}
    return {
        "type": "metallic_roughness",
        "base": mi.ScalarColor3f(base),
        "metallic": float(metallic),
        "reflectance": mi.ScalarColor3f(reflectance),
        "alpha": alpha,
        "single": {**rough("roughconductor", alpha), "material": "none"},
    }


def glass(tint, ior, alpha, plain):
    indices = {"int_ior": ior, "ext_ior": 1.0, "specular_transmittance": rgb(tint)}
    if alpha < SMOOTHEST:
        return {"type": "dielectric", **indices}
    single = {**rough("roughdielectric", alpha), **indices}
    if plain:
        return single
    return {
        "type": "rough_glass",
        "tint": mi.ScalarColor3f(tint),
        "ior": ior,
        "alpha": alpha,
        "single": single,
    }


def rough(plugin, alpha):
    return {"type": plugin, "distribution": "ggx", "alpha": alpha}


def light_of(keys):
    kind = keys.take("kind")
    # What a white diffuse surface sends back.
    intensity = pi * color(keys.take("intensity"))
    if kind == "point":
        light = {"type": "point", "position": keys.take("position"), "intensity": rgb(intensity)}
    elif kind == "directional":
        direction = keys.take("direction")
        light = {"type": "directional", "direction": direction, "irradiance": rgb(intensity)}
    elif kind == "ambient" and not np.any(intensity):
        light = None
    else:
        raise ValueError(f"[[light]] of kind {kind} is not known here")
    keys.end()
    return light


def panorama(path, finer=8):
    """Surroundings from a panorama. Mitsuba's texels have their middles elsewhere; so it is given many more, of what Raywood blends from those that there are."""
    texels = radiance_picture(path)
    height, width = texels.shape[:2]
    # Mitsuba's columns begin opposite to ours, at half a texel; its rows are at the poles, too.
    columns = (np.arange(width * finer) + 0.5) / (width * finer) + 0.5
    rows = np.arange(height * finer + 1) / (height * finer)
    x, y = columns * width - 0.5, rows * height - 0.5
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    a = (y - top)[:, None, None]
    b = (x - left)[None, :, None]
    line = lambda row: (1 - b) * texels[row][:, left % width] + b * texels[row][:, (left + 1) % width]
    clamped = lambda row: np.clip(row, 0, height - 1)
    fine = (1 - a) * line(clamped(top)) + a * line(clamped(top + 1))
    return {"type": "envmap", "bitmap": mi.Bitmap(fine.astype(np.float32))}


def radiance_picture(path):
    """The texels of a Radiance file with rows in runs, mantissas in the middle of their steps."""
    data = path.read_bytes()
    head, _, rest = data.partition(b"\n\n")
    if not head.startswith(b"#?RADIANCE") or b"FORMAT=32-bit_rle_rgbe" not in head:
        raise ValueError(f"{path} is no Radiance file")
    size, _, rest = rest.partition(b"\n")
    _, height, _, width = size.split()
    height, width = int(height), int(width)
    bytes_ = np.zeros((height, 4, width), np.uint8)
    at = 0
    for row in range(height):
        at += 4
        for channel in range(4):
            column = 0
            while column < width:
                count = rest[at]
                if count > 128:
                    count -= 128
                    bytes_[row, channel, column : column + count] = rest[at + 1]
                    at += 2
                else:
                    values = rest[at + 1 : at + 1 + count]
                    bytes_[row, channel, column : column + count] = np.frombuffer(values, np.uint8)
                    at += 1 + count
                column += count
    mantissas, exponents = bytes_[:, :3].astype(float) + 0.5, bytes_[:, 3:].astype(float)
    light = np.where(exponents > 0, mantissas * np.exp2(exponents - 136), 0)
    return light.transpose(0, 2, 1)
