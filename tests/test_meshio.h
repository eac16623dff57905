/* test_meshio.h - the readers and writers of tools/meshio.h

   The runner defines CHECK and CHECK_MSG and test_tmp_dir() before including this. Every file is made here. */

#ifndef TEST_MESHIO_H
#define TEST_MESHIO_H

#include "../tools/meshio.h"

/* ---- files ---- */

/* The path of a file in the temporary folder; good until eight calls later. */
static const char *tmio_path(const char *name)
{
    static char paths[8][1024];
    static int next;
    char *const path = paths[next++ & 7];
    snprintf(path, sizeof paths[0], "%s/%s", test_tmp_dir(), name);
    return path;
}

static void tmio_put(const char *path, const void *data, size_t size)
{
    FILE *const f = fopen(path, "wb");
    CHECK_MSG(f && fwrite(data, 1, size, f) == size, "cannot make %s", path);
    if (f) fclose(f);
}

/* Reads a small file; returns its size, or 0 when it is not there. buf gets a zero at the end. */
static size_t tmio_get(const char *path, char *buf, size_t room)
{
    FILE *const f = fopen(path, "rb");
    size_t n = 0;
    if (f) { n = fread(buf, 1, room - 1, f); fclose(f); }
    buf[n] = 0;
    return n;
}

static int tmio_load_bytes(mio_mesh *m, mio_error *e, const char *name, const void *data, size_t size)
{
    const char *const path = tmio_path(name);
    int status;
    tmio_put(path, data, size);
    e->text[0] = 0;
    status = mio_load(m, path, NULL, e);
    remove(path);
    return status;
}

/* Loads a text that must be a good mesh of this format and size. */
static mio_mesh tmio_good(const char *name, const char *text, const char *format, int32_t n, int32_t n_faces)
{
    mio_mesh m;
    mio_error e;
    const int status = tmio_load_bytes(&m, &e, name, text, strlen(text));
    CHECK_MSG(status == 0, "%s: %s", text, e.text);
    CHECK_MSG(status != 0 || strcmp(m.format, format) == 0, "%s: read as %s", text, m.format);
    CHECK_MSG(m.n == n && m.n_faces == n_faces, "%s: %ld vertices, %ld faces", text, (long)m.n, (long)m.n_faces);
    return m;
}

static void tmio_fine(const char *name, const char *text, const char *format, int32_t n, int32_t n_faces)
{
    mio_mesh m = tmio_good(name, text, format, n, n_faces);
    mio_free(&m);
}

/* Does face f have these corners? */
static int tmio_face_is(const mio_mesh *m, int32_t f, int32_t count, int32_t a, int32_t b, int32_t c, int32_t d)
{
    const int32_t want[4] = {a, b, c, d};
    int32_t k;
    if (f >= m->n_faces || m->face_ptr[f + 1] - m->face_ptr[f] != count) return 0;
    for (k = 0; k < count && k < 4; k++) if (m->face_idx[m->face_ptr[f] + k] != want[k]) return 0;
    return 1;
}

static int tmio_vertex_is(const mio_mesh *m, int32_t v, double x, double y, double z)
{
    return v < m->n && m->xyz[3 * v] == x && m->xyz[3 * v + 1] == y && m->xyz[3 * v + 2] == z;
}

/* A text (or bytes) that must be refused, with a message that ends in `PATH/where` and contains what. */
static void tmio_bad_bytes(const char *name, const void *data, size_t size, const char *where, const char *what)
{
    mio_mesh m;
    mio_error e;
    char begin[128];
    const int status = tmio_load_bytes(&m, &e, name, data, size);
    snprintf(begin, sizeof begin, "/%s: ", where);
    CHECK_MSG(status == MIO_FAILED, "%s: accepted, expected %s %s", name, where, what);
    CHECK_MSG(status != MIO_FAILED || (strstr(e.text, begin) && strstr(e.text, what)), "expected %s and '%s', got: %s", where, what, e.text);
    CHECK(!strchr(e.text, '\n') && m.n == 0 && !m.xyz && !m.face_ptr && !m.face_idx);
    mio_free(&m);
}

static void tmio_bad(const char *name, const char *text, const char *where, const char *what)
{
    tmio_bad_bytes(name, text, strlen(text), where, what);
}

/* ---- bytes for binary files ---- */

typedef struct tmio_bytes { unsigned char b[4096]; size_t n; int big; } tmio_bytes;

static void tmio_add(tmio_bytes *t, const void *data, size_t size)
{
    if (t->n + size > sizeof t->b) return;
    memcpy(t->b + t->n, data, size);
    t->n += size;
}

static void tmio_text(tmio_bytes *t, const char *text) { tmio_add(t, text, strlen(text)); }

/* An integer of `size` bytes. */
static void tmio_int(tmio_bytes *t, int64_t v, int size)
{
    int i;
    for (i = 0; i < size; i++) {
        const unsigned char c = (unsigned char)((uint64_t)v >> 8 * (t->big ? size - 1 - i : i) & 255);
        tmio_add(t, &c, 1);
    }
}

static void tmio_float(tmio_bytes *t, double x)
{
    const float y = (float)x;
    uint32_t u;
    memcpy(&u, &y, 4);
    tmio_int(t, u, 4);
}

static void tmio_double(tmio_bytes *t, double x)
{
    uint64_t u;
    memcpy(&u, &x, 8);
    tmio_int(t, (int64_t)u, 8);
}

/* ---- numbers ---- */

static void tmio_test_numbers(void)
{
    static const char *const good[] = {"0", "-0", "1", "+1", "1.", ".5", "-.5e1", "00012.50", "1e5", "1E+5", "1e-5", "0.1", "0.35444599999999998", "123456789012345678",
        "9007199254740993", "9007199254740993e-3", "9007199254740993e5", "1.7976931348623157e308", "4.9e-324", "2.2250738585072011e-308", "1e-400", "0e999999999999",
        "0.1000000000000000055511151231257827021181583404541015625", "9999999999999999999e22", "9999999999999999999e-22", "18446744073709551615", "8.5e-21",
        "100000000000000000000000000000000", "0.000000000000000000000000000000000001", "6929495644600919.5", "3.1415926535897932384626433832795028841971"};
    static const char *const bad[] = {"", "-", "+", ".", "e5", "-.e5", "1e", "1e+", "nan", "inf", "x1", "--1"};
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
        uint64_t m;
        double want;
        seed ^= seed << 13; seed ^= seed >> 7; seed ^= seed << 17;
        m = seed >> seed % 50;
        snprintf(text, sizeof text, "%llue%d", (unsigned long long)m, (int)(seed % 53) - 26);
        want = strtod(text, NULL);
        (void)mio_number(text, &x);
        if (x != want) { CHECK_MSG(0, "%s: %.17g, not %.17g", text, x, want); break; }
    }
}

/* ---- meshes as text ---- */

