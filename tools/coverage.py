#!/usr/bin/env python3
"""Which lines and branches of heatdiff.h the tests run, by room.

    coverage.py                    a table of rooms; every group of tests/runner.c, and tests/internals.c
    coverage.py --groups NAME,...  only these groups (internals is one)
    coverage.py --list             every line that no test runs, under its function
    coverage.py --branches         every branch that is never taken (lines that do run)
    coverage.py --map FILE         also writes which group runs which line, as JSON, for mutate.py
    coverage.py --check LINES BRANCHES   exit 1 below so many per cent
    coverage.py --tool             the files of the tool instead, as tests/test_cli.py and two groups of the runner run them

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
TOOL_FILES = ("heatdiff.c", "levels.h", "meshio.h", "picture.h")      # shapes.h has shapes of tests, and one of the tool
TOOL_GROUPS = ("meshio", "picture")

# What the tests do to the tool must not cost it its counters: a limit of the size of files, allocations that fail
# (tests/starve.c), and the exit at once after Ctrl-C.
KEEP_COUNTERS = """#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <sys/resource.h>
void __gcov_dump(void);
void __real__exit(int code);
static void lift_limits(void)
{
    void (*starve_end)(void);
    struct rlimit limit;
    *(void **)&starve_end = dlsym(RTLD_DEFAULT, "starve_end");
    if (starve_end) starve_end();
    if (getrlimit(RLIMIT_FSIZE, &limit)) abort();
    limit.rlim_cur = limit.rlim_max;
    if (setrlimit(RLIMIT_FSIZE, &limit)) abort();
}
__attribute__((constructor)) static void begin(void)
{
    if (atexit(lift_limits)) abort();             /* called before the counters are written */
}
void __wrap__exit(int code)
{
    lift_limits();
    __gcov_dump();
    __real__exit(code);
}
"""


def build(folder, programs=PROGRAMS):
    """The programs with counters, each in a folder of its own, where its counters go."""
    made = {}
    for name, source in programs:
        at = os.path.join(folder, name)
        os.mkdir(at)
        subprocess.run(["gcc", "-O0", "-w", "--coverage"] + PLAIN + ["-I" + TOP, os.path.join(TOP, source), "-o", "program", "-lm"],
                       cwd=at, check=True)
        made[name] = at
    return made


def build_tool(folder):
    """The tool with counters. The library goes into an object of its own without them, which is optimised: its tests wait."""
    at = os.path.join(folder, "tool")
    os.mkdir(at)
    source = os.path.join(TOP, "tools", "heatdiff.c")
    with open(source, encoding="utf-8") as f:
        text = f.read().replace("#define HEATDIFF_IMPLEMENTATION\n", "\n")
    for name, content in (("tool.c", '#line 1 "%s"\n%s' % (source, text)), ("keep.c", KEEP_COUNTERS)):
        with open(os.path.join(at, name), "w", encoding="utf-8") as f:
            f.write(content)
    for command in (["-O2", "-c", os.path.join(TOP, "tools", "heatdiff_shared.c"), "-o", "library.o"], ["-c", "keep.c"],
                    ["-O0", "--coverage", "-c", "-I" + os.path.join(TOP, "tools"), "tool.c"],
                    ["--coverage", "-Wl,--wrap=_exit", "tool.o", "keep.o", "library.o", "-o", "heatdiff", "-lm", "-ldl"]):
        subprocess.run(["gcc", "-w"] + command, cwd=at, check=True)
    return at


def read_counts(at, file="heatdiff.h", keep=False):
    """{line: count} and {line: [count of each branch]} of a file from the counters in a folder, which start again."""
    notes = [f for f in os.listdir(at) if f.endswith(".gcda")]
    lines, branches = collections.Counter(), {}
    for note in notes:
        out = subprocess.run(["gcov", "--json-format", "--stdout", "--branch-probabilities", note], cwd=at,
                             stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True).stdout
        for document in out.splitlines():
            for source in json.loads(document)["files"]:
                if os.path.basename(source["file"]) != file:
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
        if not keep:
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


def run_tool(folder):
    """Runs the tests of the tool and of its headers: the folders with their counters."""
    made = build(folder, PROGRAMS[:1])
    at = build_tool(folder)
    os.chmod(folder, 0o755)                      # one test runs the tool as a user without rights, who has counters too
    os.umask(0)
    for name, command, where in (("tool", [sys.executable, os.path.join(TOP, "tests", "test_cli.py"), "./heatdiff"], at),
                                 ("runner", ["./program", *TOOL_GROUPS], made["runner"])):
        start = time.time()
        if subprocess.run(command, cwd=where, stdout=subprocess.DEVNULL).returncode:
            sys.exit("coverage.py: the tests of %s failed" % name)
        print("%-12s %6.1f s" % (name, time.time() - start), file=sys.stderr, flush=True)
    return at, made["runner"]


def tool_parts(folders):
    """(file, {line: count}, {line: [count of each branch]}) of each file of the tool."""
    parts = []
    for file in TOOL_FILES:
        total, branches = collections.Counter(), {}
        for at in folders:
            lines, more = read_counts(at, file, keep=True)
            for line, count in lines.items():
                total[line] += count
            add_branches(branches, more)
        parts.append((file, total, branches))
    return parts


def per_cent(part, whole):
    return 100.0 * part / whole if whole else 100.0


def table(title, parts):
    """parts: (name, {line: count}, {line: [count of each branch]}) of each."""
    print("%-22s %8s %7s %9s %7s" % (title, "lines", "run", "branches", "taken"))
    sums = [0, 0, 0, 0]

    def print_row(name, row):
        print("%-22s %8d %6.1f%% %9d %6.1f%%" % (name, row[0], per_cent(row[1], row[0]), row[2], per_cent(row[3], row[2])))
    for name, lines, branches in parts:
        taken = [c for n in lines for c in branches.get(n, [])]
        row = [len(lines), sum(c > 0 for c in lines.values()), len(taken), sum(c > 0 for c in taken)]
        if row[0]:
            sums = [a + b for a, b in zip(sums, row)]
            print_row(name, row)
    print_row("all", sums)
    return per_cent(sums[1], sums[0]), per_cent(sums[3], sums[2])


def by_room(h, total, branches):
    return [("[%s] %s" % (r.number, r.name), {n: c for n, c in total.items() if r.first <= n <= r.last}, branches) for r in h.rooms]


def list_places(h, places, branches=None, file=None):
    """Lines with their function's name in front of the first of each, and how often each branch was taken."""
    last = None
    for n in sorted(places):
        name = next((f.name for f in h.functions if f.first <= n <= f.last), "")
        if name != last:
            print("\n%s %s" % (file or h.room_of(n), name))
            last = name
        print("%6d  %s%s" % (n, h.raw[n - 1].strip(), "   " + str(branches[n]) if branches else ""))


