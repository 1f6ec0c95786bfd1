// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/saved_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <sstream>
#include <utility>

#include "host/apps/recover/pipeline/byte_stream.hpp"
#include "host/system/version.hpp"

namespace palpate {
namespace {

std::string settings_that_matter(Settings settings) {
    settings.prior.noise_voxels = PriorSettings{}.noise_voxels;
    settings.prior.contour_sd_mm = PriorSettings{}.contour_sd_mm;
    settings.prior.drawn_by_slice = PriorSettings{}.drawn_by_slice;
    return to_toml(settings);
}

[[noreturn]] void refuse(const SavedReference& saved, const std::string& why) {
    throw Error(ErrorCode::input_unusable,
                fmt::format("{}: {}; save it anew with --save-reduced", saved.name, why));
}

void require(bool good, const char* what) {
    if (!good) throw Error(ErrorCode::input_unreadable, std::string(what) + " do not fit the rest");
}

/// Runs `action`; whatever it finds wrong becomes Error(input_unreadable) about the saved file.
template <typename Action>
auto blaming_file(const SavedReference& saved, const Action& action) {
    try {
        return action();
    } catch (const Error& error) {
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("{}: is damaged: {}; make it anew with --save-reduced", saved.name,
                                error.what()));
    }
}

/// The first line that differs and the organ or table it stands in.
std::string first_difference(const std::string& saved, const std::string& now) {
    std::istringstream left(saved), right(now);
    std::string a, b, where = "the settings";
    while (true) {
        const bool more_left = bool(std::getline(left, a)),
                   more_right = bool(std::getline(right, b));
        if (!more_left && !more_right) return {};
        if (!more_left) a.clear();
        if (!more_right) b.clear();
        if (a != b) break;
        if (a.starts_with("[") || a.starts_with("name = ")) where = a;
    }
    return fmt::format("after '{}', '{}' there and '{}' here", where, a, b);
}

std::string text_of(const ImageGrid& grid) {
    const auto& n = grid.size;
    const Vec3 &h = grid.spacing, &o = grid.origin;
    return fmt::format(
        "{} x {} x {} voxels of {:.6g} x {:.6g} x {:.6g} mm from ({:.6g}, {:.6g}, "
        "{:.6g})",
        n[0], n[1], n[2], h[0], h[1], h[2], o[0], o[1], o[2]);
}

bool same_places(const ImageGrid& a, const ImageGrid& b) {
    return a.size == b.size && a.origin == b.origin && a.spacing == b.spacing;
}

SparseEntries entries_of(const Eigen::SparseMatrix<double>& matrix) {
    SparseEntries entries;
    entries.size = static_cast<Index>(matrix.rows());
    for (Index column = 0; column < matrix.outerSize(); ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, column); it; ++it) {
            entries.rows.push_back(static_cast<Index>(it.row()));
            entries.columns.push_back(column);
            entries.values.push_back(it.value());
        }
    }
    return entries;
}

template <typename List>
bool all_below(const List& numbers, std::size_t limit) {
    return std::all_of(numbers.begin(), numbers.end(), [&](Index number) {
        return number >= 0 && static_cast<std::size_t>(number) < limit;
    });
}

template <typename List>
bool all_lists_below(const std::vector<List>& lists, std::size_t limit) {
    return std::all_of(lists.begin(), lists.end(),
                       [&](const List& numbers) { return all_below(numbers, limit); });
}

bool is_known(ElementType type) { return type == ElementType::tet4 || type == ElementType::tet10; }

bool is_sound(const BodyMesh& mesh, std::size_t num_regions) {
    const auto& [body, surface] = mesh;
    const std::size_t num_vertices = std::min(surface.vertices.size(), body.nodes.size());
    const std::size_t num_triangles = surface.triangles.size();
    return is_known(body.type) &&
           body.elements.size() == body.region.size() * body.table().num_nodes &&
           surface.regions.size() == num_triangles &&
           surface.on_image_border.size() == num_triangles &&
           all_below(body.elements, body.nodes.size()) && all_below(body.region, num_regions) &&
           all_lists_below(surface.triangles, num_vertices) &&
           all_lists_below(surface.regions, num_regions);
}

bool is_sound(const SparseEntries& entries) {
    return entries.rows.size() == entries.values.size() &&
           entries.columns.size() == entries.values.size() &&
           all_below(entries.rows, entries.size) && all_below(entries.columns, entries.size);
}

bool is_sound(const std::vector<Unknown>& moduli, const std::vector<Index>& unknown) {
    return std::all_of(moduli.begin(), moduli.end(), [&](const Unknown& modulus) {
        return std::find(unknown.begin(), unknown.end(), modulus.object) != unknown.end();
    });
}

void check_sound(const SavedReference& saved, const Settings& settings) {
    const auto num_fixed =
        std::count_if(settings.organs.begin(), settings.organs.end(),
                      [](const OrganSettings& organ) { return organ.role == Role::fixed; });
    require(static_cast<std::ptrdiff_t>(saved.fixed_points.size()) == num_fixed,
            "the fixed organs");
    require(is_sound(saved.mesh, settings.num_regions()), "the numbers of the mesh");
}

