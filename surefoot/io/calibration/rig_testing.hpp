// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/io_testing.hpp"

/// Shared by the tests of calibration files: the values that were read, and the messages.
namespace surefoot::io::testing {

inline constexpr double kExact = 1e-12;
/// Files print rotations with seven digits and baselines with micrometres.
inline constexpr double kPrinted_m = 1e-6;

inline std::string message(const Result<RigFile>& file) {
    return file.ok() ? "accepted" : file.error().message;
}

inline bool has_note(const Result<RigFile>& file, const std::string& part) {
    if (!file.ok()) return false;
    for (const std::string& note : file->notes) {
        if (contains(note, part)) return true;
    }
    return false;
}

inline double baseline_m(const Result<RigFile>& file) {
    return file.ok() ? file->rig.T_left_right.translation_m.norm() : -1.0;
}

inline const camera::PinholeRadTan& pinhole(const camera::Camera& camera) {
    return std::get<camera::PinholeRadTan>(camera.model);
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    std::size_t at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    for (; at != text.npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
    return text;
}

}  // namespace surefoot::io::testing
