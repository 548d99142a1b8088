// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/rated_limits.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>

#include "surefoot/core/nearest_names.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// The limits of machines/rex.yaml. The counts of hazards, faults and false stops in
/// docs/evidence/safety.md were measured with these limits.
constexpr std::array kRatedLimits{
    RatedLimit{"limits.walk.up_m", 0.02, true, "the flat gait was not tried on higher steps"},
    RatedLimit{"limits.walk.down_m", 0.02, true, "the flat gait was not tried on deeper steps"},
    RatedLimit{"limits.stair.up_m", 0.18, true, "higher risers were not tried"},
    RatedLimit{"limits.stair.down_m", 0.18, true, "higher risers were not tried"},
    RatedLimit{"limits.tilt_deg", 6.0, true, "steeper ground was not tried"},
    RatedLimit{"limits.patch_side_m",
               0.05,
               true,
               "a larger patch hides small obstacles in its mean height"},
    RatedLimit{"limits.patch_residual_m", 0.025, true, "a foot tolerates only 25 mm of unevenness"},
    RatedLimit{"limits.patch_sigma_m",
               0.003,
               true,
               "a larger value accepts ground with a less certain height"},
    RatedLimit{"limits.sigma_factor",
               3.4,
               false,
               "a smaller factor leaves an error unnoticed in more than 3e-4 of the patches"},
    RatedLimit{"limits.patch_independent_cells",
               4,
               true,
               "a larger value takes more cells of a patch as independent"},
    RatedLimit{"limits.cell_sigma_m",
               0.012,
               true,
               "a larger value accepts cells with a less certain height in the path"},
    RatedLimit{"limits.swing_clearance_m",
               0.04,
               true,
               "a larger value allows higher objects in the path of a foot"},
    RatedLimit{
        "limits.foot_margin_m", 0.02, false, "a smaller value checks a narrower path of the foot"},
    RatedLimit{"limits.drop_m",
               0.05,
               true,
               "a larger value leaves less margin to the lowest kerb that was tried (75 mm)"},
    RatedLimit{
        "limits.drop_band_m", 0.10, false, "a smaller value allows an edge closer to a foot"},
    RatedLimit{"limits.drop_evidence",
               0.5,
               true,
               "a larger value requires more evidence to detect a drop"},
    RatedLimit{"limits.drift_m",
               0.025,
               true,
               "a larger value allows more drift since the last observation of the ground"},
    RatedLimit{
        "limits.tread_share", 0.80, false, "a smaller value lets a tread support less of the foot"},
    RatedLimit{"limits.tread_overhang_m",
               0.073,
               true,
               "a larger value lets a foot extend farther over a nosing"},
    RatedLimit{"limits.frame_age_ms", 200, true, "a larger value lets the gate use an older map"},
    RatedLimit{"limits.pose_age_ms",
               200,
               true,
               "a larger value accepts an older pose, and the machine may have moved"},
    RatedLimit{"limits.future_tolerance_ms",
               5,
               true,
               "a larger value allows a larger difference between clocks"},
    RatedLimit{
        "limits.verdict_ttl_ms", 300, true, "a larger value allows the use of an older approval"},
    RatedLimit{
        "limits.attestation_radius_m", 1.0, true, "an operator cannot inspect ground farther away"},
};

const YamlNode* node_at(const YamlNode& root, std::string_view key) {
    const YamlNode* node = &root;
    for (const std::string_view part : split(key, ".")) {
        if (node == nullptr) return nullptr;
        node = node->find(part);
    }
    return node;
}

/// Returns the number in the file. Returns no value if the number is missing or unreadable (another
/// check reports this), or if its step class is disabled.
std::optional<double> value_at(const YamlNode& root, std::string_view key) {
    for (const std::string_view group : {"limits.walk", "limits.stair"}) {
        if (!key.starts_with(group)) continue;
        const YamlNode* enabled = node_at(root, fmt::format("{}.enabled", group));
        if (enabled != nullptr && enabled->scalar == "false") return std::nullopt;
    }
    const YamlNode* node = node_at(root, key);
    return node == nullptr ? std::nullopt : parse_double(node->scalar);
}

bool is_laxer(const RatedLimit& limit, double value) {
    return limit.larger_allows_more ? value > limit.rated : value < limit.rated;
}

const RatedLimit* find_limit(std::string_view key) {
    const auto found = std::find_if(kRatedLimits.begin(),
                                    kRatedLimits.end(),
                                    [&](const RatedLimit& limit) { return limit.key == key; });
    return found == kRatedLimits.end() ? nullptr : &*found;
}

