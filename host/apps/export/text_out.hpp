// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <iterator>
#include <utility>

namespace palpate {

/// Where the text of a model grows.
using TextOut = fmt::memory_buffer;

template <typename... Arguments>
void add(TextOut& out, fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(out), text, std::forward<Arguments>(arguments)...);
}

}  // namespace palpate
