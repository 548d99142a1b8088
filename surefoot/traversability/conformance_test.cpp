// SPDX-License-Identifier: Apache-2.0
// The truth is the output of the published filters on a synthetic scene (floor, stairs, ramp, box,
// noise, holes); see ref.json beside the vectors.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/traversability/traversability.hpp"

namespace surefoot::traversability {
namespace {

constexpr int kSide = 240;
constexpr double kResolution_m = 0.025;
constexpr double kTolerance = 1e-5;  // ref.json, "tolerance"

std::string folder() {
    const char* set = std::getenv("SUREFOOT_DATA_DIR");
    const std::string root = set != nullptr ? set : SUREFOOT_DEFAULT_DATA_DIR;
    return root + "/conformance/traversability/";
}

/// Reads a layer. In the file, rows grow toward -x and columns toward -y; in Surefoot, columns grow
/// along +x and rows along +y.
std::optional<grid::Layer> read_layer(const std::string& name) {
    std::ifstream file(folder() + name, std::ios::binary);
    std::vector<float> values(static_cast<std::size_t>(kSide) * kSide);
    file.read(reinterpret_cast<char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(float)));
    if (!file) return std::nullopt;
    grid::Layer layer(kSide, kSide);
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            layer.at(kSide - 1 - i, kSide - 1 - j) =
                values[static_cast<std::size_t>(i * kSide + j)];
        }
    }
    return layer;
}

void expect_same(const grid::Layer& ours, const std::string& file) {
    const auto truth = read_layer("tiefree/" + file);
    ASSERT_TRUE(truth) << folder() << "tiefree/" << file << " cannot be read";
    int wrong = 0;
    int wrong_unknown = 0;
    double largest = 0.0;
    for (int iy = 0; iy < kSide; ++iy) {
        for (int ix = 0; ix < kSide; ++ix) {
            const float a = ours.at(ix, iy);
            const float b = truth->at(ix, iy);
            if (std::isnan(a) != std::isnan(b)) {
                ++wrong_unknown;
            } else if (!std::isnan(a)) {
                const double difference = std::abs(static_cast<double>(a) - static_cast<double>(b));
                largest = std::max(largest, difference);
                if (difference > kTolerance) ++wrong;
            }
        }
    }
    EXPECT_EQ(wrong_unknown, 0) << file << ": cells known here and unknown there, or the reverse";
    EXPECT_EQ(wrong, 0) << file << ": cells beyond " << kTolerance << ", largest " << largest;
    std::printf("%s: largest difference %.2g\n", file.c_str(), largest);
}

TraversabilityConfig tiefree(Combine combine) {
    TraversabilityConfig config;
    config.normals.radius_m = 0.08;
    config.slope.critical_rad = 0.7;
    config.step = {0.12, 0.06, 0.06, 4};
    config.roughness = {0.05, 0.08};
    config.combine = combine;
    return config;
}

TEST(TraversabilityConformance, PublishedFiltersAreReproduced) {
    const auto height_m = read_layer("elevation.f32");
    if (!height_m) {
        std::printf("skipped 1 check: no conformance vectors in %s\n", folder().c_str());
        return;
    }
    Serial serial;
    TraversabilityLayers layers;
    rate(tiefree(Combine::mean_nan), height_m->view(), kResolution_m, serial, layers);
    expect_same(layers.normal_x, "surface_normal_x.f32");
    expect_same(layers.normal_y, "surface_normal_y.f32");
    expect_same(layers.normal_z, "surface_normal_z.f32");
    expect_same(layers.slope, "traversability_slope.f32");
    expect_same(layers.step, "traversability_step.f32");
    expect_same(layers.roughness, "traversability_roughness.f32");
    expect_same(layers.traversability, "traversability.f32");

    rate(tiefree(Combine::zero_dominates), height_m->view(), kResolution_m, serial, layers);
    expect_same(layers.traversability, "traversability_weightedsum2017.f32");
}

}  // namespace
}  // namespace surefoot::traversability
