// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>

#include "tests/unit/report/temporary_folder.hpp"

namespace palpate {

inline constexpr const char* with_webgl = "--use-angle=swiftshader --enable-unsafe-swiftshader";
inline constexpr const char* without_webgl = "--disable-3d-apis";

/// Opens pages in a browser; skips where there is none.
class PageInBrowser : public TemporaryFolderTest {
protected:
    void SetUp() override {
        TemporaryFolderTest::SetUp();
        if (std::system("command -v chromium > /dev/null 2>&1") != 0)
            GTEST_SKIP() << "chromium is not installed, so the page cannot be opened";
    }

    /// The page as it is after its scripts have run.
    std::string opened(const std::string& html, const std::string& flags) {
        const std::filesystem::path page = folder / "report.html";
        std::ofstream(page) << html;
        const std::string command = "HOME='" + folder.string() +
                                    "' timeout 100 chromium --headless --no-sandbox --disable-gpu "
                                    "--disable-dev-shm-usage --virtual-time-budget=20000 " +
                                    flags + " --dump-dom 'file://" + page.string() +
                                    "' 2> /dev/null";
        std::string text;
        std::FILE* pipe = ::popen(command.c_str(), "r");
        std::array<char, 65536> block;
        while (const std::size_t n = std::fread(block.data(), 1, block.size(), pipe))
            text.append(block.data(), n);
        ::pclose(pipe);
        return text;
    }
    static std::string first_tag(const std::string& page) {
        const std::size_t at = page.find("<html");
        return at == std::string::npos ? "no page" : page.substr(at, page.find('>', at) - at);
    }

    /// The page with this script at its end, which may use `frame()` (a frame is drawn),
    /// `painted()` (pixels that the first viewer has painted, of a picture 300 wide), `colours()`
    /// (their sum of red less blue), and `tell(name, value)`.
    static std::string with_script(std::string html, const std::string& script) {
        const std::string functions = R"(
const frame = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
const pixels = () => {
  const canvas = document.querySelector(".stage canvas");
  const width = 300, height = Math.round(width * canvas.height / canvas.width);
  const context = element("canvas", { width, height }).getContext("2d", { willReadFrequently: true });
  context.drawImage(canvas, 0, 0, width, height);
  return context.getImageData(0, 0, width, height).data;
};
const painted = () => pixels().filter((value, i) => i % 4 === 3 && value > 0).length;
const colours = () => pixels().reduce((sum, v, i) => sum + (i % 4 === 0 ? v : i % 4 === 2 ? -v : 0), 0);
const tell = (name, value) => { document.documentElement.dataset[name] = String(value); };
)";
        // Frames as timers, which the browser's virtual time waits for.
        const std::string frames =
            "<script>window.requestAnimationFrame = (draw) => setTimeout(() => "
            "draw(performance.now()), 16);</script>";
        html.insert(html.rfind("</body>"),
                    "<script>" + functions + "(async () => { await frame();" + script +
                        "})().catch((e) => tell('test', 'failed: ' + e));</script>");
        return html.insert(html.find("<body>"), frames);
    }
    /// The number that `tell` said; -1: none.
    static double told(const std::string& page, const std::string& name) {
        const std::string tag = first_tag(page), attribute = "data-" + name + "=\"";
        const std::size_t at = tag.find(attribute);
        return at == std::string::npos ? -1 : std::stod(tag.substr(at + attribute.size()));
    }
};

}  // namespace palpate
