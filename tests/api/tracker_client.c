/* SPDX-FileCopyrightText: The palpate developers
 * SPDX-License-Identifier: Apache-2.0 */
/* A program of somebody else, in C99: follows a cap that rises, as a camera would see it, and misuses
 * the tracker in every way that comes to mind. Exit code 0 if all went as it should. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "palpate.h"

enum { width = 180, height = 180, num_frames = 15 };
static const char *const instrument =
    "[instrument]\nhole_diameter_mm = 10\nrim_thickness_mm = 0.5\npixel_r_um = 62.9\n"
    "pixel_z_um = 31.75\nbase_row_px = 150\ntissue = \"brighter\"\n";
static const double axis_px = 87.5;

static unsigned char bytes[width * height];
static unsigned short words[width * height];
static double z_mm[width], sd_mm[width], r_mm[width];
static unsigned char flag[width];
static int failures = 0;

static void expect(int condition, const char *what) {
    if (condition) return;
    printf("failed: %s (last error: %s)\n", what, palpate_last_error());
    ++failures;
}

/* Row of the edge: a cap about the axis that rises by 1.5 rows a frame. */
static double edge_row(int x, int frame) {
    const double d = (x - axis_px) / 79.5;
    return 118 - (30 + 1.5 * frame) * (1 - d * d);
}

/* An edge that is 1.1 pixels wide, between 30 and 170, with a grain of 3. */
static void take_picture(int frame) {
    unsigned grain = 12345u + (unsigned)frame;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double deep = y - edge_row(x, frame);
            grain = grain * 1664525u + 1013904223u;
            const double noise = 10.4 * ((double)(grain >> 8) / (1 << 24) - 0.5);
            const double grey = 30 + 70 * (1 + erf(deep / (1.1 * sqrt(2.0)))) + noise;
            bytes[y * width + x] = (unsigned char)grey;
            words[y * width + x] = (unsigned short)(4095 * (unsigned char)grey / 255);
        }
}

static void follow_a_cap(void) {
    palpate_tracker *live = NULL, *deep = NULL;
    expect(palpate_tracker_create(instrument, NULL, width, height, &live) == PALPATE_OK, "begins");
    expect(palpate_tracker_create(instrument, NULL, width, height, &deep) == PALPATE_OK, "begins twice");
    expect(palpate_tracker_num_columns(live) == width, "knows its columns");
    expect(palpate_tracker_axis(live, NULL, r_mm, NULL) == PALPATE_INPUT_UNUSABLE, "has no axis yet");
    double worst_mm = 0, axis = 0, radius_mm = 0;
    int seen = 0;
    for (int frame = 0; frame < num_frames; ++frame) {
        take_picture(frame);
        expect(palpate_tracker_add(live, bytes, 255, z_mm, sd_mm, flag) == PALPATE_OK, "adds a frame");
        for (int x = 0; x < width; ++x) {
            if (flag[x] != 0) continue;
            ++seen;
            const double truth_mm = (150 - edge_row(x, frame)) * 0.03175;
            worst_mm = fmax(worst_mm, fabs(z_mm[x] - truth_mm));
            expect(sd_mm[x] > 0 && sd_mm[x] < 0.1, "tells its error");
        }
        expect(palpate_tracker_add(deep, words, 4095, z_mm, NULL, NULL) == PALPATE_OK, "takes 12 bits");
    }
    expect(seen > 100 * num_frames, "sees the cap");
    expect(worst_mm < 0.032, "is within a pixel");
    expect(palpate_tracker_axis(live, &axis, r_mm, &radius_mm) == PALPATE_OK, "finds the axis");
    expect(fabs(axis - axis_px) < 0.3, "is about where it was");
    expect(fabs(r_mm[0] + axis * 0.0629) < 1e-9, "counts from the axis");
    expect(radius_mm == 5, "knows the hole");
    expect(palpate_tracker_free(live) == PALPATE_OK && palpate_tracker_free(deep) == PALPATE_OK, "frees");
    expect(palpate_tracker_add(live, bytes, 255, z_mm, sd_mm, flag) == PALPATE_INVALID_ARGUMENT,
           "knows what was freed");
    expect(palpate_tracker_num_columns(live) == 0, "has no columns after");
}

