// SPDX-License-Identifier: Apache-2.0
#include "cli/cameras.hpp"

#include <algorithm>
#include <filesystem>

#include "surefoot/io/text.hpp"

namespace surefoot::app {

Result<CameraView> camera_view(const std::string& device) {
    const auto system = io::kernel_video_device();
    auto opened = io::V4l2Device::open(*system, device);
    if (!opened) return opened.error();
    return CameraView{
        device, opened->card(), opened->driver(), opened->modes(), opened->controls()};
}

std::vector<CameraNode> camera_nodes() {
    std::vector<std::string> devices;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator("/dev", ignored)) {
        const std::string name = entry.path().filename().string();
        const bool numbered = name.starts_with("video") && io::parse_int64(name.substr(5));
        if (numbered) devices.push_back(entry.path().string());
    }
    std::sort(devices.begin(), devices.end(), io::natural_less);
    std::vector<CameraNode> nodes;
    for (const std::string& device : devices) {
        const auto system = io::kernel_video_device();
        const auto opened = io::V4l2Device::open(*system, device);
        nodes.push_back({device,
                         opened ? opened->card() : std::string(),
                         opened ? std::string() : opened.error().message});
    }
    return nodes;
}

}  // namespace surefoot::app
