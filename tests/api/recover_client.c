/* SPDX-FileCopyrightText: The palpate developers
 * SPDX-License-Identifier: Apache-2.0 */
/* A program of somebody else, in C99: makes a phantom, recovers it from its label volumes, reads
 * the result, and cancels a second recovery. Argument: palpate-mesh. Exit code 0 if all went as it
 * should. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "palpate.h"

static int failures = 0;

static void expect(int condition, const char* what) {
    if (condition) return;
    printf("failed: %s (last error: %s)\n", what, palpate_last_error());
    ++failures;
}

struct watch {
    int calls;
    const char* cancel_in; /* a stage */
};

static int on_progress(void* user, const char* stage, double fraction, const char* message) {
    struct watch* watch = user;
    ++watch->calls;
    expect(fraction <= 1 && message != NULL, "progress makes sense");
    return watch->cancel_in != NULL && strcmp(stage, watch->cancel_in) == 0;
}

static int is_there(const char* folder, const char* name) {
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE* file = fopen(path, "rb");
    if (file != NULL) fclose(file);
    return file != NULL;
}

static void expect_folders_with_options(const palpate_result* result,
                                        palpate_write_options* writing) {
    static const char* const choices[] = {"none", "one", "all", NULL};
    char work[] = "palpate_result_XXXXXX"; /* mkdtemp replaces the six letters */
    char folder[sizeof work + 2];          /* work/k */
    char command[sizeof work + 6];         /* rm -r work */
    expect(mkdtemp(work) != NULL, "there is a folder to write into");
    for (int k = 0; k < 4; ++k) {
        writing->fields = choices[k];
        snprintf(folder, sizeof folder, "%s/%d", work, k);
        expect(palpate_result_write_with(result, folder, writing) == PALPATE_OK, "writes a folder");
        expect(is_there(folder, "result.json") && is_there(folder, "report.html"),
               "the folder holds a result");
        expect(is_there(folder, "displacement.nii.gz") == (k > 0), "holds the field, if asked");
        expect(is_there(folder, "from-target_to-reference_mode-image_xfm.h5") == (k == 2),
               "holds the transform, if asked");
        expect(palpate_result_write_with(result, folder, writing) == PALPATE_OUTPUT_FAILED,
               "replaces nothing");
    }
    snprintf(command, sizeof command, "rm -r %s", work);
    expect(system(command) == 0, "is cleaned up");
}

/* The figures of a region are those that `palpate_result_region` gives, by name and by position. */
static void check_figures(const palpate_result* result) {
    for (int32_t k = 0; k < palpate_result_num_regions(result); ++k) {
        palpate_region region = {.struct_size = sizeof region};
        palpate_figure here = {.struct_size = sizeof here}, there = {.struct_size = sizeof there};
        palpate_result_region(result, k, &region);
        char by_name[200], by_position[60];
        snprintf(by_name, sizeof by_name, "regions/%s/stiffness_kpa", region.name);
        snprintf(by_position, sizeof by_position, "regions/%d/stiffness_kpa", (int)k);
        expect(palpate_result_figure(result, by_name, &here) == PALPATE_OK &&
                   palpate_result_figure(result, by_position, &there) == PALPATE_OK,
               "finds a figure by name and by position");
        expect(strcmp(here.unit, "kPa") == 0 && strcmp(here.verdict, region.verdict) == 0 &&
                   strcmp(there.reason, region.reason) == 0,
               "a figure has unit, verdict and reason");
        if (strcmp(region.verdict, "hollow") == 0)
            expect(isnan(here.value) && isnan(here.interval_95[0]), "a hollow region has no modulus");
        else
            expect(here.value == region.stiffness_kpa && there.value == region.stiffness_kpa &&
                       here.interval_95[1] == region.interval_kpa[1],
                   "a figure is the region's");
    }
    palpate_figure figure = {.struct_size = sizeof figure};
    expect(palpate_result_figure(result, "material", &figure) == PALPATE_OK &&
               strcmp(figure.text, "linear") == 0 && isnan(figure.value) &&
               strcmp(figure.verdict, "") == 0,
           "a text is no number");
    expect(palpate_result_figure(result, "regions/99/label", &figure) == PALPATE_INVALID_ARGUMENT,
           "refuses a figure that is not there");
    figure.struct_size = 0;
    expect(palpate_result_figure(result, "material", &figure) == PALPATE_INVALID_ARGUMENT,
           "refuses a figure without a size");
}

