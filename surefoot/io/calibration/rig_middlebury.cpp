// SPDX-License-Identifier: Apache-2.0
// Reads calib.txt of the Middlebury stereo sets, after Scharstein et al. 2014, "High-resolution
// stereo datasets with subpixel-accurate ground truth". The images are rectified, and their
// principal points differ by doffs = cx1 - cx0 [px]. The baseline is in mm; depth = baseline * f /
// (disparity + doffs).
#include <fmt/format.h>

#include <cmath>
#include <map>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_lens.hpp"
#include "surefoot/io/calibration/rig_values.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// Tolerance of doffs: Middlebury files print doffs with three decimals.
constexpr double kDoffsTolerance_px = 2e-3;

/// Reads "key=value" lines and keeps the first failure.
class MiddleburyReader {
  public:
    MiddleburyReader(std::string_view text, std::string file) : file_(std::move(file)) {
        if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
        LineReader lines(text);
        while (const auto line = lines.next()) {
            const std::size_t equals = line->find('=');
            if (equals == line->npos) continue;
            lines_.emplace(trimmed(line->substr(0, equals)),
                           Line{std::string(trimmed(line->substr(equals + 1))), lines.number()});
        }
    }

    [[nodiscard]] bool has(const char* key) const { return lines_.contains(key); }
    /// Reads the numbers of "4161.221", or of "[f 0 cx; 0 f cy; 0 0 1]" row by row.
    std::vector<double> numbers(const char* key, std::size_t count) {
        std::vector<double> values;
        const auto found = lines_.find(key);
        if (found == lines_.end()) {
            fail(fmt::format("{}: the line '{}=' is missing", file_, key));
            return std::vector<double>(count, 0.0);
        }
        for (const std::string_view word : split(found->second.text, " \t[];,")) {
            const auto value = parse_double(word);
            if (!value || !std::isfinite(*value)) {
                fail(fmt::format(
                    "{}:{}: {}: {} is not a number", file_, found->second.line, key, quoted(word)));
            }
            values.push_back(value.value_or(0.0));
        }
        if (values.size() != count) {
            fail(fmt::format("{}:{}: {}: found {} numbers; exactly {} are needed",
                             file_,
                             found->second.line,
                             key,
                             values.size(),
                             count));
        }
        values.resize(count, 0.0);
        return values;
    }
    double number(const char* key) { return numbers(key, 1).front(); }
    int side(const char* key) {
        const double side_px = number(key);
        if (side_px >= 1.0 && side_px <= kMaxRigSide_px && side_px == std::floor(side_px))
            return static_cast<int>(side_px);  // in range, as checked
        fail(fmt::format(
            "{}: {}: {} is not an image side of 1 .. {} px", file_, key, side_px, kMaxRigSide_px));
        return 1;
    }
    void fail(const std::string& what) {
        if (!error_) error_ = input_error(what);
    }
    [[nodiscard]] const std::optional<Error>& error() const { return error_; }

  private:
    struct Line {
        std::string text;
        int line = 0;
    };
    std::string file_;
    std::map<std::string, Line, std::less<>> lines_;
    std::optional<Error> error_;
};

std::vector<double> read_intrinsics(MiddleburyReader& in,
                                    const char* key,
                                    const std::string& file) {
    const std::vector<double> K = in.numbers(key, 9);
    if (!in.error() && !(K[0] > 0.0 && K[4] > 0.0)) {
        in.fail(fmt::format(
            "{}: {}: focal lengths {} and {} must be above 0 px", file, key, K[0], K[4]));
    }
    return {K[0], K[4], K[2], K[5]};
}

}  // namespace

Result<RigFile> parse_middlebury_rig(std::string_view text,
                                     const std::string& file,
                                     std::optional<ImageSize> size) {
    MiddleburyReader in(text, file);
    const std::vector<double> left = read_intrinsics(in, "cam0", file);
    const std::vector<double> right = read_intrinsics(in, "cam1", file);
    const double baseline_mm = in.number("baseline");
    const bool holds_size = in.has("width") || in.has("height") || !size;
    const ImageSize image = holds_size ? ImageSize{in.side("width"), in.side("height")} : *size;
    RigFile out;
    if (in.has("doffs")) {
        const double doffs_px = in.number("doffs");
        const double differ_px = right[2] - left[2];
        if (!(std::abs(doffs_px - differ_px) <= kDoffsTolerance_px)) {
            in.fail(
                fmt::format("{}: doffs is {} px, but the principal points of cam1 and cam0 differ "
                            "by {:.3f} px; copy the file again",
                            file,
                            doffs_px,
                            differ_px));
        }
    }
    if (in.error()) return *in.error();
    out.format = RigFormat::middlebury;
    out.rig.name = "middlebury";
    out.rig.left = {make_pinhole(left, {}), image.width, image.height};
    out.rig.right = camera::Camera{make_pinhole(right, {}), image.width, image.height};
    out.rig.T_left_right.translation_m.x() = 1e-3 * baseline_mm;
    if (right[2] != left[2]) {
        out.notes.push_back(
            fmt::format("the principal points differ by doffs = {:.3f} px: a disparity of these "
                        "images is f * baseline / depth - doffs",
                        right[2] - left[2]));
    }
    return checked_file(std::move(out), file);
}

}  // namespace surefoot::io
