// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/io/image.hpp"

namespace palpate {

/// The grid with its direction made exactly orthonormal (the nearest such matrix; left-handed ones
/// stay left-handed).
/// Throws Error(input_unusable) if the spacing is not positive, a number is not finite or beyond
/// 1e6 mm, or the axes are not at right angles (1e-3).
ImageGrid checked_grid(ImageGrid grid);

}  // namespace palpate
