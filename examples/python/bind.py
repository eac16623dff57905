#!/usr/bin/env python3
"""bind.py - writes src/heatdiff/_bindings.py, the ctypes face of heatdiff.h, from the header's declarations

    bind.py            writes the file anew
    bind.py --check    exit status 1 if the file is not what the header says

tests/test_python.py also compares the file with what a compiler makes of the header, and so does not trust this script.
"""
import os
import re
import sys
import textwrap

HERE = os.path.dirname(os.path.abspath(__file__))
HEADER = os.path.join(HERE, "..", "..", "heatdiff.h")
TARGET = os.path.join(HERE, "src", "heatdiff", "_bindings.py")
PLAIN = {"int32_t": "c_int32", "int64_t": "c_int64", "uint64_t": "c_uint64", "uint16_t": "c_uint16", "size_t": "c_size_t",
         "double": "c_double", "float": "c_float", "char": "c_char", "int": "c_int"}
HEAD = '''"""The ctypes face of heatdiff.h: made by bind.py, changed by nobody."""
from ctypes import (CFUNCTYPE, POINTER, Structure, c_char, c_char_p, c_double, c_float, c_int, c_int32, c_int64, c_size_t,
                    c_uint16, c_uint64, c_void_p)
'''


def declarations(path):
    """The header up to its implementation, without comments and directives."""
    with open(path, encoding="utf-8") as f:
        text = f.read().split("#ifdef HEATDIFF_IMPLEMENTATION")[0]
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
    return text, re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*$", "", text, flags=re.M)


def enumerations(text, whole):
    """Name to {constant: value}; the enumeration without a name is ''."""
    found = {"hd_status": {name: int(value) for name, value in re.findall(r"X\((HD_\w+), (-?\d+),", whole)}}
    for body, name in re.findall(r"enum(?:\s+\w+)?\s*\{([^}]*)\}\s*(\w*)\s*;", text):
        value, of = 0, found.setdefault(name, {})
        for item in filter(None, (x.strip() for x in body.split(","))):
            m = re.match(r"(HD_\w+)\s*(?:=\s*(-?\w+))?$", item)
            if m and name != "hd_status":
                value = int(m.group(2), 0) if m.group(2) else value
                of[m.group(1)] = value
                value += 1
    return found


def choices(constants):
    """The names without what they have in common: {'direct': 2} for HD_METHOD_DIRECT."""
    names = list(constants)
    first = os.path.commonprefix(names)
    cut = first.rindex("_") + 1
    return {name[cut:].lower().replace("_", "-"): value for name, value in constants.items()}


class Binder:
    def __init__(self, path=HEADER):
        whole, text = declarations(path)
        self.text, self.enums = text, enumerations(text, whole)
        self.constants = {k: v for of in self.enums.values() for k, v in of.items()}
        self.version = ".".join(re.findall(r"#define HD_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", whole))
        self.status = re.findall(r"X\((HD_\w+), (-?\d+),\s*(?:\\\s*)?\"([^\"]*)\"\)", whole)
        self.callbacks, self.structs = {}, {}

    def kind(self, text):
        """The ctypes name of a C type, such as that of an argument without its name."""
        words = re.findall(r"\w+|\*", text)
        stars = words.count("*")
        (base,) = [w for w in words if w not in ("const", "struct", "*")]
        if base == "void":
            return {0: "None", 1: "c_void_p"}[stars]
        if base in self.callbacks or base in self.enums or base in PLAIN:
            of = base if base in self.callbacks else "c_int" if base in self.enums else PLAIN[base]
        else:
            of = base
            self.structs.setdefault(base, None)
        if of == "c_char" and stars:
            of, stars = "c_char_p", stars - 1
        return "POINTER(" * stars + of + ")" * stars

    def argument(self, text):
        """The type of `const double *x`; arrays do not occur."""
        return self.kind(re.match(r"(.*?)(\w+)$", text.strip(), re.S).group(1))

    def callback(self, result, arguments):
        return "CFUNCTYPE(%s)" % ", ".join([self.kind(result)] + [self.argument(a) for a in arguments.split(",")])

    def fields(self, body):
        """(name, type, enumeration or None) of each field."""
        for line in filter(None, (x.strip() for x in body.split(";"))):
            call = re.match(r"(.*?)\(\s*\*\s*(\w+)\s*\)\s*\((.*)\)$", line, re.S)
            if call:
                yield call.group(2), self.callback(call.group(1), call.group(3)), None
                continue
            base, rest = re.match(r"((?:const\s+|struct\s+)*\w+)\s*(.*)$", line, re.S).groups()
            for one in (x.strip() for x in rest.split(",")):
                stars, name, count = re.match(r"([*\s]*)(\w+)(?:\[([\w +]+)\])?$", one).groups()
                kind = self.kind(base + stars)
                if count:
                    kind += " * %d" % sum(int(self.constants.get(x.strip(), x)) for x in count.split("+"))
                yield name, kind, base.split()[-1] if base.split()[-1] in self.enums else None

    def made(self):
        lines = [HEAD, "VERSION = %r" % self.version, "STATUS = {"]
        lines += ["    %s: (%r, %r)," % (value, name, text) for name, value, text in self.status] + ["}", "", "CHOICES = {"]
        for name, constants in self.enums.items():
            if name and name != "hd_status":
                lines.append("    %r: %r," % (name, choices(constants)))
        lines += ["}", ""]
        for result, name, arguments in re.findall(r"typedef (\w+) \(\*(\w+)\)\(([^)]*)\);", self.text):
            made = self.callback(result, arguments)
            self.callbacks[name] = made
            lines.append("%s = %s" % (name, made))
        bodies = re.findall(r"typedef struct (\w+)\s*\{(.*?)\}\s*\1\s*;", self.text, re.S)
        made = {name: list(self.fields(body)) for name, body in bodies}
        functions = {}
        for head, name, arguments in re.findall(r"HEATDIFF_API\s+([\w\s*]*?)(\w+)\(([^)]*)\);", self.text):
            functions[name] = [self.kind(head)] + [self.argument(a) for a in arguments.split(",")]
        for name in self.structs:                       # those that the header does not define
            if name not in made:
                lines.append("%s = type(%r, (Structure,), {})" % (name, name))
        for name, fields in made.items():
            lines += ["", "", "class %s(Structure):" % name]
            enums = {field: kind for field, _, kind in fields if kind}
            lines.append("    choices = %r" % enums if enums else "    choices: dict = {}")
        lines.append("")
        for name, fields in made.items():
            lines += ["", "%s._fields_ = [" % name]
            lines += ["    (%r, %s)," % (field, kind) for field, kind, _ in fields] + ["]"]
        lines += ["", "# name: result, arguments", "FUNCTIONS = {"]
        for name, types in functions.items():
            row = "    %r: (%s)," % (name, ", ".join(types))
            lines += textwrap.wrap(row, 118, subsequent_indent="        ", break_long_words=False)
        return "\n".join(lines + ["}"]) + "\n"


def main():
    made = Binder().made()
    if sys.argv[1:] == ["--check"]:
        with open(TARGET, encoding="utf-8") as f:
            if f.read() != made:
                sys.exit("%s is not what heatdiff.h says: run examples/python/bind.py" % os.path.relpath(TARGET))
    else:
        with open(TARGET, "w", encoding="utf-8") as f:
            f.write(made)


if __name__ == "__main__":
    main()
