// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/rectifier.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "surefoot/camera/rigs_testing.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::camera {
namespace {

/// Lens inverses are solved to 1e-12 rad; multiplied by f < 1000 px, plus some roundings.
constexpr double kExact_px = 1e-6;

Rectifier make(const StereoRig& rig) {
    auto made = Rectifier::make(rig);
    EXPECT_TRUE(made.ok());
    return std::move(made).value();
}

/// Image of the plane n . p = 1 (rig's raw left frame) with a smooth pattern, in one raw camera.
GreyImage render_plane(const Camera& camera, const Pose& T_left_camera, const Eigen::Vector3d& n) {
    GreyImage image(camera.width, camera.height, 0);
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            const auto ray = unproject(camera.model, Eigen::Vector2d(u, v));
            if (!ray) continue;
            const Eigen::Vector3d direction = T_left_camera.rotation * *ray;
            const double range_m = (1.0 - n.dot(T_left_camera.translation_m)) / n.dot(direction);
            if (!(range_m > 0.0)) continue;
            const Eigen::Vector3d p = T_left_camera.translation_m + range_m * direction;
            const double checker = std::sin(24.0 * p.x()) * std::sin(24.0 * p.y());
            image.at(u, v) = static_cast<std::uint8_t>(std::lround(128.0 + 100.0 * checker));
        }
    }
    return image;
}

double bilinear(const GreyImage& image, double u, int v) {
    const int u0 = static_cast<int>(u);
    const double s = u - u0;
    return (1.0 - s) * image.at(u0, v) + s * image.at(u0 + 1, v);
}

class EveryRig : public testing::TestWithParam<int> {
  protected:
    const StereoRig rig_ = GetParam() == 0   ? test::euroc_rig()
                           : GetParam() == 1 ? test::fisheye_rig()
                                             : test::zed_rig();
    const Rectifier rectifier_ = make(rig_);
};

std::string rig_name(const testing::TestParamInfo<int>& info) {
    constexpr const char* kNames[] = {"euroc", "fisheye", "zed"};
    return kNames[info.param];
}

INSTANTIATE_TEST_SUITE_P(Rigs, EveryRig, testing::Values(0, 1, 2), rig_name);

/// Maps points of the raw left frame to raw pixels with the lens models, then to rectified pixels.
TEST_P(EveryRig, PointsFallOnEqualRowsWithTheDisparityOfTheirDepth) {
    const RectifiedRig& ideal = rectifier_.rig();
    const Pose T_camera_left = ideal.T_body_camera.inverse() * rig_.body_from_left();
    Rng rng(3);
    int seen = 0;
    for (int n = 0; n < 2000; ++n) {
        const Eigen::Vector3d p_left(
            rng.uniform(-2, 2), rng.uniform(-1.5, 1.5), rng.uniform(0.3, 5.0));
        const auto raw_left = project(rig_.left.model, p_left);
        const auto raw_right = project(rig_.right->model, rig_.T_left_right.inverse() * p_left);
        if (!raw_left || !raw_right) continue;
        const auto left = rectifier_.rectified_from_raw(Side::left, *raw_left);
        const auto right = rectifier_.rectified_from_raw(Side::right, *raw_right);
        const Eigen::Vector3d p_camera = T_camera_left * p_left;
        if (!left || !right || p_camera.z() < 0.1) continue;
        ++seen;
        const double scale = std::max(1.0, left->norm() / 1000.0);  // far outside the image
        EXPECT_NEAR(left->y(), right->y(), kExact_px * scale) << p_left.transpose();
        EXPECT_NEAR(left->x() - right->x(),
                    ideal.fx_px * ideal.baseline_m / p_camera.z(),
                    kExact_px * scale)
            << p_left.transpose();
        const double disparity_px = left->x() - right->x();
        EXPECT_LT((ideal.point(left->x(), left->y(), disparity_px) - p_camera).norm(),
                  1e-6 * scale);
        const auto raw_again = rectifier_.raw_from_point(Side::right, p_camera);
        ASSERT_TRUE(raw_again);
        EXPECT_LT((*raw_again - *raw_right).norm(), kExact_px);
    }
    EXPECT_GT(seen, 1000);
}

