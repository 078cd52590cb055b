#!/usr/bin/env python3
"""Lists the code for GPUs in a binary, as `cuobjdump --list-elf --list-ptx` does, without CUDA's tools:

    gpu_code.py BINARY

prints a line such as `sm_90.cubin` for machine code and `sm_120.ptx` for PTX, followed by the number of
kernel sources that have it. A binary without CUDA gives nothing. Needs readelf and objcopy.
"""
import collections
import pathlib
import struct
import subprocess
import sys
import tempfile

# A fat binary is a header and entries, each with a header of its own: kind, size, architecture.
MAGIC = 0xBA55ED50
KINDS = {1: "ptx", 2: "cubin"}


def section_of(binary):
    """The bytes of the section that holds the fat binaries; empty where there is none."""
    headers = subprocess.run(["readelf", "-SW", binary], check=True, capture_output=True, text=True)
    if ".nv_fatbin" not in headers.stdout:
        return b""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "section"
        subprocess.run(["objcopy", "-O", "binary", "--only-section=.nv_fatbin",
                        "--set-section-flags", ".nv_fatbin=alloc", binary, str(out)], check=True)
        return out.read_bytes()


def entries_of(data):
    """The kind and the architecture of every entry of all fat binaries of a section."""
    at = 0
    while at + 16 <= len(data):
        magic, _, header, size = struct.unpack_from("<IHHQ", data, at)
        if magic != MAGIC:
            at += 8
            continue
        entry, end = at + header, at + header + size
        while entry < end:
            kind, _, entry_header, payload = struct.unpack_from("<HHIQ", data, entry)
            architecture, = struct.unpack_from("<I", data, entry + 28)
            yield f"sm_{architecture}.{KINDS.get(kind, kind)}"
            entry += entry_header + payload
        at = end


def main():
    if len(sys.argv) != 2:
        raise SystemExit("usage: gpu_code.py BINARY")
    for name, sources in sorted(collections.Counter(entries_of(section_of(sys.argv[1]))).items()):
        print(name, sources)


if __name__ == "__main__":
    main()
