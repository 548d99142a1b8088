// SPDX-License-Identifier: Apache-2.0
// Reads and writes Stereolabs' SN<serial>.conf, after their camera calibration page and their open
// tools. zed-open-capture reads such files; the ZED stereo calibration tool writes them with R and
// T of OpenCV.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "surefoot/camera/rig_units.hpp"
#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/calibration/rig_lens.hpp"
#include "surefoot/io/calibration/rig_values.hpp"
#include "surefoot/io/settings/ini.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

struct Mode {
    const char* name;
    ImageSize size;  ///< image size of one camera
};
/// Stereolabs' names of the resolutions of their stereo cameras.
constexpr std::array<Mode, 8> kModes{{{"2K", {2208, 1242}},
                                      {"FHD", {1920, 1080}},
                                      {"HD", {1280, 720}},
                                      {"VGA", {672, 376}},
                                      {"FHD1200", {1920, 1200}},
                                      {"SVGA", {960, 600}},
                                      {"4k", {3840, 2160}},
                                      {"QHDPLUS", {3200, 1800}}}};

constexpr std::array<const char*, 8> kRationalKeys{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
/// Thin-prism terms; some newer files contain them.
constexpr std::array<const char*, 4> kPrismKeys{"s1", "s2", "s3", "s4"};

std::string size_text(ImageSize size) {
    return fmt::format("{}x{}", size.width, size.height);
}

/// Reads numbers of a ZED file. Keeps the error of the first missing or wrong number; later calls
/// return 0.
class ZedReader {
  public:
    explicit ZedReader(const IniFile& ini) : ini_(ini) {}

    double number(std::string_view section, std::string_view key) {
        if (error_) return 0.0;
        const Result<double> value = ini_.number(section, key);
        if (!value) error_ = value.error();
        return value ? *value : 0.0;
    }
    double number_or(std::string_view section, std::string_view key, double otherwise) {
        return ini_.find(section, key) == nullptr ? otherwise : number(section, key);
    }
    /// Reads a number under the first existing spelling; reports the first spelling if none exists.
    double any_number(std::string_view section, std::initializer_list<std::string> keys) {
        for (const std::string& key : keys) {
            if (ini_.find(section, key) != nullptr) return number(section, key);
        }
        fail(fmt::format(
            "[{0}] has no '{1}'. Download the file of this serial number again, or add the line "
            "'{1} = 0'. Stereolabs' programs also use 0 if an older file has no such key",
            section,
            *keys.begin()));
        return 0.0;
    }
    void fail(const std::string& what) {
        if (!error_) error_ = input_error(fmt::format("{}: {}", ini_.name, what));
    }
    [[nodiscard]] const IniFile& ini() const { return ini_; }
    [[nodiscard]] const std::optional<Error>& error() const { return error_; }

  private:
    const IniFile& ini_;
    std::optional<Error> error_;
};

bool has_all(const IniFile& ini, const std::string& section, std::span<const char* const> keys) {
    for (const char* key : keys) {
        if (ini.find(section, key) == nullptr) return false;
    }
    return true;
}

/// Selects the section of the resolution `size`. Without `size` the file must have only one
/// resolution.
Result<Mode> choose_mode(const IniFile& ini, std::optional<ImageSize> size) {
    std::vector<std::string> found;
    const Mode* chosen = nullptr;
    for (const Mode& mode : kModes) {
        if (ini.find(fmt::format("LEFT_CAM_{}", mode.name)) == nullptr) continue;
        found.push_back(fmt::format("{} ({})", mode.name, size_text(mode.size)));
        if (!size || *size == mode.size) chosen = &mode;
    }
    if (found.empty()) {
        return input_error(fmt::format(
            "{}: no [LEFT_CAM_x] section of a known resolution (2K, FHD, HD, VGA ...)", ini.name));
    }
    if (chosen != nullptr && (size || found.size() == 1)) return *chosen;
    if (size) {
        return input_error(fmt::format(
            "{}: the file has no section for {} px, only {}. A ZED crops its sensor differently "
            "for each resolution, so no section can be scaled. Use images of one of these sizes",
            ini.name,
            size_text(*size),
            fmt::join(found, ", ")));
    }
    return input_error(
        fmt::format("{}: the file has several resolutions: {}. Use the file with its images, or "
                    "select a resolution with 'surefoot rig FILE --resolution WxH --out rig.yaml'",
                    ini.name,
                    fmt::join(found, ", ")));
}

camera::CameraModel lens_or_fail(ZedReader& zed,
                                 const std::string& section,
                                 const Result<camera::CameraModel>& lens) {
    if (lens) return *lens;
    zed.fail(fmt::format("[{}] {}", section, lens.error().message));
    return {};
}

camera::CameraModel read_lens(ZedReader& zed,
                              const std::string& side,
                              const std::string& section,
                              RigFile& out) {
    const std::vector<double> k{zed.number(section, "fx"),
                                zed.number(section, "fy"),
                                zed.number(section, "cx"),
                                zed.number(section, "cy")};
    if (!zed.error() && !(k[0] > 0.0 && k[1] > 0.0)) {
        zed.fail(
            fmt::format("[{}] focal lengths {} and {} must be above 0 px", section, k[0], k[1]));
    }
    const std::string lens = side + "_DISTO";
    const auto read = [&](const std::string& from, std::span<const char* const> keys) {
        std::vector<double> values;
        for (const char* key : keys) values.push_back(zed.number(from, key));
        return values;
    };
    if (has_all(zed.ini(), lens, kRationalKeys)) {
        std::vector<double> D = read(lens, kRationalKeys);
        for (const char* key : kPrismKeys) D.push_back(zed.number_or(lens, key, 0.0));
        return lens_or_fail(zed, lens, pinhole_lens(k, std::move(D)));
    }
    static constexpr std::array<const char*, 4> kFisheyeKeys{"k1", "k2", "k3", "k4"};
    if (has_all(zed.ini(), lens, kFisheyeKeys) && zed.ini().find(lens)->size() == 4) {
        return lens_or_fail(zed, lens, fisheye_lens(k, read(lens, kFisheyeKeys)));
    }
    if (zed.ini().find(lens) != nullptr) {
        out.notes.push_back(fmt::format(
            "[{}] is left out: it has neither all of k1 k2 p1 p2 k3 k4 k5 k6 nor only k1 k2 k3 k4",
            lens));
    }
    return make_pinhole(k,
                        {zed.number(section, "k1"),
                         zed.number(section, "k2"),
                         zed.number_or(section, "p1", 0.0),
                         zed.number_or(section, "p2", 0.0),
                         zed.number_or(section, "k3", 0.0)});
}

/// Reads T_left_right from the values of this mode, or from the values for all modes.
Pose read_extrinsics(ZedReader& zed, const std::string& mode) {
    const auto value = [&](const char* key) {
        return zed.any_number("STEREO", {fmt::format("{}_{}", key, mode), key});
    };
    const double baseline_mm = zed.number("STEREO", "Baseline");
    if (!zed.error() && !(baseline_mm > 0.0)) {
        zed.fail(
            fmt::format("[STEREO] Baseline = {} must be above 0; it is the distance between the "
                        "cameras in millimetres",
                        baseline_mm));
    } else if (const auto problem = camera::baseline_problem(1e-3 * baseline_mm);
               !zed.error() && problem) {
        zed.fail(fmt::format("[STEREO] Baseline = {}, in millimetres: {}", baseline_mm, *problem));
    }
    const double y_mm =
        value("TY");  // read in this order, so that the first missing key is reported
    const double z_mm = value("TZ");
    const Eigen::Vector3d t_mm(-baseline_mm, y_mm, z_mm);
    const double convergence = zed.any_number(
        "STEREO", {fmt::format("CV_{}", mode), fmt::format("RY_{}", mode), "CV", "RY"});
    const double rx_rad = value("RX");
    const Eigen::Vector3d rotation(rx_rad, convergence, value("RZ"));
    const Pose T_right_left{exp_so3(rotation), 1e-3 * t_mm};
    return T_right_left.inverse();
}

/// Adds one note for sections with unknown names.
void note_unknown(const IniFile& ini, RigFile& out) {
    std::vector<std::string> unknown;
    for (const auto& [name, values] : ini.sections) {
        if (name == "stereo" || name == "left_disto" || name == "right_disto") continue;
        if (name.starts_with("left_cam_") || name.starts_with("right_cam_")) continue;
        unknown.push_back("[" + name + "]");
    }
    if (unknown.empty()) return;
    out.notes.push_back(fmt::format("unknown sections are left out: {}", fmt::join(unknown, ", ")));
}

std::string format_disto(const char* side, const camera::CameraModel& model) {
    std::vector<double> D = coefficients_of(model);
    D.resize(kRationalKeys.size(), 0.0);
    std::string out = fmt::format("\n[{}_DISTO]\n", side);
    for (std::size_t i = 0; i < D.size(); ++i) {
        out += fmt::format("{} = {}\n", kRationalKeys[i], format_double(D[i]));
    }
    return out;
}

std::string format_camera(const char* side,
                          const char* mode,
                          const camera::CameraModel& model,
                          bool with_lens) {
    const std::vector<double> k = intrinsics_of(model);
    std::string out = fmt::format("\n[{}_CAM_{}]\nfx = {}\nfy = {}\ncx = {}\ncy = {}\n",
                                  side,
                                  mode,
                                  format_double(k[0]),
                                  format_double(k[1]),
                                  format_double(k[2]),
                                  format_double(k[3]));
    if (!with_lens) return out;
    const std::vector<double> D = coefficients_of(model);
    for (std::size_t i = 0; i < D.size(); ++i) {
        out += fmt::format("{} = {}\n", kRationalKeys[i], format_double(D[i]));
    }
    return out;
}

const Mode* mode_of(const camera::Camera& camera) {
    for (const Mode& mode : kModes) {
        if (mode.size == ImageSize{camera.width, camera.height}) return &mode;
    }
    return nullptr;
}

}  // namespace

