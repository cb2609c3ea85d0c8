#!/usr/bin/env python3
"""How well `facezip register` registers scans whose truth is known.
    registration.py FACEZIP CAPTURE TOOLS WORK [--seeds 3,5] [--modes 100,40,0] [--resolution 1024] [--steps landmarks,model,bending,flow]
FACEZIP   the built command
CAPTURE   a registered capture with template/ and face_region.txt
TOOLS     folder of make_scans.py (CAPTURE -> raw scans with noise, holes, spikes and landmarks that are off) and judge_scans.py
          (a capture made of them against CAPTURE)
WORK      folder for scans and captures; scans that are there already are taken
Prints a row for each seed, number of identity modes and step that registration ends with (flow: all of it): means over the expressions in millimetres, RMSE of textures 0..255."""
import argparse
import json
import pathlib
import subprocess
import sys
import time

EXPRESSIONS = {3: "smile_open,brow_raise,disgust_nose_sneer", 5: "jaw_open_wide,mouth_funnel,eyes_closed_tight,surprise"}


def make_scans(options, seed, modes):
    folder = options.work / f"scans_{seed}_{modes}"
    if not (folder / "landmarks.json").exists():
        subprocess.run([sys.executable, options.tools / "make_scans.py", options.capture, folder, "--seed", str(seed),
                        "--identity", str(modes), "--expressions", EXPRESSIONS[seed]], check=True, stdout=subprocess.DEVNULL)
    return folder


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("facezip", type=pathlib.Path)
    parser.add_argument("capture", type=pathlib.Path)
    parser.add_argument("tools", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--seeds", default="3,5")
    parser.add_argument("--modes", default="100,40,0")
    parser.add_argument("--resolution", default="1024")
    parser.add_argument("--steps", default="flow")
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    columns = ["surface_mean", "drift_mean", "drift_p95", "still_mean", "texture", "slide"]
    print(f"{'seed':>4} {'modes':>5} {'step':>9} " + " ".join(f"{c:>12}" for c in columns) + f" {'seconds':>8}")
    for modes in map(int, options.modes.split(",")):
        for seed in map(int, options.seeds.split(",")):
            for step in options.steps.split(","):
                measure(options, modes, seed, step, columns)


def measure(options, modes, seed, step, columns):
    scans = make_scans(options, seed, modes)
    capture = options.work / f"capture_{seed}_{modes}"
    begin = time.time()
    subprocess.run([options.facezip, "register", scans, "--template", scans / "template", "--output", capture, "--unit", "cm",
                    "--resolution", options.resolution, "--stop-after", step, "--quiet",
                    "--report", options.work / f"report_{seed}_{modes}.json"], check=True, stdout=subprocess.DEVNULL)
    seconds = time.time() - begin
    judged = subprocess.run([sys.executable, options.tools / "judge_scans.py", options.capture, capture], check=True,
                            capture_output=True, text=True)
    found = json.loads(judged.stdout)["all"] | {"slide": json.loads(judged.stdout)["neutral"]["slide_mean"]}
    print(f"{seed:>4} {modes:>5} {step:>9} " + " ".join(f"{found[c]:>12.3f}" for c in columns) + f" {seconds:>8.1f}", flush=True)


if __name__ == "__main__":
    main()
