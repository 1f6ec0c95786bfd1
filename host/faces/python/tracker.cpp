// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <memory>
#include <mutex>

#include "host/faces/python/arrays.hpp"
#include "host/faces/python/call.hpp"
#include "host/faces/python/module.hpp"

namespace palpate_python {

using namespace nb::literals;

namespace {

using Bytes = nb::ndarray<const std::uint8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Words = nb::ndarray<const std::uint16_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

class Tracker {
public:
    Tracker(const std::string& settings, const std::string& folder, std::int32_t width,
            std::int32_t height)
        : width_(std::size_t(width)), height_(std::size_t(height)) {
        palpate_tracker* made = nullptr;
        check(palpate_tracker_create(settings.c_str(), folder.c_str(), width, height, &made));
        handle_.reset(made);
        columns_ = std::size_t(palpate_tracker_num_columns(made));
    }

    template <class Frame>
    nb::tuple add(const Frame& frame, std::int32_t white) {
        require_shape(frame.shape(0) == height_ && frame.shape(1) == width_,
                      "frames must have the height and width that the tracker was made for");
        Array z_mm = new_array({columns_}), sd_mm = new_array({columns_});
        auto* flags = new std::uint8_t[columns_]();
        nb::capsule owner(flags, [](void* p) noexcept { delete[] static_cast<std::uint8_t*>(p); });
        palpate_status status = PALPATE_OK;
        {
            nb::gil_scoped_release free;
            const std::lock_guard lock(mutex_);
            status = palpate_tracker_add(handle_.get(), frame.data(), white, z_mm.data(),
                                         sd_mm.data(), flags);
        }
        check(status);
        return nb::make_tuple(z_mm, sd_mm,
                              nb::ndarray<nb::numpy, std::uint8_t>(flags, {columns_}, owner));
    }

    /// (column of the axis, r in mm of each column, radius of the hole in mm)
    nb::tuple axis() const {
        double column = 0, radius_mm = 0;
        Array r_mm = new_array({columns_});
        palpate_status status = PALPATE_OK;
        {
            nb::gil_scoped_release free;
            const std::lock_guard lock(mutex_);
            status = palpate_tracker_axis(handle_.get(), &column, r_mm.data(), &radius_mm);
        }
        check(status);
        return nb::make_tuple(column, r_mm, radius_mm);
    }

private:
    struct Free {
        void operator()(palpate_tracker* tracker) const { palpate_tracker_free(tracker); }
    };
    std::unique_ptr<palpate_tracker, Free> handle_;
    mutable std::mutex mutex_;  ///< a handle is for one thread at a time
    std::size_t width_, height_, columns_ = 0;
};

}  // namespace

void add_tracker(nb::module_& m) {
    nb::class_<Tracker>(m, "Tracker")
        .def(nb::init<const std::string&, const std::string&, std::int32_t, std::int32_t>(),
             "settings"_a, "folder"_a, "width"_a, "height"_a)
        .def("add_bytes", &Tracker::add<Bytes>, "frame"_a, "white"_a)
        .def("add_words", &Tracker::add<Words>, "frame"_a, "white"_a)
        .def("axis", &Tracker::axis);
}

}  // namespace palpate_python
