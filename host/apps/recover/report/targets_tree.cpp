// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/targets_tree.hpp"

#include "host/apps/recover/report/recovery_tree.hpp"

namespace palpate {

ResultTree targets_tree(const std::vector<TargetRow>& rows) {
    ResultTree tree =
        ResultTree::of("targets", {{"format", "palpate-targets"}, {"format_version", 1}});
    ResultTree& list = tree.add_part("targets", ResultTree::Shape::list);
    for (const TargetRow& row : rows) {
        ResultTree part = ResultTree::of(row.name, {{"name", row.name},
                                                    {"converged", row.converged},
                                                    {"seconds", row.seconds},
                                                    {"note", row.note}});
        part.add(regions_tree(row.unknown));
        list.add(std::move(part));
    }
    return tree;
}

}  // namespace palpate
