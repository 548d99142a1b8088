// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/images/image_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "surefoot/io/file.hpp"
#include "surefoot/io/images/pfm.hpp"
#include "surefoot/io/io_testing.hpp"
#include "surefoot/io/maps/dem_file.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::data_path;

template <typename T>
std::string message(const Result<T>& result) {
    return result.ok() ? "accepted" : result.error().message;
}

template <typename Pixel>
Image<Pixel> random_image(int width, int height, std::uint64_t seed) {
    Rng rng(seed);
    Image<Pixel> image(width, height);
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) image.at(u, v) = static_cast<Pixel>(rng.next_u64());
    }
    return image;
}

RgbImage random_rgb(int width, int height, std::uint64_t seed) {
    Rng rng(seed);
    RgbImage image(width, height);
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
            const std::uint64_t bits = rng.next_u64();
            image.at(u, v) = {static_cast<std::uint8_t>(bits),
                              static_cast<std::uint8_t>(bits >> 8),
                              static_cast<std::uint8_t>(bits >> 16)};
        }
    }
    return image;
}

std::string jpeg_of(const GreyImage& image) {
    GreyImage copy = image;
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", cv::Mat(copy.height(), copy.width(), CV_8UC1, copy.data()), bytes);
    return {bytes.begin(), bytes.end()};
}

TEST(ImageFile, PngRoundTripsBitExactly) {
    const testing::TemporaryFolder folder;
    const auto grey = random_image<std::uint8_t>(31, 17, 1);
    const auto codes = random_image<std::uint16_t>(16, 9, 2);
    const RgbImage rgb = random_rgb(8, 5, 3);
    ASSERT_TRUE(write_png(folder / "grey.png", grey).ok());
    ASSERT_TRUE(write_png(folder / "codes.png", codes).ok());
    ASSERT_TRUE(write_png(folder / "rgb.png", rgb).ok());
    EXPECT_EQ(*read_grey_image(folder / "grey.png"), grey);
    EXPECT_EQ(*read_depth_codes(folder / "codes.png"), codes);
    EXPECT_EQ(*read_rgb_image(folder / "rgb.png"), rgb);
}

TEST(ImageFile, ColourBecomesGreyByBt601) {
    const RgbImage rgb = random_rgb(64, 64, 4);
    const auto grey = parse_grey_image(*format_png(rgb), "rgb.png");
    ASSERT_TRUE(grey.ok());
    for (int v = 0; v < 64; ++v) {
        for (int u = 0; u < 64; ++u) {
            const Rgb& p = rgb.at(u, v);
            const double exact = 0.299 * p.r + 0.587 * p.g + 0.114 * p.b;
            // Half a level of rounding, and weights to 15 bits: 255 * 3 * 2^-16 = 0.012.
            ASSERT_NEAR(grey->at(u, v), exact, 0.5 + 0.012) << u << " " << v;
        }
    }
}

TEST(ImageFile, EveryTruncationAndBitErrorOfAPngIsFound) {
    const std::string png = *format_png(random_image<std::uint8_t>(9, 7, 5));
    for (std::size_t size = 0; size < png.size(); ++size) {
        ASSERT_FALSE(parse_grey_image(std::string_view(png).substr(0, size), "cut.png").ok())
            << size;
    }
    for (std::size_t bit = 0; bit < 8 * png.size(); ++bit) {
        std::string damaged = png;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
        ASSERT_FALSE(parse_grey_image(damaged, "flipped.png").ok()) << bit;
    }
    EXPECT_TRUE(contains(
        message(parse_grey_image(std::string_view(png).substr(0, png.size() - 4), "a.png")),
        "a.png: truncated PNG"));
    EXPECT_EQ(message(parse_grey_image("", "a.png")),
              "a.png: empty file where an image is expected; copy or record this image again");
    // The decoder would notice this one too, but it would not say where.
    std::string damaged = png;
    damaged[png.find("IDAT") + 10] ^= 1;
    EXPECT_TRUE(contains(message(parse_grey_image(damaged, "a.png")),
                         "a.png: damaged PNG: wrong checksum of the part 'IDAT' at byte 33"));
}

