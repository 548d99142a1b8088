// SPDX-License-Identifier: Apache-2.0
// How many boards does our board finder find, compared with OpenCV's finders? Inputs: rendered
// chessboards through wide lenses, folders of real images, and images without a board.
// Usage: board_finders OUT.csv rendered FIRST_SEED SEEDS [ours]
//        board_finders OUT.csv images NAME FOLDER BOARD [ours]
//   SEEDS   number of seeds; each seed renders one board per lens and condition
//   NAME    name of the image set in the output
//   FOLDER  folder of images
//   BOARD   board description, for example chessboard:8x5:0.03
//   ours    leave OpenCV's finders out
//
// Writes OUT.csv, one line per image and finder: set, image, finder, found (0 or 1), right
// (rendered only: every returned corner is within 1.5 px of a true one, and at least three quarters
// of the corners are returned), median corner error in px (rendered only), time in ms, and our
// finder's message (problem) if it finds no board.
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "surefoot/calibration/boards/detect_board.hpp"
#include "surefoot/calibration/boards/wide_boards_testing.hpp"

namespace surefoot {
namespace {

using calibration::Board;
using Corners = std::vector<Eigen::Vector2d>;

constexpr calibration::ImageSize kSize{640, 480};
constexpr double kMostTilt_deg = 60.0;
constexpr double kLeastStep_px = 4.5;
constexpr double kSame_px = 1.5;

struct Finder {
    const char* name;
    std::function<bool(const cv::Mat&, cv::Size, std::vector<cv::Point2f>&)> find;
};

std::vector<Finder> opencv_finders() {
    const auto sb = [](int flags) {
        return [flags](const cv::Mat& image, cv::Size size, std::vector<cv::Point2f>& corners) {
            return cv::findChessboardCornersSB(image, size, corners, flags);
        };
    };
    const auto classic = [](int flags) {
        return [flags](const cv::Mat& image, cv::Size size, std::vector<cv::Point2f>& corners) {
            return cv::findChessboardCorners(image, size, corners, flags);
        };
    };
    const int usual = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE;
    return {{"SB", sb(cv::CALIB_CB_NORMALIZE_IMAGE)},
            {"SB exhaustive", sb(cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE)},
            {"SB accuracy", sb(cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY)},
            {"classic, fast check", classic(usual | cv::CALIB_CB_FAST_CHECK)},
            {"classic", classic(usual)}};
}

cv::Mat mat_of(const GreyImage& image) {
    return {image.height(),
            image.width(),
            CV_8UC1,
            const_cast<std::uint8_t*>(image.data())};  // OpenCV only reads the image
}

/// Returns true if each found corner matches a different true corner and at least three quarters of
/// the true corners are found. The order of the corners does not matter.
bool are_right(const Corners& found, const Corners& truth, double& median_px) {
    std::vector<bool> taken(truth.size(), false);
    std::vector<double> errors;
    for (const Eigen::Vector2d& corner : found) {
        std::size_t nearest = 0;
        for (std::size_t i = 1; i < truth.size(); ++i)
            if ((truth[i] - corner).norm() < (truth[nearest] - corner).norm()) nearest = i;
        errors.push_back((truth[nearest] - corner).norm());
        if (taken[nearest] || errors.back() > kSame_px) return false;
        taken[nearest] = true;
    }
    if (4 * errors.size() < 3 * truth.size()) return false;
    std::sort(errors.begin(), errors.end());
    median_px = errors[errors.size() / 2];
    return true;
}

/// Checks the corners of our finder, which numbers them. Each corner must also match the true
/// corner with its number. A board that looks the same after a rotation may be rotated.
bool are_ours_right(const Board& board,
                    const calibration::BoardView& view,
                    const Corners& truth,
                    double& median_px) {
    if (!are_right(view.pixels, truth, median_px)) return false;
    const auto turns = calibration::turns_of(board);
    return std::any_of(turns.begin(), turns.end(), [&](const std::vector<int>& turn) {
        for (std::size_t i = 0; i < view.ids.size(); ++i) {
            const auto id = static_cast<std::size_t>(turn[static_cast<std::size_t>(view.ids[i])]);
            if ((truth[id] - view.pixels[i]).norm() > kSame_px) return false;
        }
        return true;
    });
}

class Table {
  public:
    Table(const std::string& path, bool only_ours) : out_(fmt::output_file(path)) {
        if (!only_ours) finders_ = opencv_finders();
        out_.print("set,image,finder,found,right,median_px,ms,problem\n");
    }

