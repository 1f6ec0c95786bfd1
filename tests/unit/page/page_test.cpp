// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/page.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(Page, HasItsPartsOnceAndEscapesWhatIsText) {
    const std::string page = page_html({.kind = "a < b",
                                        .version = "1 & 2",
                                        .headline = "Head <i>line</i>",
                                        .main = section_html("id", "Title", "content"),
                                        .footer = "Foot.",
                                        .style = ".own {}"});

    EXPECT_TRUE(has(page, "a &lt; b · palpate 1 &amp; 2"));
    EXPECT_TRUE(has(page, "<h1>Head <i>line</i></h1>"));
    EXPECT_TRUE(has(page, "<section id='id'><h2>Title</h2>content</section>"));
    EXPECT_TRUE(has(page, "Made by palpate 1 &amp; 2. Foot."));
    EXPECT_TRUE(has(page, ".own {}</style>"));
    EXPECT_FALSE(has(page, "{{"));
}

TEST(Page, MayRunScriptsOnlyIfItHasSome) {
    EXPECT_FALSE(has(page_html({}), "<script"));
    EXPECT_FALSE(has(page_html({}), "script-src"));
    const std::string page = page_html({.scripts = "start();"});
    EXPECT_TRUE(has(page, "script-src 'unsafe-inline'"));
    EXPECT_TRUE(has(page, "\"use strict\";\nstart();</script>"));
}

TEST(Section, WithoutContentIsNone) { EXPECT_EQ(section_html("id", "Title", ""), ""); }

}  // namespace
}  // namespace palpate
