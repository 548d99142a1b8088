// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <unordered_map>

#include "io/file.hpp"
#include "io/recording.hpp"
#include "io/rig_file.hpp"

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

/// Pairs the rows of both cameras by equal stamps, in the order of the left one.
void pair_rows(const std::string& folder,
               const std::vector<CsvRow>& left,
               const std::vector<CsvRow>& right,
               Recording& out) {
    std::unordered_map<std::int64_t, const CsvRow*> partners;
    for (const CsvRow& row : right) partners.emplace(row.time_ns, &row);
    const std::string left_csv = join_path(folder, "cam0/data.csv");
    for (const CsvRow& row : left) {
        const auto partner = partners.find(row.time_ns);
        if (partner == partners.end()) {
            ++out.unpaired;
            continue;
        }
        FrameEntry entry;
        entry.time_ns = row.time_ns;
        entry.left = join_path(folder, "cam0/data/" + row.value);
        entry.right = join_path(folder, "cam1/data/" + partner->second->value);
        entry.where = fmt::format("{}:{}", left_csv, row.line);
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
    pair_rows(folder, *left, *right, recording);
    if (recording.frames.empty()) {
        return input_error(
            fmt::format("{}: no frames: {} rows of cam0 and {} of cam1 have no stamp in common",
                        folder,
                        left->size(),
                        right->size()));
    }
    Result<camera::StereoRig> rig = choose_rig(folder, options, recording.frames.front().left);
    if (!rig) return rig.error();
    recording.rig = std::move(rig).value();
    const std::string imu_csv = join_path(folder, "imu0/data.csv");
    if (recording.rig.imu && is_file(imu_csv)) {
        const Result<std::string> text = read_file(imu_csv);
        if (!text) return text.error();
        Result<std::vector<ImuSample>> samples = parse_euroc_imu_samples(*text, imu_csv);
        if (!samples) return samples.error();
        recording.imu = std::move(samples).value();
    }
    recording.info.frames = static_cast<int>(recording.frames.size());
    recording.info.has_imu = !recording.imu.empty();
    return recording;
}

}  // namespace surefoot::io
