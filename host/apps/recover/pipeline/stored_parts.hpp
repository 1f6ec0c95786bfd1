// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "host/apps/recover/modelling/body_mesh.hpp"
#include "host/apps/recover/pipeline/byte_stream.hpp"
#include "host/geometry/meshing/mesher.hpp"
#include "solver/linear/linear_solver.hpp"

namespace palpate {

// What several files of bytes hold: one function for writing and reading. `Stream` is a ByteWriter
// with a constant value, or a ByteReader.

template <typename Stream, typename Value>
requires std::is_same_v<std::remove_const_t<Value>, BodyMesh>
void visit(Stream& stream, Value& body) {
    stream(body.mesh.type, body.mesh.nodes, body.mesh.elements, body.mesh.region);
    stream(body.surface.vertices, body.surface.triangles, body.surface.regions,
           body.surface.on_image_border);
}

template <typename Stream, typename Value>
requires std::is_same_v<std::remove_const_t<Value>, MesherSummary>
void visit(Stream& stream, Value& mesher) {
    auto& quality = mesher.quality;
    stream(mesher.mesher, mesher.fallback, mesher.seconds);
    stream(quality.num_nodes, quality.num_tets, quality.num_inverted, quality.min_dihedral_deg,
           quality.max_dihedral_deg, quality.min_volume_mm3, quality.region_volume_mm3);
}

template <typename Stream, typename Value>
requires std::is_same_v<std::remove_const_t<Value>, BackendInfo>
void visit(Stream& stream, Value& device) {
    stream(device.backend, device.platform, device.device, device.version, device.precision,
           device.product, device.compute_units, device.type);
    stream.each(device.choices, [](auto& inner, auto& choice) {
        inner(choice.columns, choice.product, choice.reason);
    });
}

template <typename Stream, typename Value>
requires std::is_same_v<std::remove_const_t<Value>, LinearSolverInfo>
void visit(Stream& stream, Value& solver) {
    stream(solver.method, solver.library, solver.reason);
    visit(stream, solver.device);
}

}  // namespace palpate
