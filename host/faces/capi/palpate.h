/* SPDX-FileCopyrightText: The palpate developers
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PALPATE_H
#define PALPATE_H

/* palpate from C and from every language that can call C.
 *
 * Lengths in mm, stiffness in kPa, forces in mN (1 kPa mm^2 = 1 mN); places in LPS patient space.
 * Every function that can fail returns a palpate_status; `palpate_last_error` then has one sentence
 * about it. Nothing throws, prints or exits. Arrays are the caller's and are copied, unless a
 * function says otherwise; numbers come back into arrays that the caller made. Structs begin with
 * their size, which their `_init` function sets with all defaults: a program that was compiled
 * against an older header goes on working. A handle that was freed, or never was one, is answered
 * with PALPATE_INVALID_ARGUMENT, 0, null or "", whatever it is given to.
 *
 * Different handles may be used from different threads at the same time; one handle from one thread
 * at a time. Not a medical device. */

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define PALPATE_API __declspec(dllimport)
#elif defined(__GNUC__)
#define PALPATE_API __attribute__((visibility("default")))
#else
#define PALPATE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The numbers are the exit codes of the command line. */
typedef enum palpate_status {
    PALPATE_OK = 0,
    PALPATE_INTERNAL = 1,         /* a defect of palpate; please report it */
    PALPATE_INVALID_ARGUMENT = 2, /* null, wrong size, out of range, not supported */
    PALPATE_INPUT_UNREADABLE = 3, /* a file that is missing or damaged */
    PALPATE_INPUT_UNUSABLE = 4,   /* input that makes no sense: empty label, no overlap */
    PALPATE_MESH_FAILED = 5,
    PALPATE_SOLVE_FAILED = 6,
    PALPATE_NOT_CONVERGED = 7, /* the result is there, and flagged */
    PALPATE_DEVICE_FAILED = 8, /* no such device, its program or memory failed */
    PALPATE_TIME_LIMIT = 9,
    PALPATE_OUTPUT_FAILED = 10,
    PALPATE_CANCELLED = 11 /* a callback asked for it */
} palpate_status;

/* "not converged"; never null. */
PALPATE_API const char* palpate_status_text(palpate_status status);
/* The message of this thread's last failed call; "" if none failed. Valid until the next call. */
PALPATE_API const char* palpate_last_error(void);
/* "0.1.0 ..." with the libraries it was built with. */
PALPATE_API const char* palpate_version(void);
/* Grows when something is added (to structs at their end), its thousands when something breaks. */
PALPATE_API int palpate_abi_version(void);

/* Called during long work, about every second or more often, on the thread that called palpate or
 * on one of its own, never on two at a time. `fraction` of the stage is 0 to 1, or negative if
 * unknown; calls without news repeat the stage with a negative fraction and an empty message. A
 * value other than 0 cancels: the call returns PALPATE_CANCELLED soon. */
typedef int (*palpate_progress)(void* user, const char* stage, double fraction,
                                const char* message);

/* ---- Linear elasticity: many columns, gradients -------------------------------------------- */

/* A mesh of linear tetrahedra with one material per region. */
typedef struct palpate_model {
    size_t struct_size;
    int32_t num_nodes;
    const double* nodes; /* [num_nodes, 3] mm */
    int32_t num_elements;
    const int32_t* elements; /* [num_elements, 4] node numbers from 0, positive volumes */
    const int32_t* regions;  /* [num_elements], from 0; null: all 0 */
    int32_t num_regions;
    const double* stiffness_kpa; /* [num_regions] Young's moduli */
    const double* poisson_ratio; /* [num_regions] */
    const uint8_t* prescribed;   /* [num_nodes, 3], 1 where the displacement is given */
} palpate_model;
PALPATE_API void palpate_model_init(palpate_model* model);

typedef struct palpate_solver_options {
    size_t struct_size;
    const char* method;  /* "auto", "multigrid", "jacobi", "direct"; null: "auto" */
    const char* backend; /* "opencl", "kokkos", "reference"; null: the first of this build */
    const char* device;  /* "platform.device" or part of a name; null: best */
    int use_double;      /* on the device; results are refined to double either way */
    double relative_tolerance;
    int32_t expected_columns; /* right-hand sides per set of moduli */
    palpate_progress progress;
    void* progress_user;
} palpate_solver_options;
PALPATE_API void palpate_solver_options_init(palpate_solver_options* options);

typedef struct palpate_solver palpate_solver;

