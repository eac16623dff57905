#!/usr/bin/env python3
"""Small faults put into heatdiff.h one at a time: how many of them do the tests find?

    mutate.py [--count N] [--seed S] [--room NUMBER] [--seconds S] [--each S] [--map FILE] [--least PER CENT]
    mutate.py --line NUMBER        every fault of one line
    mutate.py --again FILE         the survivors that an earlier run has printed, after tests were added

Up to N faults are drawn in every room (default 500), no two of one line, rooms in turn: another sign, comparison,
operator, index, constant, conjugate, minimum for maximum, a condition turned round, a statement left out. Only lines
that tests run in a build without threads and vector instructions are drawn. No faults are those of a prefetch, one that
takes the other of two equal numbers, one that only takes more work space, one that leaves the compiled code as it was,
and one that does not compile.

Each fault is compiled by tcc, in a tenth of a second. The tests are cut into pieces: every call that stands in the
body of a group. The pieces that run the line follow, those first that are quick or found other faults of the function,
until one fails, crashes, or takes four times as long as without the fault. The pieces of one fault get --each seconds of
processor time (default 30); the number of pieces that were left then is printed. A line for each fault:

    caught by PIECE, or SURVIVED    line, room, what was done, the line as it is now

--map is a file that keeps which piece runs which line, made at the first run, which takes some minutes. Lines of the
header that have changed since are not drawn. Pieces that are new run too.
Exit 1 when fewer than --least per cent are caught. Needs gcc, binutils, tcc and Python 3."""
import argparse
import array
import collections
import difflib
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


WORD = r"[\w.>\[\]-]+"
EITHER = re.compile(r"(%s) (?:<=?|>=?) (%s)(?: \? (%s) : (%s)|\) (%s) = (%s);)" % ((WORD,) * 6))

LIMITED = re.compile(r"^\s*if \((%s) (?:<=?|>=?) ([^;&|]+)\) \1 = \2;$" % WORD)


def no_fault(kind, code, m):
    """Equal numbers, of which either may be taken: < and <= make no difference in x < y ? x : y and if (x < y) y = x."""
    for e in EITHER.finditer(code) if kind == "comparison" else ():
        chosen = [w for w in e.groups()[2:] if w]
        if e.start() <= m.start() < e.end() and set(chosen) == set(e.groups()[:2]):
            return True
    if kind == "comparison" and LIMITED.search(code):
        return True
    before, after = code[:m.start()], code[m.end():]
    if kind == "constant" and "HDI_TAKE(" in before and not re.search(r"HDI_TAKE\([^;]*[;/-]|[;/-] ?$", before):
        return ";" in after                  # more room than is needed
    return "HDI_PREFETCH" in code


def only_fetches(h, n):
    """Whether the line stands in a function that does nothing but fetch what will be read."""
    f = next((f for f in h.functions if f.first <= n <= f.last), None)
    body = [t.strip() for t in h.code_lines[f.first:f.last - 1]] if f else []
    return any("HDI_PREFETCH" in t for t in body) and all(
        not t or t.endswith("{") or "HDI_PREFETCH" in t or t.endswith("return;") or t.startswith(("enum ", "const ", "int")) for t in body)


def faults_of(h, n):
    """Every fault of a line."""
    if not hasattr(h, "code_lines"):
        h.code_lines = h.code.split("\n")
    code, raw = h.code_lines[n - 1].rstrip(), h.raw[n - 1]
    found = []
    if '"' in code or code.lstrip().startswith("#") or only_fetches(h, n):
        return found
    for kind, pattern, new in FAULTS:
        if kind == "statement" and DECLARES.match(code):
            continue
        for m in pattern.finditer(code):
            changed = code[:m.start()] + m.expand(new) + code[m.end():] if isinstance(new, str) else \
                code[:m.start()] + new(m) + code[m.end():]
            if changed != raw and not no_fault(kind, code, m):
                found.append(Fault(n, kind, changed))
    return found


def draw(h, lines, count, seed):
    """Up to so many faults in every room, no two of one line."""
    rng = random.Random(seed)
    rooms = collections.defaultdict(list)
    for n in lines:
        rooms[h.room_of(n)].append(n)
    drawn = []
    for room in sorted(rooms):
        rng.shuffle(rooms[room])
        choices = [c for c in (faults_of(h, n) for n in rooms[room]) if c]
        drawn += [(k, room, rng.choice(c)) for k, c in enumerate(choices[:count])]
    return [f for _, _, f in sorted(drawn)]      # rooms take turns


