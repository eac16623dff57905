/* heatdiff.c - the command-line tool: heat kernels, signatures and distances on meshes and points

   Build from the top folder:   cc -O2 tools/heatdiff.c -o heatdiff -lm
   Use:                         heatdiff --help, heatdiff COMMAND --help, heatdiff demo

   Read the file from bottom to top: everything is defined above its use, and main is the last function. File
   formats are in meshio.h, pictures in picture.h, the demo's shape in shapes.h, all mathematics in
   heatdiff.h.

   Two rules hold for the whole tool. Results go to the output, and everything meant for people goes to
   standard error. A function that can fail prints one error line with fail() and returns an exit code; 0 is
   success.

   Licence: MIT or public domain, at your choice; see the end of heatdiff.h. */

/* ==== platform ==== */

#if !defined(_WIN32) && !defined(HEATDIFF_TOOL_PLAIN)
#define TOOL_POSIX 1          /* signals, terminals, a fine clock; without it the tool is plain C99 */
#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700
#endif
#endif

#define HEATDIFF_IMPLEMENTATION
#include "../heatdiff.h"
#include "levels.h"
#include "meshio.h"
#include "picture.h"
#include "shapes.h"

#include <ctype.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifdef TOOL_POSIX
#include <sys/stat.h>
#include <unistd.h>
#elif defined(_WIN32)
#include <direct.h>
#include <io.h>
#endif

enum { DONE = 0, FAILED = 1, USAGE = 2, INTERRUPTED = 130 };   /* exit codes */

#if defined(__GNUC__)
#define TOOL_PRINTF(f, a) __attribute__((format(printf, f, a)))
#else
#define TOOL_PRINTF(f, a)
#endif

/* Seconds on a clock that only runs forward, from an unknown start. */
static double now(void)
{
#ifdef TOOL_POSIX
    struct timespec ts;
    if (clock_gettime(CLOCK_MONOTONIC, &ts) == 0) return (double)ts.tv_sec + 1e-9 * (double)ts.tv_nsec;
#endif
    return (double)clock() / CLOCKS_PER_SEC;
}

static int stderr_is_terminal(void)
{
#ifdef TOOL_POSIX
    return isatty(STDERR_FILENO);
#elif defined(_WIN32)
    return _isatty(_fileno(stderr));
#else
    return 0;
#endif
}

static int stdout_is_terminal(void)
{
#ifdef TOOL_POSIX
    return isatty(STDOUT_FILENO);
#elif defined(_WIN32)
    return _isatty(_fileno(stdout));
#else
    return 0;
#endif
}

static int make_folder(const char *path)
{
#ifdef TOOL_POSIX
    struct stat there;
    if (mkdir(path, 0777) == 0) return 1;
    return errno == EEXIST && stat(path, &there) == 0 && S_ISDIR(there.st_mode);
#elif defined(_WIN32)
    return _mkdir(path) == 0 || errno == EEXIST;
#else
    (void)path;          /* plain C cannot make folders; writing into it will tell whether it is there */
    return 1;
#endif
}

/* ==== progress bar ==== */

enum { BAR_CELLS = 24, BAR_TEXT = 72 };

/* part names the current part of the work, such as "time 2 of 5". */
static struct { int enabled, visible; double last; char part[48]; } bar;

static void bar_hide(void)
{
    if (!bar.visible) return;
    fprintf(stderr, "\r%*s\r", BAR_TEXT, "");
    fflush(stderr);
    bar.visible = 0;
}

/* Draws at most ten times a second, because terminals are slow. */
static void bar_show(const char *stage, double done)
{
    char cells[BAR_CELLS + 1], text[80];
    int full, i;
    const double time = bar.enabled ? now() : 0.0;
    if (!bar.enabled || time - bar.last < 0.1) return;
    done = done >= 0 && done <= 1 ? done : 0;
    full = (int)(done * BAR_CELLS);
    for (i = 0; i < BAR_CELLS; i++) cells[i] = i < full ? '#' : '.';
    cells[BAR_CELLS] = 0;
    snprintf(text, sizeof text, "%.38s%s%s", stage, bar.part[0] ? ", " : "", bar.part);
    fprintf(stderr, "\r[%s] %3.0f%% %-38.38s", cells, 100 * done, text);
    fflush(stderr);
    bar.visible = 1;
    bar.last = time;
}

/* From now on the bar shows part i of n, counted from 0. With a single part it shows no number. */
static void bar_part(const char *what, int64_t i, int64_t n)
{
    if (n > 1) snprintf(bar.part, sizeof bar.part, "%.10s %ld of %ld", what, (long)i + 1, (long)n);
    else bar.part[0] = 0;
}

/* ==== seconds of the stages ==== */
/* The library has no clock, but its progress calls name the current stage. The time until the next stage
 * begins belongs to it. */

enum { STAGE_ORDER, STAGE_ANALYSE, STAGE_FACTOR, STAGE_PRECONDITION, STAGE_INVERT, STAGE_SOLVE, N_STAGES,
       STAGE_ASSEMBLE = N_STAGES, N_NAMES };
/* "assemble" is the last because it is reported separately. */
static const char *const STAGE_NAMES[N_NAMES] = { "order", "analyse", "factor", "precondition", "invert",
                                                  "solve", "assemble" };

static struct { int running, stage; double since, spent[N_NAMES]; } stages;

static void stages_book(void)
{
    const double time = now();
    stages.spent[stages.stage] += time - stages.since;
    stages.since = time;
}

static void stages_start(void)
{
    stages.stage = STAGE_SOLVE;
    stages.since = now();
    stages.running = 1;
}

static void stages_stop(void)
{
    stages_book();
    stages.running = 0;
}

static void stages_enter(const char *name)
{
    int i;
    if (!stages.running || strcmp(name, STAGE_NAMES[stages.stage]) == 0) return;
    stages_book();
    stages.stage = STAGE_SOLVE;
    for (i = 0; i < N_NAMES; i++)
        if (strcmp(name, STAGE_NAMES[i]) == 0) stages.stage = i;
}

/* ==== the one place that reports errors ==== */

/* Prints "heatdiff: error: ..." as exactly one line, whatever a file name may contain, and returns code. */
TOOL_PRINTF(2, 3) static int fail(int code, const char *format, ...)
{
    char text[1500];
    size_t i;
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    for (i = 0; text[i]; i++)
        if (iscntrl((unsigned char)text[i])) text[i] = '?';
    bar_hide();
    fprintf(stderr, "heatdiff: error: %s\n", text);
    return code;
}

static int fail_memory(const char *what)
{
    return fail(FAILED, "out of memory for %s", what);
}

/* ==== Ctrl-C ==== */
/* During a computation Ctrl-C sets a flag. The progress callback sees it, and the run ends in order. During
 * loading and writing, and at the second Ctrl-C, the handler removes the unfinished file and exits at
 * once. */

static struct {
    volatile sig_atomic_t asked;     /* Ctrl-C came */
    volatile sig_atomic_t patient;   /* computing: the flag will be seen */
} interrupt;

static void on_interrupt(int number)
{
    if (interrupt.patient && !interrupt.asked) {
        interrupt.asked = 1;
#ifndef TOOL_POSIX
        signal(number, on_interrupt);
#endif
        return;
    }
    (void)number;
    mio_remove_temporary();
#ifdef TOOL_POSIX
    if (bar.visible && write(STDERR_FILENO, "\n", 1) < 0) { /* nobody is left to be told */ }
    _exit(INTERRUPTED);
#else
    _Exit(INTERRUPTED);
#endif
}

static void catch_interrupts(void)
{
#ifdef TOOL_POSIX
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_interrupt;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
#ifdef SIGXFSZ
    signal(SIGXFSZ, SIG_IGN);        /* beyond the limit of a file's size writing fails, as on a full disk */
#endif
#else
    signal(SIGINT, on_interrupt);
#endif
}

/* Ends the computing part: from here on Ctrl-C exits at once. A Ctrl-C that came just before counts too. */
static int leave_computation(int code)
{
    interrupt.patient = 0;
    return interrupt.asked ? INTERRUPTED : code;
}

static hd_progress on_progress(void *user, const char *stage, double done)
{
    (void)user;
    stages_enter(stage);
    if (interrupt.asked) return HD_PROGRESS_CANCEL;
    bar_show(stage, done);
    return HD_PROGRESS_CONTINUE;
}

/* Checks that everything printed on standard output has been written. */
static int close_stdout(void)
{
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout)) return DONE;
    return fail(FAILED, "standard output: cannot write: %s", errno ? strerror(errno) : "it is closed");
}

/* Nine tenths of the machine's memory, 0 if unknown. With more, the system might kill the process without a
 * readable error. */
static uint64_t machine_bytes(void)
{
#ifdef _SC_PHYS_PAGES
    const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    return pages > 0 && size > 0 ? (uint64_t)pages / 10 * 9 * (uint64_t)size : 0;
#else
    return 0;
#endif
}

/* ==== words ==== */
/* Names on the command line and in reports, one table for both directions. */

typedef struct word { const char *name; int value; } word;

static const word BORDERS[] = {
    { "natural", HD_BORDER_NATURAL }, { "dirichlet", HD_BORDER_DIRICHLET }, { NULL, 0 } };
static const word GEODESIC_BORDERS[] = {
    { "natural", HD_GEODESIC_BORDER_NATURAL }, { "mean", HD_GEODESIC_BORDER_MEAN },
    { "dirichlet", HD_GEODESIC_BORDER_DIRICHLET }, { NULL, 0 } };
static const word LAPLACIANS[] = {
    { "fem", HD_LAPLACIAN_FEM }, { "voronoi-cot", HD_LAPLACIAN_VORONOI_COT }, { "cot", HD_LAPLACIAN_COT },
    { "polygon", HD_LAPLACIAN_POLYGON }, { "voronoi-exp", HD_LAPLACIAN_VORONOI_EXP },
    { "exp", HD_LAPLACIAN_EXP }, { NULL, 0 } };
static const word POLES[] = {
    { "uniform", HD_POLES_UNIFORM }, { "kernel", HD_POLES_KERNEL },
    { NULL, 0 } };
static const word METHODS[] = {
    { "auto", HD_METHOD_AUTO }, { "direct", HD_METHOD_DIRECT }, { "krylov", HD_METHOD_KRYLOV },
    { "iterative", HD_METHOD_ITERATIVE }, { "local", HD_METHOD_LOCAL }, { NULL, 0 } };
static const word ORDERINGS[] = {
    { "auto", HD_ORDERING_AUTO }, { "amd", HD_ORDERING_MINIMUM_DEGREE },
    { "dissection", HD_ORDERING_NESTED_DISSECTION }, { NULL, 0 } };
static const word SIMDS[] = {
    { "auto", HD_SIMD_AUTO }, { "none", HD_SIMD_NONE }, { "avx2", HD_SIMD_AVX2 },
    { "avx512", HD_SIMD_AVX512 }, { NULL, 0 } };
static const word SOLVERS[] = {
    { "cocg", HD_SOLVER_COCG }, { "minres", HD_SOLVER_MINRES },
    { "lanczos", HD_SOLVER_LANCZOS }, { NULL, 0 } };
static const word PRECONDS[] = {
    { "none", HD_PRECOND_NONE }, { "jacobi", HD_PRECOND_JACOBI }, { "ssor", HD_PRECOND_SSOR },
    { "ildl", HD_PRECOND_ILDL }, { "mildl", HD_PRECOND_MILDL }, { NULL, 0 } };
static const word KERNELS[] = { { "operator", HD_KERNEL_OPERATOR }, { "symmetric", HD_KERNEL_SYMMETRIC },
                                { NULL, 0 } };

static const word FILTERS[] = {
    { "heat", HD_FILTER_HEAT }, { "wave", HD_FILTER_WAVE }, { "mexican-hat", HD_FILTER_MEXICAN_HAT },
    { "resolvent", HD_FILTER_RESOLVENT }, { "fractional", HD_FILTER_FRACTIONAL },
    { "band", HD_FILTER_BAND }, { "biharmonic", HD_FILTER_BIHARMONIC }, { NULL, 0 } };

static const word COLORMAPS[] = {
    { "ember", PIC_MAP_EMBER }, { "lagoon", PIC_MAP_LAGOON }, { "diverging", PIC_MAP_DIVERGING },
    { "grey", PIC_MAP_GREY }, { NULL, 0 } };

static const word AXES[] = { { "x", PIC_UP_X }, { "y", PIC_UP_Y }, { "z", PIC_UP_Z }, { NULL, 0 } };

static const word *find_word(const word *words, const char *name)
{
    for (; words->name; words++)
        if (strcmp(words->name, name) == 0) return words;
    return NULL;
}

/* Definitions of distances, and what the tool has to know of each. */
static const word DEFINITIONS[] = {
    { "classical", HD_DISTANCE_CLASSICAL }, { "weighted", HD_DISTANCE_WEIGHTED },
    { "commute", HD_DISTANCE_COMMUTE }, { "biharmonic", HD_DISTANCE_BIHARMONIC }, { NULL, 0 } };
static const struct { hd_query query; int timeless; } OF_DEFINITION[] = {     /* in the same order */
    { HD_QUERY_DISTANCE, 0 }, { HD_QUERY_DISTANCE_WEIGHTED, 0 },
    { HD_QUERY_DISTANCE_COMMUTE, 1 }, { HD_QUERY_DISTANCE_BIHARMONIC, 1 } };

enum { WORDS_TEXT = 120 };

/* "a, b or c", in text [WORDS_TEXT]. */
static const char *list_words(const word *words, char *text)
{
    size_t used = 0;
    int q;
    for (q = 0; words[q].name && used < WORDS_TEXT; q++)
        used += (size_t)snprintf(text + used, WORDS_TEXT - used, "%s%s",
                                 q == 0 ? "" : words[q + 1].name ? ", " : " or ", words[q].name);
    return text;
}

static const char *word_of(const word *words, int value)
{
    for (; words->name; words++)
        if (words->value == value) return words->name;
    return "auto";
}

enum { FORMAT_PNG = 100 };           /* beside the formats of meshio.h */

/* The format of an output by its name, or MIO_UNKNOWN. */
static int output_format(const char *path)
{
    if (strcmp(path, "-") == 0) return MIO_TXT;
    /* /dev/null, /dev/stdout */
    if (strncmp(path, "/dev/", 5) == 0 && !strchr(path, '.')) return MIO_TXT;
    return mio_has_extension(path, "png") ? FORMAT_PNG : mio_format_of(path);
}

/* ==== options ==== */

enum { CMD_INFO = 1, CMD_KERNEL = 2, CMD_DIFFUSE = 4, CMD_RENDER = 8, CMD_DEMO = 16, CMD_GEODESIC = 32,
       CMD_HKS = 64, CMD_DISTANCE = 128, CMD_PAIRS = 256, CMD_SAMPLE = 512, CMD_SPECTRUM = 1024,
       CMD_TRACE = 2048, CMD_LEVELS = 4096, CMD_SMOOTH = 8192, CMD_ALL = 16383,
       CMD_TABLES = CMD_PAIRS | CMD_SAMPLE | CMD_TRACE,
       CMD_HEAT = CMD_KERNEL | CMD_DIFFUSE | CMD_SMOOTH | CMD_HKS | CMD_DISTANCE | CMD_TABLES,
       /* results have a row per vertex */
       CMD_SOLVES = CMD_HEAT | CMD_GEODESIC | CMD_SPECTRUM,
       CMD_FIELDS = CMD_SOLVES & ~(CMD_TABLES | CMD_SMOOTH),
       CMD_METRIC = CMD_DISTANCE | CMD_PAIRS | CMD_SAMPLE,
       /* by selected inversion, which the direct method has, and diagonals also patch by patch */
       CMD_DIAGONAL = CMD_HKS | CMD_TRACE, CMD_INVERTS = CMD_DIAGONAL | CMD_DISTANCE | CMD_SAMPLE,
       CMD_ANYHOW = CMD_HEAT & ~CMD_INVERTS, CMD_PICTURE = CMD_FIELDS | CMD_RENDER,
       CMD_LAPLACIAN = CMD_INFO | CMD_HEAT | CMD_SPECTRUM, CMD_SURFACE = CMD_LAPLACIAN | CMD_GEODESIC,
       CMD_FROM = CMD_DISTANCE | CMD_GEODESIC, CMD_ANYWHERE = CMD_KERNEL | CMD_FROM | CMD_SAMPLE };

/* TIME_SPECTRAL: over the first eigenvalue. */
typedef enum time_unit { TIME_ABSOLUTE, TIME_H2, TIME_SPECTRAL, TIME_AUTO } time_unit;
/* value is the number, or for auto the number of times. */
typedef struct time_spec { time_unit unit; double value; } time_spec;

enum { MAX_PANELS = 12 };            /* of a picture */

/* A point of a source: a vertex, or a place in a face. */
typedef struct source_point {
    int64_t id;                      /* of the vertex or the face; 64 bits, as sources below */
    int in_face;
    double bary[2], weight;          /* of the first two corners */
    int source;                      /* which one it is a point of */
    int64_t line;                    /* of the file it was read from, 0: the command line */
} source_point;

typedef struct options {
    const char *program;             /* as it was called */
    unsigned command;
    const char *mesh;
    /* of render: all of them; input and mesh are the first */
    const char *inputs[MAX_PANELS], *meshes[MAX_PANELS];
    int n_inputs, n_meshes;
    time_spec *times;                /* as written; absolute times are known once h is */
    int n_times;
    const char *filter;              /* as written; NULL: none, times are given */
    int filter_kind;
    time_spec filter_a;              /* absolute or h2 */
    double filter_b;
    int64_t *sources;                /* 64 bits, so that ids beyond any mesh are told as what they are */
    int n_sources;
    source_point *points;            /* the same, if one of them is more than a vertex */
    int n_points, anywhere, curve;
    const char *source_text, *source_file;
    const char *lengths;             /* a file with those of the edges, or NULL: positions tell */
    const char *input, *output, *title;
    int has_bandwidth;
    time_spec bandwidth;             /* absolute or h2 */
    int laplacian, border, poles, method, ordering, simd, solver, precond, kernel, definition;
    long degree, max_iterations, threads, count, frequencies;
    double tol, lambda, weight_cut, below;
    uint64_t memory_limit;
    int intrinsic_delaunay, tufted;
    int nearest, matrix;             /* instead of columns of distances */
    double *levels;                  /* values, or NULL: n_levels of them between the extremes */
    int n_levels;
    int json, quiet, verbose, help, version, no_header, dry_run, normalise;
    int colormap, up, labels;        /* pictures */
    int log_scale, has_range, has_view, has_isolines;
    long isolines, column, width, height;
    double low, high, azimuth, elevation;
} options;

struct option_def;
typedef int (*option_parser)(options *o, const struct option_def *def, const char *text);

typedef struct option_def {
    const char *name;
    char letter;                     /* 0: none */
    unsigned commands;               /* that take it */
    int is_list;                     /* given twice is an error: which of the two lists was meant? */
    option_parser parse;             /* returns 1; 0: text is not what the option takes; -1: no memory */
    size_t field;                    /* offset in options, for the general parsers */
    const word *words;
    long least, most;
    const char *value;               /* its name in the help; NULL: a flag */
    const char *takes;               /* "--t takes ..."; NULL: any of the words */
    const char *help;                /* @: the words */
} option_def;

/* ---- parsing of values: all of the text or nothing, no white space, no hexadecimal ---- */

/* Reads a finite number. *end points behind it. */
static int read_number(const char *text, double *value, const char **end)
{
    char *stop = NULL;
    const char *p = text + (*text == '-' || *text == '+');
    if (!isdigit((unsigned char)*p) && !(*p == '.' && isdigit((unsigned char)p[1]))) return 0;
    if (p[0] == '0' && (p[1] == 'x' || p[1] == 'X')) return 0;
    *value = strtod(text, &stop);
    *end = stop;
    return isfinite(*value);
}

static int read_integer(const char *text, int64_t *value, const char **end)
{
    char *stop = NULL;
    const char *p = text + (*text == '-' || *text == '+');
    if (!isdigit((unsigned char)*p)) return 0;
    *value = strtoll(text, &stop, 10);   /* beyond 64 bits: the nearest value, which is out of every range */
    *end = stop;
    return 1;
}

static int read_real(const char *text, double *value)
{
    const char *end;
    return read_number(text, value, &end) && *end == 0;
}

/* Two finite numbers with a separator between. */
static int read_pair(const char *text, char separator, double *a, double *b)
{
    const char *end;
    return read_number(text, a, &end) && *end == separator && read_real(end + 1, b);
}

static void *field_of(options *o, const option_def *def) { return (char *)o + def->field; }

static int parse_flag(options *o, const option_def *def, const char *text)
{
    (void)text;
    *(int *)field_of(o, def) = 1;
    return 1;
}

static int parse_text(options *o, const option_def *def, const char *text)
{
    *(const char **)field_of(o, def) = text;
    return *text != 0;
}

static int parse_inputs(options *o, const option_def *def, const char *text)
{
    (void)def;
    if (!*text || o->n_inputs == MAX_PANELS) return 0;
    if (!o->n_inputs) o->input = text;
    o->inputs[o->n_inputs++] = text;
    return 1;
}

static int parse_words(options *o, const option_def *def, const char *text)
{
    const word *w = find_word(def->words, text);
    if (w) *(int *)field_of(o, def) = w->value;
    return w != NULL;
}

static int parse_integer(options *o, const option_def *def, const char *text)
{
    int64_t v;
    const char *end;
    if (!read_integer(text, &v, &end) || *end || v < def->least || v > def->most) return 0;
    *(long *)field_of(o, def) = (long)v;
    return 1;
}

static int parse_isolines(options *o, const option_def *def, const char *text)
{
    o->has_isolines = 1;
    return parse_integer(o, def, text);
}

static int parse_tol(options *o, const option_def *def, const char *text)
{
    (void)def;
    return read_real(text, &o->tol) && o->tol > 0 && o->tol < 1;
}

static int parse_lambda(options *o, const option_def *def, const char *text)
{
    (void)def;
    return read_real(text, &o->lambda) && o->lambda > 0 && o->lambda <= 1e100;
}

static int parse_below(options *o, const option_def *def, const char *text)
{
    (void)def;
    return read_real(text, &o->below) && o->below > 0;
}

static int parse_range(options *o, const option_def *def, const char *text)
{
    (void)def;
    o->has_range = 1;
    return read_pair(text, ',', &o->low, &o->high) && o->low < o->high;
}

static int parse_view(options *o, const option_def *def, const char *text)
{
    (void)def;
    o->has_view = 1;
    return read_pair(text, ',', &o->azimuth, &o->elevation) && fabs(o->azimuth) <= 3600 &&
           fabs(o->elevation) <= 90;
}

static int parse_size(options *o, const option_def *def, const char *text)
{
    int64_t w, h;
    const char *end;
    if (!read_integer(text, &w, &end) || *end != 'x' || !read_integer(end + 1, &h, &end) || *end) return 0;
    if (w < def->least || w > def->most || h < def->least || h > def->most) return 0;
    o->width = (long)w;
    o->height = (long)h;
    return 1;
}

static int parse_bytes(options *o, const option_def *def, const char *text)
{
    double v;
    const char *end, *suffix;
    static const char SUFFIXES[] = "KMG";
    (void)def;
    if (!read_number(text, &v, &end) || v <= 0) return 0;
    if (*end && (suffix = strchr(SUFFIXES, toupper((unsigned char)*end))) != NULL) {
        v = ldexp(v, 10 * (int)(suffix - SUFFIXES + 1));
        end++;
    }
    if (*end || v < 1 || v >= 9.2e18) return 0;
    o->memory_limit = (uint64_t)v;
    return 1;
}

/* An upper bound on the number of entries in a comma list. */
static size_t count_items(const char *text)
{
    size_t n = 1;
    for (; *text; text++) n += *text == ',';
    return n;
}

static int read_time(const char *text, time_spec *t, const char **end)
{
    int64_t count;
    if (strncmp(text, "auto:", 5) == 0) {
        t->unit = TIME_AUTO;
        if (!read_integer(text + 5, &count, end) || count < 1 || count > 1000) return 0;
        t->value = (double)count;
        return 1;
    }
    t->unit = TIME_ABSOLUTE;
    if (!read_number(text, &t->value, end) || t->value < 0) return 0;
    if (strncmp(*end, "h2", 2) == 0) {
        t->unit = TIME_H2;
        *end += 2;
    } else if (strncmp(*end, "/l1", 3) == 0) {
        t->unit = TIME_SPECTRAL;
        *end += 3;
    }
    return 1;
}

static int parse_times(options *o, const option_def *def, const char *text)
{
    (void)def;
    o->times = (time_spec *)calloc(count_items(text), sizeof *o->times);
    if (!o->times) return -1;
    for (;; text++) {
        if (!read_time(text, &o->times[o->n_times++], &text)) return 0;
        if (*text != ',') return *text == 0;
    }
}

/* NAME:A or NAME:A,B. Filters whose A is a time take multiples of h^2 too. */
static int parse_filter(options *o, const option_def *def, const char *text)
{
    const char *colon = strchr(text, ':'), *end;
    const size_t length = colon ? (size_t)(colon - text) : 0;
    char name[16] = "";
    const word *w;
    int timely, two;
    if (length == 0 || length >= sizeof name) return 0;
    memcpy(name, text, length);
    w = find_word(def->words, name);
    if (!w) return 0;
    timely = w->value == HD_FILTER_HEAT || w->value == HD_FILTER_MEXICAN_HAT ||
             w->value == HD_FILTER_RESOLVENT;
    two = w->value == HD_FILTER_WAVE || w->value == HD_FILTER_FRACTIONAL || w->value == HD_FILTER_BAND;
    o->filter = text;
    o->filter_kind = w->value;
    if (w->value == HD_FILTER_WAVE) {            /* the logarithm of an eigenvalue has either sign */
        o->filter_a.unit = TIME_ABSOLUTE;
        if (!read_number(colon + 1, &o->filter_a.value, &end)) return 0;
    } else if (!read_time(colon + 1, &o->filter_a, &end) || !(o->filter_a.value > 0)) {
        return 0;
    }
    if (o->filter_a.unit == TIME_AUTO || (o->filter_a.unit == TIME_H2 && !timely)) return 0;
    if (!two) return *end == 0;
    return *end == ',' && read_real(end + 1, &o->filter_b) && o->filter_b > 0 &&
           (w->value != HD_FILTER_BAND || o->filter_b > o->filter_a.value);
}

static int parse_weight_cut(options *o, const option_def *def, const char *text)
{
    (void)def;
    return read_real(text, &o->weight_cut) && o->weight_cut > 0 && o->weight_cut < 1;
}

static int parse_bandwidth(options *o, const option_def *def, const char *text)
{
    const char *end;
    (void)def;
    o->has_bandwidth = 1;
    return read_time(text, &o->bandwidth, &end) && *end == 0 && o->bandwidth.unit < TIME_SPECTRAL &&
           o->bandwidth.value > 0;
}

static int parse_levels(options *o, const option_def *def, const char *text)
{
    int64_t count;
    const char *end;
    (void)def;
    if (strncmp(text, "auto:", 5) == 0) {
        if (!read_integer(text + 5, &count, &end) || *end || count < 1 || count > 1000) return 0;
        o->n_levels = (int)count;
        return 1;
    }
    o->levels = (double *)calloc(count_items(text), sizeof *o->levels);
    if (!o->levels) return -1;
    for (;; text++) {
        if (!read_number(text, &o->levels[o->n_levels++], &text)) return 0;
        if (*text != ',') return *text == 0;
    }
}

/* "17", "12:0.2,0.3", or either after a weight and *. */
static int read_point(const char *text, source_point *p, const char **end)
{
    const char *after;
    memset(p, 0, sizeof *p);
    p->weight = 1;
    if (read_number(text, &p->weight, &after) && *after == '*') text = after + 1;
    else p->weight = 1;
    if (!read_integer(text, &p->id, end) || p->id < 0) return 0;
    if (**end != ':') return 1;
    p->in_face = 1;
    return read_number(*end + 1, &p->bary[0], end) && **end == ',' && read_number(*end + 1, &p->bary[1], end) &&
           p->bary[0] >= 0 && p->bary[1] >= 0 && p->bary[0] + p->bary[1] <= 1 + 1e-9;
}

/* Points, those of one source joined by +. */
static int parse_sources(options *o, const option_def *def, const char *text)
{
    size_t most = count_items(text), i;
    (void)def;
    for (i = 0; text[i]; i++) most += text[i] == '+';
    o->source_text = text;
    o->sources = (int64_t *)calloc(most, sizeof *o->sources);
    o->points = (source_point *)calloc(most, sizeof *o->points);
    if (!o->sources || !o->points) return -1;
    for (;; text++) {
        source_point *p = &o->points[o->n_points++];
        const int joined = o->n_points > 1 && text[-1] == '+';
        if (!read_point(text, p, &text)) return 0;
        o->anywhere |= joined || p->in_face || p->weight != 1;
        if (!joined) o->sources[o->n_sources++] = p->id;
        p->source = o->n_sources - 1;
        if (*text != ',' && *text != '+') return *text == 0;
    }
}

/* ---- the table ---- */

#define AT(field) offsetof(options, field)

#define SOURCE_FORMS \
    "0, or F:A,B inside triangle F, with weights A, B and 1 - A - B of\n" \
    "its corners. + joins points to one source, with weights in front:\n" \
    "0.5*12:0.2,0.3+7"