TEST(ImageFile, TruncatedJpegIsFoundWhereverItEnds) {
    const GreyImage image = random_image<std::uint8_t>(40, 30, 6);
    const std::string jpeg = jpeg_of(image);
    ASSERT_TRUE(parse_grey_image(jpeg, "a.jpg").ok());
    ASSERT_TRUE(parse_grey_image(jpeg + std::string(100, '\0'), "padded.jpg").ok());
    for (std::size_t size = 0; size < jpeg.size(); ++size) {
        ASSERT_FALSE(check_image(std::string_view(jpeg).substr(0, size), "cut.jpg").ok()) << size;
    }
    EXPECT_TRUE(contains(message(parse_grey_image(jpeg.substr(0, jpeg.size() / 2), "a.jpg")),
                         "a.jpg: truncated JPEG"));
}

TEST(ImageFile, WrongDepthAndFormatAreRefusedInWords) {
    const std::string deep = *format_png(random_image<std::uint16_t>(4, 4, 7));
    const std::string flat = *format_png(random_image<std::uint8_t>(4, 4, 8));
    EXPECT_TRUE(contains(message(parse_grey_image(deep, "a.png")), "a.png: 16 bits per channel"));
    EXPECT_TRUE(contains(message(parse_depth_codes(flat, "d.png")), "must be 16-bit grey"));
    EXPECT_TRUE(contains(message(parse_grey_image("GIF89a", "a.gif")), "not a PNG, JPEG"));
    EXPECT_TRUE(
        contains(message(parse_grey_image("P5 99999 99999 255\n", "a.pgm")), "is not allowed"));
    EXPECT_TRUE(contains(message(parse_grey_image("P5 9 9 255\nabc", "a.pgm")), "3 of 81 bytes"));
    const auto pgm = parse_grey_image("P5\n# made by hand\n2 1\n255\nab", "a.pgm");
    ASSERT_TRUE(pgm.ok()) << message(pgm);
    EXPECT_EQ(pgm->at(1, 0), 'b');
    EXPECT_TRUE(contains(write_png("/dev/full", GreyImage(3, 3)).error().message,
                         "/dev/full: cannot write: No space left on device"));
    EXPECT_FALSE(write_png("/tmp/never.png", GreyImage()).ok());
}

TEST(ImageFile, SurvivesDamagedFiles) {
    const std::string jpeg = jpeg_of(random_image<std::uint8_t>(16, 16, 9));
    const std::string png = *format_png(random_rgb(9, 7, 10));
    const std::string pgm = "P5 4 4 255\n0123456789abcdef";
    for (const std::string& valid : {jpeg, png, pgm}) {
        testing::for_each_mutation(valid, 1500, 11, [](const std::string& bytes) {
            const auto image = parse_grey_image(bytes, "damaged");
            if (image.ok()) {
                EXPECT_GT(image->size(), 0U);
            }
        });
    }
}

TEST(ImageFile, ReadsRealImages) {
    const struct {
        const char* name;
        int width, height;
    } files[] = {{"sequences/kitti_city/image_0/000000.png", 1226, 370},
                 {"calibration/chess_pinhole/left01.jpg", 640, 480},
                 {"calibration/circles_symmetric/grid36-01.pgm", 0, 0},
                 {"stereo/cones/occ_mask_left.png", 450, 375},
                 {"stereo/cones/left.png", 450, 375}};
    for (const auto& file : files) {
        const std::string path = data_path(file.name);
        if (path.empty()) continue;
        const auto image = read_grey_image(path);
        ASSERT_TRUE(image.ok()) << message(image);
        if (file.width > 0) {
            EXPECT_EQ(image->width(), file.width) << path;
            EXPECT_EQ(image->height(), file.height) << path;
        }
    }
}

TEST(Pfm, RoundTripsAndKeepsUnknownUnknown) {
    Image<float> image(5, 4, 1.5F);
    image.at(0, 0) = std::numeric_limits<float>::quiet_NaN();
    image.at(4, 3) = -2.25F;
    const std::string bytes = format_pfm(image);
    // First pixel of the file is the lower left one; the upper left one begins the last row.
    EXPECT_EQ(bytes.substr(bytes.size() - 20, 4), std::string("\0\0\x80\x7f", 4)) << "+inf";
    const auto copy = parse_pfm(bytes, "a.pfm");
    ASSERT_TRUE(copy.ok()) << message(copy);
    EXPECT_TRUE(std::isnan(copy->at(0, 0)));
    EXPECT_EQ(copy->at(4, 3), -2.25F);
    EXPECT_EQ(copy->at(2, 2), 1.5F);
    const auto big = parse_pfm(std::string("Pf 1 1 1.0\n\x3f\x80\0\0", 15), "big.pfm");
    ASSERT_TRUE(big.ok());
    EXPECT_EQ(big->at(0, 0), 1.0F);
}

