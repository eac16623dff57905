#!/usr/bin/env python3
"""Compiles and runs the C code of README.md, as C and as C++: test_readme.py [CC]. What the reader sees is what works."""
import os
import re
import subprocess
import sys
import tempfile

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def main():
    cc = sys.argv[1] if len(sys.argv) > 1 else "cc"
    text = open(os.path.join(TOP, "README.md"), encoding="utf-8").read()
    programs = [b for b in re.findall(r"```c\n(.*?)```", text, re.S) if "int main" in b]
    if not programs:
        sys.exit("README.md holds no program")
    passed = 0
    with tempfile.TemporaryDirectory() as d:
        for code in programs:
            for lang, std in (("c", "c99"), ("c++", "c++11")):
                src, exe = os.path.join(d, "readme." + ("c" if lang == "c" else "cpp")), os.path.join(d, "readme")
                open(src, "w", encoding="utf-8").write(code)
                compiler = [cc] if lang == "c" else [cc, "-x", "c++"]
                subprocess.run(compiler + ["-std=" + std, "-O1", "-Wall", "-Wextra", "-I" + TOP, src, "-o", exe, "-lm"], check=True)
                out = subprocess.run([exe], check=True, stdout=subprocess.PIPE, universal_newlines=True, timeout=60).stdout
                print("%s: %s" % (std, out.strip()))
                passed += 1
    print("%d passed, 0 failed" % passed)


if __name__ == "__main__":
    main()
