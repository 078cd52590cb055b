#!/usr/bin/env python3
"""Copies what a binary needs beside it, so that it runs without any package of the system.

    bundle.py BINARY FOLDER [--notices FOLDER] [--own-names]

FOLDER/lib gets the shared libraries, FOLDER/share/proj the data of PROJ, which PROJ finds from the
place of its library, and the folder of the notices the licences of all of them. The binary then looks
for its libraries in FOLDER/lib, which must stay where it is relative to the binary. The C library
remains that of the system, which must be as new as the one here or newer.

--own-names is for a library that other programs load, as a Python module is: the copies get names of
their own, so that a process may also hold other versions of them. The C++ library, of which a process
should hold one only, then remains that of the system too.

Needs ldd, dpkg and patchelf.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess

# The C library has to fit the system's kernel, name service and loader.
C_LIBRARY = {"libc6"}
CXX_LIBRARY = {"libstdc++6", "libgcc-s1"}
PROJ_DATA = pathlib.Path("/usr/share/proj")


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def package_of(path):
    """The Debian package of a file, of which dpkg may know the name without /usr."""
    real = os.path.realpath(path)
    for name in (real, real.removeprefix("/usr"), str(path)):
        found = subprocess.run(["dpkg", "-S", name], capture_output=True, text=True)
        if found.returncode == 0:
            return found.stdout.split(":")[0]
    raise SystemExit(f"{path} is of no package, so its licence is not known")


def libraries_of(binary):
    """The names and places of all libraries that the binary needs, directly or not."""
    text = output_of("ldd", str(binary))
    missing = re.findall(r"(\S+) => not found", text)
    if missing:
        raise SystemExit(f"{binary} needs {', '.join(missing)}, which is not here")
    return {name: pathlib.Path(path) for name, path in re.findall(r"(\S+) => (/\S+)", text)}


def own_name(name):
    """libproj.so.25 becomes libproj-clearway.so.25."""
    stem, dot, rest = name.partition(".so")
    return f"{stem}-clearway{dot}{rest}"


def copy_libraries(libraries, folder, renamed):
    """Copies the libraries, without any path in which they look for others: they find those beside
    them through the binary's."""
    folder.mkdir(parents=True)
    for name, path in libraries.items():
        copy = folder / renamed.get(name, name)
        shutil.copyfile(path, copy)
        copy.chmod(0o755)
        if re.search(r"\((RPATH|RUNPATH)\)", output_of("readelf", "-d", str(copy))):
            output_of("patchelf", "--remove-rpath", str(copy))
        if renamed:
            output_of("patchelf", "--set-soname", copy.name, str(copy))
            rename_needed(copy, renamed)


def rename_needed(binary, renamed):
    needed = output_of("patchelf", "--print-needed", str(binary)).split()
    edits = [word for name in needed if name in renamed
             for word in ("--replace-needed", name, renamed[name])]
    if edits:
        output_of("patchelf", *edits, str(binary))


def copy_notices(packages, folder):
    folder.mkdir(parents=True, exist_ok=True)
    for package in packages:
        shutil.copyfile(f"/usr/share/doc/{package}/copyright", folder / package)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("binary", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--notices", type=pathlib.Path)
    parser.add_argument("--own-names", action="store_true")
    arguments = parser.parse_args()

    of_system = C_LIBRARY | CXX_LIBRARY if arguments.own_names else C_LIBRARY
    package = {name: package_of(path) for name, path in libraries_of(arguments.binary).items()}
    libraries = {name: path for name, path in libraries_of(arguments.binary).items()
                 if package[name] not in of_system}
    renamed = {name: own_name(name) for name in libraries} if arguments.own_names else {}
    folder = arguments.folder / "lib"
    copy_libraries(libraries, folder, renamed)
    rename_needed(arguments.binary, renamed)
    # The older kind of path (RPATH, not RUNPATH) also holds for what the libraries need in turn.
    path = os.path.relpath(folder, arguments.binary.parent)
    output_of("patchelf", "--force-rpath", "--set-rpath", f"$ORIGIN/{path}", str(arguments.binary))
    shutil.copytree(PROJ_DATA, arguments.folder / "share" / "proj")
    if arguments.notices:
        copy_notices({package[name] for name in libraries} | {"proj-data"}, arguments.notices)


if __name__ == "__main__":
    main()
