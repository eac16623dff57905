#!/usr/bin/env python3
"""What the pages say is what works: runs the code and the commands of README.md, examples/README.md, tools/README.md and
tests/README.md, and looks up every name in them.

    test_readme.py [CC [OBJECT]]    CC: the C compiler, by default cc; OBJECT: the implementation, compiled already
    test_readme.py [CC] --pictures  also puts the pictures that the commands make into examples/

The rules, the same for every page:

  C code     is read as the reader sees it, as C99 and as C++11, and run with the implementation that is compiled already.
  commands   of README.md and then examples/README.md run as a reader would run them, from top to bottom in one folder.
             `cc` stands for a script here: it takes the implementation out of a program and links the one that is
             compiled already, at -O1. The programs that CMakeLists.txt lists in hd_examples_timed are built and not run.
             Output that the page shows below a command must come, line by line, with numbers alike to 2 %. Numbers below
             1e-6, seconds and milliseconds may differ.
  others     A block that calls one of the programs in OTHERS needs packages or takes minutes, as do the measurements of
             tools/README.md and tests/README.md. Such commands are looked up instead: programs must compile, scripts must
             be there, and each must know the options it is given.
  pictures   exist and have at most 150 KB. Those that commands make are the same as those in the folder.
  names      hd_, HD_ and HEATDIFF_ names, options, files, links and headings must exist.
  sections   of tools/README.md that have a table of numbers begin with the command that prints it.
  length     README.md has at most 180 lines.

Needs Python 3, a C compiler, bash and awk."""
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import zlib

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PAGES = ["README.md", "examples/README.md", "tools/README.md", "tests/README.md"]
RUN = PAGES[:2]
OTHERS = ("cmake", "ctest", "python3", "mpicc", "mpirun", "bash", "gcc", "c++", "tools/", "tests/")
OUTSIDE = ("export", "mkdir", "paste", "mpirun", "qemu-system-arm", "valgrind")     # not ours to check
LENGTH, PICTURE_BYTES, ALIKE, SMALL = 180, 150000, 0.02, 1e-6
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?(?![\w])")
COMPILER = """#!/bin/bash
# cc ARGUMENTS: compiles each source without its implementation, at -O1, and links the one that is there
args=()
for a in "$@"; do
  case $a in
    *.c) sed '/^#define HEATDIFF_IMPLEMENTATION/d' "$a" >"{work}/$(basename "$a")"
         args+=(-I"$(dirname "$a")" "{work}/$(basename "$a")" "{work}/implementation.o") ;;
    -O2|-O3) args+=(-O1) ;;
    *) args+=("$a") ;;
  esac
done
exec "{cc}" -I"{top}" "${{args[@]}}"
"""

passed, failures = [], []


def check(good, page, what):
    (passed if good else failures).append("%s: %s" % (page, what))
    return good


def read(path):
    with open(os.path.join(TOP, path), encoding="utf-8") as f:
        return f.read()


def blocks(text):
    """(language, lines, the block of text right below or None) of every fenced block."""
    found = re.findall(r"^```(\w*)\n(.*?)^```$", text, re.S | re.M)
    places = [m.span() for m in re.finditer(r"^```(\w*)\n(.*?)^```$", text, re.S | re.M)]
    for k, (language, body) in enumerate(found):
        below = None
        if k + 1 < len(found) and found[k + 1][0] == "text" and places[k + 1][0] == places[k][1] + 1:
            below = found[k + 1][1]
        yield language, body, below


def commands(body):
    """The commands of a block: continued lines joined, comments left out."""
    for line in re.sub(r"\\\n", " ", body).splitlines():
        line = re.sub(r"(^|\s)#\s.*", "", line).strip()
        if line:
            yield line


def looked_up(page, body):
    return page not in RUN or any(c.startswith(OTHERS) or " mpirun " in " " + c for c in commands(body))


# ---- pictures ----

