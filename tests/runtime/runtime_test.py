"""The C interface through ctypes: runtime_test.py LIBRARY EXAMPLE_PACKAGE FACEZIP"""

import array
import ctypes
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import threading
import unittest

LIBRARY, EXAMPLE, FACEZIP = sys.argv[1:4]


class MapInfo(ctypes.Structure):
    _fields_ = [("struct_size", ctypes.c_size_t), ("name", ctypes.c_char_p), ("colour_space", ctypes.c_char_p),
                ("width", ctypes.c_int32), ("height", ctypes.c_int32), ("channels", ctypes.c_int32),
                ("sample_type", ctypes.c_int32), ("frame_bytes", ctypes.c_size_t)]


class TextureInfo(ctypes.Structure):
    _fields_ = [("struct_size", ctypes.c_size_t), ("format", ctypes.c_char_p), ("vk_format", ctypes.c_uint32),
                ("dxgi_format", ctypes.c_uint32), ("width", ctypes.c_int32), ("height", ctypes.c_int32),
                ("channels", ctypes.c_int32), ("sample_type", ctypes.c_int32), ("block_width", ctypes.c_int32),
                ("block_height", ctypes.c_int32), ("block_bytes", ctypes.c_int32), ("levels", ctypes.c_int32),
                ("bytes", ctypes.c_size_t), ("scale", ctypes.c_double * 4), ("offset", ctypes.c_double * 4)]


def load_library():
    lib = ctypes.CDLL(LIBRARY)
    handle, index = ctypes.c_void_p, ctypes.c_int32
    lib.facezip_last_error.restype = ctypes.c_char_p
    lib.facezip_load.argtypes = [ctypes.c_char_p, ctypes.c_char_p, ctypes.POINTER(handle)]
    lib.facezip_free.argtypes = [handle]
    lib.facezip_free.restype = None
    lib.facezip_expression_count.argtypes = [handle]
    lib.facezip_get_map_info.argtypes = [handle, index, ctypes.POINTER(MapInfo)]
    lib.facezip_open.argtypes = [ctypes.c_char_p, ctypes.POINTER(handle)]
    lib.facezip_get_texture_info.argtypes = [handle, index, index, ctypes.POINTER(TextureInfo)]
    lib.facezip_level_bytes.argtypes = [handle, index, index, index]
    lib.facezip_level_bytes.restype = ctypes.c_size_t
    lib.facezip_read_level.argtypes = [handle, index, index, index, ctypes.c_void_p, ctypes.c_size_t]
    lib.facezip_set_weights.argtypes = [handle, ctypes.POINTER(ctypes.c_float), ctypes.c_size_t]
    lib.facezip_blend.argtypes = [handle, index, ctypes.c_void_p, ctypes.c_size_t]
    return lib


LIB = load_library()


class Package:
    def __init__(self, directory):
        self.handle = ctypes.c_void_p()
        self.check(LIB.facezip_load(os.fsencode(directory), b"cpu", ctypes.byref(self.handle)))

    def check(self, status):
        if status != 0:
            raise RuntimeError(LIB.facezip_last_error().decode())

    def map_info(self, index):
        info = MapInfo(struct_size=ctypes.sizeof(MapInfo))
        self.check(LIB.facezip_get_map_info(self.handle, index, ctypes.byref(info)))
        return info

    def blend(self, index, weights):
        array = (ctypes.c_float * len(weights))(*weights)
        self.check(LIB.facezip_set_weights(self.handle, array, len(weights)))
        frame = ctypes.create_string_buffer(self.map_info(index).frame_bytes)
        self.check(LIB.facezip_blend(self.handle, index, frame, len(frame)))
        return frame.raw

    def close(self):
        LIB.facezip_free(self.handle)


