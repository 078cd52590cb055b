#!/usr/bin/env python3
"""Makes a wheel of a folder that holds the package `clearway` with its module and libraries.

    wheel.py FOLDER --version VERSION --numpy RANGE --licence FILE -o FOLDER

It is for the version of Python that runs this script, and for systems whose C library is as new as the
one here or newer. The last line printed is the wheel's name. Nothing is downloaded.
"""
import argparse
import base64
import hashlib
import os
import pathlib
import platform
import sys
import zipfile

SUMMARY = "Collisions of moving models with point clouds, found exactly"


def tags():
    """The interpreter and the system that the module was built for."""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    library = os.confstr("CS_GNU_LIBC_VERSION").split()[1].replace(".", "_")
    return f"{python}-{python}-manylinux_{library}_{platform.machine()}"


def texts(arguments):
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    return {
        "METADATA": f"""\
Metadata-Version: 2.1
Name: clearway
Version: {arguments.version}
Summary: {SUMMARY}
License: Apache-2.0
License-File: LICENSE
Requires-Python: =={python}.*
Requires-Dist: numpy {arguments.numpy}
""",
        "WHEEL": f"""\
Wheel-Version: 1.0
Generator: clearway
Root-Is-Purelib: false
Tag: {tags()}
""",
        "LICENSE": arguments.licence.read_text(),
    }


def write_wheel(arguments, path):
    info = f"clearway-{arguments.version}.dist-info"
    record = ""  # a line for each file: its name, hash and size
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as wheel:

        def add(name, data):
            nonlocal record
            entry = zipfile.ZipInfo(name)
            entry.external_attr = (0o100755 if ".so" in name.rpartition("/")[2] else 0o100644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, data)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record += f"{name},sha256={digest},{len(data)}\n"

        for file in sorted(arguments.folder.rglob("*")):
            if file.is_file() and "__pycache__" not in file.parts:
                add(file.relative_to(arguments.folder).as_posix(), file.read_bytes())
        for name, text in texts(arguments).items():
            add(f"{info}/{name}", text.encode())
        add(f"{info}/RECORD", f"{record}{info}/RECORD,,\n".encode())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--version", required=True)
    parser.add_argument("--numpy", required=True, help="the versions of NumPy, as >=1.20")
    parser.add_argument("--licence", type=pathlib.Path, required=True)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    path = arguments.output / f"clearway-{arguments.version}-{tags()}.whl"
    write_wheel(arguments, path)
    print(path)


if __name__ == "__main__":
    main()
