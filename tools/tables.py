#!/usr/bin/env python3
"""Pole sets in heatdiff.h are checked anew when their table or the script that computes them has changed since the last check.

    tables.py       nothing to do in a fraction of a second; else SCRIPT --check, a minute, and the line to put in below

The table is the text between the markers of its script."""
import hashlib
import os
import subprocess
import sys

CHECKED = {     # sha256 of script and table
    "poles.py": "2bdf0e3becf82ed93843d82556e237ddaa0b1d9d04f5d0df6af63263d6a6700e",
    "shared_poles.py": "21c7559b1b387ef3f5e32151f92563e684b2d3b4c4a6e53ad30add1ea1c5d647",
}
TOOLS = os.path.dirname(os.path.abspath(__file__))


def fingerprint(script):
    with open(os.path.join(TOOLS, script), encoding="utf-8") as f:
        code = f.read()
    with open(os.path.join(TOOLS, os.pardir, "heatdiff.h"), encoding="utf-8") as f:
        _, found, rest = f.read().partition("/* %s: begin */" % script)
    table, closed, _ = rest.partition("/* %s: end */" % script)
    if not found or not closed:
        sys.exit("tables.py: heatdiff.h has no table of %s" % script)
    return hashlib.sha256((code + table).encode()).hexdigest()


def main():
    changed = [s for s in CHECKED if fingerprint(s) != CHECKED[s]]
    for script in changed:
        print("%s or its table has changed: %s --check" % (script, script), flush=True)
        if subprocess.run([sys.executable, os.path.join(TOOLS, script), "--check"]).returncode:
            sys.exit("%s: the check failed" % script)
    for script in changed:
        print('The check passed. In tools/tables.py:    "%s": "%s",' % (script, fingerprint(script)))
    if not changed:
        print("%d tables and their scripts are as they were when they were checked" % len(CHECKED))
    sys.exit(bool(changed))


if __name__ == "__main__":
    main()
