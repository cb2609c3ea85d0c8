#!/usr/bin/python3
"""Textures of generated shapes in two forms of the same size: compress and stretch maps (Li et al. 2020, Eq. 10 to 14, with the
shapes' own influences) and facezip's own.

    generated_textures.py FACEZIP MODEL HELD WORK [--subjects 081,083] [--map albedo]

HELD      a library of people who are not in MODEL: subjects/NNN/ and truth/NNN/MAP/neutral.png, MAP/SHAPE.png, the true
          textures of single shapes
Of each subject it generates one package a method, and blends every shape alone. Prints bytes in memory; the root mean square by which
the package misses the textures that were generated (as compressed, 0..255); and by which changes of the texture miss the true
ones, beside predicting no change, over texels that any shape changes. Two difference textures make the two forms equal in bytes.
Needs NumPy and Pillow.
"""
import argparse
import json
import pathlib
import re
import subprocess

import numpy as np
from PIL import Image

FORMS = {"compress and stretch": ["--method", "compress-stretch"], "facezip, 2 textures": ["--differences", "2"],
         "facezip, 4 textures": ["--differences", "4"]}


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, command))}\n{done.stderr}")
    return done.stdout


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
        for form, options in FORMS.items():
            package = work / (form.replace(", ", "_").replace(" ", "_") + ".facezip")
            said = run(o.facezip, "--quiet", "generate", own, "--model", o.model, "--output", package, "--maps", o.map, "--unit", "cm",
                       *options)
            document = json.loads((package / "package.json").read_text())
            shapes = document["expressions"]
            clip = work / "clip.csv"
            clip.write_text(",".join(shapes) + "\n" + "".join(
                ",".join("1" if n == m else "0" for m in range(len(shapes))) + "\n" for n in range(len(shapes))))
            frames = work / "frames"
            run(o.facezip, "--quiet", "blend", package, "--animation", clip, "--output", frames / "%04d.png")
            squares, nothing = 0.0, 0.0
            true = np.array([pixels(truth / f"{shape}.png") - true_neutral for shape in shapes])
            moves = np.abs(true).max((0, 3)) > 2
            for change, frame in zip(true, sorted(frames.glob("*.png"))):
                squares += ((pixels(frame) - neutral - change)[moves] ** 2).mean()
                nothing += (change[moves] ** 2).mean()
            held = re.search(r"memory: (\S+ \S+) at run time", run(o.facezip, "info", package)).group(1)
            compressed = re.search(r"RMSE (\S+) as compressed", said).group(1)
            print(f"{subject}, {form}: {held}, {compressed} as compressed, changes err by "
                  f"{np.sqrt(squares / len(shapes)):.3f} of {np.sqrt(nothing / len(shapes)):.3f}", flush=True)


if __name__ == "__main__":
    main()
