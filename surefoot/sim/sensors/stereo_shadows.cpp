// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/stereo_shadows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::sim {
namespace {

/// Number of columns in one strip of the vertical pass.
constexpr int kStrip = 64;
/// ASSUMPTION: steepest disparity gradient of a surface without a jump, in px per px. A floor seen
/// from 1 m height with a baseline of 0.12 m has a gradient of 0.12.
constexpr double kSlope = 0.2;

/// The nearest jump to a nearer surface, for pixels behind it.
struct Behind {
    std::uint8_t steps = 0;  ///< 0 = none
    float front_px = 0.0F;
};

/// Walks along a line of pixels and counts the steps since the last jump to a farther surface. A
/// pixel without a surface has a NaN disparity.
class LineWalk {
  public:
    LineWalk(float jump_px, int reach) : jump_px_(jump_px), reach_(reach) {}

    void step(float disparity_px, int surface, Behind& behind) {
        const bool border = before_surface_ >= 0 && surface != before_surface_;
        if (border && before_px_ - disparity_px > jump_px_) {
            steps_ = 1;
            front_px_ = before_px_;
        } else if (surface < 0 || (border && disparity_px - before_px_ > jump_px_)) {
            steps_ = 0;  // no surface, or the nearer surface itself
        } else if (steps_ > 0) {
            steps_ = steps_ < reach_ ? steps_ + 1 : 0;
        }
        before_px_ = disparity_px;
        before_surface_ = surface;
        note(behind);
    }
    /// Skips pixels of the same surface; `disparity_px` belongs to the last of them.
    void skip(float disparity_px) { before_px_ = disparity_px; }
    [[nodiscard]] bool behind_nothing() const { return steps_ == 0; }
    [[nodiscard]] int surface() const { return before_surface_; }

  private:
    void note(Behind& behind) const {
        if (steps_ > 0 && (behind.steps == 0 || steps_ < behind.steps)) {
            behind = {static_cast<std::uint8_t>(steps_), front_px_};
        }
    }

    float jump_px_;
    int reach_;
    int steps_ = 0;
    float front_px_ = 0.0F;
    float before_px_ = 0.0F;
    int before_surface_ = -1;
};

/// Number of pixels of a line that are tested together. Most show the same surface as the pixel
/// before.
constexpr int kTogether = 16;

bool all_show(const std::int32_t* surface, int wanted) {
    std::int32_t differs = 0;
    for (int i = 0; i < kTogether; ++i) differs |= surface[i] ^ wanted;
    return differs == 0;
}

/// Walks along one row, first to the right and then to the left.
void walk_row(const float* disparity_px,
              const std::int32_t* surface,
              int width,
              const LineWalk& start,
              Behind* behind) {
    LineWalk right = start;
    for (int u = 0; u < width;) {
        if (right.behind_nothing() && u + kTogether <= width &&
            all_show(surface + u, right.surface())) {
            u += kTogether;
            right.skip(disparity_px[u - 1]);
        } else {
            right.step(disparity_px[u], surface[u], behind[u]);
            ++u;
        }
    }
    LineWalk left = start;
    for (int u = width - 1; u >= 0;) {
        const int first = u - kTogether + 1;
        if (left.behind_nothing() && first >= 0 && all_show(surface + first, left.surface())) {
            left.skip(disparity_px[first]);
            u = first - 1;
        } else {
            left.step(disparity_px[u], surface[u], behind[u]);
            --u;
        }
    }
}

/// Walks along columns side by side, from row to row in one direction.
class StripWalk {
  public:
    StripWalk(const Image<float>& disparity_px,
              const Image<std::int32_t>& surface,
              int first,
              int count,
              const LineWalk& start)
        : disparity_px_(disparity_px),
          surface_(surface),
          first_(first),
          lines_(static_cast<std::size_t>(count), start) {}

    void step(int v, Image<Behind>& behind) {
        const float* d = disparity_px_.row(v) + first_;
        const std::int32_t* s = surface_.row(v) + first_;
        Behind* out = behind.row(v) + first_;
        std::int32_t differs = 0;
        bool nothing = true;
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            differs |= s[i] ^ lines_[i].surface();
            nothing = nothing && lines_[i].behind_nothing();
        }
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            if (nothing && differs == 0) {
                lines_[i].skip(d[i]);
            } else {
                lines_[i].step(d[i], s[i], out[i]);
            }
        }
    }

  private:
    const Image<float>& disparity_px_;
    const Image<std::int32_t>& surface_;
    int first_;
    std::vector<LineWalk> lines_;
};

