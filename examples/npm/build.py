#!/usr/bin/env python3
"""Makes what the package has besides the files here: heatdiff.wasm, the same inside inline.js, and LICENSE.

`npm pack` calls it. It needs what examples/web/build.py needs: clang with the target wasm32-wasi, wasm-ld, wasi-libc.
"""
import base64
import os
import shutil
import sys

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "web"))
import build  # noqa: E402

SWITCHES = ["-DHEATDIFF_NO_POLYGONS"]       # everything else that core.js can ask for


def main():
    wasm = build.module(HERE, os.path.join(HERE, "module.c"), SWITCHES)
    with open(os.path.join(HERE, "inline.js"), "w") as f:
        f.write("// heatdiff.wasm in base64\nexport default \"%s\";\n" % base64.b64encode(build.read(wasm)).decode())
    shutil.copy(os.path.join(HERE, "..", "..", "LICENSE"), HERE)


if __name__ == "__main__":
    main()
