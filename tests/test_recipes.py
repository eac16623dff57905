#!/usr/bin/env python3
"""Tests of the recipes in tools/packages, for vcpkg and Conan: test_recipes.py [unittest options]

Where the programs vcpkg (with VCPKG_ROOT) and conan are installed, they install the package and build a consumer. Where they are
not, stand-ins of a few lines run the recipes: CMake functions that do what vcpkg's functions of the same names say they do, and
a Python module with the two things that the Conan recipe takes from conan. These show that every command of a recipe runs, and
that what comes out is found by CMake and works. They cannot show that the real programs agree. Needs CMake and a C compiler. With
HEATDIFF_LIBRARY, a compiled library, the consumers are faster to build."""
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import types
import unittest

sys.dont_write_bytecode = True
TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PACKAGES = os.path.join(TOP, "tools", "packages")
PORT = os.path.join(PACKAGES, "vcpkg", "heatdiff")
CONAN = os.path.join(PACKAGES, "conan")
CC = os.environ.get("CC", "cc")

STANDINS = r"""
# What vcpkg sets before a portfile, and its functions as their documentation has them.
cmake_minimum_required(VERSION 3.15)
set(CURRENT_PACKAGES_DIR ${WORK}/packages)
set(CURRENT_BUILDTREES_DIR ${WORK}/buildtrees)
set(PORT heatdiff)
set(FEATURES core ${WANTED})
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(status)
    message(FATAL_ERROR "${ARGV}: ${said}")
  endif()
endfunction()
function(vcpkg_check_features)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "OUT_FEATURE_OPTIONS" "FEATURES;INVERTED_FEATURES")
  if(arg_UNPARSED_ARGUMENTS OR arg_INVERTED_FEATURES)
    message(FATAL_ERROR "unknown: ${arg_UNPARSED_ARGUMENTS}")
  endif()
  set(options)
  while(arg_FEATURES)
    list(POP_FRONT arg_FEATURES feature option)
    if(feature IN_LIST FEATURES)
      list(APPEND options -D${option}=ON)
    else()
      list(APPEND options -D${option}=OFF)
    endif()
  endwhile()
  set(${arg_OUT_FEATURE_OPTIONS} ${options} PARENT_SCOPE)
endfunction()
function(vcpkg_cmake_configure)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "SOURCE_PATH" "OPTIONS")
  if(arg_UNPARSED_ARGUMENTS OR NOT VCPKG_BUILD_TYPE STREQUAL "release")
    message(FATAL_ERROR "unknown: ${arg_UNPARSED_ARGUMENTS} ${VCPKG_BUILD_TYPE}")
  endif()
  run(${CMAKE_COMMAND} -S ${arg_SOURCE_PATH} -B ${CURRENT_BUILDTREES_DIR} -DCMAKE_INSTALL_PREFIX=${CURRENT_PACKAGES_DIR}
    -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS_RELEASE=-O0 ${arg_OPTIONS})
endfunction()
function(vcpkg_cmake_install)
  run(${CMAKE_COMMAND} --build ${CURRENT_BUILDTREES_DIR} --target install)
endfunction()
function(vcpkg_cmake_config_fixup)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "CONFIG_PATH;PACKAGE_NAME" "")
  file(MAKE_DIRECTORY ${CURRENT_PACKAGES_DIR}/share)
  file(RENAME ${CURRENT_PACKAGES_DIR}/${arg_CONFIG_PATH} ${CURRENT_PACKAGES_DIR}/share/${PORT})
  file(GLOB left ${CURRENT_PACKAGES_DIR}/lib/cmake/*)
  if(left)
    message(FATAL_ERROR "left behind: ${left}")
  endif()
  file(REMOVE_RECURSE ${CURRENT_PACKAGES_DIR}/lib/cmake)
  file(GLOB targets ${CURRENT_PACKAGES_DIR}/share/${PORT}/*-targets.cmake)
  foreach(file ${targets})    # one folder less above it
    file(READ ${file} text)
    string(REPLACE "get_filename_component(_IMPORT_PREFIX \"\${_IMPORT_PREFIX}\" PATH)\nget_filename_component(_IMPORT_PREFIX \"\${_IMPORT_PREFIX}\" PATH)\nget_filename_component(_IMPORT_PREFIX \"\${_IMPORT_PREFIX}\" PATH)"
      "get_filename_component(_IMPORT_PREFIX \"\${_IMPORT_PREFIX}\" PATH)\nget_filename_component(_IMPORT_PREFIX \"\${_IMPORT_PREFIX}\" PATH)" text "${text}")
    file(WRITE ${file} "${text}")
  endforeach()
endfunction()
function(vcpkg_fixup_pkgconfig)
  if(NOT EXISTS ${CURRENT_PACKAGES_DIR}/lib/pkgconfig/heatdiff.pc)
    message(FATAL_ERROR "no .pc file")
  endif()
endfunction()
function(vcpkg_copy_tools)
  cmake_parse_arguments(PARSE_ARGV 0 arg "AUTO_CLEAN" "" "TOOL_NAMES")
  foreach(tool ${arg_TOOL_NAMES})
    file(MAKE_DIRECTORY ${CURRENT_PACKAGES_DIR}/tools/${PORT})
    file(RENAME ${CURRENT_PACKAGES_DIR}/bin/${tool} ${CURRENT_PACKAGES_DIR}/tools/${PORT}/${tool})
  endforeach()
  file(REMOVE_RECURSE ${CURRENT_PACKAGES_DIR}/bin)
endfunction()
function(vcpkg_install_copyright)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "FILE_LIST")
  file(MAKE_DIRECTORY ${CURRENT_PACKAGES_DIR}/share/${PORT})
  configure_file(${arg_FILE_LIST} ${CURRENT_PACKAGES_DIR}/share/${PORT}/copyright COPYONLY)
endfunction()
include(${PORT_FOLDER}/portfile.cmake)
"""


