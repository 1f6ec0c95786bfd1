// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/compact_result.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/apps/recover/modelling/build_model.hpp"
#include "host/apps/recover/pipeline/assemble_result.hpp"
#include "host/apps/recover/pipeline/observed_target.hpp"
#include "host/apps/recover/pipeline/stored_parts.hpp"

namespace palpate {
namespace {

constexpr FileMark facts_mark{'P', 'A', 'L', 'F', 'C', 'T', '7', '\n'};
constexpr FileMark body_mark{'P', 'A', 'L', 'B', 'D', 'Y', '1', '\n'};

[[noreturn]] void refuse_bytes(const std::string& why) {
    throw Error(ErrorCode::input_unreadable, why);
}

/// A value that may not be there: whether it is, then the value.
template <typename Stream, typename Value, typename Visit>
void visit_optional(Stream& stream, Value& value, const Visit& visit_value) {
    bool is_there = value.has_value();
    stream(is_there);
    if constexpr (!std::is_const_v<Value>) {
        if (is_there) value.emplace();
    }
    if (is_there) visit_value(stream, *value);
}

template <typename Stream, typename Regions>
void visit_regions(Stream& stream, Regions& regions) {
    stream.each(regions, [](auto& inner, auto& r) {
        inner(r.region, r.name, r.label, r.role, r.hollow, r.unknown, r.poisson_ratio,
              r.stiffness_kpa, r.most_probable_kpa, r.interval_kpa, r.sd_ln, r.verdict, r.reason);
        visit_optional(inner, r.ratio, [](auto& within, auto& ratio) {
            within(ratio.interval, ratio.verdict, ratio.reason);
        });
        inner(r.jacobian_range, r.strain_energy_mj, r.seen_ends[0], r.seen_ends[1],
              r.other_answers_kpa, r.contradicts_prior);
    });
}

template <typename Stream, typename Result>
void visit_search(Stream& stream, Result& result) {
    stream.each(result.correlation, [](auto& inner, auto& row) { inner(row); });
    stream.each(result.sensitivity,
                [](auto& inner, auto& s) { inner(s.singular_value, s.direction); });
    visit_optional(stream, result.contours, [](auto& inner, auto& c) {
        inner(c.sd_mm, c.length_mm, c.is_given, c.images, c.point_scale, c.is_most, c.slice_share);
    });
    stream.each(result.profiles, [](auto& inner, auto& profile) {
        inner(profile.region, profile.stiffness_kpa, profile.objective);
    });
    stream.each(result.convergence, [](auto& inner, auto& record) {
        inner(record.iteration, record.objective, record.gradient_norm, record.step,
              record.stiffness_kpa);
    });
    auto& a = result.alignment;
    stream(a.method, a.reference_to_target.rotation, a.reference_to_target.translation,
           a.mean_distance_mm, a.moved_mm, a.turned_deg);
    auto& t = result.termination;
    stream(t.converged, t.reason, t.iterations);
}

/// Who computed, and how well.
template <typename Stream, typename Result>
void visit_computation(Stream& stream, Result& result) {
    visit(stream, result.mesher);
    visit(stream, result.device);
    stream.each(result.linear_solvers, [](auto& inner, auto& stage) {
        inner(stage.first);
        visit(inner, stage.second);
    });
    visit_optional(stream, result.element_loops, [](auto& inner, auto& loops) {
        visit(inner, loops.device);
        inner(loops.reason);
    });
    stream(result.full_model_residual);
    visit_optional(stream, result.mesh_change_mm, [](auto& inner, auto& mm) { inner(mm); });
    stream.each(result.timings_s,
                [](auto& inner, auto& stage) { inner(stage.first, stage.second); });
    stream.each(result.warnings, [](auto& inner, auto& warning) { inner(warning); });
}

template <typename Stream, typename Result>
void visit_facts(Stream& stream, Result& result) {
    stream(result.settings_toml, result.reference_name, result.target_name, result.version,
           result.law.name, result.seed_note);
    visit_regions(stream, result.regions);
    visit_search(stream, result);
    visit_computation(stream, result);
    // Of a surface, what the images do not say.
    stream.each(result.surfaces, [](auto& inner, auto& s) { inner(s.region, s.resultant_sd_mn); });
}

void check_mark(ByteReader& reader, const FileMark& wanted) {
    FileMark mark{};
    reader(mark);
    if (mark != wanted) refuse_bytes("it is of another version of palpate, or no file of palpate");
}

/// What `take` reads of bytes that begin with `mark`, and nothing else.
template <typename Read>
auto read_marked(std::span<const char> bytes, const FileMark& mark, const Read& take) {
    ByteReader reader(bytes);
    check_mark(reader, mark);
    auto value = take(reader);
    if (!reader.at_end()) refuse_bytes("it is too long");
    return value;
}

RecoveryResult facts_of(std::span<const char> bytes) {
    return read_marked(bytes, facts_mark, [](ByteReader& reader) {
        RecoveryResult result;
        visit_facts(reader, result);
        return result;
    });
}

/// The motion of a compact result in its model.
Recovered recovered_of(const CompactResult& kept, const RecoveryResult& facts,
                       const Settings& settings) {
    Recovered found;
    found.alignment = facts.alignment;
    found.law = facts.law;
    found.recovery = build_model(kept.body, settings);
    const std::size_t nodes = kept.body.mesh.nodes.size();
    if (kept.displacement.size() != nodes)
        refuse_bytes(
            fmt::format("it moves {} nodes, but the mesh has {}", kept.displacement.size(), nodes));
    std::vector<Index> held = found.recovery.fixed;
    held.insert(held.end(), found.recovery.driven.begin(), found.recovery.driven.end());
    std::sort(held.begin(), held.end());
    if (kept.force.size() != held.size())
        refuse_bytes(fmt::format("it has forces at {} nodes, but {} are held", kept.force.size(),
                                 held.size()));
    found.displacement = Eigen::VectorXd(3 * Index(nodes));
    found.force = Eigen::VectorXd::Zero(3 * Index(nodes));
    for (std::size_t n = 0; n < nodes; ++n)
        found.displacement.segment<3>(3 * Index(n)) = kept.displacement[n];
    for (std::size_t k = 0; k < held.size(); ++k)
        found.force.segment<3>(3 * held[k]) = kept.force[k];
    for (const SurfaceResult& surface : facts.surfaces)
        found.resultant_sd.push_back(surface.resultant_sd_mn);
    return found;
}

}  // namespace

std::string facts_bytes(const RecoveryResult& result) {
    ByteWriter writer;
    writer(facts_mark);
    visit_facts(writer, result);
    return writer.bytes();
}

std::string body_bytes(const BodyMesh& body) {
    ByteWriter writer;
    writer(body_mark);
    visit(writer, body);
    return writer.bytes();
}

BodyMesh body_of(std::span<const char> bytes) {
    return read_marked(bytes, body_mark, [](ByteReader& reader) {
        BodyMesh body;
        visit(reader, body);
        return body;
    });
}

RecoveryResult expand_result(const CompactResult& kept, const Segmentation& reference,
                             const Segmentation& target, const Settings& settings) {
    RecoveryResult result = facts_of(kept.facts);
    Recovered found = recovered_of(kept, result, settings);
    const LabelledState before = make_state(reference, settings);
    const TargetState after{target.name, found.alignment, make_state(target, settings), {}, 0};
    found.target = target_shapes(after, settings);
    const std::vector<std::string> warnings = std::move(result.warnings);
    result.settings = settings;
    result.surfaces.clear();
    add_motion(found, before, after, settings, result);
    result.warnings = warnings;
    add_element_stiffness(result);
    return result;
}

}  // namespace palpate
