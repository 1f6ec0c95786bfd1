/* SPDX-FileCopyrightText: The palpate developers
 * SPDX-License-Identifier: Apache-2.0 */
/* A program of somebody else, in C99: runs an application by name, and misuses that in every way that
 * comes to mind. Exit code 0 if all went as it should. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "palpate.h"

static int failures = 0;

static void expect(int condition, const char *what) {
    if (condition) return;
    printf("failed: %s (last error: %s)\n", what, palpate_last_error());
    ++failures;
}

static int cancels(void *user, const char *stage, double fraction, const char *message) {
    (void)stage, (void)fraction, (void)message;
    ++*(int *)user;
    return 1;
}

static palpate_status run(const char *application, const char *settings, palpate_outcome **outcome) {
    return palpate_run(application, settings, NULL, NULL, outcome);
}

/* The number behind the first "value" after a name. */
static double value_of(const char *json, const char *name) {
    const char *at = strstr(json, name);
    at = at ? strstr(at, "\"value\":") : NULL;
    return at ? strtod(at + strlen("\"value\":"), NULL) : NAN;
}

int main(void) {
    palpate_outcome *outcome = NULL;
    expect(palpate_abi_version() >= 2002, "is new enough");
    expect(strstr(palpate_applications(), "\"springs\"") != NULL, "tells its applications");
    expect(strstr(palpate_applications(), "\"force_mn\"") != NULL, "tells their options");

    /* k = (5, 2) mN/mm and F = 10 mN. */
    const char *settings = "force_mn = 10\njoint_mm = [2.0, 2.01, 1.99]\nend_mm = 7\nnoise_mm = 0.01\n";
    expect(run("springs", settings, &outcome) == PALPATE_OK, "runs");
    const char *json = palpate_outcome_json(outcome);
    expect(fabs(value_of(json, "\"first_mn_per_mm\"") - 5) < 0.05, "finds the first spring");
    expect(fabs(value_of(json, "\"second_mn_per_mm\"") - 2) < 0.02, "finds the second spring");
    expect(palpate_outcome_free(outcome) == PALPATE_OK, "frees");
    expect(strcmp(palpate_outcome_json(outcome), "") == 0, "knows what was freed");
    expect(palpate_outcome_free(outcome) == PALPATE_INVALID_ARGUMENT, "frees once");
    expect(palpate_outcome_free(NULL) == PALPATE_OK, "frees null");

    expect(run("spring", settings, &outcome) == PALPATE_INVALID_ARGUMENT, "refuses an unknown one");
    expect(strstr(palpate_last_error(), "springs") != NULL, "names those there are");
    expect(outcome == NULL, "gives nothing");
    expect(run("springs", "force_mn = -1\nend_mm = 7", &outcome) == PALPATE_INVALID_ARGUMENT,
           "refuses a value");
    expect(strstr(palpate_last_error(), "force_mn") != NULL, "names the option");
    expect(run("springs", "force_mn = 10", &outcome) == PALPATE_INVALID_ARGUMENT, "misses an option");
    expect(run("recover", "reference = \"a.nii.gz\"", &outcome) == PALPATE_INVALID_ARGUMENT,
           "misses the settings of a recovery");
    expect(strstr(palpate_last_error(), "config") != NULL, "names what is missing");
    expect(run("recover", "reference = \"a.nii.gz\"\ntarget = \"b.nii.gz\"\nconfig = \"c.toml\"\nout = \"d\"",
               &outcome) == PALPATE_INPUT_UNREADABLE,
           "misses a file");
    expect(run("springs", "force = ", &outcome) == PALPATE_INPUT_UNREADABLE, "refuses what is no TOML");
    expect(run(NULL, settings, &outcome) == PALPATE_INVALID_ARGUMENT, "refuses null");
    expect(run("springs", NULL, &outcome) == PALPATE_INVALID_ARGUMENT, "refuses null settings");
    expect(run("springs", settings, NULL) == PALPATE_INVALID_ARGUMENT, "refuses a null place");
    int calls = 0;
    expect(palpate_run("springs", settings, cancels, &calls, &outcome) == PALPATE_CANCELLED, "cancels");
    expect(calls == 1, "calls back once");

    printf("%d failures\n", failures);
    return failures != 0;
}
