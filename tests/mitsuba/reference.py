"""Renders the scenes with Mitsuba and stores what the tests compare with: `python reference.py [NAME...]`."""

import argparse
import datetime
import time

import numpy as np

import regions
import start

mi = start.mitsuba()
import scene_file


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=start.scene_names())
    parser.add_argument("--seeds", type=int, default=32)
    parser.add_argument("--samples", type=int, default=512, help="a pixel and seed")
    arguments = parser.parse_args()
    start.OUT.mkdir(exist_ok=True)
    for name in arguments.names:
        started = time.time()
        runs, mean = [], 0
        plain = name in start.PLAIN
        scene = scene_file.load(start.scene_path(name), start.SIZE, start.DEPTH, plain)
        for seed in range(arguments.seeds):
            picture = np.array(mi.render(scene, spp=arguments.samples, seed=seed), dtype=float)
            runs.append(regions.means(picture, start.REGIONS))
            mean = mean + picture / arguments.seeds
        np.save(start.OUT / f"{name}-mitsuba.npy", mean)
        write(name, regions.Estimates.of_runs(runs), arguments)
        print(f"{name}: {time.time() - started:.0f} s", flush=True)


def write(name, estimates, arguments):
    lines = [
        f"# {name} by Mitsuba {mi.__version__}, variant {start.VARIANT}, {datetime.date.today()}.",
        "# Light: the mean of red, green and blue, and their standard errors; of each region, row after row, and at last of the whole picture.",
        f"size {start.SIZE}",
        f"regions {start.REGIONS}",
        f"depth {start.DEPTH}",
        f"seeds {arguments.seeds}",
        f"samples {arguments.samples}",
    ]
    for mean, error in zip(estimates.mean, estimates.error):
        numbers = [f"{x:.6g}" for x in mean] + [f"{x:.2g}" for x in error]
        lines.append(" ".join(["light", *numbers]))
    start.REFERENCES.mkdir(exist_ok=True)
    (start.REFERENCES / f"{name}.txt").write_text("\n".join(lines) + "\n")


main()