bool has_symmetric_pattern(const Eigen::SparseMatrix<double>& matrix) {
    const Eigen::SparseMatrix<double> turned = matrix.transpose();
    const auto n = matrix.outerSize();
    const auto count = matrix.nonZeros();
    return std::equal(matrix.outerIndexPtr(), matrix.outerIndexPtr() + n, turned.outerIndexPtr()) &&
           std::equal(matrix.innerIndexPtr(), matrix.innerIndexPtr() + count,
                      turned.innerIndexPtr());
}

WallPrior walls_of(const SavedReference& saved, const RecoveryModel& recovery,
                   const PriorSettings& prior) {
    const SparseEntries& entries = saved.wall_precision;
    const char* what = "the entries of the wall prior";
    require(entries.size == static_cast<Index>(recovery.driven.size()) && is_sound(entries), what);
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(entries.values.size());
    for (std::size_t k = 0; k < entries.values.size(); ++k) {
        triplets.emplace_back(entries.rows[k], entries.columns[k], entries.values[k]);
    }
    Eigen::SparseMatrix<double> precision(entries.size, entries.size);
    precision.setFromTriplets(triplets.begin(), triplets.end());
    require(has_symmetric_pattern(precision), what);
    return WallPrior(std::move(precision), wall_expectation(recovery, prior));
}

ResponseModel response_of(SavedReference& saved, const RecoveryModel& recovery) {
    const ResponseModel::Parts& parts = saved.response;
    require(parts.modes.rows() == 3 * static_cast<Eigen::Index>(recovery.observed.size()) &&
                parts.functionals.cols() == 3 * static_cast<Eigen::Index>(recovery.driven.size()) &&
                parts.stiffness_kpa.size() == recovery.model.materials.size(),
            "the matrices of the response");
    return ResponseModel(std::move(saved.response));
}

Mechanics mechanics_of(SavedReference& saved, const Settings& settings) {
    RecoveryModel recovery = build_model(saved.mesh, settings);
    require(is_sound(saved.unknowns, recovery.unknown), "the unknown regions");
    WallPrior walls = walls_of(saved, recovery, settings.prior);
    ResponseModel response = response_of(saved, recovery);
    return {std::move(recovery), std::move(walls), std::move(response), std::move(saved.unknowns),
            std::move(saved.condensation)};
}

}  // namespace

ReferenceFingerprint fingerprint_of(const LabelledState& reference, const Settings& settings) {
    const auto& voxels = reference.regions.voxels;
    return {version_text(), settings_that_matter(settings), reference.regions.grid,
            content_hash({reinterpret_cast<const char*>(voxels.data()), voxels.size()})};
}

SavedReference saved_form(const PreparedReference& prepared, const Settings& settings) {
    const Mechanics& mechanics = prepared.mechanics;
    SavedReference saved;
    saved.made_from = fingerprint_of(prepared.reference.state, settings);
    saved.fixed_points = prepared.reference.fixed_points;
    saved.mesh = prepared.mesh;
    saved.mesher = prepared.mesher;
    saved.wall_precision = entries_of(mechanics.walls.precision());
    saved.response = mechanics.response.parts();
    saved.unknowns = mechanics.unknowns;
    saved.condensation = mechanics.condensation;
    return saved;
}

void check_same_reference(const SavedReference& saved, const LabelledState& reference,
                          const Settings& settings) {
    const ReferenceFingerprint now = fingerprint_of(reference, settings);
    const ReferenceFingerprint& then = saved.made_from;
    if (then.version != now.version) {
        refuse(saved, fmt::format("was saved by palpate {}, this is palpate {}", then.version,
                                  now.version));
    }
    if (then.settings_toml != now.settings_toml) {
        refuse(saved, "was saved with other settings: " +
                          first_difference(then.settings_toml, now.settings_toml));
    }
    if (!same_places(then.grid, now.grid)) {
        refuse(saved, fmt::format("was saved for another reference: its grid has {}, this one {}",
                                  text_of(then.grid), text_of(now.grid)));
    }
    if (then.grid.direction != now.grid.direction) {
        refuse(saved, "was saved for another reference: the axes of its grid are turned");
    }
    if (then.voxels_hash != now.voxels_hash) {
        refuse(saved, "was saved for another reference: the labels of its voxels differ");
    }
    blaming_file(saved, [&] { check_sound(saved, settings); });
}

ReferenceState reference_state(const SavedReference& saved, LabelledState state) {
    return {std::move(state), 0, {}, saved.fixed_points};
}

PreparedReference restore(SavedReference saved, ReferenceState reference,
                          const RecoverOptions& options) {
    const Settings& settings = options.settings;
    auto maps = std::async(std::launch::async, [&] {
        return maps_of_matched(reference.state.field, settings, own_margin_mm);
    });
    Mechanics mechanics = blaming_file(saved, [&] { return mechanics_of(saved, settings); });
    auto done = maps.get();
    auto full_solver = start_full_solver(mechanics.recovery, options);
    auto finer_mesh = make_finer_mesh(saved.mesh, options);
    return {std::move(reference), std::move(saved.mesh),  std::move(saved.mesher), std::move(done),
            std::move(mechanics), std::move(full_solver), std::move(finer_mesh)};
}

}  // namespace palpate
