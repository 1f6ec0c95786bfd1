/* SPDX-FileCopyrightText: The palpate developers
 * SPDX-License-Identifier: Apache-2.0
 * One recovery through palpate.h: recover_once REFERENCE TARGET SETTINGS FOLDER. For
 * scripts/compare_calls.py, which times it beside the command line. */
#include <stdio.h>
#include <stdlib.h>

#include "palpate.h"

static char* text_of(const char* path) {
    FILE* file = fopen(path, "rb");
    char* text = calloc(1, 1 << 20);
    if (!file || !text) exit(3);
    fread(text, 1, (1 << 20) - 1, file);
    fclose(file);
    return text;
}

int main(int argc, char** argv) {
    palpate_recover_options options;
    palpate_result* result = NULL;
    palpate_status status;
    if (argc != 5) return 2;
    palpate_recover_options_init(&options);
    options.settings_toml = text_of(argv[3]);
    status = palpate_recover_files(argv[1], argv[2], &options, &result);
    if (status == PALPATE_OK || status == PALPATE_NOT_CONVERGED)
        status = palpate_result_write(result, argv[4]);
    if (status != PALPATE_OK) fprintf(stderr, "%s\n", palpate_last_error());
    palpate_result_free(result);
    free((char*)options.settings_toml);
    return (int)status;
}
