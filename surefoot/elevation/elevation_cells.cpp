// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/elevation_cells.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/time.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::elevation {
namespace {

/// Trust in an overhead object. An observation adds kOverheadSeen; a line of sight through the
/// object subtracts one. The object limits the clearance from kOverheadSure on. So two observations
/// are enough; a single observation may be a wrong match. A former height of the cell with more
/// than one observation gets the largest trust, kOverheadMost. All three values are an ASSUMPTION.
constexpr int kOverheadSeen = 2;
constexpr int kOverheadSure = 4;
constexpr int kOverheadMost = 8;

/// Weight of a new observation in confidence and density ratio, and the confidence after the first
/// observation.
constexpr float kNewObservation = 0.25F;
constexpr float kFirstObservation = 0.5F;
/// Added to the id of a viewpoint if the cell was observed finely from there.
constexpr ViewpointHistory::Id kFineView = ViewpointHistory::Id{1} << 31;

ViewpointHistory::Id observed_from(const CellObservation& seen, const FrameObservation& look) {
    return seen.is_fine ? look.view | kFineView : look.view;
}

/// Evidence that one contradicting frame adds against a surface that every observation showed.
constexpr int kGone = 16;

}  // namespace

template <typename F>
void ElevationCells::for_each_layer_of_known(const F& f) {
    f(settled_var_m2_, kNanF);
    f(viewpoint_, ViewpointHistory::kNever);
    f(steady_, std::uint8_t{0});
    f(seen_through_, std::uint16_t{0});
}

template <typename F>
void ElevationCells::for_each_layer(const F& f) {
    f(layers_.height_m, kNanF);
    f(layers_.height_var_m2, kNanF);
    f(layers_.count, std::uint32_t{0});
    f(layers_.seen_ns, std::int64_t{0});
    f(layers_.horizontal_drift_m, kNanF);
    f(layers_.highest_m, kNanF);
    f(layers_.lowest_m, kNanF);
    f(layers_.clearance_m, kNanF);
    f(layers_.free_above_m, kNanF);
    f(layers_.confidence, kNanF);
    f(layers_.density_ratio, kNanF);
    if (aligns()) {
        f(aligned_var_m2_, kNanF);
        f(aligned_step_, std::uint32_t{0});
        f(is_asked_, std::uint8_t{0});
    }
    f(overhead_m_, kNanF);
    f(overhead_trust_, std::uint8_t{0});
    f(overhead_hangs_, std::uint8_t{0});
    f(bottom_m_, kNanF);
}

ElevationCells::ElevationCells(const ElevationConfig& config, int nx, int ny) : config_(config) {
    const auto make = [&](auto& layer, auto unknown) {
        layer = std::remove_reference_t<decltype(layer)>(nx, ny, unknown);
    };
    for_each_layer(make);
    for_each_layer_of_known(make);
}

void ElevationCells::clear() {
    for_each_layer([](auto& layer, auto unknown) { layer.fill(unknown); });
}

void ElevationCells::shift(grid::Shift shift) {
    for_each_layer([&](auto& layer, auto unknown) { layer.shift(shift, unknown); });
    for_each_layer_of_known([&](auto& layer, auto) { layer.slide(shift); });
}

ElevationCells::Memory ElevationCells::memory_of_row(int iy) noexcept {
    return {layers_.height_m.row(iy),
            layers_.height_var_m2.row(iy),
            layers_.horizontal_drift_m.row(iy)};
}

void ElevationCells::update(std::size_t cell,
                            const CellObservation& seen,
                            const FrameObservation& look,
                            FusionCounts& counts) {
    const CellMeasurement& measured = seen.measured;
    ++counts.cells_measured;
    const float height_m = layers_.height_m.data()[cell];
    // A height whose variance has left the range of a float carries no information.
    if (std::isnan(height_m) || !std::isfinite(layers_.height_var_m2.data()[cell])) {
        ++counts.cells_new;
        start(cell, seen, look);
        return;
    }
    float& var_m2 = layers_.height_var_m2.data()[cell];
    const FusionResult result =
        fuse(config_.fusion,
             {static_cast<double>(height_m), static_cast<double>(var_m2)},
             {static_cast<double>(measured.z_m), static_cast<double>(measured.var_m2)},
             is_same_scan(look.time_ns - layers_.seen_ns.data()[cell]));
    if (result.outcome == FusionOutcome::fused) {
        ++counts.cells_fused;
        agree(cell, result.cell, seen, look);
        return;
    }
    ++counts.cells_inflated;
    layers_.confidence.data()[cell] *= 1.0F - kNewObservation;
    const auto hangs = static_cast<float>(config_.min_overhead_m);
    if (result.outcome == FusionOutcome::replaced) {
        const float before_m = bottom_m(cell);
        const int trust = trust_in(cell);
        start(cell, seen, look);
        if (before_m - measured.z_m > hangs) see_above(cell, before_m, trust, true);
    }
    if (result.outcome == FusionOutcome::inflated) {
        const auto inflated_m2 = static_cast<float>(result.cell.var_m2);
        // The motion of the machine did not cause this growth. So the variance at the alignment
        // grows by the same amount.
        if (aligns()) aligned_var_m2_.data()[cell] += inflated_m2 - var_m2;
        var_m2 = inflated_m2;
        if (measured.z_m - height_m > hangs)
            see_above(cell, measured.z_m, kOverheadSeen, seen.bottom_m - height_m > hangs);
    }
}

