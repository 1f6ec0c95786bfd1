// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <string>

#include "host/apps/identify/experiment.hpp"
#include "tests/unit/report/temporary_folder.hpp"

namespace palpate {

class ExperimentTest : public TemporaryFolderTest {
protected:
    void SetUp() override {
        TemporaryFolderTest::SetUp();
        write("pull.csv", "time_s,force_mn\n0.5,1\n1,2\n");
    }
    void write(const std::string& name, const std::string& text) {
        std::ofstream(folder / name) << text;
    }
    Experiment experiment(const std::string& text) const {
        return Experiment::parse(text, "e.toml", folder);
    }

    /// A strip between grips; its force at two times.
    static std::string strip(const std::string& stiffness, const std::string& data) {
        return "title = \"Strip\"\n[mesh]\nformulation = \"plane-stress\"\nthickness_mm = 2\n"
               "rectangle = {size_mm = [10, 4], divisions = [4, 2]}\n"
               "[[material]]\nlaw = \"neo-hookean\"\nstiffness_kpa = " +
               stiffness +
               "\npoisson_ratio = 0.3\n"
               "[[fix]]\nname = \"left\"\nwhere = {side = \"x-min\"}\n"
               "[[move]]\nname = \"right\"\nwhere = {side = \"x-max\"}\nx_mm = 1\ny_mm = 0\n"
               "column = \"pull\"\n[history]\ntime_s = [0.5, 1]\npull = [0.5, 1]\n[[data]]\n" +
               data;
    }
    inline static const std::string force =
        "kind = \"force\"\nfile = \"pull.csv\"\non = \"right\"\ncomponent = \"x\"\nsd_mn = 0.5\n";
};

}  // namespace palpate
