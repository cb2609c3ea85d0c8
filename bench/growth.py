#!/usr/bin/python3
"""How time and peak memory of `facezip compress` grow with resolution, expressions and masks.

    bench/growth.py OUTPUT [--facezip build/release/host/cli/facezip] [--resolutions 512,1024,2048,4096]
                    [--expressions 8,20,52,100] [--masks 16,53,128] [--large]

Compresses captures of `facezip synth`, one of the three numbers varied at a time around R 1024, N 20, K 53. Writes
OUTPUT/growth.json, a table growth.md and a plot growth.svg. matplotlib (Debian: python3-matplotlib) draws the plot.
"""

import argparse
import json
import math
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import time

BASE = {"resolution": 1024, "expressions": 20, "masks": 53}
AXES = {"resolution": "R (side of the textures)", "expressions": "N (expressions)", "masks": "K (masks)"}
LARGE = {"resolution": 8192, "expressions": 8, "masks": 53}


def numbers(text):
    return [int(word) for word in text.split(",")]


def processor_seconds_of_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def compress(facezip, capture, point, memory, scratch):
    """Runs `facezip compress` once and returns what it took."""
    report = scratch / "report.json"
    command = [facezip, "--quiet", "compress", capture, "--output", scratch / "package", "--maps", "albedo", "--masks",
               point["masks"], "--memory", memory, "--report", report]
    processor = processor_seconds_of_children()
    start = time.perf_counter()
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)
    wall = time.perf_counter() - start
    processor = processor_seconds_of_children() - processor
    result = json.loads(report.read_text())
    return point | {"masks": result["masks"], "memory": memory, "wall_seconds": wall,
                    "processor_seconds": processor, "seconds": result["seconds"],
                    "peak_memory": result["bytes"]["peak_memory"], "band_rows": result["band_rows"],
                    "later_passes": result["later_passes"], "device": result["device"]}


def run_all(points, arguments):
    """Runs each point `repetitions` times; captures are made once and removed after their last use."""
    runs = []
    with tempfile.TemporaryDirectory(dir=arguments.scratch) as scratch:
        scratch = pathlib.Path(scratch)
        made = None
        for point in sorted(points, key=lambda p: (p["resolution"], p["expressions"])):
            shape = (point["resolution"], point["expressions"])
            if shape != made:
                shutil.rmtree(scratch / "capture", ignore_errors=True)
                subprocess.run([str(arguments.facezip), "--quiet", "synth", "--output", str(scratch / "capture"),
                                "--maps", "albedo", "--resolution", str(shape[0]), "--expressions", str(shape[1])],
                               check=True, stdout=subprocess.DEVNULL)
                made = shape
            for _ in range(arguments.repetitions):
                run = compress(arguments.facezip, scratch / "capture", point, arguments.memory, scratch)
                runs.append(run)
                print(f"R {run['resolution']} N {run['expressions']} K {run['masks']}: {run['wall_seconds']:.2f} s, "
                      f"{run['peak_memory'] / 2**20:.0f} MiB", file=sys.stderr)
    return runs


def best_runs(runs):
    """The fastest repetition of each point: other work on the machine only ever adds time."""
    best = {}
    for run in runs:
        key = tuple(run[name] for name in AXES)
        if key not in best or run["processor_seconds"] < best[key]["processor_seconds"]:
            best[key] = run
    return list(best.values())


def series(runs, axis):
    """Runs that differ from the base in `axis` alone, by its value. Masks are as near as the sampling came."""
    others = [name for name in AXES if name != axis and name != "masks"]
    chosen = [run for run in runs if all(run[name] == BASE[name] for name in others)]
    if axis != "masks":
        chosen = [run for run in chosen if run["wanted_masks"] == BASE["masks"]]
    return sorted(chosen, key=lambda run: run[axis])


def exponent(chosen, axis, value):
    """b of value ~ axis^b over the upper half of the axis, where constant costs matter least; None where it is none."""
    chosen = chosen[-2:]
    if len(chosen) < 2 or chosen[0][axis] == chosen[1][axis] or min(value(run) for run in chosen) <= 0:
        return None
    return math.log(value(chosen[1]) / value(chosen[0])) / math.log(chosen[1][axis] / chosen[0][axis])


def stages_of(runs):
    """Names of stages that take at least 2 % of a run, in the order of the largest."""
    names = {name for run in runs for name, seconds in run["seconds"].items()
             if name not in ("total", "decoding textures") and seconds >= 0.02 * run["wall_seconds"]}
    return sorted(names, key=lambda name: -max(run["seconds"].get(name, 0.0) for run in runs))


