#!/usr/bin/env python3
"""Tests of tools/house.py on small made-up headers: test_house.py [unittest options]. Needs nothing but Python 3."""
import contextlib
import io
import os
import sys
import tempfile
import unittest
import unittest.mock

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(TOP, "tools"))
import house  # noqa: E402

HEADER = r"""/* small.h

   ==== [A] opening ====

   declarations [B] base, implementation [00] platform: no banners */
#ifndef SMALL_H
/* ==== [B] base ==== */
#ifdef __cplusplus
extern "C" {
#endif
#define HD_TWICE(x) (2 * (x))
typedef struct hd_c64 { double re, im; } hd_c64;
typedef enum hd_kind { HD_ONE = 0, HD_TWO } hd_kind;
typedef void (*hd_task)(void *arg, int index);
typedef struct hd_opaque hd_opaque;
HEATDIFF_API int hd_sum(const double *x,
                        int n);
HEATDIFF_API void hd_free(void *p);
#ifdef __cplusplus
}
#endif
#endif
#ifdef HEATDIFF_IMPLEMENTATION
/* ==== [00] platform ====
 * Owns nothing; static int hdi_in_comment(int a) { } */
#define HDI_INLINE inline
#define HDI_MAX(a, b) ((a) > (b) ? (a) : (b))
#define HDI_OBJECT (3)
#define HDI_LOOP(i)   \
    for (i = 0;       \
         i < 3; i++)
/* ==== [01] code ==== */
struct hd_opaque { int (*call)(int a, int b); };
static const double hdi_table[] = { 1, 2, 3 };
static HDI_INLINE int hdi_one(void) { return 1; }
static int
hdi_lines(int a,
          const char *b)   /* } */
{
    const char *s = "} { \" ;";
    char c = '{';
    return a + (b != s) + c; // }
}
#if defined(SOMETHING)
static int hdi_branch(int a) {
    if (a) {
#else
static int hdi_branch(int a) {
    {
#endif
        return a;
    }
}
/* ==== [03] api ==== */
HEATDIFF_API int hd_sum(const double *x, int n) { return hdi_one() + n + (x != 0); }
static int hdi_caller(int n) {
    /* hd_free(0); */
    return hd_sum(0, n);
}
"""


def of(text):
    return house.House(text)


def implementation(body):
    return of("#ifdef HEATDIFF_IMPLEMENTATION\n/* ==== [00] base ==== */\n" + body)


def names(places):
    return [p.text.split(":")[0].split(" ")[0] for p in places]


def texts(places):
    return [p.text for p in places]