TEST_P(EveryRig, EveryRectifiedPixelHasASource) {
    StereoFrame frame;
    frame.left = GreyImage(rig_.left.width, rig_.left.height, 200);
    frame.right = frame.left;
    RectifiedPair pair;
    rectifier_.rectify(frame, pair);
    EXPECT_EQ(std::count(pair.left.data(), pair.left.data() + pair.left.size(), 200),
              static_cast<std::ptrdiff_t>(pair.left.size()));
    EXPECT_EQ(std::count(pair.right.data(), pair.right.data() + pair.right.size(), 200),
              static_cast<std::ptrdiff_t>(pair.right.size()));
}

TEST_P(EveryRig, AWarpedPlaneMatchesItselfAtItsDisparity) {
    // Tilted 20 deg about x: depth changes along the rows of the image.
    const Eigen::Vector3d n = Eigen::Vector3d(0.05, -0.34, 0.94) / 1.1;
    StereoFrame frame;
    frame.left = render_plane(rig_.left, Pose{}, n);
    frame.right = render_plane(*rig_.right, rig_.T_left_right, n);
    RectifiedPair pair;
    rectifier_.rectify(frame, pair);
    const RectifiedRig& ideal = rectifier_.rig();
    const Eigen::Vector3d n_camera =
        ideal.T_body_camera.inverse().rotation * (rig_.body_from_left().rotation * n);
    double sum_right = 0.0;
    double sum_wrong_row = 0.0;
    int count = 0;
    for (int v = 20; v < ideal.height - 20; v += 3) {
        for (int u = 20; u < ideal.width - 20; u += 3) {
            const Eigen::Vector3d ray(
                (u - ideal.cx_px) / ideal.fx_px, (v - ideal.cy_px) / ideal.fy_px, 1.0);
            const double z_m = 1.0 / n_camera.dot(ray);
            const double u_right = u - ideal.depth_to_disparity_px_m() / z_m;
            // The finest waves of the far floor are smaller than a raw pixel.
            if (!(z_m > 0.0) || z_m > 2.0 || u_right < 1 || u_right > ideal.width - 3) continue;
            const double left = pair.left.at(u, v);
            sum_right += std::abs(left - bilinear(pair.right, u_right, v));
            sum_wrong_row += std::abs(left - bilinear(pair.right, u_right, v + 3));
            ++count;
        }
    }
    ASSERT_GT(count, 3000);
    const double error_grey = sum_right / count;
    std::printf("mean grey error %.2f (%.2f three rows off)\n", error_grey, sum_wrong_row / count);
    // Error of two bilinear interpolations of a wave of 100 grey levels and about 40 px: (2
    // pi/40)^2/8 * 100.
    EXPECT_LT(error_grey, 2.0);
    EXPECT_GT(sum_wrong_row / count, 4.0 * error_grey);
}

