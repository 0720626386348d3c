/* SPDX-License-Identifier: MIT */
/*
 * glsl_limits NAME.frag...: uniform vectors, varying vectors and samplers of every text (and of NAME.vert beside it)
 * against what ES 2.0 guarantees, packed as GLSL ES 1.00 appendix A.7 says. Every declaration counts, used or not.
 * Programs of several lights (NAME has _l2 .. _l8) may need more fragment uniform vectors: the runtime takes them only
 * where the device has those. Exit code 0, 1 when a limit is exceeded, 2 when a text can't be read or understood.
 */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VERTEX_UNIFORMS = 128, FRAGMENT_UNIFORMS = 16, VARYINGS = 8, SAMPLERS = 8, ATTRIBUTES = 8, ROWS = 256 };

typedef struct macro {
    char name[64], value[256];
} macro;

typedef struct variable {
    int rows, columns, count; /* of one element; array elements */
} variable;

typedef struct text { /* one stage */
    const char *path;
    macro macros[128];
    int macro_count;
    variable uniforms[64], varyings[16];
    int uniform_count, varying_count, samplers, attributes;
} text;

static void stop(const text *t, const char *what, const char *where)
{
    fprintf(stderr, "%s: %s: %.60s\n", t->path, what, where);
    exit(2);
}

static const char *value_of(const text *t, const char *name, size_t length)
{
    for (int i = t->macro_count - 1; i >= 0; i--)
        if (strlen(t->macros[i].name) == length && !memcmp(t->macros[i].name, name, length)) return t->macros[i].value;
    return NULL;
}

/* ---- integer expressions of #if and of array sizes --------------------------------------------- */

typedef struct cursor {
    text *t;
    const char *at;
} cursor;

static long expression(cursor *c, int level);

static void skip(cursor *c)
{
    while (*c->at == ' ' || *c->at == '\t') c->at++;
}

static int accept(cursor *c, const char *token)
{
    skip(c);
    if (strncmp(c->at, token, strlen(token))) return 0;
    c->at += strlen(token);
    return 1;
}

static int is_word(char c)
{
    return isalnum((unsigned char)c) || c == '_';
}

static long word(cursor *c)
{
    const char *start = c->at;
    while (is_word(*c->at)) c->at++;
    const size_t length = (size_t)(c->at - start);
    if (length == 7 && !memcmp(start, "defined", 7)) {
        const int bracket = accept(c, "(");
        skip(c);
        start = c->at;
        while (is_word(*c->at)) c->at++;
        const long known = value_of(c->t, start, (size_t)(c->at - start)) != NULL;
        if (bracket) accept(c, ")");
        return known;
    }
    const char *value = value_of(c->t, start, length);
    if (!value) stop(c->t, "not a defined number", start); /* strict: ES 1.00 makes an undefined name an error */
    cursor inner = {c->t, value};
    return expression(&inner, 0);
}

static long primary(cursor *c)
{
    if (accept(c, "!")) return !primary(c);
    if (accept(c, "-")) return -primary(c);
    if (accept(c, "(")) {
        const long value = expression(c, 0);
        if (!accept(c, ")")) stop(c->t, "expected )", c->at);
        return value;
    }
    skip(c);
    if (isdigit((unsigned char)*c->at)) return strtol(c->at, (char **)&c->at, 0);
    if (!is_word(*c->at)) stop(c->t, "can't read expression", c->at);
    return word(c);
}

static long expression(cursor *c, int level)
{
    static const char *const operators[6][4] = {{"||"},     {"&&"},    {"==", "!="}, {"<=", ">=", "<", ">"},
                                                {"+", "-"}, {"*", "/"}};
    if (level == 6) return primary(c);
    long left = expression(c, level + 1);
    for (;;) {
        int i = 0;
        while (i < 4 && operators[level][i] && !accept(c, operators[level][i])) i++;
        if (i == 4 || !operators[level][i]) return left;
        const long right = expression(c, level + 1);
        switch (operators[level][i][0]) {
        case '|':
            left = left || right;
            break;
        case '&':
            left = left && right;
            break;
        case '=':
            left = left == right;
            break;
        case '!':
            left = left != right;
            break;
        case '<':
            left = operators[level][i][1] ? left <= right : left < right;
            break;
        case '>':
            left = operators[level][i][1] ? left >= right : left > right;
            break;
        case '+':
            left += right;
            break;
        case '-':
            left -= right;
            break;
        case '*':
            left *= right;
            break;
        default:
            if (!right) stop(c->t, "division by zero", c->at);
            left /= right;
        }
    }
}

/* ---- declarations -------------------------------------------------------------------------------- */

static const struct type {
    const char *name;
    int rows, columns;
} types[] = {{"mat4", 4, 4}, {"mat3", 3, 3},  {"mat2", 2, 4}, {"vec4", 1, 4}, {"vec3", 1, 3},
             {"vec2", 1, 2}, {"float", 1, 1}, {"int", 1, 1},  {"bool", 1, 1}, {NULL, 0, 0}};

