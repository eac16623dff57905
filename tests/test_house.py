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


class Reading(unittest.TestCase):
    def setUp(self):
        self.house = of(HEADER)

    def test_rooms(self):
        self.assertEqual([(r.number, r.name) for r in self.house.rooms],
                         [("A", "opening"), ("B", "base"), ("00", "platform"), ("01", "code"), ("03", "api")])
        self.assertEqual(sum(r.last - r.first + 1 for r in self.house.rooms), HEADER.count("\n") + 1 - 2)

    def test_a_banner_that_spans_lines_and_one_that_does_not_are_both_rooms(self):
        self.assertEqual(len(of("/* ==== [00] a ====\n * b */\n/* ==== [01] c ==== */\n/* == [02] d == */\n").rooms), 2)

    def test_skipped_rooms(self):
        self.assertEqual([p.text for p in self.house.skipped_rooms()], ["no room [02]"])
        self.assertEqual([p.text for p in of("/* ==== [00] a ==== */\n/* ==== [02] b ==== */\n/* ==== [01] c ==== */").skipped_rooms()],
                         ["no room [01]", "room [01] comes after [02]"])

    def test_functions(self):
        self.assertEqual([f.name for f in self.house.functions],
                         ["hdi_one", "hdi_lines", "hdi_branch", "hd_sum", "hdi_caller"])

    def test_length_runs_from_the_first_line_of_the_signature_to_the_brace(self):
        f = {f.name: f for f in self.house.functions}
        self.assertEqual(house.length(f["hdi_one"]), 1)
        self.assertEqual(house.length(f["hdi_lines"]), 8)
        self.assertEqual(HEADER.split("\n")[f["hdi_lines"].last - 1], "}")

    def test_function_like_macros(self):
        self.assertEqual(names(self.house.macros), ["HD_TWICE", "HDI_MAX", "HDI_LOOP"])

    def test_public_calls(self):
        self.assertEqual([p.text for p in self.house.public_calls()], ["hdi_caller calls hd_sum"])

    def test_names_are_right_here(self):
        self.assertEqual(self.house.private_names(), [])
        self.assertEqual(self.house.public_names(), [])


class Functions(unittest.TestCase):
    def arguments(self, signature):
        functions = implementation(signature + " {\n}\n").functions
        self.assertEqual(len(functions), 1, signature)
        return functions[0].name, functions[0].arguments

    def test_arguments(self):
        self.assertEqual(self.arguments("static int hdi_a(void)"), ("hdi_a", 0))
        self.assertEqual(self.arguments("static int hdi_a()"), ("hdi_a", 0))
        self.assertEqual(self.arguments("static int hdi_a(int a, int (*b)(int, int), double c[2][3])"), ("hdi_a", 3))
        self.assertEqual(self.arguments("static int hdi_a(int a, /* , */\n    int b)"), ("hdi_a", 2))

    def test_names_behind_attributes_and_macros(self):
        self.assertEqual(self.arguments('__attribute__((target("avx2,fma"))) static int hdi_a(int a)'), ("hdi_a", 1))
        self.assertEqual(self.arguments('HDI_TARGET("avx2") static HDI_INLINE int *hdi_a(int a, int b)'), ("hdi_a", 2))
        self.assertEqual(self.arguments("static int HDI_NAME(hdi_a)(int a, int b)"), ("hdi_a", 2))
        self.assertEqual(self.arguments("static struct hdi_s hdi_a(const struct hdi_t *t)"), ("hdi_a", 1))
        self.assertEqual(self.arguments("static void (*hdi_a(int a))(int, int)"), ("hdi_a", 1))

    def test_a_macro_line_before_a_function_is_no_part_of_it(self):
        f = implementation("HDI_MAKE(real)\nHDI_MAKE(lanes)\nstatic int hdi_a(int a) {\n    return a;\n}\n").functions
        self.assertEqual([(x.name, house.length(x)) for x in f], [("hdi_a", 3)])

    def test_no_functions(self):
        text = "struct hdi_s { int (*f)(int a); };\nstatic int (*hdi_v)(int) = 0;\nstatic int hdi_w[] = { HDI_A(1), sizeof(int) };\n"
        self.assertEqual(implementation(text).functions, [])
        self.assertEqual(implementation(text).forward, [])

    def test_crowded_leaves_public_functions_alone(self):
        nine = "(int a, int b, int c, int d, int e, int f, int g, int h, int i) { }\n"
        h = implementation("static void hdi_nine" + nine + "HEATDIFF_API void hd_nine" + nine)
        self.assertEqual(names(h.crowded()), ["hdi_nine"])

    def test_long(self):
        h = implementation("static void hdi_long(void) {\n" + "    x++;\n" * 59 + "}\nstatic void hdi_short(void) {\n" + "    x++;\n" * 58 + "}\n")
        self.assertEqual([p.text for p in h.long()], ["hdi_long: 61 lines"])

    def test_forward_declarations(self):
        h = implementation("static int hdi_later(int a,\n    int b);\nstruct hdi_s;\ntypedef int (*hdi_t)(int);\n"
                           "HEATDIFF_API int hd_p(int a);\nextern void hdi_e(void);\nstatic void hdi_f(void) { hdi_later(1, 2); }\n")
        self.assertEqual(names(h.forward), ["hdi_later"])