NINE = "(int a, int b, int c, int d, int e, int f, int g, int h, int i) { }\n"
LINE = "    x++;\n"
# What a check finds in a header: the check, the header, the places by their text, name or line.
FOUND = (
    ("rooms and their lines", of(HEADER), lambda h: [(r.number, r.name) for r in h.rooms],
     [("A", "opening"), ("B", "base"), ("00", "platform"), ("01", "code"), ("03", "api")]),
    ("no line is in two rooms", of(HEADER), lambda h: sum(r.last - r.first + 1 for r in h.rooms), HEADER.count("\n") + 1 - 2),
    ("a banner may span lines", of("/* ==== [00] a ====\n * b */\n/* ==== [01] c ==== */\n/* == [02] d == */\n"),
     lambda h: len(h.rooms), 2),
    ("skipped rooms", of(HEADER), lambda h: texts(h.skipped_rooms()), ["no room [02]"]),
    ("rooms out of order", of("/* ==== [00] a ==== */\n/* ==== [02] b ==== */\n/* ==== [01] c ==== */"),
     lambda h: texts(h.skipped_rooms()), ["no room [01]", "room [01] comes after [02]"]),
    # from the first line of the signature to the brace
    ("functions", of(HEADER), lambda h: [(f.name, house.length(f)) for f in h.functions],
     [("hdi_one", 1), ("hdi_lines", 8), ("hdi_branch", 9), ("hd_sum", 1), ("hdi_caller", 4)]),
    ("function-like macros", of(HEADER), lambda h: names(h.macros), ["HD_TWICE", "HDI_MAX", "HDI_LOOP"]),
    ("public calls", of(HEADER), lambda h: texts(h.public_calls()), ["hdi_caller calls hd_sum"]),
    ("right names", of(HEADER), lambda h: h.private_names() + h.public_names(), []),
    ("a macro line before a function",
     implementation("HDI_MAKE(real)\nHDI_MAKE(lanes)\nstatic int hdi_a(int a) {\n    return a;\n}\n"),
     lambda h: [(f.name, house.length(f)) for f in h.functions], [("hdi_a", 3)]),
    ("no functions", implementation("struct hdi_s { int (*f)(int a); };\nstatic int (*hdi_v)(int) = 0;\n"
                                    "static int hdi_w[] = { HDI_A(1), sizeof(int) };\n"), lambda h: h.functions + h.forward, []),
    ("crowded, but for public functions", implementation("static void hdi_nine" + NINE + "HEATDIFF_API void hd_nine" + NINE),
     lambda h: names(h.crowded()), ["hdi_nine"]),
    ("long", implementation("static void hdi_long(void) {\n" + LINE * 59 + "}\nstatic void hdi_f(void) {\n" + LINE * 58 + "}\n"),
     lambda h: texts(h.long()), ["hdi_long: 61 lines"]),
    ("forward declarations", implementation(
        "static int hdi_later(int a,\n    int b);\nstruct hdi_s;\ntypedef int (*hdi_t)(int);\nHEATDIFF_API int hd_p(int a);\n"
        "extern void hdi_e(void);\nstatic void hdi_f(void) { hdi_later(1, 2); }\n"), lambda h: names(h.forward), ["hdi_later"]),
    ("private names", implementation("""
            #define BAD_MACRO 1
            #define HD_BAD(x) x
            #define HEATDIFF_MALLOC(n) malloc(n)
            typedef struct bad_tag { int fine; } hdi_t;
            typedef struct { int fine; } bad_type;
            enum { HDI_FINE = 1, BAD_CONSTANT = HDI_FINE, HDI_LAST };
            static const int bad_variable[2] = { 1, 2 }, hdi_variable = 3;
            static int bad_function(int fine) { int also_fine; return fine; }
            typedef int (*bad_callback)(int);
            extern void dgemm_(const char *fine);
        """), lambda h: names(h.private_names()),
     ["BAD_MACRO", "HD_BAD", "bad_tag", "bad_type", "BAD_CONSTANT", "bad_variable", "bad_function", "bad_callback"]),
    ("names that a macro completes", implementation("""
            #define HDI_JOIN_NOW(name, set) hdi_##name##_##set
            #define HDI_JOIN(name, set) HDI_JOIN_NOW(name, set)
            #define HDI_NAME(name) HDI_JOIN(name, HDI_SET)
            #define HDI_BARE(name) name
            static int HDI_NAME(fine)(int a) { return a; }
            static int HDI_BARE(bad)(int a) { return a; }
        """), lambda h: (names(h.private_names()), [f.name for f in h.functions]), (["bad"], ["hdi_fine", "bad"])),
    ("public names", of(
        "#define BAD 1\n#define HD_FINE 1\n#define HEATDIFF_API extern\ntypedef struct hd_a bad_a;\nenum { HD_X, bad_x };\n"
        "HEATDIFF_API int bad_f(int fine);\nHEATDIFF_API int hd_f(struct hd_a *fine);\n"),
     lambda h: names(h.public_names()), ["BAD", "bad_a", "bad_x", "bad_f"]),
    ("a public struct may be completed below", of(
        "typedef struct hd_a hd_a;\n#ifdef HEATDIFF_IMPLEMENTATION\nstruct hd_a { int x; };\nstruct hd_b { int x; };\n#endif\n"),
     lambda h: names(h.private_names()), ["hd_b"]),
    ("wide lines", of("/* " + "x" * 107 + "*/\nint a; " + "/*" + "x" * 103 + "\n*/\n"), lambda h: [(p.line, p.text) for p in h.wide()],
     [(1, "112 characters"), (2, "112 characters")]),
    ("characters, not bytes", of("\u00e9" * 110), lambda h: (len(h.raw[0]), h.wide()), (110, [])),
    ("a wide comment is no wide declaration", of("/* " + "\u00e9" * 105 + " */"), lambda h: h.wide_declarations(), []),
    ("declarations without their comments", of(
        "int " + "x" * 90 + ";          /* a comment */\nint " + "y" * 100 + ";\n#ifdef HEATDIFF_IMPLEMENTATION\nint " + "z" * 100 + ";\n"),
     lambda h: [p.line for p in h.wide_declarations()], [2]),
)
# Signatures, with the name and the number of arguments.
SIGNATURES = (
    ("static int hdi_a(void)", "hdi_a", 0), ("static int hdi_a()", "hdi_a",
                                             0), ("static int hdi_a(int a, int (*b)(int, int), double c[2][3])", "hdi_a", 3),
    ("static int hdi_a(int a, /* , */\n    int b)", "hdi_a", 2), ('__attribute__((target("avx2,fma"))) static int hdi_a(int a)',
                                                                  "hdi_a", 1),
    ('HDI_TARGET("avx2") static HDI_INLINE int *hdi_a(int a, int b)', "hdi_a", 2), ("static int HDI_NAME(hdi_a)(int a, int b)",
        "hdi_a", 2),
    ("static struct hdi_s hdi_a(const struct hdi_t *t)", "hdi_a", 1), ("static void (*hdi_a(int a))(int, int)", "hdi_a", 1))

