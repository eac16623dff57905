#!/usr/bin/env python3
"""Counts of the house: how large the rooms of heatdiff.h are, and how well they keep the rules of the house.

    house.py                  one line a room, then a summary
    house.py --check          the same, and compares with the limits below; exit 1 when one is exceeded, with the places
    house.py --tighten        lowers the limits below to what holds today, in this file; never raises one
  house.py --list WHAT      every place that counts towards WHAT (one of the names under LIMITS, or functions)
    house.py --file PATH      another file than the heatdiff.h in the folder above this script

Needs Python 3 only. How things are counted:

  lines       from the banner of a room up to the next one. A banner is a line that begins, with or without the
              opening of a comment, with ==== [07] sparse ====.
  functions   from the line that the declaration starts on to the line of the closing brace. What macros expand to
              is not seen; in #if ... #else every branch is.
  wide        characters of a line. Declarations: what is left of a line of the public part without its comments.
  macros      #define NAME( with a parameter list, wherever it stands.
  twins       pairs of places that share six or more consecutive lines of code. Blank lines, comments, whitespace,
              the backslash at the end of a line of a macro, and lines of braces, semicolons and brackets alone are left
              out before lines are compared. Text must be the same to the letter: copies with other names are not found.
              A run is reported once, at its full length; three copies are three pairs.
  names       file scope only: functions, variables, types, tags, constants of enums, macros."""
import argparse
import os
import re
import statistics
import sys
from collections import namedtuple

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

TWIN_LINES = 6
MOST_ARGUMENTS = 8
WIDEST_LINE = 110
WIDEST_DECLARATION = 100
KERNEL_ROOMS = ("kernels", "dense")   # the name of the room, and the name it had before
FOREIGN = ("dgemm_", "WIN32_LEAN_AND_MEAN", "NOMINMAX", "syscall", "DWORD")   # names that others have chosen

# What holds today. Whenever --check says that a limit can come down, --tighten brings it down.
LIMITS = {
    "lines": 23718,           # goal 16000; raised from 23000 by eigenpairs, estimates, filters, sources and more
    "api": 501,               # lines of room [api]; goal 1100
    "median": 9,             # lines of a function; goal 13
    "longest": 46,            # lines of the longest function; goal 60
    "long": 0,                # functions longer than 60 lines; goal 0
    "widest": 110,            # characters of the widest line; goal 110
    "wide": 0,                # lines wider than that; goal 0
    "wide-declarations": 0,   # code in the public part wider than 100; goal 0
    "arguments": 2,           # private functions with more than eight arguments, kernels all; goal 0
    "macros": 31,             # function-like macros in the whole file; no goal of its own
    "kernel-macros": 6,       # function-like macros in room [kernels]; goal below 40
    "twins": 0,               # pairs of places that share six or more lines; goal 0
    "public-calls": 0,        # statics that call a public function; goal 0
    "forward": 0,             # forward declarations of statics; goal 0
    "private-names": 0,       # without hdi_ or HDI_; goal 0
    "public-names": 0,        # without hd_, HD_ or HEATDIFF_; goal 0
    "skipped-rooms": 0,       # numbers that no room has, and rooms out of order; goal 0
}

Token = namedtuple("Token", "text line")
Function = namedtuple("Function", "name first last arguments static public calls")
Place = namedtuple("Place", "line text")
Room = namedtuple("Room", "number name first last")

KEYWORDS = set("""auto break case char const continue default do double else enum extern float for goto if inline int long
register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while defined
__attribute__ __declspec __asm__ asm alignas _Alignas __extension__ noexcept""".split())
LEXER = re.compile(r"""
    (?P<comment>/\*.*?(?:\*/|\Z)|//(?:[^\n\\]|\\.)*)
  | (?P<string>"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*')""", re.S | re.X)
DIRECTIVE = re.compile(r"^[ \t]*\#(?:[^\n\\]|\\\n|\\.)*", re.M)
TOKEN = re.compile(r"[A-Za-z_]\w*|\d[\w.]*|\#\w+|\n|[^\s\w]")
BANNER = re.compile(r"^\s*(?:/\*\s*)?={4}\s*\[(\w+)\]\s*(.*?)\s*={4}")


def blank(text):
    """Spaces in place of everything but the ends of lines."""
    return re.sub(r"[^\n]", " ", text)


