/* Attach a solver written in C, C++ or Fortran to stickslip, the debugger for contact iterations. POSIX, C99 or C++.
 *
 * The solver keeps its loops. It describes the scene once, reports each contact in its innermost loop, and calls ss_pause there:
 *
 *     ss_begin("Block on a slope", "my solver", "1.0");
 *     for (each increment) for (each iteration) {
 *         for (each contact c) mode[c] = ss_mode(c, mode[c]);         // the user may force another mode
 *         ... solve, and choose the next modes ...
 *         for (each contact c) ss_contact_result(c, was[c], mode[c], gap, f_n, f_t, limit, slip);
 *         ss_pause("iteration", load, residual, tolerance);
 *     }
 *     ss_end();
 *
 * `stickslip attach -- ./solver` then steps it. In one source file, define SS_IMPLEMENTATION before this header is included; for
 * Fortran, compile it alone: cc -x c -DSS_IMPLEMENTATION -c stickslip_attach.h -o stickslip_attach.o
 *
 * Going back: each state that the debugger saves is a copy of the process (fork), so that the solver needs no code for it. This
 * requires one process without threads, MPI or files that it writes during the run; otherwise define SS_NO_FORK, and the debugger
 * replays from the start. At most SS_STATES states are kept.
 *
 * Standard output is the protocol's: what the solver prints there goes to standard error. Numbers that are unknown are NAN.
 * Part of stickslip, MIT or Apache-2.0.
 */
#ifndef STICKSLIP_ATTACH_H
#define STICKSLIP_ATTACH_H
#if defined SS_IMPLEMENTATION && !defined _DEFAULT_SOURCE
#define _DEFAULT_SOURCE /* fork and MAP_ANONYMOUS, also with -std=c99 */
#endif
#include <math.h>
#ifdef __cplusplus
extern "C" {
#endif

/* Modes of a contact. */
enum { SS_FREE = 0, SS_SLIDING = 1, SS_FIXED = 2 };

/* The scene, before ss_begin. Nodes and contacts are numbered from 0; a surface is a chain of nodes with the outward side on the
   right of the walk, and `rigid` is 1 if it does not move. */
int ss_node(double x, double y);
void ss_line(int from, int to);
void ss_surface(const char *name, const int *nodes, int count, int rigid);
int ss_contact(int node, const char *surface, double mu, double cohesion, int mode);

/* Connects to the debugger; returns when it asks for the first iteration. */
void ss_begin(const char *title, const char *name, const char *version);

/* The mode that a contact takes in the next solve: `chosen`, or what the user forces. */
int ss_mode(int contact, int chosen);

/* The result of this iteration: mode of this solve and of the next one, gap (negative is penetration), normal force (compression
   positive) and tangential force on the slave node, T_max with the sign of the friction force, slip. */
void ss_contact_result(int contact, int mode, int next, double gap, double f_n, double f_t, double limit, double slip);
void ss_displacement(int node, double x, double y);

/* The same in space, for all nodes, surfaces and contacts. The faces of a surface have equally many corners, listed face by face. Friction
   and slip have components along t and n x t; `limit` is the radius of the friction cone. Without ss_frame n is z and t is x. */
int ss_node_3d(double x, double y, double z);
void ss_surface_3d(const char *name, const int *corners, int faces, int corners_per_face, int rigid);
void ss_frame(int contact, const double *normal, const double *tangent);
void ss_contact_result_3d(int contact, int mode, int next, double gap, double f_n, const double *f_t, double limit, const double *slip);
void ss_displacement_3d(int node, double x, double y, double z);

/* Reports the iteration, and returns when the debugger asks for the next one. `ended` is the level that ended with it: "iteration",
   "equilibrium" (a major iteration), "increment", "cut", "failure" or "done"; `residual` is relative. */
void ss_pause(const char *ended, double load, double residual, double tolerance);

/* Answers until the debugger leaves. */
void ss_end(void);

#ifdef __cplusplus
}
#endif
#endif

#ifdef SS_IMPLEMENTATION
#undef SS_IMPLEMENTATION
#include <fcntl.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#ifndef SS_STATES
#define SS_STATES 200
#endif
#define SS_LOOK 100 /* milliseconds between two looks of a saved state at the others */
#define SS_LEFT 90  /* exit status of a copy that left the run to another one */

static const char *const ss_modes[] = {"free", "sliding", "fixed"};

struct ss_text { char *letters; size_t length, room; };

struct ss_found { int mode, next; double gap, f_n, f_t[2], limit, slip[2], frame[6]; int has_frame; };

