#!/usr/bin/python3
"""Textures of generated shapes in two forms of the same size: compress and stretch maps (Li et al. 2020, Eq. 10 to 14, with the
shapes' own influences) and facezip's own.

    generated_textures.py FACEZIP MODEL HELD WORK [--subjects 081,083] [--map albedo]

HELD      a library of people who are not in MODEL: subjects/NNN/ and truth/NNN/MAP/neutral.png, MAP/SHAPE.png, the true
          textures of single shapes
Of each subject it generates one package a form, and blends every shape alone. Prints megabytes in memory, and root mean squares
(0..255) over texels that any shape changes: what the package misses of a package of eight textures, which stands for what was
generated; what its changes of the texture miss of the true ones, and what predicting no change does. With two difference textures the two
forms have the same bytes.
Needs NumPy and Pillow.
"""
import argparse
import json
import pathlib
import re

import numpy as np
from PIL import Image

from people import run

FORMS = {"facezip, 8 textures": ["--differences", "8"], "compress and stretch": ["--method", "compress-stretch"], "facezip, 2 textures": ["--differences", "2"],
         "facezip, 4 textures": ["--differences", "4"]}


def pixels(path):
    return np.asarray(Image.open(path), np.float32)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("facezip", type=pathlib.Path)
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("held", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--subjects", default="081,083")
    parser.add_argument("--map", default="albedo")
    o = parser.parse_args()
    for subject in o.subjects.split(","):
        own, truth = o.held / "subjects" / subject, o.held / "truth" / subject / o.map
        work = o.work / subject
        work.mkdir(parents=True, exist_ok=True)
        neutral, true_neutral = pixels(own / o.map / "neutral.png"), pixels(truth / "neutral.png")
        best = None
        for form, options in FORMS.items():
            package = work / (form.replace(", ", "_").replace(" ", "_") + ".facezip")
            run(o.facezip, "--quiet", "generate", own, "--model", o.model, "--output", package, "--maps", o.map, "--unit", "cm", *options)
            shapes = json.loads((package / "package.json").read_text())["expressions"]
            clip = work / "clip.csv"
            clip.write_text(",".join(shapes) + "\n" + "".join(
                ",".join("1" if n == m else "0" for m in range(len(shapes))) + "\n" for n in range(len(shapes))))
            frames = work / "frames"
            run(o.facezip, "--quiet", "blend", package, "--animation", clip, "--output", frames / "%04d.png")
            blended = np.array([pixels(frame) - neutral for frame in sorted(frames.glob("*.png"))])
            if best is None:
                best = blended
                true = np.array([pixels(truth / f"{shape}.png") - true_neutral for shape in shapes])
                moves = np.abs(true).max((0, 3)) > 2
            held = re.search(r"memory: (\S+ \S+) at run time", run(o.facezip, "info", package)).group(1)
            rms = lambda change: np.sqrt((change[:, moves] ** 2).mean())
            print(f"{subject}, {form}: {held}, misses {rms(blended - best):.3f} of what was generated; of the true changes "
                  f"{rms(blended - true):.3f}, nothing {rms(true):.3f}", flush=True)


if __name__ == "__main__":
    main()
