// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/frames/pgm_picture.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    return fuzz_one([&] {
        Index depth = 0;
        const GreyFrame frame = parse_pgm({data, data + size}, depth);
        if (Index(frame.grey.size()) != frame.width * frame.height) std::abort();
    });
}
