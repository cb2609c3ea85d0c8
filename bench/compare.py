#!/usr/bin/python3
"""Compares two results of a benchmark: bench/compare.py BEFORE.json AFTER.json [--threshold 0.1] [--fail]

Takes what kernel_throughput (--benchmark_out), compress_time, paper_pipeline.py and growth.py write. A row is called faster or slower
when its times differ by more than the threshold and by more than the repetitions of either run differ among themselves,
and, where the row has one, its share of the roof differs the same way: a busy minute moves the roof too.
"""

import argparse
import json
import pathlib
import statistics
import sys


class Row:
    """Times of one row (milliseconds, one for each repetition) and its shares of the roof, if it has any."""

    def __init__(self):
        self.times = []
        self.shares = []

    def time(self):
        """The best repetition: other work on the machine only ever adds time."""
        return min(self.times)

    def share(self):
        return max(self.shares) if self.shares else None

    def spread(self):
        """By how much the median repetition was above the best: what may be noise. 0 for a single one."""
        return statistics.median(self.times) / min(self.times) - 1.0


def google_rows(result):
    rows = {}
    for entry in result["benchmarks"]:
        if entry.get("run_type") == "aggregate" or entry.get("error_occurred"):
            continue
        row = rows.setdefault(entry.get("run_name", entry["name"]), Row())
        # The best iteration: other work on the machine only ever adds time.
        scale = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}[entry["time_unit"]]
        row.times.append(entry.get("best_ms", entry["real_time"] * scale))
        share = max(entry.get("of_copy", 0.0), entry.get("of_fma", 0.0))  # of the roof that it is nearer to
        if share > 0.0:
            row.shares.append(share)
    return rows


def paper_rows(result):
    rows = {}
    for name, entry in result["rows"].items():
        for who in ("paper", "facezip"):
            rows.setdefault(f"{who}: {name}", Row()).times.append(1e3 * entry[f"{who}_seconds"])
    return rows


def growth_rows(result):
    rows = {}
    for run in result["runs"]:
        name = f"R {run['resolution']}, N {run['expressions']}, K {run['masks']}"
        rows.setdefault(name, Row()).times.append(1e3 * run["wall_seconds"])
        for stage, seconds in run["seconds"].items():
            if seconds >= 0.01:  # less is noise
                rows.setdefault(f"{name}: {stage}", Row()).times.append(1e3 * seconds)
    return rows


def compress_rows(result):
    rows = {"decode": Row(), "compress": Row()}
    for repeat in result["repeats"]:
        for name, row in rows.items():
            row.times.append(1e3 * repeat[f"{name}_seconds"])
        rows["compress"].shares.append(1.0 / repeat["ratio"])  # decoding is the roof
    return rows


def read_rows(file):
    try:
        result = json.loads(file.read_text())
    except (OSError, ValueError) as error:
        sys.exit(f"compare.py: {file}: {error}")
    if "benchmarks" in result:
        return google_rows(result)
    if "repeats" in result:
        return compress_rows(result)
    readers = {"paper_pipeline": paper_rows, "growth": growth_rows}
    if result.get("benchmark") not in readers:
        sys.exit(f"compare.py: {file}: expected a result of kernel_throughput, compress_time, paper_pipeline.py or growth.py")
    return readers[result["benchmark"]](result)


def verdict(before, after, threshold):
    """'faster', 'slower' or ''."""
    allowed = max(threshold, before.spread() + after.spread())
    ratio = after.time() / before.time()
    if 1.0 / (1.0 + allowed) <= ratio <= 1.0 + allowed:
        return ""
    if before.share() and after.share():
        against_roof = before.share() / after.share()
        if (against_roof > 1.0) != (ratio > 1.0) or abs(against_roof - 1.0) <= threshold / 2:
            return ""  # the machine changed, not the row
    return "slower" if ratio > 1.0 else "faster"


def percent(share):
    return "" if share is None else f"{100.0 * share:.0f} %"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("before", type=pathlib.Path)
    parser.add_argument("after", type=pathlib.Path)
    parser.add_argument("--threshold", type=float, default=0.1, help="differences below this share are noise [0.1]")
    parser.add_argument("--fail", action="store_true", help="exit code 1 when a row is slower")
    arguments = parser.parse_args()
    before, after = read_rows(arguments.before), read_rows(arguments.after)
    shared = [name for name in before if name in after]
    if not shared:
        sys.exit("compare.py: the results have no row in common")

    cells = [("row", "before ms", "after ms", "after / before", "noise", "of roof", "then", "")]
    slower = 0
    for name in shared:
        a, b = before[name], after[name]
        word = verdict(a, b, arguments.threshold)
        slower += word == "slower"
        cells.append((name, f"{a.time():.4g}", f"{b.time():.4g}", f"{b.time() / a.time():.2f}",
                      f"{100.0 * (a.spread() + b.spread()):.0f} %", percent(a.share()), percent(b.share()), word))
    widths = [max(len(row[i]) for row in cells) for i in range(len(cells[0]))]
    for row in cells:
        text = [row[0].ljust(widths[0])] + [cell.rjust(width) for cell, width in zip(row[1:-1], widths[1:-1])]
        print("  ".join(text + [row[-1]]).rstrip())
    for title, names in (("only before", before.keys() - after.keys()), ("only after", after.keys() - before.keys())):
        if names:
            print(f"{title}: {', '.join(sorted(names))}")
    if all(len(row.times) == 1 for row in (*before.values(), *after.values())):
        print("One repetition each, so noise is not known: run with --benchmark_repetitions=5.")
    return 1 if arguments.fail and slower else 0


if __name__ == "__main__":
    sys.exit(main())
