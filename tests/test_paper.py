"""tools/paper: its page holds Table 1 and Figures 1 to 9, whole pictures, and only numbers that are numbers.

    python3 tests/test_paper.py PAPER       the program that CMake builds
"""
import base64
import csv
import html.parser
import math
import os
import re
import struct
import subprocess
import sys
import tempfile
import zlib

VOID = {"meta", "img", "br", "link"}


class Page(html.parser.HTMLParser):
    """Ids, pictures, drawings by figure, table cells, and whether all tags close."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.images, self.points, self.cells, self.open = [], {}, {}, [], []
        self.figure = None
        self.feed(text)
        assert not self.open, "not closed: %s" % self.open

    def handle_starttag(self, tag, attrs):
        self.handle_startendtag(tag, attrs)
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        attrs = dict(attrs)
        if "id" in attrs:
            self.ids.append(attrs["id"])
        if tag == "h2":
            self.figure = attrs.get("id")
        if tag == "img":
            self.images.setdefault(self.figure, []).append(attrs["src"])
        if tag == "polyline":
            self.points.setdefault(self.figure, []).append(attrs["points"])
        if tag == "path" and "transform" in attrs:
            at = re.findall(r"translate\(([^)]*)\)", attrs["transform"])
            self.points.setdefault(self.figure, []).extend(p.replace(" ", ",") for p in at)

    def handle_endtag(self, tag):
        assert self.open and self.open.pop() == tag, "closed, but not open: %s" % tag

    def handle_data(self, data):
        if self.open and self.open[-1] == "span":
            self.cells.append(data)


def check_png(source):
    """A whole PNG with more than one colour."""
    assert source.startswith("data:image/png;base64,"), source[:40]
    data = base64.b64decode(source.split(",", 1)[1], validate=True)
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        assert struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0] == zlib.crc32(kind + body)
        packed += body if kind == b"IDAT" else b""
        at += 12 + size
    assert len(set(zlib.decompress(packed))) > 50


def check_csv(path):
    figures = set()
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            figures.add(row["figure"])
            assert math.isfinite(float(row["x"])) and math.isfinite(float(row["y"])), row
    return figures


def check_bounds(path):
    """The default is far better than a few eigenpairs at small times, and the paper's set is as good as it says."""
    with open(path, newline="") as file:
        rows = [r for r in csv.DictReader(file) if r["figure"] == "fig-5"]
    small = min(float(r["x"]) for r in rows)
    at = {r["series"]: float(r["y"]) for r in rows if float(r["x"]) == small and r["of"].startswith("Ball")}
    assert at["default"] < 1e-6 < 1e-3 < at["100 eigenpairs"], at
    assert at["uniform, degree 7"] < at["uniform, degree 5"], at


def main():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.argv[1], "--quick", folder], check=True, stderr=subprocess.DEVNULL)
        assert sorted(os.listdir(folder)) == ["paper.csv", "paper.html"]
        with open(os.path.join(folder, "paper.html"), encoding="utf-8") as file:
            text = file.read()
        page = Page(text)
        figures = check_csv(os.path.join(folder, "paper.csv"))
        check_bounds(os.path.join(folder, "paper.csv"))
    assert len(page.ids) == len(set(page.ids))
    for number in range(1, 10):
        assert "fig-%d" % number in page.ids and "fig-%d" % number in figures, number
    assert "table-1" in page.ids and "table-1" in figures
    for number in (1, 2, 3, 4, 8):
        assert len(page.images["fig-%d" % number]) >= 2
    for images in page.images.values():
        for source in images:
            check_png(source)
    for number in (5, 6, 7, 9):
        points = page.points["fig-%d" % number]
        assert len(points) > 4
        for pair in " ".join(points).split():
            assert all(0 <= float(v) <= 480 for v in pair.split(",")), pair
    assert len(page.cells) > 150
    words = " ".join(page.cells) + re.sub(r"base64,[A-Za-z0-9+/=]*", "", text)
    assert not re.search(r"\b-?(nan|inf)\b", words, re.I), "a number is none"
    assert not re.search(r"(src|href)=\"(?!data:)", text), "the page needs something else"
    print("paper: %d pictures, %d curves, %d cells" % (sum(map(len, page.images.values())),
                                                      sum(map(len, page.points.values())), len(page.cells)))


if __name__ == "__main__":
    main()
