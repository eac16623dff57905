"""Compiles heatdiff.h into a shared library beside the Python files. ctypes loads it, so one wheel serves every Python:
py3-none-PLATFORM. CC and CFLAGS are obeyed; compiling takes some 20 seconds."""
import os
import re
import shutil

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from setuptools.command.sdist import sdist

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:                                             # before setuptools 70.1
    from wheel.bdist_wheel import bdist_wheel

HERE = os.path.dirname(os.path.abspath(__file__))
FOLDERS = [HERE, os.path.join(HERE, "..", "..")]                # in a source archive, and in the repository
TOP = next(d for d in FOLDERS if os.path.exists(os.path.join(d, "heatdiff.h")))


class Build(build_ext):
    """No module of Python: its name says nothing of a version, and it links with nothing of Python."""

    def get_ext_filename(self, name):
        return os.path.join(*name.split(".")) + (".dll" if os.name == "nt" else ".so")

    def get_export_symbols(self, ext):
        return []

    def get_libraries(self, ext):
        return ext.libraries


class Wheel(bdist_wheel):
    def get_tag(self):
        return ("py3", "none", super().get_tag()[2])


class Source(sdist):
    def make_release_tree(self, folder, files):
        super().make_release_tree(folder, files)
        for name in ("heatdiff.h", "LICENSE"):
            shutil.copyfile(os.path.join(TOP, name), os.path.join(folder, name))


with open(os.path.join(TOP, "heatdiff.h"), encoding="utf-8") as f:
    version = ".".join(re.findall(r"^#define HD_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", f.read(), re.M))
unix = os.name != "nt"
setup(version=version, cmdclass={"build_ext": Build, "bdist_wheel": Wheel, "sdist": Source}, ext_modules=[Extension(
    "heatdiff.libheatdiff", ["heatdiff.c"], include_dirs=[TOP], depends=[os.path.join(TOP, "heatdiff.h")],
    extra_compile_args=["-O2", "-g0", "-std=gnu99"] + os.environ.get("CFLAGS", "").split() if unix else [],
    libraries=["m"] if unix else [])])
