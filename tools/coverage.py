#!/usr/bin/env python3
"""Which lines and branches of heatdiff.h the tests run, by room.

    coverage.py                    a table of rooms; every group of tests/runner.c, and tests/internals.c
    coverage.py --groups NAME,...  only these groups (internals is one)
    coverage.py --list             every line that no test runs, under its function
    coverage.py --branches         every branch that is never taken (lines that do run)
    coverage.py --map FILE         also writes which group runs which line, as JSON, for mutate.py
    coverage.py --check LINES BRANCHES   exit 1 below so many per cent

Needs gcc with its gcov, nothing else. A line stands for all its copies (the kernels are compiled once for each
instruction set). Branches are gcov's: two for every condition that the compiler makes a jump of, && and || included.
A function that is always inlined is compiled once here, so that its conditions count once and not once a call, and
assertions are left out, as none may fail. Where copies differ in their branches, those of the longest count alone.
Lines that only an allocation that fails, or another machine, could reach count like all others."""
import argparse
import collections
import json
import os
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import house  # noqa: E402

TOP = house.TOP
PLAIN = ["-Dalways_inline=unused", "-DNDEBUG"]      # system headers write __always_inline__ and are not meant
PROGRAMS = (("runner", "tests/runner.c"), ("internals", "tests/internals.c"))


def build(folder):
    """The programs with counters, each in a folder of its own, where its counters go."""
    made = {}
    for name, source in PROGRAMS:
        at = os.path.join(folder, name)
        os.mkdir(at)
        subprocess.run(["gcc", "-O0", "-w", "--coverage"] + PLAIN + ["-I" + TOP, os.path.join(TOP, source), "-o", "program", "-lm"],
                       cwd=at, check=True)
        made[name] = at
    return made


def read_counts(at):
    """{line: count} and {line: [count of each branch]} of heatdiff.h from the counters in a folder."""
    notes = [f for f in os.listdir(at) if f.endswith(".gcda")]
    lines, branches = collections.Counter(), {}
    for note in notes:
        out = subprocess.run(["gcov", "--json-format", "--stdout", "--branch-probabilities", note], cwd=at,
                             stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True).stdout
        for document in out.splitlines():
            for source in json.loads(document)["files"]:
                if os.path.basename(source["file"]) != "heatdiff.h":
                    continue
                for line in source["lines"]:
                    number = line["line_number"]
                    lines[number] += line["count"]
                    counts = [b["count"] for b in line["branches"]]
                    there = branches.get(number)
                    if there is None or len(there) != len(counts):   # of unlike copies the one with more branches
                        if there is None or len(counts) > len(there):
                            branches[number] = counts
                    else:
                        branches[number] = [a + b for a, b in zip(there, counts)]
        os.remove(os.path.join(at, note))
    return lines, branches


def add_branches(total, more):
    for line, counts in more.items():
        there = total.get(line)
        total[line] = counts if there is None or len(there) != len(counts) else [a + b for a, b in zip(there, counts)]


def run(made, wanted):
    """Runs the groups one by one: counts, branches, {line: groups that run it}, {group: seconds}."""
    names = subprocess.run([os.path.join(made["runner"], "program"), "--list"], stdout=subprocess.PIPE, text=True,
                           check=True).stdout.split()
    read_counts(made["runner"])
    total, branches, by, seconds = collections.Counter(), {}, {}, {}
    for group in names + ["internals"]:
        if wanted and group not in wanted:
            continue
        at = made["internals" if group == "internals" else "runner"]
        start = time.time()
        done = subprocess.run(["./program"] + ([] if group == "internals" else [group]), cwd=at, stdout=subprocess.PIPE,
                              text=True)
        seconds[group] = time.time() - start
        if done.returncode:
            print(done.stdout)
            sys.exit("coverage.py: %s failed" % group)
        lines, more = read_counts(at)
        total.update(lines)
        for line in lines:
            total.setdefault(line, 0)
            if lines[line]:
                by.setdefault(line, []).append(group)
        add_branches(branches, more)
        print("%-12s %6.1f s" % (group, seconds[group]), file=sys.stderr, flush=True)
    return total, branches, by, seconds


def per_cent(part, whole):
    return 100.0 * part / whole if whole else 100.0


def table(h, total, branches):
    print("%-22s %8s %7s %9s %7s" % ("room", "lines", "run", "branches", "taken"))
    sums = [0, 0, 0, 0]
    for room in h.rooms:
        lines = [n for n in total if room.first <= n <= room.last]
        taken = [c for n in lines for c in branches.get(n, [])]
        row = [len(lines), sum(total[n] > 0 for n in lines), len(taken), sum(c > 0 for c in taken)]
        if not row[0]:
            continue
        sums = [a + b for a, b in zip(sums, row)]
        print("%-22s %8d %6.1f%% %9d %6.1f%%" % ("[%s] %s" % (room.number, room.name), row[0], per_cent(row[1], row[0]),
                                                  row[2], per_cent(row[3], row[2])))
    print("%-22s %8d %6.1f%% %9d %6.1f%%" % ("all", sums[0], per_cent(sums[1], sums[0]), sums[2],
                                              per_cent(sums[3], sums[2])))
    return per_cent(sums[1], sums[0]), per_cent(sums[3], sums[2])


def list_places(h, places):
    """Lines with their function's name in front of the first of each."""
    last = None
    for n in sorted(places):
        name = next((f.name for f in h.functions if f.first <= n <= f.last), "")
        if name != last:
            print("\n%s %s" % (h.room_of(n), name))
            last = name
        print("%6d  %s" % (n, h.raw[n - 1].strip()))


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--groups", default="")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--branches", action="store_true")
    parser.add_argument("--map")
    parser.add_argument("--check", nargs=2, type=float)
    o = parser.parse_args()
    with open(os.path.join(TOP, "heatdiff.h"), encoding="utf-8") as f:
        h = house.House(f.read())
    with tempfile.TemporaryDirectory() as folder:
        total, branches, by, seconds = run(build(folder), [g for g in o.groups.split(",") if g])
    if o.map:
        with open(o.map, "w", encoding="utf-8") as f:
            json.dump({"seconds": seconds, "lines": by, "idle": sorted(n for n in total if not total[n])}, f)
    if o.list:
        list_places(h, [n for n in total if not total[n]])
    if o.branches:
        list_places(h, [n for n in total if total[n] and not all(branches.get(n, [1]))])
    lines, taken = table(h, total, branches)
    if o.check and (lines < o.check[0] or taken < o.check[1]):
        sys.exit("coverage.py: %.1f%% of lines and %.1f%% of branches" % (lines, taken))


main()
