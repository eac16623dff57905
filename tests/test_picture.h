/* test_picture.h - the pictures (tools/picture.h) and the shapes (tools/shapes.h)

   The runner defines CHECK and CHECK_MSG and test_tmp_dir() before including this. PNG files are read back by a reader of
   our own that shares no line with the writer. */

#ifndef TEST_PICTURE_H
#define TEST_PICTURE_H

#include "../tools/picture.h"
#include "../tools/shapes.h"

/* ---- a PNG reader ---- */

typedef struct tpic_bits { const uint8_t *p; size_t n, at; int failed; } tpic_bits;    /* at: next bit */

static uint32_t tpic_take(tpic_bits *b, int count) {
    uint32_t v = 0;
    int i;
    for (i = 0; i < count; i++, b->at++) {
        if (b->at / 8 >= b->n) { b->failed = 1; return 0; }
        v |= (uint32_t)(b->p[b->at / 8] >> (b->at % 8) & 1) << i;
    }
    return v;
}

/* A Huffman code by counts: how many codes of each length, and the symbols in code order. */
typedef struct tpic_code { int count[16], symbol[320]; } tpic_code;

/* Returns how many codes of the longest length are left over: 0 for a complete code, negative for an impossible one. */
static int tpic_code_make(tpic_code *c, const uint8_t *len, int n) {
    int at[17] = {0}, i, left = 1;
    memset(c, 0, sizeof *c);
    for (i = 0; i < n; i++) c->count[len[i]]++;
    c->count[0] = 0;
    for (i = 1; i < 16; i++) { left = 2 * left - c->count[i]; at[i + 1] = at[i] + c->count[i]; }
    for (i = 0; i < n; i++) if (len[i]) c->symbol[at[len[i]]++] = i;
    return left;
}

static int tpic_decode(tpic_bits *b, const tpic_code *c) {
    int code = 0, first = 0, index = 0, len;
    for (len = 1; len < 16; len++) {
        code = code << 1 | (int)tpic_take(b, 1);
        if (code - first < c->count[len]) return c->symbol[index + code - first];
        index += c->count[len];
        first = (first + c->count[len]) << 1;
    }
    b->failed = 1;
    return 0;
}

static void tpic_dynamic_codes(tpic_bits *b, tpic_code *lit, tpic_code *dist) {
    static const uint8_t order[19] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
    const int n_lit = (int)tpic_take(b, 5) + 257, n_dist = (int)tpic_take(b, 5) + 1, n_len = (int)tpic_take(b, 4) + 4;
    uint8_t len[320] = {0};
    tpic_code runs;
    int i, k;
    for (i = 0; i < n_len; i++) len[order[i]] = (uint8_t)tpic_take(b, 3);
    CHECK(tpic_code_make(&runs, len, 19) == 0);
    for (i = 0; i < n_lit + n_dist && !b->failed; ) {
        const int sym = tpic_decode(b, &runs);
        uint8_t value = 0;
        if (sym < 16) { len[i++] = (uint8_t)sym; continue; }
        if (sym == 16 && i > 0) value = len[i - 1];
        k = sym == 16 ? 3 + (int)tpic_take(b, 2) : sym == 17 ? 3 + (int)tpic_take(b, 3) : 11 + (int)tpic_take(b, 7);
        if (i + k > n_lit + n_dist) { b->failed = 1; return; }
        while (k-- > 0) len[i++] = value;
    }
    CHECK(tpic_code_make(lit, len, n_lit) == 0);
    CHECK(tpic_code_make(dist, len + n_lit, n_dist) == 0);
}

static void tpic_fixed_codes(tpic_code *lit, tpic_code *dist) {
    uint8_t len[288];
    int i;
    for (i = 0; i < 288; i++) len[i] = (uint8_t)(i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8);
    tpic_code_make(lit, len, 288);
    memset(len, 5, 30);
    tpic_code_make(dist, len, 30);
}

static size_t tpic_inflate_block(tpic_bits *b, const tpic_code *lit, const tpic_code *dist, uint8_t *out, size_t at, size_t room) {
    while (!b->failed) {
        int sym = tpic_decode(b, lit), extra, length, distance;
        if (sym == 256) return at;
        if (sym < 256) {
            if (at >= room) break;
            out[at++] = (uint8_t)sym;
            continue;
        }
        sym -= 257;
        extra = sym < 8 || sym == 28 ? 0 : sym / 4 - 1;
        length = sym == 28 ? 258 : sym < 8 ? sym + 3 : ((4 + sym % 4) << extra) + 3;
        length += (int)tpic_take(b, extra);
        sym = tpic_decode(b, dist);
        extra = sym < 4 ? 0 : sym / 2 - 1;
        distance = sym < 4 ? sym + 1 : ((2 + sym % 2) << extra) + 1;
        distance += (int)tpic_take(b, extra);
        if ((size_t)distance > at || at + (size_t)length > room) break;
        for (; length > 0; length--, at++) out[at] = out[at - (size_t)distance];
    }
    b->failed = 1;
    return at;
}

/* Inflates a zlib stream of known length, checksum included. Returns 1 when all is well. */
static int tpic_inflate(const uint8_t *p, size_t n, uint8_t *out, size_t room) {
    tpic_bits b = {p, n, 16, 0};
    size_t at = 0, i;
    uint32_t a1 = 1, a2 = 0, sum = 0, last = 0;
    tpic_code lit, dist;
    if (n < 6 || (p[0] & 15) != 8 || (p[0] * 256 + p[1]) % 31 != 0) return 0;
    while (!last && !b.failed) {
        uint32_t kind;
        last = tpic_take(&b, 1);
        kind = tpic_take(&b, 2);
        if (kind == 2) tpic_dynamic_codes(&b, &lit, &dist);
        else if (kind == 1) tpic_fixed_codes(&lit, &dist);
        else return 0;
        at = tpic_inflate_block(&b, &lit, &dist, out, at, room);
    }
    for (i = 0; i < at; i++) { a1 = (a1 + out[i]) % 65521u; a2 = (a2 + a1) % 65521u; }
    b.at = (b.at + 7) / 8 * 8;
    for (i = 0; i < 4; i++) sum = sum << 8 | tpic_take(&b, 8);
    return !b.failed && at == room && b.at == 8 * n && sum == (a2 << 16 | a1);
}

static uint32_t tpic_be32(const uint8_t *p) { return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3]; }

static uint32_t tpic_crc(const uint8_t *p, size_t n) {
    uint32_t c = 0xffffffffu;
    int k;
    for (; n > 0; n--, p++) for (c ^= *p, k = 0; k < 8; k++) c = c & 1u ? c >> 1 ^ 0xedb88320u : c >> 1;
    return ~c;
}

