#!/usr/bin/python3
"""How near the truth `facezip rig` comes: weights, shapes and their textures, from captures whose rig is known.

    bench/rig_truth.py measure CAPTURE --template DIR --weights WEIGHTS [--singles CAPTURE] --work DIR [--unit cm]
    bench/rig_truth.py guess WEIGHTS TEMPLATE GUESS.csv [--spread 0.2] [--seed 1]
    bench/rig_truth.py compare PACKAGE WEIGHTS [--guess GUESS.csv] [--singles CAPTURE] [--start PACKAGE]
                         [--capture CAPTURE]

`measure` makes a guess, rigs the capture without it, with it, and with `--iterations 0` (the template's shapes on the
subject), and compares all three. `guess` writes the driving weights disturbed by up to SPREAD either way, clamped to
[0, 1]. `compare` does the comparison for a package at hand.

WEIGHTS   the driving weights: {"smile": {"mouthSmile": 0.8}} (`facezip synth --template` writes weights.json), or a
          list "expressions" with "name" and "nonzero"
SINGLES   a capture of single shapes, named as the template's, at weight 1 or as its own weights.json says:
          `facezip synth --expressions 62 --template`, or singles/ of bench/rig_subject.py

The reference beside the textures is P = A B^T (B A B^T + 0.3 I)^-1 on the same weight grid, on textures that are not
compressed; A is how far the template's shapes strain the skin, 1 for the largest in a cell. Needs NumPy and Pillow.
"""

import argparse
import json
import pathlib
import subprocess
import sys

import numpy
from PIL import Image

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import rig_subject  # noqa: E402

LAMBDA = 0.3
RINGS = 10
CELL = 8


class Rig:
    def __init__(self, package):
        self.package = package
        document = json.loads((package / "rig.json").read_text())
        self.names = document["shapes"]
        self.count = document["skin_vertices"]
        self.millimetres = document["millimetres_per_unit"]
        self.expressions = [e["captured"] for e in document["expressions"]]
        self.weights = numpy.array([[e["weights"].get(m, 0.0) for m in self.names] for e in document["expressions"]])
        self.residuals = document["expressions"]

    def residual(self, kind):
        rows = [[e[kind][key] for key in ("mean", "p99", "max")] for e in self.residuals]
        return "%.3f / %.2f / %.2f" % tuple(numpy.mean(rows, axis=0))

    def shape(self, name):
        return rig_subject.read_obj(self.package / "shapes" / (name + ".obj"))[0][:self.count]


def driving(path, expressions, names):
    rows = rig_subject.read_weights(path, names)
    return numpy.array([rows[expression] for expression in expressions])


def guess_weights(arguments):
    names = list(rig_subject.template_names(arguments.template))
    random = numpy.random.default_rng(arguments.seed)
    lines = ["expression," + ",".join(names)]
    for expression, row in rig_subject.read_weights(arguments.weights, names).items():
        row = numpy.clip(row + random.uniform(-arguments.spread, arguments.spread, len(row)), 0, 1)
        lines.append(expression + "," + ",".join("%.4f" % w for w in row))
    arguments.output.write_text("\n".join(lines) + "\n")


def read_guess(path, expressions, names):
    header, *rows = [line.split(",") for line in path.read_text().splitlines()]
    table = {row[0]: dict(zip(header[1:], map(float, row[1:]))) for row in rows}
    return numpy.array([[table[e].get(m, 0.0) for m in names] for e in expressions])


