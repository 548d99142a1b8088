// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/machine_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

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
        const char* line;  ///< line of rex.yaml, or empty
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
        {"{code: 9, name: N", "{code: 8, name: N", "forward_m: 0.400", "code: 8 appears twice"},
        {"{code: 9, name: N", "{code: 27, name: N", "forward_m: 0.400", "27 is outside 1 .. 26"},
        {"{code: 9, name: N", "{code: 0, name: N", "forward_m: 0.400", "0 is outside 1 .. 26"},
        {"class: walk}", "class: run}", "class: run", "'run' is neither walk nor stair"},
        {"name: NNE,", "name: northeast,", "northeast", "1 to 7 characters"},
        {"turn_deg: 15.0", "turn_deg: 45", "turn_deg: 45", "outside -30 .. 30"},
        {"max_deg: 93.0", "max_deg: -1", "max_deg: -1", "below min_deg"},
        {"enabled: false", "enabled: off", "enabled: off", "neither true nor false"},
        {"high_m: 2.07", "high_m: 0.1", "", "body part: low_m must be"},
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

const std::string kWalk = "walk: {enabled: true, up_m: 0.02, down_m: 0.02}";

TEST(MachineFile, the_former_name_of_the_attestation_radius_is_read_with_a_note) {
    const auto today = parse_machine(rex_text(), "m.yaml");
    ASSERT_TRUE(today.ok());
    EXPECT_TRUE(today->notes.empty());
    const auto former =
        parse_machine(rex_with("attestation_radius_m: 1.0", "vouch_radius_m: 0.7"), "m.yaml");
    ASSERT_TRUE(former.ok()) << former.error().message;
    EXPECT_EQ(former->machine.limits.attestation_radius_tenth_mm, 7000);
    ASSERT_EQ(former->notes.size(), 1U);
    EXPECT_TRUE(
        contains(former->notes[0], "'vouch_radius_m' is now called 'attestation_radius_m'"));
    const auto both = parse_machine(
        rex_with("attestation_radius_m: 1.0", "attestation_radius_m: 1.0\n  vouch_radius_m: 0.7"),
        "m.yaml");
    ASSERT_FALSE(both.ok());
    EXPECT_TRUE(contains(both.error().message, "vouch_radius_m"));
}

TEST(MachineFile, a_signature_for_the_former_name_of_a_limit_counts) {
    const std::string line =
        "deviations:\n  - {key: limits.vouch_radius_m, value: 1.5, reason: a wider inspected area, "
        "signed: J. Doe, date: 2026-01-31}\n";
    const std::string laxer = rex_with("attestation_radius_m: 1.0", "vouch_radius_m: 1.5");
    EXPECT_FALSE(parse_machine(laxer, "m.yaml").ok());
    const auto is_signed = parse_machine(laxer + line, "m.yaml");
    ASSERT_TRUE(is_signed.ok()) << is_signed.error().message;
    ASSERT_EQ(is_signed->deviations.size(), 1U);
    EXPECT_EQ(is_signed->deviations[0].key, "limits.attestation_radius_m");
    EXPECT_EQ(is_signed->notes.size(), 2U);
}

/// The REX file with a laxer limit and a line of `deviations` (none for an empty one).
std::string signed_rex(const std::string& line) {
    return rex_with("tilt_deg: 6.0", "tilt_deg: 8") +
           (line.empty() ? "" : "deviations:\n  - " + line + "\n");
}

std::string message_of(const std::string& text) {
    const auto file = parse_machine(text, "m.yaml");
    return file.ok() ? "accepted" : file.error().message;
}

const std::string kSigned =
    "{key: limits.tilt_deg, value: 8, reason: ramp trial with a spotter, signed: J. Doe, date: "
    "2026-11-27}";

TEST(MachineFile, the_rex_keeps_every_rated_limit) {
    EXPECT_EQ(message_of(rex_text()), "accepted");
    EXPECT_TRUE(parse_machine(rex_text(), "m.yaml")->deviations.empty());
    EXPECT_EQ(rated_limits().size(), 24U)
        << "a limit of the file without a rated value is never judged";
}

TEST(MachineFile, a_laxer_limit_must_be_signed_for) {
    const std::string said = message_of(signed_rex(""));
    EXPECT_TRUE(contains(said, "limits.tilt_deg: 8 is laxer than the rated limit 6")) << said;
    EXPECT_TRUE(contains(said, "{key: limits.tilt_deg, value: 8, reason: WHY, signed: NAME"))
        << said;
    const auto file = parse_machine(signed_rex(kSigned), "m.yaml");
    ASSERT_TRUE(file.ok()) << file.error().message;
    ASSERT_EQ(file->deviations.size(), 1U);
    EXPECT_EQ(text_of(file->deviations[0]),
              "limits.tilt_deg is 8 (rated 6), signed by J. Doe on 2026-11-27: ramp trial with a "
              "spotter");
    EXPECT_NEAR(file->machine.limits.min_normal_z, std::cos(8.0 * std::numbers::pi / 180.0), 1e-15);
}