def house_of(*path):
    with open(os.path.join(TOP, *path), encoding="utf-8") as f:
        return house.House(f.read())


def show(o, h, total, branches, file=None):
    if o.list:
        list_places(h, [n for n in total if not total[n]], file=file)
    if o.branches:
        list_places(h, [n for n in total if total[n] and not all(branches.get(n, [1]))], branches, file)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--groups", default="")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--branches", action="store_true")
    parser.add_argument("--tool", action="store_true")
    parser.add_argument("--map")
    parser.add_argument("--check", nargs=2, type=float)
    o = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if o.tool:
            parts = tool_parts(run_tool(folder))
        else:
            total, branches, by, seconds = run(build(folder), [g for g in o.groups.split(",") if g])
    if o.map and not o.tool:
        with open(o.map, "w", encoding="utf-8") as f:
            json.dump({"seconds": seconds, "lines": by, "idle": sorted(n for n in total if not total[n])}, f)
    if o.tool:
        for file, total, branches in parts:
            show(o, house_of("tools", file), total, branches, file)
    else:
        h = house_of("heatdiff.h")
        show(o, h, total, branches)
        parts = by_room(h, total, branches)
    lines, taken = table("file" if o.tool else "room", parts)
    if o.check and (lines < o.check[0] or taken < o.check[1]):
        sys.exit("coverage.py: %.1f%% of lines and %.1f%% of branches" % (lines, taken))


if __name__ == "__main__":
    main()