PROGRAMS = ("internals", "runner")
LONGEST = 3      # seconds that a piece may take; longer ones are left out
CALL = re.compile(r"^    (\w+)\(([^;]*)\);(?:\s*/\*.*\*/)?$")
STOPS = """
#include <signal.h>
#include <sys/wait.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
static int pieces_stop = 1;
"""
MAIN = r"""
#undef main
extern void pieces_begin(void), pieces_end(int);
int main(int argc, char **argv) {      /* NAME LIMIT ... ; without names: all, with the seconds of each */
    int i, k;
    if (argc < 2) {
        pieces_stop = 0;
        for (i = 0; i < PIECES; i++) {
            const pid_t child = fork();
            int status;
            if (child == 0) {
                struct itimerval timer;
                clock_t start;
                memset(&timer, 0, sizeof timer);
                timer.it_value.tv_sec = PIECES_LONGEST;
                setitimer(ITIMER_PROF, &timer, NULL);
                pieces_begin();
                start = clock();
                pieces[i].run();
                fprintf(stderr, "piece %s %.4f %d\n", pieces[i].name, (double)(clock() - start) / CLOCKS_PER_SEC,
                        PIECES_FAILED > 0);
                fflush(stderr);
                pieces_end(i);
                _exit(0);
            }
            waitpid(child, &status, 0);
        }
        return 0;
    }
    for (k = 1; k + 1 < argc; k += 2) {
        const double limit = atof(argv[k + 1]);
        struct itimerval timer;
        memset(&timer, 0, sizeof timer);
        timer.it_value.tv_sec = (long)limit;
        timer.it_value.tv_usec = (long)(1e6 * (limit - (double)(long)limit)) + 1;
        fprintf(stderr, "%s\n", argv[k]);
        setitimer(ITIMER_PROF, &timer, NULL);
        alarm((unsigned)(20 * limit) + 60);
        for (i = 0; i < PIECES; i++) {
            if (strcmp(pieces[i].name, argv[k]) == 0) pieces[i].run();
        }
    }
    _exit(0);
}
"""
SEEN = r"""
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
extern char __executable_start, etext;
static unsigned char *seen;
void __sanitizer_cov_trace_pc(void) {
    if (seen) seen[(char *)__builtin_return_address(0) - &__executable_start] = 1;
}
static size_t length(void) { return (size_t)(&etext - &__executable_start); }
void pieces_begin(void) {
    seen = (unsigned char *)calloc(length() + 1, 1);
}
void pieces_end(int piece) {
    unsigned char *s = seen;
    char name[40];
    uint32_t k;
    FILE *out;
    seen = NULL;
    sprintf(name, "seen%d.bin", piece);
    out = fopen(name, "wb");
    for (k = 0; k < length(); k++) if (s[k]) fwrite(&k, 4, 1, out);
    fclose(out);
}
"""
IDLE = "void pieces_begin(void) {}\nvoid pieces_end(int piece) { (void)piece; }\n"


def is_piece(m, static):
    """Whether a call needs nothing of the function around it."""
    if m.group(1) not in static:
        return False
    words = re.findall(r"\b([A-Za-z_]\w*)(\(?)", re.sub(r'"[^"]*"', "", m.group(2)))
    return all(t.isupper() or after for t, after in words)


def split(body, prefix, static):
    """The calls in the body of a group as pieces of their own, and what is left of the body."""
    pieces, left = [], []
    for line in body:
        m = CALL.match(line)
        if m and is_piece(m, static):
            pieces.append((m.group(1), "%s(%s)" % (m.group(1), m.group(2))))
        else:
            left.append(line)
    bare = [t for t in left if t.strip() and not t.startswith("    return") and "passed, %lld failed" not in t]
    if bare:
        pieces.append((prefix, None))
    return pieces, bare


