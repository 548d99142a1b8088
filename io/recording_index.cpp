// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "io/file.hpp"
#include "io/image_file.hpp"
#include "io/recording.hpp"
#include "io/rig_file.hpp"
#include "io/text.hpp"
#include "surefoot/camera/rig_scaling.hpp"

namespace surefoot::io {
namespace {

Error at_line(const std::string& file, int line, const std::string& what) {
    return input_error(fmt::format("{}:{}: {}", file, line, what));
}

/// Stamps of a recording lie between 1970 and 2261, so that sums and differences stay in range.
constexpr std::int64_t kMaxStamp_ns = 9'200'000'000'000'000'000;

std::optional<std::int64_t> in_range(std::optional<std::int64_t> time_ns) {
    return time_ns && *time_ns >= 0 && *time_ns <= kMaxStamp_ns ? time_ns : std::nullopt;
}

bool is_kitti(const std::string& folder) {
    for (const char* name : {"image_0", "image_l", "image_2"}) {
        if (is_folder(join_path(folder, name))) return true;
    }
    return false;
}

/// Whichever layout the folder has.
Result<Recording> index_any(const std::string& folder, const OpenOptions& options) {
    const std::string inner = join_path(folder, "mav0");
    if (is_folder(join_path(inner, "cam0"))) return index_euroc(inner, options);
    if (is_folder(join_path(folder, "cam0"))) return index_euroc(folder, options);
    if (is_kitti(folder)) return index_kitti(folder, options);
    if (is_file(join_path(folder, "rgb.txt"))) return index_tum_rgbd(folder, options);
    return index_side_by_side(folder, options);
}

}  // namespace

Result<std::vector<CsvRow>> parse_euroc_frames(std::string_view text, const std::string& file) {
    std::vector<CsvRow> rows;
    LineReader lines(text);
    while (const auto line = lines.next()) {
        const std::string_view content = trimmed(*line);
        if (content.empty() || content[0] == '#') continue;
        const std::vector<std::string_view> fields = split(content, ",");
        const auto time_ns =
            fields.size() == 2 ? in_range(parse_int64(trimmed(fields[0]))) : std::nullopt;
        const std::string_view name = fields.size() == 2 ? trimmed(fields[1]) : std::string_view();
        if (!time_ns || name.empty()) {
            return at_line(
                file, lines.number(), "expected 'stamp_ns,file', found " + quoted(content));
        }
        rows.push_back({*time_ns, std::string(name), lines.number()});
    }
    return rows;
}

Result<std::vector<ImuSample>> parse_euroc_imu_samples(std::string_view text,
                                                       const std::string& file) {
    std::vector<ImuSample> samples;
    LineReader lines(text);
    while (const auto line = lines.next()) {
        const std::string_view content = trimmed(*line);
        if (content.empty() || content[0] == '#') continue;
        const std::vector<std::string_view> fields = split(content, ", \t");
        const auto time_ns = fields.size() == 7 ? in_range(parse_int64(fields[0])) : std::nullopt;
        if (!time_ns) {
            return at_line(file,
                           lines.number(),
                           "expected 'stamp_ns,wx,wy,wz,ax,ay,az', found " + quoted(content));
        }
        if (!samples.empty() && *time_ns <= samples.back().time_ns) {
            return at_line(file,
                           lines.number(),
                           fmt::format("IMU stamp {} ns does not grow: {} ns came before",
                                       *time_ns,
                                       samples.back().time_ns));
        }
        double v[6] = {};
        for (std::size_t i = 0; i < 6; ++i) {
            const auto value = parse_double(fields[i + 1]);
            if (!value || !std::isfinite(*value)) {
                return at_line(
                    file, lines.number(), quoted(fields[i + 1]) + " is not a finite number");
            }
            v[i] = *value;
        }
        samples.push_back({*time_ns, {v[0], v[1], v[2]}, {v[3], v[4], v[5]}});
    }
    return samples;
}

Result<std::vector<CsvRow>> parse_tum_list(std::string_view text, const std::string& file) {
    std::vector<CsvRow> rows;
    LineReader lines(text);
    while (const auto line = lines.next()) {
        const std::vector<std::string_view> words = split(*line);
        if (words.empty() || words[0].starts_with("#")) continue;
        const auto time_ns =
            words.size() == 2 ? in_range(parse_seconds_as_ns(words[0])) : std::nullopt;
        if (!time_ns) {
            return at_line(file, lines.number(), "expected 'stamp_s file', found " + quoted(*line));
        }
        rows.push_back({*time_ns, std::string(words[1]), lines.number()});
    }
    return rows;
}

std::optional<ImageSize> image_size_of(const std::string& path) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return std::nullopt;
    const Result<ImageHeader> header = check_image(*bytes, path);
    if (!header) return std::nullopt;
    return ImageSize{header->width, header->height};
}

