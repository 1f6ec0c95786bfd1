// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>
#include <vector>

#include "host/apps/phantom/pelvis.hpp"
#include "host/faces/cli/commands.hpp"
#include "host/faces/cli/console.hpp"
#include "host/faces/cli/options.hpp"
#include "host/system/interrupt.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

struct PhantomArguments {
    PelvisOptions pelvis;
    std::vector<double> spacing{1, 1, 1};
    std::vector<double> zones_kpa;
    std::string out, material = name_of(TissueLaw::linear), contours = "exact", load = "mixed",
                     anatomy = "usual";
    SolverArguments solver;
    MesherArguments mesher;
    bool quiet = false;
};

int run_pelvis(PhantomArguments arguments) {
    if (std::filesystem::exists(arguments.out)) {
        throw Error(
            ErrorCode::output_failed,
            fmt::format("{} exists already; remove it or choose another --out", arguments.out));
    }
    arguments.pelvis.spacing =
        Vec3(arguments.spacing[0], arguments.spacing[1], arguments.spacing[2]);
    if (!arguments.zones_kpa.empty()) {
        arguments.pelvis.zone_stiffness_kpa = {arguments.zones_kpa[0], arguments.zones_kpa[1]};
    }
    arguments.pelvis.num_nodes = arguments.mesher.nodes;
    arguments.pelvis.contours =
        drawn_for(contour_error_of(arguments.contours), arguments.pelvis.seed);
    arguments.pelvis.load = drawn_for(load_family_of(arguments.load), arguments.pelvis.seed);
    arguments.pelvis.anatomy =
        drawn_for(anatomy_family_of(arguments.anatomy), arguments.pelvis.seed);
    arguments.pelvis.law = tissue_law_of(arguments.material);
    const auto progress = console_progress(arguments.quiet);
    will_write(arguments.out);
    const PelvisPhantom phantom = make_pelvis(arguments.pelvis, solver_options(arguments.solver),
                                              mesher_options(arguments.mesher), progress);
    write_pelvis(phantom, arguments.pelvis, arguments.out);
    end_progress_line();
    fmt::print("phantom: {}\n", arguments.out);
    return 0;
}

}  // namespace

void add_phantom(CLI::App& app, Run& run) {
    CLI::App* command = app.add_subcommand("phantom", "Make input with a known answer");
    command->require_subcommand(1);
    CLI::App* pelvis = command->add_subcommand(
        "pelvis", "Prostate, bladder, rectum and bones, voxelised before and after deformation");
    auto arguments = std::make_shared<PhantomArguments>();
    arguments->mesher.nodes = PelvisOptions{}.num_nodes;
    auto& options = arguments->pelvis;
    pelvis->add_option("--seed", options.seed, "Anatomy and load")->capture_default_str();
    pelvis->add_option("--stiffness-kpa", options.stiffness_kpa, "Of the prostate")
        ->check(CLI::Range(1.0, 10000.0))
        ->capture_default_str();
    pelvis
        ->add_option("--zone-stiffness-kpa", arguments->zones_kpa,
                     "Two labelled zones instead: of transition and peripheral zone")
        ->expected(2)
        ->excludes("--stiffness-kpa")
        ->check(CLI::Range(1.0, 10000.0));
    pelvis->add_option("--poisson-ratio", options.poisson_ratio, "Of the prostate")
        ->check(CLI::Range(0.0, 0.49))
        ->capture_default_str();
    pelvis
        ->add_option("--tangential", options.tangential_factor,
                     "Factor on the walls' motion along themselves")
        ->check(CLI::Range(0.0, 10.0))
        ->capture_default_str();
    pelvis
        ->add_option("--material", arguments->material,
                     "Law of all tissue: linear (small strains), neo-hookean (large deformation)")
        ->check(CLI::IsMember({"linear", "neo-hookean"}))
        ->capture_default_str();
    pelvis
        ->add_option("--load-factor", options.load_factor,
                     "On the walls' motion; with 0 nothing moves, with -1 it goes the other way")
        ->check(CLI::Range(-1.0, 1.0))
        ->capture_default_str();
    pelvis
        ->add_option(
            "--target", options.target,
            "Number of the target: reference and load are those of the seed, the contours of each "
            "target are drawn anew (see --contours, --load-factor)")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    pelvis
        ->add_option("--tumour-fraction", options.tumour_fraction,
                     "Part of the prostate's volume that is tumour; it has no label")
        ->check(CLI::Range(0.0, 0.95))
        ->capture_default_str();
    pelvis->add_option("--tumour-kpa", options.tumour_stiffness_kpa, "Of the tumour")
        ->check(CLI::Range(1.0, 10000.0))
        ->capture_default_str();
    pelvis->add_option("--spacing", arguments->spacing, "Voxel size in mm, three numbers")
        ->expected(3)
        ->check(CLI::Range(0.2, 10.0))
        ->capture_default_str();
    pelvis
        ->add_option("--contours", arguments->contours,
                     "How both volumes are drawn: exact, or STYLE:SD:LENGTH in mm, STYLE one of "
                     "exponential, matern32, squared, slices; or drawn:SD, one of them")
        ->capture_default_str();
    pelvis
        ->add_option("--load", arguments->load,
                     "How the walls move: mixed, filling, bump, normal, tangential, shift, large, "
                     "or drawn")
        ->capture_default_str();
    pelvis
        ->add_option("--anatomy", arguments->anatomy,
                     "What kind of organs: usual, round, flat, touching (no tissue between them), "
                     "cut (the images end within bladder and rectum), or drawn")
        ->capture_default_str();
    pelvis->add_option("--out", arguments->out, "Folder, made new")->required();
    pelvis->add_flag("--quiet", arguments->quiet, "No progress");
    add_mesher_options(*pelvis, arguments->mesher);
    add_solver_options(*pelvis, arguments->solver);
    pelvis->callback([arguments, &run] { run = [arguments] { return run_pelvis(*arguments); }; });
}

}  // namespace palpate
