// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Empty: the object library that holds precompiled headers needs a source.
