// SPDX-License-Identifier: Apache-2.0
// Connects a camera that Surefoot does not know. The camera of this example sees a random
// pattern. Replace the body of `next` with your driver, and the numbers of the rig with your
// calibration.
#include <iostream>

#include "surefoot/surefoot.hpp"

namespace {

class MyCamera final : public surefoot::camera::FrameSource {
  public:
    MyCamera() {
        surefoot::camera::PinholeRadTan lens;
        lens.fx_px = lens.fy_px = 350.0;
        lens.cx_px = 0.5 * (kWidth - 1);
        lens.cy_px = 0.5 * (kHeight - 1);
        rig_.left = {lens, kWidth, kHeight};
        rig_.right = rig_.left;
        rig_.T_left_right.translation_m.x() = 0.12;  // the baseline
        info_.kind = "my camera";
    }
    [[nodiscard]] const surefoot::camera::StereoRig& rig() const override { return rig_; }
    [[nodiscard]] const surefoot::camera::SourceInfo& info() const override { return info_; }
    /// The next pair, an empty value after the camera is switched off, or an error with a sentence.
    [[nodiscard]] surefoot::Result<std::optional<surefoot::StereoFrame>> next() override {
        if (index_ == kFrames) return std::optional<surefoot::StereoFrame>{};
        surefoot::StereoFrame frame;
        frame.index = index_;
        frame.time_ns = 33'000'000LL * index_++;  // when the image was exposed
        frame.left.resize(kWidth, kHeight);
        frame.right.resize(kWidth, kHeight);
        for (int v = 0; v < kHeight; ++v)
            for (int u = 0; u < kWidth; ++u) {  // a wall 1 m ahead: 42 px of disparity
                frame.left.at(u, v) = grey(u, v);
                frame.right.at(u, v) = grey(u + 42, v);
            }
        return std::optional(std::move(frame));
    }

  private:
    static constexpr int kWidth = 672;
    static constexpr int kHeight = 376;
    static constexpr int kFrames = 15;
    [[nodiscard]] std::uint8_t grey(int u,
                                    int v) const {  // new noise in each frame, as a sensor has it
        const unsigned place =
            static_cast<unsigned>(u / 3) * 2654435761U ^ static_cast<unsigned>(v / 3) * 40503U;
        const unsigned noise = static_cast<unsigned>(u * 31 + v * 17 + index_ * 101) / 5U % 4U;
        return static_cast<std::uint8_t>(64U + place / 7U % 128U + noise);
    }
    surefoot::camera::StereoRig rig_;
    surefoot::camera::SourceInfo info_;
    int index_ = 0;
};

}  // namespace

int main() {
    MyCamera camera;
    auto perception = surefoot::Perception::make(camera.rig());
    if (!perception) {
        std::cerr << perception.error().message << '\n';
        return 1;
    }
    const auto print = [](std::span<const surefoot::FrameReport> reports) {
        for (const surefoot::FrameReport& report : reports)
            std::cout << "frame " << report.index << ": " << report.depth_pixels
                      << " pixels with depth, " << surefoot::to_string(report.motion.health)
                      << '\n';
    };
    for (auto frame = camera.next(); frame.ok() && frame->has_value(); frame = camera.next())
        print(perception->process(**frame));
    print(perception->finish());  // the start-up may still wait for ground; no more frames come
}
