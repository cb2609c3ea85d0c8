"""What the scripts about people whom a model has not seen share: running facezip, reading meshes, one measure of error."""
import subprocess

import numpy as np


def run(*command):
    """Runs a command and returns what it printed; one that fails ends the script with its message."""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, command))}\n{done.stderr}")
    return done.stdout


def vertices(path):
    """Positions of an OBJ file, #V by 3."""
    return np.array([line.split()[1:4] for line in open(path) if line.startswith("v ")], np.float64)


def rms(vectors):
    """Root mean square length."""
    return np.sqrt((vectors ** 2).sum(-1).mean())
