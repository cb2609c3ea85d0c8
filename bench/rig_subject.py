#!/usr/bin/python3
"""A capture whose rig is known: another subject made of a capture's neutral and its template, with the truth beside it.

    bench/rig_subject.py CAPTURE TEMPLATE WEIGHTS OUTPUT [--seed 1] [--resolution 512] [--amount 0.05] [--head-motion 3]

CAPTURE   neutral.obj, albedo/neutral.png, face_region.txt or coverage.png
TEMPLATE  neutral.obj or generic_neutral.obj and an OBJ for each shape
WEIGHTS   which shapes the expressions are made of: JSON as `facezip rig --weights` reads it, or a list of "expressions"
          with "name" and "nonzero"

The subject's neutral is the capture's, blended with the template's and changed by smooth noise (seed 1: the capture's
own). Its shapes are the template's displacements, each changed in strength and direction by noise of 4 to 5 cm; an
expression is their weighted sum, large motions saturated, with a residue per performance. Albedo is the neutral's with
creases where the skin is compressed, blood flow with its area, occlusion with its concavity, and per scan misalignment,
gain drift and noise. Another model than `facezip synth`'s: what holds for both is worth something.

OUTPUT holds capture/, weights.json (the driving weights) and singles/, a capture of every shape alone at weight 1
without flaws of its own (the captured neutral, changed): the truth that bench/rig_truth.py compares with. Needs NumPy and Pillow.
"""

import argparse
import json
import pathlib
import shutil

import numpy
from PIL import Image