def run(*command, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, **options)
    if done.returncode:
        raise AssertionError("%s\n%s" % (" ".join(command), done.stdout[-4000:]))
    return done.stdout


def read(*path):
    with open(os.path.join(*path), encoding="utf-8") as f:
        return f.read()


def version():
    return ".".join(re.findall(r"^#define HD_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", read(TOP, "heatdiff.h"), re.M))


class Recipe(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = folder.name

    def consumer(self, project, **given):
        """Builds a CMake project that looks for the package, and runs its consumer: with the implementation inside, or with the
        library that is compiled already."""
        out, library = os.path.join(self.work, "consumer"), os.environ.get("HEATDIFF_LIBRARY")
        flags = ["-DCMAKE_C_FLAGS=-DCONSUMER_SHARED", "-DCMAKE_C_STANDARD_LIBRARIES=" + library] if library else []
        run("cmake", "-S", project, "-B", out, *flags, *("-D%s=%s" % x for x in given.items()))
        run("cmake", "--build", out)
        there = {"LD_LIBRARY_PATH": os.path.dirname(library)} if library else {}
        said = run(os.path.join(out, "consumer"), env=dict(os.environ, **there))
        self.assertTrue(said.startswith(version() + " 0."), said)


class Vcpkg(Recipe):
    def test_manifest(self):
        m = json.loads(read(PORT, "vcpkg.json"))
        self.assertLessEqual(set(m), {"name", "version", "description", "license", "dependencies", "features"})
        self.assertEqual((m["name"], m["version"]), (os.path.basename(PORT), version()))
        portfile = read(PORT, "portfile.cmake")
        for name, feature in m["features"].items():
            self.assertRegex(name, r"^[a-z0-9-]+$")
            self.assertTrue(feature["description"])
            self.assertRegex(portfile, r"FEATURES\s+%s\s" % name)
        helpers = {d["name"] for d in m["dependencies"] if d["host"]}
        used = set(re.findall(r"\b(vcpkg_cmake_config_fixup|vcpkg_cmake_\w+)\(", portfile))
        self.assertEqual(helpers, {"vcpkg-cmake-config" if "config" in u and "configure" not in u else "vcpkg-cmake" for u in used})

    def test_port(self):
        if shutil.which("vcpkg"):
            run("vcpkg", "install", "heatdiff", "--overlay-ports=" + os.path.dirname(PORT), "--x-install-root=" + self.work)
            triplet = next(t for t in os.listdir(self.work) if os.path.exists(os.path.join(self.work, t, "include", "heatdiff.h")))
            return self.consumer(os.path.join(TOP, "tests", "consumer"), WAY="package",
                                 CMAKE_PREFIX_PATH=os.path.join(self.work, triplet))
        script = os.path.join(self.work, "standins.cmake")
        with open(script, "w") as f:
            f.write(STANDINS)
        run("cmake", "-DPORT_FOLDER=" + PORT, "-DWORK=" + self.work, "-DWANTED=", "-P", script)
        made = os.path.join(self.work, "packages")
        files = sorted(os.path.relpath(os.path.join(at, n), made) for at, _, names in os.walk(made) for n in names)
        self.assertEqual(files, ["include/heatdiff.h", "lib/pkgconfig/heatdiff.pc", "share/heatdiff/copyright"] + [
            "share/heatdiff/heatdiff-%s.cmake" % x for x in ("config-version", "config", "targets")] + ["share/heatdiff/usage"])
        self.consumer(os.path.join(TOP, "tests", "consumer"), WAY="package", CMAKE_PREFIX_PATH=made)
        usage = read(PORT, "usage")
        for line in ("find_package(heatdiff CONFIG REQUIRED)", "target_link_libraries(main PRIVATE heatdiff::heatdiff)"):
            self.assertIn(line, usage)


class Base:
    """Of the Conan stand-in."""

    def __init__(self, work):
        self.recipe_folder, self.export_sources_folder = CONAN, os.path.join(work, "sources")
        self.source_folder, self.package_folder = self.export_sources_folder, os.path.join(work, "package")
        self.settings = types.SimpleNamespace(os="Linux")
        self.properties = {}
        self.info = types.SimpleNamespace(clear=lambda: None)
        self.cpp_info = types.SimpleNamespace(set_property=self.properties.__setitem__, system_libs=[])


def copy(recipe, pattern, source, target):
    os.makedirs(target, exist_ok=True)
    shutil.copy(os.path.join(source, pattern), target)


class Conan(Recipe):
    def test_recipe(self):
        if shutil.which("conan"):
            env = dict(os.environ, CONAN_HOME=self.work)
            run("conan", "profile", "detect", env=env)
            return self.assertIn(version(), run("conan", "create", CONAN, env=env))
        for name, members in (("conan", {"ConanFile": Base}), ("conan.tools", {}),
                              ("conan.tools.files", {"copy": copy, "load": lambda recipe, path: read(path)}),
                              ("conan.tools.build", {"can_run": None}), ("conan.tools.cmake", {"CMake": None, "cmake_layout": None})):
            module = types.ModuleType(name)
            module.__dict__.update(members)
            sys.modules[name] = module
            self.addCleanup(sys.modules.pop, name)
        recipe = self.loaded("conanfile.py").Heatdiff(self.work)
        recipe.set_version()
        self.assertEqual((recipe.name, recipe.version), ("heatdiff", version()))
        for step in (recipe.export_sources, recipe.package, recipe.package_id, recipe.package_info):
            step()
        made = sorted(os.path.relpath(os.path.join(at, n), recipe.package_folder)
                      for at, _, names in os.walk(recipe.package_folder) for n in names)
        self.assertEqual(made, ["include/heatdiff.h", "licenses/LICENSE"])
        self.assertEqual(recipe.properties["cmake_target_name"], "heatdiff::heatdiff")
        # the generator CMakeDeps in five lines, for the test package
        with open(os.path.join(self.work, "heatdiff-config.cmake"), "w") as f:
            f.write("add_library(%s INTERFACE IMPORTED)\ntarget_include_directories(%s INTERFACE %s/include)\n"
                    "target_link_libraries(%s INTERFACE %s)\n" % (
                        (recipe.properties["cmake_target_name"],) * 2 + (recipe.package_folder, recipe.properties["cmake_target_name"],
                                                                         ";".join(recipe.cpp_info.system_libs))))
        self.consumer(os.path.join(CONAN, "test_package"), heatdiff_DIR=self.work)
        consumer = self.loaded("test_package/conanfile.py").Consumer
        self.assertEqual(consumer.generators, ("CMakeDeps", "CMakeToolchain"))

    def loaded(self, name):
        spec = importlib.util.spec_from_file_location(re.sub(r"\W", "_", name), os.path.join(CONAN, name))
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module


if __name__ == "__main__":
    for client in ("vcpkg", "conan"):
        if not shutil.which(client):
            print("%s is not installed: a stand-in runs its recipe" % client, file=sys.stderr)
    unittest.main()
