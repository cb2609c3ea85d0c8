"""Blends one frame of a package's first map, from Python through the C interface, and writes it as a PPM picture.

    blend_frame.py PACKAGE FRAME.ppm EXPRESSION=WEIGHT...

Needs libfacezip_runtime where the loader looks for libraries, and nothing that does not come with Python.
"""

import ctypes
import sys


class MapInfo(ctypes.Structure):
    """facezip_map_info of facezip_runtime.h."""
    _fields_ = [("struct_size", ctypes.c_size_t), ("name", ctypes.c_char_p), ("colour_space", ctypes.c_char_p),
                ("width", ctypes.c_int32), ("height", ctypes.c_int32), ("channels", ctypes.c_int32),
                ("sample_type", ctypes.c_int32), ("frame_bytes", ctypes.c_size_t)]


lib = ctypes.CDLL("libfacezip_runtime.so.1")
lib.facezip_last_error.restype = ctypes.c_char_p


def check(status):
    if status != 0:
        raise RuntimeError(lib.facezip_last_error().decode())


def main(package, picture, *arguments):
    face = ctypes.c_void_p()
    check(lib.facezip_load(package.encode(), None, ctypes.byref(face)))
    weights = (ctypes.c_float * lib.facezip_expression_count(face))()
    for argument in arguments:
        name, value = argument.split("=")
        expression = lib.facezip_find_expression(face, name.encode())  # -1: the package has none
        if expression < 0:
            raise SystemExit(f"{package} has no expression {name}")
        weights[expression] = float(value)
    info = MapInfo(ctypes.sizeof(MapInfo))
    check(lib.facezip_get_map_info(face, 0, ctypes.byref(info)))
    if info.channels != 3 or info.sample_type != 0:
        raise SystemExit("the map is not 8-bit RGB")
    frame = bytearray(info.frame_bytes)
    check(lib.facezip_set_weights(face, weights, ctypes.c_size_t(len(weights))))
    check(lib.facezip_blend(face, 0, (ctypes.c_char * len(frame)).from_buffer(frame), ctypes.c_size_t(len(frame))))
    lib.facezip_free(face)
    with open(picture, "wb") as file:
        file.write(b"P6\n%d %d\n255\n" % (info.width, info.height) + frame)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
