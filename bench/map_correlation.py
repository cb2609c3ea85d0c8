#!/usr/bin/python3
"""How much of one map's difference textures follows from another's, by a linear map a tile.
    map_correlation.py PACKAGE [--from albedo] [--to normal] [--tiles 16,32,64,128]
PACKAGE   of images, with both maps and one set of weights (--weight-sets shared)
For squares of several sizes: the share of the differences' energy that is left when all C textures of one map are predicted from those of the
other, a constant beside them (half of a tile's texels learn, the others are predicted); and the coefficients a texel that this takes."""
import argparse
import json
import pathlib

import numpy as np
from PIL import Image


def textures(package, description, name):
    """Difference textures of a map, decoded, channels of all of them together: height x width x (C channels)."""
    (found,) = [one for one in description["maps"] if one["name"] == name]
    planes = []
    for texture in found["differences"]:
        codes = np.asarray(Image.open(package / texture["file"])).astype(np.float64)
        codes = codes.reshape(*codes.shape[:2], -1)
        planes.append(codes * texture["scale"] + texture["offset"])
    return np.concatenate(planes, 2)


def tiles(image, side):
    rows, columns = image.shape[0] // side, image.shape[1] // side
    cut = image[:rows * side, :columns * side].reshape(rows, side, columns, side, -1)
    return cut.transpose(0, 2, 1, 3, 4).reshape(rows * columns, side * side, -1)


def share_left(source, target, side):
    left = whole = 0.0
    for x, y in zip(tiles(source, side), tiles(target, side)):
        x = np.concatenate([x, np.ones((len(x), 1))], 1)
        gram = x[::2].T @ x[::2]
        gram += 1e-4 * np.trace(gram) / len(gram) * np.eye(len(gram)) + 1e-12 * np.eye(len(gram))
        coefficients = np.linalg.solve(gram, x[::2].T @ y[::2])
        left += 2.0 * ((y[1::2] - x[1::2] @ coefficients) ** 2).sum()
        whole += (y ** 2).sum()
    return left / whole


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("package", type=pathlib.Path)
    parser.add_argument("--from", dest="source", default="albedo")
    parser.add_argument("--to", default="normal")
    parser.add_argument("--tiles", default="16,32,64,128")
    arguments = parser.parse_args()
    description = json.loads((arguments.package / "package.json").read_text())
    source = textures(arguments.package, description, arguments.source)
    target = textures(arguments.package, description, arguments.to)
    print("| tile | energy left | coefficients a texel |\n|---|---|---|")
    for side in map(int, arguments.tiles.split(",")):
        coefficients = (source.shape[2] + 1) * target.shape[2] / side ** 2
        print(f"| {side} x {side} | {share_left(source, target, side):.3f} | {coefficients:.3f} |")


if __name__ == "__main__":
    main()
