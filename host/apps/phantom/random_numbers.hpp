// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
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
    /// Of mean 0 and standard deviation 1, by Box and Muller.
    double normal() {
        const double radius = std::sqrt(-2 * std::log(std::max(1e-300, uniform(0, 1))));
        return radius * std::cos(6.283185307179586 * uniform(0, 1));
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