TEST(MachineFile, every_limit_is_judged_in_its_own_direction) {
    for (const RatedLimit& limit : rated_limits()) {
        std::string key = limit.key;
        key = key.substr(key.rfind('.') + 1);
        if (key == "up_m" || key == "down_m") continue;  // below, by class
        const std::string text = rex_text();
        const std::size_t at = text.find("  " + key + ":");
        ASSERT_NE(at, text.npos) << key;
        const std::size_t value = text.find(':', at) + 2;
        const std::size_t end = text.find_first_of(" \n", value);
        const double old = std::stod(text.substr(value, end - value));
        EXPECT_EQ(old, limit.rated) << key << ": the table says what rex.yaml has";
        const bool whole = key.ends_with("_ms") || key == "patch_independent_cells";
        const double step = whole ? 1.0 : 1e-3;
        for (const bool laxer : {true, false}) {
            const double changed = old + (laxer == limit.larger_allows_more ? step : -step);
            std::string other = text;
            other.replace(
                value,
                end - value,
                whole ? std::to_string(static_cast<int>(changed)) : std::to_string(changed));
            const std::string said = message_of(other);
            EXPECT_EQ(contains(said, "no person has signed for it"), laxer) << key << ": " << said;
        }
    }
}

TEST(MachineFile, step_limits_belong_to_what_the_class_can_do) {
    const auto walk = [](const std::string& limits) {
        return message_of(rex_with(kWalk, "walk: {enabled: true, " + limits + "}"));
    };
    EXPECT_TRUE(
        contains(walk("up_m: 0.3, down_m: 0.3"), "walk.up_m 0.3 is above swing_clearance_m 0.04"));
    EXPECT_TRUE(contains(walk("up_m: 0.03, down_m: 0.02"), "limits.walk.up_m: 0.03 is laxer"));
    EXPECT_TRUE(contains(walk("up_m: 0.02, down_m: 0.05"), "limits.walk.down_m: 0.05 is laxer"));
    const std::string stair = "stair: {enabled: false, up_m: 0.18, down_m: 0.18}";
    EXPECT_EQ(message_of(rex_with(stair, "stair: {enabled: false, up_m: 0.3, down_m: 0.3}")),
              "accepted")
        << "a class that is not enabled allows nothing";
    EXPECT_TRUE(
        contains(message_of(rex_with(stair, "stair: {enabled: true, up_m: 0.2, down_m: 0.18}")),
                 "limits.stair.up_m: 0.2 is laxer than the rated limit 0.18"));
    EXPECT_EQ(message_of(rex_with(stair, "stair: {enabled: true, up_m: 0.18, down_m: 0.18}")),
              "accepted");
}

TEST(MachineFile, a_lax_machine_is_refused_with_all_its_limits) {
    std::string text = rex_text();
    for (const auto& [from, to] :
         {std::pair<std::string, std::string>{"tilt_deg: 6.0", "tilt_deg: 11"},
          {"patch_residual_m: 0.025", "patch_residual_m: 0.05"},
          {"sigma_factor: 3.4", "sigma_factor: 3"},
          {"swing_clearance_m: 0.04", "swing_clearance_m: 0.2"},
          {"drop_band_m: 0.10", "drop_band_m: 0.05"},
          {"verdict_ttl_ms: 300", "verdict_ttl_ms: 1000"}}) {
        const std::size_t at = text.find(from);
        ASSERT_NE(at, text.npos) << from;
        text.replace(at, from.size(), to);
    }
    EXPECT_TRUE(contains(message_of(text),
                         "5 more values are laxer than their rated limits: "
                         "limits.patch_residual_m, limits.sigma_factor, "
                         "limits.swing_clearance_m, limits.drop_band_m, limits.verdict_ttl_ms"))
        << message_of(text);
}

TEST(MachineFile, a_signature_is_for_one_value_of_one_limit) {
    const auto line = [](const std::string& from, const std::string& to) {
        std::string text = kSigned;
        const std::size_t at = text.find(from);
        EXPECT_NE(at, text.npos) << from;
        return message_of(signed_rex(text.replace(at, from.size(), to)));
    };
    EXPECT_TRUE(contains(line("value: 8", "value: 7"), "7 was signed, but limits.tilt_deg is 8"));
    EXPECT_TRUE(contains(line("tilt_deg", "tiltdeg"),
                         "is not a rated limit; did you mean 'limits.tilt_deg'?"));
    EXPECT_TRUE(contains(line("limits.tilt_deg, value: 8", "limits.drop_m, value: 0.05"),
                         "limits.drop_m is not beyond its rated limit 0.05: remove this line"));
    EXPECT_TRUE(contains(line("2026-11-27", "27.11.2026"), "is not a date YYYY-MM-DD"));
    EXPECT_TRUE(contains(line("2026-11-27", "2026-13-27"), "is not a date YYYY-MM-DD"));
    EXPECT_TRUE(contains(line("ramp trial with a spotter", "trial"), "at least 10 characters"));
    EXPECT_TRUE(
        contains(line("signed: J. Doe, ", ""), "deviations[0].signed: this key is missing"));
    EXPECT_TRUE(
        contains(line("J. Doe", "''"), "deviations[0].signed: must have 1 to 80 characters"));
    EXPECT_TRUE(contains(message_of(signed_rex(kSigned + "\n  - " + kSigned)), "is signed twice"));
    EXPECT_TRUE(contains(message_of(rex_text() + "deviations: yes\n"), "expected a list"));
    EXPECT_EQ(message_of(rex_text() + "deviations: []\n"), "accepted");
}

TEST(MachineFile, another_kind_of_file_is_called_by_its_name) {
    EXPECT_EQ(message_of("resolution: [672, 376]\nfocal_px: 350\n"),
              "m.yaml: this looks like a rig.yaml of Surefoot, not like a machine file");
    EXPECT_EQ(message_of("Camera.fx: 1\n"),
              "m.yaml: this looks like an ORB-SLAM settings file, not like a machine file");
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
