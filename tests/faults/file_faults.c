/* SPDX-FileCopyrightText: The palpate developers
 * SPDX-License-Identifier: Apache-2.0 */
/* To be preloaded (LD_PRELOAD): counts the calls that change a folder (writing, bringing to disk,
 * renaming, making) and lets one of them fail, or kills the process there. What stdio writes from
 * its buffers it does inside the C library, where nothing can be put between; opening counts.
 *
 *   PALPATE_FAULT_FOLDER  calls about files below it count, in every process that inherits this,
 *                         together with what it forks
 *   PALPATE_FAULT_AT      at which call, from 1; 0: never
 *   PALPATE_FAULT_ACTION  kill: SIGKILL before the call; half: after half of a write
 *                         ENOSPC, EDQUOT: that call and every later write; EIO, EINTR: that call only
 *   PALPATE_FAULT_REPORT  file that gets, at the end, "calls <n> fired <0 or 1>" */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

/* Of a process and of all that it forks. */
static struct shared {
    atomic_long calls, fired;
    pid_t owner;
} *shared;

__attribute__((constructor)) static void begin(void) {
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) abort();
    shared->owner = getpid();
}

/* A child that writes for its parent goes with it. */
static void end_by_kill(void) {
    kill(shared->owner, SIGKILL);
    kill(getpid(), SIGKILL);
}

static const char *setting(const char *name) {
    const char *value = getenv(name);
    return value ? value : "";
}

static int is_below(const char *path) {
    const char *folder = setting("PALPATE_FAULT_FOLDER");
    const size_t length = strlen(folder);
    char whole[2 * PATH_MAX];
    if (length == 0 || !path) return 0;
    if (path[0] != '/') {
        char here[PATH_MAX];
        if (!getcwd(here, sizeof here)) return 0;
        snprintf(whole, sizeof whole, "%s/%s", here, path);
        path = whole;
    }
    return strncmp(path, folder, length) == 0 && (path[length] == '/' || path[length] == 0);
}

static int is_file_below(int file) {
    char link[64], path[PATH_MAX];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t length = readlink(link, path, sizeof path - 1);
    if (length <= 0) return 0;
    path[length] = 0;
    return is_below(path);
}

enum fate { goes_well, fails, is_cut };

/* What happens to this call; sets errno. */
static enum fate next_fate(int is_write) {
    static const struct {
        const char *name;
        int value, stays;
    } errors[] = {{"ENOSPC", ENOSPC, 1}, {"EDQUOT", EDQUOT, 1}, {"EIO", EIO, 0}, {"EINTR", EINTR, 0}};
    const long at = atol(setting("PALPATE_FAULT_AT"));
    if (!shared) return goes_well; /* another library begins */
    const char *action = setting("PALPATE_FAULT_ACTION");
    const long number = atomic_fetch_add(&shared->calls, 1) + 1;
    if (at > 0 && number >= at) shared->fired = 1;
    if (at <= 0 || number < at) return goes_well;
    if (number == at && strcmp(action, "kill") == 0) end_by_kill();
    if (number == at && strcmp(action, "half") == 0) return is_cut;
    for (size_t i = 0; i < sizeof errors / sizeof *errors; ++i)
        if (strcmp(action, errors[i].name) == 0 &&
            (number == at || (errors[i].stays && is_write))) {
            errno = errors[i].value;
            return fails;
        }
    return goes_well;
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

/* A call that writes nothing itself; `is_cut`: killed after it. */
#define SMALL_CALL(counts, is_write, call, failure) \
    const enum fate fate = (counts) ? next_fate(is_write) : goes_well; \
    if (fate == fails) return failure;              \
    const __typeof__(call) result = call;           \
    if (fate == is_cut) end_by_kill();              \
    return result;

/* A call that writes `size` of something; `half` of it when cut, and then killed. */
#define WRITES(name, half, size, ...)                                                   \
    const enum fate fate = is_file_below(file) ? next_fate(1) : goes_well;              \
    if (fate == fails) return -1;                                                       \
    const ssize_t result = REAL(name)(file, from, fate == is_cut ? half : size, ##__VA_ARGS__); \
    if (fate == is_cut) end_by_kill();                                                  \
    return result;

ssize_t write(int file, const void *from, size_t count) { WRITES(write, count / 2, count) }

ssize_t pwrite(int file, const void *from, size_t count, off_t place) {
    WRITES(pwrite, count / 2, count, place)
}

ssize_t pwrite64(int file, const void *from, size_t count, off64_t place) {
    WRITES(pwrite64, count / 2, count, place)
}

ssize_t writev(int file, const struct iovec *from, int count) {
    WRITES(writev, (count + 1) / 2, count)
}

int ftruncate(int file, off_t size) {
    SMALL_CALL(is_file_below(file), 1, REAL(ftruncate)(file, size), -1)
}

int ftruncate64(int file, off64_t size) {
    SMALL_CALL(is_file_below(file), 1, REAL(ftruncate64)(file, size), -1)
}

int fsync(int file) { SMALL_CALL(is_file_below(file), 0, REAL(fsync)(file), -1) }

int rename(const char *from, const char *to) {
    SMALL_CALL(is_below(to), 0, REAL(rename)(from, to), -1)
}

int renameat2(int from_folder, const char *from, int to_folder, const char *to, unsigned flags) {
    SMALL_CALL(is_below(to), 0, REAL(renameat2)(from_folder, from, to_folder, to, flags), -1)
}

int mkdir(const char *path, mode_t mode) {
    SMALL_CALL(is_below(path), 1, REAL(mkdir)(path, mode), -1)
}

static int makes_a_file(const char *path, int flags) {
    return (flags & O_ACCMODE) != O_RDONLY && is_below(path);
}

#define OPENS(name)                                                              \
    int name(const char *path, int flags, ...) {                                 \
        va_list rest;                                                            \
        va_start(rest, flags);                                                   \
        const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0; \
        va_end(rest);                                                            \
        SMALL_CALL(makes_a_file(path, flags), 1, REAL(name)(path, flags, mode), -1) \
    }
OPENS(open)
OPENS(open64)

#define OPENS_STREAM(name)                                                         \
    FILE *name(const char *path, const char *mode) {                               \
        SMALL_CALL(mode[0] != 'r' && is_below(path), 1, REAL(name)(path, mode), NULL) \
    }
OPENS_STREAM(fopen)
OPENS_STREAM(fopen64)

__attribute__((destructor)) static void report(void) {
    const char *path = setting("PALPATE_FAULT_REPORT");
    if (!shared) return;
    const long calls = shared->calls, fired = shared->fired;
    const int file = *path && calls > 0 ? REAL(open)(path, O_WRONLY | O_CREAT | O_TRUNC, 0666) : -1;
    if (file < 0) return;
    dprintf(file, "calls %ld fired %ld\n", calls, fired);
    REAL(fsync)(file);
    close(file);
}