static void tmio_test_obj(void)
{
    mio_mesh m = tmio_good("a.obj", "# c\nmtllib x.mtl\no thing\nv 0 0 0\nv 1 0 0 0.5\nv 1 1 0 0.1 0.2 0.3\nvt 0 0\nvn 0 0 1\nv 0 1 0 # end\n"
                                    "g a b\nusemtl m\ns off\nf 1 2 3\nf 1/1 2/2 3/3 4/4\nf 1//1 3//1 4//1\nf 1/1/1 2/1/1 3/1/1\nf -4 -3 -2\nl 1 2\np 1\nwhat ever\n"
                                    "f 1 2\nf 3\nf\n", "OBJ", 4, 5);
    CHECK(tmio_vertex_is(&m, 2, 1, 1, 0) && tmio_face_is(&m, 0, 3, 0, 1, 2, 0) && tmio_face_is(&m, 1, 4, 0, 1, 2, 3));
    CHECK(tmio_face_is(&m, 2, 3, 0, 2, 3, 0) && tmio_face_is(&m, 3, 3, 0, 1, 2, 0) && tmio_face_is(&m, 4, 3, 0, 1, 2, 0) && m.n_small_faces == 3);
    mio_free(&m);
    m = tmio_good("b.obj", "f 1 2 3\r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf -1 -3 \\\r\n  -2\r\nv 1 \\\n2 3", "OBJ", 4, 2);      /* forward, joined */
    CHECK(tmio_face_is(&m, 0, 3, 0, 1, 2, 0) && tmio_face_is(&m, 1, 3, 2, 0, 1, 0) && tmio_vertex_is(&m, 3, 1, 2, 3));
    mio_free(&m);
    tmio_fine("c.obj", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r", "OBJ", 3, 1);
    tmio_fine("d.obj", "\t v\t0 0\t0  \n  v 1 0 0\nv 0 1 0\n f  1  2  3  ", "OBJ", 3, 1);
    tmio_fine("e.obj", "\xef\xbb\xbfv 0 0 0\nv 1 0 0\n", "OBJ", 2, 0);
    tmio_fine("f.obj", "v 1e0 -1.5E-3 +2\nv .5 5. 0\nv 0 0 0#c\nf 1 2 3#c\n", "OBJ", 3, 1);

    tmio_bad("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 99999999\n", "x.obj:5", "99999999");
    tmio_bad("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\nv 0 0\n", "x.obj:5", "3 coordinates");
    tmio_bad("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\nf 1 2 5", "x.obj:4", "9999999999");
    tmio_bad("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "x.obj:4", "index 0");
    tmio_bad("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 -4\n", "x.obj:5", "-4");
    tmio_bad("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "x.obj:4", "3 vertices");
    tmio_bad("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1 9\n", "x.obj:5", "9");
    tmio_bad("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3x\n", "x.obj:4", "'3x'");
    tmio_bad("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 1.5\n", "x.obj:4", "'1.5'");
    tmio_bad("x.obj", "v 0 0 0\r\nv nan 0 0\r\n", "x.obj:2", "'nan' is not a finite");
    tmio_bad("x.obj", "v 0 0 0\rv 0 -Infinity 0\r", "x.obj:2", "'-Infinity' is not a finite");
    tmio_bad("x.obj", "v 0 0 1e999\n", "x.obj:1", "'1e999' is too large");
    tmio_bad("x.obj", "v 0 0 0\nv 1 0 \\\n 0\nv 0 \x01two\x80 0", "x.obj:4", "'?two?' is not a number");
    tmio_bad("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1\nf 1 2 3\n", "x.obj:3", "this line has 2");
    tmio_bad("x.obj", "v 0 0 0\nv", "x.obj:2", "this line has 0");
    tmio_bad("x.obj", "v 0 0 0\nv 0 1 # 2\n", "x.obj:2", "this line has 2");
    tmio_bad("x.obj", "v 0 0 0x10\n", "x.obj:1", "'0x10'");
    tmio_bad("x.obj", "v 0 0 1234567890123456789012345678901234567890123456789x\n", "x.obj:1", "'1234567890123456789012345678901234567...'");
    tmio_bad("x.obj", "# nothing here\n", "x.obj", "no vertices found");
    tmio_bad("x.obj", "f 1 2 3\n", "x.obj", "no vertices found");
    tmio_bad("x.obj", "", "x.obj", "no vertices found");
    tmio_bad("x.dat", "", "x.dat", "no vertices found");
    tmio_bad_bytes("x.obj", "v 0 0 \0 1\n", 11, "x.obj:1", "'?' is not a number");
}

static void tmio_test_off(void)
{
    const char *const cube = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    mio_mesh m;
    char text[512];
    m = tmio_good("a.off", "OFF # c\n# c\n\n4 3 0\n0 0 0\n1 0 0 # c\n\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3 255 0 0\n2 0 1\n", "OFF", 4, 2);
    CHECK(tmio_vertex_is(&m, 2, 1, 1, 0) && tmio_face_is(&m, 0, 3, 0, 1, 2, 0) && tmio_face_is(&m, 1, 4, 0, 1, 2, 3) && m.n_small_faces == 1);
    mio_free(&m);
    tmio_fine("b.off", "COFF 3 1 0\r\n0 0 0 255 0 0 255\r\n1 0 0 255 0 0 255\r\n0 1 0 255 0 0 255\r\n3 0 1 2 0.5 0.5 0.5", "OFF", 3, 1);
    tmio_fine("c.off", "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2", "OFF", 3, 1);
    tmio_fine("d.off", "STCNOFF\n3 1\n0 0 0 0 0 1 9 9\n1 0 0 0 0 1 9 9\n0 1 0 0 0 1 9 9\n3 0 1 2", "OFF", 3, 1);
    tmio_fine("e.off", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "OFF", 3, 1);                      /* no keyword */
    tmio_fine("e", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "OFF", 3, 1);                          /* nor an extension */
    tmio_fine("f.off", "OFF 3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2", "OFF", 3, 1);                        /* one line */
    tmio_fine("g.off", "OFF\n3 1 0\n0 0\n0\n1 0 0 0 1 0\n3 0\n1 2\n", "OFF", 3, 1);                /* a stream */
    tmio_fine("h.off", "OFF\n3\n1 0\n0 0\n0 7 7\n1 0 0 7 7\n0 1 0 7 7\n3 0\n1 2 7 7\n", "OFF", 3, 1);     /* spread, with colours */
    tmio_fine("i.off", "off\r3 0 0\r0 0 0\r1 0 0\r2 0 0\r", "OFF", 3, 0);
    tmio_fine("j.obj", "OFF\n1 0 0\n1 2 3\n", "OFF", 1, 0);                                        /* content before extension */

    snprintf(text, sizeof text, "OFF\n4 1 0\n%s3 0 1 4\n", cube);
    tmio_bad("x.off", text, "x.off:7", "4 is out of range");
    snprintf(text, sizeof text, "OFF\n4 1 0\n%s3 0 1 -1\n", cube);
    tmio_bad("x.off", text, "x.off:7", "-1 is out of range");
    snprintf(text, sizeof text, "OFF\n4 2 0\n%s3 0 1 2\n", cube);
    tmio_bad("x.off", text, "x.off:8", "before face 2 of 2");
    snprintf(text, sizeof text, "OFF\n4 1 0\n%s3 0 1\n", cube);
    tmio_bad("x.off", text, "x.off:7", "has only 2");
    snprintf(text, sizeof text, "OFF\n4 1 0\n%s3 0 1 b\n", cube);
    tmio_bad("x.off", text, "x.off:7", "'b'");
    snprintf(text, sizeof text, "OFF\n4 1 0\n%s-3 0 1 2\n", cube);
    tmio_bad("x.off", text, "x.off:7", "'-3'");
    snprintf(text, sizeof text, "OFF\n4 1 0\n%s4000000000 0 1 2\n", cube);
    tmio_bad("x.off", text, "x.off:7", "'4000000000'");
    snprintf(text, sizeof text, "OFF\n6 1 0\n%s3 0 1 2\n", cube);
    tmio_bad("x.off", text, "x.off:8", "before vertex 6 of 6");
    tmio_bad("x.off", "OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "x.off:4", "this line has 2");
    tmio_bad("x.off", "OFF\n3 1 0\n0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n", "x.off:4", "'inf'");
    tmio_bad("x.off", "OFF\n3000000000 1 0\n0 0 0\n", "x.off:2", "3000000000 vertices are more");
    tmio_bad("x.off", "OFF\n1 99999999999999999999 0\n0 0 0\n", "x.off:2", "faces");
    tmio_bad("x.off", "OFF\n2000000000 2000000000 0\n0 0 0\n", "x.off:4", "before vertex 2 of 2000000000");
    tmio_bad("x.off", "OFF\n-1 1 0\n0 0 0\n", "x.off:2", "'-1'");
    tmio_bad("x.off", "OFF\nx\n", "x.off:2", "'x'");
    tmio_bad("x.off", "OFF\n", "x.off:2", "number of vertices");
    tmio_bad("x.off", "OFF\n0 0 0\n", "x.off", "no vertices found");
    tmio_bad("x.off", "OFF BINARY\n3 1 0\n", "x.off:1", "binary");
    tmio_bad("x.off", "nOFF\n3\n3 1 0\n", "x.off:1", "nOFF");
}

static void tmio_test_xyz(void)
{
    mio_mesh m = tmio_good("a.xyz", "# c\n// c\n0 0 0\n1,2,3\n1, 2 ,4 9 9\n\n 5\t6\t7 # c", "XYZ", 4, 0);
    CHECK(tmio_vertex_is(&m, 1, 1, 2, 3) && tmio_vertex_is(&m, 3, 5, 6, 7) && m.face_ptr && m.face_ptr[0] == 0);
    mio_free(&m);
    tmio_fine("b.xyz", "2\n0 0 0\r\n1 0 0", "XYZ", 2, 0);
    tmio_fine("c", "0 0 0\n1 0 0\n", "XYZ", 2, 0);
    tmio_fine("d.xyz", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "XYZ", 5, 0);      /* would be OFF, but for its name */
    tmio_fine("e.obj", "0.5 0 0\n1 0 0\n", "XYZ", 2, 0);
    tmio_fine("f.txt", "4 0 0\n1 0 0\n1 1 0\n", "XYZ", 3, 0);
    tmio_bad("x.xyz", "0 0 0\n1 0\n", "x.xyz:2", "this line has 2");
    tmio_bad("x.xyz", "0 0 0\n\n1 0 a\n", "x.xyz:3", "'a' is not a number");
    tmio_bad("x.xyz", "0 0 0\n1 0 NaN\n", "x.xyz:2", "'NaN' is not a finite");
    tmio_bad("x.xyz", "5\n0 0 0\n1 0 0\n", "x.xyz:1", "5 points are announced, 2 found");
    tmio_bad("x.xyz", "# c\n", "x.xyz", "no vertices found");
    tmio_bad("x.xyz", "C 0 0 0\n", "x.xyz:1", "'C'");
    tmio_bad("x.dat", "what is this\n", "x.dat", "OBJ, OFF, PLY, STL, XYZ");
    tmio_bad("x.dat", "\x1f\x8b\x08", "x.dat", "gzip");
    tmio_bad("x.obj", "\x1f\x8b\x08", "x.obj", "gzip");
    tmio_bad_bytes("x.obj", "\xff\xfev\0 \0000\0 \0001\0 \0002\0\n", 17, "x.obj", "UTF-16");
    tmio_bad_bytes("x.off", "\xfe\xff\0O\0F\0F", 8, "x.off", "UTF-16");
}

/* ---- PLY ---- */

static void tmio_test_ply_ascii(void)
{
    const char *const head = "ply\nformat ascii 1.0\ncomment made by hand\nobj_info x\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    char text[1024];
    mio_mesh m = tmio_good("a.ply", "ply\r\nformat ascii 1.0\r\nelement extra 2\r\nproperty list uchar float w\r\nproperty int k\r\n"
                                    "element face 2\r\nproperty uchar red\r\nproperty list uint8 int32 vertex_index\r\nproperty list uchar float uv\r\n"
                                    "element vertex 4\r\nproperty uchar red\r\nproperty float64 z\r\nproperty double y\r\nproperty float32 x\r\nend_header\r\n"
                                    "2 0.5 nan 7\r\n0 7\r\n9 3 0 1 2 0\r\n9 4 0 1 2 3 2 0.1 0.2\r\n9 3 2 1\r\n9 0 0 1\r\n9 0 1 1\r\n9 0 1 0\r\n", "PLY ascii", 4, 2);
    CHECK(tmio_vertex_is(&m, 0, 1, 2, 3) && tmio_face_is(&m, 0, 3, 0, 1, 2, 0) && tmio_face_is(&m, 1, 4, 0, 1, 2, 3));
    mio_free(&m);
    m = tmio_good("b.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 2\n"
                           "property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 2\n8 0 1 2 3 -1 4 3 2\n4 0 1 -1 2\n", "PLY ascii", 5, 3);
    CHECK(tmio_face_is(&m, 0, 3, 0, 1, 2, 0) && tmio_face_is(&m, 1, 3, 2, 1, 3, 0) && tmio_face_is(&m, 2, 3, 4, 3, 2, 0));
    mio_free(&m);
    snprintf(text, sizeof text, "%selement face 1\nproperty list uchar uint vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 3 0\n1 2", head);
    tmio_fine("c.ply", text, "PLY ascii", 3, 1);                        /* a stream */
    snprintf(text, sizeof text, "%send_header\n0 0 0\n1 0 0\n0 1 0\n", head);
    tmio_fine("d", text, "PLY ascii", 3, 0);
    tmio_fine("e.ply", "ply\rformat ascii 1.0\relement vertex 1\rproperty float x\rproperty float y\rproperty float z\rend_header\r1 2 3\r", "PLY ascii", 1, 0);

    snprintf(text, sizeof text, "%selement face 1\nproperty list uchar uint vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", head);
    tmio_bad("x.ply", text, "x.ply:15", "3 is out of range");
    snprintf(text, sizeof text, "%selement face 1\nproperty list uchar uint vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", head);
    tmio_bad("x.ply", text, "x.ply:15", "too few numbers for face 0");
    snprintf(text, sizeof text, "%selement face 1\nproperty list uchar uint vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", head);
    tmio_bad("x.ply", text, "x.ply:15", "-3");
    snprintf(text, sizeof text, "%selement face 1\nproperty list uchar uint vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n", head);
    tmio_bad("x.ply", text, "x.ply:15", "1.5");
    snprintf(text, sizeof text, "%selement face 1\nproperty list uchar uint vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1\n", head);
    tmio_bad("x.ply", text, "x.ply:15", "4000000000");
    snprintf(text, sizeof text, "%send_header\n0 0 0\n1 0 0 0\n0 1 0\n", head);
    tmio_bad("x.ply", text, "x.ply:11", "more numbers");
    snprintf(text, sizeof text, "%send_header\n0 0 0\n1 0\n0 1 0\n", head);
    tmio_bad("x.ply", text, "x.ply:11", "too few numbers for vertex 1");
    snprintf(text, sizeof text, "%send_header\n0 0 0\n1 0 0\n", head);
    tmio_bad("x.ply", text, "x.ply:12", "ends inside vertex 2");
    snprintf(text, sizeof text, "%send_header\n0 0 0\n1 nan 0\n0 1 0\n", head);
    tmio_bad("x.ply", text, "x.ply:11", "'nan'");
    snprintf(text, sizeof text, "%send_header\n0 0 0\n1 zero 0\n0 1 0\n", head);
    tmio_bad("x.ply", text, "x.ply:11", "'zero'");
    tmio_bad("x.ply", "ply\nformat ascii 1.0\nelement vertex 2000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n", "x.ply:9", "inside vertex 1");
    tmio_bad("x.ply", "ply\nformat ascii 1.0\nelement vertex 3000000000\nproperty float x\n", "x.ply:3", "3000000000");
    tmio_bad("x.ply", "ply\nformat ascii 1.0\nelement vertex -1\n", "x.ply:3", "'-1'");
    tmio_bad("x.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n", "x.ply:3", "no property 'z'");
    tmio_bad("x.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty flout x\n", "x.ply:4", "'flout'");
    tmio_bad("x.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty\n", "x.ply:4", "missing");
    tmio_bad("x.ply", "ply\nformat ascii 1.0\nelement vertex\n", "x.ply:3", "missing");
    tmio_bad("x.ply", "ply\nformat ascii 1.0\nelement vertex 1\nelement vertex 1\n", "x.ply:4", "second");
    tmio_bad("x.ply", "ply\nformat ascii 1.0\nproperty float x\n", "x.ply:3", "before the first element");
    tmio_bad("x.ply", "ply\nformat ascii 1.0\nelement face 1\nproperty list float int vertex_indices\n", "x.ply:4", "integer");
    tmio_bad("x.ply", "ply\nformat morse 1.0\n", "x.ply:2", "'morse'");
    tmio_bad("x.ply", "ply\nfromat ascii 1.0\n", "x.ply:2", "'fromat'");
    tmio_bad("x.ply", "ply\nelement vertex 0\nend_header\n", "x.ply:3", "which format");
    tmio_bad("x.ply", "ply\nformat ascii 1.0\nelement vertex 1\n", "x.ply:4", "inside the header");
    tmio_bad("x.ply", "ply\nformat ascii 1.0\nend_header\n", "x.ply", "no vertices found");
    tmio_bad("x.ply", "plx\n", "x.ply:1", "'ply'");
    snprintf(text, sizeof text, "%selement face 1\nproperty uchar vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3\n", head);
    tmio_bad("x.ply", text, "x.ply:9", "no list 'vertex_indices'");
}

/* Vertices of mixed types with a colour and a list between, faces with a flag before and a list behind. `plain`: the usual layout. */
static void tmio_make_ply(tmio_bytes *t, int big, int plain)
{
    static const double xyz[4][3] = {{0.5, 0, -1}, {1, 0, 2}, {1, 1, 3}, {0, 1, -4}};
    int v, k;
    t->n = 0;
    t->big = big;
    tmio_text(t, big ? "ply\nformat binary_big_endian 1.0\n" : "ply\nformat binary_little_endian 1.0\n");
    tmio_text(t, plain ? "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
                       : "element vertex 4\nproperty uchar red\nproperty double x\nproperty list ushort short w\nproperty float y\nproperty short z\n"
                         "element junk 2\nproperty list uint double q\nproperty char k\n"
                         "element face 3\nproperty ushort flag\nproperty list int ushort vertex_indices\nproperty list uchar float uv\nend_header\n");
    for (v = 0; v < 4; v++) {
        if (plain) { for (k = 0; k < 3; k++) tmio_float(t, xyz[v][k]); continue; }
        tmio_int(t, 200, 1); tmio_double(t, xyz[v][0]);
        tmio_int(t, v, 2); for (k = 0; k < v; k++) tmio_int(t, -k, 2);
        tmio_float(t, xyz[v][1]); tmio_int(t, (int64_t)xyz[v][2], 2);
    }
    if (!plain) { tmio_int(t, 1, 4); tmio_double(t, 3); tmio_int(t, -1, 1); tmio_int(t, 0, 4); tmio_int(t, -1, 1); }
    for (k = 0; k < 2; k++) {
        if (!plain) tmio_int(t, 77, 2);
        tmio_int(t, 3 + k, plain ? 1 : 4);
        for (v = 0; v < 3 + k; v++) tmio_int(t, v, plain ? 4 : 2);
        if (!plain) { tmio_int(t, 1, 1); tmio_float(t, 0.5); }
    }
    if (!plain) { tmio_int(t, 77, 2); tmio_int(t, 2, 4); tmio_int(t, 0, 2); tmio_int(t, 1, 2); tmio_int(t, 0, 1); }
}

static void tmio_test_ply_binary(void)
{
    static tmio_bytes t;
    mio_mesh m;
    mio_error e;
    int kind;
    for (kind = 0; kind < 4; kind++) {
        tmio_make_ply(&t, kind & 1, kind >> 1);
        CHECK_MSG(tmio_load_bytes(&m, &e, kind & 1 ? "a.ply" : "a.off", t.b, t.n) == 0, "%s", e.text);
        CHECK(m.n == 4 && m.n_faces == 2 && m.n_small_faces == (kind < 2) && m.format && strcmp(m.format, "PLY binary") == 0);
        CHECK(tmio_vertex_is(&m, 0, 0.5, 0, -1) && tmio_vertex_is(&m, 3, 0, 1, -4));
        CHECK(tmio_face_is(&m, 0, 3, 0, 1, 2, 0) && tmio_face_is(&m, 1, 4, 0, 1, 2, 3));
        mio_free(&m);
    }
    tmio_make_ply(&t, 0, 1);
    tmio_bad_bytes("x.ply", t.b, t.n - 1, "x.ply", "face 1: the file ends here");
    tmio_bad_bytes("x.ply", t.b, t.n - 29, "x.ply", "2 of element face, but the file ends after 1");
    tmio_bad_bytes("x.ply", t.b, t.n - 50, "x.ply", "4 of element vertex");
    t.b[t.n - 4] = 4;                           /* the last corner */
    tmio_bad_bytes("x.ply", t.b, t.n, "x.ply", "face 1: vertex index 4 is out of range");
    t.b[t.n - 1] = 255;
    tmio_bad_bytes("x.ply", t.b, t.n, "x.ply", "face 1: vertex index -16777212");
    tmio_make_ply(&t, 0, 1);
    t.b[t.n - 30 - 4] = 0xc0;                   /* the last coordinate */
    t.b[t.n - 30 - 3] = 0x7f;
    t.b[t.n - 30 - 1] = t.b[t.n - 30 - 2] = 0xff;
    tmio_bad_bytes("x.ply", t.b, t.n, "x.ply", "vertex 3: z is");
    tmio_make_ply(&t, 0, 0);
    tmio_bad_bytes("x.ply", t.b, t.n - 1, "x.ply", "face 2: the file ends here");
    t.n = 0;                                    /* lines that end with \r, and data that begin with \n */
    t.big = 0;
    tmio_text(&t, "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty char x\rproperty char y\rproperty char z\rend_header\r\n\r\n");
    CHECK_MSG(tmio_load_bytes(&m, &e, "b.ply", t.b, t.n) == 0 && tmio_vertex_is(&m, 0, 10, 13, 10), "%s", e.text);
    mio_free(&m);
    t.n = 0;
    tmio_text(&t, "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 1\r\nproperty char x\r\nproperty char y\r\nproperty char z\r\n"
                  "element nothing 9000000000\r\nend_header\r\n\n\r\n");
    CHECK_MSG(tmio_load_bytes(&m, &e, "c.ply", t.b, t.n) == 0 && tmio_vertex_is(&m, 0, 10, 13, 10), "%s", e.text);
    mio_free(&m);
}

/* ---- STL ---- */

static void tmio_make_stl(tmio_bytes *t, const char *head)
{
    static const int corner[2][3] = {{0, 1, 2}, {2, 1, 3}};
    static const double xyz[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5}};
    int f, c, k;
    t->n = 0;
    t->big = 0;
    tmio_text(t, head);
    while (t->n < 80) tmio_int(t, 0, 1);
    tmio_int(t, 2, 4);
    for (f = 0; f < 2; f++) {
        for (k = 0; k < 3; k++) tmio_float(t, 0);
        for (c = 0; c < 3; c++) for (k = 0; k < 3; k++) tmio_float(t, f && xyz[corner[f][c]][k] == 0 ? -0.0 : xyz[corner[f][c]][k]);
        tmio_int(t, 0, 2);
    }
}

static void tmio_test_stl(void)
{
    static tmio_bytes t;
    mio_mesh m;
    mio_error e;
    int kind;
    for (kind = 0; kind < 2; kind++) {
        tmio_make_stl(&t, kind ? "solid facet, it says" : "");
        CHECK_MSG(tmio_load_bytes(&m, &e, kind ? "a.stl" : "a", t.b, t.n) == 0, "%s", e.text);
        CHECK(m.n == 4 && tmio_vertex_is(&m, 3, 1, 1, 0.5) && tmio_face_is(&m, 0, 3, 0, 1, 2, 0) && tmio_face_is(&m, 1, 3, 2, 1, 3, 0));
        mio_free(&m);
    }
    tmio_bad_bytes("x.stl", t.b, t.n - 1, "x.stl", "the file ends in triangle 1");
    tmio_make_stl(&t, "");
    tmio_bad_bytes("x.stl", t.b, 60, "x.stl", "inside the header");
    t.b[80] = t.b[81] = t.b[82] = t.b[83] = 255;
    tmio_bad_bytes("x.stl", t.b, t.n, "x.stl", "4294967295 triangles");
    tmio_make_stl(&t, "");
    t.b[84 + 50 + 12 + 12 + 7] = 0x7f;          /* second face, second corner, y */
    t.b[84 + 50 + 12 + 12 + 6] = 0x80;
    tmio_bad_bytes("x.stl", t.b, t.n, "x.stl", "face 1: y of corner 1 is inf");

    m = tmio_good("b.stl", "solid my facet\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1e0 0\n  endloop\n endfacet\nendsolid my facet\n"
                           "SOLID\r\nFACET NORMAL nan nan nan OUTER LOOP VERTEX 0 1 0 VERTEX 1 -0 0 VERTEX 1 1 0 ENDLOOP ENDFACET\r\nENDSOLID\r\n", "STL ascii", 4, 2);
    CHECK(tmio_face_is(&m, 0, 3, 0, 1, 2, 0) && tmio_face_is(&m, 1, 3, 2, 1, 3, 0));
    mio_free(&m);
    tmio_bad("x.stl", "solid\nendsolid\n", "x.stl", "no vertices found");
    tmio_bad("x.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n", "x.stl:6", "'vertex'");
    tmio_bad("x.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 inf\n", "x.stl:5", "'inf'");
    tmio_bad("x.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\nendsolid\n", "x.stl:7", "'endfacet'");
    tmio_bad("x.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n", "x.stl:9", "endsolid");
    tmio_bad("x.stl", "solid a\nfacet normal 0 0 1\nvertex 0 0 0\n", "x.stl:3", "'vertex'");
}

/* ---- tables ---- */

/* Loads a table that must be good; the caller frees it. NULL otherwise. */
static double *tmio_table(const char *name, const void *data, size_t size, int64_t rows, int32_t cols)
{
    const char *const path = tmio_path(name);
    double *v;
    int64_t r;
    int32_t c;
    mio_error e;
    int status;
    tmio_put(path, data, size);
    e.text[0] = 0;
    status = mio_load_table(&v, &r, &c, path, NULL, &e);
    CHECK_MSG(status == 0 && r == rows && c == cols, "%s: %d, %lld x %ld %s", name, status, (long long)r, (long)c, e.text);
    remove(path);
    if (status == 0 && r == rows && c == cols) return v;
    free(v);
    return NULL;
}

static void tmio_bad_table(const char *name, const void *data, size_t size, const char *where, const char *what)
{
    const char *const path = tmio_path(name);
    double *v;
    int64_t r, *lines;
    int32_t c;
    mio_error e;
    char begin[128];
    int status;
    tmio_put(path, data, size);
    e.text[0] = 0;
    status = mio_load_table_lines(&v, &r, &c, &lines, path, NULL, &e);
    snprintf(begin, sizeof begin, "/%s: ", where);
    CHECK_MSG(status == MIO_FAILED && !v && !lines && strstr(e.text, begin) && strstr(e.text, what), "expected %s and '%s', got: %s", where, what, e.text);
    remove(path);
}

static void tmio_make_npy(tmio_bytes *t, const char *descr, const char *order, const char *dims, int version)
{
    char head[200];
    int n;
    t->n = 0;
    t->big = 0;
    n = snprintf(head, sizeof head, "{'descr': '%s', 'fortran_order': %s, 'shape': %s, }   \n", descr, order, dims);
    tmio_text(t, "\x93NUMPY");
    tmio_int(t, version, 1);
    tmio_int(t, 0, 1);
    tmio_int(t, n, version == 1 ? 2 : 4);
    tmio_text(t, head);
    t->big = descr[0] == '>';
}

static void tmio_test_table_text(void)
{
    const char *const text = "# c\n\n1 2.5\r\n\t3 ,  -4e1 # row\n 5,6\n";
    static const char *const named[] = {"a,b\n3,4\n", "\n# c\n_x 10h2\r\n3 4\r\n", "\"a, b\",\"c\"\"d\"\n3,4",
                                        "nano,info\n3,4", "\xef\xbb\xbfv1, v2\n3, 4\n"};
    double *v = tmio_table("a.txt", text, strlen(text), 3, 2);
    int i;
    int64_t r, *lines;
    int32_t c;
    mio_error e;
    if (v) CHECK(v[0] == 1 && v[1] == 3 && v[2] == 5 && v[3] == 2.5 && v[4] == -40 && v[5] == 6);
    free(v);
    v = tmio_table("b.csv", "7", 1, 1, 1);
    free(v);
    tmio_put(tmio_path("c.txt"), text, strlen(text));
    CHECK(mio_load_table_lines(&v, &r, &c, &lines, tmio_path("c.txt"), NULL, &e) == 0 && lines && lines[0] == 3 && lines[1] == 4 && lines[2] == 5);
    free(v);
    free(lines);
    remove(tmio_path("c.txt"));
    for (i = 0; i < (int)(sizeof named / sizeof *named); i++) {     /* a first line of names is no row */
        v = tmio_table("n.csv", named[i], strlen(named[i]), 1, 2);
        CHECK_MSG(v && v[0] == 3 && v[1] == 4, "%s", named[i]);
        free(v);
    }
    tmio_bad_table("x.csv", "a 1\n2 3\n", 8, "x.csv:1", "'a'");
    tmio_bad_table("x.csv", "nan,b\n2,3\n", 10, "x.csv:1", "'nan'");
    tmio_bad_table("x.csv", "a,-Inf\n2,3\n", 11, "x.csv:1", "'a'");
    tmio_bad_table("x.csv", "a,b\nc,d\n", 8, "x.csv:2", "'c'");
    tmio_bad_table("x.csv", "a,b\n", 4, "x.csv", "no numbers");
    tmio_bad_table("x.txt", "1 2\n3\n", 6, "x.txt:2", "1 columns, but 2");
    tmio_bad_table("x.txt", "1 2\n3 zwei\n", 11, "x.txt:2", "'zwei'");
    tmio_bad_table("x.txt", "1 2\n3 nan\n", 10, "x.txt:2", "'nan'");
    tmio_bad_table("x.txt", "1 2\n\n3 -inf\n", 12, "x.txt:3", "'-inf'");
    tmio_bad_table("x.csv", "1,,2\n", 5, "x.csv:1", "comma");
    tmio_bad_table("x.csv", "1,2,\n", 5, "x.csv:1", "comma");
    tmio_bad_table("x.csv", "1,2\n,3\n", 7, "x.csv:2", "comma");
    tmio_bad_table("x.csv", "1;2\n", 4, "x.csv:1", "';'");
    tmio_bad_table("x.csv", "\xff\xfe" "1\0,\0002\0\n", 9, "x.csv", "UTF-16");
    tmio_bad_table("x.txt", "\x1f\x8b\x08", 3, "x.txt", "gzip");
    tmio_bad_table("x.txt", "", 0, "x.txt", "no numbers");
    tmio_bad_table("x.txt", "# c\n\n", 5, "x.txt", "no numbers");
    CHECK(mio_load_table(&v, &r, &c, tmio_path("not-there.txt"), NULL, &e) == MIO_FAILED && strstr(e.text, "not-there.txt: cannot open"));
}

static void tmio_test_table_npy(void)
{
    static const char *const types[] = {"<f8", ">f8", "<f4", ">f4", "<i8", ">i4", "<i2", "|i1", "<u4"};
    static tmio_bytes t;
    double *v;
    size_t i;
    int k, r, c;
    for (i = 0; i < sizeof types / sizeof *types; i++)
        for (k = 0; k < 3; k++) {               /* C order, Fortran order, one dimension */
            const int size = types[i][2] - '0';
            tmio_make_npy(&t, types[i], k == 1 ? "True" : "False", k == 2 ? "(6,)" : "(3, 2)", k + 1);
            for (r = 0; r < 6; r++) {
                const int value = k == 0 ? (r % 2) * 3 + r / 2 : r;         /* in memory afterwards: 0 1 2 3 4 5 */
                if (types[i][1] != 'f') tmio_int(&t, value, size);
                else if (size == 8) tmio_double(&t, value);
                else tmio_float(&t, value);
            }
            v = tmio_table("a.npy", t.b, t.n, k == 2 ? 6 : 3, k == 2 ? 1 : 2);
            for (c = 0; v && c < 6; c++) CHECK_MSG(v[c] == c, "%s %d: value %d is %g", types[i], k, c, v[c]);
            free(v);
        }
    tmio_make_npy(&t, "<i4", "False", "(1,)", 1);
    tmio_int(&t, -5, 4);
    v = tmio_table("b", t.b, t.n, 1, 1);
    CHECK(v && v[0] == -5);
    free(v);
    tmio_make_npy(&t, "<f8", "False", "(2, 1)", 1);
    tmio_double(&t, 1);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "2 x 1");
    tmio_int(&t, INT64_C(0x7ff8000000000000), 8);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "row 1, column 0");
    tmio_bad_table("x.npy", t.b, 9, "x.npy", "inside the header");
    tmio_bad_table("x.npy", t.b, 30, "x.npy", "inside the header");
    tmio_bad_table("x.npy", "1 2\n", 4, "x.npy", "not a .npy");
    tmio_make_npy(&t, "<c8", "False", "(1,)", 1);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "type");
    tmio_make_npy(&t, "<f8", "False", "(1, 1, 1)", 1);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "3 dimensions");
    tmio_make_npy(&t, "<f8", "False", "()", 1);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "0 dimensions");
    tmio_make_npy(&t, "<f8", "False", "(0, 3)", 1);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "empty");
    tmio_make_npy(&t, "<f8", "False", "(999999999999999, 999999999)", 1);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "announced");
    tmio_make_npy(&t, "<f8", "False", "(1152921504606846976, 16)", 1);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "1152921504606846976 x 16 numbers");
    tmio_make_npy(&t, "<f8", "False", "(9223372036854775808, 16)", 1);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "announces 9223372036854775808, more");
    tmio_make_npy(&t, "<f8", "Maybe", "(1,)", 1);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "order");
    tmio_make_npy(&t, "<f8", "False", "(1,)", 9);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "version 9");
}

