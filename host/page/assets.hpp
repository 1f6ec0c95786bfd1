// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace palpate {

/// Files of `assets/`, compiled in (EmbedText.cmake).
std::string_view page_css();
std::string_view page_html_template();
std::string_view page_parts_js();
std::string_view slice_viewer_js();
std::string_view surface_camera_js();
std::string_view surface_data_js();
std::string_view surface_renderer_js();
std::string_view surface_viewer_js();

}  // namespace palpate
