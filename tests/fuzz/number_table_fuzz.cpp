// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/number_table.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    return fuzz_one([&] {
        const NumberTable table = parse_number_table(text_of(data, size), "fuzz.csv");
        for (const std::string& column : table.columns)
            if (table.values(column).size() != table.lines.size()) std::abort();
    });
}
