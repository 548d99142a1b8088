// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/reference_update.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace surefoot::elevation {
namespace {

/// Relative tolerance from the notes of the vectors; NaN and infinity must match.
constexpr double kRelativeTolerance = 1e-5;

std::filesystem::path vectors_folder() {
    const char* data = std::getenv("SUREFOOT_DATA_DIR");
    return std::filesystem::path(data != nullptr ? data : SUREFOOT_DEFAULT_DATA_DIR) /
           "conformance/elevation";
}

template <typename T>
std::vector<T> read_raw(const std::string& name) {
    std::ifstream file(vectors_folder() / name, std::ios::binary | std::ios::ate);
    if (!file) return {};
    std::vector<T> values(static_cast<std::size_t>(file.tellg()) / sizeof(T));
    file.seekg(0);
    file.read(reinterpret_cast<char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(T)));
    return values;
}

/// The vectors' row 0 is the largest x and their column 0 the largest y.
void expect_same(const grid::Layer& layer,
                 const std::vector<float>& reference,
                 const std::string& name) {
    const auto n = static_cast<std::size_t>(layer.width());
    ASSERT_EQ(reference.size(), n * n) << name;
    int wrong = 0;
    int finite = 0;
    for (std::size_t row = 0; row < n; ++row) {
        for (std::size_t col = 0; col < n; ++col) {
            const double expected = static_cast<double>(reference[row * n + col]);
            const double actual = static_cast<double>(
                layer.at(static_cast<int>(n - 1 - row), static_cast<int>(n - 1 - col)));
            finite += std::isfinite(expected) ? 1 : 0;
            const bool same =
                std::isfinite(expected)
                    ? std::abs(actual - expected) <= kRelativeTolerance * std::abs(expected)
                    : (std::isnan(expected) ? std::isnan(actual) : actual == expected);
            if (!same && ++wrong <= 5) {
                ADD_FAILURE() << name << " row " << row << " col " << col << ": " << actual
                              << ", expected " << expected;
            }
        }
    }
    EXPECT_EQ(wrong, 0) << name;
    EXPECT_GT(finite, 0) << name << " has no finite value: the file was not read";
}

TEST(Reference, ReproducesTheReferenceVectors) {
    if (!std::filesystem::exists(vectors_folder())) {
        std::printf("skipped 1 check: no %s (set SUREFOOT_DATA_DIR)\n", vectors_folder().c_str());
        return;
    }
    // Times and moves as in steps.txt of the vectors.
    const std::vector<FuseStep> steps{{1000.1, 0.0, 0.0, read_raw<ReferencePoint>("cloud0.f32")},
                                      {1000.12, 0.0, 0.0, read_raw<ReferencePoint>("cloud1.f32")},
                                      {1000.3, 0.12, 0.0, read_raw<ReferencePoint>("cloud2.f32")}};
    const std::vector<FuseStepResult> results = run_fuse_steps({}, steps);
    ASSERT_EQ(results.size(), 3U);
    EXPECT_NEAR(results[2].geometry.origin_m.x(), 0.1 - 1.0, 1e-12) << "0.12 m moves by two cells";
    for (std::size_t k = 0; k < results.size(); ++k) {
        const std::string step = "step" + std::to_string(k);
        expect_same(
            results[k].elevation_m, read_raw<float>(step + "_elevation.f32"), step + " elevation");
        expect_same(
            results[k].variance_m2, read_raw<float>(step + "_variance.f32"), step + " variance");
        expect_same(results[k].time_s, read_raw<float>(step + "_time.f32"), step + " time");
    }
}

TEST(Reference, ForgetsACellWhoseVarianceExceedsTheMaximum) {
    ReferenceMap map({});
    const ReferencePoint vague[] = {{0.01F, 0.01F, 0.5F, 0.01F}};
    map.add(vague, 1000.1);
    const auto cell = map.geometry().cell_at(0.01, 0.01);
    ASSERT_TRUE(cell);
    EXPECT_TRUE(std::isinf(map.variance_m2().at(cell->ix, cell->iy)));
    const ReferencePoint next[] = {{0.01F, 0.01F, 0.1F, 1e-4F}};
    map.add(next, 1000.2);
    EXPECT_EQ(map.elevation_m().at(cell->ix, cell->iy), 0.1F) << "the next point overwrites";
}

TEST(Reference, PointsOutsideAndNanMovesChangeNothing) {
    ReferenceMap map({});
    const ReferencePoint outside[] = {{1.01F, 0.0F, 0.5F, 1e-4F}, {NAN, 0.0F, 0.5F, 1e-4F}};
    map.add(outside, 1000.1);
    map.move_to(NAN, 0.0);
    for (std::size_t i = 0; i < map.elevation_m().size(); ++i) {
        EXPECT_TRUE(std::isnan(map.elevation_m().data()[i]));
    }
}

}  // namespace
}  // namespace surefoot::elevation
