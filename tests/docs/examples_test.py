"""Runs the commands that documents show, as they stand there, on the built-in capture.

    examples_test.py REPOSITORY FACEZIP RUNTIME_LIBRARY PROGRAMS WORK

A document is a session in a folder of its own: its lines that start with four blanks and "facezip". What commands need is
made by those above them. To save time, a wrapper makes the built-in capture small and lets searches start less often; it
changes nothing that is printed. `view` is ended when it serves. Programs of docs/examples, built in PROGRAMS, run where README's session left a
capture and a package; READMEs of exports where they were written, and Blender's where Blender is.
"""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys

WRAPPER = """#!/bin/sh
# Less work, and no other output.
case $1 in
  synth) exec "$FACEZIP" "$@" --resolution 128 --expressions 12 ;;
  compress | rig | generate) exec "$FACEZIP" "$@" --restarts 2 --cluster-restarts 2 ;;
  view) exec "$FACEZIP" "$@" --port 0 ;;
esac
exec "$FACEZIP" "$@"
"""


def commands_of(text):
    """Shell lines of a document, comments included: the shell knows them."""
    return [line[4:] for line in text.splitlines() if re.match(r"    (facezip|blender) ", line)]


def run(command, folder, environment):
    if command.startswith("facezip view"):
        run_until_served(command, folder, environment)
        return
    done = subprocess.run(["bash", "-c", command], cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{folder.name}: {command}\n{done.stdout}{done.stderr}exit code {done.returncode}")


def run_until_served(command, folder, environment):
    with subprocess.Popen(["bash", "-c", "exec " + command], cwd=folder, env=environment, stdout=subprocess.PIPE,
                          text=True) as server:
        line = server.stdout.readline()
        server.send_signal(signal.SIGINT)
    if not line.startswith("Look at http://127.0.0.1:"):
        sys.exit(f"{folder.name}: {command}\nserved nothing: {line}")


def run_session(document, name, work, environment):
    commands = commands_of(document.read_text())
    if not commands:
        return 0
    folder = work / name
    folder.mkdir()
    for command in commands:
        run(command, folder, environment)
    return len(commands)


def run_exports(package, repository, work, environment):
    count = 0
    for target in sorted(p.stem for p in (repository / "host" / "export").glob("*.md")):
        folder = work / f"export_{target}"
        run(f"facezip export {package} --target {target} --output {folder}", work, environment)
        for command in commands_of((folder / "README.md").read_text()):
            if command.startswith("blender") and shutil.which("blender") is None:
                continue
            run(command, folder, environment)
            count += 1
    return count


def run_programs(session, repository, runtime, programs, environment):
    """Of docs/examples: the frames of C and of Python must be the same."""
    weights = ["smile_open=0.7", "jaw_open_wide=0.2"]
    call = {"cwd": session, "check": True}
    subprocess.run([programs / "compress_capture", "capture", "small.facezip", "0.1"], env=environment, **call)
    subprocess.run([programs / "blend_frame", "face.facezip", "c.ppm", *weights], env=environment, **call)
    # A sanitized library cannot be loaded by a Python that is not.
    if "FACEZIP_SANITIZED" in environment:
        return
    libraries = {**environment, "LD_LIBRARY_PATH": str(runtime.parent)}
    program = repository / "docs" / "examples" / "blend_frame.py"
    subprocess.run([sys.executable, program, "face.facezip", "python.ppm", *weights], env=libraries, **call)
    if (session / "c.ppm").read_bytes() != (session / "python.ppm").read_bytes():
        sys.exit("blend_frame.c and blend_frame.py differ")


def main():
    repository, facezip, runtime, programs, work = (pathlib.Path(argument) for argument in sys.argv[1:])
    shutil.rmtree(work, ignore_errors=True)
    (work / "bin").mkdir(parents=True)
    wrapper = work / "bin" / "facezip"
    wrapper.write_text(WRAPPER)
    wrapper.chmod(0o755)
    environment = {**os.environ, "FACEZIP": str(facezip), "PATH": f"{work / 'bin'}:{os.environ['PATH']}"}
    counts = {}
    for document in [repository / "README.md", *sorted((repository / "docs").glob("*.md"))]:
        counts[document.name] = run_session(document, document.stem, work, environment)
    for document in ("README.md", "rig.md", "command_line.md"):
        if counts[document] == 0:
            sys.exit(f"{document} shows no commands")
    package = work / "README" / "face.facezip"
    counts["exports"] = run_exports(package, repository, work, environment)
    run_programs(package.parent, repository, runtime, programs, environment)
    print(", ".join(f"{name}: {count}" for name, count in counts.items() if count))


if __name__ == "__main__":
    main()
