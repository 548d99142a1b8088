// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::odometry {

/// Image pyramid (full, half, quarter ... size) with derivatives. It is computed once per frame and
/// used by every search from or into that frame. Keeps its buffers from frame to frame.
class ImagePyramid {
  public:
    ImagePyramid();
    ~ImagePyramid();
    ImagePyramid(ImagePyramid&&) noexcept;
    ImagePyramid& operator=(ImagePyramid&&) noexcept;

    void build(ImageView<const std::uint8_t> image);
    [[nodiscard]] bool empty() const noexcept;
    /// The full-size image; valid until the next `build`.
    [[nodiscard]] ImageView<const std::uint8_t> image() const noexcept;
    /// Mean squared derivative [grey^2/px^2] at quarter size, a measure of texture. Blur and
    /// darkness make it small.
    [[nodiscard]] double sharpness() const;

    struct Impl;
    [[nodiscard]] const Impl& impl() const noexcept { return *impl_; }

  private:
    std::unique_ptr<Impl> impl_;
};

struct KltConfig {
    int iterations = 20;
    double forward_backward_px = 0.7;  ///< largest error after tracking forward and back
};

/// One point to track: its previous and its expected position.
struct KltRequest {
    Eigen::Vector2f from_px;
    Eigen::Vector2f start_px;
};

struct KltResult {
    Eigen::Vector2f px;
    bool found = false;
};

/// Tracks points from one image to the next (Lucas and Kanade 1981, pyramidal after Bouguet) and
/// back. The points are independent, so every executor gives the same result.
void track_points(const ImagePyramid& from,
                  const ImagePyramid& to,
                  std::span<const KltRequest> requests,
                  const KltConfig& config,
                  Executor& executor,
                  std::vector<KltResult>& results);

}  // namespace surefoot::odometry
