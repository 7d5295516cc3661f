"""Mitsuba, ready to render: its variant, the LLVM that it compiles with, and our materials."""

import os
import subprocess
from pathlib import Path

HERE = Path(__file__).parent
SCENES = HERE / "scenes"
REFERENCES = HERE / "references"
# What is only looked at.
OUT = HERE / "out"
VARIANT = "llvm_ad_rgb"

# The edge of pictures in pixels and in regions, and how often light scatters at most.
SIZE = 64
REGIONS = 8
DEPTH = 64

# Scenes that Mitsuba renders with its own rough surfaces.
PLAIN = ["plain-facets"]


def rust_llvm():
    """The LLVM of the Rust compiler, where there is one: Mitsuba asks for version 16 or later, which not every system has."""
    root = subprocess.run(["rustc", "--print", "sysroot"], capture_output=True, text=True).stdout
    # One of two is a few words that name the other.
    found = Path(root.strip()).glob("lib/libLLVM*")
    return max(map(str, found), key=os.path.getsize, default=None)


def mitsuba():
    if "DRJIT_LIBLLVM_PATH" not in os.environ:
        library = rust_llvm()
        if library:
            os.environ["DRJIT_LIBLLVM_PATH"] = library
    import mitsuba as mi

    mi.set_variant(VARIANT)
    import materials

    materials.register()
    return mi


def scene_path(name):
    return SCENES / f"{name}.scene.toml"


def scene_names():
    return sorted(path.name.removesuffix(".scene.toml") for path in SCENES.glob("*.scene.toml"))
