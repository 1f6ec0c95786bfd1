// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace palpate {

/// Four numbers side by side with the operators of one, for templates over `Real` that run with the
/// vector units of a host (multiversion.hpp); such a template must be inlined there as a whole.
/// Said to the compiler outright, because it seldom finds it in loops. A comparison holds if it
/// holds for all four: `!(a > b)` means that it fails for one of them at least, as it does with
/// NaN. So all four take one branch: a series for small numbers only if all are small, else the
/// formula for large ones, in which a small one keeps its absolute and not its relative digits.
class alignas(32) Pack {
public:
    static constexpr int size = 4;
    typedef double Register __attribute__((vector_size(size * sizeof(double)), aligned(32)));

    Pack() = default;
    Pack(double all) : value_{all, all, all, all} {}

    double operator[](int lane) const { return value_[lane]; }
    void set(int lane, double value) { value_[lane] = value; }

    friend Pack operator+(const Pack& a, const Pack& b) { return Pack(a.value_ + b.value_); }
    friend Pack operator-(const Pack& a, const Pack& b) { return Pack(a.value_ - b.value_); }
    friend Pack operator*(const Pack& a, const Pack& b) { return Pack(a.value_ * b.value_); }
    friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.value_ / b.value_); }
    friend Pack operator-(const Pack& a) { return Pack(-a.value_); }
    Pack& operator+=(const Pack& other) { return *this = *this + other; }
    Pack& operator-=(const Pack& other) { return *this = *this - other; }
    Pack& operator*=(const Pack& other) { return *this = *this * other; }

    friend bool operator>(const Pack& a, const Pack& b) { return all_of(a.value_ > b.value_); }
    friend bool operator<(const Pack& a, const Pack& b) { return all_of(a.value_ < b.value_); }
    friend bool operator==(const Pack& a, const Pack& b) { return all_of(a.value_ == b.value_); }

    friend Pack fabs(const Pack& a) { return Pack(a.value_ < 0 ? -a.value_ : a.value_); }
    friend Pack exp(const Pack& a) {
        return each(a, [](double x) { return std::exp(x); });
    }
    friend Pack expm1(const Pack& a) {
        return each(a, [](double x) { return std::expm1(x); });
    }
    friend Pack log(const Pack& a) {
        return each(a, [](double x) { return std::log(x); });
    }
    friend Pack log1p(const Pack& a) {
        return each(a, [](double x) { return std::log1p(x); });
    }

private:
    explicit Pack(const Register& value) : value_(value) {}
    template <class Mask>
    static bool all_of(const Mask& mask) {
        return (mask[0] & mask[1] & mask[2] & mask[3]) != 0;
    }
    template <class Function>
    static Pack each(const Pack& a, const Function& function) {
        Pack result;
        for (int lane = 0; lane < size; ++lane) result.value_[lane] = function(a.value_[lane]);
        return result;
    }

    Register value_;
};

}  // namespace palpate
