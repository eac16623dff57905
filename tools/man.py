#!/usr/bin/env python3
"""The man page of the command-line tool, from what the tool says of itself: one text, so that the two agree.

    man.py TOOL            writes heatdiff.1 beside this script, from TOOL --version, --help and COMMAND --help
    man.py --check TOOL    compares with the file that is there; exit 1 and the lines when they differ
"""
import difflib
import os
import re
import subprocess
import sys

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "heatdiff.1")
OPENING = """.\\" Made by tools/man.py from heatdiff --help: change that, not this.
.TH HEATDIFF 1 "" "heatdiff %s" "User Commands"
.SH NAME
heatdiff \\- heat diffusion kernels, signatures and distances on meshes and points
.SH SYNOPSIS
.nf
"""
DESCRIPTION = """.SH DESCRIPTION
Computes how heat spreads on a surface, without eigenvectors, and bounds the error of every answer.
.PP
"""


def say(tool, *args):
    return subprocess.run([tool] + list(args), check=True, stdout=subprocess.PIPE).stdout.decode().replace("\r", "")


def escaped(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\n".join("\\&" + line if line[:1] in (".", "'") else line for line in text.split("\n"))


def verbatim(text):
    return ".nf\n" + escaped(text.strip("\n")) + "\n.fi\n"


def sections(text):
    """[(title, body)] of a help text; what stands before the first title has the title ''."""
    parts, title, body = [], "", []
    for line in text.split("\n"):
        if re.fullmatch(r"[A-Z][a-z]+", line):
            parts.append((title, "\n".join(body)))
            title, body = line, []
        else:
            body.append(line)
    return parts + [(title, "\n".join(body))]


def page(tool):
    version = say(tool, "--version").split()[1]
    top = dict(sections(say(tool, "--help")))
    commands = re.findall(r"^  (\w+) ", top["Commands"], re.M)
    helps = [(name, say(tool, name, "--help")) for name in commands]
    uses = [re.search(r"^Use:  (.*)$", text, re.M).group(1) for _, text in helps]
    out = [OPENING % version, escaped("\n".join(uses + ["heatdiff [COMMAND] --help", "heatdiff --version"])), "\n.fi\n",
           DESCRIPTION, verbatim(top["Commands"])]
    examples, _, rest = top["Examples"].partition("\n\n")
    for name, text in helps:
        out.append(".SH %s\n" % name.upper())
        for title, body in sections(text):
            if title:
                out.append(".SS %s\n" % title + verbatim(body))
            else:
                about = body.partition("\n\n")[0].partition(" - ")[2]
                out.append(escaped(about[:1].upper() + about[1:]) + ".\n")    # the files stand below, once
    out += [".SH EXAMPLES\n", verbatim(examples), ".SH FILES AND EXIT STATUS\n", verbatim(rest)]
    return "".join(out)


def main():
    args = sys.argv[1:]
    check = args[:1] == ["--check"]
    if len(args) != 1 + check:
        sys.exit(__doc__)
    new = page(args[-1])
    if not check:
        open(PAGE, "w", encoding="utf-8").write(new)
        return
    old = open(PAGE, encoding="utf-8").read()
    if old != new:
        sys.stdout.writelines(difflib.unified_diff(old.splitlines(True), new.splitlines(True), "tools/heatdiff.1", "heatdiff --help"))
        sys.exit("heatdiff.1 does not say what heatdiff --help says; tools/man.py TOOL makes it anew")
    print("man page and help agree, version %s" % new.split("heatdiff ", 2)[2].split('"')[0])


if __name__ == "__main__":
    main()
