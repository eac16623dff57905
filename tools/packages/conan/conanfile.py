"""conan create tools/packages/conan

The source is the checkout that this folder is in. In a registry, conandata.yml and source() take the place of export_sources."""
import os
import re

from conan import ConanFile
from conan.tools.files import copy, load

required_conan_version = ">=2.0"


class Heatdiff(ConanFile):
    name = "heatdiff"
    description = "Heat kernels, signatures and distances on triangles, polygons and points, without eigenvectors: one C header"
    license = "MIT OR Unlicense"
    topics = ("geometry-processing", "mesh", "heat-kernel", "geodesic-distance", "header-only")
    package_type = "header-library"
    settings = "os", "arch", "compiler", "build_type"
    no_copy_source = True

    @property
    def _top(self):
        return os.path.join(self.recipe_folder, "..", "..", "..")

    def set_version(self):
        header = load(self, os.path.join(self._top, "heatdiff.h"))
        self.version = ".".join(re.findall(r"#define HD_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header))

    def export_sources(self):
        for name in ("heatdiff.h", "LICENSE"):
            copy(self, name, self._top, self.export_sources_folder)

    def package(self):
        copy(self, "heatdiff.h", self.source_folder, os.path.join(self.package_folder, "include"))
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))

    def package_id(self):
        self.info.clear()

    def package_info(self):
        self.cpp_info.bindirs, self.cpp_info.libdirs = [], []
        self.cpp_info.set_property("cmake_file_name", "heatdiff")
        self.cpp_info.set_property("cmake_target_name", "heatdiff::heatdiff")
        self.cpp_info.set_property("pkg_config_name", "heatdiff")
        if self.settings.os in ("Linux", "FreeBSD"):
            self.cpp_info.system_libs = ["m", "pthread"]
