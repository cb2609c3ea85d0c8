#!/usr/bin/python3
"""The FaceZip paper's pipeline as its text describes it (section 3.1), beside `facezip compress --method paper` on the
same capture in the same run.

    bench/paper_pipeline.py CAPTURE [--resolution 512] [--facezip build/release/host/cli/facezip] [--output FILE.json]

Fragments are what the paper makes them: a texture for each expression and mask, clustered by scikit-learn's k-means with
its own settings; the permutation is found by the paper's search. NumPy, SciPy and scikit-learn (Debian: python3-numpy
python3-scipy python3-sklearn python3-pil). bench/README.md says what is compared with what.
"""

import argparse
import contextlib
import itertools
import json
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
import sklearn
import sklearn.cluster
from PIL import Image

CLUSTERS = 4  # difference textures


class Stages:
    """Wall time by stage."""

    def __init__(self):
        self.seconds = {}

    @contextlib.contextmanager
    def __call__(self, name):
        print(f"{name} ...", end=" ", flush=True, file=sys.stderr)
        start = time.perf_counter()
        yield
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start
        print(f"{self.seconds[name]:.2f} s", file=sys.stderr)


# Input


def read_obj(path):
    """Positions #V x 3, UVs #VT x 2, triangles #F x 3 x 2 of (position, UV) indices; polygons become fans."""
    positions, uvs, triangles = [], [], []
    for line in path.read_text().splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            positions.append([float(x) for x in rest[:3]])
        elif word == "vt":
            uvs.append([float(x) for x in rest[:2]])
        elif word == "f":
            corners = [[int(i) - 1 for i in corner.split("/")[:2]] for corner in rest]
            triangles += [[corners[0], corners[i], corners[i + 1]] for i in range(1, len(corners) - 1)]
    return np.array(positions), np.array(uvs), np.array(triangles)


def read_region(capture, triangles):
    """The triangles of the face: those of face_region.txt, else all."""
    file = capture / "face_region.txt"
    if not file.exists():
        return triangles
    chosen = []
    for word in file.read_text().split():
        first, _, last = word.partition("-")
        chosen += range(int(first), int(last or first) + 1)
    return triangles[chosen]


def resize_capture(capture, resolution, folder, map_name):
    """A capture with the same meshes and one map of resolution x resolution texels."""
    for item in capture.iterdir():
        if item.name not in ("albedo", "normal", "coverage.png", map_name):
            (folder / item.name).symlink_to(item.resolve())
    (folder / map_name).mkdir()
    for image in sorted((capture / map_name).iterdir()):
        with Image.open(image) as picture:
            if picture.size != (resolution, resolution):
                picture = picture.resize((resolution, resolution), Image.Resampling.BOX)
            picture.save(folder / map_name / image.name)


def read_textures(folder, map_name):
    """Neutral H x W x 3 and expressions N x H x W x 3, 0..255, in the order of their names."""
    def read(path):
        return np.asarray(Image.open(path).convert("RGB"), dtype=np.float32)

    files = sorted(file for file in (folder / map_name).iterdir() if file.stem != "neutral")
    return read(folder / map_name / "neutral.png"), np.stack([read(file) for file in files])


# Masks


def poisson_disk(positions, vertices, radius, random):
    """Dart throwing over the vertices of the face, rejecting those within the radius of an earlier one."""
    samples = []
    for vertex in random.permutation(vertices):
        if all(np.linalg.norm(positions[vertex] - positions[s]) >= radius for s in samples):
            samples.append(vertex)
    return samples


