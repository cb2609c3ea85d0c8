"""Makes a source file of the C++ that documents show: snippets.py OUTPUT DOCUMENT...

A function for each block, behind the #include lines of all.
"""

import pathlib
import re
import sys


def blocks_of(document, language):
    return re.findall(rf"^```{language}\n(.*?)^```", pathlib.Path(document).read_text(), re.DOTALL | re.MULTILINE)


def cpp_source(documents):
    includes, functions = [], []
    for document in documents:
        for block in blocks_of(document, "cpp"):
            lines = block.splitlines()
            includes += [line for line in lines if line.startswith("#include")]
            body = "\n".join(line for line in lines if not line.startswith("#include"))
            functions.append(f"void snippet{len(functions)}() {{  // {pathlib.Path(document).name}\n{body}\n}}\n")
    if not functions:
        sys.exit("no document shows C++")
    # Warnings of the project's flags are about what a page leaves out.
    return "\n".join(dict.fromkeys(includes)) + "\n\n" + "\n".join(
        f"void snippet{n}();" for n in range(len(functions))) + "\n\n" + "\n".join(functions)


if __name__ == "__main__":
    pathlib.Path(sys.argv[1]).write_text(cpp_source(sys.argv[2:]))