static void tpic_unfilter(uint8_t *raw, int32_t w, int32_t h) {
    const size_t row = (size_t)w * 3 + 1;
    size_t i;
    int32_t y;
    for (y = 0; y < h; y++) for (i = 1; i < row; i++) {
        uint8_t *p = raw + (size_t)y * row;
        const uint8_t *up = y > 0 ? p - row : NULL;
        const int a = i > 3 ? p[i - 3] : 0, b = up ? up[i] : 0, c = up && i > 3 ? up[i - 3] : 0;
        const int q = a + b - c, qa = abs(q - a), qb = abs(q - b), qc = abs(q - c);
        const int paeth = qa <= qb && qa <= qc ? a : qb <= qc ? b : c;
        p[i] = (uint8_t)(p[i] + (p[0] == 0 ? 0 : p[0] == 1 ? a : p[0] == 2 ? b : p[0] == 3 ? (a + b) / 2 : paeth));
    }
}

/* Whether the PNG file in memory holds exactly these pixels and nothing out of order. */
static int tpic_png_holds(const uint8_t *png, size_t n, const uint8_t *rgb, int32_t w, int32_t h) {
    static const uint8_t signature[8] = {137, 80, 78, 71, 13, 10, 26, 10};
    const size_t row = (size_t)w * 3 + 1;
    uint8_t *raw = (uint8_t *)malloc(row * (size_t)h);
    size_t at = 8;
    int32_t y;
    int ok = raw && n > 8 && memcmp(png, signature, 8) == 0, chunks = 0, ended = 0, data = 0;
    while (ok && at < n) {
        const size_t size = n - at >= 12 ? tpic_be32(png + at) : n;
        const uint8_t *name = png + at + 4;
        ok = size <= n - at - 12 && !ended && tpic_crc(name, size + 4) == tpic_be32(name + 4 + size);
        if (!ok) break;
        if (chunks == 0) ok = memcmp(name, "IHDR", 4) == 0 && size == 13 && tpic_be32(name + 4) == (uint32_t)w
                           && tpic_be32(name + 8) == (uint32_t)h && name[12] == 8 && name[13] == 2 && name[16] == 0;
        if (memcmp(name, "IDAT", 4) == 0) { ok = ok && tpic_inflate(name + 4, size, raw, row * (size_t)h); data++; }
        if (memcmp(name, "IEND", 4) == 0) ended = 1;
        chunks++;
        at += size + 12;
    }
    ok = ok && ended && data == 1;
    if (ok) tpic_unfilter(raw, w, h);
    for (y = 0; ok && y < h; y++) ok = memcmp(raw + (size_t)y * row + 1, rgb + (size_t)y * (row - 1), row - 1) == 0;
    free(raw);
    return ok;
}

static void tpic_check_png(const uint8_t *rgb, int32_t w, int32_t h, const char *what) {
    uint8_t *png = NULL;
    size_t n = 0;
    CHECK_MSG(pic_png_encode(&png, &n, rgb, w, h) == PIC_OK, "%s: not encoded", what);
    CHECK_MSG(png && tpic_png_holds(png, n, rgb, w, h), "%s: %d x %d does not come back", what, (int)w, (int)h);
    free(png);
}

/* ---- PNG ---- */

/* Fills n bytes; n is 3 w h. */
static void tpic_fill(const char *what, uint8_t *rgb, int32_t n, int32_t w) {
    uint64_t seed = 5;
    int32_t i, a = 1, b = 1, k, s = 0;
    for (i = 0; i < n; i++)
        if (*what == 'r') rgb[i] = (uint8_t)(i / 3 % w + i / 3 / w * (i % 3));
        else rgb[i] = (uint8_t)(shape_random(&seed) & 255u);
    if (*what == 'b') memset(rgb, 0, (size_t)n);
    for (i = 32768 + 2; *what == 'w' && i < n; i++) rgb[i] = rgb[i - 32768 + i / 65536];
    for (i = 0; *what == 's' && i < n; s++) {
        for (k = 0; k < a && i < n; k++) rgb[i++] = (uint8_t)((s * 37) & 255);
        k = a + b;
        a = b;
        b = k;
        if (s == 22) a = b = s = 1;
    }
    for (i = n - 1; *what == 's' && i > 0; i--) {
        const int32_t j = (int32_t)(shape_random(&seed) % (uint64_t)(i + 1));
        const uint8_t swap = rgb[i];
        rgb[i] = rgb[j];
        rgb[j] = swap;
    }
}

/* skewed: symbol counts that grow like Fibonacci numbers want codes longer than 15 bits, and the limit must hold.
 * window: repeats at the far end of the window, and just beyond. */
static void tpic_test_png_pixels(void) {
    static const struct { const char *what; int32_t w, h; } rows[] = {
        {"black", 317, 211}, {"noise", 317, 211}, {"noise, one pixel", 1, 1}, {"noise, one column", 1, 200}, {"noise, one row", 300, 1},
        {"ramps", 317, 211}, {"skewed", 317, 211}, {"window", 317, 211}};
    static uint8_t rgb[3 * 317 * 211];
    size_t k;
    for (k = 0; k < sizeof rows / sizeof *rows; k++) {
        tpic_fill(rows[k].what, rgb, 3 * rows[k].w * rows[k].h, rows[k].w);
        tpic_check_png(rgb, rows[k].w, rows[k].h, rows[k].what);
    }
}

/* The Huffman lengths themselves: within the limit, complete, and never longer for a more frequent symbol. */
static void tpic_test_huffman(void) {
    uint32_t freq[286];
    uint8_t len[286];
    int n, i, j, k;
    for (n = 2; n <= 286; n += n < 40 ? 1 : 41) for (k = 0; k < 3; k++) {
        uint64_t seed = (uint64_t)n;
        double full = 0;
        for (i = 0; i < n; i++)
            freq[i] = k == 0 ? 1u : k == 1 ? 1u << (i < 28 ? i : 28) : (uint32_t)(shape_random(&seed) % 1000) + 1;
        pic_huffman_lengths(freq, n, 15, len);
        for (i = 0; i < n; i++) { CHECK(len[i] >= 1 && len[i] <= 15); full += pow(2, -len[i]); }
        CHECK_MSG(fabs(full - 1) < 1e-12, "n = %d: Kraft sum %g", n, full);
        for (i = 0; i < n; i++) for (j = 0; j < n; j++) if (freq[i] > freq[j]) CHECK(len[i] <= len[j]);
    }
}