void ElevationCells::align(std::size_t cell) {
    if (!aligns()) return;
    aligned_var_m2_.data()[cell] = layers_.height_var_m2.data()[cell];
    aligned_step_.data()[cell] = motions_;
    is_asked_.data()[cell] = 0;
}

void ElevationCells::lift(std::size_t cell, double offset_m, double var_m2) {
    const auto offset = static_cast<float>(offset_m);
    layers_.height_m.data()[cell] += offset;
    layers_.highest_m.data()[cell] += offset;
    layers_.lowest_m.data()[cell] += offset;
    bottom_m_.data()[cell] += offset;
    overhead_m_.data()[cell] += offset;
    layers_.height_var_m2.data()[cell] += static_cast<float>(var_m2);
    settled_var_m2_.data()[cell] += static_cast<float>(var_m2);
    set_clearance(cell);
    align(cell);
}

bool ElevationCells::is_above(std::size_t cell, float line_z_m) const {
    const VisibilityConfig& visibility = config_.visibility;
    const float height_m = layers_.height_m.data()[cell];
    const float sigma_m = std::sqrt(layers_.height_var_m2.data()[cell]);
    const auto margin_m = static_cast<float>(visibility.margin_m);
    return height_m - line_z_m > margin_m + static_cast<float>(visibility.sigmas) * sigma_m;
}

bool ElevationCells::see_through(std::size_t cell) {
    const VisibilityConfig& visibility = config_.visibility;
    std::uint16_t& evidence = seen_through_.data()[cell];
    evidence = static_cast<std::uint16_t>(evidence + steady_.data()[cell]);
    if (evidence < visibility.frames * kGone) return false;
    // The limit keeps the sum within 16 bits.
    evidence = static_cast<std::uint16_t>(visibility.frames * kGone);
    return true;
}

void ElevationCells::see_over(std::size_t cell, float line_z_m) {
    float& lowest_m = bottom_m_.data()[cell];
    float& second_m = layers_.free_above_m.data()[cell];
    if (!(lowest_m <= line_z_m)) {
        second_m = lowest_m;
        lowest_m = line_z_m;
    } else if (!(second_m <= line_z_m)) {
        second_m = line_z_m;
    }
}

int ElevationCells::trust_in(std::size_t cell) const {
    return layers_.count.data()[cell] > 1 ? kOverheadMost : kOverheadSeen;
}

void ElevationCells::recall(std::size_t cell, const grid::MapRegion& region, std::size_t from) {
    const float height_m = region.height_m.data()[from];
    const auto floor_m2 = static_cast<float>(config_.fusion.min_height_var_m2);
    layers_.height_m.data()[cell] = height_m;
    layers_.height_var_m2.data()[cell] = std::max(region.height_var_m2.data()[from], floor_m2);
    layers_.count.data()[cell] = region.count.data()[from];
    layers_.seen_ns.data()[cell] = 0;
    layers_.horizontal_drift_m.data()[cell] = region.horizontal_drift_m.data()[from];
    layers_.highest_m.data()[cell] = region.highest_m.data()[from];
    layers_.lowest_m.data()[cell] = region.lowest_m.data()[from];
    const float confidence = region.confidence.data()[from];
    set_confidence(cell, confidence >= 0.0F && confidence <= 1.0F ? confidence : kFirstObservation);
    layers_.density_ratio.data()[cell] = region.density_ratio.data()[from];
    layers_.free_above_m.data()[cell] = kNanF;
    settled_var_m2_.data()[cell] = layers_.height_var_m2.data()[cell];
    align(cell);
    viewpoint_.data()[cell] = ViewpointHistory::kNever;
    bottom_m_.data()[cell] = height_m;
    seen_through_.data()[cell] = 0;
    // An overhead object observed in this run stays, unless it is the recalled surface.
    forget_overhead_near(cell);
    const float clearance_m = region.clearance_m.data()[from];
    if (!std::isnan(clearance_m)) see_above(cell, height_m + clearance_m, kOverheadMost, true);
    set_clearance(cell);
}