static const option_def OPTIONS[] = {
    { "t", 0, CMD_HEAT & ~CMD_SMOOTH, 1, parse_times, 0, NULL, 0, 0, "T[,T..]",
      "times >= 0: numbers such as 0.01, multiples of h^2 such as 10h2, or auto:K for K of them",
      "diffusion times: absolute (0.01), multiples of the squared\n"
      "mean edge length (10h2), or auto:K, K times that suit the area;\n"
      "0.1/l1 is 0.1 divided by the first eigenvalue" },
    { "t", 0, CMD_SMOOTH, 1, parse_times, 0, NULL, 0, 0, "T",
      "one time >= 0: a number such as 0.01, or a multiple of h^2 such as 2h2",
      "how long coordinates diffuse: absolute (0.01), in multiples of the\n"
      "squared mean edge length (default: 1h2) or of one over the first\n"
      "eigenvalue (0.1/l1). 1h2 takes noise away, 10h2 small details" },
    { "filter", 0, CMD_HEAT & ~(CMD_TRACE | CMD_SMOOTH), 1, parse_filter, 0, FILTERS, 0, 0, "NAME:A[,B]",
      "heat:T, wave:E,SIGMA, mexican-hat:T, resolvent:T, fractional:T,S, band:LOW,HIGH or "
      "biharmonic:FLOOR",
      "instead of --t: f(lambda) of the eigenvalues instead of exp. heat:T\n"
      "exp(-T lambda); wave:E,SIGMA exp(-(E - log lambda)^2/(2 SIGMA^2)),\n"
      "whose hks is divided by its integral: the wave kernel signature;\n"
      "mexican-hat:T lambda exp(-T lambda); resolvent:T 1/(1 + T lambda);\n"
      "fractional:T,S exp(-T lambda^S); band:LOW,HIGH from LOW to HIGH;\n"
      "biharmonic:FLOOR 1/(lambda^2 + FLOOR^2). T may be 10h2 where it\n"
      "is a time. d^2 of distances is the sum of f itself" },
    { "t", 0, CMD_GEODESIC, 1, parse_times, 0, NULL, 0, 0, "T",
      "one time > 0: a number such as 0.01, or a multiple of h^2 such as 4h2",
      "how long heat flows, absolute or in h2 (default: 1h2); longer\n"
      "makes distances smoother and less exact" },
    { "source", 0, CMD_GEODESIC, 1, parse_sources, 0, NULL, 0, 0, "S[,S..]",
      "vertices such as 0,17, places in faces such as 12:0.2,0.3, or sums such as 0.5*3+7",
      "where to measure from, a column for each: vertices, counted from\n"
      SOURCE_FORMS },
    { "source", 0, CMD_KERNEL, 1, parse_sources, 0, NULL, 0, 0, "S[,S..]",
      "vertices such as 0,17, places in faces such as 12:0.2,0.3, or sums such as 0.5*3+7",
      "where the heat starts, a column for each: vertices, counted from\n"
      SOURCE_FORMS },
    { "source", 0, CMD_DISTANCE, 1, parse_sources, 0, NULL, 0, 0, "S[,S..]",
      "vertices such as 0,17, places in faces such as 12:0.2,0.3, or sums such as 0.5*3+7",
      "where to measure from, a column for each: vertices, counted from\n"
      SOURCE_FORMS },
    { "source-file", 0, CMD_ANYWHERE, 1, parse_text, AT(source_file), NULL, 0, 0, "F", "a file name",
      "one more source: its points, one on each line of F" },
    { "curve", 0, CMD_ANYWHERE, 0, parse_flag, AT(curve), NULL, 0, 0, NULL, "no value",
      "the points of each source are joined to a curve, of weight 1 for\n"
      "each unit of length; two in turn lie in one face" },
    { "source", 0, CMD_SAMPLE, 1, parse_sources, 0, NULL, 0, 0, "S[,S..]",
      "vertices such as 0,17, places in faces such as 12:0.2,0.3, or sums such as 0.5*3+7",
      "vertices to begin with (default: the first that has mass). If one\n"
      "is a place in a face or a sum, as of distance, all of them are\n"
      "what to stay away from, and no rows of the result" },
    { "count", 0, CMD_SAMPLE, 0, parse_integer, AT(count), NULL, 1, 2147483647, "K", "a number from 1",
      "how many vertices; those that --source begins with are included" },
    { "count", 'k', CMD_SPECTRUM, 0, parse_integer, AT(count), NULL, 1, 2147483647, "K", "a number from 1",
      "how many eigenpairs, the smallest" },
    { "below", 0, CMD_SPECTRUM, 0, parse_below, 0, NULL, 0, 0, "X", "a number above 0, such as 100",
      "eigenvalues below X, all of them or the first K" },
    { "input", 0, CMD_DIFFUSE, 1, parse_text, AT(input), NULL, 0, 0, "F", "a file name",
      "a field: a row per vertex, one or more columns, as text or .npy" },
    { "input", 0, CMD_RENDER, 0, parse_inputs, 0, NULL, 0, 0, "F", "a file name, up to twelve times",
      "a field: a row per vertex, one or more columns, as text or .npy.\n"
      "Given several times: pictures side by side in the same colours,\n"
      "of one mesh or of as many meshes" },
    { "input", 0, CMD_LEVELS, 1, parse_text, AT(input), NULL, 0, 0, "F", "a file name",
      "a field: a row per vertex, one or more columns, as text or .npy" },
    { "levels", 0, CMD_LEVELS, 1, parse_levels, 0, NULL, 0, 0, "X[,X..]",
      "numbers such as 0.5,1, or auto:K for K of them",
      "values of the field, or auto:K, K values spread evenly between\nthe least and the largest" },
    { "column", 0, CMD_LEVELS, 0, parse_integer, AT(column), NULL, 0, 2000000000, "K",
      "a column number from 0", "column of the field, counted from 0 (0)" },
    { "nearest", 0, CMD_FROM, 0, parse_flag, AT(nearest), NULL, 0, 0, NULL, "no value",
      "instead of a column for each source: which of them is nearest,\nand its distance" },
    { "matrix", 0, CMD_FROM, 0, parse_flag, AT(matrix), NULL, 0, 0, NULL, "no value",
      "instead: the distances among the sources, a symmetric matrix" },
    { "input", 0, CMD_PAIRS, 0, parse_text, AT(input), NULL, 0, 0, "P", "a file name",
      "pairs of vertices: two ids a line, as text or .npy" },
    { "definition", 0, CMD_METRIC, 0, parse_words, AT(definition), DEFINITIONS, 0, 0, "NAME", NULL,
      "classical (default): d^2 = k_2t(i,i) - 2 k_2t(i,j) + k_2t(j,j);\n"
      "weighted: d^2 = (e_i - e_j)' B K_2t (e_i - e_j); commute and\nbiharmonic: without --t" },
    { "laplacian", 0, CMD_LAPLACIAN, 0, parse_words, AT(laplacian), LAPLACIANS, 0, 0, "NAME", NULL,
      "fem (default of triangles), voronoi-cot, cot: other faces are\n"
      "split; polygon (default of meshes with other faces); of points:\n"
      "voronoi-exp (default) or exp, which take the vertices of a mesh\nas points" },
    { "laplacian", 0, CMD_GEODESIC, 0, parse_words, AT(laplacian), LAPLACIANS, 0, 0, "NAME",
      "fem, voronoi-cot or polygon",
      "fem (default of triangles) or voronoi-cot: other faces are split;\n"
      "polygon (default of meshes with other faces). Points have the\ntriangles of their neighbours" },
    { "intrinsic-delaunay", 0, CMD_SURFACE, 0, parse_flag, AT(intrinsic_delaunay), NULL, 0, 0, NULL,
      "no value",
      "L and B of the surface's own Delaunay triangulation: for bad\n"
      "triangles; with voronoi-cot heat is then never negative" },
    { "tufted", 0, CMD_SURFACE, 0, parse_flag, AT(tufted), NULL, 0, 0, NULL, "no value",
      "the same for any triangles, also with borders and where\n"
      "three or more faces meet; of points, with triangles made\nfrom their neighbours" },
    { "lengths", 0, CMD_SURFACE, 0, parse_text, AT(lengths), NULL, 0, 0, "F", "a file name",
      "of triangles: a row for each face of MESH with the lengths of its\n"
      "edges, from its first corner to the second, from there to the\n"
      "third, and back, as text or .npy. The coordinates of the\n"
      "vertices then serve only pictures and files" },
    { "border", 0, CMD_SMOOTH, 0, parse_words, AT(border), BORDERS, 0, 0, "NAME", NULL,
      "of meshes: natural (default): borders move as all else does, and\n"
      "holes widen; dirichlet: the vertices of borders stay where they are" },
    { "border", 0, CMD_LAPLACIAN & ~CMD_SMOOTH, 0, parse_words, AT(border), BORDERS, 0, 0, "NAME", NULL,
      "of meshes: natural (default): no heat leaves through a border;\n"
      "dirichlet: the vertices of borders are held at zero" },
    { "border", 0, CMD_GEODESIC, 0, parse_words, AT(border), GEODESIC_BORDERS, 0, 0, "NAME", NULL,
      "while heat flows: natural (default), held at zero (dirichlet), or\n"
      "the mean of both, with which a longer --t such as 8h2 is best" },
    { "lambda", 0, CMD_GEODESIC, 0, parse_lambda, 0, NULL, 0, 0, "X", "a number above 0, such as 1",
      "of polygon: weight of its stabilising part (1/6)" },
    { "lambda", 0, CMD_LAPLACIAN, 0, parse_lambda, 0, NULL, 0, 0, "X", "a number above 0, such as 1",
      "of polygon: weight of its stabilising part (1)" },
    { "bandwidth", 0, CMD_LAPLACIAN, 0, parse_bandwidth, 0, NULL, 0, 0, "S",
      "a positive number such as 0.001, or a multiple of h^2 such as 2h2",
      "of points: time parameter of the exponential weights, absolute\n"
      "or in multiples of the squared mean distance of nearest\n"
      "neighbours (2h2); default: from the sampling" },
    { "weight-cut", 0, CMD_LAPLACIAN, 0, parse_weight_cut, 0, NULL, 0, 0, "W",
      "a number between 0 and 1, such as 1e-4",
      "of points: exponentials below W are left out (1e-8); 1e-4 has\nhalf as many non-zeros" },
    { "kernel", 0, CMD_KERNEL | CMD_PAIRS, 0, parse_words, AT(kernel), KERNELS, 0, 0, "NAME", NULL,
      "operator: K_t (default); symmetric: k_t = K_t B^-1" },
    { "kernel", 0, CMD_HKS, 0, parse_words, AT(kernel), KERNELS, 0, 0, "NAME", NULL,
      "symmetric: k_t(x,x) (default); operator: the diagonal of K_t" },
    { "normalise", 0, CMD_HKS, 0, parse_flag, AT(normalise), NULL, 0, 0, NULL, "no value",
      "divides by the heat trace at each time: the integral is 1" },
    { "scale-invariant", 0, CMD_HKS, 0, parse_integer, AT(frequencies), NULL, 1, 1000, "K", "1..1000",
      "the first K frequencies of the signature over log t, which\n"
      "change little if the surface is scaled; --t takes the first and\n"
      "the last time, 16 an octave are taken between them" },
    { "degree", 0, CMD_HEAT, 0, parse_integer, AT(degree), NULL, 1, 14, "R", "1..14",
      "degree of the rational approximation, 1..14 (default: by the\n"
      "error); not for krylov and local" },
    { "poles", 0, CMD_HEAT, 0, parse_words, AT(poles), POLES, 0, 0, "NAME", NULL,
      "uniform (default of diffuse, smooth) or kernel (of all others)" },
    { "tol", 0, CMD_SPECTRUM, 0, parse_tol, 0, NULL, 0, 0, "E", "a number between 0 and 1, such as 1e-10",
      "residuals relative to eigenvalues (1e-10)" },
    { "tol", 0, CMD_HEAT, 0, parse_tol, 0, NULL, 0, 0, "E", "a number between 0 and 1, such as 1e-9",
      "relative error that iterative methods aim at (1e-9)" },
    { "method", 0, CMD_INVERTS, 0, parse_words, AT(method), METHODS, 0, 0, "NAME", NULL,
      "direct: factors of the whole mesh; local: of patches, as small\n"
      "as --memory-limit asks for; auto (default): what costs less, or\n"
      "fits" },
    { "method", 0, CMD_ANYHOW, 0, parse_words, AT(method), METHODS, 0, 0, "NAME", NULL,
      "direct: factors of all poles, for many sources or fields;\n"
      "krylov: one factor for one source and for many times;\n"
      "iterative: no factor; local: only the part that heat reaches;\n"
      "auto (default): what costs least" },
    { "ordering", 0, CMD_GEODESIC, 0, parse_words, AT(ordering), ORDERINGS, 0, 0, "NAME", NULL,
      "amd (minimum degree), dissection (nested, in space) or auto\n(default: by the size)" },
    { "ordering", 0, CMD_SPECTRUM, 0, parse_words, AT(ordering), ORDERINGS, 0, 0, "NAME", NULL,
      "amd (minimum degree), dissection (nested, in space) or auto\n(default: by the size)" },
    { "ordering", 0, CMD_HEAT, 0, parse_words, AT(ordering), ORDERINGS, 0, 0, "NAME", NULL,
      "of all but iterative: amd (minimum degree), dissection\n"
      "(nested, in space) or auto (default: by the size)" },
    { "solver", 0, CMD_ANYHOW, 0, parse_words, AT(solver), SOLVERS, 0, 0, "NAME", NULL,
      "of iterative: @ (default: by the time)" },
    { "precond", 0, CMD_ANYHOW, 0, parse_words, AT(precond), PRECONDS, 0, 0, "NAME", NULL,
      "of iterative: @ (default: mildl)" },
    { "max-iterations", 0, CMD_ANYHOW, 0, parse_integer, AT(max_iterations), NULL, 1, 2000000000, "N",
      "a number from 1", "of iterative: limit of the iterations per system" },
    { "threads", 0, CMD_INFO | CMD_SOLVES | CMD_DEMO, 0, parse_integer, AT(threads), NULL, 1, 1024, "N",
      "1..1024", "worker threads (default: all)" },
    { "simd", 0, CMD_SOLVES | CMD_DEMO, 0, parse_words, AT(simd), SIMDS, 0, 0, "NAME", NULL,
      "instruction set: none (plain C), avx2, avx512, as far as the\n"
      "processor has them, or auto (default: its best)" },
    { "memory-limit", 0, CMD_INFO | CMD_SOLVES | CMD_DEMO, 0, parse_bytes, 0, NULL, 0, 0, "BYTES",
      "bytes, also with K, M or G, such as 500M",
      "most memory for the computation, also with K, M or G\n(default: nine tenths of the machine's)" },
    { "dry-run", 0, CMD_SOLVES, 0, parse_flag, AT(dry_run), NULL, 0, 0, NULL, "no value",
      "only say what the run would take: method, work, memory, time,\n"
      "on standard output. Nothing is computed, and no file is written" },
    { "output", 'o', CMD_TABLES, 0, parse_text, AT(output), NULL, 0, 0, "FILE", "a file name",
      "where the result goes: .txt .csv or .npy; - or nothing:\nstandard output, as text" },
    { "output", 'o', CMD_FIELDS, 0, parse_text, AT(output), NULL, 0, 0, "FILE", "a file name",
      "where the result goes: .txt .csv .npy .ply .obj .vtu or .png;\n"
      "- or nothing: standard output, as text. In .ply the columns are\n"
      "quality, quality_1, ..; .obj has only the colours" },
    { "output", 'o', CMD_LEVELS, 0, parse_text, AT(output), NULL, 0, 0, "FILE", "a file name",
      "where the lines go: .obj, or .txt, .csv or .npy as a table;\n- or nothing: standard output, as text" },
    { "output", 'o', CMD_SMOOTH, 0, parse_text, AT(output), NULL, 0, 0, "FILE", "a file name",
      "where the mesh goes: .obj .off .ply .stl .vtu, or .xyz for points;\n"
      "- or nothing: standard output, in the format that was read" },
    { "no-header", 0, (CMD_SOLVES & ~CMD_SMOOTH) | CMD_LEVELS, 0, parse_flag, AT(no_header), NULL, 0, 0, NULL,
      "no value", "of .csv: no first line with the names of the columns" },
    { "output", 'o', CMD_RENDER, 0, parse_text, AT(output), NULL, 0, 0, "FILE", "the file name of a .png",
      "the .png, or - for standard output" },
    { "output", 'o', CMD_DEMO, 0, parse_text, AT(output), NULL, 0, 0, "FOLDER", "the name of a folder",
      "where the files go (heatdiff-demo)" },
    { "json", 0, CMD_ALL, 0, parse_flag, AT(json), NULL, 0, 0, NULL, "no value",
      "the report as one JSON object" },
    { "verbose", 0, CMD_SOLVES | CMD_LEVELS, 0, parse_flag, AT(verbose), NULL, 0, 0, NULL, "no value",
      "the report in full instead of two lines" },
    { "quiet", 0, CMD_ALL, 0, parse_flag, AT(quiet), NULL, 0, 0, NULL, "no value",
      "no report, no progress bar" },
    { "column", 0, CMD_PICTURE, 0, parse_integer, AT(column), NULL, 0, 2000000000, "K",
      "a column number from 0", "column that colours .png, .ply and .obj, counted from 0" },
    { "log", 0, CMD_PICTURE, 0, parse_flag, AT(log_scale), NULL, 0, 0, NULL, "no value",
      "colours by the logarithm" },
    { "isolines", 0, CMD_PICTURE, 0, parse_isolines, AT(isolines), NULL, 0, 200, "N", "0..200",
      "number of isolines, 0 for none (default: at round values)" },
    { "range", 0, CMD_PICTURE, 0, parse_range, 0, NULL, 0, 0, "LO,HI", "two numbers LO,HI with LO below HI",
      "values of the first and last colour (default: of the field)" },
    { "view", 0, CMD_PICTURE, 0, parse_view, 0, NULL, 0, 0, "AZ,EL",
      "degrees AZ,EL, elevation within -90..90",
      "direction of view in degrees: 0,0 looks at the front, 90,0 at\n"
      "the right side (default: one that shows the warmest place)" },
    { "up", 0, CMD_PICTURE, 0, parse_words, AT(up), AXES, 0, 0, "AXIS", NULL,
      "the axis that points up in pictures: x, y (default) or z" },
    { "labels", 0, CMD_RENDER, 0, parse_flag, AT(labels), NULL, 0, 0, NULL, "no value",
      "fields of whole numbers from 0, as --nearest of distance writes:\n"
      "a colour for each, without isolines; -1 is none" },
    { "colormap", 0, CMD_PICTURE | CMD_DEMO, 0, parse_words, AT(colormap), COLORMAPS, 0, 0, "NAME", NULL,
      "@ (default: ember)" },
    { "size", 0, CMD_PICTURE, 0, parse_size, 0, NULL, 64, 8192, "WxH", "WxH in pixels, each 64..8192",
      "size of the picture in pixels" },
    { "title", 0, CMD_PICTURE, 0, parse_text, AT(title), NULL, 0, 0, "TEXT", "a text",
      "title of the picture" },
    { "help", 'h', CMD_ALL, 0, parse_flag, AT(help), NULL, 0, 0, NULL, "no value", "this help" },
    { "version", 0, CMD_ALL, 0, parse_flag, AT(version), NULL, 0, 0, NULL, "no value", "the version" },
};
enum { N_OPTIONS = sizeof OPTIONS / sizeof OPTIONS[0] };

/* ---- commands ---- */

typedef struct command_def {
    const char *name;
    unsigned bit;
    const char *help, *usage;
    const char *output;              /* the columns of the output, lines of the help */
} command_def;

#define VERTEX_ROWS "A row for each vertex, in the order of the file, vertices in no face included.\n"
#define SOURCE_COLUMNS "A column for each source and time, sources outermost: --source 3,8 --t 1,2 gives\n" \
                       "v3_1, v3_2, v8_1, v8_2, as .csv and .vtu name them (s0_1 and so on where sources are\n" \
                       "more than vertices). Row i of vV_T is "

static const command_def COMMANDS[] = {
    { "info", CMD_INFO, "counts, area, edge length and defects of a mesh", "[OPTIONS] MESH",
      "A report on standard output: a name and a value on each line, or with --json one object." },
    { "kernel", CMD_KERNEL, "columns of the heat kernel: heat from single vertices",
      "--source S[,S..] --t T[,T..] [OPTIONS] MESH",
      VERTEX_ROWS SOURCE_COLUMNS "K_T(i,V), the\n"
      "heat at vertex i after the time T from 1 at vertex V (--kernel symmetric: k_T(i,V))." },
    { "diffuse", CMD_DIFFUSE, "diffuses your own fields", "--input F --t T[,T..] [OPTIONS] MESH",
      VERTEX_ROWS "A column for each field (column of F) and time, fields outermost: two fields with\n"
      "--t 1,2 give f0_1, f0_2, f1_1, f1_2, as .csv and .vtu name them. Row i of fC_T is K_T f at\n"
      "vertex i, f column C of F, counted from 0." },
    { "smooth", CMD_SMOOTH, "smooths the shape: moves its vertices", "[--t T] [OPTIONS] MESH",
      "The mesh with the same vertices and faces, in the same order, each coordinate x replaced by\n"
      "K_T x. Vertices in no face stay. Nothing else of the file is kept. The report says how far\n"
      "vertices moved, and bounds the error of their coordinates." },
    { "geodesic", CMD_GEODESIC, "distances along the surface, by the heat method",
      "--source S[,S..] [--t T] [OPTIONS] MESH",
      VERTEX_ROWS "A column for each source, in the order of --source: v3_1h2, v8_1h2, as .csv and .vtu\n"
      "name them. Row i of vV_T is the distance of vertex i from vertex V, inf where there is no\nway." },
    { "distance", CMD_DISTANCE, "diffusion distances from single vertices to all",
      "--source S[,S..] --t T[,T..] [OPTIONS] MESH",
      VERTEX_ROWS SOURCE_COLUMNS "the\ndistance of vertex i from vertex V at the time T." },
    { "pairs", CMD_PAIRS, "kernel and diffusion distance of pairs of vertices",
      "--input P --t T[,T..] [OPTIONS] MESH",
      "A row for each pair, in the order of P: i, j, then for each time the kernel K_T(i,j) (--kernel\n"
      "symmetric: k_T(i,j)) and the distance. --t 1,2 gives i, j, K_1, d_1, K_2, d_2, as .csv names\n"
      "them. Without times (commute, biharmonic): i, j and the distance." },
    { "hks", CMD_HKS, "heat kernel signature of every vertex", "--t T[,T..] [OPTIONS] MESH",
      VERTEX_ROWS "A column for each time, in the order of --t: hks_1, hks_2, as .csv and .vtu name them.\n"
      "Row i of hks_T is k_T(i,i) (--kernel operator: K_T(i,i)). --scale-invariant K gives K columns\n"
      "instead, si_0, si_1: moduli of the Fourier transform of the steps of log k_T(i,i)." },
    { "trace", CMD_TRACE, "the heat trace at many times", "--t T[,T..] [OPTIONS] MESH",
      "A row for each time, in the order of --t: t, the trace of K_t (the sum of exp(-t lambda) over\n"
      "all eigenvalues), and a bound on its error." },
    { "sample", CMD_SAMPLE, "farthest points under the diffusion distance", "--count K --t T [OPTIONS] MESH",
      "A row for each point, in the order in which they were chosen: vertex, its id counted from 0,\n"
      "and distance, to the nearest of those before it (0 in the first row, unless places in faces\n"
      "or sums stand before it)." },
    { "spectrum", CMD_SPECTRUM, "the smallest eigenvalues and eigenvectors", "-k K [--below X] [OPTIONS] MESH",
      VERTEX_ROWS "A column for each eigenvector, by ascending eigenvalues, B-orthonormal: x_0, x_1, as .csv\n"
      "and .vtu name them. In text the eigenvalues stand in a first line after #; elsewhere they are\n"
      "in the report of --json." },
    { "levels", CMD_LEVELS, "level sets of a field, as lines", "--input F --levels X[,X..] [OPTIONS] MESH",
      "A row for each point of a line: line, its number from 0, closed (1: the first point follows the\n"
      "last), level, x, y, z. In .obj each line is an element l; closed ones end where they begin, and\n"
      "the lines of a level are a group." },
    { "render", CMD_RENDER, "a picture of a field on the mesh",
      "--input F [--input F..] -o PICTURE.png [OPTIONS] MESH [MESH..]",
      "A PNG picture, without numbers." },
    { "demo", CMD_DEMO, "all of it on a shape made in memory: start here", "[-o FOLDER] [OPTIONS]",
      "Pictures and meshes in the folder, and a text on standard output that tells\n"
      "what each file is." },
};
enum { N_COMMANDS = sizeof COMMANDS / sizeof COMMANDS[0] };

static const command_def *find_command(const char *name)
{
    int i;
    for (i = 0; i < N_COMMANDS; i++)
        if (strcmp(COMMANDS[i].name, name) == 0) return &COMMANDS[i];
    return NULL;
}

static const char *command_name(unsigned bit)
{
    int i;
    for (i = 0; i < N_COMMANDS; i++)
        if (COMMANDS[i].bit == bit) return COMMANDS[i].name;
    return "";
}

/* "kernel, diffuse, render": the commands in mask. */
static void list_commands(unsigned mask, char *text, size_t size)
{
    int i;
    text[0] = 0;
    for (i = 0; i < N_COMMANDS; i++)
        if (COMMANDS[i].bit & mask)
            snprintf(text + strlen(text), size - strlen(text), "%s%s", text[0] ? ", " : "", COMMANDS[i].name);
}

/* ---- misspelled names ---- */

enum { NAME_LETTERS = 24 };          /* no name of a command or an option is longer */

static int least_of(int a, int b) { return a < b ? a : b; }

/* How many slips of the hand lead from one name to another: a letter too many, too few or wrong, or two
 * exchanged (F. J. Damerau, 1964). n: letters of the first. */
static int count_slips(const char *name, size_t n, const char *other)
{
    int d[NAME_LETTERS + 1][NAME_LETTERS + 1];
    const size_t m = strlen(other);
    size_t i, k;
    if (n > NAME_LETTERS || m > NAME_LETTERS) return NAME_LETTERS;
    for (i = 0; i <= n; i++)
        for (k = 0; k <= m; k++) {
            d[i][k] = (int)(i + k);
            if (!i || !k) continue;
            d[i][k] = least_of(d[i - 1][k], d[i][k - 1]) + 1;
            d[i][k] = least_of(d[i][k], d[i - 1][k - 1] + (name[i - 1] != other[k - 1]));
            if (i > 1 && k > 1 && name[i - 1] == other[k - 2] && name[i - 2] == other[k - 1])
                d[i][k] = least_of(d[i][k], d[i - 2][k - 2] + 1);
        }
    return d[n][m];
}

/* Takes a name that is nearer to the one written than the best so far. A beginning is one slip away. */
static void suggest(const char *name, size_t n, const char *other, int *slips, const char **best)
{
    int here = count_slips(name, n, other);
    if (n > 2 && strncmp(name, other, n) == 0) here = least_of(here, 1);
    if (here >= *slips) return;
    *slips = here;
    *best = other;
}

/* Slips from which on nothing is meant. */
static int most_slips(size_t n) { return n > 6 ? 4 : n > 4 ? 3 : n > 1 ? 2 : 1; }

/* ---- reading the command line ---- */

/* The definition of an option argument, and where its value begins behind '=' (NULL: there is none). The
 * definition for the current command takes precedence over those for others. */
static const option_def *find_option(const char *arg, unsigned command, const char **value)
{
    const option_def *other = NULL;
    const int is_long = arg[1] == '-';
    const char *name = arg + 1 + is_long, *equals = strchr(name, '=');
    const size_t length = equals ? (size_t)(equals - name) : strlen(name);
    int i;
    *value = equals ? equals + 1 : NULL;
    for (i = 0; i < N_OPTIONS; i++) {
        const option_def *def = &OPTIONS[i];
        const int same_name = strlen(def->name) == length && strncmp(def->name, name, length) == 0;
        const int same = is_long ? same_name : length == 1 && def->letter == *name;
        if (same && (def->commands & command)) return def;
        if (same) other = def;
    }
    return other;
}

/* The option of this command that is meant by a name that is none, or NULL. */
static const char *meant_option(const char *arg, unsigned command)
{
    const char *name = arg + strspn(arg, "-"), *best = NULL;
    const size_t n = strcspn(name, "=");
    int i, slips = most_slips(n);
    for (i = 0; i < N_OPTIONS; i++)
        if (OPTIONS[i].commands & command) suggest(name, n, OPTIONS[i].name, &slips, &best);
    return best;
}

/* The option as users write it. */
static const char *option_text(const option_def *def, char *text, size_t size)
{
    if (def->letter) snprintf(text, size, "-%c", def->letter);
    else snprintf(text, size, "--%s", def->name);
    return text;
}

static int take_option(options *o, char *seen, int argc, char **argv, int *i)
{
    const char *value, *takes, *arg = argv[*i];
    const option_def *def = find_option(arg, o->command, &value);
    char name[32], commands[160], words[WORDS_TEXT];
    int parsed;
    if (!def && (value = meant_option(arg, o->command)) != NULL)
        return fail(USAGE, "%.80s is not an option; did you mean --%s? See heatdiff %s --help", arg, value,
                    command_name(o->command));
    if (!def)
        return fail(USAGE, "%.80s is not an option; see heatdiff %s --help", arg, command_name(o->command));
    option_text(def, name, sizeof name);
    if (!(def->commands & o->command)) {
        list_commands(def->commands, commands, sizeof commands);
        return fail(USAGE, "%s is not an option of %s (but of %s)", name, command_name(o->command), commands);
    }
    if (!def->value && value) return fail(USAGE, "%s takes no value, but '%.80s' is given", name, value);
    takes = def->takes ? def->takes : list_words(def->words, words);
    if (def->value && !value && ++*i >= argc)
        return fail(USAGE, "%s takes %s, but nothing follows it", name, takes);
    if (def->value && !value) value = argv[*i];
    if (def->is_list && seen[def - OPTIONS])
        return fail(USAGE, "%s is given twice; it takes %s", name, takes);
    seen[def - OPTIONS] = 1;
    parsed = def->parse(o, def, value);
    if (parsed < 0) return fail_memory("the command line");
    return parsed ? DONE : fail(USAGE, "%s takes %s, not '%.80s'", name, takes, value);
}

static int take_mesh(options *o, const char *arg)
{
    if (o->command == CMD_DEMO)
        return fail(USAGE, "demo makes its own mesh and takes none, but '%.200s' is given", arg);
    if (!*arg) return fail(USAGE, "the mesh takes a file name or - (standard input), not ''");
    if (o->mesh && o->command != CMD_RENDER)
        return fail(USAGE, "one mesh at a time: '%.200s' and then '%.200s'", o->mesh, arg);
    if (o->n_meshes == MAX_PANELS)
        return fail(USAGE, "render takes at most %d meshes, but '%.200s' is one more", MAX_PANELS, arg);
    if (!o->mesh) o->mesh = arg;
    o->meshes[o->n_meshes++] = arg;
    return DONE;
}

static int check_output(const options *o)
{
    if (o->command == CMD_RENDER) {
        if (!o->output)
            return fail(USAGE,
                        "render needs -o, which takes the file name of a .png (or - for standard output)");
        if (strcmp(o->output, "-") == 0 || output_format(o->output) == FORMAT_PNG) return DONE;
        return fail(USAGE, "-o takes a name that ends in .png here, not '%.200s'", o->output);
    }
    if (o->command == CMD_DEMO || !o->output) return DONE;
    if ((o->command & (CMD_TABLES | CMD_LEVELS)) || o->matrix) {
        const int kind = output_format(o->output), lines = o->command == CMD_LEVELS;
        if (kind == MIO_TXT || kind == MIO_CSV || kind == MIO_NPY || (lines && kind == MIO_OBJ)) return DONE;
        return fail(USAGE, "-o takes a name that ends in %s.txt, .csv or .npy here, not '%.200s'",
                    lines ? ".obj, " : "", o->output);
    }
    if (o->command == CMD_SMOOTH)
        return strcmp(o->output, "-") == 0 || mio_mesh_format_of(o->output) != MIO_UNKNOWN ? DONE
               : fail(USAGE, "-o takes a name that ends in .obj, .off, .ply, .stl, .vtu or .xyz here, not "
                      "'%.200s'", o->output);
    if (output_format(o->output) != MIO_UNKNOWN) return DONE;
    return fail(USAGE,
                "-o takes a name that ends in .txt, .csv, .npy, .ply, .obj, .vtu or .png, not '%.200s'",
                o->output);
}

/* Which options belong to which method. */
static int check_method(const options *o)
{
    const char *name = word_of(METHODS, o->method), *iterating = o->solver ? "--solver" : "--precond";
    const int inverts = (o->command & CMD_INVERTS) != 0;
    const int no_poles = o->method == HD_METHOD_KRYLOV || o->method == HD_METHOD_LOCAL;
    if (inverts && (o->method == HD_METHOD_ITERATIVE || o->method == HD_METHOD_KRYLOV))
        return fail(USAGE, "--method takes auto, direct or local here, not %s: %s is read off factors", name,
                    command_name(o->command));
    if (no_poles && (o->degree || o->poles))
        return fail(USAGE, "%s takes no --method %s, which has no use for it",
                    o->degree ? "--degree" : "--poles", name);
    if (o->filter && o->method == HD_METHOD_KRYLOV)
        return fail(USAGE, "--filter takes no --method %s: its poles are made for it, and it needs them", name);
    if (o->filter && (o->degree || o->poles || o->solver == HD_SOLVER_LANCZOS))
        return fail(USAGE, "--filter takes no %s: its poles are made for it, and it needs them",
                    o->degree ? "--degree" : o->poles ? "--poles" : "--solver lanczos");
    if (o->filter && o->command == CMD_PAIRS &&
        (o->method == HD_METHOD_ITERATIVE || o->solver || o->precond))
        return fail(USAGE, "--method takes auto, direct or local here: distances of a filter are read off "
                    "the factors");
    if ((no_poles || o->method == HD_METHOD_DIRECT) && (o->solver || o->precond))
        return fail(USAGE, "%s takes --method iterative or auto: %s does not iterate over systems", iterating,
                    name);
    if (o->ordering && o->method == HD_METHOD_ITERATIVE)
        return fail(USAGE, "--ordering takes no --method iterative: that factorises nothing");
    if (o->ordering && (o->solver || o->precond))
        return fail(USAGE,
                    "--ordering takes no %s beside it: that asks for iterations, which factorise nothing",
                    iterating);
    return DONE;
}