static void read_result(const palpate_result* result) {
    int found = 0;
    for (int32_t k = 0; k < palpate_result_num_regions(result); ++k) {
        palpate_region region;
        region.struct_size = sizeof region;
        expect(palpate_result_region(result, k, &region) == PALPATE_OK, "reads a region");
        if (strcmp(region.name, "prostate") != 0) continue;
        found = 1;
        printf("prostate: %.1f kPa (%.1f to %.1f), %s\n", region.stiffness_kpa,
               region.interval_kpa[0], region.interval_kpa[1], region.verdict);
        expect(region.interval_kpa[0] < region.stiffness_kpa &&
                   region.stiffness_kpa < region.interval_kpa[1],
               "the interval holds the estimate");
        expect(fabs(log(region.most_probable_kpa / region.stiffness_kpa)) < 1,
               "the most probable modulus is near the one that is told");
        expect(region.stiffness_kpa > 20 && region.stiffness_kpa < 320,
               "the estimate is within a factor of four on this coarse phantom");
    }
    expect(found, "there is a prostate");
    palpate_region region;
    region.struct_size = sizeof region;
    expect(palpate_result_region(result, 99, &region) == PALPATE_INVALID_ARGUMENT,
           "refuses a region that is not there");
    const int32_t nodes = palpate_result_num_nodes(result);
    const double* u = palpate_result_displacement(result);
    double largest = 0;
    for (int32_t i = 0; i < 3 * nodes; ++i) largest = fmax(largest, fabs(u[i]));
    expect(nodes > 500 && largest > 0.5 && largest < 50, "the body moved");
    const int32_t* elements = palpate_result_elements(result);
    for (int32_t i = 0; i < 4 * palpate_result_num_elements(result); ++i)
        if (elements[i] < 0 || elements[i] >= nodes) expect(0, "elements have nodes");
    int32_t size[3];
    expect(palpate_result_field(result, size) != NULL && size[0] > 10, "there is a field");
    expect(strstr(palpate_result_json(result), "\"regions\"") != NULL, "there is JSON");
    check_figures(result);
    expect(palpate_result_write(result, "/proc/nowhere/result") == PALPATE_OUTPUT_FAILED,
           "says that a folder cannot be written");
    palpate_write_options writing;
    palpate_write_options_init(&writing);
    writing.fields = "none";
    expect(palpate_result_write_with(result, "/proc/nowhere/result", &writing) ==
               PALPATE_OUTPUT_FAILED,
           "says so with options, too");
    expect_folders_with_options(result, &writing);
    writing.fields = "both";
    expect(palpate_result_write_with(result, "nowhere", &writing) == PALPATE_INVALID_ARGUMENT &&
               strstr(palpate_last_error(), "\"one\"") != NULL,
           "says which fields there are");
}

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    palpate_phantom_options make;
    palpate_phantom_options_init(&make);
    make.seed = 3;
    make.num_nodes = 6000;
    make.mesh_program = argv[1];
    for (int i = 0; i < 3; ++i) make.spacing[i] = 2;
    palpate_phantom* phantom = NULL;
    expect(palpate_phantom_pelvis(&make, &phantom) == PALPATE_OK, "makes a phantom");
    if (!phantom) return 1;
    palpate_labels reference, target;
    palpate_labels_init(&reference);
    palpate_labels_init(&target);
    expect(palpate_phantom_labels(phantom, 0, &reference) == PALPATE_OK, "has a reference");
    expect(palpate_phantom_labels(phantom, 1, &target) == PALPATE_OK, "has a target");
    expect(palpate_phantom_labels(phantom, 2, &target) == PALPATE_INVALID_ARGUMENT,
           "has two states");

    struct watch watch = {0, NULL};
    palpate_recover_options options;
    palpate_recover_options_init(&options);
    options.settings_toml = palpate_phantom_settings(phantom);
    options.mesh_program = argv[1];
    options.num_nodes = 2500;
    options.progress = on_progress;
    options.progress_user = &watch;
    palpate_result* result = NULL;
    const palpate_status status = palpate_recover(&reference, &target, &options, &result);
    expect(status == PALPATE_OK || status == PALPATE_NOT_CONVERGED, "recovers");
    expect(watch.calls > 5, "tells its progress");
    if (result) read_result(result);
    palpate_result_free(result);

    watch.cancel_in = "condensing";
    expect(palpate_recover(&reference, &target, &options, &result) == PALPATE_CANCELLED,
           "is cancelled");
    expect(result == NULL, "no result after a cancel");
    watch.cancel_in = NULL;
    options.align = "magnetic";
    expect(palpate_recover(&reference, &target, &options, &result) == PALPATE_INVALID_ARGUMENT,
           "refuses an unknown alignment");
    options.align = NULL;
    target.spacing[1] = 0;
    expect(palpate_recover(&reference, &target, &options, &result) == PALPATE_INPUT_UNUSABLE,
           "refuses a grid without size");
    palpate_phantom_free(phantom);
    return failures == 0 ? 0 : 1;
}