class Singles:
    """True single shapes, at the strengths they were performed with."""

    def __init__(self, capture, rig):
        self.capture = capture
        self.neutral = rig_subject.read_obj(capture / "neutral.obj")
        self.names = [m for m in rig.names if (capture / "expressions" / (m + ".obj")).exists()]
        strengths = json.loads((capture / "weights.json").read_text()) if (capture / "weights.json").exists() else {}
        self.strengths = {m: strengths.get(m, {m: 1.0})[m] for m in self.names}
        self.moved = {m: rig_subject.read_obj(capture / "expressions" / (m + ".obj"))[0] - self.neutral[0]
                      for m in self.names}

    def distances(self, rig):
        """Mean distance to the truth in millimetres, a number per shape."""
        neutral = rig.shape("neutral")
        return numpy.array([rig.millimetres * numpy.linalg.norm(
            self.strengths[m] * (rig.shape(m) - neutral) - self.moved[m], axis=1).mean() for m in self.names])


def texture_rmse(facezip, rig, singles):
    report = rig.package / "../singles.json"
    subprocess.run([str(facezip), "--quiet", "evaluate", str(singles.capture), str(rig.package), "--shapes",
                    "--baselines", "none", "--blends", "0", "--report", str(report)],
                   check=True, stdout=subprocess.DEVNULL)
    maps = json.loads(report.read_text())["maps"]["albedo"]["detail"]
    return numpy.sqrt(numpy.mean([maps[m]["package"]["rmse"] ** 2 for m in singles.names]))


def influence(head, shapes):
    """Root mean square of the relative change of the edges around a vertex, averaged over rings: #V by M."""
    pairs = numpy.stack([numpy.repeat(numpy.arange(len(head.first)), head.degree.astype(int)), head.around], 1)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]

    def lengths(positions):
        return numpy.linalg.norm(positions[pairs[:, 0]] - positions[pairs[:, 1]], axis=1)

    before = numpy.maximum(lengths(head.positions), 1e-12)
    strain = [numpy.sqrt(numpy.bincount(pairs[:, 0], (lengths(head.positions + moved) / before - 1) ** 2,
                                        len(head.positions)) / numpy.maximum(head.degree - 1, 1)) for moved in shapes]
    return head.smooth(numpy.stack(strain, 1), RINGS)


def reference_rmse(capture, rig, start, singles):
    """The reference solve's error, and that of predicting no change."""
    def differences(folder, names, size=None):
        images = [Image.open(folder / "albedo" / (name + ".png")).convert("RGB") for name in ["neutral"] + names]
        images = [image.resize((size, size), Image.BOX) if size else image for image in images]
        images = numpy.array([numpy.asarray(image, numpy.float32) for image in images])
        return images[1:] - images[0]

    truth = differences(singles.capture, singles.names)
    size = truth.shape[1]
    positions, uvs, triangles, uv_triangles, _ = rig_subject.read_obj(capture / "neutral.obj")
    head = rig_subject.Head(positions, uvs, triangles, uv_triangles, size,
                            rig_subject.covered_triangles(capture, len(triangles)))
    observed = differences(capture, rig.expressions, size)
    columns = [rig.names.index(m) for m in singles.names]
    strain = influence(head, [start.shape(m) - positions for m in rig.names])
    b, error, nothing, count = rig.weights, 0.0, 0.0, 0
    for y in range(0, size, CELL):
        for x in range(0, size, CELL):
            rows, cols = numpy.nonzero(head.covered[y:y + CELL, x:x + CELL])
            if not len(rows):
                continue
            near = numpy.argmin((rows - CELL / 2 + 0.5) ** 2 + (cols - CELL / 2 + 0.5) ** 2)
            at = y + rows[near], x + cols[near]
            a = head.barycentric[at] @ strain[triangles[head.triangle_at[at]]]
            a /= max(a.max(), 1e-12)
            solution = (a[:, None] * b.T) @ numpy.linalg.inv((b * a) @ b.T + LAMBDA * numpy.eye(len(b)))
            wanted = truth[:, y + rows, x + cols].reshape(len(truth), -1)
            found = solution[columns] @ observed[:, y + rows, x + cols].reshape(len(observed), -1)
            error, nothing = error + ((found - wanted) ** 2).sum(), nothing + (wanted ** 2).sum()
            count += wanted.size
    return numpy.sqrt(error / count), numpy.sqrt(nothing / count)


