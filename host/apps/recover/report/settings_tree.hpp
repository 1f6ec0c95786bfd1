// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/recover/modelling/settings.hpp"
#include "host/page/result_tree.hpp"

namespace palpate {

/// The values that were used; the text of the file stays out because comments may name a patient.
ResultTree settings_tree(const Settings& settings);

}  // namespace palpate
