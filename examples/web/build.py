#!/usr/bin/env python3
"""Makes the page: build.py [FOLDER]. Writes heatdiff.html and heatdiff.wasm to FOLDER (build-web by default).

Needs clang with the target wasm32-wasi, wasm-ld and wasi-libc (Debian: clang lld wasi-libc
libclang-rt-14-dev-wasm32), and takes wasm-opt (Debian: binaryen) if it is there. The page is one file and needs
neither a server nor a network.
"""
import base64
import os
import re
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
COMPILE = ["--target=wasm32-wasi", "-std=c99", "-Oz", "-msimd128", "-mbulk-memory", "-DNDEBUG",
           "-D_WASI_EMULATED_SIGNAL", "-D_WASI_EMULATED_PROCESS_CLOCKS", "-D_WASI_EMULATED_GETPID",
           "-Wall", "-Wextra", "-Wno-unused-function",
           # 6 % of the module: small functions stay calls, and loops keep their plain counters. Times of
           # test_web.py --large in node change by no more than from run to run.
           "-mllvm", "-inline-threshold=-50", "-mllvm", "-disable-lsr"]
# What the page does not use. Its plans are direct or krylov, its distances come from columns and signatures, and its
# surfaces hold no vertices.
SWITCHES = ["-DHEATDIFF_NO_ITERATIVE", "-DHEATDIFF_NO_DIFFUSION", "-DHEATDIFF_NO_SPECTRUM"]
# Compiled and linked in two steps, without -O on the link: there clang would run wasm-opt, which lacks the features.
LINK = ["--target=wasm32-wasi", "-mexec-model=reactor", "-Wl,--gc-sections", "-Wl,--strip-all",
        "-Wl,-z,stack-size=1048576", "-Wl,--global-base=1024"]
# Nothing is at addresses below 1024, so that small offsets may go into loads.
OPTIMISE = ["wasm-opt", "--enable-simd", "--enable-bulk-memory", "--low-memory-unused", "-Oz", "--converge"]


def module(folder, source=os.path.join(HERE, "web.c"), switches=SWITCHES):
    clang = os.environ.get("CLANG", "clang")
    obj, wasm = os.path.join(folder, "module.o"), os.path.join(folder, "heatdiff.wasm")
    subprocess.run([clang] + COMPILE + switches + ["-c", source, "-o", obj], check=True)
    subprocess.run([clang] + LINK + [obj, "-o", wasm], check=True)
    os.remove(obj)
    if shutil.which("wasm-opt"):
        subprocess.run(OPTIMISE + [wasm, "-o", wasm], check=True)
    return wasm


def read(path):
    with open(path, "rb") as f:
        return f.read()


def page(folder, wasm):
    parts = {"module": base64.b64encode(read(wasm)).decode()}
    for name in ("page.css", "worker.js", "view.js", "page.js"):
        parts[name] = read(os.path.join(HERE, name)).decode()
    html = read(os.path.join(HERE, "page.html")).decode()
    html = re.sub(r"/\*@([\w.]+)\*/", lambda m: parts[m.group(1)], html)
    path = os.path.join(folder, "heatdiff.html")
    with open(path, "w", encoding="utf-8") as f:
        f.write(html)
    return path


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else "build-web"
    os.makedirs(folder, exist_ok=True)
    wasm = module(folder)
    path = page(folder, wasm)
    for file in (wasm, path):
        print("%s: %.0f KB" % (file, os.path.getsize(file) / 1000))


if __name__ == "__main__":
    main()