class House:
    """What is counted of one file."""

    def __init__(self, text):
        self.raw = text.split("\n")
        self.code = LEXER.sub(lambda m: blank(m.group()) if m.group("comment") else m.group(), text)
        masked = LEXER.sub(lambda m: blank(m.group()) if m.group("comment") else '"' + blank(m.group())[2:] + '"', text)
        self.directives = []          # (line, text with its continued lines joined)
        self.plain = DIRECTIVE.sub(lambda m: self.directive(masked, m), masked)
        self.rooms = self.find_rooms()
        self.border = self.find_border()
        self.public = set()           # names of the functions that the public part declares
        self.functions, self.forward, self.names = [], [], []
        self.pasting = self.find_pasting()
        self.parse()
        self.macros = [Place(line, m.group(1)) for line, d in self.directives
                       for m in [re.match(r"#define ([A-Za-z_]\w*)\(", d)] if m]

    def directive(self, text, m):
        joined = re.sub(r"\s*\\\n\s*", " ", m.group()).strip()
        self.directives.append((text.count("\n", 0, m.start()) + 1, re.sub(r"^#\s*(\w+)[ \t]+", r"#\1 ", joined)))
        kind = re.match(r"#\s*(if|elif|else|endif)", joined)   # braces are balanced branch by branch
        keep = "#" + ("if" if kind.group(1) == "if" else kind.group(1)) if kind else ""
        return keep + blank(m.group())[len(keep):] if keep else blank(m.group())

    def find_pasting(self):
        """Macros that paste hdi_ in front of the name they are given, themselves or by another such macro."""
        bodies = {m.group(1): m.group(2) for line, d in self.directives
                  for m in [re.match(r"#define (\w+)\(\w+(?:, *\w+)*\) *(.*)", d)] if m}
        found = {name for name, body in bodies.items() if re.match(r"hdi_ *##", body)}
        while True:
            more = {name for name, body in bodies.items() if re.match(r"\w*", body).group() in found} - found
            if not more:
                return found
            found |= more

    # ---- rooms ----

    def find_rooms(self):
        at = [(i + 1, m) for i, l in enumerate(self.raw) for m in [BANNER.match(l)] if m]
        ends = [line - 1 for line, _ in at[1:]] + [len(self.raw)]
        return [Room(m.group(1), m.group(2), line, end) for (line, m), end in zip(at, ends)]

    def find_border(self):
        """The first line of the implementation."""
        for line, d in self.directives:
            if re.match(r"#if(def\b|\s+defined).*\bHEATDIFF_IMPLEMENTATION\b", d):
                return line
        return len(self.raw) + 1

    def room_of(self, line):
        for r in self.rooms:
            if r.first <= line <= r.last:
                return "[%s]" % r.number
        return "[-]"

    def skipped_rooms(self):
        found, next_number = [], 0
        for r in self.rooms:
            if not r.number.isdigit():
                continue
            number = int(r.number)
            found += [Place(r.first, "no room [%02d]" % k) for k in range(next_number, number)]
            if number < next_number:
                found.append(Place(r.first, "room [%s] comes after [%02d]" % (r.number, next_number - 1)))
            next_number = max(next_number, number + 1)
        return found

    # ---- what stands at file scope ----

    def tokens(self):
        line = 1
        for m in TOKEN.finditer(self.plain):
            if m.group() == "\n":
                line += 1
            else:
                yield Token(m.group(), line)

    def parse(self):
        """Cuts the file into declarations and definitions at file scope."""
        head, depth, parens, stack, body = [], 0, 0, [], None
        for t in self.tokens():
            if t.text == "#if":
                stack.append((depth, parens))
            elif t.text in ("#else", "#elif"):
                if stack:
                    depth, parens = stack[-1]
            elif t.text == "#endif":
                if stack:
                    stack.pop()
            elif t.text == "{":
                if depth == 0 and [x.text for x in head[-3:]] == ["extern", '"', '"']:
                    head = []
                    continue
                if depth == 0:
                    body = self.is_function(head)
                    opening = len(head)
                depth += 1
                head.append(t)
            elif t.text == "}":
                if depth == 0:
                    head = []         # of extern "C"
                    continue
                depth -= 1
                head.append(t)
                if depth == 0 and body:
                    self.function(head, opening)
                    head, body = [], None
            elif t.text == ";" and depth == 0 and parens == 0:
                if head:
                    self.declaration(head)
                head = []
            else:
                if depth == 0:
                    parens = max(0, parens + (t.text == "(") - (t.text == ")"))
                head.append(t)

    @staticmethod
    def group_end(tokens, i):
        """Index behind the bracket that closes the one at i."""
        depth = 0
        for k in range(i, len(tokens)):
            depth += (tokens[k].text in "([{") - (tokens[k].text in ")]}")
            if depth == 0:
                return k + 1
        return len(tokens)

    def signature(self, head):
        """(name, index of the parameters' opening bracket) of a function, or None. MACRO(name)(...) has the name, with
        hdi_ in front where the macro pastes that."""
        i = 0
        while i < len(head):
            text = head[i].text
            if text in ("=", "{", "["):
                return None
            if i + 1 < len(head) and head[i + 1].text == "(" and re.match(r"[A-Za-z_]", text):
                end = self.group_end(head, i + 1)
                if text in ("__attribute__", "__declspec", "alignas", "_Alignas"):
                    i = end
                    continue
                if re.fullmatch(r"[A-Z_][A-Z0-9_]*", text):
                    if end < len(head) and head[end].text == "(" and end - i == 4:
                        return ("hdi_" if text in self.pasting else "") + head[i + 2].text, end
                    i = end
                    continue
                if text not in KEYWORDS:
                    return text, i + 1
            i += 1
        return None

    def is_function(self, head):
        return bool(head) and head[0].text != "typedef" and self.signature(head) is not None

    def arguments(self, tokens, i):
        inner = tokens[i + 1:self.group_end(tokens, i) - 1]
        if not inner or [t.text for t in inner] == ["void"]:
            return 0
        depth, count = 0, 1
        for t in inner:
            depth += (t.text in "([{") - (t.text in ")]}")
            count += t.text == "," and depth == 0
        return count

    @staticmethod
    def without_macro_lines(head):
        """MACRO(...) on a line of its own before a declaration is no part of it."""
        while len(head) > 3 and re.fullmatch(r"[A-Z_][A-Z0-9_]*", head[0].text) and head[1].text == "(":
            end = House.group_end(head, 1)
            if end >= len(head) or head[end].line == head[end - 1].line:
                break
            head = head[end:]
        return head

    def function(self, head, opening):
        signature = head[:opening]
        cut = self.without_macro_lines(signature)
        name, at = self.signature(cut)
        words = [t.text for t in cut[:at]]
        body = head[opening:]
        calls = [(a.text, a.line) for a, b in zip(body, body[1:]) if b.text == "(" and a.text.startswith("hd_")]
        public = "HEATDIFF_API" in words
        self.functions.append(Function(name, cut[0].line, head[-1].line, self.arguments(cut, at), "static" in words,
                                       public, calls))
        self.names.append((cut[0].line, name, public))

    def declaration(self, head):
        head = self.without_macro_lines(head)
        words = [t.text for t in head]
        line = head[0].line
        signature = self.signature(head) if words[0] != "typedef" else None
        if signature:
            public = "HEATDIFF_API" in words
            if public:
                self.public.add(signature[0])
            elif "static" in words:
                self.forward.append(Place(line, signature[0]))
            self.names.append((line, signature[0], public))
            return
        self.names += [(t.line, t.text, False) for t in self.tags(head)]
        if words[0] in ("struct", "union", "enum") and len(words) == 2:
            return                    # struct tag;
        self.names += [(t.line, t.text, False) for t in self.declarators(head)]

    def tags(self, head):
        """Tags of types that are defined or named, and constants of enums."""
        for i, t in enumerate(head[:-1]):
            if t.text not in ("struct", "union", "enum"):
                continue
            k = i + 1
            if re.match(r"[A-Za-z_]", head[k].text):
                if k + 1 < len(head) and head[k + 1].text == "{" or head[0].text == "typedef" or len(head) == 2:
                    yield head[k]
                k += 1
            if t.text == "enum" and k < len(head) and head[k].text == "{":
                end = self.group_end(head, k)
                for a, b, c in zip(head[k:end], head[k + 1:end], head[k + 2:end]):
                    if a.text in "{," and re.match(r"[A-Za-z_]", b.text) and c.text != "(":
                        yield b

    def declarators(self, head):
        """Names of a typedef or of variables."""
        i, depth, last, done = 0, 0, None, False
        while i < len(head):
            t = head[i].text
            if t == "{":
                i = self.group_end(head, i)
                continue
            if t == "(" and i + 2 < len(head) and head[i + 1].text == "*":   # (*name)(...)
                yield head[i + 2]
                return
            if t in ("[", "="):
                if last is not None and not done:
                    yield last
                done = True
                if t == "[":
                    i = self.group_end(head, i)
                    continue
            elif t == ",":
                if last is not None and not done:
                    yield last
                last, done = None, False
            elif t == "(":
                i = self.group_end(head, i)
                continue
            elif re.match(r"[A-Za-z_]", t) and not done:
                last = head[i]
            i += 1
        if last is not None and not done and last.text not in KEYWORDS:
            yield last

    # ---- counts ----

    def private_names(self):
        known = {name for line, name, public in self.names if line < self.border}
        macros = [(line, m.group(1)) for line, d in self.directives for m in [re.match(r"#define ([A-Za-z_]\w*)", d)] if m]
        found = [(line, name) for line, name, public in self.names
                 if line >= self.border and not public and not (name in known and name.startswith("hd_"))]
        found += [(line, name) for line, name in macros if line >= self.border and not name.startswith("HEATDIFF_")]
        return [Place(line, name) for line, name in sorted(set(found)) if not name.startswith(("hdi_", "HDI_") + FOREIGN)]

    def public_names(self):
        macros = [(line, m.group(1)) for line, d in self.directives for m in [re.match(r"#define ([A-Za-z_]\w*)", d)] if m]
        found = [(line, name) for line, name, public in self.names if line < self.border or public]
        found += [(line, name) for line, name in macros if line < self.border]
        return [Place(line, name) for line, name in sorted(set(found)) if not name.startswith(("hd_", "HD_", "HEATDIFF_"))]

    def public_calls(self):
        return [Place(line, "%s calls %s" % (f.name, name)) for f in self.functions if f.static and not f.public
                for name, line in f.calls if name in self.public]

    def wide(self):
        return [Place(i + 1, "%d characters" % len(l)) for i, l in enumerate(self.raw) if len(l) > WIDEST_LINE]

    def wide_declarations(self):
        lines = self.code.split("\n")[:self.border - 1]
        return [Place(i + 1, "%d characters" % len(l.rstrip(" \\"))) for i, l in enumerate(lines)
                if len(l.rstrip(" \\")) > WIDEST_DECLARATION]

    def crowded(self):
        return [Place(f.first, "%s: %d arguments" % (f.name, f.arguments)) for f in self.functions
                if not f.public and f.arguments > MOST_ARGUMENTS]

    def long(self, most=60):
        found = [f for f in self.functions if length(f) > most]
        return [Place(f.first, "%s: %d lines" % (f.name, length(f))) for f in sorted(found, key=length, reverse=True)]

    def kernel_macros(self):
        rooms = ["[%s]" % r.number for r in self.rooms if r.name in KERNEL_ROOMS]
        return [m for m in self.macros if self.room_of(m.line) in rooms]

    def twins(self):
        """Pairs of runs of equal lines, (first line, last line, first line, last line, lines shared)."""
        lines = []
        for i, l in enumerate(self.code.split("\n")):
            text = re.sub(r"\s+", "", l.rstrip().rstrip("\\"))
            if re.search(r"[^{}()\[\];,]", text):
                lines.append((i + 1, text))
        at, runs = {}, {}
        for k in range(len(lines) - TWIN_LINES + 1):
            key = tuple(text for _, text in lines[k:k + TWIN_LINES])
            for first in at.setdefault(key, []):
                if k - first >= TWIN_LINES:
                    runs[(first, k)] = True
            at[key].append(k)
        found = []
        for a, b in runs:
            if (a - 1, b - 1) in runs:
                continue
            n = TWIN_LINES
            while (a + n - TWIN_LINES + 1, b + n - TWIN_LINES + 1) in runs and n < b - a:
                n += 1
            found.append((lines[a][0], lines[a + n - 1][0], lines[b][0], lines[b + n - 1][0], n))
        return sorted(found)

    def twin_places(self):
        return [Place(a, "to %d and %d to %d share %d lines" % (b, c, d, n)) for a, b, c, d, n in self.twins()]

    def lines_of(self, name):
        return sum(r.last - r.first + 1 for r in self.rooms if r.name == name)

    def counts(self):
        """Of every limit: (number, places that make it up)."""
        lengths = [length(f) for f in self.functions]
        lists = {
            "long": self.long(), "wide": self.wide(), "wide-declarations": self.wide_declarations(),
            "arguments": self.crowded(), "macros": self.macros, "kernel-macros": self.kernel_macros(),
            "twins": self.twin_places(), "public-calls": self.public_calls(), "forward": self.forward,
            "private-names": self.private_names(), "public-names": self.public_names(),
            "skipped-rooms": self.skipped_rooms(),
        }
        out = {what: (len(places), places) for what, places in lists.items()}
        n_lines = len(self.raw) - (self.raw[-1] == "")
        widest = max(range(len(self.raw)), key=lambda i: len(self.raw[i]))
        api = [Place(r.first, "room [%s] %s" % (r.number, r.name)) for r in self.rooms if r.name == "api"]
        out["lines"] = (n_lines, [Place(r.first, "room [%s] %s: %d lines" % (r.number, r.name, r.last - r.first + 1))
                                  for r in self.rooms])
        out["api"] = (self.lines_of("api"), api)
        out["median"] = (statistics.median_high(lengths) if lengths else 0, [])
        out["longest"] = (max(lengths, default=0), self.long()[:1])
        out["widest"] = (len(self.raw[widest]), [Place(widest + 1, "%d characters" % len(self.raw[widest]))])
        return out

    def table(self):
        yield "%-18s %6s %9s %7s %8s %7s %6s" % ("room", "lines", "functions", "median", "longest", "macros", "wide")
        wide = [p.line for p in self.wide()]
        for r in self.rooms:
            mine = [length(f) for f in self.functions if r.first <= f.first <= r.last]
            yield "%-18s %6d %9d %7s %8s %7d %6d" % (
                "[%s] %s" % (r.number, r.name[:13]), r.last - r.first + 1, len(mine),
                statistics.median_high(mine) if mine else "-", max(mine) if mine else "-",
                sum(r.first <= m.line <= r.last for m in self.macros), sum(r.first <= w <= r.last for w in wide))


