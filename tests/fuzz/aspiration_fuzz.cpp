// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/model/aspiration_settings.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    return fuzz_one([&] {
        const auto part = AspirationPart(size % 3);
        const AspirationSettings read =
            parse_aspiration_settings(text_of(data, size), "fuzz.toml", "/dev/null", part);
        if (part != AspirationPart::tissue) read.instrument.contours(180, 180);
    });
}
