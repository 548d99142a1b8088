// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/maps/place_file.hpp"

#include <fmt/format.h>

#include <type_traits>

#include "surefoot/core/assert.hpp"
#include "surefoot/io/bytes.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/maps/map_file.hpp"

namespace surefoot::io {
namespace {

using place_recognition::Feature;
using place_recognition::Keyframe;
using place_recognition::Place;

constexpr std::string_view kMagic{"SFPLACE\0", 8};
constexpr std::size_t kHeaderBytes = 32;
constexpr std::size_t kKeyframeBytes = 176;
constexpr std::size_t kFeatureBytes = 44;
constexpr std::size_t kChecksumBytes = 8;
constexpr std::uint32_t kMostRecordBytes = 4096;  ///< largest keyframe or feature [bytes]

/// Contents of the header of a place file.
struct Outline {
    std::uint16_t minor = kPlaceFileMinor;
    std::uint32_t header_bytes = kHeaderBytes;
    std::uint32_t keyframes = 0;
    std::uint32_t keyframe_bytes = kKeyframeBytes;
    std::uint32_t feature_bytes = kFeatureBytes;
};

template <typename P, typename Visit>
void for_each_of_pose(P& pose, const Visit& visit) {
    for (int axis = 0; axis < 3; ++axis) visit(pose.translation_m[axis]);
    visit(pose.rotation.x());
    visit(pose.rotation.y());
    visit(pose.rotation.z());
    visit(pose.rotation.w());
}

/// Visits the numbers of a keyframe in file order; reading and writing share this list.
template <typename K, typename Visit>
void for_each_of_keyframe(K& keyframe, const Visit& visit) {
    visit(keyframe.view.time_ns);
    for_each_of_pose(keyframe.T_map_body, visit);
    auto& rig = keyframe.view.rig;
    visit(rig.width);
    visit(rig.height);
    visit(rig.fx_px);
    visit(rig.fy_px);
    visit(rig.cx_px);
    visit(rig.cy_px);
    visit(rig.baseline_m);
    for_each_of_pose(rig.T_body_camera, visit);
}

template <typename F, typename Visit>
void for_each_of_feature(F& feature, const Visit& visit) {
    for (int axis = 0; axis < 3; ++axis) visit(feature.pixel_px[axis]);
    for (auto& bits : feature.descriptor.bits) visit(bits);
}

/// Reads the next number from `at` on.
struct Taker {
    const char*& at;
    template <typename T>
    void operator()(T& value) const {
        value = load_le<T>(at);
        at += sizeof(T);
    }
};

Error damaged(const std::string& file, const std::string& what) {
    return input_error(fmt::format(
        "{}: {}; copy the place again, or remove the file and run again to remember the place",
        file,
        what));
}

/// Checks the sizes in a header whose checksum is correct.
Status check_sizes(const Outline& outline, std::size_t content_bytes) {
    const auto size =
        [](const char* of, std::uint64_t is, std::uint64_t least, std::uint64_t most) {
            if (is >= least && is <= most) return Status{};
            return Status{input_error(
                fmt::format("{} of {} bytes; {} to {} are allowed", of, is, least, most))};
        };
    if (auto status = size("a header", outline.header_bytes, kHeaderBytes, content_bytes); !status)
        return status;
    if (auto status = size("keyframes", outline.keyframe_bytes, kKeyframeBytes, kMostRecordBytes);
        !status)
        return status;
    if (auto status = size("features", outline.feature_bytes, kFeatureBytes, kMostRecordBytes);
        !status)
        return status;
    if (outline.keyframes > static_cast<std::uint32_t>(place_recognition::kMostKeyframes))
        return input_error(fmt::format("{} keyframes; at most {} are allowed",
                                       outline.keyframes,
                                       place_recognition::kMostKeyframes));
    return {};
}

Result<Outline> read_outline(std::string_view bytes, const std::string& file) {
    if (bytes.substr(0, kMagic.size()) != kMagic)
        return input_error(file + ": not a remembered place (wrong first bytes)");
    if (bytes.size() < kHeaderBytes + kChecksumBytes)
        return damaged(file, fmt::format("truncated place: {} bytes", bytes.size()));
    const char* at = bytes.data() + kMagic.size();
    const Taker take{at};
    Outline outline;
    std::uint16_t major = 0;
    std::uint32_t reserved = 0;
    take(major);
    take(outline.minor);
    // Check the version first: for another version even the position of the checksum is unknown.
    if (major != kPlaceFileMajor) {
        return input_error(fmt::format(
            "{}: place of version {}.{}; this program reads version {}: {}",
            file,
            major,
            outline.minor,
            kPlaceFileMajor,
            major > kPlaceFileMajor ? "use a newer program" : "run again to remember the place"));
    }
    const std::size_t content = bytes.size() - kChecksumBytes;
    if (map_checksum(bytes.substr(0, content)) != load_le<std::uint64_t>(bytes.data() + content))
        return damaged(file, "truncated or damaged place: its checksum is wrong");
    take(outline.header_bytes);
    take(outline.keyframes);
    take(outline.keyframe_bytes);
    take(outline.feature_bytes);
    take(reserved);
    if (reserved != 0)
        return damaged(file, fmt::format("invalid place: reserved bytes hold {}", reserved));
    if (const Status status = check_sizes(outline, content); !status)
        return damaged(file, "invalid place: " + status.error().message);
    return outline;
}

/// Reads one keyframe with its features; removes the bytes of the keyframe from `left`.
Status read_keyframe(std::string_view& left, const Outline& outline, Keyframe& keyframe) {
    const auto too_short = [&] {
        return input_error(
            fmt::format("the file ends after {} bytes of this keyframe", left.size()));
    };
    if (left.size() < outline.keyframe_bytes) return too_short();
    const char* at = left.data();
    for_each_of_keyframe(keyframe, Taker{at});
    const auto features = load_le<std::uint32_t>(at);
    const auto reserved = load_le<std::uint32_t>(at + 4);
    if (reserved != 0) return input_error(fmt::format("reserved bytes hold {}", reserved));
    if (features > static_cast<std::uint32_t>(place_recognition::kMostFeatures))
        return input_error(fmt::format(
            "{} features; at most {} are allowed", features, place_recognition::kMostFeatures));
    const std::size_t bytes =
        outline.keyframe_bytes + std::size_t{features} * outline.feature_bytes;
    if (left.size() < bytes) return too_short();
    keyframe.view.features.resize(features);
    for (std::uint32_t i = 0; i < features; ++i) {
        at = left.data() + outline.keyframe_bytes + std::size_t{i} * outline.feature_bytes;
        for_each_of_feature(keyframe.view.features[i], Taker{at});
    }
    left.remove_prefix(bytes);
    return {};
}

}  // namespace

Result<std::string> format_place(const Place& place) {
    if (const auto problem = place.problem())
        return output_error("the place is not written: it has " + *problem);
    std::string out(kMagic);
    store_le(out, kPlaceFileMajor);
    store_le(out, kPlaceFileMinor);
    store_le(out, static_cast<std::uint32_t>(kHeaderBytes));
    store_le(out, static_cast<std::uint32_t>(place.keyframes.size()));
    store_le(out, static_cast<std::uint32_t>(kKeyframeBytes));
    store_le(out, static_cast<std::uint32_t>(kFeatureBytes));
    store_le(out, std::uint32_t{0});
    SUREFOOT_ASSERT(out.size() == kHeaderBytes);
    const auto put = [&](const auto& value) { store_le(out, value); };
    for (const Keyframe& keyframe : place.keyframes) {
        for_each_of_keyframe(keyframe, put);
        store_le(out, static_cast<std::uint32_t>(keyframe.view.features.size()));
        store_le(out, std::uint32_t{0});
        for (const Feature& feature : keyframe.view.features) for_each_of_feature(feature, put);
    }
    store_le(out, map_checksum(out));
    return out;
}

Status write_place(const std::string& path, const Place& place) {
    const Result<std::string> bytes = format_place(place);
    if (!bytes) return output_error(path + ": " + bytes.error().message);
    return write_file(path, *bytes);
}

Result<PlaceFile> parse_place(std::string_view bytes, const std::string& file) {
    const Result<Outline> outline = read_outline(bytes, file);
    if (!outline) return outline.error();
    PlaceFile out;
    out.minor = outline->minor;
    std::string_view left =
        bytes.substr(outline->header_bytes, bytes.size() - kChecksumBytes - outline->header_bytes);
    for (std::uint32_t i = 0; i < outline->keyframes; ++i) {
        out.place.keyframes.emplace_back();
        if (const Status status = read_keyframe(left, *outline, out.place.keyframes.back());
            !status)
            return damaged(
                file, fmt::format("invalid place: keyframe {}: {}", i, status.error().message));
    }
    if (!left.empty())
        return damaged(
            file, fmt::format("invalid place: {} bytes follow its last keyframe", left.size()));
    if (const auto problem = out.place.problem())
        return damaged(file, "invalid place: " + *problem);
    return out;
}

Result<PlaceFile> read_place(const std::string& path) {
    const Result<std::string> bytes = read_file(path, limits::kMapBytes);
    if (!bytes) return bytes.error();
    return parse_place(*bytes, path);
}

}  // namespace surefoot::io