Result<RigFile> parse_zed_rig(std::string_view text,
                              const std::string& file,
                              std::optional<ImageSize> size) {
    const Result<IniFile> ini = parse_ini(text, file);
    if (!ini) return ini.error();
    const Result<Mode> mode = choose_mode(*ini, size);
    if (!mode) return mode.error();
    ZedReader zed(*ini);
    RigFile out;
    out.format = RigFormat::zed;
    out.rig.name = "zed";
    const auto read_camera = [&](const std::string& side) {
        const std::string section = fmt::format("{}_CAM_{}", side, mode->name);
        return camera::Camera{
            read_lens(zed, side, section, out), mode->size.width, mode->size.height};
    };
    out.rig.left = read_camera("LEFT");
    out.rig.right = read_camera("RIGHT");
    out.rig.T_left_right = read_extrinsics(zed, mode->name);
    if (zed.error()) return *zed.error();
    note_unknown(*ini, out);
    return checked_file(std::move(out), file);
}

Result<std::string> format_zed_rig(const camera::StereoRig& rig) {
    if (Status status = check_pair(rig, "ZED"); !status) return status.error();
    const Mode* mode = mode_of(rig.left);
    if (mode == nullptr) {
        return output_error(fmt::format(
            "a ZED file cannot store a calibration for images of {}x{} px; choose another format",
            rig.left.width,
            rig.left.height));
    }
    if (is_kannala_brandt(rig.left.model) || is_kannala_brandt(rig.right->model)) {
        return output_error(
            "a ZED file for stereo cameras stores only pinhole lenses, but this rig has a fisheye "
            "lens; choose another format");
    }
    const bool rational = is_rational(rig.left.model) || is_rational(rig.right->model);
    const Pose T_right_left = rig.T_left_right.inverse();
    const Eigen::Vector3d t_mm = 1e3 * T_right_left.translation_m;
    const Eigen::Vector3d rotation = log_so3(T_right_left.rotation);
    std::string out = format_camera("LEFT", mode->name, rig.left.model, !rational) +
                      format_camera("RIGHT", mode->name, rig.right->model, !rational);
    out.erase(0, 1);  // remove the empty line before the first section
    if (rational) {
        out += format_disto("LEFT", rig.left.model) + format_disto("RIGHT", rig.right->model);
    }
    return out + fmt::format(
                     "\n[STEREO]\nBaseline = {}\nTY = {}\nTZ = {}\nRX_{} = {}\nCV_{} = {}\n"
                     "RZ_{} = {}\n",
                     format_double(-t_mm.x()),
                     format_double(t_mm.y()),
                     format_double(t_mm.z()),
                     mode->name,
                     format_double(rotation.x()),
                     mode->name,
                     format_double(rotation.y()),
                     mode->name,
                     format_double(rotation.z()));
}

}  // namespace surefoot::io