def length(f):
    return f.last - f.first + 1


SUMMARY = {
    "lines": "lines in all", "api": "lines of room api", "median": "lines of the median function",
    "longest": "lines of the longest function", "long": "functions of more than 60 lines",
    "widest": "characters of the widest line", "wide": "lines of more than 110 characters",
    "wide-declarations": "public declarations of more than 100 characters",
    "arguments": "private functions with more than eight arguments", "macros": "function-like macros",
    "kernel-macros": "function-like macros in the kernels", "twins": "pairs of places that share six or more lines",
    "public-calls": "calls of public functions by statics", "forward": "forward declarations of statics",
    "private-names": "private names without hdi_ or HDI_", "public-names": "public names without hd_, HD_, HEATDIFF_",
    "skipped-rooms": "room numbers skipped or out of order",
}


def check(house, limits, path, most=40):
    """Lines that tell which limits are exceeded, with the places, and how many."""
    counts, said, broken = house.counts(), [], 0
    for what, limit in limits.items():
        number, places = counts[what]
        if number <= limit:
            if number < limit:
                said.append("note: %s is %d, its limit in tools/house.py can come down from %d" % (what, number, limit))
            continue
        broken += 1
        said.append("FAIL: %d %s, at most %d" % (number, SUMMARY[what], limit))
        said += ["  %s:%d: %s" % (path, p.line, p.text) for p in places[:most]]
        if len(places) > most:
            said.append("  and %d more: --list %s" % (len(places) - most, what))
    return said, broken


