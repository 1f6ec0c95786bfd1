// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/mesher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <functional>
#include <sstream>

#include "host/geometry/meshing/exchange.hpp"
#include "host/geometry/meshing/mesh_checks.hpp"
#include "host/geometry/meshing/mesh_program.hpp"
#include "host/geometry/meshing/volume_job.hpp"
#include "host/io/files.hpp"
#include "host/system/child_program.hpp"
#include "solver/base/error.hpp"

namespace palpate {

namespace {

/// What TetGen aims at; where one fails, a little more or less may do.
struct TetgenAim {
    double radius_edge_ratio, min_dihedral_deg, max_dihedral_deg;
};
constexpr TetgenAim tetgen_aims[] = {{1.4, 15, 140}, {1.3, 18, 130}, {1.8, 10, 150}};
constexpr double on_border =
    1e-6;  ///< of the box: hull triangles that near lie on the image border
constexpr double list_limit_s = 10;  ///< for palpate-mesh --list

struct Request {
    const RegionSurface& surface;
    const RegionImage& image;
    const LabelField& field;
    const std::vector<Index>& hollow;
    const MesherOptions& options;
    const ProgressSink& progress;
    std::filesystem::path program;
    Index num_regions = 0;
};

void check_options(const MesherOptions& options) {
    const auto require = [](bool ok, const char* what) {
        if (!ok) throw Error(ErrorCode::invalid_argument, std::string("mesher: ") + what);
    };
    require(options.num_nodes >= 4, "num_nodes must be at least 4");
    require(std::isfinite(options.edge_length_mm) && options.edge_length_mm > 0,
            "edge_length_mm must be positive");
    require(std::isfinite(options.outer_edge_length_mm) &&
                options.outer_edge_length_mm >= options.edge_length_mm,
            "outer_edge_length_mm must be at least edge_length_mm");
    require(options.time_limit_s > 0 && options.time_limit_s < 1e6,
            "time_limit_s must be positive");
    require(options.memory_limit_gib > 0 && options.memory_limit_gib < 1e6,
            "memory_limit_gib must be positive");
}

Index count_regions(const RegionSurface& surface, const RegionImage& image) {
    Index largest = background_region;
    for (const auto& sides : surface.regions) largest = std::max({largest, sides[0], sides[1]});
    for (std::uint8_t region : image.voxels) largest = std::max<Index>(largest, region);
    return largest + 1;
}

std::string first_line(const std::string& text) {
    return text.substr(0, std::min(text.find('\n'), std::size_t(300)));
}

std::string why_child_failed(const ChildResult& result, const MesherOptions& options) {
    if (result.timed_out) return fmt::format("it took longer than {:g} s", options.time_limit_s);
    if (result.signal == SIGSEGV || result.signal == SIGABRT)
        return fmt::format(
            "it crashed (signal {}): triangles that cross each other are the usual cause",
            result.signal);
    if (result.signal != 0) return fmt::format("it was ended by signal {}", result.signal);
    if (!result.errors.empty()) return first_line(result.errors);
    return fmt::format("it ended with code {}", result.exit_code);
}

/// Runs one mesher on a job and returns what it wrote.
Exchange run_mesher(const Request& request, const std::string& mesher, const Exchange& job) {
    const PrivateFolder folder;
    const auto job_path = folder.path() / "job", reply_path = folder.path() / "reply";
    job.write(job_path);
    const ChildResult result = run_child(
        request.program, {mesher, job_path.string(), reply_path.string()},
        {request.options.time_limit_s, request.options.memory_limit_gib}, [&](double seconds) {
            report_progress(request.progress, "meshing", -1,
                            fmt::format("{}, {:.0f} s", mesher, seconds));
        });
    if (!result.ok())
        throw Error(result.timed_out ? ErrorCode::time_limit : ErrorCode::mesh_failed,
                    why_child_failed(result, request.options));
    return Exchange::read(reply_path);
}

RegionMesh to_region_mesh(const Exchange& reply) {
    RegionMesh result;
    result.mesh.nodes = reply.points("nodes");
    result.mesh.tets = reply.rows<4>("tets");
    result.mesh.region = reply.get<std::int32_t>("tet_regions");
    result.surface.triangles = reply.rows<3>("triangles");
    result.surface.regions = reply.rows<2>("triangle_regions");
    result.surface.on_image_border.assign(result.surface.triangles.size(), 0);
    if (!has_valid_indices(result)) throw Error(ErrorCode::mesh_failed, "its reply is damaged");
    return result;
}

Exchange common_job(const Request& request) {
    Exchange job;
    job.set("hollow", request.hollow);
    job.set("num_nodes", std::vector<Index>{request.options.num_nodes});
    job.set("outer_edge_length_mm", std::vector<double>{request.options.outer_edge_length_mm});
    return job;
}

RegionMesh with_tetgen(const Request& request, const TetgenAim& aim, std::string& name) {
    Exchange job = common_job(request);
    job.set_points("vertices", request.surface.vertices);
    job.set_rows("triangles", request.surface.triangles);
    job.set_rows("regions", request.surface.regions);
    job.set("radius_edge_ratio", std::vector<double>{aim.radius_edge_ratio});
    job.set("min_dihedral_deg", std::vector<double>{aim.min_dihedral_deg});
    job.set("max_dihedral_deg", std::vector<double>{aim.max_dihedral_deg});
    const Exchange reply = run_mesher(request, "tetgen", job);
    name = reply.text("mesher");
    RegionMesh result = to_region_mesh(reply);
    const auto& source = reply.get<std::int32_t>("triangle_source");
    if (source.size() != result.surface.triangles.size())
        throw Error(ErrorCode::mesh_failed, "its reply is damaged");
    for (std::size_t i = 0; i < source.size(); ++i)
        if (source[i] >= 0 && std::size_t(source[i]) < request.surface.on_image_border.size())
            result.surface.on_image_border[i] = request.surface.on_image_border[source[i]];
    return result;
}

/// Marks the triangles of the hull that lie on one plane of the image box (local frame).
void mark_image_border(RegionMesh& mesh, const Vec3& box) {
    for (std::size_t i = 0; i < mesh.surface.triangles.size(); ++i) {
        const auto& sides = mesh.surface.regions[i];
        if (sides[0] != outside_region && sides[1] != outside_region) continue;
        for (int axis = 0; axis < 3; ++axis)
            for (double plane : {0.0, box[axis]}) {
                const auto& t = mesh.surface.triangles[i];
                const bool all = std::all_of(t.begin(), t.end(), [&](Index node) {
                    return std::abs(mesh.mesh.nodes[node][axis] - plane) <= on_border * box[axis];
                });
                if (all) mesh.surface.on_image_border[i] = 1;
            }
    }
}

RegionMesh with_cgal(const Request& request, std::string& name) {
    Exchange job = common_job(request);
    job.set("edge_length_mm", std::vector<double>{request.options.edge_length_mm});
    add_sampled_field(request.image, request.field, request.options.edge_length_mm, job);
    const Exchange reply = run_mesher(request, "cgal", job);
    name = reply.text("mesher");
    RegionMesh result = to_region_mesh(reply);
    const BoxFrame frame(request.image.grid);
    mark_image_border(result, frame.size);
    for (Vec3& node : result.mesh.nodes) node = frame.to_lps(node);
    if (frame.is_left_handed()) {
        for (Tet& tet : result.mesh.tets) std::swap(tet[2], tet[3]);
        for (Triangle& triangle : result.surface.triangles) std::swap(triangle[1], triangle[2]);
    }
    return result;
}

/// One way to get a mesh and the volumes that the result must have.
struct Rung {
    std::string name;
    std::function<RegionMesh(std::string& mesher)> make;
    std::vector<double> expected_mm3;
};

std::vector<Rung> ladder(const Request& request) {
    std::vector<Rung> rungs;
    if (request.options.kind != MesherKind::cgal)
        for (const TetgenAim& aim : tetgen_aims)
            rungs.push_back(
                {"TetGen", [&](std::string& name) { return with_tetgen(request, aim, name); }, {}});
    if (request.options.kind != MesherKind::tetgen)
        rungs.push_back({"CGAL", [&](std::string& name) { return with_cgal(request, name); },
                         voxel_volumes(request.image, request.num_regions)});
    return rungs;
}

/// Throws if the mesh must not be used.
void accept(RegionMesh& mesh, const Rung& rung, const Request& request, MesherSummary& summary) {
    summary.quality = mesh_quality(mesh.mesh, request.num_regions);
    const std::vector<double> expected =
        rung.expected_mm3.empty() ? enclosed_volumes(request.surface, request.num_regions)
                                  : rung.expected_mm3;
    const std::string why = why_unusable(mesh, summary.quality, expected, request.hollow);
    if (!why.empty()) throw Error(ErrorCode::mesh_failed, "its mesh was refused: " + why);
    mesh.surface.vertices = mesh.mesh.nodes;
}

}  // namespace

RegionMesh make_mesh(const RegionSurface& surface, const RegionImage& image,
                     const LabelField& field, const std::vector<Index>& hollow,
                     const MesherOptions& options, MesherSummary* summary,
                     const ProgressSink& progress) {
    check_options(options);
    const auto start = std::chrono::steady_clock::now();
    Request request{
        surface, image, field, hollow, options, progress, find_mesh_program(options.program), 0};
    request.num_regions = count_regions(surface, image);

    MesherSummary result;
    bool only_time_ran_out = true;
    std::string last_reason;
    for (const Rung& rung : ladder(request)) {
        try {
            RegionMesh mesh = rung.make(result.mesher);
            accept(mesh, rung, request, result);
            result.seconds =
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            if (summary) *summary = result;
            return mesh;
        } catch (const Error& error) {
            if (error.code() != ErrorCode::mesh_failed && error.code() != ErrorCode::time_limit &&
                error.code() != ErrorCode::input_unreadable)
                throw;
            only_time_ran_out &= error.code() == ErrorCode::time_limit;
            const std::string reason = rung.name + ": " + error.what();
            if (reason == last_reason) continue;
            result.fallback += (result.fallback.empty() ? "" : "; ") + reason;
            last_reason = reason;
        }
    }
    throw Error(only_time_ran_out ? ErrorCode::time_limit : ErrorCode::mesh_failed,
                "no usable mesh could be made (" + result.fallback +
                    "); try another edge length or --mesher, or give a ready mesh with --mesh");
}

std::vector<std::string> available_meshers(const std::filesystem::path& program) {
    std::vector<std::string> names;
    try {
        const ChildResult result =
            run_child(find_mesh_program(program), {"--list"}, {list_limit_s, 2});
        std::istringstream lines(result.ok() ? result.output : std::string());
        for (std::string line; std::getline(lines, line);) names.push_back(line);
    } catch (const Error&) {
        // absent or not a program: no meshers
    }
    return names;
}

}  // namespace palpate
