// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/rig_units.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace surefoot::camera {
namespace {

/// Usual baselines of cameras that people carry or mount on a machine. For example, a ZED-X Nano
/// has 18 mm, and cameras on a car have 0.6 m.
constexpr double kUsualMin_m = 0.01;
constexpr double kUsualMax_m = 1.0;
/// A calibration with squares of side 1 gives the baseline in squares. Real squares are 20-100 mm.
constexpr double kMostSquares = 50.0;
constexpr double kMaxMount_m = 10.0;

bool is_usual(double length_m) {
    return length_m >= kUsualMin_m && length_m <= kUsualMax_m;
}

/// Returns ": is it in mm (then 60.8 mm)?", for example, or "." if no unit gives a usual baseline.
std::string likely_units(double number) {
    struct Unit {
        const char* name;
        double metres;
    };
    std::vector<std::string> likely;
    for (const Unit unit : {Unit{"km", 1e3}, Unit{"cm", 1e-2}, Unit{"mm", 1e-3}}) {
        const double length_m = number * unit.metres;
        if (is_usual(length_m))
            likely.push_back(fmt::format("in {} (then {:.1f} mm)", unit.name, 1e3 * length_m));
    }
    if (number > kUsualMax_m && number <= kMostSquares)
        likely.emplace_back("in squares of a chessboard");
    if (likely.empty()) return ".";
    return fmt::format(": is it {}?", fmt::join(likely, ", or "));
}

}  // namespace

std::optional<std::string> baseline_problem(double length_m) {
    if (length_m >= kMinBaseline_m && length_m <= kMaxBaseline_m) return std::nullopt;
    if (length_m > kMaxBaseline_m) {
        return fmt::format("baseline {:.3f} m exceeds {} m{} Give it in metres",
                           length_m,
                           kMaxBaseline_m,
                           likely_units(length_m));
    }
    return fmt::format(
        "baseline {:.3f} mm is below {} mm{} Give the distance of the cameras in metres",
        1e3 * length_m,
        1e3 * kMinBaseline_m,
        likely_units(length_m));
}

std::optional<std::string> baseline_warning(double length_m) {
    if (baseline_problem(length_m) || is_usual(length_m)) return std::nullopt;
    return fmt::format(
        "baseline {:.3f} m is {} than {} m{} Every depth has the same error as the baseline: "
        "measure the distance of the lenses with a ruler",
        length_m,
        length_m < kUsualMin_m ? "shorter" : "longer",
        length_m < kUsualMin_m ? kUsualMin_m : kUsualMax_m,
        likely_units(length_m));
}

std::optional<std::string> focal_problem(double focal_px) {
    constexpr double kMaxFocal_px = 1e6;
    if (focal_px <= kMaxFocal_px) return std::nullopt;
    return fmt::format(
        "focal length {:g} px exceeds {:g} px: give it in pixels", focal_px, kMaxFocal_px);
}

std::optional<std::string> focal_warning(double focal_px, int width_px) {
    constexpr double kLeastOfWidth = 0.05;  // 2 atan(10) = 168.6 deg
    if (!(focal_px < kLeastOfWidth * width_px)) return std::nullopt;
    return fmt::format(
        "focal length {:.2f} px is too short for an image of {} px: is it in mm? In pixels it is "
        "the focal length divided by the side of a pixel, both in mm",
        focal_px,
        width_px);
}

std::optional<std::string> mount_problem(std::string_view name, double distance_m) {
    if (distance_m <= kMaxMount_m) return std::nullopt;
    return fmt::format(
        "{} is {:.1f} m from base_link, at most {} m are allowed; is it in mm or cm? "
        "Give it in metres",
        name,
        distance_m,
        kMaxMount_m);
}

}  // namespace surefoot::camera
