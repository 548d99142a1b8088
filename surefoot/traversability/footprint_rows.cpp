// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/footprint_rows.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/traversability/footprint_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace surefoot::traversability::rows::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
constexpr int kLanes = LaneStatistics::kLanes;

/// Lanes [first, first + Lanes(d)) of the statistics, in registers while a run is added.
template <class D>
class Group {
  public:
    HWY_INLINE Group(D d, int first, const LaneStatistics& from)
        : d_(d),
          sum_(hn::Load(d, from.sum + first)),
          min_(hn::Load(half_, from.min + first)),
          max_(hn::Load(half_, from.max + first)) {}

    HWY_INLINE void take(const float* values) {
        const auto value = hn::LoadU(half_, values);
        const auto known = hn::IsFinite(value);
        // Uses comparisons instead of Min and Max, because these treat NaN differently on different
        // processors.
        min_ = hn::IfThenElse(hn::And(known, hn::Lt(value, min_)), value, min_);
        max_ = hn::IfThenElse(hn::And(known, hn::Gt(value, max_)), value, max_);
        sum_ = hn::Add(sum_, hn::PromoteTo(d_, hn::IfThenElseZero(known, value)));
        known_ += static_cast<std::int64_t>(hn::CountTrue(half_, known));
    }

    [[nodiscard]] HWY_INLINE bool is_below(float least) const {
        return !hn::AllFalse(half_, hn::Lt(min_, hn::Set(half_, least)));
    }

    HWY_INLINE void put_back(int first, LaneStatistics& to) const {
        hn::Store(sum_, d_, to.sum + first);
        hn::Store(min_, half_, to.min + first);
        hn::Store(max_, half_, to.max + first);
        to.known += known_;
    }

  private:
    using Half = hn::Rebind<float, D>;
    D d_;
    Half half_;
    hn::VFromD<D> sum_;
    hn::VFromD<Half> min_;
    hn::VFromD<Half> max_;
    std::int64_t known_ = 0;
};

/// Adds a run to the statistics. Returns true if the run holds a value below `least`.
HWY_INLINE bool add_run(const float* values,
                        std::int64_t count,
                        float least,
                        LaneStatistics& statistics) {
    const hn::CappedTag<double, kLanes> d;
    const std::int64_t whole = count / kLanes * kLanes;
    alignas(32) float rest[kLanes];
    for (std::int64_t k = 0; k < kLanes; ++k) {
        rest[k] = whole + k < count ? values[whole + k] : std::numeric_limits<float>::quiet_NaN();
    }
    bool below = false;
    for (int first = 0; first < kLanes; first += static_cast<int>(hn::Lanes(d))) {
        Group group(d, first, statistics);
        for (std::int64_t i = 0; i < whole; i += kLanes) group.take(values + i + first);
        if (whole + first < count) group.take(rest + first);
        below = group.is_below(least) || below;
        group.put_back(first, statistics);
    }
    return below;
}

std::int64_t add_runs_here(ImageView<const float> layer,
                           std::span<const grid::CellRun> runs,
                           LaneStatistics& statistics) {
    std::int64_t lowest = -1;
    float least = statistics.joined_min();
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const float* const row = layer.row(static_cast<int>(runs[i].iy));
        if (!add_run(row + runs[i].first, runs[i].cells(), least, statistics)) continue;
        least = statistics.joined_min();
        lowest = static_cast<std::int64_t>(i);
    }
    return lowest;
}

}  // namespace
}  // namespace surefoot::traversability::rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::traversability::rows {

HWY_EXPORT(add_runs_here);

namespace {

/// Joins eight lanes as ((0 4) (2 6)) ((1 5) (3 7)).
template <typename T, typename Join>
T joined(const T (&lanes)[LaneStatistics::kLanes], const Join& join) {
    return join(join(join(lanes[0], lanes[4]), join(lanes[2], lanes[6])),
                join(join(lanes[1], lanes[5]), join(lanes[3], lanes[7])));
}

}  // namespace

LaneStatistics::LaneStatistics() noexcept {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    std::fill_n(min, kLanes, kInfinity);
    std::fill_n(max, kLanes, -kInfinity);
}

double LaneStatistics::joined_sum() const noexcept {
    return joined(sum, [](double a, double b) { return a + b; });
}
float LaneStatistics::joined_min() const noexcept {
    return joined(min, [](float a, float b) { return b < a ? b : a; });
}
float LaneStatistics::joined_max() const noexcept {
    return joined(max, [](float a, float b) { return b > a ? b : a; });
}

std::int64_t add_runs(ImageView<const float> layer,
                      std::span<const grid::CellRun> runs,
                      LaneStatistics& statistics) noexcept {
    return HWY_DYNAMIC_DISPATCH(add_runs_here)(layer, runs, statistics);
}

}  // namespace surefoot::traversability::rows
#endif  // HWY_ONCE
