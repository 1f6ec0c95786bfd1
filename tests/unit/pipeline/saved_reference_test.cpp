// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/saved_reference.hpp"
#include "host/apps/recover/pipeline/search_target.hpp"

#include <fmt/format.h>

#include <random>

#include "host/apps/recover/modelling/regions.hpp"
#include "host/apps/recover/pipeline/byte_stream.hpp"
#include "host/apps/recover/pipeline/saved_reference_file.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/unit/report/temporary_folder.hpp"

namespace palpate {
namespace {

constexpr double box_mm = 64;
constexpr std::size_t hash_at = 24, content_at = 32;  // as the header is laid out

Settings two_balls() {
    return parse_settings(
        "[background]\nstiffness_kpa = 10.0\n"
        "[[organ]]\nname = \"ball\"\nlabel = 1\nrole = \"tissue\"\nstiffness_kpa = \"unknown\"\n"
        "[[organ]]\nname = \"balloon\"\nlabel = 2\nrole = \"driven\"\n",
        "two balls");
}

Index label_at(const Vec3& x, double balloon_mm) {
    if ((x - Vec3(38, 32, 32)).norm() < 12) return 1;
    return (x - Vec3(14, 32, 32)).norm() < balloon_mm ? 2 : 0;
}

Segmentation volume(double balloon_mm) {
    Segmentation result;
    result.name = "volume";
    ImageGrid& grid = result.labels.grid;
    grid.size = {32, 32, 32};
    grid.spacing = Vec3::Constant(box_mm / 32);
    grid.origin = grid.spacing / 2;
    for (Index k = 0; k < 32; ++k) {
        for (Index j = 0; j < 32; ++j) {
            for (Index i = 0; i < 32; ++i) {
                const Vec3 x = grid.to_point(Vec3(i, j, k));
                result.labels.voxels.push_back(static_cast<std::uint16_t>(label_at(x, balloon_mm)));
            }
        }
    }
    return result;
}

BodyMesh cubes(const LabelledState& state, const Settings& settings) {
    Mesh mesh = fixtures::box_mesh({12, 12, 12}, Vec3::Constant(box_mm));
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        Vec3 centre = Vec3::Zero();
        for (const Index node : mesh.tets[t]) centre += mesh.nodes[node] / 4;
        mesh.region[t] = label_at(centre, 9);
    }
    return body_mesh(with_region_numbers(solid_mesh_of(mesh), settings, "cubes"), state.field,
                     settings);
}

RecoverOptions host_options() {
    RecoverOptions options;
    options.settings = two_balls();
    options.solver.method = LinearMethod::direct;
    options.align = AlignMethod::none;
    return options;
}

PreparedReference prepare(const RecoverOptions& options) {
    const Settings& settings = options.settings;
    ReferenceState reference{make_state(volume(9), settings), 0, {}, {}};
    BodyMesh mesh = cubes(reference.state, settings);
    MesherSummary mesher;
    mesher.mesher = "cubes";
    mesher.quality = mesh_quality(corner_mesh_of(mesh.mesh), settings.num_regions());
    auto maps = maps_of_matched(reference.state.field, settings, own_margin_mm);
    StageTimer timer;
    return prepare_reference(std::move(reference), std::move(mesh), std::move(mesher),
                             std::move(maps), options, timer, {});
}

class SavedReferenceFile : public TemporaryFolderTest {
protected:
    static void SetUpTestSuite() {
        options = new RecoverOptions(host_options());
        prepared = new PreparedReference(prepare(*options));
    }
    static void TearDownTestSuite() {
        delete prepared;
        delete options;
    }
    void SetUp() override {
        TemporaryFolderTest::SetUp();
        file = folder / "ball.reduced";
        write_saved_reference(saved_form(*prepared, options->settings), file);
    }

