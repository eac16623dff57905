#!/usr/bin/env python3
"""Small faults put into heatdiff.h one at a time: how many of them do the tests find?

    mutate.py [--count N] [--seed S] [--room NUMBER] [--seconds S] [--map FILE] [--keep FOLDER]
    mutate.py --line NUMBER        every fault of one line

Faults are drawn with the same share of the lines of every room: another sign, comparison, operator, index, constant,
conjugate, minimum for maximum, a condition turned round, a statement left out. Only lines that tests run are drawn
(coverage.py lists the others). A fault that leaves the compiled code as it was does not count. One that does not compile
does not count either. The groups that run the line are run, the quickest first, until one fails, crashes, or takes ten
times as long as without the fault. A line for each fault:

    caught by GROUP, or SURVIVED    line, room, what was done, the line as it is now

--map is the file of `coverage.py --map`, made first if it is not given. Exit 1 when fewer than --least per cent are caught.
Needs gcc and Python 3."""
import argparse
import collections
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import house  # noqa: E402

TOP = house.TOP
OPERAND = r"(?<=[\w\])])"
FAULTS = [   # name, what is looked for, what stands there instead
    ("sign", re.compile(OPERAND + r" \+ "), " - "),
    ("sign", re.compile(OPERAND + r" - "), " + "),
    ("sign", re.compile(r" \+= "), " -= "),
    ("sign", re.compile(r" -= "), " += "),
    ("sign", re.compile(r"(?<=[=(,?:] )-(?=[a-zA-Z(])"), ""),
    ("sign", re.compile(r"(?<=return )-(?=[a-zA-Z(])"), ""),
    ("operator", re.compile(OPERAND + r" \* (?=[\w(])"), " / "),
    ("operator", re.compile(OPERAND + r" / (?=[\w(])"), " * "),
    ("comparison", re.compile(r" < "), " <= "),
    ("comparison", re.compile(r" <= "), " < "),
    ("comparison", re.compile(r" > "), " >= "),
    ("comparison", re.compile(r" >= "), " > "),
    ("comparison", re.compile(r" == "), " != "),
    ("comparison", re.compile(r" != "), " == "),
    ("logic", re.compile(r" && "), " || "),
    ("logic", re.compile(r" \|\| "), " && "),
    ("logic", re.compile(r"(?<=[( ])!(?=[a-zA-Z(])"), ""),
    ("index", re.compile(r"(?<=[a-z])\[(i|j|k|p|q|r|c|v|f|n)\]"), r"[\1 + 1]"),
    ("index", re.compile(r" \+ 1\]"), "]"),
    ("constant", re.compile(r"(?<![\w.\"])([2-9]|[1-9]\d+)(?![\w.\]])"), lambda m: str(int(m.group(1)) + 1)),
    ("constant", re.compile(r"(?<![\w.])0\.(\d+)(?![\w.])"), r"0.9\1"),
    ("constant", re.compile(r"(?<![\w.])1e-(\d+)"), lambda m: "1e-%d" % max(0, int(m.group(1)) - 2)),
    ("conjugate", re.compile(r"\.im\b(?! [-+*/]?=)"), ".re"),
    ("conjugate", re.compile(r"\.re\b(?! [-+*/]?=)"), ".im"),
    ("extreme", re.compile(r"\bhdi_min\("), "hdi_max("),
    ("extreme", re.compile(r"\bhdi_max\("), "hdi_min("),
    ("extreme", re.compile(r"\bhdi_(low|high)32\("), lambda m: "hdi_%s32(" % ("high" if m.group(1) == "low" else "low")),
    ("statement", re.compile(r"^\s+(?!return|break|continue|const|static|else|case|goto)\w[^;{}]*[\])\w] [-+*/]?= [^;{}]*;$"), ";"),
    ("statement", re.compile(r"^\s+(?:\(void\))?hdi_\w+\([^;{}]*\);$"), ";"),
    ("statement", re.compile(r"^\s+\w+(?:->|\.)?\w*(?:\+\+|--);$"), ";"),
]
DECLARES = re.compile(r"^\s*(?:const |static |unsigned )*(?:double|float|int|u?int\d+_t|size_t|char|hd_\w+|hdi_\w+) [*\w]")

Fault = collections.namedtuple("Fault", "line kind text")


def faults_of(h, n):
    """Every fault of a line."""
    code, raw = h.code.split("\n")[n - 1].rstrip(), h.raw[n - 1]
    found = []
    if '"' in code or code.lstrip().startswith("#"):
        return found
    for kind, pattern, new in FAULTS:
        if kind == "statement" and DECLARES.match(code):
            continue
        for m in pattern.finditer(code):
            changed = code[:m.start()] + m.expand(new) + code[m.end():] if isinstance(new, str) else \
                code[:m.start()] + new(m) + code[m.end():]
            if changed != raw:
                found.append(Fault(n, kind, changed))
    return found