TEST(Pfm, RefusesDamageAndSurvivesIt) {
    EXPECT_TRUE(contains(message(parse_pfm("PF 1 1 -1\n", "a.pfm")), "colour PFM"));
    EXPECT_TRUE(contains(message(parse_pfm("Pf 100000 100000 -1\n", "a.pfm")), "a.pfm: PFM size"));
    EXPECT_TRUE(contains(message(parse_pfm("Pf 2 2 -1\nabc", "a.pfm")), "3 of 16 bytes"));
    EXPECT_TRUE(contains(message(parse_pfm("Pf 2 2 0\n", "a.pfm")), "scale '0'"));
    EXPECT_TRUE(
        contains(write_pfm("/dev/full", Image<float>(2, 2)).error().message, "No space left"));
    testing::for_each_mutation(
        format_pfm(Image<float>(6, 5, 2.0F)), 3000, 12, [](const std::string& bytes) {
            (void)parse_pfm(bytes, "damaged").ok();
        });
}

TEST(DemFile, EsriGridRoundTripsEveryBit) {
    Rng rng(13);
    grid::GridGeometry geometry{0.1, 7, 5, {-0.3, 1e6 + 1.0 / 3.0}};
    grid::Layer layer(7, 5);
    for (int i = 0; i < 35; ++i) {
        layer.data()[i] =
            i % 4 == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(rng.normal());
    }
    const auto copy = parse_esri_grid(format_esri_grid(geometry, layer), "a.asc");
    ASSERT_TRUE(copy.ok()) << message(copy);
    EXPECT_EQ(copy->geometry.origin_m, geometry.origin_m);
    EXPECT_EQ(copy->geometry.resolution_m, geometry.resolution_m);
    for (int i = 0; i < 35; ++i) {
        const float a = layer.data()[i];
        const float b = copy->values.data()[i];
        EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << i << ": " << a << " " << b;
    }
}

TEST(DemFile, FirstRowOfAnEsriGridIsTheLargestY) {
    const auto dem = parse_esri_grid(
        "NCOLS 2\nnrows 2\nxllcenter 10\nyllcorner 20\ncellsize 1\nNODATA_value -1\n1 2\n3 -1\n",
        "a.asc");
    ASSERT_TRUE(dem.ok()) << message(dem);
    EXPECT_EQ(dem->values.at(0, 1), 1.0F);
    EXPECT_EQ(dem->values.at(1, 1), 2.0F);
    EXPECT_EQ(dem->values.at(0, 0), 3.0F);
    EXPECT_TRUE(std::isnan(dem->values.at(1, 0)));
    EXPECT_EQ(dem->geometry.origin_m, Eigen::Vector2d(9.5, 20.0));
}

/// A map of 3 x 2 cells with this line of NODATA and these rows.
std::string grid_of(const std::string& no_data, const std::string& rows) {
    return "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 0.025\n" + no_data + rows;
}

TEST(DemFile, MarksForNoDataAreUnknownHoweverTheyAreSpelt) {
    const struct {
        const char* what;
        std::string text;
    } grids[] = {
        {"GDAL",
         grid_of("NODATA_value  -3.402823E+38\n",
                 "-3.4028234663852886E+38 0.5 0.5\n0.25 0.5 -3.4028230607371E+38\n")},
        {"the smallest float",
         grid_of("NODATA_value  -3.40282346638529e+38\n",
                 "-3.4028234663852886e+38 0.5 0.5\n0.25 0.5 -3.4028235e+38\n")},
        {"WindNinja",
         grid_of("NODATA_value  -3.39999999999999996e+38\n",
                 "-3.3999999521443642e+38 0.5 0.5\n0.25 0.5 -3.4e+38\n")},
        {"a float",
         grid_of("NODATA_value  -9999.9\n", "-9999.900390625 0.5 0.5\n0.25 0.5 -9999.9\n")},
        {"null", grid_of("NODATA_value null\n", "null 0.5 0.5\n0.25 0.5 NULL\n")},
        {"nan", grid_of("NODATA_value -9999\n", "nan 0.5 0.5\n0.25 0.5 -nan\n")},
        {"begins with nan", grid_of("", "nan 0.5 0.5\n0.25 0.5 -9999\n")},
        {"a byte order mark", "\xef\xbb\xbf" + grid_of("", "-9999 0.5 0.5\n0.25 0.5 -9999.0\n")},
    };
    for (const auto& grid : grids) {
        const auto dem = parse_esri_grid(grid.text, "a.asc");
        ASSERT_TRUE(dem.ok()) << grid.what << ": " << message(dem);
        EXPECT_TRUE(std::isnan(dem->values.at(0, 1)) && std::isnan(dem->values.at(2, 0)))
            << grid.what;
        EXPECT_EQ(dem->values.at(1, 1), 0.5F) << grid.what;
        EXPECT_EQ(dem->values.at(0, 0), 0.25F) << grid.what;
    }
    // Values that are not marks stay: a layer may hold anything.
    EXPECT_EQ(parse_esri_grid(grid_of("", "-32768 1 1\n1 1 1\n"), "a.asc")->values.at(0, 1),
              -32768.0F);
}