static struct {
    int in, out, nodes, contacts, in_space;
    int over;                     /* 1: done, 2: after ss_end */
    struct ss_text node_list, line_list, surface_list, contact_list, scene, hello, state;
    struct ss_found *found;
    int *held, *once;             /* -1: the solver's own choice */
    char *is_once;                /* whether the mode of this solve was forced once */
    double (*moved)[3];
    int increment, attempt, major, minor;
    int *saved;                   /* number of saved states, shared by all copies */
    int wake[SS_STATES][2];       /* a pipe for each saved state, opened before the first so that all copies know all of them */
} ss;

static void ss_add(struct ss_text *text, const char *format, ...) {
    va_list values;
    size_t length;
    va_start(values, format);
    length = (size_t)vsnprintf(NULL, 0, format, values);
    va_end(values);
    if (text->length + length + 1 > text->room) {
        text->room = 2 * (text->length + length + 1);
        text->letters = (char *)realloc(text->letters, text->room);
        if (!text->letters) { fputs("stickslip_attach: out of memory\n", stderr); _exit(1); }
    }
    va_start(values, format);
    vsnprintf(text->letters + text->length, length + 1, format, values);
    va_end(values);
    text->length += length;
}

static void ss_number(struct ss_text *text, const char *key, double value) {
    if (isfinite(value)) ss_add(text, ",\"%s\":%.17g", key, value);
    else ss_add(text, ",\"%s\":null", key);
}

/* The first `count` numbers of a list. */
static void ss_numbers(struct ss_text *text, const double *values, int count) {
    int k;
    for (k = 0; k < count; k++) ss_add(text, "%s%.17g", k ? "," : "[", values[k]);
    ss_add(text, "]");
}

/* A number in the plane, a pair in space. */
static void ss_tangential(struct ss_text *text, const char *key, const double *values) {
    if (!ss.in_space) { ss_number(text, key, values[0]); return; }
    ss_add(text, ",\"%s\":", key);
    if (isfinite(values[0]) && isfinite(values[1])) ss_numbers(text, values, 2);
    else ss_add(text, "null");
}

/* Text in quotes. */
static void ss_quoted(struct ss_text *text, const char *words) {
    ss_add(text, "\"");
    for (; *words; words++) {
        if (*words == '"' || *words == '\\') ss_add(text, "\\%c", *words);
        else if ((unsigned char)*words < 32) ss_add(text, "\\u%04x", *words);
        else ss_add(text, "%c", *words);
    }
    ss_add(text, "\"");
}

static void *ss_grown(void *list, int count, size_t size) {
    void *grown = realloc(list, (size_t)(count + 1) * size);
    if (!grown) { fputs("stickslip_attach: out of memory\n", stderr); _exit(1); }
    memset((char *)grown + (size_t)count * size, 0, size);
    return grown;
}

int ss_node_3d(double x, double y, double z) {
    const double at[3] = {x, y, z};
    ss.in_space = 1;
    ss.moved = (double(*)[3])ss_grown(ss.moved, ss.nodes, sizeof *ss.moved);
    ss_add(&ss.node_list, "%s{\"at\":", ss.nodes ? "," : "");
    ss_numbers(&ss.node_list, at, 3);
    ss_add(&ss.node_list, "}");
    return ss.nodes++;
}

int ss_node(double x, double y) {
    ss.moved = (double(*)[3])ss_grown(ss.moved, ss.nodes, sizeof *ss.moved);
    ss_add(&ss.node_list, "%s{\"at\":[%.17g,%.17g]}", ss.nodes ? "," : "", x, y);
    return ss.nodes++;
}

void ss_line(int from, int to) { ss_add(&ss.line_list, "%s[%d,%d]", ss.line_list.length ? "," : "", from, to); }

static void ss_indices(const int *nodes, int count) {
    int k;
    ss_add(&ss.surface_list, "[");
    for (k = 0; k < count; k++) ss_add(&ss.surface_list, "%s%d", k ? "," : "", nodes[k]);
    ss_add(&ss.surface_list, "]");
}

static void ss_surface_head(const char *name, int rigid) {
    ss_add(&ss.surface_list, "%s{\"name\":", ss.surface_list.length ? "," : "");
    ss_quoted(&ss.surface_list, name);
    ss_add(&ss.surface_list, ",\"rigid\":%s,", rigid ? "true" : "false");
}

void ss_surface(const char *name, const int *nodes, int count, int rigid) {
    ss_surface_head(name, rigid);
    ss_add(&ss.surface_list, "\"nodes\":");
    ss_indices(nodes, count);
    ss_add(&ss.surface_list, "}");
}

