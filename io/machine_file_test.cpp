// SPDX-License-Identifier: Apache-2.0
#include "io/machine_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "io/file.hpp"
#include "io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;

std::string rex_text() {
    const auto text = read_file(SUREFOOT_SOURCE_DIR "/machines/rex.yaml");
    EXPECT_TRUE(text.ok());
    return text.ok() ? *text : std::string();
}

/// The REX file with one piece of text replaced; the piece must be there.
std::string rex_with(const std::string& from, const std::string& to) {
    std::string text = rex_text();
    const std::size_t at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    return at == text.npos ? text : text.replace(at, from.size(), to);
}

TEST(MachineFile, the_rex_is_read_completely) {
    const auto file = read_machine(SUREFOOT_SOURCE_DIR "/machines/rex.yaml");
    ASSERT_TRUE(file.ok()) << file.error().message;
    const Machine& m = file->machine;
    EXPECT_EQ(m.problem(), nullptr);
    EXPECT_EQ(file->name, "rex");
    EXPECT_EQ(m.sole_depth_tenth_mm, 9900);
    EXPECT_EQ(m.left_foot.center_y_tenth_mm, 1800);
    EXPECT_EQ(m.right_foot.center_y_tenth_mm, -1800);
    EXPECT_EQ(m.left_foot.length_tenth_mm, 3660);
    ASSERT_EQ(m.body.count, 6);
    EXPECT_EQ(m.body.parts[4].box.width_tenth_mm, 9400);
    EXPECT_EQ(m.body.parts[4].box.center_x_tenth_mm, -100);
    EXPECT_EQ(m.body.parts[5].high_tenth_mm, 20700);
    EXPECT_EQ(m.body.lower_edge_tenth_mm(), 1100);
    for (std::size_t code = 1; code < m.movements.size(); ++code) {
        EXPECT_TRUE(m.movements[code].configured) << code;
        EXPECT_EQ(m.movements[code].movement_class, MovementClass::walk) << code;
    }
    EXPECT_FALSE(m.movements[0].configured);
    EXPECT_TRUE(m.limits.step[0].enabled);
    EXPECT_FALSE(m.limits.step[1].enabled) << "stairs are off by default";
    EXPECT_EQ(m.limits.step[0].up_tenth_mm, 200);
    EXPECT_EQ(m.ankle_from_heel_tenth_mm, 1260);
    EXPECT_EQ(m.limits.tread_share_permille, 800);
    EXPECT_EQ(m.limits.tread_overhang_tenth_mm, 730);
    EXPECT_NEAR(m.limits.min_normal_z, std::cos(6.0 * std::numbers::pi / 180.0), 1e-15);
    EXPECT_EQ(m.limits.frame_age_ns, 200'000'000);
    EXPECT_EQ(m.limits.verdict_ttl_ns, 300'000'000);
    EXPECT_EQ(m.limits.drop_evidence, 128);
    EXPECT_EQ(file->joints.size(), 5U);
    EXPECT_EQ(file->speed_m_s, 1.0);
    EXPECT_EQ(file->turn_deg_s, 90.0);
    EXPECT_NE(file->hash, 0U);
}

TEST(MachineFile, movements_of_the_rex_are_the_ellipse_through_its_four_steps) {
    const auto file = read_machine(SUREFOOT_SOURCE_DIR "/machines/rex.yaml");
    ASSERT_TRUE(file.ok()) << file.error().message;
    constexpr double kRoundingTenthMm = 10.0;  // the file gives whole millimetres, halves of these
    for (int sector = 0; sector < 16; ++sector) {
        const double angle = sector * std::numbers::pi / 8.0;
        const double forward = std::cos(angle) * (std::cos(angle) > 0.0 ? 4000.0 : 2500.0);
        const double left = -1000.0 * std::sin(angle);
        const Movement& outer = file->machine.movements[static_cast<std::size_t>(9 + sector)];
        EXPECT_NEAR(outer.forward_tenth_mm, forward, kRoundingTenthMm) << 9 + sector;
        EXPECT_NEAR(outer.left_tenth_mm, left, kRoundingTenthMm) << 9 + sector;
        if (sector % 2 != 0) continue;
        const Movement& inner = file->machine.movements[static_cast<std::size_t>(1 + sector / 2)];
        EXPECT_NEAR(inner.forward_tenth_mm, forward / 2.0, kRoundingTenthMm) << 1 + sector / 2;
        EXPECT_NEAR(inner.left_tenth_mm, left / 2.0, kRoundingTenthMm) << 1 + sector / 2;
    }
    EXPECT_NEAR(file->machine.movements[25].sin_turn, std::sin(std::numbers::pi / 12.0), 1e-15);
    EXPECT_NEAR(file->machine.movements[26].sin_turn, -std::sin(std::numbers::pi / 12.0), 1e-15);
}