def pixels(path):
    """Width, height and bytes of a PNG with three bytes a pixel."""
    with open(path, "rb") as f:
        data = f.read()
    at, packed, size = 8, b"", None
    while at < len(data):
        n, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            size = struct.unpack(">IIBB", data[at + 8:at + 18])
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + n]
        at += 12 + n
    assert size[2:] == (8, 2), "not RGB"
    raw, width, rows, above = zlib.decompress(packed), 3 * size[0], [], bytearray(3 * size[0])
    for y in range(size[1]):
        kind, row = raw[y * (width + 1)], bytearray(raw[y * (width + 1) + 1:(y + 1) * (width + 1)])
        for x in range(width):
            a, b = row[x - 3] if x >= 3 else 0, above[x]
            c = above[x - 3] if x >= 3 else 0
            p = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            row[x] = (row[x] + (0, a, b, (a + b) // 2, p)[kind]) & 255
        rows.append(row)
        above = row
    return size[0], size[1], b"".join(rows)


def same_picture(one, other):
    with open(one, "rb") as f, open(other, "rb") as g:
        if f.read() == g.read():
            return True
    a, b = pixels(one), pixels(other)
    return a[:2] == b[:2] and sum(abs(x - y) for x, y in zip(a[2], b[2])) <= len(a[2])


# ---- commands that run ----

def alike(shown, said):
    """Whether a line of output is the one that the page shows."""
    if NUMBER.sub("#", shown).split() != NUMBER.sub("#", said).split():
        return False
    for a, b in zip(NUMBER.finditer(shown), NUMBER.finditer(said)):
        x, y = float(a.group()), float(b.group())
        if re.match(r" m?s\b", shown[a.end():]) or max(abs(x), abs(y)) < SMALL:
            continue
        if abs(x - y) > ALIKE * max(abs(x), abs(y)):
            return False
    return True


def check_output(page, shown, said):
    lines = iter(said.splitlines())
    for line in shown.splitlines():
        check(any(alike(line, other) for other in lines), page, "the output has no line `%s`" % line)


def run_commands(page, text, work, folder, timed, keep):
    environment = dict(os.environ, PATH=os.path.join(work, "bin") + os.pathsep + os.environ["PATH"])
    for language, body, below in blocks(text):
        if language != "sh" or looked_up(page, body):
            continue
        names = re.findall(r"examples/(\w+)\.c", body)
        slow = [n for n in names if n in timed]
        script = re.sub(r" && \./\w+", "", body) if slow else body
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", script], cwd=folder, env=environment, timeout=120,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
        if check(done.returncode == 0, page, "failed:\n%s%s" % (script, done.stderr)) and below and not slow:
            check_output(page, below, done.stdout)
        for name in re.findall(r"-o (\w+\.png)", body):
            made, kept = os.path.join(folder, name), os.path.join(TOP, "examples", name)
            if page != "examples/README.md":
                continue
            if keep:
                shutil.copyfile(made, kept)
            check(os.path.exists(kept) and same_picture(made, kept), page, "examples/%s is another picture" % name)


# ---- commands that are looked up ----

def options_of(text):
    """The options in a text, with their dashes or, as in the tables of tools/heatdiff.c, as strings without them."""
    return set(re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", text)) | set("--" + w for w in re.findall(r'"([a-z][a-z-]*)"', text))


def program_text(path):
    """The source of a program or script, and of the headers of tools/ and examples/ that it includes."""
    text = read(path)
    for name in re.findall(r'#include "(\w+\.h)"', text):
        here = os.path.join(os.path.dirname(path), name)
        text += read(here) if os.path.exists(os.path.join(TOP, here)) else ""
    return text


def look_up(page, text, cc, implementation):
    built = {"heatdiff": "tools/heatdiff.c"}            # programs, by the source they come from
    cmake, compiled = read("CMakeLists.txt"), set()
    alone = re.findall(r"hd_program_alone\(\w+ (\S+)", cmake)      # these use what is private in the implementation
    for name in re.findall(r"hd_program(?:_alone)?\((\w+) ", cmake):
        built.setdefault(name, "tools/%s.c" % name)
    built.update(runner="tests/runner.c", internals="tests/internals.c", fuzz="tests/fuzz/fuzz.c")
    tests = re.findall(r"add_test\(NAME (\w+)", cmake)
    for language, body, _ in blocks(text):
        if language != "sh" or not looked_up(page, body):
            continue
        for command in (c for line in commands(body) for c in re.split(r"\s(?:&&|\|)\s", line)):
            words = [w for w in command.split() if not re.match(r"^[A-Z_]+=", w)]
            options = [w.split("=")[0] for w in words[1:] if re.match(r"--?[a-zA-Z]", w)]
            files = [w for w in words if re.match(r"(?:\./)?(?:tools|tests|examples)/[\w./]+$", w)]
            for f in files:
                check(os.path.exists(os.path.join(TOP, f)), page, "there is no %s" % f)
            sources = [f for f in files if f.endswith(".c")]
            out = re.search(r" -o (\S+)", command)
            if words and re.search(r"(cc|\+\+)$", words[0]) and sources:
                if out:
                    built[out.group(1)] = sources[0]
                if words[0] in ("cc", "gcc") and sources[0] not in compiled:
                    compiled.add(sources[0])
                    flags = ["-std=gnu99", "-I.", "-fsyntax-only"] + [w for w in words if w.startswith("-D")]
                    if implementation and sources[0] not in alone and not sources[0].endswith("_shared.c"):
                        flags += ["-DHEATDIFF_IMPLEMENTED", "-DHDI_KERNELS_READ"]
                    good = subprocess.run([cc] + flags + sources[:1], cwd=TOP, stderr=subprocess.PIPE).returncode == 0
                    check(good, page, "%s does not compile" % sources[0])
            elif words and words[0] == "cmake":
                for d in re.findall(r"-D(HEATDIFF_\w+)=", command):
                    check(d in cmake, page, "CMakeLists.txt has no %s" % d)
                for t in re.findall(r"--target (\w+)", command):
                    check(re.search(r"\b%s\b" % t, cmake), page, "CMakeLists.txt has no target %s" % t)
            elif words and words[0] == "ctest":
                for r in re.findall(r" -R (\S+)", command):
                    check(any(re.search(r.strip("'\""), t) for t in tests), page, "no test is called %s" % r)
            elif words and words[0] not in OUTSIDE:
                program = os.path.basename(words[0])
                source = next((f for f in files if f.endswith((".py", ".sh"))), None)
                if not source and program in built:
                    source = built[program]
                if not check(source and os.path.exists(os.path.join(TOP, source)), page, "what is `%s`?" % command):
                    continue
                its = options_of(program_text(source)) if options else ()
                for option in options:
                    check(option in its, page, "%s does not know %s" % (source, option))
                if program == "runner":
                    groups = re.findall(r'\{"(\w+)", test_', read("tests/runner.c"))
                    for g in [w for w in words[1:] if re.match(r"[a-z_]+$", w)]:
                        check(any(g in name for name in groups), page, "runner has no group %s" % g)


# ---- names, links, lengths ----

def slug(heading):
    return re.sub(r"[^\w -]", "", heading.strip().lower()).replace(" ", "-")


def anchors(text):
    text = re.sub(r"^```.*?^```$", "", text, flags=re.S | re.M)
    return set(map(slug, re.findall(r"^#+ (.*)$", text, re.M))) | set(re.findall(r'<a id="([^"]+)">', text))


def check_links(page, text):
    folder = os.path.dirname(page)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"https?:", target):
            continue
        path, _, anchor = target.partition("#")
        path = os.path.normpath(os.path.join(folder, path)) if path else page
        if check(os.path.exists(os.path.join(TOP, path)), page, "broken link: %s" % target) and anchor:
            check(anchor in anchors(read(path)), page, "no such heading: %s" % target)
        if path.endswith((".png", ".svg")) and os.path.exists(os.path.join(TOP, path)):
            check(os.path.getsize(os.path.join(TOP, path)) <= PICTURE_BYTES, page, "%s is too large" % path)


def check_names(page, text, header, programs):
    """header: its words. programs: the options and the words of everything."""
    options, words = programs
    quoted = re.findall(r"`([^`\n]+)`", re.sub(r"^```.*?^```$", "", text, flags=re.S | re.M))
    for q in quoted:
        for name in re.findall(r"(?<![\w/.-])(?:hd|HD|HEATDIFF)_\w+", q):
            known = words if name.startswith("HEATDIFF") else header
            good = name in known or name.endswith("_") and any(w.startswith(name) for w in known)
            check(good, page, "there is no name %s" % name)
        for option in re.findall(r"(?<![\w-])--[a-z][\w-]*", q):
            check(option in options, page, "no program knows %s" % option)
        for path in re.findall(r"^(?:\.\./)?((?:tools|tests|examples)/[\w./]+)", q):
            check(any(os.path.exists(os.path.join(TOP, path + e)) for e in ("", ".c")), page, "there is no %s" % path)


def check_sections(page, text):
    text = re.sub(r"^```(\w*).*?^```$", r"```\1", text, flags=re.S | re.M)
    for section in re.split(r"^(?=##? )", text, flags=re.M)[2:]:
        heading = section.split("\n")[0]
        if re.search(r"^\|.*\d", section, re.M):
            check("```sh" in section, page, "no command under `%s`" % heading)


def sources():
    """The text of all programs, scripts and CMake files."""
    found = []
    for folder in ("tools", "tests", "tests/fuzz", "tests/consumer", "examples/web", "examples/embedded", "examples/python",
                   "examples/blender"):
        for name in sorted(os.listdir(os.path.join(TOP, folder))):
            if name.endswith((".c", ".cpp", ".h", ".py", ".sh")):
                found.append(read(folder + "/" + name))
    return "\n".join(found)


# ---- C code ----

def compiled(command, work, what):
    done = subprocess.run(command, cwd=work, stderr=subprocess.PIPE, universal_newlines=True)
    if not check(done.returncode == 0, "README.md", "%s\n%s" % (what, done.stderr)):
        sys.exit("%s: %s\n%s" % (" ".join(command), what, done.stderr))


def run_programs(cc, text, work, implementation):
    """Reads the program of the page as C and as C++; without its implementation it is linked to the one that is there."""
    code = [body for language, body, _ in blocks(text) if language == "c" and "int main" in body]
    check(len(code) == 1, "README.md", "has %d programs" % len(code))
    short = code[0].replace("#define HEATDIFF_IMPLEMENTATION\n", "")
    check(short != code[0], "README.md", "its program has no implementation")
    if not implementation:
        implementation = os.path.join(work, "whole.o")
        with open(os.path.join(work, "whole.c"), "w") as f:
            f.write("#define HEATDIFF_IMPLEMENTATION\n#include \"heatdiff.h\"\n")
        compiled([cc, "-std=c99", "-O1", "-I" + TOP, "-c", "whole.c", "-o", implementation], work, "heatdiff.h does not compile")
    shutil.copyfile(implementation, os.path.join(work, "implementation.o"))
    for name, standard in (("readme.c", ["-std=c99"]), ("readme.cpp", ["-x", "c++", "-std=c++11"])):
        for folder, body in (("", code[0]), ("short", short)):
            os.makedirs(os.path.join(work, folder), exist_ok=True)
            with open(os.path.join(work, folder, name), "w", encoding="utf-8") as f:
                f.write(body)
        warn, program = ["-Wall", "-Wextra", "-I" + TOP], os.path.join(work, name.replace(".", "_"))
        compiled([cc] + standard + warn + ["-fsyntax-only", name], work, "the program does not compile")
        compiled([cc] + standard + warn + ["-O1", "-c", "short/" + name, "-o", "short.o"], work, "the program does not compile")
        compiled([cc, "short.o", "implementation.o", "-o", program, "-lm", "-lstdc++"], work, "the program does not link")
        out = subprocess.run([program], stdout=subprocess.PIPE, universal_newlines=True, timeout=60)
        check(out.returncode == 0 and "error at most" in out.stdout, "README.md", "%s said %s" % (name, out.stdout))
        print("%s: %s" % (name, out.stdout.strip()))


def main():
    given = [a for a in sys.argv[1:] if not a.startswith("-")]
    cc, implementation = given[0] if given else "cc", given[1] if len(given) > 1 else None
    cc = shutil.which(cc) or sys.exit("there is no " + cc)      # a path: "cc" will be our own
    text = {page: read(page) for page in PAGES}
    header = read("heatdiff.h")
    everything = header + sources() + read("CMakeLists.txt")
    programs = options_of(everything), set(re.findall(r"\w+", everything))
    header = set(re.findall(r"\w+", header))
    timed = re.search(r"set\(hd_examples_timed ([^)]*)\)", read("CMakeLists.txt")).group(1).split()
    check(text["README.md"].count("\n") <= LENGTH, "README.md", "is longer than %d lines" % LENGTH)
    with tempfile.TemporaryDirectory() as work:
        run_programs(cc, text["README.md"], work, implementation)
        os.mkdir(os.path.join(work, "bin"))
        with open(os.path.join(work, "bin", "cc"), "w") as f:
            f.write(COMPILER.format(work=work, cc=cc, top=TOP))
        os.chmod(f.name, 0o755)
        folder = os.path.join(work, "project")
        os.mkdir(folder)
        for name in ("examples", "tools", "tests", "heatdiff.h"):
            os.symlink(os.path.join(TOP, name), os.path.join(folder, name))
        reader = threading.Thread(target=lambda: [look_up(page, text[page], cc, implementation) for page in PAGES])
        reader.start()
        for page in RUN:
            run_commands(page, text[page], work, folder, timed, "--pictures" in sys.argv)
        reader.join()
    for page in PAGES:
        check_links(page, text[page])
        check_names(page, text[page], header, programs)
    check_sections("tools/README.md", text["tools/README.md"])
    print("\n".join(failures + ["%d passed, %d failed" % (len(passed), len(failures))]))
    sys.exit(bool(failures))


if __name__ == "__main__":
    main()