static void tpic_test_png_file(void) {
    static const uint8_t rgb[2 * 2 * 3] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 9, 8, 7};
    char back[4096], path[1024], name[TEST_LONGEST_NAME + 1];
    uint8_t *data = NULL;
    size_t n, size = 0;
    snprintf(path, sizeof path, "%s", tmio_path("picture_test.png"));
    CHECK(pic_png_write(path, rgb, 2, 2) == PIC_OK);
    CHECK(pic_png_write(path, rgb, 2, 2) == PIC_OK);    /* over an existing one */
    n = tmio_get(path, back, sizeof back);
    CHECK(tpic_png_holds((const uint8_t *)back, n, rgb, 2, 2) && !tmio_exists(tmio_path("picture_test.png.part")));
    CHECK(pic_png_write(path, NULL, 2, 2) == PIC_ERR_ARGUMENT && pic_png_write(path, rgb, 0, 2) == PIC_ERR_ARGUMENT);
    CHECK(pic_png_write("", rgb, 2, 2) == PIC_ERR_ARGUMENT && pic_png_write(NULL, rgb, 1, 1) != PIC_OK);
    remove(path);
    memset(name, 'x', TEST_LONGEST_NAME);
    memcpy(name + TEST_LONGEST_NAME - 4, ".png", 5);
    CHECK(pic_png_write(tmio_path(name), rgb, 2, 2) == PIC_OK && remove(tmio_path(name)) == 0);
    CHECK(pic_png_write("picture_test_here.png", rgb, 2, 2) == PIC_OK && remove("picture_test_here.png") == 0);
    CHECK(pic_png_write(tmio_path("no such folder/x.png"), rgb, 2, 2) == PIC_ERR_FILE);
    CHECK(pic_png_write(test_tmp_dir(), rgb, 2, 2) == PIC_ERR_FILE);    /* a folder is there, and nothing is left beside it */
    snprintf(path, sizeof path, "%s.part", test_tmp_dir());
    CHECK(!tmio_exists(path));
    CHECK(pic_png_encode(&data, &size, NULL, 1, 1) == PIC_ERR_ARGUMENT && pic_png_encode(&data, &size, rgb, 0, 1) == PIC_ERR_ARGUMENT);
    CHECK(pic_png_encode(&data, &size, rgb, 1, 0) == PIC_ERR_ARGUMENT && pic_png_encode(&data, &size, rgb, PIC_MAX_SIDE + 1, 1) == PIC_ERR_ARGUMENT);
    CHECK(pic_png_encode(&data, &size, rgb, 1, PIC_MAX_SIDE + 1) == PIC_ERR_ARGUMENT && !data);
}

/* ---- colour ---- */

static double tpic_lightness(const uint8_t rgb[3]) {
    double lin[3];
    int c;
    for (c = 0; c < 3; c++) lin[c] = pow(rgb[c] / 255.0, 2.2);
    return cbrt(0.2126 * lin[0] + 0.7152 * lin[1] + 0.0722 * lin[2]);
}

static void tpic_test_colormaps(void) {
    int map, i;
    for (map = 0; map < PIC_MAP_COUNT; map++) {
        double last = -1, low, high;
        uint8_t rgb[3];
        pic_colormap(0, rgb, map);
        low = tpic_lightness(rgb);
        pic_colormap(map == PIC_MAP_DIVERGING ? 0.5 : 1, rgb, map);
        high = tpic_lightness(rgb);
        CHECK_MSG(high - low > 0.4, "map %d: lightness only from %g to %g", map, low, high);
        for (i = 0; i <= 400; i++) {
            const double s = i / 400.0;
            double l;
            pic_colormap(s, rgb, map);
            l = tpic_lightness(rgb) * (map == PIC_MAP_DIVERGING && s > 0.5 ? -1 : 1);
            if (map == PIC_MAP_DIVERGING && fabs(s - 0.5) < 0.004) last = -2;       /* the turning point */
            CHECK_MSG(l > last - 0.004, "map %d: lightness falls at %g", map, s);
            if (l > last) last = l;     /* against the highest so far: slow falls count too */
        }
    }
    {
        uint8_t a[3], b[3];
        pic_colormap(-3, a, 0); pic_colormap(0, b, 0);
        CHECK(memcmp(a, b, 3) == 0);
        pic_colormap(7, a, 0); pic_colormap(1, b, 0);
        CHECK(memcmp(a, b, 3) == 0);
        pic_colormap((double)NAN, a, 0);
        CHECK(a[0] == a[1] && a[1] == a[2]);
    }
}

/* ---- pictures ---- */

static pic_panel tpic_panel(const shape *s, const double *field) {
    pic_panel p;
    memset(&p, 0, sizeof p);
    p.n = s->n;
    p.xyz = s->xyz;
    p.n_tri = s->n_tri;
    p.tri = s->tri;
    p.field = field;
    return p;
}

static pic_opts tpic_small(int32_t width, int32_t height) {
    pic_opts o;
    memset(&o, 0, sizeof o);
    o.width = width;
    o.height = height;
    o.supersample = 2;
    o.title = "title";
    o.subtitle = "sub";
    o.label = "u";
    return o;
}

/* Draws into an image of the same test, which goes with it; rgb NULL when it fails. */
typedef struct tpic_images { pic_image image[4]; int n; } tpic_images;

static const pic_image *tpic_draw(tpic_images *all, const pic_panel *p, int32_t n, const pic_opts *o, const char *what) {
    pic_image *const img = &all->image[all->n++];
    const int status = n == 1 ? pic_render(img, p, o) : pic_render_grid(img, p, n, o);
    CHECK_MSG(status == PIC_OK && img->rgb, "%s: status %d", what, status);
    return img;
}

static void tpic_free(tpic_images *all) {
    while (all->n > 0) pic_image_free(&all->image[--all->n]);
}

static void tpic_fine(const pic_panel *p, int32_t n, const pic_opts *o, const char *what) {
    tpic_images one = {{{0, 0, NULL, 0}}, 0};
    (void)tpic_draw(&one, p, n, o, what);
    tpic_free(&one);
}

static int tpic_refused(const pic_panel *p, int32_t n, const pic_opts *o) {
    pic_image img;
    return (n == 1 && p ? pic_render(&img, p, o) : pic_render_grid(&img, p, n, o)) == PIC_ERR_ARGUMENT && !img.rgb;
}

static int tpic_equal(const pic_image *a, const pic_image *b) {
    return a->rgb && b->rgb && a->width == b->width && a->height == b->height &&
           memcmp(a->rgb, b->rgb, 3 * (size_t)a->width * (size_t)a->height) == 0;
}

