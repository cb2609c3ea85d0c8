#!/usr/bin/python3
"""How fast `facezip solve-weights` is: frames a second, OBJ files read included.

    bench/solve_weights_time.py WORK [--side 142] [--shapes 52] [--frames 100]

Makes a sheet of SIDE x SIDE vertices (142: 20,164) with a bump for each shape, rigs it, writes frames of random weights
and solves them. Needs NumPy and Pillow.
"""

import argparse
import pathlib
import subprocess
import time

import numpy
from PIL import Image

import rig_subject


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--facezip", default=pathlib.Path(__file__).parents[1] / "build/release/host/cli/facezip")
    for name, value in (("--side", 142), ("--shapes", 52), ("--frames", 100)):
        parser.add_argument(name, type=int, default=value)
    arguments = parser.parse_args()
    side, work, random = arguments.side, arguments.work, numpy.random.default_rng(1)
    grid = numpy.stack(numpy.meshgrid(numpy.arange(side), numpy.arange(side)), -1).reshape(-1, 2) / (side - 1)
    corner = numpy.arange(side * side).reshape(side, side)[:-1, :-1].ravel() + 1
    faces = numpy.stack([corner, corner + 1, corner + side + 1, corner + side], 1)
    rest = "".join("vt %.6f %.6f\n" % tuple(uv) for uv in 0.05 + 0.9 * grid)
    rest += "".join("f " + " ".join("%d/%d" % (v, v) for v in face) + "\n" for face in faces)
    neutral = numpy.column_stack([0.2 * grid, 0.02 * numpy.sin(3 * grid[:, 0])])
    centres = random.uniform(0.15, 0.85, (arguments.shapes, 2))
    fall = numpy.maximum(1 - numpy.linalg.norm(grid[:, None] - centres, axis=2) / 0.2, 0) ** 2
    shapes = fall.T[:, :, None] * random.normal(size=(arguments.shapes, 1, 3)) * 0.01

    def write(path, weights):
        rig_subject.write_obj(path, neutral + numpy.tensordot(weights, shapes, 1), rest)

    capture, image = work / "capture", Image.fromarray(random.integers(90, 110, (64, 64, 3), numpy.uint8))
    (capture / "albedo").mkdir(parents=True, exist_ok=True)
    for n, weights in enumerate(random.uniform(size=(20, arguments.shapes))):
        write(capture / "expressions" / ("e%d.obj" % n), weights)
        image.save(capture / "albedo" / ("e%d.png" % n))
    image.save(capture / "albedo/neutral.png")
    for m, one in enumerate(numpy.eye(arguments.shapes)):
        write(work / "template" / ("m%02d.obj" % m), one)
    for path in (capture / "neutral.obj", work / "template/neutral.obj"):
        write(path, numpy.zeros(arguments.shapes))
    for f in range(arguments.frames):
        write(work / "frames" / ("%04d.obj" % f), random.uniform(size=arguments.shapes))
    command = [str(arguments.facezip), "--quiet"]
    subprocess.run(command + ["rig", str(capture), "--template", str(work / "template"), "--unit", "m", "--iterations", "0",
                              "--output", str(work / "rig")], check=True, stdout=subprocess.DEVNULL)
    for extra in ([], ["--head-motion"]):
        start = time.perf_counter()
        printed = subprocess.run(command + ["solve-weights", str(work / "rig"), str(work / "frames"), "--output",
                                            str(work / "clip.csv")] + extra, check=True, text=True,
                                 stdout=subprocess.PIPE).stdout
        print("%d vertices, %d frames%s: %.1f s with loading the rig\n%s" %
              (side * side, arguments.frames, " " + extra[0] if extra else "", time.perf_counter() - start, printed))


if __name__ == "__main__":
    main()