/* options: null for the defaults. *solver receives a handle for palpate_solver_free. A
 * factorisation (method "direct") is not interrupted: here and in set_stiffness cancelling takes
 * effect after it. */
PALPATE_API palpate_status palpate_solver_create(const palpate_model* model,
                                                 const palpate_solver_options* options,
                                                 palpate_solver** solver);
/* Null is allowed. */
PALPATE_API palpate_status palpate_solver_free(palpate_solver* solver);
/* New moduli [num_regions] for the same mesh. */
PALPATE_API palpate_status palpate_solver_set_stiffness(palpate_solver* solver,
                                                        const double* stiffness_kpa);
/* Equilibrium K u = f for `columns` load cases at once. All arrays are [num_nodes, 3, columns], the
 * column running fastest.
 *   load          mN at free components, the given displacement in mm at prescribed ones
 *   displacement  mm
 *   reaction      mN at prescribed components, 0 elsewhere; or null
 * PALPATE_NOT_CONVERGED: arrays hold the best that was found. */
PALPATE_API palpate_status palpate_solver_solve(palpate_solver* solver, const double* load,
                                                int32_t columns, double* displacement,
                                                double* reaction);
/* Derivatives of a scalar J = sum over columns of J_c(u_c) of the last solution.
 *   displacement  [num_nodes, 3, columns] as `palpate_solver_solve` gave it
 *   slope         [num_nodes, 3, columns] dJ/du
 *   by_load       [num_nodes, 3, columns] dJ/dload: per mN at free, per mm at prescribed components
 *   by_stiffness  [num_regions] dJ/dE per kPa; or null */
PALPATE_API palpate_status palpate_solver_gradient(palpate_solver* solver,
                                                   const double* displacement, const double* slope,
                                                   int32_t columns, double* by_load,
                                                   double* by_stiffness);
/* y = K x without regard to what is prescribed: nodal forces, mN. [num_nodes, 3, columns] */
PALPATE_API palpate_status palpate_solver_apply(palpate_solver* solver, const double* x,
                                                int32_t columns, double* y);
/* Who solves and how, one line; valid as long as the solver. */
PALPATE_API const char* palpate_solver_description(const palpate_solver* solver);

/* ---- Recovery: two segmentations in, moduli, forces and the field out ----------------------- */

/* A label volume. Voxel (i, j, k) has its centre at origin + direction (i sx, j sy, k sz). */
typedef struct palpate_labels {
    size_t struct_size;
    int32_t size[3];
    double origin[3];
    double spacing[3];
    double direction[9];    /* row by row; its columns are the axes */
    const uint16_t* voxels; /* [size[2], size[1], size[0]], i fastest */
    const char* name;       /* for messages and reports; null: "reference", "target" */
} palpate_labels;
PALPATE_API void palpate_labels_init(palpate_labels* labels);

typedef struct palpate_recover_options {
    size_t struct_size;
    const char* settings_toml; /* organs and roles, as in a settings file; required */
    const char* align;         /* "auto", "fixed", "centroid", "none"; null: "auto" */
    const char* mesh_program;  /* path of palpate-mesh; null: where it is looked for */
    const char* mesh;     /* path of a ready mesh (.vtu) of the reference; null: it is meshed */
    int32_t num_nodes;    /* of the mesh; 0: as the command line */
    const char* material; /* a law of docs/simulate.md; null: "linear" */
    const palpate_solver_options* solver; /* its progress is not used; null: the defaults */
    palpate_progress progress;
    void* progress_user;
    /* "tet4" (linear), "tet10" (quadratic tetrahedra); null: "tet4". Since palpate_abi_version()
     * 2003. */
    const char* element;
} palpate_recover_options;
PALPATE_API void palpate_recover_options_init(palpate_recover_options* options);

typedef struct palpate_result palpate_result;

/* PALPATE_NOT_CONVERGED comes with a result, other failures with none. From the first call on, the
 * allocator of the GNU C library keeps freed blocks of up to 1 GiB (mallopt): without that a
 * recovery takes 5 % longer. */
PALPATE_API palpate_status palpate_recover(const palpate_labels* reference,
                                           const palpate_labels* target,
                                           const palpate_recover_options* options,
                                           palpate_result** result);
/* The same from files (.nii, .nii.gz, .nrrd, .mha); the settings stay text. */
PALPATE_API palpate_status palpate_recover_files(const char* reference_path,
                                                 const char* target_path,
                                                 const palpate_recover_options* options,
                                                 palpate_result** result);
PALPATE_API palpate_status palpate_result_free(palpate_result* result);

