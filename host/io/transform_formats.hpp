// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

/// Lets ITK's transform reader and writer know .tfm, .txt and .h5. May be called any number of
/// times.
void register_transform_formats();

}  // namespace palpate