TEST(DemFile, HeightsThatNobodyMeasuredAreUnknownAndSaid) {
    for (const char* mark :
         {"-32768", "-999", "-99999", "9999", "1e6", "-1e12", "3e38", "-100", "200001"}) {
        const auto heights = parse_height_grid(
            grid_of("", std::string(mark) + " 0.5 0.5\n0.25 0.5 " + mark + "\n"), "a.asc");
        ASSERT_TRUE(heights.ok()) << mark;
        EXPECT_TRUE(std::isnan(heights->values.at(0, 1)) && std::isnan(heights->values.at(2, 0)))
            << mark;
        EXPECT_EQ(heights->values.at(0, 0), 0.25F) << mark;
        ASSERT_LE(heights->notes.size(), 1U) << mark;
        if (std::string(mark) != "3e38") {
            ASSERT_EQ(heights->notes.size(), 1U) << mark;
            EXPECT_TRUE(contains(heights->notes[0], "2 cells ")) << heights->notes[0];
        }
    }
    // Ground: mountains in metres, a pit, a hall's ceiling, level ground at any height.
    for (const char* rows : {"2400 2900 1800\n372 372 400\n",
                             "0 0 0\n-45 0 0\n",
                             "0 12 0\n0 0 0\n",
                             "-430 -430 -430\n-430 -430 -430\n",
                             "-999 -1003 -2500\n-5000 -999 -1200\n"}) {
        const auto heights = parse_height_grid(grid_of("", rows), "a.asc");
        ASSERT_TRUE(heights.ok()) << rows;
        EXPECT_TRUE(heights->notes.empty()) << rows << heights->notes.front();
    }
    EXPECT_TRUE(std::isnan(
        parse_height_grid(grid_of("", "-32768 -32768 -32768\n-32768 -32768 -32768\n"), "a.asc")
            ->values.at(0, 0)))
        << "a map of nothing but marks";
    // Two marks in one file.
    const auto two = parse_height_grid(grid_of("", "-32768 0.5 -99999\n0.5 0.25 0.5\n"), "a.asc");
    EXPECT_EQ(two->notes.size(), 2U);
}

TEST(DemFile, CellsOfEqualSidesAndDecimalCommasInWords) {
    const std::string head = "ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\n";
    EXPECT_EQ(parse_esri_grid(head + "dx 0.025\ndy 0.025\n1\n", "a.asc")->geometry.resolution_m,
              0.025);
    EXPECT_TRUE(contains(message(parse_esri_grid(head + "dx 0.025\ndy 0.05\n1\n", "a.asc")),
                         "must be square: dx 0.025 and dy 0.05"));
    EXPECT_TRUE(contains(message(parse_esri_grid(head + "cellsize ,250E-01\n1\n", "a.asc")),
                         "a.asc:5: ',250E-01' has a decimal comma"));
    EXPECT_TRUE(contains(message(parse_esri_grid(head + "cellsize 1\n,5\n", "a.asc")),
                         "a.asc:6: ',5' has a decimal comma"));
    EXPECT_TRUE(contains(message(parse_esri_grid(grid_of("", "1 2 3\n4 5,5 6\n"), "a.asc")),
                         "a.asc:7: cannot read value 2 of row 2"));
}

TEST(DemFile, AValueThatIsTheMarkComesBackBesideIt) {
    grid::Layer layer(2, 1);
    layer.data()[0] = -9999.0F;
    layer.data()[1] = 3e38F;  // no value of any layer
    const auto dem = parse_esri_grid(format_esri_grid({0.1, 2, 1, {0, 0}}, layer), "a.asc");
    ASSERT_TRUE(dem.ok());
    EXPECT_NEAR(static_cast<double>(dem->values.at(0, 0)), -9999.0, 0.003);
    EXPECT_TRUE(std::isnan(dem->values.at(1, 0)));
}

