#!/usr/bin/env python3
"""build.py - makes the zip of the add-on, which Blender 3.4 and later install from a file

    build.py [-o FOLDER] [--library FILE] [--platform NAME]
    CC=x86_64-w64-mingw32-gcc build.py --platform windows-x64

Copies the Python package of examples/python into the add-on and compiles heatdiff.h beside it (CC and CFLAGS are obeyed; some
20 seconds). --library takes a shared library that is there already. --platform is Blender's name of the system that the library
is for: linux-x64, windows-x64, macos-arm64 ..."""
import argparse
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))
TOP = os.path.join(HERE, "..", "..")
PACKAGE = os.path.join(HERE, "..", "python", "src", "heatdiff")
NAME = "heat_on_meshes"
SUFFIX = {"linux": ".so", "macos": ".dylib", "windows": ".dll"}


def read(path):
    with open(path, encoding="utf-8") as f:
        return f.read()


def version():
    return re.findall(r"^#define HD_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", read(os.path.join(TOP, "heatdiff.h")), re.M)


def this_platform():
    system = {"Darwin": "macos"}.get(platform.system(), platform.system().lower())
    machine = {"x86_64": "x64", "amd64": "x64", "aarch64": "arm64"}.get(platform.machine().lower(), platform.machine().lower())
    return system + "-" + machine


def compiled(out):
    source = os.path.join(HERE, "..", "python", "heatdiff.c")
    flags = ["-O2", "-shared"] + ([] if os.name == "nt" else ["-fPIC"]) + os.environ.get("CFLAGS", "").split()
    command = [os.environ.get("CC", "cc"), *flags, "-I" + TOP, source, "-o", out] + ([] if os.name == "nt" else ["-lm", "-lpthread"])
    subprocess.run(command, check=True)


def folder(into, library=None, where=None):
    """Lays the add-on into the folder `into`, and returns its path."""
    where = where or this_platform()
    out = os.path.join(into, NAME)
    quiet = shutil.ignore_patterns("__pycache__", "libheatdiff.*")
    shutil.copytree(os.path.join(HERE, NAME), out, ignore=quiet)
    shutil.copytree(PACKAGE, os.path.join(out, "heatdiff"), ignore=quiet)
    shutil.copyfile(os.path.join(TOP, "LICENSE"), os.path.join(out, "LICENSE"))
    beside = os.path.join(out, "heatdiff", "libheatdiff" + SUFFIX[where.split("-")[0]])
    if library:
        shutil.copyfile(library, beside)
    else:
        compiled(beside)
    manifest, first = os.path.join(out, "blender_manifest.toml"), os.path.join(out, "__init__.py")
    for path, before, after in ((manifest, 'version = "0.0.0"', 'version = "%s"' % ".".join(version())),
                                (manifest, "platforms = []", 'platforms = ["%s"]' % where),
                                (first, "(0, 0, 0)", "(%s)" % ", ".join(version()))):
        text = read(path)
        assert before in text
        with open(path, "w", encoding="utf-8") as f:
            f.write(text.replace(before, after))
    return out


def packed(into, library=None, where=None):
    """Writes the zip into the folder `into`, and returns its path. One folder inside serves old and new versions of Blender."""
    where = where or this_platform()
    path = os.path.join(into, "%s-%s-%s.zip" % (NAME, ".".join(version()), where.replace("-", "_")))
    with tempfile.TemporaryDirectory() as work, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as z:
        for at, _, names in sorted(os.walk(folder(work, library, where))):
            for name in sorted(names):
                z.write(os.path.join(at, name), os.path.relpath(os.path.join(at, name), work))
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", default=".", metavar="FOLDER")
    parser.add_argument("--library", metavar="FILE")
    parser.add_argument("--platform", metavar="NAME", default=this_platform())
    args = parser.parse_args()
    if args.platform.split("-")[0] not in SUFFIX:
        sys.exit("there is no platform %s: they are called linux-x64, windows-x64, macos-arm64 ..." % args.platform)
    print(packed(args.o, args.library, args.platform))


if __name__ == "__main__":
    main()
