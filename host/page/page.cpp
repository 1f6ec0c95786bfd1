// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/page.hpp"

#include <fmt/format.h>

#include "host/page/assets.hpp"
#include "host/page/markup.hpp"

namespace palpate {

std::string page_html(const Page& page) {
    const bool has_scripts = !page.scripts.empty();
    const std::string beside = page.takes_files_beside ? " file: 'self'" : "";
    return fill_template(
        page_html_template(),
        {{"policy", "; img-src data:" + beside +
                        (has_scripts ? "; script-src 'unsafe-inline'" + beside : "")},
         {"nature", page.takes_files_beside
                        ? "No connections: what it shows is in it and in the files beside it."
                        : "One file, no connections: everything it shows is in it."},
         {"css", std::string(page_css()) + page.style},
         {"kind", escape_html(page.kind)},
         {"version", escape_html(page.version)},
         {"headline", page.headline},
         {"lead", page.lead},
         {"notices", page.notices},
         {"main", page.main},
         {"footer", page.footer},
         {"scripts",
          has_scripts ? "<script>\n\"use strict\";\n" + page.scripts + "</script>" : ""}});
}

std::string section_html(const std::string& id, const std::string& title,
                         const std::string& content) {
    if (content.empty()) return "";
    return fmt::format("<section id='{}'><h2>{}</h2>{}</section>\n", id, title, content);
}

}  // namespace palpate
