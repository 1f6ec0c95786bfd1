// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "host/apps/export/engineering_units.hpp"
#include "host/apps/export/law_formats.hpp"
#include "host/apps/export/text_out.hpp"
#include "host/apps/export/write_model.hpp"

namespace palpate {
namespace {

using Out = TextOut;

void add_nodes_and_elements(const RecoveredModel& model, Out& out) {
    add(out, "*NODE, NSET=ALL\n");
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        const Vec3& x = model.mesh.nodes[n];
        add(out, "{}, {:.9g}, {:.9g}, {:.9g}\n", n + 1, x.x(), x.y(), x.z());
    }
    for (const ModelRegion& region : model.regions) {
        add(out, "** {}\n*ELEMENT, TYPE=C3D4, ELSET=E_{}\n", model.description_of(region),
            region.token);
        for (const Index t : region.tets) {
            const Tet& tet = model.mesh.tets[t];
            add(out, "{}, {}, {}, {}, {}\n", t + 1, tet[0] + 1, tet[1] + 1, tet[2] + 1, tet[3] + 1);
        }
    }
}

void add_set(const char* name, const std::vector<Index>& nodes, Out& out) {
    constexpr std::size_t per_line = 12;  // at most 16 are allowed
    if (nodes.empty()) return;
    add(out, "*NSET, NSET={}\n", name);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        const bool ends = k % per_line == per_line - 1 || k + 1 == nodes.size();
        add(out, "{}{}", nodes[k] + 1, ends ? ",\n" : ", ");
    }
}

void add_material(const ModelRegion& region, const TissueLaw& law, Out& out) {
    add(out, "*MATERIAL, NAME=M_{}\n{}", region.token,
        calculix_material(law, {region.stiffness_kpa, region.poisson_ratio}));
    add(out, "*SOLID SECTION, ELSET=E_{0}, MATERIAL=M_{0}\n", region.token);
}

void add_walls(const RecoveredModel& model, WallLoad load, Out& out) {
    const std::vector<Index> driven = model.nodes_that_are(Held::driven);
    if (!model.nodes_that_are(Held::fixed).empty()) add(out, "*BOUNDARY\nFIXED, 1, 3, 0.\n");
    if (driven.empty()) return;
    const bool moves = load == WallLoad::displacement;
    add(out, "{}\n", moves ? "*BOUNDARY" : "*CLOAD");
    for (const Index n : driven) {
        for (int c = 0; c < 3; ++c) {
            if (moves) {
                add(out, "{}, {}, {}, {:.12g}\n", n + 1, c + 1, c + 1, model.displacement[n][c]);
            } else {
                add(out, "{}, {}, {:.12g}\n", n + 1, c + 1, newton_from_mn(model.force[n][c]));
            }
        }
    }
}

}  // namespace

std::string abaqus_deck(const RecoveredModel& model, WallLoad load) {
    Out out;
    add(out, "*HEADING\nRecovered by palpate {}. Units: mm, MPa, N. Axes: LPS.\n", model.version);
    add_nodes_and_elements(model, out);
    add_set("FIXED", model.nodes_that_are(Held::fixed), out);
    add_set("DRIVEN", model.nodes_that_are(Held::driven), out);
    for (const ModelRegion& region : model.regions) add_material(region, model.law, out);
    add(out, "*STEP{}\n*STATIC\n", model.law.is_linear() ? "" : ", NLGEOM");
    add_walls(model, load, out);
    add(out, "*NODE FILE\nU, RF\n*NODE PRINT, NSET=ALL, FREQUENCY=1000\nU\n*END STEP\n");
    return fmt::to_string(out);
}

}  // namespace palpate
