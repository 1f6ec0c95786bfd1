// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/tiny_phantom.hpp"

#include "host/apps/recover/pipeline/recover.hpp"
#include "host/apps/recover/run/recover_table.hpp"
#include "host/cohort/plan_file.hpp"
#include "host/cohort/recover_choice.hpp"
#include "solver/base/serial_blas.hpp"

namespace palpate {
namespace {

constexpr Index voxels = 24;
constexpr double spacing_mm = 3;
constexpr Index few_nodes = 800;
constexpr const char* organs =
    "[background]\nstiffness_kpa = 10.0\n"
    "[[organ]]\nname = \"ball\"\nlabel = 1\nrole = \"tissue\"\nstiffness_kpa = \"unknown\"\n"
    "[[organ]]\nname = \"bag\"\nlabel = 2\nrole = \"driven\"\n";

struct Ball {
    Vec3 centre;  ///< mm
    double radius_mm;
};

LabelImage drawn(const Ball& ball, const Ball& bag) {
    LabelImage image;
    image.grid.size = {voxels, voxels, voxels};
    image.grid.spacing = Vec3::Constant(spacing_mm);
    image.voxels.assign(image.grid.num_voxels(), 0);
    for (Index k = 0; k < voxels; ++k)
        for (Index j = 0; j < voxels; ++j)
            for (Index i = 0; i < voxels; ++i) {
                const Vec3 at = image.grid.to_point(Vec3(i, j, k));
                if ((at - bag.centre).norm() < bag.radius_mm) image.at(i, j, k) = 2;
                if ((at - ball.centre).norm() < ball.radius_mm) image.at(i, j, k) = 1;
            }
    return image;
}

}  // namespace

std::array<Segmentation, 2> tiny_phantom() {
    const Ball ball{{35, 35, 24}, 11}, bag{{35, 35, 48}, 10};
    return {Segmentation{drawn(ball, bag), "reference"},
            Segmentation{drawn({ball.centre - Vec3(0, 0, 2), ball.radius_mm},
                               {bag.centre, bag.radius_mm + 3}),
                         "target"}};
}

void recover_tiny_phantom(const std::filesystem::path& cohort, const ProgressSink& progress) {
    const SerialBlas serial;
    const OptionValues values = recover_values(PlanFile(cohort).head().recover_toml, "none");
    RecoverOptions options = recover_options_of(values, parse_settings(organs, "tiny phantom"));
    options.mesher.num_nodes = few_nodes;
    options.method = SearchMethod::map;
    // So few nodes would be solved for on the host, without the device that is to be tried.
    if (options.solver.method == LinearMethod::automatic)
        options.solver.method = LinearMethod::multigrid;
    const auto [reference, target] = tiny_phantom();
    recover(reference, target, options, progress);
}

}  // namespace palpate
