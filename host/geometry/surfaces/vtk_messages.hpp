// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate {

/// While it lives, what VTK would print to stderr is kept here instead, so that it can go into an
/// error. VTK's message window is global: one at a time, later ones wait.
class VtkMessages {
public:
    VtkMessages();
    ~VtkMessages();
    VtkMessages(const VtkMessages&) = delete;
    VtkMessages& operator=(const VtkMessages&) = delete;

    bool any() const;
    /// The last line, which says what is wrong; those before name VTK's source files.
    std::string last() const;
};

}  // namespace palpate
