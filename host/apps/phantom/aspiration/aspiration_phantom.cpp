// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/aspiration/aspiration_phantom.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "host/apps/phantom/aspiration/sucked_surface.hpp"
#include "host/io/output_folder.hpp"
#include "host/page/png.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using Nominal = AspirationNominal;

constexpr double true_sd_mm = 0.002;  // that profiles_true.csv gives its points
constexpr double visible_row =
    Nominal::base_row_px - 1000 * Nominal::rim_thickness_mm / Nominal::pixel_z_um;

/// A frame that was kept.
struct FilmMoment {
    double told_s;     ///< as the camera's clock says
    double reading_s;  ///< when it was, by the clock of the readings
};

std::vector<FilmMoment> moments_of(const AspirationTruth& truth) {
    RandomNumbers random(0x7475626533ull * 1000003ull + truth.seed);
    std::vector<FilmMoment> moments;
    for (int k = 0; double(k) / Nominal::rate_hz < truth.film_s; ++k) {
        const double told_s = double(k) / Nominal::rate_hz;
        const double taken_s = told_s + truth.jitter_s * random.normal() - truth.delay_s;
        if (k == 0 || !random.is_below(truth.dropped_part)) moments.push_back({told_s, taken_s});
    }
    return moments;
}

/// The row at which the camera sees the surface in a column,
///     r = (x - axis) pixel_r,   y = y_base - z(|r|) / pixel_z + (x - axis) tilt.
double row_of(const AspirationTruth& truth, const SuckedSurface& surface, double column,
              double reading_s) {
    const double x = column - truth.axis_column_px;
    const double r_mm = std::abs(x) * truth.pixel_r_um / 1000;
    const double z_mm = r_mm < 0.5 * Nominal::hole_diameter_mm ? surface.z_mm(r_mm, reading_s) : 0;
    return Nominal::base_row_px - 1000 * z_mm / truth.pixel_z_um + x * truth.tilt;
}

void write_frame(const fs::path& path, const std::vector<std::uint8_t>& grey, bool is_png) {
    std::ofstream out(path, std::ios::binary);
    const auto put = [&](const std::vector<std::uint8_t>& bytes) {
        out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    };
    if (is_png) {
        put(png_of(Nominal::width_px, Nominal::height_px, grey));
    } else {
        out << fmt::format("P5\n{} {}\n255\n", Nominal::width_px, Nominal::height_px);
        put(grey);
    }
    if (!out.flush())
        throw Error(ErrorCode::output_failed,
                    fmt::format("cannot write '{}': is the disk full?", path.string()));
}

void write_film(const AspirationTruth& truth, const SuckedSurface& surface,
                const std::vector<FilmMoment>& moments, bool is_png, const fs::path& folder,
                const ProgressSink& progress) {
    RandomNumbers random(0x7475626534ull * 1000003ull + truth.seed);
    const FilmLook look(truth.scene, truth.seed, Nominal::width_px, Nominal::height_px, visible_row,
                        random, Index(moments.size()), [&](Index frame, double column) {
                            return row_of(truth, surface, column, moments[frame].reading_s);
                        });
    make_folders(folder / "frames");
    for (std::size_t k = 0; k < moments.size(); ++k) {
        const EdgeRow edge = [&](double column) {
            return row_of(truth, surface, column, moments[k].reading_s);
        };
        write_frame(folder / "frames" / fmt::format("frame{:05d}.{}", k, is_png ? "png" : "pgm"),
                    look.frame(Index(k), edge, edge(truth.axis_column_px)), is_png);
        if (k % 20 == 0)
            report_progress(progress, "frames", double(k) / double(moments.size()), "rendering");
        check_cancelled(progress);
    }
}

std::string times_csv(const std::vector<FilmMoment>& moments) {
    std::string text = "time_s\n";
    for (const FilmMoment& moment : moments) text += fmt::format("{:.4f}\n", moment.told_s);
    return text;
}

std::string pressure_csv(const Suction& suction) {
    std::string text = "time_s,suction_mbar\n";
    for (std::size_t k = 0; k < suction.time_s.size(); ++k)
        text += fmt::format("{:.3f},{:.4f}\n", suction.time_s[k], 10 * suction.kpa[k]);
    return text;
}