def read_obj(path):
    """Positions, UVs, triangles of both (quads in two), and every line that is no position."""
    positions, uvs, triangles, uv_triangles, rest = [], [], [], [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if not words or words[0] != "v":
            rest.append(line)
        if not words:
            continue
        if words[0] == "v":
            positions.append([float(word) for word in words[1:4]])
        elif words[0] == "vt":
            uvs.append([float(word) for word in words[1:3]])
        elif words[0] == "f":
            corners = [[int(part or 1) - 1 for part in word.split("/")[:2]] for word in words[1:]]
            for i in range(1, len(corners) - 1):
                triangle = [corners[0], corners[i], corners[i + 1]]
                triangles.append([corner[0] for corner in triangle])
                uv_triangles.append([corner[-1] for corner in triangle])
    return (numpy.array(positions), numpy.array(uvs), numpy.array(triangles), numpy.array(uv_triangles),
            "\n".join(rest) + "\n")


def write_obj(path, positions, rest):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("".join("v %.6f %.6f %.6f\n" % tuple(p) for p in positions) + rest)


class Noise:
    """Smooth noise of unit variance: a sum of waves of about one length."""

    def __init__(self, random, wavelength, dimensions=3, waves=48):
        directions = random.normal(size=(waves, dimensions))
        directions /= numpy.linalg.norm(directions, axis=1, keepdims=True)
        self.waves = directions * 2 * numpy.pi / (wavelength * random.uniform(0.9, 1.2, size=(waves, 1)))
        self.phases = random.uniform(0, 2 * numpy.pi, size=waves)

    def __call__(self, points):
        return numpy.cos(points @ self.waves.T + self.phases).sum(axis=1) * numpy.sqrt(2 / len(self.phases))


def smooth_step(low, high, value):
    t = numpy.clip((value - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


class Head:
    """What a mesh's triangles say of its skin, at vertices and texels."""

    def __init__(self, positions, uvs, triangles, uv_triangles, resolution, covered_triangles):
        self.positions, self.triangles, self.resolution = positions, triangles, resolution
        edges = numpy.unique(numpy.sort(numpy.concatenate(
            [triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1), axis=0)
        # Every vertex beside itself and its neighbours, sorted: sums over rings by reduceat.
        own = numpy.arange(len(positions))
        pairs = numpy.concatenate([edges, edges[:, ::-1], numpy.stack([own, own], 1)])
        pairs = pairs[numpy.argsort(pairs[:, 0], kind="stable")]
        self.around, self.first = pairs[:, 1], numpy.searchsorted(pairs[:, 0], own)
        self.degree = numpy.bincount(pairs[:, 0], minlength=len(positions)).astype(float)
        # A tangent frame that follows the UVs, and the triangle's edges in it.
        e1, e2 = self.sides(positions)
        d1, d2 = uvs[uv_triangles[:, 1]] - uvs[uv_triangles[:, 0]], uvs[uv_triangles[:, 2]] - uvs[uv_triangles[:, 0]]
        u = e1 * d2[:, 1:] - e2 * d1[:, 1:]
        u *= numpy.sign(d1[:, :1] * d2[:, 1:] - d2[:, :1] * d1[:, 1:] + 1e-30)
        n = numpy.cross(e1, e2)
        self.areas = numpy.linalg.norm(n, axis=1) + 1e-12
        u /= numpy.linalg.norm(u, axis=1, keepdims=True) + 1e-12
        v = numpy.cross(n / self.areas[:, None], u)
        flat = numpy.stack([numpy.stack([(e1 * u).sum(1), (e1 * v).sum(1)], 1),
                            numpy.stack([(e2 * u).sum(1), (e2 * v).sum(1)], 1)], 2)
        self.inverse = numpy.linalg.pinv(flat)
        self.length = numpy.linalg.norm(positions[edges[:, 0]] - positions[edges[:, 1]], axis=1).mean()
        self.rasterise(uvs, uv_triangles, covered_triangles)

    def sides(self, positions):
        t = self.triangles
        return positions[t[:, 1]] - positions[t[:, 0]], positions[t[:, 2]] - positions[t[:, 0]]

    def smooth(self, field, rounds):
        for _ in range(rounds):
            total = numpy.add.reduceat(field[self.around], self.first, axis=0)
            field = total / self.degree.reshape((-1,) + (1,) * (field.ndim - 1))
        return field

    def rasterise(self, uvs, uv_triangles, covered):
        size = self.resolution
        self.triangle_at = numpy.full((size, size), -1)
        self.barycentric = numpy.zeros((size, size, 3))
        pixels = uvs * [size, -size] + [-0.5, size - 0.5]
        for t in covered:
            a, b, c = pixels[uv_triangles[t]]
            low = numpy.maximum(numpy.ceil(numpy.minimum(numpy.minimum(a, b), c) - 1e-6).astype(int), 0)
            high = numpy.minimum(numpy.floor(numpy.maximum(numpy.maximum(a, b), c) + 1e-6).astype(int), size - 1)
            if (high < low).any():
                continue
            x, y = numpy.meshgrid(numpy.arange(low[0], high[0] + 1), numpy.arange(low[1], high[1] + 1))
            area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
            if abs(area) < 1e-12:
                continue
            wb = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area
            wc = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area
            inside = (wb >= -1e-9) & (wc >= -1e-9) & (wb + wc <= 1 + 1e-9)
            self.triangle_at[y[inside], x[inside]] = t
            self.barycentric[y[inside], x[inside]] = numpy.stack([1 - wb - wc, wb, wc], -1)[inside]
        self.covered = self.triangle_at >= 0

    def at_texels(self, field):
        corners = field[self.triangles[self.triangle_at]]
        weights = self.barycentric.reshape(self.barycentric.shape + (1,) * (field.ndim - 1))
        return (corners * weights).sum(axis=2)

    def strain(self, posed):
        """Green's strain in the UV frame (xx, yy, xy) and the logarithm of the area ratio, at vertices."""
        e1, e2 = self.sides(posed)
        moved = numpy.stack([e1, e2], 2) @ self.inverse
        c = moved.transpose(0, 2, 1) @ moved
        area = 0.5 * numpy.log(numpy.maximum(numpy.linalg.det(c), 1e-3))
        values = numpy.stack([c[:, 0, 0] - 1, c[:, 1, 1] - 1, c[:, 0, 1], area], 1)
        values = numpy.clip(values, -0.95, 2.0)
        weight = self.to_vertices(self.areas[:, None]) + 1e-12
        return self.smooth(self.to_vertices(values * self.areas[:, None]) / weight, 2)

    def to_vertices(self, values):
        """Sums of the triangles' values at their corners."""
        corners, repeated = self.triangles.T.ravel(), numpy.tile(values, (3, 1))
        return numpy.stack([numpy.bincount(corners, column, len(self.positions)) for column in repeated.T], 1)

    def concavity(self, posed, rounds):
        """How far the surroundings lie above a vertex, in edges."""
        normals = self.to_vertices(numpy.cross(*self.sides(posed)))
        normals /= numpy.linalg.norm(normals, axis=1, keepdims=True) + 1e-12
        return ((self.smooth(posed, rounds) - posed) * normals).sum(1) / (self.length * numpy.sqrt(rounds))


class Skin:
    """The subject's creases, fixed; painted according to a mesh."""

    def __init__(self, head, random):
        self.head = head
        size = head.resolution
        spectrum = [numpy.fft.fft2(random.normal(size=(size, size))) for _ in range(3 * 8)]
        fy, fx = numpy.meshgrid(numpy.fft.fftfreq(size), numpy.fft.fftfreq(size), indexing="ij")
        self.creases = []
        for i, white in enumerate(spectrum):
            wavelength = (13.0, 6.8, 3.4)[i // 8] * size / 512
            angle = numpy.pi * (i % 8) / 8
            centre = numpy.array([numpy.cos(angle), numpy.sin(angle)]) / wavelength
            window = numpy.exp(-((fx - centre[0]) ** 2 + (fy + centre[1]) ** 2) / (2 * (0.25 / wavelength) ** 2))
            wave = numpy.fft.ifft2(white * window)
            phase = numpy.cos(numpy.angle(wave)) * numpy.minimum(abs(wave) / abs(wave).mean(), 1.5)
            self.creases.append(0.3 * numpy.maximum(-phase, 0) - numpy.maximum(phase, 0) ** 3)
        self.tendency = 0.4 + 0.6 * smooth_step(-0.5, 1.0, Noise(random, 6 * 12 * head.length)(head.positions))
        self.flush = numpy.exp(-((head.positions - head.positions.mean(0)) ** 2)[:, 1] / (2 * (12 * head.length) ** 2))
        self.neutral_hollow = [head.concavity(head.positions, rounds) for rounds in (4, 16)]

    def change(self, posed, flush):
        """Albedo beside the neutral's, R by R by 3."""
        head = self.head
        strain = head.strain(posed)
        xx, yy, xy, area = numpy.moveaxis(head.at_texels(strain), 2, 0)
        # Creases run across the direction of largest compression.
        middle, half = (xx + yy) / 2, numpy.hypot((xx - yy) / 2, xy)
        compression = -(middle - half)
        angle = numpy.arctan2(xy, (xx - yy) / 2) / 2 + numpy.pi / 2
        tendency = head.at_texels(self.tendency)
        wrinkles = numpy.zeros_like(xx)
        for i, crease in enumerate(self.creases):
            low, high = ((0.11, 0.6), (0.09, 0.5), (0.07, 0.42))[i // 8]
            along = numpy.cos(angle - numpy.pi * (i % 8) / 8) ** 2
            wrinkles += smooth_step(low, high, compression) * smooth_step(0.75, 1, along) * crease * (18, 13, 9)[i // 8]
        blood = head.at_texels(head.smooth(strain[:, 3], 8))
        hollow = sum(weight * (head.at_texels(head.concavity(posed, rounds) - neutral)) for weight, rounds, neutral in
                     zip((0.25, 0.35), (4, 16), self.neutral_hollow))
        change = wrinkles[..., None] * tendency[..., None] * [0.8, 1.0, 0.95]
        change = change + numpy.tanh(2.0 * blood)[..., None] * [4.0, 11.0, 9.0]
        change = change - 45 * numpy.tanh(hollow)[..., None] * [0.8, 1.0, 1.0]
        change = change + flush * head.at_texels(self.flush)[..., None] * [0.8, -3.0, -2.0]
        return numpy.where(head.covered[..., None], change, 0)


def to_bytes(image):
    return numpy.clip(numpy.rint(image), 0, 255).astype(numpy.uint8)


def flawed(image, random):
    """A fifth of a texel of misalignment, up to a per cent of gain, noise of 0.8 / 255."""
    size = image.shape[0]
    y, x = numpy.meshgrid(numpy.arange(size), numpy.arange(size), indexing="ij")
    points = numpy.stack([x.ravel(), y.ravel()], 1) / size
    shift = [0.14 * size / 512 * 1.0 * Noise(random, 0.3, 2)(points).reshape(size, size) for _ in range(2)]
    gradient = numpy.gradient(image, axis=(0, 1))
    image = image + gradient[0] * shift[0][..., None] + gradient[1] * shift[1][..., None]
    for channel in range(3):
        image[..., channel] *= 1 + 0.004 * Noise(random, 0.6, 2)(points).reshape(size, size)
    return image + random.normal(scale=0.8, size=image.shape)


def read_weights(path, names):
    document = json.loads(path.read_text())
    if "expressions" in document:
        document = {e["name"]: e["nonzero"] for e in document["expressions"]}
    rows = {name: numpy.array([float(weights.get(m, 0)) for m in names]) for name, weights in document.items()}
    return rows


def template_names(directory):
    return sorted(p.stem for p in directory.glob("*.obj") if p.stem not in ("neutral", "generic_neutral"))


def template_of(directory):
    neutral = next(p for p in (directory / "neutral.obj", directory / "generic_neutral.obj") if p.exists())
    return read_obj(neutral)[0], {name: read_obj(directory / (name + ".obj"))[0] for name in template_names(directory)}


def covered_triangles(capture, count):
    region = capture / "face_region.txt"
    return [int(word) for word in region.read_text().split()] if region.exists() else range(count)


def make_neutral(positions, template, seed, random):
    if seed == 1:
        return positions
    size = numpy.ptp(positions, axis=0).max()
    blend = random.choice([-1, 1]) * random.uniform(0.5, 0.9)
    other = template + blend * (positions - template)
    return other + 0.004 * size * numpy.stack([Noise(random, 0.25 * size)(positions) for _ in range(3)], 1)


def personal(delta, positions, scale, random, amount):
    """A shape as this subject does it."""
    stronger = 1 + amount * Noise(random, 4.5 * scale)(positions)
    aside = amount * numpy.stack([Noise(random, 4.5 * scale)(positions) for _ in range(3)], 1)
    return delta * stronger[:, None] + numpy.linalg.norm(delta, axis=1)[:, None] * aside


def perform(weights, deltas, positions, scale, random):
    moved = numpy.tensordot(weights, deltas, 1)
    size = numpy.linalg.norm(moved, axis=1, keepdims=True)
    moved = moved * (1 - 0.08 * smooth_step(0, 3.0 * scale, size))
    residue = numpy.stack([Noise(random, 3.0 * scale)(positions) for _ in range(3)], 1)
    return positions + moved + 0.015 * size * residue


def moved_head(positions, scale, random, degrees):
    """The mesh after the head turned about a random axis through its centre and moved along another."""
    if degrees == 0:
        return positions
    axis, shift = random.normal(size=(2, 3))
    axis *= numpy.radians(random.uniform(0, degrees)) / numpy.linalg.norm(axis)
    cross = numpy.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    angle = numpy.linalg.norm(axis)
    turn = numpy.eye(3) + numpy.sin(angle) / angle * cross + (1 - numpy.cos(angle)) / angle ** 2 * cross @ cross
    centre = positions.mean(0)
    return (positions - centre) @ turn.T + centre + random.uniform(0, scale) * shift / numpy.linalg.norm(shift)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("capture", "template", "weights", "output"):
        parser.add_argument(name, type=pathlib.Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--resolution", type=int, default=512)
    parser.add_argument("--amount", type=float, default=0.05, help="how far the subject's shapes differ")
    parser.add_argument("--head-motion", type=float, default=0.0, metavar="DEGREES",
                        help="how far the head turns at most between scans; it also moves by a thirtieth of its height")
    arguments = parser.parse_args()
    random = numpy.random.default_rng(arguments.seed)
    motions = numpy.random.default_rng([arguments.seed, 1])  # by themselves: the rest is the same with and without
    source, uvs, triangles, uv_triangles, rest = read_obj(arguments.capture / "neutral.obj")
    template, shapes = template_of(arguments.template)
    names = list(shapes)
    template = template[:len(source)]
    neutral = make_neutral(source, template, arguments.seed, random)
    scale = numpy.ptp(neutral, axis=0).max() / 30  # a head and neck are some 30 cm high
    deltas = numpy.array([personal(shapes[m][:len(source)] - template, neutral, scale, random, arguments.amount)
                          for m in names])
    rows = read_weights(arguments.weights, names)
    if arguments.seed != 1:
        rows = {name: numpy.round(numpy.clip(row * random.uniform(0.75, 1.25, len(row)), 0, 1), 3)
                for name, row in rows.items()}

    size = arguments.resolution
    head = Head(neutral, uvs, triangles, uv_triangles, size, covered_triangles(arguments.capture, len(triangles)))
    skin = Skin(head, random)
    albedo = Image.open(arguments.capture / "albedo/neutral.png").convert("RGB").resize((size, size), Image.BOX)
    albedo = numpy.asarray(albedo, float)
    scanned = to_bytes(albedo + random.normal(scale=0.8, size=albedo.shape))
    shutil.rmtree(arguments.output, ignore_errors=True)
    capture, singles = arguments.output / "capture", arguments.output / "singles"
    for folder in (capture, singles):
        (folder / "albedo").mkdir(parents=True)
        write_obj(folder / "neutral.obj", neutral, rest)
        Image.fromarray(scanned).save(folder / "albedo/neutral.png")
        for extra in ("face_region.txt", "coverage.png"):
            if (arguments.capture / extra).exists():
                shutil.copyfile(arguments.capture / extra, folder / extra)
    for name, row in rows.items():
        posed = perform(row, deltas, neutral, scale, random)
        write_obj(capture / "expressions" / (name + ".obj"), moved_head(posed, scale, motions, arguments.head_motion), rest)
        image = to_bytes(flawed(albedo + skin.change(posed, 0.5 * random.normal()), random))
        Image.fromarray(image).save(capture / "albedo" / (name + ".png"))
    for name, delta in zip(names, deltas):
        write_obj(singles / "expressions" / (name + ".obj"), neutral + delta, rest)
        image = to_bytes(scanned + skin.change(neutral + delta, 0.0))
        Image.fromarray(image).save(singles / "albedo" / (name + ".png"))
    document = {name: {m: w for m, w in zip(names, row) if w > 0} for name, row in rows.items()}
    (arguments.output / "weights.json").write_text(json.dumps(document, indent=1) + "\n")


if __name__ == "__main__":
    main()