/* How many pixels are clearly coloured: those of the shape and of the bar. */
static int tpic_coloured(const pic_image *img) {
    int count = 0;
    int32_t i;
    for (i = 0; i < img->width * img->height; i++) {
        const uint8_t *p = img->rgb + 3 * i;
        const int hi = p[0] > p[1] ? (p[0] > p[2] ? p[0] : p[2]) : (p[1] > p[2] ? p[1] : p[2]);
        const int lo = p[0] < p[1] ? (p[0] < p[2] ? p[0] : p[2]) : (p[1] < p[2] ? p[1] : p[2]);
        count += hi - lo > 60;
    }
    return count;
}

static void tpic_test_isolines(void) {
    shape s = kit_own_shape(shape_grid(41, 31, 0.2));
    double *f = (double *)malloc((size_t)s.n * sizeof *f);
    pic_opts o = tpic_small(320, 240);
    tpic_images all = {{{0, 0, NULL, 0}}, 0};
    int32_t i, crossed = 0, inside = 0;
    if (CHECK(s.xyz && f)) {
        const pic_panel p = tpic_panel(&s, f);
        const pic_image *plain, *lines;
        for (i = 0; i < s.n; i++) f[i] = s.xyz[3 * i];
        o.view_given = 1;           /* straight at the square, x to the right */
        o.no_legend = 1;
        o.isolines = -1;
        plain = tpic_draw(&all, &p, 1, &o, "no lines");
        o.isolines = 7;
        lines = tpic_draw(&all, &p, 1, &o, "lines");
        for (i = 0; plain->rgb && lines->rgb && i < lines->width; i++) {
            const size_t at = 3 * ((size_t)(lines->height * 11 / 20) * (size_t)lines->width + (size_t)i);
            const uint8_t *a = plain->rgb + at, *b = lines->rgb + at;
            const int darker = a[0] + a[1] + a[2] - b[0] - b[1] - b[2];
            CHECK(darker >= -2);            /* lines only darken */
            crossed += darker > 30 && !inside;
            inside = darker > 30;
        }
        CHECK_MSG(crossed == 7, "%d isolines instead of 7", (int)crossed);
    }
    tpic_free(&all);
    free(f);
}

/* The label whose colour a pixel has, lit in any way, among the first n; -1: none, as it is grey. */
static int tpic_label_of(const uint8_t *p, int n) {
    double best = 0.99;
    int k, c, found = -1;
    for (k = 0; k < n; k++) {
        uint8_t want[3];
        double ab = 0, aa = 0, bb = 0, mean = (p[0] + p[1] + p[2]) / 3.0, middle;
        pic_label_colour(k, want);
        middle = (want[0] + want[1] + want[2]) / 3.0;
        for (c = 0; c < 3; c++) {
            ab += (p[c] - mean) * (want[c] - middle);
            aa += (p[c] - mean) * (p[c] - mean);
            bb += (want[c] - middle) * (want[c] - middle);
        }
        if (aa < 400 || !(ab / sqrt(aa * bb) > best)) continue;
        best = ab / sqrt(aa * bb);
        found = k;
    }
    return found;
}

/* Labels 0 and 3 side by side, and none: between 0 and 3 there is no 1 and no 2. */
static void tpic_test_labels(void) {
    shape s = kit_own_shape(shape_grid(21, 16, 0.2));
    double *f = (double *)malloc((size_t)s.n * sizeof *f);
    pic_opts o = tpic_small(320, 240);
    tpic_images all = {{{0, 0, NULL, 0}}, 0};
    uint8_t a[3], b[3];
    pic_scale sc;
    pic_ticks t;
    int32_t i, k, seen[5] = {0, 0, 0, 0, 0};
    for (i = 0; i < 12; i++) for (k = 0; k < i; k++) {
        pic_label_colour(i, a);
        pic_label_colour(k, b);
        CHECK_MSG(abs(a[0] - b[0]) + abs(a[1] - b[1]) + abs(a[2] - b[2]) > 50, "labels %d and %d look alike", (int)k, (int)i);
    }
    if (CHECK(s.xyz && f)) {
        const pic_panel p = tpic_panel(&s, f);
        const pic_image *plain, *lines;
        for (i = 0; i < s.n; i++) f[i] = s.xyz[3 * i] < 0.3 ? 0 : s.xyz[3 * i] < 0.7 ? 3 : i % 2 ? -1 : 0.5;
        o.view_given = 1;
        o.no_legend = 1;
        o.labels = 4;
        o.isolines = -1;
        plain = tpic_draw(&all, &p, 1, &o, "labels");
        o.isolines = 7;
        lines = tpic_draw(&all, &p, 1, &o, "labels without lines");
        CHECK(tpic_equal(plain, lines));
        for (i = 0; plain->rgb && i < plain->width; i++)
            seen[1 + tpic_label_of(plain->rgb + 3 * ((size_t)(plain->height * 11 / 20) * (size_t)plain->width + (size_t)i), 4)]++;
        CHECK_MSG(seen[1] > 30 && seen[4] > 30 && seen[0] > 30 && seen[2] + seen[3] <= 1, "none %d, 0: %d, 1: %d, 2: %d, 3: %d", (int)seen[0],
                  (int)seen[1], (int)seen[2], (int)seen[3], (int)seen[4]);
        for (o.labels = 1; o.labels <= 3000; o.labels = o.labels * 3 + 5) {
            pic_scale_make(&sc, &p, 0, 1, &o);
            pic_ticks_make(&t, &sc);
            CHECK(t.n > 0 && t.n <= 24 && strcmp(t.text[0], "0") == 0 && (o.labels > 24 || t.n == o.labels));
            tpic_fine(&p, 1, &o, "many labels");
        }
    }
    tpic_free(&all);
    free(f);
}

/* With another axis up a shape is seen as its copy is that is turned. */
static void tpic_test_up(void) {
    shape s = kit_own_shape(shape_bumpy(3, 4)), copy = kit_own_shape(shape_bumpy(3, 4));
    double *f = (double *)malloc((size_t)s.n * sizeof *f);
    pic_opts o = tpic_small(160, 120);
    tpic_images all = {{{0, 0, NULL, 0}}, 0};
    int32_t i;
    int up;
    for (up = PIC_UP_X; CHECK(s.xyz && copy.xyz && f) && up <= PIC_UP_Z; up++) {
        const pic_panel p = tpic_panel(&s, f), turned = tpic_panel(&copy, f);
        for (i = 0; i < s.n; i++) {
            const double *x = s.xyz + 3 * i;
            f[i] = exp(-4 * shape_distance(x, s.xyz));
            copy.xyz[3 * i] = up == PIC_UP_X ? -x[1] : x[0];
            copy.xyz[3 * i + 1] = up == PIC_UP_X ? x[0] : x[2];
            copy.xyz[3 * i + 2] = up == PIC_UP_X ? x[2] : -x[1];
        }
        o.up = up;
        (void)tpic_draw(&all, &p, 1, &o, "up");
        o.up = PIC_UP_Y;
        (void)tpic_draw(&all, &turned, 1, &o, "turned");
        CHECK_MSG(tpic_equal(&all.image[0], &all.image[1]), "axis %d up", up);
        (void)tpic_draw(&all, &p, 1, &o, "not turned");
        CHECK(!tpic_equal(&all.image[0], &all.image[2]));
        tpic_free(&all);
    }
    free(f);
}