/* The place of the definition asked for in both tables. */
static int definition_row(const options *o)
{
    int q = 0;
    while (DEFINITIONS[q].value != o->definition) q++;
    return q;
}

static int is_timeless(const options *o) { return OF_DEFINITION[definition_row(o)].timeless; }

/* The definitions with a time, or without. */
static const char *list_definitions(int timeless, char *text)
{
    word words[sizeof DEFINITIONS / sizeof *DEFINITIONS];
    int q, n = 0;
    for (q = 0; DEFINITIONS[q].name; q++)
        if (OF_DEFINITION[q].timeless == timeless) words[n++] = DEFINITIONS[q];
    words[n] = DEFINITIONS[q];
    return list_words(words, text);
}

static int check_times(const options *o)
{
    const char *name = command_name(o->command);
    char words[WORDS_TEXT];
    int i;
    if (o->filter && (o->times || is_timeless(o)))
        return fail(USAGE, "--filter takes no %s%s beside it: the filter says it all",
                    o->times ? "--t" : "--definition ", o->times ? "" : list_definitions(1, words));
    if (o->filter) return DONE;
    if (is_timeless(o)) {
        if (o->times)
            return fail(USAGE, "--t takes --definition %s: %s has no time", list_definitions(0, words),
                        word_of(DEFINITIONS, o->definition));
        return DONE;
    }
    if (o->command == CMD_SMOOTH)
        return o->n_times > 1 || (o->times && o->times[0].unit == TIME_AUTO && o->times[0].value > 1)
               ? fail(USAGE, "--t takes one time for smooth, such as 2h2") : DONE;
    if ((o->command & CMD_HEAT) && !o->times)
        return fail(USAGE, "%s needs --t, which takes times such as 0.01,10h2 or auto:4", name);
    for (i = 0; i < o->n_times && (o->command & (CMD_HKS | CMD_METRIC | CMD_TRACE)); i++)
        if (o->times[i].value == 0) return fail(USAGE, "--t takes times > 0 for %s", name);
    if (o->command == CMD_SAMPLE && (o->n_times > 1 ||
                                     (o->times[0].unit == TIME_AUTO && o->times[0].value > 1)))
        return fail(USAGE, "--t takes a single time for sample");
    return DONE;
}

/* Distances other than diffusion distances have poles of their own, and need the direct method. */
static int check_definition(const options *o)
{
    const char *name = word_of(DEFINITIONS, o->definition);
    char words[WORDS_TEXT];
    if (!is_timeless(o)) return DONE;
    list_definitions(0, words);
    if (o->degree || o->poles)
        return fail(USAGE, "%s takes --definition %s: %s has poles of its own",
                    o->degree ? "--degree" : "--poles", words, name);
    if (o->method != HD_METHOD_AUTO && o->method != HD_METHOD_DIRECT)
        return fail(USAGE, "--method takes auto or direct here, not %s: %s is read off the factors",
                    word_of(METHODS, o->method), name);
    if (o->solver || o->precond)
        return fail(USAGE, "%s takes --definition %s: %s does not iterate",
                    o->solver ? "--solver" : "--precond", words, name);
    return DONE;
}

static int check_sample(const options *o)
{
    if (!o->count) return fail(USAGE, "sample needs --count, which takes a number from 1");
    if (o->n_sources > o->count && !o->anywhere && !o->curve && !o->source_file)
        return fail(USAGE, "--source takes at most --count vertices, which is %ld, not %d", o->count,
                    o->n_sources);
    return DONE;
}

/* Forms of the signature. */
static int check_signature(const options *o)
{
    const char *form = o->normalise ? "--normalise" : "--scale-invariant";
    if (!o->normalise && !o->frequencies) return DONE;
    if (o->filter) return fail(USAGE, "%s takes no --filter beside it", form);
    if (o->normalise && o->frequencies)
        return fail(USAGE, "--normalise takes no --scale-invariant beside it: factors of scale cancel there");
    if (o->kernel == HD_KERNEL_OPERATOR)
        return fail(USAGE, "%s takes --kernel symmetric", form);
    if (o->frequencies && (o->n_times != 2 || o->times[0].unit == TIME_AUTO || o->times[1].unit == TIME_AUTO))
        return fail(USAGE,
                    "--t takes the first and the last time with --scale-invariant, such as 1h2,10000h2");
    return DONE;
}

/* Exactly one time, and not zero. */
static int check_geodesic(const options *o)
{
    if (!o->sources && !o->source_file)
        return fail(USAGE, "geodesic needs --source, which takes vertex ids from 0, such as 0,17");
    if (o->laplacian == HD_LAPLACIAN_VORONOI_EXP || o->laplacian == HD_LAPLACIAN_EXP)
        return fail(USAGE, "--laplacian takes fem, voronoi-cot or polygon here: %s has no gradient; without "
                    "it points get triangles, as with --tufted", word_of(LAPLACIANS, o->laplacian));
    if (o->laplacian == HD_LAPLACIAN_COT)
        return fail(USAGE,
                    "--laplacian takes fem, voronoi-cot or polygon here: with cot t is no squared length");
    if (o->times && (o->n_times != 1 || !(o->times[0].value > 0) ||
                     (o->times[0].unit == TIME_AUTO && o->times[0].value > 1)))
        return fail(USAGE, "--t takes one time above 0 here, such as 4h2");
    return DONE;
}

/* The checks below look at all options together: what is missing, and what excludes each other. */

/* Triangulations go with the Laplacians of triangles. */
static int check_intrinsic(const options *o)
{
    const char *name = o->tufted ? "tufted" : "intrinsic-delaunay";
    if (!o->tufted && !o->intrinsic_delaunay) return DONE;
    if (o->laplacian == HD_LAPLACIAN_POLYGON || o->laplacian == HD_LAPLACIAN_VORONOI_EXP ||
        o->laplacian == HD_LAPLACIAN_EXP)
        return fail(USAGE, "--%s takes --laplacian fem, voronoi-cot or cot: %s has no triangles", name,
                    word_of(LAPLACIANS, o->laplacian));
    if (o->lambda > 0) return fail(USAGE, "--%s is for triangles, --lambda for polygons", name);
    if (o->has_bandwidth || o->weight_cut > 0)
        return fail(USAGE, "--%s is for triangles, --%s for exponential weights", name,
                    o->has_bandwidth ? "bandwidth" : "weight-cut");
    return DONE;
}

/* Lengths of edges make triangles, and tell no place in space. */
static int check_lengths(const options *o)
{
    if (!o->lengths) return DONE;
    if (o->laplacian == HD_LAPLACIAN_POLYGON || o->laplacian == HD_LAPLACIAN_VORONOI_EXP ||
        o->laplacian == HD_LAPLACIAN_EXP)
        return fail(USAGE, "--lengths takes --laplacian fem, voronoi-cot or cot: %s needs coordinates",
                    word_of(LAPLACIANS, o->laplacian));
    if (o->lambda > 0 || o->has_bandwidth || o->weight_cut > 0)
        return fail(USAGE, "--lengths is for triangles, --%s for %s",
                    o->lambda > 0 ? "lambda" : o->has_bandwidth ? "bandwidth" : "weight-cut",
                    o->lambda > 0 ? "polygons" : "exponential weights");
    if (o->ordering == HD_ORDERING_NESTED_DISSECTION)
        return fail(USAGE, "--ordering takes auto or amd with --lengths: dissection cuts in space");
    if (o->curve && o->command != CMD_GEODESIC)
        return fail(USAGE, "--curve takes no --lengths beside it: its own length is measured in space");
    return DONE;
}

/* Does the column that is shown hold labels? Of --nearest every other one does. */
static int shows_labels(const options *o) { return o->labels || (o->nearest && o->column % 2 == 0); }

/* Labels have a colour each. */
static int check_labels(const options *o)
{
    const char *name = o->log_scale ? "log" : o->has_range ? "range" : o->colormap ? "colormap"
                       : o->isolines > 0 ? "isolines" : NULL;
    if (!name || !shows_labels(o)) return DONE;
    if (o->labels) return fail(USAGE, "--%s takes no --labels beside it: labels have a colour each", name);
    return fail(USAGE, "--%s takes --column %ld beside --nearest, which has distances: column %ld has the "
                "numbers of sources", name, o->column + 1, o->column);
}

static int is_stream(const char *name) { return name && strcmp(name, "-") == 0; }

/* Standard input can be read only once. */
static int check_streams(const options *o)
{
    int i, streams = is_stream(o->lengths) + is_stream(o->source_file);
    if (!o->n_inputs) streams += is_stream(o->input);
    for (i = 0; i < o->n_inputs; i++) streams += is_stream(o->inputs[i]);
    for (i = 0; i < o->n_meshes; i++) streams += is_stream(o->meshes[i]);
    if (streams < 2) return DONE;
    return fail(USAGE, "%s takes a file name here: standard input can be read only once",
                is_stream(o->lengths) ? "--lengths" : is_stream(o->source_file) ? "--source-file" : "--input");
}

static int check_options(const options *o)
{
    const char *name = command_name(o->command);
    int code;
    if (!o->mesh && o->command != CMD_DEMO)
        return fail(USAGE, "%s needs a mesh: a file name or - (standard input)", name);
    if ((o->command & (CMD_KERNEL | CMD_DISTANCE)) && !o->sources && !o->source_file)
        return fail(USAGE, "%s needs --source, which takes vertex ids from 0, such as 0,17", name);
    if (o->verbose && o->quiet) return fail(USAGE, "--verbose takes no --quiet beside it");
    if (o->nearest && o->matrix)
        return fail(USAGE, "--nearest takes no --matrix beside it: one table at a time");
    if (o->matrix && (o->anywhere || o->curve || o->source_file))
        return fail(USAGE, "--matrix takes vertices as sources");
    if ((o->command & (CMD_DIFFUSE | CMD_RENDER | CMD_PAIRS | CMD_LEVELS)) && !o->input)
        return fail(USAGE, "%s needs --input, which takes the file of %s", name,
                    o->command == CMD_PAIRS ? "vertex pairs" : "a field");
    if (o->command == CMD_SPECTRUM && !o->count && !(o->below > 0))
        return fail(USAGE, "spectrum needs -k, which takes a number from 1, or --below");
    if (o->command == CMD_LEVELS && !o->n_levels)
        return fail(USAGE, "levels needs --levels, which takes numbers such as 0.5,1, or auto:K");
    if (o->command == CMD_SAMPLE && (code = check_sample(o)) != DONE) return code;
    if (o->command == CMD_GEODESIC && (code = check_geodesic(o)) != DONE) return code;
    if (o->lambda > 0 && o->laplacian != HD_LAPLACIAN_DEFAULT && o->laplacian != HD_LAPLACIAN_POLYGON)
        return fail(USAGE, "--lambda takes --laplacian polygon: %s has no such part",
                    word_of(LAPLACIANS, o->laplacian));
    if ((code = check_intrinsic(o)) != DONE) return code;
    if ((code = check_times(o)) != DONE || (code = check_definition(o)) != DONE ||
        (code = check_signature(o)) != DONE || (code = check_method(o)) != DONE)
        return code;
    if (o->degree == 1 && o->poles != HD_POLES_UNIFORM &&
        (o->poles || !(o->command & (CMD_DIFFUSE | CMD_SMOOTH))))
        return fail(USAGE,
                    "--degree takes 2..14 with --poles kernel, and 1..14 with --poles uniform");
    if (o->n_meshes > 1 && o->n_meshes != o->n_inputs)
        return fail(USAGE, "--input takes a field for each mesh here: %d are given for %d meshes",
                    o->n_inputs, o->n_meshes);
    if ((code = check_lengths(o)) != DONE || (code = check_labels(o)) != DONE ||
        (code = check_streams(o)) != DONE)
        return code;
    return check_output(o);
}

static int read_options(options *o, int argc, char **argv)
{
    int i, code, only_operands = 0;
    char seen[N_OPTIONS] = { 0 };
    for (i = 2; i < argc; i++) {
        const char *arg = argv[i];
        if (!only_operands && strcmp(arg, "--") == 0) only_operands = 1;
        else {
            if (!only_operands && arg[0] == '-' && arg[1]) code = take_option(o, seen, argc, argv, &i);
            else code = take_mesh(o, arg);
            if (code) return code;
        }
    }
    return DONE;
}

static void free_options(options *o)
{
    free(o->times);
    free(o->sources);
    free(o->points);
    free(o->levels);
}

/* ---- help ---- */

static const char INPUTS[] =
    "MESH is a file in OBJ, OFF, PLY or STL format. Points come from XYZ files (.xyz, .pts, .txt or\n"
    ".csv: x y z on each line), or from OBJ, OFF and PLY files without faces. - is standard input.\n";

static void print_version(void)
{
    printf("heatdiff %d.%d.%d\n", HD_VERSION_MAJOR, HD_VERSION_MINOR, HD_VERSION_PATCH);
}

static void print_help(void)
{
    int i;
    printf("heatdiff - heat diffusion kernels on meshes\n\nUse:  heatdiff COMMAND [OPTIONS] MESH\n\n"
           "Commands\n");
    for (i = 0; i < N_COMMANDS; i++) printf("  %-9s %s\n", COMMANDS[i].name, COMMANDS[i].help);
    printf("\nOptions\n  heatdiff COMMAND --help lists those of a command; --version prints the version\n"
           "\nExamples\n"
           "  heatdiff demo\n"
           "  heatdiff info bunny.obj\n"
           "  heatdiff kernel --source 0 --t 100h2 bunny.obj -o heat.ply\n"
           "  heatdiff kernel --source 0,500 --t auto:4 bunny.obj > columns.txt\n"
           "  heatdiff kernel --source 0 --t auto:100 --method krylov bunny.obj -o movie.npy\n"
           "  heatdiff distance --source 0 --t 100h2 bunny.obj -o distance.png\n"
           "  heatdiff hks --t auto:16 bunny.obj -o signature.npy\n"
           "  heatdiff hks --scale-invariant 6 --t 1h2,100000h2 bunny.obj -o invariant.npy\n"
           "  heatdiff geodesic --source 0 bunny.obj -o geodesic.png\n"
           "  heatdiff spectrum -k 100 bunny.obj -o modes.npy\n"
           "  heatdiff diffuse --input noisy.npy --t 2h2 bunny.obj -o smooth.npy\n"
           "  heatdiff smooth --t 2h2 bunny.obj -o smooth.obj\n"
           "  heatdiff render --input smooth.npy --isolines 12 bunny.obj -o smooth.png\n"
           "  heatdiff render --input a.npy --input b.npy a.obj b.obj -o pair.png\n"
           "\n%sVertices are counted from 0.\n"
           "Results: .txt .csv .npy .ply .obj .vtu .png by the extension of -o; without -o text on "
           "standard output.\n"
           "Exit codes: 0 done, 1 input or computation failed, 2 the command line is wrong, "
           "130 interrupted.\n", INPUTS);
}

static void print_option(const option_def *def)
{
    char left[40], words[WORDS_TEXT];
    const char *line = def->help, *end;
    const int all = (int)strcspn(line, "@");
    int width;
    snprintf(left, sizeof left, def->letter ? "-%c, --%s %s" : "%c   --%s %s",
             def->letter ? def->letter : ' ', def->name, def->value ? def->value : "");
    if (line[all]) {
        printf("  %-27s %.*s%s%s\n", left, all, line, list_words(def->words, words), line + all + 1);
        return;
    }
    for (;; line = end + 1) {
        end = strchr(line, '\n');
        width = end ? (int)(end - line) : (int)strlen(line);
        printf("  %-27s %.*s\n", line == def->help ? left : "", width, line);
        if (!end) return;
    }
}

static void print_indented(const char *text)
{
    while (*text) {
        const int n = (int)strcspn(text, "\n");
        printf("  %.*s\n", n, text);
        text += n + (text[n] != 0);
    }
}

static void print_command_help(const command_def *command)
{
    int i;
    printf("heatdiff %s - %s\n\n", command->name, command->help);
    printf("Use:  heatdiff %s %s\n\n", command->name, command->usage);
    if (command->bit != CMD_DEMO) printf("%s\n", INPUTS);
    printf("Output\n");
    print_indented(command->output);
    printf("\nOptions\n");
    for (i = 0; i < N_OPTIONS; i++)
        if (OPTIONS[i].commands & command->bit) print_option(&OPTIONS[i]);
}

/* ==== JSON ==== */

typedef struct json { FILE *out; int first; } json;

/* Length in bytes of the UTF-8 sequence that begins at p; 0 if it is not valid (RFC 3629). */
static int utf8_length(const char *text)
{
    const unsigned char *p = (const unsigned char *)text;
    const int n = p[0] < 0x80 ? 1 : p[0] < 0xc2 ? 0 : p[0] < 0xe0 ? 2 : p[0] < 0xf0 ? 3 : p[0] < 0xf5 ? 4 : 0;
    int i;
    for (i = 1; i < n; i++)
        if ((p[i] & 0xc0) != 0x80) return 0;
    if ((p[0] == 0xe0 && p[1] < 0xa0) || (p[0] == 0xf0 && p[1] < 0x90)) return 0;    /* longer than needed */
    /* half a pair, beyond the last */
    if ((p[0] == 0xed && p[1] > 0x9f) || (p[0] == 0xf4 && p[1] > 0x8f)) return 0;
    return n;
}

/* File names need not be UTF-8, but JSON must be: invalid bytes become the replacement character. */
static void json_string(FILE *out, const char *text)
{
    fputc('"', out);
    while (*text) {
        const unsigned char c = (unsigned char)*text;
        const int n = utf8_length(text);
        if (n == 0) fprintf(out, "\\ufffd");
        else if (c == '"' || c == '\\') fprintf(out, "\\%c", c);
        else if (c < 0x20 || c == 0x7f) fprintf(out, "\\u%04x", (unsigned)c);
        else fwrite(text, 1, (size_t)n, out);
        text += n ? n : 1;
    }
    fputc('"', out);
}

static void json_key(json *j, const char *key)
{
    fprintf(j->out, "%s", j->first ? "" : ", ");
    j->first = 0;
    json_string(j->out, key);
    fprintf(j->out, ": ");
}

/* JSON has neither NaN nor infinity: both become null. */
static void json_value(FILE *out, double v)
{
    if (isfinite(v)) fprintf(out, "%.17g", v);
    else fprintf(out, "null");
}

static void json_open(json *j, FILE *out)
{
    j->out = out;
    j->first = 1;
    fputc('{', out);
}

static void json_close(json *j) { fputc('}', j->out); }

static void json_number(json *j, const char *key, double v) { json_key(j, key); json_value(j->out, v); }

static void json_integer(json *j, const char *key, int64_t v)
{
    json_key(j, key);
    fprintf(j->out, "%lld", (long long)v);
}

static void json_text(json *j, const char *key, const char *text)
{
    json_key(j, key);
    json_string(j->out, text);
}

static void json_numbers(json *j, const char *key, const double *v, int n)
{
    int i;
    json_key(j, key);
    fputc('[', j->out);
    for (i = 0; i < n; i++) {
        if (i) fprintf(j->out, ", ");
        json_value(j->out, v[i]);
    }
    fputc(']', j->out);
}

static void json_integers(json *j, const char *key, const int64_t *v, int n)
{
    int i;
    json_key(j, key);
    fputc('[', j->out);
    for (i = 0; i < n; i++) fprintf(j->out, "%s%lld", i ? ", " : "", (long long)v[i]);
    fputc(']', j->out);
}

/* ==== what a run reports ==== */

typedef struct seconds { double load, assemble, write, stage[N_STAGES]; } seconds;

/* Room for the words of a list such as "lanczos, cocg". */
typedef struct word_list { char text[200]; } word_list;

/* The reports of all calls together. */
typedef struct summary {
    hd_report *per_time;             /* [number of times] of each time the worst over its calls */
    hd_report worst;                 /* largest errors, sums of iterations and flops */
    word_list method, reason, solver, precond, poles, ordering;  /* all that were used */
} summary;

/* Appends name unless it is in the list. */
static void add_word(word_list *list, const char *separator, const char *name)
{
    const size_t n = strlen(name), used = strlen(list->text);
    const char *p;
    for (p = strstr(list->text, name); p; p = strstr(p + n, name))     /* as a whole word: ildl is in mildl */
        if ((p == list->text || p[-1] == ' ') && (p[n] == 0 || p[n] == separator[0])) return;
    if (used + n + 3 < sizeof list->text)
        snprintf(list->text + used, sizeof list->text - used, "%s%s", used ? separator : "", name);
}

static void keep_larger(double *largest, double v)
{
    if (v > *largest || v != v) *largest = v;
}

/* The direct method and times of 0 have no solver. */
static const char *solver_name(const hd_report *r)
{
    return r->solver == HD_SOLVER_AUTO ? "none" : word_of(SOLVERS, (int)r->solver);
}

/* Lanczos has no poles. */
static const char *precond_name(const hd_report *r)
{
    return r->precond == HD_PRECOND_AUTO ? "none" : word_of(PRECONDS, (int)r->precond);
}

static const char *poles_name(const hd_report *r)
{
    return r->poles == HD_POLES_DEFAULT ? "none" : r->poles == HD_POLES_OWN ? "filter"
           : word_of(POLES, (int)r->poles);
}

static const char *ordering_name(const hd_report *r)
{
    return r->ordering == HD_ORDERING_AUTO ? "none" : word_of(ORDERINGS, (int)r->ordering);
}

/* Merges two reports: the worse bounds, the sum of the counts, the names of the later one. */
static void report_merge(hd_report *all, const hd_report *one)
{
    int p;
    if (one->status > all->status) all->status = one->status;
    all->method = one->method;
    all->reason = one->reason;
    all->solver = one->solver;
    all->precond = one->precond;
    all->poles = one->poles;
    all->ordering = one->ordering;
    if (one->degree > all->degree) all->degree = one->degree;
    if (one->n_poles > all->n_poles) all->n_poles = one->n_poles;
    all->iterations += one->iterations;
    for (p = 0; p < one->n_poles; p++) all->pole_iterations[p] += one->pole_iterations[p];
    if (one->factor_nnz > all->factor_nnz) all->factor_nnz = one->factor_nnz;
    all->factor_flops += one->factor_flops;
    keep_larger(&all->growth, one->growth);
    keep_larger(&all->residual, one->residual);
    keep_larger(&all->error_rational, one->error_rational);
    keep_larger(&all->error_solver, one->error_solver);
    keep_larger(&all->error_rounding, one->error_rounding);
    keep_larger(&all->error_local, one->error_local);
    if (one->evidence_rational > all->evidence_rational) all->evidence_rational = one->evidence_rational;
    if (one->evidence_solver > all->evidence_solver) all->evidence_solver = one->evidence_solver;
    if (one->evidence_rounding > all->evidence_rounding) all->evidence_rounding = one->evidence_rounding;
    if (one->evidence_local > all->evidence_local) all->evidence_local = one->evidence_local;
    if (one->n_touched > all->n_touched) all->n_touched = one->n_touched;
    if (one->n_patches > all->n_patches) all->n_patches = one->n_patches;
    if (one->evidence_b > all->evidence_b) all->evidence_b = one->evidence_b;
    keep_larger(&all->error_bound_b, one->error_bound_b);
    keep_larger(&all->error_bound, one->error_bound);
    keep_larger(&all->mass_drift, one->mass_drift);
    keep_larger(&all->error_relative, one->error_relative);
    if (one->smallest > 0 && !(all->smallest > 0 && all->smallest < one->smallest))
        all->smallest = one->smallest;
    all->n_lost += one->n_lost;
}

/* Adds the report of one call for the times index[0..n-1]. */
static void summary_add(summary *s, const hd_report *r, const int *index, int n)
{
    int i;
    for (i = 0; i < n; i++) report_merge(&s->per_time[index[i]], r);
    report_merge(&s->worst, r);
    /* t = 0: nothing was solved */
    if (r->iterations == 0 && r->n_poles == 0 && r->factor_nnz == 0) return;
    add_word(&s->method, ", ", word_of(METHODS, (int)r->method));
    add_word(&s->solver, ", ", solver_name(r));
    add_word(&s->precond, ", ", precond_name(r));
    add_word(&s->poles, ", ", poles_name(r));
    add_word(&s->ordering, ", ", ordering_name(r));
    add_word(&s->reason, "; ", r->reason);
}

static const char *or_none(const word_list *list) { return list->text[0] ? list->text : "none"; }

/* Fills in the choices if there was nothing to solve: t = 0, or no vertex with mass. */
static const char *method_text(const summary *s)
{
    return s->method.text[0] ? s->method.text : word_of(METHODS, (int)s->worst.method);
}
static const char *reason_text(const summary *s)
{
    return s->reason.text[0] ? s->reason.text : s->worst.reason;
}

/* ==== meshes and fields ==== */

/* A mesh as the file has it, and its triangles: n, xyz and n_faces are those of file. */
typedef struct mesh_data {
    mio_mesh file;
    int32_t n, n_faces, n_tri;
    const double *xyz;
    int32_t *tri;                    /* polygons as fans */
    int32_t *face_of;                /* [n_tri] the face a triangle is of */
} mesh_data;

typedef struct field_data { double *values; int32_t columns; } field_data;

static const char *plural(int64_t n) { return n == 1 ? "" : "s"; }

static const char *display_name(const char *path) { return strcmp(path, "-") == 0 ? "<stdin>" : path; }

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static int fail_file(const mio_error *e) { return fail(FAILED, "%s", e->text); }

static void mesh_free(mesh_data *m)
{
    mio_free(&m->file);
    free(m->tri);
    free(m->face_of);
    memset(m, 0, sizeof *m);
}

static int mesh_finish(mesh_data *m)
{
    mio_error e;
    const int status = mio_triangulate(&m->file, &m->tri, &m->n_tri, &m->face_of, &e);
    m->n = m->file.n;
    m->n_faces = m->file.n_faces;
    m->xyz = m->file.xyz;
    return status < 0 ? fail_file(&e) : DONE;
}

static int mesh_load(mesh_data *m, const char *path)
{
    mio_error e;
    const int status = mio_load(&m->file, path, NULL, &e);
    return status < 0 ? fail_file(&e) : mesh_finish(m);
}

/* Makes a mesh from a shape, and empties the shape. */
static int mesh_of_shape(mesh_data *m, shape *s)
{
    int32_t f;
    m->file.face_ptr = (int64_t *)malloc(((size_t)s->n_tri + 1) * sizeof(int64_t));
    if (!m->file.face_ptr) return fail_memory("the mesh");
    for (f = 0; f <= s->n_tri; f++) m->file.face_ptr[f] = 3 * (int64_t)f;
    m->file.n = s->n;
    m->file.n_faces = s->n_tri;
    m->file.xyz = s->xyz;
    m->file.face_idx = s->tri;
    m->file.format = "memory";
    memset(s, 0, sizeof *s);
    return mesh_finish(m);
}

static void field_free(field_data *field)
{
    free(field->values);
    memset(field, 0, sizeof *field);
}

/* A field for a mesh of n vertices. infinite: inf and nan are values too, as pictures and level sets leave
 * them out. */
static int field_load(field_data *field, const char *path, const char *mesh_name, int32_t n, int infinite)
{
    mio_error e;
    int64_t rows = 0;
    const int status = (infinite ? mio_load_field : mio_load_table)(&field->values, &rows, &field->columns,
                                                                    path, NULL, &e);
    if (status < 0) return fail_file(&e);
    if (rows != n)
        return fail(FAILED, "%s: %lld rows, but %s has %ld vertices", display_name(path), (long long)rows,
                    mesh_name, (long)n);
    return DONE;
}

/* ==== a run: mesh, operator, times, values ==== */

enum { NAME_SIZE = 48 };

/* Options with which a run that does not fit the memory would take less. */
typedef struct way { char option[48]; double bytes, seconds; } way;
enum { MAX_WAYS = 8 };

typedef struct run {
    const options *o;
    const char *mesh_name;           /* for people */
    hd_context context;
    mesh_data mesh;
    double *lengths;                 /* [3 mesh.n_tri] with --lengths */
    int64_t *length_lines;           /* [mesh.n_tri] of its file; NULL: .npy */
    hd_laplacian *lap;
    double *times;                   /* resolved */
    char (*time_names)[NAME_SIZE];   /* "10h2", "0.01" */
    int n_times;
    hd_rational filter;              /* with --filter */
    int32_t *sources;                /* the nearest vertex of each, if they need not be vertices */
    int n_inputs;                    /* sources, or fields given */
    hd_sources from;
    int places;                      /* sources need not be vertices */
    int64_t *first;                  /* [n_inputs + 1] of their points */
    source_point *points;            /* [n_points] */
    int n_points;
    int32_t *corner;                 /* [3 n_points] */
    double *bary, *point_weight;     /* [3 n_points], [n_points] */
    const double *fields;            /* mesh.n x n_inputs, or NULL: the kernel columns of the sources */
    const char *field_name;          /* for people */
    hd_heat *heat;
    hd_geodesic *geodesic;
    hd_geodesic_report geodesic_report;
    hd_spectrum *spectrum;
    hd_status spectrum_status;
    hd_estimate estimate;            /* of --dry-run, or of a run that does not fit */
    way ways[MAX_WAYS];
    int n_ways;
    int32_t *pairs;                  /* pairs: [2 rows], first the i, then the j */
    int64_t rows;                    /* of the result: the vertices, the pairs or the points */
    /* column-major, rows x n_columns; input q after time k is column q n_times + k */
    double *values;
    int64_t n_columns;
    double asymmetry;                /* --matrix: the largest difference between both directions */
    char (*names)[NAME_SIZE];        /* of the columns, and pointers to them */
    const char **name_list;
    summary sum;
    double bound[2];                 /* pairs: of the kernel and of the distance, at all times */
    double moved[2], held_error;     /* smooth: means and most of the vertices' ways; error of what is held */
    double off;                      /* and a bound on the error of coordinates */
    seconds sec;
    double started;
} run;

static void run_begin(run *r, const options *o)
{
    memset(r, 0, sizeof *r);
    r->o = o;
    r->started = now();
    r->mesh_name = o->mesh ? display_name(o->mesh) : "demo";
    r->context.byte_limit = o->memory_limit ? o->memory_limit : machine_bytes();
    r->context.n_threads = (int32_t)o->threads;
    r->context.simd = (hd_simd)o->simd;
    r->context.progress = on_progress;
    bar.enabled = !o->quiet && stderr_is_terminal();
}

static void run_end(run *r)
{
    bar_hide();
    hd_heat_free(r->heat);
    hd_geodesic_free(r->geodesic);
    hd_spectrum_free(r->spectrum);
    hd_laplacian_free(r->lap);
    mesh_free(&r->mesh);
    free(r->lengths);
    free(r->length_lines);
    free(r->times);
    free(r->time_names);
    free(r->sources);
    free(r->first);
    free(r->points);
    free(r->corner);
    free(r->bary);
    free(r->point_weight);
    free(r->pairs);
    free(r->values);
    free(r->names);
    free(r->name_list);
    free(r->sum.per_time);
}