void ss_surface_3d(const char *name, const int *corners, int faces, int corners_per_face, int rigid) {
    int k;
    ss_surface_head(name, rigid);
    for (k = 0; k < faces; k++) {
        ss_add(&ss.surface_list, k ? "," : "\"faces\":[");
        ss_indices(corners + k * corners_per_face, corners_per_face);
    }
    ss_add(&ss.surface_list, "]}");
}

int ss_contact(int node, const char *surface, double mu, double cohesion, int mode) {
    int c = ss.contacts;
    ss.found = (struct ss_found *)ss_grown(ss.found, c, sizeof *ss.found);
    ss.held = (int *)ss_grown(ss.held, c, sizeof *ss.held);
    ss.once = (int *)ss_grown(ss.once, c, sizeof *ss.once);
    ss.is_once = (char *)ss_grown(ss.is_once, c, 1);
    ss.held[c] = ss.once[c] = -1;
    ss_add(&ss.contact_list, "%s{\"id\":%d,\"node\":%d,\"mode\":\"%s\",\"surface\":", c ? "," : "", c, node, ss_modes[mode]);
    ss_quoted(&ss.contact_list, surface);
    ss_add(&ss.contact_list, ",\"friction\":{\"mu\":%.17g,\"cohesion\":%.17g}}", mu, cohesion);
    return ss.contacts++;
}

static void ss_send(const char *text, size_t length) {
    while (length > 0) {
        ssize_t wrote = write(ss.out, text, length);
        if (wrote <= 0) _exit(1); /* The debugger is gone. */
        text += wrote;
        length -= (size_t)wrote;
    }
}

static void ss_say(const char *text) { ss_send(text, strlen(text)); }

/* A line of the input, read letter by letter: the rest belongs to whichever copy of the process continues. */
static int ss_read(char *line, int room) {
    int n = 0;
    while (read(ss.in, line + n, 1) == 1) {
        if (line[n] == '\n') { line[n] = 0; return 1; }
        if (n < room - 2) n++;
    }
    return 0;
}

static void ss_quit(void) {
    int k;
    for (k = 0; ss.saved && k < *ss.saved; k++) if (write(ss.wake[k][1], "q", 1) < 0) break;
    _exit(ss.saved && *ss.saved ? SS_LEFT : 0);
}

