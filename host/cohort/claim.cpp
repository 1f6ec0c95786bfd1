// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/claim.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

enum class Locking { ours, of_another, impossible };

Locking lock_now(int descriptor) {
    while (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EINTR) continue;
        return errno == EWOULDBLOCK ? Locking::of_another : Locking::impossible;
    }
    return Locking::ours;
}

/// Whether the open file is still the one of this name: its holder may have removed it meanwhile.
bool is_the_file(int descriptor, const fs::path& file) {
    struct stat open {};
    struct stat named {};
    return ::fstat(descriptor, &open) == 0 && ::stat(file.c_str(), &named) == 0 &&
           open.st_ino == named.st_ino && open.st_dev == named.st_dev;
}

}  // namespace

std::optional<Claim> Claim::take(const fs::path& file) {
    for (;;) {
        const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (descriptor < 0)
            throw Error(ErrorCode::output_failed,
                        file.string() + " cannot be made (" + std::strerror(errno) + ")");
        if (lock_now(descriptor) == Locking::of_another) {
            ::close(descriptor);
            return std::nullopt;
        }
        if (is_the_file(descriptor, file)) return Claim(file, descriptor);
        ::close(descriptor);
    }
}

bool Claim::is_held(const fs::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor < 0) return false;
    const Locking found = lock_now(descriptor);
    ::close(descriptor);
    return found == Locking::of_another;
}

Claim::Claim(fs::path file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}

Claim::Claim(Claim&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

Claim& Claim::operator=(Claim&& other) noexcept {
    if (this == &other) return *this;
    release();
    file_ = std::move(other.file_);
    descriptor_ = std::exchange(other.descriptor_, -1);
    return *this;
}

Claim::~Claim() { release(); }

void Claim::release() {
    if (descriptor_ < 0) return;
    ::unlink(file_.c_str());
    ::close(std::exchange(descriptor_, -1));
}

}  // namespace palpate