class Runtime(unittest.TestCase):
    def test_worked_example(self):
        package = Package(EXAMPLE)
        albedo = bytes([100, 101, 102, 103, 105, 108, 111, 114, 116, 119, 122, 125, 127, 128, 129, 130])
        self.assertEqual(package.blend(0, [0.5, 1.0]), 8 * albedo)
        self.assertEqual(package.blend(1, [0.5, 1.0]), 2 * bytes([99, 100, 100, 101]))
        self.assertEqual(package.blend(0, [0.0, 0.0]), 8 * bytes(range(100, 116)))
        self.assertEqual(package.blend(0, [100.0, 0.0])[0], 255)
        package.close()

    def test_failures_are_text_of_the_thread(self):
        with self.assertRaisesRegex(RuntimeError, "/no/such/package"):
            Package("/no/such/package")
        seen = []
        thread = threading.Thread(target=lambda: seen.append(LIB.facezip_last_error()))
        thread.start()
        thread.join()
        self.assertEqual(seen, [b""])

    def test_weights_have_a_limit(self):
        package = Package(EXAMPLE)
        for weight in (1e7, float("inf"), float("nan")):
            with self.assertRaisesRegex(RuntimeError, "at most"):
                package.blend(0, [weight, 0.0])
        package.blend(0, [-1e6, 1e6])
        package.close()

    def test_unloading_after_use(self):
        """Threads of the libraries below may still run then."""
        script = ("import _ctypes, ctypes, os, sys, time\n"
                  "lib = ctypes.CDLL(sys.argv[1])\n"
                  "face = ctypes.c_void_p()\n"
                  "assert lib.facezip_load(os.fsencode(sys.argv[2]), b'cpu', ctypes.byref(face)) == 0\n"
                  "lib.facezip_free(face)\n"
                  "_ctypes.dlclose(lib._handle)\n"
                  "time.sleep(0.5)\n")
        for _ in range(3):
            subprocess.run([sys.executable, "-c", script, LIBRARY, EXAMPLE], check=True)

    def test_packages_of_two_threads(self):
        frames = {}

        def work(name, weights):
            package = Package(EXAMPLE)
            frames[name] = {package.blend(0, weights) for _ in range(50)}
            package.close()

        threads = [threading.Thread(target=work, args=item) for item in
                   (("neutral", [0.0, 0.0]), ("smile", [0.5, 1.0]))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(frames["neutral"]), 1)
        self.assertEqual(len(frames["smile"]), 1)
        self.assertNotEqual(frames["neutral"], frames["smile"])

    def test_blocks_as_files_hold_them(self):
        with tempfile.TemporaryDirectory() as folder:
            packed = pathlib.Path(folder) / "package"
            for format_name, vk, dxgi, block, size in (("bc7", 139, 80, (4, 4), 8), ("astc-6x5", 163, 0, (6, 5), 16)):
                self.run_facezip("convert", EXAMPLE, "--texture-format", format_name, "--output", packed)
                handle = ctypes.c_void_p()
                self.assertEqual(LIB.facezip_open(os.fsencode(packed), ctypes.byref(handle)), 0)
                info = TextureInfo(struct_size=ctypes.sizeof(TextureInfo))
                self.assertEqual(LIB.facezip_get_texture_info(handle, 0, 2, ctypes.byref(info)), 0)
                self.assertEqual(info.format.decode(), {"bc7": "bc4"}.get(format_name, format_name))  # of one channel
                self.assertEqual((info.vk_format, info.dxgi_format), (vk, dxgi))
                self.assertEqual((info.block_width, info.block_height, info.block_bytes), (*block, size))
                self.assertEqual((info.width, info.height, info.levels), (16, 8, 5))
                self.assertGreater(info.scale[0], 0.0)
                file = (packed / "albedo/difference_1.ktx2").read_bytes()
                total = 0
                for level in range(info.levels):
                    begin, length = struct.unpack_from("<QQ", file, 80 + 24 * level)
                    total += length
                    self.assertEqual(LIB.facezip_level_bytes(handle, 0, 2, level), length)
                    blocks = ctypes.create_string_buffer(length)
                    self.assertEqual(LIB.facezip_read_level(handle, 0, 2, level, blocks, length), 0)
                    self.assertEqual(blocks.raw, file[begin:begin + length])
                self.assertEqual(info.bytes, total)
                self.assertEqual(LIB.facezip_level_bytes(handle, 0, 2, 5), 0)
                LIB.facezip_free(handle)

    def test_float_maps(self):
        """Their neutral is an EXR file: OpenImageIO is loaded for it."""
        with tempfile.TemporaryDirectory() as folder:
            capture, packed = pathlib.Path(folder) / "capture", pathlib.Path(folder) / "package"
            self.run_facezip("synth", "--output", capture, "--resolution", "64", "--expressions", "2", "--maps",
                             "displacement")
            for number, image in enumerate(sorted((capture / "displacement").glob("*.png"))):
                values = array.array("f", (0.01 * number * (i % 7) - 0.25 for i in range(64 * 64)))
                image.with_suffix(".pfm").write_bytes(b"Pf\n64 64\n-1.0\n" + values.tobytes())
                image.unlink()
            self.run_facezip("compress", capture, "--output", packed, "--restarts", "2", "--cluster-restarts", "2")
            package = Package(packed)
            self.assertEqual(package.map_info(0).sample_type, 2)
            frame = array.array("f", package.blend(0, [0.0, 0.0]))
            self.assertEqual(len(frame), 64 * 64)
            self.assertTrue(all(-0.5 < value < 0.5 for value in frame))
            package.close()

    @staticmethod
    def run_facezip(*arguments):
        subprocess.run([FACEZIP, "--quiet", *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