def cut(folder, name):
    """Writes tests/pieces_NAME.c, a program of the pieces of tests/NAME.c."""
    tests = os.path.join(folder, "tests")
    text = open(os.path.join(tests, name + ".c"), encoding="utf-8").read()
    files = [text] + [open(os.path.join(tests, f), encoding="utf-8").read() for f in re.findall(r'#include "(test_\w+\.h)"', text)]
    whole = "\n".join(files)
    static = set(re.findall(r"^static void (\w+)\(", whole, re.M))
    groups = dict((g, f) for g, f in re.findall(r'\{"(\w+)", (test_\w+)', text)) if name == "runner" else {"internals": "int_tests"}
    pieces, code, todo, done = [], [], list(groups.items()), set()
    while todo:
        group, function = todo.pop(0)
        done.add(function)
        m = re.search(r"^(?:static void|int) %s\(void\)\s*\{\n(.*?)^\}" % function, whole, re.M | re.S)
        table = re.search(r"^static void \(\*const %s\[\]\)\(void\) = \{\n(.*?)^\}" % function, whole, re.M | re.S)
        if not m and not table:
            sys.exit("mutate.py: %s has another form than expected" % function)
        body = m.group(1).split("\n") if m else ["    %s();" % t for t in re.findall(r"\w+", table.group(1))]
        found, left = split(body, group, static)
        for p, call in found:
            if p.startswith("test_"):
                todo.append((p[5:], p))
                continue
            label, k = p, 2
            while label in [q[0] for q in pieces]:
                label, k = "%s_%d" % (p, k), k + 1
            pieces.append((label, "piece_" + label))
            code.append("static void piece_%s(void) {\n%s\n}" % (label, "    %s;" % call if call else "\n".join(left)))
    stop = {"runner": ("test_failed_in_group++;", "test_failed_in_group++; if (pieces_stop) _exit(1);"),
            "internals": ("int_failed++;", "int_failed++; if (pieces_stop) _exit(1);")}[name]
    assert stop[0] in text
    with open(os.path.join(tests, "pieces_%s.c" % name), "w", encoding="utf-8") as f:
        f.write(STOPS + "#define main whole_main\n" + text.replace(stop[0], stop[1], 1) + "\n" + "\n".join(code) +
                "\nstatic const struct { const char *name; void (*run)(void); } pieces[] = {\n" +
                ",\n".join('    {"%s", %s}' % p for p in pieces) +
                "};\nenum { PIECES = %d, PIECES_LONGEST = %d };\n#define PIECES_FAILED %s\n" % (
                    len(pieces), LONGEST, "test_failed" if name == "runner" else "int_failed") + MAIN)
    return [p[0] for p in pieces]


def lines_of_blocks(program):
    """Start of each block of code, and the lines of heatdiff.h that it holds: ([address], {address: lines})."""
    text = subprocess.run(["objdump", "-d", "--no-show-raw-insn", program], stdout=subprocess.PIPE, text=True, check=True).stdout
    starts, after = [], False
    for t in text.split("\n"):
        m = re.match(r"\s*([0-9a-f]+):\t(.*)", t)
        if not m:
            continue
        if after:
            starts.append(int(m.group(1), 16))
        after = "<__sanitizer_cov_trace_pc>" in m.group(2) and m.group(2).startswith("call")
    table = subprocess.run(["objdump", "--dwarf=decodedline", program], stdout=subprocess.PIPE, text=True, check=True).stdout
    rows = sorted((int(m.group(2), 16), int(m.group(1))) for m in re.finditer(r"^heatdiff\.h\s+(\d+)\s+0x([0-9a-f]+)", table, re.M))
    of, k = collections.defaultdict(set), -1
    for address, line in rows:
        while k + 1 < len(starts) and starts[k + 1] <= address + 5:   # the call itself stands on the first line
            k += 1
        if k >= 0:
            of[starts[k]].add(line)
    return of


