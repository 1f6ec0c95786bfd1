// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/identifiability.hpp"

#include <fmt/core.h>

namespace palpate {

Verdict judge(const std::array<double, 2>& interval_kpa, double sd_ln, double prior_sd_ln) {
    const double span = interval_kpa[1] / interval_kpa[0];
    if (sd_ln > prior_sd_ln * 2.0 / 3.0) {
        return {"not identifiable",
                fmt::format("the images hardly narrow what was assumed beforehand (ln E {:.2f} "
                            "against {:.2f} before): the organ does not deform enough relative to "
                            "its surroundings",
                            sd_ln, prior_sd_ln)};
    }
    if (span > 2.0) {
        return {"weak", fmt::format("the 95 % interval spans a factor of {:.1f}", span)};
    }
    return {"recovered", fmt::format("the 95 % interval spans a factor of {:.2f}", span)};
}

Verdict judge_unobserved(bool surface_is_driven) {
    if (surface_is_driven) {
        return {"not identifiable",
                "unknown forces act on the organ's whole surface, so any modulus fits; the prior "
                "median is shown"};
    }
    return {"not identifiable",
            "no free surface of the organ was seen in both images; the prior median is shown"};
}

Verdict not_judged(const std::string& method) {
    return {"not judged", fmt::format("the 95 % interval is not computed by {}", method)};
}

Verdict judge_without_reference() {
    return {"not identifiable",
            "no tissue has a known modulus: with no measured force only ratios can be found; give "
            "one tissue or the background a stiffness_kpa"};
}

}  // namespace palpate