static int threads_used(const run *r) { return (int)hd_context_threads(&r->context); }

/* n rows of doubles, with the size checked; at least one column. */
static double *new_columns(int64_t n, int64_t columns)
{
    if ((uint64_t)n > SIZE_MAX / sizeof(double) / (uint64_t)columns) return NULL;
    return (double *)malloc((size_t)(n * columns) * sizeof(double) + 1);
}

/* Turns the library's error into the tool's line, with the place in the user's file. */
static int fail_library(const char *file, const hd_error *e)
{
    char place[120] = "";
    if (e->status == HD_ERR_CANCELLED) return INTERRUPTED;       /* on_progress said so */
    if (e->status == HD_ERR_MEMORY_LIMIT && e->value > 0)
        return fail(FAILED, "%s: at least %.1f MB are needed, more than the memory limit "
                    "(--memory-limit, by default nine tenths of the machine's memory)",
                    file, 1e-6 * e->value);
    if (e->face >= 0) snprintf(place, sizeof place, " face %lld:", (long long)e->face);
    else if (e->vertex >= 0) snprintf(place, sizeof place, " vertex %lld:", (long long)e->vertex);
    else if (e->row >= 0 && e->column >= 0)
        snprintf(place, sizeof place, " row %lld, column %lld:", (long long)e->row, (long long)e->column);
    if (e->pole >= 0)
        snprintf(place + strlen(place), sizeof place - strlen(place), " pole %lld:", (long long)e->pole);
    return fail(FAILED, "%s:%s %s", file, place, e->text[0] ? e->text : hd_status_text(e->status));
}

/* Can the faces of the mesh have lengths of edges, and are there as many rows of them? */
static int check_length_rows(const run *r, int64_t rows, int32_t columns)
{
    const mesh_data *m = &r->mesh;
    const char *file = display_name(r->o->lengths);
    int32_t f;
    if (m->n_faces == 0) return fail(FAILED, "%s: --lengths needs faces, and there are none", r->mesh_name);
    for (f = 0; f < m->n_faces; f++)
        if (m->file.face_ptr[f + 1] - m->file.face_ptr[f] != 3)
            return fail(FAILED, "%s: face %ld: --lengths takes triangles, and it has %lld corners", r->mesh_name,
                        (long)f, (long long)(m->file.face_ptr[f + 1] - m->file.face_ptr[f]));
    if (columns != 3)
        return fail(FAILED, "%s: %ld column%s; a face has three edges", file, (long)columns, plural(columns));
    return rows == m->n_faces ? DONE : fail(FAILED, "%s: %lld rows, but %s has %ld faces", file, (long long)rows,
                                            r->mesh_name, (long)m->n_faces);
}

/* --lengths: the three of a face side by side, as the library takes them. */
static int run_lengths(run *r)
{
    mio_error e;
    double *table = NULL;
    int64_t rows = 0, f;
    int32_t columns = 0;
    const int status = mio_load_table_lines(&table, &rows, &columns, &r->length_lines, r->o->lengths, NULL, &e);
    int code = status < 0 ? fail_file(&e) : check_length_rows(r, rows, columns);
    if (!code && (r->lengths = new_columns(rows, 3)) == NULL) code = fail_memory("the lengths");
    for (f = 0; f < 3 * rows && !code; f++) r->lengths[f] = table[f % 3 * rows + f / 3];
    free(table);
    return code;
}

static int run_load(run *r)
{
    const double start = now();
    int code = mesh_load(&r->mesh, r->o->mesh);
    if (!code && r->o->lengths) code = run_lengths(r);
    r->sec.load = now() - start;
    return code;
}

/* Geodesic distances of points always take the triangles of their neighbours. */
static int is_tufted(const run *r)
{
    return r->o->tufted || (r->o->command == CMD_GEODESIC && r->mesh.n_tri == 0);
}

/* The Laplacian of the command line. By default it depends on the triangulation options, and on whether the
 * mesh has no faces, other faces than triangles, or triangles only. */
static hd_laplacian_kind laplacian_kind(const run *r)
{
    if (r->o->laplacian != HD_LAPLACIAN_DEFAULT) return (hd_laplacian_kind)r->o->laplacian;
    if (r->o->intrinsic_delaunay || is_tufted(r)) return HD_LAPLACIAN_FEM;
    if (r->mesh.n_tri == 0) return HD_LAPLACIAN_VORONOI_EXP;
    /* no face of the file has fewer than three corners */
    return r->mesh.n_tri != r->mesh.n_faces ? HD_LAPLACIAN_POLYGON : HD_LAPLACIAN_FEM;
}

static int has_exponentials(const run *r)
{
    const hd_laplacian_kind kind = laplacian_kind(r);
    return kind == HD_LAPLACIAN_VORONOI_EXP || kind == HD_LAPLACIAN_EXP;
}

static int is_points(const run *r) { return r->mesh.n_tri == 0 || has_exponentials(r); }

/* h of points: the mean distance of a point to the nearest other one. The library reports it only after
 * assembling, but the bandwidth may be given in units of it. */
static hd_status point_spacing(run *r, double *h, hd_error *err)
{
    const int32_t n = r->mesh.n, k = n < 16 ? n : 16;
    int32_t *near_ids = (int32_t *)malloc((size_t)n * (size_t)k * sizeof *near_ids + 1), i, j, count = 0;
    double *d2 = new_columns(n, k);
    hd_status status = HD_ERR_MEMORY;
    *h = 0;
    memset(err, 0, sizeof *err);
    err->face = err->vertex = err->row = err->column = err->pole = -1;
    err->status = status;
    if (near_ids && d2)
        status = hd_neighbours_nearest(r->mesh.xyz, n, NULL, n, k, near_ids, d2, &r->context, err);
    for (i = 0; status >= 0 && i < n; i++) {
        const double *d = d2 + (size_t)i * (size_t)k;
        /* the first is the point itself, or an earlier one in its place */
        if (near_ids[(size_t)i * (size_t)k] != i) continue;
        for (j = 0; j < k && d[j] == 0; j++) { }
        if (j == k) continue;
        *h += sqrt(d[j]);
        count++;
    }
    if (count) *h /= count;
    free(near_ids);
    free(d2);
    return status;
}

/* The mesh as the library takes it: points, the faces of the file, or triangles by coordinates or lengths. */
static hd_mesh run_mesh(const run *r, hd_shape shape)
{
    const mesh_data *m = &r->mesh;
    hd_mesh mesh = hd_triangles(m->xyz, m->n, m->tri, m->n_tri);
    mesh.shape = shape;
    if (shape != HD_TRIANGLES) {
        mesh.corner = shape == HD_POLYGONS ? m->file.face_idx : NULL;
        mesh.face_ptr = shape == HD_POLYGONS ? m->file.face_ptr : NULL;
        mesh.n_faces = shape == HD_POLYGONS ? m->n_faces : 0;
    } else if (r->lengths) {
        mesh.xyz = NULL;
        mesh.lengths = r->lengths;
    }
    return mesh;
}

static hd_triangulation run_triangulation(const run *r)
{
    if (is_tufted(r)) return HD_TRIANGULATION_TUFTED;
    return r->o->intrinsic_delaunay ? HD_TRIANGULATION_DELAUNAY : HD_TRIANGULATION_GIVEN;
}

static hd_status run_laplacian(run *r, hd_error *err)
{
    const time_spec s = r->o->bandwidth;
    hd_laplacian_opts opts;
    const double start = now();
    double h = 1;
    hd_mesh mesh;
    hd_status status = HD_OK;
    memset(&opts, 0, sizeof opts);
    opts.kind = laplacian_kind(r);
    opts.stiffening = r->o->lambda;
    opts.context = &r->context;
    opts.triangulation = run_triangulation(r);
    if (r->o->command != CMD_GEODESIC) opts.border = (hd_border)r->o->border;
    mesh = run_mesh(r, is_points(r) ? HD_POINTS : opts.kind == HD_LAPLACIAN_POLYGON ? HD_POLYGONS : HD_TRIANGLES);
    interrupt.patient = 1;
    if (is_points(r) && !is_tufted(r)) {
        if (s.unit == TIME_H2) status = point_spacing(r, &h, err);
        opts.bandwidth2 = s.value * h * h;
        opts.weight_cut = r->o->weight_cut;
    }
    if (status >= 0) status = hd_laplacian_create(&r->lap, &mesh, &opts, err);
    interrupt.patient = 0;
    r->sec.assemble = now() - start;
    return status;
}

static const double WIDER_CUT = 1e-4;    /* halves the rows of exponential weights and changes L by 0.1 % */

/* An error about the lengths of a face: where they stand. */
static int fail_length(const run *r, const hd_error *err)
{
    const char *file = display_name(r->o->lengths);
    char edge[48] = "";
    mio_error e;
    if (err->vertex >= 0) snprintf(edge, sizeof edge, ", at the edge from vertex %lld", (long long)err->vertex);
    mio_fail_at(&e, file, r->length_lines ? r->length_lines[err->face] : 0, "face %lld: %s: %.17g%s",
                (long long)err->face, err->text, err->value, edge);
    return fail(FAILED, "%s", e.text);
}

static int fail_laplacian(const run *r, hd_error *err)
{
    if (r->lengths && err->face >= 0) return fail_length(r, err);
    /* the ways out that find_ways tries: a run whose matrices do not fit has no plan to ask */
    if (err->status == HD_ERR_MEMORY_LIMIT && err->value > 0 && laplacian_kind(r) == HD_LAPLACIAN_VORONOI_EXP)
        return fail(FAILED, "%s: the matrices alone need at least %.1f MB, and %.1f MB are allowed (--memory-limit, "
                    "by default nine tenths of the machine's memory); --tufted%s", r->mesh_name,
                    1e-6 * err->value, 1e-6 * (double)r->context.byte_limit,
                    r->o->weight_cut < WIDER_CUT ? " and --weight-cut 1e-4 need less" : " needs less");
    if (err->face >= 0 && laplacian_kind(r) != HD_LAPLACIAN_POLYGON)
        err->face = r->mesh.face_of[err->face];
    return fail_library(r->mesh_name, err);
}

/* Do the options fit what the file has? */
static int check_laplacian(const run *r)
{
    if (r->mesh.n_tri == 0 && r->o->intrinsic_delaunay && !is_tufted(r))
        return fail(FAILED, "%s: --intrinsic-delaunay needs faces, and there are none; points take --tufted",
                    r->mesh_name);
    if (r->mesh.n_tri == 0 && !has_exponentials(r) && !is_tufted(r))
        return fail(FAILED, "%s: --laplacian %s needs faces, and there are none; "
                    "points take voronoi-exp or exp, or --tufted with fem, voronoi-cot or cot",
                    r->mesh_name, word_of(LAPLACIANS, r->o->laplacian));
    if ((r->o->has_bandwidth || r->o->weight_cut > 0) && !has_exponentials(r))
        return fail(FAILED,
                    "%s: --%s is for points (--laplacian voronoi-exp or exp), and this file has faces",
                    r->mesh_name, r->o->has_bandwidth ? "bandwidth" : "weight-cut");
    if (r->o->border != HD_BORDER_NATURAL && is_points(r))
        return fail(FAILED, "%s: --border %s needs faces: points do not tell where their border is",
                    r->mesh_name, r->o->command == CMD_GEODESIC ? word_of(GEODESIC_BORDERS, r->o->border)
                                                                : "dirichlet");
    if (r->o->lambda > 0 && is_points(r))
        return fail(FAILED, "%s: --lambda is for faces, and these are points", r->mesh_name);
    if (r->o->lambda > 0 && laplacian_kind(r) != HD_LAPLACIAN_POLYGON)
        return fail(FAILED, "%s: --lambda is for --laplacian polygon, and triangles have %s by default; "
                    "on triangles it changes nothing", r->mesh_name,
                    word_of(LAPLACIANS, (int)laplacian_kind(r)));
    return DONE;
}

static int run_assemble(run *r)
{
    hd_error err;
    const int code = check_laplacian(r);
    if (code) return code;
    if (run_laplacian(r, &err) < 0) return fail_laplacian(r, &err);
    return interrupt.asked ? INTERRUPTED : DONE;
}

/* ---- times ---- */

/* 1/lambda_1, of the smallest eigenvalue that does not belong to constants. */
static int first_eigenvalue(run *r, double *unit)
{
    hd_spectrum *s = NULL;
    hd_spectrum_opts opts;
    hd_error err;
    double first;
    memset(&opts, 0, sizeof opts);
    opts.count = r->lap->n_components + (r->lap->n_components < r->lap->n_active);
    if (hd_spectrum_create(&s, r->lap, &opts, &err) < 0) return fail_library(r->mesh_name, &err);
    first = s->n_constant < s->count ? s->value[s->n_constant] : 0;
    hd_spectrum_free(s);
    *unit = 1 / first;
    if (!(first > 0)) return fail(FAILED, "%s: there is no eigenvalue above zero but for rounding", r->mesh_name);
    return DONE;
}

/* The same, or 1 if no time needs it. */
static int spectral_unit(run *r, double *unit)
{
    int i;
    *unit = 1;
    for (i = 0; i < r->o->n_times && r->o->times[i].unit != TIME_SPECTRAL; i++) {}
    return i == r->o->n_times ? DONE : first_eigenvalue(r, unit);
}

/* The times of one item of --t, and their names. */
static int put_times(run *r, time_spec s, double unit)
{
    double *t = &r->times[r->n_times];
    int k, count = s.unit == TIME_AUTO ? (int)s.value : 1;
    if (s.unit == TIME_AUTO) (void)hd_times_auto(r->lap, count, t, NULL);
    else *t = s.unit == TIME_H2 ? s.value * r->lap->h * r->lap->h
            : s.unit == TIME_SPECTRAL ? s.value * unit : s.value;
    for (k = 0; k < count; k++, r->n_times++) {
        char *name = r->time_names[r->n_times];
        if (!isfinite(t[k]))
            return fail(FAILED, "%s: the time %g%s is too large for h = %g", r->mesh_name, s.value,
                        s.unit == TIME_H2 ? "h2" : "/l1", r->lap->h);
        if (s.unit == TIME_H2) snprintf(name, sizeof *r->time_names, "%.9gh2", s.value);
        else if (s.unit == TIME_SPECTRAL) snprintf(name, sizeof *r->time_names, "%.9g/l1", s.value);
        else snprintf(name, sizeof *r->time_names, s.unit == TIME_AUTO ? "%.4g" : "%.9g", t[k]);
    }
    return DONE;
}

/* Times an octave of scale-invariant signatures, as in the paper. */
enum { PER_OCTAVE = 16 };

/* Fills in the times between the first and the last. */
static int spread_times(run *r)
{
    const double t0 = r->times[0], t1 = r->times[1];
    const int least = 2 * (int)r->o->frequencies + 1;
    int k, n;
    if (!(t1 > t0))
        return fail(FAILED, "%s: the last time, %g, is not above the first, %g", r->mesh_name, t1, t0);
    if (!isfinite(t1 / t0))
        return fail(FAILED, "%s: the last time, %g, is too far above the first, %g", r->mesh_name, t1, t0);
    n = 1 + (int)(PER_OCTAVE * log2(t1 / t0) + 0.5);
    if (n < least) n = least;
    free(r->times);
    free(r->time_names);
    free(r->sum.per_time);
    r->times = (double *)malloc((size_t)n * sizeof *r->times);
    r->time_names = (char (*)[NAME_SIZE])malloc((size_t)n * sizeof *r->time_names);
    r->sum.per_time = (hd_report *)calloc((size_t)n, sizeof *r->sum.per_time);
    if (!r->times || !r->time_names || !r->sum.per_time) return fail_memory("the times");
    for (k = 0; k < n; k++) {
        r->times[k] = t0 * pow(t1 / t0, k / (double)(n - 1));
        snprintf(r->time_names[k], sizeof *r->time_names, "%.9g", r->times[k]);
    }
    r->n_times = n;
    return DONE;
}

/* Nobody asks for so poor a filter: the function that is zero everywhere misses it by 1 of its largest value. */
static const double USELESS = 0.1;

/* The pole set of --filter, whose time is its own. */
static int run_filter(run *r)
{
    const options *o = r->o;
    const double h2 = r->lap->h * r->lap->h;
    hd_filter f;
    hd_error err;
    memset(&f, 0, sizeof f);
    f.kind = (hd_filter_kind)o->filter_kind;
    f.a = o->filter_a.value * (o->filter_a.unit == TIME_H2 ? h2 : 1);
    f.b = o->filter_b;
    if (f.kind == HD_FILTER_FRACTIONAL) {
        double unit;                             /* 1/lambda_1: all other eigenvalues are above */
        const int code = first_eigenvalue(r, &unit);
        if (code) return code;
        f.lambda_min = 0.99 / unit;
    }
    if (hd_rational_fit(&r->filter, 1, &f, r->lap->lambda_max, &r->context, &err) < 0)
        return fail_library(r->mesh_name, &err);
    if (!(r->filter.max_error < USELESS * r->filter.largest))
        return fail(FAILED, "%s: --filter %s: the best poles found miss it by %.1e of its largest value",
                    r->mesh_name, o->filter, r->filter.max_error / r->filter.largest);
    r->times[0] = r->filter.t;
    snprintf(r->time_names[r->n_times++], sizeof *r->time_names, "%s", word_of(FILTERS, o->filter_kind));
    return DONE;
}

static int run_times(run *r)
{
    static const time_spec usual = { TIME_H2, 1 };       /* of geodesic and smooth, when --t is not given */
    const options *o = r->o;
    const int n_given = o->times ? o->n_times : 1;
    const time_spec *given = o->times ? o->times : &usual;
    double unit = 1;
    int i, code, total = 0;
    for (i = 0; i < n_given; i++) total += given[i].unit == TIME_AUTO ? (int)given[i].value : 1;
    r->times = (double *)malloc((size_t)total * sizeof *r->times);
    r->time_names = (char (*)[NAME_SIZE])malloc((size_t)total * sizeof *r->time_names);
    r->sum.per_time = (hd_report *)calloc((size_t)total, sizeof *r->sum.per_time);
    if (!r->times || !r->time_names || !r->sum.per_time) return fail_memory("the times");
    if (o->filter) return run_filter(r);
    if (is_timeless(o)) {                /* a time in name only */
        r->times[0] = 0;
        snprintf(r->time_names[r->n_times++], sizeof *r->time_names, "%s",
                 word_of(DEFINITIONS, o->definition));
        return DONE;
    }
    code = o->times ? spectral_unit(r, &unit) : DONE;
    for (i = 0; i < n_given && !code; i++) code = put_times(r, given[i], unit);
    return code || !o->frequencies ? code : spread_times(r);
}

/* "t = 10 h^2" for titles. */
static void time_text(const char *name, char *text, size_t size)
{
    const size_t n = strlen(name);
    if (n > 2 && strcmp(name + n - 2, "h2") == 0) snprintf(text, size, "t = %.*s h^2", (int)n - 2, name);
    else if (n > 3 && strcmp(name + n - 3, "/l1") == 0)
        snprintf(text, size, "t = %.*s / lambda_1", (int)n - 3, name);
    else snprintf(text, size, "t = %s", name);
}

/* ---- solving ---- */

/* A point on each line of a file, as one source more. */
static int read_point_lines(run *r, mio_in *in, size_t room)
{
    const char *end;
    char shown[48];
    in->hash = 1;
    while (mio_space(in)) {
        source_point p, *more = r->points;
        const int64_t line = in->line;
        const char *text = in->p;
        const int good = read_point(text, &p, &end);
        if (good) in->p = text = end;
        if (!good || mio_blanks(in))
            return mio_fail(in, line, "'%s' is no point: a vertex such as 17, or a place in a face such as "
                            "12:0.2,0.3", mio_show(in, in->p, shown));
        if ((size_t)r->n_points == room)
            more = r->n_points < INT32_MAX
                   ? (source_point *)mio_grow(more, &room, room + 1, sizeof *more) : NULL;
        if (!more) return mio_no_memory(in);
        r->points = more;
        p.source = r->o->n_sources;
        p.line = line;
        r->points[r->n_points++] = p;
    }
    return r->n_points > r->o->n_points ? MIO_OK : mio_fail(in, 0, "there is no point in it");
}

/* The points of the command line, and those of the file. */
static int read_points(run *r)
{
    const options *o = r->o;
    const size_t room = (size_t)o->n_points + 16;
    mio_error e;
    mio_in in;
    int status;
    r->n_points = o->n_points;
    r->points = (source_point *)malloc(room * sizeof *r->points);
    if (!r->points) return fail_memory("the sources");
    if (o->points) memcpy(r->points, o->points, (size_t)o->n_points * sizeof *r->points);
    if (!o->source_file) return DONE;
    status = mio_open(&in, o->source_file, NULL, &e);
    if (status == MIO_OK) status = read_point_lines(r, &in, room);
    mio_close(&in);
    return status < 0 ? fail_file(&e) : DONE;
}

/* An error at a point of a source. */
static int fail_point(const run *r, const source_point *p, const char *what)
{
    mio_error e;
    if (!p->line) return fail(FAILED, "%s: --source %lld %s", r->mesh_name, (long long)p->id, what);
    mio_fail_at(&e, display_name(r->o->source_file), p->line, "%lld %s", (long long)p->id, what);
    return fail(FAILED, "%s", e.text);
}

/* The corners of point i. */
static int take_point(run *r, int i)
{
    const source_point *p = &r->points[i];
    const mio_mesh *mesh = &r->mesh.file;
    int32_t *v = r->corner + 3 * (size_t)i;
    double *b = r->bary + 3 * (size_t)i;
    const int32_t count = p->in_face ? mesh->n_faces : r->mesh.n;
    char what[120];
    if (p->id >= count) {
        snprintf(what, sizeof what, "is beyond the mesh, which has %ld %s, numbered from 0", (long)count, p->in_face ? "faces" : "vertices");
        return fail_point(r, p, what);
    }
    r->point_weight[i] = p->weight;
    v[0] = v[1] = v[2] = (int32_t)p->id;
    b[0] = 1;
    b[1] = b[2] = 0;
    if (!p->in_face) return DONE;
    if (mesh->face_ptr[p->id + 1] - mesh->face_ptr[p->id] != 3)
        return fail_point(r, p, "is no triangle: give its vertices with weights, such as 0.25*3+0.75*7");
    memcpy(v, mesh->face_idx + mesh->face_ptr[p->id], 3 * sizeof *v);
    b[0] = p->bary[0];
    b[1] = p->bary[1];
    b[2] = 1 - b[0] - b[1] > 0 ? 1 - b[0] - b[1] : 0;
    return DONE;
}

/* Sources that need not be vertices. */
static int run_places(run *r)
{
    const options *o = r->o;
    int i, code = read_points(r);
    if (code) return code;
    r->n_inputs = o->n_sources + (o->source_file != NULL);
    r->sources = (int32_t *)malloc(((size_t)r->n_inputs + (size_t)o->count) * sizeof *r->sources);
    r->first = (int64_t *)calloc((size_t)r->n_inputs + 1, sizeof *r->first);
    r->corner = (int32_t *)malloc((size_t)r->n_points * 3 * sizeof *r->corner);
    r->bary = (double *)malloc((size_t)r->n_points * 3 * sizeof *r->bary);
    r->point_weight = (double *)malloc((size_t)r->n_points * sizeof *r->point_weight);
    if (!r->sources || !r->first || !r->corner || !r->bary || !r->point_weight) return fail_memory("the sources");
    for (i = 0; i < r->n_points; i++) {
        const int32_t *v = r->corner + 3 * (size_t)i;
        const double *b = r->bary + 3 * (size_t)i;
        const int q = r->points[i].source;
        if ((code = take_point(r, i)) != DONE) return code;
        if (r->first[q + 1]++ == 0) r->sources[q] = v[b[0] >= b[1] && b[0] >= b[2] ? 0 : b[1] >= b[2] ? 1 : 2];
    }
    for (i = 0; i < r->n_inputs; i++) {
        if (o->curve && r->first[i + 1] < 2) return fail(FAILED, "--curve: source %d has one point; join several with +", i);
        r->first[i + 1] += r->first[i];
    }
    r->places = 1;
    r->from = hd_vertices(r->n_inputs, r->corner);
    r->from.first = r->first;
    r->from.corners = 3;
    r->from.bary = r->bary;
    r->from.weight = o->curve ? NULL : r->point_weight;
    r->from.curve = o->curve;
    return DONE;
}

/* Some of the sources, from one on. */
static hd_sources run_some(const run *r, int q, int count)
{
    hd_sources s = r->from;
    s.count = count;
    if (s.first) s.first += q;
    else s.vertex += q;
    return s;
}

static int run_sources(run *r)
{
    const options *o = r->o;
    int i;
    if (o->anywhere || o->curve || o->source_file) return run_places(r);
    r->n_inputs = o->n_sources;
    r->sources = (int32_t *)malloc((size_t)(o->command == CMD_SAMPLE ? o->count : o->n_sources)
                                   * sizeof *r->sources);
    if (!r->sources) return fail_memory("the sources");
    for (i = 0; i < o->n_sources; i++) {
        if (o->sources[i] >= r->mesh.n)
            return fail(FAILED,
                        "%s: --source %lld is beyond the mesh, which has %ld vertices, numbered from 0",
                        r->mesh_name, (long long)o->sources[i], (long)r->mesh.n);
        r->sources[i] = (int32_t)o->sources[i];
    }
    r->from = hd_vertices(r->n_inputs, r->sources);
    return DONE;
}

static int run_plan(run *r)
{
    const options *o = r->o;
    hd_heat_opts opts;
    hd_error err;
    memset(&opts, 0, sizeof opts);
    opts.method = (hd_method)o->method;
    opts.ordering = (hd_ordering)o->ordering;
    opts.solver = (hd_solver)o->solver;
    opts.precond = (hd_precond)o->precond;
    opts.poles = (hd_pole_kind)o->poles;
    opts.degree = (int32_t)o->degree;
    opts.rational = o->filter ? &r->filter : NULL;
    opts.tol = o->tol;
    opts.max_iterations = (int32_t)o->max_iterations;
    opts.context = &r->context;
    return hd_heat_create(&r->heat, r->lap, &opts, &err) < 0 ? fail_library(r->mesh_name, &err) : DONE;
}

/* ---- what a run would take ---- */

/* The methods krylov and local take one input after the other, each at all times. Others take one time after
 * the other, each with all inputs. If the method is free, new pole factors for each time cost less once there are
 * about as many inputs as times, but never with many times. Measured on meshes of 12K, 35K and 150K vertices:
 * from 2 to 5 inputs with 4 times, from 8 to 15 inputs with 10. */
static int time_by_time(const run *r, int n_times)
{
    const options *o = r->o;
    if (o->method != HD_METHOD_AUTO) return o->method < HD_METHOD_KRYLOV;
    return o->solver || o->precond || o->degree || o->poles || (n_times <= 16 && r->n_inputs >= n_times);
}

/* Distinct vertices of the pairs. Without memory to tell, all of them count. */
static int32_t pairs_vertices(const run *r)
{
    const int64_t ids = 2 * r->rows;
    char *seen = (char *)calloc((size_t)r->mesh.n + 1, 1);
    int32_t count = 0;
    int64_t i;
    for (i = 0; seen && i < ids; i++)
        if (!seen[r->pairs[i]]++) count++;
    if (!seen) count = ids < r->mesh.n ? (int32_t)ids : r->mesh.n;
    free(seen);
    return count;
}

/* Eigenpairs that are asked for. Below a bound there are about its area / 4 pi many (Weyl 1911). */
static int32_t spectrum_pairs(const run *r)
{
    const double most = r->lap->n_active;
    double pairs = r->o->count > 0 ? (double)r->o->count : most;
    int32_t c;
    if (r->o->below > 0) {
        double area = 0;
        for (c = 0; c < r->lap->n_components; c++) area += r->lap->component_mass[c];
        pairs = fmin(pairs, r->o->below * area / 12.57 + r->lap->n_components);
    }
    return (int32_t)fmax(1, fmin(pairs, most));
}

/* The library's name of the command's query, and how many items it has. */
/* Are signatures divided by the trace? Those of waves always are. */
static int by_trace(const options *o)
{
    return o->normalise || (o->command == CMD_HKS && o->filter_kind == HD_FILTER_WAVE);
}

static hd_query query_of(const run *r, int32_t *k)
{
    const options *o = r->o;
    *k = (int32_t)r->n_inputs;
    if (o->command == CMD_KERNEL) return HD_QUERY_COLUMNS;
    if (o->command == CMD_SPECTRUM) *k = spectrum_pairs(r);
    if (o->command == CMD_SPECTRUM) return HD_QUERY_SPECTRUM;
    if (o->command & (CMD_DIFFUSE | CMD_SMOOTH)) return HD_QUERY_FIELDS;
    if (o->command == CMD_TRACE) return HD_QUERY_TRACE;
    if (by_trace(o)) return HD_QUERY_TRACE;
    if (o->command == CMD_HKS)
        return o->kernel == HD_KERNEL_OPERATOR ? HD_QUERY_DIAGONAL_OPERATOR : HD_QUERY_DIAGONAL;
    if (o->command == CMD_SAMPLE) *k = (int32_t)o->count + (r->places ? (int32_t)r->n_inputs : 0);
    if (o->command == CMD_PAIRS) *k = pairs_vertices(r);
    if (o->command == CMD_PAIRS && !is_timeless(o)) return HD_QUERY_PAIRS;
    return OF_DEFINITION[definition_row(o)].query;
}

/* Each sample waits for those before it. Columns that are solved one by one take this many times as long as
 * those of the batches that estimates are of (measured on meshes of 3K to 43K vertices: 3 to 5). */
static const double ONE_BY_ONE = 4;

/* What the samples of a run take besides. Sums over eigenpairs are one by one in any case. */
static hd_status estimate_samples(const run *r, hd_heat *heat, hd_estimate *e, hd_error *err)
{
    hd_cost *c = &e->cost[HD_METHOD_DIRECT];
    hd_estimate twice;
    int32_t k;
    const hd_query query = query_of(r, &k);
    if (e->method != HD_METHOD_DIRECT || k > INT32_MAX / 2 || strstr(e->reason, "eigenpairs")) return HD_OK;
    if (hd_heat_estimate(heat, query, 1, r->times, 2 * k, &twice, err) < 0) return err->status;
    c->seconds += (ONE_BY_ONE - 1) * (twice.cost[HD_METHOD_DIRECT].seconds - c->seconds);
    e->cost[0] = *c;
    return HD_OK;
}

/* The estimate of the run's first so many times by a plan. */
static hd_status estimate_query(const run *r, hd_heat *heat, int n_times, hd_estimate *e, hd_error *err)
{
    int32_t k;
    const hd_query query = query_of(r, &k);
    /* the tool takes these one by one; the last is the longest of auto:K and what most people write */
    const int single = r->o->command == CMD_PAIRS || (query <= HD_QUERY_COLUMNS && time_by_time(r, n_times));
    const int again = single && n_times > 1;
    const double *t = again ? r->times + n_times - 1 : r->times;     /* NULL for eigenpairs */
    double twice[2];
    hd_estimate two;
    int m;
    if (hd_heat_estimate(heat, query, single ? 1 : n_times, t, k, e, err) < 0) return err->status;
    if (r->o->command == CMD_SAMPLE) return estimate_samples(r, heat, e, err);
    if (!again) return err->status;
    /* while a second time is factorised, work arrays of the first are still there */
    twice[0] = twice[1] = *t;
    if (hd_heat_estimate(heat, query, 2, twice, k, &two, err) < 0) return err->status;
    e->cost[HD_METHOD_DIRECT].bytes = two.cost[HD_METHOD_DIRECT].bytes;
    e->cost[HD_METHOD_DIRECT].bytes_most = two.cost[HD_METHOD_DIRECT].bytes_most;
    for (m = 1; m <= HD_METHOD_LOCAL; m++) {
        e->cost[m].flops *= n_times;
        e->cost[m].seconds *= n_times;
        e->cost[m].fits = e->cost[m].possible && e->cost[m].bytes <= e->bytes_left;
    }
    e->cost[0] = e->cost[e->method];
    return HD_OK;
}

