// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vtkNew.h>

#include <filesystem>

#include "host/io/files.hpp"
#include "host/system/forked_work.hpp"
#include "solver/base/error.hpp"

namespace palpate {

/// For files that VTK's readers of other formats may crash on, or write past their arrays: a child
/// reads the file with `read(path)` and hands over what came of it as a copy in VTK's XML format,
/// which `read_copy(copy)` reads in this process; returns what that returns.
/// Throws what they throw; a crash becomes Error(input_unreadable) naming the file.
template <typename Writer, typename Read, typename ReadCopy>
auto read_by_copy(const std::filesystem::path& path, const Read& read, const ReadCopy& read_copy) {
    const PrivateFolder folder;
    const std::filesystem::path copy = folder.path() / "copy";
    read_in_child(path, [&] {
        const auto data = read(path);
        vtkNew<Writer> writer;
        writer->SetFileName(copy.c_str());
        writer->SetInputData(data);
        writer->SetDataModeToAppended();
        writer->EncodeAppendedDataOff();
        writer->SetCompressorTypeToNone();
        if (writer->Write() != 1)
            throw Error(ErrorCode::output_failed,
                        "cannot copy '" + path.string() + "' to '" + folder.path().string() +
                            "' for reading; check free space and permissions");
    });
    return read_copy(copy);
}

}  // namespace palpate
