// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "solver/backends/opencl/opencl_api.hpp"
#include "solver/backends/opencl/program_file.hpp"

namespace palpate {

/// One preprocessor define of a program: {"COLUMN_WIDTH", 4}.
struct Define {
    std::string name;
    long value = 0;
};

/// How often programs came from where.
struct ProgramCounts {
    int built = 0;   ///< compiled from source
    int loaded = 0;  ///< read from the folder
};

/// The one door to compiled programs of one device. Programs stay in memory; the folder keeps them
/// for the next process, keyed by the full source, the build options, the device, its driver and
/// platform versions and the format version. Thread-safe.
class ProgramCache {
public:
    ProgramCache(cl::Context context, cl::Device device, std::filesystem::path folder);

    /// The program of `kernels/<program>.cl` for a law with these defines. Throws
    /// Error(kernel_build_failed) with program, options and the complete build log.
    cl::Program get(const std::string& program, std::string_view law,
                    const std::vector<Define>& defines);
    /// The same of a program that knows but one law.
    cl::Program get(const std::string& program, const std::vector<Define>& defines) {
        return get(program, "linear", defines);
    }
    /// The same for a text that is not among the embedded ones; `name` is used in messages.
    cl::Program get_text(const std::string& name, const std::string& text,
                         const std::vector<Define>& defines);
    /// What identifies a compiled program.
    std::string key_of(const std::string& text, const std::vector<Define>& defines) const;
    ProgramCounts counts() const;

    /// A short text kept with the programs, for this device and driver only: what was measured.
    std::optional<std::string> recall(const std::string& name) const;
    void note(const std::string& name, const std::string& text) const;

private:
    cl::Program load_or_build(const std::string& name, const std::string& text,
                              const std::string& options, const std::string& key);
    bool load(const std::string& options, const std::string& key, cl::Program& program);
    cl::Program build(const std::string& name, const std::string& text, const std::string& options);

    cl::Context context_;
    cl::Device device_;
    ProgramFolder folder_;
    std::string device_key_;
    mutable std::mutex mutex_;
    std::map<std::string, cl::Program> programs_;
    ProgramCounts counts_;
};

}  // namespace palpate
