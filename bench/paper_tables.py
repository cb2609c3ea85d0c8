#!/usr/bin/python3
"""The experiments of the FaceZip paper (Cai, Kinuwaki, Umetani 2023), made again: tables, plots and pictures.

    bench/paper_tables.py CAPTURE OUTPUT [--only table1,figure6,figure7,figure8] [--facezip COMMAND]

CAPTURE  with a template/ beside it, as `facezip synth --template` writes it. What it holds is scans or made up as
         CAPTURE is: say so beside the figures.
OUTPUT   a folder, which is made: paper_tables.md, paper_tables.json, figure6.svg, figure7.svg, figure8.jpg

table1   time of clustering and permutation, memory of ours, PCA(4), PCA(8) and raw textures, at 512, 1024 and 2048, of a
         rig: the template's shapes, with textures of their own. Captures are made by `facezip synth` (made-up data).
figure6  RMSE of every expression: PCA(4), clusters that are not permuted, the paper's method, and facezip's default
figure7  left: cost of the permutation after each sweep of 100 random starts; right: final costs of 1000 random starts for
         several numbers of masks, with the lower bound. The paper shows RMSE there; the cost is what the search lowers.
figure8  textures of the rig's shapes by the naive blend, I_0 + sum_n B+_mn (I_n - I_0), by facezip, and the truth, on a
         capture of `facezip synth`, whose truth is known (made-up data)

Each part takes one to ten minutes. Needs NumPy, Pillow and matplotlib (Debian: python3-numpy, python3-pil,
python3-matplotlib).
"""

import argparse
import json
import pathlib
import subprocess

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "facezip"  # the same bytes every time
import numpy  # noqa: E402
from matplotlib import pyplot  # noqa: E402
from PIL import Image  # noqa: E402

PARTS = ("table1", "figure6", "figure7", "figure8")
METHODS = {"pca4": "PCA(4)", "no-permutation": "not permuted", "paper": "the paper's method", "package": "facezip"}


class Facezip:
    def __init__(self, command, work):
        self.command, self.work = command, work

    def __call__(self, *arguments):
        subprocess.run([self.command, "--quiet", *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)

    def report(self, *arguments):
        file = self.work / "report.json"
        self(*arguments, "--report", file)
        return json.loads(file.read_text())


def megabytes(count):
    return "%.2f" % (count / 1e6)


def stage(seconds, word):
    return sum(time for name, time in seconds.items() if word in name)


def table1(facezip, arguments):
    rows = []
    for resolution in (512, 1024, 2048):
        capture, rig = facezip.work / f"synth_{resolution}", facezip.work / f"rig_{resolution}"
        facezip("synth", "--output", capture, "--template", "--resolution", resolution, "--maps", "albedo")
        report = facezip.report("rig", capture, "--template", capture / "template", "--output", rig,
                                "--permutation-solver", "descent")
        shapes, texture = len(report["shapes"]), 3 * resolution ** 2
        weights = 4 * shapes * ((resolution + 7) // 8) ** 2
        seconds = report["compress"]["seconds"]
        rows.append({"resolution": resolution, "shapes": shapes, "clustering": stage(seconds, "Gram") + stage(seconds, "cluster"),
                     "permutation": stage(seconds, "seam costs") + stage(seconds, "permutation"), "ours": 5 * texture + weights,
                     "pca4": 5 * texture, "pca8": 9 * texture, "raw": (shapes + 1) * texture})
    lines = ["| resolution | clustering, s | permutation, s | ours, MB | PCA(4), MB | PCA(8), MB | raw, MB |",
             "|---|---|---|---|---|---|---|"]
    for row in rows:
        sizes = " | ".join(megabytes(row[key]) for key in ("ours", "pca4", "pca8", "raw"))
        lines.append(f"| {row['resolution']} x {row['resolution']} | {row['clustering']:.2f} | {row['permutation']:.2f} | {sizes} |")
    return rows, lines + ["", f"{rows[0]['shapes']} shapes of a rig of 20 captured expressions; made-up data."]


def figure6(facezip, arguments):
    package = facezip.work / "package"
    facezip("compress", arguments.capture, "--output", package, "--maps", "albedo")
    found = facezip.report("evaluate", arguments.capture, package, "--blends", "0", "--baselines",
                           "pca4,no-permutation,paper")["maps"]["albedo"]["per_expression"]
    names = sorted(found, key=lambda name: -found[name]["pca4"])
    figure, axes = pyplot.subplots(figsize=(9, 4.2))
    for m, (method, title) in enumerate(METHODS.items()):
        axes.bar(numpy.arange(len(names)) + 0.2 * (m - 1.5), [found[name][method] for name in names], 0.2, label=title)
    axes.set_xticks(range(len(names)), names, rotation=60, ha="right", fontsize=7)
    axes.set_ylabel("RMSE, 0..255")
    axes.legend()
    figure.tight_layout()
    figure.savefig(arguments.output / "figure6.svg", metadata={"Date": None})
    lines = ["| expression | " + " | ".join(METHODS.values()) + " |", "|---" * (len(METHODS) + 1) + "|"]
    lines += ["| %s | %s |" % (name, " | ".join("%.3f" % found[name][method] for method in METHODS)) for name in names]
    best = sum(found[name]["paper"] <= min(found[name]["pca4"], found[name]["no-permutation"]) for name in names)
    lines += ["", f"The paper's method errs least of the paper's three in {best} of {len(names)} expressions.", "",
              "![RMSE of every expression](figure6.svg)"]
    return found, lines


def search(facezip, arguments, masks, restarts):
    return facezip.report("compress", arguments.capture, "--output", facezip.work / "searched", "--method", "paper",
                          "--maps", "albedo", "--masks", masks, "--restarts", restarts, "--permutation-solver",
                          "descent")["permutation"]


def figure7(facezip, arguments):
    counts = (5, 13, 23, 33, 43, 53, 63)
    convergence = search(facezip, arguments, 53, 100)["convergence"]  # some starts end sooner than others
    searches = {masks: search(facezip, arguments, masks, 1000) for masks in counts}
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10, 4))
    for costs in convergence:
        left.plot(costs, color="tab:blue", alpha=0.2, linewidth=0.8)
    left.set(xlabel="sweeps", ylabel="cost (Eq. 3)", title="100 random starts, 53 masks")
    right.boxplot([found["restart_costs"] for found in searches.values()], labels=counts, whis=(0, 100))
    right.plot(range(1, len(counts) + 1), [found["bound"] for found in searches.values()], "_", markersize=16,
               color="tab:red", label="lower bound")
    right.set(xlabel="masks", title="1000 random starts")
    right.legend()
    figure.tight_layout()
    figure.savefig(arguments.output / "figure7.svg", metadata={"Date": None})
    lines = ["| masks | least | median | largest | lower bound | starts that reach the least |", "|---|---|---|---|---|---|"]
    for masks, found in searches.items():
        costs = numpy.array(found["restart_costs"])
        reached = (costs <= costs.min() * (1 + 1e-6)).sum()
        lines.append("| %d | %.5g | %.5g | %.5g | %.5g | %d of %d |" %
                     (masks, costs.min(), numpy.median(costs), costs.max(), found["bound"], reached, len(costs)))
    return searches, lines + ["", "![convergence and final costs](figure7.svg)"]


