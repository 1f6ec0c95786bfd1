// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/displacement_steps.hpp"

#include <algorithm>
#include <string>

#include "solver/base/error.hpp"

namespace palpate {

bool is_rounded_by_writing(const Image<Vec3>& image) {
    return std::any_of(image.voxels.begin(), image.voxels.end(), [](const Vec3& v) {
        return v != Vec3(in_steps(v.x()), in_steps(v.y()), in_steps(v.z()));
    });
}

void check_displacement(const Image<Vec3>& image) {
    if (image.voxels.size() != image.grid.num_voxels())
        throw Error(ErrorCode::invalid_argument,
                    "an image of " + std::to_string(image.grid.num_voxels()) +
                        " voxels cannot have " + std::to_string(image.voxels.size()) + " vectors");
    const auto is_finite = [](const Vec3& v) { return v.allFinite(); };
    if (!std::all_of(image.voxels.begin(), image.voxels.end(), is_finite))
        throw Error(ErrorCode::output_failed,
                    "the displacement field has a vector that is not finite, so it is not written");
}

}  // namespace palpate
