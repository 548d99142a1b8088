// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/config.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::sim {

/// Settings of a camera's exposure. The renderer's grey values hold for `exposure_s` and gain 1.
/// ASSUMPTION: the control parameters are typical of small cameras; nobody measured them on a ZED.
struct ExposureConfig {
    double exposure_s = 0.008;  ///< fixed value, or the reference of the automatic control
    bool automatic = false;     ///< true: keep the mean grey value at `target_dn`
    double target_dn = 110.0;   ///< wanted mean grey value of the left image
    double min_exposure_s = 0.0001;
    double max_exposure_s = 0.016;  ///< limits the motion blur; at this limit the gain rises
    double max_gain = 8.0;
    double lag_s = 0.3;           ///< time constant of the control; 0 = at once
    bool sun_warm_up = false;     ///< true: over-exposed at first, for 10-30 s drawn by the seed
    double warm_up_factor = 8.0;  ///< factor by which the first frame is too bright
    double right_gain = 1.0;      ///< gain of the right camera relative to the left one

    void describe(ConfigVisitor& visitor);
};

/// Exposure settings of one frame.
struct Shot {
    double exposure_s = 0.008;
    double gain = 1.0;   ///< amplifies signal and noise
    double light = 1.0;  ///< signal relative to `exposure_s` of the configuration at gain 1
};

/// Mean grey value of an image whose signal is multiplied by `factor` and saturates at 255. Samples
/// every fourth pixel of every fourth row.
[[nodiscard]] double metered_mean_dn(const Image<float>& signal_dn, double factor);

/// The exposure control of a stereo camera. It meters the left image and sets both cameras alike:
/// exposure time first, then gain when the time is at its limit. The logarithm of their product
/// follows the wanted value with a first-order lag. In the sun both cameras get too much light at
/// first, by a factor that falls exponentially to 1; the control does not see this factor. (Lange
/// 2016 reports useless disparities for 10-30 s in the sun; the exponential law is an ASSUMPTION.)
class ExposureControl {
  public:
    ExposureControl(const ExposureConfig& config, std::uint64_t seed);

    /// Returns the exposure settings of a frame.
    [[nodiscard]] Shot shot(double since_start_s) const;
    /// Call at the first frame: sets the steady state for this image.
    void settle(const Image<float>& signal_dn);
    /// Call after each frame; `step_s` is the time to the next frame.
    void update(const Image<float>& signal_dn, double step_s);
    /// Duration of the warm-up; 0 without one.
    [[nodiscard]] double warm_up_s() const noexcept { return warm_up_s_; }

  private:
    [[nodiscard]] double least() const;
    [[nodiscard]] double most() const;

    ExposureConfig config_;
    double warm_up_s_ = 0.0;
    double product_ = 1.0;  ///< exposure time times gain, relative to `config_.exposure_s`
};

}  // namespace surefoot::sim