class Names(unittest.TestCase):
    def test_private(self):
        h = implementation("""
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
        """)
        self.assertEqual(names(h.private_names()), ["BAD_MACRO", "HD_BAD", "bad_tag", "bad_type", "BAD_CONSTANT", "bad_variable",
                                                    "bad_function", "bad_callback"])

    def test_names_that_a_macro_completes(self):
        h = implementation("""
            #define HDI_JOIN_NOW(name, set) hdi_##name##_##set
            #define HDI_JOIN(name, set) HDI_JOIN_NOW(name, set)
            #define HDI_NAME(name) HDI_JOIN(name, HDI_SET)
            #define HDI_BARE(name) name
            static int HDI_NAME(fine)(int a) { return a; }
            static int HDI_BARE(bad)(int a) { return a; }
        """)
        self.assertEqual(names(h.private_names()), ["bad"])
        self.assertEqual([f.name for f in h.functions], ["hdi_fine", "bad"])

    def test_public(self):
        h = of("#define BAD 1\n#define HD_FINE 1\n#define HEATDIFF_API extern\ntypedef struct hd_a bad_a;\nenum { HD_X, bad_x };\n"
               "HEATDIFF_API int bad_f(int fine);\nHEATDIFF_API int hd_f(struct hd_a *fine);\n")
        self.assertEqual(names(h.public_names()), ["BAD", "bad_a", "bad_x", "bad_f"])

    def test_a_public_struct_may_be_completed_below(self):
        h = of("typedef struct hd_a hd_a;\n#ifdef HEATDIFF_IMPLEMENTATION\nstruct hd_a { int x; };\nstruct hd_b { int x; };\n#endif\n")
        self.assertEqual(names(h.private_names()), ["hd_b"])


class Lines(unittest.TestCase):
    def test_wide(self):
        h = of("/* " + "x" * 107 + "*/\nint a; " + "/*" + "x" * 103 + "\n*/\n")
        self.assertEqual([(p.line, p.text) for p in h.wide()], [(1, "112 characters"), (2, "112 characters")])

    def test_width_counts_characters(self):
        self.assertEqual(of("/* " + "\u00e9" * 105 + " */").wide_declarations(), [])
        self.assertEqual(len(of("\u00e9" * 110).raw[0]), 110)
        self.assertEqual(of("\u00e9" * 110).wide(), [])

    def test_declarations_without_their_comments(self):
        h = of("int " + "x" * 90 + ";          /* a comment */\nint " + "y" * 100 + ";\n#ifdef HEATDIFF_IMPLEMENTATION\nint " + "z" * 100 + ";\n")
        self.assertEqual([p.line for p in h.wide_declarations()], [2])


class Twins(unittest.TestCase):
    BODY = ["    a%d = b[%d];" % (k, k) for k in range(8)]

    def text(self, *runs):
        return "\n".join("static void hdi_%d(void) {\n%s\n}" % (q, "\n".join(run)) for q, run in enumerate(runs)) + "\n"

    def test_six_lines_are_a_pair_and_five_are_none(self):
        self.assertEqual(len(of(self.text(self.BODY[:6], self.BODY[:6])).twins()), 1)
        self.assertEqual(of(self.text(self.BODY[:5], self.BODY[:5])).twins(), [])

    def test_a_run_is_reported_once_with_its_lines(self):
        self.assertEqual(of(self.text(self.BODY, self.BODY)).twins(), [(2, 9, 12, 19, 8)])

    def test_three_copies_are_three_pairs(self):
        self.assertEqual(len(of(self.text(self.BODY, self.BODY, self.BODY)).twins()), 3)

    def test_layout_and_comments_do_not_hide_a_pair(self):
        other = []
        for line in self.BODY:
            other += [line.replace(" = ", "="), "", "    /* another thought", "     */", "    }"]
        self.assertEqual([t[4] for t in of(self.text(self.BODY, other)).twins()], [8])

    def test_the_continuations_of_macros_do_not_hide_a_pair(self):
        macro = "#define HDI_X(a)  \\\n" + "   \\\n".join(self.BODY) + "\n"
        self.assertEqual(len(of(macro + self.text(self.BODY)).twins()), 1)

    def test_equal_lines_in_a_row_do_not_overlap_themselves(self):
        self.assertEqual(of("    x++;\n" * 11).twins(), [])

    def test_strings_tell_lines_apart(self):
        a, b = (['    f(%d, "%s");' % (k, s) for k in range(6)] for s in ("one", "two"))
        self.assertEqual(of(self.text(a, b)).twins(), [])


class Check(unittest.TestCase):
    def test_limits(self):
        h = implementation("static int later(int a);\n")
        limits = dict.fromkeys(house.LIMITS, 1000)
        self.assertEqual(house.check(h, limits, "x.h")[1], 0)
        limits["forward"] = limits["private-names"] = 0
        said, broken = house.check(h, limits, "x.h")
        self.assertEqual(broken, 2)
        self.assertIn("  x.h:3: later", said)

    def test_every_limit_is_counted_and_explained(self):
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
        code, out = self.run_main(HEADER)
        self.assertEqual(code, 0)
        self.assertIn("[03] api", out)
        self.assertEqual(self.run_main(HEADER, "--check")[0], 0)
        code, out = self.run_main(HEADER + "static int hdi_later(int a);\n", "--check")
        self.assertEqual(code, 1)
        self.assertIn("hdi_later", out)
        self.assertIn("HDI_LOOP", self.run_main(HEADER, "--list", "macros")[1])

    def test_empty_and_broken_files_do_not_end_it(self):
        for text in ("", "}", "{", "/* open", "#if 1\n#else\n", "static int hdi_f(", '"open', "enum {", "typedef", "a(b"):
            self.assertEqual(self.run_main(text)[0], 0, text)


if __name__ == "__main__":
    unittest.main()
