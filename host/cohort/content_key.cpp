// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/content_key.hpp"

#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr int key_format = 1;

class Sha256 {
public:
    Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
        require(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
    }
    void add(const char* data, std::size_t size) {
        require(EVP_DigestUpdate(context_.get(), data, size) == 1);
    }
    std::string hex() {
        std::array<unsigned char, 32> bytes{};
        require(EVP_DigestFinal_ex(context_.get(), bytes.data(), nullptr) == 1);
        std::string text;
        for (const unsigned char byte : bytes) {
            text += "0123456789abcdef"[byte >> 4];
            text += "0123456789abcdef"[byte & 15];
        }
        return text;
    }

private:
    static void require(bool good) {
        if (!good) throw Error(ErrorCode::internal, "OpenSSL computes no SHA-256 here");
    }
    std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

}  // namespace

std::string sha256_of(std::string_view bytes) {
    Sha256 hash;
    hash.add(bytes.data(), bytes.size());
    return hash.hex();
}

std::string sha256_of_file(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    Sha256 hash;
    std::vector<char> block(1 << 18);
    while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0)
        hash.add(block.data(), static_cast<std::size_t>(in.gcount()));
    if (!in.eof())
        throw Error(ErrorCode::input_unreadable, path.string() + ": it cannot be read to its end");
    return hash.hex();
}

CaseKeys::CaseKeys(const KeyParts& parts) {
    const auto text = [](const nlohmann::json& json) { return json.dump(); };
    before_reference_ = "{\"key_format\":" + text(key_format) +
                        ",\"numerics_version\":" + text(numerics_version) +
                        ",\"options\":" + text(parts.options) + ",\"reference\":\"";
    before_target_ = "\",\"settings\":" + text(parts.settings_toml) + ",\"target\":\"";
    before_transform_ =
        std::string("\",") + (parts.is_test_stub ? "\"test_stub\":true," : "") + "\"transform\":\"";
}

std::string CaseKeys::key(const std::string& reference_sha256, const std::string& target_sha256,
                          const std::string& transform_sha256) const {
    return sha256_of(before_reference_ + reference_sha256 + before_target_ + target_sha256 +
                     before_transform_ + transform_sha256 + "\"}");
}

std::string case_key(const KeyParts& parts) {
    return CaseKeys(parts).key(parts.reference_sha256, parts.target_sha256, parts.transform_sha256);
}

}  // namespace palpate
