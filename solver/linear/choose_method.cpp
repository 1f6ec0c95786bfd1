// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/choose_method.hpp"

#include <algorithm>
#include <cmath>

#include "solver/linear/factor_libraries.hpp"

namespace palpate {
namespace {

// Medians on two x86-64 cores with AVX-512 on cubes of tetrahedra, in seconds. Sizes are relative
// to the seed scene.
constexpr double seed_dofs = 18000;

/// What a library takes: set-up = linear s + power s^exponent and `column` s^entries_exponent per
/// column, with s the size.
struct DirectCost {
    double linear, power, exponent, column;
};

// 6.6k, 17.5k, 89k degrees of freedom: set-up 0.08, 0.28, 3.8 s; each of many columns on two
// threads 0.4, 0.75, 8 ms.
constexpr DirectCost cholmod_cost{0.196, 0.104, 2, 0.8e-3};
// 6.6k, 17.5k, 89k: close to the numbers of CHOLMOD, not measured one by one.
constexpr DirectCost mumps_cost{0.2, 0.11, 2, 0.95e-3};
// 6.6k, 17.5k: set-up 0.36, 3.5 s; each of many columns 0.9, 2.7 ms.
constexpr DirectCost eigen_cost{0, 3.6, 2.4, 2.7e-3};

// Factor of CHOLMOD: 62 MB at 17.5k, 660 MB at 89k; a desktop has to keep room for the rest.
constexpr double entries_exponent = 1.45;
constexpr double factor_gib = 0.06;
constexpr double largest_factor_gib = 4;

// Multigrid CG through PoCL to 1e-8 at 18k, 90k, 300k and 1M degrees of freedom: set-up 0.09, 0.65,
// 2.7, 13 s; each of 16 columns 4.3, 45, 180 ms, and a single column as much as four of them.
// Loading compiled kernels takes a tenth of a second.
constexpr double multigrid_start = 0.1;
constexpr double multigrid_set_up = 0.095;
constexpr double multigrid_set_up_exponent = 1.2;
constexpr double multigrid_column = 4.3e-3;
constexpr double multigrid_column_exponent = 1.35;
constexpr Index fewest_multigrid_columns = 4;
constexpr double gpu_speedup = 10;  ///< of a pass over the mesh: memory bandwidth, not measured

double direct_seconds(const DirectCost& cost, double size, Index columns) {
    return cost.linear * size + cost.power * std::pow(size, cost.exponent) +
           columns * cost.column * std::pow(size, entries_exponent);
}

double multigrid_seconds(double size, Index columns, const BackendInfo& device) {
    const double iterations = std::max(columns, fewest_multigrid_columns) * multigrid_column *
                              std::pow(size, multigrid_column_exponent);
    return multigrid_start + multigrid_set_up * std::pow(size, multigrid_set_up_exponent) +
           iterations / (device.type == "GPU" ? gpu_speedup : 1.0);
}

const DirectCost& direct_cost(const std::string& library) {
    const std::string& name = library.empty() ? sparse_factor_names().front() : library;
    if (name == "mumps") return mumps_cost;
    return name == "cholmod" ? cholmod_cost : eigen_cost;
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
    const double relative = num_dofs / seed_dofs;
    if (factor_gib * std::pow(relative, entries_exponent) > largest_factor_gib)
        return {LinearMethod::multigrid, size + ": a factor would not fit into memory"};
    const double direct =
        direct_seconds(direct_cost(options.direct_library), relative, options.expected_columns);
    if (direct < multigrid_seconds(relative, options.expected_columns, device))
        return {LinearMethod::direct, size + ": factorising once on the host is cheapest"};
    return {LinearMethod::multigrid, size + ": a factorisation would not pay"};
}

}  // namespace palpate
