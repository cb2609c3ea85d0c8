"""facezip.hpp includes every public header: umbrella_test.py FOLDER_OF_HEADERS"""

import pathlib
import re
import sys

folder = pathlib.Path(sys.argv[1])
included = set(re.findall(r'#include "facezip/(.*)"', (folder / "facezip.hpp").read_text()))
there = {header.name for header in folder.glob("*.hpp")} - {"facezip.hpp"} | {"version.hpp"}
if included != there:
    sys.exit(f"facezip.hpp and the folder differ: {sorted(included ^ there)}")
