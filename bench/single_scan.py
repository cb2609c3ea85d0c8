#!/usr/bin/python3
"""From a stranger's raw scan to a moving face in two commands, `register` and `generate` (Li et al. 2020, Fig. 15).

    single_scan.py FACEZIP MODEL HELD WORK --make-scans make_scans.py [--subjects 081,083] [--points 40000,5000] [--noise 0.004,0.02]

HELD      a library of people who are not in MODEL: template/, subjects/NNN/ and truth/NNN/shapes/SHAPE.obj
make_scans.py makes raw scans of a capture: its own vertices, layout and place, noise, holes. For each subject and quality (points
and noise in the capture's unit, one by one) it registers the neutral's scan alone and generates a face of the result. Prints,
in mm over the vertices that move: how far the registered neutral lies from the true one (mean), the generated shapes from the
true ones (root mean square), and the same of a face generated of the true neutral, and of the template's shapes. Needs NumPy.
"""
import argparse
import pathlib
import sys

import numpy as np

from people import rms, run, vertices


def linked(folder, **files):
    folder.mkdir(parents=True, exist_ok=True)
    for name, target in files.items():
        link = folder / name.replace("__", ".")
        if not link.exists():
            link.symlink_to(target.resolve())
    return folder


def rigid(points, onto):
    """R and t of x R + t."""
    a, b = points.mean(0), onto.mean(0)
    u, _, vt = np.linalg.svd((points - a).T @ (onto - b))
    turn = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt
    return turn, b - a @ turn


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("facezip", type=pathlib.Path)
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("held", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--make-scans", type=pathlib.Path, required=True)
    parser.add_argument("--subjects", default="081,083")
    parser.add_argument("--points", default="40000,5000")
    parser.add_argument("--noise", default="0.004,0.02")
    parser.add_argument("--millimetres", type=float, default=10.0, help="of a unit of the captures")
    o = parser.parse_args()
    template = vertices(o.held / "template/generic_neutral.obj")
    for subject in o.subjects.split(","):
        own, truth = o.held / "subjects" / subject, o.held / "truth" / subject / "shapes"
        names = sorted(path.stem for path in truth.glob("*.obj"))
        neutral = vertices(own / "neutral.obj")
        true = np.array([vertices(truth / f"{name}.obj") - neutral for name in names])
        of_template = np.array([vertices(o.held / f"template/{name}.obj")[:len(neutral)] - template[:len(neutral)] for name in names])
        moves = np.abs(true).max((0, 2)) > 1e-4
        print(f"{subject}: shapes of the template {o.millimetres * rms((of_template - true)[:, moves]):.3f}", flush=True)

        def errors(capture, package):
            run(o.facezip, "--quiet", "generate", capture, "--model", o.model, "--output", package, "--maps", "albedo", "--unit", "cm")
            mesh = vertices(package / "shapes/neutral.obj")[:len(neutral)]
            turn, shift = rigid(mesh[moves], neutral[moves])
            shapes = np.array([vertices(package / f"shapes/{name}.obj")[:len(neutral)] - mesh for name in names]) @ turn
            off = np.linalg.norm(mesh[moves] @ turn + shift - neutral[moves], axis=1).mean()
            return o.millimetres * off, o.millimetres * rms((shapes - true)[:, moves])

        print(f"{subject}: generated of the true neutral {errors(own, o.work / subject / 'true.facezip')[1]:.3f}", flush=True)
        for points, noise in zip(o.points.split(","), o.noise.split(",")):
            work = o.work / subject / points
            capture = linked(work / "capture", neutral__obj=own / "neutral.obj", face_region__txt=own / "face_region.txt",
                             albedo=own / "albedo", template=o.held / "template")
            run(sys.executable, o.make_scans, capture, work / "scans", "--points", points, "--noise", noise, "--expressions", "neutral",
                "--identity", 40)
            (work / "scans/template/face_region.txt").write_text((own / "face_region.txt").read_text())
            run(o.facezip, "--quiet", "register", work / "scans", "--template", work / "scans/template", "--output", work / "registered",
                "--unit", "cm", "--resolution", 1024)
            off, error = errors(work / "registered", work / "face.facezip")
            print(f"{subject}: {points} points, noise {noise}: neutral {off:.3f} off, shapes {error:.3f}", flush=True)


if __name__ == "__main__":
    main()