/* A panel of another mesh is seen from where it is warm, or with one_view from where the first is: as if it were the same mesh. */
static void tpic_test_one_view(void) {
    shape s = kit_own_shape(shape_bumpy(3, 4)), copy = kit_own_shape(shape_bumpy(3, 4));
    double *f = (double *)malloc(2 * (size_t)s.n * sizeof *f);
    pic_opts o = tpic_small(320, 240);
    tpic_images all = {{{0, 0, NULL, 0}}, 0};
    int32_t i;
    if (CHECK(s.xyz && copy.xyz && f)) {
        pic_panel p[2];
        const pic_image *same, *other, *one;
        for (i = 0; i < s.n; i++) {
            f[i] = exp(-4 * shape_distance(s.xyz + 3 * i, s.xyz));
            f[s.n + i] = exp(-4 * shape_distance(s.xyz + 3 * i, s.xyz + 9));
        }
        p[0] = tpic_panel(&s, f);
        p[1] = tpic_panel(&s, f + s.n);
        same = tpic_draw(&all, p, 2, &o, "one mesh");
        p[1].xyz = copy.xyz;
        other = tpic_draw(&all, p, 2, &o, "two meshes");
        o.one_view = 1;
        one = tpic_draw(&all, p, 2, &o, "two meshes in one view");
        CHECK(!tpic_equal(same, other) && tpic_equal(same, one));
    }
    tpic_free(&all);
    free(f);
}

/* The scale and the ticks for values, a given range and so many decades. */
static void tpic_scale(pic_scale *sc, pic_ticks *t, int n, const double *values, double lo, double hi, double decades) {
    pic_opts o;
    pic_panel p;
    memset(&o, 0, sizeof o);
    memset(&p, 0, sizeof p);
    p.n = n;
    p.field = values;
    o.lo = lo;
    o.hi = hi;
    o.log_decades = decades;
    pic_scale_make(sc, &p, 0, 1, &o);
    pic_ticks_make(t, sc);
}

static void tpic_test_scale(void) {
    static const double v[5] = {-1e-18, 1e-9, 1e-3, 10, (double)NAN}, large[2] = {-1.7e308, 1.7e308}, near1[2] = {1, 1.0000000000000002},
                        same[2] = {4, 4};
    pic_scale sc;
    pic_ticks t;
    double decades;
    int i;
    tpic_scale(&sc, &t, 5, v, 0, 0, 0);
    CHECK(sc.lo == -1e-18 && sc.hi == 10 && !sc.is_log && sc.n_levels >= 7 && sc.n_levels <= 20);
    CHECK(fabs(pic_scale_at(&sc, 5) - 0.5) < 1e-12 && !pic_finite(pic_scale_at(&sc, (double)NAN)));
    tpic_scale(&sc, &t, 5, v, 0, 0, 6);
    CHECK(sc.is_log && fabs(sc.lo - 1e-5) < 1e-12 && pic_scale_at(&sc, -1) < 0 && fabs(pic_scale_at(&sc, 1e-2) - 0.5) < 1e-9);
    for (i = 0; i < t.n; i++) if (t.text[i][0]) CHECK(strncmp(t.text[i], "10^", 3) == 0);
    CHECK(t.n >= 7);
    tpic_scale(&sc, &t, 2, large, 0, 0, 0);
    CHECK(fabs(pic_scale_at(&sc, 0) - 0.5) < 1e-9);
    tpic_scale(&sc, &t, 2, near1, 0, 0, 0);
    tpic_scale(&sc, &t, 2, same, 0, 0, 0);
    CHECK(sc.constant && sc.n_levels == 0 && fabs(pic_scale_at(&sc, 4) - 0.5) < 1e-15);
    tpic_scale(&sc, &t, 2, near1, -1, 10, 6);       /* logarithms begin above zero */
    CHECK(sc.lo > 0 && sc.hi == 10);
    for (i = -300; i <= 300; i += 50) {         /* ticks and levels for ranges of every size */
        const double w[2] = {-pow(10, i), 3 * pow(10, i)};
        tpic_scale(&sc, &t, 2, w, 0, 0, 0);
        CHECK_MSG(t.n >= 4 && t.n <= 12, "10^%d: %d ticks", i, t.n);
        CHECK_MSG(sc.n_levels >= 7 && sc.n_levels <= 20, "10^%d: %d levels", i, (int)sc.n_levels);
    }
    for (decades = 0.25; decades < 300; decades *= 1.5) {       /* from a part of a decade to hundreds */
        const double lo = 1e30 / pow(10, decades);
        tpic_scale(&sc, &t, 2, near1, lo, 1e30, 400);
        CHECK_MSG(sc.is_log && fabs(sc.lo / lo - 1) < 1e-9, "%g decades", decades);
        CHECK_MSG(t.n >= 2 && t.n <= PIC_MAX_TICKS, "%g decades: %d ticks", decades, t.n);
        for (i = 1; i < t.n; i++) CHECK(t.at[i] > t.at[i - 1]);
    }
    for (i = -7; i < 8; i++) {                   /* numbers without factor from 1e-3 to 1e4 */
        tpic_scale(&sc, &t, 2, near1, 0, 3 * pow(10, i), 0);
        CHECK_MSG((t.factor[0] != 0) == (i >= 5 || i <= -4) && t.n >= 4, "10^%d: '%s'", i, t.factor);
    }
    CHECK(fabs(pic_nice_step(10) - 10) < 1e-12 && fabs(pic_nice_step(0.0011) - 0.002) < 1e-15);
}