/* ---- writers ---- */

/* A mesh of a triangle, a quad and a pentagon on six vertices, and a field of two columns on it. */
typedef struct tmio_sample {
    mio_mesh m;
    double xyz[18], values[12];
    int64_t ptr[4];
    int32_t idx[12], id0[6], id1[6];
    const int32_t *ids[2];
    const char *names[2];
    uint8_t rgb[18];
    mio_output o;
} tmio_sample;

static void tmio_sample_make(tmio_sample *s)
{
    static const int32_t idx[12] = {0, 1, 2, 0, 2, 3, 4, 4, 3, 2, 1, 5};
    int i;
    memset(s, 0, sizeof *s);
    for (i = 0; i < 18; i++) { s->xyz[i] = (i * 7 % 11) / 3.0 - 1; s->rgb[i] = (uint8_t)(i * 15); }
    for (i = 0; i < 12; i++) { s->values[i] = i == 4 ? 0 : 1e-7 / (i + 1) - 0.1 * (i > 6); s->idx[i] = idx[i]; }
    for (i = 0; i < 6; i++) { s->id0[i] = i; s->id1[i] = -100 * i; }
    s->ptr[1] = 3; s->ptr[2] = 7; s->ptr[3] = 12;
    s->m.n = 6;
    s->m.xyz = s->xyz;
    s->m.n_faces = 3;
    s->m.face_ptr = s->ptr;
    s->m.face_idx = s->idx;
    s->ids[0] = s->id0;
    s->ids[1] = s->id1;
    s->names[0] = "t < 1 & \"two\"";
    s->names[1] = "second";
    s->o.rows = 6;
    s->o.cols = 2;
    s->o.values = s->values;
    s->o.ld = 6;
}

