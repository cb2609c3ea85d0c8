#!/usr/bin/env python3
"""Run-time bytes and RMSE of packages in block formats, beside every texture in the same blocks: a table in Markdown.

usage: block_rates.py FACEZIP CAPTURE WORK [MAP]
       block_rates.py --plot WORK PICTURE

FACEZIP  the command; CAPTURE  a capture; WORK  a folder for packages, which is made; MAP  [albedo]
The rows are kept in WORK/rates.json; --plot draws them (matplotlib, Debian: python3-matplotlib) into PICTURE (.svg).
RMSE is what `facezip evaluate` decodes from the files, in 1/255, over covered texels of all expressions. Mip levels, a
third more of either, are not counted.
"""
import json
import subprocess
import sys
from pathlib import Path

# Format of the neutral, of the differences, C, weight scale.
PACKAGES = [
    ("png", "png", 4, 8),
    ("bc7", "bc7", 4, 8), ("bc7", "bc7", 4, 16), ("bc1", "bc1", 4, 16),
    ("astc-4x4", "astc-4x4", 8, 16), ("astc-4x4", "astc-4x4", 4, 8), ("astc-4x4", "astc-4x4", 4, 16),
    ("astc-4x4", "astc-5x5", 5, 16), ("astc-5x5", "astc-6x6", 4, 16), ("astc-6x6", "astc-6x6", 4, 16),
    ("astc-6x6", "astc-8x8", 4, 16), ("astc-8x8", "astc-10x10", 4, 16), ("astc-10x10", "astc-10x10", 3, 16),
]
RIVALS = ["bc7", "bc1", "astc-4x4", "astc-5x5", "astc-6x6", "astc-8x8", "astc-10x10"]


def evaluate(facezip, capture, package, report, baselines):
    subprocess.run([facezip, "--quiet", "evaluate", capture, package, "--baselines", baselines, "--blends", "0",
                    "--report", report], check=True, stdout=subprocess.DEVNULL)
    return json.loads(Path(report).read_text())


def main(facezip, capture, work, name="albedo"):
    work = Path(work)
    work.mkdir(parents=True, exist_ok=True)
    rows = []
    for neutral, differences, count, scale in PACKAGES:
        package = work / f"{neutral}_{differences}_{count}_{scale}"
        formats = [] if neutral == "png" else ["--texture-format", neutral, "--difference-format", differences]
        subprocess.run([facezip, "--quiet", "compress", capture, "--output", package, "--maps", name, "--differences",
                        str(count), "--weight-scale", str(scale), *formats], check=True, stdout=subprocess.DEVNULL)
        last = (neutral, differences, count, scale) == PACKAGES[-1]
        found = evaluate(facezip, capture, package, work / "report.json", ",".join(RIVALS) if last else "none")
        title = neutral if neutral == differences else f"{neutral}, differences {differences}"
        rows.append((f"**facezip {title}**, C = {count}, weights at 1/{scale}", found["bytes"]["package"],
                     found["maps"][name]["rmse"]["package"]))
        if last:
            for rival in RIVALS:
                rows.append((f"every texture in {rival}", found["bytes"][f"every-{rival}"],
                             found["maps"][name]["rmse"][f"every-{rival}"]))
    (work / "rates.json").write_text(json.dumps(rows, indent=1))
    print("| | memory at run time | RMSE, 0..255 |\n|---|---|---|")
    for title, size, rmse in sorted(rows, key=lambda row: -row[1]):
        print(f"| {title} | {size / 1e6:.2f} MB | {rmse:.3f} |")


def plot(work, picture):
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "facezip"  # the same bytes every time
    from matplotlib import pyplot
    rows = json.loads((Path(work) / "rates.json").read_text())
    figure, axes = pyplot.subplots(figsize=(8, 4.8))
    for ours, colour, label in ((False, "tab:gray", "every texture in blocks"), (True, "tab:blue", "facezip")):
        points = sorted((size / 1e6, rmse, title) for title, size, rmse in rows if ("facezip" in title) == ours)
        axes.plot([p[0] for p in points], [p[1] for p in points], "o", color=colour, label=label)
        # Names of the points that no other of the same kind beats; those of facezip run down, the others stand above.
        best = [p for p in points if not any(q[0] <= p[0] and q[1] <= p[1] and q != p for q in points)]
        if ours:
            axes.plot([p[0] for p in best], [p[1] for p in best], color=colour, linewidth=0.8)
        for size, rmse, title in best:
            short = title.replace("**", "").replace("every texture in ", "").replace("facezip ", "").split(", weights")[0]
            short = short.replace(", differences astc-", " / ")
            axes.annotate(short, (size, rmse), textcoords="offset points", xytext=(2, -4) if ours else (4, 5),
                          fontsize=7, color=colour, rotation=-40 if ours else 0, va="top" if ours else "bottom",
                          rotation_mode="anchor")
    axes.set_xscale("log", base=2)
    axes.set_xticks([1, 2, 4, 8, 16], ["1", "2", "4", "8", "16"])
    axes.set_xlabel("memory at run time, MB")
    axes.set_ylabel("RMSE over the face, 0..255")
    axes.set_ylim(bottom=0)
    axes.set_xlim(0.8, 34)
    axes.grid(alpha=0.3)
    axes.legend()
    figure.tight_layout()
    figure.savefig(picture, metadata={"Date": None})


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "--plot":
        plot(*sys.argv[2:])
        sys.exit()
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    main(*sys.argv[1:])
