#!/usr/bin/env python3
"""examples/embedded on a Cortex-M7 under QEMU against the same program on this machine.

    python3 tests/test_embedded.py [FOLDER]     FOLDER: where to build; default: a temporary one

Looks into the image for malloc and stdio, runs it, and compares the values to 1e-12, relative to each. Status 77: the
compiler, newlib or QEMU is not here."""

import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
HERE = os.path.join(TOP, "examples", "embedded")
ARM = ["arm-none-eabi-gcc", "-mcpu=cortex-m7", "-mthumb", "-mfpu=fpv5-d16", "-mfloat-abi=hard"]
QEMU = ["qemu-system-arm", "-M", "mps2-an500", "-nographic", "-monitor", "none", "-serial", "none",
        "-semihosting-config", "enable=on,target=native", "-kernel"]
SKIP = 77
FORBIDDEN = re.compile(r"^_?_?(malloc|calloc|realloc|free|sbrk|brk|v?s?n?f?i?printf|v?f?scanf|f?puts|f?putc|putchar|fopen|fwrite|"
                       r"fflush|fclose|write|read|open|s[wf]?setup|sinit|sfp|srget|sread|swrite)(_r)?$")
STACK_MOST, STACK_ITERATIONS = 16 << 10, 8 << 10
TOLERANCE = 1e-12

passed = failed = 0


def check(good, text):
    global passed, failed
    passed += bool(good)
    failed += not good
    if not good:
        print("test_embedded.py: " + text)


def run(command, seconds=300):
    return subprocess.run(command, capture_output=True, text=True, timeout=seconds)


def missing(folder):
    for tool in (ARM[0], QEMU[0], "cc"):
        if not shutil.which(tool):
            return tool
    source = os.path.join(folder, "try.c")
    with open(source, "w") as f:
        f.write("#include <math.h>\n#include <string.h>\ndouble f(double x) { return exp(x); }\n")
    return None if run(ARM + ["-c", source, "-o", source + ".o"]).returncode == 0 else "newlib"


def values(text):
    """{'162 vertices by iterations, at the source': value}, and the lines that say what was computed."""
    found, title = {}, ""
    for line in text.splitlines():
        heading = re.match(r"(\d+ vertices .*), in \d+ bytes: done", line)
        value = re.match(r"  (.*?) +-?[\d.]+ bits ([0-9a-f]{16})$", line)
        if heading:
            title = heading.group(1)
        elif value:
            found[title + ", " + value.group(1)] = struct.unpack(">d", bytes.fromhex(value.group(2)))[0]
    return found


def number(text, what):
    found = re.search(what + r" (\d+)", text)
    return int(found.group(1)) if found else -1


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp()
    os.makedirs(folder, exist_ok=True)
    try:
        lacks = missing(folder)
        if lacks:
            print("test_embedded.py: skipped, %s is not here" % lacks)
            return 1 if os.environ.get("HEATDIFF_NO_SKIP") else SKIP
        image, native = os.path.join(folder, "heat.elf"), os.path.join(folder, "heat")
        source = os.path.join(HERE, "heat.c")
        built = run(ARM + ["-Os", "-Wall", "-Werror", "-ffunction-sections", "-fdata-sections", "-nostartfiles", source,
                           os.path.join(HERE, "start.c"), "-T", os.path.join(HERE, "mps2.ld"), "-Wl,--gc-sections", "-o", image, "-lm"])
        check(built.returncode == 0, "the image does not build\n" + built.stderr[:2000])
        built = run(["cc", "-w", "-DHEATDIFF_NO_SIMD", source, "-o", native, "-lm"])
        check(built.returncode == 0, "the program does not build\n" + built.stderr[:2000])
        if failed:
            return 1
        symbols = [line.split()[-1] for line in run(["arm-none-eabi-nm", image]).stdout.splitlines()]
        check("hd_heat_column" in symbols, "the image has no symbols")
        bad = [s for s in symbols if FORBIDDEN.match(s)]
        check(not bad, "the image has " + " ".join(bad))
        there, here = run(QEMU + [image], 120), run([native])
        check(there.returncode == 0, "on the board: status %d\n%s" % (there.returncode, there.stdout + there.stderr))
        check(here.returncode == 0, "here: status %d\n%s" % (here.returncode, here.stdout))
        board = there.stdout + there.stderr      # QEMU prints what comes by semihosting to the latter
        got, want = values(board), values(here.stdout)
        check(len(want) >= 12 and set(got) == set(want), "different values: %s and %s" % (sorted(got), sorted(want)))
        for name in want:
            off = abs(got.get(name, 0) - want[name]) / abs(want[name])
            check(off <= TOLERANCE, "%s: %.17g on the board, %.17g here, off by %.1e" % (name, got.get(name, 0), want[name], off))
        code, stack = number(board, "code and constants"), number(board, "deepest stack")
        check(50000 < code < 250000, "%d bytes of code" % code)
        check(500 < stack <= STACK_MOST, "%d bytes of stack, at most %d" % (stack, STACK_MOST))
        first = number(board, "by iterations, in 131072 bytes: done, peak \\d+, deepest stack until now")
        check(500 < first <= STACK_ITERATIONS, "%d bytes of stack for iterations, at most %d" % (first, STACK_ITERATIONS))
        print("%d bytes of code and constants, %d of stack" % (code, stack))
        print("%d passed, %d failed" % (passed, failed))
        return 1 if failed else 0
    finally:
        if len(sys.argv) < 2:
            shutil.rmtree(folder)


if __name__ == "__main__":
    sys.exit(main())
