// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "host/page/result_tree.hpp"

namespace palpate {

/// The result of a small inverse problem: two springs, of which the second is hardly seen.
inline ResultTree two_springs() {
    ResultTree tree{.name = "result", .title = "Two springs"};
    tree.add("format", "two-springs");
    tree.add(Figure{.name = "converged", .value = true, .title = "Converged"});
    ResultTree& springs = tree.add_part("springs", ResultTree::Shape::list);
    springs.title = "Springs";
    for (const char* name : {"left", "right"}) {
        const bool is_seen = name == std::string("left");
        ResultTree& spring = springs.add_part(name);
        spring.add(Figure{.name = "name", .value = name, .title = "Spring"});
        spring.add(Figure{.name = "stiffness_mn_per_mm",
                          .value = is_seen ? 83.24 : 20.0,
                          .unit = "mN/mm",
                          .title = "Stiffness",
                          .interval_95 = std::array{61.4, is_seen ? 112.8 : INFINITY},
                          .verdict = is_seen ? Verdict::recovered : Verdict::not_identifiable,
                          .reason = "the <interval> is what it is"});
    }
    ResultTree& fit = tree.add_part("fit");
    fit.title = "Fit";
    fit.add(Figure{
        .name = "misfit_mm", .value = 0.126, .unit = "mm", .title = "Misfit", .decimals = 2});
    fit.add("residuals_mm", std::vector{0.5, std::nan(""), -1.0});
    fit.add("frame", std::vector<std::vector<double>>{{1, 0}, {0, 1}});
    fit.add("device", FigureValue{});
    fit.add("points", std::vector<std::int64_t>{3, 4});
    fit.add("nodes", std::int64_t{7});
    return tree;
}

}  // namespace palpate
