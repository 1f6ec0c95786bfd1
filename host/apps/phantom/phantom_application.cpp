// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/phantom_application.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "host/apps/compute_options.hpp"
#include "host/apps/phantom/aspiration/aspiration_phantom.hpp"
#include "host/apps/phantom/pelvis.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::vector<Option> body_options() {
    const PelvisOptions usual;
    return {
        Option::choice("kind", {"pelvis", "aspiration"},
                       "pelvis: prostate, bladder, rectum and bones, voxelised before and after "
                       "deformation; aspiration: a film of tissue that is sucked into a tube, of "
                       "which seed, perfect and frames tell all")
            .positional()
            .required(),
        Option::folder("out", "Folder, made new").required(),
        Option::integer("seed", 0, 4294967295.0, "Anatomy and load")
            .usually(std::int64_t{usual.seed}),
        Option::flag("perfect",
                     "Of aspiration: the instrument is as its settings say, nothing mars the film"),
        Option::choice("frames", {"pgm", "png"}, "Of aspiration: kind of the pictures")
            .usually(std::string("pgm")),
        Option::number("stiffness_kpa", "kPa", {1, 10000}, "Of the prostate")
            .usually(usual.stiffness_kpa),
        Option::number("zone_stiffness_kpa", "kPa", {1, 10000},
                       "Two labelled zones instead: of transition and peripheral zone")
            .list(2, 2)
            .excludes({"stiffness_kpa"}),
        Option::number("poisson_ratio", "", {0, 0.49}, "Of the prostate")
            .usually(usual.poisson_ratio),
        Option::choice("material", tissue_law_names(), "Law of all tissue: " + tissue_laws_text())
            .usually(std::string("linear")),
        Option::number("tumour_fraction", "", {0, 0.95},
                       "Part of the prostate's volume that is tumour; it has no label")
            .usually(usual.tumour_fraction),
        Option::number("tumour_kpa", "kPa", {1, 10000}, "Of the tumour")
            .usually(usual.tumour_stiffness_kpa),
        Option::choice("anatomy", {"usual", "round", "flat", "touching", "cut", "drawn"},
                       "Kind of organs: usual, round, flat, touching (no tissue between them), "
                       "cut (the images end within bladder and rectum), or drawn, any but usual "
                       "by the seed")
            .usually(std::string("usual")),
    };
}

std::vector<Option> motion_and_image_options() {
    const PelvisOptions usual;
    return {
        Option::choice(
            "load", {"mixed", "filling", "bump", "normal", "tangential", "shift", "large", "drawn"},
            "How the walls move; drawn: any but mixed by the seed")
            .usually(std::string("mixed")),
        Option::number("load_factor", "", {-1, 1},
                       "On the walls' motion; with 0 nothing moves, with -1 it goes the other way")
            .usually(usual.load_factor),
        Option::number("tangential", "", {0, 10}, "Factor on the walls' motion along themselves")
            .usually(usual.tangential_factor),
        Option::integer("target", 1, 1000,
                        "Number of the target: reference and load are those of the seed, the "
                        "contours of each target are drawn anew (contours, load_factor)")
            .usually(std::int64_t{usual.target}),
        Option::integer(
            "loads", 1, 1000,
            "Targets of one reference, each moved and drawn anew: a table pairs.tsv and "
            "a folder for each")
            .excludes({"target"}),
        Option::number("spacing", "mm", {0.2, 10}, "Voxel size")
            .list(3, 3)
            .usually(std::vector<double>{1, 1, 1}),
        Option::text("contours",
                     "How both volumes are drawn: exact, or STYLE:SD:LENGTH in mm, STYLE one of "
                     "exponential, matern32, squared, slices; or drawn:SD, one of them")
            .usually(std::string("exact")),
    };
}

std::vector<Option> phantom_table() {
    const std::vector<Option> elements{
        Option::choice("element", {"tet4", "tet10"},
                       "Tetrahedra that the truth is solved on: tet4 (linear), tet10 (quadratic, "
                       "nearer to the truth; the nodes count those in the middles of edges)")
            .usually(element_table(PelvisOptions{}.element).name)};
    return joined({body_options(), motion_and_image_options(), elements,
                   mesher_options(PelvisOptions{}.num_nodes), solver_options()});
}

