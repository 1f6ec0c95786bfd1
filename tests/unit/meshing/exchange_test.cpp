// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/exchange.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "host/io/files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

Exchange sample() {
    Exchange exchange;
    exchange.set_points("nodes", {{1, 2, 3}, {4, 5, 6.5}});
    exchange.set_rows("tets", std::vector<Tet>{{0, 1, 2, 3}});
    exchange.set("values", std::vector<float>{1.5f, -2});
    exchange.set("nothing", std::vector<std::int32_t>{});
    exchange.set_text("name", "TetGen");
    return exchange;
}

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void put(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

TEST(Exchange, returns_what_was_written) {
    const PrivateFolder folder;
    const auto path = folder.path() / "a";
    sample().write(path);
    const Exchange back = Exchange::read(path);
    EXPECT_EQ(back.points("nodes")[1], Vec3(4, 5, 6.5));
    EXPECT_EQ(back.rows<4>("tets")[0], (Tet{0, 1, 2, 3}));
    EXPECT_EQ(back.get<float>("values"), (std::vector<float>{1.5f, -2}));
    EXPECT_TRUE(back.get<std::int32_t>("nothing").empty());
    EXPECT_EQ(back.text("name"), "TetGen");
}

TEST(Exchange, refuses_an_array_of_another_type_or_width) {
    const Exchange exchange = sample();
    EXPECT_THROW(exchange.get<double>("values"), Error);
    EXPECT_THROW(exchange.get<float>("values", 2), Error);
    EXPECT_THROW(exchange.get<float>("absent"), Error);
}

TEST(Exchange, refuses_a_file_cut_at_any_byte) {
    const PrivateFolder folder;
    const auto path = folder.path() / "a";
    sample().write(path);
    const std::string whole = bytes_of(path);
    for (std::size_t length = 0; length < whole.size(); ++length) {
        put(path, whole.substr(0, length));
        EXPECT_THROW(Exchange::read(path), Error) << "cut at " << length;
    }
    put(path, whole + "x");
    EXPECT_THROW(Exchange::read(path), Error);
}

TEST(Exchange, survives_any_damaged_byte) {
    const PrivateFolder folder;
    const auto path = folder.path() / "a";
    sample().write(path);
    const std::string whole = bytes_of(path);
    int refused = 0;
    for (std::size_t at = 0; at < whole.size(); ++at) {
        for (char mask : {char(1), char(0x80)}) {
            std::string damaged = whole;
            damaged[at] = static_cast<char>(damaged[at] ^ mask);
            put(path, damaged);
            try {
                Exchange::read(path);
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::input_unreadable);
                ++refused;
            }
        }
    }
    EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace palpate