static void next_word(cursor *c, char *out, size_t size)
{
    size_t n = 0;
    skip(c);
    while (is_word(*c->at) && n + 1 < size) out[n++] = *c->at++;
    out[n] = 0;
    /* a name that stands for another one (HIGHP, varying, ...) */
    const char *value = value_of(c->t, out, n);
    if (value && *value && !isdigit((unsigned char)*value)) snprintf(out, size, "%s", value);
}

/* A precision qualifier, or the shaders' macro for one. */
static int is_precision(const char *word)
{
    static const char *const names[] = {"highp", "mediump", "lowp", "HIGHP", "UNIT"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(word, names[i])) return 1;
    return 0;
}

static void declaration(text *t, const char *line, int vertex)
{
    cursor c = {t, line};
    char kind[64], type[64], name[64];
    next_word(&c, kind, sizeof kind);
    const int uniform = !strcmp(kind, "uniform"), in = !strcmp(kind, "in"), out = !strcmp(kind, "out");
    const int attribute = !strcmp(kind, "attribute") || (vertex && in);
    const int varying = !strcmp(kind, "varying") || (!vertex && in) || (vertex && out);
    if (!uniform && !attribute && !varying) return;
    next_word(&c, type, sizeof type);
    if (is_precision(type)) next_word(&c, type, sizeof type);
    next_word(&c, name, sizeof name);
    long count = 1;
    if (accept(&c, "[")) {
        count = expression(&c, 0);
        if (count < 1 || !accept(&c, "]")) stop(t, "array size", line);
    }
    if (!accept(&c, ";")) stop(t, "expected one declaration a line", line);
    if (!strncmp(type, "sampler", 7)) {
        t->samplers += (int)count;
        return;
    }
    const struct type *k = types;
    while (k->name && strcmp(k->name, type)) k++;
    if (!k->name) stop(t, "unknown type", line);
    if (attribute) {
        t->attributes += k->rows * (int)count;
        return;
    }
    if (uniform ? t->uniform_count == 64 : t->varying_count == 16) stop(t, "too many declarations", line);
    variable *v = uniform ? &t->uniforms[t->uniform_count++] : &t->varyings[t->varying_count++];
    v->rows = k->rows;
    v->columns = k->columns;
    v->count = (int)count;
}

/* ---- lines: conditions, definitions, declarations ------------------------------------------------ */

typedef struct state {
    int depth, live[32], taken[32]; /* live[d]: lines count; taken[d]: a branch of this #if has been */
} state;

static void define(text *t, const char *rest)
{
    cursor c = {t, rest};
    macro *m = &t->macros[t->macro_count];
    if (t->macro_count == 128) stop(t, "too many macros", rest);
    skip(&c);
    size_t n = 0;
    while (is_word(*c.at) && n + 1 < sizeof m->name) m->name[n++] = *c.at++;
    m->name[n] = 0;
    if (*c.at == '(') return; /* with arguments: never part of a declaration here */
    skip(&c);
    n = strcspn(c.at, "\r\n");
    const char *comment = strstr(c.at, "//");
    if (comment && (size_t)(comment - c.at) < n) n = (size_t)(comment - c.at);
    while (n && c.at[n - 1] == ' ') n--;
    snprintf(m->value, sizeof m->value, "%.*s", (int)n, c.at);
    t->macro_count++;
}

static int condition(text *t, const char *rest)
{
    char line[512];
    snprintf(line, sizeof line, "%.*s", (int)strcspn(rest, "\r\n"), rest);
    char *comment = strstr(line, "//");
    if (comment) *comment = 0;
    cursor c = {t, line};
    const int value = expression(&c, 0) != 0;
    skip(&c);
    if (*c.at) stop(t, "can't read condition", line);
    return value;
}

static void directive(text *t, state *s, const char *line)
{
    cursor c = {t, line + 1};
    char kind[32];
    size_t n = 0;
    skip(&c);
    while (is_word(*c.at) && n + 1 < sizeof kind) kind[n++] = *c.at++;
    kind[n] = 0;
    skip(&c);
    const int live = s->live[s->depth];
    if (!strncmp(kind, "if", 2)) {
        int value = 0;
        n = 0;
        while (is_word(c.at[n])) n++;
        if (live && !strcmp(kind, "if"))
            value = condition(t, c.at);
        else if (live)
            value = (value_of(t, c.at, n) != NULL) == !strcmp(kind, "ifdef");
        if (++s->depth == 32) stop(t, "nested too deeply", line);
        s->live[s->depth] = live && value;
        s->taken[s->depth] = !live || value;
    } else if (!strcmp(kind, "elif") || !strcmp(kind, "else")) {
        if (!s->depth) stop(t, "without #if", line);
        s->live[s->depth] = !s->taken[s->depth] && (kind[2] == 's' || condition(t, c.at));
        s->taken[s->depth] |= s->live[s->depth];
    } else if (!strcmp(kind, "endif")) {
        if (!s->depth--) stop(t, "without #if", line);
    } else if (live && !strcmp(kind, "define")) {
        define(t, c.at);
    } else if (live && strcmp(kind, "version") && strcmp(kind, "extension") && strcmp(kind, "undef")) {
        stop(t, "unknown directive", line);
    }
}

