/* meshio.h - meshes, point sets and tables of numbers: read from and written to files; for tools and tests, only the C library

   Reads  OBJ, OFF, PLY, STL, XYZ (meshes and point sets), and fields as text, CSV or .npy.
   Writes text, CSV, .npy, PLY, OBJ, VTU, and meshes alone as OFF and STL. All functions are static.

       mio_mesh mesh;  mio_error e;  mio_output out = {0};
       if (mio_load(&mesh, "bunny.obj", NULL, &e) < 0) { fprintf(stderr, "%s\n", e.text); return 1; }
       out.rows = mesh.n;  out.cols = 1;  out.values = u;  out.ld = mesh.n;
       if (mio_write("u.npy", mio_format_of("u.npy"), &mesh, &out, &e) < 0) ...
       mio_free(&mesh);

   Every function that can fail returns 0, or MIO_FAILED (-1) with one line of text in the mio_error, or MIO_STOPPED (-2) when
   the caller's stop() said so. After anything but 0 the outputs are empty and need no freeing (freeing them is harmless).
   The text reads `FILE:LINE: what is wrong`; in binary files, where there are no lines, `FILE: face 12: what is wrong`. Lines
   count from 1, as editors do; vertices, faces, rows and columns count from 0, as everywhere in this library.

   stop() may be NULL. Otherwise it is asked now and then; nonzero ends the work. A signal handler should be installed
   without SA_RESTART, so that it also ends a wait for standard input.

   Numbers are read and written with the decimal point of the "C" locale: programs that include this leave LC_NUMERIC alone.

   Contents: [1] errors and memory  [2] the whole file  [3] numbers in text  [4] mesh under construction  [5] OBJ  [6] OFF
             [7] PLY  [8] STL  [9] XYZ  [10] which format  [11] tables  [12] output files  [13] writers */

#ifndef MESHIO_H
#define MESHIO_H

#include <errno.h>
#include <float.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Two things standard C cannot do: tell a device from a file (renaming something onto /dev/null would do harm), and remove a
   file from a signal handler with a function that promises to be safe there. */
#include <sys/types.h>
#include <sys/stat.h>
#if defined(_WIN32)
#include <fcntl.h>
#include <io.h>
#else
#include <unistd.h>
#endif

enum { MIO_OK = 0, MIO_FAILED = -1, MIO_STOPPED = -2 };

typedef struct mio_error {
    char text[512];             /* one line, without a line end */
} mio_error;

/* A mesh, or a point set when n_faces is 0. Vertices are in file order, those that no face uses included. */
typedef struct mio_mesh {
    int32_t n;
    double *xyz;                /* [3n], all finite */
    int32_t n_faces;            /* faces with at least 3 corners, in file order, nothing repaired */
    int64_t *face_ptr;          /* [n_faces+1], always there: the corners of face f are face_idx[face_ptr[f]..face_ptr[f+1]-1] */
    int32_t *face_idx;          /* [face_ptr[n_faces]], all in 0..n-1; may be NULL for point sets */
    const char *format;         /* what it was read as: "OBJ", "OFF", "PLY ascii", "PLY binary", "STL ascii", "STL binary", "XYZ" */
    int64_t n_small_faces;      /* faces with fewer than 3 corners: left out */
} mio_mesh;

/* What the writers write. Zeros are fine for what is not needed. Nothing is copied or kept. */
typedef struct mio_output {
    int64_t rows;               /* of the table; for meshes n, or 0 when there is no field */
    int32_t cols;
    const double *values;       /* column c, row r: values[c*ld + r] */
    int64_t ld;                 /* rows, when the columns follow one another */
    int32_t n_ids;              /* text, CSV, .npy: this many columns of integers come first */
    const int32_t *const *ids;  /* [n_ids] arrays of `rows` integers */
    const char *const *id_names;            /* [n_ids] for CSV, where there are names */
    const char *comment;        /* text and CSV: first line, after "# "; no line end in it. NULL: none */
    const char *const *names;   /* [cols] names of the columns for CSV, PLY (as comments) and VTU, or NULL */
    int no_header;              /* CSV: no line of names */
    const uint8_t *rgb;         /* [3 rows] colours of the vertices for PLY, OBJ, VTU, or NULL: no colours */
    int (*stop)(void);
} mio_output;

enum { MIO_UNKNOWN = 0, MIO_TXT, MIO_CSV, MIO_NPY, MIO_PLY, MIO_OBJ, MIO_VTU, MIO_OFF, MIO_STL };

/* A file being written, or standard output. Written beside its target under another name and renamed when complete, so that
   the target is either as it was or whole. Devices (and what lies in /dev) are written as they are; a symbolic link is replaced
   by the file. */
typedef struct mio_file {
    FILE *stream;
    const char *path;           /* NULL: standard output */
    char *temporary;            /* NULL when written directly */
    int (*stop)(void);
    mio_error *e;
    int status;                 /* MIO_OK, or why nothing more is written */
    size_t used;
    char buffer[65536];
} mio_file;

/* ---- The functions ----

   Reading
     int  mio_load(mio_mesh *m, const char *path, int (*stop)(void), mio_error *e);
              "-" reads standard input (named <stdin> in messages). Format by content, then by extension.
     void mio_free(mio_mesh *m);
     int  mio_triangulate(const mio_mesh *m, int32_t **tri, int32_t *n_tri, int32_t **face_of_tri, mio_error *e);
              Fans from each face's first corner; tri[3*n_tri]; face_of_tri[n_tri] may be NULL. The caller frees both.
     int  mio_load_table(double **values, int64_t *rows, int32_t *cols, const char *path, int (*stop)(void), mio_error *e);
              Text (white space or commas, # comments, blank lines; a first line of words without any number,
              the names of the columns, is skipped) or .npy (floats and integers, 1-d or 2-d).
              values[c*rows + r], all finite, at least one row and one column; the caller frees it. "-" reads standard input.
     int  mio_load_table_lines(double **values, int64_t *rows, int32_t *cols, int64_t **lines, const char *path,
                               int (*stop)(void), mio_error *e);
              The same, and lines[rows], the line of each row for messages (NULL when the table is binary). The caller frees it.
     int  mio_load_field(double **values, int64_t *rows, int32_t *cols, const char *path, int (*stop)(void), mio_error *e);
              As mio_load_table, but inf and nan are values too: distances are infinite where no way leads.
     int  mio_fail_at(mio_error *e, const char *path, int64_t line, const char *format, ...);
              Writes `PATH:LINE: ...` (line < 1: `PATH: ...`) and returns MIO_FAILED: for the caller's own complaints.

   Writing: all return 0, MIO_FAILED or MIO_STOPPED; path NULL or "-" is standard output (which is flushed, not closed).
     int  mio_format_of(const char *path);               by extension, any case: MIO_TXT.. MIO_VTU, which take fields, or MIO_UNKNOWN
     int  mio_mesh_format_of(const char *path);          the same of a mesh without fields: MIO_PLY.. or, for .xyz, MIO_TXT
     int  mio_has_extension(const char *path, const char *extension);       extension without the dot, any case
     int  mio_write(const char *path, int format, const mio_mesh *m, const mio_output *o, mio_error *e);
              m may be NULL for MIO_TXT, MIO_CSV, MIO_NPY. Meshes with a field: o->rows must be m->n.
     int  mio_write_text(const char *path, const mio_output *o, mio_error *e);            "%.17g", separated by blanks
     int  mio_write_csv(const char *path, const mio_output *o, mio_error *e);             the same with commas, below a line of names
     int  mio_write_npy(const char *path, const mio_output *o, mio_error *e);             float64, little endian, (rows, columns)
     int  mio_write_ply(const char *path, const mio_mesh *m, const mio_output *o, mio_error *e);   binary; field: quality, quality_1..
     int  mio_write_obj(const char *path, const mio_mesh *m, const mio_output *o, mio_error *e);   v x y z r g b
     int  mio_write_vtu(const char *path, const mio_mesh *m, const mio_output *o, mio_error *e);   field as point data, raw
     int  mio_write_off(const char *path, const mio_mesh *m, const mio_output *o, mio_error *e);   the mesh alone
     int  mio_write_stl(const char *path, const mio_mesh *m, const mio_output *o, mio_error *e);   binary; polygons as fans; 32 bits a coordinate

   Files of your own (pictures): open, put, close. After a failure the rest is ignored; close reports the first one.
     int  mio_file_open(mio_file *f, const char *path, int (*stop)(void), mio_error *e);
     void mio_file_put(mio_file *f, const void *data, size_t size);
     int  mio_file_close(mio_file *f);                   also after a failure: cleans up
     void mio_file_cancel(mio_file *f);                  close, but throw away what was written

   Signals
     void mio_remove_temporary(void);                    removes the unfinished file, if there is one; safe in a handler */

/* ==== [1] errors and memory ==== */

/* Copies text into a message without anything that would break the line. A long one keeps its end: of a path that is what tells. */
static void mio_clean(char *to, size_t room, const char *text)
{
    const size_t n = strlen(text), skip = n < room ? 0 : n - room + 4;
    size_t k = 0, i;
    if (skip) for (; k < 3; k++) to[k] = '.';
    for (i = skip; i < n; i++) to[k++] = (char)((unsigned char)text[i] < 32 || text[i] == 127 ? '?' : text[i]);
    to[k] = 0;
}

static int mio_fail_va(mio_error *e, const char *path, int64_t line, const char *format, va_list args)
{
    char name[256], what[224];
    mio_clean(name, sizeof name, path ? path : "<stdout>");
    vsnprintf(what, sizeof what, format, args);
    if (!e) return MIO_FAILED;
    if (line > 0) snprintf(e->text, sizeof e->text, "%s:%lld: %s", name, (long long)line, what);
    else snprintf(e->text, sizeof e->text, "%s: %s", name, what);
    return MIO_FAILED;
}

static int mio_fail_at(mio_error *e, const char *path, int64_t line, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    mio_fail_va(e, path, line, format, args);
    va_end(args);
    return MIO_FAILED;
}

static void *mio_alloc(size_t count, size_t size)
{
    if (size != 0 && count > SIZE_MAX / size) return NULL;
    return malloc(count * size > 0 ? count * size : 1);
}

/* Makes room for `need` items of `size` bytes, at least doubling. Returns the block, or NULL with the old one untouched. */
static void *mio_grow(void *block, size_t *room, size_t need, size_t size)
{
    const size_t most = SIZE_MAX / 2 / size;
    size_t n = *room < 64 ? 64 : *room;
    void *q;
    if (need > most) return NULL;
    while (n < need) n = n > most / 2 ? most : 2 * n;
    q = realloc(block, n * size);
    if (q) *room = n;
    return q;
}

static int mio_is_finite(double x)
{
    uint64_t u;
    memcpy(&u, &x, sizeof u);
    return (u >> 52 & 0x7ff) != 0x7ff;          /* by its bits: true also where the compiler believes that no number is infinite */
}

static int mio_has_extension(const char *path, const char *extension)
{
    const char *dot = path ? strrchr(path, '.') : NULL;
    size_t i;
    if (!dot || strchr(dot, '/')) return 0;
    for (i = 0; extension[i] && dot[i + 1]; i++) {
        const char c = dot[i + 1];
        if ((c >= 'A' && c <= 'Z' ? (char)(c + 32) : c) != extension[i]) return 0;
    }
    return !extension[i] && !dot[i + 1];
}

/* ==== [2] the whole file ==== */
/* Files are read whole: one pass over memory is the fastest way to read them, and sizes in headers can be compared with what
   is really there before anything is allocated for them. */

typedef struct mio_in {
    const char *p, *end;        /* what is not read yet; *end is 0, so that looking one byte ahead is safe */
    int64_t line;               /* of p, from 1; for text */
    char *data;
    size_t size;
    const char *path, *name;    /* name: path, or <stdin> */
    int (*stop)(void);
    uint32_t ticks;
    int spread;                 /* a record may go on in the next line */
    int comma;                  /* 1: commas and semicolons separate numbers as blanks do; 2: they end a number, but are no blanks */
    int hash;                   /* # begins a comment */
    int joins;                  /* a backslash before the line end joins two lines */
    int infinite;               /* inf and nan are numbers of a table */
    mio_error *e;
} mio_in;

static int mio_fail(const mio_in *in, int64_t line, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    mio_fail_va(in->e, in->name, line, format, args);
    va_end(args);
    return MIO_FAILED;
}

static int mio_no_memory(const mio_in *in) { return mio_fail(in, 0, "not enough memory for this file"); }

/* Asks stop() once in a while. To be called per record. */
static int mio_tick(mio_in *in) { return (++in->ticks & 0xffff) == 0 && in->stop && in->stop() ? MIO_STOPPED : MIO_OK; }

static void mio_close(mio_in *in)
{
    free(in->data);
    in->data = NULL;
}

/* Is this neither a file nor a pipe: one like /dev/zero, which never ends? */
static int mio_is_device(const char *path)
{
#if defined(S_ISCHR)
    struct stat st;
    return stat(path, &st) == 0 && S_ISCHR(st.st_mode);
#else
    (void)path;
    return 0;
#endif
}

static int mio_read_all(mio_in *in, FILE *f)
{
    const size_t longest = (size_t)1 << 24;             /* that a terminal would be believed */
    size_t room = 0, block = 1 << 16, got;
    do {
        char *q = (char *)mio_grow(in->data, &room, in->size + block + 1, 1);
        if (!q) return mio_no_memory(in);
        in->data = q;
        got = fread(q + in->size, 1, block, f);
        in->size += got;
        if (in->stop && in->stop()) return MIO_STOPPED;
        if (in->size > longest && mio_is_device(in->path)) return mio_fail(in, 0, "a device that has no end");
        if (got < block && ferror(f)) return mio_fail(in, 0, "cannot read: %s", strerror(errno));
        if (block < (size_t)1 << 24) block *= 2;
    } while (!feof(f));
    in->data[in->size] = 0;
    return MIO_OK;
}

static void mio_begin(mio_in *in, const char *path, int (*stop)(void), mio_error *e)
{
    memset(in, 0, sizeof *in);
    in->path = path;
    in->name = strcmp(path, "-") == 0 ? "<stdin>" : path;
    in->stop = stop;
    in->e = e;
    in->line = 1;
}

/* The content is there: reading starts at its first byte. */
static void mio_rewind(mio_in *in)
{
    static const unsigned char bom[3] = {0xef, 0xbb, 0xbf};
    in->p = in->data;
    in->end = in->data + in->size;
    if (in->size >= 3 && memcmp(in->data, bom, 3) == 0) in->p += 3;        /* a mark that some editors leave */
}

