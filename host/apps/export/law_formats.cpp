// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/export/law_formats.hpp"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "host/apps/export/engineering_units.hpp"
#include "solver/base/error.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

using Values = std::vector<double>;

/// 1/kPa in 1/MPa
double per_mpa(double per_kpa) { return 1 / mpa_from_kpa(1 / per_kpa); }

std::string elastic(const Values& p) {
    return fmt::format("*ELASTIC\n{:.12g}, {:.12g}\n", mpa_from_kpa(p[0]), p[1]);
}
/// W = C10 (J1 - 3) + (J - 1)^2 / D1
std::string neo_hooke(const Values& p) {
    return fmt::format("*HYPERELASTIC, NEO HOOKE\n{:.12g}, {:.12g}\n", mpa_from_kpa(p[0]),
                       per_mpa(2 / p[1]));
}
/// W = C10 (J1 - 3) + C20 (J1 - 3)^2 + (J - 1)^2 / D1. CalculiX puts a value of its own for a D2 of
/// 0; one so large adds nothing.
std::string reduced_polynomial(const Values& p) {
    return fmt::format("*HYPERELASTIC, REDUCED POLYNOMIAL, N=2\n{:.12g}, {:.12g}, {:.12g}, 1e12\n",
                       mpa_from_kpa(p[0]), mpa_from_kpa(p[1]), per_mpa(p[2]));
}
/// W = C10 (J1 - 3) + C20 (J1 - 3)^2 + C30 (J1 - 3)^3 + (J - 1)^2 / D1
std::string yeoh(const Values& p) {
    return fmt::format("*HYPERELASTIC, YEOH\n{:.12g}, {:.12g}, {:.12g}, {:.12g}, 1e12, 1e12\n",
                       mpa_from_kpa(p[0]), mpa_from_kpa(p[1]), mpa_from_kpa(p[2]),
                       per_mpa(2 / p[3]));
}

/// One line a law; what a program has no exact word for is null.
struct LawFormat {
    const char* law;
    const char* febio_type;
    std::string (*calculix)(const Values& parameters);
};
constexpr std::array formats{
    LawFormat{"linear", "isotropic elastic", elastic},
    LawFormat{"neo-hookean", "neo-Hookean", nullptr},
    LawFormat{"neo-hookean-reduced", nullptr, neo_hooke},
    LawFormat{"reduced-polynomial", nullptr, reduced_polynomial},
    LawFormat{"yeoh", nullptr, yeoh},
};

template <typename Word>
Word word_of(const TissueLaw& law, Word LawFormat::*word, const std::string& program) {
    std::string known;
    for (const LawFormat& format : formats) {
        if (!(format.*word)) continue;
        if (law.name == format.law) return format.*word;
        known += (known.empty() ? "" : ", ") + std::string(format.law);
    }
    throw Error(ErrorCode::unsupported,
                fmt::format("{} no law like {}, which this result was recovered with; export "
                            "another format, or recover with --material one of: {}",
                            program, law.name, known));
}

}  // namespace

std::string febio_material_type(const TissueLaw& law) {
    return word_of(law, &LawFormat::febio_type, "FEBio has");
}

std::string calculix_material(const TissueLaw& law, const SmallStrainModuli& moduli) {
    return word_of(law, &LawFormat::calculix,
                   "CalculiX and Abaqus have")(parameters_of_moduli(law.name, moduli));
}

}  // namespace palpate
