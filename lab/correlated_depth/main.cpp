// SPDX-License-Identifier: Apache-2.0
// How strongly are the disparity errors of semi-global matching correlated on flat floor, and which
// share of the floor is matched?
// Usage: correlated_depth OUT_DIR [FIRST_SEED [SEEDS [NOISE [KEY=VALUE...]]]]
//   FIRST_SEED: default 1. SEEDS: number of seeds, default 4. NOISE: factor on the image noise,
//   default 1.0. KEY=VALUE: a setting of the matcher.
//
// Writes into OUT_DIR, per floor pattern:
//   correlation.csv  correlation of the errors by image axis and lag [px], and their sigma [px]
//   cells.csv        by range [m]: pixels per map cell, number of independent pixels among
//                    them, sigma of a pixel and of a cell mean [px]
//   floors.csv       share matched, share trusted, median stated sigma [px], correlation of the
//                    errors of two frames from the same pose
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "lab/drop_edges/zed_bench.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/elevation/sampling/pixel_filter.hpp"

namespace surefoot {
namespace {

using Eigen::Vector3d;

/// Sums for the autocorrelation of disparity errors at one lag.
struct Lag {
    double sum = 0.0;
    std::int64_t count = 0;
};

constexpr float kWrongMatch_px = 1.5F;
/// Largest outlier probability of a pixel that the map fuses.
constexpr auto kTrusted =
    static_cast<float>(elevation::PixelFilterConfig{}.max_outlier_probability);

/// Disparity errors on flat floor, pixel by pixel. NaN = no trusted match, or an error of at least
/// kWrongMatch_px.
Image<float> disparity_errors(const ZedBench& bench) {
    const auto& depth = bench.depth();
    Image<float> errors(depth.disparity_px.width(), depth.disparity_px.height());
    const double fb = bench.rectified().depth_to_disparity_px_m();
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const double truth_px = fb / static_cast<double>(bench.true_depth_m().data()[i]);
        const bool good = depth.outlier_probability.data()[i] <= kTrusted;
        const float error_px = depth.disparity_px.data()[i] - static_cast<float>(truth_px);
        // Wrong matches are excluded, because a few of them would dominate every sum of squares.
        errors.data()[i] = good && std::abs(error_px) < kWrongMatch_px ? error_px : NAN;
    }
    return errors;
}

/// Errors grouped by map cell at one range. Shows how much less the mean of a cell scatters than a
/// single pixel.
struct RangeBin {
    double pixel_sq = 0.0;
    std::int64_t pixels = 0;
    double cell_sq = 0.0;
    std::int64_t cells = 0;
};
constexpr int kRangeBins = 5;
constexpr double kBinWidth_m = 0.5;

void add_cells(const ZedBench& bench,
               const Pose& T_world_body,
               const Image<float>& errors,
               std::vector<RangeBin>& bins) {
    struct Sum {
        double error = 0.0;
        double square = 0.0;
        int count = 0;
        double range_m = 0.0;
    };
    constexpr int kSide = 400;
    std::vector<Sum> cells(static_cast<std::size_t>(kSide) * kSide);
    const auto& rig = bench.rectified();
    const Pose T_world_camera = T_world_body * rig.T_body_camera;
    for (int v = 0; v < errors.height(); ++v) {
        for (int u = 0; u < errors.width(); ++u) {
            const float error = errors.at(u, v);
            const double z = static_cast<double>(bench.true_depth_m().at(u, v));
            if (std::isnan(error) || !(z < 4.0)) continue;
            const Vector3d point =
                T_world_camera *
                Vector3d((u - rig.cx_px) / rig.fx_px * z, (v - rig.cy_px) / rig.fy_px * z, z);
            const int ix = static_cast<int>(std::floor(point.x() / kCellSize_m)) + kSide / 2;
            const int iy = static_cast<int>(std::floor(point.y() / kCellSize_m)) + kSide / 2;
            if (ix < 0 || iy < 0 || ix >= kSide || iy >= kSide) continue;
            Sum& sum = cells[static_cast<std::size_t>(iy) * kSide + static_cast<std::size_t>(ix)];
            sum.error += static_cast<double>(error);
            sum.square += static_cast<double>(error) * static_cast<double>(error);
            ++sum.count;
            sum.range_m = (point - T_world_camera.translation_m).norm();
        }
    }
    for (const Sum& sum : cells) {
        const auto bin = static_cast<int>(sum.range_m / kBinWidth_m) - 2;
        if (sum.count < 4 || bin < 0 || bin >= kRangeBins) continue;
        RangeBin& into = bins[static_cast<std::size_t>(bin)];
        const double mean = sum.error / sum.count;
        into.pixel_sq += sum.square;
        into.pixels += sum.count;
        into.cell_sq += mean * mean;
        ++into.cells;
    }
}

constexpr int kLags = 81;

/// Sums over all frames of one pattern.
struct FloorSums {
    std::vector<Lag> along_rows = std::vector<Lag>(kLags);
    std::vector<Lag> along_columns = std::vector<Lag>(kLags);
    std::vector<RangeBin> bins = std::vector<RangeBin>(kRangeBins);
    double cross = 0.0;   ///< sum of the products of the errors of two frames from one pose
    double square = 0.0;  ///< sum of the mean squared errors of both frames
    int pixels = 0;       ///< number of floor pixels that both cameras see
    int matched = 0;
    std::vector<float> trusted_sigma_px;
};

void add_lag(Lag& lag, float a, float b) {
    if (std::isnan(b)) return;
    lag.sum += static_cast<double>(a) * static_cast<double>(b);
    ++lag.count;
}

/// Adds the lower two thirds of the image, which show floor nearer than about 3 m.
void add_lags(const Image<float>& errors, const Image<float>& again, FloorSums& sums) {
    for (int v = errors.height() / 3; v < errors.height(); ++v) {
        for (int u = 0; u < errors.width(); ++u) {
            const float e = errors.at(u, v);
            if (std::isnan(e)) continue;
            if (const float f = again.at(u, v); !std::isnan(f)) {
                sums.cross += static_cast<double>(e * f);
                sums.square += static_cast<double>(0.5F * (e * e + f * f));
            }
            for (int lag = 0; lag < kLags; ++lag) {
                const auto l = static_cast<std::size_t>(lag);
                if (u + lag < errors.width()) add_lag(sums.along_rows[l], e, errors.at(u + lag, v));
                if (v + lag < errors.height())
                    add_lag(sums.along_columns[l], e, errors.at(u, v + lag));
            }
        }
    }
}

/// Counts the pixels in the lower two thirds of the image that both cameras see, and how many of
/// them are matched and trusted.
void add_matches(const ZedBench& bench, FloorSums& sums) {
    const auto& depth = bench.depth();
    const double fb = bench.rectified().depth_to_disparity_px_m();
    for (int v = depth.disparity_px.height() / 3; v < depth.disparity_px.height(); ++v) {
        for (int u = 0; u < depth.disparity_px.width(); ++u) {
            if (u < fb / static_cast<double>(bench.true_depth_m().at(u, v))) continue;
            ++sums.pixels;
            sums.matched += std::isnan(depth.disparity_px.at(u, v)) ? 0 : 1;
            if (depth.outlier_probability.at(u, v) <= kTrusted)
                sums.trusted_sigma_px.push_back(depth.sigma_px.at(u, v));
        }
    }
}

/// Adds two frames of flat floor with one pattern, from the same pose and with different noise.
void add_floor(ZedBench& bench, sim::Pattern pattern, int seed, FloorSums& sums) {
    Rng rng(mix_seed(static_cast<std::uint64_t>(seed), static_cast<std::uint64_t>(pattern)));
    sim::Scene scene;
    const int material = scene.add_material(zed_look(pattern, rng.next_u64()));
    scene.add_floor(sim::Floor({{-3.0, -5.0}, {9.0, 5.0}}, 0.0), material, material);
    const Pose T_world_body = bench.pose_over(rng.uniform(-0.5, 0.5));
    const std::uint64_t noise_seed = rng.next_u64();
    bench.see(scene, T_world_body, 0, noise_seed);
    const Image<float> errors = disparity_errors(bench);
    add_matches(bench, sums);
    bench.see(scene, T_world_body, 1, noise_seed);
    add_cells(bench, T_world_body, errors, sums.bins);
    add_lags(errors, disparity_errors(bench), sums);
}

void print_lags(fmt::ostream& file,
                const char* pattern,
                const char* axis,
                const std::vector<Lag>& lags) {
    const auto mean = [](const Lag& lag) {
        return lag.sum / static_cast<double>(std::max<std::int64_t>(lag.count, 1));
    };
    const double variance = mean(lags[0]);
    for (int lag = 0; lag < kLags; ++lag) {
        file.print("{},{},{},{:.4f},{:.4f}\n",
                   pattern,
                   axis,
                   lag,
                   mean(lags[static_cast<std::size_t>(lag)]) / variance,
                   std::sqrt(variance));
    }
}

void print_cells(fmt::ostream& file, const char* pattern, const std::vector<RangeBin>& bins) {
    for (int bin = 0; bin < kRangeBins; ++bin) {
        const RangeBin& b = bins[static_cast<std::size_t>(bin)];
        if (b.cells < 20) continue;
        const double pixel_var = b.pixel_sq / static_cast<double>(b.pixels);
        const double cell_var = b.cell_sq / static_cast<double>(b.cells);
        file.print("{},{:.2f},{:.1f},{:.3f},{:.4f},{:.4f}\n",
                   pattern,
                   (bin + 2.5) * kBinWidth_m,
                   static_cast<double>(b.pixels) / static_cast<double>(b.cells),
                   pixel_var / cell_var,
                   std::sqrt(pixel_var),
                   std::sqrt(cell_var));
    }
}

void print_floor(fmt::ostream& file, const char* pattern, FloorSums& sums) {
    std::vector<float>& sigmas = sums.trusted_sigma_px;
    const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
    std::nth_element(sigmas.begin(), middle, sigmas.end());
    const double pixels = sums.pixels;
    file.print("{},{:.4f},{:.4f},{:.3f},{:.3f}\n",
               pattern,
               sums.matched / pixels,
               static_cast<double>(sigmas.size()) / pixels,
               sigmas.empty() ? NAN : *middle,
               sums.cross / sums.square);
}

void measure_floors(ZedBench& bench, const std::string& out, int first_seed, int seeds) {
    auto lag_file = fmt::output_file(out + "/correlation.csv");
    lag_file.print("pattern,axis,lag_px,correlation,sigma_px\n");
    auto cell_file = fmt::output_file(out + "/cells.csv");
    cell_file.print("pattern,range_m,pixels_per_cell,independent,pixel_sigma_px,cell_sigma_px\n");
    auto floor_file = fmt::output_file(out + "/floors.csv");
    floor_file.print("pattern,matched,trusted,median_sigma_px,correlation_between_frames\n");
    for (int p = 0; p < sim::kPatterns; ++p) {
        FloorSums sums;
        for (int seed = first_seed; seed < first_seed + seeds; ++seed)
            add_floor(bench, static_cast<sim::Pattern>(p), seed, sums);
        const char* pattern = to_string(static_cast<sim::Pattern>(p));
        print_lags(lag_file, pattern, "row", sums.along_rows);
        print_lags(lag_file, pattern, "column", sums.along_columns);
        print_cells(cell_file, pattern, sums.bins);
        print_floor(floor_file, pattern, sums);
    }
}

}  // namespace
}  // namespace surefoot

// An uncaught exception ends the experiment and prints its message. This is intended.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    const auto arguments = surefoot::bench_arguments(argc, argv);
    if (!arguments) {
        fmt::print(stderr, "{}\n", arguments.error().message);
        return 2;
    }
    surefoot::Serial executor;
    surefoot::ZedBench bench(arguments->noise, arguments->matcher, executor);
    surefoot::measure_floors(bench, arguments->out_dir, arguments->first_seed, arguments->seeds);
    return 0;
}