    /// Runs all finders on one image. `truth` is empty if the true corners are unknown.
    void add(const std::string& set,
             const std::string& name,
             const Board& board,
             const GreyImage& image,
             const Corners& truth) {
        const auto begin = std::chrono::steady_clock::now();
        const auto sighting = calibration::detect_board(board, image.view());
        double median_px = 0.0;
        const bool right = sighting.found() && !truth.empty() &&
                           are_ours_right(board, sighting.view, truth, median_px);
        print(set, name, "ours", sighting.found(), right, median_px, begin, sighting.problem);
        for (const Finder& finder : finders_) {
            const auto start = std::chrono::steady_clock::now();
            std::vector<cv::Point2f> corners;
            const bool found =
                finder.find(mat_of(image), cv::Size(board.columns, board.rows), corners);
            Corners points;
            for (const cv::Point2f& p : corners)
                points.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y));
            median_px = 0.0;
            const bool true_ones = found && !truth.empty() && are_right(points, truth, median_px);
            print(set, name, finder.name, found, true_ones, median_px, start, "");
        }
    }

  private:
    void print(const std::string& set,
               const std::string& image,
               const char* finder,
               bool found,
               bool right,
               double median_px,
               std::chrono::steady_clock::time_point begin,
               const std::string& problem) {
        const std::chrono::duration<double, std::milli> ms =
            std::chrono::steady_clock::now() - begin;
        out_.print("{},{},\"{}\",{},{},{:.4f},{:.2f},\"{}\"\n",
                   set,
                   image,
                   finder,
                   found ? 1 : 0,
                   right ? 1 : 0,
                   median_px,
                   ms.count(),
                   problem);
    }

    fmt::ostream out_;
    std::vector<Finder> finders_;
};

struct Lens {
    calibration::testing::WideProfile profile;
    double fov_deg;
};

void rendered(std::uint64_t first_seed, std::uint64_t seeds, Table& table) {
    using calibration::testing::WideProfile;
    const Board board{.columns = 9, .rows = 6, .spacing_m = 0.025};
    for (const Lens& lens : {Lens{WideProfile::rational, 100.0},
                             Lens{WideProfile::rational, 120.0},
                             Lens{WideProfile::equidistant, 100.0},
                             Lens{WideProfile::stereographic, 120.0},
                             Lens{WideProfile::bought, 140.0},
                             Lens{WideProfile::equisolid, 160.0},
                             Lens{WideProfile::equidistant, 170.0}}) {
        const auto camera = calibration::testing::wide_camera(lens.profile, lens.fov_deg, kSize);
        const char* profile =
            calibration::testing::kWideProfileNames[static_cast<std::size_t>(lens.profile)];
        for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
            std::uint64_t look_number = 0;
            for (const auto& look : calibration::testing::kWideLooks) {
                const std::uint64_t own = mix_seed(mix_seed(seed, look_number++),
                                                   static_cast<std::uint64_t>(lens.fov_deg));
                Rng rng(own);
                const Pose T = calibration::testing::wide_pose(
                    board, camera, kMostTilt_deg, kLeastStep_px, rng, look.shown);
                const auto truth =
                    calibration::testing::true_corners(board, camera, T, kLeastStep_px);
                table.add(fmt::format("{:.0f} deg {}", lens.fov_deg, profile),
                          fmt::format("{} {}", look.name, seed),
                          board,
                          calibration::testing::wide_picture(board, camera, T, look, own),
                          truth.value_or(Corners{}));
            }
        }
    }
}

void images(const std::string& set, const std::string& folder, const Board& board, Table& table) {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const std::string extension = entry.path().extension().string();
        if (extension == ".png" || extension == ".jpg" || extension == ".pgm")
            paths.push_back(entry.path());
    }
    std::sort(paths.begin(), paths.end());
    for (const auto& path : paths) {
        const cv::Mat read = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
        if (read.empty()) continue;
        // A side-by-side image holds the pictures of both cameras.
        const int parts = read.cols > 2 * read.rows ? 2 : 1;
        const int width = read.cols / parts;
        for (int part = 0; part < parts; ++part) {
            GreyImage image(width, read.rows);
            for (int v = 0; v < read.rows; ++v) {
                const std::uint8_t* row = read.ptr(v) + part * width;
                std::copy(row, row + width, image.row(v));
            }
            table.add(set, fmt::format("{} {}", path.filename().string(), part), board, image, {});
        }
    }
}

}  // namespace
}  // namespace surefoot

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    using namespace surefoot;
    cv::setNumThreads(1);  // The surefoot program uses the same setting.
    const std::string how = argc > 2 ? argv[2] : "";
    const bool only_ours = argc > 3 && std::string(argv[argc - 1]) == "ours";
    if (how == "rendered" && argc >= 5) {
        Table table(argv[1], only_ours);
        rendered(std::strtoull(argv[3], nullptr, 10), std::strtoull(argv[4], nullptr, 10), table);
        return 0;
    }
    const auto board =
        how == "images" && argc >= 6 ? calibration::parse_board(argv[5]) : std::nullopt;
    if (board) {
        Table table(argv[1], only_ours);
        images(argv[3], argv[4], *board, table);
        return 0;
    }
    fmt::print(stderr,
               "usage: board_finders OUT.csv rendered FIRST_SEED SEEDS [ours]\n"
               "       board_finders OUT.csv images NAME FOLDER BOARD [ours]\n");
    return 2;
}
