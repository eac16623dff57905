/* picture.h - pictures of a field on a mesh or a point set, and a PNG writer; for tools and tests, only the C library

   A small software renderer: z-buffer, smooth normals, three soft lights, darkened creases, a shadow on the ground,
   a colour per pixel, isolines of constant width, a colour bar and text. All functions are static.

       pic_panel panel = {0};  pic_opts opts = {0};  pic_image img;
       panel.n = n;  panel.xyz = xyz;  panel.n_tri = n_tri;  panel.tri = tri;  panel.field = u;
       opts.title = "heat after t = 100 h^2";
       if (pic_render(&img, &panel, &opts) == PIC_OK) pic_png_write("heat.png", img.rgb, img.width, img.height);
       pic_image_free(&img);

   Zeros in both structs mean good defaults. Panels without triangles are drawn as discs. What cannot be drawn (indices out
   of range, coordinates that are not finite) is left out; values that are not finite are grey.

   Contents: [1] memory and numbers  [2] PNG  [3] colour  [4] canvas and text  [5] scale  [6] camera  [7] visibility
             [8] isolines  [9] light  [10] panel  [11] legend  [12] figure */

#ifndef PICTURE_H
#define PICTURE_H

#include <math.h>
#include <stddef.h>
#include <float.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PIC_OK = 0, PIC_ERR_ARGUMENT = 1, PIC_ERR_MEMORY = 2, PIC_ERR_FILE = 3 };
enum { PIC_MAP_EMBER = 0, PIC_MAP_LAGOON = 1, PIC_MAP_DIVERGING = 2, PIC_MAP_GREY = 3, PIC_MAP_COUNT = 4 };
enum { PIC_UP_Y = 0, PIC_UP_X = 1, PIC_UP_Z = 2 };
enum { PIC_MAX_SIDE = 16384 };

/* An image: width*height pixels, rows from the top, three bytes (sRGB) each. */
typedef struct pic_image {
    int32_t width, height;
    uint8_t *rgb;
    int lacking;                /* while it is drawn: something was left out for want of memory */
} pic_image;

/* What one panel shows. Nothing is copied or kept. */
typedef struct pic_panel {
    int32_t n, n_tri;           /* n_tri = 0: a point set */
    const double *xyz;          /* [3n] */
    const int32_t *tri;         /* [3n_tri], 0-based */
    const double *field;        /* [n], or NULL: plain clay */
    const char *caption;        /* below the panel, or NULL */
    const int32_t *markers;     /* [n_markers] vertices to mark with a ring, or NULL */
    int32_t n_markers;
} pic_panel;

/* Taste. In texts, ^ before an integer makes a superscript, _ between single letters a subscript: h^2, 10^-3, k_t. */
typedef struct pic_opts {
    int32_t width, height;      /* pixels; 1200 x 900 */
    int32_t supersample;        /* samples per pixel and direction, 1..8; 3, and fewer where memory says so */
    const char *title;          /* top left, or NULL */
    const char *subtitle;       /* below the title, or NULL */
    const char *label;          /* above the colour bar, or NULL */
    double log_decades;         /* > 0: logarithmic colours, this many decades below the largest value at most */
    double lo, hi;              /* range of the colours, when lo < hi; else that of the field */
    int32_t isolines;           /* 0: at about 12 round values; > 0: so many, equally spaced; < 0: none */
    int32_t colormap;           /* PIC_MAP_... */
    int32_t labels;             /* > 0: fields are labels 0..labels-1, a colour each without isolines; others are grey */
    int32_t up;                 /* PIC_UP_...: the axis that points up. The front is +z, or with z up -y */
    int32_t own_scale;          /* nonzero: every panel has its own range and legend, not one for all */
    int32_t no_legend;
    int32_t view_given;         /* nonzero: the two angles hold; else a view that shows the shape and its warmest place */
    double azimuth, elevation;  /* of the camera, degrees; 0, 0 looks at the front, azimuth 90 at the right side */
    int32_t one_view;           /* nonzero: panels of different meshes, too, are seen from where the first one is */
    double point_radius;        /* of the discs, in the points' unit; 0: from their spacing */
    int32_t columns;            /* of the grid of panels; 0: what fits best */
} pic_opts;

/* ==== [1] memory and numbers ==== */

static double pic_clamp(double x, double lo, double hi) { return x < lo ? lo : x > hi ? hi : x; }
static double pic_min(double a, double b) { return a < b ? a : b; }
static double pic_max(double a, double b) { return a > b ? a : b; }
static double pic_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static double pic_smooth(double x) { x = pic_clamp(x, 0, 1); return x * x * (3 - 2 * x); }
/* By its bits: arithmetic with infinity raises the invalid flag, as comparing NaN does. */
static int pic_finite(double x) { uint64_t bits; memcpy(&bits, &x, sizeof bits); return (bits >> 52 & 0x7ff) != 0x7ff; }

/* Scales v to length 1 and returns the length it had; a vector too short stays as it is, and 0 is returned. */
static double pic_unit(double v[3])
{
    const double len = sqrt(pic_dot(v, v));
    if (!(len > 1e-150)) return 0;
    v[0] /= len; v[1] /= len; v[2] /= len;
    return len;
}

/* malloc(count * size) or calloc, with the product checked. Never asks for 0 bytes. */
static void *pic_alloc(size_t count, size_t size)
{
    if (size != 0 && count > SIZE_MAX / size) return NULL;
    return malloc(count * size > 0 ? count * size : 1);
}

static void *pic_zalloc(size_t count, size_t size)
{
    return calloc(count > 0 ? count : 1, size > 0 ? size : 1);
}

/* ==== [2] PNG ==== */
/* RFC 1950, 1951 and the PNG specification: LZ77 with hash chains and lazy matches, Huffman codes per block. */

enum { PIC_Z_WINDOW = 32768, PIC_Z_TOKENS = 32768, PIC_Z_CHAIN = 48, PIC_Z_MIN = 3, PIC_Z_MAX = 258 };

/* Bytes that grow. After a failed allocation `failed` stays set and the rest is ignored. */
typedef struct pic_bytes {
    uint8_t *data;
    size_t size, room;
    int failed;
    uint64_t bits;              /* not yet written, lowest first */
    int n_bits;
} pic_bytes;

static void pic_put(pic_bytes *b, uint32_t byte)
{
    if (b->failed) return;
    if (b->size == b->room) {
        const size_t room = b->room < 4096 ? 4096 : b->room <= SIZE_MAX / 2 ? b->room * 2 : 0;
        uint8_t *data = room ? (uint8_t *)realloc(b->data, room) : NULL;
        if (!data) { b->failed = 1; return; }
        b->data = data;
        b->room = room;
    }
    b->data[b->size++] = (uint8_t)(byte & 255u);
}

static void pic_put_be32(pic_bytes *b, uint32_t x)
{
    pic_put(b, x >> 24); pic_put(b, x >> 16); pic_put(b, x >> 8); pic_put(b, x);
}

static void pic_put_bits(pic_bytes *b, uint32_t value, int count)
{
    b->bits |= (uint64_t)value << b->n_bits;
    for (b->n_bits += count; b->n_bits >= 8; b->n_bits -= 8, b->bits >>= 8) pic_put(b, (uint32_t)(b->bits & 255u));
}

static void pic_flush_bits(pic_bytes *b) { if (b->n_bits > 0) pic_put_bits(b, 0, 8 - b->n_bits); }

static uint32_t pic_crc32(const uint8_t *p, size_t size)
{
    uint32_t table[256], crc = 0xffffffffu, i;
    size_t k;
    for (i = 0; i < 256; i++) {
        uint32_t c = i;
        int bit;
        for (bit = 0; bit < 8; bit++) c = (c & 1u) ? 0xedb88320u ^ (c >> 1) : c >> 1;
        table[i] = c;
    }
    for (k = 0; k < size; k++) crc = table[(crc ^ p[k]) & 255u] ^ (crc >> 8);
    return crc ^ 0xffffffffu;
}

static uint32_t pic_adler32(const uint8_t *p, size_t size)
{
    uint32_t a = 1, b = 0;
    while (size > 0) {
        size_t part = size < 5552 ? size : 5552;    /* so many sums fit 32 bits */
        size -= part;
        while (part-- > 0) { a += *p++; b += a; }
        a %= 65521u; b %= 65521u;
    }
    return b << 16 | a;
}

/* Symbol of a value in a table of starts with extra bits: length 3..258 -> 257..285, distance 1..32768 -> 0..29. */
static int pic_length_symbol(int length, int *extra_bits, int *extra)
{
    int bits = 0, x = length - 3;
    if (length == 258) { *extra_bits = 0; *extra = 0; return 285; }
    while (x >> bits >= 8) bits++;
    *extra_bits = bits;
    *extra = x & ((1 << bits) - 1);
    return 257 + 4 * bits + (x >> bits);
}

static int pic_distance_symbol(int distance, int *extra_bits, int *extra)
{
    int bits = 0, x = distance - 1;
    while (x >> bits >= 4) bits++;
    *extra_bits = bits;
    *extra = x & ((1 << bits) - 1);
    return 2 * bits + (x >> bits);
}

/* How many codes of each length: Huffman's tree by repeated search for the two rarest (n <= 288, so n^2 is nothing). */
static void pic_huffman_counts(const uint32_t *freq, int n, int limit, int count[32])
{
    uint64_t weight[2 * 288];
    int parent[2 * 288], depth[2 * 288], alive[2 * 288], m = 0, nodes, i, k;
    int64_t excess = 0;
    for (i = 0; i < n; i++) if (freq[i]) { weight[m] = freq[i]; alive[m++] = 1; }
    for (i = 0; i < 32; i++) count[i] = 0;
    if (m == 1) count[1] = 1;
    if (m < 2) return;
    for (nodes = m; nodes < 2 * m - 1; nodes++) {
        int pick[2];
        for (k = 0; k < 2; k++) {
            pick[k] = -1;
            for (i = 0; i < nodes; i++) if (alive[i] && (pick[k] < 0 || weight[i] < weight[pick[k]])) pick[k] = i;
            alive[pick[k]] = 0;
            parent[pick[k]] = nodes;
        }
        weight[nodes] = weight[pick[0]] + weight[pick[1]];
        alive[nodes] = 1;
    }
    depth[nodes - 1] = 0;
    for (i = nodes - 2; i >= 0; i--) {
        depth[i] = depth[parent[i]] + 1;
        if (i < m) count[depth[i] < limit ? depth[i] : limit]++;
    }
    for (i = 1; i <= limit; i++) excess += (int64_t)count[i] << (limit - i);
    /* Cutting at the limit made the code too full. Give up one code of the longest length and split a shorter one in two:
     * the number of codes stays, the excess falls by exactly one, and the code ends complete, as inflaters demand. */
    for (excess -= (int64_t)1 << limit; excess > 0; excess--) {
        count[limit]--;
        for (i = limit - 1; count[i] == 0; i--) { }
        count[i]--;
        count[i + 1] += 2;
    }
}

/* Code lengths for n symbols; the rarer, the longer. */
static void pic_huffman_lengths(const uint32_t *freq, int n, int limit, uint8_t *len)
{
    int count[32], order[288], m = 0, i, k, l;
    pic_huffman_counts(freq, n, limit, count);
    for (i = 0; i < n; i++) {
        len[i] = 0;
        if (!freq[i]) continue;
        for (k = m++; k > 0 && freq[order[k - 1]] > freq[i]; k--) order[k] = order[k - 1];
        order[k] = i;
    }
    for (l = limit, k = 0; l > 0; l--) for (i = 0; i < count[l]; i++) len[order[k++]] = (uint8_t)l;
}

/* Canonical codes of these lengths, bits reversed because Huffman codes are written from their top bit. */
static void pic_huffman_codes(const uint8_t *len, int n, uint16_t *code)
{
    uint32_t next[17] = {0}, c = 0;
    int i, l;
    for (l = 1; l < 16; l++) {
        for (i = 0; i < n; i++) if (len[i] == l - 1 && l > 1) c++;
        c <<= 1;
        next[l] = c;
    }
    for (i = 0; i < n; i++) {
        uint32_t r = 0, x = len[i] ? next[len[i]]++ : 0;
        for (l = 0; l < len[i]; l++, x >>= 1) r = r << 1 | (x & 1u);
        code[i] = (uint16_t)r;
    }
}

/* The deflater's state. A token is a literal (distance 0 in the upper half) or a match (distance << 16 | length). */
typedef struct pic_deflate {
    pic_bytes *out;
    int32_t head[PIC_Z_WINDOW], prev[PIC_Z_WINDOW];
    uint32_t token[PIC_Z_TOKENS], n_tokens;
    uint32_t lit_freq[288], dist_freq[30];
    uint8_t lit_len[288], dist_len[30];
    uint16_t lit_code[288], dist_code[30];
} pic_deflate;

static void pic_deflate_emit(pic_deflate *z, uint32_t distance, uint32_t value)
{
    int bits, extra;
    z->token[z->n_tokens++] = distance << 16 | value;
    if (distance == 0) { z->lit_freq[value]++; return; }
    z->lit_freq[pic_length_symbol((int)value, &bits, &extra)]++;
    z->dist_freq[pic_distance_symbol((int)distance, &bits, &extra)]++;
}

/* The code lengths of a block, themselves run-length coded: symbols with their extra bits in the upper byte. */
static int pic_deflate_runs(const uint8_t *len, int n, uint16_t *run, uint32_t freq[19])
{
    int i = 0, m = 0;
    while (i < n) {
        int same = 1, sym = len[i], part;
        while (i + same < n && len[i + same] == len[i]) same++;
        i += same;
        if (sym != 0) { run[m++] = (uint16_t)sym; freq[sym]++; same--; }
        while (same >= 3) {
            part = sym != 0 ? (same < 6 ? same : 6) : (same < 138 ? same : 138);
            run[m] = (uint16_t)(sym != 0 ? 16 | (part - 3) << 8 : part < 11 ? 17 | (part - 3) << 8 : 18 | (part - 11) << 8);
            freq[run[m++] & 255]++;
            same -= part;
        }
        while (same-- > 0) { run[m++] = (uint16_t)sym; freq[sym]++; }
    }
    return m;
}

static void pic_deflate_header(pic_deflate *z)
{
    static const uint8_t order[19] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
    static const uint8_t extra[19] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 3, 7};
    uint8_t all[286 + 30], len[19];
    uint16_t run[286 + 30], code[19];
    uint32_t freq[19] = {0};
    int n_lit = 286, n_dist = 30, n_len = 19, m, i;
    while (n_lit > 257 && z->lit_len[n_lit - 1] == 0) n_lit--;
    while (n_dist > 1 && z->dist_len[n_dist - 1] == 0) n_dist--;
    memcpy(all, z->lit_len, (size_t)n_lit);
    memcpy(all + n_lit, z->dist_len, (size_t)n_dist);
    m = pic_deflate_runs(all, n_lit + n_dist, run, freq);
    pic_huffman_lengths(freq, 19, 7, len);
    pic_huffman_codes(len, 19, code);
    while (n_len > 4 && len[order[n_len - 1]] == 0) n_len--;
    pic_put_bits(z->out, (uint32_t)(n_lit - 257), 5);
    pic_put_bits(z->out, (uint32_t)(n_dist - 1), 5);
    pic_put_bits(z->out, (uint32_t)(n_len - 4), 4);
    for (i = 0; i < n_len; i++) pic_put_bits(z->out, len[order[i]], 3);
    for (i = 0; i < m; i++) {
        const int sym = run[i] & 255;
        pic_put_bits(z->out, code[sym], len[sym]);
        pic_put_bits(z->out, (uint32_t)(run[i] >> 8), extra[sym]);
    }
}