BODY = ["    a%d = b[%d];" % (k, k) for k in range(8)]
SPREAD = [part for line in BODY for part in (line.replace(" = ", "="), "", "    /* another thought", "     */", "    }")]


def bodies(*runs):
    return "\n".join("static void hdi_%d(void) {\n%s\n}" % (q, "\n".join(run)) for q, run in enumerate(runs)) + "\n"


# Texts, and the lengths of the runs that they have twice.
TWINS = (
    ("six lines are a pair", bodies(BODY[:6], BODY[:6]), [6]), ("five are none", bodies(BODY[:5], BODY[:5]), []),
    ("three copies are three pairs", bodies(BODY, BODY, BODY), [8, 8, 8]), ("layout and comments do not hide a pair",
        bodies(BODY, SPREAD), [8]),
    ("continuations of macros do not either", "#define HDI_X(a)  \\\n" + "   \\\n".join(BODY) + "\n" + bodies(BODY), [8]),
    ("equal lines in a row do not overlap themselves", LINE * 11, []),
    ("strings tell lines apart", bodies(*(['    f(%d, "%s");' % (k, word) for k in range(6)] for word in ("one", "two"))), []))


class House(unittest.TestCase):
    def test_what_is_found(self):
        for what, h, look, want in FOUND:
            with self.subTest(what):
                self.assertEqual(look(h), want)

    def test_arguments(self):
        for text, name, arguments in SIGNATURES:
            with self.subTest(text):
                self.assertEqual([(f.name, f.arguments) for f in implementation(text + " {\n}\n").functions], [(name, arguments)])

    def test_twins(self):
        for what, text, want in TWINS:
            with self.subTest(what):
                self.assertEqual([t[4] for t in of(text).twins()], want)
        self.assertEqual(of(bodies(BODY, BODY)).twins(), [(2, 9, 12, 19, 8)])

    def test_limits(self):
        h = implementation("static int later(int a);\n")
        limits = dict.fromkeys(house.LIMITS, 1000)
        self.assertEqual(house.check(h, limits, "x.h")[1], 0)
        limits["forward"] = limits["private-names"] = 0
        said, broken = house.check(h, limits, "x.h")
        self.assertEqual(broken, 2)
        self.assertIn("  x.h:3: later", said)
        self.assertEqual(set(house.LIMITS), set(house.SUMMARY))
        self.assertEqual(set(house.LIMITS), set(of(HEADER).counts()))

    def test_tighten_lowers_and_never_raises(self):
        text = '    "lines": 20000,   # goal\n    "forward": 0,     # goal\n'
        counts = {what: (limit, []) for what, limit in house.LIMITS.items()}
        counts["lines"], counts["forward"] = (9000, []), (3, [])
        self.assertEqual(house.tightened(text, counts), '    "lines": 9000,    # goal\n    "forward": 0,     # goal\n')

    def run_main(self, text, *args):
        with tempfile.TemporaryDirectory() as d:
            path = os.path.join(d, "small.h")
            with open(path, "w", encoding="utf-8") as f:
                f.write(text)
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                return house.main(["--file", path] + list(args)), out.getvalue()

    @unittest.mock.patch.dict(house.LIMITS, {"skipped-rooms": 1, "public-calls": 1})   # HEADER has these
    def test_command_line(self):
        later = HEADER + "static int hdi_later(int a);\n"
        for text, args, code, word in ((HEADER, (), 0, "[03] api"), (HEADER, ("--check",), 0, ""), (later, ("--check",), 1,
            "hdi_later"),
                                       (HEADER, ("--list", "macros"), 0, "HDI_LOOP")):
            done, out = self.run_main(text, *args)
            self.assertEqual(done, code, out)
            self.assertIn(word, out)
        for text in ("", "}", "{", "/* open", "#if 1\n#else\n", "static int hdi_f(", '"open', "enum {", "typedef", "a(b"):
            self.assertEqual(self.run_main(text)[0], 0, text)        # broken files do not end it


if __name__ == "__main__":
    unittest.main()
