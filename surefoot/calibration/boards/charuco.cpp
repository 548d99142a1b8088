// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/charuco.hpp"

#include <fmt/format.h>

namespace surefoot::calibration {
namespace {

struct Named {
    const char* name;
    cv::aruco::PREDEFINED_DICTIONARY_NAME id;
};
constexpr Named kDictionaries[] = {
    {"DICT_4X4_50", cv::aruco::DICT_4X4_50},
    {"DICT_4X4_100", cv::aruco::DICT_4X4_100},
    {"DICT_4X4_250", cv::aruco::DICT_4X4_250},
    {"DICT_4X4_1000", cv::aruco::DICT_4X4_1000},
    {"DICT_5X5_50", cv::aruco::DICT_5X5_50},
    {"DICT_5X5_100", cv::aruco::DICT_5X5_100},
    {"DICT_5X5_250", cv::aruco::DICT_5X5_250},
    {"DICT_5X5_1000", cv::aruco::DICT_5X5_1000},
    {"DICT_6X6_50", cv::aruco::DICT_6X6_50},
    {"DICT_6X6_100", cv::aruco::DICT_6X6_100},
    {"DICT_6X6_250", cv::aruco::DICT_6X6_250},
    {"DICT_6X6_1000", cv::aruco::DICT_6X6_1000},
    {"DICT_7X7_50", cv::aruco::DICT_7X7_50},
    {"DICT_7X7_100", cv::aruco::DICT_7X7_100},
    {"DICT_7X7_250", cv::aruco::DICT_7X7_250},
    {"DICT_7X7_1000", cv::aruco::DICT_7X7_1000},
    {"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL},
    {"DICT_APRILTAG_16h5", cv::aruco::DICT_APRILTAG_16h5},
    {"DICT_APRILTAG_25h9", cv::aruco::DICT_APRILTAG_25h9},
    {"DICT_APRILTAG_36h10", cv::aruco::DICT_APRILTAG_36h10},
    {"DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11},
};

}  // namespace

Result<cv::Ptr<cv::aruco::Dictionary>> dictionary_of(const Board& board) {
    std::string known;
    for (const Named& named : kDictionaries) {
        known += fmt::format("{}{}", known.empty() ? "" : ", ", named.name);
        if (board.dictionary != named.name) continue;
        auto dictionary = cv::aruco::getPredefinedDictionary(named.id);
        const int needed = squares(board.columns) * squares(board.rows) / 2;
        if (dictionary->bytesList.rows < needed) {
            return usage_error(
                fmt::format("board: the dictionary {} has {} markers, but {} x {} squares need {}; "
                            "choose a larger dictionary",
                            named.name,
                            dictionary->bytesList.rows,
                            squares(board.columns),
                            squares(board.rows),
                            needed));
        }
        return dictionary;
    }
    return usage_error(fmt::format(
        "board: unknown dictionary '{}'; known dictionaries: {}", board.dictionary, known));
}

}  // namespace surefoot::calibration
