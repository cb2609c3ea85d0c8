#!/usr/bin/python3
"""How much of a misalignment `facezip align` takes back.
    misalign.py FACEZIP CAPTURE WORK [--seed 1] [--texels 2,6] [--maps albedo]
FACEZIP   the built command
CAPTURE   a registered capture whose textures lie on each other
WORK      folder for captures and packages; what is there is made anew
Every expression's textures are slid smoothly: by some texels, drawn evenly from the range, where they slide most. Prints, of the capture as
it is, aligned, spoilt, and spoilt and aligned: RMSE 0..255 of the package that `facezip compress` makes, over its own textures; how far its
textures are from the unspoilt ones, RMSE 0..255 over the region; and the mean flow that `facezip align` found before and after."""
import argparse
import json
import pathlib
import shutil
import subprocess

import numpy as np
from PIL import Image
from scipy.ndimage import map_coordinates

WAVES = 12


def slide(rng, size, texels):
    """Texels to the right and down by which each texel of an image slides: waves of a sixth of its size and longer."""
    y, x = np.mgrid[0:size[0], 0:size[1]] / max(size)
    field = np.zeros((2, *size))
    for axis in (0, 1):
        for _ in range(WAVES):
            angle, frequency = rng.uniform(0, 2 * np.pi), rng.uniform(1, 6)
            field[axis] += np.cos(2 * np.pi * frequency * (x * np.cos(angle) + y * np.sin(angle)) + rng.uniform(0, 2 * np.pi)) / frequency
    return field * texels / np.hypot(*field).max()


def moved(image, field):
    y, x = np.mgrid[0:image.shape[0], 0:image.shape[1]]
    planes = image.reshape(*image.shape[:2], -1).astype(float)
    out = np.stack([map_coordinates(planes[..., c], [y + field[1], x + field[0]], order=3, mode="nearest") for c in range(planes.shape[2])], -1)
    limit = np.iinfo(image.dtype).max
    return np.clip(out + 0.5, 0, limit).astype(image.dtype).reshape(image.shape)


def spoil(options, names, target):
    """Returns the slide of each expression."""
    rng, slides = np.random.default_rng(options.seed), {}
    shutil.copytree(options.capture, target, ignore=shutil.ignore_patterns("expressions", "template"))
    low, high = map(float, options.texels.split(","))
    for name in names:
        for map_name in options.maps.split(","):
            file = next((options.capture / map_name).glob(name + ".*"))
            image = np.asarray(Image.open(file))
            if name not in slides:
                slides[name] = slide(rng, image.shape[:2], rng.uniform(low, high))
            Image.fromarray(moved(image, slides[name])).save(target / map_name / file.name)
    return slides


def facezip(options, *arguments):
    subprocess.run([options.facezip, *arguments, "--quiet"], check=True, stdout=subprocess.DEVNULL)


def rmse_of_package(options, capture):
    report = options.work / "evaluation.json"
    package = options.work / "package"
    facezip(options, "compress", capture, "--maps", options.maps, "--output", package)
    facezip(options, "evaluate", capture, package, "--report", report)
    found = json.loads(report.read_text())["maps"][options.maps.split(",")[0]]
    return found["rmse"]["refined"]


def difference(options, names, region, capture):
    folder, sums = options.maps.split(",")[0], []
    for name in names:
        a, b = (np.asarray(Image.open(next((c / folder).glob(name + ".*")))).astype(float) for c in (options.capture, capture))
        sums.append(((a - b)[region] ** 2).mean())
    return float(np.sqrt(np.mean(sums)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("facezip", type=pathlib.Path)
    parser.add_argument("capture", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--texels", default="2,6")
    parser.add_argument("--maps", default="albedo")
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    spoilt = options.work / "spoilt"
    shutil.rmtree(spoilt, ignore_errors=True)
    first = options.capture / options.maps.split(",")[0]
    names = sorted(p.stem for p in first.iterdir() if p.stem != "neutral")
    spoil(options, names, spoilt)
    coverage = options.capture / "coverage.png"
    size = Image.open(next(first.glob("neutral.*"))).size
    region = np.asarray(Image.open(coverage).convert("L").resize(size)) > 127 if coverage.exists() else np.ones(size[::-1], bool)
    print(f"{'':>20} {'package RMSE':>13} {'from unspoilt':>14} {'flow, texels':>13}")
    for title, capture, aligned in (("as it is", options.capture, False), ("aligned", options.capture, True), ("spoilt", spoilt, False),
                                    ("spoilt, aligned", spoilt, True)):
        flow = ""
        if aligned:
            report = options.work / "alignment.json"
            facezip(options, "align", capture, "--maps", options.maps, "--keep-meshes", "--output", options.work / "aligned", "--report", report)
            capture = options.work / "aligned"
            found = [e["flow_texels"] for e in json.loads(report.read_text())["expressions"]]
            flow = " to ".join(f"{np.mean([e[k]['mean'] for e in found]):.2f}" for k in ("before", "after"))
        print(f"{title:>20} {rmse_of_package(options, capture):>13.3f} {difference(options, names, region, capture):>14.3f} {flow:>13}", flush=True)


if __name__ == "__main__":
    main()
