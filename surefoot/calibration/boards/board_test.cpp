// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/board.hpp"

#include <gtest/gtest.h>

namespace surefoot::calibration {
namespace {

TEST(Board, IsReadFromItsText) {
    const auto chess = parse_board("chessboard:9x6:0.025");
    ASSERT_TRUE(chess);
    EXPECT_EQ(chess->columns, 9);
    EXPECT_EQ(chess->rows, 6);
    EXPECT_EQ(chess->spacing_m, 0.025);
    const auto charuco = parse_board("charuco:8x5:0.03:0.022:DICT_5X5_100");
    ASSERT_TRUE(charuco);
    EXPECT_EQ(charuco->kind, BoardKind::charuco);
    EXPECT_EQ(charuco->marker_m, 0.022);
    EXPECT_EQ(charuco->dictionary, "DICT_5X5_100");
    for (const char* text : {"",
                             "chess",
                             "chessboard:9x6",
                             "chessboard:9:0.02",
                             "chessboard:ax6:1",
                             "chessboard:9x6:0.02x",
                             "chessboard:9x6:0.02:1",
                             "charuco:8x5:0.03"}) {
        EXPECT_FALSE(parse_board(text)) << text;
    }
}

TEST(Board, SquaresAreOneMoreThanInnerCornersEachWay) {
    const auto charuco = parse_board("charuco:8x5squares:0.03:0.022");
    ASSERT_TRUE(charuco);
    EXPECT_EQ(charuco->columns, 7);
    EXPECT_EQ(charuco->rows, 4);
    EXPECT_EQ(size_in_words(*charuco), "8 x 5 squares = 7 x 4 inner corners");
    EXPECT_EQ(size_in_words(*parse_board("chessboard:9x6:0.025")),
              "10 x 7 squares = 9 x 6 inner corners");
    EXPECT_EQ(size_in_words(*parse_board("circles:6x5:0.02")), "6 x 5 circles");
    EXPECT_EQ(parse_board("chessboard:10x7squares:0.025")->points_m(),
              parse_board("chessboard:9x6:0.025")->points_m());
    for (const char* text : {"circles:8x5squares:0.03",
                             "charuco:0x5squares:0.03:0.02",
                             "charuco:-2147483648x5squares:0.03:0.02",
                             "charuco:squares:0.03:0.02",
                             "charuco:8x5square:0.03:0.02"}) {
        EXPECT_FALSE(parse_board(text)) << text;
    }
}

TEST(Board, SaysWhyItCannotBe) {
    EXPECT_FALSE(Board{}.problem());
    EXPECT_TRUE(parse_board("chessboard:2x6:0.02")->problem());
    EXPECT_TRUE(parse_board("circles:6x6:-1")->problem());
    EXPECT_TRUE(parse_board("charuco:8x5:0.03:0.03")->problem());
}

TEST(Board, PointsLieRowByRow) {
    const auto square = parse_board("circles:4x3:0.1")->points_m();
    ASSERT_EQ(square.size(), 12U);
    EXPECT_TRUE(square[5].isApprox(Eigen::Vector3d(0.1, 0.1, 0.0)));
    const auto staggered = parse_board("asymmetric_circles:4x11:0.04")->points_m();
    EXPECT_TRUE(staggered[4].isApprox(Eigen::Vector3d(0.02, 0.02, 0.0)));
    EXPECT_TRUE(staggered[8].isApprox(Eigen::Vector3d(0.0, 0.04, 0.0)));
}

}  // namespace
}  // namespace surefoot::calibration