TEST(DemFile, RefusesDamageInWords) {
    const std::string head = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
    EXPECT_TRUE(
        contains(message(parse_esri_grid(head + "1 2 3    \n", "a.asc")), "value 2 of row 2"));
    EXPECT_TRUE(contains(message(parse_esri_grid(head + "1 2 3 x\n", "a.asc")), "cells): 'x'"));
    EXPECT_TRUE(
        contains(message(parse_esri_grid(head + "1 2 3 4 5\n", "a.asc")), "found '5' after"));
    EXPECT_TRUE(
        contains(message(parse_esri_grid("ncols 2\nnrow 2\n", "a.asc")), "a.asc:2: unknown key"));
    EXPECT_TRUE(contains(message(parse_esri_grid("ncols 2\n1 2\n", "a.asc")), "has no 'nrows'"));
    EXPECT_TRUE(contains(message(parse_esri_grid("ncols 1000000\nnrows 1000000\nxllcorner 0\n"
                                                 "yllcorner 0\ncellsize 1\n1\n",
                                                 "a.asc")),
                         "do not fit"));
    const grid::GridGeometry geometry{0.1, 2, 2, {0, 0}};
    EXPECT_TRUE(contains(write_esri_grid("/dev/full", geometry, grid::Layer(2, 2)).error().message,
                         "/dev/full: cannot write: No space left"));
    EXPECT_FALSE(write_esri_grid("/tmp/never.asc", geometry, grid::Layer(3, 2)).ok());
    testing::for_each_mutation(head + "1.5 2.5\n-9999 4\n", 4000, 14, [](const std::string& text) {
        const auto dem = parse_esri_grid(text, "damaged.asc");
        if (dem.ok()) {
            EXPECT_EQ(dem->values.width(), dem->geometry.nx);
        }
    });
}

TEST(DemFile, CellsSmallerOrLargerThanAnyMapAreRefused) {
    // Lengths in cells of 1e-12 m are no integers: `rate` crashed.
    for (const char* size : {"1e-12", "5e-324", "0.00009", "1001", "1e300", "-0.02", "nan"}) {
        const auto dem = parse_esri_grid(fmt::format("ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\n"
                                                     "cellsize {}\n0 1\n",
                                                     size),
                                         "cells.asc");
        EXPECT_TRUE(contains(message(dem), "cells.asc: cellsize")) << size << ": " << message(dem);
    }
    for (const char* corner : {"1e300", "-1e300", "1e10"}) {
        // The picture that `rate` draws broke an invariant.
        const auto dem = parse_esri_grid(fmt::format("ncols 2\nnrows 1\nxllcorner {}\nyllcorner 0\n"
                                                     "cellsize 0.1\n0 1\n",
                                                     corner),
                                         "corner.asc");
        EXPECT_TRUE(contains(message(dem), "corner.asc: xllcorner")) << message(dem);
    }
    for (const char* size : {"0.0001", "0.025", "1000"}) {
        const auto dem = parse_esri_grid(fmt::format("ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\n"
                                                     "cellsize {}\n0 1\n",
                                                     size),
                                         "cells.asc");
        EXPECT_TRUE(dem.ok()) << size << ": " << message(dem);
    }
}

TEST(DemFile, HeightImagesHaveTheirHeights) {
    const std::string path = data_path("terrain/straight_stairs_1m_1m_60cm.png");
    if (path.empty()) return;
    const auto dem = read_dem_image(path, 0.02, 0.6);
    ASSERT_TRUE(dem.ok()) << message(dem);
    EXPECT_EQ(dem->geometry.nx, 50);
    // Column 25 of the image: 0, then 0.6 m from row 11, 179/255 and 94/255 of it further down.
    const auto height_at_row = [&](int row) { return dem->values.at(25, 49 - row); };
    EXPECT_FLOAT_EQ(height_at_row(5), 0.0F);
    EXPECT_FLOAT_EQ(height_at_row(12), 0.6F);
    EXPECT_NEAR(height_at_row(20), 0.6 * 179 / 255, 1e-6);
    EXPECT_NEAR(height_at_row(30), 0.6 * 94 / 255, 1e-6);
    EXPECT_TRUE(contains(message(read_dem_image(path, 0.0, 1.0)), "a scale of 0.0001 to 1000 m"));
    EXPECT_FALSE(read_dem_image(path, 1e-12, 0.6).ok());
    EXPECT_TRUE(contains(message(read_dem_image(path, 0.02, 2e5)), "exceeds 100000 m"));
}

}  // namespace
}  // namespace surefoot::io
