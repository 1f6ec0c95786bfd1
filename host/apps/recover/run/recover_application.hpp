// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/application.hpp"

namespace palpate {

/// The main job: a result folder from segmentations of one patient in two states or more, or a plan
/// from the reference alone.
Application recover_application();

}  // namespace palpate
