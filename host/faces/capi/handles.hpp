// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "solver/base/error.hpp"

// Handles of the C interface are numbers in the shape of pointers, never used twice, and looked up
// at each use: a handle that was freed, freed twice or never given out is an error, not a crash,
// and an object lives until the last call that uses it is over.
namespace palpate::capi {

/// Of all kinds: a handle of one kind is unknown among those of another.
inline std::uintptr_t next_handle() {
    static std::atomic<std::uintptr_t> count{0};
    return 0x1000 + 16 * ++count;
}

template <class Body>
class Handles {
public:
    static Handles& all() {
        static auto* handles = new Handles;  // outlives every exit handler
        return *handles;
    }
    Body* keep(std::unique_ptr<Body> body) {
        const std::uintptr_t handle = next_handle();
        const std::lock_guard lock(mutex_);
        bodies_.emplace(handle, std::move(body));
        return reinterpret_cast<Body*>(handle);
    }
    /// Null if there is none.
    std::shared_ptr<Body> find(const Body* handle) const {
        const std::lock_guard lock(mutex_);
        const auto found = bodies_.find(reinterpret_cast<std::uintptr_t>(handle));
        return found == bodies_.end() ? nullptr : found->second;
    }
    /// Whether there was one.
    bool release(const Body* handle) {
        std::shared_ptr<Body> last;  // ends outside of the lock
        const std::lock_guard lock(mutex_);
        const auto found = bodies_.find(reinterpret_cast<std::uintptr_t>(handle));
        if (found == bodies_.end()) return false;
        last = std::move(found->second);
        bodies_.erase(found);
        return true;
    }

private:
    mutable std::mutex mutex_;
    std::map<std::uintptr_t, std::shared_ptr<Body>> bodies_;
};

/// Turns a handle into its object, which lives at least as long as what is returned. Throws
/// Error(invalid_argument) if it is null or none.
template <class Body>
auto hold(Body*& handle, const char* what) {
    using Plain = std::remove_const_t<Body>;
    if (!handle) throw Error(ErrorCode::invalid_argument, std::string(what) + " is null");
    std::shared_ptr<Plain> body = Handles<Plain>::all().find(handle);
    if (!body)
        throw Error(ErrorCode::invalid_argument,
                    std::string(what) + " is no handle that is in use: was it freed?");
    handle = body.get();
    return body;
}

/// The object of a handle, or null.
template <class Body>
std::shared_ptr<Body> found(const Body* handle) {
    return Handles<Body>::all().find(handle);
}

/// Gives a handle back; null is allowed. Throws Error(invalid_argument) if it is none.
template <class Body>
void release(Body* handle, const char* what) {
    if (handle && !Handles<Body>::all().release(handle))
        throw Error(ErrorCode::invalid_argument,
                    std::string(what) + " is no handle that is in use: was it freed already?");
}

}  // namespace palpate::capi
