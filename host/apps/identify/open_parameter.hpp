// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/estimate/parameter.hpp"
#include "host/io/settings_table.hpp"

namespace palpate {

/// The parameter that an open number of a model file is: its transform from the range that the file
/// allows (log above 0, logit within two ends), start and prior from the file, else from the table
/// of material laws. Throws Error(invalid_argument) if nothing says where to begin.
Parameter parameter_of(const OpenNumber& number);

}  // namespace palpate
