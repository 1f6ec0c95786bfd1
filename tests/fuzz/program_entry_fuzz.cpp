// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/program_file.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/fuzz_file.hpp"

/// An entry of the folder of compiled kernels: what was not written for this key is not given out.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    return fuzz_one([&] {
        const std::string key = "the key of a program";
        static const std::string name = [&] {  // which the folder chooses
            const ProgramFolder folder(fuzz_folder());
            folder.write(key, {1, 2, 3});
            return std::filesystem::directory_iterator(fuzz_folder())->path().filename().string();
        }();
        fuzz_file(name, data, size);
        ProgramFolder(fuzz_folder()).read(key);
    });
}
