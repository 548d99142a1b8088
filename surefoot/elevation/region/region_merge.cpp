// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/region/region_merge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace surefoot::elevation {
namespace {

using grid::MapRegion;

/// One cell of a region.
struct KnownCell {
    float height_m;
    float height_var_m2;
    std::uint32_t count;
    std::int64_t seen_ns;
    float horizontal_drift_m;
    float highest_m;
    float lowest_m;
    float clearance_m;
    float confidence;
    float density_ratio;

    [[nodiscard]] Height height() const {
        return {static_cast<double>(height_m), static_cast<double>(height_var_m2)};
    }
};

KnownCell load(const MapRegion& r, std::size_t i) {
    return {r.height_m.data()[i],
            r.height_var_m2.data()[i],
            r.count.data()[i],
            r.seen_ns.data()[i],
            r.horizontal_drift_m.data()[i],
            r.highest_m.data()[i],
            r.lowest_m.data()[i],
            r.clearance_m.data()[i],
            r.confidence.data()[i],
            r.density_ratio.data()[i]};
}

void store(MapRegion& r, std::size_t i, const KnownCell& cell) {
    r.height_m.data()[i] = cell.height_m;
    r.height_var_m2.data()[i] = cell.height_var_m2;
    r.count.data()[i] = cell.count;
    r.seen_ns.data()[i] = cell.seen_ns;
    r.horizontal_drift_m.data()[i] = cell.horizontal_drift_m;
    r.highest_m.data()[i] = cell.highest_m;
    r.lowest_m.data()[i] = cell.lowest_m;
    r.clearance_m.data()[i] = cell.clearance_m;
    r.confidence.data()[i] = cell.confidence;
    r.density_ratio.data()[i] = cell.density_ratio;
}

/// True if cell `a` goes before cell `b`: the later observation goes first. At equal times the
/// smaller variance goes first, then the higher cell.
bool goes_before(const KnownCell& a, const KnownCell& b) {
    if (a.seen_ns != b.seen_ns) return a.seen_ns > b.seen_ns;
    if (a.height_var_m2 != b.height_var_m2) return a.height_var_m2 < b.height_var_m2;
    return a.height_m > b.height_m;
}

/// Returns the smaller value. If one value is NaN, returns the other value.
float least(float a, float b) {
    return std::isnan(a) || b < a ? b : a;
}
float most(float a, float b) {
    return std::isnan(a) || b > a ? b : a;
}

/// Merges two cells that agree; `later` goes before `earlier`.
KnownCell agreed(const FusionConfig& fusion,
                 RegionErrors errors,
                 const KnownCell& later,
                 const KnownCell& earlier) {
    KnownCell cell = later;
    if (errors == RegionErrors::shared) {
        if (earlier.height_var_m2 < later.height_var_m2) {
            cell.height_m = earlier.height_m;
            cell.height_var_m2 = earlier.height_var_m2;
        }
        cell.count = std::max(later.count, earlier.count);
    } else {
        // Calls `fuse` without an upper limit, so that it does not lower a variance above the limit
        // of the live map.
        FusionConfig unbounded = fusion;
        unbounded.max_height_var_m2 = std::numeric_limits<double>::infinity();
        const Height fused = fuse(unbounded, later.height(), earlier.height()).cell;
        cell.height_m = static_cast<float>(fused.z_m);
        cell.height_var_m2 = static_cast<float>(fused.var_m2);
        constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
        cell.count = later.count > kMost - earlier.count ? kMost : later.count + earlier.count;
    }
    if (later.seen_ns == earlier.seen_ns) {
        cell.horizontal_drift_m = most(later.horizontal_drift_m, earlier.horizontal_drift_m);
        cell.confidence = least(later.confidence, earlier.confidence);
    }
    cell.highest_m = most(later.highest_m, earlier.highest_m);
    cell.lowest_m = least(later.lowest_m, earlier.lowest_m);
    cell.clearance_m = least(later.clearance_m, earlier.clearance_m);
    cell.density_ratio = most(later.density_ratio, earlier.density_ratio);
    return cell;
}

/// Merges two cells that disagree: two surfaces, or a surface that moved. The later cell stays, and
/// its variance grows.
KnownCell disagreed(const KnownCell& later, const KnownCell& earlier) {
    KnownCell cell = later;
    const double apart_m =
        static_cast<double>(later.height_m) - static_cast<double>(earlier.height_m);
    cell.height_var_m2 =
        static_cast<float>(static_cast<double>(later.height_var_m2) + apart_m * apart_m);
    return cell;
}

/// Merges two cells. Cell `theirs` must be known.
KnownCell merged(const FusionConfig& fusion,
                 RegionErrors errors,
                 const KnownCell& ours,
                 const KnownCell& theirs,
                 MergeCounts& counts) {
    if (std::isnan(ours.height_m)) {
        ++counts.taken;
        return theirs;
    }
    const bool ours_first = goes_before(ours, theirs);
    const KnownCell& later = ours_first ? ours : theirs;
    const KnownCell& earlier = ours_first ? theirs : ours;
    if (mahalanobis_sq(ours.height(), theirs.height()) > fusion.gate_sigma * fusion.gate_sigma) {
        ++counts.disagreed;
        return disagreed(later, earlier);
    }
    ++counts.agreed;
    return agreed(fusion, errors, later, earlier);
}

std::optional<std::string> problem_of(const MapRegion& into,
                                      const MapRegion& from,
                                      RegionErrors errors) {
    if (auto problem = into.problem()) return problem;
    if (auto problem = from.problem()) return problem;
    if (into.resolution_m != from.resolution_m) {
        return fmt::format(
            "maps with cells of {} m and of {} m cannot be merged; give maps with the same cell "
            "size",
            into.resolution_m,
            from.resolution_m);
    }
    if (into.frame != from.frame) {
        return fmt::format(
            "one map is in frame {}, the other in frame {}; give maps of the same frame",
            into.frame,
            from.frame);
    }
    if (errors == RegionErrors::shared && into.frame_since_ns != from.frame_since_ns) {
        return fmt::format(
            "the maps come from two runs: their frames {0} started at {1} ns and at {2} ns. Give "
            "maps of one run, or merge them as independent maps if both frames are at the same "
            "place",
            into.frame,
            into.frame_since_ns,
            from.frame_since_ns);
    }
    if (const auto problem = grid::united(into.box, from.box).problem())
        return "no map fits around both regions: " + *problem;
    return std::nullopt;
}

/// Copies the stamps, the pose and the configuration of `from` if it is later than `into`.
void take_later_head(MapRegion& into, const MapRegion& from) {
    if (from.stamp_ns <= into.stamp_ns) return;
    into.frame_since_ns = from.frame_since_ns;
    into.stamp_ns = from.stamp_ns;
    into.T_frame_body = from.T_frame_body;
    into.config_hash = from.config_hash;
}

}  // namespace

Result<MergeCounts> merge(MapRegion& into,
                          const MapRegion& from,
                          const FusionConfig& fusion,
                          RegionErrors errors) {
    if (const auto problem = problem_of(into, from, errors)) return input_error(*problem);
    MergeCounts counts;
    const auto whole = grid::united(into.box, from.box);
    into = grid::cut(std::move(into), whole);
    take_later_head(into, from);
    const auto index = [](const MapRegion& r, std::int64_t ix, std::int64_t iy) {
        return static_cast<std::size_t>(iy * r.box.nx + ix);
    };
    const std::int64_t dx = from.box.first_ix - into.box.first_ix;
    const std::int64_t dy = from.box.first_iy - into.box.first_iy;
    for (std::int64_t iy = 0; iy < from.box.ny; ++iy) {
        for (std::int64_t ix = 0; ix < from.box.nx; ++ix) {
            const KnownCell theirs = load(from, index(from, ix, iy));
            if (std::isnan(theirs.height_m)) continue;
            const std::size_t cell = index(into, ix + dx, iy + dy);
            store(into, cell, merged(fusion, errors, load(into, cell), theirs, counts));
        }
    }
    return counts;
}

}  // namespace surefoot::elevation
