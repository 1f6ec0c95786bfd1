// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

struct RecoveryResult;

/// Why a person should look at a case, the gravest first.
enum class CaseFlag : std::uint8_t {
    failed,
    not_converged,
    folded,             ///< an element of the mesh is turned inside out
    same_images,        ///< the target has the labels of the reference
    far_off,            ///< a surface ends more than half a voxel from its target, on average
    low_overlap,        ///< Dice below 0.95 after the deformation
    unlike_the_others,  ///< ln E more than 3.5 robust z from the patient's other pairs
    volume_changed,     ///< an organ's volume differs by more than 30 % between the images
    contradicts_prior,  ///< the images say what was hardly expected beforehand
    not_identifiable,
    cut_by_image,
    other_mesher,  ///< the first mesher failed
    weak,
    slow,  ///< more than 3 times the median of the cohort
};
inline constexpr std::size_t num_case_flags = 14;

/// A set of flags: bit k for flag k.
class CaseFlags {
public:
    void add(CaseFlag flag) { bits_ |= 1u << static_cast<unsigned>(flag); }
    bool has(CaseFlag flag) const { return bits_ >> static_cast<unsigned>(flag) & 1u; }
    std::uint32_t bits() const { return bits_; }
    bool operator==(const CaseFlags&) const = default;

private:
    std::uint32_t bits_ = 0;
};

/// As people read it.
const char* name_of(CaseFlag flag);
std::optional<CaseFlag> case_flag_of(std::string_view name);
/// Sorts cases, the worst first: the sum of what each flag weighs. Those that failed come last:
/// there is nothing to see of them.
int badness(CaseFlags flags);

/// Those that a result by itself shows: all but `failed`, `unlike_the_others` and `slow`.
CaseFlags flags_of_result(const RecoveryResult& result);

/// Position by position whether a value of ln E is more than 3.5 robust z,
///   |x - median| / (1.4826 MAD),
/// from the others (Iglewicz and Hoaglin 1993); of fewer than five, and not below an sd of 0.05,
/// nobody is.
std::vector<bool> unlike_the_others(const std::vector<double>& ln_e);

}  // namespace palpate