/* Places, values, sizes and options of every kind: each gives a picture. */
static void tpic_test_degenerate(void) {
    static const double flat[9] = {0, 0, 0, 1, 0, 0, 2, 0, 0}, big[9] = {-1.7e308, 0, 0, 1.7e308, 0, 0, 0, 1.7e308, 1},
                        tiny[9] = {0, 0, 0, 1e-300, 0, 0, 0, 1e-300, 0}, here[9] = {5, 5, 5, 5, 5, 5, 5, 5, 5}, same[3] = {2, 2, 2};
    const double broken[9] = {0, 0, 0, 1, (double)NAN, 0, 0, 1, HUGE_VAL}, values[3] = {(double)NAN, HUGE_VAL, -HUGE_VAL};
    static const int32_t one[3] = {0, 1, 2}, wild[6] = {0, 1, 7, -1, 0, 0}, marks[3] = {0, 99, -4};
    const double *const places[5] = {flat, big, tiny, broken, here}, *const fields[4] = {NULL, values, same, flat};
    pic_opts o = tpic_small(160, 120);
    pic_panel p, five[5];
    int i, k;
    memset(&p, 0, sizeof p);
    tpic_fine(&p, 1, &o, "nothing");
    p.n = 3;
    p.tri = one;
    p.markers = marks;
    p.n_markers = 3;
    for (i = 0; i < 5; i++)
        for (k = 0; k < 16; k++) {
            p.xyz = places[i];
            p.n_tri = k & 1;
            o.log_decades = k & 2 ? 5 : 0;
            p.field = fields[k >> 2];
            tpic_fine(&p, 1, &o, "odd places and values");
        }
    p.xyz = tiny;
    p.n_tri = 2;
    p.tri = wild;
    tpic_fine(&p, 1, &o, "indices out of range");
    for (i = 0; i < 5; i++) {
        five[i] = p;
        five[i].caption = i % 2 ? "caption" : NULL;
    }
    tpic_fine(five, 5, &o, "five panels");
    o.own_scale = 1;
    tpic_fine(five, 5, &o, "five panels, own scales");
    tpic_fine(five, 1, &o, "one panel, own scale");
    five[1].field = NULL;
    tpic_fine(five, 2, &o, "own scales, one without a field");
    for (i = 1; i < 40; i += 3) {       /* too small for anything to fit */
        o.width = i;
        o.height = 1 + i / 2;
        tpic_fine(five, 5, &o, "thumbnail");
    }
    for (i = 1; i < 10; i += 4) {
        o = tpic_small(120, 90);
        o.columns = i;
        tpic_fine(five, 3, &o, "columns");
    }
    o.title = NULL;
    o.label = "";
    o.supersample = 20;
    tpic_fine(five, 1, &o, "a subtitle alone");
    p.n_tri = 1;
    tpic_fine(&p, 1, NULL, "no options");
}

static void tpic_test_refused(void) {
    static const double xyz[9] = {0, 0, 0, 0, 1, 0, 0, 0, 1};
    static const int32_t tri[3] = {0, 1, 2};
    /* n, n_tri, markers; whether there are places and triangles; width, height; panels */
    static const struct { int32_t n, n_tri, n_markers; int xyz, tri; int32_t width, height, panels; } rows[] = {
        {3, 1, 0, 1, 1, 20000, 90, 1}, {3, 1, 0, 1, 1, 120, PIC_MAX_SIDE + 1, 1}, {3, 1, 0, 1, 1, 120, 90, 0}, {3, 1, 0, 0, 1, 120, 90, 1},
        {3, 1, 0, 1, 0, 120, 90, 1}, {-1, 1, 0, 1, 1, 120, 90, 1}, {3, -1, 0, 1, 1, 120, 90, 1}, {3, 1, -1, 1, 1, 120, 90, 1}};
    size_t k;
    for (k = 0; k < sizeof rows / sizeof *rows; k++) {
        const pic_opts o = tpic_small(rows[k].width, rows[k].height);
        pic_panel p;
        memset(&p, 0, sizeof p);
        p.n = rows[k].n;
        p.n_tri = rows[k].n_tri;
        p.n_markers = rows[k].n_markers;
        p.xyz = rows[k].xyz ? xyz : NULL;
        p.tri = rows[k].tri ? tri : NULL;
        CHECK_MSG(tpic_refused(&p, rows[k].panels, &o), "row %d", (int)k);
        CHECK_MSG(k < 3 || tpic_refused(&p, rows[k].panels, NULL), "row %d without options", (int)k);
    }
    CHECK(tpic_refused(NULL, 1, NULL));
}

/* Are two pictures the same? */
static int tpic_same(const pic_panel *a, const pic_opts *oa, const pic_panel *b, const pic_opts *ob) {
    tpic_images all = {{{0, 0, NULL, 0}}, 0};
    const pic_image *const x = tpic_draw(&all, a, 1, oa, "one"), *const y = tpic_draw(&all, b, 1, ob, "other");
    const int same = tpic_equal(x, y);
    tpic_free(&all);
    return same;
}

/* Triangles with a corner twice or with two corners in one place draw nothing; a view that is no number is as none;
 * a factor stands above the ticks of large values; larger discs cover more; only texts with letters are seen. */
static void tpic_test_rare(void) {
    static const double xyz[12] = {0, 0, 0, 1, 0, 0.2, 0, 1, 0, 0, 1, 0}, f[4] = {0, 1, 2, 2}, large[4] = {0, 1e6, 2e6, 2e6};
    static const int32_t tri[15] = {0, 1, 2, 0, 0, 1, 0, 1, 1, 1, 0, 1, 1, 2, 3};
    shape s = kit_own_shape(shape_icosphere(1));
    pic_opts o = tpic_small(120, 90), other;
    pic_panel p, q;
    tpic_images all = {{{0, 0, NULL, 0}}, 0};
    const pic_image *img;
    int i, seen[2] = {0, 0};
    memset(&p, 0, sizeof p);
    p.n = 4;
    p.xyz = xyz;
    p.n_tri = 1;
    p.tri = tri;
    p.field = f;
    q = p;
    q.n_tri = 5;
    o.view_given = 1;
    o.azimuth = 20;
    o.elevation = 50;
    CHECK(tpic_same(&p, &o, &q, &o));
    other = o;
    o.view_given = 0;
    CHECK(!tpic_same(&p, &o, &p, &other));
    other.azimuth = (double)NAN;
    CHECK(tpic_same(&p, &o, &p, &other));
    other.azimuth = 0;
    other.elevation = HUGE_VAL;
    CHECK(tpic_same(&p, &o, &p, &other));
    q = p;
    q.field = large;
    CHECK(!tpic_same(&p, &o, &q, &o));
    img = tpic_draw(&all, &p, 1, &o, "before");
    pic_text(&all.image[0], "nothing", 10, 10, 0, 0, 1, pic_ink);
    pic_text(&all.image[0], NULL, 10, 10, 10, 0, 1, pic_ink);
    CHECK(tpic_equal(img, tpic_draw(&all, &p, 1, &o, "no text")));
    pic_text(&all.image[0], "all", 10, 50, 10, 0, 1, pic_ink);
    CHECK(!tpic_equal(img, &all.image[1]));
    tpic_free(&all);
    q = tpic_panel(&s, s.xyz);
    q.n_tri = 0;
    o.supersample = 1;
    o.title = NULL;
    o.label = "";
    for (i = 0; i < 2; i++) {
        int32_t k;
        o.point_radius = i ? 1e9 : 0.05;
        img = tpic_draw(&all, &q, 1, &o, "discs");
        for (k = 0; img->rgb && k < img->width * img->height; k++) seen[i] += img->rgb[3 * k] < 200;
    }
    CHECK_MSG(seen[1] > 2 * seen[0] && seen[0] > 20, "%d and %d pixels", seen[0], seen[1]);
    tpic_free(&all);
}

