// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

namespace palpate {

/// Memory that a forked child shares with its parent; zeros at first.
class SharedMemory {
public:
    explicit SharedMemory(std::size_t num_bytes);
    ~SharedMemory();
    SharedMemory(const SharedMemory&) = delete;
    SharedMemory& operator=(const SharedMemory&) = delete;
    std::byte* data() const { return data_; }

private:
    std::byte* data_;
    std::size_t num_bytes_;
};

struct ReadingLimits {
    std::size_t memory_bytes = std::size_t(1)
                               << 30;  ///< beyond what the process has mapped already
    int seconds = 60;                  ///< processor time, and twice that by the clock
};

/// Runs `work` in a forked child, silenced and under limits, and waits for it: for code that may
/// crash on damaged input. `work` leaves its result in SharedMemory.
/// An Error thrown by `work` is thrown here again; any other exception, a signal or a limit becomes
/// Error(input_unreadable) with what happened. `tick` is called often; if it throws, the child is
/// killed first. The child dies with its parent and does not hear the signals that end it.
void run_in_child(const std::function<void()>& work, const ReadingLimits& limits = {},
                  const std::function<void()>& tick = {});

/// Runs `write`, which brings `num_bytes` to a file, in a child: for writers of other projects,
/// which print or crash when the disk is full. Throws Error(output_failed) if anything went wrong.
void write_in_child(const std::function<void()>& write, std::size_t num_bytes);

/// Runs `read`, which reads `path` with the reader of another project, in a child. That may crash,
/// complain, or write where it should not: what it reads must come here some other way.
/// Throws what `read` throws; a crash becomes Error(input_unreadable) naming the file.
void read_in_child(const std::filesystem::path& path, const std::function<void()>& read);

}  // namespace palpate
