// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/choose_method.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// Medians on two x86-64 cores with AVX-512 (docs/performance.md); sizes scale from the seed scene,
// 18,000 degrees of freedom. In three dimensions a factor has about n^(4/3) entries and takes n^2
// operations, and Jacobi iterations grow as n^(1/3).
constexpr double seed_dofs = 18000;
constexpr double entries_exponent = 4.0 / 3.0;

// Eigen LDLT: 0.3 s at 6.6k, 6 s at 20.6k degrees of freedom; a column of 16 1.1 ms and 6.4 ms.
constexpr double factor_seconds = 4.5;
constexpr double factor_exponent = 2.5;
constexpr double direct_column_seconds = 5.4e-3;

// Jacobi CG through PoCL to 1e-8: 10 ms at 6.6k, 48 ms at 20.6k for each of 16 columns, and a
// single column as much as seven of them.
constexpr double jacobi_column_seconds = 40e-3;
constexpr Index fewest_jacobi_columns = 7;
constexpr double gpu_speedup = 10;  ///< of a pass over the mesh: memory bandwidth, not measured

// 0.1 GB of factor for the seed scene; a desktop has to keep room for the rest of the recovery.
constexpr double factor_gib = 0.1;
constexpr double largest_factor_gib = 4;

double entries_scale(Index num_dofs) { return std::pow(num_dofs / seed_dofs, entries_exponent); }

double direct_seconds(Index num_dofs, Index columns) {
    return factor_seconds * std::pow(num_dofs / seed_dofs, factor_exponent) +
           columns * direct_column_seconds * entries_scale(num_dofs);
}

double jacobi_seconds(Index num_dofs, Index columns, const BackendInfo& device) {
    const double seconds =
        std::max(columns, fewest_jacobi_columns) * jacobi_column_seconds * entries_scale(num_dofs);
    return device.type == "GPU" ? seconds / gpu_speedup : seconds;
}

/// 17646 -> "17,646".
std::string grouped(Index count) {
    std::string digits = std::to_string(count);
    for (std::ptrdiff_t at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
        digits.insert(static_cast<std::size_t>(at), 1, ',');
    return digits;
}

std::string counted(Index count, const std::string& one, const std::string& many) {
    return grouped(count) + " " + (count == 1 ? one : many);
}

MethodChoice as_asked(const LinearSolverOptions& options) {
    std::string reason = "asked for";
    if (options.method == LinearMethod::direct && options.backend != "reference")
        reason += "; factorising is host work, the " + options.backend + " back end is not used";
    return {options.method, reason};
}

}  // namespace

MethodChoice choose_method(const LinearSolverOptions& options, Index num_dofs,
                           const BackendInfo& device) {
    if (options.method != LinearMethod::automatic) return as_asked(options);
    if (device.backend == "reference")
        return {LinearMethod::direct, "the reference back end solves directly"};
    const std::string size = counted(num_dofs, "degree of freedom", "degrees of freedom") +
                             " and " + counted(options.expected_columns, "column", "columns");
    if (factor_gib * entries_scale(num_dofs) > largest_factor_gib)
        return {LinearMethod::jacobi, size + ": a factor would not fit into memory"};
    if (direct_seconds(num_dofs, options.expected_columns) <
        jacobi_seconds(num_dofs, options.expected_columns, device))
        return {LinearMethod::direct, size + ": factorising once on the host is cheapest"};
    return {LinearMethod::jacobi, size + ": a factorisation would not pay"};
}

}  // namespace palpate