/* Letters beyond ASCII, superscripts and subscripts: by the widths of texts. */
static void tpic_test_letters(void) {
    static const char *const dashes[3] = {"\xe2\x80\x93", "\xe2\x80\x94", "\xe2\x88\x92"}, *const signs[2] = {"\xc3\x97", "\xc2\xb7"};
    static const char *const unknown[6] = {"\xc3\xa9", "\xc2\xa0", "\xe2\x80\x9c", "\xe2\x88\x91", "\xe2\x82\xac", "\xf0\x9d\x84\x9e"};
    static const char *const plain[13] = {"x^", "x^y", "x^-", "x_", "heat_on", "on_t", "k_t_", "x^:", "_x", "a_:", "a_[", "a_{", "@_a"};
    static const char *const small[8][2] = {{"10^-3", "10-3"}, {"h^2", "h2"}, {"k_t", "kt"}, {"a k_T 0", "a kT 0"}, {"h^2:", "h2:"},
                                            {"a_1:", "a1:"}, {"a_t[", "at["}, {"{a_t", "{at"}};
    const double box = pic_text_width("\xff", 10);
    int i;
    for (i = 0; i < 3; i++) CHECK(pic_text_width(dashes[i], 10) == pic_text_width(dashes[0], 10) && pic_text_width(dashes[i], 10) != box);
    for (i = 0; i < 2; i++) CHECK(pic_text_width(signs[i], 10) > 0);
    CHECK(pic_text_width(signs[1], 10) != box);
    for (i = 0; i < 6; i++) CHECK_MSG(pic_text_width(unknown[i], 10) == box, "letter %d", i);
    CHECK(pic_text_width("\t\x7f", 10) == pic_text_width("  ", 10));
    for (i = 0; i < 8; i++) CHECK_MSG(pic_text_width(small[i][0], 10) < pic_text_width(small[i][1], 10), "%s", small[i][0]);
    for (i = 0; i < 13; i++) {                    /* every sign is drawn: as wide as its letters one by one */
        double sum = 0;
        const char *c;
        for (c = plain[i]; *c; c++) {
            const char one[2] = {*c, 0};
            sum += pic_text_width(one, 10);
        }
        CHECK_MSG(fabs(pic_text_width(plain[i], 10) - sum) < 1e-9, "%s", plain[i]);
    }
}

/* A sphere fills about as much of the picture as it should, as faces and as points, whichever way its faces are turned. */
static void tpic_test_picture_of_sphere(void) {
    shape s = kit_own_shape(shape_icosphere(3));
    double *f = (double *)malloc((size_t)s.n * sizeof *f);
    pic_opts o = tpic_small(320, 240);
    tpic_images all = {{{0, 0, NULL, 0}}, 0};
    uint64_t seed = 3;
    int32_t i;
    if (CHECK(s.xyz && f)) {
        pic_panel p = tpic_panel(&s, f);
        const pic_image *faces, *points, *turned;
        for (i = 0; i < s.n; i++) f[i] = s.xyz[3 * i];
        o.title = o.subtitle = NULL;
        o.isolines = -1;
        faces = tpic_draw(&all, &p, 1, &o, "faces");
        p.n_tri = 0;
        points = tpic_draw(&all, &p, 1, &o, "points");
        p.n_tri = s.n_tri;
        for (i = 0; i < s.n_tri; i++)
            if (shape_random(&seed) & 1u) {
                const int32_t swap = s.tri[3 * i];
                s.tri[3 * i] = s.tri[3 * i + 1];
                s.tri[3 * i + 1] = swap;
            }
        turned = tpic_draw(&all, &p, 1, &o, "turned");
        if (faces->rgb && points->rgb && turned->rgb) {
            const double disc = 3.14159 / 4 * pow(0.86 * 0.95 * 240, 2), seen = tpic_coloured(faces), seen_points = tpic_coloured(points);
            int64_t differ = 0;
            for (i = 0; i < 3 * faces->width * faces->height; i++) differ += abs(faces->rgb[i] - turned->rgb[i]) > 3;
            CHECK_MSG(seen > 0.7 * disc && seen < 1.3 * disc, "sphere: %g coloured pixels, disc %g", seen, disc);
            CHECK_MSG(seen_points > 0.7 * seen && seen_points < 1.3 * seen, "points: %g coloured pixels, faces %g", seen_points, seen);
            CHECK_MSG(differ < faces->width, "orientation of faces shows in %d bytes", (int)differ);
            tpic_check_png(faces->rgb, faces->width, faces->height, "a picture");
        }
    }
    tpic_free(&all);
    free(f);
}

/* ---- shapes ---- */

typedef struct tpic_edge { int32_t a, b, way; } tpic_edge;

static int tpic_compare_edges(const void *pa, const void *pb) {
    const tpic_edge *x = (const tpic_edge *)pa, *y = (const tpic_edge *)pb;
    if (x->a != y->a) return x->a < y->a ? -1 : 1;
    if (x->b != y->b) return x->b < y->b ? -1 : 1;
    return x->way - y->way;
}

static int32_t tpic_root(int32_t *parent, int32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
}

/* Checks that s is manifold and consistently oriented, with so many border edges, pieces and that Euler characteristic, no
 * vertex unused, and volume at least `volume`. */