/// What is told of lengths and times, as someone tells it who measured the instrument.
std::string true_profiles_csv(const AspirationTruth& truth, const SuckedSurface& surface,
                              const std::vector<FilmMoment>& moments) {
    std::string text = "time_s,r_mm,z_mm,sd_mm,flag\n";
    for (const FilmMoment& moment : moments)
        for (Index x = 0; x < Nominal::width_px; ++x) {
            const double r_mm = (double(x) - truth.axis_column_px) * Nominal::pixel_r_um / 1000;
            if (std::abs(r_mm) > 0.5 * Nominal::hole_diameter_mm) continue;
            const double row = row_of(truth, surface, double(x), moment.reading_s);
            const bool is_hidden = row > visible_row;
            const double z_mm = is_hidden
                                    ? 0.5 * Nominal::rim_thickness_mm
                                    : (Nominal::base_row_px - row) * Nominal::pixel_z_um / 1000;
            fmt::format_to(std::back_inserter(text), "{:.4f},{:.4f},{:.5f},{},{}\n", moment.told_s,
                           r_mm, z_mm, is_hidden ? 0.144 : true_sd_mm, is_hidden ? 2 : 0);
        }
    return text;
}

std::string settings_text(const AspirationTruth& truth) {
    const auto number = [&](double value, double sd) {
        return truth.is_perfect ? fmt::format("{}", value)
                                : fmt::format("{{value = {}, sd = {:.3g}}}", value, sd);
    };
    std::string text = fmt::format(
        "# Made by: palpate phantom aspiration --seed {}{}\n[instrument]\nhole_diameter_mm = {}\n"
        "edge_radius_mm = {}\nrim_thickness_mm = {}\nouter_diameter_mm = {}\n",
        truth.seed, truth.is_perfect ? " --perfect" : "", Nominal::hole_diameter_mm,
        number(Nominal::edge_radius_mm, Nominal::edge_radius_sd_mm), Nominal::rim_thickness_mm,
        Nominal::outer_diameter_mm);
    text += fmt::format(
        "pixel_r_um = {}\npixel_z_um = {}\nbase_row_px = {}\n[frames]\ntimes = \"times.csv\"\n"
        "[pressure]\ndelay_s = {}\n[tissue]\ndepth_mm = {}\nwidth_mm = {}\n",
        number(Nominal::pixel_r_um, Nominal::pixel_sd_part * Nominal::pixel_r_um),
        number(Nominal::pixel_z_um, Nominal::pixel_sd_part * Nominal::pixel_z_um),
        Nominal::base_row_px, number(0, Nominal::delay_sd_s), Nominal::depth_mm, Nominal::width_mm);
    return text;
}

std::string truth_json(const AspirationFigures& made) {
    const AspirationTruth& truth = made.truth;
    const FilmScene& scene = truth.scene;
    return nlohmann::ordered_json{{"format", "palpate-aspiration-truth"},
                                  {"format_version", 1},
                                  {"seed", truth.seed},
                                  {"is_perfect", truth.is_perfect},
                                  {"law", "veronda-westmann"},
                                  {"mu_kpa", truth.mu_kpa},
                                  {"gamma", truth.gamma},
                                  {"amplitude", truth.amplitude},
                                  {"time_s", truth.time_s},
                                  {"cap_mm", truth.cap_mm},
                                  {"edge_radius_mm", truth.edge_radius_mm},
                                  {"pixel_r_um", truth.pixel_r_um},
                                  {"pixel_z_um", truth.pixel_z_um},
                                  {"delay_s", truth.delay_s},
                                  {"axis_column_px", truth.axis_column_px},
                                  {"tilt", truth.tilt},
                                  {"peak_suction_kpa", truth.suction.peak_kpa()},
                                  {"travel_mm", made.travel_mm},
                                  {"frames", made.num_frames},
                                  {"scene",
                                   {{"noise", scene.noise},
                                    {"blur_px", scene.blur},
                                    {"falloff", scene.falloff},
                                    {"glares", scene.glares},
                                    {"bubbles", scene.bubbles},
                                    {"stains", scene.stains},
                                    {"jitter_s", truth.jitter_s},
                                    {"dropped_part", truth.dropped_part}}}}
               .dump(2) +
           "\n";
}

}  // namespace

AspirationFigures make_aspiration_phantom(const AspirationPhantomOptions& options,
                                          const fs::path& folder, const ProgressSink& progress) {
    AspirationFigures made;
    made.truth = draw_aspiration(options.seed, options.is_perfect);
    const SuckedSurface surface = simulate_aspiration(made.truth, progress);
    const std::vector<FilmMoment> moments = moments_of(made.truth);
    made.travel_mm = surface.travel_mm();
    made.num_frames = Index(moments.size());
    write_folder_atomically(folder, false, [&](const fs::path& inside) {
        write_film(made.truth, surface, moments, options.is_png, inside, progress);
        write_text_file(inside / "times.csv", times_csv(moments));
        write_text_file(inside / "pressure.csv", pressure_csv(made.truth.suction));
        write_text_file(inside / "profiles_true.csv",
                        true_profiles_csv(made.truth, surface, moments));
        write_text_file(inside / "aspiration.toml", settings_text(made.truth));
        write_text_file(inside / "truth.json", truth_json(made));
    });
    return made;
}

}  // namespace palpate
