// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/study/studies.hpp"

namespace palpate {

const std::vector<StudyEntry>& study_registry() {
    static const std::vector<StudyEntry> entries{
        {"coverage", "Do the 95 % intervals hold the truth? Many phantoms, 40 to 350 kPa", 60,
         make_coverage_study},
    };
    return entries;
}

}  // namespace palpate