static void pic_deflate_fixed_lengths(pic_deflate *z)
{
    int i;
    for (i = 0; i < 288; i++) z->lit_len[i] = (uint8_t)(i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8);
    memset(z->dist_len, 5, sizeof z->dist_len);
}

/* Writes the gathered tokens as one block: short ones with the fixed codes, whose header costs nothing. */
static void pic_deflate_block(pic_deflate *z, int last)
{
    const int dynamic = z->n_tokens > 100;
    uint32_t i;
    int bits = 0, extra = 0, sym;
    z->lit_freq[256] = 1;
    if (dynamic) {
        z->dist_freq[0] += 1;       /* two codes at least: some inflaters are particular about a lone one */
        z->dist_freq[1] += 1;
        pic_huffman_lengths(z->lit_freq, 286, 15, z->lit_len);
        pic_huffman_lengths(z->dist_freq, 30, 15, z->dist_len);
    } else pic_deflate_fixed_lengths(z);
    pic_huffman_codes(z->lit_len, dynamic ? 286 : 288, z->lit_code);
    pic_huffman_codes(z->dist_len, 30, z->dist_code);
    pic_put_bits(z->out, (uint32_t)last | (dynamic ? 4u : 2u), 3);
    if (dynamic) pic_deflate_header(z);
    for (i = 0; i < z->n_tokens; i++) {
        const int distance = (int)(z->token[i] >> 16), value = (int)(z->token[i] & 65535u);
        sym = distance ? pic_length_symbol(value, &bits, &extra) : value;
        pic_put_bits(z->out, z->lit_code[sym], z->lit_len[sym]);
        if (!distance) continue;
        pic_put_bits(z->out, (uint32_t)extra, bits);
        sym = pic_distance_symbol(distance, &bits, &extra);
        pic_put_bits(z->out, z->dist_code[sym], z->dist_len[sym]);
        pic_put_bits(z->out, (uint32_t)extra, bits);
    }
    pic_put_bits(z->out, z->lit_code[256], z->lit_len[256]);
    z->n_tokens = 0;
    memset(z->lit_freq, 0, sizeof z->lit_freq);
    memset(z->dist_freq, 0, sizeof z->dist_freq);
}

/* Enters position i into the chains; returns the one before it with the same hash, or -1. */
static int32_t pic_deflate_enter(pic_deflate *z, const uint8_t *p, size_t n, size_t i)
{
    uint32_t h;
    int32_t j;
    if (n - i < PIC_Z_MIN) return -1;
    h = (((uint32_t)p[i] << 16 | (uint32_t)p[i + 1] << 8 | p[i + 2]) * 2654435761u) >> 17;
    j = z->head[h];
    z->head[h] = (int32_t)i;
    z->prev[i & (PIC_Z_WINDOW - 1)] = j;
    return j;
}

/* Longest earlier copy of what starts at i, which is entered. Returns its length, 0 when below 3. */
static int pic_deflate_match(pic_deflate *z, const uint8_t *p, size_t n, size_t i, int *distance)
{
    const int most = n - i < PIC_Z_MAX ? (int)(n - i) : PIC_Z_MAX;
    int best = 0, chain = PIC_Z_CHAIN;
    int32_t j = pic_deflate_enter(z, p, n, i);
    for (; j >= 0 && i - (size_t)j <= PIC_Z_WINDOW && chain-- > 0; j = z->prev[j & (PIC_Z_WINDOW - 1)]) {
        const uint8_t *a = p + i, *b = p + j;
        int len = 0;
        if (best > 0 && a[best] != b[best]) continue;
        while (len < most && a[len] == b[len]) len++;
        if (len > best) { best = len; *distance = (int)(i - (size_t)j); }
        if (best == most) break;
    }
    return best < PIC_Z_MIN ? 0 : best;
}

static int pic_deflate_run(pic_bytes *out, const uint8_t *p, size_t n)
{
    pic_deflate *z = (pic_deflate *)pic_zalloc(1, sizeof *z);
    size_t i, k;
    int len, distance = 0, held = 0, held_distance = 0;
    if (!z) return PIC_ERR_MEMORY;
    z->out = out;
    for (k = 0; k < PIC_Z_WINDOW; k++) z->head[k] = -1;
    /* A match is held back one step: if the next byte starts a longer one, a literal goes out instead. */
    for (i = 0; i < n || held; ) {
        len = i < n ? pic_deflate_match(z, p, n, i, &distance) : 0;
        if (held && held >= len) {
            pic_deflate_emit(z, (uint32_t)held_distance, (uint32_t)held);
            for (k = 1; k + 1 < (size_t)held; k++) pic_deflate_enter(z, p, n, i + k);
            i += (size_t)held - 1;
            held = 0;
        } else {
            if (held) pic_deflate_emit(z, 0, p[i - 1]);
            held = len;
            held_distance = distance;
            if (!held) pic_deflate_emit(z, 0, p[i]);
            i++;
        }
        if (z->n_tokens > PIC_Z_TOKENS - 4) pic_deflate_block(z, 0);
    }
    pic_deflate_block(z, 1);
    pic_flush_bits(out);
    free(z);
    return out->failed ? PIC_ERR_MEMORY : PIC_OK;
}

static uint8_t pic_paeth(int a, int b, int c)
{
    const int p = a + b - c, pa = abs(p - a), pb = abs(p - b), pc = abs(p - c);
    return (uint8_t)(pa <= pb && pa <= pc ? a : pb <= pc ? b : c);
}

/* Filters one row with the given PNG filter and returns the sum of absolute differences. up may be NULL. */
static uint64_t pic_filter_row(uint8_t *out, const uint8_t *row, const uint8_t *up, size_t n, int filter)
{
    uint64_t sum = 0;
    size_t i;
    for (i = 0; i < n; i++) {
        const int a = i >= 3 ? row[i - 3] : 0, b = up ? up[i] : 0, c = up && i >= 3 ? up[i - 3] : 0;
        int guess = 0;
        if (filter == 1) guess = a;
        else if (filter == 2) guess = b;
        else if (filter == 3) guess = (a + b) / 2;
        else if (filter == 4) guess = pic_paeth(a, b, c);
        out[i] = (uint8_t)(row[i] - guess);
        sum += out[i] < 128 ? out[i] : 256u - out[i];
    }
    return sum;
}

/* All rows, each with its best filter: the bytes that PNG compresses. scratch: 3w bytes. */
static void pic_filter_image(uint8_t *raw, uint8_t *scratch, const uint8_t *rgb, size_t row_bytes, int32_t h)
{
    int32_t y;
    int f;
    for (y = 0; y < h; y++) {
        const uint8_t *row = rgb + (size_t)y * row_bytes, *up = y > 0 ? row - row_bytes : NULL;
        uint8_t *out = raw + (size_t)y * (row_bytes + 1);
        uint64_t best = UINT64_MAX;
        for (f = 0; f < 5; f++) {
            const uint64_t sum = pic_filter_row(scratch, row, up, row_bytes, f);
            if (sum >= best) continue;
            best = sum;
            out[0] = (uint8_t)f;
            memcpy(out + 1, scratch, row_bytes);
        }
    }
}

/* A chunk's length and checksum are known only when its data is there: begin keeps the place, end fills it in. */
static size_t pic_chunk_begin(pic_bytes *b, const char *name)
{
    int i;
    pic_put_be32(b, 0);
    for (i = 0; i < 4; i++) pic_put(b, (uint8_t)name[i]);
    return b->size;
}

static void pic_chunk_end(pic_bytes *b, size_t start)
{
    size_t n;
    int i;
    if (b->failed) return;
    n = b->size - start;
    for (i = 0; i < 4; i++) b->data[start - 8 + (size_t)i] = (uint8_t)(n >> (24 - 8 * i));
    pic_put_be32(b, pic_crc32(b->data + start - 4, n + 4));
}

/* A PNG file in memory: *out is malloc'd, *size its bytes. rgb: 3wh bytes, w and h in 1..PIC_MAX_SIDE. */
static int pic_png_encode(uint8_t **out, size_t *size, const uint8_t *rgb, int32_t w, int32_t h)
{
    static const uint8_t signature[8] = {137, 80, 78, 71, 13, 10, 26, 10};
    pic_bytes b = {NULL, 0, 0, 0, 0, 0};
    uint8_t *raw, *scratch;
    size_t i, start, row_bytes, n;
    *out = NULL;
    *size = 0;
    if (!rgb || w < 1 || h < 1 || w > PIC_MAX_SIDE || h > PIC_MAX_SIDE) return PIC_ERR_ARGUMENT;
    row_bytes = (size_t)w * 3;
    n = (row_bytes + 1) * (size_t)h;
    raw = (uint8_t *)pic_alloc((size_t)h, row_bytes + 1);
    scratch = (uint8_t *)pic_alloc(row_bytes, 1);
    b.failed = !raw || !scratch;
    if (!b.failed) {
        pic_filter_image(raw, scratch, rgb, row_bytes, h);
        for (i = 0; i < 8; i++) pic_put(&b, signature[i]);
        start = pic_chunk_begin(&b, "IHDR");
        pic_put_be32(&b, (uint32_t)w);
        pic_put_be32(&b, (uint32_t)h);
        pic_put_be32(&b, 0x08020000u);      /* 8 bits, red green blue, the one compression, the one filter set */
        pic_put(&b, 0);                     /* not interlaced */
        pic_chunk_end(&b, start);
        start = pic_chunk_begin(&b, "sRGB");
        pic_put(&b, 0);
        pic_chunk_end(&b, start);
        start = pic_chunk_begin(&b, "IDAT");
        pic_put(&b, 0x78); pic_put(&b, 0x9c);
        if (pic_deflate_run(&b, raw, n) != PIC_OK) b.failed = 1;
        pic_put_be32(&b, pic_adler32(raw, n));
        pic_chunk_end(&b, start);
        start = pic_chunk_begin(&b, "IEND");
        pic_chunk_end(&b, start);
    }
    free(raw);
    free(scratch);
    if (b.failed) { free(b.data); return PIC_ERR_MEMORY; }
    *out = b.data;
    *size = b.size;
    return PIC_OK;
}

/* Renames a file over another. Where rename does not replace, the old file has to go first. */
static int pic_replace(const char *from, const char *to)
{
#ifdef _WIN32
    remove(to);
#endif
    return rename(from, to) == 0;
}

/* Writes a PNG file: first under a temporary name beside it, then renamed, so that nothing half written is ever seen. */
static int pic_png_write(const char *path, const uint8_t *rgb, int32_t w, int32_t h)
{
    uint8_t *data;
    size_t size, n = path ? strlen(path) : 0, name = n;
    char *temp;
    FILE *file;
    int ok, status;
    if (n == 0) return PIC_ERR_ARGUMENT;
    status = pic_png_encode(&data, &size, rgb, w, h);
    if (status != PIC_OK) return status;
    while (name > 0 && path[name - 1] != '/') name--;
    if (n - name > 100) n = name + 100;                  /* names have an end: 255 bytes, or fewer */
    temp = (char *)pic_alloc(n + 6, 1);
    if (!temp) { free(data); return PIC_ERR_MEMORY; }
    memcpy(temp, path, n);
    memcpy(temp + n, ".part", 6);
    file = fopen(temp, "wb");
    ok = file != NULL;
    if (ok) {
        ok = fwrite(data, 1, size, file) == size;
        ok = fclose(file) == 0 && ok;
        if (ok) ok = pic_replace(temp, path);
        if (!ok) remove(temp);
    }
    free(temp);
    free(data);
    return ok ? PIC_OK : PIC_ERR_FILE;
}

static void pic_image_free(pic_image *img)
{
    free(img->rgb);
    img->rgb = NULL;
    img->width = img->height = 0;
}

/* ==== [3] colour ==== */
/* Maps are a few colours in OKLab (Bjorn Ottosson 2020), where equal steps look equal, joined by a smooth curve. Lightness
 * is linear from end to end (twice, in the diverging map); colours outside sRGB lose chroma, never lightness. */

typedef struct pic_lch { double l, c, h; } pic_lch;     /* lightness 0..1, chroma, hue in degrees */

static double pic_to_srgb(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055; }
static double pic_to_linear(double x) { return x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4); }
static uint8_t pic_byte(double x) { return (uint8_t)(255 * pic_clamp(x, 0, 1) + 0.5); }

static void pic_oklab_to_linear(double l, double a, double b, double rgb[3])
{
    const double p = l + 0.3963377774 * a + 0.2158037573 * b, q = l - 0.1055613458 * a - 0.0638541728 * b,
                 r = l - 0.0894841775 * a - 1.2914855480 * b, p3 = p * p * p, q3 = q * q * q, r3 = r * r * r;
    rgb[0] = 4.0767416621 * p3 - 3.3077115913 * q3 + 0.2309699292 * r3;
    rgb[1] = -1.2684380046 * p3 + 2.6097574011 * q3 - 0.3413193965 * r3;
    rgb[2] = -0.0041960863 * p3 - 0.7034186147 * q3 + 1.7076147010 * r3;
}

