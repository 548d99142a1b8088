// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/recordings/pairing.hpp"
#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::io {
namespace {

Result<std::vector<CsvRow>> read_frames(const std::string& file) {
    const Result<std::string> text = read_file(file);
    if (!text) return text.error();
    return parse_euroc_frames(*text, file);
}

Result<camera::StereoRig> choose_rig(const std::string& folder,
                                     const OpenOptions& options,
                                     const std::string& first_image) {
    return options.rig_file ? read_rig(*options.rig_file, image_size_of(first_image))
                            : read_euroc_rig(folder);
}

std::vector<std::int64_t> times_of(const std::vector<CsvRow>& rows) {
    std::vector<std::int64_t> times_ns;
    times_ns.reserve(rows.size());
    for (const CsvRow& row : rows) times_ns.push_back(row.time_ns);
    return times_ns;
}

/// Pairs the rows of both cameras by their stamps, in the order of the left camera.
void pair_rows(const std::string& folder,
               const std::vector<CsvRow>& left,
               const std::vector<CsvRow>& right,
               Recording& out) {
    const Partners partners = pair_stamps(times_of(left), times_of(right), out);
    const std::string left_csv = join_path(folder, "cam0/data.csv");
    for (std::size_t i = 0; i < left.size(); ++i) {
        if (!partners[i]) continue;
        FrameEntry entry;
        entry.time_ns = left[i].time_ns;
        entry.left = join_path(folder, "cam0/data/" + left[i].value);
        entry.right = join_path(folder, "cam1/data/" + right[*partners[i]].value);
        entry.where = fmt::format("{}:{}", left_csv, left[i].line);
        out.frames.push_back(std::move(entry));
    }
}

}  // namespace

Result<Recording> index_euroc(const std::string& folder, const OpenOptions& options) {
    const std::string left_csv = join_path(folder, "cam0/data.csv");
    if (Status status = refuse_rate(options, left_csv); !status) return status.error();
    Recording recording;
    recording.info.kind = "euroc";
    recording.info.path = folder;
    const Result<std::vector<CsvRow>> left = read_frames(left_csv);
    if (!left) return left.error();
    const Result<std::vector<CsvRow>> right = read_frames(join_path(folder, "cam1/data.csv"));
    if (!right) return right.error();
    set_pair_tolerance(options, fifth_of_frame_time_ns(times_of(*left)), recording);
    pair_rows(folder, *left, *right, recording);
    if (recording.frames.empty()) {
        return input_error(
            fmt::format("{}: no frames: the {} rows of cam0 and the {} rows of cam1 have no time "
                        "stamps within {:g} ms of each other; give a larger --pair-tolerance",
                        folder,
                        left->size(),
                        right->size(),
                        1e3 * recording.pair_tolerance_s));
    }
    Result<camera::StereoRig> rig = choose_rig(folder, options, recording.frames.front().left);
    if (!rig) return rig.error();
    recording.rig = std::move(rig).value();
    if (Status status = read_euroc_imu(folder, recording); !status) return status.error();
    recording.info.frames = static_cast<int>(recording.frames.size());
    return recording;
}

Status read_euroc_imu(const std::string& folder, Recording& recording) {
    const std::string imu_csv = join_path(folder, "imu0/data.csv");
    if (!recording.rig.imu || !is_file(imu_csv)) return {};
    const Result<std::string> text = read_file(imu_csv);
    if (!text) return text.error();
    Result<std::vector<ImuSample>> samples = parse_euroc_imu_samples(*text, imu_csv);
    if (!samples) return samples.error();
    recording.imu = std::move(samples).value();
    recording.info.has_imu = !recording.imu.empty();
    return {};
}

}  // namespace surefoot::io