/* Writes the sample and returns the whole output, which must fit. */
static size_t tmio_written(const tmio_sample *s, const char *name, char *buf, size_t room)
{
    const char *const path = tmio_path(name);
    mio_error e;
    size_t n;
    e.text[0] = 0;
    CHECK_MSG(mio_write(path, mio_format_of(path), &s->m, &s->o, &e) == 0, "%s", e.text);
    CHECK(!mio_temporary_set);
    n = tmio_get(path, buf, room);
    CHECK_MSG(n > 0 && n < room - 1, "%s: %lu bytes", name, (unsigned long)n);
    remove(path);
    return n;
}

static void tmio_test_write_tables(void)
{
    static tmio_sample s;
    static char buf[4096];
    int k, i;
    tmio_sample_make(&s);
    for (k = 0; k < 3; k++) {
        static const char *const names[] = {"o.txt", "o.CSV", "o.npy"};
        size_t n = tmio_written(&s, names[k], buf, sizeof buf);
        double *v = tmio_table(names[k], buf, n, 6, 2);
        CHECK(v && memcmp(v, s.values, sizeof s.values) == 0);
        free(v);
        if (k < 2) CHECK_MSG(strchr(buf, k ? ',' : ' ') && !strchr(buf, k ? ' ' : ','), "%s", buf);
        s.o.n_ids = 2;
        s.o.ids = s.ids;
        s.o.comment = "1\n2";
        n = tmio_written(&s, names[k], buf, sizeof buf);
        v = tmio_table(names[k], buf, n, 6, 4);
        for (i = 0; v && i < 6; i++) CHECK(v[i] == i && v[6 + i] == -100 * i && v[12 + i] == s.values[i] && v[18 + i] == s.values[6 + i]);
        free(v);
        if (k < 2) CHECK_MSG(strncmp(buf, "# 1 2\n0", 7) == 0, "%s", buf);
        s.o.n_ids = 0;
        s.o.comment = NULL;
    }
    CHECK(memcmp(buf, "\x93NUMPY\1\0\x76\0{'descr': '<f8', 'fortran_order': False, 'shape': (6, 4), } ", 70) == 0 && buf[127] == '\n');
    CHECK(mio_format_of("a.txt") == MIO_TXT && mio_format_of("b/a.VTU") == MIO_VTU && mio_format_of("a.png") == MIO_UNKNOWN && mio_format_of("a.d/txt") == MIO_UNKNOWN);
    CHECK(mio_has_extension("x.PnG", "png") && !mio_has_extension("png", "png") && !mio_has_extension("x.pngs", "png") && !mio_has_extension(NULL, "png"));
}