/* Catmull-Rom through equally spaced values; the curve's ends continue straight. */
static double pic_spline(double a, double b, double c, double d, double t)
{
    return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

static const pic_lch *pic_map_points(int which, int *n)
{
    static const pic_lch ember[6] = {{0.425, 0.135, 272}, {0.53, 0.185, 303}, {0.635, 0.205, 352}, {0.74, 0.172, 40},
                                     {0.845, 0.148, 75}, {0.95, 0.085, 103}};
    static const pic_lch lagoon[6] = {{0.35, 0.120, 296}, {0.464, 0.125, 266}, {0.578, 0.100, 225}, {0.692, 0.120, 172},
                                      {0.806, 0.165, 138}, {0.92, 0.170, 107}};
    static const pic_lch diverging[7] = {{0.42, 0.165, 262}, {0.60, 0.135, 254}, {0.78, 0.080, 245}, {0.96, 0.0, 0},
                                         {0.78, 0.095, 42}, {0.60, 0.165, 30}, {0.42, 0.165, 25}};
    static const pic_lch grey[2] = {{0.36, 0.012, 260}, {0.95, 0.006, 90}};
    *n = which == PIC_MAP_DIVERGING ? 7 : which == PIC_MAP_GREY ? 2 : 6;
    return which == PIC_MAP_DIVERGING ? diverging : which == PIC_MAP_GREY ? grey : which == PIC_MAP_LAGOON ? lagoon : ember;
}

/* The map's colour in linear light. */
static void pic_map_linear(double s, double rgb[3], int which)
{
    const double rad = 0.017453292519943295;
    int n, i, k;
    const pic_lch *p = pic_map_points(which, &n);
    double u, l, lab[2][4], a, b, keep;
    s = pic_finite(s) ? pic_clamp(s, 0, 1) : 0;
    u = s * (n - 1);
    i = u >= n - 1 ? n - 2 : (int)u;
    u -= i;
    for (k = 1; k < 3; k++) {
        lab[0][k] = p[i + k - 1].c * cos(p[i + k - 1].h * rad);
        lab[1][k] = p[i + k - 1].c * sin(p[i + k - 1].h * rad);
    }
    for (k = 0; k < 2; k++) {
        lab[k][0] = i > 0 ? p[i - 1].c * (k ? sin(p[i - 1].h * rad) : cos(p[i - 1].h * rad)) : 2 * lab[k][1] - lab[k][2];
        lab[k][3] = i + 2 < n ? p[i + 2].c * (k ? sin(p[i + 2].h * rad) : cos(p[i + 2].h * rad)) : 2 * lab[k][2] - lab[k][1];
    }
    l = p[i].l + u * (p[i + 1].l - p[i].l);
    a = pic_spline(lab[0][0], lab[0][1], lab[0][2], lab[0][3], u);
    b = pic_spline(lab[1][0], lab[1][1], lab[1][2], lab[1][3], u);
    for (keep = 1; keep > 0; keep -= 1.0 / 64) {
        pic_oklab_to_linear(l, a * keep, b * keep, rgb);
        if (pic_min(rgb[0], pic_min(rgb[1], rgb[2])) >= -1e-4 && pic_max(rgb[0], pic_max(rgb[1], rgb[2])) <= 1.0001) break;
    }
    for (k = 0; k < 3; k++) rgb[k] = pic_clamp(rgb[k], 0, 1);
}

enum { PIC_LUT = 1024 };                                /* steps of a tabulated map */

/* The colour of a label in linear light: hues a golden angle apart, so that those of labels near each other are far apart,
 * in three lightnesses. */
static void pic_label_linear(int32_t label, double rgb[3])
{
    static const double lightness[3] = {0.60, 0.80, 0.70};
    const double hue = 0.017453292519943295 * fmod(262 + 137.50776405 * label, 360), chroma = 0.135;
    double keep;
    int k;
    for (keep = 1; keep > 0; keep -= 1.0 / 64) {
        pic_oklab_to_linear(lightness[label % 3], keep * chroma * cos(hue), keep * chroma * sin(hue), rgb);
        if (pic_min(rgb[0], pic_min(rgb[1], rgb[2])) >= 0 && pic_max(rgb[0], pic_max(rgb[1], rgb[2])) <= 1) break;
    }
    for (k = 0; k < 3; k++) rgb[k] = pic_clamp(rgb[k], 0, 1);
}

static void pic_label_colour(int32_t label, uint8_t rgb[3])
{
    double lin[3];
    int k;
    pic_label_linear(label % (PIC_LUT + 1), lin);
    for (k = 0; k < 3; k++) rgb[k] = pic_byte(pic_to_srgb(lin[k]));
}

/* Colour of s in [0,1] (clamped; not finite: the grey of missing values), sRGB bytes. */
static void pic_colormap(double s, uint8_t rgb[3], int which)
{
    double lin[3];
    int k;
    if (!pic_finite(s)) { rgb[0] = rgb[1] = rgb[2] = 168; return; }
    pic_map_linear(s, lin, which);
    for (k = 0; k < 3; k++) rgb[k] = pic_byte(pic_to_srgb(lin[k]));
}

/* A map tabulated for per-pixel use, linear light; with labels the colour of each. Of more labels than entries some share one. */
typedef struct pic_lut { double rgb[PIC_LUT + 1][3]; int32_t labels; } pic_lut;

static void pic_lut_fill(pic_lut *lut, int which, int32_t labels)
{
    int i;
    lut->labels = labels;
    for (i = 0; i <= PIC_LUT && labels > 0; i++) pic_label_linear(i, lut->rgb[i]);
    for (i = 0; i <= PIC_LUT && labels <= 0; i++) pic_map_linear(i / (double)PIC_LUT, lut->rgb[i], which);
}

static void pic_lut_at(const pic_lut *lut, double s, double rgb[3])
{
    const double u = pic_clamp(s, 0, 1) * PIC_LUT;
    const int i = u >= PIC_LUT ? PIC_LUT - 1 : (int)u;
    int k;
    if (lut->labels > 0) {
        const int32_t label = (int32_t)pic_clamp(s * lut->labels, 0, lut->labels - 1);
        memcpy(rgb, lut->rgb[label % (PIC_LUT + 1)], 3 * sizeof *rgb);
        return;
    }
    for (k = 0; k < 3; k++) rgb[k] = lut->rgb[i][k] + (u - i) * (lut->rgb[i + 1][k] - lut->rgb[i][k]);
}

/* ==== [4] canvas and text ==== */
/* Shapes are blended into the sRGB bytes by how much of a pixel they cover, told from the distance to its centre.

   The letters are strokes on a grid: x from 0, y with the baseline at 4, small letters up to e (14), capitals to i (18),
   both as digits in base 36. A glyph is its width, then strokes: `-` a polyline, `~` a quadratic B-spline from the
   first to the last point, `@` a closed one, `.` a dot. */

static const char *const pic_glyphs[95] = {
    "5", "0 -0i09 .04", "4 -0i0e -4i4e", "a -3i14 -9i74 -0dad -09a9", "8 ~8f8i0i0b8b840407 -4k42",
    "c -bi14 @0d4d4i0i @84c4c989", "a ~a41e1i7i7e0b0484aa", "0 -0i0e", "4 ~4k0g0642", "4 ~0k4g4602",
    "8 -4h49 -0f8b -8f0b", "8 -4f47 -0b8b", "1 -1501", "6 -0b6b", "0 .04", "7 -7k02",
    "8 @04848i0i", "6 -1f5i54", "8 ~0e0i8i8c04 -0484", "8 ~0f0i8i8b3b ~3b8b840407", "9 -747i0899",
    "8 -7i1i0b ~0b1d8d840407", "8 @04848d0d ~080i7i", "8 -0i8i34", "8 @1b7b7i1i @04848b0b", "8 @09898i0i ~8e8414",
    "0 .04 .0d", "1 -1501 .1d", "8 -8f0b87", "8 -0d8d -0989", "8 -0f8b07", "7 ~0f0i7i7d3c38 .34",
    "d @48989e4e ~9e97d7di0i03b3", "a -045ia4 -2989", "9 -0i04 -0i4i ~4i8i8b4b -0b4b ~4b9b9444 -0444", "9 ~9e9i0i049498",
    "9 -0i04 -0i3i ~3i9i9434 -0434", "7 -7i0i0474 -0b6b", "7 -7i0i04 -0b6b", "a ~9f9i0i04a4ab -ab6b",
    "9 -0i04 -9i94 -0b9b", "0 -0i04", "6 -6i69 ~69640408", "8 -0i04 -8i09 -3c84", "7 -0i0474", "b -040i58bib4",
    "9 -040i949i", "a @04a4ai0i", "8 -0i04 -0i4i ~4i8i8a4a -0a4a", "a @04a4ai0i -67a3",
    "8 -0i04 -0i4i ~4i8i8b4b -0b4b -4b84", "8 ~8f8i0i0b8b840407", "8 -0i8i -4i44", "9 -0i0a ~0a04949a -9a9i",
    "a -0i54ai", "e -0i347gb4ei", "9 -0i94 -9i04", "8 -0i4b8i -4b44", "8 -0i8i0484", "3 -3k0k0232", "7 -0k72",
    "3 -0k3k3202", "8 -0d4i8d", "8 -0282", "3 -0i3f",
    "7 @04747e0e -7e74", "8 -0i04 @04848e0e", "7 ~7c7e0e047476", "8 -8i84 @04848e0e", "8 ~898e0e048486 -0989",
    "5 ~5i2i2d -2d24 -0e5e", "8 @04848e0e -8e83 ~83800001", "7 -0i04 ~0a0e7e7a -7a74", "0 -0e04 .0i",
    "2 .2i -2e22 ~222000", "7 -0i04 -7e08 -3b74", "2 -0i07 ~070424", "c -0e04 ~0b0e6e6b -6b64 ~6b6ececb -cbc4",
    "7 -0e04 ~0a0e7e7a -7a74", "8 @04848e0e", "8 -0e00 @04848e0e", "8 -8e80 @04848e0e", "5 -0e04 ~0a0e5e",
    "7 ~7c7e0e0979740406", "5 -2h27 ~272454 -0e5e", "7 -0e08 ~08047478 -7e74", "8 -0e448e", "c -0e346d94ce",
    "7 -0e74 -7e04", "8 -0e44 -8e20", "7 -0e7e0474", "5 ~5k2k2b0b ~0b2b2252", "0 -0k02", "5 ~0k3k3b5b ~5b3b3202",
    "9 ~0a1d4d5a8a9d"};
static const char *const pic_glyph_times = "8 -0e86 -8e06";
static const char *const pic_glyph_dash = "a -0bab";
static const char *const pic_glyph_dot = "0 .0b";
static const char *const pic_glyph_unknown = "8 -04848i0i04";

static int pic_digit(char c) { return c >= 'a' ? c - 'a' + 10 : c - '0'; }

/* Blends colour over pixel (x, y) with weight a; outside the image nothing happens. */
static void pic_blend(pic_image *img, int32_t x, int32_t y, const uint8_t rgb[3], double a)
{
    uint8_t *p;
    int k;
    if (x < 0 || y < 0 || x >= img->width || y >= img->height || a <= 0) return;
    p = img->rgb + 3 * ((size_t)y * (size_t)img->width + (size_t)x);
    for (k = 0; k < 3; k++) p[k] = pic_byte((p[k] + (rgb[k] - p[k]) * pic_min(a, 1)) / 255);
}

static void pic_fill_rect(pic_image *img, double x0, double y0, double x1, double y1, const uint8_t rgb[3], double a)
{
    int32_t x, y;
    for (y = (int32_t)floor(y0); y < y1; y++) {
        const double cy = pic_min(y + 1, y1) - pic_max(y, y0);
        for (x = (int32_t)floor(x0); x < x1; x++) pic_blend(img, x, y, rgb, a * cy * (pic_min(x + 1, x1) - pic_max(x, x0)));
    }
}

/* A ring of the given middle radius and half width; with radius 0 a disc. */
static void pic_ring(pic_image *img, double cx, double cy, double radius, double half, const uint8_t rgb[3], double a)
{
    const int32_t reach = (int32_t)(radius + half) + 2, x0 = (int32_t)cx, y0 = (int32_t)cy;
    int32_t x, y;
    for (y = y0 - reach; y <= y0 + reach; y++) for (x = x0 - reach; x <= x0 + reach; x++) {
        const double dx = x + 0.5 - cx, dy = y + 0.5 - cy, dist = fabs(sqrt(dx * dx + dy * dy) - radius);
        pic_blend(img, x, y, rgb, a * pic_clamp(half + 0.5 - dist, 0, 1));
    }
}

/* Distance from p to the segment ab, and where along it (0..1) the nearest point lies. */
static double pic_segment_distance(const double p[2], const double a[2], const double b[2], double *where)
{
    const double ux = b[0] - a[0], uy = b[1] - a[1], vx = p[0] - a[0], vy = p[1] - a[1], uu = ux * ux + uy * uy;
    const double t = uu > 0 ? pic_clamp((ux * vx + uy * vy) / uu, 0, 1) : 0, dx = vx - t * ux, dy = vy - t * uy;
    *where = t;
    return sqrt(dx * dx + dy * dy);
}

/* A pen: where text stands, how large, and the coverage it leaves. Strokes of one text must not darken where they meet, so
 * they are gathered (largest coverage wins) before anything is blended. */
typedef struct pic_pen {
    double x, y, unit, half;    /* origin and grid unit of the current glyph, half the stroke's width, all in pixels */
    int32_t x0, y0, w, h;       /* the gathered part of the image */
    uint8_t *cover;             /* [w*h] */
} pic_pen;

static void pic_pen_segment(pic_pen *pen, const double a[2], const double b[2], double half)
{
    const double p[2] = {pen->x + a[0] * pen->unit - pen->x0, pen->y - (a[1] - 4) * pen->unit - pen->y0};
    const double q[2] = {pen->x + b[0] * pen->unit - pen->x0, pen->y - (b[1] - 4) * pen->unit - pen->y0};
    const int32_t xa = (int32_t)pic_max(0, pic_min(p[0], q[0]) - half - 1);
    const int32_t ya = (int32_t)pic_max(0, pic_min(p[1], q[1]) - half - 1);
    const double xb = pic_min(pen->w, pic_max(p[0], q[0]) + half + 1), yb = pic_min(pen->h, pic_max(p[1], q[1]) + half + 1);
    int32_t x, y;
    for (y = ya; y < yb; y++) for (x = xa; x < xb; x++) {
        const double c[2] = {x + 0.5, y + 0.5};
        double where;
        const uint8_t v = pic_byte(half + 0.5 - pic_segment_distance(c, p, q, &where));
        uint8_t *old = pen->cover + (size_t)y * (size_t)pen->w + (size_t)x;
        if (v > *old) *old = v;
    }
}

/* The piece of a quadratic B-spline from a to c with control point b. */
static void pic_pen_arc(pic_pen *pen, const double a[2], const double b[2], const double c[2])
{
    enum { PIECES = 10 };
    double last[2] = {a[0], a[1]};
    int i, k;
    for (i = 1; i <= PIECES; i++) {
        const double t = i / (double)PIECES;
        double p[2];
        for (k = 0; k < 2; k++) p[k] = (1 - t) * (1 - t) * a[k] + 2 * t * (1 - t) * b[k] + t * t * c[k];
        pic_pen_segment(pen, last, p, pen->half);
        last[0] = p[0];
        last[1] = p[1];
    }
}

static void pic_pen_stroke(pic_pen *pen, char kind, double (*p)[2], int n)
{
    int i, k;
    if (kind == '.') pic_pen_segment(pen, p[0], p[0], pen->half * 1.35);
    if (kind == '-') for (i = 1; i < n; i++) pic_pen_segment(pen, p[i - 1], p[i], pen->half);
    if (kind != '~' && kind != '@') return;
    for (i = kind == '@' ? 0 : 1; i < (kind == '@' ? n : n - 1); i++) {
        const double *a = p[(i + n - 1) % n], *b = p[i], *c = p[(i + 1) % n];
        double from[2], to[2];
        for (k = 0; k < 2; k++) {
            from[k] = kind == '~' && i == 1 ? a[k] : 0.5 * (a[k] + b[k]);
            to[k] = kind == '~' && i == n - 2 ? c[k] : 0.5 * (b[k] + c[k]);
        }
        pic_pen_arc(pen, from, b, to);
    }
}

static void pic_pen_glyph(pic_pen *pen, const char *g)
{
    double p[24][2];
    for (g++; *g; ) {
        char kind;
        int n = 0;
        while (*g == ' ') g++;
        for (kind = *g++; g[0] && g[0] != ' '; g += 2, n++) {
            p[n][0] = pic_digit(g[0]);
            p[n][1] = pic_digit(g[1]);
        }
        pic_pen_stroke(pen, kind, p, n);
    }
}

/* The next glyph of a UTF-8 text, which is moved on. Besides ASCII: multiplication sign, middle dot, dashes and minus. */
static const char *pic_next_glyph(const char **text)
{
    const unsigned char *p = (const unsigned char *)*text;
    const char *g = pic_glyph_unknown;
    if (*p < 0x80) {
        *text += 1;
        return *p >= 32 && *p < 127 ? pic_glyphs[*p - 32] : pic_glyphs[0];
    }
    if (p[0] == 0xc3 && p[1] == 0x97) g = pic_glyph_times;
    if (p[0] == 0xc2 && p[1] == 0xb7) g = pic_glyph_dot;
    if (p[0] == 0xe2 && ((p[1] == 0x80 && (p[2] == 0x93 || p[2] == 0x94)) || (p[1] == 0x88 && p[2] == 0x92))) g = pic_glyph_dash;
    for (p++; (*p & 0xc0) == 0x80; p++) { }
    *text = (const char *)p;
    return g;
}

static int pic_is_word(char c) { return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

/* Length of a superscript that starts here with ^: the sign and digits after it, 0 when there is none. */
static int pic_superscript(const char *p)
{
    int n = 1;
    if (p[0] != '^') return 0;
    if (p[n] == '-') n++;
    if (p[n] < '0' || p[n] > '9') return 0;
    while (p[n] >= '0' && p[n] <= '9') n++;
    return n - 1;
}

/* Whether a subscript starts at text[i]: an underscore between two single letters, as in k_t but not in heat_on_mesh. */
static int pic_subscript(const char *text, size_t i)
{
    return text[i] == '_' && i > 0 && pic_is_word(text[i - 1]) && (i < 2 || !pic_is_word(text[i - 2])) &&
           pic_is_word(text[i + 1]) && !pic_is_word(text[i + 2]) && text[i + 2] != '_';
}

/* Draws a text, or with pen NULL only measures it. Returns its width in pixels. cap: height of a capital. */
static double pic_text_walk(pic_pen *pen, const char *text, double x, double y, double cap)
{
    const char *at = text;
    const double start = x;
    double shift = 0;       /* of the raised or lowered glyphs, of which so many are left */
    int small = 0;
    while (*at) {
        const int super = small ? 0 : pic_superscript(at), sub = !small && pic_subscript(text, (size_t)(at - text));
        const char *g;
        double unit;
        if (super || sub) {
            small = super ? super : 1;
            shift = super ? 0.52 : -0.24;
            at++;
        }
        unit = cap / 14 * (small ? 0.66 : 1);
        g = pic_next_glyph(&at);
        if (pen) {
            pen->x = x + 1.6 * unit;
            pen->y = y - (small ? shift * cap : 0);
            pen->unit = unit;
            pic_pen_glyph(pen, g);
        }
        x += (pic_digit(g[0]) + 3.6) * unit;
        if (small) small--;
    }
    return x - start;
}

static double pic_text_width(const char *text, double cap) { return text ? pic_text_walk(NULL, text, 0, 0, cap) : 0; }

/* Text with its baseline at y; align 0: x is the left end, 0.5 the middle, 1 the right end. weight 1 is regular. Without
 * memory the text is left out, and the image told. */
static void pic_text(pic_image *img, const char *text, double x, double y, double cap, double align, double weight,
                     const uint8_t rgb[3])
{
    const double width = pic_text_width(text, cap);
    pic_pen pen;
    int32_t i, j;
    if (!text || !*text || !(cap > 0)) return;
    x -= align * width;
    pen.half = pic_max(0.055 * cap, 0.45) * weight;
    pen.x0 = (int32_t)floor(pic_max(x - cap, -4));
    pen.y0 = (int32_t)floor(y - 1.6 * cap);
    pen.w = (int32_t)pic_min(width + 2 * cap + 4, img->width + 8.0);
    pen.h = (int32_t)(2.2 * cap) + 3;
    pen.cover = (uint8_t *)pic_zalloc((size_t)pen.w * (size_t)pen.h, 1);
    if (!pen.cover) { img->lacking = 1; return; }
    pic_text_walk(&pen, text, x, y, cap);
    for (j = 0; j < pen.h; j++) for (i = 0; i < pen.w; i++)
        pic_blend(img, pen.x0 + i, pen.y0 + j, rgb, pen.cover[(size_t)j * (size_t)pen.w + (size_t)i] / 255.0);
    free(pen.cover);
}

/* The largest capital height, at most cap, with which the text fits the width. */
static double pic_text_fit(const char *text, double cap, double width)
{
    const double w = pic_text_width(text, cap);
    return w > width ? cap * width / w : cap;
}

/* ==== [5] scale ==== */
/* How values become positions on the colour bar, 0..1, and where ticks and isolines stand. */

enum { PIC_MAX_LEVELS = 400 };

typedef struct pic_scale {
    double lo, hi;              /* values at the ends */
    int is_log, constant;       /* constant: lo = hi, everything sits in the middle */
    int32_t labels;             /* > 0: a band for each */
    double first, step;         /* isolines at first + k step, k = 0..n_levels-1, as positions in (0,1) */
    int32_t n_levels;
} pic_scale;

/* Position of a value: may leave [0,1] on either side. Not finite stays so. */
static double pic_scale_at(const pic_scale *sc, double v)
{
    if (!pic_finite(v)) return v;
    if (sc->labels > 0) return v >= 0 && v < sc->labels && v == floor(v) ? (v + 0.5) / sc->labels : HUGE_VAL;
    if (sc->constant) return 0.5;
    if (!sc->is_log) return pic_clamp((v / 2 - sc->lo / 2) / (sc->hi / 2 - sc->lo / 2), -1e6, 1e6);
    if (v <= 0) return -0.25;
    return pic_clamp(log10(v / sc->lo) / log10(sc->hi / sc->lo), -0.25, 1.25);
}

/* The round number of the form 1, 2 or 5 times a power of ten nearest above x. */
static double pic_nice_step(double x)
{
    const double p = pow(10, floor(log10(x))), m = x / p;
    return p * (m <= 1.0001 ? 1 : m <= 2.0001 ? 2 : m <= 5.0001 ? 5 : 10);
}

static void pic_scale_levels(pic_scale *sc, int32_t wanted)
{
    double lo, range, step, first, k;
    sc->n_levels = 0;
    sc->first = sc->step = 0;
    if (wanted < 0 || sc->constant) return;
    if (wanted > 0) {
        sc->n_levels = wanted < PIC_MAX_LEVELS ? wanted : PIC_MAX_LEVELS;
        sc->first = sc->step = 1.0 / (sc->n_levels + 1);
        return;
    }
    lo = sc->is_log ? log10(sc->lo) : sc->lo;
    if (!sc->is_log && sc->hi / 2 - sc->lo / 2 > DBL_MAX / 2) return;
    range = sc->is_log ? log10(sc->hi) - lo : sc->hi - lo;
    if (!(range > 0)) return;
    step = pic_nice_step(range / 14);
    if (!(step > 0) || !pic_finite(step)) return;
    k = ceil(lo / step + 1e-6);
    first = (k * step - lo) / range;
    if (!pic_finite(first) || !(first > 0 && first < 1)) return;     /* range far below the values' last digit */
    sc->first = first;
    sc->step = step / range;
    sc->n_levels = (int32_t)ceil((1 - 1e-6 - first) / sc->step);
}

/* Range of all finite values of the panels first..last-1, by the options. */
static void pic_scale_make(pic_scale *sc, const pic_panel *panels, int32_t first, int32_t last, const pic_opts *o)
{
    double lo = HUGE_VAL, hi = -HUGE_VAL, positive = HUGE_VAL;
    int32_t p, i;
    for (p = first; p < last; p++) for (i = 0; panels[p].field && i < panels[p].n; i++) {
        const double v = panels[p].field[i];
        if (!pic_finite(v)) continue;
        lo = pic_min(lo, v);
        hi = pic_max(hi, v);
        if (v > 0) positive = pic_min(positive, v);
    }
    if (lo > hi) lo = hi = 0;
    sc->labels = o->labels;
    if (o->labels > 0) {
        sc->lo = -0.5;
        sc->hi = o->labels - 0.5;
        sc->is_log = sc->constant = 0;
        pic_scale_levels(sc, -1);
        return;
    }
    sc->is_log = o->log_decades > 0;
    if (o->lo < o->hi) { lo = o->lo; hi = o->hi; positive = lo > 0 ? lo : hi * 1e-300; }
    if (sc->is_log) {
        const double decades = pic_clamp(o->log_decades, 0.01, 300);
        if (!(hi > 0)) { hi = 1; positive = 0; }
        lo = pic_max(pic_max(hi * pow(10, -decades), positive), 1e-307);
    }
    sc->lo = lo;
    sc->hi = hi;
    /* What differs by rounding only is constant: its noise must not look like a field. */
    sc->constant = !(hi / 2 - lo / 2 > 5e-13 * pic_max(fabs(lo), fabs(hi))) || (sc->is_log && !(hi / lo > 1.0000001));
    pic_scale_levels(sc, o->isolines);
}

/* ==== [6] camera ==== */

/* One vertex as the camera sees it: pixel position, closeness d = 1/depth (linear across a flat triangle on the screen,
 * which depth itself is not), normal in the camera's axes (right, up, towards the eye), position on the colour bar. */
typedef struct pic_vertex { double x, y, d, normal[3], s; } pic_vertex;

typedef struct pic_camera {
    double right[3], up[3], eye[3];     /* unit axes; the eye looks along -eye */
    double distance;                    /* of the eye from the origin; the shape lies within 1 of it */
    double focal, cx, cy;               /* pixels */
} pic_camera;

/* A panel made ready: coordinates centred and scaled into the unit ball with the axes (side, up, front). */
typedef struct pic_scene {
    const pic_panel *panel;
    double *q;                  /* [3n] */
    double *normal;             /* [3n], unit or zero */
    double *s;                  /* [n] positions on the colour bar; not finite: grey */
    uint8_t *used;              /* [n] vertex appears in the picture */
    pic_vertex *v;              /* [n] */
    pic_camera cam;
    int labels;                 /* colours do not run into each other */
    double scale, radius;       /* unit of q per unit of xyz; radius of the discs of a point set, in q */
    int32_t n_drawn;            /* triangles or points that can be drawn */
} pic_scene;

static void pic_camera_aim(pic_camera *cam, double azimuth, double elevation)
{
    const double fov = 24;      /* angle of view, degrees */
    const double rad = 0.017453292519943295, ca = cos(azimuth * rad), sa = sin(azimuth * rad), ce = cos(elevation * rad),
                 se = sin(elevation * rad);
    cam->right[0] = ca;       cam->right[1] = 0;   cam->right[2] = -sa;
    cam->up[0] = -se * sa;    cam->up[1] = ce;     cam->up[2] = -se * ca;
    cam->eye[0] = ce * sa;    cam->eye[1] = se;    cam->eye[2] = ce * ca;
    cam->distance = 1 / sin(0.5 * rad * fov);           /* far outside the shape */
    cam->focal = 1;
    cam->cx = cam->cy = 0;
}

static void pic_project(const pic_camera *cam, const double q[3], double out[3])
{
    out[2] = 1 / (cam->distance - pic_dot(q, cam->eye));
    out[0] = cam->cx + cam->focal * pic_dot(q, cam->right) * out[2];
    out[1] = cam->cy - cam->focal * pic_dot(q, cam->up) * out[2];
}

/* The triangle's three indices, or 0 when it cannot be drawn. */
static int pic_triangle(const pic_panel *p, int32_t t, int32_t id[3])
{
    int k, c;
    for (k = 0; k < 3; k++) {
        id[k] = p->tri[3 * (size_t)t + (size_t)k];
        if (id[k] < 0 || id[k] >= p->n) return 0;
        for (c = 0; c < 3; c++) if (!pic_finite(p->xyz[3 * (size_t)id[k] + (size_t)c])) return 0;
    }
    return id[0] != id[1] && id[1] != id[2] && id[2] != id[0];
}

static void pic_scene_mark_used(pic_scene *sc)
{
    const pic_panel *p = sc->panel;
    int32_t i, id[3];
    int c;
    sc->n_drawn = 0;
    for (i = 0; i < p->n_tri; i++) {
        if (!pic_triangle(p, i, id)) continue;
        sc->used[id[0]] = sc->used[id[1]] = sc->used[id[2]] = 1;
        sc->n_drawn++;
    }
    for (i = 0; p->n_tri <= 0 && i < p->n; i++) {
        sc->used[i] = 1;
        for (c = 0; c < 3; c++) if (!pic_finite(p->xyz[3 * (size_t)i + (size_t)c])) sc->used[i] = 0;
        sc->n_drawn += sc->used[i];
    }
}

/* Fills q, with axis up of PIC_UP_... second. Halves before subtracting, so that even the largest doubles do not overflow. */
static void pic_scene_normalise(pic_scene *sc, int32_t up)
{
    static const int axis[3][3] = {{0, 1, 2}, {1, 0, 2}, {0, 2, 1}}, sign[3][3] = {{1, 1, 1}, {-1, 1, 1}, {1, 1, -1}};
    const int turn = up == PIC_UP_X || up == PIC_UP_Z ? up : PIC_UP_Y;
    const pic_panel *p = sc->panel;
    double lo[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, mid[3], ext = 0, len = 0;
    int32_t i;
    int c;
    for (i = 0; i < p->n; i++) for (c = 0; sc->used[i] && c < 3; c++) {
        lo[c] = pic_min(lo[c], p->xyz[3 * (size_t)i + (size_t)c] / 2);
        hi[c] = pic_max(hi[c], p->xyz[3 * (size_t)i + (size_t)c] / 2);
    }
    for (c = 0; c < 3; c++) {
        mid[c] = lo[c] <= hi[c] ? lo[c] / 2 + hi[c] / 2 : 0;
        ext = pic_max(ext, lo[c] <= hi[c] ? hi[c] - lo[c] : 0);
    }
    if (!(ext > 0)) ext = 1;
    for (c = 0; c < 3; c++) len += lo[c] <= hi[c] ? pow((hi[c] - lo[c]) / ext, 2) : 0;
    len = len > 0 ? sqrt(len) : 1;
    sc->scale = 1 / ext / len;
    for (i = 0; i < p->n; i++) {
        double *q = sc->q + 3 * (size_t)i;
        for (c = 0; c < 3; c++) {
            const int from = axis[turn][c];
            q[c] = sc->used[i] ? sign[turn][c] * ((p->xyz[3 * (size_t)i + (size_t)from] / 2 - mid[from]) / ext * 2 / len) : 0;
        }
    }
}

/* Cross product of two edges of a triangle of q, unit; returns twice its area. */
static double pic_face_normal(const double *q, const int32_t id[3], double n[3])
{
    const double *a = q + 3 * (size_t)id[0], *b = q + 3 * (size_t)id[1], *c = q + 3 * (size_t)id[2];
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
    return pic_unit(n);
}

/* The angle at corner a of a triangle, in a cheap monotone stand-in (1 - cosine) that is quite enough as a weight. */
static double pic_corner_weight(const double *a, const double *b, const double *c)
{
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    if (pic_unit(u) <= 0 || pic_unit(v) <= 0) return 0;
    return 1 - pic_dot(u, v);
}

/* Vertex normals, weighted by angle. A face that runs against what is gathered so far is turned round first: meshes whose
 * faces are oriented at random then still look smooth. */
static void pic_scene_normals(pic_scene *sc)
{
    const pic_panel *p = sc->panel;
    int32_t t, id[3];
    int k, c;
    for (t = 0; t < p->n_tri; t++) {
        double n[3];
        if (!pic_triangle(p, t, id) || pic_face_normal(sc->q, id, n) <= 0) continue;
        for (k = 0; k < 3; k++) {
            double *m = sc->normal + 3 * (size_t)id[k];
            double w = pic_corner_weight(sc->q + 3 * (size_t)id[k], sc->q + 3 * (size_t)id[(k + 1) % 3],
                                         sc->q + 3 * (size_t)id[(k + 2) % 3]);
            if (pic_dot(m, n) < 0) w = -w;
            for (c = 0; c < 3; c++) m[c] += w * n[c];
        }
    }
    for (t = 0; t < p->n; t++) pic_unit(sc->normal + 3 * (size_t)t);
}

static int pic_compare_double(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Radius of the discs of a point set: from the distance to the fourth neighbour, looked up for some points; such
 * that where points are sparse (nine of ten have nearer neighbours) the discs still touch. */
static double pic_point_spacing(const pic_scene *sc)
{
    enum { SAMPLES = 128 };
    double dist[SAMPLES];
    const int32_t n = sc->panel->n, stride = n / SAMPLES + 1;
    int m = 0, k;
    int32_t i, j;
    for (i = 0; i < n && m < SAMPLES; i += stride) {
        double near4[4] = {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL};
        const double *a = sc->q + 3 * (size_t)i;
        if (!sc->used[i]) continue;
        for (j = 0; j < n; j++) {
            const double *b = sc->q + 3 * (size_t)j, x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
            double d = x * x + y * y + z * z;
            if (!(d < near4[3]) || d <= 0 || !sc->used[j]) continue;
            for (k = 0; k < 4; k++) if (d < near4[k]) { const double swap = near4[k]; near4[k] = d; d = swap; }
        }
        if (near4[3] < HUGE_VAL) dist[m++] = sqrt(near4[3]);
    }
    if (m == 0) return 0.03;
    qsort(dist, (size_t)m, sizeof dist[0], pic_compare_double);
    return pic_clamp(0.70 * dist[m * 9 / 10], 0.001, 0.1);
}

static void pic_scene_free(pic_scene *sc)
{
    free(sc->q); free(sc->normal); free(sc->s); free(sc->used); free(sc->v);
    memset(sc, 0, sizeof *sc);
}

static int pic_scene_make(pic_scene *sc, const pic_panel *p, const pic_scale *scale, const pic_opts *o)
{
    const size_t n = p->n > 0 ? (size_t)p->n : 0;
    size_t i;
    memset(sc, 0, sizeof *sc);
    sc->panel = p;
    sc->labels = scale->labels > 0;
    sc->q = (double *)pic_zalloc(n, 3 * sizeof(double));
    sc->normal = (double *)pic_zalloc(n, 3 * sizeof(double));
    sc->s = (double *)pic_zalloc(n, sizeof(double));
    sc->used = (uint8_t *)pic_zalloc(n, 1);
    sc->v = (pic_vertex *)pic_zalloc(n, sizeof(pic_vertex));
    if (!sc->q || !sc->normal || !sc->s || !sc->used || !sc->v) { pic_scene_free(sc); return PIC_ERR_MEMORY; }
    pic_scene_mark_used(sc);
    pic_scene_normalise(sc, o->up);
    pic_scene_normals(sc);
    for (i = 0; i < n; i++) sc->s[i] = p->field ? pic_scale_at(scale, p->field[i]) : 0.5;
    if (p->n_tri <= 0) sc->radius = o->point_radius > 0 ? pic_min(o->point_radius * sc->scale, 1) : pic_point_spacing(sc);
    return PIC_OK;
}

/* Choosing a view: candidates are drawn into a tiny z-buffer and scored by how much is seen, and how warm it is. */
enum { PIC_THUMB = 64 };

typedef struct pic_thumb { double depth[PIC_THUMB][PIC_THUMB], value[PIC_THUMB][PIC_THUMB]; } pic_thumb;

static void pic_thumb_put(pic_thumb *th, int x, int y, double depth, double value)
{
    if (x < 0 || y < 0 || x >= PIC_THUMB || y >= PIC_THUMB || depth <= th->depth[y][x]) return;
    th->depth[y][x] = depth;
    th->value[y][x] = value;
}

/* One triangle, orthographic, with one value. Its middle is always put, so that tiny ones count too. */
static void pic_thumb_triangle(pic_thumb *th, double (*a)[3], double value)
{
    const double x0 = pic_min(a[0][0], pic_min(a[1][0], a[2][0])), x1 = pic_max(a[0][0], pic_max(a[1][0], a[2][0]));
    const double y0 = pic_min(a[0][1], pic_min(a[1][1], a[2][1])), y1 = pic_max(a[0][1], pic_max(a[1][1], a[2][1]));
    const double det = (a[1][0] - a[0][0]) * (a[2][1] - a[0][1]) - (a[2][0] - a[0][0]) * (a[1][1] - a[0][1]);
    int x, y;
    pic_thumb_put(th, (int)((a[0][0] + a[1][0] + a[2][0]) / 3), (int)((a[0][1] + a[1][1] + a[2][1]) / 3),
                  (a[0][2] + a[1][2] + a[2][2]) / 3, value);
    if (fabs(det) < 1e-9) return;
    for (y = (int)y0; y <= y1; y++) for (x = (int)x0; x <= x1; x++) {
        const double px = x + 0.5 - a[0][0], py = y + 0.5 - a[0][1];
        const double u = (px * (a[2][1] - a[0][1]) - py * (a[2][0] - a[0][0])) / det;
        const double v = (py * (a[1][0] - a[0][0]) - px * (a[1][1] - a[0][1])) / det;
        if (u < 0 || v < 0 || u + v > 1) continue;
        pic_thumb_put(th, x, y, a[0][2] + u * (a[1][2] - a[0][2]) + v * (a[2][2] - a[0][2]), value);
    }
}

static void pic_thumb_project(const pic_camera *cam, const double *q, double out[3])
{
    out[0] = PIC_THUMB * (0.5 + 0.48 * pic_dot(q, cam->right));
    out[1] = PIC_THUMB * (0.5 - 0.48 * pic_dot(q, cam->up));
    out[2] = pic_dot(q, cam->eye);
}

/* What a value adds to a pixel: seeing the shape counts, seeing it warm counts more. */
static double pic_interest(double s) { return pic_finite(s) ? 0.5 + 0.9 * pic_clamp(s, 0, 1) : 0.5; }

static void pic_thumb_draw(pic_thumb *th, const pic_scene *sc)
{
    const pic_panel *p = sc->panel;
    const int32_t count = p->n_tri > 0 ? p->n_tri : p->n, stride = count / 20000 + 1;
    int32_t i, id[3];
    int x, y, k;
    for (y = 0; y < PIC_THUMB; y++) for (x = 0; x < PIC_THUMB; x++) th->depth[y][x] = -HUGE_VAL;
    for (i = 0; i < count; i += stride) {
        double a[3][3];
        if (p->n_tri > 0) {
            if (!pic_triangle(p, i, id)) continue;
            for (k = 0; k < 3; k++) pic_thumb_project(&sc->cam, sc->q + 3 * (size_t)id[k], a[k]);
            pic_thumb_triangle(th, a, pic_interest((sc->s[id[0]] + sc->s[id[1]] + sc->s[id[2]]) / 3));
        } else if (sc->used[i]) {
            pic_thumb_project(&sc->cam, sc->q + 3 * (size_t)i, a[0]);
            pic_thumb_put(th, (int)a[0][0], (int)a[0][1], a[0][2], pic_interest(sc->s[i]));
        }
    }
}

/* How well vertex i is seen: 0 hidden, else how squarely it faces the eye. */
static double pic_thumb_sees(const pic_thumb *th, const pic_scene *sc, int32_t i)
{
    double a[3], facing;
    int x, y;
    if (i < 0 || i >= sc->panel->n || !sc->used[i]) return 0;
    pic_thumb_project(&sc->cam, sc->q + 3 * (size_t)i, a);
    x = (int)pic_clamp(a[0], 0, PIC_THUMB - 1);
    y = (int)pic_clamp(a[1], 0, PIC_THUMB - 1);
    facing = sc->panel->n_tri > 0 ? pic_dot(sc->normal + 3 * (size_t)i, sc->cam.eye) : 0.7;
    return a[2] < th->depth[y][x] - 0.08 ? 0 : 0.3 + 0.7 * pic_clamp(fabs(facing) * 1.3, 0, 1);
}

static double pic_thumb_score(const pic_thumb *th, const pic_scene *sc, int32_t warmest)
{
    const pic_panel *p = sc->panel;
    double seen = 0, marks = 0;
    int32_t i;
    int x, y;
    for (y = 0; y < PIC_THUMB; y++) for (x = 0; x < PIC_THUMB; x++) if (th->depth[y][x] > -HUGE_VAL) seen += th->value[y][x];
    for (i = 0; p->markers && i < p->n_markers; i++) marks += pic_thumb_sees(th, sc, p->markers[i]) / p->n_markers;
    if (!p->markers || p->n_markers <= 0) marks = pic_thumb_sees(th, sc, warmest);
    return sqrt(seen) * (1 + 0.8 * marks);
}

/* A planar shape across one of the axes is looked at straight. */
static int pic_view_planar(const pic_scene *sc, double *azimuth, double *elevation)
{
    double ext[3] = {0, 0, 0};
    int32_t i;
    int c;
    for (i = 0; i < sc->panel->n; i++) for (c = 0; c < 3; c++) ext[c] = pic_max(ext[c], fabs(sc->q[3 * (size_t)i + (size_t)c]));
    if (pic_max(ext[0], pic_max(ext[1], ext[2])) < 1e-6) return 0;
    for (c = 0; c < 3 && !(ext[c] < 1e-6); c++) { }
    *azimuth = c == 0 ? 90 : 0;
    *elevation = c == 1 ? 90 : 0;
    return c < 3;
}

/* Returns 0 without memory. */
static int pic_view_choose(pic_scene *sc, double *azimuth, double *elevation)
{
    static const double rise[4] = {12, 22, 35, 52}, prior[4] = {0.96, 1.0, 0.97, 0.88};
    pic_thumb *th = (pic_thumb *)pic_alloc(1, sizeof *th);
    double best = -1;
    int32_t i, warmest = -1;
    int a, e;
    if (!th || pic_view_planar(sc, azimuth, elevation)) { free(th); return th != NULL; }
    for (i = 0; i < sc->panel->n; i++)
        if (sc->used[i] && pic_finite(sc->s[i]) && (warmest < 0 || sc->s[i] > sc->s[warmest])) warmest = i;
    for (e = 0; e < 4; e++) for (a = 0; a < 20; a++) {
        const double az = 33 + 18.0 * a, front = 1 + 0.02 * cos((az - 33) * 0.0174532925);   /* ties: from the front */
        double score;
        pic_camera_aim(&sc->cam, az, rise[e]);
        pic_thumb_draw(th, sc);
        score = pic_thumb_score(th, sc, warmest) * prior[e] * front;
        if (score <= best) continue;
        best = score;
        *azimuth = az;
        *elevation = rise[e];
    }
    free(th);
    return 1;
}

/* Zoom and centre so that the shape fits the middle of w x h pixels, then project all vertices. */
static void pic_scene_fit(pic_scene *sc, double w, double h)
{
    pic_camera *cam = &sc->cam;
    const double grow = sc->radius;
    double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL}, out[3];
    int32_t i;
    int c;
    for (i = 0; i < sc->panel->n; i++) {
        if (!sc->used[i]) continue;
        pic_project(cam, sc->q + 3 * (size_t)i, out);
        for (c = 0; c < 2; c++) {
            lo[c] = pic_min(lo[c], out[c] - grow * out[2]);
            hi[c] = pic_max(hi[c], out[c] + grow * out[2]);
        }
    }
    for (c = 0; c < 2; c++) if (lo[c] > hi[c]) lo[c] = hi[c] = 0;
    cam->focal = pic_min(0.90 * w / pic_max(hi[0] - lo[0], 0.02), 0.86 * h / pic_max(hi[1] - lo[1], 0.02));
    cam->cx = w / 2 - cam->focal * (lo[0] + hi[0]) / 2;
    cam->cy = h / 2 - cam->focal * (lo[1] + hi[1]) / 2 - 0.01 * h;
    for (i = 0; i < sc->panel->n; i++) {
        const double *nq = sc->normal + 3 * (size_t)i;
        pic_vertex *v = sc->v + i;
        pic_project(cam, sc->q + 3 * (size_t)i, out);
        v->x = out[0]; v->y = out[1]; v->d = out[2];
        v->normal[0] = pic_dot(nq, cam->right);
        v->normal[1] = pic_dot(nq, cam->up);
        v->normal[2] = pic_dot(nq, cam->eye);
        v->s = sc->s[i];
    }
}

/* ==== [7] visibility ==== */
/* A visibility buffer: per sample only which triangle (or point) is nearest, and how near. Everything else is worked out
 * afterwards, once per sample that is really seen. */

typedef struct pic_buffer {
    int32_t w, h;               /* samples */
    float *d;                   /* [w*h] closeness, 0: background */
    int32_t *id;                /* [w*h] */
    uint8_t *line;              /* [w*h] darkness of isolines */
} pic_buffer;

static void pic_buffer_free(pic_buffer *b)
{
    free(b->d); free(b->id); free(b->line);
    memset(b, 0, sizeof *b);
}

static int pic_buffer_make(pic_buffer *b, int32_t w, int32_t h)
{
    const size_t n = (size_t)w * (size_t)h;
    memset(b, 0, sizeof *b);
    b->w = w;
    b->h = h;
    b->d = (float *)pic_zalloc(n, sizeof(float));
    b->id = (int32_t *)pic_alloc(n, sizeof(int32_t));
    b->line = (uint8_t *)pic_zalloc(n, 1);
    if (b->d && b->id && b->line) return PIC_OK;
    pic_buffer_free(b);
    return PIC_ERR_MEMORY;
}

static void pic_raster_triangle(pic_buffer *b, const pic_vertex *p0, const pic_vertex *p1, const pic_vertex *p2, int32_t id)
{
    const double det = (p1->x - p0->x) * (p2->y - p0->y) - (p2->x - p0->x) * (p1->y - p0->y);
    const double xa = pic_min(p0->x, pic_min(p1->x, p2->x)), xb = pic_max(p0->x, pic_max(p1->x, p2->x));
    const double ya = pic_min(p0->y, pic_min(p1->y, p2->y)), yb = pic_max(p0->y, pic_max(p1->y, p2->y));
    const int32_t x0 = (int32_t)pic_clamp(ceil(xa - 0.5), 0, b->w), x1 = (int32_t)pic_clamp(floor(xb - 0.5) + 1, 0, b->w);
    const int32_t y0 = (int32_t)pic_clamp(ceil(ya - 0.5), 0, b->h), y1 = (int32_t)pic_clamp(floor(yb - 0.5) + 1, 0, b->h);
    double ux, uy, vx, vy;
    int32_t x, y;
    if (x0 >= x1 || y0 >= y1 || !(fabs(det) > 1e-12)) return;
    ux = (p2->y - p0->y) / det; uy = -(p2->x - p0->x) / det;    /* gradients of the two barycentric coordinates */
    vx = -(p1->y - p0->y) / det; vy = (p1->x - p0->x) / det;
    for (y = y0; y < y1; y++) {
        const double dy = y + 0.5 - p0->y, ru = dy * uy, rv = dy * vy;
        float *d = b->d + (size_t)y * (size_t)b->w;
        int32_t *ids = b->id + (size_t)y * (size_t)b->w;
        for (x = x0; x < x1; x++) {
            const double dx = x + 0.5 - p0->x, u = ru + dx * ux, v = rv + dx * vx;
            float close;
            if (u < -1e-9 || v < -1e-9 || u + v > 1 + 1e-9) continue;   /* shared edges belong to both: no pinholes */
            close = (float)(p0->d + u * (p1->d - p0->d) + v * (p2->d - p0->d));
            if (close <= d[x]) continue;
            d[x] = close;
            ids[x] = id;
        }
    }
}

/* A point as a ball that faces the eye. */
static void pic_raster_point(pic_buffer *b, const pic_scene *sc, const pic_vertex *p, int32_t id)
{
    const double r = pic_max(sc->radius * sc->cam.focal * p->d, 0.6);
    const int32_t x0 = (int32_t)pic_clamp(p->x - r, 0, b->w), x1 = (int32_t)pic_clamp(p->x + r + 1, 0, b->w);
    const int32_t y0 = (int32_t)pic_clamp(p->y - r, 0, b->h), y1 = (int32_t)pic_clamp(p->y + r + 1, 0, b->h);
    int32_t x, y;
    for (y = y0; y < y1; y++) for (x = x0; x < x1; x++) {
        const double dx = (x + 0.5 - p->x) / r, dy = (y + 0.5 - p->y) / r, rr = dx * dx + dy * dy;
        const size_t k = (size_t)y * (size_t)b->w + (size_t)x;
        float close;
        if (rr > 1) continue;
        close = (float)(1 / (1 / p->d - sc->radius * 0.5 * sqrt(1 - rr)));
        if (close <= b->d[k]) continue;
        b->d[k] = close;
        b->id[k] = id;
    }
}

static void pic_raster_scene(pic_buffer *b, const pic_scene *sc)
{
    const pic_panel *p = sc->panel;
    int32_t i, id[3];
    for (i = 0; i < p->n_tri; i++)
        if (pic_triangle(p, i, id)) pic_raster_triangle(b, sc->v + id[0], sc->v + id[1], sc->v + id[2], i);
    for (i = 0; p->n_tri <= 0 && i < p->n; i++) if (sc->used[i]) pic_raster_point(b, sc, sc->v + i, i);
}

/* What is seen at a sample. */
typedef struct pic_hit {
    double normal[3];           /* unit, turned towards the eye */
    double toward[3];           /* unit, from the surface to the eye */
    double s;                   /* position on the colour bar; not finite: grey */
} pic_hit;

/* The normal at one corner: the vertex normal turned to the face's side, or the face's own where they are 40 degrees
 * apart or more: that is a crease meant to be seen. */
static void pic_corner_normal(const pic_vertex *v, const double face[3], double out[3])
{
    const double along = pic_dot(v->normal, face), turn = along < 0 ? -1 : 1;
    int c;
    for (c = 0; c < 3; c++) out[c] = fabs(along) < 0.766 ? face[c] : turn * v->normal[c];
}

static void pic_hit_triangle(const pic_scene *sc, int32_t t, double x, double y, pic_hit *hit)
{
    const int32_t *id = sc->panel->tri + 3 * (size_t)t;
    const pic_vertex *v[3] = {sc->v + id[0], sc->v + id[1], sc->v + id[2]};
    const double det = (v[1]->x - v[0]->x) * (v[2]->y - v[0]->y) - (v[2]->x - v[0]->x) * (v[1]->y - v[0]->y);
    double face[3], corner[3], world[3], w[3], sum = 0;
    int k, c;
    w[1] = ((x - v[0]->x) * (v[2]->y - v[0]->y) - (y - v[0]->y) * (v[2]->x - v[0]->x)) / det;
    w[2] = ((y - v[0]->y) * (v[1]->x - v[0]->x) - (x - v[0]->x) * (v[1]->y - v[0]->y)) / det;
    w[0] = 1 - w[1] - w[2];
    for (k = 0; k < 3; k++) sum += w[k] = pic_clamp(w[k], 0, 1) * v[k]->d;      /* perspective */
    pic_face_normal(sc->q, id, world);
    face[0] = pic_dot(world, sc->cam.right);
    face[1] = pic_dot(world, sc->cam.up);
    face[2] = pic_dot(world, sc->cam.eye);
    if (pic_dot(face, hit->toward) < 0) for (c = 0; c < 3; c++) face[c] = -face[c];
    hit->s = 0;
    hit->normal[0] = hit->normal[1] = hit->normal[2] = 0;
    if (sc->labels) hit->s = v[w[0] >= w[1] && w[0] >= w[2] ? 0 : w[1] >= w[2] ? 1 : 2]->s;      /* of the nearest corner */
    for (k = 0; k < 3; k++) {
        pic_corner_normal(v[k], face, corner);
        if (!sc->labels) hit->s += w[k] / sum * v[k]->s;
        for (c = 0; c < 3; c++) hit->normal[c] += w[k] * corner[c];
    }
}

static void pic_hit_at(const pic_scene *sc, int32_t id, double x, double y, pic_hit *hit)
{
    const pic_camera *cam = &sc->cam;
    double facing;
    int c;
    hit->toward[0] = -(x - cam->cx) / cam->focal;
    hit->toward[1] = (y - cam->cy) / cam->focal;
    hit->toward[2] = 1;
    pic_unit(hit->toward);
    if (sc->panel->n_tri > 0) pic_hit_triangle(sc, id, x, y, hit);
    else {
        const pic_vertex *v = sc->v + id;
        const double r = pic_max(sc->radius * cam->focal * v->d, 0.6);
        hit->normal[0] = 0.8 * (x - v->x) / r;
        hit->normal[1] = -0.8 * (y - v->y) / r;
        hit->normal[2] = sqrt(pic_max(0.1, 1 - hit->normal[0] * hit->normal[0] - hit->normal[1] * hit->normal[1]));
        hit->s = v->s;
    }
    if (pic_unit(hit->normal) <= 0) hit->normal[2] = 1;
    facing = pic_dot(hit->normal, hit->toward);
    if (facing < 0) {       /* a smooth normal may lean away just inside the outline: bend it back to edge-on */
        for (c = 0; c < 3; c++) hit->normal[c] -= facing * hit->toward[c];
        if (pic_unit(hit->normal) <= 0) hit->normal[2] = 1;
    }
}

/* ==== [8] isolines ==== */
/* Within a triangle the field is linear and its isolines are straight: they are drawn as segments with round ends, of
 * constant width on the screen, wherever the surface seen there is as near as the line. */

static void pic_line_segment(pic_buffer *b, const double a[3], const double c[3], double half, double strength,
                             const pic_camera *cam)
{
    const int32_t x0 = (int32_t)pic_clamp(pic_min(a[0], c[0]) - half - 1, 0, b->w);
    const int32_t x1 = (int32_t)pic_clamp(pic_max(a[0], c[0]) + half + 2, 0, b->w);
    const int32_t y0 = (int32_t)pic_clamp(pic_min(a[1], c[1]) - half - 1, 0, b->h);
    const int32_t y1 = (int32_t)pic_clamp(pic_max(a[1], c[1]) + half + 2, 0, b->h);
    int32_t x, y;
    for (y = y0; y < y1; y++) for (x = x0; x < x1; x++) {
        const double p[2] = {x + 0.5, y + 0.5};
        const size_t k = (size_t)y * (size_t)b->w + (size_t)x;
        double t, dist, depth, allow;
        uint8_t v;
        if (!(b->d[k] > 0)) continue;
        dist = pic_segment_distance(p, a, c, &t);
        if (dist > half + 0.5) continue;
        depth = 1 / (a[2] + t * (c[2] - a[2]));
        allow = 10 * half * depth / cam->focal;     /* off the line's middle the surface may be this much nearer */
        if (1 / (double)b->d[k] < depth - allow) continue;
        v = pic_byte(strength * pic_clamp(half + 0.5 - dist, 0, 1));
        if (v > b->line[k]) b->line[k] = v;
    }
}

/* Where level crosses the edge from p to q of a triangle. Halfway in space is not halfway on the screen: depths weigh. */
static void pic_line_cross(const pic_vertex *p, const pic_vertex *q, double level, double out[3])
{
    const double t = pic_clamp((level - p->s) / (q->s - p->s), 0, 1), a = (1 - t) / p->d, b = t / q->d, u = b / (a + b);
    out[0] = p->x + u * (q->x - p->x);
    out[1] = p->y + u * (q->y - p->y);
    out[2] = p->d + u * (q->d - p->d);
}

/* Strength of the lines in a triangle: full, and fainter where they would crowd into one dark patch. */
static double pic_line_strength(const pic_vertex *const v[3], double step, double half)
{
    const double det = (v[1]->x - v[0]->x) * (v[2]->y - v[0]->y) - (v[2]->x - v[0]->x) * (v[1]->y - v[0]->y);
    const double s1 = v[1]->s - v[0]->s, s2 = v[2]->s - v[0]->s;
    const double gx = s1 * (v[2]->y - v[0]->y) - s2 * (v[1]->y - v[0]->y);
    const double gy = s2 * (v[1]->x - v[0]->x) - s1 * (v[2]->x - v[0]->x);
    const double spacing = step * fabs(det) / pic_max(sqrt(gx * gx + gy * gy), 1e-300);     /* in samples */
    return 0.12 + 0.88 * pic_smooth((spacing / (2 * half) - 1) / 3);
}

static void pic_line_triangle(pic_buffer *b, const pic_vertex *const v[3], const pic_scale *sc, double half,
                              const pic_camera *cam)
{
    const double lo = pic_min(v[0]->s, pic_min(v[1]->s, v[2]->s)), hi = pic_max(v[0]->s, pic_max(v[1]->s, v[2]->s));
    double from = ceil((lo - sc->first) / sc->step), to = floor((hi - sc->first) / sc->step), strength;
    int32_t k;
    int e;
    from = pic_max(from, 0);
    to = pic_min(to, sc->n_levels - 1);
    if (!(from <= to)) return;
    strength = pic_line_strength(v, sc->step, half);
    for (k = (int32_t)from; k <= (int32_t)to; k++) {
        const double level = sc->first + k * sc->step;
        double end[3][3];
        int m = 0;
        for (e = 0; e < 3; e++) {
            const pic_vertex *p = v[e], *q = v[(e + 1) % 3];
            if ((p->s < level) != (q->s < level)) pic_line_cross(p, q, level, end[m++]);
        }
        if (m == 2) pic_line_segment(b, end[0], end[1], half, strength, cam);
    }
}

static void pic_line_scene(pic_buffer *b, const pic_scene *sc, const pic_scale *scale, double half)
{
    const pic_panel *p = sc->panel;
    int32_t t, id[3];
    if (!p->field || scale->n_levels <= 0 || !(scale->step > 0)) return;
    for (t = 0; t < p->n_tri; t++) {
        const pic_vertex *v[3];
        if (!pic_triangle(p, t, id)) continue;
        v[0] = sc->v + id[0]; v[1] = sc->v + id[1]; v[2] = sc->v + id[2];
        if (pic_finite(v[0]->s + v[1]->s + v[2]->s)) pic_line_triangle(b, v, scale, half, &sc->cam);
    }
}

/* ==== [9] light ==== */

/* Position in the camera's axes of what sample (x, y) shows at closeness d. */
static void pic_view_position(const pic_camera *cam, double x, double y, double d, double out[3])
{
    out[0] = (x - cam->cx) / (cam->focal * d);
    out[1] = -(y - cam->cy) / (cam->focal * d);
    out[2] = -1 / d;
}

/* How open a place is to the sky, 0..1: looks at 16 samples around it on the screen and counts those that rise above its
 * tangent plane, near ones more (after McGuire, Osman, Bukowski, Hennessy: The alchemy screen-space ambient obscurance
 * algorithm, 2011). */
enum { PIC_LOOKS = 16 };

static double pic_openness(const pic_buffer *b, const pic_scene *sc, int32_t x, int32_t y, double (*look)[2])
{
    const double reach = 0.11;
    const size_t here = (size_t)y * (size_t)b->w + (size_t)x;
    double p[3], blocked = 0, pixels;
    pic_hit hit;
    int i, c;
    pic_hit_at(sc, b->id[here], x + 0.5, y + 0.5, &hit);
    if (sc->panel->n_tri <= 0) memcpy(hit.normal, hit.toward, sizeof hit.normal);      /* a ball's slope says little */
    pic_view_position(&sc->cam, x + 0.5, y + 0.5, (double)b->d[here], p);
    pixels = reach * sc->cam.focal * (double)b->d[here];
    for (i = 0; i < PIC_LOOKS; i++) {
        const int32_t sx = x + (int32_t)(pixels * look[i][0]), sy = y + (int32_t)(pixels * look[i][1]);
        const size_t k = (size_t)sy * (size_t)b->w + (size_t)sx;
        double v[3], vv, up;
        if (sx < 0 || sy < 0 || sx >= b->w || sy >= b->h || !(b->d[k] > 0)) continue;
        pic_view_position(&sc->cam, sx + 0.5, sy + 0.5, (double)b->d[k], v);
        for (c = 0; c < 3; c++) v[c] -= p[c];
        vv = pic_dot(v, v);
        up = pic_dot(v, hit.normal) - 0.004;
        if (up > 0 && vv < 4 * reach * reach) blocked += up * reach / (vv + 1e-4) * (1 - vv / (4 * reach * reach));
    }
    return pic_clamp(1 - 1.15 * blocked / PIC_LOOKS, 0.25, 1);
}

/* Openness for every pixel (ss x ss samples), then averaged over 5 x 5 pixels of about the same depth, which hides the
 * pattern of the looks. open and scratch: [w*h] pixels. */
static void pic_openness_all(const pic_buffer *b, const pic_scene *sc, int32_t ss, float *open, float *scratch)
{
    const int32_t w = b->w / ss, h = b->h / ss;
    double look[16][PIC_LOOKS][2];      /* a spiral, turned differently in each pixel of a 4 x 4 tile */
    int32_t x, y, i, j;
    for (j = 0; j < 16; j++) for (i = 0; i < PIC_LOOKS; i++) {
        const double r = (i + 0.5) / PIC_LOOKS, angle = 2.399963229728653 * i + j * 0.39269908169872414;
        look[j][i][0] = r * cos(angle);
        look[j][i][1] = r * sin(angle);
    }
    for (y = 0; y < h; y++) for (x = 0; x < w; x++) {
        const int32_t sx = x * ss + ss / 2, sy = y * ss + ss / 2;
        const int seen = b->d[(size_t)sy * (size_t)b->w + (size_t)sx] > 0;
        scratch[(size_t)y * (size_t)w + (size_t)x] =
            seen ? (float)pic_openness(b, sc, sx, sy, look[((x & 3) * 4 + (y & 3)) * 5 % 16]) : 1.0f;
    }
    for (y = 0; y < h; y++) for (x = 0; x < w; x++) {
        const double d = (double)b->d[(size_t)(y * ss + ss / 2) * (size_t)b->w + (size_t)(x * ss + ss / 2)];
        double sum = 0, count = 0;
        for (j = y - 2; j <= y + 2; j++) for (i = x - 2; i <= x + 2; i++) {
            double e;
            if (i < 0 || j < 0 || i >= w || j >= h) continue;
            e = (double)b->d[(size_t)(j * ss + ss / 2) * (size_t)b->w + (size_t)(i * ss + ss / 2)];
            if (!(e > 0) || fabs(e - d) > 0.01 * d) continue;
            sum += (double)scratch[(size_t)j * (size_t)w + (size_t)i];
            count++;
        }
        open[(size_t)y * (size_t)w + (size_t)x] = (float)(count > 0 ? sum / count : 1);
    }
}

/* Light that a surface of this colour sends to the eye: a sky above, a key light from the upper left, a weak one from the
 * right, a soft highlight, a darker rim against the bright paper, and a streak of light from behind on top. */
static void pic_shade(const double base[3], const pic_hit *hit, double open, double out[3])
{
    static const double key[3] = {-0.4264, 0.6396, 0.6396}, fill[3] = {0.8575, 0.0857, 0.5073},
                        back[3] = {0.2169, 0.5965, -0.7727};
    const double *n = hit->normal, *v = hit->toward;
    const double facing = pic_clamp(pic_dot(n, v), 0, 1), rim = 1 - facing;
    const double sky = 0.5 + 0.5 * n[1], main_light = pic_max(0, (pic_dot(n, key) + 0.25) / 1.25);
    const double light = open * (0.30 + 0.24 * sky + 0.15 * pic_max(0, pic_dot(n, fill)))
                       + (0.35 + 0.65 * open) * 0.62 * main_light;
    double half[3] = {key[0] + v[0], key[1] + v[1], key[2] + v[2]}, shine, streak;
    int c;
    pic_unit(half);
    shine = pic_max(0, pic_dot(n, half));
    for (c = 0; c < 5; c++) shine *= shine;     /* to the 32nd power */
    shine *= 0.07 * open;
    streak = 0.30 * open * rim * rim * pic_max(0, pic_dot(n, back) + 0.25);
    for (c = 0; c < 3; c++) out[c] = base[c] * (light * (1 - 0.30 * rim * rim * rim) + streak) + shine;
}

/* A soft shadow on the ground, gathered from above: how much of the shape stands over each place, low parts more. */
enum { PIC_GROUND = 160 };

typedef struct pic_ground {
    double height, half;                    /* of the plane; the map covers [-half, half]^2 in (side, front) */
    double dark[PIC_GROUND][PIC_GROUND], other[PIC_GROUND][PIC_GROUND];
} pic_ground;

static void pic_ground_drop(pic_ground *g, double x, double y, double z)
{
    const int i = (int)((x / g->half * 0.5 + 0.5) * PIC_GROUND), j = (int)((z / g->half * 0.5 + 0.5) * PIC_GROUND);
    const double v = exp(-2.6 * (y - g->height));
    if (i >= 0 && j >= 0 && i < PIC_GROUND && j < PIC_GROUND && v > g->dark[j][i]) g->dark[j][i] = v;
}

static void pic_ground_triangle(pic_ground *g, const double *a, const double *b, const double *c)
{
    const double cell = 2 * g->half / PIC_GROUND;
    double size = 0, w[3];
    int n, i, j, k;
    for (k = 0; k < 3; k++) size = pic_max(size, pic_max(fabs(a[k] - b[k]), pic_max(fabs(b[k] - c[k]), fabs(c[k] - a[k]))));
    n = 1 + (int)(size / cell);
    for (i = 0; i <= n; i++) for (j = 0; j <= n - i; j++) {
        w[0] = i / (double)n; w[1] = j / (double)n; w[2] = 1 - w[0] - w[1];
        pic_ground_drop(g, w[0] * a[0] + w[1] * b[0] + w[2] * c[0], w[0] * a[1] + w[1] * b[1] + w[2] * c[1],
                        w[0] * a[2] + w[1] * b[2] + w[2] * c[2]);
    }
}

/* One pass of a running mean along the rows, written transposed: two passes blur both ways. */
static void pic_ground_blur(double (*from)[PIC_GROUND], double (*to)[PIC_GROUND], int reach)
{
    int x, y;
    for (y = 0; y < PIC_GROUND; y++) {
        double sum = 0;
        for (x = -reach; x < PIC_GROUND; x++) {
            if (x + reach < PIC_GROUND) sum += from[y][x + reach];
            if (x - reach - 1 >= 0) sum -= from[y][x - reach - 1];
            if (x >= 0) to[x][y] = sum / (2 * reach + 1);
        }
    }
}

static pic_ground *pic_ground_make(const pic_scene *sc)
{
    const pic_panel *p = sc->panel;
    pic_ground *g = (pic_ground *)pic_zalloc(1, sizeof *g);
    int32_t i, id[3];
    int pass;
    if (!g) return NULL;
    g->half = 1.5;
    g->height = HUGE_VAL;
    for (i = 0; i < p->n; i++) if (sc->used[i]) g->height = pic_min(g->height, sc->q[3 * (size_t)i + 1]);
    if (!pic_finite(g->height)) g->height = 0;
    for (i = 0; i < p->n_tri; i++) if (pic_triangle(p, i, id))
        pic_ground_triangle(g, sc->q + 3 * (size_t)id[0], sc->q + 3 * (size_t)id[1], sc->q + 3 * (size_t)id[2]);
    for (i = 0; p->n_tri <= 0 && i < p->n; i++) if (sc->used[i])
        pic_ground_drop(g, sc->q[3 * (size_t)i], sc->q[3 * (size_t)i + 1], sc->q[3 * (size_t)i + 2]);
    for (pass = 0; pass < 3; pass++) {
        pic_ground_blur(g->dark, g->other, 4);
        pic_ground_blur(g->other, g->dark, 4);
    }
    return g;
}

/* Darkness of the ground seen at a background sample. */
static double pic_ground_at(const pic_ground *g, const pic_camera *cam, double x, double y)
{
    const double u = (x - cam->cx) / cam->focal, v = -(y - cam->cy) / cam->focal;
    double dir[3], t, i, j, fi, fj;
    int c, a, b;
    for (c = 0; c < 3; c++) dir[c] = u * cam->right[c] + v * cam->up[c] - cam->eye[c];
    t = (g->height - cam->distance * cam->eye[1]) / dir[1];
    if (!(dir[1] < -1e-6) || !(t > 0)) return 0;
    i = ((cam->distance * cam->eye[0] + t * dir[0]) / g->half * 0.5 + 0.5) * PIC_GROUND - 0.5;
    j = ((cam->distance * cam->eye[2] + t * dir[2]) / g->half * 0.5 + 0.5) * PIC_GROUND - 0.5;
    if (!(i >= 0 && j >= 0 && i < PIC_GROUND - 1 && j < PIC_GROUND - 1)) return 0;
    a = (int)i; b = (int)j;
    fi = i - a; fj = j - b;
    return (1 - fj) * ((1 - fi) * g->dark[b][a] + fi * g->dark[b][a + 1])
         + fj * ((1 - fi) * g->dark[b + 1][a] + fi * g->dark[b + 1][a + 1]);
}

/* ==== [10] panel ==== */

/* The paper: off-white, a little cooler and darker towards the bottom. Linear light; y from 0 (top) to 1. */
static void pic_paper(double y, double rgb[3])
{
    static const double top[3] = {0.984, 0.984, 0.978}, bottom[3] = {0.902, 0.912, 0.925};
    const double t = pic_smooth(y);
    int c;
    for (c = 0; c < 3; c++) rgb[c] = pic_to_linear(top[c] + t * (bottom[c] - top[c]));
}

/* What a panel's pixels need. */
typedef struct pic_paint {
    const pic_scene *scene;
    const pic_buffer *buffer;
    const pic_ground *ground;   /* or NULL */
    const pic_lut *lut;
    const float *open;
    int32_t ss;                 /* samples per pixel and direction */
} pic_paint;

static void pic_paint_sample(const pic_paint *pt, int32_t x, int32_t y, double open, double rgb[3])
{
    static const double clay[3] = {0.56, 0.60, 0.66}, missing[3] = {0.39, 0.39, 0.39};
    const size_t k = (size_t)y * (size_t)pt->buffer->w + (size_t)x;
    double base[3];
    pic_hit hit;
    int c;
    pic_hit_at(pt->scene, pt->buffer->id[k], x + 0.5, y + 0.5, &hit);
    if (!pt->scene->panel->field) memcpy(base, clay, sizeof base);
    else if (!pic_finite(hit.s)) memcpy(base, missing, sizeof base);
    else pic_lut_at(pt->lut, hit.s, base);
    pic_shade(base, &hit, open, rgb);
    for (c = 0; c < 3; c++) rgb[c] = pic_min(rgb[c], 1);
}

static double pic_line_ink(uint8_t line) { return 1 - 0.70 * line / 255; }

/* Sums the colours of the pixel's samples and returns how many show the shape. Where one triangle fills the pixel, light
 * and colour hardly change within it: they are worked out once, and only the isolines' darkness is averaged. */
static int32_t pic_paint_pixel(const pic_paint *pt, int32_t x, int32_t y, double open, double sum[3])
{
    const pic_buffer *b = pt->buffer;
    const int32_t ss = pt->ss;
    int32_t i, j, seen = 0, same = 0, first = -1;    /* id is only set where d > 0 */
    double ink = 0, rgb[3];
    int c;
    sum[0] = sum[1] = sum[2] = 0;
    for (j = y * ss; j < (y + 1) * ss; j++) for (i = x * ss; i < (x + 1) * ss; i++) {
        const size_t k = (size_t)j * (size_t)b->w + (size_t)i;
        if (!(b->d[k] > 0)) continue;
        if (seen++ == 0) first = b->id[k];
        same += b->id[k] == first;
        ink += pic_line_ink(b->line[k]);
    }
    if (seen > 0 && same == ss * ss) {
        pic_paint_sample(pt, x * ss + ss / 2, y * ss + ss / 2, open, rgb);
        for (c = 0; c < 3; c++) sum[c] = rgb[c] * ink;
        return seen;
    }
    for (j = y * ss; seen > 0 && j < (y + 1) * ss; j++) for (i = x * ss; i < (x + 1) * ss; i++) {
        const size_t k = (size_t)j * (size_t)b->w + (size_t)i;
        if (!(b->d[k] > 0)) continue;
        pic_paint_sample(pt, i, j, open, rgb);
        for (c = 0; c < 3; c++) sum[c] += rgb[c] * pic_line_ink(b->line[k]);
    }
    return seen;
}

/* Shadows fade out towards the panel's border, which must not show. */
static double pic_border_fade(int32_t x, int32_t y, int32_t w, int32_t h)
{
    const double margin = 0.16 * (w < h ? w : h);
    const double near_x = pic_min(x + 0.5, w - x - 0.5), near_y = pic_min(y + 0.5, h - y - 0.5);
    return pic_smooth(near_x / margin) * pic_smooth(near_y / margin);
}

/* Paints the panel's pixels into the image, its corner at (left, top). Samples are averaged in linear light. */
static void pic_paint_panel(pic_image *img, const pic_paint *pt, int32_t left, int32_t top)
{
    const int32_t ss = pt->ss, w = pt->buffer->w / ss, h = pt->buffer->h / ss;
    int32_t x, y;
    int c;
    for (y = 0; y < h; y++) for (x = 0; x < w; x++) {
        double sum[3], rgb[3], share;
        uint8_t *out = img->rgb + 3 * ((size_t)(top + y) * (size_t)img->width + (size_t)(left + x));
        const int32_t seen = pic_paint_pixel(pt, x, y, (double)pt->open[(size_t)y * (size_t)w + (size_t)x], sum);
        share = seen / (double)(ss * ss);
        pic_paper((top + y + 0.5) / img->height, rgb);
        if (pt->ground && share < 1) {
            const double dark = 0.50 * pic_border_fade(x, y, w, h)
                              * pic_clamp(pic_ground_at(pt->ground, &pt->scene->cam, (x + 0.5) * ss, (y + 0.5) * ss), 0, 1);
            for (c = 0; c < 3; c++) rgb[c] *= 1 - dark * (c == 2 ? 0.92 : 1);
        }
        for (c = 0; c < 3; c++) out[c] = pic_byte(pic_to_srgb(sum[c] / (ss * ss) + (1 - share) * rgb[c]));
    }
}

/* A ring on each marked vertex that is seen. */
static void pic_paint_markers(pic_image *img, const pic_scene *sc, const pic_buffer *b, int32_t ss, int32_t left, int32_t top,
                              double size)
{
    static const uint8_t dark[3] = {24, 26, 32}, light[3] = {255, 255, 255};
    const pic_panel *p = sc->panel;
    int32_t i;
    for (i = 0; p->markers && i < p->n_markers; i++) {
        const int32_t id = p->markers[i];
        const pic_vertex *v;
        int32_t x, y;
        double cx, cy, behind;
        if (id < 0 || id >= p->n || !sc->used[id]) continue;
        v = sc->v + id;
        x = (int32_t)pic_clamp(v->x, 0, b->w - 1);
        y = (int32_t)pic_clamp(v->y, 0, b->h - 1);
        behind = 1 / v->d - 1 / pic_max((double)b->d[(size_t)y * (size_t)b->w + (size_t)x], 1e-9);
        if (behind > 0.03 + sc->radius) continue;
        cx = left + v->x / ss;
        cy = top + v->y / ss;
        pic_ring(img, cx, cy, 0, size * 1.32, dark, 1);
        pic_ring(img, cx, cy, 0, size * 1.02, light, 1);
        pic_ring(img, cx, cy, 0, size * 0.50, dark, 1);
    }
}

/* One view shared by panels of the same mesh. */
typedef struct pic_view { int known; double azimuth, elevation; } pic_view;

/* Returns 0 without memory. */
static int pic_panel_aim(pic_scene *sc, const pic_opts *o, pic_view *view)
{
    if (o->view_given && pic_finite(o->azimuth) && pic_finite(o->elevation)) {
        view->azimuth = o->azimuth;
        view->elevation = o->elevation;
    } else if (!view->known && !pic_view_choose(sc, &view->azimuth, &view->elevation)) return 0;
    view->known = 1;
    pic_camera_aim(&sc->cam, view->azimuth, view->elevation);
    return 1;
}

/* Draws one panel into the rectangle of w x h pixels at (left, top), which lies inside the image. size: pixels per unit of
 * the layout (1 in a panel as wide as the default picture). */
static int pic_panel_draw(pic_image *img, const pic_panel *p, const pic_scale *scale, const pic_lut *lut, const pic_opts *o,
                          int32_t left, int32_t top, int32_t w, int32_t h, double size, pic_view *view)
{
    int32_t ss = o->supersample > 0 ? (o->supersample < 8 ? o->supersample : 8) : 3;
    const size_t pixels = (size_t)w * (size_t)h;
    float *open = (float *)pic_alloc(pixels, 2 * sizeof(float));
    pic_scene sc;
    pic_buffer b;
    pic_paint pt;
    pic_ground *ground = NULL;
    while (ss > 1 && pixels * (size_t)(ss * ss) > (size_t)64 << 20) ss--;
    if (!open) return PIC_ERR_MEMORY;
    if (pic_scene_make(&sc, p, scale, o) != PIC_OK) { free(open); return PIC_ERR_MEMORY; }
    if (!pic_panel_aim(&sc, o, view) || pic_buffer_make(&b, w * ss, h * ss) != PIC_OK) { pic_scene_free(&sc); free(open); return PIC_ERR_MEMORY; }
    pic_scene_fit(&sc, b.w, b.h);
    pic_raster_scene(&b, &sc);
    pic_line_scene(&b, &sc, scale, pic_max(0.95 * size, 0.5) * ss);
    pic_openness_all(&b, &sc, ss, open, open + pixels);
    if (sc.cam.eye[1] > 0.08 && sc.n_drawn > 0 && (ground = pic_ground_make(&sc)) == NULL) img->lacking = 1;
    pt.scene = &sc; pt.buffer = &b; pt.ground = ground; pt.lut = lut; pt.open = open; pt.ss = ss;
    pic_paint_panel(img, &pt, left, top);
    pic_paint_markers(img, &sc, &b, ss, left, top, 4.6 * pic_max(size, 0.75));
    free(ground);
    pic_buffer_free(&b);
    pic_scene_free(&sc);
    free(open);
    return PIC_OK;
}

/* ==== [11] legend ==== */

enum { PIC_MAX_TICKS = 64 };

typedef struct pic_ticks {
    int n;
    double at[PIC_MAX_TICKS];           /* position 0..1 */
    char text[PIC_MAX_TICKS][32];       /* empty: a small tick without number */
    char factor[32];                    /* what all numbers are to be multiplied with, or empty */
} pic_ticks;

static void pic_tick_add(pic_ticks *t, double at, const char *text)
{
    if (t->n >= PIC_MAX_TICKS || !(at > -1e-6 && at < 1 + 1e-6)) return;
    t->at[t->n] = pic_clamp(at, 0, 1);
    snprintf(t->text[t->n++], sizeof t->text[0], "%s", text);
}

/* Powers of ten, not more than about ten numbers, and small ticks between where there is room. */
static void pic_ticks_log(pic_ticks *t, const pic_scale *sc)
{
    const double a = log10(sc->lo), range = log10(sc->hi) - a;
    const int every = range <= 10 ? 1 : (int)pic_nice_step(range / 10);
    const double first = ceil(a - 1e-9);
    double k;
    int m;
    char text[32];
    if (range < 1.5) {      /* hardly a power inside: 1, 2 and 5 times one, or all multiples */
        for (k = floor(a); k <= a + range; k++) for (m = 1; m <= 9; m += range < 0.8 || m == 1 ? 1 : m == 2 ? 3 : 9) {
            snprintf(text, sizeof text, "%d\xc2\xb7" "10^%d", m, (int)k);
            pic_tick_add(t, (k + log10(m) - a) / range, m == 1 ? strchr(text, '1') + 3 : text);
        }
        return;
    }
    for (k = first - 1; k <= a + range + 1e-9; k++) {
        const int numbered = fmod(fabs(k), every) < 0.5;
        snprintf(text, sizeof text, "10^%d", (int)k);
        pic_tick_add(t, (k - a) / range, numbered ? text : "");
        for (m = 2; m < 10 && range <= 5; m++) pic_tick_add(t, (k + log10(m) - a) / range, "");
    }
}

static void pic_ticks_linear(pic_ticks *t, const pic_scale *sc)
{
    const double most = pic_max(fabs(sc->lo), fabs(sc->hi));
    const int e = most > 0 ? (int)floor(log10(most)) : 0, scaled = e >= 5 || e <= -4;
    const double unit = scaled ? pow(10, e) : 1, lo = sc->lo / unit, hi = sc->hi / unit, step = pic_nice_step((hi - lo) / 6.5);
    const int digits = step > 0 && pic_finite(step) ? (int)pic_clamp(ceil(-log10(step) - 1e-9), 0, 15) : 0;
    double k;
    int i;
    char text[32];
    if (scaled) snprintf(t->factor, sizeof t->factor, "\xc3\x97 10^%d", e);
    if (!(step > 0) || !pic_finite(step)) return;
    for (i = 0; i < 20; i++) {
        k = ceil(lo / step - 1e-6) + i;
        if (k * step > hi + 1e-6 * step) break;
        snprintf(text, sizeof text, "%.*f", digits, fabs(k) < 0.5 ? 0.0 : k * step);
        pic_tick_add(t, (k * step - lo) / (hi - lo), text);
    }
}

/* The number of each label in the middle of its band, or of every other, fifth or tenth. */
static void pic_ticks_labels(pic_ticks *t, const pic_scale *sc)
{
    const int32_t every = sc->labels <= 24 ? 1 : (int32_t)pic_nice_step(sc->labels / 20.0);
    int32_t k;
    char text[32];
    for (k = 0; k < sc->labels; k += every) {
        snprintf(text, sizeof text, "%ld", (long)k);
        pic_tick_add(t, (k + 0.5) / sc->labels, text);
    }
}

static void pic_ticks_make(pic_ticks *t, const pic_scale *sc)
{
    char text[32];
    memset(t, 0, sizeof *t);
    if (sc->labels > 0) pic_ticks_labels(t, sc);
    else if (sc->constant) {
        snprintf(text, sizeof text, "%.4g", sc->hi);
        pic_tick_add(t, 0.5, text);
    } else if (sc->is_log) pic_ticks_log(t, sc);
    else pic_ticks_linear(t, sc);
}

static double pic_ticks_width(const pic_ticks *t, double cap)
{
    double w = pic_text_width(t->factor, cap);
    int i;
    for (i = 0; i < t->n; i++) w = pic_max(w, pic_text_width(t->text[i], cap));
    return w;
}

static const uint8_t pic_ink[3] = {38, 42, 50}, pic_ink_soft[3] = {98, 104, 114};

/* A colour bar with its left top at (x, y), isolines and ticks in place. */
static void pic_legend_draw(pic_image *img, const pic_scale *sc, const pic_lut *lut, const pic_ticks *t, const char *label,
                            double x, double y, double w, double h, double cap, double width)
{
    double rgb[3], head = y - 1.6 * cap;
    uint8_t c8[3];
    int32_t i;
    int c;
    pic_fill_rect(img, x - 1, y - 1, x + w + 1, y + h + 1, pic_ink, 0.55);
    for (i = 0; i < h; i++) {
        pic_lut_at(lut, sc->constant ? 0.5 : 1 - (i + 0.5) / h, rgb);
        for (c = 0; c < 3; c++) c8[c] = pic_byte(pic_to_srgb(rgb[c]));
        pic_fill_rect(img, x, y + i, x + w, pic_min(y + i + 1, y + h), c8, 1);
    }
    for (i = 0; i < sc->n_levels; i++) {
        const double ly = y + h * (1 - sc->first - i * sc->step);
        if (sc->step * h > 3) pic_fill_rect(img, x, ly - 0.5, x + w, ly + 0.5, pic_ink, 0.55);
    }
    for (i = 0; i < t->n; i++) {
        const double ty = y + h * (1 - t->at[i]);
        pic_fill_rect(img, x + w + 1, floor(ty), x + w + (t->text[i][0] ? 0.5 : 0.3) * cap + 1, floor(ty) + 1, pic_ink, 0.7);
        pic_text(img, t->text[i], x + w + 0.75 * cap, ty + 0.5 * cap, cap, 0, 1, pic_ink);
    }
    if (t->factor[0]) { pic_text(img, t->factor, x, head, cap, 0, 1, pic_ink_soft); head -= 1.9 * cap; }
    if (label && *label) {
        const double fit = pic_text_fit(label, 1.08 * cap, width);
        pic_text(img, label, x, head, fit, 0, 1.1, pic_ink);
    }
}

/* ==== [12] figure ==== */

/* Where things stand, in pixels. */
typedef struct pic_layout {
    double unit;                            /* 1 in a picture of 1200 x 900 */
    double left, top, right, bottom;        /* what the panels share */
    int32_t columns, rows;
    double cell_w, cell_h, caption;         /* a cell, and the strip for the caption at its bottom */
    double bar_w, tick_cap, legend_w;       /* legend_w: room it takes at the right of the figure or of each cell */
} pic_layout;

/* Columns with which panels come out largest, taking a panel to look best about as wide as 1.25 its height. */
static int32_t pic_best_columns(int32_t n, double w, double h)
{
    int32_t best = 1, c;
    double size = 0;
    for (c = 1; c <= n; c++) {
        const int32_t rows = (n + c - 1) / c;
        const double s = pic_min(w / c / 1.25, h / rows) * (1 - 0.04 * (rows * c - n));
        if (s > size * 1.0001) { size = s; best = c; }
    }
    return best;
}

static void pic_layout_make(pic_layout *l, const pic_image *img, const pic_panel *panels, int32_t n, const pic_opts *o,
                            double widest_tick, int legend)
{
    int32_t i;
    l->left = 26 * l->unit;
    l->right = img->width - 26 * l->unit;
    l->top = 24 * l->unit + (o->title ? 34 * l->unit : 0) + (o->subtitle ? 24 * l->unit : 0);
    l->bottom = img->height - 22 * l->unit;
    /* A long label gets some room, then smaller letters. */
    l->legend_w = l->bar_w + widest_tick + 24 * l->unit;
    l->legend_w = pic_max(l->legend_w, pic_min(pic_text_width(o->label, 1.08 * l->tick_cap), 175 * l->unit));
    if (!legend) l->legend_w = 0;
    if (!o->own_scale) l->right -= l->legend_w;
    l->columns = o->columns > 0 ? (o->columns < n ? o->columns : n) : pic_best_columns(n, l->right - l->left, l->bottom - l->top);
    l->rows = (n + l->columns - 1) / l->columns;
    l->cell_w = (l->right - l->left) / l->columns;
    l->cell_h = (l->bottom - l->top) / l->rows;
    l->caption = 0;
    for (i = 0; i < n; i++) if (panels[i].caption) l->caption = 34 * l->unit;
}

static void pic_figure_paper(pic_image *img)
{
    double rgb[3];
    int32_t x, y;
    int c;
    for (y = 0; y < img->height; y++) {
        uint8_t *row = img->rgb + 3 * (size_t)y * (size_t)img->width;
        pic_paper((y + 0.5) / img->height, rgb);
        for (c = 0; c < 3; c++) row[c] = pic_byte(pic_to_srgb(rgb[c]));
        for (x = 1; x < img->width; x++) memcpy(row + 3 * (size_t)x, row, 3);
    }
}

static void pic_figure_titles(pic_image *img, const pic_opts *o, double unit)
{
    const double x = 32 * unit, width = img->width - 64 * unit, small = pic_max(12.5 * unit, 5.5);
    if (o->title) pic_text(img, o->title, x, 50 * unit, pic_text_fit(o->title, 19 * unit, width), 0, 1.25, pic_ink);
    if (o->subtitle)
        pic_text(img, o->subtitle, x, (o->title ? 79 : 50) * unit, pic_text_fit(o->subtitle, small, width), 0, 1, pic_ink_soft);
}

/* Legend beside the rectangle (x.., top..bottom). */
static void pic_figure_legend(pic_image *img, const pic_layout *l, const pic_scale *sc, const pic_lut *lut, const pic_opts *o,
                              double x, double top, double bottom)
{
    const double h = pic_min(0.62 * (bottom - top), 560 * l->unit), y = (top + bottom - h) / 2 + 0.8 * l->tick_cap;
    pic_ticks t;
    pic_ticks_make(&t, sc);
    if (h > 4 * l->tick_cap)
        pic_legend_draw(img, sc, lut, &t, o->label, floor(x), floor(y), floor(l->bar_w), floor(h), l->tick_cap,
                        l->legend_w + 6 * l->unit);
}

/* Panel i with its caption, and its own legend if it has one. */
static int pic_figure_panel(pic_image *img, const pic_layout *l, const pic_panel *panels, int32_t i, int32_t n,
                            const pic_scale *sc, const pic_lut *lut, const pic_opts *o, pic_view *view)
{
    const int32_t row = i / l->columns, in_row = row == l->rows - 1 ? n - row * l->columns : l->columns;
    const double x0 = l->left + (i % l->columns + 0.5 * (l->columns - in_row)) * l->cell_w, y0 = l->top + row * l->cell_h;
    const double own = o->own_scale && panels[i].field ? l->legend_w : 0;
    const int32_t left = (int32_t)pic_clamp(x0, 0, img->width - 1), top = (int32_t)pic_clamp(y0, 0, img->height - 1);
    const int32_t w = (int32_t)pic_clamp(l->cell_w - own, 1, img->width - left);
    const int32_t h = (int32_t)pic_clamp(l->cell_h - l->caption, 1, img->height - top);
    const double size = pic_clamp(pic_max(w / 1130.0, h / 830.0), 0.62 * l->unit, l->unit);
    const int status = pic_panel_draw(img, panels + i, sc, lut, o, left, top, w, h, size, view);
    if (status != PIC_OK) return status;
    if (panels[i].caption)
        pic_text(img, panels[i].caption, left + 0.5 * w, y0 + l->cell_h - l->caption + 16 * l->unit,
                 pic_text_fit(panels[i].caption, pic_max(13 * l->unit, 5.5), l->cell_w), 0.5, 1.1, pic_ink);
    if (own > 0) pic_figure_legend(img, l, sc, lut, o, left + w + 4 * l->unit, y0, y0 + l->cell_h - l->caption);
    return PIC_OK;
}

static int pic_figure_draw(pic_image *img, const pic_panel *panels, int32_t n, const pic_opts *o, pic_scale *scales, pic_lut *lut)
{
    pic_layout l;
    pic_view view = {0, 0, 0};
    double widest = 0;
    int32_t i, legend = 0;
    memset(&l, 0, sizeof l);
    l.unit = pic_min(img->width / 1200.0, img->height / 900.0);
    l.bar_w = pic_max(22 * l.unit, 6);
    l.tick_cap = pic_max((o->own_scale && n > 1 ? 10 : 12) * l.unit, 5.5);
    for (i = 0; i < n; i++) {
        pic_ticks t;
        if (o->own_scale || i == 0) pic_scale_make(scales + i, panels, o->own_scale ? i : 0, o->own_scale ? i + 1 : n, o);
        else scales[i] = scales[0];
        pic_ticks_make(&t, scales + i);
        widest = pic_max(widest, pic_ticks_width(&t, l.tick_cap));
        legend |= panels[i].field != NULL && !o->no_legend;
    }
    pic_lut_fill(lut, o->colormap, o->labels);
    pic_layout_make(&l, img, panels, n, o, widest + l.tick_cap, legend);
    pic_figure_paper(img);
    for (i = 0; i < n; i++) {
        int status;
        if (i > 0 && panels[i].xyz != panels[i - 1].xyz && !o->one_view) view.known = 0;
        status = pic_figure_panel(img, &l, panels, i, n, scales + i, lut, o, &view);
        if (status != PIC_OK) return status;
    }
    if (legend && !o->own_scale) pic_figure_legend(img, &l, scales, lut, o, l.right + 6 * l.unit, l.top, l.bottom);
    pic_figure_titles(img, o, l.unit);
    return PIC_OK;
}

static int pic_panel_ok(const pic_panel *p)
{
    if (p->n < 0 || p->n_tri < 0 || p->n_markers < 0) return 0;
    return (p->n == 0 || p->xyz) && (p->n_tri == 0 || p->tri);
}

/* A picture of n_panels panels in a grid. Panels of the same mesh that follow each other share the view (all with one_view). opts may be NULL.
 * out is filled anew (free with pic_image_free) and empty on failure. */
static int pic_render_grid(pic_image *out, const pic_panel *panels, int32_t n_panels, const pic_opts *opts)
{
    pic_opts o;
    pic_scale *scales;
    pic_lut *lut;
    int32_t i;
    int status = PIC_ERR_MEMORY;
    memset(&o, 0, sizeof o);
    if (opts) o = *opts;
    out->rgb = NULL;
    out->lacking = 0;
    out->width = o.width > 0 ? o.width : 1200;
    out->height = o.height > 0 ? o.height : 900;
    if (out->width > PIC_MAX_SIDE || out->height > PIC_MAX_SIDE || n_panels < 1 || !panels) status = PIC_ERR_ARGUMENT;
    for (i = 0; status != PIC_ERR_ARGUMENT && i < n_panels; i++) if (!pic_panel_ok(panels + i)) status = PIC_ERR_ARGUMENT;
    if (status == PIC_ERR_ARGUMENT) { out->width = out->height = 0; return status; }
    out->rgb = (uint8_t *)pic_alloc((size_t)out->width * (size_t)out->height, 3);
    scales = (pic_scale *)pic_zalloc((size_t)n_panels, sizeof *scales);
    lut = (pic_lut *)pic_alloc(1, sizeof *lut);
    if (out->rgb && scales && lut) status = pic_figure_draw(out, panels, n_panels, &o, scales, lut);
    free(scales);
    free(lut);
    if (status == PIC_OK && out->lacking) status = PIC_ERR_MEMORY;
    if (status != PIC_OK) pic_image_free(out);
    return status;
}

/* A picture of one panel. */
static int pic_render(pic_image *out, const pic_panel *panel, const pic_opts *opts)
{
    return pic_render_grid(out, panel, 1, opts);
}

#endif