/* Only some of each frame is looked at. */
static void crop(void) {
    char settings[512];
    palpate_tracker *part = NULL;
    snprintf(settings, sizeof settings, "%saxis_column_px = %g\ncrop_px = [10, 0, 160, 180]\n", instrument,
             axis_px);
    expect(palpate_tracker_create(settings, "", width, height, &part) == PALPATE_OK, "crops");
    expect(palpate_tracker_num_columns(part) == 160, "has fewer columns");
    double axis = 0;
    expect(palpate_tracker_axis(part, &axis, r_mm, NULL) == PALPATE_OK, "was told the axis");
    expect(fabs(axis - axis_px) < 1e-9 && fabs(r_mm[0] - (10 - axis_px) * 0.0629) < 1e-9, "counts in frames");
    take_picture(0);
    expect(palpate_tracker_add(part, bytes, 255, z_mm, NULL, NULL) == PALPATE_OK, "adds");
    expect(fabs(z_mm[78] - (150 - edge_row(88, 0)) * 0.03175) < 0.032, "looks at the right place");
    expect(palpate_tracker_free(part) == PALPATE_OK, "frees");
}

static void misuse(void) {
    palpate_tracker *tracker = NULL;
    expect(palpate_tracker_create(NULL, NULL, 9, 9, &tracker) == PALPATE_INVALID_ARGUMENT, "refuses null");
    expect(palpate_tracker_create(instrument, NULL, 180, 180, NULL) == PALPATE_INVALID_ARGUMENT,
           "refuses a null place");
    expect(palpate_tracker_create(instrument, NULL, 0, 180, &tracker) == PALPATE_INVALID_ARGUMENT,
           "refuses no columns");
    expect(palpate_tracker_create(instrument, NULL, 180, 20000, &tracker) == PALPATE_INVALID_ARGUMENT,
           "refuses too many rows");
    expect(palpate_tracker_create(instrument, NULL, 180, 100, &tracker) == PALPATE_INPUT_UNUSABLE,
           "misses the rim");
    expect(strstr(palpate_last_error(), "base_row_px") != NULL, "names it");
    expect(palpate_tracker_create("[instrument]\nhole = 1", NULL, 180, 180, &tracker) ==
               PALPATE_INVALID_ARGUMENT,
           "refuses a key");
    expect(palpate_tracker_create("[frames", NULL, 180, 180, &tracker) == PALPATE_INPUT_UNREADABLE,
           "refuses what is no TOML");
    expect(tracker == NULL, "gives nothing");
    expect(palpate_tracker_create(instrument, NULL, 180, 180, &tracker) == PALPATE_OK, "begins");
    expect(palpate_tracker_add(tracker, NULL, 255, z_mm, sd_mm, flag) == PALPATE_INVALID_ARGUMENT,
           "refuses no frame");
    expect(palpate_tracker_add(tracker, bytes, 0, z_mm, sd_mm, flag) == PALPATE_INVALID_ARGUMENT,
           "refuses black for white");
    expect(palpate_tracker_add(tracker, bytes, 65536, z_mm, sd_mm, flag) == PALPATE_INVALID_ARGUMENT,
           "refuses wide words");
    expect(palpate_tracker_free(tracker) == PALPATE_OK, "frees");
    expect(palpate_tracker_free(tracker) == PALPATE_INVALID_ARGUMENT, "frees once");
    expect(palpate_tracker_free(NULL) == PALPATE_OK, "frees null");
}

int main(void) {
    expect(palpate_abi_version() >= 2004, "is new enough");
    follow_a_cap();
    crop();
    misuse();
    printf("%d failures\n", failures);
    return failures != 0;
}