#ifndef SS_NO_FORK
/* Waits as a saved state, and returns in the copy that continues from it. Ends with the debugger, and reports copies that died. */
static void ss_wait(int token) {
    struct pollfd ends[2];
    char word = 0, answer[128];
    int status;
    for (;;) {
        memset(ends, 0, sizeof ends);
        ends[0].fd = ss.wake[token][0];
        ends[0].events = POLLIN;
        ends[1].fd = ss.in; /* POLLHUP needs no request. */
        poll(ends, 2, SS_LOOK);
        while (waitpid(-1, &status, WNOHANG) > 0) {
            if (WIFEXITED(status) && WEXITSTATUS(status) == SS_LEFT) continue;
            snprintf(answer, sizeof answer, "{\"type\":\"bye\",\"reason\":\"its process ended: %s %d\"}\n",
                     WIFSIGNALED(status) ? "signal" : "exit status", WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
            ss_say(answer);
            ss_quit();
        }
        if (ends[0].revents & POLLIN && read(ends[0].fd, &word, 1) == 1 && word == 'r') {
            pid_t copy = fork();
            if (copy == 0) { ss_say("{\"type\":\"ok\"}\n"); return; }
            if (copy < 0) { ss_say("{\"type\":\"bye\",\"reason\":\"fork failed\"}\n"); ss_quit(); }
        }
        if (word == 'q' || ends[1].revents) _exit(token ? SS_LEFT : 0);
    }
}
#endif

/* Saves the state: this process waits as the saved state, and its copy continues. */
static void ss_save(void) {
#ifdef SS_NO_FORK
    ss_say("{\"type\":\"refused\",\"reason\":\"no states are saved\"}\n");
#else
    char answer[64];
    int token = *ss.saved;
    pid_t copy;
    if (token >= SS_STATES) { ss_say("{\"type\":\"refused\",\"reason\":\"too many saved states\"}\n"); return; }
    copy = fork();
    if (copy < 0) { ss_say("{\"type\":\"refused\",\"reason\":\"fork failed\"}\n"); return; }
    if (copy == 0) {
        *ss.saved = token + 1;
        snprintf(answer, sizeof answer, "{\"type\":\"saved\",\"token\":%d}\n", token);
        ss_say(answer);
        return;
    }
    ss_wait(token);
#endif
}

static const char *ss_value(const char *line, const char *key) {
    const char *at = strstr(line, key);
    return at ? at + strlen(key) : NULL;
}

/* The number of a key; -1 without one. */
static int ss_integer(const char *line, const char *key) {
    const char *at = ss_value(line, key);
    return at && *at >= '0' && *at <= '9' ? atoi(at) : -1;
}

static void ss_restore(const char *line) {
    int number = ss_integer(line, "\"token\":");
    if (!ss.saved || number < 0 || number >= *ss.saved) { ss_say("{\"type\":\"refused\",\"reason\":\"no such state\"}\n"); return; }
    if (write(ss.wake[number][1], "r", 1) == 1) _exit(SS_LEFT);
}

static void ss_force(const char *line, int releases) {
    const char *mode = ss_value(line, "\"mode\":\"");
    int c = ss_integer(line, "\"contact\":"), forced = -1, k;
    for (k = 0; mode && k < 3; k++) if (!strncmp(mode, ss_modes[k], strlen(ss_modes[k]))) forced = k;
    if (c < 0 || c >= ss.contacts || (forced < 0 && !releases)) {
        ss_say("{\"type\":\"refused\",\"reason\":\"no such contact or mode\"}\n");
        return;
    }
    ss.held[c] = !releases && strstr(line, "\"hold\":true") ? forced : -1;
    ss.once[c] = releases || ss.held[c] >= 0 ? -1 : forced;
    if (ss.over == 1) ss.over = 0;
    ss_say("{\"type\":\"ok\"}\n");
}

static void ss_refuse_step(void) {
    if (ss.over > 1) ss_say("{\"type\":\"refused\",\"reason\":\"the loops of the solver have ended\"}\n");
    else ss_say("{\"type\":\"refused\",\"reason\":\"the history is complete\"}\n");
}

/* Answers requests until the next step. */
static void ss_answer(void) {
    char line[8192];
    while (ss_read(line, sizeof line)) {
        const char *type = ss_value(line, "\"type\":\"");
        if (!type) ss_say("{\"type\":\"refused\",\"reason\":\"no type\"}\n");
        else if (!strncmp(type, "hello\"", 6)) ss_send(ss.hello.letters, ss.hello.length);
        else if (!strncmp(type, "scene\"", 6)) ss_send(ss.scene.letters, ss.scene.length);
        else if (!strncmp(type, "step\"", 5) && !ss.over) return;
        else if (!strncmp(type, "step\"", 5)) ss_refuse_step();
        else if (!strncmp(type, "save\"", 5)) ss_save();
        else if (!strncmp(type, "restore\"", 8)) ss_restore(line);
        else if (!strncmp(type, "force\"", 6)) ss_force(line, 0);
        else if (!strncmp(type, "release\"", 8)) ss_force(line, 1);
        else if (!strncmp(type, "bye\"", 4)) ss_quit();
        else if (strncmp(type, "interrupt\"", 10)) ss_say("{\"type\":\"refused\",\"reason\":\"not offered\"}\n");
    }
    ss_quit();
}

void ss_begin(const char *title, const char *name, const char *version) {
    int nothing = open("/dev/null", O_RDONLY), k;
    (void)k;
    fflush(stdout);
    ss.in = dup(0);
    /* With --listen fd:0, standard input is a socket for both directions. */
    ss.out = dup(getenv("STICKSLIP_CONNECT") && !strcmp(getenv("STICKSLIP_CONNECT"), "fd:0") ? 0 : 1);
    dup2(nothing, 0);
    dup2(2, 1);
    close(nothing);
    ss.increment = ss.attempt = ss.major = ss.minor = 1;
#ifndef SS_NO_FORK
    ss.saved = (int *)mmap(NULL, sizeof *ss.saved, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (ss.saved == MAP_FAILED) ss.saved = NULL;
    for (k = 0; ss.saved && k < SS_STATES; k++) if (pipe(ss.wake[k])) ss.saved = NULL;
#endif
    ss_add(&ss.hello, "{\"type\":\"hello\",\"protocol\":%d,\"protocols\":[1,2],\"name\":", ss.in_space ? 2 : 1);
    ss_quoted(&ss.hello, name);
    ss_add(&ss.hello, ",\"version\":");
    ss_quoted(&ss.hello, version);
    ss_add(&ss.hello, ",\"abilities\":{\"force\":true,\"hold\":true,\"restore\":\"%s\"}}\n", ss.saved ? "any" : "none");
    ss_add(&ss.scene, "{\"type\":\"scene\",\"title\":");
    ss_quoted(&ss.scene, title);
    ss_add(&ss.scene, ",\"dimension\":%d,\"nodes\":[%s],\"lines\":[%s],\"surfaces\":[%s],\"contacts\":[%s]}\n",
           ss.in_space ? 3 : 2, ss.node_list.letters ? ss.node_list.letters : "", ss.line_list.letters ? ss.line_list.letters : "",
           ss.surface_list.letters ? ss.surface_list.letters : "", ss.contact_list.letters ? ss.contact_list.letters : "");
    ss_answer();
}

int ss_mode(int contact, int chosen) {
    int once = ss.once[contact];
    ss.once[contact] = -1;
    ss.is_once[contact] = once >= 0;
    return ss.held[contact] >= 0 ? ss.held[contact] : once >= 0 ? once : chosen;
}

void ss_contact_result(int contact, int mode, int next, double gap, double f_n, double f_t, double limit, double slip) {
    const double f[2] = {f_t, 0}, s[2] = {slip, 0};
    ss_contact_result_3d(contact, mode, next, gap, f_n, f, limit, s);
}

void ss_contact_result_3d(int contact, int mode, int next, double gap, double f_n, const double *f_t, double limit, const double *slip) {
    struct ss_found *found = &ss.found[contact];
    found->mode = mode;
    found->next = next;
    found->gap = gap;
    found->f_n = f_n;
    found->limit = limit;
    memcpy(found->f_t, f_t, sizeof found->f_t);
    memcpy(found->slip, slip, sizeof found->slip);
}

void ss_frame(int contact, const double *normal, const double *tangent) {
    struct ss_found *found = &ss.found[contact];
    memcpy(found->frame, normal, 3 * sizeof *normal);
    memcpy(found->frame + 3, tangent, 3 * sizeof *tangent);
    found->has_frame = 1;
}

void ss_displacement(int node, double x, double y) { ss_displacement_3d(node, x, y, 0); }

void ss_displacement_3d(int node, double x, double y, double z) {
    ss.moved[node][0] = x;
    ss.moved[node][1] = y;
    ss.moved[node][2] = z;
}

void ss_pause(const char *ended, double load, double residual, double tolerance) {
    struct ss_text *state = &ss.state;
    int c, k;
    state->length = 0;
    ss_add(state, "{\"type\":\"state\",\"at\":{\"increment\":%d,\"attempt\":%d,\"major\":%d,\"minor\":%d},\"ended\":", ss.increment,
           ss.attempt, ss.major, ss.minor);
    ss_quoted(state, ended);
    ss_number(state, "load", load);
    ss_add(state, ",\"residual\":{\"force\":null");
    ss_number(state, "relative", residual);
    ss_number(state, "limit", tolerance);
    ss_add(state, "},\"contacts\":[");
    for (c = 0; c < ss.contacts; c++) {
        const struct ss_found *found = &ss.found[c];
        int next = ss.held[c] >= 0 ? ss.held[c] : found->next;
        ss_add(state, "%s{\"id\":%d,\"mode\":\"%s\",\"next\":\"%s\"", c ? "," : "", c, ss_modes[found->mode], ss_modes[next]);
        if (ss.held[c] >= 0) ss_add(state, ",\"forced\":\"held\",\"wanted\":\"%s\"", ss_modes[found->next]);
        else if (ss.is_once[c]) ss_add(state, ",\"forced\":\"once\"");
        ss_number(state, "gap", found->gap);
        ss_number(state, "f_n", found->f_n);
        ss_tangential(state, "f_t", found->f_t);
        ss_number(state, "limit", found->limit);
        ss_tangential(state, "slip", found->slip);
        if (found->has_frame) {
            ss_add(state, ",\"normal\":");
            ss_numbers(state, found->frame, 3);
            ss_add(state, ",\"tangent\":");
            ss_numbers(state, found->frame + 3, 3);
        }
        ss_add(state, "}");
    }
    ss_add(state, "],\"displacements\":[");
    for (k = 0; k < ss.nodes; k++) {
        if (k) ss_add(state, ",");
        ss_numbers(state, ss.moved[k], ss.in_space ? 3 : 2);
    }
    ss_add(state, "]}\n");
    ss_send(state->letters, state->length);
    ss.over = !strcmp(ended, "done");
    ss.minor++;
    if (!strcmp(ended, "equilibrium")) ss.major++;
    else if (!strcmp(ended, "increment")) { ss.increment++; ss.attempt = ss.major = 1; }
    else if (!strcmp(ended, "cut")) { ss.attempt++; ss.major = 1; }
    if (strcmp(ended, "iteration")) ss.minor = 1;
    ss_answer();
}

void ss_end(void) {
    ss.over = 2;
    ss_refuse_step(); /* The one that ended the last pause. */
    ss_answer();
}
#endif