static int mio_open(mio_in *in, const char *path, int (*stop)(void), mio_error *e)
{
    const int standard = strcmp(path, "-") == 0;
    FILE *f = stdin;
    int status;
    mio_begin(in, path, stop, e);
    if (!standard) f = fopen(path, "rb");
#if defined(_WIN32)
    if (standard) (void)_setmode(_fileno(stdin), _O_BINARY);
#endif
    if (!f) return mio_fail(in, 0, "cannot open: %s", strerror(errno));
    status = mio_read_all(in, f);
    if (!standard) fclose(f);
    if (status != MIO_OK) { mio_close(in); return status; }
    mio_rewind(in);
    return MIO_OK;
}

/* What has to be turned into something else before it can be read: says so. Editors and shells of Windows write
   UTF-16 with a mark in front. */
static int mio_refuse(const mio_in *in)
{
    const unsigned char *const p = (const unsigned char *)in->data;
    if (in->size < 2) return MIO_OK;
    if (p[0] == 0x1f && p[1] == 0x8b) return mio_fail(in, 0, "compressed with gzip: please unpack it first");
    if ((p[0] == 0xff && p[1] == 0xfe) || (p[0] == 0xfe && p[1] == 0xff))
        return mio_fail(in, 0, "text in UTF-16: please save it as UTF-8 first");
    return MIO_OK;
}

static size_t mio_left(const mio_in *in) { return (size_t)(in->end - in->p); }

/* ==== [3] numbers in text ==== */

static int mio_eol(char c) { return c == '\n' || c == '\r'; }

/* Ends a token, whatever the format. A zero byte ends the file, or is read as a bad character by those who then ask for more. */
static int mio_is_end(const mio_in *in, char c)
{
    if ((unsigned char)c > ' ') return (in->comma && (c == ',' || c == ';')) || (in->hash && c == '#') || (in->joins && c == '\\');
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* Steps over a line end of any kind: \n, \r\n, \r. */
static void mio_cross(mio_in *in)
{
    if (in->p >= in->end) return;
    if (in->p[0] == '\r' && in->p[1] == '\n') in->p++;
    in->p++;
    in->line++;
}

/* To the end of the line, but not over it. */
static void mio_to_eol(mio_in *in)
{
    const char *p = in->p, *const end = in->end;
    while (p < end && !mio_eol(*p)) p++;
    in->p = p;
}

static void mio_next_line(mio_in *in)
{
    mio_to_eol(in);
    mio_cross(in);
}

/* Skips blanks within the line. Returns 1 when something other than a comment follows on it. */
static int mio_blanks(mio_in *in)
{
    for (;;) {
        const char c = *in->p;
        if (c == ' ' || c == '\t' || c == '\v' || c == '\f' || (in->comma == 1 && (c == ',' || c == ';'))) in->p++;
        else if (c == '\\' && in->joins && in->p + 1 < in->end && mio_eol(in->p[1])) { in->p++; mio_cross(in); }
        else break;
    }
    return in->p < in->end && !mio_eol(*in->p) && !(in->hash && *in->p == '#');
}

/* Skips blanks, comments and line ends. Returns 1 when something follows. */
static int mio_space(mio_in *in)
{
    while (!mio_blanks(in)) {
        if (in->p >= in->end) return 0;
        mio_next_line(in);
    }
    return 1;
}

/* The end of the token that begins at p. */
static const char *mio_token_end(const mio_in *in, const char *p)
{
    const char *const begin = p;
    while (p < in->end && !mio_is_end(in, *p)) p++;
    return p > begin || p >= in->end ? p : p + 1;       /* a lone backslash is a token too */
}

/* The token at p for a message: at most 40 characters, and only what every terminal shows. Returns buf. */
static const char *mio_show(const mio_in *in, const char *p, char buf[48])
{
    const char *const q = mio_token_end(in, p);
    size_t n = (size_t)(q - p), i;
    const int cut = n > 40;
    if (cut) n = 37;
    for (i = 0; i < n; i++) buf[i] = p[i] >= ' ' && p[i] <= '~' ? p[i] : '?';
    if (cut) for (i = 37; i < 40; i++) buf[i] = '.';
    buf[cut ? 40 : n] = 0;
    return buf;
}

/* m * 10^e, correctly rounded, for 2^53 < m < 10^19 and 1 <= |e| <= 22, or returns 0 (one case in some hundred thousand).
   The quotient (or product) in double, and what it misses, itself to some 50 bits: unless the sum lies so near the middle
   between two doubles that those bits do not decide, both ends of the uncertainty round to the same double, the right one. */
static int mio_scale_wide(uint64_t m, int e, double power, double *x)
{
    const double split = 134217729.0;                   /* 2^27 + 1: halves of 26 bits, products of which are exact */
    const double hi = (double)m, lo = (uint64_t)hi >= m ? -(double)((uint64_t)hi - m) : (double)(m - (uint64_t)hi);
    const double a = e < 0 ? hi / power : hi;
    volatile double product = a * power, sa = split * a, sb = split * power;   /* rounded here, whatever the compiler likes to fuse */
    const double p = product, as = sa, ah = as - (as - a), al = a - ah, bs = sb, bh = bs - (bs - power), bl = power - bh;
    const double missing = ((ah * bh - p) + ah * bl + al * bh) + al * bl;             /* a * power = p + missing, exactly */
    const double base = e < 0 ? a : p;
    const double rest = e < 0 ? ((hi - p) - missing + lo) / power : missing + lo * power;
    const double slack = (rest < 0 ? -rest : rest) * 8.9e-16 + base * 1e-31;
    const double down = base + (rest - slack), up = base + (rest + slack);
    *x = up;
    return down == up;
}

/* Reads a decimal number at p, without leading blanks. Returns its end, or NULL when there is none (nan and inf are none).
   Too large a number comes out infinite. Correctly rounded always. */
static const char *mio_number(const char *p, double *x)
{
    static const double ten[23] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17,
                                   1e18, 1e19, 1e20, 1e21, 1e22};
    const char *const begin = p, *first, *point = NULL;
    uint64_t m = 0;
    int digits, exponent = 0, minus;
    minus = *p == '-';
    if (*p == '-' || *p == '+') p++;
    first = p;
    while (*p == '0') p++;
    digits = 0;
    for (;; p++) {
        const unsigned d = (unsigned)(unsigned char)*p - '0';
        if (d <= 9) {
            if (digits < 19) m = 10 * m + d;
            if (digits < 1000 && m) digits++;
        } else if (*p == '.' && !point) {
            point = p;
        } else break;
    }
    if (p - first == (point ? 1 : 0)) return NULL;      /* not one digit */
    if (point) exponent = (int)(point + 1 - p < -100000 ? -100000 : point + 1 - p);
    if (*p == 'e' || *p == 'E') {
        const char *q = p + 1;
        const int down = *q == '-';
        int k = 0;
        if (*q == '-' || *q == '+') q++;
        if (*q < '0' || *q > '9') return NULL;
        for (; *q >= '0' && *q <= '9'; q++) if (k < 100000) k = 10 * k + (*q - '0');
        exponent += down ? -k : k;
        p = q;
    }
    if (m == 0) {
        *x = minus ? -0.0 : 0.0;
        return p;
    }
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD == 0
    if (digits <= 19 && exponent >= -22 && exponent <= 22) {
        double y;
        int good = 1;
        if (m <= (uint64_t)1 << 53) y = exponent < 0 ? (double)m / ten[-exponent] : (double)m * ten[exponent];
        else if (exponent == 0) y = (double)m;
        else good = mio_scale_wide(m, exponent, ten[exponent < 0 ? -exponent : exponent], &y);
        if (good) { *x = minus ? -y : y; return p; }
    }
#else
    (void)ten; (void)mio_scale_wide;
#endif
    if (digits < 1000 && digits + exponent > 310) {     /* for certain, and without raising the overflow flag */
        *x = minus ? -HUGE_VAL : HUGE_VAL;
        return p;
    }
    *x = strtod(begin, NULL);           /* in place: the bytes up to p were found to be a number, and what follows ends it */
    return p;
}

/* Reads an integer at p as mio_number does. Those beyond INT64_MAX become it: they are out of any range we have. */
static const char *mio_integer(const char *p, int64_t *x)
{
    const int minus = *p == '-';
    int64_t v = 0;
    if (*p == '-' || *p == '+') p++;
    if (*p < '0' || *p > '9') return NULL;
    for (; *p >= '0' && *p <= '9'; p++) v = v < INT64_MAX / 10 ? 10 * v + (*p - '0') : INT64_MAX;
    *x = minus ? -v : v;
    return p;
}

static int mio_more(mio_in *in) { return in->spread ? mio_space(in) : mio_blanks(in); }

/* Does it begin as nan or inf, in any case and with any sign? */
static int mio_not_finite(const char *w)
{
    if (*w == '-' || *w == '+') w++;
    return ((w[0] | 32) == 'n' && (w[1] | 32) == 'a' && (w[2] | 32) == 'n') ||
           ((w[0] | 32) == 'i' && (w[1] | 32) == 'n' && (w[2] | 32) == 'f');
}

/* Names what stands at p instead of a number. */
static int mio_no_number(const mio_in *in)
{
    char word[48];
    if (mio_not_finite(mio_show(in, in->p, word)))
        return mio_fail(in, in->line, "'%s' is not a finite number", word);
    return mio_fail(in, in->line, "'%s' is not a number", word);
}

/* Takes the number that begins at p, and nothing but a whole token. */
static int mio_take_number(mio_in *in, double *x)
{
    const char *const q = mio_number(in->p, x);
    char word[48];
    if (!q || (q < in->end && !mio_is_end(in, *q))) return mio_no_number(in);
    if (!mio_is_finite(*x)) return mio_fail(in, in->line, "'%s' is too large a number", mio_show(in, in->p, word));
    in->p = q;
    return MIO_OK;
}

/* The same for an integer; `what` says what it should have been. */
static int mio_take_integer(mio_in *in, int64_t *x, const char *what)
{
    const char *const q = mio_integer(in->p, x);
    char word[48];
    if (!q || (q < in->end && !mio_is_end(in, *q))) return mio_fail(in, in->line, "'%s' is not %s", mio_show(in, in->p, word), what);
    in->p = q;
    return MIO_OK;
}

/* Reads inf, infinity or nan at p, in any case and with any sign, as mio_number does. */
static const char *mio_infinite(const char *p, double *x)
{
    static const char *const words[3] = {"infinity", "inf", "nan"};
    const int minus = *p == '-';
    int i;
    if (*p == '-' || *p == '+') p++;
    for (i = 0; i < 3; i++) {
        size_t k = 0;
        while (words[i][k] && (p[k] | 32) == words[i][k]) k++;
        if (words[i][k]) continue;
        *x = i == 2 ? (double)NAN : minus ? -HUGE_VAL : HUGE_VAL;
        return p + k;
    }
    return NULL;
}

/* Takes the value of a table that begins at p. */
static int mio_take_value(mio_in *in, double *x)
{
    const char *const q = in->infinite ? mio_infinite(in->p, x) : NULL;
    if (!q || (q < in->end && !mio_is_end(in, *q))) return mio_take_number(in, x);
    in->p = q;
    return MIO_OK;
}

static int mio_take_coordinates(mio_in *in, double x[3])
{
    int k;
    for (k = 0; k < 3; k++) {
        if (!mio_more(in)) return mio_fail(in, in->line, "a vertex needs 3 coordinates, %s %d", in->spread ? "the file ends after" : "this line has", k);
        if (mio_take_number(in, &x[k]) < 0) return MIO_FAILED;
    }
    return MIO_OK;
}

/* ==== [4] mesh under construction ==== */

typedef struct mio_build {
    double *xyz;
    int32_t *idx;
    int64_t *ptr;               /* ends of faces */
    size_t n, n_idx, n_faces, room_xyz, room_idx, room_ptr;     /* n: vertices */
    int64_t small;
} mio_build;

static void mio_build_free(mio_build *b)
{
    free(b->xyz); free(b->idx); free(b->ptr);
    memset(b, 0, sizeof *b);
}

/* Starts again with the memory it has. */
static void mio_build_reset(mio_build *b)
{
    b->n = b->n_idx = b->n_faces = 0;
    b->small = 0;
}

static int mio_reserve_vertices(const mio_in *in, mio_build *b, size_t n)
{
    double *q;
    if (n > (size_t)INT32_MAX) return mio_fail(in, 0, "more than %ld vertices", (long)INT32_MAX);
    if (3 * n <= b->room_xyz) return MIO_OK;
    q = (double *)mio_grow(b->xyz, &b->room_xyz, 3 * n, sizeof *q);
    if (!q) return mio_no_memory(in);
    b->xyz = q;
    return MIO_OK;
}

static int mio_reserve_corners(const mio_in *in, mio_build *b, size_t n)
{
    int32_t *q;
    if (n <= b->room_idx) return MIO_OK;
    q = (int32_t *)mio_grow(b->idx, &b->room_idx, n, sizeof *q);
    if (!q) return mio_no_memory(in);
    b->idx = q;
    return MIO_OK;
}

static int mio_reserve_faces(const mio_in *in, mio_build *b, size_t n)
{
    int64_t *q;
    if (n > (size_t)INT32_MAX) return mio_fail(in, 0, "more than %ld faces", (long)INT32_MAX);
    if (n <= b->room_ptr) return MIO_OK;
    q = (int64_t *)mio_grow(b->ptr, &b->room_ptr, n, sizeof *q);
    if (!q) return mio_no_memory(in);
    b->ptr = q;
    return MIO_OK;
}

static int mio_add_vertex(const mio_in *in, mio_build *b, const double x[3])
{
    if (3 * b->n + 3 > b->room_xyz && mio_reserve_vertices(in, b, b->n + 1) < 0) return MIO_FAILED;
    memcpy(b->xyz + 3 * b->n++, x, 3 * sizeof *x);
    return MIO_OK;
}

static int mio_add_corner(const mio_in *in, mio_build *b, int32_t i)
{
    if (b->n_idx == b->room_idx && mio_reserve_corners(in, b, b->n_idx + 1) < 0) return MIO_FAILED;
    b->idx[b->n_idx++] = i;
    return MIO_OK;
}

/* Makes the corners added since the last face a face, or forgets and counts them when they are fewer than 3. */
static int mio_end_face(const mio_in *in, mio_build *b)
{
    const size_t begin = b->n_faces > 0 ? (size_t)b->ptr[b->n_faces - 1] : 0;
    if (b->n_idx - begin < 3) {
        b->n_idx = begin;
        b->small++;
        return MIO_OK;
    }
    if (b->n_faces == b->room_ptr && mio_reserve_faces(in, b, b->n_faces + 1) < 0) return MIO_FAILED;
    b->ptr[b->n_faces++] = (int64_t)b->n_idx;
    return MIO_OK;
}

static int mio_add_triangle(const mio_in *in, mio_build *b, int32_t i, int32_t j, int32_t k)
{
    if (mio_add_corner(in, b, i) < 0 || mio_add_corner(in, b, j) < 0 || mio_add_corner(in, b, k) < 0) return MIO_FAILED;
    return mio_end_face(in, b);
}