std::optional<ImageSize> one_eye(std::optional<ImageSize> both) {
    if (!both || both->width % 2 != 0) return std::nullopt;
    return ImageSize{both->width / 2, both->height};
}

void fit_rig(camera::StereoRig& rig,
             std::optional<ImageSize> images,
             std::vector<std::string>& notes) {
    const ImageSize of_rig{rig.left.width, rig.left.height};
    if (!images || *images == of_rig) return;
    if (!camera::is_binning(rig.left, images->width, images->height)) return;
    Result<camera::StereoRig> scaled = camera::scaled_to(rig, images->width, images->height);
    if (!scaled) return;
    rig = std::move(scaled).value();
    notes.push_back(fmt::format(
        "the calibration for {} x {} px is scaled by {} to the images of {} x {} px; right only if "
        "these show the whole picture",
        of_rig.width,
        of_rig.height,
        static_cast<double>(images->width) / of_rig.width,
        images->width,
        images->height));
}

Result<std::optional<camera::StereoRig>> read_rig_beside(const std::string& folder,
                                                         const OpenOptions& options,
                                                         std::optional<ImageSize> size) {
    const std::string path = options.rig_file.value_or(join_path(folder, "rig.yaml"));
    if (!options.rig_file && !is_file(path)) return std::optional<camera::StereoRig>();
    Result<camera::StereoRig> rig = read_rig(path, size);
    if (!rig) return rig.error();
    return std::optional<camera::StereoRig>(std::move(rig).value());
}

Result<double> chosen_rate_hz(const OpenOptions& options, double otherwise_hz) {
    const double rate_hz = options.rate_hz.value_or(otherwise_hz);
    constexpr double kMin_hz = 1e-3;
    constexpr double kMax_hz = 1e4;
    if (rate_hz >= kMin_hz && rate_hz <= kMax_hz) return rate_hz;
    return usage_error(
        fmt::format("--rate {}: a frame rate must be {} .. {} Hz", rate_hz, kMin_hz, kMax_hz));
}

Status refuse_rate(const OpenOptions& options, const std::string& file) {
    if (!options.rate_hz) return {};
    return usage_error(fmt::format(
        "--rate {}: {} has stamps of its own; leave the rate away", *options.rate_hz, file));
}

std::int64_t stamp_at(int index, double rate_hz) noexcept {
    return static_cast<std::int64_t>(std::llround(static_cast<double>(index) * 1e9 / rate_hz));
}

Result<Recording> index_recording(const std::string& folder, const OpenOptions& options) {
    if (!is_folder(folder)) return input_error(fmt::format("{}: no such folder", folder));
    Result<Recording> recording = index_any(folder, options);
    if (!recording || recording->frames.empty()) return recording;
    const std::optional<ImageSize> size = image_size_of(recording->frames.front().left);
    const bool side_by_side = recording->storage == Recording::Storage::side_by_side;
    fit_rig(recording->rig, side_by_side ? one_eye(size) : size, recording->info.notes);
    return recording;
}

}  // namespace surefoot::io