/// Bridges a run of occluded pixels [first, end) of a row, from the surface before the run to the
/// surface after it.
void bridge_run(const float* disparity_px, int first, int end, int width, ShadowMap& out, int v) {
    if (first == 0 || end == width) return;
    const float from_px = disparity_px[first - 1];
    const float step_px = (disparity_px[end] - from_px) / static_cast<float>(end - first + 1);
    for (int u = first; u < end; ++u) {
        if (out.shadow.row(v)[u] != Shadow::occluded) continue;
        out.bridge_px.row(v)[u] = from_px + step_px * static_cast<float>(u - first + 1);
    }
}

/// Marks the pixels of a row that are hidden from the right camera, from right to left. `seen` is
/// the leftmost column of the right image that is already occupied.
void occlude_row(const Image<float>& disparity_px, int v, ShadowMap& out) {
    const float* d = disparity_px.row(v);
    const int width = disparity_px.width();
    float seen = std::numeric_limits<float>::infinity();
    int run_end = -1;  // one past the last pixel of the open run
    for (int u = width - 1; u >= 0; --u) {
        const float right_u = static_cast<float>(u) - d[u];
        const bool hidden = right_u >= seen;
        Shadow& shadow = out.shadow.row(v)[u];
        if (right_u < -0.5F) shadow = Shadow::outside;
        if (hidden && shadow != Shadow::fattened) shadow = Shadow::occluded;
        if (hidden && run_end < 0) run_end = u + 1;
        if (!hidden && run_end >= 0) {
            bridge_run(d, u + 1, run_end, width, out, v);
            run_end = -1;
        }
        if (right_u < seen) seen = right_u;
    }
}

}  // namespace

void find_shadows(const Image<float>& disparity_px,
                  const Image<std::int32_t>& surface,
                  const ShadowConfig& config,
                  int stride,
                  Executor& executor,
                  ShadowMap& out) {
    const int width = disparity_px.width();
    const int height = disparity_px.height();
    // One pixel of this image, and one unit of its disparities, is `stride` real pixels.
    const auto jump_px = static_cast<float>(config.jump_px / stride + kSlope);
    const double widest_px = std::max(config.ramp_px, config.fattening_px);
    const int reach = std::min(saturated_integer<int>(widest_px / stride), 255);
    const int seam = saturated_integer<int>(config.fattening_px / stride);
    out.shadow.resize(width, height);
    out.bridge_px.resize(width, height);
    Image<Behind> behind(width, height);
    const LineWalk start(jump_px, reach);
    if (reach > 0) {
        executor.parallel_for(height, [&](int v) {
            walk_row(disparity_px.row(v), surface.row(v), width, start, behind.row(v));
        });
        executor.parallel_for((width + kStrip - 1) / kStrip, [&](int strip) {
            const int first = strip * kStrip;
            const int count = std::min(kStrip, width - first);
            StripWalk down(disparity_px, surface, first, count, start);
            for (int v = 0; v < height; ++v) down.step(v, behind);
            StripWalk up(disparity_px, surface, first, count, start);
            for (int v = height - 1; v >= 0; --v) up.step(v, behind);
        });
    }
    executor.parallel_for(height, [&](int v) {
        for (int u = 0; u < width; ++u) {
            const Behind& at = behind.row(v)[u];
            Shadow& shadow = out.shadow.row(v)[u];
            float& bridge_px = out.bridge_px.row(v)[u];
            shadow = Shadow::none;
            bridge_px = kNanF;
            if (at.steps == 0) continue;
            shadow = at.steps <= seam ? Shadow::fattened : Shadow::ramp;
            const float share = shadow == Shadow::fattened
                                    ? 0.0F
                                    : static_cast<float>(at.steps) / static_cast<float>(reach + 1);
            bridge_px = at.front_px + share * (disparity_px.row(v)[u] - at.front_px);
        }
        occlude_row(disparity_px, v, out);
    });
}

}  // namespace surefoot::sim
