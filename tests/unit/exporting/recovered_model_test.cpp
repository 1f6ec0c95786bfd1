// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/export/recovered_model.hpp"

#include "host/apps/export/write_model.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/exporting/two_tet_model.hpp"
#include "tests/unit/report/temporary_folder.hpp"

namespace palpate {
namespace {

using testing::two_tet_model;

class RecoveredModelFolder : public TemporaryFolderTest {
protected:
    void write(const std::string& json) {
        write_model(two_tet_model(), WallLoad::displacement, folder / "mesh.vtu");
        std::ofstream(folder / "result.json") << json;
    }
    ErrorCode refusal() {
        try {
            read_recovered_model(folder);
        } catch (const Error& error) {
            return error.code();
        }
        return ErrorCode::internal;
    }
    const std::string good = R"({"version": "0.1.0", "material": "neo-hookean", "regions": [
        {"name": "background", "label": 0, "stiffness_kpa": 10, "poisson_ratio": 0.35},
        {"name": "7 of <nine> & more", "label": 5, "stiffness_kpa": 60, "poisson_ratio": 0.4},
        {"name": "bladder", "label": 2, "stiffness_kpa": null, "poisson_ratio": null}]})";
};

TEST_F(RecoveredModelFolder, GivesBackWhatWasWritten) {
    write(good);

    const RecoveredModel model = read_recovered_model(folder);

    EXPECT_EQ(model.law, TissueLaw{"neo-hookean"});
    ASSERT_EQ(model.regions.size(), 2u);  // hollow organs have no tetrahedra
    EXPECT_EQ(model.regions[1].token, "region_7_of_nine_more");
    EXPECT_EQ(model.regions[1].stiffness_kpa, 60);
    EXPECT_EQ(model.regions[1].tets, (std::vector<Index>{1}));
    EXPECT_EQ(model.nodes_that_are(Held::fixed), (std::vector<Index>{0, 1, 2}));
    EXPECT_EQ(model.nodes_that_are(Held::driven), (std::vector<Index>{4}));
    EXPECT_EQ(model.force[4], Vec3(1500, -20, 3));
}

TEST_F(RecoveredModelFolder, ThatIsDamagedIsRefused) {
    write("{");
    EXPECT_EQ(refusal(), ErrorCode::input_unreadable);
    write("{}");
    EXPECT_EQ(refusal(), ErrorCode::input_unreadable);
    write(std::string(100000, '['));
    EXPECT_EQ(refusal(), ErrorCode::input_unreadable);
    write(R"({"version": "1", "material": "linear", "regions": []})");
    EXPECT_EQ(refusal(), ErrorCode::input_unreadable);
    std::filesystem::remove(folder / "mesh.vtu");
    write_model(two_tet_model(), WallLoad::displacement, folder / "other.vtu");
    EXPECT_EQ(refusal(), ErrorCode::input_unreadable);
}

TEST_F(RecoveredModelFolder, OfQuadraticElementsIsRefused) {
    write(
        R"({"version": "1", "material": "linear", "regions": [], "mesh": {"element_type": "tet10"}})");

    EXPECT_EQ(refusal(), ErrorCode::unsupported);
}

}  // namespace
}  // namespace palpate
