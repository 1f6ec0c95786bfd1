/* SPDX-FileCopyrightText: The palpate developers
 * SPDX-License-Identifier: Apache-2.0 */
/* To be preloaded (LD_PRELOAD): a machine on which programs crash before their main function, as
 * with a driver of another processor.
 *
 *   PALPATE_FAULT_WORDS   " patient trial ": programs whose second argument is one of them
 *   PALPATE_FAULT_SIGNAL  number of the signal; 0: they end with code 127
 *   PALPATE_FAULT_AT      from which of these programs on, from 1
 *   PALPATE_FAULT_COUNT   file in which they are counted, a byte each */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Whether the second argument is among the words. */
static int is_meant(void) {
    char words[256] = {0};
    char line[4096] = {0};
    const char *meant = getenv("PALPATE_FAULT_WORDS");
    const int file = open("/proc/self/cmdline", O_RDONLY | O_CLOEXEC);
    if (!meant || file < 0) return 0;
    const ssize_t got = read(file, line, sizeof line - 2);
    close(file);
    const char *word = line;
    for (int skipped = 0; skipped < 2 && word < line + got; ++skipped) word += strlen(word) + 1;
    if (word >= line + got) return 0;
    snprintf(words, sizeof words, " %.200s ", word);
    return strstr(meant, words) != NULL;
}

/* Which of them this is; they may start at the same time. */
static long count(void) {
    struct stat state;
    const char *path = getenv("PALPATE_FAULT_COUNT");
    const int file = path ? open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666) : -1;
    if (file < 0 || write(file, ".", 1) != 1 || fstat(file, &state) != 0) return 0;
    close(file);
    return (long)state.st_size;
}

__attribute__((constructor)) static void crash(void) {
    const char *text = getenv("PALPATE_FAULT_SIGNAL"), *at = getenv("PALPATE_FAULT_AT");
    if (!text || !at || !is_meant() || count() < atol(at)) return;
    if (atoi(text) != 0) raise(atoi(text));
    _exit(127);
}
