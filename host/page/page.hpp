// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate {

/// What one page has that others have not. All but what is called text is HTML.
struct Page {
    std::string kind = {};     ///< text: what sort of page this is
    std::string version = {};  ///< text
    std::string headline = {};
    std::string lead = {};            ///< paragraphs under the headline
    std::string notices = {};         ///< what stands before all sections
    std::string main = {};            ///< the sections
    std::string footer = {};          ///< sentences after the version
    std::string style = {};           ///< rules beside page.css
    std::string scripts = {};         ///< JavaScript; empty: the page may run none
    bool takes_files_beside = false;  ///< pictures and scripts from the folder where it lies
};

/// One file that fetches nothing, and needs nothing else unless it takes files beside it.
std::string page_html(const Page& page);

/// A section, or nothing if it has no content.
std::string section_html(const std::string& id, const std::string& title,
                         const std::string& content);

}  // namespace palpate
