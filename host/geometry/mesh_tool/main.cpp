// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// palpate-mesh: makes a mesh from a job file. A program of its own, because the libraries in it are
// under other licences (TetGen AGPL, CGAL meshing GPL) and may crash or hang on bad input.
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "host/geometry/mesh_tool/mesh_job.hpp"
#include "solver/base/error.hpp"

namespace {

using namespace palpate;
using namespace palpate::mesh_tool;

constexpr const char* usage =
    "palpate-mesh --list              which meshers this program holds\n"
    "palpate-mesh tetgen JOB REPLY    mesh the inside of a surface with TetGen\n"
    "palpate-mesh cgal JOB REPLY      mesh a labelled volume with CGAL\n"
    "It is started by palpate; JOB and REPLY are files in palpate's exchange format.\n";

int list() {
    for (const std::string& name : {tetgen_name(), cgal_name()})
        if (!name.empty()) std::printf("%s\n", name.c_str());
    return 0;
}

int run(const std::string& mesher, const std::string& job_path, const std::string& reply_path) {
    const Exchange job = Exchange::read(job_path);
    if (mesher == "tetgen" && !tetgen_name().empty())
        write_reply(reply_path, mesh_with_tetgen(read_surface_job(job)), tetgen_name());
    else if (mesher == "cgal" && !cgal_name().empty())
        write_reply(reply_path, mesh_with_cgal(read_volume_job(job)), cgal_name());
    else
        throw Error(ErrorCode::unsupported, "this program holds no mesher '" + mesher + "'");
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc == 2 && std::string(argv[1]) == "--list") return list();
        if (argc == 4) return run(argv[1], argv[2], argv[3]);
        std::fputs(usage, stderr);
        return exit_code_of(ErrorCode::invalid_argument);
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return exit_code_of(error.code());
    } catch (const std::bad_alloc&) {
        std::fputs("out of memory\n", stderr);
        return exit_code_of(ErrorCode::out_of_memory);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return exit_code_of(ErrorCode::internal);
    }
}