def table(runs):
    stages = stages_of(runs)
    lines = []
    for axis, title in AXES.items():
        chosen = series(runs, axis)
        if len(chosen) < 2:
            continue
        header = [title.split()[0], "wall s", "processor s", "peak MiB"] + [f"{name} s" for name in stages]
        lines += [f"**{title}**", "", "| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
        for run in chosen:
            cells = [run[axis], f"{run['wall_seconds']:.2f}", f"{run['processor_seconds']:.2f}", f"{run['peak_memory'] / 2**20:.0f}"]
            cells += [f"{run['seconds'].get(name, 0.0):.2f}" for name in stages]
            lines.append("| " + " | ".join(map(str, cells)) + " |")
        values = [lambda run, name=name: run[name] for name in ("wall_seconds", "processor_seconds", "peak_memory")]
        values += [lambda run, name=name: run["seconds"].get(name, 0.0) for name in stages]
        cells = ["exponent"] + ["" if (b := exponent(chosen, axis, value)) is None else f"{b:.1f}" for value in values]
        lines += ["| " + " | ".join(cells) + " |", ""]
    return "\n".join(lines)


def plot(runs, file):
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "facezip"
    from matplotlib import pyplot

    axes_with_runs = [axis for axis in AXES if len(series(runs, axis)) > 1]
    figure, grid = pyplot.subplots(2, len(axes_with_runs), figsize=(4.2 * len(axes_with_runs), 7), squeeze=False,
                                   sharey="row", layout="constrained")
    stages = stages_of(runs)
    for column, axis in enumerate(axes_with_runs):
        chosen = series(runs, axis)
        x = [run[axis] for run in chosen]
        times, memory = grid[0][column], grid[1][column]
        times.loglog(x, [run["wall_seconds"] for run in chosen], "k-o", label="wall time")
        times.loglog(x, [run["processor_seconds"] for run in chosen], "k--s", markersize=4, label="processor time")
        for stage in stages[:7]:
            times.loglog(x, [max(run["seconds"].get(stage, 0.0), 1e-3) for run in chosen], "-o", markersize=3, label=stage)
        memory.semilogx(x, [run["peak_memory"] / 2**20 for run in chosen], "k-o")
        memory.set_xlabel(AXES[axis])
        memory.set_ylim(0, 1.1 * max(run["peak_memory"] / 2**20 for run in runs))
        for area in (times, memory):
            area.set_xticks(x, [str(value) for value in x])
            area.minorticks_off()
            area.grid(True, alpha=0.3)
    grid[0][0].set_ylabel("seconds")
    grid[1][0].set_ylabel("peak memory, MiB")
    grid[0][-1].legend(fontsize="small", loc="center left", bbox_to_anchor=(1, 0.5))
    figure.savefig(file, metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("output", type=pathlib.Path, help="folder of growth.json, growth.md and growth.svg")
    parser.add_argument("--facezip", type=pathlib.Path, default="build/release/host/cli/facezip")
    parser.add_argument("--resolutions", type=numbers, default=[512, 1024, 2048, 4096])
    parser.add_argument("--expressions", type=numbers, default=[8, 20, 52, 100])
    parser.add_argument("--masks", type=numbers, default=[16, 53, 128])
    parser.add_argument("--base", type=numbers, help="R,N,K that the others are varied around [1024,20,53]")
    parser.add_argument("--large", action="store_true", help="also 8192 x 8192 with 8 expressions, within --memory")
    parser.add_argument("--memory", default="2GiB")
    parser.add_argument("--repetitions", type=int, default=2, help="the fastest counts; the first may compile kernels [2]")
    parser.add_argument("--scratch", type=pathlib.Path, help="where captures are made [the temporary directory]")
    arguments = parser.parse_args()
    if arguments.base:
        BASE.update(zip(BASE, arguments.base))

    varied = {"resolution": arguments.resolutions, "expressions": arguments.expressions, "masks": arguments.masks}
    points = [BASE | {axis: value} for axis, values in varied.items() for value in values]
    points = [BASE] + points + ([LARGE] if arguments.large else [])
    unique = {tuple(point.values()): point | {"wanted_masks": point["masks"]} for point in points}
    runs = run_all(list(unique.values()), arguments)
    arguments.output.mkdir(parents=True, exist_ok=True)
    (arguments.output / "growth.json").write_text(json.dumps({"benchmark": "growth", "runs": runs}, indent=2) + "\n")
    best = best_runs(runs)
    text = table(best)
    large = [run for run in best if run["resolution"] == LARGE["resolution"]]
    for run in large:
        text += (f"\n{run['resolution']} x {run['resolution']}, {run['expressions']} expressions, --memory {run['memory']}: "
                 f"{run['wall_seconds']:.0f} s, peak {run['peak_memory'] / 2**20:.0f} MiB\n")
    (arguments.output / "growth.md").write_text(text)
    print(text)
    plot(best, arguments.output / "growth.svg")


if __name__ == "__main__":
    main()