void ElevationCells::forget(std::size_t cell) {
    const float before_m = bottom_m(cell);
    const int trust = trust_in(cell);
    bottom_m_.data()[cell] = kNanF;
    layers_.height_m.data()[cell] = kNanF;
    layers_.height_var_m2.data()[cell] = kNanF;
    layers_.count.data()[cell] = 0;
    layers_.seen_ns.data()[cell] = 0;
    layers_.horizontal_drift_m.data()[cell] = kNanF;
    layers_.highest_m.data()[cell] = kNanF;
    layers_.lowest_m.data()[cell] = kNanF;
    layers_.clearance_m.data()[cell] = kNanF;
    layers_.confidence.data()[cell] = kNanF;
    layers_.density_ratio.data()[cell] = kNanF;
    forget_overhead(cell);
    seen_through_.data()[cell] = 0;
    // The removed surface may hang over the ground. So a surface with more than one observation
    // limits the clearance until five lines of sight have passed through it.
    see_above(cell, before_m, trust, true);
}

void ElevationCells::see_above(std::size_t cell, float z_m, int trust, bool hangs) {
    if (hangs) overhead_hangs_.data()[cell] = 1;
    float& overhead_m = overhead_m_.data()[cell];
    overhead_m = std::isnan(overhead_m) ? z_m : std::min(overhead_m, z_m);
    std::uint8_t& believed = overhead_trust_.data()[cell];
    believed = static_cast<std::uint8_t>(std::min(believed + trust, kOverheadMost));
    set_clearance(cell);
}

void ElevationCells::see_no_more_above(std::size_t cell) {
    std::uint8_t& believed = overhead_trust_.data()[cell];
    if (believed == 0) return;
    --believed;
    if (believed == 0) forget_overhead(cell);
    set_clearance(cell);
}

void ElevationCells::forget_overhead(std::size_t cell) {
    overhead_m_.data()[cell] = kNanF;
    overhead_trust_.data()[cell] = 0;
    overhead_hangs_.data()[cell] = 0;
}

void ElevationCells::forget_overhead_near(std::size_t cell) {
    const float over_m = overhead_m_.data()[cell] - layers_.height_m.data()[cell];
    if (!(over_m > static_cast<float>(config_.min_overhead_m))) forget_overhead(cell);
}

bool ElevationCells::is_sure_of_overhead(std::size_t cell) const {
    return overhead_trust_.data()[cell] >= kOverheadSure;
}

void ElevationCells::set_clearance(std::size_t cell) {
    const float free_m = overhead_m_.data()[cell] - layers_.height_m.data()[cell];
    layers_.clearance_m.data()[cell] = is_sure_of_overhead(cell) ? free_m : kNanF;
}

void ElevationCells::surface(grid::Layer& out_m) const {
    out_m.resize(layers_.height_m.width(), layers_.height_m.height());
    for (std::size_t cell = 0; cell < out_m.size(); ++cell) {
        const float height_m = layers_.height_m.data()[cell];
        const bool stands = is_sure_of_overhead(cell) && overhead_hangs_.data()[cell] == 0;
        const bool known = !std::isnan(height_m);
        out_m.data()[cell] = known && stands ? overhead_m_.data()[cell] : height_m;
    }
}

bool ElevationCells::is_same_scan(std::int64_t since_seen_ns) const {
    const double duration_s = config_.fusion.scan_duration_s;
    return duration_s > 0.0 && since_seen_ns <= ns_from_seconds(duration_s);
}

