"""Renders the scenes with Raywood and compares them with what Mitsuba stored: `python compare.py [NAME...]`.

Writes pictures of both side by side, and what differs in units of noise, to `out/`.
"""

import argparse
import subprocess

import numpy as np

import regions
import start

mi = start.mitsuba()
ROOT = start.HERE.parent.parent


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=start.scene_names())
    parser.add_argument("--raywood", default=ROOT / "target" / "release" / "raywood")
    parser.add_argument("--seeds", type=int, default=32)
    parser.add_argument("--samples", type=int, default=256, help="a pixel and seed")
    arguments = parser.parse_args()
    start.OUT.mkdir(exist_ok=True)
    print("Deviates: of the whole picture (red, green, blue), of all regions together, the largest of a region.")
    print("Noise: the mean relative standard error of a region, Mitsuba's and Raywood's.")
    for name in arguments.names:
        pictures = [render(arguments, name, seed) for seed in range(arguments.seeds)]
        ours = regions.Estimates.of_runs([regions.means(p, start.REGIONS) for p in pictures])
        theirs = read(start.REFERENCES / f"{name}.txt")
        report(name, ours, theirs)
        show(name, np.mean(pictures, axis=0), ours, theirs)


def render(arguments, name, seed):
    output = start.OUT / f"{name}.exr"
    size = f"{start.SIZE}x{start.SIZE}"
    options = ["-i", "path", "-s", size, "--filter", "box", "--bits", "32"]
    numbers = {"-n": arguments.samples, "--depth": start.DEPTH, "--seed": seed}
    options += [str(x) for pair in numbers.items() for x in pair]
    command = [arguments.raywood, "render", start.scene_path(name), *options, "-o", output]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return np.array(mi.Bitmap(str(output)), dtype=float)[..., :3]


def read(path):
    lines = [line.split() for line in path.read_text().splitlines() if line[0] != "#"]
    values = {line[0]: line[1] for line in lines if len(line) == 2}
    light = np.array([line[1:] for line in lines if line[0] == "light"], dtype=float)
    return regions.Estimates(light[:, :3], light[:, 3:], int(values["seeds"]) - 1)


def report(name, ours, theirs):
    deviates = ours.deviates_from(theirs)
    of_regions, whole = deviates[:-1], deviates[-1]
    noisy = ~(ours.is_exact() & theirs.is_exact())[:-1]
    together = [regions.chi_squared_deviate(of_regions[noisy[:, c], c]) for c in range(3)]
    largest = of_regions.flat[np.abs(of_regions).argmax()]
    with np.errstate(divide="ignore", invalid="ignore"):
        noise = [np.nanmean(e.error[:-1] / e.mean[:-1]) for e in (theirs, ours)]
        ratio = ours.mean[-1] / theirs.mean[-1] - 1
    print(
        f"{name:18} picture {numbers(whole)}  regions {numbers(together)}  largest {largest:+5.2f}"
        f"  noise {noise[0]:.3%} {noise[1]:.3%}  difference of the picture {ratio[0]:+.3%} {ratio[1]:+.3%} {ratio[2]:+.3%}",
        flush=True,
    )


def numbers(values):
    return " ".join(f"{x:+5.2f}" for x in values)


def show(name, picture, ours, theirs):
    """Mitsuba's picture, ours, and where ours is brighter (red) or darker (blue), five deviates being all."""
    parts = [picture]
    path = start.OUT / f"{name}-mitsuba.npy"
    if path.exists():
        parts.insert(0, np.load(path))
    scale = 0.5 / np.percentile(parts[0], 80)
    parts = [np.clip(part * scale, 0, 1) for part in parts]
    deviates = ours.deviates_from(theirs)[:-1].mean(axis=1).reshape(start.REGIONS, start.REGIONS) / 5
    off = np.stack([np.clip(deviates, 0, 1), 0 * deviates, np.clip(-deviates, 0, 1)], axis=2)
    edge = start.SIZE // start.REGIONS
    parts.append(off.repeat(edge, axis=0).repeat(edge, axis=1))
    together = np.concatenate(parts, axis=1).repeat(4, axis=0).repeat(4, axis=1)
    bitmap = mi.Bitmap(together.astype(np.float32))
    bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, True).write(str(start.OUT / f"{name}.png"))


main()
