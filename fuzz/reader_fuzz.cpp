// SPDX-License-Identifier: Apache-2.0
// Any bytes give a value or an error with a message: no crash, no endless loop, no huge allocation.
// SUREFOOT_FUZZ_READER names the function under test.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/must.hpp"
#include "surefoot/core/height_limit.hpp"
#include "surefoot/grid/snapshot_fields.hpp"
#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/clouds/cloud_rows.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"
#include "surefoot/io/clouds/text_cloud.hpp"
#include "surefoot/io/images/pfm.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/maps/snapshot_file.hpp"
#include "surefoot/io/recordings/trajectory_file.hpp"
#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/io/settings/model_file.hpp"
#include "surefoot/pipeline/pipeline_config.hpp"

namespace {

using namespace surefoot;

[[maybe_unused]] void fuzz_ply(std::string_view bytes) {
    must_explain(io::parse_ply(bytes, "f"));
}
[[maybe_unused]] void fuzz_pcd(std::string_view bytes) {
    must_explain(io::parse_pcd(bytes, "f"));
}
[[maybe_unused]] void fuzz_las(std::string_view bytes) {
    must_explain(io::parse_las(bytes, "f"));
}
[[maybe_unused]] void fuzz_vtk(std::string_view bytes) {
    must_explain(io::parse_vtk(bytes, "f"));
}
/// Reading in pieces accepts every file that reading at once accepts.
[[maybe_unused]] void fuzz_cloud_rows(std::string_view bytes) {
    const struct {
        std::optional<io::CloudRows> rows;
        Result<io::PointCloud> (*parse)(std::string_view, const std::string&);
    } formats[] = {{io::ply_rows(bytes, bytes.size()), io::parse_ply},
                   {io::pcd_rows(bytes, bytes.size()), io::parse_pcd},
                   {io::las_rows(bytes, bytes.size()), io::parse_las}};
    for (const auto& [rows, parse] : formats) {
        if (!rows || rows->rows == 0) continue;
        must(rows->first_byte + rows->rows * rows->row_bytes <= bytes.size());
        const std::string_view last =
            bytes.substr(rows->first_byte + (rows->rows - 1) * rows->row_bytes, rows->row_bytes);
        const auto whole = parse(bytes, "whole");
        const auto one = parse(rows->head(1) + std::string(last), "piece");
        must(whole.ok() == one.ok());
        if (!whole.ok()) continue;
        const Eigen::Vector3d& a_m = whole->points_m.back();
        const Eigen::Vector3d& b_m = one->points_m.back();
        must(whole->points_m.size() == rows->rows && one->points_m.size() == 1);
        for (int axis = 0; axis < 3; ++axis) {
            must(a_m[axis] == b_m[axis] || (std::isnan(a_m[axis]) && std::isnan(b_m[axis])));
        }
    }
}
[[maybe_unused]] void fuzz_text_cloud(std::string_view bytes) {
    const auto whole = io::parse_text_cloud(bytes, "f.txt");
    must_explain(whole);
    must_explain(io::parse_text_cloud(bytes, "f.pts"));
    // Reading the file in pieces of whole lines gives the same points.
    io::TextCloudParser parser("f.txt");
    std::size_t points = 0;
    bool fine = true;
    for (std::size_t at = 0; at < bytes.size() && fine;) {
        const std::size_t end = std::min(bytes.find('\n', at), bytes.size() - 1) + 1;
        const auto piece = parser.parse(bytes.substr(at, end - at));
        fine = piece.ok();
        must(!fine || !piece->problem());
        if (fine) points += piece->points_m.size();
        at = end;
    }
    fine = fine && parser.finish().ok();
    must(fine == whole.ok() && (!fine || points == whole->points_m.size()));
    must(!fine || !whole->problem());
}
[[maybe_unused]] void fuzz_pfm(std::string_view bytes) {
    must_explain(io::parse_pfm(bytes, "f"));
}
[[maybe_unused]] void fuzz_esri_grid(std::string_view bytes) {
    must_explain(io::parse_esri_grid(bytes, "f"));
    const auto heights = io::parse_height_grid(bytes, "f");
    if (!heights) return;
    for (std::size_t i = 0; i < heights->values.size(); ++i) {
        const float height_m = heights->values.data()[i];
        must(std::isnan(height_m) || std::abs(static_cast<double>(height_m)) <= kMaxHeight_m);
    }
}
[[maybe_unused]] void fuzz_trajectory(std::string_view bytes) {
    must_explain(io::parse_times(bytes, "f"));
    const auto file = io::parse_trajectory(bytes, "f");
    must_explain(file);
    if (!file) return;
    must(!file->poses.empty());
    for (std::size_t i = 0; i < file->poses.size(); ++i) {
        const StampedPose& pose = file->poses[i];
        must(pose.T_world_body.all_finite());
        must(i == 0 || pose.time_ns > file->poses[i - 1].time_ns);
    }
}
/// Expensive checks run for one input in so many.
constexpr std::size_t kSeldom = 16;
constexpr std::size_t kVerySeldom = 256;

/// An accepted rig is valid, and its written form reads back.
void must_be_sound(const camera::StereoRig& rig, std::size_t input_bytes) {
    must(!rig.problem());
    must(io::parse_rig_yaml(io::format_rig_yaml(rig), "again").ok());
    if (const auto text = io::format_zed_rig(rig); text) {
        const io::ImageSize size{rig.left.width, rig.left.height};
        must_explain(io::parse_zed_rig(*text, "again", size));
    }
    if (const auto text = io::format_kalibr_rig(rig); text)
        must_explain(io::parse_kalibr_rig(*text, "again"));
    // These checks plan a rectification along the image border. For a fisheye of 672 x 376 px this
    // takes 0.3 s without sanitizers, and seconds with them.
    if (input_bytes % kVerySeldom != 0) return;
    camera::StereoRig small = rig;
    small.left.width = std::min(small.left.width, 48);
    small.left.height = std::min(small.left.height, 32);
    if (small.right) {
        small.right->width = small.left.width;
        small.right->height = small.left.height;
    }
    if (const auto text = io::format_opencv_rig(small); text)
        must_explain(io::parse_opencv_rig(*text, "again"));
    if (const auto texts = io::format_ros_rig(small); texts)
        must_explain(io::parse_ros_rig({texts->left, "l"}, {texts->right, "r"}));
}
void must_be_sound(const Result<camera::StereoRig>& rig, std::string_view bytes) {
    must_explain(rig);
    if (rig) must_be_sound(*rig, bytes.size());
}
void must_be_sound(const Result<io::RigFile>& file, std::string_view bytes) {
    must_explain(file);
    if (file) must_be_sound(file->rig, bytes.size());
}
[[maybe_unused]] void fuzz_rig_yaml(std::string_view bytes) {
    must_be_sound(io::parse_rig_yaml(bytes, "f"), bytes);
}
[[maybe_unused]] void fuzz_opencv_rig(std::string_view bytes) {
    must_be_sound(io::parse_opencv_rig(bytes, "f", io::ImageSize{640, 480}), bytes);
}
[[maybe_unused]] void fuzz_kalibr_rig(std::string_view bytes) {
    must_be_sound(io::parse_kalibr_rig(bytes, "f"), bytes);
}
[[maybe_unused]] void fuzz_zed_rig(std::string_view bytes) {
    must_be_sound(io::parse_zed_rig(bytes, "f", io::ImageSize{1280, 720}), bytes);
    must_explain(io::parse_zed_rig(bytes, "f"));
}
/// Both camera files in one input, separated by "---" at the start of a line.
[[maybe_unused]] void fuzz_ros_rig(std::string_view bytes) {
    const std::size_t cut = bytes.find("\n---\n");
    const std::string left(bytes.substr(0, cut));
    const std::string right(cut == bytes.npos ? bytes : bytes.substr(cut + 5));
    must_be_sound(io::parse_ros_rig({left, "l"}, {right, "r"}), bytes);
}
[[maybe_unused]] void fuzz_kitti_rig(std::string_view bytes) {
    const auto calibration = io::parse_kitti_calibration(bytes, "f");
    must_explain(calibration);
    if (calibration) must_be_sound(io::kitti_rig(*calibration, 0, 1, {1226, 370}, "f"), bytes);
}
[[maybe_unused]] void fuzz_kitti_raw_rig(std::string_view bytes) {
    must_be_sound(io::parse_kitti_raw_rig(bytes, "f"), bytes);
    must_be_sound(io::parse_kitti_raw_rig(bytes, "f", io::ImageSize{1392, 512}), bytes);
}
[[maybe_unused]] void fuzz_middlebury_rig(std::string_view bytes) {
    must_be_sound(io::parse_middlebury_rig(bytes, "f", io::ImageSize{640, 480}), bytes);
}
[[maybe_unused]] void fuzz_orbslam_rig(std::string_view bytes) {
    must_be_sound(io::parse_orbslam_rig(bytes, "f"), bytes);
}
/// Any text: the reader of the recognised format must read it or return a message.
[[maybe_unused]] void fuzz_rig_file(std::string_view bytes) {
    must_be_sound(io::parse_rig_file(std::string(bytes), "f", io::ImageSize{640, 480}), bytes);
    must_explain(io::parse_rig_file(std::string(bytes), "f"));
}
[[maybe_unused]] void fuzz_euroc_camera(std::string_view bytes) {
    const auto camera = io::parse_euroc_camera(bytes, "f");
    must_explain(camera);
    must(!camera || !camera->camera.problem());
    must_explain(io::parse_euroc_imu(bytes, "f"));
}
[[maybe_unused]] void fuzz_machine(std::string_view bytes) {
    const auto machine = io::parse_machine(bytes, "f");
    must_explain(machine);
    if (!machine) return;
    must(machine->machine.problem() == nullptr);  // an accepted machine is usable
    for (const io::Deviation& deviation : machine->deviations) {
        must(!deviation.signed_by.empty() && deviation.value != deviation.rated);
    }
}
[[maybe_unused]] void fuzz_model(std::string_view bytes) {
    const auto model = io::parse_model(bytes, "f");
    must_explain(model);
    if (!model) return;
    const std::vector<double> zero(model->moving_joints().size(), 0.0);
    for (const io::ModelLink& link : model->links) {  // every link has a place in one tree
        must(model->T_base_link(link.name, zero).all_finite());
    }
}
/// Seals a small snapshot with any fields. Either writing it fails, or it reads back the same, or
/// reading fails because of a value without an enumerator.
void must_come_back(std::string_view bytes) {
    static const auto snapshot = std::make_unique<grid::MapSnapshot>();
    const auto take = [&bytes](auto& value) {
        const std::size_t size = std::min(sizeof(value), bytes.size());
        if (size > 0) std::memcpy(static_cast<void*>(&value), bytes.data(), size);
        bytes.remove_prefix(size);
    };
    grid::for_each_header_field(*snapshot, [&](const char*, auto& value) { take(value); });
    constexpr int kMostSide = 4;
    for (std::int32_t* size : {&snapshot->nx, &snapshot->ny, &snapshot->edge_count})
        if (*size > kMostSide) *size = kMostSide;
    const auto cells = static_cast<std::size_t>(kMostSide * kMostSide);
    grid::for_each_snapshot_layer(
        *snapshot, [&](auto& layer) { std::for_each_n(layer.begin(), cells, take); });
    std::for_each_n(snapshot->edges.begin(), kMostSide, take);
    grid::seal(*snapshot);
    const auto written = io::format_snapshot(*snapshot);
    must_explain(written);
    if (!written) return;
    const auto read = io::parse_snapshot(*written, "again");
    must_explain(read);
    const auto again = read ? io::format_snapshot(**read) : written;
    must(again.ok() && *again == *written);
}
[[maybe_unused]] void fuzz_snapshot(std::string_view bytes) {
    const auto snapshot = io::parse_snapshot(bytes, "f");
    must_explain(snapshot);
    must(!snapshot || grid::is_intact(**snapshot));
    // A checksum protects the content, so the fuzzer rarely reaches it; hashing 0.9 MB is slow,
    // too.
    if (!bytes.empty() && static_cast<std::uint8_t>(bytes.front()) % kSeldom == 0)
        must_come_back(bytes.substr(1));
}
[[maybe_unused]] void fuzz_config(std::string_view bytes) {
    pipeline::PipelineConfig config;
    must_explain(io::parse_config(bytes, "f", io::describe_config(config)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    SUREFOOT_FUZZ_READER({reinterpret_cast<const char*>(data), size});
    return 0;
}