TEST_P(EveryRig, APartHasTheBytesOfTheWhole) {
    StereoRig rectified = test::ideal_rig(64, 48, 50.0);
    rectified.rectified = true;
    for (const StereoRig& rig : {rig_, rectified}) {
        const Rectifier rectifier = make(rig);
        StereoFrame frame;
        frame.left = GreyImage(rig.left.width, rig.left.height);
        for (std::size_t i = 0; i < frame.left.size(); ++i)
            frame.left.data()[i] = static_cast<std::uint8_t>(i * 31 % 251);
        frame.right = frame.left;
        std::reverse(frame.right.data(), frame.right.data() + frame.right.size());
        RectifiedPair whole;
        rectifier.rectify(frame, whole);
        const int width = rectifier.rig().width;
        const int height = rectifier.rig().height;
        for (const PixelBox& box : {PixelBox{0, 0, width, height},
                                    PixelBox{7, 11, 33, 29},
                                    PixelBox{width - 5, height - 1, 5, 1},
                                    PixelBox{3, 3, 0, 0}}) {
            RectifiedPair part;
            rectifier.rectify_part(frame, box, part);
            ASSERT_EQ(part.left.width(), box.width);
            ASSERT_EQ(part.right.height(), box.height);
            for (int v = 0; v < box.height; ++v) {
                for (int u = 0; u < box.width; ++u) {
                    ASSERT_EQ(part.left.at(u, v), whole.left.at(box.u + u, box.v + v));
                    ASSERT_EQ(part.right.at(u, v), whole.right.at(box.u + u, box.v + v));
                }
            }
            const RectifiedRig of_part = part_of(rectifier.rig(), box);
            EXPECT_LT((of_part.point(1.0, 2.0, 3.0) -
                       rectifier.rig().point(box.u + 1.0, box.v + 2.0, 3.0))
                          .norm(),
                      1e-12);
        }
    }
}

TEST(Rectifier, RectifiedRigsPassThrough) {
    const StereoRig rig = test::zed_rig();
    const Rectifier rectifier = make(rig);
    EXPECT_TRUE(rectifier.is_identity());
    EXPECT_EQ(rectifier.rig().fx_px, 342.0);
    EXPECT_EQ(rectifier.rig().cx_px, 336.0);
    EXPECT_EQ(rectifier.rig().baseline_m, 0.12);
    Rng rng(1);
    StereoFrame frame;
    frame.left = GreyImage(672, 376);
    frame.right = GreyImage(672, 376);
    for (std::size_t i = 0; i < frame.left.size(); ++i) {
        frame.left.data()[i] = static_cast<std::uint8_t>(rng.below(256));
        frame.right.data()[i] = static_cast<std::uint8_t>(rng.below(256));
    }
    RectifiedPair pair;
    rectifier.rectify(frame, pair);
    EXPECT_EQ(pair.left, frame.left);
    EXPECT_EQ(pair.right, frame.right);
    const Eigen::Vector2d pixel(12.25, 300.5);
    EXPECT_EQ(rectifier.rectified_from_raw(Side::right, pixel), pixel);
}

TEST(Rectifier, EurocKeepsItsFieldOfView) {
    const RectifiedRig ideal = make(test::euroc_rig()).rig();
    // Visual-odometry packages publish rectified focal lengths of 430-440 px for this rig.
    EXPECT_GT(ideal.fx_px, 410.0);
    EXPECT_LT(ideal.fx_px, 480.0);
    EXPECT_EQ(ideal.fx_px, ideal.fy_px);
    EXPECT_NEAR(ideal.baseline_m, 0.1101, 1e-4);
    EXPECT_NEAR(ideal.cx_px, 376.0, 40.0);
    EXPECT_NEAR(ideal.cy_px, 240.0, 40.0);
}

/// View angle between the middles of the left and right border.
double view_deg(const RectifiedRig& rig) {
    return (std::atan(rig.cx_px / rig.fx_px) + std::atan((rig.width - 1 - rig.cx_px) / rig.fx_px)) *
           180.0 / std::numbers::pi;
}

TEST(Rectifier, FisheyeBecomesAPinholeOfLimitedView) {
    const RectifiedRig ideal = make(test::fisheye_rig()).rig();
    EXPECT_NEAR(view_deg(ideal), RectificationConfig{}.max_view_deg, 0.5);
}

