/* test_meshio.h - the readers and writers of tools/meshio.h

   The runner defines CHECK and CHECK_MSG and test_tmp_dir() before including this. Every file is made here. */

#ifndef TEST_MESHIO_H
#define TEST_MESHIO_H

#include "../tools/meshio.h"

/* ---- files ---- */

/* The path of a file in the temporary folder; good until eight calls later. */
static const char *tmio_path(const char *name) {
    static char paths[8][1024];
    static int next;
    char *const path = paths[next++ & 7];
    snprintf(path, sizeof paths[0], "%s/%s", test_tmp_dir(), name);
    return path;
}

static void tmio_put(const char *path, const void *data, size_t size) {
    FILE *const f = fopen(path, "wb");
    CHECK_MSG(f && fwrite(data, 1, size, f) == size, "cannot make %s", path);
    if (f) fclose(f);
}

/* Reads a small file; returns its size, or 0 when it is not there. buf gets a zero at the end. */
static size_t tmio_get(const char *path, char *buf, size_t room) {
    FILE *const f = fopen(path, "rb");
    size_t n = 0;
    if (f) {
        n = fread(buf, 1, room - 1, f);
        fclose(f);
    }
    buf[n] = 0;
    return n;
}

static int tmio_exists(const char *path) {
    FILE *const f = fopen(path, "rb");
    if (f) fclose(f);
    return f != NULL;
}

/* What a file holds: bytes. */
typedef struct tmio_bytes { char b[8192]; size_t n; } tmio_bytes;

static void tmio_add(tmio_bytes *t, const void *data, size_t size) {
    if (!CHECK(t->n + size <= sizeof t->b)) return;
    memcpy(t->b + t->n, data, size);
    t->n += size;
}

/* Adds one number: an integer of 1, 2, 4 or 8 bytes (b, h, i, q) or a float of 4 or 8 (f, d). Returns where it ends. */
static const char *tmio_add_number(tmio_bytes *t, const char *number, int type, int big) {
    char *end;
    const int size = type == 'b' ? 1 : type == 'h' ? 2 : type == 'i' || type == 'f' ? 4 : 8;
    int i;
    uint64_t u = 0;
    if (type == 'f' || type == 'd') {
        const double x = strtod(number, &end);
        const float y = (float)x;
        uint32_t half;
        memcpy(&half, &y, 4);
        memcpy(&u, &x, 8);
        if (type == 'f') u = half;
    } else u = (uint64_t)strtoll(number, &end, 10);
    CHECK_MSG(end > number, "not a number: %s", number);
    for (i = 0; i < size; i++) {
        const unsigned char c = (unsigned char)(u >> 8 * (big ? size - 1 - i : i) & 255);
        tmio_add(t, &c, 1);
    }
    return end > number ? end : number + strlen(number);
}

/* Adds numbers by a list such as "b 3 i 0 1 2": types before their numbers. > and <: the largest byte comes first, or last.
 * @80: zeros up to byte 80. */
static void tmio_add_numbers(tmio_bytes *t, const char *list, const char *end) {
    int type = 'b', big = 0;
    while (list < end) {
        const char c = *list;
        if (c == '@') {
            const size_t to = (size_t)strtol(list + 1, NULL, 10);
            while (t->n < to) tmio_add(t, "", 1);
            list += 1 + strspn(list + 1, "0123456789");
        } else if (c == '<' || c == '>') {
            big = c == '>';
            list++;
        } else if (strchr("bhiqfd", c) && list[1] == ' ') type = *list++;
        else if (c == ' ') list++;
        else list = tmio_add_number(t, list, type, big);
    }
}

/* A file from a text, in which form feeds stand before and after lists of numbers. `npy1 {...}` makes the head of a .npy file. */
static const tmio_bytes *tmio_make(const char *text) {
    static tmio_bytes files[2];
    static int next;
    tmio_bytes *const t = files + (next++ & 1);
    const char *stop;
    int numbers = 0;
    t->n = 0;
    if (strncmp(text, "npy", 3) == 0) {
        char size[32];
        stop = text + strcspn(text, "\f");
        snprintf(size, sizeof size, "b %c 0 %c %d", text[3], text[3] == '1' ? 'h' : 'i', (int)(stop - text - 4));
        tmio_add(t, "\x93NUMPY", 6);
        tmio_add_numbers(t, size, size + strlen(size));
        text += 4;
    }
    for (;; text = stop + 1, numbers = !numbers) {
        stop = text + strcspn(text, "\f");
        if (numbers) tmio_add_numbers(t, text, stop);
        else tmio_add(t, text, (size_t)(stop - text));
        if (!*stop) return t;
    }
}

/* ---- what a reader makes of a file, as text ---- */

typedef enum tmio_kind { TMIO_MESH, TMIO_TABLE, TMIO_FIELD } tmio_kind;

static void tmio_say(char *to, const char *what, double x) {
    char number[40];
    snprintf(number, sizeof number, x != x ? "nan" : fabs(x) > DBL_MAX ? x > 0 ? "inf" : "-inf" : "%.15g", x);
    strcat(strcat(to, what), number);
}

/* FORMAT: coordinates of each vertex | corners of each face | faces left out, if any. */
static void tmio_say_mesh(char *to, const mio_mesh *m) {
    int32_t i;
    int64_t k;
    strcat(strcat(to, m->format), ":");
    for (i = 0; i < 3 * m->n; i++) tmio_say(to, i > 0 && i % 3 == 0 ? ", " : " ", m->xyz[i]);
    for (i = 0; i < m->n_faces; i++)
        for (k = m->face_ptr[i]; k < m->face_ptr[i + 1]; k++)
            tmio_say(to, k > m->face_ptr[i] ? " " : i > 0 ? ", " : " | ", m->face_idx[k]);
    if (m->n_small_faces) tmio_say(to, " | ", (double)m->n_small_faces);
}

/* Loads a file, and tells its contents or the error. On failure nothing may be left. */
static int tmio_read(const char *name, const tmio_bytes *t, tmio_kind kind, char said[2000]) {
    const char *const path = tmio_path(name);
    mio_mesh m;
    mio_error e;
    double *v = NULL;
    int64_t rows = 0, *lines = NULL, i;
    int32_t cols = 0;
    int status;
    tmio_put(path, t->b, t->n);
    said[0] = e.text[0] = 0;
    memset(&m, 0, sizeof m);
    if (kind == TMIO_MESH) status = mio_load(&m, path, NULL, &e);
    else if (kind == TMIO_TABLE) status = mio_load_table_lines(&v, &rows, &cols, &lines, path, NULL, &e);
    else status = mio_load_field(&v, &rows, &cols, path, NULL, &e);
    remove(path);
    if (status != MIO_OK) {
        CHECK(!m.n && !m.xyz && !m.face_ptr && !m.face_idx && !v && !lines && !strchr(e.text, '\n'));
        strcat(said, e.text);
    } else if (kind == TMIO_MESH) {
        CHECK(m.face_ptr && m.face_ptr[0] == 0);
        tmio_say_mesh(said, &m);
    } else {
        tmio_say(said, "", (double)rows);
        tmio_say(said, " x ", cols);
        for (i = 0; i < rows * cols; i++) tmio_say(said, i > 0 ? " " : ": ", v[i]);
        for (i = 0; lines && i < rows; i++) tmio_say(said, i > 0 ? " " : " | ", (double)lines[i]);
    }
    free(v);
    free(lines);
    mio_free(&m);
    return status;
}

/* line 0: the message has none. It must begin with file and line, and contain what is said here. */
typedef struct tmio_bad { const char *name, *text; int line; const char *says; } tmio_bad;

static void tmio_check_bad(const tmio_bad *bad, size_t n, tmio_kind kind) {
    char said[2000], begin[80];
    for (; n > 0; n--, bad++) {
        const int status = tmio_read(bad->name, tmio_make(bad->text), kind, said);
        snprintf(begin, sizeof begin, bad->line ? "/%s:%d: " : "/%s: ", bad->name, bad->line);
        CHECK_MSG(status == MIO_FAILED && strstr(said, begin) && strstr(said, bad->says), "expected %s and '%s', got: %s", begin, bad->says, said);
    }
}

/* holds: all of it, as above. */
typedef struct tmio_good { const char *name, *text, *holds; } tmio_good;

static void tmio_check_good(const tmio_good *good, size_t n, tmio_kind kind) {
    char said[2000];
    for (; n > 0; n--, good++) {
        CHECK_MSG(tmio_read(good->name, tmio_make(good->text), kind, said) == MIO_OK, "%s: %s", good->name, said);
        CHECK_MSG(strcmp(said, good->holds) == 0, "%s holds '%s', not '%s'", good->name, said, good->holds);
    }
}

#define TMIO_BAD(rows, kind) tmio_check_bad(rows, sizeof rows / sizeof *rows, kind)
#define TMIO_GOOD(rows, kind) tmio_check_good(rows, sizeof rows / sizeof *rows, kind)

/* ---- numbers ---- */

static void tmio_test_numbers(void) {
    static const char *const good[] = {
        "0", "-0", "1", "+1", "1.", ".5", "-.5e1", "00012.50", "1e5", "1E+5", "1e-5", "0.1", "0.35444599999999998", "123456789012345678",
        "9007199254740993", "9007199254740993e-3", "9007199254740993e5", "1.7976931348623157e308", "4.9e-324",
        "2.2250738585072011e-308", "1e-400", "0e999999999999", "0.1000000000000000055511151231257827021181583404541015625",
        "9999999999999999999e22", "9999999999999999999e-22", "18446744073709551615", "8.5e-21", "100000000000000000000000000000000",
        "0.000000000000000000000000000000000001", "6929495644600919.5", "3.1415926535897932384626433832795028841971"};
    static const char *const bad[] = {"", "-", "+", ".", "e5", "-.e5", "1e", "1e+", "nan", "inf", "x1", "--1"};
    static char small[100100];
    uint64_t seed = 88172645463325252u;
    size_t i;
    int k;
    char text[64];
    double x;
    for (i = 0; i < sizeof good / sizeof *good; i++) {
        const double want = strtod(good[i], NULL);
        const char *const end = mio_number(good[i], &x);
        CHECK_MSG(end && !*end && memcmp(&x, &want, sizeof x) == 0, "%s: %.17g", good[i], x);
    }
    for (i = 0; i < sizeof bad / sizeof *bad; i++) CHECK_MSG(!mio_number(bad[i], &x), "'%s' is no number", bad[i]);
    for (k = 0; k < 100000; k++) {              /* correct rounding, where the quick way is tried and near where it is not */
        double want;
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        snprintf(text, sizeof text, "%llue%d", (unsigned long long)(seed >> seed % 50), (int)(seed % 53) - 26);
        want = strtod(text, NULL);
        (void)mio_number(text, &x);
        if (x != want && !CHECK_MSG(0, "%s: %.17g, not %.17g", text, x, want)) break;
    }
    memset(small, '0', sizeof small);            /* 100,000 digits */
    memcpy(small, "0.", 2);
    memcpy(small + sizeof small - 3, "17", 3);
    CHECK(mio_number(small, &x) == small + sizeof small - 1 && x == 0);
}

