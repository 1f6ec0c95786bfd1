// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/program_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr char magic[] = "palpate program1";  // the number is the format version
constexpr std::size_t magic_size = 16;        // no padding in EntryHeader
static_assert(sizeof(magic) == magic_size + 1);

// FNV-1a, 64 bits.
std::uint64_t hash_of(const void* data, std::size_t size,
                      std::uint64_t hash = 14695981039346656037ull) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 1099511628211ull;
    return hash;
}

struct EntryHeader {
    char magic_text[magic_size];
    std::uint64_t key_size;
    std::uint64_t binary_size;
    std::uint64_t checksum;  ///< of key and binary
};

EntryHeader header_of(std::string_view key, const unsigned char* binary, std::size_t size) {
    EntryHeader header = {};
    std::memcpy(header.magic_text, magic, magic_size);
    header.key_size = key.size();
    header.binary_size = size;
    header.checksum = hash_of(binary, size, hash_of(key.data(), key.size()));
    return header;
}

std::optional<ProgramBinary> unpack(const std::string& content, std::string_view key) {
    if (content.size() <= sizeof(EntryHeader) + key.size()) return std::nullopt;
    const char* stored_key = content.data() + sizeof(EntryHeader);
    if (std::string_view(stored_key, key.size()) != key) return std::nullopt;
    const auto* binary = reinterpret_cast<const unsigned char*>(stored_key + key.size());
    const std::size_t size = content.size() - sizeof(EntryHeader) - key.size();
    const EntryHeader expected = header_of(key, binary, size);
    if (std::memcmp(content.data(), &expected, sizeof(expected)) != 0) return std::nullopt;
    return ProgramBinary(binary, binary + size);
}

std::string unique_suffix() {
    static std::atomic<int> counter{0};
    return fmt::format(".{}.{}.new", getpid(), counter++);
}

}  // namespace

fs::path ProgramFolder::path_of(std::string_view key) const {
    return folder_ / fmt::format("{:016x}.program", hash_of(key.data(), key.size()));
}

std::optional<ProgramBinary> ProgramFolder::read(std::string_view key) const {
    if (folder_.empty()) return std::nullopt;
    std::ifstream file(path_of(key), std::ios::binary);
    if (!file) return std::nullopt;
    const std::string content((std::istreambuf_iterator<char>(file)),
                              std::istreambuf_iterator<char>());
    std::optional<ProgramBinary> binary = unpack(content, key);
    if (!binary) remove(key);
    return binary;
}

void ProgramFolder::write(std::string_view key, const ProgramBinary& binary) const {
    if (folder_.empty() || binary.empty()) return;
    std::error_code failed;
    fs::create_directories(folder_, failed);
    if (failed) return;
    const fs::path target = path_of(key);
    const fs::path temporary = target.string() + unique_suffix();
    std::ofstream file(temporary, std::ios::binary);
    const EntryHeader header = header_of(key, binary.data(), binary.size());
    file.write(reinterpret_cast<const char*>(&header), sizeof(header));
    file.write(key.data(), static_cast<std::streamsize>(key.size()));
    file.write(reinterpret_cast<const char*>(binary.data()),
               static_cast<std::streamsize>(binary.size()));
    file.close();
    if (file) fs::rename(temporary, target, failed);
    if (!file || failed) fs::remove(temporary, failed);
}

void ProgramFolder::remove(std::string_view key) const {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove(path_of(key), ignored);
}

fs::path default_cache_folder() {
    const auto set = [](const char* name) -> const char* {
        const char* value = std::getenv(name);
        return value && *value ? value : nullptr;
    };
    if (const char* own = set("PALPATE_CACHE_DIR")) return own;
    if (const char* xdg = set("XDG_CACHE_HOME")) return fs::path(xdg) / "palpate";
    if (const char* home = set("HOME")) return fs::path(home) / ".cache" / "palpate";
    return {};
}

}  // namespace palpate