static void read_text(text *t, const char *path, int vertex)
{
    char line[1024];
    state s = {0, {1}, {1}};
    memset(t, 0, sizeof *t);
    t->path = path;
    FILE *file = fopen(path, "r");
    if (!file) stop(t, "can't open", "");
    define(t, "GL_FRAGMENT_PRECISION_HIGH 1");
    while (fgets(line, sizeof line, file)) {
        const char *start = line + strspn(line, " \t");
        if (*start == '#')
            directive(t, &s, start);
        else if (s.live[s.depth])
            declaration(t, start, vertex);
    }
    fclose(file);
    if (s.depth) stop(t, "#if without #endif", "");
}

/* ---- packing, appendix A.7 ------------------------------------------------------------------------ */

typedef struct grid {
    unsigned char used[ROWS][4];
} grid;

static int fits(const grid *g, int row, int column, int rows, int columns)
{
    for (int r = row; r < row + rows; r++)
        for (int c = column; c < column + columns; c++)
            if (r >= ROWS || g->used[r][c]) return 0;
    return 1;
}

static int place(grid *g, const variable *v)
{
    const int rows = v->rows * v->count, step = v->columns == 1 ? 1 : 2;
    for (int column = 0; column + v->columns <= 4; column += step) /* 3 and 4 columns: only from the first */
        for (int row = 0; row + rows <= ROWS; row++)
            if (fits(g, row, column, rows, v->columns)) {
                for (int r = row; r < row + rows; r++) memset(&g->used[r][column], 1, (size_t)v->columns);
                return row + rows;
            }
    return ROWS + 1;
}

/* Rows in use after packing: wide variables first, among equals long arrays first. Two columns look for a place beside
   others only when their own columns are full; here rows are plenty, so squeeze them beside what is there. */
static int vectors(const variable *v, int count)
{
    grid g = {{{0}}};
    int most = 0, done[64] = {0};
    for (int n = 0; n < count; n++) {
        int best = -1;
        for (int i = 0; i < count; i++) {
            if (done[i]) continue;
            if (best < 0 || v[i].columns > v[best].columns ||
                (v[i].columns == v[best].columns && v[i].rows * v[i].count > v[best].rows * v[best].count))
                best = i;
        }
        if (best < 0) break;
        done[best] = 1;
        const int end = place(&g, &v[best]);
        if (end > most) most = end;
    }
    return most;
}

/* ---- programs ------------------------------------------------------------------------------------- */

static int exceeds(const char *path, const char *what, int found, int limit)
{
    if (found <= limit) return 0;
    fprintf(stderr, "%s: %d %s, ES 2.0 guarantees %d\n", path, found, what, limit);
    return 1;
}

static int lights_of(const char *path)
{
    const char *at = strstr(strrchr(path, '/') ? strrchr(path, '/') : path, "_l");
    return at && isdigit((unsigned char)at[2]) ? at[2] - '0' : 0;
}

int main(int argc, char **argv)
{
    static text vertex, fragment;
    char path[4096];
    int bad = 0, above = 0, most = 0;
    for (int i = 1; i < argc; i++) {
        const size_t length = strlen(argv[i]);
        if (length < 6 || length >= sizeof path || strcmp(argv[i] + length - 5, ".frag")) {
            fprintf(stderr, "usage: glsl_limits NAME.frag...\n");
            return 2;
        }
        snprintf(path, sizeof path, "%.*s.vert", (int)length - 5, argv[i]);
        read_text(&fragment, argv[i], 0);
        read_text(&vertex, path, 1);
        const int found = vectors(fragment.uniforms, fragment.uniform_count);
        bad |= exceeds(path, "uniform vectors", vectors(vertex.uniforms, vertex.uniform_count), VERTEX_UNIFORMS);
        bad |= exceeds(path, "attributes", vertex.attributes, ATTRIBUTES);
        bad |= exceeds(path, "varying vectors", vectors(vertex.varyings, vertex.varying_count), VARYINGS);
        bad |= exceeds(argv[i], "varying vectors", vectors(fragment.varyings, fragment.varying_count), VARYINGS);
        bad |= exceeds(argv[i], "samplers", fragment.samplers + vertex.samplers, SAMPLERS);
        if (lights_of(argv[i]) < 2) bad |= exceeds(argv[i], "uniform vectors", found, FRAGMENT_UNIFORMS);
        above += found > FRAGMENT_UNIFORMS;
        if (found > most) most = found;
    }
    printf("%d programs within ES 2.0's limits, but %d of several lights that need up to %d fragment uniform vectors\n",
           argc - 1, above, most);
    return bad;
}
