// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace palpate {

/// A number as people read it: three significant digits, no exponent between 0.001 and 99999;
/// "n/a" if it is not finite.
std::string significant(double value);
/// A number with fixed decimals; "n/a" if it is not finite.
std::string decimals(double value, int digits);
/// A count with a comma every three digits: "1,000,000".
std::string grouped(std::size_t count);
/// `decimals` for a table, with a dash for what does not exist.
std::string decimals_or_dash(double value, int digits);

}  // namespace palpate