def biharmonic_weights(triangles, samples):
    """phi, #vertices of the face x K, and those vertices: minimises |L phi|^2 with the combinatorial Laplacian L,
    phi_k = 1 at sample k and 0 at the others, by conjugate gradients."""
    vertices, local = np.unique(triangles[:, :, 0], return_inverse=True)
    local = local.reshape(-1, 3)
    edges = np.concatenate([local[:, [0, 1]], local[:, [1, 2]], local[:, [2, 0]]])
    count = len(vertices)
    adjacent = scipy.sparse.coo_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), (count, count)).tocsr()
    adjacent = ((adjacent + adjacent.T) > 0).astype(float)
    laplacian = scipy.sparse.diags(np.asarray(adjacent.sum(axis=1)).ravel()) - adjacent
    energy = (laplacian.T @ laplacian).tocsr()
    fixed = np.searchsorted(vertices, samples)
    free = np.setdiff1d(np.arange(count), fixed)
    system = energy[free][:, free]
    diagonal = scipy.sparse.diags(1.0 / system.diagonal())
    phi = np.zeros((count, len(samples)))
    for k, sample in enumerate(fixed):
        phi[sample, k] = 1.0
        solution, info = scipy.sparse.linalg.cg(system, -energy[free][:, [sample]].toarray().ravel(), tol=1e-6,
                                                maxiter=20000, M=diagonal)
        if info != 0:
            raise RuntimeError(f"mask {k}: conjugate gradients did not converge")
        phi[free, k] = solution
    return phi, vertices


def texels_of_triangles(uvs, triangles, size):
    """For each covered texel: its index, triangle and barycentric coordinates. Texel centre (x + 0.5) / W, v up."""
    points = uvs[triangles[:, :, 1]] * size
    points[:, :, 1] = size - points[:, :, 1]
    triangle_of = np.full((size, size), -1)
    weights = np.zeros((size, size, 3), dtype=np.float32)
    for t, (a, b, c) in enumerate(points):
        low = np.maximum(np.floor(np.min((a, b, c), axis=0) - 0.5).astype(int), 0)
        high = np.minimum(np.ceil(np.max((a, b, c), axis=0) + 0.5).astype(int), size)
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0 or (high <= low).any():
            continue
        x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
        wb = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
        wc = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
        inside = (wb >= 0) & (wc >= 0) & (wb + wc <= 1)
        window = np.s_[low[1]:high[1], low[0]:high[0]]
        triangle_of[window][inside] = t
        weights[window][inside] = np.stack([1 - wb - wc, wb, wc], axis=-1)[inside]
    texels = np.flatnonzero(triangle_of.ravel() >= 0)
    return texels, triangle_of.ravel()[texels], weights.reshape(-1, 3)[texels]


def texel_masks(phi, vertices, triangles, texels_triangle, texels_weights, cutoff, unclamped):
    """M, K x P: phi in the UV space, within [0, 1] unless it is to stay as it is, normalised to sum to one."""
    corners = np.searchsorted(vertices, triangles[:, :, 0])[texels_triangle]
    masks = np.empty((phi.shape[1], len(corners)), dtype=np.float32)
    for k in range(phi.shape[1]):
        masks[k] = (phi[corners, k] * texels_weights).sum(axis=1)
    if not unclamped:
        masks = np.clip(masks, 0.0, 1.0)
    masks[np.abs(masks) < cutoff] = 0.0  # "the value outside the fragment is zero"
    return masks / masks.sum(axis=0)


# Clustering and permutation


def cluster(differences, masks, cropped, seed):
    """Cluster of every fragment, K x N, and the centres, K x 4 fragments. Fragments are whole textures, or cropped to the
    texels of their mask."""
    labels, centres = [], []
    for mask in masks:
        chosen = np.flatnonzero(mask) if cropped else slice(None)
        fragments = (differences[:, chosen] * mask[chosen][None, :, None]).reshape(len(differences), -1)
        kmeans = sklearn.cluster.KMeans(CLUSTERS, n_init=10, random_state=seed).fit(fragments)
        labels.append(kmeans.labels_)
        centre = np.zeros((CLUSTERS, differences.shape[1], 3), dtype=np.float32)
        centre[:, chosen] = kmeans.cluster_centers_.reshape(CLUSTERS, -1, 3)
        centres.append(centre)
    return np.array(labels), np.array(centres)


