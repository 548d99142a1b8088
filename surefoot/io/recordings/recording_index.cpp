// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "surefoot/camera/rig_scaling.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/recordings/recording.hpp"
#include "surefoot/io/recordings/stamps.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

Error at_line(const std::string& file, int line, const std::string& what) {
    return input_error(fmt::format("{}:{}: {}", file, line, what));
}

std::optional<std::int64_t> in_range(std::optional<std::int64_t> time_ns) {
    return time_ns && *time_ns >= 0 && *time_ns <= kMaxStamp_ns ? time_ns : std::nullopt;
}

/// Indexes the folder with the first layout that fits.
Result<Recording> index_any(const std::string& folder, const OpenOptions& options) {
    const std::string inner = join_path(folder, "mav0");
    for (const std::string& euroc : {inner, folder}) {
        if (!is_folder(join_path(euroc, "cam0"))) continue;
        const bool listed = is_file(join_path(euroc, "cam0/data.csv"));
        return listed || !has_pair_folders(euroc) ? index_euroc(euroc, options)
                                                  : index_pair_folders(euroc, options);
    }
    for (const char* list : {"rgb.txt", "associations.txt", "association.txt", "associate.txt"}) {
        if (is_file(join_path(folder, list))) return index_tum_rgbd(folder, options);
    }
    if (has_pair_folders(folder)) return index_pair_folders(folder, options);
    return index_side_by_side(folder, options);
}

