// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/spatial_order.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/geometry/point_box.hpp"

namespace surefoot::geometry {
namespace {

constexpr int kBits = 10;

/// Inserts two zeros after each of ten bits.
std::uint32_t spread(std::uint32_t bits) noexcept {
    bits = (bits | bits << 16U) & 0x030000FFU;
    bits = (bits | bits << 8U) & 0x0300F00FU;
    bits = (bits | bits << 4U) & 0x030C30C3U;
    return (bits | bits << 2U) & 0x09249249U;
}

struct Keyed {
    std::uint32_t key;
    std::uint32_t index;
};

/// One pass of a radix sort (Knuth, volume 3, 5.2.5): stable, sorts by the ten bits from `shift`.
void sort_by_digit(std::span<const Keyed> from, std::span<Keyed> to, int shift) {
    std::array<std::uint32_t, 1U << kBits> next{};
    const auto digit = [&](const Keyed& k) { return k.key >> shift & ((1U << kBits) - 1U); };
    for (const Keyed& k : from) ++next[digit(k)];
    std::uint32_t sum = 0;
    for (std::uint32_t& n : next) sum += std::exchange(n, sum);
    for (const Keyed& k : from) to[next[digit(k)]++] = k;
}

}  // namespace

std::vector<std::uint32_t> spatial_order(std::span<const Eigen::Vector3f> points_m) {
    SUREFOOT_ASSERT(points_m.size() < 0xFFFFFFFFU);
    if (points_m.empty()) return {};
    const PointBox box = box_of(points_m);
    // All axes have one scale, so that the cells are cubes.
    const float side_m = (box.high_m - box.low_m).maxCoeff();
    constexpr float kCells = 1 << kBits;
    constexpr std::uint32_t kLast = (1U << kBits) - 1U;
    const float scale = side_m > 0.0F ? kCells / side_m : 0.0F;
    std::vector<Keyed> keyed(points_m.size());
    for (std::size_t i = 0; i < points_m.size(); ++i) {
        const Eigen::Vector3f cell = scale * (points_m[i] - box.low_m);
        const auto bits = [&](float c) {
            return spread(std::min(saturated_integer<std::uint32_t>(c), kLast));
        };
        keyed[i] = {bits(cell.x()) | bits(cell.y()) << 1U | bits(cell.z()) << 2U,
                    static_cast<std::uint32_t>(i)};
    }
    std::vector<Keyed> other(keyed.size());
    for (int pass = 0; pass < 3; ++pass) {
        sort_by_digit(keyed, other, kBits * pass);
        std::swap(keyed, other);
    }
    std::vector<std::uint32_t> order(keyed.size());
    std::transform(
        keyed.begin(), keyed.end(), order.begin(), [](const Keyed& k) { return k.index; });
    return order;
}

}  // namespace surefoot::geometry
