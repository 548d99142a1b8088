// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/clouds/voxels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/pieces.hpp"

namespace surefoot::eval {
namespace {

using Eigen::Vector3f;

constexpr int kMostBits = 63;
/// Number of points that are numbered and distributed at once (kTaken), and number of buckets
/// (kBuckets). The voxels of a bucket are processed independently of other buckets.
constexpr std::size_t kTaken = 1U << 16U;
constexpr int kBucketBits = 9;
constexpr std::size_t kBuckets = 1U << kBucketBits;

/// Numbers the voxels of a box. The highest bits of a number come from x, the next from y, the
/// lowest from z.
class VoxelKeys {
  public:
    VoxelKeys(const geometry::PointBox& box, double size_m)
        : size_m_(size_m), low_(numbers(box.low_m)) {
        bits_ = (numbers(box.high_m) - low_).unaryExpr([](std::int64_t span) {
            return static_cast<std::int64_t>(std::bit_width(static_cast<std::uint64_t>(span)));
        });
    }
    [[nodiscard]] int bits() const noexcept { return static_cast<int>(bits_.sum()); }
    [[nodiscard]] std::uint64_t key(const Vector3f& p_m) const noexcept {
        const Numbers n = numbers(p_m) - low_;
        // in range: whole numbers already
        return static_cast<std::uint64_t>(((n.x() << bits_.y() | n.y()) << bits_.z()) | n.z());
    }

  private:
    using Numbers = Eigen::Matrix<std::int64_t, 3, 1>;
    [[nodiscard]] Numbers numbers(const Vector3f& p_m) const noexcept {
        return {voxel_number(p_m.x(), size_m_),
                voxel_number(p_m.y(), size_m_),
                voxel_number(p_m.z(), size_m_)};
    }

    double size_m_;
    Numbers low_;
    Numbers bits_ = Numbers::Zero();
};

/// Uninitialised on purpose: the code writes every entry before reading it, and the threads that
/// fill the memory touch it first.
struct Keyed {  // NOLINT(*-member-init)
    std::uint64_t key;
    Vector3f point_m;
};

/// Points grouped by the first bits of their voxel number; the order in a group is the original
/// order.
struct Dealt {
    std::unique_ptr<Keyed[]> points;  // NOLINT(*-avoid-c-arrays): a vector would fill it first
    std::vector<std::size_t> first;   ///< first entry of each bucket, and the end of the last
};

geometry::PointBox box_in_pieces(std::span<const Vector3f> points_m, Executor& executor) {
    std::vector<Vector3f> corners_m(2 * pieces_of(points_m.size(), kTaken));
    in_pieces(points_m.size(),
              kTaken,
              executor,
              [&](std::size_t begin, std::size_t end, std::size_t piece) {
                  const auto box = geometry::box_of(points_m.subspan(begin, end - begin));
                  corners_m[2 * piece] = box.low_m;
                  corners_m[2 * piece + 1] = box.high_m;
              });
    return geometry::box_of(corners_m);
}

Dealt deal(std::span<const Vector3f> points_m, const VoxelKeys& keys, Executor& executor) {
    const int shift = std::max(0, keys.bits() - kBucketBits);
    const std::size_t pieces = pieces_of(points_m.size(), kTaken);
    const auto each = [&](auto&& work) {
        const auto deal_piece = [&](std::size_t begin, std::size_t end, std::size_t piece) {
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint64_t key = keys.key(points_m[i]);
                work(piece * kBuckets + (key >> shift), key, points_m[i]);
            }
        };
        in_pieces(points_m.size(), kTaken, executor, deal_piece);
    };
    std::vector<std::size_t> next(pieces * kBuckets);
    each([&](std::size_t slot, std::uint64_t, const Vector3f&) { ++next[slot]; });
    Dealt dealt;
    std::size_t sum = 0;
    for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
        dealt.first.push_back(sum);
        for (std::size_t piece = 0; piece < pieces; ++piece) {
            const std::size_t count = next[piece * kBuckets + bucket];
            next[piece * kBuckets + bucket] = sum;
            sum += count;
        }
    }
    dealt.first.push_back(sum);
    dealt.points.reset(new Keyed[points_m.size()]);
    each([&](std::size_t slot, std::uint64_t key, const Vector3f& p_m) {
        dealt.points[next[slot]++] = {key, p_m};
    });
    return dealt;
}

std::vector<Vector3f> means_m(std::span<Keyed> points) {
    std::stable_sort(
        points.begin(), points.end(), [](const Keyed& a, const Keyed& b) { return a.key < b.key; });
    std::vector<Vector3f> means_m;
    for (std::size_t begin = 0, end = 0; begin < points.size(); begin = end) {
        Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
        for (end = begin; end < points.size() && points[end].key == points[begin].key; ++end)
            sum_m += points[end].point_m.cast<double>();
        means_m.push_back((sum_m / static_cast<double>(end - begin)).cast<float>());
    }
    return means_m;
}

}  // namespace

std::int64_t voxel_number(float p_m, double size_m) noexcept {
    // `fits_voxels` returns false for boxes whose voxel numbers would saturate.
    return saturated_integer<std::int64_t>(std::floor(static_cast<double>(p_m) / size_m));
}

bool fits_voxels(const geometry::PointBox& box, double size_m) {
    // Voxel numbers of 1e18 or more are refused. This limit is well below the largest std::int64_t.
    const float most_m = box.high_m.cwiseAbs().cwiseMax(box.low_m.cwiseAbs()).maxCoeff();
    return static_cast<double>(most_m) / size_m < 1e18 &&
           VoxelKeys(box, size_m).bits() <= kMostBits;
}

std::vector<Vector3f> voxel_means_m(std::span<const Vector3f> points_m,
                                    double size_m,
                                    Executor& executor) {
    SUREFOOT_ASSERT(size_m > 0.0);
    if (points_m.empty()) return {};
    const geometry::PointBox box = box_in_pieces(points_m, executor);
    SUREFOOT_ASSERT(fits_voxels(box, size_m));
    Dealt dealt = deal(points_m, VoxelKeys(box, size_m), executor);
    std::vector<std::vector<Vector3f>> by_bucket(kBuckets);
    executor.parallel_for(static_cast<int>(kBuckets), [&](int number) {
        const auto bucket = static_cast<std::size_t>(number);
        const std::size_t first = dealt.first[bucket];
        by_bucket[bucket] =
            means_m(std::span(dealt.points.get() + first, dealt.first[bucket + 1] - first));
    });
    std::vector<std::size_t> first;
    std::size_t count = 0;
    for (const auto& some_m : by_bucket) {
        first.push_back(count);
        count += some_m.size();
    }
    std::vector<Vector3f> all_m(count);
    executor.parallel_for(static_cast<int>(kBuckets), [&](int number) {
        const auto bucket = static_cast<std::size_t>(number);
        std::copy(by_bucket[bucket].begin(),
                  by_bucket[bucket].end(),
                  all_m.begin() + static_cast<std::ptrdiff_t>(first[bucket]));
    });
    return all_m;
}

}  // namespace surefoot::eval
