// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/run/recover_table.hpp"

#include <utility>

#include "host/apps/compute_options.hpp"
#include "host/apps/recover/pipeline/landmarks.hpp"
#include "host/apps/recover/pipeline/partial_target.hpp"

namespace palpate {
namespace {

std::vector<Option> state_options() {
    return {
        Option::input_file("reference", "Label volume, state one").positional().required(),
        Option::input_file("target",
                           "Label volume, state two; of several, each gets a numbered folder in "
                           "the result folder; instead of it: target_surface, target_points")
            .positional()
            .list(1, Option::any_count),
        Option::input_file("config", "Organs and their roles (TOML)").required(),
        Option::folder("out", "Result folder, made new; needed but for a plan"),
        Option::flag("overwrite", "Replace an older result folder or save_reduced file"),
        Option::choice("align", {"auto", "fixed", "centroid", "none"},
                       "Rigid alignment first: auto (fixed organs if there are any, else "
                       "centroids), fixed, centroid, none")
            .usually(std::string("auto")),
        Option::input_file("initial_transform",
                           "Rigid ITK transform (.tfm .txt .h5) from reference to target points, "
                           "used instead of an alignment")
            .excludes({"align"}),
        Option::input_file("repeated_reference",
                           "The reference's image segmented once more, independently: measures "
                           "how far contours are off (contour_sd_mm)"),
    };
}

/// What a plan makes no use of.
const std::vector<std::string>& not_of_a_plan() {
    static const std::vector<std::string> names = {"out",
                                                   "overwrite",
                                                   "initial_transform",
                                                   "method",
                                                   "material",
                                                   "search_time",
                                                   "start_kpa",
                                                   "max_iterations",
                                                   "landmarks",
                                                   "landmarks_ras",
                                                   "fields",
                                                   "keep_file_names",
                                                   "save_reduced",
                                                   "load_reduced",
                                                   "reference_image",
                                                   "target_image",
                                                   "repeated_reference",
                                                   "max_rounds",
                                                   "one_search"};
    return names;
}

std::vector<Option> plan_options() {
    return {
        Option::flag("plan",
                     "Tell what interval to expect of how many targets, from the reference alone")
            .excludes(not_of_a_plan()),
        Option::number("plan_motion", "mm", {0.1, 50},
                       "How far loaded walls will move, along their normals")
            .usually(PlanOptions{}.motion_mm)
            .needs({"plan"}),
        Option::number("plan_contours", "mm", {0, largest_contour_sd_mm},
                       "How far contours will be off in each image (standard deviation); default: "
                       "contour_sd_mm of the settings, or 0.5")
            .needs({"plan"}),
    };
}

std::vector<Option> shape_options() {
    return {
        Option::text("target_surface",
                     "ORGAN=FILE: that organ's surface in state two, open or closed, mm (.vtp .vtk "
                     ".ply .stl .obj); may be repeated")
            .list(1, Option::any_count),
        Option::text("target_points",
                     "ORGAN=FILE: points on that organ's surface in state two, mm (.csv .txt .xyz: "
                     "columns x y z; or the points of .vtp .vtk .ply); may be repeated")
            .list(1, Option::any_count),
        Option::choice("target_frame", {"lps", "ras"}, "Frame of the coordinates in these files")
            .usually(std::string("lps"))
            .excludes({"target"}),
        Option::number("target_noise", "mm", {0.01, 20},
                       "Standard deviation of these surfaces and points")
            .usually(PartialTarget{}.noise_mm)
            .excludes({"target"}),
    };
}

std::vector<Option> shown_options() {
    return {
        Option::input_file("reference_image",
                           "Grey volume that the reference's labels were drawn on, shown under the "
                           "outlines in report.html, which then holds the patient's anatomy "
                           "(faces, and names burnt in)"),
        Option::input_file("target_image",
                           "The same for the target; with several targets given once for each, in "
                           "their order")
            .list(1, Option::any_count),
        Option::input_file("landmarks",
                           "Two CSV files (x, y, z in mm) with the same points in both images, row "
                           "by row: their error is told, the search does not use them")
            .list(2, 2),
        Option::flag("landmarks_ras", "These files are RAS, not LPS"),
        Option::choice("fields", {"none", "one", "all"},
                       "Displacement fields in the result: none, one (NIfTI, for each direction), "
                       "all (ITK transforms .h5, too)")
            .usually(std::string("one")),
        Option::flag("keep_file_names",
                     "Write the names of the input files into the result, and name the folders of "
                     "several targets after them"),
    };
}

std::vector<Option> search_options() {
    return {
        Option::input_file("mesh",
                           "Ready mesh of the reference (.vtu of linear or quadratic tetrahedra, "
                           "cell array 'region' with labels)"),
        Option::choice("element", {"tet4", "tet10"},
                       "Tetrahedra: tet4 (linear), tet10 (quadratic; a ready mesh of tet4 gets "
                       "mid-side nodes, one of tet10 stays so)")
            .usually(std::string("tet4")),
        Option::choice("method", {"map", "nested-lbfgs"},
                       "Search: map (with intervals), nested-lbfgs (the published baseline: slow, "
                       "no intervals)")
            .usually(std::string("map")),
        Option::choice("material", tissue_law_names(),
                       "Law of all tissue: " + tissue_laws_text() +
                           "; large deformation takes about three times the time")
            .usually(std::string("linear")),
        Option::number("search_time", "s", {0, 1e7},
                       "Time after which nested-lbfgs stops with its best point; 0: no limit")
            .usually(0.0),
        Option::number("start_kpa", "kPa", {0.1, 1e5},
                       "Stiffness at which the search starts; default: the prior's median"),
        Option::integer("max_iterations", 1, 1000, "Of the search")
            .usually(std::int64_t{MapOptions{}.max_iterations}),
        Option::flag("one_search",
                     "Do not search from other places where several moduli are unknown (linear "
                     "material, given Poisson's ratios): faster, but of several answers one is "
                     "told alone"),
        Option::integer("max_rounds", 1, 100, "Linearisations at large deformation")
            .usually(std::int64_t{usual_max_rounds}),
    };
}

std::vector<Option> reduced_options() {
    return {
        Option::output_file("save_reduced",
                            "File, made new, for the mesh and the reduced model of the reference, "
                            "for load_reduced"),
        Option::input_file("load_reduced",
                           "Such a file of the same reference and settings: no meshing, no "
                           "condensing")
            .excludes({"save_reduced", "mesh", "element", "mesher", "nodes", "mesh_time_limit",
                       "mesh_memory_limit"}),
    };
}

}  // namespace

std::vector<Option> recover_table() {
    return joined({state_options(), shape_options(), shown_options(), search_options(),
                   plan_options(), mesher_options(), reduced_options(), solver_options()});
}

RecoverOptions recover_options_of(const OptionValues& values) {
    return recover_options_of(values, read_settings(values.text("config")));
}

RecoverOptions recover_options_of(const OptionValues& values, Settings settings) {
    RecoverOptions options;
    options.settings = std::move(settings);
    options.element = recovery_element_of(values.text("element"));
    options.mesh = values.path("mesh");
    options.initial_transform = values.path("initial_transform");
    options.align = align_method_of(values.text("align"));
    options.mesher = mesher_of(values);
    options.solver = solver_of(values);
    options.search.max_iterations = values.integer("max_iterations");
    if (const auto start = values.optional_number("start_kpa")) options.search.start_kpa = *start;
    options.looks_elsewhere = !values.flag("one_search");
    options.method =
        values.text("method") == "map" ? SearchMethod::map : SearchMethod::nested_lbfgs;
    options.law = tissue_law_of(values.text("material"));
    options.max_rounds = values.integer("max_rounds");
    options.nested.max_outer_iterations = options.search.max_iterations;
    options.nested.time_limit_s = values.number("search_time");
    options.nested.direct_library = options.solver.direct_library;
    const std::vector<std::string> landmarks = values.texts("landmarks");
    if (!landmarks.empty())
        options.landmarks =
            read_landmarks(landmarks[0], landmarks[1],
                           values.flag("landmarks_ras") ? PointAxes::ras : PointAxes::lps);
    options.save_reduced = values.path("save_reduced");
    options.load_reduced = values.path("load_reduced");
    return options;
}

PlanOptions plan_options_of(const OptionValues& values) {
    return {values.number("plan_motion"), values.optional_number("plan_contours")};
}

}  // namespace palpate