/* Hands the arrays over, cut to what they hold. */
static int mio_finish(const mio_in *in, mio_build *b, mio_mesh *m, const char *format)
{
    double *xyz;
    int32_t *idx;
    if (b->n == 0) return mio_fail(in, 0, "no vertices found (read as %s)", format);
    m->face_ptr = (int64_t *)mio_alloc(b->n_faces + 1, sizeof *m->face_ptr);
    if (!m->face_ptr) return mio_no_memory(in);
    m->face_ptr[0] = 0;
    if (b->n_faces) memcpy(m->face_ptr + 1, b->ptr, b->n_faces * sizeof *b->ptr);
    xyz = (double *)realloc(b->xyz, 3 * b->n * sizeof *xyz);
    m->xyz = xyz ? xyz : b->xyz;
    if (b->n_idx == 0) {
        free(b->idx);
        b->idx = NULL;
    }
    idx = b->n_idx ? (int32_t *)realloc(b->idx, b->n_idx * sizeof *idx) : NULL;
    m->face_idx = idx ? idx : b->idx;
    m->n = (int32_t)b->n;
    m->n_faces = (int32_t)b->n_faces;
    m->n_small_faces = b->small;
    m->format = format;
    b->xyz = NULL;
    b->idx = NULL;
    return MIO_OK;
}

static void mio_free(mio_mesh *m)
{
    if (!m) return;
    free(m->xyz); free(m->face_ptr); free(m->face_idx);
    memset(m, 0, sizeof *m);
}

/* ==== [5] OBJ ==== */

/* The rest of a line `f ...`. Positive indices may point to vertices that come later, so in the first pass they only raise
   *largest; `limit` is the number of vertices in the second pass, and INT64_MAX before. */
static int mio_obj_face(mio_in *in, mio_build *b, int64_t limit, int64_t *largest)
{
    char word[48];
    while (mio_blanks(in)) {
        int64_t v = 0;
        const char *const q = mio_integer(in->p, &v);
        if (!q || (q < in->end && *q != '/' && !mio_is_end(in, *q)))
            return mio_fail(in, in->line, "'%s' is not a vertex index", mio_show(in, in->p, word));
        if (v == 0) return mio_fail(in, in->line, "vertex index 0 (OBJ counts from 1)");
        v = v < 0 ? v + (int64_t)b->n : v - 1;
        if (v < 0) return mio_fail(in, in->line, "vertex index %s is out of range (%lld vertices come before it)", mio_show(in, in->p, word), (long long)b->n);
        if (v >= limit) return mio_fail(in, in->line, "vertex index %s is out of range (the file has %lld vertices)", mio_show(in, in->p, word), (long long)limit);
        if (v > *largest) *largest = v;
        if (mio_add_corner(in, b, v > INT32_MAX ? INT32_MAX : (int32_t)v) < 0) return MIO_FAILED;
        in->p = q < in->end && *q == '/' ? mio_token_end(in, q) : q;       /* texture and normal are not looked at */
    }
    return mio_end_face(in, b);
}

static int mio_obj_pass(mio_in *in, mio_build *b, int64_t limit, int64_t *largest)
{
    double x[3];
    while (mio_space(in)) {
        const char a = in->p[0], z = in->p[1];
        const int status = mio_tick(in);
        if (status != MIO_OK) return status;
        if (a == 'v' && (in->p + 1 >= in->end || mio_is_end(in, z))) {
            in->p++;
            if (mio_take_coordinates(in, x) < 0 || mio_add_vertex(in, b, x) < 0) return MIO_FAILED;
        } else if (a == 'f' && (in->p + 1 >= in->end || mio_is_end(in, z) || (z == 'o' && mio_is_end(in, in->p[2])))) {
            in->p += z == 'o' ? 2 : 1;          /* fo: what old files call a face */
            if (mio_obj_face(in, b, limit, largest) < 0) return MIO_FAILED;
        }
        mio_next_line(in);
    }
    return MIO_OK;
}

static int mio_load_obj(mio_in *in, mio_build *b, mio_mesh *m)
{
    const mio_in start = *in;
    int64_t largest = -1;
    int status;
    in->hash = in->joins = 1;
    status = mio_obj_pass(in, b, INT64_MAX, &largest);
    if (status == MIO_OK && b->n > 0 && largest >= (int64_t)b->n) {     /* read again, up to the line that is wrong */
        const int64_t n = (int64_t)b->n;
        in->p = start.p;
        in->line = start.line;
        mio_build_reset(b);
        status = mio_obj_pass(in, b, n, &largest);
    }
    return status == MIO_OK ? mio_finish(in, b, m, "OBJ") : status;
}

/* ==== [6] OFF ==== */
/* Three ways to read it, tried in this order; the second and third must end exactly where the file does, and when none succeeds
   the complaint of the first is reported, because it knows in which line a number is missing.
     lines   a record a line; what follows a record on its line (colours, normals) is skipped
     stream  only tokens, whatever the lines
     spread  a record may go on in the next lines; what follows it on its last line is skipped */
enum { MIO_OFF_LINES, MIO_OFF_STREAM, MIO_OFF_SPREAD };

static int mio_off_is_keyword(const mio_in *in, const char *p)
{
    const char *const q = mio_token_end(in, p);
    const size_t n = (size_t)(q - p);
    size_t i;
    if (n < 3 || n > 7 || (q[-3] | 32) != 'o' || (q[-2] | 32) != 'f' || (q[-1] | 32) != 'f') return 0;
    for (i = 0; i + 3 < n; i++) if (!strchr("STCN4nstc", p[i])) return 0;
    return 1;
}

static int mio_off_header(mio_in *in)
{
    const char *q;
    if (!mio_space(in) || !mio_off_is_keyword(in, in->p)) return MIO_OK;        /* some files go without */
    q = mio_token_end(in, in->p);
    if (q - in->p >= 4 && q[-4] == 'n' && q[-3] == 'O') return mio_fail(in, in->line, "nOFF, points of any dimension, is not among the formats this reads");
    in->p = q;
    if (mio_blanks(in) && mio_left(in) >= 6 && memcmp(in->p, "BINARY", 6) == 0)
        return mio_fail(in, in->line, "binary OFF is not among the formats this reads");
    return MIO_OK;
}

static int mio_off_count(mio_in *in, int64_t *count, const char *what)
{
    char word[48];
    const char *at;
    if (!mio_space(in)) return mio_fail(in, in->line, "the file ends before the number of %s", what);
    at = in->p;
    if (mio_take_integer(in, count, "a count") < 0) return MIO_FAILED;
    if (*count < 0) return mio_fail(in, in->line, "'%s' is not a count", mio_show(in, at, word));
    if (*count > INT32_MAX) return mio_fail(in, in->line, "%s %s are more than this reads", mio_show(in, at, word), what);
    return MIO_OK;
}

static int mio_off_face(mio_in *in, mio_build *b)
{
    char word[48];
    const char *at = in->p;
    int64_t k, i, v;
    if (mio_take_integer(in, &k, "a number of corners") < 0) return MIO_FAILED;
    if (k < 0 || (uint64_t)k > mio_left(in)) return mio_fail(in, in->line, "'%s' is not a number of corners", mio_show(in, at, word));
    for (i = 0; i < k; i++) {
        if (!mio_more(in)) return mio_fail(in, in->line, "a face of %lld corners, %s %lld", (long long)k,
                                           in->spread ? "the file ends after" : "but this line has only", (long long)i);
        at = in->p;
        if (mio_take_integer(in, &v, "a vertex index") < 0) return MIO_FAILED;
        if (v < 0 || v >= (int64_t)b->n)
            return mio_fail(in, in->line, "vertex index %s is out of range (the file has %lld vertices)", mio_show(in, at, word), (long long)b->n);
        if (mio_add_corner(in, b, (int32_t)v) < 0) return MIO_FAILED;
    }
    return mio_end_face(in, b);
}

static int mio_off_read(mio_in *in, mio_build *b, int way)
{
    int64_t nv, nf, edges, i;
    double x[3];
    size_t fit;
    int status;
    in->spread = way != MIO_OFF_LINES;
    in->hash = 1;
    if (mio_off_header(in) < 0 || mio_off_count(in, &nv, "vertices") < 0 || mio_off_count(in, &nf, "faces") < 0) return MIO_FAILED;
    if (way == MIO_OFF_STREAM) { if (mio_space(in) && mio_take_integer(in, &edges, "a count") < 0) return MIO_FAILED; }
    else mio_next_line(in);
    fit = (mio_left(in) + 1) / 2;       /* no more can follow, whatever the header says: a record takes 2 bytes, a vertex 6 */
    if (mio_reserve_vertices(in, b, (size_t)nv < fit / 3 ? (size_t)nv : fit / 3) < 0 || mio_reserve_faces(in, b, (size_t)nf < fit ? (size_t)nf : fit) < 0)
        return MIO_FAILED;
    for (i = 0; i < nv + nf; i++) {
        if (!mio_space(in)) return mio_fail(in, in->line, "the file ends before %s %lld of %lld", i < nv ? "vertex" : "face",
                                            (long long)(i < nv ? i + 1 : i - nv + 1), (long long)(i < nv ? nv : nf));
        if ((status = mio_tick(in)) != MIO_OK) return status;
        if (i < nv ? mio_take_coordinates(in, x) < 0 || mio_add_vertex(in, b, x) < 0 : mio_off_face(in, b) < 0) return MIO_FAILED;
        if (way != MIO_OFF_STREAM) mio_next_line(in);
    }
    if (way != MIO_OFF_LINES && mio_space(in)) return mio_fail(in, in->line, "more follows after the last face");
    return MIO_OK;
}

static int mio_load_off(mio_in *in, mio_build *b, mio_mesh *m)
{
    const mio_in start = *in;
    mio_error first;
    int way, status = MIO_FAILED;
    memset(&first, 0, sizeof first);
    for (way = MIO_OFF_LINES; way <= MIO_OFF_SPREAD && status == MIO_FAILED; way++) {
        in->p = start.p;
        in->line = start.line;
        mio_build_reset(b);
        status = mio_off_read(in, b, way);
        if (way == MIO_OFF_LINES && in->e) first = *in->e;
    }
    if (status == MIO_FAILED && in->e) *in->e = first;
    return status == MIO_OK ? mio_finish(in, b, m, "OFF") : status;
}

/* ==== [7] PLY ==== */

enum { MIO_I8, MIO_U8, MIO_I16, MIO_U16, MIO_I32, MIO_U32, MIO_F32, MIO_F64, MIO_I64, MIO_U64 };      /* the last two only in .npy */

static uint32_t mio_u32(const unsigned char *p, int big)
{
    return big ? (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3]
               : (uint32_t)p[3] << 24 | (uint32_t)p[2] << 16 | (uint32_t)p[1] << 8 | p[0];
}

static uint64_t mio_u64(const unsigned char *p, int big)
{
    return (uint64_t)mio_u32(p + (big ? 0 : 4), big) << 32 | mio_u32(p + (big ? 4 : 0), big);
}

static double mio_f32(const unsigned char *p, int big)
{
    const uint32_t u = mio_u32(p, big);
    float x;
    memcpy(&x, &u, sizeof x);
    return (double)x;
}

static double mio_f64(const unsigned char *p, int big)
{
    const uint64_t u = mio_u64(p, big);
    double x;
    memcpy(&x, &u, sizeof x);
    return x;
}

/* Written so that no conversion depends on how the machine keeps negative numbers. */
static double mio_signed(uint64_t u, int bits)
{
    const uint64_t half = (uint64_t)1 << (bits - 1), mask = half | (half - 1);
    return u & half ? -(double)(mask - u + 1) : (double)u;
}

static double mio_value(const unsigned char *p, int type, int big)
{
    const unsigned two = big ? (unsigned)p[0] << 8 : p[0];
    switch (type) {
    case MIO_I8:  return mio_signed(p[0], 8);
    case MIO_U8:  return (double)p[0];
    case MIO_I16: return mio_signed(big ? two | p[1] : two | (unsigned)p[1] << 8, 16);
    case MIO_U16: return (double)(big ? two | p[1] : two | (unsigned)p[1] << 8);
    case MIO_I32: return mio_signed(mio_u32(p, big), 32);
    case MIO_U32: return (double)mio_u32(p, big);
    case MIO_F32: return mio_f32(p, big);
    case MIO_F64: return mio_f64(p, big);
    case MIO_I64: return mio_signed(mio_u64(p, big), 64);
    default:      return (double)mio_u64(p, big);
    }
}

static size_t mio_type_size(int type)
{
    static const size_t size[10] = {1, 1, 2, 2, 4, 4, 4, 8, 8, 8};
    return size[type];
}

enum { MIO_PLY_OTHER, MIO_PLY_VERTEX, MIO_PLY_FACE, MIO_PLY_STRIPS };       /* elements */
enum { MIO_PLY_X, MIO_PLY_Y, MIO_PLY_Z, MIO_PLY_INDICES, MIO_PLY_INDEX, MIO_PLY_SKIP };   /* properties; INDICES goes before INDEX */

typedef struct mio_ply_property {
    int type, count_type, role;         /* count_type -1: one value, not a list */
} mio_ply_property;

typedef struct mio_ply_element {
    int kind;
    int64_t count, line;                /* line: in the header */
    size_t first, n;                    /* its properties */
    size_t at[MIO_PLY_SKIP];            /* the property of each role, SIZE_MAX when there is none */
    char name[32];
} mio_ply_element;

typedef struct mio_ply {
    mio_ply_property *property;
    mio_ply_element *element;
    size_t n_property, n_element, room_property, room_element;
    int ascii, big;
    int64_t n;                          /* vertices */
    const mio_ply_element *now;         /* where in the file we are, for messages */
    int64_t row;
} mio_ply;

static int mio_ply_fail(const mio_in *in, const mio_ply *s, const char *format, ...)
{
    char text[160];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (s->ascii) return mio_fail(in, in->line, "%s", text);
    return mio_fail(in, 0, "%s %lld: %s", s->now->name, (long long)s->row, text);
}

static int mio_is_word(const mio_in *in, const char *word)
{
    const size_t n = strlen(word);
    return (size_t)(mio_token_end(in, in->p) - in->p) == n && memcmp(in->p, word, n) == 0;
}

/* Steps to the next word of the line; fails when there is none. */
static int mio_ply_word(mio_in *in, const char *what)
{
    in->p = mio_token_end(in, in->p);
    return mio_blanks(in) ? MIO_OK : mio_fail(in, in->line, "%s is missing", what);
}