static double bytes_needed(const run *r) { return r->estimate.bytes_in_use + r->estimate.cost[0].bytes; }

/* Notes a way out, if it takes less. */
static void add_way(run *r, const char *option, double bytes, double seconds)
{
    way *w = r->ways + r->n_ways;
    if (r->n_ways == MAX_WAYS || !(bytes < bytes_needed(r))) return;
    snprintf(w->option, sizeof w->option, "%s", option);
    w->bytes = bytes;
    w->seconds = seconds;
    r->n_ways++;
}

/* A way out by other options than the run's: its plan is made and asked. */
static void try_options(run *r, const options *o, const char *option)
{
    run other = *r;
    hd_estimate e;
    hd_error err;
    const int same = o->tufted == r->o->tufted && o->weight_cut == r->o->weight_cut;
    other.o = o;
    memset(&other.context, 0, sizeof other.context);
    other.context.progress = on_progress;
    other.context.n_threads = r->context.n_threads;
    if (!same) other.lap = NULL;
    other.heat = NULL;
    if (!interrupt.asked && (same || run_laplacian(&other, &err) >= 0) && !run_plan(&other)) {
        /* the matrices are the run's own then, and so is the analysis where the run has made one */
        if (estimate_query(&other, other.heat, other.n_times, &e, &err) >= 0)
            add_way(r, option, e.cost[0].bytes + (same ? (double)r->context.bytes_in_use : 0) +
                    (same && r->estimate.analysed ? 0 : e.bytes_in_use), e.cost[0].seconds);
        hd_heat_free(other.heat);
    }
    if (!same) hd_laplacian_free(other.lap);
    interrupt.patient = 1;
}

/* Points by triangles instead of exponential weights, whose many non-zeros in a row fill up the factors. */
static void try_tufted(run *r)
{
    options o = *r->o;
    if (laplacian_kind(r) != HD_LAPLACIAN_VORONOI_EXP) return;
    o.tufted = 1;
    o.laplacian = HD_LAPLACIAN_DEFAULT;
    o.weight_cut = 0;
    o.has_bandwidth = 0;
    try_options(r, &o, "--tufted");
}

/* What else would do for a run that does not fit, each with its need. */
static void find_ways(run *r)
{
    const hd_estimate *e = &r->estimate;
    const hd_cost *iterative = &e->cost[HD_METHOD_ITERATIVE], *krylov = &e->cost[HD_METHOD_KRYLOV];
    const hd_cost *local = &e->cost[HD_METHOD_LOCAL];
    hd_estimate one;
    hd_error err;
    options o = *r->o;
    char fewer[40];
    r->n_ways = 0;
    if (r->o->method != HD_METHOD_ITERATIVE && iterative->possible)
        add_way(r, "--method iterative", e->bytes_in_use + iterative->bytes, iterative->seconds);
    if (r->o->method == HD_METHOD_DIRECT && krylov->possible && !r->o->degree && !r->o->poles)
        add_way(r, "--method krylov", e->bytes_in_use + krylov->bytes, krylov->seconds);
    if (r->o->method != HD_METHOD_LOCAL && local->possible)
        add_way(r, "--method local", e->bytes_in_use + local->bytes, local->seconds);
    if (r->n_times > 1 && estimate_query(r, r->heat, 1, &one, &err) >= 0 &&
        one.cost[0].bytes < 0.95 * e->cost[0].bytes)
        add_way(r, "one time after the other", one.bytes_in_use + one.cost[0].bytes,
                one.cost[0].seconds * r->n_times);
    if (o.degree > 9) {
        o.degree = 8;
        try_options(r, &o, "--degree 8");
    }
    o = *r->o;
    if (r->o->command == CMD_SPECTRUM && o.count >= 8) {
        o.count /= 4;
        snprintf(fewer, sizeof fewer, "-k %ld", o.count);
        try_options(r, &o, fewer);
    }
    o = *r->o;
    o.precond = HD_PRECOND_AUTO;
    o.solver = HD_SOLVER_LANCZOS;
    if (e->method == HD_METHOD_ITERATIVE && !o.degree && !o.poles) try_options(r, &o, "--solver lanczos");
    o = *r->o;
    o.precond = HD_PRECOND_JACOBI;
    if (e->method == HD_METHOD_ITERATIVE && (o.degree || o.poles)) try_options(r, &o, "--precond jacobi");
    try_tufted(r);
    o = *r->o;
    o.weight_cut = WIDER_CUT;
    if (has_exponentials(r) && r->o->weight_cut < WIDER_CUT) try_options(r, &o, "--weight-cut 1e-4");
}

/* Can a run go on patch by patch where factors of the whole mesh do not fit? */
static int by_patches(const options *o)
{
    return (o->command & CMD_INVERTS) && !is_timeless(o) && o->method != HD_METHOD_LOCAL;
}

/* A run that does not fit the memory: what it needs, what is allowed, and what would fit. */
static int fail_limit(run *r, const hd_error *e)
{
    char ways[600] = "";
    hd_error err;
    double allowed = (double)r->context.byte_limit, needed;
    int i;
    if (estimate_query(r, r->heat, r->n_times, &r->estimate, &err) < 0 || r->estimate.cost[0].fits ||
        !r->estimate.cost[0].possible)
        return fail_library(r->mesh_name, e);
    needed = bytes_needed(r);
    needed = needed > e->value ? needed : e->value;
    find_ways(r);
    if (interrupt.asked) return INTERRUPTED;
    for (i = 0; i < r->n_ways; i++)
        snprintf(ways + strlen(ways), sizeof ways - strlen(ways), "%s%s needs %.1f MB%s", i ? ", " : "; ",
                 r->ways[i].option, 1e-6 * r->ways[i].bytes, r->ways[i].bytes > allowed ? " (too much)" : "");
    if (by_patches(r->o)) snprintf(ways + strlen(ways), sizeof ways - strlen(ways), "; --method local needs less");
    return fail(FAILED, "%s: %.1f MB are needed, and %.1f MB are allowed (--memory-limit, by default nine "
                "tenths of the machine's memory)%s", r->mesh_name, 1e-6 * needed, 1e-6 * allowed, ways);
}

/* --dry-run: the estimate, and what else would fit if the run does not. Of points, what triangles would take
 * in any case: often a small part. */
static int dry_run(run *r)
{
    hd_error err;
    const int code = run_plan(r);
    if (code) return code;
    if (estimate_query(r, r->heat, r->n_times, &r->estimate, &err) < 0) return fail_library(r->mesh_name, &err);
    if (!r->estimate.cost[0].fits) find_ways(r);
    else try_tufted(r);
    return interrupt.asked ? INTERRUPTED : DONE;
}

/* Flops per second of real factorisations, and bytes for each vertex, of a plan for geodesic distances. */
static const double GEODESIC_RATE = 25e9, GEODESIC_VERTEX = 430;

/* Options of a factor on the pattern of L. */
static hd_ldl_opts ldl_options(run *r)
{
    hd_ldl_opts opts;
    memset(&opts, 0, sizeof opts);
    opts.ordering = (hd_ordering)r->o->ordering;
    opts.xyz = r->lap->xyz;
    opts.context = &r->context;
    return opts;
}

/* The same of geodesic: two real factors on the pattern of L, or three with the mean border. */
static int dry_run_geodesic(run *r)
{
    hd_cost *c = r->estimate.cost;
    const hd_ldl_opts opts = ldl_options(r);
    hd_ldl_report report;
    hd_ldl *f = NULL;
    hd_error err;
    if (hd_ldl_analyse(&f, &r->lap->L, &opts, &report, &err) < 0) return fail_library(r->mesh_name, &err);
    r->estimate.bytes_in_use = (double)r->context.bytes_in_use;
    hd_ldl_free(f);
    c->possible = r->estimate.analysed = 1;
    c->flops = (r->o->border == HD_GEODESIC_BORDER_MEAN ? 3 : 2) * report.factor_flops + r->n_inputs * 8.0 * (double)report.factor_nnz;
    c->seconds = c->flops / GEODESIC_RATE;
    c->bytes = c->bytes_most = 16.0 * (double)report.stored + GEODESIC_VERTEX * r->lap->n;
    r->estimate.bytes_left = r->context.byte_limit ? (double)r->context.byte_limit - r->estimate.bytes_in_use
                                                   : HUGE_VAL;
    c->fits = c->bytes <= r->estimate.bytes_left;
    r->estimate.method = HD_METHOD_DIRECT;
    r->estimate.reason = "two real factors serve all sources";
    c[HD_METHOD_DIRECT] = c[0];
    return interrupt.asked ? INTERRUPTED : DONE;
}

static double *column_of(const run *r, int q, int k)
{
    return r->values + ((size_t)q * (size_t)r->n_times + (size_t)k) * (size_t)r->rows;
}

/* An error at a point of source q, which the library found; point -1: at none. */
static int fail_source(const run *r, int q, int64_t point, const char *text)
{
    const source_point *p = point < 0 ? NULL : &r->points[r->first[q] + point];
    mio_error e;
    if (!p) return fail(FAILED, "%s: source %d: %s", r->mesh_name, q, text);
    if (!p->line) return fail(FAILED, "%s: source %d, point %lld: %s", r->mesh_name, q, (long long)point, text);
    mio_fail_at(&e, display_name(r->o->source_file), p->line, "%s", text);
    return fail(FAILED, "%s", e.text);
}

static int fail_solve(run *r, hd_report *report, int q)
{
    if (report->status == HD_ERR_MEMORY_LIMIT) return fail_limit(r, &report->error);
    if (r->places && report->status == HD_ERR_ARGUMENT && report->error.column >= 0)
        return fail_source(r, q + (int)report->error.column, report->error.row, report->error.text);
    if (report->error.row >= 0 && report->error.column >= 0) report->error.column += q;
    return fail_library(report->status == HD_ERR_NOT_FINITE && r->fields ? r->field_name : r->mesh_name,
                        &report->error);
}

/* Solves time k for all inputs from q on. */
static int solve_time(run *r, int k, int q)
{
    const size_t n = (size_t)r->mesh.n, stride = n * (size_t)r->n_times;
    const int count = r->n_inputs - q;
    const hd_sources from = run_some(r, q, count);
    hd_report report;
    hd_status status;
    bar_part("time", k, r->n_times);
    if (r->fields)
        status = hd_heat_apply(r->heat, 1, &r->times[k], count, r->fields + (size_t)q * n, n, column_of(r, q, k), stride, &report, NULL);
    else status = hd_heat_columns(r->heat, (hd_kernel)r->o->kernel, 1, &r->times[k], &from, column_of(r, q, k), stride, &report, NULL);
    if (status < 0) return fail_solve(r, &report, q);
    summary_add(&r->sum, &report, &k, 1);
    return DONE;
}

/* Times that are solved together, in the order of the command line. */
typedef struct time_group {
    int n;
    int *index;                      /* [n] numbers of the times */
    double *t;                       /* [n] */
    /* mesh.n x n when their columns do not follow one another in the result, else NULL */
    double *room;
} time_group;

/* Solves all times of the group for input q. */
static int solve_input(run *r, const time_group *g, int q, hd_report *report)
{
    const size_t n = (size_t)r->mesh.n;
    double *out = g->room ? g->room : column_of(r, q, g->index[0]);
    const double *f = r->fields ? r->fields + (size_t)q * n : NULL;
    const hd_sources from = run_some(r, q, 1);
    hd_status status;
    int i;
    bar_part(r->fields ? "field" : "source", q, r->n_inputs);
    if (f) status = hd_heat_apply(r->heat, g->n, g->t, 1, f, n, out, n, report, NULL);
    else status = hd_heat_columns(r->heat, (hd_kernel)r->o->kernel, g->n, g->t, &from, out, n, report, NULL);
    if (status < 0) return fail_solve(r, report, q);
    for (i = 0; g->room && i < g->n; i++)
        memcpy(column_of(r, q, g->index[i]), g->room + (size_t)i * n, n * sizeof *out);
    /* the factor of input 0 served again */
    if (q > 0 && report->method == HD_METHOD_KRYLOV) report->factor_flops = 0;
    summary_add(&r->sum, report, g->index, g->n);
    return DONE;
}

/* If the library chooses the method, its choice for the first input decides the order of the others. */
static int solve_group(run *r, const time_group *g)
{
    int code = DONE, i, q = 0, by_time = g->n == 1 || g->t[0] == 0 || time_by_time(r, g->n);
    hd_report report;
    for (; q < r->n_inputs && !by_time && !code; q++) {
        code = solve_input(r, g, q, &report);
        by_time = report.method < HD_METHOD_KRYLOV;
    }
    for (i = 0; i < g->n && q < r->n_inputs && !code; i++) code = solve_time(r, g->index[i], q);
    return code;
}

/* One factor and basis serve times up to this ratio: a group. With one input the library forms the groups.
 * With several inputs the tool does, and completes one group for all inputs before the next, so that no
 * factor is made twice. */
static const double GROUP_RATIO = 1000;

/* The smallest time above t; HUGE_VAL if there is none. */
static double next_time(const run *r, double t)
{
    double least = HUGE_VAL;
    int k;
    for (k = 0; k < r->n_times; k++)
        if (r->times[k] > t && r->times[k] < least) least = r->times[k];
    return least;
}

/* Fills g with the times in [from, to]. */
static int group_fill(const run *r, time_group *g, double from, double to)
{
    int k;
    g->n = 0;
    for (k = 0; k < r->n_times; k++)
        if (r->times[k] >= from && r->times[k] <= to) {
            g->index[g->n] = k;
            g->t[g->n++] = r->times[k];
        }
    free(g->room);
    g->room = NULL;
    if (g->n == 0 || g->index[g->n - 1] - g->index[0] == g->n - 1) return DONE;
    g->room = new_columns(r->mesh.n, g->n);
    return g->room ? DONE : fail_memory("the result");
}

/* Solves the times 0 first, then groups of ascending times. */
static int solve_groups(run *r, time_group *g)
{
    const double ratio = r->n_inputs > 1 ? GROUP_RATIO : HUGE_VAL;
    double from = 0, to = 0;
    int code = DONE;
    for (; from <= DBL_MAX && !code; from = next_time(r, to), to = from * ratio) {
        code = group_fill(r, g, from, to);
        if (!code && g->n > 0) code = solve_group(r, g);
    }
    return code;
}

static int solve_all(run *r)
{
    time_group g;
    int code;
    memset(&g, 0, sizeof g);
    g.index = (int *)malloc((size_t)r->n_times * sizeof *g.index);
    g.t = (double *)malloc((size_t)r->n_times * sizeof *g.t);
    code = g.index && g.t ? solve_groups(r, &g) : fail_memory("the times");
    free(g.index);
    free(g.t);
    free(g.room);
    return code;
}

/* Records the report of the only call for time k. */
static int solved_time(run *r, int k, hd_status status, hd_report *report)
{
    if (status < 0) return fail_solve(r, report, 0);
    summary_add(&r->sum, report, &k, 1);
    return DONE;
}

/* Parts of a bound that has changed: rounding and what the set is off by, in their shares. */
static void share_bound(hd_report *rep, double bound)
{
    const double before = rep->error_bound, grow = before > 0 && before < HUGE_VAL ? bound / before : 0;
    rep->error_bound = bound;
    rep->error_rational *= grow;
    rep->error_rounding = grow > 0 ? bound - rep->error_rational : bound;
    if (rep->status >= 0) rep->status = bound <= 1e-2 ? HD_OK : HD_WARN_ACCURACY;
}

/* Signatures divided by their traces Z, whose errors are bound: each has the integral 1. */
static void divide_by_traces(run *r, const double *Z, const double *bound, hd_report *rep)
{
    double worst = 0, grow;
    int64_t i;
    int k;
    rep->smallest = HUGE_VAL;
    for (k = 0; k < r->n_times; k++) {
        double *d = r->values + (size_t)k * (size_t)r->mesh.n;
        if (!(bound[k] <= worst * Z[k])) worst = bound[k] < HUGE_VAL ? bound[k] / Z[k] : HUGE_VAL;
        for (i = 0; i < r->mesh.n; i++) {
            d[i] /= Z[k];
            if (d[i] != 0 && fabs(d[i]) < rep->smallest) rep->smallest = fabs(d[i]);
        }
    }
    if (rep->smallest == HUGE_VAL) rep->smallest = 0;
    grow = worst < 0.5 ? 1 / (1 - worst) : HUGE_VAL;
    if (rep->error_relative < HUGE_VAL) rep->error_relative = grow * (rep->error_relative + worst);
    share_bound(rep, grow * (rep->error_bound + worst));
}

/* Signatures that change little if the surface is scaled. Scaling shifts log k_t(v,v) along log t and adds a
 * constant. A derivative in log t removes the constant, and the modulus of a Fourier transform the shift:
 *   |sum_j (log k_(j+1) - log k_j) exp(-2 pi i j q/m)|,  j = 0 .. m - 1,  m = n_times - 1, for each frequency q
 * (Bronstein, Kokkinos 2010, eqs. (10) to (13)). Of one vertex: k [n_times], n apart, into out, n apart. Returns
 * 0, and zeros, if a value has no logarithm. */
static int scale_invariant(const run *r, const double *k, double *step, double *out)
{
    const size_t n = (size_t)r->mesh.n;
    const int m = r->n_times - 1;
    int j, ok = k[0] > 0;
    long q;
    for (j = 0; j < m; j++) {
        const double a = k[(size_t)j * n], b = k[(size_t)(j + 1) * n];
        ok = ok && b > 0;
        step[j] = ok ? log(b) - log(a) : 0;
    }
    for (q = 0; q < r->o->frequencies; q++) {
        double re = 0, im = 0;
        for (j = 0; j < m && ok; j++) {
            const double angle = 6.283185307179586 * (double)((int64_t)j * q % m) / m;
            re += step[j] * cos(angle);
            im -= step[j] * sin(angle);
        }
        out[(size_t)q * n] = hypot(re, im);
    }
    return ok;
}

/* These of all vertices. An error of at most e in each logarithm counts |w^(j-1) - w^j| = 2 sin(pi q/m) for those
 * inside, and 1 for the two at the ends. */
static int solve_invariant(run *r, hd_report *rep)
{
    const int m = r->n_times - 1;
    const double top = (double)(r->o->frequencies - 1) / m;
    double *k = new_columns(r->mesh.n, r->n_times), *step = (double *)malloc((size_t)m * sizeof *step), largest = 0, e;
    int64_t i;
    int code = k && step ? DONE : fail_memory("the signatures"), sure = 1;
    if (!code && hd_heat_diagonal(r->heat, HD_KERNEL_SYMMETRIC, r->n_times, r->times, k, 0, NULL, NULL, rep, NULL) < 0)
        code = fail_solve(r, rep, 0);
    for (i = 0; i < r->mesh.n && !code; i++)
        if (!scale_invariant(r, k + i, step, r->values + i) && r->lap->row[i] >= 0) sure = 0;
    for (i = 0; i < r->mesh.n * r->o->frequencies && !code; i++) if (r->values[i] > largest) largest = r->values[i];
    free(k);
    free(step);
    if (code) return code;
    e = sure && rep->error_relative < 1 ? -log1p(-rep->error_relative) : HUGE_VAL;
    e *= 2 + (m - 1) * 2 * sin(3.141592653589793 * (top < 0.5 ? top : 0.5));
    share_bound(rep, e < HUGE_VAL && largest > 0 ? e / largest + 8 * m * DBL_EPSILON : HUGE_VAL);
    rep->error_relative = HUGE_VAL;
    rep->smallest = 0;
    return DONE;
}

/* Signatures, or distances from all sources, at all times together: many times share their factors and cost
 * little more than one. There is one report for all times. */
static int solve_inverse(run *r)
{
    const options *o = r->o;
    const int trace = o->command == CMD_TRACE, divided = by_trace(o);
    const size_t n_times = (size_t)r->n_times;
    double *Z = trace ? r->values + n_times : divided ? (double *)malloc(2 * n_times * sizeof *Z) : NULL;
    hd_report report;
    hd_status status = HD_OK;
    int code = DONE, k;
    if (divided && !Z) return fail_memory("the traces");
    if (trace) memcpy(r->values, r->times, n_times * sizeof *r->values);
    if (o->frequencies) code = solve_invariant(r, &report);
    else if (trace || o->command == CMD_HKS)
        status = hd_heat_diagonal(r->heat, (hd_kernel)o->kernel, r->n_times, r->times, trace ? NULL : r->values, 0, Z, Z ? Z + n_times : NULL, &report, NULL);
    else status = hd_heat_distance(r->heat, (hd_distance_kind)o->definition, r->n_times, r->times, &r->from, r->values, 0, &report, NULL);
    if (status < 0) code = fail_solve(r, &report, 0);
    else if (!code && divided) divide_by_traces(r, Z, Z + n_times, &report);
    if (!trace) free(Z);
    if (code) return code;
    for (k = 0; k < r->n_times; k++) r->sum.per_time[k] = report;
    summary_add(&r->sum, &report, NULL, 0);
    return DONE;
}

/* Kernel and distance of the pairs at time k, in two columns. Distances without a time have one column. */
static int solve_pairs(run *r, int k)
{
    const options *o = r->o;
    const hd_distance_kind kind = (hd_distance_kind)o->definition;
    const int32_t *i = r->pairs, *j = i + r->rows;
    const int timeless = is_timeless(o);
    double *K = timeless ? NULL : column_of(r, 0, 2 * k), *d = timeless ? r->values : K + r->rows;
    hd_report report;
    int code = solved_time(r, k, hd_heat_distance_pairs(r->heat, kind, 1, &r->times[k], r->rows, i, j, d, &report, NULL), &report);
    keep_larger(&r->bound[1], report.error_bound);
    if (code || timeless) return code;
    code = solved_time(r, k, hd_heat_entries(r->heat, (hd_kernel)o->kernel, 1, &r->times[k], r->rows, i, j, K,
                                             &report, NULL), &report);
    keep_larger(&r->bound[0], report.error_bound);
    return code;
}

/* The given vertices are the first points: distances of each to those before. */
static hd_status solve_given(run *r, int32_t k, hd_report *report)
{
    int32_t *pair = (int32_t *)malloc(2 * (size_t)k * sizeof *pair), p, q;
    double *d = (double *)malloc((size_t)k * sizeof *d);
    hd_status status = k == 0 || (pair && d) ? HD_OK : HD_ERR_MEMORY;
    for (q = 0; q < k && status >= 0; q++) {
        r->values[q] = q ? HUGE_VAL : 0;
        for (p = 0; p < q; p++) {
            pair[p] = r->sources[p];
            pair[k + p] = r->sources[q];
        }
        if (q) status = hd_heat_distance_pairs(r->heat, (hd_distance_kind)r->o->definition, 1, r->times, q, pair, pair + k, d, report, NULL);
        for (p = 0; p < q && status >= 0; p++) if (d[p] < r->values[q]) r->values[q] = d[p];
    }
    free(pair);
    free(d);
    return status;
}

static int solve_sample(run *r)
{
    const int32_t given = r->places ? 0 : r->n_inputs, count = (int32_t)r->o->count - given;
    hd_report report;
    hd_status status;
    memset(&report, 0, sizeof report);
    report.status = status = solve_given(r, given, &report);
    if (status == HD_ERR_MEMORY && report.error.status >= 0) return fail_memory("the points");
    if (status >= 0 && count > 0)
        status = hd_heat_sample(r->heat, (hd_distance_kind)r->o->definition, r->times[0], r->n_inputs ? &r->from : NULL, count,
                                r->sources + given, r->values + given, &report, NULL);
    return solved_time(r, 0, status, &report);
}

static int solve_command(run *r)
{
    const unsigned command = r->o->command;
    int code = DONE, k;
    if (command == CMD_SAMPLE) return solve_sample(r);
    if (command & CMD_INVERTS) return solve_inverse(r);
    if (command != CMD_PAIRS) return solve_all(r);
    for (k = 0; k < r->n_times && !code; k++) {
        bar_part("time", k, r->n_times);
        code = solve_pairs(r, k);
    }
    return code;
}

/* Rows and columns of the result. */
static void run_shape(run *r)
{
    const options *o = r->o;
    if (o->command == CMD_SAMPLE) r->rows = o->count;
    else if (o->command != CMD_PAIRS) r->rows = o->command == CMD_TRACE ? r->n_times : r->mesh.n;
    r->n_columns = o->command == CMD_SAMPLE ? 1
                   : (int64_t)(o->command & (CMD_HKS | CMD_PAIRS) ? 1 : r->n_inputs) * r->n_times;
    if (o->command == CMD_PAIRS && !is_timeless(o)) r->n_columns *= 2;
    if (o->command == CMD_TRACE) r->n_columns = 3;
    if (o->frequencies) r->n_columns = o->frequencies;
}

/* Allocates the result, and checks that it has the column to be shown. */
static int run_columns(run *r)
{
    int64_t shown;
    run_shape(r);
    if (r->n_columns > INT32_MAX / 2)
        return fail(FAILED, "%lld columns are too many", (long long)r->n_columns);
    shown = r->o->nearest ? 2 * (int64_t)r->n_times : r->n_columns;
    if (r->o->column >= shown)
        return fail(FAILED, "--column %ld: the result has %lld columns, numbered from 0", r->o->column,
                    (long long)shown);
    r->values = new_columns(r->rows, r->n_columns);
    return r->values ? DONE : fail_memory("the result");
}

static hd_status geodesic_plan(run *r, hd_geodesic_opts *opts, hd_error *err)
{
    const int poly = !r->lengths && laplacian_kind(r) == HD_LAPLACIAN_POLYGON && !r->places;   /* places lie in triangles */
    const hd_mesh mesh = run_mesh(r, r->mesh.n_tri == 0 ? HD_POINTS : poly ? HD_POLYGONS : HD_TRIANGLES);
    if (!poly) opts->stiffening = 0;
    return hd_geodesic_create(&r->geodesic, &mesh, opts, err);
}

/* Distances from all sources, a column each. */
static int solve_geodesic(run *r)
{
    const options *o = r->o;
    hd_geodesic_opts opts;
    hd_error err;
    memset(&opts, 0, sizeof opts);
    if (!o->times) opts.t_in_h2 = 1;
    else if (o->times[0].unit == TIME_H2) opts.t_in_h2 = o->times[0].value;
    else opts.t = r->times[0];
    if (laplacian_kind(r) == HD_LAPLACIAN_VORONOI_COT) opts.mass = HD_GEODESIC_MASS_VORONOI;
    opts.border = (hd_geodesic_border)o->border;
    opts.triangulation = run_triangulation(r);
    opts.stiffening = o->lambda;
    opts.ordering = (hd_ordering)o->ordering;
    opts.context = &r->context;
    if (geodesic_plan(r, &opts, &err) < 0) return fail_laplacian(r, &err);
    (void)hd_geodesic_distance(r->geodesic, &r->from, r->values, 0, &r->geodesic_report, NULL);
    if (r->places && r->geodesic_report.status == HD_ERR_ARGUMENT)
        return fail_source(r, (int)r->geodesic_report.error.column, r->geodesic_report.error.row,
                           r->geodesic_report.error.text);
    if (r->geodesic_report.status < 0) return fail_library(r->mesh_name, &r->geodesic_report.error);
    r->times[0] = r->geodesic_report.t;          /* h of points is that of their triangles */
    return DONE;
}

/* Eigenpairs, whose vectors are the result. */
static int solve_spectrum(run *r)
{
    hd_spectrum_opts opts;
    hd_error err;
    memset(&opts, 0, sizeof opts);
    if (r->o->count > r->lap->n_active)
        return fail(FAILED, "%s: -k %ld is beyond the mesh, which has %ld vertices with mass", r->mesh_name,
                    r->o->count, (long)r->lap->n_active);
    opts.count = (int32_t)r->o->count;
    opts.below = r->o->below;
    opts.tol = r->o->tol;
    opts.ordering = (hd_ordering)r->o->ordering;
    opts.context = &r->context;
    r->spectrum_status = hd_spectrum_create(&r->spectrum, r->lap, &opts, &err);
    if (r->spectrum_status == HD_ERR_MEMORY_LIMIT) {     /* a plan says what would do */
        const int code = run_plan(r);
        return code ? code : fail_limit(r, &err);
    }
    if (r->spectrum_status < 0) return fail_library(r->mesh_name, &err);
    r->n_columns = r->spectrum->count;
    if (r->n_columns == 0)                       /* the border is held at zero, or constants would be one */
        return fail(FAILED, "%s: no eigenvalue is below %g: the smallest is at least %.6g", r->mesh_name,
                    r->o->below, r->spectrum->next);
    if (r->o->column < r->n_columns) return DONE;
    return fail(FAILED, "--column %ld: the result has %lld columns, numbered from 0", r->o->column,
                (long long)r->n_columns);
}

/* From a column for each source to the nearest source, by its place in --source, and its distance; -1 where
 * none can be reached. Of equal ones the first. */
static int fold_nearest(run *r)
{
    double *out = new_columns(r->rows, 2 * (int64_t)r->n_times);
    int64_t i;
    int k, q;
    if (!out) return fail_memory("the result");
    for (k = 0; k < r->n_times; k++) {
        double *id = out + 2 * (int64_t)k * r->rows, *d = id + r->rows;
        for (i = 0; i < r->rows; i++) {
            id[i] = -1;
            d[i] = HUGE_VAL;
            for (q = 0; q < r->n_inputs; q++) {
                const double x = column_of(r, q, k)[i];
                if (!(x < d[i])) continue;
                d[i] = x;
                id[i] = q;
            }
        }
    }
    free(r->values);
    r->values = out;
    r->n_columns = 2 * (int64_t)r->n_times;
    return DONE;
}

/* From a column for each source to the rows of the sources, with the mean of both directions: bits are the
 * same on both sides of the diagonal. */
static int fold_matrix(run *r)
{
    const int64_t n = r->n_inputs;
    double *out = new_columns(n, r->n_columns);
    int64_t i, j;
    int k;
    if (!out) return fail_memory("the result");
    for (k = 0; k < r->n_times; k++)
        for (j = 0; j < n; j++)
            for (i = 0; i < n; i++) {
                const double a = column_of(r, (int)j, k)[r->sources[i]];
                const double b = column_of(r, (int)i, k)[r->sources[j]];
                out[(j * r->n_times + k) * n + i] = i == j ? 0 : a / 2 + b / 2;
                if (isfinite(a - b) && fabs(a - b) > r->asymmetry) r->asymmetry = fabs(a - b);
            }
    free(r->values);
    r->values = out;
    r->rows = n;
    return DONE;
}

/* Leaves the plan in r->heat for further questions. */
static int run_solve(run *r)
{
    int code = r->o->dry_run || r->o->command == CMD_SPECTRUM ? DONE : run_columns(r);
    if (code) return code;
    interrupt.patient = 1;
    stages_start();
    if (r->o->dry_run) code = r->o->command == CMD_GEODESIC ? dry_run_geodesic(r) : dry_run(r);
    else if (r->o->command == CMD_GEODESIC) code = solve_geodesic(r);
    else if (r->o->command == CMD_SPECTRUM) code = solve_spectrum(r);
    else {
        code = run_plan(r);
        if (!code) code = solve_command(r);
    }
    stages_stop();
    r->sec.assemble += stages.spent[STAGE_ASSEMBLE];
    memcpy(r->sec.stage, stages.spent, sizeof r->sec.stage);
    if (!code && !r->o->dry_run && r->o->nearest) code = fold_nearest(r);
    if (!code && !r->o->dry_run && r->o->matrix) code = fold_matrix(r);
    code = leave_computation(code);
    bar_part("", 0, 0);
    bar_hide();
    return code;
}

