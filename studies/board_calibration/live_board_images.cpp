// SPDX-License-Identifier: Apache-2.0
#include "studies/board_calibration/live_board_images.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::app {
namespace {

/// Returns a rig of the right image size whose lenses are not used, because LiveCamera needs a rig
/// and this camera is not calibrated yet.
camera::StereoRig rig_of_size(int width, int height) {
    const camera::Camera camera{camera::PinholeRadTan{.fx_px = static_cast<double>(width),
                                                      .fy_px = static_cast<double>(width),
                                                      .cx_px = 0.5 * (width - 1),
                                                      .cy_px = 0.5 * (height - 1)},
                                width,
                                height};
    camera::StereoRig rig;
    rig.name = "not calibrated yet";
    rig.left = camera;
    rig.right = camera;
    rig.T_left_right.translation_m.x() = 0.1;
    return rig;
}

}  // namespace

Status for_live_images(std::unique_ptr<io::VideoDevice> device,
                       const LiveBoards& session,
                       const std::function<void(BoardImages)>& use) {
    const auto address = io::parse_live_address(session.address);
    if (!address) return address.error();
    if (!address->width || *address->width % 2 != 0) {
        return usage_error(
            fmt::format("{}: the size of the camera image is missing or its width is odd; give "
                        "v4l2:DEVICE@WIDTHxHEIGHT with the size of both images side by side and "
                        "an even width; 'surefoot info v4l2:DEVICE' lists the sizes",
                        session.address));
    }
    if (!session.stereo && session.camera.empty()) {
        return usage_error(fmt::format(
            "{}: the device has two cameras; choose one with --camera left or --camera right",
            session.address));
    }
    auto live = io::LiveCamera::open(std::move(device),
                                     *address,
                                     rig_of_size(*address->width / 2, *address->height),
                                     session.config,
                                     session.stop);
    if (!live) return live.error();
    if (session.opened) session.opened();
    const auto pause_ns = saturated_integer<std::int64_t>(1e9 * session.pause_s);
    std::optional<std::int64_t> last_ns;
    for (int used = 0; used < session.most;) {
        auto next = (*live)->next();
        if (!next) return next.error();
        if (!next->has_value()) return {};
        StereoFrame& frame = **next;
        if (!frame.frame_status.is_new_and_whole()) continue;
        if (last_ns && frame.time_ns - *last_ns < pause_ns) continue;
        last_ns = frame.time_ns;
        ++used;
        BoardImages images{fmt::format("frame {}", frame.index), {}, {}};
        images.left =
            std::move(session.stereo || session.camera == "left" ? frame.left : frame.right);
        if (session.stereo) images.right = std::move(frame.right);
        use(std::move(images));
    }
    return {};
}

}  // namespace surefoot::app