static int mio_ply_type(mio_in *in, int *type)
{
    static const char *const names[16] = {"char", "uchar", "short", "ushort", "int", "uint", "float", "double",
                                          "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
    char word[48];
    int i;
    for (i = 0; i < 16; i++) if (mio_is_word(in, names[i])) { *type = i & 7; return MIO_OK; }
    return mio_fail(in, in->line, "'%s' is not a PLY type", mio_show(in, in->p, word));
}

static int mio_ply_add_property(mio_in *in, mio_ply *s)
{
    static const char *const roles[MIO_PLY_SKIP] = {"x", "y", "z", "vertex_indices", "vertex_index"};
    mio_ply_element *const e = s->n_element ? &s->element[s->n_element - 1] : NULL;
    mio_ply_property p = {0, -1, MIO_PLY_SKIP}, *q;
    int i;
    if (!e) return mio_fail(in, in->line, "a property before the first element");
    if (mio_ply_word(in, "the type of the property") < 0) return MIO_FAILED;
    if (mio_is_word(in, "list")) {
        if (mio_ply_word(in, "the type of the list's length") < 0 || mio_ply_type(in, &p.count_type) < 0) return MIO_FAILED;
        if (p.count_type >= MIO_F32) return mio_fail(in, in->line, "the length of a list must be of an integer type");
        if (mio_ply_word(in, "the type of the property") < 0) return MIO_FAILED;
    }
    if (mio_ply_type(in, &p.type) < 0 || mio_ply_word(in, "the name of the property") < 0) return MIO_FAILED;
    for (i = 0; i < MIO_PLY_SKIP; i++) if (mio_is_word(in, roles[i]) && (p.count_type >= 0) == (i >= MIO_PLY_INDICES)) p.role = i;
    q = s->n_property < s->room_property ? s->property
                                         : (mio_ply_property *)mio_grow(s->property, &s->room_property, s->n_property + 1, sizeof *q);
    if (!q) return mio_no_memory(in);
    s->property = q;
    s->property[s->n_property++] = p;
    if (p.role != MIO_PLY_SKIP) e->at[p.role] = e->n;
    e->n++;
    return MIO_OK;
}

static int mio_ply_add_element(mio_in *in, mio_ply *s)
{
    mio_ply_element e, *q;
    char word[48];
    const char *at;
    size_t i;
    memset(&e, 0, sizeof e);
    e.line = in->line;
    e.first = s->n_property;
    for (i = 0; i < MIO_PLY_SKIP; i++) e.at[i] = SIZE_MAX;
    if (mio_ply_word(in, "the name of the element") < 0) return MIO_FAILED;
    e.kind = mio_is_word(in, "vertex") ? MIO_PLY_VERTEX : mio_is_word(in, "face") ? MIO_PLY_FACE : mio_is_word(in, "tristrips") ? MIO_PLY_STRIPS : 0;
    snprintf(e.name, sizeof e.name, "%.30s", mio_show(in, in->p, word));
    if (mio_ply_word(in, "the number of elements") < 0) return MIO_FAILED;
    at = in->p;
    if (mio_take_integer(in, &e.count, "a count") < 0) return MIO_FAILED;
    if (e.count < 0) return mio_fail(in, in->line, "'%s' is not a count", mio_show(in, at, word));
    if (e.kind == MIO_PLY_VERTEX) {
        for (i = 0; i < s->n_element; i++) if (s->element[i].kind == MIO_PLY_VERTEX) return mio_fail(in, in->line, "a second element 'vertex'");
        if (e.count > INT32_MAX) return mio_fail(in, in->line, "%s vertices are more than this reads", mio_show(in, at, word));
        s->n = e.count;
    }
    q = s->n_element < s->room_element ? s->element : (mio_ply_element *)mio_grow(s->element, &s->room_element, s->n_element + 1, sizeof *q);
    if (!q) return mio_no_memory(in);
    s->element = q;
    s->element[s->n_element++] = e;
    return MIO_OK;
}

static int mio_ply_check(const mio_in *in, const mio_ply *s)
{
    size_t i;
    for (i = 0; i < s->n_element; i++) {
        const mio_ply_element *const e = &s->element[i];
        int k;
        if (e->count == 0) continue;
        if (e->kind == MIO_PLY_VERTEX)
            for (k = 0; k < 3; k++) if (e->at[k] == SIZE_MAX) return mio_fail(in, e->line, "element vertex has no property '%c'", 'x' + k);
        if ((e->kind == MIO_PLY_FACE || e->kind == MIO_PLY_STRIPS) && e->at[MIO_PLY_INDICES] == SIZE_MAX && e->at[MIO_PLY_INDEX] == SIZE_MAX)
            return mio_fail(in, e->line, "element %s has no list 'vertex_indices'", e->name);
    }
    return MIO_OK;
}

static int mio_ply_format(mio_in *in, mio_ply *s)
{
    char word[48];
    if (mio_ply_word(in, "the format") < 0) return MIO_FAILED;
    s->ascii = mio_is_word(in, "ascii");
    s->big = mio_is_word(in, "binary_big_endian");
    if (s->ascii || s->big || mio_is_word(in, "binary_little_endian")) return MIO_OK;
    return mio_fail(in, in->line, "'%s' is not a PLY format", mio_show(in, in->p, word));
}

/* From `ply` to the first byte behind `end_header`. */
static int mio_ply_header(mio_in *in, mio_ply *s)
{
    int format = 0, alone, status = MIO_OK;
    char word[48];
    mio_to_eol(in);
    alone = in->p + 1 < in->end && in->p[0] == '\r' && in->p[1] != '\n';    /* lines end with \r: a \n at the end is data */
    mio_cross(in);
    for (; status == MIO_OK; mio_next_line(in)) {
        if (in->p >= in->end) return mio_fail(in, in->line, "the file ends inside the header");
        if (!mio_blanks(in) || mio_is_word(in, "comment") || mio_is_word(in, "obj_info")) continue;
        if (mio_is_word(in, "end_header")) break;
        if (mio_is_word(in, "format")) { status = mio_ply_format(in, s); format = 1; }
        else if (mio_is_word(in, "element")) status = mio_ply_add_element(in, s);
        else if (mio_is_word(in, "property")) status = mio_ply_add_property(in, s);
        else status = mio_fail(in, in->line, "'%s' does not belong in a PLY header", mio_show(in, in->p, word));
    }
    if (status != MIO_OK) return status;
    if (!format) return mio_fail(in, in->line, "the header does not say which format");
    mio_to_eol(in);
    if (alone && in->p < in->end) { in->p++; in->line++; }
    else mio_cross(in);
    return mio_ply_check(in, s);
}

/* The next value, in either format. */
static int mio_ply_get(mio_in *in, const mio_ply *s, int type, double *x)
{
    if (s->ascii) {
        if (mio_more(in)) return mio_take_number(in, x);
        return mio_fail(in, in->line, in->p >= in->end ? "the file ends inside %s %lld" : "too few numbers for %s %lld", s->now->name, (long long)s->row);
    }
    if (mio_left(in) < mio_type_size(type)) return mio_ply_fail(in, s, "the file ends here");
    *x = mio_value((const unsigned char *)in->p, type, s->big);
    in->p += mio_type_size(type);
    return MIO_OK;
}

static int mio_ply_skip(mio_in *in, const mio_ply *s, int type, size_t count)
{
    size_t i;
    if (!s->ascii) {
        if (count > mio_left(in) / mio_type_size(type)) return mio_ply_fail(in, s, "the file ends here");
        in->p += count * mio_type_size(type);
        return MIO_OK;
    }
    for (i = 0; i < count; i++) {
        double x;
        if (!mio_more(in)) return mio_ply_get(in, s, type, &x);         /* which complains */
        in->p = mio_token_end(in, in->p);
    }
    return MIO_OK;
}

/* The length of a list, not larger than the rest of the file. */
static int mio_ply_length(mio_in *in, const mio_ply *s, const mio_ply_property *p, size_t *count)
{
    double x = 0;
    if (mio_ply_get(in, s, p->count_type, &x) < 0) return MIO_FAILED;
    if (!(x >= 0) || !(x < 9e15) || (double)(int64_t)x < x) return mio_ply_fail(in, s, "a list of length %g", x);
    *count = (size_t)x;
    if (x > (double)(mio_left(in) / (s->ascii ? 2 : mio_type_size(p->type)) + 1))
        return mio_ply_fail(in, s, "a list of %.0f values, more than this file can hold", x);
    return MIO_OK;
}

static int mio_ply_index(const mio_in *in, const mio_ply *s, double x, int32_t *i)
{
    if (!(x >= 0) || !(x < (double)s->n) || (double)(int32_t)x < x)
        return mio_ply_fail(in, s, "vertex index %.12g is out of range (the file has %lld vertices)", x, (long long)s->n);
    *i = (int32_t)x;
    return MIO_OK;
}

static int mio_ply_corners(mio_in *in, const mio_ply *s, mio_build *b, const mio_ply_property *p, size_t count)
{
    size_t k;
    for (k = 0; k < count; k++) {
        double x = 0;
        int32_t i = 0;
        if (mio_ply_get(in, s, p->type, &x) < 0 || mio_ply_index(in, s, x, &i) < 0 || mio_add_corner(in, b, i) < 0) return MIO_FAILED;
    }
    return mio_end_face(in, b);
}

/* A strip: each corner makes a triangle with the two before it, every other one turned round; -1 begins anew. */
static int mio_ply_strip(mio_in *in, const mio_ply *s, mio_build *b, const mio_ply_property *p, size_t count)
{
    int32_t i = 0, j = 0, k = 0;
    size_t c, run = 0;
    for (c = 0; c < count; c++) {
        double x = 0;
        if (mio_ply_get(in, s, p->type, &x) < 0) return MIO_FAILED;
        if (x == -1) { run = 0; continue; }
        i = j;
        j = k;
        if (mio_ply_index(in, s, x, &k) < 0) return MIO_FAILED;
        if (++run >= 3 && mio_add_triangle(in, b, run % 2 ? i : j, run % 2 ? j : i, k) < 0) return MIO_FAILED;
    }
    return MIO_OK;
}

/* Bytes that a row takes at least (in ascii a digit and what ends it). */
static size_t mio_ply_least(const mio_ply *s, const mio_ply_element *e)
{
    size_t i, sum = 0;
    for (i = e->first; i < e->first + e->n; i++) {
        const mio_ply_property *const p = &s->property[i];
        sum += s->ascii ? 2 : mio_type_size(p->count_type >= 0 ? p->count_type : p->type);
    }
    return sum;
}

/* The list of corners of a face or strip, by its number in the element. */
static size_t mio_ply_list(const mio_ply_element *e)
{
    return e->at[MIO_PLY_INDICES] != SIZE_MAX ? e->at[MIO_PLY_INDICES] : e->at[MIO_PLY_INDEX];
}

/* One row of any element, property by property. */
static int mio_ply_row(mio_in *in, const mio_ply *s, mio_build *b, const mio_ply_element *e)
{
    const size_t list = mio_ply_list(e);
    double x[3] = {0, 0, 0};
    size_t i, count = 0;
    int status = MIO_OK;
    for (i = 0; i < e->n && status == MIO_OK; i++) {
        const mio_ply_property *const p = &s->property[e->first + i];
        if (p->count_type >= 0) {
            if (mio_ply_length(in, s, p, &count) < 0) return MIO_FAILED;
            status = i == list && e->kind == MIO_PLY_FACE     ? mio_ply_corners(in, s, b, p, count)
                     : i == list && e->kind == MIO_PLY_STRIPS ? mio_ply_strip(in, s, b, p, count)
                                                              : mio_ply_skip(in, s, p->type, count);
        } else if (e->kind == MIO_PLY_VERTEX && p->role <= MIO_PLY_Z) {
            status = mio_ply_get(in, s, p->type, &x[p->role]);
        } else {
            status = mio_ply_skip(in, s, p->type, 1);
        }
    }
    if (status != MIO_OK || e->kind != MIO_PLY_VERTEX) return status;
    return mio_add_vertex(in, b, x);
}

/* Binary vertices without lists: rows of one size. Leaves *done 0 when it does not apply. */
static int mio_ply_fast_vertices(mio_in *in, const mio_ply *s, mio_build *b, const mio_ply_element *e, int *done)
{
    const int big = s->big, n = (int)e->count;
    size_t offset[3] = {0, 0, 0}, size = 0, i;
    int type[3] = {0, 0, 0}, v, k;
    const unsigned char *p = (const unsigned char *)in->p;
    double *x;
    for (i = 0; i < e->n; i++) {
        const mio_ply_property *const q = &s->property[e->first + i];
        if (q->count_type >= 0) return MIO_OK;
        if (q->role <= MIO_PLY_Z) { offset[q->role] = size; type[q->role] = q->type; }
        size += mio_type_size(q->type);
    }
    *done = 1;
    if (mio_reserve_vertices(in, b, (size_t)n) < 0) return MIO_FAILED;
    x = b->xyz;
    for (v = 0; v < n; v++, p += size, x += 3) {
        const int status = mio_tick(in);
        if (status != MIO_OK) return status;
        if (type[0] == MIO_F32 && type[1] == MIO_F32 && type[2] == MIO_F32) for (k = 0; k < 3; k++) x[k] = mio_f32(p + offset[k], big);
        else for (k = 0; k < 3; k++) x[k] = mio_value(p + offset[k], type[k], big);
    }
    in->p += (size_t)n * size;
    b->n = (size_t)n;
    return MIO_OK;
}

/* Room for all faces has been made. Binary faces with one-byte lengths and 32-bit indices, with nothing or fixed-size values around the list: the usual ones.
   Steps in->p and s->row over them, and stops at the first that is wrong or odd, which is left to the general reader. */
static int mio_ply_fast_faces(mio_in *in, mio_ply *s, mio_build *b, const mio_ply_element *e)
{
    const size_t list = mio_ply_list(e), n = (size_t)s->n;
    const int big = s->big;
    size_t before = 0, after = 0, i, k;
    for (i = 0; i < e->n; i++) {
        const mio_ply_property *const q = &s->property[e->first + i];
        if (i == list) { if (mio_type_size(q->count_type) != 1 || (q->type != MIO_I32 && q->type != MIO_U32)) return MIO_OK; }
        else if (q->count_type >= 0) return MIO_OK;
        else *(i < list ? &before : &after) += mio_type_size(q->type);
    }
    for (; s->row < e->count && mio_left(in) > before; s->row++) {
        const unsigned char *p = (const unsigned char *)in->p + before;
        const size_t corners = *p++, size = before + 1 + 4 * corners + after;
        const int status = mio_tick(in);
        int32_t *idx;
        if (status != MIO_OK) return status;
        if (corners < 3 || corners > 127 || mio_left(in) < size) return MIO_OK;
        if (b->n_idx + corners > b->room_idx && mio_reserve_corners(in, b, b->n_idx + corners) < 0) return MIO_FAILED;
        idx = b->idx + b->n_idx;
        for (k = 0; k < corners; k++, p += 4) {
            const uint32_t v = mio_u32(p, big);
            if (v >= n) return MIO_OK;
            idx[k] = (int32_t)v;
        }
        b->n_idx += corners;
        b->ptr[b->n_faces++] = (int64_t)b->n_idx;
        in->p += size;
    }
    return MIO_OK;
}

static int mio_ply_element_body(mio_in *in, mio_ply *s, mio_build *b, const mio_ply_element *e)
{
    const size_t least = mio_ply_least(s, e);
    size_t fit;
    int status = MIO_OK, done = 0;
    s->now = e;
    s->row = 0;
    if (least == 0) return MIO_OK;      /* no properties: rows of nothing, however many */
    fit = (mio_left(in) + (size_t)s->ascii) / least;
    if (!s->ascii && (uint64_t)e->count > fit)
        return mio_fail(in, 0, "the header announces %lld of element %s, but the file ends after %lu at most", (long long)e->count, e->name, (unsigned long)fit);
    if ((uint64_t)e->count < fit) fit = (size_t)e->count;       /* ascii goes on to the row that is not there, and names it */
    if (e->kind == MIO_PLY_VERTEX && mio_reserve_vertices(in, b, fit) < 0) return MIO_FAILED;
    if (e->kind == MIO_PLY_FACE && (mio_reserve_faces(in, b, b->n_faces + fit) < 0 || mio_reserve_corners(in, b, b->n_idx + 3 * fit) < 0)) return MIO_FAILED;
    if (e->kind == MIO_PLY_VERTEX && !s->ascii) status = mio_ply_fast_vertices(in, s, b, e, &done);
    if (e->kind == MIO_PLY_FACE && !s->ascii) status = mio_ply_fast_faces(in, s, b, e);
    for (; status == MIO_OK && !done && s->row < e->count; s->row++) {
        if ((status = mio_tick(in)) != MIO_OK) return status;
        if (s->ascii) (void)mio_space(in);
        status = mio_ply_row(in, s, b, e);
        if (status == MIO_OK && s->ascii && !in->spread && mio_blanks(in))
            status = mio_fail(in, in->line, "more numbers than %s %lld has properties", e->name, (long long)s->row);
    }
    return status;
}

/* As in [6]: ascii is read with a row a line first, then as a stream of tokens that must end where the file does. */
static int mio_ply_body(mio_in *in, mio_ply *s, mio_build *b)
{
    const mio_in start = *in;
    mio_error first;
    int status = MIO_OK;
    size_t i;
    memset(&first, 0, sizeof first);
    for (in->spread = 0; in->spread < 2; in->spread++) {
        in->p = start.p;
        in->line = start.line;
        mio_build_reset(b);
        for (i = 0, status = MIO_OK; i < s->n_element && status == MIO_OK; i++) status = mio_ply_element_body(in, s, b, &s->element[i]);
        if (status == MIO_OK && in->spread && mio_space(in)) status = MIO_FAILED;
        if (!in->spread && in->e) first = *in->e;
        if (!s->ascii || status != MIO_FAILED) return status;
    }
    if (in->e) *in->e = first;
    return status;
}

static int mio_ply_check_finite(const mio_in *in, const mio_build *b)
{
    size_t i;
    for (i = 0; i < 3 * b->n; i++)
        if (!mio_is_finite(b->xyz[i]))
            return mio_fail(in, 0, "vertex %lld: %c is %g, not a finite number", (long long)(i / 3), 'x' + (int)(i % 3), b->xyz[i]);
    return MIO_OK;
}

static int mio_load_ply(mio_in *in, mio_build *b, mio_mesh *m)
{
    mio_ply s;
    int status;
    memset(&s, 0, sizeof s);
    if (mio_left(in) < 4 || memcmp(in->p, "ply", 3) != 0 || !mio_is_end(in, in->p[3]))
        return mio_fail(in, in->line, "not a PLY file: it does not begin with the line 'ply'");
    status = mio_ply_header(in, &s);
    if (status == MIO_OK && s.n > 0) status = mio_ply_body(in, &s, b);
    if (status == MIO_OK) status = mio_ply_check_finite(in, b);
    if (status == MIO_OK) status = mio_finish(in, b, m, s.ascii ? "PLY ascii" : "PLY binary");
    free(s.property);
    free(s.element);
    return status;
}

/* ==== [8] STL ==== */

/* Numbers of corners by their coordinates: open addressing, at most half full. */
typedef struct mio_table {
    int32_t *slot;              /* vertex + 1, or 0 */
    size_t mask;
} mio_table;

static size_t mio_table_place(const mio_table *t, const double *xyz, const double x[3])
{
    uint64_t u[3], h;
    size_t i;
    memcpy(u, x, sizeof u);
    h = u[0] * UINT64_C(0x9e3779b97f4a7c15) ^ (u[0] >> 29);
    h = (h ^ u[1]) * UINT64_C(0xbf58476d1ce4e5b9) ^ (h >> 31);
    h = (h ^ u[2]) * UINT64_C(0x94d049bb133111eb) ^ (h >> 29);
    h ^= h >> 32;
    h *= UINT64_C(0x9e3779b97f4a7c15);
    for (i = (size_t)(h >> 20) & t->mask; t->slot[i]; i = (i + 1) & t->mask) {
        const double *const y = xyz + 3 * ((size_t)t->slot[i] - 1);
        if (y[0] == x[0] && y[1] == x[1] && y[2] == x[2]) break;
    }
    return i;
}

/* Makes the table at least twice as large, and large enough for n vertices. */
static int mio_table_grow(const mio_in *in, mio_table *t, const mio_build *b, size_t n)
{
    size_t size = t->slot ? 2 * (t->mask + 1) : 1024, v;
    mio_table bigger;
    while (size / 2 < n) size *= 2;
    bigger.mask = size - 1;
    bigger.slot = (int32_t *)calloc(size, sizeof *bigger.slot);
    if (!bigger.slot) return mio_no_memory(in);
    for (v = 0; v < b->n; v++) bigger.slot[mio_table_place(&bigger, b->xyz, b->xyz + 3 * v)] = (int32_t)(v + 1);
    free(t->slot);
    *t = bigger;
    return MIO_OK;
}

/* A corner at x: the vertex that is there, or a new one. */
static int mio_stl_corner(const mio_in *in, mio_build *b, mio_table *t, double x[3])
{
    size_t i;
    int k;
    for (k = 0; k < 3; k++) if (x[k] == 0) x[k] = 0;        /* -0 is 0 */
    if ((!t->slot || 2 * b->n > t->mask) && mio_table_grow(in, t, b, b->n) < 0) return MIO_FAILED;
    i = mio_table_place(t, b->xyz, x);
    if (!t->slot[i]) {
        if (mio_add_vertex(in, b, x) < 0) return MIO_FAILED;
        t->slot[i] = (int32_t)b->n;
    }
    return mio_add_corner(in, b, t->slot[i] - 1);
}

static int mio_stl_binary(mio_in *in, mio_build *b, mio_table *t)
{
    const unsigned char *p = (const unsigned char *)in->data + 84;
    uint32_t f, n;
    int c, k;
    if (in->size < 84) return mio_fail(in, 0, "the file ends inside the header of a binary STL");
    n = mio_u32(p - 4, 0);
    if ((in->size - 84) / 50 < n)
        return mio_fail(in, 0, "%lu triangles are announced, but the file ends in triangle %lu", (unsigned long)n, (unsigned long)((in->size - 84) / 50));
    if (mio_reserve_faces(in, b, n) < 0 || mio_reserve_corners(in, b, 3 * (size_t)n) < 0 || mio_table_grow(in, t, b, n / 2) < 0) return MIO_FAILED;
    for (f = 0; f < n; f++, p += 50) {
        const int status = mio_tick(in);
        if (status != MIO_OK) return status;
        for (c = 0; c < 3; c++) {
            double x[3];
            for (k = 0; k < 3; k++) {
                x[k] = mio_f32(p + 12 + 12 * c + 4 * k, 0);
                if (!mio_is_finite(x[k])) return mio_fail(in, 0, "face %lu: %c of corner %d is %g, not a finite number", (unsigned long)f, 'x' + k, c, x[k]);
            }
            if (mio_stl_corner(in, b, t, x) < 0) return MIO_FAILED;
        }
        if (mio_end_face(in, b) < 0) return MIO_FAILED;
    }
    return MIO_OK;
}

/* Does the lower-case word stand at p, in any case? */
static int mio_stl_is(const mio_in *in, const char *word)
{
    const char *p = in->p;
    for (; *word; p++, word++) if ((*p | 32) != *word) return 0;
    return p >= in->end || mio_is_end(in, *p);
}

static int mio_stl_ascii(mio_in *in, mio_build *b, mio_table *t)
{
    int inside = 0, open = 0, k;        /* inside: between `outer loop` and `endloop`; open: between `solid` and `endsolid` */
    char word[48];
    in->spread = 1;
    while (mio_space(in)) {
        const int status = mio_tick(in);
        double x[3];
        if (status != MIO_OK) return status;
        if (!inside && (mio_stl_is(in, "solid") || mio_stl_is(in, "endsolid"))) {
            open = mio_stl_is(in, "solid");
            mio_to_eol(in);             /* a name, which can be anything */
            continue;
        }
        if (inside && mio_stl_is(in, "vertex")) {
            in->p += 6;
            if (mio_take_coordinates(in, x) < 0 || mio_stl_corner(in, b, t, x) < 0) return MIO_FAILED;
            continue;
        }
        if (inside && mio_stl_is(in, "endloop")) {
            if (mio_end_face(in, b) < 0) return MIO_FAILED;
            inside = 0;
        } else if (!inside && mio_stl_is(in, "normal")) {
            for (k = 0; k < 3; k++) { in->p = mio_token_end(in, in->p); (void)mio_space(in); }         /* from the corners instead */
        } else if (!inside && mio_stl_is(in, "outer")) {
            inside = 1;
        } else if (inside ? !mio_stl_is(in, "loop") : !mio_stl_is(in, "facet") && !mio_stl_is(in, "endfacet")) {
            return mio_fail(in, in->line, "'%s' is not expected here in an STL file", mio_show(in, in->p, word));
        }
        in->p = mio_token_end(in, in->p);
    }
    if (open || inside) return mio_fail(in, in->line, "the file ends before 'endsolid'");
    return MIO_OK;
}

static int mio_load_stl(mio_in *in, mio_build *b, mio_mesh *m, int ascii)
{
    mio_table t = {NULL, 0};
    int status = ascii ? mio_stl_ascii(in, b, &t) : mio_stl_binary(in, b, &t);
    free(t.slot);
    return status == MIO_OK ? mio_finish(in, b, m, ascii ? "STL ascii" : "STL binary") : status;
}

/* ==== [9] XYZ ==== */

static int mio_load_xyz(mio_in *in, mio_build *b, mio_mesh *m)
{
    int64_t announced = -1, announced_line = 0;
    in->comma = in->hash = 1;
    while (mio_space(in)) {
        const char *const at = in->p;
        const int status = mio_tick(in);
        double x[3];
        if (status != MIO_OK) return status;
        if (at[0] == '/' && at[1] == '/') { mio_next_line(in); continue; }
        if (b->n == 0 && announced < 0) {
            const char *const q = mio_integer(at, &announced);
            if (q && (q >= in->end || mio_is_end(in, *q)) && announced >= 0) {
                in->p = q;
                announced_line = in->line;
                if (!mio_blanks(in)) { mio_next_line(in); continue; }       /* alone on its line: how many points there are */
                in->p = at;
            }
            announced = -1;
        }
        if (mio_take_coordinates(in, x) < 0 || mio_add_vertex(in, b, x) < 0) return MIO_FAILED;
        mio_next_line(in);
    }
    if (announced >= 0 && announced != (int64_t)b->n)
        return mio_fail(in, announced_line, "%lld points are announced, %lld found", (long long)announced, (long long)b->n);
    return mio_finish(in, b, m, "XYZ");
}

/* ==== [10] which format ==== */

enum { MIO_IN_UNKNOWN, MIO_IN_OBJ, MIO_IN_OFF, MIO_IN_PLY, MIO_IN_STL_ASCII, MIO_IN_STL_BINARY, MIO_IN_XYZ, MIO_IN_NUMBERS };

/* Is there a line like `v 0 0 0` or `f 1 2 3`, or does the file begin with another of OBJ's words? By value: in is a copy. */
static int mio_looks_obj(mio_in in)
{
    static const char *const words[] = {"v", "vn", "vt", "vp", "f", "g", "o", "s", "l", "p", "mtllib", "usemtl"};
    const char *const begin = in.p;
    size_t i;
    in.joins = 1;
    for (i = 0; i < sizeof words / sizeof *words; i++) if (mio_is_word(&in, words[i])) return 1;
    while (mio_space(&in) && in.p - begin < 65536) {
        if ((in.p[0] == 'v' || in.p[0] == 'f') && (in.p[1] == ' ' || in.p[1] == '\t')) {
            in.p++;
            if (mio_blanks(&in) && strchr("+-.0123456789", *in.p)) return 1;
        }
        mio_next_line(&in);
    }
    return 0;
}

/* Does the first line with something in it hold numbers only? */
static int mio_looks_numbers(mio_in in)
{
    int n = 0;
    double x;
    in.comma = 1;
    for (; mio_blanks(&in) && n < 3; n++) {
        const char *const q = mio_number(in.p, &x);
        if (!q || (q < in.end && !mio_is_end(&in, *q))) return 0;
        in.p = q;
    }
    return n > 0;
}

static int mio_has_word(const mio_in *in, const char *word)
{
    const size_t n = strlen(word), most = mio_left(in) < 4096 ? mio_left(in) : 4096;
    size_t i;
    for (i = 0; i + n <= most; i++) {
        size_t k = 0;
        while (k < n && (in->p[i + k] | 32) == word[k]) k++;
        if (k == n) return 1;
    }
    return 0;
}

/* Binary STL has no mark, and some begin with `solid` as ascii does; but the size tells. */
static int mio_looks_stl_binary(const mio_in *in)
{
    uint32_t n;
    if (in->size < 134) return 0;
    n = mio_u32((const unsigned char *)in->data + 80, 0);
    return (in->size - 84) % 50 == 0 && (in->size - 84) / 50 == n;
}

static int mio_looks_text(const mio_in *in)
{
    const size_t n = in->size < 1024 ? in->size : 1024;
    size_t i;
    for (i = 0; i < n; i++) if ((unsigned char)in->data[i] < '\t' || in->data[i] == 127) return 0;
    return 1;
}

static int mio_which(const mio_in *in)
{
    const char *const path = in->path;
    mio_in look = *in;
    if (mio_left(in) >= 4 && memcmp(in->p, "ply", 3) == 0 && mio_is_end(in, in->p[3])) return MIO_IN_PLY;
    if (mio_looks_stl_binary(in)) return MIO_IN_STL_BINARY;
    look.hash = 1;
    if (mio_space(&look)) {
        if (mio_off_is_keyword(&look, look.p)) return MIO_IN_OFF;
        if (mio_stl_is(&look, "solid") && mio_looks_text(in) && (mio_has_word(&look, "facet") || mio_has_word(&look, "endsolid"))) return MIO_IN_STL_ASCII;
        if (mio_looks_obj(look)) return MIO_IN_OBJ;
        if (mio_looks_numbers(look))
            return mio_has_extension(path, "off") ? MIO_IN_OFF : mio_has_extension(path, "xyz") ? MIO_IN_XYZ : MIO_IN_NUMBERS;
    }
    if (mio_has_extension(path, "obj")) return MIO_IN_OBJ;
    if (mio_has_extension(path, "off")) return MIO_IN_OFF;
    if (mio_has_extension(path, "ply")) return MIO_IN_PLY;
    if (mio_has_extension(path, "stl")) return mio_looks_text(in) ? MIO_IN_STL_ASCII : MIO_IN_STL_BINARY;
    if (mio_has_extension(path, "xyz") || mio_has_extension(path, "txt") || mio_has_extension(path, "csv") || mio_has_extension(path, "pts"))
        return MIO_IN_XYZ;
    return MIO_IN_UNKNOWN;
}

/* Bare numbers: OFF without its keyword when that fits to the last line, else points. */
static int mio_load_numbers(mio_in *in, mio_build *b, mio_mesh *m)
{
    const mio_in start = *in;
    mio_error ignored;
    int status;
    in->e = &ignored;
    status = mio_off_read(in, b, MIO_OFF_LINES);
    if (status == MIO_OK && (b->n_faces == 0 || mio_space(in))) status = MIO_FAILED;
    in->e = start.e;
    if (status == MIO_OK) return mio_finish(in, b, m, "OFF");
    if (status == MIO_STOPPED) return status;
    *in = start;
    mio_build_reset(b);
    return mio_load_xyz(in, b, m);
}

static int mio_unknown(const mio_in *in)
{
    mio_in look = *in;
    look.hash = 1;
    if (!mio_space(&look)) return mio_fail(in, 0, in->size ? "no vertices found (nothing but comments)" : "no vertices found (the file is empty)");
    return mio_fail(in, 0, "neither the content nor the name tells a format this reads (OBJ, OFF, PLY, STL, XYZ)");
}

/* The mesh of an opened file, which is closed. */
static int mio_parse(mio_in *in, mio_mesh *m)
{
    mio_build b;
    int status = MIO_OK;
    memset(&b, 0, sizeof b);
    if (!mio_looks_stl_binary(in)) status = mio_refuse(in);           /* whose header can be anything */
    if (status == MIO_OK) switch (mio_which(in)) {
    case MIO_IN_OBJ:        status = mio_load_obj(in, &b, m); break;
    case MIO_IN_OFF:        status = mio_load_off(in, &b, m); break;
    case MIO_IN_PLY:        status = mio_load_ply(in, &b, m); break;
    case MIO_IN_STL_ASCII:  status = mio_load_stl(in, &b, m, 1); break;
    case MIO_IN_STL_BINARY: status = mio_load_stl(in, &b, m, 0); break;
    case MIO_IN_XYZ:        status = mio_load_xyz(in, &b, m); break;
    case MIO_IN_NUMBERS:    status = mio_load_numbers(in, &b, m); break;
    default:                status = mio_unknown(in); break;
    }
    mio_build_free(&b);
    mio_close(in);
    if (status != MIO_OK) mio_free(m);
    return status;
}

static int mio_load(mio_mesh *m, const char *path, int (*stop)(void), mio_error *e)
{
    mio_in in;
    int status;
    memset(m, 0, sizeof *m);
    status = mio_open(&in, path, stop, e);
    return status == MIO_OK ? mio_parse(&in, m) : status;
}

static int mio_triangulate(const mio_mesh *m, int32_t **tri, int32_t *n_tri, int32_t **face_of_tri, mio_error *e)
{
    const int64_t corners = m->n_faces ? m->face_ptr[m->n_faces] : 0, total = corners - 2 * (int64_t)m->n_faces;
    int32_t f, t = 0;
    *tri = NULL;
    *n_tri = 0;
    if (face_of_tri) *face_of_tri = NULL;
    if (total > INT32_MAX) return mio_fail_at(e, "mesh", 0, "more than %ld triangles after splitting", (long)INT32_MAX);
    *tri = (int32_t *)mio_alloc((size_t)total, 3 * sizeof **tri);
    if (face_of_tri) *face_of_tri = (int32_t *)mio_alloc((size_t)total, sizeof **face_of_tri);
    if (!*tri || (face_of_tri && !*face_of_tri)) {
        free(*tri);
        *tri = NULL;
        if (face_of_tri) { free(*face_of_tri); *face_of_tri = NULL; }
        return mio_fail_at(e, "mesh", 0, "not enough memory");
    }
    for (f = 0; f < m->n_faces; f++) {
        const int32_t *const c = m->face_idx + m->face_ptr[f];
        const int64_t n = m->face_ptr[f + 1] - m->face_ptr[f];
        int64_t k;
        for (k = 1; k + 1 < n; k++, t++) {
            int32_t *const q = *tri + 3 * (size_t)t;
            q[0] = c[0];
            q[1] = c[k];
            q[2] = c[k + 1];
            if (face_of_tri) (*face_of_tri)[t] = f;
        }
    }
    *n_tri = t;
    return MIO_OK;
}

/* ==== [11] tables ==== */

typedef struct mio_numbers {
    double *values;             /* row by row */
    int64_t *lines;
    size_t n_values, n_rows, room_values, room_lines, cols;
} mio_numbers;

static int mio_add_value(const mio_in *in, mio_numbers *t, double x)
{
    if (t->n_values == t->room_values) {
        double *const q = (double *)mio_grow(t->values, &t->room_values, t->n_values + 1, sizeof *q);
        if (!q) return mio_no_memory(in);
        t->values = q;
    }
    t->values[t->n_values++] = x;
    return MIO_OK;
}

/* One line with something in it. A comma stands between two numbers, so that a column without a value is noticed. */
static int mio_table_row(mio_in *in, mio_numbers *t)
{
    const int64_t line = in->line;
    size_t cols = 0;
    double x;
    for (;;) {
        if (*in->p == ',' || !mio_blanks(in)) return mio_fail(in, in->line, "a value is missing beside a comma");
        if (mio_take_value(in, &x) < 0 || mio_add_value(in, t, x) < 0) return MIO_FAILED;
        cols++;
        if (!mio_blanks(in)) break;
        if (*in->p == ',') { in->p++; (void)mio_blanks(in); }
    }
    if (t->n_rows == 0) t->cols = cols;
    if (cols != t->cols) return mio_fail(in, line, "%lu columns, but %lu in the rows before", (unsigned long)cols, (unsigned long)t->cols);
    if (cols > (size_t)INT32_MAX) return mio_fail(in, line, "too many columns");
    if (t->n_rows == t->room_lines) {
        int64_t *const q = (int64_t *)mio_grow(t->lines, &t->room_lines, t->n_rows + 1, sizeof *q);
        if (!q) return mio_no_memory(in);
        t->lines = q;
    }
    t->lines[t->n_rows++] = line;
    return MIO_OK;
}

/* Is this the line of names that CSV files begin with: words, no number among them, nan and inf included? */
static int mio_table_names(const mio_in *in)
{
    const char *p = in->p;
    double x;
    if (!((*p | 32) >= 'a' && (*p | 32) <= 'z') && *p != '_' && *p != '"') return 0;
    for (; p < in->end && !mio_eol(*p); p++) {
        /* one or the other, so that no byte is looked at for each quote before it */
        const char *const q = *p == '"' ? p + 1 + strcspn(p + 1, "\"\r\n") : p + strcspn(p, ", \t\r\n");
        if (mio_number(p, &x) == q || (mio_not_finite(p) && q - p <= 3 + (*p == '-' || *p == '+'))) return 0;
        p = q;
        if (mio_eol(*p)) break;                         /* else it stands on what ends the item */
    }
    return 1;
}

static int mio_table_text(mio_in *in, mio_numbers *t, double **values, int64_t *rows, int32_t *cols)
{
    size_t r, c;
    in->comma = 2;
    in->hash = 1;
    if (mio_space(in) && mio_table_names(in)) mio_next_line(in);
    while (mio_space(in)) {
        const int status = mio_tick(in);
        if (status != MIO_OK) return status;
        if (mio_table_row(in, t) < 0) return MIO_FAILED;
    }
    if (t->n_rows == 0) return mio_fail(in, 0, "no numbers found");
    *values = (double *)mio_alloc(t->n_values, sizeof **values);
    if (!*values) return mio_no_memory(in);
    for (r = 0; r < t->n_rows; r++) for (c = 0; c < t->cols; c++) (*values)[c * t->n_rows + r] = t->values[r * t->cols + c];
    *rows = (int64_t)t->n_rows;
    *cols = (int32_t)t->cols;
    return MIO_OK;
}

/* What the header of a .npy file says. */
typedef struct mio_npy {
    int type, big, fortran, dimensions;
    int64_t shape[2];
} mio_npy;

/* The value of a key in the header, which is a Python dict of one line: 'key': value. NULL when it is not there. */
static const char *mio_npy_key(const char *p, const char *end, const char *key)
{
    const size_t n = strlen(key);
    for (; p + n + 2 < end; p++) {
        if ((*p != '\'' && *p != '"') || memcmp(p + 1, key, n) != 0 || p[n + 1] != *p) continue;
        for (p += n + 2; p < end && (*p == ' ' || *p == ':'); p++) {}
        return p < end ? p : NULL;
    }
    return NULL;
}

static int mio_npy_type(const mio_in *in, mio_npy *h, const char *p, const char *end)
{
    static const char names[10][3] = {"i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8", "i8", "u8"};
    int i;
    if (p && end - p > 4 && (*p == '\'' || *p == '"') && strchr("<>|=", p[1])) {
        h->big = p[1] == '>';
        for (i = 0; i < 10; i++) if (memcmp(p + 2, names[i], 2) == 0 && p[4] == *p) { h->type = i; return MIO_OK; }
        if (memcmp(p + 2, "b1", 2) == 0 && p[4] == *p) { h->type = MIO_U8; return MIO_OK; }
    }
    return mio_fail(in, 0, "the type of its numbers is none of those this reads (float64, float32, integers)");
}

static int mio_npy_shape(const mio_in *in, mio_npy *h, const char *p, const char *end)
{
    h->shape[0] = h->shape[1] = 1;
    h->dimensions = 0;
    if (!p || *p != '(') return mio_fail(in, 0, "the header does not tell the shape");
    for (p++; p < end && *p != ')';) {
        int64_t v;
        const char *const q = mio_integer(p, &v);
        if (*p == ' ' || *p == ',' || *p == 'L') { p++; continue; }
        if (!q || v < 0) return mio_fail(in, 0, "the header does not tell the shape");
        if (v == INT64_MAX) return mio_fail(in, 0, "the header announces %.*s, more than any file holds", q - p < 40 ? (int)(q - p) : 40, p);
        if (h->dimensions < 2) h->shape[h->dimensions] = v;
        h->dimensions++;
        p = q;
    }
    if (h->dimensions < 1 || h->dimensions > 2) return mio_fail(in, 0, "an array of %d dimensions; 1 or 2 are needed", h->dimensions);
    return MIO_OK;
}

static int mio_npy_header(mio_in *in, mio_npy *h)
{
    const unsigned char *const u = (const unsigned char *)in->data;
    const size_t start = in->size > 6 && u[6] == 1 ? 10 : 12;
    const char *p, *end;
    size_t n;
    if (in->size < start) return mio_fail(in, 0, "the file ends inside the header");
    if (u[6] < 1 || u[6] > 3) return mio_fail(in, 0, "version %d of the .npy format is not known", u[6]);
    n = start == 10 ? (size_t)u[8] | (size_t)u[9] << 8 : mio_u32(u + 8, 0);
    if (n > in->size - start) return mio_fail(in, 0, "the file ends inside the header");
    p = in->data + start;
    end = p + n;
    if (mio_npy_type(in, h, mio_npy_key(p, end, "descr"), end) < 0 || mio_npy_shape(in, h, mio_npy_key(p, end, "shape"), end) < 0) return MIO_FAILED;
    p = mio_npy_key(p, end, "fortran_order");
    if (!p || (*p != 'T' && *p != 'F')) return mio_fail(in, 0, "the header does not tell the order of the numbers");
    h->fortran = *p == 'T';
    in->p = end;
    return MIO_OK;
}

static int mio_table_npy(mio_in *in, double **values, int64_t *rows, int32_t *cols)
{
    mio_npy h;
    size_t size, nr, nc, r, c;
    const unsigned char *p;
    memset(&h, 0, sizeof h);
    if (mio_npy_header(in, &h) < 0) return MIO_FAILED;
    size = mio_type_size(h.type);
    if (h.shape[0] == 0 || h.shape[1] == 0) return mio_fail(in, 0, "no numbers found (the array is empty)");
    if (h.shape[1] > INT32_MAX) return mio_fail(in, 0, "%lld columns are too many", (long long)h.shape[1]);
    if ((uint64_t)h.shape[0] > mio_left(in) / size / (uint64_t)h.shape[1])
        return mio_fail(in, 0, "%lld x %lld numbers are announced, but the file ends after %lu", (long long)h.shape[0], (long long)h.shape[1],
                        (unsigned long)(mio_left(in) / size));
    nr = (size_t)h.shape[0];
    nc = (size_t)h.shape[1];
    *values = (double *)mio_alloc(nr * nc, sizeof **values);
    if (!*values) return mio_no_memory(in);
    p = (const unsigned char *)in->p;
    for (r = 0; r < nr; r++) {
        const int status = mio_tick(in);
        if (status != MIO_OK) return status;
        for (c = 0; c < nc; c++) {
            const double x = mio_value(p + (h.fortran ? c * nr + r : r * nc + c) * size, h.type, h.big);
            if (!in->infinite && !mio_is_finite(x))
                return mio_fail(in, 0, "row %lu, column %lu: %g is not a finite number", (unsigned long)r, (unsigned long)c, x);
            (*values)[c * nr + r] = x;
        }
    }
    *rows = h.shape[0];
    *cols = (int32_t)h.shape[1];
    return MIO_OK;
}

/* The table of an opened file, which is closed. */
static int mio_parse_table(mio_in *in, double **values, int64_t *rows, int32_t *cols, int64_t **lines)
{
    mio_numbers t;
    int status;
    memset(&t, 0, sizeof t);
    if (in->size >= 6 && memcmp(in->data, "\223NUMPY", 6) == 0) status = mio_table_npy(in, values, rows, cols);
    else if (mio_has_extension(in->path, "npy")) status = mio_fail(in, 0, "not a .npy file: it does not begin as one");
    else if ((status = mio_refuse(in)) == MIO_OK) status = mio_table_text(in, &t, values, rows, cols);
    if (status == MIO_OK && lines) { *lines = t.lines; t.lines = NULL; }
    if (status != MIO_OK) { free(*values); *values = NULL; }
    free(t.values);
    free(t.lines);
    mio_close(in);
    return status;
}

static int mio_load_any(double **values, int64_t *rows, int32_t *cols, int64_t **lines, const char *path, int (*stop)(void), mio_error *e,
                        int infinite)
{
    mio_in in;
    int status;
    *values = NULL;
    *rows = 0;
    *cols = 0;
    if (lines) *lines = NULL;
    status = mio_open(&in, path, stop, e);
    in.infinite = infinite;
    return status == MIO_OK ? mio_parse_table(&in, values, rows, cols, lines) : status;
}

static int mio_load_table_lines(double **values, int64_t *rows, int32_t *cols, int64_t **lines, const char *path, int (*stop)(void), mio_error *e)
{
    return mio_load_any(values, rows, cols, lines, path, stop, e, 0);
}

static int mio_load_table(double **values, int64_t *rows, int32_t *cols, const char *path, int (*stop)(void), mio_error *e)
{
    return mio_load_table_lines(values, rows, cols, NULL, path, stop, e);
}

static int mio_load_field(double **values, int64_t *rows, int32_t *cols, const char *path, int (*stop)(void), mio_error *e)
{
    return mio_load_any(values, rows, cols, NULL, path, stop, e, 1);
}

/* ==== [12] output files ==== */

/* The unfinished file, for mio_remove_temporary: plain memory, written before the flag is set. */
static char mio_temporary_path[4096];
static volatile sig_atomic_t mio_temporary_set;

static void mio_remove_temporary(void)
{
    if (!mio_temporary_set) return;
#if defined(_WIN32)
    (void)remove(mio_temporary_path);
#else
    (void)unlink(mio_temporary_path);
#endif
    mio_temporary_set = 0;
}

/* Can the target be replaced by renaming another file: is it a regular file, or not there yet? */
static int mio_is_replaceable(const char *path)
{
    struct stat st;
    if (strncmp(path, "/dev/", 5) == 0 || strncmp(path, "/proc/", 6) == 0) return 0;
    if (stat(path, &st) != 0) return 1;
#if defined(S_ISREG)
    return S_ISREG(st.st_mode) != 0;
#else
    return (st.st_mode & _S_IFMT) == _S_IFREG;
#endif
}

static int mio_file_fail(mio_file *f, const char *what)
{
    if (f->status == MIO_OK) f->status = mio_fail_at(f->e, f->path, 0, "%s: %s", what, errno ? strerror(errno) : "unknown reason");
    return f->status;
}

/* Where the file's own name begins. */
static size_t mio_folder_length(const char *path)
{
    size_t n = strlen(path);
    while (n > 0 && path[n - 1] != '/') {
#if defined(_WIN32)
        if (path[n - 1] == '\\' || path[n - 1] == ':') break;
#endif
        n--;
    }
    return n;
}

/* A name beside the target that is not taken, made known to mio_remove_temporary before the file exists. It begins
   as the target's, but is short enough for every file system: these have room for 255 bytes, some for 143. */
static int mio_file_name_temporary(mio_file *f)
{
    const size_t room = strlen(f->path) + 32, most = mio_folder_length(f->path) + 100;
    int keep = (int)(strlen(f->path) < most ? strlen(f->path) : most);
    uint32_t mix = (uint32_t)time(NULL) * 2654435761u ^ (uint32_t)clock() ^ (uint32_t)((uintptr_t)f >> 4);
    int tries;
#if !defined(_WIN32)
    mix ^= (uint32_t)getpid() * 2246822519u;            /* two runs that begin at once */
#endif
    while (strlen(f->path) > most && ((unsigned char)f->path[keep] & 0xc0) == 0x80) keep--;  /* whole letters */
    f->temporary = (char *)mio_alloc(room, 1);
    if (!f->temporary) return MIO_FAILED;
    for (tries = 0; tries < 64; tries++, mix = mix * 1664525u + 1013904223u) {
        FILE *there;
        snprintf(f->temporary, room, "%.*s.%08lx.part", keep, f->path, (unsigned long)mix);
        there = fopen(f->temporary, "rb");
        if (!there) break;
        fclose(there);
    }
    if (!mio_temporary_set && strlen(f->temporary) < sizeof mio_temporary_path) {
        memcpy(mio_temporary_path, f->temporary, strlen(f->temporary) + 1);
        mio_temporary_set = 1;
    }
    return MIO_OK;
}

static void mio_file_forget_temporary(mio_file *f)
{
    if (f->temporary && mio_temporary_set && strcmp(f->temporary, mio_temporary_path) == 0) mio_temporary_set = 0;
    free(f->temporary);
    f->temporary = NULL;
}

static int mio_file_open(mio_file *f, const char *path, int (*stop)(void), mio_error *e)
{
    FILE *old;
    f->stream = NULL;
    f->path = path && strcmp(path, "-") != 0 ? path : NULL;
    f->temporary = NULL;
    f->stop = stop;
    f->e = e;
    f->status = MIO_OK;
    f->used = 0;
    if (!f->path) {
        f->stream = stdout;
#if defined(_WIN32)
        fflush(stdout);
        (void)_setmode(_fileno(stdout), _O_BINARY);
#endif
        return MIO_OK;
    }
    errno = 0;
    if (mio_is_replaceable(f->path)) {
        old = fopen(f->path, "r+b");            /* renaming would also replace a file that its owner has protected: do not */
        if (old) fclose(old);
        else if (errno != ENOENT) return mio_file_fail(f, "cannot write");
        errno = 0;
        if (mio_file_name_temporary(f) < 0) return mio_file_fail(f, "cannot write");
    }
#if defined(_WIN32)
    f->stream = fopen(f->temporary ? f->temporary : f->path, "wb");
#else
    f->stream = fopen(f->temporary ? f->temporary : f->path, f->temporary ? "wbx" : "wb");   /* x: never through a link that others put there */
#endif
    if (f->stream) return MIO_OK;
    mio_file_fail(f, "cannot write");
    mio_file_forget_temporary(f);
    return f->status;
}

static void mio_file_flush(mio_file *f)
{
    errno = 0;
    if (f->status == MIO_OK && f->stream && f->used && fwrite(f->buffer, 1, f->used, f->stream) != f->used) (void)mio_file_fail(f, "cannot write");
    f->used = 0;
    if (f->status == MIO_OK && f->stop && f->stop()) f->status = MIO_STOPPED;
}

static void mio_file_put(mio_file *f, const void *data, size_t size)
{
    const char *p = (const char *)data;
    while (f->status == MIO_OK && size > 0) {
        const size_t room = sizeof f->buffer - f->used, n = size < room ? size : room;
        memcpy(f->buffer + f->used, p, n);
        f->used += n;
        p += n;
        size -= n;
        if (f->used == sizeof f->buffer) mio_file_flush(f);
    }
}

static int mio_file_close(mio_file *f)
{
    mio_file_flush(f);
    errno = 0;
    if (f->stream == stdout) {
        if (fflush(stdout) != 0 || ferror(stdout)) (void)mio_file_fail(f, "cannot write");
    } else if (f->stream && fclose(f->stream) != 0) {
        (void)mio_file_fail(f, "cannot write");
    }
    f->stream = NULL;
    if (f->temporary) {
#if defined(_WIN32)
        if (f->status == MIO_OK) (void)remove(f->path);        /* where rename does not replace */
#endif
        if (f->status == MIO_OK && rename(f->temporary, f->path) != 0) (void)mio_file_fail(f, "cannot write");
        if (f->status != MIO_OK) (void)remove(f->temporary);
        mio_file_forget_temporary(f);
    }
    return f->status;
}

static void mio_file_cancel(mio_file *f)
{
    if (f->status == MIO_OK) f->status = MIO_STOPPED;
    (void)mio_file_close(f);
}

/* ==== [13] writers ==== */

static int mio_format_of(const char *path)
{
    static const char *const names[] = {"txt", "csv", "npy", "ply", "obj", "vtu"};
    int i;
    for (i = 0; i < 6; i++) if (mio_has_extension(path, names[i])) return MIO_TXT + i;
    return MIO_UNKNOWN;
}

static int mio_mesh_format_of(const char *path)
{
    static const char *const names[] = {"ply", "obj", "vtu", "off", "stl"};
    int i;
    for (i = 0; i < 5; i++) if (mio_has_extension(path, names[i])) return MIO_PLY + i;
    return mio_has_extension(path, "xyz") ? MIO_TXT : MIO_UNKNOWN;
}

static void mio_put_text(mio_file *f, const char *text) { mio_file_put(f, text, strlen(text)); }

/* A line of text of the user's in a place where a line end would do harm. */
static void mio_put_line(mio_file *f, const char *text)
{
    for (; *text; text++) mio_file_put(f, (unsigned char)*text < 32 ? " " : text, 1);
}

static void mio_put_integer(mio_file *f, int64_t x)
{
    char digits[24];
    size_t k = sizeof digits;
    uint64_t u = x < 0 ? (uint64_t)0 - (uint64_t)x : (uint64_t)x;
    do digits[--k] = (char)('0' + (int)(u % 10)); while ((u /= 10) != 0);
    if (x < 0) digits[--k] = '-';
    mio_file_put(f, digits + k, sizeof digits - k);
}

static void mio_put_double(mio_file *f, double x)
{
    char text[40];
    uint64_t u;
    memcpy(&u, &x, sizeof u);
    if (u == 0) { mio_file_put(f, "0", 1); return; }    /* many are, far from the source */
    if (x != x) { mio_put_text(f, "nan"); return; }
    mio_file_put(f, text, (size_t)snprintf(text, sizeof text, "%.17g", x));
}

static void mio_put_u32(mio_file *f, uint32_t u)
{
    const unsigned char b[4] = {(unsigned char)(u & 255), (unsigned char)(u >> 8 & 255), (unsigned char)(u >> 16 & 255), (unsigned char)(u >> 24)};
    mio_file_put(f, b, 4);
}

static void mio_put_u64(mio_file *f, uint64_t u)
{
    mio_put_u32(f, (uint32_t)(u & 0xffffffffu));
    mio_put_u32(f, (uint32_t)(u >> 32));
}

/* Little endian, whatever the machine. */
static void mio_put_f64(mio_file *f, double x)
{
    uint64_t u;
    memcpy(&u, &x, sizeof u);
    mio_put_u64(f, u);
}

/* The fields of a mesh must have a row per vertex. */
static int mio_check_rows(const char *path, const mio_mesh *m, const mio_output *o, mio_error *e)
{
    if (!m) return mio_fail_at(e, path, 0, "this format needs the mesh as well");
    if ((o->cols > 0 || o->rgb) && o->rows != (int64_t)m->n)
        return mio_fail_at(e, path, 0, "%lld rows to write for %ld vertices", (long long)o->rows, (long)m->n);
    return MIO_OK;
}

/* A name as CSV has it: in quotes where it holds what separates. */
static void mio_put_name(mio_file *f, const char *name)
{
    const int quoted = name[strcspn(name, ", \"\t\r\n")] != 0;
    if (quoted) mio_put_text(f, "\"");
    for (; *name; name++) {
        if (*name == '"') mio_put_text(f, "\"");
        mio_file_put(f, (unsigned char)*name < 32 ? " " : name, 1);
    }
    if (quoted) mio_put_text(f, "\"");
}

/* The line of names above the numbers. */
static void mio_put_names(mio_file *f, const mio_output *o, const char *between)
{
    int32_t c;
    for (c = 0; c < o->n_ids + o->cols; c++) {
        if (c) mio_put_text(f, between);
        mio_put_name(f, c < o->n_ids ? o->id_names[c] : o->names[c - o->n_ids]);
    }
    mio_put_text(f, "\n");
}

/* names: 1 with a line of names, 0 without. */
static int mio_write_rows(const char *path, const mio_output *o, const char *between, int names, mio_error *e)
{
    mio_file f;
    int64_t r;
    int32_t c;
    if (mio_file_open(&f, path, o->stop, e) < 0) return mio_file_close(&f);
    if (o->comment) {
        mio_put_text(&f, "# ");
        mio_put_line(&f, o->comment);
        mio_put_text(&f, "\n");
    }
    if (names) mio_put_names(&f, o, between);
    for (r = 0; r < o->rows && f.status == MIO_OK; r++) {
        for (c = 0; c < o->n_ids; c++) {
            if (c) mio_put_text(&f, between);
            mio_put_integer(&f, o->ids[c][r]);
        }
        for (c = 0; c < o->cols; c++) {
            if (c + o->n_ids) mio_put_text(&f, between);
            mio_put_double(&f, o->values[c * o->ld + r]);
        }
        mio_put_text(&f, "\n");
    }
    return mio_file_close(&f);
}

static int mio_write_text(const char *path, const mio_output *o, mio_error *e)
{
    return mio_write_rows(path, o, " ", 0, e);
}

static int mio_write_csv(const char *path, const mio_output *o, mio_error *e)
{
    return mio_write_rows(path, o, ",", !o->no_header && o->names && (o->n_ids == 0 || o->id_names), e);
}

static int mio_write_npy(const char *path, const mio_output *o, mio_error *e)
{
    mio_file f;
    char header[128];
    int64_t r;
    int32_t c;
    size_t n;
    if (mio_file_open(&f, path, o->stop, e) < 0) return mio_file_close(&f);
    memset(header, ' ', sizeof header);
    memcpy(header, "\223NUMPY\1\0\166\0", 10);          /* version 1.0, 118 more bytes of header: 128, of which 64 is a divisor */
    n = 10 + (size_t)snprintf(header + 10, sizeof header - 10, "{'descr': '<f8', 'fortran_order': False, 'shape': (%lld, %lld), }",
                              (long long)o->rows, (long long)o->n_ids + o->cols);
    header[n] = ' ';
    header[127] = '\n';
    mio_file_put(&f, header, sizeof header);
    for (r = 0; r < o->rows && f.status == MIO_OK; r++) {
        for (c = 0; c < o->n_ids; c++) mio_put_f64(&f, (double)o->ids[c][r]);
        for (c = 0; c < o->cols; c++) mio_put_f64(&f, o->values[c * o->ld + r]);
    }
    return mio_file_close(&f);
}

static int64_t mio_longest_face(const mio_mesh *m)
{
    int64_t most = 0;
    int32_t i;
    for (i = 0; i < m->n_faces; i++) if (m->face_ptr[i + 1] - m->face_ptr[i] > most) most = m->face_ptr[i + 1] - m->face_ptr[i];
    return most;
}

static void mio_ply_write_header(mio_file *f, const mio_mesh *m, const mio_output *o)
{
    int32_t c;
    mio_put_text(f, "ply\nformat binary_little_endian 1.0\n");
    for (c = 0; c < o->cols && o->names; c++) {
        mio_put_text(f, c ? "comment quality_" : "comment quality");
        if (c) mio_put_integer(f, c);
        mio_put_text(f, ": ");
        mio_put_line(f, o->names[c]);
        mio_put_text(f, "\n");
    }
    mio_put_text(f, "element vertex ");
    mio_put_integer(f, m->n);
    mio_put_text(f, "\nproperty double x\nproperty double y\nproperty double z\n");
    if (o->rgb) mio_put_text(f, "property uchar red\nproperty uchar green\nproperty uchar blue\n");
    for (c = 0; c < o->cols; c++) {
        mio_put_text(f, c ? "property double quality_" : "property double quality");
        if (c) mio_put_integer(f, c);
        mio_put_text(f, "\n");
    }
    if (m->n_faces) {
        mio_put_text(f, "element face ");
        mio_put_integer(f, m->n_faces);
        mio_put_text(f, mio_longest_face(m) < 256 ? "\nproperty list uchar int vertex_indices\n" : "\nproperty list int int vertex_indices\n");
    }
    mio_put_text(f, "end_header\n");
}

static int mio_write_ply(const char *path, const mio_mesh *m, const mio_output *o, mio_error *e)
{
    mio_file f;
    int32_t i, c, wide;
    int64_t k;
    if (mio_check_rows(path, m, o, e) < 0) return MIO_FAILED;
    if (mio_file_open(&f, path, o->stop, e) < 0) return mio_file_close(&f);
    mio_ply_write_header(&f, m, o);
    for (i = 0; i < m->n && f.status == MIO_OK; i++) {
        for (c = 0; c < 3; c++) mio_put_f64(&f, m->xyz[3 * (size_t)i + (size_t)c]);
        if (o->rgb) mio_file_put(&f, o->rgb + 3 * (size_t)i, 3);
        for (c = 0; c < o->cols; c++) mio_put_f64(&f, o->values[c * o->ld + i]);
    }
    wide = mio_longest_face(m) > 255;
    for (i = 0; i < m->n_faces && f.status == MIO_OK; i++) {
        const int64_t corners = m->face_ptr[i + 1] - m->face_ptr[i];
        const unsigned char byte = (unsigned char)(corners & 255);
        if (wide) mio_put_u32(&f, (uint32_t)corners);
        else mio_file_put(&f, &byte, 1);
        for (k = m->face_ptr[i]; k < m->face_ptr[i + 1]; k++) mio_put_u32(&f, (uint32_t)m->face_idx[k]);
    }
    return mio_file_close(&f);
}

static int mio_write_obj(const char *path, const mio_mesh *m, const mio_output *o, mio_error *e)
{
    mio_file f;
    char text[32];
    int32_t i, c;
    int64_t k;
    if (mio_check_rows(path, m, o, e) < 0) return MIO_FAILED;
    if (mio_file_open(&f, path, o->stop, e) < 0) return mio_file_close(&f);
    for (i = 0; i < m->n && f.status == MIO_OK; i++) {
        mio_put_text(&f, "v");
        for (c = 0; c < 3; c++) {
            mio_put_text(&f, " ");
            mio_put_double(&f, m->xyz[3 * (size_t)i + (size_t)c]);
        }
        for (c = 0; c < 3 && o->rgb; c++)
            mio_file_put(&f, text, (size_t)snprintf(text, sizeof text, " %.5g", o->rgb[3 * (size_t)i + (size_t)c] / 255.0));
        mio_put_text(&f, "\n");
    }
    for (i = 0; i < m->n_faces && f.status == MIO_OK; i++) {
        mio_put_text(&f, "f");
        for (k = m->face_ptr[i]; k < m->face_ptr[i + 1]; k++) {
            mio_put_text(&f, " ");
            mio_put_integer(&f, (int64_t)m->face_idx[k] + 1);
        }
        mio_put_text(&f, "\n");
    }
    return mio_file_close(&f);
}

/* Text inside an XML attribute. */
static void mio_put_xml(mio_file *f, const char *text)
{
    for (; *text; text++) {
        switch (*text) {
        case '&':  mio_put_text(f, "&amp;"); break;
        case '<':  mio_put_text(f, "&lt;"); break;
        case '>':  mio_put_text(f, "&gt;"); break;
        case '"':  mio_put_text(f, "&quot;"); break;
        case '\'': mio_put_text(f, "&apos;"); break;
        default:   mio_file_put(f, (unsigned char)*text < 32 ? " " : text, 1);
        }
    }
}

/* The name of column c, quoted: the caller's, or field, field_1, ... */
static void mio_vtu_name(mio_file *f, const mio_output *o, int32_t c)
{
    mio_put_text(f, "\"");
    if (o->names) mio_put_xml(f, o->names[c]);
    else mio_put_text(f, "field");
    if (!o->names && c) { mio_put_text(f, "_"); mio_put_integer(f, c); }
    mio_put_text(f, "\"");
}

/* The rest of a DataArray's tag, whose data end at *end, and steps back over them: the size in 8 bytes, then `bytes` of numbers.
 *
 * The data of the arrays lie in the file in the opposite order of their tags: the cells first, the first column last. meshio 5.0 turns
 * the offsets in the tags into others, one array after another in the order of the data, and takes the first tag that has the
 * offset it looks for. In the order of the tags this can be one that is done already: with four columns its new offset is the
 * old one of another. In the opposite order the tags that are done stand behind. */
static void mio_vtu_appended(mio_file *f, int64_t *end, int64_t bytes)
{
    *end -= 8 + bytes;
    mio_put_text(f, " format=\"appended\" offset=\"");
    mio_put_integer(f, *end);
    mio_put_text(f, "\"/>\n");
}

/* Cells are the faces; points alone get a cell each, without which most programs would not show them. */
static void mio_vtu_header(mio_file *f, const mio_mesh *m, const mio_output *o)
{
    const int64_t cells = m->n_faces ? m->n_faces : m->n, corners = m->n_faces ? m->face_ptr[m->n_faces] : m->n;
    int64_t end = 4 * 8 + 24 * (int64_t)m->n + 8 * corners + 9 * cells;
    int32_t c;
    end += o->cols * (8 + 8 * (int64_t)m->n) + (o->rgb ? 8 + 3 * (int64_t)m->n : 0);
    mio_put_text(f, "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
                    "<UnstructuredGrid>\n<Piece NumberOfPoints=\"");
    mio_put_integer(f, m->n);
    mio_put_text(f, "\" NumberOfCells=\"");
    mio_put_integer(f, cells);
    mio_put_text(f, "\">\n<PointData");
    if (o->cols) { mio_put_text(f, " Scalars="); mio_vtu_name(f, o, 0); }
    mio_put_text(f, ">\n");
    for (c = 0; c < o->cols; c++) {
        mio_put_text(f, "<DataArray type=\"Float64\" Name=");
        mio_vtu_name(f, o, c);
        mio_vtu_appended(f, &end, 8 * (int64_t)m->n);
    }
    if (o->rgb) {
        mio_put_text(f, "<DataArray type=\"UInt8\" Name=\"RGB\" NumberOfComponents=\"3\"");
        mio_vtu_appended(f, &end, 3 * (int64_t)m->n);
    }
    mio_put_text(f, "</PointData>\n<Points>\n<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"");
    mio_vtu_appended(f, &end, 24 * (int64_t)m->n);
    mio_put_text(f, "</Points>\n<Cells>\n<DataArray type=\"Int64\" Name=\"connectivity\"");
    mio_vtu_appended(f, &end, 8 * corners);
    mio_put_text(f, "<DataArray type=\"Int64\" Name=\"offsets\"");
    mio_vtu_appended(f, &end, 8 * cells);
    mio_put_text(f, "<DataArray type=\"UInt8\" Name=\"types\"");
    mio_vtu_appended(f, &end, cells);
    mio_put_text(f, "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
}

static void mio_vtu_cells(mio_file *f, const mio_mesh *m)
{
    const int32_t cells = m->n_faces ? m->n_faces : m->n;
    const int64_t corners = m->n_faces ? m->face_ptr[m->n_faces] : m->n;
    int64_t k;
    int32_t i;
    mio_put_u64(f, (uint64_t)cells);
    for (i = 0; i < cells && f->status == MIO_OK; i++) {
        const int64_t n = m->n_faces ? m->face_ptr[i + 1] - m->face_ptr[i] : 1;
        const unsigned char type = n == 1 ? 1 : n == 3 ? 5 : n == 4 ? 9 : 7;         /* VTK's vertex, triangle, quad, polygon */
        mio_file_put(f, &type, 1);
    }
    mio_put_u64(f, 8 * (uint64_t)cells);
    for (i = 0; i < cells && f->status == MIO_OK; i++) mio_put_u64(f, m->n_faces ? (uint64_t)m->face_ptr[i + 1] : (uint64_t)i + 1);
    mio_put_u64(f, 8 * (uint64_t)corners);
    for (k = 0; k < corners && f->status == MIO_OK; k++) mio_put_u64(f, m->n_faces ? (uint64_t)m->face_idx[k] : (uint64_t)k);
}

static int mio_write_vtu(const char *path, const mio_mesh *m, const mio_output *o, mio_error *e)
{
    mio_file f;
    size_t i;
    int32_t c, v;
    if (mio_check_rows(path, m, o, e) < 0) return MIO_FAILED;
    if (mio_file_open(&f, path, o->stop, e) < 0) return mio_file_close(&f);
    mio_vtu_header(&f, m, o);
    mio_vtu_cells(&f, m);
    mio_put_u64(&f, 24 * (uint64_t)m->n);
    for (i = 0; i < 3 * (size_t)m->n && f.status == MIO_OK; i++) mio_put_f64(&f, m->xyz[i]);
    if (o->rgb) {
        mio_put_u64(&f, 3 * (uint64_t)m->n);
        mio_file_put(&f, o->rgb, 3 * (size_t)m->n);
    }
    for (c = o->cols - 1; c >= 0; c--) {
        mio_put_u64(&f, 8 * (uint64_t)m->n);
        for (v = 0; v < m->n && f.status == MIO_OK; v++) mio_put_f64(&f, o->values[c * o->ld + v]);
    }
    mio_put_text(&f, "\n</AppendedData>\n</VTKFile>\n");
    return mio_file_close(&f);
}

static int mio_write_off(const char *path, const mio_mesh *m, const mio_output *o, mio_error *e)
{
    mio_file f;
    int32_t i, c;
    int64_t k;
    if (mio_check_rows(path, m, o, e) < 0) return MIO_FAILED;
    if (mio_file_open(&f, path, o->stop, e) < 0) return mio_file_close(&f);
    mio_put_text(&f, "OFF\n");
    mio_put_integer(&f, m->n);
    mio_put_text(&f, " ");
    mio_put_integer(&f, m->n_faces);
    mio_put_text(&f, " 0\n");
    for (i = 0; i < m->n && f.status == MIO_OK; i++)
        for (c = 0; c < 3; c++) {
            mio_put_double(&f, m->xyz[3 * (size_t)i + (size_t)c]);
            mio_put_text(&f, c < 2 ? " " : "\n");
        }
    for (i = 0; i < m->n_faces && f.status == MIO_OK; i++) {
        mio_put_integer(&f, m->face_ptr[i + 1] - m->face_ptr[i]);
        for (k = m->face_ptr[i]; k < m->face_ptr[i + 1]; k++) {
            mio_put_text(&f, " ");
            mio_put_integer(&f, m->face_idx[k]);
        }
        mio_put_text(&f, "\n");
    }
    return mio_file_close(&f);
}

/* A vector in 32 bits a coordinate, times a factor. */
static void mio_put_f32(mio_file *f, const double v[3], double factor)
{
    int c;
    for (c = 0; c < 3; c++) {
        const float x = (float)(v[c] * factor);
        uint32_t u;
        memcpy(&u, &x, sizeof u);
        mio_put_u32(f, u);
    }
}

static void mio_put_facet(mio_file *f, const double *a, const double *b, const double *c)
{
    double n[3], size;
    int k;
    for (k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
    }
    size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(size > 0 && size <= DBL_MAX)) n[0] = n[1] = n[2] = 0;
    mio_put_f32(f, n, size > 0 ? 1 / size : 1);
    mio_put_f32(f, a, 1);
    mio_put_f32(f, b, 1);
    mio_put_f32(f, c, 1);
    mio_file_put(f, "\0\0", 2);
}

static int mio_write_stl(const char *path, const mio_mesh *m, const mio_output *o, mio_error *e)
{
    static const char head[80] = "binary STL by heatdiff";
    mio_file f;
    int32_t i;
    int64_t k;
    if (mio_check_rows(path, m, o, e) < 0) return MIO_FAILED;
    for (k = 0; k < 3 * (int64_t)m->n; k++)
        if (fabs(m->xyz[k]) > (double)FLT_MAX)
            return mio_fail_at(e, path, 0, "vertex %lld: %g is too large for the 32 bits of STL", (long long)(k / 3), m->xyz[k]);
    if (mio_file_open(&f, path, o->stop, e) < 0) return mio_file_close(&f);
    mio_file_put(&f, head, sizeof head);
    mio_put_u32(&f, (uint32_t)(m->face_ptr[m->n_faces] - 2 * (int64_t)m->n_faces));
    for (i = 0; i < m->n_faces && f.status == MIO_OK; i++) {
        const int32_t *v = m->face_idx + m->face_ptr[i];
        for (k = 1; k + 1 < m->face_ptr[i + 1] - m->face_ptr[i]; k++)
            mio_put_facet(&f, m->xyz + 3 * (size_t)v[0], m->xyz + 3 * (size_t)v[k], m->xyz + 3 * (size_t)v[k + 1]);
    }
    return mio_file_close(&f);
}

static int mio_write(const char *path, int format, const mio_mesh *m, const mio_output *o, mio_error *e)
{
    switch (format) {
    case MIO_TXT: return mio_write_text(path, o, e);
    case MIO_CSV: return mio_write_csv(path, o, e);
    case MIO_NPY: return mio_write_npy(path, o, e);
    case MIO_PLY: return mio_write_ply(path, m, o, e);
    case MIO_OBJ: return mio_write_obj(path, m, o, e);
    case MIO_VTU: return mio_write_vtu(path, m, o, e);
    case MIO_OFF: return mio_write_off(path, m, o, e);
    case MIO_STL: return mio_write_stl(path, m, o, e);
    default:      return mio_fail_at(e, path, 0, "not a format this writes (txt, csv, npy, ply, obj, vtu, off, stl)");
    }
}

#endif