/* CSV alone begins with names, if there are any and they are wanted; and is read without them. */
static void tmio_test_csv_names(void)
{
    static tmio_sample s;
    static char buf[4000];
    static const char *const id_names[2] = {"i", "j"};
    static const char *const begin[] = {"\"t < 1 & \"\"two\"\"\",second\n",
                                        "i,j,\"t < 1 & \"\"two\"\"\",second\n0,0,", "0,0,", "0 0 "};
    int k;
    tmio_sample_make(&s);
    s.o.names = s.names;
    s.o.ids = s.ids;
    s.o.id_names = id_names;
    for (k = 0; k < 4; k++) {
        const char *const name = k < 3 ? "o.csv" : "o.txt";
        size_t n;
        s.o.n_ids = k > 0 ? 2 : 0;
        s.o.no_header = k == 2;
        n = tmio_written(&s, name, buf, sizeof buf);
        CHECK_MSG(strncmp(buf, begin[k], strlen(begin[k])) == 0, "%s", buf);
        free(tmio_table(name, buf, n, 6, s.o.n_ids + 2));
    }
}

/* The longest names that file systems have, of letters of two bytes at every place. */
static void tmio_test_long_names(void)
{
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
        CHECK(mio_temporary_path[0] && !fopen(mio_temporary_path, "rb"));
        n = (int)(strstr(mio_temporary_path, ".part") - mio_temporary_path) - 10;
        CHECK((mio_temporary_path[n] & 0x80) == 0 || (unsigned char)mio_temporary_path[n] == 0xa9);  /* whole letters */
        CHECK(tmio_get(tmio_path(name), back, sizeof back) > 8);
        remove(tmio_path(name));
    }
}

static int tmio_same_mesh(const mio_mesh *a, const mio_mesh *b)
{
    return a->n == b->n && a->n_faces == b->n_faces && memcmp(a->xyz, b->xyz, 3 * (size_t)a->n * sizeof *a->xyz) == 0 &&
           (!a->n_faces || (memcmp(a->face_ptr, b->face_ptr, ((size_t)a->n_faces + 1) * sizeof *a->face_ptr) == 0 &&
                            memcmp(a->face_idx, b->face_idx, (size_t)a->face_ptr[a->n_faces] * sizeof *a->face_idx) == 0));
}

static void tmio_test_write_meshes(void)
{
    static tmio_sample s;
    static char buf[8192];
    mio_mesh m;
    mio_error e;
    int k;
    for (k = 0; k < 4; k++) {                   /* PLY and OBJ, with everything and with next to nothing */
        const char *const name = k & 1 ? "o.obj" : "o.ply";
        size_t n;
        tmio_sample_make(&s);
        if (k < 2) { s.o.rgb = s.rgb; s.o.names = s.names; }
        else { s.m.n_faces = 0; s.o.rows = 0; s.o.cols = 0; }
        n = tmio_written(&s, name, buf, sizeof buf);
        CHECK_MSG(tmio_load_bytes(&m, &e, name, buf, n) == 0 && tmio_same_mesh(&m, &s.m), "%s", e.text);
        mio_free(&m);
        if (k == 0) CHECK(strstr(buf, "property uchar blue\nproperty double quality\nproperty double quality_1\nelement face 3\n") && strstr(buf, "comment quality_1: second\n"));
        if (k == 1) CHECK(strncmp(buf, "v -1 1.3333333333333335 0 0 0.058824 0.11765\n", 45) == 0 && strstr(buf, "\nf 1 3 4 5\n"));
        if (k == 2) CHECK(!strstr(buf, "element face") && !strstr(buf, "red"));
    }
    tmio_sample_make(&s);
    s.o.rows = 5;
    CHECK(mio_write_ply(tmio_path("o.ply"), &s.m, &s.o, &e) == MIO_FAILED && strstr(e.text, "5 rows") && mio_write_vtu(tmio_path("o.vtu"), NULL, &s.o, &e) == MIO_FAILED);
    CHECK(mio_write("o.x", MIO_UNKNOWN, &s.m, &s.o, &e) == MIO_FAILED);
}

/* A polygon of 300 corners does not fit a length of one byte. */
static void tmio_test_wide_ply(void)
{
    static double xyz[900];
    static int32_t idx[300];
    int64_t ptr[2] = {0, 300};
    mio_mesh m, back;
    mio_output o;
    mio_error e;
    int i;
    memset(&m, 0, sizeof m);
    memset(&o, 0, sizeof o);
    for (i = 0; i < 300; i++) { idx[i] = i; xyz[3 * i] = i; }
    m.n = 300; m.xyz = xyz; m.n_faces = 1; m.face_ptr = ptr; m.face_idx = idx;
    CHECK(mio_write_ply(tmio_path("w.ply"), &m, &o, &e) == 0 && mio_load(&back, tmio_path("w.ply"), NULL, &e) == 0 && tmio_same_mesh(&m, &back));
    mio_free(&back);
    remove(tmio_path("w.ply"));
}

/* The 8 bytes of a little-endian integer. */
static uint64_t tmio_u64(const char *p)
{
    uint64_t u = 0;
    int i;
    for (i = 7; i >= 0; i--) u = u << 8 | (unsigned char)p[i];
    return u;
}

static void tmio_test_vtu(void)
{
    static tmio_sample s;
    static char buf[8192];
    size_t n;
    int points;
    for (points = 0; points < 2; points++) {
        const uint64_t cells = points ? 6 : 3, corners = points ? 6 : 12;
        const char *p, *at;
        uint64_t sizes[7], i, k, x;
        tmio_sample_make(&s);
        if (points) s.m.n_faces = 0;
        s.o.rgb = s.rgb;
        s.o.names = s.names;
        n = tmio_written(&s, "o.vtu", buf, sizeof buf);
        CHECK(strstr(buf, "Scalars=\"t &lt; 1 &amp; &quot;two&quot;\"") && strstr(buf, points ? "NumberOfCells=\"6\"" : "NumberOfCells=\"3\""));
        p = strstr(buf, "encoding=\"raw\">\n_");
        CHECK(p != NULL);
        if (!p) return;
        p += 17;
        /* the data lie in the opposite order of their tags */
        sizes[6] = sizes[5] = 48; sizes[4] = 18; sizes[3] = 144; sizes[2] = 8 * corners; sizes[1] = 8 * cells; sizes[0] = cells;
        for (i = 0, k = 0; i < 7; i++) {
            char want[64];
            snprintf(want, sizeof want, "offset=\"%llu\"", (unsigned long long)k);
            CHECK_MSG(strstr(buf, want) && tmio_u64(p + k) == sizes[i], "array %d", (int)i);
            k += 8 + sizes[i];
        }
        CHECK((size_t)(p - buf) + k + 28 == n && memcmp(p + k, "\n</AppendedData>\n</VTKFile>\n", 28) == 0);
        at = p + k - 2 * 56 + 8;                /* the second column, before the first */
        for (i = 0; i < 6; i++) { memcpy(&x, &s.values[6 + i], 8); CHECK(tmio_u64(at + 8 * i) == x); }
        at = p + 8;
        CHECK(points ? at[0] == 1 && at[5] == 1 : at[0] == 5 && at[1] == 9 && at[2] == 7);
    }
}

