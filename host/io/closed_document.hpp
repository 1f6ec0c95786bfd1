// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace palpate {

/// A document in which nothing is open any more.
struct DocumentClosing {
    std::map<std::string, double> numbers;  ///< of each open number's path (OpenNumber)
    std::vector<std::string> dropped;       ///< keys of the document that are left out
    std::function<std::string(const std::string&)> file_name;  ///< what a key `file` becomes
};

/// `toml` with these numbers in place of open ones, as TOML; comments are lost. Throws
/// Error(input_unreadable) if it is not TOML.
std::string closed_document(const std::string& toml, const std::string& source_name,
                            const DocumentClosing& closing);

}  // namespace palpate