/// For such lenses cv::fisheye::stereoRectify returns a focal length of 0 or of thousands of px.
TEST(Rectifier, WideLensesGetASensibleFocalLength) {
    const StereoRig rig = test::fisheye_rig();
    const RectifiedRig ideal = make(rig).rig();
    // 960 px over 105 deg.
    EXPECT_GT(ideal.fx_px, 340.0);
    EXPECT_LT(ideal.fx_px, 400.0);
    EXPECT_NEAR(ideal.cx_px, 0.5 * (ideal.width - 1), 0.1 * ideal.width);
    EXPECT_NEAR(ideal.cy_px, 0.5 * (ideal.height - 1), 0.1 * ideal.height);
}

TEST(Rectifier, TheUserChoosesFocalLengthAndSize) {
    const StereoRig rig = test::fisheye_rig();
    RectificationConfig config;
    config.rectified_focal_px = 260.0;
    config.rectified_width_px = 800;
    config.rectified_height_px = 450;
    const auto rectifier = Rectifier::make(rig, config);
    ASSERT_TRUE(rectifier.ok());
    const RectifiedRig& ideal = rectifier->rig();
    EXPECT_EQ(ideal.fx_px, 260.0);
    EXPECT_EQ(ideal.fy_px, 260.0);
    EXPECT_EQ(ideal.width, 800);
    EXPECT_EQ(ideal.height, 450);
    EXPECT_NEAR(view_deg(ideal), 2.0 * std::atan(400.0 / 260.0) * 180.0 / std::numbers::pi, 1.0);
    StereoFrame frame;
    frame.left = GreyImage(rig.left.width, rig.left.height, 90);
    frame.right = frame.left;
    RectifiedPair pair;
    rectifier->rectify(frame, pair);
    ASSERT_EQ(pair.left.width(), 800);
    ASSERT_EQ(pair.right.height(), 450);
    EXPECT_EQ(pair.left.at(400, 225), 90);
    // Pixels and points still agree.
    const Eigen::Vector3d p_camera(0.3, -0.1, 0.9);
    const auto raw = rectifier->raw_from_point(Side::right, p_camera);
    ASSERT_TRUE(raw);
    const auto pixel = rectifier->rectified_from_raw(Side::right, *raw);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(
        pixel->x(), ideal.cx_px + 260.0 * (p_camera.x() - ideal.baseline_m) / p_camera.z(), 1e-6);
    EXPECT_NEAR(pixel->y(), ideal.cy_px + 260.0 * p_camera.y() / p_camera.z(), 1e-6);
}

TEST(Rectifier, RectifiedImagesCanBeMadeSmaller) {
    RectificationConfig config;
    config.rectified_width_px = 336;
    config.rectified_height_px = 188;
    const auto rectifier = Rectifier::make(test::zed_rig(), config);
    ASSERT_TRUE(rectifier.ok());
    EXPECT_FALSE(rectifier->is_identity());
    // Half the pixels over the same view: the border pixels keep their directions.
    EXPECT_NEAR(rectifier->rig().fx_px, 342.0 * 335.0 / 671.0, 0.5);
    EXPECT_NEAR(view_deg(rectifier->rig()), view_deg(make(test::zed_rig()).rig()), 0.3);
}

TEST(Rectifier, SaysWhichViewCannotBeShown) {
    RectificationConfig config;
    config.rectified_focal_px = 20.0;
    const auto made = Rectifier::make(test::fisheye_rig(), config);
    ASSERT_FALSE(made.ok());
    EXPECT_EQ(made.error().message,
              "camera.rectified_focal_px = 20 must be at least 129 for a 960x600 image: a plane "
              "image shows at most 150 deg");
    config.rectified_focal_px = 0.0;
    config.rectified_height_px = 1;
    EXPECT_FALSE(Rectifier::make(test::fisheye_rig(), config).ok());
}

TEST(Rectifier, MixedLensesShareOneView) {
    StereoRig rig = test::fisheye_rig();
    rig.right->model = PinholeRadTan{.fx_px = 500, .fy_px = 500, .cx_px = 480, .cy_px = 300};
    const Rectifier rectifier = make(rig);
    // The narrower pinhole camera decides: 960 px at f = 500 px.
    EXPECT_GT(rectifier.rig().fx_px, 495.0);
    EXPECT_LT(rectifier.rig().fx_px, 560.0);
}

