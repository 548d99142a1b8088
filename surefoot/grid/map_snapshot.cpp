// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/map_snapshot.hpp"

#include <bit>
#include <cstring>

namespace surefoot::grid {
namespace {

constexpr std::uint64_t kOffsetBasis = 0xcbf29ce484222325ULL;
constexpr std::uint64_t kPrime = 0x00000100000001b3ULL;

constexpr std::uint64_t step(std::uint64_t hash, std::uint64_t word) noexcept {
    return (hash ^ word) * kPrime;
}

std::uint64_t word_at(const unsigned char* bytes) noexcept {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, sizeof(word));
    return word;
}

/// Four independent chains keep the multiplier busy: one chain alone waits for every product. Plain
/// variables, because an array of lanes would live in memory.
template <typename Layer>
std::uint64_t add_layer(std::uint64_t hash, const Layer& layer) noexcept {
    constexpr std::size_t kWord = sizeof(std::uint64_t);
    static_assert(sizeof(Layer) % (4 * kWord) == 0);
    std::uint64_t a = hash;
    std::uint64_t b = hash ^ 1U;
    std::uint64_t c = hash ^ 2U;
    std::uint64_t d = hash ^ 3U;
    const auto* bytes = reinterpret_cast<const unsigned char*>(layer.data());
    for (const auto* const end = bytes + sizeof(Layer); bytes != end; bytes += 4 * kWord) {
        a = step(a, word_at(bytes));
        b = step(b, word_at(bytes + kWord));
        c = step(c, word_at(bytes + 2 * kWord));
        d = step(d, word_at(bytes + 3 * kWord));
    }
    return step(step(step(step(hash, a), b), c), d);
}

std::uint64_t header_hash(const MapSnapshot& s) noexcept {
    std::uint64_t hash = kOffsetBasis;
    const auto add = [&hash](auto value) { hash = step(hash, static_cast<std::uint64_t>(value)); };
    add(s.magic);
    add(s.layout);
    add(s.version);
    add(s.config_hash);
    add(s.frame_time_ns);
    add(s.pose_time_ns);
    add(s.resolution_tenth_mm);
    add(s.nx);
    add(s.ny);
    add(s.edge_count);
    add(s.origin_x_tenth_mm);
    add(s.origin_y_tenth_mm);
    add(s.body_x_tenth_mm);
    add(s.body_y_tenth_mm);
    add(s.body_z_tenth_mm);
    add(std::bit_cast<std::uint64_t>(s.body_cos_yaw));
    add(std::bit_cast<std::uint64_t>(s.body_sin_yaw));
    add(s.gravity_source);
    add(s.health);
    add(s.camera);
    for (const std::uint8_t byte : s.padding) add(byte);
    return hash;
}

bool has_sound_header(const MapSnapshot& s) noexcept {
    // 5 mm is the finest and 0.2 m the coarsest cell that the rules of the gate were made for.
    constexpr std::int32_t kFinestTenthMm = 50;
    constexpr std::int32_t kCoarsestTenthMm = 2000;
    // 100 km: what quantised coordinates may reach without any product overflowing.
    constexpr std::int64_t kFarthestTenthMm = 1'000'000'000;
    const auto near = [](std::int64_t value) {
        return value >= -kFarthestTenthMm && value <= kFarthestTenthMm;
    };
    const double norm_sq =
        s.body_cos_yaw * s.body_cos_yaw + s.body_sin_yaw * s.body_sin_yaw;  // NaN fails the test
    return s.magic == MapSnapshot::kMagic && s.layout == MapSnapshot::kLayout && s.nx >= 1 &&
           s.nx <= MapSnapshot::kMaxSide && s.ny >= 1 && s.ny <= MapSnapshot::kMaxSide &&
           s.edge_count >= 0 && s.edge_count <= MapSnapshot::kMaxEdges &&
           s.resolution_tenth_mm >= kFinestTenthMm && s.resolution_tenth_mm <= kCoarsestTenthMm &&
           near(s.origin_x_tenth_mm) && near(s.origin_y_tenth_mm) && near(s.body_x_tenth_mm) &&
           near(s.body_y_tenth_mm) && near(s.body_z_tenth_mm) && norm_sq > 0.999 && norm_sq < 1.001;
}

}  // namespace

std::uint64_t snapshot_checksum(const MapSnapshot& snapshot) noexcept {
    std::uint64_t hash = header_hash(snapshot);
    hash = add_layer(hash, snapshot.height_tenth_mm);
    hash = add_layer(hash, snapshot.sigma_tenth_mm);
    hash = add_layer(hash, snapshot.drift_tenth_mm);
    hash = add_layer(hash, snapshot.clearance_tenth_mm);
    hash = add_layer(hash, snapshot.component);
    hash = add_layer(hash, snapshot.drop_evidence);
    hash = add_layer(hash, snapshot.source);
    return add_layer(hash, snapshot.edges);
}

bool is_intact(const MapSnapshot& snapshot) noexcept {
    return has_sound_header(snapshot) && snapshot.checksum == snapshot_checksum(snapshot);
}

}  // namespace surefoot::grid