def seam_tables(centres, masks, cropped):
    """Eq. 3 and 4 for pairs of masks that overlap: {(k, l): 4 x 4 costs of cluster a of k beside cluster b of l}."""
    tables = {}
    for k, l in itertools.combinations(range(len(masks)), 2):
        shared = np.flatnonzero(masks[k] * masks[l])
        if len(shared) == 0:
            continue
        chosen = shared if cropped else slice(None)
        of_k = centres[k][:, chosen] * masks[l][chosen][None, :, None]
        of_l = centres[l][:, chosen] * masks[k][chosen][None, :, None]
        tables[k, l] = np.array([[np.sum((a - b) ** 2, dtype=np.float64) for b in of_l] for a in of_k])
    return tables


def descend(tables, masks, restarts, sweeps, random):
    """The paper's search: masks one by one take the best of the 4! permutations, 10 sweeps, 100 random starts."""
    permutations = np.array(list(itertools.permutations(range(CLUSTERS))))
    neighbours = [[] for _ in range(masks)]
    for (k, l), table in tables.items():
        neighbours[k].append((l, table))
        neighbours[l].append((k, table.T))
    best_cost, best = np.inf, None
    for _ in range(restarts):
        order = permutations[random.integers(len(permutations), size=masks)]
        for _ in range(sweeps):
            for k in range(masks):
                costs = sum((table[permutations, order[l]].sum(axis=1) for l, table in neighbours[k]), np.zeros(24))
                order[k] = permutations[np.argmin(costs)]
        cost = sum(table[order[k], order[l]].sum() for (k, l), table in tables.items())
        if cost < best_cost:
            best_cost, best = cost, order.copy()
    return best, best_cost


# Both pipelines


def reconstruction_rmse(differences, masks, labels, centres, order):
    """Of Eq. 1 with the textures of Eq. 5 and the weights of Eq. 6, at full resolution and not rounded."""
    textures = np.zeros((CLUSTERS,) + differences.shape[1:], dtype=np.float32)
    for k in range(len(masks)):
        textures += centres[k][order[k]]
    squared = 0.0
    for n, difference in enumerate(differences):
        estimate = np.zeros_like(difference)
        for k, mask in enumerate(masks):
            texture = int(np.flatnonzero(order[k] == labels[k][n])[0])
            estimate += textures[texture] * mask[:, None]
        squared += np.sum((difference - estimate) ** 2, dtype=np.float64)
    return float(np.sqrt(squared / differences.size))


def run_paper(folder, arguments, radius):
    stages = Stages()
    random = np.random.default_rng(arguments.seed)
    start = time.perf_counter()
    with stages("reading"):
        positions, uvs, all_triangles = read_obj(folder / "neutral.obj")
        triangles = read_region(folder, all_triangles)
        neutral, expressions = read_textures(folder, arguments.map)
    with stages("masks"):
        samples = poisson_disk(positions, np.unique(triangles[:, :, 0]), radius, random)
        phi, vertices = biharmonic_weights(triangles, samples)
        texels, triangle, weights = texels_of_triangles(uvs, triangles, neutral.shape[0])
        masks = texel_masks(phi, vertices, triangles, triangle, weights, arguments.cutoff, arguments.unclamped)
    differences = (expressions - neutral).reshape(len(expressions), -1, 3)[:, texels]
    del expressions
    with stages("clustering"):
        labels, centres = cluster(differences, masks, arguments.cropped, arguments.seed)
    with stages("permutation"):
        tables = seam_tables(centres, masks, arguments.cropped)
        order, cost = descend(tables, len(masks), arguments.restarts, 10, random)
    with stages("textures and weights"):
        rmse = reconstruction_rmse(differences, masks, labels, centres, order)
    return {"seconds": stages.seconds | {"total": time.perf_counter() - start}, "masks": len(masks),
            "phi": [float(phi.min()), float(phi.max())], "pairs": len(tables), "covered_texels": len(texels), "permutation_cost": cost, "rmse": rmse,
            "peak_memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024}


def run_facezip(folder, arguments, scratch):
    """The report of `facezip compress --method paper`; run twice, for the first may compile kernels."""
    report = scratch / "report.json"
    command = [arguments.facezip, "--quiet", "compress", folder, "--output", scratch / "package", "--method", "paper",
               "--maps", arguments.map, "--permutation-solver", "descent", "--restarts", str(arguments.restarts),
               "--seed", str(arguments.seed), "--report", report]
    for _ in range(2):
        start = time.perf_counter()
        subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)
        wall = time.perf_counter() - start
    result = json.loads(report.read_text())
    result["wall"] = wall
    return result


