#!/usr/bin/python3
"""How well faces are generated of people that were held out (Li et al. 2020, Table 2, Fig. 17 and 18).

    library_tables.py FACEZIP MODEL HELD WORK [--subjects 080,081,...] [--scans 26] [--maps albedo]

HELD      a library: template/, facs.json, subjects/NNN/, and truth/NNN/shapes/SHAPE.obj where the true shapes are known
MODEL     that `facezip train` wrote, without these subjects
Of each subject it makes packages: the template's shapes on the neutral (`rig` of it alone), example-based rigging with SCANS
expressions (`rig`), and the generated one. It then fits each package's shapes to all expressions, weights in [0, 1], on the
subject's own neutral, and prints root mean squares in mm over vertices: of expressions, of shapes. `swapped` is the next subject's
generated shapes. Needs NumPy and SciPy.
"""
import argparse
import json
import pathlib

import numpy as np
from scipy.optimize import lsq_linear

from people import rms, run, vertices


def neutral_alone(subject, folder):
    """The subject's capture without its expressions."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in subject.glob("*"):
        target = folder / path.name
        if path.is_file() and not target.exists():
            target.symlink_to(path.resolve())
        if path.is_dir() and any(path.glob("neutral.*")):
            target.mkdir(exist_ok=True)
            for image in path.glob("neutral.*"):
                if not (target / image.name).exists():
                    (target / image.name).symlink_to(image.resolve())
    return folder


def some_scans(subject, folder, expressions, facs):
    """The subject's capture with some of its expressions, and what they were asked to be."""
    for name in expressions:
        for path in subject.glob(f"*/{name}.*"):
            target = folder / path.parent.name / path.name
            target.parent.mkdir(parents=True, exist_ok=True)
            if not target.exists():
                target.symlink_to(path.resolve())
    (folder / "facs.json").write_text(json.dumps({name: facs[name] for name in expressions}))
    return neutral_alone(subject, folder)


def shapes_of(package, names, count):
    neutral = vertices(package / "shapes/neutral.obj")[:count]
    return np.array([vertices(package / f"shapes/{name}.obj")[:count] - neutral for name in names])


def fitted(shapes, displacement):
    """What the shapes leave of a displacement, weights in [0, 1]."""
    basis = shapes.reshape(len(shapes), -1).T
    gram = basis.T @ basis
    factor = np.linalg.cholesky(gram + 1e-9 * np.trace(gram) / len(gram) * np.eye(len(gram))).T
    weights = lsq_linear(factor, np.linalg.solve(factor.T, basis.T @ displacement.ravel()), (0, 1)).x
    return displacement - (basis @ weights).reshape(displacement.shape)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("facezip", type=pathlib.Path)
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("held", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--subjects", default="")
    parser.add_argument("--scans", type=int, default=26)
    parser.add_argument("--maps", default="albedo")
    parser.add_argument("--millimetres", type=float, default=10.0, help="of the meshes' unit")
    options = parser.parse_args()
    options.facezip = options.facezip.resolve()
    facs = json.loads((options.held / "facs.json").read_text())
    template = options.held / "template"
    names = sorted(p.stem for p in template.glob("*.obj") if not p.stem.endswith("neutral"))
    subjects = options.subjects.split(",") if options.subjects else sorted(p.name for p in (options.held / "subjects").iterdir())
    expressions = sorted(facs)
    scans = expressions[:: max(1, len(expressions) // options.scans)][: options.scans]
    work = options.work.resolve()
    rows, generated, neutrals, moved = {}, {}, {}, {}
    columns = ["template on the subject", f"example-based, {len(scans)} scans", "generated", "generated, swapped"]
    shapes_by_method = {}
    for who in subjects:
        subject = options.held / "subjects" / who
        alone = neutral_alone(subject, work / who / "neutral")
        few = some_scans(subject, work / who / "scans", scans, facs)
        common = ["--maps", options.maps]
        packages = {c: work / who / c.split(",")[0].replace(" ", "_") for c in columns[:3]}
        run(options.facezip, "-q", "rig", alone, "--template", template, "--transfer", "displacements", "--output",
            packages[columns[0]], *common)
        run(options.facezip, "-q", "rig", few, "--template", template, "--weights", few / "facs.json", "--output",
            packages[columns[1]], *common)
        run(options.facezip, "-q", "generate", alone, "--model", options.model, "--output", packages[columns[2]], *common)
        neutrals[who] = vertices(subject / "neutral.obj")
        moved[who] = np.array([vertices(subject / f"expressions/{e}.obj") - neutrals[who] for e in expressions])
        shapes_by_method[who] = {c: shapes_of(packages[c], names, len(neutrals[who])) for c in columns[:3]}
    for i, who in enumerate(subjects):
        own = dict(shapes_by_method[who])
        own[columns[3]] = shapes_by_method[subjects[(i + 1) % len(subjects)]][columns[2]]
        truth = options.held / "truth" / who / "shapes"
        for column in columns:
            left = [rms(fitted(own[column], displacement)) for displacement in moved[who]]
            entry = rows.setdefault(column, {"expressions": [], "shapes": []})
            entry["expressions"].append(np.sqrt(np.mean(np.square(left))))
            if truth.is_dir():
                true = np.array([vertices(truth / f"{name}.obj") - neutrals[who] for name in names])
                entry["shapes"].append(rms(own[column] - true))
    print(f"{len(subjects)} subjects, {len(expressions)} expressions, {len(names)} shapes; mm, root mean square\n")
    print("| | expressions, weights free | shapes |\n|---|---|---|")
    for column in columns:
        values = [f"{options.millimetres * np.mean(rows[column][key]):.3f}" if rows[column][key] else "" for key in ("expressions", "shapes")]
        print(f"| {column} | {values[0]} | {values[1]} |")


if __name__ == "__main__":
    main()