    static PreparedReference restored(const std::filesystem::path& path) {
        SavedReference saved = read_saved_reference(path);
        LabelledState state = make_state(volume(9), options->settings);
        check_same_reference(saved, state, options->settings);
        ReferenceState reference = reference_state(saved, std::move(state));
        return restore(std::move(saved), std::move(reference), *options);
    }
    static void put(const std::filesystem::path& path, const std::string& bytes) {
        std::ofstream(path, std::ios::binary) << bytes;
    }
    /// The message with which `action` fails; it must be an Error with this code.
    template <typename Action>
    static std::string refusal(ErrorCode code, const Action& action) {
        try {
            action();
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), code) << error.what();
            return error.what();
        }
        return "no error";
    }
    static std::string refusal_of(const std::filesystem::path& path) {
        return refusal(ErrorCode::input_unreadable, [&] { read_saved_reference(path); });
    }
    /// Why the file is not taken for this reference.
    std::string difference(const LabelledState& state, const Settings& settings) const {
        return refusal(ErrorCode::input_unusable,
                       [&] { check_same_reference(read_saved_reference(file), state, settings); });
    }

    static inline RecoverOptions* options = nullptr;
    static inline PreparedReference* prepared = nullptr;
    std::filesystem::path file;
};

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

Recovered found_with(const PreparedReference& prepared, const RecoverOptions& options) {
    const TargetState target =
        align_target(make_state(volume(10.5), options.settings), prepared.reference, options, {});
    StageTimer timer;
    return search_target(prepared, target, start_target_shapes(target, options.settings), options,
                         timer, {});
}

TEST_F(SavedReferenceFile, AFinerMeshThatFailsIsToldOfAndCostsNoAnswer) {
    PreparedReference again = restored(file);
    EXPECT_EQ(found_with(again, *options).mesh_change.size(),
              3 * again.mechanics.recovery.observed.size());
    LinearSolverOptions few;
    few.backend = "reference";
    few.max_iterations = 1;
    few.max_refinements = 1;
    again.finer_mesh = std::make_shared<FinerMesh>(again.mesh, options->settings, few);

    const Recovered found = found_with(again, *options);

    EXPECT_EQ(found.mesh_change.size(), 0);
    EXPECT_TRUE(found.estimate.termination.converged);
    ASSERT_EQ(found.warnings.size(), 1u);
    EXPECT_NE(found.warnings[0].find("size of the elements"), std::string::npos);
}

TEST_F(SavedReferenceFile, GivesTheSameAnswersToTheLastBit) {
    const PreparedReference again = restored(file);

    const Recovered first = found_with(*prepared, *options), second = found_with(again, *options);

    ASSERT_EQ(first.estimate.theta.size(), 1);
    EXPECT_EQ(first.estimate.theta, second.estimate.theta);
    EXPECT_EQ(first.estimate.interval_kpa, second.estimate.interval_kpa);
    EXPECT_EQ(first.displacement, second.displacement);
    EXPECT_EQ(first.force, second.force);
}

TEST_F(SavedReferenceFile, HoldsEveryPartOfTheReducedModel) {
    const PreparedReference again = restored(file);

    const auto &a = prepared->mechanics.response.parts(), &b = again.mechanics.response.parts();
    EXPECT_EQ(a.prior_covariance, b.prior_covariance);
    EXPECT_EQ(a.spread, b.spread);
    EXPECT_EQ(a.influence, b.influence);
    EXPECT_EQ(a.root_tolerance, b.root_tolerance);
    EXPECT_EQ(a.left_out_mm, b.left_out_mm);
    EXPECT_EQ(prepared->mechanics.walls.walls()[0].covariance,
              again.mechanics.walls.walls()[0].covariance);
    EXPECT_EQ(again.mesher.mesher, "cubes");
    EXPECT_EQ(again.mechanics.condensation.solver.library,
              prepared->mechanics.condensation.solver.library);
    EXPECT_EQ(again.mechanics.condensation.columns, prepared->mechanics.condensation.columns);
}

TEST_F(SavedReferenceFile, WithoutAnyOfItsEndIsRefused) {
    const std::string bytes = content_of(file);
    for (const std::size_t size :
         {std::size_t{0}, std::size_t{5}, std::size_t{8}, std::size_t{31}, content_at,
          content_at + 7, bytes.size() / 3, bytes.size() / 2, bytes.size() - 1}) {
        put(file, bytes.substr(0, size));

        EXPECT_TRUE(holds(refusal_of(file), "ball.reduced")) << size;
    }
    put(file, bytes + "x");
    EXPECT_TRUE(holds(refusal_of(file), "damaged"));
}