/* ---- report ---- */

static void json_seconds(json *j, const run *r)
{
    json inner;
    int i;
    json_key(j, "seconds");
    json_open(&inner, j->out);
    json_number(&inner, "load", r->sec.load);
    json_number(&inner, "assemble", r->sec.assemble);
    for (i = 0; i < N_STAGES; i++) json_number(&inner, STAGE_NAMES[i], r->sec.stage[i]);
    json_number(&inner, "write", r->sec.write);
    json_number(&inner, "total", now() - r->started);
    json_close(&inner);
}

static void json_begin(json *j, const run *r, FILE *out)
{
    char version[32];
    snprintf(version, sizeof version, "%d.%d.%d", HD_VERSION_MAJOR, HD_VERSION_MINOR, HD_VERSION_PATCH);
    json_open(j, out);
    json_text(j, "command", command_name(r->o->command));
    json_text(j, "version", version);
    json_text(j, "mesh", r->mesh_name);
    json_text(j, "format", r->mesh.file.format);
    json_integer(j, "n", r->mesh.n);
    json_integer(j, "faces", r->mesh.n_faces);
    if (r->lengths) json_text(j, "lengths", r->o->lengths);
    if (r->o->matrix) json_number(j, "asymmetry", r->asymmetry);
}

static void json_end(json *j, const run *r)
{
    json_integer(j, "threads", threads_used(r));
    json_integer(j, "peak_bytes", (int64_t)r->context.bytes_peak);
    json_seconds(j, r);
    json_close(j);
    fputc('\n', j->out);
}

static void json_points(json *j, const hd_point_report *p)
{
    json_integer(j, "neighbours", p->neighbours);
    json_integer(j, "coincident", p->n_coincident);
    json_integer(j, "not_flat", p->n_not_flat);
    if (!(p->bandwidth2 > 0)) return;             /* the rest is of exponential weights */
    json_number(j, "bandwidth", p->bandwidth2);
    json_number(j, "weight_cut", p->weight_cut);
    json_number(j, "cut_radius", p->cut_radius);
    json_integer(j, "isolated", p->n_isolated);
    json_integer(j, "without_area", p->n_no_area);
    json_integer(j, "border_points", p->n_border);
    json_integer(j, "most_in_row", p->most_in_row);
}

static const double DEGREES = 57.29577951308232;

/* What --intrinsic-delaunay or --tufted did; nothing without them. */
static void json_intrinsic(json *j, const run *r, const hd_mesh_report *m)
{
    if (!r->o->intrinsic_delaunay && !r->o->tufted) return;
    json_text(j, "intrinsic", r->o->tufted ? "tufted" : "delaunay");
    json_integer(j, "sheets", m->n_sheets);
    json_integer(j, "flips", m->n_flips);
    json_integer(j, "not_delaunay_edges", m->n_not_delaunay);
    json_integer(j, "self_edges", m->n_self_edges);
    json_integer(j, "mollified_faces", m->n_mollified);
    json_number(j, "mollify_epsilon", m->mollify_epsilon);
    json_number(j, "smallest_intrinsic_angle", m->smallest_intrinsic_angle * DEGREES);
}

static void json_laplacian(json *j, const hd_laplacian *lap)
{
    json_integer(j, "components", lap->n_components);
    json_number(j, "h", lap->h);
    json_number(j, "area", lap->area);
    json_integer(j, "inert", lap->mesh.n_inert);
    json_integer(j, "held", lap->n_held);
    json_text(j, "laplacian", word_of(LAPLACIANS, (int)lap->kind));
    if (lap->points.neighbours) json_points(j, &lap->points);
}

/* Fill, flops and growth of the factorisations, and of local the most vertices that one had, and patches; zeros
 * if there are none. */
static void json_factor(json *j, const hd_report *p)
{
    json_integer(j, "factor_nnz", p->factor_nnz);
    json_number(j, "factor_flops", p->factor_flops);
    json_number(j, "growth", p->growth);
    json_integer(j, "touched", p->n_touched);
    json_integer(j, "patches", p->n_patches);
}

static const char *const EVIDENCE[] = {"none", "proven", "measured", "estimated"};    /* by hd_evidence */

/* The bound, its parts, and how each is known. */
static void json_errors(json *j, const hd_report *p)
{
    json inner;
    json_number(j, "residual", p->residual);
    json_number(j, "error_bound", p->error_bound);
    json_number(j, "error_rational", p->error_rational);
    json_number(j, "error_solver", p->error_solver);
    json_number(j, "error_rounding", p->error_rounding);
    json_number(j, "error_local", p->error_local);
    json_number(j, "error_bound_b", p->error_bound_b);
    json_key(j, "evidence");
    json_open(&inner, j->out);
    json_text(&inner, "rational", EVIDENCE[p->evidence_rational]);
    json_text(&inner, "solver", EVIDENCE[p->evidence_solver]);
    json_text(&inner, "rounding", EVIDENCE[p->evidence_rounding]);
    json_text(&inner, "local", EVIDENCE[p->evidence_local]);
    json_close(&inner);
}

/* Of diagonals and distances. */
static void json_values(json *j, const hd_report *p)
{
    json_number(j, "error_relative", p->error_relative);
    json_number(j, "smallest", p->smallest);
    json_integer(j, "lost", p->n_lost);
}

/* A distance without a time and a filter have NaN as their time, which is written as null. */
static void json_time(FILE *out, double t, const hd_report *p)
{
    json j;
    json_open(&j, out);
    json_number(&j, "t", t);
    json_text(&j, "method", word_of(METHODS, (int)p->method));
    json_text(&j, "reason", p->reason);
    json_text(&j, "solver", solver_name(p));
    json_text(&j, "precond", precond_name(p));
    json_text(&j, "poles", poles_name(p));
    json_integer(&j, "degree", p->degree);
    json_integer(&j, "iterations", p->iterations);
    json_text(&j, "ordering", ordering_name(p));
    json_factor(&j, p);
    json_errors(&j, p);
    json_number(&j, "mass_drift", p->mass_drift);
    json_values(&j, p);
    json_text(&j, "status", hd_status_name(p->status));
    json_close(&j);
}

/* Vertices by their ids, other sources as they were written. */
static void json_sources(json *j, const run *r)
{
    if (!r->places) json_integers(j, "sources", r->o->sources, r->o->n_sources);
    if (r->places && r->o->source_text) json_text(j, "source", r->o->source_text);
    if (r->places && r->o->source_file) json_text(j, "source_file", r->o->source_file);
    if (r->places) json_integer(j, "curve", r->o->curve);
}

/* What the command asked for. */
static void json_query(json *j, const run *r)
{
    const options *o = r->o;
    if (!(o->command & (CMD_DISTANCE | CMD_SAMPLE | CMD_TRACE | CMD_SPECTRUM)))
        json_text(j, "kernel", word_of(KERNELS, o->kernel));
    if (o->command & CMD_METRIC) json_text(j, "definition", word_of(DEFINITIONS, o->definition));
    if (r->sources) json_sources(j, r);
    else if (o->input) json_text(j, "input", o->input);
    if (o->command == CMD_PAIRS) json_integer(j, "pairs", r->rows);
    if (o->command == CMD_PAIRS && !o->dry_run) {
        if (!is_timeless(o)) json_number(j, "kernel_bound", r->bound[0]);
        json_number(j, "distance_bound", r->bound[1]);
    }
    if (o->command == CMD_SAMPLE) json_integer(j, "count", r->rows);
    if (o->filter) {
        json_text(j, "filter", o->filter);
        json_number(j, "filter_error", r->filter.max_error / r->filter.largest);
    }
    if (o->command == CMD_SMOOTH && !o->dry_run) {
        json_number(j, "moved_mean", r->moved[0]);
        json_number(j, "moved_most", r->moved[1]);
        json_number(j, "coordinate_error", r->off);
    }
    json_numbers(j, "times", r->times, o->filter || is_timeless(o) ? 0 : r->n_times);
}

static void json_heat(json *j, const run *r)
{
    const hd_report *w = &r->sum.worst;
    int k;
    json_intrinsic(j, r, &r->lap->mesh);
    json_text(j, "method", method_text(&r->sum));
    json_text(j, "reason", reason_text(&r->sum));
    json_text(j, "solver", or_none(&r->sum.solver));
    json_text(j, "precond", or_none(&r->sum.precond));
    json_text(j, "poles", or_none(&r->sum.poles));
    json_integer(j, "degree", w->degree);
    json_query(j, r);
    json_integer(j, "iterations", w->iterations);
    json_integers(j, "pole_iterations", w->pole_iterations, w->n_poles);
    json_text(j, "ordering", or_none(&r->sum.ordering));
    json_factor(j, w);
    json_errors(j, w);
    json_number(j, "mass_drift", w->mass_drift);
    json_values(j, w);
    json_text(j, "status", hd_status_name(w->status));
    json_key(j, "per_time");
    fputc('[', j->out);
    for (k = 0; k < r->n_times; k++) {
        if (k) fprintf(j->out, ", ");
        json_time(j->out, r->o->filter || is_timeless(r->o) ? (double)NAN : r->times[k], &r->sum.per_time[k]);
    }
    fputc(']', j->out);
}

/* What the method did: fill and work of its factorisations, poles, iterations. */
static void print_method(const run *r)
{
    const hd_report *w = &r->sum.worst;
    const double rows = w->n_touched > 0 ? w->n_touched : r->lap->n_active;
    fprintf(stderr, "method %s (%s)\n", method_text(&r->sum), reason_text(&r->sum));
    if (w->n_patches > 0) fprintf(stderr, "%ld patch%s, ", (long)w->n_patches, w->n_patches > 1 ? "es" : "");
    if (w->n_touched > 0)
        fprintf(stderr, "parts of at most %ld of %ld vertices\n", (long)w->n_touched, (long)r->lap->n_active);
    if (w->factor_nnz > 0)
        fprintf(stderr, "factors: %.3g non-zeros, %.3g a row; %.3g flops, growth %.3g, ordering %s\n",
                (double)w->factor_nnz, (double)w->factor_nnz / rows, w->factor_flops, w->growth,
                or_none(&r->sum.ordering));
    fprintf(stderr, "solver %s, preconditioner %s, poles %s, degree %ld, %lld iterations\n",
            or_none(&r->sum.solver), or_none(&r->sum.precond), or_none(&r->sum.poles), (long)w->degree,
            (long long)w->iterations);
}

static void print_seconds(const run *r)
{
    int i;
    fprintf(stderr, "%.3g s: load %.3g, assemble %.3g", now() - r->started, r->sec.load, r->sec.assemble);
    for (i = 0; i < N_STAGES; i++)
        if (r->sec.stage[i] > 0) fprintf(stderr, ", %s %.3g", STAGE_NAMES[i], r->sec.stage[i]);
    fprintf(stderr, ", write %.3g; %.1f MB, %d thread%s\n", r->sec.write,
            (double)r->context.bytes_peak / 1048576.0, threads_used(r), plural(threads_used(r)));
}

static void print_surface(const run *r)
{
    const hd_laplacian *lap = r->lap;
    fprintf(stderr, "%s: %ld vertices, %ld faces, %ld component%s, h = %.4g, area = %.4g", r->mesh_name,
            (long)r->mesh.n, (long)r->mesh.n_faces, (long)lap->n_components, plural(lap->n_components),
            lap->h, lap->area);
    if (lap->mesh.n_inert) fprintf(stderr, ", %ld without area", (long)lap->mesh.n_inert);
    if (lap->n_held) fprintf(stderr, ", %ld held at zero", (long)lap->n_held);
    fprintf(stderr, "\n");
}

/* "1 source, 2 times, classical, fem Laplacian" */
static void print_query(const run *r)
{
    const options *o = r->o;
    if (o->command & (CMD_PAIRS | CMD_SAMPLE))
        fprintf(stderr, "%lld %s%s, ", (long long)r->rows, o->command == CMD_PAIRS ? "pair" : "point",
                plural(r->rows));
    else if (!(o->command & (CMD_HKS | CMD_TRACE | CMD_SMOOTH)))
        fprintf(stderr, "%d %s%s, ", r->n_inputs, r->sources ? "source" : "field", plural(r->n_inputs));
    if (o->filter)
        fprintf(stderr, "filter %s to %.1e of its largest value, ", o->filter,
                r->filter.max_error / r->filter.largest);
    else if (o->command == CMD_SMOOTH)
        fprintf(stderr, "vertices moved by %.3g on average, %.3g at most, t = %s, ", r->moved[0], r->moved[1],
                r->time_names[0]);
    else if (!is_timeless(o)) fprintf(stderr, "%d time%s, ", r->n_times, plural(r->n_times));
    if (o->command & CMD_METRIC) fprintf(stderr, "%s, ", word_of(DEFINITIONS, o->definition));
    fprintf(stderr, "%s Laplacian%s%s", word_of(LAPLACIANS, (int)r->lap->kind),
            o->tufted ? ", tufted" : o->intrinsic_delaunay ? ", intrinsic Delaunay" : "",
            r->lengths ? ", from lengths of edges" : "");
}

/* What the operator made of triangles or points. */
static void print_laplacian(const run *r)
{
    const hd_laplacian *lap = r->lap;
    if (lap->mesh.n_sheets)
        fprintf(stderr,
                "%lld edges flipped on %ld sheet%s, all lengthened by %.2g, %lld negative weights left\n",
                (long long)lap->mesh.n_flips, (long)lap->mesh.n_sheets, plural(lap->mesh.n_sheets),
                lap->mesh.mollify_epsilon, (long long)lap->mesh.n_negative_weights);
    if (lap->points.bandwidth2 > 0)
        fprintf(stderr, "bandwidth %.4g (%.3gh2%s), weights up to a distance of %.4g, %.3g a row\n",
                lap->points.bandwidth2,
                lap->points.bandwidth2 / (lap->h * lap->h), r->o->has_bandwidth ? "" : ", from the sampling",
                lap->points.cut_radius, (double)lap->L.nnz / lap->n_active);
}

/* The bound. Kernel and distance of pairs have one each. */
static void print_bound(const run *r)
{
    if (r->o->command == CMD_PAIRS && !is_timeless(r->o))
        fprintf(stderr, "error of K at most %.1e of its largest value, of d at most %.1e of its largest",
                r->bound[0], r->bound[1]);
    else if (r->o->command == CMD_SMOOTH) fprintf(stderr, "each coordinate is off by at most %.1e", r->off);
    else fprintf(stderr, "error at most %.1e of the largest value", r->sum.worst.error_bound);
}

/* Distances get their relative error and smallest value; columns get the conservation of heat. */
static void print_errors(const run *r)
{
    const hd_report *w = &r->sum.worst;
    print_bound(r);
    if (w->evidence_b == HD_EVIDENCE_NONE)
        fprintf(stderr, ", %.1e of each; the smallest is %.4g\n", w->error_relative, w->smallest);
    else {
        if (r->o->command != CMD_PAIRS) fprintf(stderr, " (%.1e in the B norm)", w->error_bound_b);
        if (r->o->filter || w->n_touched > 0) fprintf(stderr, "\n");
        else if (r->lap->conserves == 1) fprintf(stderr, ", heat conserved to %.1e\n", w->mass_drift);
        else fprintf(stderr, ", heat leaves at the border\n");
    }
}

/* What is wrong with the answers. */
static void print_notes(const run *r)
{
    const hd_report *w = &r->sum.worst;
    if (w->evidence_b == HD_EVIDENCE_NONE && w->n_lost)
        fprintf(stderr, "note: %lld distances are error for the most part, "
                "far smaller than what they are the difference of; pairs finds them\n",
                (long long)w->n_lost);
    if (w->status == HD_WARN_ACCURACY) fprintf(stderr, "note: %s\n", hd_status_text(w->status));
}

/* "; 0.31 s, 45.1 MB", the end of the second line. */
static void print_total(const run *r)
{
    fprintf(stderr, "; %.3g s, %.1f MB\n", now() - r->started, (double)r->context.bytes_peak / 1048576.0);
}

/* "kernel of bunny.obj: ", the beginning of the first line. */
static void print_subject(const run *r)
{
    fprintf(stderr, "%s of %s: ", command_name(r->o->command), r->mesh_name);
}

static void print_heat(const run *r)
{
    if (r->o->verbose) {
        print_surface(r);
        fprintf(stderr, "%s: ", command_name(r->o->command));
        print_query(r);
        fprintf(stderr, "\n");
        print_laplacian(r);
        print_method(r);
        print_errors(r);
        print_notes(r);
        print_seconds(r);
        return;
    }
    print_subject(r);
    print_query(r);
    fprintf(stderr, ", method %s\n", method_text(&r->sum));
    print_bound(r);
    print_total(r);
    print_notes(r);
}

/* As JSON or for people; more: what comes after the Laplacian. An estimate is all that its run makes. */
static void report(const run *r, void (*more)(json *, const run *), void (*print)(const run *))
{
    json j;
    if (r->o->json) {
        json_begin(&j, r, r->o->dry_run ? stdout : stderr);
        json_laplacian(&j, r->lap);
        more(&j, r);
        json_end(&j, r);
    } else if (!r->o->quiet) print(r);
}

static void report_heat(const run *r) { report(r, json_heat, print_heat); }

/* ---- of --dry-run ---- */

static void json_cost(json *j, const char *name, const run *r, const hd_cost *c)
{
    json inner;
    json_key(j, name);
    json_open(&inner, j->out);
    json_number(&inner, "flops", c->flops);
    json_number(&inner, "seconds", c->seconds);
    json_number(&inner, "bytes", r->estimate.bytes_in_use + c->bytes);
    json_number(&inner, "bytes_most", r->estimate.bytes_in_use + c->bytes_most);
    json_key(&inner, "fits");
    fputs(c->fits ? "true" : "false", inner.out);
    json_close(&inner);
}

static void json_estimate(json *j, const run *r)
{
    const hd_estimate *e = &r->estimate;
    json inner;
    int m;
    json_key(j, "dry_run");
    fputs("true", j->out);
    json_text(j, "method", word_of(METHODS, (int)e->method));
    json_text(j, "reason", e->reason);
    json_key(j, "analysed");
    fputs(e->analysed ? "true" : "false", j->out);
    json_cost(j, "estimate", r, &e->cost[0]);
    json_number(j, "bytes_in_use", e->bytes_in_use);
    json_number(j, "bytes_allowed", r->context.byte_limit ? (double)r->context.byte_limit : (double)NAN);
    json_key(j, "methods");
    json_open(&inner, j->out);
    for (m = HD_METHOD_AUTO + 1; m <= HD_METHOD_LOCAL; m++)
        if (e->cost[m].possible) json_cost(&inner, word_of(METHODS, m), r, &e->cost[m]);
    json_close(&inner);
    json_key(j, "ways_out");
    json_open(&inner, j->out);
    for (m = 0; m < r->n_ways; m++) json_number(&inner, r->ways[m].option, r->ways[m].bytes);
    json_close(&inner);
    json_query(j, r);
}

static void print_cost(const run *r, const char *name, const hd_cost *c)
{
    printf("%-10s %9.3g flops, %8.3g s, %9.1f MB%s\n", name, c->flops, c->seconds,
            1e-6 * (r->estimate.bytes_in_use + c->bytes), c->fits ? "" : ", too much");
}

static void print_estimate(const run *r)
{
    const hd_estimate *e = &r->estimate;
    const hd_cost *c = &e->cost[0];
    int m;
    printf("dry run: method %s (%s)\n", word_of(METHODS, (int)e->method), e->reason);
    printf("%s: %.3g flops, about %.3g s on one core\n",
            e->analysed ? "by the analysis of the pattern" : "guessed before the analysis of the pattern",
            c->flops, c->seconds);
    printf("memory at the peak %.1f MB, of which %.1f MB are in use now", 1e-6 * bytes_needed(r),
            1e-6 * e->bytes_in_use);
    if (r->context.byte_limit) printf("; allowed %.1f MB", 1e-6 * (double)r->context.byte_limit);
    printf(c->fits ? "\n" : ": too much\n");
    if (!c->fits && by_patches(r->o)) printf("--method local needs less; auto goes on by it on large meshes\n");
    if (c->bytes_most > c->bytes)
        printf("with poles of degree 14, if they are needed, %.1f MB\n",
                1e-6 * (e->bytes_in_use + c->bytes_most));
    for (m = HD_METHOD_AUTO + 1; m <= HD_METHOD_LOCAL; m++)
        if (e->cost[m].possible && r->o->command != CMD_GEODESIC) print_cost(r, word_of(METHODS, m), &e->cost[m]);
    for (m = 0; m < r->n_ways; m++)
        printf("%s needs %.1f MB and about %.3g s\n", r->ways[m].option, 1e-6 * r->ways[m].bytes,
                r->ways[m].seconds);
}

static void report_estimate(const run *r) { report(r, json_estimate, print_estimate); }

/* ---- of geodesic ---- */

/* Distances that are infinite, in all columns. */
static int64_t count_unreached(const run *r)
{
    int64_t i, count = 0;
    for (i = 0; i < r->n_columns * r->rows; i++) count += !isfinite(r->values[i]);
    return count;
}

static void json_geodesic(json *j, const run *r)
{
    const hd_geodesic_report *g = &r->geodesic_report;
    json_text(j, "method", "direct");
    json_sources(j, r);
    json_numbers(j, "times", r->times, r->n_times);
    json_text(j, "ordering", word_of(ORDERINGS, (int)g->ordering));
    json_integer(j, "factor_nnz", g->factor_nnz);
    json_number(j, "factor_flops", g->factor_flops);
    json_number(j, "residual", g->residual_heat > g->residual_distance ? g->residual_heat
                : g->residual_distance);
    json_number(j, "residual_heat", g->residual_heat);
    json_number(j, "residual_distance", g->residual_distance);
    json_number(j, "edge", g->h);
    json_text(j, "border", word_of(GEODESIC_BORDERS, r->o->border));
    json_integer(j, "stages", g->n_stages);
    json_integer(j, "unreached", count_unreached(r));
    json_text(j, "status", hd_status_name(g->status));
}

static void print_geodesic(const run *r)
{
    const hd_geodesic_report *g = &r->geodesic_report;
    const int64_t unreached = count_unreached(r);
    const int full = r->o->verbose;
    if (full) print_surface(r);
    if (full) fprintf(stderr, "geodesic: ");
    else print_subject(r);
    fprintf(stderr, "%d source%s, t = %.4g (%.4g h^2)\n", r->n_inputs, plural(r->n_inputs), g->t,
            g->t / (g->h * g->h));
    if (full)
        fprintf(stderr, "%s factors: %.3g non-zeros each; %.3g flops, ordering %s\n",
                r->o->border == HD_GEODESIC_BORDER_MEAN ? "three" : "two", (double)g->factor_nnz,
                g->factor_flops, word_of(ORDERINGS, (int)g->ordering));
    fprintf(stderr, "residuals %.1e and %.1e", g->residual_heat, g->residual_distance);
    if (full) fprintf(stderr, ", heat followed in %ld stage%s\n", (long)g->n_stages, plural(g->n_stages));
    else print_total(r);
    if (unreached)
        fprintf(stderr, "note: %lld distance%s infinite: nothing leads there\n", (long long)unreached,
                unreached == 1 ? " is" : "s are");
    if (g->status == HD_WARN_ACCURACY) fprintf(stderr, "note: %s\n", hd_status_text(g->status));
    if (full) print_seconds(r);
}

static void report_geodesic(const run *r) { report(r, json_geodesic, print_geodesic); }

/* ---- of spectrum ---- */

static void json_spectrum(json *j, const run *r)
{
    const hd_spectrum *s = r->spectrum;
    json_intrinsic(j, r, &r->lap->mesh);
    json_text(j, "method", "direct");
    json_integer(j, "count", s->count);
    json_numbers(j, "eigenvalues", s->value, s->count);
    json_numbers(j, "residuals", s->residual, s->count);
    json_number(j, "residual", s->largest_residual);
    json_integer(j, "proven", s->proven);
    json_number(j, "next", s->next);
    json_number(j, "shift", s->shift);
    json_number(j, "shift_margin", s->shift_margin);
    json_integer(j, "factorisations", s->n_factors);
    json_integer(j, "runs", s->n_runs);
    json_integer(j, "solves", s->n_solves);
    json_text(j, "ordering", word_of(ORDERINGS, (int)s->ordering));
    json_integer(j, "factor_nnz", s->factor_nnz);
    json_number(j, "factor_flops", s->factor_flops);
    json_text(j, "status", hd_status_name(r->spectrum_status));
}

static void print_spectrum(const run *r)
{
    const hd_spectrum *s = r->spectrum;
    const char *proven = s->proven ? "proven complete" : "NOT proven complete";
    const int full = r->o->verbose;
    if (full) print_surface(r);
    else print_subject(r);
    fprintf(stderr, "%ld eigenvalue%s from %.6g to %.6g, largest residual %.1e\n", (long)s->count,
            plural(s->count), s->value[0], s->value[s->count - 1], s->largest_residual);
    fprintf(stderr, "%s: all others are at least %.6g", proven, s->next);
    if (full)
        fprintf(stderr, "\n%ld factorisations, %ld runs, %lld solves; factor: %.3g non-zeros, ordering %s\n",
                (long)s->n_factors, (long)s->n_runs, (long long)s->n_solves, (double)s->factor_nnz,
                word_of(ORDERINGS, (int)s->ordering));
    else print_total(r);
    if (s->proven && r->spectrum_status == HD_WARN_ACCURACY)
        fprintf(stderr, "note: residuals are above the tolerance\n");
    if (full) print_seconds(r);
}

static void report_spectrum(const run *r) { report(r, json_spectrum, print_spectrum); }

/* ==== pictures ==== */

enum { PICTURE_WIDTH = 1200, PICTURE_HEIGHT = 900, LOG_DECADES = 6 };

/* The renderer's options from those of the command line. */
static pic_opts picture_opts(const options *o)
{
    pic_opts p;
    memset(&p, 0, sizeof p);
    p.width = o->width ? (int32_t)o->width : PICTURE_WIDTH;
    p.height = o->height ? (int32_t)o->height : PICTURE_HEIGHT;
    p.log_decades = o->log_scale ? LOG_DECADES : 0;
    if (o->has_range) { p.lo = o->low; p.hi = o->high; }
    p.isolines = o->has_isolines ? (o->isolines > 0 ? (int32_t)o->isolines : -1) : 0;
    p.colormap = o->colormap;
    p.up = o->up;
    p.view_given = o->has_view;
    p.azimuth = o->azimuth;
    p.elevation = o->elevation;
    return p;
}

static pic_panel picture_panel(const mesh_data *mesh, const double *field)
{
    pic_panel p;
    memset(&p, 0, sizeof p);
    p.n = mesh->n;
    p.n_tri = mesh->n_tri;
    p.xyz = mesh->xyz;
    p.tri = mesh->tri;
    p.field = field;
    return p;
}

/* One more than the largest label. */
static int32_t count_labels(const pic_panel *panels, int n_panels)
{
    double most = 0;
    int32_t i;
    int k;
    for (k = 0; k < n_panels; k++)
        for (i = 0; i < panels[k].n; i++)
            if (isfinite(panels[k].field[i])) keep_larger(&most, panels[k].field[i]);
    return (int32_t)most + 1;
}

/* Heat is never negative, but computed heat can be slightly negative because of rounding. Colours then begin
 * at 0, because otherwise the isoline of 0 would run through noise. */
static void picture_from_zero(pic_opts *opts, const pic_panel *panels, int n_panels)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    int32_t i;
    int k;
    if (opts->lo < opts->hi || opts->log_decades > 0 || opts->labels) return;
    for (k = 0; k < n_panels; k++)
        for (i = 0; i < panels[k].n; i++) {
            const double x = panels[k].field[i];
            if (isfinite(x) && x < low) low = x;
            if (isfinite(x) && x > high) high = x;
        }
    if (low < 0 && -low < 1e-4 * high) {
        opts->lo = 0;
        opts->hi = high;
    }
}

static int write_picture(const char *path, const pic_panel *panels, int n_panels, const pic_opts *opts)
{
    pic_image image;
    mio_file *file = (mio_file *)malloc(sizeof *file);      /* its buffer is large for a stack */
    mio_error e;
    uint8_t *data = NULL;
    size_t size = 0;
    int status = file ? pic_render_grid(&image, panels, n_panels, opts) : PIC_ERR_MEMORY;
    if (status == PIC_OK) {
        status = pic_png_encode(&data, &size, image.rgb, image.width, image.height);
        pic_image_free(&image);
    }
    if (status != PIC_OK) {
        free(file);
        return fail_memory("the picture");
    }
    if (mio_file_open(file, path, NULL, &e) == MIO_OK) mio_file_put(file, data, size);
    status = mio_file_close(file);
    free(file);
    free(data);
    return status < 0 ? fail_file(&e) : DONE;
}

/* ==== results ==== */

/* Columns on the vertices of the run's mesh, as they are written. */
typedef struct result {
    int64_t n_columns;
    const double *values;            /* column-major */
    const char *const *names;        /* one word per column */
    const char *comment;             /* first line of text, or NULL */
    int64_t colour;                  /* the column that colours .ply, .obj and .png */
} result;

static const double *result_column(const run *r, const result *res, int64_t c)
{
    return res->values + (size_t)c * (size_t)r->mesh.n;
}

/* The renderer's options for a column of the run's result. */
static pic_opts result_opts(const run *r)
{
    pic_opts opts = picture_opts(r->o);
    if (!r->o->nearest || !shows_labels(r->o)) return opts;
    opts.labels = r->n_inputs;
    opts.label = "source";
    return opts;
}

/* Colours by the same scale as pictures. rgb: three bytes per vertex. */
static uint8_t *result_colours(const run *r, const result *res)
{
    pic_panel panel = picture_panel(&r->mesh, result_column(r, res, res->colour));
    const pic_opts opts = result_opts(r);
    pic_scale scale;
    uint8_t *rgb = (uint8_t *)malloc((size_t)r->mesh.n * 3 + 1);
    int32_t i;
    if (!rgb) return NULL;
    pic_scale_make(&scale, &panel, 0, 1, &opts);
    for (i = 0; i < r->mesh.n; i++) {
        const double s = pic_scale_at(&scale, panel.field[i]);
        if (opts.labels && isfinite(s)) pic_label_colour((int32_t)panel.field[i], rgb + 3 * (size_t)i);
        else pic_colormap(s, rgb + 3 * (size_t)i, opts.colormap);
    }
    return rgb;
}

static int write_table(const char *path, int kind, const run *r, const result *res)
{
    mio_output out;
    mio_error e;
    uint8_t *rgb = NULL;
    int status;
    memset(&out, 0, sizeof out);
    if (kind == MIO_PLY || kind == MIO_OBJ) {
        if ((rgb = result_colours(r, res)) == NULL) return fail_memory("the colours");
        out.rgb = rgb;
    }
    out.rows = out.ld = r->mesh.n;
    out.cols = (int32_t)res->n_columns;
    out.values = res->values;
    out.names = res->names;
    out.comment = kind == MIO_TXT ? res->comment : NULL;
    out.no_header = r->o->no_header;
    status = mio_write(path, kind, &r->mesh.file, &out, &e);
    free(rgb);
    return status < 0 ? fail_file(&e) : DONE;
}