/* What is known about one region. Strings live as long as the result. */
typedef struct palpate_region {
    size_t struct_size;
    const char* name;
    int32_t label;
    const char* role;
    const char* verdict;    /* "recovered", "weak", "not identifiable", "given", "hollow" */
    const char* reason;     /* one sentence */
    double stiffness_kpa;   /* 0 for hollow regions */
    double interval_kpa[2]; /* 95 % */
    double poisson_ratio;
    double most_probable_kpa; /* the modulus with which displacements and forces are */
} palpate_region;

PALPATE_API int32_t palpate_result_num_regions(const palpate_result* result);
PALPATE_API palpate_status palpate_result_region(const palpate_result* result, int32_t index,
                                                 palpate_region* region);
/* One figure of the result. Texts are valid as long as the result. */
typedef struct palpate_figure {
    size_t struct_size;
    const char* unit;      /* "kPa"; "" if it has none */
    double value;          /* a number, or 1 and 0 for true and false; else NaN */
    const char* text;      /* a text; else "" */
    double interval_95[2]; /* NaN unless it is an estimate */
    const char* verdict;   /* as in palpate_region; "" unless it is an estimate */
    const char* reason;    /* of the verdict */
} palpate_figure;

/* By its path in result.json, with positions from 0 or names in lists: "full_model_residual",
 * "regions/0/stiffness_kpa", "regions/prostate/stiffness_kpa". Set struct_size before. Since
 * palpate_abi_version() 2003. */
PALPATE_API palpate_status palpate_result_figure(const palpate_result* result, const char* path,
                                                 palpate_figure* figure);

PALPATE_API int32_t palpate_result_num_nodes(const palpate_result* result);
PALPATE_API int32_t palpate_result_num_elements(const palpate_result* result);
/* Of an element: 4, or 10 with the middles of the edges 01, 12, 02, 03, 13, 23 after the corners.
 * Since palpate_abi_version() 2003. */
PALPATE_API int32_t palpate_result_nodes_per_element(const palpate_result* result);
/* Views into the result, valid as long as it: [num_nodes, 3] mm, mm and mN, [num_elements, nodes of
 * an element], and [num_elements] kPa. Displacements of nodes lead to the target as the rigid
 * alignment laid it onto the reference; `palpate_result_field` leads to where the target lies in
 * its own image. */
PALPATE_API const double* palpate_result_nodes(const palpate_result* result);
PALPATE_API const double* palpate_result_displacement(const palpate_result* result);
PALPATE_API const double* palpate_result_force(const palpate_result* result);
PALPATE_API const int32_t* palpate_result_elements(const palpate_result* result);
PALPATE_API const double* palpate_result_stiffness(const palpate_result* result);
/* The displacement field on the reference's grid, reference to target: a view [k, j, i, 3] mm. */
PALPATE_API const double* palpate_result_field(const palpate_result* result, int32_t size[3]);
/* result.json as the command line writes it; valid as long as the result. */
PALPATE_API const char* palpate_result_json(const palpate_result* result);
/* The folder that the command line writes: report, volumes, meshes. It must not exist. */
PALPATE_API palpate_status palpate_result_write(const palpate_result* result, const char* folder);

/* How a result folder is written. */
typedef struct palpate_write_options {
    size_t struct_size;
    const char* fields; /* displacement fields, rounded to 1/128 mm: "none", "one" (NIfTI, for each
                           direction), "all" (ITK transforms, too); null: "one" */
} palpate_write_options;
PALPATE_API void palpate_write_options_init(palpate_write_options* options);

/* The same with options; null for the defaults. Since palpate_abi_version() 2001. */
PALPATE_API palpate_status palpate_result_write_with(const palpate_result* result,
                                                     const char* folder,
                                                     const palpate_write_options* options);

/* ---- Phantoms: two segmentations whose answer is known -------------------------------------- */

typedef struct palpate_phantom_options {
    size_t struct_size;
    uint32_t seed;        /* anatomy and load; the same seed gives the same phantom */
    double stiffness_kpa; /* of the prostate */
    double background_stiffness_kpa;
    double spacing[3];                    /* mm, of the label volumes */
    int32_t num_nodes;                    /* of the mesh that the truth is solved on */
    const char* mesh_program;             /* path of palpate-mesh; null: where it is looked for */
    const char* material;                 /* a law of docs/simulate.md; null: "linear" */
    const palpate_solver_options* solver; /* its progress is not used; null: the defaults */
    palpate_progress progress;
    void* progress_user;
} palpate_phantom_options;
PALPATE_API void palpate_phantom_options_init(palpate_phantom_options* options);