/// Finds the number of bits that the values of 16-bit camera images use. Frames with mixed bit
/// depths fail later, one by one.
Status choose_image_bits(const OpenOptions& options, Recording& recording) {
    if (recording.storage == Recording::Storage::rgbd) return {};
    const auto& frames = recording.frames;
    unsigned largest = 0;
    for (const std::size_t i : {std::size_t{0}, frames.size() / 2, frames.size() - 1}) {
        const Result<std::string> bytes = read_file(frames[i].left, limits::kImageBytes);
        if (!bytes) return {};  // reading the frame reports the error
        const Result<ImageHeader> header = check_image(*bytes, frames[i].left);
        if (!header || header->bits != 16) return {};
        const Result<DepthCodes> codes = parse_depth_codes(*bytes, frames[i].left);
        if (!codes) return {};
        for (std::size_t k = 0; k < codes->size(); ++k)
            largest = std::max<unsigned>(largest, codes->data()[k]);
    }
    // Sensors have 10, 12, 14 or 16 bits. Cameras often shift values of fewer bits up to 16 bits.
    int guess = 16;
    for (const int bits : {14, 12, 10})
        if (largest > 0 && static_cast<int>(std::bit_width(largest)) <= bits) guess = bits;
    recording.image_bits = options.image_bits.value_or(guess);
    if (recording.image_bits < 9 || recording.image_bits > 16)
        return usage_error(fmt::format("--image-bits {}: give 9 to 16", recording.image_bits));
    recording.info.notes.push_back(
        fmt::format("16-bit images: the upper 8 of {} bits are used{}",
                    recording.image_bits,
                    options.image_bits
                        ? std::string()
                        : fmt::format(" (the largest value in the first, middle and last image is "
                                      "{}); if this is wrong, give --image-bits",
                                      largest)));
    return {};
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
            return at_line(
                file,
                lines.number(),
                fmt::format("IMU time stamp {} ns does not increase: the previous one is {} ns",
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

Result<std::vector<AssociatedRow>> parse_associations(std::string_view text,
                                                      const std::string& file) {
    std::vector<AssociatedRow> rows;
    LineReader lines(text);
    while (const auto line = lines.next()) {
        const std::vector<std::string_view> words = split(*line);
        if (words.empty() || words[0].starts_with("#")) continue;
        const bool four = words.size() == 4;
        const auto first_ns = four ? in_range(parse_seconds_as_ns(words[0])) : std::nullopt;
        const auto second_ns = four ? in_range(parse_seconds_as_ns(words[2])) : std::nullopt;
        if (!first_ns || !second_ns) {
            return at_line(file,
                           lines.number(),
                           "expected 'stamp_s file stamp_s file', found " + quoted(*line));
        }
        AssociatedRow row{{*first_ns, std::string(words[1]), lines.number()},
                          {*second_ns, std::string(words[3]), lines.number()}};
        const auto is_depth = [](const CsvRow& image) {
            return image.value.find("depth") != image.value.npos;
        };
        if (is_depth(row.colour) && !is_depth(row.depth)) std::swap(row.colour, row.depth);
        rows.push_back(std::move(row));
    }
    return rows;
}

Result<std::vector<std::int64_t>> parse_timestamps(std::string_view text, const std::string& file) {
    std::vector<std::int64_t> times_ns;
    LineReader lines(text);
    while (const auto line = lines.next()) {
        const std::vector<std::string_view> words = split(trimmed(*line));
        if (words.empty()) continue;
        const auto day = words.size() == 2 ? split(words[0], "-") : std::vector<std::string_view>();
        const auto clock =
            words.size() == 2 ? split(words[1], ":") : std::vector<std::string_view>();
        std::optional<std::int64_t> time_ns;
        if (day.size() == 3 && clock.size() == 3) {
            const auto number = [](std::string_view word, std::int64_t least, std::int64_t most) {
                const auto value = parse_int64(word);
                return value && *value >= least && *value <= most ? value : std::nullopt;
            };
            const auto year = number(day[0], 1970, 2200);
            const auto month = number(day[1], 1, 12);
            const auto date = number(day[2], 1, 31);
            const auto hour = number(clock[0], 0, 23);
            const auto minute = number(clock[1], 0, 59);
            const auto second_ns = parse_seconds_as_ns(clock[2]);
            if (year && month && date && hour && minute && second_ns && *second_ns >= 0 &&
                *second_ns < 61'000'000'000) {
                const std::chrono::year_month_day named =
                    std::chrono::year(static_cast<int>(*year)) /
                    std::chrono::month(static_cast<unsigned>(*month)) /
                    std::chrono::day(static_cast<unsigned>(*date));
                const std::chrono::sys_days days = named;
                const std::int64_t minutes =
                    (days.time_since_epoch().count() * 24LL + *hour) * 60 + *minute;
                // Without this check 30 February would silently become a day of March.
                if (named.ok()) time_ns = in_range(minutes * 60'000'000'000 + *second_ns);
            }
        }
        if (!time_ns) {
            return at_line(
                file, lines.number(), "expected 'YYYY-MM-DD hh:mm:ss.s', found " + quoted(*line));
        }
        times_ns.push_back(*time_ns);
    }
    return times_ns;
}

void set_pair_tolerance(const OpenOptions& options,
                        std::int64_t otherwise_ns,
                        Recording& recording) {
    recording.pair_tolerance_s =
        options.pair_tolerance_s.value_or(1e-9 * static_cast<double>(otherwise_ns));
}

Partners pair_stamps(const std::vector<std::int64_t>& left_ns,
                     const std::vector<std::int64_t>& right_ns,
                     Recording& recording) {
    Partners partners =
        pair_by_time(left_ns,
                     right_ns,
                     saturated_integer<std::int64_t>(std::round(1e9 * recording.pair_tolerance_s)));
    std::int64_t largest_ns = 0;
    for (std::size_t i = 0; i < partners.size(); ++i) {
        if (!partners[i]) {
            ++recording.unpaired;
        } else {
            largest_ns = std::max(largest_ns, std::abs(left_ns[i] - right_ns[*partners[i]]));
        }
    }
    recording.largest_pair_difference_s = 1e-9 * static_cast<double>(largest_ns);
    const std::string within =
        fmt::format("within {:g} ms (--pair-tolerance)", 1e3 * recording.pair_tolerance_s);
    if (largest_ns > 0) {
        recording.info.notes.push_back(fmt::format(
            "the time stamps of the two images of a frame differ by up to {:.3f} ms. Images are "
            "paired {}, and the frame gets the time stamp of its left (or colour) image",
            1e3 * recording.largest_pair_difference_s,
            within));
    }
    if (recording.unpaired > 0 && recording.unpaired < static_cast<int>(partners.size())) {
        recording.info.notes.push_back(
            fmt::format("{} of {} images have no partner {} and are left out",
                        recording.unpaired,
                        partners.size(),
                        within));
    }
    return partners;
}

std::optional<ImageSize> image_size_of(const std::string& path) {
    const Result<std::string> bytes = read_file(path, limits::kImageBytes);
    if (!bytes) return std::nullopt;
    const Result<ImageHeader> header = check_image(*bytes, path);
    if (!header) return std::nullopt;
    return ImageSize{header->width, header->height};
}

std::optional<ImageSize> one_camera(std::optional<ImageSize> both) {
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
    notes.push_back(
        fmt::format("the calibration for {} x {} px is scaled by {} to the images of {} x {} px; "
                    "this is correct only if the images show the whole field of view",
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
        fmt::format("--rate {}: a frame rate must be {} to {} Hz", rate_hz, kMin_hz, kMax_hz));
}

Status refuse_rate(const OpenOptions& options, const std::string& file) {
    if (!options.rate_hz) return {};
    return usage_error(
        fmt::format("--rate {}: {} has time stamps of its own; remove the option --rate",
                    *options.rate_hz,
                    file));
}

std::int64_t stamp_at(int index, double rate_hz) noexcept {
    return saturated_integer<std::int64_t>(std::round(static_cast<double>(index) * 1e9 / rate_hz));
}

Result<Recording> index_recording(const std::string& folder, const OpenOptions& options) {
    if (!is_folder(folder)) return input_error(fmt::format("{}: no such folder", folder));
    Result<Recording> recording = index_any(folder, options);
    if (!recording || recording->frames.empty()) return recording;
    const std::optional<ImageSize> size = image_size_of(recording->frames.front().left);
    const bool side_by_side = recording->storage == Recording::Storage::side_by_side;
    fit_rig(recording->rig, side_by_side ? one_camera(size) : size, recording->info.notes);
    if (Status status = choose_image_bits(options, *recording); !status) return status.error();
    return recording;
}

}  // namespace surefoot::io