TEST(Rectifier, RgbdLosesItsDistortionAndKeepsItsDepth) {
    StereoRig rig = test::euroc_rig();
    rig.right.reset();
    const Rectifier rectifier = make(rig);
    const RectifiedRig& ideal = rectifier.rig();
    EXPECT_FALSE(rectifier.is_identity());
    EXPECT_EQ(ideal.baseline_m, Rectifier::kVirtualBaseline_m);
    EXPECT_LT(difference(ideal.T_body_camera, *rig.T_body_left).norm(), 1e-12);
    // A depth ramp that depends only on the raw column, unknown in one corner.
    Image<float> raw_m(rig.left.width, rig.left.height);
    for (int v = 0; v < raw_m.height(); ++v) {
        for (int u = 0; u < raw_m.width(); ++u)
            raw_m.at(u, v) = 1.0F + 0.001F * static_cast<float>(u);
    }
    for (int v = 200; v < 260; ++v) raw_m.at(300, v) = std::numeric_limits<float>::quiet_NaN();
    Image<float> depth_m;
    rectifier.rectify_depth(raw_m, depth_m);
    int unknown = 0;
    for (int v = 0; v < depth_m.height(); ++v) {
        for (int u = 0; u < depth_m.width(); ++u) {
            const auto raw = rectifier.raw_from_point(Side::left, ideal.point(u, v, 10.0));
            ASSERT_TRUE(raw);
            if (std::isnan(depth_m.at(u, v))) {
                EXPECT_LT(std::abs(raw->x() - 300.0), 1.0);
                ++unknown;
            } else {
                ASSERT_NEAR(depth_m.at(u, v), 1.0 + 0.001 * raw->x(), 0.0006) << u << " " << v;
            }
        }
    }
    EXPECT_GT(unknown, 40);
    StereoFrame frame;
    frame.left = GreyImage(rig.left.width, rig.left.height, 7);
    RectifiedPair pair;
    rectifier.rectify(frame, pair);
    EXPECT_EQ(pair.left.at(0, 0), 7);
    EXPECT_TRUE(pair.right.empty());
}

TEST(Rectifier, TheStampIsThatOfTheMiddleRow) {
    StereoRig rig = test::euroc_rig();
    EXPECT_EQ(Rectifier::make(rig)->row_offset_s(0.0), 0.0);  // global shutter
    rig.readout_s = 0.02;
    const auto rectifier = Rectifier::make(rig);
    const double last = rig.left.height - 1.0;
    EXPECT_DOUBLE_EQ(rectifier->row_offset_s(0.5 * last), 0.0);
    EXPECT_DOUBLE_EQ(rectifier->row_offset_s(last), 0.01 * last / rig.left.height);
    EXPECT_DOUBLE_EQ(rectifier->row_offset_s(0.0), -rectifier->row_offset_s(last));
}

TEST(Rectifier, SaysWhyARigCannotBeRectified) {
    StereoRig rig = test::euroc_rig();
    std::get<PinholeRadTan>(rig.left.model).fx_px = std::numeric_limits<double>::quiet_NaN();
    const auto made = Rectifier::make(rig);
    ASSERT_FALSE(made.ok());
    EXPECT_EQ(made.error().message,
              "rig 'euroc': left camera: pinhole fx_px = nan is not a finite number");
}

// ---- real images --------------------------------------------------------------------------------

std::string data_folder() {
    const char* folder = std::getenv("SUREFOOT_DATA_DIR");
    return folder != nullptr ? folder : SUREFOOT_DEFAULT_DATA_DIR;
}

GreyImage grey_image(const cv::Mat& m) {
    GreyImage image(m.cols, m.rows);
    m.copyTo(cv::Mat(m.rows, m.cols, CV_8UC1, image.data()));
    return image;
}

