// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/point_table.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/fuzz_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    return fuzz_one([&] {
        const PointTable table = read_points(fuzz_file("points.csv", data, size), PointAxes::lps);
        points_csv(table, std::vector<MovedPoint>(table.points.size()), PointAxes::ras);
    });
}