TEST(MachineFile, the_mount_looks_forward_and_32_deg_down) {
    const auto file = read_machine(SUREFOOT_SOURCE_DIR "/machines/rex.yaml");
    ASSERT_TRUE(file.ok()) << file.error().message;
    EXPECT_EQ(file->T_body_left.translation_m, Eigen::Vector3d(0.075, 0.25, 0.05));
    EXPECT_EQ(file->mount_pitch_deg, 32.0);
    const Eigen::Matrix3d R = file->T_body_left.R();
    const double down_rad = 32.0 * std::numbers::pi / 180.0;
    const Eigen::Vector3d view = R * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d right = R * Eigen::Vector3d::UnitX();
    EXPECT_NEAR(
        (view - Eigen::Vector3d(std::cos(down_rad), 0.0, -std::sin(down_rad))).norm(), 0.0, 1e-12);
    EXPECT_NEAR((right - Eigen::Vector3d(0.0, -1.0, 0.0)).norm(), 0.0, 1e-12);
}

TEST(MachineFile, every_mistake_is_named_with_file_line_and_key) {
    struct Case {
        const char* from;
        const char* to;
        const char* line;  ///< of rex.yaml, or empty
        const char* expected;
    };
    const Case cases[] = {
        {"sway_m: 0.02", "swaym: 0.02", "swaym", "unknown key 'body.swaym'"},
        {"tilt_deg: 6.0", "tilt_deg: 60", "tilt_deg", "limits.tilt_deg: 60 is outside 0 .. 11"},
        {"tilt_deg: 6.0", "tilt_deg: .nan", "tilt_deg", "is outside"},
        {"tilt_deg: 6.0", "tilt_deg: steep", "tilt_deg", "is not a number"},
        {"frame_age_ms: 200", "frame_age_ms: 0", "frame_age_ms", "outside 1 .. 1000"},
        {"verdict_ttl_ms: 300", "verdict_ttl_ms: 3.5", "verdict_ttl_ms", "not a whole number"},
        {"  drop_m: 0.05 ", "  # ", "", "limits.drop_m: this key is missing"},
        {"{code: 9, name: N", "{code: 8, name: N", "forward_m: 0.400", "code: 8 is there twice"},
        {"{code: 9, name: N", "{code: 27, name: N", "forward_m: 0.400", "27 is outside 1 .. 26"},
        {"{code: 9, name: N", "{code: 0, name: N", "forward_m: 0.400", "0 is outside 1 .. 26"},
        {"class: walk}", "class: run}", "class: run", "'run' is neither walk nor stair"},
        {"name: NNE,", "name: northeast,", "northeast", "1 to 7 characters"},
        {"turn_deg: 15.0", "turn_deg: 45", "turn_deg: 45", "outside -30 .. 30"},
        {"max_deg: 93.0", "max_deg: -1", "max_deg: -1", "below min_deg"},
        {"enabled: false", "enabled: off", "enabled: off", "neither true nor false"},
        {"high_m: 2.07", "high_m: 0.1", "", "heights of a part of the body"},
        {"  parts:", "  pars:", "pars", "unknown key 'body.pars'"},
        {"low_m: 1.24", "low_m: 0.0", "low_m: 0.0,", "body.parts[5].low_m: 0 is outside"},
        {"name: rex", "name: rex\nname: rex", "", "appears twice"},
        {"feet:", "feet: 3\nfeat:", "feet: 3", "feet: expected a group of keys"},
        {"mount:", "mount: [", "", "not valid YAML"},
    };
    for (const Case& c : cases) {
        const std::string text = rex_with(c.from, c.to);
        const auto file = parse_machine(text, "m.yaml");
        ASSERT_FALSE(file.ok()) << c.to;
        EXPECT_EQ(file.error().code, ErrorCode::usage) << c.to;
        const std::string& message = file.error().message;
        EXPECT_TRUE(contains(message, c.expected)) << message;
        EXPECT_TRUE(contains(message, "m.yaml")) << message;
        if (*c.line == '\0') continue;
        const std::size_t at = text.find(c.line);
        const auto line =
            1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
        EXPECT_TRUE(contains(message, "m.yaml:" + std::to_string(line) + ":"))
            << message << " should name line " << line;
    }
}

TEST(MachineFile, an_empty_or_missing_file_is_refused) {
    EXPECT_FALSE(parse_machine("", "m.yaml").ok());
    EXPECT_FALSE(parse_machine("[1, 2]", "m.yaml").ok());
    EXPECT_FALSE(parse_machine("3", "m.yaml").ok());
    const auto missing = read_machine("/nowhere/rex.yaml");
    ASSERT_FALSE(missing.ok());
    EXPECT_TRUE(contains(missing.error().message, "/nowhere/rex.yaml"));
}

TEST(MachineFile, damaged_files_are_refused_or_valid_but_never_crash) {
    testing::for_each_mutation(rex_text(), 400, 31, [](const std::string& text) {
        const auto file = parse_machine(text, "m.yaml");
        if (file.ok()) {
            EXPECT_EQ(file->machine.problem(), nullptr);
            EXPECT_TRUE(file->T_body_left.all_finite());
        } else {
            EXPECT_FALSE(file.error().message.empty());
        }
    });
}

}  // namespace
}  // namespace surefoot::io