/// Vertical offset between the cameras at a corner: normalised correlation of 15x15 windows over
/// `kDisparities` columns and +-2 rows, with a parabola across the rows; nullopt for weak matches.
std::optional<double> row_offset_px(const cv::Mat& left, const cv::Mat& right, cv::Point2f corner) {
    constexpr int kHalf = 7;
    constexpr int kRows = 2;
    constexpr int kDisparities = 100;
    const int u = cvRound(corner.x);
    const int v = cvRound(corner.y);
    if (u < kHalf + kDisparities || v < kHalf + kRows || u + kHalf >= left.cols ||
        v + kHalf + kRows >= left.rows) {
        return std::nullopt;
    }
    const cv::Mat window = left(cv::Rect(u - kHalf, v - kHalf, 2 * kHalf + 1, 2 * kHalf + 1));
    const cv::Mat strip = right(cv::Rect(u - kHalf - kDisparities,
                                         v - kHalf - kRows,
                                         kDisparities + 2 * kHalf + 1,
                                         2 * kHalf + 1 + 2 * kRows));
    cv::Mat score;
    cv::matchTemplate(strip, window, score, cv::TM_CCOEFF_NORMED);
    double best = 0.0;
    cv::Point where;
    cv::minMaxLoc(score, nullptr, &best, nullptr, &where);
    if (best < 0.9 || where.y == 0 || where.y == 2 * kRows) return std::nullopt;
    const double above = score.at<float>(where.y - 1, where.x);
    const double below = score.at<float>(where.y + 1, where.x);
    return where.y - kRows + 0.5 * (above - below) / (above + below - 2.0 * best);
}

TEST(Rectifier, RealEurocCornersLieOnEqualRows) {
    const std::string base = data_folder() + "/sequences/euroc_still/mav0/";
    const cv::Mat raw_left =
        cv::imread(base + "cam0/data/1403715273262142976.png", cv::IMREAD_GRAYSCALE);
    const cv::Mat raw_right =
        cv::imread(base + "cam1/data/1403715273262142976.png", cv::IMREAD_GRAYSCALE);
    if (raw_left.empty() || raw_right.empty()) {
        std::printf("skipped 1 check: no images in %s\n", base.c_str());
        return;
    }
    const Rectifier rectifier = make(test::euroc_rig());
    StereoFrame frame;
    frame.left = grey_image(raw_left);
    frame.right = grey_image(raw_right);
    RectifiedPair pair;
    rectifier.rectify(frame, pair);
    const cv::Mat left(480, 752, CV_8UC1, pair.left.data());
    const cv::Mat right(480, 752, CV_8UC1, pair.right.data());
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(left, corners, 400, 0.01, 8.0);
    std::vector<double> offsets_px;
    for (const cv::Point2f& corner : corners) {
        if (const auto offset = row_offset_px(left, right, corner)) offsets_px.push_back(*offset);
    }
    ASSERT_GT(offsets_px.size(), 80U);
    std::vector<double> absolute_px;
    for (const double offset : offsets_px) absolute_px.push_back(std::abs(offset));
    std::sort(absolute_px.begin(), absolute_px.end());
    std::sort(offsets_px.begin(), offsets_px.end());
    const double median_px = absolute_px[absolute_px.size() / 2];
    const double p90_px = absolute_px[absolute_px.size() * 9 / 10];
    std::printf(
        "EuRoC row error over %zu corners: median %.3f px, 90 %% %.3f px, signed median %+.3f px\n",
        offsets_px.size(),
        median_px,
        p90_px,
        offsets_px[offsets_px.size() / 2]);
    // The published calibration has an epipolar error of about 0.2 px; corners add about 0.1 px.
    EXPECT_LT(median_px, 0.3);
    EXPECT_LT(p90_px, 0.8);
}

}  // namespace
}  // namespace surefoot::camera