def draw(h, lines, count, seed):
    """Faults of lines of every room in proportion, no two of one line."""
    rng = random.Random(seed)
    rooms = collections.defaultdict(list)
    for n in lines:
        rooms[h.room_of(n)].append(n)
    drawn, whole = [], sum(len(v) for v in rooms.values())
    for room in sorted(rooms):
        rng.shuffle(rooms[room])
        share, got = max(1, round(count * len(rooms[room]) / whole)), 0
        for n in rooms[room]:
            choice = faults_of(h, n)
            if choice and got < share:
                drawn.append(rng.choice(choice))
                got += 1
    rng.shuffle(drawn)
    return drawn


class Bench:
    """A copy of the tree whose header is changed."""

    def __init__(self, folder, raw):
        self.folder, self.raw = folder, raw
        for name in ("tests", "tools", "examples"):
            shutil.copytree(os.path.join(TOP, name), os.path.join(folder, name))
        self.put(raw)
        self.plain = {name: self.compile(name) for name in ("runner", "internals")}

    def put(self, raw):
        with open(os.path.join(self.folder, "heatdiff.h"), "w", encoding="utf-8") as f:
            f.write("\n".join(raw))

    def compile(self, name):
        """Links tests/name.c; the bytes of its object, or None."""
        out = os.path.join(self.folder, name)
        if subprocess.run(["gcc", "-O1", "-w", "-c", "tests/%s.c" % name, "-I.", "-o", name + ".o"], cwd=self.folder,
                          stderr=subprocess.DEVNULL).returncode:
            return None
        subprocess.run(["gcc", name + ".o", "-o", out, "-lm"], cwd=self.folder, check=True)
        with open(out + ".o", "rb") as f:
            return f.read()

    def fails(self, group, seconds):
        """Whether a group notices."""
        command = ["./internals"] if group == "internals" else ["./runner", group]
        try:
            return subprocess.run(["bash", "-c", "ulimit -v 12000000; exec " + " ".join(command)], cwd=self.folder,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                  timeout=20 + 10 * seconds).returncode != 0
        except subprocess.TimeoutExpired:
            return True

    def try_fault(self, fault, groups, seconds):
        """'same', 'broken', the name of the group that finds it, or None."""
        raw = list(self.raw)
        raw[fault.line - 1] = fault.text
        self.put(raw)
        code = self.compile("runner")
        if code is None:
            return "broken"
        if code == self.plain["runner"]:
            return "same"
        for group in sorted(groups, key=lambda g: seconds[g]):
            if group == "internals" and self.compile("internals") is None:
                return "internals"
            if self.fails(group, seconds[group]):
                return group
        return None


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=1e9)
    parser.add_argument("--room")
    parser.add_argument("--line", type=int)
    parser.add_argument("--map")
    parser.add_argument("--least", type=float, default=0)
    o = parser.parse_args()
    begin = time.time()
    with open(os.path.join(TOP, "heatdiff.h"), encoding="utf-8") as f:
        h = house.House(f.read())
    with tempfile.TemporaryDirectory() as folder:
        if not o.map:
            o.map = os.path.join(folder, "map.json")
            subprocess.run([sys.executable, os.path.join(TOP, "tools", "coverage.py"), "--map", o.map], check=True)
        with open(o.map, encoding="utf-8") as f:
            known = json.load(f)
        by = {int(n): groups for n, groups in known["lines"].items()}
        lines = [n for n in sorted(by) if n > h.border and (not o.room or h.room_of(n) == "[%s]" % o.room)]
        faults = faults_of(h, o.line) if o.line else draw(h, lines, o.count, o.seed)
        bench = Bench(os.path.join(folder), h.raw)
        caught, all_of = collections.Counter(), collections.Counter()
        for fault in faults:
            if time.time() - begin > o.seconds:
                break
            found = bench.try_fault(fault, by.get(fault.line, []), known["seconds"])
            if found in ("same", "broken"):
                continue
            all_of[fault.kind] += 1
            caught[fault.kind] += found is not None
            print("%-18s %6d %s %-10s %s" % ("caught by " + found if found else "SURVIVED", fault.line,
                                             h.room_of(fault.line), fault.kind, fault.text.strip()), flush=True)
            if not found:
                print("%18s %6s %s" % ("", "was", h.raw[fault.line - 1].strip()), flush=True)
    whole, good = sum(all_of.values()), sum(caught.values())
    for kind in sorted(all_of):
        print("%-12s %4d of %4d" % (kind, caught[kind], all_of[kind]))
    print("%d faults, %d caught, %.1f%%" % (whole, good, 100.0 * good / max(1, whole)))
    sys.exit(100.0 * good < o.least * whole)


main()
