"""bench/compare.py as it is called: compare_test.py SCRIPT"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = sys.argv[1]


def kernel_result(rows):
    """rows: {name: [(best_ms, of_copy) of each repetition]}, as Google Benchmark writes them."""
    return {"benchmarks": [{"name": name, "run_name": name, "run_type": "iteration", "real_time": 1.0,
                            "time_unit": "ms", "best_ms": time, "of_copy": share}
                           for name, repetitions in rows.items() for time, share in repetitions]}


class Compare(unittest.TestCase):
    def compare(self, before, after, *options):
        """Exit code, and the words of each row of the table."""
        with tempfile.TemporaryDirectory() as folder:
            files = [pathlib.Path(folder) / name for name in ("before.json", "after.json")]
            for file, result in zip(files, (before, after)):
                file.write_text(result if isinstance(result, str) else json.dumps(result))
            run = subprocess.run([sys.executable, SCRIPT, *map(str, files), *options], capture_output=True, text=True)
            return run, {line.split()[0]: line.split() for line in run.stdout.splitlines() if line}

    def test_differences_beyond_the_noise_have_a_verdict(self):
        before = kernel_result({"slow": [(10, 0.5), (10.2, 0.5)], "fast": [(10, 0.5)], "same": [(10, 0.5)]})
        after = kernel_result({"slow": [(13, 0.38), (13.1, 0.38)], "fast": [(7, 0.7)], "same": [(10.5, 0.48)]})
        run, rows = self.compare(before, after)
        self.assertEqual(run.returncode, 0)
        self.assertEqual(rows["slow"][-1], "slower")
        self.assertEqual(rows["slow"][3], "1.30")
        self.assertEqual(rows["fast"][-1], "faster")
        self.assertEqual(rows["same"][-1], "%")
        self.assertEqual(self.compare(before, after, "--fail")[0].returncode, 1)
        self.assertEqual(self.compare(after, before, "--fail", "--threshold", "0.5")[0].returncode, 0)

    def test_repetitions_that_differ_are_noise(self):
        before = kernel_result({"row": [(10, 0.5), (14, 0.4), (15, 0.4)]})
        after = kernel_result({"row": [(13, 0.38), (13, 0.38), (13, 0.38)]})
        self.assertNotIn("slower", self.compare(before, after)[1]["row"])

    def test_a_machine_that_slowed_down_is_not_a_slower_row(self):
        before = kernel_result({"row": [(10, 0.50)]})
        after = kernel_result({"row": [(20, 0.51)]})  # the roof halved as well
        self.assertNotIn("slower", self.compare(before, after)[1]["row"])

    def test_other_results(self):
        paper = {"benchmark": "paper_pipeline", "rows": {"masks": {"paper_seconds": 2.0, "facezip_seconds": 0.5}}}
        growth = {"benchmark": "growth", "runs": [{"resolution": 512, "expressions": 8, "masks": 53,
                                                   "wall_seconds": 1.0, "seconds": {"masks": 0.2, "tiny": 0.001}}]}
        job = {"median_ratio": 2.0, "repeats": [{"decode_seconds": 1.0, "compress_seconds": 2.0, "ratio": 2.0}]}
        self.assertIn("facezip:", self.compare(paper, paper)[1])
        run, _ = self.compare(growth, growth)
        self.assertIn("R 512, N 8, K 53: masks", run.stdout)
        self.assertNotIn("tiny", run.stdout)
        self.assertIn("compress", self.compare(job, job)[1])

    def test_what_cannot_be_compared_is_an_error(self):
        rows = kernel_result({"row": [(1, 0.5)]})
        for other in ("{}", "no json", json.dumps(kernel_result({"other": [(1, 0.5)]}))):
            run, _ = self.compare(rows, other)
            self.assertEqual(run.returncode, 1)
            self.assertIn("compare.py:", run.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
