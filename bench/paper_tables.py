#!/usr/bin/python3
"""The experiments of the FaceZip paper (Cai, Kinuwaki, Umetani 2023), made again: tables, plots and pictures.

    bench/paper_tables.py CAPTURE OUTPUT [--only table1,figure6,figure7,figure8] [--facezip COMMAND]

CAPTURE  with a template/ beside it, as `facezip synth --template` writes it. What it holds is scans or made up as
         CAPTURE is: say so beside the figures.
OUTPUT   a folder, which is made: paper_tables.md, paper_tables.json, figure6.svg, figure7.svg, figure8.png

table1   time of clustering and permutation, memory of ours, PCA(4), PCA(8) and raw textures, at 512, 1024 and 2048, of a
         rig: the template's shapes, with textures of their own. Captures are made by `facezip synth` (made-up data).
figure6  RMSE of every expression: PCA(4), clusters that are not permuted, the paper's method, and facezip's default
figure7  left: cost of the permutation after each sweep of 100 random starts; right: final costs of 1000 random starts for
         several numbers of masks, with the lower bound. The paper shows RMSE there; the cost is what the search lowers.
figure8  the texture of one shape of the rig by the naive blend, I_0 + sum_n B+_mn (I_n - I_0), by facezip, and the truth.
         Needs a capture whose truth is known: `facezip synth` makes it.

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
        rows.append({"resolution": resolution, "shapes": shapes, "clustering": stage(seconds, "cluster"),
                     "permutation": stage(seconds, "seam costs") + stage(seconds, "permutation"), "ours": 5 * texture + weights,
                     "pca4": 5 * texture, "pca8": 9 * texture, "raw": (shapes + 1) * texture})
    lines = ["| resolution | clustering, s | permutation, s | ours, MB | PCA(4), MB | PCA(8), MB | raw, MB |",
             "|---|---|---|---|---|---|---|"]
    for row in rows:
        sizes = " | ".join(megabytes(row[key]) for key in ("ours", "pca4", "pca8", "raw"))
        lines.append(f"| {row['resolution']} x {row['resolution']} | {row['clustering']:.2f} | {row['permutation']:.2f} | {sizes} |")
    return rows, lines


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
    convergence = numpy.array(search(facezip, arguments, 53, 100)["convergence"])
    searches = {masks: search(facezip, arguments, masks, 1000) for masks in counts}
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10, 4))
    left.plot(convergence.T if convergence.ndim == 2 else convergence, color="tab:blue", alpha=0.2, linewidth=0.8)
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
    """Of one shape that several captured expressions use: the sixth of ARKit is one."""
    capture, singles, rig = (facezip.work / name for name in ("poses", "singles", "rig"))
    facezip("synth", "--output", capture, "--template", "--maps", "albedo")
    facezip("synth", "--output", singles, "--template", "--expressions", "62", "--maps", "albedo")
    facezip("rig", capture, "--template", capture / "template", "--output", rig)
    facezip("reconstruct", rig, "--output", facezip.work / "shapes")
    document = json.loads((rig / "rig.json").read_text())
    names, poses = document["shapes"], [e["captured"] for e in document["expressions"]]
    b = numpy.array([[e["weights"].get(m, 0.0) for m in names] for e in document["expressions"]])

    def read(folder, name):
        return numpy.asarray(Image.open(folder / "albedo" / (name + ".png")).convert("RGB"), numpy.float32)

    known = [m for m in names if (singles / "albedo" / (m + ".png")).exists()]
    shape = max(known, key=lambda m: numpy.sort(b[:, names.index(m)])[-2])  # that two poses use most
    neutral = read(capture, "neutral")
    naive = neutral + sum(share * (read(capture, pose) - neutral)
                          for share, pose in zip(numpy.linalg.pinv(b)[names.index(shape)], poses))
    truth, ours = read(singles, shape), read(facezip.work / "shapes", shape)
    changed = numpy.abs(truth - neutral).max(axis=2) > 4
    rmse = {title: float(numpy.sqrt(numpy.mean((texture - truth)[changed] ** 2)))
            for title, texture in (("naive", naive), ("facezip", ours), ("no change", neutral))}
    rows, columns = (numpy.nonzero(changed.any(axis=axis))[0] for axis in (1, 0))
    cut = (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1))
    pictures = [numpy.clip(128 + 3 * (texture - neutral)[cut], 0, 255) for texture in (naive, ours, truth)]
    Image.fromarray(numpy.concatenate(pictures, axis=1).astype(numpy.uint8)).save(arguments.output / "figure8.png")
    lines = [f"Shape {shape}, RMSE against its true texture where that differs from the neutral: naive {rmse['naive']:.3f}, "
             f"facezip {rmse['facezip']:.3f}, no change {rmse['no change']:.3f}. Made-up data. Changes, threefold: naive, facezip, truth.",
             "", "![naive, facezip, truth](figure8.png)"]
    return {"shape": shape, **rmse}, lines


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