def facezip_stages(report):
    """Its stages, gathered into the paper's: what the paper's clustering does to texels are its Gram matrices."""
    seconds = report["seconds"]
    groups = {"masks": ("masks", "weight grid"), "clustering": ("Gram matrices", "clustering"),
              "permutation": ("seam costs", "permutation")}
    missing = [stage for stages in groups.values() for stage in stages if stage not in seconds]
    if missing:
        raise KeyError(f"the report has no stage {missing}; it has {sorted(seconds)}")
    return {name: sum(seconds[stage] for stage in stages) for name, stages in groups.items()} | {"total": report["wall"]}


def table_of(paper, facezip):
    paper = paper | {"clustering + permutation": paper["clustering"] + paper["permutation"]}
    facezip = facezip | {"clustering + permutation": facezip["clustering"] + facezip["permutation"]}
    rows = ["masks", "clustering", "permutation", "clustering + permutation", "total"]
    return {row: {"paper_seconds": paper[row], "facezip_seconds": facezip[row], "ratio": paper[row] / facezip[row]}
            for row in rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("capture", type=pathlib.Path)
    parser.add_argument("--map", default="albedo")
    parser.add_argument("--resolution", type=int, default=512, help="side that textures are resized to [512]")
    parser.add_argument("--cropped", action="store_true",
                        help="crop fragments to the texels of their mask, which the text does not say")
    parser.add_argument("--unclamped", action="store_true", help="take phi as it is, beyond 0 and 1 too")
    parser.add_argument("--cutoff", type=float, default=0.01, help="mask weights below this are 0 [0.01, as facezip's]")
    parser.add_argument("--restarts", type=int, default=100, help="random starts of the permutation search [100]")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--facezip", type=pathlib.Path, default="build/release/host/cli/facezip")
    parser.add_argument("--output", type=pathlib.Path, help="also write the result as JSON")
    arguments = parser.parse_args()

    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        folder = scratch / "capture"
        folder.mkdir()
        resize_capture(arguments.capture, arguments.resolution, folder, arguments.map)
        report = run_facezip(folder, arguments, scratch)
        paper = run_paper(folder, arguments, report["mask_radius"])

    table = table_of(paper["seconds"], facezip_stages(report))
    result = {"benchmark": "paper_pipeline", "capture": arguments.capture.name, "resolution": arguments.resolution,
              "cropped": arguments.cropped, "device": report["device"], "scikit-learn": sklearn.__version__,
              "rows": table, "paper": paper, "facezip": {"masks": report["masks"], "seconds": report["seconds"],
                                                         "peak_memory": report["bytes"]["peak_memory"]}}
    print(f"{arguments.resolution} x {arguments.resolution}, paper: {paper['masks']} masks, phi {paper['phi'][0]:.2f} to "
          f"{paper['phi'][1]:.2f}, RMSE {paper['rmse']:.3f}; "
          f"facezip: {report['masks']} masks\n")
    print("| stage | paper's pipeline (s) | facezip (s) | ratio |\n|---|---|---|---|")
    for name, row in table.items():
        print(f"| {name} | {row['paper_seconds']:.2f} | {row['facezip_seconds']:.3f} | {row['ratio']:.0f} |")
    if arguments.output:
        arguments.output.write_text(json.dumps(result, indent=2) + "\n")


if __name__ == "__main__":
    main()