PelvisOptions pelvis_of(const OptionValues& values) {
    PelvisOptions options;
    options.seed = static_cast<unsigned>(values.whole("seed"));
    options.stiffness_kpa = values.number("stiffness_kpa");
    const std::vector<double> zones = values.numbers("zone_stiffness_kpa");
    if (!zones.empty()) options.zone_stiffness_kpa = {zones[0], zones[1]};
    options.poisson_ratio = values.number("poisson_ratio");
    options.law = tissue_law_of(values.text("material"));
    options.tumour_fraction = values.number("tumour_fraction");
    options.tumour_stiffness_kpa = values.number("tumour_kpa");
    options.anatomy = drawn_for(anatomy_family_of(values.text("anatomy")), options.seed);
    options.load = load_family_of(values.text("load"));
    options.load_factor = values.number("load_factor");
    options.tangential_factor = values.number("tangential");
    options.target = static_cast<unsigned>(values.integer("target"));
    options.spacing = Vec3::Map(values.numbers("spacing").data());
    options.contours = drawn_for(contour_error_of(values.text("contours")), options.seed);
    options.num_nodes = static_cast<Index>(values.integer("nodes"));
    options.element = recovery_element_of(values.text("element"));
    return options;
}

/// Options of one kind are refused where they would do nothing.
void refuse_options_of_others(const OptionValues& values, bool is_aspiration) {
    const std::vector<std::string> of_aspiration{"perfect", "frames"};
    const std::vector<std::string> of_both{"kind", "out", "seed"};
    const auto has = [](const std::vector<std::string>& names, const std::string& name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
    for (const Option& option : phantom_table()) {
        if (has(of_both, option.name) || has(of_aspiration, option.name) == is_aspiration) continue;
        if (values.is_given(option.name))
            throw Error(ErrorCode::invalid_argument,
                        fmt::format("{} is of the other kind of phantom; leave it out",
                                    command_line_name(option.name)));
    }
}

Outcome run_aspiration(const OptionValues& values, const std::filesystem::path& folder,
                       const ProgressSink& progress) {
    const AspirationFigures made =
        make_aspiration_phantom({static_cast<unsigned>(values.whole("seed")),
                                 values.flag("perfect"), values.text("frames") == "png"},
                                folder, progress);
    return {ResultTree::of("phantom", {{"format", "palpate-phantom"},
                                       {"format_version", 1},
                                       {"seed", std::int64_t{made.truth.seed}},
                                       {"frames", std::int64_t{made.num_frames}},
                                       {"travel_mm", made.travel_mm},
                                       {"peak_suction_kpa", made.truth.suction.peak_kpa()}}),
            fmt::format("phantom: {}\n", folder.string())};
}

Outcome run_phantom(const OptionValues& values, const ProgressSink& progress) {
    const std::filesystem::path folder = values.path("out");
    if (std::filesystem::exists(folder))
        throw Error(
            ErrorCode::output_failed,
            fmt::format("{} exists already; remove it or choose another --out", folder.string()));
    const bool is_aspiration = values.text("kind") == "aspiration";
    refuse_options_of_others(values, is_aspiration);
    if (is_aspiration) return run_aspiration(values, folder, progress);
    const PelvisOptions options = pelvis_of(values);
    PelvisTruth largest;  // of the load that moves most
    std::int64_t nodes = 0;
    const auto note = [&](const PelvisPhantom& phantom) {
        nodes = phantom.mesh.mesh.num_nodes();
        if (phantom.truth.peak_displacement_mm >= largest.peak_displacement_mm)
            largest = phantom.truth;
    };
    const std::int64_t loads = values.is_given("loads") ? values.whole("loads") : 0;
    if (loads == 0) {
        const PelvisPhantom phantom =
            make_pelvis(options, solver_of(values), mesher_of(values), progress);
        write_pelvis(phantom, options, folder);
        note(phantom);
    } else {
        const auto for_each = [&](const PelvisSink& write) {
            make_pelvis_loads(
                options, static_cast<unsigned>(loads), solver_of(values), mesher_of(values),
                [&](const PelvisPhantom& phantom) {
                    write(phantom);
                    note(phantom);
                },
                progress);
        };
        write_pelvis_loads(options, for_each, folder);
    }
    return {
        ResultTree::of("phantom", {{"format", "palpate-phantom"},
                                   {"format_version", 1},
                                   {"seed", std::int64_t{options.seed}},
                                   {"nodes", nodes},
                                   {"loads", std::max<std::int64_t>(loads, 1)},
                                   {"peak_displacement_mm", largest.peak_displacement_mm},
                                   {"prostate_shape_change_mm", largest.prostate_shape_change_mm}}),
        fmt::format("phantom: {}\n", folder.string())};
}

}  // namespace

Application phantom_application() {
    return {"phantom", "Make input with a known answer", phantom_table(), run_phantom};
}

}  // namespace palpate
