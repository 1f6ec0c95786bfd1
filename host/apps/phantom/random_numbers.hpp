// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "solver/base/types.hpp"

namespace palpate {

/// Numbers that depend on the seed alone, the same with every standard library (the standard's
/// distributions are not).
class RandomNumbers {
public:
    explicit RandomNumbers(std::uint64_t seed) : engine_(seed) {}

    double uniform(double low, double high) {
        return low + (high - low) * double(engine_() >> 11) * 0x1.0p-53;
    }
    bool is_below(double probability) { return uniform(0, 1) < probability; }
    Vec3 direction() {
        const double z = uniform(-1, 1), angle = uniform(0, 2 * 3.14159265358979323846);
        const double radius = std::sqrt(1 - z * z);
        return {radius * std::cos(angle), radius * std::sin(angle), z};
    }

private:
    std::mt19937_64 engine_;
};

}  // namespace palpate