/* The picture of one column, with the words that the command has for it. */
static int write_png(const char *path, const run *r, const result *res, const char *title,
                     const int32_t *marker)
{
    pic_panel panel = picture_panel(&r->mesh, result_column(r, res, res->colour));
    pic_opts opts = result_opts(r);
    char subtitle[300];
    snprintf(subtitle, sizeof subtitle, "%.200s, %ld %s", base_name(r->mesh_name), (long)r->mesh.n,
             r->mesh.n_tri ? "vertices" : "points");
    opts.title = r->o->title ? r->o->title : title;
    opts.subtitle = subtitle;
    if (r->o->labels) opts.labels = count_labels(&panel, 1);
    picture_from_zero(&opts, &panel, 1);
    panel.markers = marker;
    panel.n_markers = marker != NULL;
    return write_picture(path, &panel, 1, &opts);
}

/* ---- of kernel, diffuse, distance and hks ---- */

static int has_twice(const run *r)
{
    int i, k;
    for (i = 0; i < r->n_times; i++)
        for (k = 0; k < i; k++) if (strcmp(r->time_names[i], r->time_names[k]) == 0) return 1;
    for (i = 0; r->sources && !r->places && i < r->n_inputs; i++)
        for (k = 0; k < i; k++) if (r->sources[i] == r->sources[k]) return 1;
    return 0;
}

/* "v8_10h2", "f0_10h2" or "hks_10h2": the source or the field, then the time; "K_10h2" and "d_10h2" for
 * pairs. Repeated names also get the number of the column, because programs that read them need distinct
 * names. */
static int heat_names(run *r)
{
    const int pairs = r->o->command == CMD_PAIRS, step = pairs && !is_timeless(r->o) ? 2 : 1;
    const int twice = has_twice(r);
    int64_t c;
    r->names = (char (*)[NAME_SIZE])malloc((size_t)r->n_columns * sizeof *r->names);
    r->name_list = (const char **)malloc((size_t)r->n_columns * sizeof *r->name_list);
    if (!r->names || !r->name_list) return fail_memory("the names of the columns");
    for (c = 0; c < r->n_columns; c++) {
        const int q = (int)(c / r->n_times);
        char number[12] = "";
        if (twice) snprintf(number, sizeof number, "_c%d", (int)(c % 1000000));
        if (r->o->command == CMD_TRACE)
            snprintf(r->names[c], NAME_SIZE, "%s", c == 0 ? "t" : c == 1 ? "trace" : "bound");
        else if (r->o->frequencies) snprintf(r->names[c], NAME_SIZE, "si_%d", (int)(c % 1000000));
        else if (r->o->nearest)
            snprintf(r->names[c], NAME_SIZE, "%s_%.14s%s", c % 2 ? "d" : "nearest", r->time_names[c / 2],
                     number);
        else if (r->o->command == CMD_HKS)
            snprintf(r->names[c], NAME_SIZE, "hks_%.14s%s", r->time_names[c], number);
        else if (r->o->command == CMD_SAMPLE) snprintf(r->names[c], NAME_SIZE, "distance");
        else if (pairs)
            snprintf(r->names[c], NAME_SIZE, "%c_%.14s%s", c % step < step - 1 ? 'K' : 'd',
                     r->time_names[c / step], number);
        else snprintf(r->names[c], NAME_SIZE, "%c%ld_%.14s%s", r->places ? 's' : r->sources ? 'v' : 'f',
                      r->sources && !r->places ? (long)r->sources[q] : (long)q, r->time_names[c % r->n_times], number);
        r->name_list[c] = r->names[c];
    }
    return DONE;
}

static void heat_title(const run *r, int64_t c, char *title, size_t size)
{
    const int q = (int)(c / r->n_times);
    char when[64], where[40] = "";
    if (r->places) snprintf(where, sizeof where, "source %d", q);
    else if (r->sources) snprintf(where, sizeof where, "vertex %ld", (long)r->sources[q]);
    time_text(r->time_names[r->o->nearest ? c / 2 : c % r->n_times], when, sizeof when);
    if (is_timeless(r->o)) snprintf(when, sizeof when, "%s", r->time_names[0]);
    if (r->o->filter) snprintf(when, sizeof when, "filter %.40s", r->o->filter);
    if (r->o->nearest)
        snprintf(title, size, "%s of %d sources, %s", c % 2 ? "Distance to the nearest" : "Nearest",
                 r->n_inputs, when);
    else if (r->o->frequencies)
        snprintf(title, size, "Scale-invariant heat kernel signature, frequency %d", (int)(c % 1000000));
    else if (r->o->command == CMD_HKS)
        snprintf(title, size, "%s, %s", r->o->filter ? "Diagonal" : r->o->normalise ?
                 "Normalised heat kernel signature" : "Heat kernel signature", when);
    else if (r->o->command == CMD_DISTANCE)
        snprintf(title, size, "Diffusion distance from %s, %s", where, when);
    else if (r->o->command == CMD_GEODESIC)
        snprintf(title, size, "Geodesic distance from %s, %s", where, when);
    else if (r->sources) snprintf(title, size, "Heat from %s, %s", where, when);
    else snprintf(title, size, "Field %d diffused, %s", q, when);
}

static int write_heat(run *r)
{
    const double start = now();
    const int kind = r->o->output ? output_format(r->o->output) : MIO_TXT;
    const int32_t *marker = r->sources && !r->o->nearest ? &r->sources[r->o->column / r->n_times] : NULL;
    char title[160];
    result res;
    int code = heat_names(r);
    hd_heat_free(r->heat);           /* large, and not needed any more */
    r->heat = NULL;
    hd_geodesic_free(r->geodesic);
    r->geodesic = NULL;
    if (code) return code;
    memset(&res, 0, sizeof res);
    res.n_columns = r->n_columns;
    res.values = r->values;
    res.names = r->name_list;
    res.colour = r->o->column;
    heat_title(r, res.colour, title, sizeof title);
    bar_show("writing", 0);
    if (kind == FORMAT_PNG) code = write_png(r->o->output, r, &res, title, marker);
    else code = write_table(r->o->output, kind, r, &res);
    bar_hide();
    r->sec.write = now() - start;
    return code;
}

/* ---- of spectrum ---- */

/* The names of the vectors, and the eigenvalues as a line of text. */
static int spectrum_names(run *r, char **line)
{
    const hd_spectrum *s = r->spectrum;
    const size_t room = 32 * (size_t)s->count + 1;
    size_t at = 0;
    int32_t i;
    r->names = (char (*)[NAME_SIZE])malloc((size_t)s->count * sizeof *r->names + 1);
    r->name_list = (const char **)malloc((size_t)s->count * sizeof *r->name_list + 1);
    *line = (char *)malloc(room);
    if (!r->names || !r->name_list || !*line) return fail_memory("the names of the columns");
    (*line)[0] = 0;
    for (i = 0; i < s->count; i++) {
        snprintf(r->names[i], NAME_SIZE, "x_%ld", (long)i);
        r->name_list[i] = r->names[i];
        at += (size_t)snprintf(*line + at, room - at, "%s%.17g", i ? " " : "", s->value[i]);
    }
    return DONE;
}

static int write_spectrum(run *r)
{
    const double start = now();
    const int kind = r->o->output ? output_format(r->o->output) : MIO_TXT;
    char title[120], *line = NULL;
    result res;
    int code = spectrum_names(r, &line);
    memset(&res, 0, sizeof res);
    res.n_columns = r->n_columns;
    res.values = r->spectrum->vector;
    res.names = r->name_list;
    res.comment = line;
    res.colour = r->o->column;
    if (!code) {
        bar_show("writing", 0);
        if (kind == FORMAT_PNG) {
            snprintf(title, sizeof title, "Eigenvector %ld, eigenvalue %.6g", r->o->column,
                     r->spectrum->value[r->o->column]);
            code = write_png(r->o->output, r, &res, title, NULL);
        } else code = write_table(r->o->output, kind, r, &res);
        bar_hide();
    }
    free(line);
    r->sec.write = now() - start;
    return code;
}

/* ---- of pairs and sample ---- */

/* The ids in front of each row, then the numbers. */
static int write_ids(run *r)
{
    static const char *const pair_names[2] = { "i", "j" }, *const point_names[1] = { "vertex" };
    const double start = now();
    const int32_t *ids[2];
    mio_output out;
    mio_error e;
    int status = heat_names(r);
    hd_heat_free(r->heat);
    hd_geodesic_free(r->geodesic);
    r->heat = NULL;
    r->geodesic = NULL;
    if (status) return status;
    memset(&out, 0, sizeof out);
    ids[0] = r->o->command == CMD_PAIRS ? r->pairs : r->sources;
    ids[1] = r->pairs ? r->pairs + r->rows : NULL;
    out.ids = ids;
    out.n_ids = r->o->matrix || r->o->command == CMD_TRACE ? 0 : r->o->command == CMD_PAIRS ? 2 : 1;
    out.id_names = r->o->command == CMD_PAIRS ? pair_names : point_names;
    out.names = r->name_list;
    out.no_header = r->o->no_header;
    out.rows = out.ld = r->rows;
    out.cols = (int32_t)r->n_columns;
    out.values = r->values;
    bar_show("writing", 0);
    status = mio_write(r->o->output, r->o->output ? output_format(r->o->output) : MIO_TXT, NULL, &out, &e);
    bar_hide();
    r->sec.write = now() - start;
    return status < 0 ? fail_file(&e) : DONE;
}

/* ==== info ==== */

static void bounding_box(const mesh_data *m, double low[3], double high[3])
{
    int32_t i;
    int c;
    for (c = 0; c < 3; c++) {
        low[c] = HUGE_VAL;
        high[c] = -HUGE_VAL;
    }
    for (i = 0; i < m->n; i++)
        for (c = 0; c < 3; c++) {
            const double x = m->xyz[3 * (size_t)i + (size_t)c];
            if (x < low[c]) low[c] = x;
            if (x > high[c]) high[c] = x;
        }
}

static void info_json(const run *r, const hd_laplacian *lap, const double low[3], const double high[3])
{
    const hd_mesh_report *m = &lap->mesh;
    double meaningful[2];
    json j;
    (void)hd_times_auto(lap, 2, meaningful, NULL);
    json_begin(&j, r, stdout);
    json_laplacian(&j, lap);
    if (lap->kind == HD_LAPLACIAN_POLYGON) json_integer(&j, "faces_used", m->n_faces_used);
    json_integer(&j, "triangles", r->mesh.n_tri);
    if (lap->kind != HD_LAPLACIAN_POLYGON) json_integer(&j, "triangles_used", m->n_faces_used);
    json_integer(&j, "edges", m->n_edges);
    json_integer(&j, "boundary_loops", m->n_boundary_loops);
    json_integer(&j, "boundary_edges", m->n_boundary_edges);
    json_integer(&j, "nonmanifold_edges", m->n_nonmanifold_edges);
    json_integer(&j, "misoriented_edges", m->n_misoriented_edges);
    json_integer(&j, "small_faces", r->mesh.file.n_small_faces);
    json_integer(&j, "repeated_corner_faces", m->n_repeated_corner);
    json_integer(&j, "zero_area_faces", m->n_zero_area);
    json_integer(&j, "repeated_faces", m->n_repeated_face);
    json_integer(&j, "negative_weights", m->n_negative_weights);
    json_number(&j, "smallest_angle", m->smallest_angle * DEGREES);
    json_intrinsic(&j, r, m);
    if (!r->lengths) {
        json_numbers(&j, "box_low", low, 3);
        json_numbers(&j, "box_high", high, 3);
    }
    json_numbers(&j, "meaningful_times", meaningful, 2);
    json_end(&j, r);
}

static void print_count(const char *what, int64_t n, const char *note)
{
    if (n) printf("%-22s %lld%s%s%s\n", what, (long long)n, *note ? "  (" : "", note, *note ? ")" : "");
}

static void info_times(const hd_laplacian *lap)
{
    const double h2 = lap->h * lap->h;
    double t[2];
    (void)hd_times_auto(lap, 2, t, NULL);
    if (!(t[1] > 0)) return;
    printf("%-22s %.3g to %.3g", "meaningful times", t[0], t[1]);
    if (lap->kind != HD_LAPLACIAN_EXP) printf("  (%.3gh2 to %.3gh2)", t[0] / h2, t[1] / h2);
    printf("; --t auto:K takes K of them\n");
}

static void info_laplacian(const run *r, const hd_laplacian *lap)
{
    printf("%-22s %s%s\n", "Laplacian", word_of(LAPLACIANS, (int)lap->kind),
           r->o->tufted ? ", tufted" : r->o->intrinsic_delaunay ? ", intrinsic Delaunay" : "");
    if (r->lengths) printf("%-22s %s\n", "lengths of edges", display_name(r->o->lengths));
}

static void info_intrinsic(const hd_mesh_report *m)
{
    if (!m->n_sheets) return;
    printf("%-22s %ld%s\n%-22s %lld\n", "sheets", (long)m->n_sheets,
           m->n_sheets > 1 ? "  (the surface is covered twice)" : "", "edges flipped", (long long)m->n_flips);
    print_count("faces mollified", m->n_mollified, "all edges were lengthened a little");
    print_count("self-edges", m->n_self_edges, "from a vertex to itself, without weight");
    print_count("edges not Delaunay", m->n_not_delaunay, "rounding kept them");
    printf("%-22s %.4g degrees\n", "smallest angle now", m->smallest_intrinsic_angle * DEGREES);
}

static void info_points(const run *r, const hd_laplacian *lap, const double low[3], const double high[3])
{
    const hd_point_report *p = &lap->points;
    printf("%-22s %s (%s)\n", "points", r->mesh_name, r->mesh.file.format);
    info_laplacian(r, lap);
    printf("%-22s %ld\n%-22s %ld\n", "vertices", (long)r->mesh.n, "components", (long)lap->n_components);
    printf("%-22s %.9g x %.9g x %.9g, from (%.6g, %.6g, %.6g)\n", "box", high[0] - low[0], high[1] - low[1],
           high[2] - low[2], low[0], low[1], low[2]);
    printf("%-22s %.9g\n%-22s %.9g  (mean distance to the nearest point)\n",
           r->o->tufted ? "area of the stars" : "area of the cells", lap->area, "spacing h", lap->h);
    if (p->bandwidth2 > 0 && lap->n_active > 0) {
        printf("%-22s %.9g  (%.4gh2%s)\n", "bandwidth", p->bandwidth2, p->bandwidth2 / (lap->h * lap->h),
               r->o->has_bandwidth ? "" : ", from the sampling");
        printf("%-22s %.4g, where weights fall below %.3g; %.4g a row, at most %ld (7 to 13 with --tufted)\n",
               "weights reach", p->cut_radius, p->weight_cut, (double)lap->L.nnz / lap->n_active,
               (long)p->most_in_row);
    }
    print_count("coincident points", p->n_coincident,
                r->o->tufted ? "in the place of an earlier one, left out"
                             : "in the place of an earlier one; they share its cell");
    print_count("isolated points", p->n_isolated, "no other one within reach");
    print_count("points without area", p->n_no_area, "their neighbours lie on a line");
    print_count("border points", p->n_border, "at an edge of the surface or a gap");
    print_count("places not flat", p->n_not_flat, "creases, noise, or two sheets too close together");
    if (r->o->tufted) print_count("points in no star", lap->mesh.n_inert, "without area");
    info_intrinsic(&lap->mesh);
    info_times(lap);
}

static void info_print(const run *r, const hd_laplacian *lap, const double low[3], const double high[3])
{
    const hd_mesh_report *m = &lap->mesh;
    printf("%-22s %s (%s)\n", "mesh", r->mesh_name, r->mesh.file.format);
    info_laplacian(r, lap);
    printf("%-22s %ld\n%-22s %ld\n", "vertices", (long)r->mesh.n, "faces", (long)r->mesh.n_faces);
    if (m->n_faces != r->mesh.n_faces)
        printf("%-22s %ld  (polygons are split as fans)\n", "triangles", (long)m->n_faces);
    printf("%-22s %lld\n%-22s %ld\n%-22s %ld\n", "edges", (long long)m->n_edges, "components",
           (long)lap->n_components, "boundary loops", (long)m->n_boundary_loops);
    print_count("boundary edges", m->n_boundary_edges, "");
    if (!r->lengths)
        printf("%-22s %.9g x %.9g x %.9g, from (%.6g, %.6g, %.6g)\n", "box", high[0] - low[0],
               high[1] - low[1], high[2] - low[2], low[0], low[1], low[2]);
    printf("%-22s %.9g\n%-22s %.9g\n%-22s %.4g degrees\n", "area", lap->area, "mean edge length h", lap->h,
           "smallest angle", m->smallest_angle * DEGREES);
    print_count("vertices without area", m->n_inert, "no heat reaches them");
    print_count("vertices held at zero", lap->n_held, "all vertices of borders");
    print_count("faces left out", r->mesh.file.n_small_faces, "fewer than three corners");
    print_count("faces left out", m->n_repeated_corner, "a corner twice");
    print_count("faces left out", m->n_zero_area, "area zero");
    print_count("faces left out", m->n_repeated_face, "repeat an earlier one");
    print_count("non-manifold edges", m->n_nonmanifold_edges,
                "three faces or more; their weights are summed");
    print_count("misoriented edges", m->n_misoriented_edges, "their two faces disagree about the side");
    print_count("negative weights", m->n_negative_weights,
                m->n_sheets ? "border edges opposite to obtuse angles" :
                lap->kind == HD_LAPLACIAN_POLYGON ?
                "edges and diagonals of faces; fine, but values below 0 can occur" :
                "obtuse angles; fine, but values below 0 can occur");
    info_intrinsic(m);
    info_times(lap);
}

/* Also reports on meshes and point sets on which nothing can be computed. Missing values are zero. */
static int command_info(run *r)
{
    hd_laplacian none;
    hd_error err;
    double low[3], high[3];
    int code = run_load(r);
    if (!code) code = check_laplacian(r);
    if (code) return code;
    memset(&none, 0, sizeof none);
    none.kind = laplacian_kind(r);
    none.mesh.n_inert = r->mesh.n;
    none.mesh.n_faces = none.kind == HD_LAPLACIAN_POLYGON ? r->mesh.n_faces : r->mesh.n_tri;
    if (run_laplacian(r, &err) < 0 && err.status != HD_ERR_EMPTY) return fail_laplacian(r, &err);
    if (interrupt.asked) return INTERRUPTED;
    bar_hide();
    bounding_box(&r->mesh, low, high);
    if (r->o->json) info_json(r, r->lap ? r->lap : &none, low, high);
    else if (!r->o->quiet) (is_points(r) ? info_points : info_print)(r, r->lap ? r->lap : &none, low, high);
    return close_stdout();
}

/* ==== kernel, diffuse, distance, hks, pairs, sample, render ==== */

/* The computation, and what becomes of it: a file and a report, or with --dry-run an estimate. */
static int command_finish(run *r, int (*write)(run *), void (*report)(const run *))
{
    int code = run_solve(r);
    if (code) return code;
    if (r->o->dry_run) {
        report_estimate(r);
        return close_stdout();
    }
    code = write(r);
    if (!code) report(r);
    return code;
}

/* Fields on the mesh that begin at vertices, or at all of them. */
static int command_columns(run *r)
{
    int code = run_load(r);
    if (!code) code = run_assemble(r);
    if (!code) code = run_times(r);
    if (!code && r->o->command != CMD_HKS) code = run_sources(r);
    return code ? code : command_finish(r, r->o->matrix ? write_ids : write_heat, report_heat);
}

/* The two ids of a row into r->pairs. */
static int take_pair(run *r, const double *values, int64_t row, const int64_t *lines)
{
    const char *file = r->o->input;
    mio_error e;
    int c;
    for (c = 0; c < 2; c++) {
        const double id = values[c * r->rows + row];
        if (id >= 0 && id < r->mesh.n && id == floor(id)) {
            r->pairs[c * r->rows + row] = (int32_t)id;
            continue;
        }
        if (!lines) return fail(FAILED,
                                "%s: row %lld: %.15g is not a vertex of %s, which has %ld, numbered from 0",
                                display_name(file), (long long)row, id, r->mesh_name, (long)r->mesh.n);
        mio_fail_at(&e, display_name(file), lines[row],
                    "%.15g is not a vertex of %s, which has %ld, numbered from 0", id, r->mesh_name,
                    (long)r->mesh.n);
        return fail(FAILED, "%s", e.text);
    }
    return DONE;
}

static int run_pairs(run *r)
{
    mio_error e;
    double *values = NULL;
    int64_t *lines = NULL, row;
    int32_t columns = 0;
    const int status = mio_load_table_lines(&values, &r->rows, &columns, &lines, r->o->input, NULL, &e);
    int code = status < 0 ? fail_file(&e) : DONE;
    if (!code && columns != 2)
        code = fail(FAILED, "%s: %ld columns; a pair has two ids", display_name(r->o->input), (long)columns);
    if (!code && r->rows > INT32_MAX)
        code = fail(FAILED, "%s: %lld pairs are too many", display_name(r->o->input), (long long)r->rows);
    if (!code && (r->pairs = (int32_t *)malloc((size_t)r->rows * 2 * sizeof *r->pairs)) == NULL)
        code = fail_memory("the pairs");
    for (row = 0; !code && row < r->rows; row++) code = take_pair(r, values, row, lines);
    free(values);
    free(lines);
    return code;
}

static int command_pairs(run *r)
{
    int code = run_load(r);
    if (!code) code = run_pairs(r);
    if (!code) code = run_assemble(r);
    if (!code) code = run_times(r);
    return code ? code : command_finish(r, write_ids, report_heat);
}

static int command_trace(run *r)
{
    int code = run_load(r);
    if (!code) code = run_assemble(r);
    if (!code) code = run_times(r);
    return code ? code : command_finish(r, write_ids, report_heat);
}

static int command_sample(run *r)
{
    int code = run_load(r);
    if (!code) code = run_assemble(r);
    if (!code) code = run_times(r);
    if (!code && r->o->count > r->lap->n_active)
        code = fail(FAILED, "%s: --count %ld is beyond the mesh, which has %ld vertices with mass",
                    r->mesh_name, r->o->count, (long)r->lap->n_active);
    if (!code) code = run_sources(r);
    return code ? code : command_finish(r, write_ids, report_heat);
}

static int command_geodesic(run *r)
{
    int code = run_load(r);
    if (!code) code = run_assemble(r);
    if (!code) code = run_times(r);
    if (!code) code = run_sources(r);
    return code ? code : command_finish(r, r->o->matrix ? write_ids : write_heat, report_geodesic);
}

static int command_spectrum(run *r)
{
    int code = run_load(r);
    if (!code) code = run_assemble(r);
    return code ? code : command_finish(r, write_spectrum, report_spectrum);
}

static int command_diffuse(run *r)
{
    field_data field;
    int code;
    memset(&field, 0, sizeof field);
    code = run_load(r);
    if (!code) code = field_load(&field, r->o->input, r->mesh_name, r->mesh.n, 0);
    if (!code) code = run_assemble(r);
    if (!code) code = run_times(r);
    r->n_inputs = field.columns;
    r->fields = field.values;
    r->field_name = display_name(r->o->input);
    if (!code) code = command_finish(r, write_heat, report_heat);
    r->fields = NULL;
    field_free(&field);
    return code;
}

/* ---- smooth ---- */
/* Vertices move by K_t f - f, f their coordinates from the middle of the shape, as K_t keeps constants. Where
 * borders are held, f is instead how far vertices are from the shape w that heat tends to: L w = 0 inside,
 * and w = x on borders. It is zero on borders and L f = L x inside, and the place at time t is w + K_t f, by K_t
 * with borders held at zero. */

/* L of all vertices times the three columns of f, at the rows that are not held: the right-hand sides. On
 * components without a border f stays, and their rows of val become those of the identity. */
static void held_sides(const hd_laplacian *lap, const hd_laplacian *whole, const double *f, double *val,
                       double *side)
{
    const size_t n = (size_t)lap->n, rows = (size_t)lap->n_active;
    int64_t p;
    size_t c;
    int32_t i;
    memcpy(val, lap->L.val, (size_t)lap->L.nnz * sizeof *val);
    for (i = 0; i < lap->n_active; i++) {
        const int32_t v = lap->vertex[i], row = whole->row[v];
        const int closed = lap->conserves && isfinite(lap->component_mass[lap->component[i]]);
        for (c = 0; c < 3; c++) side[c * rows + (size_t)i] = closed ? f[c * n + (size_t)v] : 0;
        for (p = lap->L.row_ptr[i]; closed && p < lap->L.row_ptr[i + 1]; p++) val[p] = lap->L.col[p] == i;
        for (p = whole->L.row_ptr[row]; !closed && p < whole->L.row_ptr[row + 1]; p++)
            for (c = 0; c < 3; c++) {
                const int32_t other = whole->vertex[whole->L.col[p]];
                side[c * rows + (size_t)i] += whole->L.val[p] * f[c * n + (size_t)other];
            }
    }
}

/* side -= A y */
static void held_residual(const hd_csr *a, const double *val, const double *y, double *side)
{
    const size_t rows = (size_t)a->n_rows;
    int64_t p;
    int32_t i;
    size_t c;
    for (i = 0; i < a->n_rows; i++)
        for (p = a->row_ptr[i]; p < a->row_ptr[i + 1]; p++)
            for (c = 0; c < 3; c++) side[c * rows + (size_t)i] -= val[p] * y[c * rows + (size_t)a->col[p]];
}

/* Solves with one refinement, whose largest entry tells how far off the solution was. work: [9 n_active] */
static hd_status held_solve(run *r, const double *val, double *work, hd_error *err)
{
    const size_t size = 3 * (size_t)r->lap->n_active;
    double *side = work, *y = work + size, *d = y + size;
    const hd_ldl_opts opts = ldl_options(r);
    hd_ldl *f = NULL;
    size_t i;
    if (hd_ldl_analyse(&f, &r->lap->L, &opts, NULL, err) >= 0 && hd_ldl_factor(f, val, NULL, err) >= 0 &&
        hd_ldl_solve(f, 3, side, 0, y, 0, err) >= 0) {
        held_residual(&r->lap->L, val, y, side);
        (void)hd_ldl_solve(f, 3, side, 0, d, 0, err);
        for (i = 0; i < size; i++) {
            keep_larger(&r->held_error, fabs(d[i]));
            y[i] += d[i];
        }
    }
    hd_ldl_free(f);
    return err->status;
}

/* The Laplacian that holds nothing. */
static hd_status held_whole(run *r, hd_laplacian **whole, hd_error *err)
{
    const options *o = r->o;
    hd_laplacian *held = r->lap;
    const double seconds_before = r->sec.assemble;
    options natural = *o;
    hd_status status;
    natural.border = HD_BORDER_NATURAL;
    r->o = &natural;
    r->lap = NULL;
    status = run_laplacian(r, err);
    *whole = r->lap;
    r->lap = held;
    r->o = o;
    r->sec.assemble += seconds_before;
    return status;
}

/* From coordinates to f, see above. */
static int hold_borders(run *r, double *f)
{
    const size_t n = (size_t)r->mesh.n, rows = (size_t)r->lap->n_active;
    double *val = new_columns(r->lap->L.nnz, 1), *work = new_columns(r->lap->n_active, 9);
    hd_laplacian *whole = NULL;
    hd_error err;
    size_t i, c;
    int code = val && work ? DONE : fail_memory("the borders");
    memset(&err, 0, sizeof err);
    if (!code && held_whole(r, &whole, &err) < 0) code = fail_laplacian(r, &err);
    if (!code) {
        held_sides(r->lap, whole, f, val, work);
        interrupt.patient = 1;
        if (held_solve(r, val, work, &err) < 0) code = fail_library(r->mesh_name, &err);
        code = leave_computation(code);
    }
    for (i = 0; i < n && !code; i++)
        for (c = 0; c < 3; c++) {
            const int32_t row = r->lap->row[i];
            f[c * n + i] = row < 0 ? 0 : work[(3 + c) * rows + (size_t)row];
        }
    hd_laplacian_free(whole);
    free(val);
    free(work);
    return code;
}

/* The new coordinates, how far vertices moved, and how far off they can be: the bound of K_t f, twice the
 * error of f and the rounding of the sum. */
static double *smooth_places(run *r)
{
    const size_t n = (size_t)r->mesh.n;
    double *xyz = new_columns(r->mesh.n, 3), largest = 0, farthest = 0;
    size_t i, c;
    for (i = 0; i < n && xyz; i++) {
        double way2 = 0;
        for (c = 0; c < 3; c++) {
            const double x = r->mesh.xyz[3 * i + c], by = r->values[c * n + i] - r->fields[c * n + i];
            xyz[3 * i + c] = x + by;
            way2 += by * by;
            keep_larger(&largest, fabs(r->values[c * n + i]));
            keep_larger(&farthest, fabs(x));
        }
        r->moved[0] += sqrt(way2) / (double)n;
        keep_larger(&r->moved[1], sqrt(way2));
    }
    r->off = r->sum.worst.error_bound * largest + 2 * r->held_error + DBL_EPSILON * farthest;
    return xyz;
}

/* The format of the output; to standard output that of the input. */
static int smooth_format(const run *r)
{
    static const word formats[] = { { "OBJ", MIO_OBJ }, { "OFF", MIO_OFF }, { "PLY", MIO_PLY },
                                    { "STL", MIO_STL }, { NULL, MIO_TXT } };
    int i;
    if (r->o->output && !is_stream(r->o->output)) return mio_mesh_format_of(r->o->output);
    for (i = 0; formats[i].name && strncmp(formats[i].name, r->mesh.file.format, 3) != 0; i++) {}
    return formats[i].value;
}

static int write_smooth(run *r)
{
    const double start = now();
    const int kind = smooth_format(r);
    double *xyz = smooth_places(r);
    mio_mesh mesh = r->mesh.file;
    mio_output out;
    mio_error e;
    int status, c;
    if (!xyz) return fail_memory("the result");
    memset(&out, 0, sizeof out);
    mesh.xyz = xyz;
    if (kind == MIO_TXT) {               /* points as three columns */
        for (c = 0; c < 3; c++)
            for (out.rows = 0; out.rows < mesh.n; out.rows++)
                r->values[c * (int64_t)mesh.n + out.rows] = xyz[3 * out.rows + c];
        out.ld = mesh.n;
        out.cols = 3;
        out.values = r->values;
    }
    bar_show("writing", 0);
    status = mio_write(r->o->output, kind, &mesh, &out, &e);
    bar_hide();
    free(xyz);
    r->sec.write = now() - start;
    return status < 0 ? fail_file(&e) : DONE;
}

/* Coordinates from the middle of the shape, as three fields. */
static int smooth_fields(run *r, double *f)
{
    const size_t n = (size_t)r->mesh.n;
    double low[3], high[3];
    size_t i, c;
    bounding_box(&r->mesh, low, high);
    for (c = 0; c < 3; c++)
        for (i = 0; i < n; i++) f[c * n + i] = r->mesh.xyz[3 * i + c] - (low[c] / 2 + high[c] / 2);
    return r->lap->n_held && !r->o->dry_run ? hold_borders(r, f) : DONE;
}

/* Can the shape be written in the format that is asked for? */
static int check_smooth(const run *r)
{
    const int kind = smooth_format(r), points = r->mesh.n_tri == 0;
    const int shown = (!r->o->output || is_stream(r->o->output)) && stdout_is_terminal();
    if (shown && (kind == MIO_PLY || kind == MIO_STL))
        return fail(USAGE, "-o is needed here: %s is nothing for a terminal", r->mesh.file.format);
    if (points && kind == MIO_STL)
        return fail(FAILED, "%s: .stl needs faces, and there are none", r->mesh_name);
    if (!points && kind == MIO_TXT)
        return fail(FAILED, "%s: .xyz is for points, and this file has faces", r->mesh_name);
    return DONE;
}

