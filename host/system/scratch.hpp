// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

/// Makes one private LockedFolder for all temporary files of this program and of those that it
/// starts (TMPDIR points to it from here on), to be removed when the program ends. Where none can
/// be made everything stays as it is.
void make_scratch();

}  // namespace palpate