static int tmio_stop_now(void) { return 1; }

/* Asked 20 times, then stops. */
static int tmio_stop_count;
static int tmio_stop_later(void) { return ++tmio_stop_count > 20; }

static void tmio_test_failures(void)
{
    static tmio_sample s;
    static double big[200000];
    static const char *const names[] = {"o.txt", "o.csv", "o.npy", "o.ply", "o.obj", "o.vtu"};
    char keep[64];
    mio_mesh m;
    mio_error e;
    mio_file f;
    FILE *full;
    int k;
    tmio_sample_make(&s);
    for (k = 0; k < 6; k++) {
        CHECK(mio_write(tmio_path("no/such/folder/o.txt"), MIO_TXT + k, &s.m, &s.o, &e) == MIO_FAILED && strstr(e.text, "o.txt: cannot write"));
        tmio_put(tmio_path(names[k]), "precious", 8);
        s.o.stop = tmio_stop_now;               /* what was there stays, and nothing is left beside it */
        CHECK(mio_write(tmio_path(names[k]), MIO_TXT + k, &s.m, &s.o, &e) == MIO_STOPPED && !mio_temporary_set);
        s.o.stop = NULL;
        CHECK(mio_temporary_path[0] && !fopen(mio_temporary_path, "rb"));
        CHECK(tmio_get(tmio_path(names[k]), keep, sizeof keep) == 8 && strcmp(keep, "precious") == 0);
        CHECK(mio_write(tmio_path(names[k]), MIO_TXT + k, &s.m, &s.o, &e) == 0 && tmio_get(tmio_path(names[k]), keep, sizeof keep) > 8);
        remove(tmio_path(names[k]));
    }
    CHECK(mio_file_open(&f, tmio_path("o.txt"), NULL, &e) == 0);
    mio_file_put(&f, "12", 2);
    CHECK(mio_temporary_set && f.temporary);
    full = fopen(mio_temporary_path, "rb");     /* it exists, until a signal handler says so */
    CHECK(full != NULL);
    if (full) fclose(full);
    mio_file_cancel(&f);
    CHECK(!mio_temporary_set && !fopen(mio_temporary_path, "rb") && !fopen(tmio_path("o.txt"), "rb"));
#if !defined(_WIN32)
    CHECK(mio_file_open(&f, tmio_path("o.txt"), NULL, &e) == 0);
    mio_remove_temporary();
    CHECK(!mio_temporary_set && !fopen(mio_temporary_path, "rb"));
    CHECK(mio_file_close(&f) == MIO_FAILED);
    full = fopen("/dev/full", "wb");
    if (full) {
        fclose(full);
        for (k = 0; k < 6; k++) CHECK(mio_write("/dev/full", MIO_TXT + k, &s.m, &s.o, &e) == MIO_FAILED && strstr(e.text, "/dev/full: cannot write: "));
        s.o.rows = s.o.ld = 100000;             /* more than any buffer */
        s.o.values = big;
        CHECK(mio_write_npy("/dev/full", &s.o, &e) == MIO_FAILED);
        CHECK(mio_write_text("/dev/null", &s.o, &e) == 0);
        full = fopen("/dev/null", "wb");
        CHECK(full != NULL && fputs("still a device", full) >= 0);
        if (full) fclose(full);
    }
#endif
    CHECK(mio_load(&m, tmio_path("not-there.obj"), NULL, &e) == MIO_FAILED && strstr(e.text, "not-there.obj: cannot open: ") && !m.xyz);
    CHECK(mio_load(&m, test_tmp_dir(), NULL, &e) == MIO_FAILED);
    tmio_put(tmio_path("s.obj"), "v 1 2 3\n", 8);
    CHECK(mio_load(&m, tmio_path("s.obj"), tmio_stop_now, &e) == MIO_STOPPED && !m.xyz);
    CHECK(mio_load(&m, tmio_path("s.obj"), NULL, NULL) == 0);
    mio_free(&m);
    mio_free(&m);
    remove(tmio_path("s.obj"));
    CHECK(mio_fail_at(&e, "a\nb", 7, "%d", 5) == MIO_FAILED && strcmp(e.text, "a?b:7: 5") == 0);
}

/* A large file of one row again and again, between a beginning and an end. */
typedef struct tmio_large { const char *name, *head, *row; size_t head_size, row_size; int32_t rows; const char *tail; } tmio_large;