class Bench:
    """A copy of the tree whose header is changed."""

    def __init__(self, folder, raw):
        self.folder, self.raw = folder, raw
        for name in ("tests", "tools", "examples"):
            shutil.copytree(os.path.join(TOP, name), os.path.join(folder, name))
        self.put(raw)
        self.pieces = {name: cut(folder, name) for name in PROGRAMS}
        for name, text in (("seen.c", SEEN), ("idle.c", IDLE)):
            with open(os.path.join(folder, name), "w", encoding="utf-8") as f:
                f.write(text)
        self.plain, self.trust = {}, {}
        for name in PROGRAMS:
            self.plain[name] = self.compile(name)
            self.link(name)
            os.rename(os.path.join(folder, name), os.path.join(folder, name + "_plain"))

    def put(self, raw):
        with open(os.path.join(self.folder, "heatdiff.h"), "w", encoding="utf-8") as f:
            f.write("\n".join(raw))

    def compile(self, name):
        """The bytes of the object of a program, or None."""
        if subprocess.run(["tcc", "-w", "-DHEATDIFF_AUDIT", "-DCASES_SPARSE", "-c", "tests/pieces_%s.c" % name, "-I.", "-o", name + ".o"], cwd=self.folder,
                          stderr=subprocess.DEVNULL).returncode:
            return None
        with open(os.path.join(self.folder, name + ".o"), "rb") as f:
            return f.read()

    def link(self, name):
        subprocess.run(["tcc", name + ".o", "idle.c", "-o", name, "-lm"], cwd=self.folder, check=True)

    def measure(self):
        """Seconds of each piece without optimisation, and the lines of the header that it runs."""
        known = {}
        for name in PROGRAMS:
            program = os.path.join(self.folder, name + "_seen")
            subprocess.run(["gcc", "-O0", "-g", "-w", "-D__TINYC__", "-DCASES_SPARSE", "-DHEATDIFF_NO_SIMD", "-no-pie", "-fsanitize-coverage=trace-pc",
                            "-I.", "-c", "tests/pieces_%s.c" % name, "-o", "seen_pieces.o"], cwd=self.folder, check=True)
            subprocess.run(["gcc", "-no-pie", "seen_pieces.o", "seen.c", "-o", program, "-lm"], cwd=self.folder, check=True)
            printed = subprocess.run([program], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True).stderr
            of = lines_of_blocks(program)
            first = int(re.search(r"([0-9a-f]+) \w __executable_start", subprocess.run(
                ["nm", program], stdout=subprocess.PIPE, text=True, check=True).stdout).group(1), 16)
            for k, piece in enumerate(self.pieces[name]):
                m = re.search(r"^piece %s ([\d.]+) (\d)" % piece, printed, re.M)
                seen = os.path.join(self.folder, "seen%d.bin" % k)
                if not m or int(m.group(2)) or not os.path.exists(seen):
                    print("left out, as it fails or takes too long without a fault: " + piece, flush=True)
                    continue
                lines = set()
                with open(seen, "rb") as f:
                    for offset in array.array("I", f.read()):
                        lines |= of.get(first + offset, set())
                os.remove(seen)
                known[piece] = {"seconds": float(m.group(1)), "lines": sorted(lines)}
        return known

    def trusted(self, name, piece, seconds):
        """Whether a piece passes without a fault; asked when it finds its first."""
        if piece not in self.trust:
            self.trust[piece] = self.run(name + "_plain", [piece], seconds) is None
            if not self.trust[piece]:
                print("not trusted, as it fails without a fault: " + piece, flush=True)
        return self.trust[piece]

    def run(self, name, pieces, seconds):
        """The piece that fails, or None."""
        command = ["./" + name]
        for p in pieces:
            command += [p, "%.2f" % (0.5 + 4 * seconds.get(p, 2))]
        done = subprocess.run(["bash", "-c", 'ulimit -c 0 -v 6000000; exec "$@"', "-"] + command, cwd=self.folder,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
        if done.returncode == 0:
            return None
        begun = [t for t in done.stderr.split("\n") if t in pieces]
        return begun[-1] if begun else pieces[0]

    def try_fault(self, fault, order, seconds):
        """'same', 'broken', the name of the piece that finds it, or None. order: [(program, pieces)]."""
        raw = list(self.raw)
        raw[fault.line - 1] = fault.text
        self.put(raw)
        made = {}
        for name, pieces in order:
            if name not in made:
                made[name] = self.compile(name)
                if made[name] is None:
                    return "broken"
                if made[name] == self.plain[name]:
                    return "same"
                self.link(name)
            left = [p for p in pieces if self.trust.get(p, True)]
            while left:
                found = self.run(name, left, seconds)
                if not found:
                    break
                if self.trusted(name, found, seconds):
                    return found
                left = left[left.index(found) + 1:]
        return None


def order_of(bench, fault, known, hits, budget):
    """The pieces to run: [(program, pieces)], and how many are left out."""
    at = {p: name for name in PROGRAMS for p in bench.pieces[name]}
    new = [p for p in at if p not in known["pieces"] and p not in known["failing"]]
    by = known["by"].get(fault.line, [])
    by = sorted(by, key=lambda p: (known["pieces"][p]["seconds"] + 0.002) / (1 + 20 * hits[p]))
    spent, order, left = 0.0, [], 0
    for p in new + by if known["new_first"] else by + new:
        cost = known["pieces"][p]["seconds"] if p in known["pieces"] else 0
        if spent + cost > budget:
            left += 1
            continue
        spent += cost
        if order and order[-1][0] == at[p]:
            order[-1][1].append(p)
        else:
            order.append((at[p], [p]))
    if len(order) > 8:       # few changes between the programs
        order = [(name, [p for n, ps in order if n == name for p in ps]) for name in PROGRAMS]
    return [(n, ps) for n, ps in order if ps], left


def moved(old, new):
    """{line of the old text: line of the new one} of lines that are the same."""
    same = {}
    for a, b, size in difflib.SequenceMatcher(None, old, new).get_matching_blocks():
        same.update((a + k + 1, b + k + 1) for k in range(size))
    return same


def read_map(o, bench, h):
    if o.map and os.path.exists(o.map):
        with open(o.map, encoding="utf-8") as f:
            known = json.load(f)
        if known["text"] != h.raw:
            to = moved(known["text"], h.raw)
            for piece in known["pieces"].values():
                piece["lines"] = [to[n] for n in piece["lines"] if n in to]
        return known
    pieces = bench.measure()
    failing = [p for name in PROGRAMS for p in bench.pieces[name] if p not in pieces]
    known = {"text": h.raw, "pieces": pieces, "failing": failing}
    if o.map:
        with open(o.map, "w", encoding="utf-8") as f:
            json.dump(known, f)
    return known


def survivors(name):
    """The faults that an earlier run has printed as survivors."""
    found, last = [], None
    with open(name, encoding="utf-8") as f:
        for t in f:
            m = re.match(r"SURVIVED\s+(\d+) \[\d+\] (\w+)\s+(?:\(\d+ left\) )?(.*)$", t)
            if m:
                last = m
            elif last and t.split(None, 1)[:1] == ["was"]:
                found.append((t.split(None, 1)[1].strip(), int(last.group(1)), last.group(2), last.group(3)))
                last = None
    return found


def faults_again(h, name):
    """Those faults in the header as it is now; lines may have moved, and what is gone is left out."""
    faults, places = [], collections.defaultdict(list)
    for n, t in enumerate(h.raw, 1):
        places[t.strip()].append(n)
    for was, line, kind, text in survivors(name):
        if places[was]:
            n = min(places[was], key=lambda k: abs(k - line))
            faults.append(Fault(n, kind, text))
    return faults


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=1e9)
    parser.add_argument("--each", type=float, default=30)
    parser.add_argument("--room")
    parser.add_argument("--line", type=int)
    parser.add_argument("--again")
    parser.add_argument("--map")
    parser.add_argument("--least", type=float, default=0)
    o = parser.parse_args()
    begin = time.time()
    with open(os.path.join(TOP, "heatdiff.h"), encoding="utf-8") as f:
        h = house.House(f.read())
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(folder, h.raw)
        known = read_map(o, bench, h)
        seconds = {p: v["seconds"] for p, v in known["pieces"].items()}
        known["new_first"] = bool(o.again or o.line)
        known["by"] = collections.defaultdict(list)
        for p in known["pieces"]:
            if any(p in bench.pieces[name] for name in PROGRAMS):
                for n in known["pieces"][p]["lines"]:
                    known["by"][n].append(p)
        lines = [n for n in sorted(known["by"]) if n > h.border and (not o.room or h.room_of(n) == "[%s]" % o.room)]
        faults = faults_again(h, o.again) if o.again else faults_of(h, o.line) if o.line else draw(h, lines, o.count, o.seed)
        caught, all_of = collections.Counter(), collections.Counter()
        hits = collections.defaultdict(collections.Counter)
        for fault in faults:
            if time.time() - begin > o.seconds:
                break
            function = next((f.name for f in h.functions if f.first <= fault.line <= f.last), "")
            order, left = order_of(bench, fault, known, hits[function], o.each)
            found = bench.try_fault(fault, order, seconds)
            if found in ("same", "broken"):
                continue
            if found:
                hits[function][found] += 1
            room = h.room_of(fault.line)
            for key in (fault.kind, room):
                all_of[key] += 1
                caught[key] += found is not None
            print("%-28s %6d %s %-10s %s%s" % ("caught by " + found if found else "SURVIVED", fault.line, room, fault.kind,
                                               "(%d left) " % left if left and not found else "", fault.text.strip()), flush=True)
            if not found:
                print("%28s %6s %s" % ("", "was", h.raw[fault.line - 1].strip()), flush=True)
    for key in sorted(all_of):
        print("%-12s %4d of %4d" % (key, caught[key], all_of[key]))
    rooms = [key for key in all_of if key.startswith("[")]
    whole, good = sum(all_of[k] for k in rooms), sum(caught[k] for k in rooms)
    print("%d faults, %d caught, %.1f%%, %.0f s" % (whole, good, 100.0 * good / max(1, whole), time.time() - begin))
    sys.exit(100.0 * good < o.least * whole)


main()