def figure8(facezip, arguments):
    capture, singles, rig = (facezip.work / name for name in ("poses", "singles", "rig"))
    facezip("synth", "--output", capture, "--template", "--maps", "albedo")
    facezip("synth", "--output", singles, "--template", "--expressions", "62", "--maps", "albedo")
    facezip("rig", capture, "--template", capture / "template", "--output", rig)
    facezip("reconstruct", rig, "--output", facezip.work / "shapes")
    document = json.loads((rig / "rig.json").read_text())
    names, poses = document["shapes"], [e["captured"] for e in document["expressions"]]
    b = numpy.array([[e["weights"].get(m, 0.0) for m in names] for e in document["expressions"]])
    inverse = numpy.linalg.pinv(b)

    def read(folder, name):
        return numpy.asarray(Image.open(folder / "albedo" / (name + ".png")).convert("RGB"), numpy.float32)

    neutral = read(capture, "neutral")
    changes = numpy.array([read(capture, pose) - neutral for pose in poses])

    def textures(shape):
        naive = neutral + numpy.tensordot(inverse[names.index(shape)].astype(numpy.float32), changes, 1)
        return naive, read(facezip.work / "shapes", shape), neutral, read(singles, shape)

    # Shapes that the poses tell apart from the others: of those the least squares know something.
    told = numpy.diag(inverse @ b)
    known = [m for m in names if (singles / "albedo" / (m + ".png")).exists() and told[names.index(m)] > 0.5]
    squares, worst = {}, (0.0, known[0])
    for shape in known:
        *candidates, truth = textures(shape)
        changed = numpy.abs(truth - neutral).max(axis=2) > 2
        if not changed.any():
            continue
        squares[shape] = [float(numpy.mean((texture - truth)[changed] ** 2)) for texture in candidates]
        worst = max(worst, (float(numpy.abs(truth - neutral).sum()), shape))
    rmse = dict(zip(("naive", "facezip", "no change"), numpy.sqrt(numpy.mean(list(squares.values()), axis=0)).tolist()))
    shape = worst[1]
    naive, ours, _, truth = textures(shape)
    rows, columns = (numpy.nonzero((numpy.abs(truth - neutral).max(axis=2) > 2).any(axis=axis))[0] for axis in (1, 0))
    cut = (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1))
    pictures = [numpy.clip(128 + 3 * (texture - neutral)[cut], 0, 255) for texture in (naive, ours, truth)]
    picture = Image.fromarray(numpy.concatenate(pictures, axis=1).astype(numpy.uint8))
    picture.resize((picture.width // 2, picture.height // 2), Image.LANCZOS).save(arguments.output / "figure8.jpg", quality=85)
    lines = [f"Made-up data. Textures of {len(squares)} shapes that the poses tell apart, where they differ from the neutral, RMSE: "
             f"naive {rmse['naive']:.3f}, facezip {rmse['facezip']:.3f}, no change {rmse['no change']:.3f}. "
             f"Changes of {shape}, threefold: naive, facezip, truth.", "", "![naive, facezip, truth](figure8.jpg)"]
    return {"shape": shape, "shapes": sorted(squares), **rmse}, lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("capture", type=pathlib.Path)
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--only", default=",".join(PARTS), help="parts to make [all]")
    parser.add_argument("--facezip", default="build/release/host/cli/facezip")
    arguments = parser.parse_args()
    unknown = set(arguments.only.split(",")) - set(PARTS)
    if unknown:
        parser.error(f"--only {','.join(sorted(unknown))}: expected some of {', '.join(PARTS)}")
    work = arguments.output / "work"
    work.mkdir(parents=True, exist_ok=True)
    facezip = Facezip(arguments.facezip, work)
    results, text = {}, ["# The paper's experiments"]
    for part in arguments.only.split(","):
        results[part], lines = globals()[part](facezip, arguments)
        text += ["", "## " + part.replace("table", "Table ").replace("figure", "Figure "), "", *lines]
    (arguments.output / "paper_tables.json").write_text(json.dumps(results, indent=1))
    (arguments.output / "paper_tables.md").write_text("\n".join(text) + "\n")
    print("\n".join(text))


if __name__ == "__main__":
    main()