static int command_smooth(run *r)
{
    double *f = NULL;
    int code = run_load(r);
    if (!code) code = check_smooth(r);
    if (!code) code = run_assemble(r);
    if (!code) code = run_times(r);
    if (!code && (f = new_columns(r->mesh.n, 3)) == NULL) code = fail_memory("the coordinates");
    if (!code) code = smooth_fields(r, f);
    r->n_inputs = 3;
    r->fields = f;
    r->field_name = r->mesh_name;
    if (!code) code = command_finish(r, write_smooth, report_heat);
    r->fields = NULL;
    free(f);
    return code;
}

/* ---- levels ---- */

/* auto:K becomes K values between the least and the largest finite one, which range gets. */
static int levels_resolve(const run *r, const double *f, double *level, double range[2])
{
    const options *o = r->o;
    int32_t i;
    int k;
    range[0] = HUGE_VAL;
    range[1] = -HUGE_VAL;
    for (i = 0; i < r->mesh.n; i++)
        if (isfinite(f[i])) {
            range[0] = f[i] < range[0] ? f[i] : range[0];
            range[1] = f[i] > range[1] ? f[i] : range[1];
        }
    if (!o->levels && !(range[0] < range[1]))
        return fail(FAILED, "%s: column %ld has one value only: there is nothing between",
                    display_name(o->input), o->column);
    for (k = 0; k < o->n_levels; k++) {
        const double u = (k + 1.0) / (o->n_levels + 1.0);
        level[k] = o->levels ? o->levels[k] : range[0] * (1 - u) + range[1] * u;
    }
    return DONE;
}

static void levels_obj(mio_file *f, const lev_set *s)
{
    int64_t i, k;
    int c;
    for (i = 0; i < s->n_points && f->status == MIO_OK; i++) {
        mio_put_text(f, "v");
        for (c = 0; c < 3; c++) {
            mio_put_text(f, " ");
            mio_put_double(f, s->xyz[3 * i + c]);
        }
        mio_put_text(f, "\n");
    }
    for (k = 0; k < s->n_lines && f->status == MIO_OK; k++) {
        const lev_line *line = s->line + k;
        if (k == 0 || line->level != line[-1].level) {
            mio_put_text(f, "g level_");
            mio_put_double(f, line->level);
            mio_put_text(f, "\n");
        }
        mio_put_text(f, "l");
        for (i = 0; i < line->count + line->closed; i++) {
            mio_put_text(f, " ");
            mio_put_integer(f, line->first + i % line->count + 1);
        }
        mio_put_text(f, "\n");
    }
}

/* Columns of the table: line, closed, level, x, y, z. */
static int levels_table(const run *r, const lev_set *s, int kind)
{
    static const char *const names[4] = { "level", "x", "y", "z" }, *const id_names[2] = { "line", "closed" };
    const size_t n = (size_t)s->n_points;
    int32_t *id = (int32_t *)malloc((2 * n + 1) * sizeof *id);
    double *values = new_columns(s->n_points, 4);
    const int32_t *ids[2];
    mio_output out;
    mio_error e;
    int64_t i, k;
    int code = DONE, status, c;
    if (!id || !values) code = fail_memory("the table");
    else {
        for (k = 0; k < s->n_lines; k++)
            for (i = s->line[k].first; i < s->line[k].first + s->line[k].count; i++) {
                id[i] = (int32_t)k;
                id[(int64_t)n + i] = s->line[k].closed;
                values[i] = s->line[k].level;
                for (c = 0; c < 3; c++) values[(c + 1) * (int64_t)n + i] = s->xyz[3 * i + c];
            }
        ids[0] = id;
        ids[1] = id + n;
        memset(&out, 0, sizeof out);
        out.rows = out.ld = s->n_points;
        out.cols = 4;
        out.values = values;
        out.n_ids = 2;
        out.ids = ids;
        out.id_names = id_names;
        out.names = names;
        out.no_header = r->o->no_header;
        status = mio_write(r->o->output, kind, NULL, &out, &e);
        if (status < 0) code = fail_file(&e);
    }
    free(id);
    free(values);
    return code;
}

static int levels_write(const run *r, const lev_set *s)
{
    const int kind = r->o->output ? output_format(r->o->output) : MIO_TXT;
    mio_file f;
    mio_error e;
    int status;
    if (kind != MIO_OBJ) return levels_table(r, s, kind);
    if (mio_file_open(&f, r->o->output, NULL, &e) == MIO_OK) levels_obj(&f, s);
    status = mio_file_close(&f);
    return status < 0 ? fail_file(&e) : DONE;
}

/* Sums over the lines of one level. */
static void levels_count(const lev_set *s, double level, int64_t *lines, int64_t *closed, double *length)
{
    int64_t k;
    *lines = *closed = 0;
    *length = 0;
    for (k = 0; k < s->n_lines; k++) {
        if (s->line[k].level != level) continue;
        ++*lines;
        *closed += s->line[k].closed;
        *length += s->line[k].length;
    }
}

static void levels_json(const run *r, const lev_set *s, const double *level, const double range[2])
{
    int64_t lines, closed, all_closed = 0;
    double length;
    json j;
    int k;
    json_begin(&j, r, stderr);
    json_numbers(&j, "levels", level, r->o->n_levels);
    json_numbers(&j, "range", range, 2);
    for (lines = 0; lines < s->n_lines; lines++) all_closed += s->line[lines].closed;
    json_integer(&j, "lines", s->n_lines);
    json_integer(&j, "closed", all_closed);
    json_integer(&j, "points", s->n_points);
    json_key(&j, "lengths");
    for (k = 0; k < r->o->n_levels; k++) {
        levels_count(s, level[k], &lines, &closed, &length);
        fprintf(j.out, k ? ", " : "[");
        json_value(j.out, length);
    }
    fprintf(j.out, "]");
    json_end(&j, r);
}

static void levels_print(const run *r, const lev_set *s, const double *level, const double range[2])
{
    const char *field = display_name(r->o->input);
    int64_t lines, closed;
    double length;
    int k, outside = 0;
    fprintf(stderr, "levels of %s: %lld line%s at %d value%s, %lld points, %.3g s\n", field,
            (long long)s->n_lines, plural(s->n_lines), r->o->n_levels, plural(r->o->n_levels),
            (long long)s->n_points, now() - r->started);
    for (k = 0; k < r->o->n_levels; k++) {
        outside += !(level[k] >= range[0] && level[k] <= range[1]);
        levels_count(s, level[k], &lines, &closed, &length);
        if (r->o->verbose)
            fprintf(stderr, "level %.9g: %lld line%s, %lld closed, length %.9g\n", level[k], (long long)lines,
                    plural(lines), (long long)closed, length);
    }
    if (outside && range[0] > range[1])
        fprintf(stderr, "note: column %ld of %s has no finite value\n", r->o->column, field);
    else if (outside)
        fprintf(stderr, "note: %d of %d level%s outside the range of column %ld of %s, from %.9g to %.9g\n",
                outside, r->o->n_levels, r->o->n_levels == 1 ? " is" : outside == 1 ? "s is" : "s are",
                r->o->column, field, range[0], range[1]);
}

/* Is x among the first n levels? Its lines are there already then. */
static int has_level(const double *level, int n, double x)
{
    int k;
    for (k = 0; k < n && level[k] != x; k++) { }
    return k < n;
}

static int levels_of(run *r, const field_data *field)
{
    const double *f = field->values + (size_t)r->o->column * (size_t)r->mesh.n;
    double *level = (double *)malloc((size_t)r->o->n_levels * sizeof *level);
    double range[2];
    lev_mesh mesh;
    lev_set s;
    int code, k;
    if (!level) return fail_memory("the levels");
    mesh.xyz = r->mesh.xyz;
    mesh.face_ptr = r->mesh.file.face_ptr;
    mesh.face_idx = r->mesh.file.face_idx;
    mesh.n_faces = r->mesh.n_faces;
    memset(&s, 0, sizeof s);
    code = levels_resolve(r, f, level, range);
    for (k = 0; k < r->o->n_levels && !code && !interrupt.asked; k++)
        if (!has_level(level, k, level[k]) && !lev_trace(&s, &mesh, f, level[k]))
            code = fail_memory("the lines");
    if (!code && interrupt.asked) code = INTERRUPTED;
    if (!code) code = levels_write(r, &s);
    if (!code && r->o->json) levels_json(r, &s, level, range);
    else if (!code && !r->o->quiet) levels_print(r, &s, level, range);
    lev_free(&s);
    free(level);
    return code;
}

static int command_levels(run *r)
{
    field_data field;
    int code = run_load(r);
    memset(&field, 0, sizeof field);
    if (!code && r->mesh.n_tri == 0)
        code = fail(FAILED, "%s: levels needs faces, and there are none", r->mesh_name);
    if (!code) code = field_load(&field, r->o->input, r->mesh_name, r->mesh.n, 1);
    if (!code && r->o->column >= field.columns)
        code = fail(FAILED, "%s: --column %ld is beyond its %ld columns, numbered from 0",
                    display_name(r->o->input), r->o->column, (long)field.columns);
    if (!code) code = levels_of(r, &field);
    field_free(&field);
    return code;
}

/* A field of render and the mesh it is on. */
typedef struct view_data { mesh_data own; const mesh_data *mesh; const char *mesh_name; field_data field;
                           } view_data;

static void report_render(const run *r, const view_data *views)
{
    const options *o = r->o;
    json j;
    if (o->json) {
        json_begin(&j, r, stderr);
        json_text(&j, "input", o->input);
        json_integer(&j, "columns", views->field.columns);
        json_integer(&j, "column", o->column);
        json_integer(&j, "panels", o->n_inputs);
        json_end(&j, r);
    } else if (!o->quiet && o->n_inputs > 1)
        fprintf(stderr, "%d panels, column %ld of each field, %.3g s\n", o->n_inputs, o->column,
                now() - r->started);
    else if (!o->quiet)
        fprintf(stderr, "%s: %ld vertices, column %ld of %ld from %s, %.3g s\n", r->mesh_name,
                (long)r->mesh.n, o->column, (long)views->field.columns, display_name(o->input),
                now() - r->started);
}

/* Are all numbers of the column labels, or -1 for none? */
static int check_label_values(const options *o, const char *file, const double *values, int32_t n)
{
    int32_t i;
    for (i = 0; i < n; i++)
        if (isfinite(values[i]) &&
            !(values[i] >= -1 && values[i] < INT32_MAX && values[i] == floor(values[i])))
            return fail(FAILED, "%s: row %ld, column %ld: --labels takes whole numbers from 0, or -1 for "
                        "none, not %.9g", display_name(file), (long)i, o->column, values[i]);
    return DONE;
}

/* Field k, and its mesh unless that of the run serves all. */
static int view_load(const run *r, int k, view_data *v)
{
    const options *o = r->o;
    const int own = k > 0 && o->n_meshes > 1;
    int code = own ? mesh_load(&v->own, o->meshes[k]) : DONE;
    v->mesh = own ? &v->own : &r->mesh;
    v->mesh_name = own ? display_name(o->meshes[k]) : r->mesh_name;
    if (!code) code = field_load(&v->field, o->inputs[k], v->mesh_name, v->mesh->n, 1);
    if (!code && o->column >= v->field.columns)
        code = fail(FAILED, "%s: --column %ld is beyond its %ld columns, numbered from 0",
                    display_name(o->inputs[k]), o->column, (long)v->field.columns);
    if (!code && o->labels)
        code = check_label_values(o, o->inputs[k], v->field.values + (size_t)o->column * (size_t)v->mesh->n,
                                  v->mesh->n);
    return code;
}

/* Pictures side by side, with one range of colours and one view. Each has the name of its mesh below, or of
 * its field if all meshes are the same. */
static int render_panels(const run *r, const view_data *views)
{
    const options *o = r->o;
    const int n = o->n_inputs;
    pic_panel panels[MAX_PANELS];
    pic_opts opts = picture_opts(o);
    char title[120];
    int k;
    for (k = 0; k < n; k++) {
        panels[k] = picture_panel(views[k].mesh,
                                  views[k].field.values + (size_t)o->column * (size_t)views[k].mesh->n);
        panels[k].caption = base_name(o->n_meshes > 1 ? views[k].mesh_name : display_name(o->inputs[k]));
    }
    snprintf(title, sizeof title, "column %ld", o->column);
    opts.title = o->title ? o->title : title;
    opts.one_view = 1;
    if (!o->height) opts.height = n == 2 ? 640 : n == 3 ? 460 : PICTURE_HEIGHT;
    if (o->labels) opts.labels = count_labels(panels, n);
    picture_from_zero(&opts, panels, n);
    return write_picture(o->output, panels, n, &opts);
}

static int render_fields(run *r, const view_data *views)
{
    char title[120];
    result res;
    memset(&res, 0, sizeof res);
    res.n_columns = views->field.columns;
    res.values = views->field.values;
    res.colour = r->o->column;
    if (strcmp(r->o->output, "-") == 0 && stdout_is_terminal())
        return fail(USAGE, "-o - takes a pipe or a file: a picture is nothing for a terminal");
    if (r->o->n_inputs > 1) return render_panels(r, views);
    snprintf(title, sizeof title, "%.80s, column %ld", base_name(r->o->input), r->o->column);
    return write_png(r->o->output, r, &res, title, NULL);
}

static int command_render(run *r)
{
    view_data views[MAX_PANELS];
    int k, code;
    memset(views, 0, sizeof views);
    code = run_load(r);
    for (k = 0; !code && k < r->o->n_inputs; k++) code = view_load(r, k, views + k);
    if (!code) code = render_fields(r, views);
    if (!code) report_render(r, views);
    for (k = 0; k < r->o->n_inputs; k++) {
        mesh_free(&views[k].own);
        field_free(&views[k].field);
    }
    return code;
}

/* ==== demo ==== */

enum { DEMO_SOURCES = 2, DEMO_N_TIMES = 4, DEMO_PATH = 2048, DEMO_FILE_NAME = 48 };  /* the last two: bytes */
static const char *const DEMO_NAMES[DEMO_SOURCES] = { "trunk", "tail" };
static const char DEMO_TIMES[] = "10h2,100h2,500h2,2000h2";
static const char DEMO_FOLDER[] = "heatdiff-demo";

/* Properties that the demo checks, apart from the columns. */
typedef struct demo_checks {
    double mass_error;               /* |1'B K e_i - b_i| / b_i, the worst of all columns */
    double there, back;              /* k_t from trunk to tail and from tail to trunk, at the longest time */
    double least, largest;           /* values of the last column */
} demo_checks;

static int demo_mesh(run *r)
{
    shape s = shape_demo(0);
    const int code = s.xyz ? mesh_of_shape(&r->mesh, &s) : fail_memory("the demo's shape");
    shape_free(&s);
    return code;
}

/* The ends of the longest axis, which is x. */
static void demo_sources(const mesh_data *m, int64_t source[DEMO_SOURCES])
{
    double low[3], high[3];
    int32_t i;
    bounding_box(m, low, high);
    for (i = 0; i < m->n; i++) {
        if (m->xyz[3 * (size_t)i] == high[0]) source[0] = i;
        if (m->xyz[3 * (size_t)i] == low[0]) source[1] = i;
    }
}

static double demo_mass_error(const run *r)
{
    double worst = 0;
    int q, k;
    int32_t i;
    for (q = 0; q < r->n_inputs; q++)
        for (k = 0; k < r->n_times; k++) {
            const double *u = r->values + (size_t)(q * r->n_times + k) * (size_t)r->mesh.n;
            const double given = r->lap->mass[r->lap->row[r->sources[q]]];
            double mass = 0;
            for (i = 0; i < r->lap->n_active; i++) mass += r->lap->mass[i] * u[r->lap->vertex[i]];
            keep_larger(&worst, fabs(mass - given) / given);
        }
    return worst;
}

static int demo_check(run *r, demo_checks *c)
{
    const int32_t from[2] = { r->sources[1], r->sources[0] }, to[2] = { r->sources[0], r->sources[1] };
    const double *last = r->values + (size_t)(r->n_columns - 1) * (size_t)r->mesh.n;
    double pair[2];
    hd_report report;
    int32_t i;
    int code = DONE;
    interrupt.patient = 1;
    if (hd_heat_entries(r->heat, HD_KERNEL_SYMMETRIC, 1, r->times + r->n_times - 1, 2, from, to, pair, &report, NULL) < 0)
        code = fail_library("demo", &report.error);
    code = leave_computation(code);
    if (code) return code;
    c->mass_error = demo_mass_error(r);
    c->there = pair[0];
    c->back = pair[1];
    c->least = c->largest = last[0];
    for (i = 0; i < r->mesh.n; i++) {
        if (last[i] < c->least) c->least = last[i];
        if (last[i] > c->largest) c->largest = last[i];
    }
    return DONE;
}

/* ---- its files ---- */

static const char *demo_folder(const run *r) { return r->o->output ? r->o->output : DEMO_FOLDER; }

/* command_demo has seen to it that the folder's name is short enough. */
static void demo_path(const run *r, char *path, size_t size, const char *kind, const char *name,
                      const char *extension)
{
    snprintf(path, size, "%s/%s%s%s", demo_folder(r), kind, name, extension);
    bar_show("writing", 0);
}

static int demo_ply(const run *r, int q)
{
    const size_t first = (size_t)(q * r->n_times);
    char path[DEMO_PATH];
    const char *names[DEMO_N_TIMES];
    result res;
    int k;
    demo_path(r, path, sizeof path, "heat-", DEMO_NAMES[q], ".ply");
    memset(&res, 0, sizeof res);
    res.n_columns = r->n_times;
    res.values = r->values + first * (size_t)r->mesh.n;
    for (k = 0; k < DEMO_N_TIMES; k++) names[k] = r->time_names[k];
    res.names = names;
    res.colour = r->n_times / 2;
    return write_table(path, MIO_PLY, r, &res);
}

static int demo_grid(const run *r, int q)
{
    pic_panel panels[DEMO_N_TIMES];
    char path[DEMO_PATH], captions[DEMO_N_TIMES][64], title[64];
    pic_opts opts = picture_opts(r->o);
    int k;
    demo_path(r, path, sizeof path, "heat-", DEMO_NAMES[q], ".png");
    snprintf(title, sizeof title, "Heat that starts at the %s", DEMO_NAMES[q]);
    for (k = 0; k < DEMO_N_TIMES; k++) {
        panels[k] = picture_panel(&r->mesh, r->values + (size_t)(q * r->n_times + k) * (size_t)r->mesh.n);
        time_text(r->time_names[k], captions[k], sizeof captions[k]);
        panels[k].caption = captions[k];
        panels[k].markers = &r->sources[q];
        panels[k].n_markers = 1;
    }
    opts.width = 1600;
    opts.height = 1150;
    opts.title = title;
    opts.subtitle = "columns of the heat kernel K_t = exp(-t B^-1 L), "
                    "logarithmic colours, one legend per time";
    opts.own_scale = 1;
    opts.log_decades = 4;
    opts.isolines = 10;
    return write_picture(path, panels, k, &opts);
}

static int demo_isolines(const run *r)
{
    const int k = r->n_times - 2;
    pic_panel panel = picture_panel(&r->mesh, r->values + (size_t)k * (size_t)r->mesh.n);
    pic_opts opts = picture_opts(r->o);
    char path[DEMO_PATH], title[100], when[64];
    demo_path(r, path, sizeof path, "isolines", "", ".png");
    time_text(r->time_names[k], when, sizeof when);
    snprintf(title, sizeof title, "Lines of equal heat, %s", when);
    panel.markers = &r->sources[0];
    panel.n_markers = 1;
    opts.title = title;
    opts.subtitle = "colours and lines are logarithmic: "
                    "from one line to the next the heat falls by the same factor";
    opts.label = "K_t";
    opts.width = 1600;
    opts.height = 1200;
    opts.log_decades = 8;
    opts.isolines = 40;
    return write_picture(path, &panel, 1, &opts);
}

enum { DEMO_DISTANCE, DEMO_SIGNATURE, DEMO_FIELDS };
static const char *const DEMO_FIELD_NAMES[DEMO_FIELDS] = { "distance", "signature" };
static const char *const DEMO_FIELD_TITLES[DEMO_FIELDS] = {
    "Diffusion distance from the trunk", "Heat kernel signature" };

/* The distance from the first source to all vertices, and the signature of all vertices, at a middle time.
 * fields: two columns. */
static int demo_inverse(const run *r, double *fields)
{
    const double *t = &r->times[r->n_times / 2];
    const hd_sources trunk = run_some(r, 0, 1);
    hd_report report;
    interrupt.patient = 1;
    if (hd_heat_distance(r->heat, HD_DISTANCE_CLASSICAL, 1, t, &trunk, fields, 0, &report, NULL) < 0 ||
        hd_heat_diagonal(r->heat, HD_KERNEL_SYMMETRIC, 1, t, fields + r->mesh.n, 0, NULL, NULL, &report, NULL) < 0)
        return leave_computation(fail_library("demo", &report.error));
    return leave_computation(DONE);
}

static int demo_field(const run *r, int f, const double *values)
{
    pic_panel panel = picture_panel(&r->mesh, values);
    pic_opts opts = picture_opts(r->o);
    char path[DEMO_PATH], subtitle[100];
    demo_path(r, path, sizeof path, DEMO_FIELD_NAMES[f], "", ".png");
    time_text(r->time_names[r->n_times / 2], subtitle, sizeof subtitle);
    opts.title = DEMO_FIELD_TITLES[f];
    opts.subtitle = subtitle;
    opts.width = 1600;
    opts.height = 1200;
    opts.log_decades = 0;
    opts.isolines = 24;
    panel.markers = r->sources;
    panel.n_markers = f == DEMO_DISTANCE;
    return write_picture(path, &panel, 1, &opts);
}

/* Two pictures, and a mesh with both. */
static int demo_fields(const run *r)
{
    double *values = new_columns(r->mesh.n, DEMO_FIELDS);
    char path[DEMO_PATH];
    result res;
    int f, code = values ? demo_inverse(r, values) : fail_memory("the demo's fields");
    for (f = 0; f < DEMO_FIELDS && !code; f++)
        code = demo_field(r, f, values + (size_t)f * (size_t)r->mesh.n);
    if (!code) {
        demo_path(r, path, sizeof path, "distance-signature", "", ".ply");
        memset(&res, 0, sizeof res);
        res.n_columns = DEMO_FIELDS;
        res.values = values;
        res.names = DEMO_FIELD_NAMES;
        code = write_table(path, MIO_PLY, r, &res);
    }
    free(values);
    return code;
}

static int demo_files(const run *r)
{
    int q, code = DONE;
    for (q = 0; q < DEMO_SOURCES && !code; q++) {
        code = demo_ply(r, q);
        if (!code) code = demo_grid(r, q);
    }
    return code ? code : demo_isolines(r);
}

static const double DEMO_NOISE = 0.017;      /* about half an edge length */

/* The surface, bent, and with noise: for runs of one's own. */
static int demo_shapes(const run *r)
{
    static const char *const names[3] = { "elephant", "bent", "noisy" };
    const size_t size = 3 * (size_t)r->mesh.n;
    double *xyz = new_columns(r->mesh.n, 3);
    mio_mesh mesh = r->mesh.file;
    char path[DEMO_PATH];
    mio_output out;
    mio_error e;
    int k, code = xyz ? DONE : fail_memory("the demo's shapes");
    memset(&out, 0, sizeof out);
    mesh.xyz = xyz;
    for (k = 0; k < 3 && !code; k++) {
        memcpy(xyz, r->mesh.xyz, size * sizeof *xyz);
        if (k == 1) shape_bend(xyz, mesh.n);
        if (k == 2) shape_shake(xyz, mesh.n, DEMO_NOISE);
        demo_path(r, path, sizeof path, "", names[k], ".obj");
        if (mio_write(path, MIO_OBJ, &mesh, &out, &e) < 0) code = fail_file(&e);
    }
    free(xyz);
    return code;
}

static void demo_print(const run *r, const demo_checks *c)
{
    const char *folder = demo_folder(r), *program = r->o->program;
    const hd_laplacian *lap = r->lap;
    double spent = 0;
    int q, k;
    for (k = 0; k < N_STAGES; k++) spent += r->sec.stage[k];
    printf("A surface made in memory: %ld vertices, %ld triangles, area %.3f, mean edge h = %.4f.\n",
           (long)r->mesh.n, (long)r->mesh.n_tri, lap->area, lap->h);
    printf("Heat was put at two vertices, %s (%ld) and %s (%ld), and followed over", DEMO_NAMES[0],
           (long)r->sources[0], DEMO_NAMES[1], (long)r->sources[1]);
    for (k = 0; k < r->n_times; k++) printf("%s %s", k ? "," : "", r->time_names[k]);
    printf(".\n\n");
    printf("  error         at most %.1e of the largest value (a bound, computed with the answer)\n",
           r->sum.worst.error_bound);
    printf("  conservation  the heat on the surface stays what it was, to %.1e\n", c->mass_error);
    printf("  symmetry      trunk to tail %.9g, tail to trunk %.9g, difference %.1e of it\n", c->there,
           c->back, fabs(c->there - c->back) / fabs(c->there));
    printf("  time          %.2g s for %ld columns, method %s, no eigenvectors; %.1f MB\n\n", spent,
           (long)r->n_columns, method_text(&r->sum), (double)r->context.bytes_peak / 1048576.0);
    printf("Look at\n");
    for (q = 0; q < DEMO_SOURCES; q++)
        printf("  %s/heat-%s.png  the four times side by side\n", folder, DEMO_NAMES[q]);
    printf("  %s/isolines.png  one of them, large, with lines of equal heat\n", folder);
    printf("  %s/distance.png  the diffusion distance from the trunk to every vertex\n", folder);
    printf("  %s/signature.png  the heat kernel signature: what the surface looks like from each vertex\n",
           folder);
    printf("  %s/distance-signature.ply  the mesh with both\n", folder);
    for (q = 0; q < DEMO_SOURCES; q++)
        printf("  %s/heat-%s.ply  the mesh with all values, for MeshLab, Blender or ParaView\n", folder,
               DEMO_NAMES[q]);
    printf("  %s/elephant.obj  the surface alone; bent.obj and noisy.obj: bent, and with noise\n", folder);
    printf("\nNext, on this mesh or one of your own\n");
    printf("  %s info %s/heat-trunk.ply\n", program, folder);
    printf("  %s kernel --source 0 --t 50h2 %s/heat-trunk.ply -o heat.png\n", program, folder);
    printf("  %s kernel --source 0,100 --t auto:4 %s/heat-trunk.ply > columns.txt\n", program, folder);
    printf("  %s distance --source 0 --t 500h2 %s/heat-trunk.ply -o distance.ply\n", program, folder);
    printf("  %s sample --count 10 --t 500h2 %s/heat-trunk.ply\n", program, folder);
    printf("  %s smooth %s/noisy.obj -o smooth.obj\n", program, folder);
    printf("  %s --help\n", program);
}

static int command_demo(run *r)
{
    options o = *r->o;               /* with times and sources of its own */
    int64_t sources[DEMO_SOURCES] = { 0, 0 };
    demo_checks checks;
    int code;
    if (strlen(demo_folder(r)) > DEMO_PATH - DEMO_FILE_NAME)
        return fail(FAILED, "%.60s...: cannot make this folder: the name is too long", demo_folder(r));
    if (!make_folder(demo_folder(r)))
        return fail(FAILED, "%s: cannot make this folder: %s", demo_folder(r), strerror(errno));
    if ((code = demo_mesh(r)) != DONE) return code;
    demo_sources(&r->mesh, sources);
    o.sources = sources;
    o.n_sources = DEMO_SOURCES;
    o.log_scale = 1;                 /* of the colours in the PLY files */
    if (parse_times(&o, NULL, DEMO_TIMES) < 1) return fail_memory("the times");
    r->o = &o;
    code = run_assemble(r);
    if (!code) code = run_times(r);
    if (!code) code = run_sources(r);
    if (!code) code = run_solve(r);
    if (!code) code = demo_check(r, &checks);
    if (!code) code = demo_files(r);
    o.log_scale = 0;                 /* distances are not spread over decades */
    if (!code) code = demo_fields(r);
    if (!code) code = demo_shapes(r);
    bar_hide();
    if (!code) {
        if (!o.quiet) demo_print(r, &checks);
        if (o.json) report_heat(r);
        code = close_stdout();
    }
    free(o.times);
    return code;
}

/* ==== main ==== */

/* All files are in their places: what is left is to free memory, and the answer is no longer "interrupted". */
static void ignore_interrupts(void)
{
    signal(SIGINT, SIG_IGN);
    signal(SIGTERM, SIG_IGN);
}

static int run_command(const options *o)
{
    run r;
    int code = DONE;
    run_begin(&r, o);
    switch (o->command) {
    case CMD_INFO: code = command_info(&r); break;
    case CMD_KERNEL: case CMD_DISTANCE: case CMD_HKS: code = command_columns(&r); break;
    case CMD_PAIRS: code = command_pairs(&r); break;
    case CMD_SAMPLE: code = command_sample(&r); break;
    case CMD_TRACE: code = command_trace(&r); break;
    case CMD_DIFFUSE: code = command_diffuse(&r); break;
    case CMD_SMOOTH: code = command_smooth(&r); break;
    case CMD_GEODESIC: code = command_geodesic(&r); break;
    case CMD_SPECTRUM: code = command_spectrum(&r); break;
    case CMD_LEVELS: code = command_levels(&r); break;
    case CMD_RENDER: code = command_render(&r); break;
    case CMD_DEMO: code = command_demo(&r); break;
    default: break;
    }
    if (code == DONE) ignore_interrupts();
    run_end(&r);
    return code;
}

static int fail_command(const char *name)
{
    char commands[160];
    const char *best = NULL;
    int i, slips = most_slips(name ? strlen(name) : 0);
    list_commands(CMD_ALL, commands, sizeof commands);
    for (i = 0; name && i < N_COMMANDS; i++) suggest(name, strlen(name), COMMANDS[i].name, &slips, &best);
    if (!name) return fail(USAGE, "a command is missing; there are %s (see heatdiff --help)", commands);
    if (best)
        return fail(USAGE, "'%.80s' is not a command; did you mean %s? There are %s", name, best, commands);
    return fail(USAGE, "'%.80s' is not a command; there are %s", name, commands);
}

/* Help and version work anywhere on the command line, before anything is checked or read. */
static int answer_questions(int argc, char **argv, const command_def *command)
{
    int i;
    for (i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (strcmp(argv[i], "--version") == 0) { print_version(); return 1; }
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            if (command) print_command_help(command);
            else print_help();
            return 1;
        }
        if (!command) return 0;
    }
    return 0;
}

int main(int argc, char **argv)
{
    options o;
    const command_def *command = argc > 1 ? find_command(argv[1]) : NULL;
    int code;
    catch_interrupts();
    if (answer_questions(argc, argv, command)) return close_stdout();
    if (!command) return fail_command(argc > 1 ? argv[1] : NULL);
    memset(&o, 0, sizeof o);
    o.program = argv[0];
    o.command = command->bit;
    o.kernel = o.command == CMD_HKS ? HD_KERNEL_SYMMETRIC : HD_KERNEL_OPERATOR;
    code = read_options(&o, argc, argv);
    if (!code) code = check_options(&o);
    if (!code) code = run_command(&o);
    free_options(&o);
    if (code == INTERRUPTED) {
        bar_hide();
        fprintf(stderr, "heatdiff: interrupted\n");
    }
    return code;
}