void ElevationCells::start(std::size_t cell,
                           const CellObservation& seen,
                           const FrameObservation& look) {
    const CellMeasurement& measured = seen.measured;
    const auto floor_m2 = static_cast<float>(config_.fusion.min_height_var_m2);
    layers_.height_m.data()[cell] = measured.z_m;
    layers_.height_var_m2.data()[cell] = std::max(measured.var_m2, floor_m2);
    layers_.count.data()[cell] = 1;
    layers_.seen_ns.data()[cell] = look.time_ns;
    layers_.horizontal_drift_m.data()[cell] = 0.0F;
    layers_.highest_m.data()[cell] = measured.highest_m;
    layers_.lowest_m.data()[cell] = measured.lowest_m;
    set_confidence(cell, kFirstObservation);
    layers_.density_ratio.data()[cell] = seen.density_ratio;
    layers_.free_above_m.data()[cell] = kNanF;
    settled_var_m2_.data()[cell] = layers_.height_var_m2.data()[cell];
    align(cell);
    viewpoint_.data()[cell] = observed_from(seen, look);
    bottom_m_.data()[cell] = seen.bottom_m;
    seen_through_.data()[cell] = 0;
    // A known overhead object stays if it is more than min_overhead_m above the new surface.
    forget_overhead_near(cell);
    set_clearance(cell);
}

void ElevationCells::agree(std::size_t cell,
                           const Height& fused,
                           const CellObservation& seen,
                           const FrameObservation& look) {
    const CellMeasurement& measured = seen.measured;
    if (look.views.is_new_since(viewpoint_.data()[cell] & ~kFineView)) {
        layers_.height_m.data()[cell] = static_cast<float>(fused.z_m);
        layers_.height_var_m2.data()[cell] = static_cast<float>(fused.var_m2);
        settled_var_m2_.data()[cell] = static_cast<float>(fused.var_m2);
        viewpoint_.data()[cell] = observed_from(seen, look);
    } else {
        repeat(cell, seen, look);
    }
    align(cell);
    ++layers_.count.data()[cell];
    layers_.seen_ns.data()[cell] = look.time_ns;
    layers_.horizontal_drift_m.data()[cell] = 0.0F;
    float& highest_m = layers_.highest_m.data()[cell];
    float& lowest_m = layers_.lowest_m.data()[cell];
    highest_m = std::max(highest_m, measured.highest_m);
    lowest_m = std::min(lowest_m, measured.lowest_m);
    const float confidence = layers_.confidence.data()[cell];
    set_confidence(cell, confidence + kNewObservation * (1.0F - confidence));
    remember_density(cell, seen.density_ratio);
    bottom_m_.data()[cell] = std::min(bottom_m_.data()[cell], seen.bottom_m);
    seen_through_.data()[cell] = 0;
    // A camera observes ground under a table top, but not through a person. So observed ground is
    // evidence against an object that stands on the ground.
    if (overhead_hangs_.data()[cell] == 0) see_no_more_above(cell);
    set_clearance(cell);
}

void ElevationCells::set_confidence(std::size_t cell, float confidence) {
    layers_.confidence.data()[cell] = confidence;
    // Rounds to the nearest sixteenth; half a sixteenth rounds up.
    const float share = kGone * confidence;
    // in range: confidence is in [0, 1]: recall() checks it, observations mix it with 0 or 1
    const int whole = static_cast<int>(share);
    const int more = share - static_cast<float>(whole) >= 0.5F ? 1 : 0;
    steady_.data()[cell] = static_cast<std::uint8_t>(whole + more);
}

void ElevationCells::remember_density(std::size_t cell, float ratio) {
    float& remembered = layers_.density_ratio.data()[cell];
    if (std::isnan(ratio)) return;
    remembered =
        std::isnan(remembered) ? ratio : remembered + kNewObservation * (ratio - remembered);
}

void ElevationCells::repeat(std::size_t cell,
                            const CellObservation& seen,
                            const FrameObservation& look) {
    // The cell and the measurement share an unknown part of their errors. Covariance intersection
    // (Julier and Uhlmann 1997) in one dimension keeps the estimate of smaller variance unchanged.
    // Of many equal observations the one with the smallest variance is not better than the others,
    // but the first fine observation after coarse ones is.
    float& var_m2 = layers_.height_var_m2.data()[cell];
    float& settled_m2 = settled_var_m2_.data()[cell];
    ViewpointHistory::Id& viewpoint = viewpoint_.data()[cell];
    const bool is_first_fine = seen.is_fine && (viewpoint & kFineView) == 0;
    const float measured_m2 =
        is_first_fine
            ? std::max(seen.measured.var_m2, static_cast<float>(config_.fusion.min_height_var_m2))
            : std::max(seen.measured.var_m2, settled_m2);
    if (var_m2 <= measured_m2) return;
    layers_.height_m.data()[cell] = seen.measured.z_m;
    var_m2 = measured_m2;
    settled_m2 = measured_m2;
    viewpoint = observed_from(seen, look) | (viewpoint & kFineView);
}

}  // namespace surefoot::elevation