typedef struct palpate_phantom palpate_phantom;
PALPATE_API palpate_status palpate_phantom_pelvis(const palpate_phantom_options* options,
                                                  palpate_phantom** phantom);
PALPATE_API palpate_status palpate_phantom_free(palpate_phantom* phantom);
/* Reference (0) or target (1): fills `labels` with views that live as long as the phantom. */
PALPATE_API palpate_status palpate_phantom_labels(const palpate_phantom* phantom, int32_t state,
                                                  palpate_labels* labels);
/* Its organs as the settings of a recovery; valid as long as the phantom. */
PALPATE_API const char* palpate_phantom_settings(const palpate_phantom* phantom);

/* ---- Applications: whatever the command line can do, by name -------------------------------- */

/* What there is and what each takes, as JSON: {"applications": [{"name", "summary", "options":
 * [{"name", "kind", "meaning", "allowed", "default", "required", "unit", ...}]}]}. Never null;
 * valid for ever. Since palpate_abi_version() 2002, as all that follows. */
PALPATE_API const char* palpate_applications(void);

typedef struct palpate_outcome palpate_outcome;

/* Runs an application.
 *   application    its name, "springs"
 *   settings_toml  TOML text with a key for each option that is given; "" if none is
 *   progress       may be null
 *   outcome        receives a handle for palpate_outcome_free
 * PALPATE_NOT_CONVERGED comes with an outcome; so does the first failure among several cases. Other
 * failures come with none. */
PALPATE_API palpate_status palpate_run(const char* application, const char* settings_toml,
                                       palpate_progress progress, void* progress_user,
                                       palpate_outcome** outcome);
/* The result as JSON, as the command line writes result.json; valid as long as the outcome. */
PALPATE_API const char* palpate_outcome_json(const palpate_outcome* outcome);
/* Null is allowed. */
PALPATE_API palpate_status palpate_outcome_free(palpate_outcome* outcome);

/* ---- Aspiration: the outline of sucked tissue, frame by frame -------------------------------- */

/* Since palpate_abi_version() 2004, as all that follows. */
typedef struct palpate_tracker palpate_tracker;

/* Follows the edge of tissue in a film, as `palpate aspirate contours` does: a frame goes in, its
 * profile comes out at once. For a live camera.
 *   settings_toml  the tables [instrument] and [frames] of an aspiration's settings
 *   folder         where a `calibration` that the settings name lies; null: the current folder
 *   width, height  of frames, pixels
 *   tracker        receives a handle for palpate_tracker_free */
PALPATE_API palpate_status palpate_tracker_create(const char* settings_toml, const char* folder,
                                                  int32_t width, int32_t height,
                                                  palpate_tracker** tracker);
/* Null is allowed. */
PALPATE_API palpate_status palpate_tracker_free(palpate_tracker* tracker);
/* Of a profile: the frame's width, or that of `crop_px`; 0 for what is no handle. */
PALPATE_API int32_t palpate_tracker_num_columns(const palpate_tracker* tracker);
/* The profile in the next frame, of all columns, those beyond the hole, too. Null for what is not
 * asked for. Black frames are not refused: look at the flags.
 *   grey   [height, width] pixels, rows from the top, without gaps: bytes where `white` is at most
 *          255, aligned 16-bit words of this machine above
 *   white  grey of white, 1 to 65535: 255, or 4095 of a camera of 12 bits; what is brighter is
 * white z_mm   [columns] height of the edge above the rim's lower face, mm sd_mm  [columns] its
 * standard deviation flag   [columns] 0 ok; 1 guessed, cues disagree; 2 hidden behind the rim, z is
 * the middle of what it hides; 3 lost. Heights of 1 and 3 are guesses */
PALPATE_API palpate_status palpate_tracker_add(palpate_tracker* tracker, const void* grey,
                                               int32_t white, double* z_mm, double* sd_mm,
                                               uint8_t* flag);
/* Where the tube's axis is. If settings do not tell, the frames so far that show tissue do, and
 * stay with what the first ten of them say; PALPATE_INPUT_UNUSABLE before the first. Null for what
 * is not asked for. axis_column_px  in whole frames r_mm            [columns] distance from the
 * axis, negative left of it hole_radius_mm  a profile is what lies within */
PALPATE_API palpate_status palpate_tracker_axis(const palpate_tracker* tracker,
                                                double* axis_column_px, double* r_mm,
                                                double* hole_radius_mm);

#ifdef __cplusplus
}
#endif

#endif /* PALPATE_H */
