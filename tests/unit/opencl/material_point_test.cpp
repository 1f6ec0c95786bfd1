// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "solver/backends/opencl/context.hpp"
#include "solver/backends/opencl/kernel_text.hpp"
#include "solver/backends/opencl/launch.hpp"
#include "tests/fixtures/materials.hpp"

// The device text of every law against its template in fp64.
namespace palpate {
namespace {

using namespace fixtures;

constexpr double double_tolerance = 1e-12;
constexpr double single_tolerance = 4e-5;  ///< turned by any angle, lambda up to ten times mu
constexpr int num_points = 331;            ///< no multiple of a work group
constexpr int num_materials = 3;

struct Case {
    std::string law;
    bool is_double;
    int num_columns;  ///< also the width of a work item
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.law; }

std::vector<Case> every_case() {
    std::vector<Case> cases;
    for (const std::string& law : material_names()) {
        cases.push_back({law, false, 1});
        cases.push_back({law, true, 4});
    }
    return cases;
}

std::string name_of(const testing::TestParamInfo<Case>& entry) {
    std::string name = entry.param.law + (entry.param.is_double ? "_double_" : "_single_") +
                       std::to_string(entry.param.num_columns);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

/// What the kernels read and write, in one precision.
template <typename Real>
struct Points {
    std::vector<Real> coefficients, gradients, directions;
    std::vector<int> region;
    std::vector<Real> energy, stress, tangent, parameter_energy, parameter_stress;
};

class MaterialPointTest : public testing::TestWithParam<Case> {
protected:
    void SetUp() override {
        try {
            device = open_device("");
        } catch (const Error& error) {
            GTEST_SKIP() << error.what();
        }
        if (GetParam().is_double && !device->has_double)
            GTEST_SKIP() << device->info.name << " has no double precision.";
        for (int k = 0; k < num_materials; ++k)
            parameters.push_back(random_parameters(description, random));
    }

    int num_columns() const { return GetParam().num_columns; }
    int num_parameters() const { return static_cast<int>(description.parameters.size()); }

    /// Points of all regions: moderate, near rest, and one that is not a state at all.
    template <typename Real>
    Points<Real> make_points() {
        Points<Real> points;
        for (const std::vector<double>& values : parameters)
            for (double number : material_coefficients(GetParam().law, values))
                points.coefficients.push_back(static_cast<Real>(number));
        for (int p = 0; p < num_points; ++p) {
            points.region.push_back(p % num_materials);
            const auto h = p % 2 ? moderate_gradient(random) : gradient_near_rest(random);
            for (double entry : h.m) points.gradients.push_back(static_cast<Real>(entry));
            for (int k = 0; k < num_columns(); ++k)
                for (double entry : random_tensor(random).m)
                    points.directions.push_back(static_cast<Real>(entry));
        }
        points.gradients.back() = std::numeric_limits<Real>::quiet_NaN();
        return points;
    }

    template <typename T>
    cl::Buffer buffer_of(std::vector<T>& numbers) {
        return {device->context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR,
                numbers.size() * sizeof(T), numbers.data()};
    }
    template <typename T>
    void read(const cl::Buffer& buffer, std::vector<T>& numbers) {
        device->queue.enqueueReadBuffer(buffer, CL_TRUE, 0, numbers.size() * sizeof(T),
                                        numbers.data());
    }

    cl::Program program(bool is_double) {
        return device->programs->get_text("material_point " + GetParam().law,
                                          program_text("material_point", GetParam().law),
                                          {{"REAL_IS_DOUBLE", is_double},
                                           {"HAS_DOUBLE", device->has_double},
                                           {"DEVICE_IS_CPU", device->is_cpu},
                                           {"COLUMN_WIDTH", num_columns()}});
    }

    template <typename Real>
    void run(Points<Real>& points) {
        constexpr Real nobody = -12345;
        points.energy.assign(num_points, nobody);
        points.stress.assign(num_points * 9, nobody);
        points.tangent.assign(num_points * 9 * num_columns(), nobody);
        points.parameter_energy.assign(num_points * num_parameters(), nobody);
        points.parameter_stress.assign(num_points * num_parameters() * 9, nobody);
        const auto coefficients = buffer_of(points.coefficients), region = buffer_of(points.region),
                   gradients = buffer_of(points.gradients),
                   directions = buffer_of(points.directions), energy = buffer_of(points.energy),
                   stress = buffer_of(points.stress), tangent = buffer_of(points.tangent),
                   by_parameter = buffer_of(points.parameter_energy),
                   stress_by_parameter = buffer_of(points.parameter_stress);
        const cl::Program built = program(std::is_same_v<Real, double>);
        const WorkSize size{1, num_points, {1, 64}};

        cl::Kernel kernel(built, "material_point");
        launch(device->queue, kernel, size, coefficients, region, gradients, directions, energy,
               stress, tangent, cl_int{num_points}, cl_int{num_columns()});
        cl::Kernel parameter_kernel(built, "material_point_parameters");
        launch(device->queue, parameter_kernel, size, coefficients, region, gradients, by_parameter,
               stress_by_parameter, cl_int{num_points});

        read(energy, points.energy);
        read(stress, points.stress);
        read(tangent, points.tangent);
        read(by_parameter, points.parameter_energy);
        read(stress_by_parameter, points.parameter_stress);
    }

    /// Nine numbers from `first`, every `stride`-th.
    template <typename Real>
    static Tensor3<double> tensor_at(const std::vector<Real>& numbers, int first, int stride = 1) {
        Tensor3<double> t;
        for (int i = 0; i < 9; ++i) t.m[i] = numbers[first + i * stride];
        return t;
    }

    void note(const Tensor3<double>& actual, const Tensor3<double>& expected, double size) {
        Tensor3<double> difference = actual;
        for (int i = 0; i < 9; ++i) difference.m[i] -= expected.m[i];
        note(norm(difference), size);
    }
    void note(double difference, double size) {
        const double error = std::abs(difference) / size;
        worst = std::isfinite(error) ? std::max(worst, error) : 1e300;
    }

    /// Errors are relative to energy, stress and tangent; for derivatives by a parameter to what a
    /// change of that parameter by its own size could do.
    template <class Law, typename Real>
    void compare_point(const Law& law, const Points<Real>& points, int p) {
        const auto state = law.state(tensor_at(points.gradients, 9 * p));
        const double energy = law.energy(state);
        const Tensor3<double> stress = law.stress(state);
        note(points.energy[p] - energy, energy);
        note(tensor_at(points.stress, 9 * p), stress, norm(stress));
        for (int k = 0; k < num_columns(); ++k) {
            const int first = 9 * p * num_columns() + k;
            const Tensor3<double> tangent =
                law.tangent_apply(state, tensor_at(points.directions, first, num_columns()));
            note(tensor_at(points.tangent, first, num_columns()), tangent, norm(tangent));
        }
        for (int k = 0; k < num_parameters(); ++k) {
            const int row = num_parameters() * p + k;
            const double value = parameters[points.region[p]][k];
            const double energy_slope = law.parameter_energy(state, k);
            const Tensor3<double> stress_slope = law.parameter_stress(state, k);
            note(points.parameter_energy[row] - energy_slope,
                 std::max(std::abs(energy_slope), energy / value));
            note(tensor_at(points.parameter_stress, 9 * row), stress_slope,
                 std::max(norm(stress_slope), norm(stress) / value));
        }
    }

    template <typename Real>
    void compare(double tolerance) {
        Points<Real> points = make_points<Real>();

        run(points);

        for (int p = 0; p + 1 < num_points; ++p) {
            with_material_law<double>(GetParam().law, parameters[p % num_materials],
                                      [&](const auto& law) { compare_point(law, points, p); });
        }
        RecordProperty("worst", std::to_string(worst * 1e12) + "e-12");
        EXPECT_LE(worst, tolerance);
        EXPECT_EQ(points.energy.back(), std::numeric_limits<Real>::infinity());
        for (int i = 0; i < 9; ++i) {
            EXPECT_EQ(points.stress[9 * (num_points - 1) + i], 0);
            EXPECT_EQ(points.tangent[9 * (num_points - 1) * num_columns() + i], 0);
        }
    }

    const MaterialDescription& description = material_law(GetParam().law);
    std::mt19937 random{5};
    std::shared_ptr<OpenclDevice> device;
    std::vector<std::vector<double>> parameters;
    double worst = 0;
};

TEST_P(MaterialPointTest, ComputesWhatTheTemplateDoes) {
    if (GetParam().is_double)
        compare<double>(double_tolerance);
    else
        compare<float>(single_tolerance);
}

INSTANTIATE_TEST_SUITE_P(EveryLaw, MaterialPointTest, testing::ValuesIn(every_case()), name_of);

}  // namespace
}  // namespace palpate