TEST_F(SavedReferenceFile, WithAFlippedByteIsRefused) {
    const std::string bytes = content_of(file);
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < content_at + 64; ++k) places.push_back(k);
    for (std::size_t k = 1; k < 20; ++k) places.push_back(k * (bytes.size() - 1) / 19);
    for (const std::size_t place : places) {
        std::string damaged = bytes;
        damaged[place] = static_cast<char>(damaged[place] ^ 0x41);
        put(file, damaged);

        EXPECT_NE(refusal_of(file), "no error") << place;
    }
}

TEST_F(SavedReferenceFile, DamagedWithARightChecksumIsReadOrRefusedButNeverCrashes) {
    const std::string bytes = content_of(file);
    std::mt19937 random(7);
    int refused = 0;
    for (int trial = 0; trial < 60; ++trial) {
        std::string damaged = bytes;
        const std::size_t reach = trial % 3 == 0 ? bytes.size() - content_at : 1500;
        for (int flip = 0; flip < 2; ++flip) {
            damaged[content_at + random() % reach] = static_cast<char>(random());
        }
        const std::uint64_t hash = content_hash(std::span(damaged).subspan(content_at));
        std::memcpy(damaged.data() + hash_at, &hash, sizeof hash);
        put(file, damaged);
        try {
            restored(file);
        } catch (const Error&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 10);
}

TEST_F(SavedReferenceFile, WithAHugeLengthAndARightChecksumIsRefusedBeforeAllocating) {
    std::string damaged = content_of(file);
    for (const std::uint64_t length : {std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
        std::memcpy(damaged.data() + content_at, &length, sizeof length);
        const std::uint64_t hash = content_hash(std::span(damaged).subspan(content_at));
        std::memcpy(damaged.data() + hash_at, &hash, sizeof hash);
        put(file, damaged);

        EXPECT_TRUE(holds(refusal_of(file), "length"));
    }
}

TEST_F(SavedReferenceFile, OfAnotherKindIsRefused) {
    put(folder / "notes.txt", "a text that is longer than the header of a saved reduced model");

    EXPECT_TRUE(holds(refusal_of(folder / "notes.txt"), "no saved reduced model"));
    EXPECT_TRUE(holds(refusal_of(folder / "nowhere"), "no such file"));
    EXPECT_TRUE(holds(refusal_of(folder), "no such file"));
}

TEST_F(SavedReferenceFile, SaysWhichSettingDiffers) {
    Settings settings = options->settings;
    settings.organs[0].poisson_ratio = 0.45;

    const std::string message = difference(make_state(volume(9), settings), settings);

    EXPECT_TRUE(holds(message, "ball")) << message;
    EXPECT_TRUE(holds(message, "poisson_ratio = 0.45")) << message;
}

TEST_F(SavedReferenceFile, DoesNotMindTheNoiseThatOnlyTheSearchReads) {
    Settings settings = options->settings;
    settings.prior.noise_voxels = 0.5;

    EXPECT_EQ(difference(make_state(volume(9), settings), settings), "no error");
}

TEST_F(SavedReferenceFile, SaysThatTheReferenceDiffers) {
    const Settings& settings = options->settings;
    Segmentation moved = volume(9);
    moved.labels.grid.origin[0] += 1;

    EXPECT_TRUE(holds(difference(make_state(volume(9.5), settings), settings), "labels"));
    EXPECT_TRUE(holds(difference(make_state(moved, settings), settings), "grid"));
}

TEST_F(SavedReferenceFile, OnlyReplacesItsOwnKindAndOnlyWhenAsked) {
    put(folder / "thesis.txt", "years of work");
    const auto refused = [&](const std::filesystem::path& path, bool overwrite) {
        return refusal(ErrorCode::output_failed,
                       [&] { check_saved_reference_path(path, overwrite); });
    };

    EXPECT_TRUE(holds(refused(file, false), "--overwrite"));
    EXPECT_EQ(refused(file, true), "no error");
    EXPECT_TRUE(holds(refused(folder / "thesis.txt", true), "not replaced"));
    EXPECT_TRUE(holds(refused(folder / "nowhere" / "new", false), "folder that exists"));
    EXPECT_EQ(refused(folder / "new", false), "no error");
}

}  // namespace
}  // namespace palpate