/// Returns true if the text has the form YYYY-MM-DD, with a month of 1 to 12 and a day of 1 to 31.
bool is_date(std::string_view text) {
    const auto parts = split(text, "-");
    if (text.size() != 10 || parts.size() != 3 || parts[0].size() != 4 || parts[1].size() != 2)
        return false;
    const auto month = parse_int64(parts[1]);
    const auto day = parse_int64(parts[2]);
    return parse_int64(parts[0]) && month && day && *month >= 1 && *month <= 12 && *day >= 1 &&
           *day <= 31;
}

Deviation read_line(YamlGroup& line) {
    constexpr std::size_t kShortestReason = 10;
    constexpr double kLargest = 1e6;
    Deviation deviation;
    deviation.key = line.text("key", 60);
    deviation.value = line.number("value", -kLargest, kLargest);
    deviation.reason = line.text("reason", 300);
    deviation.signed_by = line.text("signed", 80);
    deviation.date = line.text("date", 10);
    if (deviation.reason.size() < kShortestReason)
        line.fail("reason",
                  fmt::format("give the reason in at least {} characters", kShortestReason));
    if (!is_date(deviation.date))
        line.fail("date", quoted(deviation.date) + " is not a date YYYY-MM-DD");
    return deviation;
}

/// Describes the problem of an entry; no value if the entry is valid.
std::optional<std::string> problem_of(const Deviation& deviation,
                                      const std::vector<Deviation>& before,
                                      const YamlNode& document) {
    const RatedLimit* limit = find_limit(deviation.key);
    if (limit == nullptr) {
        std::vector<std::string> keys;
        keys.reserve(std::size(kRatedLimits));
        for (const RatedLimit& each : kRatedLimits) keys.emplace_back(each.key);
        return fmt::format(
            "{} is not a rated limit{}", quoted(deviation.key), did_you_mean(deviation.key, keys));
    }
    for (const Deviation& other : before) {
        if (other.key == deviation.key)
            return fmt::format("{} is signed twice; remove one of the two lines", deviation.key);
    }
    const std::optional<double> value = value_at(document, deviation.key);
    if (value && *value != deviation.value) {
        return fmt::format(
            "{} was signed, but {} is {}: have the new value signed, or restore the old one",
            deviation.value,
            deviation.key,
            *value);
    }
    if (!value || !is_laxer(*limit, *value)) {
        return fmt::format(
            "{} is not beyond its rated limit {}: remove this line", deviation.key, limit->rated);
    }
    return std::nullopt;
}

void report_unsigned(YamlReader& reader,
                     const YamlNode& document,
                     const std::vector<Deviation>& deviations) {
    std::vector<const RatedLimit*> beyond;
    for (const RatedLimit& limit : kRatedLimits) {
        const std::optional<double> value = value_at(document, limit.key);
        const bool is_signed =
            std::any_of(deviations.begin(), deviations.end(), [&](const Deviation& deviation) {
                return deviation.key == limit.key;
            });
        if (value && is_laxer(limit, *value) && !is_signed) beyond.push_back(&limit);
    }
    if (beyond.empty()) return;
    const RatedLimit& first = *beyond.front();
    std::vector<std::string> others;
    for (std::size_t i = 1; i < beyond.size(); ++i) others.emplace_back(beyond[i]->key);
    const double value = *value_at(document, first.key);
    reader.fail(
        *node_at(document, first.key),
        first.key,
        fmt::format(
            "{0} is laxer than the rated limit {1} ({2}) and no person has signed for it. Set it "
            "to {1}, or have the responsible person add this line to 'deviations': "
            "{{key: {3}, value: {0}, reason: WHY, signed: NAME, date: YYYY-MM-DD}}{4}",
            value,
            first.rated,
            first.reason,
            first.key,
            others.empty() ? ""
                           : fmt::format(". {} more values are laxer than their rated limits: {}",
                                         others.size(),
                                         fmt::join(others, ", "))));
}

}  // namespace

std::span<const RatedLimit> rated_limits() noexcept {
    return kRatedLimits;
}

std::string text_of(const Deviation& deviation) {
    return fmt::format("{} is {} (rated {}), signed by {} on {}: {}",
                       deviation.key,
                       deviation.value,
                       deviation.rated,
                       deviation.signed_by,
                       deviation.date,
                       deviation.reason);
}

std::vector<Deviation> read_deviations(YamlReader& reader, YamlGroup& root) {
    const YamlNode& document = reader.root();
    std::vector<Deviation> deviations;
    if (root.has("deviations")) {
        root.list("deviations", kRatedLimits.size(), [&](YamlGroup& line) {
            Deviation deviation = read_line(line);
            if (reader.error()) return;
            if (const auto problem = problem_of(deviation, deviations, document))
                return line.fail("key", *problem);
            deviation.rated = find_limit(deviation.key)->rated;
            deviations.push_back(std::move(deviation));
        });
    }
    if (!reader.error()) report_unsigned(reader, document, deviations);
    return deviations;
}

}  // namespace surefoot::io