def tightened(source, counts):
    """The text of this file with lower limits where the counts allow them."""
    for what, limit in LIMITS.items():
        number = min(limit, counts[what][0])
        source = re.sub(r'( "%s": )\d+,( *)(?=#)' % what,
                        lambda m: (m.group(1) + "%d," % number).ljust(len(m.group()) - 2) + "  ", source)
    return source


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--file", default=os.path.join(TOP, "heatdiff.h"))
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--tighten", action="store_true")
    parser.add_argument("--list", metavar="WHAT", choices=list(LIMITS) + ["functions"])
    args = parser.parse_args(argv)
    with open(args.file, encoding="utf-8") as f:
        house = House(f.read())
    path = os.path.relpath(args.file)
    if args.list:
        places = ([Place(f.first, "%s: %d lines, %d arguments" % (f.name, length(f), f.arguments)) for f in house.functions]
                  if args.list == "functions" else house.counts()[args.list][1])
        for p in places:
            print("%s:%d: %s %s" % (path, p.line, house.room_of(p.line), p.text))
        return 0
    for line in house.table():
        print(line)
    print()
    counts = house.counts()
    for what, limit in LIMITS.items():
        print("%6d %s" % (counts[what][0], SUMMARY[what]))
    if args.tighten:
        with open(__file__, encoding="utf-8") as f:
            source = f.read()
        with open(__file__, "w", encoding="utf-8") as f:
            f.write(tightened(source, counts))
    if not args.check:
        return 0
    said, broken = check(house, LIMITS, path)
    print()
    print("\n".join(said + ["%d limits kept, %d exceeded" % (len(LIMITS) - broken, broken)]))
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
