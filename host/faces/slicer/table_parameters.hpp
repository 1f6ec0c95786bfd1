// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/io/option.hpp"

namespace palpate {

/// Options of a table as parameters of a module, in XML of 3D Slicer's execution model. Flags,
/// choices, texts, integers and numbers only.
std::string parameters_xml(const std::vector<Option>& options);

}  // namespace palpate