/* ---- meshes as text ---- */

#define OBJ3 "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
#define TRIANGLE " 0 0 0, 1 0 0, 0 1 0 | 0 1 2"

static void tmio_test_obj(void) {
    static const tmio_good good[] = {
        {"a.obj", "# c\nmtllib x.mtl\no thing\nv 0 0 0\nv 1 0 0 0.5\nv 1 1 0 0.1 0.2 0.3\nvt 0 0\nvn 0 0 1\nv 0 1 0 # end\n"
                  "g a b\nusemtl m\ns off\nf 1 2 3\nf 1/1 2/2 3/3 4/4\nf 1//1 3//1 4//1\nf 1/1/1 2/1/1 3/1/1\nf -4 -3 -2\nl 1 2\np 1\n"
                  "what ever\nf 1 2\nf 3\nf\n", "OBJ: 0 0 0, 1 0 0, 1 1 0, 0 1 0 | 0 1 2, 0 1 2 3, 0 2 3, 0 1 2, 0 1 2 | 3"},
        {"b.obj", "f 1 2 3\r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf -1 -3 \\\r\n  -2\r\nv 1 \\\n2 3",     /* forward, joined */
            "OBJ: 0 0 0, 1 0 0, 0 1 0, 1 2 3 | 0 1 2, 2 0 1"},
        {"c.obj", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r", "OBJ:" TRIANGLE},
        {"d.obj", "\t v\t0 0\t0  \n  v 1 0 0\nv 0 1 0\n f  1  2  3  ", "OBJ:" TRIANGLE},
        {"e.obj", "\357\273\277v 0 0 0\nv 1 0 0\n", "OBJ: 0 0 0, 1 0 0"},
        {"f.obj", "v 1e0 -1.5E-3 +2\nv .5 5. 0\nv 0 0 0#c\nf 1 2 3#c\n", "OBJ: 1 -0.0015 2, 0.5 5 0, 0 0 0 | 0 1 2"},
        {"a.obj", OBJ3 "fo 1 2 3\n", "OBJ:" TRIANGLE}, {"a.obj", OBJ3 "fog 1 2 3\nf 1 2 3\n", "OBJ:" TRIANGLE},
        {"a.obj", OBJ3 "f 1 2 3\nf", "OBJ:" TRIANGLE " | 1"},
        {"a", "about\nv\t1 2 3\nf\t1 1 1\n", "OBJ: 1 2 3 | 0 0 0"}};          /* the second line tells */
    static const tmio_bad bad[] = {
        {"x.obj", OBJ3 "f 1 2 3\nf 1 2 99999999\n", 5, "99999999"}, {"x.obj", OBJ3 "f 1 2 4\nv 0 0\n", 5, "3 coordinates"},
        {"x.obj", OBJ3 "f 1 2 99999999999999999999\nf 1 2 5", 4, "9999999999"}, {"x.obj", OBJ3 "f 1 2 0\n", 4, "index 0"},
        {"x.obj", OBJ3 "\nf 1 2 -4\n", 5, "-4"}, {"x.obj", OBJ3 "f 1 2 9\n", 4, "3 vertices"},
        {"x.obj", OBJ3 "f 1 2\nf 1 9\n", 5, "9"}, {"x.obj", OBJ3 "f 1 2 3x\n", 4, "'3x'"},
        {"x.obj", OBJ3 "f 1 2 1.5\n", 4, "'1.5'"}, {"x.obj", "v 0 0 0\r\nv nan 0 0\r\n", 2, "'nan' is not a finite"},
        {"x.obj", "v 0 0 0\rv 0 -Infinity 0\r", 2, "'-Infinity' is not a finite"},
        {"x.obj", "v 0 0 1e999\n", 1, "'1e999' is too large"},
        {"x.obj", "v 0 0 0\nv 1 0 \\\n 0\nv 0 \001two\200 0", 4, "'?two?' is not a number"},
        {"x.obj", "v 0 0 0\nv 1 0 0\nv 0 1\nf 1 2 3\n", 3, "this line has 2"}, {"x.obj", "v 0 0 0\nv", 2, "this line has 0"},
        {"x.obj", "v 0 0 0\nv 0 1 # 2\n", 2, "this line has 2"}, {"x.obj", "v 0 0 0x10\n", 1, "'0x10'"},
        {"x.obj", "v 0 0 1234567890123456789012345678901234567890123456789x\n", 1, "'1234567890123456789012345678901234567...'"},
        {"x.obj", "# nothing here\n", 0, "no vertices found"}, {"x.obj", "f 1 2 3\n", 0, "no vertices found"},
        {"x.obj", "", 0, "no vertices found"}, {"x.dat", "", 0, "no vertices found"},
        {"x.obj", "v 0 0 \fb 0\f 1\n\fb 0", 1, "'?' is not a number"}, {"x.obj", "v nab 0 0\nv 1 0 0\nf 1 2 1\n", 1, "'nab'"},
        {"x.obj", "v inx 0 0\nv 1 0 0\nf 1 2 1\n", 1, "'inx'"}, {"x.obj", "v n 0 0\nv 1 0 0\nf 1 2 1\n", 1, "'n'"},
        {"x", "about\nv  \nv of\n", 0, "neither the content nor the name"}};
    TMIO_GOOD(good, TMIO_MESH);
    TMIO_BAD(bad, TMIO_MESH);
}

/* The beginning of an OFF of four vertices, which says how much there is. */
#define OFF4(counts) "OFF\n" counts "\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"

static void tmio_test_off(void) {
    static const tmio_good good[] = {
        {"a.off", "OFF # c\n# c\n\n4 3 0\n0 0 0\n1 0 0 # c\n\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3 255 0 0\n2 0 1\n",
            "OFF: 0 0 0, 1 0 0, 1 1 0, 0 1 0 | 0 1 2, 0 1 2 3 | 1"},
        {"b.off", "COFF 3 1 0\r\n0 0 0 255 0 0 255\r\n1 0 0 255 0 0 255\r\n0 1 0 255 0 0 255\r\n3 0 1 2 0.5 0.5 0.5", "OFF:" TRIANGLE},
        {"c.off", "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2", "OFF:" TRIANGLE},
        {"a.off", "noff\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2", "OFF:" TRIANGLE},         /* not nOFF */
        {"d.off", "STCNOFF\n3 1\n0 0 0 0 0 1 9 9\n1 0 0 0 0 1 9 9\n0 1 0 0 0 1 9 9\n3 0 1 2", "OFF:" TRIANGLE},
        {"e.off", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "OFF:" TRIANGLE},                               /* no keyword */
        {"e", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "OFF:" TRIANGLE},                                   /* nor an extension */
        {"f.off", "OFF 3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2", "OFF:" TRIANGLE},                                 /* one line */
        {"g.off", "OFF\n3 1 0\n0 0\n0\n1 0 0 0 1 0\n3 0\n1 2\n", "OFF:" TRIANGLE},                         /* a stream */
        {"h.off", "OFF\n3\n1 0\n0 0\n0 7 7\n1 0 0 7 7\n0 1 0 7 7\n3 0\n1 2 7 7\n", "OFF:" TRIANGLE},       /* spread, with colours */
        {"i.off", "off\r3 0 0\r0 0 0\r1 0 0\r2 0 0\r", "OFF: 0 0 0, 1 0 0, 2 0 0"},
        {"j.obj", "OFF\n1 0 0\n1 2 3\n", "OFF: 1 2 3"}};                                                   /* content before extension */
    static const tmio_bad bad[] = {
        {"x.off", OFF4("4 1 0") "3 0 1 4\n", 7, "4 is out of range"},
        {"x.off", OFF4("4 1 0") "3 0 1 -1\n", 7, "-1 is out of range"},
        {"x.off", OFF4("4 2 0") "3 0 1 2\n", 8, "before face 2 of 2"}, {"x.off", OFF4("4 1 0") "3 0 1\n", 7, "has only 2"},
        {"x.off", OFF4("4 1 0") "3 0 1 b\n", 7, "'b'"}, {"x.off", OFF4("4 1 0") "-3 0 1 2\n", 7, "'-3'"},
        {"x.off", OFF4("4 1 0") "4000000000 0 1 2\n", 7, "'4000000000'"},
        {"x.off", OFF4("6 1 0") "3 0 1 2\n", 8, "before vertex 6 of 6"},
        {"x.off", "OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", 4, "this line has 2"},
        {"x.off", "OFF\n3 1 0\n0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n", 4, "'inf'"},
        {"x.off", "OFF\n3000000000 1 0\n0 0 0\n", 2, "3000000000 vertices are more"},
        {"x.off", "OFF\n1 99999999999999999999 0\n0 0 0\n", 2, "faces"},
        {"x.off", "OFF\n2000000000 2000000000 0\n0 0 0\n", 4, "before vertex 2 of 2000000000"},
        {"x.off", "OFF\n-1 1 0\n0 0 0\n", 2, "'-1'"}, {"x.off", "OFF\nx\n", 2, "'x'"},
        {"x.off", "OFF\n", 2, "number of vertices"}, {"x.off", "OFF 1", 1, "number of faces"},
        {"x.off", "OFF\n0 0 0\n", 0, "no vertices found"}, {"x.off", "OFF BINARY\n3 1 0\n", 1, "binary"},
        {"x.off", "nOFF\n3\n3 1 0\n", 1, "nOFF"}, {"x.off", "4nOFF\n3 1 0\n", 1, "nOFF"}};
    TMIO_GOOD(good, TMIO_MESH);
    TMIO_BAD(bad, TMIO_MESH);
}

static void tmio_test_xyz(void) {
    static const tmio_good good[] = {
        {"a.xyz", "# c\n// c\n0 0 0\n1,2,3\n1, 2 ,4 9 9\n\n 5\t6\t7 # c", "XYZ: 0 0 0, 1 2 3, 1 2 4, 5 6 7"},
        {"b.xyz", "2\n0 0 0\r\n1 0 0", "XYZ: 0 0 0, 1 0 0"}, {"c", "0 0 0\n1 0 0\n", "XYZ: 0 0 0, 1 0 0"},
        {"d.xyz", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "XYZ: 3 1 0, 0 0 0, 1 0 0, 0 1 0, 3 0 1"},      /* would be OFF, but for its name */
        {"e.obj", "0.5 0 0\n1 0 0\n", "XYZ: 0.5 0 0, 1 0 0"}, {"f.txt", "4 0 0\n1 0 0\n1 1 0\n", "XYZ: 4 0 0, 1 0 0, 1 1 0"},
        {"a.xyz", "// points\n2\n1;2;3\n4,5,6\n", "XYZ: 1 2 3, 4 5 6"},
        {"a.dat", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n5 5 5\n",                                           /* one line too much for an OFF */
            "XYZ: 3 1 0, 0 0 0, 1 0 0, 0 1 0, 3 0 1, 5 5 5"}};
    static const tmio_bad bad[] = {
        {"x.xyz", "0 0 0\n1 0\n", 2, "this line has 2"}, {"x.xyz", "0 0 0\n\n1 0 a\n", 3, "'a' is not a number"},
        {"x.xyz", "0 0 0\n1 0 NaN\n", 2, "'NaN' is not a finite"},
        {"x.xyz", "5\n0 0 0\n1 0 0\n", 1, "5 points are announced, 2 found"}, {"x.xyz", "# c\n", 0, "no vertices found"},
        {"x.xyz", "C 0 0 0\n", 1, "'C'"}, {"x.xyz", "1 2 3\n/ 5 6\n", 2, "'/'"}, {"x.xyz", "1 2 \\\n3\n", 1, "'\\'"},
        {"x.csv", "x,y,z\n", 1, "'x'"}, {"x.pts", "x y z\n", 1, "'x'"}, {"x.dat", "# nothing\n", 0, "nothing but comments"},
        {"x.dat", "what is this\n", 0, "OBJ, OFF, PLY, STL, XYZ"}, {"x.dat", "\037\213\010", 0, "gzip"},
        {"x.obj", "\037\213\010", 0, "gzip"},
        {"x.obj", "\377\376v\fb 0\f \fb 0\f0\fb 0\f \fb 0\f1\fb 0\f \fb 0\f2\fb 0\f\n", 0, "UTF-16"},
        {"x.off", "\376\377\fb 0\fO\fb 0\fF\fb 0\fF", 0, "UTF-16"}};
    TMIO_GOOD(good, TMIO_MESH);
    TMIO_BAD(bad, TMIO_MESH);
}

/* ---- PLY ---- */

#define XYZ(type) "property " type " x\nproperty " type " y\nproperty " type " z\n"
#define XYZ3 "0 0 0\n1 0 0\n0 1 0\n"
#define ASCII "ply\nformat ascii 1.0\n"
#define PLY3 ASCII "comment made by hand\nobj_info x\nelement vertex 3\n" XYZ("float")
#define PLY3_FACE PLY3 "element face 1\nproperty list uchar uint vertex_indices\nend_header\n"
#define PLY1 ASCII "element vertex 1\n" XYZ("float")

static void tmio_test_ply_ascii(void) {
    static const tmio_good good[] = {
        {"a.ply", "ply\r\nformat ascii 1.0\r\nelement extra 2\r\nproperty list uchar float w\r\nproperty int k\r\n"
                  "element face 2\r\nproperty uchar red\r\nproperty list uint8 int32 vertex_index\r\nproperty list uchar float uv\r\n"
                  "element vertex 4\r\nproperty uchar red\r\nproperty float64 z\r\nproperty double y\r\nproperty float32 x\r\nend_header\r\n"
                  "2 0.5 nan 7\r\n0 7\r\n9 3 0 1 2 0\r\n9 4 0 1 2 3 2 0.1 0.2\r\n9 3 2 1\r\n9 0 0 1\r\n9 0 1 1\r\n9 0 1 0\r\n",
            "PLY ascii: 1 2 3, 1 0 0, 1 1 0, 0 1 0 | 0 1 2, 0 1 2 3"},
        {"b.ply", ASCII "element vertex 5\n" XYZ("float") "element tristrips 2\nproperty list int int vertex_indices\nend_header\n"
                  "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 2\n8 0 1 2 3 -1 4 3 2\n4 0 1 -1 2\n",
            "PLY ascii: 0 0 0, 1 0 0, 0 1 0, 1 1 0, 2 2 2 | 0 1 2, 2 1 3, 4 3 2"},
        {"c.ply", PLY3_FACE "0 0 0 1 0 0 0 1 0 3 0\n1 2", "PLY ascii:" TRIANGLE},                  /* a stream */
        {"d", PLY3 "end_header\n" XYZ3, "PLY ascii: 0 0 0, 1 0 0, 0 1 0"},
        {"e.ply", "ply\rformat ascii 1.0\relement vertex 1\rproperty float x\rproperty float y\rproperty float z\rend_header\r1 2 3\r",
            "PLY ascii: 1 2 3"},
        {"a.ply", PLY1 "element face 0\nproperty int q\nend_header\n1 2 3\n", "PLY ascii: 1 2 3"}};
    static const tmio_bad bad[] = {
        {"x.ply", PLY3_FACE XYZ3 "3 0 1 3\n", 15, "3 is out of range"},
        {"x.ply", PLY3_FACE XYZ3 "3 0 1\n", 15, "too few numbers for face 0"}, {"x.ply", PLY3_FACE XYZ3 "-3 0 1 2\n", 15, "-3"},
        {"x.ply", PLY3_FACE XYZ3 "3 0 1 1.5\n", 15, "1.5"}, {"x.ply", PLY3_FACE XYZ3 "4000000000 0 1\n", 15, "4000000000"},
        {"x.ply", PLY3 "end_header\n0 0 0\n1 0 0 0\n0 1 0\n", 11, "more numbers"},
        {"x.ply", PLY3 "end_header\n0 0 0\n1 0\n0 1 0\n", 11, "too few numbers for vertex 1"},
        {"x.ply", PLY3 "end_header\n0 0 0\n1 0 0\n", 12, "ends inside vertex 2"},
        {"x.ply", PLY3 "end_header\n0 0 0\n1 nan 0\n0 1 0\n", 11, "'nan'"},
        {"x.ply", PLY3 "end_header\n0 0 0\n1 zero 0\n0 1 0\n", 11, "'zero'"},
        {"x.ply", PLY3 "element face 1\nproperty uchar vertex_indices\nend_header\n" XYZ3 "3\n", 9, "no list 'vertex_indices'"},
        {"x.ply", PLY1 "property float q\nend_header\n1 2 3\n", 9, "too few numbers for vertex 0"},
        {"x.ply", PLY1 "property list uchar int q\nend_header\n1 2 3 1e16 1\n", 9, "a list of length 1e+16"},
        {"x.ply", PLY1 "property list uchar int q\nend_header\n1 2 3 1.5 1 1\n", 9, "a list of length 1.5"},
        {"x.ply", "ply\rformat ascii 1.0\relement vertex 1\rproperty int x\rproperty int y\rproperty int z\rend_header", 7, "vertex 0"},
        {"x.ply", ASCII "element vertex 2000000000\n" XYZ("float") "end_header\n0 0 0\n", 9, "inside vertex 1"},
        {"x.ply", ASCII "element vertex 3000000000\nproperty float x\n", 3, "3000000000"},
        {"x.ply", ASCII "element vertex -1\n", 3, "'-1'"},
        {"x.ply", ASCII "element vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n", 3, "no property 'z'"},
        {"x.ply", ASCII "element vertex 1\nproperty flout x\n", 4, "'flout'"},
        {"x.ply", ASCII "element vertex 1\nproperty\n", 4, "missing"}, {"x.ply", ASCII "element vertex\n", 3, "missing"},
        {"x.ply", ASCII "element vertex 1\nelement vertex 1\n", 4, "second"},
        {"x.ply", ASCII "property float x\n", 3, "before the first element"},
        {"x.ply", ASCII "element face 1\nproperty list float int vertex_indices\n", 4, "integer"},
        {"x.ply", "ply\nformat morse 1.0\n", 2, "'morse'"}, {"x.ply", "ply\nfromat ascii 1.0\n", 2, "'fromat'"},
        {"x.ply", "ply\nelement vertex 0\nend_header\n", 3, "which format"},
        {"x.ply", ASCII "element vertex 1\n", 4, "inside the header"}, {"x.ply", ASCII "end_header\n", 0, "no vertices found"},
        {"x.ply", "plx\n", 1, "'ply'"}};
    TMIO_GOOD(good, TMIO_MESH);
    TMIO_BAD(bad, TMIO_MESH);
}

/* The usual layout; and vertices of mixed types with a colour and a list between, faces with a flag before and a list behind. */
#define BINARY(order) "ply\nformat binary_" order "_endian 1.0\n"
#define PLAIN "element vertex 4\n" XYZ("float") "element face 2\nproperty list uchar int vertex_indices\nend_header\n\f"
#define PLAIN_XYZ "f 0.5 0 -1 1 0 2 1 1 3 0 1 -4 "
#define PLAIN_FACES "b 3 i 0 1 2 b 4 i 0 1 2 3"
#define MIXED \
    "element vertex 4\nproperty uchar red\nproperty double x\nproperty list ushort short w\nproperty float y\nproperty short z\n" \
    "element junk 2\nproperty list uint double q\nproperty char k\n" \
    "element face 3\nproperty ushort flag\nproperty list int ushort vertex_indices\nproperty list uchar float uv\nend_header\n\f"
#define MIXED_ROWS \
    "b 200 d 0.5 h 0 f 0 h -1 b 200 d 1 h 1 0 f 0 h 2 b 200 d 1 h 2 0 -1 f 1 h 3 b 200 d 0 h 3 0 -1 -2 f 1 h -4 " \
    "i 1 d 3 b -1 i 0 b -1 h 77 i 3 h 0 1 2 b 1 f 0.5 h 77 i 4 h 0 1 2 3 b 1 f 0.5 h 77 i 2 h 0 1 "
#define SQUARE "PLY binary: 0.5 0 -1, 1 0 2, 1 1 3, 0 1 -4 | 0 1 2, 0 1 2 3"

/* Vertices and faces in layouts of their own, around the corners too. */
#define RARE(x, y, z, faces) \
    BINARY("little") "element vertex 3\nproperty " x " x\nproperty " y " y\nproperty " z " z\nelement face 2\n" faces "end_header\n\f"
#define LIST(count, corner) "property list " count " " corner " vertex_indices\n"
#define RARE_D "f 0.5 d 2.5 0 f 1.5 d 2.5 -1 f 2.5 d 2.5 -2 "
#define RARE_F "f 0.5 2.5 d 0 f 1.5 2.5 d -1 f 2.5 2.5 d -2 "
#define RARE_MESH "PLY binary: 0.5 2.5 0, 1.5 2.5 -1, 2.5 2.5 -2 | 0 1 2, 0 1 2"

static void tmio_test_ply_binary(void) {
    static const tmio_good good[] = {
        {"a.off", BINARY("little") MIXED "< " MIXED_ROWS "b 0", SQUARE " | 1"}, {"a.ply", BINARY("big") MIXED "> " MIXED_ROWS "b 0", SQUARE " | 1"},
        {"a.off", BINARY("little") PLAIN "< " PLAIN_XYZ PLAIN_FACES, SQUARE}, {"a.ply", BINARY("big") PLAIN "> " PLAIN_XYZ PLAIN_FACES, SQUARE},
        {"b.ply", "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty char x\rproperty char y\rproperty char z\r"
                  "end_header\r\n\r\n", "PLY binary: 10 13 10"},     /* lines that end with \r, and data that begin with \n */
        {"c.ply", "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 1\r\nproperty char x\r\nproperty char y\r\nproperty char z\r\n"
                  "element nothing 9000000000\r\nend_header\r\n\n\r\n", "PLY binary: 10 13 10"},
        {"a.ply", RARE("float", "double", "double", LIST("uchar", "uint") "property short q\n")
                  RARE_D "b 3 i 0 1 2 h 7 b 3 i 0 1 2 h 7", RARE_MESH},
        {"a.ply", RARE("float", "float", "double", LIST("uchar", "short")) RARE_F "b 3 h 0 1 2 b 3 h 0 1 2", RARE_MESH},
        {"a.ply", RARE("float", "double", "double", "property list uchar float uv\n" LIST("uchar", "int"))
                  RARE_D "b 1 f 7 b 3 i 0 1 2 b 1 f 7 b 3 i 0 1 2", RARE_MESH},
        {"a.ply", RARE("float", "float", "double", "property uchar q\n" LIST("uchar", "int") "property double r\n")
                  RARE_F "b 7 3 i 0 1 2 d 7 b 7 3 i 0 1 2 d 7", RARE_MESH}};
    static const tmio_bad bad[] = {
        {"x.ply", BINARY("little") PLAIN PLAIN_XYZ "b 3 i 0 1 2 b 4 i 0 1 2 b 3 0 0", 0, "face 1: the file ends here"},
        {"x.ply", BINARY("little") PLAIN PLAIN_XYZ "b 3", 0, "2 of element face, but the file ends after 1"},
        {"x.ply", BINARY("little") PLAIN "f 0.5 0 -1 1 0 2 1", 0, "4 of element vertex"},
        {"x.ply", BINARY("little") PLAIN PLAIN_XYZ "b 3 i 0 1 2 b 4 i 0 1 2 4", 0, "face 1: vertex index 4 is out of range"},
        {"x.ply", BINARY("little") PLAIN PLAIN_XYZ "b 3 i 0 1 2 b 4 i 0 1 2 -16777212", 0, "face 1: vertex index -16777212"},
        {"x.ply", BINARY("little") PLAIN "f 0.5 0 -1 1 0 2 1 1 3 0 1 b 192 127 255 255 " PLAIN_FACES, 0, "vertex 3: z is"},
        {"x.ply", BINARY("little") MIXED MIXED_ROWS, 0, "face 2: the file ends here"}};
    static char many[4096];
    static tmio_bytes t;
    mio_mesh m;
    mio_error e;
    int f;
    TMIO_GOOD(good, TMIO_MESH);
    TMIO_BAD(bad, TMIO_MESH);
    /* more corners than triangles have */
    strcpy(many, BINARY("little") "element vertex 6\n" XYZ("char") "element face 100\n" LIST("uchar", "int") "end_header\n"
                 "\fb 0 1 2 0 1 2 0 1 2 0 1 2 0 1 2 0 1 2");
    for (f = 0; f < 100; f++) strcat(many, " b 6 i 0 1 2 3 4 5");
    t = *tmio_make(many);
    tmio_put(tmio_path("a.ply"), t.b, t.n);
    CHECK_MSG(mio_load(&m, tmio_path("a.ply"), NULL, &e) == 0, "%s", e.text);
    CHECK(m.n == 6 && m.n_faces == 100 && m.face_ptr[100] == 600 && m.face_idx[599] == 5 && m.face_idx[300] == 0);
    mio_free(&m);
    remove(tmio_path("a.ply"));
}

/* ---- STL ---- */

#define FACET "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
#define STL "\f@80 i 2 f 0 0 0 0 0 0 1 0 0 0 1 0 h 0 f 0 0 0 "       /* two triangles, the second without corners */
#define STL_MESH "0 0 0, 1 0 0, 0 1 0, 1 1 0.5 | 0 1 2, 2 1 3"

static void tmio_test_stl(void) {
    static const tmio_good good[] = {
        {"a", STL "-0 1 -0 1 -0 -0 1 1 0.5 h 0", "STL binary: " STL_MESH},
        {"a.stl", "solid facet, it says" STL "-0 1 -0 1 -0 -0 1 1 0.5 h 0", "STL binary: " STL_MESH},
        {"b.stl", "solid my facet\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1e0 0\n  endloop\n"
                  " endfacet\nendsolid my facet\nSOLID\r\nFACET NORMAL nan nan nan OUTER LOOP VERTEX 0 1 0 VERTEX 1 -0 0 VERTEX 1 1 0 "
                  "ENDLOOP ENDFACET\r\nENDSOLID\r\n", "STL ascii: 0 0 0, 1 0 0, 0 1 0, 1 1 0 | 0 1 2, 2 1 3"}};
    static const tmio_bad bad[] = {
        {"x.stl", "solid facet, it says" STL "-0 1 -0 1 -0 -0 1 1 0.5 b 0", 0, "the file ends in triangle 1"},
        {"x.stl", "\f@60", 0, "inside the header"},
        {"x.stl", "\f@80 i 4294967295 f 0 0 0 0 0 0 1 0 0 0 1 0 h 0 f 0 0 0 -0 1 -0 1 -0 -0 1 1 0.5 h 0", 0, "4294967295 triangles"},
        {"x.stl", STL "-0 1 -0 1 inf -0 1 1 0.5 h 0", 0, "face 1: y of corner 1 is inf"},
        {"x.stl", "solid\nendsolid\n", 0, "no vertices found"},
        {"x.stl", FACET "vertex 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n", 6, "'vertex'"},
        {"x.stl", FACET "vertex 1 0 inf\n", 5, "'inf'"},
        {"x.stl", FACET "vertex 1 0 0\nvertex 0 1 0\nendfacet\nendsolid\n", 7, "'endfacet'"},
        {"x.stl", FACET "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n", 9, "endsolid"},
        {"x.stl", "solid a\nfacet normal 0 0 1\nvertex 0 0 0\n", 3, "'vertex'"},
        {"x.stl", "facet normal 0 0 1 outer loop vertex 0 0 0\n", 2, "before 'endsolid'"}};
    TMIO_GOOD(good, TMIO_MESH);
    TMIO_BAD(bad, TMIO_MESH);
}

/* ---- tables ---- */

static void tmio_test_table_text(void) {
    static const tmio_good good[] = {
        {"a.txt", "# c\n\n1 2.5\r\n\t3 ,  -4e1 # row\n 5,6\n", "3 x 2: 1 3 5 2.5 -40 6 | 3 4 5"}, {"b.csv", "7", "1 x 1: 7 | 1"},
        {"n.csv", "a,b\n3,4\n", "1 x 2: 3 4 | 2"},              /* a first line of names is no row */
        {"n.csv", "\n# c\n_x 10h2\r\n3 4\r\n", "1 x 2: 3 4 | 4"}, {"n.csv", "\"a, b\",\"c\"\"d\"\n3,4", "1 x 2: 3 4 | 2"},
        {"n.csv", "nano,info\n3,4", "1 x 2: 3 4 | 2"}, {"n.csv", "\357\273\277v1, v2\n3, 4\n", "1 x 2: 3 4 | 2"},
        {"a.csv", "nax,ina\n1,2\n3,4\n", "2 x 2: 1 3 2 4 | 2 3"}, {"a.csv", "a,-infra\n2,3\n", "1 x 2: 2 3 | 2"}};
    static const tmio_good fields[] = {
        {"a.txt", "d,e\n1 inf\n-Infinity NaN\n+INF -nan\n", "3 x 2: 1 -inf inf inf nan nan"}};
    static const tmio_bad bad_fields[] = {
        {"a.txt", "1\ninfinit\n", 2, ""}, {"a.txt", "1\n1e999\n", 2, ""}, {"a.txt", "1\nnana\n", 2, ""}, {"a.txt", "1\n- inf\n", 2, ""}};
    static const tmio_bad bad[] = {
        {"x.csv", "a 1\n2 3\n", 1, "'a'"}, {"x.csv", "nan,b\n2,3\n", 1, "'nan'"}, {"x.csv", "a,-Inf\n2,3\n", 1, "'a'"},
        {"x.csv", "a,-nan\n2,3\n", 1, "'a'"}, {"x.csv", "a,+inf\n2,3\n", 1, "'a'"}, {"x.csv", "a,b\nc,d\n", 2, "'c'"},
        {"x.csv", "a,b\n", 0, "no numbers"}, {"x.txt", "1 2\n3\n", 2, "1 columns, but 2"},
        {"x.txt", "1 2\n3 zwei\n", 2, "'zwei'"}, {"x.txt", "1 2\n3 nan\n", 2, "'nan'"}, {"x.txt", "1 2\n\n3 -inf\n", 3, "'-inf'"},
        {"x.csv", "1,,2\n", 1, "comma"}, {"x.csv", "1,2,\n", 1, "comma"}, {"x.csv", "1,2\n,3\n", 2, "comma"},
        {"x.csv", "1;2\n", 1, "';'"}, {"x.csv", "\377\3761\fb 0\f,\fb 0\f2\fb 0\f\n", 0, "UTF-16"},
        {"x.txt", "\037\213\010", 0, "gzip"}, {"x.txt", "", 0, "no numbers"}, {"x.txt", "# c\n\n", 0, "no numbers"}};
    double *v;
    int64_t r;
    int32_t c;
    mio_error e;
    TMIO_GOOD(good, TMIO_TABLE);
    TMIO_GOOD(fields, TMIO_FIELD);
    TMIO_BAD(bad, TMIO_TABLE);
    TMIO_BAD(bad_fields, TMIO_FIELD);
    CHECK(mio_load_table(&v, &r, &c, tmio_path("not-there.txt"), NULL, &e) == MIO_FAILED);
    CHECK(strstr(e.text, "not-there.txt: cannot open"));
}

/* The head of a .npy file in so many of its versions. */
#define NPY(version, type, order, shape) "npy" version "{'descr': '" type "', 'fortran_order': " order ", 'shape': " shape ", }   \n"

static void tmio_test_table_npy(void) {
    static const char *const types[] = {"<f8d", ">f8d", "<f4f", ">f4f", "<i8q", ">i4i", "<i2h", "|i1b", "<u4i"};
    static const tmio_good good[] = {
        {"b", NPY("1", "<i4", "False", "(1,)") "\fi -5", "1 x 1: -5"},
        {"a.npy", NPY("1", "|u1", "False", "(2L, 1L)") "\fb 1 2", "2 x 1: 1 2"},
        {"a.npy", NPY("1", "|b1", "False", "(2,)") "\fb 1 0", "2 x 1: 1 0"},
        {"a.npy", NPY("1", "<u8", "False", "(1,)") "\fq 4611686018427387904", "1 x 1: 4.61168601842739e+18"}};
    static const tmio_good field[] = {{"a.npy", NPY("1", "<f8", "False", "(2,)") "\fd inf nan", "2 x 1: inf nan"}};
    static const tmio_bad bad[] = {
        {"x.npy", NPY("1", "<f8", "False", "(2, 1)") "\fd 1", 0, "2 x 1"},
        {"x.npy", NPY("1", "<f8", "False", "(2, 1)") "\fd 1 q 9221120237041090560", 0, "row 1, column 0"},     /* a NaN */
        {"x.npy", "\223NUMPY\1\fb 0 63", 0, "inside the header"},
        {"x.npy", "\223NUMPY\1\fb 0 63 0\f{'descr': '<f8', 'fo", 0, "inside the header"}, {"x.npy", "1 2\n", 0, "not a .npy"},
        {"x.npy", NPY("1", "<c8", "False", "(1,)"), 0, "type"},
        {"x.npy", NPY("1", "<f8", "False", "(1, 1, 1)"), 0, "3 dimensions"},
        {"x.npy", NPY("1", "<f8", "False", "()"), 0, "0 dimensions"}, {"x.npy", NPY("1", "<f8", "False", "(0, 3)"), 0, "empty"},
        {"x.npy", NPY("1", "<f8", "False", "(3, 0)"), 0, "empty"},
        {"x.npy", NPY("1", "<f8", "False", "(999999999999999, 999999999)"), 0, "announced"},
        {"x.npy", NPY("1", "<f8", "False", "(1152921504606846976, 16)"), 0, "1152921504606846976 x 16 numbers"},
        {"x.npy", NPY("1", "<f8", "False", "(9223372036854775808, 16)"), 0, "announces 9223372036854775808, more"},
        {"x.npy", NPY("1", "<f8", "Maybe", "(1,)"), 0, "order"}, {"x.npy", NPY("9", "<f8", "False", "(1,)"), 0, "version 9"},
        {"x.npy", "npy1{'descr'", 0, "the type of its numbers"},
        {"x.npy", "npy1{'descr': <f8', 'fortran_order': False, 'shape': (1,), }", 0, "the type of its numbers"},
        {"x.npy", "npy1{'descr': '<f", 0, "the type of its numbers"},
        {"x.npy", "npy1{'descr': 'f8'  , 'shape': (1,)}", 0, "the type of its numbers"},
        {"x.npy", "npy1{'descr': '|b1 ', 'shape': (1,)}", 0, "the type of its numbers"},
        {"x.npy", "npy1{'descr':  ", 0, "the type of its numbers"}, {"x.npy", "npy1{'descr' : :", 0, "the type of its numbers"}};
    static const struct { char version; const char *order, *shape, *values, *holds; } layouts[] = {
        {'1', "False", "(3, 2)", "0 3 1 4 2 5", "3 x 2: 0 1 2 3 4 5"}, {'2', "True", "(3, 2)", "0 1 2 3 4 5", "3 x 2: 0 1 2 3 4 5"},
        {'3', "False", "(6,)", "0 1 2 3 4 5", "6 x 1: 0 1 2 3 4 5"}};
    size_t i;
    int k;
    for (i = 0; i < sizeof types / sizeof *types; i++)
        for (k = 0; k < 3; k++) {               /* C order, Fortran order, one dimension */
            char text[200];
            const tmio_good one = {"a.npy", text, layouts[k].holds};
            snprintf(text, sizeof text, "npy%c{'descr': '%.3s', 'fortran_order': %s, 'shape': %s, }   \n\f%c%c %s", layouts[k].version, types[i],
                     layouts[k].order, layouts[k].shape, types[i][0] == '>' ? '>' : '<', types[i][3], layouts[k].values);
            tmio_check_good(&one, 1, TMIO_TABLE);
        }
    TMIO_GOOD(good, TMIO_TABLE);
    TMIO_GOOD(field, TMIO_FIELD);
    TMIO_BAD(bad, TMIO_TABLE);
}

/* ---- writers ---- */

/* A mesh of a triangle, a quad and a pentagon on six vertices, and a field of two columns on it. */
typedef struct tmio_sample {
    mio_mesh m;
    double xyz[18], values[12];
    const int32_t *ids[2];
    const char *names[2];
    uint8_t rgb[18];
    mio_output o;
} tmio_sample;

static void tmio_sample_make(tmio_sample *s) {
    static int32_t idx[12] = {0, 1, 2, 0, 2, 3, 4, 4, 3, 2, 1, 5}, ids[2][6] = {{0, 1, 2, 3, 4, 5}, {0, -100, -200, -300, -400, -500}};
    static int64_t ptr[4] = {0, 3, 7, 12};
    const mio_mesh m = {6, s->xyz, 3, ptr, idx, NULL, 0};
    int i;
    memset(s, 0, sizeof *s);
    s->m = m;
    for (i = 0; i < 18; i++) {
        s->xyz[i] = (i * 7 % 11) / 3.0 - 1;
        s->rgb[i] = (uint8_t)(i * 15);
    }
    for (i = 0; i < 12; i++) s->values[i] = i == 4 ? 0 : 1e-7 / (i + 1) - 0.1 * (i > 6);
    s->ids[0] = ids[0];
    s->ids[1] = ids[1];
    s->names[0] = "t < 1 & \"two\"";
    s->names[1] = "second";
    s->o.ids = s->ids;
    s->o.rows = s->o.ld = 6;
    s->o.cols = 2;
    s->o.values = s->values;
}

/* Writes the sample into a file, and gets the whole of it, which must fit. The caller removes it. */
static size_t tmio_written(const tmio_sample *s, const char *name, char *buf, size_t room) {
    mio_error e;
    size_t n;
    e.text[0] = 0;
    CHECK_MSG(mio_write(tmio_path(name), mio_format_of(name), &s->m, &s->o, &e) == 0, "%s", e.text);
    CHECK(!mio_temporary_set);
    n = tmio_get(tmio_path(name), buf, room);
    CHECK_MSG(n > 0 && n < room - 1, "%s: %lu bytes", name, (unsigned long)n);
    return n;
}

/* CSV alone begins with names, if there are any and they are wanted. All are read again without them. */
static void tmio_test_write_tables(void) {
    static const char *const id_names[2] = {"i", "j"};
    static const struct { const char *file; int n_ids; const char *comment, *name; int id_names, no_header; const char *begins; } rows[] = {
        {"o.txt", 0, NULL, NULL, 0, 0, "9.9999999999999995e-08 1.4"}, {"o.txt", 2, "1\n2", NULL, 0, 0, "# 1 2\n0 0 9.99"},
        {"o.CSV", 0, NULL, NULL, 0, 0, "9.9999999999999995e-08,1.4"}, {"o.CSV", 2, "1\n2", NULL, 0, 0, "# 1 2\n0,0,9.99"},
        {"o.npy", 0, NULL, NULL, 0, 0, "\x93NUMPY\1"}, {"o.npy", 2, "1\n2", NULL, 0, 0, "\x93NUMPY\1"},
        {"o.csv", 0, NULL, "t < 1 & \"two\"", 1, 0, "\"t < 1 & \"\"two\"\"\",second\n9.99"},
        {"o.csv", 2, NULL, "t < 1 & \"two\"", 1, 0, "i,j,\"t < 1 & \"\"two\"\"\",second\n0,0,"},
        {"o.csv", 2, NULL, "t < 1 & \"two\"", 1, 1, "0,0,"}, {"o.txt", 2, NULL, "t < 1 & \"two\"", 1, 1, "0 0 "},
        {"o.csv", 0, NULL, "a\nb", 0, 0, "\"a b\",second\n9.99"}, {"o.csv", 2, NULL, "a\nb", 0, 0, "0,0,"}};    /* not all have names */
    static tmio_sample s;
    static char buf[4096];
    size_t k;
    int i;
    for (k = 0; k < sizeof rows / sizeof *rows; k++) {
        const int first = rows[k].n_ids;
        double *v;
        int64_t r;
        int32_t c;
        mio_error e;
        tmio_sample_make(&s);
        s.o.n_ids = first;
        s.o.comment = rows[k].comment;
        s.names[0] = rows[k].name;
        if (rows[k].name) s.o.names = s.names;
        if (rows[k].id_names) s.o.id_names = id_names;
        s.o.no_header = rows[k].no_header;
        (void)tmio_written(&s, rows[k].file, buf, sizeof buf);
        CHECK_MSG(strncmp(buf, rows[k].begins, strlen(rows[k].begins)) == 0, "%s", buf);
        if (CHECK(mio_load_table(&v, &r, &c, tmio_path(rows[k].file), NULL, &e) == 0 && r == 6 && c == first + 2)) {
            CHECK(memcmp(v + 6 * first, s.values, sizeof s.values) == 0);
            for (i = 0; i < 6 * first; i++) CHECK(v[i] == (i < 6 ? i : -100 * (i - 6)));
            free(v);
        }
        if (k < 4) CHECK(!strchr(buf + 6 * (first > 0), k < 2 ? ',' : ' '));
        if (k == 5) CHECK(memcmp(buf, "\x93NUMPY\1\0\x76\0{'descr': '<f8', 'fortran_order': False, 'shape': (6, 4), } ", 70) == 0 && buf[127] == '\n');
        remove(tmio_path(rows[k].file));
    }
    s.values[0] = strtod("nan", NULL);
    tmio_written(&s, "o.txt", buf, sizeof buf);
    CHECK(strncmp(buf, "0 0 nan ", 8) == 0);
    remove(tmio_path("o.txt"));
    CHECK(mio_format_of("a.txt") == MIO_TXT && mio_format_of("b/a.VTU") == MIO_VTU);
    CHECK(mio_format_of("a.png") == MIO_UNKNOWN && mio_format_of("a.d/txt") == MIO_UNKNOWN);
    CHECK(mio_has_extension("x.PnG", "png") && !mio_has_extension("png", "png") && !mio_has_extension("x.pngs", "png"));
    CHECK(!mio_has_extension(NULL, "png") && !mio_has_extension("a.3ds", "obj") && !mio_has_extension("a.1", "obj"));
}

/* The longest names that file systems have, of letters of two bytes at every place. */
static void tmio_test_long_names(void) {
    static tmio_sample s;
    char name[256], back[64];
    int k, n;
    mio_error e;
    tmio_sample_make(&s);
    for (k = 0; k < 12; k++) {
        const int size = k < 8 ? TEST_LONGEST_NAME - 7 + k : 96 + k;    /* with its extension */
        for (n = 0; n < k % 2; n++) name[n] = 'x';
        for (; n + 6 <= size; n += 2) memcpy(name + n, "\303\251", 2);
        for (; n + 4 < size; n++) name[n] = 'y';
        memcpy(name + n, ".txt", 5);
        e.text[0] = 0;
        CHECK_MSG(mio_write(tmio_path(name), MIO_TXT, &s.m, &s.o, &e) == 0, "%d bytes: %s", size, e.text);
        CHECK(mio_temporary_path[0] && !tmio_exists(mio_temporary_path));
        n = (int)(strstr(mio_temporary_path, ".part") - mio_temporary_path) - 10;
        CHECK((mio_temporary_path[n] & 0x80) == 0 || (unsigned char)mio_temporary_path[n] == 0xa9);  /* whole letters */
        CHECK(tmio_get(tmio_path(name), back, sizeof back) > 8);
        remove(tmio_path(name));
    }
}

static int tmio_same_mesh(const mio_mesh *a, const mio_mesh *b) {
    return a->n == b->n && a->n_faces == b->n_faces && memcmp(a->xyz, b->xyz, 3 * (size_t)a->n * sizeof *a->xyz) == 0 &&
           (!a->n_faces || (memcmp(a->face_ptr, b->face_ptr, ((size_t)a->n_faces + 1) * sizeof *a->face_ptr) == 0 &&
                            memcmp(a->face_idx, b->face_idx, (size_t)a->face_ptr[a->n_faces] * sizeof *a->face_idx) == 0));
}

/* What is written is read again as the same mesh. The file is removed. */
static void tmio_check_back(const char *name, const mio_mesh *m) {
    mio_mesh back;
    mio_error e;
    if (CHECK_MSG(mio_load(&back, tmio_path(name), NULL, &e) == 0, "%s", e.text)) CHECK(tmio_same_mesh(&back, m));
    mio_free(&back);
    remove(tmio_path(name));
}

static void tmio_test_write_meshes(void) {
    static const struct { const char *file; int bare; const char *has[2], *lacks; } rows[] = {     /* with everything, and with next to nothing */
        {"o.ply", 0, {"property uchar blue\nproperty double quality\nproperty double quality_1\nelement face 3\n", "comment quality_1: second\n"}, "\n\n"},
        {"o.obj", 0, {"v -1 1.3333333333333335 0 0 0.058824 0.11765\n", "\nf 1 3 4 5\n"}, "\n\n"},
        {"o.ply", 1, {"ply", "element vertex 6"}, "element face"}, {"o.ply", 1, {"ply", "end_header"}, "red"}, {"o.obj", 1, {"v -1", "\nv "}, "f"}};
    static tmio_sample s;
    static char buf[8192];
    double xyz[900] = {0};
    int32_t idx[300], i;
    const int64_t ptr[2] = {0, 300};
    mio_error e;
    size_t k;
    for (k = 0; k < sizeof rows / sizeof *rows; k++) {
        tmio_sample_make(&s);
        if (!rows[k].bare) {
            s.o.rgb = s.rgb;
            s.o.names = s.names;
        } else s.m.n_faces = s.o.cols = (int32_t)(s.o.rows = 0);
        (void)tmio_written(&s, rows[k].file, buf, sizeof buf);
        CHECK_MSG(strstr(buf, rows[k].has[0]) && strstr(buf, rows[k].has[1]) && !strstr(buf, rows[k].lacks), "%s", buf);
        tmio_check_back(rows[k].file, &s.m);
    }
    for (i = 0; i < 300; i++) xyz[3 * i] = idx[i] = i;      /* a polygon of 300 corners does not fit a length of one byte */
    s.m.n = 300;
    s.m.xyz = xyz;
    s.m.n_faces = 1;
    s.m.face_ptr = (int64_t *)ptr;
    s.m.face_idx = idx;
    CHECK(mio_write_ply(tmio_path("w.ply"), &s.m, &s.o, &e) == 0);
    tmio_check_back("w.ply", &s.m);
    tmio_sample_make(&s);
    s.o.rows = 5;
    CHECK(mio_write_ply(tmio_path("o.ply"), &s.m, &s.o, &e) == MIO_FAILED && strstr(e.text, "5 rows"));
    CHECK(mio_write_vtu(tmio_path("o.vtu"), NULL, &s.o, &e) == MIO_FAILED && mio_write("o.x", MIO_UNKNOWN, &s.m, &s.o, &e) == MIO_FAILED);
    CHECK(mio_write(tmio_path("o.obj"), MIO_OBJ, &s.m, &s.o, &e) == MIO_FAILED && !tmio_exists(tmio_path("o.obj")));
}

/* The 8 bytes of a little-endian integer. */
static uint64_t tmio_u64(const char *p) {
    uint64_t u = 0;
    int i;
    for (i = 7; i >= 0; i--) u = u << 8 | (unsigned char)p[i];
    return u;
}

static void tmio_test_vtu(void) {
    static tmio_sample s;
    static char buf[8192];
    size_t n;
    int points;
    for (points = 0; points < 2; points++) {
        /* the data lie in the opposite order of their tags: two columns, colours, points, corners, ends of cells, kinds of cells */
        const uint64_t cells = points ? 6 : 3, corners = points ? 6 : 12, sizes[7] = {cells, 8 * cells, 8 * corners, 144, 18, 48, 48};
        const char *p, *at;
        uint64_t i, k, x;
        tmio_sample_make(&s);
        if (points) s.m.n_faces = 0;
        s.o.rgb = s.rgb;
        s.o.names = s.names;
        n = tmio_written(&s, "o.vtu", buf, sizeof buf);
        CHECK(strstr(buf, "Scalars=\"t &lt; 1 &amp; &quot;two&quot;\"") && strstr(buf, points ? "NumberOfCells=\"6\"" : "NumberOfCells=\"3\""));
        p = strstr(buf, "encoding=\"raw\">\n_");
        if (!CHECK(p != NULL)) return;
        p += 17;
        for (i = 0, k = 0; i < 7; i++) {
            char want[64];
            snprintf(want, sizeof want, "offset=\"%llu\"", (unsigned long long)k);
            CHECK_MSG(strstr(buf, want) && tmio_u64(p + k) == sizes[i], "array %d", (int)i);
            k += 8 + sizes[i];
        }
        CHECK((size_t)(p - buf) + k + 28 == n && memcmp(p + k, "\n</AppendedData>\n</VTKFile>\n", 28) == 0);
        at = p + k - 2 * 56 + 8;                /* the second column, before the first */
        for (i = 0; i < 6; i++) {
            memcpy(&x, &s.values[6 + i], 8);
            CHECK(tmio_u64(at + 8 * i) == x);
        }
        at = p + 8;
        CHECK(points ? at[0] == 1 && at[5] == 1 : at[0] == 5 && at[1] == 9 && at[2] == 7);
    }
    s.names[0] = "a > 'b'\n\tc";
    tmio_written(&s, "o.vtu", buf, sizeof buf);
    CHECK(strstr(buf, "a &gt; &apos;b&apos;  c"));
    s.o.cols = 0;
    tmio_written(&s, "o.vtu", buf, sizeof buf);
    CHECK(!strstr(buf, "Scalars="));
    remove(tmio_path("o.vtu"));
}

static void tmio_test_triangulate(void) {
    static const int32_t want[18] = {0, 1, 2, 0, 2, 3, 0, 3, 4, 4, 3, 2, 4, 2, 1, 4, 1, 5}, face[6] = {0, 1, 1, 2, 2, 2};
    static tmio_sample s;
    int32_t *tri, *of, n;
    mio_error e;
    tmio_sample_make(&s);
    CHECK(mio_triangulate(&s.m, &tri, &n, &of, &e) == 0 && n == 6 && memcmp(tri, want, sizeof want) == 0 && memcmp(of, face, sizeof face) == 0);
    free(tri);
    free(of);
    CHECK(mio_triangulate(&s.m, &tri, &n, NULL, &e) == 0 && n == 6 && memcmp(tri, want, sizeof want) == 0);
    free(tri);
    s.m.n_faces = 0;
    CHECK(mio_triangulate(&s.m, &tri, &n, NULL, &e) == 0 && n == 0 && tri);
    free(tri);
}

/* ---- what fails, and stops ---- */

static int tmio_never(void) { return 0; }
static int tmio_stop_now(void) { return 1; }

/* Asked 20 times, then stops. */
static int tmio_stop_count;
static int tmio_stop_later(void) { return ++tmio_stop_count > 20; }

/* What was there stays when a file cannot be written, and nothing is left beside it. */
static void tmio_test_failed_writes(void) {
    static tmio_sample s;
    static const char *const names[] = {"o.txt", "o.csv", "o.npy", "o.ply", "o.obj", "o.vtu"};
    char keep[64];
    mio_error e;
    int k;
    tmio_sample_make(&s);
    for (k = 0; k < 6; k++) {
        const char *const path = tmio_path(names[k]);
        CHECK(mio_write(tmio_path("no/such/folder/o.txt"), MIO_TXT + k, &s.m, &s.o, &e) == MIO_FAILED && strstr(e.text, "o.txt: cannot write"));
        tmio_put(path, "precious", 8);
        s.o.stop = tmio_stop_now;
        CHECK(mio_write(path, MIO_TXT + k, &s.m, &s.o, &e) == MIO_STOPPED && !mio_temporary_set);
        CHECK(mio_temporary_path[0] && !tmio_exists(mio_temporary_path));
        CHECK(tmio_get(path, keep, sizeof keep) == 8 && strcmp(keep, "precious") == 0);
        s.o.stop = NULL;
        CHECK(mio_write(path, MIO_TXT + k, &s.m, &s.o, &e) == 0 && tmio_get(path, keep, sizeof keep) > 8);
        remove(path);
    }
#if !defined(_WIN32)
    if (tmio_exists("/dev/full")) {
        static double big[200000];
        FILE *null;
        for (k = 0; k < 6; k++)
            CHECK(mio_write("/dev/full", MIO_TXT + k, &s.m, &s.o, &e) == MIO_FAILED && strstr(e.text, "/dev/full: cannot write: "));
        s.o.rows = s.o.ld = 100000;             /* more than any buffer */
        s.o.values = big;
        CHECK(mio_write_npy("/dev/full", &s.o, &e) == MIO_FAILED);
        CHECK(mio_write_text("/dev/null", &s.o, &e) == 0);
        null = fopen("/dev/null", "wb");
        CHECK(null != NULL && fputs("still a device", null) >= 0);
        if (null) fclose(null);
    }
#endif
}

/* A temporary file exists until it is cancelled, closed or a signal handler says so. Two may be open at once. */
static void tmio_test_temporary_files(void) {
    static mio_file a, b;
    char buf[16];
    mio_error e;
    CHECK(mio_file_open(&a, tmio_path("o.txt"), NULL, &e) == 0);
    mio_file_put(&a, "12", 2);
    CHECK(mio_temporary_set && a.temporary && tmio_exists(mio_temporary_path));
    mio_file_cancel(&a);
    CHECK(!mio_temporary_set && !tmio_exists(mio_temporary_path) && !tmio_exists(tmio_path("o.txt")));
#if !defined(_WIN32)
    CHECK(mio_file_open(&a, tmio_path("o.txt"), NULL, &e) == 0);
    mio_remove_temporary();
    CHECK(!mio_temporary_set && !tmio_exists(mio_temporary_path));
    CHECK(mio_file_close(&a) == MIO_FAILED);
#endif
    CHECK(mio_file_open(&a, tmio_path("one.txt"), tmio_never, &e) == 0 && mio_file_open(&b, tmio_path("two.txt"), NULL, &e) == 0);
    CHECK(strcmp(mio_temporary_path, a.temporary) == 0 && strcmp(a.temporary, b.temporary) != 0);
    mio_file_put(&a, "1", 1);
    mio_file_put(&b, "2", 1);
    CHECK(mio_file_close(&b) == 0 && mio_temporary_set && mio_file_close(&a) == 0 && !mio_temporary_set);
    CHECK(tmio_get(tmio_path("one.txt"), buf, sizeof buf) == 1 && buf[0] == '1');
    CHECK(tmio_get(tmio_path("two.txt"), buf, sizeof buf) == 1 && buf[0] == '2');
    remove(tmio_path("one.txt"));
    remove(tmio_path("two.txt"));
    CHECK(mio_file_open(&a, tmio_path("no/such/folder/x.txt"), NULL, &e) == MIO_FAILED);
    mio_file_cancel(&a);
    CHECK(a.status == MIO_FAILED && strstr(e.text, "cannot write"));
}

/* Files that cannot be read; callers that want no message, or none so long. */
static void tmio_test_failed_reads(void) {
    char name[400];
    mio_mesh m;
    mio_error e;
    CHECK(mio_load(&m, tmio_path("not-there.obj"), NULL, &e) == MIO_FAILED && strstr(e.text, "not-there.obj: cannot open: ") && !m.xyz);
    CHECK(mio_load(&m, test_tmp_dir(), NULL, &e) == MIO_FAILED);
    memset(name, 'x', sizeof name - 1);
    name[sizeof name - 1] = 0;
    CHECK(mio_load(&m, name, NULL, &e) == MIO_FAILED && strncmp(e.text, "...xxx", 6) == 0 && strlen(e.text) < 300);
    CHECK(mio_load(&m, name, NULL, NULL) == MIO_FAILED);
    tmio_put(tmio_path("s.obj"), "v 1 2 3\n", 8);
    CHECK(mio_load(&m, tmio_path("s.obj"), tmio_stop_now, &e) == MIO_STOPPED && !m.xyz);
    CHECK(mio_load(&m, tmio_path("s.obj"), NULL, NULL) == 0);
    mio_free(&m);
    mio_free(&m);
    mio_free(NULL);
    tmio_put(tmio_path("s.obj"), "OFF\n1 1 0\n0 0 0\n", 17);
    CHECK(mio_load(&m, tmio_path("s.obj"), NULL, NULL) == MIO_FAILED);
    tmio_put(tmio_path("s.obj"), "ply\nformat ascii 1.0\nelement vertex 1\n" XYZ("int") "end_header\n1 2\n", 98);
    CHECK(mio_load(&m, tmio_path("s.obj"), NULL, NULL) == MIO_FAILED && !m.xyz);
    remove(tmio_path("s.obj"));
    CHECK(mio_fail_at(&e, "a\nb", 7, "%d", 5) == MIO_FAILED && strcmp(e.text, "a?b:7: 5") == 0);
}

/* A large file of one row again and again, between a beginning and an end. */
typedef struct tmio_large { const char *name, *head, *row, *tail; } tmio_large;

/* Loads it; stop is asked so many times before it says so. Returns the status. */
static int tmio_load_large(const tmio_large *x, int asked) {
    const char *const path = tmio_path(x->name);
    const int table = strstr(x->name, "table") != NULL;
    mio_error e;
    mio_mesh m;
    double *values = NULL;
    int64_t rows;
    int32_t columns;
    int status;
    tmio_stop_count = 21 - asked;
    if (!table) status = mio_load(&m, path, tmio_stop_later, &e);
    else status = mio_load_table(&values, &rows, &columns, path, tmio_stop_later, &e);
    CHECK_MSG(status != MIO_FAILED, "%s", e.text);
    CHECK(status == MIO_OK ? table ? values != NULL : m.n > 0 : table ? !values : !m.xyz && m.n == 0);
    free(values);
    if (!table) mio_free(&m);
    return status;
}

/* Loading something large stops wherever it is asked to, whatever the format. */
static void tmio_test_stop(void) {
    static const tmio_large all[] = {
        {"l.obj", "", "v 1 2 3\n", ""}, {"l.off", "OFF\n70000 0 0\n", "1 2 3\n", ""}, {"l.xyz", "", "1 2 3\n", ""},
        {"l.ply", ASCII "element vertex 70000\n" XYZ("float") "end_header\n", "1 2 3\n", ""},
        {"v.ply", BINARY("little") "element vertex 70000\n" XYZ("float") "end_header\n", "\f@12", ""},
        {"f.ply", BINARY("little") "element vertex 3\n" XYZ("char") "element face 70000\n" LIST("uchar", "int") "end_header\n\fb 0 0 0 0 0 0 0 0 0",
            "\fb 3 i 0 1 2", ""},
        {"l.stl", "solid\n", "facet normal 0 0 1 outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop endfacet\n", "endsolid\n"},
        {"b.stl", "\f@80 i 70000", "\f@50", ""}, {"table.txt", "", "1 2\n", ""}, {"table.npy", NPY("1", "<f8", "False", "(70000,)"), "\f@8", ""}};
    size_t k;
    int i, asked;
    for (k = 0; k < sizeof all / sizeof *all; k++) {
        const tmio_bytes *const head = tmio_make(all[k].head), *const row = tmio_make(all[k].row);
        FILE *const f = fopen(tmio_path(all[k].name), "wb");
        if (!CHECK(f != NULL)) continue;
        fwrite(head->b, 1, head->n, f);
        for (i = 0; i < 70000; i++) fwrite(row->b, 1, row->n, f);
        CHECK(fputs(all[k].tail, f) >= 0 && fclose(f) == 0);
        for (asked = 1; asked < 100 && tmio_load_large(all + k, asked) == MIO_STOPPED; asked++) {}
        CHECK_MSG(asked > 3 && asked < 100, "%s: asked %d times", all[k].name, asked);
        CHECK(tmio_stop_count == 20);            /* and not once more than that */
        remove(tmio_path(all[k].name));
    }
}

/* The reader puts corners of STL in the same place together, however many there are. */
static void tmio_test_large_stl(void) {
    enum { SIDE = 60 };
    FILE *const f = fopen(tmio_path("side.stl"), "wb");
    static const int turn[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    mio_mesh m;
    mio_error e;
    int k, right = 1;
    if (!CHECK(f != NULL)) return;
    fputs("solid s\n", f);
    for (k = 0; k < 6 * SIDE * SIDE; k++)
        fprintf(f, "%svertex %d %d 0\n%s", k % 3 == 0 ? "facet normal 0 0 1\nouter loop\n" : "", k / 6 % SIDE + turn[k % 6][0],
                k / 6 / SIDE + turn[k % 6][1], k % 3 == 2 ? "endloop\nendfacet\n" : "");
    CHECK(fputs("endsolid s\n", f) >= 0 && fclose(f) == 0);
    CHECK_MSG(mio_load(&m, tmio_path("side.stl"), NULL, &e) == 0, "%s", e.text);
    CHECK(m.n == (SIDE + 1) * (SIDE + 1) && m.n_faces == 2 * SIDE * SIDE);
    for (k = 0; k < 6 * SIDE * SIDE && m.n > 0; k++) {     /* corner by corner, as they were written */
        const double *const x = m.xyz + 3 * m.face_idx[k];
        right = right && x[0] == k / 6 % SIDE + turn[k % 6][0] && x[1] == k / 6 / SIDE + turn[k % 6][1] && x[2] == 0;
    }
    CHECK(right);
    mio_free(&m);
    remove(tmio_path("side.stl"));
}

/* ---- broken files ---- */

/* Loads, and checks what holds for whatever the file was. Returns the status. */
static int tmio_survive(const char *name, const void *data, size_t size, int table) {
    const char *const path = tmio_path(name);
    mio_mesh m;
    mio_error e;
    double *v;
    int64_t r, i;
    int32_t c;
    int status;
    tmio_put(path, data, size);
    e.text[0] = 0;
    if (table) {
        status = mio_load_table(&v, &r, &c, path, NULL, &e);
        for (i = 0; i < r * c && status == 0; i++) if (!mio_is_finite(v[i])) CHECK_MSG(0, "a number that is not finite");
        free(v);
    } else {
        status = mio_load(&m, path, NULL, &e);
        for (i = 0; status == 0 && i < 3 * (int64_t)m.n; i++) if (!mio_is_finite(m.xyz[i])) CHECK_MSG(0, "a coordinate that is not finite");
        for (i = 0; status == 0 && i < m.face_ptr[m.n_faces]; i++)
            if (m.face_idx[i] < 0 || m.face_idx[i] >= m.n) CHECK_MSG(0, "an index out of range");
        for (i = 0; status == 0 && i < m.n_faces; i++) if (m.face_ptr[i + 1] - m.face_ptr[i] < 3) CHECK_MSG(0, "a face of fewer than 3 corners");
        CHECK(status != 0 || m.n > 0);
        mio_free(&m);
    }
    remove(path);
    if (status != 0 && (status != MIO_FAILED || !strstr(e.text, name) || strchr(e.text, '\n'))) CHECK_MSG(0, "%s: %d, '%s'", name, status, e.text);
    return status;
}

static uint64_t tmio_random(uint64_t *seed) {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    return *seed ^= *seed << 17;
}

/* Changes a byte at random, leaves one out or doubles one. Returns the new length. */
static size_t tmio_spoil(unsigned char *b, size_t length, size_t room, uint64_t *seed) {
    static const unsigned char values[] = {0, 255, '-', '\n', '9'};
    const uint64_t r = tmio_random(seed);
    const size_t at = (size_t)(r >> 8) % length;
    const int way = (int)(r >> 60);
    if (way < 2) b[at] = (unsigned char)(b[at] ^ 1u << (r & 7));
    else if (way < 4) b[at] = (unsigned char)(r & 255);
    else if (way < 9) b[at] = values[way - 4];
    else if (way == 9) {
        memmove(b + at, b + at + 1, length - at - 1);
        if (length > 1) return length - 1;
    } else if (way > 10) b[at] = b[(size_t)(r >> 20) % length];
    else if (length < room - 1) {
        memmove(b + at + 1, b + at, length - at);
        return length + 1;
    }
    return length;
}

/* Every beginning of a good file, and some thousand files with a few wrong bytes. `least`: no shorter beginning is good. */
static void tmio_break(const char *name, const void *data, size_t size, size_t least, int table) {
    static unsigned char buf[8192];
    uint64_t seed = 0x9e3779b97f4a7c15u;
    size_t k;
    int i, n;
    CHECK_MSG(tmio_survive(name, data, size, table) == 0, "%s: the whole file is refused", name);
    for (k = 0; k < size; k++) if (tmio_survive(name, data, k, table) == 0 && k < least) CHECK_MSG(0, "%s: accepted after %lu bytes", name, (unsigned long)k);
    for (i = 0; i < 400; i++) {
        size_t length = size;
        memcpy(buf, data, size);
        for (n = 0; n <= i % 4; n++) length = tmio_spoil(buf, length, sizeof buf, &seed);
        (void)tmio_survive(name, buf, length, table);
    }
}

static void tmio_test_broken(void) {
    static const char off[] = "OFF # c\n4 2 0\n0 0 0\n1 0 0\n0 1 0 255 0 0\n1 1 1.25\n3 0 1 2\n4 0 1 3 2 0.5 0.5 0.5\n";
    /* spare: so many bytes at the end are not needed; -1: no beginning must be refused */
    static const struct { const char *name, *text; int spare, table; } files[] = {
        {"t.obj", "v 0 0 0\nv 1.5 0 -2e1\nv 0 1 0.123456789012345678\nf 1 2 3\nf -1/1 -2/2/2 -3//3 \\\n1\nl 1 2\n# end\n", -7, 0},
        {"t.off", off, 20, 0}, {"t", off, -1, 0},
        {"t.ply", ASCII "element vertex 4\nproperty float x\nproperty double y\nproperty float z\nelement face 1\n"
                  "property list uchar int vertex_index\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                  "0 0 0\n1 0 0\n0 1 0\n1 1 0.5\n4 0 1 3 2\n6 0 1 2 -1 3 2\n", 2, 0},
        {"t.stl", "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n", 4, 0},
        {"t.xyz", "3\n# c\n0 0 0\n1,2,3\n4 5 6 7 8 9\n", 11, 0}, {"t.txt", "# c\n1 2\n3,4\n-5e3\t6.25\n", -1, 1},
        {"tb.ply", BINARY("little") MIXED "< " MIXED_ROWS "b 0", 0, 0}, {"tb.ply", BINARY("big") MIXED "> " MIXED_ROWS "b 0", 0, 0},
        {"tb.ply", BINARY("little") PLAIN "< " PLAIN_XYZ PLAIN_FACES, 0, 0}, {"tb.ply", BINARY("big") PLAIN "> " PLAIN_XYZ PLAIN_FACES, 0, 0},
        {"tb.stl", "solid" STL "-0 1 -0 1 -0 -0 1 1 0.5 h 0", 0, 0}, {"t.npy", NPY("1", "<f4", "True", "(2, 2)") "\ff 0 1 2 3", 0, 1}};
    static const char *const names[] = {"r.obj", "r.off", "r.ply", "r.stl", "r.xyz", "r", "r.txt", "r.npy"};
    static tmio_sample s;
    static char buf[8192];
    uint64_t seed = 12345;
    size_t n, k;
    int i;
    for (k = 0; k < sizeof files / sizeof *files; k++) {
        const tmio_bytes t = *tmio_make(files[k].text);
        const int spare = files[k].spare;
        tmio_break(files[k].name, t.b, t.n, spare >= 0 ? t.n - (size_t)spare : spare == -1 ? 0 : (size_t)-spare, files[k].table);
    }
    tmio_sample_make(&s);
    n = tmio_written(&s, "o.ply", buf, sizeof buf);
    tmio_break("o.ply", buf, n, n, 0);
    for (i = 0; i < 200; i++) {                 /* bytes at random, under every name */
        for (k = 0; k < 600; k++) buf[k] = (char)(unsigned char)(tmio_random(&seed) >> 24 & 255);
        CHECK(tmio_survive(names[i & 7], buf, 600, (i & 7) > 5) == MIO_FAILED);
    }
}

static void test_meshio(void) {
    tmio_test_numbers();
    tmio_test_obj();
    tmio_test_off();
    tmio_test_xyz();
    tmio_test_ply_ascii();
    tmio_test_ply_binary();
    tmio_test_stl();
    tmio_test_table_text();
    tmio_test_table_npy();
    tmio_test_write_tables();
    tmio_test_long_names();
    tmio_test_write_meshes();
    tmio_test_vtu();
    tmio_test_triangulate();
    tmio_test_failed_writes();
    tmio_test_temporary_files();
    tmio_test_failed_reads();
    tmio_test_stop();
    tmio_test_large_stl();
    tmio_test_broken();
}

#endif
