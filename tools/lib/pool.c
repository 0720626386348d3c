/* SPDX-License-Identifier: MIT */
#include "pool.h"

#include <errno.h>
#include <omp.h>
#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "failure.h"

enum { MAX_JOBS = POOL_MAX_JOBS };

/* What the processes share. */
typedef struct board {
    atomic_int next;           /* first index nobody has taken */
    atomic_int held[MAX_JOBS]; /* what each worker works on; -1: nothing */
} board;

typedef struct worker {
    pid_t pid; /* 0: none */
    int from;  /* reads the indices it has finished */
} worker;

static const int stopping[] = {SIGINT, SIGTERM, SIGHUP};
enum { STOPPING = sizeof stopping / sizeof *stopping };

typedef struct crew {
    const pool *pool;
    int count;
    board *shared;
    char *finished; /* by index */
    worker worker[MAX_JOBS];
    struct sigaction before[STOPPING]; /* what the caller does at these signals */
} crew;

static volatile sig_atomic_t stop_signal;

static void on_signal(int number)
{
    stop_signal = number;
}

/* Ignored ones stay so: nohup and shells ask for that. */
static void catch_signals(crew *c)
{
    struct sigaction act = {.sa_handler = on_signal};
    stop_signal = 0;
    for (int i = 0; i < STOPPING; i++) {
        sigaction(stopping[i], NULL, &c->before[i]);
        if (c->before[i].sa_handler != SIG_IGN) sigaction(stopping[i], &act, NULL);
    }
}

static void release_signals(const crew *c)
{
    for (int i = 0; i < STOPPING; i++) sigaction(stopping[i], &c->before[i], NULL);
}

void *pool_memory(size_t size)
{
    void *memory = mmap(NULL, size ? size : 1, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory != MAP_FAILED) return memory;
    fprintf(stderr, "nacre: out of memory: %zu bytes\n", size);
    exit(FAIL_INTERNAL);
}

void pool_memory_free(void *memory, size_t size)
{
    munmap(memory, size ? size : 1);
}

/* The whole life of a worker. */
static _Noreturn void serve(const crew *c, int slot, int to, pid_t parent)
{
    const pool *p = c->pool;
    release_signals(c);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(0);
    omp_set_num_threads(p->threads);
    for (;;) {
        int index = atomic_fetch_add(&c->shared->next, 1);
        if (index >= c->count) break;
        atomic_store(&c->shared->held[slot], index);
        p->work(index, p->context);
        fflush(NULL);
        if (write(to, &index, sizeof index) != (ssize_t)sizeof index) _exit(FAIL_INTERNAL);
        atomic_store(&c->shared->held[slot], -1);
    }
    _exit(0);
}

/* Where that fails, the slot stays empty. */
static void start(crew *c, int slot)
{
    int ends[2];
    pid_t parent = getpid();
    fflush(NULL); /* or the child would print it again */
    atomic_store(&c->shared->held[slot], -1);
    if (pipe(ends)) return;
    pid_t pid = fork();
    if (pid == 0) {
        close(ends[0]);
        serve(c, slot, ends[1], parent);
    }
    close(ends[1]); /* so that the pipe ends when the worker does */
    if (pid > 0)
        c->worker[slot] = (worker){pid, ends[0]};
    else
        close(ends[0]);
}

static void finished(crew *c, int index, const char *how)
{
    if (c->finished[index]) return;
    c->finished[index] = 1;
    c->pool->done(index, how, c->pool->context);
}

/* The worker of a slot has ended; what it held has not been finished. */
static void bury(crew *c, int slot)
{
    worker *w = &c->worker[slot];
    int status = 0, index = atomic_load(&c->shared->held[slot]);
    char how[100];
    close(w->from);
    while (waitpid(w->pid, &status, 0) < 0 && errno == EINTR) {}
    w->pid = 0;
    if (WIFSIGNALED(status))
        snprintf(how, sizeof how, "signal %d, %s", WTERMSIG(status), strsignal(WTERMSIG(status)));
    else
        snprintf(how, sizeof how, "exit code %d", WEXITSTATUS(status));
    if (index >= 0) finished(c, index, how);
}

/* The worker's pipe has something: a finished index, or its end. */
static void attend(crew *c, int slot)
{
    int index;
    ssize_t got = read(c->worker[slot].from, &index, sizeof index);
    if (got < 0 && errno == EINTR) return;
    if (got == (ssize_t)sizeof index) {
        finished(c, index, NULL);
        return;
    }
    bury(c, slot);
    if (atomic_load(&c->shared->next) < c->count) start(c, slot);
}

static void watch(crew *c)
{
    for (;;) {
        struct pollfd waiting[MAX_JOBS];
        int slot_of[MAX_JOBS], alive = 0;
        for (int i = 0; i < c->pool->jobs; i++) {
            if (!c->worker[i].pid) continue;
            waiting[alive] = (struct pollfd){c->worker[i].from, POLLIN, 0};
            slot_of[alive++] = i;
        }
        if (!alive || stop_signal) return;
        if (poll(waiting, (nfds_t)alive, 500) < 0) continue; /* not for ever: a signal may have come just before */
        for (int k = 0; k < alive && !stop_signal; k++)
            if (waiting[k].revents) attend(c, slot_of[k]);
    }
}

/* Indices that no worker took, because none could be started; and those that one took to its grave. */
static void finish(crew *c)
{
    for (int index; !stop_signal && (index = atomic_fetch_add(&c->shared->next, 1)) < c->count;) {
        c->pool->work(index, c->pool->context);
        finished(c, index, NULL);
    }
    for (int i = 0; i < c->count && !stop_signal; i++) finished(c, i, "its end before it began");
}

static void end_all(crew *c)
{
    for (int i = 0; i < c->pool->jobs; i++) {
        if (!c->worker[i].pid) continue;
        kill(c->worker[i].pid, SIGKILL);
        while (waitpid(c->worker[i].pid, NULL, 0) < 0 && errno == EINTR) {}
        close(c->worker[i].from);
    }
}

int pool_run(const pool *p, int count)
{
    crew c = {.pool = p, .count = count};
    c.shared = pool_memory(sizeof *c.shared);
    c.finished = need_memory((size_t)count, 1);
    memset(c.finished, 0, (size_t)count);
    catch_signals(&c);
    for (int i = 0; i < p->jobs && i < count; i++) start(&c, i);
    watch(&c);
    finish(&c);
    end_all(&c);
    release_signals(&c);
    free(c.finished);
    pool_memory_free(c.shared, sizeof *c.shared);
    return stop_signal;
}
