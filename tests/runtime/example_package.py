"""Writes the worked example of docs/package_format.md to a directory: example_package.py DIRECTORY

Python's standard library alone, and the document's numbers: independent of facezip's writer.
"""

import json
import pathlib
import re
import shutil
import struct
import sys
import zlib


def write_png(path, rows, channels, bits):
    """rows: lists of samples, channels interleaved."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    samples = "B" if bits == 8 else "H"
    raw = b"".join(b"\0" + struct.pack(f">{len(row)}{samples}", *row) for row in rows)
    header = struct.pack(">IIBBBBB", len(rows[0]) // channels, len(rows), bits, {1: 0, 2: 4}[channels], 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw)) +
                     chunk(b"IEND", b""))


def write_example(directory):
    document = pathlib.Path(__file__).resolve().parents[2] / "docs" / "package_format.md"
    description = json.loads(re.search(r"```json\n(.*?)```", document.read_text(), re.DOTALL).group(1))
    shutil.rmtree(directory, ignore_errors=True)
    for folder in ("albedo", "gloss"):
        (directory / folder).mkdir(parents=True)
    (directory / "package.json").write_text(json.dumps(description))

    albedo, gloss = directory / "albedo", directory / "gloss"
    smile = [255, 128, 255, 128, 0, 128, 0, 128]
    jaw_open = [0, 192, 0, 192, 255, 64, 255, 64]
    write_png(albedo / "weights.png", 3 * [smile + jaw_open], channels=2, bits=8)
    write_png(albedo / "neutral.png", 8 * [[100 + x for x in range(16)]], channels=1, bits=8)
    write_png(albedo / "difference_0.png", 8 * [16 * [148]], channels=1, bits=8)
    write_png(albedo / "difference_1.png", 8 * [16 * [118]], channels=1, bits=8)
    write_png(gloss / "weights.png", 3 * [3 * [128, 64] + 3 * [64, 32]], channels=2, bits=8)
    write_png(gloss / "neutral.png", 2 * [4 * [50]], channels=1, bits=8)
    write_png(gloss / "difference_0.png", 2 * [4 * [35349]], channels=1, bits=16)
    write_png(gloss / "difference_1.png", 2 * [[20000 + 300 * x for x in range(4)]], channels=1, bits=16)


if __name__ == "__main__":
    write_example(pathlib.Path(sys.argv[1]))