def compare(arguments, package, guess, start):
    weights, singles = arguments.weights, arguments.singles
    rig = Rig(package)
    print("\n%s" % package)
    print("  captured meshes, mean / 99th pct / largest, mm: rig %s, template %s" %
          (rig.residual("residual_mm"), rig.residual("template_residual_mm")))
    truth = driving(weights, rig.expressions, rig.names)
    text = "  weights against the driving ones, mean absolute difference: rig %.4f" % abs(rig.weights - truth).mean()
    if guess:
        text += ", guess %.4f" % abs(read_guess(guess, rig.expressions, rig.names) - truth).mean()
    if start:
        text += ", template %.4f" % abs(Rig(start).weights - truth).mean()
    print(text)
    if not singles:
        return
    true_shapes = Singles(singles, rig)
    distances = true_shapes.distances(rig)
    text = "  shapes, mean distance to the true ones, mm: rig %.4f" % distances.mean()
    if start:
        before = true_shapes.distances(Rig(start))
        text += ", template %.4f; nearer than the template's: %d of %d, further by over 2 %%: %d" % (
            before.mean(), (distances < before).sum(), len(before), (distances > 1.02 * before).sum())
    print(text)
    text = "  textures of single shapes, RMSE: %.3f" % texture_rmse(arguments.facezip, rig, true_shapes)
    if start and arguments.capture:
        text += ", reference %.3f, no change %.3f" % reference_rmse(arguments.capture, rig, Rig(start), true_shapes)
    print(text)


def measure(arguments):
    work = arguments.work
    work.mkdir(parents=True, exist_ok=True)
    guess = work / "guess.csv"
    guess_weights(argparse.Namespace(template=arguments.template, weights=arguments.weights, output=guess,
                                     spread=arguments.spread, seed=arguments.seed))
    for name, extra in (("start", ["--iterations", "0"]), ("no_guess", []), ("guess", ["--weights", str(guess)])):
        subprocess.run([str(arguments.facezip), "--quiet", "rig", str(arguments.capture), "--template",
                        str(arguments.template), "--maps", "albedo", "--output", str(work / name)] +
                       (["--unit", arguments.unit] if arguments.unit else []) + extra + arguments.rig_option,
                       check=True, stdout=subprocess.DEVNULL)
        if name != "start":
            compare(arguments, work / name, guess if name == "guess" else None, work / "start")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    facezip = pathlib.Path(__file__).parents[1] / "build/release/host/cli/facezip"
    one = commands.add_parser("measure")
    one.add_argument("capture", type=pathlib.Path)
    one.add_argument("--template", type=pathlib.Path, required=True)
    one.add_argument("--weights", type=pathlib.Path, required=True)
    one.add_argument("--singles", type=pathlib.Path)
    one.add_argument("--work", type=pathlib.Path, required=True)
    one.add_argument("--unit")
    one.add_argument("--rig-option", action="append", default=[], help="handed to `facezip rig`, e.g. =--head-motion")
    two = commands.add_parser("guess")
    for name in ("weights", "template", "output"):
        two.add_argument(name, type=pathlib.Path)
    for command in (one, two):
        command.add_argument("--spread", type=float, default=0.2)
        command.add_argument("--seed", type=int, default=1)
    three = commands.add_parser("compare")
    for name in ("package", "weights"):
        three.add_argument(name, type=pathlib.Path)
    for name in ("--guess", "--singles", "--start", "--capture"):
        three.add_argument(name, type=pathlib.Path)
    for command in (one, three):
        command.add_argument("--facezip", type=pathlib.Path, default=facezip)
    arguments = parser.parse_args()
    if arguments.command == "guess":
        guess_weights(arguments)
    elif arguments.command == "compare":
        compare(arguments, arguments.package, arguments.guess, arguments.start)
    else:
        measure(arguments)


if __name__ == "__main__":
    main()