/* Loads it; stop is asked so many times before it says so. Returns the status. */
static int tmio_load_large(const tmio_large *x, int asked)
{
    const char *const path = tmio_path(x->name);
    mio_error e;
    mio_mesh m;
    double *values = NULL;
    int64_t rows;
    int32_t columns;
    const int table = strstr(x->name, "table") != NULL;
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
static void tmio_test_stop(void)
{
#define TMIO_XYZ "property float x\nproperty float y\nproperty float z\n"
    static const char binary[] = "ply\nformat binary_little_endian 1.0\nelement vertex 70000\n" TMIO_XYZ "end_header\n";
    static const char faces[] = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" TMIO_XYZ "element face 70000\n"
        "property list uchar int vertex_indices\nend_header\n\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0";
    static const char ascii[] = "ply\nformat ascii 1.0\nelement vertex 70000\n" TMIO_XYZ "end_header\n";
    static const char facet[] = "facet normal 0 0 1 outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop endfacet\n";
    static const char npy[] = "\x93NUMPY\1\0\x3c\0{'descr': '<f8', 'fortran_order': False, 'shape': (70000,)} \n";
    static const char zeros[96] = "";
    static char stl[84];
    const tmio_large all[] = {
        {"l.obj", "", "v 1 2 3\n", 0, 8, 70000, ""}, {"l.off", "OFF\n70000 0 0\n", "1 2 3\n", 14, 6, 70000, ""}, {"l.ply", ascii, "1 2 3\n", sizeof ascii - 1, 6, 70000, ""},
        {"v.ply", binary, zeros, sizeof binary - 1, 12, 70000, ""}, {"f.ply", faces, "\3\0\0\0\0\1\0\0\0\2\0\0\0", sizeof faces - 1, 13, 70000, ""},
        {"l.stl", "solid\n", facet, 6, sizeof facet - 1, 70000, "endsolid\n"}, {"b.stl", stl, zeros, 84, 50, 70000, ""}, {"l.xyz", "", "1 2 3\n", 0, 6, 70000, ""},
        {"table.txt", "", "1 2\n", 0, 4, 70000, ""}, {"table.npy", npy, zeros, sizeof npy - 1, 8, 70000, ""}};
    size_t k;
    int32_t i;
    int asked;
    memcpy(stl + 80, "\x70\x11\x01", 4);           /* 70000 triangles */
    for (k = 0; k < sizeof all / sizeof all[0]; k++) {
        const tmio_large *const x = all + k;
        FILE *const f = fopen(tmio_path(x->name), "wb");
        if (!CHECK(f != NULL)) continue;
        fwrite(x->head, 1, x->head_size, f);
        for (i = 0; i < x->rows; i++) fwrite(x->row, 1, x->row_size, f);
        CHECK(fputs(x->tail, f) >= 0 && fclose(f) == 0);
        for (asked = 1; asked < 100 && tmio_load_large(x, asked) == MIO_STOPPED; asked++) {}
        CHECK_MSG(asked > 3 && asked < 100, "%s: asked %d times", x->name, asked);
        CHECK(tmio_stop_count == 20);            /* and not once more than that */
        remove(tmio_path(x->name));
    }
#undef TMIO_XYZ
}

/* The reader puts corners of STL in the same place together, however many there are. */
static void tmio_test_large_stl(void)
{
    enum { SIDE = 60 };
    FILE *const f = fopen(tmio_path("side.stl"), "wb");
    static const int turn[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    mio_mesh m;
    mio_error e;
    int x, y, c;
    if (!CHECK(f != NULL)) return;
    fputs("solid s\n", f);
    for (y = 0; y < SIDE; y++) for (x = 0; x < SIDE; x++) for (c = 0; c < 6; c++) {
        if (c % 3 == 0) fputs("facet normal 0 0 1\nouter loop\n", f);
        fprintf(f, "vertex %d %d 0\n", x + turn[c][0], y + turn[c][1]);
        if (c % 3 == 2) fputs("endloop\nendfacet\n", f);
    }
    CHECK(fputs("endsolid s\n", f) >= 0 && fclose(f) == 0);
    CHECK_MSG(mio_load(&m, tmio_path("side.stl"), NULL, &e) == 0, "%s", e.text);
    CHECK(m.n == (SIDE + 1) * (SIDE + 1) && m.n_faces == 2 * SIDE * SIDE);
    for (x = 0, c = 1; x < 6 * SIDE * SIDE && m.n > 0; x++) {     /* corner by corner, as they were written */
        const int cell = x / 6;
        c = c && tmio_vertex_is(&m, m.face_idx[x], cell % SIDE + turn[x % 6][0], cell / SIDE + turn[x % 6][1], 0);
    }
    CHECK(c);
    mio_free(&m);
    remove(tmio_path("side.stl"));
}

/* Words that are nearly others, names nearly keys, and callers that want no message. */
static void tmio_test_nearly(void)
{
    static tmio_bytes t;
    static tmio_sample s;
    static char buf[8192], name[400];
    const double nan_value = mio_is_finite(0) ? strtod("nan", NULL) : 0;
    mio_mesh m;
    mio_error e;
    double *v;
    tmio_bad("x.obj", "v nab 0 0\nv 1 0 0\nf 1 2 1\n", "x.obj:1", "'nab'");
    tmio_bad("x.obj", "v inx 0 0\nv 1 0 0\nf 1 2 1\n", "x.obj:1", "'inx'");
    tmio_bad("x.obj", "v n 0 0\nv 1 0 0\nf 1 2 1\n", "x.obj:1", "'n'");
    tmio_fine("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nfo 1 2 3\n", "OBJ", 3, 1);
    tmio_fine("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nfog 1 2 3\nf 1 2 3\n", "OBJ", 3, 1);
    tmio_fine("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf", "OBJ", 3, 1);
    tmio_bad("x.off", "4nOFF\n3 1 0\n", "x.off:1", "nOFF");
    tmio_fine("a.xyz", "// points\n2\n1;2;3\n4,5,6\n", "XYZ", 2, 0);
    v = tmio_table("a.csv", "nax,ina\n1,2\n3,4\n", 16, 2, 2);
    CHECK(v && v[0] == 1 && v[3] == 4);
    free(v);
    tmio_make_npy(&t, "|u1", "False", "(2L, 1L)", 1);
    tmio_text(&t, "\1\2");
    v = tmio_table("a.npy", t.b, t.n, 2, 1);
    CHECK(v && v[0] == 1 && v[1] == 2);
    free(v);
    tmio_make_npy(&t, "|b1", "False", "(2,)", 1);
    tmio_text(&t, "\1\2");
    v = tmio_table("a.npy", t.b, t.n, 2, 1);
    CHECK(v && v[0] == 1);
    free(v);
    tmio_make_npy(&t, "<u8", "False", "(1,)", 1);
    tmio_int(&t, (int64_t)1 << 62, 8);
    v = tmio_table("a.npy", t.b, t.n, 1, 1);
    CHECK(v && v[0] == ldexp(1, 62));
    free(v);
    tmio_make_npy(&t, "<f8", "False", "(0, 3)", 1);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "empty");
    tmio_make_npy(&t, "<f8", "False", "(3, 0)", 1);
    tmio_bad_table("x.npy", t.b, t.n, "x.npy", "empty");
    memset(name, 'x', sizeof name - 1);
    CHECK(mio_load(&m, name, NULL, &e) == MIO_FAILED && strncmp(e.text, "...xxx", 6) == 0 && strlen(e.text) < 300);
    CHECK(mio_load(&m, name, NULL, NULL) == MIO_FAILED);
    tmio_put(tmio_path("x.off"), "OFF\n1 1 0\n0 0 0\n", 17);
    CHECK(mio_load(&m, tmio_path("x.off"), NULL, NULL) == MIO_FAILED);
    remove(tmio_path("x.off"));
    mio_free(NULL);
    tmio_sample_make(&s);
    s.names[0] = "a > 'b'\n\tc";
    s.o.names = s.names;
    s.values[0] = nan_value;
    tmio_written(&s, "o.vtu", buf, sizeof buf);
    CHECK(strstr(buf, "a &gt; &apos;b&apos;  c"));
    tmio_written(&s, "o.txt", buf, sizeof buf);
    CHECK(strncmp(buf, "nan ", 4) == 0);
    s.o.cols = 0;
    s.o.rgb = s.rgb;
    tmio_written(&s, "o.vtu", buf, sizeof buf);
    CHECK(!strstr(buf, "Scalars="));
    s.o.rows = 5;
    CHECK(mio_write(tmio_path("o.obj"), MIO_OBJ, &s.m, &s.o, &e) == MIO_FAILED && !fopen(tmio_path("o.obj"), "rb"));
}

static void tmio_test_triangulate(void)
{
    static const int32_t want[18] = {0, 1, 2, 0, 2, 3, 0, 3, 4, 4, 3, 2, 4, 2, 1, 4, 1, 5}, face[6] = {0, 1, 1, 2, 2, 2};
    static tmio_sample s;
    int32_t *tri, *of, n;
    mio_error e;
    tmio_sample_make(&s);
    CHECK(mio_triangulate(&s.m, &tri, &n, &of, &e) == 0 && n == 6 && memcmp(tri, want, sizeof want) == 0 && memcmp(of, face, sizeof face) == 0);
    free(tri);
    free(of);
    s.m.n_faces = 0;
    CHECK(mio_triangulate(&s.m, &tri, &n, NULL, &e) == 0 && n == 0 && tri);
    free(tri);
}

/* ---- what is rare ---- */

static int tmio_never(void) { return 0; }

/* What is rare in text, but allowed or told. */
static void tmio_test_rare_text(void)
{
    static char small[100100];
    const char *const head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
    char text[512];
    mio_mesh m;
    double x = 1;
    memset(small, '0', sizeof small);
    memcpy(small, "0.", 2);
    memcpy(small + sizeof small - 3, "17", 3);
    CHECK(mio_number(small, &x) == small + sizeof small - 1 && x == 0);
    CHECK(!mio_has_extension("a.3ds", "obj") && !mio_has_extension("a.1", "obj"));
    m = tmio_good("a.off", "noff\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2", "OFF", 3, 1);    /* not nOFF */
    CHECK(tmio_vertex_is(&m, 2, 0, 1, 0) && tmio_face_is(&m, 0, 3, 0, 1, 2, 0));
    mio_free(&m);
    tmio_bad("x.off", "OFF 1", "x.off:1", "number of faces");
    m = tmio_good("a", "about\nv\t1 2 3\nf\t1 1 1\n", "OBJ", 1, 1);          /* the second line tells */
    CHECK(tmio_vertex_is(&m, 0, 1, 2, 3));
    mio_free(&m);
    tmio_bad("x", "about\nv  \nv of\n", "x", "neither the content nor the name");
    m = tmio_good("a.dat", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n5 5 5\n", "XYZ", 6, 0);       /* one line too much for an OFF */
    CHECK(tmio_vertex_is(&m, 0, 3, 1, 0) && tmio_vertex_is(&m, 5, 5, 5, 5));
    mio_free(&m);
    tmio_bad("x.xyz", "1 2 3\n/ 5 6\n", "x.xyz:2", "'/'");
    tmio_bad("x.xyz", "1 2 \\\n3\n", "x.xyz:1", "'\\'");
    tmio_bad("x.csv", "x,y,z\n", "x.csv:1", "'x'");
    tmio_bad("x.pts", "x y z\n", "x.pts:1", "'x'");
    tmio_bad("x.dat", "# nothing\n", "x.dat", "nothing but comments");
    tmio_bad("x.stl", "facet normal 0 0 1 outer loop vertex 0 0 0\n", "x.stl:2", "before 'endsolid'");
    snprintf(text, sizeof text, "%selement face 0\nproperty int q\nend_header\n1 2 3\n", head);
    tmio_fine("a.ply", text, "PLY ascii", 1, 0);
    snprintf(text, sizeof text, "%sproperty float q\nend_header\n1 2 3\n", head);
    tmio_bad("x.ply", text, "x.ply:9", "too few numbers for vertex 0");
    snprintf(text, sizeof text, "%sproperty list uchar int q\nend_header\n1 2 3 1e16 1\n", head);
    tmio_bad("x.ply", text, "x.ply:9", "a list of length 1e+16");
    snprintf(text, sizeof text, "%sproperty list uchar int q\nend_header\n1 2 3 1.5 1 1\n", head);
    tmio_bad("x.ply", text, "x.ply:9", "a list of length 1.5");
    tmio_bad("x.ply", "ply\rformat ascii 1.0\relement vertex 1\rproperty int x\rproperty int y\rproperty int z\rend_header", "x.ply:7", "vertex 0");
    tmio_bad_table("x.csv", "a,-nan\n2,3\n", 11, "x.csv:1", "'a'");
    tmio_bad_table("x.csv", "a,+inf\n2,3\n", 11, "x.csv:1", "'a'");
    free(tmio_table("a.csv", "a,-infra\n2,3\n", 13, 1, 2));
}

/* A binary PLY of one face per row of `corners`, with these properties of vertices and faces. */
static void tmio_begin_ply(tmio_bytes *t, int vertices, const char *x, const char *y, const char *z, int faces, const char *properties)
{
    char head[400];
    t->n = 0;
    t->big = 0;
    snprintf(head, sizeof head, "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty %s x\nproperty %s y\nproperty %s z\nelement face %d\n%send_header\n",
             vertices, x, y, z, faces, properties);
    tmio_text(t, head);
}

static void tmio_corners(tmio_bytes *t, int count, int size)
{
    int i;
    for (i = 0; i < count; i++) tmio_int(t, i, size);
}

/* Properties in unusual orders and types, around the corners of faces too. */
static void tmio_test_rare_ply(void)
{
    static const char *const faces[4] = {"property list uchar uint vertex_indices\nproperty short q\n", "property list uchar short vertex_indices\n",
                                         "property list uchar float uv\nproperty list uchar int vertex_indices\n",
                                         "property uchar q\nproperty list uchar int vertex_indices\nproperty double r\n"};
    static tmio_bytes t;
    mio_mesh m;
    mio_error e;
    int k, f, i;
    for (k = 0; k < 4; k++) {
        tmio_begin_ply(&t, 3, "float", k % 2 ? "float" : "double", "double", 2, faces[k]);
        for (i = 0; i < 3; i++) {
            tmio_float(&t, i + 0.5);
            if (k % 2) tmio_float(&t, 2.5);
            else tmio_double(&t, 2.5);
            tmio_double(&t, -i);
        }
        for (f = 0; f < 2; f++) {
            if (k == 2) { tmio_int(&t, 1, 1); tmio_float(&t, 7); }
            if (k == 3) tmio_int(&t, 7, 1);
            tmio_int(&t, 3, 1);
            tmio_corners(&t, 3, k == 1 ? 2 : 4);
            if (k == 0) tmio_int(&t, 7, 2);
            if (k == 3) tmio_double(&t, 7);
        }
        CHECK_MSG(tmio_load_bytes(&m, &e, "a.ply", t.b, t.n) == 0, "%d: %s", k, e.text);
        CHECK(m.n == 3 && m.n_faces == 2 && tmio_vertex_is(&m, 2, 2.5, 2.5, -2) && tmio_face_is(&m, 1, 3, 0, 1, 2, 0));
        mio_free(&m);
    }
    tmio_begin_ply(&t, 6, "char", "char", "char", 100, "property list uchar int vertex_indices\n");   /* more corners than triangles have */
    for (i = 0; i < 6; i++) tmio_corners(&t, 3, 1);
    for (f = 0; f < 100; f++) { tmio_int(&t, 6, 1); tmio_corners(&t, 6, 4); }
    CHECK_MSG(tmio_load_bytes(&m, &e, "a.ply", t.b, t.n) == 0, "%s", e.text);
    CHECK(m.n == 6 && m.n_faces == 100 && m.face_ptr[100] == 600 && m.face_idx[599] == 5 && m.face_idx[300] == 0);
    mio_free(&m);
}

/* Tables with inf and nan, where these are wanted; and headers of .npy files that end too early. */
static void tmio_test_rare_tables(void)
{
    const char *const text = "d,e\n1 inf\n-Infinity NaN\n+INF -nan\n";
    static const char *const heads[] = {"{'descr'", "{'descr': <f8', 'fortran_order': False, 'shape': (1,), }", "{'descr': '<f", "{'descr': 'f8'  , 'shape': (1,)}",
                                        "{'descr': '|b1 ', 'shape': (1,)}", "{'descr':  ", "{'descr' : :"};
    static tmio_bytes t;
    double *v = NULL;
    int64_t rows, total = 0;
    int32_t cols;
    mio_error e;
    size_t i;
    tmio_put(tmio_path("a.txt"), text, strlen(text));
    CHECK_MSG(mio_load_field(&v, &rows, &cols, tmio_path("a.txt"), NULL, &e) == 0 && rows == 3 && cols == 2, "%s", e.text);
    CHECK(v && v[0] == 1 && v[1] == -HUGE_VAL && v[2] == HUGE_VAL && v[3] == HUGE_VAL && v[4] != v[4] && v[5] != v[5]);
    free(v);
    for (i = 0; i < 4; i++) {
        static const char *const wrong[4] = {"1\ninfinit\n", "1\n1e999\n", "1\nnana\n", "1\n- inf\n"};
        tmio_put(tmio_path("a.txt"), wrong[i], strlen(wrong[i]));
        CHECK_MSG(mio_load_field(&v, &rows, &cols, tmio_path("a.txt"), NULL, &e) == MIO_FAILED && strstr(e.text, "a.txt:2: "), "%s", wrong[i]);
    }
    remove(tmio_path("a.txt"));
    tmio_make_npy(&t, "<f8", "False", "(2,)", 1);
    tmio_double(&t, HUGE_VAL);
    tmio_double(&t, (double)NAN);
    tmio_put(tmio_path("a.npy"), t.b, t.n);
    CHECK(mio_load_field(&v, &rows, &cols, tmio_path("a.npy"), NULL, &e) == 0 && rows == 2 && v[0] == HUGE_VAL && v[1] != v[1]);
    free(v);
    remove(tmio_path("a.npy"));
    for (i = 0; i < sizeof heads / sizeof *heads; i++, total += rows) {
        t.n = 0;
        t.big = 0;
        tmio_text(&t, "\x93NUMPY\1");
        tmio_int(&t, 0, 1);
        tmio_int(&t, (int64_t)strlen(heads[i]), 2);
        tmio_text(&t, heads[i]);
        rows = 1;
        tmio_bad_table("x.npy", t.b, t.n, "x.npy", "the type of its numbers");
    }
    CHECK(total == 7);
}

/* Two files at once, a stop that never comes, names with line ends or none, callers that want no message. */
static void tmio_test_rare_calls(void)
{
    static tmio_sample s;
    static char buf[4096];
    static mio_file a, b;
    mio_mesh m;
    mio_error e;
    int32_t *tri, n;
    CHECK(mio_file_open(&a, tmio_path("one.txt"), tmio_never, &e) == 0 && mio_file_open(&b, tmio_path("two.txt"), NULL, &e) == 0);
    CHECK(strcmp(mio_temporary_path, a.temporary) == 0 && strcmp(a.temporary, b.temporary) != 0);
    mio_file_put(&a, "1", 1);
    mio_file_put(&b, "2", 1);
    CHECK(mio_file_close(&b) == 0 && mio_temporary_set && mio_file_close(&a) == 0 && !mio_temporary_set);
    CHECK(tmio_get(tmio_path("one.txt"), buf, sizeof buf) == 1 && buf[0] == '1' && tmio_get(tmio_path("two.txt"), buf, sizeof buf) == 1 && buf[0] == '2');
    remove(tmio_path("one.txt"));
    remove(tmio_path("two.txt"));
    CHECK(mio_file_open(&a, tmio_path("no/such/folder/x.txt"), NULL, &e) == MIO_FAILED);
    mio_file_cancel(&a);
    CHECK(a.status == MIO_FAILED && strstr(e.text, "cannot write"));
    tmio_sample_make(&s);
    s.names[0] = "a\nb";
    s.o.names = s.names;
    tmio_written(&s, "o.csv", buf, sizeof buf);
    CHECK_MSG(strncmp(buf, "\"a b\",second\n", 13) == 0, "%s", buf);
    s.o.n_ids = 2;
    s.o.ids = s.ids;
    s.o.id_names = NULL;                         /* not all columns have names */
    tmio_written(&s, "o.csv", buf, sizeof buf);
    CHECK_MSG(strncmp(buf, "0,0,", 4) == 0, "%s", buf);
    CHECK(mio_triangulate(&s.m, &tri, &n, NULL, &e) == 0 && n == 6 && tri[17] == 5);
    free(tri);
    tmio_put(tmio_path("x.ply"), "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nproperty int z\nend_header\n1 2\n", 98);
    CHECK(mio_load(&m, tmio_path("x.ply"), NULL, NULL) == MIO_FAILED && !m.xyz);
    remove(tmio_path("x.ply"));
}

/* ---- broken files ---- */

/* Loads, and checks what holds for whatever the file was. Returns the status. */
static int tmio_survive(const char *name, const void *data, size_t size, int table)
{
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
        for (i = 0; status == 0 && i < m.face_ptr[m.n_faces]; i++) if (m.face_idx[i] < 0 || m.face_idx[i] >= m.n) CHECK_MSG(0, "an index out of range");
        for (i = 0; status == 0 && i < m.n_faces; i++) if (m.face_ptr[i + 1] - m.face_ptr[i] < 3) CHECK_MSG(0, "a face of fewer than 3 corners");
        CHECK(status != 0 || m.n > 0);
        mio_free(&m);
    }
    remove(path);
    if (status != 0 && (status != MIO_FAILED || !strstr(e.text, name) || strchr(e.text, '\n'))) CHECK_MSG(0, "%s: %d, '%s'", name, status, e.text);
    return status;
}

/* Every beginning of a good file, and some thousand files with a few wrong bytes. `least`: no shorter beginning is good. */
static void tmio_break(const char *name, const void *data, size_t size, size_t least, int table)
{
    static unsigned char buf[8192];
    uint64_t seed = 0x9e3779b97f4a7c15u;
    size_t k;
    int i, n;
    CHECK_MSG(tmio_survive(name, data, size, table) == 0, "%s: the whole file is refused", name);
    for (k = 0; k < size; k++) if (tmio_survive(name, data, k, table) == 0 && k < least) CHECK_MSG(0, "%s: accepted after %lu bytes", name, (unsigned long)k);
    for (i = 0; i < 400; i++) {
        size_t length = size;
        memcpy(buf, data, size);
        for (n = 0; n <= i % 4; n++) {
            size_t at;
            seed ^= seed << 13; seed ^= seed >> 7; seed ^= seed << 17;
            at = (size_t)(seed >> 8) % length;
            switch (seed >> 60) {
            case 0: case 1: buf[at] = (unsigned char)(buf[at] ^ 1u << (seed & 7)); break;
            case 2: case 3: buf[at] = (unsigned char)(seed & 255); break;
            case 4: buf[at] = 0; break;
            case 5: buf[at] = 255; break;
            case 6: buf[at] = '-'; break;
            case 7: buf[at] = '\n'; break;
            case 8: buf[at] = '9'; break;
            case 9: memmove(buf + at, buf + at + 1, length - at - 1); if (length > 1) length--; break;
            case 10: if (length < sizeof buf - 1) { memmove(buf + at + 1, buf + at, length - at); length++; } break;
            default: buf[at] = buf[(size_t)(seed >> 20) % length]; break;
            }
        }
        (void)tmio_survive(name, buf, length, table);
    }
}

static void tmio_test_broken(void)
{
    static const char obj[] = "v 0 0 0\nv 1.5 0 -2e1\nv 0 1 0.123456789012345678\nf 1 2 3\nf -1/1 -2/2/2 -3//3 \\\n1\nl 1 2\n# end\n";
    static const char off[] = "OFF # c\n4 2 0\n0 0 0\n1 0 0\n0 1 0 255 0 0\n1 1 1.25\n3 0 1 2\n4 0 1 3 2 0.5 0.5 0.5\n";
    static const char ply[] = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty double y\nproperty float z\nelement face 1\n"
                              "property list uchar int vertex_index\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                              "0 0 0\n1 0 0\n0 1 0\n1 1 0.5\n4 0 1 3 2\n6 0 1 2 -1 3 2\n";
    static const char stl[] = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
    static const char xyz[] = "3\n# c\n0 0 0\n1,2,3\n4 5 6 7 8 9\n";
    static const char table[] = "# c\n1 2\n3,4\n-5e3\t6.25\n";
    static tmio_bytes t;
    static tmio_sample s;
    static char buf[8192];
    uint64_t seed = 12345;
    size_t n, k;
    int kind;
    tmio_break("t.obj", obj, sizeof obj - 1, 7, 0);
    tmio_break("t.off", off, sizeof off - 1, sizeof off - 20, 0);
    tmio_break("t.ply", ply, sizeof ply - 1, sizeof ply - 2, 0);
    tmio_break("t.stl", stl, sizeof stl - 1, sizeof stl - 4, 0);
    tmio_break("t.xyz", xyz, sizeof xyz - 1, sizeof xyz - 11, 0);
    tmio_break("t", off, sizeof off - 1, 0, 0);
    tmio_break("t.txt", table, sizeof table - 1, 0, 1);
    for (kind = 0; kind < 4; kind++) {
        tmio_make_ply(&t, kind & 1, kind >> 1);
        tmio_break("tb.ply", t.b, t.n, t.n, 0);
    }
    tmio_make_stl(&t, "solid");
    tmio_break("tb.stl", t.b, t.n, t.n, 0);
    tmio_make_npy(&t, "<f4", "True", "(2, 2)", 1);
    for (k = 0; k < 4; k++) tmio_float(&t, (double)k);
    tmio_break("t.npy", t.b, t.n, t.n, 1);
    tmio_sample_make(&s);
    n = tmio_written(&s, "o.ply", buf, sizeof buf);
    tmio_break("o.ply", buf, n, n, 0);
    for (kind = 0; kind < 200; kind++) {        /* bytes at random, under every name */
        static const char *const names[] = {"r.obj", "r.off", "r.ply", "r.stl", "r.xyz", "r", "r.txt", "r.npy"};
        for (k = 0; k < 600; k++) {
            seed ^= seed << 13; seed ^= seed >> 7; seed ^= seed << 17;
            buf[k] = (char)(unsigned char)(seed >> 24 & 255);
        }
        CHECK(tmio_survive(names[kind & 7], buf, 600, (kind & 7) > 5) == MIO_FAILED);
    }
}

static void test_meshio(void)
{
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
    tmio_test_write_meshes();
    tmio_test_wide_ply();
    tmio_test_vtu();
    tmio_test_csv_names();
    tmio_test_long_names();
    tmio_test_failures();
    tmio_test_stop();
    tmio_test_large_stl();
    tmio_test_nearly();
    tmio_test_rare_text();
    tmio_test_rare_ply();
    tmio_test_rare_tables();
    tmio_test_rare_calls();
    tmio_test_triangulate();
    tmio_test_broken();
}

#endif
