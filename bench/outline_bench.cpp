// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// How many frames of sucked tissue a second has one core outlines of? Rendered films of the suite
// of `palpate study aspiration-contours`, in memory, forth and back; figures in
// docs/performance.md.
//   outline    ContourTracker::add
//   published  the published method on the same frames
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "host/apps/aspirate/contours/contour_tracker.hpp"
#include "host/apps/aspirate/contours/published_outline.hpp"
#include "host/apps/aspirate/median.hpp"
#include "host/apps/study/aspiration_film.hpp"

namespace palpate {
namespace {

struct Size {
    const char* name;
    Index width, height;
};
constexpr Size sizes[] = {{"small", 180, 180}, {"large", 640, 480}};
constexpr Index num_frames = 40;
constexpr unsigned seed = 601;
constexpr double most_far = 1.5;  // rows from the truth

/// A film with its frames rendered.
struct Film {
    AspirationFilm truth;
    ContourSettings settings;
    std::vector<GreyFrame> frames;

    Film(const FilmScene& scene, const Size& size)
        : truth(scene, seed, num_frames, size.width, size.height),
          settings{size.width, size.height, truth.visible_rows(), true} {
        for (Index k = 0; k < num_frames; ++k) {
            const std::vector<std::uint8_t> grey = truth.frame(k);
            frames.push_back({size.width, size.height, {grey.begin(), grey.end()}});
        }
    }
    /// Forth and back again.
    Index frame_at(Index number) const {
        const Index place = number % (2 * num_frames - 2);
        return place < num_frames ? place : 2 * num_frames - 2 - place;
    }
};

/// Rows, the median over what has no flag.
double far_from_truth(const Film& film, Index frame, const Outline& outline) {
    const std::vector<double> truth = film.truth.outline(frame);
    std::vector<double> away{0};
    for (std::size_t x = 0; x < truth.size(); ++x)
        if (outline[x].flag == PointFlag::ok && truth[x] <= film.truth.visible_rows() - 6)
            away.push_back(std::abs(outline[x].row - truth[x]));
    return median(std::move(away));
}

template <typename Tracker>
void follow(benchmark::State& state, const FilmScene& scene, const Size& size, double allowed) {
    const Film film(scene, size);
    Tracker tracker(film.settings);
    double farthest = 0;
    for (Index k = 0; k < 2 * num_frames; ++k) {
        const Index frame = film.frame_at(k);
        farthest = std::max(farthest, far_from_truth(film, frame, tracker.add(film.frames[frame])));
    }
    if (farthest >= allowed) {
        state.SkipWithError("failed: the outline is not the film's");
        return;
    }
    Index number = 2 * num_frames;
    for (auto _ : state)
        benchmark::DoNotOptimize(tracker.add(film.frames[film.frame_at(number++)]).data());
    state.counters["frames"] =
        benchmark::Counter(double(state.iterations()), benchmark::Counter::kIsRate);
}

void register_all() {
    for (const FilmScene* scene : {&film_suite().front(), &film_suite().back()})
        for (const Size& size : sizes) {
            const std::string rest = (scene == &film_suite().front() ? "/noise/" : "/all_of_it/") +
                                     std::string(size.name);
            benchmark::RegisterBenchmark(("outline" + rest).c_str(), [=](benchmark::State& state) {
                follow<ContourTracker>(state, *scene, size, most_far);
            })->Unit(benchmark::kMicrosecond);
            benchmark::RegisterBenchmark(("published" + rest).c_str(), [=](benchmark::State&
                                                                               state) {
                follow<PublishedOutline>(state, *scene, size, HUGE_VAL);
            })->Unit(benchmark::kMicrosecond);
        }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
    palpate::register_all();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