static void tpic_check_shape(const shape *s, const char *what, int euler, int border, int pieces, double volume) {
    tpic_edge *e = (tpic_edge *)malloc((size_t)s->n_tri * 3 * sizeof *e);
    int32_t *parent = (int32_t *)malloc((size_t)s->n * sizeof *parent), *faces = (int32_t *)calloc((size_t)s->n, sizeof *faces);
    int32_t i, n_edges = 0, n_border = 0, n_pieces = 0, wrong = 0, unused = 0;
    double sum = 0;
    int c;
    CHECK_MSG(s->xyz && e && parent && faces, "%s: no memory", what);
    if (!s->xyz || !e || !parent || !faces) { free(e); free(parent); free(faces); return; }
    for (i = 0; i < s->n; i++) parent[i] = i;
    for (i = 0; i < s->n_tri; i++) {
        const int32_t *t = s->tri + 3 * i;
        double n[3];
        for (c = 0; c < 3; c++) {
            const int32_t a = t[c], b = t[(c + 1) % 3];
            e[3 * i + c].a = a < b ? a : b; e[3 * i + c].b = a < b ? b : a; e[3 * i + c].way = a < b;
            parent[tpic_root(parent, a)] = tpic_root(parent, b);
            faces[a]++;
            wrong += a == b;
        }
        shape_normal(s->xyz + 3 * t[0], s->xyz + 3 * t[1], s->xyz + 3 * t[2], n);
        sum += shape_dot(n, s->xyz + 3 * t[0]) / 6;
    }
    qsort(e, (size_t)s->n_tri * 3, sizeof *e, tpic_compare_edges);
    for (i = 0; i < 3 * s->n_tri; n_edges++) {
        int32_t same = 1;
        while (i + same < 3 * s->n_tri && e[i + same].a == e[i].a && e[i + same].b == e[i].b) same++;
        n_border += same == 1;
        wrong += same > 2 || (same == 2 && e[i].way == e[i + 1].way);
        i += same;
    }
    for (i = 0; i < s->n; i++) { n_pieces += tpic_root(parent, i) == i; unused += faces[i] == 0; }
    CHECK_MSG(wrong == 0, "%s: %d edges not manifold or not consistent", what, (int)wrong);
    CHECK_MSG(unused == 0, "%s: %d vertices unused", what, (int)unused);
    CHECK_MSG(n_border == border, "%s: %d border edges, not %d", what, (int)n_border, border);
    CHECK_MSG(n_pieces == pieces, "%s: %d pieces, not %d", what, (int)n_pieces, pieces);
    n_edges = s->n - n_edges + s->n_tri;
    CHECK_MSG(n_edges == euler, "%s: Euler characteristic %d, not %d", what, (int)n_edges, euler);
    CHECK_MSG(border > 0 || sum > volume, "%s: volume %g, not above %g", what, sum, volume);
    free(e);
    free(parent);
    free(faces);
}

static void tpic_test_simple_shapes(void) {
    static const double offset[3] = {5, 0, 0};
    shape all[8], none[5];
    static const struct { const char *name; int euler, border, pieces; double volume; } rows[] = {
        {"icosahedron", 2, 0, 1, 2.5}, {"icosphere", 2, 0, 1, 4.1}, {"two balls", 4, 0, 2, 6.6}, {"torus", 0, 0, 1, 2.9}, {"bumpy", 2, 0, 1, 2},
        {"bumpy again", 2, 0, 1, 2}, {"grid", 1, 2 * 8 + 2 * 5, 1, 0}, {"cylinder", 0, 24, 1, 0}};
    size_t k;
    all[0] = shape_icosphere(0);
    all[1] = shape_icosphere(4);
    all[2] = shape_disjoint(&all[0], &all[1], offset);
    all[3] = shape_torus(40, 20, 1, 0.4);
    all[4] = shape_bumpy(4, 11);
    all[5] = shape_bumpy(4, 11);
    all[6] = shape_grid(9, 6, 0.4);
    all[7] = shape_cylinder(12, 5, 1, 2);
    none[0] = shape_torus(2, 5, 1, 0.4);
    none[1] = shape_grid(1, 5, 0);
    none[2] = shape_icosphere(-1);
    none[3] = shape_icosphere(11);
    none[4] = shape_cylinder(3, 1, 1, 1);
    for (k = 0; k < sizeof none / sizeof *none; k++) CHECK_MSG(!none[k].xyz && none[k].n == 0, "shape %d", (int)k);
    CHECK(all[0].n == 12 && all[0].n_tri == 20 && all[1].n == 2562 && all[1].n_tri == 5120);
    CHECK(all[4].n == all[5].n && all[4].xyz && all[5].xyz && memcmp(all[4].xyz, all[5].xyz, (size_t)all[4].n * 24) == 0);
    for (k = 0; k < sizeof rows / sizeof *rows; k++) {
        tpic_check_shape(&all[k], rows[k].name, rows[k].euler, rows[k].border, rows[k].pieces, rows[k].volume);
        shape_free(&all[k]);
    }
}

/* All triangles of a grid look up, also the jittered ones; the random generator gives its published first number. */
static void tpic_test_grid_upright(void) {
    shape s = kit_own_shape(shape_grid(30, 20, 0.3));
    uint64_t seed = 0;
    int32_t i, bad = 0;
    for (i = 0; i < s.n_tri; i++) {
        double n[3];
        shape_normal(s.xyz + 3 * s.tri[3 * i], s.xyz + 3 * s.tri[3 * i + 1], s.xyz + 3 * s.tri[3 * i + 2], n);
        bad += !(n[2] > 0);
    }
    CHECK(s.n == 600 && bad == 0);
    CHECK(shape_random(&seed) == 0xe220a8397b1dcdafu);
}

static void tpic_test_demo(void) {
    static const int32_t sizes[3] = {2000, 0, 36000};
    int k, c;
    for (k = 0; k < 3; k++) {
        shape s = kit_own_shape(shape_demo(sizes[k]));
        const double wanted = sizes[k] ? sizes[k] : 12000;
        int32_t i, slim = 0, odd = 0, *valence = (int32_t *)calloc((size_t)s.n + 1, sizeof *valence);
        tpic_check_shape(&s, "demo", -2, 0, 1, 1.7);
        CHECK_MSG(s.n > 0.85 * wanted && s.n < 1.15 * wanted, "demo: %d vertices for %g", (int)s.n, wanted);
        for (i = 0; i < s.n_tri; i++) for (c = 0; c < 3; c++) {
            const int32_t *t = s.tri + 3 * i;
            const double angle = shape_cosine(s.xyz + 3 * t[c], s.xyz + 3 * t[(c + 1) % 3], s.xyz + 3 * t[(c + 2) % 3]);
            slim += angle > cos(15 * 0.0174533);
            if (valence) valence[t[c]]++;
        }
        for (i = 0; valence && i < s.n; i++) odd += valence[i] != 6;
        CHECK_MSG(slim <= s.n_tri / 2000, "demo: %d angles below 15 degrees", (int)slim);
        CHECK_MSG(odd > s.n / 20, "demo: only %d irregular vertices", (int)odd);
        free(valence);
    }
}

static void test_picture(void) {
    tpic_test_png_pixels();
    tpic_test_huffman();
    tpic_test_png_file();
    tpic_test_colormaps();
    tpic_test_scale();
    tpic_test_isolines();
    tpic_test_one_view();
    tpic_test_labels();
    tpic_test_up();
    tpic_test_degenerate();
    tpic_test_refused();
    tpic_test_rare();
    tpic_test_letters();
    tpic_test_picture_of_sphere();
    tpic_test_simple_shapes();
    tpic_test_grid_upright();
    tpic_test_demo();
}

#endif
